"""Multipliers, quadratic programmes and the exact finish, each against independent results."""

import numpy as np
import problems
import pytest
from hypothesis import given, strategies as st
from scipy.optimize import nnls as reference_nnls

from actuator_opt.optimisation import kkt
from actuator_opt.optimisation.evaluator import Evaluator
from actuator_opt.optimisation.problem import BoxProblem, PointValues


def test_gradients_at_a_kink_are_exact():
    """Where max(a, 2 b) has its kink, either gradient is exact; one that lacks a term is not."""

    def evaluate(x):
        larger = np.where(x[0].real >= 2 * x[1].real, x[0], 2 * x[1])
        lacking = np.where(x[0].real >= 2 * x[1].real, x[0], 2 * x[1].real) + x[1] ** 2
        return PointValues(x[0] + x[1], np.stack([larger, lacking]))

    problem = BoxProblem(("a", "b"), np.ones(2), np.full(2, 9.0), evaluate, ("larger", "lacking"))
    evaluator = Evaluator(problem)
    assert (
        evaluator.check_gradients(evaluator.point(evaluator.space.to_z(np.array([4.0, 2.0])))) == ()
    )
    (warning,) = evaluator.check_gradients(
        evaluator.point(evaluator.space.to_z(np.array([3.0, 2.0])))
    )
    assert "lacking" in warning


@given(st.integers(0, 10**6), st.integers(1, 8), st.integers(1, 14), st.booleans())
def test_nnls_matches_scipy(seed, height, width, dependent):
    """Our non-negative least squares reaches SciPy's residual, copies of columns included."""
    generator = np.random.default_rng(seed)
    matrix = generator.normal(size=(height, width))
    if dependent and width > 1:
        matrix[:, -1] = 2 * matrix[:, 0]
    vector = generator.normal(size=height)
    ours = kkt.nnls(matrix, vector)
    _, residual = reference_nnls(matrix, vector)
    assert (ours >= 0).all()
    assert np.linalg.norm(matrix @ ours - vector) == pytest.approx(residual, abs=1e-9)


def test_nnls_ignores_zero_columns():
    """A column of zeros takes no multiplier."""
    matrix = np.array([[1.0, 0.0], [0.0, 0.0]])
    np.testing.assert_array_equal(kkt.nnls(matrix, np.array([2.0, 0.0])), [2, 0])
    np.testing.assert_array_equal(kkt.nnls(np.zeros((2, 2)), np.ones(2)), [0, 0])


@given(st.integers(0, 10**6), st.integers(1, 6), st.integers(0, 12))
def test_quadratic_programme_is_optimal(seed, n, rows):
    """Solutions of feasible quadratic programmes meet their optimality conditions."""
    generator = np.random.default_rng(seed)
    root = generator.normal(size=(n, n))
    hessian = root @ root.T + 0.1 * np.eye(n)
    slope, matrix = generator.normal(size=n), generator.normal(size=(rows, n))
    margins = generator.uniform(0, 1, rows)  # no step at all is feasible
    step, prices = kkt.quadratic_programme(hessian, slope, matrix, margins)
    left = margins + matrix @ step
    assert (left >= -1e-8).all()
    assert (prices >= 0).all()
    np.testing.assert_allclose(hessian @ step + slope, matrix.T @ prices, atol=1e-7)
    np.testing.assert_allclose(prices * left, 0, atol=1e-7)


def test_a_vertex_is_exact_whatever_the_curvature():
    """Two rows hold both variables: the step follows from them, though one curvature is tiny."""
    hessian = np.array([[1e-3, 1.2e-5], [1.2e-5, 6e-6]])
    rows, margins = np.array([[2.0, 1.0], [-1.0, 0.0]]), np.array([-2e-3, 1e-3])
    step, prices = kkt.quadratic_programme(hessian, np.ones(2), rows, margins)
    assert step == pytest.approx([1e-3, 0.0], abs=1e-9)
    assert prices == pytest.approx([1 + 1.2e-8, 1 - 1e-6 + 2.4e-8], abs=1e-9)


def test_contradicting_rows_give_the_least_violation():
    """Where linearised rows exclude each other, the step halves the contradiction."""
    step, _ = kkt.quadratic_programme(
        np.eye(1), np.zeros(1), np.array([[1.0], [-1.0]]), np.array([-1.0, -3.0])
    )
    assert step[0] == pytest.approx(-1.0)  # least squares of d = 1 and d = -3


@pytest.mark.parametrize("offset", [1e-2, 1e-4, 1e-6])
def test_polish_converges_from_nearby(offset):
    """From points off by 1e-2 to 1e-6 the finish reaches a residual of 1e-12."""
    evaluator = Evaluator(problems.thrust_bearing())
    x = np.array([5.95578050, 5.38901305, 5.35869727e-6, 2.26965596])
    z = evaluator.space.to_z(x) + offset * np.array([1, -1, 1, 1])
    found = kkt.polish(evaluator, evaluator.point(z))
    assert kkt.check(evaluator, found).residual <= 1e-12
    assert found.objective == pytest.approx(1625.442759, abs=5e-6)


