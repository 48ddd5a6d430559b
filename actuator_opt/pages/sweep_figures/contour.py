"""Contours of a metric over two varied inputs of a sweep, with the boundary of every limit."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import field
from itertools import pairwise
from typing import Any

import numpy as np

from ...base.dataclass import dataclass
from ...base.errors import Diagnostic, InputError
from ...base.numeric import Array
from ...rendering.axes import Axes, even_ticks, spaced
from ...rendering.heights import wrap
from ...rendering.ink import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    OCHRE,
    PALE,
    POINT,
    RED,
    WHITE,
    Ink,
    Point,
    hatch,
    text_width,
)
from ...rendering.text import trimmed
from ...sweeps.field import Boundary, Field, field as field_of, require_grid
from .shared import ORIGINS, SweepFigure, SweepFigureData, heading

_LEFT, _WIDE, _TALL, _WIDTH = 20.0, 152.0, 100.0, 180.0
LEVELS = 9
"""Approximate number of contour lines."""
_SIZE = 6.3
STYLES: tuple[dict[str, Any], ...] = tuple(
    {"stroke": colour, "pen": pen, "dash": dash}
    for dash, pen in (((), 0.5), ((2.4, 0.8), 0.5), ((2.4, 0.7, 0.5, 0.7), 0.5))
    for colour in (RED, GREEN, OCHRE, BLACK, "#7a5a8c")
)
_METRIC: dict[str, Any] = {"stroke": BLUE, "pen": 0.22}
_HATCH: dict[str, Any] = {"stroke": "#98a3ab", "pen": 0.1}


@dataclass
class _Labels:
    """Positions for words on lines, chosen so that words do not touch each other."""

    axes: Axes
    boxes: list[tuple[float, float, float, float]] = field(default_factory=list)
    crowd: Array = field(default_factory=lambda: np.empty((0, 2)))
    """Points of all lines; words are placed where few of these points are."""

    def place(
        self, lines: Sequence[Sequence[Point]], words: str, *, bold: bool = False
    ) -> Point | None:
        """The least crowded position for words on a line; None without enough space."""
        half, tall = text_width(words, _SIZE, bold=bold) / 2 + 0.8, 0.5 * _SIZE * POINT + 0.7
        axes, best = self.axes, None
        for share, (x, y) in _beside(lines, half + 0.4):
            box = (x - half, y - tall, x + half, y + tall)
            if box[0] < axes.left + 0.5 or box[2] > axes.left + axes.width - 0.5:
                continue
            if box[1] < axes.top + 0.5 or box[3] > axes.top + axes.height - 0.5:
                continue
            if any(_touch(box, other) for other in self.boxes):
                continue
            inside = (np.abs(self.crowd - (x, y)) < (half, tall)).all(axis=1)
            score = (float(np.count_nonzero(inside)) * 0.06 + share, x, y, box)
            if best is None or score < best:
                best = score
        if best is None:
            return None
        self.boxes.append(best[3])
        return best[1], best[2]


def _beside(lines: Sequence[Sequence[Point]], aside: float) -> Iterator[tuple[float, Point]]:
    """Candidate positions for words: on lines and, with a penalty, to their right and left."""
    for share, (x, y) in _candidates(lines):
        yield share, (x, y)
        yield share + 0.4, (x + aside, y)
        yield share + 0.4, (x - aside, y)


def _touch(a: tuple[float, ...], b: tuple[float, ...]) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def _candidates(lines: Sequence[Sequence[Point]]) -> Iterator[tuple[float, Point]]:
    """Positions along lines, with their distance from the middle of the longest line."""
    sized = []
    for line in lines:
        points = np.array(line)
        sized.append((float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum()), points))
    longest = max((size for size, _ in sized), default=0.0)
    for size, points in sized:
        along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
        for k in range(1, 32):
            at = size * k / 32
            place = tuple(float(np.interp(at, along, points[:, j])) for j in (0, 1))
            yield abs(k / 32 - 0.5) + (longest - size) / (longest or 1.0), (place[0], place[1])


def _even(line: Sequence[Point]) -> Array:
    """Points along a line at intervals of a millimetre."""
    points = np.array(line)
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    at = np.arange(0.0, along[-1], 1.0)
    return np.stack([np.interp(at, along, points[:, k]) for k in (0, 1)], axis=1)


def contour_figure(
    drawn: SweepFigureData, field: Field, boundaries: Sequence[Boundary], metric: str
) -> Ink:
    """Contours of a metric, and lines on which limits are just met; the missed side is hatched.

    Drawn directly, without `Chart`, because lines carry their names, and areas are hatched.

    Raises
    ------
    InputError
        a metric without values
    """
    track = drawn.metric(metric)
    table = np.where(field.failed, np.nan, track.shown(field.metric(metric)))
    if not np.isfinite(table).any():
        message = f"--show {metric}: it has no value for any design of this sweep"
        raise InputError(Diagnostic(message, "show another metric"))
    first, second = (drawn.axis(axis.path) for axis in drawn.study.plan.axes)
    xs, ys = first.shown(field.xs), second.shown(field.ys)
    ink = Ink(_WIDTH, 400.0)
    words = f"{track.label} versus {first.words} and {second.words}"
    top = heading(ink, drawn, words, _notes(drawn, field)) + 4.0
    spans = [(float(values[0]), float(values[-1])) for values in (xs, ys)]
    axes = Axes(ink, (_LEFT, top, _WIDE, _TALL), *spans)
    styles = {line.number: STYLES[k % len(STYLES)] for k, line in enumerate(boundaries)}
    scale = (first.shown, second.shown)
    edges = {b.number: [_paper(axes, line, scale) for line in b.lines] for b in boundaries}
    _missed(axes, field, boundaries, scale)
    levels = _metric_lines(axes, xs, ys, table)
    for lines in levels.values():
        ink.path(lines, **_METRIC)
    for boundary in boundaries:
        ink.path(edges[boundary.number], **styles[boundary.number])
    ink.box(*(axes.left, axes.top, axes.width, axes.height), pen=0.25)
    _frame(axes, first.label, second.label)
    labels = _Labels(axes)
    if drawn.swept.best:
        values = drawn.study.values(drawn.swept.best[0].number)
        at = np.array([[float(values[axis.words]) for axis in (first, second)]])
        x, y = _paper(axes, at, scale)[0]
        ink.circle(x, y, 1.2, fill=WHITE, stroke=BLACK, pen=0.5)
        labels.boxes.append((x - 1.4, y - 1.4, x + 1.4, y + 1.4))
    every = [_even(line) for lines in (*levels.values(), *edges.values()) for line in lines]
    labels.crowd = np.concatenate([*every, np.empty((0, 2))])
    key = _name(drawn, labels, edges, styles)
    for level, lines in levels.items():
        place = labels.place(lines, trimmed(level))
        if place is not None:
            _say(ink, place, trimmed(level), BLUE)
    ink.height = _below(ink, drawn, field, key, top + _TALL + 12.0)
    return ink


def _notes(drawn: SweepFigureData, field: Field) -> str:
    counts = drawn.counts()
    every = (
        f"; only a grid of {len(field.xs)} by {len(field.ys)} variants is drawn"
        if field.thinned
        else ""
    )
    return f"{counts}{every}. Hatched: at least one limit is missed."


def _paper(axes: Axes, points: Array, scale: Sequence[Any]) -> list[Point]:
    """Convert points from SI values to positions on paper."""
    shown = [convert(points[:, k]).tolist() for k, convert in enumerate(scale)]
    return [(axes.x(x), axes.y(y)) for x, y in zip(*shown, strict=True)]


def _missed(axes: Axes, field: Field, boundaries: Sequence[Boundary], scale: Sequence[Any]) -> None:
    """Hatch areas in which a limit is missed; cross-hatch areas without a design."""
    whole = [
        (axes.left, axes.top), (axes.left + axes.width, axes.top),
        (axes.left + axes.width, axes.top + axes.height), (axes.left, axes.top + axes.height),
    ]  # fmt: skip
    areas = [[_paper(axes, ring, scale) for ring in area] for b in boundaries for area in b.missed]
    if _nowhere(field):
        areas = [[whole]]
    axes.ink.path(_hatched(areas, 45.0, 1.7), **_HATCH)
    if field.failed.any():
        from contourpy import FillType, contour_generator

        maker = contour_generator(
            field.xs, field.ys, field.failed.T.astype(float), fill_type=FillType.OuterOffset
        )
        filled: Any = maker.filled(1e-9, 2.0)
        areas = [
            [_paper(axes, ring[a:b], scale) for a, b in pairwise(starts)]
            for ring, starts in zip(*filled, strict=True)
        ]
        for angle in (45.0, -45.0):
            axes.ink.path(_hatched(areas, angle, 1.7), **_HATCH)


def _hatched(areas: Sequence[Sequence[Sequence[Point]]], angle: float, spacing: float) -> Any:
    """Hatch areas that may overlap; each hatch line is drawn only once."""
    cosine, sine = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    rows: dict[int, list[tuple[float, float]]] = {}
    for area in areas:
        for (x1, y1), (x2, y2) in hatch(area, angle=angle, spacing=spacing):
            row = round((y1 * cosine - x1 * sine) / spacing - 0.5)
            rows.setdefault(row, []).append((x1 * cosine + y1 * sine, x2 * cosine + y2 * sine))
    lines = []
    for row, pieces in sorted(rows.items()):
        level, merged = (row + 0.5) * spacing, [list(min(pieces))]
        for start, end in sorted(pieces):
            if start > merged[-1][1] + 0.02:
                merged.append([start, end])
            merged[-1][1] = max(merged[-1][1], end)
        for piece in merged:
            lines.append([(u * cosine - level * sine, u * sine + level * cosine) for u in piece])
    return lines


def _nowhere(field: Field) -> list[int]:
    """Numbers of the limits that no point of the grid meets."""
    known = np.where(np.isnan(field.margins), -np.inf, field.margins)
    known[:, field.failed] = -np.inf
    answered = not field.failed.all()
    return [k for k, margins in enumerate(known) if answered and float(margins.max()) < 0]


def _metric_lines(axes: Axes, xs: Array, ys: Array, table: Array) -> dict[float, list[list[Point]]]:
    """Contours at round values, each as lines on paper."""
    from contourpy import LineType, contour_generator

    known = table[np.isfinite(table)]
    low, high = float(known.min()), float(known.max())
    if high - low <= 1e-9 * max(abs(low), abs(high)):
        return {}
    maker = contour_generator(
        xs, ys, np.ma.masked_invalid(table.T), line_type=LineType.Separate, corner_mask=True
    )
    contours = {}
    for level, _ in even_ticks(low, high, LEVELS):
        traced: Any = maker.lines(level)
        lines = [[(axes.x(float(x)), axes.y(float(y))) for x, y in line] for line in traced]
        if lines:
            contours[level] = lines
    return contours


def _frame(axes: Axes, across: str, up: str) -> None:
    ink, bottom = axes.ink, axes.top + axes.height
    for value, words in even_ticks(*axes.y_range, 6):
        y = axes.y(value)
        ink.line((axes.left - 1.0, y), (axes.left, y), pen=0.18)
        ink.text(axes.left - 1.6, y, words, anchor="right")
    places = [(v, w, 1) for v, w in even_ticks(*axes.x_range, 8)]
    for value, words in spaced(places, axes):
        x = axes.x(value)
        ink.line((x, bottom), (x, bottom + 1.0), pen=0.18)
        ink.text(x, bottom + 3.0, words, anchor="center")
    ink.text(axes.left + axes.width / 2, bottom + 7.0, across, anchor="center")
    ink.text(3.0, axes.top + axes.height / 2, up, anchor="center", angle=-90.0)


def _name(
    drawn: SweepFigureData,
    labels: _Labels,
    edges: dict[int, list[list[Point]]],
    styles: dict[int, dict[str, Any]],
) -> list[tuple[str, str]]:
    """Name every boundary beside its line; return the key of names replaced by a letter.

    A letter is used if there is no space for the name.
    """
    key: list[tuple[str, str]] = []
    rooms = {k: sum(len(line) for line in lines) for k, lines in edges.items()}
    for number in sorted(edges, key=lambda k: (rooms[k], k)):
        words = drawn.limit_words(drawn.study.binding[number])
        color = str(styles[number]["stroke"])
        place = labels.place(edges[number], words, bold=True)
        if place is None:
            letter = chr(ord("A") + len(key) % 26)
            place = labels.place(edges[number], letter, bold=True)
            key.append(
                (letter, words if place else f"{words} (no space for the letter at its line)")
            )
            words = letter
        if place is not None:
            _say(labels.axes.ink, place, words, color, bold=True)
    return key


def _say(ink: Ink, at: Point, words: str, color: str, *, bold: bool = False) -> None:
    """Write words on a white background, so that no dash beside them looks like a minus sign."""
    wide = text_width(words, _SIZE, bold=bold) + 1.6
    ink.box(at[0] - wide / 2, at[1] - 1.3, wide, 2.6, fill=WHITE, stroke=None)
    ink.text(*at, words, size=_SIZE, anchor="center", color=color, bold=bold)


def _below(
    ink: Ink, drawn: SweepFigureData, field: Field, key: Sequence[tuple[str, str]], y: float
) -> float:
    """Write the key of marks and the limits that have no line; return the figure's height."""
    x = 2.0
    marks = [("contour", _METRIC), ("limit just met", STYLES[0])]
    for words, style in marks:
        ink.line((x, y), (x + 6.0, y), **style)
        ink.text(x + 7.4, y, words, size=_SIZE)
        x += 11.0 + text_width(words, _SIZE)
    if drawn.swept.best:
        ink.circle(x + 3.0, y, 1.2, fill=WHITE, stroke=BLACK, pen=0.5)
        ink.text(x + 5.4, y, "best design", size=_SIZE)
        x += 9.0 + text_width("best design", _SIZE)
    kinds: list[tuple[str, tuple[float, ...]]] = [("a limit is missed", (45.0,))]
    kinds += [("no design there", (45.0, -45.0))] if field.failed.any() else []
    for words, angles in kinds:
        box = ((x, y - 1.5), (x + 6.0, y - 1.5), (x + 6.0, y + 1.5), (x, y + 1.5))
        for angle in angles:
            ink.path([list(line) for line in hatch([box], angle=angle, spacing=1.2)], **_HATCH)
        ink.path([box], closed=True, pen=0.13, stroke=PALE, fill=None)
        ink.text(x + 7.4, y, words, size=_SIZE)
        x += 11.0 + text_width(words, _SIZE)
    texts = [f"{letter}: {words}" for letter, words in key]
    missed = [drawn.limit_words(drawn.study.binding[k]) for k in _nowhere(field)]
    if missed:
        texts.append(f"missed by every design: {', '.join(missed)}")
    own = _everywhere(drawn, field)
    if own:
        texts.append(f"met by every design: {', '.join(own)}")
    for line in (line for text in texts for line in wrap(text, _WIDTH - 4.0, _SIZE)):
        y += 3.6
        ink.text(2.0, y, line, size=_SIZE, color=GREY)
    return y + 4.0


def _everywhere(drawn: SweepFigureData, field: Field) -> list[str]:
    """Requirements that every point of the grid meets, in words."""
    met = []
    for k, margins in enumerate(field.margins):
        limit = drawn.study.binding[k]
        known = margins[~field.failed]
        if limit.origin in ORIGINS and len(known) and bool((known >= 0).all()):
            met.append(drawn.limit_words(limit))
    return met


def _draw(drawn: SweepFigureData, metrics: Sequence[str], chosen: bool) -> dict[str, Ink]:
    """A picture for every metric that the user named; without names, for the first metric."""
    grid = field_of(drawn.study)
    lines = list(grid.boundaries())
    return {
        f"contour-{name}": contour_figure(drawn, grid, lines, name)
        for name in (metrics if chosen else metrics[:1])
    }


FIGURE = SweepFigure(
    every=False,
    lines=False,
    check=lambda study, metrics: require_grid(study.plan),
    draw=_draw,
)
