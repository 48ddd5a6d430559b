"""Hydraulic circuit at the chambers: lines, throttles, valve, and conditions at the lines' ends."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array, maximum, where
from ..design.model import Design, Line
from ..models import accumulator, elements, holding_valve, line_ends, lines, one_way_valve
from ..models.line_ends import LineEnd
from ..models.metering_spool import BothSlopes, MeteringSpool, held_slopes
from . import spool
from .geometry import Geometry
from .state import LoadState
from .values import Values

Chamber = Literal["a", "b"]
CHAMBERS: tuple[Chamber, Chamber] = ("a", "b")


@dataclass(frozen=True, slots=True)
class ChamberLines:
    """Lumped properties of one chamber's lines; compliances of oil and pipe walls in m^3/Pa."""

    volume: Array = 0.0
    pipes: Array = 0.0
    """Compliance of pipe walls."""
    hoses: Array = 0.0
    """Compliance of hose walls."""
    resistance: Array = 0.0
    inertance: Array = 0.0
    far: Array = 0.0
    """The dynamic model divides each chamber's lines between two nodes. This is the compliance at
    the node away from the chamber: half of every line (pi element) or, with a throttle, all lines
    beyond the throttle."""


def wall_compliance(v: Values, line: Line, at: str) -> Array:
    """Compliance [m^3/Pa] of a line's wall: volume by which the line expands per unit pressure."""
    if line.rigid:
        return 0.0
    material = f"materials.{line.material}."
    return lines.line_compliance(
        inner_diameter=v[at + "inner_diameter"],
        length=v[at + "length"],
        outer_diameter=v[at + "outer_diameter"],
        youngs_modulus=v[material + "youngs_modulus"],
        poissons_ratio=v[material + "poissons_ratio"],
    )


def branches(v: Values, design: Design, state: LoadState) -> dict[Chamber, ChamberLines]:
    """Lumped properties of the lines of chambers A and B."""
    throttled = design.ports.throttle is not None
    modulus = {"a": state.bulk_modulus_a, "b": state.bulk_modulus_b}
    viscosity = {"a": state.dynamic_viscosity_a, "b": state.dynamic_viscosity_b}
    total: dict[Chamber, dict[str, Array]] = {name: {} for name in CHAMBERS}

    def count(chamber: Chamber, quantity: str, value: Array) -> None:
        known = total[chamber].get(quantity)
        total[chamber][quantity] = value if known is None else known + value

    for i, line in enumerate(design.lines):
        at, chamber = f"lines[{i}].", line.chamber
        size = {"inner_diameter": v[at + "inner_diameter"], "length": v[at + "length"]}
        volume, wall = lines.line_volume(**size), wall_compliance(v, line, at)
        count(chamber, "volume", volume)
        if not line.rigid:
            count(chamber, "hoses" if line.type == "hose" else "pipes", wall)
        count(
            chamber,
            "resistance",
            elements.resistance(**size, dynamic_viscosity=viscosity[chamber]),
        )
        count(chamber, "inertance", elements.inertance(**size, density=state.density))
        if line.beyond_throttle or not throttled:
            share = 1.0 if throttled else 0.5
            count(chamber, "far", share * (volume / modulus[chamber] + wall))
    return {name: ChamberLines(**total[name]) for name in CHAMBERS}


class Ways(NamedTuple):
    """A property of a chamber that has one value for each direction of motion."""

    extending: Array
    retracting: Array

    def toward(self, extending: Array) -> Array:
        """Return the value for a direction; `extending` is True, False or an array of booleans."""
        return where(extending, self.extending, self.retracting)


class LinearValve(NamedTuple):
    """The valve, linearised about the spool position at which it holds the load."""

    gains: dict[Chamber, Ways]
    """Flow gains K_q into the lines [m^3/s/V], by spool direction."""
    conductances: dict[Chamber, Ways]
    """Flow-pressure coefficients K_c [m^3/s/Pa] by spool direction; empty if the valve is tight."""
    resting: dict[Chamber, Array]
    """Flow-pressure coefficients K_c while the valve holds the load; empty if the valve is tight
    there."""

    def held(self, chamber: Chamber) -> LineEnd:
        """Condition at the valve end of a chamber's line while the valve holds the load."""
        leaks = self.resting.get(chamber)
        return line_ends.CLOSED if leaks is None else LineEnd((leaks,))

    def driving(self, chamber: Chamber, extending: Array) -> LineEnd:
        """Condition at the valve end of a chamber's line while the valve moves the load."""
        ways = self.conductances.get(chamber)
        return LineEnd((ways.toward(extending),)) if ways else line_ends.CLOSED


def of_valve(v: Values) -> spool.Read:
    """Read a number of the design's valve; None if it is not stated."""

    def read(name: str) -> Array:
        return v.get("valve." + name, None)

    return read


def metering_spool(v: Values, design: Design, state: LoadState) -> MeteringSpool | None:
    """The spool of the design's valve in every load case; None for the course's equal edges."""
    assert design.valve is not None
    return spool.metering_spool(
        of_valve(v),
        design.valve,
        density=state.density,
        kinematic_viscosity=state.kinematic_viscosity,
    )


