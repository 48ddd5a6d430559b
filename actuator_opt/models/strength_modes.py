"""Ply strengths, strength ratios, and criteria by mode: max stress, max strain, Hashin, Puck.

Stresses are in material axes (1 fibre, 2 transverse in the wall, 3 radial), tension positive. A
criterion gives the utilisation 1/SR of each of its modes; `strength` states the common rules.

Hashin and Puck separate fibre failure from inter-fibre failure, in plane stress. The sign of
sigma_2 at failure decides which failure surface applies. Without residual stress that is the sign
of the load's sigma_2. With residual stress, sigma_2 may change sign as the load grows. If the shear
at sigma_2 = 0 is below S, the ply survives there and fails later, on the other side; otherwise it
has failed before. At sigma_2 = 0 both criteria give |tau| = S from either side, so the utilisation
of the ply is continuous there. Of the inter-fibre modes only the mode in which the ply fails has a
utilisation; that of the others is 0. Every surface is a conic in (sigma_2, tau), and so gives a
quadratic equation in SR along the load.
"""

from __future__ import annotations

from math import inf
from typing import TypeAlias

from ..base.dataclass import dataclass
from ..base.numeric import Array, absolute, namespace, real, where

Stress: TypeAlias = tuple[Array, Array, Array, Array]
"""Ply stress sigma_1, sigma_2, sigma_3, tau_12 [Pa]."""

_IDLE = 1e-300
"""Utilisations up to this value count as no load: SR is then infinite, without an overflow."""


