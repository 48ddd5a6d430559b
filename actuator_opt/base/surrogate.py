"""Approximate a costly smooth function by a Chebyshev polynomial in a box, with derivatives.

Inputs with a range are axes of a tensor product of Chebyshev polynomials [Boyd2001]. The effect of
other inputs is linearised, with the slopes that the function returns. Evaluation is plain
arithmetic and supports complex steps.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import product
from math import cos, exp, log, pi

import numpy as np

from .dataclass import dataclass
from .numeric import Array, array_of, clip


@dataclass(frozen=True, slots=True)
class Interpolation:
    """Result of the costly function at one point.

    Parameters
    ----------
    values : outputs (m,)
    slopes : for each input by name, derivatives of the outputs (m,) with respect to its logarithm;
        slopes of an axis are only used if its `hermite` is set; an input that is not an axis and
        has no slopes has no effect
    why : why the evaluation failed (values and slopes are then ignored); "" if it succeeded
    """

    values: np.ndarray
    slopes: Mapping[str, np.ndarray]
    why: str = ""


@dataclass(frozen=True, slots=True)
class SurrogateAxis:
    """An axis of the polynomial: the logarithm of an input, with 0 < lower < upper.

    With `hermite` the fit also matches the slopes along the axis and has twice as many terms.
    """

    name: str
    lower: float
    upper: float
    nodes: int
    hermite: bool = False

    @property
    def terms(self) -> int:
        """Number of polynomials along the axis."""
        return 2 * self.nodes if self.hermite else self.nodes

    @property
    def points(self) -> list[float]:
        """Nodes in the unit of the input: the roots of the Chebyshev polynomial."""
        middle, half = 0.5 * log(self.lower * self.upper), 0.5 * log(self.upper / self.lower)
        return [exp(middle + half * cos(pi * (k + 0.5) / self.nodes)) for k in range(self.nodes)]

    def _coordinate(self, value: Array) -> Array:
        """Position of an input on the axis, from -1 to 1."""
        low, high = log(self.lower), log(self.upper)
        limited = clip(value, self.lower, self.upper)
        return (2 * np.log(limited) - low - high) / (high - low)

    def basis(self, value: Array) -> Array:
        """Chebyshev polynomials (..., terms) at an input, which is clipped to the axis range."""
        x = self._coordinate(value)
        rows = [np.ones_like(x), x]
        while len(rows) < self.terms:
            rows.append(2 * x * rows[-1] - rows[-2])
        return np.stack(rows[: self.terms], axis=-1)

    def basis_slope(self, value: Array) -> Array:
        """Derivatives of the polynomials (..., terms) by the logarithm of the input."""
        x = self._coordinate(value)
        second = [np.ones_like(x), 2 * x]  # U_k; T_k' = k U_(k-1)
        while len(second) < self.terms:
            second.append(2 * x * second[-1] - second[-2])
        rows = [0 * x, *(k * second[k - 1] for k in range(1, self.terms))]
        return np.stack(rows, axis=-1) * (2 / (log(self.upper) - log(self.lower)))

    def holds(self, value: float) -> bool:
        """Whether an input lies within the range of the axis."""
        return self.lower * (1 - 1e-9) <= value <= self.upper * (1 + 1e-9)


@dataclass(frozen=True, slots=True)
class Surrogate:
    """Polynomial approximation of several outputs.

    Parameters
    ----------
    axes : inputs with a range
    base : reference value of every input
    coefficients : array (terms of axis 1, terms of axis 2, ..., outputs, 1 + linear inputs); the
        last axis has the value, then the slope for each input in `linear`
    linear : inputs whose effect is linearised
    failed : reasons of failed points, which the fit omits
    """

    axes: tuple[SurrogateAxis, ...]
    base: dict[str, float]
    coefficients: np.ndarray
    linear: tuple[str, ...]
    failed: tuple[str, ...] = ()

    def __call__(self, inputs: Mapping[str, Array], slope: str | None = None) -> Array:
        """Outputs (m, ...) at inputs that broadcast; missing inputs have their base value.

        With `slope` (the name of an axis), return derivatives with respect to the logarithm of its
        input instead.
        """
        point = {name: array_of(inputs.get(name, value)) for name, value in self.base.items()}
        names = [axis.name for axis in self.axes] + list(self.linear)
        shape = np.broadcast_shapes(*(point[name].shape for name in names))
        table = np.broadcast_to(self.coefficients, shape + self.coefficients.shape)
        for axis in self.axes:
            basis = axis.basis_slope if axis.name == slope else axis.basis
            rows = np.broadcast_to(basis(point[axis.name]), (*shape, axis.terms))
            others = table.ndim - len(shape) - 1
            table = np.sum(rows.reshape(rows.shape + (1,) * others) * table, axis=len(shape))
        result = table[..., 0]
        for k, name in enumerate(self.linear):
            change = np.log(point[name] / self.base[name])
            result = result + table[..., k + 1] * np.broadcast_to(change, shape)[..., None]
        return np.moveaxis(result, -1, 0)

    def covers(self, inputs: Mapping[str, float]) -> bool:
        """Whether a point lies within the ranges of all axes."""
        return all(axis.holds(inputs[axis.name]) for axis in self.axes if axis.name in inputs)


def surrogate(
    function: Callable[[dict[str, float]], Interpolation],
    *,
    base: Mapping[str, float],
    axes: Sequence[SurrogateAxis],
) -> Surrogate | None:
    """Fit a surrogate at the Chebyshev nodes of the axes; None if too many points failed.

    Parameters
    ----------
    function : evaluates a point (every input of `base`); successive points are neighbours
    base : reference values of all inputs, positive
    axes : inputs with a range

    Failed points are omitted and the others fitted by least squares. There is no surrogate if more
    than a tenth of the points failed.
    """
    points, results, failed = [], [], []
    grids = [axis.points for axis in axes]
    for index in product(*(range(len(grid)) for grid in grids)):
        indices = _back_and_forth(index, [len(grid) for grid in grids])
        point = dict(base)
        for axis, grid, i in zip(axes, grids, indices, strict=True):
            point[axis.name] = grid[i]
        result = function(point)
        if result.why:
            failed.append(result.why)
            continue
        points.append(point)
        results.append(result)
    if not results or len(failed) > 0.1 * (len(results) + len(failed)):
        return None
    names = {axis.name for axis in axes}
    linear = tuple(name for name in base if name in results[0].slopes and name not in names)
    table = np.zeros((*(axis.terms for axis in axes), results[0].values.size, 1 + len(linear)))
    table[..., 0] = _fitted(axes, points, [result.values for result in results], results)
    plain = tuple(replace(axis, hermite=False) for axis in axes)
    corner = tuple(slice(axis.nodes) for axis in axes)
    for k, name in enumerate(linear):
        values = [result.slopes.get(name, np.zeros_like(result.values)) for result in results]
        place: tuple[slice | int, ...] = (*corner, slice(None), k + 1)
        table[place] = _fitted(plain, points, values, results)
    return Surrogate(tuple(axes), dict(base), table, linear, tuple(failed))


def _fitted(
    axes: Sequence[SurrogateAxis],
    points: Sequence[Mapping[str, float]],
    values: Sequence[np.ndarray],
    results: Sequence[Interpolation],
) -> np.ndarray:
    """Fit coefficients (terms of every axis, outputs) to values; with `hermite` also to slopes."""
    rows, targets = [_basis(axes, points)], [np.array(values)]
    for axis in axes:
        if axis.hermite:
            rows.append(_basis(axes, points, axis.name))
            targets.append(np.array([result.slopes[axis.name] for result in results]))
    solution = np.linalg.lstsq(np.concatenate(rows), np.concatenate(targets), rcond=None)[0]
    return np.asarray(solution.reshape(*(axis.terms for axis in axes), -1))


def _basis(
    axes: Sequence[SurrogateAxis], points: Sequence[Mapping[str, float]], slope: str = ""
) -> np.ndarray:
    """Products of polynomials (points, all terms), or their derivatives along the axis `slope`."""
    matrix = np.ones((len(points), 1))
    for axis in axes:
        along = axis.basis_slope if axis.name == slope else axis.basis
        basis = along(np.array([point[axis.name] for point in points]))
        matrix = (matrix[:, :, None] * basis[:, None, :]).reshape(len(points), -1)
    return matrix


def _back_and_forth(index: tuple[int, ...], sizes: Sequence[int]) -> tuple[int, ...]:
    """Indices in back-and-forth order, so that successive points are neighbours."""
    indices, parity = [], 0
    for i, size in zip(index, sizes, strict=True):
        indices.append(i if parity % 2 == 0 else size - 1 - i)
        parity = parity * size + i
    return tuple(indices)
