"""The optimiser on awkward problems: limits, NaN, faults, flat objectives, kinks, degeneracy."""

import sys
from dataclasses import replace

import numpy as np
import problems
import pytest

from actuator_opt.base.errors import InputError
from actuator_opt.optimisation import kinks, nlopt_wrapper, solver
from actuator_opt.optimisation.evaluator import Evaluator
from actuator_opt.optimisation.kkt import Curvature
from actuator_opt.optimisation.problem import BoxProblem, PointValues, Space
from actuator_opt.optimisation.resolve import ladder, parallel_descents
from actuator_opt.optimisation.resolve.parallel_descents import Descents, SearchResult
from actuator_opt.optimisation.solution import Outcome, StartRecord, reached_again
from actuator_opt.optimisation.solver import Halton, solve


def box(evaluate, n=2, constraints=(), low=0.1, high=10.0, **others):
    """Return a problem in n variables with the same bounds."""
    names = tuple(f"x{i + 1}" for i in range(n))
    return BoxProblem(names, np.full(n, low), np.full(n, high), evaluate, constraints, **others)


def test_every_outcome_is_a_sentence():
    """Every outcome has a one-word status and a sentence; all but the good one have a remedy."""
    for outcome in Outcome:
        assert " " not in outcome.status
        assert len(outcome.sentence.split()) > 4
        assert bool(outcome.remedy) == (outcome is not Outcome.OPTIMUM)


def test_unconstrained_interior_optimum():
    """At a stationary objective the residual is small although grad f itself vanishes."""

    def evaluate(x):
        logs = np.log(x)
        return PointValues(
            1 + (logs[0] - 0.5) ** 2 + (logs[1] + 0.5) ** 2 + 0.3 * logs[0] * logs[1]
        )

    found = solve(box(evaluate))
    # 2(u - .5) + .3 v = 0, 2(v + .5) + .3 u = 0  ->  u = -v = 1/1.7
    np.testing.assert_allclose(np.log(found.x), [1 / 1.7, -1 / 1.7], rtol=1e-7)
    assert found.outcome is Outcome.OPTIMUM
    assert found.kkt.active == ()
    assert found.kkt.curvature is Curvature.POSITIVE


def test_an_optimum_at_a_bound_of_zero_is_zero():
    """A dimension that the optimum does without reads 0, not the 1e-20 of a step's rounding."""

    def evaluate(x):
        return PointValues((x[0] + 0.3) ** 2 + (x[1] - 0.0123) ** 2)

    found = solve(box(evaluate, low=0.0, high=0.025))
    assert found.x[0] == 0.0
    assert found.at_bound(0) == "lower"
    np.testing.assert_allclose(found.x[1], 0.0123, rtol=1e-6)
    space = Space(found.problem)
    beside = np.array([1e-15, space.upper[1] - 1e-15])
    assert list(space.to_x(beside[:, None])[:, 0]) == [0.0, 0.025]
    inner = np.array([1e-9, space.upper[1] - 1e-9])  # still its own value
    assert 0 < space.to_x(inner[:, None])[0, 0] < space.to_x(inner[:, None])[1, 0] < 0.025


@pytest.mark.parametrize("name", ["rosen_suzuki", "hs71", "piston_lever", "thrust_bearing"])
def test_runs_side_by_side_are_the_runs_alone(name, monkeypatch):
    """Points looked at in advance change nothing that is found, but the model is called less."""
    found, calls = {}, {"together": 0, "alone": 0}
    for way in calls:
        if way == "alone":
            monkeypatch.setattr(solver, "precompute", lambda *_, **__: None)
        problem = getattr(problems, name)()

        def counted(x, way=way, evaluate=problem.evaluate):
            calls[way] += 1
            return evaluate(x)

        found[way] = solve(replace(problem, evaluate=counted))
    one, other = found["together"], found["alone"]
    np.testing.assert_array_equal(one.x, other.x)
    assert one.trace == other.trace
    assert [r.objective for r in one.starts] == [r.objective for r in other.starts]
    assert [r.evaluations for r in one.starts] == [r.evaluations for r in other.starts]
    assert calls["together"] < calls["alone"]


