"""Several objectives of one problem, and the single-objective problems that give front designs.

A front design solves: minimise t subject to f_i <= a_i + r_i t for every normalised objective f_i,
and to all requirements [PascolettiSerafini1984]. The level a_i and the direction r_i are given.
If r_i = 1 for all objectives, the limits a_i + t form a line along which all objectives improve
equally; the design is as near to the ideal as this line permits [DasDennis1998]. An objective with
r_i = 0 only has to stay below a_i.
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
"""Bounds of t; between the designs that are best in one objective each, t is between -1 and 1."""


@dataclass(frozen=True)
class Objectives:
    """Several objectives, all to be minimised, of one problem.

    Parameters
    ----------
    names : names of the objectives
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
        """The problem of minimising one objective; its parameter is the index of that objective."""

        def evaluate(points: Array, parameters: Array) -> PointValues:
            values = self.evaluate(points)
            index = np.broadcast_to(np.asarray(parameters[0], dtype=np.intp), points.shape[1:])
            stacked = self._stacked(values, points)
            return replace(values, objective=stacked[index, np.arange(len(index))])

        return ParametricProblem(self.problem, ["objective"], np.zeros(1), evaluate)

    def single_problem(self, index: int) -> BoxProblem:
        """The problem with only the objective `index`."""
        return self.selection().at(np.array([index]))

    def evaluator_of(self, checked: Evaluator, index: int) -> Evaluator:
        """An evaluator for one objective; it reuses the gradient check of `checked`.

        `checked` is the evaluator that the method `checked` returns.
        """
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
        """An evaluator of the problem to minimise t, gradients checked; warnings of the check."""
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
        """The problem to minimise t; parameters: `a` (objectives,), then `r` (objectives,).

        Objectives f are normalised as (f - ideal)/width; `ideal` and `width` are (objectives,).
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
    """Checks the optimality conditions of a front design.

    A front design minimises at least one objective while the others may not exceed their values at
    the design. Each objective therefore gives one problem to check, in which this objective is
    minimised. The optimality conditions of each problem have a residual. The residual of the design
    is the first of them that is at most the tolerance, or else the smallest.
    """

    objectives: Objectives

    @cached_property
    def _evaluators(self) -> list[Evaluator]:
        """For each objective: evaluator of the problem that minimises it and bounds the others."""
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
        """The residual at a point (variables and t) with known gradients."""
        smallest = np.inf
        for index in range(self.objectives.count):
            smallest = min(smallest, self._residual_of(point, index))
            if smallest <= RESIDUAL:
                break
        return float(smallest)

    def _residual_of(self, point: Point, index: int) -> float:
        """The residual of the problem that minimises one objective and bounds the others."""
        assert point.jacobian is not None
        count, problem = self.objectives.count, self.objectives.problem
        inner, size = len(problem.constraint_names), len(point.z) - 1
        front = slice(1 + inner, 1 + inner + count)
        bounded = [1 + inner + i for i in range(count) if i != index]
        slopes = point.jacobian[:, :size]
        order = [*range(1, 1 + inner), *bounded, *range(front.stop, len(point.rows))]
        # with an objective of 1, `slope_scale` replaces a vanishing gradient by 1e-3
        rows = np.concatenate([[1.0], point.rows[order]])
        rows[1 + inner : inner + count] = 0.0
        jacobian = np.concatenate([-slopes[front][index][None], slopes[order]])
        at = Point(point.z[:-1], point.x[:-1], rows, point.valid, point.violation, jacobian)
        return residual(self._evaluators[index], at)
