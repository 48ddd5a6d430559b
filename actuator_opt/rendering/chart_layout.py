"""Layout of a chart: columns, frames, scales, rows of legends, and styles of lines and points.

Lengths are in mm of paper. The frames of a column share their left and right edge.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import field, replace
from itertools import pairwise
from typing import Any

import numpy as np

from ..base.dataclass import dataclass
from .axes import Ticks, fitted
from .chart import (
    Area,
    Curve,
    Level,
    Panel,
    Points,
    PointWeight,
    Scale,
    Values,
    known,
    scale,
)
from .heights import wrap
from .ink import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    OCHRE,
    PALE,
    RED,
    WHITE,
    Ink,
    text_width,
)

LINES: tuple[dict[str, Any], ...] = (
    {"stroke": BLUE, "pen": 0.4},
    {"stroke": OCHRE, "pen": 0.4, "dash": (1.6, 0.8)},
    {"stroke": GREEN, "pen": 0.35, "dash": (0.8, 0.5)},
    {"stroke": "#7a5a8c", "pen": 0.4, "dash": (2.4, 0.7, 0.4, 0.7)},
    {"stroke": BLACK, "pen": 0.35, "dash": (3.2, 0.8)},
    {"stroke": "#4f86a8", "pen": 0.4, "dash": (0.4, 0.5)},
)
"""Line styles of curves; they differ in dash as well as in colour."""
MARKS = (
    (BLUE, WHITE), (BLACK, "#9ec3da"), (OCHRE, WHITE), (BLACK, BLUE), (GREEN, WHITE),
    ("#7a5a8c", "#d9c9e3"),
)  # fmt: skip
"""Edge and fill of points."""
THIN, GUIDE = 0.2, {"stroke": GREY, "pen": 0.18}
BROAD: dict[str, Any] = {"stroke": "#a9b4bc", "pen": 0.7}
LIMIT: dict[str, Any] = {"stroke": RED, "pen": 0.25, "dash": (1.8, 1.0)}
DOTS = {"normal": (0.75, 0.3), "guide": (0.55, 0.1), "strong": (1.15, 0.45)}
"""Radius and pen of points by weight [mm]."""
SKETCH, BETWEEN = 4.6, 2.6
"""Length of the line samples in the legend, and gap between its entries [mm]."""
GAP, ROW, BELOW = 6.0, 3.7, 2.2
"""Gap between columns, height of a row of words above a frame, gap between two frames [mm]."""
FOOT, APART = 8.4, 1.8
"""Height of ticks and label below a frame, and gap to the title of the next frame [mm]."""
OVER = 2.8
"""Height of a text row directly above a frame, for the name of a marked position on x [mm]."""
LEAST = 4.0
"""Least height of a frame [mm]."""
RIGHT, NAMES = 26.0, 36.0
"""Greatest width of words to the right and to the left of a frame [mm]."""
SHADES = 13.0
"""Width of the colour scale of a map [mm]."""
TITLE, SIZE, SMALL = 6.8, 6.5, 6.2


@dataclass(frozen=True, slots=True)
class LegendEntry:
    """A name of the legend with its line, its point, or both."""

    words: str
    line: dict[str, Any] | None = None
    point: tuple[str, str] | None = None
    small: int | None = None
    weight: PointWeight = "normal"

    @property
    def sketch(self) -> float:
        """Width of line or point before the words."""
        return SKETCH + 1.3 if self.line else 2.0 + DOTS[self.weight][0]

    def width(self) -> float:
        """Width with the gap after the entry."""
        return self.sketch + text_width(self.words, SIZE) + BETWEEN


@dataclass(slots=True)
class Frame:
    """A panel with its scales, the words above it, and its position."""

    panel: Panel
    x: Scale
    y: Scale
    why: str
    label: str = ""
    shared: bool = False
    notes: list[str] = field(default_factory=list)
    rows: list[list[LegendEntry]] = field(default_factory=list)
    beside: bool = True
    above: float = 0.0
    right: float = 0.0
    top: float = 0.0
    height: float = 20.0

    @property
    def head(self) -> float:
        """Height of title, note and legend."""
        lines = len(self.rows) - (1 if self.rows and self.beside else 0)
        return ROW * (1 + lines) + 3.0 * len(self.notes) + OVER * self.over + 0.9

    @property
    def over(self) -> int:
        """Number of text rows above the frame, for the names of marked positions or ranges of x."""
        if self.why:
            return 0
        named = (part.words for part in self.panel.stretches if part.words)
        stretches = max((words.count("\n") + 1 for words in named), default=0)
        return stretches + any(level.words for level in upright_limits(self.panel))


class ColumnLayout:
    """Panels above each other; panels with a common x axis form a group."""

    def __init__(self, parts: Sequence[Panel | Ink]) -> None:
        self.frames: list[Frame] = []
        self.inks = [part for part in parts if isinstance(part, Ink)]
        panels = [part for part in parts if isinstance(part, Panel)]
        group: list[Panel] = []
        for panel in panels:
            group.append(panel)
            if panel.x.label or panel is panels[-1]:
                x = _x_scale(group)
                members = [frame_of(member, x) for member in group]
                members[-1].label = panel.x.label or " "
                members[-1].shared = any(not member.why for member in members)
                self.frames += members
                group = []
        self.left = self.right = self.wide = self.top = 0.0

    @property
    def head(self) -> float:
        """Height of the words above the first frame."""
        return self.frames[0].head if self.frames else 0.0

    def fit(self, room: float, top: float, bottom: float, head: float) -> None:
        """Place the frames in a width `room` and a height [mm]; the first begins below `head`."""
        self.top = top if not self.frames else bottom - sum(ink.height for ink in self.inks)
        if not self.frames:
            return
        ticks = [words for frame in self.frames for _, words in y_ticks(frame)]
        self.left = min(max([text_width(w, SIZE) for w in ticks], default=0.0), NAMES) + 2.0
        self.right = max(_right_room(frame) for frame in self.frames)
        for frame in self.frames:
            before, after = _overhang(frame, room - self.left - self.right)
            self.left, self.right = max(self.left, before), max(self.right, after)
        self.wide = max(room - self.left - self.right, 8.0)
        for frame in self.frames:
            _fit_head(frame, self.wide, self.right)
        height = self.top - top
        heads = [max(self.frames[0].head, head)]
        for upper, lower in pairwise(self.frames):
            heads.append((FOOT + APART if upper.label else BELOW) + lower.head)
        free = height - sum(heads) - FOOT
        shares = [frame.panel.share for frame in self.frames]
        for frame, above, share in zip(self.frames, heads, shares, strict=True):
            frame.top, frame.right = top + above, self.right
            frame.above = above if frame is self.frames[0] else frame.head
            frame.height = max(free * share / sum(shares), LEAST)
            top = frame.top + frame.height


def _overhang(frame: Frame, wide: float) -> tuple[float, float]:
    """Lengths by which tick labels of x extend beyond the left and right end of a frame [mm]."""
    low, high = frame.x.range
    before = after = 0.0
    for place, words in frame.x.ticks(wide, across=True) if frame.label else ():
        half, at = text_width(words, SIZE) / 2, (place - low) / (high - low) * wide
        before, after = max(before, half - at), max(after, at + half - wide)
    return before, after


def _x_scale(panels: Sequence[Panel]) -> Scale:
    """The common scale of x.

    If the panels show only curves that are functions of x, it ends at the extreme values of x.
    """
    axis = panels[-1].x
    values = [
        value
        for panel in panels
        for xs in _xs(panel)
        for value in known(xs, log=axis.log and not axis.signed)
    ]
    for panel in panels:
        for points in panel.points:
            if points.across:
                values += known([*points.low, *points.high])
        if panel.surface is not None and not values:
            values += known(panel.surface.xs)
    bare = not any(panel.points for panel in panels)
    lines = [xs for panel in panels for xs in _xs(replace(panel, points=()))]
    functions = all(map(_rises, lines))
    return scale(axis, values, exact=bare and functions)


def _xs(panel: Panel) -> list[Values]:
    drawn_over: list[Curve | Points | Area] = [*panel.curves, *panel.points, *panel.areas]
    return [part.xs for part in drawn_over]


def _rises(values: Values) -> bool:
    array = np.asarray(values, dtype=float)
    finite = array[np.isfinite(array)]
    return bool(np.all(finite[1:] >= finite[:-1]))


def frame_of(panel: Panel, x: Scale) -> Frame:
    """Frame of a panel; its y axis covers points and curves, and the levels near them."""
    log = panel.y.log and not panel.y.signed
    ends = [v for points in panel.points for v in known(points.ys, log=log)]
    for points in panel.points:
        if not points.across:
            ends += known([*points.low, *points.high], log=log)
    curves = [v for curve in panel.curves for v in _seen(curve, curve.ys, x, log)]
    bands = [v for c in panel.curves for b in (c.low, c.high) for v in _seen(c, b, x, log)]
    for more in (curves, [] if panel.points else bands):
        ends += _near(ends, more, log) if ends else more
    if panel.surface is not None and not ends:
        ends += known(panel.surface.ys, log=log)
    ends += [v for area in panel.areas for v in known([*area.low, *area.high], log=log)]
    levels = known([level.value for level in panel.levels if not level.upright], log=log)
    why = "" if ends or levels else _why(panel)
    if ends:
        levels = _near(ends, levels, log, 3.0, cut=False)
    return Frame(panel, x, scale(panel.y, [*ends, *levels]), why)


def _seen(curve: Curve, values: Values, x: Scale, log: bool) -> list[float]:
    """The values of a curve (or of a bound of its band) at points within the range of x."""
    if not len(values):
        return []
    places = x.at(curve.xs)
    inside = (places >= x.range[0] - 1e-9) & (places <= x.range[1] + 1e-9)
    return known(np.asarray(values, dtype=float)[inside], log=log)


def _near(
    ends: Sequence[float],
    values: Sequence[float],
    log: bool,
    most: float = 0.5,
    *,
    cut: bool = True,
) -> list[float]:
    """The values that lie in a range or near it: beyond its ends by at most `most` times its width.

    Values farther away are moved to this distance if `cut` is True; otherwise they are left out.
    """
    low, high = (math.log10(f(ends)) if log else f(ends) for f in (min, max))
    spare = most * ((high - low) or max(abs(high), 1.0))
    low, high = (10.0 ** min(max(v, -100), 150) if log else v for v in (low - spare, high + spare))
    if not cut:
        return [v for v in values if low <= v <= high]
    return [min(max(v, low), high) for v in values]


def _why(panel: Panel) -> str:
    """Reason why a panel is empty, in words."""
    if panel.note:
        return panel.note
    if not any(len(xs) for xs in _xs(panel)):
        return "No values."
    logs = (panel.x.log and not panel.x.signed) or (panel.y.log and not panel.y.signed)
    return "No value above zero." if logs else "No value is a number."


def y_ticks(frame: Frame) -> Ticks:
    """Ticks of the y axis; none in an empty frame."""
    return [] if frame.why else frame.y.ticks(frame.height, across=False)


def _fit_head(frame: Frame, wide: float, right: float) -> None:
    """Place the rows of the legend: beside the title if they fit there, else below it."""
    panel = frame.panel
    note = "" if frame.why else panel.note
    frame.notes = wrap(note, wide + right - 0.5, SMALL) if note else []
    entries = [] if frame.why else list(_entries(frame, wide))
    whole = text_width(panel.title, TITLE, bold=True) + 2.0 - BETWEEN
    whole += sum(entry.width() for entry in entries)
    frame.beside = not frame.notes and whole <= wide
    frame.rows = []
    room = 0.0
    for entry in entries:
        if not frame.rows or (not frame.beside and entry.width() > room + BETWEEN):
            frame.rows.append([])
            room = wide
        frame.rows[-1].append(entry)
        room -= entry.width()


def _entries(frame: Frame, wide: float) -> Iterator[LegendEntry]:
    """Legend entries of points, curves and full-width `Level` lines, without duplicates."""
    panel, entries = frame.panel, dict[str, LegendEntry]()

    def add(words: str, **sketch: Any) -> None:
        if words:
            known = entries.get(words)
            line = sketch.get("line") or (known.line if known else None)
            point = sketch.get("point") or (known.point if known else None)
            room = wide - (SKETCH + 1.3 if line else 2.8)
            small, weight = sketch.get("small"), sketch.get("weight", "normal")
            entries[words] = LegendEntry(fitted(words, room, SIZE), line, point, small, weight)

    for k, points in enumerate(panel.points):
        style = k if points.style is None else points.style
        if points.small:
            add(points.words, small=style)
        else:
            add(points.words, point=point_style(points, style), weight=points.weight)
    for k, curve in enumerate(panel.curves):
        words = curve.words or ("" if curve in curves_named_at_end(frame) else curve.end)
        if words:
            line = line_style(curve, k)
            add(words, line=line | {"pen": max(line["pen"], 0.4)})
    for level in panel.levels:
        if not level.sense and level.between is None:
            add(level.words, line=level_style(level))
    yield from entries.values()


def line_style(curve: Curve, index: int) -> dict[str, Any]:
    """Colour, width and dashes of a curve, by its style or its position among the curves."""
    style = LINES[(index if curve.style is None else curve.style) % len(LINES)]
    if curve.weight == "thin":
        style = style | {"pen": THIN}
    elif curve.weight != "normal":
        style = GUIDE if curve.weight == "guide" else BROAD
    if curve.dash is None:
        return style
    return style | {"dash": LINES[curve.dash % len(LINES)].get("dash", ())}


def level_style(level: Level) -> dict[str, Any]:
    """Colour, width and dashes of a `Level` line; limits are red."""
    if level.sense and level.between is not None:
        return LIMIT | {"pen": 0.4, "dash": ()}
    return LIMIT if level.sense else LINES[level.style % len(LINES)] | {"pen": 0.3}


def curves_named_at_end(frame: Frame) -> list[Curve]:
    """Curves with words at their right end; empty if the frame is too low for all of them."""
    curves = [curve for curve in frame.panel.curves if curve.end]
    limits = sum(bool(level.sense) for level in frame.panel.levels if not level.upright)
    limits += len(frame.panel.areas)
    return curves if 2.7 * (len(curves) + limits) <= frame.height - 1.0 else []


def _right_room(frame: Frame) -> float:
    words = [curve.end for curve in curves_named_at_end(frame)]
    limits = [level for level in frame.panel.levels if level.sense and not level.upright]
    words += [level.words + " ↑" for level in limits if level.words]
    words += [area.words + " " * 3 for area in frame.panel.areas]  # blanks leave the swatch space
    room = min(max(text_width(w, SIZE) for w in words), RIGHT) + 2.0 if words else 0.5
    return room + (SHADES if frame.panel.surface is not None and not frame.why else 0.0)


def point_style(points: Points, style: int) -> tuple[str, str]:
    """Edge and fill of points."""
    if points.weight == "guide":
        return PALE, PALE
    if points.weight == "strong":
        return RED, WHITE
    return MARKS[style % len(MARKS)]


def upright_limits(panel: Panel) -> list[Level]:
    """The limits on x, drawn as vertical lines."""
    return [level for level in panel.levels if level.upright and level.sense]
