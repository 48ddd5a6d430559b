"""Ends of a hydraulic line: closed, conductance, accumulator, reducing valve, or several of them.

Each line end is an admittance, a ratio of two polynomials in s, so it can be used directly in the
linear model.
"""

from __future__ import annotations

import math
from math import pi

from ..base.dataclass import dataclass
from ..base.numeric import Array, namespace, real, sqrt, where
from ..base.polynomial import Polynomial, add, at_frequency, multiply, scale


@dataclass(frozen=True, slots=True)
class LineEnd:
    """End of a line: an admittance Y(s) = numerator/denominator (flow out per pressure)."""

    numerator: Polynomial = ()
    denominator: Polynomial = (1.0,)


CLOSED = LineEnd()
"""Nothing flows out of the line."""
CONSTANT_PRESSURE = LineEnd((1.0,), ())
"""The pressure stays constant at any flow."""


def parallel_ends(*ends: LineEnd) -> LineEnd:
    """Combine several line ends on one node: their admittances add.

    Parameters
    ----------
    ends : line ends of `accumulator_end`, `reducing_valve_end` or a valve's conductance

    Returns
    -------
    the combined line end, Y in [m^3/s/Pa]

    Notes
    -----
    Valid: everywhere.

    References
    ----------
    [derived] Y = sum n_i/d_i

    Examples
    --------
    >>> parallel_ends(LineEnd((1e-12,)), LineEnd((2e-12,))).numerator
    (3e-12,)
    """
    numerator, denominator = ends[0].numerator, ends[0].denominator
    for end in ends[1:]:
        numerator = add(multiply(numerator, end.denominator), multiply(end.numerator, denominator))
        denominator = multiply(denominator, end.denominator)
    return LineEnd(numerator, denominator)


def accumulator_end(*, capacitance: Array, inertance: Array, resistance: Array) -> LineEnd:
    """Gas-charged accumulator behind its neck, Y = C s/(1 + R C s + L C s^2).

    Parameters
    ----------
    capacitance : of the gas at the working pressure [m^3/Pa]
    inertance : of the neck [kg/m^4]
    resistance : of the neck [Pa s/m^3]

    Returns
    -------
    line end, Y in [m^3/s/Pa]

    Notes
    -----
    Valid: pressure swings small against the gas pressure.

    References
    ----------
    [derived] series of neck and gas; [AaltoThesis] eq. 11-16

    Examples
    --------
    >>> accumulator_end(capacitance=2.0, inertance=3.0, resistance=5.0)
    LineEnd(numerator=(0.0, 2.0), denominator=(1.0, 10.0, 6.0))
    """
    return LineEnd((0.0, capacitance), (1.0, resistance * capacitance, inertance * capacitance))


def reducing_valve_end(
    *,
    conductance: Array,
    natural_frequency: Array,
    damping_ratio: Array,
    passive_conductance: Array = 0.0,
) -> LineEnd:
    """Pressure reducing valve, Y = g + G omega^2/(s^2 + 2 zeta omega s + omega^2).

    omega and zeta are the natural frequency [rad/s] and the damping ratio of the spool. At low
    frequency, the valve holds its pressure with the conductance G + g. It lags at every
    frequency, like an inertance. Well above its natural frequency only g remains, the conductance
    of its opening.

    Parameters
    ----------
    conductance : G, flow per pressure by which the spool regulates [m^3/s/Pa]
    natural_frequency : [Hz]
    damping_ratio : [-]
    passive_conductance : g [m^3/s/Pa]

    Returns
    -------
    line end, Y in [m^3/s/Pa]

    Notes
    -----
    Valid: small signals about the set pressure.

    References
    ----------
    [AaltoThesis] section 5.2, where this valve is the suspected cause of a 20 Hz peak; [derived]
    second-order spool

    Examples
    --------
    >>> end = reducing_valve_end(conductance=1e-10, natural_frequency=20.0, damping_ratio=0.3)
    >>> end.numerator
    (1e-10,)
    """
    omega = 2 * pi * natural_frequency
    denominator = (1.0, 2 * damping_ratio / omega, 1 / (omega * omega))
    return LineEnd(add(scale(denominator, passive_conductance), (conductance,)), denominator)


def end_admittance(*, end: LineEnd, frequency: Array) -> Array:
    """Admittance of a line end at a frequency, Y(i omega) = n(i omega)/d(i omega).

    Parameters
    ----------
    end : numerator and denominator
    frequency : [Hz]

    Returns
    -------
    complex admittance, flow out of the line per pressure [m^3/s/Pa]; infinite where the pressure
    is held

    Notes
    -----
    Valid: real coefficients (no complex step).

    References
    ----------
    [derived] ratio of the polynomials

    Examples
    --------
    >>> y = end_admittance(end=reducing_valve_end(conductance=1e-10, natural_frequency=10.0,
    ...                                           damping_ratio=0.5), frequency=10.0)
    >>> print(f"{y.imag:.1e}")
    -1.0e-10
    """
    xp = namespace(frequency)
    omega = xp.asarray(2 * pi * frequency, dtype=xp.complex128)
    above = at_frequency(end.numerator, omega).complex
    below = at_frequency(end.denominator, omega).complex + 0 * omega
    held = below == 0
    return where(held, math.inf, above / where(held, 1.0, below))


def antiresonance_frequency(
    *, conductance: Array, natural_frequency: Array, damping_ratio: Array, compliance: Array
) -> Array:
    """Frequency at which the reactive flows of chamber and reducing valve cancel: C + Im(Y)/w = 0.

    w is the angular frequency and Y the admittance of the valve (`reducing_valve_end`). The valve
    lags: below this frequency it acts as an inertance that outweighs the compliance. At this
    frequency only Re(Y) remains, and the stiffness of the actuator with piston area A,
    A^2 w/|Re(Y)|, peaks if Re(Y) is small. The line is stable only if Re(Y) > 0 here, so the
    passive conductance must outweigh the negative share that the regulating valve contributes.
    With k = G/(C w0),
    w^2 = w0^2 [1 - 2 zeta^2 + sqrt(4 zeta^4 - 4 zeta^2 + 2 zeta k)], the upper root.

    Parameters
    ----------
    conductance : G, as in `reducing_valve_end` [m^3/s/Pa]
    natural_frequency : w0/(2 pi) [Hz]
    damping_ratio : zeta [-]
    compliance : C of chamber, line and walls before the valve [m^3/Pa], > 0

    Returns
    -------
    frequency [Hz]; NaN where the valve is too weak to cancel the compliance

    Notes
    -----
    Valid: as `reducing_valve_end`; lumped chamber and line.

    References
    ----------
    [AaltoThesis] section 5.2 suspects this resonance at 20 Hz; [derived] imaginary part of
    i w C + Y

    Examples
    --------
    >>> f = antiresonance_frequency(conductance=2e-10, natural_frequency=10.0, damping_ratio=0.5,
    ...                     compliance=1e-12)
    >>> print(f"{f:.2f} Hz")
    14.35 Hz
    """
    strength = conductance / (compliance * (2 * math.pi) * natural_frequency)
    square = damping_ratio * damping_ratio
    inner = 4 * square * square - 4 * square + 2 * damping_ratio * strength
    ratio = 1 - 2 * square + sqrt(inner)
    valid = real(ratio) > 0
    return where(valid, natural_frequency * sqrt(where(valid, ratio, 1.0)), math.nan)
