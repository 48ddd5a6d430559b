"""A system of ordinary differential equations under construction, and its compiled form.

Components add states, rates and signals as expressions in the same symbols. They call the models of
`actuator_opt.models` with these symbols instead of numbers, so the simulation has no formulas of
its own. Jumps are represented by flags, which are constant between two restarts of the integration.
There are two kinds of flags. Instants are true after a given time. Switches are true while an
expression, the guard of the switch, is positive.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field
from typing import Any

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array, clip, maximum, minimum, where
from ..base.quantities import Quantity
from ..base.symbolic import Equations, Expression, Graph, Namespace, Symbol, jacobian
from ..models.fluid import ATMOSPHERIC_PRESSURE

LOOSE = 1e-4
"""Tolerance of an integral relative to its scale (our choice: so wide that the other states
determine the step size)."""
PRESSURE = 1.0
"""Error tolerance of a pressure [Pa]."""
EMPTY = -40.0
"""Lower limit of a pressure state, in units of the atmospheric pressure. Negative states are
logarithmic (see `System.pressure`); below this limit, the distance to vacuum is lost in
rounding."""
VACUUM = 1e-6
"""Smallest absolute initial pressure, in units of the atmospheric pressure."""


@dataclass(slots=True)
class SystemState:
    """A state with its initial value, error tolerance and rate."""

    name: str
    symbol: Symbol
    initial: Expression
    tolerance: float
    rate: Expression = 0.0
    integral: bool = False
    """Whether the state is only an integral for the results, on which no other equation depends."""


@dataclass(frozen=True, slots=True)
class Switch:
    """A flag that is true while an expression, its guard, is positive."""

    name: str
    flag: str
    guard: Expression


@dataclass(frozen=True, slots=True)
class Instant:
    """A flag that is true after a given time."""

    flag: str
    time: float


@dataclass(frozen=True, slots=True)
class Signal:
    """An output signal: an expression with its quantity."""

    name: str
    label: str
    quantity: Quantity
    value: Expression


@dataclass(slots=True)
class System:
    """A system of equations under construction; `compiled` returns its functions."""

    graph: Graph = field(default_factory=Graph)
    states: list[SystemState] = field(default_factory=list)
    switches: list[Switch] = field(default_factory=list)
    instants: list[Instant] = field(default_factory=list)
    signals: list[Signal] = field(default_factory=list)
    pressure_states: dict[int, Symbol] = field(default_factory=dict)
    """State from which each pressure is computed, by index of the pressure's symbol."""
    bends: list[float] = field(default_factory=list)
    """Times at which the slope of an input record changes. No integration step is longer than the
    interval between them."""
    notes: list[str] = field(default_factory=list)
    """Notes for the user: assumptions and simplifications that affect the result."""

    @property
    def time(self) -> Symbol:
        """The time [s]."""
        return self.graph.variable("t")

    def state(self, name: str, initial: Expression, *, tolerance: float) -> Symbol:
        """Add a state, whose time derivative `rate` sets later."""
        initial = initial if isinstance(initial, Symbol) else float(initial)
        symbol = self.graph.variable(f"y_{len(self.states)}")
        self.states.append(SystemState(name, symbol, initial, tolerance))
        return symbol

    def pressure(self, name: str, initial: Expression) -> Symbol:
        """Add a gauge pressure as a state that cannot fall below vacuum.

        The state s is defined by s = p for p above zero, and by s = p_a ln(1 + p/p_a) below zero. p
        is the gauge pressure, p_a the atmospheric pressure. An error of s is then relative to the
        distance from vacuum, and s has no lower limit.
        """
        air = ATMOSPHERIC_PRESSURE
        clipped = maximum(initial, (VACUUM - 1) * air)
        start = where(clipped >= 0, clipped, air * Namespace.log1p(minimum(clipped, 0.0) / air))
        state = self.state(name, start, tolerance=PRESSURE)
        below_zero = air * Namespace.expm1(_below(state) / air)
        symbol: Symbol = where(state >= 0, state, below_zero)
        self.pressure_states[symbol.index] = state
        return symbol

    def rate(self, symbol: Symbol, rate: Expression) -> None:
        """Set the time derivative of a state or a pressure."""
        state = self.pressure_states.get(symbol.index)
        if state is not None:
            slope = Namespace.exp(-_below(state) / ATMOSPHERIC_PRESSURE)
            symbol, rate = state, where(state >= 0, rate, rate * slope)
        next(s for s in self.states if s.symbol is symbol).rate = rate

    def integral(self, name: str, rate: Expression, *, scale: float) -> Symbol:
        """Add the integral of an expression over time, from zero.

        Its error does not limit the size of the integration steps.
        """
        symbol = self.state(name, 0.0, tolerance=LOOSE * scale)
        self.states[-1].rate, self.states[-1].integral = rate, True
        return symbol

    def after(self, time: float) -> Any:
        """A flag that is true after a given time; the integration restarts then."""
        if time <= 0:
            return True
        existing = next((instant for instant in self.instants if instant.time == time), None)
        if existing is None:
            existing = Instant(f"m_{len(self.instants)}", time)
            self.instants.append(existing)
        return self.graph.flag(existing.flag)

    def switch(self, name: str, guard: Expression) -> Symbol:
        """A flag that is true while the guard is positive.

        The integration computes the times at which the flag changes.
        """
        flag = f"s_{len(self.switches)}"
        self.switches.append(Switch(name, flag, guard))
        return self.graph.flag(flag)

    def signal(self, name: str, label: str, quantity: Quantity, value: Expression) -> None:
        """Add an output signal; it replaces an earlier signal of the same name."""
        self.signals = [signal for signal in self.signals if signal.name != name]
        self.signals.append(Signal(name, label, quantity, value))

    @property
    def flags(self) -> list[str]:
        """Names of the flags: first the instants, then the switches."""
        return [instant.flag for instant in self.instants] + [
            switch.flag for switch in self.switches
        ]

    def equations(self, outputs: Sequence[Expression]) -> Equations:
        """Outputs as functions of time, states and flags."""
        flags = [self.graph.flag(name) for name in self.flags]
        return Equations(self.time, [state.symbol for state in self.states], flags, outputs)

    def compiled(self) -> Compiled:
        """The equations as functions of time, states and flags."""
        return Compiled.of(self)


