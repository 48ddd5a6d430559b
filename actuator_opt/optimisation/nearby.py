"""Re-optimise a problem near a known optimum of another one much like it.

Quadratic steps with the curvature of that optimum, one evaluation each, settle most problems that
differ in a bound, in a fixed value or in a material. Where they do not, the nearest feasible point
is sought by shortest steps, and SLSQP goes on from it.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from . import elastic, kkt, newton, nlopt_wrapper
from .descents import FEASIBLE, RESIDUAL
from .evaluator import Evaluator, Point, points_together
from .lockstep import PATIENCE, RESTORATIONS, SETTLED
from .problem import Vector

STEPS = 14
"""Most steps with the curvature of the other optimum."""

MOST_STEPS = 100
"""Most evaluations of SLSQP where these do not settle."""

DOUBTFUL = 0.01
"""Violation left up to which shortest steps may have overlooked a feasible point."""


class Finish(NamedTuple):
    """When steps count as settled: length of the last one, violation and residual left."""

    step: float
    violation: float
    residual: float


EXACT = Finish(SETTLED, 1e-11, RESIDUAL)
"""For what is kept: the objective is first order in the violation, second in the others."""

ROUGH = Finish(1e-4, 1e-7, 1e-3)
"""For what is compared: to seven digits."""

NEAR = Finish(0.02, 1e-3, np.inf)
"""For what is clearly worse than what is known, by `WORSE`."""

WORSE = 0.02
"""Relative loss of the objective that is more than what `NEAR` leaves open."""


@dataclass(frozen=True)
class Curvature:
    """Scaled Hessian (n, n) of the Lagrangian at an optimum, per x of all variables."""

    hessian: Vector
    scale: float

    def seen_by(self, evaluator: Evaluator, x: Vector) -> Vector:
        """In the coordinates of the free variables of a problem, at a point of it (n,)."""
        space = evaluator.space
        slope = space.slope(x[:, None])[:, 0]
        return np.asarray(self.hessian[np.ix_(space.free, space.free)] * np.outer(slope, slope))


def curvature_at(evaluator: Evaluator, point: Point) -> Curvature | None:
    """The curvature at an optimum; None where nothing is free."""
    space = evaluator.space
    if not space.size or not point.valid:
        return None
    state = newton.state_at(evaluator, point)
    slope = space.slope(point.x[:, None])[:, 0]
    hessian = newton.convex_hessian(evaluator, state) / np.outer(slope, slope)
    full = np.zeros((len(point.x), len(point.x)))
    full[np.ix_(space.free, space.free)] = hessian
    return Curvature(full, state.scale)


class Nearest(NamedTuple):
    """The optimum near a point, or None and the least violated point met on the way.

    `followed` tells that steps with the other optimum's curvature settled on it.
    """

    optimum: Point | None
    missed: Point | None = None
    followed: bool = False


Steps = Generator[Vector, Point, Point | None]
"""Asks for points by their coordinates, is given them, ends on one or none."""


@dataclass(frozen=True)
class Task:
    """A problem to re-optimise near a known optimum of another.

    Parameters
    ----------
    evaluator : of the problem
    x : a point (n,), as near as is known
    curvature : of the optimum of the other problem
    finish : when steps count as settled
    hopeless : whether the other problem has no feasible point, and `x` misses least of it
    above : an optimum clearly worse than this objective need not be reached
    """

    evaluator: Evaluator
    x: Vector
    curvature: Curvature | None
    finish: Finish = EXACT
    hopeless: bool = False
    above: float = np.inf


def resolve(tasks: Sequence[Task]) -> list[Nearest]:
    """The optimum of every task; none where no feasible point is found near it.

    Their problems differ in nothing but their bounds, so that one call of the model serves the
    steps of all.
    """
    ends: list[Nearest | None] = [None] * len(tasks)
    running = {k: _approach(task) for k, task in enumerate(tasks)}
    asked = {k: next(steps) for k, steps in running.items()}
    while asked:
        points = points_together([(tasks[k].evaluator, z) for k, z in asked.items()])
        following = {}
        for k, point in zip(asked, points, strict=True):
            try:
                following[k] = running[k].send(point)
            except StopIteration as end:
                ends[k] = end.value
        asked = following
    return [_finished(task, end) for task, end in zip(tasks, ends, strict=True) if end is not None]


def _finished(task: Task, end: Nearest) -> Nearest:
    """Go on by SLSQP from a point that only meets every requirement."""
    if end.optimum is None or end.followed:
        return end
    found = nlopt_wrapper.run(task.evaluator, end.optimum, "LD_SLSQP", most=MOST_STEPS).point
    found = newton.polish(task.evaluator, found, iterations=8, tolerance=1e-10)
    return Nearest(found if _met(found) else end.optimum)


def _approach(task: Task) -> Generator[Vector, Point, Nearest]:
    """Steps with the other's curvature, else to a feasible point."""
    evaluator = task.evaluator
    start = yield evaluator.space.to_z(task.x)
    if evaluator.space.size == 0:
        return Nearest(start, followed=True) if _met(start) else Nearest(None, start)
    if not start.valid:
        return Nearest(None)
    if task.curvature is not None and not task.hopeless:
        found = yield from steps(evaluator, start, task.curvature, task.finish, task.above)
        if found is not None:
            return Nearest(found, followed=True)
    return (yield from _restored(evaluator, start, 1 if task.hopeless else PATIENCE))


