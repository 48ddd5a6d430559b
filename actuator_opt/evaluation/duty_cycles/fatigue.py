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
from ...models import endurance, rainflow
from .numbers import LIFE, STRESS, History, Plan

if TYPE_CHECKING:
    from .results import Track


class _Counted(NamedTuple):
    """Shares of the full pulse at the ends of counted cycles, (cycles, directions)."""

    largest: Array
    smallest: Array
    count: Array
    """How often each occurs in a life."""


class _Group(NamedTuple):
    """Parts under the same load, with the same kind of life."""

    load: History
    bolted: bool
    only_tension: bool
    parts: npt.NDArray[np.intp]


class Fatigue:
    """Damage of all parts by the cycles of a life.

    Parameters
    ----------
    plan : structure of the design
    cycles : names of the cycles with a stated number of repeats
    rows : row of every number by name

    Attributes
    ----------
    keys : (cycle, "damage", part) of every result; the cycle is "" for the whole life
    """

    def __init__(self, plan: Plan, cycles: Sequence[str], rows: Mapping[str, int]) -> None:
        self.cycles, self._rows = tuple(cycles), rows
        kinds: dict[tuple[History, bool, bool], list[int]] = {}
        for i, part in enumerate(plan.parts if cycles else ()):
            kinds.setdefault((part.load, part.bolted, part.only_tension), []).append(i)
        self._groups = [_Group(*kind, np.array(parts)) for kind, parts in kinds.items()]
        places = [plan.parts[i].place for group in self._groups for i in group.parts]
        words = (*self.cycles, "") if places else ()
        self.keys = [(cycle, "damage", place) for cycle in words for place in places]

    def damages(self, numbers: Array, tracks: Mapping[str, Track]) -> Array:
        """Miner's sums (keys, directions) at numbers (numbers, directions)."""
        histories: dict[History, dict[str, _Counted]] = {}
        by_cycle: dict[str, list[Array]] = {cycle: [] for cycle in (*self.cycles, "")}
        for group in self._groups:
            if group.load not in histories:
                histories[group.load] = self._counted(group.load, numbers, tracks)
            damages = {
                cycle: self._damage(group, numbers, counted)
                for cycle, counted in histories[group.load].items()
            }
            for cycle in self.cycles:
                by_cycle[cycle].append(damages[cycle])
            by_cycle[""].append(sum(damages.values()))
        blocks = [block for parts in by_cycle.values() for block in parts]
        return np.concatenate(blocks) if blocks else np.empty((0, numbers.shape[1]))

    def _counted(
        self, load: History, numbers: Array, tracks: Mapping[str, Track]
    ) -> dict[str, _Counted]:
        """Counted cycles of one load by duty cycle, and under "" those between duty cycles."""
        counted, ends = {}, []
        for name in self.cycles:
            share = self._history(load, numbers, tracks[name])
            repeats, starts = (numbers[self._rows[f"{name}|{key}"]] for key in LIFE)
            level = share[:, 0].real
            at = reversals(level)
            found = rainflow.repeating_cycles(history=level[at])
            largest, smallest = share[at][found.largest], share[at][found.smallest]
            high, low = share[np.argmax(level)], share[np.argmin(level)]
            peak = high if abs(high[0].real) >= abs(low[0].real) else low
            up = np.where(peak.real > 0, peak, 0.0)
            counted[name] = _Counted(
                np.concatenate([largest, up[None]]),
                np.concatenate([smallest, (peak - up)[None]]),
                np.concatenate([np.ones((len(largest), 1)) * repeats, starts[None]]),
            )
            ends.append((high, low, starts))
        if len(ends) > 1:
            high = max((end[0] for end in ends), key=lambda x: x[0].real)
            low = min((end[1] for end in ends), key=lambda x: x[0].real)
            starts = max((end[2] for end in ends), key=lambda x: x[0].real)
            counted[""] = _Counted(high[None], low[None], starts[None])
        return counted

    def _history(self, load: History, numbers: Array, track: Track) -> Array:
        """The load at all samples as a share of its full pulse (samples, directions)."""
        if load == "rod":
            return -track.array("force") / numbers[self._rows["rod_pulse"]]
        a, b = track.array("pressure_a"), track.array("pressure_b")
        pressure = a if load == "a" else b
        if load == "middle":
            x = track.real("position")
            pressure = np.where((x > (x.max() + x.min()) / 2)[:, None], a, b)
        return pressure / numbers[self._rows["supply"]]

    def _damage(self, group: _Group, numbers: Array, counted: _Counted) -> Array:
        """Miner's sums of the parts of a group (parts, directions)."""
        largest, smallest, count = (x[:, None] for x in counted)
        if group.only_tension:
            largest = np.where(largest.real > 0, largest, 0.0)
            smallest = np.where(smallest.real > 0, smallest, 0.0)
        span = largest - smallest

        def stated(key: str) -> Array:
            return numbers[[self._rows[f"part{i}.{key}"] for i in group.parts]]

        if group.bolted:  # life falls with the third power of the load (`endurance.bolt_cycles`)
            return (count * span * span * span).sum(axis=0) / stated("life")
        part = {key: stated(key) for key in STRESS}
        endured = endurance.basquin_cycles(
            amplitude=endurance.reversed_amplitude(
                amplitude=part["span"] * span / 2,
                mean=part["offset"] + part["slope"] * (largest + smallest) / 2,
                ultimate_strength=part["ultimate"],
            ),
            ultimate_strength=part["ultimate"],
            fatigue_limit=part["limit"],
            limit_cycles=part["limit_cycles"],
        )
        counts = np.broadcast_to(count, endured.shape)
        return endurance.miner_damage(cycles=endured, counts=counts, repeats=1.0)


def reversals(values: npt.NDArray[np.float64]) -> npt.NDArray[np.intp]:
    """Indices of the local extremes of a repeating history, and of its first sample."""
    keep = np.flatnonzero(np.append(True, values[1:] != values[:-1]))
    rest = values[keep]
    before, after = np.roll(rest, 1), np.roll(rest, -1)
    turns = (rest - before) * (after - rest) <= 0
    turns[0] = True
    return keep[turns]
