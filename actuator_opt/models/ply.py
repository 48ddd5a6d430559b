"""One ply in its wall: reduced stiffness, rotation into tube axes, stresses, thermal terms.

The ply is in plane stress. Directions: 1 fibre, 2 across it; z tube axis, t hoop, s in-plane shear
(engineering). The winding angle is measured from the tube axis; each layer is a balanced +-angle
pair, so the laminate has no shear coupling. The stresses are those of the +angle ply.
"""

from __future__ import annotations

from typing import TypeAlias

from ..base.numeric import Array, namespace

Stiffness: TypeAlias = tuple[Array, Array, Array, Array]
"""Reduced stiffnesses Q11, Q12, Q22, Q66 of a ply [Pa]."""


def ply_stiffness(
    *,
    youngs_modulus_1: Array,
    youngs_modulus_2: Array,
    poissons_ratio_12: Array,
    shear_modulus_12: Array,
) -> Stiffness:
    """Reduced stiffness of an orthotropic ply in plane stress.

    Q11 = E1/m, Q12 = nu12 E2/m, Q22 = E2/m, Q66 = G12, m = 1 - nu12^2 E2/E1.

    Parameters
    ----------
    youngs_modulus_1, youngs_modulus_2 : moduli along and across the fibre [Pa]
    poissons_ratio_12 : major Poisson's ratio [-]
    shear_modulus_12 : in-plane shear modulus [Pa]

    Returns
    -------
    Q11, Q12, Q22, Q66 [Pa]

    Notes
    -----
    Valid: nu12^2 < E1/E2.

    References
    ----------
    [Jones1999] reduced stiffnesses

    Examples
    --------
    >>> q11, q12, q22, q66 = ply_stiffness(youngs_modulus_1=181e9, youngs_modulus_2=10.3e9,
    ...                                    poissons_ratio_12=0.28, shear_modulus_12=7.17e9)
    >>> print(f"{q11 / 1e9:.1f} {q12 / 1e9:.3f} {q22 / 1e9:.2f}")
    181.8 2.897 10.35
    """
    coupling = poissons_ratio_12 * youngs_modulus_2
    shared = 1 / (1 - poissons_ratio_12 * coupling / youngs_modulus_1)
    return (
        youngs_modulus_1 * shared,
        coupling * shared,
        youngs_modulus_2 * shared,
        shear_modulus_12,
    )


def rotated(
    *, stiffness: Stiffness, angle: Array
) -> tuple[Array, Array, Array, Array, Array, Array]:
    """Stiffness of a ply in tube axes.

    With the invariants U1 to U4 of Q: Qzz, Qtt = U1 +- U2 cos 2a + U3 cos 4a, Qzt = U4 - U3 cos 4a,
    Qss = (U1 - U4)/2 - U3 cos 4a, Qzs, Qts = U2 sin(2a)/2 +- U3 sin 4a.

    Parameters
    ----------
    stiffness : Q11, Q12, Q22, Q66 [Pa]
    angle : winding angle from the tube axis [rad]

    Returns
    -------
    Qzz, Qzt, Qtt, Qzs, Qts, Qss [Pa]; a balanced pair has Qzs = Qts = 0 in the laminate

    Notes
    -----
    Valid: any angle.

    References
    ----------
    [TsaiPagano1968] invariants

    Examples
    --------
    >>> q = ply_stiffness(youngs_modulus_1=181e9, youngs_modulus_2=10.3e9,
    ...                   poissons_ratio_12=0.28, shear_modulus_12=7.17e9)
    >>> print(*(f"{value / 1e9:.2f}" for value in rotated(stiffness=q, angle=0.5235987755982988)))
    109.38 32.46 23.65 54.19 20.05 36.74
    """
    q11, q12, q22, q66 = stiffness
    xp = namespace(angle, q11)
    double = 2 * angle
    cosine, sine = xp.cos(double), xp.sin(double)
    total, cross = q11 + q22, 2 * q12
    u3 = (total - cross - 4 * q66) / 8
    fourfold = u3 * (2 * cosine * cosine - 1)
    even = (3 * total + cross + 4 * q66) / 8 + fourfold
    odd = (q11 - q22) / 2
    swing, half, tilt = odd * cosine, odd * sine / 2, 2 * u3 * sine * cosine
    return (
        even + swing,
        (total + 3 * cross - 4 * q66) / 8 - fourfold,
        even - swing,
        half + tilt,
        half - tilt,
        (total - cross + 4 * q66) / 8 - fourfold,
    )


