"""Claims about natural frequency, damping ratio and dynamic stiffness."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from actuator_opt.models import dynamics, forces, stiffness

# 32/18-160 at 80 mm, V_0 8 ml, K 1.4 GPa, m 30 kg, B 400 N s/m.
AREA_A = forces.piston_area(bore=0.032)
AREA_B = forces.annulus_area(bore=0.032, rod_diameter=0.018)
CHAMBERS = {
    "area_a": AREA_A,
    "compliance_a": (8e-6 + AREA_A * 0.08) / 1.4e9,
    "area_b": AREA_B,
    "compliance_b": (8e-6 + AREA_B * 0.08) / 1.4e9,
}
STIFFNESS = stiffness.hydraulic_stiffness(**CHAMBERS)
# centred valve of [MECE5005], 140 bar supply: each chamber sees two leakage edges at 70 bar
CONDUCTANCE = 2 * (0.45 / 60000) / math.sqrt(50e5) / (2 * math.sqrt(7e6))


def test_frequency_and_damping_check_values():
    """132.071 Hz, damping ratio 0.008034 (friction) + 0.017064 (valve leakage)."""
    load = {"stiffness": STIFFNESS, "mass": 30.0}
    friction = dynamics.friction_damping_ratio(incremental_damping=400.0, **load)
    leak = dynamics.conductance_damping_ratio(
        **load, **CHAMBERS, conductance_a=CONDUCTANCE, conductance_b=CONDUCTANCE
    )
    total = dynamics.damping_ratio(
        incremental_damping=400.0,
        **load,
        **CHAMBERS,
        conductance_a=CONDUCTANCE,
        conductance_b=CONDUCTANCE,
    )
    assert dynamics.natural_frequency(**load) == pytest.approx(132.071, abs=6e-4)
    assert friction == pytest.approx(0.008034, abs=6e-7)
    assert leak == pytest.approx(0.017064, abs=6e-7)
    assert total == pytest.approx(friction + leak, rel=1e-12)


def test_damping_ratio_is_that_of_the_poles():
    """The lightly damped pole of the full fourth-order system has the ratio we state.

    m s^2 + B s + sum A_i^2 s/(C_i s + G_i) = 0, multiplied out to a polynomial here.
    """
    c_a, c_b = CHAMBERS["compliance_a"], CHAMBERS["compliance_b"]
    side_a, side_b = [c_a, CONDUCTANCE], [c_b, CONDUCTANCE]
    mechanical = np.polymul([30.0, 400.0], np.polymul(side_a, side_b))
    springs = np.polyadd(AREA_A**2 * np.array(side_b), AREA_B**2 * np.array(side_a))
    poles = np.roots(np.polyadd(mechanical, springs))
    pole = max(poles, key=lambda p: p.imag)
    zeta = dynamics.damping_ratio(
        incremental_damping=400.0,
        stiffness=STIFFNESS,
        mass=30.0,
        **CHAMBERS,
        conductance_a=CONDUCTANCE,
        conductance_b=CONDUCTANCE,
    )
    assert -pole.real / abs(pole) == pytest.approx(zeta, rel=2e-3)


def test_falling_friction_makes_the_ratio_negative():
    """A negative dF/dv without leakage is an unstable (stick-slip) ratio."""
    zeta = dynamics.damping_ratio(
        incremental_damping=-400.0, stiffness=STIFFNESS, mass=30.0, **CHAMBERS
    )
    assert zeta == pytest.approx(-0.008034, abs=6e-7)


@pytest.mark.parametrize(
    ("frequency", "admittance", "magnitude", "phase"),
    [(10, 0.0, 20.5399, 0.070), (40, 0.0, 18.7636, 0.307),
     (10, 2e-11, 2.95833, 83.94), (40, 2e-11, 9.51768, 69.89)],
)  # fmt: skip
def test_dynamic_stiffness_check_values(frequency, admittance, magnitude, phase):
    """Magnitude (MN/m) and phase (deg) with closed and leaking line ends."""
    k = dynamics.dynamic_stiffness(
        frequency=float(frequency),
        mass=30.0,
        damping=400.0,
        **CHAMBERS,
        admittance_a=admittance,
        admittance_b=admittance,
    )
    assert math.hypot(*k) / 1e6 == pytest.approx(magnitude, rel=3e-6)
    assert math.degrees(math.atan2(k.loss, k.storage)) == pytest.approx(phase, abs=0.006)


def test_dynamic_stiffness_equals_the_complex_formula():
    """Real parts agree with -m w^2 + i w B + sum A^2/(C + Y/(i w)) in complex arithmetic."""
    omega, y_a, y_b = 2 * math.pi * 17.0, 3e-11, 1e-12
    expected = (
        -30.0 * omega**2
        + 400j * omega
        + AREA_A**2 / (CHAMBERS["compliance_a"] + y_a / (1j * omega))
        + AREA_B**2 / (CHAMBERS["compliance_b"] + y_b / (1j * omega))
    )
    k = dynamics.dynamic_stiffness(
        frequency=17.0, mass=30.0, damping=400.0, **CHAMBERS, admittance_a=y_a, admittance_b=y_b
    )
    assert cmath.isclose(complex(k.storage, k.loss), expected, rel_tol=1e-12)


def test_faults_are_nan():
    """No mass has no frequency; no k m has no ratio."""
    f = dynamics.natural_frequency(stiffness=1e7, mass=np.array([0.0, -1.0, 2.0]))
    np.testing.assert_array_equal(np.isnan(f), [True, True, False])
    zeta = dynamics.friction_damping_ratio(
        incremental_damping=1.0, stiffness=np.array([-1e6, 1e6]), mass=1.0
    )
    np.testing.assert_array_equal(np.isnan(zeta), [True, False])
