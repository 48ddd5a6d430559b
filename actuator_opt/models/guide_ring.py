"""Guide rings: contact pressure, radial stiffness and friction under a side load.

The ring, of thickness t and width w, lines the gap between the bore (or rod) of diameter d and its
housing; the side load presses half of it by the cosine of the angle.
"""

from __future__ import annotations

import math

from ..numeric import Array, absolute


def projected_pressure(*, side_load: Array, diameter: Array, width: Array) -> Array:
    """Mean pressure of a guide ring on its projected area, p = |N|/(d w).

    Parameters
    ----------
    side_load : N on this ring [N]
    diameter : of the sliding surface [m]
    width : of the ring [m]

    Returns
    -------
    pressure [Pa]; makers' limits are stated as this mean

    Notes
    -----
    Valid: everywhere; the peak is 4/pi of it (`peak_pressure`).

    References
    ----------
    [derived] definition of the bearing pressure

    Examples
    --------
    >>> print(f"{projected_pressure(side_load=2e3, diameter=40e-3, width=10e-3) / 1e6:.1f} MPa")
    5.0 MPa
    """
    return absolute(side_load) / (diameter * width)


def peak_pressure(*, side_load: Array, diameter: Array, width: Array) -> Array:
    """Highest pressure of a fitting guide ring, p_0 = 4 |N|/(pi d w).

    Parameters
    ----------
    side_load : N on this ring [N]
    diameter : of the sliding surface [m]
    width : of the ring [m]

    Returns
    -------
    peak pressure [Pa]

    Notes
    -----
    Valid: ring fits its surface (clearance small against its compression), no edge load.

    References
    ----------
    [derived] p_0 cos(theta) over the loaded half: N = pi p_0 d w/4

    Examples
    --------
    >>> print(f"{peak_pressure(side_load=2e3, diameter=40e-3, width=10e-3) / 1e6:.3f} MPa")
    6.366 MPa
    """
    return (4 / math.pi) * projected_pressure(side_load=side_load, diameter=diameter, width=width)


def radial_stiffness(
    *, youngs_modulus: Array, diameter: Array, width: Array, thickness: Array
) -> Array:
    """Side stiffness of a guide ring, k = pi E d w/(4 t).

    Parameters
    ----------
    youngs_modulus : through the ring's thickness [Pa]
    diameter : of the sliding surface [m]
    width, thickness : axial w, radial t [m]

    Returns
    -------
    stiffness [N/m]

    Notes
    -----
    Valid: clearance taken up; housing rigid; ring free to spread (a lower bound).

    References
    ----------
    [derived] compression delta cos(theta) of a layer of modulus E over the loaded half

    Examples
    --------
    >>> k = radial_stiffness(youngs_modulus=2.5e9, diameter=40e-3, width=10e-3, thickness=2.5e-3)
    >>> print(f"{k / 1e6:.1f} N/um")
    314.2 N/um
    """
    return (math.pi / 4) * youngs_modulus * diameter * width / thickness


def friction(
    *, side_load: Array, friction_coefficient: Array, wrap_factor: Array = 4 / math.pi
) -> Array:
    """Friction of a guide ring under a side load, F = c mu |N|.

    Parameters
    ----------
    side_load : N on this ring [N]
    friction_coefficient : mu of ring on surface [-]
    wrap_factor : c [-], sum of the normal pressure over its resultant: 4/pi for a ring that fits
        (cosine pressure), 1 for a loose ring that touches along a line

    Returns
    -------
    friction [N]

    Notes
    -----
    Valid: dry or boundary lubrication.

    References
    ----------
    [derived] Coulomb friction of the pressure p_0 cos(theta), int p dA = 4 N/pi

    Examples
    --------
    >>> print(f"{friction(side_load=-2e3, friction_coefficient=0.1):.2f} N")
    254.65 N
    """
    return wrap_factor * friction_coefficient * absolute(side_load)
