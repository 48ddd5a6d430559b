"""Fatigue damage of the parts of a design by its duty cycles: rainflow counting and Miner's sum.

Parts under the same load have the same counted cycles, as their stress is a linear function of that
load. Each cycle of the life is counted apart. Every start adds a cycle from rest to the peak; with
several duty cycles it also adds one from the smallest to the largest load of them all (our choice).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ...base.numeric import Array
from ...base.symbolic.recorded import RecordedFunction
from ...models import endurance, rainflow
from .numbers import LIFE, STRESS, History, SamplePlan
from .sampling import NearSamples, Rows, SampleResults, padded

_LOCAL = ("largest", "smallest", *STRESS)
"""Inputs of the damage of a counted cycle: the ends of the load, and the numbers of the part."""


class _Spots(NamedTuple):
    """Samples, and the output that is the load there."""

    rows: Rows
    """(loads, counted cycles, duty cycles, designs)"""
    outputs: Rows


class _Counted(NamedTuple):
    """Samples at the ends of the counted cycles of all duty cycles of a life."""

    largest: _Spots
    smallest: _Spots
    times: Array
    """1, or 0 where a load has fewer cycles than another."""
    highest: _Spots
    """Samples of the largest and of the smallest load."""
    lowest: _Spots

    @property
    def rows(self) -> tuple[Rows, ...]:
        """All samples."""
        return self.largest.rows, self.smallest.rows, self.highest.rows, self.lowest.rows


class _Ends(NamedTuple):
    """Load as a share of its full pulse at both ends of counted cycles, with slopes.

    Arrays are (loads, counted cycles, designs, 1 + directions), or with duty cycles as third axis.
    """

    largest: Array
    smallest: Array
    times: Array
    """Number of times each occurs in a life."""


class CycleFatigue:
    """Damage of all parts by the cycles of a life.

    Parameters
    ----------
    plan : structure of the design
    cycles : names of all cycles
    repeated : which of them have a stated number of repeats
    rows : row of every number by name
    outputs : names of the results of a sample
    first : number of the first sample of every cycle, and of all samples (cycles + 1,)

    Attributes
    ----------
    keys : (cycle, "damage", part) of every result; the cycle is "" for the whole life
    outputs : results of a sample that the damage needs
    """

    def __init__(
        self,
        plan: SamplePlan,
        cycles: Sequence[str],
        repeated: Sequence[int],
        rows: Mapping[str, int],
        outputs: Sequence[str],
        first: Rows,
    ) -> None:
        names, self._outputs = [cycles[k] for k in repeated], tuple(outputs)
        self.outputs = [x for x in outputs if x.startswith("pulse_") or x == "position"]
        parts = sorted(enumerate(plan.parts if names else ()), key=lambda pair: pair[1].bolted)
        self._loads: tuple[History, ...] = tuple(dict.fromkeys(part.load for _, part in parts))
        self._load = np.array([self._loads.index(part.load) for _, part in parts], dtype=np.intp)
        self._tension = np.array([part.only_tension for _, part in parts], dtype=bool)
        self._metal = sum(not part.bolted for _, part in parts)
        metal, bolts = parts[: self._metal], parts[self._metal :]
        self._stress = np.array(
            [[rows[f"part{i}.{key}"] for i, _ in metal] for key in STRESS], dtype=np.intp
        )
        self._life = np.array([rows[f"part{i}.life"] for i, _ in bolts], dtype=np.intp)
        words = (*names, "") if parts else ()
        self.keys = [(cycle, "damage", part.place) for cycle in words for _, part in parts]
        self._lives = np.array([[rows[f"{name}|{key}"] for key in LIFE] for name in names])
        self._groups = padded(first[:-1][repeated], first[1:][repeated]) if parts else []
        self._damage_of = RecordedFunction(_damage_of, _LOCAL, np.ones(len(_LOCAL)))

    def counted(self, track: SampleResults) -> list[_Counted]:
        """The counted cycles of every duty cycle of the life, by length of the duty cycle."""
        return [self._counted(track, group.rows) for group in self._groups]

    def _counted(self, track: SampleResults, rows: Rows) -> _Counted:
        """The counted cycles of duty cycles with samples `rows` (duty cycles, samples).

        Short ones are filled up by their last sample, which changes no counted cycle.
        """
        shape = (len(self._loads), *rows.shape, track.values.shape[2])
        outputs, levels = np.empty(shape, dtype=np.intp), np.empty(shape)
        for k, load in enumerate(self._loads):
            if load == "middle":
                x = track.real("position")[rows]
                behind = x > (x.max(axis=1, keepdims=True) + x.min(axis=1, keepdims=True)) / 2
                a, b = (self._outputs.index(f"pulse_{chamber}") for chamber in "ab")
                outputs[k] = np.where(behind, a, b)
                first, second = (track.values[rows, track.columns[x]] for x in (a, b))
                levels[k] = np.where(behind, first, second)
            else:
                outputs[k] = self._outputs.index(f"pulse_{load}")
                levels[k] = track.real(f"pulse_{load}")[rows]
        history = levels.transpose(2, 0, 1, 3)
        pairs = rainflow.repeating_cycles(history=history.reshape(len(history), -1))
        loads = np.arange(shape[0])[:, None, None, None]
        cycles, designs = np.arange(shape[1])[:, None], np.arange(shape[3])

        def by_load(values: Array) -> Array:
            return values.reshape(len(values), *history.shape[1:]).transpose(1, 0, 2, 3)

        def spots(place: Rows) -> _Spots:
            return _Spots(rows[cycles, place], outputs[loads, cycles, place, designs])

        return _Counted(
            spots(by_load(pairs.largest)),
            spots(by_load(pairs.smallest)),
            by_load(pairs.count),
            spots(np.argmax(levels, axis=2)[:, None]),
            spots(np.argmin(levels, axis=2)[:, None]),
        )

    def damages(
        self, numbers: Array, counted: Sequence[_Counted], near: NearSamples, wanted: Array
    ) -> Array:
        """Miner's sums with slopes (keys, designs, 1 + directions).

        Results that are not wanted may be 0.

        Parameters
        ----------
        numbers : with slopes (numbers, designs, 1 + directions)
        counted, near : the counted cycles, and the samples at their ends with slopes
        wanted : whether each result is wanted (keys,)
        """
        parts, shape = len(self._load), numbers.shape[1:]
        lives = numbers[self._lives]  # (duty cycles, repeats and starts, designs, 1 + directions)
        blocks = np.zeros((1 + len(lives), parts, *shape))
        whole: list[Sequence[Array]] = []
        extremes: list[tuple[Array, Array]] = []
        for (cycles, _, _), some in zip(self._groups, counted, strict=True):
            high, low = (near.at(x.outputs, x.rows) for x in (some.highest, some.lowest))
            own = self._with_starts(some, near, high, low, lives[cycles])
            used = np.append(some.times.any(axis=(0, 3)), [[True] * len(cycles)], axis=0)
            for k, cycle in enumerate(cycles):
                if wanted[cycle * parts : (cycle + 1) * parts].any():
                    blocks[cycle] = self._damage(
                        numbers, _Ends(*(x[:, used[:, k], k] for x in own))
                    )
            whole.append([x[:, used] for x in own])
            extremes.append((high[:, 0], low[:, 0]))
        if len(lives) > 1:
            high, low = (np.concatenate(x, axis=1) for x in zip(*extremes, strict=True))
            order = np.concatenate([group.parts for group in self._groups])
            whole.append(_changes(high, low, lives[order, 1]))
        ends = _Ends(*(np.concatenate(x, axis=1) for x in zip(*whole, strict=True)))
        blocks[-1] = self._damage(numbers, ends)
        return blocks.reshape(-1, *shape)

    @staticmethod
    def _with_starts(
        counted: _Counted, near: NearSamples, high: Array, low: Array, lives: Array
    ) -> _Ends:
        """Counted cycles of the duty cycles in a life, and those of their starts."""
        peak: Array = np.where(np.abs(high[..., :1]) >= np.abs(low[..., :1]), high, low)
        up: Array = np.where(peak[..., :1] > 0, peak, 0.0)
        largest, smallest = (
            near.at(x.outputs, x.rows) for x in (counted.largest, counted.smallest)
        )
        starts = np.broadcast_to(lives[:, 1], up.shape)
        return _Ends(
            np.concatenate([largest, up], axis=1),
            np.concatenate([smallest, peak - up], axis=1),
            np.concatenate([counted.times[..., None] * lives[:, 0], starts], axis=1),
        )

    def _damage(self, numbers: Array, ends: _Ends) -> Array:
        """Miner's sums of all parts with slopes (parts, designs, 1 + directions)."""
        largest, smallest, count = (x[..., 0][self._load] for x in ends)
        kept, unused = [], count == 0  # loads and designs may have fewer cycles than others
        for x in (largest, smallest):
            slack = unused | (self._tension[:, None, None] & (x < 0))
            x[slack] = 0.0
            kept.append(~slack)
        steep = numbers.shape[2] > 1
        metal = self._metal_damage(largest, smallest, numbers[..., 0], steep=steep)
        bolts = slice(self._metal, None)
        # the life of a bolt falls with the third power of the load (`endurance.bolt_cycles`)
        pulse = (largest - smallest)[bolts]
        life = numbers[self._life, :, 0][:, None]
        cube = pulse**3 / life
        each = np.concatenate([metal[..., 0], cube])
        result = np.zeros((len(self._load), *numbers.shape[1:]))
        result[..., 0] = (count * each).sum(axis=1)
        if not steep:
            return result
        square = 3 * pulse**2 / life
        by_end = (
            np.concatenate([metal[..., 1], square]),
            np.concatenate([metal[..., 2], -square]),
        )
        by_input = [each, *(count * x * some for x, some in zip(by_end, kept, strict=True))]
        factors = np.concatenate(by_input, axis=1)
        steps = np.concatenate(
            [x[..., 1:] for x in (ends.times, ends.largest, ends.smallest)], axis=1
        )
        for load in range(len(self._loads)):
            parts = self._load == load
            result[parts, :, 1:] = _summed(factors[parts], steps[load])
        for rows, some, slopes in (
            (self._stress, slice(self._metal), metal[..., 3:]),
            (self._life[None], bolts, (-cube / life)[..., None]),
        ):
            sums = np.einsum("pcn,pcnk->kpn", count[some], slopes)
            result[some, :, 1:] += np.einsum("kpn,kpnd->pnd", sums, numbers[rows][..., 1:])
        return result

    def _metal_damage(
        self, largest: Array, smallest: Array, values: Array, *, steep: bool
    ) -> Array:
        """Damage of every counted cycle of metal parts (parts, cycles, designs, 1 + inputs).

        Behind it, if `steep`, are its slopes by the inputs `_LOCAL`.
        """
        shape = largest[: self._metal].shape
        points = np.empty((*shape, len(_LOCAL)))
        points[..., 0], points[..., 1] = largest[: self._metal], smallest[: self._metal]
        points[..., 2:] = values[self._stress].transpose(1, 2, 0)[:, None]
        seeds = np.eye(len(_LOCAL))[None] if steep else np.zeros((1, len(_LOCAL), 0))
        found = self._damage_of.duals(np.empty((1, 0)), points.reshape(-1, len(_LOCAL)), seeds)
        return found.reshape(*shape, -1)


