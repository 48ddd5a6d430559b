"""Response of an evaluated point to parameters, exact where the model allows, always checked.

Derivatives of values use the complex step in the parameter; derivatives of gradients use central
differences of complex-step gradients. A parameter whose complex step disagrees with a finite
difference (a look-up table, say) falls back to differences. Bounds of variables count as
parameters.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..base.numeric import STEP
from .evaluator import Evaluator, Point
from .problem import BoxProblem, ParametricProblem, Vector

RELATIVE_STEP = 1e-5
"""Step of central differences, relative to the parameter (absolute where it is 0)."""


@dataclass(frozen=True)
class Responses:
    """Derivatives by each parameter (q of them, bounds included) at one point.

    Parameters
    ----------
    names, values : of the parameters
    rows : (rows, q), derivative of objective, constraints and equalities
    mixed : (nf, q), derivative of the gradient of the Lagrangian
    bounds : (2 nf, q), derivative of the distance to lower, then upper bounds
    differences : labels of parameters that fell back to finite differences
    """

    names: tuple[str, ...]
    values: Vector
    rows: Vector
    mixed: Vector
    bounds: Vector
    differences: tuple[str, ...]

    def matters(self, k: int) -> bool:
        """Whether parameter k changes anything at the point."""
        return bool(self.rows[:, k].any() or self.bounds[:, k].any())


def responses(
    parametric: ParametricProblem, evaluator: Evaluator, point: Point, weights: Vector
) -> Responses:
    """Return derivatives by the parameters; `weights` (rows,) make the Lagrangian of the rows."""
    count, nf = len(parametric.parameters), evaluator.space.size
    steps = RELATIVE_STEP * np.where(parametric.parameters == 0, 1.0, parametric.parameters)
    rows, fallen = _row_slopes(parametric, point, steps)
    mixed = _mixed(parametric, evaluator, point, weights, steps)
    return Responses(
        tuple(parametric.parameter_names),
        parametric.parameters,
        rows,
        mixed,
        np.zeros((2 * nf, count)),
        fallen,
    )


def with_bounds(found: Responses, evaluator: Evaluator, multipliers: Vector) -> Responses:
    """Return the same with a parameter "NAME lower" or "NAME upper" for each bound that costs.

    `multipliers` (2 nf,) are those of the lower, then the upper bounds.
    """
    space, problem = evaluator.space, evaluator.problem
    nf = space.size
    priced = np.flatnonzero(multipliers > 0)
    names, values, shifts = [], [], np.zeros((2 * nf, len(priced)))
    for k, i in enumerate(priced):
        j, upper = int(i) % nf, bool(i >= nf)
        limit = (problem.upper if upper else problem.lower)[space.free[j]]
        slope = limit if space.logarithmic[j] else space.scale[j]
        names.append(f"{problem.names[space.free[j]]} {'upper' if upper else 'lower'}")
        values.append(limit)
        shifts[i, k] = (1.0 if upper else -1.0) / slope
    extra = len(priced)
    return replace(
        found,
        names=(*found.names, *names),
        values=np.concatenate([found.values, np.array(values, dtype=float)]),
        rows=np.concatenate([found.rows, np.zeros((len(found.rows), extra))], axis=1),
        mixed=np.concatenate([found.mixed, np.zeros((nf, extra))], axis=1),
        bounds=np.concatenate([found.bounds, shifts], axis=1),
    )


def perturbed(parametric: ParametricProblem, name: str, k: int, value: float) -> BoxProblem | None:
    """Return the problem with parameter k (a bound beyond the parameters) at `value`.

    None where the bounds would cross.
    """
    if k < len(parametric.parameters):
        parameters = parametric.parameters.copy()
        parameters[k] = value
        return parametric.at(parameters)
    problem = parametric.problem
    variable, side = name.rsplit(" ", 1)
    j = list(problem.names).index(variable)
    bound = (problem.upper if side == "upper" else problem.lower).copy()
    bound[j] = value
    lower, upper = (bound, problem.upper) if side == "lower" else (problem.lower, bound)
    if lower[j] > upper[j]:
        return None
    return replace(problem, lower=lower, upper=upper, start=None)


def _rows(parametric: ParametricProblem, points: Vector, parameters: Vector) -> Vector:
    problem = replace(
        parametric.problem, start=None, evaluate=lambda x: parametric.evaluate(x, parameters)
    )
    return np.asarray(problem.rows(points))


def _row_slopes(
    parametric: ParametricProblem, point: Point, steps: Vector
) -> tuple[Vector, tuple[str, ...]]:
    """Return derivative of the rows (rows, q), and the parameters that fell back to differences."""
    count = len(steps)
    if count == 0:
        return np.zeros((len(point.rows), 0)), ()
    at = np.repeat(parametric.parameters[:, None], count, axis=1)
    x = np.repeat(point.x[:, None], count, axis=1)
    moves = np.diag(steps)
    both = _rows(
        parametric,
        np.concatenate([x, x], axis=1),
        np.concatenate([at + moves, at - moves], axis=1),
    ).real
    above, below = both[:, :count], both[:, count:]
    middle = point.rows[:, None]
    above = np.where(np.isfinite(above), above, 2 * middle - below)
    below = np.where(np.isfinite(below), below, 2 * middle - above)
    crude = np.nan_to_num((above - below) / (2 * steps))
    try:
        fine = _rows(parametric, x, at + 1j * STEP * moves).imag / STEP / steps
    except (TypeError, ValueError, np.exceptions.ComplexWarning):
        return crude, tuple(parametric.parameter_names)
    room = 1e-4 * np.abs(crude).max(axis=0) + 1e-6 * (1 + np.abs(point.rows).max()) / np.abs(steps)
    room = np.minimum(room, 1e-4 * np.abs(crude).max(axis=0) + 1e-9 / np.abs(steps))
    wrong = ~(np.abs(fine - crude) <= room).all(axis=0)
    names = tuple(parametric.parameter_names[int(k)] for k in np.flatnonzero(wrong))
    return np.where(wrong, crude, fine), names


def _mixed(
    parametric: ParametricProblem,
    evaluator: Evaluator,
    point: Point,
    weights: Vector,
    steps: Vector,
) -> Vector:
    """Return the derivative of the Lagrangian's gradient (nf, q), in one call where exact."""
    count, nf = len(steps), evaluator.space.size
    if count == 0 or nf == 0:
        return np.zeros((nf, count))
    slopes = []
    if evaluator.complex_works and not evaluator.difference_rows.any():
        x = np.repeat(point.x[:, None].astype(complex), nf, axis=1)
        seeds = evaluator.space.slope(point.x[:, None])[:, 0]
        x[evaluator.space.free, np.arange(nf)] += 1j * STEP * seeds
        for sign in (1.0, -1.0):
            at = parametric.parameters[:, None] + sign * np.diag(steps)
            rows = _rows(parametric, np.tile(x, count), np.repeat(at, nf, axis=1))
            part = (rows.imag / STEP).reshape(len(rows), count, nf)
            slopes.append(np.tensordot(weights, part, axes=1))
    else:
        for sign in (1.0, -1.0):
            side = []
            for k in range(count):
                parameters = parametric.parameters.copy()
                parameters[k] += sign * 100 * steps[k]
                near = Evaluator(parametric.at(parameters))
                near.complex_works = evaluator.complex_works
                near.difference_rows = evaluator.difference_rows
                side.append(weights @ near.jacobians(point.z[:, None])[:, 0])
            slopes.append(np.array(side))
        steps = 100 * steps
    return np.asarray(np.nan_to_num((slopes[0] - slopes[1]) / (2 * steps[:, None])).T)
