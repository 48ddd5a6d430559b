"""Claims about the edges of a proportional valve and their slopes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.optimize import brentq

from actuator_opt.models import holding_valve, valve

# [MECE5005]: 40 l/min at 35 bar and 10 V, 0.45 l/min at 50 bar and 0 V
RATED = valve.edge_coefficient(flow=40 / 60000, pressure_drop=35e5)
LEAKAGE = valve.edge_coefficient(flow=0.45 / 60000, pressure_drop=50e5)
PRESSURE = st.floats(-3e7, 3e7)


def whole_valve(signal, supply, pressure_a, pressure_b, leaks=(LEAKAGE,) * 4):
    """Flows q_A, q_B, q_P, q_T of four edges PA, AT, PB, BT (l/min), return at 0 bar."""
    opening = (RATED - LEAKAGE) * abs(signal) / 10
    opens = (signal > 0, signal < 0, signal < 0, signal > 0)
    drops = (supply - pressure_a, pressure_a, supply - pressure_b, pressure_b)
    pa, at, pb, bt = (
        valve.edge_flow(coefficient=leak + opening * is_open, pressure_drop=drop) * 60000
        for leak, is_open, drop in zip(leaks, opens, drops, strict=True)
    )
    return pa - at, pb - bt, pa + pb, at + bt


def test_edge_coefficients_of_the_data_sheet():
    """K10 and K0 are flow over the root of the pressure drop; no drop has none."""
    assert pytest.approx(40 / 60000 / math.sqrt(35e5), rel=1e-15) == RATED
    assert pytest.approx(0.45 / 60000 / math.sqrt(50e5), rel=1e-15) == LEAKAGE
    assert np.isnan(valve.edge_coefficient(flow=1e-4, pressure_drop=np.array([0.0, -1e5]))).all()


def test_full_signal_check_values():
    """70 bar supply, ports at 35 bar: +-10 V gives 39.62 in and out, 40.38 l/min from the pump."""
    for signal, sign in ((10, 1), (-10, -1)):
        q_a, q_b, q_p, q_t = whole_valve(signal, 70e5, 35e5, 35e5)
        assert q_a == pytest.approx(sign * 39.62, abs=6e-3)
        assert q_b == pytest.approx(-sign * 39.62, abs=6e-3)
        assert (q_p, q_t) == pytest.approx((40.38, 40.38), abs=6e-3)


@pytest.mark.parametrize(
    ("signal", "flows"),
    [
        (6, (28.2617, -31.0513, 29.4347, 32.2243)),
        (-3, (-19.2154, 18.0478, 18.9907, 20.1584)),
    ],
)
def test_flow_check_values(signal, flows):
    """140/90/60 bar at +6 and -3 V, and q_A + q_B = q_P - q_T."""
    found = whole_valve(signal, 140e5, 90e5, 60e5)
    assert found == pytest.approx(flows, abs=6e-5)
    assert found[0] + found[1] == pytest.approx(found[2] - found[3], rel=1e-12)


def test_blocked_ports_rest_at_half_supply():
    """0 V and 100 bar: 50 bar in both ports and 0.9 l/min of leakage; 60 bar when split 60/40."""
    q_a, q_b, q_p, q_t = whole_valve(0, 100e5, 50e5, 50e5)
    assert (q_a, q_b) == pytest.approx((0, 0), abs=1e-12)
    assert (q_p, q_t) == pytest.approx((0.9, 0.9), abs=1e-5)
    into, out = ((0.45 / 60000) / math.sqrt(drop) for drop in (60e5, 40e5))
    q_a, q_b, q_p, _ = whole_valve(0, 100e5, 40e5, 40e5, (into, out, into, out))
    assert (q_a, q_b) == pytest.approx((0, 0), abs=1e-6)
    assert q_p == pytest.approx(0.9, abs=1e-5)


@given(PRESSURE)
def test_edge_flow_is_odd_and_its_slope_its_derivative(drop):
    """q(-dp) = -q(dp); the conductance is dq/d(dp) by central difference and never negative."""
    flow, slope = valve.edge_flow, valve.edge_conductance
    k = {"coefficient": RATED}
    assert flow(**k, pressure_drop=-drop) == -flow(**k, pressure_drop=drop)
    step = 1e-4 * (abs(drop) + 1e4)
    two = flow(**k, pressure_drop=drop + step) - flow(**k, pressure_drop=drop - step)
    found = slope(**k, pressure_drop=drop)
    assert found > 0
    assert found == pytest.approx(two / (2 * step), rel=1e-6)


def test_edges_follow_the_square_root_beyond_a_bar():
    """Away from zero q = K sqrt(dp) with slope K/(2 sqrt(dp)); at zero the slope K/sqrt(delta)."""
    for drop in (1e6, 1e7, 3.5e7):
        flow = valve.edge_flow(coefficient=RATED, pressure_drop=drop)
        assert flow == pytest.approx(RATED * math.sqrt(drop), rel=3e-5)
        slope = valve.edge_conductance(coefficient=RATED, pressure_drop=drop)
        assert slope == pytest.approx(RATED / (2 * math.sqrt(drop)), rel=2e-4)
    at_zero = valve.edge_conductance(coefficient=RATED, pressure_drop=0.0)
    assert at_zero == pytest.approx(RATED / math.sqrt(1e4), rel=1e-12)


@given(st.floats(1e5, 3.4e7), st.floats(1e5, 3.4e7), st.booleans())
def test_slopes_are_the_derivatives_of_the_whole_valve(pressure_a, pressure_b, extending):
    """Gains equal differences about the centre, conductances where a chamber gains no oil.

    Held, that is the spool's own place; on the other side the centre is what a drift passes.
    """
    supply, h, sign = 35e6, 1e3, 1 if extending else -1
    slopes, other = (
        holding_valve.valve_slopes(
            rated_coefficient=RATED, leakage_coefficient=LEAKAGE, signal=10.0, return_pressure=0.0,
            supply_pressure=supply, pressure_a=pressure_a, pressure_b=pressure_b, extending=way,
        ) for way in (extending, not extending)
    )  # fmt: skip
    rest = whole_valve(0, supply, pressure_a, pressure_b)
    moved = whole_valve(sign * 0.01, supply, pressure_a, pressure_b)
    per_volt = [(b - a) / (sign * 0.01) / 60000 for a, b in zip(rest, moved, strict=True)]
    assert slopes.gain_a == pytest.approx(per_volt[0], rel=1e-6)
    assert -slopes.gain_b == pytest.approx(per_volt[1], rel=1e-6)
    for i, (a, b) in enumerate(((1, 0), (0, 1))):
        fed = brentq(lambda u, i=i: whole_valve(u, supply, pressure_a, pressure_b)[i], -10, 10)
        less, more = (
            whole_valve(fed, supply, pressure_a + way * h * a, pressure_b + way * h * b)[i]
            for way in (-1, 1)
        )
        lost = (less - more) / (2 * h) / 60000
        own, beside = (one[2 + i] for one in (slopes, other))
        assert max(own, beside) == pytest.approx(lost, rel=1e-4)
        less, more = (
            whole_valve(0.0, supply, pressure_a + way * h * a, pressure_b + way * h * b)[i]
            for way in (-1, 1)
        )
        passed = (less - more) / (2 * h) / 60000
        side = math.copysign(1.0, fed) == sign
        assert own == pytest.approx(lost if side else passed, rel=1e-4)


@given(st.floats(-1e6, 3.6e7), st.floats(1.0, 20.0), st.floats(1.0, 20.0), st.floats(-1e-5, 1e-5))
def test_feeding_edges_close_the_balance(pressure, more_supply, more_tank, lost):
    """What leaks is fed: neither edge below its leakage nor above its capacity, one at it."""
    supply, leaks = 35e6, (more_supply * LEAKAGE, more_tank * LEAKAGE)
    into, out = supply - pressure, pressure
    edges = holding_valve.feeding_edges(
        rated_coefficient=RATED, leakage_supply=leaks[0], leakage_tank=leaks[1], into=into, out=out,
        lost=lost,
    )  # fmt: skip
    assert leaks[0] <= edges.supply * (1 + 1e-15)
    assert leaks[1] <= edges.tank * (1 + 1e-15)
    assert max(edges) <= RATED
    if max(edges) < RATED:
        assert min(edges.supply / leaks[0], edges.tank / leaks[1]) == pytest.approx(1, rel=1e-14)
        fed, drained = (
            valve.edge_flow(coefficient=k, pressure_drop=p)
            for k, p in ((edges.supply, into), (edges.tank, out))
        )
        assert fed == pytest.approx(drained + lost, rel=1e-11, abs=1e-18)


def test_an_edge_without_pressure_gives_no_flow():
    """Gains vanish where the opening edge sees no pressure drop: the valve moves nothing."""
    slopes = holding_valve.valve_slopes(
        rated_coefficient=RATED, leakage_coefficient=LEAKAGE, signal=10.0, supply_pressure=1e7,
        return_pressure=5e5, pressure_a=np.array([1.1e7, 1e7]), pressure_b=4e5, extending=True,
    )  # fmt: skip
    np.testing.assert_array_equal(slopes.gain_a, 0.0)
    np.testing.assert_array_equal(slopes.gain_b, 0.0)
    assert np.all(slopes.conductance_a > 0)
