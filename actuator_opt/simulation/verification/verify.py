"""Verify dynamic requirements by simulation, and determine the error of the linear models.

The requirements of a design are evaluated with linear models (the 'linear tier'). Here the metric
of each dynamic requirement is measured in its own small simulated experiment, with the equations of
the scenario, at the point where the linear value is worst. If measured and linear values differ,
the experiment is repeated without sticking friction, and then again with small amplitudes as well.
The two repetitions show how much friction and amplitude contribute to the difference; the rest is
due to the operating point.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field, replace
from math import inf, isfinite, isnan, nan, pi
from time import perf_counter
from typing import Any, Final, Literal, NamedTuple

import numpy as np

from ...base.dataclass import dataclass
from ...base.errors import InputError, Unsolvable
from ...base.numeric import Array
from ...base.polynomial import at_frequency
from ...base.progress import steps
from ...base.tables import Displayed
from ...design.scenario.kinds import Records
from ...design.scenario.model import Scenario, ScenarioLoad
from ...evaluation.build import evaluate
from ...evaluation.kernel import ModelRun, PreparedDesign, compute
from ...evaluation.result import Requirement
from ...evaluation.values import of_case
from ...metrics import METRICS
from ...models import linear, loop
from ...studies.plant import Plant, plant
from ..components.circuit import loop_of
from ..result import Simulation
from ..run import simulate
from . import experiments
from .experiments import (
    ExperimentResult,
    Facts,
    RunCounter,
    Stand,
)

WEAKEST = "weakest position"


STEADY_STEP = 0.4
"""Gain with which a loop that would oscillate is brought to rest, relative to the ultimate gain
(our choice)."""


SLOW = 0.05
"""Bandwidth assumed for a loop if it is unknown, relative to the resonance frequency (our
choice)."""


PEAK = 0.5
"""Magnitude of the open loop above which a resonance peak is searched for a crossover (our
choice)."""


class Spot(NamedTuple):
    """Load case, position and spool direction at which a metric of the linear models is worst."""

    case: int
    position: float
    extending: bool | None
    """Whether the spool is on the extending side; None if the direction has no effect."""
    words: str


class LoopFigures(NamedTuple):
    """Metrics of the position loop for one spool direction."""

    ultimate_gain: float
    frequency: float
    """Frequency of the oscillation at the ultimate gain [Hz]."""
    phase_margin: float
    bandwidth: float


@dataclass(frozen=True, slots=True)
class LinearTier:
    """Linear models of a design, for any load case and any position of the piston."""

    subject: PreparedDesign
    done: ModelRun

    @classmethod
    def of(cls, subject: PreparedDesign) -> LinearTier:
        """Build the linear models from an evaluation of the design."""
        return cls(subject, compute(subject, subject.values()))

    def spot(self, row: Requirement) -> Spot:
        """Load case, position and spool direction at which a requirement has its worst value."""
        cases = self.subject.cases
        case = cases.index(row.case) if row.case in cases else 0
        place = row.place or WEAKEST
        extending: bool | None = None
        parts = [row.case or "", row.place or WEAKEST]
        if place.startswith(("extending, ", "retracting, ")):
            direction, _, place = place.partition(", ")
            extending = direction == "extending"
        position = self.done.places.get(place, self.done.places[WEAKEST])
        return Spot(case, of_case(position, case), extending, ", ".join(filter(None, parts)))

    def plant(self, case: int) -> Plant:
        """The plant with the oil and the temperature of a load case."""
        subject = self.subject
        order = [case, *(k for k in range(len(subject.cases)) if k != case)]
        cases = tuple(subject.design.load_cases[k] for k in order)
        films = {
            (p, order.index(k), direction): t for (p, k, direction), t in subject.films.items()
        }
        design = subject.design.model_copy(update={"load_cases": cases})
        return plant(replace(subject, design=design, films=films))

    def stand(self, scenario: Scenario, spot: Spot, tally: RunCounter, scale: float) -> Stand:
        """The design on a test stand at its worst point, with the pressures of the load case."""
        actuator = self.plant(spot.case)
        state = self.done.state
        stand = Stand(
            plant=actuator,
            scenario=scenario,
            position=spot.position,
            pressure_a=of_case(state.holding_a, spot.case),
            pressure_b=of_case(state.holding_b, spot.case),
            tally=tally,
            scale=scale,
        )
        if actuator.valve is None:
            return stand
        valve = replace(actuator.valve, plays=())  # as in the linear model
        stand = stand.with_changes(plant=replace(actuator, valve=valve))
        gain = self._gain(spot.case)
        both = [self.figures(spot.case, spot.position, extending) for extending in (True, False)]
        least = min(figures.ultimate_gain for figures in both)
        bandwidths = [figures.bandwidth for figures in both if figures.bandwidth > 0]
        slow = min(bandwidths, default=SLOW * self.resonance(spot.case, spot.position))
        return stand.with_changes(
            gain=gain, steady_gain=min(gain, STEADY_STEP * least), bandwidth=slow
        )

    def _open_loop(self, position: float, extending: bool) -> loop.PositionOpenLoop:
        place = np.array([[position]])
        return self.done.motion.position_loop(place, extending=np.array(extending))

    def _gain(self, case: int) -> float:
        return of_case(self.done.computed.metrics["position_gain"][""], case)

    def figures(self, case: int, position: float, extending: bool) -> LoopFigures:
        """Metrics of the position loop; margin and bandwidth are those at the design's gain."""
        open_loop, gain = self._open_loop(position, extending), self._gain(case)
        limit = loop.ultimate_gain(loop=open_loop)
        margins = loop.margins(loop=open_loop, gain=gain)
        return LoopFigures(
            of_case(limit.gain, case),
            of_case(limit.frequency, case),
            of_case(margins.phase_margin, case),
            of_case(margins.bandwidth, case),
        )

    def response(
        self, case: int, position: float, extending: bool
    ) -> Callable[[float | Array], Array]:
        """The open loop as a function of frequency [Hz], including the controller gain."""
        open_loop, gain = self._open_loop(position, extending), self._gain(case)

        def at(frequency: float | Array) -> Array:
            omega = 2 * pi * np.asarray(frequency, dtype=float).reshape(-1, 1, 1)
            top, low = (
                at_frequency(open_loop.numerator, omega),
                at_frequency(open_loop.denominator, omega),
            )
            value = gain * np.asarray(top.complex / low.complex)
            value = value[:, min(case, value.shape[1] - 1), 0]
            return value if np.ndim(frequency) else complex(value[0])

        return at

    def crossings(
        self, case: int, position: float, extending: bool
    ) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Crossover and resonance frequencies of the open loop [Hz]."""
        figures = self.figures(case, position, extending)
        resonance = self.resonance(case, position)
        low = 0.2 * min(figures.bandwidth or resonance, resonance)
        grid = np.geomspace(low, 5 * resonance, 4000)
        size = np.abs(self.response(case, position, extending)(grid))
        crossed = np.flatnonzero((size[:-1] > 1) != (size[1:] > 1))
        inner = size[1:-1]
        peaks = np.flatnonzero((inner > size[:-2]) & (inner > size[2:]) & (inner > PEAK)) + 1
        return tuple(grid[crossed].tolist()), tuple(grid[peaks].tolist())

    def resonance(self, case: int, position: float) -> float:
        """Natural frequency with closed ports [Hz]."""
        return of_case(self.done.motion.closed_frequency(np.array([[position]])), case)

    def held(self, case: int, position: float) -> dict[str, float]:
        """Natural frequency, damping and dynamic stiffness, without the position loop."""
        place = np.array([[position]])
        motion = self.done.motion
        model = motion.model(place)
        figures = {
            "natural_frequency": self.resonance(case, position),
            "damping_ratio": of_case(loop.load_mode(model=model).damping_ratio, case),
        }
        frequency = self.subject.design.load_cases[case].frequency
        if frequency is None:
            return figures | dict.fromkeys(("dynamic_stiffness", "dynamic_phase"), nan)
        parts = linear.dynamic_stiffness(model=model, frequency=frequency)
        value = complex(of_case(parts.real, case), of_case(parts.imaginary, case))
        return figures | {
            "dynamic_stiffness": abs(value),
            "dynamic_phase": float(np.angle(value)),
        }

    def closed(self, metric: str, case: int, position: float, extending: bool) -> float:
        """A metric of the closed loop for one spool direction."""
        figures = self.figures(case, position, extending)
        if metric == "gain_margin":
            return figures.ultimate_gain / self._gain(case)
        return float(getattr(figures, metric))

    def stated(self, case: int) -> tuple[float, float]:
        """Chamber pressures that the linear models assume [Pa]."""
        state = self.done.state
        return of_case(state.holding_a, case), of_case(state.holding_b, case)

    def unsimulated(self) -> str:
        """Reason why experiments cannot represent this design.

        Empty if they can.
        """
        if self.subject.design.ports.accumulators:
            return "accumulators at the ports are not simulated, so no experiment is possible"
        return ""


MANY = 9.0
"""Relative changes above this are reported as a factor instead of in per cent (our choice)."""


STILL = 0.01
"""Motion of the spool, relative to its largest opening, up to which it counts as still (our
choice)."""


def relative_difference(value: float | None, other: float | None) -> float | None:
    """Relative difference of `value` from `other`; None if it cannot be computed.

    >>> relative_difference(1.5, 2.0), relative_difference(None, 2.0)
    (-0.25, None)
    >>> relative_difference(1.0, 0.0) is None
    True
    """
    if value is None or other is None or not isfinite(value) or not isfinite(other) or not other:
        return None
    return value / other - 1


def relative_change(share: float) -> str:
    """A relative change as text: in per cent, or as a factor if it is large.

    >>> [relative_change(share) for share in (0.031, -0.5, 19.0, -1.2)]
    ['+3.1 %', '-50 %', 'x 20', 'changes its sign']
    """
    if share < -1:
        return "changes its sign"
    if share >= MANY:
        return f"x {1 + share:.3g}"
    return f"{100 * share:+.{0 if abs(share) >= 0.095 else 1}f} %"


def evidence(facts: Facts | None, cause: str) -> str:
    """Evidence, as text, that friction or a large amplitude causes a difference."""
    if facts is None:
        return "no record"
    if cause == "friction":
        return _seals(facts)
    words = []
    if facts.saturated > 0:
        words.append(f"the valve signal is at its limit {100 * facts.saturated:.0f} % of the time")
    if facts.lowest < 0:
        words.append(f"the pressure in a chamber falls to {1e-5 * facts.lowest:.2g} bar")
    low, high = (0.0, 0.0) if facts.spool is None else facts.spool
    if high - low > STILL * max(abs(low), abs(high)):
        words.append(f"the spool oscillates between {low:.2g} and {high:.2g} V")
    return "; ".join(words) or (
        f"the pressure in chamber A oscillates by +-{1e-5 * facts.pulse:.2g} bar"
    )


def _seals(facts: Facts) -> str:
    swing, travel = 1e3 * facts.swing, 1e3 * facts.travel
    if not travel:
        return f"the seals slide over {swing:.2g} mm"
    word = "stick" if swing < travel else "slip"
    return f"the seals {word}: amplitude {swing:.2g} mm, bristle travel {travel:.2g} mm"


def operating_point(facts: Facts | None, assumed: tuple[float, float]) -> str:
    """Operating point of a simulation, as text, with the pressures of the linear models."""
    if facts is None:
        return "no record"
    (a, b), (taken_a, taken_b) = (
        [1e-5 * pressure for pressure in pair] for pair in (facts.pressures, assumed)
    )
    words = (
        f"chambers at {a:.0f} and {b:.0f} bar, but {taken_a:.0f} and {taken_b:.0f} bar in "
        "the linear model"
    )
    if facts.spool is not None:
        words += f"; spool at about {0.5 * sum(facts.spool):.2g} V"
    return words


LOOPS = ("ultimate_gain", "gain_margin", "phase_margin", "bandwidth")
HELD = ("dynamic_stiffness", "dynamic_phase", "damping_ratio", "natural_frequency")
DYNAMIC: Final = (*LOOPS, *HELD)
"""Metrics of a design that an experiment can measure."""
SMALL = 0.02
"""Factor on the amplitude of an experiment that is repeated with a small amplitude (our choice)."""
AGREE = 0.02
"""Relative difference between linear and measured value up to which they count as equal and no
cause is given (our choice)."""
CENTRED = 1e-3
"""Distance from its centre, as a share of the full signal, within which a spool counts as centred
(our choice)."""
TOLERANCE = 1e-6
"""A requirement counts as met if its margin is -TOLERANCE or more, as in an evaluation."""


@dataclass(frozen=True, slots=True)
class VerifiedRequirement:
    """A requirement with its values from the linear models and from the simulation, SI."""

    origin: Literal["design", "scenario"]
    metric: str
    sense: str
    limit: float
    stated: float | None
    """Value in the evaluation of the design, which is the worst value of the linear models."""
    linear: float | None
    """Value of the linear models at the experiment's position and spool direction."""
    value: float | None
    """Value measured in the simulation."""
    difference: float | None
    """Relative difference of `value` from `linear`."""
    met: bool
    where: str = ""
    how: str = ""
    """Description of the experiment, with its amplitude."""
    why: str = ""
    """Cause of the difference, or the reason why a value is missing."""
    shares: Mapping[str, float] = field(default_factory=dict)
    """Relative change of the value due to friction, to amplitude and to the operating point."""


