"""Axes and marks of the figures of an Identification: velocities both ways, error bars, reasons."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from ..base.fitting import NORMAL
from ..base.numeric import Array
from ..identification.points import Point
from ..rendering.axes import Axes, Ticks, ticks
from ..rendering.heights import wrap
from ..rendering.ink import BLACK, BLUE, GREY, PALE, WHITE, Ink, text_width
from ..rendering.text import fixed, trimmed
from .dynamics_figures import level_ticks

Box = tuple[float, float, float, float]
"""Left, top, width and height on the paper [mm]."""
CORE = 0.35
"""Decades that the velocities about rest take, where the axis is straight (a choice: what lies
there is not measured)."""
DECADE = 8.0
"""Ratio of speeds from which on their axis is logarithmic (a choice: nearly a decade)."""
SURE = NORMAL
"""Standard errors of the bounds of a mark."""
OUT: dict[str, Any] = {"color": BLUE, "fill": WHITE}
IN: dict[str, Any] = {"color": BLACK, "fill": "#9ec3da"}


def even_ticks(low: float, high: float, count: int) -> Ticks:
    """Round ticks with as many decimals as their step needs.

    >>> even_ticks(54.91, 55.09, 3)
    [(54.95, '54.95'), (55.0, '55.00'), (55.05, '55.05')]
    """
    values = ticks(low, high, count)
    while len(values) < 2 and count < 9:  # one tick tells no scale
        count += 1
        values = ticks(low, high, count)
    step = values[1] - values[0] if len(values) > 1 else abs(high) or 1.0
    places = max(0, min(9, -math.floor(math.log10(step) + 1e-9)))
    if any(abs(round(v, places) - v) > 1e-6 * step for v in values):
        places += 1
    return [(v, fixed(v, places) if places else trimmed(v, 7)) for v in values]


def spaced(found: Iterable[tuple[float, str, int]], axes: Axes) -> Ticks:
    """Ticks of an x axis (place, words, rank) whose words do not touch; the least rank stays."""
    kept: list[tuple[float, str]] = []
    for value, words, _ in sorted(found, key=lambda one: (one[2], abs(one[0]))):
        half = text_width(words, 6.5) / 2
        x = axes.x(value)
        if all(abs(x - axes.x(v)) > half + text_width(w, 6.5) / 2 + 1.0 for v, w in kept):
            kept.append((value, words))
    return sorted(kept)


class Velocities:
    """A place for every velocity, mm/s: straight, or logarithmic both ways about a straight core.

    Parameters
    ----------
    values : velocities to show, signed [mm/s]
    """

    def __init__(self, values: Sequence[float]) -> None:
        speeds = [abs(v) for v in values if v]
        self.low, self.high = min(speeds), 1.12 * max(speeds)
        self.logarithmic = self.high / self.low > DECADE
        self.least = self.low / 1.5
        ways = {v > 0 for v in values if v}
        end = self.at(self.high)
        self.range = (-end if False in ways else 0.0, end if True in ways else 0.0)
        self.ways = [way for way in (1, -1) if (way > 0) in ways]

    def at(self, value: float) -> float:
        """Where a velocity stands."""
        if not self.logarithmic:
            return value
        size = abs(value)
        if size <= self.least:
            return CORE * value / self.least
        return math.copysign(CORE + math.log10(size / self.least), value)

    def curve(self) -> Array:
        """Speeds at which a curve is drawn, away from rest [mm/s]."""
        if self.logarithmic:
            return np.geomspace(self.least, self.high, 90)
        return np.linspace(self.high / 400, self.high, 90)

    def ticks(self, axes: Axes) -> Ticks:
        """Places and words along the axis, as many as have room."""
        if not self.logarithmic:
            low, high = (v * self.high / (self.range[1] or -self.range[0]) for v in self.range)
            count = max(2, int(axes.width / 9.0))
            values = even_ticks(low, high, count)
            kept = spaced([(v, w, 1) for v, w in values], axes)
            if len(kept) < 2:  # rather both ends than zero alone
                kept = spaced([(v, w, -round(1e6 * abs(v))) for v, w in values], axes)
            return kept
        found = [(0.0, "0", 0)]
        for place, words in level_ticks(math.log10(self.least), math.log10(self.high)):
            value = 10.0**place
            rank = 1 if abs(place - round(place)) < 1e-9 else 2
            for way in self.ways:
                signed = words if way > 0 else f"\N{MINUS SIGN}{words}"
                found.append((self.at(way * value), signed, rank))
        return spaced([one for one in found if self._holds(one[0])], axes)

    def _holds(self, place: float) -> bool:
        return self.range[0] - 1e-9 <= place <= self.range[1] + 1e-9


def log_ticks(low: float, high: float) -> Ticks:
    """Ticks of a logarithmic axis (log10): as `level_ticks`, or even ones where those are few.

    >>> log_ticks(0.5, 0.9)
    [(0.6020599913279624, '4'), (0.7781512503836436, '6')]
    """
    found = level_ticks(low, high)
    if len(found) > 1:
        return found
    values = even_ticks(10.0**low, 10.0**high, 3)
    return [(math.log10(v), words) for v, words in values if v > 0]


def log_range(values: Sequence[float], least: float = 0.5) -> tuple[float, float]:
    """Range of a logarithmic axis (log10), at least `least` decades."""
    low, high = math.log10(min(values)), math.log10(max(values))
    spare = max(0.06 * (high - low), (least - (high - low)) / 2, 0.04)
    return low - spare, high + spare


def even_range(values: Sequence[float], *, zero: bool = False) -> tuple[float, float]:
    """Range of a straight axis with a little room; never empty."""
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


def error_bar(axes: Axes, x: float, low: float, high: float, color: str) -> None:
    """A bar from low to high, cut at the frame, with feet where it ends inside."""
    bottom, top = axes.y_range
    if high < bottom or low > top:
        return
    at = axes.x(x)
    axes.ink.line(
        (at, axes.y(max(low, bottom))), (at, axes.y(min(high, top))), pen=0.2, stroke=color
    )
    for level in (low, high):
        if bottom <= level <= top:
            y = axes.y(level)
            axes.ink.line((at - 0.7, y), (at + 0.7, y), pen=0.2, stroke=color)


def reason(ink: Ink, box: Box, words: str) -> Box:
    """Why something is missing, above a frame; what is left of its box."""
    lines = wrap(words, box[2], 6.2)
    for k, line in enumerate(lines):
        ink.text(box[0], box[1] - 1.0 + 2.9 * k, line, size=6.2, color=GREY)
    used = 2.9 * len(lines) + 1.0
    return box[0], box[1] + used, box[2], max(box[3] - used, 6.0)


def empty(ink: Ink, box: Box, title: str, words: str) -> None:
    """A frame that holds the reason why there is nothing in it."""
    ink.text(box[0] - 1.4, box[1] - 3.6, title, size=7.0, bold=True)
    ink.box(*box, stroke=PALE, pen=0.13)
    lines = wrap(words, box[2] - 6.0, 6.5)
    first = box[1] + box[3] / 2 - 3.1 * (len(lines) - 1) / 2
    for k, line in enumerate(lines):
        ink.text(box[0] + box[2] / 2, first + 3.1 * k, line, anchor="center", color=GREY)


def band(axes: Axes, xs: Sequence[float], low: Sequence[float], high: Sequence[float]) -> None:
    """The area between two curves, cut at the frame; nothing where a bound has no value."""
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
            axes.ink.path([[*upper, *lower[::-1]]], fill="#d5e6f0", stroke=None, closed=True)


def ways(ink: Ink, x: float, y: float, points: Sequence[Point]) -> None:
    """What the marks of both ways mean, in one line from `x`."""
    for words, style in (("out", OUT), ("in", IN)):
        if any((one.velocity > 0) == (words == "out") for one in points):
            ink.circle(x + 1.0, y, 0.75, fill=style["fill"], stroke=style["color"], pen=0.3)
            ink.text(x + 2.6, y, words)
            x += 8.5