@dataclass(frozen=True, slots=True)
class Compiled:
    """Equations of a system, as functions of time, states and flags.

    The flags are in the order of the `instants`, followed by the switches.
    """

    system: System
    rates: Equations
    """Time derivatives of the states."""
    switches: Equations
    """Guards of all switches, followed by their time derivatives."""
    signal_values: Equations
    initial: Array
    tolerances: Array
    instants: tuple[float, ...]
    bends: Array
    """Times at which the slope of an input record changes, in ascending order."""

    @classmethod
    def of(cls, system: System) -> Compiled:
        """Write the programs of the equations."""
        guards = [switch.guard for switch in system.switches]
        return cls(
            system=system,
            rates=system.equations([state.rate for state in system.states]),
            switches=system.equations([*guards, *guard_rates(system)]),
            signal_values=system.equations([signal.value for signal in system.signals]),
            initial=np.array([state.initial for state in system.states]),
            tolerances=np.array([state.tolerance for state in system.states]),
            instants=tuple(instant.time for instant in system.instants),
            bends=np.unique(np.array(system.bends, dtype=float)),
        )

    def signals(self, t: Array, y: Array, m: Sequence[Array]) -> dict[str, Array]:
        """Values of every signal at samples; y has one row per state, m one per flag."""
        values = self.signal_values.at_samples(t, y, m)
        names = (signal.name for signal in self.system.signals)
        return dict(zip(names, values, strict=True))


def _below(state: Symbol) -> Expression:
    """A pressure state, limited to the range from `EMPTY` atmospheres to 0."""
    return clip(state, EMPTY * ATMOSPHERIC_PRESSURE, 0.0)


def guard_rates(system: System) -> list[Expression]:
    """Time derivatives of the guards along the solution."""
    symbols, rates = [state.symbol for state in system.states], [s.rate for s in system.states]
    rates_of_guards = []
    for row in jacobian([switch.guard for switch in system.switches], [*symbols, system.time]):
        slopes = zip(row, [*rates, 1.0], strict=True)
        rates_of_guards.append(sum((slope * rate for slope, rate in slopes), start=0.0))
    return rates_of_guards
