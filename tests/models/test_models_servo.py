"""Claims about the whole valve, its spool, the reducing valve and controller tuning."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.optimize import brentq

from actuator_opt.models import holding_valve, loop, supply, valve
from actuator_opt.models.line_ends import LineEnd, end_admittance, reducing_valve_end
from actuator_opt.models.linear import Side, linear_actuator
from actuator_opt.models.loop import open_loop, ultimate_gain

# [MECE5005]: 40 l/min at 35 bar and 10 V, 0.45 l/min at 50 bar and 0 V
RATED = 40 / 60000 / math.sqrt(35e5)
LEAKAGE = 0.45 / 60000 / math.sqrt(50e5)
PRESSURE = st.floats(0.0, 3.5e7)
SIGNAL = st.floats(-15.0, 15.0)


def flows(signal, supply, pressure_a, pressure_b, leaks=(LEAKAGE, LEAKAGE), tank=0.0):
    """Flows of the slides' valve."""
    return valve.valve_flows(
        signal=signal, rated_coefficient=RATED, leakage_supply=leaks[0], leakage_tank=leaks[1],
        full_signal=10.0, supply_pressure=supply, return_pressure=tank, pressure_a=pressure_a,
        pressure_b=pressure_b,
    )  # fmt: skip


def ports(found):
    """Flows q_A, q_B, q_P, q_T in l/min."""
    return [60000 * q for q in (found.into_a, found.into_b, found.supply, found.tank)]


@pytest.mark.parametrize(
    ("signal", "expected"),
    [
        (6, (28.2617, -31.0513, 29.4347, 32.2243)),
        (-3, (-19.2154, 18.0478, 18.9907, 20.1584)),
    ],
)
def test_flow_check_values(signal, expected):
    """Supply 140, A 90, B 60 bar: the four port flows at +6 and -3 V."""
    assert ports(flows(signal, 140e5, 90e5, 60e5)) == pytest.approx(expected, abs=6e-5)


def test_full_signal_check_values():
    """Supply 70, ports 35 bar: +-10 V gives +-39.62 l/min and 40.38 l/min; 12 V no more."""
    for signal, sign in ((10, 1), (-10, -1), (12, 1), (-12, -1)):
        expected = (sign * 39.62, -sign * 39.62, 40.38, 40.38)
        assert ports(flows(signal, 70e5, 35e5, 35e5)) == pytest.approx(expected, abs=6e-3)


@pytest.mark.parametrize(("split", "rest"), [((50e5, 50e5), 50e5), ((60e5, 40e5), 40e5)])
def test_blocked_ports_rest_where_the_leakages_agree(split, rest):
    """0 V, 100 bar: 0.9 l/min, ports at 50 bar; with leakages of 60 and 40 bar at 40 bar."""
    leaks = tuple(0.45 / 60000 / math.sqrt(drop) for drop in split)
    assert ports(flows(0, 100e5, rest, rest, leaks)) == pytest.approx((0, 0, 0.9, 0.9), abs=1e-5)


@pytest.mark.parametrize(
    ("signal", "speed", "pressure_a", "pressure_b"),
    [(3, 0.393606, 51.942e5, 43.109e5), (-3, -0.381055, 82.856e5, 99.424e5)],
)
def test_steady_speed_check_values(signal, speed, pressure_a, pressure_b):
    """Cylinder 32/18 at 140 bar and +-3 V: the valve's flows are the piston's, A_A v and -A_B v."""
    found = flows(signal, 140e5, pressure_a, pressure_b)
    area_a, area_b = math.pi / 4 * 0.032**2, math.pi / 4 * (0.032**2 - 0.018**2)
    assert found.into_a == pytest.approx(area_a * speed, rel=2e-5)
    assert found.into_b == pytest.approx(-area_b * speed, rel=2e-5)


@given(SIGNAL, PRESSURE, PRESSURE, PRESSURE, PRESSURE)
def test_no_oil_is_made_and_the_valve_is_symmetric(signal, supply, tank, pressure_a, pressure_b):
    """q_A + q_B = q_P - q_T; the opposite signal does to B what the signal does to A."""
    found = flows(signal, supply, pressure_a, pressure_b, (LEAKAGE, 2 * LEAKAGE), tank)
    largest = max(abs(q) for q in found)
    lost = found.into_a + found.into_b - found.supply + found.tank
    assert abs(lost) <= 1e-14 * largest
    mirrored = flows(-signal, supply, pressure_b, pressure_a, (LEAKAGE, 2 * LEAKAGE), tank)
    assert mirrored == (found.supply_b, found.supply_a, found.b_tank, found.a_tank)


