"""A circuit under construction: data shared by its parts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from ...base.symbolic import Expression, Symbol
from ...design.scenario.model import Scenario
from ...design.scenario.signals import SignalSegment
from ...models.loop import ControllerGains
from ...studies.plant import Plant
from ..loops import Loop
from ..system import System
from . import signals

FLOW = 1e-4
"""Flow whose power at supply pressure scales energies [m^3/s], 6 l/min (a choice)."""


@dataclass(frozen=True, slots=True)
class Start:
    """Initial state of a run."""

    position: float
    pressure_a: float
    pressure_b: float


@dataclass(slots=True)
class Audit:
    """Terms of a run's balance."""

    mass: list[tuple[str, Expression, Symbol]] = field(default_factory=list)
    """Name, content at reference density [m^3], and the integral of the inflow."""
    stored: list[tuple[str, Expression]] = field(default_factory=list)
    """Energy as a function of the states [J]."""
    flows: list[tuple[str, Symbol, bool]] = field(default_factory=list)
    """Energy that entered (True) or left [J]."""


@dataclass(slots=True)
class Circuit:
    """A system of equations with the data for its parts, balance and results."""

    scenario: Scenario
    plant: Plant
    records: signals.Records
    start: Start
    gains: ControllerGains | None = None
    loop: Loop | None = None
    linear: bool = False
    """Whether the loop is opened at a free variable ``u``, without sticking friction."""
    system: System = field(default_factory=System)
    audit: Audit = field(default_factory=Audit)
    measured: Expression = 0.0
    """Measured value of the loop."""
    centre: float = 0.0
    """Signal that centres the spool [V]."""

    def course(self, parts: Sequence[SignalSegment]) -> Expression:
        """A signal of the scenario over time."""
        return signals.signal(self.system, parts, self.records)

    def door(self, name: str, power: Expression, *, state: str = "", into: bool = False) -> None:
        """Add an energy flow to the balance, out of or `into` the circuit, as integral `state`."""
        scale = self.plant.supply_pressure * FLOW
        work = self.system.integral(state or name, power, scale=scale)
        self.audit.flows.append((name, work, into))
