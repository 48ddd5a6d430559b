"""One ply as a solid: 3-D stiffness, rotation into the wall of a tube, thermal terms, stresses.

Directions: 1 fibre, 2 across it in the wall, 3 radial; z tube axis, t hoop, r radial, s shear in
the wall (engineering). The winding angle is measured from the tube axis. In a tube without
transverse shear, tau_13 = tau_23 = 0, so only the in-plane shear stiffness enters.
"""

from __future__ import annotations

from typing import TypeAlias

from ..base.numeric import Array, namespace
from .ply import rotated

Solid: TypeAlias = tuple[Array, Array, Array, Array, Array, Array, Array]
"""Stiffnesses C11, C12, C13, C22, C23, C33, C66 of a ply [Pa]."""

TubeStiffness: TypeAlias = tuple[
    Array, Array, Array, Array, Array, Array, Array, Array, Array, Array
]
"""Stiffnesses zz, zt, zr, tt, tr, rr, zs, ts, rs, ss of a layer in tube axes [Pa]."""


def solid_stiffness(
    *,
    youngs_modulus_1: Array,
    youngs_modulus_2: Array,
    youngs_modulus_3: Array,
    poissons_ratio_12: Array,
    poissons_ratio_13: Array,
    poissons_ratio_23: Array,
    shear_modulus_12: Array,
) -> Solid:
    """Stiffness of an orthotropic ply as a solid.

    C = S^-1 of the normal block S_ii = 1/E_i, S_12 = -nu12/E1, S_13 = -nu13/E1, S_23 = -nu23/E2;
    C66 = G12.

    Parameters
    ----------
    youngs_modulus_1, youngs_modulus_2, youngs_modulus_3 : moduli [Pa]
    poissons_ratio_12, poissons_ratio_13, poissons_ratio_23 : Poisson's ratios [-]
    shear_modulus_12 : in-plane shear modulus [Pa]

    Returns
    -------
    C11, C12, C13, C22, C23, C33, C66 [Pa]

    Notes
    -----
    Valid: positive definite S: 1 > nu12 n21 + nu13 n31 + nu23 n32 + 2 n21 n32 nu13.

    References
    ----------
    [Jones1999] orthotropic stiffness

    Examples
    --------
    >>> c = solid_stiffness(youngs_modulus_1=138e9, youngs_modulus_2=9e9, youngs_modulus_3=9e9,
    ...                     poissons_ratio_12=0.28, poissons_ratio_13=0.28,
    ...                     poissons_ratio_23=0.42, shear_modulus_12=5e9)
    >>> print(f"{c[0] / 1e6:.1f} {c[5] / 1e6:.1f}")
    140476.8 11066.9
    """
    n21 = poissons_ratio_12 * youngs_modulus_2 / youngs_modulus_1
    n31 = poissons_ratio_13 * youngs_modulus_3 / youngs_modulus_1
    n32 = poissons_ratio_23 * youngs_modulus_3 / youngs_modulus_2
    pair_12 = poissons_ratio_12 * n21
    pair_13 = poissons_ratio_13 * n31
    pair_23 = poissons_ratio_23 * n32
    whole = 1 - pair_12 - pair_13 - pair_23 - 2 * n21 * n32 * poissons_ratio_13
    first, second, third = (
        youngs_modulus_1 / whole,
        youngs_modulus_2 / whole,
        youngs_modulus_3 / whole,
    )
    return (
        first * (1 - pair_23),
        second * (poissons_ratio_12 + n32 * poissons_ratio_13),
        third * (poissons_ratio_13 + poissons_ratio_12 * poissons_ratio_23),
        second * (1 - pair_13),
        third * (poissons_ratio_23 + n21 * poissons_ratio_13),
        third * (1 - pair_12),
        shear_modulus_12,
    )


def solid_rotated(*, stiffness: Solid, angle: Array) -> TubeStiffness:
    """Stiffness of a ply in tube axes.

    The in-plane block rotates as in plane stress. Czr = C13 cos^2 + C23 sin^2,
    Ctr = C13 sin^2 + C23 cos^2, Crs = (C13 - C23) sin cos.

    Parameters
    ----------
    stiffness : C11, C12, C13, C22, C23, C33, C66 [Pa]
    angle : winding angle from the tube axis [rad]

    Returns
    -------
    zz, zt, zr, tt, tr, rr, zs, ts, rs, ss [Pa]

    Notes
    -----
    Valid: any angle.

    References
    ----------
    [TsaiPagano1968] invariants; [derived] rotation about the radial axis

    Examples
    --------
    >>> c = (140e9, 4e9, 4e9, 11e9, 5e9, 11e9, 5e9)
    >>> print(*(f"{v / 1e9:.3f}" for v in solid_rotated(stiffness=c, angle=0.0)[:6]))
    140.000 4.000 4.000 11.000 5.000 11.000
    """
    c11, c12, c13, c22, c23, c33, c66 = stiffness
    zz, zt, tt, zs, ts, ss = rotated(stiffness=(c11, c12, c22, c66), angle=angle)
    xp = namespace(angle, c11)
    mean, half = (c13 + c23) / 2, (c13 - c23) / 2
    swing = half * xp.cos(2 * angle)
    return zz, zt, mean + swing, tt, mean - swing, c33, zs, ts, half * xp.sin(2 * angle), ss


