"""Motion of the rod: mass, end stops, cushions, load, joint, external machine, seal friction.

Seal friction is modelled in one of three ways: by the LuGre law, by a smooth Stribeck curve, or as
viscous only.
"""

from __future__ import annotations

from ...base.kinds import per_kind
from ...base.numeric import maximum, where
from ...base.quantities import INPUTS, SCENARIOS
from ...base.symbolic import Expression, Symbol
from ...design.scenario.kinds import FRICTIONS
from ...design.scenario.model import Drive, ScenarioFriction as Stated
from ...models import end_stop, friction, linkage, lugre
from ...studies.plant import Plane, Plant
from .circuit import Circuit, FrictionCurve, InitialState, rate

POSITION = 1e-10
SPEED = 1e-9
"""Error tolerances of position [m] and speed [m/s]."""
_FORCE = SCENARIOS["force_value"]


def stops(circuit: Circuit, position: Symbol, speed: Symbol) -> Expression:
    """Force of the end stops. It jumps at contact, so the time of contact is computed exactly."""
    system, plant = circuit.system, circuit.plant
    stiffness, damping = stop_law(circuit)
    law = {"stiffness": stiffness, "damping": damping}
    at_cap = system.switch("stop at the cap end", -position)
    at_rod = system.switch("stop at the rod end", position - plant.stroke)
    cap = end_stop.contact_force(compression=-position, closing_speed=-speed, **law)
    rod = end_stop.contact_force(compression=position - plant.stroke, closing_speed=speed, **law)
    return where(at_cap, cap, 0.0) - where(at_rod, rod, 0.0)


def stop_law(circuit: Circuit) -> tuple[float, float]:
    """Stiffness [N/m] and damping [N s/m] of a stop."""
    plant = circuit.plant
    damping = end_stop.stop_damping(
        stiffness=plant.stop_stiffness,
        mass=plant.moving_mass(circuit.start.position),
        factor=circuit.scenario.stops.damping,
    )
    return plant.stop_stiffness, float(damping)


def cushions(circuit: Circuit, position: Symbol, speed: Symbol) -> Expression:
    """Force on the piston from the oil that a cushion spear throttles.

    The cushion pressure acts on the whole area of the chamber.
    """
    plant, cushion = circuit.plant, circuit.cushion
    if cushion is None:
        return 0.0
    total: Expression = 0.0
    ends = (
        ("cap", position, -speed, plant.area_a, 1.0),
        ("rod", plant.stroke - position, speed, plant.area_b, -1.0),
    )
    for name, remaining, closing_speed, area, sign in ends:
        if cushion.ends not in ("both", name):
            continue
        opening = end_stop.cushion_flow_area(
            remaining=remaining,
            length=cushion.length,
            open_area=cushion.open_area,
            end_area=cushion.end_area,
            exponent=cushion.exponent,
        )
        pressure = end_stop.cushion_pressure(
            speed=closing_speed,
            area=area,
            flow_area=opening,
            density=plant.oil.density,
            dynamic_viscosity=plant.oil.dynamic_viscosity,
        )
        total = total + sign * where(remaining < cushion.length, pressure * area, 0.0)
    return total


def _machine(circuit: Circuit, drive: Drive, position: Expression, speed: Expression) -> Expression:
    """Force of an external machine that moves the rod through a spring and a damper [N]."""
    system = circuit.system
    wanted = circuit.scenario_signal(drive.position) + circuit.begin.position
    system.signal("drive_position", "position of the external machine", INPUTS["position"], wanted)
    force = drive.stiffness * (wanted - position)
    return force + drive.damping * (rate(system, wanted) - speed)


