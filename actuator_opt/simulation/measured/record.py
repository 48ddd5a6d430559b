"""A measured record laid over a simulation in time, and what is left over."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import comb, sqrt
from typing import Any

import numpy as np

from ...base.numeric import Array
from ...base.suggest import shown
from ...design.scenario.recorded import WIDE
from ...models.fluid import ATMOSPHERIC_PRESSURE
from ..result import Simulation, Told
from .file import FEWEST, SIGNALS, Measured, named

FINEST = 1e-4
"""Least noise of a sensor over the span of its record (a choice: no sensor is better)."""
ORDERS = (3, 6)
"""Orders of the differences that show noise (a choice: the higher one bears a faster course)."""
ROBUST = 1.4826
"""Standard deviation over the median distance from zero, of a normal distribution."""
APART = 0.02
"""Share of a channel's span by which the start may be off before it is told (a choice)."""
BEYOND = 5.0
"""The same in standard deviations of the noise (a choice)."""
BESIDE = 2.0
"""Strokes or proof pressures that a record may go beyond (a choice: bar and MPa are ten apart)."""
STARTS = ("position", "pressure_a", "pressure_b")
"""Signals whose start a scenario states."""


@dataclass(frozen=True, slots=True)
class Residual:
    """What a channel measured less what was simulated, SI."""

    count: int
    rms: float
    largest: float
    """Largest |measured - simulated|."""
    time: float
    """When that is [s]."""
    bias: float
    """Their mean."""
    span: float
    """Largest less least value measured, over the same samples."""
    noise: float
    """Standard deviation of the sensor's noise, by `noise`."""

    @property
    def relative(self) -> float | None:
        """Root mean square over the span; None of a channel that stands still."""
        return self.rms / self.span if self.span > 0 else None

    def to_dict(self, told: Told) -> dict[str, Any]:
        """As plain data for JSON, SI."""
        return {
            "label": told.label,
            "unit": told.quantity.si_unit,
            "count": self.count,
            "rms": self.rms,
            "max": self.largest,
            "time": self.time,
            "bias": self.bias,
            "span": self.span,
            "relative": self.relative,
            "noise": self.noise,
        }


@dataclass(frozen=True, slots=True)
class Overlay:
    """A measured record over a simulation."""

    measured: Measured
    simulation: Simulation
    lag: float
    """Time by which the record comes late [s]."""
    residuals: Mapping[str, Residual]
    notes: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """As plain data for JSON, SI; without the samples."""
        told = self.simulation.told
        return {
            "record": self.measured.name,
            "lag": self.lag,
            "residuals": {name: one.to_dict(told[name]) for name, one in self.residuals.items()},
            "notes": list(self.notes),
        }


def overlay(simulation: Simulation, measured: Measured, *, lag: float = 0.0) -> Overlay:
    """Lay a record over a simulation and tell what is left over, channel by channel.

    Parameters
    ----------
    simulation, measured : on one time
    lag : time by which the record comes late [s]

    Raises
    ------
    InputError
        no signal in common, no time in common
    """
    time, signals = simulation.time, simulation.signals
    duration = float(time[-1])
    used = inside(measured, signals, duration, lag)
    found = {
        name: residual(t, y, beside(t - lag, y, time, signals[name]))
        for name, (t, y) in used.items()
    }
    notes = [*measured.notes]
    absent = [name for name in measured.channels if name not in signals]
    if absent:
        notes.append(f"not simulated here: {', '.join(absent)}")
    short = [name for name in measured.channels if name in signals and name not in used]
    if short:
        notes.append(f"no time in common: {', '.join(short)}")
    notes += _reach(used, measured, duration, lag)
    notes += _sampling(simulation, used)
    notes += _starts(simulation, used, found, lag)
    notes += _absurd(simulation, used)
    return Overlay(measured, simulation, lag, found, tuple(notes))


