"""Proportional valve with four control edges: flows, effect of viscosity, spool motion, geometry.

An edge is the orifice between two ports. A signal U > 0 opens the edges P to A and B to T; U < 0
opens the edges A to T and P to B.
"""

from __future__ import annotations

from math import pi, sqrt as root
from typing import NamedTuple

from ..base.numeric import Array, clip, geometry, maximum, minimum, positive, real, sqrt, where
from .orifice import TURBULENT_COEFFICIENT

WIDEST = root(1 + root(2.0))
"""Largest ratio of the -3 dB frequency to the natural frequency of a lag of second order, that of
an undamped one: |G|^2 = 1/(1 - r^2)^2 = 1/2."""
SMOOTHING = 1e4
"""Pressure difference below which the flow through an edge is laminar [Pa], our choice: 0.1 bar."""


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
    """Flow through an edge, q = K dp/(dp^2 + delta^2)^(1/4).

    This is K sqrt(|dp|) sgn dp, smoothed about zero pressure drop.

    Parameters
    ----------
    coefficient : K of the edge at its opening [m^3/s/sqrt(Pa)]
    pressure_drop : either sign [Pa]

    Returns
    -------
    flow with the sign of the pressure drop [m^3/s]

    Notes
    -----
    Valid: equal to the plain square root for |dp| well above delta = 0.1 bar.

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

    The slope tends to K/(2 sqrt(|dp|)) far from zero.

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


def edge_opening(
    *, signal: Array, rated_coefficient: Array, leakage_coefficient: Array, full_signal: Array
) -> Array:
    """Coefficient of the edge that a signal opens, K = K0 + (K10 - K0) min(max(U, 0)/U_max, 1).

    Parameters
    ----------
    signal, full_signal : U (-U for an edge that the opposite signal opens), U_max > 0 [V]
    rated_coefficient, leakage_coefficient : K10 and K0 [m^3/s/sqrt(Pa)]

    Returns
    -------
    K [m^3/s/sqrt(Pa)]; NaN where the full signal is not positive

    Notes
    -----
    Valid: no overlap; the opening is proportional to the signal.

    References
    ----------
    [MECE5005] model for a control edge; [derived] leakage and opening add (our choice)

    Examples
    --------
    >>> edge_opening(signal=5.0, rated_coefficient=3e-7, leakage_coefficient=1e-7, full_signal=10.0)
    2e-07
    """
    slope = (rated_coefficient - leakage_coefficient) / positive(full_signal)
    return leakage_coefficient + slope * minimum(full_signal, maximum(0.0, signal))  # NaN stays


class ValveFlows(NamedTuple):
    """Flows of the edges P to A, P to B, A to T and B to T, and of the four ports [m^3/s]."""

    supply_a: Array
    supply_b: Array
    a_tank: Array
    b_tank: Array

    @property
    def into_a(self) -> Array:
        """Flow into chamber A [m^3/s]."""
        return self.supply_a - self.a_tank

    @property
    def into_b(self) -> Array:
        """Flow into chamber B [m^3/s]."""
        return self.supply_b - self.b_tank

    @property
    def supply(self) -> Array:
        """Flow out of the supply line [m^3/s]."""
        return self.supply_a + self.supply_b

    @property
    def tank(self) -> Array:
        """Flow into the return line [m^3/s]."""
        return self.a_tank + self.b_tank


def valve_flows(
    *,
    signal: Array,
    rated_coefficient: Array,
    leakage_supply: Array,
    leakage_tank: Array,
    full_signal: Array,
    supply_pressure: Array,
    return_pressure: Array,
    pressure_a: Array,
    pressure_b: Array,
) -> ValveFlows:
    """Flows of the four edges at a signal and four pressures.

    q_A = q_PA - q_AT, q_B = q_PB - q_BT, q_P = q_PA + q_PB, q_T = q_AT + q_BT.

    Parameters
    ----------
    signal, full_signal : position of the spool, either sign, and U_max > 0 [V]
    rated_coefficient : K10 of every edge [m^3/s/sqrt(Pa)]
    leakage_supply : K0 of the edges P-A and P-B [m^3/s/sqrt(Pa)]
    leakage_tank : K0 of the edges A-T and B-T [m^3/s/sqrt(Pa)]
    supply_pressure, return_pressure, pressure_a, pressure_b : gauge [Pa]

    Returns
    -------
    flows P to A, P to B, A to T, B to T [m^3/s], and their sums at the four ports

    Notes
    -----
    Valid: no overlap, no cavitation in an edge; viscosity of the data sheet.

    References
    ----------
    [MECE5005] flow rates in a proportional control valve; valve leakage parameters, tuning

    Examples
    --------
    >>> flows = valve_flows(signal=10.0, rated_coefficient=3.5635e-7, leakage_supply=3.3541e-9,
    ...     leakage_tank=3.3541e-9, full_signal=10.0, supply_pressure=70e5, return_pressure=0.0,
    ...     pressure_a=35e5, pressure_b=35e5)
    >>> print(f"{flows.into_a * 60000:.2f} {flows.supply * 60000:.2f} l/min")
    39.62 40.38 l/min
    """
    edges = {"rated_coefficient": rated_coefficient, "full_signal": full_signal}

    def edge(opens: Array, leakage: Array, before: Array, after: Array) -> Array:
        opening = edge_opening(signal=opens, leakage_coefficient=leakage, **edges)
        return edge_flow(coefficient=opening, pressure_drop=before - after)

    return ValveFlows(
        edge(signal, leakage_supply, supply_pressure, pressure_a),
        edge(-signal, leakage_supply, supply_pressure, pressure_b),
        edge(-signal, leakage_tank, pressure_a, return_pressure),
        edge(signal, leakage_tank, pressure_b, return_pressure),
    )


def viscosity_corrected(*, coefficient: Array, rated_viscosity: Array, viscosity: Array) -> Array:
    """Coefficient of an edge at another viscosity, K2 = K1 (nu1/nu2)^(1/8).

    The pressure drop at a given flow is proportional to nu^(1/4): 1.189 times at twice the
    viscosity.

    Parameters
    ----------
    coefficient : K1 at the viscosity of the data sheet [m^3/s/sqrt(Pa)]
    rated_viscosity, viscosity : kinematic, nu1 and nu2 [m^2/s], > 0

    Returns
    -------
    K2 [m^3/s/sqrt(Pa)]; NaN where a viscosity is not positive

    Notes
    -----
    Valid: 10 to 800 mm^2/s, fixed opening.

    References
    ----------
    [MECE5005] viscosity and valve capacity

    Examples
    --------
    >>> print(f"{viscosity_corrected(coefficient=1.0, rated_viscosity=32e-6, viscosity=64e-6):.4f}")
    0.9170
    """
    ratio = positive(rated_viscosity) / positive(viscosity)
    return coefficient * sqrt(sqrt(sqrt(ratio)))


def spool_acceleration(
    *, command: Array, opening: Array, rate: Array, natural_frequency: Array, damping_ratio: Array
) -> Array:
    """Acceleration of a second-order spool, o'' = w^2 (u - o) - 2 zeta w o', with o in volts.

    Parameters
    ----------
    command : u, command to the valve [V]
    opening, rate : position o of the spool [V] and its speed o' [V/s]
    natural_frequency, damping_ratio : w/(2 pi) [Hz] and zeta [-]

    Returns
    -------
    acceleration of the spool [V/s^2]

    Notes
    -----
    Valid: below the limits of stroke and speed of the spool.

    References
    ----------
    [derived] second-order lag, as in `loop.open_loop`

    Examples
    --------
    >>> spool = {"natural_frequency": 50 / pi, "damping_ratio": 0.7}  # 100 rad/s
    >>> round(spool_acceleration(command=1.0, opening=0.4, rate=10.0, **spool))
    4600
    """
    omega = 2 * pi * natural_frequency
    return omega * (omega * (command - opening) - 2 * damping_ratio * rate)


def limited_spool_acceleration(
    *,
    command: Array,
    opening: Array,
    rate: Array,
    natural_frequency: Array,
    damping_ratio: Array,
    fastest: Array,
) -> Array:
    """Acceleration of a spool whose speed is limited, o'' = 2 zeta w (min(|v|, r) sgn v - o').

    The speed that the spool is driven to is v = w (u - o)/(2 zeta), at most r either way. Below
    the limit this is `spool_acceleration`.

    Parameters
    ----------
    command : u, command to the valve [V]
    opening, rate : position o of the spool [V] and its speed o' [V/s]
    natural_frequency, damping_ratio : w/(2 pi) [Hz] and zeta > 0 [-]
    fastest : r, largest speed of the spool [V/s]

    Returns
    -------
    acceleration of the spool [V/s^2]

    Notes
    -----
    Valid: the speed approaches its limit with the time constant 1/(2 zeta w).

    References
    ----------
    [derived] second-order lag as a lag of first order of the speed; our choice of the limited term

    Examples
    --------
    >>> spool = {"natural_frequency": 50 / pi, "damping_ratio": 0.7}  # 100 rad/s
    >>> law = {"command": 1.0, "opening": 0.4, "rate": 10.0, **spool}
    >>> [round(limited_spool_acceleration(fastest=r, **law)) for r in (100.0, 20.0)]
    [4600, 1400]
    """
    omega = 2 * pi * natural_frequency
    wanted = omega * (command - opening) / (2 * damping_ratio)
    return 2 * damping_ratio * omega * (clip(wanted, -fastest, fastest) - rate)


def spool_bandwidth(*, damping_ratio: Array) -> Array:
    """Frequency at which a lag of second order falls to -3 dB, over its natural frequency.

    r^2 = 1 - 2 zeta^2 + sqrt((1 - 2 zeta^2)^2 + 1), from |G|^2 = 1/2. The phase is -90 degrees at
    the natural frequency itself, whatever the damping.

    Parameters
    ----------
    damping_ratio : zeta [-]

    Returns
    -------
    ratio r [-]

    Notes
    -----
    Valid: small strokes, below the limit of the spool's speed.

    References
    ----------
    [derived] (1 - r^2)^2 + (2 zeta r)^2 = 2

    Examples
    --------
    >>> print(f"{spool_bandwidth(damping_ratio=0.7):.4f}")
    1.0100
    """
    side = 1 - 2 * damping_ratio * damping_ratio
    whole = sqrt(side * side + 1)
    # at high damping side + whole is small: the quotient avoids the cancellation
    return sqrt(where(real(side) > 0, side + whole, 1 / (whole - side)))


def spool_damping(*, bandwidth: Array) -> Array:
    """Damping ratio of a lag of second order, zeta^2 = (2 - (1 - r^2)^2)/(4 r^2).

    This is the reverse of `spool_bandwidth`: r is the -3 dB frequency over the natural frequency.

    Parameters
    ----------
    bandwidth : r, -3 dB frequency over the natural (-90 degrees) frequency [-]

    Returns
    -------
    damping ratio [-]; NaN from `WIDEST` on

    Notes
    -----
    Valid: 0 < r < sqrt(1 + sqrt(2)).

    References
    ----------
    [derived] (1 - r^2)^2 + (2 zeta r)^2 = 2

    Examples
    --------
    >>> print(f"{spool_damping(bandwidth=1.0100):.4f}")
    0.7000
    """
    square = bandwidth * bandwidth
    return sqrt((2 - (1 - square) * (1 - square)) / (4 * positive(square)))


@geometry
def spool_edge_coefficient(
    *,
    spool_position: Array,
    overlap: Array,
    area_gradient: Array,
    density: Array,
    flow_coefficient: Array = TURBULENT_COEFFICIENT,
) -> Array:
    """Coefficient of an edge from the spool's geometry, K = C_q w sqrt(2/rho) max(x - x0, 0).

    Parameters
    ----------
    spool_position : x from the centre (-x for an edge that the opposite stroke opens) [m]
    overlap : x0 (negative if the edge is open at the centre) [m]
    area_gradient : w, width of the ports around the spool: f pi d if they take the share f of the
        circumference of a spool of diameter d [m]
    density : rho [kg/m^3], > 0
    flow_coefficient : C_q [-]

    Returns
    -------
    K [m^3/s/sqrt(Pa)]; NaN where the density is not positive

    Notes
    -----
    Valid: turbulent sharp edges; no leakage through the overlap.

    References
    ----------
    [AaltoThesis] eq. 9; [derived] area of a ring of ports, w (x - x0)

    Examples
    --------
    >>> spool = {"area_gradient": 0.5 * pi * 10e-3, "overlap": 0.1e-3}
    >>> print(f"{spool_edge_coefficient(spool_position=6e-4, density=870.0, **spool):.4e}")
    2.3008e-07
    """
    uncovered = maximum(0.0, spool_position - overlap)  # NaN stays
    return flow_coefficient * area_gradient * uncovered * sqrt(2 / positive(density))
