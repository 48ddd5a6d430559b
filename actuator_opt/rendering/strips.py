"""TODO."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..base.numeric import Array
from .axes import (
    COLOURS,
    DASHES,
    ZERO,
    Axes,
    Box,
    even_ticks,
    lines,
    names,
    steady_range,
    time_axis,
)
from .ink import BLACK, GREY, RED, Ink, text_width

STYLES: tuple[dict[str, Any], ...] = tuple(
    {"stroke": colour, "pen": 0.28, "dash": dash}
    for colour, dash in zip(COLOURS[:4], DASHES[:4], strict=True)
)


ASKED: dict[str, Any] = {"stroke": BLACK, "pen": 0.2, "dash": (0.9, 0.6)}
"""What was asked for."""


LEVEL: dict[str, Any] = {"stroke": GREY, "pen": 0.18, "dash": (0.9, 0.6)}


LIMIT: dict[str, Any] = {"stroke": RED, "pen": 0.2, "dash": (1.8, 0.8)}


MEASURED: dict[str, Any] = {"stroke": "#a9b4bc", "pen": 0.7}


EVENT: dict[str, Any] = {"stroke": RED, "pen": 0.13, "dash": (0.4, 0.5)}


HEAD, FOOT = 5.2, 7.5
"""Height of the words above a strip and below the last one [mm]."""


LEAST_STRIP = 10.0
"""Least height of the frame of a strip [mm] (a choice: three numbers beside it)."""


@dataclass(frozen=True, slots=True)
class Curve:
    """Values over time, in the unit shown; without words it is not named."""

    words: str
    time: Array
    values: Array
    style: dict[str, Any]


@dataclass(frozen=True, slots=True)
class Level:
    """A value that holds all the time; without words it is not named."""

    words: str
    value: float
    style: dict[str, Any]


@dataclass(frozen=True, slots=True)
class Strip:
    """A frame of curves over time; the strips of highest rank go where there is no room."""

    title: str
    curves: tuple[Curve, ...]
    levels: tuple[Level, ...] = ()
    zero: bool = False
    """Whether zero belongs to the axis."""
    rank: int = 1


def kept(strips: Sequence[Strip], height: float) -> list[Strip]:
    """The strips that have room in a height [mm], in their order."""
    most = max(2, int((height - FOOT) / (HEAD + LEAST_STRIP)))
    order = sorted(range(len(strips)), key=lambda k: (strips[k].rank, k))[:most]
    return [strips[k] for k in sorted(order)]


def stack(
    ink: Ink,
    box: Box,
    strips: Sequence[Strip],
    across: tuple[float, float],
    *,
    marks: Sequence[float] = (),
    words: str = "time",
) -> None:
    """Strips over one time, one above the other; `marks` are instants [s] through all of them."""
    left, top, width, height = box
    shown = kept(strips, height)
    if not shown:
        return
    tall = (height - FOOT) / len(shown) - HEAD
    for k, one in enumerate(shown):
        axes = strip(ink, (left, top + k * (tall + HEAD) + HEAD, width, tall), one, across)
        for instant in marks:
            if across[0] < instant < across[1]:
                x = axes.x(instant)
                ink.line((x, axes.top), (x, axes.top + tall), **EVENT)
        if k == len(shown) - 1:
            time_axis(axes, words)


def strip(ink: Ink, box: Box, one: Strip, across: tuple[float, float]) -> Axes:
    """One frame of curves, title and names above it; no time axis."""
    span = value_range(one, across)
    axes = Axes(ink, box, across, span)
    axes.frame_at("", "", [], even_ticks(*span, 2 if box[3] < 9 else 3 if box[3] < 20 else 5))
    ink.text(box[0], box[1] - 2.4, one.title, size=6.5, bold=True)
    low, high = span
    if low < 0 < high:
        ink.line((box[0], axes.y(0.0)), (box[0] + box[2], axes.y(0.0)), **ZERO)
    entries = []
    for level in one.levels:
        if low <= level.value <= high:
            y = axes.y(level.value)
            ink.line((box[0], y), (box[0] + box[2], y), **level.style)
            entries.append((level.words, level.style))
    for curve in one.curves:
        ink.path(lines(axes, curve.time, curve.values), **curve.style)
    named = [(curve.words, curve.style) for curve in one.curves if curve.words]
    room = box[2] - text_width(one.title, 6.5, bold=True) - 2.0
    names(ink, box[0] + box[2], box[1] - 2.4, _distinct([*named, *entries]), room)
    return axes


def value_range(one: Strip, across: tuple[float, float]) -> tuple[float, float]:
    """Range of the values that lie in a time, with the levels where zero belongs to them."""
    ends: list[float] = []
    for curve in one.curves:
        inside = curve.values[(curve.time >= across[0]) & (curve.time <= across[1])]
        inside = inside[np.isfinite(inside)]
        if inside.size:
            ends += [float(np.min(inside)), float(np.max(inside))]
    if one.zero:
        ends += [level.value for level in one.levels]
    return steady_range(ends, zero=one.zero)


def _distinct(entries: Sequence[tuple[str, dict[str, Any]]]) -> list[tuple[str, dict[str, Any]]]:
    """Entries with words, each once."""
    found: dict[str, dict[str, Any]] = {}
    for words, style in entries:
        if words:
            found.setdefault(words, style)
    return list(found.items())
