"""Initial Hessians: from another problem's optimum, or along the free directions.

Most designs of a front have nearly as many active limits as variables. Along the few free
directions, a gradient on each side gives the curvature. Elsewhere the Hessian only has to be
convex, as the rows determine the step [NocedalWright2006] section 16.2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .. import kkt, newton
from ..evaluator import HESSIAN_STEP, Evaluator, Point
from ..problem import Vector
from .steps import Descent

FIRM = 1e-6
"""Multiplier, relative to the largest, above which a row is active."""

FLATTEST = 1e-10
"""Least curvature relative to the largest, above rounding; below it no direction is crossed."""

LEAST = 1e-6
"""Least curvature over the largest multiplier."""


@dataclass(frozen=True)
class ScaledHessian:
    """Scaled Hessian (n, n) of the Lagrangian at an optimum, per x of all variables."""

    hessian: Vector
    scale: float

    def seen_by(self, evaluator: Evaluator, x: Vector) -> Vector:
        """The Hessian in the free coordinates of a problem, at one of its points (n,)."""
        space = evaluator.space
        slope = space.slope(x[:, None])[:, 0]
        return np.asarray(self.hessian[np.ix_(space.free, space.free)] * np.outer(slope, slope))


def hessian_at(evaluator: Evaluator, point: Point) -> ScaledHessian | None:
    """The Hessian at an optimum; None if no variable is free."""
    space = evaluator.space
    if not space.size or not point.valid:
        return None
    state = newton.state_at(evaluator, point)
    slope = space.slope(point.x[:, None])[:, 0]
    hessian = newton.convex_hessian(evaluator, state) / np.outer(slope, slope)
    full = np.zeros((len(point.x), len(point.x)))
    full[np.ix_(space.free, space.free)] = hessian
    return ScaledHessian(full, state.scale)


def free_hessians(evaluator: Evaluator, descents: Sequence[Descent]) -> list[Vector]:
    """Convex Hessian of the Lagrangian at the point of each descent, from one model call.

    Parameters
    ----------
    evaluator : of the problems, which have the same curvature
    descents : with a point and its multipliers
    """
    free = [_free(evaluator, descent) for descent in descents]
    if not any(z.shape[1] for z in free):
        return [np.eye(evaluator.space.size) for _ in descents]
    moves = np.concatenate([HESSIAN_STEP * z for z in free], axis=1)
    at = np.repeat(
        np.stack([descent.known.z for descent in descents], axis=1),
        [z.shape[1] for z in free],
        axis=1,
    )
    slopes = evaluator.jacobians(np.concatenate([at + moves, at - moves], axis=1), inside=False)
    bends = np.nan_to_num(slopes[:, : at.shape[1]] - slopes[:, at.shape[1] :]) / (2 * HESSIAN_STEP)
    result, first = [], 0
    for descent, z in zip(descents, free, strict=True):
        part = bends[:, first : first + z.shape[1]]
        first += z.shape[1]
        weights = -descent.multipliers
        along = np.tensordot(weights, part[1 : 1 + len(weights)], axes=1).T
        along += part[0].T / descent.scale
        result.append(_convex(z, along, float(np.abs(weights).max(initial=0.0))))
    return result


def _free(evaluator: Evaluator, descent: Descent) -> Vector:
    """Orthonormal directions (nf, d) that leave the active rows unchanged."""
    size, prices = evaluator.space.size, descent.prices
    unit = np.eye(size)
    rows = np.concatenate([evaluator.jacobian(descent.known)[1 : 1 + descent.rows], unit, -unit])
    assert prices is not None
    weight = prices * np.sqrt((rows**2).sum(axis=1))
    return kkt.null_space(rows[weight > FIRM * weight.max(initial=0.0)], size)


def _convex(z: Vector, along: Vector, largest: float) -> Vector:
    """A convex matrix (nf, nf) with known products (nf, d) along orthonormal directions (nf, d)."""
    size = len(z)
    if z.shape[1] == 0:
        return np.eye(size)
    values, vectors = np.linalg.eigh(z.T @ along + along.T @ z)
    values = np.maximum(np.abs(values) / 2, LEAST * max(largest, 1e-3))
    inner = (vectors * values) @ vectors.T
    across = along - z @ (z.T @ along)
    rest = np.eye(size) - z @ z.T
    crossed = across @ np.linalg.solve(inner, across.T)
    firm = 1.0 + float(np.linalg.norm(crossed, 2))
    whole = np.asarray(z @ inner @ z.T + across @ z.T + z @ across.T + firm * rest)
    bends = np.linalg.eigvalsh(whole)
    return whole if bends[0] > FLATTEST * bends[-1] else np.asarray(z @ inner @ z.T + rest)
