"""A measured record over a simulation, and what it tells of named parameters.

The records are those of the oracle, written apart from the package, with noise of 0.1 % of the
supply pressure and a position in steps of 10 um, as a bench records them.
"""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
import servo_oracle as oracle
import servo_oracle_parts as parts
from simulation_case import AREA_A, AREA_B, BAR, FULL, LEAK, OIL, VALVE as FAST, plant, scenario

from actuator_opt.base.errors import InputError
from actuator_opt.simulation.linear import tune
from actuator_opt.simulation.measured.fit import fit
from actuator_opt.simulation.measured.parameters import PARAMETERS, entries
from actuator_opt.simulation.measured.record import (
    AlignedRecord,
    SimulatedSignal,
    noise,
    overlay,
    parse_measured,
)
from actuator_opt.simulation.run import run
from actuator_opt.studies.plant import Plane, SealData

VALVE = replace(FAST, natural_frequency=80.0)
TRUE = {
    "air_content": 0.01, "bulk_modulus": 1.4e9, "valve_capacity": 0.8, "valve_leakage": 1.0,
    "valve_offset": 0.0, "piston_leakage": 2e-13, "coulomb": 150.0, "static": 200.0,
    "stribeck_speed": 0.01, "viscous": 400.0, "bristle_travel": 1e-5, "mass": 30.0,
    "dead_volume_a": 8e-6, "dead_volume_b": 8e-6, "load_offset": 0.0,
}  # fmt: skip
"""The cylinder of the records: its valve gives 32 l/min, where the data sheet says 40."""
STAIR = [(0.02, 1.5), (0.15, -2.0), (0.24, 0.0), (0.31, 0.6), (0.4, -0.4)]
"""Signal of the valve [V] from each time on."""
DURATION = 0.5
MIDDLE = {"position": 0.08, "pressure_a": 70 * BAR, "pressure_b": 70 * BAR}
LOAD = 1500.0
PRESSURE_NOISE, GRAIN = 1e-3 * 140 * BAR, 10e-6
KNOWN = ("air_content", "piston_leakage", "coulomb")
ASKED = ("air_content", "valve_capacity", "piston_leakage", "coulomb")


def circuit(**changes):
    """The oracle's circuit, open loop, with values by the names of the fit."""
    v = TRUE | changes
    leak = v["valve_leakage"] * LEAK
    stair = [(0.0, -v["valve_offset"])] + [(t, u - v["valve_offset"]) for t, u in STAIR]
    valve = parts.Valve(
        v["valve_capacity"] * FULL, (leak,) * 4, 2 * np.pi * VALVE.natural_frequency
    )
    rubbing = parts.LuGre(
        v["static"], v["coulomb"], v["stribeck_speed"], v["static"] / v["bristle_travel"]
    )
    cylinder = parts.Cylinder(
        AREA_A, AREA_B, 0.16, v["dead_volume_a"], v["dead_volume_b"], v["mass"],
        leakage=v["piston_leakage"], viscous=v["viscous"], friction=rubbing,
    )  # fmt: skip
    return oracle.Circuit(
        parts.Oil(v["bulk_modulus"], air=v["air_content"]), valve, cylinder,
        parts.ConstantSupply(140 * BAR), parts.steps(*stair),
        parts.steps((0.0, LOAD + v["load_offset"])),
    )  # fmt: skip


@cache
def measured_signals(step=1e-3, **changes):
    """What the oracle gives, by the simulation's names: time and signals."""
    time = step * np.arange(round(DURATION / step) + 1)
    start = {"position": 0.08, "p_a": 70 * BAR, "p_b": 70 * BAR}
    start["spool"] = -(TRUE | changes)["valve_offset"]
    found = oracle.simulate(circuit(**changes), time, start, rtol=1e-8, method="LSODA").signals
    names = {"position": "position", "speed": "velocity", "pressure_a": "p_a", "pressure_b": "p_b"}
    return time, {name: found[own] for name, own in names.items()}


def bench(seed, **changes):
    """A record as a bench writes it."""
    rng = np.random.default_rng(seed)
    time, signals = measured_signals(**changes)
    zero = rng.uniform()  # where the steps of the position lie
    channels = {"position": GRAIN * (np.round(signals["position"] / GRAIN + zero) - zero)}
    for name in ("pressure_a", "pressure_b"):
        channels[name] = signals[name] + PRESSURE_NOISE * rng.standard_normal(time.size)
    return AlignedRecord({name: (time, values) for name, values in channels.items()})


