"""Re-optimise a problem at changed parameters, every end of a price table together.

Most ends follow from the predicted optimum in a few common steps. What is found at one end then
stands as a start at every other, so that none stays in a worse valley than its neighbours know of.
Only what is left is searched for like any optimum.
"""

from __future__ import annotations

from collections.abc import Sequence

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

BETTER = 1e-9
"""Share of the objective by which another design must be better to count as another valley."""

ROUNDS = 3
"""Most exchanges of what the ends found; each goes on only where the last one gained."""

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
    if lockstep.applicable(parametric, evaluator):
        batch = [pair for pair in steps if pair[0] < count]
        columns = np.repeat(parametric.parameters[:, None], len(batch), axis=1)
        starts = np.repeat(point.z[:, None], len(batch), axis=1)
        for column, (k, sign) in enumerate(batch):
            columns[k, column] += steps[k, sign]
            starts[:, column] += moves[:, k] * steps[k, sign]
        found, feasible = _together(parametric, evaluator, point, starts, columns, known)
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
    point: Point,
    starts: Vector,
    parameters: Vector,
    known: Sequence[Vector],
) -> tuple[list[Point | None], list[Vector | None]]:
    """The optimum of each changed problem, and a feasible point; None where none is in reach."""
    found = lockstep.resolve_together(parametric, evaluator, point, starts, parameters)
    inside: list[Vector | None] = [None if one is None else one.z for one in found]
    left = [i for i, one in enumerate(found) if one is None]
    restored = lockstep.restore_together(parametric, evaluator, point, parameters[:, left])
    for i, z in zip(left, restored, strict=True):
        inside[i] = z
    better = {i: z for i, z in zip(left, restored, strict=True) if z is not None}
    old = [point, *(evaluator.point(evaluator.space.to_z(x)) for x in known)]
    for _ in range(ROUNDS):
        if better:
            chosen = list(better)
            again = lockstep.descend_together(
                parametric,
                evaluator,
                point,
                np.stack([better[i] for i in chosen], axis=1),
                parameters[:, chosen],
            )
            for i, one in zip(chosen, again, strict=True):
                now = found[i]
                if one is not None and (now is None or one.objective < now.objective):
                    found[i] = one
        better = _elsewhere(parametric, evaluator, old, found, parameters)
        inside = [better.get(i, z) for i, z in enumerate(inside)]
        if not better:
            break
    for i in better:
        found[i] = None  # a better valley is known, its optimum is not
    return found, inside


def _elsewhere(
    parametric: ParametricProblem,
    evaluator: Evaluator,
    old: list[Point],
    found: list[Point | None],
    parameters: Vector,
) -> dict[int, Vector]:
    """For each end the best of the other ends' designs, where that beats its own optimum."""
    points = [*old, *(one for one in found if one is not None)]
    if not found:
        return {}
    objectives, violations = lockstep.standing(parametric, evaluator, points, parameters)
    objectives = np.where(violations <= lockstep.FEASIBLE, objectives, np.inf)
    best = np.argmin(objectives, axis=0)
    better = {}
    for i, one in enumerate(found):
        reached = float(objectives[best[i], i])
        room = BETTER * abs(reached)
        if np.isfinite(reached) and (one is None or reached < one.objective - room):
            better[i] = points[int(best[i])].z
    return better


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
