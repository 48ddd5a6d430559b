"""Results of a simulation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, Unsolvable
from ..base.numeric import Array
from ..base.quantities import RESULTS, Quantity
from ..base.tables import Displayed
from ..design.scenario.kinds import SHAPES, Records
from ..design.scenario.model import Scenario, SignalSegment
from ..evaluation.result import State, state_of
from ..models.fluid import ATMOSPHERIC_PRESSURE
from ..studies.plant import Plant
from .basis import Basis
from .components.circuit import Circuit, Loop, acts_after, frequencies, loop_of
from .duty_cycle import CycleComparison
from .harmonic import dynamic_stiffness_of_record, windows
from .integrate import LAST, Event, Stuck, Trajectory
from .linear import StepMetrics, Tuned, step_metrics
from .system import Compiled


@dataclass(frozen=True, slots=True)
class EnergyFlow:
    """Energy that crosses the boundary of the circuit during a simulation [J].

    Inflow is positive.
    """

    name: str
    energy: float


@dataclass(frozen=True, slots=True)
class Balance:
    """Relative errors of the mass and energy balance of a simulation."""

    mass: float
    """Largest error in any volume: |change of content - net inflow|, divided by the largest
    content."""
    energy: float
    """Largest |change of stored energy - net inflow|, divided by all energy that enters, leaves or
    is stored."""
    flows: tuple[EnergyFlow, ...]
    stored: tuple[EnergyFlow, ...]
    """Change of each stored energy during the simulation."""


@dataclass(frozen=True, slots=True)
class Second:
    """Comparison with a second integration method that solves the same equations."""

    method: str
    max_difference: float
    """Largest difference of any compared signal, as a share of its span."""
    signal: str
    """Signal with the largest difference."""
    time: float
    """Time of the largest difference [s]."""
    differences: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Window:
    """Dynamic stiffness in one time window, which contains whole cycles."""

    time: float
    position: float
    """Mean position in the window [m]; `time` is the mean time [s]."""
    stiffness: complex
    """Force divided by position [N/m]."""
    standard_error: float


@dataclass(frozen=True, slots=True)
class HarmonicLoad:
    """Dynamic stiffness at the frequency of the sinusoidal load, in successive time windows."""

    frequency: float
    windows: tuple[Window, ...]


@dataclass(frozen=True, slots=True)
class Servo:
    """Response of the control loop to a step."""

    loop: Loop
    time: float
    """Time of the step [s]."""
    start: float
    target: float
    metrics: StepMetrics


@dataclass(frozen=True, slots=True)
class RequirementResult:
    """A requirement of the scenario, compared with the simulated value."""

    metric: str
    sense: str
    limit: float
    value: float | None
    margin: float | None
    met: bool
    why: str = ""

    @property
    def state(self) -> State:
        """The requirement is "missed", "met", or met without a reserve ("no_reserve")."""
        return state_of(self.met, self.margin, self.limit)


@dataclass(frozen=True, slots=True)
class SignalLabel:
    """Label and quantity of a signal."""

    label: str
    quantity: Quantity


@dataclass(frozen=True, slots=True)
class Simulation(Displayed):
    """Results of a simulated scenario.

    At a jump, `time` contains the same time twice: before and after the jump. `values` are the
    results by the names of `quantities.RESULTS`. A result that does not apply is None, and `why`
    gives the reason.
    """

    scenario: Scenario
    plant: Plant
    spec_hash: str
    time: Array
    signals: Mapping[str, Array]
    told: Mapping[str, SignalLabel]
    balance: Balance
    values: Mapping[str, float | None]
    why: Mapping[str, str]
    requirements: tuple[RequirementResult, ...]
    tuned: Tuned | None
    servo: Servo | None
    shaken: HarmonicLoad | None
    events: tuple[Event, ...]
    notes: tuple[str, ...]
    basis: Basis
    """Values of the equations, each with its origin."""
    second: Second | None = None
    cycle: CycleComparison | None = None
    """Results beside the quasi-static ones, if a duty cycle was simulated."""
    evaluations: int = 0
    seconds: float = 0.0

    @property
    def met(self) -> bool:
        """Whether all requirements are met."""
        return all(row.met for row in self.requirements)

    @property
    def in_short(self) -> tuple[str, str]:
        """The duration, and the number of requirements that are met."""
        total, met = len(self.requirements), sum(row.met for row in self.requirements)
        limits = f", {met} of {total} requirements met" if total else ""
        return self.scenario.name, f"{self.scenario.duration:g} s{limits}"

    def __str__(self) -> str:
        """The results as a table."""
        lines = [f"{self.scenario.name}: {self.plant.design.name}, {self.scenario.duration:g} s"]
        for name, value in self.values.items():
            if value is not None:
                lines.append(f"  {name:20s} {RESULTS[name].text(value)}")
        for row in self.requirements:
            limit = RESULTS[row.metric].text(row.limit)
            lines.append(f"  {row.metric} {row.sense} {limit}: {'met' if row.met else 'missed'}")
        notes = [*(() if self.cycle is None else self.cycle.notes), *self.notes]
        return "\n".join([*lines, *(f"  note: {note}" for note in notes)])

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON, SI; the samples are left out."""
        return {
            "name": self.scenario.name,
            "design": self.plant.design.name,
            "spec_hash": self.spec_hash,
            "signals": {
                name: {
                    "final": float(values[-1]),
                    "min": float(np.min(values)),
                    "max": float(np.max(values)),
                    "unit": self.told[name].quantity.si_unit,
                    "label": self.told[name].label,
                }
                for name, values in self.signals.items()
            },
            "servo": self._servo(),
            "controller": self._controller(),
            "results": {
                name: {
                    "value": value,
                    "unit": RESULTS[name].si_unit,
                    "label": RESULTS[name].label,
                    **({"why": self.why[name]} if value is None else {}),
                }
                for name, value in self.values.items()
            },
            "requirements": [
                {name: getattr(row, name) for name in RequirementResult.__dataclass_fields__}
                for row in self.requirements
            ],
            "balance": {
                "mass": self.balance.mass,
                "energy": self.balance.energy,
                "flows": {flow.name: flow.energy for flow in self.balance.flows},
                "stored": {store.name: store.energy for store in self.balance.stored},
            },
            "dynamic_stiffness": self._shaken(),
            "events": [
                {"name": event.name, "time": event.time, "on": event.on} for event in self.events
            ],
            "second_integrator": self._second(),
            **({} if self.cycle is None else {"duty_cycle": self.cycle.to_dict()}),
            "notes": list(self.notes),
            "basis": self.basis.to_dict(),
            "evaluations": self.evaluations,
            "seconds": self.seconds,
        }

    def _servo(self) -> dict[str, Any] | None:
        servo = self.servo
        if servo is None:
            return None
        return {
            "loop": servo.loop,
            "time": servo.time,
            "start": servo.start,
            "target": servo.target,
            **servo.metrics._asdict(),
        }

    def _second(self) -> dict[str, Any] | None:
        second = self.second
        if second is None:
            return None
        return {
            "method": second.method,
            "max_difference": second.max_difference,
            "signal": second.signal,
            "time": second.time,
            "differences": dict(second.differences),
        }

    def _controller(self) -> dict[str, Any] | None:
        tuned = self.tuned
        if tuned is None:
            return None
        ultimate, margins = tuned.ultimate, tuned.margins
        return {
            "origin": tuned.origin,
            "unit": tuned.unit,
            "proportional_gain": tuned.gains.proportional_gain,
            "integral_time": _finite(tuned.gains.integral_time),
            "derivative_time": tuned.gains.derivative_time,
            "ultimate_gain": None if ultimate is None else _finite(ultimate.gain),
            "ultimate_period": None if ultimate is None else _finite(ultimate.period),
            "gain_margin": None if margins is None else _finite(margins.gain),
            "phase_margin": None if margins is None else margins.phase,
            "stable": None if margins is None else margins.stable,
            **({"why": NOT_ASKED} if margins is None else {}),
        }

    def _shaken(self) -> dict[str, Any] | None:
        if self.shaken is None:
            return None
        return {
            "frequency": self.shaken.frequency,
            "windows": [
                {
                    "time": window.time,
                    "position": window.position,
                    "stiffness": abs(window.stiffness),
                    "phase": float(np.angle(window.stiffness)),
                    "standard_error": window.standard_error,
                }
                for window in self.shaken.windows
            ],
        }


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


