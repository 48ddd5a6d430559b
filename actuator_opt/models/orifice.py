"""Orifices from creeping to turbulent flow: flow, pressure drop and their slopes.

All functions use one law, the laminar and the turbulent pressure drop in series:
dp = rho q |q|/(2 C^2 A^2) + eta q/(2 delta^2 d A). The law is odd, once differentiable at zero, and
can be solved in closed form for flow and for pressure drop. Its discharge coefficient C_q
tends to delta sqrt(Re) in creeping flow and to C in turbulent flow [Merritt1967]. The other common
form switches from the laminar to the turbulent law at Re = (C/delta)^2, where it has a kink.
"""

from __future__ import annotations

import math

from ..base.numeric import Array, absolute, geometry, namespace, real, sqrt, where

TURBULENT_COEFFICIENT = 0.611
"""Discharge coefficient C of a sharp edge, pi/(pi + 2) [AaltoThesis]."""
LAMINAR_COEFFICIENT = 0.2
"""Laminar coefficient delta of a round sharp-edged hole; a long slot has 0.157 [Merritt1967]."""


def discharge_coefficient(
    *,
    reynolds: Array,
    turbulent_coefficient: Array = TURBULENT_COEFFICIENT,
    laminar_coefficient: Array = LAMINAR_COEFFICIENT,
) -> Array:
    """Discharge coefficient at a Reynolds number, 1/C_q^2 = 1/C^2 + 1/(delta^2 Re).

    It tends to delta sqrt(Re) in creeping flow and to C in turbulent flow; at the transition,
    Re = (C/delta)^2 (about 9), it is C/sqrt(2).

    Parameters
    ----------
    reynolds : q d/(A nu), either sign [-]
    turbulent_coefficient : C [-]
    laminar_coefficient : delta [-]

    Returns
    -------
    discharge coefficient C_q [-]

    Notes
    -----
    Valid: sharp edges; the few percent above C that some edges show near Re 100 are left out.

    References
    ----------
    [Merritt1967] C_q = delta sqrt(Re) of laminar flow; [AaltoThesis] eq. 10; [derived] laminar
    and turbulent pressure drop in series

    Examples
    --------
    >>> print(f"{discharge_coefficient(reynolds=1.0):.3f}")
    0.190
    >>> print(f"{discharge_coefficient(reynolds=1e4):.3f}")
    0.611
    """
    number = laminar_coefficient * laminar_coefficient * absolute(reynolds)
    return turbulent_coefficient * sqrt(
        number / (number + turbulent_coefficient * turbulent_coefficient)
    )


@geometry
def round_diameter(*, area: Array) -> Array:
    """Hydraulic diameter of a round hole, d = sqrt(4 A/pi).

    Parameters
    ----------
    area : [m^2]

    Returns
    -------
    diameter [m]

    Notes
    -----
    Valid: everywhere.

    References
    ----------
    [derived] area of a circle

    Examples
    --------
    >>> print(f"{round_diameter(area=0.22e-4) * 1e3:.3f} mm")
    5.293 mm
    """
    return sqrt((4 / math.pi) * area)


@geometry
def orifice_flow(
    *,
    area: Array,
    pressure_difference: Array,
    density: Array,
    dynamic_viscosity: Array,
    hydraulic_diameter: Array | None = None,
    turbulent_coefficient: Array = TURBULENT_COEFFICIENT,
    laminar_coefficient: Array = LAMINAR_COEFFICIENT,
) -> Array:
    """Flow through an orifice, q = C_q A sqrt(2 |dp|/rho) sgn(dp), where C_q drops at low Re.

    q = 2 A d dp/(e + sqrt(e^2 + 2 rho d^2 |dp|/C^2)), e = eta/(2 delta^2).

    Parameters
    ----------
    area : [m^2]; 0 if closed
    pressure_difference : [Pa], either sign
    density : [kg/m^3]
    dynamic_viscosity : [Pa s]; 0 gives the plain square root
    hydraulic_diameter : d [m]; if left out, that of a round hole
    turbulent_coefficient : C [-]
    laminar_coefficient : delta [-]

    Returns
    -------
    flow [m^3/s], with the sign of the pressure difference

    Notes
    -----
    Valid: sharp edges, no cavitation behind the orifice.

    References
    ----------
    [AaltoThesis] eq. 9; [Merritt1967] laminar orifice flow; [derived] positive root of the
    pressure balance with the laminar and the turbulent drop in series

    Examples
    --------
    >>> q = orifice_flow(area=0.3e-4, pressure_difference=5e5, density=870.0,
    ...                  dynamic_viscosity=0.04)
    >>> print(f"{q * 60000:.2f} l/min")
    37.22 l/min
    """
    width = round_diameter(area=area) if hydraulic_diameter is None else hydraulic_diameter
    viscous = 0.5 * dynamic_viscosity / (laminar_coefficient * laminar_coefficient)
    scaled = width / turbulent_coefficient
    root = sqrt(viscous * viscous + 2 * density * scaled * scaled * absolute(pressure_difference))
    total = viscous + root
    moving = real(total) > 0  # else no pressure difference and no viscosity: no flow
    return where(moving, 2 * area * width * pressure_difference, 0.0) / where(moving, total, 1.0)


