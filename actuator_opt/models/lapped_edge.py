"""A metering edge of a spool with lap and radial clearance: flow, flow gain and conductance.

The land uncovers the port by y (negative: it laps the port). Where the edge is open, it is a slot
whose opening is the distance between the corners of land and port. Where it is lapped, the slot is
followed by an annular gap as long as the lap. Laminar and turbulent pressure drop are in series:

dp = rho q|q|/(2 C^2 w^2 h^2) + (eta/w) [32/(pi h^2) + 12 L/c^3] q.

The first viscous term is that of a long sharp-edged slot [Merritt1967], the second that of a gap
between parallel walls. Without a stated clearance the edge does not leak, and its flow is turbulent
at any opening.
"""

from __future__ import annotations

from math import pi, sqrt as root
from typing import NamedTuple

from ..base.numeric import Array, absolute, geometry, real, sqrt, where
from .orifice import TURBULENT_COEFFICIENT, orifice_conductance, orifice_flow
from .valve import edge_conductance, edge_flow, spool_edge_coefficient

SLOT_COEFFICIENT = root(pi / 128)
"""Laminar coefficient delta of a long sharp-edged slot: q = pi w h^2 dp/(32 eta), 0.157
[Merritt1967], recalled."""
SLOT_DROP = 32 / pi
"""Viscous pressure drop of the slot, times w h^2/(eta q)."""
GAP_DROP = 12.0
"""Viscous pressure drop of the gap, times w c^3/(eta L q)."""
ENTRY = 15 * pi / 32 - 0.5
"""Part of the lap that the slot already contains, in clearances. Derived: with it, an edge of zero
lap leaks exactly as the slot of height c."""


class EdgeGap(NamedTuple):
    """Opening and gap length of an edge, with their slopes over the uncovered length."""

    opening: Array
    """Distance h between the corners [m]."""
    opening_slope: Array
    length: Array
    """Length L of the annular gap [m]."""
    length_slope: Array


@geometry
def edge_gap(*, uncovered: Array, clearance: Array, rounding: Array = 0.0) -> EdgeGap:
    """Opening of an edge, h = sqrt(z_o^2 + (c + 2 r)^2) - 2 r, and length L of its annular gap.

    With corners of radius r, z = y + 2 r, where y is the uncovered length. The open and the lapped
    part of z are z_o, z_l = (sqrt(z^2 + c^2) +- z)/2, which are smooth at the edge. The gap length
    L = z_l^2/(z_l + b c), b = 15 pi/32 - 1/2, tends to the lap less one clearance.

    Parameters
    ----------
    uncovered : y, axial distance by which the land has uncovered the port [m]; negative: lap
    clearance : c, radial, > 0 [m]
    rounding : r, radius of the corners [m]

    Returns
    -------
    opening and gap length [m], and their slopes dh/dy and dL/dy [-]

    Notes
    -----
    Valid: clearance well below the stroke; the smoothing acts within about one clearance.

    References
    ----------
    [Merritt1967] opening sqrt(x^2 + c^2) with clearance, recalled; [derived] distance between two
    round corners; lap and opening joined smoothly (our choice)

    Examples
    --------
    >>> gap = edge_gap(uncovered=50e-6, clearance=3e-6)
    >>> print(f"{gap.opening * 1e6:.2f} um, {gap.length * 1e6:.4f} um")
    50.13 um, 0.0007 um
    """
    width = clearance + 2 * rounding
    z = uncovered + 2 * rounding
    whole = sqrt(z * z + clearance * clearance)
    # the larger part directly, the smaller from their product c^2/4: no cancellation
    larger = 0.5 * (whole + absolute(z))
    smaller = 0.25 * clearance * clearance / larger
    outside = real(z) >= 0
    free, lapped = where(outside, larger, smaller), where(outside, smaller, larger)
    across = sqrt(free * free + width * width)
    entry = lapped + ENTRY * clearance
    return EdgeGap(
        across - 2 * rounding,
        free * free / (across * whole),
        lapped * lapped / entry,
        -lapped * lapped * (lapped + 2 * ENTRY * clearance) / (entry * entry * whole),
    )


