"""A design on a stand: held at a position under a force, for small experiments.

Plant, friction, valve, supply and stops are those of the scenario; excitation and loop closure are
the experiment's own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf
from typing import Any

import numpy as np

from ...base.numeric import Array
from ...design.scenario.model import Control, Initial, Load, Scenario
from ...design.scenario.signals import Force, Position, Signal
from ...models.tuning import ControllerGains
from ...studies.plant import Plant
from ..assemble import assemble
from ..integrate import integrate

RELATIVE = 1e-7
"""Relative tolerance of a step for a full-size oscillation; small ones need a smaller one."""
FINEST = 1e-9
"""Least relative tolerance of a step: 0.1 nm beside a position of 100 mm."""
SETTLED = 3.0
"""Periods of the bandwidth after which a loop is at rest (a choice: e^(-6 pi) remains)."""


@dataclass(slots=True)
class Tally:
    """Counts the runs."""

    runs: int = 0


@dataclass(frozen=True, slots=True)
class Record:
    """Signals of a run, and its final states by name."""

    time: Array
    signals: Mapping[str, Array]
    last: Mapping[str, float]

    def within(self, begin: float, end: float = inf) -> Record:
        """The samples between two times; of a doubled instant the later one."""
        later = np.append(np.diff(self.time) > 0, True)
        kept = (self.time >= begin) & (self.time <= end) & later
        signals = {name: values[kept] for name, values in self.signals.items()}
        return Record(self.time[kept], signals, self.last)


@dataclass(frozen=True, slots=True)
class Facts:
    """Further facts about a record."""

    swing: float
    """Amplitude of the position without drift [m]."""
    travel: float
    """Bristle travel before the seals slip [m]; 0 without sticking friction."""
    saturated: float
    """Share of the time with the valve's signal at its limit."""
    spool: tuple[float, float] | None
    """Least and largest position of the spool [V]."""
    pressures: tuple[float, float]
    """Means of the chambers A and B [Pa]."""
    pulse: float
    """Amplitude of the pressure in chamber A [Pa]."""
    lowest: float
    """Lowest chamber pressure [Pa]."""
    stopped: bool
    """Whether the piston reached a stop."""


@dataclass(frozen=True, slots=True)
class Measured:
    """Results of an experiment, None with a reason if it gives none."""

    values: Mapping[str, float | None]
    how: str
    facts: Facts | None = None
    why: str = ""


