"""A lapped spool in the simulation, against equations written out here alone.

The other side is a few lines of continuity and Newton's law, integrated by `solve_ivp`, with the
textbook's edge: q = K max(y, 0) sqrt(dp), or laminar and turbulent drop in series by a root search.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from simulation_case import AREA_A, AREA_B, BAR, OIL, VALVE, plant, run, scenario

from actuator_opt.models import linear
from actuator_opt.models.lapped_spool import LappedSpool, SpoolEdge
from actuator_opt.models.loop import ControllerGains
from actuator_opt.models.metering_spool import held_slopes
from actuator_opt.simulation.assemble import assemble
from actuator_opt.simulation.linear import Linear

SUPPLY, MODULUS, RHO, MU = 140 * BAR, 1.4e9, 870.0, 32e-6 * 870
STROKE, WIDTH, C = 0.5e-3, 0.02, 0.611
MASS, DAMPING, LENGTH, DEAD = 30.0, 400.0, 0.16, 8e-6
OMEGA, ZETA = 2 * math.pi * 250.0, 0.7


def lapped(*overlaps, clearance=None, shares=(1.0, 1.0, 1.0, 1.0), **changes):
    """A valve with edges P-A, P-B, A-T, B-T of these overlaps; one number serves all four."""
    overlaps = overlaps * (4 if len(overlaps) == 1 else 1)
    edges = (
        SpoolEdge(overlap, share * WIDTH, clearance)
        for overlap, share in zip(overlaps, shares, strict=True)
    )
    spool = LappedSpool(*edges, STROKE, 10.0, RHO, MU, C)
    return replace(VALVE, metering=spool, **changes)


def sharp(y, width, drop):
    """An ideal edge."""
    return C * width * max(y, 0.0) * math.sqrt(2 / RHO) * math.copysign(abs(drop) ** 0.5, drop)


def leaking(clearance):
    """An edge with clearance, smooth about y = 0 as the docstring says; the flow by a search."""

    def flow(y, width, drop):
        free = (y + math.hypot(y, clearance)) / 2
        lap = (math.hypot(y, clearance) - y) / 2
        h = math.hypot(free, clearance)
        length = lap**2 / (lap + (15 * math.pi / 32 - 0.5) * clearance)
        laminar = MU / width * (32 / (math.pi * h**2) + 12 * length / clearance**3)
        turbulent = RHO / (2 * (C * width * h) ** 2)
        # the positive root, written so that nothing cancels
        root = math.sqrt(laminar**2 + 4 * turbulent * abs(drop))
        return 2 * drop / (laminar + root)

    return flow


def twin(edge, gain, area_b, reference, load, *, overlap=0.0, shares=(1.0, 1.0, 1.0, 1.0)):
    """Rates of position, speed, both pressures, spool and its speed."""
    pa_w, pb_w, at_w, bt_w = (WIDTH * share for share in shares)

    def rates(t, state):
        x, v, p_a, p_b, o, w = state
        u = max(-10.0, min(10.0, gain * (reference(t) - x)))
        s = max(-STROKE, min(STROKE, STROKE * o / 10.0))
        q_a = edge(s - overlap, pa_w, SUPPLY - p_a) - edge(-s - overlap, at_w, p_a)
        q_b = edge(-s - overlap, pb_w, SUPPLY - p_b) - edge(s - overlap, bt_w, p_b)
        v_a, v_b = DEAD + AREA_A * x, DEAD + area_b * (LENGTH - x)
        return [
            v,
            (AREA_A * p_a - area_b * p_b - DAMPING * v - load(t)) / MASS,
            MODULUS / v_a * (q_a - AREA_A * v),
            MODULUS / v_b * (q_b + area_b * v),
            w,
            OMEGA**2 * (u - o) - 2 * ZETA * OMEGA * w,
        ]

    return rates


def both(valve, edge, *, gain, area_b=AREA_B, load=0.0, step=0.02, duration=0.6, **more):
    """Our run and the twin's states at its samples: a step of position, then one of the load."""
    hold = 70 * BAR * (AREA_A - area_b)
    own = plant(valve=valve, area_b=area_b)
    scene = scenario(
        duration=duration,
        control={"position_gain": gain, "position": [
            {"shape": "step", "start": 0.05, "value": step}]},
        load={"force": [{"shape": "constant", "value": hold},
                        {"shape": "step", "start": 0.35, "value": load}]},
        initial={"position": 0.06, "pressure_a": 70 * BAR, "pressure_b": 70 * BAR},
    )  # fmt: skip
    ours = run(scene, own, ControllerGains(gain, math.inf, 0.0))
    rates = twin(
        edge, gain, area_b, lambda t: 0.06 + (step if t >= 0.05 else 0.0),
        lambda t: hold + (load if t >= 0.35 else 0.0), **more,
    )  # fmt: skip
    state, parts = np.array([0.06, 0.0, 70 * BAR, 70 * BAR, 0.0, 0.0]), []
    times, first = np.unique(ours.time, return_index=True)
    for begin, end in ((0.0, 0.05), (0.05, 0.35), (0.35, duration)):
        inside = (
            times[(times >= begin) & (times < end)] if end < duration else times[times >= begin]
        )
        found = solve_ivp(
            rates, (begin, end), state, method="LSODA", rtol=1e-9, max_step=1e-3,
            atol=[1e-11, 1e-9, 1.0, 1.0, 1e-8, 1e-5], t_eval=np.union1d(inside, end),
        )  # fmt: skip
        assert found.success
        parts.append(found.y[:, : len(inside)])
        state = found.y[:, -1]
    return ours, first, np.concatenate(parts, axis=1)


