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
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, field
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from ..base.dataclass import dataclass
from ..base.numeric import STEP
from ..base.quantities import Quantity, short
from ..base.units import unit
from ..evaluation.influences import NO_PERCENT, input_quantity
from . import kkt
from .actuator import ActuatorProblem, Responses, perturbed, responses, with_bounds
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


def reach(
    optimum: Optimum, derivatives: Responses, moves: Vector, shifts: Vector
) -> list[tuple[float | None, str | None]]:
    """For each parameter, the nearest value at which the active limits change, and that change.

    Both are None if the active limits do not change while the parameter changes by up to ±100 %.
    """
    result: list[tuple[float | None, str | None]] = []
    for value, changes in zip(
        derivatives.values, _changes(optimum, derivatives, moves, shifts), strict=True
    ):
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
    optimum: Optimum, derivatives: Responses, moves: Vector, shifts: Vector
) -> list[tuple[ActiveSetChange | None, ActiveSetChange | None]]:
    """For each parameter, the nearest changes of active limits below and above its value."""
    return [
        (
            min((change for change in changes if change.direction < 0), key=_size, default=None),
            min((change for change in changes if change.direction > 0), key=_size, default=None),
        )
        for changes in _changes(optimum, derivatives, moves, shifts)
    ]


def _size(change: ActiveSetChange) -> float:
    return abs(change.distance)


def _changes(
    optimum: Optimum, derivatives: Responses, moves: Vector, shifts: Vector
) -> Iterator[list[ActiveSetChange]]:
    """For each parameter, its changes at which a linearised margin or multiplier reaches zero."""
    rates = margin_slopes(optimum, derivatives) + optimum.gradients @ moves
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


CHANGE = 0.1
"""Relative change of a parameter for which the price's prediction is checked by re-solving."""
STRAIGHT = 0.25
"""Largest error, as a share of the re-solved change, with which a straight-line prediction counts
as good."""
Kind: TypeAlias = Literal["requirement", "parameter", "material"]
"""A limit that can be negotiated, a fixed number of the design, or a material property."""


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """The price of one limit or parameter, in SI units of objective and parameter.

    Parameters
    ----------
    parameter : PATH
    label : name of the parameter's quantity
    unit : display unit of the parameter
    scale : display value = SI value / scale
    limit : present value
    price : change of the objective per unit of the parameter
    percent_per_percent : relative change of the objective per relative change of the parameter;
        None if the objective or the parameter is 0
    predicted_10, resolved_10, predicted_minus10, resolved_minus10 : the objective with the
        parameter changed by +10 % and -10 %, predicted from the price or re-optimised; None if no
        design exists
    holds_until : value of the parameter up to which the same limits are active; None if it is more
        than ±100 % away
    next_active : the limit that becomes active, or stops being active, at the value `holds_until`
    active : whether the limit is active at the optimum
    price_up, price_down : prices of an increase and of a decrease, which differ only at a
        degenerate vertex; None if no design exists in this direction
    movement : change of each variable at the optimum per unit of the parameter, by PATH
    """

    parameter: str
    label: str
    unit: str
    scale: float
    limit: float
    price: float
    percent_per_percent: float | None
    predicted_10: float | None
    resolved_10: float | None
    predicted_minus10: float | None
    resolved_minus10: float | None
    holds_until: float | None
    next_active: str | None
    active: bool
    price_up: float | None
    price_down: float | None
    movement: Mapping[str, float] = field(default_factory=dict)

    @property
    def kind(self) -> Kind:
        """Whether the parameter is a limit, a number of the design, or a material property."""
        root = self.parameter.partition(".")[0].partition("[")[0]
        if root in ("requirements", "load_cases", "duty"):
            return "requirement"
        return "material" if root == "materials" else "parameter"

    @property
    def ends(self) -> tuple[tuple[int, float | None, float | None], ...]:
        """For +10 % and -10 %: sign, predicted objective, re-solved objective.

        Empty for a limit of 0.
        """
        if self.limit == 0:
            return ()
        return (
            (1, self.predicted_10, self.resolved_10),
            (-1, self.predicted_minus10, self.resolved_minus10),
        )

    @property
    def one_sided(self) -> bool:
        """Whether an increase and a decrease have different prices."""
        up, down = self.price_up, self.price_down
        if up is None or down is None:
            return up is not down
        return abs(up - down) > 1e-6 * max(abs(up), abs(down))

    def effect(self, objective: float) -> float:
        """Largest re-solved change of the objective if the parameter changes by +10 % or -10 %."""
        changes = [abs(solved - objective) for _, _, solved in self.ends if solved is not None]
        return max(changes, default=0.0)

    def straight(self, objective: float) -> bool:
        """Whether the price predicts the changes of the objective at ±10 % to within a quarter."""
        for _, predicted, solved in self.ends:
            if predicted is None or solved is None:
                if predicted is not solved:
                    return False
                continue
            larger = max(abs(solved - objective), abs(predicted - objective))
            if abs(predicted - solved) > STRAIGHT * larger + 1e-9 * abs(objective):
                return False
        return True

    def to_dict(self, objective: float) -> dict[str, Any]:
        """The row in JSON (SI)."""
        result = asdict(self)
        for name in ("label", "unit", "scale"):
            del result[name]
        return result | {"kind": self.kind, "straight": self.straight(objective)}


