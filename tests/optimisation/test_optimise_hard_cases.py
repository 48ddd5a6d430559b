"""Degenerate and hard cases: the outcome named, the best feasible point kept, never a traceback."""

from __future__ import annotations

import math

import numpy as np
import problems
import pytest
from cli_runner import bench

import actuator_opt as ao
from actuator_opt import api as verbs
from actuator_opt.base.errors import InputError
from actuator_opt.optimisation.problem import BoxProblem, PointValues
from actuator_opt.optimisation.solution import Outcome
from actuator_opt.optimisation.solver import solve


def box(evaluate, n=2, constraints=(), low=0.1, high=10.0, **others):
    """A problem in n variables with the same bounds."""
    names = tuple(f"x{i + 1}" for i in range(n))
    return BoxProblem(names, np.full(n, low), np.full(n, high), evaluate, constraints, **others)


def best(*changes, own=None, **options):
    """The optimum of the bench design, changed, with a metric of one's own; no prices."""
    plugins = [] if own is None else [ao.metric("own")(own)]
    given = {"starts": 1, "prices": False} | options
    return verbs.optimise(verbs.read(bench(*changes), plugins=plugins), **given)


def required(limit="min: 0"):
    """The change that makes the own metric a requirement."""
    return ("requirements:\n", f"requirements:\n  own:\n    {limit}\n")


AIMED = ("minimise: mass", "minimise: own")


@pytest.fixture(scope="module")
def plain():
    """The optimum of the bench design as it stands: the bore at its lower bound, 20 mm."""
    return best()


def test_a_requirement_exactly_at_its_limit():
    """A feasible set of one point, x y >= 100 in a box up to 10, is found and called optimal."""
    found = solve(
        box(lambda x: PointValues(x[0] + x[1], (x[0] * x[1] / 100 - 1)[None]), 2, ("all",))
    )
    assert found.outcome is Outcome.OPTIMUM
    np.testing.assert_allclose(found.x, [10, 10], rtol=1e-9)


def test_a_bore_required_at_its_bound():
    """A requirement that only the upper bound of the bore meets holds there, and is met."""
    upper = ("    upper: 30 mm", "    upper: 22 mm")
    found = best(upper, required("min: 0.022"), own=lambda v: v["cylinder.bore"])
    assert found.status == "optimal"
    assert found.evaluation.met
    assert {v.path: v.value for v in found.variables}["cylinder.bore"] == pytest.approx(0.022)


