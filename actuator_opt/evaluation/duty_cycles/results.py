"""Results of the duty cycles of many designs: sums, extremes, fatigue and wear, with slopes.

Every result is a function of the numbers of a design (see `numbers`). Sums over the motion are
taken interval by interval between positions, sums over time by the trapezoid rule, so that the
energy balance closes for any sampling. An extreme is never smoothed: a cycle is divided into
windows of time, and the worst two samples of each window are separate results.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ...base.numeric import STEP, Array, over_time, over_travel
from ...base.quantities import Sense
from ...design.cycle_record import CycleRecord
from ...models import heat_transfer, supply_sizing, wear
from ..values import Values
from .fatigue import CycleFatigue
from .numbers import CYCLE, Numbers, SamplePlan
from .samples import SampleModel, SampleResults, complexed, leakage_at_rest

WINDOWS = 8
"""Windows of time of all cycles together (our choice). The extremes in each window are separate
limits of the optimiser."""
MOST_SAMPLES = 400_000
"""Samples, counted in every direction of every design, that are computed together: 150 bytes each,
to bound memory."""
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


def _firsts(points: Array) -> npt.NDArray[np.intp]:
    """First columns of the groups with equal real parts."""
    new = np.append(True, (points.real[:, 1:] != points.real[:, :-1]).any(axis=0))
    return np.flatnonzero(new)


def width_of(points: Array) -> int | None:
    """Size of the groups of columns with equal real parts; None if they differ in size."""
    sizes = np.diff(np.append(_firsts(points), points.shape[1]))
    return int(sizes[0]) if (sizes == sizes[0]).all() else None


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
        lives = [cycle for cycle in records if f"{cycle}|repeats" in self._row]
        self._fatigue = CycleFatigue(plan, lives, self._row)
        count = max(LEAST_WINDOWS, WINDOWS // len(records))
        self._models: dict[tuple[str | bool, ...], SampleModel] = {}
        self._cycles: dict[str, _Cycle] = {}
        places: list[Place] = []
        for name, record in records.items():
            cycle = self._cycle(name, record, count, (phases or {}).get(name, ()))
            self._cycles[name] = cycle
            places += [Place(name, *key) for key in cycle.keys]
        places += [Place(*key) for key in self._fatigue.keys]
        self.places = (*places, Place("", "rest_leakage"))

    def _cycle(self, name: str, record: CycleRecord, count: int, phases: Sequence[float]) -> _Cycle:
        columns = [record.motion, record.load, record.speed]
        titles = ["=motion", "=load", "=rate"]
        if record.supply_pressure is not None:
            columns.append(record.supply_pressure)
            titles.append("=supply")
        linked = name in self.plan.linked
        model = self._models.setdefault(
            (linked, *titles), SampleModel(self.plan, (*self.common, *CYCLE), titles, linked)
        )
        order = [self._row[key] for key in self.common]
        order += [self._row[f"{name}|{key}"] for key in CYCLE]
        return _Cycle(self.plan, record, model, np.stack(columns, axis=1), order, count, phases)

    def __call__(
        self, points: Array, width: int | None = None, wanted: Array | None = None
    ) -> Array:
        """Results (places, k) at numbers (numbers, k), real or complex.

        Parameters
        ----------
        points : the numbers
        width : number of neighbouring complex columns that are directions of one design; None:
            those with equal real parts
        wanted : whether each result is wanted (places,); others may be 0. None: all
        """
        directions = 0
        if np.iscomplexobj(points):
            width = width or width_of(points)
            if width is None:  # different numbers of directions
                parts = np.split(points, _firsts(points)[1:], axis=1)
                rows = [self(part, part.shape[1], wanted) for part in parts]
                return np.concatenate(rows, axis=1)
            directions = width
        values = points.real[:, :: max(directions, 1)]
        seeds = np.zeros((*values.shape, 0))
        if directions:
            seeds = points.imag.reshape(*values.shape, directions) / STEP
        longest = max(len(record.time) for record in self.records.values())
        most = max(1, MOST_SAMPLES // (longest * (1 + directions)))
        with np.errstate(all="ignore"):
            rows = [
                self._results(values[:, at : at + most], seeds[:, at : at + most], wanted)
                for at in range(0, values.shape[1], most)
            ]
        return rows[0] if len(rows) == 1 else np.concatenate(rows, axis=1)

    def tracks(self, values: Array) -> dict[str, SampleResults]:
        """Results of all samples of every cycle, at numbers (numbers, designs)."""
        seeds = np.zeros((*values.shape, 0))
        return {name: cycle.track(values, seeds) for name, cycle in self._cycles.items()}

    def _results(self, values: Array, seeds: Array, wanted: Array | None) -> Array:
        """Results (places, columns) at values (numbers, designs)."""
        wanted = np.ones(len(self.places), dtype=bool) if wanted is None else wanted
        numbers = values
        if seeds.shape[2]:
            numbers = (values[:, :, None] + 1j * STEP * seeds).reshape(len(values), -1)
        blocks: list[Array] = []
        tracks: dict[str, SampleResults] = {}
        first = 0
        for name, cycle in self._cycles.items():
            tracks[name] = cycle.track(values, seeds)
            u = dict(zip((*self.common, *CYCLE), numbers[cycle.order], strict=True))
            own = wanted[first : first + len(cycle.keys)]
            blocks.append(cycle.results(u, tracks[name], own))
            first += len(cycle.keys)
        u = dict(zip(self.names, numbers, strict=True))
        if wanted[first:-1].any():
            blocks.append(self._fatigue.damages(numbers, tracks))
        else:
            blocks.append(np.zeros((len(self._fatigue.keys), numbers.shape[1])))
        blocks.append(np.reshape(leakage_at_rest(self.plan, u), (1, -1)))
        return np.concatenate(blocks)


class _Block(NamedTuple):
    """Results that are computed together: number of rows, and their function."""

    rows: int
    results: Callable[[Numbers, SampleResults], Array]


class _Cycle:
    """Results of one cycle except fatigue, and the keys (name, place) of their rows."""

    def __init__(
        self,
        plan: SamplePlan,
        record: CycleRecord,
        model: SampleModel,
        data: Array,
        order: Sequence[int],
        count: int,
        phases: Sequence[float],
    ) -> None:
        self.plan, self.record, self.model, self.phases = plan, record, model, tuple(phases)
        self.data, self.order = data, list(order)
        self.extremes = {k: v for k, v in EXTREMES.items() if plan.valve or k != "opening"}
        self.windows, self.whole = windows_of(record, count), windows_of(record, 1)
        labels = [ring.label for ring in plan.rings]
        sums = [(name, "") for name in SUMS]
        seals = [(name, label) for name in SEAL_SUMS for label in labels]
        extremes = [(name, place) for name in self.extremes for place in _ranked(self.windows)]
        ends = [(name, place) for name in ENDS for place in _ranked(self.whole)]
        pv = [("pv", f"{label}|{place}") for label in labels for place in _ranked(self.windows)]
        self.keys: list[tuple[str, str]] = [*sums, *seals, *extremes, *ends, *pv]
        self._blocks = (
            _Block(len(sums), self._sums),
            _Block(len(seals), self._seal_sums),
            _Block(
                len(extremes),
                lambda u, track: self._worst(self.extremes, self.windows, track),
            ),
            _Block(len(ends), lambda u, track: self._worst(ENDS, self.whole, track)),
            _Block(len(pv), self._pressure_times_speed),
        )

    def track(self, values: Array, seeds: Array) -> SampleResults:
        """Results of all samples."""
        return self.model.run(values[self.order], seeds[self.order], self.data)

    def results(self, u: Numbers, track: SampleResults, wanted: Array) -> Array:
        """All results (keys, columns); 0 in blocks without a wanted result."""
        columns = track.shape[0] * track.shape[1]
        parts = np.split(wanted, np.cumsum([block.rows for block in self._blocks])[:-1])
        blocks = [
            block.results(u, track) if part.any() else np.zeros((block.rows, columns))
            for block, part in zip(self._blocks, parts, strict=True)
        ]
        return np.concatenate(blocks)

    def _sums(self, u: Numbers, track: SampleResults) -> Array:
        time = self.record.time[:, None] * u["time_scale"]
        total = self._total_flow(track.array("flow"))
        most = np.argmax(total.flow.real, axis=0)[None]
        ripple = supply_sizing.ripple_volume(
            time=total.time[:, None] * u["time_scale"], flow=total.flow
        )
        sums = sums_of(u, time, track, closed=self.record.closed) | {
            "ripple_volume": ripple.volume,
            "flow_total": np.take_along_axis(total.flow, most, axis=0)[0],
        }
        return np.stack(np.broadcast_arrays(*(sums[name] for name in SUMS)))

    def _total_flow(self, flow: Array) -> supply_sizing.FlowHistory:
        """Flow of all actuators on the supply; the others run the same cycle later or earlier."""
        time = self.record.time
        if not self.phases:
            return supply_sizing.FlowHistory(time, flow)
        phases = (0.0, *self.phases)
        count = len(phases)
        return supply_sizing.total_flow(times=[time] * count, flows=[flow] * count, phases=phases)

    def _seal_sums(self, u: Numbers, track: SampleResults) -> Array:
        """Severity and friction energy of every seal."""
        x = track.array("position")
        count = range(len(self.plan.rings))
        rows = [
            wear.cycle_severity(contact_pressure=track.array(f"contact{i}"), position=x)
            for i in count
        ]
        rows += [over_travel(track.array(f"friction{i}"), x) for i in count]
        return np.stack(rows) if rows else np.empty((0, x.shape[1]))

    def _worst(
        self, extremes: Mapping[str, tuple[str, Sense]], windows: TimeWindows, track: SampleResults
    ) -> Array:
        """Extremes in windows, name by name."""
        outputs = np.array([track.outputs.index(output) for output, _ in extremes.values()])
        signs = np.array([1.0 if sense == "min" else -1.0 for _, sense in extremes.values()])
        rows = windows.least(track.values[..., 0][:, outputs] * signs[:, None])
        designs = np.arange(track.shape[0])
        picked = complexed(track.values[rows, outputs[:, None, None], designs])
        return picked.reshape(rows.shape[0] * rows.shape[1], -1)

    def _pressure_times_speed(self, u: Numbers, track: SampleResults) -> Array:
        """Largest contact pressure times speed of every seal, in windows."""
        blocks = []
        for i in range(len(self.plan.rings)):
            product = wear.pressure_velocity(
                contact_pressure=track.array(f"contact{i}"), speed=track.array("speed")
            )
            rows = self.windows.least(-product.real[:, None, :: track.shape[1]])[0]
            rows = np.repeat(rows, track.shape[1], axis=1)
            blocks.append(np.take_along_axis(product, rows, axis=0))
        return np.concatenate(blocks) if blocks else np.empty((0, track.array("speed").shape[1]))


SUMS = (
    "duration", "way", "volume", "supply_energy", "leakage_energy", "work_out", "work_in",
    "friction_energy", "return_energy", "throttling_energy", "oil_volume", "position_mean",
    "inlet_heat", "inlet_volume", "ripple_volume", "flow_total", "exchange_a", "exchange_b",
)  # fmt: skip
"""Sums over a cycle."""
SEAL_SUMS = ("severity", "seal_friction_energy")
"""Sums over a cycle for each seal."""


def sums_of(u: Numbers, time: Array, track: SampleResults, *, closed: bool) -> dict[str, Array]:
    """Sums over the motion and over time."""
    x, supply = track.array("position"), track.array("supply")
    leakage, force = track.array("leakage"), track.array("force")
    dx = x[1:] - x[:-1]
    outward = dx.real > 0
    way = np.where(outward, dx, -dx)
    areas = u["area_a"], u["area_b"]
    volume = np.where(outward, *areas) * way
    work = 0.5 * (force[1:] + force[:-1]) * dx
    duration = over_time(np.ones_like(x[:, :1]), time)
    supplied = _flowing(supply, volume)
    leaked = over_time(supply * leakage, time)
    out = np.where(work.real > 0, work, 0.0).sum(axis=0)
    absorbed = -np.where(work.real < 0, work, 0.0).sum(axis=0)
    rubbed = over_travel(track.array("friction"), x)
    drained = u["drain"] * (np.where(outward, *areas[::-1]) * way).sum(axis=0)
    oil = u["area_a"] * x + u["area_b"] * (u["stroke"] - x)
    filled = volume.sum(axis=0)
    sums = {
        "duration": duration,
        "way": wear.sliding_distance(position=x),
        "volume": filled + over_time(leakage, time),
        "supply_energy": supplied + leaked,
        "leakage_energy": leaked,
        "work_out": out,
        "work_in": absorbed,
        "friction_energy": rubbed,
        "return_energy": drained,
        "throttling_energy": supplied - drained - (out - absorbed) - rubbed,
        "oil_volume": over_time(oil, time) / duration,
        "position_mean": over_time(x, time) / duration,
        "inlet_heat": _flowing(track.array("inlet_drop"), volume),
        "inlet_volume": filled,
    }
    turns = turning_points(track.real("position")[:, 0])
    return sums | _exchange(u, x, duration, turns, closed=closed)


def _flowing(values: Array, volume: Array) -> Array:
    """Sum of mean values times the volumes of the intervals."""
    return (0.5 * (values[1:] + values[:-1]) * volume).sum(axis=0)


def turning_points(position: npt.NDArray[np.float64]) -> npt.NDArray[np.intp]:
    """Indices of the first and last sample and of every reversal; samples at rest are skipped."""
    moves = np.flatnonzero(np.diff(position))
    signs = np.sign(np.diff(position)[moves])
    turns = moves[1:][signs[1:] != signs[:-1]]
    return np.concatenate([[0], turns, [len(position) - 1]])


def _exchange(
    u: Numbers, x: Array, duration: Array, turns: npt.NDArray[np.intp], *, closed: bool
) -> dict[str, Array]:
    """Flow of fresh oil into each chamber: of every stroke, what the line does not hold back.

    All designs turn at the same samples: a lever arm does not change its sign. The last stroke of
    a closed cycle may go on in its first.
    """
    strokes = x[turns[1:]] - x[turns[:-1]]
    if closed and len(strokes) > 1 and strokes[0, 0].real * strokes[-1, 0].real > 0:
        strokes = np.concatenate([strokes[:1] + strokes[-1:], strokes[1:-1]])
    flows = {}
    for chamber, sign in (("a", 1.0), ("b", -1.0)):
        filling = np.where(sign * strokes.real > 0, sign * strokes, 0.0)
        fresh = heat_transfer.exchanged_volume(
            piston_area=u[f"area_{chamber}"],
            travel=filling,
            line_volume=u[f"line_volume_{chamber}"],
        )
        flows[f"exchange_{chamber}"] = fresh.sum(axis=0) / duration
    return flows


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
        keys = np.where(np.isnan(values), -np.inf, values)[self.rows]
        keys[self.repeated] = np.inf
        last = min(RANKS, keys.shape[1]) - 1
        picked = np.argpartition(keys, last, axis=1)[:, : last + 1]
        order = np.argsort(np.take_along_axis(keys, picked, axis=1), axis=1, kind="stable")
        picked = np.take_along_axis(picked, order, axis=1)
        picked = picked[:, np.minimum(np.arange(RANKS), last)]  # (windows, ranks, outputs, designs)
        windows = np.arange(len(self.rows))[:, None, None, None]
        found = self.rows[windows, picked].transpose(2, 0, 1, 3)
        return found.reshape(keys.shape[2], -1, keys.shape[3])


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
