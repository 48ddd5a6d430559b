"""Optimality of a point (multipliers, residual, rank, curvature), and Newton steps to an optimum.

The residual is the norm of grad f - sum(multiplier * grad g), divided by the norm of grad f, in
solver coordinates; f is the objective and g are constraint margins and distances to bounds. The sum
is over all g within 1e-6 of zero. The multipliers follow from non-negative least squares
[LawsonHanson1974].

The Newton steps are sequential quadratic programming with the Lagrangian's Hessian from exact
gradients [NocedalWright2006] ch. 18. Each quadratic programme is a least-distance problem, solved
by non-negative least squares [LawsonHanson1974] ch. 23. This finds the active constraints, and also
works if constraints depend on each other or outnumber the variables at a vertex. The steps converge
quadratically near the optimum, also if they start from the optimum of a slightly changed problem.
"""

from __future__ import annotations

from enum import Enum

import numpy as np
import numpy.typing as npt

from ..base.dataclass import dataclass
from .evaluator import Evaluator, LimitReached, Point
from .problem import Vector

ACTIVE = 1e-6
"""A limit is active if its margin, or the distance to a bound in solver coordinates, is below this.
"""


class Curvature(Enum):
    """Sign of the Lagrangian's curvature in the directions that the active limits leave free."""

    VERTEX = "vertex: the active limits leave no direction free"
    POSITIVE = "positive definite: a strict local minimum"
    FLAT = "flat: in some direction the curvature is zero"
    NEGATIVE = "negative curvature: not a minimum"


@dataclass(frozen=True)
class Active:
    """The limits and bounds that are active at a point, with their margins and gradients.

    Parameters
    ----------
    gradients : gradients of the margins (a, nf); a is the number of active limits, nf that of free
        variables
    margins : margins (a,), at least 0 where met
    constraint, lower, upper : indices of the active constraints, and of the variables at their
        lower and upper bounds; `gradients` and `margins` are in this order
    """

    gradients: Vector
    margins: Vector
    constraint: npt.NDArray[np.intp]
    lower: npt.NDArray[np.intp]
    upper: npt.NDArray[np.intp]

    @property
    def count(self) -> int:
        """Number of active limits and bounds."""
        return len(self.margins)


@dataclass(frozen=True)
class KktResidual:
    """Accuracy with which a point satisfies the optimality conditions.

    Parameters
    ----------
    residual : norm of the Lagrangian's gradient, relative to that of the objective's gradient
    active : labels of active constraints, equalities and bounds ("NAME lower", "NAME upper")
    count, rank : number of active gradients, and how many of them are independent
    multipliers : multipliers (m,) of the constraints: change of the optimal objective per unit of
        additional margin required
    equality_multipliers : multipliers (e,) of the equalities
    lower_multipliers, upper_multipliers : (n,) for the bounds, per unit of solver coordinate
    curvature : result of the second-order condition; None if not requested
    """

    residual: float
    active: tuple[str, ...]
    count: int
    rank: int
    multipliers: Vector
    equality_multipliers: Vector
    lower_multipliers: Vector
    upper_multipliers: Vector
    curvature: Curvature | None = None

    @property
    def unique(self) -> bool:
        """Whether the multipliers are unique, which requires independent active gradients."""
        return self.rank == self.count


def nnls(
    matrix: Vector, vector: Vector, previous: Vector | None = None, *, independent: bool = True
) -> Vector:
    """Non-negative least squares: minimise |matrix @ result - vector| with result >= 0.

    First, plain least squares ignores the sign, which is enough at a regular optimum. If a result
    is negative, the active-set method of Lawson and Hanson follows. It starts from the columns that
    are positive in `previous`, the result of a similar problem.

    The positive results belong to independent columns; without `independent`, perhaps not.
    """
    size = np.sqrt((matrix**2).sum(axis=0))
    used = np.flatnonzero(size > 1e-14 * size.max(initial=0.0))
    result = np.zeros(matrix.shape[1])
    if len(used) == 0:
        return result
    scaled = matrix[:, used] / size[used]
    if len(used) <= matrix.shape[0] or not independent:
        guess, _, rank, _ = np.linalg.lstsq(scaled, vector, rcond=1e-10)
        if (rank == len(used) or not independent) and (guess >= 0).all():
            result[used] = guess / size[used]
            return result
    passive = np.zeros(len(used), dtype=bool) if previous is None else previous[used] > 0
    result[used] = _lawson_hanson(scaled, vector, passive) / size[used]
    return result


