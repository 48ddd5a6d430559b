"""Claims about edges by a curve, and about plays that stand for hysteresis and threshold."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from actuator_opt.models import holding_valve, metering_curve, metering_spool, play, valve
from actuator_opt.models.metering_curve import CurveEdge, CurveSpool, MeteringCurve

SUPPLY, FULL = 140e5, 10.0
LINEAR = MeteringCurve.through((0.0, 1.0), (0.0, 1.0))
K10, K0 = 3.6e-7, 1.2e-9
PRESSURES = {"supply_pressure": SUPPLY, "return_pressure": 2e5, "pressure_a": 80e5,
             "pressure_b": 62e5}  # fmt: skip


def spool(edges):
    """A spool with four edges, or with one edge four times."""
    return CurveSpool(*(edges * (4 if len(edges) == 1 else 1)), FULL)


# ---- curves ----


@given(
    st.lists(st.tuples(st.floats(0.01, 1.0), st.floats(0.0, 5.0)), min_size=2, max_size=12),
    st.floats(-0.2, 1.2),
)
def test_a_curve_is_the_monotone_interpolant(points, share):
    """Values, slopes and their continuation are those of `PchipInterpolator`."""
    x, y = np.cumsum([step for step, _ in points]), np.cumsum([rise for _, rise in points])
    curve = MeteringCurve.through(x.tolist(), y.tolist())
    theirs = PchipInterpolator(x, y)
    np.testing.assert_allclose(
        metering_curve.monotone_slopes(places=x.tolist(), values=y.tolist()),
        theirs.derivative()(x), rtol=1e-9, atol=1e-9,
    )  # fmt: skip
    place = x[0] + share * (x[-1] - x[0])
    inside = np.clip(place, x[0], x[-1])
    value = metering_curve.curve_value(curve=curve, share=place)
    assert value == pytest.approx(float(theirs(inside)), rel=1e-9, abs=1e-9)
    slope = metering_curve.curve_slope(curve=curve, share=place)
    if place in x:
        return
    outside = place < x[0] or place > x[-1]
    expected = 0.0 if outside else float(theirs.derivative()(inside))
    assert slope == pytest.approx(expected, rel=1e-8, abs=1e-8)


@pytest.mark.parametrize(
    "values", [(0.0, 1.0, 0.3, 0.8), (2.0, 0.0, 0.0, 1.0), (0.0, 9.0, 8.9, 9.0)]
)
def test_slopes_of_a_curve_that_turns(values):
    """Zero where the secants change sign; at the ends at most three times the secant."""
    x = (0.0, 0.1, 0.7, 1.0)
    found = metering_curve.monotone_slopes(places=x, values=values)
    np.testing.assert_allclose(found, PchipInterpolator(x, values).derivative()(x), atol=1e-12)


def test_a_dead_band_stays_closed():
    """Between points of zero flow there is none at all, and an edge opens beyond them."""
    curve = MeteringCurve.through((0.0, 0.02, 0.05, 0.1, 1.0), (0.0, 0.0, 0.0, 0.3, 4.0))
    for share in np.linspace(0.0, 0.05, 11):
        assert metering_curve.curve_value(curve=curve, share=share) == 0
    level = metering_curve.curve_value(curve=curve, share=curve.start)
    assert level == pytest.approx(0.01 * 4.0, rel=1e-9)
    assert 0.05 < curve.start < 0.1


# ---- edges ----


def test_equal_linear_edges_are_the_course():
    """K = K0 + (K10 - K0) u for all edges: flows, gains and conductances of the course's law."""
    one = spool([CurveEdge(LINEAR, K10 - K0, K0)])
    course = {"rated_coefficient": K10, "full_signal": FULL, "leakage_supply": K0,
              "leakage_tank": K0}  # fmt: skip
    for signal in (-12.0, -4.0, 0.0, 0.3, 10.0):
        ours = metering_spool.spool_flows(spool=one, signal=signal, **PRESSURES)
        theirs = valve.valve_flows(signal=signal, **course, **PRESSURES)
        np.testing.assert_allclose(ours, theirs, rtol=1e-12)
    both = metering_spool.held_slopes(spool=one, **PRESSURES)
    for extending, way in ((True, both.extending), (False, both.retracting)):
        theirs = holding_valve.valve_slopes(
            rated_coefficient=K10, leakage_coefficient=K0, signal=FULL, extending=extending,
            **PRESSURES,
        )  # fmt: skip
        np.testing.assert_allclose(way, theirs, rtol=1e-9)


