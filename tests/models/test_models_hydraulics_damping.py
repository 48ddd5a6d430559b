"""Claims about viscous damping coefficients and gap leakage."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st

from actuator_opt.models import damping


def test_check_values():
    """Pipe 0.201062, annulus 0.0629493 N s/m, leakage 1.76715e-6 m3/s; 2.5 times off-centre."""
    assert damping.pipe_flow(dynamic_viscosity=0.04, length=0.2) == pytest.approx(
        0.201062, abs=6e-7
    )
    annulus = damping.annular_couette(
        dynamic_viscosity=0.04, length=0.2, inner_radius=9e-3, outer_radius=20e-3
    )
    assert annulus == pytest.approx(0.0629493, abs=6e-8)
    gap = {"diameter": 0.04, "gap": 30e-6, "dynamic_viscosity": 0.04, "length": 0.02}
    leak = damping.gap_conductance(**gap)
    assert 5e6 * leak == pytest.approx(1.76715e-6, rel=3e-6)
    assert damping.gap_conductance(eccentricity=1.0, **gap) == pytest.approx(2.5 * leak)


@given(st.floats(1e-5, 1e-3))
def test_thin_annulus_is_a_flat_gap(share):
    """Couette between cylinders tends to the flat gap at the mean diameter."""
    radius, gap = 0.01, 0.01 * share
    annulus = damping.annular_couette(
        dynamic_viscosity=0.03, length=0.1, inner_radius=radius, outer_radius=radius + gap
    )
    flat = damping.flat_gap(dynamic_viscosity=0.03, diameter=2 * radius + gap, length=0.1, gap=gap)
    assert annulus == pytest.approx(flat, rel=1e-6)


def test_secant_has_no_value_at_rest():
    """F/v at v = 0 is NaN, elsewhere F/v with both signs."""
    b = damping.secant(friction=np.array([5.0, 5.0, -5.0]), speed=np.array([0.0, 0.1, -0.1]))
    np.testing.assert_array_equal(b, [np.nan, 50.0, 50.0])


def test_annulus_without_gap_is_nan():
    """A rod as thick as its tube has no annular flow."""
    c = damping.annular_couette(
        dynamic_viscosity=0.03,
        length=0.1,
        inner_radius=np.array([0.01, 0.02, 0.0]),
        outer_radius=0.01,
    )
    assert np.isnan(c).all()


def test_fits_pass_through_constructed_points():
    """B = a v^b through (1 mm/s, 1e6), (10 mm/s, 1e5): a = 1000, b = -1; B(0) = a1 + a2."""
    speeds = np.array([1e-3, 1e-2, 0.0])
    b = damping.power_law(speed=speeds, coefficient=1e3, exponent=-1.0)
    np.testing.assert_allclose(b, [1e6, 1e5, np.nan])
    pair = {"coefficient_1": 2e5, "rate_1": -400.0, "coefficient_2": 5e4, "rate_2": -20.0}
    assert damping.double_exponential(speed=0.0, **pair) == pytest.approx(2.5e5)
    falling = damping.double_exponential(speed=np.linspace(0, 0.02, 30), **pair)
    assert np.all(np.diff(falling) < 0)
