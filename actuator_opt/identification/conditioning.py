"""Conditioning of a raw record: cleaned, divided at gaps, evenly sampled and filtered.

Every channel passes the same zero-phase filter once. The force balance therefore also holds for the
filtered values and gives filtered friction. Velocity and acceleration are central differences of
the filtered position.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import InputError
from ..base.numeric import Array
from .cleaning import ROBUST, Quality, clean, runs
from .record import CHANNELS, Record

CUTOFF, ORDER = 30.0, 4
"""Cut-off of the zero-phase Butterworth filter [Huang2017] [Hz], and its order in each of two
passes (our choice, as the source only gives the cut-off)."""
SLOWEST = 3.0
"""Smallest number of samples per period of the cut-off (our choice: the cut-off is then 2/3 of the
Nyquist frequency)."""
SHORTEST = 6.0
"""Smallest duration of a section of a record, in periods of the cut-off (our choice: a third of
such a section remains after `EDGE` is cut off at each end)."""
EDGE = 2.0
"""Time at each end of a section in which the filter is inaccurate, in periods of the cut-off (our
choice: after this time, a step response is within 0.2 % of its final value)."""
BRIDGE = 5
"""Largest number of successive missing samples that are interpolated linearly. A longer gap is
interpolated too if it lasts less than a quarter of a period of the cut-off (our choices: 5 ms at 1
kHz; over a quarter of a period of the cut-off, a straight line deviates by 0.3 % from a sine of a
tenth of the cut-off frequency)."""
ORDERS = 10
"""Highest order of the filter in a pass (our choice: a filter of higher order rings for longer than
`EDGE`)."""
CROWDED = 3.0
"""Largest permitted ratio of mean to median time step (our choice: at this ratio, resampling at
even steps triples the number of samples)."""
SAMPLED = 100_000
"""Number of samples of a section from which its noise is estimated (our choice: accurate to 0.3
%)."""
LATEST = 0.1
"""Largest lag that is corrected [s] (our choice: twenty times the usual lag of a pressure
sensor)."""
NEEDED = ("p1", "p2", "x", "F_L")
"""Channels that divide a record into sections where their samples are missing."""


@dataclass(frozen=True, slots=True, eq=False)
class RecordSection:
    """An uninterrupted section of a record, evenly sampled, SI; arrays are (samples).

    `channels` are filtered. `sound` selects the samples where the filter is accurate, which are
    those away from the ends.
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

    @property
    def pressures(self) -> tuple[Array, Array]:
        """Pressures of both chambers; without a channel p2 the rod end has zero pressure."""
        first = self["p1"]
        return first, self.channels.get("p2", np.zeros_like(first))


@dataclass(frozen=True, slots=True, eq=False)
class ConditionedRecord:
    """A conditioned record: its sections, the filter, and notes on the conditioning."""

    pieces: tuple[RecordSection, ...]
    sample_time: float
    cutoff: float
    order: int
    compensated: bool
    quality: dict[str, Quality]
    notes: tuple[str, ...]
    cleaned: dict[str, Array]
    """Channels without spikes and clipped samples, but not filtered, at the times of the raw
    record."""

    @property
    def band(self) -> float:
        """Share of white noise that passes the filter: 2 f_c dt with the cut-off f_c, at most 1."""
        return min(2 * self.cutoff * self.sample_time, 1.0)

    def sections(self, *, cutoff: float, sample_time: float) -> Array:
        """Second-order sections of the filter for another cut-off [Hz] or sample time [s]."""
        return low_pass(
            cutoff=cutoff, order=self.order, sample_time=sample_time, compensated=self.compensated
        )


def pass_cutoff(*, cutoff: float, order: int) -> float:
    """Cut-off f_c/(sqrt 2 - 1)^(1/2n) of each of two passes that together have -3 dB at f_c.

    Parameters
    ----------
    cutoff : f_c, cut-off of both passes together [Hz]
    order : n of each pass

    Returns
    -------
    frequency [Hz]

    References
    ----------
    [derived] two passes, each with the cut-off f_p, together have the gain 1/(1 + (f/f_p)^(2n)) at
    a frequency f; the gain is 1/sqrt 2 at f = f_c

    Examples
    --------
    >>> print(f"{pass_cutoff(cutoff=30.0, order=4):.3f} Hz")
    33.494 Hz
    """
    return cutoff / math.pow(math.sqrt(2.0) - 1, 1 / (2 * order))