def _lawson_hanson(matrix: Vector, vector: Vector, passive: npt.NDArray[np.bool_]) -> Vector:
    count = matrix.shape[1]
    result, passive = _initial_result(matrix, vector, passive)
    refused = np.zeros(count, dtype=bool)
    tolerance = 1e-13 * (1e-300 + float(np.linalg.norm(vector)))
    for _ in range(5 * count):
        pull = matrix.T @ (vector - matrix @ result)
        pull[passive | refused] = -np.inf
        entering = int(np.argmax(pull))
        if pull[entering] <= tolerance:
            break
        passive[entering] = True
        trial, rank = _restricted(matrix, vector, passive)
        if rank < passive.sum() or trial[entering] <= 0:  # dependent, or within rounding error
            passive[entering], refused[entering] = False, True
            continue
        while trial[passive].min() <= 0:
            falling = np.flatnonzero(passive & (trial <= 0))
            room = result[falling] - trial[falling]
            shares = np.where(room > 0, result[falling] / np.where(room > 0, room, 1.0), 0.0)
            result = result + shares.min() * (trial - result)
            passive[falling[shares <= shares.min() * (1 + 1e-12)]] = False  # at least one
            result[~passive] = 0.0
            if not passive.any():
                trial = result
                break
            trial, _ = _restricted(matrix, vector, passive)
        result = trial
        refused[:] = False
    return result


def _initial_result(
    matrix: Vector, vector: Vector, passive: npt.NDArray[np.bool_]
) -> tuple[Vector, npt.NDArray[np.bool_]]:
    """A first result, from columns of `passive` that are independent and give positive values."""
    nothing = np.zeros(matrix.shape[1])
    while passive.any():
        trial, rank = _restricted(matrix, vector, passive)
        if rank < passive.sum():
            break
        if trial[passive].min() > 0:
            return trial, passive
        passive = passive & (trial > 0)
    return nothing, nothing > 0


def _restricted(
    matrix: Vector, vector: Vector, passive: npt.NDArray[np.bool_]
) -> tuple[Vector, int]:
    trial = np.zeros(matrix.shape[1])
    trial[passive], _, rank, _ = np.linalg.lstsq(matrix[:, passive], vector, rcond=1e-10)
    return trial, int(rank)


def active_set(evaluator: Evaluator, point: Point, width: float = ACTIVE) -> Active:
    """The constraints and bounds whose margin at a point is at most `width`."""
    space, m = evaluator.space, evaluator.constraint_count
    jacobian = evaluator.jacobian(point)
    margins = point.rows[1 : 1 + m]
    constraint = np.flatnonzero(margins <= width)
    lower = np.flatnonzero(point.z - space.lower <= width)
    upper = np.flatnonzero(space.upper - point.z <= width)
    unit = np.eye(space.size)
    return Active(
        np.concatenate([jacobian[1 : 1 + m][constraint], unit[lower], -unit[upper]]),
        np.concatenate(
            [margins[constraint], (point.z - space.lower)[lower], (space.upper - point.z)[upper]]
        ),
        constraint,
        lower,
        upper,
    )


def multipliers(
    slope: Vector,
    active: Active,
    equalities: Vector,
    damping: float = 0.0,
    *,
    independent: bool = True,
) -> tuple[Vector, Vector]:
    """Multipliers (a,) >= 0 of the active limits, and multipliers (e,) of the equalities.

    A `damping` above 0 penalises multipliers of limits with a positive margin. This identifies the
    active limits of an optimum from a point near it. Positive multipliers belong to limits with
    independent gradients; without `independent`, which is faster, perhaps not.
    """
    matrix, vector = active.gradients.T, slope
    if len(equalities):
        basis, _ = np.linalg.qr(equalities.T)
        matrix = matrix - basis @ (basis.T @ matrix)
        vector = vector - basis @ (basis.T @ vector)
    if damping > 0 and active.count:
        size = np.sqrt((active.gradients**2).sum(axis=1))
        extra = np.diag(damping * np.maximum(active.margins, 0.0) * size)
        matrix = np.concatenate([matrix, extra])
        vector = np.concatenate([vector, np.zeros(active.count)])
    inequality = nnls(matrix, vector, independent=independent)
    equality_multipliers = np.zeros(len(equalities))
    if len(equalities):
        remainder = slope - active.gradients.T @ inequality
        solution = np.linalg.lstsq(equalities.T, remainder, rcond=1e-12)[0]
        equality_multipliers = np.asarray(solution, dtype=float)
    return inequality, equality_multipliers


