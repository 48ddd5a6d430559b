"""Caveats of a calibrated design: effects left out, and extrapolation."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from ..base.fitting import Parameter
from ..base.numeric import Array
from ..friction.coefficient import STRIBECK_EXPONENT
from ..models import friction
from ..studies.bench import Bench
from .points import Point
from .stribeck_fit import StribeckFit

FARTHER = 1.05
"""Duty relative to the record's speed or pressure that is reported (a choice: less is no
extrapolation)."""
MISFIT = 0.1
"""Deviation of the contact law at other pressures, as a share of F_C, that is reported (a choice: a
third of what makes a parameter weakly identifiable)."""


def of_curve(
    points: Sequence[Point], stribeck: StribeckFit, level: Array, stated: Array
) -> Iterator[str]:
    """Effects that the design's friction omits: an offset, another pressure dependence."""
    offset = stribeck.parameters.get("offset")
    if offset is not None and (offset.lower > 0 or offset.upper < 0):
        yield (
            f"the offset of {offset.value:.3g} N between both directions is not in the design's "
            "friction, which is the mean"
        )
    yield from _shape(points, stribeck)
    apart = level - float(np.mean(level) / np.mean(stated)) * stated
    worst = int(np.argmax(np.abs(apart)))
    share = float(apart[worst] / np.mean(level))
    if abs(share) > MISFIT:
        yield (
            f"the measured friction deviates from the contact law by {100 * share:+.0f} % of F_C "
            f"at {points[worst].pressure / 100000.0:.3g} bar: the factor is a mean over the "
            "record's pressures, and its bounds cover all of them"
        )


def _shape(points: Sequence[Point], stribeck: StribeckFit) -> Iterator[str]:
    """Deviation of the Stribeck exponent from the design's, and the resulting error of friction."""
    found = stribeck.parameters.get("exponent")
    if found is None or found.lower <= STRIBECK_EXPONENT <= found.upper:
        return
    values = {name: stribeck.values[name] for name in ("coulomb", "static", "stribeck_speed")}
    speed = np.array([one.speed for one in points])
    own, other = (
        friction.stribeck_level(speed=speed, exponent=one, **values)
        for one in (found.value, STRIBECK_EXPONENT)
    )
    worst = float(np.max(np.abs(other / own - 1)))
    yield (
        f"the exponent of the Stribeck curve is {found.value:.2f} ({found.lower:.2f} to "
        f"{found.upper:.2f}), but {STRIBECK_EXPONENT:g} in the design: error up to "
        f"{100 * worst:.0f} % at the record's speeds"
    )


def extrapolated(bench: Bench, points: Sequence[Point]) -> Iterator[str]:
    """Duties of the design beyond the record."""
    fastest = max(case.speed for case in bench.design.load_cases)
    speed, pressure = max(one.speed for one in points), max(one.pressure for one in points)
    if fastest > FARTHER * speed or bench.supply_pressure > FARTHER * pressure:
        yield (
            f"the record reaches {1000.0 * speed:.3g} mm/s and {pressure / 100000.0:.3g} bar, "
            f"the design {1000.0 * fastest:.3g} mm/s and {bench.supply_pressure / 100000.0:.3g} "
            "bar: beyond the record friction is extrapolated by contact law and Stribeck curve"
        )


def weak(known: Mapping[str, Parameter]) -> Iterator[str]:
    """Weakly determined numbers."""
    names = [name for name, one in known.items() if not one.identifiable]
    if names:
        yield f"only weakly known (bounds beyond 30 %): {', '.join(names)}"
