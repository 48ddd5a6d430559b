"""The optimiser: sweeps the design space, descends from the best starts, refines and verifies.

On the default path, a low-discrepancy sweep suggests starts. From each start, SLSQP runs in
logarithmic variables and, if that fails, in linear variables. If all runs fail, the augmented
Lagrangian method with LBFGS follows. Active-set Newton steps reduce the remaining error to
rounding. Feasibility and optimality are then verified, independently of what a solver reports.

The sweep is a scrambled Halton sequence [Halton1960] [Owen2017]: each variable has its own prime
base. The coordinate of a point is the point's index, written in this base with its digits reversed
behind the radix point. The digits are permuted at random, with a seed.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import numpy as np

from ..base.dataclass import dataclass
from ..base.progress import tell
from . import kinks, kkt, nlopt_wrapper
from .evaluator import CHUNK, Evaluator, LimitReached, Point
from .problem import BoxProblem, Vector
from .resolve.parallel_descents import (
    LOCAL_EVALUATIONS,
    Descents,
    SearchResult,
    precompute,
)
from .resolve.steps import RESIDUAL
from .solution import MET, LocalOptimum, Outcome, Solution

KEEP = 256
"""Number of best points of the sweep that are kept as possible starts."""


def primes(count: int) -> list[int]:
    """The first `count` primes."""
    result: list[int] = []
    candidate = 2
    while len(result) < count:
        if all(candidate % p for p in result if p * p <= candidate):
            result.append(candidate)
        candidate += 1
    return result


class Halton:
    """Scrambled Halton points in the unit cube; the same seed gives the same points."""

    def __init__(self, dimension: int, seed: int, max_points: int = 2**31) -> None:
        generator = np.random.default_rng(seed)
        self.tables: list[Vector] = []
        for base in primes(dimension):
            digits = 1
            while base**digits < max_points:
                digits += 1
            order = generator.permuted(np.tile(np.arange(base), (digits, 1)), axis=1)
            self.tables.append(order * float(base) ** -np.arange(1, digits + 1)[:, None])
        self.shift = generator.random(dimension)  # for all digits beyond the tables
        self.most = max_points

    def points(self, first: int, count: int) -> Vector:
        """Points (dimension, count); the first has the index `first`."""
        result = np.empty((len(self.tables), count))
        for row, table, shift in zip(result, self.tables, self.shift, strict=True):
            base = table.shape[1]
            index = np.arange(first, first + count)
            total = np.full(count, shift * float(base) ** -len(table))
            for digit in table:
                if not index[-1]:
                    total += digit[0]
                    continue
                index, remainder = np.divmod(index, base)
                total += digit[remainder]
            row[:] = total
        return np.minimum(result, 1.0 - 2**-53)


@dataclass(frozen=True)
class Sweep:
    """Result of a sweep of the design space.

    Parameters
    ----------
    z : candidates (nf, k), sorted by violation, then by objective
    violation, objective : violation and objective of the candidates (k,)
    count, valid, feasible : numbers of all points, of points with finite values, and of feasible
        points
    spread : range of the objective in the sweep, relative to its largest magnitude there
    scale : largest magnitude among the candidates' objectives
    """

    z: Vector
    violation: Vector
    objective: Vector
    count: int
    valid: int
    feasible: int
    spread: float
    scale: float


def sweep(evaluator: Evaluator, samples: int, seed: int) -> Sweep:
    """Evaluate `samples` low-discrepancy points in chunks, and return the best of them, sorted."""
    space = evaluator.space
    sequence = Halton(space.size, seed, max_points=max(2, samples))
    width = (space.upper - space.lower)[:, None]
    best = (np.empty((space.size, 0)), np.empty(0), np.empty(0))
    count = valid = feasible = 0
    lowest, highest = np.inf, -np.inf
    for first in range(0, samples, CHUNK):
        try:
            evaluator.check_limits()
        except LimitReached:
            break
        size = min(CHUNK, samples - first)
        z = space.lower[:, None] + width * sequence.points(first, size)
        rows = evaluator.batch(z)
        violation = evaluator.violations(rows, "sum")
        good = np.isfinite(violation)
        count, valid = count + size, valid + int(good.sum())
        feasible += int((violation == 0).sum())
        z, violation, objective = z[:, good], violation[good], rows[0, good]
        lowest = min(lowest, objective.min(initial=np.inf))
        highest = max(highest, objective.max(initial=-np.inf))
        candidates = [
            np.concatenate(p, axis=-1) for p in zip(best, (z, violation, objective), strict=True)
        ]
        order = np.lexsort((candidates[2], candidates[1]))[:KEEP]
        best = (candidates[0][:, order], candidates[1][order], candidates[2][order])
    largest = max(abs(lowest), abs(highest)) if valid else 0.0
    spread = (highest - lowest) / largest if largest > 0 else 0.0
    scale = float(np.abs(best[2]).max(initial=0.0))
    return Sweep(*best, count, valid, feasible, float(spread), scale)


def distinct(evaluator: Evaluator, z: Vector, count: int) -> list[Vector]:
    """Up to `count` of the sorted candidates (nf, k) that are far apart from each other."""
    space = evaluator.space
    unit = (z - space.lower[:, None]) / (space.upper - space.lower)[:, None]
    selected: list[int] = []
    distance = 0.25 * np.sqrt(space.size)
    while len(selected) < count and distance > 1e-3:
        for k in range(unit.shape[1]):
            if len(selected) >= count:
                break
            gaps = unit[:, selected] - unit[:, k : k + 1]
            if not selected or np.sqrt((gaps**2).sum(axis=0)).min() >= distance:
                selected.append(k)
        distance /= 2
    return [z[:, k].copy() for k in selected]


LAGRANGIAN_EVALUATIONS = 1000
"""Maximum evaluations in one augmented Lagrangian run: the shipped designs take 300 to 850."""


def solve(
    problem: BoxProblem,
    *,
    algorithm: str = "auto",
    starts: int = 6,
    samples: int = 8192,
    seed: int = 0,
    max_evaluations: int | None = None,
    max_seconds: float | None = None,
    more_starts: Sequence[Vector] = (),
    keep_interrupted: bool = False,
    stop: Callable[[], bool] | None = None,
    check: bool = True,
    only_best: bool = False,
) -> Solution:
    """Find the best point of a problem.

    Parameters
    ----------
    problem : the problem; its own start, if any, is always tried
    algorithm : "auto" (the default path) or a name that `nlopt_wrapper.find` knows
    starts : number of starts; after the given starts, the best points of the global sweep are used
    samples : number of points of the global sweep
    seed : seed of sweep and stochastic algorithms; the same seed gives the same result
    max_evaluations, max_seconds : limits of the whole search; once a limit is reached, the best
        point so far is returned
    more_starts : further starts (n,)
    keep_interrupted : whether the best point so far is returned after Ctrl-C
    stop : called before every evaluation of a descent; if it returns True, the search ends with the
        best point so far
    check : whether gradients are compared with finite differences before they are used
    only_best : whether runs that end above a known optimum are left as they are, instead of
        refined to local optima

    Raises
    ------
    UsageError
        the algorithm does not exist or does not suit the problem
    """
    name = "auto" if algorithm == "auto" else nlopt_wrapper.suit(algorithm, problem)
    evaluator = Evaluator(
        problem, max_evaluations=max_evaluations, max_seconds=max_seconds, stop=stop
    )
    search = Descents(evaluator, seed, only_best=only_best)
    if evaluator.space.size == 0:
        return _fixed(search)
    swept = _nothing(evaluator)
    try:
        swept = sweep(evaluator, samples, seed)
        search.objective_scale = swept.scale
        points = _starts(search, swept, starts, more_starts)
        if points:
            if check:
                search.warnings += evaluator.check_gradients(points[0])
            if name == "auto":
                _default_path(search, points)
            else:
                _chosen_path(search, points, name)
    except LimitReached:
        pass
    except KeyboardInterrupt:
        if not keep_interrupted:
            raise
        search.interrupted = True
    return _conclude(search, swept)


def _nothing(evaluator: Evaluator) -> Sweep:
    """An empty sweep, for a search that needs no sweep."""
    size = evaluator.space.size
    return Sweep(np.empty((size, 0)), np.empty(0), np.empty(0), 0, 0, 0, 0.0, 0.0)


def _starts(search: Descents, swept: Sweep, count: int, further: Sequence[Vector]) -> list[Point]:
    """Valid starts: the problem's own, then the further starts, then the sweep's best."""
    evaluator = search.evaluator
    user_starts = [x for x in (evaluator.problem.start, *further) if x is not None]
    coordinates = [evaluator.space.to_z(np.asarray(x, dtype=float)) for x in user_starts]
    coordinates += distinct(evaluator, swept.z, max(count - len(coordinates), 1))
    if not coordinates:
        coordinates = [(evaluator.space.lower + evaluator.space.upper) / 2]
    points = [evaluator.point(z) for z in coordinates]
    return [p for p in points if p.valid]


def _default_path(search: Descents, points: list[Point]) -> None:
    """Run SLSQP in logarithmic variables, then other methods from failed starts.

    Several runs that end at the same point, which is no optimum, end the search.
    If the first start leads to no feasible point, even after its worst violation was minimised, the
    other starts first minimise their worst violation.
    """
    failed = []
    precompute(search.evaluator, points, seed=search.seed, max_evaluations=LOCAL_EVALUATIONS)
    for number, point in enumerate(points):
        tell("searching for a design", number / len(points))
        if search.least_infeasible and not search.feasible:
            search.restore(point, start=point)
        elif not search.descend(point, "LD_SLSQP", linear=False, max_evaluations=LOCAL_EVALUATIONS):
            failed.append(point)
            if not search.feasible:
                search.restore(search.optima[-1].point, start=point)
    if search.least_infeasible and not search.feasible:
        return
    failed = [
        point
        for point in failed[:2]
        if not search.stuck
        and not search.descend(point, "LD_SLSQP", linear=True, max_evaluations=LOCAL_EVALUATIONS)
    ]
    search.complete()
    if search.succeeded or search.stuck or not search.feasible:
        return
    for point in failed:
        if search.descend(
            point, "AUGLAG+LD_LBFGS", linear=False, max_evaluations=LAGRANGIAN_EVALUATIONS
        ):
            return


def _chosen_path(search: Descents, points: list[Point], name: str) -> None:
    """Run a local algorithm from every start, or a global algorithm once and then SLSQP."""
    outer, _ = nlopt_wrapper.find(name)
    if outer.scope == "local" or outer.name.startswith("AUGLAG"):
        for point in points:
            search.descend(point, name, linear=False)
        return
    run = nlopt_wrapper.run(search.evaluator, points[0], name, seed=search.seed)
    search.descend(run.point, "LD_SLSQP", linear=False, max_evaluations=LOCAL_EVALUATIONS)
    for optimum in search.optima:
        optimum.algorithm = f"{name}, {optimum.algorithm}"


def _fixed(search: Descents) -> Solution:
    point = search.evaluator.point(np.empty(0))
    search.optima.append(SearchResult(point, 0.0, "none"))
    return _conclude(search, _nothing(search.evaluator))


def _conclude(search: Descents, swept: Sweep) -> Solution:
    """Judge the best point and assemble the solution."""
    evaluator = search.evaluator
    evaluator.limited = False
    best = search.best()
    if best is None or search.interrupted or evaluator.exhausted or not search.feasible:
        best = _best_seen(search, swept)
    point, idle = _settle(search, best)
    quality = None
    if point.valid and evaluator.space.size:
        quality = kinks.check(
            evaluator, point, curvature=True, objective_scale=search.objective_scale
        )
    outcome = _outcome(search, swept, point, quality)
    if not point.valid:
        labels = np.array(
            [
                "the objective",
                *evaluator.problem.constraint_names,
                *evaluator.problem.equality_names,
            ]
        )
        lost = labels[~np.isfinite(point.rows)]
        others = f" and {len(lost) - 3} more" if len(lost) > 3 else ""
        search.warnings.append(
            f"not computable at the point where the search ended: {', '.join(lost[:3])}{others}"
        )
    if evaluator.bad_slopes:
        search.warnings.append(
            f"{evaluator.bad_slopes} gradients had undefined entries (a derivative was not finite)"
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
        kkt=quality,
        evaluations=evaluator.evaluations,
        gradients=evaluator.gradients,
        samples=swept.count,
        feasible_samples=swept.feasible,
        undefined=1 - swept.valid / swept.count if swept.count else 0.0,
        starts=tuple(search.records),
        optima=_local_optima(search),
        trace=tuple(evaluator.trace),
        algorithm=best.algorithm,
        without_effect=idle,
        warnings=tuple(search.warnings),
        seed=search.seed,
        seconds=time.perf_counter() - evaluator.began,
    )


def _best_seen(search: Descents, swept: Sweep) -> SearchResult:
    """The best point of the runs, the sweep, and the start (or the middle of the bounds)."""
    evaluator = search.evaluator
    if search.interrupted or evaluator.exhausted:
        evaluator.enter_precomputed()
    points = [evaluator.point(z) for z in (*swept.z[:, :1].T.copy(), evaluator.space.reference)]
    if evaluator.best is not None:
        points.insert(0, evaluator.best)
    best = search.best([SearchResult(p, search.residual(p), "best point seen") for p in points])
    assert best is not None
    return best


def _settle(search: Descents, best: SearchResult) -> tuple[Point, tuple[str, ...]]:
    """Reset variables that affect nothing to their start, or else to the middle of their bounds.

    Returns the new point and the names of these variables.
    """
    evaluator = search.evaluator
    space, problem = evaluator.space, evaluator.problem
    if not best.point.valid or space.size == 0:
        return best.point, ()
    evaluator.jacobian(best.point)
    idle = np.flatnonzero(evaluator.influence[1] == 0.0)
    if len(idle) == 0:
        return best.point, ()
    z = best.point.z.copy()
    z[idle] = space.reference[idle]
    restored = evaluator.point(z)
    names = tuple(problem.names[space.free[j]] for j in idle)
    unchanged = restored.valid and np.array_equal(restored.rows, best.point.rows)
    return (restored if unchanged else best.point), names


def _outcome(
    search: Descents, swept: Sweep, point: Point, kkt_residual: kkt.KktResidual | None
) -> Outcome:
    evaluator = search.evaluator
    feasible = point.valid and point.violation <= MET
    if search.interrupted:
        return Outcome.INTERRUPTED if feasible else Outcome.INTERRUPTED_INFEASIBLE
    if not point.valid:
        return Outcome.UNDEFINED
    if evaluator.space.size == 0 or kkt_residual is None:
        return Outcome.NOTHING_FREE if feasible else Outcome.INFEASIBLE
    if evaluator.exhausted and not (feasible and kkt_residual.residual <= RESIDUAL):
        return Outcome.LIMIT if feasible else Outcome.LIMIT_INFEASIBLE
    if not feasible:
        return Outcome.INFEASIBLE
    if not evaluator.influence[0].any() and swept.spread <= 1e-12:
        return Outcome.FLAT
    if kkt_residual.residual > RESIDUAL:
        return Outcome.NOT_STATIONARY
    if kkt_residual.curvature is kkt.Curvature.NEGATIVE:
        return Outcome.SADDLE
    return Outcome.LIMIT if evaluator.exhausted else Outcome.OPTIMUM


def _local_optima(search: Descents) -> tuple[LocalOptimum, ...]:
    valid = [o for o in search.optima if o.point.valid]
    valid.sort(key=lambda o: (not o.good, max(o.point.violation, MET), o.point.objective))
    return tuple(
        LocalOptimum(o.point.x, o.point.objective, o.point.violation, o.residual, o.hits)
        for o in valid
    )
