"""Quadratic ply failure criteria (Tsai-Hill, Tsai-Wu) and Puck's, as utilisations.

The criteria that name a failure mode, the ply strengths and the conventions are in
`strength_modes`.
"""

from __future__ import annotations

from ..numeric import Array, absolute, maximum, namespace, real, where
from .strength_modes import PlyStrength


def inverse_tsai_hill(
    *, stress_1: Array, stress_2: Array, shear_12: Array, strength: PlyStrength
) -> Array:
    """Utilisation by the classical Tsai-Hill criterion, tension strengths always.

    sqrt(sigma_1^2/X_t^2 - sigma_1 sigma_2/X_t^2 + sigma_2^2/Y_t^2 + tau^2/S^2).

    Parameters
    ----------
    stress_1, stress_2, shear_12 : ply stresses [Pa]
    strength : ply strengths

    Returns
    -------
    utilisation [-]

    Notes
    -----
    Valid: plane stress, X_t > Y_t/2.

    References
    ----------
    [Jones1999] Tsai-Hill

    Examples
    --------
    >>> p = PlyStrength(1900.0, 1300.0, 55.0, 190.0, 85.0)
    >>> u = inverse_tsai_hill(stress_1=400.0, stress_2=30.0, shear_12=40.0, strength=p)
    >>> print(f"{1 / u:.5f}")
    1.33634
    """
    s = strength
    along, across, slip = stress_1 / s.tension_1, stress_2 / s.tension_2, shear_12 / s.shear_12
    mixed = along * stress_2 / s.tension_1
    squares = along * along - mixed + across * across + slip * slip
    return namespace(squares).sqrt(squares)


def _tsai_wu_form(strength: PlyStrength, interaction: Array, *, radial: bool) -> tuple[Array, ...]:
    """Coefficients F1, F2, F11, F22, F66, 2 F12, 2 F23 of Tsai-Wu."""
    s = strength
    f1, f2 = 1 / s.tension_1 - 1 / s.compression_1, 1 / s.tension_2 - 1 / s.compression_2
    f11, f22 = 1 / (s.tension_1 * s.compression_1), 1 / (s.tension_2 * s.compression_2)
    f66 = 1 / (s.shear_12 * s.shear_12)
    twice_f12 = 2 * interaction * namespace(f11, f22).sqrt(f11 * f22)
    twice_f23: Array = 0.0
    if radial:
        across = s.shear_23
        twice_f23 = -f22 if across is None else 2 * f22 - 1 / (across * across)
    return f1, f2, f11, f22, f66, twice_f12, twice_f23


def inverse_tsai_wu(
    *,
    stress_1: Array,
    stress_2: Array,
    shear_12: Array,
    strength: PlyStrength,
    stress_3: Array | None = None,
    interaction: Array = -0.5,
    residual: tuple[Array, Array, Array] | None = None,
) -> Array:
    """Utilisation by the Tsai-Wu criterion, in plane stress or with a radial stress.

    a SR^2 + b SR = 1, a = sum F_ij sigma_i sigma_j, b = sum F_i sigma_i: 1/SR =
    (b + sqrt(b^2 + 4 a))/2; F_12 = F_12* sqrt(F_11 F_22), F_13 = F_12, F_3 = F_2, F_33 = F_22,
    F_23 = -F_22/2, or F_22 - 1/(2 S_23^2) where S_23 is known. A residual stress is not
    multiplied by SR: it adds to b and takes from the 1.

    Parameters
    ----------
    stress_1, stress_2, shear_12 : ply stresses of the load [Pa]
    strength : ply strengths
    stress_3 : radial stress of the load [Pa], or None in plane stress
    interaction : F_12* [-], between -1 and 1
    residual : residual (thermal) sigma_1, sigma_2, tau_12 [Pa]

    Returns
    -------
    utilisation [-]; not positive where the ply never fails; NaN where the residual stress alone
    fails it

    Notes
    -----
    Valid: |F_12*| < 1.

    References
    ----------
    [TsaiWu1971]; F_23 [derived] from isotropy in the 2-3 plane

    Examples
    --------
    >>> p = PlyStrength(1900.0, 1300.0, 55.0, 190.0, 85.0)
    >>> u = inverse_tsai_wu(stress_1=400.0, stress_2=30.0, shear_12=40.0, strength=p)
    >>> print(f"{1 / u:.6f}")
    1.408903
    """
    f1, f2, f11, f22, f66, twice_f12, twice_f23 = _tsai_wu_form(
        strength, interaction, radial=stress_3 is not None
    )
    square = (
        (f11 * stress_1 + twice_f12 * stress_2) * stress_1
        + f22 * stress_2 * stress_2
        + f66 * shear_12 * shear_12
    )
    linear = f1 * stress_1 + f2 * stress_2
    if stress_3 is not None:
        square = square + (f22 * stress_3 + twice_f12 * stress_1 + twice_f23 * stress_2) * stress_3
        linear = linear + f2 * stress_3
    left: Array = 1.0
    if residual is not None:
        held_1, held_2, held_12 = residual
        pull_1 = 2 * f11 * held_1 + twice_f12 * held_2
        pull_2 = 2 * f22 * held_2 + twice_f12 * held_1
        linear = linear + pull_1 * stress_1 + pull_2 * stress_2 + 2 * f66 * held_12 * shear_12
        if stress_3 is not None:
            linear = linear + (twice_f12 * held_1 + twice_f23 * held_2) * stress_3
        used = (pull_1 * held_1 + pull_2 * held_2) / 2 + f66 * held_12 * held_12
        left = 1 - used - f1 * held_1 - f2 * held_2
        left = where(real(left) > 0, left, 0 * left + float("nan"))
    inside = linear * linear + 4 * square * left
    never = real(inside) < 0
    root = namespace(inside).sqrt(where(never, 0 * inside, inside))
    return where(never, 0 * inside, (linear + root) / (2 * left))


