"""Valves as data sheets state them, in the simulation: K per edge, flow curves, hysteresis.

The other side is a few lines of continuity and Newton's law with `PchipInterpolator` and a play,
integrated by `solve_ivp`, and the describing function of a play by a Fourier integral.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq
from simulation_case import AREA_A, AREA_B, BAR, MIDDLE, OIL, VALVE, plant, run, scenario

from actuator_opt.design.valve import Valve
from actuator_opt.models import linear
from actuator_opt.models.loop import ControllerGains
from actuator_opt.models.metering_spool import held_slopes
from actuator_opt.models.play import FASTER, play_half_widths
from actuator_opt.simulation.assemble import assemble
from actuator_opt.simulation.linear import ControllerLaw, Linear
from actuator_opt.studies.plant import valve_data

SUPPLY, MASS, DAMPING, LENGTH, DEAD = 140 * BAR, 30.0, 400.0, 0.16, 8e-6
FREQUENCY, ZETA, FULL = 250.0, 0.7, 10.0
OMEGA = 2 * math.pi * FREQUENCY
LITRE = 1 / 60000
HELD = {"pressure_a": 70 * BAR, "pressure_b": 70 * BAR}
MOTION = {"natural_frequency": FREQUENCY, "damping_ratio": ZETA}


def valve(**stated):
    """A valve of the block `valve`, as the simulation takes it."""
    block = Valve.model_validate(MOTION | stated)

    def read(path):
        value = block
        for name in path.split("."):
            value = getattr(value, name, None)
        return value

    return valve_data(read, block, density=OIL.density, kinematic_viscosity=OIL.kinematic_viscosity)


ONE_FLOW = """signal [%]; q [l/min]
0; 0,02
3; 0,02
6; 0,4
10; 1,5
20; 5
45; 14
70; 25
100; 40
"""
PER_EDGE = """u [V],q_pa [l/min],q_bt [l/min],q_pb [l/min],q_at [l/min]
-10,0.01,0.01,18,39
-5,0.02,0.01,8,18
-1,0.05,0.04,1.2,2.6
-0.2,0.1,0.08,0.2,0.4
0,0.25,0.15,0.12,0.2
0.2,0.5,0.3,0.07,0.1
1,2.7,1.3,0.04,0.05
5,19,9,0.01,0.02
10,40,20,0.01,0.01
"""
COEFFICIENTS = {
    "pa": "6.8 l/min/sqrt(bar)", "pb": "3.4 l/min/sqrt(bar)",
    "at": "6.6 l/min/sqrt(bar)", "bt": "3.3 l/min/sqrt(bar)",
}  # fmt: skip


def hand_coefficients(name):
    """K [m^3/s/sqrt(Pa)] of the edges P-A, P-B, A-T, B-T over the share of the signal."""
    root = math.sqrt(35 * BAR)
    if name == "coefficients":
        k0 = 0.4 * LITRE / math.sqrt(50 * BAR)
        sizes = [x * LITRE / math.sqrt(BAR) for x in (6.8, 3.4, 6.6, 3.3)]
        rise = [lambda s, k=k: k0 + (k - k0) * min(max(s, 0.0), 1.0) for k in sizes]
    elif name == "one flow":
        rows = [line.replace(",", ".").split(";") for line in ONE_FLOW.splitlines()[1:]]
        x, q = np.array(rows, dtype=float).T
        curve = PchipInterpolator(x / 100, q * LITRE / root)
        rise = [lambda s: float(curve(min(max(s, 0.0), 1.0)))] * 4
    else:
        table = np.loadtxt(PER_EDGE.splitlines()[1:], delimiter=",")
        u, columns = table[:, 0] / 10, dict(zip(("pa", "bt", "pb", "at"), table.T[1:], strict=True))
        curves = [
            PchipInterpolator(u, columns["pa"]), PchipInterpolator(-u[::-1], columns["pb"][::-1]),
            PchipInterpolator(-u[::-1], columns["at"][::-1]), PchipInterpolator(u, columns["bt"]),
        ]  # fmt: skip
        rise = [lambda s, c=c: float(c(min(max(s, -1.0), 1.0))) * LITRE / root for c in curves]
    return rise


STATED = {
    "coefficients": {"edge_coefficients": COEFFICIENTS, "leakage_flow": "0.4 l/min"},
    "one flow": {"flow_curve": ONE_FLOW, "rated_drop": "35 bar"},
    "per edge": {"flow_curve": PER_EDGE, "rated_drop": "35 bar"},
}


def twin(edges, gain, widths, reference, load):
    """Rates of position, speed, both pressures, spool, its speed, and plays."""
    pa, pb, at, bt = edges

    def root(drop):
        return math.copysign(math.sqrt(abs(drop)), drop)

    def rates(t, state):
        x, v, p_a, p_b, o, w, *plays = state
        u = max(-FULL, min(FULL, gain * (reference(t) - x)))
        moved = [
            FASTER * OMEGA * (max(u - y - r, 0.0) + min(u - y + r, 0.0))
            for y, r in zip(plays, widths, strict=True)
        ]
        driven = sum(plays) / len(plays) if plays else u
        s = o / FULL
        q_a = pa(s) * root(SUPPLY - p_a) - at(-s) * root(p_a)
        q_b = pb(-s) * root(SUPPLY - p_b) - bt(s) * root(p_b)
        v_a, v_b = DEAD + AREA_A * x, DEAD + AREA_B * (LENGTH - x)
        return [
            v,
            (AREA_A * p_a - AREA_B * p_b - DAMPING * v - load(t)) / MASS,
            OIL.bulk_modulus / v_a * (q_a - AREA_A * v),
            OIL.bulk_modulus / v_b * (q_b + AREA_B * v),
            w,
            OMEGA**2 * (driven - o) - 2 * ZETA * OMEGA * w,
            *moved,
        ]

    return rates


@pytest.mark.parametrize("hysteresis", [{}, {"hysteresis": "4 %", "threshold": "1 %"}])
@pytest.mark.parametrize("name", STATED)
def test_cylinder_meets_an_independent_integration(name, hysteresis):
    """A step, then a load: position and spool within 1e-5 of their span, pressures 1e-4."""
    data, hold, gain = valve(**STATED[name], **hysteresis), 70 * BAR * (AREA_A - AREA_B), 100.0
    widths = play_half_widths(hysteresis=0.4, threshold=0.1) if hysteresis else ()
    assert data.plays == pytest.approx(widths)
    scene = scenario(
        duration=0.45,
        control={"position_gain": gain, "position": [
            {"shape": "step", "start": 0.02, "value": 0.02}]},
        load={"force": [{"shape": "constant", "value": hold},
                        {"shape": "step", "start": 0.3, "value": 1500.0}]},
        initial={"position": 0.06, "pressure_a": 70 * BAR, "pressure_b": 70 * BAR},
    )  # fmt: skip
    ours = run(scene, plant(valve=data), ControllerGains(gain, math.inf, 0.0), relative=1e-8)
    rates = twin(
        hand_coefficients(name), gain, widths, lambda t: 0.06 + (0.02 if t >= 0.02 else 0.0),
        lambda t: hold + (1500.0 if t >= 0.3 else 0.0),
    )  # fmt: skip
    state = np.array([0.06, 0.0, 70 * BAR, 70 * BAR, 0.0, 0.0, *(0.0 for _ in widths)])
    times, first = np.unique(ours.time, return_index=True)
    parts = []
    for begin, end in ((0.0, 0.02), (0.02, 0.3), (0.3, 0.45)):
        inside = times[(times >= begin) & ((times < end) | (end == 0.45))]
        found = solve_ivp(
            rates, (begin, end), state, method="LSODA", rtol=1e-8, max_step=1e-3,
            atol=[1e-11, 1e-9, 1.0, 1.0, 1e-8, 1e-5, *(1e-8 for _ in widths)],
            t_eval=np.union1d(inside, end),
        )  # fmt: skip
        assert found.success
        parts.append(found.y[:, : len(inside)])
        state = found.y[:, -1]
    theirs = np.concatenate(parts, axis=1)
    for signal, row, most in (("position", 0, 1e-5), ("pressure_a", 2, 1e-4),
                              ("pressure_b", 3, 1e-4), ("spool", 4, 1e-5)):  # fmt: skip
        apart = np.abs(ours.signals[signal][first] - theirs[row]).max() / np.ptp(theirs[row])
        assert apart < most, f"{signal}: {apart:.2e}"
    assert ours.lost_energy() < 1e-4 * ours.turnover()


@pytest.mark.parametrize("method", ["lsoda", "radau"])
@pytest.mark.parametrize(("hysteresis", "threshold"), [(0.4, 0.4), (0.4, 0.1), (0.1, 0.02)])
def test_hysteresis_and_threshold_of_a_slow_sweep(hysteresis, threshold, method):
    """Signals of equal flow differ by H, and a stop needs T to reverse, as the data sheet says."""
    data = valve(rated_flow="40 l/min", hysteresis=hysteresis / FULL, threshold=threshold / FULL)
    rate, top = 0.9, 9.0
    sweep = [
        {"shape": "ramp", "start": 0.0, "end": 10.0, "value": top},
        {"shape": "ramp", "start": 10.0, "end": 30.0, "value": -2 * top},
        {"shape": "ramp", "start": 30.0, "end": 50.0, "value": 2 * top},
        {"shape": "ramp", "start": 51.0, "end": 52.0, "value": -rate},
    ]
    made = run(
        scenario(duration=52.0, signal=sweep, held_ports=HELD), plant(valve=data),
        sample_time=1e-2, method=method,
    )  # fmt: skip
    t, q, u = made.time, made.signals["flow_a"], made.signals["signal"]
    falling, rising = (t > 11) & (t < 29), (t > 31) & (t < 49)
    lag = 2 * rate * (2 * ZETA / OMEGA + 1 / (FASTER * OMEGA))
    for level in (-0.4 * np.max(q), 0.0, 0.4 * np.max(q)):
        apart = np.interp(level, q[rising], u[rising]) - np.interp(
            level, q[falling][::-1], u[falling][::-1]
        )
        assert apart == pytest.approx(hysteresis + lag, abs=2e-4 * FULL * hysteresis)
    after = t >= 51.0
    spool = made.signals["spool"][after]
    change = top - u[after]
    begun = change[np.argmax(spool < spool[0] - 2e-4)]
    assert begun == pytest.approx(threshold, abs=0.02)


def mean_of_plays(samples, widths):
    """The mean of play operators over a signal of a second period of its samples."""
    total = np.zeros(len(samples))
    for width in widths:
        output, values = 0.0, []
        for u in np.concatenate((samples, samples)):
            output = max(u - width, min(u + width, output))
            values.append(output)
        total += np.array(values[len(samples) :]) / len(widths)
    return total


def describing_function(amplitude, widths, count=720):
    """Fundamental of the plays' output over that of their input, by a Fourier integral."""
    angle = 2 * np.pi * np.arange(count) / count
    output = mean_of_plays(amplitude * np.sin(angle), widths)
    return 2j / count * np.sum(output * np.exp(-1j * angle)) / amplitude


