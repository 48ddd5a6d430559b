"""Films, layers, air and tank: published values, worked numbers, limits and slopes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.integrate import quad

from actuator_opt.base.numeric import STEP
from actuator_opt.models import heat_transfer

OIL = {"density": 870.0, "specific_heat": 1900.0}
SIX_DIGITS = {"rel": 5e-6}


@pytest.mark.parametrize(
    ("temperature", "viscosity", "conductivity"),
    # air at atmospheric pressure, Incropera and DeWitt, Fundamentals of Heat and Mass Transfer, A.4
    [(250.0, 159.6e-7, 22.3e-3), (300.0, 184.6e-7, 26.3e-3), (400.0, 230.1e-7, 33.8e-3)],
)
def test_air_of_a_second_table(temperature, viscosity, conductivity):
    """Another table of air agrees within 2 %."""
    air = heat_transfer.air_properties(temperature=temperature)
    assert air.dynamic_viscosity == pytest.approx(viscosity, rel=2e-2)
    assert air.conductivity == pytest.approx(conductivity, rel=2e-2)
    assert 0.68 < air.prandtl_number < 0.74


def test_air_of_the_standard_atmosphere():
    """Sea level, 288.15 K: 1.2250 kg/m3, 1.7894e-5 Pa s, 2.5326e-2 W/mK of the published table."""
    air = heat_transfer.air_properties(temperature=288.15)
    assert air[:3] == pytest.approx((1.2250, 1.7894e-5, 2.5326e-2), rel=3e-5)


def test_air_at_no_temperature_is_nan():
    """Zero and negative temperatures have no properties; the others keep theirs."""
    air = heat_transfer.air_properties(temperature=np.array([-1.0, 0.0, 300.0]))
    assert np.isnan(air.density).tolist() == [True, True, False]


def test_oil_film_of_the_worked_example():
    """Hausen: 249.008 W/m2K at 0.13 m/s, 20.687 at rest; written out with Re, Pr and viscosity."""
    film = {"diameter": 23e-3, "length": 55e-3, "conductivity": 0.13, **OIL}
    moving = heat_transfer.oil_film_coefficient(speed=0.13, **film)
    assert moving == pytest.approx(249.008, **SIX_DIGITS)
    assert heat_transfer.oil_film_coefficient(speed=0.0, **film) == pytest.approx(20.687, 2e-5)
    reynolds, prandtl = 0.13 * 23e-3 / 32e-6, 32e-6 * 870.0 * 1900.0 / 0.13
    graetz = reynolds * prandtl * 23 / 55
    nusselt = 3.66 + 0.0668 * graetz / (1 + 0.04 * graetz ** (2 / 3))
    assert moving == pytest.approx(nusselt * 0.13 / 23e-3, rel=1e-13)


def test_laminar_film_at_rest_and_backwards():
    """No flow: 3.66 with the finite slope 0.0668; a negative Graetz number has no answer."""
    numbers = np.array([0.0, -1.0]) + 1j * STEP
    nusselt = heat_transfer.laminar_nusselt(graetz_number=numbers)
    assert nusselt[0].real == 3.66
    assert nusselt[0].imag / STEP == pytest.approx(0.0668)
    assert np.isnan(nusselt[1])
    graetz = np.geomspace(1e6, 1e9, 4)
    entry = heat_transfer.laminar_nusselt(graetz_number=graetz) / (1.67 * np.cbrt(graetz))
    assert abs(entry[-1] - 1) < abs(entry[0] - 1)
    assert entry[-1] == pytest.approx(1.0, rel=5e-3)  # 0.0668/0.04 Gz^(1/3) of the thermal entry


def test_air_film_of_the_worked_example():
    """28.2 mm at 60 degC in air of 20 degC: 6.82010 free, 35.4748 in 3 m/s, 6.29418 radiation."""
    state = {"surface_temperature": 333.15, "ambient_temperature": 293.15}
    free = heat_transfer.convection_coefficient(diameter=28.2e-3, **state)
    wind = heat_transfer.convection_coefficient(diameter=28.2e-3, air_speed=3.0, **state)
    radiation = heat_transfer.radiation_coefficient(emissivity=0.9, **state)
    assert free == pytest.approx(6.82010, **SIX_DIGITS)
    assert wind == pytest.approx(35.4748, **SIX_DIGITS)
    assert radiation == pytest.approx(6.29418, **SIX_DIGITS)
    resistance = heat_transfer.film_resistance(
        film_coefficient=free + radiation, area=math.pi * 28.2e-3 * 0.138
    )
    assert resistance == pytest.approx(6.23703, **SIX_DIGITS)


def test_nusselt_numbers_of_cylinders_lie_on_the_published_branches():
    """Free: laminar about 0.53 Ra^(1/4) [air]; forced: Hilpert's 0.193 Re^0.618 from 4e3 to 4e4."""
    rayleigh = np.geomspace(1e5, 1e7, 5)
    free = heat_transfer.free_convection_nusselt(rayleigh_number=rayleigh, prandtl_number=0.71)
    np.testing.assert_allclose(free, 0.48 * rayleigh**0.25, rtol=0.15)  # Morgan, 1e4 to 1e7
    reynolds = np.geomspace(4e3, 4e4, 5)
    forced = heat_transfer.cross_flow_nusselt(reynolds_number=reynolds, prandtl_number=0.71)
    np.testing.assert_allclose(forced, 0.193 * 0.71 ** (1 / 3) * reynolds**0.618, rtol=0.15)


