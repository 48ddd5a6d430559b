"""Metrics of a single load case or duty cycle, METRIC[NAME], and levels that cycles choose."""

from __future__ import annotations

from functools import cache
from itertools import product
from pathlib import Path

import pytest
from cli_runner import run

import actuator_opt as ao
from actuator_opt.metrics import METRICS, split_case, term_of

DESIGNS = Path(__file__).parents[2] / "designs"
GAIT = DESIGNS / "cycles" / "gait_knee.csv"
DUTY = f"""
valve: {{rated_flow: 6 l/min, natural_frequency: 100 Hz}}
duty:
  levels:
    - {{name: low, pressure: 100 bar}}
    - {{name: high, pressure: 210 bar}}
  cycles:
    - {{name: walk, file: {GAIT}, lever_arm: 57 mm, torque_scale: 2, level: low}}
    - {{name: trot, file: {GAIT}, lever_arm: 57 mm, torque_scale: 2, time_scale: 0.9}}
"""
BOUNDS = "variables:\n  duty.levels[low].pressure: {lower: 30 bar, upper: 150 bar}\n"


@cache
def text(choices: str = "") -> str:
    """The steel cylinder with two cycles; the level of one of them is free."""
    base = (DESIGNS / "steel_baseline.yaml").read_text("utf-8")
    return base.replace("variables:\n", BOUNDS, 1) + DUTY + choices


def design(**changed) -> ao.Actuator:
    """The design with values changed by PATH."""
    return ao.read(text(), set=changed)


def test_names_of_metrics_in_a_case():
    """They have the quantity of their metric and words of their own."""
    assert split_case("duty_supply_energy[walk]") == ("duty_supply_energy", "walk")
    quantity = METRICS["duty_supply_energy[walk]"]
    assert (quantity.dimension, quantity.label) == (
        "energy", "energy from the supply per duty cycle, walk",
    )  # fmt: skip
    assert term_of("duty_supply_energy[walk]") == "supply energy, walk"
    assert "duty_supply_energy[walk]" not in METRICS
    for unknown in ("energy[walk]", "duty_supply_energy[]"):
        with pytest.raises(KeyError):
            METRICS[unknown]


def test_requirements_hold_in_the_case_that_they_name():
    """A duty cycle, a load case, and a metric with several places."""
    found = ao.evaluate(
        design(
            **{
                "requirements.duty_supply_energy[walk].max": "500 J",
                "requirements.duty_pressure_min[trot].min": "1 bar",
                "requirements.friction_running[swing].max": "200 N",
            }
        )
    )
    own = {row.name: row for row in found.requirements if "[" in row.metric}
    assert set(own) == {
        "duty_supply_energy[walk]", "duty_pressure_min[trot]", "friction_running[swing]",
    }  # fmt: skip
    energy = own["duty_supply_energy[walk]"]
    assert energy.value == found.metrics["duty_supply_energy"].by_place["walk"]
    assert energy.value < found.metrics["duty_supply_energy"].value  # that of trot
    assert (energy.case, energy.limit, energy.met) == ("walk", 500.0, True)
    lowest = found.metrics["duty_pressure_min"].by_place
    pressure = own["duty_pressure_min[trot]"]
    assert pressure.value == min(lowest["trot, chamber A"], lowest["trot, chamber B"])
    friction = own["friction_running[swing]"]
    assert friction.value == found.metrics["friction_running"].by_case["swing"]
    assert friction.case == "swing"
    metric = found.metrics["duty_supply_energy[walk]"]
    assert (metric.value, metric.case, metric.model) == (
        energy.value, "walk", found.metrics["duty_supply_energy"].model,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("duty_supply_energy[wlak]", '"wlak" is not a duty cycle; did you mean "walk"?'),
        ("friction_running[walk]", '"walk" is not a load case; use one of stance, swing'),
        ("system_mass[walk]", "a value of all duty cycles together; write system_mass"),
        ("nothing[walk]", "is not a metric"),
    ],
)
def test_a_case_that_is_none_is_refused(name, words):
    """As objective, as weight and as requirement, with what to write."""
    changes = (
        {"objective.minimise": name},
        {f"requirements.{name}.max": 1.0},
    )
    for change in changes:
        with pytest.raises(ao.InputError) as error:
            design(**change)
        assert words in str(error.value)
    weights = text().replace("minimise: mass", f"minimise:\n    mass: 1\n    {name}: 1")
    with pytest.raises(ao.InputError) as error:
        ao.read(weights)
    assert words in str(error.value)


def test_a_metric_without_a_value_of_the_case_says_so():
    """The mean of all cycles heats the actuator, so no cycle has temperatures of its own."""
    limit = {"requirements.duty_oil_temperature[walk].max": "90 degC"}
    found = ao.evaluate(design(**limit, **{"duty.thermal": "mean", "duty.cycles[walk].repeats": 9}))
    (row,) = [row for row in found.requirements if "[" in row.metric]
    assert (row.value, row.met) == (None, False)
    assert "no value of its own for walk" in found.metrics[row.metric].why