NOT_ASKED = "the gain needs no margins; simulate --margins (margins=True) computes them"
"""Reason for missing margins."""
RISE = 4
"""Step response results are reliable if the rise lasts at least this number of sample intervals
(our choice)."""
NOT_HERE = "does not apply to this scenario"
NO_STEP = "the reference has no step"
NO_MOTION = "the reference does not keep moving"
NO_SINE = "no sinusoidal load acts on the rod"
NO_STOP = "the piston does not reach a stop"
EXPECTED = (NOT_HERE, NO_STEP, NO_MOTION, NO_SINE, NO_STOP)
"""Reasons for missing results that are obvious from the scenario and therefore not reported."""
_STEP = ("rise_time", "settling_time", "overshoot", "steady_state_ratio")


def reference(scenario: Scenario) -> tuple[Loop | None, Sequence[SignalSegment]]:
    """The control loop of a scenario, and the pieces of its reference signal."""
    loop = loop_of(scenario.control)
    return loop, () if loop is None else getattr(scenario.control, loop)


def servo(scenario: Scenario, time: Array, signals: Mapping[str, Array]) -> Servo | None:
    """Response to the first step of the reference, until the reference changes again.

    None if it has no step.
    """
    loop, parts = reference(scenario)
    steps = [part for part in parts if part.shape == "step"]
    if loop is None or not steps or not all(SHAPES[part.shape].settles for part in parts):
        return None
    first = min(steps, key=lambda part: part.start)
    moving_parts = [part for part in parts if SHAPES[part.shape].moves_on]
    if any(
        part.start <= first.start < (part.end or 0.0) for part in moving_parts
    ):  # the target is not constant
        return None
    changes = [t for part in parts for t in (part.start, part.end) if t is not None]
    end = min((t for t in changes if t > first.start), default=scenario.duration)
    value = signals[loop]
    inside = np.flatnonzero((time >= first.start) & (time <= end))
    if first.start > 0 and inside.size:  # the time of the step occurs twice
        inside = inside[time[inside] > first.start]
        inside = np.concatenate(([inside[0] - 1], inside)) if inside.size else inside
    if inside.size < 3:
        return None
    reference_values = signals["reference"]
    target = float(reference_values[inside[1]])
    start = float(reference_values[inside[0] - 1]) if inside[0] > 0 else float(value[0])
    if start == target:
        return None
    metrics = step_metrics(time=time[inside], response=value[inside], start=start, target=target)
    return Servo(loop, first.start, start, target, metrics)


