"""Ply strengths, and the criteria that name a failure mode: max stress, max strain, Hashin.

`*_modes` gives the utilisation 1/SR of every mode by name, `inverse_*` the largest of them:
finite at zero stress and linear in the load, at most 1 is safe. `load_multiplier` turns it into SR,
the factor by which the load may grow before the ply fails. Stresses are in material axes (1 fibre,
2 transverse in the wall, 3 radial), tension positive. The quadratic criteria are in `strength`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce

import numpy as np

from ..numeric import Array, absolute, maximum, namespace, real, where

_IDLE = 1e-300
"""Utilisations up to this count as no load: their inverse is infinite, without overflow."""


@dataclass(frozen=True, slots=True)
class PlyStrength:
    """Strengths of a unidirectional or woven ply [Pa], all positive.

    Parameters
    ----------
    tension_1, compression_1 : along the fibre
    tension_2, compression_2 : across the fibre
    shear_12 : in the plane
    shear_23 : across the fibre, in the 2-3 plane; None where unknown
    """

    tension_1: Array
    compression_1: Array
    tension_2: Array
    compression_2: Array
    shear_12: Array
    shear_23: Array | None = None


def load_multiplier(inverse: Array) -> Array:
    """Factor by which the load may grow before the utilisation reaches one.

    SR = 1/utilisation, infinite where it is not positive: the ply never fails.

    Parameters
    ----------
    inverse : utilisation, of any criterion [-]

    Returns
    -------
    strength ratio SR [-]

    Notes
    -----
    Valid: proportional loading.

    References
    ----------
    [derived] the utilisations here are linear in the load

    Examples
    --------
    >>> load_multiplier(0.5), load_multiplier(0.0)
    (2.0, inf)
    """
    held = real(inverse) <= _IDLE
    return where(held, 0 * inverse + np.inf, 1 / where(held, 0 * inverse + 1, inverse))


def max_stress_modes(
    *,
    stress_1: Array,
    stress_2: Array,
    shear_12: Array,
    strength: PlyStrength,
    stress_3: Array | None = None,
    residual: tuple[Array, Array, Array] | None = None,
) -> dict[str, Array]:
    """Utilisation of every mode of the maximum-stress criterion.

    sigma_1/X_t, -sigma_1/X_c, sigma_2/Y_t, -sigma_2/Y_c, |tau_12|/S, with sigma_3 also
    sigma_3/Y_t and -sigma_3/Y_c. A residual stress that does not grow with the load shortens the
    strength: sigma/(X - sigma_residual).

    Parameters
    ----------
    stress_1, stress_2, shear_12 : ply stresses of the load [Pa]
    strength : ply strengths
    stress_3 : radial stress of the load [Pa], or None in plane stress
    residual : residual (thermal) sigma_1, sigma_2, tau_12 [Pa]

    Returns
    -------
    utilisation of each mode [-]; negative where the stress has the other sign

    Notes
    -----
    Valid: any orthotropic ply whose residual stress alone does not fail it.

    References
    ----------
    [Jones1999] maximum stress

    Examples
    --------
    >>> p = PlyStrength(1900.0, 1300.0, 55.0, 190.0, 85.0)
    >>> modes = max_stress_modes(stress_1=400.0, stress_2=30.0, shear_12=40.0, strength=p)
    >>> max(modes, key=modes.get)
    'matrix tension'
    """
    s = strength
    fixed_1, fixed_2, fixed_12 = (0.0, 0.0, 0.0) if residual is None else residual
    modes = {
        "fibre tension": stress_1 / (s.tension_1 - fixed_1),
        "fibre compression": -stress_1 / (s.compression_1 + fixed_1),
        "matrix tension": stress_2 / (s.tension_2 - fixed_2),
        "matrix compression": -stress_2 / (s.compression_2 + fixed_2),
    }
    if residual is None:
        modes["shear"] = absolute(shear_12) / s.shear_12
    else:
        modes["shear"] = maximum(
            shear_12 / (s.shear_12 - fixed_12), -shear_12 / (s.shear_12 + fixed_12)
        )
    if stress_3 is not None:
        modes["radial tension"] = stress_3 / s.tension_2
        modes["radial compression"] = -stress_3 / s.compression_2
    return modes


def inverse_max_stress(
    *,
    stress_1: Array,
    stress_2: Array,
    shear_12: Array,
    strength: PlyStrength,
    stress_3: Array | None = None,
    residual: tuple[Array, Array, Array] | None = None,
) -> Array:
    """Utilisation by maximum stress: the largest of `max_stress_modes`.

    Parameters
    ----------
    stress_1, stress_2, shear_12 : ply stresses of the load [Pa]
    strength : ply strengths
    stress_3 : radial stress of the load [Pa], or None in plane stress
    residual : residual (thermal) sigma_1, sigma_2, tau_12 [Pa]

    Returns
    -------
    utilisation [-]

    Notes
    -----
    Valid: as `max_stress_modes`.

    References
    ----------
    [Jones1999] maximum stress

    Examples
    --------
    >>> p = PlyStrength(1900.0, 1300.0, 55.0, 190.0, 85.0)
    >>> inverse_max_stress(stress_1=0.0, stress_2=-95.0, shear_12=0.0, strength=p)
    0.5
    """
    modes = max_stress_modes(
        stress_1=stress_1,
        stress_2=stress_2,
        shear_12=shear_12,
        strength=strength,
        stress_3=stress_3,
        residual=residual,
    )
    return reduce(maximum, modes.values())


def inverse_max_strain(
    *,
    stress_1: Array,
    stress_2: Array,
    shear_12: Array,
    strength: PlyStrength,
    poissons_ratio_12: Array,
    modulus_ratio: Array,
    stress_3: Array = 0.0,
    poissons_ratio_13: Array = 0.0,
    poissons_ratio_23: Array = 0.0,
) -> Array:
    """Utilisation by maximum strain, failure strains being strength over modulus.

    E_1 eps_1 = sigma_1 - nu_12 sigma_2 - nu_13 sigma_3 against X_t and X_c,
    E_2 eps_2 = sigma_2 - nu_12 (E_2/E_1) sigma_1 - nu_23 sigma_3 against Y_t and Y_c, and
    tau against S.

    Parameters
    ----------
    stress_1, stress_2, shear_12, stress_3 : ply stresses [Pa]
    strength : ply strengths
    poissons_ratio_12, poissons_ratio_13, poissons_ratio_23 : Poisson's ratios [-]
    modulus_ratio : E_2/E_1 [-]

    Returns
    -------
    utilisation [-]

    Notes
    -----
    Valid: linear plies; the radial strain is not tested.

    References
    ----------
    [Jones1999] maximum strain

    Examples
    --------
    >>> p = PlyStrength(1900.0, 1300.0, 55.0, 190.0, 85.0)
    >>> u = inverse_max_strain(stress_1=400.0, stress_2=30.0, shear_12=40.0, strength=p,
    ...                        poissons_ratio_12=0.28, modulus_ratio=9 / 138)
    >>> print(f"{1 / u:.3f}")
    2.125
    """
    first = stress_1 - poissons_ratio_12 * stress_2 - poissons_ratio_13 * stress_3
    coupling = poissons_ratio_12 * modulus_ratio
    second = stress_2 - coupling * stress_1 - poissons_ratio_23 * stress_3
    return inverse_max_stress(stress_1=first, stress_2=second, shear_12=shear_12, strength=strength)


def hashin_modes(
    *,
    stress_1: Array,
    stress_2: Array,
    shear_12: Array,
    strength: PlyStrength,
    fibre_shear: float = 1.0,
) -> dict[str, Array]:
    """Utilisation of every mode of Hashin's plane-stress criterion.

    Fibre tension sqrt((sigma_1/X_t)^2 + a (tau/S)^2), fibre compression -sigma_1/X_c, matrix
    tension sqrt((sigma_2/Y_t)^2 + (tau/S)^2), matrix compression the positive root of
    SR^2 [(sigma_2/(2 S_23))^2 + (tau/S)^2] + SR [(Y_c/(2 S_23))^2 - 1] sigma_2/Y_c = 1.

    Parameters
    ----------
    stress_1, stress_2, shear_12 : ply stresses [Pa]
    strength : ply strengths; S_23 defaults to S_12
    fibre_shear : a, share of the shear term in fibre tension [-], 0 to 1

    Returns
    -------
    utilisation of each mode [-], 0 where the stress has the other sign

    Notes
    -----
    Valid: unidirectional plies. The shear term and the default S_23 are choices.

    References
    ----------
    [Hashin1980] plane-stress form

    Examples
    --------
    >>> p = PlyStrength(1900.0, 1300.0, 55.0, 190.0, 85.0)
    >>> modes = hashin_modes(stress_1=400.0, stress_2=30.0, shear_12=40.0, strength=p)
    >>> print(f"{1 / modes['matrix tension']:.6f}")
    1.388121
    """
    s = strength
    shear_23 = s.shear_12 if s.shear_23 is None else s.shear_23
    slip = shear_12 / s.shear_12
    slip = slip * slip
    root = namespace(stress_1, stress_2, slip).sqrt
    along, across = stress_1 / s.tension_1, stress_2 / s.tension_2
    crush, flat = stress_2 / (2 * shear_23), s.compression_2 / (2 * shear_23)
    linear = (flat * flat - 1) * stress_2 / s.compression_2
    pressed = (linear + root(linear * linear + 4 * (crush * crush + slip))) / 2
    pulled_1, pulled_2 = real(stress_1) >= 0, real(stress_2) >= 0
    none = 0 * stress_1 + 0 * stress_2 + 0 * slip
    return {
        "fibre tension": where(pulled_1, root(along * along + fibre_shear * slip), none),
        "fibre compression": where(pulled_1, none, -stress_1 / s.compression_1 + none),
        "matrix tension": where(pulled_2, root(across * across + slip), none),
        "matrix compression": where(pulled_2, none, pressed),
    }


def inverse_hashin(
    *,
    stress_1: Array,
    stress_2: Array,
    shear_12: Array,
    strength: PlyStrength,
    fibre_shear: float = 1.0,
) -> Array:
    """Utilisation by Hashin's criterion: the largest of `hashin_modes`.

    Parameters
    ----------
    stress_1, stress_2, shear_12 : ply stresses [Pa]
    strength : ply strengths
    fibre_shear : a, share of the shear term in fibre tension [-], 0 to 1

    Returns
    -------
    utilisation [-]

    Notes
    -----
    Valid: as `hashin_modes`.

    References
    ----------
    [Hashin1980] plane-stress form

    Examples
    --------
    >>> p = PlyStrength(1900.0, 1300.0, 55.0, 190.0, 85.0)
    >>> print(f"{inverse_hashin(stress_1=0.0, stress_2=27.5, shear_12=0.0, strength=p):.3f}")
    0.500
    """
    modes = hashin_modes(
        stress_1=stress_1,
        stress_2=stress_2,
        shear_12=shear_12,
        strength=strength,
        fibre_shear=fibre_shear,
    )
    return reduce(maximum, modes.values())