def case(**changes):
    """Scenario and plant with values by the names of the fit, each at its own place."""
    v = TRUE | changes
    steps = [{"shape": "step", "start": STAIR[0][0], "value": STAIR[0][1]}]
    steps += [
        {"shape": "step", "start": t, "value": u - before}
        for (_, before), (t, u) in pairwise(STAIR)
    ]
    rubbing = {
        "coulomb": v["coulomb"], "static": v["static"], "stribeck_speed": v["stribeck_speed"],
        "viscous": v["viscous"], "bristle_travel": v["bristle_travel"], "bristle_damping": 1e-6,
    }  # fmt: skip
    scene = scenario(
        duration=DURATION, sample_time=1e-3, initial=MIDDLE, friction=rubbing, signal=steps,
        load={"force": [{"shape": "constant", "value": LOAD}]},
    )  # fmt: skip
    own = plant(
        oil=replace(OIL, bulk_modulus=v["bulk_modulus"], air_content=v["air_content"]),
        valve=replace(VALVE, rated=v["valve_capacity"] * FULL),
        leakage=v["piston_leakage"], mass=v["mass"], oil_damping=0.0,
    )  # fmt: skip
    return scene, own


GUESS = {"air_content": 0.005, "valve_capacity": 1.0, "piston_leakage": 1e-13, "coulomb": 100.0}
"""What the design says of the cylinder of the records."""


# What a record is


def test_channels_are_read_with_their_units():
    """Names of a bench and of the simulation's own table mean the same signals, in SI."""
    text = (
        "t [ms],p1 [bar],pressure_b [MPa],x [mm],U [V],qA [l/min],speed [rpm],phi [deg],note\n"
        + "".join(f"{k},{70 + k},7,80,1.5,6,60,180,9\n" for k in range(12))
    )
    found = parse_measured(text, name="bench.csv")
    time, pressure = found.channels["pressure_a"]
    assert time == pytest.approx(1e-3 * np.arange(12))
    assert pressure == pytest.approx((70 + np.arange(12)) * BAR)
    values = {name: one[1][0] for name, one in found.channels.items()}
    assert values == {
        "pressure_a": pytest.approx(70 * BAR), "pressure_b": pytest.approx(70 * BAR),
        "position": pytest.approx(0.08), "signal": 1.5, "flow_a": pytest.approx(1e-4),
        "shaft_speed": pytest.approx(2 * np.pi), "shaft_angle": pytest.approx(np.pi),
    }  # fmt: skip
    unknown, still = found.notes
    assert unknown.startswith(
        'columns ignored, as they are not channels: "note"; channels are p1, p2, x'
    )
    assert still == (
        "pressure_b, position, signal, flow_a, shaft_speed, shaft_angle: constant throughout the "
        "record"
    )


def test_missing_samples_are_left_out_channel_by_channel():
    """A gap of one channel takes nothing from the others; a channel of gaps is told."""
    lines = [f"{k},{'' if 3 <= k < 6 else 70},{80 if k < 4 else 'nan'}" for k in range(20)]
    found = parse_measured("t [s],p1 [bar],x [mm]\n" + "\n".join(lines))
    assert found.channels["pressure_a"][0].tolist() == [0, 1, 2, *range(6, 20)]
    assert list(found.channels) == ["pressure_a"]
    assert found.notes[:2] == (
        "position: 4 samples, but at least 10 are needed, so it is left out",
        "pressure_a: 3 samples are missing from 3 to 5 s, left out",
    )


