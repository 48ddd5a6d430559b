"""Rows of a sweep to draw: bounded in number, thinned evenly, with exact Pareto lines."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from ..base.numeric import Array
from .chunk import Chunk, Study

MOST = 4096
"""Rows kept of the feasible designs, and of the others (a choice: more cannot be told apart in
print); beyond it every second is let go, again and again."""

LONGEST = 65_536
"""Points kept of a Pareto line (a choice: 1 MB each)."""

LESS_IS_BETTER = -1
MORE_IS_BETTER = 1


def better(study: Study, metric: str) -> int:
    """Which way a metric is better: by the objective, its limits, else its worst value.

    1 for more, -1 for less, 0 where both ways are limited.
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
    """Numbers of the points that no other betters, less being better, along `first`.

    A point goes where another is no worse in both and better in one; of equals the first stays.
    """
    order = np.lexsort((second, first))
    known = order[np.isfinite(first[order]) & np.isfinite(second[order])]
    falls = second[known]
    least = np.minimum.accumulate(np.concatenate([[np.inf], falls[:-1]])) if len(falls) else falls
    kept: Array = known[falls < least]
    return kept


@dataclass
class Pool:
    """Every k-th of some rows, at most `MOST`."""

    seen: int = 0
    step: int = 1
    variants: Array = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    rows: Array = field(default_factory=lambda: np.empty((0, 0)))

    def add(self, variants: Array, rows: Array) -> None:
        """Rows with the combinations of names they belong to."""
        at = np.arange((-self.seen) % self.step, len(rows), self.step)
        self.seen += len(rows)
        if not len(at):
            return
        self.variants = np.concatenate([self.variants, variants[at]])
        self.rows = np.concatenate([self.rows.reshape(-1, rows.shape[1]), rows[at]])
        while len(self.rows) > MOST:
            self.step *= 2
            self.variants, self.rows = self.variants[::2], self.rows[::2]

    def thinned(self, most: int) -> tuple[Array, Array, int]:
        """Variants and rows of an even choice of at most so many, and every which it is."""
        step = max(1, -(-len(self.rows) // most))
        return self.variants[::step], self.rows[::step], self.step * step


@dataclass
class Sample:
    """Rows of a sweep as it runs: the feasible and the others; designs that failed have none.

    `watch` are metrics; the Pareto line of each pair of them is kept of every feasible design.
    """

    watch: tuple[str, ...] = ()
    feasible: Pool = field(default_factory=Pool)
    others: Pool = field(default_factory=Pool)
    _fronts: dict[tuple[str, str], Array] = field(default_factory=dict, repr=False)

    def add(self, study: Study, chunk: Chunk) -> None:
        """Take of a chunk what is drawn."""
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
        """Values (2, n) of the Pareto line of two metrics (SI), and whether it is of every design.

        Empty where nothing says which way one of them is better.
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
    """A Pareto line with more designs."""
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
