"""Lumped hydraulic elements of a line: resistance, inertance, capacitance and resonances.

Lines and plugged side branches as functions of frequency are in `transmission_line`.
"""

from __future__ import annotations

import math

from ..base.numeric import Array, geometry, sqrt


@geometry
def resistance(*, inner_diameter: Array, length: Array, dynamic_viscosity: Array) -> Array:
    """Laminar resistance of a line, R = 128 eta l/(pi d^4).

    Parameters
    ----------
    inner_diameter, length : [m]
    dynamic_viscosity : [Pa s]

    Returns
    -------
    resistance [Pa s/m^3]

    Notes
    -----
    Valid: Re below 2300.

    References
    ----------
    [AaltoThesis] section 2.1.3

    Examples
    --------
    >>> print(f"{resistance(inner_diameter=8e-3, length=1.2, dynamic_viscosity=0.04):.5e}")
    4.77465e+08
    """
    square = inner_diameter * inner_diameter
    return (128 / math.pi) * dynamic_viscosity * length / (square * square)


@geometry
def inertance(*, inner_diameter: Array, length: Array, density: Array) -> Array:
    """Inertance of a line, L = rho l/A.

    Parameters
    ----------
    inner_diameter, length : [m]
    density : [kg/m^3]

    Returns
    -------
    inertance [kg/m^4]

    Notes
    -----
    Valid: uniform velocity over the section.

    References
    ----------
    [AaltoThesis] section 2.1.3

    Examples
    --------
    >>> print(f"{inertance(inner_diameter=8e-3, length=1.2, density=865.0):.5e}")
    2.06504e+07
    """
    return (4 / math.pi) * density * length / (inner_diameter * inner_diameter)


@geometry
def capacitance(*, volume: Array, bulk_modulus: Array) -> Array:
    """Capacitance of an oil volume, C = V/K.

    Parameters
    ----------
    volume : [m^3]
    bulk_modulus : effective tangent value [Pa]

    Returns
    -------
    capacitance [m^3/Pa]

    Notes
    -----
    Valid: rigid walls (add their compliance).

    References
    ----------
    [AaltoThesis] section 2.1.3

    Examples
    --------
    >>> print(f"{capacitance(volume=6.031858e-5, bulk_modulus=1.4e9):.5e}")
    4.30847e-14
    """
    return volume / bulk_modulus


def sound_speed(*, bulk_modulus: Array, density: Array) -> Array:
    """Speed of sound in the oil, a = sqrt(K/rho).

    Parameters
    ----------
    bulk_modulus : effective tangent value [Pa]
    density : [kg/m^3]

    Returns
    -------
    speed of sound [m/s]

    Notes
    -----
    Valid: rigid walls; about 1300 m/s in practice.

    References
    ----------
    [AaltoThesis] section 2.1.3

    Examples
    --------
    >>> print(f"{sound_speed(bulk_modulus=1.4e9, density=865.0):.2f}")
    1272.20
    """
    return sqrt(bulk_modulus / density)


@geometry
def quarter_wave_frequency(*, length: Array, sound_speed: Array) -> Array:
    """First quarter-wave frequency of a plugged branch, f = a/(4 l).

    At odd multiples of f, pressure oscillates at the plugged end, and oil flows in and out of the
    mouth without any pressure swing there. At even multiples, no oil flows through the mouth.

    Parameters
    ----------
    length : [m]
    sound_speed : [m/s]

    Returns
    -------
    frequency [Hz]

    Notes
    -----
    Valid: one end closed, one open.

    References
    ----------
    [AaltoThesis] section 2.1.3

    Examples
    --------
    >>> print(f"{quarter_wave_frequency(length=1.2, sound_speed=1272.2):.2f}")
    265.04
    """
    return 0.25 * sound_speed / length


def resonance_frequency(*, inertance: Array, capacitance: Array) -> Array:
    """Resonance of a lumped inertance with a capacitance, f = 1/(2 pi sqrt(L C)).

    In a Helmholtz resonator, the neck is the inertance and the volume the capacitance.

    Parameters
    ----------
    inertance : [kg/m^4]
    capacitance : [m^3/Pa]

    Returns
    -------
    frequency [Hz]

    Notes
    -----
    Valid: wavelength much longer than the line.

    References
    ----------
    [AaltoThesis] section 2.1.3

    Examples
    --------
    >>> print(f"{resonance_frequency(inertance=2.06504e7, capacitance=4.30847e-14):.3f}")
    168.731
    """
    return (0.5 / math.pi) / sqrt(inertance * capacitance)
