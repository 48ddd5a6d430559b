"""Isotropic barrel: growth, stress, burst, compliance, axial load path, growth at the seal."""

from __future__ import annotations

from math import exp, log, pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from actuator_opt.models import barrel, barrel_ends

TUBE = {"inner_radius": 16e-3, "outer_radius": 20e-3}
ALUMINIUM = {"youngs_modulus": 71.7e9, "poissons_ratio": 0.33}
CLOSED = pi * 16e-3**2

walls = st.fixed_dictionaries(
    {"inner_radius": st.floats(5e-3, 0.1), "ratio": st.floats(1.02, 4.0)}
).map(lambda d: {"inner_radius": d["inner_radius"], "outer_radius": d["inner_radius"] * d["ratio"]})


@pytest.mark.parametrize(("area", "growth"), [(0.0, 30.5262e-6), (CLOSED, 26.8606e-6)])
def test_bore_growth_check_values(area, growth):
    """28 MPa in 16/20 mm aluminium: 0.0305262 mm open, 0.0268606 mm closed (independent check)."""
    value = barrel.bore_growth(pressure=28e6, axial_force=28e6 * area, **TUBE, **ALUMINIUM)
    assert value == pytest.approx(growth, rel=2e-6)


@pytest.mark.parametrize(
    ("poisson", "growth"), [(0.49, 5.0399e-3), (0.499, 5.0602e-3), (0.4999, 5.0623e-3)]
)
def test_plane_strain_cylinder_of_macneal_and_harder(poisson, growth):
    """The plane-strain benchmark (E 1000, r 3 to 9, p 1) follows from any axial force N.

    Plane strain: sigma_z = nu (sigma_r + sigma_theta) = 2 nu p/(k^2 - 1) over the annulus.
    """
    force = 2 * poisson / 8 * pi * (81 - 9)
    value = barrel.bore_growth(
        pressure=1.0,
        inner_radius=3.0,
        outer_radius=9.0,
        youngs_modulus=1000.0,
        poissons_ratio=poisson,
        axial_force=force,
    )
    assert value == pytest.approx(growth, rel=2e-5)


@pytest.mark.parametrize(
    ("modulus", "poisson", "thickness", "growth"),
    [(210e9, 0.3, 1.5e-3, 19e-6), (71.7e9, 0.33, 2e-3, 43e-6)],
)
def test_growth_of_metal_barrels(modulus, poisson, thickness, growth):
    """25 mm bore, 35 MPa, open: steel 1.5 mm 19 um, aluminium 2 mm 43 um (independent check)."""
    value = barrel.bore_growth(
        pressure=35e6,
        inner_radius=12.5e-3,
        outer_radius=12.5e-3 + thickness,
        youngs_modulus=modulus,
        poissons_ratio=poisson,
    )
    assert value == pytest.approx(growth, abs=0.5e-6)


def test_published_growth_is_wall_ratio_times_too_large():
    """The printed outer radius over-states the bore growth by exactly k = r_o/r_i."""
    right = barrel.bore_growth(pressure=2e6, **TUBE, **ALUMINIUM)
    printed = barrel.bore_growth_as_published(pressure=2e6, **TUBE, **ALUMINIUM)
    assert printed / right == pytest.approx(20 / 16, rel=1e-14)


def test_bore_stress_check_value():
    """28 MPa in 16/20 mm: hoop stress 127.556 MPa; radial -p; axial p/(k^2 - 1) when closed."""
    hoop, radial, axial = barrel.bore_stresses(pressure=28e6, axial_force=28e6 * CLOSED, **TUBE)
    assert hoop == pytest.approx(127.556e6, rel=4e-6)
    assert radial == -28e6
    assert axial == pytest.approx(28e6 / (1.25**2 - 1), rel=1e-13)


@given(walls, st.floats(1e5, 1e8))
@settings(max_examples=40, deadline=None)
def test_closed_bore_yields_by_shear_difference(wall, pressure):
    """With closed ends sigma_z is the mean of the others, so von Mises = sqrt(3)/2 (s_h - s_r)."""
    force = pressure * pi * wall["inner_radius"] ** 2
    hoop, radial, axial = barrel.bore_stresses(pressure=pressure, axial_force=force, **wall)
    stress = barrel.von_mises(hoop=hoop, radial=radial, axial=axial)
    assert stress == pytest.approx(sqrt(3) / 2 * (hoop - radial), rel=1e-10)