def test_each_edge_has_its_own_flow():
    """Q = K sqrt(dp) of every edge by hand, and the other edges closed."""
    coefficients = (3.0e-7, 1.5e-7, 2.8e-7, 1.4e-7)
    one = spool([CurveEdge(LINEAR, k) for k in coefficients])
    drops = (SUPPLY - 80e5, SUPPLY - 62e5, 80e5 - 2e5, 62e5 - 2e5)
    for signal, opened in ((5.0, (0, 3)), (-5.0, (1, 2))):
        flows = metering_spool.spool_flows(spool=one, signal=signal, **PRESSURES)
        for k, flow in enumerate(flows):
            by_hand = 0.5 * coefficients[k] * math.sqrt(drops[k]) if k in opened else 0.0
            assert flow == pytest.approx(by_hand, rel=1e-5)


def test_the_held_spool_balances_a_chamber():
    """The place found is the root of the inflow; slopes are those of the flows there."""
    curve = MeteringCurve.through((-1.0, -0.1, 0.0, 0.2, 1.0), (0.01, 0.02, 0.1, 2.0, 9.0))
    one = spool([CurveEdge(curve, 5e-8), CurveEdge(curve, 3e-8), CurveEdge(curve, 4e-8),
                 CurveEdge(curve, 2e-8)])  # fmt: skip

    def inflow(x, pressure):
        signal = FULL * x
        stated = PRESSURES | {"pressure_a": pressure}
        return metering_spool.spool_flows(spool=one, signal=signal, **stated).into_a

    root = brentq(lambda x: inflow(x, 80e5), -1.0, 1.0, xtol=1e-15)
    found = metering_spool.holding_stroke(
        spool=one, chamber="a", into=SUPPLY - 80e5, out=80e5 - 2e5
    )
    assert found == pytest.approx(root, abs=1e-12)
    slopes = metering_spool.held_slopes(spool=one, **PRESSURES)
    place = max(root, curve.start)
    step = 1e-7
    gain = (inflow(place + step, 80e5) - inflow(place - step, 80e5)) / (2 * step * FULL)
    assert slopes.extending.gain_a == pytest.approx(gain, rel=1e-5)
    conductance = (inflow(root, 80e5 - 1.0) - inflow(root, 80e5 + 1.0)) / 2.0
    assert slopes.held_a == pytest.approx(conductance, rel=1e-6)


# ---- plays ----


def exact_play(signal, half_width, start=0.0):
    """The play operator over the samples of a signal."""
    output, values = start, []
    for u in signal:
        output = max(u - half_width, min(u + half_width, output))
        values.append(output)
    return np.array(values)


@given(st.floats(0.0, 1.0), st.floats(0.05, 1.0))
def test_two_plays_have_hysteresis_and_threshold(share, hysteresis):
    """On a full cycle the branches are H apart; a reversal has no effect up to T, then half."""
    threshold = share * hysteresis
    widths = play.play_half_widths(hysteresis=hysteresis, threshold=threshold)
    up, down = np.linspace(-10.0, 10.0, 4001), np.linspace(10.0, -10.0, 4001)
    cycle = np.concatenate((up, down, up))
    mean = sum(exact_play(cycle, width) for width in widths) / 2
    falling, rising = mean[4001:8002], mean[8002:]
    apart = np.interp(0.0, rising, up) - np.interp(0.0, falling[::-1], down[::-1])
    assert apart == pytest.approx(hysteresis, abs=1e-9)
    back = np.array([10.0, 10.0 - 0.999 * threshold, 10.0 - threshold - 0.01])
    after = sum(exact_play(np.concatenate((up, back)), width) for width in widths)[-3:] / 2
    assert after[1] == pytest.approx(after[0], abs=1e-12)
    moved = (
        0.01 if widths[0] == widths[1] else 0.005 + max(0.01 - 2 * (widths[1] - widths[0]), 0) / 2
    )
    assert after[0] - after[2] == pytest.approx(moved, abs=1e-9)


def test_the_rate_of_a_play_tends_to_the_play():
    """Integrated over a slow sine, it stays within rate/corner of the play operator."""
    frequency, r, step = 200.0, 0.3, 2e-6
    t = np.arange(0.0, 0.05, step)
    u = 2.0 * np.sin(2 * math.pi * 20 * t)
    y, values = 0.0, []
    for command in u:
        values.append(y)
        y += step * play.play_rate(command=command, output=y, half_width=r,
                                   natural_frequency=frequency)  # fmt: skip
    lag = 2.0 * 2 * math.pi * 20 / (play.FASTER * 2 * math.pi * frequency)
    assert np.abs(np.array(values) - exact_play(u, r)).max() < 1.1 * lag


def test_band_of_position():
    """0.3 V at 500 V/m is 0.6 mm."""
    assert play.band_of_position(signal_band=0.3, gain=500.0) == pytest.approx(0.6e-3)
    assert math.isnan(play.band_of_position(signal_band=0.3, gain=0.0))
