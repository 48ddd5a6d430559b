"""Duty cycles as scenarios: signals, plant, faults, and energies beside the quasi-static ones."""

from __future__ import annotations

import json
from functools import cache
from math import pi
from pathlib import Path

import numpy as np
import pytest
from cli_runner import run
from duty_case import DESIGNS, GAIT, knee, text, wave
from scipy.interpolate import CubicSpline

import actuator_opt as ao
from actuator_opt.design.scenario.model import Scenario
from actuator_opt.pages.simulation import page
from actuator_opt.pages.simulation_figures import strips
from actuator_opt.rendering.blocks import Table
from actuator_opt.simulation import simulate
from actuator_opt.simulation.duty_cycle import AGREEMENT, plant_of, spool_lag, with_cycle
from actuator_opt.studies.plant import plant

AREA_A, AREA_B = pi / 4 * 0.023**2, pi / 4 * (0.023**2 - 0.013**2)


def scenario(duration: float, **stated) -> Scenario:
    """A scenario of the cycle."""
    return Scenario(name="walk", design="knee.yaml", cycle="walk", duration=duration, **stated)


@cache
def _walking() -> ao.Actuator:
    return knee()


def test_the_reference_is_the_position_of_the_linkage_in_every_period():
    """By the law of cosines from the file's angles; the force is the torque by the lever arm."""
    subject = knee(load__mass="0 kg").subject()
    period = subject.design.duty.record(subject.design.duty.cycles[0]).duration
    scene, records = with_cycle(scenario(2.5 * period), subject)
    time, x = records[str(GAIT), "position of walk"]
    assert time[-1] == pytest.approx(3 * period)
    assert np.all(np.diff(time) > 0)
    start = float(scene.initial.position)
    lines = [line for line in GAIT.read_text("utf-8").splitlines() if not line.startswith("#")]
    assert lines[0] == "time [s],joint_angle [deg],joint_torque [N*m]"
    rows = np.array([line.split(",") for line in lines[1:]], dtype=float)
    phi = np.radians(rows[:, 1] + 120)
    length = np.sqrt(0.25**2 + 0.062**2 - 2 * 0.25 * 0.062 * np.cos(phi))
    arm = 0.25 * 0.062 * np.sin(phi) / length
    force = records[str(GAIT), "force of walk"][1]
    for k in range(3):
        at = rows[:, 0] - rows[0, 0] + k * period
        assert np.interp(at, time, x) + start == pytest.approx(length - 0.192, abs=1e-9)
        assert np.interp(at, time, force) == pytest.approx(rows[:, 2] / arm, rel=1e-6, abs=1e-6)
    (part,) = scene.load.force
    assert (part.column, part.scale) == ("force of walk", 1.0)


def test_the_feed_forward_is_the_opening_of_the_quasi_static_model():
    """Its sign is that of the speed, ahead by the lag of the spool; a stated one is kept."""
    subject = _walking().subject()
    scene, records = with_cycle(scenario(1.1), subject)
    time, x = records[str(GAIT), "position of walk"]
    signal = records[str(GAIT), "valve signal of walk"][1]
    speed = np.gradient(x, time)
    lag = spool_lag(plant(subject).valve)
    assert lag == pytest.approx(2 * 0.7 / (2 * pi * 120))
    speed = np.interp(time + lag, time, speed, period=time[-1])
    moving = np.abs(speed) > 0.02
    assert np.array_equal(np.sign(signal[moving]), np.sign(speed[moving]))
    largest = ao.evaluate(_walking()).metrics["duty_opening"].value
    assert np.max(np.abs(signal)) == pytest.approx(10 * largest, rel=0.02)
    assert [part.column for part in scene.control.feed_forward] == ["valve signal of walk"]
    own = {"feed_forward": [{"shape": "constant", "value": 0.0}]}
    kept, _ = with_cycle(scenario(1.1, control=own), subject)
    assert [part.shape for part in kept.control.feed_forward] == ["constant"]