@dataclass(frozen=True, slots=True)
class Stand:
    """A plant at a position, with chamber pressures in balance with a constant force."""

    plant: Plant
    scenario: Scenario
    position: float
    pressure_a: float
    pressure_b: float
    gain: float = 0.0
    """Gain of the design's proportional position loop [V/m]; 0 without one."""
    steady_gain: float = 0.0
    """Gain that brings the loop to rest where the design's own oscillates [V/m]."""
    bandwidth: float = 1.0
    """Expected bandwidth of the loop, which sets its time to rest [Hz]."""
    scale: float = 1.0
    """Factor on all amplitudes."""
    tally: Tally = field(default_factory=Tally)
    rested: dict[str, float] = field(default_factory=dict)
    """Equilibrium states of the loop, once computed."""

    def but(self, **changes: Any) -> Stand:
        """A copy with some changes, whose equilibrium is not computed yet."""
        return replace(self, rested={}, **changes)

    def bare(self) -> Stand:
        """A copy without sticking friction."""
        free = self.scenario.friction.model_copy(update={"model": "none"})
        return self.but(scenario=self.scenario.model_copy(update={"friction": free}))

    @property
    def force(self) -> float:
        """External force that balances the pressures [N], positive against extension."""
        return self.pressure_a * self.plant.area_a - self.pressure_b * self.plant.area_b

    @property
    def full_force(self) -> float:
        """Force of the supply pressure on the whole piston [N]."""
        return self.plant.supply_pressure * self.plant.area_a

    def run(
        self,
        *,
        duration: float,
        sample_time: float,
        gain: float | None = None,
        ends: str | None = None,
        signal: float = 0.0,
        reference: Sequence[Position] = (),
        force: Sequence[Force] = (),
        start: Mapping[str, float] | None = None,
    ) -> Record:
        """One run: closed with a gain, or open with the ports terminated.

        Parameters
        ----------
        duration, sample_time : [s]
        gain : of a proportional position loop [V/m]; None: no loop
        ends : what the ports lead to; None: the valve
        signal : of the valve without a loop [V]
        reference : relative to the stand's position
        force : in addition to the balancing one
        start : states by name that replace those of the stand
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
                "load": Load(force=(Force(shape="constant", value=self.force), *force)),
                "signal": (Signal(shape="constant", value=signal),) if signal else (),
                "control": None if gain is None else self._control(gain, reference),
                "requirements": {},
            }
        )
        gains = None if gain is None else ControllerGains(gain, inf, 0.0)
        circuit = assemble(scenario, self.plant, {}, gains)
        system = circuit.system
        system.states = [one for one in system.states if not one.integral]
        compiled = system.compiled()
        names = [one.name for one in system.states]
        if start is not None:
            own = dict(zip(names, compiled.initial.tolist(), strict=True))
            begin = np.array([start.get(name, value) for name, value in own.items()])
            compiled = replace(compiled, initial=begin)
        relative = max(RELATIVE * min(self.scale, 1.0), FINEST)
        found = integrate(compiled, duration=duration, sample_time=sample_time, relative=relative)
        signals = compiled.signals(found.time, found.states, found.flags)
        last = dict(zip(names, found.states[:, -1].tolist(), strict=True))
        return Record(found.time, signals, last)

    def _control(self, gain: float, reference: Sequence[Position]) -> Control:
        """A proportional position loop, with the rate limit of the scenario."""
        stated = self.scenario.control
        return Control(
            position=(*reference, Position(shape="constant", value=0.0)),
            tuning="stated",
            position_gain=gain,
            rate_limit=None if stated is None else stated.rate_limit,
        )

    @property
    def opening(self) -> float:
        """Rest position of the spool, from its centre [V]; positive extends."""
        assert self.plant.valve is not None
        return self.rest()["spool"] - self.plant.valve.offset

    def rest(self) -> Mapping[str, float]:
        """States in which the loop holds the force at the stand's position; computed once.

        The valve feeds its own leakage and the piston's. The first run, at mid-stroke, measures the
        resulting error, and the second one compensates it.
        """
        if not self.rested:
            duration = SETTLED / self.bandwidth * self.gain / self.steady_gain

            def held(stand: Stand, error: float) -> Mapping[str, float]:
                part = Position(shape="constant", value=error)
                return stand.run(
                    duration=duration,
                    sample_time=duration / 20,
                    gain=self.steady_gain,
                    reference=(part,),
                ).last

            middle = held(replace(self, position=0.5 * self.plant.stroke), 0.0)
            self.rested.update(held(self, middle["spool"] / self.steady_gain))
        return self.rested

    def held(
        self, *, ends: str, duration: float, sample_time: float, force: Sequence[Force] = ()
    ) -> Record:
        """A run with terminated ports; a valve stays where it held the force."""
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
        reference: Sequence[Position] = (),
        force: Sequence[Force] = (),
    ) -> Record:
        """A closed-loop run from rest; a new gain is inserted without a jump of the signal."""
        state = self.rest()
        shift = state["position"] + state["spool"] / gain - self.position
        held = Position(shape="constant", value=shift)
        return self.run(
            duration=duration,
            sample_time=sample_time,
            gain=gain,
            reference=(held, *reference),
            force=force,
            start=state,
        )

    def facts(self, record: Record) -> Facts:
        """Further facts about a record."""
        t, signals = record.time, record.signals
        position = signals["position"]
        straight = np.polynomial.polynomial.polyfit(t - t[0], position, 1)
        swing = position - np.polynomial.polynomial.polyval(t - t[0], straight)
        spool = signals.get("spool")
        signal = signals.get("signal")
        valve = self.plant.valve
        full = inf if valve is None else valve.signal
        chambers = signals["pressure_a"], signals["pressure_b"]
        return Facts(
            swing=0.5 * float(np.ptp(swing)),
            travel=self.travel if "bristles" in signals else 0.0,
            saturated=0.0 if signal is None else float(np.mean(np.abs(signal) > 0.999 * full)),
            spool=None if spool is None else (float(np.min(spool)), float(np.max(spool))),
            pressures=(float(np.mean(chambers[0])), float(np.mean(chambers[1]))),
            pulse=0.5 * float(np.ptp(chambers[0])),
            lowest=float(min(np.min(one) for one in chambers)),
            stopped=bool(np.any(signals["stop_force"] != 0)),
        )

    @property
    def travel(self) -> float:
        """Bristle travel before the seals slip [m]."""
        return self.scenario.friction.bristle_travel or self.plant.seals.bristle_travel
