"""Runs SLSQP from several starts in parallel: one model call evaluates a step of all runs.

A model call for many points costs little more than for one point, but NLopt requests single points.
So each run has its own thread, which waits until all runs have requested a point. Every run takes
the same steps as it would alone.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field
from queue import SimpleQueue
from threading import Thread

import numpy as np
import numpy.typing as npt

from ...base.dataclass import dataclass
from .. import kinks, kkt, nlopt_wrapper, repairs
from ..evaluator import Evaluator, LimitReached, Point
from ..kkt import polish
from ..nlopt_wrapper import ARRIVAL
from ..problem import ParametricProblem, Vector
from ..solution import MET, StartRecord, reached_again
from .changed import ChangedProblems
from .steps import (
    RESIDUAL,
    Batch,
    Descent,
    Steps,
    free_hessians,
    run_batch,
    trusted_steps,
    valley_at,
)

FINISH = "active-set Newton"


TRUSTED = "quadratic steps within a trust region"


RESTORATION = "least worst violation by LD_SLSQP"


NEARER = 1e-3
"""A violation is stored as a new least violation only if it is smaller by this share."""


ELSEWHERE = 1.0
"""If a restoration ends with a violation that exceeds the least known violation by this share, a
descent starts from the point where the restoration ended."""


LOCAL_EVALUATIONS = 150
"""Maximum number of evaluations in one local SLSQP run on the default path."""


@dataclass
class SearchResult:
    """A point at which runs ended, with its residual, algorithm, and the number of these runs."""

    point: Point
    residual: float
    algorithm: str
    hits: int = 1

    @property
    def good(self) -> bool:
        """Whether the point is feasible and satisfies the optimality conditions."""
        return self.point.violation <= MET and self.residual <= RESIDUAL


class Descents:
    """State of a search by local runs: the evaluator, the results so far and the warnings."""

    def __init__(self, evaluator: Evaluator, seed: int, *, only_best: bool = False) -> None:
        self.evaluator = evaluator
        self.seed = seed
        self.only_best = only_best
        self.optima: list[SearchResult] = []
        self.records: list[StartRecord] = []
        self.warnings: list[str] = []
        self.least_infeasible: list[Point] = []
        """The infeasible points whose worst violation is least."""
        self.objective_scale = 0.0
        self.interrupted = False

    @property
    def succeeded(self) -> bool:
        """Whether an optimum was reached."""
        return any(optimum.good for optimum in self.optima)

    @property
    def feasible(self) -> bool:
        """Whether a feasible point was reached."""
        return any(optimum.point.violation <= MET for optimum in self.optima)

    @property
    def stuck(self) -> bool:
        """Whether several runs ended at the best objective, without a proven optimum."""
        best = self.best()
        if best is None or self.succeeded:
            return False
        return reached_again(self.records, best.point.objective)

    def residual(self, point: Point) -> float:
        """Residual of the optimality conditions; infinite where the model is undefined."""
        if not point.valid:
            return np.inf
        return kinks.check(self.evaluator, point, objective_scale=self.objective_scale).residual

    def same(self, point: Point) -> SearchResult | None:
        """The known optimum at which a point has arrived, or None."""
        for optimum in self.optima:
            end = optimum.point
            size = max(abs(end.objective), 1e-3 * self.objective_scale, 1e-300)
            similar = abs(point.objective - end.objective) <= 1e-5 * size
            if optimum.good and similar and np.abs(point.z - end.z).max(initial=0.0) <= 1e-3:
                return optimum
        return None

    def descend(
        self, start: Point, algorithm: str, *, linear: bool, max_evaluations: int | None = None
    ) -> bool:
        """Run one local search and refine its result; whether it needs no further search.

        It ended at an optimum or, if only the best counts, above a known optimum.
        """
        evaluations_before = self.evaluator.evaluations
        known_optima = [o for o in self.optima if o.good]
        run = nlopt_wrapper.run(
            self.evaluator,
            start,
            algorithm,
            linear=linear,
            max_evaluations=max_evaluations,
            seed=self.seed,
            optima=[o.point for o in known_optima],
        )
        point, name = run.point, run.algorithm + (" (linear variables)" if linear else "")
        optimum = self.same(point) if point.valid and point.violation <= MET else None
        if run.arrived is not None:
            optimum = known_optima[run.arrived]
        if optimum is not None:
            optimum.hits += 1
            point = optimum.point
        else:
            optimum = self.finish(point, name)
        count = self.evaluator.evaluations - evaluations_before
        self.records.append(
            StartRecord(start.x, optimum.point.objective, optimum.point.violation, name, count)
        )
        return optimum.good or self._beaten(optimum.point)

    def restore(self, point: Point, *, start: Point) -> None:
        """Minimise the worst violation; if that gives a feasible point, descend from it."""
        evaluations_before = self.evaluator.evaluations
        smallest = min((p.violation for p in self.least_infeasible), default=np.inf)
        end = repairs.least_missed(self.evaluator, point, smallest / 2)
        if end.violation <= MET:
            self.descend(end, "LD_SLSQP", linear=False, max_evaluations=LOCAL_EVALUATIONS)
            return
        if end.violation < smallest * (1 - NEARER):
            self.optima.append(SearchResult(end, self.residual(end), RESTORATION))
        self.least_infeasible.append(end)
        if end.violation > smallest * (1 + ELSEWHERE):
            self.descend(end, "LD_SLSQP", linear=False, max_evaluations=LOCAL_EVALUATIONS)
        elif point is start:
            count = self.evaluator.evaluations - evaluations_before
            self.records.append(
                StartRecord(start.x, end.objective, end.violation, RESTORATION, count)
            )

    def finish(self, point: Point, algorithm: str) -> SearchResult:
        """Refine a point by Newton steps, and add it to the optima."""
        polished = polish(self.evaluator, point)
        if not self._beaten(polished):
            polished = kinks.optimum_beside(self.evaluator, polished) or polished
        if polished is not point:
            algorithm = f"{algorithm}, {FINISH}"
        optimum = self.same(polished) if polished.valid else None
        if optimum is not None:
            optimum.hits += 1
            return optimum
        optimum = SearchResult(polished, self.residual(polished), algorithm)
        self.optima.append(optimum)
        return optimum

    def _beaten(self, point: Point) -> bool:
        """Whether a known optimum is as good as a point, if only the best optimum counts."""
        objectives = [optimum.point.objective for optimum in self.optima if optimum.good]
        met = point.violation <= MET
        return self.only_best and met and min(objectives, default=np.inf) <= point.objective

    def complete(self) -> None:
        """Continue from the best feasible point if it is no optimum yet; an optimum replaces it.

        A run that stopped at a known optimum nearby may have left a better point behind. SLSQP
        comes first, then steps within a trust region, with the Hessian at the point.
        """
        best, evaluator = self.best(), self.evaluator
        if best is None or best.good or best.point.violation > MET:
            return
        run = nlopt_wrapper.run(
            evaluator, best.point, "LD_SLSQP", max_evaluations=LOCAL_EVALUATIONS, seed=self.seed
        )
        end = self.finish(run.point, run.algorithm)
        if not end.good and evaluator.exact and not evaluator.problem.equality_names:
            descent = valley_at(evaluator, best.point).trusted()
            solver = trusted_steps(evaluator, descent, best.point.z)
            (point,) = run_batch(
                [solver], lambda asked: [evaluator.point(z) for z in asked.values()]
            )
            if point is not None:
                end = self.finish(point, TRUSTED)
        states = (kkt.state_at(evaluator, x.point) for x in (best, end))
        if end.good and kkt.acceptable(evaluator, *states):
            self.optima = [result for result in self.optima if result is not best]

    def best(self, further: Sequence[SearchResult] = ()) -> SearchResult | None:
        """The best of the optima and of further points: by violation first, then by objective.

        A verified optimum is preferred to another point that is better only by rounding errors.
        """

        def rank(optimum: SearchResult) -> tuple[float, float]:
            point = optimum.point
            if not point.valid:
                return (np.inf, np.inf)
            missed = point.violation if point.violation > MET else 0.0
            return (missed, point.objective)

        candidates = [*self.optima, *further]
        best = min(candidates, key=rank, default=None)
        if best is None or best.good:
            return best
        room = 1e-7 * max(abs(best.point.objective), 1e-300)
        proven = [
            o for o in candidates if o.good and o.point.objective <= best.point.objective + room
        ]
        return min(proven, key=rank, default=best)


ROUNDS = 60
"""Maximum number of points computed in advance per run; a start from the sweep takes 10 to 60."""

FIRST = 14
"""Number of steps after which only the problems without a solution continue."""


@dataclass(frozen=True)
class DescentTask:
    """The runs of one problem: its evaluator, and the starting points with gradients."""

    evaluator: Evaluator
    starts: list[Point]


Rows = Callable[[npt.NDArray[np.complex128], npt.NDArray[np.intp]], npt.NDArray[np.generic]]
"""Computes objective and constraints (rows, k) of points (n, k); the second argument (k,) is the
number of the task to which each point belongs."""


def precompute(
    evaluator: Evaluator, starts: Sequence[Point], *, seed: int, max_evaluations: int
) -> None:
    """Compute, in parallel, the points that SLSQP will visit from the given starts.

    Does nothing if gradients are not exact or evaluations are limited. Stops early at the
    evaluator's time limit, or if the first run ends infeasible, because the search then skips the
    other runs.

    Parameters
    ----------
    evaluator : evaluator of the problem
    starts : evaluated points
    seed, max_evaluations : seed of the runs, and maximum number of evaluations in each run
    """
    if len(starts) < 2 or not evaluator.exact or evaluator.max_evaluations is not None:
        return
    evaluator.take_slopes(starts)
    task = DescentTask(evaluator, list(starts))
    run_together(
        [task],
        lambda batch, _: evaluator.problem.rows(batch),
        seed=seed,
        max_evaluations=max_evaluations,
    )


def run_together(
    tasks: Sequence[DescentTask],
    rows: Rows,
    *,
    seed: int,
    max_evaluations: int,
    tolerance: float = 1e-9,
    rounds: int = ROUNDS,
) -> list[list[Point]]:
    """The best point that each SLSQP run reached: a list for every task, with a point per start.

    The evaluators store every visited point. If the first run of a task is infeasible, the other
    runs of the task stop. All runs stop at the time limit of the first evaluator.

    Parameters
    ----------
    tasks : the problems and starts, with exact gradients
    rows : evaluates points of all tasks in one call
    seed, max_evaluations, tolerance : settings of the runs
    rounds : maximum number of points in a run
    """
    runs: list[SlsqpRun] = []
    for number, task in enumerate(tasks):
        optima: list[Point] = []
        runs += [
            SlsqpRun(number, start, task.evaluator, optima, seed, max_evaluations, tolerance)
            for start in task.starts
        ]
    firsts = {run.task: run for run in reversed(runs)}

    def evaluate(requests: Mapping[int, Vector]) -> list[Point]:
        parts = [runs[k].evaluator.columns(z[:, None]) for k, z in requests.items()]
        sizes = [part.shape[1] for part in parts]
        owners = np.repeat([runs[k].task for k in requests], sizes).astype(np.intp)
        values = rows(np.concatenate(parts, axis=1), owners)
        split = np.split(values, np.cumsum(sizes)[:-1], axis=1)
        return [
            runs[k].enter(*pair)
            for k, pair in zip(requests, zip(requests.values(), split, strict=True), strict=True)
        ]

    solvers = [run.steps() for run in runs]
    try:
        batch = Batch(solvers, evaluate)
        _share(runs, batch, set())
        for _ in range(rounds):
            for k in [k for k in batch.requests if firsts[runs[k].task].hopeless]:
                batch.drop(k)
            if not batch.requests or tasks[0].evaluator.late:
                break
            finished = set(batch.results)
            batch.step()
            _share(runs, batch, finished)
    finally:
        for solver in solvers:
            solver.close()
    return [[run.best for run in runs if run.task == k] for k in range(len(tasks))]


def _share(runs: Sequence[SlsqpRun], batch: Batch[None], finished: set[int]) -> None:
    """Tell the other runs of a task about new optima, so that a run that reaches one stops."""
    for number in sorted(set(batch.results) - finished):
        if runs[number].new:
            runs[number].known.append(runs[number].best)


@dataclass
class SlsqpRun:
    """One run of SLSQP in its thread.

    Parameters
    ----------
    task : number of its task
    start : first point
    evaluator : evaluator of the task, which stores the visited points
    known : known optima of the task; a run that reaches one stops
    seed, most, tolerance : seed, maximum evaluations and tolerance of the run
    """

    task: int
    start: Point
    evaluator: Evaluator
    known: list[Point]
    seed: int
    most: int
    tolerance: float
    hopeless: bool = False
    """Whether the run ended at an infeasible point."""
    new: bool = False
    """Whether the run ended at a new feasible point."""
    best: Point = field(init=False)

    def __post_init__(self) -> None:
        self.best = self.start
        self._requests: SimpleQueue[Vector | None] = SimpleQueue()
        self._replies: SimpleQueue[Point | None] = SimpleQueue()
        self._evaluator = _QueuedEvaluator(
            self.evaluator, self.start, self._requests, self._replies
        )

    def steps(self) -> Steps[None]:
        """The run as a solver for `Batch`; if closed early, it keeps its best point so far."""
        thread = Thread(target=self._run, daemon=True)
        thread.start()
        try:
            while (z := self._requests.get()) is not None:
                self._replies.put((yield z))
        finally:
            self._replies.put(None)
            thread.join()

    def enter(self, z: Vector, rows: npt.NDArray[np.generic]) -> Point:
        """Store the computed rows of the point z (nf,) in the evaluator; return the point."""
        self.evaluator.precomputed[z.tobytes()] = rows
        return self._evaluator.enter(z, rows)

    def _run(self) -> None:
        try:
            run = nlopt_wrapper.run(
                self._evaluator, self.start, "LD_SLSQP", max_evaluations=self.most, seed=self.seed,
                optima=self.known, tolerance=self.tolerance,
            )  # fmt: skip
            self.best = run.point
            self.hopeless = run.point.violation > MET
            self.new = not self.hopeless and run.arrived is None
        finally:
            self._requests.put(None)


class _QueuedEvaluator(Evaluator):
    """An evaluator whose points are computed together with those of all other runs."""

    def __init__(
        self,
        evaluator: Evaluator,
        start: Point,
        requests: SimpleQueue[Vector | None],
        replies: SimpleQueue[Point | None],
    ) -> None:
        super().__init__(evaluator.problem)
        self.adopt_check(evaluator)
        self._requests, self._replies = requests, replies
        self._cache[start.z.tobytes()] = start

    def point(self, z: Vector) -> Point:
        """The evaluated point at z (nf,); waits until all runs have requested a point."""
        cached = self._cache.get(z.tobytes())
        if cached is not None:
            return cached
        self._requests.put(z)
        point = self._replies.get()
        if point is None:
            raise LimitReached
        return point


def descents_from(
    parametric: ParametricProblem,
    evaluators: Sequence[Evaluator],
    parameters: Vector,
    starts: Sequence[Sequence[Vector]],
    seed: int,
    *,
    tolerance: float = 1e-9,
    rounds: int = ROUNDS,
) -> list[list[Point]]:
    """The points at which SLSQP runs end, for each problem and start.

    Parameters
    ----------
    parametric : the problems
    evaluators : one evaluator per problem, with exact gradients
    parameters : parameter values of each problem (q, k)
    starts : starting coordinates (nf,) for each problem
    seed, tolerance, rounds : settings of the runs, see `run_together`
    """

    def rows(
        batch: npt.NDArray[np.complex128], owners: npt.NDArray[np.intp]
    ) -> npt.NDArray[np.generic]:
        return parametric.with_columns(parameters[:, owners]).rows(batch)

    if not any(starts):
        return [[] for _ in evaluators]
    run_starts = [(k, z) for k, points in enumerate(starts) for z in points]
    parts = [evaluators[k].columns(z[:, None]) for k, z in run_starts]
    owners = np.repeat([k for k, _ in run_starts], parts[0].shape[1]).astype(np.intp)
    values = np.split(rows(np.concatenate(parts, axis=1), owners), len(parts), axis=1)
    tasks = [DescentTask(evaluator, []) for evaluator in evaluators]
    for (k, z), part in zip(run_starts, values, strict=True):
        point = evaluators[k].enter(z, part)
        if point.valid:
            tasks[k].starts.append(point)
    return run_together(
        tasks,
        rows,
        seed=seed,
        max_evaluations=LOCAL_EVALUATIONS,
        tolerance=tolerance,
        rounds=rounds,
    )


def converged_from(
    parametric: ParametricProblem,
    evaluators: Sequence[Evaluator],
    parameters: Vector,
    starts: Sequence[Sequence[Point]],
) -> list[list[Point | None]]:
    """The optimum that quadratic steps reach from each point; None if they reach none.

    The first step uses the Hessian at the point.

    Parameters
    ----------
    parametric, evaluators, parameters : see `descents_from`
    starts : points of each problem with their gradients
    """
    descents: list[Descent] = []
    for evaluator, points in zip(evaluators, starts, strict=True):
        initial = [_descent(evaluator, point, np.eye(evaluator.space.size)) for point in points]
        for descent, point in zip(initial, points, strict=True):
            descent.advance(evaluator, point)
        hessians = free_hessians(evaluator, initial)
        descents += [_descent(evaluator, *pair) for pair in zip(points, hessians, strict=True)]
    if not descents:
        return [[] for _ in starts]
    owners = np.repeat(np.arange(len(starts)), [len(points) for points in starts])
    changed = ChangedProblems(parametric, evaluators[0], parameters[:, owners])
    z = np.stack([point.z for points in starts for point in points], axis=1)
    optima = changed.descend(descents, z, FIRST)
    solved = {owner for owner, point in zip(owners, optima, strict=True) if point is not None}
    unsolved = [
        k for k, owner in enumerate(owners) if owner not in solved and descents[k].point is not None
    ]
    if unsolved:
        z = np.stack([descents[k].current.z + descents[k].step for k in unsolved], axis=1)
        continued = changed.subset(unsolved).descend([descents[k] for k in unsolved], z)
        for k, optimum in zip(unsolved, continued, strict=True):
            optima[k] = optimum
    iterator = iter(optima)
    return [[next(iterator) for _ in points] for points in starts]


def _descent(evaluator: Evaluator, point: Point, hessian: Vector) -> Descent:
    """A descent that begins at a point with a given Hessian."""
    scale = kkt.slope_scale(evaluator, point)
    return Descent(hessian, scale, evaluator.constraint_count, 1.0)


def distinct_ends(points: Sequence[Point]) -> list[Point]:
    """Distinct points at which runs ended, the best first."""
    distinct: list[Point] = []
    for point in sorted(points, key=lambda p: (p.violation > ARRIVAL[2], p.objective)):
        if not any(_near(point, known) for known in distinct):
            distinct.append(point)
    return distinct


def _near(point: Point, known: Point) -> bool:
    """Whether a point is so close to a known point that both count as the same."""
    distance, share, _ = ARRIVAL
    similar = abs(point.objective - known.objective) <= share * abs(known.objective)
    return similar and bool(np.abs(point.z - known.z).max(initial=0.0) <= distance)