def harmonic_load(
    scenario: Scenario, time: Array, signals: Mapping[str, Array]
) -> tuple[HarmonicLoad | None, str]:
    """Dynamic stiffness under a sinusoidal load in each time window, or why it is missing."""
    if "position" not in signals:
        return None, NO_SINE
    load = scenario.load
    parts: list[SignalSegment] = [
        *load.force,
        *(load.drive.position if load.drive is not None else ()),
    ]
    parts += load.cylinder.signal if load.cylinder is not None else ()
    sines = [part for part in parts if "frequency" in SHAPES[part.shape].needed]
    tones = set(frequencies(sines))
    if len(tones) != 1:
        several = "sinusoidal loads of several frequencies act on the rod"
        return None, several if tones else NO_SINE
    tone = tones.pop()
    begin = max(part.start for part in sines)
    end = min(part.end or scenario.duration for part in sines)
    inside = (time >= begin) & (time <= end)
    t, first_index = np.unique(time[inside], return_index=True)
    x, force = (signals[name][inside][first_index] for name in ("position", "load_force"))
    cycles = int(scenario.analysis.window_cycles)
    try:
        pieces = windows(time=t, frequency=tone, cycles=cycles)
        stiffnesses = tuple(_window(t[piece], x[piece], -force[piece], tone) for piece in pieces)
    except InputError as error:
        return None, error.diagnostics[0].message
    return HarmonicLoad(tone, stiffnesses), ""


def _window(time: Array, position: Array, force: Array, frequency: float) -> Window:
    dynamic_stiffness = dynamic_stiffness_of_record(
        time=time, position=position, force=force, frequency=frequency
    )
    return Window(
        float(np.mean(time)),
        float(np.mean(position)),
        dynamic_stiffness.stiffness,
        dynamic_stiffness.standard_error,
    )


def _step_results(step: Servo, spacing: float) -> tuple[dict[str, float | None], dict[str, str]]:
    """Results of a step response, and reasons for missing results.

    `spacing` is the sample time [s].
    """
    metrics = step.metrics
    error = abs(metrics.steady_state_error) / abs(step.target - step.start)
    if metrics.rise_time is not None and metrics.rise_time < RISE * spacing:
        coarse = (
            f"the rise takes {RISE} samples or fewer, which is too coarse; state a "
            "shorter sample_time"
        )
        return dict.fromkeys(_STEP) | {"steady_state_ratio": error}, dict.fromkeys(_STEP, coarse)
    figures = {
        "rise_time": metrics.rise_time,
        "settling_time": metrics.settling_time,
        "overshoot": metrics.overshoot,
        "steady_state_ratio": error,
    }
    return figures, {
        "rise_time": "the response never reaches 90 % of the step",
        "settling_time": "the response does not stay within 2 % of the step",
    }


