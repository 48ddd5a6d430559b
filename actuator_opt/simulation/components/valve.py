"""The proportional valve: spool and four edges."""

from __future__ import annotations

from typing import NamedTuple

from ...base.numeric import clip
from ...base.quantities import SCENARIOS
from ...base.symbolic import Expression
from ...models import valve
from ...models.valve import spool_acceleration
from ...studies.plant import ValveData
from .circuit import Circuit

SPOOL = 1e-7
"""Error tolerance of the spool position [V]."""


class Port(NamedTuple):
    """Flows of the valve."""

    into_a: Expression
    into_b: Expression
    supply: Expression
    tank: Expression


def spool(circuit: Circuit, data: ValveData, command: Expression, whose: str = "") -> Expression:
    """Spool position for a command, in volts; `whose` prefixes the names of its signals."""
    system = circuit.system
    opening = system.state(f"{whose}spool", 0.0, tolerance=SPOOL)
    speed = system.state(f"{whose}spool rate", 0.0, tolerance=SPOOL * 6 * data.natural_frequency)
    limited = clip(command, -data.signal, data.signal)
    system.rate(opening, speed)
    system.rate(
        speed,
        spool_acceleration(
            command=limited,
            opening=opening,
            rate=speed,
            natural_frequency=data.natural_frequency,
            damping_ratio=data.damping_ratio,
        ),
    )
    volts = SCENARIOS["signal_value"]
    of = " of the load cylinder" if whose else ""
    system.signal(f"{whose}signal", f"signal of the valve{of}", volts, limited)
    system.signal(f"{whose}spool", f"position of the spool{of}", volts, opening)
    return opening


def edges(
    circuit: Circuit,
    data: ValveData,
    *,
    opening: Expression,
    supply_pressure: Expression,
    return_pressure: float,
    pressure_a: Expression,
    pressure_b: Expression,
    whose: str = "",
) -> Port:
    """Flows through the four edges, and their losses."""
    flows = valve.valve_flows(
        signal=opening - data.offset,
        rated_coefficient=data.rated,
        leakage_supply=data.leakage_supply,
        leakage_tank=data.leakage_tank,
        full_signal=data.signal,
        supply_pressure=supply_pressure,
        return_pressure=return_pressure,
        pressure_a=pressure_a,
        pressure_b=pressure_b,
    )
    lost = (
        (supply_pressure - pressure_a) * flows.supply_a
        + (supply_pressure - pressure_b) * flows.supply_b
        + (pressure_a - return_pressure) * flows.a_tank
        + (pressure_b - return_pressure) * flows.b_tank
    )
    of = " of the load cylinder" if whose else ""
    name = "load cylinder's valve" if whose else "valve edges"
    circuit.door(name, lost, state=f"{whose}valve loss")
    for name, words, value in (
        ("a", "into port A", flows.into_a),
        ("b", "into port B", flows.into_b),
        ("supply", "from the supply", flows.supply),
        ("tank", "to the tank", flows.tank),
    ):
        circuit.system.signal(f"{whose}flow_{name}", f"flow {words}{of}", _FLOW, value)
    return Port(flows.into_a, flows.into_b, flows.supply, flows.tank)


_FLOW = SCENARIOS["flow_value"]
