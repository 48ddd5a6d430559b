"""Figures of the report as ink: stiffness over the stroke with its compliance contributions.

Readable in black and white: areas differ in lightness, lines in dash, and every curve carries
its own label.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, TypeAlias

from ..evaluation.result import Requirement, StrokeCurve
from .ink import BLACK, BLUE, GREY, PALE, RED, Ink, Point, hatch, spread_within, text_width
from .text import MINUS, number, trimmed

AREAS = (
    "#0b3c5d", "#9ec3da", "#d5e6f0", "#4f86a8", "#f0e2b6", "#b98b3e",
    "#d9c9e3", "#7a5a8c", "#7d868e", "#e3e6e8", "#2b3138",
)  # fmt: skip
"""Fills of stacked areas: distinct in hue for colour-blind eyes, in lightness on a grey print."""
PARTS = (
    "oil A", "oil B", "oil in lines", "barrel", "stretch", "pipes", "hoses", "seals", "rod",
    "mount", "load cell",
)  # fmt: skip
"""Parts of the stiffness budget, each with its own fill in every report."""
Ticks: TypeAlias = Sequence[tuple[float, str]]
"""Places on an axis with what is written there."""


def ticks(low: float, high: float, count: int = 5) -> list[float]:
    """Round tick values inside [low, high], about `count` of them.

    >>> ticks(0.0, 110.0)
    [0.0, 25.0, 50.0, 75.0, 100.0]
    """
    span = high - low
    if not span > 0:
        return [low]
    raw = span / count
    decade = 10.0 ** math.floor(math.log10(raw))
    step = next((m * decade for m in (1, 2, 2.5, 5) if m * decade >= raw * 0.9999), 10 * decade)
    first = math.ceil(low / step - 1e-9)
    last = math.floor(high / step + 1e-9)
    return [round(k * step, 12) + 0.0 for k in range(first, last + 1)]


class Axes:
    """A plot frame on ink; its axes are linear in what they are given (a logarithm, say)."""

    def __init__(
        self,
        ink: Ink,
        box: tuple[float, float, float, float],
        x_range: tuple[float, float],
        y_range: tuple[float, float],
    ) -> None:
        self.ink = ink
        self.left, self.top, self.width, self.height = box
        self.x_range, self.y_range = x_range, y_range

    def x(self, value: float) -> float:
        """Millimetres from the left of the paper."""
        low, high = self.x_range
        return self.left + (value - low) / (high - low) * self.width

    def y(self, value: float) -> float:
        """Millimetres from the top of the paper."""
        low, high = self.y_range
        return self.top + (high - value) / (high - low) * self.height

    def frame(self, title: str, x_label: str) -> None:
        """Grid, ticks, axis labels; the y label stands as the title above the axis."""
        self.frame_at(
            title,
            x_label,
            [(value, trimmed(value)) for value in ticks(*self.x_range, 6)],
            [(value, trimmed(value)) for value in ticks(*self.y_range, 5)],
        )

    def frame_at(
        self, title: str, x_label: str, x_ticks: Ticks, y_ticks: Ticks, *, upright: bool = False
    ) -> None:
        """The same with ticks at stated places; `upright` draws their grid lines too.

        Without an x label the ticks stay without their numbers: another frame stands below.
        """
        bottom = self.top + self.height
        for value, words in y_ticks:
            y = self.y(value)
            self.ink.line((self.left, y), (self.left + self.width, y), stroke=PALE, pen=0.1)
            self.ink.text(self.left - 1.4, y, words, size=6.5, anchor="right")
        for value, words in x_ticks:
            x = self.x(value)
            if upright:
                self.ink.line((x, self.top), (x, bottom), stroke=PALE, pen=0.1)
            self.ink.line((x, bottom), (x, bottom + 1.0), pen=0.13)
            if x_label:
                self.ink.text(x, bottom + 3.0, words, size=6.5, anchor="center")
        self.ink.line(
            (self.left, self.top), (self.left, bottom), (self.left + self.width, bottom), pen=0.18
        )
        middle = self.left + self.width / 2
        if x_label:
            self.ink.text(middle, bottom + 7.0, x_label, size=6.5, anchor="center", color=GREY)
        if title:
            self.ink.text(self.left - 1.4, self.top - 3.6, title, size=7.0, bold=True)

    def clipped(self, xs: Sequence[float], ys: Sequence[float]) -> list[list[Point]]:
        """Polyline on paper, cut where it leaves the top or the bottom of the frame."""
        low, high = self.y_range
        lines: list[list[Point]] = [[]]
        for index, (x, y) in enumerate(zip(xs, ys, strict=True)):
            before = ys[index - 1] if index else y
            for level, beyond in ((low, y < low), (high, y > high))[:: 1 if y > before else -1]:
                outside = before > level if level == high else before < level
                if outside == beyond:
                    continue
                share = (level - before) / (y - before)
                edge = xs[index - 1] + share * (x - xs[index - 1])
                lines[-1].append((self.x(edge), self.y(level)))
                if beyond:
                    lines.append([])
            if low <= y <= high:
                lines[-1].append((self.x(x), self.y(y)))
        return [line for line in lines if len(line) > 1]


def fitted(words: str, room: float, size: float = 6.5) -> str:
    """Words cut with an ellipsis to what fits into `room` mm.

    >>> fitted("weakest position", 12.0)
    'weakest…'
    """
    if text_width(words, size) <= room:
        return words
    while words and text_width(words + "…", size) > room:
        words = words[:-1]
    return words.rstrip() + "…"


def legend(
    ink: Ink,
    x: float,
    y: float,
    entries: Sequence[tuple[str, dict[str, Any]]],
    *,
    ends: bool = True,
) -> None:
    """Names of curves in one line that ends at `x`, or starts there, each after its line."""
    if ends:
        x -= sum(text_width(words, 6.5) + 11.0 for words, _ in entries) - 3.5
    for words, style in entries:
        ink.line((x, y), (x + 6.0, y), **style)
        ink.text(x + 7.5, y, words, size=6.5)
        x += 11.0 + text_width(words, 6.5)


def stiffness_figure(
    curve: StrokeCurve,
    requirement: Requirement | None,
    *,
    width: float = 180.0,
    height: float = 62.0,
) -> Ink:
    """Stiffness over the stroke (left) and the compliances it is made of, stacked (right)."""
    ink = Ink(width, height)
    positions = [1000.0 * float(x) for x in curve.position]
    stiffness = [float(k) / 1e6 for k in curve.stiffness]
    usable = [(x, k) for x, k in zip(positions, stiffness, strict=True) if math.isfinite(k)]
    if len(usable) < 2 or not usable[-1][0] > usable[0][0]:
        ink = Ink(width, 6.0)
        ink.text(0.0, 3.0, "No stiffness curve: the stroke was not evaluated.")
        return ink
    panel = (width - 56.0) / 2
    _stiffness_panel(ink, (9.0, 8.0, panel, height - 18.0), usable, requirement)
    _compliance_panel(ink, (panel + 26.0, 8.0, panel, height - 18.0), curve, positions)
    return ink


def _stiffness_panel(
    ink: Ink,
    box: tuple[float, float, float, float],
    points: Sequence[tuple[float, float]],
    requirement: Requirement | None,
) -> None:
    xs, ys = [x for x, _ in points], [k for _, k in points]
    place, weakest = min(points, key=lambda point: point[1])
    limit = None if requirement is None else requirement.limit / 1e6
    floor = max(weakest, limit or 0.0)
    top = min(max(*ys, 1.15 * floor), 3.0 * floor) * 1.06
    axes = Axes(ink, box, (xs[0], xs[-1]), (0.0, top))
    axes.frame("Axial stiffness, kN/mm", "piston position from the cap end, mm")
    ink.path(axes.clipped(xs, ys), stroke=BLUE, pen=0.45)
    lowest(axes, place, weakest, [] if limit is None else [limit])
    if limit is not None:
        required(axes, limit, f"≥ {trimmed(limit)}")


def lowest(axes: Axes, place: float, value: float, limits: Sequence[float]) -> None:
    """The lowest point of a curve (place in mm) with its words below it, clear of the limits."""
    x, y = axes.x(place), axes.y(value)
    axes.ink.circle(x, y, 0.8, fill=BLUE, stroke="#ffffff", pen=0.2)
    label = f"minimum {number(value)} at {trimmed(place, 3)} mm"
    half = text_width(label, 6.5) / 2
    text_x = min(max(x, axes.left + half + 1.0), axes.left + axes.width - half - 1.0)
    text_y = y + 4.0
    for limit in limits:
        level = axes.y(limit)
        if level > y:
            text_y = max(text_y, level + 3.0) if level - y < 6.5 else y + 3.0
    if text_y > axes.top + axes.height - 1.8:
        text_y = y - 3.4
    axes.ink.text(text_x, text_y, label, anchor="center", halo=True, color=BLUE)


def required(axes: Axes, level: float, words: str) -> None:
    """A limit over the whole frame, named to its right; left out where it is off the frame."""
    if axes.y_range[0] <= level <= axes.y_range[1]:
        right, y = axes.left + axes.width, axes.y(level)
        axes.ink.line((axes.left, y), (right, y), stroke=RED, pen=0.25, dash=(1.8, 1.0))
        axes.ink.text(right + 1.0, y, words, color=RED, anchor="left")


def fills(parts: Sequence[str]) -> list[str]:
    """The fill of each part: its own, or one that no other part has."""
    free = [k for k, name in enumerate(PARTS) if name not in parts]
    own = [PARTS.index(name) if name in PARTS else free.pop(0) if free else 0 for name in parts]
    return [AREAS[k] for k in own]


def per_cent(share: float) -> str:
    """A share in whole per cent, small ones with a decimal.

    >>> per_cent(0.44), per_cent(0.0031), per_cent(0.0002), per_cent(0.0)
    ('44 %', '0.3 %', '< 0.1 %', '0 %')
    """
    size = 100 * abs(share)
    if 0 < size < 0.05:
        return "< 0.1 %"
    decimals = 1 if 0 < size < 0.95 else 0
    return f"{100 * share:.{decimals}f} %".replace("-", MINUS)


def _compliance_panel(
    ink: Ink,
    box: tuple[float, float, float, float],
    curve: StrokeCurve,
    positions: Sequence[float],
) -> None:
    parts = {
        name.replace("_", " "): [float(c) * 1e9 for c in values]
        for name, values in curve.contributions.items()
        if any(float(c) > 0 for c in values)
    }
    if not parts:
        return
    totals = [sum(column) for column in zip(*parts.values(), strict=True)]
    axes = Axes(ink, box, (positions[0], positions[-1]), (0.0, max(totals) * 1.06))
    axes.frame("Compliance, µm/kN, stacked", "piston position from the cap end, mm")
    below = [0.0] * len(positions)
    weakest = max(range(len(totals)), key=totals.__getitem__)
    middles, labels, paints = [], [], fills(list(parts))
    for paint, (name, values) in zip(paints, parts.items(), strict=True):
        above = [low + value for low, value in zip(below, values, strict=True)]
        edge = [(axes.x(x), axes.y(y)) for x, y in zip(positions, above, strict=True)]
        back = [(axes.x(x), axes.y(y)) for x, y in zip(positions, below, strict=True)]
        ink.path([[*edge, *back[::-1]]], fill=paint, stroke=None, closed=True)
        ink.path([edge], stroke="#ffffff", pen=0.12)
        middles.append((edge[-1][1] + back[-1][1]) / 2)
        labels.append(f"{name} {per_cent(values[weakest] / totals[weakest])}")
        below = above
    ink.path([edge], stroke=BLACK, pen=0.3)
    x = axes.x(positions[weakest])
    ink.line((x, box[1]), (x, box[1] + box[3]), stroke=BLACK, pen=0.13, dash=(0.5, 0.7))
    right = box[0] + box[2]
    order = list(range(len(middles)))[::-1]
    places = spread_within(
        [middles[k] for k in order], [3.6] * len(order), box[1] - 0.4, box[1] + box[3] + 2.0
    )
    for k, y in zip(order, places, strict=True):
        ink.line((right, middles[k]), (right + 3.0, y), pen=0.13, stroke=GREY)
        ink.box(right + 3.2, y - 1.1, 2.2, 2.2, fill=paints[k], pen=0.1)
        ink.text(right + 6.2, y, labels[k], size=6.5)
    ink.text(right + 3.2, box[1] - 3.6, "share at minimum", size=6.0, color=GREY)


def wall_figure(layers: Sequence[tuple[str, float, str]], *, width: float = 180.0) -> Ink:
    """The barrel wall enlarged to an ISO scale, layer by layer from the bore (below) outwards.

    `layers` holds (text, thickness in m, kind).
    """
    total = 1000.0 * sum(thickness for _, thickness, _ in layers)
    paper, real = next(
        ((p, 1) for p in (100, 50, 20, 10, 5, 2, 1) if total * p <= 26.0),
        next(((1, r) for r in (2, 5, 10, 20, 50) if total / r <= 26.0), (1, 100)),
    )
    factor = 1000.0 * paper / real
    count = len(layers)
    wall = total * paper / real
    height = max(wall, 3.4 * count) + 9.0
    ink = Ink(width, height)
    bottom = height - 4.0 - max(0.0, (3.4 * count - wall) / 2)
    middles = []
    base = bottom
    for _, thickness, kind in layers:
        deep = thickness * factor
        box = ((3.0, base - deep), (63.0, base - deep), (63.0, base), (3.0, base))
        composite = kind == "composite"
        ink.path([box], fill="#d5dbe0" if composite else "#eef1f3", stroke=None, closed=True)
        lines = hatch([box], angle=-60.0 if composite else -45.0, spacing=0.9 if composite else 1.5)
        if composite:
            lines += hatch([box], angle=60.0, spacing=0.9)
        ink.path(lines, pen=0.09, stroke=GREY)
        ink.path([box], closed=True, pen=0.18)
        middles.append(base - deep / 2)
        base -= deep
    places = spread_within(middles[::-1], [3.4] * (count - 1), 2.0, height - 2.0)[::-1]
    for (words, thickness, _), middle, y in zip(layers, middles, places, strict=True):
        ink.line((63.0, middle), (69.0, y), (71.0, y), pen=0.13)
        ink.text(72.0, y, f"{words}, {trimmed(1000 * thickness)} mm", size=7.0)
    ink.text(33.0, bottom + 2.4, "bore side", size=6.0, color=GREY, anchor="center")
    ink.text(width, 2.0, f"SCALE {paper}:{real}", size=7.0, bold=True, anchor="right")
    return ink
