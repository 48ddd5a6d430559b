"""Whether the requirements of a design hold in time, and by how much the linear tier erred.

Each dynamic requirement has its own small experiment on the scenario's equations, where the linear
tier is worst. Where both differ, it is repeated without sticking friction, and then with small
swings: what each step changes is the share of friction, of the size of the swing, and of the point
at which the loop works.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf, isfinite, isnan
from time import perf_counter
from typing import Any, Final, Literal

from ..design.scenario.model import Scenario
from ..evaluation.build import evaluate
from ..evaluation.kernel import Subject
from ..evaluation.result import Requirement
from . import experiments
from .assemble import loop_of
from .linear_tier import LinearTier, Spot
from .parts.signals import Records
from .result import Simulation
from .run import simulate
from .stand import Facts, Measured, Stand, Tally

LOOPS = ("ultimate_gain", "gain_margin", "phase_margin", "bandwidth")
HELD = ("dynamic_stiffness", "dynamic_phase", "damping_ratio", "natural_frequency")
DYNAMIC: Final = (*LOOPS, *HELD)
"""Metrics of a design that an experiment finds again."""
SMALL = 0.02
"""Swings over those of the experiment that count as small (a choice)."""
AGREE = 0.02
"""Difference below which no reason is sought (a choice)."""
TOLERANCE = 1e-6
"""A margin of at least -TOLERANCE counts as met, as in an evaluation."""


@dataclass(frozen=True, slots=True)
class Row:
    """A requirement in both tiers, SI."""

    origin: Literal["design", "scenario"]
    metric: str
    sense: str
    limit: float
    stated: float | None
    """What an evaluation says: the linear tier at its worst."""
    linear: float | None
    """The same at the place and in the ways of the experiment."""
    value: float | None
    """In time."""
    difference: float | None
    """Of `value` from `linear`, over it."""
    met: bool
    where: str = ""
    how: str = ""
    """The experiment, with its amplitude."""
    why: str = ""
    """Where the difference comes from; without a value, why there is none."""
    shares: Mapping[str, float] = field(default_factory=dict)
    """Relative change by friction, by the size of the swing, by the operating point."""


@dataclass(frozen=True, slots=True)
class Verification:
    """All requirements of a design and a scenario in time."""

    name: str
    rows: tuple[Row, ...]
    simulation: Simulation
    """The scenario itself."""
    runs: int
    seconds: float
    notes: tuple[str, ...] = ()

    @property
    def met(self) -> bool:
        """Whether every requirement holds in time."""
        return all(row.met for row in self.rows)

    def to_dict(self) -> dict[str, Any]:
        """As plain data for JSON, SI; None for what has no finite value."""
        rows = [
            {name: _plain(getattr(row, name)) for name in Row.__dataclass_fields__}
            for row in self.rows
        ]
        return {
            "name": self.name,
            "met": self.met,
            "rows": rows,
            "runs": self.runs,
            "seconds": self.seconds,
            "notes": list(self.notes),
        }


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {name: _plain(one) for name, one in value.items()}
    return None if isinstance(value, float) and not isfinite(value) else value


def verify(
    scenario: Scenario,
    subject: Subject,
    *,
    records: Records | None = None,
    result: Simulation | None = None,
    scale: float = 1.0,
) -> Verification:
    """Every dynamic requirement of a design and every one of a scenario, checked in time.

    Parameters
    ----------
    scenario : what happens; the experiments take its friction, supply, stops and rate limit
    subject : the design as it is to be checked, an optimum for one
    records : columns of the files that the scenario's signals name
    result : the scenario already simulated with this design
    scale : on the amplitudes of all experiments

    Raises
    ------
    InputError
        as `run.simulate`
    Unsolvable
        where an integration cannot go on
    """
    begin = perf_counter()
    tally = Tally()
    if result is None:
        tally.runs += 1
        result = simulate(scenario, subject, records=records)
    bench = _Bench(scenario, LinearTier.of(subject), tally, scale)
    asked = [one for one in evaluate(subject).requirements if one.metric in DYNAMIC]
    rows = [bench.row(one) for one in asked]
    rows += [
        Row("scenario", one.metric, one.sense, one.limit, None, None, one.value, None, one.met,
            where=scenario.name, how="the scenario itself", why=one.why)
        for one in result.requirements
    ]  # fmt: skip
    return Verification(
        subject.design.name,
        tuple(rows),
        result,
        tally.runs,
        perf_counter() - begin,
        _notes(scenario, bool(asked)),
    )


def _notes(scenario: Scenario, asked: bool) -> tuple[str, ...]:
    if not asked:
        return ("the design has no dynamic requirement",)
    notes = ["each experiment stands where the linear tier is worst, and nowhere else"]
    control = scenario.control
    own = control is not None and (
        loop_of(control) != "position"
        or control.law != "p"
        or bool(control.speed_feedback or control.pressure_feedback)
    )
    if own:
        notes.append(
            "the scenario has a controller of its own: requirements of the design are those of its "
            "proportional position loop"
        )
    load = scenario.load
    if load.stiffness or load.damping or load.drive is not None:
        notes.append("spring, damper and machine at the load are left out of the experiments")
    return tuple(notes)


@dataclass(slots=True)
class _Bench:
    """Experiments that were made; two requirements may share one."""

    scenario: Scenario
    tier: LinearTier
    tally: Tally
    scale: float
    stands: dict[Spot, Stand] = field(default_factory=dict)
    made: dict[tuple[str, Spot, bool, bool], Measured] = field(default_factory=dict)

    def row(self, asked: Requirement) -> Row:
        """One requirement of the design in both tiers."""
        spot = self.tier.spot(asked)
        why = self.tier.unsimulated() or self._impossible(asked.metric, spot)
        full = Measured({}, "", why=why) if why else self.measured(asked.metric, spot)
        value = full.values.get(asked.metric)
        linear = None if why else self.linear(asked.metric, spot, full)
        difference = _apart(value, linear)
        shares: dict[str, float] = {}
        why = full.why
        if difference is not None and abs(difference) > AGREE:
            shares, why = self._reasons(asked.metric, spot, full)
        elif difference is not None:
            why = "both agree"
        if linear is not None and (apart := _apart(linear, asked.value)) and abs(apart) > AGREE:
            why += "; " * bool(why) + self._moved(spot, asked.metric, full)
        return Row(
            "design",
            asked.metric,
            asked.sense,
            asked.limit,
            asked.value,
            linear,
            value,
            difference,
            _holds(value, asked.sense, asked.limit),
            where=spot.words,
            how=full.how,
            why=why,
            shares=shares,
        )

    def _impossible(self, metric: str, spot: Spot) -> str:
        """Why there is no experiment; empty where there is."""
        if metric not in LOOPS:
            shakes = self.tier.subject.design.load_cases[spot.case].frequency is not None
            asked = metric in ("dynamic_stiffness", "dynamic_phase")
            return "" if shakes or not asked else "no load case shakes"
        stand = self.stand(spot)
        if stand.plant.valve is None:
            return "the design has no valve"
        if not stand.steady_gain > 0:
            return "no gain holds the loop by the linear tier: nothing comes to rest"
        return ""

    def stand(self, spot: Spot) -> Stand:
        if spot not in self.stands:
            self.stands[spot] = self.tier.stand(self.scenario, spot, self.tally, self.scale)
        return self.stands[spot]

    def measured(
        self, metric: str, spot: Spot, *, bare: bool = False, small: bool = False
    ) -> Measured:
        """The experiment that finds a metric."""
        name = _EXPERIMENTS[metric]
        key = name, spot, bare, small
        if key not in self.made:
            stand = self._placed(metric, spot)
            stand = stand.bare() if bare else stand
            stand = stand.but(scale=SMALL * stand.scale) if small else stand
            self.made[key] = self._made(name, spot, stand)
        return self.made[key]

    def _placed(self, metric: str, spot: Spot) -> Stand:
        stand = self.stand(spot)
        return experiments.placed(stand) if metric in LOOPS else experiments.held_place(stand)

    def _made(self, name: str, spot: Spot, stand: Stand) -> Measured:
        tier, at = self.tier, stand.position
        if name in ("shaking", "decay"):
            resonance = tier.resonance(spot.case, at)
            design = tier.subject.design
            if name == "decay":
                return experiments.decay(stand, design.ports.end, resonance)
            frequency = design.load_cases[spot.case].frequency
            assert frequency is not None
            return experiments.dynamic_stiffness(stand, design.ports.end, frequency, resonance)
        way = bool(spot.extending)
        figures = tier.figures(spot.case, at, way)
        response = tier.response(spot.case, at, way)
        if name == "bandwidth":
            return experiments.bandwidth(stand, figures.bandwidth, response)
        if name == "phase":
            crossed, peaks = tier.crossings(spot.case, at, way)
            return experiments.phase_margin(stand, crossed, peaks, response)
        limit, frequency = figures.ultimate_gain, figures.frequency
        if not isfinite(limit):
            limit, frequency = stand.gain, tier.resonance(spot.case, at)
        found = experiments.ultimate_gain(stand, limit, frequency)
        gain = found.values["ultimate_gain"]
        margin = None if gain is None else gain / stand.gain
        values = {"ultimate_gain": gain, "gain_margin": margin}
        return Measured(values, found.how, found.facts, found.why)

    def linear(self, metric: str, spot: Spot, found: Measured) -> float | None:
        """The linear tier at the place and in the ways of an experiment."""
        at = self._placed(metric, spot).position
        if metric in HELD:
            return self.tier.held(spot.case, at)[metric]
        share = 0.5 if found.facts is None else found.facts.extending
        share = 0.0 if share < 0.05 else 1.0 if share > 0.95 else share
        return self.tier.closed(metric, spot.case, at, share)

    def _reasons(
        self, metric: str, spot: Spot, full: Measured
    ) -> tuple[dict[str, float], str]:
        """Shares of friction, swing and operating point in a difference, with what was seen."""
        steps: list[tuple[str, Measured]] = [("", full)]
        if self.scenario.friction.model != "none":
            steps.append(("friction", self.measured(metric, spot, bare=True)))
        steps.append(("size of the swing", self.measured(metric, spot, bare=True, small=True)))
        shares: dict[str, float] = {}
        said: list[str] = []
        before, after = full, full
        for name, after in steps[1:]:
            value, rest = before.values[metric], after.values[metric]
            if rest is None:
                return shares, "; ".join([*said, f"{name} decides: without it {after.why}"])
            ways = self._ways(metric, spot, before, after) if name != "friction" else 1.0
            share = _apart(value, rest * ways if isfinite(rest) else rest)
            if share is None:
                said.append(f"{name}: {_words(before, after, name)}")
            elif abs(share) > AGREE / 2:
                shares[name] = share
                said.append(f"{name} {_percent(share)} ({_words(before, after, name)})")
            before = after
        last = _apart(after.values[metric], self.linear(metric, spot, after))
        if last is not None and abs(last) > AGREE / 2:
            shares["operating point"] = last
            said.append(f"operating point {_percent(last)} ({self._point(spot, after)})")
        return shares, "; ".join(said)

    def _ways(self, metric: str, spot: Spot, one: Measured, other: Measured) -> float:
        """Linear figure in the ways of one experiment over that in the ways of another."""
        first, second = (self.linear(metric, spot, found) for found in (one, other))
        if first is None or second is None or not isfinite(first) or not second:
            return 1.0
        return first / second

    def _point(self, spot: Spot, found: Measured) -> str:
        """Where the loop works, beside what the linear tier takes."""
        facts = found.facts
        if facts is None:
            return ""
        held = self.tier.stated(spot.case)
        a, b = (1e-5 * one for one in facts.pressures)
        words = f"chambers at {a:.0f}/{b:.0f} bar, linear {1e-5 * held[0]:.0f}/{1e-5 * held[1]:.0f}"
        if facts.spool is not None:
            words += f", spool about {0.5 * sum(facts.spool):.2g} V"
        return words

    def _moved(self, spot: Spot, metric: str, found: Measured) -> str:
        """Why the linear tier is asked elsewhere than at its worst."""
        at = 1e3 * self._placed(metric, spot).position
        if metric in HELD or found.facts is None:
            return f"compared at {at:.3g} mm, off the stop"
        share = round(100 * found.facts.extending)
        return f"compared at {at:.3g} mm with both ways of the spool, {share} % extending"


_EXPERIMENTS = {
    "ultimate_gain": "swinging",
    "gain_margin": "swinging",
    "phase_margin": "phase",
    "bandwidth": "bandwidth",
    "dynamic_stiffness": "shaking",
    "dynamic_phase": "shaking",
    "damping_ratio": "decay",
    "natural_frequency": "decay",
}


def _apart(value: float | None, other: float | None) -> float | None:
    """Relative difference; None where there is none."""
    if value is None or other is None or not isfinite(value) or not isfinite(other) or not other:
        return None
    return value / other - 1


def _percent(share: float) -> str:
    return f"{100 * share:+.{0 if abs(share) >= 0.095 else 1}f} %"


def _words(found: Measured, without: Measured, name: str) -> str:
    """What the record of an experiment shows of a cause."""
    facts = found.facts
    if facts is None:
        return "no record"
    if name == "friction":
        return _seals(facts)
    if facts.saturated > 0:
        return f"the signal is at its limit {100 * facts.saturated:.0f} % of the time"
    if facts.lowest < 0:
        return f"a chamber falls to {1e-5 * facts.lowest:.2g} bar"
    if facts.spool is not None:
        return f"the spool swings from {facts.spool[0]:.2g} to {facts.spool[1]:.2g} V"
    return f"swing of {1e3 * facts.swing:.2g} mm"


def _seals(facts: Facts) -> str:
    swing, travel = 1e3 * facts.swing, 1e3 * facts.travel
    if not travel:
        return f"the seals slide over {swing:.2g} mm"
    if facts.swing < facts.travel:
        return f"the seals stick: swing of {swing:.2g} mm, their bristles give {travel:.2g} mm"
    return f"the seals slip: swing of {swing:.2g} mm, their bristles give {travel:.2g} mm"


def _holds(value: float | None, sense: str, limit: float) -> bool:
    if value is None or isnan(value):
        return False
    if value in (inf, -inf):
        return (value > 0) == (sense == "min")
    gap = value - limit if sense == "min" else limit - value
    return gap >= -TOLERANCE * abs(limit)
