"""LuGre bristle friction: exact step, steady state, passivity and rules of thumb.

The friction level g(v) is `friction.stribeck_level`.
"""

from __future__ import annotations

from typing import NamedTuple

from ..base.numeric import Array, absolute, namespace, real, where


class LuGreStep(NamedTuple):
    """Bristle deflection and friction force after a time step."""

    deflection: Array
    force: Array


def lugre_step(
    *,
    deflection: Array,
    speed: Array,
    time_step: Array,
    level: Array,
    bristle_stiffness: Array,
    bristle_damping: Array,
    viscous: Array,
) -> LuGreStep:
    """One step of the LuGre model at constant speed, exact and unconditionally stable.

    dz/dt = v - sigma0 |v| z/g has z(t) = z_ss + (z0 - z_ss) e^(-sigma0 |v| t/g),
    z_ss = (g/sigma0) sgn v; F = sigma0 z + sigma1 dz/dt + sigma2 v.

    Parameters
    ----------
    deflection : z0 [m]
    speed : [m/s], constant over the step
    time_step : [s]
    level : g(v) of `stribeck_level` [N]
    bristle_stiffness : sigma0 [N/m]
    bristle_damping : sigma1 [N s/m]
    viscous : sigma2 [N s/m]

    Returns
    -------
    deflection [m] and force [N] at the end of the step

    Notes
    -----
    Valid: passive while |v| <= `lugre_passive_speed`.

    References
    ----------
    [AaltoThesis] eq. 27, 28, 29; [derived] closed form at constant speed

    Examples
    --------
    >>> step = lugre_step(deflection=0.0, speed=0.02, time_step=1e-3, level=683.9397,
    ...     bristle_stiffness=1e7, bristle_damping=3e4, viscous=1000.0)
    >>> print(f"{step.deflection * 1e6:.4f} um {step.force:.3f} N")
    17.3411 um 641.283 N
    """
    rate = bristle_stiffness * absolute(speed) / level
    decay = rate * time_step
    # (v - rate z0) dt E(-decay), E(y) = expm1(y)/y, needs no z_ss and so no sgn v.
    tail = namespace(decay).exp(-decay)
    slip = speed - rate * deflection
    moving = real(decay) > 1e-9
    mean = where(moving, (1 - tail) / where(moving, decay, 1.0), 1 - 0.5 * decay)
    after = deflection + slip * mean * time_step
    return LuGreStep(
        after, bristle_stiffness * after + bristle_damping * slip * tail + viscous * speed
    )


def lugre_steady_deflection(*, speed: Array, level: Array, bristle_stiffness: Array) -> Array:
    """Bristle deflection in steady sliding, z = (g/sigma0) sgn v.

    Parameters
    ----------
    speed : [m/s]
    level : g(v) of `stribeck_level` [N]
    bristle_stiffness : sigma0 [N/m]

    Returns
    -------
    deflection [m]; 0 at rest

    Notes
    -----
    Valid: |z| <= F_S/sigma0.

    References
    ----------
    [AaltoThesis] eq. 27 at dz/dt = 0

    Examples
    --------
    >>> lugre_steady_deflection(speed=-0.1, level=500.0, bristle_stiffness=1e7)
    -5e-05
    """
    direction = where(real(speed) > 0, 1.0, where(real(speed) < 0, -1.0, 0.0 * real(speed)))
    return level / bristle_stiffness * direction


def lugre_passive_speed(*, level: Array, bristle_damping: Array, viscous: Array) -> Array:
    """Largest speed at which the LuGre model cannot create energy.

    The speed is 4 g (sigma1 + sigma2)/sigma1^2. With the stored energy sigma0 z^2/2, the
    dissipation is a quadratic form in (z, dz/dt), which is not negative up to this speed. Beyond
    it, taper sigma1 (`lugre_tapered_damping`).

    Parameters
    ----------
    level : g at that speed [N]
    bristle_damping : sigma1 [N s/m]
    viscous : sigma2 [N s/m]

    Returns
    -------
    speed [m/s]

    Notes
    -----
    Valid: sigma1 > 0.

    References
    ----------
    [derived] discriminant of the power balance; sigma2 = 0 gives sigma1 |v| <= 4 g

    Examples
    --------
    >>> limit = lugre_passive_speed(level=500.0, bristle_damping=48373.5, viscous=1000.0)
    >>> print(f"{limit:.4f} m/s")
    0.0422 m/s
    """
    return 4 * level * (bristle_damping + viscous) / (bristle_damping * bristle_damping)


