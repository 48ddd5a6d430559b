"""The proportional valve (spool and four edges) and its controller.

The controller acts on the control error by a P, PI or PID law. It can have inner feedback loops,
and limits on its output and on the output's rate of change.
"""

from __future__ import annotations

from math import inf
from typing import NamedTuple

from ...base.dataclass import dataclass
from ...base.numeric import clip, where
from ...base.quantities import SCENARIOS
from ...base.symbolic import Expression
from ...models import play, valve
from ...models.metering_spool import spool_flows
from ...models.valve import limited_spool_acceleration, spool_acceleration
from ...studies.plant import ValveData
from .circuit import Circuit

SPOOL = 1e-7
"""Error tolerance of the spool position [V]."""


class Port(NamedTuple):
    """Flows at the ports of the valve."""

    into_a: Expression
    into_b: Expression
    supply: Expression
    tank: Expression


def spool(circuit: Circuit, data: ValveData, command: Expression, prefix: str = "") -> Expression:
    """Spool position for a command, both in volts.

    `prefix` starts the names of the added signals.
    """
    system = circuit.system
    opening = system.state(f"{prefix}spool", 0.0, tolerance=SPOOL)
    speed = system.state(f"{prefix}spool rate", 0.0, tolerance=SPOOL * 6 * data.natural_frequency)
    limited = clip(command, -data.signal, data.signal)
    system.rate(opening, speed)
    law = {
        "command": _played(circuit, data, limited, prefix),
        "opening": opening,
        "rate": speed,
        "natural_frequency": data.natural_frequency,
        "damping_ratio": data.damping_ratio,
    }
    if data.slew_rate is None:
        system.rate(speed, spool_acceleration(**law))
    else:
        system.rate(speed, limited_spool_acceleration(**law, fastest=data.slew_rate))
    volts = SCENARIOS["signal_value"]
    of = " of the load cylinder" if prefix else ""
    system.signal(f"{prefix}signal", f"signal of the valve{of}", volts, limited)
    system.signal(f"{prefix}spool", f"position of the spool{of}", volts, opening)
    return opening


def _played(circuit: Circuit, data: ValveData, command: Expression, prefix: str) -> Expression:
    """Signal that drives the spool: mean of the plays; a linear model leaves them out."""
    if circuit.linear or not data.plays:
        return command
    if circuit.loop is not None and not prefix:
        circuit.system.notes.append(
            "margins and tuned gains of the loop leave out hysteresis and threshold of the valve; "
            "the simulation includes them"
        )
    total: Expression = 0.0
    for number, half_width in enumerate(data.plays, 1):
        output = circuit.system.state(f"{prefix}valve play {number}", 0.0, tolerance=SPOOL)
        rate = play.play_rate(
            command=command,
            output=output,
            half_width=half_width,
            natural_frequency=data.natural_frequency,
        )
        circuit.system.rate(output, rate)
        total = total + output
    return total / len(data.plays)


def edges(
    circuit: Circuit,
    data: ValveData,
    *,
    opening: Expression,
    supply_pressure: Expression,
    return_pressure: Expression,
    pressure_a: Expression,
    pressure_b: Expression,
    prefix: str = "",
) -> Port:
    """Flows through the four edges of the spool.

    The energy that the edges dissipate is added to the balance.
    """
    offset = data.offset if prefix else circuit.value("valve.offset", data.offset)
    port_pressures = {
        "supply_pressure": supply_pressure,
        "return_pressure": return_pressure,
        "pressure_a": pressure_a,
        "pressure_b": pressure_b,
    }
    if data.metering is not None:
        flows = spool_flows(spool=data.metering, signal=opening - offset, **port_pressures)
    else:
        flows = valve.valve_flows(
            signal=opening - offset,
            rated_coefficient=data.rated,
            leakage_supply=data.leakage_supply,
            leakage_tank=data.leakage_tank,
            full_signal=data.signal,
            **port_pressures,
        )
    loss = (
        (supply_pressure - pressure_a) * flows.supply_a
        + (supply_pressure - pressure_b) * flows.supply_b
        + (pressure_a - return_pressure) * flows.a_tank
        + (pressure_b - return_pressure) * flows.b_tank
    )
    of = " of the load cylinder" if prefix else ""
    name = "load cylinder's valve" if prefix else "valve edges"
    circuit.energy_port(name, loss, state=f"{prefix}valve loss")
    for name, words, value in (
        ("a", "into port A", flows.into_a),
        ("b", "into port B", flows.into_b),
        ("supply", "from the supply", flows.supply),
        ("tank", "to the tank", flows.tank),
    ):
        circuit.system.signal(f"{prefix}flow_{name}", f"flow {words}{of}", _FLOW, value)
    return Port(flows.into_a, flows.into_b, flows.supply, flows.tank)


