"""Secant damping over speed and pressure: measured points, shaded as the fitted surface below."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence

import numpy as np

from ..identification.points import Point, by_pressure
from ..identification.stribeck_fit import StribeckFit
from ..rendering.axes import Axes, Box, even_range, even_ticks, log_range, log_ticks, spaced
from ..rendering.ink import BLACK, GREY, WHITE, Ink
from ..rendering.shading import bands, levels, scale, shades
from ..rendering.text import unit_text
from .identification_rows import PRESSURE, SPEED

LEAST_SPEEDS = 3
"""Speeds at a level of pressure from which on a map tells more than a curve (a choice)."""


def pressure_levels(points: Sequence[Point]) -> list[list[Point]]:
    """Points one way by level of pressure, where two levels or more hold three speeds; else none.

    Both ways differ in pressure without a load already: that alone makes no map.
    """
    for way in (True, False):
        here = [one for one in points if (one.velocity > 0) == way]
        full = [group for group in by_pressure(here) if _speeds(group) >= LEAST_SPEEDS]
        if len(full) > 1 and _overlap(full):
            return full
    return []


def _speeds(group: Sequence[Point]) -> int:
    return len({round(10 * math.log(one.speed)) for one in group})


def _overlap(groups: Sequence[Sequence[Point]]) -> bool:
    """Whether all levels share a range of speeds: else speed alone makes the pressure."""
    low = max(min(one.speed for one in group) for group in groups)
    high = min(max(one.speed for one in group) for group in groups)
    return high > 1.5 * low


def map_panel(
    ink: Ink, box: Box, title: str, points: Sequence[Point], fit: StribeckFit | str
) -> None:
    """Points over speed and pressure, shaded by their damping, on the Stribeck curve's surface."""
    xs = [math.log10(SPEED.to_display(one.speed)) for one in points]
    ys = [PRESSURE.to_display(one.pressure) for one in points]
    axes = Axes(ink, box, log_range([10.0**x for x in xs]), even_range(ys))
    values = [one.damping / 1e3 for one in points]
    surface = None
    if isinstance(fit, StribeckFit):
        across = np.linspace(*axes.x_range, 40)
        upwards = np.linspace(*axes.y_range, 24)
        speed = 10.0**across / SPEED.to_display(1.0)
        pressure = upwards / PRESSURE.to_display(1.0)
        table = np.asarray(fit.predict(speed[None, :], pressure[:, None])) / speed / 1e3
        surface = (across.tolist(), upwards.tolist(), np.broadcast_to(table, (24, 40)))
        values += [float(v) for v in table.ravel() if v > 0]
    bounds = levels(min(values), max(values))
    if surface is not None:
        logs = np.ma.masked_invalid(np.log10(np.where(surface[2] > 0, surface[2], np.nan)))
        bands(axes, surface[0], surface[1], logs, bounds)
    _frame(axes, title)
    paints = shades(len(bounds) - 1)
    for one, x, y in zip(points, xs, ys, strict=True):
        k = min(max(bisect_right(bounds, one.damping / 1e3) - 1, 0), len(paints) - 1)
        ink.circle(axes.x(x), axes.y(y), 1.15, fill=WHITE, stroke=None)
        ink.circle(axes.x(x), axes.y(y), 0.9, fill=paints[k], stroke=BLACK, pen=0.18)
    scale(ink, box, bounds)
    words = f"upwards: pressure, {unit_text(PRESSURE.unit)}; circles: measured"
    ink.text(box[0] - 1.4, box[1] - 5.8, words, size=6.2, color=GREY)
    if surface is not None:
        words = "bands: Stribeck curve, outwards"
        ink.text(box[0] - 1.4, box[1] - 2.6, words, size=6.2, color=GREY)


def _frame(axes: Axes, title: str) -> None:
    ink, bottom = axes.ink, axes.top + axes.height
    for value, words in even_ticks(*axes.y_range, 5):
        y = axes.y(value)
        ink.line((axes.left - 1.0, y), (axes.left, y), pen=0.13)
        ink.text(axes.left - 1.6, y, words, anchor="right")
    found = log_ticks(*axes.x_range)
    for value, words in spaced([(v, w, int(abs(v - round(v)) > 1e-9)) for v, w in found], axes):
        x = axes.x(value)
        ink.line((x, bottom), (x, bottom + 1.0), pen=0.13)
        ink.text(x, bottom + 3.0, words, anchor="center")
    ink.box(axes.left, axes.top, axes.width, axes.height, pen=0.18)
    middle = axes.left + axes.width / 2
    ink.text(middle, bottom + 7.0, "speed, mm/s", anchor="center", color=GREY)
    ink.text(axes.left - 1.4, axes.top - 9.6, title, size=7.0, bold=True)
