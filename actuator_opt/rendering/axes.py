"""Axes of figures: ranges, ticks, frames, and curves with their names.

Figures can be read in black and white: areas differ in lightness, lines in dash, and every curve
has its own label.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np

from ..base.numeric import Array
from .ink import GREY, PALE, Ink, Point, text_width
from .text import MINUS, SUPERSCRIPTS, fixed, trimmed

AREAS = (
    "#0b3c5d", "#9ec3da", "#d5e6f0", "#4f86a8", "#f0e2b6", "#b98b3e",
    "#d9c9e3", "#7a5a8c", "#7d868e", "#e3e6e8", "#2b3138",
)  # fmt: skip
"""Fills of stacked areas: distinct in hue for colour-blind eyes, in lightness on a grey print."""
Ticks: TypeAlias = Sequence[tuple[float, str]]
"""Values on an axis with their labels."""
Box: TypeAlias = tuple[float, float, float, float]
"""Left, top, width and height on the paper [mm]."""
THINNED = 640
"""Number of values to which a dense curve is thinned (our choice: two per 0.3 mm of paper)."""
SIZE = 6.2
"""Type size of the names of curves [pt]."""
_MILLISECONDS = 0.1
"""Time span [s] below which a time axis is in milliseconds."""


def ticks(low: float, high: float, count: int = 5) -> list[float]:
    """Tick values at round numbers inside [low, high], about `count` of them.

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
    """A plot frame on ink with linear axes; for a logarithmic axis, pass logarithms."""

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
        """Horizontal position of a value: distance from the left edge of the paper [mm]."""
        low, high = self.x_range
        return self.left + (value - low) / (high - low) * self.width

    def y(self, value: float) -> float:
        """Vertical position of a value: distance from the top edge of the paper [mm]."""
        low, high = self.y_range
        return self.top + (high - value) / (high - low) * self.height

    def frame(self, title: str, x_label: str) -> None:
        """Draw grid, ticks and axis labels; the y label is the title above the axis."""
        self.frame_at(
            title,
            x_label,
            [(value, trimmed(value)) for value in ticks(*self.x_range, 6)],
            [(value, trimmed(value)) for value in ticks(*self.y_range, 5)],
        )

    def frame_at(
        self, title: str, x_label: str, x_ticks: Ticks, y_ticks: Ticks, *, upright: bool = False
    ) -> None:
        """Draw grid, given ticks and axis labels; `upright` also draws vertical grid lines.

        Without an x label, the x ticks have no numbers, because a frame below shows them.
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
        """Polyline on paper, cut where it leaves the frame at the top or the bottom."""
        low, high = self.y_range
        lines: list[list[Point]] = [[]]
        for index, (x, y) in enumerate(zip(xs, ys, strict=True)):
            previous = ys[index - 1] if index else y
            for level, beyond in ((low, y < low), (high, y > high))[:: 1 if y > previous else -1]:
                outside = previous > level if level == high else previous < level
                if outside == beyond:
                    continue
                share = (level - previous) / (y - previous)
                edge = xs[index - 1] + share * (x - xs[index - 1])
                lines[-1].append((self.x(edge), self.y(level)))
                if beyond:
                    lines.append([])
            if low <= y <= high:
                lines[-1].append((self.x(x), self.y(y)))
        return [line for line in lines if len(line) > 1]


def fitted(words: str, room: float, size: float = 6.5) -> str:
    """Words that fit into `room` mm, cut with an ellipsis if too long.

    >>> fitted("weakest position", 12.0)
    'weakest…'
    """
    if text_width(words, size) <= room:
        return words
    while words and text_width(words + "…", size) > room:
        words = words[:-1]
    return words.rstrip() + "…"


def per_cent(share: float) -> str:
    """A share in whole per cent; small shares have a decimal.

    >>> per_cent(0.44), per_cent(0.0031), per_cent(0.0002), per_cent(0.0)
    ('44 %', '0.3 %', '< 0.1 %', '0 %')
    """
    size = 100 * abs(share)
    if 0 < size < 0.05:
        return "< 0.1 %"
    decimals = 1 if 0 < size < 0.95 else 0
    return f"{100 * share:.{decimals}f} %".replace("-", MINUS)


def level_words(value: float) -> str:
    """A power of ten or a multiple of it, as a short label for an axis.

    >>> level_words(0.01), level_words(2000.0), level_words(1e5), level_words(5e-7)
    ('0.01', '2000', '10⁵', '5×10⁻⁷')
    """
    if 1e-3 < value < 9999:
        return trimmed(value)
    power = math.floor(math.log10(value) + 1e-9)
    step = round(value / 10.0**power)
    power_text = f"10{str(power).translate(SUPERSCRIPTS)}"
    return power_text if step == 1 else f"{step}×{power_text}"


def level_ticks(low: float, high: float) -> Ticks:
    """Ticks of a logarithmic axis (log10): decades, or 1, 2, 5 on a short axis.

    >>> level_ticks(0.0, 0.8)
    [(0.0, '1'), (0.3010299956639812, '2'), (0.6989700043360189, '5')]
    """
    powers = range(math.floor(low), math.ceil(high) + 1)
    interval = max(1, math.ceil((high - low) / 7))
    steps = (1, 2, 5) if high - low < 2.2 else (1,)
    places = [
        (math.log10(step) + power, step * 10.0**power)
        for power in powers
        for step in steps
        if power % interval == 0
    ]
    return [(at, level_words(v)) for at, v in places if low - 1e-9 <= at <= high + 1e-9]


def even_ticks(low: float, high: float, count: int) -> Ticks:
    """Ticks at round numbers, about `count` of them, with as many decimals as their step needs.

    >>> even_ticks(54.91, 55.09, 3)
    [(54.95, '54.95'), (55.0, '55.00'), (55.05, '55.05')]
    """
    values = ticks(low, high, count)
    while len(values) < 2 and count < 9:  # a single tick shows no scale
        count += 1
        values = ticks(low, high, count)
    step = values[1] - values[0] if len(values) > 1 else abs(high) or 1.0
    places = max(0, min(9, -math.floor(math.log10(step) + 1e-9)))
    if any(abs(round(v, places) - v) > 1e-6 * step for v in values):
        places += 1
    return [(v, fixed(v, places) if places else trimmed(v, 7)) for v in values]


def spaced(candidates: Iterable[tuple[float, str, int]], axes: Axes) -> Ticks:
    """Ticks of an x axis (value, words, rank) whose words do not touch; low ranks have priority."""
    labels: list[tuple[float, str]] = []
    for value, words, _ in sorted(candidates, key=lambda tick: (tick[2], abs(tick[0]))):
        half = text_width(words, 6.5) / 2
        x = axes.x(value)
        if all(abs(x - axes.x(v)) > half + text_width(w, 6.5) / 2 + 1.0 for v, w in labels):
            labels.append((value, words))
    return sorted(labels)


def log_range(values: Sequence[float], least: float = 0.5) -> tuple[float, float]:
    """Range of a logarithmic axis (log10), at least `least` decades."""
    low, high = math.log10(min(values)), math.log10(max(values))
    spare = max(0.06 * (high - low), (least - (high - low)) / 2, 0.04)
    return low - spare, high + spare


def even_range(values: Sequence[float], *, zero: bool = False) -> tuple[float, float]:
    """Range of a linear axis, slightly wider than the values; never empty."""
    known = [v for v in values if math.isfinite(v)] or [0.0]
    low, high = min(known), max(known)
    if zero:
        low, high = min(low, 0.0), max(high, 0.0)
    spare = 0.06 * (high - low)
    if spare <= 1e-9 * max(abs(low), abs(high), 1e-12):
        spare = 0.05 * abs(high) or 1.0
    flat = low == high
    below = 0.0 if zero and low == 0 and not (flat and high < 0) else spare
    above = 0.0 if zero and high == 0 and not flat else spare
    return low - below, high + above


def band(
    axes: Axes,
    xs: Sequence[float],
    low: Sequence[float],
    high: Sequence[float],
    fill: str = "#d5e6f0",
) -> None:
    """Draw the area between two curves, cut at the frame; it has gaps where a bound is missing."""
    bottom, top = axes.y_range
    runs: list[list[tuple[float, float, float]]] = [[]]
    for x, below, above in zip(xs, low, high, strict=True):
        if math.isfinite(below) and math.isfinite(above) and below < top and above > bottom:
            runs[-1].append((x, max(below, bottom), min(above, top)))
        elif runs[-1]:
            runs.append([])
    for run in runs:
        upper = [(axes.x(x), axes.y(y)) for x, _, y in run]
        lower = [(axes.x(x), axes.y(y)) for x, y, _ in run]
        if len(run) > 1:
            axes.ink.path([[*upper, *lower[::-1]]], fill=fill, stroke=None, closed=True)


def thinned(values: Array, most: int = THINNED) -> Array:
    """Indices of samples with the least and greatest value of every interval, in order.

    >>> thinned(np.array([0.0, 5.0, 1.0, 2.0, -3.0, 3.0]), 4)
    array([0, 1, 4, 5])
    """
    size = values.size
    if size <= most:
        return np.arange(size)
    edges = np.linspace(0, size, max(most // 2, 1) + 1).round().astype(int)
    indices = {0, size - 1}
    for first, last in pairwise(edges.tolist()):
        indices |= {first + int(np.argmin(values[first:last]))}
        indices |= {first + int(np.argmax(values[first:last]))}
    return np.array(sorted(indices))


def time_words(span: float, words: str = "time") -> tuple[str, float]:
    """Label of a time axis, and the factor from seconds to its unit.

    >>> time_words(5.0), time_words(0.02)
    (('time, s', 1.0), ('time, ms', 1000.0))
    """
    return (f"{words}, ms", 1e3) if span < _MILLISECONDS else (f"{words}, s", 1.0)


def steady_range(ends: Sequence[float], *, zero: bool = False) -> tuple[float, float]:
    """Range like `even_range`, but so wide that a constant signal appears as a straight line."""
    low, high = even_range(ends, zero=zero)
    size = max((abs(v) for v in ends), default=0.0)
    least = 1e-6 * size if size > 1e-12 else 1.0
    if high - low >= least:
        return low, high
    middle = (low + high) / 2
    return middle - 0.05 * max(size, 1e-9), middle + 0.05 * max(size, 1e-9)


def names(
    ink: Ink, right: float, y: float, entries: Sequence[tuple[str, dict[str, Any]]], room: float
) -> None:
    """Draw names of curves, each after a line sample, in a row that ends at `right`.

    Names are cut to the width `room`.
    """
    if not entries:
        return
    words = [name for name, _ in entries]
    for line, gap in ((4.0, 2.2), (2.8, 1.4)):
        left = room + gap - len(entries) * (line + 0.8 + gap)
        if sum(text_width(name, SIZE) for name in words) <= left:
            break
    while len(words) > 1 and sum(text_width(name, SIZE) for name in words) > left:
        widest = max(range(len(words)), key=lambda k: text_width(words[k], SIZE))
        cut = fitted(words[widest], text_width(words[widest], SIZE) - 0.5, SIZE)
        if len(cut) < 3:
            break
        words[widest] = cut
    x = right + gap - sum(text_width(name, SIZE) + line + 0.8 + gap for name in words)
    for name, (_, style) in zip(words, entries, strict=True):
        ink.line((x, y), (x + line, y), **style)
        ink.text(x + line + 0.8, y, name, size=SIZE)
        x += line + 0.8 + text_width(name, SIZE) + gap
