"""The functions of curves, of arrays."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from ..problem import Vector

Kind: TypeAlias = Literal["softplus", "exp", "log", "tanh"]
Function: TypeAlias = Callable[[Vector], Vector]

LEAST = 1e-300
"""Stands for zero under a logarithm."""


class Shape(NamedTuple):
    """A function that rises or falls throughout, with its slope and its inverse."""

    value: Function
    slope: Function
    inverse: Function
    convex: bool


def _softplus(x: Vector) -> Vector:
    """log(1 + e^x)."""
    return np.logaddexp(0.0, x)


def _softplus_inverse(y: Vector) -> Vector:
    """log(e^y - 1)."""
    held = np.maximum(y, LEAST)
    return held + np.log(-np.expm1(-held))


def _exp(x: Vector) -> Vector:
    return np.exp(np.minimum(x, 700.0))


def _log(x: Vector) -> Vector:
    return np.log(np.maximum(x, LEAST))


SHAPES: dict[Kind, Shape] = {
    "softplus": Shape(
        _softplus, lambda x: 1 / (1 + np.exp(-np.maximum(x, -700.0))), _softplus_inverse, True
    ),
    "exp": Shape(_exp, _exp, _log, True),
    "log": Shape(_log, lambda x: 1 / np.maximum(x, LEAST), _exp, False),
    "tanh": Shape(
        lambda x: _log(np.tanh(_exp(x))),
        lambda x: 2 * _exp(x) / np.sinh(np.minimum(2 * _exp(x), 700.0)),
        lambda y: _log(np.arctanh(np.minimum(_exp(y), 1 - 1e-16))),
        False,
    ),
}
"""The functions of curves; of the hyperbolic tangent, the logarithm by that of its argument."""


class Mixed:
    """Many curves of several kinds at once, one argument each."""

    def __init__(self, kinds: list[Kind]) -> None:
        names = np.array(kinds, dtype=object)
        self.parts = [(SHAPES[kind], np.flatnonzero(names == kind)) for kind in dict.fromkeys(kinds)]
        self.convex = np.array([SHAPES[kind].convex for kind in kinds], dtype=bool)

    def value(self, x: Vector) -> Vector:
        """The functions' values."""
        return self._each(lambda shape: shape.value, x)

    def slope(self, x: Vector) -> Vector:
        """Their slopes."""
        return self._each(lambda shape: shape.slope, x)

    def inverse(self, y: Vector) -> Vector:
        """Their arguments."""
        return self._each(lambda shape: shape.inverse, y)

    def _each(self, pick: Callable[[Shape], Function], x: Vector) -> Vector:
        found = np.empty_like(x)
        for shape, some in self.parts:
            found[some] = pick(shape)(x[some])
        return found