def test_what_is_missing_is_told_with_its_place():
    """Cells that are no number and lines that an even clock leaves out, counted by hand."""
    values = ["80"] * 40
    values[5], values[20], values[21] = "inf", "", "-"
    lines = [f"{0.001 * k:.3f},{70 + k},{one}" for k, one in enumerate(values)]
    del lines[30:33]
    found = parse_measured("t [s],p1 [bar],x [mm]\n" + "\n".join(lines))
    assert found.channels["position"][0].size == 34
    assert found.notes == (
        "pressure_a: 3 samples are missing from 0.03 to 0.032 s, left out",
        "position: 6 samples are missing in 3 places, first at 0.005 s, last from 0.03 to 0.032 s, "
        "left out",
        "position: constant throughout the record",
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("t [s],T [degC]\n0,20\n1,20\n", "no channel matches a simulated signal"),
        ("t [s],x [bar]\n0,1\n1,2\n", 'column "x"'),
        ("t [s],x [mm]\n0,1\n2,2\n1,3\n", "time does not increase at 1 s"),
        ("t [s],x [mm]\n0,1\n,2\n1,3\n", "missing time"),
        ("x [mm]\n1\n", "no column t"),
    ],
)
def test_bad_records_are_told_in_one_line(text, message):
    """What cannot be read says what, where and what to do."""
    with pytest.raises(InputError) as told:
        parse_measured(text, name="bench.csv")
    fault = told.value.diagnostics[0]
    assert fault.message.startswith(message)
    assert fault.file == "bench.csv"
    assert fault.remedy


@pytest.mark.parametrize("grain", [0.0, 4e-3])
def test_noise_is_seen_through_motion_and_jumps(grain):
    """The estimate is the scatter of a sample, whatever smooth course and jumps lie under it."""
    rng = np.random.default_rng(3)
    time = np.linspace(0, 2, 2001)
    course = np.sin(9 * time) + (time > 0.7)
    measured = course + 2e-3 * rng.standard_normal(time.size)
    if grain:
        measured = grain * np.round(measured / grain)
    assert noise(measured) == pytest.approx(np.hypot(2e-3, grain / np.sqrt(12)), rel=0.15)
    assert noise(np.full(50, 3.0)) == 0


# A record over a simulation


def test_overlay_leaves_the_noise_of_the_sensors():
    """Over a simulation of the same numbers the record is left with its own noise."""
    scene, own = case()
    found = overlay(run(scene, own, {}, None), bench(1))
    left = found.residuals
    assert left["pressure_a"].rms == pytest.approx(PRESSURE_NOISE, rel=0.1)
    assert left["position"].rms == pytest.approx(GRAIN / np.sqrt(12), rel=0.1)
    assert abs(left["pressure_b"].bias) < 4 * PRESSURE_NOISE / np.sqrt(501)
    assert left["position"].relative == left["position"].rms / left["position"].span
    assert not found.notes
    assert json.loads(json.dumps(found.to_dict()))["residuals"]["position"]["unit"] == "m"


def test_residuals_are_what_was_added():
    """An offset is the bias, a spike the largest, with its time; a late record is its lag late."""
    scene, own = case()
    made = run(scene, own, {}, None)
    time, signals = measured_signals()
    values = signals["position"] + 2e-3
    values[300] += 5e-3
    moved = AlignedRecord({"position": (time + 0.05, values)})
    left = overlay(made, moved, lag=0.05).residuals["position"]
    assert left.count == time.size
    assert left.bias == pytest.approx(2e-3 + 5e-3 / time.size, rel=1e-4)
    assert (left.largest, left.time) == (pytest.approx(7e-3, rel=1e-4), pytest.approx(0.35))
    late = overlay(made, moved).residuals["position"]
    assert late.count == time.size - 50
    assert late.rms > 1e-3


def test_overlay_says_where_record_and_scenario_do_not_meet():
    """Another start, a coarse simulation and signals that are not simulated are told."""
    scene, own = case()
    scene = scene.model_copy(update={"sample_time": 0.01})
    time, signals = measured_signals()
    record = AlignedRecord({
        "position": (time, signals["position"] + 0.01),
        "pressure_a": (time, signals["pressure_a"]),
        "shaft_speed": (time, signals["speed"]),
        "pressure_b": (time + 5, signals["pressure_b"]),
    })  # fmt: skip
    notes = overlay(run(scene, own, {}, None), record).notes
    assert any("position starts at 90 mm in the record, but at 80 mm" in one for one in notes)
    assert any("state a shorter sample_time" in one for one in notes)
    assert "measured, but not simulated: shaft_speed" in notes
    assert "measured only outside the simulated time: pressure_b" in notes


def test_overlay_refuses_what_has_nothing_in_common():
    """No time or no signal in common is a fault of the record."""
    scene, own = case()
    made = run(scene, own, {}, None)
    late = AlignedRecord({name: (t + 9.0, y) for name, (t, y) in bench(1).channels.items()})
    with pytest.raises(InputError, match=r"covers 9 to 9\.5 s, the scenario 0 to 0\.5 s"):
        overlay(made, late)
    time, signals = measured_signals()
    with pytest.raises(InputError, match="none of the record's channels is simulated"):
        overlay(made, AlignedRecord({"shaft_speed": (time, signals["speed"])}))


