"""The friction coefficient of a record, by the contact law of the design."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..base.fitting import quantile
from ..base.numeric import Array
from ..studies.bench import Bench
from .balance import Sliding
from .conditioning import ConditionedRecord

WINDOW = 0.1
"""Averaging time of friction and contact force [s] (our choice: six independent samples at 30 Hz)."""
LEAST_SPEED = 1e-3
"""Least mean speed of a window [m/s] (our choice: ten sensor steps of 10 um show its direction)."""


@dataclass(frozen=True, slots=True)
class Coefficient:
    """Median of mu = F_r/N over windows of sliding, SI.

    Parameters
    ----------
    value, lower, upper : [-], 95 % bounds of the median
    contact_force : N, normal force of all rings, median over the windows [N]
    contact_pressure : N over the rings' contact areas [Pa]
    windows : number of windows
    law : contact laws of the rings
    speeds : lowest and highest mean speed of the windows [m/s]
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
    """The friction coefficient of a record, or the reason for none.

    mu = F_r/sum f_i pi D_i, f the line loads of the design's contact laws at the chamber pressures.
    Squeeze and pressure both load the rings, so no pressure difference is needed.

    Parameters
    ----------
    slidings, motion : friction along the record, and its sample time
    bench : rings of the design

    Returns
    -------
    median over windows with bounds from the order statistics, or the reason for none
    """
    rows = np.concatenate([_windows(sliding, motion) for sliding in slidings])
    if rows.shape[0] < 2:
        return (
            f"no sliding of {WINDOW:g} s above {1e3 * LEAST_SPEED:g} mm/s in one direction: "
            "no friction coefficient"
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
    """Friction in the direction of motion, both pressures, speed: means of windows (windows, 4)."""
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