def linear_valve(v: Values, design: Design, state: LoadState, leakage: Array) -> LinearValve | None:
    """Linearise the valve about the state in which it holds the load; None without valve.

    The valve then supplies the oil that leaks across the piston.
    """
    if design.valve is None:
        return None
    outward, inward, *held = _slopes(v, design, state, leakage)
    conductances: dict[Chamber, Ways] = {
        "a": Ways(outward.conductance_a, inward.conductance_a),
        "b": Ways(outward.conductance_b, inward.conductance_b),
    }
    tight = not any(np.any(np.real(way) > 0) for ways in conductances.values() for way in ways)
    closed = not any(np.any(np.real(leaks) > 0) for leaks in held)
    return LinearValve(
        {"a": Ways(outward.gain_a, inward.gain_a), "b": Ways(-outward.gain_b, -inward.gain_b)},
        {} if tight else conductances,
        {} if closed else dict(zip(CHAMBERS, held, strict=True)),
    )


def _slopes(v: Values, design: Design, state: LoadState, leakage: Array) -> BothSlopes:
    """Small-signal flows of the valve that drives and holds the load."""
    metering = metering_spool(v, design, state)
    if metering is not None:
        return held_slopes(
            spool=metering,
            supply_pressure=v["supply.pressure"],
            return_pressure=v["supply.return_pressure"],
            pressure_a=state.holding_a,
            pressure_b=state.holding_b,
            piston_leakage=leakage,
        )
    edges = spool.course_edges(of_valve(v), viscosity=state.kinematic_viscosity)
    outward, inward = (
        holding_valve.valve_slopes(
            rated_coefficient=edges.rated,
            leakage_coefficient=edges.supply,
            leakage_tank=edges.tank,
            signal=v["valve.signal"],
            supply_pressure=v["supply.pressure"],
            return_pressure=v["supply.return_pressure"],
            pressure_a=state.holding_a,
            pressure_b=state.holding_b,
            extending=extending,
            piston_leakage=leakage,
        )
        for extending in (True, False)
    )
    return BothSlopes(
        outward,
        inward,
        maximum(outward.conductance_a, inward.conductance_a),
        maximum(outward.conductance_b, inward.conductance_b),
    )


def throttle_conductances(
    v: Values, design: Design, state: LoadState, geometry: Geometry
) -> dict[Chamber, Ways]:
    """Conductance of the throttles by piston direction, for the flow of each load case."""
    if design.ports.throttle is None:
        return {}
    at = "ports.throttle."
    common = {
        "density": state.density,
        "dynamic_viscosity": state.dynamic_viscosity,
        "opening": v[at + "opening"],
        "needle_area": v[at + "area"],
        "check_area": v[at + "check_area"],
        "cracking_pressure": v[at + "cracking_pressure"],
    }

    def conductance(flow: Array) -> Array:
        """Conductance for a given flow out of the chamber."""
        drop = one_way_valve.one_way_pressure_drop(flow=flow, **common)
        return one_way_valve.one_way_conductance(pressure_difference=drop, **common)

    flow_a, flow_b = geometry.area_a * state.speed, geometry.area_b * state.speed
    return {
        "a": Ways(extending=conductance(-flow_a), retracting=conductance(flow_a)),
        "b": Ways(extending=conductance(flow_b), retracting=conductance(-flow_b)),
    }


def line_end(
    v: Values,
    design: Design,
    holding: LinearValve | None,
    accumulators: tuple[LineEnd, ...],
    chamber: Chamber,
) -> LineEnd:
    """Condition at the end of a chamber's line while an oscillating load excites the actuator."""
    ends = list(accumulators)
    kind = design.ports.end
    if kind == "valve" and holding is not None:
        ends.append(holding.held(chamber))
    elif kind == "constant_pressure":
        return line_ends.CONSTANT_PRESSURE
    elif kind == "reducing_valve":
        at = "ports.reducing_valve."
        ends.append(
            line_ends.reducing_valve_end(
                conductance=v[at + "conductance"],
                passive_conductance=v[at + "passive_conductance"],
                natural_frequency=v[at + "natural_frequency"],
                damping_ratio=v[at + "damping_ratio"],
            )
        )
    return line_ends.parallel_ends(*ends) if ends else line_ends.CLOSED


def accumulator_ends(
    v: Values, design: Design, state: LoadState, chamber: Chamber
) -> tuple[LineEnd, ...]:
    """Conditions that the accumulators set at the end of a chamber's line."""
    ends = []
    for i, entry in enumerate(design.ports.accumulators):
        if entry.chamber != chamber:
            continue
        at = f"ports.accumulators[{i}]."
        neck = {"inner_diameter": v[at + "neck_diameter"], "length": v[at + "neck_length"]}
        capacitance = accumulator.gas_capacitance(
            pressure=state.holding_a if chamber == "a" else state.holding_b,
            precharge_pressure=v[at + "precharge"],
            gas_volume=v[at + "gas_volume"],
            polytropic_index=v["fluid.polytropic_index"],
        )
        ends.append(
            line_ends.accumulator_end(
                capacitance=capacitance,
                inertance=elements.inertance(**neck, density=state.density),
                resistance=elements.resistance(**neck, dynamic_viscosity=state.dynamic_viscosity),
            )
        )
    return tuple(ends)
