"""Ply strengths, strength ratios, and the criteria without interaction: max stress, max strain.

Stresses are in material axes (1 fibre, 2 transverse in the wall, 3 radial), tension positive.
A criterion gives the utilisation 1/SR of each of its modes; see `criteria` for what all share.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TypeAlias

from ..base.numeric import Array, real, where

Stress: TypeAlias = tuple[Array, Array, Array, Array]
"""Ply stress sigma_1, sigma_2, sigma_3, tau_12 [Pa]."""

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


@dataclass(frozen=True, slots=True, kw_only=True)
class PlyRatios:
    """Ratios of a ply's elastic constants [-]: all that maximum strain needs of them.

    Parameters
    ----------
    poissons_ratio_12, poissons_ratio_13, poissons_ratio_23 : Poisson's ratios
    modulus_ratio : E_2/E_1
    """

    poissons_ratio_12: Array
    poissons_ratio_13: Array
    poissons_ratio_23: Array
    modulus_ratio: Array


def load_multiplier(inverse: Array) -> Array:
    """Factor by which the load may grow before the utilisation reaches one.

    SR = 1/utilisation, infinite where it is not positive: the ply never fails; zero where it is
    infinite: the residual stress alone fails the ply.

    Parameters
    ----------
    inverse : utilisation, of any criterion [-]

    Returns
    -------
    strength ratio SR [-]

    Notes
    -----
    Valid: proportional loading, on top of what the utilisation holds constant.

    References
    ----------
    [derived] definition of the utilisation

    Examples
    --------
    >>> load_multiplier(0.5), load_multiplier(0.0)
    (2.0, inf)
    """
    held = real(inverse) <= _IDLE
    return where(held, inf, 1 / where(held, 1.0, inverse))


def _share(load: Array, left: Array) -> Array:
    """Load over the strength that the residual stress leaves; infinite where none is left."""
    broken = real(left) <= 0
    return where(broken, inf, load / where(broken, 1.0, left))


def one_stress_modes(
    *, stress: Array, tension: Array, compression: Array, residual: Array | None = None
) -> tuple[Array, Array]:
    """Utilisation of one stress component in tension and in compression.

    sigma/(X_t - sigma_residual) and -sigma/(X_c + sigma_residual), 0 where the sign is the other.

    Parameters
    ----------
    stress : stress of the load [Pa]
    tension, compression : strengths of either sign [Pa]
    residual : stress that does not grow with the load [Pa], or None

    Returns
    -------
    utilisation in tension, in compression [-]; infinite where the residual stress alone fails

    Notes
    -----
    Valid: any load, any residual stress.

    References
    ----------
    [derived] residual + SR stress = strength, solved for 1/SR

    Examples
    --------
    >>> one_stress_modes(stress=30.0, tension=55.0, compression=190.0, residual=5.0)
    (0.6, 0.0)
    """
    pulled = where(real(stress) > 0, stress, 0.0)
    pressed = pulled - stress
    if residual is None:
        return pulled / tension, pressed / compression
    return _share(pulled, tension - residual), _share(pressed, compression + residual)


def _plane_modes(
    stress: tuple[Array, Array, Array],
    strength: PlyStrength,
    residual: tuple[Array | None, Array | None, Array | None],
) -> dict[str, Array]:
    """Modes of sigma_1, sigma_2 and tau_12, or of what stands for them, each on its own."""
    s = strength
    limits = (s.tension_1, s.compression_1), (s.tension_2, s.compression_2), (s.shear_12,) * 2
    along, across, slip = (
        one_stress_modes(stress=load, tension=up, compression=down, residual=held)
        for load, (up, down), held in zip(stress, limits, residual, strict=True)
    )
    return {
        "fibre tension": along[0],
        "fibre compression": along[1],
        "matrix tension": across[0],
        "matrix compression": across[1],
        "shear": slip[0] + slip[1],
    }


def max_stress_modes(
    *,
    stress: Stress,
    strength: PlyStrength,
    residual: Stress | None = None,
    elastic: PlyRatios | None = None,
) -> dict[str, Array]:
    """Utilisation of every mode of the maximum-stress criterion.

    sigma_1/X_t, -sigma_1/X_c, sigma_2/Y_t, -sigma_2/Y_c, |tau_12|/S, sigma_3/Y_t, -sigma_3/Y_c,
    each strength less the residual stress of that direction.

    Parameters
    ----------
    stress : sigma_1, sigma_2, sigma_3, tau_12 of the load [Pa]
    strength : ply strengths
    residual : stress that does not grow with the load [Pa], or None
    elastic : not used [-]

    Returns
    -------
    utilisation of each mode [-]; infinite where the residual stress alone fails the ply

    Notes
    -----
    Valid: any orthotropic ply.

    References
    ----------
    [Jones1999] maximum stress

    Examples
    --------
    >>> p = PlyStrength(1900.0, 1300.0, 55.0, 190.0, 85.0)
    >>> modes = max_stress_modes(stress=(400.0, 30.0, 0.0, 40.0), strength=p)
    >>> mode = max(modes, key=modes.get)
    >>> print(f"{mode}, {1 / modes[mode]:.5f}")
    matrix tension, 1.83333
    """
    held_1, held_2, held_3, held_12 = (None,) * 4 if residual is None else residual
    modes = _plane_modes((stress[0], stress[1], stress[3]), strength, (held_1, held_2, held_12))
    modes["radial tension"], modes["radial compression"] = one_stress_modes(
        stress=stress[2],
        tension=strength.tension_2,
        compression=strength.compression_2,
        residual=held_3,
    )
    return modes


def _strains(stress: Stress, elastic: PlyRatios) -> tuple[Array, Array, Array]:
    """E_1 epsilon_1, E_2 epsilon_2 and tau_12 of a stress."""
    along, across, radial, slip = stress
    e = elastic
    first = along - e.poissons_ratio_12 * across - e.poissons_ratio_13 * radial
    second = across - e.poissons_ratio_12 * e.modulus_ratio * along - e.poissons_ratio_23 * radial
    return first, second, slip


def max_strain_modes(
    *,
    stress: Stress,
    strength: PlyStrength,
    residual: Stress | None = None,
    elastic: PlyRatios | None = None,
) -> dict[str, Array]:
    """Utilisation of every mode of maximum strain, failure strains being strength over modulus.

    E_1 eps_1 = sigma_1 - nu_12 sigma_2 - nu_13 sigma_3 against X_t and X_c,
    E_2 eps_2 = sigma_2 - nu_12 (E_2/E_1) sigma_1 - nu_23 sigma_3 against Y_t and Y_c, and
    tau_12 against S; the strain is that of the stress, without free thermal or cure strain.

    Parameters
    ----------
    stress : sigma_1, sigma_2, sigma_3, tau_12 of the load [Pa]
    strength : ply strengths
    residual : stress that does not grow with the load [Pa], or None
    elastic : Poisson's ratios and modulus ratio of the ply [-]; needed

    Returns
    -------
    utilisation of each mode [-]; infinite where the residual stress alone fails the ply

    Raises
    ------
    ValueError : without `elastic`

    Notes
    -----
    Valid: linear plies; the radial strain is not tested.

    References
    ----------
    [Jones1999] maximum strain

    Examples
    --------
    >>> p = PlyStrength(1900.0, 1300.0, 55.0, 190.0, 85.0)
    >>> e = PlyRatios(poissons_ratio_12=0.28, poissons_ratio_13=0.28, poissons_ratio_23=0.42,
    ...               modulus_ratio=9 / 138)
    >>> modes = max_strain_modes(stress=(400.0, 30.0, 0.0, 40.0), strength=p, elastic=e)
    >>> mode = max(modes, key=modes.get)
    >>> print(f"{mode}, {1 / modes[mode]:.3f}")
    shear, 2.125
    """
    if elastic is None:
        raise ValueError("maximum strain needs the elastic ratios of the ply")
    held = (None,) * 3 if residual is None else _strains(residual, elastic)
    return _plane_modes(_strains(stress, elastic), strength, held)
