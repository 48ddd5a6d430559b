"""An actuator between a fixed pivot and a crank pin on a joint: torque, motion, reflected inertia.

Length and lever arm are those of `forces.crank`, at the angle theta + theta_0 between the radii
from the joint axis to the fixed pivot and to the crank pin.
At the dead points, angle 0 and pi, the lever arm is zero: forces and reflected mass are infinite
there, not NaN.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..base.numeric import Array, angle, geometry, namespace, real, sqrt, where
from .forces import crank, joint_force


class LinkageGeometry(NamedTuple):
    """Actuator length with its first and second derivative by the joint angle."""

    length: Array
    lever_arm: Array
    """dl/dtheta [m]; negative where the actuator shortens with the joint angle."""
    lever_slope: Array
    """d2l/dtheta2 [m]."""


@geometry
def linkage(
    *, base_radius: Array, crank_radius: Array, joint_angle: Array, angle_offset: Array = 0.0
) -> LinkageGeometry:
    """Length, lever arm and its slope, l^2 = a^2 + r^2 - 2 a r cos(theta + theta_0).

    l' = a r sin(theta + theta_0)/l, l'' = (a r cos(theta + theta_0) - l'^2)/l.

    Parameters
    ----------
    base_radius : joint axis to the fixed pivot, a [m]
    crank_radius : joint axis to the crank pin, r [m]
    joint_angle : theta [rad]
    angle_offset : theta_0, angle between the radii a and r at theta = 0 [rad]

    Returns
    -------
    length [m], lever arm [m], slope of the lever arm [m/rad]; NaN where both pivots coincide

    Notes
    -----
    Valid: any angle; the lever arm changes sign at the dead points 0 and pi.

    References
    ----------
    [derived] law of cosines, differentiated twice

    Examples
    --------
    >>> arm = linkage(base_radius=0.3, crank_radius=0.04, joint_angle=0.0, angle_offset=1.2)
    >>> print(f"{arm.length:.5f} {arm.lever_arm:.5f} {arm.lever_slope:.5f}")
    0.28793 0.03884 0.00986
    """
    turned = joint_angle + angle_offset
    arm = crank(base_radius=base_radius, crank_radius=crank_radius, joint_angle=turned)
    bend = base_radius * crank_radius * namespace(turned).cos(turned)
    slope = (bend - arm.lever_arm * arm.lever_arm) / arm.length
    return LinkageGeometry(arm.length, arm.lever_arm, slope)


@geometry
def linkage_angle(
    *, length: Array, base_radius: Array, crank_radius: Array, angle_offset: Array = 0.0
) -> Array:
    """Joint angle at an actuator length, between the dead points 0 < theta + theta_0 < pi.

    tan^2((theta + theta_0)/2) = (l^2 - (a - r)^2)/((a + r)^2 - l^2).

    Parameters
    ----------
    length : pin to pin, l [m]
    base_radius, crank_radius : a, r [m]
    angle_offset : theta_0 [rad]

    Returns
    -------
    joint angle theta [rad]; NaN outside |a - r| <= l <= a + r

    Notes
    -----
    Valid: the joint bent to one side; at both ends of the reach, theta changes steeply with l.

    References
    ----------
    [derived] half-angle form of the law of cosines

    Examples
    --------
    >>> theta = linkage_angle(length=0.28793, base_radius=0.3, crank_radius=0.04)
    >>> print(f"{theta:.4f} rad")
    1.2000 rad
    """
    longest, least = base_radius + crank_radius, base_radius - crank_radius
    beyond = (length - least) * (length + least)
    short = (longest - length) * (longest + length)
    reached = (real(beyond) >= 0) & (real(short) >= 0) & (real(length) > 0)
    half = angle(sqrt(where(reached, beyond, 1.0)), sqrt(where(reached, short, 1.0)))
    return where(reached, 2 * half - angle_offset, math.nan)


def joint_torque(*, force: Array, lever_arm: Array) -> Array:
    """Torque of the actuator's push on the joint, T = F dl/dtheta.

    Parameters
    ----------
    force : extending positive [N]
    lever_arm : dl/dtheta [m], with its sign

    Returns
    -------
    torque [N m], positive in the direction of the joint angle

    Notes
    -----
    Valid: everywhere; pin friction left out.

    References
    ----------
    [derived] virtual work, F dl = T dtheta

    Examples
    --------
    >>> joint_torque(force=3000.0, lever_arm=0.04)
    120.0
    """
    return force * lever_arm


def actuator_force(*, torque: Array, lever_arm: Array) -> Array:
    """Push of the actuator that gives a joint torque, also at a dead point.

    This is `forces.joint_force` with its limit where the lever arm is zero: infinite with the sign
    of the torque, and 0 without torque.

    Parameters
    ----------
    torque : positive in the direction of the joint angle [N m]
    lever_arm : dl/dtheta [m], with its sign

    Returns
    -------
    force, extending positive [N]

    Notes
    -----
    Valid: away from the dead points; pin friction left out.

    References
    ----------
    [derived] virtual work, F dl = T dtheta

    Examples
    --------
    >>> actuator_force(torque=120.0, lever_arm=0.04), actuator_force(torque=120.0, lever_arm=0.0)
    (3000.0, inf)
    """
    dead = real(lever_arm) == 0
    limit = _infinite(real(torque))
    return where(dead, limit, joint_force(torque=torque, lever_arm=where(dead, 1.0, lever_arm)))


class ReflectedInertia(NamedTuple):
    """A joint's inertia reflected to the actuator, F = mass dv/dt + velocity_factor v^2."""

    mass: Array
    velocity_factor: Array


def reflected_inertia(*, inertia: Array, lever_arm: Array, lever_slope: Array) -> ReflectedInertia:
    """Joint inertia as the actuator feels it, F = (J/l'^2) dv/dt - (J l''/l'^4) v^2.

    The velocity factor is half the derivative of mass by length, so that the work of F is
    the change of J theta_dot^2/2.

    Parameters
    ----------
    inertia : J about the joint axis [kg m^2]
    lever_arm : l' = dl/dtheta [m]
    lever_slope : l'' = d2l/dtheta2 [m/rad]

    Returns
    -------
    mass [kg] and velocity factor [kg/m]; both are infinite at a dead point (the factor is 0 there
    if l'' = 0)

    Notes
    -----
    Valid: rigid linkage; away from the dead points.

    References
    ----------
    [derived] T = J theta'', l' theta'' = dv/dt - l'' (v/l')^2, F = T/l'

    Examples
    --------
    >>> felt = reflected_inertia(inertia=0.8, lever_arm=0.04, lever_slope=0.01)
    >>> print(f"{felt.mass:.0f} kg, {felt.velocity_factor:.0f} kg/m")
    500 kg, -3125 kg/m
    """
    dead = real(lever_arm) == 0
    arm = where(dead, 1.0, lever_arm)
    mass = inertia / (arm * arm)
    factor = -mass * lever_slope / (arm * arm)
    return ReflectedInertia(
        where(dead, _infinite(real(inertia)), mass),
        where(dead, _infinite(-real(inertia) * real(lever_slope)), factor),
    )


def _infinite(value: Array) -> Array:
    """Infinity with the sign of a real value; 0 if the value is zero."""
    return where(value > 0, math.inf, where(value < 0, -math.inf, 0.0 * value))
