"""Amplitude and phase at one frequency for records with drift, and the dynamic stiffness.

Mean, drift and oscillation are fitted together. Subtracting the drift first would also remove a
part of the oscillation, depending on its phase. Over n cycles this part is up to 6/(pi n)^2, or 2.4
% for 5 cycles [derived].
"""

from __future__ import annotations

from itertools import pairwise
from math import floor, pi
from typing import NamedTuple

import numpy as np

from ..base.errors import Diagnostic, InputError
from ..base.numeric import Array
from .integrate import sampled

FEWEST_SAMPLES = 5
"""Smallest number of samples: four unknowns, and a fifth sample to estimate the scatter."""
RESOLVED = 1e-12
"""Oscillation amplitude, as a share of the largest position, below which it counts as rounding
error (our choice)."""


class HarmonicFit(NamedTuple):
    """Fit x(t) = mean + slope (t - t_mid) + Re(amplitude e^(i omega t))."""

    mean: float
    """Fitted value at the middle of the record, without the oscillation."""
    slope: float
    """Drift per second."""
    amplitude: complex
    """Complex amplitude; phase 0 is a cosine that peaks at t = 0."""
    residual: float
    """Residual standard deviation: root of the sum of squared residuals divided by n - 4."""
    standard_error: float
    """Standard error of real and imaginary part for independent residuals. Higher harmonics
    increase it."""


def harmonic_fit(*, time: Array, values: Array, frequency: float) -> HarmonicFit:
    """Fit mean, drift and oscillation of a record by least squares on [1, t, cos wt, sin wt].

    Parameters
    ----------
    time : (n,) [s], one cycle or more; steps may be uneven
    values : (n,)
    frequency : frequency of the oscillation [Hz]

    Returns
    -------
    mean, slope per second, complex amplitude, residual and standard error, in the values' unit

    Raises
    ------
    InputError : invalid samples, less than one cycle, two samples a cycle or fewer

    Notes
    -----
    Valid: straight drift; the frequency is known.

    References
    ----------
    [derived] linear least squares, covariance s^2 (X^T X)^-1

    Examples
    --------
    >>> t = np.linspace(0.0, 1.0, 101)
    >>> fit = harmonic_fit(time=t, values=3 + 2 * t + np.sin(2 * pi * 4 * t), frequency=4.0)
    >>> print(f"{abs(fit.amplitude):.6f} {np.degrees(np.angle(fit.amplitude)):.1f} {fit.slope:.4f}")
    1.000000 -90.0 2.0000
    """
    t, x = sampled(time=time, fewest=FEWEST_SAMPLES, values=values)
    return _harmonic(_design(t, frequency), x)


class DynamicStiffness(NamedTuple):
    """Dynamic stiffness of a record."""

    stiffness: complex
    """Force divided by position [N/m]; with a positive phase the force leads."""
    standard_error: float
    """Standard error of real and imaginary part [N/m], for independent residuals."""


def dynamic_stiffness_of_record(
    *, time: Array, position: Array, force: Array, frequency: float
) -> DynamicStiffness:
    """Dynamic stiffness k = F/x of force and position oscillations at one frequency.

    Both are fitted with the same functions [1, t, cos wt, sin wt]. The force is positive in the
    direction of the position, so reverse the sign of a load that opposes extension.

    Parameters
    ----------
    time : (n,) [s], one cycle or more
    position : (n,) [m]
    force : (n,) on the rod, positive in the direction of the position [N]
    frequency : frequency of the load [Hz]

    Returns
    -------
    complex stiffness and its standard error [N/m]

    Raises
    ------
    InputError : as for `harmonic_fit`, or a position that does not oscillate at the frequency

    Notes
    -----
    Valid: small oscillations; noise of position and force independent.

    References
    ----------
    [AaltoThesis] eq. 2; [derived] joint least squares, relative errors in quadrature

    Examples
    --------
    >>> t = np.linspace(0.0, 1.0, 201)
    >>> x, f = 1e-4 * np.sin(2 * pi * 5 * t), 1e3 * np.sin(2 * pi * 5 * t + 0.1)
    >>> k = dynamic_stiffness_of_record(time=t, position=x, force=f, frequency=5.0).stiffness
    >>> print(f"{abs(k):.4g} N/m, {np.angle(k):.4f} rad")
    1e+07 N/m, 0.1000 rad
    """
    t, x, f = sampled(time=time, fewest=FEWEST_SAMPLES, position=position, force=force)
    design = _design(t, frequency)
    position_fit, force_fit = _harmonic(design, x), _harmonic(design, f)
    amplitude = abs(position_fit.amplitude)
    if amplitude <= RESOLVED * np.max(np.abs(x)):
        message = f"the position does not oscillate at {frequency:g} Hz"
        raise InputError(Diagnostic(message, "give the frequency of the load"))
    stiffness = force_fit.amplitude / position_fit.amplitude
    error = (
        np.hypot(force_fit.standard_error, abs(stiffness) * position_fit.standard_error) / amplitude
    )
    return DynamicStiffness(complex(stiffness), float(error))


