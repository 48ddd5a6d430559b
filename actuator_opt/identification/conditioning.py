"""From a raw record to evenly sampled, filtered motion: gaps, spikes, clipping, zero-phase filter.

Every channel passes the same filter once, so that the force balance holds for filtered values:
what comes out is the friction itself through that filter. Velocity and acceleration are central
differences of the filtered position.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..numeric import Array
from .record import CHANNELS, Record

CUTOFF, ORDER = 30.0, 4
"""Cut-off [Hz] of the zero-phase Butterworth filter [Huang2017], and its order per pass (a choice:
the source gives the cut-off alone)."""
SLOWEST = 3.0
"""Samples per period of the cut-off, at least."""
SHORTEST = 6.0
"""Periods of the cut-off that a piece of the record lasts at least."""
EDGE = 2.0
"""Periods of the cut-off at both ends of a piece where the filter knows too little."""
GAP, BRIDGE = 3.5, 5
"""A step of time over the usual one that is a gap; missing samples that a straight line bridges."""
SPIKE, QUANTA, RANGE = 6.0, 3.0, 1e-3
"""A spike stands out of its neighbours' median by so many robust standard deviations, by so many
steps of the sensor, and by so much of the channel's range."""
NEEDED = ("p1", "p2", "x", "F_L", "v")
"""Channels whose missing samples break a record."""


class Quality(NamedTuple):
    """What a channel is worth."""

    missing: int
    spikes: int
    clipped: int
    resolution: float
    """Least step between samples, SI."""
    noise: float
    """Standard deviation of a sample, what the filter takes away, SI."""


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """An unbroken stretch of a record, evenly sampled, SI; arrays (samples).

    `channels` are filtered; `sound` leaves out the ends where the filter knows too little.
    """

    time: Array
    channels: dict[str, Array]
    velocity: Array
    acceleration: Array
    sound: Array

    def __getitem__(self, name: str) -> Array:
        return self.channels[name]

    def __contains__(self, name: object) -> bool:
        return name in self.channels


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """A conditioned record: its pieces, and what was done to it."""

    pieces: tuple[Piece, ...]
    sample_time: float
    cutoff: float
    order: int
    compensated: bool
    quality: dict[str, Quality]
    notes: tuple[str, ...]

    @property
    def duration(self) -> float:
        """Of all pieces [s]."""
        return sum(float(one.time[-1] - one.time[0]) for one in self.pieces)


def pass_cutoff(*, cutoff: float, order: int) -> float:
    """Cut-off of each of two passes whose product is -3 dB at `cutoff`, f_c/(sqrt 2 - 1)^(1/2n).

    Parameters
    ----------
    cutoff : wanted of both passes [Hz]
    order : n of each pass

    Returns
    -------
    frequency [Hz]

    References
    ----------
    [derived] (1 + (f_c/f)^(2 n)) = sqrt 2 of the squared gain

    Examples
    --------
    >>> print(f"{pass_cutoff(cutoff=30.0, order=4):.3f} Hz")
    33.494 Hz
    """
    return cutoff / math.pow(math.sqrt(2.0) - 1, 1 / (2 * order))


def low_pass(*, cutoff: float, order: int, sample_time: float, compensated: bool) -> Array:
    """Second-order sections of one pass."""
    from scipy.signal import butter  # slow to import, rarely needed

    corner = pass_cutoff(cutoff=cutoff, order=order) if compensated else cutoff
    nyquist = 0.5 / sample_time
    return butter(order, min(corner, 0.99 * nyquist), fs=1 / sample_time, output="sos")


def zero_phase(sections: Array, values: Array, *, reach: int) -> Array:
    """Forward and backward along the last axis; `reach` samples are mirrored at the ends."""
    from scipy.signal import sosfiltfilt

    length = min(reach, values.shape[-1] - 1)
    return sosfiltfilt(sections, values, axis=-1, padtype="odd", padlen=length)