def test_the_load_moves_with_the_rod_but_its_inertia_counts_once():
    """The force of the cycle contains it along the reference: J theta''/h is subtracted there."""
    changes = {"load__mass": "0 kg", "load__inertia": "0.2 kg*m^2"}
    actuator = knee(stated="supply_pressure: 140 bar\n", **changes)
    subject = actuator.subject()
    moving = plant_of(scenario(1.1), plant(subject))
    assert moving.supply_pressure == 140e5
    assert moving.design.load.inertia == 0.2
    bare = knee(stated="supply_pressure: 140 bar\n", load__mass="0 kg")
    name = (str(GAIT), "force of walk")
    time, loaded = with_cycle(scenario(1.1), subject)[1][name]
    inertia = with_cycle(scenario(1.1), bare.subject())[1][name][1] - loaded
    lines = [line for line in GAIT.read_text("utf-8").splitlines() if not line.startswith("#")]
    rows = np.array([line.split(",") for line in lines[1:]], dtype=float)
    angle = CubicSpline(rows[:, 0], np.radians(rows[:, 1]), bc_type="periodic")
    at = rows[0, 0] + time
    phi = angle(at) + np.radians(120)
    length = np.sqrt(0.25**2 + 0.062**2 - 2 * 0.25 * 0.062 * np.cos(phi))
    expected = 0.2 * angle(at, 2) / (0.25 * 0.062 * np.sin(phi) / length)
    assert np.abs(expected).max() > 50
    assert inertia == pytest.approx(expected, abs=0.05 * np.abs(expected).max())


def test_an_inertia_beyond_the_force_of_the_cycle_is_reported():
    """20 mm at 2 Hz accelerate 1 t by 3.2 kN; the cycle has 500 N."""
    actuator = knee(wave(), load__mass="1000 kg")
    scene, records = with_cycle(scenario(0.5, sample_time=1e-3), actuator.subject())
    found = simulate(scene, actuator.subject(), records=records)
    assert found.cycle.inertia == pytest.approx(1000 * 0.020 * (4 * pi) ** 2, rel=0.01)
    assert any("its force does not contain" in note for note in found.cycle.notes)


def test_the_power_of_an_open_cycle_ends_with_its_last_force():
    """A stroke from 20 to 90 mm in 1 s whose load falls from 3000 N to 200 N."""
    time = np.linspace(0.0, 1.0, 81)
    x, force = 55 - 35 * np.cos(pi * time), 3000 - 2800 * time
    rows = [f"{t:.6f},{p:.6f},{f:.6f}" for t, p, f in zip(time, x, force, strict=True)]
    cycle = "\n".join(["time [s],position [mm],force [N]", *rows]) + "\n"
    actuator = knee(cycle, stated="closed: false\n", load__mass="1 kg")
    scene, records = with_cycle(scenario(1.0, sample_time=1e-3), actuator.subject())
    found = simulate(scene, actuator.subject(), records=records)
    rows = {row.name: row for row in found.cycle.rows}
    assert rows["duty_power_peak"].difference == pytest.approx(0.0, abs=0.05)
    assert rows["duty_work_out"].difference == pytest.approx(0.0, abs=AGREEMENT)


def test_a_sine_takes_the_energy_of_the_closed_form():
    """W = p (A_A + A_B) S/2 without leakage; both models agree on it, and on the work."""
    changed = {"valve__leakage_flow": "0 l/min", "piston__leakage_conductance": "0 ml/min/bar"}
    changed["variables__piston__leakage_conductance"] = None
    actuator = knee(wave(), **changed)
    scene, records = with_cycle(scenario(1.0, sample_time=1e-3), actuator.subject())
    found = simulate(scene, actuator.subject(), records=records)
    assert found.cycle is not None
    rows = {row.name: row for row in found.cycle.rows}
    energy = rows["duty_supply_energy"]
    closed = 210e5 * (AREA_A + AREA_B) * 4 * 0.020 / 2
    assert energy.quasi_static == pytest.approx(closed, rel=1e-6)
    assert energy.simulated == pytest.approx(closed, rel=AGREEMENT)
    assert rows["duty_work_out"].simulated == pytest.approx(500 * 2 * 0.020, rel=AGREEMENT)
    assert rows["duty_work_in"].simulated == pytest.approx(500 * 2 * 0.020, rel=AGREEMENT)
    assert (found.cycle.start, found.cycle.end) == (0.5, 1.0)
    assert abs(found.cycle.change) < 0.005
    assert found.cycle.position_error < 0.5e-3
    assert found.balance.energy < 1e-6
    assert "within 2 %" in found.cycle.sentence
    assert found.to_dict()["duty_cycle"]["results"]["duty_supply_energy"]["unit"] == "J"
    assert any("it is subtracted along the reference" in note for note in found.notes)
    assert (found.cycle.samples, found.cycle.stated) == (3041, 81)
    assert any("3041 samples of the splines" in note for note in found.cycle.notes)