def inside(
    measured: Measured, signals: Mapping[str, Any], duration: float, lag: float
) -> dict[str, tuple[Array, Array]]:
    """The samples of a record within a run, of the signals that are simulated.

    Raises
    ------
    InputError
        where there are none
    """
    common = {name: one for name, one in measured.channels.items() if name in signals}
    if not common:
        have = ", ".join(measured.channels) or "none"
        known = ", ".join(name for name in SIGNALS.values() if name in signals)
        message = f"none of its channels is simulated ({have})"
        raise measured.fault(message, shown(f"give some of {known}", 200))
    found = {}
    for name, (t, y) in common.items():
        room = 1e-9 * duration
        within = (t - lag >= -room) & (t - lag <= duration + room)
        if np.count_nonzero(within) >= FEWEST:
            found[name] = t[within], y[within]
    if not found:
        first = min(float(t[0]) for t, _ in common.values()) - lag
        last = max(float(t[-1]) for t, _ in common.values()) - lag
        raise measured.fault(
            f"the record runs from {first:.6g} to {last:.6g} s, the scenario from 0 to "
            f"{duration:.6g} s: fewer than {FEWEST} samples in common",
            "count the record's time from the scenario's start, or simulate longer",
        )
    return found


class Course:
    """A simulated signal at any time: cubic between samples, across no jump, still beyond its ends.

    Slopes are those of the parabola through a sample and its neighbours on the same side of a jump.
    """

    def __init__(self, time: Array, values: Array) -> None:
        self.time, self.values = time, values
        step = np.diff(time)
        rise = np.divide(np.diff(values), step, out=np.zeros(step.size), where=step > 0)
        before, after = np.append(0.0, step), np.append(step, 0.0)
        left, right = np.append(0.0, rise), np.append(rise, 0.0)
        inner = (before > 0) & (after > 0)
        whole = np.where(inner, before + after, 1.0)
        middle = (after * left + before * right) / whole
        self.slopes = np.where(inner, middle, left + right)
        begins = np.flatnonzero(~inner[:-1] & inner[1:] & (step > 0))
        finishes = np.flatnonzero(inner[:-1] & ~inner[1:] & (step > 0))
        self.slopes[begins] = 2 * rise[begins] - middle[begins + 1]
        self.slopes[finishes + 1] = 2 * rise[finishes] - middle[finishes]

    def __call__(self, moment: Array) -> Array:
        """Values at times; at a jump what follows it."""
        t, y, m = self.time, self.values, self.slopes
        right = np.clip(np.searchsorted(t, moment, side="right"), 1, t.size - 1)
        left = right - 1
        step = t[right] - t[left]
        s = np.clip((moment - t[left]) / np.where(step > 0, step, 1.0), 0.0, 1.0)
        a, b = y[left], y[right]
        bent = (1 - s) * m[left] - s * m[right]
        return a + s * (b - a) + s * (1 - s) * (step * bent - (1 - 2 * s) * (b - a))


def beside(moment: Array, measured: Array, time: Array, values: Array) -> Array:
    """A simulated signal beside measured samples.

    A sample nearer to a jump than its neighbours may show either side of it, or what lies between.
    """
    found = Course(time, values)(moment)
    half = 0.5 * float(np.median(np.diff(moment)))
    for k in np.flatnonzero((np.diff(time) == 0) & (np.diff(values) != 0)):
        near = np.abs(moment - time[k]) <= 1.001 * half
        found[near] = np.clip(measured[near], *sorted((values[k], values[k + 1])))
    return found


def residual(time: Array, measured: Array, simulated: Array) -> Residual:
    """What is left over of one channel."""
    rest = measured - simulated
    worst = int(np.argmax(np.abs(rest)))
    return Residual(
        count=rest.size,
        rms=float(np.sqrt(np.mean(rest**2))),
        largest=float(np.abs(rest[worst])),
        time=float(time[worst]),
        bias=float(np.mean(rest)),
        span=float(np.ptp(measured)),
        noise=noise(measured),
    )


