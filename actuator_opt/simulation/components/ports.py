"""The line of a chamber: one-way valve, line, far end."""

from __future__ import annotations

from typing import NamedTuple

from ...base.kinds import per_kind
from ...base.quantities import SCENARIOS
from ...base.symbolic import Expression, Symbol
from ...design.scenario.kinds import ENDS
from ...evaluation.circuit import Chamber
from ...models import one_way_valve, supply
from .chambers import node
from .circuit import Circuit

FLOW = 1e-12
"""Error tolerance of a flow [m^3/s]."""
LEAST_NODE = 1e-6
"""Volume behind a throttle if the design states none (a choice: 1 ml of fittings)."""
REDUCING_FLOW = 20 / 60000
"""Largest flow of the reducing valve [m^3/s] (a choice: a pilot-operated valve of size 6)."""


class Side(NamedTuple):
    """A chamber with its port."""

    name: Chamber
    pressure: Expression
    """Pressure of the chamber."""
    end: Expression
    """Pressure at the far end, at the valve or reducing valve."""
    lumped: float
    """Line volume and wall that belong to the chamber."""
    lumped_wall: float
    line: Symbol | None
    outer: Expression | None
    """Pressure behind the throttle."""


def side(circuit: Circuit, name: Chamber, ends: str, start: float) -> Side:
    """States of a chamber and of its line.

    A line has inertia if flow passes through it; behind closed ends it is only volume.
    """
    system, data = circuit.system, circuit.plant.lines[name]
    throttled = circuit.plant.throttle is not None
    near, wall = data.near_volume, data.near_wall
    kind = ENDS[ends]
    if kind.at_cylinder or (not throttled and (kind.shut or data.inertance == 0)):
        if not throttled:
            near, wall = near + data.far_volume, wall + data.far_wall
        pressure = start if kind.holds else system.pressure(f"pressure {name}", start)
        return Side(name, pressure, pressure, near, wall, None, None)
    pressure = system.pressure(f"pressure {name}", start)
    lined = data.inertance > 0 and not kind.shut
    if throttled and kind.holds and not lined:
        return Side(name, pressure, start, near, wall, None, start)
    outer = system.pressure(f"behind throttle {name}", start) if throttled else None
    line = None
    end: Expression = outer if outer is not None else pressure
    if lined:
        line = system.state(f"line {name}", 0.0, tolerance=FLOW)
        end = start
        if not kind.holds:
            end = system.pressure(f"far end {name}", start)
    return Side(name, pressure, end, near, wall, line, outer)


def connect(circuit: Circuit, one: Side, ends: str, feed: Expression, *, held: float) -> Expression:
    """Flow into the chamber; `feed` is the flow at the end, `held` a pressure held there."""
    feed = FEEDS[ends](circuit, one, feed, held)
    if one.line is not None:
        feed = _through_line(circuit, one, one.line, feed)
    if one.outer is not None:
        return -_through_throttle(circuit, one, one.outer, feed)
    return feed


def _through_line(circuit: Circuit, one: Side, flow: Symbol, feed: Expression) -> Expression:
    """Flow of the line towards the chamber."""
    data, word = circuit.plant.lines[one.name], one.name.upper()
    inner = one.pressure if one.outer is None else one.outer
    lost = data.resistance * flow
    circuit.system.rate(flow, (one.end - inner - lost) / data.inertance)
    circuit.door(f"line {word}", lost * flow, state=f"line loss {one.name}")
    motion = 0.5 * data.inertance * flow * flow
    circuit.audit.stored.append((f"oil in motion in line {word}", motion))
    if isinstance(one.end, Symbol):
        _far(circuit, one, f"far end {word}", one.end, feed - flow)
    else:
        circuit.door("held ports", one.end * flow, state=f"held work {one.name}", into=True)
    return flow


def _through_throttle(
    circuit: Circuit, one: Side, outer: Expression, feed: Expression
) -> Expression:
    """Flow of the one-way valve out of the chamber."""
    word = one.name.upper()
    assert circuit.plant.throttle is not None
    drop = one.pressure - outer
    flow = one_way_valve.one_way_flow(pressure_difference=drop, **circuit.plant.throttle)
    circuit.door(f"throttle {word}", drop * flow, state=f"throttle loss {one.name}")
    circuit.system.signal(
        f"flow_throttle_{one.name}", f"flow out of chamber {word}", SCENARIOS["flow_value"], flow
    )
    if isinstance(outer, Symbol):
        _far(circuit, one, f"behind throttle {word}", outer, feed + flow)
    else:
        circuit.door("held ports", outer * flow, state=f"held work {one.name}")
    return flow


def _far(circuit: Circuit, one: Side, name: str, pressure: Symbol, inflow: Expression) -> None:
    """Volume at the far end: half of the line behind a throttle."""
    data = circuit.plant.lines[one.name]
    share = 0.5 if one.outer is not None and one.line is not None else 1.0
    if share * data.far_volume < LEAST_NODE:
        circuit.system.notes.append(f"{name}: volume taken as {LEAST_NODE * 1e6:.2g} ml")
    node(
        circuit,
        name,
        pressure,
        inflow=inflow,
        volume=max(share * data.far_volume, LEAST_NODE),
        wall=share * data.far_wall,
    )


def _reducing(circuit: Circuit, one: Side, held: float) -> Expression:
    """Flow of the reducing valve into the line."""
    system, data = circuit.system, circuit.plant.reducing_valve
    assert data is not None
    regulated = system.state(f"reducing valve {one.name}", 0.0, tolerance=FLOW)
    rate = system.state(f"reducing valve rate {one.name}", 0.0, tolerance=100 * FLOW)
    system.rate(regulated, rate)
    system.rate(
        rate,
        supply.reducing_valve_acceleration(
            flow=regulated,
            rate=rate,
            pressure=one.end,
            set_pressure=held,
            conductance=data["conductance"],
            natural_frequency=data["natural_frequency"],
            damping_ratio=data["damping_ratio"],
        ),
    )
    flow = supply.reducing_valve_flow(
        flow=regulated,
        pressure=one.end,
        set_pressure=held,
        largest_flow=REDUCING_FLOW,
        passive_conductance=data["passive_conductance"],
    )
    circuit.door("held ports", one.end * flow, state=f"reducing work {one.name}", into=True)
    return flow


def _given(circuit: Circuit, one: Side, feed: Expression, held: float) -> Expression:
    """Flow from the valve, or zero."""
    return feed


def _nothing(circuit: Circuit, one: Side, feed: Expression, held: float) -> Expression:
    return 0.0


def _regulated(circuit: Circuit, one: Side, feed: Expression, held: float) -> Expression:
    return _reducing(circuit, one, held)


FEEDS = per_kind(
    ENDS,
    {
        "valve": _given,
        "closed": _nothing,
        "blocked": _nothing,
        "constant_pressure": _given,
        "reducing_valve": _regulated,
    },
)
"""Flow into the line for every kind of end."""
