"""Oil volumes, each at a single pressure, and the components connected to them.

Every volume adds its pressure rate, mass and elastic energy. The components are: the hydraulic line
of a chamber, with its one-way valve and its far end; a hydraulic motor between two pipes, by the
Wilson model; and a load cylinder with its own valve, which loads the rod on a test bench.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from ...base.kinds import per_kind
from ...base.numeric import clip, maximum, where
from ...base.quantities import INPUTS, SCENARIOS
from ...base.symbolic import Expression, Namespace, Symbol
from ...design.scenario.kinds import ENDS
from ...design.scenario.model import LoadCylinder
from ...design.structure import child_at, number_of
from ...evaluation.circuit import Chamber
from ...evaluation.springs import Give
from ...models import chamber, forces, one_way_valve, supply, wilson
from ...models.chamber import cavity
from ...models.fluid import ATMOSPHERIC_PRESSURE
from ...studies.plant import Oil, ValveData, valve_data
from ..system import System
from . import valve
from .circuit import Circuit

DEEPEST = -12.0
"""Limit of the piston's travel into an end stop, in units of half the length of the dead volume,
from the position at which half of this volume is left (our choice). At the limit, the oil left is
e^-12 = 6e-6 times that half."""
FLOOR = 1e-6
"""Lower limit of the absolute pressure in the formulas for oil and air [Pa], to guard against
rounding."""
LEAST_DEAD = 0.5e-3
"""Smallest length of a dead volume [m] (our choice). Without any dead volume, a chamber at its end
stop would have no compliance."""


class Volumes(NamedTuple):
    """Properties of the oil in a volume, at the pressure of the volume."""

    ratio: Expression
    modulus: Expression
    energy: Expression


def oil_at(oil: Oil, pressure: Expression) -> Volumes:
    """Density ratio, bulk modulus and energy density at a pressure above vacuum.

    In oil with almost no air, a cavity forms below atmospheric pressure, so that the pressure stays
    above vacuum.
    """
    limited = maximum(pressure, FLOOR - ATMOSPHERIC_PRESSURE)
    mixed = Volumes(
        chamber.density_ratio(pressure=limited, **oil.law),
        chamber.mixture_bulk_modulus(pressure=limited, **oil.law),
        chamber.oil_energy_density(pressure=limited, **oil.law),
    )
    if not oil.cavity:
        return mixed
    opening, falling, work = cavity(
        pressure=limited, content=oil.cavity, polytropic_index=oil.polytropic_index
    )
    filled = (1 + oil.air_content) / mixed.ratio
    total = filled + opening
    return Volumes(
        (1 + oil.air_content) / total,
        total / (filled / mixed.modulus + falling),
        (mixed.energy * filled + work) / total,
    )


def node(
    circuit: Circuit,
    name: str,
    pressure: Symbol,
    *,
    inflow: Expression,
    volume: float,
    wall: float = 0.0,
) -> None:
    """Add an oil volume with elastic walls; the net inflow changes its pressure."""
    law = oil_at(circuit.plant.oil, pressure)
    total_volume = volume + wall * pressure
    circuit.system.rate(
        pressure,
        chamber.pressure_rate(
            flow=inflow,
            volume=total_volume,
            volume_rate=0.0,
            bulk_modulus=law.modulus,
            compliance=wall,
        ),
    )
    _content(circuit, name, law, total_volume, inflow, volume)
    circuit.audit.stored.append((f"walls of {name}", 0.5 * wall * pressure * pressure))


def _content(
    circuit: Circuit,
    name: str,
    law: Volumes,
    volume: Expression,
    inflow: Expression,
    scale: float,
) -> None:
    """Add mass and energy of a volume to the balance.

    Oil that flows in carries its elastic energy into the volume.
    """
    system, audit = circuit.system, circuit.audit
    mass = system.integral(f"inflow of {name}", law.ratio * inflow, scale=1e-3 * scale)
    audit.mass.append((name, law.ratio * volume, mass))
    audit.stored.append((f"oil of {name}", law.energy * volume))
    carried = system.integral(f"carried into {name}", law.energy * inflow, scale=1e4 * scale)
    audit.flows.append(("carried by the oil", carried, True))


def _left(travel: Expression, film: float) -> tuple[Expression, Expression]:
    """Length of the oil column without the dead volume, and its derivative by the travel.

    The length equals the travel, which is negative inside the end stop. Once half the dead volume
    is used up, the piston touches the end over a growing area, so the remaining volume shrinks more
    slowly than the travel.
    """
    half = 0.5 * film
    depth = clip((travel + half) / half, DEEPEST, 0.0)
    in_stop = travel < -half
    length = where(in_stop, half * Namespace.expm1(depth) - half, travel)
    return length, where(in_stop, Namespace.exp(depth), 1.0)


def cylinder(
    circuit: Circuit,
    *,
    pressure_a: Expression,
    pressure_b: Expression,
    inflow_a: Expression,
    inflow_b: Expression,
    position: Expression,
    speed: Expression,
    area_a: float,
    area_b: float,
    stroke: float,
    dead_a: float,
    dead_b: float,
    walls: Give,
    flexibility: float,
    suffix: str = "",
) -> Expression:
    """Add both chambers of a cylinder, coupled by walls and rod; return their force [N].

    The chamber volumes are V_A = A_A x + V_0A + W_AA p_A + W_AB p_B and V_B = A_B (s - x) + V_0B +
    W_BB p_B + W_AB p_A, with the position x, the stroke s, and for each chamber the piston area A,
    the dead volume V_0 and the pressure p. The matrix W(x) is the compliance of the walls, plus f a
    a^T for rod and mount with the flexibility f and the vector a = (A_A, -A_B). The force on the
    piston is a^T p + p^T W' p/2, with W' = dW/dx; its second term follows from the work of the
    walls. A pressure given as a number is prescribed, so that its port supplies the flow for
    volume, walls and leakage. Deep in an end stop, the length from `_left` replaces x.
    """
    oil, beyond = circuit.plant.oil, stroke - position
    w_a = walls.a0 + walls.a1 * position + flexibility * area_a * area_a
    w_b = walls.b0 + walls.b1 * beyond + flexibility * area_b * area_b
    w_ab = walls.c0 + walls.c1 * position - flexibility * area_a * area_b
    (left_a, free_a), (left_b, free_b) = (
        _left(position, dead_a / area_a), _left(beyond, dead_b / area_b),
    )  # fmt: skip
    v_a = area_a * left_a + dead_a + w_a * pressure_a + w_ab * pressure_b
    v_b = area_b * left_b + dead_b + w_b * pressure_b + w_ab * pressure_a
    swept_a = area_a * free_a + walls.a1 * pressure_a + walls.c1 * pressure_b
    swept_b = -area_b * free_b - walls.b1 * pressure_b + walls.c1 * pressure_a
    law_a, law_b = oil_at(oil, pressure_a), oil_at(oil, pressure_b)
    c_a, c_b = v_a / law_a.modulus + w_a, v_b / law_b.modulus + w_b
    net_a, net_b = inflow_a - swept_a * speed, inflow_b - swept_b * speed
    _set_pressures(circuit, (pressure_a, pressure_b), (c_a, c_b), w_ab, (net_a, net_b))
    for name, pressure, law, volume, inflow, scale in (
        ("A", pressure_a, law_a, v_a, inflow_a, area_a * stroke + dead_a),
        ("B", pressure_b, law_b, v_b, inflow_b, area_b * stroke + dead_b),
    ):
        if isinstance(pressure, Symbol):
            _content(circuit, f"chamber {name}{suffix}", law, volume, inflow, scale)
    energy = 0.5 * (
        w_a * pressure_a * pressure_a
        + w_b * pressure_b * pressure_b
        + 2 * w_ab * pressure_a * pressure_b
    )
    circuit.audit.stored.append((f"walls, rod and mount{suffix}", energy))
    wall_force = 0.5 * (
        walls.a1 * pressure_a * pressure_a
        - walls.b1 * pressure_b * pressure_b
        + 2 * walls.c1 * pressure_a * pressure_b
    )
    return area_a * free_a * pressure_a - area_b * free_b * pressure_b + wall_force


def _set_pressures(
    circuit: Circuit,
    pressures: tuple[Expression, Expression],
    capacities: tuple[Expression, Expression],
    coupling: Expression,
    net: tuple[Expression, Expression],
) -> None:
    """Set the rates of two coupled pressures.

    If a pressure is prescribed, its port supplies the flow that keeps it constant.
    """
    (c_a, c_b), (net_a, net_b) = capacities, net
    is_state_a, is_state_b = (isinstance(pressure, Symbol) for pressure in pressures)
    det = c_a * c_b - (coupling * coupling if is_state_a and is_state_b else 0.0)
    rate_a = (c_b * net_a - (coupling * net_b if is_state_b else 0.0)) / det if is_state_a else 0.0
    rate_b = (c_a * net_b - (coupling * net_a if is_state_a else 0.0)) / det if is_state_b else 0.0
    demands = coupling * rate_b - net_a, coupling * rate_a - net_b
    sides = zip("ab", pressures, (rate_a, rate_b), demands, strict=True)
    for name, pressure, rate, demand in sides:
        if isinstance(pressure, Symbol):
            circuit.system.rate(pressure, rate)
        else:
            work = f"held work {name}"
            circuit.energy_port("held ports", pressure * demand, state=work, into=True)


def dead_volume(circuit: Circuit, volume: float, area: float, chamber: str) -> float:
    """Dead volume of a chamber, at least `LEAST_DEAD` times the area."""
    least = LEAST_DEAD * area
    if volume >= least:
        return volume
    circuit.system.notes.append(
        f"{chamber}: the dead volume is too small for the simulation and was set to "
        f"{least * 1e6:.2g} ml, the chamber's area times 0.5 mm"
    )
    return least


PREFIX = "load_"


def push(circuit: Circuit, stated: LoadCylinder, *, position: Symbol, speed: Symbol) -> Expression:
    """Force with which the load cylinder pushes the actuator's rod outwards [N].

    Both rods move together.
    """
    system = circuit.system
    area = float(forces.annulus_area(bore=stated.bore, rod_diameter=stated.rod_diameter))
    middle = 0.5 * (stated.supply_pressure + stated.return_pressure)
    half = 0.5 * stated.force / area
    a = system.pressure(f"{PREFIX}pressure a", middle + half)
    b = system.pressure(f"{PREFIX}pressure b", middle - half)
    data = _data(stated, circuit.plant.oil)
    opening = valve.spool(circuit, data, circuit.scenario_signal(stated.signal), PREFIX)
    flows = valve.edges(
        circuit,
        data,
        opening=opening,
        supply_pressure=stated.supply_pressure,
        return_pressure=stated.return_pressure,
        pressure_a=a,
        pressure_b=b,
        prefix=PREFIX,
    )
    supply_power = stated.supply_pressure * flows.supply - stated.return_pressure * flows.tank
    circuit.energy_port(
        "supply of the load cylinder", supply_power, state=f"{PREFIX}supply work", into=True
    )
    dead = dead_volume(circuit, stated.dead_volume, area, "load cylinder")
    force_on_rod = cylinder(
        circuit,
        pressure_a=a,
        pressure_b=b,
        inflow_a=flows.into_a,
        inflow_b=flows.into_b,
        position=position + (0.5 * stated.stroke - circuit.begin.position),
        speed=speed,
        area_a=area,
        area_b=area,
        stroke=stated.stroke,
        dead_a=dead,
        dead_b=dead,
        walls=Give(),
        flexibility=0.0,
        suffix=" of the load cylinder",
    )
    pressures = INPUTS["pressure"]
    system.signal(f"{PREFIX}pressure_a", "pressure of the load cylinder, side A", pressures, a)
    system.signal(f"{PREFIX}pressure_b", "pressure of the load cylinder, side B", pressures, b)
    force = SCENARIOS["force_value"]
    system.signal("load_cylinder_force", "force of the load cylinder", force, force_on_rod)
    return force_on_rod


def _data(load_cylinder: LoadCylinder, oil: Oil) -> ValveData:
    """Data of the load cylinder's valve, with the oil of the design."""

    def read(name: str) -> float | None:
        keys = re.findall(r"\w+", name)
        loc = tuple(int(key) if key.isdigit() else key for key in keys)
        return number_of(child_at(load_cylinder.valve, loc))

    return valve_data(
        read,
        load_cylinder.valve,
        density=oil.density,
        kinematic_viscosity=oil.kinematic_viscosity,
    )