def steps(
    evaluator: Evaluator,
    start: Point,
    curvature: Curvature,
    finish: Finish,
    above: float = np.inf,
) -> Steps:
    """The optimum that steps with the other's curvature settle on; None where they do not.

    Steps that come near an optimum clearly worse than `above` end there.
    """
    clearly = above + WORSE * abs(above) if above < np.inf else np.inf
    space = evaluator.space
    hessian = curvature.seen_by(evaluator, start.x)
    if not (np.diag(hessian) > 0).all():  # what is free here was fixed there
        return None
    free = np.zeros(len(evaluator.problem.equality_names))
    last, point, least = np.inf, start, np.inf
    for iteration in range(STEPS):
        stuck = iteration > PATIENCE and point.violation > max(0.98 * least, FEASIBLE)
        if not point.valid or stuck:
            return None
        if iteration % PATIENCE == 0:
            least = point.violation
        if last <= finish.step and point.violation <= finish.violation:
            return point if kkt.check(evaluator, point).residual <= finish.residual else None
        if last <= NEAR.step and point.violation <= NEAR.violation and point.objective > clearly:
            return point
        step, _ = newton.quadratic_step(evaluator, point, curvature.scale, hessian, free)
        longest = float(np.abs(step).max(initial=0.0))
        if not np.isfinite(longest) or longest > 4 * max(last, 1e-3):
            return None
        last = longest
        share = min(1.0, newton.RADIUS / max(longest, 1e-300))
        point = yield np.clip(point.z + share * step, space.lower, space.upper)
    return None


def stepped(
    evaluator: Evaluator, start: Point, curvature: Curvature, finish: Finish
) -> Point | None:
    """`steps` of one problem alone."""
    going = steps(evaluator, start, curvature, finish)
    try:
        z = next(going)
        while True:
            z = going.send(evaluator.point(z))
    except StopIteration as end:
        found: Point | None = end.value
        return found


def _restored(
    evaluator: Evaluator, start: Point, patience: int
) -> Generator[Vector, Point, Nearest]:
    """A feasible point near another, by the shortest steps that meet the linearised rows.

    None, and the least violated point, where the violation stops falling.
    """
    space, point, best, least = evaluator.space, start, start, np.inf
    for iteration in range(RESTORATIONS):
        if evaluator.problem.equality_names or not point.valid:
            break
        if point.violation <= FEASIBLE:
            return Nearest(point)
        best = point if point.violation < best.violation else best
        if iteration > patience and point.violation > 0.98 * least:
            break
        if iteration % patience == 0:
            least = point.violation
        rows = kkt.active_set(evaluator, point, width=1.0)
        step, _ = newton.quadratic_programme(
            np.eye(space.size), np.zeros(space.size), rows.gradients, rows.margins - 1e-7
        )
        share = min(1.0, newton.RADIUS / max(float(np.abs(step).max(initial=0.0)), 1e-300))
        point = yield np.clip(point.z + share * step, space.lower, space.upper)
    doubtful = best.violation <= DOUBTFUL or bool(evaluator.problem.equality_names)
    return Nearest(elastic.feasible_point(evaluator, best) if doubtful else None, best)


def _met(point: Point) -> bool:
    return point.valid and point.violation <= FEASIBLE
