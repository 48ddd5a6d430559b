"""Criteria that separate fibre failure from inter-fibre failure: Hashin, Puck (plane stress).

The sign of sigma_2 at failure decides which surface holds. Without residual stress that is the
sign of the load's sigma_2. With it, the load leads from the residual stress across sigma_2 = 0
at some shear: below S the ply still holds there and fails on the far side, else it has failed
before. Both criteria meet |tau| = S at sigma_2 = 0 from either side, so the utilisation of the
ply is continuous there. Of the modes between the fibres only the one that fails is loaded, the
others are 0. Every surface is a conic in (sigma_2, tau), so along the load a quadratic in SR.
"""

from __future__ import annotations

from math import inf

from ..base.numeric import Array, absolute, namespace, real, where
from .strength_modes import PlyRatios, PlyStrength, Stress, one_stress_modes


def _exit_root(square: Array, half: Array, left: Array) -> Array:
    """1/SR where the load leaves square SR^2 + 2 half SR = left, even if it has to enter first.

    (half + root)/left or square/(root - half), whichever loses no digits.
    """
    inside = half * half + square * left
    root = namespace(inside).sqrt(where(real(inside) > 0, inside, 0.0))
    outward = real(half) > 0
    total = root + where(outward, half, -half)
    below = where(outward, left, total)
    return where(outward, total, square) / where(real(below) > 0, below, 1.0)


def _fails_pulled(across: Array, slip: Array, held: Array, held_slip: Array) -> Array:
    """Whether sigma_2 >= 0 where the growing load fails the ply; shears are over S."""
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
    """1/SR on slip^2 + k sigma_2^2 + 2 m sigma_2 = 1, (k, m) by the sign of sigma_2 at failure.

    Also whether sigma_2 >= 0 there, and whether the residual stress (sigma_2, tau/S) alone fails:
    there 1/SR means nothing and the sign is that of the residual stress.
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
    """Utilisation by (sigma_1/X_t)^2 + share (tau/S)^2 = 1 where sigma_1 >= 0, all scaled.

    A load that pulls a fibre out of residual compression under more shear than that fails it as
    sigma_1 changes sign.
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
    (sigma_2/(2 S_23))^2 + (tau/S)^2 + [(Y_c/(2 S_23))^2 - 1] sigma_2/Y_c = 1; each holds for its
    sign of sigma_1 or sigma_2, with sigma = residual + SR stress.

    Parameters
    ----------
    stress : sigma_1, sigma_2, sigma_3 (not used), tau_12 of the load [Pa]
    strength : ply strengths; S_23 defaults to S_12
    residual : stress that does not grow with the load [Pa], or None
    elastic : not used [-]
    fibre_shear : a, share of the shear term in fibre tension [-], 0 to 1

    Returns
    -------
    utilisation of each mode [-], 0 where the stress at failure has the other sign; infinite where
    the residual stress alone fails the ply

    Notes
    -----
    Valid: unidirectional plies in plane stress.

    The shear term of fibre tension and the default S_23 are choices.

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
    """Whether a stress lies beyond the line from zero to the corner of Puck's modes B and C."""
    return -real(across) * real(corner[1]) > real(corner[0]) * absolute(real(slip))


def _puck_mode_c(
    across: Array, slip: Array, held: tuple[Array, Array], weight: Array, limit: Array
) -> tuple[Array, Array]:
    """1/SR on weight slip^2 + (sigma_2/Y_c)^2 + sigma_2/Y_c = 0; whether `held` is outside it."""
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
    sqrt(t^2 + (q sigma_2/S)^2) + q sigma_2/S = 1 up to |sigma_2/tau| = R_A/tau_c; mode C beyond
    (t/(2 (1 + q_t)))^2 + (sigma_2/Y_c)^2 = -sigma_2/Y_c; fibre sigma_1 = X_t, -sigma_1 = X_c.
    Squared they are t^2 + (1/Y_t^2 - 2 p/(S Y_t)) sigma_2^2 + 2 p sigma_2/S = 1 and
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
    utilisation of each mode [-], 0 where another inter-fibre mode is the one that fails; infinite
    where the residual stress alone fails the ply

    Notes
    -----
    Valid: unidirectional plies in plane stress, p Y_t < S, Y_c > S/2.

    The parabola of mode B touches the ellipse of mode C at their corner and holds it, so the
    crossing of B decides between them.

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
