"""Requirements checked in time against the linear tier, and sensitivities against closed forms."""

import json
from dataclasses import replace
from functools import cache
from math import pi, prod, sqrt
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import actuator_opt as ao
from actuator_opt.base.errors import InputError
from actuator_opt.design.model import Limit
from actuator_opt.design.scenario.model import Scenario, ScenarioLoad
from actuator_opt.evaluation.build import prepare
from actuator_opt.evaluation.springs import Give
from actuator_opt.pages import verification as pages
from actuator_opt.rendering import terminal
from actuator_opt.simulation import sensitivity
from actuator_opt.simulation.sensitivity import sensitivities
from actuator_opt.simulation.verification import DYNAMIC, experiments, verify
from actuator_opt.simulation.verification.experiments import Stand
from actuator_opt.simulation.verification.verify import _left_out
from actuator_opt.studies.plant import Plane, SealData, ValveData, plant

KNEE = Path(__file__).parents[2] / "designs" / "servo_knee.yaml"
BAR = 1e5
MIDDLE = 0.5 * (210 + 5) * BAR
"""Of supply and return pressure of the knee: there both ways of its valve are alike."""
LIMITS = {
    "bandwidth": Limit(min=5.0),
    "gain_margin": Limit(min=2.0),
    "ultimate_gain": Limit(min=1000.0),
    "phase_margin": Limit(min=0.7),
    "dynamic_stiffness": Limit(min=9e6),
    "dynamic_phase": Limit(max=1.2),
    "natural_frequency": Limit(min=100.0),
    "damping_ratio": Limit(min=0.02),
}


FULL, CENTRED = 10 / sqrt(35), 1 / sqrt(50)
OPENED = FULL / (FULL - CENTRED)
"""K_10/(K_10 - K_0) of the valve of the slow loop: what 1 % of its rated flow opens."""


def knee(*, requirements=None, cases=None, changes=()):
    """The knee with some of it other, ready for the models."""
    design = ao.read(KNEE, set=dict(changes)).design
    known = {"requirements": LIMITS if requirements is None else requirements}
    known |= {} if cases is None else {"load_cases": cases(design.load_cases)}
    return prepare(design.model_copy(update=known))


def balanced(cases):
    """The first case with equal pressures that open neither edge of the valve at rest."""
    return (cases[0].model_copy(update={"pressure_a": MIDDLE, "pressure_b": MIDDLE}),)


def scenario(friction="none", **more):
    """A step of the knee's position."""
    step = {"shape": "step", "start": 0.05, "value": 5e-3}
    return Scenario.model_validate(
        {
            "name": "step",
            "design": "knee_bonded.yaml",
            "duration": 0.4,
            "friction": {"model": friction},
            "control": {"position": [step]},
            "requirements": {"overshoot": {"max": 0.05}, "rise_time": {"max": 0.01}},
        }
        | more
    )


@cache
def small(gain=500):
    """The knee without sticking friction, its valve alike in both ways, swings of a fiftieth."""
    changes = {"control.gain": f"{gain} V/m"}
    return verify(scenario(), knee(cases=balanced, changes=changes), scale=0.02)


@cache
def sticking():
    """The knee as it is, with LuGre friction."""
    return verify(scenario("lugre"), knee())


def row(found, metric):
    """The row of a requirement."""
    return next(one for one in found.rows if one.metric == metric)


@pytest.mark.parametrize(
    ("metric", "tolerance"),
    [
        ("bandwidth", 0.02),
        ("gain_margin", 0.03),
        ("ultimate_gain", 0.03),
        ("phase_margin", 0.02),
        ("dynamic_stiffness", 0.01),
        ("dynamic_phase", 0.02),
        ("natural_frequency", 0.01),
        ("damping_ratio", 0.02),
    ],
)
def test_both_tiers_agree_in_the_linear_limit(metric, tolerance):
    """Without friction, with small swings about a centred spool, time tells what the tier does.

    They are two independent sets of equations of one design.
    """
    found = row(small(), metric)
    assert found.value == pytest.approx(found.linear, rel=tolerance)
    assert found.difference == pytest.approx(found.value / found.linear - 1)
    assert found.why.startswith("both agree")


def test_the_phase_margin_of_a_resonance_is_seen():
    """With more gain the open loop passes one at its resonance too, and that crossover is found."""
    found = row(small(1200), "phase_margin")
    assert found.linear < 1.0
    assert found.value == pytest.approx(found.linear, rel=0.02)
    assert float(found.how.split(": ")[1].split(" Hz")[0]) > 100


