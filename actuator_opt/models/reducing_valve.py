"""Pressure reducing valve as the end of a line: a second-order answer beside a passive leak."""

from __future__ import annotations

import math

from ..numeric import Array, namespace, real, sqrt, where


def reducing_valve_admittance(
    *,
    frequency: Array,
    conductance: Array,
    natural_frequency: Array,
    damping_ratio: Array,
    passive_conductance: Array = 0.0,
) -> Array:
    """Flow out of the line per pressure above the set value, at a frequency.

    Y = g + G w0^2/(w0^2 - w^2 + 2 i zeta w0 w): G + g slowly, where the valve holds its pressure;
    g alone well above its natural frequency, where the spool stands still.

    Parameters
    ----------
    frequency : [Hz]
    conductance : G of the controlled flow [m^3/s/Pa]: flow per pressure deviation, steady
    natural_frequency : w0/(2 pi) [Hz], > 0
    damping_ratio : zeta [-]
    passive_conductance : g of the standing opening [m^3/s/Pa]

    Returns
    -------
    complex admittance [m^3/s/Pa]; its real part is negative above w0 where g is small

    Notes
    -----
    Valid: small pressure changes about a steady flow; one spool mode (pilot stages add lag).

    References
    ----------
    [AaltoThesis] section 5.2 names the cause; [derived] spool as a second-order system

    Examples
    --------
    >>> y = reducing_valve_admittance(frequency=10.0, conductance=1e-10, natural_frequency=10.0,
    ...                               damping_ratio=0.5)
    >>> print(f"{y.imag:.1e}")
    -1.0e-10
    """
    xp = namespace(frequency, conductance, natural_frequency, damping_ratio, passive_conductance)
    ratio = xp.asarray(frequency / natural_frequency, dtype=xp.complex128)
    return passive_conductance + conductance / (1 - ratio * ratio + 2j * (damping_ratio * ratio))


def stiff_frequency(
    *, conductance: Array, natural_frequency: Array, damping_ratio: Array, compliance: Array
) -> Array:
    """Frequency where chamber and valve together take no reactive flow: C + Im(Y)/w = 0.

    The valve lags: below this frequency it is an inertance that outweighs the compliance, here
    only Re(Y) is left, and the actuator's stiffness A^2 w/|Re(Y)| peaks where that is small. The
    line is stable only if Re(Y) > 0 here, so the passive share must outweigh the valve's. With
    k = G/(C w0): w^2 = w0^2 [1 - 2 zeta^2 + sqrt(4 zeta^4 - 4 zeta^2 + 2 zeta k)], the upper root.

    Parameters
    ----------
    conductance : G of the controlled flow [m^3/s/Pa]
    natural_frequency : w0/(2 pi) [Hz]
    damping_ratio : zeta [-]
    compliance : C of chamber, line and walls before the valve [m^3/Pa], > 0

    Returns
    -------
    frequency [Hz]; NaN where the valve is too weak to cancel the compliance

    Notes
    -----
    Valid: as `reducing_valve_admittance`; lumped chamber and line.

    References
    ----------
    [AaltoThesis] section 5.2 suspects this resonance at 20 Hz; [derived] imaginary part of
    i w C + Y

    Examples
    --------
    >>> f = stiff_frequency(conductance=2e-10, natural_frequency=10.0, damping_ratio=0.5,
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
