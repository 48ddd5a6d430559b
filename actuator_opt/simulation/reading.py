"""Results from the signals of a run: loop performance, pressures, stiffness, requirements."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..base.errors import InputError
from ..base.numeric import Array
from ..base.quantities import RESULTS
from ..design.scenario.model import Scenario
from ..design.scenario.shapes import SHAPES
from ..design.scenario.signals import SignalSegment
from ..models.fluid import ATMOSPHERIC_PRESSURE
from ..studies.plant import Plant
from .harmonic import dynamic_stiffness_of_record, windows
from .integrate import Event
from .loops import Loop, loop_of
from .parts.signals import Records, acts_after, frequencies
from .result import Balance, HarmonicLoad, RequirementResult, Servo, Window
from .step_response import step_metrics

LAST = 0.1
"""Final share of the time used for creep."""
RISE = 4
"""Least number of samples of a rise for reliable results (a choice)."""
NOT_HERE = "does not apply to this scenario"
NO_STEP = "the reference has no step"
NO_MOTION = "the reference does not move on"
NO_SINE = "no sinusoidal load acts on the rod"
NO_STOP = "the piston does not reach a stop"
EXPECTED = (NOT_HERE, NO_STEP, NO_MOTION, NO_SINE, NO_STOP)
"""Reasons of missing results that follow from the scenario and need no report."""
_STEP = ("rise_time", "settling_time", "overshoot", "steady_state_ratio")


def reference(scenario: Scenario) -> tuple[Loop | None, Sequence[SignalSegment]]:
    """The loop of a scenario and the parts of its reference."""
    loop = loop_of(scenario.control)
    return loop, () if loop is None else getattr(scenario.control, loop)


def servo(scenario: Scenario, time: Array, signals: Mapping[str, Array]) -> Servo | None:
    """Response to the first step of the reference, until it changes again; None without a step."""
    loop, parts = reference(scenario)
    steps = [part for part in parts if part.shape == "step"]
    if loop is None or not steps or not all(SHAPES[part.shape].settles for part in parts):
        return None
    first = min(steps, key=lambda part: part.start)
    moving = [part for part in parts if SHAPES[part.shape].moves_on]
    if any(one.start <= first.start < (one.end or 0.0) for one in moving):  # no constant target
        return None
    changes = [t for part in parts for t in (part.start, part.end) if t is not None]
    end = min((t for t in changes if t > first.start), default=scenario.duration)
    value = signals[loop]
    inside = np.flatnonzero((time >= first.start) & (time <= end))
    if first.start > 0 and inside.size:  # the instant appears twice
        inside = inside[time[inside] > first.start]
        inside = np.concatenate(([inside[0] - 1], inside)) if inside.size else inside
    if inside.size < 3:
        return None
    asked = signals["reference"]
    target = float(asked[inside[1]])
    start = float(asked[inside[0] - 1]) if inside[0] > 0 else float(value[0])
    if start == target:
        return None
    found = step_metrics(time=time[inside], response=value[inside], start=start, target=target)
    return Servo(loop, first.start, start, target, found)


def shaken(
    scenario: Scenario, time: Array, signals: Mapping[str, Array]
) -> tuple[HarmonicLoad | None, str]:
    """Dynamic stiffness along the stroke under a sinusoidal load, or the reason for none."""
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
    t, keep = np.unique(time[inside], return_index=True)
    x, force = (signals[name][inside][keep] for name in ("position", "load_force"))
    cycles = int(scenario.analysis.window_cycles)
    try:
        pieces = windows(time=t, frequency=tone, cycles=cycles)
        found = tuple(_window(t[one], x[one], -force[one], tone) for one in pieces)
    except InputError as error:
        return None, error.diagnostics[0].message
    return HarmonicLoad(tone, found), ""


def _window(time: Array, position: Array, force: Array, frequency: float) -> Window:
    one = dynamic_stiffness_of_record(
        time=time, position=position, force=force, frequency=frequency
    )
    return Window(float(np.mean(time)), float(np.mean(position)), one.stiffness, one.standard_error)


def _answer(step: Servo, apart: float) -> tuple[dict[str, float | None], dict[str, str]]:
    """Step response results at a sample spacing [s], and reasons for missing ones."""
    own = step.metrics
    error = abs(own.steady_state_error) / abs(step.target - step.start)
    if own.rise_time is not None and own.rise_time < RISE * apart:
        coarse = f"the rise takes at most {RISE} samples: state a shorter sample_time"
        return dict.fromkeys(_STEP) | {"steady_state_ratio": error}, dict.fromkeys(_STEP, coarse)
    found = {
        "rise_time": own.rise_time,
        "settling_time": own.settling_time,
        "overshoot": own.overshoot,
        "steady_state_ratio": error,
    }
    return found, {
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
    """Every result of `quantities.RESULTS`, None with a reason if it does not apply."""
    found: dict[str, float | None] = dict.fromkeys(RESULTS)
    why = dict.fromkeys(RESULTS, NOT_HERE)
    why |= dict.fromkeys(_STEP, NO_STEP)
    if step is not None:
        figures, reasons = _answer(step, float(np.median(np.diff(time))))
        found |= figures
        why |= reasons
    chambers = [signals[name] for name in ("pressure_a", "pressure_b") if name in signals]
    if chambers:
        found["peak_pressure"] = float(max(np.max(one) for one in chambers))
        lowest = float(min(np.min(one) for one in chambers))
        found["lowest_pressure"] = lowest
        found["cavitation_margin"] = lowest + ATMOSPHERIC_PRESSURE - plant.oil.vapour_pressure
    if "position" in signals:
        found["hold_drift"] = _drift(scenario, records, time, signals)
        why["hold_drift"] = "signal, reference or load still cause motion in the last tenth"
        speed = _stop_speed(time, signals["speed"], events)
        found["stop_speed"], why["stop_speed"] = speed, NO_STOP
    loop, parts = reference(scenario)
    if loop == "position" and any(SHAPES[part.shape].moves_on for part in parts):
        late = time >= _settled_from(parts, scenario.duration)
        found["following_error"] = float(np.max(np.abs(signals["error"][late])))
    why["following_error"] = NO_MOTION
    came = {flow.name: flow.energy for flow in balance.flows}
    if "supply" in came:
        found["supply_energy"] = came["supply"]
        work = -(came.get("load", 0.0) + came.get("joint", 0.0))
        net = came["supply"] + came.get("return line", 0.0)
        found["efficiency"] = work / net if work > 0 and net > 0 else None
        why["efficiency"] = "no work was done on the load"
        if scenario.supply.accumulator is not None:
            found["efficiency"] = None
            why["efficiency"] = "the accumulator supplies part of the work"
        if scenario.load.cylinder is not None or scenario.load.drive is not None:
            why["efficiency"] = "work of an external machine is not counted"
    if dynamic is not None:
        settled = dynamic.windows[1:] or dynamic.windows  # the first value belongs to the start
        worst = min(settled, key=lambda one: abs(one.stiffness))
        found["dynamic_stiffness"] = abs(worst.stiffness)
        found["dynamic_phase"] = float(np.angle(worst.stiffness))
    why |= dict.fromkeys(("dynamic_stiffness", "dynamic_phase"), still)
    return found, {name: reason for name, reason in why.items() if found[name] is None}


def _settled_from(parts: Sequence[SignalSegment], duration: float) -> float:
    """Time after one period of the slowest sine, or zero."""
    tones = frequencies(parts)
    begin = min(part.start for part in parts)
    return min(begin + (1 / min(tones) if tones else 0.0), 0.9 * duration)


def _drift(
    scenario: Scenario, records: Records, time: Array, signals: Mapping[str, Array]
) -> float | None:
    """Mean speed over the last part, if nothing commands motion."""
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
    touched = [event.time for event in events if event.on and event.name.startswith("stop")]
    if not touched:
        return None
    return float(max(abs(np.interp(t, time, speed)) for t in touched))


def requirements(
    scenario: Scenario, found: Mapping[str, float | None], why: Mapping[str, str]
) -> tuple[RequirementResult, ...]:
    """Every limit of the scenario against its result."""
    rows = []
    for metric, limit in scenario.requirements.items():
        for sense in ("min", "max"):
            bound: float | None = getattr(limit, sense)
            if bound is None:
                continue
            value = found.get(metric)
            if value is None and metric == "stop_speed" and sense == "max":
                value = 0.0  # no stop is reached
            if value is None:
                rows.append(
                    RequirementResult(metric, sense, bound, None, None, False, why.get(metric, ""))
                )
                continue
            gap = value - bound if sense == "min" else bound - value
            margin = gap / abs(bound) if bound else gap
            rows.append(RequirementResult(metric, sense, bound, value, margin, margin >= -1e-6))
    return tuple(rows)
