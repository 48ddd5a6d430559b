"""Results of a sweep."""

from __future__ import annotations

import heapq
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..base.tables import Displayed
from ..version import VERSION
from .chunk import Chunk, Study
from .sample import Sample


@dataclass(frozen=True, order=True)
class Best:
    """One of the best designs: its objective (to be minimised), point and row."""

    objective: float
    number: int
    row: tuple[float, ...] = field(compare=False)

    @property
    def margin(self) -> float:
        """Return the least margin of all limits."""
        return self.row[-3]


@dataclass
class Swept(Displayed):
    """Results of a sweep."""

    study: Study
    requested: int
    computed: int = 0
    reused: int = 0
    damaged: int = 0
    """Rows computed again because the database holds them damaged."""
    failed: int = 0
    feasible: int | None = 0
    """None when only the best are kept, as most designs are then never evaluated."""
    screened: int = 0
    """Designs ruled out by the screen or by better ones of their chunk, in reduced sweeps."""
    best: list[Best] = field(default_factory=list)
    failures: dict[str, int] = field(default_factory=dict)
    """Failed designs by reason."""
    missed: dict[str, int] = field(default_factory=dict)
    """Infeasible designs by the limit missed most."""
    seconds: float = 0.0
    sample: Sample = field(default_factory=Sample)
    """Rows for drawing."""

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
        found = {paths[k]: float(x) for k, x in zip(study.order, best.row, strict=False)}
        return {path: found[path] for path in paths}

    def limit(self, keep: int) -> float:
        """Return the objective that another design must improve on to join the best."""
        return self.best[-1].objective if len(self.best) >= keep else np.inf

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON form (CONTRACT): counts, and the best designs in SI."""
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
        """Add a chunk to the counts."""
        self.computed += chunk.computed
        self.damaged += chunk.damaged
        self.reused += max(len(chunk.rows.numbers) - chunk.computed, 0)
        self.screened += 0 if chunk.places is None else chunk.computed - len(chunk.places)
        if chunk.places is None:
            self.sample.add(self.study, chunk)
        self.failed += len(chunk.rows.failures)
        for reason in chunk.rows.failures.values():
            self.failures[reason] = self.failures.get(reason, 0) + 1
        good = np.flatnonzero(chunk.feasible)
        self.count_missed(chunk)
        if self.feasible is not None:
            self.feasible += len(good)
        ranked = np.flatnonzero(chunk.ranked)
        if keep and len(ranked):
            numbers = chunk.numbers
            order = ranked[np.argsort(chunk.objective[ranked], kind="stable")[:keep]]
            found = [
                Best(float(chunk.objective[k]), int(numbers[k]), tuple(chunk.rows.numbers[k]))
                for k in order
            ]
            self.best = heapq.nsmallest(keep, [*self.best, *found])
