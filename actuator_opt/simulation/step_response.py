"""Step response of a servo."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..base.errors import Diagnostic, InputError
from ..base.numeric import Array
from .sampled import LAST, last_mean, sampled

BAND = 0.02
"""Settling band as a share of the step, the usual 2 %."""


class StepMetrics(NamedTuple):
    """Figures of a step response; times count from its first sample."""

    rise_time: float | None
    """From 10 to 90 % of the step [s]; None if it never gets there."""
    settling_time: float | None
    """Last time outside the band about the target [s]; None if it does not stay inside."""
    overshoot: float
    """Excess over the target, as a share of the step; 0 if the target is never reached."""
    steady_state_error: float
    """Target less the mean of the last tenth, in the response's unit."""
    peak: float
    """Extreme response in the direction of the step."""
    peak_time: float
    """Time of the peak [s]."""
    decay: float | None
    """Next overshoot over the largest one; None without a next one."""


def step_metrics(
    *, time: Array, response: Array, start: float, target: float, band: float = BAND
) -> StepMetrics:
    """Rise, settling, overshoot and steady-state error of a sampled step response.

    Samples are joined by straight lines. The band and the overshoot are shares of the step about
    the target, so a response that settles elsewhere has an error but no settling time. It must also
    stay inside for the last tenth of the record.

    Parameters
    ----------
    time : (n,) [s]; the first sample is the instant of the step
    response : (n,)
    start, target : command before and after the step, in the response's unit
    band : half its width, share of the step [-]

    Returns
    -------
    figures in seconds, in shares of the step and in the response's unit

    Raises
    ------
    InputError : invalid samples, no step, or a band that is not positive

    Notes
    -----
    Valid: command constant after the step.

    References
    ----------
    [derived] usual definitions: 10 to 90 %, 2 % of the step

    Examples
    --------
    >>> t = np.linspace(0.0, 1.0, 2001)
    >>> found = step_metrics(time=t, response=1 - np.exp(-t / 0.1), start=0.0, target=1.0)
    >>> print(f"{found.rise_time:.4f} s, {found.settling_time:.4f} s, {found.overshoot}")
    0.2197 s, 0.3912 s, 0.0
    """
    t, x = sampled(time=time, response=response)
    if not np.isfinite(target - start) or target == start:
        message = f"a step from {start:g} to {target:g}"
        raise InputError(Diagnostic(message, "give different values for start and target"))
    if not 0 < band < 1:
        raise InputError(Diagnostic(f"band {band:g} of the step", "give one between 0 and 1"))
    t = t - t[0]
    done = (x - start) / (target - start)
    early, late = _reached(t, done, 0.1), _reached(t, done, 0.9)
    top = int(np.argmax(done))
    return StepMetrics(
        None if early is None or late is None else late - early,
        _settled(t, done - 1, band),
        max(float(done[top]) - 1, 0.0),
        target - last_mean(t, x),
        float(x[top]),
        float(t[top]),
        _decay(done[top:] - 1),
    )


def _reached(t: np.ndarray, done: np.ndarray, level: float) -> float | None:
    """First time at a level."""
    above = np.flatnonzero(done >= level)
    if not above.size:
        return None
    at = int(above[0])
    return float(t[0]) if at == 0 else _crossing(t, done, at - 1, level)


def _crossing(t: np.ndarray, values: np.ndarray, at: int, level: float) -> float:
    """Time at which the straight line between two samples crosses a level."""
    share = (level - values[at]) / (values[at + 1] - values[at])
    return float(t[at] + share * (t[at + 1] - t[at]))


def _settled(t: np.ndarray, error: np.ndarray, band: float) -> float | None:
    """Last time outside the band, if the rest covers the last tenth."""
    outside = np.flatnonzero(np.abs(error) > band)
    if not outside.size:
        return 0.0
    at = int(outside[-1])
    if at == len(t) - 1:
        return None
    time = _crossing(t, error, at, float(np.copysign(band, error[at])))
    return time if time <= (1 - LAST) * t[-1] else None


def _decay(beyond: np.ndarray) -> float | None:
    """Next overshoot over the first sample, which is the largest one."""
    back = np.flatnonzero(beyond < 0)
    if beyond[0] <= 0 or not back.size:
        return None
    following = float(np.max(beyond[back[0] :]))
    return following / float(beyond[0]) if following > 0 else None
