"""Valve that holds a load at rest: how far its edges open, and its small-signal flows."""

from __future__ import annotations

from typing import NamedTuple

from ..base.numeric import Array, maximum, minimum, real, where
from .valve import edge_conductance, edge_flow

LEAST = 1e-12
"""An edge counts as able to pass oil only if its flow per unit flow coefficient exceeds this value
[sqrt(Pa)]. In `valve.edge_flow`, which is linear near zero, a drop of 1e-10 Pa causes this flow."""


class FeedingEdges(NamedTuple):
    """Flow coefficients of a chamber's two valve edges while it holds a load [m^3/s/sqrt(Pa)]."""

    supply: Array
    tank: Array


def feeding_edges(
    *,
    rated_coefficient: Array,
    leakage_supply: Array,
    leakage_tank: Array,
    into: Array,
    out: Array,
    lost: Array = 0.0,
) -> FeedingEdges:
    """Flow coefficients of both edges of a chamber at rest, so that oil in and oil out balance.

    One edge only leaks; the other opens as far as necessary. The flows Q_S from the supply and Q_T
    to the tank, and the coefficient K of each edge, are

    Q_S = max(K0s sqrt(into), K0t sqrt(out) + q), Q_T = Q_S - q; K = Q/sqrt(dp), at most K10.

    Parameters
    ----------
    rated_coefficient : K10 [m^3/s/sqrt(Pa)]
    leakage_supply, leakage_tank : K0s and K0t, leakage coefficients of the edges to supply and to
        tank [m^3/s/sqrt(Pa)]
    into, out : pressure drops p_S - p and p - p_T [Pa]
    lost : flow q that leaves the chamber past the piston [m^3/s]

    Returns
    -------
    K of both edges [m^3/s/sqrt(Pa)]; K10 for an edge without pressure drop

    Notes
    -----
    Valid: a load held still by the valve.

    With matched edges one signal balances both chambers at p_A + p_B = p_S + p_T, whatever flow
    leaks past the piston, so the pressures of `stiffness.holding_pressures` stay exact.

    References
    ----------
    [derived] continuity of a chamber at rest; [MECE5005] model for a control edge

    Examples
    --------
    >>> found = feeding_edges(rated_coefficient=3.6e-7, leakage_supply=1e-9, leakage_tank=1e-9,
    ...                       into=1e6, out=9e6)
    >>> print(f"{found.supply:.3e} {found.tank:.3e}")
    3.000e-09 1.000e-09
    """
    unit_in = edge_flow(coefficient=1.0, pressure_drop=into)
    unit_out = edge_flow(coefficient=1.0, pressure_drop=out)
    supplied = maximum(leakage_supply * unit_in, leakage_tank * unit_out + lost)

    def opened(flow: Array, unit: Array) -> Array:
        feeds = real(unit) > LEAST
        wanted = flow / where(feeds, unit, 1.0)
        return where(feeds, minimum(rated_coefficient, wanted), rated_coefficient)

    return FeedingEdges(opened(supplied, unit_in), opened(supplied - lost, unit_out))


class ValveSlopes(NamedTuple):
    """Small-signal flows about a held load, for one direction of the spool.

    With the spool signal u, the flow into A changes by dq_A = G_A du - C_A dp_A, and the flow out
    of B by dq_B = G_B du + C_B dp_B.
    """

    gain_a: Array
    """Flow into chamber A per unit of spool signal [m^3/s/V]."""
    gain_b: Array
    """Flow out of chamber B per unit of spool signal [m^3/s/V]."""
    conductance_a: Array
    """Flow out of chamber A through both of its edges, per unit of pressure in A [m^3/s/Pa]."""
    conductance_b: Array


