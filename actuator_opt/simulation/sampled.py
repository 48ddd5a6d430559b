"""Sampled signals: one time, one or more channels, checked once."""

from __future__ import annotations

import numpy as np

from ..base.errors import Diagnostic, InputError
from ..base.numeric import Array

LAST = 0.1
"""Share of a record, at its end, that counts as steady (a choice)."""


def sampled(*, time: Array, fewest: int = 2, **channels: Array) -> tuple[np.ndarray, ...]:
    """Time and channels as arrays of floats, in the order given.

    Parameters
    ----------
    time : (n,) [s], never falling: a jump has two samples of one time
    fewest : samples that the caller needs
    channels : (n,) each

    Returns
    -------
    time and channels

    Raises
    ------
    InputError : a channel of another length, a sample that is no number, too few, time that falls
    """
    names = ("time", *channels)
    arrays = tuple(np.asarray(values, dtype=float) for values in (time, *channels.values()))
    shape = arrays[0].shape
    for name, values in zip(names, arrays, strict=True):
        if values.shape != shape or values.ndim != 1:
            message = f"{name} has shape {values.shape}, time {shape}"
            raise InputError(Diagnostic(message, "give one number a sample, of every channel"))
        broken = np.flatnonzero(~np.isfinite(values))
        if broken.size:
            message = f"{name} of sample {broken[0]} is {values[broken[0]]}"
            raise InputError(Diagnostic(message, "leave the sample out"))
    if len(arrays[0]) < fewest:
        message = f"{len(arrays[0])} samples"
        raise InputError(Diagnostic(message, f"give {fewest} or more"))
    falls = np.flatnonzero(np.diff(arrays[0]) < 0)
    if falls.size:
        message = f"time falls from sample {falls[0]} to the next"
        raise InputError(Diagnostic(message, "sort the samples by time"))
    if arrays[0][-1] == arrays[0][0]:
        raise InputError(Diagnostic("time stands still", "give samples of a longer time"))
    return arrays


def last_mean(time: np.ndarray, values: np.ndarray) -> float:
    """Mean over the last tenth of the time, samples joined by straight lines."""
    start = time[-1] - LAST * (time[-1] - time[0])
    inside = time > start
    t = np.concatenate([[start], time[inside]])
    v = np.concatenate([[np.interp(start, time, values)], values[inside]])
    return float(np.trapezoid(v, t) / (t[-1] - t[0]))
