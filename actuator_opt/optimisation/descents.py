"""Descents from points and their results: the state of one optimiser run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from . import elastic, kkt, nlopt_wrapper
from .actuator import StartRecord
from .evaluator import Evaluator, Point
from .kkt import polish

FEASIBLE = 1e-6
"""Worst missed margin that still counts as met (contract)."""

RESIDUAL = 1e-6
"""Largest residual of the optimality conditions that counts as an optimum."""

FINISH = "active-set Newton"

RESTORATION = "least worst violation by LD_SLSQP"

NEARER = 1e-3
"""Share by which a worst violation must improve on the known ones to count as new."""

ELSEWHERE = 1.0
"""Share by which a worst violation must exceed the least known for its search to count as stuck."""

LOCAL_EVALUATIONS = 150
"""Maximum evaluations of one local SLSQP run on the default path."""


@dataclass
class SearchResult:
    """The end point of runs: its residual, its algorithm, and how often it was reached."""

    point: Point
    residual: float
    algorithm: str
    hits: int = 1

    @property
    def good(self) -> bool:
        """Whether it is feasible and satisfies the optimality conditions."""
        return self.point.violation <= FEASIBLE and self.residual <= RESIDUAL


class Descents:
    """The state of one run: evaluator, results and warnings."""

    def __init__(self, evaluator: Evaluator, seed: int) -> None:
        self.evaluator = evaluator
        self.seed = seed
        self.optima: list[SearchResult] = []
        self.records: list[StartRecord] = []
        self.warnings: list[str] = []
        self.least: list[Point] = []
        """The infeasible point with the least worst violation."""
        self.objective_scale = 0.0
        self.interrupted = False

    @property
    def succeeded(self) -> bool:
        """Whether an optimum was reached."""
        return any(optimum.good for optimum in self.optima)

    @property
    def feasible(self) -> bool:
        """Whether a feasible point was reached."""
        return any(optimum.point.violation <= FEASIBLE for optimum in self.optima)

    def residual(self, point: Point) -> float:
        """Residual of the optimality conditions; infinite where the model is undefined."""
        if not point.valid:
            return np.inf
        return kkt.check(self.evaluator, point, objective_scale=self.objective_scale).residual

    def same(self, point: Point) -> SearchResult | None:
        """Return the known optimum that a point has reached."""
        for optimum in self.optima:
            known = optimum.point
            size = max(abs(known.objective), 1e-3 * self.objective_scale, 1e-300)
            near = abs(point.objective - known.objective) <= 1e-5 * size
            if optimum.good and near and np.abs(point.z - known.z).max(initial=0.0) <= 1e-3:
                return optimum
        return None

    def descend(
        self, start: Point, algorithm: str, *, linear: bool, most: int | None = None
    ) -> bool:
        """Run one local search and polish the result; True if it ended at an optimum."""
        before = self.evaluator.evaluations
        good = [o for o in self.optima if o.good]
        run = nlopt_wrapper.run(
            self.evaluator,
            start,
            algorithm,
            linear=linear,
            most=most,
            seed=self.seed,
            known=[o.point for o in good],
        )
        point, name = run.point, run.algorithm + (" (linear variables)" if linear else "")
        found = self.same(point) if point.valid and point.violation <= FEASIBLE else None
        if run.arrived is not None:
            found = good[run.arrived]
        if found is not None:
            found.hits += 1
            point = found.point
        else:
            found = self.finish(point, name)
        used = self.evaluator.evaluations - before
        self.records.append(
            StartRecord(start.x, found.point.objective, found.point.violation, name, used)
        )
        return found.good

    def restore(self, point: Point, *, start: Point) -> None:
        """Minimise the worst violation, and descend from there if it vanishes."""
        before = self.evaluator.evaluations
        least = min((one.violation for one in self.least), default=np.inf)
        found = elastic.least_missed(self.evaluator, point, least / 2)
        if found.violation <= FEASIBLE:
            self.descend(found, "LD_SLSQP", linear=False, most=LOCAL_EVALUATIONS)
            return
        if found.violation < least * (1 - NEARER):
            self.optima.append(SearchResult(found, self.residual(found), RESTORATION))
        self.least.append(found)
        if found.violation > least * (1 + ELSEWHERE):
            self.descend(found, "LD_SLSQP", linear=False, most=LOCAL_EVALUATIONS)
        elif point is start:
            used = self.evaluator.evaluations - before
            self.records.append(
                StartRecord(start.x, found.objective, found.violation, RESTORATION, used)
            )

    def finish(self, point: Point, algorithm: str) -> SearchResult:
        """Polish a point and add it to the optima."""
        better = polish(self.evaluator, point)
        if better is not point:
            algorithm = f"{algorithm}, {FINISH}"
        known = self.same(better) if better.valid else None
        if known is not None:
            known.hits += 1
            return known
        optimum = SearchResult(better, self.residual(better), algorithm)
        self.optima.append(optimum)
        return optimum

    def best(self, others: Sequence[SearchResult] = ()) -> SearchResult | None:
        """The best of the optima and other points: feasible ones first, by objective.

        A proven optimum wins over a point that is better only by rounding.
        """

        def rank(optimum: SearchResult) -> tuple[float, float]:
            point = optimum.point
            if not point.valid:
                return (np.inf, np.inf)
            missed = point.violation if point.violation > FEASIBLE else 0.0
            return (missed, point.objective)

        found = [*self.optima, *others]
        first = min(found, key=rank, default=None)
        if first is None or first.good:
            return first
        room = 1e-7 * max(abs(first.point.objective), 1e-300)
        proven = [o for o in found if o.good and o.point.objective <= first.point.objective + room]
        return min(proven, key=rank, default=first)