def values(
    scenario: Scenario,
    plant: Plant,
    time: Array,
    signals: Mapping[str, Array],
    balance: Balance,
    events: Sequence[Event],
    step: Servo | None,
    dynamic: HarmonicLoad | None,
    still: str,
    records: Records,
) -> tuple[dict[str, float | None], dict[str, str]]:
    """Every result of `quantities.RESULTS`; a result that does not apply is None, with a reason."""
    results: dict[str, float | None] = dict.fromkeys(RESULTS)
    why = dict.fromkeys(RESULTS, NOT_HERE)
    why |= dict.fromkeys(_STEP, NO_STEP)
    if step is not None:
        figures, reasons = _step_results(step, float(np.median(np.diff(time))))
        results |= figures
        why |= reasons
    chambers = [signals[name] for name in ("pressure_a", "pressure_b") if name in signals]
    if chambers:
        results["peak_pressure"] = float(max(np.max(chamber) for chamber in chambers))
        lowest = float(min(np.min(chamber) for chamber in chambers))
        results["lowest_pressure"] = lowest
        results["cavitation_margin"] = lowest + ATMOSPHERIC_PRESSURE - plant.oil.vapour_pressure
    if "position" in signals:
        results["hold_drift"] = _drift(scenario, records, time, signals)
        why["hold_drift"] = (
            "valve signal, reference or load still cause motion in the last tenth of the time"
        )
        speed = _stop_speed(time, signals["speed"], events)
        results["stop_speed"], why["stop_speed"] = speed, NO_STOP
    loop, parts = reference(scenario)
    if loop == "position" and any(SHAPES[part.shape].moves_on for part in parts):
        late = time >= _settled_from(parts, scenario.duration)
        results["following_error"] = float(np.max(np.abs(signals["error"][late])))
    why["following_error"] = NO_MOTION
    energies = {flow.name: flow.energy for flow in balance.flows}
    if "supply" in energies:
        results["supply_energy"] = energies["supply"]
        work = -(energies.get("load", 0.0) + energies.get("joint", 0.0))
        net = energies["supply"] + energies.get("return line", 0.0)
        results["efficiency"] = work / net if work > 0 and net > 0 else None
        why["efficiency"] = "the actuator did no net work on the load"
        if scenario.supply.accumulator is not None:
            results["efficiency"] = None
            why["efficiency"] = "the accumulator supplies part of the work"
        if scenario.load.cylinder is not None or scenario.load.drive is not None:
            why["efficiency"] = "work of an external machine is not counted"
    if dynamic is not None:
        later = dynamic.windows[1:] or dynamic.windows  # the first window contains the transient
        worst = min(later, key=lambda window: abs(window.stiffness))
        results["dynamic_stiffness"] = abs(worst.stiffness)
        results["dynamic_phase"] = float(np.angle(worst.stiffness))
    why |= dict.fromkeys(("dynamic_stiffness", "dynamic_phase"), still)
    return results, {name: reason for name, reason in why.items() if results[name] is None}


def _settled_from(parts: Sequence[SignalSegment], duration: float) -> float:
    """Time at which the following error is first evaluated.

    This is the start of the reference, plus one period of its slowest sine if it has one, but at
    most 90 % of the duration.
    """
    tones = frequencies(parts)
    begin = min(part.start for part in parts)
    return min(begin + (1 / min(tones) if tones else 0.0), 0.9 * duration)


def _drift(
    scenario: Scenario, records: Records, time: Array, signals: Mapping[str, Array]
) -> float | None:
    """Mean speed over the last tenth of the time; None if a motion is commanded."""
    begin = (1 - LAST) * scenario.duration
    loop, parts = reference(scenario)
    load = scenario.load
    acting = [*load.force, *load.torque, *(load.drive.position if load.drive else ()), *parts]
    acting += load.cylinder.signal if load.cylinder is not None else ()
    acting += () if parts else scenario.signal
    if any(acts_after(part, begin, records) for part in acting):
        return None
    late = time >= begin
    open_loop = loop is None and "signal" in signals and np.any(signals["signal"][late] != 0)
    if open_loop or (loop == "speed" and np.any(signals["reference"][late] != 0)):
        return None
    t, x = time[late], signals["position"][late]
    return float(abs(x[-1] - x[0]) / (t[-1] - t[0]))


def _stop_speed(time: Array, speed: Array, events: Sequence[Event]) -> float | None:
    contacts = [event.time for event in events if event.on and event.name.startswith("stop")]
    if not contacts:
        return None
    return float(max(abs(np.interp(t, time, speed)) for t in contacts))


