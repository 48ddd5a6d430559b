"""Prices of an optimum's parameters: value, range of validity, and check by re-solving.

The price of a parameter is the change of the optimal objective per unit of the parameter, which is
the derivative of the Lagrangian [Fiacco1983]. It is exact for limits, material data, pressures and
bounds, whatever the form of the constraints. The derivatives of the optimal design solve the
linearised optimality conditions [Fiacco1983]; they give the range in which the price is valid.
Re-optimising with the parameter changed by +10 % and -10 % shows the error of the straight-line
prediction.

At a degenerate vertex the multipliers are not unique but form a polytope. The prices of an increase
and of a decrease are then the largest and the smallest within this polytope [Gauvin1982].
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import field
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ..base.dataclass import dataclass
from . import kinks, kkt
from .actuator import Responses, perturbed, responses, with_bounds
from .evaluator import Evaluator, Point
from .problem import ParametricProblem, Vector
from .resolve import ladder
from .resolve.steps import valley_at
from .solution import Solution

INSTANT = 1e-7
"""Change of an active margin, per relative change of the parameter, that counts as zero."""
BASES = 1000
"""Maximum number of vertices of the multipliers' polytope that are enumerated; if there are more,
linear programming is used."""


@dataclass(frozen=True)
class Optimum:
    """Vectors and matrices at an optimum.

    The M margins are those of the constraints, then of the lower and of the upper bounds. The
    number of free variables is nf.

    Parameters
    ----------
    margins, multipliers : margins (M,) and their multipliers
    gradients : gradients of the margins (M, nf)
    equalities : gradients of the equalities (e, nf)
    equality_multipliers : multipliers of the equalities (e,)
    slope : gradient of the objective (nf,)
    hessian : Hessian of the Lagrangian (nf, nf)
    labels : labels of the margins
    weights : factors of objective, constraints and equalities in the Lagrangian
    """

    margins: Vector
    multipliers: Vector
    gradients: Vector
    equalities: Vector
    equality_multipliers: Vector
    slope: Vector
    hessian: Vector
    labels: tuple[str, ...]
    weights: Vector

    @property
    def active(self) -> npt.NDArray[np.intp]:
        """Indices of the margins whose multiplier is positive."""
        size = self.multipliers * np.sqrt((self.gradients**2).sum(axis=1))
        return np.flatnonzero(size > 1e-10 * max(float(np.linalg.norm(self.slope)), 1e-300))


def optimum_at(evaluator: Evaluator, point: Point, quality: kkt.KktResidual) -> Optimum:
    """Collect margins, gradients, multipliers and the Hessian at an optimum."""
    space, m = evaluator.space, evaluator.constraint_count
    jacobian, unit = evaluator.jacobian(point), np.eye(evaluator.space.size)
    weights = kkt.lagrangian_weights(quality.multipliers, quality.equality_multipliers)
    names = [evaluator.problem.names[j] for j in space.free]
    return Optimum(
        margins=np.concatenate(
            [point.rows[1 : 1 + m], point.z - space.lower, space.upper - point.z]
        ),
        multipliers=np.concatenate(
            [
                quality.multipliers,
                quality.lower_multipliers[space.free],
                quality.upper_multipliers[space.free],
            ]
        ),
        gradients=np.concatenate([jacobian[1 : 1 + m], unit, -unit]),
        equalities=jacobian[1 + m :],
        equality_multipliers=quality.equality_multipliers,
        slope=jacobian[0],
        hessian=evaluator.hessian(point, weights, np.arange(space.size)),
        labels=(
            *evaluator.problem.constraint_names,
            *(f"{name} lower" for name in names),
            *(f"{name} upper" for name in names),
        ),
        weights=weights,
    )


def margin_slopes(optimum: Optimum, derivatives: Responses) -> Vector:
    """Derivatives (M, q) of the margins with respect to the parameters, at fixed variables."""
    m = len(optimum.margins) - len(derivatives.bounds)
    return np.concatenate([derivatives.rows[1 : 1 + m], derivatives.bounds])


def lagrangian_slopes(optimum: Optimum, derivatives: Responses) -> Vector:
    """Price of every parameter (q,): derivative of the Lagrangian."""
    m = len(optimum.margins) - len(derivatives.bounds)
    return optimum.weights @ derivatives.rows - optimum.multipliers[m:] @ derivatives.bounds


def movement(optimum: Optimum, derivatives: Responses) -> tuple[Vector, Vector]:
    """Change of the optimal point (nf, q) and multipliers (M, q) per unit of the parameters.

    The optimum is assumed not to move along directions in which neither objective nor limits
    curve.
    """
    active, nf = optimum.active, len(optimum.slope)
    rows = np.concatenate([optimum.gradients[active], optimum.equalities])
    explicit = np.concatenate(
        [
            margin_slopes(optimum, derivatives)[active],
            derivatives.rows[len(derivatives.rows) - len(optimum.equalities) :],
        ]
    )
    # scaled system on the active rows: d(gradient of the Lagrangian) = 0 and d(margin) = 0
    size = np.sqrt((rows**2).sum(axis=1))
    size = np.where(size > 0, size, 1.0)
    scale = max(float(np.linalg.norm(optimum.slope)), 1e-300)
    rows, explicit = rows / size[:, None], explicit / size[:, None]
    system = np.block([[optimum.hessian / scale, -rows.T], [rows, np.zeros((len(rows),) * 2)]])
    right = -np.concatenate([derivatives.mixed / scale, explicit])
    solution = np.linalg.lstsq(system, right, rcond=1e-11)[0]
    shifts = np.zeros((len(optimum.margins), right.shape[1]))
    shifts[active] = solution[nf : nf + len(active)] * scale / size[: len(active), None]
    return solution[:nf], shifts


@dataclass(frozen=True)
class LinearOptimum:
    """An optimum on a smooth piece, as a linear function of the parameters.

    Parameters
    ----------
    optimum : the optimum
    derivatives : derivatives of all results with respect to the parameters
    moves, shifts : change of the optimal point and of the multipliers, see `movement`
    """

    optimum: Optimum
    derivatives: Responses
    moves: Vector = field(init=False)
    shifts: Vector = field(init=False)

    def __post_init__(self) -> None:
        moves, shifts = movement(self.optimum, self.derivatives)
        object.__setattr__(self, "moves", moves)
        object.__setattr__(self, "shifts", shifts)


def slopes(pieces: Sequence[LinearOptimum]) -> Vector:
    """Price (2, q) of a decrease and of an increase of each parameter.

    The optimum moves to the piece on which it costs least, see `kinks`.
    """
    sides = [
        one_sided(x.optimum, x.derivatives, np.flatnonzero(x.optimum.margins <= kkt.ACTIVE))
        for x in pieces
    ]
    below, above = np.stack(sides, axis=1)
    return np.stack([below.max(axis=0), above.min(axis=0)])


def reach(pieces: Sequence[LinearOptimum]) -> list[tuple[float | None, str | None]]:
    """For each parameter, the nearest value at which the active limits change, and that change.

    Both are None if the active limits do not change while the parameter changes by up to ±100 %.
    """
    result: list[tuple[float | None, str | None]] = []
    for value, changes in zip(pieces[0].derivatives.values, _changes(pieces), strict=True):
        nearest = min(changes, key=lambda change: abs(change.distance), default=None)
        if nearest is None or abs(nearest.distance) > (abs(value) if value else 1.0):
            result.append((None, None))
        else:
            result.append((float(value + nearest.distance), nearest.text))
    return result


class ActiveSetChange(NamedTuple):
    """A change of the active limits: by how much and in which direction the parameter must change.

    The direction matters at distance 0. A limit that is just met, without a multiplier, becomes
    active on one side only.
    """

    distance: float
    direction: int
    text: str


def ends(
    pieces: Sequence[LinearOptimum],
) -> list[tuple[ActiveSetChange | None, ActiveSetChange | None]]:
    """For each parameter, the nearest changes of active limits below and above its value."""
    return [
        (
            min((change for change in changes if change.direction < 0), key=_size, default=None),
            min((change for change in changes if change.direction > 0), key=_size, default=None),
        )
        for changes in _changes(pieces)
    ]


def _size(change: ActiveSetChange) -> float:
    return abs(change.distance)


def _changes(pieces: Sequence[LinearOptimum]) -> list[list[ActiveSetChange]]:
    """For each parameter, the changes of active limits on all pieces."""
    return [
        list(itertools.chain(*changes)) for changes in zip(*map(_changes_on, pieces), strict=True)
    ]


def _changes_on(piece: LinearOptimum) -> Iterator[list[ActiveSetChange]]:
    """For each parameter, its changes at which a linearised margin or multiplier reaches zero."""
    optimum, derivatives, shifts = piece.optimum, piece.derivatives, piece.shifts
    rates = margin_slopes(optimum, derivatives) + optimum.gradients @ piece.moves
    active = optimum.active
    for k, value in enumerate(derivatives.values):
        changes: list[ActiveSetChange] = []
        reference = abs(value) if value else 1.0
        for i, label in enumerate(optimum.labels):
            if i in active:
                level, rate, event = optimum.multipliers[i], shifts[i, k], "stops being active"
            else:
                level, rate, event = max(optimum.margins[i], 0.0), rates[i, k], "becomes active"
            if abs(rate) * reference <= INSTANT * max(level, 1.0 if i not in active else 0.0):
                continue
            direction = -1 if rate > 0 else 1
            changes.append(ActiveSetChange(-level / rate, direction, f"{label} {event}"))
        yield changes


def one_sided(optimum: Optimum, derivatives: Responses, active: npt.NDArray[np.intp]) -> Vector:
    """Smallest and largest price (2, q) among all multipliers that the optimum admits."""
    margins = _without_copies(optimum, derivatives, active)
    rows = np.concatenate([optimum.gradients[margins], optimum.equalities])
    count, e = len(rows), len(optimum.equalities)
    size = np.sqrt((rows**2).sum(axis=1))
    size = np.where(size > 0, size, 1.0)
    rank = int(np.linalg.matrix_rank(rows / size[:, None], tol=1e-8)) if count else 0
    slopes = np.concatenate(
        [
            margin_slopes(optimum, derivatives)[margins],
            derivatives.rows[len(derivatives.rows) - e :],
        ]
    )
    single = lagrangian_slopes(optimum, derivatives)
    if rank == count:
        return np.stack([single, single])
    target = rows.T @ np.concatenate([optimum.multipliers[margins], optimum.equality_multipliers])
    if rank >= e and math.comb(count - e, rank - e) <= BASES:
        vertices = _vertices(rows / size[:, None], target, rank, e) / size
        vertices = np.concatenate(
            [
                vertices,
                [np.concatenate([optimum.multipliers[margins], optimum.equality_multipliers])],
            ]
        )
        all_prices = derivatives.rows[0] - vertices @ slopes
        return np.stack([all_prices.min(axis=0), all_prices.max(axis=0)])
    return _by_linear_programming(rows, target, slopes, derivatives.rows[0], e)


def _without_copies(
    optimum: Optimum, derivatives: Responses, active: npt.NDArray[np.intp]
) -> npt.NDArray[np.intp]:
    """Active margins without exact duplicates, such as the same limit in two load cases.

    Only duplicates without a multiplier are dropped: of several equal margins, least squares gives
    a multiplier to at most one.
    """
    slopes = np.concatenate([optimum.gradients, margin_slopes(optimum, derivatives)], axis=1)
    indices: list[int] = []
    order = sorted(active, key=lambda i: (optimum.multipliers[i] <= 0, i))
    for i in order:
        size = 1e-9 * np.abs(slopes[i]).max(initial=1e-300)
        if optimum.multipliers[i] > 0 or not any(
            (np.abs(slopes[i] - slopes[j]) <= size).all() for j in indices
        ):
            indices.append(int(i))
    return np.array(sorted(indices), dtype=np.intp)


def _vertices(rows: Vector, target: Vector, rank: int, free_count: int) -> Vector:
    """Vertices of the set of all m with rows.T @ m = target; each row is one vertex.

    Only the last `free_count` entries of m may be negative.
    """
    count = len(rows)
    vertices = []
    for combination in itertools.combinations(range(count - free_count), rank - free_count):
        basis = [*combination, *range(count - free_count, count)]
        part, _, part_rank, _ = np.linalg.lstsq(rows[basis].T, target, rcond=1e-10)
        fits = np.linalg.norm(rows[basis].T @ part - target) <= 1e-8 * np.linalg.norm(target)
        if (
            part_rank == rank
            and fits
            and (part[: len(combination)] >= -1e-9 * np.abs(part).max()).all()
        ):
            vertex = np.zeros(count)
            vertex[basis] = part
            vertices.append(vertex)
    return np.array(vertices).reshape(len(vertices), count)


def _by_linear_programming(
    rows: Vector, target: Vector, slopes: Vector, objective: Vector, free_count: int
) -> Vector:
    from scipy.optimize import linprog  # slow import, rarely needed

    limits = [(0, None)] * (len(rows) - free_count) + [(None, None)] * free_count
    result = np.empty((2, slopes.shape[1]))
    for k in range(slopes.shape[1]):
        for side, sign in ((0, 1.0), (1, -1.0)):
            solution = linprog(-sign * slopes[:, k], A_eq=rows.T, b_eq=target, bounds=limits)
            # an unbounded price means that no point in this direction is feasible
            value = -np.inf if solution.fun is None else float(solution.fun)
            result[side, k] = objective[k] + sign * value
    return result


@dataclass(frozen=True, slots=True)
class ParameterPrice:
    """The price of a parameter at an optimum; values are in the units of the model.

    Parameters
    ----------
    parameter, value : the parameter and its present value
    price : change of the objective per unit of the parameter
    price_up, price_down : one-sided prices, which differ only at a degenerate vertex; infinite if
        no feasible point exists in this direction
    percent_per_percent : relative change of the objective per relative change of the parameter;
        None where the objective or the parameter is 0
    predicted_up, predicted_down : objective predicted from the price, with the parameter changed by
        +10 % and -10 %; None where infinite
    resolved_up, resolved_down : objective of the optimum for the same changes; None if infeasible
        or not requested
    holds_until : the nearest value of the parameter at which the active limits change; None if it
        is more than ±100 % away
    change : the change of the active limits in words, "LABEL becomes active" or "LABEL stops being
        active"
    movement : change of each variable (n,) per unit of the parameter
    """

    parameter: str
    value: float
    price: float
    price_up: float
    price_down: float
    percent_per_percent: float | None
    predicted_up: float | None
    predicted_down: float | None
    resolved_up: float | None
    resolved_down: float | None
    holds_until: float | None
    change: str | None
    movement: Vector


def prices(
    parametric: ParametricProblem,
    solution: Solution,
    *,
    change: float = 0.1,
    resolve: bool = True,
    bounds: bool = True,
) -> tuple[ParameterPrice, ...]:
    """Price every parameter, and every bound with a positive multiplier, at the optimum.

    Parameters
    ----------
    parametric : the problem with its parameters
    solution : its optimum; an infeasible or undefined solution has no prices
    change : relative change for prediction and re-solving
    resolve : whether to re-solve
    bounds : whether to price bounds of variables, as "NAME lower" and "NAME upper"
    """
    if solution.kkt is None or not solution.feasible:
        return ()
    evaluator = Evaluator(parametric.problem)
    point = evaluator.point(evaluator.space.to_z(solution.x))
    evaluator.check_gradients(point)
    pieces: list[LinearOptimum] = []
    for piece in kinks.pieces(parametric, evaluator, point):
        optimum = optimum_at(piece.evaluator, piece.point, piece.quality)
        derivatives = responses(piece.parametric, piece.evaluator, piece.point, optimum.weights)
        if bounds:
            priced = pieces[0].optimum if pieces else optimum
            multipliers = priced.multipliers[piece.evaluator.constraint_count :]
            derivatives = with_bounds(derivatives, evaluator, multipliers)
        pieces.append(LinearOptimum(optimum, derivatives))
    first = pieces[0]
    ends: list[tuple[float | None, float | None]] = [(None, None)] * len(first.derivatives.values)
    if resolve and change:
        valleys = [
            valley_at(evaluator, p) for p in (point, *ladder.other_optima(evaluator, solution))
        ]
        solved = ladder.SolvedProblem(parametric, evaluator, valleys)
        ends = _ends(solved, first.derivatives, first.moves, change)
    return _rows(
        evaluator,
        point,
        first.derivatives,
        change,
        price=lagrangian_slopes(first.optimum, first.derivatives),
        sides=slopes(pieces),
        moves=first.moves,
        ends=ends,
        reach=reach(pieces),
    )


def _ends(
    solved: ladder.SolvedProblem, derivatives: Responses, moves: Vector, change: float
) -> list[tuple[float | None, float | None]]:
    """Re-optimised objectives at +change and -change of every parameter; None where infeasible.

    Parameters
    ----------
    solved : the unchanged problem
    derivatives : derivatives with respect to the parameters, which include the bounds of variables
    moves : derivatives of the optimum with respect to the parameters (nf, q)
    change : relative change
    """
    parametric, point = solved.parametric, solved.valleys[0].point
    objectives: dict[tuple[int, int], float | None] = {}
    tasks: dict[tuple[int, int], ladder.ResolveTask] = {}
    for k, value in enumerate(derivatives.values.tolist()):
        for sign in (1, -1):
            if value == 0 or not derivatives.matters(k):
                continue
            step = sign * change * value
            problem = perturbed(parametric, derivatives.names[k], k, value + step)
            objectives[k, sign] = None
            if problem is None:
                continue
            parameters = None
            if k < len(parametric.parameters):
                parameters = parametric.parameters.copy()
                parameters[k] += step
            tasks[k, sign] = ladder.ResolveTask(problem, point.z + moves[:, k] * step, parameters)
    for pair, optimum in zip(tasks, ladder.resolve(solved, list(tasks.values())), strict=True):
        objectives[pair] = None if optimum is None else optimum.objective
    present = point.objective
    return [
        (objectives.get((k, 1), present), objectives.get((k, -1), present))
        for k in range(len(derivatives.values))
    ]


def _rows(
    evaluator: Evaluator,
    point: Point,
    derivatives: Responses,
    change: float,
    *,
    price: Vector,
    sides: Vector,
    moves: Vector,
    ends: list[tuple[float | None, float | None]],
    reach: list[tuple[float | None, str | None]],
) -> tuple[ParameterPrice, ...]:
    slope = evaluator.space.slope(point.x[:, None])
    x_moves = np.zeros((len(point.x), len(price)))
    x_moves[evaluator.space.free] = slope * moves
    objective = point.objective
    rows = []
    for k, (name, value) in enumerate(
        zip(derivatives.names, derivatives.values.tolist(), strict=True)
    ):
        below, above = float(sides[0, k]), float(sides[1, k])
        step = change * value
        first, second = (above, below) if step >= 0 else (below, above)
        relative = float(price[k]) * value / objective if objective and value else None
        rows.append(
            ParameterPrice(
                parameter=name,
                value=value,
                price=float(price[k]),
                price_up=above,
                price_down=below,
                percent_per_percent=relative,
                predicted_up=finite(objective + first * step),
                predicted_down=finite(objective - second * step),
                resolved_up=ends[k][0],
                resolved_down=ends[k][1],
                holds_until=reach[k][0],
                change=reach[k][1],
                movement=x_moves[:, k],
            )
        )
    return tuple(rows)


def finite(value: float) -> float | None:
    """The value; None if it is not finite."""
    return value if np.isfinite(value) else None
