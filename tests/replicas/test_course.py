"""The course over time: shipped scenarios against closed forms and a second simulator."""

from __future__ import annotations

import math
import re
import shlex
from dataclasses import replace
from functools import cache
from pathlib import Path

import course_case as case
import numpy as np
import pytest
import servo_oracle as oracle
from course_case import AREA_A, AREA_B, BAR, LITRE, RPM, SUPPLY
from servo_oracle_parts import Controller, steps

from actuator_opt.api.simulations import Trial, read_scenario, simulate
from actuator_opt.evaluation.springs import Give
from actuator_opt.models.loop import ControllerGains
from actuator_opt.simulation import Simulation
from actuator_opt.simulation.assemble import assemble
from actuator_opt.simulation.linear import Linear, tune, ultimate
from actuator_opt.simulation.run import run
from actuator_opt.studies.plant import Plant, plant

SCENARIOS = Path(__file__).parents[2] / "designs" / "scenarios"
ALL = sorted(path.stem for path in SCENARIOS.glob("course_*.yaml"))
BEFORE, PULSE, AFTER = 2.9, 4.1, 5.9
"""At rest, in the pulse, at rest again [s]."""
QUICK = {"method": "LSODA", "rtol": 1e-8}


@cache
def found(name: str, **values: str) -> Simulation:
    """A shipped scenario, simulated with values set; a double underscore is a dot."""
    own = {path.replace("__", "."): value for path, value in values.items()}
    return simulate(SCENARIOS / f"course_{name}.yaml", set=own, margins=True)


def at(one: Simulation, name: str, time: float) -> float:
    """A signal at a time."""
    return float(np.interp(time, one.time, one.signals[name]))


@cache
def trial(name: str) -> Trial:
    """A shipped scenario as read."""
    return read_scenario(SCENARIOS / f"course_{name}.yaml")


@cache
def bare(name: str) -> Plant:
    """The plant as the slides have it: no walls, no give, the moved mass alone."""
    own = plant(trial(name).actuator.subject())
    return replace(own, walls=Give(), flexibility=0.0, mass=case.MASS, oil_damping=0.0)


def with_gains(name: str, gains: ControllerGains, **control) -> Simulation:
    """A shipped scenario on the bare plant with stated gains."""
    one = trial(name)
    stated = one.scenario.control.model_copy(update=control | {"tuning": "ziegler_nichols"})
    scene = one.scenario.model_copy(update={"control": stated})
    tuned = replace(tune(scene, bare(name), {}), gains=gains)
    return run(scene, bare(name), {}, tuned)


# ---- every file ----


@pytest.mark.parametrize(
    "name",
    [pytest.param(x, marks=[pytest.mark.long] if x == "course_open_loop" else []) for x in ALL],
)
def test_a_scenario_of_the_course_adds_up(name) -> None:
    """Requirements met, mass and energy kept, a second integrator agrees."""
    one = simulate(SCENARIOS / f"{name}.yaml", verify=True)
    assert one.met, [row for row in one.requirements if not row.met]
    assert one.balance.mass < 1e-6
    assert one.balance.energy < 1e-6
    assert one.second is not None
    assert one.second.max_difference < 1e-3


def _variants() -> list[tuple[str, str]]:
    """Every variant that the head of a scenario names."""
    heads = {name: (SCENARIOS / f"{name}.yaml").read_text("utf-8") for name in ALL}
    return [
        (name, line)
        for name, text in heads.items()
        for line in re.findall(r"^#   (--set .*?)(?:   .*)?$", text, re.MULTILINE)
    ]


