"""A scenario around a plant as a system of equations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import pi
from typing import Literal

from ..design.kinds import position_at
from ..design.scenario.model import Control, Scenario
from ..design.scenario.signals import Part
from ..errors import Diagnostic, InputError
from ..evaluation.study.plant import Plant
from ..models.stiffness import holding_pressures
from ..models.tuning import ControllerGains
from ..quantities import INPUTS, SCENARIOS, Quantity
from ..symbolic import Expression, Symbol
from .parts import chambers, friction, load_cylinder, motion, motor, ports, signals, valve
from .parts.chambers import Audit
from .parts.control import Measured, command, inner
from .parts.signals import Records
from .parts.supply import Source
from .system import System

Loop = Literal["position", "speed", "shaft_speed", "shaft_angle"]
LOOPS: tuple[Loop, ...] = ("position", "speed", "shaft_speed", "shaft_angle")
QUANTITIES: dict[Loop, Quantity] = {
    "position": INPUTS["position"],
    "speed": SCENARIOS["speed_value"],
    "shaft_speed": SCENARIOS["shaft_speed_value"],
    "shaft_angle": SCENARIOS["shaft_angle_value"],
}
TYPICAL: dict[Loop, float] = {
    "position": 1e-2, "speed": 0.1, "shaft_speed": 10.0, "shaft_angle": 1.0,
}  # fmt: skip
"""A typical error of each loop, for tolerances (SI)."""
LEAST_DEAD = 0.5e-3
"""Least dead volume of a chamber over its area [m] (a choice): none would have no compliance."""
PRESSURES = INPUTS["pressure"]


@dataclass(frozen=True, slots=True)
class Start:
    """Where a run begins."""

    position: float
    pressure_a: float
    pressure_b: float


@dataclass(slots=True)
class Circuit:
    """A system with what its balance and its results are read from."""

    system: System
    audit: Audit
    start: Start
    loop: Loop | None = None
    measured: Expression = 0.0
    centre: float = 0.0
    """Signal that centres the spool [V]."""
    notes: list[str] = field(default_factory=list)


def loop_of(control: Control | None) -> Loop | None:
    """Which reference closes the loop."""
    if control is None:
        return None
    return next((name for name in LOOPS if getattr(control, name)), None)


def ends_of(scenario: Scenario, plant: Plant) -> str:
    """What the ports lead to."""
    if scenario.ends is not None:
        return scenario.ends
    return "valve" if plant.valve is not None else plant.design.ports.end


def start_of(scenario: Scenario, plant: Plant) -> Start:
    """Position and pressures of the start: the load held by a valve that has closed."""
    stated = scenario.initial
    place = None if stated.position is None else position_at(stated.position, plant.stroke)
    turned, areas = scenario.motor, (plant.area_a, plant.area_b)
    parts: Sequence[Part] = scenario.load.force
    if turned is not None:  # volume per radian and torque, as area and force
        parts = turned.torque
        areas = 2 * (turned.machine.setting * turned.machine.displacement / (2 * pi),)
    held = holding_pressures(
        force=sum(
            getattr(part, "value", None) or 0.0
            for part in parts
            if part.shape == "constant" or (part.shape == "step" and part.start <= 0)
        ),
        supply_pressure=plant.supply_pressure,
        return_pressure=plant.return_pressure,
        area_a=areas[0],
        area_b=areas[1],
    )
    return Start(
        0.5 * plant.stroke if place is None else float(place),
        float(held[0]) if stated.pressure_a is None else stated.pressure_a,
        float(held[1]) if stated.pressure_b is None else stated.pressure_b,
    )


def assemble(
    scenario: Scenario,
    plant: Plant,
    records: Records,
    gains: ControllerGains | None,
    *,
    linear: bool = False,
    start: Start | None = None,
) -> Circuit:
    """The equations of a scenario.

    Parameters
    ----------
    scenario, plant : what happens, to what
    records : columns of the files that signals name
    gains : of the controller, None where there is none
    linear : leave the controller open at a free variable ``u``, and sticking friction out
    start : where it begins; default: as the scenario says
    """
    system = System()
    audit = Audit([], [], [])
    begin = start_of(scenario, plant) if start is None else start
    power = plant.supply_pressure * 1e-4
    circuit = Circuit(system, audit, begin, loop_of(scenario.control))
    if scenario.held_ports is not None:
        _valve_bench(circuit, scenario, plant, records, power)
    elif scenario.motor is not None:
        _motor(circuit, scenario, plant, records, gains, linear, power)
    else:
        _cylinder(circuit, scenario, plant, records, gains, linear, power)
    return circuit


def _command(
    circuit: Circuit,
    scenario: Scenario,
    plant: Plant,
    records: Records,
    gains: ControllerGains | None,
    measured: Measured,
    linear: bool,
) -> Expression:
    """Signal to the valve: free, stated over time, or the controller's."""
    system, loop = circuit.system, circuit.loop
    circuit.measured = measured.value
    if linear:
        free = system.graph.variable("u")
        return free if scenario.control is None else inner(system, scenario.control, free, measured)
    if loop is None or scenario.control is None:
        return signals.signal(system, scenario.signal, records)
    assert gains is not None
    assert plant.valve is not None
    base = circuit.start.position if loop == "position" else 0.0
    wanted = base + signals.signal(system, getattr(scenario.control, loop), records)
    system.signal("reference", "reference", QUANTITIES[loop], wanted)
    system.signal("error", "error of the loop", QUANTITIES[loop], wanted - measured.value)
    return command(
        system,
        scenario.control,
        gains,
        reference=wanted,
        measured=measured,
        full_signal=plant.valve.signal,
        scale=TYPICAL[loop],
    )