def ply_stresses(
    *,
    stiffness: Stiffness,
    angle: Array,
    axial_strain: Array,
    hoop_strain: Array,
    free_strain_1: Array = 0.0,
    free_strain_2: Array = 0.0,
) -> tuple[Array, Array, Array]:
    """Stresses of the +angle ply in its own axes, from the wall's strains without twist.

    eps_1, eps_2 = (e_z + e_t)/2 -+ (e_t - e_z)/2 cos 2a, gamma_12 = (e_t - e_z) sin 2a;
    sigma = Q (eps - free strain). The -angle ply has the opposite shear stress.

    Parameters
    ----------
    stiffness : Q11, Q12, Q22, Q66 [Pa]
    angle : winding angle from the tube axis [rad]
    axial_strain, hoop_strain : strains of the wall [-]
    free_strain_1, free_strain_2 : stress-free strains of the ply, alpha_1 dT and alpha_2 dT [-]

    Returns
    -------
    sigma_1, sigma_2, tau_12 [Pa]

    Notes
    -----
    Valid: thin wall, perfect bond, balanced pairs.

    References
    ----------
    [Jones1999] strain transformation

    Examples
    --------
    >>> q = ply_stiffness(youngs_modulus_1=138e9, youngs_modulus_2=9e9, poissons_ratio_12=0.28,
    ...                   shear_modulus_12=5e9)
    >>> s1, s2, t12 = ply_stresses(stiffness=q, angle=0.0, axial_strain=1e-3, hoop_strain=1e-3)
    >>> print(f"{s1 / 1e6:.1f} {s2 / 1e6:.2f} {t12:.1f}")
    141.2 11.58 0.0
    """
    q11, q12, q22, q66 = stiffness
    xp = namespace(angle, axial_strain, hoop_strain)
    mean, spread = (axial_strain + hoop_strain) / 2, hoop_strain - axial_strain
    turned = spread / 2 * xp.cos(2 * angle)
    first, second = mean - turned - free_strain_1, mean + turned - free_strain_2
    shear = spread * xp.sin(2 * angle)
    return q11 * first + q12 * second, q12 * first + q22 * second, q66 * shear


def thermal_ply_load(
    *, stiffness: Stiffness, angle: Array, expansion_1: Array, expansion_2: Array
) -> tuple[Array, Array]:
    """Axial and hoop stress per kelvin that would hold a ply at zero strain.

    K_z, K_t = (k1 + k2)/2 +- (k1 - k2)/2 cos 2a, k1 = Q11 a1 + Q12 a2, k2 = Q12 a1 + Q22 a2.

    Parameters
    ----------
    stiffness : Q11, Q12, Q22, Q66 [Pa]
    angle : winding angle from the tube axis [rad]
    expansion_1, expansion_2 : thermal expansions along and across the fibre [1/K]

    Returns
    -------
    K_z, K_t [Pa/K]

    Notes
    -----
    Valid: constant properties; a pair has no shear term.

    References
    ----------
    [Jones1999] thermal forces

    Examples
    --------
    >>> q = 76.923e9, 23.077e9, 76.923e9, 26.923e9  # aluminium, 70 GPa
    >>> kz, kt = thermal_ply_load(stiffness=q, angle=0.0, expansion_1=2e-5, expansion_2=2e-5)
    >>> print(f"{kz / 1e6:.3f} {kt / 1e6:.3f}")
    2.000 2.000
    """
    q11, q12, q22, _ = stiffness
    first, second = q11 * expansion_1 + q12 * expansion_2, q12 * expansion_1 + q22 * expansion_2
    mean, swing = (first + second) / 2, (first - second) / 2 * namespace(angle).cos(2 * angle)
    return mean + swing, mean - swing