def published(**valve):
    """The cylinder of the check list: 32/18-160, both chambers at 70 bar, x 80 mm, B 400."""
    area_a = pi * 0.032**2 / 4
    full, leak = 40 / 60000 / sqrt(35 * BAR), 0.45 / 60000 / sqrt(50 * BAR)
    own = plant(knee())
    no_seals = SealData(Plane(0.0), Plane(0.0), 1e-3, 0.0, 1e-4)
    oil = replace(own.oil, bulk_modulus=1.4e9, slope=0.0, air_content=1e-9)
    spool = {"signal": 10.0, "natural_frequency": 250.0, "damping_ratio": 0.7} | valve
    cylinder = replace(
        own,
        area_a=area_a,
        area_b=area_a - pi * 0.018**2 / 4,
        stroke=0.16,
        dead_a=8e-6,
        dead_b=8e-6,
        walls=Give(),
        flexibility=0.0,
        mass=30.0,
        leakage=0.0,
        oil=oil,
        supply_pressure=140 * BAR,
        return_pressure=0.0,
        valve=ValveData(full, leak, leak, **spool),
        oil_damping=400.0,
        seals=no_seals,
    )
    return Stand(
        cylinder, scenario(), 0.08, 70 * BAR, 70 * BAR,
        gain=150.0, steady_gain=100.0, bandwidth=3.0, scale=0.02,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("spool", "gain", "period"), [(250, 416.743, 7.7584), (400, 333.220, 7.6671)]
)
def test_the_loop_swings_from_the_check_value_on(spool, gain, period):
    """Raised until a push lasts: K_u of the check list, in V/m."""
    stand = published(natural_frequency=float(spool))
    found = experiments.ultimate_gain(stand, 0.8 * gain, 1e3 / period)
    assert found.values["ultimate_gain"] == pytest.approx(gain, rel=0.01)


@pytest.mark.parametrize(
    ("frequency", "stiffness", "phase"), [(10.0, 20.5399e6, 0.070), (40.0, 18.7636e6, 0.307)]
)
def test_closed_ports_have_the_stiffness_of_the_check_list(frequency, stiffness, phase):
    """Magnitude in N/m, phase in degrees."""
    found = experiments.dynamic_stiffness(published(), "closed", frequency, 132.0).values
    assert found["dynamic_stiffness"] == pytest.approx(stiffness, rel=1e-3)
    assert np.degrees(found["dynamic_phase"]) == pytest.approx(phase, rel=0.03)


@pytest.mark.parametrize(("ends", "ratio"), [("closed", 0.008034), ("valve", 0.008034 + 0.017064)])
def test_a_decay_has_frequency_and_damping_of_the_check_list(ends, ratio):
    """132.071 Hz; the centred valve adds 0.017064 to the damping ratio of the friction."""
    found = experiments.decay(published(), ends, 130.0).values
    assert found["natural_frequency"] == pytest.approx(132.071, rel=1e-3)
    assert found["damping_ratio"] == pytest.approx(ratio, rel=0.01)


@pytest.mark.long
def test_sticking_friction_raises_the_ultimate_gain():
    """Bristles hold the piston: the loop takes more gain, and the reason tells the swing seen."""
    found = row(sticking(), "ultimate_gain")
    assert found.shares["friction"] > 0.5
    assert found.value > 1.5 * found.linear
    assert "the seals" in found.why
    assert "push of" in found.how


def test_the_bristles_of_sticking_seals_are_a_spring_beside_the_oil():
    """Far below breakaway the seals add F_S/z_max to the stiffness of the closed chambers."""
    subject = knee(cases=balanced)
    own = plant(subject)
    stand = Stand(own, scenario("lugre"), 0.055, MIDDLE, MIDDLE, scale=0.01)
    held = [
        experiments.dynamic_stiffness(one, "closed", 2.0, 110.0).values for one in
        (stand, stand.frictionless())
    ]  # fmt: skip
    with_seals, without = (
        one["dynamic_stiffness"] * np.exp(1j * one["dynamic_phase"]) for one in held
    )
    plane = own.seals.static
    breakaway = plane.constant + (plane.rod_side + plane.higher) * MIDDLE
    assert (with_seals - without).real == pytest.approx(breakaway / 1e-4, rel=0.02)


@pytest.mark.long
def test_shares_make_up_the_difference():
    """Friction, amplitude and operating point together lead from one tier to the other."""
    told = [one for one in sticking().rows if one.shares]
    assert {"bandwidth", "gain_margin", "dynamic_stiffness"} <= {one.metric for one in told}
    for one in told:
        together = prod(1 + share for share in one.shares.values())
        assert together == pytest.approx(one.value / one.linear, rel=0.03)