def move(
    circuit: Circuit,
    *,
    position: Symbol,
    speed: Symbol,
    pressure_force: Expression,
    friction: Expression,
    load_cylinder_force: Expression = 0.0,
) -> None:
    """Add the motion of the piston and its energy flows.

    Mass times acceleration equals the pressure force, minus seal friction and oil shear, plus the
    forces of end stops and cushions, minus the force of the load. Load cylinder, external machine
    and joint add their forces if the scenario or the design has them.
    """
    system, plant, load = circuit.system, circuit.plant, circuit.scenario.load

    def work_on(name: str, force: Expression) -> None:
        circuit.energy_port(name, force * speed, state=f"work on {name}")

    shear = plant.oil_damping * speed
    stop_force = stops(circuit, position, speed)
    cushion_force = cushions(circuit, position, speed)
    start = circuit.begin.position
    force = circuit.value("load.force", circuit.scenario_signal(load.force))
    stiffness = circuit.value("load.stiffness", load.stiffness)
    damping = circuit.value("load.damping", load.damping)
    load_force = force + stiffness * (position - start) + damping * speed
    total = pressure_force - friction - shear + stop_force + cushion_force
    total = total - load_force + load_cylinder_force
    stated_mass = float(plant.design.load.mass)
    mass = plant.mass + (circuit.value("load.mass", stated_mass) - stated_mass)
    circuit.audit.stored.append(("motion", 0.5 * plant.mass * speed * speed))
    work_on("friction of the seals", friction)
    if plant.oil_damping:
        work_on("shear of the oil", shear)
    work_on("stops", -stop_force)
    if circuit.cushion is not None:
        work_on("cushions", -cushion_force)
        system.signal("cushion_force", "force of the cushions", _FORCE, cushion_force)
    work_on("load", load_force)
    load_force = load_force - load_cylinder_force
    if load.drive is not None:
        drive_force = _machine(circuit, load.drive, position, speed)
        total, load_force = total + drive_force, load_force - drive_force
        work_on("machine outside", -drive_force)
    if plant.design.linkage is not None:
        joint_mass, joint_force = _joint(circuit, position, speed)
        mass = mass + joint_mass
        total, load_force = total - joint_force, load_force + joint_force
    system.rate(position, speed)
    system.rate(speed, total / mass)
    for name, words, quantity, value in (
        ("position", "position of the piston", INPUTS["position"], position),
        ("speed", "speed of the piston", SCENARIOS["speed_value"], speed),
        ("load_force", "force of the load", _FORCE, load_force),
        ("friction", "friction of the seals", _FORCE, friction),
        ("stop_force", "force of the end stops", _FORCE, stop_force),
        ("pressure_force", "force of the pressures", _FORCE, pressure_force),
    ):
        system.signal(name, words, quantity, value)


def _joint(circuit: Circuit, position: Symbol, speed: Symbol) -> tuple[Expression, Expression]:
    """Reflected mass of the joint's inertia, and the force due to its torque and motion [N]."""
    system, plant = circuit.system, circuit.plant
    joint = plant.joint(position)
    assert joint is not None
    arm, inertia = joint
    torque = circuit.scenario_signal(circuit.scenario.load.torque)
    torque = circuit.value("load.torque", torque)
    force = linkage.actuator_force(torque=torque, lever_arm=arm.lever_arm)
    circuit.energy_port("joint", force * speed, state="work on the joint")
    circuit.audit.stored.append(("motion of the joint", 0.5 * inertia.mass * speed * speed))
    angle = plant.joint_angle(position)
    system.signal("joint_angle", "joint angle", SCENARIOS["shaft_angle_value"], angle)
    system.signal("joint_torque", "torque on the joint", SCENARIOS["torque_value"], torque)
    return inertia.mass, force + inertia.velocity_factor * speed * speed


LEAST = 1e-3
"""Smallest friction force [N]; the bristles of the LuGre law need a positive force."""


SMOOTHING = 0.05
"""Width of the smooth change of sign at zero speed, relative to the Stribeck speed (our choice)."""


TAPER = 0.5
"""Speed at which the bristle damping has fallen to 1/e, divided by the passive speed (our choice:
the largest that keeps `lugre_tapered_damping` passive)."""


TAPERED = 0.05
"""Largest relative fall of the bristle damping that no note reports (our choice)."""


LONE_SPEED = 1e-3
"""Stribeck speed assumed if the scenario states friction, but no Stribeck speed [m/s]."""


