"""Lines of the linear programme: chords and tangents of curves, each over one direction."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..problem import Vector


class Lines(NamedTuple):
    """low <= out + coefficient * ratio <= high, by columns of curve and direction."""

    ratio: Any
    coefficient: Vector
    out: Any
    low: Vector
    high: Vector

    def joined(self, more: Lines) -> Lines:
        """These lines followed by others."""
        return Lines(*(np.concatenate(pair) for pair in zip(self, more, strict=True)))

    def put(self, solver: Any) -> None:
        """Add the lines to a programme as rows."""
        count = len(self.low)
        indices = np.stack([self.ratio, self.out], axis=1).ravel().astype(np.int32)
        data = np.stack([self.coefficient, np.ones(count)], axis=1).ravel()
        starts = 2 * np.arange(count, dtype=np.int32)
        solver.addRows(count, self.low, self.high, 2 * count, starts, indices, data)


class Seen:
    """Least and largest value of every direction over known points of the relaxation."""

    def __init__(self, directions: Vector) -> None:
        self.ends = directions.copy(), directions.copy()

    def add(self, directions: Vector) -> None:
        """Include another point."""
        np.minimum(self.ends[0], directions, out=self.ends[0])
        np.maximum(self.ends[1], directions, out=self.ends[1])
