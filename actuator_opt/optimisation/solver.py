"""The optimiser: sweep the box, descend from the best starts, finish exactly, judge honestly.

Default path: a low-discrepancy sweep suggests starts; SLSQP runs from each in logarithmic
variables, again in linear ones where it failed, and an augmented Lagrangian around LBFGS takes
over where nothing worked; active-set Newton brings the result to rounding. Feasibility and
optimality are then checked here, whatever a solver claims.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..progress import tell
from . import elastic, kkt, nlopt_wrapper
from .evaluator import Evaluator, LimitReached, Point
from .newton import polish
from .outcome import LocalOptimum, Outcome, Solution, StartRecord
from .problem import Problem, Vector
from .sampling import Sweep, distinct, sweep

FEASIBLE = 1e-6
"""Worst missed margin that still counts as met (contract)."""

RESIDUAL = 1e-6
"""Largest residual of the optimality conditions that counts as an optimum."""

FINISH = "active-set Newton"

RESTORATION = "least worst miss by LD_SLSQP"

NEARER = 1e-3
"""Share by which a worst miss must be less than those known to be another one."""

ELSEWHERE = 1.0
"""Share by which a worst miss must exceed the least known for its search to count as stuck."""

LOCAL_EVALUATIONS = 150
"""Most evaluations of one local run of a default algorithm."""


@dataclass
class _Optimum:
    point: Point
    residual: float
    algorithm: str
    hits: int = 1

    @property
    def good(self) -> bool:
        return self.point.violation <= FEASIBLE and self.residual <= RESIDUAL


class _Search:
    """The state of one run: the evaluator, what was found, what to tell."""

    def __init__(self, evaluator: Evaluator, seed: int) -> None:
        self.evaluator = evaluator
        self.seed = seed
        self.optima: list[_Optimum] = []
        self.records: list[StartRecord] = []
        self.warnings: list[str] = []
        self.least: list[Point] = []
        """Where the most missed limit is missed least, though it is missed."""
        self.objective_scale = 0.0

    @property
    def succeeded(self) -> bool:
        return any(optimum.good for optimum in self.optima)

    @property
    def feasible(self) -> bool:
        return any(optimum.point.violation <= FEASIBLE for optimum in self.optima)

    def residual(self, point: Point) -> float:
        if not point.valid:
            return np.inf
        return kkt.check(self.evaluator, point, objective_scale=self.objective_scale).residual

    def same(self, point: Point) -> _Optimum | None:
        """Return the optimum already found that a point has run into."""
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
        """One local run with its finish; True where it ended on an optimum."""
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
        """Go to where the most missed limit is missed least, and on from there if all are met."""
        before = self.evaluator.evaluations
        least = min((one.violation for one in self.least), default=np.inf)
        found = elastic.least_missed(self.evaluator, point, least / 2)
        if found.violation <= FEASIBLE:
            self.descend(found, "LD_SLSQP", linear=False, most=LOCAL_EVALUATIONS)
            return
        if found.violation < least * (1 - NEARER):
            self.optima.append(_Optimum(found, self.residual(found), RESTORATION))
        self.least.append(found)
        if found.violation > least * (1 + ELSEWHERE):
            self.descend(found, "LD_SLSQP", linear=False, most=LOCAL_EVALUATIONS)
        elif point is start:
            used = self.evaluator.evaluations - before
            self.records.append(
                StartRecord(start.x, found.objective, found.violation, RESTORATION, used)
            )

    def finish(self, point: Point, algorithm: str) -> _Optimum:
        """Polish a point and enter it among the optima."""
        better = polish(self.evaluator, point)
        if better is not point:
            algorithm = f"{algorithm}, {FINISH}"
        known = self.same(better) if better.valid else None
        if known is not None:
            known.hits += 1
            return known
        optimum = _Optimum(better, self.residual(better), algorithm)
        self.optima.append(optimum)
        return optimum

    def best(self) -> _Optimum | None:
        """Feasible points by objective, then the least infeasible.

        A point whose optimality is proven wins over one that is better by rounding only.
        """

        def rank(optimum: _Optimum) -> tuple[float, float]:
            point = optimum.point
            if not point.valid:
                return (np.inf, np.inf)
            missed = point.violation if point.violation > FEASIBLE else 0.0
            return (missed, point.objective)

        first = min(self.optima, key=rank, default=None)
        if first is None or first.good:
            return first
        room = 1e-7 * max(abs(first.point.objective), 1e-300)
        proven = [
            o for o in self.optima if o.good and o.point.objective <= first.point.objective + room
        ]
        return min(proven, key=rank, default=first)


def solve(
    problem: Problem,
    *,
    algorithm: str = "auto",
    starts: int = 6,
    samples: int = 8192,
    seed: int = 0,
    max_evaluations: int | None = None,
    max_seconds: float | None = None,
    more_starts: Sequence[Vector] = (),
) -> Solution:
    """Find the best point of a problem.

    Parameters
    ----------
    problem : the problem; its own start, if any, is always tried
    algorithm : "auto" (the default path) or a name that `nlopt_wrapper.find` knows
    starts : how many starts to descend from: those given, the rest from the global sweep
    samples : points of the global sweep
    seed : of the sweep and of stochastic algorithms; the same seed gives the same result
    max_evaluations, max_seconds : limits of the whole run; the best point so far is kept
    more_starts : further starts (n,)

    Raises
    ------
    UsageError
        Where the algorithm does not exist or does not suit the problem.
    """
    chosen = "auto" if algorithm == "auto" else nlopt_wrapper.suit(algorithm, problem)
    evaluator = Evaluator(problem, max_evaluations=max_evaluations, max_seconds=max_seconds)
    search = _Search(evaluator, seed)
    if evaluator.space.size == 0:
        return _fixed(search)
    swept = sweep(evaluator, samples, seed)
    search.objective_scale = swept.scale
    try:
        points = _starts(search, swept, starts, more_starts)
        if points:
            search.warnings += evaluator.check_gradients(points[0])
            if chosen == "auto":
                _default_path(search, points)
            else:
                _chosen_path(search, points, chosen)
    except LimitReached:
        pass
    return _conclude(search, swept)


def _starts(search: _Search, swept: Sweep, wanted: int, more: Sequence[Vector]) -> list[Point]:
    """Return valid starts: the user's, then further ones given, then the best of the sweep."""
    evaluator = search.evaluator
    given = [x for x in (evaluator.problem.start, *more) if x is not None]
    coordinates = [evaluator.space.to_z(np.asarray(x, dtype=float)) for x in given]
    coordinates += distinct(evaluator, swept.z, max(wanted - len(coordinates), 1))
    if not coordinates:
        coordinates = [(evaluator.space.lower + evaluator.space.upper) / 2]
    points = [evaluator.point(z) for z in coordinates]
    return [p for p in points if p.valid]


