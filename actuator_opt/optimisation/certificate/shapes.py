"""The functions of curves: of a log ratio, or of an angle's logarithm."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal, NamedTuple, TypeAlias

Kind: TypeAlias = Literal["softplus", "exp", "log", "cos", "sin"]


class Shape(NamedTuple):
    """A rising or falling function of one argument."""

    value: Callable[[float], float]
    slope: Callable[[float], float]
    inverse: Callable[[float], float]
    convex: bool
    rising: bool


def softplus(x: float) -> float:
    """log(1 + e^x)."""
    return max(x, 0.0) + math.log1p(math.exp(-abs(x))) if x < 700 else x


def _softplus_inverse(y: float) -> float:
    if y <= 0:
        return -math.inf
    return y + math.log(-math.expm1(-y)) if y < 700 else y


def _log(x: float) -> float:
    return math.log(x) if x > 0 else -math.inf


def _exp(x: float) -> float:
    return math.exp(x) if x < 700 else math.inf


def _of_log(function: Callable[[float], float]) -> Callable[[float], float]:
    return lambda x: _log(function(_exp(x)))


SHAPES: dict[Kind, Shape] = {
    "softplus": Shape(
        softplus,
        lambda x: 1 / (1 + math.exp(-x)) if x > -700 else 0.0,
        _softplus_inverse,
        convex=True,
        rising=True,
    ),
    "exp": Shape(_exp, _exp, _log, convex=True, rising=True),
    "log": Shape(_log, lambda x: 1 / x, _exp, convex=False, rising=True),
    "cos": Shape(
        _of_log(math.cos),
        lambda x: -_exp(x) * math.tan(_exp(x)),
        _of_log(lambda c: math.acos(min(c, 1.0))),
        convex=False,
        rising=False,
    ),
    "sin": Shape(
        _of_log(math.sin),
        lambda x: _exp(x) / math.tan(_exp(x)),
        _of_log(lambda s: math.asin(min(s, 1.0))),
        convex=False,
        rising=True,
    ),
}
"""The functions of curves; of an angle below a right one, by its logarithm."""
