"""Results of the duty cycles of many designs: sums, extremes, fatigue and wear, with slopes.

Every result is a function of the numbers of a design (see `numbers`). Sums over the motion are
taken interval by interval between positions, sums over time by the trapezoid rule, so that the
energy balance closes for any sampling. An extreme is never smoothed: a cycle is divided into
windows of time, and the worst two samples of each window are separate results.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ...base.dataclass import dataclass
from ...base.numeric import STEP, Array, real, where
from ...base.quantities import Sense
from ...design.cycle_record import CycleRecord
from ...design.duty import DutyCycle
from ..values import Values
from .fatigue import damages
from .numbers import CYCLE, Numbers, Plan
from .samples import SampleModel, leakage_at_rest

WINDOWS = 8
"""Windows of time of a cycle, in which extremes are separate limits of the optimiser (our choice).
"""
RANKS = 2
"""Samples of each window that are separate limits: the worst and the next. At an optimum two
neighbouring samples may be equally bad; one limit for both would then have a kink."""

EXTREMES: Mapping[str, tuple[str, Sense, float]] = {
    "share": ("share", "max", 1.0),
    "needed": ("needed", "max", 1.0),
    "reserve": ("reserve", "min", 1.0),
    "flow_peak": ("flow", "max", 1.0),
    "power_peak": ("power", "max", 1.0),
    "power_absorbed": ("power", "min", -1.0),
    "opening": ("opening", "max", 1.0),
    "pressure_a_min": ("pressure_a", "min", 1.0),
    "pressure_b_min": ("pressure_b", "min", 1.0),
    "pressure_a_max": ("pressure_a", "max", 1.0),
    "pressure_b_max": ("pressure_b", "max", 1.0),
    "position_min": ("position", "min", 1.0),
    "position_max": ("position", "max", 1.0),
}
"""Extremes of a cycle: result of the samples, whether its least or largest value, and a factor."""



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


class Window(NamedTuple):
    """Samples of a cycle from `first` to before `last`, and their times as text."""

    first: int
    last: int
    label: str


def results_in(v: Values) -> dict[Place, Array]:
    """Results that stand among the values of a design, because they were computed before."""
    return {
        Place(*path.removeprefix(RESULT).split("|", 2)): value
        for path, value in v.varied.items()
        if path.startswith(RESULT)
    }


@dataclass(frozen=True)
class Track:
    """Results of all samples of a cycle, with slopes in every direction.

    Arrays are (samples, 1) without directions; otherwise complex (samples, directions), whose
    imaginary parts are the slopes times the complex step.
    """

    values: npt.NDArray[np.float64]
    """(samples, outputs, 1 + directions)"""
    outputs: tuple[str, ...]

    def array(self, name: str, rows: Array | slice = slice(None)) -> Array:
        """A result at samples."""
        part = self.values[rows, self.outputs.index(name)]
        return complexed(part)

    def real(self, name: str) -> npt.NDArray[np.float64]:
        """A result at all samples, without slopes (samples,)."""
        return self.values[:, self.outputs.index(name), 0]


def complexed(part: Array) -> Array:
    """Values and slopes (..., 1 + directions) as complex numbers (..., directions)."""
    if part.shape[-1] == 1:
        return part
    result = np.empty((*part.shape[:-1], part.shape[-1] - 1), dtype=complex)
    result.real = part[..., :1]
    result.imag = STEP * part[..., 1:]
    return result


class CycleModels:
    """Results of all cycles of a design structure, for any numbers.

    Parameters
    ----------
    plan : structure of the design
    cycles : the cycles with their records
    names : names of the numbers, in order
    """

    def __init__(self, plan: Plan, cycles: Sequence[DutyCycle], names: Sequence[str]) -> None:
        self.plan, self.cycles, self.names = plan, tuple(cycles), tuple(names)
        self.common = tuple(name for name in names if "|" not in name)
        self._models: dict[tuple[str, ...], SampleModel] = {}
        self._data: dict[str, npt.NDArray[np.float64]] = {}
        self.places: tuple[Place, ...] = ()

    def __call__(self, points: Array) -> Array:
        """Results (places, k) at numbers (numbers, k), real or complex."""
        stepped = np.iscomplexobj(points)
        new = np.append(True, (points.real[:, 1:] != points.real[:, :-1]).any(axis=0))
        parts = []
        for part in np.split(points, np.flatnonzero(new)[1:], axis=1):
            seeds = part.imag / STEP if stepped else np.zeros((len(part), 0))
            with np.errstate(all="ignore"):
                results = self._results(part.real[:, 0], seeds)
            self.places = tuple(results)
            rows = np.stack([np.ravel(value) for value in results.values()])
            parts.append(np.broadcast_to(rows, (len(rows), part.shape[1])))
        return np.concatenate(parts, axis=1)

    def _results(self, values: Array, seeds: Array) -> dict[Place, Array]:
        """Results at one design, each (1,) or complex (directions,)."""
        numbers = dict(zip(self.names, _stepped(values, seeds), strict=True))
        results: dict[Place, Array] = {}
        tracks = {}
        for cycle in self.cycles:
            track = self.track(cycle, values, seeds)
            tracks[cycle.name] = track
            own = {name: numbers[name] for name in self.common}
            own |= {name: numbers[f"{cycle.name}|{name}"] for name in CYCLE}
            for name, value in cycle_results(self.plan, own, cycle, track).items():
                results[Place(cycle.name, *name)] = value
        results |= {
            Place(*key): value
            for key, value in damages(self.plan, numbers, self.cycles, tracks).items()
        }
        results[Place("", "rest_leakage")] = leakage_at_rest(self.plan, numbers)
        return results

    def track(self, cycle: DutyCycle, values: Array, seeds: Array) -> Track:
        """Results of all samples of a cycle at one design."""
        columns = ["=travel", "=load", "=rate"]
        record = cycle.record
        if record.supply_pressure is not None:
            columns.append("=supply")
        model = self._models.setdefault(
            tuple(columns), SampleModel(self.plan, (*self.common, *CYCLE), columns)
        )
        order = [self.names.index(name) for name in self.common]
        order += [self.names.index(f"{cycle.name}|{name}") for name in CYCLE]
        if cycle.name not in self._data:
            self._data[cycle.name] = _columns(record)
        rows = model.run(values[order], seeds[order], self._data[cycle.name])
        return Track(rows, model.outputs)


def _stepped(values: Array, seeds: Array) -> Array:
    """Numbers (numbers, 1) or complex (numbers, directions)."""
    return values[:, None] if not seeds.shape[1] else values[:, None] + 1j * STEP * seeds


def _columns(record: CycleRecord) -> npt.NDArray[np.float64]:
    columns = [record.motion, record.load, record.speed]
    if record.supply_pressure is not None:
        columns.append(record.supply_pressure)
    return np.stack(columns, axis=1)


def cycle_results(
    plan: Plan, u: Numbers, cycle: DutyCycle, track: Track
) -> dict[tuple[str, ...], Array]:
    """All results of one cycle by (name,) or (name, place), except fatigue."""
    time = cycle.record.time[:, None] * u["time_scale"]
    sums = _sums(plan, u, time, track)
    results: dict[tuple[str, ...], Array] = {(name,): value for name, value in sums.items()}
    results |= _seals(plan, track)
    results |= _extremes(plan, cycle.record, track)
    return results


def _sums(plan: Plan, u: Numbers, time: Array, track: Track) -> dict[str, Array]:
    """Sums over the motion and over time."""
    dt = time[1:] - time[:-1]
    x = track.array("position")
    dx = x[1:] - x[:-1]
    outward = dx.real > 0
    way = np.where(outward, dx, -dx)
    areas = u["area_a"], u["area_b"]
    volume = np.where(outward, *areas) * way
    returned = np.where(outward, *areas[::-1]) * way
    work = _mean(track.array("force")) * dx
    supply = track.array("supply")
    leakage = track.array("leakage")
    duration = dt.sum(axis=0)
    supplied = (_mean(supply) * volume).sum(axis=0)
    leaked = (_mean(supply * leakage) * dt).sum(axis=0)
    out = np.where(work.real > 0, work, 0.0).sum(axis=0)
    absorbed = -np.where(work.real < 0, work, 0.0).sum(axis=0)
    rubbed = (_mean(track.array("friction")) * way).sum(axis=0)
    drained = (u["drain"] * returned).sum(axis=0)
    oil = u["area_a"] * x + u["area_b"] * (u["stroke"] - x)
    leaked_volume = (_mean(leakage) * dt).sum(axis=0)
    sums = {
        "duration": duration,
        "way": way.sum(axis=0),
        "volume": volume.sum(axis=0) + leaked_volume,
        "supply_energy": supplied + leaked,
        "leakage_energy": leaked,
        "work_out": out,
        "work_in": absorbed,
        "friction_energy": rubbed,
        "return_energy": drained,
        "throttling_energy": supplied - drained - (out - absorbed) - rubbed,
        "oil_volume": (_mean(oil) * dt).sum(axis=0) / duration,
        "position_mean": (_mean(x) * dt).sum(axis=0) / duration,
        "inlet_heat": (_mean(track.array("inlet_drop")) * volume).sum(axis=0),
        "inlet_volume": volume.sum(axis=0),
        "ripple_volume": ripple(track.array("flow"), dt),
    }
    return sums | _exchange(u, x, duration)


def _mean(values: Array) -> Array:
    """Means of neighbouring samples."""
    return 0.5 * (values[1:] + values[:-1])


def ripple(flow: Array, dt: Array) -> Array:
    """Volume of an accumulator that evens out a flow over a period (mass-curve method) [m^3]."""
    steps = _mean(flow) * dt
    mean = steps.sum(axis=0) / dt.sum(axis=0)
    curve = np.concatenate([0 * steps[:1], np.cumsum(steps - mean * dt, axis=0)])
    level = curve[:, 0].real
    return curve[np.argmax(level)] - curve[np.argmin(level)]


def turning_points(position: npt.NDArray[np.float64]) -> npt.NDArray[np.intp]:
    """Indices of the first and last sample and of every reversal; samples at rest are skipped."""
    moves = np.flatnonzero(np.diff(position))
    signs = np.sign(np.diff(position)[moves])
    turns = moves[1:][signs[1:] != signs[:-1]]
    return np.concatenate([[0], turns, [len(position) - 1]])


def _exchange(u: Numbers, x: Array, duration: Array) -> dict[str, Array]:
    """Flow of fresh oil into each chamber: of every stroke, what the line does not hold back."""
    ends = x[turning_points(x[:, 0].real)]
    strokes = ends[1:] - ends[:-1]
    flows = {}
    for chamber, sign in (("a", 1.0), ("b", -1.0)):
        fresh = sign * u[f"area_{chamber}"] * strokes - u[f"line_volume_{chamber}"]
        flows[f"exchange_{chamber}"] = np.where(fresh.real > 0, fresh, 0.0).sum(axis=0) / duration
    return flows


def _seals(plan: Plan, track: Track) -> dict[tuple[str, ...], Array]:
    """Severity and friction energy of every seal."""
    x = track.array("position")
    dx = x[1:] - x[:-1]
    way = np.where(dx.real > 0, dx, -dx)
    results: dict[tuple[str, ...], Array] = {}
    for i, ring in enumerate(plan.rings):
        severity = (_mean(track.array(f"contact{i}")) * way).sum(axis=0)
        results["severity", ring.label] = severity
        energy = (_mean(track.array(f"friction{i}")) * way).sum(axis=0)
        results["seal_friction_energy", ring.label] = energy
    return results


def _extremes(plan: Plan, record: CycleRecord, track: Track) -> dict[tuple[str, ...], Array]:
    """The worst samples of every window."""
    results: dict[tuple[str, ...], Array] = {}
    parts = windows_of(record)
    for name, (output, sense, factor) in EXTREMES.items():
        if output not in track.outputs:
            continue
        values = track.real(output)
        for window in parts:
            for rank, row in enumerate(worst(values[window.first : window.last], sense)):
                picked = track.array(output, slice(window.first + row, window.first + row + 1))
                results[name, _ranked(window, rank)] = factor * picked[0]
    for i, ring in enumerate(plan.rings):
        speed, contact = track.real("speed"), track.real(f"contact{i}")
        for window in parts:
            values = np.abs(speed * contact)[window.first : window.last]
            for rank, row in enumerate(worst(values, "max")):
                rows = slice(window.first + row, window.first + row + 1)
                product = track.array("speed", rows) * track.array(f"contact{i}", rows)
                picked = np.where(product.real < 0, -product, product)[0]
                results["pv", f"{ring.label}|{_ranked(window, rank)}"] = picked
    return results


def windows_of(record: CycleRecord) -> tuple[Window, ...]:
    """Windows of a record; the last sample of a closed cycle repeats its first."""
    count = len(record.time) - (1 if record.closed else 0)
    edges = np.linspace(0, count, min(WINDOWS, count) + 1).round().astype(int)
    return tuple(
        Window(int(a), int(b), f"{record.time[a]:.3g} s to {record.time[b - 1]:.3g} s")
        for a, b in zip(edges[:-1], edges[1:], strict=True)
    )


def _ranked(window: Window, rank: int) -> str:
    return window.label if rank == 0 else f"{window.label}, next"


def worst(values: npt.NDArray[np.float64], sense: Sense) -> list[int]:
    """Indices of the worst samples, the worst first; at most `RANKS`."""
    keys = values if sense == "min" else -values
    keys = np.where(np.isnan(keys), -np.inf, keys)  # an unknown value is the worst
    count = min(RANKS, len(keys))
    picked = np.argpartition(keys, count - 1)[:count]
    return [int(i) for i in picked[np.argsort(keys[picked], kind="stable")]]
