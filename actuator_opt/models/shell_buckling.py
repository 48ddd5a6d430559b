"""Local buckling of the wall of a compressed or bent tube, isotropic or laminated.

Forces and moments are those of the whole tube; the stress and its knock-down in compression are in
`column`.
"""

from __future__ import annotations

from math import pi

from ..base.numeric import Array, geometry, minimum, namespace, sqrt
from .column import local_shell_stress


def shell_modulus(
    *,
    axial_modulus: Array,
    hoop_modulus: Array,
    shear_modulus: Array,
    poissons_ratio: Array,
) -> Array:
    """Modulus with which an orthotropic wall buckles like an isotropic one.

    E = sqrt(E_z E_theta) min(1, sqrt(2 G (1 + nu)/sqrt(E_z E_theta))): the wall buckles in rings,
    or in diamonds where it is soft in shear. For an isotropic wall the result is E.

    Parameters
    ----------
    axial_modulus, hoop_modulus : E_z and E_theta of the wall [Pa]
    shear_modulus : G_ztheta of the wall [Pa]
    poissons_ratio : sqrt(nu_ztheta nu_thetaz) [-]

    Returns
    -------
    modulus for `column.local_shell_stress`, `local_shell_force`, `local_shell_moment` [Pa]

    Notes
    -----
    Valid: thin wall, layers mixed evenly through it; much longer than sqrt(R t).

    References
    ----------
    [derived] least of N(p, q) of Donnell's equations for an orthotropic shell over all wave
    numbers, in closed form

    Examples
    --------
    >>> e = shell_modulus(axial_modulus=138e9, hoop_modulus=9e9, shear_modulus=5e9,
    ...                   poissons_ratio=0.0715)
    >>> print(f"{e / 1e9:.2f} GPa, not {(138 * 9) ** 0.5:.2f}")
    19.43 GPa, not 35.24
    """
    mean = sqrt(axial_modulus * hoop_modulus)
    skew = 2 * shear_modulus * (1 + poissons_ratio)
    return minimum(mean, sqrt(mean * skew))


@geometry
def local_shell_force(
    *,
    youngs_modulus: Array,
    thickness: Array,
    radius: Array,
    poissons_ratio: Array,
    knockdown: Array | None = None,
) -> Array:
    """Axial force at which the wall of a compressed tube buckles locally.

    P = 2 pi R t sigma = 2 pi gamma E t^2/sqrt(3 (1 - nu^2)).

    Parameters
    ----------
    youngs_modulus : Young's modulus; `shell_modulus` of a laminate [Pa]
    thickness : wall thickness [m]
    radius : mid-radius [m]
    poissons_ratio : Poisson's ratio; sqrt(nu_ztheta nu_thetaz) of a laminate [-]
    knockdown : gamma [-]; None takes `column.local_shell_knockdown`, 1 gives the classical force

    Returns
    -------
    force [N]

    Notes
    -----
    Valid: thin shells longer than about their radius.

    Combined with bending, P/P_cr + M/M_cr <= 1 must hold, with M_cr from `local_shell_moment`.

    References
    ----------
    [TimoshenkoGere1961] axially compressed cylindrical shell, [NASA-SP-8007]

    Examples
    --------
    >>> p = local_shell_force(youngs_modulus=70e9, thickness=1.2e-3, radius=15e-3,
    ...                       poissons_ratio=0.3)
    >>> print(f"{p / 1e3:.2f} kN")
    314.84 kN
    """
    stress = local_shell_stress(
        youngs_modulus=youngs_modulus,
        thickness=thickness,
        radius=radius,
        poissons_ratio=poissons_ratio,
        knockdown=knockdown,
    )
    return 2 * pi * radius * thickness * stress


@geometry
def bending_shell_knockdown(*, radius: Array, thickness: Array) -> Array:
    """Knock-down factor of a bent thin shell's buckling stress, closer to 1 than in compression.

    gamma = 1 - 0.731 (1 - exp(-sqrt(R/t)/16)): only part of the wall sees the largest stress.

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
    [NASA-SP-8007] unstiffened isotropic cylinder, bending

    Examples
    --------
    >>> print(f"{bending_shell_knockdown(radius=15.0, thickness=1.2):.5f}")
    0.85507
    """
    slender = sqrt(radius / thickness) / 16
    return 1 - 0.731 * (1 - namespace(slender).exp(-slender))


@geometry
def local_shell_moment(
    *,
    youngs_modulus: Array,
    thickness: Array,
    radius: Array,
    poissons_ratio: Array,
    knockdown: Array | None = None,
) -> Array:
    """Bending moment at which the wall of a tube buckles locally, or a long tube flattens.

    The result is the lower of pi R^2 t sigma = pi gamma E R t^2/sqrt(3 (1 - nu^2)) and Brazier's
    (2 sqrt(2) pi/9) E R t^2/sqrt(1 - nu^2); the second governs up to R/t of about 240.

    Parameters
    ----------
    youngs_modulus : Young's modulus; `shell_modulus` of a laminate [Pa]
    thickness : wall thickness [m]
    radius : mid-radius [m]
    poissons_ratio : Poisson's ratio; sqrt(nu_ztheta nu_thetaz) of a laminate [-]
    knockdown : gamma [-]; None takes `bending_shell_knockdown`, 1 gives the classical stress

    Returns
    -------
    moment [N m]

    Notes
    -----
    Valid: thin shells; on the safe side where ends close by keep the tube round.

    References
    ----------
    [NASA-SP-8007] unstiffened isotropic cylinder, bending; flattening of a long one

    Examples
    --------
    >>> m = local_shell_moment(youngs_modulus=70e9, thickness=1.2e-3, radius=15e-3,
    ...                        poissons_ratio=0.3)
    >>> print(f"{m:.1f} N m")
    1564.9 N m
    """
    if knockdown is None:
        knockdown = bending_shell_knockdown(radius=radius, thickness=thickness)
    stress = local_shell_stress(
        youngs_modulus=youngs_modulus,
        thickness=thickness,
        radius=radius,
        poissons_ratio=poissons_ratio,
        knockdown=knockdown,
    )
    wall = radius * thickness
    flat = sqrt(1 - poissons_ratio * poissons_ratio)
    flattening = 2 * 2**0.5 * pi / 9 * youngs_modulus * thickness * wall / flat
    return minimum(pi * radius * wall * stress, flattening)
