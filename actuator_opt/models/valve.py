"""Proportional valve of four alike edges: flow of an edge, centre conductance, flow gains."""

from __future__ import annotations

from typing import NamedTuple

from ..numeric import Array, positive, real, sqrt, where

SMOOTHING = 1e4
"""Pressure difference below which an edge is laminar (Pa): a choice, 0.1 bar."""


def edge_coefficient(*, flow: Array, pressure_drop: Array) -> Array:
    """Coefficient of an edge from its data-sheet point, K = q/sqrt(dp).

    Parameters
    ----------
    flow : rated (or leakage) flow through one edge [m^3/s]
    pressure_drop : over that edge [Pa], > 0

    Returns
    -------
    K [m^3/s/sqrt(Pa)]; NaN where the pressure drop is not positive

    Notes
    -----
    Valid: turbulent edges at the viscosity of the data sheet.

    References
    ----------
    [MECE5005] K values for orifices from valve data sheet

    Examples
    --------
    >>> print(f"{edge_coefficient(flow=40 / 60000, pressure_drop=35e5):.4e}")
    3.5635e-07
    """
    return flow / sqrt(positive(pressure_drop))


def edge_flow(*, coefficient: Array, pressure_drop: Array) -> Array:
    """Flow through an edge, q = K dp/(dp^2 + delta^2)^(1/4): K sqrt(|dp|) sgn dp, smooth at zero.

    Parameters
    ----------
    coefficient : K of the edge at its opening [m^3/s/sqrt(Pa)]
    pressure_drop : either sign [Pa]

    Returns
    -------
    flow with the sign of the pressure drop [m^3/s]

    Notes
    -----
    Valid: |dp| well above delta = 0.1 bar for the plain square root.

    References
    ----------
    [MECE5005] model for a control edge; [derived] smoothing at zero

    Examples
    --------
    >>> q = edge_flow(coefficient=3.5635e-7, pressure_drop=35e5)
    >>> print(f"{q * 60000:.2f} l/min")
    40.00 l/min
    """
    root = sqrt(sqrt(pressure_drop * pressure_drop + SMOOTHING * SMOOTHING))
    return coefficient * pressure_drop / root


def edge_conductance(*, coefficient: Array, pressure_drop: Array) -> Array:
    """Slope of an edge's flow, dq/d(dp) = K (dp^2/2 + delta^2)/(dp^2 + delta^2)^(5/4).

    Tends to K/(2 sqrt(|dp|)).

    Parameters
    ----------
    coefficient : K of the edge at its opening [m^3/s/sqrt(Pa)]
    pressure_drop : either sign [Pa]

    Returns
    -------
    conductance [m^3/s/Pa]

    Notes
    -----
    Valid: small changes about the stated pressure drop.

    References
    ----------
    [derived] derivative of `edge_flow`

    Examples
    --------
    >>> print(f"{edge_conductance(coefficient=6.364e-9, pressure_drop=7e6):.4e}")
    1.2027e-12
    """
    square = pressure_drop * pressure_drop
    small = SMOOTHING * SMOOTHING
    whole = square + small
    return coefficient * (0.5 * square + small) / (whole * sqrt(sqrt(whole)))


class ValveSlopes(NamedTuple):
    """Valve linearised at the centre: into chamber A dq_A = G_A du - C_A dp_A, out of B G_B du."""

    gain_a: Array
    """Flow into chamber A per signal [m^3/s/V]."""
    gain_b: Array
    """Flow out of chamber B per signal [m^3/s/V]."""
    conductance_a: Array
    """Flow out of chamber A through the centred edges per its pressure [m^3/s/Pa]."""
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
) -> ValveSlopes:
    """Small-signal model of the centred valve; flow gains differ by direction.

    K(U) = K0 + (K10 - K0)|U|/U_max on opening edges, so G = ((K10 - K0)/U_max) sqrt(dp) of the
    edge that opens: P-A and B-T extending, A-T and P-B retracting. Each chamber's conductance is
    that of both its edges at K0.

    Parameters
    ----------
    rated_coefficient, leakage_coefficient : K10 and K0 [m^3/s/sqrt(Pa)]
    signal : U_max [V]
    supply_pressure, return_pressure, pressure_a, pressure_b : gauge [Pa]
    extending : True for U > 0 (P to A, B to T) [-]

    Returns
    -------
    flow gains into A and out of B [m^3/s/V], conductances of A and B [m^3/s/Pa]

    Notes
    -----
    Valid: spool near its centre, alike edges, no overlap; laminar leakage damps twice as much.

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
    slope = (rated_coefficient - leakage_coefficient) / signal
    into_a, from_a = supply_pressure - pressure_a, pressure_a - return_pressure
    into_b, from_b = supply_pressure - pressure_b, pressure_b - return_pressure
    drop_a = where(extending, into_a, from_a)
    drop_b = where(extending, from_b, into_b)

    def centred(first: Array, second: Array) -> Array:
        return edge_conductance(
            coefficient=leakage_coefficient, pressure_drop=first
        ) + edge_conductance(coefficient=leakage_coefficient, pressure_drop=second)

    return ValveSlopes(
        edge_flow(coefficient=slope, pressure_drop=where(real(drop_a) > 0, drop_a, 0 * drop_a)),
        edge_flow(coefficient=slope, pressure_drop=where(real(drop_b) > 0, drop_b, 0 * drop_b)),
        centred(into_a, from_a),
        centred(into_b, from_b),
    )
