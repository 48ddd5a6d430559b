"""Small simulated experiments that measure the figures of the linear tier, each with its own runs.

Amplitudes are small against stroke, signal and pressure, and stated with every figure, as with
friction all figures depend on them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, exp, inf, log, pi, sqrt
from typing import NamedTuple

import numpy as np

from ...base.numeric import Array
from ...design.scenario.signals import Force, Position
from ..harmonic import dynamic_stiffness_of_record, harmonic_fit
from .stand import Measured, Record, Stand

STROKE_SHARE = 0.05
"""Amplitude of a sine relative to the stroke (a choice: small)."""
SIGNAL_SHARE = 0.5
"""Largest share of the valve's full signal that a sine may use (a choice: never saturated)."""
FORCE_SHARE = 0.05
"""Size of a push or a force oscillation, relative to supply pressure times area (a choice:
small)."""
SAMPLES = 40
"""Samples per period."""
FITTED = 4.0
"""Periods of a sine in one fit."""
STEADY = 0.01
"""Change of the open loop between fits that counts as steady (a choice)."""
LONGEST = 100.0
"""Periods after which a sine is accepted even if not steady."""
HALF = 1 / sqrt(2)
"""Amplitude ratio at -3 dB."""
EXACT = 2e-3
"""Relative tolerance of a search."""
MOST = 16.0
"""Factor on a linear figure within which the nonlinear one is searched (a choice)."""
LASTING = 1e-3
"""Decay per period below which an oscillation counts as sustained (a choice)."""
FIRST, EARLY, LATE = (0.0, 4.0), (8.0, 12.0), (18.0, 22.0)
"""Windows after a push, in periods, to compare for growth or decay."""
UNEVEN = 2.0
"""Ratio of half-period lengths above which the motion is not a decay (a choice)."""
FADED = 0.01
"""Share of the first amplitude below which a decay is not evaluated (a choice)."""


SWINGS = 8.0
"""Periods over which a decay is evaluated (a choice: leakage shifts closed chambers meanwhile)."""
RINGING = 20.0
"""Periods of a resonance after which its oscillation has died out (a choice)."""
SHAPED = 0.6
"""Frequency relative to the resonance up to which a force is applied in parts (a choice)."""
BESIDE = (0.7, 1.0, 1.4)
"""Factors on a linear crossover among which the nonlinear one is searched."""
SLIDING = (0.9, 1.0, 1.1)
STICKING = (0.8, 0.9, 1.0, 1.1, 1.22, 1.35, 1.5)
"""The same on a resonance; bristles of sticking seals add stiffness to the oil."""
HOW_PHASE = "position over error of the closed loop, at unit gain"
Loop = Callable[[float], complex]
"""Open loop of the linear tier over frequency [Hz], its gain included."""


class Sine(NamedTuple):
    """Complex ratios of the fundamentals in a closed loop."""

    closed: complex
    """Position over reference."""
    opened: complex
    """Position over error: the describing function of the open loop."""
    distortion: float
    """Residual of the position relative to the amplitude of its fundamental."""
    record: Record


def _inset(stand: Stand, room: float) -> Stand:
    """The stand with a clearance to both ends of the stroke."""
    room = min(room, 0.45 * stand.plant.stroke)
    place = min(max(stand.position, room), stand.plant.stroke - room)
    return stand if place == stand.position else stand.but(position=place)


def placed(stand: Stand) -> Stand:
    """The stand moved off the stroke ends by the amplitude of the experiments."""
    return _inset(stand, 1.5 * STROKE_SHARE * stand.plant.stroke * stand.scale)


def held_place(stand: Stand) -> Stand:
    """The stand moved off the stroke ends by the creep of a held piston (2 % of the stroke)."""
    return _inset(stand, 0.02 * stand.plant.stroke)


