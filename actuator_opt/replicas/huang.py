"""The seals of [Huang2017] on their oil films, over speed and pressure: piston cylinder, plunger.

Test A is the design itself. Test B, the plunger, is the tandem of the design's rod on the plunger's
diameter: the standard housings of both diameters are the same. SI; pressures are gauge.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..base.numeric import Array
from ..design.model import Design
from ..evaluation.build import prepare
from ..evaluation.kernel import base
from ..friction import film
from ..lubrication import Lubricant
from ..studies.film_walk import FilmMap, Sealing, film_map, sealing
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
class Sealings:
    """The sealings of both tests.

    Parameters
    ----------
    piston : between driven chamber and return, its bore drawn in
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
    rod = sealing(found, "rod", CASE)
    plunger = tuple(ring.at(diameter=PAPER.plunger) for ring in rod.rings)
    first = rod.rings[0]
    return Sealings(
        piston=sealing(found, "piston", CASE),
        rod=rod,
        plunger=replace(rod, rings=plunger),
        return_pressure=drain,
        lubricant=Lubricant(
            dynamic_viscosity=first["viscosity"],
            pressure_law=first.viscosity_law,
            pressure_coefficient=first["viscosity_coefficient"],
        ),
    )


def _on_films(design: Design) -> Design:
    """The design with a film under every sealing element."""
    filmed: dict[str, Any] = {"friction": film.LAW.name}
    seals = {}
    for place in ("piston", "rod"):
        seal = getattr(design.seals, place)
        second = seal.secondary and seal.secondary.model_copy(update=filmed)
        seals[place] = seal.model_copy(update=filmed | {"secondary": second})
    return design.model_copy(update={"seals": design.seals.model_copy(update=seals)})


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
    """Figure 3: piston and rod seals, driven out."""
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