def law(plant: Plant, stated: Stated, start: InitialState) -> FrictionCurve:
    """Friction that the scenario states or, if it states none, that of the design.

    The bristle stiffness is computed at the initial pressures.
    """
    seals = plant.seals
    coulomb, static = seals.coulomb, seals.static
    speed = seals.stribeck_speed
    viscous = seals.viscous
    if stated.coulomb is not None:
        coulomb = Plane(stated.coulomb)
        static = Plane(stated.coulomb if stated.static is None else stated.static)
        speed = stated.stribeck_speed or LONE_SPEED
        viscous = 0.0
    if stated.model == "none":
        viscous = 0.0
    if stated.viscous is not None:
        viscous = stated.viscous
    level, breakaway = _levels_at(coulomb, static, start)
    travel = stated.bristle_travel or seals.bristle_travel
    stiffness = float(lugre.lugre_bristle_stiffness(static=breakaway, largest_deflection=travel))
    damping = stated.bristle_damping
    if damping is None:
        damping = float(
            lugre.lugre_bristle_damping(
                bristle_stiffness=stiffness, mass=plant.moving_mass(start.position)
            )
        )
    passive = lugre.lugre_passive_speed(
        level=level, bristle_damping=max(damping, 1e-9), viscous=viscous
    )
    tapered = stated.bristle_taper
    if tapered is None:
        tapered = stated.bristle_damping is None
    return FrictionCurve(
        coulomb,
        static,
        speed,
        stated.exponent,
        viscous,
        stiffness,
        damping,
        float(passive),
        TAPER * float(passive) if tapered else None,
    )


def levels_at(curve: FrictionCurve, start: InitialState) -> tuple[float, float]:
    """Coulomb and breakaway friction at the initial pressures [N]."""
    return _levels_at(curve.coulomb, curve.static, start)


def _levels_at(coulomb: Plane, static: Plane, start: InitialState) -> tuple[float, float]:
    level = max(float(coulomb.at(start.pressure_a, start.pressure_b)), LEAST)
    return level, max(float(static.at(start.pressure_a, start.pressure_b)), level)


def resist(
    circuit: Circuit,
    curve: FrictionCurve,
    *,
    speed: Expression,
    pressure_a: Expression,
    pressure_b: Expression,
) -> Expression:
    """Friction force on the piston [N], positive if the speed is positive."""
    if circuit.linear:
        return _viscous(circuit, curve, speed, pressure_a, pressure_b)
    return FORCES[circuit.scenario.friction.model](circuit, curve, speed, pressure_a, pressure_b)


def _levels(
    curve: FrictionCurve, pressure_a: Expression, pressure_b: Expression
) -> tuple[Expression, Expression]:
    """Coulomb and static friction at the chamber pressures."""
    coulomb = maximum(curve.coulomb.at(pressure_a, pressure_b), LEAST)
    if curve.static is curve.coulomb:
        return coulomb, coulomb
    return coulomb, maximum(curve.static.at(pressure_a, pressure_b), coulomb)


def _viscous(
    circuit: Circuit,
    curve: FrictionCurve,
    speed: Expression,
    pressure_a: Expression,
    pressure_b: Expression,
) -> Expression:
    return curve.viscous * speed


def _stribeck(
    circuit: Circuit,
    curve: FrictionCurve,
    speed: Expression,
    pressure_a: Expression,
    pressure_b: Expression,
) -> Expression:
    coulomb, static = _levels(curve, pressure_a, pressure_b)
    return friction.stribeck(
        speed=speed,
        coulomb=coulomb,
        static=static,
        stribeck_speed=curve.stribeck_speed,
        exponent=curve.exponent,
        viscous=curve.viscous,
        smoothing_speed=SMOOTHING * curve.stribeck_speed,
    )


def _lugre(
    circuit: Circuit,
    curve: FrictionCurve,
    speed: Expression,
    pressure_a: Expression,
    pressure_b: Expression,
) -> Expression:
    system = circuit.system
    coulomb, static = _levels(curve, pressure_a, pressure_b)
    level = friction.stribeck_level(
        speed=speed,
        coulomb=coulomb,
        static=static,
        stribeck_speed=curve.stribeck_speed,
        exponent=curve.exponent,
    )
    bristle = system.state("bristles", 0.0, tolerance=1e-10)
    rate = lugre.lugre_rate(
        deflection=bristle, speed=speed, level=level, bristle_stiffness=curve.bristle_stiffness
    )
    system.rate(bristle, rate)
    system.signal("bristles", "deflection of the bristles", SCENARIOS["position_value"], bristle)
    damping: Expression = curve.bristle_damping
    if curve.taper_speed is not None:
        damping = lugre.lugre_tapered_damping(
            bristle_damping=damping, speed=speed, taper_speed=curve.taper_speed
        )
    return lugre.lugre_force(
        deflection=bristle,
        rate=rate,
        speed=speed,
        bristle_stiffness=curve.bristle_stiffness,
        bristle_damping=damping,
        viscous=curve.viscous,
    )


FORCES = per_kind(FRICTIONS, {"lugre": _lugre, "stribeck": _stribeck, "none": _viscous})
"""Function that returns the friction force, for every friction law of the seals."""
