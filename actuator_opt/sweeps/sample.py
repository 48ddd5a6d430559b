"""Rows of a sweep for drawing: a bounded, evenly thinned number, with exact Pareto lines."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from ..base.numeric import Array
from .chunk import Chunk, Study

MOST_POINTS = 4096
"""Rows kept of the feasible designs, and of the others (a choice: print resolves no more). Beyond
it every second row is dropped, repeatedly."""

LONGEST = 65_536
"""Points kept per Pareto line (a choice: 1 MB each)."""

LESS_IS_BETTER = -1
MORE_IS_BETTER = 1


def better(study: Study, metric: str) -> int:
    """Return which way a metric is better: by the objective, its limits, else its worst value.

    1 for more, -1 for less, 0 with limits on both sides.
    """
    goal = study.goal
    if metric in goal.weights:
        return LESS_IS_BETTER if goal.sign * goal.weights[metric] > 0 else MORE_IS_BETTER
    senses: set[str | None] = {one.sense for one in study.binding if one.metric == metric}
    if len(senses) > 1:
        return 0
    sense = senses.pop() if senses else study.quantity(metric).worst
    return MORE_IS_BETTER if sense == "min" else LESS_IS_BETTER


def front(first: Array, second: Array) -> Array:
    """Return the numbers of the non-dominated points, along `first`; less is better.

    A point is dominated by another that is no worse in both values and better in one. Of equal
    points the first stays.
    """
    order = np.lexsort((second, first))
    known = order[np.isfinite(first[order]) & np.isfinite(second[order])]
    falls = second[known]
    least = np.minimum.accumulate(np.concatenate([[np.inf], falls[:-1]])) if len(falls) else falls
    kept: Array = known[falls < least]
    return kept


@dataclass
class Pool:
    """Every k-th row of a stream, at most `MOST_POINTS` in total."""

    seen: int = 0
    step: int = 1
    variants: Array = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    rows: Array = field(default_factory=lambda: np.empty((0, 0)))

    def add(self, variants: Array, rows: Array) -> None:
        """Add rows with their combinations of names."""
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
        """Return variants and rows, thinned evenly to at most so many, and the step."""
        step = max(1, -(-len(self.rows) // most))
        return self.variants[::step], self.rows[::step], self.step * step


@dataclass
class Sample:
    """Feasible and other rows, collected as a sweep runs; failed designs are left out.

    `watch` are metrics; every pair has a Pareto line over all feasible designs.
    """

    watch: tuple[str, ...] = ()
    feasible: Pool = field(default_factory=Pool)
    others: Pool = field(default_factory=Pool)
    _fronts: dict[tuple[str, str], Array] = field(default_factory=dict, repr=False)

    def add(self, study: Study, chunk: Chunk) -> None:
        """Collect the rows of a chunk that are drawn."""
        rows = chunk.rows.numbers
        answered = np.ones(len(rows), dtype=bool)
        answered[list(chunk.rows.failures)] = False
        variants = np.zeros(len(rows), dtype=np.int64)
        if study.plan.named:
            variants = study.plan.points(chunk.first, len(rows)).variant
        for pool, which in (
            (self.feasible, chunk.feasible & answered),
            (self.others, ~chunk.feasible & answered),
        ):
            at = np.flatnonzero(which)
            pool.add(variants[at], rows[at])
        good = rows[chunk.feasible & answered]
        if len(good):
            for pair in combinations(self.watch, 2):
                self._fronts[pair] = _extended(study, pair, self._fronts.get(pair), good)

    def front(self, study: Study, pair: tuple[str, str]) -> tuple[Array, bool]:
        """Return the Pareto line (2, n) of two metrics (SI), and whether it covers every design.

        Empty where the better direction of a metric is unknown.
        """
        for one in (pair, pair[::-1]):
            if one in self._fronts:
                kept = self._fronts[one]
                return (kept if one == pair else kept[::-1, ::-1]), True
        rows = self.feasible.rows
        if not len(rows):
            return np.empty((2, 0)), True
        return _extended(study, pair, None, rows), self.feasible.step == 1


def _extended(study: Study, pair: tuple[str, str], known: Array | None, rows: Array) -> Array:
    """Return a Pareto line extended by more designs."""
    ways = [better(study, name) for name in pair]
    if 0 in ways:
        return np.empty((2, 0))
    values = rows[:, [study.place(name) for name in pair]].T
    if known is not None:
        values = np.concatenate([known, values], axis=1)
    kept = values[:, front(-ways[0] * values[0], -ways[1] * values[1])]
    while kept.shape[1] > LONGEST:
        kept = kept[:, ::2]
    return kept
