"""A grid of two numbers as a field: metrics and margins at its nodes, lines of zero margin."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, TypeVar

from ..base.errors import Diagnostic, UsageError

if TYPE_CHECKING:
    pass


from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..base.numeric import Array
from ..evaluation.build import TOLERANCE, margins_of
from .chunk import Study
from .plan import Plan, SweepPoints

FINEST = 161
"""Maximum number of nodes per axis (a choice: one per mm of paper); finer grids are thinned."""

FAR = 2.0
"""Margins are clipped here (a choice: +-200 %)."""

NOTHING = -1.0
"""Margin assigned to a wall of negative thickness."""

STEPS = 12
"""Maximum iterations of the search for zero on an edge of the grid."""

CLOSE = 1e-9
"""Margin treated as zero."""


@dataclass(frozen=True)
class Boundary:
    """Zero line of one limit of a study (`number` of its `binding`), in SI.

    `lines` are (n, 2) points of zero margin; `missed` the areas where the limit is missed, each a
    list of rings.
    """

    number: int
    lines: list[Array]
    missed: list[list[Array]]


@dataclass(frozen=True)
class Field:
    """Nodes of a grid (first axis, second axis), in SI.

    `rows` are those of the sweep, (nodes, nodes, columns), NaN where a design failed. `margins` are
    (limits, nodes, nodes), NaN without a value. `failed` marks nodes without a design, whether for
    a fault or for a negative wall. `room`, (limits,), is the tolerance within which a limit counts
    as met. `thinned`: the sweep had more nodes.
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
        found: Array = self.rows[:, :, self.study.place(name)]
        return found

    def boundaries(self) -> Iterator[Boundary]:
        """Yield the lines of every limit that is met at some nodes and missed at others."""
        from contourpy import FillType, LineType, contour_generator

        for number, margins in enumerate(self.margins):
            table = np.clip(margins, -FAR, FAR)
            known = table[np.isfinite(table)]
            if not len(known) or known.min() >= 0 or known.max() < 0:
                continue
            maker = contour_generator(
                self.xs, self.ys, np.ma.masked_invalid(table.T),
                fill_type=FillType.OuterOffset, line_type=LineType.Separate, corner_mask=True,
            )  # fmt: skip
            filled: Any = maker.filled(-2 * FAR, 0.0)
            found: Any = maker.lines(0.0)
            lines = [np.asarray(one) for one in found]
            areas = [
                [np.asarray(one)[a:b] for a, b in pairwise(starts)]
                for one, starts in zip(*filled, strict=True)
            ]
            rings = [ring for area in areas for ring in area]
            moved = self._on_zero(number, table, [*lines, *rings])
            rest = iter(moved[len(lines) :])
            yield Boundary(
                number, moved[: len(lines)], [[next(rest) for _ in area] for area in areas]
            )

    def _on_zero(self, number: int, table: Array, curves: Sequence[Array]) -> list[Array]:
        """Return curves with their points moved to zero margin.

        Points move along the edge between a met and a missed node. They stay where each design
        needs a new preparation.
        """
        if self.study.designs.apart or not curves:
            return list(curves)
        every = np.concatenate(curves)
        points, which = np.unique(np.round(every, 15), axis=0, return_inverse=True)
        edges = [self._edge(table, point) for point in points]
        moving = np.array([k for k, edge in enumerate(edges) if edge is not None], dtype=np.intp)
        if len(moving):
            low = np.array([edge[0] for edge in edges if edge is not None])
            high = np.array([edge[1] for edge in edges if edge is not None])
            ends = np.array([edge[2] for edge in edges if edge is not None])
            points[moving] = self._zeros(number, low, high, ends)
        found = points[which.ravel()]
        cuts = np.cumsum([len(curve) for curve in curves])[:-1]
        return list(np.split(found, cuts))

    def _edge(
        self, table: Array, point: Array
    ) -> tuple[list[float], list[float], list[float]] | None:
        """Return ends and margins of the grid edge under a point, if its margin changes sign."""
        nodes = (self.xs, self.ys)
        places = []
        for axis, value in zip(nodes, point, strict=True):
            near = int(np.argmin(np.abs(axis - value)))
            on = abs(axis[near] - value) <= 1e-9 * float(axis[-1] - axis[0])
            below = min(max(int(np.searchsorted(axis, value)) - 1, 0), len(axis) - 2)
            places.append((near, near) if on else (below, below + 1))
        (i, k), (j, m) = places
        if (i == k) == (j == m):  # a node, or inside a cell
            return None
        ends = [float(table[i, j]), float(table[k, m])]
        if (ends[0] < 0) == (ends[1] < 0) or not np.isfinite(ends).all():
            return None
        return [self.xs[i], self.ys[j]], [self.xs[k], self.ys[m]], ends

    def _zeros(self, number: int, low: Array, high: Array, ends: Array) -> Array:
        """Return points of zero margin between ends of opposite sign, by the Illinois method."""
        a, b = np.zeros(len(low)), np.ones(len(low))
        f, g = ends[:, 0].copy(), ends[:, 1].copy()
        t, going = np.where(f == 0, 0.0, 1.0), (f != 0) & (g != 0)
        for _ in range(STEPS):
            at = np.flatnonzero(going)
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
            going[at] = np.abs(value) > CLOSE
        found: Array = low + t[:, None] * (high - low)
        return found


