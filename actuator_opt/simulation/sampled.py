"""Sampled signals: one time, one or more channels, checked once."""

from __future__ import annotations

import numpy as np

from ..base.errors import Diagnostic, InputError
from ..base.numeric import Array

LAST = 0.1
"""Final share of a record that counts as steady (a choice)."""


def sampled(*, time: Array, fewest: int = 2, **channels: Array) -> tuple[np.ndarray, ...]:
    """Time and channels as arrays of floats, in the order given.

    Parameters
    ----------
    time : (n,) [s], never decreasing: a jump has two samples at one time
    fewest : minimum number of samples
    channels : (n,) each

    Returns
    -------
    time and channels

    Raises
    ------
    InputError : channels of different length, a sample that is not a number, too few samples, or
        decreasing time
    """
    names = ("time", *channels)
    arrays = tuple(np.asarray(values, dtype=float) for values in (time, *channels.values()))
    shape = arrays[0].shape
    for name, values in zip(names, arrays, strict=True):
        if values.shape != shape or values.ndim != 1:
            message = f"{name} has shape {values.shape}, but time {shape}"
            raise InputError(Diagnostic(message, "give one number per sample in every channel"))
        broken = np.flatnonzero(~np.isfinite(values))
        if broken.size:
            message = f"{name} of sample {broken[0]} is {values[broken[0]]}"
            raise InputError(Diagnostic(message, "remove the sample"))
    if len(arrays[0]) < fewest:
        message = f"{len(arrays[0])} samples"
        raise InputError(Diagnostic(message, f"give {fewest} or more"))
    falls = np.flatnonzero(np.diff(arrays[0]) < 0)
    if falls.size:
        message = f"time decreases after sample {falls[0]}"
        raise InputError(Diagnostic(message, "sort the samples by time"))
    if arrays[0][-1] == arrays[0][0]:
        raise InputError(Diagnostic("time does not advance", "give samples over a longer time"))
    return arrays


def last_mean(time: np.ndarray, values: np.ndarray) -> float:
    """Mean over the last tenth of the time, with linear interpolation."""
    start = time[-1] - LAST * (time[-1] - time[0])
    inside = time > start
    t = np.concatenate([[start], time[inside]])
    v = np.concatenate([[np.interp(start, time, values)], values[inside]])
    return float(np.trapezoid(v, t) / (t[-1] - t[0]))
