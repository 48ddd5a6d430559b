"""A warm session: its optima are the cold ones, its prices and predictions their derivatives."""

import importlib.util
import math
import sys
from pathlib import Path

import numpy as np
import pytest

import actuator_opt as ao
from actuator_opt.optimisation.evaluator import Evaluator
from actuator_opt.optimisation.resolve.steps import Batch, run_batch

ROOT = Path(__file__).parents[2]
STEEL = ROOT / "designs" / "steel_baseline.yaml"
STROKE = "cylinder.stroke"


@pytest.fixture(scope="module")
def steel():
    """A session on the steel cylinder."""
    return ao.session(STEEL)


@pytest.fixture(scope="module")
def priced():
    """The steel cylinder optimised with its prices."""
    return ao.optimise(STEEL)


def cold(changes):
    """The optimum of the file with changes, searched for anew."""
    return ao.optimise(ao.read(STEEL).changed(changes), prices=False)


def benchmark():
    """The benchmark of sessions as a module."""
    spec = importlib.util.spec_from_file_location("session_bench", ROOT / "benchmarks/session.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def test_the_optimum_is_that_of_optimise(steel):
    """The one cold solve is `optimise` without prices, to the last digit."""
    ours, theirs = steel.optimum.to_dict(), ao.optimise(STEEL, prices=False).to_dict()
    assert {**ours, "seconds": 0} == {**theirs, "seconds": 0}


@pytest.mark.long
def test_random_moves_agree_with_a_cold_solve(steel, priced):
    """No move of priced numbers within 2 % is worse than its cold solve, or fails without it."""
    paths = [row.parameter for row in priced.sensitivities if row.limit]
    done = list(benchmark().moves(str(STEEL), steel, paths, 10, 1))
    assert [move.verdict for move in done if move.verdict not in ("same", "better")] == []
    assert len({tuple(move.changes) for move in done}) > 5


def test_changes_are_the_whole_difference(steel):
    """What was solved before changes nothing, and no change is the optimum itself."""
    first = steel.solve({STROKE: "112 mm"})
    steel.solve({STROKE: 0.1, "supply.pressure": "22 MPa"})
    steel.price("supply.pressure")
    again = steel.solve({STROKE: 0.112})
    assert again.objective_value == first.objective_value
    assert again.variables == first.variables
    same = steel.solve({})
    assert same.objective_value == pytest.approx(steel.optimum.objective_value, rel=1e-12)
    assert same.status == "optimal"


def test_new_numbers_give_the_problem_that_is_built_anew(steel):
    """Same limits and values, at once; a number that decides a limit of no variable is built."""
    x = steel._warm.point.x[:, None]
    again = {}
    for path in (STROKE, "requirements.stiffness_min.min", "load_cases[stance].force",
                 "fluid.temperature", "head.clearance", "seals.rod.stretch"):  # fmt: skip
        value = 1.03 * float(steel._warm.actuator.subject.numbers[path])
        actuator, numbers = steel._changed({path: value})
        _, problem, again[path] = steel._problem(actuator, numbers)
        built = steel._built(actuator)[1]
        assert problem.problem.same_rows_and_box(built.problem)
        assert problem.problem.rows(x) == pytest.approx(built.problem.rows(x), rel=1e-9, abs=1e-9)
        assert [row.label for row in problem.fixed] == [row.label for row in built.fixed]
    assert list(again.values()) == [True] * 4 + [False] * 2


def test_a_bare_optimum_is_the_optimum(steel):
    """Objective, dimensions and active limits of `solve`; None beyond what steps reach."""
    for changes in ({STROKE: 0.112}, {STROKE: 0.112, "supply.pressure": "20.5 MPa"}, {}):
        bare, full = steel.bare_optimum(changes), steel.solve(changes)
        assert bare.objective == pytest.approx(full.objective_value, rel=1e-12)
        assert bare.variables == pytest.approx({v.path: v.value for v in full.variables})
        assert bare.active == full.kkt.active
        assert bare.residual <= 1e-6
        assert {row.label for row in bare.limits} <= set(bare.active)
        assert bare.subject.numbers[STROKE] == full.design.cylinder.stroke
        assert bare.subject.numbers["cylinder.bore"] == bare.variables["cylinder.bore"]
        assert bare.to_dict()["active"] == list(bare.active)
    assert steel.bare_optimum({"requirements.stiffness_min.min": "60 kN/mm"}) is None
    assert steel.bare_optimum({STROKE: 0.112}, stop=lambda: True) is None
    moved = steel.at({STROKE: 0.112})
    assert moved.optimum is not steel.optimum
    assert moved.bare_optimum({}).objective == pytest.approx(moved.optimum.objective_value)


def test_a_warm_optimum_meets_every_requirement_and_its_conditions(steel):
    """The result is evaluated with the changes, and stationary to 1e-6, without a sweep."""
    found = steel.solve({STROKE: 0.112})
    assert found.status == "optimal"
    assert found.evaluation.met
    assert found.kkt.residual <= 1e-6
    assert found.samples == 0
    assert found.design.cylinder.stroke == 0.112
    assert found.sensitivities == ()


@pytest.mark.parametrize(
    "changes",
    [
        pytest.param({"environment.temperature_max": "60 degC"}, marks=pytest.mark.long),
        {"fluid.temperature": "50 degC"},
        {"variables.cylinder.bore.lower": "21.5 mm"},
        pytest.param({"requirements.mass.max": "0.4 kg"}, marks=pytest.mark.long),
        pytest.param({"requirements.stiffness_min.min": "6 kN/mm"}, marks=pytest.mark.long),
        {STROKE: "80 mm"},
    ],
    ids=str,
)
def test_changes_beyond_the_priced_numbers_agree_too(steel, changes):
    """Temperatures, bounds, new limits, much looser limits and long moves: all as searched anew."""
    warm, searched = steel.solve(changes), cold(changes)
    assert warm.status == searched.status == "optimal"
    assert warm.objective_value <= searched.objective_value * (1 + 1e-6)


def test_nothing_fits_only_after_a_search(steel):
    """A mass that no design has is infeasible, with a status and a sweep made."""
    found = steel.solve({"requirements.stiffness_min.min": "60 kN/mm"})
    assert found.status == "infeasible"
    assert found.samples > 0
    assert not found.evaluation.met


def test_prices_come_where_asked_for(steel):
    """With prices the result has the table of `optimise`."""
    found = steel.solve({STROKE: 0.111}, prices=True)
    table = ao.optimise(ao.read(STEEL).changed({STROKE: 0.111})).sensitivities
    ours = {row.parameter: row.price for row in found.sensitivities}
    assert ours == pytest.approx({row.parameter: row.price for row in table}, rel=1e-5, abs=1e-12)


def test_a_stop_ends_between_steps(steel):
    """Stopped at once, the unchanged optimum comes back; never stopped, the new one."""
    stopped = steel.solve({STROKE: 0.112}, stop=lambda: True)
    assert stopped.status == "interrupted_infeasible"  # the old optimum misses the longer stroke
    free = steel.solve({"requirements.friction_running.max": "400 N"}, stop=lambda: True)
    assert free.status == "interrupted"
    asked = []
    done = steel.solve({STROKE: 0.112}, stop=lambda: bool(asked.append(1)))
    assert done.objective_value == steel.solve({STROKE: 0.112}).objective_value
    assert len(asked) >= 2


def test_a_stop_half_way_comes_at_once(steel):
    """After the second question no more steps are made."""
    asked = []
    steel.solve({STROKE: 0.112}, stop=lambda: bool(asked.append(1)) or len(asked) >= 2)
    assert len(asked) == 2


def test_a_stopped_curve_keeps_what_was_solved(steel):
    """Nothing that was not solved counts as found, though the old optimum would do."""
    path = "requirements.friction_running.max"
    assert steel.curve(path, ["400 N", "410 N"], stop=lambda: True).found == (False, False)
    asked = []
    path = "environment.temperature_max"  # each value by itself
    curve = steel.curve(
        path, ["69 degC", "60 degC"], stop=lambda: bool(asked.append(1)) or len(asked) > 2
    )
    assert curve.found == (False, False)


def test_prices_are_those_of_the_table(steel, priced):
    """Slopes, movement and the nearer end of what holds are those `optimise` prints."""
    for row in priced.sensitivities:
        price = steel.price(row.parameter)
        size = priced.objective_value / row.limit
        assert price.value == row.limit
        assert price.slope_up == pytest.approx(row.price_up, rel=1e-6, abs=1e-9 * size)
        assert price.slope_down == pytest.approx(row.price_down, rel=1e-6, abs=1e-9 * size)
        ends = [end for end in price.holds if end is not None]
        nearest = min(ends, key=lambda end, at=row.limit: abs(end - at), default=None)
        assert (nearest is None) == (row.holds_until is None)
        if nearest is not None:
            assert nearest == pytest.approx(row.holds_until, rel=1e-6)
            assert row.next_active in price.changes
        assert price.holds[0] is None or price.holds[0] <= price.value
        assert price.holds[1] is None or price.holds[1] >= price.value
        move = [price.movement[v.path] for v in priced.variables]
        known = [row.movement[v.path] for v in priced.variables]
        assert move == pytest.approx(known, rel=1e-4, abs=1e-9 / row.limit)


def test_the_active_set_changes_where_the_price_says(steel):
    """Just inside both ends the same limits hold the optimum; beyond the lower one others do."""
    price = steel.price("requirements.burst_factor.min")
    low, high = price.holds
    inside = steel.solve({price.path: low + 0.1 * (price.value - low)})
    outside = steel.solve({price.path: low - 0.3 * (price.value - low)})
    assert set(inside.kkt.active) == set(steel.optimum.kkt.active)
    assert set(outside.kkt.active) != set(steel.optimum.kkt.active)
    assert price.changes[0].removesuffix(" becomes active") in outside.kkt.active
    assert low < price.value < high


@pytest.mark.parametrize("step", [1e-3, -1e-3])
def test_predictions_are_first_order(steel, step):
    """The error of a prediction falls with the square of the change, of one number and of two."""
    for paths in ([STROKE], [STROKE, "supply.pressure"]):
        errors = []
        for size in (step, step / 4):
            changes = {p: steel.price(p).value * (1 + size) for p in paths}
            told, solved = steel.predict(changes), steel.solve(changes)
            assert told.valid
            assert told.why == ""
            errors.append(abs(told.objective - solved.objective_value))
            x = {v.path: v.value for v in solved.variables}
            assert told.variables == pytest.approx(x, rel=50 * size**2, abs=1e-9)
        assert errors[1] <= errors[0] / 12 + 1e-10


def test_a_prediction_says_where_it_ends(steel):
    """Beyond what holds it is not valid and names what changes, and after which share."""
    price = steel.price("requirements.burst_factor.min")
    low, _ = price.holds
    inside = steel.predict({price.path: low + 0.01 * (price.value - low)})
    beyond = steel.predict({price.path: price.value + 2 * (low - price.value)})
    assert inside.valid
    assert not beyond.valid
    assert beyond.why == f"after 50 % of the change, {price.changes[0]}"
    nothing = steel.predict({price.path: price.value})
    assert (nothing.objective, nothing.valid) == (steel.optimum.objective_value, True)


def test_a_curve_is_its_solves(steel):
    """Values in any order, with units; every optimum as solved alone."""
    curve = steel.curve(STROKE, ["120 mm", 0.1, 0.11, 0.125])
    assert len(curve) == 4
    assert curve.values == pytest.approx((0.12, 0.1, 0.11, 0.125))
    assert curve.found == (True,) * 4
    for value, objective, x in zip(curve.values, curve.objectives, curve.variables, strict=True):
        alone = steel.solve({STROKE: value})
        assert objective == pytest.approx(alone.objective_value, rel=1e-6)
        assert x == pytest.approx({v.path: v.value for v in alone.variables}, rel=1e-3)
    assert "120 mm" in str(curve).splitlines()[1]
    assert curve.columns()["objective"] == list(curve.objectives)
    table = curve.table()
    assert (table.units[STROKE], table.units["objective"]) == ("m", "kg")
    assert [*table["objective"]] == list(curve.objectives)
    again = steel.curve(STROKE, np.array([0.12, 0.1]))
    assert again.objectives == pytest.approx(curve.objectives[:2], rel=1e-9)


@pytest.mark.parametrize(
    ("values", "told"),
    [
        (np.zeros((2, 2)), "cylinder.stroke: an array of 2 dimensions"),
        (np.array([0.1, np.nan]), "cylinder.stroke: the value at index 1 is nan"),
        ([0.1, None], "cylinder.stroke: the value at index 1 is not a number"),
        (np.array([]), "cylinder.stroke: has no values"),
        (["0.1 m", "110"], "cylinder.stroke: the text at index 1 has no unit"),
    ],
)
def test_values_that_a_curve_cannot_take(steel, values, told):
    """One line with PATH and index."""
    with pytest.raises(ao.InputError) as fault:
        steel.curve(STROKE, values)
    assert str(fault.value).startswith(told)


def test_a_curve_of_what_decides_more_than_the_models_read(steel):
    """Temperatures change factors on materials: every value is solved by itself."""
    path = "environment.temperature_max"
    curve = steel.curve(path, ["60 degC", "65 degC"])
    for value, objective in zip(curve.values, curve.objectives, strict=True):
        assert objective == pytest.approx(cold({path: value}).objective_value, rel=1e-6)


def test_a_curve_marks_where_no_design_is_found(steel):
    """Beyond the last possible value there is none, and NaN in the columns."""
    path = "requirements.stiffness_min.min"
    curve = steel.curve(path, ["9 kN/mm", "60 kN/mm", "70 kN/mm"])
    assert curve.found == (True, False, False)
    assert "none found" in str(curve)
    assert math.isnan(curve.columns()["objective"][1])
    assert curve.to_dict()["objectives"][1:] == [None, None]


@pytest.mark.parametrize(
    ("act", "kind", "words"),
    [
        (lambda s: s.solve({"cylinder.strok": 0.1}), ao.InputError, 'mean "cylinder.stroke"'),
        (lambda s: s.solve({"rod.material": "steel_e355"}), ao.InputError, "new session"),
        (lambda s: s.solve({STROKE: math.nan}), ao.InputError, "not a number"),
        (lambda s: s.solve({STROKE: math.inf}), ao.InputError, STROKE),
        (lambda s: s.solve({STROKE: "long"}), ao.InputError, "number with a unit"),
        (lambda s: s.solve({STROKE: "5 N"}), ao.InputError, "need a length"),
        (lambda s: s.solve({STROKE: None}), ao.InputError, "must be a number"),
        (lambda s: s.solve({STROKE: True}), ao.InputError, "must be a number"),
        (lambda s: s.solve([STROKE]), ao.ActuatorError, "mapping from PATH"),
        (lambda s: s.solve({"cylinder.bore": 0.02}), ao.ActuatorError, "free dimension"),
        (lambda s: s.predict({"requirements.mass.max": 1.0}), ao.ActuatorError, "no derivative"),
        (lambda s: s.price("cylinder.bore"), ao.ActuatorError, "free dimension"),
        (lambda s: s.price("variables.cylinder.bore.upper"), ao.ActuatorError, "session.solve"),
        (lambda s: s.price("environment.temperature_max"), ao.ActuatorError, "session.solve"),
        (lambda s: s.predict({"seals.rod.count": 2}), ao.ActuatorError, "whole number"),
        (lambda s: s.price("nothing"), ao.InputError, "unknown PATH"),
        (lambda s: s.price(3), ao.InputError, "must be a PATH"),
        (lambda s: s.curve(STROKE, []), ao.ActuatorError, "list of values"),
        (lambda s: s.curve(STROKE, "110 mm"), ao.ActuatorError, "list of values"),
        (lambda s: s.curve(STROKE, [0.1, "x"]), ao.InputError, "number with a unit"),
    ],
)
def test_bad_input_is_one_clear_fault(steel, act, kind, words):
    """What, where and what to do."""
    with pytest.raises(kind, match=r".") as caught:
        act(steel)
    assert len(caught.value.diagnostics) == 1
    text = caught.value.diagnostics[0]
    assert words in f"{text.path}: {text.message}; {text.remedy}"
    assert text.remedy


def test_designs_without_a_session():
    """No variables, no design that fits, choices, sizes: each says what to do."""
    text = STEEL.read_text(encoding="utf-8")
    bare = text[: text.index("\nvariables:")] + "\n"
    with pytest.raises(ao.InputError, match="no variables"):
        ao.session(bare)
    with pytest.raises(ao.InputError, match="no design meets all requirements"):
        ao.session(STEEL, set={"requirements.stiffness_min.min": "60 kN/mm"})
    choices = f"{text}\nchoices:\n  rod.material: [steel_42crmo4, ti_6al4v]\n"
    with pytest.raises(ao.ActuatorError, match="choices"):
        ao.session(choices)
    sized = text.replace("cylinder.bore:\n", "cylinder.bore:\n    sizes: iso_3320\n", 1)
    with pytest.raises(ao.ActuatorError, match="sizes"):
        ao.session(sized)


def test_a_session_of_a_changed_design(steel):
    """`set` is part of the design as read, for files and for actuators."""
    want = steel.solve({STROKE: 0.112}).objective_value
    for design in (STEEL, ao.read(STEEL)):
        found = ao.session(design, set={STROKE: "112 mm"})
        assert found.optimum.objective_value == pytest.approx(want, rel=1e-9)
    assert repr(found) == f"<Session 'steel knee': mass {1000 * want:.4g} g>"


def test_solvers_in_a_batch_see_only_their_own_points():
    """Each gets what it asked for, in rounds; one that is dropped has no result."""

    def count(name, rounds):
        total = 0.0
        for k in range(rounds):
            point = yield np.array([name, k], dtype=float)
            total += point
        return total

    asked = []

    def answer(wanted):
        asked.append(list(wanted))
        return [100.0 * z[0] + z[1] for z in wanted.values()]

    assert run_batch([count(1, 3), count(2, 1), count(3, 0)], answer) == [303.0, 200.0, 0.0]
    assert asked == [[0, 1], [0], [0]]
    batch = Batch([count(1, 2), count(2, 2)], answer)
    batch.step()
    batch.drop(0)
    batch.step()
    assert batch.results == {1: 401.0}
    assert not batch.requests


def test_an_evaluator_asks_whether_to_stop(steel):
    """A stop counts as a used-up limit."""
    problem = steel._warm.actuator.problem
    assert not Evaluator(problem, stop=lambda: False).late
    assert Evaluator(problem, stop=lambda: True).late
