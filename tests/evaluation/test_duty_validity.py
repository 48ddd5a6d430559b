"""Whether duty cycles are slow enough for the quasi-static model."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from duty_case import knee

import actuator_opt as ao
from actuator_opt.design.cycle_record import read_cycle
from actuator_opt.evaluation.duty_cycles.study import CycleStudy, DutyStudy
from actuator_opt.evaluation.duty_cycles.validity import (
    AFFECTED,
    RUBBING,
    content_frequency,
    warnings,
)


def cycle(position, period=2.0, *, closed=True, samples=200) -> CycleStudy:
    """A cycle whose position is a function of the share of its period."""
    time = np.linspace(0.0, period, samples + 1)
    x = position(time / period)
    if closed:
        x[-1] = x[0]
    rows = [f"{t:.12f},{1e3 * p:.12f},0" for t, p in zip(time, x, strict=True)]
    record = read_cycle("\n".join(["time [s],position [mm],force [N]", *rows, ""]), closed=closed)
    return CycleStudy("walk", record, time, {"position": x}, {}, {}, {}, {}, None)


@pytest.mark.parametrize(("share", "expected"), [(0.005, 1), (0.02, 5)])
def test_the_content_is_the_harmonic_that_completes_99_percent_of_the_power(share, expected):
    """Of sin(w t) + b sin(5 w t), the fifth harmonic has 25 b^2/(1 + 25 b^2) of the power."""
    b = np.sqrt(share / (1 - share)) / 5
    own = cycle(lambda s: np.sin(2 * np.pi * s) + b * np.sin(10 * np.pi * s))
    assert content_frequency(own) == pytest.approx(expected / 2.0, rel=1e-12)
    slower = replace(own, time=3 * own.time)
    assert content_frequency(slower) == pytest.approx(expected / 6.0, rel=1e-12)


def test_an_open_cycle_is_continued_by_its_mirror_image():
    """The speed of half a cosine is |sin|: 81.06 % of its power is its mean, 18.01 % the first."""
    own = cycle(lambda s: 0.03 * (1 - np.cos(np.pi * s)), closed=False)
    mean, first = (2 / np.pi) ** 2 / 0.5, 0.5 * (4 / (3 * np.pi)) ** 2 / 0.5
    assert mean < 0.99 < mean + first
    assert content_frequency(own) == pytest.approx(1 / 2.0, rel=1e-12)


def test_a_cycle_at_rest_has_no_content():
    """Without motion nothing is too fast."""
    assert content_frequency(cycle(lambda s: 0.05 + 0 * s)) == 0.0


@pytest.mark.parametrize(("lowest", "warned"), [(1.51, False), (1.49, True)])
def test_the_limit_is_a_third_of_the_lowest_frequency(lowest, warned):
    """A sine of 0.5 Hz against three frequencies; unknown and zero ones do not count."""
    study = DutyStudy((cycle(lambda s: np.sin(2 * np.pi * s)),), {}, ())
    known = {"natural frequency": 100.0, "bandwidth of the position loop": lowest, "none": 0.0}
    found = dict(warnings(study, known, valve=True))
    assert set(found) == (set(AFFECTED) if warned else set())
    for sentence in found.values():
        assert "bandwidth of the position loop (1.49 Hz)" in sentence
        assert sentence.endswith("run actuator-opt simulate FILE --cycle walk")
    for sentence in dict(warnings(study, known, valve=False)).values():
        assert "add valve" in sentence


@cache
def _walking(scale: str) -> ao.Evaluation:
    return ao.evaluate(knee(**{"duty__cycles[walk]__time_scale": scale}))


def test_a_design_warns_of_a_fast_cycle_and_marks_its_metrics():
    """The gait has 4.55 Hz (its fifth harmonic), the loop 4.31 Hz."""
    fast = _walking("1")
    (sentence,) = [text for text in fast.warnings if "too fast" in text]
    assert "4.55 Hz" in sentence
    assert not fast.metrics["duty_pressure_min"].in_range
    assert fast.metrics["duty_work_out"].in_range


def test_a_design_does_not_warn_of_a_slow_cycle():
    """Four times as slow, the gait has 1.14 Hz, below 4.31/3 Hz."""
    slow = _walking("4")
    assert not [text for text in slow.warnings if "too fast" in text]
    assert slow.metrics["duty_supply_share"].in_range


def test_a_design_warns_where_leakage_shifts_pressures_and_opening():
    """Shortly before the reversal the valve leaks 31 % of the flow; a tight one is fine."""
    walking = _walking("4")
    (sentence,) = [text for text in walking.warnings if "leakage takes" in text]
    worst = walking.duty.cycles[0].worst["pressure_a"]
    traces = walking.duty.cycles[0].traces
    share = traces["leakage"][worst.sample] / traces["flow"][worst.sample]
    assert f"leakage takes {100 * share:.0f} % of the flow at the lowest pressure" in sentence
    assert f"({worst.time:.3g} s)" in sentence
    high = np.maximum(traces["pressure_a"], traces["pressure_b"])
    leaks = (traces["leakage"] / traces["flow"])[[np.argmax(high), np.argmax(traces["opening"])]]
    for share, words in zip(
        leaks, ("at the highest pressure", "at the largest opening"), strict=True
    ):
        assert (f"{100 * share:.0f} % {words}" in sentence) == (share > 0.1)
    assert "run actuator-opt simulate FILE --cycle walk" in sentence
    assert not walking.metrics["duty_suction_ratio"].in_range
    tight = ao.evaluate(knee(valve__leakage_flow="0 l/min",
                             piston__leakage_conductance="0 ml/min/bar",
                             variables__piston__leakage_conductance=None))  # fmt: skip
    assert not [text for text in tight.warnings if "leakage takes" in text]


def test_friction_of_film_seals_is_said_to_be_dry():
    """With the share of these seals in the friction energy of the cycle."""
    study = _walking("1").duty
    assert study.films == {}
    study = replace(study, films={"rod seal": "friction1"})
    found = [pair for pair in warnings(study, {}, valve=True) if pair[0] in RUBBING]
    traces = study.cycles[0].traces
    means = [(y[1:] + y[:-1]) / 2 for y in (traces["friction1"], traces["friction"])]
    rod, both = (np.sum(mean * np.abs(np.diff(traces["position"]))) for mean in means)
    assert [metric for metric, _ in found] == list(RUBBING)
    for _, sentence in found:
        assert sentence.startswith("walk: rod seal with an oil film")
        assert f"{100 * rod / both:.0f} % of the friction energy" in sentence


@pytest.mark.long
def test_a_design_with_a_film_says_so():
    """The film's own friction costs seconds for each speed; a cycle has many."""
    found = ao.evaluate(knee(seals__rod__friction="film"))
    assert found.duty.films == {"rod seal": "friction1"}
    assert not found.metrics["duty_friction_energy"].in_range
