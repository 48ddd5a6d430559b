"""From a chamber to what ends its line: one-way valve, line, far end."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from ...evaluation.study.plant import LineData, Plant
from ...models import one_way_valve, reducing_valve
from ...quantities import SCENARIOS
from ...symbolic import Expression, Symbol
from ..system import System
from .chambers import Audit, node

FLOW = 1e-12
"""Error of a flow that is let pass [m^3/s]."""
LEAST_NODE = 1e-6
"""Volume behind a throttle where the design states none (a choice: 1 ml of fittings)."""
REDUCING_FLOW = 20 / 60000
"""Largest flow of the reducing valve [m^3/s] (a choice: a pilot-operated valve of size 6)."""


class Side(NamedTuple):
    """A chamber as its port sees it."""

    name: str
    """"a" or "b"."""
    pressure: Expression
    """Of the chamber."""
    end: Expression
    """Of the far end, where valve or reducing valve stand."""
    lumped: float
    """Volume and wall of lines that count to the chamber."""
    lumped_wall: float
    line: Symbol | None
    outer: Expression | None
    """Behind the throttle."""


def side(system: System, plant: Plant, name: str, ends: str, start: float) -> Side:
    """States of a chamber and of what lies before its end.

    A line has inertia where something moves oil through it; behind closed ends it is volume.
    """
    data = plant.lines[name]  # type: ignore[index]
    throttled = plant.throttle is not None
    shut = ends == "blocked"
    near, wall = data.near_volume, data.near_wall
    if shut or (not throttled and (ends == "closed" or data.inertance == 0)):
        if not throttled:
            near, wall = near + data.far_volume, wall + data.far_wall
        held = ends == "constant_pressure"
        pressure = start if held else system.pressure(f"pressure {name}", start)
        return Side(name, pressure, pressure, near, wall, None, None)
    pressure = system.pressure(f"pressure {name}", start)
    lined = data.inertance > 0 and ends != "closed"
    if throttled and ends == "constant_pressure" and not lined:
        return Side(name, pressure, start, near, wall, None, start)
    outer = system.pressure(f"behind throttle {name}", start) if throttled else None
    line = None
    end: Expression = outer if outer is not None else pressure
    if lined:
        line = system.state(f"line {name}", 0.0, tolerance=FLOW)
        end = start
        if ends != "constant_pressure":
            end = system.pressure(f"far end {name}", start)
    return Side(name, pressure, end, near, wall, line, outer)


def connect(
    system: System,
    audit: Audit,
    plant: Plant,
    one: Side,
    ends: str,
    feed: Expression,
    *,
    held: float,
    power: float,
) -> Expression:
    """Flow into the chamber; `feed` is what the end gives, `held` the pressure it holds."""
    data: LineData = plant.lines[one.name]  # type: ignore[index]
    word = one.name.upper()
    if ends == "reducing_valve":
        feed = _reducing(system, audit, plant, one, held, power)
    elif ends in ("closed", "blocked"):
        feed = 0.0
    if one.line is None and one.outer is None:
        return feed
    throttled = one.outer is not None
    inner: Expression = one.outer if one.outer is not None else one.pressure
    halves = 0.5 if throttled and one.line is not None else 1.0
    into_line = feed
    if one.line is not None:
        flow = one.line
        system.rate(flow, (one.end - inner - data.resistance * flow) / data.inertance)
        lost = system.integral(f"line loss {one.name}", data.resistance * flow * flow, scale=power)
        audit.flows.append((f"line {word}", lost, False))
        motion = 0.5 * data.inertance * flow * flow
        audit.stored.append((f"oil in motion in line {word}", motion))
        if isinstance(one.end, Symbol):
            node(
                system,
                audit,
                f"far end {word}",
                plant.oil,
                one.end,
                inflow=feed - flow,
                volume=max(halves * data.far_volume, LEAST_NODE),
                wall=halves * data.far_wall,
            )
        else:
            work = system.integral(f"held work {one.name}", one.end * flow, scale=power)
            audit.flows.append(("held ports", work, True))
        into_line = flow
    if not throttled:
        return into_line
    assert plant.throttle is not None
    assert one.outer is not None
    through = one_way_valve.one_way_flow(
        pressure_difference=one.pressure - one.outer, **plant.throttle
    )
    lost = system.integral(
        f"throttle loss {one.name}", (one.pressure - one.outer) * through, scale=power
    )
    audit.flows.append((f"throttle {word}", lost, False))
    system.signal(
        f"flow_throttle_{one.name}", f"flow out of chamber {word}", SCENARIOS["flow_value"], through
    )
    if not isinstance(one.outer, Symbol):
        taken = system.integral(f"held work {one.name}", one.outer * through, scale=power)
        audit.flows.append(("held ports", taken, False))
        return -through
    node(
        system,
        audit,
        f"behind throttle {word}",
        plant.oil,
        one.outer,
        inflow=into_line + through,
        volume=max(halves * data.far_volume, LEAST_NODE),
        wall=halves * data.far_wall,
    )
    return -through


def _reducing(
    system: System, audit: Audit, plant: Plant, one: Side, held: float, power: float
) -> Expression:
    """Flow of the reducing valve into the line."""
    data = plant.reducing_valve
    assert data is not None
    regulated = system.state(f"reducing valve {one.name}", 0.0, tolerance=FLOW)
    rate = system.state(f"reducing valve rate {one.name}", 0.0, tolerance=100 * FLOW)
    system.rate(regulated, rate)
    system.rate(
        rate,
        reducing_valve.reducing_valve_acceleration(
            flow=regulated,
            rate=rate,
            pressure=one.end,
            set_pressure=held,
            conductance=data["conductance"],
            natural_frequency=data["natural_frequency"],
            damping_ratio=data["damping_ratio"],
        ),
    )
    flow = reducing_valve.reducing_valve_flow(
        flow=regulated,
        pressure=one.end,
        set_pressure=held,
        largest_flow=REDUCING_FLOW,
        passive_conductance=data["passive_conductance"],
    )
    work = system.integral(f"reducing work {one.name}", one.end * flow, scale=power)
    audit.flows.append(("held ports", work, True))
    return flow


Feed = Callable[[Expression, Expression], tuple[Expression, Expression]]
