"""Duty cycles of a design over time, for figures and tables."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import field, replace
from functools import cached_property, partial
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from ...base.dataclass import dataclass
from ...design.cycle_record import CycleRecord
from ...models import wear
from .force_speed import ForceLimit, force_limits
from .numbers import CYCLE
from .results import CycleModels, Place
from .sampling import SampleResults

Trace = npt.NDArray[np.float64]

ENERGIES: Mapping[str, str] = {
    "work_out": "work on the load",
    "work_in": "work of the load",
    "throttling_energy": "throttling",
    "leakage_energy": "leakage",
    "friction_energy": "friction",
    "return_energy": "return line",
}
"""Parts of the energy from the supply; it is their sum, with the work of the load subtracted."""


STATE = (
    "position", "arm", "force", "speed", "supply", "pressure_a", "pressure_b", "opening", "flow",
)  # fmt: skip
"""Traces that describe the actuator at a sample."""


class WorstSample(NamedTuple):
    """The sample of a cycle at which a result is worst."""

    sample: int
    time: float
    """Time of the file [s]."""
    value: float


class ShortStrokes(NamedTuple):
    """Strokes of a cycle too short to carry oil across a seal's contact."""

    strokes: int
    shorter_than: float
    """Length below which a stroke is short [m]."""


@dataclass(frozen=True)
class CycleStudy:
    """A cycle of a design: its record, and results at all samples, SI.

    The traces are those of `samples.sample`, by name. Times and speeds are scaled as the design
    states.
    """

    name: str
    record: CycleRecord
    time: Trace
    traces: Mapping[str, Trace]
    energies: Mapping[str, float]
    """Energy per cycle [J] by the names in `ENERGIES`, and "supply_energy"."""
    worst: Mapping[str, WorstSample]
    damage: Mapping[str, float]
    """Fatigue damage of every part by this cycle in a life; empty without repeats."""
    severity: Mapping[str, float]
    """Contact pressure times way of every seal per cycle [N/m]."""
    repeats: float | None
    flow_mean: float = 0.0
    """Mean flow from the supply [m^3/s]."""
    way: float = 0.0
    """Distance that the piston moves per cycle [m]."""
    limits: tuple[ForceLimit, ...] = ()
    """Limits in the plane of force and speed, at the least supply pressure of the cycle."""
    linked: bool = False
    """Whether the linkage gives position and lever arm."""
    reversals: int = 0
    """Changes of direction of the piston, the smallest ones included."""
    short_strokes: Mapping[str, ShortStrokes] = field(default_factory=dict)
    """Strokes by seal that are shorter than `wear.SHORT_STROKE` contact widths."""

    @property
    def efficiency(self) -> float | None:
        """Work on the load divided by the energy from the supply; None if nothing moves."""
        supplied = self.energies["supply_energy"]
        return self.energies["work_out"] / supplied if self.way > 0 and supplied > 0 else None

    def state(self, index: int) -> dict[str, float]:
        """Angle and torque of the joint if there is one, and traces at a sample, by name."""
        values: dict[str, float] = {}
        if self.record.joint:
            torque = self.traces["force"][index] * self.traces["arm"][index]
            angle = float(self.record.motion[index])
            values = {"joint_angle": angle, "joint_torque": float(torque)}
        return values | {
            name: float(self.traces[name][index]) for name in STATE if name in self.traces
        }

    def to_dict(self) -> dict[str, Any]:
        """JSON data: sums, worst samples with the state there, and limits; without traces."""
        return {
            "name": self.name,
            "duration": float(self.time[-1] - self.time[0]),
            "samples": len(self.time),
            "reversals": self.reversals,
            "short_strokes": {seal: x._asdict() for seal, x in self.short_strokes.items()},
            "energies": dict(self.energies),
            "efficiency": self.efficiency,
            "flow_mean": self.flow_mean,
            "way": self.way,
            "worst": {
                key: worst._asdict() | {"state": self.state(worst.sample)}
                for key, worst in self.worst.items()
            },
            "force_limits": [limit.to_dict() for limit in self.limits],
            "damage": dict(self.damage),
            "severity": dict(self.severity),
            "warnings": [*self.record.notes, *self.record.warnings],
        }


Lack: TypeAlias = Literal["force", "flow", "pressure", "travel", "fatigue strength"]
"""Kinds of shortage of a duty cycle; without pressure the oil cavitates."""


class Remedy(NamedTuple):
    """A change of one number that is enough for the duty cycles, SI and as text."""

    path: str
    words: str
    now: float
    needed: float
    now_text: str
    needed_text: str

    @property
    def text(self) -> str:
        """The change in words."""
        return f"{self.words} of {self.needed_text} instead of {self.now_text}"


