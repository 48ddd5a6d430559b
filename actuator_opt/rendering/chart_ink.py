"""A chart as ink: curves, points, areas, levels and labels in the frames of the layout.

Legends are above their frame. Names of limits and of curve ends are to its right, without overlaps.
Curves are cut at the frame. In a frame without values, words state the reason.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from ..base.numeric import Array
from . import contours
from .axes import AREAS, Axes, Box, Ticks, band, fitted, thinned
from .blocks import Chart
from .chart import (
    Area,
    Curve,
    Level,
    Panel,
    Points,
    Scale,
    Stretch,
    known,
)
from .chart_layout import (
    BETWEEN,
    DOTS,
    GAP,
    GUIDE,
    LINES,
    MARKS,
    NAMES,
    OVER,
    RIGHT,
    ROW,
    SIZE,
    SKETCH,
    SMALL,
    TITLE,
    ColumnLayout,
    Frame,
    LegendEntry,
    curves_named_at_end,
    level_style,
    line_style,
    point_style,
    upright_limits,
    y_ticks,
)
from .heights import wrap
from .ink import (
    BLACK,
    GREY,
    PALE,
    RED,
    WHITE,
    Anchor,
    Ink,
    Point,
    hatch,
    spread_within,
    text_width,
)

STRETCHES = ("#e2e7eb", "#f1f3f5", "#f6efdc")
"""Fills of shaded stretches of x."""
SWATCH = 2.8
"""Width of the colour sample before the name of an area [mm]."""
LOOP = 4
"""A loop (a curve with several values at an x) keeps this many times as many values as a function
of x when it is thinned (our choice)."""
JUMPS = 500
"""Largest number of jumps (x with two values) that a thinned curve keeps."""
DENSE = 10.0
"""Largest number of curve values or points drawn per mm of paper (our choice: finer than the pen).
"""
Line: TypeAlias = list[Point]


def drawn(chart: Chart, *, width: float = 180.0, height: float | None = None) -> Ink:
    """The chart as a drawing; `width` and `height` in mm, default: its stated height."""
    tall = chart.height if height is None else height
    ink = Ink(width, tall)
    top = _key(ink, chart.key)
    columns = [ColumnLayout(parts) for parts in chart.columns if parts]
    shares = [*chart.widths, *[1.0] * len(columns)][: len(columns)]
    room = width - GAP * (len(columns) - 1)
    wides = [room * share / sum(shares) for share in shares]
    for _ in range(3):  # ticks depend on the height, heights on the rows of the legend
        row = all(len(column.frames) == 1 for column in columns)
        head = max((column.head for column in columns), default=0.0) if row else 0.0
        for column, wide in zip(columns, wides, strict=True):
            column.fit(wide, top, tall, head)
    left = 0.0
    for column, wide in zip(columns, wides, strict=True):
        _column(ink, column, left)
        left += wide + GAP
    return ink


def _key(ink: Ink, curves: Sequence[Curve]) -> float:
    """Draw names of curves in equal columns above all panels; return the height of their rows."""
    if not curves:
        return 0.0
    entries = [LegendEntry(curve.words, line_style(curve, k)) for k, curve in enumerate(curves)]
    longest = min(max(entry.width() for entry in entries), ink.width / 2)
    columns = max(1, min(len(entries), int(ink.width / longest)))
    wide = ink.width / columns
    for k, entry in enumerate(entries):
        words = fitted(entry.words, wide - entry.sketch - BETWEEN, SIZE)
        place = wide * (k % columns), ROW * (k // columns) + 1.8
        _legend(ink, *place, [replace(entry, words=words)])
    return ROW * -(-len(entries) // columns) + 2.0


def titled(chart: Chart, notes: Sequence[str] = (), *, width: float = 180.0) -> Ink:
    """The chart as a separate picture, with title and notes above and its own note below."""
    ink = Ink(width, 0.0)
    room = width - 4.0
    ink.text(2.0, 3.0, fitted(chart.title, 0.88 * room, 9.0), size=9.0, bold=True)
    top = 7.6
    for words in (words for note in notes for words in wrap(note, room, SIZE)):
        ink.text(2.0, top, words, size=SIZE, color=GREY)
        top += 3.3
    ink.paste(drawn(chart, width=room), 2.0, top)
    ink.height = top + chart.height + 2.0
    below = chart.note.split("\n") if chart.note else []
    for words in (words for part in below for words in wrap(part, room, SMALL)):
        ink.text(2.0, ink.height, words, size=SMALL, color=GREY)
        ink.height += 3.1
    return ink


def _column(ink: Ink, column: ColumnLayout, left: float) -> None:
    """Draw all frames of a column, and the pictures below them."""
    for frame in column.frames:
        _draw(ink, (left + column.left, frame.top, column.wide, frame.height), frame, left)
    top = column.top
    for own in column.inks:
        ink.paste(own, left, top)
        top += own.height


def _draw(ink: Ink, box: Box, frame: Frame, edge: float) -> None:
    """Draw a frame with its content; `edge` is the left end of its column."""
    panel, x, label = frame.panel, frame.x, frame.label
    _head(ink, box, frame, edge)
    axes = Axes(ink, box, x.range, frame.y.range)
    x_ticks = x.ticks(box[2], across=True)
    if frame.why:
        _empty(ink, box, frame.why)
        if frame.shared:
            axes.frame_at("", label, x_ticks, [])
        return
    heights = [(at, fitted(words, NAMES, SIZE)) for at, words in y_ticks(frame)]
    if panel.surface is not None:
        bounds = _shaded(axes, frame, x)
        _outside_ticks(axes, x_ticks, heights, label)
    else:
        bounds = []
        _stretches(axes, panel.stretches, x)
        for curve in panel.curves:
            if len(curve.low):
                _band(axes, curve, frame.y, x)
        axes.frame_at("", label, x_ticks, heights, upright=True)
        for area in panel.areas:
            _area(axes, area, frame.y, x)
        _zero_lines(axes, frame, x)
    lines = [_curve(axes, curve, k, frame.y, x) for k, curve in enumerate(panel.curves)]
    for level in panel.levels:
        if level.upright:
            _upright(axes, level, x)
        else:
            _level(axes, level, frame.y, x)
    _words_over(axes, panel, x)
    spots = [_spots(axes, points, k, frame.y, x, bounds) for k, points in enumerate(panel.points)]
    _right_words(axes, frame, lines)
    drawn_points = [p for part in lines for line in part for p in _dotted(line)]
    drawn_points += [spot for part in spots for spot in part]
    for level in panel.levels:
        if level.between is not None and level.words and not (level.sense or level.upright):
            _beside(axes, level, frame.y, x, drawn_points)
    if any(points.labels for points in panel.points):
        drawn_points += [spot for line in _level_lines(axes, frame, x) for spot in _dotted(line)]
    for k, points in enumerate(panel.points):
        _labels(axes, points, k, frame.y, x, drawn_points)


def _area(axes: Axes, area: Area, y: Scale, x: Scale) -> None:
    """Draw a filled area with a white upper edge."""
    xs, low, high = (scale.at(v) for scale, v in ((x, area.xs), (y, area.low), (y, area.high)))
    paint = AREAS[area.fill % len(AREAS)]
    places, lower, upper = xs.tolist(), low.tolist(), high.tolist()
    band(axes, places, lower, upper, fill=paint)
    edge = [(axes.x(a), axes.y(b)) for a, b in zip(places, upper, strict=True) if a == a and b == b]
    axes.ink.path(_cut(edge, axes), stroke=WHITE, pen=0.12)


def _band(axes: Axes, curve: Curve, y: Scale, x: Scale) -> None:
    """Draw the band around a curve; a log axis shows bounds at or below zero at its lower end."""
    xs, low, high = x.at(curve.xs), y.at(curve.low), y.at(curve.high)
    low = np.where(np.asarray(curve.low) <= 0, np.fmax(low, axes.y_range[0]), low)
    inside = (xs >= axes.x_range[0]) & (xs <= axes.x_range[1])
    places = np.where(inside, xs, axes.x_range[0])
    band(axes, places.tolist(), np.where(inside, low, np.nan).tolist(), high.tolist())


def _head(ink: Ink, box: Box, frame: Frame, edge: float) -> None:
    """Draw title, note and legend, from the frame upwards."""
    left, wide = box[0] - 1.4, box[2] + frame.right
    title, y = frame.panel.title, box[1] - frame.above + 1.6
    if text_width(title, TITLE, bold=True) > wide:
        left, wide = edge, box[0] + box[2] + frame.right - edge
    ink.text(left, y, fitted(title, wide / 1.1, TITLE), size=TITLE, bold=True)
    for k, words in enumerate(frame.notes):
        ink.text(box[0], y + ROW + 3.0 * k, words, size=SMALL, color=GREY)
    if frame.beside and frame.rows:
        long = sum(entry.width() for entry in frame.rows[0]) - BETWEEN
        _legend(ink, box[0] + box[2] - long, y, frame.rows[0])
        return
    y += 3.0 * len(frame.notes)
    for row in frame.rows:
        y += ROW
        _legend(ink, box[0], y, row)


def _legend(ink: Ink, x: float, y: float, row: Sequence[LegendEntry]) -> None:
    for entry in row:
        if entry.line is not None:
            ink.line((x, y), (x + SKETCH, y), **entry.line)
        middle = x + (SKETCH / 2 if entry.line else 1.0)
        if entry.point is not None:
            radius, pen = DOTS[entry.weight]
            ink.circle(middle, y, radius, fill=entry.point[1], stroke=entry.point[0], pen=pen)
        if entry.small is not None:
            _small(ink, middle, y, entry.small)
        ink.text(x + entry.sketch, y, entry.words, size=SIZE)
        x += entry.width()


def _empty(ink: Ink, box: Box, why: str) -> None:
    ink.box(*box, stroke=PALE, pen=0.13)
    lines = wrap(why, max(box[2] - 4.0, 8.0), SIZE)[: max(int((box[3] - 1.0) / 3.1), 1)]
    first = box[1] + box[3] / 2 - 3.1 * (len(lines) - 1) / 2
    for k, line in enumerate(lines):
        ink.text(box[0] + box[2] / 2, first + 3.1 * k, line, anchor="center", color=GREY)


def _zero_lines(axes: Axes, frame: Frame, x: Scale) -> None:
    """Draw lines at zero inside linear and signed axes."""
    (left, right), (bottom, top) = axes.x_range, axes.y_range
    own = frame.panel
    if not (own.y.log and not own.y.signed) and not own.y.names and bottom < 0 < top:
        axes.ink.line((axes.x(left), axes.y(0.0)), (axes.x(right), axes.y(0.0)), **GUIDE)
    if not (own.x.log and not own.x.signed) and left < 0 < right:
        axes.ink.line((axes.x(0.0), axes.y(bottom)), (axes.x(0.0), axes.y(top)), **GUIDE)


def _curve(axes: Axes, curve: Curve, index: int, y: Scale, x: Scale) -> list[Line]:
    """Draw a curve: thinned, interrupted where it has no value, cut at the frame."""
    xs, ys = x.at(curve.xs), y.at(curve.ys)
    style = line_style(curve, index)
    defined = np.flatnonzero(np.isfinite(xs) & np.isfinite(ys))
    lines: list[Line] = []
    most = int(DENSE * axes.width)
    for run in np.split(defined, np.flatnonzero(np.diff(defined) > 1) + 1):
        if run.size == 1:
            at = axes.x(float(xs[run[0]])), axes.y(float(ys[run[0]]))
            if _inside(axes, at):
                axes.ink.circle(*at, 0.4, fill=style["stroke"], stroke=None)
                lines.append([at])
            continue
        if run.size:
            indices = run[_kept(xs[run], ys[run], max(8, most * run.size // defined.size))]
            paper = [(axes.x(float(xs[k])), axes.y(float(ys[k]))) for k in indices]
            lines += _cut(paper, axes)
    axes.ink.path([line for line in lines if len(line) > 1], **style)
    return lines


def _kept(xs: Array, ys: Array, most: int) -> Array:
    """Indices of the values that are drawn: the extremes of every short interval, and jumps."""
    steps = np.diff(xs)
    if np.any(steps < 0):  # a loop: any stretch of it may be long on paper
        return np.union1d(*(thinned(values, LOOP * most) for values in (xs, ys)))
    kept = thinned(ys, most)
    jumps = np.flatnonzero(steps == 0)
    if kept.size == ys.size or not 0 < jumps.size < JUMPS:
        return kept
    return np.union1d(kept, [*jumps, *jumps + 1])


def _inside(axes: Axes, at: Point) -> bool:
    right, bottom = axes.left + axes.width, axes.top + axes.height
    return axes.left - 0.01 <= at[0] <= right + 0.01 and axes.top - 0.01 <= at[1] <= bottom + 0.01


def _cut(line: Sequence[Point], axes: Axes) -> list[Line]:
    """The parts of a line inside the frame (Liang and Barsky 1984)."""
    box = ((axes.left, axes.left + axes.width), (axes.top, axes.top + axes.height))
    parts: list[Line] = []
    for start, end in pairwise(line):
        first, last = 0.0, 1.0
        for k, (low, high) in enumerate(box):
            step = end[k] - start[k]
            if step == 0:
                if not low - 1e-9 <= start[k] <= high + 1e-9:
                    last = -1.0
                continue
            near, far = sorted(((low - start[k]) / step, (high - start[k]) / step))
            first, last = max(first, near), min(last, far)
        if first >= last:
            continue
        a, b = ((start[0] + t * (end[0] - start[0]), start[1] + t * (end[1] - start[1]))
                for t in (first, last))  # fmt: skip
        if first > 0.0 or not parts or parts[-1][-1] != start:
            parts.append([a])
        parts[-1].append(end if last == 1.0 else b)
    return parts


def _spots(
    axes: Axes, points: Points, index: int, y: Scale, x: Scale, bounds: Sequence[float]
) -> list[Point]:
    """Draw points with error bars; crowded points are thinned."""
    style = index if points.style is None else points.style
    edge, fill = point_style(points, style)
    radius, pen = DOTS[points.weight]
    color = str(LINES[style % len(LINES)]["stroke"]) if points.small else edge
    xs, ys = x.at(points.xs), y.at(points.ys)
    defined = np.flatnonzero(np.isfinite(xs) & np.isfinite(ys))
    places = [(axes.x(float(xs[k])), axes.y(float(ys[k]))) for k in defined]
    inside = [n for n, at in enumerate(places) if _inside(axes, at)]
    bars: list[Point] = []
    if len(inside) > 400:
        cells = {(round(places[n][0] * 2), round(places[n][1] * 2)): n for n in inside}
        inside = sorted(cells.values())
    for n in inside:
        at, k = places[n], int(defined[n])
        if len(points.low):
            bars += _bar(axes, points, k, at, y, x, color)
        if points.small:
            _small(axes.ink, *at, style)
        elif len(points.shades) and bounds:
            paints = contours.shades(len(bounds) - 1)
            shade = min(max(bisect_right(bounds, points.shades[k]) - 1, 0), len(paints) - 1)
            axes.ink.circle(*at, 1.15, fill=WHITE, stroke=None)
            axes.ink.circle(*at, 0.9, fill=paints[shade], stroke=BLACK, pen=0.18)
        else:
            axes.ink.circle(*at, radius, fill=fill, stroke=edge, pen=pen)
    return [*(places[n] for n in inside), *bars]


def _bar(axes: Axes, points: Points, k: int, at: Point, y: Scale, x: Scale, color: str) -> Line:
    """Draw an error bar, cut at the frame; returns points along it.

    An end inside the frame has a cap.
    """
    along, on_paper = (x, axes.x) if points.across else (y, axes.y)
    bottom, top = along.range
    ends = (points.low[k], points.high[k])
    if any(math.isnan(end) for end in ends):
        return []
    low, high = (float(end) for end in along.at(ends))
    low = low if math.isfinite(low) else bottom - 1.0  # not shown: beyond the frame
    high = high if math.isfinite(high) else top + 1.0
    if high < bottom or low > top:
        return []

    def spot(place: float, aside: float = 0.0) -> Point:
        return (place, at[1] + aside) if points.across else (at[0] + aside, place)

    first, last = on_paper(max(low, bottom)), on_paper(min(high, top))
    pen, foot = (0.4, 0.9) if points.across else (0.2, 0.7)
    if points.across and last - first < 2.0:  # hidden behind its point
        return []
    axes.ink.line(spot(first), spot(last), pen=pen, stroke=color)
    for end, place in ((low, first), (high, last)):
        if bottom <= end <= top:
            axes.ink.line(spot(place, -foot), spot(place, foot), pen=pen, stroke=color)
    return list(_dotted([spot(first), spot(last)]))


def _small(ink: Ink, x: float, y: float, style: int) -> None:
    """Draw a small dot, or a cross for odd styles."""
    color = LINES[style % len(LINES)]["stroke"]
    if style % 2 == 0:
        ink.circle(x, y, 0.6, fill=color, stroke=None)
        return
    for side in (-0.7, 0.7):
        ink.line((x - 0.7, y - side), (x + 0.7, y + side), pen=0.25, stroke=color)


def _level(axes: Axes, level: Level, y: Scale, x: Scale) -> None:
    """Draw a `Level` as a horizontal line; the forbidden side of a limit is hatched."""
    place = y.place(level.value)
    if not axes.y_range[0] <= place <= axes.y_range[1]:
        return
    at, left, right = axes.y(place), axes.left, axes.left + axes.width
    if level.between is not None:
        left, right = sorted(_ends(axes, level.between, x))
    axes.ink.line((left, at), (right, at), **level_style(level))
    if level.sense:
        side = 1.3 if level.sense == "min" else -1.3
        edge = min(max(at + side, axes.top), axes.top + axes.height)
        strip = [(left, at), (right, at), (right, edge), (left, edge)]
        axes.ink.path(hatch([strip], angle=45.0, spacing=0.9), pen=0.1, stroke=RED)


def _upright(axes: Axes, level: Level, x: Scale) -> None:
    """Draw a `Level` as a vertical line; the forbidden side of a limit is hatched."""
    place = x.place(level.value)
    if not axes.x_range[0] <= place <= axes.x_range[1]:
        return
    at, top, bottom = axes.x(place), axes.top, axes.top + axes.height
    axes.ink.line((at, top), (at, bottom), **level_style(level))
    if level.sense:
        side = -1.3 if level.sense == "min" else 1.3
        edge = min(max(at + side, axes.left), axes.left + axes.width)
        strip = [(at, top), (edge, top), (edge, bottom), (at, bottom)]
        axes.ink.path(hatch([strip], angle=45.0, spacing=0.9), pen=0.1, stroke=RED)


def _stretches(axes: Axes, stretches: Sequence[Stretch], x: Scale) -> None:
    """Draw shaded ranges of x, with a white line between neighbours."""
    for part in stretches:
        left, right = sorted(_ends(axes, (part.start, part.end), x))
        fill = STRETCHES[part.shade % len(STRETCHES)]
        axes.ink.box(left, axes.top, right - left, axes.height, fill=fill, stroke=None)
    ends = {part.end for part in stretches}
    for place in (x.place(part.start) for part in stretches if part.start in ends):
        if axes.x_range[0] <= place <= axes.x_range[1]:
            at, bottom = axes.x(place), axes.top + axes.height
            axes.ink.line((at, axes.top), (at, bottom), stroke=WHITE, pen=0.35)


def _ends(axes: Axes, between: tuple[float, float], x: Scale) -> tuple[float, float]:
    """Positions on paper of both ends of a short horizontal line, cut at the frame [mm].

    An end with no position on the x axis (zero on a logarithmic axis) is put at the left edge.
    """
    low, high = axes.x_range
    start, end = np.clip(np.nan_to_num(x.at(between), nan=low), low, high)
    return axes.x(float(start)), axes.x(float(end))


def _words_over(axes: Axes, panel: Panel, x: Scale) -> None:
    """Write names of stretches and of vertical limits above the frame, if they fit."""
    y, right = axes.top - 1.7, axes.left + axes.width
    limits = [level for level in upright_limits(panel) if level.words]
    limits = sorted((level for level in limits if math.isfinite(x.place(level.value))),
                    key=lambda level: x.place(level.value))  # fmt: skip
    if limits:
        low, high = axes.x_range
        names = [fitted(level.words, axes.width / len(limits) - 1.0, SIZE) for level in limits]
        widths = [text_width(name, SIZE) for name in names]
        wanted = [axes.x(min(max(x.place(level.value), low), high)) for level in limits]
        gaps = [(a + b) / 2 + 1.0 for a, b in pairwise(widths)]
        places = spread_within(wanted, gaps, axes.left + widths[0] / 2, right - widths[-1] / 2)
        for name, at in zip(names, places, strict=True):
            axes.ink.text(at, y, name, size=SIZE, anchor="center", color=RED)
        y -= OVER
    lines = [part.words.split("\n") for part in panel.stretches]
    count = max(map(len, lines), default=0)
    for k in range(count):
        free = axes.left
        for part, words in zip(panel.stretches, lines, strict=True):
            if k >= len(words) or not words[k]:
                continue
            start, end = sorted(_ends(axes, (part.start, part.end), x))
            middle, half = (start + end) / 2, text_width(words[k], SMALL) / 2
            fits = 2 * half <= end - start + 1.0
            if fits and middle - half >= free and middle + half <= right:
                level = y - OVER * (count - 1 - k)
                axes.ink.text(middle, level, words[k], size=SMALL, anchor="center", color=GREY)
                free = middle + half + 0.8


def _right_words(axes: Axes, frame: Frame, lines: Sequence[Sequence[Line]]) -> None:
    """Write names of curve ends, limits and areas right of the frame, near their positions."""
    low, high = axes.top, axes.top + axes.height
    labels: list[tuple[float, str, str]] = []
    paints: dict[str, str] = {}
    for area in frame.panel.areas:
        known_ends = frame.y.at([area.low[-1], area.high[-1]])
        if np.isfinite(known_ends).all():
            labels.append((axes.y(float(np.mean(known_ends))), area.words, BLACK))
            paints[area.words] = AREAS[area.fill % len(AREAS)]
    ends = curves_named_at_end(frame)
    for k, (curve, parts) in enumerate(zip(frame.panel.curves, lines, strict=True)):
        if curve in ends and parts:
            last = max((line[-1] for line in parts), key=lambda at: at[0])
            labels.append((last[1], curve.end, str(line_style(curve, k)["stroke"])))
    for level in frame.panel.levels:
        if level.sense and level.words and not level.upright:
            place = frame.y.place(level.value)
            words = level.words
            if not place >= axes.y_range[0]:
                place, words = axes.y_range[0], f"{words} ↓"
            elif place > axes.y_range[1]:
                place, words = axes.y_range[1], f"{words} ↑"
            labels.append((axes.y(place), words, RED))
    labels.sort()
    most = max(int((axes.height + 2.0) / 2.7), 1)
    labels = labels[:most]
    heights = [y for y, _, _ in labels]
    places = spread_within(heights, [2.9] * len(heights), low + 0.5, high - 0.5)
    right = axes.left + axes.width
    for (y, words, color), at in zip(labels, places, strict=True):
        if abs(at - y) > 1.4:
            axes.ink.line((right + 0.2, y), (right + 1.3, at), pen=0.1, stroke=color)
        if words in paints:
            axes.ink.box(right + 1.6, at - 1.1, 2.2, 2.2, fill=paints[words], pen=0.1)
            axes.ink.text(right + 1.6 + SWATCH, at, fitted(words, RIGHT - SWATCH, SIZE))
            continue
        axes.ink.text(right + 1.6, at, fitted(words, RIGHT, SIZE), color=color)


def _beside(axes: Axes, level: Level, y: Scale, x: Scale, drawn_points: Sequence[Point]) -> None:
    """Write the name of a short `Level` line on the side where it crosses the fewest lines."""
    place = y.place(level.value)
    if level.between is None or not axes.y_range[0] <= place <= axes.y_range[1]:
        return
    start, end = _ends(axes, level.between, x)
    way = 1.0 if end >= start else -1.0
    before: Anchor = "right" if way > 0 else "left"
    beyond: Anchor = "left" if way > 0 else "right"
    at = axes.y(place)
    sides: list[tuple[float, Anchor, float]] = []
    for dy in (0.0, -2.6, 2.6):
        sides += [(start - 1.2 * way, before, dy), (end + 1.2 * way, beyond, dy)]
    sides += [((start + end) / 2, "center", dy) for dy in (-2.0, 2.0)]
    sides = [(across, anchor, at + dy) for across, anchor, dy in sides]
    _written(axes, level.words, sides, drawn_points, str(level_style(level)["stroke"]))


def _written(
    axes: Axes,
    words: str,
    sides: Sequence[tuple[float, Anchor, float]],
    drawn_points: Sequence[Point],
    color: str,
    *,
    halo: bool = False,
) -> None:
    """Write words on the side where they cross the fewest lines.

    They are left out if other words are on every side.
    """
    wide = text_width(words, 6.0)
    best: tuple[int, float, Anchor, float] | None = None
    text_boxes = [box[1:] for box in axes.ink.text_boxes()]
    for across, anchor, at in sides:
        left = across - {"left": 0.0, "center": wide / 2, "right": wide}[anchor]
        box = (left - 0.3, at - 1.0, left + wide + 0.3, at + 1.0)
        if not (_inside(axes, box[:2]) and _inside(axes, box[2:])) or any(
            box[0] < b[2] and b[0] < box[2] and box[1] < b[3] and b[1] < box[3] for b in text_boxes
        ):
            continue
        crossed = sum(box[0] < p[0] < box[2] and box[1] < p[1] < box[3] for p in drawn_points)
        if best is None or crossed < best[0]:
            best = (crossed, across, anchor, at)
    if best is not None:
        crossed, across, anchor, at = best
        axes.ink.text(
            across, at, words, size=6.0, anchor=anchor, color=color, halo=halo or crossed > 0
        )


def _level_lines(axes: Axes, frame: Frame, x: Scale) -> Iterator[Line]:
    """The lines of all `Level` objects, in mm of paper."""
    left, right = axes.left, axes.left + axes.width
    for level in frame.panel.levels:
        place = (x if level.upright else frame.y).place(level.value)
        low, high = axes.x_range if level.upright else axes.y_range
        if not low <= place <= high:
            continue
        if level.upright:
            at = axes.x(place)
            yield [(at, axes.top), (at, axes.top + axes.height)]
        else:
            at = axes.y(place)
            start, end = (left, right) if level.between is None else _ends(axes, level.between, x)
            yield [(start, at), (end, at)]
            if level.sense:
                edge = at + (1.3 if level.sense == "min" else -1.3)
                yield [(start, edge), (end, edge)]


def _labels(
    axes: Axes, points: Points, index: int, y: Scale, x: Scale, drawn_points: Sequence[Point]
) -> None:
    """Write words beside points, each on a free side."""
    style = index if points.style is None else points.style
    color = MARKS[style % len(MARKS)][0]
    if points.small:
        color = str(LINES[style % len(LINES)]["stroke"])
    for words, place, height in zip(points.labels, x.at(points.xs), y.at(points.ys), strict=False):
        if not words or not math.isfinite(place) or not math.isfinite(height):
            continue
        at = axes.x(float(place)), axes.y(float(height))
        if not _inside(axes, at):
            continue
        half = text_width(words, 6.0) / 2 + 0.4
        middle = min(max(at[0], axes.left + half), axes.left + axes.width - half)
        sides: list[tuple[float, Anchor, float]] = []
        for away in (0.0, 2.2, 4.4):
            for dy in sorted({-away, away}):
                sides += [(at[0] + 1.5, "left", at[1] + dy), (at[0] - 1.5, "right", at[1] + dy)]
            sides += [(middle, "center", at[1] + way * (away + 2.4)) for way in (1, -1)]
        _written(axes, words, sides, drawn_points, color, halo=True)


def _dotted(line: Line) -> Iterator[Point]:
    """Points along a line, half a millimetre apart."""
    for a, b in pairwise(line):
        count = max(1, int(2 * math.dist(a, b)))
        for k in range(count):
            yield a[0] + (b[0] - a[0]) * k / count, a[1] + (b[1] - a[1]) * k / count
    yield from line[-1:]


def _shaded(axes: Axes, frame: Frame, x: Scale) -> list[float]:
    """Draw the surface in bands with its scale; returns the levels between them."""
    surface = frame.panel.surface
    assert surface is not None
    shown = [value for points in frame.panel.points for value in known(points.shades, log=True)]
    shown += known(np.asarray(surface.values).ravel(), log=True)
    if not shown:
        return []
    bounds = contours.levels(min(shown), max(shown))
    table = np.asarray(surface.values, dtype=float)
    if table.size:
        xs, ys = (along.at(values) for along, values in ((x, surface.xs), (frame.y, surface.ys)))
        with np.errstate(invalid="ignore", divide="ignore"):
            logs = np.ma.masked_invalid(np.log10(np.where(table > 0, table, np.nan)))
        if np.ma.getmaskarray(logs).any():
            right, bottom = axes.left + axes.width, axes.top + axes.height
            frame_corners = (
                (axes.left, axes.top), (right, axes.top), (right, bottom), (axes.left, bottom)
            )  # fmt: skip
            axes.ink.path(hatch([frame_corners], angle=45.0, spacing=1.6), pen=0.1, stroke=PALE)
        contours.bands(axes, xs.tolist(), ys.tolist(), logs, bounds)
    contours.scale(axes.ink, (axes.left, axes.top, axes.width, axes.height), bounds)
    return bounds


def _outside_ticks(axes: Axes, x_ticks: Ticks, heights: Ticks, label: str) -> None:
    """Draw a closed frame with ticks outside it, and without a grid across the bands."""
    ink, bottom = axes.ink, axes.top + axes.height
    for value, words in heights:
        y = axes.y(value)
        ink.line((axes.left - 1.0, y), (axes.left, y), pen=0.13)
        ink.text(axes.left - 1.6, y, words, anchor="right")
    for value, words in x_ticks:
        x = axes.x(value)
        ink.line((x, bottom), (x, bottom + 1.0), pen=0.13)
        ink.text(x, bottom + 3.0, words, anchor="center")
    ink.box(axes.left, axes.top, axes.width, axes.height, pen=0.18)
    ink.text(axes.left + axes.width / 2, bottom + 7.0, label, anchor="center", color=GREY)
