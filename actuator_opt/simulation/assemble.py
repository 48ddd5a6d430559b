"""A scenario around a plant as a system of equations."""

from __future__ import annotations

from math import pi

from ..base.errors import Diagnostic, InputError
from ..base.quantities import INPUTS, SCENARIOS
from ..base.symbolic import Expression, Symbol
from ..design.kinds import position_at
from ..design.scenario.kinds import Records
from ..design.scenario.model import HeldPorts, Scenario
from ..models import linkage
from ..models.loop import ControllerGains
from ..models.stiffness import holding_pressures
from ..studies.plant import Plant
from .components import chambers, circuit, motion, valve
from .components.circuit import LOOPS, Circuit, InitialState, loop_of
from .components.supply import SupplyBuilder
from .components.valve import Feedback, command, inner
from .system import System

PRESSURES = INPUTS["pressure"]


def ends_of(scenario: Scenario, plant: Plant) -> str:
    """Kind of end of the lines at the ports."""
    if scenario.ends is not None:
        return scenario.ends
    return "valve" if plant.valve is not None else plant.design.ports.end


def start_of(scenario: Scenario, plant: Plant, records: Records) -> InitialState:
    """Position and pressures at the start: a load held by a closed valve."""
    stated, turned, load = scenario.initial, scenario.motor, scenario.load
    place = None if stated.position is None else position_at(stated.position, plant.stroke)
    position = 0.5 * plant.stroke if place is None else float(place)
    areas = plant.area_a, plant.area_b
    if turned is not None:  # volume per radian and torque, in place of area and force
        areas = 2 * (turned.machine.setting * turned.machine.displacement / (2 * pi),)
        force = circuit.at_start(turned.torque, records)
    else:
        force = circuit.at_start(load.force, records)
        force -= 0.0 if load.cylinder is None else load.cylinder.force
        joint = plant.joint(position)
        if joint is not None:
            torque = circuit.at_start(load.torque, records)
            force += float(linkage.actuator_force(torque=torque, lever_arm=joint[0].lever_arm))
    held = holding_pressures(
        force=force,
        supply_pressure=plant.supply_pressure,
        return_pressure=plant.return_pressure,
        area_a=areas[0],
        area_b=areas[1],
    )
    return InitialState(
        position,
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
) -> Circuit:
    """Assemble the equations of a scenario.

    Parameters
    ----------
    scenario, plant : what happens, and the actuator
    records : columns of the files that signals name
    gains : of the controller, None without one
    linear : open the loop at a free variable ``u``, without sticking friction
    """
    circuit = Circuit(
        scenario=scenario,
        plant=plant,
        records=records,
        start=start_of(scenario, plant, records),
        gains=gains,
        loop=loop_of(scenario.control),
        linear=linear,
    )
    if scenario.held_ports is not None:
        _valve_bench(circuit, scenario.held_ports)
    elif scenario.motor is not None:
        _motor(circuit)
    else:
        _cylinder(circuit)
    return circuit


def _command(circuit: Circuit, measured: Feedback) -> Expression:
    """Signal to the valve: free, prescribed over time, or from the controller."""
    system, loop, control = circuit.system, circuit.loop, circuit.scenario.control
    circuit.measured = measured.value
    if circuit.linear:
        return inner(circuit, system.graph.variable("u"), measured)
    if loop is None or control is None:
        return circuit.course(circuit.scenario.signal)
    base = circuit.start.position if loop == "position" else 0.0
    wanted = base + circuit.course(getattr(control, loop))
    system.signal("reference", "reference", LOOPS[loop].quantity, wanted)
    system.signal("error", "error of the loop", LOOPS[loop].quantity, wanted - measured.value)
    return command(circuit, wanted, measured, LOOPS[loop].typical)


def _driven(
    circuit: Circuit, wish: Expression, pressures: tuple[Expression, Expression]
) -> valve.Port:
    """The valve with its supply, between two far ends."""
    data = circuit.plant.valve
    if data is None:
        message = "the design has no valve"
        raise InputError(Diagnostic(message, 'add a block "valve" to the design', path="valve"))
    source = SupplyBuilder.of(circuit)
    circuit.centre = data.offset
    flows = valve.edges(
        circuit,
        data,
        opening=valve.spool(circuit, data, wish),
        supply_pressure=source.pressure,
        return_pressure=circuit.plant.return_pressure,
        pressure_a=pressures[0],
        pressure_b=pressures[1],
    )
    source.feed(flows.supply, flows.tank)
    return flows


