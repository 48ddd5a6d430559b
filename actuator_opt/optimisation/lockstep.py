"""Re-solve many slightly changed problems at once: one model evaluation serves all of them.

Each problem takes the quadratic steps of `newton` with the Hessian of the unchanged optimum,
which converges linearly and fast for small changes. Those it does not serve go on from a feasible
point with Hessians of their own, and the rest is left to the sturdier path of `prices.resolved`.
"""

from __future__ import annotations

import numpy as np

from ..numeric import STEP
from . import kkt, newton
from .evaluator import Evaluator, Point
from .problem import ParametricProblem, Vector

ITERATIONS = 10
"""Most steps with the shared Hessian; 10 % changes mostly take three to five."""

RENEWALS = (0, 5, 10)
"""Steps before which a problem with a Hessian of its own renews it."""

LONGEST = 16
"""Most steps with Hessians of one's own."""

RESTORATIONS = 24
"""Most steps towards a feasible point."""

PATIENCE = 4
"""Steps within which the violation must fall by 2 %, or the problem counts as infeasible."""

SETTLED = 1e-6
"""Length of the last step below which the optimality conditions are worth checking."""

FEASIBLE = 1e-11
"""Violation left: the objective is first order in it."""

RESIDUAL = 1e-6
"""Residual of the optimality conditions left: the objective is second order in it."""


def applicable(parametric: ParametricProblem, evaluator: Evaluator) -> bool:
    """Whether exact gradients of every row come from one complex evaluation."""
    exact = evaluator.complex_works and not evaluator.difference_rows.any()
    return exact and not parametric.problem.equality_names


def resolve_together(
    parametric: ParametricProblem,
    evaluator: Evaluator,
    point: Point,
    starts: Vector,
    parameters: Vector,
    *,
    own: bool = False,
) -> list[Point | None]:
    """Optima of the re-solved problems; None where a problem needs the sturdier path.

    Parameters
    ----------
    parametric : the problem with its parameters
    evaluator, point : of the unchanged optimum
    starts : coordinates to start from (nf, K)
    parameters : parameter values of each problem (q, K)
    own : each problem takes Hessians of its own, dearer and sturdier than the shared one
    """
    count = starts.shape[1]
    found: list[Point | None] = [None] * count
    if count == 0:
        return found
    state = newton.state_at(evaluator, point)
    hessians = [newton.convex_hessian(evaluator, state)] * count
    space = evaluator.space
    z = np.clip(starts, space.lower[:, None], space.upper[:, None])
    last = np.full(count, np.inf)
    alive = list(range(count))
    for iteration in range(LONGEST if own else ITERATIONS):
        if not alive:
            break
        points = _points(parametric, evaluator, z[:, alive], parameters[:, alive])
        going = []
        for k, trial in zip(alive, points, strict=True):
            if not trial.valid:
                continue
            settled = last[k] <= SETTLED and trial.violation <= FEASIBLE
            if settled and kkt.check(evaluator, trial).residual <= RESIDUAL:
                found[k] = trial
                continue
            if own and iteration in RENEWALS:
                alone = Evaluator(parametric.at(parameters[:, k]))
                there = newton.state_at(alone, trial)
                hessians[k] = newton.convex_hessian(alone, there) * (there.scale / state.scale)
                last[k] = np.inf
            step, _ = newton.quadratic_step(
                evaluator, trial, state.scale, hessians[k], state.equality_multipliers
            )
            longest = float(np.abs(step).max(initial=0.0))
            if not np.isfinite(longest) or longest > 4 * max(last[k], 1e-3):
                continue
            last[k] = longest
            share = min(1.0, newton.RADIUS / max(longest, 1e-300))
            z[:, k] = np.clip(z[:, k] + share * step, space.lower, space.upper)
            going.append(k)
        alive = going
    kept = _unmoved(parametric, evaluator, point, parameters)
    for k, optimum in enumerate(found):
        if optimum is None:
            continue
        if kept[k] < optimum.objective * (1 - 1e-9 * np.sign(optimum.objective)):
            found[k] = None  # the old optimum itself is better: another valley
    return found


def restore_together(
    parametric: ParametricProblem, evaluator: Evaluator, point: Point, parameters: Vector
) -> list[Vector | None]:
    """A feasible point (nf,) near the unchanged optimum for each problem; None where none is.

    Every step is the shortest that meets the linearised rows, or misses them least.
    """
    space = evaluator.space
    count = parameters.shape[1]
    found: list[Vector | None] = [None] * count
    z = np.repeat(point.z[:, None], count, axis=1)
    least = np.full(count, np.inf)
    alive = list(range(count))
    for iteration in range(RESTORATIONS):
        if not alive:
            break
        points = _points(parametric, evaluator, z[:, alive], parameters[:, alive])
        going = []
        for k, trial in zip(alive, points, strict=True):
            if trial.valid and trial.violation <= 1e-6:
                found[k] = trial.z
                continue
            stuck = iteration > PATIENCE and trial.violation > 0.98 * least[k]
            if not trial.valid or stuck:
                continue
            if iteration % PATIENCE == 0:
                least[k] = trial.violation
            rows = kkt.active_set(evaluator, trial, width=1.0)
            step, _ = newton.quadratic_programme(
                np.eye(space.size), np.zeros(space.size), rows.gradients, rows.margins - 1e-7
            )
            share = min(1.0, newton.RADIUS / max(float(np.abs(step).max(initial=0.0)), 1e-300))
            z[:, k] = np.clip(z[:, k] + share * step, space.lower, space.upper)
            going.append(k)
        alive = going
    return found


def _points(
    parametric: ParametricProblem, evaluator: Evaluator, z: Vector, parameters: Vector
) -> list[Point]:
    """Every problem's point with its gradients, from one complex evaluation."""
    space = evaluator.space
    nf, count = z.shape
    x = space.to_x(z)
    batch = np.repeat(x.astype(complex), nf, axis=1)
    columns = np.arange(count * nf).reshape(count, nf)
    batch[space.free[None, :], columns] += 1j * STEP * space.slope(x).T
    problem = parametric.with_columns(np.repeat(parameters, nf, axis=1))
    rows = problem.rows(batch).reshape(-1, count, nf)
    values, slopes = rows.real[:, :, 0], np.asarray(rows.imag / STEP, dtype=float)
    values = Evaluator.screen(values)
    violation = evaluator.violations(values, "worst")
    valid = np.isfinite(values).all(axis=0) & np.isfinite(slopes).all(axis=(0, 2))
    return [
        Point(z[:, k], x[:, k], values[:, k], bool(valid[k]), float(violation[k]), slopes[:, k])
        for k in range(count)
    ]


def _unmoved(
    parametric: ParametricProblem, evaluator: Evaluator, point: Point, parameters: Vector
) -> Vector:
    """Objective of the unchanged optimum under each problem, infinite where it is infeasible."""
    count = parameters.shape[1]
    x = np.repeat(point.x[:, None], count, axis=1)
    rows = Evaluator.screen(parametric.with_columns(parameters).rows(x))
    feasible = evaluator.violations(rows, "worst") <= FEASIBLE
    return np.where(feasible, rows[0], np.inf)
