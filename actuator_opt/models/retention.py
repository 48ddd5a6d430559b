"""Retention of the ends by tie rods or pins, and guidance of the rod.

Bonds are in `lap_joint`, the rod's thread in `rod`, the thread of the caps in `thread`, plates in
`end_plate`, fatigue and the end of the stroke in `endurance`.
"""

from __future__ import annotations

from math import pi

from ..base.numeric import Array, absolute, geometry, maximum, minimum
from .rod import thread_stress


@geometry
def tie_rod_stress(*, force: Array, count: Array, diameter: Array, pitch: Array) -> Array:
    """Tensile stress in the threads of tie rods that share a force evenly.

    sigma = F/(n A_s). The force is what the rods carry, preload included
    (`barrel_ends.tie_rod_forces`).

    Parameters
    ----------
    force : total force of the rods [N]
    count : number of rods [-]
    diameter, pitch : of the metric thread [m]

    Returns
    -------
    stress [Pa]

    Notes
    -----
    Valid: even sharing, no bending.

    References
    ----------
    [ISO898-1] stress area

    Examples
    --------
    >>> s = tie_rod_stress(force=20e3, count=4, diameter=6e-3, pitch=1e-3)
    >>> print(f"{s / 1e6:.1f} MPa")
    248.5 MPa
    """
    return thread_stress(force=force / count, diameter=diameter, pitch=pitch)


@geometry
def pin_shear_stress(*, force: Array, diameter: Array) -> Array:
    """Mean shear stress of a clevis pin in double shear.

    tau = 2 F/(pi d^2); the largest shear stress in a solid round pin is 4/3 of this mean.

    Parameters
    ----------
    force : force on the pin [N]
    diameter : pin diameter [m]

    Returns
    -------
    mean shear stress [Pa]

    Notes
    -----
    Valid: close fit, two shear planes; bending of the pin is not included.

    References
    ----------
    [Shigley2011] direct shear

    Examples
    --------
    >>> print(f"{pin_shear_stress(force=10e3, diameter=10e-3) / 1e6:.2f} MPa")
    63.66 MPa
    """
    return 2 * force / (pi * diameter * diameter)


@geometry
def guide_forces(*, side_force: Array, overhang: Array, span: Array) -> tuple[Array, Array]:
    """Split a side force at the rod eye between head bearing and piston.

    F_head = F (a + e)/a, F_piston = F e/a.

    Parameters
    ----------
    side_force : F at the rod eye [N]
    overhang : e, distance of the rod eye beyond the head bearing [m]
    span : a, distance between head bearing and piston [m]

    Returns
    -------
    head and piston force [N]

    Notes
    -----
    Valid: rigid rod, bearings as points; a is smallest at full extension.

    References
    ----------
    [derived] moment balance

    Examples
    --------
    >>> guide_forces(side_force=100.0, overhang=0.2, span=0.1)
    (300.0, 200.0)
    """
    piston = side_force * overhang / span
    return side_force + piston, piston


