"""The piston on the rod: clamped between a shoulder of the rod and a nut on its stud.

Tie rods share the nut's proportions, and what tightening and settling make of a preload.
"""

from __future__ import annotations

from math import pi

from ..base.numeric import Array, geometry, minimum, namespace, sqrt

FLATS, HEIGHT = 1.5, 0.8
"""Width across flats and height of a hexagon nut, in thread diameters: those of ISO 4032 are 1.5 to
1.63 and 0.8 to 0.9 from M8 to M64."""
THREADS = 0.9
"""Length of stud that gives as much as the engaged thread and the nut, in thread diameters: 0.5 and
0.4 [VDI2230]."""
SPREAD = 3**-0.5
"""Tangent of the angle at which pressure spreads in clamped parts, 30 degrees [Shigley2011]."""
TIGHTENING = 1.6
"""Greatest divided by least preload that one setting of a torque wrench gives. [VDI2230] states 1.4
to 1.6 for torques found by trials on the joint, and 1.6 to 2 for estimated friction."""
FRICTION = 0.12
"""Friction coefficient of a thread as it is tightened: the middle of class B of [VDI2230], 0.08 to
0.16, with oil or grease."""
USED, LEFT = 0.9, 0.5
"""Share of the yield strength that tightening may use, and share of its torsion that stays
[VDI2230]."""
THREAD_SETTLING, SEAT_SETTLING, JOINT_SETTLING = 3e-6, 2.5e-6, 1.5e-6
"""Depth by which a thread, a seat of nut or head, and each other face settle in use [m]. They are
guide values of [VDI2230], for forces along the bolt and faces smoother than Rz 10 um."""


@geometry
def preload_range(*, preload: Array, tightening_factor: Array) -> tuple[Array, Array]:
    """Least and greatest preload after tightening to a stated one.

    F_min = 2 F/(1 + alpha), F_max = alpha F_min: the stated preload is the mean of both.

    Parameters
    ----------
    preload : F [N]
    tightening_factor : alpha, greatest divided by least preload [-]

    Returns
    -------
    least and greatest preload [N]

    Notes
    -----
    Valid: alpha >= 1.

    References
    ----------
    [VDI2230] tightening factor, scatter (alpha - 1)/(alpha + 1) on either side of the mean

    Examples
    --------
    >>> least, greatest = preload_range(preload=13e3, tightening_factor=1.6)
    >>> print(f"{least:.0f} N to {greatest:.0f} N")
    10000 N to 16000 N
    """
    least = 2 * preload / (1 + tightening_factor)
    return least, tightening_factor * least


@geometry
def torsion_factor(*, diameter: Array, pitch: Array, share: Array = 1.0) -> Array:
    """Equivalent stress of a tightened thread divided by its tensile stress.

    sqrt(1 + 3 (c tau/sigma)^2), tau/sigma = 2 (d_2/d_s) (P/(pi d_2) + 2/sqrt(3) mu), with d_2 =
    d - 0.6495 P, d_s = d - 0.9382 P, and friction coefficient mu = 0.12.

    Parameters
    ----------
    diameter, pitch : d and P of the thread [m]
    share : c, share of the torsion of tightening that acts [-]

    Returns
    -------
    factor [-]

    Notes
    -----
    Valid: metric threads, flanks at 30 deg.

    References
    ----------
    [VDI2230] torque in the thread, equivalent stress; [ISO898-1] stress diameter

    Examples
    --------
    >>> print(f"{torsion_factor(diameter=8e-3, pitch=1e-3):.4f}")
    1.1958
    """
    flank, stressed = diameter - 0.6495 * pitch, diameter - 0.9382 * pitch
    lead = pitch / (pi * flank) + 2 / 3**0.5 * FRICTION
    ratio = share * 2 * flank / stressed * lead
    return sqrt(1 + 3 * ratio * ratio)


