"""Integration: the same motion with and without the machine, and long sections between checks."""

from __future__ import annotations

import math

import numpy as np
import pytest
import simulation_case as case

from actuator_opt.base.symbolic import Namespace, program as programs
from actuator_opt.models.loop import ControllerGains
from actuator_opt.simulation.integrate import integrate
from actuator_opt.simulation.run import COMPARED
from actuator_opt.simulation.system import System


@pytest.mark.skipif(not programs.AVAILABLE, reason="the machine was not built")
def test_a_servo_without_the_machine_moves_alike(monkeypatch):
    """LuGre friction in a position loop that runs into its end: signals, events and energy."""
    scene = case.scenario(
        duration=0.4,
        initial=case.MIDDLE,
        friction={"model": "lugre", "coulomb": 80.0, "static": 120.0, "stribeck_speed": 5e-3},
        load={"force": case.BALANCED},
        control={"position": [{"shape": "step", "start": 0.05, "value": 0.1}]},
    )
    gains = ControllerGains(300.0, math.inf, 0.0)
    runs = []
    for available in (True, False):
        monkeypatch.setattr(programs, "AVAILABLE", available)
        runs.append(case.run(scene, case.plant(), gains, relative=1e-9, sharp=10.0))
    own, other = runs
    assert [event.name for event in own.found.events] == [
        event.name for event in other.found.events
    ]
    assert len(own.found.events) >= 1
    ends = [[event.time for event in one.found.events] for one in runs]
    assert ends[0] == pytest.approx(ends[1], abs=1e-6)
    for name in set(COMPARED) & set(own.signals):
        first, second = (np.interp(scene_time(), r.time, r.signals[name]) for r in runs)
        assert np.abs(first - second).max() < 1e-5 * np.ptp(second), name
    assert own.lost_energy() < 1e-5 * own.turnover()


def scene_time():
    """Times away from the jumps."""
    return np.linspace(0.0, 0.4, 397)


@pytest.mark.parametrize("method", ["lsoda", "radau"])
@pytest.mark.parametrize("late", [0.3305, 2.9005, 9.9991])
def test_a_late_change_within_a_long_section_is_found(method, late):
    """A decay x' = -x whose rate triples once the time is late: closed form, and the event."""
    system = System()
    x = system.state("x", 1.0, tolerance=1e-10)
    fast = system.switch("fast", system.time - late)
    system.rate(x, Namespace.where(fast, -3.0, -1.0) * x)
    found = integrate(
        system.compiled(), duration=10.0, sample_time=2e-3, method=method, relative=1e-8
    )
    (event,) = found.events
    assert (event.name, event.on) == ("fast", True)
    assert event.time == pytest.approx(late, abs=1e-8)
    t = found.time
    after = np.clip(t - late, 0.0, None)
    assert found.states[0] == pytest.approx(np.exp(-(t + 2 * after)), abs=2e-7)
    assert np.count_nonzero(np.diff(t) == 0) == 1
    assert len(t) in (5002, 5003)
