"""Prices of the parameters of an optimum: value, range, and the check by re-solving.

The price of a parameter is the derivative of the Lagrangian [Fiacco1983]: exact for limits,
material data, pressures and bounds, whatever algebraic form the constraints take. Its range of
validity follows from the derivative of the optimum. Re-solving at plus and minus 10 % shows the
error of the straight line.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import kkt, movement
from .evaluator import Evaluator, Point
from .outcome import Solution
from .parameters import Responses, perturbed, responses, with_bounds
from .problem import ParametricProblem, Vector
from .resolve import ladder
from .resolve.steps import valley_at


@dataclass(frozen=True, slots=True)
class ParameterPrice:
    """The price of one parameter at an optimum; values in the units of the model.

    Parameters
    ----------
    parameter, value : the parameter and its present value
    price : change of the objective per unit of the parameter
    price_up, price_down : one-sided prices; they differ only at a degenerate vertex, and are
        infinite where the next step that way leaves no feasible point
    percent_per_percent : relative change of the objective per relative change of the parameter;
        None where the objective or the parameter is 0
    predicted_up, predicted_down : objective at +10 % and -10 % by the price; None where infinite
    resolved_up, resolved_down : the same re-optimised; None if infeasible or not requested
    holds_until : the nearest value of the parameter at which the active set changes; None where
        that is beyond -100 % and +100 %
    change : what changes there, "LABEL becomes active" or "LABEL stops being active"
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
    """Price every parameter, and every bound that costs, at the optimum.

    Parameters
    ----------
    parametric : the problem with its parameters
    solution : its optimum; an infeasible or undefined one has no prices
    change : relative change at which to predict and to re-solve
    resolve : whether to re-solve
    bounds : whether to price bounds too, as "NAME lower" and "NAME upper"
    """
    if solution.kkt is None or not solution.feasible:
        return ()
    evaluator = Evaluator(parametric.problem)
    point = evaluator.point(evaluator.space.to_z(solution.x))
    evaluator.check_gradients(point)
    quality = kkt.check(evaluator, point)
    found = movement.optimum(evaluator, point, quality)
    given = responses(parametric, evaluator, point, found.weights)
    if bounds:
        m = evaluator.constraint_count
        given = with_bounds(given, evaluator, found.multipliers[m:])
    moves, shifts = movement.movement(found, given)
    active = np.flatnonzero(found.margins <= kkt.ACTIVE)
    ends: list[tuple[float | None, float | None]] = [(None, None)] * len(given.values)
    if resolve and change:
        valleys = [
            valley_at(evaluator, one) for one in (point, *ladder.other_optima(evaluator, solution))
        ]
        solved = ladder.SolvedProblem(parametric, evaluator, valleys)
        ends = _ends(solved, given, moves, change)
    return _rows(
        evaluator,
        point,
        given,
        change,
        price=movement.lagrangian_slopes(found, given),
        sides=movement.one_sided(found, given, active),
        moves=moves,
        ends=ends,
        reach=movement.reach(found, given, moves, shifts),
    )


def _ends(
    solved: ladder.SolvedProblem, given: Responses, moves: Vector, change: float
) -> list[tuple[float | None, float | None]]:
    """Re-optimised objectives at +change and -change of every parameter; None where infeasible.

    Parameters
    ----------
    solved : the unchanged problem
    given : the parameters, bounds of variables included
    moves : derivative of the optimum by them (nf, q)
    change : relative
    """
    parametric, point = solved.parametric, solved.valleys[0].point
    objectives: dict[tuple[int, int], float | None] = {}
    tasks: dict[tuple[int, int], ladder.Task] = {}
    for k, value in enumerate(given.values.tolist()):
        for sign in (1, -1):
            if value == 0 or not given.matters(k):
                continue
            step = sign * change * value
            problem = perturbed(parametric, given.names[k], k, value + step)
            objectives[k, sign] = None
            if problem is None:
                continue
            parameters = None
            if k < len(parametric.parameters):
                parameters = parametric.parameters.copy()
                parameters[k] += step
            tasks[k, sign] = ladder.Task(problem, point.z + moves[:, k] * step, parameters)
    for pair, optimum in zip(tasks, ladder.resolve(solved, list(tasks.values())), strict=True):
        objectives[pair] = None if optimum is None else optimum.objective
    here = point.objective
    return [
        (objectives.get((k, 1), here), objectives.get((k, -1), here))
        for k in range(len(given.values))
    ]


def _rows(
    evaluator: Evaluator,
    point: Point,
    given: Responses,
    change: float,
    *,
    price: Vector,
    sides: Vector,
    moves: Vector,
    ends: list[tuple[float | None, float | None]],
    reach: list[tuple[float | None, str | None]],
) -> tuple[ParameterPrice, ...]:
    slope = evaluator.space.slope(point.x[:, None])
    moved = np.zeros((len(point.x), len(price)))
    moved[evaluator.space.free] = slope * moves
    objective = point.objective
    rows = []
    for k, (name, value) in enumerate(zip(given.names, given.values.tolist(), strict=True)):
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
                movement=moved[:, k],
            )
        )
    return tuple(rows)


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
