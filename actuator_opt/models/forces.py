"""Areas, forces, flow and power of a cylinder, and its lever arm on a joint.

Chamber A is at the cap end, chamber B at the rod end; pressures are gauge, forces positive in
the named direction.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..base.numeric import Array, geometry, namespace, real, sqrt, where


@geometry
def piston_area(*, bore: Array) -> Array:
    """Area of the cap side, A_A = pi D^2/4.

    Parameters
    ----------
    bore : [m]

    Returns
    -------
    area [m^2]

    Notes
    -----
    Valid: everywhere.

    References
    ----------
    [derived] area of a circle

    Examples
    --------
    >>> print(f"{piston_area(bore=25e-3) * 1e6:.2f} mm2")
    490.87 mm2
    """
    return (0.25 * math.pi) * bore * bore


@geometry
def annulus_area(*, bore: Array, rod_diameter: Array) -> Array:
    """Area of the rod side, A_B = pi (D^2 - d^2)/4.

    Parameters
    ----------
    bore, rod_diameter : [m]

    Returns
    -------
    area [m^2]; negative where the rod is thicker than the bore (the checks of a design report it)

    Notes
    -----
    Valid: d < D.

    References
    ----------
    [derived] area of a ring

    Examples
    --------
    >>> print(f"{annulus_area(bore=25e-3, rod_diameter=12e-3) * 1e6:.2f} mm2")
    377.78 mm2
    """
    return (0.25 * math.pi) * (bore * bore - rod_diameter * rod_diameter)


@geometry
def push_force(
    *, pressure_a: Array, pressure_b: Array, area_a: Array, area_b: Array, friction: Array
) -> Array:
    """Force on the load when extending, p_A A_A - p_B A_B - F_fr.

    Parameters
    ----------
    pressure_a : driving pressure [Pa]
    pressure_b : back pressure [Pa]
    area_a, area_b : [m^2]
    friction : magnitude [N]

    Returns
    -------
    net force [N]

    Notes
    -----
    Valid: steady speed.

    References
    ----------
    [derived] force balance of the piston

    Examples
    --------
    >>> round(push_force(pressure_a=1e7, pressure_b=2e5, area_a=5e-4, area_b=4e-4, friction=120.0))
    4800
    """
    return pressure_a * area_a - pressure_b * area_b - friction


@geometry
def pull_force(
    *, pressure_a: Array, pressure_b: Array, area_a: Array, area_b: Array, friction: Array
) -> Array:
    """Force on the load when retracting, p_B A_B - p_A A_A - F_fr.

    Parameters
    ----------
    pressure_a : back pressure [Pa]
    pressure_b : driving pressure [Pa]
    area_a, area_b : [m^2]
    friction : magnitude [N]

    Returns
    -------
    net force [N]

    Notes
    -----
    Valid: steady speed.

    References
    ----------
    [derived] force balance of the piston

    Examples
    --------
    >>> round(pull_force(pressure_a=2e5, pressure_b=1e7, area_a=5e-4, area_b=4e-4, friction=100.0))
    3800
    """
    return pressure_b * area_b - pressure_a * area_a - friction


@geometry
def efficiency(*, force: Array, pressure: Array, area: Array) -> Array:
    """Force efficiency, F/(p A) of the driven side.

    Parameters
    ----------
    force : net force on the load [N]
    pressure : driving pressure [Pa]
    area : driven area [m^2]

    Returns
    -------
    efficiency [-]; NaN where p A = 0

    Notes
    -----
    Valid: steady speed.

    References
    ----------
    [derived] definition of the efficiency

    Examples
    --------
    >>> efficiency(force=4500.0, pressure=1e7, area=5e-4)
    0.9
    """
    ideal = pressure * area
    valid = real(ideal) != 0
    return where(valid, force / where(valid, ideal, 1.0), math.nan)


@geometry
def pressure_loss(*, friction: Array, area: Array) -> Array:
    """Pressure needed to overcome friction, F/A.

    Parameters
    ----------
    friction : [N]
    area : driven area [m^2]

    Returns
    -------
    pressure [Pa]

    Notes
    -----
    Valid: everywhere.

    References
    ----------
    [ElAsswad2018] section 4.1

    Examples
    --------
    >>> print(f"{pressure_loss(friction=166.0, area=4.9087e-4) / 1e6:.3f} MPa")
    0.338 MPa
    """
    return friction / area


@geometry
def chamber_flow(*, area: Array, speed: Array) -> Array:
    """Flow that a moving piston takes in or pushes out, q = A v.

    Parameters
    ----------
    area : [m^2]
    speed : [m/s]

    Returns
    -------
    flow [m^3/s]

    Notes
    -----
    Valid: incompressible oil, no leakage.

    References
    ----------
    [derived] continuity

    Examples
    --------
    >>> print(f"{chamber_flow(area=5e-4, speed=0.1) * 60000:.1f} l/min")
    3.0 l/min
    """
    return area * speed


def power(*, force: Array, speed: Array) -> Array:
    """Mechanical power, P = F v.

    Parameters
    ----------
    force : [N]
    speed : [m/s]

    Returns
    -------
    power [W]

    Notes
    -----
    Valid: everywhere.

    References
    ----------
    [derived] definition of power

    Examples
    --------
    >>> power(force=3000.0, speed=0.1)
    300.0
    """
    return force * speed


def joint_force(*, torque: Array, lever_arm: Array) -> Array:
    """Actuator force that gives a joint torque, F = M/a.

    Parameters
    ----------
    torque : [N m]
    lever_arm : distance of the actuator's line from the joint axis [m]

    Returns
    -------
    force [N]

    Notes
    -----
    Valid: everywhere.

    References
    ----------
    [derived] moment balance

    Examples
    --------
    >>> joint_force(torque=120.0, lever_arm=0.04)
    3000.0
    """
    return torque / lever_arm


class Crank(NamedTuple):
    """Length and lever arm of an actuator that connects two pivots across a joint."""

    length: Array
    lever_arm: Array


@geometry
def crank(*, base_radius: Array, crank_radius: Array, joint_angle: Array) -> Crank:
    """Pin-to-pin length and lever arm of an actuator that connects two pivots across a joint.

    L^2 = a^2 + c^2 - 2 a c cos(phi), lever arm = dL/dphi = a c sin(phi)/L.

    Parameters
    ----------
    base_radius : joint axis to the base pivot, a [m]
    crank_radius : joint axis to the crank pivot, c [m]
    joint_angle : phi between both radii [rad]

    Returns
    -------
    length and lever arm [m]; NaN where both pivots coincide

    Notes
    -----
    Valid: 0 < phi < pi.

    References
    ----------
    [derived] law of cosines and virtual work

    Examples
    --------
    >>> c = crank(base_radius=0.3, crank_radius=0.04, joint_angle=1.5707963267948966)
    >>> print(f"{c.length:.5f} {c.lever_arm:.5f}")
    0.30265 0.03965
    """
    xp = namespace(joint_angle)
    product = base_radius * crank_radius
    square = (
        base_radius * base_radius + crank_radius * crank_radius - 2 * product * xp.cos(joint_angle)
    )
    valid = real(square) > 0
    length = sqrt(where(valid, square, 1.0))
    return Crank(
        where(valid, length, math.nan),
        where(valid, product * xp.sin(joint_angle) / length, math.nan),
    )