def limit_cycle(loop, law, widths):
    """Frequency [rad/s] and amplitude [V] with N(A) C(iw) L(iw) = -1."""

    def balance(omega):
        response = complex(law.at(np.array(omega)) * loop.at(np.array(omega)))
        least = min(widths)
        amplitude = brentq(
            lambda a: abs(describing_function(a, widths)) - 1 / abs(response),
            1.001 * least, 1e3 * least, rtol=1e-4,
        )  # fmt: skip
        return float(np.angle(-response * describing_function(amplitude, widths))), amplitude

    omega = brentq(lambda w: balance(w)[0], 8.0, 20.0, rtol=1e-3)
    return omega, balance(omega)[1]


@pytest.mark.parametrize("threshold", [0.4, 0.1])
def test_a_loop_with_integral_control_hunts_as_the_describing_function_says(threshold):
    """The linear loop is stable; with hysteresis its period and amplitude are met within 12 %."""
    widths = play_half_widths(hysteresis=0.4, threshold=threshold)
    widths = widths[:1] if threshold == 0.4 else widths
    gain, time = 200.0, 0.05
    scene = scenario(
        duration=5.0, initial=MIDDLE,
        control={"law": "pi", "position": [{"shape": "step", "start": 0.05, "value": 0.004}]},
    )  # fmt: skip
    amplitudes = {}
    for plays in ((), widths):
        own = plant(valve=replace(VALVE, plays=plays), area_b=AREA_A)
        made = run(scene, own, ControllerGains(gain, time, 0.0))
        late = made.time > 3.5
        amplitudes[plays] = np.ptp(made.signals["signal"][late]) / 2
    loop = Linear.of(assemble(scene, own, {}, None, linear=True)).about(position=0.08).loops[0]
    law = ControllerLaw(gain, time, 0.0, 1e-3)
    assert max(law.closed(loop).real) < 0
    assert amplitudes[()] < 1e-3
    omega, amplitude = limit_cycle(loop, law, widths)
    signal, at = made.signals["signal"][late], made.time[late]
    middle = signal.mean()
    turns = at[1:][(signal[:-1] < middle) & (signal[1:] >= middle)]
    assert amplitudes[widths] == pytest.approx(amplitude, rel=0.12)
    assert np.diff(turns).mean() == pytest.approx(2 * math.pi / omega, rel=0.12)