def test_a_sample_on_a_jump_may_show_either_side():
    """A signal that jumps at a sample is no misfit, before it or after it."""
    scene, own = case()
    time, _ = measured_signals()
    stair = np.zeros(time.size)
    for start, value in STAIR:
        stair[time > start + 1e-9] = value
    left = overlay(run(scene, own, {}, None), AlignedRecord({"signal": (time, stair)})).residuals
    assert left["signal"].largest == 0


def test_a_course_is_cubic_and_crosses_no_jump():
    """Parabolas on both sides of a jump are met, uneven samples or not; a sine within h^4."""
    left, right = np.array([0.0, 0.1, 0.3, 0.4, 0.5]), np.array([0.5, 0.52, 0.7, 1.0])
    time = np.concatenate([left, right])
    course = SimulatedSignal(time, np.concatenate([left**2, 3 - right + right**2]))
    asked = np.linspace(-0.1, 1.0, 200)
    exact = np.where(asked < 0.5, np.maximum(asked, 0) ** 2, 3 - asked + asked**2)
    assert course(asked) == pytest.approx(exact, abs=1e-12)
    worst = []
    for count in (51, 101):
        time = np.linspace(0, 1, count)
        apart = SimulatedSignal(time, np.sin(9 * time))(asked[20:]) - np.sin(9 * asked[20:])
        worst.append(np.abs(apart).max())
    assert worst[1] < worst[0] / 6
    assert worst[1] < 1e-4


# Where parameters enter


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("air_content", 0.002), ("bulk_modulus", 1.1e9), ("valve_capacity", 1.1),
        ("valve_leakage", 3.0), ("valve_offset", 0.2), ("piston_leakage", 1e-12),
        ("coulomb", 60.0), ("static", 320.0), ("stribeck_speed", 0.05), ("viscous", 900.0),
        ("bristle_travel", 4e-5), ("mass", 55.0), ("dead_volume_a", 2e-5),
        ("dead_volume_b", 3e-5), ("load_offset", -700.0),
    ],
)  # fmt: skip
def test_parameters_enter_where_the_oracle_has_them(name, value):
    """A value put in gives the run that the oracle gives with the same value, and another one."""
    scene, own = case(valve_capacity=1.0 if name == "valve_capacity" else 0.8)
    entry = entries([name], scene, own)[0]
    made = run(*entry.put(scene, own, value), {}, None)
    plain = measured_signals()[1]
    time, signals = measured_signals(**{name: value})
    for signal, exact in signals.items():
        simulated = np.interp(time, made.time, made.signals[signal])
        size = float(np.ptp(exact))
        assert np.abs(simulated - exact).max() < 1e-4 * size
    assert np.abs(signals["pressure_a"] - plain["pressure_a"]).max() > 0.1 * BAR


def test_every_parameter_is_compared_with_the_oracle():
    """The list of the test above is the table of the fit."""
    assert set(TRUE) == set(PARAMETERS)


def test_friction_over_the_pressures_keeps_its_shape():
    """The design's friction scales with its level at the start; breakaway with Coulomb friction."""
    scene, own = case()
    scene = scene.model_copy(update={"friction": scene.friction.model_validate({})})
    level = Plane(40.0, 1e-5, 2e-5, 1e-5)
    at_start = 40.0 + (2e-5 + 1e-5) * 70 * BAR
    rises = Plane(80.0, 2e-5, 4e-5, 2e-5)
    own = replace(own, seals=SealData(level, rises, 5e-3, 0.0, 1e-4))
    coulomb, static = entries(["coulomb", "static"], scene, own)
    assert (coulomb.start, static.start) == pytest.approx((at_start, 2 * at_start))
    seals = coulomb.put(scene, own, 3 * at_start)[1].seals
    for plane, first in ((seals.coulomb, level), (seals.static, rises)):
        assert [plane.constant, plane.difference, plane.rod_side, plane.higher] == pytest.approx(
            [3 * first.constant, 3 * first.difference, 3 * first.rod_side, 3 * first.higher]
        )