def _driven(
    circuit: Circuit,
    scenario: Scenario,
    plant: Plant,
    wish: Expression,
    pressures: tuple[Expression, Expression],
    power: float,
) -> valve.Port:
    """Valve with its supply between two far ends."""
    if plant.valve is None:
        message = "the design has no valve"
        raise InputError(Diagnostic(message, 'add a block "valve" to the design', path="valve"))
    system, audit = circuit.system, circuit.audit
    source = Source.of(system, audit, plant, scenario)
    circuit.centre = plant.valve.offset
    opening = valve.spool(system, plant.valve, wish)
    flows = valve.edges(
        system,
        audit,
        plant.valve,
        opening=opening,
        supply_pressure=source.pressure,
        return_pressure=plant.return_pressure,
        pressure_a=pressures[0],
        pressure_b=pressures[1],
        power=power,
    )
    source.feed(flows.supply, flows.tank, power)
    return flows


def _valve_bench(
    circuit: Circuit, scenario: Scenario, plant: Plant, records: Records, power: float
) -> None:
    held = scenario.held_ports
    assert held is not None
    system = circuit.system
    wish = signals.signal(system, scenario.signal, records)
    pressures = (held.pressure_a, held.pressure_b)
    flows = _driven(circuit, scenario, plant, wish, pressures, power)
    work = held.pressure_a * flows.into_a + held.pressure_b * flows.into_b
    done = system.integral("work on the bench", work, scale=power)
    circuit.audit.flows.append(("held ports", done, False))


def _motor(
    circuit: Circuit,
    scenario: Scenario,
    plant: Plant,
    records: Records,
    gains: ControllerGains | None,
    linear: bool,
    power: float,
) -> None:
    assert scenario.motor is not None
    system, audit, begin = circuit.system, circuit.audit, circuit.start
    a, b = (
        system.pressure(f"pressure {name}", value)
        for name, value in (("a", begin.pressure_a), ("b", begin.pressure_b))
    )
    shaft = motor.shaft(system)
    measured = Measured(
        shaft.angle if circuit.loop == "shaft_angle" else shaft.speed, shaft.speed, a - b
    )
    wish = _command(circuit, scenario, plant, records, gains, measured, linear)
    flows = _driven(circuit, scenario, plant, wish, (a, b), power)
    motor.turn(
        system,
        audit,
        plant,
        scenario.motor,
        records,
        shaft,
        pressure_a=a,
        pressure_b=b,
        inflow_a=flows.into_a,
        inflow_b=flows.into_b,
        smooth=linear,
        power=power,
    )
    _pressures(system, a, b)


def _pressures(system: System, a: Expression, b: Expression) -> None:
    system.signal("pressure_a", "pressure in chamber A", PRESSURES, a)
    system.signal("pressure_b", "pressure in chamber B", PRESSURES, b)


