"""A circuit under construction: data that its components share, signals, and control loops.

A signal over time is a sum of pieces, such as steps and sines. The reference of a controller sets
the position or the speed of the piston or of a motor shaft.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import field
from typing import Any, Literal, NamedTuple

import numpy as np

from ...base.dataclass import dataclass
from ...base.numeric import Array, where
from ...base.quantities import INPUTS, SCENARIOS, Quantity
from ...base.symbolic import Expression, Namespace, Symbol, jacobian
from ...design.model import Cushion
from ...design.scenario.kinds import SHAPES, Records, height
from ...design.scenario.model import Controller, Scenario, SignalSegment
from ...evaluation.springs import Give
from ...models.loop import ControllerGains
from ...studies.plant import Plane, Plant
from ..system import System


@dataclass(frozen=True, slots=True)
class _Clock:
    """Time of a system, with the interface `Clock` that the signal shapes in `design` expect."""

    system: System

    @property
    def time(self) -> Expression:
        return self.system.time

    def after(self, instant: float) -> Any:
        return self.system.after(instant)

    def sine(self, angle: Expression) -> Expression:
        return Namespace.sin(angle)

    def samples(self, time: Array, values: Array, label: str) -> Expression:
        self.system.bends += _bends(time, values)
        course, slope = SampledCourse(time, values), _slope(time, values)
        return self.system.graph.table(course, self.time, slope, label)


def signal(system: System, parts: Sequence[SignalSegment], records: Records) -> Expression:
    """Sum of the pieces of a signal at the system's time; zero if the signal has no pieces."""
    total: Expression = 0.0
    for part in parts:
        total = total + SHAPES[part.shape].course(_Clock(system), part, records)
    return total


@dataclass(frozen=True, slots=True)
class SampledCourse:
    """Function of time that is linear between the samples and constant outside them."""

    time: Array
    values: Array

    def __call__(self, moment: Any) -> Any:
        """Value at a time or at an array of times."""
        values_at = np.interp(moment, self.time, self.values)
        return float(values_at) if np.ndim(values_at) == 0 else values_at


@dataclass(frozen=True, slots=True)
class SampledSlope:
    """Time derivative of a `SampledCourse`: constant between two samples, zero outside them."""

    time: Array
    values: Array
    """Slope before the first sample, between the samples, and after the last."""

    def __call__(self, moment: Any) -> Any:
        """Slope at a time or at an array of times."""
        slopes_at = self.values[np.searchsorted(self.time, moment, side="right")]
        return float(slopes_at) if np.ndim(slopes_at) == 0 else slopes_at


def _slope(time: Array, values: Array) -> SampledSlope:
    """Time derivative of a `SampledCourse`."""
    run = np.diff(time)
    rise = np.divide(np.diff(values), run, out=np.zeros(len(run)), where=run > 0)
    return SampledSlope(time, np.concatenate(([0.0], rise, [0.0])))


def _bends(time: Array, values: Array) -> list[float]:
    """Times at which the slope changes, including the first and the last sample."""
    rise, run = np.diff(values, prepend=values[:1], append=values[-1:]), np.diff(time)
    run = np.concatenate(([1.0], run, [1.0]))
    slope = np.divide(rise, run, out=np.full(len(rise), np.inf), where=run > 0)
    bends: list[float] = time[slope[1:] != slope[:-1]].tolist()
    return bends


def rate(system: System, expression: Expression) -> Expression:
    """Time derivative of a signal between its jumps."""
    return jacobian([expression], [system.time])[0][0]


def steady_value(parts: Sequence[SignalSegment]) -> float:
    """Final value of a signal: the sum of its pieces that keep their final value."""
    return sum(height(part) for part in parts if SHAPES[part.shape].lasts)


def at_start(parts: Sequence[SignalSegment], records: Records) -> float:
    """Value of a signal at time zero; a piece whose record is missing counts as zero."""
    return sum(SHAPES[part.shape].initial(part, records) for part in parts)


def acts_after(part: SignalSegment, moment: float, records: Records) -> bool:
    """Whether a piece of a signal still changes after a given time [s]."""
    return SHAPES[part.shape].changes_after(part, moment, records)


def frequencies(parts: Sequence[SignalSegment]) -> tuple[float, ...]:
    """Frequencies of the sinusoidal pieces of a signal [Hz]."""
    return tuple(
        part.frequency
        for part in parts
        if part.frequency and "frequency" in SHAPES[part.shape].needed
    )


Loop = Literal["position", "speed", "shaft_speed", "shaft_angle"]


class Followed(NamedTuple):
    """Controlled quantity of a control loop."""

    words: str
    quantity: Quantity
    unit: str
    """Unit of the controller gain."""
    typical: float
    """A typical control error (SI), from which tolerances are derived."""


def _followed(words: str, quantity: Quantity, gain: str, typical: float) -> Followed:
    return Followed(words, quantity, SCENARIOS[gain].unit, typical)


LOOPS: dict[Loop, Followed] = {
    "position": _followed("position", INPUTS["position"], "position_gain", 1e-2),
    "speed": _followed("speed", SCENARIOS["speed_value"], "speed_gain", 0.1),
    "shaft_speed": _followed(
        "shaft speed", SCENARIOS["shaft_speed_value"], "shaft_speed_gain", 10.0
    ),
    "shaft_angle": _followed(
        "shaft angle", SCENARIOS["shaft_angle_value"], "shaft_angle_gain", 1.0
    ),
}
"""Control loops, by the name of the controlled quantity."""