@pytest.mark.parametrize(
    ("names", "message"),
    [
        ((), "no parameter to fit"),
        (("air",), '"air" is not a parameter'),
        (("mass", "mass"), "mass is named twice"),
        (("bristle_travel",), "bristle_travel has no effect: friction.model is stribeck"),
    ],
)
def test_names_that_cannot_be_fitted_are_told(names, message):
    """A name that is none, twice there or without effect is a fault with its remedy."""
    scene, own = case()
    rubbing = scene.friction.model_copy(update={"model": "stribeck"})
    scene = scene.model_copy(update={"friction": rubbing})
    with pytest.raises(InputError) as told:
        fit(scene, own, {}, bench(1), names)
    assert told.value.diagnostics[0].message.startswith(message)
    assert told.value.diagnostics[0].remedy


def test_parameters_without_effect_are_told():
    """A valve that is not there, one whose ports are held and one that leaks nothing."""
    scene, own = case()
    held = scenario(held_ports={"pressure_a": 35 * BAR, "pressure_b": 35 * BAR})
    tight = replace(own, valve=replace(VALVE, leakage_supply=0.0, leakage_tank=0.0))
    even = case(static=TRUE["coulomb"])[0]
    assert entries(["stribeck_speed", "static"], even, own)
    for name, there, body, why in (
        ("stribeck_speed", even, own, "static and Coulomb friction are equal; also fit static"),
        ("valve_offset", scene, replace(own, valve=None), "the design has no valve"),
        ("mass", held, own, "the ports of the valve are blocked"),
        ("valve_leakage", scene, tight, "design's valve, which is zero"),
    ):
        with pytest.raises(InputError, match=why):
            entries([name], there, body)


# What a record tells


@pytest.mark.long
def test_a_fit_finds_the_cylinder_of_the_record():
    """From the design's numbers: 32 l/min in place of 40, twice the air, leakage and friction."""
    found = fit(*case(**GUESS), {}, bench(1), ASKED)
    for name, one in found.parameters.items():
        parameter = one.parameter
        assert parameter.value == pytest.approx(TRUE[name], rel=0.05)
        half = parameter.upper - parameter.value
        assert abs(parameter.value - TRUE[name]) < 2 * half
        assert parameter.verdict == "identifiable"
    before, after = found.before.residuals, found.after.residuals
    assert after["pressure_a"].rms == pytest.approx(PRESSURE_NOISE, rel=0.1)
    assert after["position"].rms == pytest.approx(GRAIN / np.sqrt(12), rel=0.1)
    assert before["position"].rms > 100 * after["position"].rms
    assert not found.missed
    assert not found.doubts
    told = json.loads(json.dumps(found.to_dict()))
    assert told["parameters"]["piston_leakage"]["unit"] == "m^3/(s*Pa)"
    assert len(told["correlations"]) == 6


@pytest.mark.long
def test_bounds_hold_the_truth_as_often_as_they_say():
    """Of 9 bounds of 95 % at least 7 hold; by chance fewer would once in 120 times."""
    held = []
    for seed in range(3):
        found = fit(*case(), {}, bench(100 + seed), KNOWN)
        held += [
            one.parameter.lower <= TRUE[name] <= one.parameter.upper
            for name, one in found.parameters.items()
        ]
    assert sum(held) >= 7


@pytest.mark.long
def test_late_uneven_records_with_gaps_are_fitted():
    """Channels of other rates that begin late, with a gap, on a clock 40 ms behind."""
    time, signals = measured_signals(step=5e-4)
    rng = np.random.default_rng(5)
    channels = {}
    for name, every, first in (("position", 6, 31), ("pressure_a", 4, 5), ("pressure_b", 3, 101)):
        t, y = time[first::every], signals[name][first::every]
        kept = (t < 0.2) | (t > 0.23)
        scatter = 3e-6 if name == "position" else PRESSURE_NOISE
        channels[name] = t[kept] + 0.04, (y + scatter * rng.standard_normal(y.size))[kept]
    names = ("air_content", "valve_capacity")
    guess = {name: GUESS[name] for name in names}
    found = fit(*case(**guess), {}, AlignedRecord(channels), ("lag", *names))
    lag = found.parameters["lag"].parameter
    assert lag.value == pytest.approx(0.04, abs=1e-4)
    assert lag.identifiable
    for name in names:
        assert found.values[name] == pytest.approx(TRUE[name], rel=0.06)


