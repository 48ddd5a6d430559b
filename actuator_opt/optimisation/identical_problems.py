"""Detects problems for which a search of listed sizes would repeat an earlier search.

Combinations of choices often differ only in numbers that enter inactive limits, such as the
viscosity of oils with the same bulk modulus. The search of listed sizes depends on the result of
each box (part) of the search space: the box's optimum or its least infeasible point. If values and
slopes of two problems agree at these points, both searches give the same results. A limit may
differ between the problems if all these points are farther from it than their accuracy.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..base.dataclass import dataclass
from .evaluator import Evaluator, Point
from .problem import BoxProblem, Vector
from .resolve.boxes import NEAR

SAME_OPTIMUM = 1e-6
"""Continuous optima count as equal up to this relative difference, the accuracy of quick looks."""


@dataclass(frozen=True)
class Evidence:
    """Results of all boxes (parts of the space) of a search, and the continuous `optimum`."""

    problem: BoxProblem
    optimum: float
    ends: Sequence[tuple[Evaluator, Point]]

    def holds_for(self, other: BoxProblem, optimum: float) -> bool:
        """Whether a search of another problem would give the same result."""
        problem = self.problem
        if not self.ends or abs(optimum - self.optimum) > SAME_OPTIMUM * abs(self.optimum):
            return False
        if problem.names != other.names or not problem.same_rows_and_box(other):
            return False
        exact = all(evaluator.exact for evaluator, _ in self.ends)
        if not exact or problem.equality_names or other.equality_names:
            return False
        parts = [evaluator.columns(end.z[:, None]) for evaluator, end in self.ends]
        rows = np.split(
            other.rows(np.concatenate(parts, axis=1)),
            np.cumsum([part.shape[1] for part in parts])[:-1],
            axis=1,
        )
        comparisons = [
            (end, evaluator.jacobian(end), *evaluator.values_and_slopes(part))
            for (evaluator, end), part in zip(self.ends, rows, strict=True)
        ]
        differing = np.zeros(problem.row_count, dtype=bool)
        for end, slopes, values, other_slopes in comparisons:
            differing |= (values[:, 0] != end.rows) | (slopes != other_slopes).any(axis=1)
        return not differing[0] and all(
            (_distance(end.rows, slopes)[differing] > NEAR.step).all()
            and (_distance(values[:, 0], other_slopes)[differing] > NEAR.step).all()
            for end, slopes, values, other_slopes in comparisons
        )


def _distance(rows: Vector, slopes: Vector) -> Vector:
    """Distance to each limit in solver coordinates, estimated from margin and slope."""
    return np.asarray(rows / np.maximum(np.sqrt((slopes**2).sum(axis=1)), 1e-300))