CASES = {
    "differential": {"gain": 150.0, "load": 2000.0},
    "symmetric": {"gain": 150.0, "load": 2000.0, "area_b": AREA_A},
    "matched 2:1": {"gain": 120.0, "load": 1000.0, "area_b": 0.5 * AREA_A,
                    "shares": (1.0, 0.5, 1.0, 0.5)},
    "underlap": {"gain": 60.0, "load": 2000.0, "overlap": -20e-6},
    "overlap": {"gain": 150.0, "load": 2000.0, "overlap": 15e-6},
    "leaking": {"gain": 150.0, "load": 2000.0, "clearance": 3e-6},
    "leaking overlap": {"gain": 150.0, "load": 2000.0, "clearance": 5e-6, "overlap": 10e-6},
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_cylinder_and_spool_meet_an_independent_integration(name):
    """Step, then load: position within 1e-5 of its span (asked: 0.5 %), pressures 2e-4 (1 %)."""
    case = dict(CASES[name])
    clearance, overlap = case.pop("clearance", None), case.get("overlap", 0.0)
    valve = lapped(overlap, clearance=clearance, shares=case.get("shares", (1.0,) * 4))
    edge = sharp if clearance is None else leaking(clearance)
    ours, first, theirs = both(valve, edge, **case)
    for signal, row, most in (("position", 0, 1e-5), ("pressure_a", 2, 2e-4),
                              ("pressure_b", 3, 2e-4)):  # fmt: skip
        apart = np.abs(ours.signals[signal][first] - theirs[row]).max() / np.ptp(theirs[row])
        assert apart < most, f"{name} {signal}: {apart:.2e}"
    # the balance of energy closes too
    assert ours.lost_energy() < 1e-4 * ours.turnover()


def test_the_load_sags_half_as_far_as_with_a_constant_leakage():
    """2 kN on a symmetric cylinder: the closing edge halves the sag of the course's law."""
    under = 2e-6
    root = C * WIDTH * math.sqrt(2 / RHO)
    leak = root * under
    course = replace(VALVE, rated=root * STROKE, leakage_supply=leak, leakage_tank=leak)
    sags = []
    for valve in (course, lapped(-under)):
        scene = scenario(
            duration=1.5,
            control={"position_gain": 60.0, "position": [{"shape": "constant", "value": 0.0}]},
            load={"force": [{"shape": "step", "start": 0.1, "value": 2000.0}]},
            initial={"position": 0.08},
        )
        found = run(scene, plant(valve=valve, area_b=AREA_A), ControllerGains(60.0, math.inf, 0.0))
        sags.append(0.08 - float(np.mean(found.signals["position"][-100:])))
    # sharp edges: p_L/p_S = 2 U x/(U^2 + x^2); x is U_max/stroke times the gain times the sag
    ratio = 2000.0 / AREA_A / SUPPLY
    exact = under * (1 - math.sqrt(1 - ratio**2)) / ratio * 10.0 / STROKE / 60.0
    assert sags[1] == pytest.approx(exact, rel=0.02)
    assert sags[1] / sags[0] == pytest.approx(0.45, abs=0.05)


def test_both_tiers_have_the_same_loop():
    """The static tier's slopes give the frequency response of the linearised circuit."""
    own = plant(valve=lapped(-20e-6, clearance=3e-6))
    hold = 70 * BAR * (AREA_A - AREA_B)
    scene = scenario(
        control={"position": [{"shape": "constant", "value": 0.0}]},
        load={"force": [{"shape": "constant", "value": hold}]}, initial={"position": 0.08},
    )  # fmt: skip
    ours = Linear.of(assemble(scene, own, {}, None, linear=True)).about(position=0.08).loops
    slopes = held_slopes(
        spool=own.valve.metering, supply_pressure=SUPPLY, return_pressure=0.0,
        pressure_a=70 * BAR, pressure_b=70 * BAR,
    )  # fmt: skip
    omega = np.array([5.0, 100.0, 400.0, 900.0])
    for loop, way in zip(ours, (slopes.extending, slopes.retracting), strict=True):
        sides = [
            linear.Side(
                area=area, compliance=volume / OIL.bulk_modulus,
                end=linear.LineEnd((leak,)), flow_gain=gain,
            )
            for area, volume, leak, gain in (
                (AREA_A, DEAD + AREA_A * 0.08, way.conductance_a, way.gain_a),
                (AREA_B, DEAD + AREA_B * 0.08, way.conductance_b, -way.gain_b),
            )
        ]  # fmt: skip
        model = linear.linear_actuator(side_a=sides[0], side_b=sides[1], mass=MASS, damping=DAMPING)
        s = 1j * omega
        spool = OMEGA**2 / (s**2 + 2 * ZETA * OMEGA * s + OMEGA**2)
        plain = sum(c * s**i for i, c in enumerate(model.drive)) / sum(
            c * s**i for i, c in enumerate(model.characteristic)
        )
        np.testing.assert_allclose(loop.at(omega), plain * spool, rtol=2e-3)


def test_overlap_is_passed_before_the_loop_is_linearised():
    """Within the lap the valve does nothing; the loops are those of the edges that just open."""
    own, ideal = (plant(valve=lapped(overlap)) for overlap in (15e-6, 0.0))
    scene = scenario(
        control={"position": [{"shape": "constant", "value": 0.0}]},
        load={"force": [{"shape": "constant", "value": 70 * BAR * (AREA_A - AREA_B)}]},
        initial={"position": 0.08},
    )
    rates = [
        [loop.steady_rate for loop in
         Linear.of(assemble(scene, one, {}, None, linear=True)).about(position=0.08).loops]
        for one in (own, ideal)
    ]  # fmt: skip
    assert min(rates[0]) > 0
    np.testing.assert_allclose(*rates, rtol=1e-2)


def test_a_curve_with_a_dead_band_is_linearised_beyond_it():
    """The loop has the slope of the curve where its flow begins, in both directions."""
    rates = []
    for points in ((), ((0.04, 0.0), (0.5, 0.23))):
        valve = lapped(0.0)
        own = plant(valve=replace(valve, metering=replace(valve.metering, curve=points)))
        scene = scenario(
            control={"position": [{"shape": "constant", "value": 0.0}]},
            load={"force": [{"shape": "constant", "value": 70 * BAR * (AREA_A - AREA_B)}]},
            initial={"position": 0.08},
        )
        loops = Linear.of(assemble(scene, own, {}, None, linear=True)).about(position=0.08).loops
        rates.append([loop.steady_rate for loop in loops])
    np.testing.assert_allclose(rates[1], 0.5 * np.array(rates[0]), rtol=1e-2)


def test_a_jump_passes_the_dead_band():
    """Without load, P control stops at the lap: error o U/(s K_p); the jump removes almost all."""
    overlap, gain = 15e-6, 60.0
    edge = overlap / STROKE * 10.0
    errors = []
    for jump in (None, edge):
        control = {"position_gain": gain, "position": [
            {"shape": "step", "start": 0.05, "value": 0.02}]}  # fmt: skip
        scene = scenario(
            duration=1.0, control=control | ({} if jump is None else {"dead_band_jump": jump}),
            load={"force": [{"shape": "constant", "value": 70 * BAR * (AREA_A - AREA_B)}]},
            initial={"position": 0.06, "pressure_a": 70 * BAR, "pressure_b": 70 * BAR},
        )  # fmt: skip
        found = run(scene, plant(valve=lapped(overlap)), ControllerGains(gain, math.inf, 0.0))
        errors.append(0.08 - float(found.signals["position"][-1]))
    assert errors[0] == pytest.approx(edge / gain, rel=0.05)
    # u (1 + jump/band) = lap, with the band of 0.1 V
    assert errors[1] == pytest.approx(edge / gain / (1 + edge / 0.1), rel=0.1)


def test_a_slow_spool_moves_at_its_limit():
    """A step of 8 V at 200 V/s takes 40 ms; after 20 ms the spool is at 4 V."""
    scene = scenario(
        duration=0.1, signal=[{"shape": "step", "start": 0.01, "value": 8.0}],
        held_ports={"pressure_a": 70 * BAR, "pressure_b": 70 * BAR},
    )  # fmt: skip
    found = run(scene, plant(valve=lapped(0.0, slew_rate=200.0)))
    spool = np.interp([0.03, 0.09], found.time, found.signals["spool"])
    lag = 1 / (2 * ZETA * OMEGA) * 200.0
    assert spool[0] == pytest.approx(4.0 - lag, abs=0.02)
    assert spool[1] == pytest.approx(8.0, abs=1e-3)
    rate = found.state("spool rate")
    assert 0.99 * 200.0 < np.max(rate) <= 200.0 * 1.0001


def test_search_of_the_twin_is_the_root():
    """The leaking edge of this file solves its own pressure balance."""
    flow, c = leaking(3e-6), 3e-6
    for y in (-20e-6, 0.0, 20e-6):
        h, lap = math.hypot((y + math.hypot(y, c)) / 2, c), (math.hypot(y, c) - y) / 2
        length = lap**2 / (lap + (15 * math.pi / 32 - 0.5) * c)

        def balance(q, h=h, length=length):
            viscous = MU / WIDTH * (32 / (math.pi * h**2) + 12 * length / c**3) * q
            return viscous + RHO * q**2 / (2 * (C * WIDTH * h) ** 2) - 70e5

        assert flow(y, WIDTH, 70e5) == pytest.approx(brentq(balance, 0.0, 1e-2), rel=1e-9)
