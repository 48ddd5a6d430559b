"""Frames of the [Huang2017] figures: curves, contours of a surface, the surface itself."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..base.numeric import Array
from ..pages.wall_figures import GREEN, OCHRE
from ..rendering.axes import Axes, ticks
from ..rendering.ink import BLACK, BLUE, GREY, PALE, WHITE, Ink, Point, spread_within
from ..rendering.text import trimmed
from .aalto_figures import CHAIN, DASHED, DOTTED, FULL, THIN, Curve, Style

STYLES: tuple[Style, ...] = (
    FULL,
    DASHED,
    CHAIN,
    THIN,
    {"stroke": BLUE, "pen": 0.35, "dash": (0.5, 0.6)},
    {"stroke": OCHRE, "pen": 0.4, "dash": (3.2, 0.7, 0.4, 0.7, 0.4, 0.7)},
    {"stroke": GREEN, "pen": 0.5},
    DOTTED,
)
"""Styles of the curves of one panel, in order."""
COLUMNS, PANEL, HEIGHT, ROW, TOP = (10.0, 101.0), 52.0, 36.0, 56.0, 9.0
_LABEL = 3.2
"""Height (mm) of a line of a label."""
_LIFT = 0.4
"""Depth axis of a surface: how far it leads up and right, of the panel's height and width."""


def box(place: tuple[int, int]) -> tuple[float, float, float, float]:
    """Frame of a (row, column)."""
    row, column = place
    return COLUMNS[column], TOP + row * ROW, PANEL, HEIGHT


def curve(xs: Array, ys: Array, style: Style, *label: str) -> Curve:
    """A curve over arrays."""
    return Curve([float(x) for x in xs], [float(y) for y in ys], style, label)


def panel(
    ink: Ink,
    place: tuple[int, int],
    title: str,
    x_label: str,
    curves: Sequence[Curve],
    *,
    span: tuple[float, float],
    range_: tuple[float, float],
    level: float | None = None,
) -> None:
    """Curves in a frame, each labelled where it ends; `level` is a line across."""
    left, top, width, height = box(place)
    axes = Axes(ink, (left, top, width, height), span, range_)
    right, bottom = left + width, top + height
    axes.frame(title, x_label)
    if level is not None:
        ink.line((left, axes.y(level)), (right, axes.y(level)), stroke=GREY, pen=0.2)
    ends: list[tuple[Point, Style, tuple[str, ...]]] = []
    for one in curves:
        found = [line for xs, ys in _unbroken(one.xs, one.ys) for line in axes.clipped(xs, ys)]
        ink.path(found, **one.style)
        if found:
            ends.append((found[-1][-1], one.style, one.label))
    ends.sort(key=lambda end: end[0][1])
    heights = [_LABEL * len(label) for *_, label in ends]
    gaps = [(a + b) / 2 + 0.6 for a, b in itertools.pairwise(heights)]
    places = spread_within([end[1] for end, *_ in ends], gaps, top, bottom + 3.0)
    for (end, style, label), tall, y in zip(ends, heights, places, strict=True):
        ink.line(end, (right + 1.0, end[1]), (right + 3.0, y), pen=0.13, stroke=GREY)
        for k, words in enumerate(label):
            at = y - tall / 2 + _LABEL * (k + 0.5)
            ink.text(right + 3.6, at, words, size=6.5, color=style["stroke"])


def _unbroken(xs: Sequence[float], ys: Sequence[float]) -> list[tuple[list[float], list[float]]]:
    """Stretches of a curve without gaps."""
    pairs = [
        list(group)
        for finite, group in itertools.groupby(
            zip(xs, ys, strict=True), key=lambda pair: math.isfinite(pair[1])
        )
        if finite
    ]
    return [([x for x, _ in group], [y for _, y in group]) for group in pairs]


@dataclass(frozen=True, slots=True)
class Field:
    """Damping over speed [mm/s] and pressure [MPa], (p, v) [MN s/m]."""

    speeds: Array
    pressures: Array
    values: Array