@geometry
def settling_loss(*, threads: Array, seats: Array, joints: Array, compliance: Array) -> Array:
    """Preload that a joint loses as its faces settle, f/(delta_s + delta_p).

    f = 3 um a thread + 2.5 um a seat of nut or head + 1.5 um each other joint face.

    Parameters
    ----------
    threads, seats, joints : number of threads, seats and other faces that the force passes [-]
    compliance : delta_s + delta_p, give of what pulls and of what is clamped, per force [m/N]

    Returns
    -------
    force [N]

    Notes
    -----
    Valid: metal faces smoother than Rz 10 um, tightened once; creep is left out.

    References
    ----------
    [VDI2230] guide values of embedding, loss of preload

    Examples
    --------
    >>> loss = settling_loss(threads=1, seats=2, joints=0, compliance=2e-9)
    >>> print(f"{loss:.0f} N")
    4000 N
    """
    depth = THREAD_SETTLING * threads + SEAT_SETTLING * seats + JOINT_SETTLING * joints
    return depth / compliance


@geometry
def stud_share(
    *, diameter: Array, shoulder_diameter: Array, stud_modulus: Array, piston_modulus: Array
) -> Array:
    """Share of a force on the piston that the stud feels.

    phi = E_s d^2/(E_s d^2 + E_p (D^2 - d^2)): stud and clamped part of the piston are springs of
    equal length in parallel. The clamped part is a sleeve whose outer diameter D is that of the
    shoulder, or the nut's width if that is smaller.

    Parameters
    ----------
    diameter : d of the stud's thread [m]
    shoulder_diameter : outer diameter of the rod's shoulder [m]
    stud_modulus, piston_modulus : Young's moduli E_s and E_p [Pa]

    Returns
    -------
    share [-], 0 to 1

    Notes
    -----
    Valid: the joint stays closed; an upper bound.

    The nut's threads and the spread of pressure in the piston are left out; both lower the share.
    `least_stud_share` is a lower bound.

    References
    ----------
    [VDI2230] load factor of a bolted joint; [derived] sleeve instead of the pressure cone

    Examples
    --------
    >>> share = stud_share(diameter=8e-3, shoulder_diameter=12e-3, stud_modulus=206e9,
    ...                    piston_modulus=71.7e9)
    >>> print(f"{share:.4f}")
    0.6968
    """
    width = FLATS * diameter
    outer = minimum(shoulder_diameter, width)
    square = diameter * diameter
    stud = stud_modulus * square
    return stud / (stud + piston_modulus * (outer * outer - square))


def _gives(
    diameter: Array,
    piston_diameter: Array,
    length: Array,
    stud_modulus: Array,
    piston_modulus: Array,
) -> tuple[Array, Array]:
    """Give of stud and clamped piston per force [m/N]; the whole width of the piston is clamped."""
    clamped = piston_modulus * (piston_diameter * piston_diameter - diameter * diameter)
    return _stud_give(diameter, length, stud_modulus), 4 / pi * length / clamped


def _stud_give(diameter: Array, length: Array, modulus: Array) -> Array:
    """Give of the stud with its engaged thread and the nut per force [m/N]."""
    return 4 / pi * (length + THREADS * diameter) / (modulus * diameter * diameter)