def slope_scale(evaluator: Evaluator, point: Point, objective_scale: float = 0.0) -> float:
    """Divisor of the residual: |grad f|, the norm of the objective's gradient.

    The divisor is at least a thousandth of the objective's magnitude, since |grad f| vanishes where
    the objective is stationary.
    """
    slope = float(np.linalg.norm(evaluator.jacobian(point)[0]))
    floor = max(1e-3 * abs(point.objective), 1e-6 * objective_scale)
    return max(slope, floor, 1e-300)


def _priced(
    evaluator: Evaluator, point: Point, objective_scale: float, *, independent: bool = True
) -> tuple[Active, Vector, Vector, float]:
    """Active limits at a point, multipliers of these and of the equalities, and the residual."""
    jacobian = evaluator.jacobian(point)
    active = active_set(evaluator, point)
    equalities = jacobian[1 + evaluator.constraint_count :]
    inequality, equality_multipliers = multipliers(
        jacobian[0], active, equalities, independent=independent
    )
    gradient = jacobian[0] - active.gradients.T @ inequality - equalities.T @ equality_multipliers
    size = slope_scale(evaluator, point, objective_scale)
    return active, inequality, equality_multipliers, float(np.linalg.norm(gradient)) / size


def residual(evaluator: Evaluator, point: Point) -> float:
    """Relative norm of the Lagrangian's gradient at a point, computed as in `check`."""
    return _priced(evaluator, point, 0.0, independent=False)[-1]


def check(
    evaluator: Evaluator, point: Point, *, curvature: bool = False, objective_scale: float = 0.0
) -> KktResidual:
    """Check how accurately a point satisfies the optimality conditions."""
    problem, m = evaluator.problem, evaluator.constraint_count
    jacobian = evaluator.jacobian(point)
    active, inequality, equality_multipliers, residual = _priced(evaluator, point, objective_scale)
    equalities = jacobian[1 + m :]
    stacked = np.concatenate([active.gradients, equalities])
    size = np.sqrt((stacked**2).sum(axis=1, keepdims=True))
    rank = int(np.linalg.matrix_rank(stacked / np.where(size > 0, size, 1.0), tol=1e-8))
    if len(stacked) == 0:
        rank = 0
    a, b = len(active.constraint), len(active.constraint) + len(active.lower)
    constraints, (lower, upper) = np.zeros(m), np.zeros((2, len(problem.names)))
    free_variables = evaluator.space.free
    constraints[active.constraint] = inequality[:a]
    lower[free_variables[active.lower]] = inequality[a:b]
    upper[free_variables[active.upper]] = inequality[b:]
    labels = [problem.constraint_names[i] for i in active.constraint]
    labels += list(problem.equality_names)
    labels += [f"{problem.names[free_variables[j]]} lower" for j in active.lower]
    labels += [f"{problem.names[free_variables[j]]} upper" for j in active.upper]
    sign = None
    if curvature:
        strong = active.gradients[inequality * np.sqrt((active.gradients**2).sum(axis=1)) > 0]
        rows = np.concatenate([strong, equalities])
        sign = _curvature(evaluator, point, constraints, equality_multipliers, rows)
    multipliers = constraints, equality_multipliers, lower, upper
    return KktResidual(residual, tuple(labels), len(stacked), rank, *multipliers, sign)


def lagrangian_weights(constraints: Vector, equalities: Vector) -> Vector:
    """Factors of the rows (objective, constraints, equalities) in the Lagrangian."""
    return np.concatenate([[1.0], -constraints, -equalities])


