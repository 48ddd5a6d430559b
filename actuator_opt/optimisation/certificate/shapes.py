"""Functions of curves for arrays: analytic ones, and tables of samples."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np

from ..problem import Vector

Name: TypeAlias = Literal["softplus", "exp", "log", "tanh"]
Function: TypeAlias = Callable[[Vector], Vector]

LEAST = 1e-300
"""Substitute for zero under a logarithm."""

FAR = 200.0
"""Largest logarithm of an atom or a ratio; e^200 is beyond any quantity."""


class Shape(NamedTuple):
    """An increasing function with its slope and its inverse; convex (1) or concave (-1)."""

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
"""The functions of curves; the hyperbolic tangent in logarithms of argument and value."""


@dataclass(frozen=True, eq=False)
class Table:
    """A smooth function as equally spaced samples; `room` bounds the error between samples.

    `convex` is 1, -1 or 0 for neither.
    """

    low: float
    step: float
    values: Vector
    room: float
    convex: int
    rising: int
    """1, -1 or 0 for neither."""

    @classmethod
    def of(cls, t: Vector, values: Vector, caution: float) -> Table:
        """The table of samples at t; `caution` scales their second derivative."""
        step = float(t[1] - t[0])
        second = np.diff(values, 2)
        noise = 1e-12 * (1 + float(np.abs(values).max()))
        convex = 1 if second.min() >= -noise else -1 if second.max() <= noise else 0
        first = np.diff(values)
        rising = 1 if first.min() >= 0 else -1 if first.max() <= 0 else 0
        bend = caution * float(np.abs(second).max()) / step**2
        return cls(float(t[0]), step, values, bend * step * step / 8 + noise, convex, rising)


class Tables:
    """Several tables with equally many samples, one argument each."""

    def __init__(self, tables: Sequence[Table]) -> None:
        self.low = np.array([one.low for one in tables])
        self.step = np.array([one.step for one in tables])
        self.values = np.stack([one.values for one in tables])
        self.room = np.array([one.room for one in tables])
        self.convex = np.array([one.convex for one in tables])
        self.rising = np.array([one.rising for one in tables])
        self.last = self.values.shape[1] - 1
        self.rows = np.arange(len(tables))
        self.turning, self.waving = (
            np.flatnonzero(self.rising == 0),
            np.flatnonzero(self.convex == 0),
        )
        self._ordered = self.values * np.where(self.rising < 0, -1.0, 1.0)[:, None]

    def _place(self, x: Vector) -> tuple[np.ndarray, Vector]:
        place = (x - self.low) / self.step
        index = np.clip(place.astype(int), 0, self.last - 1)
        return index, np.clip(place - index, 0.0, 1.0)

    def value(self, x: Vector) -> Vector:
        """Linear interpolation between two samples."""
        index, share = self._place(x)
        first, second = self.values[self.rows, index], self.values[self.rows, index + 1]
        found: Vector = first * (1 - share) + second * share
        return found

    def slope(self, x: Vector) -> Vector:
        """Slope of the interpolation."""
        index, _ = self._place(x)
        rise = self.values[self.rows, index + 1] - self.values[self.rows, index]
        found: Vector = rise / self.step
        return found

    def _inside(self, low: Vector, high: Vector, some: np.ndarray) -> tuple[Vector, np.ndarray]:
        """Samples of some tables, and whether they lie within the ranges."""
        t = self.low[some, None] + self.step[some, None] * np.arange(self.last + 1)
        return t, (t > low[:, None]) & (t < high[:, None])

    def hull(self, low: Vector, high: Vector) -> tuple[Vector, Vector]:
        """Least and largest values over ranges."""
        ends = self.value(low), self.value(high)
        least, most = np.minimum(*ends), np.maximum(*ends)
        some = self.turning
        if len(some):
            _, inside = self._inside(low[some], high[some], some)
            values = self.values[some]
            least[some] = np.minimum(least[some], np.where(inside, values, np.inf).min(axis=1))
            most[some] = np.maximum(most[some], np.where(inside, values, -np.inf).max(axis=1))
        return least - self.room, most + self.room

    def apart(self, low: Vector, high: Vector, slope: Vector, some: Any) -> tuple[Vector, Vector]:
        """Least and largest distance of some tables from lines through their first values."""
        first, last = self.value(low)[some], self.value(high)[some]
        low, high, slope = low[some], high[some], slope[some]
        last = last - slope * (high - low) - first
        t, inside = self._inside(low, high, some)
        off = self.values[some] - slope[:, None] * (t - low[:, None]) - first[:, None]
        off = np.where(inside, off, 0.0)
        return (
            np.minimum(np.minimum(off.min(axis=1), last), 0.0),
            np.maximum(np.maximum(off.max(axis=1), last), 0.0),
        )

    def within(self, low: Vector, high: Vector) -> tuple[Vector, Vector]:
        """Ranges of arguments for ranges of values; the whole range if not monotonic."""
        falls = self.rising < 0
        first = np.where(falls, -high, low) - self.room
        second = np.where(falls, -low, high) + self.room
        ordered = self._ordered
        least = self._inverse(first, (ordered < first[:, None]).sum(axis=1), 0.0)
        most = self._inverse(second, (ordered <= second[:, None]).sum(axis=1), 1.0)
        least[self.turning] = self.low[self.turning]
        most[self.turning] = (self.low + self.step * self.last)[self.turning]
        return least, most

    def _inverse(self, wanted: Vector, below: np.ndarray, flat: float) -> Vector:
        """Arguments of values, from the number of samples below; at flat parts one of the ends."""
        ordered, rows = self._ordered, self.rows
        index = np.clip(below - 1, 0, self.last - 1)
        first, second = ordered[rows, index], ordered[rows, index + 1]
        rises = second > first
        share = np.where(rises, (wanted - first) / np.where(rises, second - first, 1.0), flat)
        found: Vector = self.low + self.step * (index + np.clip(share, 0.0, 1.0))
        return found


Kind: TypeAlias = Name | Table


class Mixed:
    """Many curves of several kinds, one argument each."""

    def __init__(self, kinds: Sequence[Kind]) -> None:
        tables = [kind for kind in kinds if isinstance(kind, Table)]
        self.tabled = np.array(
            [k for k, kind in enumerate(kinds) if isinstance(kind, Table)], dtype=np.intp
        )
        self.tables = Tables(tables) if tables else None
        names = np.array([kind if isinstance(kind, str) else "" for kind in kinds], dtype=object)
        self.parts = [(shape, np.flatnonzero(names == name)) for name, shape in SHAPES.items()]
        self.convex = np.zeros(len(kinds), dtype=int)
        self.room = np.zeros(len(kinds))
        for shape, some in self.parts:
            self.convex[some] = shape.convex
        if self.tables is not None:
            self.convex[self.tabled], self.room[self.tabled] = self.tables.convex, self.tables.room

    def value(self, x: Vector) -> Vector:
        """The functions' values."""
        found = np.empty_like(x)
        for shape, some in self.parts:
            found[some] = shape.value(x[some])
        if self.tables is not None:
            found[self.tabled] = self.tables.value(x[self.tabled])
        return found

    def slope(self, x: Vector) -> Vector:
        """Their slopes."""
        found = np.empty_like(x)
        for shape, some in self.parts:
            found[some] = shape.slope(x[some])
        if self.tables is not None:
            found[self.tabled] = self.tables.slope(x[self.tabled])
        return found

    def hull(self, low: Vector, high: Vector) -> tuple[Vector, Vector]:
        """Ranges of the values over ranges of the arguments."""
        least, most = np.empty_like(low), np.empty_like(high)
        for shape, some in self.parts:
            least[some], most[some] = shape.value(low[some]), shape.value(high[some])
        if self.tables is not None:
            some = self.tabled
            least[some], most[some] = self.tables.hull(low[some], high[some])
        return least, most

    def apart(self, low: Vector, high: Vector, slope: Vector) -> tuple[Vector, Vector]:
        """Distance of functions with both curvatures from their secants, below and above."""
        least, most = np.zeros_like(low), np.zeros_like(low)
        if self.tables is not None:
            some, own = self.tables.waving, self.tabled
            if len(some):
                least[own[some]], most[own[some]] = self.tables.apart(
                    low[own], high[own], slope[own], some
                )
        return least, most

    def within(self, low: Vector, high: Vector) -> tuple[Vector, Vector]:
        """Ranges of the arguments whose values lie in ranges."""
        least, most = np.empty_like(low), np.empty_like(high)
        for shape, some in self.parts:
            least[some], most[some] = shape.inverse(low[some]), shape.inverse(high[some])
        if self.tables is not None:
            some = self.tabled
            least[some], most[some] = self.tables.within(low[some], high[some])
        return least, most
