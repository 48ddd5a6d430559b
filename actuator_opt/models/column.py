"""Buckling of uniform columns (Euler, shear, local shell), and cylinder and rod as a bent beam.

The stepped column is in `stepped`; local buckling forces and moments are in `shell_buckling`. The
beam carries its own weight, a side load and an off-centre push. The push amplifies the moment by a
factor that is exact only if the moment has the shape of the buckling mode. A side force F at the
rod's eye, which the guides carry, bends the rod at the head by F times the distance to the eye.
"""

from __future__ import annotations

from math import pi

from ..base.numeric import Array, geometry, namespace, positive, real, sqrt, where


@geometry
def euler_load(*, bending_stiffness: Array, effective_length: Array) -> Array:
    """Euler's critical load.

    P = pi^2 EI/(K L)^2.

    Parameters
    ----------
    bending_stiffness : EI [N m^2]
    effective_length : K L [m]: L pinned-pinned, 2 L fixed-free, 0.699 L fixed-pinned, L/2
        fixed-fixed

    Returns
    -------
    critical load [N]

    Notes
    -----
    Valid: elastic, slender, one section.

    References
    ----------
    [TimoshenkoGere1961] uniform column

    Examples
    --------
    >>> p = euler_load(bending_stiffness=210e9 * 3216.99e-12, effective_length=0.6)
    >>> print(f"{p / 1e3:.3f} kN")
    18.521 kN
    """
    return pi * pi * bending_stiffness / (effective_length * effective_length)


def cowper_tube(*, poissons_ratio: Array, radius_ratio: Array) -> Array:
    """Shear coefficient of a round tube.

    kappa = 6 (1 + nu)(1 + m^2)^2/[(7 + 6 nu)(1 + m^2)^2 + (20 + 12 nu) m^2], m = r_i/r_o.

    Parameters
    ----------
    poissons_ratio : Poisson's ratio [-]
    radius_ratio : m [-], 0 for a solid bar

    Returns
    -------
    kappa [-]

    Notes
    -----
    Valid: isotropic; usual for composite tubes with their axial-hoop Poisson's ratio.

    References
    ----------
    [Cowper1966] hollow circular section

    Examples
    --------
    >>> print(f"{cowper_tube(poissons_ratio=0.28, radius_ratio=0.75):.6f}")
    0.546147
    """
    hollow = radius_ratio * radius_ratio
    square = (1 + hollow) * (1 + hollow)
    below = (7 + 6 * poissons_ratio) * square + (20 + 12 * poissons_ratio) * hollow
    return 6 * (1 + poissons_ratio) * square / below


def engesser_load(*, critical_load: Array, shear_stiffness: Array) -> Array:
    """Critical load of a column that also deforms in shear.

    P = P_E/(1 + P_E/(kappa G A)).

    Parameters
    ----------
    critical_load : P_E, load by bending alone [N]
    shear_stiffness : kappa G A [N]

    Returns
    -------
    critical load [N]

    Notes
    -----
    Valid: exact for a uniform pinned column, on the safe side for others.

    For a column of two segments pass `stepped.mode_shear_stiffness`.

    References
    ----------
    [TimoshenkoGere1961] effect of shearing force

    Examples
    --------
    >>> engesser_load(critical_load=100.0, shear_stiffness=900.0)
    90.0
    """
    return critical_load / (1 + critical_load / shear_stiffness)


@geometry
def local_shell_knockdown(*, radius: Array, thickness: Array) -> Array:
    """Knock-down of a thin shell's axial buckling stress for its imperfections.

    gamma = 1 - 0.901 (1 - exp(-sqrt(R/t)/16)).

    Parameters
    ----------
    radius : mid-radius [m]
    thickness : wall thickness [m]

    Returns
    -------
    gamma [-]

    Notes
    -----
    Valid: R/t < 1500.

    References
    ----------
    [NASA-SP-8007] unstiffened isotropic cylinder, axial compression

    Examples
    --------
    >>> print(f"{local_shell_knockdown(radius=15.0, thickness=1.2):.5f}")
    0.82137
    """
    slender = sqrt(radius / thickness) / 16
    return 1 - 0.901 * (1 - namespace(slender).exp(-slender))


@geometry
def local_shell_stress(
    *,
    youngs_modulus: Array,
    thickness: Array,
    radius: Array,
    poissons_ratio: Array,
    knockdown: Array | None = None,
) -> Array:
    """Axial stress at which the wall of a compressed tube buckles locally.

    sigma = gamma E t/(R sqrt(3 (1 - nu^2))).

    Parameters
    ----------
    youngs_modulus : Young's modulus; `shell_buckling.shell_modulus` of a laminate [Pa]
    thickness : wall thickness [m]
    radius : mid-radius [m]
    poissons_ratio : Poisson's ratio; sqrt(nu_ztheta nu_thetaz) of a laminate [-]
    knockdown : gamma [-]; None takes `local_shell_knockdown`, 1 gives the classical stress

    Returns
    -------
    stress [Pa]

    Notes
    -----
    Valid: thin shells longer than about their radius.

    References
    ----------
    [TimoshenkoGere1961] axially compressed cylindrical shell, [NASA-SP-8007]

    Examples
    --------
    >>> s = local_shell_stress(youngs_modulus=70e9, thickness=1.2e-3, radius=15e-3,
    ...                        poissons_ratio=0.3)
    >>> print(f"{s / 1e6:.1f} MPa")
    2783.8 MPa
    """
    if knockdown is None:
        knockdown = local_shell_knockdown(radius=radius, thickness=thickness)
    curve = radius * sqrt(3 * (1 - poissons_ratio * poissons_ratio))
    return knockdown * youngs_modulus * thickness / curve


