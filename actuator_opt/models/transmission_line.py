"""Frequency response of round hydraulic lines, plugged side branches, waves after a sudden stop.

The distributed model gives the impedance p/q at one end of a line. Results are complex; arguments
are real and the convention is e^(+i omega t), so that a result at -f is the conjugate of that at f.
Pressure and flow at the near end follow from those at the far end by a matrix, p1 = A p2 + B q2,
q1 = C p2 + D q2, flow positive from near to far [Merritt1967]. The friction
models `lossless`, `steady` and `distributed` are explained in `lines`.

A plugged side branch (T-pipe) whose length is an odd number of quarter waves takes in flow without
any pressure oscillation at the junction; the pressure oscillates most at the plugged end. With an
even number of quarter waves it takes no flow.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from ..base.numeric import Array, geometry, namespace, sqrt, where
from .lines import series_impedance


class LineMatrix(NamedTuple):
    """Matrix that gives the pressure and flow at a line's near end from those at its far end."""

    A: Array
    B: Array
    C: Array
    D: Array


@geometry
def line_matrix(
    *,
    frequency: Array,
    length: Array,
    inner_diameter: Array,
    density: Array,
    sound_speed: Array,
    dynamic_viscosity: Array,
    friction: str = "distributed",
) -> LineMatrix:
    """Matrix of a distributed line: A = D = cosh Gamma, B = Z_c sinh Gamma, C = sinh Gamma/Z_c.

    Gamma is the complex propagation constant times the length, and Z_c is the characteristic
    impedance.

    Parameters
    ----------
    frequency : [Hz]; 0 gives the steady flow
    length, inner_diameter : [m]
    density : [kg/m^3]
    sound_speed : wave speed a in the elastic line [m/s]
    dynamic_viscosity : [Pa s]
    friction : `lossless`, `steady` or `distributed` [-]

    Returns
    -------
    complex A, D [-], B [Pa s/m^3], C [m^3/s/Pa]; A D - B C = 1

    Notes
    -----
    Valid: as `lines.series_impedance`; real part of Gamma below 700.

    References
    ----------
    [DSouza1964] distributed line; [derived] waves of p' = -Z' q, q' = -Y' p

    Examples
    --------
    >>> quarter = line_matrix(frequency=20.0, length=16.25, inner_diameter=8e-3, density=865.0,
    ...     sound_speed=1300.0, dynamic_viscosity=0.0, friction="lossless")
    >>> print(f"{abs(quarter.A):.3f} {quarter.B.imag:.4e}")
    0.000 2.2371e+10
    """
    xp = namespace(frequency, length, inner_diameter, density, sound_speed, dynamic_viscosity)
    along = length * series_impedance(
        frequency=frequency,
        inner_diameter=inner_diameter,
        density=density,
        dynamic_viscosity=dynamic_viscosity,
        friction=friction,
    )
    across = length * _shunt_admittance(xp, frequency, inner_diameter, density, sound_speed)
    square = along * across
    gamma = xp.sqrt(square)
    small = xp.abs(square) < 1e-8
    quotient = xp.sinh(gamma) / where(small, 1.0, gamma)
    quotient = where(small, 1 + square / 6, quotient)  # sinh Gamma/Gamma
    diagonal = xp.cosh(gamma)
    return LineMatrix(diagonal, along * quotient, across * quotient, diagonal)


def input_impedance(*, matrix: LineMatrix, end_impedance: Array) -> Array:
    """Impedance p/q at the near end of a line, (A Z + B)/(C Z + D).

    Parameters
    ----------
    matrix : matrix of the line, with A, D [-], B [Pa s/m^3], C [m^3/s/Pa]
    end_impedance : Z at the far end [Pa s/m^3]: 0 if at constant pressure, infinite if closed

    Returns
    -------
    complex impedance [Pa s/m^3]; infinite, or very large, at a resonance without loss

    Notes
    -----
    Valid: everywhere.

    References
    ----------
    [derived] p2 = Z q2 in the line's matrix

    Examples
    --------
    >>> throttle = LineMatrix(1.0, 2e9, 0.0, 1.0)
    >>> input_impedance(matrix=throttle, end_impedance=3e9)
    5000000000.0
    """
    finite, end = _finite(end_impedance)
    numerator = where(finite, matrix.A * end + matrix.B, matrix.A)
    return _ratio(numerator, where(finite, matrix.C * end + matrix.D, matrix.C))


