"""Results of a sweep, with a limited number of evenly spread rows for its figures.

The Pareto lines of the figures are exact, as they take all rows into account.
"""

from __future__ import annotations

import heapq
from dataclasses import field
from itertools import combinations
from typing import Any

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, UsageError
from ..base.numeric import Array
from ..base.tables import Displayed
from ..design.paths import quantity_of
from ..rendering.series import Coded
from ..rendering.tables import DataColumn, DataTable, Library, Units
from ..version import VERSION
from .chunk import FEASIBLE, MARGIN, MISSED, Chunk, Study

MOST_POINTS = 4096
"""Maximum number of rows that are kept for figures, separately for feasible and other designs (our
choice: print resolves no more). Whenever there are more, every second row is dropped."""


LONGEST = 65_536
"""Maximum number of points in a Pareto line (our choice: 1 MB per line)."""


LESS_IS_BETTER = -1


MORE_IS_BETTER = 1


def better(study: Study, metric: str) -> int:
    """Return whether a larger or smaller value of a metric is better.

    This follows from the objective, else from the limits, else from the definition of the metric.
    The result is 1 if larger is better, -1 if smaller is, and 0 if the metric has limits on both
    sides.
    """
    goal = study.goal
    if metric in goal.weights:
        return LESS_IS_BETTER if goal.sign * goal.weights[metric] > 0 else MORE_IS_BETTER
    senses: set[str | None] = {limit.sense for limit in study.binding if limit.metric == metric}
    if len(senses) > 1:
        return 0
    sense = senses.pop() if senses else study.quantity(metric).worst
    return MORE_IS_BETTER if sense == "min" else LESS_IS_BETTER


def front(first: Array, second: Array) -> Array:
    """Return the indices of the non-dominated points in the order of `first`; less is better.

    A point is dominated if another point is no worse in both values and better in at least one. Of
    equal points, the first is kept.
    """
    order = np.lexsort((second, first))
    finite = order[np.isfinite(first[order]) & np.isfinite(second[order])]
    values = second[finite]
    least = (
        np.minimum.accumulate(np.concatenate([[np.inf], values[:-1]])) if len(values) else values
    )
    non_dominated: Array = finite[values < least]
    return non_dominated


