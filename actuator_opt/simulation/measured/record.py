"""Compare a measured record with a simulation over time: overlay and residuals."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from math import comb, sqrt
from typing import Any

import numpy as np

from ...base.dataclass import dataclass
from ...base.errors import Diagnostic, InputError, shown
from ...base.numeric import Array
from ...design.scenario.reader import WIDE, gap_words, gaps
from ...identification.column_units import NONE, ColumnUnits
from ...identification.record import CHANNELS, Channel, Record, parse_record
from ...models.fluid import ATMOSPHERIC_PRESSURE
from ..result import SignalLabel, Simulation

COLUMNS = {name: CHANNELS[name] for name in ("t", "p1", "p2", "x", "v", "F_L", "T")} | {
    "U": Channel("voltage", "V", "signal of the valve", ("signal", "command")),
    "spool": Channel("voltage", "V", "position of the spool", ("spoolposition",)),
    "pS": Channel("pressure", "bar", "supply pressure", ("pressuresupply", "psupply", "pp")),
    "qA": Channel("flow", "l/min", "flow into port A", ("flowa",)),
    "qB": Channel("flow", "l/min", "flow into port B", ("flowb",)),
    "n_shaft": Channel("angular_speed", "rpm", "speed of the shaft", ("shaftspeed", "speed")),
    "phi": Channel("angle", "deg", "angle of the shaft", ("shaftangle",)),
}
"""Channels of a record by column name, with their descriptions; a temperature column is ignored."""
SIGNALS = {
    "p1": "pressure_a", "p2": "pressure_b", "x": "position", "v": "speed", "F_L": "load_force",
    "U": "signal", "spool": "spool", "pS": "pressure_supply", "qA": "flow_a", "qB": "flow_b",
    "n_shaft": "shaft_speed", "phi": "shaft_angle",
}  # fmt: skip
"""The simulated signal that each channel measures."""
FEWEST = 10
"""A channel is used if it has at least this number of samples (our choice)."""


@dataclass(frozen=True, slots=True, eq=False)
class AlignedRecord:
    """A measured record on the time axis of the scenario.

    Signals are stored by name, each as (time [s], values [SI]).

    Channels may have different sample rates, start late or have gaps; their times increase.
    """

    channels: Mapping[str, tuple[Array, Array]]
    name: str = "record"
    notes: tuple[str, ...] = ()

    @classmethod
    def of(cls, record: Record) -> AlignedRecord:
        """The channels of a record; missing samples are left out.

        Raises
        ------
        InputError
            a sample without time, times that do not increase, or no channel that a simulation has
        """
        time = _rising(record)
        channels: dict[str, tuple[Array, Array]] = {}
        notes, missing = [*record.notes], dict[str, list[str]]()
        recognised = [column for column in SIGNALS if column in record]
        for column in recognised:
            values, signal = record[column], SIGNALS[column]
            present = np.isfinite(values)
            count = int(np.count_nonzero(present))
            if count < FEWEST:
                notes.append(
                    f"{signal}: {count} samples, but at least {FEWEST} are needed, so it "
                    "is left out"
                )
                continue
            channels[signal] = time[present], values[present]
            if gap_list := gaps(time, values):
                missing.setdefault(gap_words(gap_list), []).append(signal)
        if recognised and not channels:
            message = f"fewer than {FEWEST} numbers in {', '.join(recognised)}"
            raise record.fault(
                message, "give more samples; empty cells, nan, inf and 1e30 count as missing"
            )
        if not channels:
            message = "no channel matches a simulated signal"
            raise record.fault(message, f"name the columns {', '.join(SIGNALS)}, with their units")
        notes += [
            f"{named(names, channels)}: {words}, left out" for words, names in missing.items()
        ]
        constant = [signal for signal, (_, values) in channels.items() if np.ptp(values) == 0]
        if constant:
            notes.append(f"{', '.join(constant)}: constant throughout the record")
        return cls(channels, record.name, tuple(notes))

    def fault(self, message: str, remedy: str) -> InputError:
        """Create an error that names this record."""
        return InputError(Diagnostic(message, remedy, file=self.name))


def parse_measured(
    text: str,
    *,
    name: str = "record",
    columns: Mapping[str, str] | None = None,
    units: ColumnUnits = NONE,
) -> AlignedRecord:
    """A measured record from the text of a CSV file, whose columns have the names in `COLUMNS`.

    Parameters
    ----------
    text : content of the file
    name : name of the file, for messages
    columns : column heading by channel, for other headings: ``{"p1": "Channel 3 [bar]"}``
    units : units of columns whose heading states none

    Raises
    ------
    InputError
        as for `identification.parse_record`, or no channel that a simulation has
    """
    record = parse_record(
        text, name=name, columns=columns, channels=COLUMNS, units=units, needed=SIGNALS
    )
    return AlignedRecord.of(record)


def named(names: Collection[str], all_names: Collection[str]) -> str:
    """Some channel names as text, or "all channels" if none is missing."""
    return ", ".join(names) if len(names) < max(len(all_names), 2) else "all channels"


def _rising(record: Record) -> Array:
    """The times of a record, checked to increase."""
    time = record.time
    without_time = np.flatnonzero(~np.isfinite(time))
    if without_time.size:
        raise record.fault("missing time", "give a time for every sample", int(without_time[0]))
    falling = np.flatnonzero(np.diff(time) <= 0)
    if falling.size:
        at = int(falling[0]) + 1
        message = f"time does not increase at {time[at]:.9g} s"
        raise record.fault(message, "sort the lines by time and remove repeated ones", at)
    return time


FINEST = 1e-4
"""Smallest noise assumed for a sensor, as a share of the span of its record (our choice: no sensor
is better)."""
ORDERS = (3, 6)
"""Orders of the differences between samples from which noise is estimated (our choice: a higher
order tolerates a faster signal)."""
ROBUST = 1.4826
"""Ratio of standard deviation to median absolute deviation in a normal distribution."""
APART = 0.02
"""Difference between the initial values of record and simulation up to which no message is given,
as a share of the channel's span (our choice)."""
BEYOND = 5.0
"""Difference between the initial values up to which no message is given, in standard deviations of
the noise (our choice)."""
BESIDE = 2.0
"""Largest plausible position and pressure in a record, as multiples of stroke and proof pressure
(our choice: bar and MPa differ by a factor of ten)."""
STARTS = ("position", "pressure_a", "pressure_b")
"""Signals for which the scenario sets the initial value."""