def test_a_proportional_loop_stops_within_the_band_of_position():
    """From either side the error is half of H/K_p, and a step of less than T/K_p has no effect."""
    gain, widths = 100.0, play_half_widths(hysteresis=0.4, threshold=0.1)
    own = plant(valve=replace(VALVE, plays=widths), area_b=AREA_A)
    errors = []
    for step in (0.01, -0.01):
        scene = scenario(
            duration=1.6, initial=MIDDLE,
            control={"position": [{"shape": "step", "start": 0.05, "value": step},
                                  {"shape": "step", "start": 1.3, "value": 0.09 * step}]},
        )  # fmt: skip
        made = run(scene, own, ControllerGains(gain, math.inf, 0.0))
        moment = np.searchsorted(made.time, 1.29)
        errors.append(0.08 + step - float(made.signals["position"][moment]))
        moved = np.abs(made.signals["position"][moment:] - made.signals["position"][moment])
        assert moved.max() < 5e-5  # a reversal by 0.9 mm, less than T/K_p = 1 mm
    assert abs(errors[0]) == pytest.approx(0.5 * 0.4 / gain, rel=0.15)
    assert errors[0] == pytest.approx(-errors[1], rel=1e-3)


def test_the_linear_model_leaves_out_the_plays():
    """The same loop with and without hysteresis; the circuit of the simulation has two states."""
    scene = scenario(control={"position": [{"shape": "constant", "value": 0.0}]}, initial=MIDDLE)
    loops, states = [], []
    for plays in ((), (0.05, 0.35)):
        own = plant(valve=replace(VALVE, plays=plays))
        model = Linear.of(assemble(scene, own, {}, None, linear=True))
        loops.append(model.about(position=0.08).loops[0])
        circuit = assemble(scene, own, {}, ControllerGains(100.0, math.inf, 0.0))
        states.append({state.name for state in circuit.system.states})
    np.testing.assert_allclose(*(loop.at(np.array([3.0, 80.0])) for loop in loops), rtol=1e-12)
    assert states[1] - states[0] == {"valve play 1", "valve play 2"}