def condition(
    record: Record,
    *,
    cutoff: float = CUTOFF,
    order: int = ORDER,
    compensated: bool = True,
    pressure_lag: float = 0.0,
) -> Motion:
    """Evenly sampled, cleaned and filtered pieces of a record.

    Parameters
    ----------
    record : raw
    cutoff, order : of the zero-phase Butterworth filter [Hz], of each of its two passes
    compensated : whether both passes together are -3 dB at the cut-off, else -6 dB
    pressure_lag : time by which pressures come late, taken off [s]

    Returns
    -------
    the motion

    Raises
    ------
    InputError
        time that does not increase, samples too few or too far apart, nothing left unbroken
    """
    time = _time(record)
    step = float(np.median(np.diff(time)))
    _sampling(record, time, step, cutoff)
    notes = list(record.notes)
    quality: dict[str, Quality] = {}
    cleaned: dict[str, Array] = {}
    for name in CHANNELS:
        if name in record:
            cleaned[name], quality[name] = _clean(record[name], step)
    uneven = float(np.max(np.abs(np.diff(time) - step))) > 0.01 * step
    breaks = _breaks(time, cleaned, step, cutoff)
    shortest = SHORTEST / cutoff
    sections = low_pass(cutoff=cutoff, order=order, sample_time=step, compensated=compensated)
    pieces, dropped = [], 0.0
    for first, last in breaks:
        span = float(time[last - 1] - time[first])
        if span < shortest:
            dropped += span
            continue
        own = {name: one[first:last] for name, one in cleaned.items()}
        pieces.append(_piece(time[first:last], own, step, cutoff, sections, pressure_lag))
    if not pieces:
        raise record.fault(
            f"no stretch of {shortest:.2g} s without a gap, a clipped or a missing channel",
            "mend the sensors, or give a longer record",
        )
    if len(breaks) > 1:
        notes.append(
            f"{len(breaks) - 1} gaps; {len(pieces)} pieces used"
            + (f", {dropped:.3g} s too short to use" if dropped else "")
        )
    if uneven:
        notes.append(f"sample times are uneven: drawn to even steps of {1e3 * step:.4g} ms")
    for name, one in quality.items():
        for count, what in (
            (one.missing, "missing"),
            (one.spikes, "spikes"),
            (one.clipped, "clipped"),
        ):
            if count:
                notes.append(f"{name}: {count} samples {what} of {time.size}")
    quality = {
        name: one._replace(noise=_noise(time, record[name], name, pieces))
        for name, one in quality.items()
    }
    return Motion(
        tuple(pieces),
        step,
        cutoff,
        order,
        compensated,
        quality,
        tuple(notes),
    )


def _time(record: Record) -> Array:
    """The time of every sample, increasing."""
    time = record.time
    lost = np.flatnonzero(~np.isfinite(time))
    if lost.size:
        raise record.fault("no time", "give every sample its time", int(lost[0]))
    if time.size < 2:
        raise record.fault("one sample", "give a record of a second or more")
    back = np.flatnonzero(np.diff(time) <= 0)
    if back.size:
        at = int(back[0]) + 1
        word = "stands still" if time[at] == time[at - 1] else "runs backwards"
        raise record.fault(f"time {word} at {time[at]:.6g} s", "sort or mend the record", at)
    return time


def _sampling(record: Record, time: Array, step: float, cutoff: float) -> None:
    """Refuse a record the filter cannot work on."""
    span = float(time[-1] - time[0])
    if span < SHORTEST / cutoff:
        raise record.fault(
            f"the record lasts {span:.3g} s, too short for a filter at {cutoff:g} Hz",
            f"give {SHORTEST / cutoff:.2g} s or more",
        )
    if step * cutoff * SLOWEST > 1:
        most = 1 / (SLOWEST * step)
        raise record.fault(
            f"{1 / step:.4g} samples per second are too few for a cut-off of {cutoff:g} Hz",
            f'sample faster, or filter lower: --cutoff "{most:.3g} Hz" at most',
        )