def lugre_tapered_damping(*, bristle_damping: Array, speed: Array, taper_speed: Array) -> Array:
    """Bristle damping that fades with speed, sigma1 e^(-(v/v_d)^2), to stay passive.

    Parameters
    ----------
    bristle_damping : sigma1 at rest [N s/m]
    speed, taper_speed : v, v_d [m/s]

    Returns
    -------
    sigma1 at that speed [N s/m]

    Notes
    -----
    Valid: v_d below about half of the `lugre_passive_speed` that g and sigma1 at rest give.

    References
    ----------
    [derived] keeps sigma1 |v| <= 4 g at every speed

    Examples
    --------
    >>> print(f"{lugre_tapered_damping(bristle_damping=3e4, speed=0.02, taper_speed=0.02):.0f}")
    11036
    """
    ratio = speed / taper_speed
    return bristle_damping * namespace(ratio).exp(-ratio * ratio)


def lugre_bristle_stiffness(*, static: Array, largest_deflection: Array) -> Array:
    """Bristle stiffness from the pre-sliding distance, sigma0 = F_S/z_max.

    Parameters
    ----------
    static : F_S [N]
    largest_deflection : z_max [m] (0.1 mm in the source)

    Returns
    -------
    sigma0 [N/m]

    Notes
    -----
    Valid: rule of thumb; fit it where records exist.

    References
    ----------
    [MECE5005] LuGre model

    Examples
    --------
    >>> print(f"{lugre_bristle_stiffness(static=1000.0, largest_deflection=1e-4):.3g}")
    1e+07
    """
    return static / largest_deflection


def lugre_bristle_damping(*, bristle_stiffness: Array, mass: Array) -> Array:
    """Bristle damping that damps the stuck mass with zeta = 1/2, sigma1 = sqrt(sigma0 m).

    Parameters
    ----------
    bristle_stiffness : sigma0 [N/m]
    mass : [kg]

    Returns
    -------
    sigma1 [N s/m]

    Notes
    -----
    Valid: rule of thumb.

    References
    ----------
    [MECE5005] LuGre model

    Examples
    --------
    >>> print(f"{lugre_bristle_damping(bristle_stiffness=1e7, mass=234.0):.1f}")
    48373.5
    """
    return namespace(bristle_stiffness * mass).sqrt(bristle_stiffness * mass)


def lugre_rate(*, deflection: Array, speed: Array, level: Array, bristle_stiffness: Array) -> Array:
    """Rate of the bristle deflection, dz/dt = v - sigma0 |v| z/g(v).

    Parameters
    ----------
    deflection : z [m]
    speed : v [m/s]
    level : g(v) of `stribeck_level` [N], > 0
    bristle_stiffness : sigma0 [N/m]

    Returns
    -------
    rate [m/s]

    Notes
    -----
    Valid: |z| <= F_S/sigma0; this rate keeps z in the range.

    References
    ----------
    [AaltoThesis] eq. 27; [MECE5005] LuGre model

    Examples
    --------
    >>> rate = lugre_rate(deflection=5e-5, speed=0.02, level=683.9397, bristle_stiffness=1e7)
    >>> print(f"{rate:.6f} m/s")
    0.005379 m/s
    """
    return speed - bristle_stiffness * absolute(speed) * deflection / level


def lugre_force(
    *,
    deflection: Array,
    rate: Array,
    speed: Array,
    bristle_stiffness: Array,
    bristle_damping: Array,
    viscous: Array,
) -> Array:
    """Friction of the bristles, F = sigma0 z + sigma1 dz/dt + sigma2 v.

    Parameters
    ----------
    deflection : z [m]
    rate : dz/dt of `lugre_rate` [m/s]
    speed : v [m/s]
    bristle_stiffness : sigma0 [N/m]
    bristle_damping : sigma1 [N s/m]
    viscous : sigma2 [N s/m]

    Returns
    -------
    friction [N]

    Notes
    -----
    Valid: passive while |v| <= `lugre_passive_speed`.

    References
    ----------
    [AaltoThesis] eq. 29; [MECE5005] LuGre model

    Examples
    --------
    >>> force = lugre_force(deflection=5e-5, rate=0.005379, speed=0.02, bristle_stiffness=1e7,
    ...                     bristle_damping=3e4, viscous=1000.0)
    >>> print(f"{force:.2f} N")
    681.37 N
    """
    return bristle_stiffness * deflection + bristle_damping * rate + viscous * speed
