"""Pressure supply: relief valve, pressure-controlled pump, pressure reducing valve.

Pressures are gauge, or relative to the tank. A supply line of volume V_S and bulk modulus K closes
the loop: (V_S/K) dp_S/dt = delivery - relief flow - demand. Accumulators are in `accumulator`. The
reducing valve lets oil out of its line to the tank when the line exceeds the set pressure;
`line_ends.reducing_valve_end` is its small-signal form.
"""

from __future__ import annotations

from math import pi

from ..base.numeric import Array, clip, maximum, minimum, positive, sqrt


def relief_flow(
    *,
    pressure_difference: Array,
    cracking_pressure: Array,
    override: Array,
    rated_flow: Array,
) -> Array:
    """Flow of a relief valve, q = q_r min(x, 1) sqrt(dp/(p_c + dp_o)), x = (dp - p_c)/dp_o.

    The area grows in proportion to the pressure above cracking. The valve is fully open at the
    rated flow (our choice: the data sheet's last point) and is a plain orifice above it.

    Parameters
    ----------
    pressure_difference : dp, pressure of the line minus tank pressure [Pa], either sign
    cracking_pressure : p_c, at which the valve begins to open [Pa], >= 0
    override : dp_o, pressure above cracking at the rated flow [Pa], > 0
    rated_flow : q_r [m^3/s]

    Returns
    -------
    flow to the tank [m^3/s]; 0 below cracking; NaN where the override is not positive

    Notes
    -----
    Valid: steady state or changes slower than the poppet; turbulent seat, no hysteresis.

    References
    ----------
    [Merritt1967] orifice law; [derived] opening in proportion to the pressure above cracking

    Examples
    --------
    >>> for pressure in (140e5, 145e5, 150e5):
    ...     q = relief_flow(pressure_difference=pressure, cracking_pressure=140e5, override=10e5,
    ...                     rated_flow=40 / 60000)
    ...     print(f"{q * 60000:.2f} l/min")
    0.00 l/min
    19.66 l/min
    40.00 l/min
    """
    span = positive(override)
    opened = clip((pressure_difference - cracking_pressure) / span, 0.0, 1.0)
    root = sqrt(maximum(pressure_difference, 0.0) / (cracking_pressure + span))
    return rated_flow * opened * root


def controlled_pump_rate(
    *, flow: Array, pressure: Array, set_pressure: Array, gain: Array, time_constant: Array
) -> Array:
    """Rate of the flow of a pressure-controlled pump, dq/dt = (K_p (p_set - p_S) - q)/tau.

    In steady state the pump delivers q at the pressure p_set - q/K_p. The state q has no limits: it
    may exceed the flow to which `controlled_pump_delivery` limits the pump, and then takes a few
    tau to return.

    Parameters
    ----------
    flow : q, state of the pump [m^3/s]
    pressure : p_S of the supply line [Pa]
    set_pressure : p_set, at which the pump delivers no flow [Pa]
    gain : K_p, change of flow per unit pressure [m^3/s/Pa]
    time_constant : tau [s], > 0

    Returns
    -------
    rate of the flow [m^3/s^2]; NaN where the time constant is not positive

    Notes
    -----
    Valid: one lag for controller and swash plate; constant shaft speed.

    References
    ----------
    [MECE5005] pressure controlled pump

    Examples
    --------
    >>> rate = controlled_pump_rate(flow=20 / 60000, pressure=138e5, set_pressure=140e5,
    ...     gain=40 / 60000 / 2e5, time_constant=0.02)
    >>> print(f"{rate * 60000:.0f} l/min/s")
    1000 l/min/s
    """
    return (gain * (set_pressure - pressure) - flow) / positive(time_constant)


def controlled_pump_delivery(*, flow: Array, largest_flow: Array) -> Array:
    """Flow that a pressure-controlled pump delivers, q_P = min(max(q, 0), q_max).

    The swash plate's stops limit the flow.

    Parameters
    ----------
    flow : q, state of the pump [m^3/s]
    largest_flow : q_max, at full displacement and the pump's speed [m^3/s]

    Returns
    -------
    flow into the supply line [m^3/s]

    Notes
    -----
    Valid: no leakage; the pump does not take oil back.

    References
    ----------
    [MECE5005] pressure controlled pump; [derived] ends of the displacement

    Examples
    --------
    >>> for flow in (-1e-4, 2e-4, 9e-4):
    ...     print(controlled_pump_delivery(flow=flow, largest_flow=5e-4))
    0.0
    0.0002
    0.0005
    """
    return clip(flow, 0.0, largest_flow)


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
    """Acceleration q'' of a reducing valve's flow, q'' = w^2 (G (p_set - p) - q) - 2 zeta w q'.

    The spool is a second-order system. The state q has no limits: it may exceed the flow to which
    `reducing_valve_flow` limits the valve, and then takes part of an oscillation to return.

    Parameters
    ----------
    flow : q, flow into the line that the spool regulates [m^3/s]
    rate : q' [m^3/s^2]
    pressure : p of the line whose pressure the valve regulates [Pa]
    set_pressure : p_set [Pa]
    conductance : G, flow per unit pressure error that the spool settles to [m^3/s/Pa]
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
    [AaltoThesis] section 5.2, which suspects this valve of a 20 Hz peak; [derived] second-order
    spool

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
    """Flow of a reducing valve into its line, min(max(q, -q_max), q_max) + g (p_set - p).

    A negative flow relieves the line to the tank.

    Parameters
    ----------
    flow : q, state of `reducing_valve_acceleration` [m^3/s]
    pressure : p of the line whose pressure the valve regulates [Pa]
    set_pressure : p_set [Pa]
    largest_flow : q_max of the fully open spool, in either direction [m^3/s]
    passive_conductance : g, change of flow per unit pressure while the spool stays in place
        [m^3/s/Pa]

    Returns
    -------
    flow into the line [m^3/s]

    Notes
    -----
    Valid: three-way valve that passes as much flow to the tank as from the supply.

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
