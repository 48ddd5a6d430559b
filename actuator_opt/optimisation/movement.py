"""Movement of an optimum with a parameter, validity of its active set, and one-sided prices.

The derivative of the optimum solves the linearised optimality conditions [Fiacco1983]. At a
degenerate vertex the multipliers form a polytope; the prices upwards and downwards are the
largest and smallest over it [Gauvin1982].
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from . import kkt
from .evaluator import Evaluator, Point
from .parameters import Responses
from .problem import Vector

INSTANT = 1e-7
"""Change of an active margin per relative parameter change that counts as zero."""

BASES = 1000
"""Maximum vertices of the multiplier polytope to enumerate; beyond, linear programming."""


@dataclass(frozen=True)
class Optimum:
    """Linear algebra of an optimum: margins of constraints, then lower and upper bounds.

    Parameters
    ----------
    margins, multipliers : (M,)
    gradients : (M, nf)
    equalities : gradients (e, nf)
    equality_multipliers : (e,)
    slope : gradient of the objective (nf,)
    hessian : of the Lagrangian (nf, nf)
    labels : of the margins
    weights : of the rows in the Lagrangian
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
    def held(self) -> npt.NDArray[np.intp]:
        """Margins with a positive multiplier."""
        size = self.multipliers * np.sqrt((self.gradients**2).sum(axis=1))
        return np.flatnonzero(size > 1e-10 * max(float(np.linalg.norm(self.slope)), 1e-300))


def optimum(evaluator: Evaluator, point: Point, quality: kkt.Kkt) -> Optimum:
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


def margin_slopes(found: Optimum, given: Responses) -> Vector:
    """Explicit derivative of every margin by every parameter (M, q)."""
    m = len(found.margins) - len(given.bounds)
    return np.concatenate([given.rows[1 : 1 + m], given.bounds])


def lagrangian_slopes(found: Optimum, given: Responses) -> Vector:
    """Price of every parameter (q,): derivative of the Lagrangian."""
    m = len(found.margins) - len(given.bounds)
    return found.weights @ given.rows - found.multipliers[m:] @ given.bounds


def movement(found: Optimum, given: Responses) -> tuple[Vector, Vector]:
    """Return derivatives by the parameters of the optimum (nf, q) and its multipliers (M, q).

    Directions that change nothing to second order do not move.
    """
    held, nf = found.held, len(found.slope)
    rows = np.concatenate([found.gradients[held], found.equalities])
    explicit = np.concatenate(
        [margin_slopes(found, given)[held], given.rows[len(given.rows) - len(found.equalities) :]]
    )
    # solves d gradient of the Lagrangian = 0 and d margin = 0 along the active rows, scaled
    size = np.sqrt((rows**2).sum(axis=1))
    size = np.where(size > 0, size, 1.0)
    scale = max(float(np.linalg.norm(found.slope)), 1e-300)
    rows, explicit = rows / size[:, None], explicit / size[:, None]
    system = np.block([[found.hessian / scale, -rows.T], [rows, np.zeros((len(rows),) * 2)]])
    right = -np.concatenate([given.mixed / scale, explicit])
    answer = np.linalg.lstsq(system, right, rcond=1e-11)[0]
    shifts = np.zeros((len(found.margins), right.shape[1]))
    shifts[held] = answer[nf : nf + len(held)] * scale / size[: len(held), None]
    return answer[:nf], shifts


def reach(
    found: Optimum, given: Responses, moves: Vector, shifts: Vector
) -> list[tuple[float | None, str | None]]:
    """For each parameter the nearest value at which the active set changes, and the change.

    None if beyond -100 % and +100 % of the parameter.
    """
    result: list[tuple[float | None, str | None]] = []
    for value, changes in zip(given.values, _changes(found, given, moves, shifts), strict=True):
        nearest = min(changes, key=lambda change: abs(change.distance), default=None)
        if nearest is None or abs(nearest.distance) > (abs(value) if value else 1.0):
            result.append((None, None))
        else:
            result.append((float(value + nearest.distance), nearest.text))
    return result


class ActiveSetChange(NamedTuple):
    """A change of the active set: distance and direction of the parameter, and the change.

    The direction matters at distance 0: a margin already used up without a multiplier becomes
    active on one side only.
    """

    distance: float
    direction: int
    text: str


def ends(
    found: Optimum, given: Responses, moves: Vector, shifts: Vector
) -> list[tuple[ActiveSetChange | None, ActiveSetChange | None]]:
    """For each parameter the nearest change of the active set below and above its value."""
    return [
        (
            min((one for one in changes if one.direction < 0), key=_size, default=None),
            min((one for one in changes if one.direction > 0), key=_size, default=None),
        )
        for changes in _changes(found, given, moves, shifts)
    ]


