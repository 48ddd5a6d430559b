"""Scatter as ink: margins of every requirement over the draws, and tornados of single inputs."""

from __future__ import annotations

import math

from ..rendering import text
from ..rendering.axes import Axes, fitted, ticks
from ..rendering.ink import BLACK, BLUE, GREY, RED, Ink
from ..uncertainties.result import LimitYield, Swing, Uncertainty
from . import uncertainty_rows as rows
from .tornado import LIGHT, MOST, Bar, bars

ROW, NAMES, HOLDS = 5.4, 46.0, 22.0
"""Height of a row, room for names at the left and for probabilities at the right (mm)."""
LOWEST, HIGHEST = -0.6, 1.0
"""Margins drawn at most; what lies beyond ends at the frame with an arrow."""


def shown(found: Uncertainty) -> list[LimitYield]:
    """Requirements and failing checks, the most endangered first."""
    failing = [one for one in found.checks if one.rate.value < 1]
    return [*found.required, *failing][:MOST]


def margins_figure(found: Uncertainty, *, width: float = 180.0) -> Ink:
    """A strip per requirement: 1 to 99 % as a line, 5 to 95 % as a box, median, design."""
    lines = shown(found)
    top = 9.0
    ink = Ink(width, top + ROW * max(len(lines), 1) + 10.0)
    known = [x for one in lines for x in (*one.margins, one.margin) if x is not None]
    low = max(min([*known, 0.0]), LOWEST)
    high = min(max([*known, 0.02]), HIGHEST)
    room = 0.04 * (high - low)
    box = (NAMES, top, width - NAMES - HOLDS, ROW * max(len(lines), 1))
    axes = Axes(ink, box, (100 * (low - room), 100 * (high + room)), (0.0, 1.0))
    places = [(x, text.trimmed(x)) for x in ticks(*axes.x_range, 8)]
    axes.frame_at("", "margin, % of the limit", places, [], upright=True)
    zero = axes.x(0.0)
    ink.line((zero, top - 1.0), (zero, top + box[3]), pen=0.35, stroke=RED)
    ink.text(zero, top - 2.6, "limit", size=6.5, anchor="center", color=RED, bold=True)
    _key(ink, top)
    ink.text(width, top - 2.6, "holds", size=6.5, anchor="right", color=GREY)
    for index, one in enumerate(lines):
        _strip(ink, axes, top + ROW * (index + 0.5), one, width)
    return ink


def _key(ink: Ink, top: float) -> None:
    """What box, line and circle mean."""
    y = top - 6.4
    ink.line((0.0, y), (8.0, y), pen=0.3)
    ink.box(2.0, y - 1.1, 4.0, 2.2, fill=LIGHT, pen=0.15)
    ink.line((4.0, y - 1.1), (4.0, y + 1.1), pen=0.5, stroke=BLUE)
    ink.text(9.5, y, "1, 5, 50, 95 and 99 % of the draws", size=6.5)
    ink.circle(62.0, y, 0.8, fill=BLACK, pen=0.1)
    ink.text(64.0, y, "as it stands", size=6.5)


def _strip(ink: Ink, axes: Axes, y: float, one: LimitYield, width: float) -> None:
    name = fitted(one.name, NAMES - 2.0, 6.5)
    ink.text(NAMES - 1.6, y, name, size=6.5, anchor="right", bold=one.required)
    left, right = axes.left, axes.left + axes.width

    def place(margin: float | None) -> float:
        if margin is None:
            return left
        return min(max(axes.x(100 * max(min(margin, 1e3), -1e3)), left), right)

    p1, p5, p50, p95, p99 = (place(x) for x in one.margins)
    ink.line((p1, y), (p99, y), pen=0.3)
    ink.box(p5, y - 1.4, max(p95 - p5, 0.1), 2.8, fill=LIGHT, pen=0.15)
    ink.line((p50, y - 1.4), (p50, y + 1.4), pen=0.5, stroke=BLUE)
    for edge, inner, beyond in (
        (left, left + 2.0, _below(one.margins[0], axes)),
        (right, right - 2.0, _above(one.margins[-1], axes)),
    ):
        if beyond:
            ink.arrow((edge, y), (inner, y), length=1.6, color=GREY)
    if one.margin is not None and axes.x_range[0] <= 100 * one.margin <= axes.x_range[1]:
        ink.circle(place(one.margin), y, 0.8, fill=BLACK, pen=0.1)
    colour = BLACK if one.rate.value > 0.5 else RED
    ink.text(width, y, rows.percent(one.rate.value), size=6.5, anchor="right", color=colour)


def _below(margin: float | None, axes: Axes) -> bool:
    return margin is None or 100 * margin < axes.x_range[0]


def _above(margin: float | None, axes: Axes) -> bool:
    return margin is not None and 100 * margin > axes.x_range[1]


def tornado(found: Uncertainty, output: str, *, width: float = 180.0) -> Ink | None:
    """Bars of one output at the 95 % (dark) and 5 % (light) points of every input that matters."""
    ranked, _ = found.of_output(output)
    ends = {one.path: one for one in found.of_output(output)[1]}
    centre = found.nominal[output]
    if centre is None:
        return None
    metric = output in found.units
    quantity = text.metric(output) if metric else None
    factor = 100.0 if quantity is None else quantity.to_display(1.0) - quantity.to_display(0.0)
    matter = [x for x in ranked if (x.total or 0.0) >= rows.LEAST_SHARE][: rows.SHOWN]
    lines = []
    for one in matter:
        shares = (_share(one.first), _share(one.total))
        changes = _changes(ends[one.path], centre, factor)
        lines.append(Bar(one.path, changes, shares))
    if not lines or all(change is None for line in lines for change in line.changes):
        return None
    unit = "% of the limit" if quantity is None else text.unit_text(quantity.unit)
    label = f"change of the margin of {output}" if quantity is None else quantity.label
    return bars(
        lines,
        axis=f"{label}, {unit}" if quantity is None else f"change of {label}, {unit}",
        centre=f"as it stands {rows.value(found, output, centre)}",
        ends=("95 %", "5 %"),
        columns=("alone", "with others"),
        width=width,
    )


def _changes(one: Swing, centre: float, factor: float) -> tuple[float | None, float | None]:
    """Changes at the upper and the lower end, in display units."""

    def change(value: float | None) -> float | None:
        if value is None or not math.isfinite(value):
            return None
        return factor * (value - centre)

    return change(one.at_95), change(one.at_5)


def _share(index: float | None) -> str:
    if index is None:
        return text.DASH
    return f"{max(100 * index, 0.0):.0f} %"
