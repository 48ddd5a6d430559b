"""Fatigue damage of the parts of a design by its duty cycles: rainflow counting and Miner's sum.

Parts under the same load have the same counted cycles, as their stress is a linear function of that
load. Each cycle of the life is counted apart. Every start adds a cycle from rest to the peak; with
several duty cycles it also adds one from the smallest to the largest load of them all (our choice).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from ...base.numeric import Array
from ...design.duty import DutyCycle
from ...models import endurance, rainflow
from .numbers import FatiguePart, History, Numbers, Plan

if TYPE_CHECKING:
    from .results import Track


class _Counted(NamedTuple):
    """Shares of the full pulse at the ends of counted cycles, cycles on the first axis."""

    largest: Array
    smallest: Array
    count: Array
    """How often each occurs in a life."""


def damages(
    plan: Plan, numbers: Numbers, cycles: Sequence[DutyCycle], tracks: Mapping[str, Track]
) -> dict[tuple[str, str, str], Array]:
    """Miner's sums by (cycle, "damage", part); the cycle is "" for the whole life."""
    results: dict[tuple[str, str, str], Array] = {}
    histories: dict[History, dict[str, _Counted]] = {}
    for i, part in enumerate(plan.parts):
        if part.load not in histories:
            histories[part.load] = _counted(part.load, numbers, cycles, tracks)
        total: Array = 0.0
        for name, counted in histories[part.load].items():
            damage = _damage(part, f"part{i}.", numbers, counted)
            total = total + damage
            if name:
                results[name, "damage", part.place] = damage
        results["", "damage", part.place] = total
    return results


def _counted(
    load: History, numbers: Numbers, cycles: Sequence[DutyCycle], tracks: Mapping[str, Track]
) -> dict[str, _Counted]:
    """Counted cycles of one load by duty cycle, and under "" those between duty cycles."""
    counted, ends = {}, []
    for cycle in cycles:
        share = _history(load, numbers, tracks[cycle.name])
        repeats, starts = (numbers[f"{cycle.name}|{key}"] for key in ("repeats", "starts"))
        at = reversals(share[:, 0].real)
        found = rainflow.repeating_cycles(history=share[at, 0].real)
        largest, smallest = share[at][found.largest], share[at][found.smallest]
        row = np.ones((len(largest), 1))
        high, low = np.argmax(share[:, 0].real), np.argmin(share[:, 0].real)
        peak = share[high] if abs(share[high, 0].real) >= abs(share[low, 0].real) else share[low]
        start = np.where(peak.real > 0, peak, 0.0), np.where(peak.real < 0, peak, 0.0)
        counted[cycle.name] = _Counted(
            np.concatenate([largest, start[0][None]]),
            np.concatenate([smallest, start[1][None]]),
            np.concatenate([row * repeats, np.ones((1, 1)) * starts]),
        )
        ends.append((share[high], share[low], starts))
    if len(cycles) > 1:
        top = max(ends, key=lambda end: end[0][0].real)[0]
        bottom = min(ends, key=lambda end: end[1][0].real)[1]
        starts = max((end[2] for end in ends), key=lambda value: np.ravel(value)[0].real)
        counted[""] = _Counted(top[None], bottom[None], np.ones((1, 1)) * starts)
    return counted


def _history(load: History, numbers: Numbers, track: Track) -> Array:
    """The load at all samples as a share of its full pulse (samples, directions)."""
    if load == "rod":
        return -track.array("force") / numbers["rod_pulse"]
    a, b = track.array("pressure_a"), track.array("pressure_b")
    if load == "middle":
        x = track.real("position")
        behind = x > (x.max() + x.min()) / 2
        pressure = np.where(behind[:, None], a, b)
    else:
        pressure = a if load == "a" else b
    return pressure / numbers["supply"]


def reversals(values: npt.NDArray[np.float64]) -> npt.NDArray[np.intp]:
    """Indices of the local extremes of a repeating history, and of its first sample."""
    keep = np.flatnonzero(np.append(True, values[1:] != values[:-1]))
    rest = values[keep]
    before, after = np.roll(rest, 1), np.roll(rest, -1)
    turns = (rest - before) * (after - rest) <= 0
    turns[0] = True
    return keep[turns]


def _damage(part: FatiguePart, at: str, numbers: Numbers, counted: _Counted) -> Array:
    """Miner's sum of a part over counted cycles."""
    largest, smallest, count = counted
    if part.only_tension:
        largest = np.where(largest.real > 0, largest, 0.0)
        smallest = np.where(smallest.real > 0, smallest, 0.0)
    span = largest - smallest
    if part.bolted:
        # the life of a bolt falls with the third power of the load (`endurance.bolt_cycles`)
        return (count * span * span * span).sum(axis=0) / numbers[f"{at}life"]
    stress = {
        "amplitude": numbers[f"{at}span"] * span / 2,
        "mean": numbers[f"{at}offset"] + numbers[f"{at}slope"] * (largest + smallest) / 2,
    }
    ultimate = numbers[f"{at}ultimate"]
    endured = endurance.basquin_cycles(
        amplitude=endurance.reversed_amplitude(**stress, ultimate_strength=ultimate),
        ultimate_strength=ultimate,
        fatigue_limit=numbers[f"{at}limit"],
        limit_cycles=numbers[f"{at}limit_cycles"],
    )
    return endurance.miner_damage(cycles=endured, counts=count, repeats=1.0)

