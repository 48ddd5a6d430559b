"""Small simulated experiments that measure the quantities that linear models predict.

The linear models of a design are called its 'linear tier'. In the simulation, a test stand holds
the design at a position under a constant force. Plant, friction, valve, supply and end stops are
those of the scenario; each experiment adds its own excitation and control loop. Amplitudes are
small compared with the stroke, the full valve signal and the supply pressure. Every result states
its amplitude, because friction makes results depend on it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field, replace
from math import cos, exp, inf, log, pi, sqrt
from typing import Any, NamedTuple

import numpy as np

from ...base.dataclass import dataclass
from ...base.numeric import Array
from ...design.scenario.model import (
    Controller,
    ForceSignal,
    Initial,
    PositionSignal,
    Scenario,
    ScenarioLoad,
    ValveSignal,
)
from ...models.loop import ControllerGains
from ...studies.plant import Plant
from ..assemble import assemble
from ..harmonic import dynamic_stiffness_of_record, harmonic_fit
from ..integrate import integrate

RELATIVE = 1e-7
"""Relative tolerance of an integration step at full amplitude; smaller amplitudes have a smaller
tolerance."""
FINEST = 1e-9
"""Smallest relative tolerance of an integration step: 0.1 nm for a position of 100 mm."""
SETTLED = 3.0
"""Time until a loop is at rest, in periods at its bandwidth frequency (our choice: a share of e^(-6
pi) of the motion then remains)."""


@dataclass(slots=True)
class RunCounter:
    """Counts the simulations."""

    runs: int = 0


@dataclass(frozen=True, slots=True)
class RunRecord:
    """Signals of a simulation over time, and its final states by name."""

    time: Array
    signals: Mapping[str, Array]
    last: Mapping[str, float]

    def within(self, begin: float, end: float = inf) -> RunRecord:
        """Samples between two times, without the first of two samples at the same time."""
        later = np.append(np.diff(self.time) > 0, True)
        chosen = (self.time >= begin) & (self.time <= end) & later
        signals = {name: values[chosen] for name, values in self.signals.items()}
        return RunRecord(self.time[chosen], signals, self.last)


@dataclass(frozen=True, slots=True)
class Facts:
    """Observations in a simulation that help to explain how it differs from the linear models."""

    swing: float
    """Amplitude of the position about a straight drift [m]."""
    travel: float
    """Bristle travel before the seals slip [m]; 0 without sticking friction."""
    saturated: float
    """Share of the time in which the valve signal is at its limit."""
    spool: tuple[float, float] | None
    """Smallest and largest position of the spool [V]."""
    pressures: tuple[float, float]
    """Mean pressures of chambers A and B [Pa]."""
    pulse: float
    """Amplitude of the pressure in chamber A [Pa]."""
    lowest: float
    """Lowest chamber pressure [Pa]."""
    stopped: bool
    """Whether the piston reached a stop."""


@dataclass(frozen=True, slots=True)
class ExperimentResult:
    """Results of an experiment; a missing result is None, and `why` states the reason."""

    values: Mapping[str, float | None]
    how: str
    facts: Facts | None = None
    why: str = ""


@dataclass(frozen=True, slots=True)
class Stand:
    """A plant held at a position; a constant external force balances its chamber pressures."""

    plant: Plant
    scenario: Scenario
    position: float
    pressure_a: float
    pressure_b: float
    gain: float = 0.0
    """Gain of the design's proportional position loop [V/m]; 0 if it has no such loop."""
    steady_gain: float = 0.0
    """A lower gain, at which the loop comes to rest even if it oscillates at `gain` [V/m]."""
    bandwidth: float = 1.0
    """Expected bandwidth of the loop, which determines how long it takes to come to rest [Hz]."""
    scale: float = 1.0
    """Factor on the amplitudes of all experiments."""
    tally: RunCounter = field(default_factory=RunCounter)
    rest_states: dict[str, float] = field(default_factory=dict)
    """States of the closed loop at rest, by name; empty until they are computed."""

    def with_changes(self, **changes: Any) -> Stand:
        """Copy the stand with some changes; its equilibrium is computed again when needed."""
        return replace(self, rest_states={}, **changes)

    def frictionless(self) -> Stand:
        """Copy the stand without sticking friction."""
        frictionless = self.scenario.friction.model_copy(update={"model": "none"})
        return self.with_changes(
            scenario=self.scenario.model_copy(update={"friction": frictionless})
        )

    @property
    def force(self) -> float:
        """External force that balances the chamber pressures [N], positive against extension."""
        return self.pressure_a * self.plant.area_a - self.pressure_b * self.plant.area_b

    @property
    def full_force(self) -> float:
        """Force of the supply pressure on the whole piston area [N]."""
        return self.plant.supply_pressure * self.plant.area_a

    def run(
        self,
        *,
        duration: float,
        sample_time: float,
        gain: float | None = None,
        ends: str | None = None,
        signal: float = 0.0,
        reference: Sequence[PositionSignal] = (),
        force: Sequence[ForceSignal] = (),
        start: Mapping[str, float] | None = None,
    ) -> RunRecord:
        """Simulate with a position loop if `gain` is given, else without a loop.

        Parameters
        ----------
        duration, sample_time : [s]
        gain : gain of a proportional position loop [V/m]; None for no loop
        ends : component at the far ends of the lines; None for the valve
        signal : constant valve signal if there is no loop [V]
        reference : reference signal of the loop, relative to the position of the stand
        force : force in addition to the force that balances the pressures
        start : initial states by name, in place of those of the stand
        """
        self.tally.runs += 1
        scenario = self.scenario.model_copy(
            update={
                "duration": duration,
                "sample_time": sample_time,
                "initial": Initial(
                    position=self.position, pressure_a=self.pressure_a, pressure_b=self.pressure_b
                ),
                "ends": ends,
                "motor": None,
                "held_ports": None,
                "load": ScenarioLoad(
                    force=(ForceSignal(shape="constant", value=self.force), *force)
                ),
                "signal": (ValveSignal(shape="constant", value=signal),) if signal else (),
                "control": None if gain is None else self._control(gain, reference),
                "requirements": {},
            }
        )
        gains = None if gain is None else ControllerGains(gain, inf, 0.0)
        circuit = assemble(scenario, self.plant, {}, gains)
        system = circuit.system
        system.states = [state for state in system.states if not state.integral]
        compiled = system.compiled()
        names = [state.name for state in system.states]
        if start is not None:
            initial = dict(zip(names, compiled.initial.tolist(), strict=True))
            begin = np.array([start.get(name, value) for name, value in initial.items()])
            compiled = replace(compiled, initial=begin)
        relative = max(RELATIVE * min(self.scale, 1.0), FINEST)
        trajectory = integrate(
            compiled, duration=duration, sample_time=sample_time, relative=relative
        )
        signals = compiled.signals(trajectory.time, trajectory.states, trajectory.flags)
        last = dict(zip(names, trajectory.states[:, -1].tolist(), strict=True))
        return RunRecord(trajectory.time, signals, last)

    def _control(self, gain: float, reference: Sequence[PositionSignal]) -> Controller:
        """A proportional position loop, with the rate limit of the scenario."""
        control = self.scenario.control
        return Controller(
            position=(*reference, PositionSignal(shape="constant", value=0.0)),
            tuning="stated",
            position_gain=gain,
            rate_limit=None if control is None else control.rate_limit,
        )

    @property
    def opening(self) -> float:
        """Distance of the spool from its centre at rest [V]; positive on the side that extends."""
        assert self.plant.valve is not None
        return self.rest()["spool"] - self.plant.valve.offset

    def rest(self) -> Mapping[str, float]:
        """States at rest, when the loop holds the plant at the stand's position; computed once.

        To supply the leakage of valve and piston, the spool must be off its centre, which causes a
        position error. A first simulation, at mid-stroke, measures this error; a second compensates
        it.
        """
        if not self.rest_states:
            duration = SETTLED / self.bandwidth * self.gain / self.steady_gain

            def resting(stand: Stand, error: float) -> Mapping[str, float]:
                part = PositionSignal(shape="constant", value=error)
                return stand.run(
                    duration=duration,
                    sample_time=duration / 20,
                    gain=self.steady_gain,
                    reference=(part,),
                ).last

            middle = resting(replace(self, position=0.5 * self.plant.stroke), 0.0)
            self.rest_states.update(resting(self, middle["spool"] / self.steady_gain))
        return self.rest_states

    def held(
        self, *, ends: str, duration: float, sample_time: float, force: Sequence[ForceSignal] = ()
    ) -> RunRecord:
        """Simulate without a control loop, with a given component at the far ends of the lines.

        If this is the valve, its signal stays constant at the value at rest.
        """
        if ends != "valve" or not self.steady_gain:
            return self.run(duration=duration, sample_time=sample_time, ends=ends, force=force)
        state = self.rest()
        return self.run(
            duration=duration,
            sample_time=sample_time,
            signal=state["spool"],
            force=force,
            start=state,
        )

    def closed(
        self,
        *,
        gain: float,
        duration: float,
        sample_time: float,
        reference: Sequence[PositionSignal] = (),
        force: Sequence[ForceSignal] = (),
    ) -> RunRecord:
        """Simulate the closed loop from rest.

        The reference is shifted so that the valve signal does not jump at the start.
        """
        state = self.rest()
        shift = state["position"] + state["spool"] / gain - self.position
        hold = PositionSignal(shape="constant", value=shift)
        return self.run(
            duration=duration,
            sample_time=sample_time,
            gain=gain,
            reference=(hold, *reference),
            force=force,
            start=state,
        )

    def facts(self, record: RunRecord) -> Facts:
        """Collect observations that help to explain a difference from the linear models."""
        t, signals = record.time, record.signals
        position = signals["position"]
        straight = np.polynomial.polynomial.polyfit(t - t[0], position, 1)
        oscillation = position - np.polynomial.polynomial.polyval(t - t[0], straight)
        spool = signals.get("spool")
        signal = signals.get("signal")
        valve = self.plant.valve
        full = inf if valve is None else valve.signal
        chambers = signals["pressure_a"], signals["pressure_b"]
        return Facts(
            swing=0.5 * float(np.ptp(oscillation)),
            travel=self.travel if "bristles" in signals else 0.0,
            saturated=0.0 if signal is None else float(np.mean(np.abs(signal) > 0.999 * full)),
            spool=None if spool is None else (float(np.min(spool)), float(np.max(spool))),
            pressures=(float(np.mean(chambers[0])), float(np.mean(chambers[1]))),
            pulse=0.5 * float(np.ptp(chambers[0])),
            lowest=float(min(np.min(chamber) for chamber in chambers)),
            stopped=bool(np.any(signals["stop_force"] != 0)),
        )

    @property
    def travel(self) -> float:
        """Bristle travel before the seals slip [m]."""
        return self.scenario.friction.bristle_travel or self.plant.seals.bristle_travel


