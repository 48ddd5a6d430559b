"""What a cut-off frequency keeps of the motion and lets through of the noise."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..base.numeric import Array
from .conditioning import Motion
from .record import Record

SHARE = 0.999
"""Share of the velocity's power that counts as the motion (a choice: what lies above then holds
3 % of the velocity)."""
ABOVE = 4.0
"""Times its noise that the velocity's spectrum shows motion (a choice: a line of white noise is as
high in one of 55 by a single periodogram, hardly ever by the mean of many)."""


class Spectrum(NamedTuple):
    """Frequencies of a record [Hz].

    Parameters
    ----------
    motion : 99.9 % of the velocity's power lies below
    floor : above the motion the position's spectrum is noise from here on; 0 where it never is
    kept : share of the velocity's power that passes the filter
    """

    motion: float
    floor: float
    kept: float

    def says(self, cutoff: float) -> str:
        """Whether a cut-off [Hz] fits the record, in one line."""
        if self.motion == 0:
            return "the position shows no motion above its noise"
        if self.motion > cutoff:
            return (
                f"the motion reaches {self.motion:.3g} Hz, beyond the cut-off: raise --cutoff, "
                "or what is fast is lost"
            )
        if 0 < self.floor < cutoff:
            return (
                f"99.9 % of the motion lies below {self.motion:.3g} Hz and the position is noise "
                f"from {self.floor:.3g} Hz: a cut-off between them loses nothing and is quieter"
            )
        return f"99.9 % of the motion lies below {self.motion:.3g} Hz, within the cut-off"


def spectrum(record: Record, motion: Motion) -> Spectrum:
    """Where motion ends and noise begins, by Welch's method on the longest piece.

    The velocity's spectrum less that of white noise of the position, (2 sin(pi f dt)/dt)^2 times a
    level that the upper half of the band shows.

    Parameters
    ----------
    record : raw
    motion : conditioned

    Returns
    -------
    the frequencies
    """
    from scipy.signal import welch  # slow to import, rarely needed

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
    """Frequencies at which what stands above the white noise is motion.

    The steps q of a sensor draw lines at v/q that hold up to q^2/(2 pi^2) of the position's power,
    less than their variance q^2/12: past the motion's own hill a line counts from there on.
    """
    place = np.where(loud, power / np.where(slope > 0, slope, 1.0), 0.0)
    peak = int(np.argmax(place))
    quiet = np.flatnonzero(~loud[peak:])
    foot = peak + (int(quiet[0]) if quiet.size else loud.size)
    return (np.arange(loud.size) < foot) | (place * frequency[1] > variance)