@given(SIGNAL, PRESSURE, PRESSURE, PRESSURE)
def test_the_valve_only_takes_power(signal, supply, pressure_a, pressure_b):
    """Each edge loses p q: what goes in at the ports as power is never less than what comes out."""
    found = flows(signal, supply, pressure_a, pressure_b)
    lost = supply * found.supply - pressure_a * found.into_a - pressure_b * found.into_b
    assert lost >= -1e-12 * supply * abs(found.supply)


@given(st.floats(1e5, 1.39e7), st.booleans(), st.floats(0, 1e-12))
def test_slopes_of_the_valve_that_holds_are_those_of_the_linear_valve(pressure_a, extending, past):
    """At p_A + p_B = p_S one signal feeds both chambers; slopes there equal `valve_slopes`."""
    supply = 140e5
    pressure_b = supply - pressure_a
    slopes, other = (
        holding_valve.valve_slopes(
            rated_coefficient=RATED, leakage_coefficient=LEAKAGE, signal=10.0, return_pressure=0.0,
            extending=way, supply_pressure=supply, pressure_a=pressure_a, pressure_b=pressure_b,
            piston_leakage=past,
        ) for way in (extending, not extending)
    )  # fmt: skip
    side = 1e-9 if extending else -1e-9  # a share of a volt to the side that opens
    moved = flows(side + 1e-30j, supply, pressure_a, pressure_b)
    assert moved.into_a.imag / 1e-30 == pytest.approx(slopes.gain_a, rel=1e-6)
    assert moved.into_b.imag / 1e-30 == pytest.approx(-slopes.gain_b, rel=1e-6)
    lost = past * (pressure_a - pressure_b)
    rest = brentq(
        lambda u: flows(u, supply, pressure_a, pressure_b).into_a - lost, -10, 10, xtol=1e-14
    )
    assert flows(rest, supply, pressure_a, pressure_b).into_b == pytest.approx(-lost, abs=1e-14)
    pressed = flows(rest, supply, pressure_a + 1e-20j, pressure_b + 1e-20j)
    held = [max(slopes[k], other[k]) for k in (2, 3)]
    assert pressed.into_a.imag / 1e-20 == pytest.approx(-held[0], rel=1e-8)
    assert pressed.into_b.imag / 1e-20 == pytest.approx(-held[1], rel=1e-8)


def test_edge_opening_runs_from_leakage_to_rated():
    """K0 up to 0 V, a straight line, K10 from the full signal on; no full signal has none."""
    edge = {"rated_coefficient": 9.0, "leakage_coefficient": 1.0}
    signals = np.array([-10.0, 0.0, 2.5, 10.0, 40.0])
    found = valve.edge_opening(signal=signals, full_signal=10.0, **edge)
    np.testing.assert_array_equal(found, [1.0, 1.0, 3.0, 9.0, 9.0])
    for signal, full in ((1.0, 0.0), (math.nan, 10.0)):
        assert math.isnan(valve.edge_opening(signal=signal, full_signal=full, **edge))


def test_viscosity_check_values():
    """[MECE5005]: twice the viscosity loses 1.189 times, 10 to 800 cSt nearly 3 times as much."""

    def loss(rated, now):
        k = valve.viscosity_corrected(coefficient=1.0, rated_viscosity=rated, viscosity=now)
        return 1 / k**2  # pressure drop at one flow

    assert loss(32e-6, 64e-6) == pytest.approx(1.189, abs=5e-4)
    assert loss(10e-6, 800e-6) == pytest.approx(2.99, abs=5e-3)
    assert loss(46e-6, 46e-6) == 1
    assert math.isnan(loss(46e-6, 0.0))


@given(st.floats(5.0, 500.0), st.floats(0.2, 1.5), st.floats(0.1, 10.0))
def test_the_spool_is_a_second_order_lag(natural_frequency, damping_ratio, ratio):
    """At r times its frequency it answers a sine with 1/(1 - r^2 + 2 i zeta r)."""
    answer = 1 / (1 - ratio**2 + 2j * damping_ratio * ratio)
    s = 2j * math.pi * natural_frequency * ratio
    found = valve.spool_acceleration(
        command=1.0, opening=answer, rate=s * answer, natural_frequency=natural_frequency,
        damping_ratio=damping_ratio,
    )  # fmt: skip
    assert abs(found - s * s * answer) <= 1e-12 * (2 * math.pi * natural_frequency) ** 2 * 10


