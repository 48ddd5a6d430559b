"""Mass and energy balance of a run: stored content against flows across the boundary."""

from __future__ import annotations

import numpy as np

from ..base.numeric import Array
from ..base.symbolic import vectorised
from .integrate import Trajectory
from .parts.circuit import Circuit
from .result import Balance, Flow
from .system import System


def balance(circuit: Circuit, run: Trajectory) -> Balance:
    """The balance of a run from its states, as content and energy are functions of them."""
    audit, system = circuit.audit, circuit.system
    at = {state.symbol.index: k for k, state in enumerate(system.states)}

    def integral(symbol: object) -> Array:
        return run.states[at[symbol.index]]  # type: ignore[attr-defined]

    contents = _values(system, [value for _, value, _ in audit.mass], run)
    mass = 0.0
    for (_, _, inflow), content in zip(audit.mass, contents, strict=True):
        missing = content - content[0] - integral(inflow)
        mass = max(mass, float(np.max(np.abs(missing)) / np.max(np.abs(content))))
    stored = _values(system, [value for _, value in audit.stored], run)
    kept: dict[str, Array] = {}
    for (name, _), value in zip(audit.stored, stored, strict=True):
        kept[name] = kept.get(name, 0.0) + value - value[0]
    doors: dict[str, Array] = {}
    for name, symbol, into in audit.flows:
        doors[name] = doors.get(name, 0.0) + (1 if into else -1) * integral(symbol)
    missing = sum(kept.values(), start=np.zeros(len(run.time))) - sum(doors.values())
    through = sum(float(np.sum(np.abs(np.diff(value)))) for value in doors.values())
    through += max((float(np.ptp(value)) for value in kept.values()), default=0.0)
    return Balance(
        mass=mass,
        energy=float(np.max(np.abs(missing))) / through if through > 0 else 0.0,
        flows=tuple(Flow(name, float(value[-1])) for name, value in doors.items()),
        stored=tuple(Flow(name, float(value[-1])) for name, value in kept.items()),
    )


def _values(system: System, expressions: list[object], run: Trajectory) -> list[Array]:
    """Expressions of the states at every sample."""
    unpack = system.unpack([state.symbol for state in system.states], "y")
    values = vectorised("stored", "t, y, m", unpack, expressions)(
        run.time, run.states, tuple(run.flags)
    )
    return [np.broadcast_to(np.asarray(value, float), run.time.shape) for value in values]