def inverse_puck(
    *,
    stress_1: Array,
    stress_2: Array,
    shear_12: Array,
    strength: PlyStrength,
    inclination_tension: Array = 0.35,
    inclination_compression: Array = 0.30,
) -> Array:
    """Utilisation (stress exposure) by Puck's plane-stress criterion.

    Mode A (sigma_2 >= 0): sqrt((tau/S)^2 + (1 - p Y_t/S)^2 (sigma_2/Y_t)^2) + p sigma_2/S; mode B
    (|sigma_2/tau| <= R_A/tau_c): [sqrt(tau^2 + (q sigma_2)^2) + q sigma_2]/S; mode C otherwise:
    [(tau/(2 (1 + q_t) S))^2 + (sigma_2/Y_c)^2] Y_c/(-sigma_2); fibre sigma_1/X_t, -sigma_1/X_c.

    Parameters
    ----------
    stress_1, stress_2, shear_12 : ply stresses [Pa]
    strength : ply strengths
    inclination_tension, inclination_compression : p and q [-]: 0.35 and 0.30 for CFRP, 0.30 and
        0.25 for GFRP

    Returns
    -------
    stress exposure [-], the larger of fibre and inter-fibre failure

    Notes
    -----
    Valid: unidirectional plies, Y_c > S/2.

    References
    ----------
    [Puck2002] plane-stress modes A, B, C

    Examples
    --------
    >>> p = PlyStrength(1900.0, 1300.0, 55.0, 190.0, 85.0)
    >>> print(f"{1 / inverse_puck(stress_1=0.0, stress_2=-20.0, shear_12=60.0, strength=p):.6f}")
    1.565399
    """
    s, up, down = strength, inclination_tension, inclination_compression
    shear = s.shear_12
    root = namespace(stress_1, stress_2, shear_12, shear).sqrt
    slip = shear_12 / shear
    plane = shear / (2 * down) * (root(1 + 2 * down * s.compression_2 / shear) - 1)
    steep = down * plane / shear
    limit = shear * root(1 + 2 * steep)
    pulled = real(stress_2) >= 0
    lift = (1 - up * s.tension_2 / shear) * stress_2 / s.tension_2
    mode_a = root(slip * slip + lift * lift) + up * stress_2 / shear
    press = down * stress_2 / shear
    mode_b = root(slip * slip + press * press) + press
    sheared = real(absolute(stress_2) * limit) <= real(plane * absolute(shear_12))
    crush = -stress_2 / s.compression_2
    idle = sheared | (real(crush) < 1e-300)
    wedge = slip / (2 * (1 + steep))
    mode_c = wedge * wedge / where(idle, 0 * crush + 1, crush) + crush
    between = where(pulled, mode_a, where(sheared, mode_b, mode_c))
    fibre = maximum(stress_1 / s.tension_1, -stress_1 / s.compression_1)
    return maximum(fibre, between)
