"""Build the system of equations for a scenario and an actuator."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from math import pi

from ..base.errors import Diagnostic, InputError
from ..base.quantities import INPUTS, SCENARIOS
from ..base.symbolic import Expression, Symbol
from ..design.kinds import position_at
from ..design.scenario.kinds import ENDS, Records
from ..design.scenario.model import HeldPorts, Scenario
from ..models import linkage
from ..models.loop import ControllerGains
from ..models.stiffness import holding_pressures
from ..studies.plant import Plant
from .components import chambers, circuit, motion, valve
from .components.circuit import LOOPS, ChamberVolumes, Circuit, InitialState, loop_of
from .components.supply import SupplyBuilder
from .components.valve import Feedback, command, inner
from .duty_cycle import plant_of
from .system import System

PRESSURES = INPUTS["pressure"]


def ends_of(scenario: Scenario, plant: Plant) -> str:
    """Name of the component at the far ends of the lines, such as "valve" or "closed"."""
    if scenario.ends is not None:
        return scenario.ends
    return "valve" if plant.valve is not None else plant.design.ports.end


def start_of(scenario: Scenario, plant: Plant, records: Records) -> InitialState:
    """Initial position and pressures.

    By default, the pressures are those at which a closed valve holds the load.
    """
    initial, motor_load, load = scenario.initial, scenario.motor, scenario.load
    place = None if initial.position is None else position_at(initial.position, plant.stroke)
    position = 0.5 * plant.stroke if place is None else float(place)
    areas = plant.area_a, plant.area_b
    # The motor's volume per radian and its torque take the place of area and force.
    if motor_load is not None:
        areas = 2 * (motor_load.machine.setting * motor_load.machine.displacement / (2 * pi),)
        force = circuit.at_start(motor_load.torque, records)
    else:
        force = circuit.at_start(load.force, records)
        force -= 0.0 if load.cylinder is None else load.cylinder.force
        joint = plant.joint(position)
        if joint is not None:
            torque = circuit.at_start(load.torque, records)
            force += float(linkage.actuator_force(torque=torque, lever_arm=joint[0].lever_arm))
    pressures = holding_pressures(
        force=force,
        supply_pressure=plant.supply_pressure,
        return_pressure=plant.return_pressure,
        area_a=areas[0],
        area_b=areas[1],
    )
    return InitialState(
        position,
        float(pressures[0]) if initial.pressure_a is None else initial.pressure_a,
        float(pressures[1]) if initial.pressure_b is None else initial.pressure_b,
    )


def assemble(
    scenario: Scenario,
    plant: Plant,
    records: Records,
    gains: ControllerGains | None,
    *,
    linear: bool = False,
    free: Collection[str] = (),
) -> Circuit:
    """Assemble the equations of a scenario.

    Parameters
    ----------
    scenario, plant : inputs over time, and the actuator
    records : columns of the files that the scenario's signals name
    gains : controller gains; None without a controller
    linear : replace the valve signal by a free variable ``u``, which opens the control loop, and
        omit sticking friction
    free : names of values that become variables; `Circuit.freed` has those that the circuit uses
    """
    plant = plant_of(scenario, plant)
    circuit = Circuit(
        scenario=scenario,
        plant=plant,
        records=records,
        start=start_of(scenario, plant, records),
        gains=gains,
        loop=loop_of(scenario.control),
        linear=linear,
        free=free,
    )
    if scenario.held_ports is not None:
        _valve_bench(circuit, scenario.held_ports)
    elif scenario.motor is not None:
        _motor(circuit)
    else:
        _cylinder(circuit)
    return circuit


def _command(circuit: Circuit, measured: Feedback) -> Expression:
    """Signal to the valve: a free variable, a given function of time, or the controller output."""
    system, loop, control = circuit.system, circuit.loop, circuit.scenario.control
    circuit.measured = measured.value
    if circuit.linear:
        return inner(circuit, system.graph.variable("u"), measured)
    if loop is None or control is None:
        return circuit.value("signal", circuit.scenario_signal(circuit.scenario.signal))
    base = circuit.begin.position if loop == "position" else 0.0
    reference = base + circuit.scenario_signal(getattr(control, loop))
    reference = circuit.value("reference", reference)
    system.signal("reference", "reference", LOOPS[loop].quantity, reference)
    system.signal("error", "error of the loop", LOOPS[loop].quantity, reference - measured.value)
    return command(circuit, reference, measured, LOOPS[loop].typical)


def _driven(
    circuit: Circuit, valve_signal: Expression, pressures: tuple[Expression, Expression]
) -> valve.Port:
    """Add valve and supply; return the flows of the valve for the given pressures at its ports."""
    data = circuit.plant.valve
    if data is None:
        message = "the design has no valve"
        raise InputError(Diagnostic(message, 'add a block "valve" to the design', path="valve"))
    source = SupplyBuilder.of(circuit)
    circuit.centre, circuit.driven = data.offset, True
    flows = valve.edges(
        circuit,
        data,
        opening=valve.spool(circuit, data, valve_signal),
        supply_pressure=source.pressure,
        return_pressure=circuit.return_pressure,
        pressure_a=pressures[0],
        pressure_b=pressures[1],
    )
    source.feed(flows.supply, flows.tank)
    return flows


def _valve_bench(circuit: Circuit, ports: HeldPorts) -> None:
    valve_signal = circuit.value("signal", circuit.scenario_signal(circuit.scenario.signal))
    flows = _driven(circuit, valve_signal, (ports.pressure_a, ports.pressure_b))
    work = ports.pressure_a * flows.into_a + ports.pressure_b * flows.into_b
    circuit.energy_port("held ports", work, state="work on the bench")


def _motor(circuit: Circuit) -> None:
    system, start = circuit.system, circuit.begin
    a = system.pressure("pressure a", start.pressure_a)
    b = system.pressure("pressure b", start.pressure_b)
    shaft = chambers.shaft(system)
    value = shaft.angle if circuit.loop == "shaft_angle" else shaft.speed
    difference = start.pressure_a - start.pressure_b
    valve_signal = _command(circuit, Feedback(value, shaft.speed, a - b, difference))
    flows = _driven(circuit, valve_signal, (a, b))
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
    system, plant, scenario = circuit.system, circuit.plant, circuit.scenario
    ends = ends_of(scenario, plant)
    position = system.state("position", circuit.begin.position, tolerance=motion.POSITION)
    start = circuit.start if ENDS[ends].holds else circuit.begin  # held pressures are no states
    initial_speed = circuit.value("initial.speed", scenario.initial.speed)
    speed = system.state("speed", initial_speed, tolerance=motion.SPEED)
    a = chambers.side(circuit, "a", ends, start.pressure_a)
    b = chambers.side(circuit, "b", ends, start.pressure_b)
    valve_flow: tuple[Expression, Expression] = (0.0, 0.0)
    if ends == "valve":
        ratio = plant.area_b / plant.area_a
        measured = Feedback(
            speed if circuit.loop == "speed" else position,
            speed,
            a.pressure - ratio * b.pressure,
            start.pressure_a - ratio * start.pressure_b,
        )
        flows = _driven(circuit, _command(circuit, measured), (a.end, b.end))
        valve_flow = flows.into_a, flows.into_b
    into_a = chambers.connect(circuit, a, ends, valve_flow[0], end_pressure=start.pressure_a)
    into_b = chambers.connect(circuit, b, ends, valve_flow[1], end_pressure=start.pressure_b)
    leakage = plant.leakage * (a.pressure - b.pressure)
    if plant.leakage:
        loss = leakage * (a.pressure - b.pressure)
        circuit.energy_port("leakage across the piston", loss, state="leakage loss")
        system.signal("flow_leakage", "leakage across the piston", SCENARIOS["flow_value"], leakage)
    pressure_force = _chambers(
        circuit, (a, b), (into_a - leakage, into_b + leakage), position, speed
    )
    circuit.friction = curve = motion.law(plant, scenario.friction, circuit.start)
    curve = replace(curve, viscous=circuit.value("friction.viscous", curve.viscous))
    friction = motion.resist(
        circuit, curve, speed=speed, pressure_a=a.pressure, pressure_b=b.pressure
    )
    load_cylinder = scenario.load.cylinder
    motion.move(
        circuit,
        position=position,
        speed=speed,
        pressure_force=pressure_force,
        friction=friction,
        load_cylinder_force=0.0
        if load_cylinder is None
        else chambers.push(circuit, load_cylinder, position=position, speed=speed),
    )
    _pressures(system, a.pressure, b.pressure)


def _chambers(
    circuit: Circuit,
    sides: tuple[chambers.ChamberPort, chambers.ChamberPort],
    inflow: tuple[Expression, Expression],
    position: Symbol,
    speed: Symbol,
) -> Expression:
    """Add both chambers, each including the line volume that is lumped into it.

    Return the pressure force.
    """
    plant, (a, b) = circuit.plant, sides
    circuit.volumes = volumes = ChamberVolumes(
        chambers.dead_volume(circuit, plant.dead_a + a.lumped, plant.area_a, "chamber A"),
        chambers.dead_volume(circuit, plant.dead_b + b.lumped, plant.area_b, "chamber B"),
        plant.walls._replace(a0=plant.walls.a0 + a.lumped_wall, b0=plant.walls.b0 + b.lumped_wall),
    )
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
        **volumes._asdict(),
        flexibility=plant.flexibility,
    )
