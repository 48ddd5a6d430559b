"""Variables with listed values, singly or in groups, and boxes of such values."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from .problem import Vector

ON = 1e-7
"""Distance from a listed value, relative to the spacing, that counts as none."""

SAME = 1e-9
"""Relative difference of objectives that counts as none."""

Rows: TypeAlias = tuple[int, ...]
"""Selected rows of a group of listed variables, ascending."""

Box: TypeAlias = tuple[Rows, ...]
"""The remaining rows of every group."""

Assignment: TypeAlias = tuple[int, ...]
"""One row of every group."""


@dataclass(frozen=True, eq=False)
class Listed:
    """A group of variables with listed values; a row is an allowed combination.

    Parameters
    ----------
    index : of the variables (k,)
    rows : values (c, k) within their bounds, all different
    """

    index: tuple[int, ...]
    rows: Vector

    def values(self, column: int, rows: Rows) -> Vector:
        """The distinct values of a column in some rows, ascending."""
        return np.unique(self.rows[list(rows), column])

    def parts(self, rows: Rows, row: int) -> list[Rows]:
        """The other rows, split into parts that a bound of one variable separates from this row."""
        parts: list[Rows] = []
        for column, value in enumerate(self.rows[row]):
            of = self.rows[:, column]
            parts += [
                tuple(k for k in rows if of[k] < value),
                tuple(k for k in rows if of[k] > value),
            ]
            rows = tuple(k for k in rows if of[k] == value)
        return [part for part in parts if part]

    def at(self, x: Vector, rows: Rows) -> int | None:
        """The row at a point (k,), or None."""
        span = np.ptp(self.rows, axis=0)
        near = np.abs(self.rows[list(rows)] - x) <= ON * span + SAME * np.abs(x)
        found = np.flatnonzero(near.all(axis=1))
        return rows[int(found[0])] if len(found) else None

    def around(self, x: Vector) -> list[int]:
        """The nearest rows of a point (k,), for all roundings; only itself if it is a row."""
        every = tuple(range(len(self.rows)))
        here = self.at(x, every)
        if here is not None:
            return [here]
        span = np.ptp(self.rows, axis=0)
        off = (self.rows - x) / np.where(span > 0, span, 1.0)
        distance = np.abs(off).sum(axis=1)
        found = []
        for sides in itertools.product((1, -1), repeat=len(x)):
            there = np.flatnonzero((off * sides >= -ON).all(axis=1))
            if len(there):
                found.append(int(there[distance[there].argmin()]))
        found = found or [int(distance.argmin())]
        return sorted(dict.fromkeys(found), key=lambda row: float(distance[row]))


def with_rows(box: Box, k: int, rows: Rows) -> Box:
    """A box with the rows of one group replaced."""
    return (*box[:k], rows, *box[k + 1 :])


def between(values: Vector, value: float) -> tuple[float, float, float]:
    """The neighbouring values and the relative distance to the nearest (0 to 0.5)."""
    if len(values) == 1:
        return float(values[0]), float(values[0]), 0.0
    k = int(np.clip(np.searchsorted(values, value), 1, len(values) - 1))
    low, high = float(values[k - 1]), float(values[k])
    share = min(value - low, high - value) / (high - low)
    return low, high, max(share, 0.0)
