"""Choices that a scenario may name: shapes of signals, and components around the design.

A shape is an entry of `SHAPES` with its name, keys, value over time and report text. A component
(supply, seal friction, port end, control law) is declared here with its name and keys. Its
equations are in `simulation.components`; if they are missing, the import fails (`kinds.per_kind`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import field
from math import pi
from typing import Annotated, Any, Literal, Protocol, TypeAlias

import numpy as np

from ...base.dataclass import dataclass
from ...base.kinds import kinds
from ...base.numeric import Array, where
from ..kinds import Choice, Position, PositionKind, ValueFault, choice_of


@dataclass(frozen=True, slots=True)
class SupplyType:
    """Type of hydraulic supply that feeds the valve.

    Attributes
    ----------
    name, help : name in a scenario, and its meaning
    needed, unread : required keys, and keys that have no effect with this type
    pumps : whether a pump delivers into a volume whose pressure is a state variable
    words : text for a report
    """

    name: str
    help: str
    needed: tuple[str, ...]
    unread: tuple[str, ...]
    pumps: bool
    words: str


@dataclass(frozen=True, slots=True)
class SealFriction:
    """Friction model of the seals in a simulation.

    Attributes
    ----------
    name, help : name in a scenario, and its meaning
    unread : keys of the block `friction` that have no effect with this model
    words : text for a report
    """

    name: str
    help: str
    unread: tuple[str, ...]
    words: str


@dataclass(frozen=True, slots=True)
class PortEnd:
    """Component to which the cylinder's ports, or the lines at these ports, are connected.

    Attributes
    ----------
    name, help : name in a scenario, and its meaning
    words : text for a report; None if the text of the supply suffices
    shut : whether the line is closed
    holds : whether the pressure is held constant
    at_cylinder : whether the connection is directly at the cylinder, so that a throttle in the line
        has no effect
    """

    name: str
    help: str
    words: str | None
    shut: bool
    holds: bool
    at_cylinder: bool


@dataclass(frozen=True, slots=True)
class ControlLaw:
    """Control law: response of the controller to the error.

    Attributes
    ----------
    name, help : name in a scenario, and its meaning
    integral, derivative : whether the law has these terms besides the proportional term
    """

    name: str
    help: str
    integral: bool
    derivative: bool

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the terms besides the proportional term."""
        both = {"integral": self.integral, "derivative": self.derivative}
        return tuple(name for name, has in both.items() if has)


SUPPLIES = kinds(
    "supply",
    SupplyType(
        "constant",
        "supply pressure of the design at any flow",
        needed=(),
        unread=("volume", "flow", "pump", "relief", "gain", "time_constant", "accumulator"),
        pumps=False,
        words="constant supply",
    ),
    SupplyType(
        "fixed_pump",
        "constant-flow pump with a relief valve",
        needed=("volume", "relief"),
        unread=("gain", "time_constant"),
        pumps=True,
        words="fixed pump",
    ),
    SupplyType(
        "controlled_pump",
        "pressure-controlled pump with a first-order lag",
        needed=("volume", "flow", "gain", "time_constant"),
        unread=("pump",),
        pumps=True,
        words="controlled pump",
    ),
)
"""All types of supply by name."""


FRICTIONS = kinds(
    "friction of the seals",
    SealFriction(
        "lugre", "bristle model with sticking, sliding and creep", unread=(), words="LuGre friction"
    ),
    SealFriction(
        "stribeck",
        "friction as a curve over speed, smooth through zero speed",
        unread=("bristle_travel", "bristle_damping", "bristle_taper"),
        words="Stribeck friction",
    ),
    SealFriction(
        "none",
        "no friction",
        unread=(
            "coulomb",
            "static",
            "stribeck_speed",
            "exponent",
            "bristle_travel",
            "bristle_damping",
            "bristle_taper",
        ),
        words="no dry friction",
    ),
)
"""All friction models of the seals by name."""


ENDS = kinds(
    "end",
    PortEnd(
        "valve",
        "valve, driven by signal or control",
        words=None,
        shut=False,
        holds=False,
        at_cylinder=False,
    ),
    PortEnd(
        "closed",
        "lines closed at the end away from the cylinder",
        words="ports closed",
        shut=True,
        holds=False,
        at_cylinder=False,
    ),
    PortEnd(
        "blocked",
        "ports closed at the cylinder, ahead of any throttle",
        words="ports blocked",
        shut=True,
        holds=False,
        at_cylinder=True,
    ),
    PortEnd(
        "constant_pressure",
        "ports at constant pressure",
        words="ports at constant pressure",
        shut=False,
        holds=True,
        at_cylinder=False,
    ),
    PortEnd(
        "reducing_valve",
        "reducing valves of the design",
        words="ports at reducing valves",
        shut=False,
        holds=False,
        at_cylinder=False,
    ),
)
"""All connections of the ports by name."""


LAWS = kinds(
    "law",
    ControlLaw("p", "proportional", integral=False, derivative=False),
    ControlLaw("pi", "proportional and integral", integral=True, derivative=False),
    ControlLaw("pid", "proportional, integral and derivative", integral=True, derivative=True),
)
"""All control laws by name."""


Records = Mapping[tuple[str, str], tuple[Array, Array]]
"""Time [s] and values [SI] by (file, column) that a part names; missing samples are NaN."""


class SignalPart(Protocol):
    """Values that a shape reads from a part of a signal: times [s], frequency [Hz], phase [rad]."""

    start: float
    end: float | None
    frequency: float | None
    phase: float
    file: str | None
    column: str | None
    scale: float


