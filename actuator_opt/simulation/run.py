"""Simulate a scenario."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from dataclasses import replace
from time import perf_counter
from typing import Final

import numpy as np

from ..base.numeric import Array
from ..base.quantities import INPUTS
from ..design.scenario.kinds import Records
from ..design.scenario.model import SAMPLES, Scenario
from ..design.scenario.reader import recorded_notes
from ..evaluation.build import spec_hash
from ..evaluation.kernel import PreparedDesign
from ..models.supply import relief_flow
from ..studies.plant import Plant, plant
from . import result as reading
from .assemble import assemble
from .components.circuit import Circuit
from .integrate import Method, Stuck, Trajectory, integrate
from .linear import CAUSES, UNHELD, Tuned, tune
from .result import Second, SignalLabel, Simulation, balance, failed
from .system import Compiled

SECOND: Final[dict[Method, Method]] = {"lsoda": "radau", "cvodes": "radau", "radau": "lsoda"}
"""Second integrator for each method."""
COMPARED = (
    "position", "speed", "pressure_a", "pressure_b", "shaft_speed", "shaft_angle", "spool",
    "flow_a", "flow_b",
)  # fmt: skip
"""Signals compared between the two integrators."""
TORN = -0.8e5
"""Gauge pressure below which cavitation is reported [Pa] (a choice: air is released before)."""
COARSE = 1e-3
"""Sample time above which oil pressure peaks may be missed [s] (a choice: at 125 Hz, an eighth of a
period)."""
SETTLED = 0.02
"""Difference of a pump line's initial pressure, as a share, that is reported (a choice)."""
WARN_PLANE = 0.02
"""Fit error of friction over pressure that is reported."""


def simulate(
    scenario: Scenario,
    subject: PreparedDesign,
    *,
    records: Records | None = None,
    verify: bool = False,
    method: Method = "lsoda",
) -> Simulation:
    """Simulate a scenario around a design.

    Parameters
    ----------
    scenario : what happens
    subject : the design, with the values that the scenario sets
    records : columns of the files that its signals name
    verify : integrate again by another method and compare
    method : of the integration

    Raises
    ------
    InputError
        a missing valve or gain, or a law without a tuning rule
    Unsolvable
        the integration fails; gives the time
    """
    begin = perf_counter()
    files = {} if records is None else records
    own = plant(subject)
    tuned = tune(scenario, own, files)
    return run(
        scenario, own, files, tuned, verify=verify, method=method,
        spec=spec_of(subject, scenario), begin=begin,
    )  # fmt: skip


def run(
    scenario: Scenario,
    own: Plant,
    records: Records,
    tuned: Tuned | None,
    *,
    verify: bool = False,
    method: Method = "lsoda",
    spec: str = "",
    begin: float | None = None,
) -> Simulation:
    """Simulate a scenario around a plant with known gains; parameters as `simulate`."""
    begin = perf_counter() if begin is None else begin
    circuit = assemble(scenario, own, records, None if tuned is None else tuned.gains)
    compiled = circuit.system.compiled()
    step = scenario.sample_time or scenario.duration / SAMPLES
    try:
        trajectory = integrate(
            compiled, duration=scenario.duration, sample_time=step, method=method
        )
    except Stuck as stuck:
        raise failed(stuck, compiled, own) from None
    signals = compiled.signals(trajectory.time, trajectory.states, trajectory.flags)
    added = balance(circuit, trajectory)
    followed = reading.servo(scenario, trajectory.time, signals)
    dynamic, still = reading.harmonic_load(scenario, trajectory.time, signals)
    values, why = reading.values(
        scenario,
        own,
        trajectory.time,
        signals,
        added,
        trajectory.events,
        followed,
        dynamic,
        still,
        records,
    )
    result = Simulation(
        scenario=scenario,
        plant=own,
        spec_hash=spec,
        time=trajectory.time,
        signals=signals,
        told={
            signal.name: SignalLabel(signal.label, signal.quantity)
            for signal in circuit.system.signals
        },
        balance=added,
        values=values,
        why=why,
        requirements=reading.requirements(scenario, values, why),
        tuned=tuned,
        servo=followed,
        shaken=dynamic,
        events=trajectory.events,
        notes=(
            *recorded_notes(scenario, records),
            *_notes(circuit, own, tuned),
            *_reference_outside_stroke(own, signals),
            *_limits(scenario, own, signals),
            *_coarse_samples(step, signals),
            *_pump_not_in_equilibrium(scenario, own),
        ),
        evaluations=trajectory.evaluations,
        seconds=perf_counter() - begin,
    )
    if not verify:
        return result
    second = _checked_by(compiled, scenario, step, trajectory, signals, SECOND[method])
    return replace(result, second=second)


def _checked_by(
    compiled: Compiled,
    scenario: Scenario,
    step: float,
    first: Trajectory,
    signals: dict[str, Array],
    method: Method,
) -> Second:
    """Integrate again by another method: largest difference, relative to each signal's span."""
    other = integrate(compiled, duration=scenario.duration, sample_time=step, method=method)
    again = compiled.signals(other.time, other.states, other.flags)
    grid, at = _single_instants(first.time)
    times, there = _single_instants(other.time)
    differences, where = {}, {}
    for name in COMPARED:
        if name not in signals:
            continue
        reference = signals[name][at]
        deviation = np.abs(reference - np.interp(grid, times, again[name][there]))
        span = float(np.ptp(reference))
        if span <= 1e-9 * max(float(np.max(np.abs(reference))), 1e-12):
            continue
        worst = int(np.argmax(deviation))
        differences[name], where[name] = float(deviation[worst]) / span, float(grid[worst])
    name = max(differences, key=lambda signal: differences[signal], default="")
    if not name:
        return Second(method, 0.0, "", 0.0, {})
    return Second(method, differences[name], name, where[name], differences)