@dataclass(frozen=True, slots=True)
class Verification(Displayed):
    """All dynamic requirements of a design and all requirements of a scenario, simulated."""

    name: str
    rows: tuple[VerifiedRequirement, ...]
    simulation: Simulation
    """Simulation of the scenario itself."""
    runs: int
    seconds: float
    notes: tuple[str, ...] = ()

    @property
    def met(self) -> bool:
        """Whether the simulation meets all requirements."""
        return all(row.met for row in self.rows)

    @property
    def in_short(self) -> tuple[str, str]:
        """The number of simulated requirements that are met."""
        return (
            self.name,
            f"{sum(row.met for row in self.rows)} of {len(self.rows)} met by simulation",
        )

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON, SI; a value that is not finite is None."""
        rows = [
            {name: _plain(getattr(row, name)) for name in VerifiedRequirement.__dataclass_fields__}
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
        return {name: _plain(item) for name, item in value.items()}
    return None if isinstance(value, float) and not isfinite(value) else value


def verify(
    scenario: Scenario,
    subject: PreparedDesign,
    *,
    records: Records | None = None,
    result: Simulation | None = None,
    scale: float = 1.0,
) -> Verification:
    """Verify every dynamic requirement of a design and of a scenario by simulation.

    Parameters
    ----------
    scenario : inputs over time; the experiments use its friction, supply, stops and rate limit
    subject : the design to verify, such as an optimum
    records : columns of the files that the scenario's signals name
    result : simulation of the scenario with this design, if it already exists
    scale : factor on the amplitudes of all experiments

    Raises
    ------
    InputError
        as for `run.simulate`
    Unsolvable
        an integration in time fails
    """
    begin = perf_counter()
    counter = RunCounter()
    if result is None:
        counter.runs += 1
        result = simulate(scenario, subject, records=records)
    bench = _Bench(scenario, LinearTier.of(subject), counter, scale)
    requirements = [
        requirement
        for requirement in evaluate(subject).requirements
        if requirement.metric in DYNAMIC
    ]
    rows = [bench.row(step) for step in steps("verifying each requirement", requirements)]
    rows += [
        VerifiedRequirement(
            "scenario", requirement.metric, requirement.sense, requirement.limit, None, None,
            requirement.value, None, requirement.met,
            where=scenario.name, how="the scenario itself", why=requirement.why)
        for requirement in result.requirements
    ]  # fmt: skip
    return Verification(
        subject.design.name,
        tuple(rows),
        result,
        counter.runs,
        perf_counter() - begin,
        _notes(scenario, bool(requirements), _has_hysteresis(subject)),
    )


def _has_hysteresis(subject: PreparedDesign) -> bool:
    """Whether the design's valve states hysteresis or threshold."""
    valve = subject.design.valve
    return valve is not None and bool(valve.hysteresis or valve.threshold)


