"""Spool whose four edges have lap, clearance and width of their own: flows, and held loads.

The spool is at x = s U/U_max, with stroke s, at most s from its centre. It uncovers the edges P-A
and B-T by x - o and the edges A-T and P-B by -x - o, where o is the overlap of each edge.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

from ..base.dataclass import dataclass
from ..base.numeric import Array, absolute, clip, finished, maximum, minimum, positive, real, where
from .holding_valve import ValveSlopes
from .lapped_edge import lapped_edge_conductance, lapped_edge_flow, lapped_edge_gain
from .orifice import TURBULENT_COEFFICIENT
from .valve import ValveFlows

ROUNDS = 40
"""Most rounds of the search for the spool position that holds a load."""
FEWEST = 10
"""Rounds before that search may end (our choice), so that a recording of the models for one design
also serves designs that need a few rounds more."""
SETTLED = 1e-12
"""Step at which that search ends, as a share of the stroke; one more Newton step follows."""
CLEAR = 4.0
"""Uncovered length at which an edge with clearance counts as open, in clearances. Our choice: the
opening is then 3 % larger than the uncovered length."""
NULL = 0.01
"""Least uncovered length at which an edge with clearance counts as open, as a share of the stroke.
Our choice: closer to the edge, viscous flow lowers the flow gain."""


@dataclass(frozen=True, slots=True)
class SpoolEdge:
    """One metering edge; see `lapped_edge.lapped_edge_flow`."""

    overlap: Array
    """[m]; negative: open at the centre."""
    area_gradient: Array
    """Width of the ports around the spool [m]."""
    clearance: Array | None = None
    """Radial [m]; None: the edge does not leak."""
    rounding: Array = 0.0
    """Radius of the corners [m]."""


@dataclass(frozen=True, slots=True)
class LappedSpool:
    """A spool with its four edges, and the oil in them."""

    supply_a: SpoolEdge
    supply_b: SpoolEdge
    a_tank: SpoolEdge
    b_tank: SpoolEdge
    stroke: Array
    """Largest distance from the centre [m], > 0."""
    full_signal: Array
    """Signal at the full stroke [V], > 0."""
    density: Array
    dynamic_viscosity: Array
    flow_coefficient: Array = TURBULENT_COEFFICIENT
    curve: tuple[tuple[Array, Array], ...] = ()
    """Points between 0 and 1: share of the full signal, and share of the stroke there."""

    def start(self, edge: SpoolEdge) -> Array:
        """Stroke at which an edge counts as open [m]."""
        return edge.overlap if edge.clearance is None else self.opened(edge)

    def signal_share(self, stroke: float) -> float:
        """Largest share of the full signal at which the spool is no farther than a stroke [m]."""
        share = min(stroke / float(self.stroke), 1.0)
        for start, x, _, slope in reversed(_segments(self)):
            if float(slope) > 0 and float(x) <= share:
                return float(start) + (share - float(x)) / float(slope)
        return 0.0

    def opened(self, edge: SpoolEdge) -> Array:
        """Stroke at which an edge is open beyond its lap and clearance [m]."""
        clear = 0.0 if edge.clearance is None else CLEAR * edge.clearance
        return edge.overlap + maximum(clear, NULL * self.stroke)


def spool_stroke(*, spool: LappedSpool, signal: Array) -> Array:
    """Position of the spool at a signal, x = s f(U/U_max), at most s from its centre.

    Without curve f(u) = u; else the points of the curve are joined by straight lines, and the other
    direction is its mirror image.

    Parameters
    ----------
    spool : stroke s [m] and signal U_max at full stroke [V]
    signal : U, either sign [V]

    Returns
    -------
    position [m]; NaN where the full signal is not positive

    Notes
    -----
    Valid: a spool that follows its signal without delay.

    References
    ----------
    [derived] spool with mechanical stops

    Examples
    --------
    >>> edge = SpoolEdge(overlap=0.0, area_gradient=20e-3)
    >>> spool = LappedSpool(edge, edge, edge, edge, 1e-3, 10.0, 870.0, 0.03)
    >>> [float(spool_stroke(spool=spool, signal=u)) for u in (-2.5, 12.0)]
    [-0.00025, 0.001]
    """
    if not spool.curve:
        x = spool.stroke * signal / positive(spool.full_signal)
        return clip(x, -spool.stroke, spool.stroke)
    share = signal / positive(spool.full_signal)
    size, travel = absolute(share), 0.0
    for start, _, end, slope in _segments(spool):
        travel = travel + slope * (clip(size, start, end) - start)
    x = spool.stroke * travel
    return where(real(share) >= 0, x, -x)


def _segments(spool: LappedSpool) -> list[tuple[Array, Array, Array, Array]]:
    """Straight parts of the curve: signal and stroke at the start, signal at the end, slope."""
    points = [(0.0, 0.0), *spool.curve, (1.0, 1.0)]
    return [
        (u, x, u_next, (x_next - x) / (u_next - u)) for (u, x), (u_next, x_next) in pairwise(points)
    ]


def stroke_slope(*, spool: LappedSpool, place: Array) -> Array:
    """Slope of the spool's position over its signal at a position, dx/dU.

    Parameters
    ----------
    spool : stroke s [m], signal U_max at full stroke [V] and curve
    place : position x of the spool, either sign [m]

    Returns
    -------
    slope [m/V]; at a point of the curve, that of the part beyond it

    Notes
    -----
    Valid: within the stroke.

    References
    ----------
    [derived] slope of `spool_stroke`

    Examples
    --------
    >>> edge = SpoolEdge(overlap=0.0, area_gradient=20e-3)
    >>> spool = LappedSpool(edge, edge, edge, edge, 1e-3, 10.0, 870.0, 0.03, curve=((0.5, 0.2),))
    >>> [round(float(stroke_slope(spool=spool, place=x)) * 1e6) for x in (1e-4, -5e-4)]
    [40, 160]
    """
    per_volt = spool.stroke / positive(spool.full_signal)
    slope: Array = 1.0
    for i, (_, x, _, steepness) in enumerate(_segments(spool) if spool.curve else ()):
        beyond = real(absolute(place)) >= real(x * spool.stroke)
        slope = where(beyond, steepness, slope) if i else steepness
    return slope * per_volt + 0 * place


def lapped_flows(
    *,
    spool: LappedSpool,
    signal: Array,
    supply_pressure: Array,
    return_pressure: Array,
    pressure_a: Array,
    pressure_b: Array,
) -> ValveFlows:
    """Flows of the four edges at a signal and four pressures, each by `lapped_edge_flow`.

    Parameters
    ----------
    spool : edges, stroke and oil, see `LappedSpool` [SI]
    signal : from the centre of the spool, either sign [V]
    supply_pressure, return_pressure, pressure_a, pressure_b : gauge [Pa]

    Returns
    -------
    flows P to A, P to B, A to T, B to T [m^3/s], and their sums at the four ports

    Notes
    -----
    Valid: no cavitation in an edge.

    References
    ----------
    [Merritt1967] four-way spool valve, recalled; [derived] lap of each edge

    Examples
    --------
    >>> edge = SpoolEdge(overlap=0.0, area_gradient=20e-3)
    >>> spool = LappedSpool(edge, edge, edge, edge, 1e-3, 10.0, 870.0, 0.03)
    >>> flows = lapped_flows(spool=spool, signal=1.0, supply_pressure=140e5, return_pressure=0.0,
    ...                      pressure_a=70e5, pressure_b=70e5)
    >>> print(f"{flows.into_a * 60000:.2f} {flows.supply * 60000:.2f} l/min")
    9.30 9.30 l/min
    """
    x = spool_stroke(spool=spool, signal=signal)

    def flow(edge: SpoolEdge, place: Array, drop: Array) -> Array:
        return lapped_edge_flow(pressure_drop=drop, **_edge(spool, edge, place))

    return ValveFlows(
        flow(spool.supply_a, x, supply_pressure - pressure_a),
        flow(spool.supply_b, -x, supply_pressure - pressure_b),
        flow(spool.a_tank, -x, pressure_a - return_pressure),
        flow(spool.b_tank, x, pressure_b - return_pressure),
    )


def _edge(spool: LappedSpool, edge: SpoolEdge, place: Array) -> dict[str, Array]:
    """Arguments of the functions of an edge, with the spool moved by `place` to open it."""
    return {
        "uncovered": place - edge.overlap,
        "area_gradient": edge.area_gradient,
        "clearance": edge.clearance,
        "rounding": edge.rounding,
        "density": spool.density,
        "dynamic_viscosity": spool.dynamic_viscosity,
        "flow_coefficient": spool.flow_coefficient,
    }


class _Port(NamedTuple):
    """A chamber's port: its edge to the supply, its edge to the tank, and their pressure drops."""

    spool: LappedSpool
    supply: SpoolEdge
    tank: SpoolEdge
    into: Array
    out: Array

    def inflow(self, place: Array) -> Array:
        """Flow into the chamber, with the spool moved by `place` to open the supply edge."""
        fed = lapped_edge_flow(pressure_drop=self.into, **_edge(self.spool, self.supply, place))
        drained = lapped_edge_flow(pressure_drop=self.out, **_edge(self.spool, self.tank, -place))
        return fed - drained

    def gain(self, place: Array, *, feeds: bool = False, drains: bool = False) -> Array:
        """Slope of the inflow over the place; never negative.

        `feeds` or `drains` says which edge the spool is about to open.
        """
        fed = lapped_edge_gain(
            pressure_drop=self.into, opens=feeds, **_edge(self.spool, self.supply, place)
        )
        drained = lapped_edge_gain(
            pressure_drop=self.out, opens=drains, **_edge(self.spool, self.tank, -place)
        )
        return fed + drained

    def conductance(self, place: Array) -> Array:
        """Flow out of the chamber per pressure in it."""
        fed = lapped_edge_conductance(
            pressure_drop=self.into, **_edge(self.spool, self.supply, place)
        )
        drained = lapped_edge_conductance(
            pressure_drop=self.out, **_edge(self.spool, self.tank, -place)
        )
        return fed + drained


