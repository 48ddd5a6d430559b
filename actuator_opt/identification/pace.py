"""Velocity of slow motion, where the position resolution shows below the record's cut-off."""

from __future__ import annotations

import numpy as np

from ..base.numeric import Array
from .conditioning import Motion, Piece, low_pass, zero_phase

CUTOFFS = (1 / 3, 1 / 8, 1 / 20)
"""Lower cut-offs relative to the record's (a choice: down to 1.5 Hz, some ten times the pace of a
slow test, 2 to 3 times apart)."""
BENT = 1.5
"""Mean square change of the position by a lower cut-off, relative to the sensor's errors, that is
allowed (a choice: 1 if only errors are removed)."""
PADDING = 1.5
"""Periods of a lower cut-off beside a section that affect its filter (a choice: a step response is
within 0.5 % there)."""


def velocities(piece: Piece, motion: Motion, first: int, last: int) -> Array:
    """Velocity along a section at the record's cut-off and at lower ones.

    A cut-off that moves the position by more than the sensor's errors is replaced by the cut-off
    before.

    Parameters
    ----------
    piece, motion : conditioned record
    first, last : first and one past the last sample of the section

    Returns
    -------
    velocities, the record's own first (cut-offs, samples) [m/s]
    """
    step = motion.sample_time
    own = piece.velocity[first:last]
    allowed = BENT * position_error(own, motion)
    found = [own]
    for share in CUTOFFS:
        cutoff = share * motion.cutoff
        more = round(PADDING / (cutoff * step))
        low, high = max(first - more, 0), min(last + more, piece.time.size)
        whole = piece["x"][low:high]
        sections = low_pass(
            cutoff=cutoff, order=motion.order, sample_time=step, compensated=motion.compensated
        )
        smooth = zero_phase(sections, whole, reach=2 * more)
        inside = slice(first - low, last - low)
        moved = float(np.mean((smooth - whole)[inside] ** 2))
        found.append(np.gradient(smooth, step)[inside] if moved <= allowed else found[-1])
    return np.stack(found)


def position_error(velocity: Array, motion: Motion) -> float:
    """Mean square error of the filtered position along a velocity [m^2].

    White noise s^2 passes the filter by 2 f_c dt. Steps q pass fully, as q^2/12, if the rod takes
    longer than 1/f_c for one; else as white noise [derived].
    """
    quality, cutoff = motion.quality["x"], motion.cutoff
    band = min(2 * cutoff * motion.sample_time, 1.0)
    step = quality.resolution**2 / 12
    slow = np.abs(velocity) < cutoff * quality.resolution
    return float(np.mean(np.where(slow, step, band * step))) + band * quality.noise**2
