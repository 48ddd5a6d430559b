"""Re-optimises a problem from the optimum of a similar problem (other bounds or materials).

Most optima are reached by quadratic steps that use the Hessian of the known optimum, with one
evaluation each. If the steps fail, a restoration looks for the nearest feasible point, and SLSQP
continues from there. The Hessian is not updated, because seven correct digits are enough and
because the problem may contain equalities.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ...base.dataclass import dataclass
from .. import kkt, nlopt_wrapper, repairs
from ..evaluator import Evaluator, Point, points_together
from ..problem import Vector
from ..solution import MET
from .steps import (
    PATIENCE,
    RESIDUAL,
    SETTLED,
    ScaledHessian,
    Steps,
    is_met,
    restoring_steps,
    run_batch,
)

STEPS = 14
"""Maximum number of steps that use the Hessian of the known, similar optimum."""

MOST_STEPS = 100
"""Maximum number of evaluations by SLSQP after a restoration."""

DOUBTFUL = 0.01
"""If the restoration leaves a violation of at most this, it may have overlooked a feasible point,
and a slower search for a feasible point follows."""


class Criteria(NamedTuple):
    """When steps count as converged: limits on step length, violation and residual."""

    step: float
    violation: float
    residual: float


EXACT = Criteria(SETTLED, 1e-11, RESIDUAL)
"""For final results. The limit on the violation is strict because a violation changes the objective
to first order; step length and residual change it only to second order."""

ROUGH = Criteria(1e-4, 1e-7, 1e-3)
"""For comparisons of designs, which need seven correct digits."""

NEAR = Criteria(0.02, 1e-3, np.inf)
"""Sufficient to reject a design whose objective is worse than the known best by more than `WORSE`.
"""

WORSE = 0.02
"""A relative loss in the objective larger than this is certain, even at the accuracy of `NEAR`."""


class Nearest(NamedTuple):
    """The optimum near the start; if there is none, the least infeasible point.

    `followed` is True if steps with the Hessian of the known, similar optimum converged.
    """

    optimum: Point | None
    missed: Point | None = None
    followed: bool = False


@dataclass(frozen=True)
class BoxTask:
    """A problem to re-optimise near a known optimum of another problem.

    Parameters
    ----------
    evaluator : evaluator of the problem
    x : the nearest known point (n,)
    hessian : Hessian at the optimum of the other problem
    criteria : convergence criteria
    hopeless : whether the other problem is infeasible; `x` is then its least infeasible point
    cutoff : known objective; the steps may stop early once the optimum is clearly worse than this
    """

    evaluator: Evaluator
    x: Vector
    hessian: ScaledHessian | None
    criteria: Criteria = EXACT
    hopeless: bool = False
    cutoff: float = np.inf


def resolve_boxes(tasks: Sequence[BoxTask]) -> list[Nearest]:
    """Re-optimise the problem of every task; it has no optimum if no feasible point is nearby.

    The problems differ only in their bounds, so one model call evaluates a step of all problems.
    """

    def evaluate(requests: Mapping[int, Vector]) -> list[Point]:
        return points_together([(tasks[k].evaluator, z) for k, z in requests.items()])

    ends = run_batch([_approach(task) for task in tasks], evaluate)
    return [_finished(*pair) for pair in zip(tasks, ends, strict=True)]


def _finished(task: BoxTask, end: Nearest) -> Nearest:
    """Continue with SLSQP if the end point is feasible but not yet optimal."""
    if end.optimum is None or end.followed:
        return end
    point = nlopt_wrapper.run(
        task.evaluator, end.optimum, "LD_SLSQP", max_evaluations=MOST_STEPS
    ).point
    point = kkt.polish(task.evaluator, point, iterations=8, tolerance=1e-10)
    return Nearest(point if is_met(point) else end.optimum)


def _approach(task: BoxTask) -> Steps[Nearest]:
    """Step to the optimum, with the other problem's Hessian; if that fails, to a feasible point."""
    evaluator = task.evaluator
    start = yield evaluator.space.to_z(task.x)
    if evaluator.space.size == 0:
        return Nearest(start, followed=True) if is_met(start) else Nearest(None, start)
    if not start.valid:
        return Nearest(None)
    if task.hessian is not None and not task.hopeless:
        optimum = yield from fixed_hessian_steps(
            evaluator, start, task.hessian, task.criteria, task.cutoff
        )
        if optimum is not None:
            return Nearest(optimum, followed=True)
    return (yield from _restored(evaluator, start, 1 if task.hopeless else PATIENCE))


def fixed_hessian_steps(
    evaluator: Evaluator,
    start: Point,
    scaled_hessian: ScaledHessian,
    criteria: Criteria,
    cutoff: float = np.inf,
) -> Steps[Point | None]:
    """The optimum reached by steps that use another problem's Hessian; None if they fail.

    If the optimum is clearly worse than `cutoff`, the steps stop early.
    """
    clearly_worse = cutoff + WORSE * abs(cutoff) if cutoff < np.inf else np.inf
    space = evaluator.space
    hessian = scaled_hessian.in_coordinates(evaluator, start.x)
    if not (np.diag(hessian) > 0).all():  # a variable is free only here
        return None
    no_equalities = np.zeros(len(evaluator.problem.equality_names))
    previous_length, point, reference = np.inf, start, np.inf
    for iteration in range(STEPS):
        stuck = iteration > PATIENCE and point.violation > max(0.98 * reference, MET)
        if not point.valid or stuck:
            return None
        if iteration % PATIENCE == 0:
            reference = point.violation
        if previous_length <= criteria.step and point.violation <= criteria.violation:
            return point if kkt.check(evaluator, point).residual <= criteria.residual else None
        if (
            previous_length <= NEAR.step
            and point.violation <= NEAR.violation
            and point.objective > clearly_worse
        ):
            return point
        step, _ = kkt.quadratic_step(evaluator, point, scaled_hessian.scale, hessian, no_equalities)
        longest = float(np.abs(step).max(initial=0.0))
        if not np.isfinite(longest) or longest > 4 * max(previous_length, 1e-3):
            return None
        previous_length = longest
        share = min(1.0, kkt.RADIUS / max(longest, 1e-300))
        point = yield np.clip(point.z + share * step, space.lower, space.upper)
    return None


def stepped(
    evaluator: Evaluator, start: Point, scaled_hessian: ScaledHessian, criteria: Criteria
) -> Point | None:
    """The result of `fixed_hessian_steps` for a single problem."""
    solver = fixed_hessian_steps(evaluator, start, scaled_hessian, criteria)
    (optimum,) = run_batch(
        [solver], lambda requests: [evaluator.point(z) for z in requests.values()]
    )
    return optimum


def _restored(evaluator: Evaluator, start: Point, patience: int) -> Steps[Nearest]:
    """A feasible point near the start; if there is none, None and the least infeasible point."""
    best = start
    if not evaluator.problem.equality_names:
        feasible, least_infeasible = yield from restoring_steps(evaluator, start, patience)
        if feasible is not None:
            return Nearest(feasible)
        best = least_infeasible or start
    doubtful = best.violation <= DOUBTFUL or bool(evaluator.problem.equality_names)
    return Nearest(repairs.feasible_point(evaluator, best) if doubtful else None, best)
