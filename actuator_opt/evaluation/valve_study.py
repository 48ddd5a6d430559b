"""The valve about its null: no-load flow, load pressure in blocked ports, and leakage.

A lapped spool is shown beside the textbook's three centres: the same spool with open, critical and
closed centre [Merritt1967].
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array
from ..design.model import Design
from ..design.valve import Valve
from ..models.lapped_spool import LappedSpool
from ..models.metering_spool import MeteringSpool, spool_flows
from ..models.valve import ValveFlows, valve_flows
from . import circuit, spool
from .state import LoadState
from .values import Values, of_case, plain

POINTS = 161
"""Signals of each curve; an odd number, so that one of them is the null."""
HALVINGS = 48
"""Halvings of the supply pressure in each balance: rounding remains."""
LEAST = 0.01
"""Least lap of the textbook's open and closed centre, as a share of the stroke (our choice)."""
SHOWN = 4.0
"""Range of signals shown, in laps of the textbook's centres (our choice)."""
STEP = 1e-3
"""Half of the signal step of the null coefficients, as a share of the range shown (our choice)."""
TIGHT = 1e-9
"""Leakage up to which a valve counts as tight, as a share of its no-load flow at full signal."""

Flows = Callable[[Array, Array], ValveFlows]
"""Flows at signals and at a pressure in both ports."""


@dataclass(frozen=True, slots=True)
class ValveCurve:
    """A valve about its null; the arrays have one entry per signal."""

    name: str
    """``this valve``, or ``open``, ``critical`` or ``closed`` for the textbook's centres."""
    overlap: float | None
    """Overlap of its edges [m]; None if they differ, and for the course's law."""
    flow: Array
    """Flow from port A to port B, joined without load [m^3/s]."""
    load_pressure: Array
    """Pressure in blocked port A minus that in blocked port B [Pa]."""
    leakage: Array
    """Flow from the supply with blocked ports [m^3/s]."""
    flow_gain: float
    """K_q0 at the null [m^3/s/V]."""
    pressure_gain: float | None
    """K_p0 at the null [Pa/V]; None for a valve that does not leak there."""
    flow_pressure_coefficient: float | None
    """K_c0 = K_q0/K_p0 at the null [m^3/s/Pa]; None within a dead band, where both are zero."""
    null_leakage: float
    """Flow from the supply at the null [m^3/s]."""


@dataclass(frozen=True, slots=True)
class ValveStudy:
    """Curves of a valve, in the oil of the first load case."""

    case: str
    supply_pressure: float
    return_pressure: float
    signal: Array
    """Signals from the centre [V]."""
    curves: tuple[ValveCurve, ...]
    """Curve of the design's valve, then those of the textbook's centres."""
    threshold: float | None = None
    hysteresis: float | None = None
    """Threshold and hysteresis [V]; None if the valve states neither."""
    position_gain: float | None = None
    """Gain of the position loop [V/m], for the position error that they cause."""

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON; threshold and hysteresis only if the valve states them."""
        names = list(self.__dataclass_fields__)
        if self.hysteresis is None:
            names = names[: names.index("threshold")]
        return {name: plain(getattr(self, name)) for name in names}


def _is_stated(valve: Valve | None) -> bool:
    """Whether a valve states more than the rated flow and leakage of the course's law."""
    names = ("spool", "flow_curve", "edge_coefficients", "hysteresis", "threshold")
    return any(getattr(valve, name, None) is not None for name in names)


def study(
    design: Design, v: Values, state: LoadState, position_gain: float | None
) -> ValveStudy | None:
    """Curves of the design's valve; None if it has none, or states only flow and leakage."""
    if design.valve is None or not _is_stated(design.valve):
        return None
    oil = {
        "density": of_case(state.density, 0),
        "kinematic_viscosity": of_case(state.kinematic_viscosity, 0),
    }
    read = circuit.of_valve(v)
    supply, tank = float(v["supply.pressure"]), float(v["supply.return_pressure"])
    lines = {"supply_pressure": supply, "return_pressure": tank}
    metering = spool.metering_spool(read, design.valve, **oil)
    full = float(read("signal"))
    if metering is None:
        edges = spool.course_edges(read, viscosity=oil["kinematic_viscosity"])
        most = full * min(1.0, max(SHOWN * LEAST, SHOWN * float(edges.supply / edges.rated)))
        names: dict[str, float | None] = {"this valve": None}
        flows = _course(edges, full, lines)
    elif isinstance(metering, LappedSpool):
        lap = _lap(metering)
        most = full * min(1.0, SHOWN * metering.signal_share(lap))
        names = {"this valve": _common(metering)}
        if not metering.curve:  # a curve has its own dead band
            names |= {"open": -lap, "critical": 0.0, "closed": lap}
        flows = _metered(_beside(metering, list(names.values())[1:]), lines)
    else:  # a curve is shown whole
        leaks = max(
            float(e.coefficient(0.0) / e.coefficient(1.0)) for e in _edges(metering).values()
        )
        whole = design.valve.flow_curve is not None
        most = full * (1.0 if whole else min(1.0, SHOWN * max(LEAST, leaks)))
        names = {"this valve": None}
        flows = _metered(metering, lines)
    signal = np.linspace(-most, most, POINTS)
    curves = _curves(names, flows, signal, full, supply, tank)
    bands = spool.spool_bands(read) or (None, None)
    threshold, hysteresis = (None if band is None else float(band) for band in bands)
    return ValveStudy(
        v.cases[0], supply, tank, signal, curves, threshold, hysteresis, position_gain
    )


