"""What each parameter of an optimum costs: prices, ranges, and the check by re-solving.

The price of a parameter is the derivative of the Lagrangian [Fiacco1983]: exact for limits,
material data, pressures and bounds alike, whatever algebraic form the constraints take. How far
it holds follows from the derivative of the optimum; re-solving at plus and minus 10 % tells how
much the straight line hides.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import elastic, kkt, lockstep, movement, nlopt_wrapper
from .evaluator import Evaluator, Point
from .newton import polish
from .outcome import Solution
from .parameters import Responses, perturbed, responses, with_bounds
from .problem import ParametricProblem, Problem, Vector

FEASIBLE = 1e-6
"""Worst missed margin that still counts as met."""

RESIDUAL = 1e-6
"""Residual of the optimality conditions that a re-solved optimum must reach."""


@dataclass(frozen=True, slots=True)
class Price:
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
    resolved_up, resolved_down : the same re-optimised; None where infeasible or not asked for
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
) -> tuple[Price, ...]:
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
    ends = _resolved_ends(parametric, evaluator, point, given, moves, change if resolve else 0.0)
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
) -> tuple[Price, ...]:
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
            Price(
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


def _resolved_ends(
    parametric: ParametricProblem,
    evaluator: Evaluator,
    point: Point,
    given: Responses,
    moves: Vector,
    change: float,
) -> list[tuple[float | None, float | None]]:
    """Re-optimised objectives at +change and -change of every parameter."""
    values = given.values.tolist()
    ends = {
        (k, sign): None if change == 0 else point.objective
        for k in range(len(values))
        for sign in (1, -1)
    }
    wanted = [(k, sign) for k, sign in ends if change != 0 and given.matters(k) and values[k] != 0]
    known, inside = _together(parametric, evaluator, point, values, moves, change, wanted)
    for i, (k, sign) in enumerate(wanted):
        objective = known[i]
        step = sign * change * values[k]
        if objective is None and inside[i] is not _NOWHERE:
            problem = perturbed(parametric, given.names[k], k, values[k] + step)
            guess = point.z + moves[:, k] * step
            if problem is not None:
                objective = resolved(problem, evaluator, guess, point, inside=inside[i])
        ends[k, sign] = objective
    return [(ends[k, 1], ends[k, -1]) for k in range(len(values))]


_NOWHERE = np.empty(0)
"""Stands for "no feasible point nearby"."""


def _together(
    parametric: ParametricProblem,
    evaluator: Evaluator,
    point: Point,
    values: list[float],
    moves: Vector,
    change: float,
    wanted: list[tuple[int, int]],
) -> tuple[list[float | None], list[Vector | None]]:
    """What re-solving all at once gives, and a feasible point where it does not converge.

    None and None where it does not apply, None and `_NOWHERE` where nothing is feasible nearby.
    """
    count = len(parametric.parameters)
    known: list[float | None] = [None] * len(wanted)
    inside: list[Vector | None] = [None] * len(wanted)
    chosen = [i for i, (k, _) in enumerate(wanted) if k < count]
    if not chosen or not lockstep.applicable(parametric, evaluator):
        return known, inside
    parameters = np.repeat(parametric.parameters[:, None], len(chosen), axis=1)
    starts = np.repeat(point.z[:, None], len(chosen), axis=1)
    for column, i in enumerate(chosen):
        k, sign = wanted[i]
        step = sign * change * values[k]
        parameters[k, column] += step
        starts[:, column] += moves[:, k] * step
    found = lockstep.resolve_together(parametric, evaluator, point, starts, parameters)
    for i, optimum in zip(chosen, found, strict=True):
        known[i] = None if optimum is None else optimum.objective
    left = [column for column, i in enumerate(chosen) if known[i] is None]
    restored = lockstep.restore_together(parametric, evaluator, point, parameters[:, left])
    feasible = [(column, z) for column, z in zip(left, restored, strict=True) if z is not None]
    for column in left:
        inside[chosen[column]] = _NOWHERE
    if feasible:
        columns = [column for column, _ in feasible]
        points = np.stack([z for _, z in feasible], axis=1)
        again = lockstep.resolve_together(
            parametric, evaluator, point, points, parameters[:, columns], own=True
        )
        for (column, z), optimum in zip(feasible, again, strict=True):
            known[chosen[column]] = None if optimum is None else optimum.objective
            inside[chosen[column]] = z
    return known, inside


def resolved(
    problem: Problem,
    evaluator: Evaluator,
    guess: Vector,
    point: Point,
    *,
    inside: Vector | None = None,
) -> float | None:
    """Objective of a slightly changed problem, from the predicted optimum; None if infeasible.

    Newton first; where the active set changes too much for it, a search for a feasible point
    (whose failure means that the changed problem has none nearby) and SLSQP. With `inside`, a
    feasible point already found, SLSQP from there at once.
    """
    near = Evaluator(problem)
    if near.space.size != len(guess):  # the changed bound fixes a variable
        guess = near.space.to_z(near.space.to_x(near.space.lower[:, None])[:, 0])
    near.complex_works = evaluator.complex_works
    near.difference_rows = evaluator.difference_rows
    here = near.point(near.space.to_z(np.clip(point.x, problem.lower, problem.upper)))
    start = near.point(np.clip(guess, near.space.lower, near.space.upper))
    if inside is not None:
        best = _descended(near, near.point(inside))
        return None if best is None else best.objective
    best = _refined(near, start if start.valid else here)
    if best is None or (_met(here) and here.objective < best.objective):
        best = _refined(near, here) or best  # the guess led nowhere, or uphill
    return None if best is None else best.objective


def _refined(near: Evaluator, start: Point) -> Point | None:
    """Return an optimum near the start, else a feasible point; None where there is none."""
    if not start.valid:
        return None
    found = polish(near, start, iterations=8, tolerance=1e-10)
    return found if _optimal(near, found) else _from_feasible(near, found)


def _from_feasible(near: Evaluator, start: Point) -> Point | None:
    """Return an optimum from the nearest feasible point, else that point; None without one."""
    inside = elastic.feasible_point(near, start) if start.valid else None
    return None if inside is None else _descended(near, inside)


def _descended(near: Evaluator, inside: Point) -> Point | None:
    """Return an optimum from a feasible point, else that point."""
    found = nlopt_wrapper.run(near, inside, "LD_SLSQP", most=100).point
    found = polish(near, found, iterations=8, tolerance=1e-10)
    if _met(found):
        return found
    return inside if _met(inside) else None


def _met(point: Point) -> bool:
    return point.valid and point.violation <= FEASIBLE


def _optimal(near: Evaluator, point: Point) -> bool:
    return _met(point) and kkt.check(near, point).residual <= RESIDUAL
