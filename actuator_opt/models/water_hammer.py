"""Waves in elastic lines: their speed, and the surge of a sudden stop."""

from __future__ import annotations

from ..base.numeric import Array, geometry, sqrt


@geometry
def wave_speed(
    *, bulk_modulus: Array, density: Array, volume: Array, wall_compliance: Array = 0.0
) -> Array:
    """Wave speed in an elastic line, a^2 = (K/rho)/(1 + K (dV/dp)/V).

    Volume and compliance of the wall belong to the same piece of line, whatever its length:
    `lines.line_volume` and `lines.line_compliance`, or a measured swelling of a hose.

    Parameters
    ----------
    bulk_modulus : effective tangent value of the oil [Pa]
    density : [kg/m^3]
    volume : of the line [m^3]
    wall_compliance : dV/dp of its wall [m^3/Pa]; 0 rigid

    Returns
    -------
    wave speed [m/s]

    Notes
    -----
    Valid: wavelength much longer than the diameter.

    References
    ----------
    [AaltoThesis] eq. 20; [WylieStreeter1993] elastic wall

    Examples
    --------
    >>> print(f"{wave_speed(bulk_modulus=1.4e9, density=865.0, volume=6e-5):.2f}")
    1272.20
    >>> a = wave_speed(bulk_modulus=1.4e9, density=865.0, volume=42.53e-6,
    ...                wall_compliance=22.3e-15)
    >>> print(f"{a:.0f}")
    966
    """
    return sqrt(bulk_modulus / (density * (1 + bulk_modulus * wall_compliance / volume)))


def joukowsky_pressure(*, density: Array, sound_speed: Array, velocity_change: Array) -> Array:
    """Pressure rise of a sudden stop, dp = rho a dv.

    Parameters
    ----------
    density : [kg/m^3]
    sound_speed : wave speed in the line [m/s]
    velocity_change : mean speed that is stopped [m/s]

    Returns
    -------
    pressure rise [Pa]

    Notes
    -----
    Valid: closure within 2 l/a; dv much smaller than a; no cavitation.

    References
    ----------
    [WylieStreeter1993] Joukowsky's equation

    Examples
    --------
    >>> dp = joukowsky_pressure(density=865.0, sound_speed=1272.2, velocity_change=4.0)
    >>> print(f"{dp / 1e5:.1f} bar")
    44.0 bar
    """
    return density * sound_speed * velocity_change
