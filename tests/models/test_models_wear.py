"""Claims about the wear of seals over a cycle: worked numbers, closed forms, strokes by hand."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.integrate import quad
from scipy.interpolate import CubicSpline

from actuator_opt.models import wear

TIME = [0.0, 0.3, 0.5, 0.8, 1.0]
POSITION = [0.02, 0.06, 0.09, 0.05, 0.02]
PRESSURE = [12e6, 18e6, 14e6, 9e6, 12e6]
SIX_DIGITS = 5e-6


def test_worked_example():
    """Severity, depth, share and pV of the worked example."""
    severity = wear.cycle_severity(contact_pressure=PRESSURE, position=POSITION)
    depth = wear.worn_depth(severity=severity, wear_rate=2e-17, repeats=1e6)
    assert wear.sliding_distance(position=POSITION) == pytest.approx(0.14, rel=SIX_DIGITS)
    assert severity == pytest.approx(1.855e6, rel=SIX_DIGITS)
    assert depth == pytest.approx(3.71e-5, rel=SIX_DIGITS)
    assert wear.wear_share(depth=depth, allowed_depth=50e-6) == pytest.approx(0.742, rel=SIX_DIGITS)
    speed = CubicSpline(TIME, POSITION, bc_type="periodic")(TIME, 1)
    pv = wear.pressure_velocity(contact_pressure=np.array(PRESSURE), speed=speed)
    assert pv.max() == pytest.approx(3.80909e6, rel=SIX_DIGITS)
    assert int(pv.argmax()) == 1


def test_no_allowance_has_no_share():
    """A depth of zero allows nothing."""
    assert np.isnan(wear.wear_share(depth=1e-6, allowed_depth=0.0))


@given(st.floats(1e5, 3e7), st.lists(st.floats(-0.1, 0.1), min_size=2, max_size=20))
def test_constant_pressure_is_the_other_form(pressure, position):
    """Archard's load and distance, `sliding_severity`, where the pressure does not change."""
    severity = wear.cycle_severity(contact_pressure=[pressure] * len(position), position=position)
    expected = wear.sliding_severity(
        line_load=1e-3 * pressure,
        contact_width=1e-3,
        distance=np.abs(np.diff(position)).sum(),
    )
    assert severity == pytest.approx(expected, rel=1e-9)


def test_volume_worn_is_that_of_archard():
    """Depth times area is k times the work of the load over time, by quadrature of p|v|."""
    amplitude, omega, rate = 0.04, 2 * np.pi, 3e-17

    def pressure(x):
        return 12e6 + 8e6 * x / amplitude + 5e6 * (x / amplitude) ** 2

    def power(t):
        x, v = amplitude * np.sin(omega * t), amplitude * omega * np.cos(omega * t)
        return pressure(x) * abs(v)

    work, _ = quad(power, 0.0, 1.0, points=[0.25, 0.75], epsrel=1e-12)
    errors = []
    for samples in (41, 161):
        x = amplitude * np.sin(omega * np.linspace(0.0, 1.0, samples))
        severity = wear.cycle_severity(contact_pressure=pressure(x), position=x)
        depth = wear.worn_depth(severity=severity, wear_rate=rate, repeats=1e6)
        errors.append(abs(depth / (rate * work * 1e6) - 1))
    assert errors[1] < 2e-4
    assert errors[1] < errors[0] / 12  # second order: a sixteenth


def test_many_designs_at_once():
    """Positions (samples, designs) with one pressure history: a column per design."""
    position = np.outer(POSITION, [1.0, 2.0])
    found = wear.cycle_severity(contact_pressure=PRESSURE, position=position)
    assert found == pytest.approx([1.855e6, 3.71e6])


def by_hand(position, *, closed):
    """Lengths of runs of one direction, joined over the end of a closed cycle."""
    steps = [b - a for a, b in pairwise(position) if b != a]
    runs = []
    for step in steps:
        if runs and (runs[-1] > 0) == (step > 0):
            runs[-1] += step
        else:
            runs.append(step)
    if closed and len(runs) > 1 and (runs[0] > 0) == (runs[-1] > 0):
        runs[0] += runs.pop()
    return runs


@given(st.lists(st.integers(-4, 4), min_size=1, max_size=30), st.booleans())
def test_strokes_are_runs_of_one_direction(position, closed):
    """Lengths, reversals and short strokes, for closed and open cycles."""
    if closed:
        position = [*position, position[0]]
    runs = by_hand(position, closed=closed)
    found = wear.strokes(position=position, contact_width=1.0, closed=closed)
    assert found.lengths.tolist() == [abs(run) for run in runs]
    assert found.reversals == (len(runs) if closed else max(len(runs) - 1, 0))
    assert found.short == sum(abs(run) < 2 for run in runs)


def test_dither_is_counted():
    """A tremble of 0.1 mm after the peak adds two reversals and two short strokes."""
    dither = [0.09, 0.0901, 0.09, 0.0901, 0.09]
    smooth = wear.strokes(position=POSITION, contact_width=1e-3, closed=True)
    found = wear.strokes(
        position=[0.02, 0.06, *dither, 0.05, 0.02], contact_width=1e-3, closed=True
    )
    assert (smooth.reversals, smooth.short) == (2, 0)
    assert (found.reversals, found.short) == (4, 2)


@pytest.mark.parametrize("position", [[0.0, np.nan, 1.0], np.zeros((3, 2))])
def test_strokes_need_one_history_of_numbers(position):
    """A NaN or several histories have no strokes."""
    with pytest.raises(ValueError, match="position: needs the samples of one history"):
        wear.strokes(position=position, contact_width=1e-3, closed=False)
