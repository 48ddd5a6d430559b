"""Claims about edges with lap and clearance, and about the spool that holds a load with them.

The textbook's null coefficients [Merritt1967] are written out by hand here.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.optimize import brentq

from actuator_opt.models import lapped_edge, lapped_spool, metering_spool, valve
from actuator_opt.models.lapped_spool import LappedSpool, SpoolEdge

RHO, MU, C, W = 870.0, 0.03, 0.611, 20e-3
SUPPLY = 140e5
OIL = {"density": RHO, "dynamic_viscosity": MU, "area_gradient": W, "flow_coefficient": C}
ROOT = C * W * math.sqrt(2 / RHO)
UM = 1e-6
PLACES = st.floats(-300 * UM, 300 * UM)
CLEARANCES = st.floats(0.5 * UM, 20 * UM)


def spool(*overlaps, clearance=None, rounding=0.0, stroke=1e-3):
    """A spool with edges P-A, P-B, A-T, B-T of these overlaps; one number serves all four."""
    if len(overlaps) == 1:
        overlaps *= 4
    edges = (SpoolEdge(overlap, W, clearance, rounding) for overlap in overlaps)
    return LappedSpool(*edges, stroke, 10.0, RHO, MU, C)


def flows(one, signal, pressure_a, pressure_b):
    """Flows of the edges with no pressure in the tank line."""
    return metering_spool.spool_flows(
        spool=one, signal=signal, supply_pressure=SUPPLY, return_pressure=0.0,
        pressure_a=pressure_a, pressure_b=pressure_b,
    )  # fmt: skip


def blocked(one, signal):
    """Pressures in blocked ports A and B, each by a balance of its two edges."""
    return [
        brentq(lambda p, port=port: flows_of(one, signal, p)[port], 1.0, SUPPLY - 1.0, rtol=1e-14)
        for port in (0, 1)
    ]


def flows_of(one, signal, pressure):
    """Flows into A and B with one pressure in both."""
    found = flows(one, signal, pressure, pressure)
    return found.into_a, found.into_b


# ---- one edge ----


def test_zero_lap_leaks_as_a_slot():
    """At zero lap and small pressure the conductance is pi w c^2/(32 mu), the textbook's K_c0."""
    for c in (1 * UM, 5 * UM):
        found = lapped_edge.lapped_edge_conductance(
            uncovered=0.0, clearance=c, pressure_drop=0.0, **OIL
        )
        assert found == pytest.approx(math.pi * W * c**2 / (32 * MU), rel=1e-14)


def test_a_long_lap_leaks_as_a_gap_and_an_open_edge_is_an_orifice():
    """Lap: w c^3 dp/(12 mu L) within one clearance of length; open: C w y sqrt(2 dp/rho)."""
    c, drop = 4 * UM, 70e5
    for lap in (100 * UM, 400 * UM):
        flow = lapped_edge.lapped_edge_flow(uncovered=-lap, clearance=c, pressure_drop=drop, **OIL)
        assert flow == pytest.approx(W * c**3 * drop / (12 * MU * lap), rel=c / lap)
    flow = lapped_edge.lapped_edge_flow(uncovered=1e-3, clearance=c, pressure_drop=drop, **OIL)
    assert flow == pytest.approx(ROOT * 1e-3 * math.sqrt(drop), rel=3e-3)


def test_rounded_corners_open_early():
    """Corners of radius r: the opening is the distance of two circles, and the lap is 2 r less."""
    c, r = 3 * UM, 5 * UM
    for y in (60 * UM, 200 * UM):
        gap = lapped_edge.edge_gap(uncovered=y, clearance=c, rounding=r)
        assert gap.opening == pytest.approx(math.hypot(y + 2 * r, c + 2 * r) - 2 * r, rel=2e-3)
    gap = lapped_edge.edge_gap(uncovered=-200 * UM, clearance=c, rounding=r)
    assert gap.length == pytest.approx(200 * UM - 2 * r, abs=1.1 * c)
    assert gap.opening == pytest.approx(c, rel=1e-3)