STROKE_SHARE = 0.05
"""Amplitude of a sinusoidal reference, relative to the stroke (our choice: small)."""
SIGNAL_SHARE = 0.5
"""Largest share of the valve's full signal that a sine may use (our choice: the signal never
saturates)."""
FORCE_SHARE = 0.05
"""Size of a force step or force oscillation, relative to supply pressure times area (our choice:
small)."""
SAMPLES = 40
"""Samples per period of an oscillation."""
FITTED = 4.0
"""Number of periods of a sine that one fit of amplitude and phase covers."""
STEADY = 0.01
"""A sinusoidal response counts as steady if the open loop changes by less than this share between
two successive fits (our choice)."""
LONGEST = 100.0
"""Number of periods after which a sinusoidal response is evaluated even if it is not steady."""
HALF = 1 / sqrt(2)
"""Amplitude ratio at -3 dB, which defines the bandwidth."""
EXACT = 2e-3
"""Relative tolerance of the searches, such as for the bandwidth."""
MOST = 16.0
"""A value of the nonlinear system is searched for up to this factor above and below the value of
the linear models (our choice)."""
LASTING = 1e-3
"""Relative decay per period below which an oscillation counts as sustained (our choice)."""
FIRST, EARLY, LATE = (0.0, 4.0), (8.0, 12.0), (18.0, 22.0)
"""Time windows after a force pulse, in periods of the oscillation. Their amplitudes are compared to
see whether the oscillation grows or decays."""
UNEVEN = 2.0
"""Ratio of the longest to the shortest half period above which a motion does not count as a
decaying oscillation (our choice)."""
FADED = 0.01
"""Share of the first amplitude below which a decaying oscillation is not evaluated further (our
choice)."""
SWINGS = 8.0
"""Number of periods over which a decaying oscillation is simulated (our choice: over a longer time,
leakage would shift the piston between closed chambers)."""
RINGING = 20.0
"""Number of periods after which a resonant transient counts as died out (our choice)."""
SHAPED = 0.6
"""Ratio of excitation to resonance frequency up to which a sinusoidal force starts in three parts
to avoid transients (our choice; see `dynamic_stiffness`)."""
BESIDE = (0.7, 1.0, 1.4)
"""Factors on a crossover frequency of the linear models. The nonlinear crossover is searched for
between the resulting frequencies."""
SLIDING = (0.9, 1.0, 1.1)
STICKING = (0.8, 0.9, 1.0, 1.1, 1.22, 1.35, 1.5)
"""Factors on a resonance frequency of the linear models, for seals that slide and for seals that
stick. Crossovers are searched for between the resulting frequencies. Sticking seals raise the
resonance, because their bristles add stiffness."""
HOW_PHASE = "phase between control error and position, where both amplitudes are equal"
Loop = Callable[[float], complex]
"""Open loop of the linear models as a function of frequency [Hz], including the controller gain."""


