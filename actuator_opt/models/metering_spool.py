"""Spool with four metering edges of any law: flows, and held loads.

The spool is at a place x, zero at its centre. An edge is a function of the place that opens it: x
for the edges P-A and B-T, and -x for A-T and P-B.
"""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

from ..base.numeric import Array, absolute, clip, finished, maximum, minimum, real, where
from .holding_valve import ValveSlopes
from .valve import ValveFlows

ROUNDS = 40
"""Most rounds of the search for the spool position that holds a load."""
FEWEST = 10
"""Rounds before that search may end (our choice), so that a recording of the models for one design
also serves designs that need a few rounds more."""
SETTLED = 1e-12
"""Step at which that search ends, as a share of the stroke; one more Newton step follows."""


class MeteringSpool(Protocol):
    """Edges and stroke of a spool: `lapped_spool.LappedSpool`, or `metering_curve.CurveSpool`.

    The unit of a place is that of the stroke: m, or a share of the full signal.
    """

    @property
    def supply_a(self) -> Any:
        """Edge P-A; its `overlap` is the place at which it opens."""

    @property
    def supply_b(self) -> Any:
        """Edge P-B."""

    @property
    def a_tank(self) -> Any:
        """Edge A-T."""

    @property
    def b_tank(self) -> Any:
        """Edge B-T."""

    @property
    def stroke(self) -> Array:
        """Largest distance from the centre."""

    @property
    def full_signal(self) -> Array:
        """Signal at the full stroke [V]."""

    def start(self, edge: Any) -> Array:
        """Place at which an edge counts as open in the linear model."""

    def opened(self, edge: Any) -> Array:
        """Place at which an edge is open beyond its leakage."""

    def signal_share(self, stroke: float) -> float:
        """Largest share of the full signal at which the spool is no farther than a place."""

    def position(self, signal: Array) -> Array:
        """Place of the spool at a signal [V]."""

    def position_slope(self, place: Array) -> Array:
        """Slope of the place over the signal [1/V, times the unit of a place]."""

    def edge_flow(self, edge: Any, place: Array, drop: Array) -> Array:
        """Flow through an edge at a place that opens it, and at a pressure drop [m^3/s]."""

    def edge_gain(self, edge: Any, place: Array, drop: Array, *, opens: bool = False) -> Array:
        """Slope of that flow over the place; `opens`: the edge is about to open."""

    def edge_conductance(self, edge: Any, place: Array, drop: Array) -> Array:
        """Slope of that flow over the pressure drop [m^3/s/Pa]."""


def spool_flows(
    *,
    spool: MeteringSpool,
    signal: Array,
    supply_pressure: Array,
    return_pressure: Array,
    pressure_a: Array,
    pressure_b: Array,
) -> ValveFlows:
    """Flows of the four edges at a signal and four pressures, each by the law of its edge.

    Parameters
    ----------
    spool : edges, stroke and signal, see `MeteringSpool` [SI]
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
    >>> from actuator_opt.models.lapped_spool import LappedSpool, SpoolEdge
    >>> edge = SpoolEdge(overlap=0.0, area_gradient=20e-3)
    >>> spool = LappedSpool(edge, edge, edge, edge, 1e-3, 10.0, 870.0, 0.03)
    >>> flows = spool_flows(spool=spool, signal=1.0, supply_pressure=140e5, return_pressure=0.0,
    ...                      pressure_a=70e5, pressure_b=70e5)
    >>> print(f"{flows.into_a * 60000:.2f} {flows.supply * 60000:.2f} l/min")
    9.30 9.30 l/min
    """
    x = spool.position(signal)
    return ValveFlows(
        spool.edge_flow(spool.supply_a, x, supply_pressure - pressure_a),
        spool.edge_flow(spool.supply_b, -x, supply_pressure - pressure_b),
        spool.edge_flow(spool.a_tank, -x, pressure_a - return_pressure),
        spool.edge_flow(spool.b_tank, x, pressure_b - return_pressure),
    )


