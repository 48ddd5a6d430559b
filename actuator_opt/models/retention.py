"""What holds the ends on: bond, tie rods, pins; and what guides the rod.

Threads live in `rod`, plates in `end_plate`, fatigue and the end of the stroke in `endurance`.
"""

from __future__ import annotations

from math import pi

from ..numeric import Array, absolute, maximum, minimum, namespace, positive, sqrt
from .rod import thread_stress


def _edge_ratio(*, loaded: Array, free: Array, reach: Array) -> Array:
    """Edge over mean shear; reach = G L^2/t_a, K of the loaded and of the ending wall."""
    half = sqrt(positive(reach * (1 / loaded + 1 / free))) / 2
    wave = namespace(half).tanh(half)
    return half * ((1 / wave - wave) + 2 * free / (free + loaded) * wave)  # no term below zero


def bond_peak_ratio(
    *,
    shear_modulus: Array,
    bond_thickness: Array,
    length: Array,
    membrane_stiffness_1: Array,
    membrane_stiffness_2: Array,
) -> Array:
    """Peak over mean shear stress of a bonded overlap.

    (w/2) [coth(w/2) + (s - 1)/(s + 1) tanh(w/2)], w^2 = (G L^2/t_a)(1/K_1 + 1/K_2),
    s = K_1/K_2 >= 1, K_i = E_i t_i. Length beyond w of about 5 brings nothing.

    Parameters
    ----------
    shear_modulus : G of the adhesive [Pa]
    bond_thickness : t_a of the adhesive [m]
    length : L, overlap [m]
    membrane_stiffness_1, membrane_stiffness_2 : axial E t of barrel and skirt, either order [N/m]

    Returns
    -------
    peak over mean [-], at least 1

    Notes
    -----
    Valid: linear adhesive, thin walls against the radius, no peel.

    A ductile adhesive levels the peak: conservative.

    References
    ----------
    [Volkersen1938] shear lag of a lap joint

    Examples
    --------
    >>> r = bond_peak_ratio(shear_modulus=1e9, bond_thickness=0.2e-3, length=20e-3,
    ...                     membrane_stiffness_1=100e6, membrane_stiffness_2=50e6)
    >>> print(f"{r:.4f}")
    5.1662
    """
    return _edge_ratio(
        loaded=minimum(membrane_stiffness_1, membrane_stiffness_2),
        free=maximum(membrane_stiffness_1, membrane_stiffness_2),
        reach=shear_modulus / bond_thickness * length * length,
    )


def bond_shear_peak(
    *,
    force: Array,
    diameter: Array,
    length: Array,
    shear_modulus: Array,
    bond_thickness: Array,
    membrane_stiffness_1: Array,
    membrane_stiffness_2: Array,
) -> Array:
    """Peak shear stress of a bonded cap.

    tau = F/(pi D L) times `bond_peak_ratio`.

    Parameters
    ----------
    force : axial force through the bond [N]
    diameter : diameter of the bond surface [m]
    length : overlap [m]
    shear_modulus, bond_thickness : G and thickness of the adhesive [Pa], [m]
    membrane_stiffness_1, membrane_stiffness_2 : axial E t of barrel and skirt [N/m]

    Returns
    -------
    peak shear stress [Pa]

    Notes
    -----
    Valid: as `bond_peak_ratio`.

    References
    ----------
    [Volkersen1938] shear lag of a lap joint

    Examples
    --------
    >>> tau = bond_shear_peak(force=10e3, diameter=30e-3, length=20e-3, shear_modulus=1e9,
    ...                       bond_thickness=0.2e-3, membrane_stiffness_1=100e6,
    ...                       membrane_stiffness_2=50e6)
    >>> print(f"{tau / 1e6:.2f} MPa")
    27.41 MPa
    """
    ratio = bond_peak_ratio(
        shear_modulus=shear_modulus,
        bond_thickness=bond_thickness,
        length=length,
        membrane_stiffness_1=membrane_stiffness_1,
        membrane_stiffness_2=membrane_stiffness_2,
    )
    return force / (pi * diameter * length) * ratio


