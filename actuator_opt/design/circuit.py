"""Hydraulic circuit of the cylinder: lines, valve, line ends, position loop."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from . import choices
from .kinds import Flag, MaterialName, Of
from .section import Section


class Line(Section):
    """A pipe or hose of one chamber (a: cap side, b: rod side), in order from the port."""

    chamber: choices.Chamber
    type: choices.LineType = "pipe"
    length: Annotated[float, Of("part_length", "length of the line")]
    inner_diameter: Annotated[float, Of("diameter", "inner diameter")]
    outer_diameter: Annotated[float, Of("diameter", "outer diameter")]
    material: Annotated[str, MaterialName("isotropic")]
    rigid: Annotated[bool, Flag("rigid wall: only the oil is compliant")] = False
    beyond_throttle: Annotated[
        bool, Flag("the line is between the throttle and the line's end")
    ] = False


class Valve(Section):
    """A proportional or servo valve with four edges, linear in the signal."""

    rated_flow: Annotated[float, Of("rated_flow", "flow through one metering edge at full signal")]
    rated_drop: Annotated[
        float, Of("pressure_drop", "pressure drop across the edge at rated flow")
    ] = 35e5
    leakage_flow: Annotated[
        float, Of("leakage_flow", "leakage of one edge with centred spool: half of the valve's")
    ] = 0.0
    leakage_drop: Annotated[
        float, Of("pressure_drop", "pressure drop across the edge at the leakage flow")
    ] = 50e5
    tank_leakage_drop: Annotated[
        float | None,
        Of("pressure_drop", "the same across an edge to tank; default: leakage_drop"),
    ] = None
    rated_viscosity: Annotated[
        float | None,
        Of("oil_viscosity", "oil viscosity at rated flow; default: rated flow for any oil"),
    ] = None
    offset: Annotated[float, Of("signal_offset", "signal that centres the spool")] = 0.0
    signal: Annotated[float, Of("signal", "signal of the fully open spool")] = 10.0
    natural_frequency: Annotated[float, Of("frequency", "natural frequency of the spool")]
    damping_ratio: Annotated[float, Of("damping_ratio", "damping ratio of the spool")] = 0.7


class Throttle(Section):
    """One-way flow-control valves that throttle the outflow; linear about the flow of each case."""

    area: Annotated[float, Of("orifice_area", "area of the fully open needle")]
    opening: Annotated[float, Of("opening", "opening of the needle")] = 1.0
    check_area: Annotated[float, Of("orifice_area", "area of the open check valve")]
    cracking_pressure: Annotated[
        float, Of("pressure_drop", "opening pressure of the check valve")
    ] = 0.4e5


class ReducingValve(Section):
    """A pressure reducing valve as a second-order line end, for small signals."""

    conductance: Annotated[float, Of("conductance", "static regulating conductance")]
    passive_conductance: Annotated[
        float, Of("conductance", "conductance of the valve opening, at any frequency")
    ] = 0.0
    natural_frequency: Annotated[float, Of("frequency", "natural frequency of the valve")]
    damping_ratio: Annotated[float, Of("damping_ratio", "damping ratio of the valve")]


class Accumulator(Section):
    """A gas accumulator on the line of one chamber; the gas has fluid.polytropic_index."""

    chamber: choices.Chamber
    gas_volume: Annotated[float, Of("gas_volume", "gas volume at the precharge")]
    precharge: Annotated[float, Of("precharge", "gas precharge, gauge")]
    neck_length: Annotated[float, Of("part_length", "length of the neck")]
    neck_diameter: Annotated[float, Of("diameter", "inner diameter of the neck")]


class Ports(Section):
    """End of both lines while the load excites the actuator, with the position loop open."""

    end: choices.End = "closed"
    throttle: Throttle | None = None
    reducing_valve: ReducingValve | None = None
    accumulators: Annotated[tuple[Accumulator, ...], Field(max_length=8)] = ()


class Control(Section):
    """The position loop: signal = gain x position error, measured at the load."""

    gain: Annotated[
        float | None,
        Of("gain", "signal per position error; default: half the ultimate gain"),
    ] = None
