"""Paths of fibres wound on tubes and cones: length of a turn at an end, angle and thickness."""

from __future__ import annotations

from ..base.numeric import Array, absolute, angle as angle_of, geometry, namespace, positive, sqrt

SLIPPAGE = 0.2
"""Ratio of lateral to normal force that friction allows a wet tow: 0.15 to 0.2 wet, up to 0.3 for
tow-preg. Scatter is large; the values are recalled from [Koussios2004], not measured here."""


@geometry
def turn_length(*, radius: Array, angle: Array, slippage: Array = SLIPPAGE) -> Array:
    """Axial length that a helical winding needs at each end to turn, R (1/sin a - 1)/lambda.

    On a plain tube, no geodesic path turns back. With lateral friction lambda, the angle rises by
    da/dz = lambda sin(a) tan(a)/R, up to 90 degrees at the turn.

    Parameters
    ----------
    radius : R, of the winding [m]
    angle : winding angle a from the tube axis [rad]
    slippage : ratio of lateral to normal force, lambda [-]

    Returns
    -------
    length [m]

    Notes
    -----
    Valid: winding without pins or domes; 0 < |a| <= 90 degrees.

    References
    ----------
    [Koussios2004] non-geodesic winding; [derived] integral of the slope over the angle

    Examples
    --------
    >>> print(f"{turn_length(radius=14e-3, angle=0.4363323129985824) * 1e3:.4f}")
    95.6341
    """
    return radius * (1 / absolute(namespace(angle).sin(angle)) - 1) / slippage


@geometry
def geodesic_angle(*, angle: Array, start_radius: Array, radius: Array) -> Array:
    """Angle of a geodesic fibre to the meridian at another radius, r sin(a) = constant.

    Parameters
    ----------
    angle : a at the first radius [rad]
    start_radius, radius : first radius R and other radius r of the wound surface [m]

    Returns
    -------
    angle [rad]

    Notes
    -----
    Valid: r above R sin(a), where the fibre turns back; NaN below.

    References
    ----------
    [Koussios2004] theorem of Clairaut

    Examples
    --------
    >>> from math import degrees, radians
    >>> a = geodesic_angle(angle=radians(25), start_radius=14e-3, radius=16.5e-3)
    >>> print(f"{degrees(a):.4f}")
    21.0133
    """
    sine = start_radius * absolute(namespace(angle).sin(angle)) / radius
    return angle_of(sine, sqrt(1 - sine * sine))


@geometry
def geodesic_thickness_ratio(*, angle: Array, start_radius: Array, radius: Array) -> Array:
    """Thickness of a helical layer at another radius divided by that at its start.

    t/t_R = R cos(a_R)/(r cos(a)), with r sin(a) = R sin(a_R): the fibre volume is constant.

    Parameters
    ----------
    angle : a_R at the first radius [rad]
    start_radius, radius : first radius R and other radius r of the wound surface [m]

    Returns
    -------
    ratio [-]

    Notes
    -----
    Valid: r clearly above R sin(a_R), where fibres pile up as they turn back.

    References
    ----------
    [Koussios2004] theorem of Clairaut; [derived] constant number of tows

    Examples
    --------
    >>> ratio = geodesic_thickness_ratio(angle=0.4363323129985824, start_radius=14e-3,
    ...                                  radius=16.5e-3)
    >>> print(f"{ratio:.6f}")
    0.823772
    """
    xp = namespace(angle)
    sine, cosine = xp.sin(angle), xp.cos(angle)
    remaining = radius * radius - start_radius * start_radius * sine * sine
    return start_radius * cosine / sqrt(positive(remaining))
