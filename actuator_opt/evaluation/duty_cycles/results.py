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
from .samples import SEAL_SUMS, SUMS, leakage_at_rest
from .sampling import Inputs, NearSamples, Padded, Rows, SampleResults, Samples, padded

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
        row = {name: k for k, name in enumerate(names)}
        self.common = tuple(x for x in names if "|" not in x and not x.startswith("part"))
        common = [row[key] for key in self.common]
        self._rows = np.array(
            [[*common, *(row[f"{cycle}|{key}"] for key in CYCLE)] for cycle in records]
        )
        self._samples = Samples(plan, records, (*self.common, *CYCLE))
        self._supplies = [
            SupplyWeights(x.time, (phases or {}).get(k, ())) for k, x in records.items()
        ]
        self._strokes = _strokes_of([*records.values()], self._samples.first)
        outputs, labels = self._samples.outputs, [ring.label for ring in plan.rings]
        extremes = _extremes(EXTREMES, outputs)
        extremes += [
            (("pv", label), outputs.index(f"pv{i}"), -1.0) for i, label in enumerate(labels)
        ]
        count = max(LEAST_WINDOWS, WINDOWS // len(records))
        self._extremes = [
            (extremes, windows_of([*records.values()], count)),
            (_extremes(ENDS, outputs), windows_of([*records.values()], 1)),
        ]
        sums = [(name, "") for name in SUMS] + [(name, x) for name in SEAL_SUMS for x in labels]
        groups = [
            [Place(cycle, *key) for key in sums for cycle in records],
            [Place(cycle, key) for key in EXCHANGE for cycle in records],
        ]
        groups += [
            [
                Place([*records][k], name, f"{label}|{place}" if label else place)
                for (name, label), _, _ in some
                for k, place in windows.ranked
            ]
            for some, windows in self._extremes
        ]
        repeated = [k for k, name in enumerate(records) if f"{name}|repeats" in row]
        self._fatigue = CycleFatigue(plan, [*records], repeated, row, outputs, self._samples.first)
        groups.append([Place(*key) for key in self._fatigue.keys])
        self.places = (*(place for group in groups for place in group), Place("", "rest_leakage"))
        self._sizes = [len(group) for group in groups]
        self._needs = self._outputs_needed()
        self._selections: dict[bytes, _Selection] = {}

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
        selection = self._selection(wanted)
        most = max(1, MOST_SAMPLES // int(self._samples.first[-1]))
        blocks = []
        with np.errstate(all="ignore"):
            for at in range(0, count, most):
                blocks.append(self._results(numbers[:, at : at + most], selection))
        return blocks[0] if len(blocks) == 1 else np.concatenate(blocks, axis=1)

    def tracks(self, values: Array) -> dict[str, SampleResults]:
        """Results of all samples of every cycle, at numbers (numbers, designs)."""
        own = values[self._rows]
        track = self._samples.values(Inputs(own[..., None]), self._samples.parts(own))
        return {
            name: SampleResults(track.values[a:b], track.outputs, track.known)
            for name, (a, b) in zip(self.records, pairwise(self._samples.first), strict=True)
        }

    def _outputs_needed(self) -> npt.NDArray[np.bool_]:
        """Whether each result needs each output at all samples (places, outputs)."""
        outputs, ends = self._samples.outputs, np.cumsum([0, *self._sizes])
        needs = np.zeros((len(self.places), len(outputs)), dtype=bool)
        for k in FLOW_SUMS:
            cycles = len(self.records)
            needs[k * cycles : (k + 1) * cycles, outputs.index("flow")] = True
        needs[ends[1] : ends[2], outputs.index("position")] = True
        for (extremes, windows), first in zip(self._extremes, ends[2:], strict=False):
            for k, (_, place, _) in enumerate(extremes):
                size = len(windows.ranked)
                needs[first + k * size : first + (k + 1) * size, place] = True
        for output in self._fatigue.outputs:
            needs[ends[4] : ends[5], outputs.index(output)] = True
        return needs

    def _selection(self, wanted: Array | None) -> _Selection:
        """Outputs, sums and samples for the wanted results (places,); None: all. Cached."""
        if wanted is None:
            wanted = np.ones(len(self.places), dtype=bool)
        key = wanted.tobytes()
        if key not in self._selections:
            sums, exchange, *picked, damage, rest = np.split(wanted, np.cumsum(self._sizes))
            taken = []
            for (extremes, windows), some in zip(self._extremes, picked, strict=True):
                kept = np.asarray(some.reshape(len(extremes), -1).any(axis=1))
                outputs = np.array([output for _, output, _ in extremes])[kept]
                signs = np.array([sign for _, _, sign in extremes])[kept]
                taken.append(_Taken(windows, kept, outputs, signs))
            self._selections[key] = _Selection(
                np.asarray(self._needs[wanted].any(axis=0)),
                np.asarray(sums.reshape(-1, len(self.records)).any(axis=1)),
                bool(exchange.any()),
                taken,
                damage,
                bool(rest.any()),
            )
        return self._selections[key]

    def _results(self, numbers: Array, selection: _Selection) -> Array:
        """Results of `duals` of designs that are computed together."""
        own = numbers[self._rows]  # (cycles, numbers, designs, 1 + directions)
        inputs, parts = Inputs(own), self._samples.parts(own[..., 0])
        track = self._samples.values(inputs, parts, selection.needed)
        picks = [taken.rows(track) for taken in selection.extremes]
        counted = self._fatigue.counted(track) if selection.damage.any() else []
        rows = [*picks, *(spots for part in counted for spots in part.rows)]
        if selection.exchange:
            rows += [self._strokes.start, self._strokes.end]
        near = self._samples.near(inputs, track, rows)
        shape = numbers.shape[1:]
        blocks = []
        if selection.sums.any():
            weights = None
            if selection.sums[FLOW_SUMS].any():
                weights = self._weights(track.real("flow"))
            blocks.append(self._samples.sums(inputs, parts, selection.sums, weights))
        else:
            blocks.append(np.zeros((self._sizes[0], *shape)))
        exchanged = np.zeros((self._sizes[1], *shape))
        blocks.append(self._exchange(own, near) if selection.exchange else exchanged)
        for taken, pick, size in zip(selection.extremes, picks, self._sizes[2:], strict=False):
            block = np.zeros((taken.kept.size, size // max(taken.kept.size, 1), *shape))
            if len(pick):
                block[taken.kept] = near.at(taken.outputs[:, None, None], pick)
            blocks.append(block)
        if counted:
            blocks.append(self._fatigue.damages(numbers, counted, near, selection.damage))
        else:
            blocks.append(np.zeros((self._sizes[4], *shape)))
        rest = np.zeros((1, *shape))
        if selection.rest:
            columns = complexed(numbers) if shape[1] > 1 else numbers[:, :, 0]
            u = dict(zip(self.names, columns, strict=True))
            leakage = np.broadcast_to(leakage_at_rest(self.plan, u), (1, columns.shape[1]))
            rest = duals_of(leakage, shape[1] - 1) if shape[1] > 1 else leakage[:, :, None]
        return np.concatenate([block.reshape(-1, *shape) for block in (*blocks, rest)])

    def _weights(self, flow: Array) -> Array:
        """Weights (2, samples, designs) of the flow in ripple volume and peak flow."""
        parts = np.split(flow, self._samples.first[1:-1])
        weights = [supply.weights(part) for supply, part in zip(self._supplies, parts, strict=True)]
        return np.stack([np.concatenate(part) for part in zip(*weights, strict=True)])

    def _exchange(self, own: Array, near: NearSamples) -> Array:
        """Flow of fresh oil into each chamber: of every stroke, what the line does not hold back.

        All designs turn at the same samples: a lever arm does not change its sign.

        Parameters
        ----------
        own : numbers of every cycle with slopes (cycles, numbers, designs, 1 + directions)
        near : samples with slopes, the turning points among them

        Returns
        -------
        (chambers * cycles, designs, 1 + directions)
        """
        strokes, (designs, size) = self._strokes, own.shape[2:]
        output = self._samples.outputs.index("position")
        start, end = (
            near.at(output, np.broadcast_to(rows[:, None], (len(rows), designs)))
            for rows in (strokes.start, strokes.end)
        )
        travel = (end - start).transpose(1, 0, 2)
        place = self._samples.names.index
        points = np.empty((len(EXCHANGE), *travel.shape[:2], len(_STROKE), size))
        for k, (chamber, outward) in enumerate((("a", 1.0), ("b", -1.0))):
            used = [place(f"area_{chamber}"), place(f"line_volume_{chamber}"), place("time_scale")]
            points[k, :, :, 0] = outward * travel
            points[k, :, :, 1:] = own[:, used][strokes.cycle].transpose(2, 0, 1, 3)
        points[:, :, :, 3] *= strokes.period[strokes.cycle][:, None]
        flat = points.reshape(-1, len(_STROKE), size)
        groups = len(EXCHANGE) * designs
        cycles = len(self.records)
        group = np.arange(groups, dtype=np.int32)[:, None] * cycles + strokes.cycle
        flows = _EXCHANGE_OF.duals(
            np.empty((1, 0)), flat[:, :, 0], flat[:, :, 1:], groups * cycles,
            group.ravel().astype(np.int32),
        )  # fmt: skip
        flows = flows.reshape(len(EXCHANGE), designs, cycles, size).transpose(0, 2, 1, 3)
        return flows.reshape(-1, designs, size)


def _distinct(numbers: Array) -> tuple[Array, npt.NDArray[np.intp]]:
    """The designs with different numbers (numbers, distinct, 1), and the place of each there."""
    columns = np.ascontiguousarray(numbers[:, :, 0].T)
    known: dict[bytes, int] = {}
    place = np.array([known.setdefault(column.tobytes(), len(known)) for column in columns])
    firsts = np.zeros(len(known), dtype=np.intp)
    firsts[place[::-1]] = np.arange(len(place))[::-1]
    return numbers[:, firsts], place


class _Strokes(NamedTuple):
    """Strokes of all cycles between turning points, by cycle."""

    start: Rows
    end: Rows
    cycle: Rows
    period: Array
    """Duration of each cycle [s]."""


def _strokes_of(records: Sequence[CycleRecord], first: Rows) -> _Strokes:
    """The strokes of records whose first samples are given.

    The last stroke of a closed cycle may go on in its first.
    """
    starts, ends, cycles = [], [], []
    for k, record in enumerate(records):
        turns = turning_points(record.motion)
        start, end = turns[:-1], turns[1:]
        travel = record.motion[end] - record.motion[start]
        if record.closed and travel[0] * travel[-1] > 0:
            start, end = np.append(start[1:-1], start[-1]), np.append(end[1:-1], end[0])
        starts.append(first[k] + start)
        ends.append(first[k] + end)
        cycles.append(np.full(len(start), k))
    period = np.array([record.time[-1] - record.time[0] for record in records])
    start, end, cycle = (np.concatenate(part) for part in (starts, ends, cycles))
    return _Strokes(start, end, cycle, period)


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
        known = track.values[:, track.columns[self.outputs]]
        return self.windows.least(known * self.signs[:, None])


class _Selection(NamedTuple):
    """Outputs, sums and samples that the wanted results need."""

    needed: npt.NDArray[np.bool_]
    """Whether each output is needed at all samples (outputs,)."""
    sums: npt.NDArray[np.bool_]
    """Whether each sum is wanted of some cycle (sums,)."""
    exchange: bool
    extremes: list[_Taken]
    damage: npt.NDArray[np.bool_]
    rest: bool
    """Whether the leakage at rest is wanted."""


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
    """Windows of time of all cycles."""

    labels: tuple[str, ...]
    cycles: Rows
    """Number of the cycle of every window."""
    groups: list[Padded]
    """The windows by length."""

    @property
    def ranked(self) -> list[tuple[int, str]]:
        """Cycle and name of the results of all windows, the worst sample first."""
        words = ["", *(", next" if k == 1 else f", next {k}" for k in range(1, RANKS))]
        return [
            (cycle, label + word)
            for cycle, label in zip(self.cycles.tolist(), self.labels, strict=True)
            for word in words
        ]

    def least(self, values: npt.NDArray[np.float64]) -> npt.NDArray[np.intp]:
        """Samples of the `RANKS` least values of every window, in order.

        Values (samples, outputs, designs) give samples (outputs, windows * RANKS, designs). An
        unknown value (NaN) is the least.
        """
        _, outputs, designs = values.shape
        found = np.empty((outputs, designs, len(self.cycles), RANKS), dtype=np.intp)
        for windows, rows, repeated in self.groups:
            keys = np.take(values.transpose(1, 2, 0), rows, axis=2)
            keys[..., repeated] = np.inf  # (outputs, designs, windows, samples)
            flat, every = keys.reshape(-1, rows.shape[1]), np.arange(keys[..., 0].size)
            for rank in range(RANKS):
                place = np.argmin(flat, axis=1)  # NaN if there is any
                found[:, :, windows, rank] = rows[every % len(rows), place].reshape(keys.shape[:3])
                if rank + 1 < min(RANKS, rows.shape[1]):
                    flat[every, place] = np.inf
        return found.reshape(outputs, designs, -1).transpose(0, 2, 1)


def windows_of(records: Sequence[CycleRecord], windows: int) -> TimeWindows:
    """Windows of each record; the last sample of a closed cycle repeats its first."""
    first, labels, parts = 0, [], []
    for k, record in enumerate(records):
        time, count = record.time, len(record.time) - (1 if record.closed else 0)
        edges = np.linspace(0, count, min(windows, count) + 1).round().astype(int)
        labels += [f"{time[a]:.3g} s to {time[b - 1]:.3g} s" for a, b in pairwise(edges)]
        parts += [(k, first + a, first + b) for a, b in pairwise(edges)]
        first += len(time)
    cycles, starts, ends = np.array(parts).T
    return TimeWindows(tuple(labels), cycles, padded(starts, ends))