@pytest.mark.long
def test_the_linear_tier_stands_where_the_valve_holds_the_load():
    """Under load the spool rests open, and what it feeds damps: both tiers have it, to 2 %."""
    found = sticking()
    assert "the spool rests -0.4" in row(found, "gain_margin").why
    told = [one.shares.get("operating point", 0.0) for one in found.rows]
    assert max(map(abs, told)) < 0.02


def test_what_only_friction_holds_is_told():
    """A stiffness between that of sliding and that of sticking seals: it holds, with a warning."""
    limit = {"dynamic_stiffness": Limit(min=11.5e6)}
    (found,) = verify(scenario("lugre", requirements={}), knee(requirements=limit)).rows
    assert found.met
    assert "met only because of seal friction; without it, the value is 10" in found.why


def test_every_dynamic_requirement_and_the_scenario_have_a_row():
    """Requirements of the scenario come from its own run, and a miss there counts."""
    found = sticking()
    assert [one.metric for one in found.rows if one.origin == "design"] == list(LIMITS)
    assert set(LIMITS) == set(DYNAMIC)
    rise = row(found, "rise_time")
    assert rise.value == found.simulation.values["rise_time"]
    assert (rise.origin, rise.linear) == ("scenario", None)
    assert not rise.met
    assert not found.met
    assert found.runs > len(found.rows)


def test_without_a_valve_there_is_no_loop_to_test():
    """No value, the reason, and not met."""
    design = knee().design.model_copy(update={"valve": None, "control": None})
    ports = design.ports.model_copy(update={"end": "closed"})
    limits = {name: LIMITS[name] for name in ("bandwidth", "natural_frequency")}
    design = design.model_copy(update={"ports": ports, "requirements": limits})
    force = {"force": [{"shape": "step", "start": 0.1, "value": 100.0}]}
    found = verify(scenario("none", control=None, requirements={}, load=force), prepare(design))
    loop, held = row(found, "bandwidth"), row(found, "natural_frequency")
    assert (loop.value, loop.met) == (None, False)
    assert "no valve" in loop.why
    assert held.value == pytest.approx(held.linear, rel=0.02)
    assert held.met


def test_verification_reads_as_tables():
    """Terminal in its width and in ASCII, report tables and JSON without NaN."""
    found = sticking()
    for width in (60, 100, 160):
        plain = terminal.blocks_text(pages.blocks(found), colour=False, unicode=False, width=width)
        assert plain.isascii()
        assert max(map(len, plain.splitlines())) <= width
    held = sum(one.met for one in found.rows)
    assert f"{held} of {len(found.rows)} requirements are met in the time simulation" in plain
    tables = pages.tables(found)
    assert len(tables[0].rows) == len(found.rows)
    for table in tables:
        assert table.columns
    json.dumps(found.to_dict(), allow_nan=False)


@cache
def followed():
    """A slow proportional loop without friction, at equal pressures.

    The step opens the valve by less than its centred edges are: leakage holds the pressures.
    """
    changes = {"control.gain": "30 V/m", "valve.leakage_flow": "1 l/min"}
    step = {"shape": "step", "start": 0.1, "value": 2e-3}
    held = {"shape": "constant", "value": MIDDLE * pi * 0.013**2 / 4}
    what = scenario(
        duration=5.0,
        control={"position": [step]},
        load={"force": [held]},
        initial={"pressure_a": MIDDLE, "pressure_b": MIDDLE},
        requirements={},
    )
    names = [
        "control.gain", "valve.rated_flow", "valve.rated_drop", "load.mass",
        "control.position[0].value", "fluid.temperature", "load.inertia",
    ]  # fmt: skip
    return sensitivities(what, knee(changes=changes), names, results=["rise_time"])


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        ("control.gain", -1.0),
        ("valve.rated_flow", -OPENED),
        ("valve.rated_drop", 0.5 * OPENED),
        ("load.mass", 0.0),
        ("control.position[0].value", 0.0),
    ],
)
def test_rise_time_of_a_slow_loop_goes_with_one_over_its_velocity_gain(path, expected):
    """t_r = ln 9/(K K_v), K_v as the opening K_10 - K_0; mass and step do not count."""
    one = next(one for one in followed().parameters if one.path == path)
    effect = one.effects["rise_time"]
    assert effect.percent == pytest.approx(expected, abs=0.03)
    assert effect.reliable
    unit = 0.01 * followed().results["rise_time"]
    assert effect.change == pytest.approx(effect.percent * unit, rel=1e-9)


def test_parameters_are_ranked_and_what_cannot_be_moved_is_told():
    """The most effective first; a zero has no share; a temperature goes by kelvin."""
    found = followed()
    largest = [one.largest for one in found.parameters]
    assert largest == sorted(largest, reverse=True)
    assert found.parameters[0].path in ("control.gain", "valve.rated_flow")
    assert "load.inertia" in found.skipped
    units = {one.path: one.unit for one in found.parameters}
    assert (units["fluid.temperature"], units["load.mass"]) == ("1 K", "1 %")
    json.dumps(found.to_dict(), allow_nan=False)


