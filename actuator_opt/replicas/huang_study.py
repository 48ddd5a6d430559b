"""Everything the [Huang2017] pages of a report show, computed once for a design."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..design.material_fits import fit_double_exponential, fit_power_law
from ..design.model import Design
from ..models.friction import HUANG_TABLE_2
from ..studies.film_walk import FilmMap
from . import huang, huang_parts, huang_published, huang_trend
from .huang import CylinderMap, Sealings
from .huang_parts import RingFilm, Total
from .huang_published import PAPER, CurveFits
from .huang_readings import Readings, readings
from .huang_trend import Kind, Profile, Relief, Stress, Turn

RELIEFS = (3e-3, 3.7e-3)
"""Reliefs that are drawn beside the design's, the one that turns the trend and a longer one (m)."""
BEYOND = (1.08, 1.16)
"""Reliefs beyond the turning one, over it."""
TOTALS = tuple((p, v) for p in huang_trend.ENDS for v in (0.5e-3, 10e-3))
"""Pressures and speeds at which every part of eq. 26 is shown."""


@dataclass(frozen=True, slots=True, eq=False)
class HuangStudy:
    """Both tests on films, and the paper's own curves.

    Parameters
    ----------
    sealings : rings, oil
    cylinder, plunger, fast : maps of test A, of test B, and of test B beyond its speeds
    published, films : fits of table 2 and of the plunger's map, by pressure; without those that
        lack a film somewhere
    rings, totals : of the back-up ring, of eq. 26
    kinds, stress, profiles : of the seal types and of the step ring
    turn, reliefs : None and empty where the first rod seal is no step ring
    readings : what the paper's letters would do
    whole, drained : rise of the plunger's damping by relief, tandem and without pressure between
    """

    sealings: Sealings
    cylinder: CylinderMap
    plunger: FilmMap
    fast: FilmMap
    published: tuple[CurveFits, ...]
    films: tuple[tuple[float, CurveFits], ...]
    rings: tuple[RingFilm, ...]
    totals: tuple[Total, ...]
    kinds: tuple[Kind, ...]
    stress: Stress
    profiles: tuple[Profile, ...]
    readings: Readings
    turn: Turn | None
    reliefs: tuple[Relief, ...]
    whole: tuple[float, ...]
    drained: tuple[float, ...]


def study(design: Design) -> HuangStudy:
    """Both tests with the seals of a design."""
    found = huang.sealings(design)
    plunger = huang.plunger_map(found)
    turn, reliefs, whole, drained = _reliefs(found)
    return HuangStudy(
        sealings=found,
        cylinder=huang.cylinder_map(found),
        plunger=plunger,
        fast=huang.fast_map(found),
        published=tuple(map(huang_published.fitted, HUANG_TABLE_2)),
        films=_fitted(plunger),
        rings=huang_parts.ring_films(found),
        totals=tuple(huang_parts.total(found, plunger, p, v) for p, v in TOTALS),
        kinds=huang_trend.kinds(found, plunger),
        stress=huang_trend.stress(found),
        profiles=huang_trend.profiles(found),
        readings=readings(found),
        turn=turn,
        reliefs=reliefs,
        whole=whole,
        drained=drained,
    )


def _fitted(mapped: FilmMap) -> tuple[tuple[float, CurveFits], ...]:
    """Both laws through every pressure of a map."""
    fits = []
    for row in HUANG_TABLE_2:
        i, _ = mapped.at(row.pressure, PAPER.speeds[0])
        curve = mapped.damping[i]
        if np.all(np.isfinite(curve)):
            power = fit_power_law(mapped.speeds, curve)
            both = CurveFits(row, power, fit_double_exponential(mapped.speeds, curve))
            fits.append((row.pressure, both))
    return tuple(fits)


def _reliefs(
    found: Sealings,
) -> tuple[Turn | None, tuple[Relief, ...], tuple[float, ...], tuple[float, ...]]:
    """What other reliefs of the step ring do to the trend over pressure."""
    ring = found.plunger.rings[0]
    if "relief" not in ring.numbers:
        return None, (), (), ()
    turn = huang_trend.turn(found)
    wanted = {*RELIEFS, ring["relief"]}
    if np.isfinite(turn.relief):
        wanted |= {turn.relief, *(turn.relief * share for share in BEYOND)}
    lengths = [one for one in sorted(wanted) if one < 0.93 * ring["width"]]
    two = len(found.plunger.rings) == 2
    return (
        turn,
        tuple(huang_trend.with_relief(found, one) for one in lengths),
        tuple(huang_trend.tandem_rise(found, one) for one in lengths) if two else (),
        tuple(huang_trend.drained_rise(found, one) for one in lengths) if two else (),
    )