def _port(spool: LappedSpool, chamber: str, into: Array, out: Array) -> _Port:
    """The port of chamber a or b, at pressure drops of which none is negative."""
    edges = (spool.supply_a, spool.a_tank) if chamber == "a" else (spool.supply_b, spool.b_tank)
    return _Port(spool, *edges, *(where(real(drop) > 0, drop, 0 * drop) for drop in (into, out)))


def holding_stroke(
    *, spool: LappedSpool, chamber: str, into: Array, out: Array, lost: Array = 0.0
) -> Array:
    """Spool position at which as much oil enters a chamber as leaves it.

    The inflow q_in(x) - q_out(x) - q rises with the stroke x that opens the supply edge. A Newton
    search between two bounds, which halves them where a step leaves them, finds its zero; one more
    step carries the derivative.

    Parameters
    ----------
    spool : edges, stroke and oil, see `LappedSpool` [SI]
    chamber : "a" or "b" [-]
    into, out : pressure drops p_S - p and p - p_T [Pa]
    lost : flow q that leaves the chamber past the piston [m^3/s]

    Returns
    -------
    stroke in the direction that feeds the chamber [m]; the full stroke where none is enough; any
    position within the lap if nothing flows there

    Notes
    -----
    Valid: a load held still by the valve.

    With matched edges, one position balances both chambers at p_A + p_B = p_S + p_T.

    References
    ----------
    [derived] continuity of a chamber at rest

    Examples
    --------
    >>> edge = SpoolEdge(overlap=-10e-6, area_gradient=20e-3)
    >>> spool = LappedSpool(edge, edge, edge, edge, 1e-3, 10.0, 870.0, 0.03)
    >>> x = holding_stroke(spool=spool, chamber="a", into=90e5, out=50e5)
    >>> print(f"{x * 1e6:.3f} um")
    -1.459 um
    """
    port = _port(spool, chamber, into, out)
    most = real(spool.stroke) + 0 * real(port.into + port.out + lost + spool.full_signal)
    low = where(
        real(port.inflow(most) - lost) <= 0, most, -most
    )  # or the full stroke is too little
    high = where(real(port.inflow(-most) - lost) >= 0, -most, most)
    x = clip(0.5 * real(port.supply.overlap - port.tank.overlap) + 0 * most, low, high)
    # from an open edge, where the inflow is almost linear, Newton's steps do not overshoot
    net = real(port.inflow(x) - lost)
    low, high = where(net < 0, x, low), where(net > 0, x, high)
    feeding, draining = real(spool.opened(port.supply)), -real(spool.opened(port.tank))
    x = where(net < 0, maximum(x, minimum(feeding, high)), x)
    x = where(net > 0, minimum(x, maximum(draining, low)), x)
    for rounds in range(ROUNDS):
        net, slope = real(port.inflow(x) - lost), real(port.gain(x))
        low, high = where(net <= 0, x, low), where(net >= 0, x, high)
        rises = slope > 0
        tried = x - net / where(rises, slope, 1.0)
        tried = where(rises & (tried >= low) & (tried <= high), tried, 0.5 * (low + high))
        active = absolute(tried - x) > SETTLED * most
        if rounds >= FEWEST and finished(active):
            break
        x = where(active, tried, x)
    net, slope = port.inflow(x) - lost, port.gain(x)
    rises = real(slope) > 0
    return clip(
        x - where(rises, net / where(rises, slope, 1.0), 0 * net), -spool.stroke, spool.stroke
    )


