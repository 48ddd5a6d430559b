"""The seals of [Huang2017] on their oil films, over speed and pressure: piston cylinder, plunger.

Test A is the design itself. Test B, the plunger, is the tandem of the design's rod on the plunger's
diameter: the standard housings of both diameters are the same. SI; pressures are gauge.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import nan, pi
from typing import Any

import numpy as np

from ...design.model import Design
from ...lubrication import Lubricant
from ...numeric import Array
from ..barrel import SEAL_STEP
from ..build import prepare
from ..film import Row, Solved, ring_films, solve
from ..film_tables import floats, of_place
from ..kernel import base
from ..rings import Place, Ring
from .huang_published import PAPER

CASE = 0
"""Load case of the design that gives oil and return pressure."""
SPEEDS = (0.5e-3, 0.8e-3, 1.3e-3, 2.1e-3, 3.3e-3, 5e-3, 7e-3, 10e-3)
"""Speeds of the maps: the tested range, and 2.1 mm/s where the printed fall holds."""
FAST = (10e-3, 20e-3, 40e-3, 80e-3, 0.16, 0.32)
"""Speeds beyond the tests, where oil begins to carry the seals."""
TYPICAL = 2.1e-3
"""Speed at which pressures are compared."""
PRESSURES = (0.6e6, 2e6, 4e6, 6e6, 8e6, 10e6)
"""Pressures of the plunger's map: those of table 2, and of figure 16."""
PISTON_PRESSURES = (1e6, 2e6, 4e6, 6e6, 7.15e6, 8e6, 10e6)
"""Pressures of the driven chamber of the piston cylinder; 7.15 MPa is the paper's."""


@dataclass(frozen=True, slots=True)
class Sealing:
    """Rings of one place that share the oil, from the sealed side outwards.

    Parameters
    ----------
    rings : at the design's case
    outward : whether their counterface moves to the outer side
    growth : of the counterface over the sealed pressure [m/Pa]
    outer_pressure : [Pa]
    """

    rings: tuple[Ring, ...]
    outward: bool
    growth: float = 0.0
    outer_pressure: float = 0.0

    def row(self, pressure: float, speed: float, **changes: float) -> Row:
        """The rings at a pressure difference and speed; `changes` are of the first."""
        rings = []
        for ring in self.rings:
            grown = self.growth * pressure / ring["section"]
            left = ring["squeeze"] - grown
            numbers = {"pressure": pressure, "speed": speed, "squeeze_left": left}
            rings.append(ring.at(outer_pressure=self.outer_pressure, **numbers))
        rings[0] = rings[0].at(**changes)
        return Row(tuple(rings), self.outward)

    def alone(self, index: int) -> Sealing:
        """One of the rings without the others."""
        return Sealing((self.rings[index],), self.outward, self.growth, self.outer_pressure)


@dataclass(frozen=True, slots=True)
class Sealings:
    """The sealings of both tests.

    Parameters
    ----------
    piston : drawn inwards, between driven chamber and return
    rod : of test A, at return pressure
    plunger : the rod's rings on the plunger
    return_pressure : [Pa]
    lubricant : the oil
    """

    piston: Sealing
    rod: Sealing
    plunger: Sealing
    return_pressure: float
    lubricant: Lubricant


def sealings(design: Design) -> Sealings:
    """The rings of both tests, each on its oil film whatever the design asks for."""
    subject = prepare(_on_films(design))
    v = subject.values()
    found = base(subject, v)
    drain = float(v["supply.return_pressure"])
    growth = float(np.max(np.real(SEAL_STEP * found.wall.growth))) / float(v["supply.pressure"])

    def own(place: Place) -> tuple[Ring, ...]:
        return tuple(floats(ring, CASE) for ring in of_place(found.rings, place))

    rod = own("rod")
    plunger = tuple(ring.at(diameter=PAPER.plunger) for ring in rod)
    first = rod[0]
    return Sealings(
        piston=Sealing(own("piston"), False, growth, drain),
        rod=Sealing(rod, True),
        plunger=Sealing(plunger, True),
        return_pressure=drain,
        lubricant=Lubricant(
            dynamic_viscosity=first["viscosity"],
            pressure_law=first.viscosity_law,
            pressure_coefficient=first["viscosity_coefficient"],
        ),
    )


