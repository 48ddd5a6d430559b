"""Axes and marks of the figures of an Identification: velocities both ways, error bars, reasons."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..base.fitting import NORMAL
from ..base.numeric import Array
from ..identification.points import Point
from ..rendering.axes import Axes, Ticks, even_ticks, level_ticks, spaced
from ..rendering.ink import BLACK, BLUE, WHITE, Ink

CORE = 0.35
"""Decades that the velocities about rest take, where the axis is straight (a choice: what lies
there is not measured)."""
DECADE = 8.0
"""Ratio of speeds from which on their axis is logarithmic (a choice: nearly a decade)."""
SURE = NORMAL
"""Standard errors of the bounds of a mark."""
OUT: dict[str, Any] = {"color": BLUE, "fill": WHITE}
IN: dict[str, Any] = {"color": BLACK, "fill": "#9ec3da"}


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


def ways(ink: Ink, x: float, y: float, points: Sequence[Point]) -> None:
    """What the marks of both ways mean, in one line from `x`."""
    for words, style in (("out", OUT), ("in", IN)):
        if any((one.velocity > 0) == (words == "out") for one in points):
            ink.circle(x + 1.0, y, 0.75, fill=style["fill"], stroke=style["color"], pen=0.3)
            ink.text(x + 2.6, y, words)
            x += 8.5
