"""Three servos held against their equations alone: symmetric, differential, robot arm."""

from __future__ import annotations

from math import acos, pi, sin, sqrt
from pathlib import Path

import numpy as np
from plain_servo import Arm, PlainServo

import actuator_opt as ao

K = 20 / 60000 / sqrt(35e5)
COMMON = {"edge": K, "modulus": 1.4e9}
BACK = 2e5
DESIGN = """\
name: one servo
ideal: {{{ideal}}}
supply: {{pressure: {supply}, return_pressure: 2 bar}}
fluid: {{material: iso_vg_32, air_content: 0 %, bulk_modulus_law: constant}}
valve: {{rated_flow: 20 l/min, rated_drop: 35 bar, natural_frequency: 80 Hz, damping_ratio: 0.8}}
materials:
  iso_vg_32: {{bulk_modulus: 1.4 GPa, bulk_modulus_slope: 0, bulk_modulus_decay: 0 1/K}}
"""
SCENARIO = """\
name: one motion
design: servo.yaml
duration: 1 s
sample_time: 1 ms
control: {{tuning: stated, position_gain: {gain} V/m, position: [{reference}]}}
initial: {{position: {place}, pressure_a: {a} bar, pressure_b: {b} bar}}
"""
SYMMETRIC = (
    "area_a: 10 cm^2, area_b: 10 cm^2, stroke: 300 mm, mass: 80 kg, dead_volume_a: 50 ml, "
    "dead_volume_b: 50 ml"
)
DIFFERENTIAL = (
    "area_a: 12.5 cm^2, area_b: 8 cm^2, stroke: 400 mm, mass: 60 kg, dead_volume_a: 40 ml, "
    "dead_volume_b: 30 ml"
)
ROBOT = (
    "area_a: 8 cm^2, area_b: 5 cm^2, stroke: 150 mm, mass: 0 kg, dead_volume_a: 30 ml, "
    "dead_volume_b: 30 ml, closed_length: 300 mm"
)


def difference(
    folder: Path, design: str, scenario: str, servo: PlainServo, place: float, jumps: tuple
) -> dict[str, float]:
    """Largest difference of position, as a share of its span, and of pressures, of the supply."""
    (folder / "servo.yaml").write_text(design)
    (folder / "motion.yaml").write_text(scenario)
    found = ao.simulate(folder / "motion.yaml")
    signals = found.signals
    start = tuple(float(signals[f"pressure_{side}"][0]) for side in "ab")
    truth = servo.run(place, start, found.time, jumps)
    span = float(np.ptp(truth["position"]))
    assert span > 0.015
    assert min(truth["pressure_a"].min(), truth["pressure_b"].min()) > 0
    size = {"position": span, "pressure_a": servo.supply, "pressure_b": servo.supply}
    return {
        name: float(np.max(np.abs(signals[name] - values))) / size[name]
        for name, values in truth.items()
    }


CLOSE = 1e-4
"""Ten times the largest difference of the three (the claim: 0.1 % of position, 0.5 % of supply)."""


def test_a_symmetric_cylinder_follows_a_sine(tmp_path) -> None:
    """Equal areas, 20 mm at 2 Hz."""
    design = DESIGN.format(ideal=SYMMETRIC, supply="160 bar")
    scenario = SCENARIO.format(
        gain=150,
        reference="{shape: sine, value: 20 mm, frequency: 2 Hz}",
        place="150 mm",
        a=80,
        b=80,
    )
    scenario += "friction: {model: none, viscous: 4 kN*s/m}\n"
    servo = PlainServo(
        areas=(1e-3, 1e-3), dead=(5e-5, 5e-5), stroke=0.3, supply=160e5, back=BACK, gain=150.0,
        reference=lambda t: 0.15 + 0.02 * sin(4 * pi * t), mass=80.0, viscous=4e3, **COMMON,
    )  # fmt: skip
    found = difference(tmp_path, design, scenario, servo, 0.15, ())
    assert max(found.values()) < CLOSE, found


def test_a_differential_cylinder_steps_against_dry_friction(tmp_path) -> None:
    """40 mm out and back, 1 kN of load, 500 N of dry friction that holds it in between."""
    design = DESIGN.format(ideal=DIFFERENTIAL, supply="140 bar")
    steps = "{shape: step, value: 40 mm, start: 20 ms}, {shape: step, value: -40 mm, start: 500 ms}"
    scenario = SCENARIO.format(gain=120, reference=steps, place="150 mm", a=60, b=81.25)
    scenario += (
        "friction: {model: stribeck, coulomb: 500 N, stribeck_speed: 0.1 mm/s, viscous: 4 kN*s/m}\n"
        "load: {force: [{shape: constant, value: 1 kN}]}\n"
    )
    servo = PlainServo(
        areas=(12.5e-4, 8e-4), dead=(4e-5, 3e-5), stroke=0.4, supply=140e5, back=BACK, gain=120.0,
        reference=lambda t: 0.15 + (0.04 if 0.02 <= t < 0.5 else 0.0), mass=60.0, viscous=4e3,
        dry=500.0, load=lambda t: 1e3, **COMMON,
    )  # fmt: skip
    found = difference(tmp_path, design, scenario, servo, 0.15, (0.02, 0.5))
    assert max(found.values()) < CLOSE, found


def of_robot(folder: Path, inertia: float) -> dict[str, float]:
    """Differences of a run with 25 kg m^2 from an arm of an inertia, integrated in its angle."""
    design = DESIGN.format(ideal=ROBOT, supply="140 bar")
    design += "linkage: {base_radius: 300 mm, crank_radius: 250 mm}\nload: {inertia: 25 kg*m^2}\n"
    scenario = SCENARIO.format(
        gain=60, reference="{shape: step, value: 30 mm, start: 20 ms}", place="60 mm", a=60, b=70
    )
    scenario += (
        "friction: {model: none, viscous: 5 kN*s/m}\n"
        "load: {torque: [{shape: constant, value: 300 N*m}]}\n"
    )
    arm = Arm(0.3, 0.25, inertia, lambda angle: 300.0, 0.3)
    servo = PlainServo(
        areas=(8e-4, 5e-4), dead=(3e-5, 3e-5), stroke=0.15, supply=140e5, back=BACK, gain=60.0,
        reference=lambda t: 0.06 + (0.03 if t >= 0.02 else 0.0), viscous=5e3, arm=arm, **COMMON,
    )  # fmt: skip
    angle = acos((0.3**2 + 0.25**2 - 0.36**2) / (2 * 0.3 * 0.25))
    return difference(folder, design, scenario, servo, angle, (0.02,))


def test_a_cylinder_turns_a_robot_arm(tmp_path) -> None:
    """Pivots of 300 and 250 mm; an inertia that is 5 % off is seen."""
    found = of_robot(tmp_path, 25.0)
    assert max(found.values()) < CLOSE, found
    assert max(of_robot(tmp_path, 26.25).values()) > 10 * CLOSE
