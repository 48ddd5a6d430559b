"""End stops in the time domain: a spring and damper that only push, and a cushion.

Position runs from 0 (retracted) to the stroke; forces are positive when they extend. Energy and
peak force of an undamped stop are in `endurance`.
"""

from __future__ import annotations

import math

from ..base.numeric import Array, clip, geometry, maximum, real, sqrt, where
from .endurance import end_stop_energy
from .orifice import TURBULENT_COEFFICIENT, orifice_pressure_drop

STOP_TRAVEL = 0.2e-3
"""Compression of a stop under the force of the supply pressure, m [MECE5005]."""
DAMPING_FACTOR = 0.5
"""Ratio of a stop's damping to sqrt(K m) with stiffness K and mass m; 0.5 is a quarter of critical
[MECE5005]."""


@geometry
def stop_stiffness(*, area: Array, pressure: Array, travel: Array = STOP_TRAVEL) -> Array:
    """Stiffness of an end stop, K_end = A_A p_P/0.2 mm.

    Parameters
    ----------
    area : piston area A_A [m^2]
    pressure : supply pressure p_P, gauge [Pa]
    travel : compression at which the force of the stop is A_A p_P [m]

    Returns
    -------
    stiffness [N/m]

    Notes
    -----
    Valid: a stand-in for the stiffness of the ends, which are much stiffer than the oil.

    References
    ----------
    [MECE5005] cylinder ends as stiff springs and dampers

    Examples
    --------
    >>> print(f"{stop_stiffness(area=8.0425e-4, pressure=140e5):.4e} N/m")
    5.6298e+07 N/m
    """
    return area * pressure / travel


def stop_damping(*, stiffness: Array, mass: Array, factor: Array = DAMPING_FACTOR) -> Array:
    """Damping of an end stop, b = 0.5 sqrt(K_end m).

    Parameters
    ----------
    stiffness : K_end [N/m]
    mass : moving mass [kg]
    factor : b/sqrt(K_end m), twice the damping ratio [-]

    Returns
    -------
    damping [N s/m]; NaN where K_end m < 0

    Notes
    -----
    Valid: a stand-in for the losses of an impact.

    References
    ----------
    [MECE5005] cylinder ends as stiff springs and dampers

    Examples
    --------
    >>> print(f"{stop_damping(stiffness=5.63e7, mass=30.0):.0f} N s/m")
    20549 N s/m
    """
    return factor * sqrt(stiffness * mass)


def contact_force(
    *, compression: Array, closing_speed: Array, stiffness: Array, damping: Array
) -> Array:
    """Force of a stop while the piston touches it, max(K delta + b delta', 0).

    Parameters
    ----------
    compression : delta [m]
    closing_speed : delta' [m/s]
    stiffness : K_end [N/m]
    damping : b [N s/m]

    Returns
    -------
    force that pushes the piston back [N], >= 0

    Notes
    -----
    Valid: from contact until the piston leaves the stop.

    References
    ----------
    [MECE5005] cylinder ends as stiff springs and dampers; [derived] never pulling

    Examples
    --------
    >>> contact_force(compression=1e-4, closing_speed=0.1, stiffness=5.63e7, damping=2.05e4)
    7680.0
    """
    return maximum(stiffness * compression + damping * closing_speed, 0.0)


@geometry
def cushion_flow_area(
    *,
    remaining: Array,
    length: Array,
    open_area: Array,
    end_area: Array,
    exponent: Array = 1.0,
) -> Array:
    """Flow area past a cushion spear, A = A_end + (A_open - A_end)(y/L)^k over the last length L.

    k = 1 is a straight taper; k = 1/2 with A_end = 0 brakes a mass evenly.

    Parameters
    ----------
    remaining : y, travel left to the stop [m]
    length : L, of the cushion [m]
    open_area : flow area as the spear enters, and before [m^2]
    end_area : flow area at the stop [m^2]; the mass reaches the stop only if it is > 0
    exponent : k [-], > 0

    Returns
    -------
    area [m^2]

    Notes
    -----
    Valid: the least section of the path is at the spear; no eccentricity.

    References
    ----------
    [derived] spear whose section follows a power of the travel

    Examples
    --------
    >>> spear = dict(length=20e-3, open_area=30e-6, end_area=1e-6)
    >>> for y in (30e-3, 10e-3, 0.0):
    ...     print(f"{cushion_flow_area(remaining=y, **spear) * 1e6:.2f} mm2")
    30.00 mm2
    15.50 mm2
    1.00 mm2
    """
    share = clip(remaining / length, 0.0, 1.0)
    inside = real(share) > 0
    opened = where(inside, where(inside, share, 1.0) ** exponent, 0.0)
    return end_area + (open_area - end_area) * opened