def test_objective_zero_at_optimum():
    """An objective that vanishes at its optimum is judged against its size elsewhere."""
    found = solve(box(lambda x: PointValues((x[0] - 1) ** 2 + (x[1] - 2) ** 2), low=-5.0))
    assert found.outcome is Outcome.OPTIMUM
    np.testing.assert_allclose(found.x, [1, 2], atol=1e-6)


def test_degenerate_vertex():
    """Three constraints through one vertex of two variables: optimum found, rank 2 of 3.

    Minimise x + y with x >= 1, y >= 1, x y >= 1, x + y >= 2, all active at (1, 1).
    """

    def evaluate(x):
        a, b = x
        return PointValues(a + b, np.stack([a - 1, b - 1, a * b - 1, (a + b) / 2 - 1]))

    found = solve(box(evaluate, constraints=("a", "b", "product", "sum")))
    assert found.outcome is Outcome.OPTIMUM
    np.testing.assert_allclose(found.x, [1, 1], rtol=1e-9)
    assert (found.kkt.count, found.kkt.rank) == (4, 2)
    assert not found.kkt.unique
    assert (found.kkt.multipliers >= 0).all()


def test_redundant_copies():
    """The same constraint three times changes nothing; the multipliers of the copies add up."""

    def evaluate(x):
        margin = x[0] * x[1] ** 2 - 1
        return PointValues(x[0] + x[1], np.stack([margin] * 3))

    found = solve(box(evaluate, constraints=("one", "two", "three")))
    assert found.outcome is Outcome.OPTIMUM
    # x y^2 = 1, x + y least: y = 2x, x = 4^(-1/3); multiplier (per margin) = f/3
    np.testing.assert_allclose(found.x, [4 ** (-1 / 3), 2 * 4 ** (-1 / 3)], rtol=1e-8)
    assert found.kkt.multipliers.sum() == pytest.approx(found.objective / 3, rel=1e-8)


def test_variable_without_effect():
    """A variable that no value depends on is named and keeps its start."""

    def evaluate(x):
        return PointValues(x[0] + x[1], (x[0] * x[1] - 1)[None])

    start = np.array([3.0, 3.0, 7.0])
    found = solve(box(evaluate, 3, constraints=("product",), start=start))
    assert found.outcome is Outcome.OPTIMUM
    assert found.without_effect == ("x3",)
    assert found.x[2] == pytest.approx(7.0, rel=1e-12)
    assert found.kkt.curvature is Curvature.FLAT


def test_flat_objective():
    """An objective that nothing affects is said to be flat; a feasible point is returned."""

    def evaluate(x):
        return PointValues(0 * x[0] + 5.0, (x[0] * x[1] - 50)[None])

    found = solve(box(evaluate, constraints=("product",)))
    assert found.outcome is Outcome.FLAT
    assert found.feasible


def folded(x):
    """max(x, 1/x), with a kink at 1."""
    return np.where(x.real >= 1, x, 1 / x)


def test_a_point_on_many_kinks_is_not_called_an_optimum():
    """Where five kinks meet, the slopes do not balance, and no proof is tried: a remedy."""
    found = solve(box(lambda x: PointValues(folded(x).sum(axis=0)), 5))
    assert found.outcome is Outcome.NOT_STATIONARY
    assert "kink" in found.outcome.remedy
    assert found.objective == pytest.approx(5.0, abs=1e-6)


def test_a_search_that_reaches_a_kink_again_ends(monkeypatch):
    """Where no proof is tried, runs that reach the same kink are not repeated."""
    monkeypatch.setattr(kinks, "MOST", 0)
    found = solve(box(lambda x: PointValues(folded(x[0]) * x[1] + x[1] ** -2)))
    assert found.outcome is Outcome.NOT_STATIONARY
    assert {start.algorithm for start in found.starts} == {"LD_SLSQP"}