@dataclass(frozen=True, slots=True)
class Shortfall:
    """A check that a duty cycle misses: what is lacking where, and single changes that cure it."""

    metric: str
    cycle: str
    lacks: Lack
    sample: int | None
    """The sample at which it lacks most; None for the life."""
    time: float | None
    """Time of this sample in the file [s]."""
    reason: str
    """Sentence that names the sample, the time and the shortfall."""
    remedies: tuple[Remedy, ...]
    tried: tuple[str, ...]
    """Words of all numbers that were tried."""

    @property
    def cures(self) -> str:
        """The changes in words, or which numbers do not help."""
        if not self.remedies:
            return f"no change of {_listed(self.tried)} alone is enough"
        return _listed([remedy.text for remedy in self.remedies])

    @property
    def sentence(self) -> str:
        """The shortfall and its cures."""
        enough = " is enough for the duty cycles" if self.remedies else ""
        return f"{self.reason}; {self.cures}{enough}"

    def to_dict(self) -> dict[str, Any]:
        """JSON data."""
        keys = ("metric", "cycle", "lacks", "sample", "time", "sentence")
        return {key: getattr(self, key) for key in keys} | {
            "remedies": [
                {"path": remedy.path, "now": remedy.now, "needed": remedy.needed}
                for remedy in self.remedies
            ],
            "tried": list(self.tried),
        }


def _listed(words: Sequence[str]) -> str:
    """Alternatives joined by commas and "or".

    >>> _listed(["a", "b", "c"]), _listed(["a"])
    ('a, b or c', 'a')
    """
    head = ", ".join(words[:-1])
    return f"{head} or {words[-1]}" if head else words[-1]


@dataclass(frozen=True, slots=True)
class WarmingPlace:
    """Temperature of a place over time [K], and the limit of its material."""

    name: str
    temperature: Trace
    steady: float
    limit: float | None
    """Highest temperature of the material; None if the library states none."""
    material: str
    """Material with this limit."""
    crossed: float | None
    """Time from which on the limit is exceeded [s]; None if it never is."""
    after_mission: float | None
    """Temperature at the end of the mission; None if no time of a mission is stated."""


@dataclass(frozen=True, slots=True)
class Warming:
    """Temperatures from cold while a cycle, or the mean of all cycles, repeats without end, SI."""

    name: str
    """The cycle, or `thermal.MEAN`."""
    start: float
    """Temperature of all parts at the beginning: that of the air."""
    time_constant: float
    """Slowest time constant."""
    mission: float | None
    """Time of a mission."""
    ripple: float
    """Bound of the deviation from these temperatures within a period."""
    time: Trace
    places: tuple[WarmingPlace, ...]

    @property
    def reserve(self) -> float:
        """Least distance of a steady temperature from its limit; infinite without limits."""
        known = (place.limit - place.steady for place in self.places if place.limit is not None)
        return min(known, default=float("inf"))

    def to_dict(self) -> dict[str, Any]:
        """JSON data."""
        keys = ("steady", "limit", "material", "crossed", "after_mission")
        return {
            "cycle": self.name,
            "start": self.start,
            "time_constant": self.time_constant,
            "mission": self.mission,
            "ripple": self.ripple,
            "time": self.time.tolist(),
            "places": {
                place.name: {"temperature": place.temperature.tolist()}
                | {key: getattr(place, key) for key in keys}
                for place in self.places
            },
        }


class LinkageSize(NamedTuple):
    """Lengths and angle of a linkage, as in `models.linkage`, and of the actuator in it."""

    base_radius: float
    """Joint axis to the fixed pivot [m]."""
    crank_radius: float
    """Joint axis to the crank pin [m]."""
    angle_offset: float
    """Angle between both radii at joint angle zero [rad]."""
    closed_length: float
    """Retracted actuator, pin to pin [m]."""


@dataclass(frozen=True)
class DutyStudy:
    """All duty cycles of a design."""

    cycles: tuple[CycleStudy, ...]
    unknown: Mapping[str, str]
    """Parts that are not assessed for fatigue, with the reason."""
    notes: tuple[str, ...]
    """Assumptions behind the results."""
    return_pressure: float = 0.0
    """Gauge pressure of the return line [Pa]."""
    stroke: float = 0.0
    """Stroke of the cylinder [m]."""
    opening_limit: float | None = None
    """Largest opening of the valve that a cycle may need; None without a valve."""
    linkage: LinkageSize | None = None
    """Lengths of the linkage; None if no cycle moves it."""
    warming: tuple[Warming, ...] = ()
    """Temperatures over time, under every cycle or the mean of all; empty if they are not known."""
    films: Mapping[str, str] = field(default_factory=dict)
    """Seals with an oil film, each with the trace of its friction, which is that of dry contact."""
    find_shortfalls: Callable[[], Iterable[Shortfall]] = field(
        default=tuple, repr=False, compare=False
    )
    """Finds the `shortfalls`; the search for cures takes seconds."""

    @cached_property
    def shortfalls(self) -> tuple[Shortfall, ...]:
        """Checks that the cycles miss, with reasons and cures."""
        return tuple(self.find_shortfalls())

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "find_shortfalls": partial(tuple, self.shortfalls)}

    def to_dict(self) -> dict[str, Any]:
        """JSON data."""
        return {
            "cycles": [cycle.to_dict() for cycle in self.cycles],
            "opening_limit": self.opening_limit,
            "linkage": None if self.linkage is None else self.linkage._asdict(),
            "not_assessed_for_fatigue": dict(self.unknown),
            "warming": [warming.to_dict() for warming in self.warming],
            "shortfalls": [shortfall.to_dict() for shortfall in self.shortfalls],
            "notes": list(self.notes),
        }