@given(PLACES, CLEARANCES, st.floats(0.0, 10 * UM), st.floats(-3e7, 3e7))
def test_flow_is_the_root_of_the_drops_in_series(y, c, r, drop):
    """The drops rho q|q|/(2 C^2 w^2 h^2) + mu/w (32/(pi h^2) + 12 L/c^3) q add up."""
    arguments = {"uncovered": y, "clearance": c, "rounding": r}
    q = lapped_edge.lapped_edge_flow(pressure_drop=drop, **arguments, **OIL)
    gap = lapped_edge.edge_gap(**arguments)
    h, length = gap.opening, gap.length
    turbulent = RHO * q * abs(q) / (2 * (C * W * h) ** 2)
    laminar = MU / W * (32 / (math.pi * h**2) + 12 * length / c**3) * q
    assert turbulent + laminar == pytest.approx(drop, rel=1e-9, abs=1e-9)


@given(PLACES, st.one_of(st.none(), CLEARANCES), st.floats(1e4, 3e7))
def test_slopes_are_the_derivatives_and_the_flow_never_falls(y, c, drop):
    """Gain and conductance are central differences, and not negative, on both sides of the edge."""
    arguments = {"clearance": c, "rounding": 0.0 if c is None else 2 * UM, **OIL}

    def flow(place, pressure):
        return lapped_edge.lapped_edge_flow(uncovered=place, pressure_drop=pressure, **arguments)

    at = {"uncovered": y, "pressure_drop": drop, **arguments}
    gain, conductance = (
        lapped_edge.lapped_edge_gain(**at),
        lapped_edge.lapped_edge_conductance(**at),
    )
    assert gain >= 0
    assert conductance >= 0
    step = 1e-9 if c is None else 1e-3 * c
    if c is not None or abs(y) > step:
        change = (flow(y + step, drop) - flow(y - step, drop)) / (2 * step)
        largest = ROOT * math.sqrt(drop)
        assert gain == pytest.approx(change, rel=1e-4, abs=1e-6 * largest)
    h = 1e-4 * drop
    change = (flow(y, drop + h) - flow(y, drop - h)) / (2 * h)
    assert conductance == pytest.approx(change, rel=1e-5, abs=1e-25)


# ---- the textbook's curves ----


def test_an_open_centre_has_twice_the_flow_gain():
    """At the null K_q0 is C w sqrt(p_S/rho), and twice that within the underlap."""
    ideal = C * W * math.sqrt(SUPPLY / RHO)
    for overlap, factor in ((0.0, 1.0), (-40 * UM, 2.0)):
        one, step = spool(overlap), 1e-4
        up = flows(one, step, SUPPLY / 2, SUPPLY / 2).into_a
        down = flows(one, -step, SUPPLY / 2, SUPPLY / 2).into_a
        per_metre = (up - down) / (2 * step * one.stroke / 10.0)
        assert per_metre == pytest.approx(factor * ideal, rel=1e-5)


def test_leakage_of_an_open_centre_falls_with_the_stroke():
    """Blocked: 2 C w sqrt(p_S/rho) (U^2 - x^2)/sqrt(U^2 + x^2), which is zero from x = U on."""
    under, one = 40 * UM, spool(-40 * UM)
    for share in (0.0, 0.3, 0.6, 0.9):
        x = share * under
        a, b = blocked(one, 10.0 * x / one.stroke)
        found = flows(one, 10.0 * x / one.stroke, a, b).supply
        ideal = 2 * C * W * math.sqrt(SUPPLY / RHO) * (under**2 - x**2) / math.hypot(under, x)
        assert found == pytest.approx(ideal, rel=1e-4)


def test_pressure_gain_of_an_open_centre():
    """K_p0 = 2 p_S/U at the null: the load pressure rises twice as steeply as K_q0/K_c0 of one."""
    under, one = 40 * UM, spool(-40 * UM)
    x = 1e-3 * under
    a, b = blocked(one, 10.0 * x / one.stroke)
    assert (a - b) / x == pytest.approx(2 * SUPPLY / under, rel=1e-4)


def test_leakage_and_pressure_gain_of_a_critical_centre():
    """Null leakage pi w c^2 p_S/(32 mu), less the turbulent part; overlap lowers both.

    The laminar limit is approached as the viscosity rises.
    """
    c, thick = 3 * UM, 3.0
    one = replace(spool(0.0, clearance=c), dynamic_viscosity=thick)
    leak = flows(one, 0.0, SUPPLY / 2, SUPPLY / 2).supply
    assert leak == pytest.approx(math.pi * W * c**2 * SUPPLY / (32 * thick), rel=1e-2)
    lapped = spool(10 * UM, clearance=c)
    assert (
        flows(lapped, 0.0, SUPPLY / 2, SUPPLY / 2).supply
        < 0.5 * flows(spool(0.0, clearance=c), 0.0, SUPPLY / 2, SUPPLY / 2).supply
    )