def test_one_run_from_two_equal_starts_is_no_repetition():
    """The same run from the same start says nothing about a kink; another algorithm does."""
    record = StartRecord(np.ones(2), 3.0, 0.0, "LD_SLSQP", 10)
    assert not reached_again([record, record], 3.0)
    assert reached_again([record, replace(record, algorithm="LD_SLSQP (linear variables)")], 3.0)
    assert not reached_again([record, replace(record, x=np.zeros(2), objective=3.1)], 3.0)
    assert not reached_again([record, replace(record, x=np.zeros(2), violation=1.0)], 3.0)


def test_a_kink_that_several_starts_reach_is_searched_once(monkeypatch):
    """Re-solving ends at the kink of max(x, 1/x) y + 1/y^2; a sweep would only repeat it."""
    sweeps = []
    monkeypatch.setattr(kinks, "MOST", 0)
    monkeypatch.setattr(
        ladder, "solve", lambda *a, **k: (sweeps.append(k["samples"]), solve(*a, **k))[1]
    )
    problem = box(lambda x: PointValues(folded(x[0]) * x[1] + x[1] ** -2))
    evaluator = Evaluator(problem)
    point = evaluator.point(evaluator.space.to_z(np.array([1.4, 1.1])))
    end = ladder.search_near(problem, evaluator, point.z, point, feasible_z=point.z)
    assert end.x == pytest.approx([1.0, 2 ** (1 / 3)], rel=1e-5)
    assert sweeps == [0]


def test_nan_in_part_of_the_box():
    """Points where a root is undefined count as infeasible; the optimum beside them is found.

    Minimise x + y with sqrt(x - y) >= 1: real only for x > y. Best: y at its bound, x = y + 1.
    """

    def evaluate(x):
        return PointValues(x[0] + x[1], (np.sqrt(x[0] - x[1]) - 1)[None])

    found = solve(box(evaluate, constraints=("root",)))
    assert found.outcome is Outcome.OPTIMUM
    np.testing.assert_allclose(found.x, [1.1, 0.1], rtol=1e-9)
    assert found.undefined == pytest.approx(0.5, abs=0.01)  # x < y in half of a square box


def test_nan_everywhere():
    """A model without any finite value is called undefined."""
    found = solve(box(lambda x: PointValues(x[0] * np.nan)))
    assert found.outcome is Outcome.UNDEFINED
    assert found.kkt is None


def test_infinite_margin_is_met():
    """A margin of plus infinity (nothing loads the part) is met and does not spoil gradients."""

    def evaluate(x):
        return PointValues(x[0] + x[1], np.stack([x[0] * x[1] - 1, np.inf + 0 * x[0].real]))

    found = solve(box(evaluate, constraints=("product", "unloaded")))
    assert found.outcome is Outcome.OPTIMUM
    np.testing.assert_allclose(found.x, [1, 1], rtol=1e-8)


class _OwnFaultError(Exception):
    pass


@pytest.mark.parametrize("algorithm", ["auto", "LD_MMA", "LN_COBYLA", "AUGLAG", "GN_ISRES"])
@pytest.mark.parametrize("fault", [_OwnFaultError, KeyboardInterrupt])
def test_exception_of_the_model_surfaces(algorithm, fault):
    """An exception in the model, an interrupt included, leaves the solver as it was raised."""
    calls = []

    def evaluate(x):
        calls.append(1)
        if len(calls) > 10:
            raise fault("boom")
        return PointValues(x[0] + x[1], (x[0] * x[1] - 1)[None])

    with pytest.raises(fault, match="boom"):
        solve(box(evaluate, constraints=("product",)), algorithm=algorithm, samples=64)


def test_evaluation_limit_keeps_best_feasible():
    """A used-up evaluation limit keeps the best feasible point and says so."""
    found = solve(problems.thrust_bearing(), max_evaluations=40)
    assert found.outcome in (Outcome.LIMIT, Outcome.LIMIT_INFEASIBLE)
    assert found.evaluations <= 45
    easy = solve(problems.pressure_vessel().problem, max_evaluations=8)
    assert easy.outcome is Outcome.LIMIT
    assert easy.feasible
    assert easy.outcome.feasible