NOTES = (
    "quasi-static: pressures follow force and direction; the oil is incompressible and the spool "
    "has no dynamics",
    "the torques or forces of a cycle contain the inertia of the load: load.mass and load.inertia "
    "are not added",
)
"""Assumptions of all duty cycles."""

_WORST: Mapping[str, tuple[str, float]] = {
    "share": ("share", -1.0),
    "reserve": ("reserve", 1.0),
    "opening": ("opening", -1.0),
    "flow": ("flow", -1.0),
    "power": ("power", -1.0),
    "absorbed": ("power", 1.0),
    "pressure_a": ("pressure_a", 1.0),
    "pressure_b": ("pressure_b", 1.0),
    "force": ("force", -1.0),
    "pull": ("force", 1.0),
    "speed": ("speed", -1.0),
}
"""Worst samples by name: the trace, and 1 for its least or -1 for its largest value."""


def study(
    models: CycleModels, numbers: npt.NDArray[np.float64], widths: Mapping[str, float] | None = None
) -> DutyStudy:
    """The duty cycles of one design at its numbers (numbers,); `widths` are the seals' contacts."""
    results = dict(zip(models.places, models(numbers[:, None])[:, 0].tolist(), strict=True))
    named = dict(zip(models.names, numbers.tolist(), strict=True))
    cycles = []
    for name, track in models.tracks(numbers[:, None]).items():
        record = models.records[name]
        time = record.time * named[f"{name}|time_scale"]
        u = {key: named[key] for key in models.common}
        u |= {key: named[f"{name}|{key}"] for key in CYCLE}
        u["level"] = float(track.real("supply").min())
        limits = force_limits(models.plan, u, track.real("speed")[:, 0])
        repeats = named.get(f"{name}|repeats")
        cycle = _cycle(
            name, record, time, track, results, limits, repeats, name in models.plan.linked
        )
        cycles.append(_with_strokes(cycle, widths or {}))
    linkage = None
    if models.plan.linked:
        linkage = LinkageSize(**{key: named[key] for key in LinkageSize._fields})
    return DutyStudy(
        cycles=tuple(cycles),
        unknown=dict(models.plan.unknown),
        notes=NOTES,
        return_pressure=named["drain"],
        stroke=named["stroke"],
        opening_limit=named["opening_limit"] if models.plan.valve else None,
        linkage=linkage,
        films={
            ring.label: f"friction{i}"
            for i, ring in enumerate(models.plan.rings)
            if ring.element.friction_law.film is not None
        },
    )


def _with_strokes(cycle: CycleStudy, widths: Mapping[str, float]) -> CycleStudy:
    """The cycle with its reversals, and the strokes that starve a seal of oil."""
    position = cycle.traces["position"]
    if not np.isfinite(position).all():
        return cycle
    short = {}
    reversals = 0
    for seal, width in {"": 0.0, **widths}.items():
        found = wear.strokes(position=position, contact_width=width, closed=cycle.record.closed)
        reversals = found.reversals
        if seal:
            short[seal] = ShortStrokes(found.short, wear.SHORT_STROKE * width)
    return replace(cycle, reversals=reversals, short_strokes=short)


def _cycle(
    name: str,
    record: CycleRecord,
    time: Trace,
    track: SampleResults,
    results: Mapping[Place, float],
    limits: tuple[ForceLimit, ...],
    repeats: float | None,
    linked: bool,
) -> CycleStudy:
    own = {place: value for place, value in results.items() if place.cycle == name}

    def by_place(result: str) -> dict[str, float]:
        return {place.place: value for place, value in own.items() if place.name == result}

    traces = {output: track.real(output)[:, 0] for output in track.outputs}
    worst = {}
    for key, (output, sign) in _WORST.items():
        if output in traces:
            at = int(np.argmin(sign * traces[output]))
            worst[key] = WorstSample(at, float(record.time[at]), float(traces[output][at]))
    return CycleStudy(
        name=name,
        record=record,
        time=time,
        traces=traces,
        energies={key: own[Place(name, key)] for key in ("supply_energy", *ENERGIES)},
        flow_mean=own[Place(name, "volume")] / own[Place(name, "duration")],
        way=own[Place(name, "way")],
        limits=limits,
        worst=worst,
        damage=by_place("damage"),
        severity=by_place("severity"),
        repeats=repeats,
        linked=linked,
    )