@dataclass
class Pool:
    """Collects every k-th row of a sweep; k grows so that at most `MOST_POINTS` rows are kept."""

    seen: int = 0
    step: int = 1
    variants: Array = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    rows: Array = field(default_factory=lambda: np.empty((0, 0)))

    def add(self, variants: Array, rows: Array) -> None:
        """Add rows, each with the index of its combination of texts (such as materials)."""
        at = np.arange((-self.seen) % self.step, len(rows), self.step)
        self.seen += len(rows)
        if not len(at):
            return
        self.variants = np.concatenate([self.variants, variants[at]])
        self.rows = np.concatenate([self.rows.reshape(-1, rows.shape[1]), rows[at]])
        while len(self.rows) > MOST_POINTS:
            self.step *= 2
            self.variants, self.rows = self.variants[::2], self.rows[::2]

    def thinned(self, most: int) -> tuple[Array, Array, int]:
        """Return at most `most` evenly spread rows, the indices added with them, and the step k."""
        step = max(1, -(-len(self.rows) // most))
        return self.variants[::step], self.rows[::step], self.step * step


@dataclass
class Sample:
    """Feasible and infeasible rows, collected while a sweep runs, without failed designs.

    `watch` are metrics. For each pair of them, a Pareto line over all feasible designs is kept.
    """

    watch: tuple[str, ...] = ()
    feasible: Pool = field(default_factory=Pool)
    others: Pool = field(default_factory=Pool)
    _fronts: dict[tuple[str, str], Array] = field(default_factory=dict, repr=False)

    def add(self, study: Study, chunk: Chunk) -> None:
        """Collect the rows of a chunk for drawing."""
        rows = chunk.rows.numbers
        valid = np.ones(len(rows), dtype=bool)
        valid[list(chunk.rows.failures)] = False
        variants = np.zeros(len(rows), dtype=np.int64)
        if study.plan.named:
            variants = study.plan.points(chunk.first, len(rows)).variant
        for pool, selected in (
            (self.feasible, chunk.feasible & valid),
            (self.others, ~chunk.feasible & valid),
        ):
            at = np.flatnonzero(selected)
            pool.add(variants[at], rows[at])
        feasible_rows = rows[chunk.feasible & valid]
        if len(feasible_rows):
            for pair in combinations(self.watch, 2):
                self._fronts[pair] = _extended(study, pair, self._fronts.get(pair), feasible_rows)

    def front(self, study: Study, pair: tuple[str, str]) -> tuple[Array, bool]:
        """Return the Pareto line (2, n) of two metrics (SI), and whether it is complete.

        The line is empty if it is unknown for a metric whether a larger or a smaller value is
        better.
        """
        for order in (pair, pair[::-1]):
            if order in self._fronts:
                line = self._fronts[order]
                return (line if order == pair else line[::-1, ::-1]), True
        rows = self.feasible.rows
        if not len(rows):
            return np.empty((2, 0)), True
        return _extended(study, pair, None, rows), self.feasible.step == 1


def _extended(study: Study, pair: tuple[str, str], previous: Array | None, rows: Array) -> Array:
    """Return a Pareto line extended by more designs."""
    directions = [better(study, name) for name in pair]
    if 0 in directions:
        return np.empty((2, 0))
    values = rows[:, [study.place(name) for name in pair]].T
    if previous is not None:
        values = np.concatenate([previous, values], axis=1)
    line = values[:, front(-directions[0] * values[0], -directions[1] * values[1])]
    while line.shape[1] > LONGEST:
        line = line[:, ::2]
    return line


@dataclass(frozen=True)
class Best:
    """One of the best designs, with its objective (to be minimised), point and row."""

    objective: float
    number: int
    row: tuple[float, ...] = field(compare=False)

    @property
    def margin(self) -> float:
        """Return the least margin of all limits."""
        return self.row[-3]


@dataclass
class AllRows:
    """Every row of a sweep in memory: an array (columns, points), a row per column."""

    numbers: Array
    variants: Array
    """Number of the combination of texts of each point."""
    failures: Array
    """Index of the reason in `reasons` for each failed point, else -1."""
    reasons: dict[str, int] = field(default_factory=dict)

    @classmethod
    def empty(cls, study: Study) -> AllRows:
        """Space for all rows of a sweep."""
        count = study.plan.count
        variants = np.zeros(count if study.plan.named else 0, dtype=np.int32)
        numbers = np.empty((len(study.columns), count))
        return cls(numbers, variants, np.full(count, -1, dtype=np.int32))

    def add(self, study: Study, chunk: Chunk) -> None:
        """Store the rows of a chunk."""
        count = len(chunk.rows.numbers)
        part = np.s_[chunk.first : chunk.first + count]
        self.numbers[:, part] = chunk.rows.numbers.T
        for k, reason in chunk.rows.failures.items():
            place = self.reasons.setdefault(reason, len(self.reasons))
            self.failures[chunk.first + k] = place
        if study.plan.named:
            self.variants[part] = study.plan.points(chunk.first, count).variant


@dataclass
class Swept(Displayed):
    """Results of a sweep."""

    study: Study
    requested: int
    computed: int = 0
    reused: int = 0
    damaged: int = 0
    """Number of rows that were computed again because they are damaged in the database."""
    failed: int = 0
    feasible: int | None = 0
    """Number of feasible designs; None if only the best are kept, because most designs are then not
    evaluated."""
    screened: int = 0
    """Number of designs that a reduced sweep excluded, either by its screen or because the same
    chunk contains enough better designs."""
    best: list[Best] = field(default_factory=list)
    failures: dict[str, int] = field(default_factory=dict)
    """Number of failed designs, by reason."""
    missed: dict[str, int] = field(default_factory=dict)
    """Number of infeasible designs, by the limit that they miss most."""
    seconds: float = 0.0
    sample: Sample = field(default_factory=Sample)
    """Rows for figures."""
    rows: AllRows | None = field(default=None, repr=False)
    """All rows, if they were kept."""

    @property
    def in_short(self) -> tuple[str, str]:
        """The number of designs, and how many of them are feasible."""
        found = "" if self.feasible is None else f", {self.feasible} feasible"
        best = ""
        single = self.study.goal.single
        if self.best and single is not None:
            value = self.metrics(self.best[0])[single]
            best = (
                ""
                if value is None
                else f", best {single} {self.study.quantity(single).text(value)}"
            )
        return self.study.design.name, f"{self.requested} designs{found}{best}"

    def metrics(self, best: Best) -> dict[str, float | None]:
        """Return the metrics of one of the best designs (SI); None without a value."""
        values = dict(zip([c.name for c in self.study.columns], best.row, strict=True))
        return {
            name: None if np.isnan(values[name]) else values[name] for name in self.study.metrics
        }

    def values(self, best: Best) -> dict[str, float | str]:
        """Return the varied values of one of the best designs, by PATH (SI)."""
        study = self.study
        if study.plan.named:
            return study.values(best.number)
        paths = [axis.path for axis in study.plan.numeric]
        numbers = {paths[k]: float(x) for k, x in zip(study.order, best.row, strict=False)}
        return {path: numbers[path] for path in paths}

    def table(self) -> DataTable:
        """All designs as a table: varied inputs, metrics, least margin, and reasons of failures.

        `met` states whether every requirement and check is met. `governing_limit` is the limit with
        the least margin.

        Raises
        ------
        InputError : the rows were not kept
        """
        rows, study = self.rows, self.study
        if rows is None:
            message = "the rows of this sweep were not kept in memory"
            remedy = "sweep with rows=True and without reduce, or write csv or parquet"
            raise InputError(Diagnostic(message, remedy))
        place = {column.name: k for k, column in enumerate(study.columns)}
        columns = []
        size = study.plan.variants
        for axis in study.plan.axes:
            if axis.values is not None:
                quantity = quantity_of(axis.path, study.design)
                columns.append(DataColumn(axis.path, rows.numbers[place[axis.path]], quantity))
            else:
                size //= axis.size
                columns.append(
                    DataColumn(axis.path, Coded(rows.variants // size % axis.size, axis.texts))
                )
        columns += [
            DataColumn(name, rows.numbers[place[name]], study.quantity(name))
            for name in study.metrics
        ]
        missed = rows.numbers[place[MISSED]]
        limits = np.where(np.isnan(missed), -1, np.nan_to_num(missed)).astype(np.int32)
        columns += [
            DataColumn("met", rows.numbers[place[FEASIBLE]] == 1.0),
            DataColumn(MARGIN, rows.numbers[place[MARGIN]]),
            DataColumn(MISSED, Coded(limits, study.limits)),
            DataColumn("failure", Coded(rows.failures, tuple(rows.reasons))),
        ]
        return DataTable(study.design.name, columns)

    def to_frame(self, library: Library = "pandas", *, units: Units = "si") -> Any:
        """All designs as a data frame (see `table` and `DataTable.to_frame`)."""
        return self.table().to_frame(library, units=units)

    def to_xarray(self, *, units: Units = "si") -> Any:
        """A full factorial as an `xarray.Dataset`, with a dimension for each varied PATH.

        Raises
        ------
        ActuatorError : xarray is not installed
        UsageError : the sweep is not a full factorial
        InputError : the rows were not kept
        """
        plan = self.study.plan
        if plan.method != "grid":
            message = f"a sweep by {plan.method} has no grid"
            raise UsageError(Diagnostic(message, "sweep a full factorial, or use to_frame"))
        return self.table().to_xarray({axis.path: axis.size for axis in plan.axes}, units=units)

    def limit(self, keep: int) -> float:
        """Return the objective that a further design must undercut to be among the best `keep`."""
        return self.best[-1].objective if len(self.best) >= keep else np.inf

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON form (see CONTRACT): counts, and the best designs in SI."""
        return {
            "name": self.study.design.name,
            "version": VERSION,
            "requested": self.requested,
            "computed": self.computed,
            "reused": self.reused,
            "damaged": self.damaged,
            "failed": self.failed,
            "feasible": self.feasible,
            "screened": self.screened,
            "engine": self.study.engine,
            "best": [
                {"variables": self.values(best), "metrics": self.metrics(best)}
                for best in self.best
            ],
            "failures": self.failures,
            "missed": self.missed,
            "seconds": self.seconds,
        }

    def count_missed(self, chunk: Chunk) -> None:
        """Count the limit that each design of a chunk misses most."""
        worst = chunk.rows.numbers[~chunk.feasible, -2]
        for number, times in zip(
            *np.unique(worst[np.isfinite(worst)], return_counts=True), strict=True
        ):
            name = self.study.limits[int(number)]
            self.missed[name] = self.missed.get(name, 0) + int(times)

    def add(self, chunk: Chunk, keep: int) -> None:
        """Add the rows of a chunk to counts, best designs and figures."""
        self.computed += chunk.computed
        self.damaged += chunk.damaged
        self.reused += max(len(chunk.rows.numbers) - chunk.computed, 0)
        self.screened += 0 if chunk.places is None else chunk.computed - len(chunk.places)
        if self.rows is not None:
            self.rows.add(self.study, chunk)
        if chunk.places is None:
            self.sample.add(self.study, chunk)
        self.failed += len(chunk.rows.failures)
        for reason in chunk.rows.failures.values():
            self.failures[reason] = self.failures.get(reason, 0) + 1
        feasible = np.flatnonzero(chunk.feasible)
        self.count_missed(chunk)
        if self.feasible is not None:
            self.feasible += len(feasible)
        ranked = np.flatnonzero(chunk.ranked)
        if keep and len(ranked):
            numbers = chunk.numbers
            order = ranked[np.argsort(chunk.objective[ranked], kind="stable")[:keep]]
            candidates = [
                Best(float(chunk.objective[k]), int(numbers[k]), tuple(chunk.rows.numbers[k]))
                for k in order
            ]
            self.best = heapq.nsmallest(
                keep, [*self.best, *candidates], key=lambda best: (best.objective, best.number)
            )
