"""Cleaning of a channel: remove spikes and clipped samples, estimate resolution and noise."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..base.numeric import Array

SPIKE, QUANTA, RANGE = 6.0, 3.0, 1e-3
"""Smallest height of a spike above the median of its neighbours: the largest of `SPIKE` robust
standard deviations, `QUANTA` sensor steps, and the share `RANGE` of the channel's range (our
choices: of samples with normal noise, one in 5e8 deviates by `SPIKE` standard deviations; rounding
alone causes two sensor steps; the usual noise of pressures reaches the share `RANGE`)."""
JUMP, BURST, FLANK = 0.7, 0.45, 0.3
"""A group of outlying samples is a spike if it rises by the share `JUMP` of its height within one
sample; otherwise it is a true peak of the signal. The smaller share `BURST` is sufficient unless
the signal already moves towards the group on both sides, by more than `FLANK` times the step at the
group's edge. All three are our choices. Within one sample, three adjacent stray samples rise by
half their height or more. For a true peak as wide as the window of the running median, the rise is
a third of the height if it is a triangle, and 0.6 if it is a half sine."""
WINDOW = 5e-3
"""Half the width of the neighbourhood of a sample [s] (our choice: a sixth of a 30 Hz period)."""
SAMPLED = 100_000
"""Number of samples from which a channel's robust standard deviation is estimated (our choice:
accurate to 1 %)."""
LEVELS = 20_000
"""Number of samples from which the resolution of a sensor is estimated (our choice: each step of a
fine sensor then occurs several times)."""
CROWD, GARBAGE = 0.15, 0.5
"""Shares of spikes among the samples of a window. Above the first share the remaining samples of
the window are doubtful, above the second they are useless (our choices). With 5 % random stray
samples the second share is exceeded once in 1e10 samples, with 10 % once in 1e6. If noise is as
large as the range, three quarters of the samples are spikes."""
HELD = 6
"""Smallest number of successive equal samples, at an end of the channel's range, that count as
clipped (our choice: a fifth of a 30 Hz period at 1 kHz; the filter smooths shorter runs)."""
FLICKER = 0.6
"""If the noise exceeds this number of sensor steps, a constant level can only be due to clipping
(our choice: on a true plateau, two of five samples would leave their step)."""
LIVE = 0.2
"""Noise is estimated from the samples that are not at an end of the range, provided that they are
at least this share of all samples (our choice: four times the share of stray samples)."""
TURNS = 0.3
"""A channel counts as noisy if it changes direction at more than this share of its steps (our
choice: about half the share of white noise, 2/3)."""
ROBUST = 1.4826
"""Standard deviation of a normal variable, divided by its median absolute deviation: 1/0.67449
[derived]."""


class Quality(NamedTuple):
    """Quality of a channel."""

    missing: int
    spikes: int
    clipped: int
    resolution: float
    """Resolution of the sensor, SI; negligibly small if the samples show no steps."""
    noise: float
    """Standard deviation of the noise of a single sample, SI: what the filter removes."""

    def told(self, name: str, samples: int) -> list[str]:
        """Notes on the samples that were removed from a channel."""
        counts = ((self.missing, "missing"), (self.spikes, "spikes"), (self.clipped, "clipped"))
        return [f"{name}: {n} of {samples} samples are {fault}" for n, fault in counts if n]


def clean(values: Array, step: float, *, pressure: bool) -> tuple[Array, Quality]:
    """Remove spikes and clipped samples from a channel; return it with its quality.

    Parameters
    ----------
    values : raw samples, NaN where missing
    step : time step [s]
    pressure : whether the channel is a pressure. Its smallest value then does not count as clipped,
        because a chamber open to the tank stays at that value

    Returns
    -------
    the samples, NaN where they are unreliable, and the quality of the channel
    """
    from scipy.ndimage import median_filter  # slow import, rarely used

    absent = ~np.isfinite(values)
    if absent.all():
        return values, Quality(values.size, 0, 0, 0.0, 0.0)
    present = values[~absent]
    size = 2 * int(np.clip(round(WINDOW / step), 2, 5)) + 1
    middle = median_filter(present, size=size, mode="nearest")
    quantum = resolution(middle) or resolution(present)
    live = _live(present)
    least = _least(present, middle, quantum, live)
    spikes = _spikes(present, middle, least)
    spikes |= _strays(present, spikes, quantum, live)
    spikes |= _garbage(present, spikes, least, size)
    clipped = _clipped(present, spikes, quantum, pressure=pressure)
    spikes &= ~clipped
    cleaned = np.full(values.shape, np.nan)
    cleaned[~absent] = np.where(spikes | clipped, np.nan, present)
    counts = values.size - present.size, int(spikes.sum()), int(clipped.sum())
    return cleaned, Quality(*counts, quantum, 0.0)


def resolution(values: Array) -> float:
    """Resolution of a sensor: the smallest gap between levels that occur repeatedly.

    `values` should be the running median of a channel, because stray samples add arbitrary levels.
    If levels seldom recur, the resolution is the first percentile of the gaps between levels, or of
    the steps from sample to sample if that is smaller.
    """
    # one random sample from each part, because equal intervals could alias
    count = min(LEVELS, values.size)
    parts = np.arange(count) + np.random.default_rng(0).random(count)
    sample = values[(parts * (values.size / count)).astype(int)]
    levels, counts = np.unique(sample, return_counts=True)
    least = 1e-9 * float(levels[-1] - levels[0])  # smaller differences are rounding
    counts = np.minimum(counts, 5)  # a long standstill must not count more than motion
    again = counts > 1
    gaps = np.diff(levels[again])
    gaps = gaps[gaps > least]
    if gaps.size and counts[again].sum() > 0.5 * counts.sum():
        return float(gaps.min())
    steps = np.abs(np.diff(values[: 50 * LEVELS]))
    gaps_by_source = [
        _hundredth(differences[differences > least]) for differences in (np.diff(levels), steps)
    ]
    return min((gap for gap in gaps_by_source if gap > 0), default=0.0)


def _hundredth(values: Array) -> float:
    """The value below which a hundredth of the given values lie; zero if none are given."""
    place = values.size // 100
    return float(np.partition(values, place)[place]) if values.size else 0.0


def _levels(values: Array) -> tuple[Array, Array]:
    """Indices at which a channel changes its level, and how many samples each level lasts."""
    first = np.concatenate([[0], np.flatnonzero(np.diff(values)) + 1])
    return first, np.diff(first, append=values.size)


def _live(values: Array) -> Array:
    """Flags for samples that are not at an end of the channel's range, where noise may be cut off.

    If only few samples would be flagged, all are: such a channel is a constant level with some
    stray samples.
    """
    first, length = _levels(values)
    constant = length >= HELD
    if not constant.any():
        return np.ones(values.shape, dtype=bool)
    level = values[first]
    ends = (level == level[constant].min()) | (level == level[constant].max())
    live = np.repeat(~(ends & constant), length)
    return live if np.mean(live) > LIVE else np.ones_like(live)


def _spread(values: Array, live: Array) -> float:
    """Robust standard deviation about zero of the samples that `live` flags."""
    sample = values[live]
    sample = sample[:: max(1, sample.size // SAMPLED)]
    return ROBUST * float(np.median(np.abs(sample))) if sample.size else 0.0


def runs(flags: Array) -> tuple[Array, Array]:
    """Start and end (exclusive) of every run of successive true flags."""
    turns = np.flatnonzero(np.diff(flags.astype(np.int8), prepend=0, append=0))
    return turns[::2], turns[1::2]


def _least(values: Array, middle: Array, quantum: float, live: Array) -> float:
    """Smallest deviation from the median of its neighbours at which a sample counts as a spike."""
    apart = np.abs(values - middle)
    if not np.any(middle != middle[0]) and np.mean(apart > 0) < 0.01:
        return 0.0  # a constant with a few stray samples
    sample = np.sort(values[:: max(1, values.size // LEVELS)])
    low, high = sample[sample.size // 100], sample[-1 - sample.size // 100]
    return max(SPIKE * _spread(apart, live), QUANTA * quantum, RANGE * float(high - low))


def _spikes(values: Array, middle: Array, least: float) -> Array:
    """Flags for spikes: far from their neighbours' median, and steeper than a true peak."""
    apart = np.abs(values - middle)
    out = apart > least
    at = np.flatnonzero(out)
    before, after = np.maximum(at - 2, 0), np.minimum(at + 2, values.size - 1)
    here = middle[at]  # a neighbour shifts the median by one sample, and a reversal flattens it
    passing = np.maximum(np.abs(middle[after] - here), np.abs(middle[before] - here))
    out[at] = apart[at] > least + passing
    for a, b in zip(*_peaks(values, apart, *runs(out)), strict=True):
        out[a:b] = False
    return out


