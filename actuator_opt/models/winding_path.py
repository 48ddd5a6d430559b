"""Paths of fibres wound on a tube: the length that a helical winding needs to turn at an end."""

from __future__ import annotations

from ..base.numeric import Array, absolute, geometry, namespace

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