def requirements(
    scenario: Scenario, results: Mapping[str, float | None], why: Mapping[str, str]
) -> tuple[RequirementResult, ...]:
    """Every requirement of the scenario, compared with its result."""
    rows = []
    for metric, limit in scenario.requirements.items():
        for sense in ("min", "max"):
            bound: float | None = getattr(limit, sense)
            if bound is None:
                continue
            value = results.get(metric)
            if value is None and metric == "stop_speed" and sense == "max":
                value = 0.0  # the piston reaches no end stop
            if value is None:
                rows.append(
                    RequirementResult(metric, sense, bound, None, None, False, why.get(metric, ""))
                )
                continue
            gap = value - bound if sense == "min" else bound - value
            margin = gap / abs(bound) if bound else gap
            rows.append(RequirementResult(metric, sense, bound, value, margin, margin >= -1e-6))
    return tuple(rows)


def balance(circuit: Circuit, run: Trajectory) -> Balance:
    """Mass and energy balance of a simulation, computed from its states."""
    audit, system = circuit.audit, circuit.system
    at = {state.symbol.index: k for k, state in enumerate(system.states)}

    def integral(symbol: object) -> Array:
        return run.states[at[symbol.index]]  # type: ignore[attr-defined]

    audited = [value for _, value, _ in audit.mass] + [value for _, value in audit.stored]
    values = system.equations(audited).at_samples(run.time, run.states, run.flags)
    contents, stored = values[: len(audit.mass)], values[len(audit.mass) :]
    mass = 0.0
    for (_, _, inflow), content in zip(audit.mass, contents, strict=True):
        imbalance = content - content[0] - integral(inflow)
        mass = max(mass, float(np.max(np.abs(imbalance)) / np.max(np.abs(content))))
    changes: dict[str, Array] = {}
    for (name, _), value in zip(audit.stored, stored, strict=True):
        changes[name] = changes.get(name, 0.0) + value - value[0]
    energies: dict[str, Array] = {}
    for name, symbol, into in audit.flows:
        energies[name] = energies.get(name, 0.0) + (1 if into else -1) * integral(symbol)
    imbalance = sum(changes.values(), start=np.zeros(len(run.time))) - sum(energies.values())
    throughput = sum(float(np.sum(np.abs(np.diff(value)))) for value in energies.values())
    throughput += max((float(np.ptp(value)) for value in changes.values()), default=0.0)
    return Balance(
        mass=mass,
        energy=float(np.max(np.abs(imbalance))) / throughput if throughput > 0 else 0.0,
        flows=tuple(EnergyFlow(name, float(value[-1])) for name, value in energies.items()),
        stored=tuple(EnergyFlow(name, float(value[-1])) for name, value in changes.items()),
    )


EXPLAINING = ("position", "speed", "shaft_speed", "pressure_a", "pressure_b", "pressure_supply")
"""Signals whose values at the time of failure are reported if an integration fails."""
OUT = 0.1
"""Travel past the end of the stroke, as a share of the stroke, above which the end stops count as
too soft for the load (our choice)."""


def failed(stuck: Stuck, compiled: Compiled, plant: Plant) -> Unsolvable:
    """Error for a failed integration, with the actuator's state at that time and a remedy."""
    flags = np.zeros((len(compiled.system.flags), 1), dtype=bool)
    signals = compiled.signals(np.array([stuck.time]), stuck.state[:, None], list(flags))
    words = [
        f"{signal.label} {signal.quantity.text(float(signals[signal.name][0]))}"
        for signal in compiled.system.signals
        if signal.name in EXPLAINING and np.isfinite(signals[signal.name][0])
    ]
    (fault,) = stuck.diagnostics
    at = f" ({', '.join(words)})" if words else ""
    remedy = _outside(signals, plant) or fault.remedy
    return Unsolvable(Diagnostic(f"{fault.message}{at}", remedy))


def _outside(signals: Mapping[str, Array], plant: Plant) -> str:
    """Remedy if the piston has left its stroke; empty if it has not."""
    if "position" not in signals:
        return ""
    position = float(signals["position"][0])
    beyond = max(-position, position - plant.stroke)
    if plant.design.linkage is not None and beyond > 0:
        return (
            "the load pushes the piston so far into the end stop that the linkage reaches its dead "
            "centre: lower the load"
        )
    if beyond > OUT * plant.stroke:
        return (
            "the piston is beyond its stops: lower the load, or stiffen the stops (smaller "
            "stop_travel)"
        )
    return ""