def test_spool_geometry_check_value():
    """Ports of 0.30 cm^2 at 5 bar, C_q 0.611, rho 870: 37.287 l/min; nothing within the overlap."""
    ring = {"area_gradient": 0.5 * math.pi * 10e-3, "density": 870.0}
    stroke = 0.30e-4 / (0.5 * math.pi * 10e-3)
    for overlap in (0.2e-3, 0.0, -0.1e-3):
        geometry = {**ring, "overlap": overlap}
        k = valve.spool_edge_coefficient(spool_position=stroke + overlap, **geometry)
        assert k * math.sqrt(5e5) * 60000 == pytest.approx(37.287, abs=5e-4)
        for position in (overlap, overlap - 1e-4):
            assert valve.spool_edge_coefficient(spool_position=position, **geometry) == 0


REDUCING = {"conductance": 1e-10, "natural_frequency": 20.0, "damping_ratio": 0.3}


@given(
    st.floats(0.1, 400.0), st.floats(1e-12, 1e-8), st.floats(1.0, 200.0), st.floats(0.05, 2.0),
    st.floats(0.0, 1e-10),
)  # fmt: skip
def test_small_signals_of_the_reducing_valve_are_its_line_end(frequency, g, own, zeta, passive):
    """Flow out of the line per pressure swing equals the linear admittance."""
    end = {"conductance": g, "natural_frequency": own, "damping_ratio": zeta}
    s = 2j * math.pi * frequency
    swing = {"pressure": 1.0, "set_pressure": 0.0}

    def left(flow):
        """Excess of s^2 q over the valve's acceleration."""
        found = supply.reducing_valve_acceleration(flow=flow, rate=s * flow, **swing, **end)
        return s * s * flow - found

    flow = -left(0.0) / (left(1.0) - left(0.0))  # linear in the flow
    into_line = supply.reducing_valve_flow(
        flow=flow, largest_flow=1.0, passive_conductance=passive, **swing
    )
    expected = end_admittance(
        end=reducing_valve_end(passive_conductance=passive, **end), frequency=frequency
    )
    away = abs(-into_line - expected)
    assert away <= 1e-12 * max(abs(expected), g)


def test_the_reducing_valve_rests_on_its_line_and_saturates():
    """At rest q = (G + g)(p_set - p), relieves above the set pressure, never beyond q_max."""
    for pressure in (59e5, 60e5, 61e5):
        line = {"pressure": pressure, "set_pressure": 60e5}
        rest = REDUCING["conductance"] * (60e5 - pressure)
        valve_at_rest = {"flow": rest, "rate": 0.0, **line, **REDUCING}
        assert supply.reducing_valve_acceleration(**valve_at_rest) == 0
        found = supply.reducing_valve_flow(
            flow=rest, largest_flow=1e-3, passive_conductance=2e-12, **line
        )
        assert found == pytest.approx((1e-10 + 2e-12) * (60e5 - pressure), rel=1e-12)
        for flow, limit in ((5e-3, 1e-3), (-5e-3, -1e-3)):
            full = {"flow": flow, "largest_flow": 1e-3, **line}
            assert supply.reducing_valve_flow(**full) == limit


def test_ziegler_nichols_table():
    """P 0.5 K_u; PI 0.45 K_u, T_u/1.2; PID 0.6 K_u, T_u/2, T_u/8."""
    point = {"ultimate_gain": 10.0, "ultimate_period": 2.4}
    assert loop.ziegler_nichols(law="p", **point) == (5.0, math.inf, 0.0)
    assert loop.ziegler_nichols(law="pi", **point) == pytest.approx((4.5, 2.0, 0.0))
    assert loop.ziegler_nichols(law="pid", **point) == pytest.approx((6.0, 1.2, 0.3))


