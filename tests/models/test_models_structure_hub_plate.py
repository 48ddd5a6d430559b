"""Caps hung on a skirt or held by a neck, against an independent boundary-value solution."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.integrate import solve_bvp

from actuator_opt.models.end_plate import (
    end_plate_stress,
    hub_plate_stress,
    hung_plate_stress,
    rim_tear_factor,
)


def by_integration(pressure, force, b, a, t, nu):
    """Hub stress from the slope equation (1/r (r f)')' = -Q/D solved numerically.

    Q(r) = shear per length towards the hub: everything outside r, [p pi (a^2 - r^2) + F]/(2 pi r).
    """
    E = 1e10  # any: bending moments do not depend on it; slopes of order one suit the solver
    D = E * t**3 / (12 * (1 - nu**2))

    def shear(r):
        return (pressure * np.pi * (a**2 - r**2) + force) / (2 * np.pi * r)

    def rhs(r, y):  # y0 = slope f, y1 = f'
        return np.vstack([y[1], -y[1] / r + y[0] / r**2 + shear(r) / D])

    def ends(left, right):  # clamped at b; radial moment free at a
        return np.array([left[0], right[1] + nu * right[0] / a])

    r = np.linspace(b, a, 400)
    found = solve_bvp(rhs, ends, r, np.zeros((2, r.size)), tol=1e-7, max_nodes=100000)
    assert found.success
    moment = D * (found.sol(b)[1] + nu * found.sol(b)[0] / b)
    return abs(6 * moment / t**2)


@pytest.mark.parametrize(
    ("pressure", "force", "b", "a"),
    [(1e6, 0.0, 10e-3, 20e-3), (0.0, 5e3, 4e-3, 14e-3), (2e6, 3e3, 5e-3, 25e-3)],
)
def test_hub_plate_equals_the_integrated_plate(pressure, force, b, a):
    """The closed form is the solution of the plate equation, clamped at the hub, free outside."""
    got = hub_plate_stress(
        pressure=pressure,
        edge_force=force,
        hub_radius=b,
        edge_radius=a,
        thickness=3e-3,
        poissons_ratio=0.33,
    )
    assert got == pytest.approx(by_integration(pressure, force, b, a, 3e-3, 0.33), rel=1e-4)


def test_hung_plate_at_the_bore_is_the_simply_supported_plate():
    """With the support at the edge of the pressure it is Timoshenko's uniformly loaded plate."""
    common = {"thickness": 4e-3, "poissons_ratio": 0.3}
    assert hung_plate_stress(
        pressure=2e6, loaded_radius=15e-3, support_radius=15e-3, **common
    ) == pytest.approx(end_plate_stress(pressure=2e6, radius=15e-3, **common), rel=1e-12)


@given(st.floats(1.0, 3.0))
def test_hung_plate_bends_more_the_wider_it_hangs(ratio):
    """Moving the support outwards never relieves the plate."""
    common = {
        "pressure": 1e6,
        "loaded_radius": 10e-3,
        "thickness": 3e-3,
        "poissons_ratio": 0.3,
    }
    near = hung_plate_stress(support_radius=10e-3, **common)
    assert hung_plate_stress(support_radius=ratio * 10e-3, **common) >= near * (1 - 1e-12)


@pytest.mark.parametrize(("force", "low", "high"), [(5924.0, 2.65, 2.7), (7825.0, 2.1, 2.2)])
def test_rim_behind_a_seal_against_plastic_finite_elements(force, low, high):
    """Collapse of cap and head of a knee at a flow stress of 476 MPa, by a second reader."""
    factor = rim_tear_factor(
        force=force,
        groove_radius=9.476e-3,
        skirt_radius=10.1e-3,
        lip_thickness=1.135e-3,
        strength=476e6,
    )
    assert high / 1.11 < factor < low * 1.001


def test_rim_of_a_deep_skirt_is_sheared_and_pulled():
    """Without an arm, pure shear; further inside, also the tension of the annulus."""
    size = {"force": 8000.0, "groove_radius": 9e-3, "lip_thickness": 1e-3, "strength": 500e6}
    shear = 500.0 / 3**0.5 * 2 * pi * 9 * 1 / 8000
    assert rim_tear_factor(skirt_radius=9e-3, **size) == pytest.approx(shear)
    pull = 500.0 * pi * (9**2 - 8.5**2) / 8000
    assert rim_tear_factor(skirt_radius=8.5e-3, **size) == pytest.approx(shear + pull)
