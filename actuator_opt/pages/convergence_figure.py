"""How a search went: objective and worst missed limit of the best design so far, as ink."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..metrics import of_metric
from ..rendering.axes import Axes, Ticks, fitted, ticks
from ..rendering.ink import BLUE, GREY, RED, Ink, text_width
from ..rendering.text import number, trimmed, unit_text

MET = 1e-6
"""Largest miss of a limit that counts as met (contract)."""
_WIDTH, _HEIGHT, _PANEL, _TALL = 180.0, 70.0, 66.0, 44.0
_LOWEST = -6.0
"""Decade at which a limit counts as met, the bottom of the right panel."""


def convergence_figure(
    trace: Sequence[Sequence[float]], metric: str, evaluations: int, title: str
) -> Ink:
    """Improvements (evaluation, objective in SI, worst violation) over the evaluations made.

    Open circles miss a limit, filled ones meet all; the line goes on to the last evaluation.
    """
    ink = Ink(_WIDTH, _HEIGHT)
    ink.text(4.0, 3.0, fitted(title, 116.0, 8.0), size=8.0, bold=True)
    if not trace:
        ink.text(4.0, 12.0, "No search: nothing could move.", size=7.0, color=GREY)
        return ink
    ink.text(_WIDTH - 4.0, 3.0, "open: a limit is missed, filled: all are met", anchor="right",
             color=GREY)  # fmt: skip
    quantity = of_metric(metric)
    counts = [max(float(row[0]), 1.0) for row in trace]
    values = [quantity.to_display(float(row[1])) for row in trace]
    missed = [float(row[2]) for row in trace]
    last = max(float(evaluations), counts[-1], 2.0)
    across = (0.0, math.log10(last))
    low, high = min(values), max(values)
    room = 0.08 * (high - low) or 0.08 * abs(high) or 1.0
    unit = unit_text(quantity.unit)
    name = f"{quantity.label}, {unit}" if unit else quantity.label
    box = (20.0, 15.0, _PANEL, _TALL)
    axes = Axes(ink, box, across, (low - room, high + room))
    axes.frame_at(
        fitted(name[:1].upper() + name[1:], _PANEL, 7.0), "evaluations", _counts(last),
        [(y, trimmed(y)) for y in ticks(low - room, high + room, 5)], upright=True,
    )  # fmt: skip
    _steps(axes, counts, values, missed, last)
    _end(axes, values[-1], number(values[-1], 5), BLUE)
    heights = [max(math.log10(m), _LOWEST) if m > 0 else _LOWEST for m in missed]
    top = max(math.ceil(max(heights)), -1)
    right = Axes(ink, (112.0, 15.0, 62.0, _TALL), across, (_LOWEST, float(top)))
    decades = range(int(_LOWEST), top + 1, 1 if top <= 0 else 2)
    words = [(float(k), "met" if k == _LOWEST else f"{100 * 10.0**k:g} %") for k in decades]
    right.frame_at("Worst limit missed by", "evaluations", _counts(last), words, upright=True)
    _steps(right, counts, heights, missed, last)
    return ink


def _counts(last: float) -> Ticks:
    """Ticks of a logarithmic axis from 1 to `last` evaluations: 1, 2, 5 of few decades."""
    decades = math.ceil(math.log10(last)) + 1
    steps = (1, 2, 5) if decades <= 4 else (1,)
    found = [m * 10**k for k in range(decades) for m in steps if m * 10**k <= last]
    return [(math.log10(n), f"{n:g}") for n in found]


def _steps(
    axes: Axes, counts: Sequence[float], ys: Sequence[float], missed: Sequence[float], last: float
) -> None:
    """A staircase: each value holds until the next improvement."""
    points = []
    for k, (count, y) in enumerate(zip(counts, ys, strict=True)):
        after = counts[k + 1] if k + 1 < len(counts) else last
        points += [(axes.x(math.log10(count)), axes.y(y)), (axes.x(math.log10(after)), axes.y(y))]
    axes.ink.line(*points, stroke=BLUE, pen=0.35)
    for count, y, miss in zip(counts, ys, missed, strict=True):
        met = miss <= MET
        place = (axes.x(math.log10(count)), axes.y(y))
        axes.ink.circle(*place, 0.8, fill=BLUE if met else "#ffffff", stroke=BLUE if met else RED,
                        pen=0.25)  # fmt: skip


def _end(axes: Axes, value: float, words: str, color: str) -> None:
    """The last value in words over the end of its line, clear of the frame's top."""
    x, y = axes.left + axes.width, axes.y(value)
    above = y - 3.0 if y - 3.0 > axes.top + 1.5 else y + 3.0
    left = x - text_width(words, 6.5)
    axes.ink.text(max(left, axes.left + 1.0), above, words, color=color, halo=True)
