"""Claims about a closed cylinder with a constant mass of air in each chamber."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, strategies as st

from actuator_opt.models import forces, stiffness
from actuator_opt.models.fluid import ATMOSPHERIC_PRESSURE

A2 = forces.piston_area(bore=0.032)
B2 = forces.annulus_area(bore=0.032, rod_diameter=0.018)


def volume_change(*, volume, air_volume, pressure, initial_pressure):
    """Change of liquid at constant K beside a polytropic gas of constant mass."""
    now, before = (
        (ATMOSPHERIC_PRESSURE / (p + ATMOSPHERIC_PRESSURE)) ** (1 / 1.4)
        for p in (pressure, initial_pressure)
    )
    liquid = (volume - air_volume) * (pressure - initial_pressure) / 1.5e9
    return air_volume * (now - before) - liquid


def test_trapped_air_check_value():
    """32/18-160 at 80 mm, 0.2/0.1 ml air, pull 2 kN: 0.110162 mm, 6.6294 and 46.0761 bar."""
    step = stiffness.trapped_air_load_step(
        force=-2000.0,
        area_a=A2,
        area_b=B2,
        volume_a=A2 * 0.08 + 8e-6,
        volume_b=B2 * 0.08 + 8e-6,
        air_volume_a=0.2e-6,
        air_volume_b=0.1e-6,
        initial_pressure_a=20e5,
        initial_pressure_b=20e5 * A2 / B2,
        bulk_modulus=1.5e9,
        atmospheric_pressure=1.013e5,
    )
    assert step.displacement * 1e3 == pytest.approx(0.110162, rel=1e-5)
    assert step.pressure_a / 1e5 == pytest.approx(6.6294, abs=6e-5)
    assert step.pressure_b / 1e5 == pytest.approx(46.0761, abs=6e-5)
    assert step.stiffness == pytest.approx(2000 / 0.110162e-3, rel=1e-5)


@given(st.floats(-8000, 8000), st.floats(0, 1e-6), st.floats(0, 1e-6), st.floats(1e5, 1e7))
def test_trapped_air_step_solves_its_three_equations(force, air_a, air_b, pressure):
    """Volumes and forces balance to rounding, or the answer is NaN (cavitation)."""
    start = {"a": pressure, "b": pressure * A2 / B2}
    volume = {"a": A2 * 0.08 + 8e-6, "b": B2 * 0.08 + 8e-6}
    step = stiffness.trapped_air_load_step(
        force=force,
        area_a=A2,
        area_b=B2,
        volume_a=volume["a"],
        volume_b=volume["b"],
        air_volume_a=air_a,
        air_volume_b=air_b,
        initial_pressure_a=start["a"],
        initial_pressure_b=start["b"],
        bulk_modulus=1.5e9,
    )
    if math.isnan(step.displacement):
        return
    for side, air, p, move in (
        ("a", air_a, step.pressure_a, A2 * step.displacement),
        ("b", air_b, step.pressure_b, -B2 * step.displacement),
    ):
        change = volume_change(
            volume=volume[side], air_volume=air, pressure=p, initial_pressure=start[side]
        )
        assert change == pytest.approx(move, rel=1e-7, abs=1e-16)
    balance = (step.pressure_a - start["a"]) * A2 - (step.pressure_b - start["b"]) * B2
    assert balance == pytest.approx(force, abs=1e-5)


def test_trapped_air_without_air_is_the_rigid_oil_spring():
    """No air: the secant stiffness is K (A_A^2/V_A + A_B^2/V_B)."""
    v_a, v_b = A2 * 0.08 + 8e-6, B2 * 0.08 + 8e-6
    step = stiffness.trapped_air_load_step(
        force=500.0,
        area_a=A2,
        area_b=B2,
        volume_a=v_a,
        volume_b=v_b,
        air_volume_a=0.0,
        air_volume_b=0.0,
        initial_pressure_a=50e5,
        initial_pressure_b=60e5,
        bulk_modulus=1.5e9,
    )
    assert step.stiffness == pytest.approx(1.5e9 * (A2**2 / v_a + B2**2 / v_b), rel=1e-9)


def test_trapped_air_reports_cavitation_as_nan():
    """A pull no closed chamber can carry has no answer."""
    step = stiffness.trapped_air_load_step(
        force=-1e6,
        area_a=A2,
        area_b=B2,
        volume_a=7e-5,
        volume_b=7e-5,
        air_volume_a=0.0,
        air_volume_b=0.0,
        initial_pressure_a=20e5,
        initial_pressure_b=20e5,
        bulk_modulus=1.5e9,
    )
    assert math.isnan(step.displacement)
    assert math.isnan(step.stiffness)
