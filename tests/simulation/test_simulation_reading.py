"""Claims about what a run tells: starts, stability, creep, second opinions, reasons."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from simulation_case import plant, scenario

import actuator_opt as ao
from actuator_opt.simulation.assemble import assemble
from actuator_opt.simulation.linear import ControllerLaw, Linear, margins, tune, ultimate

DESIGNS = Path(__file__).parents[2] / "designs"
KNEE = f"name: a\ndesign: {DESIGNS / 'servo_knee.yaml'}\nduration: 0.2 s\n"


def load(part: str) -> str:
    """The knee under a part of a load."""
    return f"{KNEE}load:\n  force:\n    - {part}\n"


@pytest.mark.parametrize(
    "part",
    [
        "{shape: constant, value: 2 kN}",
        "{shape: step, value: 2 kN}",
        "{shape: sine, value: 2 kN, frequency: 5 Hz, phase: 90 deg}",
        "{shape: pulse, value: 2 kN, end: 0.1 s}",
        "{shape: record, file: pull.csv, column: F}",
    ],
)
def test_every_load_is_held_as_the_run_begins(part, tmp_path):
    """The pressures balance the load at time zero, whatever its shape; nothing flings the rod."""
    (tmp_path / "pull.csv").write_text("t [s],F [N]\n0,2000\n1,2000\n")
    file = tmp_path / "a.yaml"
    file.write_text(load(part))
    run = ao.simulate(file)
    assert run.signals["load_force"][0] == pytest.approx(2000)
    assert run.signals["pressure_force"][0] == pytest.approx(2000, abs=5)
    assert abs(run.signals["speed"][run.time < 2e-3]).max() < 5e-3


def test_a_loop_beyond_its_ultimate_gain_is_unstable():
    """Factors of the ultimate gain: 0.97 is stable with margin 1/0.97, 1.03 is not."""
    text = {"position": [{"shape": "step", "value": 0.01}]}
    scene = scenario(control=text, initial={"pressure_a": 7e6, "pressure_b": 7e6})
    linear = Linear.of(assemble(scene, plant(), {}, None, linear=True))
    loop = linear.about(position=0.08).loops[0]
    limit = ultimate(loop)
    for factor in (0.97, 1.03, 1.3):
        found = margins(loop, ControllerLaw(factor * limit.gain, np.inf, 0.0, 1e-3))
        assert found.stable is (factor < 1)
        assert found.gain == pytest.approx(1 / factor, rel=1e-6)


def test_a_fast_pump_does_not_hide_an_unstable_loop():
    """Poles far away say nothing of the slow ones."""
    pump = {
        "type": "controlled_pump", "volume": 1e-4, "flow": 1e-3, "gain": 1e-9,
        "time_constant": 1e-4,
    }  # fmt: skip
    text = {"position": [{"shape": "step", "value": 0.01}], "position_gain": 1.0,
            "tuning": "stated"}  # fmt: skip
    scene = scenario(control=text, supply=pump)
    calm = tune(scene, plant(), {}, with_margins=True)
    gain = 1.1 * calm.ultimate.gain
    wild = scene.model_copy(
        update={"control": scene.control.model_copy(update={"position_gain": gain})}
    )
    assert calm.margins.stable
    assert not tune(wild, plant(), {}, with_margins=True).margins.stable


@pytest.mark.parametrize(
    "moved",
    [
        "signal:\n  - {shape: constant, value: 0.5 V}\n",
        "control:\n  law: pi\n  speed:\n    - {shape: constant, value: 50 mm/s}\n",
        "control:\n  position:\n    - {shape: ramp, value: 5 mm, start: 0.1 s, end: 0.19 s}\n",
        "load:\n  force:\n    - {shape: step, value: 100 N, start: 0.19 s}\n",
    ],
)
def test_creep_is_told_only_where_nothing_asks_for_motion(moved):
    """A valve that is open, a speed or a ramp asked for, a load that jumps: no creep."""
    run = ao.simulate(KNEE + moved)
    assert run.values["hold_drift"] is None
    assert "still cause motion" in run.why["hold_drift"]


def test_the_second_opinion_is_another_method():
    """Whatever integrates first, something else checks it."""
    for method, other in (("lsoda", "radau"), ("radau", "lsoda")):
        second = ao.simulate(KNEE, method=method, verify=True)
        assert second.second.method == other


def test_a_stiffness_that_is_not_told_says_why():
    """Two tones and too few cycles have reasons of their own."""
    two = load("{shape: sine, value: 100 N, frequency: 30 Hz}\n    - "
               "{shape: sine, value: 100 N, frequency: 50 Hz}")  # fmt: skip
    assert "several frequencies" in ao.simulate(two).why["dynamic_stiffness"]
    few = load("{shape: sine, value: 100 N, frequency: 10 Hz}")
    assert "cycles" in ao.simulate(few).why["dynamic_stiffness"]
    assert "no sinusoidal" in ao.simulate(KNEE).why["dynamic_stiffness"]


def test_a_reference_beyond_the_stroke_is_said():
    """The run goes on to the stop, and a note says what was asked."""
    text = KNEE + "control:\n  position:\n    - {shape: step, value: 80 mm}\n"
    assert any("the stroke ends at 110 mm" in note for note in ao.simulate(text).notes)


def test_a_run_prints_as_a_table():
    """The name, the results with units, the requirements."""
    text = str(ao.simulate(DESIGNS / "scenarios" / "knee_step.yaml"))
    assert "rise_time" in text
    assert " ms" in text
    assert "met" in text
    assert len(text) < 2000


def test_oil_films_are_said_to_run_dry():
    """A seal on its film is simulated by its coefficient, and a note says so."""
    own = replace(plant(), films={"piston": False, "rod": True})
    from actuator_opt.simulation.run import run

    notes = run(scenario(duration=0.01), own, {}, None).notes
    assert any("oil film of the rod seal" in note for note in notes)


def test_two_steps_at_once_are_one():
    """10 and 5 mm at the same instant read as a step of 15 mm."""
    two = "control:\n  position:\n" + "".join(
        f"    - {{shape: step, value: {size} mm}}\n" for size in (10, 5)
    )
    one = "control:\n  position:\n    - {shape: step, value: 15 mm}\n"
    found = [ao.simulate(KNEE + text).servo for text in (two, one)]
    assert found[0].start == pytest.approx(found[1].start)
    assert found[0].metrics.rise_time == pytest.approx(found[1].metrics.rise_time, rel=1e-6)


def test_a_step_on_a_ramp_has_no_figures():
    """No target stands while the reference moves on."""
    text = (
        "control:\n  position:\n    - {shape: ramp, value: 9 mm, end: 0.2 s}\n"
        "    - {shape: step, value: 5 mm, start: 0.1 s}\n"
    )
    assert ao.simulate(KNEE + text).servo is None


def test_torn_oil_is_said():
    """A load that pulls a chamber to vacuum leaves a note."""
    text = (
        KNEE + "ends: closed\nload:\n  force:\n    - {shape: step, value: -30 kN, start: 0.01 s}\n"
    )
    assert any("cavitat" in note for note in ao.simulate(text).notes)