def test_what_nothing_moves_is_not_identifiable():
    """With the valve centred nothing tells its capacity; its leakage is known."""
    scene, own = case()
    scene = scene.model_copy(update={"signal": ()})
    made = run(scene, own, {}, None)
    rng = np.random.default_rng(2)
    record = AlignedRecord({
        name: (made.time, made.signals[name] + PRESSURE_NOISE * rng.standard_normal(501))
        for name in ("pressure_a", "pressure_b")
    })  # fmt: skip
    found = fit(scene, own, {}, record, ("valve_capacity", "valve_leakage"))
    alone = fit(scene, own, {}, record, ("valve_capacity",)).parameters["valve_capacity"].parameter
    capacity = found.parameters["valve_capacity"].parameter
    assert alone.verdict == capacity.verdict
    assert capacity.verdict == "not identifiable"
    assert found.to_dict()["parameters"]["valve_capacity"]["upper"] is None
    assert found.parameters["valve_leakage"].parameter.identifiable
    assert any(one.startswith("valve_capacity is not identifiable") for one in found.doubts)


def test_a_channel_that_stands_still_is_left_out():
    """A sensor that shows one value weighs nothing and is told."""
    whole = bench(7).channels
    time, values = whole["position"]
    record = AlignedRecord(
        {"pressure_a": whole["pressure_a"], "position": (time, 0 * values + 0.08)}
    )
    found = fit(*case(air_content=0.005), {}, record, ("air_content",))
    assert found.values["air_content"] == pytest.approx(0.01, rel=0.05)
    assert "position is constant in the record and was not used in the fit" in found.doubts


@pytest.mark.long
def test_a_leakage_that_is_not_there_is_bounded_from_zero():
    """A tight piston: no leakage is among the values allowed, and what it is at most."""
    found = fit(*case(), {}, bench(3, piston_leakage=0.0), ("piston_leakage",))
    one = found.parameters["piston_leakage"].parameter
    assert one.lower == 0
    assert one.upper < 0.05 * TRUE["piston_leakage"]
    assert one.verdict == "not identifiable"
    assert any("piston_leakage" in doubt for doubt in found.doubts)


def test_a_model_that_lacks_something_says_so():
    """With a spool slower than it was the fit tells that the model misses the record."""
    scene, own = case(air_content=0.005)
    own = replace(own, valve=replace(own.valve, natural_frequency=55.0))
    found = fit(scene, own, {}, bench(4), ("air_content",))
    assert "position" in found.missed
    assert any(
        "differs from the record by more than the sensor noise" in one for one in found.doubts
    )


@pytest.mark.long
def test_pairs_that_hide_in_each_other_are_named():
    """At one speed, one way, friction is a load: the record tells their sum."""
    whole = bench(6).channels
    part = {name: (t[80:150], y[80:150]) for name, (t, y) in whole.items()}
    found = fit(*case(), {}, AlignedRecord(part), ("coulomb", "load_offset"))
    assert found.correlations["coulomb", "load_offset"] < -0.9
    assert found.parameters["coulomb"].parameter.verdict == "not identifiable"
    assert any(
        one.startswith("correlated errors: coulomb with load_offset") for one in found.doubts
    )


def test_a_loop_keeps_its_gains_while_its_cylinder_changes():
    """In a closed loop the stated gain holds; mass and load are found from the simulated record."""
    scene, own = case()
    step = {"shape": "step", "start": 0.05, "value": 0.01}
    control = scenario(control={"position": [step], "position_gain": 100.0}).control
    scene = scene.model_copy(update={"signal": (), "control": control})
    made = run(scene, replace(own, mass=45.0), {}, tune(scene, own, {}))
    rng = np.random.default_rng(8)
    scatter = {"position": 3e-6, "pressure_a": PRESSURE_NOISE}
    record = AlignedRecord({
        name: (made.time, made.signals[name] + size * rng.standard_normal(made.time.size))
        for name, size in scatter.items()
    })  # fmt: skip
    found = fit(scene, own, {}, record, ("mass", "load_offset"))
    assert found.values["mass"] == pytest.approx(45.0, rel=0.02)
    assert found.values["load_offset"] == pytest.approx(0.0, abs=5.0)
    assert found.parameters["load_offset"].parameter.identifiable
