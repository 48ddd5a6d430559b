"""An eye that holds a spherical plain bearing, in proportions of the plain eye of `mass`.

A plain eye for a pin d has a lug of radius and thickness d, and a neck of diameter and length d.
"""

from __future__ import annotations

from math import pi

from ..base.numeric import Array, geometry


@geometry
def lug_radius(*, pin_diameter: Array, outer_diameter: Array, width: Array) -> Array:
    """Outer radius of a lug around a bearing, D/2 + d^2/(2 B).

    The metal beside the bearing has the section d^2 of the plain eye: 2 (R - D/2) B = d^2. The lug
    is as thick as the inner ring of the bearing, B.

    Parameters
    ----------
    pin_diameter : bore d of the bearing [m]
    outer_diameter : D of the bearing [m]
    width : B of its inner ring [m]

    Returns
    -------
    R [m]

    Notes
    -----
    Valid: lugs whose net section governs; our choice.

    References
    ----------
    [derived] equal net section

    Examples
    --------
    >>> print(f"{lug_radius(pin_diameter=8e-3, outer_diameter=16e-3, width=8e-3) * 1e3:.1f} mm")
    12.0 mm
    """
    return outer_diameter / 2 + pin_diameter * pin_diameter / (2 * width)


@geometry
def bearing_eye_volume(*, pin_diameter: Array, outer_diameter: Array, width: Array) -> Array:
    """Volume of an eye without its bearing, pi B (R^2 - D^2/4) + pi d^3/4.

    The first part is the lug with the hole for the bearing, the second the neck of diameter and
    length d from the lug's rim. As in `mass.eye_volume`, the crescent between both is neglected.

    Parameters
    ----------
    pin_diameter : bore d of the bearing [m]
    outer_diameter : D of the bearing [m]
    width : B of its inner ring [m]

    Returns
    -------
    volume [m^3]

    Notes
    -----
    Valid: the proportions of `lug_radius`.

    References
    ----------
    [derived] disc minus hole plus cylinder

    Examples
    --------
    >>> v = bearing_eye_volume(pin_diameter=8e-3, outer_diameter=16e-3, width=8e-3)
    >>> print(f"{v * 1e9:.1f} mm3")
    2412.7 mm3
    """
    radius = lug_radius(pin_diameter=pin_diameter, outer_diameter=outer_diameter, width=width)
    lug = pi * width * (radius * radius - outer_diameter * outer_diameter / 4)
    return lug + pi / 4 * pin_diameter * pin_diameter * pin_diameter