def margins_at(study: Study, numbers: Array) -> Array:
    """Return the margin of every limit, (limits, n), at numbers (axes, n) of the plan."""
    count = numbers.shape[1]
    found = np.full((len(study.binding), count), np.nan)
    for places, subject, varied in study.designs.groups(
        SweepPoints(np.zeros(count, dtype=int), numbers)
    ):
        if not isinstance(subject, str):
            found[:, places] = margins_of(subject, varied, len(places))
    return found


def require_grid(plan: Plan) -> None:
    """Reject a sweep that is not a grid of two numbers.

    Raises
    ------
    UsageError
        another method, not two axes, names on an axis, or a single value
    """
    for axis in plan.named:
        message = f"a contour needs numbers, but {axis.path} takes names"
        raise UsageError(Diagnostic(message, "set it with --set, and vary two numbers"))
    if len(plan.axes) != 2:
        message = f"a contour needs exactly two --vary, not {len(plan.axes)}"
        raise UsageError(Diagnostic(message, "set the others with --set"))
    if plan.method != "grid":
        message = f"a contour needs a grid, not --method {plan.method}"
        raise UsageError(Diagnostic(message, "omit --method and write PATH=A..B:N"))
    for axis in plan.axes:
        if axis.size < 2:
            raise UsageError(
                Diagnostic(f"a contour needs at least two values of {axis.path}", "add values")
            )


def _cut_away(study: Study, margins: Array) -> Array:
    """Return the nodes with a negative wall or clearance; other limits have no margin there."""
    shapes = np.array([one.origin == "geometry" for one in study.binding])
    gone: Array = (margins[shapes] < NOTHING).any(axis=0)
    for number in np.flatnonzero(~shapes):
        margins[number][gone] = np.nan
    return gone


def field(study: Study) -> Field:
    """Evaluate again the grid of a sweep of two numbers, at most `FINEST` nodes per axis."""
    require_grid(study.plan)
    values = [axis.numbers() for axis in study.plan.axes]
    wide = len(values[1])
    kept = []
    for one in values:
        order = np.argsort(one)
        at = np.unique(np.round(np.linspace(0, len(one) - 1, min(len(one), FINEST))).astype(int))
        kept.append(order[at])
    chunks = [study.chunk(int(i) * wide, wide, kept[1]) for i in kept[0]]
    xs, ys = (value[at] for value, at in zip(values, kept, strict=True))
    failed = np.zeros((len(xs), len(ys)), dtype=bool)
    for k, one in enumerate(chunks):
        failed[k, list(one.rows.failures)] = True
    mesh = np.stack([part.ravel() for part in np.meshgrid(xs, ys, indexing="ij")])
    margins = margins_at(study, mesh).reshape(-1, len(xs), len(ys))
    just = np.abs(margins) <= TOLERANCE  # within tolerance: met, as in every verdict
    room = np.where(just.any(axis=(1, 2)), TOLERANCE, 0.0)
    margins += room[:, None, None]
    gone = _cut_away(study, margins)
    margins[:, failed & ~gone] = np.nan  # a negative wall keeps the margins of its shape
    failed |= gone
    rows = np.stack([chunk.rows.numbers for chunk in chunks])
    thinned = any(len(value) > FINEST for value in values)
    return Field(study, xs, ys, rows, margins, failed, room, thinned)


Task = TypeVar("Task")
