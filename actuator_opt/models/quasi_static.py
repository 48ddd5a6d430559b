"""Pressures, speed limit and least supply pressure of a cylinder that moves quasi-statically.

A valve with four metering edges drives the cylinder: one edge feeds the driven chamber, another
drains the other chamber, and both open by the same share. Pressures follow force and direction;
they do not depend on the speed. All pressures are gauge.
"""

from __future__ import annotations

from typing import NamedTuple

from ..base.numeric import Array, absolute, geometry, positive, sqrt


class DrivenPressures(NamedTuple):
    """Pressures while a valve drives a load."""

    edge_drop: Array
    """Pressure drop of the edge that feeds the driven chamber [Pa]; negative past stall."""
    driven: Array
    """Pressure in the driven chamber [Pa]."""
    other: Array
    """Pressure in the other chamber [Pa]."""


@geometry
def edge_ratio(
    *, driven_area: Array, other_area: Array, feed_coefficient: Array, drain_coefficient: Array
) -> Array:
    """Pressure drop of the draining edge, divided by that of the feeding edge.

    c = (A_o K_f/(A_d K_r))^2: both edges pass the flow of the same piston speed.

    Parameters
    ----------
    driven_area, other_area : A_d, A_o of the driven and the other chamber [m^2]
    feed_coefficient, drain_coefficient : K_f, K_r of the fully open edges [m^3/s/sqrt(Pa)]

    Returns
    -------
    ratio [-]; NaN where an area or coefficient is not positive

    Notes
    -----
    Valid: turbulent edges that open by the same share of their stroke.

    References
    ----------
    [derived] continuity; [Merritt1967] chapter 6 has the case of equal edges

    Examples
    --------
    >>> c = edge_ratio(
    ...     driven_area=4e-4, other_area=3e-4, feed_coefficient=1e-7, drain_coefficient=1e-7
    ... )
    >>> print(f"{c:.4f}")
    0.5625
    """
    share = other_area * feed_coefficient
    share = share / positive(driven_area * drain_coefficient)
    return share * share


@geometry
def driven_pressures(
    *,
    load: Array,
    supply_pressure: Array,
    return_pressure: Array,
    driven_area: Array,
    other_area: Array,
    ratio: Array,
) -> DrivenPressures:
    """Chamber pressures while the valve drives a load.

    D = (p_s A_d - p_T A_o - P)/(A_d + c A_o), p_d = p_s - D, p_o = p_T + c D.

    Parameters
    ----------
    load : P, force of load and friction against the motion [N]; negative: the load helps
    supply_pressure, return_pressure : p_s, p_T [Pa]
    driven_area, other_area : A_d, A_o [m^2]
    ratio : c, result of `edge_ratio` [-]

    Returns
    -------
    drop of the feeding edge, pressure of the driven and of the other chamber [Pa]

    Notes
    -----
    Valid: incompressible oil, no spool dynamics, critical centre of the valve.

    A negative drop marks a load that stalls the cylinder; a negative chamber pressure marks a load
    that overruns it.

    References
    ----------
    [derived] force balance and continuity

    Examples
    --------
    >>> p = driven_pressures(load=1000.0, supply_pressure=210e5, return_pressure=5e5,
    ...                      driven_area=4.15476e-4, other_area=2.82743e-4, ratio=0.463120)
    >>> print(f"{p.edge_drop / 1e6:.3f} {p.driven / 1e6:.3f} {p.other / 1e6:.3f} MPa")
    13.879 7.121 6.928 MPa
    """
    spare = supply_pressure * driven_area - return_pressure * other_area - load
    drop = spare / (driven_area + ratio * other_area)
    return DrivenPressures(drop, supply_pressure - drop, return_pressure + ratio * drop)


@geometry
def speed_limit(*, edge_drop: Array, driven_area: Array, feed_coefficient: Array) -> Array:
    """Speed of the piston with the valve fully open, v = K_f sqrt(D)/A_d.

    Parameters
    ----------
    edge_drop : D of the feeding edge [Pa]
    driven_area : A_d [m^2]
    feed_coefficient : K_f [m^3/s/sqrt(Pa)]

    Returns
    -------
    speed [m/s]; NaN past stall

    Notes
    -----
    Valid: turbulent edge.

    References
    ----------
    [derived] orifice law and continuity

    Examples
    --------
    >>> v = speed_limit(edge_drop=13.8787e6, driven_area=4.15476e-4, feed_coefficient=8.90871e-8)
    >>> print(f"{v:.4f} m/s")
    0.7988 m/s
    """
    return feed_coefficient * sqrt(edge_drop) / driven_area


@geometry
def needed_supply(
    *,
    load: Array,
    speed: Array,
    return_pressure: Array,
    driven_area: Array,
    other_area: Array,
    ratio: Array,
    feed_coefficient: Array,
    opening: Array = 1.0,
) -> Array:
    """Least supply pressure that moves a load at a speed.

    p = [P + p_T A_o + (A_d + c A_o)(A_d v/(K_f y))^2]/A_d, a parabola in the speed, smooth past
    stall. The force reserve at a supply pressure p_s is (p_s - p) A_d.

    Parameters
    ----------
    load : P, force of load and friction against the motion [N]; negative: the load helps
    speed : v, of the motion [m/s], any sign
    return_pressure : p_T [Pa]
    driven_area, other_area : A_d, A_o [m^2]
    ratio : c, result of `edge_ratio` [-]
    feed_coefficient : K_f of the fully open edge [m^3/s/sqrt(Pa)]
    opening : y, largest permitted opening as a share of the stroke of the spool [-]

    Returns
    -------
    pressure, gauge [Pa]; negative for a load that moves itself

    Notes
    -----
    Valid: as `driven_pressures`.

    References
    ----------
    [derived] `driven_pressures` and `speed_limit`, solved for the supply pressure

    Examples
    --------
    >>> p = needed_supply(load=1000.0, speed=0.38, return_pressure=5e5, driven_area=4.15476e-4,
    ...                   other_area=2.82743e-4, ratio=0.463120, feed_coefficient=8.90871e-8,
    ...                   opening=0.9)
    >>> print(f"{p / 1e6:.4f} MPa")
    7.8466 MPa
    """
    flow = driven_area * absolute(speed) / (feed_coefficient * opening)
    drop = (driven_area + ratio * other_area) * flow * flow
    return (load + return_pressure * other_area + drop) / driven_area
