"""Several objectives over one box and one set of margins, and their scalar problems.

A point of the front solves: minimise t subject to f_i <= a_i + r_i t for every objective i, in
normalised objectives, within the requirements [PascolettiSerafini1984]. With every r_i = 1 the
design is the nearest to the ideal along the line through `a` that trades all objectives equally
[DasDennis1998]. An objective with r_i = 0 is only bounded.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ...base.numeric import Array
from ..evaluator import Evaluator, Point
from ..kkt import residual
from ..problem import BoxProblem, ParametricProblem, PointValues, Vector
from ..resolve.parallel_descents import RESIDUAL

LEVEL = "level of the objectives"
"""Name of the variable t."""

LOWEST, HIGHEST = -1.0, 2.0
"""Bounds of t: between anchors it is within -1 and 1."""


@dataclass(frozen=True)
class Objectives:
    """The objectives to be minimised together.

    Parameters
    ----------
    names : of the objectives
    problem : variables and constraints; its own objective is ignored
    evaluate : maps points (n, k) to `PointValues` with objectives (objectives, k), to be minimised
    """

    names: Sequence[str]
    problem: BoxProblem
    evaluate: Callable[[Array], PointValues]

    @property
    def count(self) -> int:
        """Number of objectives."""
        return len(self.names)

    def picked(self) -> ParametricProblem:
        """The problem of a single objective; the parameter is its index."""

        def evaluate(points: Array, parameters: Array) -> PointValues:
            found = self.evaluate(points)
            which = np.broadcast_to(np.asarray(parameters[0], dtype=np.intp), points.shape[1:])
            stacked = self._stacked(found, points)
            return replace(found, objective=stacked[which, np.arange(len(which))])

        return ParametricProblem(self.problem, ["objective"], np.zeros(1), evaluate)

    def alone(self, index: int) -> BoxProblem:
        """The problem of one objective alone."""
        return self.picked().at(np.array([index]))

    def like(self, checked: Evaluator, index: int) -> Evaluator:
        """An evaluator of one objective, reusing the gradient check of `scaled`."""
        own, m = Evaluator(self.alone(index)), len(self.problem.constraint_names)
        rows = [
            1 + m + index,
            *range(1, 1 + m),
            *range(1 + m + self.count, checked.problem.row_count),
        ]
        own.complex_works = checked.complex_works
        own.difference_rows = checked.difference_rows[rows]
        return own

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
            found = self.evaluate(x)
            unit = (self._stacked(found, x) - ideal[:, None]) / width[:, None]
            front = parameters[:count] + parameters[count:] * level - unit
            margins = front if found.constraints is None else _joined(found.constraints, front)
            return PointValues(level, margins, found.equalities)

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
        names = [f"{what} {name}" for what in ("level of", "way of") for name in self.names]
        return ParametricProblem(plain, names, neutral, evaluate)


def _joined(constraints: Array, front: Array) -> Array:
    constraints = np.asarray(constraints)
    shape = (len(constraints), front.shape[1])
    return np.concatenate([np.broadcast_to(constraints.reshape(shape[0], -1), shape), front])


@dataclass(frozen=True)
class Conditions:
    """The optimality conditions of a design of the front.

    A design of the front minimises at least one objective with the others bounded at their values
    here. Its residual is that of the first such problem it solves, else the least.
    """

    objectives: Objectives

    @cached_property
    def _held(self) -> list[Evaluator]:
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
        least = np.inf
        for index in range(self.objectives.count):
            least = min(least, self._one(point, index))
            if least <= RESIDUAL:
                break
        return float(least)

    def _one(self, point: Point, index: int) -> float:
        """The residual of minimising one objective with the others bounded."""
        assert point.jacobian is not None
        count, problem = self.objectives.count, self.objectives.problem
        inner, size = len(problem.constraint_names), len(point.z) - 1
        front = slice(1 + inner, 1 + inner + count)
        others = [1 + inner + i for i in range(count) if i != index]
        slopes = point.jacobian[:, :size]
        order = [*range(1, 1 + inner), *others, *range(front.stop, len(point.rows))]
        rows = np.concatenate([[1.0], point.rows[order]])  # a vanishing gradient counts as 1e-3
        rows[1 + inner : inner + count] = 0.0
        jacobian = np.concatenate([-slopes[front][index][None], slopes[order]])
        at = Point(point.z[:-1], point.x[:-1], rows, point.valid, point.violation, jacobian)
        return residual(self._held[index], at)
