"""Claims about forces, flow, lever arms and part masses; all checked by hand arithmetic."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from actuator_opt.models import forces, mass


def test_areas():
    """25/12 mm: 490.87 and 377.78 mm2."""
    assert forces.piston_area(bore=0.025) * 1e6 == pytest.approx(490.874, abs=1e-3)
    area = forces.annulus_area(bore=0.025, rod_diameter=0.012)
    assert area * 1e6 == pytest.approx(490.874 - 113.097, abs=1e-3)
    assert math.isnan(forces.annulus_area(bore=0.01, rod_diameter=0.012))


@given(st.floats(0, 3e7), st.floats(0, 3e7), st.floats(0, 1e3))
def test_push_plus_pull_is_minus_twice_the_friction(pressure_a, pressure_b, friction):
    """With the same pressures push and pull differ by sign and lose the friction twice."""
    state = {
        "pressure_a": pressure_a,
        "pressure_b": pressure_b,
        "area_a": 5e-4,
        "area_b": 4e-4,
        "friction": friction,
    }
    total = forces.push_force(**state) + forces.pull_force(**state)
    assert total == pytest.approx(-2 * friction, abs=1e-8)


def test_push_force_by_hand():
    """10 MPa on 500 mm2 less 0.2 MPa on 400 mm2 less 120 N = 4800 N; 0.96 of 5000 N."""
    state = {"pressure_a": 1e7, "pressure_b": 2e5, "area_a": 5e-4, "area_b": 4e-4}
    force = forces.push_force(friction=120.0, **state)
    assert force == pytest.approx(4800.0)
    assert forces.efficiency(force=force, pressure=1e7, area=5e-4) == pytest.approx(0.96)
    assert math.isnan(forces.efficiency(force=force, pressure=0.0, area=5e-4))


def test_flow_speed_power():
    """Q = A v; P = F v."""
    assert forces.chamber_flow(area=5e-4, speed=0.2) == pytest.approx(1e-4)
    assert forces.power(force=3000.0, speed=0.2) == pytest.approx(600.0)


@given(st.floats(0.1, 3.0), st.floats(0.02, 0.2))
def test_crank_lever_arm_is_the_change_of_length(angle, crank_radius):
    """Virtual work: the lever arm is dL/dphi (central difference); F = M/arm."""
    h = 1e-6
    at = [
        forces.crank(base_radius=0.3, crank_radius=crank_radius, joint_angle=angle + d)
        for d in (-h, 0.0, h)
    ]
    slope = (at[2].length - at[0].length) / (2 * h)
    assert at[1].lever_arm == pytest.approx(slope, rel=1e-6, abs=1e-9)
    torque = 50.0
    force = forces.joint_force(torque=torque, lever_arm=at[1].lever_arm)
    assert force * at[1].lever_arm == pytest.approx(torque)


def test_crank_with_coinciding_pivots_is_nan():
    """Both pivots on one point: no length, no lever."""
    assert math.isnan(forces.crank(base_radius=0.1, crank_radius=0.1, joint_angle=0.0).lever_arm)


def test_masses_by_hand():
    """Steel bar 12 x 150: 133.17 g; ring, disc and tie rods are the same cylinder."""
    bar = mass.tube_mass(density=7850.0, inner_diameter=0.0, outer_diameter=0.012, length=0.15)
    assert bar == pytest.approx(7850 * 113.0973e-6 * 0.15, rel=1e-6)
    assert mass.disc_mass(density=7850.0, diameter=0.012, thickness=0.15) == pytest.approx(bar)
    assert mass.tie_rod_mass(
        density=7850.0, diameter=0.012, length=0.15, count=4.0
    ) == pytest.approx(4 * bar)


@given(st.floats(0.01, 0.1), st.floats(1e-4, 0.05))
def test_a_layer_is_the_ring_between_its_faces(radius, thickness):
    """2 mm around a radius of 10 mm: 44 pi mm2; as the difference of two circles in general."""
    assert mass.layer_area(inner_radius=10.0, thickness=2.0) == pytest.approx(44 * math.pi)
    ring = math.pi * ((radius + thickness) ** 2 - radius**2)
    area = mass.layer_area(inner_radius=radius, thickness=thickness)
    assert area == pytest.approx(ring, rel=1e-9)


@given(st.floats(0.01, 0.1), st.floats(1e-4, 4e-3), st.floats(1e-3, 1e-2))
def test_groove_volumes_are_rings(diameter, depth, width):
    """Outer and inner grooves equal the difference of two cylinders."""
    outer = math.pi / 4 * (diameter**2 - (diameter - 2 * depth) ** 2) * width
    inner = math.pi / 4 * ((diameter + 2 * depth) ** 2 - diameter**2) * width
    groove = {"diameter": diameter, "depth": depth, "width": width}
    assert mass.piston_groove_volume(**groove) == pytest.approx(outer, rel=1e-9)
    assert mass.rod_groove_volume(**groove) == pytest.approx(inner, rel=1e-9)


def test_stud_lies_between_core_and_nominal():
    """M10 x 1.5: pitch diameter 9.026 mm, stress area 57.99 < 63.98 < 78.54 mm2."""
    pitch = mass.pitch_diameter(diameter=10e-3, pitch=1.5e-3)
    assert pitch * 1e3 == pytest.approx(9.026, abs=5e-4)
    area = mass.stud_mass(density=1.0, diameter=10e-3, pitch=1.5e-3, length=1.0)
    assert 57.99e-6 < area < 78.54e-6


def test_eye_is_disc_minus_hole_plus_neck():
    """Lug radius d, thickness d, hole d; neck d x d: (1 - 1/4 + 1/4) pi d^3; pin to neck 2 d."""
    d = 8e-3
    parts = math.pi * d**2 * d - math.pi * d**2 / 4 * d + math.pi * d**2 / 4 * d
    assert mass.eye_volume(pin_diameter=d) == pytest.approx(parts)
    assert mass.eye_length(pin_diameter=d) == 2 * d


def test_neglected_crescent_of_the_eye_is_below_one_percent():
    """Between rim and flat neck end: integral of R - sqrt(R^2 - y^2) over the neck, R = d."""
    y = (np.arange(400) + 0.5) / 400 - 0.5
    width = 2 * np.sqrt(0.25 - y**2)
    crescent = float(np.sum((1 - np.sqrt(1 - y**2)) * width) / 400)
    assert crescent == pytest.approx(math.pi / 128, rel=0.1)
    assert crescent < 0.01 * math.pi


def test_ring_mass_is_pappus():
    """2 mm ring on 23 mm: section times centre line; oil is density times volume."""
    ring = mass.ring_mass(density=1300.0, area=math.pi * 1e-6, centre_diameter=23e-3)
    assert ring == pytest.approx(1300 * (math.pi * 1e-6) * (math.pi * 23e-3))
    assert mass.oil_mass(density=870.0, volume=1e-4) == pytest.approx(0.087)
