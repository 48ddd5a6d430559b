"""The spool of a valve as its block states it: edges, motion, hysteresis."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from ..base.numeric import Array
from ..design.valve import Valve
from ..models import lapped_edge, lapped_leakage, play, valve as models
from ..models.lapped_spool import LappedSpool, SpoolEdge
from ..models.metering_curve import CurveEdge, CurveSpool, MeteringCurve
from ..models.metering_spool import MeteringSpool

Read = Callable[[str], Array]
"""Reads a stated number of the block by its key, such as ``spool.overlap``; None if not stated."""
EDGES = {"supply_a": "pa", "supply_b": "pb", "a_tank": "at", "b_tank": "bt"}
"""Key of each edge of a `metering_spool.MeteringSpool`."""
LINEAR = MeteringCurve.through((0.0, 1.0), (0.0, 1.0))
"""An edge that opens in proportion to the signal."""
ANY_STROKE = 1e-3
"""Stroke of a spool that states neither lap nor clearance [m]: it cancels out."""


class SpoolMotion(NamedTuple):
    """Natural frequency [Hz] and damping ratio of the spool."""

    natural_frequency: Array
    damping_ratio: Array


def spool_motion(read: Read) -> SpoolMotion:
    """Motion of the spool from the frequencies that the valve states."""
    natural, fall = read("natural_frequency"), read("frequency_3db")
    if natural is None:
        natural = read("frequency_90deg")
    if fall is None:
        return SpoolMotion(natural, read("damping_ratio"))
    if natural is not None:
        return SpoolMotion(natural, models.spool_damping(bandwidth=fall / natural))
    damping = read("damping_ratio")
    return SpoolMotion(fall / models.spool_bandwidth(damping_ratio=damping), damping)


def spool_bands(read: Read) -> tuple[Array, Array] | None:
    """Threshold and hysteresis of a valve [V]; None if it states neither.

    The threshold is part of the hysteresis: if only one of them is stated, the other equals it.
    """
    hysteresis, threshold = read("hysteresis"), read("threshold")
    if hysteresis is None and threshold is None:
        return None
    threshold = hysteresis if threshold is None else threshold
    hysteresis = threshold if hysteresis is None else hysteresis
    return threshold * read("signal"), hysteresis * read("signal")


def spool_plays(read: Read) -> tuple[Array, ...]:
    """Half widths of the plays before the spool [V]; empty for a valve without hysteresis."""
    bands = spool_bands(read)
    if bands is None or bands[1] == 0:
        return ()
    widths = play.play_half_widths(threshold=bands[0], hysteresis=bands[1])
    return widths[:1] if widths[0] == widths[1] else widths


class CourseEdges(NamedTuple):
    """Flow coefficients of the edges by the course's law [m^3/s/sqrt(Pa)]."""

    rated: Array
    """Coefficient of a fully open edge, corrected for the viscosity of the oil."""
    supply: Array
    """Coefficient of the supply edges P-A and P-B with the spool centred."""
    tank: Array
    """Coefficient of the return edges A-T and B-T with the spool centred."""


def _in_oil(read: Read, coefficient: Array, viscosity: Array) -> Array:
    """Coefficient of an open edge in an oil; the same in any oil without a rated viscosity."""
    rated_viscosity = read("rated_viscosity")
    if rated_viscosity is None:
        return coefficient
    return models.viscosity_corrected(
        coefficient=coefficient, rated_viscosity=rated_viscosity, viscosity=viscosity
    )


def course_edges(read: Read, *, viscosity: Array) -> CourseEdges:
    """Flow coefficients of a valve by the course's law, in an oil of a kinematic viscosity."""
    rated = models.edge_coefficient(flow=read("rated_flow"), pressure_drop=read("rated_drop"))
    return CourseEdges(_in_oil(read, rated, viscosity), *_leakages(read))


def _leakages(read: Read) -> tuple[Array, Array]:
    """Leakage coefficients of the supply edges and of the tank edges by the course's law."""
    leakage, drop, tank_drop = (
        read(name) for name in ("leakage_flow", "leakage_drop", "tank_leakage_drop")
    )
    return (
        models.edge_coefficient(flow=leakage, pressure_drop=drop),
        models.edge_coefficient(
            flow=leakage, pressure_drop=drop if tank_drop is None else tank_drop
        ),
    )


