"""Rough surfaces in contact and their flow factors, against check values and other forms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import gamma, pbdv
from scipy.stats import norm

from actuator_opt.models.rough_surface import (
    asperity_integral,
    asperity_pressure,
    asperity_stiffness,
    composite_roughness,
    film_ratio_under_contact,
    mean_gap_ratio,
    pressure_flow_factor,
    pressure_stress_factor,
    shear_flow_factor,
    shear_stress_correction,
    shear_stress_factor,
)

SEAL = {
    "youngs_modulus": 30e6, "poissons_ratio": 0.48, "asperity_density": 8e13,
    "asperity_radius": 1.5e-6, "roughness": 1e-6,
}  # fmt: skip
CHECK = np.array([1.5, 2.5, 8.0])


def test_composite_roughness():
    """Root of the sum of squares (Huang eq. 5): 0.6 and 0.8 give 1."""
    assert composite_roughness(first=0.6e-6, second=0.8e-6) == pytest.approx(1e-6, rel=1e-15)


def test_asperity_integral_check_values():
    """The tabulated F_3/2 and F_1/2, and F_3/2(0) = 0.43 of Greenwood and Williamson."""
    film = np.array([0.5, 1.5, 2.5, 3.5])
    np.testing.assert_allclose(
        asperity_integral(film_ratio=film), [0.195204, 0.0246395, 1.46994e-3, 3.82271e-5], rtol=4e-6
    )
    np.testing.assert_allclose(
        asperity_integral(film_ratio=film, order="1/2"),
        [0.225336, 0.0398815, 3.15902e-3, 1.04071e-4],
        rtol=6e-6,
    )
    assert asperity_integral(film_ratio=0.0) == pytest.approx(0.43, abs=5e-5)


@pytest.mark.parametrize(("order", "n"), [("-1/2", -0.5), ("1/2", 0.5), ("3/2", 1.5), ("5/2", 2.5)])
def test_asperity_integral_is_a_parabolic_cylinder_function(order, n):
    """F_n = Gamma(n+1)(2 pi)^(-1/2) e^(-H^2/4) D_(-n-1)(H) on -3 to 9, to what SciPy has."""
    film = np.linspace(-3, 9, 49)
    cylinder = np.array([pbdv(-n - 1, h)[0] for h in film])
    exact = gamma(n + 1) / np.sqrt(2 * np.pi) * np.exp(-film * film / 4) * cylinder
    np.testing.assert_allclose(asperity_integral(film_ratio=film, order=order), exact, rtol=1e-8)


def test_asperity_integral_by_quadrature():
    """Adaptive quadrature of the defining integral, down to H = -6."""
    for film in (-6.0, -1.0, 2.0, 12.0):
        value, _ = quad(
            lambda t, h=film: t**1.5 * np.exp(-((t + h) ** 2 - h * h) / 2),
            0, 20, epsabs=0, epsrel=1e-11, limit=200,
        )  # fmt: skip
        exact = value * np.exp(-film * film / 2) / np.sqrt(2 * np.pi)
        assert asperity_integral(film_ratio=film) == pytest.approx(exact, rel=1e-9)


def test_asperity_integral_slope():
    """DF_n/dH = -n F_(n-1): the complex step of one order is the next lower order."""
    film = np.linspace(-2, 6, 9)
    for order, lower, n in (("1/2", "-1/2", 0.5), ("3/2", "1/2", 1.5), ("5/2", "3/2", 2.5)):
        slope = asperity_integral(film_ratio=film + 1e-30j, order=order).imag / 1e-30
        below = asperity_integral(film_ratio=film, order=lower)
        np.testing.assert_allclose(slope, -n * below, rtol=1e-9)


def test_unknown_order_is_refused():
    """An order outside the list is named with those that exist."""
    with pytest.raises(ValueError, match=r"order '2'.*3/2"):
        asperity_integral(film_ratio=1.0, order="2")


def test_asperity_pressure_check_value():
    """The tabulated 7.48565 MPa at H = 2.5; pressure over stiffness is F_3/2."""
    pressure = asperity_pressure(film_ratio=2.5, **SEAL)
    assert pressure == pytest.approx(7.48565e6, rel=1e-6)
    assert pressure / asperity_stiffness(**SEAL) == pytest.approx(1.46994e-3, rel=4e-6)


def test_film_ratio_under_contact_is_the_inverse():
    """From H to pressure and back; no film ratio for a pull or for flattened asperities."""
    film, stiffness = np.linspace(-5, 15, 81), asperity_stiffness(**SEAL)
    pressure = asperity_pressure(film_ratio=film, **SEAL)
    back = film_ratio_under_contact(contact_pressure=pressure, stiffness=stiffness)
    np.testing.assert_allclose(back, film, atol=1e-11)
    assert np.isnan(film_ratio_under_contact(contact_pressure=-1.0, stiffness=stiffness))
    assert np.isnan(film_ratio_under_contact(contact_pressure=1e3 * stiffness, stiffness=stiffness))


def test_mean_gap_ratio():
    """Check values, and H Phi(H) + phi(H) of the normal distribution."""
    np.testing.assert_allclose(mean_gap_ratio(film_ratio=CHECK), [1.529307, 2.502004, 8], rtol=4e-7)
    film = np.linspace(-9, 12, 85)
    exact = film * norm.cdf(film) + norm.pdf(film)
    np.testing.assert_allclose(mean_gap_ratio(film_ratio=film), exact, atol=1e-13)


def test_flow_factor_check_values():
    """The tabulated factors at H = 1.5, 2.5, 8, with the signs of a smooth rod."""
    smooth = {"film_ratio": CHECK, "rod_share": 0.0}
    np.testing.assert_allclose(
        pressure_flow_factor(film_ratio=CHECK), [0.611461, 0.778063, 0.989800], rtol=1e-6
    )
    np.testing.assert_allclose(
        shear_flow_factor(**smooth), [-0.795474, -0.638772, -0.152388], rtol=4e-6
    )
    np.testing.assert_allclose(
        shear_stress_factor(film_ratio=CHECK), [1.920896, 1.379666, 1.016259], rtol=1e-6
    )
    np.testing.assert_allclose(
        shear_stress_correction(**smooth), [-1.021293, -0.477628, 0], rtol=1e-6, atol=1e-12
    )
    np.testing.assert_allclose(
        pressure_stress_factor(film_ratio=CHECK), [0.479793, 0.731130, 0.992871], rtol=1e-6
    )


def test_factors_of_motion_turn_with_the_roughness():
    """A rough rod turns both signs, equal roughness cancels them: (2 V - 1)."""
    for factor in (shear_flow_factor, shear_stress_correction):
        smooth, even, rough = (factor(film_ratio=2.5, rod_share=v) for v in (0.0, 0.5, 1.0))
        assert smooth < 0 == even < rough == -smooth


def test_shear_stress_factor_is_the_mean_of_its_polynomial_density():
    """phi_f = H E[1/(h)] over the heights density (35/96)(1 - (z/3)^2)^3, cut off at 1/300.

    The density of Patir and Cheng's own closed form, integrated here by quadrature.
    """
    for film in (0.8, 1.5, 2.5, 4.0, 8.0, 20.0, 60.0):
        low = max(-3.0, -film + 3 / 300)
        value, _ = quad(
            lambda z, h=film: (35 / 96) * (1 - (z / 3) ** 2) ** 3 * h / (h + z),
            low,
            3,
            epsrel=1e-11,
        )
        assert shear_stress_factor(film_ratio=film) == pytest.approx(value, rel=3e-3)


def test_factors_tend_to_a_smooth_gap():
    """Far above the roughness no factor is left; the pieces of each law meet."""
    for factor in (pressure_flow_factor, pressure_stress_factor, shear_stress_factor):
        assert factor(film_ratio=200.0) == pytest.approx(1.0, abs=3e-5)
    for factor in (shear_flow_factor, shear_stress_correction):
        assert factor(film_ratio=60.0, rod_share=0.0) == pytest.approx(0.0, abs=1e-6)
    for joint in (3.0, 30.0):
        below, above = (shear_stress_factor(film_ratio=joint + d) for d in (-1e-9, 1e-9))
        assert below == pytest.approx(above, rel=1e-6)
    below, above = (shear_flow_factor(film_ratio=5 + d, rod_share=0.0) for d in (-1e-9, 1e-9))
    assert below == pytest.approx(above, rel=2e-4)