@given(st.floats(1.0, 1e4), st.floats(1e-3, 1.0), st.floats(1.5, 10.0))
def test_margin_rules_damp_the_slow_pair_critically(limit, speed, margin):
    """With K = K_u/margin, s^2 + K K_v s + K K_v/T_i has a double root."""
    point = {"ultimate_gain": limit, "velocity_gain": speed, "gain_margin": margin}
    assert loop.margin_rules(law="p", **point) == (limit / margin, math.inf, 0.0)
    gain, integral, derivative = loop.margin_rules(law="pi", **point)
    assert (gain, derivative) == (limit / margin, 0.0)
    assert (gain * speed) ** 2 == pytest.approx(4 * gain * speed / integral, rel=1e-12)


def test_an_unknown_law_is_one_clear_line():
    """Another word names the choices; the margin rules say where a PID comes from."""
    with pytest.raises(ValueError, match="law: pd; choose one of p, pi, pid"):
        loop.ziegler_nichols(law="pd", ultimate_gain=1.0, ultimate_period=1.0)
    with pytest.raises(ValueError, match="law: pid; the margin rules support p or pi"):
        loop.margin_rules(law="pid", ultimate_gain=1.0, velocity_gain=1.0)


def servo(spool_frequency):
    """Polynomials, ultimate point and velocity gain of the check cylinder's position loop."""
    slopes = holding_valve.valve_slopes(
        rated_coefficient=RATED, leakage_coefficient=LEAKAGE, signal=10.0, supply_pressure=140e5,
        return_pressure=0.0, pressure_a=70e5, pressure_b=70e5, extending=True,
    )  # fmt: skip
    area_a, area_b = math.pi / 4 * 0.032**2, math.pi / 4 * (0.032**2 - 0.018**2)
    sides = {
        name: Side(area, (8e-6 + area * 0.08) / 1.4e9, end=LineEnd((leak,)), flow_gain=gain)
        for name, area, leak, gain in (
            ("side_a", area_a, slopes.conductance_a, slopes.gain_a),
            ("side_b", area_b, slopes.conductance_b, -slopes.gain_b),
        )
    }
    model = linear_actuator(mass=30.0, damping=400.0, **sides)
    loop = open_loop(model=model, natural_frequency=spool_frequency, damping_ratio=0.7)
    top, low = np.array(loop.numerator, float), np.array(loop.denominator, float)
    return top, low, ultimate_gain(loop=loop), top[0] / low[1]


def peak_and_margin(top, low, gains):
    """Largest |T(i w)|, and the factor of gain to instability, of PID with T_f = 1 ms, NumPy."""
    poly = np.polynomial.polynomial
    lead = poly.polymul([1 / gains.integral_time, 1.0], [1.0, 1e-3])
    lead = gains.proportional_gain * poly.polyadd(lead, [0.0, 0.0, gains.derivative_time])
    top, low = poly.polymul(lead, top), poly.polymul(poly.polymul([0.0, 1.0], [1.0, 1e-3]), low)
    s = 2j * math.pi * np.geomspace(0.05, 500, 20001)
    loop = poly.polyval(s, top) / poly.polyval(s, low)
    factors = np.geomspace(1.0, 6.0, 300)
    grow = [poly.polyroots(poly.polyadd(k * top, low)).real.max() > 1e-3 for k in factors]
    return np.max(np.abs(loop / (1 + loop))), factors[np.argmax(grow)]


@pytest.mark.parametrize(("spool_frequency", "limit"), [(250.0, 416.743), (400.0, 333.220)])
def test_margin_rules_are_calm_on_a_lightly_damped_cylinder(spool_frequency, limit):
    """PI peaks at 2/sqrt(3), as on a bare integrator, and keeps its gain margin of 3.

    Ziegler-Nichols PI peaks above 3, its PID is within a fifth of swinging for ever.
    """
    top, low, point, speed = servo(spool_frequency)
    assert point.gain == pytest.approx(limit, abs=1e-3)
    gains = loop.margin_rules(law="pi", ultimate_gain=point.gain, velocity_gain=speed)
    peak, margin = peak_and_margin(top, low, gains)
    assert peak == pytest.approx(2 / math.sqrt(3), rel=0.01)
    assert margin == pytest.approx(3.0, rel=0.02)
    rule = {"ultimate_gain": point.gain, "ultimate_period": 1 / point.frequency}
    assert peak_and_margin(top, low, loop.ziegler_nichols(law="pi", **rule))[0] > 3
    assert peak_and_margin(top, low, loop.ziegler_nichols(law="pid", **rule))[1] < 1.2