def solid_expansion_load(
    *,
    stiffness: Solid,
    angle: Array,
    expansion_1: Array,
    expansion_2: Array,
    expansion_3: Array,
) -> tuple[Array, Array, Array, Array]:
    """Stresses per kelvin that would hold a ply at zero strain, in tube axes.

    k_i = C_ij alpha_j; K_z, K_t = (k1 + k2)/2 +- (k1 - k2)/2 cos 2a, K_r = k3,
    K_s = (k1 - k2)/2 sin 2a.

    Parameters
    ----------
    stiffness : C11, C12, C13, C22, C23, C33, C66 [Pa]
    angle : winding angle from the tube axis [rad]
    expansion_1, expansion_2, expansion_3 : thermal expansions [1/K]

    Returns
    -------
    K_z, K_t, K_r, K_s [Pa/K]

    Notes
    -----
    Valid: constant properties; a balanced pair has no K_s.

    References
    ----------
    [derived] K = C alpha, rotated about the radial axis

    Examples
    --------
    >>> c = (150e9, 50e9, 50e9, 150e9, 50e9, 150e9, 50e9)
    >>> k = solid_expansion_load(stiffness=c, angle=0.3, expansion_1=1e-5, expansion_2=1e-5,
    ...                          expansion_3=1e-5)
    >>> print(*(f"{v / 1e6:.3f}" for v in k))
    2.500 2.500 2.500 0.000
    """
    c11, c12, c13, c22, c23, c33, _ = stiffness
    first = c11 * expansion_1 + c12 * expansion_2 + c13 * expansion_3
    second = c12 * expansion_1 + c22 * expansion_2 + c23 * expansion_3
    third = c13 * expansion_1 + c23 * expansion_2 + c33 * expansion_3
    xp = namespace(angle, first)
    mean, half = (first + second) / 2, (first - second) / 2
    swing = half * xp.cos(2 * angle)
    return mean + swing, mean - swing, third, half * xp.sin(2 * angle)


def solid_ply_stresses(
    *,
    stiffness: Solid,
    angle: Array,
    axial_strain: Array,
    hoop_strain: Array,
    radial_strain: Array,
    shear_strain: Array = 0.0,
    free_strain_1: Array = 0.0,
    free_strain_2: Array = 0.0,
    free_strain_3: Array = 0.0,
) -> tuple[Array, Array, Array, Array]:
    """Stresses of a ply in its own axes, from the strains of the wall.

    eps_1, eps_2 = (e_z + e_t)/2 +- [(e_z - e_t) cos 2a + g sin 2a]/2,
    gamma_12 = g cos 2a - (e_z - e_t) sin 2a; sigma = C (eps - free strain).

    Parameters
    ----------
    stiffness : C11, C12, C13, C22, C23, C33, C66 [Pa]
    angle : winding angle from the tube axis [rad]
    axial_strain, hoop_strain, radial_strain : normal strains of the wall [-]
    shear_strain : engineering shear g of the wall, z-t [-]
    free_strain_1, free_strain_2, free_strain_3 : stress-free strains of the ply [-]

    Returns
    -------
    sigma_1, sigma_2, sigma_3, tau_12 [Pa]

    Notes
    -----
    Valid: perfect bond; the -angle ply of a pair has the opposite shear where g = 0.

    References
    ----------
    [Jones1999] strain transformation

    Examples
    --------
    >>> c = (140e9, 4e9, 4e9, 11e9, 5e9, 11e9, 5e9)
    >>> s = solid_ply_stresses(stiffness=c, angle=0.0, axial_strain=1e-3, hoop_strain=0.0,
    ...                        radial_strain=0.0)
    >>> print(*(f"{v / 1e6:.1f}" for v in s))
    140.0 4.0 4.0 0.0
    """
    c11, c12, c13, c22, c23, c33, c66 = stiffness
    xp = namespace(angle, axial_strain, hoop_strain)
    cosine, sine = xp.cos(2 * angle), xp.sin(2 * angle)
    mean, half = (axial_strain + hoop_strain) / 2, (axial_strain - hoop_strain) / 2
    turned = half * cosine + shear_strain / 2 * sine
    first, second = mean + turned - free_strain_1, mean - turned - free_strain_2
    third = radial_strain - free_strain_3
    return (
        c11 * first + c12 * second + c13 * third,
        c12 * first + c22 * second + c23 * third,
        c13 * first + c23 * second + c33 * third,
        c66 * (shear_strain * cosine - 2 * half * sine),
    )
