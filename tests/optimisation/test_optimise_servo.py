"""A cylinder and its position loop, the design of the tutorial, with a bandwidth to reach."""

from __future__ import annotations

import numpy as np
import pytest

import actuator_opt as ao
from actuator_opt import api as verbs
from actuator_opt.evaluation import compute

LOOP = """
valve: {rated_flow: 10 l/min, rated_drop: 35 bar, leakage_flow: 0.2 l/min, leakage_drop: 50 bar,
  natural_frequency: 120 Hz, damping_ratio: 0.7}
ports: {end: valve}
control: {gain: 700 V/m}
load: {mass: 30 kg}

# Sizes that"""
VARIABLES = """\
  control.gain: {lower: 10 V/m, upper: 20000 V/m}
  piston.leakage_conductance: {lower: 0.1 ml/min/bar, upper: 20 ml/min/bar}
"""


@pytest.fixture(scope="module")
def tutorial():
    """The tutorial's design for a bandwidth [Hz]."""
    start = ao.start(push="9 kN", pull="5 kN", stroke="180 mm", pressure="160 bar")
    text = start.source.text
    limits = "  gain_margin: {min: 2}\n  phase_margin: {min: 40 deg}\n"
    for before, after in (
        ("\n# Sizes that", LOOP),
        ("\nobjective:", f"\n  bandwidth: {{min: BAND}}\n{limits}objective:"),
        ("\npiston: {", "\npiston: {leakage_conductance: 2 ml/min/bar, "),
    ):
        assert text.count(before) == 1
        text = text.replace(before, after)
    return lambda band: verbs.read((text + VARIABLES).replace("BAND", f"{band} Hz"))


@pytest.mark.parametrize("band", [4.5, *(pytest.param(x, marks=pytest.mark.long) for x in
    (3.25, 3.465, 3.5, 4, 4.8, 5, 6))])  # fmt: skip
def test_the_servo_of_the_tutorial_ends_at_an_optimum(tutorial, band):
    """Every bandwidth has an optimum with all requirements met, without a waiver."""
    found = verbs.optimise(tutorial(band), prices=False)
    assert found.status == "optimal"


def test_the_damping_ratio_has_no_jump_between_two_optima(tutorial):
    """From the optimum for 3.25 Hz to that for 6 Hz every row is a number and changes steadily."""
    subject = tutorial(4).subject()
    ends = {
        "cylinder.bore": (28.01e-3, 29.82e-3),
        "barrel.layup[0].thickness": (1.767e-3, 1.882e-3),
        "rod.outer_diameter": (16.93e-3, 16.61e-3),
        "rod.inner_diameter": (14.50e-3, 13.49e-3),
        "piston.leakage_conductance": (3.33e-12, 3.33e-12),
    }
    share = np.linspace(0, 1, 401)
    varied = {name: low + (high - low) * share for name, (low, high) in ends.items()}
    rows = compute(subject, subject.values(varied)).computed.metrics["damping_ratio"]
    for ratios in rows.values():
        assert np.isfinite(ratios).all()
        assert np.max(np.abs(np.diff(ratios))) < 0.03
