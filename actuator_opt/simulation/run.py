"""Simulate a scenario."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from time import perf_counter
from typing import Final

import numpy as np

from ..base.numeric import Array
from ..base.quantities import INPUTS, SCENARIOS
from ..design.data_file_reader import replace_by_digests
from ..design.ideal import assumptions
from ..design.scenario.kinds import Records
from ..design.scenario.model import SAMPLES, Scenario
from ..design.scenario.reader import recorded_notes
from ..evaluation.build import leave_out_unset, spec_hash
from ..evaluation.kernel import PreparedDesign
from ..models.supply import relief_flow
from ..studies.plant import Plant, plant
from . import result as results
from .assemble import assemble
from .basis import basis
from .components import motion
from .components.circuit import Circuit
from .duty_cycle import compare, plant_of, spool_lag
from .integrate import Method, Stuck, Trajectory, integrate
from .linear import CAUSES, UNHELD, Tuned, tune
from .result import Second, SignalLabel, Simulation
from .system import Compiled

SECOND: Final[dict[Method, Method]] = {"lsoda": "radau", "radau": "lsoda"}
"""For each integration method, the second method that checks it."""
COMPARED = (
    "position", "speed", "pressure_a", "pressure_b", "shaft_speed", "shaft_angle", "spool",
    "flow_a", "flow_b",
)  # fmt: skip
"""Signals that are compared between the two methods."""
TORN = -0.8e5
"""Gauge pressure below which cavitation is reported [Pa] (our choice; oil releases air at higher
pressures already)."""
COARSE = 1e-3
"""Sample time above which peaks of the oil pressure may be missed [s] (our choice: an eighth of a
period at 125 Hz)."""
SETTLED = 0.02
"""Relative difference between the initial pressure of a pump line and its equilibrium pressure,
above which a note reports it (our choice)."""
WARN_PLANE = 0.02
"""A simulation uses a simple function of the chamber pressures, fitted to the friction of the
seals. If its relative error exceeds this value, a note reports the error."""


def simulate(
    scenario: Scenario,
    subject: PreparedDesign,
    *,
    records: Records | None = None,
    verify: bool = False,
    margins: bool = False,
    method: Method = "lsoda",
) -> Simulation:
    """Simulate a scenario around a design.

    Parameters
    ----------
    scenario : inputs over time
    subject : the design, already with the values that the scenario sets
    records : columns of the files that the scenario's signals name
    verify : whether to integrate again by another method and compare the results
    margins : whether to compute the margins of the linear loop although no gain is tuned by them
    method : integration method

    Raises
    ------
    InputError
        a missing valve or gain, or a control law without a tuning rule
    Unsolvable
        the integration fails; the message gives the time
    """
    begin = perf_counter()
    files = {} if records is None else records
    actuator = plant(subject)
    tuned = tune(scenario, actuator, files, with_margins=margins)
    result = run(
        scenario, actuator, files, tuned, verify=verify, method=method,
        spec=spec_of(subject, scenario), begin=begin,
    )  # fmt: skip
    cycle = compare(scenario, subject, actuator, result.time, result.signals)
    return result if cycle is None else replace(result, cycle=cycle)


def run(
    scenario: Scenario,
    actuator: Plant,
    records: Records,
    tuned: Tuned | None,
    *,
    verify: bool = False,
    method: Method = "lsoda",
    spec: str = "",
    begin: float | None = None,
) -> Simulation:
    """Simulate a scenario for a plant and known controller gains.

    The other parameters are as in `simulate`.
    """
    begin = perf_counter() if begin is None else begin
    actuator = plant_of(scenario, actuator)
    circuit = assemble(scenario, actuator, records, None if tuned is None else tuned.gains)
    compiled = circuit.system.compiled()
    step = scenario.sample_time or scenario.duration / SAMPLES
    try:
        trajectory = integrate(
            compiled, duration=scenario.duration, sample_time=step, method=method
        )
    except Stuck as stuck:
        raise results.failed(stuck, compiled, actuator) from None
    signals = compiled.signals(trajectory.time, trajectory.states, trajectory.flags)
    balance = results.balance(circuit, trajectory)
    servo = results.servo(scenario, trajectory.time, signals)
    dynamic, reason = results.harmonic_load(scenario, trajectory.time, signals)
    values, why = results.values(
        scenario, actuator, trajectory.time, signals, balance, trajectory.events, servo, dynamic,
        reason, records,
    )  # fmt: skip
    result = Simulation(
        scenario=scenario,
        plant=actuator,
        spec_hash=spec,
        time=trajectory.time,
        signals=signals,
        told={x.name: SignalLabel(x.label, x.quantity) for x in circuit.system.signals},
        balance=balance,
        values=values,
        why=why,
        requirements=results.requirements(scenario, values, why),
        tuned=tuned,
        servo=servo,
        shaken=dynamic,
        events=trajectory.events,
        notes=_notes(circuit, tuned, trajectory.time, signals, step),
        basis=basis(circuit),
        evaluations=trajectory.evaluations,
        seconds=perf_counter() - begin,
    )
    if not verify:
        return result
    second = _checked_by(compiled, scenario, step, trajectory, signals, SECOND[method])
    return replace(result, second=second)


def with_margins(simulation: Simulation, records: Records) -> Simulation:
    """A simulation with the margins of its control loop, if it has a loop but no margins yet."""
    before = simulation.tuned
    if before is None or before.margins is not None:
        return simulation
    scenario, actuator = simulation.scenario, simulation.plant
    tuned = tune(scenario, actuator, records, previous=before, with_margins=True)
    notes = (*_controller_notes(tuned), *simulation.notes)
    return replace(simulation, tuned=tuned, notes=notes)


def _checked_by(
    compiled: Compiled,
    scenario: Scenario,
    step: float,
    first: Trajectory,
    signals: dict[str, Array],
    method: Method,
) -> Second:
    """Integrate again by another method; differences are shares of the span of each signal."""
    other = integrate(compiled, duration=scenario.duration, sample_time=step, method=method)
    again = compiled.signals(other.time, other.states, other.flags)
    grid, at = _single_instants(first.time)
    times, other_at = _single_instants(other.time)
    differences, where = {}, {}
    for name in COMPARED:
        if name not in signals:
            continue
        reference = signals[name][at]
        deviation = np.abs(reference - np.interp(grid, times, again[name][other_at]))
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
    """Times that occur once, and their indices; jumps, which have two samples, are left out."""
    instants, first, count = np.unique(time, return_index=True, return_counts=True)
    single = count == 1
    return instants[single], first[single]


def _notes(
    circuit: Circuit, tuned: Tuned | None, time: Array, signals: Mapping[str, Array], step: float
) -> tuple[str, ...]:
    """Notes on a simulation for its user."""
    scenario, actuator = circuit.scenario, circuit.plant
    return (
        *assumptions(circuit.plant.design.ideal),
        *recorded_notes(scenario, circuit.records),
        *circuit.system.notes,
        *_controller_notes(tuned),
        *_cycle(circuit),
        *_simplifications(scenario, actuator),
        *_bristles(circuit, time, signals),
        *_reference_outside_stroke(actuator, signals),
        *_limits(scenario, actuator, signals),
        *_coarse_samples(step, signals),
        *_pump_not_in_equilibrium(scenario, actuator),
    )


def _controller_notes(tuned: Tuned | None) -> Iterator[str]:
    """Notes from tuning the controller; a note if the loop is unstable or has no valid margins."""
    if tuned is None:
        return
    yield from tuned.notes
    if tuned.margins is None:
        return
    if tuned.unheld:
        yield f"{UNHELD}{tuned.unheld}: the margins of the linear loop are meaningless; {CAUSES}"
    elif not tuned.margins.stable:
        yield (
            f"the linear loop is unstable: gain margin {tuned.margins.gain:.2f}; its "
            "oscillation grows until the valve or the friction limits it"
        )


def _cycle(circuit: Circuit) -> Iterator[str]:
    """Notes on the inertia of the load in a duty cycle, and on its feed-forward."""
    name = circuit.scenario.cycle
    if name is None:
        return
    yield (
        f"the force of {name} contains the inertia of the load: it is subtracted along the "
        "reference, and load.mass and load.inertia move with the rod, so that they resist any "
        "other motion"
    )
    assert circuit.plant.valve is not None
    lag = f"{1e3 * spool_lag(circuit.plant.valve):.2g} ms"
    yield (
        f"the valve opening that {name} needs by the quasi-static model is added to the signal of "
        f"the controller, ahead by the lag of the spool ({lag}); control.feed_forward replaces it"
    )


def _simplifications(scenario: Scenario, actuator: Plant) -> Iterator[str]:
    """Notes on simplified friction, and on port accumulators, which are left out."""
    friction, seals = scenario.friction, actuator.seals
    if friction.coulomb is None and friction.model != "none" and scenario.motor is None:
        error = max(seals.coulomb.error, seals.static.error)
        if error > WARN_PLANE:
            yield (
                "friction is interpolated between chamber pressures with an error of up to "
                f"{100 * error:.1f} %"
            )
        films = [place for place in ("piston", "rod") if actuator.films[place]]
        if films:
            yield (
                f"the oil film of the {' and '.join(films)} seal is simulated as dry friction with "
                "the seal's friction coefficient: to simulate the friction of the film, state "
                "friction.coulomb and friction.viscous"
            )
    if actuator.design.ports.accumulators:
        yield "accumulators at the ports (ports.accumulators) are left out of the simulation"


def _bristles(circuit: Circuit, time: Array, signals: Mapping[str, Array]) -> Iterator[str]:
    """A note on when the bristle damping falls with speed or, if it does not, may add energy."""
    curve = circuit.friction
    if curve is None or "bristles" not in signals:
        return
    speed, text = np.abs(signals["speed"]), SCENARIOS["speed_value"].text
    fastest, limit = float(np.max(speed)), curve.taper_speed
    if limit is None:
        if fastest > curve.passive_speed > 0 and curve.bristle_damping > 0:
            share = _share_above(curve.passive_speed, time, speed)
            yield (
                f"the bristle damping does not fall with speed: above "
                f"{text(curve.passive_speed, 3)}, {share} of the time, friction may add energy; "
                "friction.bristle_taper: true lets it fall"
            )
    elif fastest > limit * math.sqrt(-math.log(1 - motion.TAPERED)):
        yield (
            f"the bristle damping falls with speed so that friction adds no energy: to 37 % at "
            f"{text(limit, 3)}, which the piston exceeds {_share_above(limit, time, speed)} of the "
            f"time (up to {text(fastest, 3)}); friction.bristle_taper: false keeps it constant"
        )


def _share_above(limit: float, time: Array, speed: Array) -> str:
    """Share of the time in which the speed exceeds a limit, as text."""
    share = float(np.trapezoid((speed > limit).astype(float), time)) / float(time[-1] - time[0])
    return f"{100 * share:.2g} %"


def _limits(scenario: Scenario, actuator: Plant, signals: Mapping[str, Array]) -> Iterator[str]:
    """Notes on cavitation, excess pressure and excess travel, which the model does not limit."""
    where = "chamber" if scenario.motor is None else "pipe"
    for name in ("pressure_a", "pressure_b"):
        if name not in signals:
            continue
        text, side = INPUTS["pressure"].text, f"{where} {name[-1].upper()}"
        lowest, highest = float(np.min(signals[name])), float(np.max(signals[name]))
        if lowest < TORN:
            yield f"the oil in {side} cavitates: {text(lowest)} gauge"
        if highest > actuator.proof_pressure:
            proof = text(actuator.proof_pressure)
            yield (
                f"the pressure in {side} peaks at {text(highest)}, above the proof pressure of "
                f"{proof}"
            )
    bench = scenario.load.cylinder
    if bench is not None and "position" in signals:
        x = signals["position"]
        if float(np.max(np.abs(x - x[0]))) > 0.5 * bench.stroke:
            yield (
                "the load cylinder leaves its stroke: in the model it starts at mid-stroke and "
                "has no end stops"
            )


def _coarse_samples(step: float, signals: Mapping[str, Array]) -> Iterator[str]:
    """A note if the sample time is so long that the samples may miss a peak."""
    if step > COARSE and "pressure_a" in signals:
        yield (
            f"peaks and step results are taken from samples that are {1e3 * step:.3g} ms apart; "
            "for more accurate values state a shorter sample_time"
        )


def _pump_not_in_equilibrium(scenario: Scenario, actuator: Plant) -> Iterator[str]:
    """A note on a pump whose initial pressure is not in equilibrium with its relief valve."""
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

    over = float(brentq(excess_flow, 0.0, 2 * relief.override))  # `excess_flow` includes the pump
    initial = actuator.supply_pressure
    equilibrium = actuator.return_pressure + relief.pressure + over
    if abs(equilibrium - initial) > SETTLED * initial:
        yield (
            f"the supply line starts at {text(initial)} (supply.pressure), but pump and relief "
            f"valve are in equilibrium near {text(equilibrium)}: set supply.pressure to that value"
        )


def _reference_outside_stroke(actuator: Plant, signals: Mapping[str, Array]) -> Iterator[str]:
    """A note on a reference outside the stroke."""
    if "reference" not in signals or "position" not in signals:
        return
    reference = signals["reference"]
    low, high = float(np.min(reference)), float(np.max(reference))
    follows = np.allclose(reference - signals["error"], signals["position"])
    if follows and (low < 0 or high > actuator.stroke):
        length = INPUTS["position"].text
        yield (
            f"the reference ranges from {length(low)} to {length(high)}, but the stroke ends at "
            f"{length(actuator.stroke)}"
        )


def spec_of(subject: PreparedDesign, scenario: Scenario) -> str:
    """Hash of all inputs that affect the result."""
    content = scenario.model_dump(mode="json", exclude={"reproduces"})
    replace_by_digests(content, scenario)
    if content["load"]["cylinder"]:
        leave_out_unset(content["load"]["cylinder"]["valve"])
    for block, key in (
        (content["control"], "dead_band_jump"),
        (content["control"], "feed_forward"),
        (content, "cycle"),
        (content, "unset"),
    ):
        if block and not block[key]:  # unset fields are left out: hashes of older runs stay valid
            del block[key]
    text = spec_hash(subject) + json.dumps(content, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:16]
