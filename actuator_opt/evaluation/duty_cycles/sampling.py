"""Results of all samples of all duty cycles of a design structure, with slopes.

The samples of all cycles stand one behind the other. The model of a sample is recorded once per
design structure and run by the virtual machine for all samples and designs together; where the
machine is missing, NumPy runs it with a complex step.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ...base.dataclass import dataclass
from ...base.numeric import Array, sorted_unique
from ...base.symbolic.program import EQUAL, WIDTH
from ...base.symbolic.recorded import RecordedFunction
from ...design.cycle_record import CycleRecord
from .numbers import SamplePlan
from .samples import COLUMNS, NEIGHBOURS, sample, summands

Rows = npt.NDArray[np.intp]
WITH_SUPPLY = (*COLUMNS, "supply")
"""Columns of a cycle that states the supply pressure of every sample."""


class Padded(NamedTuple):
    """Parts of the samples of similar length, such as cycles or windows of time."""

    parts: Rows
    """Numbers of the parts."""
    rows: Rows
    """Samples (parts, samples); short parts repeat their last."""
    repeated: npt.NDArray[np.bool_]
    """Whether a sample only fills up its part."""


def padded(starts: Rows, ends: Rows) -> list[Padded]:
    """The parts from first samples to before their ends, by lengths that differ by a factor of 2.

    >>> [group.parts.tolist() for group in padded(np.array([0, 90, 100]), np.array([90, 95, 180]))]
    [[0, 2], [1]]
    """
    groups = []
    kinds = np.floor(np.log2((ends - starts).max() / (ends - starts)))
    for kind in sorted_unique(kinds):
        parts = np.flatnonzero(kinds == kind)
        first, end = starts[parts, None], ends[parts, None]
        places = first + np.arange((end - first).max())
        groups.append(Padded(parts, np.minimum(places, end - 1), places >= end))
    return groups


@dataclass(frozen=True)
class SampleResults:
    """Results of samples, without slopes."""

    values: npt.NDArray[np.float64]
    """(samples, known outputs, designs)"""
    outputs: tuple[str, ...]
    known: Array
    """Whether each output was computed (outputs,)."""

    @cached_property
    def columns(self) -> Rows:
        """Place of each output among the known; meaningless for others."""
        return np.cumsum(self.known) - 1

    def real(self, name: str) -> npt.NDArray[np.float64]:
        """A known result at all samples (samples, designs)."""
        return self.values[:, self.columns[self.outputs.index(name)]]


class NearSamples(NamedTuple):
    """Results with slopes at some samples."""

    values: Array
    """(samples, known outputs, designs, 1 + directions)"""
    places: Rows
    """Place of each sample of all cycles among `values`; meaningless for samples left out."""
    track: SampleResults

    def at(self, outputs: Array | int, rows: Rows) -> Array:
        """Known outputs (..., designs, 1 + directions) at samples (..., designs)."""
        column = self.track.columns[outputs]
        picked: Array = self.values[self.places[rows], column, np.arange(rows.shape[-1])]
        return picked


class Inputs:
    """Numbers of every cycle of some designs with slopes, as the machine takes them.

    Parameters
    ----------
    numbers : (cycles, numbers, designs, 1 + directions)

    Attributes
    ----------
    values : (designs, cycles, numbers)
    seeds : slopes in the active directions, in which some number changes, filled up to a multiple
        of `WIDTH` (designs, cycles, numbers, width)
    shape : designs, and 1 + directions
    """

    def __init__(self, numbers: Array) -> None:
        self.shape = numbers.shape[2:]
        self.values = np.ascontiguousarray(numbers[..., 0].transpose(2, 0, 1))
        slopes = numbers[..., 1:].transpose(2, 0, 1, 3)
        self._active = np.flatnonzero(slopes.any(axis=(0, 1, 2)))
        self._count = len(self._active)
        self.seeds = np.zeros((*self.values.shape, -(-self._count // WIDTH) * WIDTH))
        self.seeds[..., : self._count] = slopes[..., self._active]

    def of(self, cycles: Rows) -> tuple[Array, Array]:
        """Values and seeds of some cycles, those of a design together."""
        values, seeds = self.values, self.seeds
        if len(cycles) < values.shape[1]:
            values, seeds = values[:, cycles], seeds[:, cycles]
        groups = values.shape[0] * values.shape[1]
        return values.reshape(groups, -1), seeds.reshape(groups, *seeds.shape[2:])

    def spread(self, found: Array) -> Array:
        """Results with slopes in all directions (..., 1 + directions)."""
        spread = np.zeros((*found.shape[:-1], self.shape[1]))
        spread[..., 0], spread[..., 1 + self._active] = (
            found[..., 0],
            found[..., 1 : 1 + self._count],
        )
        return spread


class _Kind(NamedTuple):
    """Cycles with the same model of a sample."""

    linked: bool
    """Whether the linkage gives position and lever arm."""
    columns: tuple[str, ...]
    extending: bool | None = None
    """Direction of the rod; None: it differs between designs, or changes at a dead point."""


class SampleGroup(NamedTuple):
    """Samples with the same model."""

    kind: _Kind
    rows: Rows
    """The samples, in order."""
    cycles: Rows
    """Cycles to which they belong."""
    sizes: Rows
    """Number of samples of each of these cycles."""
    data: Array
    """Columns of the samples, and those of `NEIGHBOURS` (samples, columns)."""


class Samples:
    """The samples of all cycles, as functions of the numbers of a design.

    Parameters
    ----------
    plan : structure of the design
    records : records of the cycles by name
    names : names of the numbers of a cycle, in the order of their arrays

    Attributes
    ----------
    outputs : names of the results of a sample
    first : number of the first sample of every cycle, and of all samples (cycles + 1,)
    """

    def __init__(
        self, plan: SamplePlan, records: Mapping[str, CycleRecord], names: Sequence[str]
    ) -> None:
        self.plan, self.names = plan, tuple(names)
        sizes = [len(record.time) for record in records.values()]
        self.first = np.concatenate([[0], np.cumsum(sizes)])
        self._cycle = np.repeat(np.arange(len(sizes)), sizes)
        self._kinds = [
            _Kind(name in plan.linked, COLUMNS if x.supply_pressure is None else WITH_SUPPLY)
            for name, x in records.items()
        ]
        self._data = np.concatenate([_data(record) for record in records.values()])
        self._neighbours = np.concatenate([_neighbours(record) for record in records.values()])
        self._ends = np.array([[x.motion.min(), x.motion.max()] for x in records.values()])
        self._functions: dict[Any, RecordedFunction] = {}
        self._parts: dict[bytes, list[SampleGroup]] = {}

    @cached_property
    def outputs(self) -> tuple[str, ...]:
        """Names of the results of a sample, see `sample`."""
        one = dict.fromkeys((*self.names, *COLUMNS), np.ones(1))
        with np.errstate(all="ignore"):
            return tuple(sample(self.plan, one, one, linked=False))

    def values(
        self, inputs: Inputs, parts: Sequence[SampleGroup], wanted: Array | None = None
    ) -> SampleResults:
        """Results of all samples.

        Parameters
        ----------
        inputs : the numbers
        parts : the samples, see `parts`
        wanted : whether each output is wanted (outputs,); None: all
        """
        if wanted is None:
            wanted = np.ones(len(self.outputs), dtype=bool)
        values = np.empty((self.first[-1], wanted.sum(), inputs.shape[0]))
        for part in parts if wanted.any() else ():
            found = self._run(_results, part, inputs, wanted, sloped=False)
            values[part.rows] = found[..., 0].transpose(1, 2, 0)
        return SampleResults(values, self.outputs, wanted)

    def near(self, inputs: Inputs, track: SampleResults, rows: Sequence[Rows]) -> NearSamples:
        """The samples that are in some rows, with slopes.

        Parameters
        ----------
        inputs : the numbers
        track : results of all samples
        rows : samples
        """
        if inputs.shape[1] == 1 or not track.known.any():
            return NearSamples(track.values[..., None], np.arange(len(self._cycle)), track)
        marked = np.zeros(len(self._cycle), dtype=bool)
        for some in rows:
            marked[some] = True
        places = np.cumsum(marked) - 1
        values = np.empty((places[-1] + 1, track.known.sum(), *inputs.shape))
        for part in self._by_kind(np.flatnonzero(marked)):
            found = self._run(_results, part, inputs, track.known)
            values[places[part.rows]] = inputs.spread(found.transpose(1, 2, 0, 3))
        return NearSamples(values, places, track)

    def sums(
        self,
        inputs: Inputs,
        parts: Sequence[SampleGroup],
        wanted: Array,
        weights: Array | None = None,
    ) -> Array:
        """Sums over every cycle with slopes (sums, cycles, designs, 1 + directions).

        The sums are `SUMS` and then `SEAL_SUMS` of each seal.

        Parameters
        ----------
        inputs : the numbers
        parts : the samples, see `parts`
        wanted : whether each sum is wanted (sums,); others are 0
        weights : of the flow in its ripple volume and in its peak (2, samples, designs)
        """
        shape = inputs.shape[0], len(self._kinds), int(wanted.sum()), 1 + inputs.seeds.shape[3]
        total = np.zeros(shape)
        for part in parts:
            total[:, part.cycles] += self._run(summands, part, inputs, wanted, weights)
        sums = np.zeros((len(wanted), len(self._kinds), *inputs.shape))
        sums[wanted] = inputs.spread(total.transpose(2, 1, 0, 3))
        return sums

    def _run(
        self,
        function: Callable[..., list[Array]],
        part: SampleGroup,
        inputs: Inputs,
        wanted: Array,
        weights: Array | None = None,
        *,
        sloped: bool = True,
    ) -> Array:
        """Results at the samples of a part (designs, samples, results, 1 + active directions).

        Of the function `summands`, the sums over each cycle (designs, cycles, ...).
        """
        designs, groups = inputs.shape[0], len(part.cycles) * inputs.shape[0]
        summed = function is summands
        data = part.data if summed else part.data[:, : len(part.kind.columns)]
        own = data if designs == 1 else np.broadcast_to(data, (designs, *data.shape))
        if weights is not None:
            own = np.array(own).reshape(designs, *data.shape)
            own[:, :, -2:] = weights[:, part.rows].transpose(2, 1, 0)
        recorded = self._recorded(function, part.kind, wanted)
        values, seeds = inputs.of(part.cycles)
        group = EQUAL
        if len(part.cycles) > 1:
            group = np.repeat(np.arange(groups, dtype=np.int32), np.tile(part.sizes, designs))
        found = recorded.duals(
            values,
            own.reshape(-1, data.shape[1]),
            seeds if sloped else seeds[:, :, :0],
            groups if summed else None,
            group,
        )
        return found.reshape(designs, -1, *found.shape[1:])

    def _recorded(
        self, function: Callable[..., list[Array]], kind: _Kind, wanted: Array
    ) -> RecordedFunction:
        """The wanted results of a function of samples, as a recorded function."""
        key = (function, kind, wanted.tobytes())
        if key not in self._functions:
            columns = (*kind.columns, *NEIGHBOURS) if function is summands else kind.columns
            count, rows = len(self.names), np.flatnonzero(wanted).tolist()

            def some(points: Array) -> Array:
                u = dict(zip(self.names, points[:count], strict=True))
                s = dict(zip(columns, points[count:], strict=True))
                every = function(self.plan, u, s, linked=kind.linked, extending=kind.extending)
                first = points[0]
                xp: Any = np if type(first) is np.ndarray else first.__array_namespace__()
                return xp.stack(
                    [xp.broadcast_to(xp.asarray(every[row]), first.shape) for row in rows]
                )

            labels = [*self.names, *(f"={name}" for name in columns)]
            self._functions[key] = RecordedFunction(
                some, labels, np.ones(len(labels)), shared=count
            )
        return self._functions[key]

    def parts(self, numbers: Array) -> list[SampleGroup]:
        """All samples by model at numbers (cycles, numbers, designs).

        A program for one direction of the rod is shorter than one that selects by direction.
        """
        known = self._outward(numbers)
        key = known.tobytes()
        if key not in self._parts:
            ahead = self._data[:, COLUMNS.index("rate")] >= 0
            certain = known[self._cycle]
            self._parts[key] = [
                part._replace(kind=part.kind._replace(extending=extending))
                for extending, rows in (
                    (True, certain & ahead), (False, certain & ~ahead), (None, ~certain)
                )
                for part in self._by_kind(np.flatnonzero(rows))
            ]  # fmt: skip
        return self._parts[key]

    def _by_kind(self, rows: Rows) -> list[SampleGroup]:
        """Samples by the kind of their cycles."""
        parts = []
        for kind in dict.fromkeys(self._kinds):
            own = rows
            if len(set(self._kinds)) > 1:
                own = rows[np.array([x == kind for x in self._kinds])[self._cycle[rows]]]
            sizes = np.bincount(self._cycle[own], minlength=len(self._kinds))
            cycles, data = np.flatnonzero(sizes), self._data[own, : len(kind.columns)]
            if len(own):
                data = np.concatenate([data, self._neighbours[own]], axis=1)
                parts.append(SampleGroup(kind, own, cycles, sizes[cycles], data))
        return parts

    def _outward(self, numbers: Array) -> npt.NDArray[np.bool_]:
        """Whether the lever arm is positive all along each cycle, of all designs (cycles,)."""
        outward = numbers[:, self.names.index("arm")] > 0
        linked = np.array([kind.linked for kind in self._kinds])
        if linked.any():  # where the sine of the angle between the radii is
            offset = numbers[linked, self.names.index("angle_offset")]
            first, last = self._ends[linked].T[:, :, None] + offset
            outward[linked] = (first > 0) & (last < np.pi)
        return np.asarray(outward.all(axis=1))


def _results(*arguments: Any, **stated: Any) -> list[Array]:
    """All results of `sample`, in order."""
    return [*sample(*arguments, **stated).values()]


def _data(record: CycleRecord) -> Array:
    """Columns `WITH_SUPPLY` of all samples; the supply pressure may be missing."""
    supply = record.supply_pressure
    if supply is None:
        supply = np.full(len(record.time), np.nan)
    return np.stack([record.motion, record.load, record.speed, supply], axis=1)


def _neighbours(record: CycleRecord) -> Array:
    """Columns `NEIGHBOURS` of all samples, without the weights of the flow."""
    count = len(record.time)
    before, after = np.maximum(np.arange(count) - 1, 0), np.minimum(np.arange(count) + 1, count - 1)
    weight = 0.5 * (record.time[after] - record.time[before])
    columns = [record.motion[before], record.load[before], record.motion[after], record.load[after]]
    columns += [weight, weight / weight.sum(), np.zeros(count), np.zeros(count)]
    return np.stack(columns, axis=1)
