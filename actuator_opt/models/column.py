"""Buckling of uniform columns: Euler, shear correction, local shell.

The stepped column lives in `stepped`; forces and moments of a laminated wall in `shell_buckling`.
"""

from __future__ import annotations

from math import pi

from ..base.numeric import Array, geometry, namespace, sqrt


@geometry
def euler_load(*, bending_stiffness: Array, effective_length: Array) -> Array:
    """Euler's critical load.

    P = pi^2 EI/(K L)^2.

    Parameters
    ----------
    bending_stiffness : EI [N m^2]
    effective_length : K L [m]: L pinned-pinned, 2 L fixed-free, 0.699 L fixed-pinned, L/2 fixed

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
    """Critical load of a column that also gives in shear.

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

    A column of two segments takes `stepped.mode_shear_stiffness`.

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
    knockdown : gamma [-]; None takes `local_shell_knockdown`, 1 the classical stress

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
