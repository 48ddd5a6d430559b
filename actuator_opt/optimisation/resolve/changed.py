"""Solves several problems together that differ from a solved problem only in parameter values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ...base.dataclass import dataclass
from ...base.numeric import STEP
from .. import kinks
from ..evaluator import Evaluator, Point
from ..problem import ParametricProblem, Vector
from ..solution import MET
from .steps import (
    FEASIBLE,
    LONGEST,
    RESIDUAL,
    Descent,
    Result,
    Steps,
    Valley,
    full_steps,
    is_met,
    restoring_steps,
    run_batch,
    trusted_steps,
    valley_at,
)


def applicable(parametric: ParametricProblem, evaluator: Evaluator) -> bool:
    """Whether `ChangedProblems` is applicable: no equalities, all gradients by complex steps."""
    exact = evaluator.complex_works and not evaluator.difference_rows.any()
    return exact and not parametric.problem.equality_names


@dataclass(frozen=True)
class ChangedProblems:
    """A solved problem with nf free variables, and K sets of other values for its parameters.

    Parameters
    ----------
    parametric : the problem with its parameters
    evaluator : evaluator of the solved problem, with exact gradients
    parameters : values of the parameters of each changed problem (q, K)
    """

    parametric: ParametricProblem
    evaluator: Evaluator
    parameters: Vector

    def subset(self, numbers: Sequence[int]) -> ChangedProblems:
        """The problems with the given numbers (positions in this list)."""
        return replace(self, parameters=self.parameters[:, list(numbers)])

    def points(self, z: Vector, numbers: Sequence[int] | None = None) -> list[Point]:
        """Points with gradients at coordinates z (nf, k), one point for each problem in `numbers`.

        By default, `numbers` means all problems. This takes one complex evaluation. Raises
        `LimitReached` at the evaluator's limits.
        """
        evaluator, parameters = self.evaluator, self.parameters
        evaluator.check_limits()
        parameters = parameters if numbers is None else parameters[:, list(numbers)]
        space, (nf, count) = evaluator.space, z.shape
        x = space.to_x(z)
        if nf:
            problem = self.parametric.with_columns(np.repeat(parameters, nf, axis=1))
            rows = problem.rows(space.complex_steps(x)).reshape(-1, count, nf)
            values, slopes = rows.real[:, :, 0], np.asarray(rows.imag / STEP, dtype=float)
        else:  # every variable is fixed
            values = np.real(self.parametric.with_columns(parameters).rows(x))
            slopes = np.empty((*values.shape, 0))
        values = Evaluator.screen(values)
        violation = evaluator.violations(values, "worst")
        valid = np.isfinite(values).all(axis=0) & np.isfinite(slopes).all(axis=(0, 2))
        return [
            Point(z[:, k], x[:, k], values[:, k], bool(valid[k]), float(violation[k]), slopes[:, k])
            for k in range(count)
        ]

    def run(self, solvers: Sequence[Steps[Result]]) -> list[Result]:
        """Run one solver for each problem, all in parallel, and return their results."""

        def evaluate(requests: Mapping[int, Vector]) -> list[Point]:
            return self.points(np.stack(list(requests.values()), axis=1), list(requests))

        return run_batch(solvers, evaluate)

    def step_fully(self, descents: Sequence[Descent], starts: Vector) -> list[Point | None]:
        """The optimum of each problem, reached by `full_steps` from starts (nf, K)."""
        return self.run(
            [full_steps(self.evaluator, *pair) for pair in zip(descents, starts.T, strict=True)]
        )

    def descend(
        self, descents: Sequence[Descent], starts: Vector, max_evaluations: int = LONGEST
    ) -> list[Point | None]:
        """The optimum of each problem, reached by `trusted_steps` from starts (nf, K)."""
        return self.run(
            [
                trusted_steps(self.evaluator, *pair, max_evaluations)
                for pair in zip(descents, starts.T, strict=True)
            ]
        )

    def restore(self, start: Vector) -> list[Vector | None]:
        """A feasible point (nf,) of each problem, found from one start (nf,); None if not found."""
        count = self.parameters.shape[1]
        results = self.run([restoring_steps(self.evaluator, start) for _ in range(count)])
        return [None if result.feasible is None else result.feasible.z for result in results]

    def margins_at(self, points: Sequence[Point]) -> Vector:
        """Objective and constraints (rows, points, K) of the given points in each problem."""
        count, size = self.parameters.shape[1], len(points)
        x = np.stack([p.x for p in points], axis=1)
        problem = self.parametric.with_columns(np.tile(self.parameters, size))
        return Evaluator.screen(problem.rows(np.repeat(x, count, axis=1))).reshape(-1, size, count)

    def near_optimum(self, valley: Valley, starts: Vector) -> list[Point | None]:
        """The optimum of each problem, by full steps with the Hessian of the solved problem.

        None if the steps do not converge, or if the optimum of the solved problem is feasible and
        better in the changed problem.

        Parameters
        ----------
        valley : the optimum of the solved problem
        starts : starting coordinates (nf, K)
        """
        if starts.shape[1] == 0:
            return []
        evaluator, point = self.evaluator, valley.point
        if (starts == point.z[:, None]).all():  # evaluate the unchanged optimum once
            points = self.points(starts)
            unmoved_objectives = [
                p.objective if p.violation <= FEASIBLE else np.inf for p in points
            ]
            first_points: Sequence[Point | Vector] = points
        else:
            first_points = list(starts.T)
            margins = self.margins_at([point])[:, 0]
            feasible = evaluator.violations(margins, "worst") <= FEASIBLE
            unmoved_objectives = np.where(feasible, margins[0], np.inf).tolist()
        optima = self.run([full_steps(evaluator, valley.full(), start) for start in first_points])
        missing = [k for k, optimum in enumerate(optima) if optimum is None]
        on_kink = self.subset(missing).near_kink(valley.point, starts[:, missing])
        for k, optimum in zip(missing, on_kink, strict=True):
            optima[k] = optimum
        return [
            None  # the steps led to another valley
            if optimum is not None and unmoved < optimum.objective - 1e-9 * abs(optimum.objective)
            else optimum
            for optimum, unmoved in zip(optima, unmoved_objectives, strict=True)
        ]

    def near_kink(self, point: Point, starts: Vector) -> list[Point | None]:
        """The optimum of each problem that stays on the kinks of the solved problem's optimum.

        None for all problems if the optimum `point` is not on a kink. `starts` are coordinates
        (nf, K).
        """
        results: list[Point | None] = [None] * starts.shape[1]
        if not results:
            return results
        point = self.evaluator.point(point.z)
        first, *others = kinks.pieces(self.parametric, self.evaluator, point)
        if not others:
            return results
        valley = valley_at(first.evaluator, first.point)
        smooth = replace(self, parametric=first.parametric, evaluator=first.evaluator)
        ends = smooth.run([full_steps(first.evaluator, valley.full(), z) for z in starts.T])
        for k, end in enumerate(ends):
            if end is not None:
                evaluator = Evaluator(self.parametric.at(self.parameters[:, k]))
                evaluator.adopt_check(self.evaluator)
                optimum = evaluator.point(end.z)
                if is_met(optimum) and kinks.check(evaluator, optimum).residual <= RESIDUAL:
                    results[k] = optimum
        return results

    def descend_from(
        self, valley: Valley, starts: Vector
    ) -> tuple[list[Point | None], list[Point | None]]:
        """The optimum of each problem, reached by descents, or else a feasible point.

        Two lists: the optima (None if not reached), and a feasible point for each problem without
        an optimum (None if not found).

        Parameters
        ----------
        valley : a local optimum of the solved problem
        starts : feasible coordinates (nf, K)
        """
        descents = [valley.trusted() for _ in starts.T]
        optima = self.descend(descents, starts)
        stopped = [
            descent.point
            if optimum is None and descent.point is not None and descent.point.violation <= MET
            else None
            for optimum, descent in zip(optima, descents, strict=True)
        ]
        return optima, stopped
