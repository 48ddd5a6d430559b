"""A duty cycle of a design for the page: traces over time, force over speed, energies."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from ..base.errors import Diagnostic, UsageError, remedy, shown
from ..evaluation import Evaluation
from ..evaluation.duty_cycles.study import CycleStudy, DutyStudy
from ..pages.duty_figures import (
    ANGLE,
    CYCLE,
    ENERGY,
    FORCE,
    OPENING,
    SPEED,
    TORQUE,
    balance_of,
    efficiency_of,
    planes,
    strips,
    time_of,
    trace_of,
    value_of,
)
from ..rendering.axes import even_range, time_words
from ..rendering.chart import Panel, known

Rows: TypeAlias = npt.NDArray[np.intp]
"""Indices of samples."""
MOST = 400
"""Largest number of samples that are sent, about: as many as a curve on a screen shows (our
choice). Samples with an extreme value are kept."""
DIGITS = 6
"""Significant digits of a coordinate."""
_TOLD = (
    ("joint at {}", "angle", ANGLE), ("torque {}", "torque", TORQUE), ("force {}", "force", FORCE),
    ("speed {}", "speed", SPEED), ("force reserve {}", "reserve", FORCE),
    ("valve {} open", "opening", OPENING), ("{} of the supply pressure needed", "share", OPENING),
)  # fmt: skip
"""Content of the text at a sample: words, trace and quantity."""


def drawn(evaluation: Evaluation, name: str) -> dict[str, Any]:
    """A duty cycle as plain data, in display units.

    Parameters
    ----------
    evaluation : the design
    name : name of the cycle

    Raises
    ------
    UsageError : the design states no such cycle
    """
    study = evaluation.duty
    cycles = {} if study is None else {cycle.name: cycle for cycle in study.cycles}
    if study is None or name not in cycles:
        message = f'"{shown(name)}" is no duty cycle of the design'
        raise UsageError(Diagnostic(message, remedy(name, cycles)))
    cycle = cycles[name]
    rows = _kept(cycle)
    reserve = cycle.worst["reserve"]
    label, factor = time_words(float(np.ptp(cycle.time)))
    return {
        "name": name,
        "time": _rounded(factor * cycle.time[rows]),
        "seconds": float(np.ptp(cycle.time)),
        "told": [_told(cycle, int(row)) for row in rows],
        "strips": [_panel(x, rows, label) for x in strips(study, cycle)],
        "planes": [_panel(x, rows) for x in planes(study, cycle)],
        "reserve": {
            "sample": int(np.searchsorted(rows, reserve.sample)),
            "text": f"least force reserve {value_of(FORCE, reserve.value)} "
            f"at {time_of(cycle, reserve.sample)}",
        },
        "energies": [
            {"name": words, "value": value, "text": value_of(ENERGY, abs(value))}
            for words, value in balance_of(cycle)
        ],
        "efficiency": efficiency_of(cycle),
        "limit": _limit(study),
    }


def _limit(study: DutyStudy) -> str:
    """Meaning of the shaded area of the plane."""
    if study.opening_limit is None:
        return "Shaded: loads that the supply moves; the design states no valve."
    share = value_of(OPENING, study.opening_limit)
    return (
        f"Shaded: loads that the supply moves with the valve at most {share} open. "
        "Dashed: at this opening, and fully open."
    )


def _kept(cycle: CycleStudy) -> Rows:
    """The samples that are sent, in order; those with a worst result are among them."""
    record = cycle.record
    kept = np.isin(record.time, record.thinned(MOST).time)
    kept[[sample.sample for sample in cycle.worst.values()]] = True
    return np.flatnonzero(kept)


def _told(cycle: CycleStudy, row: int) -> str:
    """Time and state at a sample in words."""
    words = [time_of(cycle, row)]
    for name, key, quantity in _TOLD:
        values = trace_of(cycle, key)
        if values is not None and math.isfinite(values[row]):
            words.append(name.format(value_of(quantity, float(values[row]))))
    return ", ".join(words)


def _panel(panel: Panel, rows: Rows, time: str = "") -> dict[str, Any]:
    """A panel of the report; of a curve along the cycle, only some samples.

    `time` is the label of the time axis; empty for force over speed, where other curves are limits.
    """

    def some(values: Iterable[float], *, along: bool) -> list[float | None]:
        array = np.asarray(list(values), dtype=float)
        return _rounded(array[rows] if along else array)

    curves = []
    for curve in panel.curves:
        along = bool(time) or curve.style == CYCLE
        curves.append(
            {
                "words": curve.words,
                "along": along,
                "xs": some(curve.xs, along=along),
                "ys": some(curve.ys, along=along),
                "low": some(curve.low, along=False),
                "high": some(curve.high, along=False),
            }
        )
    levels = [x for x in panel.levels if not x.upright]
    shown_values = [float(y) for curve in panel.curves for y in curve.ys]
    values = known([*shown_values, *(x.value for x in levels)])
    across = known(float(x) for curve in panel.curves for x in curve.xs)
    return {
        "title": panel.title,
        "label": time or panel.x.label,
        "x": list(panel.x.range or (min(across), max(across))),
        "y": list(panel.y.range or even_range(values, zero=panel.y.zero)),
        "curves": curves,
        "levels": [{"value": x.value, "words": x.words, "limit": bool(x.sense)} for x in levels],
        "points": [
            {"x": x, "y": y, "words": words}
            for points in panel.points
            for x, y, words in zip(points.xs, points.ys, points.labels, strict=True)
        ],
    }


def _rounded(values: Sequence[float] | np.ndarray[Any, Any]) -> list[float | None]:
    """Coordinates with a few digits; None instead of NaN and infinity."""
    return [
        float(f"{value:.{DIGITS}g}") if math.isfinite(value) else None
        for value in map(float, values)
    ]
