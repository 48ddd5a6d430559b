"""Claims about damage of counted cycles: worked numbers, other ways to the same, exact slopes."""

from __future__ import annotations

import numpy as np
import pytest
from counted_cycles import cycle_stress
from hypothesis import given, strategies as st

from actuator_opt.models import endurance, rainflow

METAL = {"ultimate_strength": 570e6, "fatigue_limit": 159e6, "limit_cycles": 5e8}
BARS = np.array([0.0, 210.0, 80.0, 150.0, 20.0, 120.0, 0.0])
"""Pressure of the worked example [bar]; the stress is 9.5 times the pressure."""
SIX_DIGITS = 5e-6


def lives(history):
    """Cycles endured, and counts, of a repeating stress history."""
    counted = rainflow.repeating_cycles(history=history)
    stress = cycle_stress(history, counted)
    amplitude = endurance.reversed_amplitude(
        amplitude=stress.amplitude, mean=stress.mean, ultimate_strength=METAL["ultimate_strength"]
    )
    return endurance.basquin_cycles(amplitude=amplitude, **METAL), counted.count


def damage(history, repeats=1.0):
    """Damage of a repeating stress history."""
    cycles, counts = lives(history)
    return endurance.miner_damage(cycles=cycles, counts=counts, repeats=repeats)


def test_worked_example():
    """Cycles (80, 150), (20, 120), (0, 210) bar times 9.5: three lives and their damage."""
    cycles, counts = lives(BARS * 1e5 * 9.5)
    assert sorted(cycles, reverse=True) == pytest.approx(
        [1.89264e15, 9.407e13, 1.07493e10], rel=SIX_DIGITS
    )
    assert counts.tolist() == [1.0, 1.0, 1.0]
    assert damage(BARS * 1e5 * 9.5) == pytest.approx(9.30400e-11, rel=SIX_DIGITS)
    assert damage(BARS * 1e5 * 9.5, repeats=5e6) == pytest.approx(4.65200e-4, rel=SIX_DIGITS)


@pytest.mark.parametrize("amplitude", [400e6, 200e6, 60e6])
def test_line_is_straight_in_logarithms(amplitude):
    """Through (1e3, 0.9 R_m) and (N_w, S_w) by a straight line of NumPy, continued past N_w."""
    stresses, cycles = np.log([0.9 * 570e6, 159e6]), np.log([1e3, 5e8])
    line = np.poly1d(np.polyfit(stresses, cycles, 1))
    found = endurance.basquin_cycles(amplitude=amplitude, **METAL)
    assert np.log(found) == pytest.approx(line(np.log(amplitude)), rel=1e-12)


@given(st.floats(10e6, 550e6))
def test_pulsating_tension_as_in_the_other_form(peak):
    """`cycles_to_failure` at a stress ratio of zero is the same life."""
    amplitude = endurance.reversed_amplitude(
        amplitude=peak / 2, mean=peak / 2, ultimate_strength=570e6
    )
    found = endurance.basquin_cycles(amplitude=amplitude, **METAL)
    assert found == pytest.approx(endurance.cycles_to_failure(peak_stress=peak, **METAL), rel=1e-9)


def test_compression_gets_no_credit():
    """A compressive mean changes nothing; a tensile mean shortens the life."""
    amplitude = np.full(3, 90e6)
    mean = np.array([-200e6, 0.0, 200e6])
    found = endurance.reversed_amplitude(amplitude=amplitude, mean=mean, ultimate_strength=570e6)
    assert found[:2].tolist() == [90e6, 90e6]
    assert found[2] == pytest.approx(90e6 * 570 / 370)


def test_limits_of_the_life():
    """No amplitude is endured for ever, a mean of R_m for no cycle; the damage follows."""
    found = endurance.reversed_amplitude(
        amplitude=np.array([0.0, 1e6, 1e6]), mean=np.array([0.0, 570e6, 0.0]),
        ultimate_strength=570e6,
    )  # fmt: skip
    cycles = endurance.basquin_cycles(amplitude=found, **METAL)
    assert cycles[:2].tolist() == [np.inf, 0.0]
    sums = endurance.miner_damage(
        cycles=cycles[:, None] * np.ones(3), counts=np.diag([1.0, 1.0, 1.0]), repeats=1e3
    )
    assert sums == pytest.approx([0.0, np.inf, 1e3 / cycles[2]])
    assert endurance.bolt_cycles(amplitude=0.0, diameter=8e-3) == np.inf


def test_damage_of_bolts_grows_with_the_cube():
    """N = 2e6 (sigma_A/sigma_a)^3: a doubled history does eight times the damage."""
    history = np.array([10e6, 60e6, 20e6, 50e6])

    def of(scale):
        counted = rainflow.repeating_cycles(history=history)
        stress = cycle_stress(scale * history, counted)
        cycles = endurance.bolt_cycles(amplitude=stress.amplitude, diameter=8e-3)
        return endurance.miner_damage(cycles=cycles, counts=counted.count, repeats=1e4)

    by_hand = 1e4 / 2e6 * (25**3 + 15**3) / (0.85 * (150 / 8 + 45)) ** 3
    assert of(1.0) == pytest.approx(by_hand, rel=1e-12)
    assert of(2.0) == pytest.approx(8 * of(1.0), rel=1e-12)


@given(st.lists(st.floats(0.0, 500e6), min_size=2, max_size=25), st.data())
def test_damage_does_not_depend_on_the_beginning(history, data):
    """Rotated histories do the same damage, two repeats in one file twice as much."""
    shift = data.draw(st.integers(0, len(history) - 1))
    once = damage(history)
    assert damage([*history[shift:], *history[:shift]]) == pytest.approx(once, rel=1e-9)
    assert damage([*history, *history]) == pytest.approx(2 * once, rel=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_slope_of_the_damage_is_exact(seed):
    """Complex steps of every sample agree with central differences while the pairs stay."""
    history = np.random.default_rng(seed).uniform(-150e6, 400e6, 30)
    steps = np.repeat(history[:, None].astype(complex), 30, axis=1) + 1e-30j * np.eye(30)
    slopes = np.imag(damage(steps)) / 1e-30
    change = 1.0 * np.eye(30)
    differences = (damage(history[:, None] + change) - damage(history[:, None] - change)) / 2.0
    assert np.count_nonzero(slopes) > 5
    np.testing.assert_allclose(slopes, differences, rtol=1e-6, atol=1e-8 * np.abs(slopes).max())


def test_damage_is_continuous_where_the_pairs_change():
    """Two valleys change places in the pairs where they are equal; the damage does not jump."""

    def history(valley):
        return np.array([300e6, 50e6, 200e6, valley, 250e6, 80e6])

    def pairs(found):
        return {(int(i), int(k)) for i, k in zip(found.largest, found.smallest, strict=True)}

    below, above = history(50e6 - 1e-3), history(50e6 + 1e-3)
    assert pairs(rainflow.repeating_cycles(history=below)) != pairs(
        rainflow.repeating_cycles(history=above)
    )
    assert damage(below) == pytest.approx(damage(above), rel=1e-9)
