"""Claims about the static contact pressure profiles and the loads they carry."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.integrate import quad
from scipy.interpolate import PchipInterpolator

from actuator_opt.models import contact_profile, seals


def land_mean(*, sealed_pressure, outer_pressure, excess):
    """Mean of `land_profile`, its integral over t."""
    share = contact_profile.LAND_POWER / (contact_profile.LAND_POWER + 1)
    return (sealed_pressure + outer_pressure) / 2 + share * excess


SHAPES = {
    "o_ring": (
        contact_profile.o_ring_profile,
        contact_profile.o_ring_mean,
        contact_profile.o_ring_excess,
    ),
    "lip": (contact_profile.lip_profile, contact_profile.lip_mean, contact_profile.lip_excess),
    "land": (contact_profile.land_profile, land_mean, contact_profile.land_excess),
}
ENDS = {"sealed_pressure": 5e6, "outer_pressure": 0.101e6}
KNOTS = (0.2, 0.6)
pressures = st.floats(0, 4e7)
whole = st.integers(0, 40_000_000)
"""Pascals: far below one, the other interpolator overflows."""


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("excess", [0.0, 0.3e6, 1.5e6, 2e7])
def test_profiles_meet_both_sides_and_their_mean(shape, excess):
    """p_s at t = 0, p_a at t = 1, continuous between, and the mean is the integral."""
    profile, mean, _ = SHAPES[shape]
    assert profile(position=0.0, excess=excess, **ENDS) == pytest.approx(5e6)
    assert profile(position=1.0, excess=excess, **ENDS) == pytest.approx(0.101e6)
    area, _ = quad(
        lambda t: profile(position=t, excess=excess, **ENDS), 0, 1, points=KNOTS, limit=200
    )
    assert mean(excess=excess, **ENDS) == pytest.approx(area, rel=1e-7)
    t = np.linspace(0, 1, 40001)
    steps = np.abs(np.diff(profile(position=t, excess=excess, **ENDS)))
    assert np.max(steps) < 0.011 * (excess + 5e6)


@pytest.mark.parametrize("shape", SHAPES)
@given(pressures, st.floats(0, 2e5), st.floats(1e5, 4e7), st.floats(1e-4, 1e-2))
def test_excess_carries_the_line_load(shape, difference, outer, excess, width):
    """Profile of the excess found for f has b (mean - p_a) = f again."""
    _, mean, inverse = SHAPES[shape]
    ends = {"sealed_pressure": outer + difference, "outer_pressure": outer}
    if 0.58 * (outer + difference + excess) <= outer:
        return  # outside the lip profile's range
    load = width * (mean(excess=excess, **ends) - outer)
    found = inverse(line_load=load, width=width, **ends)
    assert found == pytest.approx(excess, rel=1e-8, abs=1e-6 * (difference + outer))


@pytest.mark.parametrize("shape", SHAPES)
def test_too_small_a_load_gives_a_negative_excess_and_no_width_none(shape):
    """A load below what the sealed pressure needs is told by the sign; no contact is NaN."""
    inverse = SHAPES[shape][2]
    assert inverse(line_load=100.0, width=1e-3, **ENDS) < 0
    assert math.isnan(inverse(line_load=100.0, width=0.0, **ENDS))


@given(whole, st.integers(0, 200_000), st.integers(-30_000_000, 40_000_000))
def test_lip_profile_is_the_monotone_cubic_of_its_points(difference, outer, excess):
    """Equal to SciPy's interpolator through the four points, also where a branch turns."""
    sealed = outer + difference
    top = sealed + excess
    points = [sealed, top, outer + 0.42 * top, outer]
    t = np.linspace(0, 1, 101)
    ours = contact_profile.lip_profile(
        position=t, sealed_pressure=sealed, outer_pressure=outer, excess=excess
    )
    theirs = PchipInterpolator([0, 0.2, 0.6, 1], points)
    scale = max(map(abs, points)) + 1e-3
    np.testing.assert_allclose(ours, theirs(t), atol=1e-9 * scale, rtol=0)
    mean = contact_profile.lip_mean(sealed_pressure=sealed, outer_pressure=outer, excess=excess)
    assert mean == pytest.approx(float(theirs.integrate(0, 1)), abs=1e-9 * scale)


def test_o_ring_profile_at_its_middle_and_by_hertz():
    """At t = 1/2: the sealed pressure less 1/1024, plus p_0; at rest the excess is Hertz's peak.

    Ring of 3.53 mm at 13 % squeeze, E 8 MPa: width 1.18326 mm and peak of `hertz_lindley`.
    """
    middle = contact_profile.o_ring_profile(position=0.5, excess=2e6, **ENDS)
    assert middle == pytest.approx(5e6 - (5e6 - 0.101e6) / 1024 + 2e6)
    law = seals.LAWS["hertz_lindley"]
    ring = {"squeeze": 0.13, "section": 3.53e-3, "youngs_modulus": 8e6, "pressure": 0.0}
    width = law.contact_width(**ring)
    assert width * 1e3 == pytest.approx(1.18326, abs=6e-6)
    excess = contact_profile.o_ring_excess(
        line_load=law.line_load(**ring), width=width, sealed_pressure=0.0, outer_pressure=0.0
    )
    assert excess == pytest.approx(law.peak_pressure(**ring))


@given(st.floats(0, 3e7), st.floats(0, 1e5), st.floats(0.0, 2e5), st.floats(1e-4, 1e-2))
def test_land_peak_is_the_highest_of_the_profile(difference, outer, load, width):
    """No place of the profile that carries the load lies higher, and one reaches the peak."""
    arguments = {"sealed_pressure": outer + difference, "outer_pressure": outer}
    peak = contact_profile.land_peak(line_load=load, width=width, **arguments)
    excess = contact_profile.land_excess(line_load=load, width=width, **arguments)
    t = np.linspace(0, 1, 20001)
    highest = np.max(contact_profile.land_profile(position=t, excess=excess, **arguments))
    if excess >= 0:
        assert peak == pytest.approx(highest, rel=1e-5, abs=1e-6)
    else:
        assert peak == pytest.approx(outer + difference)


def test_land_without_contact_shows_the_outer_pressure():
    """No width: nothing but the surroundings; a worn land without pressure has its mean 9/8 up."""
    assert contact_profile.land_peak(line_load=0.0, width=0.0, **ENDS) == 0.101e6
    flat = contact_profile.land_peak(
        line_load=8e3, width=1e-3, sealed_pressure=0.0, outer_pressure=0.0
    )
    assert flat == pytest.approx(9e6)


def test_table_profile_is_linear_interpolation():
    """Equal to NumPy's, held outside; its mean is the exact area."""
    places, values = (0.0, 0.2, 0.5, 1.0), (5e6, 8e6, 6e6, 0.0)
    t = np.linspace(0, 1, 57)
    ours = contact_profile.table_profile(position=t, positions=places, pressures=values)
    np.testing.assert_allclose(ours, np.interp(t, places, values), rtol=1e-13, atol=1e-6)
    assert contact_profile.table_profile(position=1.4, positions=places, pressures=values) == 0.0
    mean = contact_profile.table_mean(positions=places, pressures=values)
    assert mean == pytest.approx(0.2 * 6.5e6 + 0.3 * 7e6 + 0.5 * 3e6)
