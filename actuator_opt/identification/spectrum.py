"""What a cut-off frequency keeps of the motion and lets through of the noise."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .conditioning import Motion
from .record import Record

SHARE = 0.999
"""Share of the velocity's power that counts as the motion."""


ABOVE = 4.0
"""Times its noise that the velocity's spectrum shows motion."""


class Spectrum(NamedTuple):
    """Frequencies of a record [Hz].

    Parameters
    ----------
    motion : 99.9 % of the velocity's power lies below
    floor : the position's spectrum stands on its noise from here on; 0 where it never does
    kept : share of the velocity's power that passes the filter
    """

    motion: float
    floor: float
    kept: float

    def says(self, cutoff: float) -> str:
        """Whether a cut-off [Hz] fits the record, in one line."""
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
    white = slope * float(np.median(power[upper] / slope[upper]))
    clear = np.where(power > ABOVE * white, power - white, 0.0)
    total = np.cumsum(clear)
    if total[-1] == 0:
        return Spectrum(0.0, 0.0, 1.0)
    edge = float(frequency[int(np.searchsorted(total, SHARE * total[-1]))])
    drowned = np.flatnonzero((power < ABOVE * white) & (frequency > 0))
    floor = float(frequency[drowned[0]]) if drowned.size else 0.0
    kept = float(np.sum(clear[frequency <= motion.cutoff]) / total[-1])
    return Spectrum(edge, floor, kept)
