"""Caps hung on a skirt or held by a neck, against an independent boundary-value solution."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.integrate import solve_bvp

from actuator_opt.models.end_plate import end_plate_stress, hub_plate_stress, hung_plate_stress


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