def _strays(values: Array, spikes: Array, quantum: float, live: Array) -> Array:
    """Flags for single samples far from the straight line through their neighbours, except spikes.

    A stray sample of height h gives the deviations -h/2, h, -h/2 from that line; a step gives h/2,
    -h/2; a kink gives a single deviation.
    """
    sound = np.flatnonzero(~spikes)
    if sound.size < 5:
        return np.zeros(values.shape, dtype=bool)
    spike_places = np.flatnonzero(spikes)
    straight = values.copy()
    straight[spike_places] = np.interp(spike_places, sound, values[sound])
    bent = np.zeros(values.shape)
    bent[1:-1] = straight[1:-1] - (straight[2:] + straight[:-2]) / 2
    least = max(SPIKE * _spread(bent, live), QUANTA * quantum)
    strays = np.flatnonzero(np.abs(bent) > least)
    strays = strays[(strays > 1) & (strays < values.size - 2)]
    strays = strays[~spikes[strays]]
    for side in (-1, 1):
        share = -bent[strays + side] / bent[strays]
        strays = strays[(share > 0.25) & (share < 0.75)]
    mask = np.zeros(values.shape, dtype=bool)
    mask[strays] = True
    return mask


def _garbage(values: Array, spikes: Array, least: float, size: int) -> Array:
    """Flags for further unreliable samples, where spikes are dense.

    In a short group of spikes, a sample is flagged if it lies outside the channel's range next to
    the group, provided that the channel is calm there. In a long group, all samples are flagged.
    """
    from scipy.ndimage import maximum_filter1d, uniform_filter1d  # slow import, rarely used

    wide = 2 * size + 1
    dense = uniform_filter1d(spikes.astype(np.float32), wide, mode="constant")
    out = np.zeros(values.shape, dtype=bool)
    for a, b in zip(*runs(dense > CROWD), strict=True):
        before, after = slice(max(a - wide, 0), a), slice(b, b + wide)
        left, right = values[before][~spikes[before]], values[after][~spikes[after]]
        if min(left.size, right.size) < size or b - a > 4 * wide:
            continue
        ends = sorted((np.sort(left[-size:])[size // 2], np.sort(right[:size])[size // 2]))
        outside = (values[a:b] < ends[0] - least) | (values[a:b] > ends[1] + least)
        if np.any(outside & ~spikes[a:b]):
            rough = max(float(np.max(np.abs(np.diff(side, 2)))) for side in (left, right))
            # if it is not calm, the channel itself varies fast
            out[a:b] = outside & (rough <= 2 * least)
    core = dense > GARBAGE
    return out | maximum_filter1d(core, wide) if core.any() else out


def _peaks(values: Array, apart: Array, first: Array, last: Array) -> tuple[Array, Array]:
    """Select the runs of outlying samples that are true peaks."""
    if not first.size:
        return first, last
    rise = np.abs(np.diff(values, prepend=values[0], append=values[-1]))
    height = np.maximum.reduceat(np.append(apart, 0.0), np.stack([first, last], 1).ravel())[::2]
    steps = np.maximum.reduceat(np.append(rise, 0.0), np.stack([first, last + 1], 1).ravel())[::2]
    wide = np.pad(values, 2, mode="edge")
    goes_on = np.ones(first.size, dtype=bool)
    for edge, beyond in (
        (wide[first + 2] - wide[first + 1], wide[first + 1] - wide[first]),
        (wide[last + 1] - wide[last + 2], wide[last + 2] - wide[last + 3]),
    ):
        goes_on &= beyond * np.sign(edge) > FLANK * np.abs(edge)
    peak = (steps < BURST * height) | (goes_on & (steps < JUMP * height))
    return first[peak], last[peak]


def _clipped(values: Array, spikes: Array, quantum: float, *, pressure: bool) -> Array:
    """Flags for samples at the limit of a sensor's range.

    A channel counts as clipped if it stays at its highest or lowest level at least four times as
    long as at any other level, and if one of two things shows that this is not real: the noise of
    the channel is too large for a constant level, or it reaches the level without slowing down.
    """
    mask = np.zeros(values.shape, dtype=bool)
    first, length = _levels(values)
    level = values[first]
    constant = length >= HELD
    if values.size < 4 * HELD or not constant.any():
        return mask
    ends = (level[constant].max(),) if pressure else (level[constant].max(), level[constant].min())
    free = ~np.isin(level, [level[constant].min(), level[constant].max()])
    # with hardly more than two levels, no comparison is possible
    if length[free].sum() < LIVE * values.size:
        return mask
    turns = np.sign(np.diff(values[np.repeat(free, length)]))
    turns = turns[turns != 0]
    restless = turns.size > 1 and float(np.mean(turns[1:] != turns[:-1])) > TURNS
    noise = _noise(values, np.repeat(free, length))
    chance_of_stay = _stay(noise, quantum)
    for end in ends:
        beyond = (values > end) if end == level[constant].max() else (values < end)
        here = constant & (level == end)
        if np.mean(beyond & ~spikes) > 0.005 or length[here].max() < 4 * length[free].max():
            continue
        longest = float(length[here].max())  # 1e-4: once in ten thousand records by chance
        chance = values.size * chance_of_stay**longest < 1e-4
        flickers = restless and noise > FLICKER * quantum and chance
        if flickers or _abrupt(values, first[here], length[here], quantum):
            for a, n in zip(first[here], length[here], strict=True):
                mask[a : a + n] = True
    return mask


def _noise(values: Array, free: Array) -> float:
    """Standard deviation of white noise: that of the second differences, divided by sqrt 6."""
    bent = values[2:] - 2 * values[1:-1] + values[:-2]
    bent = bent[free[2:] & free[1:-1] & free[:-2]]
    return ROBUST * float(np.median(np.abs(bent))) / np.sqrt(6) if bent.size else 0.0


def _stay(noise: float, quantum: float) -> float:
    """Probability that a noisy sample stays on its sensor step: P(|n| < q/2), noise n, step q."""
    from math import erf

    return erf(quantum / (2 * np.sqrt(2) * noise)) if noise > 0 else 1.0


def _abrupt(values: Array, first: Array, length: Array, quantum: float) -> bool:
    """Whether a channel reaches or leaves a level without slowing down.

    The limit cuts the last step before the level short, so the two steps before it are compared:
    the channel does not slow down if the later one is not smaller.
    """
    arrivals = first[first >= 3]
    departures = (first + length - 1)[first + length + 3 <= values.size]
    later = np.concatenate(
        [
            values[arrivals - 1] - values[arrivals - 2],
            values[departures + 1] - values[departures + 2],
        ]
    )
    early = np.concatenate(
        [
            values[arrivals - 2] - values[arrivals - 3],
            values[departures + 2] - values[departures + 3],
        ]
    )
    later, early = np.abs(later), np.abs(early)
    steps = np.abs(np.diff(values))
    least = max(QUANTA * quantum, 0.3 * float(np.median(steps[steps > 0])))
    fast = (later > least) & (later > 0.75 * early) & (early > 0.75 * later)
    return later.size > 0 and float(np.mean(fast)) > 0.5
