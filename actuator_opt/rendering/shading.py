"""Shaded bands between levels of a quantity over two others, and their scale.

Lighter is less, so that a grey print reads the same.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from .axes import Axes
from .ink import WHITE, Ink
from .text import number, trimmed

_LIGHT, _DARK = (0xF1, 0xF6, 0xF9), (0x0B, 0x3C, 0x5D)
_MOST = 11
"""Bands of a map at most."""


def levels(low: float, high: float) -> list[float]:
    """Round levels across a range above zero: from six in a decade down to one.

    >>> levels(33.0, 121.0), levels(110.0, 2.2e7)[:3]
    ([30.0, 50.0, 70.0, 100.0, 150.0], [100.0, 300.0, 1000.0])
    """
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    for steps in ((1, 1.5, 2, 3, 5, 7), (1, 2, 5), (1, 3), (1,)):
        every = [step * 10.0**power for power in powers for step in steps]
        first = max(k for k, v in enumerate(every) if v <= low * (1 + 1e-9))
        last = min((k for k, v in enumerate(every) if v >= high * (1 - 1e-9)), default=len(every))
        found = every[first : last + 1]
        if len(found) <= _MOST + 1:
            return found if len(found) > 1 else [found[0], 10 * found[0]]
    return found


def shades(count: int) -> list[str]:
    """Fills from light to dark."""
    found = []
    for k in range(count):
        share = k / max(count - 1, 1)
        parts = [round(a + share * (b - a)) for a, b in zip(_LIGHT, _DARK, strict=True)]
        found.append("#" + "".join(f"{part:02x}" for part in parts))
    return found


def bands(
    axes: Axes, xs: Sequence[float], ys: Sequence[float], table: Any, bounds: Sequence[float]
) -> None:
    """Bands between levels, bilinear in the logarithm; a thin line at every level."""
    from contourpy import FillType, LineType, contour_generator

    maker = contour_generator(
        xs, ys, table, fill_type=FillType.OuterOffset, line_type=LineType.Separate, corner_mask=True
    )
    marks = [math.log10(v) for v in bounds]
    for low, high, paint in zip(marks[:-1], marks[1:], shades(len(marks) - 1), strict=True):
        filled: Any = maker.filled(low, high)
        for one, starts in zip(*filled, strict=True):
            rings = [one[a:b] for a, b in pairwise(starts)]
            paper = [[(axes.x(float(x)), axes.y(float(y))) for x, y in ring] for ring in rings]
            axes.ink.path(paper, stroke=paint, pen=0.05, fill=paint, closed=True)
    for mark in marks[1:-1]:
        found: Any = maker.lines(mark)
        lines = [[(axes.x(float(x)), axes.y(float(y))) for x, y in one] for one in found]
        axes.ink.path(lines, stroke=WHITE, pen=0.12)


def scale(ink: Ink, box: tuple[float, float, float, float], bounds: Sequence[float]) -> None:
    """The bands beside the frame, with the level between two of them."""
    x, count = box[0] + box[2] + 2.5, len(bounds) - 1
    high = min(box[3] / count, 6.0)
    top = box[1] + box[3] - high * count
    for k, paint in enumerate(shades(count)[::-1]):
        ink.box(x, top + k * high, 3.0, high, fill=paint, pen=0.1)
    for k, level in enumerate(reversed(bounds)):
        ink.text(x + 4.2, top + k * high, _level(level), size=6.0)


def _level(value: float) -> str:
    return number(value, 1) if value < 1 else trimmed(value)
