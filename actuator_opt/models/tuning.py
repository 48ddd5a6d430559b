"""Controller tuning from the ultimate point of a loop, its limit of stability.

The controller is u = K (e + (1/T_i) integral of e + T_d de/dt).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..base.numeric import Array, positive

GAIN_MARGIN = 3.0
"""Ultimate gain over gain (a choice: room for the friction, oil and strokes that the linear loop
leaves out)."""
_ZIEGLER_NICHOLS = {"p": (0.5, None, 0.0), "pi": (0.45, 1 / 1.2, 0.0), "pid": (0.6, 1 / 2, 1 / 8)}
"""K/K_u, T_i/T_u and T_d/T_u."""


class ControllerGains(NamedTuple):
    """Gain and times of a controller."""

    proportional_gain: Array
    """K, in the unit of the ultimate gain."""
    integral_time: Array
    """T_i [s]; infinite without an integral part."""
    derivative_time: Array
    """T_d [s]; 0 without a derivative part."""


def ziegler_nichols(*, law: str, ultimate_gain: Array, ultimate_period: Array) -> ControllerGains:
    """Ziegler-Nichols rule from the ultimate point: quick, for a plant that is well damped.

    P 0.5 K_u; PI 0.45 K_u, T_u/1.2; PID 0.6 K_u, T_u/2, T_u/8. A lightly damped oil spring leaves
    its PID hardly any gain margin, and its PI swings: `margin_rules` is calmer there.

    Parameters
    ----------
    law : "p", "pi" or "pid" [-]
    ultimate_gain : K_u, the gain at which the loop swings for ever [V/m or another]
    ultimate_period : T_u of that swing [s]

    Returns
    -------
    gain [that of K_u], integral time [s] and derivative time [s]

    Notes
    -----
    Valid: K_u without dry friction, which inflates it: such a loop overshoots by half.

    References
    ----------
    [ZieglerNichols1942] ultimate sensitivity; [MECE5005] closed loop control system tuning

    Examples
    --------
    >>> gains = ziegler_nichols(law="pid", ultimate_gain=400.0, ultimate_period=0.008)
    >>> print(f"{gains.proportional_gain:.0f} V/m, {gains.integral_time:.3f} s, "
    ...       f"{gains.derivative_time:.3f} s")
    240 V/m, 0.004 s, 0.001 s
    """
    if law not in _ZIEGLER_NICHOLS:
        raise ValueError(f"law: {law}; choose one of {', '.join(_ZIEGLER_NICHOLS)}")
    proportional, integral, derivative = _ZIEGLER_NICHOLS[law]
    return ControllerGains(
        proportional * ultimate_gain,
        math.inf if integral is None else integral * ultimate_period,
        derivative * ultimate_period,
    )


def margin_rules(
    *,
    law: str,
    ultimate_gain: Array,
    velocity_gain: Array,
    gain_margin: Array = GAIN_MARGIN,
) -> ControllerGains:
    """Calm position loop, K = K_u/margin and for PI T_i = 4/(K K_v).

    That integral time damps the slow pair of poles, s^2 + K K_v s + K K_v/T_i, critically; its zero
    overshoots a step by e^-2. There is no PID: behind a lightly damped oil spring a derivative part
    takes gain margin away and gives nothing back.

    Parameters
    ----------
    law : "p" or "pi" [-]
    ultimate_gain : K_u of the position loop [V/m]
    velocity_gain : K_v, steady speed per signal [m/s/V], > 0
    gain_margin : K_u/K [-], > 1

    Returns
    -------
    gain [V/m], integral time [s], derivative time 0 [s]; NaN where a divisor is not positive

    Notes
    -----
    Valid: loops that integrate once, K K_v well below the oil's frequency.

    References
    ----------
    [Skogestad2003] integral time of an integrating plant; [derived] damping ratio 1 of the pair

    Examples
    --------
    >>> gains = margin_rules(law="pi", ultimate_gain=420.0, velocity_gain=0.13)
    >>> print(f"{gains.proportional_gain:.0f} V/m, {gains.integral_time:.3f} s")
    140 V/m, 0.220 s
    """
    if law not in ("p", "pi"):
        raise ValueError(f"law: {law}; the margin rules give p or pi, take ziegler_nichols")
    gain = ultimate_gain / positive(gain_margin)
    integral = math.inf if law == "p" else 4 / (gain * positive(velocity_gain))
    return ControllerGains(gain, integral, 0.0)
