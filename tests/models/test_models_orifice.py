"""Claims about orifices, the one-way flow-control valve and leakage through a gap."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.optimize import brentq

from actuator_opt.models import damping, one_way_valve, orifice

OIL = {"density": 870.0, "dynamic_viscosity": 0.04}
HOLE = {"area": 0.3e-4, **OIL}
PRESSURES = st.floats(-8, 8).map(lambda x: math.copysign(10 ** abs(x), x))
"""Pressure differences of either sign, 1 Pa to 1000 bar."""
OPENINGS = st.floats(0.01, 1.0)


def test_plain_orifice_check_value():
    """C_q 0.611, 0.30 cm2, 5 bar, 870 kg/m3 without viscosity: 37.287 l/min, odd, 0 at rest."""
    flow = orifice.orifice_flow(
        area=0.3e-4,
        pressure_difference=np.array([5e5, -5e5, 0.0]),
        density=870.0,
        dynamic_viscosity=0.0,
    )
    np.testing.assert_allclose(flow * 60000, [37.287, -37.287, 0.0], atol=5e-4)


def test_coefficient_between_its_limits():
    """C_q -> delta sqrt(Re) [Merritt1967], -> 0.611; C/sqrt(2) at Re = (C/delta)^2 = 9.33."""
    assert orifice.discharge_coefficient(reynolds=1e-6) == pytest.approx(0.2e-3, rel=1e-6)
    assert orifice.discharge_coefficient(reynolds=1e9) == pytest.approx(0.611, rel=1e-8)
    assert orifice.discharge_coefficient(reynolds=0.0) == 0.0
    transition = (0.611 / 0.2) ** 2
    assert transition == pytest.approx(9.33, abs=5e-3)
    half = orifice.discharge_coefficient(reynolds=transition)
    assert half == pytest.approx(0.611 / math.sqrt(2))


def test_coefficient_at_the_thesis_reynolds_number():
    """[AaltoThesis] section 3.3.3: at Re 100.8 the coefficient is around 0.611 (within 5 %)."""
    assert orifice.discharge_coefficient(reynolds=100.8) == pytest.approx(0.611, rel=0.05)


@given(st.floats(1e-6, 1e8), st.floats(1.0001, 10))
def test_coefficient_rises_below_both_limits(reynolds, factor):
    """C_q rises with Re and stays below delta sqrt(Re) and below C; the sign of Re is no matter."""
    value = orifice.discharge_coefficient(reynolds=reynolds)
    assert value < min(0.2 * math.sqrt(reynolds), 0.611)
    assert orifice.discharge_coefficient(reynolds=reynolds * factor) > value
    assert orifice.discharge_coefficient(reynolds=-reynolds) == value


@pytest.mark.parametrize("difference", [1.0, 300.0, 1e4, 5e5, 2e7])
def test_explicit_flow_solves_the_implicit_law(difference):
    """Bisection of q = C_q(Re(q)) A sqrt(2 dp/rho) finds the explicit flow."""
    width = math.sqrt(4 * 0.3e-4 / math.pi)

    def mismatch(q):
        reynolds = q / 0.3e-4 * width / (0.04 / 870.0)
        coefficient = orifice.discharge_coefficient(reynolds=reynolds)
        return q - coefficient * 0.3e-4 * math.sqrt(2 * difference / 870.0)

    expected = brentq(mismatch, 1e-15, 1.0, xtol=1e-18, rtol=1e-14)
    flow = orifice.orifice_flow(**HOLE, pressure_difference=difference)
    assert flow == pytest.approx(expected, rel=1e-9)


def test_creeping_flow_through_a_thin_plate():
    """Sampson's exact q = r^3 dp/(3 eta) of a round hole is the law with delta^2 = 1/(12 pi)."""
    flow = orifice.orifice_flow(
        **HOLE, pressure_difference=1e-3, laminar_coefficient=math.sqrt(1 / (12 * math.pi))
    )
    radius = math.sqrt(0.3e-4 / math.pi)
    assert flow == pytest.approx(radius**3 * 1e-3 / (3 * 0.04), rel=1e-6)


def test_hydraulic_diameter_is_that_of_a_round_hole():
    """Left out or given as that of the round hole, the flow is the same; a slit's is smaller."""
    width = orifice.round_diameter(area=0.3e-4)
    assert math.pi / 4 * width**2 == pytest.approx(0.3e-4)
    flows = [
        orifice.orifice_flow(**HOLE, pressure_difference=1e4, hydraulic_diameter=d)
        for d in (None, width, 0.1 * width)
    ]
    assert flows[0] == flows[1] > flows[2]


@given(PRESSURES)
def test_flow_drop_and_slopes_belong_together(difference):
    """dp(q(dp)) = dp, G R = 1, odd flow, and a slope that is the small difference quotient."""
    at = {**HOLE, "pressure_difference": difference}
    flow = orifice.orifice_flow(**at)
    assert orifice.orifice_pressure_drop(**HOLE, flow=flow) == pytest.approx(difference, rel=1e-9)
    conductance = orifice.orifice_conductance(**at)
    resistance = orifice.orifice_resistance(**HOLE, flow=flow)
    assert conductance * resistance == pytest.approx(1.0, rel=1e-9)
    assert orifice.orifice_flow(**{**at, "pressure_difference": -difference}) == -flow
    change = 1e-4 * difference
    above = orifice.orifice_flow(**{**at, "pressure_difference": difference + change})
    below = orifice.orifice_flow(**{**at, "pressure_difference": difference - change})
    assert (above - below) / (2 * change) == pytest.approx(conductance, rel=1e-6)


