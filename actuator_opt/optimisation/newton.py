"""Active-set Newton steps: the exact-Hessian polish that first-order solvers lack.

Sequential quadratic programming with the Hessian of the Lagrangian from exact gradients
[NocedalWright2006] ch. 18. Each quadratic programme is a least-distance problem, solved by
non-negative least squares [LawsonHanson1974] ch. 23. This identifies the active set and copes with
dependent rows and overdetermined vertices. Converges quadratically near the optimum; also re-solves
a slightly changed problem.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import kkt
from .evaluator import Evaluator, LimitReached, Point
from .problem import Vector

DAMPING = 1e3
"""Weight of complementarity when multipliers are estimated away from the optimum."""

FEASIBLE = 1e-9
"""Violation below which a polished point counts as exactly feasible."""

RADIUS = 0.5
"""Longest step in any solver coordinate (a factor of 1.65 in a logarithmic variable)."""


@dataclass(frozen=True)
class NewtonState:
    """A point with the data for the next step."""

    point: Point
    near: kkt.Active
    multipliers: Vector
    equality_multipliers: Vector
    measure: float
    scale: float


def state_at(evaluator: Evaluator, point: Point) -> NewtonState:
    """A point with its multipliers and optimality residual."""
    m = evaluator.constraint_count
    jacobian = evaluator.jacobian(point)
    near = kkt.active_set(evaluator, point, width=0.1)
    equalities = jacobian[1 + m :]
    held, free = kkt.multipliers(jacobian[0], near, equalities, damping=DAMPING)
    scale = kkt.slope_scale(evaluator, point)
    rest = jacobian[0] - near.gradients.T @ held - equalities.T @ free
    slack = float(held @ np.maximum(near.margins, 0.0))
    measure = (float(np.linalg.norm(rest)) + slack) / scale + point.violation
    return NewtonState(point, near, held, free, measure, scale)


def polish(
    evaluator: Evaluator, start: Point, *, iterations: int = 12, tolerance: float = 1e-13
) -> Point:
    """Improve a point towards the optimality conditions; never worse than the start.

    Returns the start itself without a better point.
    """
    if not start.valid or evaluator.space.size == 0:
        return start
    first = state = state_at(evaluator, start)
    visited = [state]
    try:
        for _ in range(iterations):
            if state.measure <= tolerance:
                break
            following = _advance(evaluator, state)
            if following is None:
                break
            state = following
            visited.append(state)
    except LimitReached:
        pass
    visited.sort(key=lambda s: (max(s.point.violation - FEASIBLE, 0.0), s.measure))
    for candidate in visited:
        if _acceptable(evaluator, first, candidate):
            return candidate.point
    return start


def _acceptable(evaluator: Evaluator, first: NewtonState, found: NewtonState) -> bool:
    """Whether a point is no less feasible, and not costlier than start plus priced violation."""
    if found.point.violation > max(FEASIBLE, first.point.violation):
        return False
    owed = float(first.multipliers @ np.maximum(-first.near.margins, 0.0))
    m = evaluator.constraint_count
    owed += float(np.abs(first.equality_multipliers) @ np.abs(first.point.rows[1 + m :]))
    room = 1e-9 * max(abs(first.point.objective), first.scale)
    if first.point.violation > 1e-3:  # far away: any feasible point is an improvement
        return True
    return found.point.objective <= first.point.objective + 2 * owed + room


def _advance(evaluator: Evaluator, state: NewtonState) -> NewtonState | None:
    """One accepted step, or None if no step improves."""
    point, space = state.point, evaluator.space
    step, price = quadratic_step(
        evaluator,
        point,
        state.scale,
        convex_hessian(evaluator, state),
        state.equality_multipliers,
    )
    longest = float(np.abs(step).max(initial=0.0))
    if not np.isfinite(longest) or longest < 1e-16:
        return None
    step = step * min(1.0, RADIUS / longest)
    merit = _merit(evaluator, point, state.scale, price)
    for share in (1.0, 0.5, 0.2, 0.05, 0.01):
        z = np.clip(point.z + share * step, space.lower, space.upper)
        trial = evaluator.point(z)
        if not trial.valid:
            continue
        better = _merit(evaluator, trial, state.scale, price) < merit - 1e-9 * (1 + abs(merit))
        if better or share == 1.0:
            following = state_at(evaluator, trial)
            if better or following.measure < 0.9 * state.measure:
                return following
    return None


def _merit(evaluator: Evaluator, point: Point, scale: float, price: float) -> float:
    """Return the l1 merit: objective plus violations at more than their price."""
    m = evaluator.constraint_count
    missed = np.maximum(-point.rows[1 : 1 + m], 0.0).sum() + np.abs(point.rows[1 + m :]).sum()
    return point.objective / scale + price * float(missed)


def quadratic_step(
    evaluator: Evaluator,
    point: Point,
    scale: float,
    hessian: Vector,
    equality_multipliers: Vector,
) -> tuple[Vector, float]:
    """Step (nf,) of the quadratic programme, and a price above every scaled multiplier.

    `hessian` (nf, nf) is that of the Lagrangian over `scale`, positive definite.
    """
    m = evaluator.constraint_count
    rows = kkt.active_set(evaluator, point, width=1.0)
    jacobian = evaluator.jacobian(point)
    slope, equalities = jacobian[0] / scale, jacobian[1 + m :]
    shift = np.zeros_like(slope)
    basis = np.eye(len(slope))
    if len(equalities):
        shift = np.linalg.lstsq(equalities, -point.rows[1 + m :], rcond=1e-12)[0]
        basis = kkt.null_space(equalities, len(slope))
    inner, prices = quadratic_programme(
        basis.T @ hessian @ basis,
        basis.T @ (slope + hessian @ shift),
        rows.gradients @ basis,
        rows.margins + rows.gradients @ shift,
    )
    held = prices[: len(rows.constraint)]
    free = np.abs(equality_multipliers) / scale
    return shift + basis @ inner, 2 * max(held.max(initial=0.0), free.max(initial=0.0)) + 1.0


def convex_hessian(evaluator: Evaluator, state: NewtonState) -> Vector:
    """Scaled Hessian of the Lagrangian, made positive definite without changing the step.

    Adding multiples of the active rows' outer products leaves the solution on those rows unchanged.
    If that is not enough, negative curvatures count by their magnitude.
    """
    m, near = evaluator.constraint_count, state.near
    full = np.zeros(m)
    full[near.constraint] = state.multipliers[: len(near.constraint)]
    firm = state.multipliers > 1e-6 * state.scale
    a, b = len(near.constraint), len(near.constraint) + len(near.lower)
    close = near.margins <= 1e-8
    fixed = np.concatenate([near.lower[(firm & close)[a:b]], near.upper[(firm & close)[b:]]])
    columns = np.setdiff1d(np.arange(evaluator.space.size), fixed)
    weights = kkt.lagrangian_weights(full, state.equality_multipliers)
    hessian = evaluator.hessian(state.point, weights, columns) / state.scale
    size = max(float(np.abs(hessian).max(initial=0.0)), 1e-3)
    hessian[fixed, fixed] = size
    floor = 1e-7 * size
    held = near.gradients[firm]
    held = held / np.sqrt((held**2).sum(axis=1, keepdims=True))
    for weight in (0.0, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0, 1e3):
        convex = hessian + weight * size * (held.T @ held)
        if np.linalg.eigvalsh(convex)[0] > floor:
            return np.asarray(convex)
    values, vectors = np.linalg.eigh(hessian)
    return np.asarray((vectors * np.maximum(np.abs(values), floor)) @ vectors.T)


def quadratic_programme(
    hessian: Vector, slope: Vector, rows: Vector, margins: Vector, known: Vector | None = None
) -> tuple[Vector, Vector]:
    """Minimise d'Hd/2 + slope'd subject to margins + rows d >= 0, with multipliers (a,) >= 0.

    Inconsistent rows give the step of least violation instead. `known` are multipliers of a similar
    programme, which only save time.
    """
    factor = np.linalg.cholesky(hessian)
    moved = np.linalg.solve(factor, slope)
    prices = np.zeros(len(margins))
    if len(margins) == 0:
        return -np.linalg.solve(factor.T, moved), prices
    turned = np.linalg.solve(factor, rows.T).T
    needed = turned @ moved - margins
    length = np.sqrt((turned**2).sum(axis=1))
    useful = length > 1e-12
    turned, needed = turned[useful] / length[useful, None], needed[useful] / length[useful]
    unit = np.zeros(len(slope) + 1)
    unit[-1] = 1.0
    stacked = np.concatenate([turned.T, needed[None, :]])
    weights = kkt.nnls(stacked, unit, None if known is None else known[useful])
    residual = stacked @ weights - unit
    if -residual[-1] <= 1e-12:  # the rows contradict each other
        missed = -margins
        worst = missed > 0
        step = np.linalg.lstsq(rows[worst], missed[worst], rcond=1e-8)[0]
        return np.asarray(step, dtype=float), prices
    nearest = -residual[:-1] / residual[-1]
    prices[useful] = weights / -residual[-1] / length[useful]
    return np.linalg.solve(factor.T, nearest - moved), prices
