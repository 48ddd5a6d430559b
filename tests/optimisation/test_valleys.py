"""Several local optima: which of them count, and which changed problems descend into them."""

from __future__ import annotations

import numpy as np
import pytest

from actuator_opt.optimisation.evaluator import Evaluator
from actuator_opt.optimisation.prices import prices
from actuator_opt.optimisation.problem import BoxProblem, ParametricProblem, PointValues
from actuator_opt.optimisation.resolve import ladder
from actuator_opt.optimisation.resolve.changed import ChangedProblems
from actuator_opt.optimisation.solver import solve

NAMES = ("a", "b")


def problem_of(evaluate, parameters, constraints):
    """A problem in a and b between 0.4 and 4, with parameters p0, p1, ..."""
    values = np.array(parameters, dtype=float)
    box = BoxProblem(
        NAMES,
        np.full(2, 0.4),
        np.full(2, 4.0),
        lambda x: evaluate(x, values[:, None]),
        constraints,
    )
    names = tuple(f"p{k}" for k in range(len(values)))
    return ParametricProblem(box, names, values, evaluate)


def wells(b):
    """Zero at b = 1 and b = 3, with a ridge between them."""
    return 10 * ((b - 1) * (b - 3)) ** 2


def test_equally_good_optima_side_by_side_are_one_valley():
    """Any b is as good, as long as it is below 3 a."""
    problem = problem_of(
        lambda x, p: PointValues(x[0], np.stack([x[0] / p[0] - 1, 3 * x[0] - x[1]])),
        [1.2],
        ("p0", "b"),
    ).problem
    solution = solve(problem)
    ends = {round(float(optimum.x[1]), 3) for optimum in solution.optima}
    assert len(ends) > 1
    assert ladder.other_optima(Evaluator(problem), solution) == []


def test_equally_good_optima_with_a_ridge_between_are_two_valleys():
    """Both wells are as deep."""
    problem = problem_of(
        lambda x, p: PointValues(x[0] + wells(x[1]), (x[0] / p[0] - 1)[None]), [1.2], ("p0",)
    ).problem
    solution = solve(problem)
    (other,) = ladder.other_optima(Evaluator(problem), solution)
    assert sorted([solution.x[1], other.x[1]]) == pytest.approx([1, 3], abs=1e-6)


def tilted(x, p):
    """With p0, the well at b = 3 gains on that at b = 1; p1 raises both alike."""
    least = x[0] / (p[0] * (4 - x[1]) / 3) - 1
    return PointValues(x[0] + 0.34 * x[1] + wells(x[1]) + p[1], np.stack([least, x[0] * 0 + 1]))


def best_of(p0, p1):
    """Least objective on a fine line, with a as small as the limit allows."""
    b = np.linspace(0.4, 4, 2_000_001)
    return float((np.maximum(p0 * (4 - b) / 3, 0.4) + 0.34 * b + wells(b) + p1).min())


def test_only_problems_that_may_gain_descend_into_another_valley(monkeypatch):
    """More p0 makes the other valley the better one; less p0, and any p1, do not."""
    restored = []
    restore = ChangedProblems.restore

    def recorded(self, start):
        if self.evaluator.space.to_x(start[:, None])[1] > 2.5:  # in the other valley
            restored.append(self.parameters.copy())
        return restore(self, start)

    parametric = problem_of(tilted, [1.0, 0.5], ("p0", "positive"))
    solution = solve(parametric.problem)
    assert solution.x[1] == pytest.approx(1, abs=0.05)
    monkeypatch.setattr(ChangedProblems, "restore", recorded)
    rows = {row.parameter: row for row in prices(parametric, solution)}
    assert rows["p0"].resolved_up == pytest.approx(best_of(1.1, 0.5), rel=1e-9)
    assert rows["p0"].resolved_down == pytest.approx(best_of(0.9, 0.5), rel=1e-9)
    assert rows["p1"].resolved_up == pytest.approx(best_of(1.0, 0.55), rel=1e-9)
    assert rows["p1"].resolved_down == pytest.approx(best_of(1.0, 0.45), rel=1e-9)
    (parameters,) = restored
    assert parameters.T.tolist() == [[pytest.approx(1.1), 0.5]]
