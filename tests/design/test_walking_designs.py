"""Shipped designs with duty cycles: their load cases, cycles and energies against closed forms."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import actuator_opt as ao

DESIGNS = Path(__file__).parents[2] / "designs"
STRIKE = (0.36, 0.44)
"""Doubtful samples around foot strike of the running cycle [s]; see the head of its file."""


@pytest.fixture(scope="module")
def knee():
    """The walking knee."""
    return ao.read(DESIGNS / "knee_walking.yaml")


@pytest.fixture(scope="module")
def study(knee):
    """Its duty cycles at the values of the file."""
    return {cycle.name: cycle for cycle in ao.evaluate(knee).duty.cycles}


def test_the_squat_follows_its_stated_model(knee):
    """Torque by virtual work of a mass on the hip, with differences in time of its height."""
    record = knee.design.duty.cycles[2].record
    step = 1e-4

    def flexion(time):
        turns = ((0.0, 1.2, 95, 5), (2.0, 3.4, 5, 95))
        for begin, end, first, last in turns:
            if begin <= time <= end:
                u = (time - begin) / (end - begin)
                return math.radians(first + (last - first) * u**3 * (10 - 15 * u + 6 * u * u))
        return math.radians(5 if time < 2 else 95)

    def height(time):
        return 2 * 0.40 * math.cos(flexion(time) / 2)

    mass = 60 * 0.878
    for time, angle, torque in zip(record.time, record.motion, record.load, strict=True):
        assert -angle == pytest.approx(flexion(time), abs=2e-6)
        if time in (0.0, 1.2, 2.0, 3.4, 4.0):
            continue  # the third derivative jumps
        rise = (height(time + step) - 2 * height(time) + height(time - step)) / step**2
        arm = 0.40 * math.sin(flexion(time) / 2)
        assert torque == pytest.approx(mass / 2 * (9.81 + rise) * arm, rel=1e-3, abs=1e-3)


def test_load_cases_hold_the_peaks_of_the_cycles(knee):
    """Torques of the load cases are the extremes of all cycles, away from foot strike."""
    cases = {case.name: case for case in knee.design.load_cases}
    walk, run, rise = knee.design.duty.cycles
    time, torque = run.record.time, run.torque_scale * run.record.load
    assert run.torque_scale == pytest.approx(60 / 70, rel=1e-3)
    assert cases["running stance"].joint_torque == pytest.approx(torque.max(), rel=0.01)
    assert cases["end of swing"].joint_torque == pytest.approx(-torque.min(), rel=0.01)
    assert cases["deep squat"].joint_torque == pytest.approx(rise.record.load.max(), rel=0.01)
    assert np.abs(walk.record.load).max() < cases["end of swing"].joint_torque
    for case, k in (("running stance", torque.argmax()), ("end of swing", torque.argmin())):
        assert not STRIKE[0] < time[k] < STRIKE[1]
        assert cases[case].angle == pytest.approx(run.record.motion[k], abs=math.radians(0.5))


def test_doubtful_samples_size_neither_bore_nor_valve(study):
    """Largest share of the supply and largest opening lie outside foot strike, by a third."""
    run = study["run"]
    doubtful = (run.time > STRIKE[0]) & (run.time < STRIKE[1])
    for name in ("share", "opening"):
        assert run.traces[name][doubtful].max() < 0.67 * run.traces[name].max()


@pytest.mark.parametrize("name", ["walk", "run", "rise"])
def test_energy_of_a_closed_cycle_needs_no_load(knee, study, name):
    """Supply energy without leakage = pressure times (A_A + A_B)/2 times way of the piston."""
    bore, rod = knee.design.cylinder.bore, knee.design.rod.outer_diameter
    areas = math.pi / 4 * (2 * bore**2 - rod**2)
    way = np.abs(np.diff(study[name].traces["position"])).sum()
    energies = study[name].energies
    assert energies["supply_energy"] - energies["leakage_energy"] == pytest.approx(
        knee.design.supply.pressure * areas / 2 * way, rel=1e-9
    )


def test_the_flight_control_actuator_meets_its_mission():
    """Reserve of force, safe life and temperature at the values of the file."""
    evaluation = ao.evaluate(DESIGNS / "flight_control.yaml")
    metrics = evaluation.metrics
    assert metrics["duty_supply_share"].value < 0.8
    assert metrics["duty_fatigue"].value < 0.3
    assert metrics["duty_temperature_margin"].value > 10
    assert metrics["system_mass"].value is None


def test_pressures_together_are_those_of_single_evaluations(knee):
    """Two designs at once, and one of them alone."""
    pressures = [140e5, 149e5]
    names = ("duty_supply_energy", "duty_supply_share", "duty_fatigue", "system_mass")
    many = ao.evaluate_many(knee, {"supply.pressure": pressures}, metrics=names)
    metrics = ao.evaluate(knee.changed({"supply.pressure": pressures[1]})).metrics
    for name in names:
        assert many[name][1] == pytest.approx(metrics[name].value, rel=1e-9), name


@pytest.mark.long
@pytest.mark.parametrize("name", ["knee_walking", "flight_control"])
def test_the_optimum_is_certain_and_meets_every_requirement(name):
    """Status, optimality conditions and checks of both designs."""
    optimum = ao.optimise(ao.read(DESIGNS / f"{name}.yaml"), starts=2, prices=False)
    assert optimum.status == "optimal"
    assert optimum.kkt is not None
    assert optimum.kkt.residual <= 1e-6
    assert optimum.evaluation.met