@pytest.mark.long
def test_the_energy_of_one_cycle_is_an_objective():
    """Its level falls until it needs all of it; trot, the worst of all, only has to be possible."""
    goal = {"objective.minimise": "duty_supply_energy[walk]"}
    found = ao.optimise(design(**goal), starts=1, prices=False)
    assert found.kkt.residual <= 1e-6
    walk, trot = found.evaluation.duty.cycles
    assert walk.traces["share"].max() == pytest.approx(1.0, rel=1e-6)
    assert trot.traces["share"].max() < 0.7
    objective = found.to_dict()["objective"]
    assert objective["metric"] == "duty_supply_energy[walk]"
    assert objective["value"] == pytest.approx(walk.energies["supply_energy"], rel=1e-9)
    assert objective["value"] < trot.energies["supply_energy"]


def test_a_level_is_the_supply_pressure_of_its_cycle():
    """All metrics are those of the pressure stated for the cycle itself."""
    level = ao.evaluate(design(**{"duty.levels[low].pressure": "90 bar"})).metrics
    stated = {"duty.cycles[walk].level": None, "duty.cycles[walk].supply_pressure": "90 bar"}
    unset = {"variables.duty.levels[low].pressure": None}
    own = ao.evaluate(design(**unset, **stated)).metrics
    duty = [name for name in own if name.startswith("duty_")]
    assert len(duty) > 20
    for name in duty:
        assert level[name].by_place == own[name].by_place, name


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"duty.cycles[walk].level": "mid"}, '"mid" is not a level of duty.levels; use one of low'),
        ({"duty.cycles[walk].supply_pressure": 90e5}, "the cycle states supply_pressure too"),
        ({"duty.levels[high].pressure": "220 bar"}, "above supply.pressure (210 bar)"),
        ({"duty.levels[high].name": "low"}, '"low": also the name of entry 0'),
    ],
)
def test_faulty_levels_are_refused(changed, words):
    """With what to write."""
    with pytest.raises(ao.InputError) as error:
        design(**changed)
    assert words in str(error.value)


def test_a_choice_of_an_unknown_level_is_refused():
    """At its place in the list."""
    with pytest.raises(ao.InputError, match=r"level\[1\]: \"hgh\" is not a level"):
        ao.read(text("choices:\n  duty.cycles[walk].level: [low, hgh]\n"))


@pytest.mark.long
def test_choices_of_levels_find_the_best_combination():
    """The four combinations by hand; a level that no cycle uses is not a variable of them."""
    goal = {
        "objective.minimise": "duty_supply_energy[walk]", "requirements.duty_supply_share.max": 0.8,
        "requirements.duty_supply_energy[trot].max": "1000 J",
    }  # fmt: skip
    cycles = ("walk", "trot")
    by_hand = {}
    for levels in product(("low", "high"), repeat=2):
        stated = {f"duty.cycles[{x}].level": y for x, y in zip(cycles, levels, strict=True)}
        if "low" not in levels:
            stated["variables.duty.levels[low].pressure"] = None
        found = ao.optimise(design(**goal, **stated), starts=2, prices=False)
        if found.status == "optimal":
            by_hand[levels] = found.to_dict()["objective"]["value"]
    choices = "".join(f"  duty.cycles[{name}].level: [low, high]\n" for name in cycles)
    found = ao.optimise(ao.read(text(f"choices:\n{choices}"), set=goal), prices=False)
    best = min(by_hand, key=by_hand.get)
    assert len(by_hand) >= 2
    assert found.to_dict()["objective"]["value"] == pytest.approx(by_hand[best], rel=1e-6)
    assert tuple(found.to_dict()["choices"]["best"].values()) == best


@pytest.mark.long
def test_commands_take_metrics_of_a_case(tmp_path):
    """A front, a sweep with its explorer, and an optimum with its report."""
    file = tmp_path / "two.yaml"
    file.write_text(text(), "utf-8")
    names = ("--objective", "duty_supply_energy[walk]:min", "--objective", "mass:min")
    front = run("pareto", file, *names, "-n", "4", "--json")
    assert front.code in (0, 1), front.err
    assert all("duty_supply_energy[walk]" in point["metrics"] for point in front.json["points"])
    wrong = run("pareto", file, "--objective", "duty_supply_energy[trt]:min", *names[2:])
    assert wrong.code == 2
    assert "no value of its own for trt" in wrong.err
    goal = ("--set", "objective.minimise=duty_supply_energy[walk]")
    store = tmp_path / "rows.db"
    vary = ("--vary", "load.mass=10 kg,20 kg", "--store", store)
    assert run("sweep", file, *goal, *vary).code in (0, 1)
    assert run("explore", store, "--out", tmp_path / "e.html").code == 0
    limit = ("--set", "requirements.duty_supply_share[trot].max=60 %")
    best = run("optimise", file, *goal, *limit, "--starts", "1", "--out", tmp_path, "--write",
               tmp_path / "best.yaml")  # fmt: skip
    assert best.code in (0, 1), best.err
    assert "duty_supply_energy[walk]" in (tmp_path / "best.yaml").read_text()
    again = ao.evaluate(tmp_path / "best.yaml")
    assert again.metrics["duty_supply_share[trot]"].value <= 0.6 * (1 + 1e-6)