def amplitude(stand: Stand, frequency: float, opened: complex) -> float:
    """Amplitude of a reference [m]; `opened` is the open loop expected by the linear tier.

    5 % of the stroke, limited to half the valve's signal for the expected error and to a tenth of
    the supply pressure for the expected inertia force.
    """
    plant = stand.plant
    assert plant.valve is not None
    errs = 1 / max(abs(1 + opened), 1e-3)
    signal = SIGNAL_SHARE * plant.valve.signal / (stand.gain * errs)
    inertia = 2 * FORCE_SHARE * plant.supply_pressure * plant.area_b
    moved = plant.moving_mass(stand.position)
    swing = inertia / (moved * (2 * pi * frequency) ** 2 * abs(opened) * errs)
    return stand.scale * min(STROKE_SHARE * plant.stroke, signal, swing)


def sine(stand: Stand, frequency: float, size: float, cycles: float) -> Sine:
    """The loop following a sine, evaluated after some cycles, or later if not steady yet."""
    part = Position(shape="sine", value=size, frequency=frequency)
    while True:
        record = stand.closed(
            gain=stand.gain,
            duration=(cycles + 2 * FITTED) / frequency,
            sample_time=1 / (SAMPLES * frequency),
            reference=(part,),
        )
        middle = (cycles + FITTED) / frequency
        first = _fitted(record.within(cycles / frequency, middle), frequency)
        last = _fitted(record.within(middle), frequency)
        steady = abs(first.opened / last.opened - 1) < STEADY
        if steady or _no_sine(last) or cycles > LONGEST:
            return last
        cycles *= 2


def _fitted(record: Record, frequency: float) -> Sine:
    """Ratios of a record of whole cycles."""
    asked, found, error = (
        harmonic_fit(time=record.time, values=record.signals[name], frequency=frequency)
        for name in ("reference", "position", "error")
    )
    size = max(abs(found.amplitude), 1e-30)
    return Sine(
        found.amplitude / asked.amplitude,
        found.amplitude / error.amplitude,
        found.residual / size,
        record,
    )


def bandwidth(stand: Stand, expected: float, loop: Loop) -> Measured:
    """Frequency at which the closed loop's fundamental falls to -3 dB, by secants."""
    size = amplitude(stand, expected, loop(expected))
    how = f"sine of {1e3 * size:.3g} mm"
    seen: list[Sine] = []

    def above(share: float) -> float:
        seen.append(sine(stand, expected * exp(share), size, 2.0))
        return log(abs(seen[-1].closed) / HALF)

    share = _root(above, slope=-1.0)
    facts = stand.facts(seen[-1].record)
    why = _no_sine(seen[-1])
    if share is None or why:
        why = why or f"no -3 dB point within a factor of {MOST:g} of the linear one"
        return Measured({"bandwidth": None}, how, facts, why)
    return Measured({"bandwidth": expected * exp(share)}, how, facts)


def _no_sine(one: Sine) -> str:
    if one.distortion < 0.5:
        return ""
    return "the response is not sinusoidal: the loop oscillates by itself, or sticks"


def _root(function: Callable[[float], float], slope: float) -> float | None:
    """Zero of a function of a logarithmic ratio, from 0 on, by secant steps up to 0.5.

    None without convergence in ten steps.
    """
    x, y = 0.0, function(0.0)
    for _ in range(10):
        if abs(y) < EXACT:
            return x - y / slope
        step = max(-0.5, min(0.5, -y / slope))
        if abs(x + step) > log(MOST):
            return None
        new = function(x + step)
        if (new - y) / step * slope > 0:
            slope = (new - y) / step
        x, y = x + step, new
    return None


