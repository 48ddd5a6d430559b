"""Amplitude and mean of counted cycles, for tests of rainflow counting and damage."""

from __future__ import annotations

from typing import NamedTuple

from actuator_opt.base.numeric import Array, histories, namespace
from actuator_opt.models.rainflow import Cycles


class CycleStress(NamedTuple):
    """Stress of counted cycles, cycles on the first axis."""

    amplitude: Array
    mean: Array


def cycle_stress(history: object, cycles: Cycles) -> CycleStress:
    """Half of the range of every cycle, and the mean of its two samples."""
    (values,) = histories(history)
    xp = namespace(values)
    largest, smallest = (
        xp.take_along_axis(values, xp.asarray(index), axis=0)
        for index in (cycles.largest, cycles.smallest)
    )
    return CycleStress(0.5 * (largest - smallest), 0.5 * (largest + smallest))