def loop_of(control: Controller | None) -> Loop | None:
    """The loop for which a controller states a reference; None without a controller."""
    if control is None:
        return None
    return next((name for name in LOOPS if getattr(control, name)), None)


FLOW = 1e-4
"""Flow of 6 l/min [m^3/s] (our choice). Multiplied by the supply pressure, it gives a typical
power, from which the error tolerances of energies are derived."""


@dataclass(frozen=True, slots=True)
class InitialState:
    """Position and chamber pressures at the start of a simulation."""

    position: Expression
    pressure_a: Expression
    pressure_b: Expression


@dataclass(slots=True)
class Audit:
    """Terms of the mass and energy balance of a simulation."""

    mass: list[tuple[str, Expression, Symbol]] = field(default_factory=list)
    """Name of a volume, its oil content at reference density [m^3], and the integral of its
    inflow."""
    stored: list[tuple[str, Expression]] = field(default_factory=list)
    """Name of an energy store, and its energy as a function of the states [J]."""
    flows: list[tuple[str, Symbol, bool]] = field(default_factory=list)
    """Name of an energy flow, its integral [J], and whether it enters the circuit (True) or leaves
    it."""


class FreeValue(NamedTuple):
    """A value of the circuit that a variable replaces."""

    symbol: Symbol
    stated: Expression
    """Value that the scenario or the design states; it may depend on time."""
    flag: Symbol | None
    """Flag that is true if the variable counts, and false if the stated value does; None if the
    variable always counts, because the stated value is a number."""
    value: Expression
    """Value in the equations: the variable or, while its flag is false, the stated value."""


class ChamberVolumes(NamedTuple):
    """Dead volumes [m^3] and walls of both chambers, with the lines that are lumped into them."""

    dead_a: float
    dead_b: float
    walls: Give


@dataclass(frozen=True, slots=True)
class FrictionCurve:
    """Seal friction as a function of speed and chamber pressures."""

    coulomb: Plane
    static: Plane
    stribeck_speed: float
    exponent: float
    viscous: float
    bristle_stiffness: float
    bristle_damping: float
    passive_speed: float
    """Speed up to which the bristles cannot add energy with their damping at rest [m/s]."""
    taper_speed: float | None
    """Speed at which the bristle damping has fallen to 1/e of its value at rest; None: it stays."""


@dataclass(slots=True)
class Circuit:
    """A system of equations, with the data that its components, balance and results need."""

    scenario: Scenario
    plant: Plant
    records: Records
    start: InitialState
    gains: ControllerGains | None = None
    loop: Loop | None = None
    linear: bool = False
    """Whether the control loop is opened at the valve signal, which becomes a free variable ``u``.
    Friction is then viscous only."""
    system: System = field(default_factory=System)
    audit: Audit = field(default_factory=Audit)
    measured: Expression = 0.0
    """Measured value of the controlled quantity."""
    centre: float = 0.0
    """Valve signal that centres the spool [V]."""
    free: Collection[str] = ()
    """Names of the values that stay variables of the equations (see `value`)."""
    freed: dict[str, FreeValue] = field(default_factory=dict)
    """Those of the names in `free` that the equations use."""
    driven: bool = False
    """Whether the valve of the design drives the circuit."""
    volumes: ChamberVolumes | None = None
    friction: FrictionCurve | None = None
    """Friction of the seals, if the circuit has any."""

    def value(self, name: str, stated: Expression) -> Expression:
        """A stated value, or a variable that replaces it if `name` is one of `free`."""
        if name not in self.free:
            return stated
        if name not in self.freed:
            graph = self.system.graph
            symbol, flag = graph.variable(name), None
            if isinstance(stated, Symbol):
                flag = graph.flag(f"{name} is set")
            value = symbol if flag is None else where(flag, symbol, stated)
            self.freed[name] = FreeValue(symbol, stated, flag, value)
        return self.freed[name].value

    @property
    def begin(self) -> InitialState:
        """The initial position and pressures, from which the states start; some may be free."""
        names = InitialState.__dataclass_fields__
        return InitialState(
            **{name: self.value(f"initial.{name}", getattr(self.start, name)) for name in names}
        )

    @property
    def return_pressure(self) -> Expression:
        """The return pressure."""
        return self.value("supply.return_pressure", self.plant.return_pressure)

    @property
    def cushion(self) -> Cushion | None:
        """The cushion of the scenario, or else of the design."""
        return self.scenario.stops.cushion or self.plant.design.cushion

    def start_of_edges(self, side: float) -> float:
        """Signal from the centre at which the edges of a direction (1 or -1) open [V]."""
        valve = self.plant.valve
        return 0.0 if valve is None else valve.start(side)

    def scenario_signal(self, parts: Sequence[SignalSegment]) -> Expression:
        """A signal of the scenario as a function of time."""
        return signal(self.system, parts, self.records)

    def energy_port(
        self, name: str, power: Expression, *, state: str = "", into: bool = False
    ) -> None:
        """Add an energy flow that leaves the circuit or, if `into` is true, enters it.

        `power` is the power of this flow [W]; `state` is the name of the added state that
        integrates it over time.
        """
        scale = self.plant.supply_pressure * FLOW
        work = self.system.integral(state or name, power, scale=scale)
        self.audit.flows.append((name, work, into))