def phase_margin(
    stand: Stand, crossovers: Sequence[float], resonances: Sequence[float], loop: Loop
) -> Measured:
    """Least phase margin over the crossovers, from error and position of the closed loop.

    L = position/error of the fundamentals; where |L| is one, the margin is |pi + arg L|. The loop
    stays closed, so friction and saturation act as in service. Crossovers are searched near the
    linear ones and near the resonances, which sticking seals raise.
    """
    from scipy.optimize import brentq

    seen: dict[float, Sine] = {}

    def above(share: float) -> float:
        frequency = exp(share)
        if share not in seen:
            size = amplitude(stand, frequency, loop(frequency))
            cycles = min(max(2.0, 3 * frequency / stand.bandwidth), RINGING)
            seen[share] = sine(stand, frequency, size, cycles)
        return log(abs(seen[share].opened))

    around = STICKING if "bristles" in stand.rest() else SLIDING
    asked = [f * k for f in crossovers for k in BESIDE]
    asked += [f * k for f in resonances for k in around]
    grid = sorted(log(f) for f in set(asked))
    while above(grid[0]) <= 0 and exp(grid[0]) > stand.bandwidth / MOST:
        grid.insert(0, grid[0] - log(BESIDE[-1]))
    values = [above(share) for share in grid]
    found = [
        float(brentq(above, low, high, xtol=EXACT))
        for low, high, one, two in zip(grid, grid[1:], values, values[1:], strict=False)
        if (one > 0) != (two > 0)
    ]
    one = next((seen[share] for share in found if _no_sine(seen[share])), seen[grid[0]])
    why = _no_sine(one)
    if why or not found:
        value = None if why else inf
        return Measured({"phase_margin": value}, HOW_PHASE, stand.facts(one.record), why)
    at = min(found, key=lambda share: abs(np.angle(-seen[share].opened)))
    margin = abs(float(np.angle(-seen[at].opened)))
    size = 0.5 * np.ptp(seen[at].record.signals["reference"])
    how = f"{HOW_PHASE}: {exp(at):.3g} Hz, sine of {1e3 * size:.3g} mm"
    return Measured({"phase_margin": margin}, how, stand.facts(seen[at].record))


def ultimate_gain(stand: Stand, expected: float, frequency: float) -> Measured:
    """Gain above which oscillations after a push persist, searched from the linear one."""
    from scipy.optimize import brentq

    push = FORCE_SHARE * stand.full_force * stand.scale
    how = f"push of {push:.3g} N for {500 / frequency:.3g} ms"
    seen: dict[float, Record] = {}

    def growth(share: float) -> float:
        rate, seen[share] = _growth(stand, expected * exp(share), frequency, push)
        return rate + LASTING

    step, low, high, most = log(1.25), 0.0, 0.0, log(MOST)
    value = growth(0.0)
    way = 1 if value < 0 else -1
    while (value < 0) == (way > 0) and abs(high) < most:
        low, high, step = high, way * min(abs(high) + step, most), 2 * step
        value = growth(high)
    facts = stand.facts(seen[high])
    if (value < 0) == (way > 0):
        found = {"ultimate_gain": inf if way > 0 else 0.0}
        words = "no oscillation up to" if way > 0 else "it oscillates down to 1 over"
        return Measured(found, how, facts, f"{words} {MOST:g} times the linear one")
    share = float(brentq(growth, low, high, xtol=2 * EXACT))
    near = min(seen, key=lambda one: abs(one - share))
    facts = stand.facts(seen[near])
    how += f", amplitude {1000.0 * facts.swing:.2g} mm"
    return Measured({"ultimate_gain": expected * exp(share)}, how, facts)


def _growth(stand: Stand, gain: float, frequency: float, push: float) -> tuple[float, Record]:
    """Growth of the speed oscillation per period, and the record of its early window.

    An oscillation larger at the end than just after the push is sustained, however irregular.
    """
    period = 1 / frequency
    record = stand.closed(
        gain=gain,
        duration=LATE[1] * period,
        sample_time=period / SAMPLES,
        force=(Force(shape="pulse", value=push, start=0.0, end=0.5 * period),),
    )
    first, early, late = (record.within(a * period, b * period) for a, b in (FIRST, EARLY, LATE))
    pushed, before, after = (
        max(float(np.ptp(one.signals["speed"])), 1e-15) for one in (first, early, late)
    )
    rate = max(log(after / before) / (LATE[0] - EARLY[0]), -1.0)
    return max(rate, LASTING) if after >= pushed else rate, early