def null_space(rows: Vector, size: int) -> Vector:
    """Orthonormal basis (size, k) of all directions orthogonal to the `rows` (a, size)."""
    if len(rows) == 0:
        return np.eye(size)
    lengths = np.sqrt((rows**2).sum(axis=1, keepdims=True))
    _, values, basis = np.linalg.svd(rows / np.where(lengths > 0, lengths, 1.0))
    return np.asarray(basis[int((values > 1e-8).sum()) :].T)


def _curvature(
    evaluator: Evaluator, point: Point, constraints: Vector, equalities: Vector, rows: Vector
) -> Curvature:
    size = evaluator.space.size
    basis = null_space(rows, size)
    if basis.shape[1] == 0:
        return Curvature.VERTEX
    weights = lagrangian_weights(constraints, equalities)
    products = evaluator.hessian_products(point, weights, basis)
    values = np.linalg.eigvalsh((basis.T @ products + products.T @ basis) / 2)
    room = 1e-6 * max(float(np.abs(products).max()), 1e-3 * abs(point.objective), 1e-300)
    if values[0] < -room:
        return Curvature.NEGATIVE
    return Curvature.POSITIVE if values[0] > room else Curvature.FLAT


DAMPING = 1e3
"""Weight of the condition "margin times multiplier is 0" when multipliers are estimated near an
optimum."""
FEASIBLE = 1e-9
"""Violation up to which a point from Newton steps counts as exactly feasible."""
SIGNIFICANT = 1e-6
"""Multipliers above this share of the objective's slope count in a Newton step."""
REACHED = 1e-8
"""A limit is reached if its margin is at most this."""
RADIUS = 0.5
"""Longest step in each solver coordinate (a factor of 1.65 in a logarithmic variable)."""


@dataclass(frozen=True)
class NewtonState:
    """A point with the data from which the next step is computed."""

    point: Point
    active: Active
    multipliers: Vector
    equality_multipliers: Vector
    measure: float
    scale: float

    def weights(self, constraints: int) -> Vector:
        """Factors of the rows in the Lagrangian, see `lagrangian_weights`."""
        factors = np.zeros(constraints)
        factors[self.active.constraint] = self.multipliers[: len(self.active.constraint)]
        return lagrangian_weights(factors, self.equality_multipliers)


def state_at(evaluator: Evaluator, point: Point) -> NewtonState:
    """A point together with its multipliers and its residual."""
    m = evaluator.constraint_count
    jacobian = evaluator.jacobian(point)
    active = active_set(evaluator, point, width=0.1)
    equalities = jacobian[1 + m :]
    inequality, equality_multipliers = multipliers(jacobian[0], active, equalities, damping=DAMPING)
    scale = slope_scale(evaluator, point)
    gradient = jacobian[0] - active.gradients.T @ inequality - equalities.T @ equality_multipliers
    slack = float(inequality @ np.maximum(active.margins, 0.0))
    measure = (float(np.linalg.norm(gradient)) + slack) / scale + point.violation
    return NewtonState(point, active, inequality, equality_multipliers, measure, scale)


def polish(
    evaluator: Evaluator,
    start: Point,
    *,
    iterations: int = 12,
    tolerance: float = 1e-13,
    curved: Evaluator | None = None,
) -> Point:
    """Improve a point by Newton steps; return the start if no better point is reached.

    The steps end once the measure of optimality (see `NewtonState`) is below `tolerance`. Second
    derivatives come from `curved`, by default the same evaluator: rough ones cost steps, not
    accuracy.
    """
    if not start.valid or evaluator.space.size == 0:
        return start
    initial = state = state_at(evaluator, start)
    visited = [state]
    try:
        for _ in range(iterations):
            if state.measure <= tolerance:
                break
            following = _advance(evaluator, state, curved or evaluator)
            if following is None:
                break
            state = following
            visited.append(state)
    except LimitReached:
        pass
    visited.sort(key=lambda s: (max(s.point.violation - FEASIBLE, 0.0), s.measure))
    for candidate in visited:
        if acceptable(evaluator, initial, candidate):
            return candidate.point
    return start


