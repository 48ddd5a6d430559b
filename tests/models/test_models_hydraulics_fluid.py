"""Claims about the fluid models; expected values from published curves and hand derivations."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from actuator_opt.models import fluid, oil_laws

CELSIUS = 273.15


def two_point_d341(a: float, b: float, celsius: float) -> float:
    """Kinematic viscosity (m2/s) from printed A, B of log10 log10(nu + 0.7) = A - B log10 T."""
    return 1e-6 * (10 ** (10 ** (a - b * math.log10(celsius + CELSIUS))) - 0.7)


GRADES = {
    "VG32": (9.58029, 3.76640, {0: 341.36, 20: 86.79, 60: 15.13, 100: 5.36}),
    "VG46": (9.45549, 3.69946, {0: 584.93, 20: 134.49, 60: 20.56, 100: 6.76}),
    "VG68": (9.28859, 3.61594, {0: 1024.93, 20: 214.12, 60: 28.71, 100: 8.73}),
}


@pytest.mark.parametrize("grade", GRADES)
def test_astm_d341_reproduces_iso_grades(grade):
    """Two points (40 and 100 degC) of a VI 100 oil reproduce its whole published D341 curve."""
    a, b, curve = GRADES[grade]
    points = (40.0, 100.0)
    for celsius, expected in curve.items():
        nu = fluid.viscosity_astm_d341(
            temperature=celsius + CELSIUS,
            points_temperature=tuple(t + CELSIUS for t in points),
            points_viscosity=tuple(two_point_d341(a, b, t) for t in points),
        )
        assert nu * 1e6 == pytest.approx(expected, rel=3e-4, abs=0.0051)


def test_astm_d341_two_points_miss_the_cold_of_a_multigrade_fluid():
    """MIL-PRF-5606 from 40/100 degC alone gives 214 mm2/s at -40 degC; a third point gives 600."""
    temps, values = (40 + CELSIUS, 100 + CELSIUS), (13.2e-6, 4.9e-6)
    cold = CELSIUS - 40
    two = fluid.viscosity_astm_d341(
        temperature=cold, points_temperature=temps, points_viscosity=values
    )
    three = fluid.viscosity_astm_d341(
        temperature=cold, points_temperature=(cold, *temps), points_viscosity=(600e-6, *values)
    )
    assert two * 1e6 == pytest.approx(214, abs=0.5)
    assert three * 1e6 == pytest.approx(600, rel=1e-12)


def test_astm_d341_passes_through_every_point_and_is_continuous():
    """Piecewise between neighbours: exact at each point, no jump across the middle one."""
    temps, values = (233.15, 313.15, 373.15), (600e-6, 13.2e-6, 4.9e-6)
    at = np.array([*temps, 313.15 - 1e-9, 313.15 + 1e-9])
    nu = fluid.viscosity_astm_d341(
        temperature=at, points_temperature=temps, points_viscosity=values
    )
    np.testing.assert_allclose(nu[:3], values, rtol=1e-12)
    np.testing.assert_allclose(nu[3:], values[1], rtol=1e-9)


@pytest.mark.parametrize("temps", [(313.15,), (313.15, 373.15, 400.0)])
def test_astm_d341_needs_matching_points(temps):
    """One point, or unequal lists, are refused."""
    with pytest.raises(ValueError, match="two or more"):
        fluid.viscosity_astm_d341(
            temperature=300.0, points_temperature=temps, points_viscosity=(1e-5, 5e-6)[: len(temps)]
        )


def test_astm_d341_below_absolute_zero_is_nan():
    """A temperature of 0 K or less has no viscosity."""
    nu = fluid.viscosity_astm_d341(
        temperature=np.array([-1.0, 313.15]),
        points_temperature=(313.15, 373.15),
        points_viscosity=(32e-6, 5.36e-6),
    )
    assert np.isnan(nu[0])
    assert nu[1] == pytest.approx(32e-6)


@given(st.floats(230, 420), st.floats(0.5, 60))
def test_astm_d341_falls_with_temperature(temperature, step):
    """A warmer oil is never thicker."""
    points = {"points_temperature": (313.15, 373.15), "points_viscosity": (32e-6, 5.36e-6)}
    assert fluid.viscosity_astm_d341(
        temperature=temperature + step, **points
    ) < fluid.viscosity_astm_d341(temperature=temperature, **points)


@pytest.mark.parametrize(
    ("viscosity", "coefficient", "pressure", "expected_roelands", "expected_barus"),
    [(0.0186, 20e-9, 30e6, 0.0334492, 0.0338914), (0.040, 18e-9, 20e6, 0.0568883, 0.0573332)],
)
def test_viscosity_under_pressure(
    viscosity, coefficient, pressure, expected_roelands, expected_barus
):
    """Roelands and Barus check values, computed independently from the printed equations."""
    arguments = {"viscosity": viscosity, "coefficient": coefficient, "pressure": pressure}
    assert fluid.roelands(**arguments) == pytest.approx(expected_roelands, rel=2e-6)
    assert fluid.barus(**arguments) == pytest.approx(expected_barus, rel=2e-6)


@given(st.floats(0.003, 0.5), st.floats(5e-9, 35e-9))
def test_roelands_tends_to_barus(viscosity, coefficient):
    """At small pressure Roelands has the slope alpha of Barus."""
    arguments = {"viscosity": viscosity, "coefficient": coefficient, "pressure": 1e4}
    # p0 = 1.96e8 and 5.1e-9 differ from exact reciprocals by 4e-4
    gain = fluid.roelands(**arguments) / viscosity - 1
    assert gain == pytest.approx(coefficient * 1e4, rel=1e-3)


def test_roelands_outside_its_domain_is_nan():
    """A liquid with ln eta0 + 9.67 <= 0 (below 6.3e-5 Pa s) has no Roelands law."""
    eta = fluid.roelands(viscosity=np.array([5e-5, 0.02]), pressure=1e6, coefficient=1e-8)
    assert np.isnan(eta[0])
    assert eta[1] > 0.02


@given(st.floats(0.003, 0.5), st.floats(5e-9, 35e-9), st.floats(0, 9e8), st.floats(1e5, 1e8))
def test_roelands_rises_with_pressure_and_below_barus(viscosity, coefficient, pressure, step):
    """More pressure is never thinner; below Z = 1 the growth stays under the exponential."""
    arguments = {"viscosity": viscosity, "coefficient": coefficient}
    low = fluid.roelands(pressure=pressure, **arguments)
    assert fluid.roelands(pressure=pressure + step, **arguments) > low
    if coefficient / (5.1e-9 * (math.log(viscosity) + 9.67)) < 0.99:
        # p0 = 1.96e8 and 5.1e-9 differ from exact reciprocals by 4e-4
        assert math.log(low / viscosity) <= 1.0005 * coefficient * pressure + 1e-12


WATER = {0: 611.2, 20: 2339.3, 40: 7384.9, 60: 19947.0, 80: 47414.0}
"""Saturation pressure of water (Pa) over temperature (degC), steam tables."""


def test_vapour_pressure_lies_between_its_points_as_in_steam_tables():
    """Water at 10, 30, 50 and 70 degC from points 20 K apart: 1.228, 4.247, 12.352, 31.20 kPa."""
    points = {
        "points_temperature": [t + CELSIUS for t in WATER], "points_pressure": list(WATER.values()),
    }  # fmt: skip
    for celsius, expected in ((10, 1228.2), (30, 4247.0), (50, 12352.0), (70, 31202.0)):
        found = fluid.vapour_pressure(temperature=celsius + CELSIUS, **points)
        assert found == pytest.approx(expected, rel=4e-3)
    at = np.array(list(WATER)) + CELSIUS
    np.testing.assert_allclose(fluid.vapour_pressure(temperature=at, **points), [*WATER.values()])
    rising = fluid.vapour_pressure(temperature=np.linspace(230, 400, 99), **points)
    assert (np.diff(rising) > 0).all()
    assert math.isnan(fluid.vapour_pressure(temperature=0.0, **points))
    with pytest.raises(ValueError, match="two or more"):
        fluid.vapour_pressure(temperature=300.0, points_temperature=[300.0], points_pressure=[1e3])


def test_density_compressed_has_the_bulk_modulus_it_is_made_of():
    """Closed form rho0 (1 + m p/K0)^(1/m), its limit rho0 exp(p/K0), and K = rho dp/drho."""
    k0, m, p = 1.4e9, 10.8, 300e5
    found = oil_laws.density_compressed(
        reference_density=870.0, pressure=p, bulk_modulus=k0, slope=m
    )
    assert found == pytest.approx(870 * (1 + m * p / k0) ** (1 / m), rel=1e-13)
    for slope in (0.0, 1e-9):
        flat = oil_laws.density_compressed(
            reference_density=870.0, pressure=p, bulk_modulus=k0, slope=slope
        )
        assert flat == pytest.approx(870 * math.exp(p / k0), rel=1e-10)
    low, high = (
        oil_laws.density_compressed(
            reference_density=870.0, pressure=q, bulk_modulus=k0, slope=np.array([m])
        )
        for q in (p - 1e4, p + 1e4)
    )
    assert (found * 2e4 / (high - low))[0] == pytest.approx(k0 + m * p, rel=1e-6)


@pytest.mark.parametrize(
    ("celsius", "bar", "expected"),
    [(20, 1, 856.9), (20, 200, 867.3), (40, 200, 855.6), (60, 1, 831.6), (80, 200, 833.4)],
)
def test_density_tait(celsius, bar, expected):
    """Density of the generic mineral oil, published table."""
    rho = oil_laws.density_tait(temperature=celsius + CELSIUS, pressure=bar * 1e5)
    assert rho == pytest.approx(expected, abs=0.06)


@pytest.mark.parametrize(
    ("celsius", "bar", "expected"),
    [
        (40, 1, 1367), (40, 200, 1582), (40, 350, 1743), (60, 100, 1325.0), (40, 280, 1668.1),
        (20, 350, 1911), (80, 200, 1299),
    ],
)  # fmt: skip
def test_bulk_modulus_tait(celsius, bar, expected):
    """Tangent bulk modulus of the generic mineral oil; B = 11.9 (10.9 would give 1563 at 200)."""
    modulus = oil_laws.bulk_modulus_tait(temperature=celsius + CELSIUS, pressure=bar * 1e5)
    assert modulus / 1e6 == pytest.approx(expected, abs=0.55 if expected % 1 == 0 else 0.06)


def test_tait_density_and_modulus_agree():
    """K = rho dp/drho by central differences."""
    t, p, h = 313.15, 200e5, 1e3
    rho = [oil_laws.density_tait(temperature=t, pressure=q) for q in (0.0, p - h, p, p + h)]
    tangent = rho[2] * 2 * h / (rho[3] - rho[1])
    assert oil_laws.bulk_modulus_tait(temperature=t, pressure=p) == pytest.approx(tangent, rel=1e-6)


def test_warm_bulk_modulus_falls_as_tait_does():
    """From 40 to 60 degC at 1 bar the generic oil goes from 1367 to 1218 MPa."""
    warm = fluid.bulk_modulus_warm(
        bulk_modulus=1367e6, decay=0.0058, temperature=333.15, reference_temperature=313.15
    )
    assert warm / 1e6 == pytest.approx(1218, abs=1.0)


@pytest.mark.parametrize(
    ("modulus", "air", "bar", "expected", "atmosphere"),
    [
        (1600, 0.005, 20, 1220, 101325.0), (1600, 0.005, 42, 1467, 101325.0),
        (1600, 0.005, 100, 1567, 101325.0), (1600, 0.01, 10, 555, 101325.0),
        (1600, 0.03, 60, 1232, 101325.0), (1600, 0.005, 0, 28, 101325.0),
        (1800, 0.01, 10, 577.35, 1.013e5), (1800, 0.03, 10, 245.56, 1.013e5),
        (1800, 0.01, 60, 1618.36, 1.013e5), (1800, 0.03, 60, 1346.96, 1.013e5),
        (1800, 0.01, 210, 1776.51, 1.013e5), (1800, 0.03, 210, 1731.35, 1.013e5),
    ],
)  # fmt: skip
def test_effective_bulk_modulus(modulus, air, bar, expected, atmosphere):
    """Oil with entrained air, [AaltoThesis] eq. 5, against independent values."""
    value = fluid.effective_bulk_modulus(
        bulk_modulus=modulus * 1e6,
        pressure=bar * 1e5,
        air_content=air,
        atmospheric_pressure=atmosphere,
    )
    assert value / 1e6 == pytest.approx(expected, abs=0.51 if expected % 1 == 0 else 0.006)


@given(st.floats(0, 500e5), st.floats(1e5, 100e5), st.floats(0, 0.1))
def test_effective_bulk_modulus_laws(pressure, step, air):
    """Air softens, pressure stiffens, no air leaves the oil alone."""
    k = {"bulk_modulus": 1.6e9}
    low = fluid.effective_bulk_modulus(pressure=pressure, air_content=air, **k)
    high = fluid.effective_bulk_modulus(pressure=pressure + step, air_content=air, **k)
    more_air = fluid.effective_bulk_modulus(pressure=pressure, air_content=air + 0.01, **k)
    assert low <= high * (1 + 1e-12)
    assert more_air < low
    assert fluid.effective_bulk_modulus(pressure=pressure, air_content=0.0, **k) == 1.6e9


def test_effective_bulk_modulus_is_the_two_volumes_in_parallel():
    """K_eff = -V dp/dV of oil V_o e^(-p/K) beside a polytropic gas, by central difference."""
    k, alpha, n, pa, p, h = 1.8e9, 0.02, 1.4, 101325.0, 30e5, 10.0

    def volume(q: float) -> float:  # small-strain oil about p, gas from atmospheric pressure
        return (1 - (q - p) / k) + alpha * (pa / (pa + q)) ** (1 / n)

    tangent = -volume(p) * 2 * h / (volume(p + h) - volume(p - h))
    value = fluid.effective_bulk_modulus(bulk_modulus=k, pressure=p, air_content=alpha)
    assert value == pytest.approx(tangent, rel=1e-6)


def test_effective_bulk_modulus_holds_at_cavitation():
    """Below -0.9 p_a the value at -0.9 p_a is kept: finite, positive."""
    values = fluid.effective_bulk_modulus(
        bulk_modulus=1.6e9, pressure=np.array([-0.9 * 101325, -2e5]), air_content=0.01
    )
    assert values[0] == values[1] > 0


def test_thermal_pressure_of_trapped_oil():
    """7.806 bar/K for the 16/20 mm aluminium barrel; the printed digit is truncated (7.8066)."""
    wall = 19.7282e-15 / (math.pi * 0.016**2 * 0.18)  # dV/dp over V of the barrel check values
    slope = oil_laws.thermal_pressure_slope(
        volume_expansion=7e-4,
        wall_expansion_axial=12e-6,
        wall_expansion_hoop=12e-6,
        bulk_modulus=1.4e9,
        wall_compliance_per_volume=wall,
    )
    assert slope / 1e5 == pytest.approx(7.806, rel=1e-4)


def test_linear_and_thermal_laws_by_hand():
    """1.4 GPa + 6 x 200 bar = 1.52 GPa; 870 kg/m^3 swell by 1.75 % over 25 K; 46 mm^2/s x 870."""
    viscosity = fluid.dynamic_viscosity(kinematic_viscosity=46e-6, density=870.0)
    assert viscosity == pytest.approx(0.04002, rel=1e-12)
    modulus = fluid.bulk_modulus_linear(bulk_modulus=1.4e9, slope=6.0, pressure=200e5)
    assert modulus == pytest.approx(1.52e9, rel=1e-12)
    warm = oil_laws.density_thermal(
        reference_density=870.0, volume_expansion=7e-4, temperature=313.15
    )
    assert warm * 1.0175 == pytest.approx(870.0, rel=1e-12)