@geometry
def lapped_edge_flow(
    *,
    uncovered: Array,
    pressure_drop: Array,
    area_gradient: Array,
    density: Array,
    dynamic_viscosity: Array,
    clearance: Array | None = None,
    rounding: Array = 0.0,
    flow_coefficient: Array = TURBULENT_COEFFICIENT,
) -> Array:
    """Flow through an edge, q = 2 w h dp/(a + sqrt(a^2 + 2 rho |dp|/C^2)).

    The viscous term is a = eta (32/(pi h) + 12 L h/c^3), with opening h and gap length L of
    `edge_gap`. Without clearance, q = C w max(y, 0) sqrt(2 |dp|/rho) sgn(dp), smoothed as
    `valve.edge_flow`.

    Parameters
    ----------
    uncovered : y [m]; negative: lap
    pressure_drop : either sign [Pa]
    area_gradient : w, width of the ports around the spool [m]
    density, dynamic_viscosity : rho [kg/m^3] and eta [Pa s], > 0
    clearance, rounding : c > 0, or None for an edge that does not leak; corner radius r [m]
    flow_coefficient : C of the turbulent flow [-]

    Returns
    -------
    flow, with the sign of the pressure drop [m^3/s]

    Notes
    -----
    Valid: no cavitation in the edge; spool centred in its bore.

    A spool that touches its bore leaks up to 2.5 times as much through a long lap.

    References
    ----------
    [Merritt1967] laminar and turbulent flow through a slot, leakage of a gap, recalled;
    [EryilmazWilson2006] one formula for leakage and orifice flow, recalled; [derived] positive root

    Examples
    --------
    >>> edge = {"area_gradient": 20e-3, "density": 870.0, "dynamic_viscosity": 0.03,
    ...         "clearance": 3e-6}
    >>> for y in (-100e-6, 0.0, 100e-6):
    ...     print(f"{lapped_edge_flow(uncovered=y, pressure_drop=70e5, **edge) * 60000:.4f} l/min")
    0.0063 l/min
    0.1721 l/min
    9.1396 l/min
    """
    if clearance is None:
        return edge_flow(
            coefficient=_sharp(uncovered, area_gradient, density, flow_coefficient),
            pressure_drop=pressure_drop,
        )
    gap = edge_gap(uncovered=uncovered, clearance=clearance, rounding=rounding)
    return orifice_flow(
        pressure_difference=pressure_drop,
        density=density,
        dynamic_viscosity=dynamic_viscosity,
        **_slot(gap, area_gradient, clearance, flow_coefficient),
    )


@geometry
def lapped_edge_conductance(
    *,
    uncovered: Array,
    pressure_drop: Array,
    area_gradient: Array,
    density: Array,
    dynamic_viscosity: Array,
    clearance: Array | None = None,
    rounding: Array = 0.0,
    flow_coefficient: Array = TURBULENT_COEFFICIENT,
) -> Array:
    """Slope of an edge's flow over its pressure drop, dq/d(dp) = w h/sqrt(a^2 + 2 rho |dp|/C^2).

    Parameters
    ----------
    uncovered : y [m]; negative: lap
    pressure_drop : either sign [Pa]
    area_gradient : w, width of the ports around the spool [m]
    density, dynamic_viscosity : rho [kg/m^3] and eta [Pa s], > 0
    clearance, rounding : c > 0, or None for an edge that does not leak; corner radius r [m]
    flow_coefficient : C of the turbulent flow [-]

    Returns
    -------
    conductance [m^3/s/Pa]

    Notes
    -----
    Valid: small changes about the stated pressure drop.

    At zero lap and low pressure this is pi w c^2/(32 eta).

    References
    ----------
    [Merritt1967] K_c0 of a critical-centre valve; [derived] slope of `lapped_edge_flow`

    Examples
    --------
    >>> edge = {"area_gradient": 20e-3, "density": 870.0, "dynamic_viscosity": 0.03,
    ...         "clearance": 3e-6}
    >>> print(f"{lapped_edge_conductance(uncovered=0.0, pressure_drop=0.0, **edge):.4e}")
    5.8905e-13
    """
    if clearance is None:
        return edge_conductance(
            coefficient=_sharp(uncovered, area_gradient, density, flow_coefficient),
            pressure_drop=pressure_drop,
        )
    gap = edge_gap(uncovered=uncovered, clearance=clearance, rounding=rounding)
    return orifice_conductance(
        pressure_difference=pressure_drop,
        density=density,
        dynamic_viscosity=dynamic_viscosity,
        **_slot(gap, area_gradient, clearance, flow_coefficient),
    )


