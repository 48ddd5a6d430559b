"""Friction and secant damping over speed and pressure as contours, between shaded bands.

Lighter is less, so that a grey print reads the same. Where there is no film the map stays hatched.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from ..rendering.axes import Axes, dot, level_ticks, ticks
from ..rendering.ink import BLACK, GREY, PALE, WHITE, Ink, hatch
from ..rendering.text import number, trimmed
from ..studies.seal import FilmMap, SealStudy
from .bode import inside, logs
from .seal_figures import stroke_names

_LIGHT, _DARK = (0xF1, 0xF6, 0xF9), (0x0B, 0x3C, 0x5D)
_MOST = 11
"""Bands of a map at most."""
_BOX = (62.0, 44.0)


def map_figure(study: SealStudy) -> Ink:
    """Friction (left) and secant damping (right), driven."""
    found = study.map
    assert found is not None
    ink = Ink(180.0, 62.0)
    title = f"Friction, {stroke_names(study)[0]}, N"
    _panel(ink, 11.0, study, found, title, found.friction)
    _panel(ink, 102.0, study, found, "Secant damping F/v, kN·s/m", found.damping / 1e3)
    return ink


def levels(low: float, high: float) -> list[float]:
    """Round levels across a range above zero: from six in a decade down to one, so that few stand.

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


def _panel(
    ink: Ink,
    left: float,
    study: SealStudy,
    found: FilmMap,
    title: str,
    values: np.ndarray,
) -> None:
    box = (left, 8.0, *_BOX)
    xs, ys = logs(1e3 * found.speeds), [float(p) / 1e5 for p in found.pressures]
    axes = Axes(ink, box, (xs[0], xs[-1]), (ys[0], ys[-1]))
    corners = [(box[0], box[1]), (box[0] + box[2], box[1])]
    corners += [(box[0] + box[2], box[1] + box[3]), (box[0], box[1] + box[3])]
    ink.path(hatch([corners], angle=45.0, spacing=1.6), pen=0.1, stroke=PALE)
    usable = values[np.isfinite(values) & (values > 0)]
    bounds = levels(float(usable.min()), float(usable.max()))
    table = np.ma.masked_invalid(np.log10(np.where(values > 0, values, np.nan)))
    bands(axes, xs, ys, table, bounds)
    for i, j in zip(*np.nonzero(table.mask if table.mask is not np.False_ else []), strict=True):
        _missing(axes, xs[int(j)], ys[int(i)])
    place, level = math.log10(1e3 * study.drive.speed), study.drive.pressure / 1e5
    if inside(axes, place) and ys[0] <= level <= ys[-1]:
        dot(axes, place, level, BLACK)
    marks = [(v, trimmed(v)) for v in ticks(ys[0], ys[-1], 5)]
    _frame(axes, title, level_ticks(xs[0], xs[-1]), marks)
    scale(ink, box, bounds)


def _frame(axes: Axes, title: str, x_ticks: Any, y_ticks: Any) -> None:
    """Ticks outside, no grid; the axes' names as those of the other figures."""
    ink, bottom, right = axes.ink, axes.top + axes.height, axes.left + axes.width
    for value, words in y_ticks:
        y = axes.y(value)
        ink.line((axes.left - 1.0, y), (axes.left, y), pen=0.13)
        ink.text(axes.left - 1.6, y, words, anchor="right")
    for value, words in x_ticks:
        x = axes.x(value)
        ink.line((x, bottom), (x, bottom + 1.0), pen=0.13)
        ink.text(x, bottom + 3.0, words, anchor="center")
    ink.box(axes.left, axes.top, axes.width, axes.height, pen=0.18)
    middle = (axes.left + right) / 2
    ink.text(middle, bottom + 7.0, "speed, mm/s", anchor="center", color=GREY)
    words = f"{title}; upwards: pressure, bar"
    ink.text(axes.left - 1.4, axes.top - 3.6, words, size=7.0, bold=True)


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


def _missing(axes: Axes, x: float, y: float) -> None:
    """A point without a film."""
    at = axes.x(x), axes.y(y)
    for side in (-0.7, 0.7):
        axes.ink.line((at[0] - 0.7, at[1] - side), (at[0] + 0.7, at[1] + side), pen=0.2)


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
