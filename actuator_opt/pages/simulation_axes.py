"""Axes of the figures of a Simulation: strips over one time, curves named above their frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..base.numeric import Array
from ..rendering.axes import Axes, Box, even_range, even_ticks, fitted, spaced, thinned
from ..rendering.ink import BLACK, BLUE, GREY, RED, Ink, Point, text_width
from .wall_figures import GREEN, OCHRE

COLOURS = (BLUE, OCHRE, GREEN, "#7a5a8c", RED, "#4f86a8", BLACK, "#b98b3e")
DASHES: tuple[tuple[float, ...], ...] = (
    (), (1.6, 0.8), (2.4, 0.7, 0.4, 0.7), (0.8, 0.5), (3.2, 0.8), (0.4, 0.5),
)  # fmt: skip
STYLES: tuple[dict[str, Any], ...] = tuple(
    {"stroke": colour, "pen": 0.28, "dash": dash}
    for colour, dash in zip(COLOURS[:4], DASHES[:4], strict=True)
)
ASKED: dict[str, Any] = {"stroke": BLACK, "pen": 0.2, "dash": (0.9, 0.6)}
"""What was asked for."""
LEVEL: dict[str, Any] = {"stroke": GREY, "pen": 0.18, "dash": (0.9, 0.6)}
LIMIT: dict[str, Any] = {"stroke": RED, "pen": 0.2, "dash": (1.8, 0.8)}
ZERO: dict[str, Any] = {"stroke": GREY, "pen": 0.13}
MEASURED: dict[str, Any] = {"stroke": "#a9b4bc", "pen": 0.7}
EVENT: dict[str, Any] = {"stroke": RED, "pen": 0.13, "dash": (0.4, 0.5)}
SIZE = 6.2
"""Type of the names of curves [pt]."""
HEAD, FOOT = 5.2, 7.5
"""Height of the words above a strip and below the last one [mm]."""
LEAST_STRIP = 10.0
"""Least height of the frame of a strip [mm] (a choice: three numbers beside it)."""
DENSE = 8
"""Values of a thinned curve per mm (a choice: four pairs, finer than the pen)."""
MOST_JUMPS = 500
"""Instants that stand twice and are kept as they are."""
SHORT = 0.1
"""Time below which an axis counts milliseconds [s]."""


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


def time_words(span: float, words: str = "time") -> tuple[str, float]:
    """Label of a time axis, and what is shown over seconds.

    >>> time_words(5.0), time_words(0.02)
    (('time, s', 1.0), ('time, ms', 1000.0))
    """
    return (f"{words}, ms", 1e3) if span < SHORT else (f"{words}, s", 1.0)


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


def steady_range(ends: Sequence[float], *, zero: bool = False) -> tuple[float, float]:
    """`even_range`, wide enough to show what does not move as a straight line."""
    low, high = even_range(ends, zero=zero)
    size = max((abs(v) for v in ends), default=0.0)
    least = 1e-6 * size if size > 1e-12 else 1.0
    if high - low >= least:
        return low, high
    middle = (low + high) / 2
    return middle - 0.05 * max(size, 1e-9), middle + 0.05 * max(size, 1e-9)


def lines(axes: Axes, time: Array, values: Array) -> list[list[Point]]:
    """A curve on paper, thinned, cut where it leaves the frame or has no value."""
    inside = (time >= axes.x_range[0]) & (time <= axes.x_range[1]) & np.isfinite(values)
    known = np.flatnonzero(inside)
    jumps = np.flatnonzero(np.diff(time) == 0)  # an instant stands twice: upright, not aslant
    jumps = np.union1d(jumps, jumps + 1) if jumps.size < MOST_JUMPS else jumps[:0]
    found: list[list[Point]] = []
    for run in np.split(known, np.flatnonzero(np.diff(known) > 1) + 1):
        if run.size > 1:
            at = run[thinned(values[run], max(int(DENSE * axes.width), 16))]
            at = np.union1d(at, np.intersect1d(run, jumps))
            found += axes.clipped([float(t) for t in time[at]], [float(v) for v in values[at]])
    return found


def time_axis(axes: Axes, words: str = "time") -> None:
    """Ticks, numbers and the name of the time below a frame, whose range is in seconds."""
    label, scale = time_words(axes.x_range[1] - axes.x_range[0], words)
    x_axis(axes, label, scale)


def x_axis(axes: Axes, label: str, scale: float = 1.0) -> None:
    """Ticks of an x axis that shows its values times `scale`; their numbers only with a label."""
    bottom = axes.top + axes.height
    low, high = (scale * v for v in axes.x_range)
    ticks = even_ticks(low, high, max(2, int(axes.width / 11)))
    for value, said in spaced([(v / scale, w, 1) for v, w in ticks], axes):
        x = axes.x(value)
        axes.ink.line((x, bottom), (x, bottom + 1.0), pen=0.13)
        if label:
            axes.ink.text(x, bottom + 2.8, said, anchor="center")
    if label:
        middle = axes.left + axes.width / 2
        axes.ink.text(middle, bottom + 6.0, label, anchor="center", color=GREY)


def _distinct(entries: Sequence[tuple[str, dict[str, Any]]]) -> list[tuple[str, dict[str, Any]]]:
    """Entries with words, each once."""
    found: dict[str, dict[str, Any]] = {}
    for words, style in entries:
        if words:
            found.setdefault(words, style)
    return list(found.items())


def names(
    ink: Ink, right: float, y: float, entries: Sequence[tuple[str, dict[str, Any]]], room: float
) -> None:
    """Names of curves in one line that ends at `right`, each after its line, cut to the room."""
    if not entries:
        return
    words = [one for one, _ in entries]
    for line, gap in ((4.0, 2.2), (2.8, 1.4)):
        left = room + gap - len(entries) * (line + 0.8 + gap)
        if sum(text_width(one, SIZE) for one in words) <= left:
            break
    while len(words) > 1 and sum(text_width(one, SIZE) for one in words) > left:
        widest = max(range(len(words)), key=lambda k: text_width(words[k], SIZE))
        cut = fitted(words[widest], text_width(words[widest], SIZE) - 0.5, SIZE)
        if len(cut) < 3:
            break
        words[widest] = cut
    x = right + gap - sum(text_width(one, SIZE) + line + 0.8 + gap for one in words)
    for one, (_, style) in zip(words, entries, strict=True):
        ink.line((x, y), (x + line, y), **style)
        ink.text(x + line + 0.8, y, one, size=SIZE)
        x += line + 0.8 + text_width(one, SIZE) + gap