@pytest.mark.long
def test_the_energy_of_a_walking_knee_agrees_within_2_percent():
    """The supply energy of the last of three periods, with the loop of the design."""
    period = 1.1
    scene, records = with_cycle(scenario(3 * period, sample_time=1e-3), _walking().subject())
    found = simulate(scene, _walking().subject(), records=records)
    assert found.tuned.origin == "control.gain of the design"
    assert abs(found.cycle.difference) < AGREEMENT
    assert found.cycle.position_error < 0.2e-3
    assert abs(found.cycle.change) < 1e-3
    rows = {row.name: row for row in found.cycle.rows}
    for name in ("duty_work_out", "duty_work_in", "duty_friction_energy", "duty_flow_peak"):
        assert abs(rows[name].difference) < 0.02, name


PEAKS = 0.05
"""Difference of peaks up to which both models agree; of pressures as a share of the supply's."""


@pytest.mark.long
@pytest.mark.parametrize(
    ("design", "cycle", "beyond"),
    [
        ("knee_walking", "walk", set()),
        ("knee_walking", "run", set()),
        ("knee_walking", "rise", {"pressure_min"}),  # where the valve leaks a third of the flow
        ("flight_control", "manoeuvre and gust", set()),
    ],
)
def test_the_simulation_of_a_shipped_cycle_agrees_or_is_warned_of(design, cycle, beyond):
    """Energy within 2 %; peaks within 5 %, or the quasi-static metric says that it is doubtful."""
    trial = ao.cycle_scenario(DESIGNS / f"{design}.yaml", cycle)
    found = ao.simulate(trial)
    assert abs(found.cycle.difference) < AGREEMENT
    metrics = ao.evaluate(trial.actuator).metrics
    supply = trial.actuator.design.supply.pressure
    apart = {}
    for row in found.cycle.rows:
        scale = supply if "pressure" in row.name else abs(row.quasi_static)
        apart[row.name] = abs(row.simulated - row.quasi_static) / scale
    peaks = ("flow_peak", "power_peak", "power_absorbed", "pressure_min", "pressure_max", "opening")
    assert {peak for peak in peaks if apart[f"duty_{peak}"] >= PEAKS} <= beyond
    assert not any(metrics[f"duty_{peak}"].in_range for peak in beyond)
    assert max(apart.values()) < 0.13


@pytest.mark.long
def test_the_feed_forward_of_a_lapped_spool_begins_at_its_overlap():
    """An edge with clearance and without lap opens from the centre on: no jump at a reversal."""
    subject = ao.read(DESIGNS / "knee_walking.yaml").subject()
    scene = Scenario(name="rise", design="knee.yaml", cycle="rise", duration=4.0)
    _, records = with_cycle(scene, subject)
    signal = next(x for (_, name), (_, x) in records.items() if name == "valve signal of rise")
    cycle = next(
        x for x in ao.evaluate(DESIGNS / "knee_walking.yaml").duty.cycles if x.name == "rise"
    )
    assert np.max(np.abs(signal)) == pytest.approx(10 * cycle.traces["opening"].max(), rel=5e-3)
    moving = np.abs(signal[signal != 0])
    assert moving.min() < 0.02


SCENE = """\
name: walking
design: knee.yaml
cycle: walk
duration: 2 s
"""


@pytest.fixture
def folder(tmp_path):
    """A folder with the design of a sine of 2 Hz."""
    (tmp_path / "knee.yaml").write_text(text(wave()), "utf-8")
    return tmp_path


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ("cycle: run", "the design has no duty cycle run; write one of walk"),
        ("duration: 0.4 s", "shorter than walk"),
        ("control: {position: [{shape: constant, value: 1 mm}]}", "position: without effect"),
        ("signal: [{shape: constant, value: 1 V}]", "signal: without effect"),
        ("load: {force: [{shape: constant, value: 1 N}]}", "force: without effect"),
        ("initial: {position: 50 %}", "position: without effect"),
        ("ends: closed", "needs the lines to end at the valve"),
        ("control: {law: p, tuning: stated}", "position_gain: missing"),
    ],
)
def test_a_scenario_of_a_cycle_states_nothing_that_the_cycle_states(folder, changed, words):
    """Faults name line and remedy."""
    key = changed.partition(":")[0]
    lines = [line for line in SCENE.splitlines() if not line.startswith(f"{key}:")]
    file = folder / "scene.yaml"
    file.write_text("\n".join([*lines, changed, ""]), "utf-8")
    with pytest.raises(ao.InputError) as error:
        ao.read_scenario(file)
    assert words in str(error.value)