def acceptable(evaluator: Evaluator, initial: NewtonState, newton_state: NewtonState) -> bool:
    """Whether a point is at least as feasible as the start, and its objective not higher.

    If the start violates limits, the objective may rise by twice the cost of removing this
    violation. If the violation at the start is large (above 1e-3), any rise is accepted.
    """
    if newton_state.point.violation > max(FEASIBLE, initial.point.violation):
        return False
    allowance = float(initial.multipliers @ np.maximum(-initial.active.margins, 0.0))
    m = evaluator.constraint_count
    allowance += float(np.abs(initial.equality_multipliers) @ np.abs(initial.point.rows[1 + m :]))
    room = 1e-9 * max(abs(initial.point.objective), initial.scale)
    if initial.point.violation > 1e-3:  # far from feasible: any feasible point is an improvement
        return True
    return newton_state.point.objective <= initial.point.objective + 2 * allowance + room


def _advance(evaluator: Evaluator, state: NewtonState, curved: Evaluator) -> NewtonState | None:
    """One accepted Newton step, or None if no step improves the point; see `polish`."""
    point, space = state.point, evaluator.space
    step, price = quadratic_step(
        evaluator,
        point,
        state.scale,
        _hessian_of_step(evaluator, state, curved),
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
        improves = _merit(evaluator, trial, state.scale, price) < merit - 1e-9 * (1 + abs(merit))
        if improves or share == 1.0:
            following = state_at(evaluator, trial)
            if improves or following.measure < 0.9 * state.measure:
                return following
    return None


def _merit(evaluator: Evaluator, point: Point, scale: float, price: float) -> float:
    """The l1 merit function: the objective plus `price` times the sum of the violations."""
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
    """Step (nf,) of the quadratic programme, and a penalty above every scaled multiplier.

    `hessian` (nf, nf) is the Lagrangian's Hessian divided by `scale`; it must be positive definite.
    """
    m = evaluator.constraint_count
    rows = active_set(evaluator, point, width=1.0)
    jacobian = evaluator.jacobian(point)
    slope, equalities = jacobian[0] / scale, jacobian[1 + m :]
    shift = np.zeros_like(slope)
    basis = np.eye(len(slope))
    if len(equalities):
        shift = np.linalg.lstsq(equalities, -point.rows[1 + m :], rcond=1e-12)[0]
        basis = null_space(equalities, len(slope))
    inner, prices = quadratic_programme(
        basis.T @ hessian @ basis,
        basis.T @ (slope + hessian @ shift),
        rows.gradients @ basis,
        rows.margins + rows.gradients @ shift,
    )
    constraint_prices = prices[: len(rows.constraint)]
    equality_prices = np.abs(equality_multipliers) / scale
    highest = max(constraint_prices.max(initial=0.0), equality_prices.max(initial=0.0))
    return shift + basis @ inner, 2 * highest + 1.0


def _hessian_of_step(evaluator: Evaluator, state: NewtonState, curved: Evaluator) -> Vector:
    """Scaled convex Hessian for a Newton step.

    Where every limit with a multiplier is reached, only the directions along these limits count,
    which are few; elsewhere the whole Hessian is computed.
    """
    m, active = evaluator.constraint_count, state.active
    significant = state.multipliers > SIGNIFICANT * state.scale
    if np.any(np.abs(active.margins[significant]) > REACHED):
        return convex_hessian(curved, state)
    equalities = evaluator.jacobian(state.point)[1 + m :]
    rows = np.concatenate([active.gradients[significant], equalities])
    free = null_space(rows, evaluator.space.size)
    products = curved.hessian_products(state.point, state.weights(m), free) / state.scale
    largest = float(state.multipliers.max(initial=0.0)) / state.scale
    return convex_matrix(free, products, largest)


FLATTEST = 1e-10
"""Least ratio of smallest to largest curvature; below it, mixed second derivatives are dropped."""
LEAST = 1e-6
"""Least curvature, relative to the largest multiplier."""


def convex_matrix(z: Vector, products: Vector, largest: float) -> Vector:
    """A positive definite matrix (nf, nf) whose products with the vectors z are `products` (nf, d).

    The columns of z (nf, d) are orthonormal; `largest` is the largest multiplier, which scales the
    least curvature.
    """
    size = len(z)
    if z.shape[1] == 0:
        return np.eye(size)
    values, vectors = np.linalg.eigh(z.T @ products + products.T @ z)
    values = np.maximum(np.abs(values) / 2, LEAST * max(largest, 1e-3))
    inner = (vectors * values) @ vectors.T
    across = products - z @ (z.T @ products)
    complement = np.eye(size) - z @ z.T
    crossed = across @ np.linalg.solve(inner, across.T)
    stiffness = 1.0 + float(np.linalg.norm(crossed, 2))
    matrix = np.asarray(z @ inner @ z.T + across @ z.T + z @ across.T + stiffness * complement)
    curvatures = np.linalg.eigvalsh(matrix)
    return (
        matrix
        if curvatures[0] > FLATTEST * curvatures[-1]
        else np.asarray(z @ inner @ z.T + complement)
    )


def convex_hessian(evaluator: Evaluator, state: NewtonState) -> Vector:
    """Scaled Hessian of the Lagrangian, made positive definite with little effect on the step.

    Multiples of the active gradients' outer products are added, which keeps the solution on the
    active limits. If they are not enough, a negative curvature is replaced by its magnitude.
    """
    active = state.active
    significant = state.multipliers > SIGNIFICANT * state.scale
    a, b = len(active.constraint), len(active.constraint) + len(active.lower)
    at_limit = active.margins <= REACHED
    binding = significant & at_limit
    fixed = np.concatenate([active.lower[binding[a:b]], active.upper[binding[b:]]])
    columns = np.setdiff1d(np.arange(evaluator.space.size), fixed)
    weights = state.weights(evaluator.constraint_count)
    hessian = evaluator.hessian(state.point, weights, columns) / state.scale
    size = max(float(np.abs(hessian).max(initial=0.0)), 1e-3)
    hessian[fixed, fixed] = size
    floor = 1e-7 * size
    rows = active.gradients[significant]
    rows = rows / np.sqrt((rows**2).sum(axis=1, keepdims=True))
    for weight in (0.0, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0, 1e3):
        convex = hessian + weight * size * (rows.T @ rows)
        if np.linalg.eigvalsh(convex)[0] > floor:
            return np.asarray(convex)
    values, vectors = np.linalg.eigh(hessian)
    return np.asarray((vectors * np.maximum(np.abs(values), floor)) @ vectors.T)


def quadratic_programme(
    hessian: Vector, slope: Vector, rows: Vector, margins: Vector, previous: Vector | None = None
) -> tuple[Vector, Vector]:
    """Minimise d'Hd/2 + slope'd for a step d with margins + rows d >= 0, where H is the Hessian.

    Returns the step and the multipliers (a,) of the rows. If no step satisfies all rows, the step
    with the least violation results. `previous` has the multipliers of a similar programme, which
    only save time.
    """
    factor = np.linalg.cholesky(hessian)
    scaled_slope = np.linalg.solve(factor, slope)
    prices = np.zeros(len(margins))
    if len(margins) == 0:
        return -np.linalg.solve(factor.T, scaled_slope), prices
    scaled_rows = np.linalg.solve(factor, rows.T).T
    needed = scaled_rows @ scaled_slope - margins
    length = np.sqrt((scaled_rows**2).sum(axis=1))
    useful = length > 1e-12
    scaled_rows = scaled_rows[useful] / length[useful, None]
    needed = needed[useful] / length[useful]
    unit = np.zeros(len(slope) + 1)
    unit[-1] = 1.0
    stacked = np.concatenate([scaled_rows.T, needed[None, :]])
    weights = nnls(stacked, unit, None if previous is None else previous[useful])
    residual = stacked @ weights - unit
    if -residual[-1] <= 1e-12:  # the rows contradict each other
        missed = -margins
        violated = missed > 0
        step = np.linalg.lstsq(rows[violated], missed[violated], rcond=1e-8)[0]
        return np.asarray(step, dtype=float), prices
    held = weights > 0  # solved again: the residual is inexact if the curvatures differ widely
    nearest = np.linalg.lstsq(scaled_rows[held], needed[held], rcond=1e-10)[0]
    weights[held] = np.linalg.lstsq(scaled_rows[held].T, nearest, rcond=1e-10)[0]
    prices[useful] = weights / length[useful]
    return np.linalg.solve(factor.T, nearest - scaled_slope), prices