def _course(edges: spool.CourseEdges, full: float, lines: dict[str, float]) -> Flows:
    """Flows of a valve by the course's law."""

    def flows(signal: Array, pressure: Array) -> ValveFlows:
        return valve_flows(
            signal=signal,
            rated_coefficient=edges.rated,
            leakage_supply=edges.supply,
            leakage_tank=edges.tank,
            full_signal=full,
            pressure_a=pressure,
            pressure_b=pressure,
            **lines,
        )

    return flows


def _metered(one: MeteringSpool, lines: dict[str, float]) -> Flows:
    """Flows of a spool with laps or curves."""

    def flows(signal: Array, pressure: Array) -> ValveFlows:
        return spool_flows(
            spool=one, signal=signal, pressure_a=pressure, pressure_b=pressure, **lines
        )

    return flows


def _edges(one: MeteringSpool) -> dict[str, Any]:
    """The four edges of a spool, by name."""
    return {name: getattr(one, name) for name in spool.EDGES}


def _common(one: LappedSpool) -> float | None:
    """Overlap of all edges; None if they differ."""
    overlaps = {float(edge.overlap) for edge in _edges(one).values()}
    return overlaps.pop() if len(overlaps) == 1 else None


def _beside(one: LappedSpool, overlaps: Sequence[float | None]) -> LappedSpool:
    """The spool and others with these overlaps at all edges, as rows of its overlaps."""
    edges = {
        name: replace(edge, overlap=np.array([[edge.overlap], *([lap] for lap in overlaps)], float))
        for name, edge in _edges(one).items()
    }
    return replace(one, **edges)


def _lap(one: LappedSpool) -> float:
    """Lap of the textbook's open and closed centre: at least that of the spool."""
    laps = [LEAST * float(one.stroke)]
    for edge in _edges(one).values():
        laps += [abs(float(edge.overlap)), 4 * float(edge.clearance or 0.0)]
    return max(laps)


def _balance(net: Callable[[Array], Array], like: Array, supply: float, tank: float) -> Array:
    """Pressure at which a net inflow, which falls with it, is zero; the middle where none flows."""
    low, high = np.full(like.shape, tank), np.full(like.shape, supply)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        inflow = net(middle)
        low = np.where(inflow >= 0, middle, low)
        high = np.where(inflow <= 0, middle, high)
    return 0.5 * (low + high)


def _load_pressure(flows: Flows, signal: Array, supply: float, tank: float) -> tuple[Array, Array]:
    """Load pressure and leakage with blocked ports."""
    a = _balance(lambda p: flows(signal, p).into_a, signal, supply, tank)
    b = _balance(lambda p: flows(signal, p).into_b, signal, supply, tank)
    return a - b, flows(signal, a).supply_a + flows(signal, b).supply_b


def _no_load(flows: Flows, signal: Array, supply: float, tank: float) -> Array:
    """Flow from A to B, joined."""

    def net(pressure: Array) -> Array:
        found = flows(signal, pressure)
        return found.into_a + found.into_b

    return flows(signal, _balance(net, signal, supply, tank)).into_a


def _curves(
    names: dict[str, float | None],
    flows: Flows,
    signal: Array,
    full: float,
    supply: float,
    tank: float,
) -> tuple[ValveCurve, ...]:
    """Curves of the valves in the rows of the flows."""
    step = STEP * float(signal[-1])
    every = np.concatenate([signal, [-step, step, full]])
    every = np.broadcast_to(every, (len(names), len(every)))
    flow = _no_load(flows, every, supply, tank)
    load_pressure, leakage = _load_pressure(flows, every, supply, tank)
    curves = []
    for i, (name, overlap) in enumerate(names.items()):
        gain, rise = (float(row[-2] - row[-3]) / (2 * step) for row in (flow[i], load_pressure[i]))
        null_leakage = float(leakage[i, len(signal) // 2])
        tight = null_leakage <= TIGHT * float(flow[i, -1])
        curves.append(
            ValveCurve(
                name=name,
                overlap=overlap,
                flow=flow[i, :POINTS],
                load_pressure=load_pressure[i, :POINTS],
                leakage=leakage[i, :POINTS],
                flow_gain=gain,
                pressure_gain=None if tight else rise,
                flow_pressure_coefficient=0.0 if tight else gain / rise if rise > 0 else None,
                null_leakage=null_leakage,
            )
        )
    return tuple(curves)