def _on_films(design: Design) -> Design:
    """The design with a film under every sealing element."""
    film: dict[str, Any] = {"friction": "film"}
    seals = {}
    for place in ("piston", "rod"):
        seal = getattr(design.seals, place)
        second = seal.secondary and seal.secondary.model_copy(update=film)
        seals[place] = seal.model_copy(update=film | {"secondary": second})
    return design.model_copy(update={"seals": design.seals.model_copy(update=seals)})


def ring_friction(solved: Solved) -> tuple[float, ...]:
    """Friction of every ring of a row [N]; NaN without a film."""
    if solved.why:
        return (nan,) * len(solved.row.rings)
    return tuple(float(one) for one in solved.row.frictions(solved.values))


@dataclass(frozen=True, slots=True)
class FilmMap:
    """Friction of a sealing over pressure and speed; NaN where there is no film.

    Parameters
    ----------
    pressures, speeds : (p,) [Pa], (v,) [m/s]
    parts : friction of every ring (p, v, rings) [N]
    between : pressure between two rings (p, v) [Pa]; NaN for one
    thickness : mean film of every ring (p, v, rings) [m]
    viscous : share of the oil's shear in the friction (p, v)
    why : reasons of the points without a film
    """

    pressures: Array
    speeds: Array
    parts: Array
    between: Array
    thickness: Array
    viscous: Array
    why: tuple[str, ...]

    @property
    def friction(self) -> Array:
        """Of all rings (p, v) [N]."""
        return np.sum(self.parts, axis=2)

    @property
    def damping(self) -> Array:
        """Secant damping (p, v) [N s/m]."""
        return self.friction / self.speeds

    def at(self, pressure: float, speed: float) -> tuple[int, int]:
        """Place of a pressure and a speed in the tables."""
        return (
            int(np.argmin(np.abs(self.pressures - pressure))),
            int(np.argmin(np.abs(self.speeds - speed))),
        )


def film_map(
    sealing: Sealing,
    pressures: Sequence[float],
    speeds: Sequence[float] = SPEEDS,
    **changes: float,
) -> FilmMap:
    """The films at every pressure and speed, each begun from the one before."""
    shape = len(pressures), len(speeds)
    count = len(sealing.rings)
    parts, thickness = np.full((2, *shape, count), nan)
    between, viscous = np.full((2, *shape), nan)
    why: list[str] = []
    last: Solved | None = None
    for i, pressure in enumerate(pressures):
        for k in range(len(speeds)):
            j = k if i % 2 == 0 else len(speeds) - 1 - k
            found = solve(sealing.row(pressure, speeds[j], **changes), last)
            if found.why:
                why.append(f"{pressure / 1e6:g} MPa, {speeds[j] * 1e3:g} mm/s: {found.why}")
                continue
            last = found
            parts[i, j] = ring_friction(found)
            films = ring_films(found.values)
            thickness[i, j] = [film.thickness for film in films]
            sheared = [
                pi * ring["diameter"] * film.drag
                for ring, film in zip(found.row.rings, films, strict=True)
            ]
            viscous[i, j] = sum(sheared) / found.friction()
            if count == 2:
                between[i, j] = found.between - found.row.inputs()["outer"]
    return FilmMap(
        np.array(pressures), np.array(speeds), parts, between, thickness, viscous, tuple(why)
    )


@dataclass(frozen=True, slots=True)
class CylinderMap:
    """Damping of the piston cylinder over the driven chamber's pressure and the speed.

    Parameters
    ----------
    piston : over the pressure difference across it
    rod : at return pressure
    pressures : of the driven chamber (p,) [Pa]
    """

    piston: FilmMap
    rod: FilmMap
    pressures: Array

    @property
    def damping(self) -> Array:
        """Of both (p, v) [N s/m]."""
        return self.piston.damping + self.rod.damping


def cylinder_map(found: Sealings, speeds: Sequence[float] = SPEEDS) -> CylinderMap:
    """Figure 3: piston and rod seals on the outstroke."""
    across = [p - found.return_pressure for p in PISTON_PRESSURES]
    return CylinderMap(
        piston=film_map(found.piston, across, speeds),
        rod=film_map(found.rod, [found.return_pressure], speeds),
        pressures=np.array(PISTON_PRESSURES),
    )


def fast_map(found: Sealings) -> FilmMap:
    """The plunger at 6 MPa beyond the tested speeds."""
    return film_map(found.plunger, [PAPER.compared], FAST)


def plunger_map(found: Sealings, speeds: Sequence[float] = SPEEDS) -> FilmMap:
    """Figures 6 to 8, 15 and 16: the tandem of the plunger on the outstroke."""
    return film_map(found.plunger, PRESSURES, speeds)