def bond_edge_shear(
    *,
    force: Array,
    diameter: Array,
    length: Array,
    shear_modulus: Array,
    bond_thickness: Array,
    membrane_stiffness_loaded: Array,
    membrane_stiffness_free: Array,
) -> Array:
    """Shear stress at one edge of a bonded cap; smooth, unlike the larger of both edges.

    tau = F/(pi D L) (w/2) [coth(w/2) + ((K_f - K_l)/(K_f + K_l)) tanh(w/2)], w as in
    `bond_peak_ratio`; K_l belongs to the wall that carries the whole force at this edge, K_f to
    the one that ends here.

    Parameters
    ----------
    force : axial force through the bond [N]
    diameter : diameter of the bond surface [m]
    length : overlap [m]
    shear_modulus, bond_thickness : G and thickness of the adhesive [Pa], [m]
    membrane_stiffness_loaded, membrane_stiffness_free : axial E t of the two walls [N/m]

    Returns
    -------
    shear stress at the edge [Pa]

    Notes
    -----
    Valid: as `bond_peak_ratio`.

    A plug or a thick sleeve counts with E A/(pi D), D of the bond.

    References
    ----------
    [Volkersen1938] shear lag of a lap joint

    Examples
    --------
    >>> common = dict(force=10e3, diameter=30e-3, length=20e-3, shear_modulus=1e9,
    ...               bond_thickness=0.2e-3)
    >>> tau = bond_edge_shear(**common, membrane_stiffness_loaded=50e6,
    ...                       membrane_stiffness_free=100e6)
    >>> print(f"{tau / 1e6:.2f} MPa")
    27.41 MPa
    """
    ratio = _edge_ratio(
        loaded=membrane_stiffness_loaded,
        free=membrane_stiffness_free,
        reach=shear_modulus / bond_thickness * length * length,
    )
    return force / (pi * diameter * length) * ratio


def bond_thermal_shear(
    *,
    strain_difference: Array,
    length: Array,
    shear_modulus: Array,
    bond_thickness: Array,
    membrane_stiffness_1: Array,
    membrane_stiffness_2: Array,
) -> Array:
    """Shear stress at an edge of a bonded overlap whose walls change length unequally.

    tau = (G L/t_a) (e_l - e_f) tanh(w/2)/w, w as in `bond_peak_ratio`; opposite at the other edge.
    It adds to the shear of a tensile force from `bond_edge_shear`; l is the wall that carries
    that force at this edge, f the one that ends here.

    Parameters
    ----------
    strain_difference : e_l - e_f, free axial strains alpha dT (and swelling) of both walls [-]
    length : L, overlap [m]
    shear_modulus, bond_thickness : G and thickness of the adhesive [Pa], [m]
    membrane_stiffness_1, membrane_stiffness_2 : axial E t of both walls, either order [N/m]

    Returns
    -------
    shear stress at the edge [Pa]

    Notes
    -----
    Valid: as `bond_peak_ratio`; stress-free at the reference temperature (cure).

    The radial stress of unequal hoop expansion is that of the layered tube.

    References
    ----------
    [derived] Volkersen's tau'' = (w/L)^2 tau with tau' = (G/t_a)(e_f - e_l) at both edges

    Examples
    --------
    >>> tau = bond_thermal_shear(strain_difference=22e-6 * 100, length=20e-3, shear_modulus=1e9,
    ...                          bond_thickness=0.2e-3, membrane_stiffness_1=100e6,
    ...                          membrane_stiffness_2=50e6)
    >>> print(f"{tau / 1e6:.2f} MPa")
    28.38 MPa
    """
    lag = shear_modulus / bond_thickness
    flex = 1 / membrane_stiffness_1 + 1 / membrane_stiffness_2
    decay = sqrt(positive(lag * flex))
    return lag * strain_difference / decay * namespace(decay).tanh(decay * length / 2)


def tie_rod_stress(*, force: Array, count: Array, diameter: Array, pitch: Array) -> Array:
    """Tensile stress in the threads of tie rods that share a force evenly.

    sigma = F/(n A_s). The force is the rods' share with preload (`barrel_ends.tie_rod_forces`).

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


def pin_shear_stress(*, force: Array, diameter: Array) -> Array:
    """Mean shear stress of a clevis pin in double shear.

    tau = 2 F/(pi d^2); the largest in a solid round pin is 4/3 of it.

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


def guide_forces(*, side_force: Array, overhang: Array, span: Array) -> tuple[Array, Array]:
    """Split a side force at the rod eye between head bearing and piston.

    F_head = F (a + e)/a, F_piston = F e/a.

    Parameters
    ----------
    side_force : F at the rod eye [N]
    overhang : e, rod eye outside the head bearing [m]
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

    Its pressure p_0 cos(theta) over the loaded half adds up to 4/pi of the force it carries.

    Parameters
    ----------
    force : radial force N on it [N]
    friction_coefficient : mu of ring on surface [-]

    Returns
    -------
    friction [N]

    Notes
    -----
    Valid: ring fits its surface (clearance small against its compression); no oil film.

    A loose ring touches along a line: mu |N|.

    References
    ----------
    [derived] Coulomb friction of the pressure p_0 cos(theta), int p dA = 4 N/pi

    Examples
    --------
    >>> print(f"{guide_friction(force=-2e3, friction_coefficient=0.1):.2f} N")
    254.65 N
    """
    return (4 / pi) * friction_coefficient * absolute(force)