def ranked(rows: Sequence[Sensitivity], objective: float) -> tuple[Sensitivity, ...]:
    """Rows sorted by their re-solved effect on the objective, the largest first."""
    return tuple(
        sorted(rows, key=lambda r: (-r.effect(objective), -abs(r.percent_per_percent or 0.0)))
    )


@dataclass(frozen=True, slots=True)
class Offer:
    """Change of one parameter by 10 %, up or down, that improves the objective by `gain` (SI)."""

    row: Sensitivity
    change: float
    value: float
    objective: float
    gain: float

    def to_dict(self) -> dict[str, Any]:
        """The offer in JSON (SI)."""
        values = {name: getattr(self, name) for name in ("change", "value", "objective", "gain")}
        return {"parameter": self.row.parameter} | values


@dataclass(frozen=True, slots=True)
class Offers:
    """The most valuable change by 10 % of each kind of parameter; None if no change is worthwhile.

    `no_design` lists the requirements which, changed by 10 %, leave no feasible design, with the
    sign of that change.
    """

    requirement: Offer | None
    parameter: Offer | None
    material: Offer | None
    no_design: tuple[tuple[Sensitivity, int], ...]

    @property
    def found(self) -> tuple[Offer, ...]:
        """The changes that are not None, requirements first."""
        existing = (self.requirement, self.parameter, self.material)
        return tuple(offer for offer in existing if offer is not None)

    def to_dict(self) -> dict[str, Any]:
        """The "what_buys_most" of `optimise --json` (SI), except for its sentence."""
        kinds = ("requirement", "parameter", "material")
        best_offers = {name: getattr(self, name) for name in kinds}
        return {
            name: None if offer is None else offer.to_dict() for name, offer in best_offers.items()
        } | {
            "no_design": [
                {"parameter": row.parameter, "change": sign * CHANGE}
                for row, sign in self.no_design
            ]
        }