class Sine(NamedTuple):
    """Response to a sinusoidal reference: complex amplitude ratios measured in a closed loop."""

    closed: complex
    """Position divided by reference."""
    opened: complex
    """Position divided by control error: the describing function of the open loop."""
    distortion: float
    """Part of the position that is not sinusoidal, relative to its amplitude at the excitation
    frequency."""
    record: RunRecord


def _inset(stand: Stand, clearance: float) -> Stand:
    """The stand, moved so that the piston has a clearance to both ends of the stroke."""
    clearance = min(clearance, 0.45 * stand.plant.stroke)
    place = min(max(stand.position, clearance), stand.plant.stroke - clearance)
    return stand if place == stand.position else stand.with_changes(position=place)


def placed(stand: Stand) -> Stand:
    """The stand, moved so far from the stroke ends that the experiments do not reach them."""
    return _inset(stand, 1.5 * STROKE_SHARE * stand.plant.stroke * stand.scale)


def held_place(stand: Stand) -> Stand:
    """A copy whose piston is at least 2 % of the stroke from both ends, because it may creep."""
    return _inset(stand, 0.02 * stand.plant.stroke)


def amplitude(stand: Stand, frequency: float, opened: complex) -> float:
    """Amplitude of a reference [m]; `opened` is the open loop that the linear models predict.

    The amplitude is 5 % of the stroke or less. It is also limited so that the expected control
    error uses at most half the valve's full signal, and the expected inertia force at most a tenth
    of the supply pressure.
    """
    plant = stand.plant
    assert plant.valve is not None
    error_ratio = 1 / max(abs(1 + opened), 1e-3)
    signal = SIGNAL_SHARE * plant.valve.signal / (stand.gain * error_ratio)
    inertia = 2 * FORCE_SHARE * plant.supply_pressure * plant.area_b
    moving_mass = plant.moving_mass(stand.position)
    swing = inertia / (moving_mass * (2 * pi * frequency) ** 2 * abs(opened) * error_ratio)
    return stand.scale * min(STROKE_SHARE * plant.stroke, signal, swing)


