"""Prices: exact derivatives, re-solved ends, validity ranges, movement, degenerate vertices."""

import numpy as np
import problems
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays

from actuator_opt.evaluation.limits import margin
from actuator_opt.optimisation import prices as price_table
from actuator_opt.optimisation.prices import prices
from actuator_opt.optimisation.problem import BoxProblem, ParametricProblem, PointValues
from actuator_opt.optimisation.resolve.steps import Descent
from actuator_opt.optimisation.solver import solve


def priced(parametric, **options):
    """Prices by name at the optimum."""
    found = solve(parametric.problem)
    return found, {row.parameter: row for row in prices(parametric, found, **options)}


def parametric(evaluate, values, constraints, *, n=2, low=0.1, high=10.0):
    """Return a parametric problem in n variables with parameters p0, p1, ..."""
    values = np.asarray(values, dtype=float)
    problem = BoxProblem(
        tuple("abcdefgh"[:n]),
        np.full(n, low),
        np.full(n, high),
        lambda x: evaluate(x, values[:, None]),
        constraints,
    )
    return ParametricProblem(problem, tuple(f"p{i}" for i in range(len(values))), values, evaluate)


def test_cantilever_sensitivity_is_minus_one_third():
    """The optimum scales with limit^(-1/3) and density^1: price, ends and movement exactly so."""
    found, rows = priced(problems.stepped_cantilever())
    row = rows["limit"]
    assert row.percent_per_percent == pytest.approx(-1 / 3, rel=1e-12)
    assert row.price == pytest.approx(-found.objective / 3, rel=1e-12)
    assert row.price_up == row.price_down == pytest.approx(row.price)
    assert row.predicted_up == pytest.approx(found.objective * (1 - 0.1 / 3), rel=1e-12)
    assert row.resolved_up == pytest.approx(found.objective * 1.1 ** (-1 / 3), rel=1e-9)
    assert row.resolved_down == pytest.approx(found.objective * 0.9 ** (-1 / 3), rel=1e-9)
    np.testing.assert_allclose(row.movement, -found.x / 3, rtol=1e-6)
    assert row.holds_until is None
    assert rows["density"].percent_per_percent == pytest.approx(1.0, rel=1e-12)
    np.testing.assert_allclose(rows["density"].movement, 0, atol=1e-6)


def test_vessel_prices_match_resolving():
    """Prices of the vessel agree with central differences of re-solved optima, bounds included."""
    _, rows = priced(problems.pressure_vessel())
    _, close = priced(problems.pressure_vessel(), change=1e-4)
    assert set(rows) == {"shell ratio", "head ratio", "volume", "length upper"}
    for name, row in close.items():
        slope = (row.resolved_up - row.resolved_down) / (2e-4 * row.value)
        assert slope == pytest.approx(row.price, rel=1e-5), name
    row = rows["length upper"]
    assert row.price < 0
    assert row.holds_until == pytest.approx(240.0)  # the written length limit, L <= 240
    assert row.change == "length limit becomes active"
    assert row.movement[3] == pytest.approx(1.0)


def test_movement_matches_resolving():
    """The derivative of the optimum agrees with re-solved optima at +-0.1 %."""
    parametric_problem = problems.geometric_programme(2)
    found, rows = priced(parametric_problem, resolve=False)
    for k, name in list(enumerate(parametric_problem.parameter_names))[:6]:
        ends = []
        for sign in (1, -1):
            limits = parametric_problem.parameters.copy()
            limits[k] *= 1 + 1e-3 * sign
            problem = parametric_problem.at(limits)
            ends.append(solve(problem, samples=0, more_starts=[found.x]).x)
        np.testing.assert_allclose(
            (ends[0] - ends[1]) / 2e-3, rows[name].movement, rtol=2e-3, atol=2e-4
        )


def test_convex_value_function_lies_above_its_tangent():
    """In a geometric programme the re-solved objective is never below the log-log tangent.

    The optimal value of a geometric programme is log-convex in the logarithms of its limits.
    """
    found, rows = priced(problems.geometric_programme(1))
    assert len(rows) == 15
    for row in rows.values():
        for factor, end in ((1.1, row.resolved_up), (0.9, row.resolved_down)):
            tangent = found.objective * factor**row.percent_per_percent
            assert end is None or end >= tangent * (1 - 1e-9)