@lru_cache(maxsize=64)  # every window of a record asks for the same few filters
def low_pass(*, cutoff: float, order: int, sample_time: float, compensated: bool) -> Array:
    """Second-order sections of one of the filter's two passes.

    If `compensated`, both passes together have -3 dB at exactly `cutoff`. The bilinear transform
    maps a frequency f to tan(pi f dt) with the sample time dt, and the cut-off of a single pass
    takes this into account. Far below the Nyquist frequency it is f_c/(sqrt 2 - 1)^(1/2n) for the
    cut-off f_c and the order n.
    """
    from scipy.signal import butter  # slow import, rarely used

    corner = math.tan(math.pi * cutoff * sample_time)  # as warped by the bilinear transform
    if compensated:
        corner = pass_cutoff(cutoff=corner, order=order)
    return butter(
        order, math.atan(corner) / (math.pi * sample_time), fs=1 / sample_time, output="sos"
    )


def zero_phase(sections: Array, values: Array, *, reach: int) -> Array:
    """Filter forward and backward along the last axis, so that nothing is shifted in time.

    At both ends the values are extended by `reach` mirrored samples.
    """
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
    before: ConditionedRecord | None = None,
) -> ConditionedRecord:
    """Divide a record into uninterrupted sections, cleaned, evenly sampled and filtered.

    Parameters
    ----------
    record : raw record
    cutoff, order : cut-off of the zero-phase Butterworth filter [Hz], and order of each of its two
        passes
    compensated : whether both passes together have -3 dB at the cut-off; if not, they have -6 dB
    pressure_lag : time lag of the pressures to correct [s]
    before : earlier result for the same record with other settings, so that the channels need not
        be cleaned again; None to clean them

    Returns
    -------
    the conditioned record

    Raises
    ------
    InputError
        times do not increase, samples are too few or too far apart, or there is no uninterrupted
        section
    """
    _check_settings(record, cutoff, order, pressure_lag)
    if "x" not in record:
        raise record.fault("no column x, the position", 'name it with --column "x=..."')
    time = _increasing_time(record)
    steps = np.diff(time)
    step = float(np.median(steps))
    _check_sampling(record, time, step, cutoff)
    notes = list(record.notes)
    if before is None:
        cleaned, quality = _cleaned(record, step)
    else:
        cleaned, quality = before.cleaned, before.quality
    lost = [name for name in CHANNELS if name in record and name not in cleaned]
    notes += [f"{name} has no samples and is left out" for name in lost]
    sections = low_pass(cutoff=cutoff, order=order, sample_time=step, compensated=compensated)
    pieces, dropped = [], []
    for first, last in _breaks(time, cleaned, step, cutoff):
        span = float(time[last - 1] - time[first])
        if span < SHORTEST / cutoff:
            dropped.append(span)
            continue
        if span > CROWDED * step * (last - first):
            raise record.fault(
                f"sample times are too uneven: most are {step:.3g} s apart, but the mean is "
                f"{span / (last - first):.3g} s",
                "give one line per sample, at even times",
                first,
            )
        section = {name: values[first:last] for name, values in cleaned.items()}
        pieces.append(_piece(time[first:last], section, step, cutoff, sections, pressure_lag))
    if not pieces:
        raise _no_section(record, quality, SHORTEST / cutoff)
    gaps = len(pieces) + len(dropped) - 1
    if gaps:
        short = f"; {sum(dropped):.3g} s are in sections too short to use" if dropped else ""
        notes.append(f"{gaps} gaps split the record; {len(pieces)} sections are used{short}")
    notes += _timing(steps, step, cutoff)
    quality = {
        name: channel._replace(noise=_noise(time, record[name], name, pieces))
        for name, channel in quality.items()
    }
    notes += [note for name, channel in quality.items() for note in channel.told(name, time.size)]
    return ConditionedRecord(
        tuple(pieces), step, cutoff, order, compensated, quality, tuple(notes), cleaned
    )


def _timing(steps: Array, step: float, cutoff: float) -> list[str]:
    """Notes on missing or uneven sample times."""
    notes = []
    bridged = steps[steps < (_bridged(step, cutoff) + 1.5) * step]
    skipped = float(np.sum(np.round(bridged / step) - 1))
    if skipped > 0:
        notes.append(f"{skipped:.0f} samples are missing from the sequence and were interpolated")
    if np.abs(steps[steps < 1.5 * step] - step).max() > 0.01 * step:
        notes.append(f"sample times are uneven, so the record was resampled at {1e3 * step:.4g} ms")
    return notes


