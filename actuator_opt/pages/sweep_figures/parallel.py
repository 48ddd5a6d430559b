"""Parallel axes of a sweep: an axis for every varied input, the objective and every metric."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ...base.numeric import Array
from ...rendering.axes import even_range, even_ticks, fitted
from ...rendering.ink import BLACK, GREY, RED, WHITE, Ink, Point, text_width
from ...rendering.text import SENSES, trimmed
from .shared import (
    BETTER,
    INFEASIBLE,
    DrawnRows,
    SweepFigure,
    SweepFigureData,
    Track,
    fits,
    heading,
    two_lines,
)

MOST = 1000
"""Largest number of feasible designs drawn, and of designs that miss a limit (our choice, as more
lines merge)."""
_LEFT, _RIGHT, _GAP, _TALL, _SIZE = 16.0, 14.0, 25.0, 82.0, 6.3


def parallel_figure(drawn: SweepFigureData, metrics: Sequence[str]) -> Ink:
    """Parallel axes for inputs, objective and metrics; each design is a line, the best is bold.

    Drawn directly, without `Chart`, because every vertical axis has a separate scale.

    Raises
    ------
    InputError
        no feasible design, or a metric without values
    """
    best = drawn.best()
    others, (feasible, fills) = drawn.others(MOST), drawn.feasible(MOST)
    goal = drawn.study.goal.single
    names = [axis.path for axis in drawn.study.plan.axes]
    shown = [name for name in metrics if name != goal]
    for name in shown:
        drawn.require(name, feasible, others)
    tracks = [*map(drawn.axis, names), drawn.goal, *map(drawn.metric, shown)]

    def table(rows: DrawnRows) -> Array:
        if not len(rows.rows):
            return np.empty((len(tracks), 0))
        return np.array(
            [
                *(drawn.values(name, rows) for name in names),
                drawn.goals(rows),
                *(drawn.values(name, rows) for name in shown),
            ]
        )

    values = [table(others), table(feasible), table(best)]
    ink = Ink(max(180.0, _LEFT + _GAP * (len(tracks) - 1) + _RIGHT), 400.0)
    counts = drawn.counts(("feasible", feasible.every), ("infeasible", others.every))
    top = heading(ink, drawn, "varied inputs and metrics", counts) + 14.0
    gap = (ink.width - _LEFT - _RIGHT) / (len(tracks) - 1)
    places = [_LEFT + k * gap for k in range(len(tracks))]
    ranges = _ranges(tracks, values)
    lines = [_lines(designs, ranges, places, top) for designs in values]
    ink.path([part for parts in lines[0] for part in parts], stroke=INFEASIBLE, pen=0.08)
    for fill in BETTER:
        of_fill = [parts for parts, own in zip(lines[1], fills, strict=True) if own == fill]
        ink.path([part for parts in of_fill for part in parts], stroke=fill, pen=0.12)
    ink.path(lines[2][0], stroke=WHITE, pen=1.3)
    ink.path(lines[2][0], stroke=BLACK, pen=0.75)
    for k, track in enumerate(tracks):
        _axis(ink, (places[k], top, gap), track, ranges[k])
        if k >= len(names):
            _limits(ink, drawn, (places[k], top, gap), track, ranges[k])
    _legend(ink, top + _TALL + 6.0)
    ink.height = top + _TALL + 10.0
    return ink


def _ranges(tracks: Sequence[Track], values: Sequence[Array]) -> list[tuple[float, float]]:
    ranges = []
    for k, track in enumerate(tracks):
        if track.names:
            ranges.append((-0.5, len(track.names) - 0.5))
        else:
            known = np.concatenate([designs[k] for designs in values])
            known = known[np.isfinite(known)]
            ranges.append(even_range([float(known.min()), float(known.max())]))
    return ranges


def _lines(
    table: Array, ranges: Sequence[tuple[float, float]], places: Sequence[float], top: float
) -> list[list[list[Point]]]:
    """The line of every design, divided into parts where a value is missing."""
    low, high = (np.array(side)[:, None] for side in zip(*ranges, strict=True))
    heights = top + (high - table) / (high - low) * _TALL
    lines = []
    for column in heights.T.tolist():
        parts: list[list[Point]] = [[]]
        for x, y in zip(places, column, strict=True):
            if math.isfinite(y):
                parts[-1].append((x, y))
            else:
                parts.append([])
        lines.append([part for part in parts if len(part) > 1])
    return lines


def _axis(
    ink: Ink, at: tuple[float, float, float], track: Track, span: tuple[float, float]
) -> None:
    """An axis with its ticks; its name and unit above."""
    x, top, gap = at
    ink.line((x, top), (x, top + _TALL), pen=0.25)
    heads = [*two_lines(track.words, gap - 1.5, _SIZE), *([track.unit] if track.unit else [])]
    for k, line in enumerate(heads):
        color = GREY if track.unit and k == len(heads) - 1 else BLACK
        y = top - 3.0 - 3.1 * (len(heads) - 1 - k)
        ink.text(x, y, line, size=_SIZE, anchor="center", color=color)
    marks = (
        [(float(k), name) for k, name in enumerate(track.names)]
        if track.names
        else even_ticks(*span, 5)
    )
    for value, words in marks:
        y = top + (span[1] - value) / (span[1] - span[0]) * _TALL
        ink.line((x - 0.8, y), (x, y), pen=0.18)
        right = track.names and x > _LEFT
        room = gap - 3.0 if track.names else 12.0
        cut = fitted(words, room if right or not track.names else max(gap - 3.0, 10.0), _SIZE)
        if track.names:
            ink.text(x + 1.4, y, cut, size=_SIZE, halo=True)
        else:
            ink.text(x - 1.4, y, cut, size=_SIZE, anchor="right", halo=True)


def _limits(
    ink: Ink,
    drawn: SweepFigureData,
    at: tuple[float, float, float],
    track: Track,
    span: tuple[float, float],
) -> None:
    """A red mark at every limit on a metric that lies on its axis."""
    x, top, gap = at
    for sense, value in drawn.limits_on(track.words):
        level = float(track.shown(np.array(value)))
        if not span[0] <= level <= span[1]:
            continue
        y = top + (span[1] - level) / (span[1] - span[0]) * _TALL
        ink.line((x, y), (x + 1.8, y), stroke=RED, pen=0.6)
        words = fitted(f"{SENSES[sense]} {trimmed(level)}", min(gap - 3.0, 13.0), _SIZE)
        ink.text(x + 2.2, y, words, size=_SIZE, color=RED, halo=True)


def _legend(ink: Ink, y: float) -> None:
    """Names of the lines."""
    x = 2.0
    for words, style in (
        ("infeasible", {"stroke": INFEASIBLE, "pen": 0.5}),
        ("feasible, worst third", {"stroke": BETTER[0], "pen": 0.5}),
        ("middle third", {"stroke": BETTER[1], "pen": 0.5}),
        ("best third by the objective", {"stroke": BETTER[2], "pen": 0.5}),
        ("best design", {"stroke": BLACK, "pen": 1.0}),
        ("limit", {"stroke": RED, "pen": 0.6}),
    ):
        ink.line((x, y), (x + 5.0, y), **style)
        ink.text(x + 6.2, y, words, size=_SIZE)
        x += 10.0 + text_width(words, _SIZE)


FIGURE = SweepFigure(
    every=True,
    lines=False,
    check=fits,
    draw=lambda drawn, metrics, chosen: {"parallel": parallel_figure(drawn, metrics)},
)
