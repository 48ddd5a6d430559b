"""A hydraulic motor between two pipes, by the Wilson model."""

from __future__ import annotations

from typing import NamedTuple

from ...design.scenario.model import Motor
from ...evaluation.study.plant import Plant
from ...models import wilson
from ...quantities import SCENARIOS
from ...symbolic import Expression, Symbol
from ..system import System
from .chambers import Audit, node
from .signals import Records, signal

SPEED = 1e-8
ANGLE = 1e-9
"""Errors of shaft speed [rad/s] and angle [rad] that are let pass."""


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
    system: System,
    audit: Audit,
    plant: Plant,
    motor: Motor,
    records: Records,
    own: Shaft,
    *,
    pressure_a: Symbol,
    pressure_b: Symbol,
    inflow_a: Expression,
    inflow_b: Expression,
    smooth: bool,
    power: float,
) -> None:
    """Pipes, motor and load; `smooth` leaves the friction out that has the sign of the speed."""
    angle, speed = own
    machine = motor.machine
    across = pressure_a - pressure_b
    common = {
        "speed": speed,
        "pressure_difference": across,
        "displacement": machine.displacement,
        "dynamic_viscosity": plant.oil.dynamic_viscosity,
        "setting": machine.setting,
    }
    flow = wilson.motor_flow(**common, slip_coefficient=machine.slip)
    torque = wilson.motor_torque(
        **common,
        coulomb_coefficient=0.0 if smooth else machine.coulomb,
        viscous_coefficient=machine.viscous,
        constant_torque=0.0 if smooth else machine.constant_torque,
    )
    for name, pressure, inflow in (
        ("pipe A", pressure_a, inflow_a - flow),
        ("pipe B", pressure_b, inflow_b + flow),
    ):
        node(system, audit, name, plant.oil, pressure, inflow=inflow, volume=motor.pipe_volume)
    load = signal(system, motor.torque, records) + motor.damping * speed
    system.rate(angle, speed)
    system.rate(speed, (torque - load) / motor.inertia)
    audit.stored.append(("motion", 0.5 * motor.inertia * speed * speed))
    lost = system.integral("motor loss", across * flow - torque * speed, scale=power)
    audit.flows.append(("losses of the motor", lost, False))
    work = system.integral("work on the load", load * speed, scale=power)
    audit.flows.append(("load", work, False))
    system.signal("shaft_speed", "speed of the shaft", SCENARIOS["shaft_speed_value"], speed)
    system.signal("shaft_angle", "angle of the shaft", SCENARIOS["shaft_angle_value"], angle)
    system.signal("torque", "torque of the motor", SCENARIOS["torque_value"], torque)
    system.signal("load_torque", "torque of the load", SCENARIOS["torque_value"], load)
    system.signal("flow_motor", "flow through the motor", SCENARIOS["flow_value"], flow)
