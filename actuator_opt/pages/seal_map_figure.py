"""Friction and secant damping over speed and pressure as contours, between shaded bands.

Lighter is less, so that a grey print reads the same. Where there is no film the map stays hatched.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..rendering.axes import Axes, dot, level_ticks, ticks
from ..rendering.ink import BLACK, GREY, PALE, Ink, hatch
from ..rendering.shading import bands, levels, scale
from ..rendering.text import trimmed
from ..studies.seal import FilmMap, SealStudy
from .bode import inside, logs
from .seal_figures import stroke_names

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


def _missing(axes: Axes, x: float, y: float) -> None:
    """A point without a film."""
    at = axes.x(x), axes.y(y)
    for side in (-0.7, 0.7):
        axes.ink.line((at[0] - 0.7, at[1] - side), (at[0] + 0.7, at[1] + side), pen=0.2)