def test_a_jump_of_the_result_is_marked(monkeypatch):
    """A result that jumps changes as much over half the step: twice the slope, not reliable."""

    def jumps(scenario, plant, records, tuned):
        value = 1.0 if plant.mass > 20.2 else 0.5
        return SimpleNamespace(values={"rise_time": 3.0 + plant.mass, "settling_time": value})

    monkeypatch.setattr(sensitivity, "run", jumps)
    (mass,) = sensitivities(scenario(), knee(), ["load.mass"]).parameters
    assert mass.effects["rise_time"].reliable
    assert not mass.effects["settling_time"].reliable
    assert mass.largest == abs(mass.effects["rise_time"].percent)


@pytest.mark.parametrize(
    ("overshoot", "reliable", "runs"),
    [
        (lambda more: 0.1 if more > 0.2 else 0.0, False, 5),
        (lambda more: 0.01 * more, True, 5),
        (lambda more: 1e-7 * more, True, 3),
        (lambda more: 0.0, True, 3),
    ],
)
def test_a_zero_result_that_moves_is_compared_too(monkeypatch, overshoot, reliable, runs):
    """No share of nothing: its change itself must agree over half the step; rounding need not."""
    mass = plant(knee()).mass

    def zero(scenario, plant, records, tuned):
        return SimpleNamespace(values={"overshoot": overshoot(plant.mass - mass)})

    monkeypatch.setattr(sensitivity, "run", zero)
    found = sensitivities(scenario(), knee(), ["load.mass"])
    effect = found.parameters[0].effects["overshoot"]
    assert effect.percent is None
    assert (effect.reliable, found.runs) == (reliable, runs)


def test_what_is_left_out_of_the_experiments_is_named():
    """All that a scenario states at the load, and nothing else."""
    drive = {"position": [{"shape": "constant", "value": 0.0}], "stiffness": 1e5}
    rig = {
        "bore": 0.04, "rod_diameter": 0.02, "stroke": 0.25, "supply_pressure": 1e7,
        "valve": {"rated_flow": 2.5e-4, "natural_frequency": 100.0},
    }  # fmt: skip
    part = [{"shape": "constant", "value": 5.0}]
    full = {"force": part, "torque": part, "stiffness": 1.0, "damping": 1.0, "drive": drive}
    words = ("force of the load", "torque on the joint", "spring", "damper", "external machine",
             "load cylinder")  # fmt: skip
    for (name, value), word in zip((full | {"cylinder": rig}).items(), words, strict=True):
        assert _left_out(ScenarioLoad.model_validate({name: value})) == word
    assert _left_out(ScenarioLoad.model_validate(full)) == ", ".join(words[:-1])
    nothing = ScenarioLoad.model_validate({"force": [{"shape": "constant", "value": 0.0}]})
    assert _left_out(nothing) == ""


def test_numbers_of_the_scenario_are_moved_by_default():
    """What the scenario states is among the parameters, its times and limits are not."""
    force = {"force": [{"shape": "constant", "value": 500.0}]}
    what = scenario(load=force, duration=0.15)
    paths = [one.path for one in sensitivity._Bench.of(what, knee(), {}).targets(None)]
    assert {"load.force[0].value", "control.position[0].value", "load.mass"} <= set(paths)
    assert not [path for path in paths if path.startswith(("requirements", "duration"))]
    assert "control.position[0].start" not in paths


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"names": ["valve.rated_flw"]}, "valve.rated_flow"),
        ({"names": ["fluid.material"]}, "text"),
        ({"names": ["control.law"]}, "number"),
        ({"results": ["rise_tim"]}, "rise_time"),
        ({"step": 0.0}, "0.02"),
    ],
)
def test_what_is_asked_wrongly_is_said_in_one_line(arguments, words):
    """Unknown PATH, text, unknown result, no step: what and the remedy."""
    with pytest.raises(InputError) as caught:
        sensitivities(scenario(duration=0.15), knee(), **arguments)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_sensitivities_read_as_a_table():
    """Terminal in its width and in ASCII; every parameter has a row, each left out its reason."""
    found = followed()
    for width in (50, 100):
        plain = terminal.blocks_text(
            pages.sensitivity_blocks(found), colour=False, unicode=False, width=width
        )
        assert plain.isascii()
        assert max(map(len, plain.splitlines())) <= width
    table, left_out = pages.sensitivity_blocks(found)
    assert len(table.rows) == len(found.parameters)
    assert len(left_out.items) == len(found.skipped)