@geometry
def least_stud_share(
    *,
    diameter: Array,
    piston_diameter: Array,
    length: Array,
    stud_modulus: Array,
    piston_modulus: Array,
) -> Array:
    """Lower bound of the share of a force on the piston that the stud feels.

    phi = delta_p/(delta_s + delta_p), with delta_s = (l + 0.9 d)/(E_s pi d^2/4) of the stud, its
    engaged thread and the nut, and delta_p = l/(E_p pi (D^2 - d^2)/4) of the piston.

    Parameters
    ----------
    diameter : d of the stud's thread [m]
    piston_diameter : D of the piston, all of which counts as clamped [m]
    length : l between shoulder and nut [m]
    stud_modulus, piston_modulus : Young's moduli E_s and E_p [Pa]

    Returns
    -------
    share [-], 0 to 1

    Notes
    -----
    Valid: the joint stays closed, and the force enters at the shoulder.

    References
    ----------
    [VDI2230] load factor, give of thread and nut; [derived] whole piston instead of its cone

    Examples
    --------
    >>> share = least_stud_share(diameter=8e-3, piston_diameter=21.4e-3, length=6e-3,
    ...                          stud_modulus=206e9, piston_modulus=71.7e9)
    >>> print(f"{share:.4f}")
    0.1750
    """
    stud, piston = _gives(diameter, piston_diameter, length, stud_modulus, piston_modulus)
    return piston / (stud + piston)


def _frustum_give(seat: Array, diameter: Array, height: Array, modulus: Array) -> Array:
    """Give per force [m/N] of the half of the clamped piston under a seat of this diameter."""
    spread = 2 * SPREAD * height
    ratio = 1 + 2 * diameter * spread / ((seat + spread + diameter) * (seat - diameter))
    return namespace(ratio).log(ratio) / (SPREAD * pi * modulus * diameter)


@geometry
def clamp_compliance(
    *,
    diameter: Array,
    shoulder_diameter: Array,
    length: Array,
    stud_modulus: Array,
    piston_modulus: Array,
) -> Array:
    """Give of stud and clamped piston together per force, delta_s + delta_p.

    delta_p is that of two hollow frusta of half the length l, whose pressure spreads at 30 deg from
    the seats of shoulder and nut, of diameter D: ln[(D + l tan 30 - d)(D + d)/((D + l tan 30 + d)
    (D - d))]/(pi E_p d tan 30) each. delta_s is that of `least_stud_share`.

    Parameters
    ----------
    diameter : d of the stud's thread [m]
    shoulder_diameter : outer diameter of the rod's shoulder [m]; that of the nut's seat is 1.5 d
    length : l between shoulder and nut [m]
    stud_modulus, piston_modulus : Young's moduli E_s and E_p [Pa]

    Returns
    -------
    compliance [m/N]

    Notes
    -----
    Valid: frusta within the piston, l/2 below its width beside the seat.

    References
    ----------
    [Shigley2011] stiffness of clamped members; [VDI2230] give of bolt, thread and nut

    Examples
    --------
    >>> give = clamp_compliance(diameter=8e-3, shoulder_diameter=12e-3, length=6e-3,
    ...                         stud_modulus=206e9, piston_modulus=71.7e9)
    >>> print(f"{1e9 * give:.4f} um/kN")
    2.1669 um/kN
    """
    size = {"diameter": diameter, "height": length / 2, "modulus": piston_modulus}
    seats = shoulder_diameter, FLATS * diameter
    return _stud_give(diameter, length, stud_modulus) + sum(
        _frustum_give(seat, **size) for seat in seats
    )


@geometry
def preload_change(
    *,
    diameter: Array,
    piston_diameter: Array,
    length: Array,
    stud_modulus: Array,
    piston_modulus: Array,
    strain_difference: Array,
) -> Array:
    """Change of the nut's preload with temperature, l (e_p - e_s)/(delta_s + delta_p).

    Parameters
    ----------
    diameter : d of the stud's thread [m]
    piston_diameter : D of the piston, all of which counts as clamped [m]
    length : l between shoulder and nut [m]
    stud_modulus, piston_modulus : Young's moduli E_s and E_p [Pa]
    strain_difference : e_p - e_s, free thermal strain of the piston minus that of the stud [-]

    Returns
    -------
    force [N], positive for a larger preload

    Notes
    -----
    Valid: elastic, one temperature throughout. delta_s and delta_p are those of
    `least_stud_share`.

    References
    ----------
    [VDI2230] thermal change of preload

    Examples
    --------
    >>> force = preload_change(diameter=8e-3, piston_diameter=21.4e-3, length=6e-3,
    ...                        stud_modulus=206e9, piston_modulus=71.7e9, strain_difference=6.6e-4)
    >>> print(f"{force:.1f} N")
    2562.7 N
    """
    gives = _gives(diameter, piston_diameter, length, stud_modulus, piston_modulus)
    return length * strain_difference / sum(gives)


