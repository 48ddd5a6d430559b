"""Re-solve many problems near a solved one, with ever more robust methods.

1. Full steps from the predicted optima, all problems together.
2. For the rest, a restoration and a descent. Other known local optima are followed too, and the
   optimum of each problem is a start for all others, as a small change may favour another valley.
3. For what is left, Newton's method and SLSQP from the points at hand, then a search with a sweep.

Only the last step may end without a design.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from .. import kkt, repairs
from ..actuator import Solution
from ..evaluator import Evaluator, Point
from ..kkt import polish
from ..problem import BoxProblem, ParametricProblem, Vector
from ..solver import solve
from . import steps
from .changed import ChangedProblems, applicable
from .steps import Valley

FEASIBLE = 1e-6
"""Worst missed margin that still counts as met."""

RESIDUAL = 1e-6
"""Residual of the optimality conditions that a re-solved optimum must reach."""

BETTER = 1e-8
"""Relative improvement of the objective that indicates another valley."""

ROUNDS = 3
"""Maximum exchanges of optima; each follows only if the last exchange improved."""

BEYOND = 1.0
"""Start of descents beyond another valley, as a share of the distance from the best: the
ridge between the two often moves as fast as they do."""

SAMPLES = 1024
"""Points of the sweep for a feasible problem whose optimum was not reached."""


@dataclass(frozen=True)
class SolvedProblem:
    """A problem with its optimum.

    Parameters
    ----------
    parametric : the problem with its parameters
    evaluator : its evaluator, with checked gradients
    valleys : its local optima, the best first
    """

    parametric: ParametricProblem
    evaluator: Evaluator
    valleys: Sequence[Valley]


@dataclass(frozen=True)
class ResolveTask:
    """A problem to solve near a solved one.

    Parameters
    ----------
    problem : the changed problem
    guess : predicted optimum, in coordinates of the solved problem (nf,)
    parameters : values of the parameters (q,) that make the problem; None where its bounds differ
    """

    problem: BoxProblem
    guess: Vector
    parameters: Vector | None = None


def resolve(solved: SolvedProblem, tasks: Sequence[ResolveTask]) -> list[Point | None]:
    """The optimum of every task; None without a feasible point.

    If no optimum is reached, the best feasible point.
    """
    optima: list[Point | None] = [None] * len(tasks)
    inside: list[Vector | None] = [None] * len(tasks)
    alone = list(range(len(tasks)))
    together = [k for k, task in enumerate(tasks) if task.parameters is not None]
    if together and applicable(solved.parametric, solved.evaluator):
        starts = np.stack([tasks[k].guess for k in together], axis=1)
        columns = [p for k in together if (p := tasks[k].parameters) is not None]
        changed = ChangedProblems(solved.parametric, solved.evaluator, np.stack(columns, axis=1))
        found = resolve_batch(changed, solved.valleys, starts)
        for k, optimum, feasible in zip(together, *found, strict=True):
            optima[k], inside[k] = optimum, feasible
        lost = [k for k in together if optima[k] is None and inside[k] is None]
        alone = [k for k in alone if optima[k] is None and k not in lost]
    for k in alone:
        task = tasks[k]
        optima[k] = search_near(
            task.problem, solved.evaluator, task.guess, solved.valleys[0].point, inside=inside[k]
        )
    return optima


def resolve_batch(
    changed: ChangedProblems, valleys: Sequence[Valley], starts: Vector
) -> tuple[list[Point | None], list[Vector | None]]:
    """The optimum of each changed problem, and a feasible point; None where not reached.

    Parameters
    ----------
    changed : the problems
    valleys : local optima of the solved problem, the best first
    starts : predicted optima (nf, K) in the first valley; others are entered from beyond
    """
    first, space = valleys[0], changed.evaluator.space
    point = first.point
    optima = changed.near_optimum(first, starts)
    left = [i for i, one in enumerate(optima) if one is None]
    restored = changed.chosen(left).restore(point.z)
    ends = _Ends(changed, optima, [None] * len(optima))
    ends.descend(first, dict(zip(left, restored, strict=True)))
    for valley in valleys[1:]:
        there = valley.point.z
        begin = np.clip(there + BEYOND * (there - point.z), space.lower, space.upper)
        ends.descend(valley, dict(enumerate(changed.restore(begin))))
    single = len(optima) == 1 and len(valleys) == 1  # nothing to exchange
    for _ in range(0 if single else ROUNDS):
        better = ends.elsewhere([valley.point for valley in valleys])
        if not better:
            break
        ends.descend(first, better)
    return ends.settled()


@dataclass
class _Ends:
    """The best optimum of each changed problem, and the best feasible design."""

    changed: ChangedProblems
    optima: list[Point | None]
    known: list[Point | None]
    feasible: dict[int, Vector] = field(default_factory=dict)

    def descend(self, valley: Valley, starts: Mapping[int, Vector | None]) -> None:
        """Descend from a start of each of these problems, and keep improvements."""
        begun = {i: z for i, z in starts.items() if z is not None}
        chosen = list(begun)
        if not chosen:
            return
        self.feasible = begun | self.feasible
        z = np.stack(list(begun.values()), axis=1)
        reached, stopped = self.changed.chosen(chosen).descend_from(valley, z)
        for i, optimum, stop in zip(chosen, reached, stopped, strict=True):
            self.optima[i] = _better(self.optima[i], optimum)
            self.known[i] = _better(self.known[i], stop)

    def elsewhere(self, valleys: Sequence[Point]) -> dict[int, Vector]:
        """For each problem the best design of the others, if better than its own."""
        points = [*valleys, *(one for one in self.optima if one is not None)]
        rows = self.changed.margins_at(points)
        missed = self.changed.evaluator.violations(rows.reshape(len(rows), -1), "worst")
        missed = missed.reshape(rows.shape[1:])
        objectives = np.where(missed <= steps.FEASIBLE, rows[0], np.inf)
        best = np.argmin(objectives, axis=0)
        better = {}
        for i, one in enumerate(self.optima):
            least = float(objectives[best[i], i])
            if least < _beaten(one):
                better[i] = points[int(best[i])].z
        return better

    def settled(self) -> tuple[list[Point | None], list[Vector | None]]:
        """The optima, None where a better design is known; and those designs."""
        inside: list[Vector | None] = [None] * len(self.optima)
        for i, at in enumerate(self.known):
            if at is not None and at.objective < _beaten(self.optima[i]):
                self.optima[i], inside[i] = None, at.z
            elif self.optima[i] is None:
                inside[i] = self.feasible.get(i)
        return self.optima, inside


def _beaten(point: Point | None) -> float:
    """Objective below which another design is clearly better."""
    return np.inf if point is None else point.objective - BETTER * abs(point.objective)


def _better(point: Point | None, other: Point | None) -> Point | None:
    if point is None or other is None:
        return point or other
    return other if other.objective < point.objective else point


def other_optima(evaluator: Evaluator, solution: Solution) -> list[Point]:
    """Local optima of the search other than the best."""
    good = [
        one.x
        for one in solution.optima
        if one.violation <= FEASIBLE
        and one.residual <= RESIDUAL
        and not np.array_equal(one.x, solution.x)
    ]
    return [evaluator.point(evaluator.space.to_z(x)) for x in good]


def point_of(evaluator: Evaluator, solution: Solution) -> Point:
    """The end point of a search."""
    rows = np.concatenate([[solution.objective], solution.constraints, solution.equalities])
    return Point(evaluator.space.to_z(solution.x), solution.x, rows, True, solution.violation)


def search_near(
    problem: BoxProblem,
    evaluator: Evaluator,
    guess: Vector,
    point: Point,
    *,
    inside: Vector | None = None,
) -> Point | None:
    """The best point of a slightly changed problem, solved alone; None if infeasible.

    Newton steps first; if the active set changes too much, a search from the points at hand.

    Parameters
    ----------
    problem : the changed problem
    evaluator, point : of the unchanged problem, and its optimum
    guess : predicted optimum (nf,)
    inside : coordinates of a known feasible point; if missing, and none lies near the unchanged
        optimum, the problem counts as infeasible
    """
    near = Evaluator(problem)
    if near.space.size != len(guess):  # the changed bound fixes a variable
        guess = near.space.to_z(near.space.to_x(near.space.lower[:, None])[:, 0])
    near.complex_works = evaluator.complex_works
    near.difference_rows = evaluator.difference_rows
    here = near.point(near.space.to_z(np.clip(point.x, problem.lower, problem.upper)))
    start = near.point(np.clip(guess, near.space.lower, near.space.upper))
    tried = [p for p in (start, here) if p.valid]
    if inside is None:
        for one in tried:
            found = polish(near, one, iterations=8, tolerance=1e-10)
            uphill = _met(here) and here.objective < found.objective
            if _optimal(near, found) and not uphill:
                return found
        restored = repairs.feasible_point(near, tried[0]) if tried else None
        if restored is None:
            return None
        inside = restored.z
    first = near.point(inside)
    found = polish(near, first, iterations=8, tolerance=1e-10)
    if _optimal(near, found) and found.objective <= first.objective:
        return found
    more = [p.x for p in (first, *tried)]
    for samples in (0, SAMPLES):
        best = solve(problem, starts=len(more), samples=samples, more_starts=more)
        if best.feasible and best.kkt is not None and best.kkt.residual <= RESIDUAL:
            return point_of(near, best)
    if best.feasible and best.objective < first.objective:
        return point_of(near, best)
    return first


def _met(point: Point) -> bool:
    return point.valid and point.violation <= FEASIBLE


def _optimal(near: Evaluator, point: Point) -> bool:
    return _met(point) and kkt.check(near, point).residual <= RESIDUAL
