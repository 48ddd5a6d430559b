"""Re-optimise a problem at changed parameters, every end of a price table together.

Most ends follow from the predicted optimum in a few common steps. Every other local optimum known
is followed too, and what is found at one end stands as a start at every other: a change of 10 % may
make another valley the best. Only what is left is searched for like any optimum.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from . import elastic, kkt, lockstep
from .evaluator import Evaluator, Point
from .newton import polish
from .parameters import Responses, perturbed
from .problem import ParametricProblem, Problem, Vector
from .solver import solve

FEASIBLE = 1e-6
"""Worst missed margin that still counts as met."""

RESIDUAL = 1e-6
"""Residual of the optimality conditions that a re-solved optimum must reach."""

BETTER = 1e-8
"""Share of the objective by which another design must be better to be another valley."""

ROUNDS = 3
"""Most exchanges of what the ends found; each goes on only where the last one gained."""

BEYOND = 1.0
"""How far past another valley its descents start, as a share of the way there from the best: what
lies between the two often moves as fast as they do."""

SAMPLES = 1024
"""Points of the sweep where a feasible end has no optimum in reach."""


def ends(
    parametric: ParametricProblem,
    evaluator: Evaluator,
    point: Point,
    given: Responses,
    moves: Vector,
    change: float,
    known: Sequence[Vector] = (),
) -> list[tuple[float | None, float | None]]:
    """Re-optimised objectives at +change and -change of every parameter; None where infeasible.

    Parameters
    ----------
    parametric : the problem with its parameters
    evaluator, point : of the unchanged optimum
    given : the parameters, bounds of variables included
    moves : derivative of the optimum by them (nf, q)
    change : relative; 0 re-solves nothing
    known : other local optima (n,)
    """
    values, count = given.values.tolist(), len(parametric.parameters)
    if change == 0:
        return [(None, None)] * len(values)
    steps = {
        (k, sign): sign * change * value
        for k, value in enumerate(values)
        for sign in (1, -1)
        if value != 0 and given.matters(k)
    }
    answers: dict[tuple[int, int], float | None] = {}
    inside: dict[tuple[int, int], Vector | None] = {}
    alone = set(steps)
    batch = [pair for pair in steps if pair[0] < count]
    if batch and lockstep.applicable(parametric, evaluator):
        columns = np.repeat(parametric.parameters[:, None], len(batch), axis=1)
        starts = np.repeat(point.z[:, None], len(batch), axis=1)
        for column, (k, sign) in enumerate(batch):
            columns[k, column] += steps[k, sign]
            starts[:, column] += moves[:, k] * steps[k, sign]
        others = [evaluator.point(evaluator.space.to_z(x)) for x in known]
        found, feasible = _together(parametric, evaluator, [point, *others], starts, columns)
        for pair, one, z in zip(batch, found, feasible, strict=True):
            answers[pair], inside[pair] = None if one is None else one.objective, z
            if one is not None or z is None:
                alone.discard(pair)
    for k, sign in sorted(alone):
        step = steps[k, sign]
        problem = perturbed(parametric, given.names[k], k, values[k] + step)
        answers[k, sign] = None
        if problem is not None:
            guess, near = point.z + moves[:, k] * step, inside.get((k, sign))
            answers[k, sign] = resolved(problem, evaluator, guess, point, inside=near)
    here = point.objective
    return [(answers.get((k, 1), here), answers.get((k, -1), here)) for k in range(len(values))]


def _together(
    parametric: ParametricProblem,
    evaluator: Evaluator,
    valleys: list[Point],
    starts: Vector,
    parameters: Vector,
) -> tuple[list[Point | None], list[Vector | None]]:
    """The optimum of each changed problem, and a feasible point; None where none is in reach.

    `starts` (nf, K) are those of the first valley; the others are entered from beyond.
    """
    point, space = valleys[0], evaluator.space
    found = lockstep.resolve_together(parametric, evaluator, point, starts, parameters)
    left = [i for i, one in enumerate(found) if one is None]
    restored = lockstep.restore_together(parametric, evaluator, point.z, parameters[:, left])
    state = _Ends(parametric, evaluator, parameters, found, [None] * len(found))
    state.descend(point, dict(zip(left, restored, strict=True)))
    for valley in valleys[1:]:
        begin = np.clip(valley.z + BEYOND * (valley.z - point.z), space.lower, space.upper)
        restored = lockstep.restore_together(parametric, evaluator, begin, parameters)
        state.descend(valley, dict(enumerate(restored)))
    for _ in range(ROUNDS):
        better = state.elsewhere(valleys)
        if not better:
            break
        state.descend(point, better)
    return state.settled()


@dataclass
class _Ends:
    """The best optimum found for each changed problem, and the best feasible design."""

    parametric: ParametricProblem
    evaluator: Evaluator
    parameters: Vector
    found: list[Point | None]
    known: list[Point | None]
    feasible: dict[int, Vector] = field(default_factory=dict)

    def descend(self, valley: Point, starts: Mapping[int, Vector | None]) -> None:
        """Descend from a start of each of these ends, and keep what is better."""
        begun = {i: z for i, z in starts.items() if z is not None}
        chosen = list(begun)
        if not chosen:
            return
        self.feasible = begun | self.feasible
        z, parameters = np.stack(list(begun.values()), axis=1), self.parameters[:, chosen]
        reached, stopped = lockstep.descend_together(
            self.parametric, self.evaluator, valley, z, parameters
        )
        for i, optimum, stop in zip(chosen, reached, stopped, strict=True):
            self.found[i] = _better(self.found[i], optimum)
            self.known[i] = _better(self.known[i], stop)

    def elsewhere(self, valleys: list[Point]) -> dict[int, Vector]:
        """For each end the best of the other ends' designs, where it is better than its own."""
        points = [*valleys, *(one for one in self.found if one is not None)]
        rows = lockstep.standing(self.parametric, points, self.parameters)
        missed = self.evaluator.violations(rows.reshape(len(rows), -1), "worst")
        missed = missed.reshape(rows.shape[1:])
        objectives = np.where(missed <= lockstep.FEASIBLE, rows[0], np.inf)
        best = np.argmin(objectives, axis=0)
        better = {}
        for i, one in enumerate(self.found):
            least = float(objectives[best[i], i])
            if least < _beaten(one):
                better[i] = points[int(best[i])].z
        return better

    def settled(self) -> tuple[list[Point | None], list[Vector | None]]:
        """The optima, None where a better design is known than the optimum; and those designs."""
        inside: list[Vector | None] = [None] * len(self.found)
        for i, at in enumerate(self.known):
            if at is not None and at.objective < _beaten(self.found[i]):
                self.found[i], inside[i] = None, at.z
            elif self.found[i] is None:
                inside[i] = self.feasible.get(i)
        return self.found, inside