@pytest.mark.parametrize("name", ["coefficients", "one flow"])
def test_both_tiers_have_the_same_loop(name):
    """The slopes of the held spool give the frequency response of the linearised circuit."""
    stated = dict(STATED[name])
    if name == "coefficients":  # equal edges hold both chambers at one place of the spool
        stated["edge_coefficients"] = dict.fromkeys(("pa", "pb", "at", "bt"), "6 l/min/sqrt(bar)")
    # beyond a dead band the valve moves the piston: equal areas keep the pressures of the rest
    area_b = AREA_B if name == "coefficients" else AREA_A
    own = plant(valve=valve(**stated), area_b=area_b)
    hold = 70 * BAR * (AREA_A - area_b)
    scene = scenario(
        control={"position": [{"shape": "constant", "value": 0.0}]},
        load={"force": [{"shape": "constant", "value": hold}]}, initial={"position": 0.08},
    )  # fmt: skip
    loops = Linear.of(assemble(scene, own, {}, None, linear=True)).about(position=0.08).loops
    slopes = held_slopes(
        spool=own.valve.metering, supply_pressure=SUPPLY, return_pressure=0.0,
        pressure_a=70 * BAR, pressure_b=70 * BAR,
    )  # fmt: skip
    omega = np.array([5.0, 100.0, 400.0, 900.0])
    for loop, way in zip(loops, (slopes.extending, slopes.retracting), strict=True):
        sides = [
            linear.Side(
                area=area, compliance=(DEAD + area * 0.08) / OIL.bulk_modulus,
                end=linear.LineEnd((leak,)), flow_gain=gain,
            )
            for area, leak, gain in (
                (AREA_A, way.conductance_a, way.gain_a), (area_b, way.conductance_b, -way.gain_b)
            )
        ]  # fmt: skip
        model = linear.linear_actuator(side_a=sides[0], side_b=sides[1], mass=MASS, damping=DAMPING)
        s = 1j * omega
        spool = OMEGA**2 / (s**2 + 2 * ZETA * OMEGA * s + OMEGA**2)
        plain = sum(c * s**i for i, c in enumerate(model.drive)) / sum(
            c * s**i for i, c in enumerate(model.characteristic)
        )
        np.testing.assert_allclose(loop.at(omega), plain * spool, rtol=5e-3)
