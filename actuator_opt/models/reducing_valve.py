"""Pressure reducing valve in the time domain; it relieves when its line exceeds the set pressure.

Its small signals are those of `line_ends.reducing_valve_end`.
"""

from __future__ import annotations

from math import pi

from ..base.numeric import Array, maximum, minimum


def reducing_valve_acceleration(
    *,
    flow: Array,
    rate: Array,
    pressure: Array,
    set_pressure: Array,
    conductance: Array,
    natural_frequency: Array,
    damping_ratio: Array,
) -> Array:
    """Second-order spool of the valve, q'' = w^2 (G (p_set - p) - q) - 2 zeta w q'.

    The state has no limits: it may run past what `reducing_valve_flow` lets through and takes part
    of a period to come back.

    Parameters
    ----------
    flow : q, flow that the spool regulates, into the line [m^3/s]
    rate : q' [m^3/s^2]
    pressure : p of the line it holds [Pa]
    set_pressure : p_set [Pa]
    conductance : G, flow per pressure the spool regulates with [m^3/s/Pa]
    natural_frequency : w/(2 pi) [Hz]
    damping_ratio : zeta [-]

    Returns
    -------
    second derivative of the flow [m^3/s^3]

    Notes
    -----
    Valid: constant supply well above the set pressure.

    References
    ----------
    [AaltoThesis] section 5.2, the suspect of its 20 Hz peak; [derived] second-order spool

    Examples
    --------
    >>> valve = {"conductance": 1e-10, "natural_frequency": 20.0, "damping_ratio": 0.3}
    >>> line = {"pressure": 59e5, "set_pressure": 60e5}
    >>> print(f"{reducing_valve_acceleration(flow=0.0, rate=0.0, **line, **valve):.4f} m^3/s^3")
    0.1579 m^3/s^3
    """
    omega = 2 * pi * natural_frequency
    return omega * (
        omega * (conductance * (set_pressure - pressure) - flow) - 2 * damping_ratio * rate
    )


def reducing_valve_flow(
    *,
    flow: Array,
    pressure: Array,
    set_pressure: Array,
    largest_flow: Array,
    passive_conductance: Array = 0.0,
) -> Array:
    """Flow of the valve into its line, min(max(q, -q_max), q_max) + g (p_set - p).

    A negative flow relieves the line to the tank.

    Parameters
    ----------
    flow : q, state of `reducing_valve_acceleration` [m^3/s]
    pressure : p of the line it holds [Pa]
    set_pressure : p_set [Pa]
    largest_flow : q_max of the fully open spool, both ways [m^3/s]
    passive_conductance : g of its opening [m^3/s/Pa]

    Returns
    -------
    flow into the line [m^3/s]

    Notes
    -----
    Valid: three-way valve; as large a flow to the tank as from the supply.

    References
    ----------
    [derived] time-domain form of `line_ends.reducing_valve_end`, fully open at q_max

    Examples
    --------
    >>> for flow in (-2e-3, 3e-4):
    ...     print(reducing_valve_flow(flow=flow, pressure=60e5, set_pressure=60e5,
    ...                               largest_flow=1e-3))
    -0.001
    0.0003
    """
    regulated = minimum(largest_flow, maximum(-largest_flow, flow))  # NaN stays
    return regulated + passive_conductance * (set_pressure - pressure)