class _Port(NamedTuple):
    """A chamber's port: its edge to the supply, its edge to the tank, and their pressure drops."""

    spool: MeteringSpool
    supply: Any
    tank: Any
    into: Array
    out: Array

    def inflow(self, place: Array) -> Array:
        """Flow into the chamber, with the spool moved by `place` to open the supply edge."""
        fed = self.spool.edge_flow(self.supply, place, self.into)
        return fed - self.spool.edge_flow(self.tank, -place, self.out)

    def gain(self, place: Array, *, feeds: bool = False, drains: bool = False) -> Array:
        """Slope of the inflow over the place; never negative.

        `feeds` or `drains` says which edge the spool is about to open.
        """
        fed = self.spool.edge_gain(self.supply, place, self.into, opens=feeds)
        return fed + self.spool.edge_gain(self.tank, -place, self.out, opens=drains)

    def conductance(self, place: Array) -> Array:
        """Flow out of the chamber per pressure in it."""
        fed = self.spool.edge_conductance(self.supply, place, self.into)
        return fed + self.spool.edge_conductance(self.tank, -place, self.out)


def _port(spool: MeteringSpool, chamber: str, into: Array, out: Array) -> _Port:
    """The port of chamber a or b, at pressure drops of which none is negative."""
    edges = (spool.supply_a, spool.a_tank) if chamber == "a" else (spool.supply_b, spool.b_tank)
    return _Port(spool, *edges, *(where(real(drop) > 0, drop, 0 * drop) for drop in (into, out)))


def holding_stroke(
    *, spool: MeteringSpool, chamber: str, into: Array, out: Array, lost: Array = 0.0
) -> Array:
    """Spool position at which as much oil enters a chamber as leaves it.

    The inflow q_in(x) - q_out(x) - q rises with the stroke x that opens the supply edge. A Newton
    search between two bounds, which halves them where a step leaves them, finds its zero; one more
    step carries the derivative.

    Parameters
    ----------
    spool : edges, stroke and signal, see `MeteringSpool` [SI]
    chamber : "a" or "b" [-]
    into, out : pressure drops p_S - p and p - p_T [Pa]
    lost : flow q that leaves the chamber past the piston [m^3/s]

    Returns
    -------
    place in the direction that feeds the chamber [unit of the stroke]; the full stroke where none
    is enough; any position within the lap if nothing flows there

    Notes
    -----
    Valid: a load held still by the valve.

    With matched edges, one position balances both chambers at p_A + p_B = p_S + p_T.

    References
    ----------
    [derived] continuity of a chamber at rest

    Examples
    --------
    >>> from actuator_opt.models.lapped_spool import LappedSpool, SpoolEdge
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


def held_slopes(
    *,
    spool: MeteringSpool,
    supply_pressure: Array,
    return_pressure: Array,
    pressure_a: Array,
    pressure_b: Array,
    piston_leakage: Array = 0.0,
) -> BothSlopes:
    """Small-signal model of a spool that holds a load, for both directions.

    Each chamber is taken at its `holding_stroke`. If the edge that a direction opens is not open
    there, that direction is taken where this edge begins to open (`MeteringSpool.start`): its flow
    gain, and so the loop, is that of the moving spool. Gains and conductances are the slopes of
    both edges of the chamber.

    Parameters
    ----------
    spool : edges, stroke and signal, see `MeteringSpool` [SI]
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
    [Merritt1967] null coefficients of spool valves, recalled; [derived] slopes of `spool_flows`

    Examples
    --------
    An open centre has twice the flow gain of a critical one:

    >>> from actuator_opt.models.lapped_spool import LappedSpool, SpoolEdge
    >>> for overlap in (0.0, -20e-6):
    ...     edge = SpoolEdge(overlap=overlap, area_gradient=20e-3)
    ...     spool = LappedSpool(edge, edge, edge, edge, 1e-3, 10.0, 870.0, 0.03)
    ...     slopes = held_slopes(spool=spool, supply_pressure=14e6, return_pressure=0.0,
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
                port.gain(fed, feeds=True) * spool.position_slope(fed),
                port.conductance(fed),
            ),
            (
                port.gain(drained, drains=True) * spool.position_slope(drained),
                port.conductance(drained),
            ),
            port.conductance(held),
        )

    a, b = both_ways("a", pressure_a, past), both_ways("b", pressure_b, -past)

    def slopes(of_a: tuple[Array, Array], of_b: tuple[Array, Array]) -> ValveSlopes:
        return ValveSlopes(of_a[0], of_b[0], of_a[1], of_b[1])

    return BothSlopes(slopes(a.fed, b.drained), slopes(a.drained, b.fed), a.held, b.held)