@geometry
def cushion_pressure(
    *,
    speed: Array,
    area: Array,
    flow_area: Array,
    density: Array,
    dynamic_viscosity: Array,
    back_pressure: Array = 0.0,
) -> Array:
    """Pressure of the oil driven past a cushion spear, p_b + dp of an orifice at q = A v.

    Parameters
    ----------
    speed : into the cushion [m/s]; in the other direction a check valve fills the chamber without
        pressure drop
    area : A, of the cushion chamber [m^2]
    flow_area : past the spear, `cushion_flow_area` [m^2], > 0
    density : [kg/m^3]
    dynamic_viscosity : [Pa s]
    back_pressure : p_b at the port, gauge [Pa]

    Returns
    -------
    gauge pressure [Pa]; NaN at a flow area <= 0

    Notes
    -----
    Valid: stiff oil (the flow follows the speed at once); sharp edges.

    References
    ----------
    [derived] `orifice.orifice_pressure_drop` at the flow of the piston

    Examples
    --------
    >>> p = cushion_pressure(speed=0.3, area=6e-4, flow_area=4e-6, density=870.0,
    ...                      dynamic_viscosity=0.04)
    >>> print(f"{p / 1e5:.1f} bar")
    23.7 bar
    """
    flow = area * maximum(speed, 0.0)
    return back_pressure + orifice_pressure_drop(
        area=flow_area, flow=flow, density=density, dynamic_viscosity=dynamic_viscosity
    )


@geometry
def cushion_mean_pressure(
    *, driving_force: Array, mass: Array, velocity: Array, length: Array, area: Array
) -> Array:
    """Mean pressure of a cushion that stops a mass within the cushion's length, E/(A L).

    No cushion of this length can have a lower peak pressure. E is
    `endurance.end_stop_energy` with the length L as compression.

    Parameters
    ----------
    driving_force : F_d, net force that keeps pushing [N]
    mass : moving mass [kg]
    velocity : as the spear enters [m/s]
    length : L, of the cushion [m]
    area : A, of the cushion chamber [m^2]

    Returns
    -------
    pressure above that of the port [Pa]

    Notes
    -----
    Valid: constant driving force.

    References
    ----------
    [derived] work of the pressure over the swept volume A L

    Examples
    --------
    >>> p = cushion_mean_pressure(driving_force=6000.0, mass=40.0, velocity=0.3, length=20e-3,
    ...                           area=6e-4)
    >>> print(f"{p / 1e5:.1f} bar")
    101.5 bar
    """
    energy = end_stop_energy(
        driving_force=driving_force, compression=length, mass=mass, velocity=velocity
    )
    return energy / (area * length)


@geometry
def cushion_open_area(
    *,
    velocity: Array,
    area: Array,
    pressure: Array,
    density: Array,
    turbulent_coefficient: Array = TURBULENT_COEFFICIENT,
) -> Array:
    """Flow area past an evenly braking spear as the spear enters, A v/(C sqrt(2 p/rho)).

    If the area then closes as (y/L)^(1/2) with the remaining travel y, the pressure stays constant,
    because v^2 falls in proportion to y.

    Parameters
    ----------
    velocity : as the spear enters [m/s]
    area : A, of the cushion chamber [m^2]
    pressure : required pressure above that of the port [Pa], > 0: `cushion_mean_pressure`
    density : [kg/m^3]
    turbulent_coefficient : C [-]

    Returns
    -------
    area [m^2]; NaN at a pressure <= 0

    Notes
    -----
    Valid: turbulent flow past the spear.

    References
    ----------
    [AaltoThesis] eq. 9 solved for the area

    Examples
    --------
    >>> a = cushion_open_area(velocity=0.3, area=6e-4, pressure=101.5e5, density=870.0)
    >>> print(f"{a * 1e6:.3f} mm2")
    1.929 mm2
    """
    usable = real(pressure) > 0
    jet = turbulent_coefficient * sqrt(2 * where(usable, pressure, 1.0) / density)
    return where(usable, area * velocity / jet, math.nan)