def _single_instants(time: Array) -> tuple[Array, Array]:
    """Samples without the doubled instants, so that jumps are compared away from the edge."""
    instants, first, count = np.unique(time, return_index=True, return_counts=True)
    single = count == 1
    return instants[single], first[single]


def _notes(circuit: Circuit, own: Plant, tuned: Tuned | None) -> tuple[str, ...]:
    """Notes on a run for its reader."""
    notes = [*circuit.system.notes]
    if tuned is not None:
        notes += tuned.notes
        if tuned.unheld:
            consequence = "the margins of the linear loop are meaningless"
            notes.append(f"{UNHELD}{tuned.unheld}: {consequence}; {CAUSES}")
        elif not tuned.margins.stable:
            notes.append(
                f"the linear loop is unstable: gain margin {tuned.margins.gain:.2f}; it "
                "oscillates until limited by the valve or the friction"
            )
    stated, seals = circuit.scenario.friction, own.seals
    if stated.coulomb is None and stated.model != "none" and circuit.scenario.motor is None:
        error = max(seals.coulomb.error, seals.static.error)
        if error > WARN_PLANE:
            notes.append(f"the fit of friction over the pressures is within {100 * error:.1f} %")
        films = [place for place in ("piston", "rod") if own.films[place]]
        if films:
            notes.append(
                f"the {' and '.join(films)} seal's oil film is simulated as dry friction with "
                "its coefficient: state friction.coulomb and viscous for its running friction"
            )
    if own.design.ports.accumulators:
        notes.append("accumulators at the ports (ports.accumulators) are not simulated")
    return tuple(notes)


def _limits(scenario: Scenario, own: Plant, signals: Mapping[str, Array]) -> Iterator[str]:
    """Cavitation, excess pressure, or a load cylinder at its end, which the equations ignore."""
    where = "chamber" if scenario.motor is None else "pipe"
    for name in ("pressure_a", "pressure_b"):
        if name not in signals:
            continue
        text, side = INPUTS["pressure"].text, f"{where} {name[-1].upper()}"
        lowest, highest = float(np.min(signals[name])), float(np.max(signals[name]))
        if lowest < TORN:
            yield f"the oil in {side} cavitates: {text(lowest)} gauge"
        if highest > own.proof_pressure:
            proof = text(own.proof_pressure)
            yield (
                f"the pressure in {side} peaks at {text(highest)}, above the proof pressure of "
                f"{proof}"
            )
    bench = scenario.load.cylinder
    if bench is not None and "position" in signals:
        x = signals["position"]
        if float(np.max(np.abs(x - x[0]))) > 0.5 * bench.stroke:
            yield "the load cylinder exceeds its stroke: it starts in the middle and has no stops"


def _coarse_samples(step: float, signals: Mapping[str, Array]) -> Iterator[str]:
    """Samples that may miss a peak."""
    if step > COARSE and "pressure_a" in signals:
        apart = f"{1e3 * step:.3g} ms apart"
        yield f"peaks and step results are taken from samples, {apart}: state a shorter sample_time"


def _pump_not_in_equilibrium(scenario: Scenario, own: Plant) -> Iterator[str]:
    """A pump that does not start in equilibrium with its relief valve."""
    from scipy.optimize import brentq

    unit = scenario.supply
    if unit.type != "fixed_pump" or unit.relief is None or unit.flow is None:
        return
    relief, flow, text = unit.relief, unit.flow, INPUTS["pressure"].text

    def excess_flow(over: float) -> float:
        relieved = relief_flow(
            pressure_difference=relief.pressure + over,
            cracking_pressure=relief.pressure,
            override=relief.override,
            rated_flow=relief.rated_flow,
        )
        return float(relieved) - flow

    over = float(brentq(excess_flow, 0.0, 2 * relief.override))  # includes the pump, as checked
    equilibrium = own.return_pressure + relief.pressure + over
    if abs(equilibrium - own.supply_pressure) > SETTLED * own.supply_pressure:
        yield (
            f"the supply line starts at {text(own.supply_pressure)} (supply.pressure), but pump "
            f"and relief valve settle near {text(equilibrium)}: set supply.pressure there"
        )


def _reference_outside_stroke(own: Plant, signals: Mapping[str, Array]) -> Iterator[str]:
    """A reference outside the stroke."""
    if "reference" not in signals or "position" not in signals:
        return
    reference = signals["reference"]
    low, high = float(np.min(reference)), float(np.max(reference))
    follows = np.allclose(reference - signals["error"], signals["position"])
    if follows and (low < 0 or high > own.stroke):
        length = INPUTS["position"].text
        yield (
            f"the reference ranges from {length(low)} to {length(high)}, but the stroke ends at "
            f"{length(own.stroke)}"
        )


def spec_of(subject: PreparedDesign, scenario: Scenario) -> str:
    """Hash of everything that affects the result."""
    content = json.dumps(scenario.model_dump(mode="json"), sort_keys=True, default=str)
    text = spec_hash(subject) + content
    return hashlib.sha256(text.encode()).hexdigest()[:16]
