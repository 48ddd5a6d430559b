"""Residuals of a fitted record, and the resulting bounds of the parameters."""

from __future__ import annotations

from typing import Final

import numpy as np

from ...base.fitting import Known, known
from ...base.numeric import Array
from .problem import STEPS, RecordFitProblem

STEADIEST: Final = 0.97
"""Largest correlation of neighbouring samples used for the bandwidth, as is usual."""
WHOLE: Final = 4
"""Least number of bandwidths in a record (a choice)."""
ORDERS: Final = 10
"""Highest order of an autoregression of residuals (a choice)."""


def bounds(problem: RecordFitProblem, x: Array) -> Known:
    """Covariance of the fitted values from the residuals.

    cov = H^-1 S H^-1, H = J^T J, S the covariance of J^T r. S is the largest of three estimates:
    independent residuals; channels as autoregressions, each of the order by Akaike's criterion;
    and, for intermittent misfit, the sum of J^T r r^T J over times and lags within a bandwidth,
    with Bartlett's weights (Newey and West; bandwidth by Andrews' rule), all channels of an instant
    together. The degrees of freedom follow from that window, 3 n/(2 m) - p. The slopes are secants
    over a standard error.
    """
    rest = problem.rest(x)
    variance = float(np.sum(rest**2)) / max(rest.size - x.size, 1)
    first = problem.slopes_on_the_way(x) * problem.sizes
    errors = np.sqrt(variance * np.diag(np.linalg.pinv(first.T @ first, hermitian=True)))
    errors[np.linalg.norm(first, axis=0) == 0] = np.inf
    steps = np.clip(errors, *STEPS) * problem.sizes
    scaled = problem.slopes(x, steps) * problem.sizes
    left, singular, right = np.linalg.svd(scaled, full_matrices=False)
    moments = _by_time(problem, left * rest[:, None])
    width = _bandwidth(moments)
    inner = _larger(variance * np.eye(x.size), _coloured(problem, left, rest))
    inner = _larger(inner, _summed(moments, width))
    root = np.linalg.cholesky(inner)
    whitened = np.linalg.solve(root, singular[:, None] * right) / problem.sizes
    points = min(float(rest.size), 1.5 * moments.shape[0] / width)
    return known(
        dict(zip(problem.names, x.tolist(), strict=True)),
        whitened,
        np.ones(1) * np.sqrt(points),
        problem.sizes,
        spare=max(points - x.size, 1.0),
    )


def _larger(first: Array, second: Array) -> Array:
    """A covariance at least as large as both: the first plus the excess of the second."""
    values, turn = np.linalg.eigh(second - first)
    found: Array = first + (turn * np.maximum(values, 0.0)) @ turn.T
    return found


def _by_time(problem: RecordFitProblem, rows: Array) -> Array:
    """Rows of samples, summed per instant, in the order of time."""
    times = np.concatenate([t for t, _ in problem.used.values()])
    instants, place = np.unique(times, return_inverse=True)
    found = np.zeros((instants.size, rows.shape[1]))
    np.add.at(found, place, rows)
    return found


def _bandwidth(moments: Array) -> float:
    """Correlation length of the moments in samples, from neighbouring values."""
    before, after = moments[:-1], moments[1:]
    power = np.maximum(np.sum(before**2, axis=0), 1e-300)
    rho = np.clip(np.sum(before * after, axis=0) / power, -STEADIEST, STEADIEST)
    square = (power / power.size) ** 2
    above = np.sum(4 * rho**2 * square / ((1 - rho) ** 6 * (1 + rho) ** 2))
    alpha = float(above / max(np.sum(square / (1 - rho) ** 4), 1e-300))
    count = moments.shape[0]
    return float(np.clip(1.1447 * (alpha * count) ** (1 / 3), 1.0, max(count / WHOLE, 1.0)))


def _summed(moments: Array, width: float) -> Array:
    """Sum of products of moments within a bandwidth, with weights that fall to zero."""
    total: Array = moments.T @ moments
    for k in range(1, min(int(np.ceil(width)), moments.shape[0])):
        product = moments[:-k].T @ moments[k:]
        total = total + (1 - k / width) * (product + product.T)
    return total


def _coloured(problem: RecordFitProblem, left: Array, rest: Array) -> Array:
    """Covariance of U^T r with every channel's residuals as an autoregression."""
    from scipy.linalg import matmul_toeplitz  # slow import, rarely used

    total = np.zeros((left.shape[1], left.shape[1]))
    first = 0
    for t, _ in problem.used.values():
        part = slice(first, first + t.size)
        first += t.size
        total += left[part].T @ matmul_toeplitz(_autocovariance(rest[part]), left[part])
    return total


def _autocovariance(rest: Array) -> Array:
    """Autocovariance of the best autoregression of some residuals, by Levinson's recursion."""
    count = rest.size
    orders = min(ORDERS, count // 4)
    lags = np.array([float(rest[: count - k] @ rest[k:]) for k in range(orders + 1)]) / count
    found, weights = np.empty(0), np.empty(0)
    variance = lags[0]
    least = np.inf
    for order in range(orders + 1):
        if order:
            turn = (lags[order] - weights @ lags[order - 1 : 0 : -1]) / variance
            weights = np.append(weights - turn * weights[::-1], turn)
            variance = max(variance * (1 - turn**2), 1e-12 * lags[0])
        cost = count * np.log(max(variance, 1e-300)) + 2 * order
        if cost < least:
            least, found = cost, weights
    series = np.empty(count)
    series[: orders + 1] = lags
    for k in range(found.size + 1, count):
        series[k] = found @ series[k - found.size : k][::-1]
    return series