def metering_spool(
    read: Read, stated: Valve, *, density: Array, kinematic_viscosity: Array
) -> MeteringSpool | None:
    """The spool of a valve in an oil, lapped or with curves; None for the course's equal edges."""
    if stated.spool is not None and stated.spool.type == "lapped":
        return _lapped(read, stated, density, kinematic_viscosity)
    edges: dict[str, CurveEdge] = {}
    if (table := stated.flow_table) is not None:
        root = models.edge_coefficient(flow=1.0, pressure_drop=read("rated_drop"))
        factor = _in_oil(read, root, kinematic_viscosity)
        for name, key in EDGES.items():
            points = table.points(key, stated.signal)
            edges[name] = CurveEdge(MeteringCurve.through(*points), factor)
    elif stated.edge_coefficients is not None:
        supply, tank = _leakages(read)
        for name, key in EDGES.items():
            rated = _in_oil(read, read(f"edge_coefficients.{key}"), kinematic_viscosity)
            leakage = supply if name.startswith("supply") else tank
            edges[name] = CurveEdge(LINEAR, rated - leakage, leakage)
    return CurveSpool(**edges, full_signal=read("signal")) if edges else None


def _lapped(read: Read, stated: Valve, density: Array, kinematic_viscosity: Array) -> LappedSpool:
    """The lapped spool of a valve in an oil.

    Every edge passes the rated flow at full signal if the valve states it.
    """
    assert stated.spool is not None
    stroke = read("spool.stroke")
    oil = {"density": density, "flow_coefficient": read("spool.flow_coefficient")}
    spool = {
        "stroke": ANY_STROKE if stroke is None else stroke,
        "full_signal": read("signal"),
        "dynamic_viscosity": density * kinematic_viscosity,
        **oil,
    }
    clearance = read("spool.clearance")
    if stated.leakage_flow > 0:
        clearance = _leaking_clearance(read, spool["stroke"], oil)
    edges = {
        name: _edge(read, key, spool["stroke"], oil, kinematic_viscosity, clearance)
        for name, key in EDGES.items()
    }
    points = tuple(
        tuple(read(f"spool.curve[{i}].{name}") for name in ("signal", "flow"))
        for i in range(len(stated.spool.curve))
    )
    return LappedSpool(**edges, **spool, curve=points)


def _leaking_clearance(read: Read, stroke: Array, oil: dict[str, Array]) -> Array:
    """Clearance with which every edge leaks as the data sheet says, in its oil."""
    return lapped_leakage.clearance_of_leakage(
        leakage=read("leakage_flow"),
        leakage_drop=read("leakage_drop"),
        overlap=read("spool.overlap"),
        stroke=stroke,
        dynamic_viscosity=oil["density"] * read("rated_viscosity"),
        rated_flow=read("rated_flow"),
        rated_drop=read("rated_drop"),
        rounding=read("spool.rounding"),
        **oil,
    )


def _edge(
    read: Read,
    key: str,
    stroke: Array,
    oil: dict[str, Array],
    viscosity: Array,
    clearance: Array | None,
) -> SpoolEdge:
    """One edge of the spool; `clearance` is that of the edges that state none."""

    def own(name: str) -> Array:
        value = read(f"spool.{key}.{name}")
        return read(f"spool.{name}") if value is None else value

    share = read(f"spool.{key}.flow_share")
    stated = read(f"spool.{key}.clearance")
    gap = {
        "clearance": clearance if stated is None else stated,
        "rounding": own("rounding"),
    }
    overlap, width = own("overlap"), read("spool.area_gradient")
    if width is None:
        width = _width(read, stroke - overlap, oil, viscosity, gap)
    return SpoolEdge(overlap, width if share is None else share * width, **gap)


def _width(
    read: Read, opening: Array, oil: dict[str, Array], viscosity: Array, gap: dict[str, Array]
) -> Array:
    """Width of an edge that passes the rated flow at its full opening.

    An edge without clearance has no law of its own for the viscosity: it follows
    `valve.viscosity_corrected`.
    """
    flow, drop, rated = read("rated_flow"), read("rated_drop"), read("rated_viscosity")
    if gap["clearance"] is None and rated is not None:
        flow = models.viscosity_corrected(
            coefficient=flow, rated_viscosity=rated, viscosity=viscosity
        )
    per_width = lapped_edge.lapped_edge_flow(
        uncovered=opening,
        pressure_drop=drop,
        area_gradient=1.0,
        dynamic_viscosity=oil["density"] * (viscosity if rated is None else rated),
        **oil,
        **gap,
    )
    return flow / per_width