def _default_path(search: _Search, points: list[Point]) -> None:
    """SLSQP in logarithmic variables; what failed again, by other means.

    Where the first start leads to no feasible point, neither itself nor from where its most
    missed limit is missed least, the others look for a feasible point first.
    """
    failed = []
    for number, point in enumerate(points):
        tell("searching for a design", number / len(points))
        if search.least and not search.feasible:
            search.restore(point, start=point)
        elif not search.descend(point, "LD_SLSQP", linear=False, most=LOCAL_EVALUATIONS):
            failed.append(point)
            if not search.feasible:
                search.restore(search.optima[-1].point, start=point)
    if search.least and not search.feasible:
        return
    best = search.best()
    if best is not None and best.point.violation <= FEASIBLE and not search.succeeded:
        search.descend(best.point, "LD_SLSQP", linear=False, most=LOCAL_EVALUATIONS)
    failed = [
        point
        for point in failed[:2]
        if not search.descend(point, "LD_SLSQP", linear=True, most=LOCAL_EVALUATIONS)
    ]
    if search.succeeded or not search.feasible:
        return
    for point in failed:
        if search.descend(point, "AUGLAG+LD_LBFGS", linear=False):
            return


def _chosen_path(search: _Search, points: list[Point], chosen: str) -> None:
    """Local algorithms run from every start; global ones once, then SLSQP refines."""
    outer, _ = nlopt_wrapper.find(chosen)
    if outer.scope == "local" or outer.name.startswith("AUGLAG"):
        for point in points:
            search.descend(point, chosen, linear=False)
        return
    run = nlopt_wrapper.run(search.evaluator, points[0], chosen, seed=search.seed)
    search.descend(run.point, "LD_SLSQP", linear=False, most=LOCAL_EVALUATIONS)
    for optimum in search.optima:
        optimum.algorithm = f"{chosen}, {optimum.algorithm}"