@given(walls, st.floats(0.0, 0.49))
@settings(max_examples=40, deadline=None)
def test_thicker_and_closed_walls_grow_less(wall, poisson):
    """Growth falls with wall thickness and, with any Poisson's ratio, with axial tension."""
    metal = {"youngs_modulus": 2e11, "poissons_ratio": poisson}
    thicker = {**wall, "outer_radius": wall["outer_radius"] * 1.01}
    force = 1e7 * pi * wall["inner_radius"] ** 2
    open_end = barrel.bore_growth(pressure=1e7, **wall, **metal)
    assert barrel.bore_growth(pressure=1e7, **thicker, **metal) < open_end
    assert barrel.bore_growth(pressure=1e7, axial_force=force, **wall, **metal) <= open_end


def test_no_wall_is_nan_not_an_error():
    """A wall ratio of one or less inside an array gives NaN there and values elsewhere."""
    outer = np.array([20e-3, 16e-3, 15e-3])
    growth = barrel.bore_growth(pressure=1e6, inner_radius=16e-3, outer_radius=outer, **ALUMINIUM)
    assert np.isnan(growth).tolist() == [False, True, True]
    burst = barrel.burst_pressure_thick(
        inner_radius=16e-3, outer_radius=outer, yield_strength=3e8, ultimate_strength=4e8
    )
    assert np.isnan(burst).tolist() == [False, True, True]


def test_burst_limits():
    """Faupel's closed tube, and the thin-wall von Mises limit for open ends.

    No hardening (s_y = s_u) leaves the fully plastic tube: 2/sqrt(3) s ln k closed; open and thin
    is s t/r, since plane-stress yield with no axial stress is at s.
    """
    closed = barrel.burst_pressure_thick(
        inner_radius=1.0, outer_radius=2.0, yield_strength=3e8, ultimate_strength=3e8
    )
    assert closed == pytest.approx(2 / sqrt(3) * 3e8 * log(2), rel=1e-13)
    opened = barrel.burst_pressure_thick(
        inner_radius=1.0,
        outer_radius=1.0001,
        yield_strength=3e8,
        ultimate_strength=3e8,
        axial_force_ratio=0.0,
    )
    assert opened == pytest.approx(3e8 * 1e-4, rel=1e-4)


def test_chamber_compliance_and_stiffness():
    """The 180 mm chamber of the check gives 19.7282 mm^3/MPa; k = A^2/(dV/dp)."""
    growth = barrel.bore_growth(pressure=1.0, **TUBE, **ALUMINIUM)
    compliance = barrel.chamber_compliance(
        inner_radius=16e-3, growth_per_pressure=growth, length=0.18
    )
    assert compliance == pytest.approx(19.7282e-15, rel=3e-6)
    area = pi * 16e-3**2
    assert barrel.barrel_stiffness(area=area, compliance=compliance) == area**2 / compliance


@pytest.mark.parametrize(("closed", "ratio"), [(False, 1.293425), (True, 1.249764)])
def test_wall_ratio_check_values(closed, ratio):
    """25 MPa, strain 0.0015: k = 1.293425 open, 1.249764 closed; the growth then fits."""
    value = barrel.wall_ratio_for_strain(strain=0.0015, pressure=25e6, closed=closed, **ALUMINIUM)
    assert value == pytest.approx(ratio, rel=1e-6)
    growth = barrel.bore_growth(
        pressure=25e6,
        inner_radius=1.0,
        outer_radius=value,
        axial_force=25e6 * pi if closed else 0.0,
        **ALUMINIUM,
    )
    assert growth == pytest.approx(0.0015, rel=1e-12)


def test_unreachable_strain_raises():
    """Where even an infinite wall grows more, the inverse says so."""
    with pytest.raises(ValueError, match="no wall is thick enough"):
        barrel.wall_ratio_for_strain(strain=4e-4, pressure=25e6, closed=False, **ALUMINIUM)


