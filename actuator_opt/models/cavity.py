"""Cavitation of oil without air: a cavity opens below atmospheric pressure and closes above."""

from __future__ import annotations

from ..base.numeric import Array, expm1_quotient, namespace, real, where
from .fluid import ATMOSPHERIC_PRESSURE


def cavity(
    *,
    pressure: Array,
    content: Array,
    polytropic_index: Array = 1.4,
    atmospheric_pressure: Array = ATMOSPHERIC_PRESSURE,
) -> tuple[Array, Array, Array]:
    """Volume of a cavity over the oil's at zero gauge pressure, -dG/dp, and the work to open it.

    G = c (r - 1)^2 with r = (p_a/(p_a + p))^(1/n) below zero gauge pressure, none above: the volume
    and its slope are continuous, and no pressure reaches a vacuum. Its work is
    -int p dG = c p_a ((r - 1)^2 - 2 ((r^(2-n) - 1)/(2 - n) - (r^(1-n) - 1)/(1 - n))).

    Parameters
    ----------
    pressure : gauge pressure p [Pa], above -p_a
    content : c, what bounds the vacuum [-] (a choice)
    polytropic_index : n of what fills the cavity [-]
    atmospheric_pressure : p_a [Pa]

    Returns
    -------
    volume G [-], -dG/dp [1/Pa], work over the oil's volume [J/m^3]; all zero from p = 0 up

    Notes
    -----
    Valid: any pressure above vacuum.

    No law of cavitation, but a bound on the tension of oil.

    References
    ----------
    [derived] quadratic in the expansion of a polytropic gas, so that no gas is left at p = 0

    Examples
    --------
    >>> for pressure in (1e5, -0.5e5, -0.9e5):
    ...     volume, falling, work = cavity(pressure=pressure, content=1e-4)
    ...     print(f"{volume:.3e} {falling:.3e} {work:.3f}")
    0.000e+00 0.000e+00 0.000
    3.913e-05 2.830e-09 1.482
    1.432e-03 2.283e-07 116.027
    """
    n = polytropic_index
    opened = real(pressure) < 0
    left = atmospheric_pressure + where(opened, pressure, 0 * pressure)
    share = namespace(left, n).log(atmospheric_pressure / left) / n
    grown = share * expm1_quotient(share)  # r - 1, which keeps its digits near zero
    volume = content * grown * grown
    falling = 2 * content * grown * (1 + grown) / (n * left)
    change = share * (expm1_quotient((2 - n) * share) - expm1_quotient((1 - n) * share))
    return volume, falling, content * atmospheric_pressure * (grown * grown - 2 * change)
