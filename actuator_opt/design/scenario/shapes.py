"""Shapes of signal parts: names, keys, time courses, report texts.

A new shape is an entry of `SHAPES` with its functions here; a shape is named nowhere else.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import pi
from typing import Any, Protocol

import numpy as np

from ...base.kinds import kinds
from ...base.numeric import Array, where

Records = Mapping[tuple[str, str], tuple[Array, Array]]
"""Time [s] and values [SI] of every file column that a part names; NaN where missing."""


class SignalPart(Protocol):
    """Attributes of a part that shapes read: times [s], frequency [Hz], phase [rad]."""

    start: float
    end: float | None
    frequency: float | None
    phase: float
    file: str | None
    column: str | None
    scale: float


class Clock(Protocol):
    """Time of a system of equations, and time-dependent terms of a signal."""

    @property
    def time(self) -> Any:
        """The time [s], an expression."""

    def after(self, instant: float) -> Any:
        """True after `time`; the integrator restarts there."""

    def sine(self, angle: Any) -> Any:
        """Sine of an expression [rad]."""

    def samples(self, time: Array, values: Array) -> Any:
        """Linear interpolation between samples, constant outside."""


@dataclass(frozen=True, slots=True)
class SignalShape:
    """Shape of a signal part.

    Attributes
    ----------
    name, help : name in a scenario, and its meaning
    needed, read : required keys, and optional keys
    instead : shape to suggest for a key without effect
    course : expression of the value over the time of a clock
    initial : value at time zero
    lasts : whether the final value is kept
    moves_on : whether it changes gradually, so that a following error is defined
    settles : whether it comes to rest, so that the response to a superposed step is defined
    changes_after : whether it changes after a time [s]
    words : text for a report, from texts of height and times
    """

    name: str
    help: str
    needed: tuple[str, ...]
    read: tuple[str, ...]
    instead: Mapping[str, str] = field(kw_only=True)
    course: Callable[[Clock, SignalPart, Records], Any] = field(kw_only=True)
    initial: Callable[[SignalPart, Records], float] = field(kw_only=True)
    lasts: bool = field(kw_only=True)
    moves_on: bool = field(kw_only=True)
    settles: bool = field(kw_only=True)
    changes_after: Callable[[SignalPart, float, Records], bool] = field(kw_only=True)
    words: Callable[[SignalPart, str, Callable[[float], str]], str] = field(kw_only=True)


def height(part: SignalPart) -> float:
    """Height of a part, or amplitude of a sine; zero if not stated."""
    return getattr(part, "value", None) or 0.0


def sampled(part: SignalPart, records: Records) -> tuple[Array, Array] | None:
    """Time [s] and values of a recorded part without missing samples; None without a record."""
    known = records.get((part.file or "", part.column or ""))
    if known is None:
        return None
    time, values = known
    seen = np.isfinite(values)
    return time[seen] + part.start, part.scale * values[seen]


def _from_start(part: SignalPart, records: Records) -> float:
    return height(part) if part.start <= 0 else 0.0


def _end(part: SignalPart) -> float:
    return math.inf if part.end is None else part.end


def _turns_at(*names: str) -> Callable[[SignalPart, float, Records], bool]:
    """Whether any of these times of a part comes after a given time."""

    def after(part: SignalPart, moment: float, records: Records) -> bool:
        instants = (_end(part) if name == "end" else part.start for name in names)
        return any(moment < instant < math.inf for instant in instants)

    return after


def _until_end(part: SignalPart, moment: float, records: Records) -> bool:
    return _end(part) > moment


def _step(clock: Clock, part: SignalPart, records: Records) -> Any:
    return where(clock.after(part.start), height(part), 0.0)


def _ramp(clock: Clock, part: SignalPart, records: Records) -> Any:
    value, start, end = height(part), part.start, part.end
    assert end is not None
    on, done = clock.after(start), clock.after(end)
    rise = value * (clock.time - start) / (end - start)
    return where(done, value, where(on, rise, 0.0))


def _ramps_after(part: SignalPart, moment: float, records: Records) -> bool:
    return part.start < moment < _end(part) or _turns_at("start", "end")(part, moment, records)


def _between(clock: Clock, part: SignalPart) -> Any:
    """True from start to end."""
    on = clock.after(part.start)
    if part.end is None:
        return on
    off = ~clock.after(part.end)
    return off if on is True else on & off


def _pulse(clock: Clock, part: SignalPart, records: Records) -> Any:
    return where(_between(clock, part), height(part), 0.0)


def _sine(clock: Clock, part: SignalPart, records: Records) -> Any:
    assert part.frequency is not None
    turn = 2 * pi * part.frequency * (clock.time - part.start) + part.phase
    return where(_between(clock, part), height(part) * clock.sine(turn), 0.0)


def _sine_at_start(part: SignalPart, records: Records) -> float:
    return height(part) * math.sin(part.phase) if part.start <= 0 else 0.0


def _record(clock: Clock, part: SignalPart, records: Records) -> Any:
    known = sampled(part, records)
    assert known is not None
    return clock.samples(*known)


def _record_at_start(part: SignalPart, records: Records) -> float:
    known = sampled(part, records)
    return 0.0 if known is None else float(np.interp(0.0, *known))


def _record_after(part: SignalPart, moment: float, records: Records) -> bool:
    known = sampled(part, records)
    if known is None:
        return _until_end(part, moment, records)
    still = float(np.interp(moment, *known))
    return bool(np.any(known[1][known[0] > moment] != still))


SHAPES = kinds(
    "shape",
    SignalShape(
        "constant",
        "constant value",
        ("value",),
        (),
        instead={"end": "pulse", "start": "step"},
        course=lambda clock, part, records: height(part),
        initial=lambda part, records: height(part),
        lasts=True,
        moves_on=False,
        settles=True,
        changes_after=lambda part, moment, records: False,
        words=lambda part, value, seconds: value,
    ),
    SignalShape(
        "step",
        "value from start on",
        ("value",),
        ("start",),
        instead={"end": "pulse"},
        course=_step,
        initial=_from_start,
        lasts=True,
        moves_on=False,
        settles=True,
        changes_after=_turns_at("start"),
        words=lambda part, value, seconds: f"step of {value} at {seconds(part.start)} s",
    ),
    SignalShape(
        "ramp",
        "from zero at start to value at end",
        ("value", "end"),
        ("start",),
        instead={},
        course=_ramp,
        initial=lambda part, records: 0.0,
        lasts=True,
        moves_on=True,
        settles=True,
        changes_after=_ramps_after,
        words=lambda part, value, seconds: (
            f"ramp of {value} from {seconds(part.start)} to {seconds(_end(part))} s"
        ),
    ),
    SignalShape(
        "pulse",
        "value from start to end",
        ("value", "end"),
        ("start",),
        instead={},
        course=_pulse,
        initial=_from_start,
        lasts=False,
        moves_on=False,
        settles=True,
        changes_after=_turns_at("start", "end"),
        words=lambda part, value, seconds: (
            f"{value} from {seconds(part.start)} to {seconds(_end(part))} s"
        ),
    ),
    SignalShape(
        "sine",
        "amplitude value at frequency, from start to end",
        ("value", "frequency"),
        ("start", "end", "phase"),
        instead={},
        course=_sine,
        initial=_sine_at_start,
        lasts=False,
        moves_on=True,
        settles=False,
        changes_after=_until_end,
        words=lambda part, value, seconds: (
            f"sine of {value} at {seconds(part.frequency or 0.0)} Hz"
        ),
    ),
    SignalShape(
        "record",
        "a column of a CSV file, linear between its samples",
        ("file", "column"),
        ("start", "scale"),
        instead={},
        course=_record,
        initial=_record_at_start,
        lasts=False,
        moves_on=True,
        settles=False,
        changes_after=_record_after,
        words=lambda part, value, seconds: f"record {part.file}, {part.column}",
    ),
)
"""Every shape by name."""