def sine(stand: Stand, frequency: float, size: float, cycles: float) -> Sine:
    """Simulate the closed loop with a sinusoidal reference.

    The response is evaluated after `cycles` periods, or later if it is not steady by then.
    """
    part = PositionSignal(shape="sine", value=size, frequency=frequency)
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


def _fitted(record: RunRecord, frequency: float) -> Sine:
    """Complex amplitude ratios of a simulation that contains whole cycles."""
    reference, position, error = (
        harmonic_fit(time=record.time, values=record.signals[name], frequency=frequency)
        for name in ("reference", "position", "error")
    )
    size = max(abs(position.amplitude), 1e-30)
    return Sine(
        position.amplitude / reference.amplitude,
        position.amplitude / error.amplitude,
        position.residual / size,
        record,
    )


def bandwidth(stand: Stand, expected: float, loop: Loop) -> ExperimentResult:
    """Frequency at which the closed loop's response falls to -3 dB, found by secant steps."""
    size = amplitude(stand, expected, loop(expected))
    how = f"sine of {1e3 * size:.3g} mm"
    sines: list[Sine] = []

    def above(share: float) -> float:
        sines.append(sine(stand, expected * exp(share), size, 2.0))
        return log(abs(sines[-1].closed) / HALF)

    share = _root(above, slope=-1.0)
    facts = stand.facts(sines[-1].record)
    why = _no_sine(sines[-1])
    if share is None or why:
        why = why or (
            f"the gain does not cross -3 dB within a factor of {MOST:g} of the linear bandwidth"
        )
        return ExperimentResult({"bandwidth": None}, how, facts, why)
    return ExperimentResult({"bandwidth": expected * exp(share)}, how, facts)