def test_holds_until_where_another_constraint_takes_over():
    """With min a + b, a b >= p, a <= 2: a = b = sqrt(p) until p = 4, where a <= 2 becomes active.

    At p = 3, sqrt(p) = 1.732; the straight line a(p) in the logarithm, log a = log(sqrt 3) +
    dp/(2 * 3), cannot be exact; da/dp = a/(2 p), so the margin 1 - a/2 with slope -a/(4 p)
    vanishes at p + (1 - a/2) 4 p/a = 3.928.
    """

    def evaluate(x, p):
        return PointValues(x[0] + x[1], np.stack([x[0] * x[1] / p[0] - 1, 1 - x[0] / 2 + 0 * p[0]]))

    _, rows = priced(parametric(evaluate, [3.0], ("product", "a max")))
    a = np.sqrt(3)
    assert rows["p0"].holds_until == pytest.approx(3 + (1 - a / 2) * 12 / a, rel=1e-6)
    assert rows["p0"].change == "a max becomes active"


def test_slack_requirement_is_free_until_it_binds():
    """A requirement with slack costs nothing until its limit reaches the value."""

    def evaluate(x, p):
        return PointValues(x[0] + x[1], np.stack([x[0] * x[1] - 1 + 0 * p[0], x[0] / p[0] - 1]))

    _, rows = priced(parametric(evaluate, [0.9], ("product", "a min")))
    row = rows["p0"]
    assert row.price == pytest.approx(0, abs=1e-9)
    # margin a/p - 1 with slope -a/p^2 vanishes at p + (1/p - 1) p^2 = p + p - p^2 = 0.99
    assert row.holds_until == pytest.approx(0.99, rel=1e-6)
    assert row.change == "a min becomes active"
    assert row.resolved_down == pytest.approx(2, rel=1e-9)
    assert row.resolved_up == pytest.approx(2, rel=1e-9)  # a = 0.99 is still below 1


def test_active_requirement_that_stops_binding():
    """Relaxing a requirement pays only until another rules: the re-solved end shows it.

    min a with a >= p and a >= 1.9 (p = 2): down 10 % predicts 1.8 but reaches 1.9.
    """

    def evaluate(x, p):
        return PointValues(x[0] + 0 * p[0], np.stack([x[0] / p[0] - 1, x[0] / 1.9 - 1 + 0 * p[0]]))

    _, rows = priced(parametric(evaluate, [2.0], ("first", "second"), n=1))
    row = rows["p0"]
    assert row.predicted_down == pytest.approx(1.8)
    assert row.resolved_down == pytest.approx(1.9)
    assert row.holds_until == pytest.approx(1.9)
    assert row.change == "second becomes active"


def test_infeasible_end_is_none():
    """Where +10 % leaves no feasible point, the re-solved value is None, not a number."""

    def evaluate(x, p):
        return PointValues(x[0] + 0 * p[0], np.stack([x[0] / p[0] - 1, 1 - x[0] / 2.1 + 0 * p[0]]))

    _, rows = priced(parametric(evaluate, [2.0], ("min", "max"), n=1))
    assert rows["p0"].resolved_up is None
    assert rows["p0"].resolved_down == pytest.approx(1.8)


def test_degenerate_vertex_has_one_sided_prices():
    """With a >= p0 and a >= p1 at p0 = p1 = 2: raising either costs 1, lowering either saves 0."""

    def evaluate(x, p):
        return PointValues(x[0] + x[1], np.stack([x[0] / p[0] - 1, x[0] / p[1] - 1]))

    _, rows = priced(parametric(evaluate, [2.0, 2.0], ("one", "two")))
    for name in ("p0", "p1"):
        row = rows[name]
        assert row.price_up == pytest.approx(1)
        assert row.price_down == pytest.approx(0, abs=1e-9)
        assert row.predicted_up == pytest.approx(2.1 + 0.2)
        assert row.predicted_down == pytest.approx(2.1)
        assert row.resolved_up == pytest.approx(2.3)
        assert row.resolved_down == pytest.approx(2.1)
        assert row.holds_until == pytest.approx(2.0)


def test_linear_programming_agrees_with_enumeration(monkeypatch):
    """The two ways to one-sided prices give the same, at a vertex of five rows in the plane."""

    def evaluate(x, p):
        a, b = x
        rows = [a - p[0], b - p[1], a * b - p[2], (a + b) / 2 - p[3], a**2 * b - p[4]]
        return PointValues(a + b, np.stack(np.broadcast_arrays(*rows)))

    problem = parametric(evaluate, np.ones(5), tuple("vwxyz"))
    _, first = priced(problem, resolve=False)
    monkeypatch.setattr(price_table, "BASES", 0)
    _, second = priced(problem, resolve=False)
    for name, row in first.items():
        assert row.price_up == pytest.approx(second[name].price_up, abs=1e-8)
        assert row.price_down == pytest.approx(second[name].price_down, abs=1e-8)
        assert row.price_down <= row.price_up
    # with only "a" and "b" multiplied: both 1; y alone can carry 2: upward price of p3 is 2
    assert first["p3"].price_up == pytest.approx(2)
    assert first["p3"].price_down == pytest.approx(0, abs=1e-9)