def _notes(scenario: Scenario, any_requirement: bool, hysteresis: bool) -> tuple[str, ...]:
    if not any_requirement:
        return ("the design has no dynamic requirement",)
    notes = [
        "each requirement is simulated only at the point where the linear model gives its worst "
        "value"
    ]
    control = scenario.control
    if hysteresis:
        notes.append("hysteresis and threshold of the valve are left out, as in the linear model")
    own_controller = control is not None and (
        loop_of(control) != "position"
        or control.law != "p"
        or bool(control.speed_feedback or control.pressure_feedback)
    )
    if own_controller:
        notes.append(
            "the scenario has its own controller, but requirements of the design refer to the "
            "proportional position loop of the design"
        )
    omitted = _left_out(scenario.load)
    if omitted:
        notes.append(
            f"the experiments load the rod with a constant force; they leave out these "
            f"parts of the load: {omitted}"
        )
    return tuple(notes)


def _left_out(load: ScenarioLoad) -> str:
    """Names of the parts of the scenario's load that the experiments omit."""
    parts = {
        "force of the load": any(part.shape == "record" or part.value for part in load.force),
        "torque on the joint": any(part.shape == "record" or part.value for part in load.torque),
        "spring": load.stiffness,
        "damper": load.damping,
        "external machine": load.drive is not None,
        "load cylinder": load.cylinder is not None,
    }
    return ", ".join(name for name, acts in parts.items() if acts)