def test_polish_adds_and_drops_active_rows():
    """The finish changes the active set where the start suggests a wrong one."""
    evaluator = Evaluator(problems.rosen_suzuki())
    near = evaluator.space.to_z(np.array([0.02, 1.0, 1.97, -1.02]))
    found = kkt.polish(evaluator, evaluator.point(near))
    assert kkt.check(evaluator, found).active == ("g1", "g3")
    np.testing.assert_allclose(found.x, [0, 1, 2, -1], atol=1e-7)


def test_polish_never_worsens():
    """From anywhere in the box the finish is never less feasible, nor costlier if feasible."""
    for problem in (problems.pressure_vessel().problem, problems.piston_lever()):
        evaluator = Evaluator(problem)
        generator = np.random.default_rng(1)
        for _ in range(10):
            share = generator.random(4)
            z = evaluator.space.lower + share * (evaluator.space.upper - evaluator.space.lower)
            start = evaluator.point(z)
            found = kkt.polish(evaluator, start)
            assert found.violation <= max(start.violation, 1e-9)
            if start.violation == 0:
                assert found.objective <= start.objective * (1 + 1e-8)


def test_polish_does_not_settle_on_a_maximum():
    """Near a constrained maximum of the objective the finish moves away instead of onto it."""

    def evaluate(x):
        logs = np.log(x)
        return PointValues(3 - logs[0] ** 2 + 0.1 * logs[1] ** 2)

    evaluator = Evaluator(BoxProblem(("a", "b"), [0.1, 0.1], [10, 10], evaluate))
    start = evaluator.point(np.array([0.01, 0.3]))
    found = kkt.polish(evaluator, start, iterations=40)
    assert found.objective < start.objective
    assert abs(found.z[0]) > 1.0


def test_curvature_names_the_second_order_condition():
    """Vertex, strict minimum, flat direction and saddle are told apart."""

    def evaluate(x):
        a, b = np.log(x)
        return PointValues(10 + a**2 - b**2 + 0 * a, None)

    saddle = Evaluator(BoxProblem(("a", "b"), [0.1, 0.1], [10, 10], evaluate))
    quality = kkt.check(saddle, saddle.point(np.zeros(2)), curvature=True)
    assert quality.residual <= 1e-12
    assert quality.curvature is kkt.Curvature.NEGATIVE


def test_residual_definition():
    """The residual is |grad f - sum(multiplier grad g)| / |grad f| in logarithmic variables.

    By hand, f = x + 2 y at (1, 1): grad = (1, 2). One active row x y >= 1 with gradient (1, 1):
    least squares 1.5, remainder (-0.5, 0.5), so the residual is sqrt(0.5/5).
    """

    def evaluate(x):
        return PointValues(x[0] + 2 * x[1], (x[0] * x[1] - 1)[None])

    evaluator = Evaluator(BoxProblem(("a", "b"), [0.1, 0.1], [10, 10], evaluate, ("product",)))
    quality = kkt.check(evaluator, evaluator.point(np.zeros(2)))
    assert quality.residual == pytest.approx(np.sqrt(0.1))
    assert quality.multipliers[0] == pytest.approx(1.5)


def test_rows_beyond_tolerance_are_not_active():
    """A margin of 2e-6 is not active, one of 5e-7 is (contract: within 1e-6)."""

    def evaluate(x):
        one = np.ones_like(x[0])
        return PointValues(x[0], np.stack([5e-7 * one, 2e-6 * one]))

    evaluator = Evaluator(BoxProblem(("a",), [0.1], [10], evaluate, ("near", "far")))
    assert kkt.check(evaluator, evaluator.point(np.zeros(1))).active == ("near",)


@pytest.mark.parametrize("seed", range(20))
def test_what_is_known_of_a_result_does_not_change_it(seed):
    """Least squares of a random matrix, from nothing, from the result and from columns at random.

    With fewer columns than rows too, where a first try is made without bounds.
    """
    rng = np.random.default_rng(seed)
    rows, columns = (8, 40) if seed % 2 else (12, 9)
    matrix, vector = rng.standard_normal((rows, columns)), rng.standard_normal(rows)
    alone = kkt.nnls(matrix, vector)
    for known in (alone, rng.standard_normal(columns), np.ones(columns)):
        np.testing.assert_allclose(kkt.nnls(matrix, vector, known), alone, rtol=1e-9, atol=1e-12)
    pull = matrix.T @ (vector - matrix @ alone)
    assert (alone >= 0).all()
    assert pull.max() <= 1e-9
    assert abs(pull[alone > 0]).max(initial=0.0) <= 1e-9
