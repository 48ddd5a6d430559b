"""A threaded port in a round boss on the outside of a tube: volumes in closed forms."""

from __future__ import annotations

from math import pi

from ..base.numeric import Array, geometry


@geometry
def saddle_depth(*, boss_diameter: Array, tube_radius: Array) -> Array:
    """Mean distance between a tube and the plane that touches it, under a round boss.

    With the boss radius a and the tube radius R, the distance at the offset y from the tube's axis
    is R - sqrt(R^2 - y^2). Its mean over the disc is a^2/(8 R) + a^4/(64 R^3) + 5 a^6/(1024 R^5) +
    35 a^8/(16384 R^7) + ...

    Parameters
    ----------
    boss_diameter : 2 a [m]
    tube_radius : R [m]

    Returns
    -------
    mean distance [m]

    Notes
    -----
    Valid: a <= 0.8 R; there the terms left out are 0.3 % of the mean.

    References
    ----------
    [derived] mean of the binomial series over a disc

    Examples
    --------
    >>> print(f"{saddle_depth(boss_diameter=14e-3, tube_radius=15e-3) * 1e3:.4f} mm")
    0.4203 mm
    """
    square = boss_diameter * boss_diameter / (4 * tube_radius * tube_radius)
    terms = 1 / 8 + square * (1 / 64 + square * (5 / 1024 + square * 35 / 16384))
    return tube_radius * square * terms


@geometry
def boss_volume(*, boss_diameter: Array, height: Array, tube_radius: Array) -> Array:
    """Volume of a round boss that stands on a tube, pi a^2 (h + mean saddle depth).

    Parameters
    ----------
    boss_diameter : 2 a [m]
    height : h of the boss above the tube [m]
    tube_radius : outer radius of the tube [m]

    Returns
    -------
    volume of the solid boss, without its hole [m^3]

    Notes
    -----
    Valid: as `saddle_depth`.

    References
    ----------
    [derived] cylinder cut by a cylinder

    Examples
    --------
    >>> v = boss_volume(boss_diameter=14e-3, height=11.5e-3, tube_radius=15e-3)
    >>> print(f"{v * 1e9:.1f} mm3")
    1835.0 mm3
    """
    saddle = saddle_depth(boss_diameter=boss_diameter, tube_radius=tube_radius)
    return pi / 4 * boss_diameter * boss_diameter * (height + saddle)