def windows(*, time: Array, frequency: float, cycles: int) -> tuple[slice, ...]:
    """Consecutive slices of a record, each with whole cycles.

    A window ends before the first sample of the next one; an incomplete window at the end is
    dropped.

    Parameters
    ----------
    time : (n,) [s]
    frequency : [Hz]
    cycles : number of cycles in a window, 1 or more

    Returns
    -------
    slices of the samples

    Raises
    ------
    InputError : a record shorter than one window, or windows with too few samples to fit

    Notes
    -----
    Valid: nearly even steps.

    Examples
    --------
    >>> windows(time=np.arange(25) * 0.1, frequency=1.0, cycles=1)
    (slice(0, 10, None), slice(10, 20, None))
    """
    (t,) = sampled(time=time)
    if not frequency > 0 or cycles < 1:
        message = f"no windows of {cycles} cycles at {frequency:g} Hz exist"
        raise InputError(Diagnostic(message, "give a positive frequency and 1 cycle or more"))
    step = (t[-1] - t[0]) / (len(t) - 1)
    length = cycles / frequency
    count = floor((t[-1] - t[0] + step) / length + 1e-6)
    if count < 1:
        message = (
            f"a record of {t[-1] - t[0]:.3g} s is shorter than {cycles} cycles of {frequency:g} Hz"
        )
        raise InputError(Diagnostic(message, "take fewer cycles"))
    edges = t[0] + length * np.arange(count + 1) - 1e-3 * step  # each edge is the start of a window
    places = np.searchsorted(t, edges)
    if np.min(np.diff(places)) < FEWEST_SAMPLES:
        message = f"a window of {length:.3g} s contains fewer than {FEWEST_SAMPLES} samples"
        raise InputError(Diagnostic(message, "take more cycles"))
    return tuple(slice(int(a), int(b)) for a, b in pairwise(places))


class _Design(NamedTuple):
    """Matrix of a least-squares fit, its pseudo-inverse, and half the record duration [s]."""

    columns: np.ndarray
    inverse: np.ndarray
    half: float


def _design(t: np.ndarray, frequency: float) -> _Design:
    """Matrix with the columns [1, (t - t_mid)/half, cos wt, sin wt], all of order one."""
    span = t[-1] - t[0]
    step = span / (len(t) - 1)
    if not frequency > 0 or (span + step) * frequency < 1 - 1e-6:
        message = f"a record of {span:.3g} s is shorter than one cycle of {frequency:g} Hz"
        raise InputError(Diagnostic(message, "give a longer record or a higher frequency"))
    if 2 * step * frequency >= 1:
        message = f"samples every {step:.3g} s do not resolve {frequency:g} Hz"
        raise InputError(Diagnostic(message, "give more than two samples a cycle"))
    middle, half = 0.5 * (t[0] + t[-1]), 0.5 * span
    phase = 2 * pi * frequency * t
    columns = np.stack([np.ones_like(t), (t - middle) / half, np.cos(phase), np.sin(phase)], axis=1)
    return _Design(columns, np.linalg.pinv(columns), float(half))


def _harmonic(design: _Design, values: np.ndarray) -> HarmonicFit:
    """Least-squares fit of one channel."""
    coefficients = design.inverse @ values
    misfit = values - design.columns @ coefficients
    residual = float(np.linalg.norm(misfit) / np.sqrt(len(values) - 4))
    spread = np.sqrt(0.5 * np.sum(design.inverse[2:] ** 2))  # (X^T X)^-1 = X+ X+^T
    return HarmonicFit(
        float(coefficients[0]),
        float(coefficients[1] / design.half),
        complex(coefficients[2], -coefficients[3]),
        residual,
        float(residual * spread),
    )
