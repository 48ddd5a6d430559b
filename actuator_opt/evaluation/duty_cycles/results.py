"""Results of the duty cycles of many designs: sums, extremes, fatigue and wear, with slopes.

Every result is a function of the numbers of a design (see `numbers`). Sums over the motion are
taken interval by interval between positions, sums over time by the trapezoid rule, so that the
energy balance closes for any sampling. An extreme is never smoothed: a cycle is divided into
windows of time, and the worst two samples of each window are separate results.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ...base.numeric import (
    Array,
    complexed,
    duals_of,
    group_starts,
    group_width,
    real,
    sorted_unique,
    where,
)
from ...base.quantities import Sense
from ...base.symbolic.recorded import RecordedFunction
from ...design.cycle_record import CycleRecord
from ...models import heat_transfer, supply_sizing
from ..values import Values
from .fatigue import CycleFatigue
from .numbers import CYCLE, SamplePlan
from .samples import (
    COLUMNS,
    SEAL_SUMS,
    SUMS,
    NearSamples,
    Part,
    SampleModel,
    SampleResults,
    leakage_at_rest,
    parts_of,
)

WINDOWS = 8
"""Windows of time of all cycles together (our choice). The extremes in each window are separate
limits of the optimiser."""
MOST_SAMPLES = 20_000
"""Samples of all designs that are computed together, so that their results stay in fast memory: ten
times as many took 1.4 times as long."""
LEAST_WINDOWS = 2
"""Windows of each cycle if there are many cycles."""
RANKS = 2
"""Samples of each window that are separate limits: the worst and the next. At an optimum two
neighbouring samples may be equally bad; one limit for both would then have a kink."""

EXTREMES: Mapping[str, tuple[str, Sense]] = {
    "share": ("share", "max"),
    "needed": ("needed", "max"),
    "reserve": ("reserve", "min"),
    "flow_peak": ("flow", "max"),
    "power_peak": ("power", "max"),
    "power_least": ("power", "min"),
    "opening": ("opening", "max"),
    "pressure_a_min": ("pressure_a", "min"),
    "pressure_b_min": ("pressure_b", "min"),
    "pressure_a_max": ("pressure_a", "max"),
    "pressure_b_max": ("pressure_b", "max"),
}
"""Extremes in every window: result of the samples, and whether its least or largest value."""
ENDS: Mapping[str, tuple[str, Sense]] = {
    "position_min": ("position", "min"),
    "position_max": ("position", "max"),
}
"""Extremes of the whole cycle: the piston has a single farthest position."""


FLOW_SUMS = [SUMS.index("ripple_volume"), SUMS.index("flow_total")]
"""Sums whose weights follow from the flow of all actuators."""
EXCHANGE = ("exchange_a", "exchange_b")
"""Flows of fresh oil into the chambers."""


class Place(NamedTuple):
    """A result of a cycle: its name, and the part, seal or window of time to which it belongs."""

    cycle: str
    name: str
    place: str = ""

    @property
    def path(self) -> str:
        """Name under which the result may stand among the values of a design."""
        return f"{RESULT}{self.cycle}|{self.name}|{self.place}"


RESULT = "result of a duty cycle|"


def results_in(v: Values) -> dict[Place, Array]:
    """Results that stand among the values of a design, because they were computed before."""
    return {
        Place(*path.removeprefix(RESULT).split("|", 2)): value
        for path, value in v.varied.items()
        if path.startswith(RESULT)
    }


class CycleModels:
    """Results of all cycles of a design structure, for any numbers.

    Parameters
    ----------
    plan : structure of the design
    records : records of the cycles by name
    names : names of the numbers, in order
    phases : delays of further actuators on the same supply by cycle, as shares of the period

    Attributes
    ----------
    places : the results, in the order of their rows
    """

    def __init__(
        self,
        plan: SamplePlan,
        records: Mapping[str, CycleRecord],
        names: Sequence[str],
        phases: Mapping[str, Sequence[float]] | None = None,
    ) -> None:
        self.plan, self.records, self.names = plan, dict(records), tuple(names)
        self._row = {name: k for k, name in enumerate(names)}
        self.common = tuple(x for x in names if "|" not in x and not x.startswith("part"))
        self._models: dict[tuple[bool, bool], SampleModel] = {}
        count = max(LEAST_WINDOWS, WINDOWS // len(records))
        self._cycles = {
            name: self._cycle(name, record, count, (phases or {}).get(name, ()))
            for name, record in records.items()
        }
        repeated = [name for name in records if f"{name}|repeats" in self._row]
        outputs = next(iter(self._models.values())).outputs
        self._fatigue = CycleFatigue(plan, repeated, self._row, outputs)
        places: list[Place] = []
        for name, cycle in self._cycles.items():
            places += [Place(name, *key) for key in cycle.keys]
        places += [Place(*key) for key in self._fatigue.keys]
        self.places = (*places, Place("", "rest_leakage"))

    def _cycle(self, name: str, record: CycleRecord, count: int, phases: Sequence[float]) -> _Cycle:
        kind = (name in self.plan.linked, record.supply_pressure is not None)
        if kind not in self._models:
            columns = (*COLUMNS, "supply") if kind[1] else COLUMNS
            self._models[kind] = SampleModel(self.plan, (*self.common, *CYCLE), columns, kind[0])
        order = [self._row[key] for key in self.common]
        order += [self._row[f"{name}|{key}"] for key in CYCLE]
        return _Cycle(self.plan, record, self._models[kind], order, count, phases)

    def __call__(
        self, points: Array, width: int | None = None, wanted: Array | None = None
    ) -> Array:
        """Results (places, k) at numbers (numbers, k), real or complex.

        Parameters
        ----------
        points : the numbers
        width : number of neighbouring complex columns that are directions of one design; None:
            those with equal real parts
        wanted : see `duals`
        """
        if not np.iscomplexobj(points):
            return self.duals(points[:, :, None], wanted)[:, :, 0]
        width = width or group_width(points)
        if width is None:  # different numbers of directions
            parts = np.split(points, group_starts(points)[1:], axis=1)
            return np.concatenate([self(part, None, wanted) for part in parts], axis=1)
        return complexed(self.duals(duals_of(points, width), wanted))

    def duals(self, numbers: Array, wanted: Array | None = None) -> Array:
        """Results with slopes (places, designs, 1 + directions) at numbers that have slopes, too.

        Parameters
        ----------
        numbers : (numbers, designs, 1 + directions)
        wanted : whether each result is wanted (places,); others may be 0. None: all
        """
        count, size = numbers.shape[1:]
        if size == 1 and count > 1:  # limits that a study changes are no numbers of a cycle
            numbers, place = _distinct(numbers)
            if numbers.shape[1] < count:
                return self.duals(numbers, wanted)[:, place]
        longest = max(len(record.time) for record in self.records.values())
        most = max(1, MOST_SAMPLES // longest)
        blocks = []
        with np.errstate(all="ignore"):
            for at in range(0, count, most):
                part = numbers[:, at : at + most]
                blocks.append(self._results(part, wanted))
        return blocks[0] if len(blocks) == 1 else np.concatenate(blocks, axis=1)

    def tracks(self, values: Array) -> dict[str, SampleResults]:
        """Results of all samples of every cycle, at numbers (numbers, designs)."""
        return {name: cycle.samples(values) for name, cycle in self._cycles.items()}

    def _results(self, numbers: Array, wanted: Array | None) -> Array:
        """Results of `duals` of designs that are computed together."""
        values, seeds = numbers[:, :, 0], numbers[:, :, 1:]
        wanted = np.ones(len(self.places), dtype=bool) if wanted is None else wanted
        ends = np.cumsum([len(cycle.keys) for cycle in self._cycles.values()])
        parts = dict(zip(self._cycles, np.split(wanted, ends), strict=False))
        fatigued = bool(wanted[ends[-1] : -1].any())
        pulses = self._fatigue.outputs if fatigued else ()
        tracks = {
            name: cycle.samples(values, cycle.needed(parts[name], pulses))
            for name, cycle in self._cycles.items()
        }
        counted = self._fatigue.counted(tracks) if fatigued else {}
        blocks: list[Array] = []
        near: dict[str, NearSamples] = {}
        for name, cycle in self._cycles.items():
            more = counted[name].rows if name in counted else ()
            rows, near[name] = cycle.results(values, seeds, tracks[name], parts[name], more)
            blocks.append(rows)
        shape = (values.shape[1], 1 + seeds.shape[2])
        if counted:
            some = wanted[ends[-1] : -1]
            blocks.append(self._fatigue.damages(values, seeds, counted, near, some))
        else:
            blocks.append(np.zeros((len(self._fatigue.keys), *shape)))
        rest = np.zeros((1, *shape))
        if wanted[-1]:
            columns = complexed(numbers) if seeds.size else values
            u = dict(zip(self.names, columns, strict=True))
            leakage = np.broadcast_to(leakage_at_rest(self.plan, u), (1, columns.shape[1]))
            rest = duals_of(leakage, shape[1] - 1) if seeds.size else leakage[:, :, None]
        return np.concatenate([*blocks, rest])


def _distinct(numbers: Array) -> tuple[Array, npt.NDArray[np.intp]]:
    """The designs with different numbers (numbers, distinct, 1), and the place of each there."""
    columns = np.ascontiguousarray(numbers[:, :, 0].T)
    known: dict[bytes, int] = {}
    place = np.array([known.setdefault(column.tobytes(), len(known)) for column in columns])
    firsts = np.zeros(len(known), dtype=np.intp)
    firsts[place[::-1]] = np.arange(len(place))[::-1]
    return numbers[:, firsts], place


class _Cycle:
    """Results of one cycle except fatigue, and the keys (name, place) of their rows."""

    def __init__(
        self,
        plan: SamplePlan,
        record: CycleRecord,
        model: SampleModel,
        order: Sequence[int],
        count: int,
        phases: Sequence[float],
    ) -> None:
        self.record, self.model, self.order = record, model, list(order)
        self._supply = SupplyWeights(record.time, phases)
        self._data = _data(record)
        self._wide = np.concatenate([self._data, _neighbours(record)], axis=1)
        self._range = record.motion.min(), record.motion.max()
        self._parts: dict[int, tuple[list[Part], list[Part]]] = {}
        self._turns = turning_points(record.motion)
        self.windows, self.whole = windows_of(record, count), windows_of(record, 1)
        labels = [ring.label for ring in plan.rings]
        self._extremes = _extremes(EXTREMES, model.outputs)
        self._extremes += [
            (("pv", label), model.outputs.index(f"pv{i}"), -1.0) for i, label in enumerate(labels)
        ]
        self._ends = _extremes(ENDS, model.outputs)
        sums = [(name, "") for name in SUMS] + [(name, x) for name in SEAL_SUMS for x in labels]
        exchange = [(name, "") for name in EXCHANGE]
        self.keys: list[tuple[str, str]] = [*sums, *exchange]
        self._sizes = [len(sums), len(exchange)]
        for extremes, windows in self._blocks:
            ranked = _ranked(windows)
            for (name, label), _, _ in extremes:
                self.keys += [(name, f"{label}|{place}" if label else place) for place in ranked]
            self._sizes.append(len(extremes) * len(ranked))
        self._needs = self._outputs_needed()
        self._selections: dict[bytes, _Selection] = {}
        place = model.names.index
        self._stroke = np.array(
            [[place(f"area_{x}"), place(f"line_volume_{x}"), place("time_scale")] for x in "ab"]
        )

    def _outputs_needed(self) -> npt.NDArray[np.bool_]:
        """Whether each result needs each output at all samples (keys, outputs)."""
        outputs, ends = self.model.outputs, np.cumsum(self._sizes)
        needs = np.zeros((len(self.keys), len(outputs)), dtype=bool)
        needs[FLOW_SUMS, outputs.index("flow")] = True
        needs[ends[0] : ends[1], outputs.index("position")] = True
        for (extremes, _), first, last in zip(self._blocks, ends[1:], ends[2:], strict=False):
            rows = np.arange(first, last)
            places = [output for _, output, _ in extremes]
            needs[rows, np.repeat(places, len(rows) // len(places))] = True
        return needs

    @property
    def _blocks(self) -> tuple[tuple[list[Extreme], TimeWindows], ...]:
        return (self._extremes, self.windows), (self._ends, self.whole)

    def needed(self, wanted: Array, more: Sequence[str]) -> Array:
        """Whether each output is needed for the wanted results, or among `more` (outputs,)."""
        needed = self._selection(wanted).needed.copy()
        needed[[self.model.outputs.index(name) for name in more]] = True
        return needed

    def _selection(self, wanted: Array) -> _Selection:
        """Outputs, sums and extremes that the wanted results need; cached."""
        key = wanted.tobytes()
        if key not in self._selections:
            sums, exchange, *picked = np.split(wanted, np.cumsum(self._sizes[:-1]))
            taken = []
            for (extremes, windows), some in zip(self._blocks, picked, strict=True):
                kept = np.asarray(some.reshape(len(extremes), -1).any(axis=1))
                outputs = np.array([output for _, output, _ in extremes])[kept]
                signs = np.array([sign for _, _, sign in extremes])[kept]
                taken.append(_Taken(windows, kept, outputs, signs))
            needed = np.asarray(self._needs[wanted].any(axis=0))
            self._selections[key] = _Selection(needed, sums, bool(exchange.any()), taken)
        return self._selections[key]

    def samples(self, values: Array, wanted: Array | None = None) -> SampleResults:
        """Results of all samples at values (all numbers, designs); None: all outputs."""
        numbers = values[self.order]
        if wanted is None:
            wanted = np.ones(len(self.model.outputs), dtype=bool)
        parts = self._parted(numbers)[0]
        found = self.model.results(numbers, parts, np.zeros((*numbers.shape, 0)), wanted)
        return SampleResults(found[..., 0], self.model.outputs, wanted)

    def results(
        self,
        values: Array,
        seeds: Array,
        track: SampleResults,
        wanted: Array,
        more: Sequence[Array],
    ) -> tuple[Array, NearSamples]:
        """All results (keys, designs, 1 + directions), and the samples of `more` with slopes.

        Results that are not wanted may be 0.
        """
        values, seeds = values[self.order], seeds[self.order]
        selection = self._selection(wanted)
        sums, exchange = selection.sums, selection.exchange
        picks = [taken.rows(track) for taken in selection.extremes]
        rows = [*picks, *more]
        if exchange:
            rows.append(self._turns)
        near = self._near(values, seeds, track, rows)
        shape = (values.shape[1], 1 + seeds.shape[2])
        blocks = [
            self._sums(values, seeds, track, sums)
            if sums.any()
            else np.zeros((self._sizes[0], *shape)),
            self._exchange(values, seeds, near) if exchange else np.zeros((self._sizes[1], *shape)),
        ]
        for taken, pick, size in zip(selection.extremes, picks, self._sizes[2:], strict=True):
            block = np.zeros((taken.kept.size, size // max(taken.kept.size, 1), *shape))
            if len(pick):
                block[taken.kept] = near.at(taken.outputs[:, None, None], pick)
            blocks.append(block.reshape(size, *shape))
        return np.concatenate(blocks), near

    def _near(
        self, values: Array, seeds: Array, track: SampleResults, rows: Sequence[Array]
    ) -> NearSamples:
        """The samples that are in some rows of any design, with slopes."""
        count = len(track.values)
        if not seeds.shape[2]:
            return NearSamples(track.values[..., None], np.arange(count))
        marked = np.zeros(count, dtype=bool)
        for part in rows:
            marked[part] = True
        part = parts_of(self._data[marked], side=0)  # so few that a second program takes longer
        found = self.model.results(values, part, seeds, track.known)
        return NearSamples(found, np.cumsum(marked) - 1)

    def _sums(self, values: Array, seeds: Array, track: SampleResults, wanted: Array) -> Array:
        weights = None
        if wanted[FLOW_SUMS].any():
            weights = self._supply.weights(track.real("flow"))
        parts = []
        for extending, rows, data in self._parted(values)[1]:
            every = np.broadcast_to(data, (values.shape[1], *data.shape))
            if weights is not None:
                every = every.copy()
                every[:, :, -2], every[:, :, -1] = weights.ripple[rows].T, weights.peak[rows].T
            parts.append(Part(extending, rows, every))
        return self.model.sums(values, parts, seeds, wanted)

    def _parted(self, values: Array) -> tuple[list[Part], list[Part]]:
        """The samples by direction at numbers of this cycle: columns, and those of sums."""
        side = self.model.side(values, self._range)
        if side not in self._parts:
            self._parts[side] = parts_of(self._data, side), parts_of(self._wide, side)
        return self._parts[side]

    def _exchange(self, values: Array, seeds: Array, near: NearSamples) -> Array:
        """Flow of fresh oil into each chamber: of every stroke, what the line does not hold back.

        All designs turn at the same samples: a lever arm does not change its sign. The last stroke
        of a closed cycle may go on in its first.
        """
        turns = np.broadcast_to(self._turns[:, None], (len(self._turns), values.shape[1]))
        position = near.at(self.model.outputs.index("position"), turns)
        strokes = position[1:] - position[:-1]
        if self.record.closed and strokes[0, 0, 0] * strokes[-1, 0, 0] > 0:
            strokes = np.concatenate([strokes[:1] + strokes[-1:], strokes[1:-1]])
        numbers = np.concatenate([values[:, :, None], seeds], axis=2)
        shape = (len(EXCHANGE), values.shape[1], len(strokes), len(_STROKE), strokes.shape[2])
        points = np.empty(shape)  # chambers, designs, strokes, inputs, 1 + directions
        points[:, :, :, 0] = np.stack([strokes, -strokes]).transpose(0, 2, 1, 3)
        points[:, :, :, 1:] = numbers[self._stroke].transpose(0, 2, 1, 3)[:, :, None]
        points[:, :, :, 3] *= self.record.time[-1] - self.record.time[0]
        flat = points.reshape(-1, *shape[3:])
        groups = shape[0] * shape[1]
        flows = _EXCHANGE_OF.duals(np.empty((1, 0)), flat[:, :, 0], flat[:, :, 1:], groups)
        return flows.reshape(*shape[:2], shape[4])


_STROKE = ("travel", "area", "line_volume", "duration")
"""Inputs of the flow that a stroke exchanges; the travel is negative away from the chamber."""


def _exchange_of(points: Array) -> Array:
    """Flow of fresh oil by single strokes (1, strokes), from numbers (`_STROKE`, strokes)."""
    travel, area, line_volume, duration = points
    filling = where(real(travel) > 0, travel, 0.0)
    volume = heat_transfer.exchanged_volume(
        piston_area=area, travel=filling, line_volume=line_volume
    )
    flow: Array = (volume / duration)[None]
    return flow


_EXCHANGE_OF = RecordedFunction(_exchange_of, _STROKE, np.array([1.0, 1.0, 0.5, 1.0]))


Extreme = tuple[tuple[str, str], int, float]
"""Name and place of an extreme, its output, and 1 for its least or -1 for its largest value."""


def _extremes(extremes: Mapping[str, tuple[str, Sense]], outputs: Sequence[str]) -> list[Extreme]:
    """Extremes of the outputs that there are."""
    return [
        ((name, ""), outputs.index(output), 1.0 if sense == "min" else -1.0)
        for name, (output, sense) in extremes.items()
        if output in outputs
    ]


class _Taken(NamedTuple):
    """Extremes of which some result is wanted."""

    windows: TimeWindows
    kept: npt.NDArray[np.bool_]
    """Whether each extreme is taken."""
    outputs: npt.NDArray[np.intp]
    """Outputs of the extremes that are taken."""
    signs: npt.NDArray[np.float64]
    """1 for their least, -1 for their largest value."""

    def rows(self, track: SampleResults) -> npt.NDArray[np.intp]:
        """Samples of the worst values (extremes that are taken, windows and ranks, designs)."""
        if not len(self.outputs):
            return np.empty((0, 0, 0), dtype=np.intp)
        return self.windows.least(track.values[:, self.outputs] * self.signs[:, None])


class _Selection(NamedTuple):
    """Outputs, sums and extremes that the wanted results of a cycle need."""

    needed: npt.NDArray[np.bool_]
    """Whether each output is needed at all samples (outputs,)."""
    sums: npt.NDArray[np.bool_]
    exchange: bool
    extremes: list[_Taken]


def _data(record: CycleRecord) -> Array:
    """Columns of all samples."""
    columns = [record.motion, record.load, record.speed]
    if record.supply_pressure is not None:
        columns.append(record.supply_pressure)
    return np.stack(columns, axis=1)


def _neighbours(record: CycleRecord) -> Array:
    """Columns `NEIGHBOURS` of all samples, without the weights of the flow."""
    count = len(record.time)
    before, after = np.maximum(np.arange(count) - 1, 0), np.minimum(np.arange(count) + 1, count - 1)
    weight = 0.5 * (record.time[after] - record.time[before])
    columns = [record.motion[before], record.load[before], record.motion[after], record.load[after]]
    columns += [weight, weight / weight.sum(), np.zeros(count), np.zeros(count)]
    return np.stack(columns, axis=1)


class _Weights(NamedTuple):
    """Weights (samples, designs) of the flow of one actuator."""

    ripple: Array
    peak: Array


class SupplyWeights:
    """Weights of the flow of one actuator in ripple volume and peak flow of all on the supply.

    The others run the same cycle later or earlier; their flow is linear between samples. Both
    results are linear in the flow while the samples of their extremes stay the same.

    Parameters
    ----------
    time : of the samples [s]
    phases : delays of the others, as shares of the period
    """

    def __init__(self, time: Array, phases: Sequence[float]) -> None:
        period, count = time[-1] - time[0], len(time)
        delays = [phase * period for phase in (0.0, *phases)]
        own = time - time[0]
        corners = [own, *((own + delay) % period for delay in delays[1:])]
        self._count = count
        self._time = sorted_unique(np.concatenate(corners)) if phases else own
        self._actuators: list[tuple[npt.NDArray[np.intp], Array]] = []
        for delay in delays:
            moved = (self._time - delay) % period if delay else self._time
            left = np.clip(np.searchsorted(own, moved, side="right") - 1, 0, count - 2)
            share = ((moved - own[left]) / (own[left + 1] - own[left]))[:, None]
            self._actuators.append((left, share))

    def weights(self, flow: Array) -> _Weights:
        """Weights at the flow of one actuator (samples, designs)."""
        parts = ((1 - x) * flow[left] + x * flow[left + 1] for left, x in self._actuators)
        total, steps = sum(parts), np.diff(self._time)[:, None]
        ripple = supply_sizing.ripple_volume(time=self._time[:, None], flow=total)
        rows = np.arange(len(steps))[:, None]
        between = 0.5 * ((rows < ripple.largest).astype(float) - (rows < ripple.smallest))
        taken, mean = _by_sample(between * steps), _by_sample(0.5 * steps)
        taken -= mean * (taken.sum(axis=0) / mean.sum())
        peak = np.zeros_like(total)
        np.put_along_axis(peak, np.argmax(total, axis=0)[None], 1.0, axis=0)
        return _Weights(self._of_one(taken), self._of_one(peak))

    def _of_one(self, weights: Array) -> Array:
        """Weights of the flow of one actuator from those of the total flow."""
        own = np.zeros((self._count, weights.shape[1]))
        for left, share in self._actuators:
            np.add.at(own, left, (1 - share) * weights)
            np.add.at(own, left + 1, share * weights)
        return own


def _by_sample(halves: Array) -> Array:
    """Weights of samples (samples, designs) from those of half intervals."""
    weights: Array = np.zeros((len(halves) + 1, halves.shape[1]))
    weights[:-1] = halves
    weights[1:] += halves
    return weights


def turning_points(position: npt.NDArray[np.float64]) -> npt.NDArray[np.intp]:
    """Indices of the first and last sample and of every reversal; samples at rest are skipped."""
    moves = np.flatnonzero(np.diff(position))
    signs = np.sign(np.diff(position)[moves])
    turns = moves[1:][signs[1:] != signs[:-1]]
    return np.concatenate([[0], turns, [len(position) - 1]])


class TimeWindows(NamedTuple):
    """Windows of time of a cycle."""

    labels: tuple[str, ...]
    rows: npt.NDArray[np.intp]
    """Samples of every window (windows, samples); short windows repeat their last sample."""
    repeated: npt.NDArray[np.bool_]
    """Whether a sample only fills up its window."""

    def least(self, values: npt.NDArray[np.float64]) -> npt.NDArray[np.intp]:
        """Samples of the `RANKS` least values of every window, in order.

        Values (samples, outputs, designs) give samples (outputs, windows * RANKS, designs). An
        unknown value (NaN) is the least.
        """
        outputs = values.transpose(1, 2, 0)[:, :, self.rows]  # (outputs, designs, windows, samples)
        keys = np.where(np.isnan(outputs), -np.inf, outputs)
        keys[..., self.repeated] = np.inf
        ranks, every = [], np.arange(keys.size // keys.shape[-1])
        for _ in range(RANKS):
            ranks.append(np.argmin(keys, axis=-1))
            if keys.shape[-1] > 1:
                keys.reshape(-1, keys.shape[-1])[every, ranks[-1].ravel()] = np.inf
        picked = np.stack(ranks, axis=-1)  # (outputs, designs, windows, ranks)
        found: npt.NDArray[np.intp] = self.rows[np.arange(len(self.rows))[:, None], picked]
        return found.reshape(*found.shape[:2], -1).transpose(0, 2, 1)


def windows_of(record: CycleRecord, windows: int) -> TimeWindows:
    """Windows of a record; the last sample of a closed cycle repeats its first."""
    count = len(record.time) - (1 if record.closed else 0)
    edges = np.linspace(0, count, min(windows, count) + 1).round().astype(int)
    longest = int(np.diff(edges).max())
    steps = np.arange(longest)
    first, last = edges[:-1, None], edges[1:, None]
    return TimeWindows(
        tuple(f"{record.time[a]:.3g} s to {record.time[b - 1]:.3g} s" for a, b in pairwise(edges)),
        np.minimum(first + steps, last - 1),
        first + steps >= last,
    )


def _ranked(windows: TimeWindows) -> list[str]:
    """Names of the results of all windows, the worst sample first."""
    words = ["", *(", next" if k == 1 else f", next {k}" for k in range(1, RANKS))]
    return [label + word for label in windows.labels for word in words]