def _changes(high: Array, low: Array, starts: Array) -> _Ends:
    """Cycles from the smallest to the largest load of all duty cycles, one for every start.

    Loads are (loads, duty cycles, designs, 1 + directions), starts the same for all loads.
    """
    most = np.argmax(starts[..., 0], axis=0)
    starts = starts[most, np.arange(starts.shape[1])]
    high = np.take_along_axis(high, np.argmax(high[..., :1], axis=1)[:, None], axis=1)
    low = np.take_along_axis(low, np.argmin(low[..., :1], axis=1)[:, None], axis=1)
    return _Ends(high, low, np.broadcast_to(starts, high.shape))


def _summed(factors: Array, steps: Array) -> Array:
    """Sums over cycles (parts, designs, directions).

    Factors are (parts, cycles, designs), steps (cycles, designs, directions).
    """
    sums: Array = np.matmul(factors.transpose(2, 0, 1), steps.transpose(1, 0, 2))
    return sums.transpose(1, 0, 2)


def _damage_of(points: Array) -> Array:
    """Damage of single cycles of stress (1, cycles) from numbers `_LOCAL` (numbers, cycles)."""
    largest, smallest, span, offset, slope, ultimate, limit, limit_cycles = points
    cycles = endurance.basquin_cycles(
        amplitude=endurance.reversed_amplitude(
            amplitude=span * (largest - smallest) / 2,
            mean=offset + slope * (largest + smallest) / 2,
            ultimate_strength=ultimate,
        ),
        ultimate_strength=ultimate,
        fatigue_limit=limit,
        limit_cycles=limit_cycles,
    )
    damage: Array = (1 / cycles)[None]
    return damage