def test_slopes_at_zero_and_in_turbulence():
    """At zero flow G = 2 delta^2 d A/eta, finite; far above, G = q/(2 dp) and R = 2 dp/q."""
    width = orifice.round_diameter(area=0.3e-4)
    rest = orifice.orifice_conductance(**HOLE, pressure_difference=0.0)
    assert rest == pytest.approx(2 * 0.04 * width * 0.3e-4 / 0.04)
    assert orifice.orifice_resistance(**HOLE, flow=0.0) == pytest.approx(1 / rest)
    thin = {"area": 0.3e-4, "density": 870.0, "dynamic_viscosity": 0.0}
    flow = orifice.orifice_flow(**thin, pressure_difference=5e5)
    conductance = orifice.orifice_conductance(**thin, pressure_difference=5e5)
    assert conductance == pytest.approx(flow / 1e6)
    assert math.isnan(orifice.orifice_conductance(**thin, pressure_difference=0.0))


def test_closed_orifice():
    """No area: no flow, no conductance, and no finite pressure drop."""
    closed = {**OIL, "area": np.array([0.0, 1e-5])}
    assert orifice.orifice_flow(**closed, pressure_difference=1e5)[0] == 0.0
    assert orifice.orifice_conductance(**closed, pressure_difference=1e5)[0] == 0.0
    assert np.isnan(orifice.orifice_pressure_drop(**closed, flow=1e-4)).tolist() == [True, False]


def valve(difference, **changed):
    """Flow of the valve of [AaltoThesis]."""
    return one_way_valve.one_way_flow(pressure_difference=difference, **OIL, **changed)


def test_valve_directions():
    """Out: the needle's 0.22 cm2. In: the needle below 0.4 bar, both areas above 0.5 bar."""
    needle = {"area": 0.22e-4, **OIL}
    poppet = {"area": 0.64e-4, **OIL}
    for difference in (1e5, 100.0, -0.2e5, -0.4e5):
        alone = orifice.orifice_flow(**needle, pressure_difference=difference)
        assert valve(difference) == pytest.approx(alone, rel=1e-12)
    for difference in (-0.5e5, -3e5):
        both = sum(
            orifice.orifice_flow(**path, pressure_difference=difference)
            for path in (needle, poppet)
        )
        assert valve(difference) == pytest.approx(both, rel=1e-12)


def test_valve_opens_half_way_at_the_middle_of_its_span():
    """0.45 bar inward lets through half of the poppet's flow."""
    poppet = orifice.orifice_flow(area=0.64e-4, pressure_difference=-0.45e5, **OIL)
    assert valve(-0.45e5, opening=0.0) == pytest.approx(poppet / 2, rel=1e-12)


def test_closed_needle_blocks_one_direction():
    """Out: no flow, conductance 0, an infinite drop for any flow; in: the check valve alone."""
    conductance = one_way_valve.one_way_conductance
    assert valve(1e5, opening=0.0) == 0.0
    for difference in (0.0, 1e5, math.inf):
        assert conductance(pressure_difference=difference, opening=0.0, **OIL) == 0.0
    drop = one_way_valve.one_way_pressure_drop(
        flow=np.array([1e-4, 0.0, -1e-3]), opening=0.0, **OIL
    )
    assert drop[:2].tolist() == [math.inf, 0.0]
    poppet = orifice.orifice_pressure_drop(area=0.64e-4, flow=-1e-3, **OIL)
    assert drop[2] == pytest.approx(poppet, rel=1e-12)


@given(PRESSURES, OPENINGS)
def test_valve_drop_is_the_inverse_of_its_flow(difference, opening):
    """dp(q(dp)) = dp for either sign and opening, also while the check valve opens."""
    flow = valve(difference, opening=opening)
    drop = one_way_valve.one_way_pressure_drop(flow=flow, opening=opening, **OIL)
    assert drop == pytest.approx(difference, rel=1e-9)


@given(st.floats(0.405e5, 0.495e5), OPENINGS)
def test_valve_conductance_is_the_slope(size, opening):
    """dq/d(dp) is the small difference quotient while the check valve opens, and positive."""
    slope = one_way_valve.one_way_conductance(pressure_difference=-size, opening=opening, **OIL)
    above, below = valve(-size + 1.0, opening=opening), valve(-size - 1.0, opening=opening)
    assert slope == pytest.approx((above - below) / 2, rel=1e-5)
    assert slope > 0


@given(PRESSURES, OPENINGS, st.floats(1.01, 3))
def test_valve_never_passes_less_for_more_pressure_or_opening(difference, opening, factor):
    """A larger pressure difference or a wider needle never lowers the flow's size."""
    flow = abs(valve(difference, opening=opening)) * (1 - 1e-14)  # rounding aside
    assert abs(valve(difference * factor, opening=opening)) >= flow
    assert abs(valve(difference, opening=min(1.0, opening * factor))) >= flow


def test_gap_conductance_is_leakage_per_pressure():
    """1.76715e-6 m3/s at 5 MPa (independent value); eccentric by the whole gap: 2.5 times."""
    gap = {"diameter": 0.04, "gap": 30e-6, "dynamic_viscosity": 0.04, "length": 0.02}
    assert damping.gap_conductance(**gap) * 5e6 == pytest.approx(1.76715e-6, rel=3e-6)
    ratio = damping.gap_conductance(eccentricity=1.0, **gap) / damping.gap_conductance(**gap)
    assert ratio == pytest.approx(2.5)
