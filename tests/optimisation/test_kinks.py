"""Optima on a kink of objective or limits: proof, multipliers, prices and re-solving."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import actuator_opt as ao
from actuator_opt.optimisation import kinks, kkt
from actuator_opt.optimisation.actuator import build
from actuator_opt.optimisation.evaluator import Evaluator
from actuator_opt.optimisation.kkt import Curvature
from actuator_opt.optimisation.prices import prices
from actuator_opt.optimisation.problem import BoxProblem, ParametricProblem, PointValues
from actuator_opt.optimisation.resolve import ladder
from actuator_opt.optimisation.solution import Outcome
from actuator_opt.optimisation.solver import solve

DESIGNS = Path(__file__).parents[2] / "designs"


def box(evaluate, n, constraints=(), low=0.1, high=10.0):
    """Return a problem in n variables with the same bounds."""
    names = tuple(f"x{i + 1}" for i in range(n))
    return BoxProblem(names, np.full(n, low), np.full(n, high), evaluate, constraints)


def least(one, other):
    """The lesser of two values, with its derivative."""
    return np.where(one.real <= other.real, one, other)


def corner(x):
    """The lesser of 6 - x - 2 y and 6 - 2 x - y; both are 0 at x = y = 2."""
    return least(6 - x[0] - 2 * x[1], 6 - 2 * x[0] - x[1])


def near_three(n):
    """The problem of the point nearest to (3, 3, ...) in the corner."""
    return box(lambda x: PointValues(((x - 3) ** 2).sum(axis=0), corner(x)[None]), n, ("corner",))


def at(problem, x):
    """The evaluator of a problem, and its point at x."""
    evaluator = Evaluator(problem)
    return evaluator, evaluator.point(evaluator.space.to_z(np.array(x, dtype=float)))


def test_a_vertex_on_a_kink_is_an_optimum():
    """Most x + y at the corner (2, 2): multipliers 1/3 each, of one limit together 2/3."""
    problem = box(lambda x: PointValues(20 - x[0] - x[1], corner(x)[None]), 2, ("corner",))
    found = solve(problem)
    assert found.outcome is Outcome.OPTIMUM
    np.testing.assert_allclose(found.x, 2, rtol=1e-9)
    assert found.kkt.active == ("corner", "kink of corner")
    assert found.kkt.multipliers == pytest.approx([2 / 3])
    assert found.kkt.curvature is Curvature.VERTEX
    assert (found.kkt.count, found.kkt.rank) == (2, 2)
    evaluator, point = at(problem, found.x)
    assert kkt.check(evaluator, point).residual > 0.1


def test_one_side_of_a_kink_may_prove_an_optimum():
    """Where one value is a limit of its own, it and the other prove the optimum: 1/3 each."""

    def evaluate(x):
        one, other = 6 - x[0] - 2 * x[1], 6 - 2 * x[0] - x[1]
        return PointValues(20 - x[0] - x[1], np.stack([one, least(one, other)]))

    problem = box(evaluate, 2, ("one", "corner"))
    evaluator, point = at(problem, [2.0, 2.0])
    assert kkt.check(evaluator, point).residual > 0.1
    quality = kinks.check(evaluator, point)
    assert quality.residual < 1e-9
    assert quality.multipliers.sum() == pytest.approx(2 / 3)


@pytest.mark.parametrize("n", [2, 5])
def test_a_smooth_objective_on_a_kink(n):
    """The nearest point to (3, 3, ...) in the corner is (2, 2, 3, ...); multipliers 2/3 each."""
    found = solve(near_three(n))
    assert found.outcome is Outcome.OPTIMUM
    np.testing.assert_allclose(found.x, [2, 2, 3, 3, 3][:n], rtol=1e-8)
    assert found.kkt.multipliers == pytest.approx([4 / 3])
    assert found.kkt.curvature is (Curvature.VERTEX if n == 2 else Curvature.POSITIVE)
    assert found.evaluations < 1000


def test_an_objective_may_have_the_kink():
    """Least max(x, 1/x) y + 1/y^2 is at x = 1 and y^3 = 2."""

    def evaluate(x):
        return PointValues(np.where(x[0].real >= 1, x[0], 1 / x[0]) * x[1] + x[1] ** -2)

    found = solve(box(evaluate, 2))
    assert found.outcome is Outcome.OPTIMUM
    np.testing.assert_allclose(found.x, [1, 2 ** (1 / 3)], rtol=1e-9)
    assert found.kkt.active == ("kink of the objective",)


def test_two_kinks_at_one_point():
    """Nearest to (3, 3, 3, 3), with two variables in each of two corners: both kinks hold."""

    def evaluate(x):
        return PointValues(((x - 3) ** 2).sum(axis=0), np.stack([corner(x[:2]), corner(x[2:])]))

    found = solve(box(evaluate, 4, ("one", "two")))
    assert found.outcome is Outcome.OPTIMUM
    np.testing.assert_allclose(found.x, 2, rtol=1e-9)
    assert found.kkt.active == ("one", "two", "kink of one", "kink of two")
    assert found.kkt.multipliers == pytest.approx([4 / 3, 4 / 3])


def test_a_convex_kink_is_no_optimum():
    """Where the greater of two margins must be met, the corner is the worst point of the limit."""

    def evaluate(x):
        margin = -least(x[0] + 2 * x[1] - 6, 2 * x[0] + x[1] - 6)
        return PointValues(20 - x[0] - x[1], margin[None])

    evaluator, point = at(box(evaluate, 2, ("g",)), [2.0, 2.0])
    assert kinks.check(evaluator, point).residual > 0.1
    assert kinks.optimum_beside(evaluator, point) is None


@pytest.mark.parametrize("weight", [0.4, 2.5])
def test_a_point_on_a_kink_that_is_no_optimum(weight):
    """With slopes outside the cone between (1, 2) and (2, 1), one side leads away from the kink."""
    problem = box(lambda x: PointValues(50 - x[0] - weight * x[1], corner(x)[None]), 2, ("g",))
    evaluator, point = at(problem, [2.0, 2.0])
    assert kinks.check(evaluator, point).residual > 1e-3
    assert kinks.optimum_beside(evaluator, point) is None
    assert solve(problem).outcome is Outcome.OPTIMUM


def test_an_optimum_beside_a_kink_is_found():
    """From 4e-6 beside the kink, Newton steps on a piece lead to the optimum on it."""
    evaluator, point = at(near_three(3), [2.0 - 8e-6, 2.0, 2.9999])
    end = kinks.optimum_beside(evaluator, point)
    np.testing.assert_allclose(end.x, [2, 2, 3], rtol=1e-10)
    assert kinks.check(evaluator, end).residual < 1e-9


def test_a_smooth_optimum_needs_no_pieces(monkeypatch):
    """Without a kink, no further gradients are computed."""
    problem = box(lambda x: PointValues(((x - 3) ** 2).sum(axis=0) + 1), 3)
    monkeypatch.setattr(kinks, "_kinks_near", lambda *_: pytest.fail("a kink was sought"))
    assert solve(problem).outcome is Outcome.OPTIMUM


def moved_corner(x, p):
    """Distance to (3, 3, c) within the corner of p - x - q y and 6 - 2 x - y."""
    distance = (x[0] - 3) ** 2 + (x[1] - 3) ** 2 + (x[2] - p[2]) ** 2 + 1
    return distance, p[0] - x[0] - p[1] * x[1], 6 - 2 * x[0] - x[1]


@pytest.mark.parametrize("change", [1e-3, 1e-2])
def test_prices_at_a_kink_are_those_of_two_limits(change):
    """Price, movement, reach and re-solved objectives equal those of the limits on both sides."""
    values = np.array([6.0, 2.0, 1.5])

    def kinked(x, p):
        objective, one, other = moved_corner(x, p)
        return PointValues(objective, least(one, other)[None])

    def smooth(x, p):
        objective, one, other = moved_corner(x, p)
        return PointValues(objective, np.stack([one, other]))

    tables = []
    for evaluate, names in ((kinked, ("g",)), (smooth, ("one", "other"))):
        problem = box(lambda x, given=evaluate: given(x, values[:, None]), 3, names)
        parametric = ParametricProblem(problem, ("p", "q", "c"), values, evaluate)
        tables.append(prices(parametric, solve(problem), change=change))
    for row, reference in zip(*tables, strict=True):
        for name in ("price", "price_up", "price_down", "resolved_up", "resolved_down"):
            expected = pytest.approx(getattr(reference, name), rel=1e-7, abs=1e-9)
            assert getattr(row, name) == expected, name
        expected = reference.holds_until and pytest.approx(reference.holds_until, rel=1e-6)
        assert row.holds_until == expected
        np.testing.assert_allclose(row.movement, reference.movement, rtol=1e-6, atol=1e-9)
    assert tables[0][0].price == pytest.approx(-2 / 3)
    assert tables[0][0].change == "kink of g stops being active"


def test_prices_differ_at_a_degenerate_kink():
    """Most x + 1.3 y in the corner of p - x - 2 y and 6 - 2 x - y with x + y <= 4, at p = 6.

    At (2, 2) all three hold. The multiplier of p is 0.3 with the sum, 8/15 with the other side.
    """

    def evaluate(x, p):
        margins = [least(6 - 2 * x[0] - x[1], p[0] - x[0] - 2 * x[1]), 4 - x[0] - x[1]]
        return PointValues(20 - x[0] - 1.3 * x[1], np.stack(margins))

    problem = box(lambda x: evaluate(x, np.array([[6.0]])), 2, ("corner", "sum"))
    parametric = ParametricProblem(problem, ("p",), np.array([6.0]), evaluate)
    solution = solve(problem)
    assert solution.objective == pytest.approx(15.4)
    solution = replace(solution, x=np.array([2.0, 2.0]))  # exactly on the kink
    (row,) = prices(parametric, solution, change=1e-3, bounds=False)
    assert row.price_up == pytest.approx(-0.3)
    assert row.price_down == pytest.approx(-8 / 15)
    assert (row.resolved_up - 15.4) / 6e-3 == pytest.approx(row.price_up, abs=1e-6)
    assert (15.4 - row.resolved_down) / 6e-3 == pytest.approx(row.price_down, abs=1e-6)


def test_changed_problems_are_solved_along_the_kink(monkeypatch):
    """A price table at a kink takes no search for any of its ends."""
    monkeypatch.setattr(ladder, "search_near", lambda *_, **__: pytest.fail("a search was needed"))

    def evaluate(x, p):
        objective, one, other = moved_corner(x, p)
        return PointValues(objective, least(one, other)[None])

    values = np.array([6.0, 2.0, 1.5])
    problem = box(lambda x: evaluate(x, values[:, None]), 3, ("g",))
    parametric = ParametricProblem(problem, ("p", "q", "c"), values, evaluate)
    rows = prices(parametric, solve(problem), change=1e-3)
    assert all(row.resolved_up is not None and row.resolved_down is not None for row in rows)


def knee():
    """The walking knee without duty cycles at 220 N of friction: a thread changes its ring."""
    changes = {
        "duty": None,
        "requirements.duty_fatigue": None,
        "requirements.duty_supply_share": None,
        "requirements.friction_running.max": "220 N",
    }
    return build(ao.read(DESIGNS / "knee_walking.yaml", set=changes).subject())


def test_the_knee_on_a_kink_is_optimal():
    """The thread of the plug is the larger of what two rings need; both needs are equal."""
    solution = solve(knee().problem, starts=2, samples=1024)
    assert solution.outcome is Outcome.OPTIMUM
    assert solution.objective == pytest.approx(0.12972697, abs=1e-8)
    assert sum(label.startswith("kink of ") for label in solution.kkt.active) == 1
    assert solution.evaluations < 1000


@pytest.mark.long
@pytest.mark.parametrize("change", [1e-3, 1e-2])
def test_prices_of_the_knee_on_a_kink(change):
    """Re-solving with changes of 0.1 % and 1 % gives the slopes that the prices predict."""
    actuator = knee()
    solution = solve(actuator.problem)
    limits = ("friction_running", "seal_gap")
    paths = (*(f"requirements.{name}.max" for name in limits), "materials.al_7075_t6.density")
    rows = prices(actuator.parametric(paths), solution, change=change, bounds=False)
    assert len(rows) == 3
    for row in rows:
        step = change * row.value
        for slope in (
            (row.resolved_up - solution.objective) / step,
            (solution.objective - row.resolved_down) / step,
        ):
            assert slope == pytest.approx(row.price, rel=30 * change)


def test_a_piece_with_a_further_kink_proves_nothing():
    """The objective falls in a narrow cone between the axes, and rises along them."""

    def objective(x):
        size = np.where(x[0].real > 0, x[0], -x[0]) + np.where(x[1].real > 0, x[1], -x[1])
        cone = least(x[1] - 1.7 * x[0], 5.7 * x[0] - x[1])
        return PointValues(
            1 + size - 3 * np.where(cone.real > 0, cone, 0), np.empty((0, x.shape[1]))
        )

    problem = box(objective, 2, low=-1.0, high=1.0)
    assert objective(np.array([[0.03], [0.1]])).objective < 1
    assert kinks.check(*at(problem, [0.0, 0.0])).residual > 0.1
