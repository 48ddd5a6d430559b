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
from .numbers import LIFE, STRESS, History, SamplePlan

if TYPE_CHECKING:
    from .samples import SampleResults


MOST_KNOWN = 1000
"""Orders of reversals whose pairs are kept."""


class _Counted(NamedTuple):
    """Shares of the full pulse at the ends of counted cycles, (loads, cycles, columns)."""

    largest: Array
    smallest: Array
    count: Array
    """Number of times each occurs in a life; 0 fills up the cycles of a load."""


class CycleFatigue:
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

    def __init__(self, plan: SamplePlan, cycles: Sequence[str], rows: Mapping[str, int]) -> None:
        self.cycles, self._rows = tuple(cycles), rows
        self._known: dict[bytes, tuple[Array, Array]] = {}
        parts = sorted(enumerate(plan.parts if cycles else ()), key=lambda pair: pair[1].bolted)
        self._loads: tuple[History, ...] = tuple(dict.fromkeys(part.load for _, part in parts))
        self._load = np.array([self._loads.index(part.load) for _, part in parts], dtype=np.intp)
        self._tension = np.array([part.only_tension for _, part in parts], dtype=bool)
        self._metal = sum(not part.bolted for _, part in parts)
        self._stress = {
            key: [rows[f"part{i}.{key}"] for i, _ in parts[: self._metal]] for key in STRESS
        }
        self._life = [rows[f"part{i}.life"] for i, _ in parts[self._metal :]]
        words = (*self.cycles, "") if parts else ()
        self.keys = [(cycle, "damage", part.place) for cycle in words for _, part in parts]

    def damages(self, numbers: Array, tracks: Mapping[str, SampleResults]) -> Array:
        """Miner's sums (keys, columns) at numbers (numbers, columns)."""
        if not self.keys:
            return np.zeros((len(self.keys), numbers.shape[1]))
        loads = {
            name: [self._history(load, numbers, tracks[name]) for load in self._loads]
            for name in self.cycles
        }
        designs = next(iter(tracks.values())).shape[0]
        blocks = [
            self._damage(numbers, self._counted(name, loads[name], numbers, tracks[name]), designs)
            for name in self.cycles
        ]
        total = sum(blocks)
        if len(self.cycles) > 1:
            total = total + self._damage(numbers, self._changes(loads, numbers), designs)
        return np.concatenate([*blocks, total])

    def _counted(
        self, name: str, shares: Sequence[Array], numbers: Array, track: SampleResults
    ) -> _Counted:
        """Counted cycles of a duty cycle, and those of its starts, for each load."""
        repeats, starts = (numbers[self._rows[f"{name}|{key}"]] for key in LIFE)
        share = np.stack(shares)  # (loads, samples, columns)
        loads, columns, width = len(shares), share.shape[2], track.shape[1]
        levels = share.real[:, :, ::width].transpose(1, 0, 2)
        pairs = self._pairs(levels.reshape(len(levels), -1))

        def spread(values: Array) -> Array:
            """Values (cycles, loads x designs) as (loads, cycles, columns)."""
            wide = values.reshape(len(values), loads, -1).transpose(1, 0, 2)
            return np.repeat(wide, width, axis=2) if width > 1 else wide

        largest, smallest = (
            np.take_along_axis(share, spread(at), axis=1) for at in (pairs.largest, pairs.smallest)
        )
        high, low = _ends(share)
        peak: Array = np.where(np.abs(high.real) >= np.abs(low.real), high, low)
        up = np.where(peak.real > 0, peak, 0.0)
        begun = np.broadcast_to(starts, (loads, 1, columns))
        return _Counted(
            np.concatenate([largest, up], axis=1),
            np.concatenate([smallest, peak - up], axis=1),
            np.concatenate([spread(pairs.count) * repeats, begun], axis=1),
        )

    def _changes(self, loads: Mapping[str, Sequence[Array]], numbers: Array) -> _Counted:
        """Cycles from the smallest to the largest load of all duty cycles, one for every start."""
        starts = numbers[[self._rows[f"{name}|starts"] for name in self.cycles]]
        starts = np.take_along_axis(starts, np.argmax(starts.real, axis=0)[None], axis=0)
        high, low = _ends(np.concatenate([np.stack(shares) for shares in loads.values()], axis=1))
        return _Counted(high, low, np.broadcast_to(starts, high.shape))

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

    def _history(self, load: History, numbers: Array, track: SampleResults) -> Array:
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

    def _damage(self, numbers: Array, counted: _Counted, designs: int) -> Array:
        """Miner's sums of all parts (parts, columns)."""
        real = _Counted(*(np.real(x)[..., :: x.shape[-1] // designs] for x in counted))
        values = np.real(numbers)[:, :: numbers.shape[1] // designs]
        largest, smallest, count = (x[self._load] for x in real)
        kept = []
        for x in (largest, smallest):  # (parts, cycles, designs)
            slack = self._tension[:, None, None] & (x < 0)
            kept.append(~slack)
            x[slack] = 0.0
        each, by_largest, by_smallest, by_number = self._slopes(largest, smallest, values)
        total = (count * each).sum(axis=1)
        if not np.iscomplexobj(numbers):
            return total
        shape = (*total.shape, numbers.shape[1] // designs)
        change = np.zeros(shape)
        steps = [np.imag(x).reshape(*x.shape[:2], designs, -1) for x in counted]
        slopes = (count * by_largest * kept[0], count * by_smallest * kept[1], each)
        for slope, step in zip(slopes, steps, strict=True):
            if step.any():
                for load in range(len(self._loads)):
                    own = self._load == load
                    change[own] += np.einsum("pcd,cdn->pdn", slope[own], step[load])
        for rows, first, slope in by_number:
            if not rows:  # no part of this kind
                continue
            step = np.imag(numbers[rows]).reshape(len(rows), designs, -1)
            change[first : first + len(rows)] += (count[first : first + len(rows)] * slope).sum(
                axis=1
            )[:, :, None] * step
        result = np.repeat(total, shape[2], axis=1).astype(complex)
        result.imag = change.reshape(len(total), -1)
        return result

    def _slopes(
        self, largest: Array, smallest: Array, values: Array
    ) -> tuple[Array, Array, Array, list[tuple[list[int], int, Array]]]:
        """Damage of every counted cycle (parts, cycles, designs), and its slopes.

        The slopes are by the ends of the cycle, and by the numbers of the parts: rows of the
        numbers, first part, slope.
        """
        metal = slice(self._metal)
        part = {key: values[rows][:, None] for key, rows in self._stress.items()}
        span, middle = (largest - smallest)[metal], (largest + smallest)[metal] / 2
        stress = {
            "amplitude": part["span"] * span / 2,
            "mean": part["offset"] + part["slope"] * middle,
            **{key: part[key] for key in ("ultimate", "limit", "limit_cycles")},
        }
        each = _damage_of(stress)
        slope = {
            key: _damage_of({**stress, key: stress[key] + 1j * STEP}).imag / STEP for key in stress
        }
        swing, shift = slope["amplitude"] * part["span"] / 2, slope["mean"] * part["slope"] / 2
        by_number = [
            (self._stress["span"], 0, slope["amplitude"] * span / 2),
            (self._stress["offset"], 0, slope["mean"]),
            (self._stress["slope"], 0, slope["mean"] * middle),
            *((self._stress[key], 0, slope[key]) for key in ("ultimate", "limit", "limit_cycles")),
        ]
        # the life of a bolt falls with the third power of the load (`endurance.bolt_cycles`)
        pulse = (largest - smallest)[self._metal :]
        life = values[self._life][:, None]
        cube, square = pulse**3 / life, 3 * pulse**2 / life
        by_number.append((self._life, self._metal, -cube / life))
        return (
            np.concatenate([each, cube]),
            np.concatenate([swing + shift, square]),
            np.concatenate([shift - swing, -square]),
            by_number,
        )


def _ends(share: Array) -> tuple[Array, Array]:
    """Largest and smallest values of histories (loads, samples, columns), (loads, 1, columns)."""
    high, low = (
        np.take_along_axis(share, at(share.real, axis=1)[:, None], axis=1)
        for at in (np.argmax, np.argmin)
    )
    return high, low


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


def _turns(values: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
    """Whether samples are local extremes of repeating histories (samples, designs)."""
    before, after = np.roll(values, 1, axis=0), np.roll(values, -1, axis=0)
    turns: npt.NDArray[np.bool_] = ~((values - before) * (after - values) > 0)
    return turns
