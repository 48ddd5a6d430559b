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

from ...base.numeric import STEP, Array
from ...models import endurance, rainflow
from .numbers import LIFE, STRESS, History, Plan

if TYPE_CHECKING:
    from .results import Track


MOST_KNOWN = 1000
"""Orders of reversals whose pairs are kept."""


class _Counted(NamedTuple):
    """Shares of the full pulse at the ends of counted cycles, (cycles, columns)."""

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
        self._known: dict[bytes, tuple[Array, Array]] = {}
        kinds: dict[tuple[History, bool, bool], list[int]] = {}
        for i, part in enumerate(plan.parts if cycles else ()):
            kinds.setdefault((part.load, part.bolted, part.only_tension), []).append(i)
        self._groups = [_Group(*kind, np.array(parts)) for kind, parts in kinds.items()]
        places = [plan.parts[i].place for group in self._groups for i in group.parts]
        words = (*self.cycles, "") if places else ()
        self.keys = [(cycle, "damage", place) for cycle in words for place in places]

    def damages(self, numbers: Array, tracks: Mapping[str, Track]) -> Array:
        """Miner's sums (keys, columns) at numbers (numbers, columns)."""
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
            designs, width = tracks[name].shape
            found = self._pairs(share.real[:, ::width])
            largest, smallest = (
                np.take_along_axis(share, np.repeat(at, width, axis=1), axis=0)
                for at in (found.largest, found.smallest)
            )
            high, low = (
                np.take_along_axis(share, at(share.real, axis=0)[None], axis=0)
                for at in (np.argmax, np.argmin)
            )
            peak = np.where(np.abs(high.real) >= np.abs(low.real), high, low)
            up = np.where(peak.real > 0, peak, 0.0)
            counted[name] = _Counted(
                np.concatenate([largest, up]),
                np.concatenate([smallest, peak - up]),
                np.concatenate([np.repeat(found.count, width, axis=1) * repeats, starts[None]]),
            )
            ends.append((high, low, starts[None]))
        if len(ends) > 1:
            high, low, starts = ends[0]
            for other in ends[1:]:
                high = np.where(other[0].real > high.real, other[0], high)
                low = np.where(other[1].real < low.real, other[1], low)
                starts = np.where(other[2].real > starts.real, other[2], starts)
            counted[""] = _Counted(high, low, starts)
        return counted

    def _pairs(self, levels: npt.NDArray[np.float64]) -> rainflow.Cycles:
        """Rainflow cycles of histories (samples, designs).

        The pairs depend on the order of the reversals alone, and are kept for equal orders.
        """
        turns = _turns(levels)
        found = []
        for k in range(levels.shape[1]):
            at = np.flatnonzero(turns[:, k])
            values = levels[at, k]
            key = at.tobytes() + np.argsort(values, kind="stable").tobytes()
            if key not in self._known or (values[1:] == values[:-1]).any():
                if len(self._known) >= MOST_KNOWN:
                    self._known.clear()
                pairs = rainflow.repeating_cycles(history=values)
                self._known[key] = (at[pairs.largest], at[pairs.smallest])
            found.append(self._known[key])
        rows = max((len(pair[0]) for pair in found), default=0)
        index = np.zeros((2, rows, len(found)), dtype=np.intp)
        count = np.zeros((rows, len(found)))
        for k, pair in enumerate(found):
            index[:, : len(pair[0]), k] = pair
            count[: len(pair[0]), k] = 1.0
        return rainflow.Cycles(index[0], index[1], count)

    def _history(self, load: History, numbers: Array, track: Track) -> Array:
        """The load at all samples as a share of its full pulse (samples, columns)."""
        if load == "rod":
            return -track.array("force") / numbers[self._rows["rod_pulse"]]
        a, b = track.array("pressure_a"), track.array("pressure_b")
        pressure = a if load == "a" else b
        if load == "middle":
            x = track.real("position")
            behind = x > (x.max(axis=0) + x.min(axis=0)) / 2
            pressure = np.where(np.repeat(behind, track.shape[1], axis=1), a, b)
        return pressure / numbers[self._rows["supply"]]

    def _damage(self, group: _Group, numbers: Array, counted: _Counted) -> Array:
        """Miner's sums of the parts of a group (parts, columns)."""
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
        return _summed(
            count,
            amplitude=part["span"] * span / 2,
            mean=part["offset"] + part["slope"] * (largest + smallest) / 2,
            ultimate=part["ultimate"],
            limit=part["limit"],
            limit_cycles=part["limit_cycles"],
        )


def _damage_of(values: dict[str, Array]) -> Array:
    """Damage of single cycles of stress."""
    ultimate = values["ultimate"]
    return 1 / endurance.basquin_cycles(
        amplitude=endurance.reversed_amplitude(
            amplitude=values["amplitude"], mean=values["mean"], ultimate_strength=ultimate
        ),
        ultimate_strength=ultimate,
        fatigue_limit=values["limit"],
        limit_cycles=values["limit_cycles"],
    )


def _summed(count: Array, **stress: Array) -> Array:
    """Miner's sum over the first axis.

    Each cycle has few inputs and many directions: its slope by each input is computed once.
    """
    plain = {key: np.real(value) for key, value in stress.items()}
    each = _damage_of(plain)
    total: Array = (np.real(count) * each).sum(axis=0)
    if not np.iscomplexobj(count) and not any(map(np.iscomplexobj, stress.values())):
        return total
    change = np.imag(count) * each
    for key, value in stress.items():
        if np.any(np.imag(value)):
            slope = _damage_of({**plain, key: plain[key] + 1j * STEP}).imag / STEP
            change = change + np.real(count) * slope * np.imag(value)
    return total + 1j * change.sum(axis=0)


def _turns(values: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
    """Whether samples are local extremes of repeating histories (samples, designs)."""
    before, after = np.roll(values, 1, axis=0), np.roll(values, -1, axis=0)
    turns: npt.NDArray[np.bool_] = ~((values - before) * (after - values) > 0)
    return turns