def _cleaned(record: Record, step: float) -> tuple[dict[str, Array], dict[str, Quality]]:
    """Every channel without its spikes and clipped samples, and the quality of each channel."""
    cleaned: dict[str, Array] = {}
    quality: dict[str, Quality] = {}
    for name in CHANNELS:
        if name not in record:
            continue
        if np.isfinite(record[name]).any():
            pressure = name in ("p1", "p2")
            cleaned[name], quality[name] = clean(record[name], step, pressure=pressure)
        elif name in NEEDED:
            raise record.fault(
                f"{name} has no samples", "repair the sensor, or leave the column out"
            )
    return cleaned, quality


def _check_settings(record: Record, cutoff: float, order: int, lag: float) -> None:
    """Reject invalid filter settings."""
    if not (math.isfinite(cutoff) and cutoff > 0):
        raise record.fault(
            f"the cut-off is {cutoff:g} Hz", 'give a frequency above zero: --cutoff "30 Hz"'
        )
    if not 1 <= order <= ORDERS or int(order) != order:
        raise record.fault(
            f"the order of the filter is {order:g}", f"give a whole number from 1 to {ORDERS}"
        )
    if not abs(lag) <= LATEST:
        raise record.fault(
            f"the lag of the pressures is {lag:g} s", f"give a lag from -{LATEST:g} to {LATEST:g} s"
        )


def _increasing_time(record: Record) -> Array:
    """The times of all samples; an error if they do not increase."""
    time = record.time
    if time.size < 2:
        raise record.fault("one sample", "give a record of a second or more")
    lost = np.flatnonzero(~np.isfinite(time))
    if lost.size:
        raise record.fault("missing time", "give a time for every sample", int(lost[0]))
    back = np.flatnonzero(np.diff(time) <= 0)
    if back.size:
        at = int(back[0]) + 1
        times = f", {back.size} times in total" if back.size > 1 else ""
        if time[at] == time[at - 1]:
            word, remedy = "stands still", "write time with more digits, one line per time"
        else:
            word, remedy = "runs backwards", "sort the lines by time, or give one test at a time"
        raise record.fault(f"time {word} at {time[at]:.9g} s{times}", remedy, at)
    return time


def _no_section(record: Record, quality: dict[str, Quality], shortest: float) -> InputError:
    """Create the error for a record without an uninterrupted section, with the cause."""
    worst = max(
        (
            (channel.missing + channel.spikes + channel.clipped, name)
            for name, channel in quality.items()
            if name in NEEDED
        ),
        default=(0, ""),
    )
    cause = "gaps in time"
    if worst[0] > BRIDGE:
        missing, stray, clipped, *_ = quality[worst[1]]
        cause = f"{worst[1]} has {missing} missing, {stray} stray and {clipped} clipped samples"
    return record.fault(
        f"no section of {shortest:.2g} s is uninterrupted: {cause}",
        "repair the sensors, or give a longer record",
    )


def _check_sampling(record: Record, time: Array, step: float, cutoff: float) -> None:
    """Reject a record whose sampling does not suit the filter."""
    span, shortest = float(time[-1] - time[0]), SHORTEST / cutoff
    if step * cutoff * SLOWEST > 1:
        most = 1 / (SLOWEST * step)
        hint = "; or is t in ms?" if step >= 0.1 and 1e-3 * step * cutoff * SLOWEST <= 1 else ""
        raise record.fault(
            f"{1 / step:.4g} samples per second are too few for a cut-off of {cutoff:g} Hz",
            f'sample faster, or lower the cut-off: --cutoff "{_floor(most):g} Hz" at most{hint}',
        )
    if span < shortest:
        hint = "; or is t in s?" if step < 2e-5 and 1e3 * span >= shortest else ""
        raise record.fault(
            f"the record lasts {span:.3g} s, too short for a filter at {cutoff:g} Hz",
            f"give {shortest:.2g} s or more{hint}",
        )