@dataclass(slots=True)
class _Bench:
    """The experiments run so far; requirements that need the same experiment share its result."""

    scenario: Scenario
    tier: LinearTier
    tally: RunCounter
    scale: float
    stands: dict[Spot, Stand] = field(default_factory=dict)
    made: dict[tuple[str, Spot, bool, bool], ExperimentResult] = field(default_factory=dict)

    def row(self, requirement: Requirement) -> VerifiedRequirement:
        """Compare the linear and the measured value for one requirement of the design."""
        spot = self.tier.spot(requirement)
        why = self._impossible(requirement.metric, spot)
        full = ExperimentResult({}, "", why=why) if why else self.measured(requirement.metric, spot)
        value = full.values.get(requirement.metric)
        linear = None if why else self.linear(requirement.metric, spot)
        difference = relative_difference(value, linear)
        shares: dict[str, float] = {}
        reasons = [full.why] if full.why else []
        if difference is not None and abs(difference) > AGREE:
            shares, more = self._reasons(requirement.metric, spot, full)
            reasons += [*more, *self._by_friction(requirement, spot, value)]
        elif difference is not None:
            reasons.append("both agree")
        spot_difference = relative_difference(linear, requirement.value)
        if spot_difference is not None and abs(spot_difference) > AGREE:
            reasons.append(self._compared(requirement.metric, spot))
        return VerifiedRequirement(
            "design",
            requirement.metric,
            requirement.sense,
            requirement.limit,
            requirement.value,
            linear,
            value,
            difference,
            _holds(value, requirement.sense, requirement.limit),
            where=spot.words,
            how=full.how,
            why="; ".join(reasons),
            shares=shares,
        )

    def _by_friction(self, requirement: Requirement, spot: Spot, value: float | None) -> list[str]:
        """A warning if the requirement is met only because the seals stick."""
        if self.scenario.friction.model == "none":
            return []
        frictionless = self.measured(requirement.metric, spot, frictionless=True).values.get(
            requirement.metric
        )
        is_met = _holds(value, requirement.sense, requirement.limit)
        if (
            frictionless is None
            or not is_met
            or _holds(frictionless, requirement.sense, requirement.limit)
        ):
            return []
        return [
            "met only because of seal friction; without it, the value is "
            f"{METRICS[requirement.metric].text(frictionless)}"
        ]

    def _impossible(self, metric: str, spot: Spot) -> str:
        """Reason why an experiment is impossible; empty if it is possible."""
        left_out = self.tier.unsimulated()
        if left_out:
            return left_out
        if metric not in LOOPS:
            oscillates = self.tier.subject.design.load_cases[spot.case].frequency is not None
            needs_oscillation = metric in ("dynamic_stiffness", "dynamic_phase")
            return (
                "no load case has an oscillating load"
                if needs_oscillation and not oscillates
                else ""
            )
        stand = self.stand(spot)
        if stand.plant.valve is None:
            return "the design has no valve"
        if not stand.steady_gain > 0:
            return (
                "no gain stabilises the loop in the linear model, so the loop never comes to rest"
            )
        return ""

    def stand(self, spot: Spot) -> Stand:
        """The simulated test stand of a design at a worst-case point of the linear models."""
        if spot not in self.stands:
            self.stands[spot] = self.tier.stand(self.scenario, spot, self.tally, self.scale)
        return self.stands[spot]

    def _placed(self, metric: str, spot: Spot) -> Stand:
        stand = self.stand(spot)
        return experiments.placed(stand) if metric in LOOPS else experiments.held_place(stand)

    def measured(
        self, metric: str, spot: Spot, *, frictionless: bool = False, small: bool = False
    ) -> ExperimentResult:
        """Result of the experiment that measures a metric; run it if needed."""
        name = _EXPERIMENTS[metric]
        key = name, spot, frictionless, small
        if key not in self.made:
            stand = self._placed(metric, spot)
            stand = stand.frictionless() if frictionless else stand
            stand = stand.with_changes(scale=SMALL * stand.scale) if small else stand
            try:
                self.made[key] = self._made(name, spot, stand)
            except (InputError, Unsolvable) as error:
                self.made[key] = ExperimentResult({}, "", why=f"the experiment failed: {error}")
        return self.made[key]

    def _made(self, name: str, spot: Spot, stand: Stand) -> ExperimentResult:
        tier, at = self.tier, stand.position
        resonance = tier.resonance(spot.case, at)
        design = tier.subject.design
        if name == "closed":
            return experiments.decay(stand, "closed", resonance)
        if name == "decay":
            return experiments.decay(stand, design.ports.end, resonance)
        if name == "shaking":
            frequency = design.load_cases[spot.case].frequency
            assert frequency is not None
            return experiments.dynamic_stiffness(stand, design.ports.end, frequency, resonance)
        rests_extending = self._way(spot, stand)
        figures = tier.figures(spot.case, at, rests_extending)
        response = tier.response(spot.case, at, rests_extending)
        if name == "bandwidth":
            return experiments.bandwidth(stand, figures.bandwidth or stand.bandwidth, response)
        if name == "phase":
            both = [tier.crossings(spot.case, at, extending) for extending in (True, False)]
            crossed, peaks = (sum(parts, ()) for parts in zip(*both, strict=True))
            return experiments.phase_margin(stand, crossed, peaks, response)
        limit, frequency = figures.ultimate_gain, figures.frequency
        if not isfinite(limit):
            limit, frequency = stand.gain, resonance
        swinging = experiments.ultimate_gain(stand, limit, frequency)
        gain = swinging.values["ultimate_gain"]
        margin = None if gain is None else gain / stand.gain
        values = {"ultimate_gain": gain, "gain_margin": margin}
        return ExperimentResult(values, swinging.how, swinging.facts, swinging.why)

    def _way(self, spot: Spot, stand: Stand) -> bool:
        """Whether the spool rests on the extending side.

        For a centred spool, this is the side on which the linear models have their worst value.
        """
        assert stand.plant.valve is not None
        if abs(stand.opening) < CENTRED * stand.plant.valve.signal:
            return bool(spot.extending)
        return stand.opening > 0

    def linear(self, metric: str, spot: Spot) -> float:
        """Value of the linear models for the position and spool direction of an experiment."""
        stand = self._placed(metric, spot)
        if metric in HELD:
            return self.tier.held(spot.case, stand.position)[metric]
        extending = self._way(spot, stand)
        return self.tier.closed(metric, spot.case, stand.position, extending)

    def _reasons(
        self, metric: str, spot: Spot, full: ExperimentResult
    ) -> tuple[dict[str, float], list[str]]:
        """Shares of friction, amplitude and operating point in the difference, with evidence."""
        steps = [("amplitude", self.measured(metric, spot, frictionless=True, small=True))]
        if self.scenario.friction.model != "none":
            steps.insert(0, ("friction", self.measured(metric, spot, frictionless=True)))
        shares: dict[str, float] = {}
        reasons: list[str] = []
        before = full
        for name, without in steps:
            value, remaining = before.values.get(metric), without.values.get(metric)
            if remaining is None or not isfinite(remaining):
                words = without.why or "there is no limit"
                return shares, [*reasons, f"the difference is due to {name}; without it, {words}"]
            share = relative_difference(value, remaining)
            if share is not None and abs(share) > AGREE / 2:
                shares[name] = share
                reasons.append(f"{name} {relative_change(share)} ({evidence(before.facts, name)})")
            before = without
        share = relative_difference(before.values.get(metric), self.linear(metric, spot))
        if share is not None and abs(share) > AGREE / 2:
            shares["operating point"] = share
            pressures = operating_point(before.facts, self.tier.stated(spot.case))
            reasons.append(f"operating point {relative_change(share)} ({pressures})")
        return shares, reasons

    def _compared(self, metric: str, spot: Spot) -> str:
        """Text that states the point at which linear and simulated value are compared.

        It is used if this is not the point at which the linear models have their worst value.
        """
        stand = self._placed(metric, spot)
        words = f"compared at the position {1e3 * stand.position:.3g} mm"
        if metric in HELD:
            return f"{words}, away from the end stop"
        direction = "extending" if self._way(spot, stand) else "retracting"
        return f"{words}, {direction}: the spool rests {stand.opening:.2g} V from its centre"


_EXPERIMENTS = {
    "ultimate_gain": "swinging",
    "gain_margin": "swinging",
    "phase_margin": "phase",
    "bandwidth": "bandwidth",
    "dynamic_stiffness": "shaking",
    "dynamic_phase": "shaking",
    "damping_ratio": "decay",
    "natural_frequency": "closed",
}


def _holds(value: float | None, sense: str, limit: float) -> bool:
    if value is None or isnan(value):
        return False
    if value in (inf, -inf):
        return (value > 0) == (sense == "min")
    gap = value - limit if sense == "min" else limit - value
    return gap >= -TOLERANCE * abs(limit)