def input_admittance(*, matrix: LineMatrix, end_admittance: Array) -> Array:
    """Admittance q/p at the near end of a line, (C + D Y)/(A + B Y).

    Parameters
    ----------
    matrix : matrix of the line, with A, D [-], B [Pa s/m^3], C [m^3/s/Pa]
    end_admittance : Y at the far end [m^3/s/Pa]: 0 if closed, infinite if at constant pressure

    Returns
    -------
    complex admittance [m^3/s/Pa]; infinite, or very large, at a resonance without loss

    Notes
    -----
    Valid: everywhere.

    References
    ----------
    [derived] q2 = Y p2 in the line's matrix

    Examples
    --------
    >>> throttle = LineMatrix(1.0, 2e9, 0.0, 1.0)
    >>> print(f"{input_admittance(matrix=throttle, end_admittance=float('inf')):.1e}")
    5.0e-10
    """
    finite, end = _finite(end_admittance)
    numerator = where(finite, matrix.C + matrix.D * end, matrix.D)
    return _ratio(numerator, where(finite, matrix.A + matrix.B * end, matrix.B))


def _shunt_admittance(
    xp: Any, frequency: Array, inner_diameter: Array, density: Array, sound_speed: Array
) -> Array:
    """Shunt admittance of a line per unit length, i omega A/(rho a^2)."""
    area = (0.25 * math.pi) * inner_diameter * inner_diameter
    rate = 2j * math.pi * xp.asarray(frequency, dtype=xp.complex128)
    return rate * (area / (density * sound_speed * sound_speed))


def _finite(value: Array) -> tuple[Array, Array]:
    """Mask of the finite values, and the values with zeros in place of those not finite."""
    xp = namespace(value)
    finite = xp.isfinite(value)
    return finite, where(finite, value, 0.0)


def _ratio(numerator: Array, denominator: Array) -> Array:
    """Quotient that is infinite, not an error, where the denominator vanishes."""
    vanishes = denominator == 0
    return where(vanishes, math.inf, numerator / where(vanishes, 1.0, denominator))


@geometry
def wave_speed(
    *, bulk_modulus: Array, density: Array, volume: Array, wall_compliance: Array = 0.0
) -> Array:
    """Wave speed a in an elastic line, a^2 = (K/rho)/(1 + K (dV/dp)/V).

    The volume V and the wall's compliance dV/dp must be of the same piece of line; its length does
    not matter. They come from `lines.line_volume` and `lines.line_compliance`, or from a measured
    swelling of a hose.

    Parameters
    ----------
    bulk_modulus : effective tangent value of the oil [Pa]
    density : [kg/m^3]
    volume : of the line [m^3]
    wall_compliance : dV/dp of its wall [m^3/Pa]; 0 for a rigid wall

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


def quarter_wave_length(
    *, frequency: Array, sound_speed: Array, quarter_waves: Array = 1.0
) -> Array:
    """Length of a plugged branch of n quarter waves, l = n a/(4 f).

    Parameters
    ----------
    frequency : [Hz]
    sound_speed : wave speed in the branch [m/s]
    quarter_waves : n [-]; at n = 1, 3, ... the branch is resonant, at n = 2, 4, ... it has no
        effect on the junction

    Returns
    -------
    length [m]

    Notes
    -----
    Valid: low friction.

    References
    ----------
    [AaltoThesis] eq. 17, 18

    Examples
    --------
    >>> quarter_wave_length(frequency=20.0, sound_speed=1300.0)
    16.25
    """
    return 0.25 * quarter_waves * sound_speed / frequency


@geometry
def plugged_branch_impedance(
    *,
    frequency: Array,
    length: Array,
    inner_diameter: Array,
    density: Array,
    sound_speed: Array,
    dynamic_viscosity: Array,
    friction: str = "distributed",
) -> Array:
    """Impedance at the mouth of a plugged T-pipe, Z_c coth Gamma.

    It is small at odd numbers of quarter waves and large at even numbers. Without friction it is
    -i Z_c cot(omega l/a). `line_matrix` defines Gamma and Z_c.

    Parameters
    ----------
    frequency : [Hz], not 0
    length, inner_diameter : [m]
    density : [kg/m^3]
    sound_speed : wave speed in the branch [m/s]
    dynamic_viscosity : [Pa s]
    friction : `lossless`, `steady` or `distributed` [-]

    Returns
    -------
    complex impedance [Pa s/m^3]; infinite at zero frequency

    Notes
    -----
    Valid: as `lines.series_impedance`.

    References
    ----------
    [AaltoThesis] section 2.1.3; [derived] `transmission_line.input_impedance` of a closed end

    Examples
    --------
    >>> pipe = dict(length=16.25, inner_diameter=8e-3, density=865.0, sound_speed=1300.0,
    ...             dynamic_viscosity=0.0, friction="lossless")
    >>> print(f"{abs(plugged_branch_impedance(frequency=10.0, **pipe)):.4e}")
    2.2371e+10
    """
    matrix = line_matrix(
        frequency=frequency,
        length=length,
        inner_diameter=inner_diameter,
        density=density,
        sound_speed=sound_speed,
        dynamic_viscosity=dynamic_viscosity,
        friction=friction,
    )
    return input_impedance(matrix=matrix, end_impedance=math.inf)