def valve_slopes(
    *,
    rated_coefficient: Array,
    leakage_coefficient: Array,
    signal: Array,
    supply_pressure: Array,
    return_pressure: Array,
    pressure_a: Array,
    pressure_b: Array,
    extending: Array,
    leakage_tank: Array | None = None,
    piston_leakage: Array = 0.0,
) -> ValveSlopes:
    """Small-signal model of a valve that holds a load, in the direction in which its spool opens.

    K(U) = K0 + (K10 - K0)|U|/U_max on opening edges, so G = ((K10 - K0)/U_max) sqrt(dp) of the edge
    that opens: P-A and B-T extending, A-T and P-B retracting. The conductance of a chamber is that
    of both its edges. If opening in this direction makes up for the leakage, the conductance is
    taken at the spool position that holds the load (`feeding_edges`). Otherwise it is taken at the
    centre of the spool, where the load slowly drifts. For a chamber that is held, call the function
    for both directions and take the larger conductance.

    Parameters
    ----------
    rated_coefficient, leakage_coefficient : K10 and K0 [m^3/s/sqrt(Pa)]
    signal : U_max, at which the edge has the rated coefficient [V]
    supply_pressure, return_pressure, pressure_a, pressure_b : gauge [Pa]
    extending : True for U > 0 (P to A, B to T) [-]
    leakage_tank : K0 of A-T and B-T, if it differs from that of P-A and P-B [m^3/s/sqrt(Pa)]
    piston_leakage : conductance from A to B [m^3/s/Pa]

    Returns
    -------
    flow gains into A and out of B [m^3/s/V], conductances of A and B [m^3/s/Pa]

    Notes
    -----
    Valid: spool near its centre, no overlap; laminar leakage would damp twice as much.

    References
    ----------
    [MECE5005] flow rates in a proportional control valve; [derived] linearised

    Examples
    --------
    >>> slopes = valve_slopes(rated_coefficient=3.5635e-7, leakage_coefficient=1.0607e-9,
    ...     signal=10.0, supply_pressure=14e6, return_pressure=0.0, pressure_a=7e6,
    ...     pressure_b=7e6, extending=True)
    >>> print(f"{slopes.gain_a * 60000:.3f} l/min/V, {slopes.conductance_a:.3e}")
    5.640 l/min/V, 4.009e-13
    """
    tank = leakage_coefficient if leakage_tank is None else leakage_tank
    slope_supply = (rated_coefficient - leakage_coefficient) / signal
    slope_tank = (rated_coefficient - tank) / signal
    into_a, from_a = supply_pressure - pressure_a, pressure_a - return_pressure
    into_b, from_b = supply_pressure - pressure_b, pressure_b - return_pressure
    drop_a = where(extending, into_a, from_a)
    drop_b = where(extending, from_b, into_b)

    def gain(slope: Array, drop: Array) -> Array:
        return edge_flow(coefficient=slope, pressure_drop=where(real(drop) > 0, drop, 0 * drop))

    past = piston_leakage * (pressure_a - pressure_b)

    def conductances(into: Array, out: Array, lost: Array) -> tuple[Array, Array]:
        """Two conductances of a chamber: its supply edge may open, or its tank edge may open."""
        edges = feeding_edges(
            rated_coefficient=rated_coefficient,
            leakage_supply=leakage_coefficient,
            leakage_tank=tank,
            into=into,
            out=out,
            lost=lost,
        )
        fed, leaks = (
            edge_conductance(coefficient=one, pressure_drop=into)
            for one in (edges.supply, leakage_coefficient)
        )
        drained, drips = (
            edge_conductance(coefficient=one, pressure_drop=out) for one in (edges.tank, tank)
        )
        return fed + drips, leaks + drained

    fed_a, drained_a = conductances(into_a, from_a, past)
    fed_b, drained_b = conductances(into_b, from_b, -past)
    return ValveSlopes(
        gain(where(extending, slope_supply, slope_tank), drop_a),
        gain(where(extending, slope_tank, slope_supply), drop_b),
        where(extending, fed_a, drained_a),
        where(extending, drained_b, fed_b),
    )
