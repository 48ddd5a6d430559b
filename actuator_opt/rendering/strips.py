"""Strips: frames of curves over the same time, one above the other."""

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
"""Ink of a reference."""
LEVEL: dict[str, Any] = {"stroke": GREY, "pen": 0.18, "dash": (0.9, 0.6)}
LIMIT: dict[str, Any] = {"stroke": RED, "pen": 0.2, "dash": (1.8, 0.8)}
MEASURED: dict[str, Any] = {"stroke": "#a9b4bc", "pen": 0.7}
_EVENT: dict[str, Any] = {"stroke": RED, "pen": 0.13, "dash": (0.4, 0.5)}
_HEAD, _FOOT = 5.2, 7.5
"""Height of the words above every strip and below the last strip [mm]."""
_LEAST = 10.0
"""Minimum height of the frame of a strip [mm] (a choice: room for three numbers beside it)."""


@dataclass(frozen=True, slots=True)
class StripCurve:
    """Values over time, in display units; without words it has no name."""

    words: str
    time: Array
    values: Array
    style: dict[str, Any]


@dataclass(frozen=True, slots=True)
class ConstantLevel:
    """A constant value; without words it has no name."""

    words: str
    value: float
    style: dict[str, Any]


@dataclass(frozen=True, slots=True)
class Strip:
    """A frame of curves over time; if the height is too small, high ranks are dropped first."""

    title: str
    curves: tuple[StripCurve, ...]
    levels: tuple[ConstantLevel, ...] = ()
    zero: bool = False
    """Whether the axis includes zero."""
    rank: int = 1


def stack(
    ink: Ink,
    box: Box,
    strips: Sequence[Strip],
    across: tuple[float, float],
    *,
    marks: Sequence[float] = (),
) -> None:
    """Strips over the same time, one above the other; every strip has `marks` at times [s]."""
    left, top, width, height = box
    shown = _chosen(strips, height)
    if not shown:
        return
    tall = (height - _FOOT) / len(shown) - _HEAD
    for k, strip in enumerate(shown):
        frame = (left, top + k * (tall + _HEAD) + _HEAD, width, tall)
        axes = _drawn(ink, frame, strip, across)
        for instant in marks:
            if across[0] < instant < across[1]:
                x = axes.x(instant)
                ink.line((x, axes.top), (x, axes.top + tall), **_EVENT)
    time_axis(axes)


def _chosen(strips: Sequence[Strip], height: float) -> list[Strip]:
    """The strips that fit into a height [mm], in their order."""
    most = max(2, int((height - _FOOT) / (_HEAD + _LEAST)))
    order = sorted(range(len(strips)), key=lambda k: (strips[k].rank, k))[:most]
    return [strips[k] for k in sorted(order)]


def _drawn(ink: Ink, box: Box, strip: Strip, across: tuple[float, float]) -> Axes:
    """Draw a strip with its title and the names of its curves, but without its time axis."""
    span = _range(strip, across)
    axes = Axes(ink, box, across, span)
    axes.frame_at("", "", [], even_ticks(*span, 2 if box[3] < 9 else 3 if box[3] < 20 else 5))
    ink.text(box[0], box[1] - 2.4, strip.title, size=6.5, bold=True)
    low, high = span
    if low < 0 < high:
        ink.line((box[0], axes.y(0.0)), (box[0] + box[2], axes.y(0.0)), **ZERO)
    levels = [level for level in strip.levels if low <= level.value <= high]
    for level in levels:
        y = axes.y(level.value)
        ink.line((box[0], y), (box[0] + box[2], y), **level.style)
    for curve in strip.curves:
        ink.path(lines(axes, curve.time, curve.values), **curve.style)
    entries: dict[str, dict[str, Any]] = {}
    marks: list[StripCurve | ConstantLevel] = [*strip.curves, *levels]
    for mark in marks:
        if mark.words:
            entries.setdefault(mark.words, mark.style)
    room = box[2] - text_width(strip.title, 6.5, bold=True) - 2.0
    names(ink, box[0] + box[2], box[1] - 2.4, list(entries.items()), room)
    return axes


def _range(strip: Strip, across: tuple[float, float]) -> tuple[float, float]:
    """Range of the values within the time, and of the levels if the axis includes zero."""
    ends: list[float] = []
    for curve in strip.curves:
        inside = curve.values[(curve.time >= across[0]) & (curve.time <= across[1])]
        inside = inside[np.isfinite(inside)]
        if inside.size:
            ends += [float(np.min(inside)), float(np.max(inside))]
    if strip.zero:
        ends += [level.value for level in strip.levels]
    return steady_range(ends, zero=strip.zero)
