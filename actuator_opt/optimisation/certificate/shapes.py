"""The functions of curves, of arrays: analytic ones, and tables of sampled ones."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from ..problem import Vector

Name: TypeAlias = Literal["softplus", "exp", "log", "tanh"]
Function: TypeAlias = Callable[[Vector], Vector]

LEAST = 1e-300
"""Stands for zero under a logarithm."""

FAR = 200.0
"""Largest logarithm of an atom or a ratio; e^200 is beyond any quantity."""


class Shape(NamedTuple):
    """A function that rises throughout, with its slope and its inverse; convex (1) or concave."""

    value: Function
    slope: Function
    inverse: Function
    convex: int


def _softplus_inverse(y: Vector) -> Vector:
    """log(e^y - 1)."""
    held = np.maximum(y, LEAST)
    return held + np.log(-np.expm1(-held))


def _exp(x: Vector) -> Vector:
    return np.exp(np.minimum(x, 700.0))


def _log(x: Vector) -> Vector:
    return np.log(np.maximum(x, LEAST))


SHAPES: dict[Name, Shape] = {
    "softplus": Shape(
        lambda x: np.logaddexp(0.0, x),
        lambda x: 1 / (1 + np.exp(-np.maximum(x, -700.0))),
        _softplus_inverse,
        1,
    ),
    "exp": Shape(_exp, _exp, _log, 1),
    "log": Shape(_log, lambda x: 1 / np.maximum(x, LEAST), _exp, -1),
    "tanh": Shape(
        lambda x: _log(np.tanh(_exp(x))),
        lambda x: 2 * _exp(x) / np.sinh(np.minimum(2 * _exp(x), 700.0)),
        lambda y: _log(np.arctanh(np.minimum(_exp(y), 1 - 1e-16))),
        -1,
    ),
}
"""The functions of curves; of the hyperbolic tangent, the logarithm by that of its argument."""


@dataclass(frozen=True, eq=False)
class Table:
    """A smooth function by equally spaced samples; `room` holds what lies between two of them.

    `convex` is 1, -1 or, of neither, 0.
    """

    low: float
    step: float
    values: Vector
    room: float
    convex: int
    rising: int
    """1, -1 or, of neither, 0."""

    @classmethod
    def of(cls, t: Vector, values: Vector, caution: float) -> Table:
        """The table of samples at t; the second derivative is that of the samples, and more."""
        step = float(t[1] - t[0])
        second = np.diff(values, 2)
        noise = 1e-12 * (1 + float(np.abs(values).max()))
        convex = 1 if second.min() >= -noise else -1 if second.max() <= noise else 0
        first = np.diff(values)
        rising = 1 if first.min() >= 0 else -1 if first.max() <= 0 else 0
        bend = caution * float(np.abs(second).max()) / step**2
        return cls(float(t[0]), step, values, bend * step * step / 8 + noise, convex, rising)

    def _place(self, x: Vector) -> tuple[np.ndarray, Vector]:
        place = (np.asarray(x) - self.low) / self.step
        index = np.clip(place.astype(int), 0, len(self.values) - 2)
        return index, np.clip(place - index, 0.0, 1.0)

    def value(self, x: Vector) -> Vector:
        """Between two samples on a straight line."""
        index, share = self._place(x)
        found: Vector = self.values[index] * (1 - share) + self.values[index + 1] * share
        return found

    def slope(self, x: Vector) -> Vector:
        """Of the line between two samples."""
        index, _ = self._place(x)
        found: Vector = (self.values[index + 1] - self.values[index]) / self.step
        return found

    def hull(self, low: float, high: float) -> tuple[float, float]:
        """Least and largest value over a range."""
        ends = self.value(np.array([low, high]))
        if not self.rising:
            first, last = self._place(np.array([low, high]))[0]
            ends = np.concatenate([ends, self.values[first + 1 : last + 1]])
        return float(ends.min()) - self.room, float(ends.max()) + self.room

    def apart(self, low: float, high: float, slope: float) -> tuple[float, float]:
        """Least and largest distance from a line through the value at the lower end of a range."""
        ends = np.array([low, high])
        first, last = self._place(ends)[0]
        inside = np.arange(first + 1, last + 1)
        t = np.concatenate([ends, self.low + self.step * inside])
        off = np.concatenate([self.value(ends), self.values[inside]]) - slope * (t - low)
        off = off - off[0]
        return float(off.min()), float(off.max())

    def within(self, low: float, high: float) -> tuple[float, float]:
        """Least and largest argument of values in a range; all of them where it turns."""
        last = self.low + self.step * (len(self.values) - 1)
        if not self.rising:
            return self.low, last
        t = np.linspace(self.low, last, len(self.values))
        values = self.values if self.rising > 0 else -self.values
        ends = (low, high) if self.rising > 0 else (-high, -low)
        least = float(np.interp(ends[0] - self.room, values, t))
        return least, float(np.interp(ends[1] + self.room, values, t))


Kind: TypeAlias = Name | Table


class Mixed:
    """Many curves of several kinds at once, one argument each."""

    def __init__(self, kinds: Sequence[Kind]) -> None:
        self.tables = [(k, kind) for k, kind in enumerate(kinds) if isinstance(kind, Table)]
        names = np.array([kind if isinstance(kind, str) else "" for kind in kinds], dtype=object)
        self.parts = [(shape, np.flatnonzero(names == name)) for name, shape in SHAPES.items()]
        self.convex = np.zeros(len(kinds), dtype=int)
        self.room = np.zeros(len(kinds))
        for shape, some in self.parts:
            self.convex[some] = shape.convex
        for k, table in self.tables:
            self.convex[k], self.room[k] = table.convex, table.room

    def value(self, x: Vector) -> Vector:
        """The functions' values."""
        found = np.empty_like(x)
        for shape, some in self.parts:
            found[some] = shape.value(x[some])
        for k, table in self.tables:
            found[k] = table.value(x[k])
        return found

    def slope(self, x: Vector) -> Vector:
        """Their slopes."""
        found = np.empty_like(x)
        for shape, some in self.parts:
            found[some] = shape.slope(x[some])
        for k, table in self.tables:
            found[k] = table.slope(x[k])
        return found

    def hull(self, low: Vector, high: Vector) -> tuple[Vector, Vector]:
        """Ranges of the values over ranges of the arguments."""
        least, most = np.empty_like(low), np.empty_like(high)
        for shape, some in self.parts:
            least[some], most[some] = shape.value(low[some]), shape.value(high[some])
        for k, table in self.tables:
            least[k], most[k] = table.hull(low[k], high[k])
        return least, most

    def apart(self, low: Vector, high: Vector, slope: Vector) -> tuple[Vector, Vector]:
        """How far functions that bend both ways leave their secants, below and above."""
        least, most = np.zeros_like(low), np.zeros_like(low)
        for k, table in self.tables:
            if not table.convex:
                least[k], most[k] = table.apart(low[k], high[k], slope[k])
        return least, most

    def within(self, low: Vector, high: Vector) -> tuple[Vector, Vector]:
        """Ranges of the arguments whose values lie in ranges."""
        least, most = np.empty_like(low), np.empty_like(high)
        for shape, some in self.parts:
            least[some], most[some] = shape.inverse(low[some]), shape.inverse(high[some])
        for k, table in self.tables:
            least[k], most[k] = table.within(low[k], high[k])
        return least, most