def noise(values: Array) -> float:
    """Standard deviation of a sensor's noise, from differences of neighbouring samples.

    The median size of differences of an order n, whose variance is (2n)!/n!^2 that of a sample,
    leaves out jumps and whatever is smooth over n + 1 samples; the least over `ORDERS` counts.
    Steps of the sensor count as theirs, step/sqrt(12); not less than `FINEST` of the span.

    Parameters
    ----------
    values : of one channel (samples)

    Notes
    -----
    Noise that a filter has made smooth is taken for the signal.
    """
    span = float(np.ptp(values))
    steps = np.abs(np.diff(values))
    steps = steps[steps > 1e-9 * span]
    grain = float(np.min(steps)) if steps.size else 0.0
    rough = min(
        ROBUST * float(np.median(np.abs(np.diff(values, n)))) / sqrt(comb(2 * n, n)) for n in ORDERS
    )
    return max(rough, float(grain / np.sqrt(12.0)), FINEST * span)


def _reach(
    used: Mapping[str, tuple[Array, Array]], measured: Measured, duration: float, lag: float
) -> Iterator[str]:
    """Channels that begin later or end earlier than the run, or go beyond it."""
    spans: dict[tuple[str, str], list[str]] = {}
    for name in used:
        time = measured.channels[name][0] - lag
        room = WIDE * float(np.median(np.diff(time)))
        first = 0.0 if abs(time[0]) <= room else float(time[0])
        last = duration if abs(time[-1] - duration) <= room else float(time[-1])
        if (first, last) != (0.0, duration):
            spans.setdefault((f"{first:.4g}", f"{last:.4g}"), []).append(name)
    for (begin, end), names in spans.items():
        yield (
            f"{named(names, used)}: measured from {begin} to {end} s, simulated from 0 to "
            f"{duration:.4g} s: compared where both are"
        )


def _sampling(simulation: Simulation, used: Mapping[str, tuple[Array, Array]]) -> Iterator[str]:
    """Whether the simulation is told more coarsely than the record."""
    own = float(np.median(np.diff(simulation.time)))
    theirs = min(float(np.median(np.diff(t))) for t, _ in used.values())
    if own > WIDE * theirs:
        yield (
            f"the simulation is told every {1e3 * own:.3g} ms, the record every "
            f"{1e3 * theirs:.3g} ms: peaks between are cut; state sample_time"
        )


def _starts(
    simulation: Simulation,
    used: Mapping[str, tuple[Array, Array]],
    found: Mapping[str, Residual],
    lag: float,
) -> Iterator[str]:
    """Where the record begins elsewhere than the scenario."""
    for name in STARTS:
        if name not in used:
            continue
        t, y = used[name]
        step = float(np.median(np.diff(t)))
        if t[0] - lag > 1.5 * step:
            continue
        begun = float(simulation.signals[name][0])
        apart = abs(float(y[0]) - begun)
        if apart > max(APART * found[name].span, BEYOND * found[name].noise):
            quantity = simulation.told[name].quantity
            yield (
                f"{name} begins at {quantity.text(float(y[0]))} in the record, at "
                f"{quantity.text(begun)} in the scenario: state initial.{name}"
            )


def _absurd(simulation: Simulation, used: Mapping[str, tuple[Array, Array]]) -> Iterator[str]:
    """Positions off the stroke and pressures off the design: another unit, or another zero."""
    plant = simulation.plant
    for name, low, high, what in (
        ("position", 0.0, plant.stroke, "the stroke"),
        ("pressure_a", -ATMOSPHERIC_PRESSURE, plant.proof_pressure, "the proof pressure"),
        ("pressure_b", -ATMOSPHERIC_PRESSURE, plant.proof_pressure, "the proof pressure"),
    ):
        if name not in used:
            continue
        room = BESIDE * (high - low)
        least, most = float(np.min(used[name][1])), float(np.max(used[name][1]))
        if least < low - room or most > high + room:
            say = simulation.told[name].quantity.text
            yield (
                f"{name} goes from {say(least)} to {say(most)} in the record, {what} is "
                f"{say(high)}: check its unit and its zero"
            )
