"""Seal friction: dry friction, Stribeck curve, and published parameters.

Friction has the sign of the speed; the magnitudes here are positive. The dynamic form, LuGre, is in
`lugre`.
"""

from __future__ import annotations

import math

from ..base.dataclass import dataclass
from ..base.numeric import Array, absolute, geometry, maximum, namespace, real, where


@geometry
def seal_friction(
    *, line_load: Array, diameter: Array, friction_coefficient: Array, count: Array = 1.0
) -> Array:
    """Dry running friction of equal ring seals, F = n mu f pi D.

    Parameters
    ----------
    line_load : normal force per length of circumference [N/m]
    diameter : of the sliding surface (bore or rod) [m]
    friction_coefficient : [-]
    count : number of rings that carry this line load [-] (back-to-back rings do not both carry the
        pressure)

    Returns
    -------
    friction [N]

    Notes
    -----
    Valid: dry or boundary lubrication; above it an oil film carries part of the load.

    References
    ----------
    [ElAsswad2018] eq. 15; [derived] squeeze preload inside the line load

    Examples
    --------
    >>> print(f"{seal_friction(line_load=2000.0, diameter=25e-3, friction_coefficient=0.1):.2f}")
    15.71
    """
    return math.pi * friction_coefficient * line_load * diameter * count


@geometry
def coulomb_as_published(
    *,
    pressure: Array,
    friction_coefficient: Array,
    piston_contact_width: Array,
    bore: Array,
    rod_contact_width: Array,
    rod_diameter: Array,
) -> Array:
    """Coulomb friction as printed, F = mu dp (pi b_p D + pi b_r d).

    Zero at dp = 0: the squeeze preload is missing.

    Parameters
    ----------
    pressure : pressure difference, the same at both seals [Pa]
    friction_coefficient : [-]
    piston_contact_width, rod_contact_width : `seals.width_as_published` [m]
    bore, rod_diameter : D and d under pressure, the bore grown by 2 delta_r [m]

    Returns
    -------
    friction as published [N]

    Notes
    -----
    Valid: to reproduce the source only.

    References
    ----------
    [ElAsswad2018] eq. 15, 16, 17, 18, 20

    Examples
    --------
    >>> f = coulomb_as_published(pressure=1e6, friction_coefficient=0.61, bore=25e-3,
    ...     piston_contact_width=1e-3, rod_contact_width=1e-3, rod_diameter=12e-3)
    >>> print(f"{f:.2f}")
    70.91
    """
    area = math.pi * (piston_contact_width * bore + rod_contact_width * rod_diameter)
    return friction_coefficient * pressure * area


def breakaway(*, running: Array, ratio: Array) -> Array:
    """Breakaway friction from running friction, F_S = ratio F_C.

    Parameters
    ----------
    running : [N]
    ratio : F_S/F_C, to be measured [-] (1.5 to 3 for elastomers)

    Returns
    -------
    breakaway friction [N]

    Notes
    -----
    Valid: for the dwell time after which the ratio was measured.

    References
    ----------
    [derived] definition of the ratio

    Examples
    --------
    >>> breakaway(running=100.0, ratio=2.0)
    200.0
    """
    return ratio * running


def stribeck_level(
    *, speed: Array, coulomb: Array, static: Array, stribeck_speed: Array, exponent: Array
) -> Array:
    """Friction level without sign and viscous part, g = F_C + (F_S - F_C) e^(-|v/v_s|^delta).

    Parameters
    ----------
    speed : [m/s]
    coulomb, static : Coulomb and breakaway friction F_C, F_S [N]
    stribeck_speed : v_s [m/s]
    exponent : delta [-]

    Returns
    -------
    friction level [N]

    Notes
    -----
    Valid: F_S >= F_C > 0.

    References
    ----------
    [AaltoThesis] eq. 30, [Huang2017] eq. 31

    Examples
    --------
    >>> g = stribeck_level(speed=0.02, coulomb=500.0, static=1000.0, stribeck_speed=0.02,
    ...                    exponent=2.0)
    >>> print(f"{g:.2f}")
    683.94
    """
    decay = (absolute(speed) / stribeck_speed) ** exponent
    return coulomb + (static - coulomb) * namespace(decay).exp(-decay)


