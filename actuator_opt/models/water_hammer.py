"""Waves in elastic lines: their speed, the surge of a closing valve, standing waves."""

from __future__ import annotations

from ..geometry import geometry
from ..numeric import Array, maximum, sqrt


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


@geometry
def closure_factor(*, length: Array, sound_speed: Array, closure_time: Array) -> Array:
    """Share of the sudden-stop pressure that a slow closure makes, min(1, 2 l/(a T)).

    Parameters
    ----------
    length : to the nearest reflecting volume [m]
    sound_speed : wave speed in the line [m/s]
    closure_time : T, of a speed that falls linearly [s]

    Returns
    -------
    factor on `joukowsky_pressure` [-]

    Notes
    -----
    Valid: open far end at constant pressure, low friction.

    References
    ----------
    [WylieStreeter1993] slow closure; [derived] waves of a linear stop superposed over 2 l/a

    Examples
    --------
    >>> f = closure_factor(length=1.2, sound_speed=1200.0, closure_time=0.01)
    >>> print(f"{f:.2f}")
    0.20
    """
    reflection = 2 * length / sound_speed
    return reflection / maximum(closure_time, reflection)


@geometry
def standing_wave_frequency(
    *, length: Array, sound_speed: Array, ends: tuple[str, str], mode: Array = 1.0
) -> Array:
    """Resonance of a line between two ends: n a/(2 l) of equal, (2 n - 1) a/(4 l) of unlike ones.

    Parameters
    ----------
    length : [m]
    sound_speed : wave speed in the line [m/s]
    ends : each `closed` (no flow) or `open` (constant pressure)
    mode : n = 1, 2, ... [-]

    Returns
    -------
    frequency [Hz]

    Raises
    ------
    ValueError
        An end that is neither closed nor open.

    Notes
    -----
    Valid: uniform line, low friction; ends far stiffer or softer than the line.

    References
    ----------
    [AaltoThesis] eq. 17, 18; [derived] standing waves

    Examples
    --------
    >>> line = dict(length=16.25, sound_speed=1300.0)
    >>> standing_wave_frequency(**line, ends=("open", "closed"))
    20.0
    >>> standing_wave_frequency(**line, ends=("closed", "closed"))
    40.0
    """
    if not set(ends) <= {"closed", "open"}:
        raise ValueError(f"ends: {ends[0]}, {ends[1]}; each is closed or open")
    quarters = 2 * mode if ends[0] == ends[1] else 2 * mode - 1
    return 0.25 * quarters * sound_speed / length
