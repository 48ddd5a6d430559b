"""Effect of a cut-off frequency: motion kept, noise passed."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..base.numeric import Array
from .conditioning import Motion
from .record import Record

SHARE = 0.999
"""Share of the velocity's power that counts as motion (a choice: the rest then has 3 % of the
velocity)."""
ABOVE = 4.0
"""Multiple of its noise at which the velocity's spectrum shows motion (a choice: white noise
reaches it in one of 55 lines of a single periodogram, hardly ever in the mean of many)."""


class Spectrum(NamedTuple):
    """Frequencies of a record [Hz].

    Parameters
    ----------
    motion : 99.9 % of the velocity's power lies below
    floor : above the motion, the position's spectrum is noise from here on; 0 if it never is
    kept : share of the velocity's power that passes the filter
    """

    motion: float
    floor: float
    kept: float

    def says(self, cutoff: float) -> str:
        """Judge a cut-off [Hz] for the record, in one line."""
        if self.motion == 0:
            return "the position shows no motion above its noise"
        if self.motion > cutoff:
            return (
                f"the motion reaches {self.motion:.3g} Hz, above the cut-off: raise --cutoff, or "
                "fast motion is lost"
            )
        if 0 < self.floor < cutoff:
            return (
                f"99.9 % of the motion lies below {self.motion:.3g} Hz, and the position is "
                f"noise above {self.floor:.3g} Hz: a cut-off between them loses nothing and "
                "reduces noise"
            )
        return f"99.9 % of the motion lies below {self.motion:.3g} Hz, within the cut-off"


def spectrum(record: Record, motion: Motion) -> Spectrum:
    """Frequencies at which motion ends and noise begins, by Welch's method on the longest section.

    Uses the velocity's spectrum less that of white noise of the position, (2 sin(pi f dt)/dt)^2
    times a level from the upper half of the band.

    Parameters
    ----------
    record : raw
    motion : conditioned

    Returns
    -------
    the frequencies
    """
    from scipy.signal import welch  # slow import, rarely used

    step, noise = motion.sample_time, motion.quality["x"].noise
    piece = max(motion.pieces, key=lambda one: one.time.size)
    known = np.isfinite(record["x"])
    raw = np.interp(piece.time, record.time[known], record["x"][known])
    spike = np.abs(raw - piece["x"]) > 6 * noise
    position = np.where(spike, piece["x"], raw)
    frequency, power = welch(
        np.diff(position) / step, fs=1 / step, nperseg=min(position.size - 1, round(4 / step))
    )
    slope = (2 * np.sin(np.pi * frequency * step) / step) ** 2
    upper = frequency > 0.25 / step
    level = float(np.median(power[upper] / slope[upper]))
    variance = max(level * 0.5 / step, motion.quality["x"].resolution ** 2 / 12)
    loud = (power > ABOVE * level * slope) & (frequency > 0)
    clear = np.where(loud & _moves(frequency, power, slope, loud, variance), power, 0.0)
    clear = np.maximum(clear - level * slope, 0.0)
    total = np.cumsum(clear)
    if np.sum(clear[1:] / slope[1:]) * frequency[1] <= variance:
        return Spectrum(0.0, 0.0, 1.0)
    edge = float(frequency[int(np.searchsorted(total, SHARE * total[-1]))])
    drowned = np.flatnonzero((clear == 0) & (frequency > edge))
    floor = float(frequency[drowned[0]]) if drowned.size else 0.0
    kept = float(np.sum(clear[frequency <= motion.cutoff]) / total[-1])
    return Spectrum(edge, floor, kept)


def _moves(frequency: Array, power: Array, slope: Array, loud: Array, variance: float) -> Array:
    """Frequencies at which the excess over white noise is motion.

    A sensor step q causes lines at v/q with up to q^2/(2 pi^2) of the position's power, less than
    their variance q^2/12. Beyond the motion's own peak a line must exceed that to count.
    """
    place = np.where(loud, power / np.where(slope > 0, slope, 1.0), 0.0)
    peak = int(np.argmax(place))
    quiet = np.flatnonzero(~loud[peak:])
    foot = peak + (int(quiet[0]) if quiet.size else loud.size)
    return (np.arange(loud.size) < foot) | (place * frequency[1] > variance)