def test_copies_of_a_requirement_share_one_price():
    """The same limit checked in three load cases has one price, not three or none."""

    def evaluate(x, p):
        margin = x[0] * x[1] / p[0] - 1
        return PointValues(x[0] + x[1], np.stack([margin] * 3))

    _, rows = priced(parametric(evaluate, [4.0], ("case 1", "case 2", "case 3")))
    row = rows["p0"]
    assert row.percent_per_percent == pytest.approx(0.5, rel=1e-9)
    assert row.price_up == pytest.approx(row.price_down)
    assert row.resolved_up == pytest.approx(4 * np.sqrt(1.1), rel=1e-9)
    assert row.holds_until is None


def test_parameter_without_complex_step():
    """A parameter read through a table (no complex step) is priced by differences."""
    table = np.array([1.0, 2.0, 3.0, 4.0, 5.0])

    def evaluate(x, p):
        looked_up = np.interp(p[0].real, table, table**2)  # piecewise linear, no derivative
        return PointValues(x[0] + x[1], (x[0] * x[1] / looked_up - 1)[None])

    _, rows = priced(parametric(evaluate, [2.5], ("product",)))
    # limit L(p) = 4 + 5 (p - 2) = 6.5, f = 2 sqrt(L), df/dp = 5/sqrt(L)
    assert rows["p0"].price == pytest.approx(5 / np.sqrt(6.5), rel=1e-6)
    assert rows["p0"].resolved_up == pytest.approx(2 * np.sqrt(7.75), rel=1e-9)


def test_price_of_a_limit_of_zero():
    """A margin is relative, but absolute for a limit of 0; its price is no difference of both."""

    def evaluate(x, p):
        return PointValues(x[0], margin(x[0] - 2 * x[1], p[0], "min")[None])

    _, rows = priced(parametric(evaluate, [0.0], ("difference",)))
    assert rows["p0"].price == pytest.approx(1.0, rel=1e-9)  # x0 = 2 x1 + p, x1 at its bound


def test_idle_parameter_costs_nothing():
    """A parameter that nothing depends on has price 0 and unchanged ends."""

    def evaluate(x, p):
        return PointValues(x[0] + x[1] + 0 * p[0], (x[0] * x[1] - 1)[None])

    found, rows = priced(parametric(evaluate, [0.0], ("product",)))
    row = rows["p0"]
    assert row.price == 0
    assert row.percent_per_percent is None
    assert row.resolved_up == row.resolved_down == row.predicted_up == found.objective


def test_infeasible_problem_has_no_prices():
    """Without a feasible point there is nothing to price."""

    def evaluate(x, p):
        return PointValues(x[0], np.stack([x[0] / p[0] - 1, 1 - x[0]]))

    _, rows = priced(parametric(evaluate, [2.0], ("min", "max"), n=1))
    assert rows == {}


def test_equality_prices():
    """Prices hold with an equality: HS71 with the sphere's 40 as parameter has price -(-0.1615).

    The published multiplier of the equality, 0.161469 in size, is df*/d(40) with its sign: a
    larger sphere lowers the objective.
    """
    base = problems.hs71()

    def evaluate(x, p):
        values = base.evaluate(x)
        return PointValues(values.objective, values.constraints, values.equalities + 40 - p[0])

    full = ParametricProblem(base, ("sphere",), np.array([40.0]), evaluate)
    _, rows = priced(full, change=1e-4)
    row = rows["sphere"]
    slope = (row.resolved_up - row.resolved_down) / (2e-4 * 40)
    assert slope == pytest.approx(row.price, rel=1e-6)
    assert abs(row.price) == pytest.approx(0.161469, abs=1e-6)
    assert "x1 lower" in rows


@given(
    steps=arrays(float, (30, 4), elements=st.floats(-1, 1)),
    changes=arrays(float, (30, 4), elements=st.floats(-1e8, 1e8)),
)
def test_a_learnt_curvature_stays_positive(steps, changes):
    """Whatever slopes are learnt, steep, flat or bent down, the next step has a unique answer."""
    descent = Descent(np.eye(4), 1.0, 0, 0.0)
    for step, change in zip(steps, changes, strict=True):
        descent._learn(step, change)
        np.linalg.cholesky(descent.hessian)