def _cylinder(
    circuit: Circuit,
    scenario: Scenario,
    plant: Plant,
    records: Records,
    gains: ControllerGains | None,
    linear: bool,
    power: float,
) -> None:
    system, audit, begin = circuit.system, circuit.audit, circuit.start
    ends = ends_of(scenario, plant)
    position = system.state("position", begin.position, tolerance=motion.POSITION)
    speed = system.state("speed", scenario.initial.speed, tolerance=motion.SPEED)
    sides = {
        name: ports.side(system, plant, name, ends, value)
        for name, value in (("a", begin.pressure_a), ("b", begin.pressure_b))
    }
    a, b = sides["a"], sides["b"]
    feed: tuple[Expression, Expression] = (0.0, 0.0)
    if ends == "valve":
        load_pressure = a.pressure - (plant.area_b / plant.area_a) * b.pressure
        value = speed if circuit.loop == "speed" else position
        start = begin.pressure_a - (plant.area_b / plant.area_a) * begin.pressure_b
        measured = Measured(value, speed, load_pressure, start)
        wish = _command(circuit, scenario, plant, records, gains, measured, linear)
        flows = _driven(circuit, scenario, plant, wish, (a.end, b.end), power)
        feed = flows.into_a, flows.into_b
    inflow = {
        name: ports.connect(system, audit, plant, side, ends, gives, held=held, power=power)
        for name, side, gives, held in (
            ("a", a, feed[0], begin.pressure_a),
            ("b", b, feed[1], begin.pressure_b),
        )
    }
    across = plant.leakage * (a.pressure - b.pressure)
    if plant.leakage:
        lost = system.integral("leakage loss", across * (a.pressure - b.pressure), scale=power)
        audit.flows.append(("leakage across the piston", lost, False))
        system.signal("flow_leakage", "leakage across the piston", SCENARIOS["flow_value"], across)
    net = inflow["a"] - across, inflow["b"] + across
    pressed = _chambers(circuit, plant, (a, b), net, position, speed, power)
    stated = scenario.friction.model_copy(update={"model": "none"}) if linear else scenario.friction
    own = friction.law(plant, scenario.friction, (begin.pressure_a, begin.pressure_b))
    force = friction.resist(
        system, stated, own, speed=speed, pressure_a=a.pressure, pressure_b=b.pressure
    )
    outside: Expression = 0.0
    if scenario.load.cylinder is not None:
        outside = load_cylinder.push(
            system,
            audit,
            plant,
            scenario.load.cylinder,
            records,
            position=position,
            start=begin.position,
            speed=speed,
            power=power,
        )
    motion.move(
        system,
        audit,
        plant,
        scenario,
        records,
        position=position,
        speed=speed,
        pressure_force=pressed,
        friction=force,
        pulled=outside,
        power=power,
    )
    _pressures(system, a.pressure, b.pressure)


def _chambers(
    circuit: Circuit,
    plant: Plant,
    sides: tuple[ports.Side, ports.Side],
    inflow: tuple[Expression, Expression],
    position: Symbol,
    speed: Symbol,
    power: float,
) -> Expression:
    """Both chambers with what of their lines counts to them; the force of their pressures."""
    a, b = sides
    found = chambers.cylinder(
        circuit.system,
        circuit.audit,
        plant.oil,
        pressure_a=a.pressure,
        pressure_b=b.pressure,
        inflow_a=inflow[0],
        inflow_b=inflow[1],
        position=position,
        speed=speed,
        area_a=plant.area_a,
        area_b=plant.area_b,
        stroke=plant.stroke,
        dead_a=_dead(circuit, plant.dead_a + a.lumped, plant.area_a, "A"),
        dead_b=_dead(circuit, plant.dead_b + b.lumped, plant.area_b, "B"),
        walls=plant.walls._replace(
            a0=plant.walls.a0 + a.lumped_wall, b0=plant.walls.b0 + b.lumped_wall
        ),
        flexibility=plant.flexibility,
        power=power,
    )
    return found.force


def _dead(circuit: Circuit, volume: float, area: float, word: str) -> float:
    """Dead volume of a chamber, not less than a film's."""
    least = LEAST_DEAD * area
    if volume >= least:
        return volume
    circuit.system.notes.append(
        f"chamber {word}: dead volume taken as {least * 1e6:.2g} ml, 0.5 mm of its area"
    )
    return least