def test_films_where_nothing_moves():
    """No difference, no wind: the film is finite, and so is its slope over temperature and wind."""
    start = np.array([293.15 + 1j * STEP, 293.15])
    wind = np.array([0.0, 1j * STEP])
    film = heat_transfer.convection_coefficient(
        surface_temperature=start, ambient_temperature=293.15, diameter=28e-3, air_speed=wind
    )
    assert np.isfinite(film).all()
    assert (film.real > 0.36 * 0.025 / 28e-3).all()  # the limit of Ra = 0
    assert heat_transfer.cross_flow_nusselt(reynolds_number=0.0, prandtl_number=0.7) == 0.3
    assert np.isnan(heat_transfer.cross_flow_nusselt(reynolds_number=-1.0, prandtl_number=0.7))


@given(st.floats(230.0, 420.0), st.floats(5e-3, 0.2), st.floats(0.0, 20.0))
def test_air_film_is_the_larger_of_both_and_blind_to_the_sign_of_the_wind(surface, size, wind):
    """Wind never cools less than still air; wind from either side cools alike."""

    def film(speed):
        return heat_transfer.convection_coefficient(
            surface_temperature=surface, ambient_temperature=293.15, diameter=size, air_speed=speed
        )

    assert film(wind) >= film(0.0)
    assert film(wind) == film(-wind)


@given(st.floats(0.05, 1.0), st.floats(220.0, 500.0), st.floats(220.0, 330.0))
def test_radiation_is_the_difference_of_fourth_powers(emissivity, surface, ambient):
    """The heat flux h (T_s - T_a) = eps sigma (T_s^4 - T_a^4)."""
    film = heat_transfer.radiation_coefficient(
        emissivity=emissivity, surface_temperature=surface, ambient_temperature=ambient
    )
    flux = emissivity * 5.670374419e-8 * (surface**4 - ambient**4)
    assert film * (surface - ambient) == pytest.approx(flux, rel=1e-9, abs=1e-9)


def test_layers_of_the_worked_example():
    """0.6 mm aluminium, 1.2 and 0.8 mm laminate over 138 mm: 4.51191e-4, 0.181757, 0.112275 K/W."""
    radii = (11.5e-3, 12.1e-3, 13.3e-3, 14.1e-3)
    expected = (4.51191e-4, 0.181757, 0.112275)
    total = 0.0
    for inner, outer, k, value in zip(radii, radii[1:], (130.0, 0.6, 0.6), expected, strict=False):
        found = heat_transfer.layer_resistance(
            inner_radius=inner, outer_radius=outer, length=0.138, conductivity=k
        )
        assert found == pytest.approx(value, **SIX_DIGITS)
        integral, _ = quad(lambda r, k=k: 1 / (2 * math.pi * r * 0.138 * k), inner, outer)
        assert found == pytest.approx(integral, rel=1e-10)
        total += found
    assert total == pytest.approx(0.294483, **SIX_DIGITS)


def test_throttle_of_the_worked_example():
    """175 bar heat oil by 10.5868 K from tank to tank, by 8.26613 K across the throttle itself."""
    rise = heat_transfer.throttle_temperature_rise(pressure_drop=175e5, **OIL)
    alone = heat_transfer.throttle_temperature_rise(
        pressure_drop=175e5, volume_expansion=7e-4, temperature=313.15, **OIL
    )
    assert rise == pytest.approx(10.5868, **SIX_DIGITS)
    assert alone == pytest.approx(8.26613, **SIX_DIGITS)
    flow = 3e-5  # the power of the throttled flow heats that flow
    heat = heat_transfer.oil_exchange_conductance(exchange_flow=flow, **OIL) * rise
    assert heat == pytest.approx(175e5 * flow, rel=1e-13)


def test_a_line_longer_than_the_stroke_exchanges_nothing():
    """4 cm2 by 60 mm bring 24 ml less the line; exactly 0 from 24 ml on."""
    volumes = heat_transfer.exchanged_volume(
        piston_area=4e-4, travel=60e-3, line_volume=np.array([0.0, 10e-6, 24e-6, 1e-3])
    )
    np.testing.assert_allclose(volumes, [24e-6, 14e-6, 0.0, 0.0], atol=1e-20)


@given(st.floats(0.0, 1e3), st.floats(0.0, 1e3), st.booleans())
def test_friction_heat_is_split_without_loss(piston, rod, in_oil):
    """All heat goes somewhere; half the rod seal's to the rod, or all to the oil."""
    heat = heat_transfer.friction_heat(piston_seal=piston, rod_seal=rod, in_oil=in_oil)
    assert sum(heat) == pytest.approx(piston + rod, rel=1e-14)
    assert heat == ((piston + rod, 0, 0, 0) if in_oil else (0, piston, rod / 2, rod / 2))
