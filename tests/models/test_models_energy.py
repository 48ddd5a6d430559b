"""Claims about elastic energy, bristle rates, contact and gas pressure: what simulations add up."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.integrate import quad, solve_ivp

from actuator_opt.models import accumulator, chamber, lugre

LAWS = [
    {"bulk_modulus": 1.4e9, "slope": 0.0, "air_content": 0.0, "polytropic_index": 1.4},
    {"bulk_modulus": 1.4e9, "slope": 10.8, "air_content": 0.0, "polytropic_index": 1.4},
    {"bulk_modulus": 1.6e9, "slope": 1.0, "air_content": 0.02, "polytropic_index": 1.4},
    {"bulk_modulus": 1.6e9, "slope": 9.0, "air_content": 0.005, "polytropic_index": 1.0},
    {"bulk_modulus": 1.2e9, "slope": 0.0, "air_content": 0.1, "polytropic_index": 1.2},
]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("pressure", [-0.8e5, 3e5, 2e7, 3.5e7])
def test_energy_is_the_work_of_compression(law, pressure):
    """Density times volume is the integral of -p dV of a fixed mass, by quadrature."""

    def volume(p):
        return 1 / chamber.density_ratio(pressure=p, **law)

    if law["air_content"] == 0 and pressure < 0:
        pytest.skip("pure oil in tension")
    split = np.linspace(0.0, pressure, 9)
    work = 0.0
    for low, high in pairwise(split):
        inner, _ = quad(volume, low, high, epsabs=0, epsrel=1e-12)
        work += inner
    work -= pressure * volume(pressure)  # by parts: -int p dV = int V dp - p V
    found = chamber.oil_energy_density(pressure=pressure, **law) * volume(pressure)
    assert found == pytest.approx(work, rel=1e-6, abs=1e-7 * abs(pressure))


def test_stiff_oil_stores_half_the_square():
    """p^2/(2 K) where the oil hardly shrinks; at 140 bar and 1.4 GPa 70 kJ/m^3."""
    found = chamber.oil_energy_density(pressure=140e5, bulk_modulus=1.4e9)
    assert found == pytest.approx(140e5**2 / 2.8e9, rel=5e-3)
    assert found == pytest.approx(1.4e9 * np.expm1(0.01) - 140e5, rel=1e-9)


@given(st.floats(-0.4, 0.4), st.floats(-8e-5, 8e-5))
def test_bristles_move_as_the_exact_step_says(speed, deflection):
    """The rate, integrated at constant speed, is `lugre_step`, and so is the force at the end."""
    law = {"level": 600.0, "bristle_stiffness": 1e7}
    found = solve_ivp(
        lambda _, z: lugre.lugre_rate(deflection=z, speed=speed, **law),
        (0.0, 1e-4), [deflection], rtol=1e-10, atol=1e-14,
    )  # fmt: skip
    step = lugre.lugre_step(
        deflection=deflection, speed=speed, time_step=1e-4, bristle_damping=2e3, viscous=50.0, **law
    )
    end = found.y[0, -1]
    assert end == pytest.approx(step.deflection, rel=1e-7, abs=1e-11)
    force = lugre.lugre_force(
        deflection=end, rate=lugre.lugre_rate(deflection=end, speed=speed, **law), speed=speed,
        bristle_stiffness=1e7, bristle_damping=2e3, viscous=50.0,
    )  # fmt: skip
    assert force == pytest.approx(step.force, rel=1e-6, abs=1e-3)


@given(st.floats(6e6, 3e7), st.floats(1.0, 1.6))
def test_gas_pressure_inverts_the_gas_volume(pressure, index):
    """The pressure at the volume of a pressure is that pressure again."""
    law = {"precharge_pressure": 6e6, "gas_volume": 1e-3, "polytropic_index": index}
    volume = accumulator.gas_volume_at(pressure=pressure, **law)
    assert accumulator.gas_pressure(volume=volume, **law) == pytest.approx(pressure, rel=1e-12)
