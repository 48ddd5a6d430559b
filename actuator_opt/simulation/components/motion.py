"""Motion of the rod: mass, end stops, cushions, load, joint, external machine."""

from __future__ import annotations

from ...base.numeric import where
from ...base.quantities import INPUTS, SCENARIOS
from ...base.symbolic import Expression, Symbol
from ...models import end_stop, linkage
from .circuit import Circuit
from .signals import rate

POSITION = 1e-10
SPEED = 1e-9
"""Error tolerances of position [m] and speed [m/s]."""
_FORCE = SCENARIOS["force_value"]


def stops(circuit: Circuit, position: Symbol, speed: Symbol) -> Expression:
    """Force of the end stops; contact is located in time, as the force jumps."""
    system, plant = circuit.system, circuit.plant
    damping = end_stop.stop_damping(
        stiffness=plant.stop_stiffness,
        mass=plant.moving_mass(circuit.start.position),
        factor=circuit.scenario.stops.damping,
    )
    law = {"stiffness": plant.stop_stiffness, "damping": float(damping)}
    at_cap = system.switch("stop at the cap end", -position)
    at_rod = system.switch("stop at the rod end", position - plant.stroke)
    cap = end_stop.contact_force(compression=-position, closing_speed=-speed, **law)
    rod = end_stop.contact_force(compression=position - plant.stroke, closing_speed=speed, **law)
    return where(at_cap, cap, 0.0) - where(at_rod, rod, 0.0)


def cushions(circuit: Circuit, position: Symbol, speed: Symbol) -> Expression:
    """Force of the oil throttled by the cushion spears, on the whole area of each chamber."""
    plant, cushion = circuit.plant, circuit.scenario.stops.cushion
    if cushion is None:
        return 0.0
    total: Expression = 0.0
    ends = (
        ("cap", position, -speed, plant.area_a, 1.0),
        ("rod", plant.stroke - position, speed, plant.area_b, -1.0),
    )
    for name, left, into, area, way in ends:
        if cushion.ends not in ("both", name):
            continue
        opening = end_stop.cushion_flow_area(
            remaining=left,
            length=cushion.length,
            open_area=cushion.open_area,
            end_area=cushion.end_area,
            exponent=cushion.exponent,
        )
        pressure = end_stop.cushion_pressure(
            speed=into,
            area=area,
            flow_area=opening,
            density=plant.oil.density,
            dynamic_viscosity=plant.oil.dynamic_viscosity,
        )
        total = total + way * where(left < cushion.length, pressure * area, 0.0)
    return total


def move(
    circuit: Circuit,
    *,
    position: Symbol,
    speed: Symbol,
    pressure_force: Expression,
    friction: Expression,
    pulled: Expression = 0.0,
) -> None:
    """Motion, m a = F_p - F_fr - b v + F_stop + F_cushion - F_L, with its energy balance."""
    system, plant, load = circuit.system, circuit.plant, circuit.scenario.load

    def spent(name: str, force: Expression) -> None:
        circuit.door(name, force * speed, state=f"work on {name}")

    sheared = plant.oil_damping * speed
    stopping = stops(circuit, position, speed)
    braking = cushions(circuit, position, speed)
    begin = circuit.start.position
    held = circuit.course(load.force) + load.stiffness * (position - begin) + load.damping * speed
    total = pressure_force - friction - sheared + stopping + braking - held + pulled
    mass: Expression = plant.mass
    circuit.audit.stored.append(("motion", 0.5 * plant.mass * speed * speed))
    spent("friction of the seals", friction)
    if plant.oil_damping:
        spent("shear of the oil", sheared)
    spent("stops", -stopping)
    if circuit.scenario.stops.cushion is not None:
        spent("cushions", -braking)
        system.signal("cushion_force", "force of the cushions", _FORCE, braking)
    spent("load", held)
    held = held - pulled
    if load.drive is not None:
        where_to = circuit.course(load.drive.position) + begin
        moved = rate(system, where_to)
        pull = load.drive.stiffness * (where_to - position) + load.drive.damping * (moved - speed)
        total, held = total + pull, held - pull
        spent("machine outside", -pull)
        system.signal(
            "drive_position", "position of the external machine", INPUTS["position"], where_to
        )
    if plant.design.linkage is not None:
        mass, more = _joint(circuit, position, speed)
        total, held = total - more, held + more
    system.rate(position, speed)
    system.rate(speed, total / mass)
    for name, words, quantity, value in (
        ("position", "position of the piston", INPUTS["position"], position),
        ("speed", "speed of the piston", SCENARIOS["speed_value"], speed),
        ("load_force", "force of the load", _FORCE, held),
        ("friction", "friction of the seals", _FORCE, friction),
        ("stop_force", "force of the end stops", _FORCE, stopping),
        ("pressure_force", "force of the pressures", _FORCE, pressure_force),
    ):
        system.signal(name, words, quantity, value)


def _joint(circuit: Circuit, position: Symbol, speed: Symbol) -> tuple[Expression, Expression]:
    """Mass at the rod with the joint's inertia, and the force of joint torque and inertia."""
    system, plant = circuit.system, circuit.plant
    joint = plant.joint(position)
    assert joint is not None
    arm, felt = joint
    torque = circuit.course(circuit.scenario.load.torque)
    force = linkage.actuator_force(torque=torque, lever_arm=arm.lever_arm)
    circuit.door("joint", force * speed, state="work on the joint")
    circuit.audit.stored.append(("motion of the joint", 0.5 * felt.mass * speed * speed))
    angle = plant.joint_angle(position)
    system.signal("joint_angle", "joint angle", SCENARIOS["shaft_angle_value"], angle)
    system.signal("joint_torque", "torque on the joint", SCENARIOS["torque_value"], torque)
    return plant.mass + felt.mass, force + felt.velocity_factor * speed * speed
