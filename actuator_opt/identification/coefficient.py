"""The friction coefficient from a record; contact laws of the design give the normal force."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..base.dataclass import dataclass
from ..base.fitting import quantile
from ..base.numeric import Array
from ..studies.bench import Bench
from .balance import Sliding
from .conditioning import ConditionedRecord

WINDOW = 0.1
"""Length of the time windows over which friction and contact force are averaged [s] (our choice:
six independent samples at 30 Hz)."""
LEAST_SPEED = 1e-3
"""Smallest mean speed of a usable time window [m/s] (our choice: the rod then moves ten sensor
steps of 10 um, which show the direction)."""


@dataclass(frozen=True, slots=True)
class Coefficient:
    """Friction coefficient mu = F_r/N: median over short time windows of sliding, SI.

    F_r is the friction force, N the normal force of all rings.

    Parameters
    ----------
    value, lower, upper : median, and its 95 % confidence limits [-]
    contact_force : normal force N of all rings, median over the windows [N]
    contact_pressure : N divided by the contact areas of the rings [Pa]
    windows : number of windows
    law : contact laws of the rings
    speeds : lowest and highest mean speed of a window [m/s]
    """

    value: float
    lower: float
    upper: float
    contact_force: float
    contact_pressure: float
    windows: int
    law: str
    speeds: tuple[float, float]


def coefficient(
    slidings: Sequence[Sliding], motion: ConditionedRecord, bench: Bench
) -> Coefficient | str:
    """The friction coefficient from a record, or the reason why it is missing.

    mu = F_r/(pi sum f_i D_i), with the friction force F_r and, for each ring i, its diameter D_i
    and its line load f_i. The line loads follow from the contact laws of the design at the chamber
    pressures. Both squeeze and pressure load the rings, so no pressure difference is needed.

    Parameters
    ----------
    slidings, motion : friction along each section of the record, and the conditioned record
    bench : rings of the design

    Returns
    -------
    median over the windows, with confidence limits from its order statistics; or the reason why it
    is missing
    """
    rows = np.concatenate([_windows(sliding, motion) for sliding in slidings])
    if rows.shape[0] < 2:
        return (
            f"the rod never slides for {WINDOW:g} s above {1e3 * LEAST_SPEED:g} mm/s in one "
            "direction: no friction coefficient"
        )
    forces = bench.contact_forces(rows[:, 1], rows[:, 2])
    normal = sum(forces.values())
    ratios = np.sort(rows[:, 0] / normal)
    count = ratios.size
    half = quantile(count - 1) * np.sqrt(count) / 2
    low = int(np.clip(np.floor(count / 2 - half), 0, count - 1))
    high = int(np.clip(np.ceil(count / 2 + half), 0, count - 1))
    first, second = float(np.median(rows[:, 1])), float(np.median(rows[:, 2]))
    return Coefficient(
        float(np.median(ratios)),
        float(ratios[low]),
        float(ratios[high]),
        float(np.median(normal)),
        bench.contact_pressure(first, second),
        count,
        bench.contact_law,
        (float(np.min(rows[:, 3])), float(np.max(rows[:, 3]))),
    )


def _windows(sliding: Sliding, motion: ConditionedRecord) -> Array:
    """Means over each time window in which the rod slides in one direction, an array (windows, 4).

    The columns are friction (positive against the motion), both pressures, and speed.
    """
    size = max(round(WINDOW / motion.sample_time), 1)
    piece = sliding.piece
    count = piece.time.size // size

    def cut(values: Array) -> Array:
        return values[: count * size].reshape(count, size)

    way = np.sign(piece.velocity)
    valid = np.all(cut(sliding.moving), axis=1) & (np.abs(np.sum(cut(way), axis=1)) == size)
    valid &= np.mean(np.abs(cut(piece.velocity)), axis=1) > LEAST_SPEED
    channels = (sliding.friction * way, *piece.pressures, np.abs(piece.velocity))
    return np.stack([np.mean(cut(channel), axis=1)[valid] for channel in channels], axis=1)
