"""Distributions as quantile functions: from cumulative probability to value."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import erfc, sqrt
from statistics import NormalDist
from typing import Any

import numpy as np

from ..design.uncertain import REACH, limits, log_deviation
from ..optimisation.problem import Vector

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
        """Return the quantiles at the given cumulative probabilities.

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
    shares = np.asarray(share)
    values = map(NormalDist().inv_cdf, shares.ravel().tolist())
    return np.fromiter(values, float, shares.size).reshape(shares.shape)


def about(
    shape: str, stated: Mapping[str, Any], value: float, within: tuple[float, float]
) -> Distribution:
    """Return the distribution that an entry of the design file states around a nominal value.

    Parameters
    ----------
    shape, stated : as in the design file, SI
    value : nominal value
    within : valid range; draws outside it are set to the bound
    """
    low, high = limits(shape, stated, value)
    if shape == "normal":
        deviation = (high - low) / (2 * REACH)
    else:
        deviation = log_deviation(stated) if shape == "lognormal" else 0.0
    if shape in ("uniform", "loguniform"):
        value = (low + high) / 2
    return Distribution(shape, value, max(low, within[0]), min(high, within[1]), deviation)
