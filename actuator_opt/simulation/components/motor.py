"""A hydraulic motor between two pipes, by the Wilson model."""

from __future__ import annotations

from typing import NamedTuple

from ...base.quantities import SCENARIOS
from ...base.symbolic import Expression, Symbol
from ...models import wilson
from ..system import System
from .chambers import node
from .circuit import Circuit

SPEED = 1e-8
ANGLE = 1e-9
"""Error tolerances of shaft speed [rad/s] and angle [rad]."""


class Shaft(NamedTuple):
    """States of the shaft."""

    angle: Symbol
    speed: Symbol


def shaft(system: System) -> Shaft:
    """The shaft at rest."""
    return Shaft(
        system.state("shaft angle", 0.0, tolerance=ANGLE),
        system.state("shaft speed", 0.0, tolerance=SPEED),
    )


def turn(
    circuit: Circuit,
    own: Shaft,
    *,
    pressure_a: Symbol,
    pressure_b: Symbol,
    inflow_a: Expression,
    inflow_b: Expression,
) -> None:
    """Pipes, motor and load; a linear circuit omits Coulomb friction."""
    system, motor = circuit.system, circuit.scenario.motor
    assert motor is not None
    angle, speed = own
    machine = motor.machine
    across = pressure_a - pressure_b
    common = {
        "speed": speed,
        "pressure_difference": across,
        "displacement": machine.displacement,
        "dynamic_viscosity": circuit.plant.oil.dynamic_viscosity,
        "setting": machine.setting,
    }
    flow = wilson.motor_flow(**common, slip_coefficient=machine.slip)
    torque = wilson.motor_torque(
        **common,
        coulomb_coefficient=0.0 if circuit.linear else machine.coulomb,
        viscous_coefficient=machine.viscous,
        constant_torque=0.0 if circuit.linear else machine.constant_torque,
    )
    for name, pressure, inflow in (
        ("pipe A", pressure_a, inflow_a - flow),
        ("pipe B", pressure_b, inflow_b + flow),
    ):
        node(circuit, name, pressure, inflow=inflow, volume=motor.pipe_volume)
    load = circuit.course(motor.torque) + motor.damping * speed
    system.rate(angle, speed)
    system.rate(speed, (torque - load) / motor.inertia)
    circuit.audit.stored.append(("motion", 0.5 * motor.inertia * speed * speed))
    circuit.door("losses of the motor", across * flow - torque * speed, state="motor loss")
    circuit.door("load", load * speed, state="work on the load")
    system.signal("shaft_speed", "speed of the shaft", SCENARIOS["shaft_speed_value"], speed)
    system.signal("shaft_angle", "angle of the shaft", SCENARIOS["shaft_angle_value"], angle)
    system.signal("torque", "torque of the motor", SCENARIOS["torque_value"], torque)
    system.signal("load_torque", "torque of the load", SCENARIOS["torque_value"], load)
    system.signal("flow_motor", "flow through the motor", SCENARIOS["flow_value"], flow)
