"""Claims about the closed forms of the load on the oil: frequency and damping ratio."""

from __future__ import annotations

import math

import numpy as np
import pytest

from actuator_opt.models import dynamics, forces, stiffness
from actuator_opt.models.line_ends import LineEnd
from actuator_opt.models.linear import Side, linear_actuator
from actuator_opt.models.loop import load_mode

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
LOAD = {"stiffness": STIFFNESS, "mass": 30.0}
# centred valve of [MECE5005], 140 bar supply: each chamber sees two leakage edges at 70 bar
CONDUCTANCE = 2 * (0.45 / 60000) / math.sqrt(50e5) / (2 * math.sqrt(7e6))


def leak(conductance):
    """Share of the damping ratio from one conductance in each chamber, to the first order."""
    springs = [CHAMBERS[f"area_{c}"] ** 2 / CHAMBERS[f"compliance_{c}"] for c in "ab"]
    rates = [conductance / CHAMBERS[f"compliance_{c}"] for c in "ab"]
    lost = sum(k * rate for k, rate in zip(springs, rates, strict=True))
    return lost / (2 * math.sqrt(STIFFNESS / 30.0) * sum(springs))


def rubbing(damping):
    """Share of the damping ratio from friction, dF/dv/(2 sqrt(k m))."""
    return damping / (2 * math.sqrt(STIFFNESS * 30.0))


def mode(conductance, damping, flexibility=0.0):
    """Mode of the linear model of the same cylinder, with rod and mount of this flexibility."""
    sides = {
        f"side_{c}": Side(
            CHAMBERS[f"area_{c}"], CHAMBERS[f"compliance_{c}"], end=LineEnd((conductance,))
        )
        for c in "ab"
    }
    load = {"mass": 30.0, "damping": damping, "flexibility": flexibility}
    return load_mode(model=linear_actuator(**sides, **load))


def test_frequency_and_damping_check_values():
    """132.071 Hz, damping ratio 0.008034 (friction) + 0.017064 (valve leakage)."""
    friction = rubbing(400.0)
    assert dynamics.natural_frequency(**LOAD) == pytest.approx(132.071, abs=6e-4)
    assert friction == pytest.approx(0.008034, abs=6e-7)
    assert leak(CONDUCTANCE) == pytest.approx(0.017064, abs=6e-7)


def test_the_shares_are_those_of_the_poles():
    """Both shares are the first order of the poles: the rest falls with their square."""
    for factor in (1.0, 0.1, 0.01):
        friction = rubbing(400.0 * factor)
        poles = mode(CONDUCTANCE * factor, 400.0 * factor)
        share = leak(CONDUCTANCE * factor)
        assert poles.damping_ratio == pytest.approx(friction + share, rel=2e-3 * factor)
        assert poles.natural_frequency == pytest.approx(132.071, rel=2e-3 * factor**2 + 1e-5)


@pytest.mark.parametrize("ratio", [1.0, 4.0])
def test_a_flexible_rod_lowers_both_shares(ratio):
    """(k/k_h)^2 [B/(2 sqrt(k m)) + sum(A^2 G/C^2)/(2 omega k)] with k of oil, rod and mount.

    ratio : stiffness of rod and mount over that of the oil
    """
    k = STIFFNESS * ratio / (1 + ratio)
    omega = math.sqrt(k / 30.0)
    lost = sum((CHAMBERS[f"area_{c}"] / CHAMBERS[f"compliance_{c}"]) ** 2 for c in "ab")
    for friction, conductance in ((4.0, 0.0), (0.0, 0.01 * CONDUCTANCE)):
        bracket = friction / (2 * math.sqrt(k * 30.0)) + lost * conductance / (2 * omega * k)
        poles = mode(conductance, friction, 1 / (ratio * STIFFNESS))
        assert poles.damping_ratio == pytest.approx((k / STIFFNESS) ** 2 * bracket, rel=1e-4)
        assert poles.natural_frequency == pytest.approx(omega / (2 * math.pi), rel=1e-5)


def test_a_slow_load_on_the_loop_meets_a_finite_stiffness():
    """Spool o = -K_p x, ports that leak: at 0 Hz K_p (A_A G_qA/G_A + A_B G_qB/G_B)."""
    gains, leaks, gain = {"a": 2e-4, "b": 3e-4}, {"a": 2e-11, "b": 5e-11}, 50.0
    sides = {
        f"side_{c}": Side(
            CHAMBERS[f"area_{c}"],
            CHAMBERS[f"compliance_{c}"],
            end=LineEnd((leaks[c],)),
            flow_gain=sign * gains[c],
        )
        for c, sign in (("a", 1.0), ("b", -1.0))
    }
    model = linear_actuator(**sides, mass=30.0, damping=400.0)
    loop = (model.characteristic[0] + gain * model.drive[0]) / model.mobile[0]
    by_hand = gain * sum(CHAMBERS[f"area_{c}"] * gains[c] / leaks[c] for c in "ab")
    assert loop == pytest.approx(by_hand, rel=1e-12)


def test_falling_friction_makes_the_ratio_negative():
    """A negative dF/dv without leakage is an unstable (stick-slip) ratio, also as a pole."""
    share = rubbing(-400.0)
    assert share == pytest.approx(-0.008034, abs=6e-7)
    assert mode(0.0, -400.0).damping_ratio == pytest.approx(share, rel=1e-9)


def test_faults_are_nan():
    """No mass has no frequency."""
    f = dynamics.natural_frequency(stiffness=1e7, mass=np.array([0.0, -1.0, 2.0]))
    np.testing.assert_array_equal(np.isnan(f), [True, True, False])