@geometry
def lapped_edge_gain(
    *,
    uncovered: Array,
    pressure_drop: Array,
    area_gradient: Array,
    density: Array,
    dynamic_viscosity: Array,
    clearance: Array | None = None,
    rounding: Array = 0.0,
    flow_coefficient: Array = TURBULENT_COEFFICIENT,
    opens: bool = False,
) -> Array:
    """Slope of an edge's flow over its opening, dq/dy = q (h'/h - a'/S).

    S^2 = a^2 + 2 rho |dp|/C^2, with the viscous term a of `lapped_edge_flow`. Without clearance,
    dq/dy = q/y of an open edge, and zero of a closed one.

    Parameters
    ----------
    uncovered : y [m]; negative: lap
    pressure_drop : either sign [Pa]
    area_gradient : w, width of the ports around the spool [m]
    density, dynamic_viscosity : rho [kg/m^3] and eta [Pa s], > 0
    clearance, rounding : c > 0, or None for an edge that does not leak; corner radius r [m]
    flow_coefficient : C of the turbulent flow [-]
    opens : whether an edge without clearance that is exactly at y = 0 counts as open

    Returns
    -------
    flow gain [m^3/s/m]

    Notes
    -----
    Valid: small changes about the stated opening.

    References
    ----------
    [derived] slope of `lapped_edge_flow`

    Examples
    --------
    >>> edge = {"area_gradient": 20e-3, "density": 870.0, "dynamic_viscosity": 0.03,
    ...         "uncovered": 100e-6, "pressure_drop": 70e5}
    >>> for clearance in (None, 3e-6):
    ...     print(f"{lapped_edge_gain(clearance=clearance, **edge):.4f} m^2/s")
    1.5502 m^2/s
    1.5488 m^2/s
    """
    if clearance is None:
        open_now = real(uncovered) >= 0 if opens else real(uncovered) > 0
        per_length = _sharp(1.0, area_gradient, density, flow_coefficient)
        slope = edge_flow(coefficient=per_length, pressure_drop=pressure_drop)
        return where(open_now, slope, 0 * slope)
    gap = edge_gap(uncovered=uncovered, clearance=clearance, rounding=rounding)
    h, dh = gap.opening, gap.opening_slope
    cube = GAP_DROP / (clearance * clearance * clearance)
    viscous = dynamic_viscosity * (SLOT_DROP / h + cube * gap.length * h)
    change = dynamic_viscosity * (
        cube * (gap.length_slope * h + gap.length * dh) - SLOT_DROP * dh / (h * h)
    )
    turbulent = 2 * density * absolute(pressure_drop) / (flow_coefficient * flow_coefficient)
    total = sqrt(viscous * viscous + turbulent)
    slope = (dh - h * change / total) / (viscous + total)
    return 2 * area_gradient * pressure_drop * slope


def _sharp(
    uncovered: Array, area_gradient: Array, density: Array, flow_coefficient: Array
) -> Array:
    """Flow coefficient of an edge that does not leak."""
    return spool_edge_coefficient(
        spool_position=uncovered,
        overlap=0.0,
        area_gradient=area_gradient,
        density=density,
        flow_coefficient=flow_coefficient,
    )


def _slot(
    gap: EdgeGap, area_gradient: Array, clearance: Array, flow_coefficient: Array
) -> dict[str, Array]:
    """Edge as an orifice; its hydraulic diameter 2 h falls with the drop of the gap behind it."""
    h = gap.opening
    share = (GAP_DROP / SLOT_DROP) * gap.length * h * h / (clearance * clearance * clearance)
    return {
        "area": area_gradient * h,
        "hydraulic_diameter": 2 * h / (1 + share),
        "turbulent_coefficient": flow_coefficient,
        "laminar_coefficient": SLOT_COEFFICIENT,
    }