@geometry
def through_rod_guide_forces(
    *,
    side_force: Array,
    overhang: Array,
    span: Array,
    second_span: Array,
    bending_stiffness: Array,
    second_bending_stiffness: Array,
    clearance: Array,
    piston_clearance: Array,
    second_clearance: Array,
) -> tuple[Array, Array, Array]:
    """Share of a side force on the head bearing, the piston and the bearing of a second rod.

    The rods are a beam over three bearings with play. With M = F e, spans b1 and b2, L = b1 + b2,
    the beam on the outer bearings sags at the piston by M f_M - P f_P:

    f_M = b1^2 b2 (1/2 - b1/(3 L))/(L EI1) + b1 b2^3/(3 L^2 EI2),
    f_P = b1^2 b2^2 (b1/EI1 + b2/EI2)/(3 L^2).

    The rod tilts by the play at the head. Up to a sag d = c_P + c_H - (c_H + c_2) b1/L the piston
    carries nothing, P = 0; then P = (M f_M - d)/f_P until P = M/b1, where the second bearing
    is free; it takes load on its other side from a sag of d + 2 c_2 b1/L on.

    Parameters
    ----------
    side_force : F at the rod eye [N]
    overhang : e, distance of the rod eye beyond the head bearing [m]
    span, second_span : b1 from head bearing to piston, b2 from there to the second bearing [m]
    bending_stiffness, second_bending_stiffness : EI1, EI2 of the rods [N m^2]
    clearance, piston_clearance, second_clearance : radial play c_H, c_P and c_2 [m]

    Returns
    -------
    forces of the head bearing, against F; of the piston, along F; and of the second bearing, along
    F if positive [N]

    Notes
    -----
    Valid: bearings as points, barrel and bearings rigid, piston no stiffer than the rods.

    References
    ----------
    [derived] unit-load theorem for a beam with one redundant support; equals the theorem of three
    moments without play, and `guide_forces` where the second bearing is free

    Examples
    --------
    >>> stiff = {"bending_stiffness": 1600.0, "second_bending_stiffness": 1600.0}
    >>> spans = {"overhang": 0.2, "span": 0.1, "second_span": 0.1}
    >>> for c in (0.0, 50e-6):
    ...     play = dict.fromkeys(("clearance", "piston_clearance", "second_clearance"), c)
    ...     forces = through_rod_guide_forces(side_force=100.0, **spans, **stiff, **play)
    ...     print(*(f"{force:.1f}" for force in forces))
    350.0 300.0 -50.0
    200.0 0.0 100.0
    """
    moment, whole = side_force * overhang, span + second_span
    first, second = 1 / bending_stiffness, 1 / second_bending_stiffness
    tilted = span * span * second_span * (0.5 - span / (3 * whole)) / whole * first
    tilted = tilted + span * second_span**3 / (3 * whole * whole) * second
    pressed = span * second_span / whole
    pressed = pressed * pressed * (span * first + second_span * second) / 3
    play = piston_clearance + clearance - (clearance + second_clearance) * span / whole
    below = (moment * tilted - play) / pressed
    above = below - 2 * second_clearance * span / whole / pressed
    piston = maximum(minimum(maximum(below, 0.0), moment / span), above)
    far = (moment - piston * span) / whole
    return side_force + piston + far, piston, far


@geometry
def bearing_pressure(*, force: Array, diameter: Array, length: Array) -> Array:
    """Mean pressure on a plain bearing or pin.

    p = F/(d L), on the projected area.

    Parameters
    ----------
    force : radial force [N]
    diameter : diameter of the bearing [m]
    length : bearing length [m]

    Returns
    -------
    pressure [Pa]

    Notes
    -----
    Valid: even load along the bearing; its edges carry more when the rod tilts.

    References
    ----------
    [Shigley2011] nominal bearing pressure

    Examples
    --------
    >>> print(f"{bearing_pressure(force=300.0, diameter=12e-3, length=10e-3) / 1e6:.2f} MPa")
    2.50 MPa
    """
    return force / (diameter * length)


def guide_friction(*, force: Array, friction_coefficient: Array) -> Array:
    """Friction of a guide ring or plain bearing under a radial force, F = (4/pi) mu |N|.

    The pressure p_0 cos(theta) over the loaded half adds up to 4/pi times the radial force.

    Parameters
    ----------
    force : radial force N on the ring [N]
    friction_coefficient : mu of ring on surface [-]

    Returns
    -------
    friction [N]

    Notes
    -----
    Valid: ring fits its surface (clearance small against its compression); no oil film.

    A loose ring touches along a line, and its friction is mu |N|.

    References
    ----------
    [derived] Coulomb friction of the pressure p_0 cos(theta), int p dA = 4 N/pi

    Examples
    --------
    >>> print(f"{guide_friction(force=-2e3, friction_coefficient=0.1):.2f} N")
    254.65 N
    """
    return (4 / pi) * friction_coefficient * absolute(force)
