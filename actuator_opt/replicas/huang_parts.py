"""Equation 26 of [Huang2017] for its plunger: seals, back-up ring and chamber, each part shown.

The paper gives no number of the back-up ring but its material, PTFE with copper; what it is
computed from here is assumed and stated. SI; pressures are gauge unless absolute is said.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from ..lubrication import Elastic, Gap, Lubricant, SmoothFilm, solve_gap
from ..models.damping import flat_gap, secant
from ..models.fluid import ATMOSPHERIC_PRESSURE
from ..studies.film_walk import FilmMap
from .huang import Sealings
from .huang_published import PAPER, plausible_chamber

CONTACT_PRESSURE = 0.1e6
"""Mean pressure of the back-up ring on the plunger: the "low contact stress" of section 3 (Pa)."""
CONTACT_PRESSURES = (0.02e6, 0.2e6)
"""Least and largest one that is tried beside it."""
WIDTH = 15e-3
"""Of the ring: the ISO 10766 housing of the standards the paper names, GB/T 15242 (m)."""
EDGE = 5e-6
"""Rounding of the ring's edges (m): worn in, assumed."""
EDGE_POWER = 8
"""The face rises with this power of the distance from its middle: flat but for the edges."""
NODES = 241
RING_SPEEDS = (0.5e-3, 0.7e-3, 1e-3, 1.5e-3, 2e-3, 3e-3)
"""Speeds of figure 20, and some between its own three."""


@dataclass(frozen=True, slots=True)
class RingFilm:
    """The smooth film of the back-up ring at a speed.

    Parameters
    ----------
    speed : [m/s]
    film : solved, or why not
    drag : on the plunger [N]
    """

    speed: float
    film: SmoothFilm
    drag: float

    @property
    def damping(self) -> float:
        """Secant damping [N s/m]."""
        return self.drag / self.speed


def back_up_ring(
    lubricant: Lubricant,
    elastic: Elastic,
    speed: float,
    contact_pressure: float = CONTACT_PRESSURE,
) -> RingFilm:
    """Equations 19 to 22 with density and viscosity in their places.

    The pressure around the ring is the same on both sides and bends nothing, so it counts as that
    of the atmosphere; a higher one would only keep the film from rupturing.
    """
    place = np.linspace(-1.0, 1.0, NODES)
    around = ATMOSPHERIC_PRESSURE
    gap = Gap(
        width=WIDTH,
        profile=EDGE * np.abs(place) ** EDGE_POWER,
        lubricant=lubricant,
        speed=speed,
        sealed_pressure=around,
        outer_pressure=around,
        line_load=(around + contact_pressure) * WIDTH,
        elastic=elastic,
    )
    film = solve_gap(gap)
    return RingFilm(speed, film, pi * PAPER.plunger * film.viscous_drag)


def ring_elastic(found: Sealings) -> Elastic:
    """The PTFE of the design's first rod seal: the ring is of the same stuff."""
    first = found.plunger.rings[0]
    return Elastic(first["face_modulus"], first["face_poissons_ratio"])


def ring_films(found: Sealings) -> tuple[RingFilm, ...]:
    """Figures 19 and 20."""
    elastic = ring_elastic(found)
    return tuple(back_up_ring(found.lubricant, elastic, v) for v in RING_SPEEDS)


@dataclass(frozen=True, slots=True)
class Total:
    """Equation 26 of the plunger at a pressure and speed.

    Parameters
    ----------
    pressure, speed : [Pa], [m/s]
    parts : secant damping of every part by its name [N s/m]
    ring_range : damping of the back-up ring at the least and largest contact pressure [N s/m]
    """

    pressure: float
    speed: float
    parts: dict[str, float]
    ring_range: tuple[float, float]

    @property
    def damping(self) -> float:
        """B = (seals + back-up rings + chamber)/U [N s/m]."""
        return sum(self.parts.values())

    @property
    def seals(self) -> float:
        """Damping of the seals alone [N s/m]."""
        return sum(value for name, value in self.parts.items() if name not in (BACK_UP, CHAMBER))

    def share(self, name: str) -> float:
        """Of a part in the total."""
        return self.parts[name] / self.damping

    @property
    def beside_share(self) -> float:
        """Of back-up ring, at its largest, and chamber, over the seals."""
        return (max(self.ring_range) + self.parts[CHAMBER]) / self.seals


BACK_UP, CHAMBER = "back-up ring", "chamber"


def total(found: Sealings, mapped: FilmMap, pressure: float, speed: float) -> Total:
    """Equation 26 at a point of the plunger's map."""
    i, j = mapped.at(pressure, speed)
    labels = [ring.label.replace("rod ", "") for ring in found.plunger.rings]
    elastic = ring_elastic(found)
    ring = back_up_ring(found.lubricant, elastic, speed)
    ends = [back_up_ring(found.lubricant, elastic, speed, q).damping for q in CONTACT_PRESSURES]
    forces = dict(zip(labels, map(float, mapped.parts[i, j]), strict=True))
    forces |= {BACK_UP: ring.drag, CHAMBER: chamber_drag(speed)}
    parts = {name: float(secant(friction=force, speed=speed)) for name, force in forces.items()}
    return Total(pressure, speed, parts, (ends[0], ends[1]))


def dry_ring(found: Sealings) -> float:
    """Friction of the back-up ring without oil, by the PTFE's dry coefficient [N]."""
    coefficient = found.plunger.rings[0]["asperity_friction"]
    return float(pi * PAPER.plunger * WIDTH * CONTACT_PRESSURE * coefficient)


def chamber_drag(speed: float) -> float:
    """Equation 24 and 25 with the member of `huang_published.chamber` that has reasons."""
    member = plausible_chamber()
    coefficient = flat_gap(
        dynamic_viscosity=member.viscosity,
        diameter=PAPER.plunger,
        length=member.length,
        gap=member.gap,
    )
    return float(coefficient) * speed
