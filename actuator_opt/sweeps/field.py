"""Metrics and margins over a grid of two varied numbers, with lines of zero margin."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, UsageError
from ..base.numeric import Array
from ..evaluation.build import TOLERANCE, margins_of
from .chunk import Study
from .plan import Plan, SweepPoints

FINEST = 161
"""Maximum number of nodes per axis (our choice: one per mm of paper); of a finer grid, only some
nodes are used."""

FAR = 2.0
"""Margins are limited to the range from -200 to +200 % (our choice)."""

NOTHING = -1.0
"""Margin below which a wall or clearance counts as negative."""

STEPS = 12
"""Maximum number of iterations in the search for zero margin on an edge of the grid."""

CLOSE = 1e-9
"""Margin treated as zero."""


@dataclass(frozen=True)
class Boundary:
    """Lines of zero margin of one limit, SI; `number` is its index in `Study.binding`.

    `lines` are (n, 2) points of zero margin. `missed` are the areas where the limit is missed, each
    as a list of closed lines.
    """

    number: int
    lines: list[Array]
    missed: list[list[Array]]


@dataclass(frozen=True)
class Field:
    """Values at the nodes of a grid (first axis, second axis), SI.

    `rows` are the rows of the sweep, (nodes, nodes, columns), NaN where a design failed. `margins`
    are (limits, nodes, nodes), NaN without a value. `failed` marks nodes without a valid design,
    because of a fault or a negative wall. `room`, (limits,), is the tolerance within which a limit
    counts as met. `thinned` states whether nodes of the sweep were left out.
    """

    study: Study
    xs: Array
    ys: Array
    rows: Array
    margins: Array
    failed: Array
    room: Array
    thinned: bool

    def metric(self, name: str) -> Array:
        """Return a metric at the nodes, (nodes, nodes)."""
        values: Array = self.rows[:, :, self.study.place(name)]
        return values

    def boundaries(self) -> Iterator[Boundary]:
        """Yield the lines of zero margin of each limit that is met at only some of the nodes."""
        from contourpy import FillType, LineType, contour_generator

        for number, margins in enumerate(self.margins):
            table = np.clip(margins, -FAR, FAR)
            finite = table[np.isfinite(table)]
            if not len(finite) or finite.min() >= 0 or finite.max() < 0:
                continue
            maker = contour_generator(
                self.xs, self.ys, np.ma.masked_invalid(table.T),
                fill_type=FillType.OuterOffset, line_type=LineType.Separate, corner_mask=True,
            )  # fmt: skip
            filled: Any = maker.filled(-2 * FAR, 0.0)
            zero_lines: Any = maker.lines(0.0)
            lines = [np.asarray(line) for line in zero_lines]
            areas = [
                [np.asarray(points)[a:b] for a, b in pairwise(starts)]
                for points, starts in zip(*filled, strict=True)
            ]
            rings = [ring for area in areas for ring in area]
            corrected = self._on_zero(number, table, [*lines, *rings])
            remaining = iter(corrected[len(lines) :])
            yield Boundary(
                number, corrected[: len(lines)], [[next(remaining) for _ in area] for area in areas]
            )

    def _on_zero(self, number: int, table: Array, curves: Sequence[Array]) -> list[Array]:
        """Return curves with their points moved to zero margin.

        Points move along the grid edge between a node that meets the limit and a node that misses
        it. They are not moved if a design must be built for every value of a varied number.
        """
        if self.study.designs.apart or not curves:
            return list(curves)
        all_points = np.concatenate(curves)
        points, which = np.unique(np.round(all_points, 15), axis=0, return_inverse=True)
        edges = [self._edge(table, point) for point in points]
        on_edges = np.array([k for k, edge in enumerate(edges) if edge is not None], dtype=np.intp)
        if len(on_edges):
            low = np.array([edge[0] for edge in edges if edge is not None])
            high = np.array([edge[1] for edge in edges if edge is not None])
            ends = np.array([edge[2] for edge in edges if edge is not None])
            points[on_edges] = self._zeros(number, low, high, ends)
        corrected = points[which.ravel()]
        cuts = np.cumsum([len(curve) for curve in curves])[:-1]
        return list(np.split(corrected, cuts))

    def _edge(
        self, table: Array, point: Array
    ) -> tuple[list[float], list[float], list[float]] | None:
        """Return ends and margins of the grid edge on which a point lies.

        None if the point is a node or inside a cell, or if the margin has the same sign at both
        ends.
        """
        nodes = (self.xs, self.ys)
        places = []
        for axis, value in zip(nodes, point, strict=True):
            near = int(np.argmin(np.abs(axis - value)))
            on = abs(axis[near] - value) <= 1e-9 * float(axis[-1] - axis[0])
            below = min(max(int(np.searchsorted(axis, value)) - 1, 0), len(axis) - 2)
            places.append((near, near) if on else (below, below + 1))
        (i, k), (j, m) = places
        if (i == k) == (j == m):  # the point is a node, or inside a cell
            return None
        ends = [float(table[i, j]), float(table[k, m])]
        if (ends[0] < 0) == (ends[1] < 0) or not np.isfinite(ends).all():
            return None
        return [self.xs[i], self.ys[j]], [self.xs[k], self.ys[m]], ends

    def _zeros(self, number: int, low: Array, high: Array, ends: Array) -> Array:
        """Return the points of zero margin on grid edges, by the Illinois method."""
        a, b = np.zeros(len(low)), np.ones(len(low))
        f, g = ends[:, 0].copy(), ends[:, 1].copy()
        t, active = np.where(f == 0, 0.0, 1.0), (f != 0) & (g != 0)
        for _ in range(STEPS):
            at = np.flatnonzero(active)
            if not len(at):
                break
            t[at] = (a - f * (b - a) / np.where(g == f, 1.0, g - f))[at]
            points = low[at] + t[at, None] * (high - low)[at]
            value = margins_at(self.study, points.T)[number] + self.room[number]
            value = np.clip(np.where(np.isnan(value), -FAR, value), -FAR, FAR)
            same = (value < 0) == (g[at] < 0)
            f[at] = np.where(same, f[at] / 2, g[at])
            a[at] = np.where(same, a[at], b[at])
            b[at], g[at] = t[at], value
            active[at] = np.abs(value) > CLOSE
        zeros: Array = low + t[:, None] * (high - low)
        return zeros


def margins_at(study: Study, numbers: Array) -> Array:
    """Return the margin of every limit, (limits, n), at n points; `numbers` is (axes, n)."""
    count = numbers.shape[1]
    margins = np.full((len(study.binding), count), np.nan)
    for places, subject, varied in study.designs.groups(
        SweepPoints(np.zeros(count, dtype=int), numbers)
    ):
        if not isinstance(subject, str):
            margins[:, places] = margins_of(subject, varied, len(places))
    return margins


def require_grid(plan: Plan) -> None:
    """Reject a sweep that is not a grid of two numbers.

    Raises
    ------
    UsageError
        if it is no full factorial, has not two axes, or an axis has names or a single value
    """
    for axis in plan.named:
        message = f"a contour needs numbers, but {axis.path} takes names"
        raise UsageError(Diagnostic(message, "set this PATH with --set, and vary two numbers"))
    if len(plan.axes) != 2:
        message = f"a contour needs exactly two --vary, not {len(plan.axes)}"
        raise UsageError(Diagnostic(message, "set the other PATHs with --set"))
    if plan.method != "grid":
        message = f"a contour needs a grid, not --method {plan.method}"
        raise UsageError(Diagnostic(message, "omit --method and write PATH=A..B:N"))
    for axis in plan.axes:
        if axis.size < 2:
            raise UsageError(
                Diagnostic(f"a contour needs at least two values of {axis.path}", "add values")
            )


def _cut_away(study: Study, margins: Array) -> Array:
    """Return which nodes have a negative wall or clearance; set all other margins there to NaN."""
    shapes = np.array([limit.origin == "geometry" for limit in study.binding])
    cut_away: Array = (margins[shapes] < NOTHING).any(axis=0)
    for number in np.flatnonzero(~shapes):
        margins[number][cut_away] = np.nan
    return cut_away


def field(study: Study) -> Field:
    """Evaluate the grid of a sweep of two numbers again, with at most `FINEST` nodes per axis."""
    require_grid(study.plan)
    values = [axis.numbers() for axis in study.plan.axes]
    wide = len(values[1])
    chosen = []
    for axis_values in values:
        order = np.argsort(axis_values)
        size = len(axis_values)
        at = np.unique(np.round(np.linspace(0, size - 1, min(size, FINEST))).astype(int))
        chosen.append(order[at])
    chunks = [study.chunk(int(i) * wide, wide, chosen[1]) for i in chosen[0]]
    xs, ys = (value[at] for value, at in zip(values, chosen, strict=True))
    failed = np.zeros((len(xs), len(ys)), dtype=bool)
    for k, chunk in enumerate(chunks):
        failed[k, list(chunk.rows.failures)] = True
    mesh = np.stack([part.ravel() for part in np.meshgrid(xs, ys, indexing="ij")])
    margins = margins_at(study, mesh).reshape(-1, len(xs), len(ys))
    tolerated = np.abs(margins) <= TOLERANCE  # met within the tolerance, as in every verdict
    room = np.where(tolerated.any(axis=(1, 2)), TOLERANCE, 0.0)
    margins += room[:, None, None]
    cut_away = _cut_away(study, margins)
    margins[:, failed & ~cut_away] = np.nan  # negative walls keep margins
    failed |= cut_away
    rows = np.stack([chunk.rows.numbers for chunk in chunks])
    thinned = any(len(value) > FINEST for value in values)
    return Field(study, xs, ys, rows, margins, failed, room, thinned)
