"""Distributions of inputs; probabilities and sensitivity indices with confidence bounds.

A distribution is represented by its quantile function, which gives the value at a cumulative
probability. Probabilities and variance-based sensitivity indices are estimated from points of the
unit cube; their coordinates are the cumulative probabilities of the inputs.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from math import erfc, sqrt
from statistics import NormalDist
from typing import Any

import numpy as np

from ..base.cluster import HERE, Cluster
from ..base.dataclass import dataclass
from ..base.progress import tell
from ..design.uncertain import REACH, limits, log_deviation
from ..optimisation.problem import Vector

LEVEL = 0.95
"""Confidence level of all bounds."""

Outputs = Callable[[Vector], Vector]
"""Function that returns k outputs, (k, n), at n points, (d, n), of the unit cube in d
dimensions."""


@dataclass(frozen=True, slots=True)
class Rate:
    """A probability with its 95 % confidence bounds."""

    value: float
    lower: float
    upper: float

    def to_dict(self) -> dict[str, float]:
        """Return the JSON form."""
        return {"value": self.value, "lower": self.lower, "upper": self.upper}


def exact(hits: int, count: int) -> Rate:
    """Return the share of `hits` in `count` independent draws, with exact bounds [Clopper1934].

    >>> bounds = exact(0, 100)
    >>> round(bounds.lower, 4), round(bounds.upper, 4)
    (0.0, 0.0362)
    """
    lower = _least(hits, count) if hits > 0 else 0.0
    upper = 1 - _least(count - hits, count) if hits < count else 1.0
    return Rate(hits / count, lower, upper)


SUMMED = 2000
"""Up to this number of draws, bounds are computed by direct summation, as SciPy is slow to load."""


def _least(hits: int, count: int) -> float:
    """Return the hit probability for which `hits` or more of `count` draws are 2.5 % likely."""
    tail = (1 - LEVEL) / 2
    if count > SUMMED:
        from scipy.special import betaincinv

        return float(betaincinv(hits, count - hits + 1, tail))
    number = np.arange(1, count + 1)
    ways = np.concatenate([[0.0], np.cumsum(np.log((count - number + 1) / number))])[hits:]
    number = np.arange(hits, count + 1)
    low, high = 0.0, 1.0
    for _ in range(60):  # halves the bracket down to floating-point precision
        middle = (low + high) / 2
        share = np.exp(ways + number * np.log(middle) + (count - number) * np.log1p(-middle)).sum()
        low, high = (low, middle) if share > tail else (middle, high)
    return (low + high) / 2


def replicated(hits: Vector, points: int) -> Rate:
    """Return the share of hits in independent replicates of `points` quasi-random points each.

    The bounds follow from the scatter of the replicates by Student's t [Owen2013]. If there are
    fewer misses, or fewer hits, than replicates, their scatter gives no information. The bounds are
    then those of independent draws, which are wider.
    """
    total, replicates = int(hits.sum()), len(hits)
    pooled = exact(total, points * replicates)
    if min(total, points * replicates - total) < replicates:
        return pooled
    half = half_width(hits / points)
    return Rate(pooled.value, max(0.0, pooled.value - half), min(1.0, pooled.value + half))


def half_width(values: Vector) -> float:
    """Return half the width of the 95 % confidence interval of the mean of replicates."""
    return _student(len(values)) * float(np.std(values, ddof=1))


def _student(count: int) -> float:
    """Return half the width of the 95 % interval of a mean, for values of standard deviation 1."""
    from scipy.special import stdtrit

    return float(stdtrit(count - 1, (1 + LEVEL) / 2)) / float(np.sqrt(count))


def quasi(dimension: int, power: int, seed: tuple[int, ...]) -> Vector:
    """Return 2^power scrambled Sobol points (dimension, n) [Sobol1967] [Owen2013]."""
    from scipy.stats import qmc

    generator = np.random.default_rng(seed)
    points = qmc.Sobol(dimension, scramble=True, seed=generator).random_base2(power)
    return np.asarray(points.T)


@dataclass(frozen=True, slots=True)
class Indices:
    """Variance-based sensitivity indices of k outputs to d inputs, with confidence intervals.

    Parameters
    ----------
    first, total : first-order and total indices (d, k); NaN if the output does not vary
    first_half, total_half : half the width of their 95 % confidence intervals (d, k)
    variance : variance of each output (k,)
    dropped : share of the rows that are left out, because some output has no value
    """

    first: Vector
    total: Vector
    first_half: Vector
    total_half: Vector
    variance: Vector
    dropped: float


TOGETHER = 2048
"""Maximum number of points in one model call. Where a sample is smaller, the samples for several
inputs are computed in one call."""
REPLICATES = 8
"""Number of independent randomisations, from whose scatter the confidence intervals of indices
follow."""


def indices(
    outputs: Outputs, dimension: int, *, rows: int, seed: int, cluster: Cluster = HERE
) -> Indices:
    """Return the first-order and total indices of every output.

    The first-order index of input i is E[f(B) (f(AB_i) - f(A))] / V [Saltelli2010], its total index
    E[(f(A) - f(AB_i))^2] / 2V [Jansen1999], with the variance V of the output f. A and B are the
    first and the last d coordinates of one scrambled Sobol sequence in 2d dimensions; AB_i is A
    with coordinate i taken from B. Confidence intervals follow from `REPLICATES` randomisations of
    the sequence.

    Parameters
    ----------
    outputs : function that returns the outputs (k, n) at points (d, n)
    dimension : number of inputs d
    rows : number of points in total; each takes (d + 2) evaluations of the design
    seed : seed of the randomisations
    cluster : workers for the randomisations
    """
    power = max(3, round(np.log2(max(rows, 1) / REPLICATES)))
    parts = []
    dropped_rows = 0
    work = partial(_replicate_moments, outputs, dimension, power, seed)
    for moments, dropped in cluster.map(work, range(REPLICATES)):
        parts.append(moments)
        dropped_rows += dropped
    sums = np.array(parts)  # (replicates, 2 d + 1, k)
    variance = sums[:, -1]
    with np.errstate(all="ignore"):
        shares = sums[:, :-1] / variance[:, None]
        pooled = sums[:, :-1].mean(axis=0) / variance.mean(axis=0)
    flat = ~(variance.mean(axis=0) > 0)
    pooled[:, flat], shares[:, :, flat] = np.nan, np.nan
    half = _student(REPLICATES) * np.std(shares, axis=0, ddof=1)
    return Indices(
        first=pooled[:dimension],
        total=pooled[dimension:],
        first_half=half[:dimension],
        total_half=half[dimension:],
        variance=variance.mean(axis=0),
        dropped=dropped_rows / (REPLICATES << power),
    )


def _replicate_moments(
    outputs: Outputs, dimension: int, power: int, seed: int, replicate: int
) -> tuple[Vector, int]:
    """Return the variances of a randomisation of 2^power points, and the number of rows left out.

    The variances (2 d + 1, k) are the first-order parts due to each input, then the total parts due
    to each input, and finally the variance of the output.
    """
    points = quasi(2 * dimension, power, (seed, 1, replicate))
    first, second = points[:dimension], points[dimension:]
    a, b = outputs(first), outputs(second)
    mixed: list[Vector] = []
    count = first.shape[1]
    columns = max(1, TOGETHER // count)
    for begin in range(0, dimension, columns):
        tell("indices", (replicate + begin / dimension) / REPLICATES)
        group = range(begin, min(begin + columns, dimension))
        swapped = np.tile(first, len(group))
        for place, index in enumerate(group):
            swapped[index, place * count : (place + 1) * count] = second[index]
        mixed += np.split(outputs(swapped), len(group), axis=1)
    valid = np.isfinite(np.stack([a, b, *mixed])).all(axis=0)  # (k, n)
    number = np.maximum(valid.sum(axis=1), 1)
    mean = np.where(valid, a + b, 0.0).sum(axis=1) / (2 * number)
    a, b = (np.where(valid, output - mean[:, None], 0.0) for output in (a, b))
    variance = ((a**2 + b**2).sum(axis=1)) / (2 * number)
    noise = (1e-12 * np.maximum(np.abs(mean), 1e-30)) ** 2
    variance = np.where(variance > noise, variance, 0.0)
    firsts, totals = [], []
    for output in mixed:
        changed = np.where(valid, output - mean[:, None], 0.0)
        firsts.append((b * (changed - a)).sum(axis=1) / number)
        totals.append(((a - changed) ** 2).sum(axis=1) / (2 * number))
    return np.array([*firsts, *totals, variance]), int((~valid).any(axis=0).sum())


_TAIL = erfc(REACH / sqrt(2)) / 2


@dataclass(frozen=True, slots=True)
class Distribution:
    """Distribution of an input, SI.

    Parameters
    ----------
    shape : normal, lognormal, uniform, loguniform, triangular or fixed
    centre : mean (normal), median (lognormal) or mode (triangular)
    low, high : least and largest value
    deviation : standard deviation of the value (normal) or of its logarithm (lognormal)
    """

    shape: str
    centre: float
    low: float
    high: float
    deviation: float = 0.0

    def at(self, share: Vector) -> Vector:
        """Return the values at the given cumulative probabilities.

        Normal and lognormal distributions are truncated at 5 standard deviations.

        Examples
        --------
        >>> Distribution("uniform", 2.0, 1.0, 3.0).at(np.array([0.0, 0.25, 1.0])).tolist()
        [1.0, 1.5, 3.0]
        >>> Distribution("triangular", 1.0, 0.0, 4.0).at(np.array([0.25])).tolist()
        [1.0]
        """
        if self.shape == "fixed" or self.low == self.high:
            return np.full_like(share, self.centre)
        return np.clip(self._at(share), self.low, self.high)

    def _at(self, share: Vector) -> Vector:
        width = self.high - self.low
        if self.shape == "uniform":
            return self.low + width * share
        if self.shape == "loguniform":
            return np.asarray(self.low * (self.high / self.low) ** share)
        if self.shape == "triangular":
            tip = (self.centre - self.low) / width
            rising = np.sqrt(share * tip)
            falling = 1 - np.sqrt((1 - share) * (1 - tip))
            return self.low + width * np.where(share < tip, rising, falling)
        steps = self.deviation * normal_quantile(_TAIL + share * (1 - 2 * _TAIL))
        if self.shape == "lognormal":
            return np.asarray(self.centre * np.exp(steps))
        return np.asarray(self.centre + steps)


def normal_quantile(share: Vector) -> Vector:
    """Return quantiles of the standard normal distribution [Wichura1988].

    Examples
    --------
    >>> normal_quantile(np.array([0.5, 0.975])).round(6).tolist()
    [0.0, 1.959964]
    """
    probabilities = np.asarray(share)
    values = map(NormalDist().inv_cdf, probabilities.ravel().tolist())
    return np.fromiter(values, float, probabilities.size).reshape(probabilities.shape)


def about(
    shape: str, stated: Mapping[str, Any], value: float, within: tuple[float, float]
) -> Distribution:
    """Return the distribution that a design file states, centred on a nominal value.

    Parameters
    ----------
    shape, stated : shape and parameters as in the design file, SI
    value : nominal value
    within : valid range; draws outside it are set to the nearest bound
    """
    low, high = limits(shape, stated, value)
    if shape == "normal":
        deviation = (high - low) / (2 * REACH)
    else:
        deviation = log_deviation(stated) if shape == "lognormal" else 0.0
    if shape in ("uniform", "loguniform"):
        value = (low + high) / 2
    return Distribution(shape, value, max(low, within[0]), min(high, within[1]), deviation)