class _Ways(NamedTuple):
    """Flow gain and conductance of a chamber that is fed and drained; conductance if it is held."""

    fed: tuple[Array, Array]
    drained: tuple[Array, Array]
    held: Array


class BothSlopes(NamedTuple):
    """Small-signal flows of a valve that drives the load either way, and of one that holds it."""

    extending: ValveSlopes
    retracting: ValveSlopes
    held_a: Array
    """Flow out of chamber A per unit of pressure in A, where the spool holds the load
    [m^3/s/Pa]."""
    held_b: Array


def lapped_slopes(
    *,
    spool: LappedSpool,
    supply_pressure: Array,
    return_pressure: Array,
    pressure_a: Array,
    pressure_b: Array,
    piston_leakage: Array = 0.0,
) -> BothSlopes:
    """Small-signal model of a lapped spool that holds a load, for both directions.

    Each chamber is taken at its `holding_stroke`. If the edge that a direction opens is not open
    there, that direction is taken where this edge begins to open (`LappedSpool.start`): its flow
    gain, and so the loop, is that of the moving spool. Gains and conductances are the slopes of
    both edges of the chamber.

    Parameters
    ----------
    spool : edges, stroke and oil, see `LappedSpool` [SI]
    supply_pressure, return_pressure, pressure_a, pressure_b : gauge [Pa]
    piston_leakage : conductance from A to B [m^3/s/Pa]

    Returns
    -------
    for each direction: flow gains into A and out of B [m^3/s/V], conductances of A and B; and
    the conductances where the load is held [m^3/s/Pa]

    Notes
    -----
    Valid: small motion about the held load.

    With unequal edges no single position balances both chambers at the stated pressures; each
    chamber is then taken at its own.

    References
    ----------
    [Merritt1967] null coefficients of spool valves, recalled; [derived] slopes of `lapped_flows`

    Examples
    --------
    An open centre has twice the flow gain of a critical one:

    >>> for overlap in (0.0, -20e-6):
    ...     edge = SpoolEdge(overlap=overlap, area_gradient=20e-3)
    ...     spool = LappedSpool(edge, edge, edge, edge, 1e-3, 10.0, 870.0, 0.03)
    ...     slopes = lapped_slopes(spool=spool, supply_pressure=14e6, return_pressure=0.0,
    ...                            pressure_a=7e6, pressure_b=7e6).extending
    ...     print(f"{slopes.gain_a * 60000:.3f} l/min/V, {slopes.conductance_a:.3e}")
    9.301 l/min/V, 0.000e+00
    18.602 l/min/V, 4.429e-12
    """
    past = piston_leakage * (pressure_a - pressure_b)

    def both_ways(chamber: str, pressure: Array, lost: Array) -> _Ways:
        """Gains and conductances of a chamber that is fed, drained and held."""
        into, out = supply_pressure - pressure, pressure - return_pressure
        port = _port(spool, chamber, into, out)
        held = holding_stroke(spool=spool, chamber=chamber, into=into, out=out, lost=lost)
        fed = maximum(held, spool.start(port.supply))
        drained = minimum(held, -spool.start(port.tank))
        return _Ways(
            (
                port.gain(fed, feeds=True) * stroke_slope(spool=spool, place=fed),
                port.conductance(fed),
            ),
            (
                port.gain(drained, drains=True) * stroke_slope(spool=spool, place=drained),
                port.conductance(drained),
            ),
            port.conductance(held),
        )

    a, b = both_ways("a", pressure_a, past), both_ways("b", pressure_b, -past)

    def slopes(of_a: tuple[Array, Array], of_b: tuple[Array, Array]) -> ValveSlopes:
        return ValveSlopes(of_a[0], of_b[0], of_a[1], of_b[1])

    return BothSlopes(slopes(a.fed, b.drained), slopes(a.drained, b.fed), a.held, b.held)