def _floor(value: float) -> float:
    """A value rounded down to three digits."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 2)
    return math.floor(value / unit) * unit


def _bridged(step: float, cutoff: float) -> int:
    """Largest number of successive missing samples that are interpolated linearly."""
    return max(BRIDGE, round(0.25 / (cutoff * step)))


def _breaks(
    time: Array, channels: dict[str, Array], step: float, cutoff: float
) -> list[tuple[int, int]]:
    """Start and end (exclusive) of every uninterrupted section."""
    torn = np.zeros(time.size, dtype=bool)
    longest = _bridged(step, cutoff)
    for name, values in channels.items():
        if name in NEEDED:
            first, last = runs(np.isnan(values))
            long = last - first > longest
            for a, b in zip(first[long], last[long], strict=True):
                torn[a:b] = True
    first, last = runs(~torn)
    cuts = np.flatnonzero(np.diff(time) > (longest + 1.5) * step) + 1
    cuts = cuts[~torn[cuts] & ~torn[cuts - 1]]
    first, last = np.sort(np.append(first, cuts)), np.sort(np.append(last, cuts))
    return list(zip(first.tolist(), last.tolist(), strict=True))


def _piece(
    time: Array,
    channels: dict[str, Array],
    step: float,
    cutoff: float,
    sections: Array,
    pressure_lag: float,
) -> RecordSection:
    """One section, resampled with even time steps, filtered and differentiated."""
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
    return RecordSection(even, smooth, velocity, np.gradient(velocity, step), sound)


def _noise(time: Array, values: Array, name: str, pieces: Sequence[RecordSection]) -> float:
    """Robust standard deviation of the differences between samples and the filtered channel."""
    deviations = []
    for piece in pieces:
        if name in piece:
            first, last = np.searchsorted(time, (piece.time[0], piece.time[-1] + 1e-9))
            known = np.flatnonzero(np.isfinite(values[first:last])) + first
            known = known[:: max(1, known.size // SAMPLED)]
            deviations.append(values[known] - np.interp(time[known], piece.time, piece[name]))
    return float(ROBUST * np.median(np.abs(np.concatenate(deviations)))) if deviations else 0.0


CUTOFFS = (1 / 3, 1 / 8, 1 / 20)
"""Lower cut-offs that are tried for the velocity, as shares of the record's cut-off (our choice:
down to 1.5 Hz, some ten times the frequency of a slow test, in factors of 2 to 3)."""
BENT = 1.5
"""Filtering at a lower cut-off changes the position. This is the largest permitted mean square of
the change, divided by the mean square error of the sensor (our choice: the ratio is 1 if only
errors are removed)."""
PADDING = 1.5
"""Length of record that is filtered besides the samples of interest, before and after them, in
periods of the lower cut-off (our choice: after this time, a step response is within 0.5 % of its
final value)."""


def velocities(piece: RecordSection, motion: ConditionedRecord, first: int, last: int) -> Array:
    """Velocity along a section, filtered at the record's cut-off and at lower cut-offs.

    Where a lower cut-off changes the position by more than the sensor's errors, the next higher
    cut-off is used instead.

    Parameters
    ----------
    piece, motion : a section of a conditioned record, and that record
    first, last : start and end (exclusive) of the samples of interest

    Returns
    -------
    velocities (cut-offs, samples), first that at the record's cut-off [m/s]
    """
    step = motion.sample_time
    velocity = piece.velocity[first:last]
    allowed = BENT * position_error(velocity, motion)
    candidates = [velocity]
    for share in CUTOFFS:
        cutoff = share * motion.cutoff
        more = round(PADDING / (cutoff * step))
        low, high = max(first - more, 0), min(last + more, piece.time.size)
        whole = piece["x"][low:high]
        sections = motion.sections(cutoff=cutoff, sample_time=step)
        smooth = zero_phase(sections, whole, reach=2 * more)
        inside = slice(first - low, last - low)
        moved = float(np.mean((smooth - whole)[inside] ** 2))
        candidates.append(np.gradient(smooth, step)[inside] if moved <= allowed else candidates[-1])
    return np.stack(candidates)


def position_error(velocity: Array, motion: ConditionedRecord) -> float:
    """Mean square error of the filtered position during a motion [m^2].

    Of white noise with variance s^2, the filter passes the share 2 f_c dt, with the cut-off f_c and
    the sample time dt. The variance q^2/12 of sensor steps q passes completely if the rod takes
    longer than 1/f_c for a step; if not, it counts as white noise [derived].
    """
    quality, band = motion.quality["x"], motion.band
    step = quality.resolution**2 / 12
    slow = np.abs(velocity) < motion.cutoff * quality.resolution
    return float(np.mean(np.where(slow, step, band * step))) + band * quality.noise**2
