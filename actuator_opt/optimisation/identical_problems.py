"""Problems that differ in nothing that a search of another one rests on: its result is theirs too.

Combinations of choices often differ in numbers that only enter limits nothing hangs on: oils of one
bulk modulus in their viscosity. What a search of listed sizes came to rests on where its boxes
ended, the optimum of each or the point that misses least. Where two problems have the same values
and slopes there, but for rows whose limits are farther off than any optimum is from where its box
ended, the boxes of both have the same optima.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .evaluator import Evaluator, Point
from .problem import BoxProblem, Vector
from .resolve.boxes import NEAR

EQUAL = 1e-6
"""Relative difference of continuous optima that counts as none: quick looks know them so well."""


@dataclass(frozen=True)
class Evidence:
    """Where the boxes of a search of a problem ended; `optimum` is its continuous objective."""

    problem: BoxProblem
    optimum: float
    ends: Sequence[tuple[Evaluator, Point]]

    def holds_for(self, other: BoxProblem, optimum: float) -> bool:
        """Whether a search of another problem would end as this one did."""
        one = self.problem
        if not self.ends or abs(optimum - self.optimum) > EQUAL * abs(self.optimum):
            return False
        same = one.names == other.names and one.constraint_names == other.constraint_names
        boxed = np.array_equal(one.lower, other.lower) and np.array_equal(one.upper, other.upper)
        exact = all(evaluator.exact for evaluator, _ in self.ends)
        if not (same and boxed and exact) or one.equality_names or other.equality_names:
            return False
        parts = [evaluator.columns(end.z[:, None]) for evaluator, end in self.ends]
        rows = np.split(
            other.rows(np.concatenate(parts, axis=1)),
            np.cumsum([part.shape[1] for part in parts])[:-1],
            axis=1,
        )
        found = [
            (end, evaluator.jacobian(end), *evaluator.values_and_slopes(part))
            for (evaluator, end), part in zip(self.ends, rows, strict=True)
        ]
        differing = np.zeros(one.row_count, dtype=bool)
        for end, slopes, values, others in found:
            differing |= (values[:, 0] != end.rows) | (slopes != others).any(axis=1)
        return not differing[0] and all(
            (_distance(end.rows, slopes)[differing] > NEAR.step).all()
            and (_distance(values[:, 0], others)[differing] > NEAR.step).all()
            for end, slopes, values, others in found
        )


def _distance(rows: Vector, slopes: Vector) -> Vector:
    """How far off the limits of rows are in solver coordinates, by their slopes."""
    return np.asarray(rows / np.maximum(np.sqrt((slopes**2).sum(axis=1)), 1e-300))