def _beaten(one: Point | None) -> float:
    """Objective below which another design is really better."""
    return np.inf if one is None else one.objective - BETTER * abs(one.objective)


def _better(one: Point | None, other: Point | None) -> Point | None:
    if one is None or other is None:
        return one or other
    return other if other.objective < one.objective else one


def resolved(
    problem: Problem,
    evaluator: Evaluator,
    guess: Vector,
    point: Point,
    *,
    inside: Vector | None = None,
) -> float | None:
    """Objective of a slightly changed problem, from the predicted optimum; None if infeasible.

    Newton first; where the active set changes too much for it, a search from the points at hand.
    `inside` is a feasible point already known; without it and without a feasible point near the
    unchanged optimum there is taken to be none.
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
                return found.objective
        restored = elastic.feasible_point(near, tried[0]) if tried else None
        if restored is None:
            return None
        inside = restored.z
    first = near.point(inside)
    found = polish(near, first, iterations=8, tolerance=1e-10)
    if _optimal(near, found) and found.objective <= first.objective:
        return found.objective
    more = [p.x for p in (first, *tried)]
    for samples in (0, SAMPLES):
        best = solve(problem, starts=len(more), samples=samples, more_starts=more)
        if best.feasible and best.kkt is not None and best.kkt.residual <= RESIDUAL:
            return best.objective
    return min(best.objective, first.objective) if best.feasible else first.objective


def _met(point: Point) -> bool:
    return point.valid and point.violation <= FEASIBLE


def _optimal(near: Evaluator, point: Point) -> bool:
    return _met(point) and kkt.check(near, point).residual <= RESIDUAL
