"""Stiffness over the stroke of the best designs of a sweep, and their differences."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from ...base.errors import Diagnostic, InputError
from ...evaluation import evaluate
from ...evaluation.result import StrokeCurve
from ...rendering.axes import COLOURS, DASHES, Axes, even_range, even_ticks
from ...rendering.heights import wrap
from ...rendering.ink import GREY, RED, Ink, spread_within
from ...rendering.text import limit_text, margin_text
from .shared import SweepFigure, SweepFigureData, fits, heading, value_words

MOST = 6
"""Most curves (a choice: more are hard to distinguish)."""


SIZE = 6.3


STYLES: tuple[dict[str, Any], ...] = tuple(
    {"stroke": colour, "pen": 0.45, "dash": dash}
    for colour, dash in zip(COLOURS, DASHES, strict=False)
)


Points: TypeAlias = tuple[list[float], list[float]]
"""Positions (mm) and stiffness (kN/mm)."""


_LEFT, _WIDE, _TALL, _LOW, _STEP = 14.0, 132.0, 78.0, 32.0, 44.0


class Required(NamedTuple):
    """A required stiffness [N/m], and its words in the figure."""

    stiffness: float
    words: str


def curves_drawn(
    ink: Ink,
    top: float,
    curves: Sequence[StrokeCurve],
    labels: Sequence[str],
    required: Sequence[Required],
    first: str,
) -> float:
    """Draw at most `MOST` curves, each with its label at its end; the height they end at.

    Below them stand the differences from the first curve, named `first`: curves of similar designs
    nearly coincide. At least one curve must have a finite point.
    """
    points = [_points(curve) for curve in curves]
    axes = _frame(ink, top, points, required)
    ends = []
    for (xs, ys), style in zip(points, STYLES, strict=False):
        ink.path(axes.clipped(xs, ys), **style)
        ends.append(axes.y(ys[-1]) if ys else top)
    order = np.argsort(ends, kind="stable").tolist()
    right, gaps = _LEFT + _WIDE, [3.4] * len(order)
    places = spread_within([ends[k] for k in order], gaps, top, top + _TALL - 1.0)
    for k, y in zip(order, places, strict=True):
        last = max(points[k][0], default=0.0)
        if last == axes.x_range[1]:  # shorter strokes end inside, and have their colour
            ink.line((right, ends[k]), (right + 2.5, y), pen=0.13, stroke=GREY)
        ink.text(right + 3.2, y, labels[k], size=SIZE, color=STYLES[k]["stroke"])
    below = top + _TALL + 14.0
    if len(points) > 1:
        below = differences_drawn(ink, below + 6.0, axes.x_range, points, first) + 14.0
    return below


def has_points(curve: StrokeCurve) -> bool:
    """Whether there is anything to draw of a curve."""
    return bool(_points(curve)[0])


def differences_drawn(
    ink: Ink, top: float, span: tuple[float, float], curves: Sequence[Points], first: str
) -> float:
    """What each curve differs from the first by, where both are; the height it ends at."""
    places, stiffness = map(np.array, curves[0])
    differences = []
    for curve in curves:
        xs, ys = map(np.array, curve)
        both = (xs >= min(places, default=0.0)) & (xs <= max(places, default=0.0))
        beside = np.interp(xs[both], places, stiffness) if both.any() else xs[both]
        differences.append((xs[both].tolist(), (100.0 * (ys[both] / beside - 1.0)).tolist()))
    every = [y for _, ys in differences for y in ys]
    if not every:
        return top
    axes = Axes(ink, (_LEFT, top, _WIDE, _LOW), span, even_range(every))
    axes.frame_at(
        f"Difference from {first}, %", "piston position from the cap end, mm",
        even_ticks(*span, 8), even_ticks(*axes.y_range, 4), upright=True,
    )  # fmt: skip
    for (xs, ys), style in zip(differences, STYLES, strict=False):
        if len(xs) > 1:
            ink.path(axes.clipped(xs, ys), **style)
    return top + _LOW


def _points(curve: StrokeCurve) -> Points:
    """Where it is finite."""
    pairs = [
        (1e3 * float(x), float(k) / 1e6)
        for x, k in zip(curve.position, curve.stiffness, strict=True)
        if math.isfinite(k)
    ]
    return [x for x, _ in pairs], [k for _, k in pairs]


def _frame(ink: Ink, top: float, curves: Sequence[Points], required: Sequence[Required]) -> Axes:
    """Axes that hold the bottom of every curve, with the stiffness required."""
    limits = [limit.stiffness / 1e6 for limit in required]
    ends = [x for xs, _ in curves for x in xs]
    lows = [min(ys) for _, ys in curves if ys] + limits
    high = min(max(k for _, ys in curves for k in ys), 3.0 * max(lows)) * 1.06
    low = max(0.0, min(lows) - 0.12 * (high - min(lows)))
    axes = Axes(ink, (_LEFT, top, _WIDE, _TALL), (min(ends), max(ends)), (low, high))
    axes.frame_at(
        "Axial stiffness, kN/mm", "piston position from the cap end, mm",
        even_ticks(*axes.x_range, 8), even_ticks(low, high, 6), upright=True,
    )  # fmt: skip
    for k, limit in enumerate(required):
        y = axes.y(limit.stiffness / 1e6)
        ink.line((_LEFT, y), (_LEFT + _WIDE, y), stroke=RED, pen=0.3, dash=(1.8, 1.0))
        ink.text(_LEFT + 2.0 + _STEP * k, y + 2.4, limit.words, size=SIZE, color=RED, halo=True)
    return axes


NBSP = "\N{NO-BREAK SPACE}"


def ucurves_figure(drawn: SweepFigureData) -> Ink:
    """The U-curves of the best designs with the stiffness required, and what each of them is.

    Raises
    ------
    InputError
        no feasible design, or none with a stiffness curve
    """
    curves, labels = [], []
    for k, best in enumerate(drawn.bests()[:MOST]):
        design = drawn.study.designs.made(drawn.study.values(best.number))
        curves.append(evaluate(design).curve)
        said = value_words(drawn.goal, float(drawn.goals(drawn.best(k))[0]))
        labels.append(f"{k + 1}: {said}")
    if not any(map(has_points, curves)):
        message = "no stiffness curve: the stroke of these designs was not evaluated"
        raise InputError(Diagnostic(message, "draw another figure"))
    ink = Ink(180.0, 400.0)
    count = len(curves)
    words = "stiffness over the stroke of the best design" + (
        f"s (1 to {count})" if count > 1 else ""
    )
    top = heading(ink, drawn, words, drawn.counts()) + 8.0
    quantity = drawn.study.quantity("stiffness_min")
    required = [
        Required(value, f"required {limit_text(quantity, 'min', value)}")
        for sense, value in drawn.limits_on("stiffness_min")
        if sense == "min"
    ]
    below = curves_drawn(ink, top, curves, labels, required, "design 1")
    ink.height = _key(drawn, ink, below, count)
    return ink


def _key(drawn: SweepFigureData, ink: Ink, y: float, count: int) -> float:
    """What varies in each of the designs."""
    tracks = [drawn.axis(axis.path) for axis in drawn.study.plan.axes]
    for k in range(count):
        rows = drawn.best(k)
        values = [value_words(track, float(drawn.values(track.words, rows)[0])) for track in tracks]
        said = [
            f"{track.words} {value}".replace(" ", NBSP)
            for track, value in zip(tracks, values, strict=True)
        ]
        ink.line((2.0, y), (8.0, y), **STYLES[k])
        ink.text(9.4, y, f"{k + 1}", size=SIZE, bold=True)
        margin = f"least margin {margin_text(drawn.bests()[k].margin)}".replace(" ", NBSP)
        for line in wrap("; ".join([*said, margin]), 166.0, SIZE):
            ink.text(13.0, y, line, size=SIZE)
            y += 3.5
    return y + 1.0


FIGURE = SweepFigure(
    every=False,
    lines=False,
    check=fits,
    draw=lambda drawn, metrics, chosen: {"ucurves": ucurves_figure(drawn)},
)