def test_time_limit():
    """A time limit of zero still returns an evaluated point and the outcome that says so."""
    found = solve(problems.pressure_vessel().problem, max_seconds=0.0)
    assert found.outcome in (Outcome.LIMIT, Outcome.LIMIT_INFEASIBLE)
    assert np.isfinite(found.objective)


def test_fixed_variables():
    """Equal bounds fix a variable; with all fixed the point is only evaluated."""
    problem = problems.stepped_cantilever().problem
    held = problem.lower.copy()
    held[0] = 7.0
    upper = problem.upper.copy()
    upper[0] = 7.0
    found = solve(replace(problem, lower=held, upper=upper))
    assert found.outcome is Outcome.OPTIMUM
    assert found.x[0] == 7.0
    root = problems.CANTILEVER_COEFFICIENTS[1:] ** 0.25
    left = 1 - 61 / 7.0**3
    np.testing.assert_allclose(found.x[1:], root * (root.sum() / left) ** (1 / 3), rtol=1e-8)
    fixed = solve(replace(problem, lower=np.full(5, 8.0), upper=np.full(5, 8.0)))
    assert fixed.outcome is Outcome.NOTHING_FREE
    assert fixed.objective == pytest.approx(0.0624 * 40)


def test_user_start_is_tried():
    """With no sweep, the run starts from the user's own point."""
    start = np.array([1.0, 0.5, 50.0, 100.0])
    problem = replace(problems.pressure_vessel().problem, start=start)
    found = solve(problem, samples=0)
    assert found.samples == 0
    np.testing.assert_allclose(found.starts[0].x, start, rtol=1e-14)
    assert found.objective == pytest.approx(5885.332774, abs=5e-7)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"lower": [5, 1]}, "reversed"),
        ({"lower": [np.nan, 1]}, "not finite"),
        ({"start": [5.0, 1.0]}, "outside its bounds"),
        ({"relaxable": (True,)}, "relaxable"),
    ],
)
def test_bad_problems_are_refused(change, message):
    """Reversed or missing bounds and a start outside them are input errors that name them."""
    fields = {"names": ("a", "b"), "lower": [1, 1], "upper": [2, 2]} | change
    with pytest.raises(InputError, match=message):
        BoxProblem(evaluate=lambda x: PointValues(x[0]), **fields)


def test_wrong_shapes_are_refused():
    """An evaluation with the wrong number of constraints is an input error that says so."""
    problem = box(lambda x: PointValues(x[0], np.stack([x[0]] * 3)), constraints=("a", "b"))
    with pytest.raises(InputError, match="constraints have the shape"):
        solve(problem)


@pytest.mark.parametrize("style", ["float", "abs", "declared"])
def test_functions_without_complex_step_fall_back(style):
    """Functions that lose the imaginary part, or refuse it, fall back to differences, loudly."""

    def evaluate(x):
        if style == "abs":  # silently wrong: the modulus has no imaginary part
            return PointValues(x[0] + x[1], (np.abs(x[0] * x[1]) - 1)[None])
        if np.iscomplexobj(x):
            raise TypeError("no complex numbers, please")
        return PointValues(x[0] + x[1], (x[0] * x[1] - 1)[None])

    found = solve(box(evaluate, constraints=("product",), has_complex_step=style != "declared"))
    assert found.outcome is Outcome.OPTIMUM
    np.testing.assert_allclose(found.x, [1, 1], rtol=1e-6)
    assert found.kkt.residual <= 1e-6
    assert any("finite differences" in w for w in found.warnings)


def test_exact_gradients_need_no_fallback():
    """The finite-difference check passes on every benchmark problem: no warning."""
    for problem in (problems.rosen_suzuki(), problems.thrust_bearing(), problems.hs71()):
        evaluator = Evaluator(problem)
        z = evaluator.space.lower + 0.6 * (evaluator.space.upper - evaluator.space.lower)
        assert evaluator.check_gradients(evaluator.point(z)) == ()


