"""The proportional valve (spool and four edges) and its controller.

The controller is P, PI or PID on the error, with inner loops and limits of value and rate.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import NamedTuple

from ...base.numeric import clip, where
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


HOLD_BAND = 1e-3
"""Share of the full signal over which the integral part stops before the limit (a choice: the
integral is frozen while the signal is saturated and the error would increase it)."""


RATE_TIME = 1e-4
"""Time lag of a rate-limited signal [s] (a choice)."""


@dataclass(frozen=True, slots=True)
class Feedback:
    """Feedback signals of the controller."""

    value: Expression
    """Measured value of the loop: position, speed, shaft speed or angle."""
    speed: Expression
    load_pressure: Expression
    """Load pressure: pressure force over area A [Pa]."""
    load_pressure_start: float = 0.0


def inner(circuit: Circuit, wish: Expression, measured: Feedback) -> Expression:
    """A reference less the inner loops: speed, and changes of the load pressure."""
    system, stated = circuit.system, circuit.scenario.control
    if stated is None:
        return wish
    wish = wish - stated.speed_feedback * measured.speed
    if stated.pressure_feedback:
        start = measured.load_pressure_start
        slow = system.state("filtered load pressure", start, tolerance=1.0)
        system.rate(slow, (measured.load_pressure - slow) / stated.pressure_time)
        wish = wish - stated.pressure_feedback * (measured.load_pressure - slow)
    return wish


def command(
    circuit: Circuit, reference: Expression, measured: Feedback, scale: float
) -> Expression:
    """Signal to the valve; `scale` is a typical control error, for tolerances."""
    system, stated, gains = circuit.system, circuit.scenario.control, circuit.gains
    assert stated is not None
    assert gains is not None
    assert circuit.plant.valve is not None
    full_signal = circuit.plant.valve.signal
    gain = stated.gain_factor * gains.proportional_gain
    error = reference - measured.value
    wish: Expression = gain * error
    if gains.derivative_time > 0:
        slow = system.state("filtered error", 0.0, tolerance=1e-9 * scale)
        change = (error - slow) / stated.filter_time
        system.rate(slow, change)
        factor = stated.derivative_factor * gains.proportional_gain
        wish = wish + factor * gains.derivative_time * change
    wish = inner(circuit, wish, measured)
    if gains.integral_time < inf:
        part = system.state("integral part", 0.0, tolerance=1e-7 * full_signal)
        wish = wish + part
        band = HOLD_BAND * full_signal
        up = clip((full_signal - wish) / band, 0.0, 1.0)
        down = clip((full_signal + wish) / band, 0.0, 1.0)
        factor = stated.integral_factor * gains.proportional_gain
        rate = factor / gains.integral_time * error
        system.rate(part, where(rate > 0, rate * up, rate * down))
    wish = clip(wish, -full_signal, full_signal)
    if stated.rate_limit is None:
        return wish
    limited = system.state("limited signal", 0.0, tolerance=1e-7 * full_signal)
    system.rate(limited, clip((wish - limited) / RATE_TIME, -stated.rate_limit, stated.rate_limit))
    return limited