@dataclass(frozen=True, slots=True)
class ChannelResidual:
    """Difference between measured and simulated values of a channel, SI."""

    count: int
    rms: float
    largest: float
    """Largest |measured - simulated|."""
    time: float
    """Time of the largest difference [s]."""
    bias: float
    """Mean difference."""
    span: float
    """Largest minus smallest measured value of the compared samples."""
    noise: float
    """Standard deviation of the sensor noise, estimated by `noise`."""

    @property
    def relative(self) -> float | None:
        """Root mean square residual as a share of the span; None for a constant channel."""
        return self.rms / self.span if self.span > 0 else None

    def to_dict(self, label: SignalLabel) -> dict[str, Any]:
        """As plain data for JSON, SI."""
        return {
            "label": label.label,
            "unit": label.quantity.si_unit,
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
    """A measured record with its simulation, and the differences between the two."""

    measured: AlignedRecord
    simulation: Simulation
    lag: float
    """Time lag of the record [s]."""
    residuals: Mapping[str, ChannelResidual]
    notes: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """As plain data for JSON, SI; without the samples."""
        labels = self.simulation.told
        return {
            "record": self.measured.name,
            "lag": self.lag,
            "residuals": {
                name: channel_residual.to_dict(labels[name])
                for name, channel_residual in self.residuals.items()
            },
            "notes": list(self.notes),
        }


def overlay(simulation: Simulation, measured: AlignedRecord, *, lag: float = 0.0) -> Overlay:
    """Compare a record with a simulation; compute the residuals of every channel.

    Parameters
    ----------
    simulation, measured : both on the same time axis
    lag : time lag of the record [s]

    Raises
    ------
    InputError
        no common signal, or no common time
    """
    time, signals = simulation.time, simulation.signals
    duration = float(time[-1])
    samples = inside(measured, signals, duration, lag)
    residuals = {
        name: residual(t, y, beside(t - lag, y, time, signals[name]))
        for name, (t, y) in samples.items()
    }
    notes = [*measured.notes]
    unsimulated = [name for name in measured.channels if name not in signals]
    if unsimulated:
        notes.append(f"measured, but not simulated: {', '.join(unsimulated)}")
    outside = [name for name in measured.channels if name in signals and name not in samples]
    if outside:
        notes.append(f"measured only outside the simulated time: {', '.join(outside)}")
    notes += _partial_overlaps(samples, measured, duration, lag)
    notes += _coarse_sampling(simulation, samples)
    notes += _initial_values(simulation, samples, residuals, lag)
    notes += _implausible(simulation, samples)
    return Overlay(measured, simulation, lag, residuals, tuple(notes))


def inside(
    measured: AlignedRecord, signals: Mapping[str, Any], duration: float, lag: float
) -> dict[str, tuple[Array, Array]]:
    """The samples of a record that lie within the simulated time, for the simulated signals.

    Raises
    ------
    InputError
        no signal or too few samples in common
    """
    common = {name: channel for name, channel in measured.channels.items() if name in signals}
    if not common:
        have = ", ".join(measured.channels) or "none"
        known = ", ".join(name for name in SIGNALS.values() if name in signals)
        message = f"none of the record's channels is simulated ({have})"
        raise measured.fault(message, shown(f"give some of {known}", 200))
    samples = {}
    for name, (t, y) in common.items():
        room = 1e-9 * duration
        within = (t - lag >= -room) & (t - lag <= duration + room)
        if np.count_nonzero(within) >= FEWEST:
            samples[name] = t[within], y[within]
    if not samples:
        first = min(float(t[0]) for t, _ in common.values()) - lag
        last = max(float(t[-1]) for t, _ in common.values()) - lag
        raise measured.fault(
            f"the record covers {first:.6g} to {last:.6g} s, the scenario 0 to {duration:.6g} s: "
            f"fewer than {FEWEST} common samples",
            "start the record's time at the scenario's start, or simulate longer",
        )
    return samples


class SimulatedSignal:
    """A simulated signal as a function of time: cubic between samples and split at jumps.

    Beyond its ends the signal is constant. The cubics have at each sample the slope of the parabola
    through it and its neighbours on the same side of a jump.
    """

    def __init__(self, time: Array, values: Array) -> None:
        self.time, self.values = time, values
        step = np.diff(time)
        rise = np.divide(np.diff(values), step, out=np.zeros(step.size), where=step > 0)
        before, after = np.append(0.0, step), np.append(step, 0.0)
        left, right = np.append(0.0, rise), np.append(rise, 0.0)
        inner = (before > 0) & (after > 0)
        total_step = np.where(inner, before + after, 1.0)
        middle = (after * left + before * right) / total_step
        self.slopes = np.where(inner, middle, left + right)
        begins = np.flatnonzero(~inner[:-1] & inner[1:] & (step > 0))
        finishes = np.flatnonzero(inner[:-1] & ~inner[1:] & (step > 0))
        self.slopes[begins] = 2 * rise[begins] - middle[begins + 1]
        self.slopes[finishes + 1] = 2 * rise[finishes] - middle[finishes]

    def __call__(self, moment: Array) -> Array:
        """Values at given times; at a jump, the value after it."""
        t, y, m = self.time, self.values, self.slopes
        right = np.clip(np.searchsorted(t, moment, side="right"), 1, t.size - 1)
        left = right - 1
        step = t[right] - t[left]
        s = np.clip((moment - t[left]) / np.where(step > 0, step, 1.0), 0.0, 1.0)
        a, b = y[left], y[right]
        slope_term = (1 - s) * m[left] - s * m[right]
        return a + s * (b - a) + s * (1 - s) * (step * slope_term - (1 - 2 * s) * (b - a))


def beside(moment: Array, measured: Array, time: Array, values: Array) -> Array:
    """A simulated signal at measured samples.

    Within half a sample of a jump, any value between those before and after the jump is possible,
    so the value nearest to the measured value is used.
    """
    simulated = SimulatedSignal(time, values)(moment)
    half = 0.5 * float(np.median(np.diff(moment)))
    for k in np.flatnonzero((np.diff(time) == 0) & (np.diff(values) != 0)):
        near = np.abs(moment - time[k]) <= 1.001 * half
        simulated[near] = np.clip(measured[near], *sorted((values[k], values[k + 1])))
    return simulated


def residual(time: Array, measured: Array, simulated: Array) -> ChannelResidual:
    """The residual of one channel."""
    difference = measured - simulated
    worst = int(np.argmax(np.abs(difference)))
    return ChannelResidual(
        count=difference.size,
        rms=float(np.sqrt(np.mean(difference**2))),
        largest=float(np.abs(difference[worst])),
        time=float(time[worst]),
        bias=float(np.mean(difference)),
        span=float(np.ptp(measured)),
        noise=noise(measured),
    )


def noise(values: Array) -> float:
    """Standard deviation of a sensor's noise, from differences of neighbouring samples.

    Differences of order n have a variance of (2n)!/n!^2 times that of a sample. Neither jumps nor a
    signal that is smooth over n + 1 samples affect their median magnitude. Of the estimates for the
    `ORDERS`, the smallest is used. The result is at least the rounding noise of a sensor whose
    resolution is the smallest step of the record, step/sqrt(12), and at least `FINEST` times the
    span.

    Parameters
    ----------
    values : samples of one channel, (n,)

    Notes
    -----
    If a filter has smoothed the noise, this method takes it for signal.
    """
    span = float(np.ptp(values))
    steps = np.abs(np.diff(values))
    steps = steps[steps > 1e-9 * span]
    grain = float(np.min(steps)) if steps.size else 0.0
    rough = min(
        ROBUST * float(np.median(np.abs(np.diff(values, n)))) / sqrt(comb(2 * n, n)) for n in ORDERS
    )
    return max(rough, float(grain / np.sqrt(12.0)), FINEST * span)


def _partial_overlaps(
    samples: Mapping[str, tuple[Array, Array]], measured: AlignedRecord, duration: float, lag: float
) -> Iterator[str]:
    """Messages on channels that start or end at other times than the simulation."""
    spans: dict[tuple[str, str], list[str]] = {}
    for name in samples:
        time = measured.channels[name][0] - lag
        room = WIDE * float(np.median(np.diff(time)))
        first = 0.0 if abs(time[0]) <= room else float(time[0])
        last = duration if abs(time[-1] - duration) <= room else float(time[-1])
        if (first, last) != (0.0, duration):
            spans.setdefault((f"{first:.4g}", f"{last:.4g}"), []).append(name)
    for (begin, end), names in spans.items():
        yield (
            f"{named(names, samples)}: measured from {begin} to {end} s, simulated from 0 to "
            f"{duration:.4g} s: only the overlap is compared"
        )


def _coarse_sampling(
    simulation: Simulation, samples: Mapping[str, tuple[Array, Array]]
) -> Iterator[str]:
    """Messages on channels that the simulation samples more coarsely than the record does."""
    simulated_step = float(np.median(np.diff(simulation.time)))
    record_step = min(float(np.median(np.diff(t))) for t, _ in samples.values())
    if simulated_step > WIDE * record_step:
        yield (
            f"the simulation is sampled every {1e3 * simulated_step:.3g} ms, but the record "
            f"every {1e3 * record_step:.3g} ms, so peaks may be missed: state a shorter sample_time"
        )


def _initial_values(
    simulation: Simulation,
    samples: Mapping[str, tuple[Array, Array]],
    residuals: Mapping[str, ChannelResidual],
    lag: float,
) -> Iterator[str]:
    """Messages on channels whose initial value differs from that in the scenario."""
    for name in STARTS:
        if name not in samples:
            continue
        t, y = samples[name]
        step = float(np.median(np.diff(t)))
        if t[0] - lag > 1.5 * step:
            continue
        initial = float(simulation.signals[name][0])
        offset = abs(float(y[0]) - initial)
        if offset > max(APART * residuals[name].span, BEYOND * residuals[name].noise):
            quantity = simulation.told[name].quantity
            yield (
                f"{name} starts at {quantity.text(float(y[0]))} in the record, but at "
                f"{quantity.text(initial)} in the scenario: "
                f"state the starting value as initial.{name}"
            )


def _implausible(
    simulation: Simulation, samples: Mapping[str, tuple[Array, Array]]
) -> Iterator[str]:
    """Messages on implausible positions or pressures, which suggest a wrong unit or zero point."""
    plant = simulation.plant
    for name, low, high, limit_name in (
        ("position", 0.0, plant.stroke, "the stroke"),
        ("pressure_a", -ATMOSPHERIC_PRESSURE, plant.proof_pressure, "the proof pressure"),
        ("pressure_b", -ATMOSPHERIC_PRESSURE, plant.proof_pressure, "the proof pressure"),
    ):
        if name not in samples:
            continue
        room = BESIDE * (high - low)
        least, most = float(np.min(samples[name][1])), float(np.max(samples[name][1]))
        if least < low - room or most > high + room:
            text = simulation.told[name].quantity.text
            yield (
                f"{name} ranges from {text(least)} to {text(most)} in the record, but "
                f"{limit_name} is {text(high)}: check the unit and zero point of this channel"
            )
