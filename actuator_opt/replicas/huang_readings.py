"""Places where [Huang2017] cannot be taken by its letters, each with what taking it so would do.

Eq. 14 and 15 lack the rigid shift of the seal, though eq. 12 asks for a balance of loads that only
a shift can close. The text below eq. 4 calls "a" the seal and gives it the rod's speed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import nan, pi

import numpy as np

from ..evaluation.film import FilmRow, solve
from ..models.rough_surface import asperity_pressure
from .huang import Sealings
from .huang_trend import FILM_SPEED

PRESSURE = 6e6
"""Sealed pressure of both readings; the speed is that of the film profiles (Pa)."""


@dataclass(frozen=True, slots=True)
class Readings:
    """The step ring of the plunger, alone; NaN without a film.

    Parameters
    ----------
    shift : rigid shift of the solved film [m]
    mean : its mean film [m]
    excess : (carried - given load)/given load if the film were thinner by the shift
    flow, swapped : oil dragged outwards with the rough side the seal, or the rod [m^3/s]
    """

    shift: float
    mean: float
    excess: float
    flow: float
    swapped: float


def readings(found: Sealings) -> Readings:
    """What the missing shift and the swapped sides would do, of the plunger's first seal."""
    row = found.plunger.alone(0).row(PRESSURE, FILM_SPEED)
    solved, other = solve(row), solve(_swapped(row))
    if solved.why or other.why:
        return Readings(nan, nan, nan, nan, nan)
    film = solved.films[0]
    contact, around = film.contact, pi * row.rings[0]["diameter"]
    surface, elastic = contact.surface, contact.elastic
    thinner = (film.film - film.rigid_shift) / surface.roughness
    carried = film.pressure + asperity_pressure(
        film_ratio=np.maximum(thinner, 0.0),
        youngs_modulus=elastic.youngs_modulus,
        poissons_ratio=elastic.poissons_ratio,
        asperity_density=surface.asperity_density,
        asperity_radius=surface.asperity_radius,
        roughness=surface.roughness,
    )
    loads = [float(np.trapezoid(one, film.x)) for one in (carried, contact.static_pressure)]
    return Readings(
        shift=film.rigid_shift,
        mean=film.mean_film,
        excess=loads[0] / loads[1] - 1,
        flow=around * film.flow,
        swapped=around * other.films[0].flow,
    )


def _swapped(row: FilmRow) -> FilmRow:
    """The same surfaces, the rough one on the rod: the composite roughness stays."""
    rings = [
        ring.at(
            seal_roughness=ring["counterface_roughness"],
            counterface_roughness=ring["seal_roughness"],
        )
        for ring in row.rings
    ]
    return replace(row, rings=tuple(rings))
