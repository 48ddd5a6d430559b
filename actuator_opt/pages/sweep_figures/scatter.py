"""Scatter plots for every pair of selected metrics of a sweep, each with its Pareto line."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...base.errors import Diagnostic, UsageError
from ...base.numeric import Array
from ...rendering.axes import Axes, even_range, even_ticks, fitted, spaced
from ...rendering.ink import BLACK, GREY, PALE, RED, WHITE, Ink, text_width
from ...sweeps.result import better
from .shared import BETTER, INFEASIBLE, SweepFigure, SweepFigureData, heading

MOST = 2000
"""Largest number of feasible designs drawn in a panel, and of designs that miss a limit (our
choice)."""
WIDEST = 8
"""Largest number of metrics (our choice; with so many, panels are 20 mm wide)."""
LEAST = 0.1
"""Least space around the feasible designs in a panel, as a share of the range of all designs (our
choice)."""
BESIDE = 28.0
"""Least height of a panel for which the legend is placed beside it [mm]."""
_LEFT, _RIGHT, _GAP, _FOOT, _WIDTH = 20.0, 4.0, 4.0, 10.0, 180.0
PARETO: dict[str, Any] = {"stroke": RED, "pen": 0.4}
LIMIT: dict[str, Any] = {"stroke": BLACK, "pen": 0.2, "dash": (1.6, 0.9)}


def scatter_figure(drawn: SweepFigureData, metrics: Sequence[str]) -> Ink:
    """A panel for every pair of metrics.

    Drawn directly, without `Chart`, because frames share their axes along rows and
    columns of a triangle, and thousands of designs of the same colour are drawn as a single path.

    Raises
    ------
    UsageError
        fewer than two metrics, or too many to be read
    InputError
        no feasible design, or a metric without values
    """
    require_some(metrics)
    best, others, (feasible, fills) = drawn.best(), drawn.others(MOST), drawn.feasible(MOST)
    for name in metrics:
        drawn.require(name, feasible, others)
    side = len(metrics) - 1
    wide = (_WIDTH - _LEFT - _RIGHT - _GAP * (side - 1)) / side
    tall = min(wide, 70.0) if side > 1 else 90.0
    lines = {(a, b): _front(drawn, a, b) for a, b in _pairs(metrics)}
    notes = drawn.counts(("feasible", feasible.every), ("infeasible", others.every))
    ink = Ink(_WIDTH, 400.0)
    top = (
        heading(ink, drawn, "metrics in pairs", f"{notes}. {_directions(drawn, metrics, lines)}")
        + 3.0
    )
    beside = side > 1 and tall >= BESIDE
    if not beside:
        _legend(ink, 2.0, top, across=True)
        top += 6.0
    ink.height = top + side * tall + (side - 1) * _GAP + _FOOT
    tables = [np.array([drawn.values(name, x) for name in metrics]) for x in (feasible, best)]
    if len(others.rows):
        tables.append(np.array([drawn.values(name, others) for name in metrics]))
    spans = [_span(tables[0][k], [table[k] for table in tables]) for k in range(len(metrics))]
    for row in range(1, len(metrics)):
        for column in range(row):
            box = (
                _LEFT + column * (wide + _GAP), top + (row - 1) * (tall + _GAP), wide, tall
            )  # fmt: skip
            axes = Axes(ink, box, spans[column], spans[row])
            _frame(drawn, axes, metrics[column], metrics[row], column == 0, row == side)
            if len(tables) > 2:
                _points(axes, tables[2][[column, row]], INFEASIBLE, 0.45)
            for fill in BETTER:
                own = np.array([own_fill == fill for own_fill in fills], dtype=bool)
                _points(axes, tables[0][[column, row]][:, own], fill, 0.55)
            for k, name in enumerate((metrics[column], metrics[row])):
                _limits(drawn, axes, name, upright=k == 0)
            _line(
                drawn, axes, (metrics[column], metrics[row]), *lines[metrics[column], metrics[row]]
            )
            x, y = (float(tables[1][k][0]) for k in (column, row))
            ink.circle(axes.x(x), axes.y(y), 1.1, fill=WHITE, stroke=BLACK, pen=0.5)
    if beside:
        _legend(ink, _LEFT + (wide + _GAP) * 1 + 4.0, top + 3.0)
    return ink


def require_some(metrics: Sequence[str]) -> None:
    """Refuse too few or too many metrics; raises `UsageError`."""
    if len(metrics) < 2:
        raise UsageError(
            Diagnostic("a scatter plot needs two metrics or more", "add --show METRIC")
        )
    if len(metrics) > WIDEST:
        message = f"a scatter plot of {len(metrics)} metrics would be illegible"
        raise UsageError(Diagnostic(message, f"show {WIDEST} or fewer"))


def _pairs(metrics: Sequence[str]) -> list[tuple[str, str]]:
    return [(metrics[c], metrics[r]) for r in range(1, len(metrics)) for c in range(r)]


def _front(drawn: SweepFigureData, first: str, second: str) -> tuple[Array, bool]:
    return drawn.swept.sample.front(drawn.study, (first, second))


def _directions(
    drawn: SweepFigureData, metrics: Sequence[str], lines: dict[tuple[str, str], tuple[Array, bool]]
) -> str:
    """Words on the better direction of each metric, and on the designs used for Pareto lines."""
    ways = {name: better(drawn.study, name) for name in metrics}
    parts = (
        ["axes limited to the region of the feasible designs"]
        if len(drawn.swept.sample.others.rows)
        else []
    )
    parts += [
        f"{words}: {', '.join(named)}"
        for words, way in (("higher is better", 1), ("lower is better", -1), ("neither", 0))
        if (named := [name for name in metrics if ways[name] == way])
    ]
    if not all(exact for _, exact in lines.values()):
        parts.append("Pareto lines include only the designs that were kept")
    words = "; ".join(parts)
    return words[:1].upper() + words[1:]


def _span(feasible: Array, every: Sequence[Array]) -> tuple[float, float]:
    """Axis range: the range of the feasible designs, extended on each side by its width.

    On a side where no design lies that far out, the axis ends earlier.
    """
    known = np.concatenate(list(every))
    known = known[np.isfinite(known)]
    low, high = float(known.min()), float(known.max())
    good = feasible[np.isfinite(feasible)]
    if len(good):
        room = max(float(good.max() - good.min()), LEAST * (high - low))
        low, high = max(low, float(good.min()) - room), min(high, float(good.max()) + room)
    return even_range([low, high])


def _frame(
    drawn: SweepFigureData, axes: Axes, across: str, up: str, first: bool, last: bool
) -> None:
    """Draw grid and ticks; names and numbers are only at the outer edges of the matrix."""
    ink, bottom, right = axes.ink, axes.top + axes.height, axes.left + axes.width
    small = axes.height < 30
    for value, words in even_ticks(*axes.y_range, 3 if small else 5):
        y = axes.y(value)
        ink.line((axes.left, y), (right, y), stroke=PALE, pen=0.08)
        if first:
            ink.text(axes.left - 1.2, y, words, size=6.0, anchor="right")
    places = [(v, w, 1) for v, w in even_ticks(*axes.x_range, max(2, int(axes.width / 11)))]
    for value, words in spaced(places, axes):
        x, half = axes.x(value), text_width(words, 6.0) / 2
        ink.line((x, axes.top), (x, bottom), stroke=PALE, pen=0.08)
        if last and min(x - axes.left, right - x) > half - _GAP / 2 + 0.3:
            ink.text(x, bottom + 2.4, words, size=6.0, anchor="center")
    ink.box(axes.left, axes.top, axes.width, axes.height, pen=0.15, stroke=GREY)
    if last:
        words = fitted(drawn.metric(across).label, axes.width, 6.5)
        ink.text(axes.left + axes.width / 2, bottom + 6.2, words, anchor="center")
    if first:
        words = fitted(drawn.metric(up).label, axes.height + 2.0, 6.5)
        middle = axes.top + axes.height / 2
        ink.text(axes.left - 15.5, middle, words, anchor="center", angle=-90.0)


def _points(axes: Axes, values: Array, fill: str, half: float) -> None:
    """Draw designs as small diamonds, all in a single path."""
    (left, right), (low, high) = axes.x_range, axes.y_range
    known = values[:, (values[0] >= left) & (values[0] <= right)]
    known = known[:, (known[1] >= low) & (known[1] <= high)].T.tolist()
    shapes = []
    for first, second in known:
        x, y = axes.x(first), axes.y(second)
        shapes.append([(x - half, y), (x, y - half), (x + half, y), (x, y + half)])
    axes.ink.path(shapes, stroke=None, fill=fill, closed=True)


def _limits(drawn: SweepFigureData, axes: Axes, metric: str, *, upright: bool) -> None:
    """A dashed line at every limit on a metric."""
    low, high = axes.x_range if upright else axes.y_range
    for _, value in drawn.limits_on(metric):
        level = float(drawn.metric(metric).shown(np.array(value)))
        if not low <= level <= high:
            continue
        if upright:
            x = axes.x(level)
            axes.ink.line((x, axes.top), (x, axes.top + axes.height), **LIMIT)
        else:
            y = axes.y(level)
            axes.ink.line((axes.left, y), (axes.left + axes.width, y), **LIMIT)


def _line(
    drawn: SweepFigureData, axes: Axes, pair: tuple[str, str], values: Array, exact: bool
) -> None:
    """Draw the Pareto line as a staircase; no design lies on its better side."""
    if not values.shape[1]:
        return
    xs, ys = (
        drawn.metric(name).shown(column).tolist() for name, column in zip(pair, values, strict=True)
    )
    points = [(xs[0], ys[0])]
    for x, y in zip(xs[1:], ys[1:], strict=True):
        points += [(x, points[-1][1]), (x, y)]
    style = PARETO if exact else PARETO | {"dash": (0.6, 0.5)}
    axes.ink.path([[(axes.x(x), axes.y(y)) for x, y in points]], **style)
    if len(xs) < 60:
        for x, y in zip(xs, ys, strict=True):
            axes.ink.circle(axes.x(x), axes.y(y), 0.5, fill=RED, stroke=None)


def _legend(ink: Ink, x: float, y: float, *, across: bool = False) -> None:
    """Draw the legend, with entries below each other or in one line."""
    for words, fill in (
        ("infeasible", INFEASIBLE), ("feasible, worst third by the objective", BETTER[0]),
        ("middle third", BETTER[1]), ("best third", BETTER[2]), ("best design", None),
        ("Pareto line", PARETO), ("limit", LIMIT),
    ):  # fmt: skip
        if isinstance(fill, dict):
            ink.line((x, y), (x + 3.6, y), **fill)
        elif fill is None:
            ink.circle(x + 1.8, y, 1.1, fill=WHITE, stroke=BLACK, pen=0.5)
        else:
            corners = [(x + 0.8, y), (x + 1.8, y - 1.0), (x + 2.8, y), (x + 1.8, y + 1.0)]
            ink.path([corners], stroke=None, fill=fill, closed=True)
        ink.text(x + 4.6, y, words, size=6.3)
        if across:
            x += 7.6 + text_width(words, 6.3)
        else:
            y += 3.8


FIGURE = SweepFigure(
    every=True,
    lines=True,
    check=lambda study, metrics: require_some(metrics),
    draw=lambda drawn, metrics, chosen: {"scatter": scatter_figure(drawn, metrics)},
)
