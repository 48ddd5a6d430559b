"""Effects of the parameters of a scenario: the frequencies of a data sheet."""

from __future__ import annotations

from math import sqrt
from pathlib import Path

import pytest

import actuator_opt as ao

SERVO = Path(__file__).parents[2] / "designs" / "servo_knee.yaml"
SCENARIO = f"""\
name: short step
design: {SERVO}
duration: 0.3 s
control:
  tuning: stated
  position_gain: 700 V/m
  position:
    - shape: step
      value: 10 mm
requirements:
  rise_time:
    max: 60 ms
"""
NATURAL, DAMPING = "valve.natural_frequency", "valve.damping_ratio"
LAG, FALL = "valve.frequency_90deg", "valve.frequency_3db"


def effects(names, **stated):
    """Change of the rise time in per cent per 1 % of each parameter."""
    changes = dict.fromkeys((NATURAL, DAMPING)) | {f"valve.{key}": x for key, x in stated.items()}
    found = ao.servo_sensitivities(ao.read_scenario(SCENARIO, set=changes), names)
    assert not found.skipped
    return {row.path: row.effects["rise_time"].percent for row in found.parameters}


def damping_by_hand(fall, lag):
    """(1 - r^2)^2 + (2 zeta r)^2 = 10^0.3 at r = fall/lag, -3 dB of a second-order lag."""
    ratio = fall / lag
    return sqrt(10**0.3 - (1 - ratio**2) ** 2) / (2 * ratio)


def test_the_frequency_at_90_degrees_acts_as_the_natural_frequency():
    """A second-order lag turns by 90 degrees at its natural frequency: equal effects."""
    lag = effects([LAG, DAMPING], frequency_90deg="80 Hz", damping_ratio="0.7")
    natural = effects([NATURAL, DAMPING], natural_frequency="80 Hz", damping_ratio="0.7")
    assert abs(natural[NATURAL]) > 0.05
    assert lag[LAG] == pytest.approx(natural[NATURAL], rel=1e-9)
    assert lag[DAMPING] == pytest.approx(natural[DAMPING], rel=1e-9)


def test_two_frequencies_act_through_the_damping_ratio():
    """Chain rule: the -3 dB frequency acts by d ln zeta/d ln f of the response by hand."""
    both = effects([LAG, FALL, "load.mass"], frequency_90deg="80 Hz", frequency_3db="90 Hz")
    zeta = damping_by_hand(90, 80)
    one = effects([NATURAL, DAMPING, "load.mass"], natural_frequency="80 Hz", damping_ratio=zeta)
    step = 1e-4
    slope = (damping_by_hand(90 * (1 + step), 80) / zeta - 1) / step
    assert both[FALL] == pytest.approx(slope * one[DAMPING], rel=0.1)
    assert both[LAG] == pytest.approx(one[NATURAL] - slope * one[DAMPING], rel=0.1, abs=0.01)
    assert both["load.mass"] == pytest.approx(one["load.mass"], rel=0.01, abs=1e-3)


def test_the_default_parameters_are_the_stated_frequencies():
    """Those of the data sheet are varied; a damping ratio that follows from them is not."""
    from actuator_opt.simulation import sensitivity

    changes = {
        NATURAL: None,
        DAMPING: None,
        LAG: "80 Hz",
        FALL: "90 Hz",
        "valve.slew_rate": "9 V/ms",
    }
    trial = ao.read_scenario(SCENARIO, set=changes)
    bench = sensitivity._Bench(trial.scenario, trial.actuator.subject(), {}, None)
    varied = {target.path for target in bench.targets(None)}
    assert {LAG, FALL, "valve.slew_rate", "valve.rated_flow", "load.mass"} <= varied
    assert not {NATURAL, DAMPING} & varied
    bench.subject = ao.read(SERVO).subject()
    assert {NATURAL, DAMPING} <= {target.path for target in bench.targets(None)}


def test_a_design_with_both_frequencies_can_be_changed():
    """A default that has no effect beside other keys is not taken for a stated value."""
    changes = {NATURAL: None, DAMPING: None, LAG: "80 Hz", FALL: "90 Hz"}
    changed = ao.read(SERVO, set=changes).changed({"load.mass": "30 kg"})
    assert changed.design.load.mass == 30
    assert changed.design.valve.frequency_3db == 90
    with pytest.raises(ao.InputError, match="follows from frequency_3db"):
        changed.changed({DAMPING: 0.8})
