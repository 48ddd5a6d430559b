"""Stiffness over the stroke of the best designs of a sweep."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..design import with_values
from ..errors import Diagnostic, InputError
from ..evaluation import evaluate, prepare
from ..evaluation.result import StrokeCurve
from .fallback import wrap
from .figures import Axes
from .identification_axes import even_range, even_ticks
from .ink import GREY, RED, Ink, spread_within
from .simulation_axes import COLOURS, DASHES
from .sweep_marks import Drawn, heading, value_words
from .text import limit_text, margin_text

MOST = 6
"""Curves (a choice: as many as can be told apart)."""
NBSP = "\N{NO-BREAK SPACE}"
_LEFT, _WIDE, _TALL, _LOW, _SIZE = 14.0, 138.0, 78.0, 32.0, 6.3
STYLES: tuple[dict[str, Any], ...] = tuple(
    {"stroke": colour, "pen": 0.45, "dash": dash}
    for colour, dash in zip(COLOURS, DASHES, strict=False)
)


def ucurves_figure(drawn: Drawn) -> Ink:
    """The U-curves of the best designs with the stiffness required, and what each of them is.

    Raises
    ------
    InputError
        no feasible design, or none with a stiffness curve
    """
    curves = []
    for best in drawn.bests()[:MOST]:
        values = drawn.study.values(best.number)
        design = with_values(drawn.study.design, dict(values))
        found = evaluate(prepare(design, plugins=drawn.study.plugins)).curve
        curves.append(_points(found))
    if not any(len(xs) for xs, _ in curves):
        message = "no stiffness curve: the stroke of these designs was not evaluated"
        raise InputError(Diagnostic(message, "draw another figure"))
    ink = Ink(180.0, 400.0)
    count = len(curves)
    words = "stiffness over the stroke of the best design" + (
        f"s (1 to {count})" if count > 1 else ""
    )
    top = heading(ink, drawn, words, drawn.counts()) + 8.0
    axes = _frame(drawn, ink, top, curves)
    ends = []
    for (xs, ys), style in zip(curves, STYLES, strict=False):
        ink.path(axes.clipped(xs, ys), **style)
        ends.append(axes.y(ys[-1]) if ys else top)
    order = np.argsort(ends, kind="stable").tolist()
    right = _LEFT + _WIDE
    gaps = [3.4] * len(order)
    places = spread_within([ends[k] for k in order], gaps, top, top + _TALL - 1.0)
    for k, y in zip(order, places, strict=True):
        ink.line((right, ends[k]), (right + 2.5, y), pen=0.13, stroke=GREY)
        said = value_words(drawn.goal, float(drawn.goals(drawn.best(k))[0]))
        ink.text(right + 3.2, y, f"{k + 1}: {said}", size=_SIZE, color=STYLES[k]["stroke"])
    below = top + _TALL + 14.0
    if count > 1:
        below = _differences(ink, below + 6.0, axes.x_range, curves) + 14.0
    ink.height = _key(drawn, ink, below, count)
    return ink


def _differences(
    ink: Ink, top: float, span: tuple[float, float], curves: list[tuple[list[float], list[float]]]
) -> float:
    """What each curve differs from the first by, where both are; the height it ends at.

    The best designs of a sweep are often so near that their curves lie on one another.
    """
    places, stiffness = (np.array(one) for one in curves[0])
    found = []
    for curve in curves:
        xs, ys = (np.array(one) for one in curve)
        both = (xs >= min(places, default=0.0)) & (xs <= max(places, default=0.0))
        beside = np.interp(xs[both], places, stiffness) if both.any() else xs[both]
        found.append((xs[both].tolist(), (100.0 * (ys[both] / beside - 1.0)).tolist()))
    every = [y for _, ys in found for y in ys]
    if not every:
        return top
    axes = Axes(ink, (_LEFT, top, _WIDE, _LOW), span, even_range(every))
    axes.frame_at(
        "Difference from design 1, %", "piston position from the cap end, mm",
        even_ticks(*span, 8), even_ticks(*axes.y_range, 4), upright=True,
    )  # fmt: skip
    for (xs, ys), style in zip(found, STYLES, strict=False):
        if len(xs) > 1:
            ink.path(axes.clipped(xs, ys), **style)
    return top + _LOW


def _points(curve: StrokeCurve) -> tuple[list[float], list[float]]:
    """Positions (mm) and stiffness (kN/mm) where it is finite."""
    pairs = [
        (1e3 * float(x), float(k) / 1e6)
        for x, k in zip(curve.position, curve.stiffness, strict=True)
        if math.isfinite(k)
    ]
    return [x for x, _ in pairs], [k for _, k in pairs]


def _frame(
    drawn: Drawn, ink: Ink, top: float, curves: list[tuple[list[float], list[float]]]
) -> Axes:
    """Axes that hold the bottom of every curve, with the stiffness required."""
    limits = [value for sense, value in drawn.limits_on("stiffness_min") if sense == "min"]
    ends = [x for xs, _ in curves for x in xs]
    floor = max([min(ys) for _, ys in curves if ys] + [one / 1e6 for one in limits])
    high = min(max(k for _, ys in curves for k in ys), 3.0 * floor) * 1.06
    lows = [min(ys) for _, ys in curves if ys] + [one / 1e6 for one in limits]
    low = max(0.0, min(lows) - 0.12 * (high - min(lows)))
    axes = Axes(ink, (_LEFT, top, _WIDE, _TALL), (min(ends), max(ends)), (low, high))
    axes.frame_at(
        "Axial stiffness, kN/mm", "piston position from the cap end, mm",
        even_ticks(*axes.x_range, 8), even_ticks(low, high, 6), upright=True,
    )  # fmt: skip
    for value in limits:
        y = axes.y(value / 1e6)
        ink.line((_LEFT, y), (_LEFT + _WIDE, y), stroke=RED, pen=0.3, dash=(1.8, 1.0))
        quantity = drawn.study.quantity("stiffness_min")
        words = f"required {limit_text(quantity, 'min', value)}"
        ink.text(_LEFT + 2.0, y + 2.4, words, size=_SIZE, color=RED, halo=True)
    return axes


def _key(drawn: Drawn, ink: Ink, y: float, count: int) -> float:
    """What varies in each of the designs."""
    tracks = [drawn.axis(axis.path) for axis in drawn.study.plan.axes]
    for k in range(count):
        rows = drawn.best(k)
        values = [value_words(one, float(drawn.values(one.words, rows)[0])) for one in tracks]
        said = [
            f"{track.words} {value}".replace(" ", NBSP)
            for track, value in zip(tracks, values, strict=True)
        ]
        ink.line((2.0, y), (8.0, y), **STYLES[k])
        ink.text(9.4, y, f"{k + 1}", size=_SIZE, bold=True)
        margin = f"least margin {margin_text(drawn.bests()[k].margin)}".replace(" ", NBSP)
        for line in wrap("; ".join([*said, margin]), 166.0, _SIZE):
            ink.text(13.0, y, line, size=_SIZE)
            y += 3.5
    return y + 1.0