def _fixed(search: _Search) -> Solution:
    point = search.evaluator.point(np.empty(0))
    search.optima.append(_Optimum(point, 0.0, "none"))
    nothing = Sweep(np.empty((0, 0)), np.empty(0), np.empty(0), 0, 0, 0, 0.0, 0.0)
    return _conclude(search, nothing)


def _conclude(search: _Search, swept: Sweep) -> Solution:
    """Judge the best point and put everything together."""
    evaluator = search.evaluator
    evaluator.limited = False
    best = search.best()
    if best is None or not best.point.valid:
        best = _fallback(search, swept)
    point, idle = _settle(search, best)
    found = None
    if point.valid and evaluator.space.size:
        found = kkt.check(evaluator, point, curvature=True, objective_scale=search.objective_scale)
    outcome = _outcome(search, swept, point, found)
    if swept.count and swept.valid < swept.count:
        share = 100 * (1 - swept.valid / swept.count)
        search.warnings.append(f"the model has no finite values in {share:.3g} % of the box")
    if evaluator.bad_slopes:
        search.warnings.append(
            f"{evaluator.bad_slopes} gradients had entries that do not exist (infinite slope)"
        )
    m = evaluator.constraint_count
    return Solution(
        problem=evaluator.problem,
        outcome=outcome,
        x=point.x,
        objective=point.objective,
        constraints=point.rows[1 : 1 + m],
        equalities=point.rows[1 + m :],
        violation=point.violation,
        kkt=found,
        evaluations=evaluator.evaluations,
        gradients=evaluator.gradients,
        samples=swept.count,
        feasible_samples=swept.feasible,
        starts=tuple(search.records),
        optima=_local_optima(search),
        trace=tuple(evaluator.trace),
        algorithm=best.algorithm,
        without_effect=idle,
        warnings=tuple(search.warnings),
        seed=search.seed,
        seconds=time.perf_counter() - evaluator.began,
    )


def _fallback(search: _Search, swept: Sweep) -> _Optimum:
    """Return the best point of the sweep, or the middle of the box, where no local run ended."""
    evaluator = search.evaluator
    z = (evaluator.space.lower + evaluator.space.upper) / 2
    if swept.z.shape[1]:
        z = swept.z[:, 0].copy()
    point = evaluator.point(z)
    return _Optimum(point, search.residual(point), "sweep")


def _settle(search: _Search, best: _Optimum) -> tuple[Point, tuple[str, ...]]:
    """Put variables without effect back to their start, or the middle of their bounds."""
    evaluator = search.evaluator
    space, problem = evaluator.space, evaluator.problem
    if not best.point.valid or space.size == 0:
        return best.point, ()
    evaluator.jacobian(best.point)
    idle = np.flatnonzero(evaluator.influence[1] == 0.0)
    if len(idle) == 0:
        return best.point, ()
    rest = (space.lower + space.upper) / 2
    if problem.start is not None:
        rest = space.to_z(problem.start)
    z = best.point.z.copy()
    z[idle] = rest[idle]
    moved = evaluator.point(z)
    names = tuple(problem.names[space.free[j]] for j in idle)
    same = moved.valid and np.array_equal(moved.rows, best.point.rows)
    return (moved if same else best.point), names


def _outcome(search: _Search, swept: Sweep, point: Point, found: kkt.Kkt | None) -> Outcome:
    evaluator = search.evaluator
    if not point.valid:
        return Outcome.UNDEFINED
    feasible = point.violation <= FEASIBLE
    if evaluator.space.size == 0 or found is None:
        return Outcome.NOTHING_FREE if feasible else Outcome.INFEASIBLE
    if evaluator.exhausted and not (feasible and found.residual <= RESIDUAL):
        return Outcome.LIMIT if feasible else Outcome.LIMIT_INFEASIBLE
    if not feasible:
        return Outcome.INFEASIBLE
    if not evaluator.influence[0].any() and swept.spread <= 1e-12:
        return Outcome.FLAT
    if found.residual > RESIDUAL:
        return Outcome.NOT_STATIONARY
    if found.curvature is kkt.Curvature.NEGATIVE:
        return Outcome.SADDLE
    return Outcome.LIMIT if evaluator.exhausted else Outcome.OPTIMUM


def _local_optima(search: _Search) -> tuple[LocalOptimum, ...]:
    valid = [o for o in search.optima if o.point.valid]
    valid.sort(key=lambda o: (not o.good, max(o.point.violation, FEASIBLE), o.point.objective))
    return tuple(
        LocalOptimum(o.point.x, o.point.objective, o.point.violation, o.residual, o.hits)
        for o in valid
    )
