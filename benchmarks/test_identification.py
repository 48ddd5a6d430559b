"""How long a long record takes; never gating. Run with `just bench`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import actuator_opt as ao
from actuator_opt.identification import Record, identify, parse_record, synthetic
from actuator_opt.studies.bench import bench

KNEE = Path(__file__).parent.parent / "designs" / "knee_bonded.yaml"
SPEEDS = (0.0005, 0.001, 0.002, 0.003, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2)
TRUTH = synthetic.Truth(
    coulomb=150.0,
    static=300.0,
    stribeck_speed=4e-3,
    exponent=2.0,
    viscous=200.0,
    bristle_stiffness=5e6,
    bristle_damping=1e3,
)
SECONDS = 600.0


@pytest.fixture(scope="module")
def long() -> tuple[Record, object]:
    """Ten minutes at 1 kHz with the noise of real sensors."""
    own = bench(ao.read(KNEE).subject())
    once = synthetic.plateaus(SPEEDS, travel=0.08, begin=0.015)
    repeats = int(np.ceil(SECONDS / once.time[-1]))
    course = synthetic.course(np.tile(once.velocity, repeats), begin=0.015, step=1e-3)
    rubbed = synthetic.friction_along(TRUTH, course, np.zeros_like(course.time))
    sensors = synthetic.Sensors(pressure_lag=4e-3, spikes=0.05)
    return synthetic.record(own, course, rubbed, mass=own.mass, sensors=sensors), own


def test_a_ten_minute_record(benchmark, long):
    """Budget 5 s: friction, Stribeck and LuGre of 600 000 samples."""
    record, own = long
    found = benchmark.pedantic(identify, (record, own), rounds=3)
    benchmark.extra_info["seconds of record"] = float(record.time[-1])
    assert found.stribeck.parameters["coulomb"].value == pytest.approx(150.0, rel=0.03)


def test_reading_a_ten_minute_record(benchmark, long):
    """The text of the same record, 30 MB."""
    record, _ = long
    table = np.stack([record.time, *record.channels.values()], axis=1)
    lines = ["t [s],p1 [Pa],p2 [Pa],x [m],F_L [N]"]
    lines += [",".join(f"{v:.6g}" for v in row) for row in table.tolist()]
    text = "\n".join(lines)
    benchmark.pedantic(parse_record, (text,), rounds=3)