class Clock(Protocol):
    """Symbols for time in a system of equations, and time-dependent terms that signals use."""

    @property
    def time(self) -> Any:
        """Symbolic expression for the time [s]."""

    def after(self, instant: float) -> Any:
        """Whether the time is after `instant`; the integrator restarts there."""

    def sine(self, angle: Any) -> Any:
        """Sine of an angle [rad] that is given as an expression."""

    def samples(self, time: Array, values: Array, label: str) -> Any:
        """Interpolate samples linearly, constant before the first and after the last."""


@dataclass(frozen=True, slots=True)
class SignalShape:
    """Shape of a signal part.

    Attributes
    ----------
    name, help : name in a scenario, and its meaning
    needed, read : required keys, and optional keys
    instead : for a key that this shape does not use, the shape to suggest
    course : function that returns the expression for the value over time
    initial : function that returns the value at time zero
    lasts : whether the signal keeps its final value
    moves_on : whether the signal changes gradually, so that a following error is defined
    settles : whether the signal becomes constant, so that the response to a superposed step is
        defined
    changes_after : function that returns whether the signal changes after a time [s]
    words : function that returns the text for a report, from the texts of height and times
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
    """Time [s] and values of a recorded part, without its missing samples.

    None if `records` lacks the column.
    """
    column = records.get((part.file or "", part.column or ""))
    if column is None:
        return None
    time, values = column
    finite = np.isfinite(values)
    return time[finite] + part.start, part.scale * values[finite]


def _from_start(part: SignalPart, records: Records) -> float:
    return height(part) if part.start <= 0 else 0.0


def _end(part: SignalPart) -> float:
    return math.inf if part.end is None else part.end


def _turns_at(*names: str) -> Callable[[SignalPart, float, Records], bool]:
    """Return a function that checks whether any of these times of a part is after a given time."""

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
    on, ended = clock.after(start), clock.after(end)
    rise = value * (clock.time - start) / (end - start)
    return where(ended, value, where(on, rise, 0.0))


def _ramps_after(part: SignalPart, moment: float, records: Records) -> bool:
    return part.start < moment < _end(part) or _turns_at("start", "end")(part, moment, records)


def _between(clock: Clock, part: SignalPart) -> Any:
    """Whether the time is between start and end of a part."""
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
    samples = sampled(part, records)
    assert samples is not None
    return clock.samples(*samples, f"{part.column} of {part.file}")


def _record_at_start(part: SignalPart, records: Records) -> float:
    samples = sampled(part, records)
    return 0.0 if samples is None else float(np.interp(0.0, *samples))


def _record_after(part: SignalPart, moment: float, records: Records) -> bool:
    samples = sampled(part, records)
    if samples is None:
        return _until_end(part, moment, records)
    present = float(np.interp(moment, *samples))
    return bool(np.any(samples[1][samples[0] > moment] != present))


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
        "constant value after start",
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
        "sine of amplitude value and of this frequency, from start to end",
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
        "a column of a CSV file, interpolated linearly between its samples",
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
"""All shapes by name."""


class StartPosition(PositionKind):
    """A length from the cap end, or a fraction of the stroke (``50 %``)."""

    help = "piston position from the cap end: a length, or a share of the stroke (50 %)"

    def validate(self, value: Any) -> Position:
        """A length in m, or a `Fraction`."""
        remedy = 'write "50 %" or "55 mm"'
        try:
            position = super().validate(value)
        except ValueFault as fault:
            if "worst" in fault.remedy:
                raise ValueFault(fault.message, remedy) from None
            raise
        if position == "worst":
            raise ValueFault('"worst": not an initial position', remedy)
        return position


PublishedCase: TypeAlias = Annotated[
    Literal["Exudyn2022", "ExudynPress", "FOSSEE788"] | None,
    Choice(
        "published or foreign case that this scenario repeats: its report compares the numbers of "
        "the source with ours; "
        "Exudyn2022: arm lifted by a cylinder, a test model of the multibody program EXUDYN; "
        "ExudynPress: press ram, our circuit as computed by EXUDYN; "
        "FOSSEE788: electrohydraulic servo, examples of a textbook of fluid power"
    ),
]
Shape: TypeAlias = Annotated[str, choice_of("shape of this part of the signal", SHAPES)]
Law: TypeAlias = Annotated[str, choice_of("law of the controller", LAWS)]
Tuning: TypeAlias = Annotated[
    Literal["margins", "ziegler_nichols", "stated"],
    Choice(
        "how the gain and the times of the controller are found; margins: the stability limit of "
        "the linear model divided by a gain margin, for the position and direction with the "
        "lowest limit; ziegler_nichols: by the table of Ziegler and Nichols, from the same limit; "
        "stated: the scenario states all values"
    ),
]
TuningSide: TypeAlias = Annotated[
    Literal["worst", "rest"],
    Choice(
        "side of the spool's centre whose loop sets gain and margins; worst: the side with the "
        "lower limit; rest: the side on which the spool holds the load, or both without load"
    ),
]
Friction: TypeAlias = Annotated[str, choice_of("friction model of the seals", FRICTIONS)]
Supply: TypeAlias = Annotated[str, choice_of("type of supply", SUPPLIES)]
Ends: TypeAlias = Annotated[
    str | None,
    choice_of(
        "connection of the ports (default: the valve of the design, else its ports.end)", ENDS
    ),
]
