"""Spool of a proportional valve: its motion, and the opening of its edges."""

from __future__ import annotations

from math import pi

from ..base.numeric import Array, geometry, maximum, positive, sqrt
from .orifice import TURBULENT_COEFFICIENT


def spool_acceleration(
    *, command: Array, opening: Array, rate: Array, natural_frequency: Array, damping_ratio: Array
) -> Array:
    """Second-order spool, o'' = w^2 (u - o) - 2 zeta w o', with its position o in volts.

    Parameters
    ----------
    command, opening, rate : u to the valve [V], o of the spool [V] and o' [V/s]
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


@geometry
def spool_edge_coefficient(
    *,
    spool_position: Array,
    overlap: Array,
    spool_diameter: Array,
    share: Array,
    density: Array,
    flow_coefficient: Array = TURBULENT_COEFFICIENT,
) -> Array:
    """Coefficient of an edge from the spool's geometry, K = C_q f pi d sqrt(2/rho) max(x - x0, 0).

    Parameters
    ----------
    spool_position : x from the centre (-x for an edge that the opposite stroke opens) [m]
    overlap, spool_diameter : x0 (negative: open at the centre) and d [m]
    share, flow_coefficient : f, open part of the circumference, and C_q [-]
    density : rho [kg/m^3], > 0

    Returns
    -------
    K [m^3/s/sqrt(Pa)]; NaN where the density is not positive

    Notes
    -----
    Valid: turbulent sharp edges; no leakage through the overlap.

    References
    ----------
    [AaltoThesis] eq. 9; [derived] area of a ring of ports, f pi d (x - x0)

    Examples
    --------
    >>> spool = {"spool_diameter": 10e-3, "share": 0.5, "overlap": 0.1e-3}
    >>> print(f"{spool_edge_coefficient(spool_position=6e-4, density=870.0, **spool):.4e}")
    2.3008e-07
    """
    uncovered = maximum(0.0, spool_position - overlap)  # NaN stays
    return flow_coefficient * share * pi * spool_diameter * uncovered * sqrt(2 / positive(density))
