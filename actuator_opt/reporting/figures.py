"""Figures of the report as ink: stiffness over the stroke with its compliance contributions.

Readable in black and white: areas differ in lightness, lines in dash, and every curve carries
its own label.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..evaluation.result import Requirement, StrokeCurve
from .ink import BLACK, BLUE, GREY, PALE, RED, Ink, Point, hatch, spread_within, text_width
from .text import number, trimmed

AREAS = ("#0b3c5d", "#9ec3da", "#4f86a8", "#f0e2b6", "#b98b3e", "#e3e6e8", "#7d868e")
"""Fills of stacked areas: distinct in hue for colour-blind eyes, in lightness on a grey print."""


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
    """A plot frame on ink with linear axes."""

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
        bottom = self.top + self.height
        for value in ticks(*self.y_range, 5):
            y = self.y(value)
            self.ink.line((self.left, y), (self.left + self.width, y), stroke=PALE, pen=0.1)
            self.ink.text(self.left - 1.4, y, trimmed(value), size=6.5, anchor="right")
        for value in ticks(*self.x_range, 6):
            x = self.x(value)
            self.ink.line((x, bottom), (x, bottom + 1.0), pen=0.13)
            self.ink.text(x, bottom + 3.0, trimmed(value), size=6.5, anchor="center")
        self.ink.line(
            (self.left, self.top), (self.left, bottom), (self.left + self.width, bottom), pen=0.18
        )
        middle = self.left + self.width / 2
        self.ink.text(middle, bottom + 7.0, x_label, size=6.5, anchor="center", color=GREY)
        self.ink.text(self.left - 1.4, self.top - 3.6, title, size=7.0, bold=True)

    def clipped(self, xs: Sequence[float], ys: Sequence[float]) -> list[list[Point]]:
        """Polyline on paper, cut where it leaves the top of the frame."""
        top = self.y_range[1]
        lines: list[list[Point]] = [[]]
        for index, (x, y) in enumerate(zip(xs, ys, strict=True)):
            if index and (ys[index - 1] > top) != (y > top):
                share = (top - ys[index - 1]) / (y - ys[index - 1])
                edge = xs[index - 1] + share * (x - xs[index - 1])
                lines[-1].append((self.x(edge), self.y(top)))
                if y > top:
                    lines.append([])
            if y <= top:
                lines[-1].append((self.x(x), self.y(y)))
        return [line for line in lines if len(line) > 1]


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
    x, y = axes.x(place), axes.y(weakest)
    ink.circle(x, y, 0.8, fill=BLUE, stroke="#ffffff", pen=0.2)
    label = f"minimum {number(weakest)} at {trimmed(place, 3)} mm"
    half = text_width(label, 6.5) / 2
    text_x = min(max(x, box[0] + half + 1.0), box[0] + box[2] - half - 1.0)
    text_y = y + 4.0
    if limit is not None and axes.y(limit) > y:
        text_y = max(text_y, axes.y(limit) + 3.0) if axes.y(limit) - y < 6.5 else y + 3.0
    ink.text(text_x, text_y, label, anchor="center", halo=True, color=BLUE)
    if limit is not None:
        level = axes.y(limit)
        ink.line((box[0], level), (box[0] + box[2], level), stroke=RED, pen=0.25, dash=(1.8, 1.0))
        ink.text(box[0] + box[2] + 1.0, level, f"≥ {trimmed(limit)}", color=RED, anchor="left")


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
    middles, labels = [], []
    for index, (name, values) in enumerate(parts.items()):
        above = [low + value for low, value in zip(below, values, strict=True)]
        edge = [(axes.x(x), axes.y(y)) for x, y in zip(positions, above, strict=True)]
        back = [(axes.x(x), axes.y(y)) for x, y in zip(positions, below, strict=True)]
        ink.path([[*edge, *back[::-1]]], fill=AREAS[index % len(AREAS)], stroke=None, closed=True)
        ink.path([edge], stroke="#ffffff", pen=0.2)
        middles.append((edge[-1][1] + back[-1][1]) / 2)
        labels.append(f"{name} {100 * values[weakest] / totals[weakest]:.0f} %")
        below = above
    ink.path([edge], stroke=BLACK, pen=0.3)
    right = box[0] + box[2]
    order = list(range(len(middles)))[::-1]
    places = spread_within(
        [middles[k] for k in order], [3.4] * len(order), box[1] - 1.0, box[1] + box[3] + 2.0
    )
    for k, y in zip(order, places, strict=True):
        ink.line((right, middles[k]), (right + 3.0, y), pen=0.13, stroke=GREY)
        ink.box(right + 3.2, y - 1.1, 2.2, 2.2, fill=AREAS[k % len(AREAS)], pen=0.1)
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