def _no_sine(response: Sine) -> str:
    if response.distortion < 0.5:
        return ""
    return "the response is not sinusoidal: the loop oscillates by itself, or sticks"


def _root(function: Callable[[float], float], slope: float) -> float | None:
    """Zero of a function, found by secant steps of at most 0.5 that start at 0.

    None if ten steps do not converge.
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
) -> ExperimentResult:
    """Smallest phase margin, from control error and position in the closed loop.

    L is the complex amplitude of the position divided by that of the control error. At a crossover,
    where |L| is one, the margin is |pi + arg L|. The loop stays closed, so friction and saturation
    act as in service. Crossovers are searched for near the crossovers of the linear models and near
    the resonances, which sticking seals raise.
    """
    from scipy.optimize import brentq

    sines: dict[float, Sine] = {}

    def above(share: float) -> float:
        frequency = exp(share)
        if share not in sines:
            size = amplitude(stand, frequency, loop(frequency))
            cycles = min(max(2.0, 3 * frequency / stand.bandwidth), RINGING)
            sines[share] = sine(stand, frequency, size, cycles)
        return log(abs(sines[share].opened))

    around = STICKING if "bristles" in stand.rest() else SLIDING
    frequencies = [f * k for f in crossovers for k in BESIDE]
    frequencies += [f * k for f in resonances for k in around]
    grid = sorted(log(f) for f in set(frequencies))
    while above(grid[0]) <= 0 and exp(grid[0]) > stand.bandwidth / MOST:
        grid.insert(0, grid[0] - log(BESIDE[-1]))
    values = [above(share) for share in grid]
    crossings = [
        float(brentq(above, low, high, xtol=EXACT))
        for low, high, value, two in zip(grid, grid[1:], values, values[1:], strict=False)
        if (value > 0) != (two > 0)
    ]
    doubtful = next((sines[share] for share in crossings if _no_sine(sines[share])), sines[grid[0]])
    why = _no_sine(doubtful)
    if why or not crossings:
        value = None if why else inf
        return ExperimentResult(
            {"phase_margin": value}, HOW_PHASE, stand.facts(doubtful.record), why
        )
    at = min(crossings, key=lambda share: abs(np.angle(-sines[share].opened)))
    margin = abs(float(np.angle(-sines[at].opened)))
    size = 0.5 * np.ptp(sines[at].record.signals["reference"])
    how = f"{HOW_PHASE}: {exp(at):.3g} Hz, sine of {1e3 * size:.3g} mm"
    return ExperimentResult({"phase_margin": margin}, how, stand.facts(sines[at].record))


def ultimate_gain(stand: Stand, expected: float, frequency: float) -> ExperimentResult:
    """Gain above which the oscillation after a force pulse persists.

    The search starts at the value of the linear models.
    """
    from scipy.optimize import brentq

    push = FORCE_SHARE * stand.full_force * stand.scale
    how = f"push of {push:.3g} N for {500 / frequency:.3g} ms"
    records: dict[float, RunRecord] = {}

    def growth(share: float) -> float:
        rate, records[share] = _growth(stand, expected * exp(share), frequency, push)
        return rate + LASTING

    step, low, high, most = log(1.25), 0.0, 0.0, log(MOST)
    value = growth(0.0)
    direction = 1 if value < 0 else -1
    while (value < 0) == (direction > 0) and abs(high) < most:
        low, high, step = high, direction * min(abs(high) + step, most), 2 * step
        value = growth(high)
    facts = stand.facts(records[high])
    if (value < 0) == (direction > 0):
        result = {"ultimate_gain": inf if direction > 0 else 0.0}
        why = f"no sustained oscillation up to {MOST:g} times the linear ultimate gain"
        if direction < 0:
            why = f"the loop oscillates even at 1/{MOST:g} of the linear ultimate gain"
        return ExperimentResult(result, how, facts, why)
    share = float(brentq(growth, low, high, xtol=2 * EXACT))
    nearest = min(records, key=lambda candidate: abs(candidate - share))
    facts = stand.facts(records[nearest])
    how += f", amplitude {1e3 * facts.swing:.2g} mm"
    return ExperimentResult({"ultimate_gain": expected * exp(share)}, how, facts)


def _growth(stand: Stand, gain: float, frequency: float, push: float) -> tuple[float, RunRecord]:
    """Logarithmic growth of the speed oscillation per period, and the signals in window `EARLY`.

    An oscillation that is larger at the end than just after the force pulse counts as growing, even
    if it is irregular.
    """
    period = 1 / frequency
    record = stand.closed(
        gain=gain,
        duration=LATE[1] * period,
        sample_time=period / SAMPLES,
        force=(ForceSignal(shape="pulse", value=push, start=0.0, end=0.5 * period),),
    )
    first, early, late = (record.within(a * period, b * period) for a, b in (FIRST, EARLY, LATE))
    first_span, early_span, late_span = (
        max(float(np.ptp(window.signals["speed"])), 1e-15) for window in (first, early, late)
    )
    rate = max(log(late_span / early_span) / (LATE[0] - EARLY[0]), -1.0)
    return max(rate, LASTING) if late_span >= first_span else rate, early


def dynamic_stiffness(
    stand: Stand, ends: str, frequency: float, resonance: float
) -> ExperimentResult:
    """Stiffness against a sinusoidal force on the rod, without a control loop.

    Well below the resonance, the force starts in three parts (1/4, 1/2 and 1/4 of its amplitude),
    half a resonance period apart, so that their transients cancel.
    """
    settle, cycles, wait = RINGING / resonance, 10.0, 0.5 / resonance
    shares = (0.25, 0.5, 0.25) if frequency < SHAPED * resonance else (1.0,)
    swing = 2 * FORCE_SHARE * stand.full_force * stand.scale
    parts = [
        ForceSignal(shape="sine", value=share * swing, frequency=frequency, start=k * wait)
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
    how = f"force of {swing:.3g} N at {frequency:.3g} Hz, amplitude {1e3 * facts.swing:.2g} mm"
    names = ("dynamic_stiffness", "dynamic_phase")
    if facts.stopped:
        return ExperimentResult(dict.fromkeys(names), how, facts, "the piston creeps onto its stop")
    stiffness = dynamic_stiffness_of_record(
        time=record.time,
        position=record.signals["position"],
        force=-record.signals["load_force"],
        frequency=frequency,
    ).stiffness
    return ExperimentResult(
        dict(zip(names, (abs(stiffness), float(np.angle(stiffness))), strict=True)), how, facts
    )


def decay(stand: Stand, ends: str, resonance: float) -> ExperimentResult:
    """Natural frequency and damping ratio after a step of force, without a control loop.

    D_0, D_1, ... are the differences between successive extremes of the speed, and D_n is the last
    that exceeds a hundredth of D_0. The damping ratio zeta follows from the logarithmic decrement
    per half period, ln(D_0/D_n)/n. The natural frequency is f = f_d/sqrt(1 - zeta^2), with the
    measured frequency f_d.
    """
    push = FORCE_SHARE * stand.full_force * stand.scale
    record = stand.held(
        duration=SWINGS / resonance,
        sample_time=1 / (2 * SAMPLES * resonance),
        ends=ends,
        force=(ForceSignal(shape="constant", value=push),),
    )
    facts = stand.facts(record)
    how = f"step of {push:.3g} N, amplitude {1e3 * facts.swing:.2g} mm"
    names = ("natural_frequency", "damping_ratio")
    if facts.stopped:
        return ExperimentResult(dict.fromkeys(names), how, facts, "the piston creeps onto its stop")
    times, values = _extremes(record.time, record.signals["speed"])
    spans = np.abs(np.diff(values))
    faded = np.flatnonzero(spans < FADED * spans[:1])
    count = int(faded[0]) if faded.size else len(spans)
    if count < 2:
        why = f"overdamped or stuck: the piston comes to rest after {len(spans)} half periods"
        return ExperimentResult(dict.fromkeys(names), how, facts, why)
    halves = np.diff(times[: count + 1])
    if np.max(halves) > UNEVEN * np.min(halves):
        why = "stick-slip: the half periods differ in length, so this is no decaying oscillation"
        return ExperimentResult(dict.fromkeys(names), how, facts, why)
    decrement = log(spans[0] / spans[count - 1]) / (count - 1)
    ratio = decrement / sqrt(pi * pi + decrement * decrement)
    damped = (count - 1) / (2 * float(times[count - 1] - times[0]))
    figures = damped / sqrt(1 - ratio * ratio), ratio
    how += f", evaluated over {count} half periods"
    return ExperimentResult(dict(zip(names, figures, strict=True)), how, facts)


def _extremes(time: Array, values: Array) -> tuple[Array, Array]:
    """Times and values of the extremes, each from a parabola through three samples."""
    rising = np.diff(values) > 0
    at = np.flatnonzero(rising[1:] != rising[:-1]) + 1
    before, peak, after = values[at - 1], values[at], values[at + 1]
    bend = before - 2 * peak + after
    offset = np.where(bend != 0, 0.5 * (before - after) / np.where(bend != 0, bend, 1.0), 0.0)
    step = time[at + 1] - time[at]
    return time[at] + offset * step, peak - 0.25 * (before - after) * offset