def contours(
    ink: Ink, place: tuple[int, int], title: str, field: Field, levels: Sequence[float]
) -> None:
    """Lines of equal damping; the speed axis is logarithmic, where they lie evenly."""
    logs = np.log10(field.speeds)
    spans = [(float(axis[0]), float(axis[-1])) for axis in (logs, field.pressures)]
    axes = Axes(ink, box(place), spans[0], spans[1])
    marks = [v for v in (0.5, 1.0, 2.0, 5.0, 10.0) if spans[0][0] <= math.log10(v) <= spans[0][1]]
    axes.frame_at(
        title,
        "speed, mm/s",
        [(math.log10(v), trimmed(v)) for v in marks],
        [(p, trimmed(p)) for p in ticks(*spans[1], 5)],
    )
    taken: list[Point] = []
    for k, level in enumerate(levels):
        pieces = segments(logs, field.pressures, np.log(field.values), math.log(level))
        if not pieces:
            continue
        paper = [[(axes.x(x), axes.y(y)) for x, y in piece] for piece in pieces]
        ink.path(paper, stroke=(BLUE, OCHRE, GREEN)[k % 3], pen=0.35)
        middles = [((a[0] + b[0]) / 2, (a[1] + b[1]) / 2) for a, b in paper]
        inner = [m for m in middles if _inside(m, box(place))]
        free = [m for m in inner if all(abs(m[0] - x) > 8 or abs(m[1] - y) > 4 for x, y in taken)]
        if free:
            x, y = free[len(free) // 2]
            taken.append((x, y))
            ink.text(x, y, trimmed(level), size=6.0, anchor="center", halo=True)


def _inside(point: Point, frame: tuple[float, float, float, float]) -> bool:
    left, top, width, height = frame
    return left + 3 < point[0] < left + width - 3 and top + 2 < point[1] < top + height - 2


def segments(xs: Array, ys: Array, values: Array, level: float) -> list[tuple[Point, Point]]:
    """Straight pieces of a level, cell by cell, each cell as two triangles."""
    found = []
    for i, j in itertools.product(range(len(ys) - 1), range(len(xs) - 1)):
        corners = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)]
        for three in ((0, 1, 2), (0, 2, 3)):
            crossed = []
            nodes = [corners[k] for k in three]
            for a, b in itertools.combinations(nodes, 2):
                one, other = values[a] - level, values[b] - level
                if one * other < 0:
                    t = float(one / (one - other))
                    x = xs[a[1]] + t * (xs[b[1]] - xs[a[1]])
                    y = ys[a[0]] + t * (ys[b[0]] - ys[a[0]])
                    crossed.append((float(x), float(y)))
            if len(crossed) == 2:
                found.append((crossed[0], crossed[1]))
    return found


def surface(ink: Ink, place: tuple[int, int], title: str, field: Field) -> None:
    """The damping as a net in space: speed to the right, pressure to the back, values upwards."""
    left, top, width, height = box(place)
    deep, wide = _LIFT * height, _LIFT * width
    speeds, pressures = field.speeds, field.pressures
    ink.text(left - 1.4, top - 3.6, title, size=7.0, bold=True)
    if not np.any(np.isfinite(field.values)):
        ink.text(left, top + height / 2, "no film", size=6.5, color=GREY)
        return
    highest = float(np.nanmax(field.values))

    def paper(v: float, p: float, value: float) -> Point:
        across = (v - speeds[0]) / (speeds[-1] - speeds[0])
        back = (p - pressures[0]) / (pressures[-1] - pressures[0])
        x = left + across * (width - wide) + back * wide
        y = top + height - back * deep - value / highest * (height - deep)
        return float(x), float(y)

    for p in pressures[[0, -1]]:
        ink.line(paper(speeds[0], p, 0), paper(speeds[-1], p, 0), stroke=PALE, pen=0.15)
    for v in speeds[[0, -1]]:
        ink.line(paper(v, pressures[0], 0), paper(v, pressures[-1], 0), stroke=PALE, pen=0.15)
    corner = paper(speeds[0], pressures[0], 0)
    ink.line(corner, paper(speeds[0], pressures[0], highest), pen=0.18)
    ink.line(corner, paper(speeds[-1], pressures[0], 0), pen=0.18)
    ink.line(paper(speeds[-1], pressures[0], 0), paper(speeds[-1], pressures[-1], 0), pen=0.18)
    for i in range(len(pressures) - 2, -1, -1):
        for j in range(len(speeds) - 1):
            nodes = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)]
            values = [float(field.values[node]) for node in nodes]
            if all(map(math.isfinite, values)):
                face = [
                    paper(speeds[b], pressures[a], value)
                    for (a, b), value in zip(nodes, values, strict=True)
                ]
                ink.path([face], fill=WHITE, stroke=BLUE, pen=0.18, closed=True)
    for value in ticks(0.0, highest, 4):
        at = paper(speeds[0], pressures[0], value)
        ink.line(at, (at[0] - 1.0, at[1]), pen=0.13)
        ink.text(at[0] - 1.6, at[1], trimmed(value), size=6.5, anchor="right")
    bottom = top + height
    for v in (speeds[0], speeds[-1]):
        x, _ = paper(v, pressures[0], 0)
        ink.text(x, bottom + 3.0, trimmed(float(v)), size=6.5, anchor="center")
    ink.text(
        left + (width - wide) / 2, bottom + 7.0, "speed, mm/s", size=6.5, anchor="center",
        color=GREY,
    )  # fmt: skip
    for p in (pressures[0], pressures[-1]):
        x, y = paper(speeds[-1], p, 0)
        words = f"{trimmed(float(p))} MPa"
        ink.text(x + 2.6, y + 0.6, words, size=6.5, color=BLACK)