def offers(rows: Sequence[Sensitivity], objective: float, *, maximised: bool) -> Offers:
    """For each kind of parameter, the best re-solved change by 10 %, if it improves the optimum."""
    direction = 1.0 if maximised else -1.0
    best: dict[Kind, Offer] = {}
    infeasible = []
    for row in rows:
        for sign, _, solved in row.ends:
            if solved is None:
                if row.kind == "requirement":
                    infeasible.append((row, sign))
                continue
            gain = direction * (solved - objective)
            rival = best.get(row.kind)
            if gain > 1e-6 * abs(objective) and (rival is None or gain > rival.gain):
                value = row.limit * (1 + sign * CHANGE)
                best[row.kind] = Offer(row, sign * CHANGE, value, solved, gain)
    return Offers(
        best.get("requirement"), best.get("parameter"), best.get("material"), tuple(infeasible)
    )


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
    quality = kkt.check(evaluator, point)
    optimum = optimum_at(evaluator, point, quality)
    derivatives = responses(parametric, evaluator, point, optimum.weights)
    if bounds:
        m = evaluator.constraint_count
        derivatives = with_bounds(derivatives, evaluator, optimum.multipliers[m:])
    moves, shifts = movement(optimum, derivatives)
    active = np.flatnonzero(optimum.margins <= kkt.ACTIVE)
    ends: list[tuple[float | None, float | None]] = [(None, None)] * len(derivatives.values)
    if resolve and change:
        valleys = [
            valley_at(evaluator, p) for p in (point, *ladder.other_optima(evaluator, solution))
        ]
        solved = ladder.SolvedProblem(parametric, evaluator, valleys)
        ends = _ends(solved, derivatives, moves, change)
    return _rows(
        evaluator,
        point,
        derivatives,
        change,
        price=lagrangian_slopes(optimum, derivatives),
        sides=one_sided(optimum, derivatives, active),
        moves=moves,
        ends=ends,
        reach=reach(optimum, derivatives, moves, shifts),
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
                predicted_up=_finite(objective + first * step),
                predicted_down=_finite(objective - second * step),
                resolved_up=ends[k][0],
                resolved_down=ends[k][1],
                holds_until=reach[k][0],
                change=reach[k][1],
                movement=x_moves[:, k],
            )
        )
    return tuple(rows)


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


MOST_PARAMETERS = 10
"""Maximum number of parameters (besides limits) in the sensitivity table, the most important first.
"""
LEAST_EFFECT = 1e-3
"""A parameter enters the table if its change by 1 % changes the objective by at least this many
per cent."""
FREE = 1e-9
"""A limit whose value is 0 is left out if its price, relative to the objective, is at most this."""


def sensitivities(actuator: ActuatorProblem, solution: Solution) -> tuple[Sensitivity, ...]:
    """Prices of the limits, and of the parameters with the largest effect on the objective."""
    active = _active_limits(actuator, solution)
    limits = dict.fromkeys(
        row.limit_of.path
        for row in actuator.rows
        if row.limit_of.path is not None
        and (row.limit_of.origin in ("requirement", "case") or row.limit_of.path in active)
    )
    paths = (*limits, *_strongest(actuator, solution, set(limits)))
    numbers = actuator.subject.numbers
    paths = tuple(path for path in paths if path in numbers and (numbers[path] or path in active))
    parameter_prices = prices(actuator.parametric(paths), solution, change=CHANGE, bounds=False)
    shown = actuator.goal.shown
    rows = []
    for price in parameter_prices:
        if price.value == 0 and abs(price.price) <= FREE * abs(solution.objective):
            continue
        quantity = _quantity(actuator, price.parameter)
        rows.append(
            Sensitivity(
                parameter=price.parameter,
                label=quantity.label,
                unit=quantity.unit,
                scale=unit(quantity.unit, quantity.dimension).scale if quantity.unit else 1.0,
                limit=price.value,
                price=shown(price.price),
                percent_per_percent=price.percent_per_percent,
                predicted_10=_shown(shown, price.predicted_up),
                resolved_10=_shown(shown, price.resolved_up),
                predicted_minus10=_shown(shown, price.predicted_down),
                resolved_minus10=_shown(shown, price.resolved_down),
                holds_until=price.holds_until,
                next_active=price.change,
                active=price.parameter in active,
                price_up=_finite(shown(price.price_up)),
                price_down=_finite(shown(price.price_down)),
                movement=dict(zip(actuator.paths, price.movement.tolist(), strict=True)),
            )
        )
    return ranked(rows, shown(solution.objective))


def _shown(display: Callable[[float], float], value: float | None) -> float | None:
    return None if value is None else display(value)


def _active_limits(actuator: ActuatorProblem, solution: Solution) -> set[str]:
    labels = set(solution.kkt.active) if solution.kkt is not None else set()
    return {
        row.limit_of.path
        for row in actuator.rows
        if row.label in labels and row.limit_of.path is not None
    }


def _quantity(actuator: ActuatorProblem, path: str) -> Quantity:
    if path.startswith("requirements."):
        return actuator.subject.quantities[path.removeprefix("requirements.").rpartition(".")[0]]
    return input_quantity(path, actuator.subject.design)