@geometry
def self_weight_moments(
    *, weight_1: Array, length_1: Array, weight_2: Array, length_2: Array
) -> tuple[Array, Array, Array]:
    """Bending moments of a horizontal cylinder, pinned at both eyes, under its own weight.

    Where the segments meet, M = L1 L2 (w1 L1 + w2 L2)/(2 L). With the reaction
    R_i = M/L_i + w_i L_i/2 of its pin, the largest moment in segment i is R_i^2/(2 w_i) if
    R_i < w_i L_i, and M otherwise.

    Parameters
    ----------
    weight_1, weight_2 : weight per length of barrel (with oil) and rod [N/m]
    length_1, length_2 : from the barrel's eye to the head, from there to the rod's eye [m]

    Returns
    -------
    moments: M where the segments meet, largest in segment 1, largest in segment 2 [N m]

    Notes
    -----
    Valid: horizontal, pinned at both ends, each weight even along its segment.

    References
    ----------
    [derived] equilibrium of a beam on two supports

    Examples
    --------
    >>> moments = self_weight_moments(weight_1=40.0, length_1=0.8, weight_2=25.0, length_2=0.6)
    >>> print(*(f"{m:.3f}" for m in moments))
    8.057 8.496 8.057
    """
    joint = length_1 * length_2 / (length_1 + length_2)
    joint = joint * (weight_1 * length_1 + weight_2 * length_2) / 2

    def largest(weight: Array, length: Array) -> Array:
        load = weight * length
        reaction = joint / length + load / 2
        inside = real(reaction) < real(load)
        divisor = where(inside, weight, 0 * weight + 1)
        return where(inside, reaction * reaction / (2 * divisor), joint)

    return joint, largest(weight_1, length_1), largest(weight_2, length_2)


def amplified_moment(
    *, bending_moment: Array, axial_force: Array, critical_load: Array, shape: Array = 0.0
) -> Array:
    """Bending moment of a beam-column: the moment without axial push, amplified by the push.

    M (1 + psi P/P_cr)/(1 - P/P_cr). This is exact for a uniform column whose moment has the shape
    of its buckling mode. For a uniform pinned column at mid-span psi = 0.03 for a uniform load,
    -0.18 for a load in the middle, 4/pi - 1 (safe) for a push off-centre at both ends.

    Parameters
    ----------
    bending_moment : M, largest along the beam before the push amplifies it [N m]
    axial_force : P, push positive [N]
    critical_load : P_cr of the same column [N]
    shape : psi, correction for the shape of the moment [-]

    Returns
    -------
    moment [N m]; NaN at and above the critical load

    Notes
    -----
    Valid: P < P_cr; elastic.

    For the largest moment in the rod of a stepped cylinder, with psi = 0 and P/P_cr up to 1/3.5,
    the result is between 4 % too low and 14 % too high if the moment is due to weight, and 4 to 8 %
    too low if it is due to a push that is off-centre at both ends.

    References
    ----------
    [TimoshenkoGere1961] beam-columns, approximate formula

    Examples
    --------
    >>> m = amplified_moment(bending_moment=10.0, axial_force=9e3, critical_load=30e3)
    >>> print(f"{m:.3f} N m")
    14.286 N m
    """
    ratio = axial_force / critical_load
    return bending_moment * (1 + shape * ratio) / positive(1 - ratio)


@geometry
def bending_axial_force(
    *, bending_moment: Array, radius: Array, axial_stiffness: Array, bending_stiffness: Array
) -> Array:
    """Axial force whose strain equals the bending strain of the fibre at a radius.

    N = M r EA/EI. Added to the axial force of a layered tube it gives the plies' stresses on the
    most strained side; for a single material it is M A r/I.

    Parameters
    ----------
    bending_moment : M [N m]
    radius : r of the fibre [m]; the outer radius has the largest strain
    axial_stiffness : EA of the section [N]
    bending_stiffness : EI of the section [N m^2]

    Returns
    -------
    axial force [N]

    Notes
    -----
    Valid: linear elastic, slender; the strain of one fibre is taken for the whole section.

    References
    ----------
    [derived] strain M r/EI equals strain N/EA

    Examples
    --------
    >>> n = bending_axial_force(bending_moment=20.0, radius=8e-3, axial_stiffness=9.32e6,
    ...                         bending_stiffness=215.4)
    >>> print(f"{n / 1e3:.3f} kN")
    6.923 kN
    """
    return bending_moment * radius * axial_stiffness / bending_stiffness
