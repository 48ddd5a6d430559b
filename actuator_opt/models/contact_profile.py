"""Static contact pressure along a seal's contact width: closed forms in t = x/b, and line loads.

There are profiles of O-rings (`o_ring_*`), lips (`lip_*`) and worn-in lands (`land_*`), and tables
(`table_*`). t = 0 is the sealed side, t = 1 the outer side; at either end the closed forms equal
the pressure on that side. All pressures are on one scale, gauge or absolute.

Each closed form has one free parameter, a pressure called its excess. `*_mean` is the mean of the
profile over t. `*_excess` is the excess at which a contact of width b carries the line load
f = b (mean - p_a), which is counted from the outer pressure p_a. A negative excess shows that the
load is too small for this width: the sealed pressure would open the contact, and the profile must
not be used. Without width the excess is NaN.

A land is the worn-in face of a step ring or a compact seal. PTFE and elastomer faces wear and creep
until their pressure is even, so the land carries the falling oil pressure plus a flat excess. New
sharp edges carry more during the first metres of sliding.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from ..base.numeric import Array, clip, geometry, maximum, positive, real, sqrt, where

LIP_PLACES, LIP_SHARE = (0.0, 0.2, 0.6, 1.0), 0.42
"""Knots t of the lip profile, and a ratio: pressure above p_a at the third knot, divided by the
pressure at the second knot (*choice*, surrogate)."""
O_RING_POWER = 10
"""Exponent in p (1 - t^10), the part of the profile that the sealed pressure p adds. It differs by
at most 0.18 p from the same part of this project's finite-element profiles, at a squeeze of 0.10 to
0.20 and p up to the rubber's Young's modulus; the difference is largest near the outer edge. The
mean of the finite-element part is 0.89 to 0.94 p."""


def o_ring_profile(
    *, position: Array, sealed_pressure: Array, outer_pressure: Array, excess: Array
) -> Array:
    """Contact pressure of an O-ring: an ellipse, plus the sealed pressure almost to the outer edge.

    p = p_a + (p_s - p_a)(1 - t^10) + p_0 sqrt(1 - u^2), u = 2 t - 1.

    Parameters
    ----------
    position : t = x/b, 0 to 1 [-]
    sealed_pressure, outer_pressure : p_s, p_a [Pa]
    excess : p_0, peak without pressure [Pa]

    Returns
    -------
    contact pressure [Pa]

    Notes
    -----
    Valid: 0 <= t <= 1, squeeze 0.10 to 0.20, p_s - p_a up to 2 E.

    The rubber passes the pressure on like a liquid; the pressure falls only near the outer edge.

    References
    ----------
    [Johnson1985] line contact; [derived] energised part after own finite elements

    Examples
    --------
    >>> p = o_ring_profile(position=0.25, sealed_pressure=3e6, outer_pressure=0.0, excess=2e6)
    >>> print(f"{p / 1e6:.4f} MPa")
    4.7320 MPa
    """
    square = 4 * position * (1 - position)
    inside = real(square) > 0
    ellipse = where(inside, sqrt(where(inside, square, 1.0)), 0.0)
    energised = 1 - position**O_RING_POWER
    return outer_pressure + (sealed_pressure - outer_pressure) * energised + excess * ellipse


def o_ring_mean(*, sealed_pressure: Array, outer_pressure: Array, excess: Array) -> Array:
    """Mean of the O-ring profile, p_a + (10/11)(p_s - p_a) + pi p_0/4.

    Parameters
    ----------
    sealed_pressure, outer_pressure : p_s, p_a [Pa]
    excess : p_0 [Pa]

    Returns
    -------
    mean contact pressure [Pa]

    Notes
    -----
    Valid: as `o_ring_profile`.

    References
    ----------
    [derived] integral of `o_ring_profile` over t

    Examples
    --------
    >>> p = o_ring_mean(sealed_pressure=3.3e6, outer_pressure=0.0, excess=2e6)
    >>> print(f"{p / 1e6:.4f} MPa")
    4.5708 MPa
    """
    share = O_RING_POWER / (O_RING_POWER + 1)
    return outer_pressure + share * (sealed_pressure - outer_pressure) + (math.pi / 4) * excess


@geometry
def o_ring_excess(
    *, line_load: Array, width: Array, sealed_pressure: Array, outer_pressure: Array
) -> Array:
    """Excess p_0 with which the O-ring profile carries a line load.

    p_0 = (4/pi)[f/b - (10/11)(p_s - p_a)].

    Parameters
    ----------
    line_load : f, counted from the outer pressure [N/m]
    width : b [m]
    sealed_pressure, outer_pressure : p_s, p_a [Pa]

    Returns
    -------
    excess [Pa]

    Notes
    -----
    Valid: result >= 0.

    References
    ----------
    [derived] inverse of `o_ring_mean`

    Examples
    --------
    >>> p = o_ring_excess(line_load=9e3, width=2e-3, sealed_pressure=3.3e6, outer_pressure=0.0)
    >>> print(f"{p / 1e6:.4f} MPa")
    1.9099 MPa
    """
    share = O_RING_POWER / (O_RING_POWER + 1)
    mean = line_load / positive(width) - share * (sealed_pressure - outer_pressure)
    return (4 / math.pi) * mean


def _inner_slope(before: Array, after: Array, left: float, right: float) -> Array:
    """Harmonic mean of two slopes, weighted by interval lengths; 0 if they differ in sign."""
    same = real(before) * real(after) > 0
    one, two = 2 * right + left, right + 2 * left
    below = where(same, one * after + two * before, 1.0)
    return where(same, (one + two) * before * after / below, 0.0)


def _end_slope(near: Array, far: Array, length: float, following: float) -> Array:
    """Slope at an end knot, from a parabola through three knots; limited to avoid overshoot."""
    slope = ((2 * length + following) * near - length * far) / (length + following)
    steep = real(slope) * real(near) > 3 * real(near) * real(near)
    bounded = where((real(near) * real(far) <= 0) & steep, 3 * near, slope)
    return where(real(slope) * real(near) > 0, bounded, 0.0)


def _lip_cubics(
    sealed_pressure: Array, outer_pressure: Array, excess: Array
) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
    """Values and slopes of the lip profile at its knots."""
    top = sealed_pressure + excess
    values = (sealed_pressure, top, outer_pressure + LIP_SHARE * top, outer_pressure)
    h = [right - left for left, right in pairwise(LIP_PLACES)]
    m = [(values[i + 1] - values[i]) / h[i] for i in range(3)]
    slopes = (
        _end_slope(m[0], m[1], h[0], h[1]),
        _inner_slope(m[0], m[1], h[0], h[1]),
        _inner_slope(m[1], m[2], h[1], h[2]),
        _end_slope(m[2], m[1], h[2], h[1]),
    )
    return values, slopes


def lip_profile(
    *, position: Array, sealed_pressure: Array, outer_pressure: Array, excess: Array
) -> Array:
    """Contact pressure of a lip: monotone cubics through four points, steep at the sealed side.

    (0, p_s), (0.2, p_s + p_k), (0.6, p_a + 0.42 (p_s + p_k)), (1, p_a), slopes of Fritsch and
    Carlson.

    Parameters
    ----------
    position : t = x/b, 0 to 1 [-]
    sealed_pressure, outer_pressure : p_s, p_a [Pa]
    excess : p_k, height of the peak above the sealed pressure [Pa]

    Returns
    -------
    contact pressure [Pa]

    Notes
    -----
    Valid: 0 <= t <= 1, p_k >= 0, 0.58 (p_s + p_k) > p_a.

    References
    ----------
    [FritschCarlson1980] monotone cubic interpolation; [derived] surrogate of published lip
    pressures

    Examples
    --------
    >>> p = lip_profile(position=0.4, sealed_pressure=5e6, outer_pressure=0.101e6, excess=1.5e6)
    >>> print(f"{p / 1e6:.4f} MPa")
    5.0568 MPa
    """
    values, slopes = _lip_cubics(sealed_pressure, outer_pressure, excess)
    pieces = []
    for i in range(3):
        h = LIP_PLACES[i + 1] - LIP_PLACES[i]
        s = (position - LIP_PLACES[i]) / h
        r = 1 - s
        pieces.append(
            r * r * ((1 + 2 * s) * values[i] + h * s * slopes[i])
            + s * s * ((3 - 2 * s) * values[i + 1] - h * r * slopes[i + 1])
        )
    late = where(real(position) < LIP_PLACES[2], pieces[1], pieces[2])
    return where(real(position) < LIP_PLACES[1], pieces[0], late)


def lip_mean(*, sealed_pressure: Array, outer_pressure: Array, excess: Array) -> Array:
    """Mean of the lip profile, sum over its cubics of h (y_0 + y_1)/2 + h^2 (y_0' - y_1')/12.

    Parameters
    ----------
    sealed_pressure, outer_pressure : p_s, p_a [Pa]
    excess : p_k [Pa]

    Returns
    -------
    mean contact pressure [Pa]

    Notes
    -----
    Valid: as `lip_profile`.

    References
    ----------
    [derived] integral of a cubic from its end values and slopes

    Examples
    --------
    >>> p = lip_mean(sealed_pressure=5e6, outer_pressure=0.101e6, excess=1.5e6)
    >>> print(f"{p / 1e6:.4f} MPa")
    3.7215 MPa
    """
    values, slopes = _lip_cubics(sealed_pressure, outer_pressure, excess)
    total = 0.0
    for i in range(3):
        h = LIP_PLACES[i + 1] - LIP_PLACES[i]
        total = total + h * (values[i] + values[i + 1]) / 2
        total = total + h * h * (slopes[i] - slopes[i + 1]) / 12
    return total


@geometry
def lip_excess(
    *, line_load: Array, width: Array, sealed_pressure: Array, outer_pressure: Array
) -> Array:
    """Excess p_k with which the lip profile carries a line load.

    With y = p_a + f/b it is the greater of [y - 0.57933 p_s - 0.61667 p_a]/0.52933 and
    [y - 0.58094 p_s - 0.61389 p_a]/0.50317, one for each form of the slope at the sealed end.

    Parameters
    ----------
    line_load : f, counted from the outer pressure [N/m]
    width : b [m]
    sealed_pressure, outer_pressure : p_s, p_a [Pa]

    Returns
    -------
    excess [Pa]

    Notes
    -----
    Valid: result >= 0, 0.58 (p_s + p_k) > p_a.

    References
    ----------
    [derived] inverse of `lip_mean`, which is the lesser of two linear functions of p_k

    Examples
    --------
    >>> p = lip_excess(line_load=14.482e3, width=4e-3, sealed_pressure=5e6, outer_pressure=0.101e6)
    >>> print(f"{p / 1e6:.4f} MPa")
    1.5000 MPa
    """
    mean = outer_pressure + line_load / positive(width)
    top = 0.468 + 0.85 / 75  # factor of p_s + p_k in the mean, but for the sealed end's slope
    outer = 0.6 + 1.25 / 75
    rest = mean - (0.1 + top) * sealed_pressure - outer * outer_pressure
    bounded = rest / (top + 1 / 20)
    free = (rest - (0.58 * sealed_pressure - outer_pressure) / 360) / (top + 1 / 45 + 0.58 / 360)
    return maximum(bounded, free)


def table_profile(
    *, position: Array, positions: Sequence[Array], pressures: Sequence[Array]
) -> Array:
    """Contact pressure from a table, linear between its points and constant outside them.

    Parameters
    ----------
    position : t = x/b, 0 to 1 [-]
    positions : t of the table's points, increasing from 0 to 1 [-]
    pressures : contact pressures at these points [Pa]

    Returns
    -------
    contact pressure [Pa]

    Notes
    -----
    Valid: positions increase strictly; the sealed pressure the table was made for.

    References
    ----------
    [derived] linear interpolation

    Examples
    --------
    >>> p = table_profile(position=0.35, positions=(0.0, 0.2, 0.5, 1.0),
    ...                   pressures=(5e6, 8e6, 6e6, 0.0))
    >>> print(f"{p / 1e6:.2f} MPa")
    7.00 MPa
    """
    value = pressures[0]
    for i in range(len(positions) - 1):
        share = clip((position - positions[i]) / (positions[i + 1] - positions[i]), 0.0, 1.0)
        value = value + (pressures[i + 1] - pressures[i]) * share
    return value


def table_mean(*, positions: Sequence[Array], pressures: Sequence[Array]) -> Array:
    """Mean of a table's profile, sum of (t_1 - t_0)(p_0 + p_1)/2: exact for straight lines.

    Parameters
    ----------
    positions : t of the table's points, increasing from 0 to 1 [-]
    pressures : contact pressures at these points [Pa]

    Returns
    -------
    mean contact pressure [Pa]

    Notes
    -----
    Valid: first point at 0, last at 1.

    References
    ----------
    [derived] integral of `table_profile` over t

    Examples
    --------
    >>> p = table_mean(positions=(0.0, 0.2, 0.5, 1.0), pressures=(5e6, 8e6, 6e6, 0.0))
    >>> print(f"{p / 1e6:.2f} MPa")
    4.90 MPa
    """
    total = 0.0
    for i in range(len(positions) - 1):
        step = positions[i + 1] - positions[i]
        total = total + step * (pressures[i] + pressures[i + 1]) / 2
    return total


LAND_POWER = 8
"""Even exponent of the excess term, 1 - u^8 (*choice*: level within 5 % over the middle 69 %)."""


def land_profile(
    *, position: Array, sealed_pressure: Array, outer_pressure: Array, excess: Array
) -> Array:
    """Contact pressure of a worn-in land: linear fall of the oil pressure plus a flat excess.

    p = p_a + (p_s - p_a)(1 - t) + p_e (1 - u^8), u = 2 t - 1.

    Parameters
    ----------
    position : t = x/b, 0 to 1 [-]
    sealed_pressure, outer_pressure : p_s, p_a [Pa]
    excess : p_e [Pa]

    Returns
    -------
    contact pressure [Pa]

    Notes
    -----
    Valid: 0 <= t <= 1; run-in faces (new sharp edges carry more).

    References
    ----------
    [Archard1953] wear grows with pressure, so running evens the pressure out; [derived] edges that
    fall over the outer sixths

    Examples
    --------
    >>> p = land_profile(position=0.5, sealed_pressure=5e6, outer_pressure=0.0, excess=4e6)
    >>> print(f"{p / 1e6:.2f} MPa")
    6.50 MPa
    """
    fall = (sealed_pressure - outer_pressure) * (1 - position)
    return outer_pressure + fall + excess * (1 - (2 * position - 1) ** LAND_POWER)


@geometry
def land_excess(
    *, line_load: Array, width: Array, sealed_pressure: Array, outer_pressure: Array
) -> Array:
    """Excess with which the land profile carries a line load, (9/8)[f/b - (p_s - p_a)/2].

    Parameters
    ----------
    line_load : f, counted from the outer pressure [N/m]
    width : b [m]
    sealed_pressure, outer_pressure : p_s, p_a [Pa]

    Returns
    -------
    excess [Pa]

    Notes
    -----
    Valid: result >= 0; NaN without width.

    References
    ----------
    [derived] mean of `land_profile` over t, solved for the excess

    Examples
    --------
    >>> p = land_excess(line_load=13e3, width=2e-3, sealed_pressure=5e6, outer_pressure=0.0)
    >>> print(f"{p / 1e6:.2f} MPa")
    4.50 MPa
    """
    mean = line_load / positive(width) - (sealed_pressure - outer_pressure) / 2
    return mean * (LAND_POWER + 1) / LAND_POWER


@geometry
def land_peak(
    *, line_load: Array, width: Array, sealed_pressure: Array, outer_pressure: Array
) -> Array:
    """Highest pressure of the land profile that carries a line load.

    The peak is at u = -min[((p_s - p_a)/(16 p_e))^(1/7), 1]; without excess it is the sealed
    pressure.

    Parameters
    ----------
    line_load : f, counted from the outer pressure [N/m]
    width : b [m]
    sealed_pressure, outer_pressure : p_s, p_a [Pa]; p_s >= p_a

    Returns
    -------
    peak pressure, gauge or absolute like `sealed_pressure` and `outer_pressure` [Pa]; without
    width (no contact) it is the outer pressure

    Notes
    -----
    Valid: as `land_profile`.

    References
    ----------
    [derived] maximum of `land_profile`

    Examples
    --------
    >>> p = land_peak(line_load=13e3, width=2e-3, sealed_pressure=5e6, outer_pressure=0.0)
    >>> print(f"{p / 1e6:.3f} MPa")
    8.494 MPa
    """
    touching = real(width) > 0
    excess = land_excess(
        line_load=line_load,
        width=where(touching, width, 1.0),
        sealed_pressure=sealed_pressure,
        outer_pressure=outer_pressure,
    )
    fall = real(sealed_pressure) - real(outer_pressure)
    steep = fall >= 2 * LAND_POWER * real(excess)
    ratio = where(steep, 1.0, fall / where(steep, 1.0, 2 * LAND_POWER * real(excess)))
    place = where(steep, 0.0, (1 - ratio ** (1 / (LAND_POWER - 1))) / 2)
    peak = land_profile(
        position=place,
        sealed_pressure=sealed_pressure,
        outer_pressure=outer_pressure,
        excess=excess,
    )
    return where(touching, peak, outer_pressure)