def _clean(values: Array, step: float) -> tuple[Array, Quality]:
    """A channel without spikes and clipped samples (NaN there), and how many there were."""
    from scipy.ndimage import median_filter

    absent = ~np.isfinite(values)
    if absent.all():
        return values, Quality(values.size, 0, 0, 0.0, 0.0)
    kept = values[~absent]
    steps = np.abs(np.diff(kept))
    resolution = float(np.min(steps[steps > 0])) if np.any(steps > 0) else 0.0
    clipped = _clipped(kept)
    size = 2 * int(np.clip(round(5e-3 / step), 2, 5)) + 1
    middle = median_filter(kept, size=size, mode="nearest")
    apart = np.abs(kept - middle)
    low, high = np.percentile(kept, (1, 99))
    least = max(QUANTA * resolution, RANGE * float(high - low))
    least = max(SPIKE * 1.4826 * float(np.median(apart)), least)
    passing = 2 * np.abs(np.gradient(middle))  # a spike beside it moves the median by a sample
    spikes = (apart > least + passing) & ~clipped
    kept = np.where(spikes | clipped, np.nan, kept)
    out = np.full(values.shape, np.nan)
    out[~absent] = kept
    counts = int(absent.sum()), int(spikes.sum()), int(clipped.sum())
    return out, Quality(*counts, resolution, 0.0)


def _clipped(values: Array) -> Array:
    """Samples that stand at the channel's highest or lowest value while others never repeat."""
    same = np.diff(values) == 0
    out = np.zeros(values.shape, dtype=bool)
    for end in (values.min(), values.max()):
        at = values == end
        runs = same & at[:-1]
        elsewhere = same[~at[:-1]]
        if runs.sum() < 5 or elsewhere.size == 0 or elsewhere.mean() > 0.02:
            continue
        out[:-1] |= runs
        out[1:] |= runs
    return out


def _breaks(
    time: Array, channels: dict[str, Array], step: float, cutoff: float
) -> list[tuple[int, int]]:
    """First and one past the last sample of every unbroken stretch."""
    torn = np.zeros(time.size, dtype=bool)
    longest = max(BRIDGE, round(0.25 / (cutoff * step)))
    for name, values in channels.items():
        if name in NEEDED:
            torn |= _long_runs(np.isnan(values), longest)
    cuts = np.flatnonzero(np.diff(time) > GAP * step) + 1
    inside = ~torn
    edges = np.flatnonzero(np.diff(np.concatenate(([0], inside.astype(int), [0]))))
    found = []
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        here = [first, *cuts[(cuts > first) & (cuts < last)], last]
        found += [(int(a), int(b)) for a, b in pairwise(here)]
    return found


def _long_runs(flags: Array, longest: int) -> Array:
    """Those flags that stand in runs longer than `longest`."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flags.astype(int), [0]))))
    out = np.zeros(flags.size, dtype=bool)
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        if last - first > longest:
            out[first:last] = True
    return out


def _piece(
    time: Array,
    channels: dict[str, Array],
    step: float,
    cutoff: float,
    sections: Array,
    pressure_lag: float,
) -> Piece:
    """One stretch on even steps of time, filtered and differentiated."""
    count = int(np.floor((time[-1] - time[0]) / step + 1e-6)) + 1
    even = time[0] + step * np.arange(count)
    reach = round(3 / (cutoff * step))
    smooth: dict[str, Array] = {}
    for name, values in channels.items():
        known = np.isfinite(values)
        if not known.any():
            continue
        late = pressure_lag if name in ("p1", "p2") else 0.0
        straight = np.interp(even + late, time[known], values[known])
        smooth[name] = zero_phase(sections, straight, reach=reach)
    velocity = np.gradient(smooth["x"], step)
    edge = int(np.ceil(EDGE / (cutoff * step)))
    sound = np.zeros(count, dtype=bool)
    sound[edge : count - edge] = True
    return Piece(even, smooth, velocity, np.gradient(velocity, step), sound)


def _noise(time: Array, values: Array, name: str, pieces: Sequence[Piece]) -> float:
    """Standard deviation of a sample about the filtered channel, robust."""
    apart = []
    for piece in pieces:
        if name in piece:
            within = (time >= piece.time[0]) & (time <= piece.time[-1]) & np.isfinite(values)
            apart.append(values[within] - np.interp(time[within], piece.time, piece[name]))
    return float(1.4826 * np.median(np.abs(np.concatenate(apart)))) if apart else 0.0