def _size(change: ActiveSetChange) -> float:
    return abs(change.distance)


def _changes(
    found: Optimum, given: Responses, moves: Vector, shifts: Vector
) -> Iterator[list[ActiveSetChange]]:
    """For each parameter the points where margins or multipliers vanish on their straight lines."""
    rates = margin_slopes(found, given) + found.gradients @ moves
    held = found.held
    for k, value in enumerate(given.values):
        changes: list[ActiveSetChange] = []
        reference = abs(value) if value else 1.0
        for i, label in enumerate(found.labels):
            if i in held:
                level, rate, event = found.multipliers[i], shifts[i, k], "stops being active"
            else:
                level, rate, event = max(found.margins[i], 0.0), rates[i, k], "becomes active"
            if abs(rate) * reference <= INSTANT * max(level, 1.0 if i not in held else 0.0):
                continue
            direction = -1 if rate > 0 else 1
            changes.append(ActiveSetChange(-level / rate, direction, f"{label} {event}"))
        yield changes


def one_sided(found: Optimum, given: Responses, active: npt.NDArray[np.intp]) -> Vector:
    """Smallest and largest price (2, q) over all multipliers of the optimum."""
    keep = _without_copies(found, given, active)
    rows = np.concatenate([found.gradients[keep], found.equalities])
    count, e = len(rows), len(found.equalities)
    size = np.sqrt((rows**2).sum(axis=1))
    size = np.where(size > 0, size, 1.0)
    rank = int(np.linalg.matrix_rank(rows / size[:, None], tol=1e-8)) if count else 0
    slopes = np.concatenate([margin_slopes(found, given)[keep], given.rows[len(given.rows) - e :]])
    single = lagrangian_slopes(found, given)
    if rank == count:
        return np.stack([single, single])
    target = rows.T @ np.concatenate([found.multipliers[keep], found.equality_multipliers])
    if rank >= e and math.comb(count - e, rank - e) <= BASES:
        vertices = _vertices(rows / size[:, None], target, rank, e) / size
        vertices = np.concatenate(
            [vertices, [np.concatenate([found.multipliers[keep], found.equality_multipliers])]]
        )
        all_prices = given.rows[0] - vertices @ slopes
        return np.stack([all_prices.min(axis=0), all_prices.max(axis=0)])
    return _by_linear_programming(rows, target, slopes, given.rows[0], e)


def _without_copies(
    found: Optimum, given: Responses, active: npt.NDArray[np.intp]
) -> npt.NDArray[np.intp]:
    """Active margins without exact copies (the same limit in two load cases); sums are kept.

    Only copies without a multiplier are dropped; least squares leaves at most one with it.
    """
    slopes = np.concatenate([found.gradients, margin_slopes(found, given)], axis=1)
    kept: list[int] = []
    order = sorted(active, key=lambda i: (found.multipliers[i] <= 0, i))
    for i in order:
        size = 1e-9 * np.abs(slopes[i]).max(initial=1e-300)
        if found.multipliers[i] > 0 or not any(
            (np.abs(slopes[i] - slopes[j]) <= size).all() for j in kept
        ):
            kept.append(int(i))
    return np.array(sorted(kept), dtype=np.intp)


def _vertices(rows: Vector, target: Vector, rank: int, free: int) -> Vector:
    """Vertices (v, a) of {multipliers : rows.T @ multipliers = target}, the last `free` free."""
    count = len(rows)
    found = []
    for chosen in itertools.combinations(range(count - free), rank - free):
        basis = [*chosen, *range(count - free, count)]
        part, _, got, _ = np.linalg.lstsq(rows[basis].T, target, rcond=1e-10)
        fits = np.linalg.norm(rows[basis].T @ part - target) <= 1e-8 * np.linalg.norm(target)
        if got == rank and fits and (part[: len(chosen)] >= -1e-9 * np.abs(part).max()).all():
            full = np.zeros(count)
            full[basis] = part
            found.append(full)
    return np.array(found).reshape(len(found), count)


def _by_linear_programming(
    rows: Vector, target: Vector, slopes: Vector, objective: Vector, free: int
) -> Vector:
    from scipy.optimize import linprog  # slow import, rarely used

    limits = [(0, None)] * (len(rows) - free) + [(None, None)] * free
    result = np.empty((2, slopes.shape[1]))
    for k in range(slopes.shape[1]):
        for side, sign in ((0, 1.0), (1, -1.0)):
            answer = linprog(-sign * slopes[:, k], A_eq=rows.T, b_eq=target, bounds=limits)
            # an unbounded price means that this direction has no feasible point
            value = -np.inf if answer.fun is None else float(answer.fun)
            result[side, k] = objective[k] + sign * value
    return result