def test_gradients_match_central_differences():
    """Complex-step gradients and the Hessian in solver coordinates match central differences."""
    evaluator = Evaluator(problems.pressure_vessel().problem)
    z = (evaluator.space.lower + evaluator.space.upper) / 2
    point = evaluator.point(z)
    exact = evaluator.jacobian(point)
    weights = np.array([1.0, -300.0, 20.0, -5.0, 0.0])
    hessian = evaluator.hessian(point, weights, np.arange(4))
    for j in range(4):
        step = np.zeros(4)
        step[j] = 1e-5
        above, below = evaluator.point(z + step), evaluator.point(z - step)
        np.testing.assert_allclose(
            (above.rows - below.rows) / 2e-5, exact[:, j], rtol=1e-7, atol=1e-5
        )
        slope = weights @ (evaluator.jacobian(above) - evaluator.jacobian(below)) / 2e-5
        np.testing.assert_allclose(slope, hessian[j], rtol=1e-6, atol=1e-3)


def test_one_evaluation_per_point():
    """Objective, constraints and gradients of a point share one evaluation."""
    evaluator = Evaluator(problems.rosen_suzuki())
    z = np.full(4, 0.1)
    for _ in range(3):
        evaluator.jacobian(evaluator.point(z))
    assert (evaluator.evaluations, evaluator.gradients) == (1, 1)


def test_low_discrepancy_points():
    """Halton points fill the cube evenly: every cell of 2^a 3^b boxes holds its exact share.

    [Halton1960]: among the first 2^a 3^b points each elementary box holds exactly one; random
    digit permutations [Owen2017] keep that.
    """
    points = Halton(2, seed=3).points(0, 2**5 * 3**3)
    cells = np.floor(points[0] * 32).astype(int) * 27 + np.floor(points[1] * 27).astype(int)
    np.testing.assert_array_equal(np.bincount(cells), np.ones(32 * 27))
    assert points.min() >= 0
    assert points.max() < 1
    whole = Halton(12, seed=5).points(0, 100)
    parts = np.concatenate(
        [Halton(12, seed=5).points(0, 37), Halton(12, seed=5).points(37, 63)], axis=1
    )
    np.testing.assert_array_equal(whole, parts)
    assert not np.array_equal(whole, Halton(12, seed=6).points(0, 100))


def test_normal_path_imports_no_scipy():
    """Solving and pricing load no SciPy (it alone would cost a third of the time budget)."""
    import subprocess

    code = (
        "import sys, problems\n"
        "from actuator_opt.optimisation.solver import solve\n"
        "from actuator_opt.optimisation.prices import prices\n"
        "p = problems.pressure_vessel()\n"
        "prices(p, solve(p.problem))\n"
        "assert 'scipy' not in sys.modules, 'scipy was imported'\n"
    )
    here = problems.__file__.rsplit("/", 1)[0]
    environment = {"PYTHONPATH": f"{here}:{here}/.."}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("slsqp", [True, False])
def test_the_best_point_is_completed(monkeypatch, slsqp):
    """A better point that is no optimum yet is the answer once it is one, also without SLSQP."""

    def evaluate(x):
        valley = (x[1] - x[0] ** 2) ** 2
        return PointValues(1 + (x[0] - 2) ** 2 + 10 * valley, np.stack([x[1] - 1]))

    problem = BoxProblem(
        ("a", "b"), np.array([0.5, 0.5]), np.array([3.0, 9.0]), evaluate, ("least",)
    )
    search = Descents(Evaluator(problem), 0)
    near, far = (
        search.evaluator.point(search.evaluator.space.to_z(np.array(x)))
        for x in ([1.999, 3.997], [1.9, 3.6])
    )
    search.optima = [
        SearchResult(far, 0.0, "known"),
        SearchResult(near, search.residual(near), "stopped"),
    ]
    if not slsqp:
        keep = lambda evaluator, start, name, **_: nlopt_wrapper.NloptRun(start, 1, name)  # noqa: E731
        monkeypatch.setattr(nlopt_wrapper, "run", keep)
        monkeypatch.setattr(parallel_descents, "polish", lambda evaluator, point: point)
    search.complete()
    best = search.best()
    assert best.good
    assert best.point.x == pytest.approx([2.0, 4.0], rel=1e-6)
    assert best.point.objective <= near.objective
    assert "stopped" not in {result.algorithm for result in search.optima}
