"""Several objectives of one problem, and the scalar problems for the designs of their front.

A design of the front solves: minimise t subject to f_i <= a_i + r_i t for every normalised
objective i, within the requirements [PascolettiSerafini1984]. With r_i = 1 for all objectives, the
design is nearest to the ideal along the line through `a` that trades all objectives equally
[DasDennis1998]. An objective with r_i = 0 is only bounded.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from ...base.dataclass import dataclass
from ...base.numeric import Array
from ..evaluator import Evaluator, Point
from ..kkt import residual
from ..problem import BoxProblem, ParametricProblem, PointValues, Vector
from ..resolve.steps import RESIDUAL

LEVEL = "level of the objectives"
"""Name of the variable t."""

LOWEST, HIGHEST = -1.0, 2.0
"""Bounds of t, which is between -1 and 1 within the anchors."""


@dataclass(frozen=True)
class Objectives:
    """The objectives to be minimised together.

    Parameters
    ----------
    names : of the objectives
    problem : variables and constraints; its objective is ignored
    evaluate : maps points (n, k) to `PointValues` with objectives (objectives, k), to be minimised
    """

    names: Sequence[str]
    problem: BoxProblem
    evaluate: Callable[[Array], PointValues]

    @property
    def count(self) -> int:
        """Number of objectives."""
        return len(self.names)

    def selection(self) -> ParametricProblem:
        """The problem of one objective; the parameter is the index of the objective."""

        def evaluate(points: Array, parameters: Array) -> PointValues:
            values = self.evaluate(points)
            index = np.broadcast_to(np.asarray(parameters[0], dtype=np.intp), points.shape[1:])
            stacked = self._stacked(values, points)
            return replace(values, objective=stacked[index, np.arange(len(index))])

        return ParametricProblem(self.problem, ["objective"], np.zeros(1), evaluate)

    def single_problem(self, index: int) -> BoxProblem:
        """The problem of one objective."""
        return self.selection().at(np.array([index]))

    def evaluator_of(self, checked: Evaluator, index: int) -> Evaluator:
        """An evaluator of one objective that reuses the gradient check of `scaled`."""
        evaluator, m = Evaluator(self.single_problem(index)), len(self.problem.constraint_names)
        rows = [
            1 + m + index,
            *range(1, 1 + m),
            *range(1 + m + self.count, checked.problem.row_count),
        ]
        evaluator.complex_works = checked.complex_works
        evaluator.difference_rows = checked.difference_rows[rows]
        return evaluator

    def checked(self) -> tuple[Evaluator, tuple[str, ...]]:
        """An evaluator of `scaled` with checked gradients, and the warnings of the check."""
        problem = self.problem
        start = (problem.lower + problem.upper) / 2 if problem.start is None else problem.start
        size = np.abs(self.values(start[:, None])[:, 0])
        width = np.where(np.isfinite(size) & (size > 0), size, 1.0)
        evaluator = Evaluator(self.scaled(np.zeros(self.count), width).problem)
        point = evaluator.point(evaluator.space.to_z(np.append(start, HIGHEST / 2)))
        return evaluator, evaluator.check_gradients(point)

    def values(self, x: Vector) -> Vector:
        """Objectives (objectives, k) of points (n, k)."""
        with np.errstate(all="ignore"):
            return np.asarray(self._stacked(self.evaluate(x), x), dtype=float)

    def _stacked(self, point_values: PointValues, points: Array) -> Array:
        parts = point_values.objective
        return np.stack([np.broadcast_to(np.asarray(f), points.shape[1:]) for f in parts])

    def scaled(self, ideal: Vector, width: Vector) -> ParametricProblem:
        """Minimise t; the parameters are `a` (objectives,), then `r` (objectives,).

        `ideal` and `width` (objectives,) normalise: (f - ideal)/width.
        """
        problem, count = self.problem, self.count

        def evaluate(points: Array, parameters: Array) -> PointValues:
            x, level = points[:-1], points[-1]
            values = self.evaluate(x)
            unit = (self._stacked(values, x) - ideal[:, None]) / width[:, None]
            front = parameters[:count] + parameters[count:] * level - unit
            margins = front if values.constraints is None else _joined(values.constraints, front)
            return PointValues(level, margins, values.equalities)

        neutral = np.concatenate([np.zeros(count), np.ones(count)])
        start = problem.start
        grouped = problem.groups
        plain = replace(
            problem,
            names=(*problem.names, LEVEL),
            lower=np.append(problem.lower, LOWEST),
            upper=np.append(problem.upper, HIGHEST),
            evaluate=lambda points: evaluate(points, neutral[:, None]),
            constraint_names=(*problem.constraint_names, *self.names),
            start=None if start is None else np.append(start, HIGHEST / 2),
            relaxable=None,
            groups=None if grouped is None else (*grouped, *range(-count, 0)),
        )
        names = [f"{prefix} {name}" for prefix in ("level of", "way of") for name in self.names]
        return ParametricProblem(plain, names, neutral, evaluate)


def _joined(constraints: Array, front: Array) -> Array:
    constraints = np.asarray(constraints)
    shape = (len(constraints), front.shape[1])
    return np.concatenate([np.broadcast_to(constraints.reshape(shape[0], -1), shape), front])


@dataclass(frozen=True)
class Conditions:
    """The optimality conditions of a design of the front.

    A design of the front minimises at least one objective with the others bounded at their values.
    Its residual is the first below the tolerance of such a problem, else the smallest.
    """

    objectives: Objectives

    @cached_property
    def _evaluators(self) -> list[Evaluator]:
        """Evaluators of the problems that minimise one objective with the others bounded."""
        problem, names = self.objectives.problem, self.objectives.names
        return [
            Evaluator(
                replace(
                    problem,
                    constraint_names=(*problem.constraint_names, *names[:k], *names[k + 1 :]),
                    relaxable=None,
                    groups=None,
                )
            )
            for k in range(len(names))
        ]

    def residual(self, point: Point) -> float:
        """The residual at a point (variables and t) whose gradients are known."""
        smallest = np.inf
        for index in range(self.objectives.count):
            smallest = min(smallest, self._residual_of(point, index))
            if smallest <= RESIDUAL:
                break
        return float(smallest)

    def _residual_of(self, point: Point, index: int) -> float:
        """The residual of minimising one objective with the others bounded."""
        assert point.jacobian is not None
        count, problem = self.objectives.count, self.objectives.problem
        inner, size = len(problem.constraint_names), len(point.z) - 1
        front = slice(1 + inner, 1 + inner + count)
        bounded = [1 + inner + i for i in range(count) if i != index]
        slopes = point.jacobian[:, :size]
        order = [*range(1, 1 + inner), *bounded, *range(front.stop, len(point.rows))]
        # an objective of 1 makes a vanishing gradient count as 1e-3
        rows = np.concatenate([[1.0], point.rows[order]])
        rows[1 + inner : inner + count] = 0.0
        jacobian = np.concatenate([-slopes[front][index][None], slopes[order]])
        at = Point(point.z[:-1], point.x[:-1], rows, point.valid, point.violation, jacobian)
        return residual(self._evaluators[index], at)