@pytest.mark.parametrize(("distance", "factor"), [(-3e-3, 0.167744), (0.0, 0.5), (3e-3, 0.832256)])
def test_pressure_step_check_values(distance, factor):
    """The factor at -3, 0, +3 mm with a decay length of 3.92005 mm (R 16.75, t 1.5, nu 0.33)."""
    value = barrel_ends.pressure_step_factor(distance=distance, decay_length=3.92005e-3)
    assert value == pytest.approx(factor, abs=1e-6)


def test_decay_of_a_layered_wall_of_one_layer():
    """With E_theta t and D_z of a homogeneous wall the shell form is the orthotropic one."""
    radius, thickness, product = 16.75e-3, 1.5e-3, 0.33**2
    value = barrel_ends.shell_decay_length(
        radius=radius,
        hoop_stiffness=71.7e9 * thickness,
        bending_stiffness=71.7e9 * thickness**3 / (12 * (1 - product)),
    )
    assert value == pytest.approx(sqrt(radius * thickness) / (3 * (1 - product)) ** 0.25, rel=1e-12)


@given(st.floats(-0.2, 0.2))
def test_pressure_step_factor_bounds(distance):
    """The factor is antisymmetric about one half and overshoots by at most 3.4 %.

    The extreme of exp(-z) cos(z)/2 lies at z = 3 pi/4: exp(-3 pi/4) sqrt(2)/4 = 0.0335.
    """
    ahead = barrel_ends.pressure_step_factor(distance=distance, decay_length=4e-3)
    behind = barrel_ends.pressure_step_factor(distance=-distance, decay_length=4e-3)
    peak = exp(-3 * pi / 4) * sqrt(2) / 4
    assert ahead + behind == pytest.approx(1.0, abs=1e-14)
    assert -peak - 1e-12 <= ahead <= 1 + peak + 1e-12


def test_axial_load_path():
    """The mounting decides the wall's axial force: p_B A_B with the stop force, or p_A A_A."""
    force = barrel_ends.axial_force_cap_mounted(
        rod_side_pressure=20e6, rod_side_area=3e-4, stop_force=500.0
    )
    assert force == pytest.approx(6500.0)
    force = barrel_ends.axial_force_head_mounted(cap_side_pressure=20e6, cap_side_area=5e-4)
    assert force == pytest.approx(10e3)


def test_tie_rod_check_value_and_balance():
    """N 12 kN, F0 9 kN, 300/90 N/um, 3 um: opens at +438.5 N, the rods carry 11 561.5 N."""
    forces = barrel_ends.tie_rod_forces(
        axial_force=12e3,
        preload=9e3,
        barrel_stiffness=300e6,
        tie_rod_stiffness=90e6,
        free_shortening=3e-6,
    )
    assert forces[0] == pytest.approx(438.5, abs=0.05)
    assert forces[1] == pytest.approx(11561.5, abs=0.05)
    assert sum(forces) == pytest.approx(12e3, rel=1e-14)


def test_pressure_shortens_the_barrel():
    """The free shortening is nu (sigma_r + sigma_theta)/E over the length."""
    value = barrel_ends.pressure_shortening(pressure=28e6, length=0.18, **TUBE, **ALUMINIUM)
    hoop, radial, _ = barrel.bore_stresses(pressure=28e6, **TUBE)
    assert value == pytest.approx(0.33 * (hoop + radial) / 71.7e9 * 0.18, rel=1e-13)


def test_preload_change_by_two_springs():
    """Four rods of 5 mm steel: the worked number, and equal forces in rods and barrel."""
    sizes = {"barrel_length": 126e-3, "plate_thickness": 7e-3, "tie_rod_length": 140e-3}
    springs = {"barrel_stiffness": 39.6825e6, "tie_rod_stiffness": 115.566e6}
    change = barrel_ends.preload_change(
        temperature_change=40.0, barrel_expansion=20e-6, plate_expansion=23.6e-6,
        tie_rod_expansion=11.5e-6, **sizes, **springs,
    )  # fmt: skip
    assert change == pytest.approx(1465.63, rel=1e-5)
    gap = 40 * (20e-6 * 126e-3 + 2 * 23.6e-6 * 7e-3 - 11.5e-6 * 140e-3)
    assert sum(change / stiffness for stiffness in springs.values()) == pytest.approx(gap)