_FLOW = SCENARIOS["flow_value"]


HOLD_BAND = 1e-3
"""Distance from the signal limit, as a share of the full signal, over which the controller's
integration fades out (our choice). Integration stops while the signal is at its limit and the error
would drive it further."""


JUMP_BAND = 0.01
"""Signal over which the jump across the dead band rises, as a share of the full signal (our
choice). The narrower it is, the more the valve swings about its null."""


RATE_TIME = 1e-4
"""Time lag of a rate-limited signal [s] (our choice)."""


@dataclass(frozen=True, slots=True)
class Feedback:
    """Measured signals that the controller uses as feedback."""

    value: Expression
    """Measured value of the controlled quantity: position, speed, shaft speed or shaft angle."""
    speed: Expression
    load_pressure: Expression
    """Load pressure: pressure force on the piston, divided by area A [Pa]."""
    load_pressure_start: float = 0.0


def inner(circuit: Circuit, valve_signal: Expression, measured: Feedback) -> Expression:
    """Valve signal, reduced by feedback of the speed and of changes in the load pressure."""
    system, control = circuit.system, circuit.scenario.control
    if control is None:
        return valve_signal
    valve_signal = valve_signal - control.speed_feedback * measured.speed
    if control.pressure_feedback:
        start = measured.load_pressure_start
        filtered = system.state("filtered load pressure", start, tolerance=1.0)
        system.rate(filtered, (measured.load_pressure - filtered) / control.pressure_time)
        valve_signal = valve_signal - control.pressure_feedback * (
            measured.load_pressure - filtered
        )
    return valve_signal


def command(
    circuit: Circuit, reference: Expression, measured: Feedback, scale: float
) -> Expression:
    """Signal to the valve.

    `scale` is a typical control error, from which tolerances are derived.
    """
    system, control, gains = circuit.system, circuit.scenario.control, circuit.gains
    assert control is not None
    assert gains is not None
    assert circuit.plant.valve is not None
    full_signal = circuit.plant.valve.signal
    proportional_gain = circuit.value(f"control.{circuit.loop}_gain", gains.proportional_gain)
    gain = control.gain_factor * proportional_gain
    error = reference - measured.value
    valve_signal: Expression = gain * error
    if gains.derivative_time > 0:
        filtered = system.state("filtered error", 0.0, tolerance=1e-9 * scale)
        change = (error - filtered) / control.filter_time
        system.rate(filtered, change)
        factor = control.derivative_factor * proportional_gain
        derivative_time = circuit.value("control.derivative_time", gains.derivative_time)
        valve_signal = valve_signal + factor * derivative_time * change
    if control.feed_forward:
        valve_signal = valve_signal + circuit.scenario_signal(control.feed_forward)
    valve_signal = inner(circuit, valve_signal, measured)
    if gains.integral_time < inf:
        integral = system.state("integral part", 0.0, tolerance=1e-7 * full_signal)
        valve_signal = valve_signal + integral
        band = HOLD_BAND * full_signal
        up = clip((full_signal - valve_signal) / band, 0.0, 1.0)
        down = clip((full_signal + valve_signal) / band, 0.0, 1.0)
        factor = control.integral_factor * proportional_gain
        rate = factor / circuit.value("control.integral_time", gains.integral_time) * error
        system.rate(integral, where(rate > 0, rate * up, rate * down))
    if control.dead_band_jump is not None:
        share = clip(valve_signal / (JUMP_BAND * full_signal), -1.0, 1.0)
        valve_signal = valve_signal + control.dead_band_jump * share
    valve_signal = clip(valve_signal, -full_signal, full_signal)
    if control.rate_limit is None:
        return valve_signal
    limited = system.state("limited signal", 0.0, tolerance=1e-7 * full_signal)
    system.rate(
        limited, clip((valve_signal - limited) / RATE_TIME, -control.rate_limit, control.rate_limit)
    )
    return limited