@pytest.mark.parametrize(("name", "line"), _variants())
def test_a_variant_named_in_a_scenario_runs(name, line) -> None:
    """What its head says to set can be set, and the balances still close."""
    words = shlex.split(line)
    assert words[::2] == ["--set"] * (len(words) // 2)
    one = simulate(SCENARIOS / f"{name}.yaml", set=dict(w.split("=", 1) for w in words[1::2]))
    assert max(one.balance.mass, one.balance.energy) < 1e-6


# ---- circuit 1: the cylinder without a loop ----


@pytest.mark.parametrize(
    ("rated", "speed", "p_a", "p_b"), [(40, -0.1843, 44.55, 77.61), (32, -0.1471, 44.70, 77.17)]
)
def test_the_pulse_runs_at_the_speed_of_three_equations(rated, speed, p_a, p_b) -> None:
    """-2 V: both flows and the balance of forces give speed and pressures, also for 32 l/min."""
    closed = case.steady(-2.0, -0.2, rated / 40 * case.FULL)
    assert closed[0] == pytest.approx(speed, abs=5e-5)
    assert closed[1:] == pytest.approx((p_a * BAR, p_b * BAR), abs=0.005 * BAR)
    one = found("open_loop", valve__rated_flow=f"{rated} l/min")
    # the design adds 4 N s/m of oil that is sheared in its gaps
    assert at(one, "speed", PULSE) == pytest.approx(closed[0], rel=1e-3)
    assert at(one, "pressure_a", PULSE) == pytest.approx(closed[1], rel=1e-3)
    assert at(one, "pressure_b", PULSE) == pytest.approx(closed[2], rel=1e-3)
    travel = at(one, "position", 4.117) - at(one, "position", 2.923)
    # whole time at that speed, less the lag of the spool and the start of 234 kg
    assert 0.98 < travel / (closed[0] * (4.117 - 2.923)) < 1


def test_the_pulse_is_the_second_simulators() -> None:
    """Position, speed and pressures of the whole test case equal an independent simulation."""
    stairs = steps((0.0, 0.0), (2.923, -2.0), (4.117, 0.0))
    begin = {"position": 0.3, "p_a": 4.0603e6, "p_b": 5.9397e6}
    times = np.linspace(2.9, 4.4, 1501)  # the samples of ours
    other = oracle.simulate(
        replace(case.CYLINDER, reference=stairs), np.concatenate(([0.0], times)), begin, **QUICK
    ).signals
    one = trial("open_loop")
    started = one.scenario.initial.model_copy(update={"pressure_a": begin["p_a"]})
    started = started.model_copy(update={"pressure_b": begin["p_b"]})
    scene = one.scenario.model_copy(update={"duration": 4.4, "initial": started})
    ours = run(scene, bare("open_loop"), {}, None)
    for name, theirs in (
        ("position", "position"), ("speed", "velocity"), ("pressure_a", "p_a"),
        ("pressure_b", "p_b"), ("friction", "friction"), ("flow_a", "q_a"),
    ):  # fmt: skip
        apart = np.interp(times, ours.time, ours.signals[name]) - other[theirs][1:]
        assert np.abs(apart).max() < 2e-4 * np.ptp(other[theirs][1:]), name


def test_the_piston_creeps_without_a_signal() -> None:
    """At 0 V the rod's area drives it out at the speed of three equations, 0.43 mm/s."""
    closed = case.steady(0.0, 4e-4)
    assert closed[0] == pytest.approx(0.43e-3, abs=0.005e-3)
    assert closed[1:] == pytest.approx((47.7 * BAR, 51.6 * BAR), abs=0.05 * BAR)
    one = found("open_loop")
    for time in (BEFORE, AFTER):
        assert at(one, "speed", time) == pytest.approx(closed[0], rel=5e-3)
        assert at(one, "pressure_a", time) == pytest.approx(closed[1], rel=1e-3)
        assert at(one, "pressure_b", time) == pytest.approx(closed[2], rel=1e-3)
    assert one.values["hold_drift"] == pytest.approx(closed[0], rel=5e-3)


@pytest.mark.parametrize(("into", "out", "rest"), [(50, 50, 50), (60, 40, 40)])
def test_blocked_chambers_rest_between_the_leakages(into, out, rest) -> None:
    """Held by friction, at 0 V, both chambers stand at the divider's pressure; 0.9 l/min pass."""
    one = found(
        "open_loop",
        friction__static="2 kN",
        friction__coulomb="2 kN",
        valve__leakage_drop=f"{into} bar",
        valve__tank_leakage_drop=f"{out} bar",
    )
    assert at(one, "pressure_a", BEFORE) == pytest.approx(rest * BAR, rel=1e-4)
    assert at(one, "pressure_b", BEFORE) == pytest.approx(rest * BAR, rel=1e-4)
    assert at(one, "flow_supply", BEFORE) == pytest.approx(0.9 * LITRE, rel=1e-4)


def test_split_leakage_nearly_stops_the_creep() -> None:
    """At 40 bar in both chambers the rod's area pushes with 1018 N, hardly above 1000 N."""
    push = 40 * BAR * (AREA_A - AREA_B)
    assert push == pytest.approx(1018, abs=0.5)
    closed = case.steady(0.0, 1e-4, case.FULL, case.leak(60), case.leak(40))
    assert 0 < closed[0] < 0.1e-3
    split = {"valve__leakage_drop": "60 bar", "valve__tank_leakage_drop": "40 bar"}
    one = found("open_loop", duration="25 s", **split)  # so slow a creep takes its time
    assert one.signals["pressure_a"][-1] == pytest.approx(closed[1], rel=1e-4)
    assert one.signals["speed"][-1] == pytest.approx(closed[0], rel=0.01)


def test_zero_adjustment_holds_the_piston() -> None:
    """-19.9 mV divides the pressures as the areas; friction allows from -3.9 to -39.7 mV."""
    assert case.holding_signal(0.0) == pytest.approx(-19.9e-3, abs=0.05e-3)
    least, most = (case.holding_signal(force) for force in (case.STATIC, -case.STATIC))
    assert (least, most) == (pytest.approx(-3.9e-3, abs=5e-5), pytest.approx(-39.7e-3, abs=5e-5))
    # the valve's offset is the signal that centres it: the other way
    one = found("open_loop", valve__offset=f"{-case.holding_signal(0.0)} V")
    assert abs(at(one, "speed", BEFORE)) < 1e-8
    assert at(one, "pressure_a", BEFORE) * AREA_A == pytest.approx(
        at(one, "pressure_b", BEFORE) * AREA_B, rel=1e-3
    )
    for volts, moves in ((0.8 * least, 1), (2 * least, 0), (0.9 * most, 0), (1.1 * most, -1)):
        speed = at(found("open_loop", valve__offset=f"{-volts} V"), "speed", BEFORE)
        assert (abs(speed) > 1e-5, np.sign(speed) * abs(moves)) == (bool(moves), moves), volts


# ---- the valve on its bench ----


def test_the_ramp_draws_the_valves_flows() -> None:
    """Over the spool: q_A = -q_B = 3.962 l/min per volt, supply and tank 0.753 l/min more."""
    one = found("valve_ramp")
    late = one.time > 0.1  # the spool starts at 0 V
    volts = one.signals["spool"][late]
    per_volt = (40 - 0.45 * math.sqrt(35 / 50)) / 10
    closed = 0.45 * math.sqrt(35 / 50)
    assert per_volt == pytest.approx(3.962, abs=5e-4)
    assert 2 * closed == pytest.approx(0.753, abs=5e-4)
    expected = {
        "flow_a": per_volt * volts,
        "flow_b": -per_volt * volts,
        "flow_supply": 2 * closed + per_volt * np.abs(volts),
        "flow_tank": 2 * closed + per_volt * np.abs(volts),
    }
    for name, litres in expected.items():
        assert one.signals[name][late] / LITRE == pytest.approx(litres, abs=1e-4), name
    lag = one.signals["signal"][-1] - one.signals["spool"][-1]
    assert lag == pytest.approx(2 * 0.7 / case.SPOOL, rel=1e-3)  # 2 zeta/w at 1 V/s, 3.7 mV
    ends = {name: expected[name][-1] + per_volt * lag for name in ("flow_a", "flow_supply")}
    assert ends["flow_a"] == pytest.approx(39.62, abs=5e-3)
    assert ends["flow_supply"] == pytest.approx(40.38, abs=5e-3)


def test_split_leakage_and_offset_shift_the_ramp() -> None:
    """At 0 V: 60/40 bar take 0.077 l/min out of A; an offset of 0.5 V shifts the ramp by it."""
    one = found("valve_ramp", valve__leakage_drop="60 bar", valve__tank_leakage_drop="40 bar")
    middle = int(np.argmin(np.abs(one.signals["spool"][20:]))) + 20
    assert abs(one.signals["spool"][middle]) < 0.006
    into, out = 0.45 * math.sqrt(35 / 60), 0.45 * math.sqrt(35 / 40)
    opened = 3.962 * one.signals["spool"][middle]
    assert one.signals["flow_a"][middle] / LITRE == pytest.approx(into - out + opened, abs=1e-3)
    one = found("valve_ramp", valve__offset="0.5 V")
    crossing = np.interp(0.0, one.signals["flow_a"][20:], one.signals["spool"][20:])
    assert crossing == pytest.approx(0.5, abs=1e-5)


# ---- circuit 2: position servo ----


@pytest.mark.parametrize("place", [0.1, 0.2, 0.3])
def test_ultimate_gain_of_the_position_loop(place) -> None:
    """At three places, to both sides: the gain at which the second simulator's poles turn."""
    scene, own = trial("position_servo").scenario, bare("position_servo")
    linear = Linear.of(assemble(scene, own, {}, None, linear=True))
    pressures = dict(zip(linear.names, linear.initial, strict=True))
    start = {"position": place, "p_a": pressures["pressure a"], "p_b": pressures["pressure b"]}
    smooth = replace(case.CYLINDER, actuator=replace(case.SLIDES, friction=None))
    for loop, side in zip(linear.about(position=place).loops, (1.0, -1.0), strict=True):
        there = oracle.about_rest(smooth, start, side)
        gain, period = oracle.ultimate_gain_by_swinging(smooth, there, side, gains=(10.0, 1e4))
        ours = ultimate(loop)
        assert ours.gain == pytest.approx(gain, rel=2e-5)
        assert ours.period == pytest.approx(period, rel=2e-5)
        rate = case.velocity_gain(start["p_a"], start["p_b"], side > 0)
        assert loop.steady_rate == pytest.approx(rate, rel=1e-3)


def test_zero_adjustment_leaves_the_ultimate_gain() -> None:
    """The spool is taken to both sides of where it is centred, not of 0 V."""
    before, after = (
        found("position_servo", valve__offset=volts).tuned.ultimate for volts in ("0 V", "0.5 V")
    )
    assert after.gain == pytest.approx(before.gain, rel=1e-6)
    assert after.period == pytest.approx(before.period, rel=1e-6)


def test_the_calm_pi_of_the_position_loop() -> None:
    """T_i = 4/(K K_v) with a third of the ultimate gain, K_v by three linear equations."""
    tuned = found("position_servo", control__law="pi").tuned
    one = found("position_servo")
    assert tuned.gains.proportional_gain == pytest.approx(tuned.ultimate.gain / 3)
    p_a, p_b = (float(one.signals[f"pressure_{side}"][0]) for side in "ab")
    rate = case.velocity_gain(p_a, p_b, extend=True)
    times = tuned.gains.integral_time * tuned.gains.proportional_gain
    assert times == pytest.approx(4 / rate, rel=2e-3)
    assert tuned.margins.gain == pytest.approx(3, rel=0.02)


def test_the_p_loop_stops_where_friction_takes_over() -> None:
    """It creeps out until the error gives -3.9 mV: 0.05 mm beyond the target at 82 V/m."""
    one = found("position_servo")
    gain = one.tuned.gains.proportional_gain
    assert one.servo.metrics.steady_state_error == pytest.approx(
        case.holding_signal(case.STATIC) / gain, rel=0.02
    )


@pytest.mark.parametrize(
    "factors",
    [
        {"gain_factor": 2.0},
        {"integral_factor": 0.5},
        {"derivative_factor": 2.0},
        {"gain_factor": 0.5, "integral_factor": 2.0, "derivative_factor": 0.5},
    ],
)
def test_a_factor_acts_on_its_own_part(factors) -> None:
    """Margins and response are those of the PID with K, K/T_i and K T_d multiplied singly."""
    zn = {"control__tuning": "ziegler_nichols", "control__law": "pid"}
    base = found("position_servo", **zn).tuned.gains
    by = found("position_servo", **zn, **{f"control__{k}": str(v) for k, v in factors.items()})
    k, i, d = (factors.get(f"{part}_factor", 1.0) for part in ("gain", "integral", "derivative"))
    stated = found(
        "position_servo",
        control__tuning="stated",
        control__law="pid",
        control__position_gain=f"{k * base.proportional_gain!r} V/m",
        control__integral_time=f"{k / i * base.integral_time!r} s",
        control__derivative_time=f"{d / k * base.derivative_time!r} s",
    )
    assert by.tuned.margins.gain == pytest.approx(stated.tuned.margins.gain, rel=1e-6)
    for name in ("position", "signal"):
        assert by.signals[name] == pytest.approx(stated.signals[name], abs=1e-4), name


@pytest.mark.parametrize(
    ("law", "gain", "integral_time", "derivative_time"),
    [("p", 96.0, math.inf, 0.0), ("pi", 86.0, 0.028, 0.0), ("pid", 115.0, 0.0168, 0.0042)],
)
def test_position_steps_are_the_second_simulators(law, gain, integral_time, derivative_time):
    """Overshoot, rise and the whole course of a step under P, PI and PID, friction included."""
    gains = ControllerGains(gain, integral_time, derivative_time)
    one = with_gains("position_servo", gains, law=law)
    other = _step(
        case.CYLINDER,
        Controller(gain, gain / integral_time, gain * derivative_time),
        (0.2, 0.05),
        {"position": 0.2, "p_a": one.signals["pressure_a"][0], "p_b": one.signals["pressure_b"][0]},
        1.6,
    )
    _same_step(one, other, "position", "position", (0.2, 0.05), 1.0)


def _step(circuit, controller, step, start, end):
    """The oracle's answer to a step at 1 s (the motor's: 2 s), every millisecond."""
    begin = 2.0 if circuit is case.TURNING else 1.0
    reference = steps((0.0, step[0]), (begin, step[0] + step[1]))
    looped = replace(circuit, controller=controller, reference=reference)
    return oracle.simulate(looped, np.linspace(0, end, round(1000 * end) + 1), start, **QUICK)


def _same_step(one, other, name, theirs, step, begin):
    """Overshoot within 0.2 % of the step, everything within 0.3 %.

    Ours rests its integral part over the last 0.1 % before the valve's limit, the other at once.
    """
    start, size = step
    value = other.signals[theirs]
    ours = np.interp(other.times, one.time, one.signals[name])
    assert np.abs(ours - value).max() < 0.003 * size
    after = other.times > begin
    overshoot = (value[after].max() - start) / size - 1
    assert one.servo.metrics.overshoot == pytest.approx(max(overshoot, 0.0), abs=0.002)


# ---- circuit 3: motor ----


def test_the_motor_at_a_steady_speed() -> None:
    """1000 rpm against 5 N m: pressures from the torque, 4.01 V from the flow."""
    closed = case.running(1000 * RPM)
    assert (closed.volts, closed.p_a / BAR, closed.p_b / BAR) == (
        pytest.approx(4.01, abs=5e-3), pytest.approx(66.1, abs=0.05), pytest.approx(33.9, abs=0.05)
    )  # fmt: skip
    one = found("motor_velocity")
    assert one.signals["signal"][-1] == pytest.approx(closed.volts, rel=2e-4)
    assert one.signals["pressure_a"][-1] == pytest.approx(closed.p_a, rel=2e-4)
    assert one.signals["pressure_b"][-1] == pytest.approx(closed.p_b, rel=2e-4)


def test_the_motor_begins_with_its_load_held() -> None:
    """The pressures of the start carry 5 N m and halve the supply."""
    one = found("motor_velocity")
    p_a, p_b = one.signals["pressure_a"][0], one.signals["pressure_b"][0]
    assert case.V_R * (p_a - p_b) == pytest.approx(case.LOAD, rel=1e-9)
    assert p_a + p_b == pytest.approx(SUPPLY, rel=1e-9)


def test_a_pump_of_the_motors_constants_delivers_what_it_does_not_lose() -> None:
    """It is V n - C_s V_r p/mu at the pressure that its relief valve holds, 1000 rpm."""
    lost = {"slip": case.SLIP, "coulomb": case.DRY, "viscous": case.DRAG, "constant_torque": 0.1}
    pump = {"displacement": 13.3e-6, "shaft_speed": 1000 * RPM} | lost
    relief = {"pressure": 90 * BAR, "rated_flow": 40 * LITRE}
    scene = trial("valve_ramp").scenario.model_copy(update={"signal": (), "duration": 2.0})
    scene = type(scene).model_validate(
        scene.model_dump()
        | {"supply": {"type": "fixed_pump", "volume": 1e-3, "pump": pump, "relief": relief}}
    )
    one = run(scene, bare("valve_ramp"), {}, None)
    pressure = one.signals["pressure_supply"][-1]
    assert 80 * BAR < pressure < 110 * BAR
    expected = 13.3e-6 * 1000 / 60 - case.SLIP * case.V_R / case.VISCOSITY * pressure
    assert one.signals["flow_pump"][-1] == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(
    ("rpm", "swings"), [(20, 59e-3), (100, 65e-3), (500, 99e-3), (1000, 147e-3)]
)
def test_ultimate_gain_of_the_speed_loop_grows_with_speed(rpm, swings) -> None:
    """By hand with friction; without it, as the linear loop is taken, ours is the same by hand."""
    speed = rpm * RPM
    with_friction, _ = case.motor_swings(speed)
    assert with_friction * RPM == pytest.approx(swings, rel=0.01)
    gain, period = case.motor_swings(speed, dry=0.0, constant=0.0)
    closed = case.running(speed, dry=0.0, constant=0.0)
    one = trial("motor_velocity")
    linear = Linear.of(assemble(one.scenario, bare("motor_velocity"), {}, None, linear=True))
    state = linear.initial.copy()
    for name, value in (
        ("shaft speed", speed), ("pressure a", closed.p_a), ("pressure b", closed.p_b),
        ("spool", closed.volts),
    ):  # fmt: skip
        state[linear.names.index(name)] = value
    ours = ultimate(linear.loop(state, closed.volts))
    assert ours.gain == pytest.approx(gain, rel=1e-3)  # of air: 0.01 %
    assert ours.period == pytest.approx(period, rel=1e-3)


def test_the_p_speed_loop_droops() -> None:
    """The error is what the valve needs: U(w) = K (w_ref - w), solved by hand."""
    from scipy.optimize import brentq

    gain, wanted = 0.2, 1000 * RPM
    one = found(
        "motor_velocity",
        control__law="p",
        control__tuning="stated",
        control__shaft_speed_gain=f"{gain}",
    )
    speed = float(brentq(lambda w: case.running(w).volts - gain * (wanted - w), 1.0, wanted))
    assert 0.8 < speed / wanted < 0.9
    assert one.signals["shaft_speed"][-1] == pytest.approx(speed, rel=1e-4)
    assert one.values["steady_state_ratio"] == pytest.approx(1 - speed / wanted, rel=1e-3)


@pytest.mark.parametrize(
    ("law", "gain", "integral_time", "derivative_time"),
    [("pi", 0.25, 0.019, 0.0), ("pid", 0.34, 0.0116, 0.0029)],
)
def test_speed_steps_are_the_second_simulators(law, gain, integral_time, derivative_time) -> None:
    """Overshoot and course of 1000 rpm from rest: the valve's limit and the held integral act."""
    gains = ControllerGains(gain, integral_time, derivative_time)
    one = with_gains("motor_velocity", gains, law=law)
    controller = Controller(gain, gain / integral_time, gain * derivative_time, of="velocity")
    start = {"p_a": one.signals["pressure_a"][0], "p_b": one.signals["pressure_b"][0]}
    other = _step(case.TURNING, controller, (0.0, 1000 * RPM), start, 2.6)
    _same_step(one, other, "shaft_speed", "velocity", (0.0, 1000 * RPM), 2.0)


def test_the_pi_of_the_shaft_angle_keeps_its_margin() -> None:
    """A calm PI keeps nine tenths of its margin of 3 and comes to rest, whatever the plant."""
    one = found("motor_position", control__law="pi")
    assert one.tuned.margins.gain >= 0.9 * 3
    assert one.values["settling_time"] is not None


def test_the_scenarios_notes_say_what_happens() -> None:
    """Overshoots, standing errors and pressures in the shipped notes are those of the runs."""
    said = " ".join(trial("position_servo").scenario.notes.split())
    rule = {"control__tuning": "ziegler_nichols"}
    for law, pattern in (("pi", r"overshoot by (\d+) and"), ("pid", r"and (\d+) % here")):
        overshoot = found("position_servo", control__law=law, **rule).values["overshoot"]
        assert 100 * overshoot == pytest.approx(float(re.search(pattern, said)[1]), abs=0.5)
    servo = found("position_servo").servo
    millimetres = float(re.search(r"ends ([\d.]+) mm beyond", said)[1])
    assert -1e3 * servo.metrics.steady_state_error == pytest.approx(millimetres, abs=0.006)
    said = " ".join(trial("motor_position").scenario.notes.split())
    short = float(re.search(r"ends (\d+) degrees short", said)[1])
    assert math.degrees(found("motor_position").servo.metrics.steady_state_error) == pytest.approx(
        short, abs=0.5
    )
    said = " ".join(trial("motor_velocity").scenario.notes.split())
    volts, high, low = map(
        float, re.search(r"take ([\d.]+) V and (\d+) and (\d+) bar", said).groups()
    )
    end = {name: values[-1] for name, values in found("motor_velocity").signals.items()}
    assert end["spool"] == pytest.approx(volts, abs=0.05)
    assert end["pressure_a"] / 1e5 == pytest.approx(high, abs=0.5)
    assert end["pressure_b"] / 1e5 == pytest.approx(low, abs=0.5)
