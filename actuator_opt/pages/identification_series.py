"""An Identification over time as ink: motion, pressures, friction, bore growth and stiffness.

Long records are thinned to the least and the greatest value of every short stretch of time, so that
peaks stay.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..base.numeric import Array
from ..identification.balance import Sliding
from ..identification.result import Identification
from ..rendering.axes import THINNED, Axes, Box, even_range, even_ticks, spaced, thinned
from ..rendering.ink import BLUE, GREY, Ink, Point
from ..rendering.text import unit_text
from .identification_rows import FORCE, GROWTH, LENGTH, PRESSURE, STIFFNESS
from .wall_figures import OCHRE

LINE: dict[str, Any] = {"stroke": BLUE, "pen": 0.2}
SECOND: dict[str, Any] = {"stroke": OCHRE, "pen": 0.2, "dash": (1.2, 0.5)}
_HEAD, _FOOT = 5.2, 7.5
"""Height of the words above a strip and below the last one [mm]."""
Curve = tuple[dict[str, Any], list[tuple[Array, Array]]]
"""A style with times and values of every stretch."""


def strips(ink: Ink, box: Box, found: Identification) -> None:
    """Position, pressures, friction, growth and stiffness over time, one above the other."""
    left, top, width, height = box
    rows = _rows(found)
    tall = (height - _FOOT) / len(rows) - _HEAD
    slidings = found.slidings
    across = (float(slidings[0].piece.time[0]), float(slidings[-1].piece.time[-1]))
    for k, (title, curves, zero) in enumerate(rows):
        y = top + k * (tall + _HEAD) + _HEAD
        values = [float(v) for _, parts in curves for _, one in parts for v in one]
        values = [v for v in values if math.isfinite(v)]
        span = even_range(values, zero=zero)
        axes = Axes(ink, (left, y, width, tall), across, span)
        marks = even_ticks(*span, 2 if tall < 9 else 3) if values else []
        axes.frame_at("", "", [], marks)
        ink.text(left, y - 2.4, title, size=6.5, bold=True)
        if not values:
            said = "the record lies outside the stroke"
            ink.text(left + width / 2, y + tall / 2, said, anchor="center", size=6.0, color=GREY)
        for style, parts in curves:
            ink.path(_lines(axes, parts), **style)
        if len(curves) == 2:
            for x, words, (style, _) in zip((18.0, 8.0), ("p1", "p2"), curves, strict=True):
                at = left + width - x
                ink.line((at, y - 2.4), (at + 4.0, y - 2.4), **style | {"pen": 0.35})
                ink.text(at + 4.7, y - 2.4, words)
        if k == len(rows) - 1:
            _time_axis(axes, spaced([(v, w, 1) for v, w in even_ticks(*across, 5)], axes))


def _rows(found: Identification) -> list[tuple[str, list[Curve], bool]]:
    """Title, curves and whether zero belongs to the axis."""
    slidings = found.slidings
    length, pressure = LENGTH.to_display(1.0), PRESSURE.to_display(1.0)
    pair = [("p1", LINE), ("p2", SECOND)] if "p2" in slidings[0].piece else [("p1", LINE)]
    pressures = [
        (style, _parts(slidings, [pressure * one.piece[name] for one in slidings]))
        for name, style in pair
    ]
    friction = [np.where(one.piece.sound, one.friction, np.nan) for one in slidings]
    growth = [GROWTH.to_display(1.0) * found.growth_along(one) for one in slidings]
    stiffness = [STIFFNESS.to_display(1.0) * found.stiffness_along(one) for one in slidings]
    place = [length * one.piece["x"] for one in slidings]
    return [
        (f"Position, {unit_text(LENGTH.unit)}", [(LINE, _parts(slidings, place))], False),
        (f"Pressures, {unit_text(PRESSURE.unit)}", pressures, False),
        (f"Friction, {unit_text(FORCE.unit)}", [(LINE, _parts(slidings, friction))], True),
        (
            f"Bore growth at the seal, {unit_text(GROWTH.unit)}",
            [(LINE, _parts(slidings, growth))],
            True,
        ),
        (f"k_eq, {unit_text(STIFFNESS.unit)}", [(LINE, _parts(slidings, stiffness))], True),
    ]


def _parts(slidings: Sequence[Sliding], values: Sequence[Array]) -> list[tuple[Array, Array]]:
    """Time and thinned values of every unbroken stretch that has a value."""
    parts = []
    for one, whole, most in zip(slidings, values, _shares(slidings), strict=True):
        known = np.flatnonzero(np.isfinite(whole))
        runs = np.split(known, np.flatnonzero(np.diff(known) > 1) + 1)
        for run in runs:
            if run.size > 1:
                share = max(8, int(most * run.size / known.size))
                at = run[thinned(whole[run], share)]
                parts.append((one.piece.time[at], whole[at]))
    return parts


def _lines(axes: Axes, parts: Sequence[tuple[Array, Array]]) -> list[list[Point]]:
    lines: list[list[Point]] = []
    for time, one in parts:
        lines += axes.clipped([float(t) for t in time], [float(v) for v in one])
    return lines


def _time_axis(axes: Axes, marks: Sequence[tuple[float, str]]) -> None:
    bottom = axes.top + axes.height
    for value, words in marks:
        x = axes.x(value)
        axes.ink.line((x, bottom), (x, bottom + 1.0), pen=0.13)
        axes.ink.text(x, bottom + 2.8, words, anchor="center")
    middle = axes.left + axes.width / 2
    axes.ink.text(middle, bottom + 6.0, "time, s", anchor="center", color=GREY)


def _shares(slidings: Sequence[Sliding]) -> list[int]:
    """Values each piece may have, by its length."""
    sizes = np.array([one.piece.time.size for one in slidings], dtype=float)
    return [max(8, int(THINNED * share)) for share in sizes / sizes.sum()]


def loop(found: Identification) -> list[list[tuple[float, float]]]:
    """Friction over position, thinned: (mm, N) by piece."""
    lines = []
    for one, most in zip(found.slidings, _shares(found.slidings), strict=True):
        sound = np.flatnonzero(one.piece.sound)
        at = sound[thinned(one.friction[sound], most)]
        places = LENGTH.to_display(1.0) * one.piece["x"][at]
        lines.append([(float(x), float(f)) for x, f in zip(places, one.friction[at], strict=True)])
    return lines