@geometry
def orifice_conductance(
    *,
    area: Array,
    pressure_difference: Array,
    density: Array,
    dynamic_viscosity: Array,
    hydraulic_diameter: Array | None = None,
    turbulent_coefficient: Array = TURBULENT_COEFFICIENT,
    laminar_coefficient: Array = LAMINAR_COEFFICIENT,
) -> Array:
    """Small-signal conductance dq/d(dp) of an orifice at a pressure difference.

    G = A d/sqrt(e^2 + 2 rho d^2 |dp|/C^2), e = eta/(2 delta^2); 2 delta^2 A d/eta at zero flow.

    Parameters
    ----------
    area : [m^2]; 0 if closed
    pressure_difference : mean value [Pa], either sign
    density : [kg/m^3]
    dynamic_viscosity : [Pa s]
    hydraulic_diameter : d [m]; if left out, that of a round hole
    turbulent_coefficient : C [-]
    laminar_coefficient : delta [-]

    Returns
    -------
    conductance [m^3/s/Pa]; 0 where closed; NaN without viscosity and pressure difference

    Notes
    -----
    Valid: amplitudes much smaller than the mean, or a mean of zero in creeping flow.

    References
    ----------
    [derived] slope of `orifice_flow`

    Examples
    --------
    >>> g = orifice_conductance(area=0.22e-4, pressure_difference=1e5, density=870.0,
    ...                         dynamic_viscosity=0.04)
    >>> print(f"{g:.3e}")
    1.019e-09
    """
    xp = namespace(area, pressure_difference, density, dynamic_viscosity)
    width = round_diameter(area=area) if hydraulic_diameter is None else hydraulic_diameter
    viscous = 0.5 * dynamic_viscosity / (laminar_coefficient * laminar_coefficient)
    closed = (real(area) <= 0) | (real(width) <= 0)
    difference = where(closed, 0.0, absolute(pressure_difference))  # may be infinite
    scaled = width / turbulent_coefficient
    square = viscous * viscous + 2 * density * scaled * scaled * difference
    flowing = real(square) > 0
    slope = area * width / xp.sqrt(where(flowing, square, 1.0))
    return where(closed, 0.0, where(flowing, slope, math.nan))


@geometry
def orifice_pressure_drop(
    *,
    area: Array,
    flow: Array,
    density: Array,
    dynamic_viscosity: Array,
    hydraulic_diameter: Array | None = None,
    turbulent_coefficient: Array = TURBULENT_COEFFICIENT,
    laminar_coefficient: Array = LAMINAR_COEFFICIENT,
) -> Array:
    """Pressure drop of an orifice, dp = rho q |q|/(2 C^2 A^2) + eta q/(2 delta^2 d A).

    Parameters
    ----------
    area : [m^2], > 0
    flow : [m^3/s], either sign
    density : [kg/m^3]
    dynamic_viscosity : [Pa s]
    hydraulic_diameter : d [m]; if left out, that of a round hole
    turbulent_coefficient : C [-]
    laminar_coefficient : delta [-]

    Returns
    -------
    pressure drop [Pa], with the sign of the flow; NaN at area <= 0

    Notes
    -----
    Valid: sharp edges, no cavitation behind the orifice.

    References
    ----------
    [AaltoThesis] eq. 9; [Merritt1967] laminar orifice flow; [derived] sum of both drops

    Examples
    --------
    >>> dp = orifice_pressure_drop(area=0.3e-4, flow=37.22 / 60000, density=870.0,
    ...                            dynamic_viscosity=0.04)
    >>> print(f"{dp / 1e5:.2f} bar")
    5.00 bar
    """
    laminar, turbulent = _resistances(
        area, density, dynamic_viscosity, hydraulic_diameter, turbulent_coefficient,
        laminar_coefficient,
    )  # fmt: skip
    return flow * (laminar + turbulent * absolute(flow))


@geometry
def orifice_resistance(
    *,
    area: Array,
    flow: Array,
    density: Array,
    dynamic_viscosity: Array,
    hydraulic_diameter: Array | None = None,
    turbulent_coefficient: Array = TURBULENT_COEFFICIENT,
    laminar_coefficient: Array = LAMINAR_COEFFICIENT,
) -> Array:
    """Small-signal resistance d(dp)/dq of an orifice at a flow.

    R = rho |q|/(C^2 A^2) + eta/(2 delta^2 d A).

    Parameters
    ----------
    area : [m^2], > 0
    flow : mean value [m^3/s], either sign
    density : [kg/m^3]
    dynamic_viscosity : [Pa s]
    hydraulic_diameter : d [m]; if left out, that of a round hole
    turbulent_coefficient : C [-]
    laminar_coefficient : delta [-]

    Returns
    -------
    resistance [Pa s/m^3]; NaN at area <= 0

    Notes
    -----
    Valid: amplitudes much smaller than the mean, or a mean of zero in creeping flow.

    References
    ----------
    [derived] slope of `orifice_pressure_drop`

    Examples
    --------
    >>> r = orifice_resistance(area=0.22e-4, flow=0.0, density=870.0, dynamic_viscosity=0.04)
    >>> print(f"{r:.3e}")
    4.294e+06
    """
    laminar, turbulent = _resistances(
        area, density, dynamic_viscosity, hydraulic_diameter, turbulent_coefficient,
        laminar_coefficient,
    )  # fmt: skip
    return laminar + 2 * turbulent * absolute(flow)


def _resistances(
    area: Array,
    density: Array,
    dynamic_viscosity: Array,
    hydraulic_diameter: Array | None,
    turbulent_coefficient: Array,
    laminar_coefficient: Array,
) -> tuple[Array, Array]:
    """Factors of q and q |q| in the pressure drop."""
    hole = where(real(area) > 0, area, math.nan)
    width = round_diameter(area=hole) if hydraulic_diameter is None else hydraulic_diameter
    effective = turbulent_coefficient * hole
    laminar = 0.5 * dynamic_viscosity
    laminar = laminar / (laminar_coefficient * laminar_coefficient * width * hole)
    return laminar, 0.5 * density / (effective * effective)