def test_sag_of_a_closing_edge_is_half_that_of_one_that_keeps_its_leakage():
    """Equal leakage at the null: the signal that holds a load halves when the other edge closes."""
    under = 2 * UM
    one, per_volt = spool(-under), 1e-3 / 10.0
    leak, full = ROOT * under, ROOT * (1e-3 + under)
    load = 10e5

    def course(signal):
        found = valve.valve_flows(
            signal=signal, rated_coefficient=full, leakage_supply=leak, leakage_tank=leak,
            full_signal=10.0, supply_pressure=SUPPLY, return_pressure=0.0,
            pressure_a=(SUPPLY + load) / 2, pressure_b=(SUPPLY - load) / 2,
        )  # fmt: skip
        return found.into_a

    kept = brentq(course, -1.0, 1.0, xtol=1e-12)
    closing = metering_spool.holding_stroke(
        spool=one, chamber="a", into=(SUPPLY - load) / 2, out=(SUPPLY + load) / 2
    )
    assert closing / per_volt / kept == pytest.approx(0.5, abs=0.02)
    # p_L/p_S = [(U+x)^2 - (U-x)^2]/[(U+x)^2 + (U-x)^2] = 2 U x/(U^2 + x^2)
    ratio = load / SUPPLY
    exact = under * (1 - math.sqrt(1 - ratio**2)) / ratio
    assert closing == pytest.approx(exact, rel=1e-4)


# ---- held loads ----


def test_the_spool_stops_at_its_stroke():
    """Half the signal is half the stroke; beyond full signal the spool stays at its stop."""
    places = lapped_spool.spool_stroke(spool=spool(0.0), signal=np.array([-5.0, 10.0, 12.0]))
    np.testing.assert_allclose(places, [-0.5e-3, 1e-3, 1e-3], rtol=1e-15)


@given(
    st.floats(-30 * UM, 30 * UM), st.one_of(st.none(), st.floats(1 * UM, 8 * UM)),
    st.floats(10e5, 130e5), st.floats(-2e-6, 2e-6), st.sampled_from("ab"),
)  # fmt: skip
def test_the_held_chamber_gains_no_oil(overlap, clearance, pressure, lost, chamber):
    """At the holding stroke as much oil enters as leaves, whatever lap, pressure and leakage."""
    one = spool(overlap, overlap + 2 * UM, overlap - UM, overlap, clearance=clearance)
    x = metering_spool.holding_stroke(
        spool=one, chamber=chamber, into=SUPPLY - pressure, out=pressure, lost=lost
    )
    signal = 10.0 * x / one.stroke * (1 if chamber == "a" else -1)
    found = flows(one, signal, pressure, pressure)
    into = found.into_a if chamber == "a" else found.into_b
    assert into == pytest.approx(lost, abs=1e-7 * ROOT * 1e-3 * math.sqrt(SUPPLY) * 1e-2)


@pytest.mark.parametrize("clearance", [None, 3 * UM])
def test_slopes_are_those_of_the_whole_valve(clearance):
    """An underlapped spool: gains and conductances are differences about the held load."""
    one, force = spool(-30 * UM, clearance=clearance), 20e5
    a, b = (SUPPLY + force) / 2, (SUPPLY - force) / 2
    slopes = metering_spool.held_slopes(
        spool=one, supply_pressure=SUPPLY, return_pressure=0.0, pressure_a=a, pressure_b=b
    )
    held = brentq(lambda u: flows(one, u, a, b).into_a, -5.0, 5.0, xtol=1e-14)
    du, dp = 1e-5, 1e3
    up, down = flows(one, held + du, a, b), flows(one, held - du, a, b)
    gain_a, gain_b = (up.into_a - down.into_a) / (2 * du), (down.into_b - up.into_b) / (2 * du)
    less, more = (flows(one, held, a + way, b + way) for way in (-dp, dp))
    leak_a, leak_b = (less.into_a - more.into_a) / (2 * dp), (less.into_b - more.into_b) / (2 * dp)
    for way in (slopes.extending, slopes.retracting):
        np.testing.assert_allclose(way, (gain_a, gain_b, leak_a, leak_b), rtol=1e-5)
    assert (slopes.held_a, slopes.held_b) == pytest.approx((leak_a, leak_b), rel=1e-5)