@dataclass(frozen=True, slots=True)
class PlyStrength:
    """Strengths of a unidirectional or woven ply [Pa], all positive.

    Parameters
    ----------
    tension_1, compression_1 : strengths along the fibre
    tension_2, compression_2 : strengths across the fibre
    shear_12 : in-plane shear strength
    shear_23 : shear strength in the 2-3 plane, across the fibre; None where unknown
    """

    tension_1: Array
    compression_1: Array
    tension_2: Array
    compression_2: Array
    shear_12: Array
    shear_23: Array | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class PlyRatios:
    """Ratios of a ply's elastic constants [-], used by the maximum-strain criterion.

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

    SR = 1/utilisation. SR is infinite where the utilisation is not positive, as the ply never
    fails. SR is zero where the utilisation is infinite, as the residual stress alone fails the ply.

    Parameters
    ----------
    inverse : utilisation, of any criterion [-]

    Returns
    -------
    strength ratio SR [-]

    Notes
    -----
    Valid: proportional loading, on top of the constant residual stress in the utilisation.

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
    """Load divided by the strength that the residual stress leaves; infinite if it leaves none."""
    broken = real(left) <= 0
    return where(broken, inf, load / where(broken, 1.0, left))


def one_stress_modes(
    *, stress: Array, tension: Array, compression: Array, residual: Array | None = None
) -> tuple[Array, Array]:
    """Utilisation of one stress component in tension and in compression.

    sigma/(X_t - sigma_residual) in tension and -sigma/(X_c + sigma_residual) in compression; the
    utilisation that does not match the sign of sigma is 0.

    Parameters
    ----------
    stress : stress of the load [Pa]
    tension, compression : tensile and compressive strength, both positive [Pa]
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
    """Utilisations by each of sigma_1, sigma_2 and tau_12 alone (or by modulus times strain)."""
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
    with each strength reduced by the residual stress in its direction.

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
    """Strains that a stress causes, each times its modulus: E_1 eps_1, E_2 eps_2 and tau_12."""
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
    """Utilisation of every mode of maximum strain; failure strains are strength divided by modulus.

    E_1 eps_1 = sigma_1 - nu_12 sigma_2 - nu_13 sigma_3 against X_t and X_c,
    E_2 eps_2 = sigma_2 - nu_12 (E_2/E_1) sigma_1 - nu_23 sigma_3 against Y_t and Y_c, and
    tau_12 against S. Only strain caused by stress counts, not free thermal or cure strain.

    Parameters
    ----------
    stress : sigma_1, sigma_2, sigma_3, tau_12 of the load [Pa]
    strength : ply strengths
    residual : stress that does not grow with the load [Pa], or None
    elastic : Poisson's ratios and modulus ratio of the ply [-]; required

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
        raise ValueError("maximum strain needs the ratios of the ply's elastic constants")
    held = (None,) * 3 if residual is None else _strains(residual, elastic)
    return _plane_modes(_strains(stress, elastic), strength, held)


def _exit_root(square: Array, half: Array, left: Array) -> Array:
    """1/SR where the growing load leaves the region square SR^2 + 2 half SR <= left.

    The load may start outside and enter the region first. 1/SR has two equal forms,
    (half + root)/left and square/(root - half), with the square root of the discriminant; the code
    uses the form that loses no digits.
    """
    inside = half * half + square * left
    root = namespace(inside).sqrt(where(real(inside) > 0, inside, 0.0))
    outward = real(half) > 0
    total = root + where(outward, half, -half)
    below = where(outward, left, total)
    return where(outward, total, square) / where(real(below) > 0, below, 1.0)


def _fails_pulled(across: Array, slip: Array, held: Array, held_slip: Array) -> Array:
    """Whether sigma_2 >= 0 at the load that fails the ply.

    `across` is sigma_2 and `slip` tau/S of the load, `held` and `held_slip` those of the residual
    stress.
    """
    across, slip, held, held_slip = real(across), real(slip), real(held), real(held_slip)
    at_zero = held_slip * across - held * slip
    passes = at_zero * at_zero < across * across
    return where(passes, across >= 0, held >= 0)


def _matrix_surface(
    across: Array,
    slip: Array,
    residual: tuple[Array, Array] | None,
    tension: tuple[Array, Array],
    compression: tuple[Array, Array],
) -> tuple[Array, Array, Array | None]:
    """1/SR on the failure surface (tau/S)^2 + k sigma_2^2 + 2 m sigma_2 = 1 of inter-fibre failure.

    (k, m) are `tension` or `compression`, by the sign of sigma_2 at failure. The function also
    returns whether sigma_2 >= 0 at failure, and whether the residual stress (sigma_2, tau/S) alone
    fails the ply. Where it does, 1/SR has no meaning and the sign is that of the residual stress.
    """
    if residual is None:
        pulled = real(across) >= 0
        curve, half = (where(pulled, a, b) for a, b in zip(tension, compression, strict=True))
        half = half * across
        inside = half * half + curve * across * across + slip * slip
        return half + namespace(inside).sqrt(inside), pulled, None
    held, held_slip = residual
    slipped = 1 - held_slip * held_slip
    left_pulled, left_pressed = (
        slipped - (curve * held + 2 * half) * held for curve, half in (tension, compression)
    )
    stretched = real(held) >= 0
    broken = real(where(stretched, left_pulled, left_pressed)) <= 0
    pulled = where(broken, stretched, _fails_pulled(across, slip, held, held_slip))
    curve, half = (where(pulled, a, b) for a, b in zip(tension, compression, strict=True))
    used = _exit_root(
        slip * slip + curve * across * across,
        held_slip * slip + (curve * held + half) * across,
        where(pulled, left_pulled, left_pressed),
    )
    return used, pulled, broken


def _fibre_tension_with_shear(
    along: Array, slip: Array, held: Array, held_slip: Array, share: Array
) -> Array:
    """Utilisation by (sigma_1/X_t)^2 + share (tau/S)^2 = 1 where sigma_1 >= 0.

    `along` and `slip` are the load's stresses divided by X_t and S; `held` and `held_slip` are the
    residual stresses divided likewise. `share` is the weight of the shear term.

    A load may pull a fibre out of residual compression under more shear than this surface allows;
    the fibre then fails where sigma_1 changes sign.
    """
    shared = share * held_slip
    left = 1 - held * held - shared * held_slip
    used = _exit_root(along * along + share * slip * slip, held * along + shared * slip, left)
    pressed = real(held) < 0
    pulled = where(real(along) > 0, along, 0.0)
    at_zero = real(held_slip) * real(along) - real(held) * real(slip)
    passes = real(share) * at_zero * at_zero < real(along) * real(pulled)
    stretched = real(along) + real(held) * real(used) >= 0
    entry = pulled / where(pressed, -held, 1.0)
    broken = real(where(pressed, 1.0, left)) <= 0
    return where(broken, inf, where(where(pressed, passes, stretched), used, entry))


def hashin_modes(
    *,
    stress: Stress,
    strength: PlyStrength,
    residual: Stress | None = None,
    elastic: PlyRatios | None = None,
    fibre_shear: Array = 1.0,
) -> dict[str, Array]:
    """Utilisation of every mode of Hashin's plane-stress criterion.

    Surfaces: fibre tension (sigma_1/X_t)^2 + a (tau/S)^2 = 1, fibre compression -sigma_1 = X_c,
    matrix tension (sigma_2/Y_t)^2 + (tau/S)^2 = 1, matrix compression
    (sigma_2/(2 S_23))^2 + (tau/S)^2 + [(Y_c/(2 S_23))^2 - 1] sigma_2/Y_c = 1. Each applies to its
    own sign of sigma_1 or sigma_2, with sigma = residual + SR stress.

    Parameters
    ----------
    stress : sigma_1, sigma_2, sigma_3 (not used), tau_12 of the load [Pa]
    strength : ply strengths; S_23 defaults to S_12
    residual : stress that does not grow with the load [Pa], or None
    elastic : not used [-]
    fibre_shear : a, share of the shear term in fibre tension [-], 0 to 1

    Returns
    -------
    utilisation of each mode [-], 0 where the sign of the stress at failure belongs to the opposite
    mode; infinite where the residual stress alone fails the ply

    Notes
    -----
    Valid: unidirectional plies in plane stress.

    The shear term of fibre tension and the default S_23 are our choices.

    References
    ----------
    [Hashin1980] plane-stress form; 1/SR [derived] from the quadratic along the load

    Examples
    --------
    >>> p = PlyStrength(1900.0, 1300.0, 55.0, 190.0, 85.0)
    >>> modes = hashin_modes(stress=(400.0, 30.0, 0.0, 40.0), strength=p)
    >>> print(f"{1 / modes['matrix tension']:.6f}")
    1.388121
    """
    s = strength
    load_1, across, _, shear = stress
    slip = shear / s.shear_12
    held_1, held = None, None
    if residual is not None:
        held_1, held = residual[0], (residual[1], residual[3] / s.shear_12)
    fibre, crushed = one_stress_modes(
        stress=load_1, tension=s.tension_1, compression=s.compression_1, residual=held_1
    )
    if held is None:
        shared = fibre * fibre + fibre_shear * slip * slip
        fibre = where(real(load_1) >= 0, namespace(shared).sqrt(shared), 0.0)
    else:
        fibre = _fibre_tension_with_shear(
            load_1 / s.tension_1, slip, held_1 / s.tension_1, held[1], fibre_shear
        )
    double = 2 * (s.shear_12 if s.shear_23 is None else s.shear_23)
    flat = s.compression_2 / double
    used, pulled, broken = _matrix_surface(
        across,
        slip,
        held,
        tension=(1 / (s.tension_2 * s.tension_2), 0.0),
        compression=(1 / (double * double), (flat * flat - 1) / (2 * s.compression_2)),
    )
    if broken is not None:
        used = where(broken, inf, used)
    return {
        "fibre tension": fibre,
        "fibre compression": crushed,
        "matrix tension": where(pulled, used, 0.0),
        "matrix compression": where(pulled, 0.0, used),
    }


def _in_mode_c(across: Array, slip: Array, corner: tuple[Array, Array]) -> Array:
    """Whether a stress (sigma_2, tau/S) is in Puck's mode C.

    It is in mode C beyond the line from zero stress through the point where the surfaces of modes B
    and C meet (`corner`).
    """
    return -real(across) * real(corner[1]) > real(corner[0]) * absolute(real(slip))


def _puck_mode_c(
    across: Array, slip: Array, held: tuple[Array, Array], weight: Array, limit: Array
) -> tuple[Array, Array]:
    """1/SR on Puck's surface weight (tau/S)^2 + (sigma_2/Y_c)^2 + sigma_2/Y_c = 0 of mode C.

    The function also returns whether the residual stress `held` (sigma_2, tau/S) alone lies outside
    this surface. `limit` is Y_c.
    """
    crush, held_crush = across / limit, held[0] / limit
    weighted = weight * held[1]
    left = -(weighted * held[1] + held_crush * (held_crush + 1))
    square = weight * slip * slip + crush * crush
    half = weighted * slip + (held_crush + 0.5) * crush
    return _exit_root(square, half, left), real(left) <= 0


def puck_modes(
    *,
    stress: Stress,
    strength: PlyStrength,
    residual: Stress | None = None,
    elastic: PlyRatios | None = None,
    inclination_tension: Array = 0.35,
    inclination_compression: Array = 0.30,
) -> dict[str, Array]:
    """Utilisation (stress exposure) of every mode of Puck's plane-stress criterion.

    Surfaces, with t = tau/S: mode A (sigma_2 >= 0)
    sqrt(t^2 + (1 - p Y_t/S)^2 (sigma_2/Y_t)^2) + p sigma_2/S = 1; mode B
    sqrt(t^2 + (q sigma_2/S)^2) + q sigma_2/S = 1 up to |sigma_2/tau| = R_A/tau_c; beyond it, mode C
    (t/(2 (1 + q_t)))^2 + (sigma_2/Y_c)^2 = -sigma_2/Y_c; fibre sigma_1 = X_t, -sigma_1 = X_c.
    Here R_A = Y_c/(2 (1 + q_t)), q_t = q R_A/S and tau_c = S sqrt(1 + 2 q_t). Squared,
    mode A is t^2 + (1/Y_t^2 - 2 p/(S Y_t)) sigma_2^2 + 2 p sigma_2/S = 1 and mode B is
    t^2 + 2 q sigma_2/S = 1.

    Parameters
    ----------
    stress : sigma_1, sigma_2, sigma_3 (not used), tau_12 of the load [Pa]
    strength : ply strengths
    residual : stress that does not grow with the load [Pa], or None
    elastic : not used [-]
    inclination_tension, inclination_compression : p and q [-]: 0.35 and 0.30 for CFRP, 0.30 and
        0.25 for GFRP

    Returns
    -------
    utilisation of each mode [-], 0 where another inter-fibre mode fails; infinite where the
    residual stress alone fails the ply

    Notes
    -----
    Valid: unidirectional plies in plane stress, p Y_t < S, Y_c > S/2.

    The parabola of mode B touches the ellipse of mode C at their corner and encloses it, so the
    point where the load meets the parabola decides between the two modes.

    References
    ----------
    [Puck2002] plane-stress modes A, B, C; 1/SR [derived] from the quadratics along the load

    Examples
    --------
    >>> p = PlyStrength(1900.0, 1300.0, 55.0, 190.0, 85.0)
    >>> modes = puck_modes(stress=(0.0, -20.0, 0.0, 60.0), strength=p)
    >>> print(f"{1 / modes['inter-fibre B']:.6f}")
    1.565399
    """
    s, up, down = strength, inclination_tension, inclination_compression
    across, slip = stress[1], stress[3] / s.shear_12
    held = None if residual is None else (residual[1], residual[3] / s.shear_12)
    tension, compression = one_stress_modes(
        stress=stress[0],
        tension=s.tension_1,
        compression=s.compression_1,
        residual=None if residual is None else residual[0],
    )
    root = namespace(s.compression_2, s.shear_12, down).sqrt
    steep = (root(1 + 2 * down * s.compression_2 / s.shear_12) - 1) / 2
    corner = steep * s.shear_12 / down, root(1 + 2 * steep)
    weight = 1 / (4 * (1 + steep) * (1 + steep))
    used, pulled, broken = _matrix_surface(
        across,
        slip,
        held,
        tension=(
            (1 / s.tension_2 - 2 * up / s.shear_12) / s.tension_2,
            up / s.shear_12,
        ),
        compression=(0.0, down / s.shear_12),
    )
    if held is None:
        crushed = _in_mode_c(across, slip, corner)
        crush = -across / s.compression_2
        mode_c = weight * slip * slip / where(crushed, crush, 1.0) + crush
    else:
        mode_c, outside = _puck_mode_c(across, slip, held, weight, s.compression_2)
        crossing = (across + held[0] * used, slip + held[1] * used)
        at_rest = _in_mode_c(*held, corner)
        outside = at_rest & outside
        crushed = where(broken, at_rest, _in_mode_c(*crossing, corner)) | outside
        broken = broken | outside
        used, mode_c = where(broken, inf, used), where(broken, inf, mode_c)
    between = where(crushed, 0.0, used)
    return {
        "fibre tension": tension,
        "fibre compression": compression,
        "inter-fibre A": where(pulled, between, 0.0),
        "inter-fibre B": where(pulled, 0.0, between),
        "inter-fibre C": where(crushed, mode_c, 0.0),
    }