@geometry
def shoulder_area(*, diameter: Array, shoulder_diameter: Array) -> Array:
    """Area on which the rod's shoulder bears on the piston, pi (D^2 - d^2)/4.

    Parameters
    ----------
    diameter : d of the stud, and of the hole in the piston [m]
    shoulder_diameter : outer diameter D of the shoulder [m]

    Returns
    -------
    area [m^2]

    Notes
    -----
    Valid: chamfers small compared with the shoulder.

    References
    ----------
    [derived] area of an annulus

    Examples
    --------
    >>> area = shoulder_area(diameter=8e-3, shoulder_diameter=12e-3)
    >>> print(f"{area * 1e6:.4f} mm2")
    62.8319 mm2
    """
    return pi / 4 * (shoulder_diameter * shoulder_diameter - diameter * diameter)


@geometry
def nut_volume(*, diameter: Array) -> Array:
    """Volume of a hexagon nut, (sqrt(3)/2 s^2 - pi d^2/4) m, with s = 1.5 d and m = 0.8 d.

    Parameters
    ----------
    diameter : d of the thread [m]

    Returns
    -------
    volume [m^3]

    Notes
    -----
    Valid: nuts of ISO 4032; its chamfers are left out.

    References
    ----------
    [ISO4032] proportions; [derived] hexagon less the thread's nominal cylinder

    Examples
    --------
    >>> print(f"{nut_volume(diameter=8e-3) * 1e9:.2f} mm3")
    476.43 mm3
    """
    section = (3**0.5 / 2 * FLATS * FLATS - pi / 4) * diameter * diameter
    return section * HEIGHT * diameter


@geometry
def corner_radius(*, diameter: Array) -> Array:
    """Radius over the corners of a hexagon nut, s/sqrt(3), with s = 1.5 d.

    Parameters
    ----------
    diameter : d of the thread [m]

    Returns
    -------
    radius [m]

    Notes
    -----
    Valid: nuts of ISO 4032.

    References
    ----------
    [ISO4032] proportions

    Examples
    --------
    >>> print(f"{corner_radius(diameter=8e-3) * 1e3:.3f} mm")
    6.928 mm
    """
    return FLATS * diameter / 3**0.5


@geometry
def web_stress(*, force: Array, radius: Array, reach_length: Array, thickness: Array) -> Array:
    """Equivalent stress of the piston's web, which carries a force from ring to shoulder or nut.

    sqrt((3 V a/t^2)^2 + 3 (V/t)^2), V = F/(2 pi r): an edge that may not turn at either side
    carries the moment V a/2, and the shear force V.

    Parameters
    ----------
    force : F on the web [N]
    radius : r at which the web is supported [m]
    reach_length : a, radial distance from the support to the ring, not negative [m]
    thickness : t of the web [m]

    Returns
    -------
    stress [Pa]

    Notes
    -----
    Valid: ring and support much stiffer than the web; an upper bound away from notches.

    Hoop stress in the web, which carries a part of the load, is left out.

    References
    ----------
    [derived] guided beam of the web's thickness; von Mises stress

    Examples
    --------
    >>> sigma = web_stress(force=5e3, radius=5.5e-3, reach_length=1.4e-3, thickness=2e-3)
    >>> print(f"{sigma / 1e6:.1f} MPa")
    196.9 MPa
    """
    shear = force / (2 * pi * radius) / thickness
    bending = 3 * shear * reach_length / thickness
    return sqrt(bending * bending + 3 * shear * shear)