def dynamic_stiffness(stand: Stand, ends: str, frequency: float, resonance: float) -> Measured:
    """Stiffness under a sinusoidal force at the rod, with terminated ports.

    Below the resonance the force starts in three parts of 1, 2, 1 quarters, half a resonance period
    apart, so that the transients cancel.
    """
    settle, cycles, wait = RINGING / resonance, 10.0, 0.5 / resonance
    shares = (0.25, 0.5, 0.25) if frequency < SHAPED * resonance else (1.0,)
    swing = 2 * FORCE_SHARE * stand.full_force * stand.scale
    parts = [
        Force(shape="sine", value=share * swing, frequency=frequency, start=k * wait)
        for k, share in enumerate(shares)
    ]
    if len(shares) > 1:
        swing *= cos(pi * frequency * wait) ** 2
    record = stand.held(
        duration=settle + cycles / frequency,
        sample_time=1 / (SAMPLES * frequency),
        ends=ends,
        force=parts,
    ).within(settle)
    facts = stand.facts(record)
    how = f"force of {swing:.3g} N at {frequency:.3g} Hz, amplitude {1000.0 * facts.swing:.2g} mm"
    names = ("dynamic_stiffness", "dynamic_phase")
    if facts.stopped:
        return Measured(dict.fromkeys(names), how, facts, "the piston creeps onto its stop")
    one = dynamic_stiffness_of_record(
        time=record.time,
        position=record.signals["position"],
        force=-record.signals["load_force"],
        frequency=frequency,
    ).stiffness
    return Measured(dict(zip(names, (abs(one), float(np.angle(one))), strict=True)), how, facts)


def decay(stand: Stand, ends: str, resonance: float) -> Measured:
    """Natural frequency and damping ratio after a step of force, with terminated ports.

    From successive extremes of the speed with spans D_i: zeta from the logarithmic decrement
    ln(D_0/D_n)/n over half periods, down to a hundredth; f = f_d/sqrt(1 - zeta^2).
    """
    push = FORCE_SHARE * stand.full_force * stand.scale
    record = stand.held(
        duration=SWINGS / resonance,
        sample_time=1 / (2 * SAMPLES * resonance),
        ends=ends,
        force=(Force(shape="constant", value=push),),
    )
    facts = stand.facts(record)
    how = f"step of {push:.3g} N, amplitude {1000.0 * facts.swing:.2g} mm"
    names = ("natural_frequency", "damping_ratio")
    if facts.stopped:
        return Measured(dict.fromkeys(names), how, facts, "the piston creeps onto its stop")
    times, values = _extremes(record.time, record.signals["speed"])
    spans = np.abs(np.diff(values))
    faded = np.flatnonzero(spans < FADED * spans[:1])
    kept = int(faded[0]) if faded.size else len(spans)
    if kept < 2:
        why = f"overdamped or stuck: it comes to rest after {len(spans)} half periods"
        return Measured(dict.fromkeys(names), how, facts, why)
    halves = np.diff(times[: kept + 1])
    if np.max(halves) > UNEVEN * np.min(halves):
        why = "stick-slip: half periods of uneven length, no decay"
        return Measured(dict.fromkeys(names), how, facts, why)
    decrement = log(spans[0] / spans[kept - 1]) / (kept - 1)
    ratio = decrement / sqrt(pi * pi + decrement * decrement)
    damped = (kept - 1) / (2 * float(times[kept - 1] - times[0]))
    found = damped / sqrt(1 - ratio * ratio), ratio
    how += f", evaluated over {kept} half periods"
    return Measured(dict(zip(names, found, strict=True)), how, facts)


def _extremes(time: Array, values: Array) -> tuple[Array, Array]:
    """Times and values of the extremes, by parabolas through three samples."""
    rising = np.diff(values) > 0
    at = np.flatnonzero(rising[1:] != rising[:-1]) + 1
    left, here, right = values[at - 1], values[at], values[at + 1]
    bend = left - 2 * here + right
    off = np.where(bend != 0, 0.5 * (left - right) / np.where(bend != 0, bend, 1.0), 0.0)
    step = time[at + 1] - time[at]
    return time[at] + off * step, here - 0.25 * (left - right) * off
