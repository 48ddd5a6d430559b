"""Figures of a calibration: friction measured beside both designs, and margins that moved."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..identification.points import Point, by_pressure
from ..optimisation.redesign import Redesign, Shift
from ..rendering.axes import (
    Axes,
    Box,
    dot,
    error_bar,
    even_range,
    even_ticks,
    fitted,
    legend,
    level_ticks,
    log_range,
    ticks,
)
from ..rendering.ink import BLACK, BLUE, GREY, WHITE, Ink, spread_within
from ..rendering.text import trimmed, unit_text
from ..studies.bench import Bench
from .identification_axes import IN, OUT, SURE, ways
from .identification_rows import FORCE, SPEED
from .wall_figures import OCHRE

WIDTH, HEIGHT = 180.0, 64.0
_STATED: dict[str, Any] = {"stroke": OCHRE, "pen": 0.35, "dash": (1.6, 0.8)}
_MEASURED: dict[str, Any] = {"stroke": BLUE, "pen": 0.45}
MOST_LEVELS, MOST_ROWS = 3, 9
"""Levels of pressure and requirements that are drawn (a choice: what the eye parts)."""


def calibration_figure(
    points: Sequence[Point], stated: Bench, measured: Bench, changes: Redesign
) -> Ink:
    """Friction over speed (left) and the margins before and after (right)."""
    ink = Ink(WIDTH, HEIGHT)
    _friction(ink, (12.0, 9.5, 68.0, HEIGHT - 19.0), points, stated, measured)
    _margins(ink, (132.0, 9.5, 47.0, HEIGHT - 19.0), changes)
    return ink


def shown_levels(points: Sequence[Point]) -> list[list[Point]]:
    """Points of like pressure, the lowest first; of many levels the ends and the middle."""
    groups = by_pressure(points)
    if len(groups) <= MOST_LEVELS:
        return groups
    return [groups[0], groups[len(groups) // 2], groups[-1]]


def _friction(ink: Ink, box: Box, points: Sequence[Point], stated: Bench, measured: Bench) -> None:
    """Points with their bars; curves of the design before and after at each pressure."""
    groups = shown_levels(points)
    drawn = []
    for group in groups:
        speeds = np.geomspace(
            min(one.speed for one in group) / 1.2, 1.2 * max(one.speed for one in group), 60
        )
        first, second = (np.full(60, np.mean([one[k] for one in group])) for k in (2, 3))
        for bench, style in ((stated, _STATED), (measured, _MEASURED)):
            level, viscous = bench.sliding(speeds, first, second)
            drawn.append((speeds, level + viscous, style, group))
    shown = [one for group in groups for one in group]
    forces = [_force(one) + side * SURE * one.error for one in shown for side in (-1, 1)]
    forces += [float(f) for _, curve, _, _ in drawn for f in curve]
    across = log_range([SPEED.to_display(float(v)) for xs, _, _, _ in drawn for v in xs])
    axes = Axes(ink, box, across, even_range(forces, zero=True))
    axes.frame_at(
        "",
        f"speed, {unit_text(SPEED.unit)}",
        level_ticks(*across),
        even_ticks(*axes.y_range, 5),
        upright=True,
    )
    title = f"Friction over speed, {unit_text(FORCE.unit)}"
    ink.text(box[0] - 1.4, box[1] - 6.2, title, size=7.0, bold=True)
    legend(ink, box[0] + box[2], box[1] - 2.4,
           [("design as stated", _STATED), ("as measured", _MEASURED)])  # fmt: skip
    for xs, ys, style, _ in drawn:
        places = [math.log10(SPEED.to_display(float(v))) for v in xs]
        ink.path(axes.clipped(places, [float(y) for y in ys]), **style)
    for one in shown:
        x, style = math.log10(SPEED.to_display(one.speed)), OUT if one.velocity > 0 else IN
        half = SURE * one.error
        error_bar(axes, x, _force(one) - half, _force(one) + half, style["color"])
        dot(axes, x, _force(one), **style)
    if len(groups) > 1:
        ends = [(float(ys[-1]), group) for _, ys, style, group in drawn if style is _MEASURED]
        wanted = [axes.y(force) for force, _ in ends][::-1]
        low, high = box[1] + 1.5, box[1] + box[3] - 1.5
        places = spread_within(wanted, [3.0] * len(wanted), low, high)
        for (_, group), y in zip(ends[::-1], places, strict=True):
            level = round(float(np.mean([one.pressure for one in group])) / 1e5)
            ink.text(box[0] + box[2] + 1.5, y, f"{level} bar", color=GREY)
    ways(ink, box[0], box[1] - 2.4, shown)


def _force(one: Point) -> float:
    """Friction against the motion [N]."""
    return math.copysign(1.0, one.velocity) * one.friction


def _margins(ink: Ink, box: Box, changes: Redesign) -> None:
    """Margins of the requirements that moved: before hollow, after filled with its bounds."""
    title = "Margin of requirements, as tested, %"
    moved = sorted((one for one in changes.shifts if one.move != 0), key=lambda o: -abs(o.move))
    moved = moved[:MOST_ROWS]
    ink.text(box[0] - 36.0, box[1] - 6.2, title, size=7.0, bold=True)
    if not moved:
        ink.text(box[0] - 36.0, box[1] + 4.0, "No requirement moved.", color=GREY)
        return
    left, top, width, height = box
    spans = [_span(one) for one in moved]
    values = [v for span in spans for v in span] + [0.0]
    low, high = even_range(values)
    row = min(height / len(moved), 12.0)
    tall = row * len(moved)
    axes = Axes(ink, (left, top, width, tall), (low, high), (0.0, 1.0))
    axes.frame_at("", "margin, %", [(v, trimmed(v)) for v in ticks(low, high, 5)], [], upright=True)
    ink.line((axes.x(0.0), top), (axes.x(0.0), top + tall), stroke=GREY, pen=0.25)
    for k, (one, (before, after, below, above)) in enumerate(zip(moved, spans, strict=True)):
        y = top + (k + 0.5) * row
        ink.text(left - 2.0, y, fitted(one.after.name, 34.0), anchor="right")
        ink.line((axes.x(before), y), (axes.x(after), y), stroke=GREY, pen=0.2)
        ink.line((axes.x(below), y), (axes.x(above), y), stroke=BLUE, pen=0.8)
        ink.circle(axes.x(before), y, 1.0, fill=WHITE, stroke=OCHRE, pen=0.35)
        ink.circle(axes.x(after), y, 1.0, fill=BLUE, stroke=BLACK, pen=0.2)
    x = left - 36.0
    for words, fill, stroke in (
        ("as stated", WHITE, OCHRE),
        ("as measured, bar: 95 %", BLUE, BLACK),
    ):
        ink.circle(x + 1.0, box[1] - 2.4, 0.9, fill=fill, stroke=stroke, pen=0.3)
        ink.text(x + 3.0, box[1] - 2.4, words)
        x += 18.0


def _span(one: Shift) -> tuple[float, float, float, float]:
    """Margins before and after, and its bounds [%]."""
    before, after = (100 * (row.margin or 0.0) for row in (one.before, one.after))
    if one.lower is None or one.upper is None or one.after.limit == 0:
        return before, after, after, after
    sign = 1.0 if one.after.sense == "min" else -1.0
    limit = one.after.limit
    ends = sorted(100 * sign * (v - limit) / abs(limit) for v in (one.lower, one.upper))
    return before, after, ends[0], ends[1]
