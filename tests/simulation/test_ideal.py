"""A cylinder stated by its numbers: held against an integration of the equations alone."""

from __future__ import annotations

import numpy as np
import pytest
from cli_runner import run
from scipy.integrate import solve_ivp

import actuator_opt as ao

DESIGN = """\
name: one mass on a cylinder
ideal: {area_a: 12.5 cm^2, area_b: 8 cm^2, stroke: 400 mm, mass: 60 kg,
  dead_volume_a: 40 ml, dead_volume_b: 30 ml}
supply: {pressure: 140 bar, return_pressure: 2 bar}
fluid: {material: iso_vg_32, air_content: 0 %, bulk_modulus_law: constant}
valve: {rated_flow: 20 l/min, rated_drop: 35 bar, natural_frequency: 80 Hz, damping_ratio: 0.8}
"""
SCENARIO = """\
name: a step and a pulse of force
design: ideal.yaml
duration: 0.6 s
sample_time: 1 ms
initial: {position: 150 mm}
friction: {model: none, viscous: 6 kN*s/m}
load: {force: [{shape: constant, value: 1 kN}, {shape: step, value: 1 kN, start: 0.4 s}]}
control: {tuning: stated, position_gain: 120 V/m,
  position: [{shape: step, value: 40 mm, start: 20 ms}]}
"""
AREA_A, AREA_B, STROKE, MASS, DAMPING = 12.5e-4, 8e-4, 0.4, 60.0, 6e3
K, SIGNAL = 20 / 60000 / np.sqrt(35e5), 10.0


@pytest.fixture
def files(tmp_path):
    """Design and scenario in a folder."""
    (tmp_path / "ideal.yaml").write_text(DESIGN)
    (tmp_path / "step.yaml").write_text(SCENARIO)
    return tmp_path


def integrated(modulus, start, times):
    """Position and pressures by scipy: two chambers, four sharp edges, a second-order spool."""
    natural, damping = 2 * np.pi * 80.0, 0.8

    def flow(opening, drop):
        return K * max(opening, 0.0) / SIGNAL * np.sign(drop) * np.sqrt(abs(drop))

    def rates(time, state):
        x, v, a, b, o, rate = state
        error = 0.15 + (0.04 if time >= 0.02 else 0.0) - x
        command = np.clip(120.0 * error, -SIGNAL, SIGNAL)
        into_a = flow(o, 140e5 - a) - flow(-o, a - 2e5)
        into_b = flow(-o, 140e5 - b) - flow(o, b - 2e5)
        load = 1e3 + (1e3 if time >= 0.4 else 0.0)
        return [
            v,
            (a * AREA_A - b * AREA_B - DAMPING * v - load) / MASS,
            modulus / (40e-6 + AREA_A * x) * (into_a - AREA_A * v),
            modulus / (30e-6 + AREA_B * (STROKE - x)) * (into_b + AREA_B * v),
            rate,
            natural * (natural * (command - o) - 2 * damping * rate),
        ]

    states, state = [], [0.15, 0.0, *start, 0.0, 0.0]
    for begin, end in ((0.0, 0.02), (0.02, 0.4), (0.4, 0.6)):
        at = times[(times >= begin) & ((times < end) | (end == 0.6))]
        found = solve_ivp(
            rates, (begin, end), state, "Radau", dense_output=True,
            rtol=1e-8, atol=[1e-11, 1e-10, 1.0, 1.0, 1e-8, 1e-5],
        )  # fmt: skip
        states.append(found.sol(at))
        state = found.y[:, -1]
    return np.concatenate(states, axis=1)


def test_a_one_mass_servo_is_that_of_its_equations(files):
    """Position within 0.1 % of its range, pressures within 0.5 % of supply, in fifteen lines."""
    assert len(DESIGN.splitlines()) + len(SCENARIO.splitlines()) < 20
    trial = ao.read_scenario(files / "step.yaml")
    found = ao.simulate(trial)
    oil = found.plant.oil
    assert oil.slope == 0.0
    signals = found.signals
    first = [signals[f"pressure_{side}"][0] for side in "ab"]
    x, _, a, b, _, _ = integrated(oil.bulk_modulus, first, found.time)
    assert np.ptp(x) > 0.03
    np.testing.assert_allclose(signals["position"], x, atol=1e-3 * np.ptp(x))
    np.testing.assert_allclose(signals["pressure_a"], a, atol=5e-3 * 140e5)
    np.testing.assert_allclose(signals["pressure_b"], b, atol=5e-3 * 140e5)


def test_only_the_stated_numbers_count(files):
    """Masses add up; stiffness and leakage are those of the file; notes name what it leaves out."""
    plain = ao.simulate(files / "step.yaml")
    assert plain.plant.mass == 60.0
    assert "a rigid rod, no leakage across the piston" in plain.notes[0]
    assert plain.plant.flexibility == 0.0
    heavier = ao.simulate(files / "step.yaml", set={"load.mass": "40 kg"})
    assert heavier.plant.mass == 100.0
    soft = ao.simulate(files / "step.yaml", set={"ideal.stiffness": "10 kN/mm"})
    assert soft.plant.flexibility == pytest.approx(1e-7)
    assert "rigid rod" not in soft.notes[0]
    leak = {"ideal.leakage": "1 ml/s/bar", "control.tuning": "stated"}
    assert ao.simulate(files / "step.yaml", set=leak).plant.leakage == pytest.approx(1e-11)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("area_b: 8 cm^2", "area_b: 0 cm^2"), "ideal.area_b"),
        (("stroke: 400 mm, ", ""), "ideal.stroke: missing"),
        (("valve:", "cylinder: {bore: 40 mm, stroke: 1 m}\nvalve:"), "ideal states the cylinder"),
        (("valve:", "linkage: {base_radius: 0.3 m, crank_radius: 0.3 m}\nvalve:"), "closed_length"),
        (("mass: 60 kg", "mass: 60 kg, closed_length: 1 m"), "no effect without linkage"),
        (("valve:", "requirements: {mass: {max: 1 kg}}\nvalve:"), "remove it, or remove ideal"),
    ],
)
def test_faults_are_single_lines(files, change, words):
    """Where, what, what to do."""
    (files / "ideal.yaml").write_text(DESIGN.replace(*change))
    result = run("check", files / "ideal.yaml")
    assert result.code == 3
    assert words in result.err
    assert "Traceback" not in result.err


@pytest.mark.parametrize(
    "words", [("evaluate",), ("compare", "{}"), ("seal", "--seal", "rod"), ("uncertainty",)]
)
def test_what_needs_parts_is_refused(files, words):
    """No result of the parts that complete the file is ever shown."""
    name = files / "ideal.yaml"
    command, *others = (str(name) if word == "{}" else word for word in words)
    result = run(command, name, *others)
    assert result.code == 3
    assert "use simulate" in result.err
    assert result.out == ""
