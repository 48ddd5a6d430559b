"""Claims about lines and lumped elements."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from actuator_opt.models import elements, lines

LINE = {"inner_diameter": 8e-3, "length": 1.2}


def test_lumped_line_check_values():
    """R, L, C, resonance, quarter wave and speed of sound of an 8 mm line, independent values."""
    volume = lines.line_volume(**LINE)
    inertance = elements.inertance(**LINE, density=865.0)
    capacitance = elements.capacitance(volume=volume, bulk_modulus=1.4e9)
    speed = elements.sound_speed(bulk_modulus=1.4e9, density=865.0)
    assert elements.resistance(**LINE, dynamic_viscosity=0.04) == pytest.approx(4.77465e8, rel=2e-6)
    assert inertance == pytest.approx(2.06504e7, rel=3e-6)
    assert capacitance == pytest.approx(4.30847e-14, rel=2e-6)
    resonance = elements.resonance_frequency(inertance=inertance, capacitance=capacitance)
    assert resonance == pytest.approx(168.731, rel=3e-6)
    assert speed == pytest.approx(1272.20, rel=3e-6)
    wave = elements.quarter_wave_frequency(length=1.2, sound_speed=speed)
    assert wave == pytest.approx(265.042, rel=3e-6)


def test_helmholtz_check_value():
    """0.1 l behind a neck of 8 x 300 mm resonates at 262.090 Hz."""
    neck = elements.inertance(inner_diameter=8e-3, length=0.3, density=865.0)
    volume = elements.capacitance(volume=1e-4, bulk_modulus=1.4e9)
    frequency = elements.resonance_frequency(inertance=neck, capacitance=volume)
    assert frequency == pytest.approx(262.090, rel=3e-6)


def test_quarter_wave_of_the_thesis():
    """[AaltoThesis]: 20 Hz at 1300 m/s needs 16.25 m."""
    assert elements.quarter_wave_frequency(length=16.25, sound_speed=1300.0) == pytest.approx(20.0)


def test_line_compliance_is_the_open_lame_tube():
    """16/20 mm aluminium, 180 mm: 19.7282 mm3/MPa (barrel check value)."""
    compliance = lines.line_compliance(
        inner_diameter=0.032,
        outer_diameter=0.040,
        length=0.18,
        youngs_modulus=71.7e9,
        poissons_ratio=0.33,
    )
    assert compliance * 1e15 == pytest.approx(19.7282, rel=3e-6)


def test_line_without_wall_is_nan():
    """An outer diameter not above the inner one has no compliance."""
    compliance = lines.line_compliance(
        inner_diameter=0.01,
        outer_diameter=np.array([0.01, 0.009, 0.012]),
        length=1.0,
        youngs_modulus=2e11,
        poissons_ratio=0.3,
    )
    np.testing.assert_array_equal(np.isnan(compliance), [True, True, False])


def drop(flow):
    """Pressure drop of the line for an oil of 0.01 Pa s."""
    return lines.line_pressure_drop(flow=flow, **LINE, density=865.0, dynamic_viscosity=0.01)


def flow_at(reynolds: float) -> float:
    """Flow that gives a Reynolds number in that line."""
    return reynolds * math.pi * 8e-3 * 0.01 / (4 * 865.0)


def test_pressure_drop_is_hagen_poiseuille_when_laminar():
    """Up to Re 2300 the drop is R q exactly."""
    for number in (1.0, 500.0, 2300.0):
        q = flow_at(number)
        assert drop(q) == pytest.approx(
            elements.resistance(**LINE, dynamic_viscosity=0.01) * q, rel=1e-12
        )


def test_pressure_drop_is_blasius_when_turbulent():
    """From Re 4000 the drop is f (l/d) rho v^2/2, f = 0.3164 Re^-0.25."""
    for number in (4000.0, 3e4):
        q = flow_at(number)
        v = lines.line_velocity(flow=q, inner_diameter=8e-3)
        nu = 0.01 / 865.0
        re = lines.reynolds(velocity=v, diameter=8e-3, kinematic_viscosity=nu)
        assert re == pytest.approx(number)
        expected = 0.3164 * number**-0.25 * (1.2 / 8e-3) * 865.0 * v * v / 2
        assert drop(q) == pytest.approx(expected, rel=1e-12)


def test_fittings_lose_their_share_of_the_dynamic_pressure():
    """At 4 m/s and 850 kg/m^3 the dynamic pressure is 6800 Pa; 2.5 of it are lost."""
    flow = 4.0 * math.pi / 4 * 8e-3**2
    fittings = {"inner_diameter": 8e-3, "loss_coefficient": 2.5, "density": 850.0}
    assert lines.fitting_pressure_drop(flow=flow, **fittings) == pytest.approx(17e3, rel=1e-12)
    assert lines.fitting_pressure_drop(flow=-flow, **fittings) == pytest.approx(-17e3, rel=1e-12)


@given(st.floats(1, 9e4), st.floats(1.0001, 1.5))
def test_pressure_drop_grows_with_flow_and_is_odd(number, factor):
    """More flow, more drop, also through the blend; reversed flow reverses it."""
    q = flow_at(number)
    assert drop(q * factor) > drop(q)
    assert drop(-q) == -drop(q)


@pytest.mark.parametrize("number", [2300.0, 4000.0])
def test_pressure_drop_is_smooth_at_the_ends_of_the_blend(number):
    """Slopes from both sides agree where the blend begins and ends."""
    q, h = flow_at(number), flow_at(number) * 1e-5
    below, above = (drop(q) - drop(q - h)) / h, (drop(q + h) - drop(q)) / h
    assert above == pytest.approx(below, rel=2e-4)


def test_port_velocity_is_continuity():
    """10 l/min through 6 mm is 5.895 m/s: q/A by hand."""
    v = lines.port_velocity(flow=10 / 60000, port_diameter=6e-3)
    assert v == pytest.approx((10 / 60000) / (math.pi * 9e-6))