def _valve_bench(circuit: Circuit, held: HeldPorts) -> None:
    wish = circuit.course(circuit.scenario.signal)
    flows = _driven(circuit, wish, (held.pressure_a, held.pressure_b))
    work = held.pressure_a * flows.into_a + held.pressure_b * flows.into_b
    circuit.door("held ports", work, state="work on the bench")


def _motor(circuit: Circuit) -> None:
    system, begin = circuit.system, circuit.start
    a = system.pressure("pressure a", begin.pressure_a)
    b = system.pressure("pressure b", begin.pressure_b)
    shaft = chambers.shaft(system)
    value = shaft.angle if circuit.loop == "shaft_angle" else shaft.speed
    across = begin.pressure_a - begin.pressure_b
    wish = _command(circuit, Feedback(value, shaft.speed, a - b, across))
    flows = _driven(circuit, wish, (a, b))
    chambers.turn(
        circuit,
        shaft,
        pressure_a=a,
        pressure_b=b,
        inflow_a=flows.into_a,
        inflow_b=flows.into_b,
    )
    _pressures(system, a, b, "pipe")


def _pressures(system: System, a: Expression, b: Expression, where: str = "chamber") -> None:
    system.signal("pressure_a", f"pressure in {where} A", PRESSURES, a)
    system.signal("pressure_b", f"pressure in {where} B", PRESSURES, b)


def _cylinder(circuit: Circuit) -> None:
    system, plant, begin = circuit.system, circuit.plant, circuit.start
    scenario = circuit.scenario
    ends = ends_of(scenario, plant)
    position = system.state("position", begin.position, tolerance=motion.POSITION)
    speed = system.state("speed", scenario.initial.speed, tolerance=motion.SPEED)
    a = chambers.side(circuit, "a", ends, begin.pressure_a)
    b = chambers.side(circuit, "b", ends, begin.pressure_b)
    feed: tuple[Expression, Expression] = (0.0, 0.0)
    if ends == "valve":
        ratio = plant.area_b / plant.area_a
        measured = Feedback(
            speed if circuit.loop == "speed" else position,
            speed,
            a.pressure - ratio * b.pressure,
            begin.pressure_a - ratio * begin.pressure_b,
        )
        flows = _driven(circuit, _command(circuit, measured), (a.end, b.end))
        feed = flows.into_a, flows.into_b
    into_a = chambers.connect(circuit, a, ends, feed[0], held=begin.pressure_a)
    into_b = chambers.connect(circuit, b, ends, feed[1], held=begin.pressure_b)
    across = plant.leakage * (a.pressure - b.pressure)
    if plant.leakage:
        lost = across * (a.pressure - b.pressure)
        circuit.door("leakage across the piston", lost, state="leakage loss")
        system.signal("flow_leakage", "leakage across the piston", SCENARIOS["flow_value"], across)
    pressed = _chambers(circuit, (a, b), (into_a - across, into_b + across), position, speed)
    own = motion.law(plant, scenario.friction, begin)
    force = motion.resist(circuit, own, speed=speed, pressure_a=a.pressure, pressure_b=b.pressure)
    bench = scenario.load.cylinder
    motion.move(
        circuit,
        position=position,
        speed=speed,
        pressure_force=pressed,
        friction=force,
        pulled=0.0
        if bench is None
        else chambers.push(circuit, bench, position=position, speed=speed),
    )
    _pressures(system, a.pressure, b.pressure)


def _chambers(
    circuit: Circuit,
    sides: tuple[chambers.ChamberPort, chambers.ChamberPort],
    inflow: tuple[Expression, Expression],
    position: Symbol,
    speed: Symbol,
) -> Expression:
    """Both chambers with their share of the lines; returns the force of their pressures."""
    plant, (a, b) = circuit.plant, sides
    return chambers.cylinder(
        circuit,
        pressure_a=a.pressure,
        pressure_b=b.pressure,
        inflow_a=inflow[0],
        inflow_b=inflow[1],
        position=position,
        speed=speed,
        area_a=plant.area_a,
        area_b=plant.area_b,
        stroke=plant.stroke,
        dead_a=chambers.dead_volume(circuit, plant.dead_a + a.lumped, plant.area_a, "chamber A"),
        dead_b=chambers.dead_volume(circuit, plant.dead_b + b.lumped, plant.area_b, "chamber B"),
        walls=plant.walls._replace(
            a0=plant.walls.a0 + a.lumped_wall, b0=plant.walls.b0 + b.lumped_wall
        ),
        flexibility=plant.flexibility,
    )
