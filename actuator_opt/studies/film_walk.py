"""Oil films of one or two seals in series, solved point by point over pressure and speed.

The solution at each point is the initial guess for the next.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import nan, pi
from typing import Literal, NamedTuple

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array
from ..evaluation.barrel import SEAL_STEP
from ..evaluation.film import FilmRow, Solved, floats, of_place, ring_films, solve
from ..evaluation.kernel import Base
from ..evaluation.rings import Place, Ring, seal_contact
from ..evaluation.values import of_case
from ..models import friction
from ..seals.contact import SealContact

Stroke = Literal["out", "in"]
"""Direction in which the counterface (rod or bore) moves past the seal: out of the sealed chamber,
or into it."""


def drives(place: Place) -> Stroke:
    """Return the direction in which the counterface moves past a seal if oil drives the actuator.

    A piston that oil drives moves away from the sealed pressure. Relative to its seal, the bore
    thus moves into the sealed chamber. (If a load overruns the actuator, the bore moves out of this
    chamber.) A rod that oil drives moves out of the sealed chamber.
    """
    return "in" if place == "piston" else "out"


@dataclass(frozen=True, slots=True)
class Sealing:
    """One ring, or two in series with oil between them, from the sealed side outwards.

    Parameters
    ----------
    rings : the rings, each with the pressure on its outer side; all numbers are floats
    outward : whether the counterface moves towards the outer side
    growth : radial growth of the counterface per unit pressure [m/Pa]
    """

    rings: tuple[Ring, ...]
    outward: bool
    growth: float = 0.0

    def grown(self, pressure: float) -> float:
        """Return the radial growth of the counterface [m] at a pressure difference [Pa]."""
        return self.growth * (pressure + float(self.rings[-1]["outer_pressure"]))

    def row(self, pressure: float, speed: float, **changes: float) -> FilmRow:
        """Return the inputs of the oil-film model; `changes` replace data of the first ring."""
        grown = self.grown(pressure)
        rings = []
        for ring in self.rings:
            left = ring["squeeze"] - grown / ring["section"]
            rings.append(ring.at(pressure=pressure, speed=speed, squeeze_left=left))
        rings[0] = rings[0].at(**changes)
        return FilmRow(tuple(rings), self.outward)

    def alone(self, index: int) -> Sealing:
        """Return a copy with only one of the rings."""
        return Sealing((self.rings[index],), self.outward, self.growth)


def sealing(base: Base, place: Place, case: int) -> Sealing:
    """Return the rings of piston or rod, with oil and outer pressure as in a load case."""
    rings = tuple(floats(ring, case) for ring in of_place(base.rings, place))
    pressure = float(of_case(base.state.driven_pressure, case))
    growth = 0.0
    if place == "piston" and pressure > 0:
        growths = SEAL_STEP * of_case(base.wall.case_growth, case)
        growth = float(np.max(np.real(growths))) / pressure
    return Sealing(rings, drives(place) == "out", growth)


class Missing(NamedTuple):
    """A point for which no film was solved: pressure difference [Pa], speed [m/s], and reason."""

    pressure: float
    speed: float
    reason: str


@dataclass(frozen=True, slots=True)
class FilmMap:
    """Friction of one ring or of two in series, at p pressures and v speeds; NaN without a film.

    Parameters
    ----------
    pressures, speeds : sealed pressures above the outer pressure (p,) [Pa], speeds (v,) [m/s]
    parts : friction of each ring (p, v, rings) [N]
    between : pressure between two rings, above the outer pressure (p, v) [Pa]; NaN for a single
        ring
    thickness : mean film thickness of each ring (p, v, rings) [m]
    viscous : share of oil shear in the friction (p, v)
    breakaway : dry breakaway friction, sum of all rings (p,) [N]; two rings share the pressure as
        they do at the lowest speed
    why : points without a film, each with the reason
    """

    pressures: Array
    speeds: Array
    parts: Array
    between: Array
    thickness: Array
    viscous: Array
    breakaway: Array
    why: tuple[Missing, ...]

    @property
    def friction(self) -> Array:
        """Return the friction of all rings (p, v) [N]."""
        return np.sum(self.parts, axis=2)

    @property
    def damping(self) -> Array:
        """Return the secant damping, friction divided by speed (p, v) [N s/m]."""
        return self.friction / self.speeds

    def at(self, pressure: float, speed: float) -> tuple[int, int]:
        """Return the indices of the tabulated pressure and speed nearest to given values."""
        return (
            int(np.argmin(np.abs(self.pressures - pressure))),
            int(np.argmin(np.abs(self.speeds - speed))),
        )


def film_map(
    sealing: Sealing, pressures: Sequence[float], speeds: Sequence[float], **changes: float
) -> FilmMap:
    """Solve the oil films at every pressure and speed; `changes` replace data of the first ring."""
    shape = len(pressures), len(speeds)
    count = len(sealing.rings)
    parts, thickness = np.full((2, *shape, count), nan)
    between, viscous = np.full((2, *shape), nan)
    dry: list[float] = []
    why: list[Missing] = []
    last: Solved | None = None
    for i, pressure in enumerate(pressures):
        rings = sealing.row(pressure, speeds[0], **changes).rings
        dry.append(breakaway(rings[0]) if count == 1 else nan)
        for k in range(len(speeds)):
            j = k if i % 2 == 0 else len(speeds) - 1 - k
            solved = solve(sealing.row(pressure, speeds[j], **changes), last)
            if solved.why:
                why.append(Missing(pressure, speeds[j], solved.why))
                continue
            last = solved
            films = ring_films(solved.values)
            parts[i, j] = ring_friction(solved)
            thickness[i, j] = [film.thickness for film in films]
            sheared = [
                pi * ring["diameter"] * film.drag
                for ring, film in zip(solved.row.rings, films, strict=True)
            ]
            viscous[i, j] = sum(sheared) / solved.friction()
            if count == 2:
                between[i, j] = solved.between - solved.row.inputs()["outer"]
                if j == 0:
                    dry[i] = sum(map(breakaway, solved.row.between(solved.between)))
    return FilmMap(
        np.array(pressures),
        np.array(speeds),
        parts,
        between,
        thickness,
        viscous,
        np.array(dry),
        tuple(why),
    )


def ring_friction(solved: Solved) -> tuple[float, ...]:
    """Return the friction of each ring [N]; NaN without a film."""
    if solved.why:
        return (nan,) * len(solved.row.rings)
    return tuple(float(friction) for friction in solved.row.frictions(solved.values))


def breakaway(ring: Ring) -> float:
    """Return the friction of a ring with all oil squeezed out [N]; 0 if pressure lifts it off."""
    return dry_friction(
        ring, seal_contact(ring.at(pressure=abs(ring["pressure"]))), "asperity_friction"
    )


def dry_friction(ring: Ring, contact: SealContact, coefficient: str) -> float:
    """Return the friction [N] of a ring's dry contact for a friction coefficient."""
    return float(
        friction.seal_friction(
            line_load=contact.line_load,
            diameter=ring["diameter"],
            friction_coefficient=ring[coefficient],
        )
    )