SPEED = 1e-8
ANGLE = 1e-9
"""Error tolerances of shaft speed [rad/s] and angle [rad]."""


class Shaft(NamedTuple):
    """Speed and angle of the motor shaft, as states."""

    angle: Symbol
    speed: Symbol


def shaft(system: System) -> Shaft:
    """Add the states of the motor shaft, which starts at rest."""
    return Shaft(
        system.state("shaft angle", 0.0, tolerance=ANGLE),
        system.state("shaft speed", 0.0, tolerance=SPEED),
    )


def turn(
    circuit: Circuit,
    shaft_states: Shaft,
    *,
    pressure_a: Symbol,
    pressure_b: Symbol,
    inflow_a: Expression,
    inflow_b: Expression,
) -> None:
    """Add pipes, motor and load of the motor; a linear circuit omits Coulomb friction."""
    system, motor = circuit.system, circuit.scenario.motor
    assert motor is not None
    angle, speed = shaft_states
    machine = motor.machine
    difference = pressure_a - pressure_b
    common = {
        "speed": speed,
        "pressure_difference": difference,
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
    load = circuit.value("motor.torque", circuit.scenario_signal(motor.torque))
    load = load + motor.damping * speed
    system.rate(angle, speed)
    system.rate(speed, (torque - load) / motor.inertia)
    circuit.audit.stored.append(("motion", 0.5 * motor.inertia * speed * speed))
    circuit.energy_port(
        "losses of the motor", difference * flow - torque * speed, state="motor loss"
    )
    circuit.energy_port("load", load * speed, state="work on the load")
    system.signal("shaft_speed", "speed of the shaft", SCENARIOS["shaft_speed_value"], speed)
    system.signal("shaft_angle", "angle of the shaft", SCENARIOS["shaft_angle_value"], angle)
    system.signal("torque", "torque of the motor", SCENARIOS["torque_value"], torque)
    system.signal("load_torque", "torque of the load", SCENARIOS["torque_value"], load)
    system.signal("flow_motor", "flow through the motor", SCENARIOS["flow_value"], flow)


FLOW = 1e-12
"""Error tolerance of a flow [m^3/s]."""


LEAST_NODE = 1e-6
"""Smallest oil volume at the far end of a line or behind a throttle, also if the design states none
(our choice: 1 ml of fittings)."""


REDUCING_FLOW = 20 / 60000
"""Largest flow of the reducing valve [m^3/s] (our choice: a pilot-operated valve of size 6)."""


class ChamberPort(NamedTuple):
    """States of a chamber and of its line."""

    name: Chamber
    pressure: Expression
    """Pressure of the chamber."""
    end: Expression
    """Pressure at the far end of the line, next to the valve or reducing valve."""
    lumped: float
    """Line volume that is added to the chamber; `lumped_wall` is the compliance of that line's
    wall."""
    lumped_wall: float
    line: Symbol | None
    outer: Expression | None
    """Pressure between the throttle and the line; None without a throttle."""


def side(circuit: Circuit, name: Chamber, ends: str, start: Expression) -> ChamberPort:
    """Add the states of a chamber and of its line.

    The oil in a line has inertia if it flows; if the far end is closed, the line only adds volume.
    """
    system, data = circuit.system, circuit.plant.lines[name]
    throttled = circuit.plant.throttle is not None
    near_volume, near_wall = data.near_volume, data.near_wall
    kind = ENDS[ends]
    if kind.at_cylinder or (not throttled and (kind.shut or data.inertance == 0)):
        if not throttled:
            near_volume, near_wall = near_volume + data.far_volume, near_wall + data.far_wall
        pressure = start if kind.holds else system.pressure(f"pressure {name}", start)
        return ChamberPort(name, pressure, pressure, near_volume, near_wall, None, None)
    pressure = system.pressure(f"pressure {name}", start)
    has_inertia = data.inertance > 0 and not kind.shut
    if throttled and kind.holds and not has_inertia:
        return ChamberPort(name, pressure, start, near_volume, near_wall, None, start)
    outer = system.pressure(f"behind throttle {name}", start) if throttled else None
    line = None
    end: Expression = outer if outer is not None else pressure
    if has_inertia:
        line = system.state(f"line {name}", 0.0, tolerance=FLOW)
        end = start
        if not kind.holds:
            end = system.pressure(f"far end {name}", start)
    return ChamberPort(name, pressure, end, near_volume, near_wall, line, outer)


def connect(
    circuit: Circuit, port: ChamberPort, ends: str, feed: Expression, *, end_pressure: Expression
) -> Expression:
    """Connect a chamber to its line; return the flow into the chamber.

    `feed` is the flow into the line at its far end. `end_pressure` is the prescribed pressure
    there, if any.
    """
    feed = FEEDS[ends](circuit, port, feed, end_pressure)
    if port.line is not None:
        feed = _through_line(circuit, port, port.line, feed)
    if port.outer is not None:
        return -_through_throttle(circuit, port, port.outer, feed)
    return feed


def _through_line(
    circuit: Circuit, port: ChamberPort, flow: Symbol, feed: Expression
) -> Expression:
    """Flow from the line into the chamber."""
    data, word = circuit.plant.lines[port.name], port.name.upper()
    inner = port.pressure if port.outer is None else port.outer
    drop = data.drop(flow)
    circuit.system.rate(flow, (port.end - inner - drop) / data.inertance)
    circuit.energy_port(f"line {word}", drop * flow, state=f"line loss {port.name}")
    motion = 0.5 * data.inertance * flow * flow
    circuit.audit.stored.append((f"oil in motion in line {word}", motion))
    if isinstance(port.end, Symbol):
        _far(circuit, port, f"far end {word}", port.end, feed - flow)
    else:
        circuit.energy_port(
            "held ports", port.end * flow, state=f"held work {port.name}", into=True
        )
    return flow


def _through_throttle(
    circuit: Circuit, port: ChamberPort, outer: Expression, feed: Expression
) -> Expression:
    """Flow out of the chamber through the one-way valve and its throttle."""
    word = port.name.upper()
    assert circuit.plant.throttle is not None
    drop = port.pressure - outer
    flow = one_way_valve.one_way_flow(pressure_difference=drop, **circuit.plant.throttle)
    circuit.energy_port(f"throttle {word}", drop * flow, state=f"throttle loss {port.name}")
    circuit.system.signal(
        f"flow_throttle_{port.name}",
        f"flow out of chamber {word}",
        SCENARIOS["flow_value"],
        flow,
    )
    if isinstance(outer, Symbol):
        _far(circuit, port, f"behind throttle {word}", outer, feed + flow)
    else:
        circuit.energy_port("held ports", outer * flow, state=f"held work {port.name}")
    return flow


def _far(
    circuit: Circuit, port: ChamberPort, name: str, pressure: Symbol, inflow: Expression
) -> None:
    """Add the oil volume at the far end of the line, or behind the throttle.

    If a line continues beyond the throttle, half of its far volume is placed at each of the two.
    """
    data = circuit.plant.lines[port.name]
    share = 0.5 if port.outer is not None and port.line is not None else 1.0
    if share * data.far_volume < LEAST_NODE:
        circuit.system.notes.append(
            f"{name}: the volume is too small for the simulation and was "
            f"set to {LEAST_NODE * 1e6:.2g} ml"
        )
    node(
        circuit,
        name,
        pressure,
        inflow=inflow,
        volume=max(share * data.far_volume, LEAST_NODE),
        wall=share * data.far_wall,
    )


def _reducing(
    circuit: Circuit, port: ChamberPort, feed: Expression, end_pressure: Expression
) -> Expression:
    """Flow of the reducing valve into the line."""
    system, data = circuit.system, circuit.plant.reducing_valve
    assert data is not None
    regulated = system.state(f"reducing valve {port.name}", 0.0, tolerance=FLOW)
    rate = system.state(f"reducing valve rate {port.name}", 0.0, tolerance=100 * FLOW)
    system.rate(regulated, rate)
    system.rate(
        rate,
        supply.reducing_valve_acceleration(
            flow=regulated,
            rate=rate,
            pressure=port.end,
            set_pressure=end_pressure,
            conductance=data["conductance"],
            natural_frequency=data["natural_frequency"],
            damping_ratio=data["damping_ratio"],
        ),
    )
    flow = supply.reducing_valve_flow(
        flow=regulated,
        pressure=port.end,
        set_pressure=end_pressure,
        largest_flow=REDUCING_FLOW,
        passive_conductance=data["passive_conductance"],
    )
    circuit.energy_port(
        "held ports", port.end * flow, state=f"reducing work {port.name}", into=True
    )
    return flow


def _from_valve(
    circuit: Circuit, port: ChamberPort, feed: Expression, end_pressure: Expression
) -> Expression:
    """Flow from the valve into the line; zero if the far end is closed."""
    return feed


def _no_flow(
    circuit: Circuit, port: ChamberPort, feed: Expression, end_pressure: Expression
) -> Expression:
    return 0.0


FEEDS = per_kind(
    ENDS,
    {
        "valve": _from_valve,
        "closed": _no_flow,
        "blocked": _no_flow,
        "constant_pressure": _from_valve,
        "reducing_valve": _reducing,
    },
)
"""Function that returns the flow into the line, for every kind of far end."""