def _strongest(
    actuator: ActuatorProblem, solution: Solution, excluded: set[str]
) -> tuple[str, ...]:
    """The parameters to which the objective is most sensitive by the Lagrangian's derivatives."""
    if solution.kkt is None:
        return ()
    candidates = [
        path
        for path in actuator.fixed_numbers(solution.x)
        if path not in excluded
        and not path.startswith("requirements.")
        and _quantity(actuator, path).dimension not in NO_PERCENT
    ]
    if not candidates:
        return ()
    values = actuator.number_steps(solution.x, candidates)
    slope = np.imag(values.objective) - solution.kkt.multipliers @ np.imag(values.constraints)
    elasticity = np.nan_to_num(slope / STEP / abs(solution.objective or 1.0))
    order = np.argsort(-np.abs(elasticity), kind="stable")
    return tuple(
        candidates[i] for i in order[:MOST_PARAMETERS] if abs(elasticity[i]) >= LEAST_EFFECT
    )


PER_CENT = round(100 * CHANGE)


def display_of(row: Sensitivity, value: float | None) -> float | None:
    """A value of a row's parameter in its display unit; None for no value."""
    if value is None:
        return None
    offset = 273.15 if row.unit in ("degC", "°C") else 0.0
    return value / row.scale - offset


def short_name(row: Sensitivity) -> str:
    """A PATH shortened for use in a sentence: "stiffness_min", "density of ti_6al4v".

    >>> from types import SimpleNamespace as Row
    >>> short_name(Row(parameter="requirements.stiffness_min.min"))
    'stiffness_min'
    >>> short_name(Row(parameter="materials.ti_6al4v.density"))
    'density of ti_6al4v'
    """
    path = row.parameter
    if path.startswith("requirements."):
        return path.removeprefix("requirements.").rpartition(".")[0]
    if path.startswith("materials."):
        material, _, name = path.removeprefix("materials.").rpartition(".")
        return f"{name} of {material}"
    return path


def buys_most(
    best_offers: Offers, quantity: Quantity, objective: float, *, maximised: bool
) -> tuple[str, ...]:
    """Sentences on the most valuable changes, and on requirements that cannot be made stricter.

    Parameters
    ----------
    best_offers : the best change of each kind
    quantity, objective : the objective's quantity, and its value at the optimum (SI)
    maximised : whether a larger objective is better
    """

    def gain(offer: Offer) -> str:
        """The gain of a change in words: "saves 19.7 g (7.5 %)"."""
        per_display = quantity.to_display(1.0) - quantity.to_display(0.0)
        amount = f"{short(offer.gain * per_display, 3, full=True)} {quantity.unit}".rstrip()
        if objective:
            amount += f" ({short(100 * offer.gain / abs(objective), 2, full=True)} %)"
        return f"adds {amount}" if maximised else f"saves {amount}"

    if (best := best_offers.requirement) is not None:
        parts = [
            f"Relaxing {short_name(best.row)} by {PER_CENT} % (to {_at(best.row, best.value)}) "
            f"{gain(best)}, the most of any requirement."
        ]
    else:
        parts = [f"Relaxing any single requirement by {PER_CENT} % does not improve the objective."]
    for best, group in (
        (best_offers.parameter, "Among the design's fixed values"),
        (best_offers.material, "Among the material properties"),
    ):
        if best is not None:
            direction = "more" if best.change > 0 else "less"
            name, value = short_name(best.row), _at(best.row, best.value)
            parts.append(f"{group}, {PER_CENT} % {direction} {name} (to {value}) {gain(best)}.")
    if best_offers.no_design:
        infeasible = ", ".join(
            f"{short_name(row)} at {_at(row, row.limit * (1 + sign * CHANGE))}"
            for row, sign in best_offers.no_design
        )
        parts.append(f"The search found no feasible design with {infeasible}.")
    return tuple(parts)


def _at(row: Sensitivity, value: float) -> str:
    """A value of a row's parameter as text with its unit."""
    display = display_of(row, value)
    assert display is not None
    unit = "" if row.unit == "-" else row.unit
    return f"{short(display)} {unit}".rstrip()