def stribeck(
    *,
    speed: Array,
    coulomb: Array,
    static: Array,
    stribeck_speed: Array,
    exponent: Array,
    viscous: Array,
    smoothing_speed: Array | None = None,
) -> Array:
    """Steady friction, F = [F_C + (F_S - F_C) e^(-|v/v_s|^delta)] sgn v + sigma2 v.

    Parameters
    ----------
    speed : [m/s], signed
    coulomb, static : Coulomb and breakaway friction F_C, F_S [N]
    stribeck_speed : [m/s] (papers print mm/s)
    exponent : delta [-]
    viscous : sigma2 [N s/m]
    smoothing_speed : v_eps much smaller than v_s replaces sgn v by tanh(v/v_eps) [m/s]; None keeps
        the step (0 at v = 0)

    Returns
    -------
    friction [N], with the sign of the speed

    Notes
    -----
    Valid: steady sliding.

    References
    ----------
    [Huang2017] eq. 31, [AaltoThesis] eq. 31, [MECE5005] Stribeck curve

    Examples
    --------
    >>> f = stribeck(speed=0.04, coulomb=500.0, static=1000.0, stribeck_speed=0.02,
    ...              exponent=2.0, viscous=1000.0)
    >>> print(f"{f:.3f}")
    549.158
    """
    level = stribeck_level(
        speed=speed,
        coulomb=coulomb,
        static=static,
        stribeck_speed=stribeck_speed,
        exponent=exponent,
    )
    if smoothing_speed is None:
        direction = where(real(speed) > 0, 1.0, where(real(speed) < 0, -1.0, 0.0 * real(speed)))
    else:
        ratio = speed / smoothing_speed
        direction = namespace(ratio).tanh(ratio)
    return level * direction + viscous * speed


def stribeck_slope(
    *,
    speed: Array,
    coulomb: Array,
    static: Array,
    stribeck_speed: Array,
    exponent: Array,
    viscous: Array,
) -> Array:
    """Incremental damping of the Stribeck curve, dF/dv; negative where it falls (stick-slip).

    dF/dv = sigma2 - (F_S - F_C) (delta/v_s) y^(delta - 1) e^(-y^delta), y = |v|/v_s; the same for
    both signs of the speed. At rest it is the limit v -> 0+ of the sliding branch, taken at
    y = 1e-9; for delta < 1 no limit exists.

    Parameters
    ----------
    speed : [m/s]
    coulomb, static : Coulomb and breakaway friction F_C, F_S [N]
    stribeck_speed : [m/s]
    exponent : delta [-]
    viscous : sigma2 [N s/m]

    Returns
    -------
    incremental damping [N s/m]

    Notes
    -----
    Valid: sliding; it says nothing about stiction.

    References
    ----------
    [derived] derivative of [Huang2017] eq. 31 times v

    Examples
    --------
    >>> b = stribeck_slope(speed=0.02, coulomb=500.0, static=1000.0, stribeck_speed=0.02,
    ...                    exponent=2.0, viscous=1000.0)
    >>> print(f"{b:.1f}")
    -17394.0
    """
    y = maximum(absolute(speed) / stribeck_speed, 1e-9)
    decay = y**exponent
    fall = (static - coulomb) * exponent * decay * namespace(decay).exp(-decay)
    return viscous - fall / (y * stribeck_speed)


@dataclass(frozen=True, slots=True)
class StribeckParameters:
    """Stribeck parameters that were identified at one chamber pressure, in SI units."""

    pressure: float
    static: float
    coulomb: float
    exponent: float
    stribeck_speed: float
    viscous: float


HUANG_TABLE_2 = (
    StribeckParameters(0.6e6, 2100.0, 1419.0, 2.0, 1.5e-3, 1.1e4),
    StribeckParameters(2.0e6, 1900.0, 800.0, 1.2, 1.9e-3, 1.0e4),
    StribeckParameters(4.0e6, 1100.0, 362.8, 1.3, 2.2e-3, 1.3e4),
    StribeckParameters(6.0e6, 1100.0, 300.0, 2.0, 1.2e-3, 1.6e4),
)
"""Parameters of a 125 mm plunger cylinder with step ring and Yx seal, [Huang2017] Table 2. The
table prints v_s in mm/s and sigma2 in 1e4 N s/m; here they are in SI."""