def test_a_design_without_cycles_or_valve_is_refused(folder):
    """With what to add."""
    (folder / "scene.yaml").write_text(SCENE, "utf-8")
    for removed, words in (
        (("duty",), "add duty.cycles to the design"),
        (("valve", "ports.end"), "add valve to the design"),
    ):
        with pytest.raises(ao.InputError) as error:
            ao.read_scenario(
                folder / "scene.yaml", set=[(path, None) for path in (*removed, "control")]
            )
        assert words in str(error.value)


def test_a_supply_pressure_over_time_is_refused(folder):
    """The supply of a simulation is constant."""
    rows = [line for line in wave().splitlines() if line]
    cycle = "\n".join([f"{rows[0]},supply_pressure [bar]", *(f"{row},200" for row in rows[1:]), ""])
    (folder / "knee.yaml").write_text(text(cycle), "utf-8")
    (folder / "scene.yaml").write_text(SCENE, "utf-8")
    with pytest.raises(ao.InputError, match="states the supply pressure of every sample"):
        ao.read_scenario(folder / "scene.yaml")


def test_a_cycle_that_begins_outside_the_stroke_is_refused(folder):
    """As no piston can start there."""
    rows = wave().splitlines()
    shifted = [
        rows[0],
        *(f"{a},{float(b) + 60},{c}" for a, b, c in (r.split(",") for r in rows[1:])),
    ]
    (folder / "knee.yaml").write_text(text("\n".join([*shifted, ""])), "utf-8")
    with pytest.raises(ao.InputError, match="outside the stroke"):
        ao.simulate(ao.cycle_scenario(folder / "knee.yaml", "walk"))


def test_the_command_simulates_a_cycle_of_a_design(folder):
    """Three periods unless stated; the comparison is in JSON and on the terminal."""
    file = str(folder / "knee.yaml")
    found = run("simulate", file, "--cycle", "walk", "--periods", "1", "--json")
    assert found.code == 0
    duty = json.loads(found.out)["duty_cycle"]
    assert (duty["start"], duty["end"]) == (0.0, 0.5)
    assert abs(duty["results"]["duty_supply_energy"]["difference"]) < AGREEMENT
    assert duty["change_between_periods"] is None
    trial = ao.cycle_scenario(Path(file), "walk", set=[("duty.cycles[walk].time_scale", "2")])
    assert trial.scenario.duration == pytest.approx(3.0)
    assert trial.files[0] == folder / "knee.yaml"


def test_the_command_refuses_periods_without_a_cycle(folder):
    """And a cycle of the standard input."""
    (folder / "scene.yaml").write_text(SCENE, "utf-8")
    assert run("simulate", str(folder / "scene.yaml"), "--periods", "2").code != 0
    found = run("simulate", "-", "--cycle", "walk")
    assert found.code != 0
    assert "needs the file of its design" in found.err


def test_the_page_sets_both_models_side_by_side():
    """A table with the difference of every result, and the sentence among the notes."""
    actuator = knee(wave())
    scene, records = with_cycle(scenario(0.5, sample_time=1e-3), actuator.subject())
    found = simulate(scene, actuator.subject(), records=records)
    tables = [block for block in page(found).blocks if isinstance(block, Table)]
    (table,) = [block for block in tables if "both models" in block.title]
    assert len(table.rows) == len(found.cycle.rows)
    assert table.note.startswith("Position error")
    (strip,) = [
        x for x in strips(found, found.cycle.traces) if x.panel.title.startswith("Pressure")
    ]
    first, second = [curve for curve in strip.panel.curves if curve.words == "quasi-static"]
    assert np.asarray(first.xs)[[0, -1]] == pytest.approx([0.0, 0.5])
    known = ao.evaluate(actuator).duty.cycles[0].traces
    assert np.asarray(first.ys)[::38] == pytest.approx(known["pressure_a"] / 1e5)
    assert np.asarray(second.ys)[::38] == pytest.approx(known["pressure_b"] / 1e5)


def test_a_cycle_does_not_verify_dynamic_requirements(folder):
    """They depend on the mass of the load."""
    trial = ao.cycle_scenario(folder / "knee.yaml", "walk")
    with pytest.raises(ao.InputError, match="mass of the load"):
        ao.verify_dynamics(trial)


def test_the_equations_of_a_cycle_are_exported(folder):
    """As those of any scenario."""
    trial = ao.cycle_scenario(folder / "knee.yaml", "walk", periods=1)
    files = ao.export(trial.actuator, scenario=trial, formats=["c"], folder=folder)
    assert [file.path.suffix for file in files] == [".h", ".c"]
