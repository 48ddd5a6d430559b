"""Re-solves many problems near a solved problem, by increasingly robust methods.

1. Full steps from the predicted optima, all problems together.
2. Where they fail, a restoration finds a feasible point, and a descent starts there. Descents also
   start in the other known valleys (local optima), and the optimum of each problem is a start for
   all others, because a small change may favour another valley.
3. Where both fail, Newton's method and SLSQP from the known points, then a search with a sweep.

A problem counts as unsolvable only after the last method has failed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field

import numpy as np

from ...base.dataclass import dataclass
from .. import kinks, kkt, repairs
from ..evaluator import Evaluator, Point
from ..kkt import polish
from ..problem import BoxProblem, ParametricProblem, Vector
from ..solution import BETTER, MET, Solution, reached_again
from ..solver import solve
from . import steps
from .changed import ChangedProblems, applicable
from .steps import Valley

ROUNDS = 3
"""Maximum number of rounds in which problems exchange optima; fewer if a round improves none."""

BEYOND = 1.0
"""A descent towards another local optimum starts beyond it, as seen from the best optimum.

The start lies on the straight line through both optima, beyond the other optimum by this share of
the distance between them. The ridge that separates them often moves as fast as they do, so a start
on the other optimum itself could be on the wrong side of the ridge."""

BETWEEN = np.arange(1, 8) / 8
"""Designs tried between two equally good optima, as shares of the distance (our choice)."""

SAMPLES = 1024
"""Number of points of the sweep for a feasible problem whose optimum is not yet known."""


@dataclass(frozen=True)
class SolvedProblem:
    """A problem with its optimum.

    Parameters
    ----------
    parametric : the problem with its parameters
    evaluator : evaluator of the problem, with checked gradients
    valleys : local optima of the problem, the best first
    """

    parametric: ParametricProblem
    evaluator: Evaluator
    valleys: Sequence[Valley]


@dataclass(frozen=True)
class ResolveTask:
    """A changed problem, to be solved from the optimum of a solved problem.

    Parameters
    ----------
    problem : the changed problem
    guess : predicted optimum (nf,), in coordinates of the solved problem
    parameters : values of the parameters (q,) in the changed problem; None if the change is not one
        of parameters, for example of bounds
    """

    problem: BoxProblem
    guess: Vector
    parameters: Vector | None = None


def resolve(solved: SolvedProblem, tasks: Sequence[ResolveTask]) -> list[Point | None]:
    """The optimum of every task, or else its best feasible point; None if there is none."""
    optima: list[Point | None] = [None] * len(tasks)
    feasible_z: list[Vector | None] = [None] * len(tasks)
    single = list(range(len(tasks)))
    batched = [k for k, task in enumerate(tasks) if task.parameters is not None]
    if batched and applicable(solved.parametric, solved.evaluator):
        starts = np.stack([tasks[k].guess for k in batched], axis=1)
        columns = [p for k in batched if (p := tasks[k].parameters) is not None]
        changed = ChangedProblems(solved.parametric, solved.evaluator, np.stack(columns, axis=1))
        results = resolve_batch(changed, solved.valleys, starts)
        for k, optimum, feasible in zip(batched, *results, strict=True):
            optima[k], feasible_z[k] = optimum, feasible
        unreached = [k for k in batched if optima[k] is None and feasible_z[k] is None]
        single = [k for k in single if optima[k] is None and k not in unreached]
    for k in single:
        task = tasks[k]
        optima[k] = search_near(
            task.problem,
            solved.evaluator,
            task.guess,
            solved.valleys[0].point,
            feasible_z=feasible_z[k],
        )
    return optima


def resolve_batch(
    changed: ChangedProblems, valleys: Sequence[Valley], starts: Vector
) -> tuple[list[Point | None], list[Vector | None]]:
    """The optimum and a feasible point of each changed problem; None where none is reached.

    Parameters
    ----------
    changed : the problems
    valleys : local optima of the solved problem, the best first
    starts : predicted optima (nf, K) in the first valley
    """
    best_valley, space = valleys[0], changed.evaluator.space
    point = best_valley.point
    optima = changed.near_optimum(best_valley, starts)
    missing = [i for i, optimum in enumerate(optima) if optimum is None]
    restored = changed.subset(missing).restore(point.z)
    ends = _Ends(changed, optima, [None] * len(optima))
    ends.descend(best_valley, dict(zip(missing, restored, strict=True)))
    for valley in valleys[1:]:
        z = valley.point.z
        start = np.clip(z + BEYOND * (z - point.z), space.lower, space.upper)
        numbers = ends.in_reach_of(valley)
        restored = changed.subset(numbers).restore(start)
        ends.descend(valley, dict(zip(numbers, restored, strict=True)))
    single = len(optima) == 1 and len(valleys) == 1  # there are no other optima to exchange
    for _ in range(0 if single else ROUNDS):
        improved = ends.better_designs([valley.point for valley in valleys])
        if not improved:
            break
        ends.descend(best_valley, improved)
    return ends.results()


@dataclass
class _Ends:
    """The best optimum and the best feasible design reached so far for each changed problem."""

    changed: ChangedProblems
    optima: list[Point | None]
    best_feasible: list[Point | None]
    feasible: dict[int, Vector] = field(default_factory=dict)
    compared: list[Point] = field(default_factory=list)

    def descend(self, valley: Valley, starts: Mapping[int, Vector | None]) -> None:
        """Run a descent for each problem that has a start, and store the improved results."""
        feasible_starts = {i: z for i, z in starts.items() if z is not None}
        numbers = list(feasible_starts)
        if not numbers:
            return
        self.feasible = feasible_starts | self.feasible
        z = np.stack(list(feasible_starts.values()), axis=1)
        optima, stopped = self.changed.subset(numbers).descend_from(valley, z)
        for i, optimum, stop in zip(numbers, optima, stopped, strict=True):
            self.optima[i] = _better(self.optima[i], optimum)
            self.best_feasible[i] = _better(self.best_feasible[i], stop)

    def in_reach_of(self, valley: Valley) -> list[int]:
        """Numbers of the problems whose optimum in a valley may be better than that reached so far.

        The Lagrangian at the valley's optimum, with the multipliers there, estimates the optimum in
        this valley. It is a lower bound, to second order of the change, where objective and limits
        are convex (weak duality, [NocedalWright2006] section 12.9). On a kink, the multipliers of
        one side give none: then all problems count.
        """
        evaluator = self.changed.evaluator
        smooth = kkt.check(evaluator, valley.point).residual <= steps.RESIDUAL
        if valley.prices is None or not smooth:
            return list(range(len(self.optima)))
        rows = self.changed.margins_at([valley.point])[:, 0]
        multipliers = valley.scale * valley.prices[: valley.rows]
        estimates = rows[0] - multipliers @ rows[1 : 1 + valley.rows]
        numbers = zip(estimates, self.optima, strict=True)
        return [i for i, (estimate, best) in enumerate(numbers) if not estimate >= _beaten(best)]

    def better_designs(self, valleys: Sequence[Point]) -> dict[int, Vector]:
        """For each problem that optima of other problems improve, the best of these optima.

        Optima that were compared before are left out: no problem has become worse since.
        """
        reached = [*valleys, *(optimum for optimum in self.optima if optimum is not None)]
        points = [point for point in reached if not any(point is x for x in self.compared)]
        self.compared += points
        if not points:
            return {}
        rows = self.changed.margins_at(points)
        missed = self.changed.evaluator.violations(rows.reshape(len(rows), -1), "worst")
        missed = missed.reshape(rows.shape[1:])
        objectives = np.where(missed <= steps.FEASIBLE, rows[0], np.inf)
        best_points = np.argmin(objectives, axis=0)
        improvements = {}
        for i, optimum in enumerate(self.optima):
            objective = float(objectives[best_points[i], i])
            if objective < _beaten(optimum):
                improvements[i] = points[int(best_points[i])].z
        return improvements

    def results(self) -> tuple[list[Point | None], list[Vector | None]]:
        """The optima and feasible points; an optimum is left out if a feasible point is better."""
        feasible_z: list[Vector | None] = [None] * len(self.optima)
        for i, point in enumerate(self.best_feasible):
            if point is not None and point.objective < _beaten(self.optima[i]):
                self.optima[i], feasible_z[i] = None, point.z
            elif self.optima[i] is None:
                feasible_z[i] = self.feasible.get(i)
        return self.optima, feasible_z


def _beaten(point: Point | None) -> float:
    """Objective below which a design is clearly better than this point."""
    return np.inf if point is None else point.objective - BETTER * abs(point.objective)


def _better(point: Point | None, other: Point | None) -> Point | None:
    if point is None or other is None:
        return point or other
    return other if other.objective < point.objective else point


def other_optima(evaluator: Evaluator, solution: Solution) -> list[Point]:
    """The local optima that a search reached, each of another valley, without the best of them.

    Where a variable does not matter, equally good optima lie side by side in one valley: they are
    joined by a straight line of designs that are as good. Only one of them counts.
    """
    points = [
        optimum.x
        for optimum in solution.optima
        if optimum.violation <= MET
        and optimum.residual <= steps.RESIDUAL
        and not np.array_equal(optimum.x, solution.x)
    ]
    others: list[Point] = []
    valleys = [point_of(evaluator, solution)]
    for x in points:
        point = evaluator.point(evaluator.space.to_z(x))
        if not any(_joined(evaluator, point, valley) for valley in valleys):
            valleys.append(point)
            others.append(point)
    return others


def _joined(evaluator: Evaluator, first: Point, second: Point) -> bool:
    """Whether all designs tried between two equally good ones meet the limits and are as good."""
    room = BETTER * abs(first.objective)
    if abs(first.objective - second.objective) > room:
        return False
    z = first.z[:, None] + np.multiply.outer(second.z - first.z, BETWEEN)
    rows = evaluator.batch(z)
    met = evaluator.violations(rows, "worst") <= MET
    return bool((met & (np.abs(rows[0] - first.objective) <= room)).all())


def point_of(evaluator: Evaluator, solution: Solution) -> Point:
    """The point at which a search ended."""
    rows = np.concatenate([[solution.objective], solution.constraints, solution.equalities])
    return Point(evaluator.space.to_z(solution.x), solution.x, rows, True, solution.violation)


def search_near(
    problem: BoxProblem,
    evaluator: Evaluator,
    guess: Vector,
    point: Point,
    *,
    feasible_z: Vector | None = None,
) -> Point | None:
    """Solve one slightly changed problem; None if it is infeasible.

    Newton steps are tried first. If the active limits change too much for them, a search follows
    from the known points.

    Parameters
    ----------
    problem : the changed problem
    evaluator, point : evaluator and optimum of the unchanged problem
    guess : predicted optimum (nf,)
    feasible_z : coordinates of a known feasible point. Without it, the problem counts as infeasible
        if the search near the unchanged optimum finds none
    """
    changed = Evaluator(problem)
    if changed.space.size != len(guess):  # the changed bound fixes a variable
        guess = changed.space.to_z(changed.space.to_x(changed.space.lower[:, None])[:, 0])
    changed.adopt_check(evaluator)
    unmoved = changed.point(changed.space.to_z(np.clip(point.x, problem.lower, problem.upper)))
    start = changed.point(np.clip(guess, changed.space.lower, changed.space.upper))
    starts = [p for p in (start, unmoved) if p.valid]
    if feasible_z is None:
        for trial in starts:
            polished = polish(changed, trial, iterations=8, tolerance=1e-10)
            uphill = steps.is_met(unmoved) and unmoved.objective < polished.objective
            if _optimal(changed, polished) and not uphill:
                return polished
        restored = repairs.feasible_point(changed, starts[0]) if starts else None
        if restored is None:
            return None
        feasible_z = restored.z
    feasible = changed.point(feasible_z)
    optimum = optimum_near(changed, feasible, near=False)
    if optimum is not None:
        return optimum
    further = [p.x for p in (feasible, *starts)]
    for samples in (0, SAMPLES):
        solution = solve(
            problem, starts=len(further), samples=samples, more_starts=further, only_best=True
        )
        if (
            solution.feasible
            and solution.kkt is not None
            and solution.kkt.residual <= steps.RESIDUAL
        ):
            return point_of(changed, solution)
        if reached_again(solution.starts, solution.objective):
            break
    if solution.feasible and solution.objective < feasible.objective:
        return point_of(changed, solution)
    return feasible


def optimum_near(evaluator: Evaluator, feasible: Point, *, near: bool = True) -> Point | None:
    """The optimum that Newton steps from a feasible point reach, perhaps on a kink; None if none.

    It is at least as good as the feasible point. `near` is that of `kinks.optimum_beside`.
    """
    polished = polish(evaluator, feasible, iterations=8, tolerance=1e-10)
    end = kinks.optimum_beside(evaluator, polished, near=near) or polished
    return end if _optimal(evaluator, end) and _lower(end, feasible) else None


def _lower(point: Point, other: Point) -> bool:
    """Whether a point's objective is not above another's, except by rounding."""
    return point.objective <= other.objective + BETTER * abs(other.objective)


def _optimal(evaluator: Evaluator, point: Point) -> bool:
    return steps.is_met(point) and kinks.check(evaluator, point).residual <= steps.RESIDUAL
