"""The spool of a valve as its block states it: edges, and motion."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from ..base.numeric import Array
from ..design.valve import Valve
from ..models import lapped_edge, valve as models
from ..models.lapped_spool import LappedSpool, SpoolEdge

Read = Callable[[str], Array]
"""Reads a stated number of the block by its key, such as ``spool.overlap``; None if not stated."""
EDGES = {"supply_a": "pa", "supply_b": "pb", "a_tank": "at", "b_tank": "bt"}
"""Key of each edge of `lapped_spool.LappedSpool`."""
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


class CourseEdges(NamedTuple):
    """Flow coefficients of the edges by the course's law [m^3/s/sqrt(Pa)]."""

    rated: Array
    """Coefficient of a fully open edge, corrected for the viscosity of the oil."""
    supply: Array
    """Coefficient of the supply edges P-A and P-B with the spool centred."""
    tank: Array
    """Coefficient of the return edges A-T and B-T with the spool centred."""


def course_edges(read: Read, *, viscosity: Array) -> CourseEdges:
    """Flow coefficients of a valve by the course's law, in an oil of a kinematic viscosity."""
    rated = models.edge_coefficient(flow=read("rated_flow"), pressure_drop=read("rated_drop"))
    rated_viscosity = read("rated_viscosity")
    if rated_viscosity is not None:
        rated = models.viscosity_corrected(
            coefficient=rated, rated_viscosity=rated_viscosity, viscosity=viscosity
        )
    leakage, drop, tank_drop = (
        read(name) for name in ("leakage_flow", "leakage_drop", "tank_leakage_drop")
    )
    return CourseEdges(
        rated,
        models.edge_coefficient(flow=leakage, pressure_drop=drop),
        models.edge_coefficient(
            flow=leakage, pressure_drop=drop if tank_drop is None else tank_drop
        ),
    )


def lapped_spool(
    read: Read, stated: Valve, *, density: Array, kinematic_viscosity: Array
) -> LappedSpool | None:
    """The lapped spool of a valve in an oil; None for a valve with the course's law.

    Every edge passes the rated flow at full signal if the valve states it.
    """
    if stated.spool is None or stated.spool.type != "lapped":
        return None
    stroke = read("spool.stroke")
    oil = {"density": density, "flow_coefficient": read("spool.flow_coefficient")}
    spool = {
        "stroke": ANY_STROKE if stroke is None else stroke,
        "full_signal": read("signal"),
        "dynamic_viscosity": density * kinematic_viscosity,
        **oil,
    }
    edges = {
        name: _edge(read, key, spool["stroke"], oil, kinematic_viscosity)
        for name, key in EDGES.items()
    }
    points = tuple(
        tuple(read(f"spool.curve[{i}].{name}") for name in ("signal", "flow"))
        for i in range(len(stated.spool.curve))
    )
    return LappedSpool(**edges, **spool, curve=points)


def _edge(
    read: Read, key: str, stroke: Array, oil: dict[str, Array], viscosity: Array
) -> SpoolEdge:
    """One edge of the spool."""

    def own(name: str) -> Array:
        value = read(f"spool.{key}.{name}")
        return read(f"spool.{name}") if value is None else value

    share = read(f"spool.{key}.flow_share")
    gap = {"clearance": own("clearance"), "rounding": own("rounding")}
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