def test_an_ideal_spool_is_the_course_valve_without_leakage():
    """Zero lap, no clearance: the gains of `holding_valve` with K0 = 0, and no conductance."""
    from actuator_opt.models.holding_valve import valve_slopes

    one, full = spool(0.0), ROOT * 1e-3
    pressures = {
        "supply_pressure": SUPPLY, "return_pressure": 0.0, "pressure_a": 80e5, "pressure_b": 60e5
    }  # fmt: skip
    both = metering_spool.held_slopes(spool=one, **pressures)
    for way, extending in ((both.extending, True), (both.retracting, False)):
        other = valve_slopes(
            rated_coefficient=full, leakage_coefficient=0.0, signal=10.0, extending=extending,
            **pressures,
        )  # fmt: skip
        np.testing.assert_allclose(way, other, rtol=1e-12)


def test_a_covered_edge_is_taken_where_it_opens():
    """With overlap each direction has the gain of its own open edge; the held spool leaks less."""
    c = 3 * UM
    both = metering_spool.held_slopes(
        spool=spool(25 * UM, clearance=c), supply_pressure=SUPPLY, return_pressure=0.0,
        pressure_a=SUPPLY / 2, pressure_b=SUPPLY / 2,
    )  # fmt: skip
    ideal = C * W * math.sqrt(SUPPLY / RHO) * 1e-3 / 10.0
    for way in (both.extending, both.retracting):
        assert way.gain_a == pytest.approx(ideal, rel=0.2)
        assert way.gain_b == pytest.approx(ideal, rel=0.2)
        assert both.held_a < 0.2 * way.conductance_a


def test_a_curve_gives_the_stroke_and_its_slope():
    """Straight lines through the points, mirrored; the slope is that of the part beyond a point."""
    points = ((0.05, 0.0), (0.5, 0.2), (0.8, 0.7))
    one = replace(spool(0.0), curve=points)
    signals = np.linspace(-12.0, 12.0, 97)
    table = np.array([(0.0, 0.0), *points, (1.0, 1.0)])
    expected = np.sign(signals) * 1e-3 * np.interp(abs(signals) / 10.0, *table.T)
    found = lapped_spool.spool_stroke(spool=one, signal=signals)
    np.testing.assert_allclose(found, expected, atol=1e-18)
    for place, slope in ((0.0, 0.2 / 0.45), (-1e-4, 0.2 / 0.45), (3e-4, 0.5 / 0.3), (8e-4, 1.5)):
        value = lapped_spool.stroke_slope(spool=one, place=place)
        assert value == pytest.approx(slope * 1e-3 / 10.0)
    assert one.signal_share(0.0) == pytest.approx(0.05)
    assert one.signal_share(0.45e-3) == pytest.approx(0.65)
    both = metering_spool.held_slopes(
        spool=one, supply_pressure=SUPPLY, return_pressure=0.0, pressure_a=SUPPLY / 2,
        pressure_b=SUPPLY / 2,
    )  # fmt: skip
    ideal = C * W * math.sqrt(SUPPLY / RHO) * 1e-3 / 10.0
    assert both.extending.gain_a == pytest.approx(0.2 / 0.45 * ideal, rel=1e-5)


# ---- motion of the spool ----


@given(st.floats(0.05, 3.0))
def test_bandwidth_is_that_of_the_transfer_function(damping):
    """|1/(1 - r^2 + 2 i zeta r)|^2 is 1/2 at the bandwidth, and the damping follows back."""
    r = valve.spool_bandwidth(damping_ratio=damping)
    assert abs(1 / (1 - r**2 + 2j * damping * r)) ** 2 == pytest.approx(0.5, rel=1e-9)
    assert valve.spool_damping(bandwidth=r) == pytest.approx(damping, rel=1e-6)
    assert r < valve.WIDEST


def test_a_limited_spool_is_a_lag_below_its_limit():
    """Far below the limit both laws agree; far above it, the speed ends at the limit."""
    lag = {"natural_frequency": 100.0, "damping_ratio": 0.7}
    state = {"command": 0.3, "opening": 0.1, "rate": -2.0}
    free = valve.spool_acceleration(**state, **lag)
    assert valve.limited_spool_acceleration(**state, **lag, fastest=1e6) == pytest.approx(free)
    assert valve.limited_spool_acceleration(
        command=10.0, opening=-10.0, rate=50.0, **lag, fastest=50.0
    ) == pytest.approx(0.0, abs=1e-9)
