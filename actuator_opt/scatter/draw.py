"""Distributions as quantile functions: a share of the probability in, a value out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import erfc, sqrt
from typing import Any

import numpy as np

from ..design.distributions import REACH, limits, log_deviation
from ..optimisation.problem import Vector

_TAIL = erfc(REACH / sqrt(2)) / 2


@dataclass(frozen=True, slots=True)
class Distribution:
    """A distribution of a value, SI.

    Parameters
    ----------
    shape : normal, lognormal, uniform, loguniform, triangular or fixed
    centre : mean of a normal, median of a lognormal, tip of a triangular one
    low, high : least and largest value
    deviation : standard deviation of a normal; of the logarithm, of a lognormal
    """

    shape: str
    centre: float
    low: float
    high: float
    deviation: float = 0.0

    def at(self, share: Vector) -> Vector:
        """The values below which shares of the probability lie.

        Normal and lognormal distributions end at 5 standard deviations.

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


_MIDDLE = (
    (2509.0809287301227, 33430.575583588128, 67265.770927008700, 45921.953931549871,
     13731.693765509461, 1971.5909503065514, 133.14166789178438, 3.3871328727963666),
    (5226.4952788528546, 28729.085735721943, 39307.895800092711, 21213.794301586596,
     5394.1960214247511, 687.18700749205791, 42.313330701600911, 1.0),
)  # fmt: skip
_NEAR = (
    (7.7454501427834141e-4, 2.2723844989269185e-2, 2.4178072517745061e-1, 1.2704582524523684,
     3.6478483247632046, 5.7694972214606914, 4.6303378461565453, 1.4234371107496836),
    (1.0507500716444168e-9, 5.4759380849953449e-4, 1.5198666563616457e-2, 1.4810397642748007e-1,
     6.8976733498510000e-1, 1.6763848301838038, 2.0531916266377588, 1.0),
)  # fmt: skip
_FAR = (
    (2.0103343992922881e-7, 2.7115555687434876e-5, 1.2426609473880784e-3, 2.6532189526576123e-2,
     2.9656057182850489e-1, 1.7848265399172913, 5.4637849111641144, 6.6579046435011038),
    (2.0442631033899398e-15, 1.4215117583164459e-7, 1.8463183175100547e-5, 7.8686913114561326e-4,
     1.4875361290850615e-2, 1.3692988092273581e-1, 5.9983220655588794e-1, 1.0),
)  # fmt: skip
"""Numerator and denominator of the quantile: in the middle, to e^-25, beyond [Wichura1988]."""


def normal_quantile(share: Vector) -> Vector:
    """The standard normal value below which shares of the probability lie [Wichura1988].

    Algorithm AS 241 (PPND16), to 1e-15 of the value. SciPy has the same, but is slow to load.

    Examples
    --------
    >>> normal_quantile(np.array([0.5, 0.975])).round(6).tolist()
    [0.0, 1.959964]
    """
    middle = np.asarray(share) - 0.5
    root = np.sqrt(-np.log(np.minimum(share, 1 - share)))
    tail = np.where(root <= 5, _ratio(_NEAR, root - 1.6), _ratio(_FAR, root - 5))
    inner = middle * _ratio(_MIDDLE, 0.180625 - middle**2)
    return np.where(np.abs(middle) <= 0.425, inner, np.copysign(tail, middle))


def _ratio(pair: tuple[tuple[float, ...], tuple[float, ...]], at: Vector) -> Vector:
    return np.polyval(pair[0], at) / np.polyval(pair[1], at)


def about(
    shape: str, stated: Mapping[str, Any], value: float, within: tuple[float, float]
) -> Distribution:
    """The distribution that an entry states about a value of the design.

    Parameters
    ----------
    shape, stated : as the design file has them, SI
    value : of the design
    within : bounds that draws never leave: what lies beyond is drawn at the bound
    """
    low, high = limits(shape, stated, value)
    if shape == "normal":
        deviation = (high - low) / (2 * REACH)
    else:
        deviation = log_deviation(stated) if shape == "lognormal" else 0.0
    if shape in ("uniform", "loguniform"):
        value = (low + high) / 2
    return Distribution(shape, value, max(low, within[0]), min(high, within[1]), deviation)