def test_a_requirement_no_variable_moves_exactly_at_its_limit(plain):
    """What is met by equality whatever moves changes nothing."""
    found = best(required("min: 0.5"), own=lambda v: 0.5)
    assert found.status == "optimal"
    assert found.objective_value == pytest.approx(plain.objective_value, rel=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_two_pieces(seed):
    """Of two discs apart the smaller holds the optimum, known in closed form, and it is found."""
    found = solve(problems.two_pieces(), seed=seed)
    assert found.outcome is Outcome.OPTIMUM
    assert found.objective == pytest.approx(4 - 0.3 * math.sqrt(2), rel=1e-9)
    np.testing.assert_allclose(found.x, 2 - 0.3 / math.sqrt(2), rtol=1e-7)
    assert any(o.objective == pytest.approx(14 - 2.5 * math.sqrt(2)) for o in found.optima)


def test_a_design_of_two_pieces(plain):
    """A bore of 20 to 20.4 mm or above 24 mm, nothing between: the narrow piece is found."""

    def pieces(v):
        bore = 1e3 * v["cylinder.bore"]
        return (bore - 20.4) * (bore - 24)

    found = best(required(), own=pieces)
    assert found.status == "optimal"
    assert found.objective_value == pytest.approx(plain.objective_value, rel=1e-9)


def test_a_copy_of_a_requirement_changes_nothing(plain):
    """The same limit in other words, and an implied one, leave the optimum where it was."""
    found = best(required("min: 0.5"), own=lambda v: v.metric("burst_factor") / 6)
    assert found.status == "optimal"
    assert found.objective_value == pytest.approx(plain.objective_value, rel=1e-9)


def test_an_objective_no_variable_enters_is_refused():
    """One line at the objective, with the remedy, before anything is searched."""
    for changes, own in (
        ((("minimise: mass", "minimise: seal_section"),), None),
        ((AIMED,), lambda v: v["cylinder.stroke"]),
    ):
        with pytest.raises(InputError, match="no variable affects") as caught:
            best(*changes, own=own)
        (fault,) = caught.value.diagnostics
        assert fault.path == "objective"
        assert fault.line is not None
        assert "choose another objective" in fault.remedy


def test_a_flat_objective_keeps_a_feasible_design():
    """An objective that a variable enters but does not move is called flat; the rest is met."""
    found = best(AIMED, own=lambda v: 5.0 + 0.0 * v["cylinder.bore"])
    assert found.status == "flat"
    assert found.evaluation.met
    assert found.objective_value == 5.0


def raises(v):
    """Refuse bores above 25 mm."""
    if np.any(np.real(v["cylinder.bore"]) > 0.025):
        raise ValueError("too big")
    return 40 * v["cylinder.bore"]


def test_a_metric_that_raises_somewhere(plain):
    """Points it refuses are not allowed; the others are searched, and how many is told."""
    found = best(required("min: 0.5"), own=raises)
    assert found.status == "optimal"
    assert found.objective_value == pytest.approx(plain.objective_value, rel=1e-9)
    (told,) = [w for w in found.warnings if "own had no value at" in w]
    assert "ValueError: too big" in told
    share = float(told.split("at ")[1].split(" %")[0])
    # log(30/25)/log(30/20) of the sweep; the local run adds few points
    assert share == pytest.approx(100 * math.log(30 / 25) / math.log(30 / 20), abs=2)


def test_a_metric_nobody_asks_for_may_raise(plain):
    """It stops no search; at the best design it is null with the reason where it raises."""

    def refuses(v):
        if np.any(np.real(v["cylinder.bore"]) < 0.021):
            raise ValueError("too small")
        return 1.0

    found = best(own=refuses)
    assert found.objective_value == pytest.approx(plain.objective_value, rel=1e-9)
    own = found.evaluation.metrics["own"]
    assert own.value is None
    assert "too small" in own.why
    assert not any("own" in w for w in found.warnings)


@pytest.mark.long
@pytest.mark.parametrize("kind", ["math", "interp", "if"])
def test_functions_of_one_number_can_be_used(kind, plain):
    """What takes one real number at a time is asked for each design alone; slopes by differences.

    Each wants a bore of at least 21 mm, the lightest then.
    """

    def own(v):
        bore = v["cylinder.bore"]
        if kind == "math":
            return math.sqrt(bore / 0.021)
        if kind == "interp":
            return np.interp(bore, [0.02, 0.03], [20 / 21, 30 / 21])
        return bore / 0.021 if bore > 0.01 else 0.0

    found = best(required("min: 1"), own=own)
    assert found.status == "optimal"
    bore = {v.path: v.value for v in found.variables}["cylinder.bore"]
    assert bore == pytest.approx(0.021, rel=1e-6)
    assert found.objective_value > plain.objective_value
    if kind != "if":
        assert any("gradient of own is computed by finite differences" in w for w in found.warnings)


def test_a_metric_that_is_nan_somewhere(plain):
    """Points without a number are not allowed, the optimum beside them is found, and it is told."""
    found = best(required("min: 0.5"), own=lambda v: 100 * np.sqrt(0.025 - v["cylinder.bore"]))
    assert found.status == "optimal"
    assert found.objective_value == pytest.approx(plain.objective_value, rel=1e-9)
    assert any("own had no value at" in w for w in found.warnings)


@pytest.mark.parametrize("change", [required(), AIMED])
def test_a_metric_that_is_nan_everywhere(change):
    """The outcome is undefined, the culprit named, and the design as it stands handed back."""
    found = best(change, own=lambda v: np.nan * v["cylinder.bore"])
    assert found.status == "undefined"
    expected = "own had no value at 100 % of the points tried; these points count as infeasible"
    assert expected in found.warnings
    assert {v.path: v.value for v in found.variables}["cylinder.bore"] == pytest.approx(0.022)


def test_equal_and_reversed_bounds_are_told_apart():
    """Equal bounds hold a dimension still; reversed ones are to be swapped."""
    bounds = "    lower: 20 mm\n    upper: 30 mm"
    for upper, message, remedy in (("20 mm", "bounds equal", "remove the entry"),
                                   ("19 mm", "bounds reversed", "swap them")):  # fmt: skip
        (fault,) = verbs.check(bench((bounds, f"    lower: 20 mm\n    upper: {upper}")))
        assert message in fault.message
        assert remedy in fault.remedy


def test_a_requirement_nothing_answers_is_refused_before_the_search():
    """No lines, no velocity in them: one fault at its line, with what to do."""
    with pytest.raises(InputError, match="no lines stated") as caught:
        best(("requirements:\n", "requirements:\n  line_velocity:\n    max: 5 m/s\n"))
    (fault,) = caught.value.diagnostics
    assert fault.line is not None
    assert fault.remedy == "remove the requirement, or add the inputs that it needs"


def test_no_time_at_all_keeps_an_evaluated_point():
    """A time limit of zero ends with the start, evaluated, and the outcome that says so."""
    found = best(max_seconds=0.0)
    assert found.status in ("limit", "limit_infeasible")
    assert {v.path: v.value for v in found.variables}["cylinder.bore"] == pytest.approx(0.022)
    assert math.isfinite(found.objective_value)


def test_the_best_feasible_point_of_the_sweep_is_kept():
    """Where a run leaves what the sweep found feasible, that is handed back.

    ISRES begins at an infeasible start and is stopped before it is anywhere.
    """
    problem = box(
        lambda x: PointValues(x[0] + x[1], (1 - (x[0] - 3) ** 2 - (x[1] - 3) ** 2)[None]),
        2,
        ("in the disc",),
        start=np.array([9.0, 0.2]),
    )
    found = solve(problem, algorithm="GN_ISRES", max_evaluations=3)
    assert found.feasible_samples > 0
    assert found.feasible
    assert found.outcome is Outcome.LIMIT


@pytest.mark.parametrize("after", [1, 15])
@pytest.mark.parametrize("algorithm", ["auto", "LN_COBYLA"])
def test_an_interrupt_keeps_the_best_point(after, algorithm):
    """Where asked for, Ctrl-C ends the search like a limit: outcome named, best point kept."""
    calls = []

    def evaluate(x):
        calls.append(1)
        if len(calls) == after:
            raise KeyboardInterrupt
        return PointValues(x[0] + x[1], (x[0] * x[1] - 1)[None])

    problem = box(evaluate, 2, ("product",), start=np.array([5.0, 5.0]))
    found = solve(problem, algorithm=algorithm, keep_interrupted=True)
    assert found.outcome is Outcome.INTERRUPTED
    assert found.feasible
    assert found.objective <= 10
    again = box(evaluate, 2, ("product",), start=np.array([5.0, 5.0]))
    calls.clear()
    with pytest.raises(KeyboardInterrupt):
        solve(again, algorithm=algorithm)
