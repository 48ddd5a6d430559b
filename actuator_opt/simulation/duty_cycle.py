"""Duty cycles of a design as scenarios, with their quasi-static results beside the simulated ones.

The position of the cycle is the reference of the position loop, its force the load of the rod. This
force contains the inertia of the load along the reference. A simulation subtracts this inertia and
moves the load with the rod, so that it resists any other motion. The opening of the valve that the
quasi-static model needs is added to the signal of the controller, ahead by the lag of the spool, so
that the position lags less. Reference and quasi-static results count the same samples: those of the
file and, between them, of its splines.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import ceil, floor
from typing import Any, NamedTuple

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError
from ..base.numeric import Array
from ..base.quantities import INPUTS, Quantity
from ..design.cycle_record import CycleRecord, spline
from ..design.duty import DutyCycle
from ..design.model import Design
from ..design.paths import get
from ..design.scenario.kinds import Records
from ..design.scenario.model import (
    Controller,
    ForceSignal,
    PositionSignal,
    Scenario,
    ScenarioLoad,
    ValveSignal,
)
from ..evaluation.duty_cycles.results import CycleModels
from ..evaluation.duty_cycles.study import CycleStudy, study
from ..evaluation.kernel import PreparedDesign, duty_numbers
from ..evaluation.values import plain
from ..metrics import METRICS
from ..metrics.table import ROWS
from ..studies.plant import Plant, ValveData, plant

SAMPLES = 3000
"""Least number of samples of a period of the reference (our choice: the reference is linear between
them; half as many change no result of the walking knee by 0.2 %, and the absorbed power of the
flight control by 2 %)."""
AGREEMENT = 0.02
"""Difference of the supply energies up to which the quasi-static results are confirmed (our
choice)."""
REPEATED = 0.005
"""Relative change of the supply energy from one period to the next that a note reports (our
choice)."""
LAG = 0.02
"""Position error, as a share of the travel of the cycle, that a note reports (our choice)."""


def cycle_of(scenario: Scenario, design: Design) -> DutyCycle | None:
    """The duty cycle that a scenario simulates; None if it simulates none."""
    cycles = () if design.duty is None else design.duty.cycles
    return next((cycle for cycle in cycles if cycle.name == scenario.cycle), None)


def plant_of(scenario: Scenario, actuator: Plant) -> Plant:
    """The plant of a scenario: with the supply pressure of its duty cycle, if it has one."""
    cycle = cycle_of(scenario, actuator.design)
    if cycle is None:
        return actuator
    assert actuator.design.duty is not None
    level = get(actuator.design, actuator.design.duty.pressure_path(cycle))
    assert isinstance(level, float)
    return replace(actuator, supply_pressure=level)


def inertia_force(actuator: Plant, cycle: CycleStudy) -> Array:
    """Force of the load's inertia on the rod along a cycle [N].

    F = m a + (J/h^2) a - (J h'/h^4) v^2, with the load's mass m, the lever arm h, and the joint's
    inertia J as the actuator feels it (`linkage.reflected_inertia`).
    """
    position = cycle.traces["position"]
    curve = spline(cycle.time, position, closed=cycle.record.closed)
    speed, acceleration = curve(cycle.time, 1), curve(cycle.time, 2)
    force = actuator.design.load.mass * acceleration
    joint = actuator.joint(position)
    if joint is not None and actuator.design.load.inertia:
        felt = joint[1]
        force = force + felt.mass * acceleration + felt.velocity_factor * speed**2
    return np.asarray(force)


def with_cycle(scenario: Scenario, subject: PreparedDesign) -> tuple[Scenario, Records]:
    """A scenario with the signals of its duty cycle, and the records of these signals.

    Parameters
    ----------
    scenario : a scenario that names a duty cycle of the design
    subject : the design

    Raises
    ------
    InputError
        the linkage cannot follow the cycle, or the cycle begins outside the stroke
    """
    cycle = cycle_of(scenario, subject.design)
    if cycle is None:
        return scenario, {}
    actuator = plant_of(scenario, plant(subject))
    finer = _resampled(cycle, subject)
    record, position = finer.record, finer.traces["position"]
    _require_positions(cycle, record, position, actuator.stroke)
    assert actuator.valve is not None
    own = (record.time - record.time[0]) * cycle.time_scale
    period = own[-1] if record.closed else None
    signal = _signal(actuator.valve, finer.traces)
    columns = {
        "position": position - position[0],
        "force": finer.traces["force"] - inertia_force(actuator, finer),
        "valve signal": np.interp(own + spool_lag(actuator.valve), own, signal, period=period),
    }
    label = getattr(cycle.file, "label", str(cycle.file))
    time, repeated = _repeated(record, cycle.time_scale, scenario.duration)
    records = {
        (label, f"{name} of {cycle.name}"): (time, repeated(values))
        for name, values in columns.items()
    }
    position_column, force_column, signal_column = (column for _, column in records)
    control = scenario.control or Controller()
    changed: dict[str, Any] = {
        "position": (PositionSignal(shape="record", file=label, column=position_column),)
    }
    if not control.feed_forward:
        changed["feed_forward"] = (ValveSignal(shape="record", file=label, column=signal_column),)
    initial = scenario.initial.model_copy(update={"position": float(position[0])})
    update = {
        "control": control.model_copy(update=changed),
        "load": ScenarioLoad(force=(ForceSignal(shape="record", file=label, column=force_column),)),
        "initial": initial,
    }
    return scenario.model_copy(update=update), records


def _resampled(cycle: DutyCycle, subject: PreparedDesign) -> CycleStudy:
    """A cycle with enough samples for a smooth reference."""
    models, numbers = duty_numbers(subject, subject.values())
    record = models.records[cycle.name].resampled(SAMPLES + 1)
    finer = CycleModels(models.plan, {cycle.name: record}, models.names)
    (found,) = study(finer, numbers[:, 0]).cycles
    return found


def _require_positions(
    cycle: DutyCycle, record: CycleRecord, position: Array, stroke: float
) -> None:
    text = INPUTS["position"].text
    unknown = np.flatnonzero(~np.isfinite(position))
    if unknown.size:
        at = record.time[unknown[0]]
        message = f"{cycle.name}: the linkage has no position of the piston at {at:.4g} s"
        raise InputError(Diagnostic(message, "check linkage and angles", path="cycle"))
    first = float(position[0])
    if not 0 <= first <= stroke:
        message = f"{cycle.name} begins at {text(first)}, outside the stroke of {text(stroke)}"
        remedy = "meet the check of the travel first: change linkage or cylinder.stroke"
        raise InputError(Diagnostic(message, remedy, path="cycle"))


def spool_lag(valve: ValveData) -> float:
    """Time by which a spool lags a slow signal: 2 zeta/omega of its second-order equation [s].

    References
    ----------
    [derived] the phase of 1/(1 + 2 zeta s/omega + s^2/omega^2) at low frequency, divided by it
    """
    return 2 * valve.damping_ratio / (2 * np.pi * valve.natural_frequency)


def _signal(valve: ValveData, traces: Mapping[str, Array]) -> Array:
    """Signal of the valve for the quasi-static opening; the full signal past stall [V]."""
    extending = traces["speed"] >= 0
    side = np.where(extending, 1.0, -1.0)
    start = _start(valve, extending)
    opening = np.nan_to_num(traces["opening"], nan=1.0, posinf=1.0)
    opening = np.clip(opening, 0.0, 1.0)
    start = np.where(opening > 0, start, 0.0)
    signal: Array = valve.offset + side * (start + opening * (valve.signal - start))
    return signal


def _start(valve: ValveData, extending: Array) -> Array:
    """Signal from the centre at which the open edges have passed their overlap [V].

    `ValveData.start` adds the clearance of edges that leak; the opening of a cycle begins earlier.
    """
    spool = valve.metering
    if spool is None:
        return np.zeros(np.shape(extending))
    out, back = (
        valve.signal * spool.signal_share(max(0.0, *(float(edge.overlap) for edge in edges)))
        for edges in ((spool.supply_a, spool.b_tank), (spool.a_tank, spool.supply_b))
    )
    return np.where(extending, out, back)


class _Repeated(NamedTuple):
    """Repeats the samples of a period."""

    periods: int

    def __call__(self, values: Array) -> Array:
        return np.append(np.tile(values[:-1], self.periods), values[-1])


def _repeated(record: CycleRecord, scale: float, duration: float) -> tuple[Array, _Repeated]:
    """Times of all periods of a cycle until `duration`, from zero; an open cycle has one."""
    period = record.duration * scale
    periods = ceil(duration / period * (1 - 1e-12)) if record.closed else 1
    time = (record.time - record.time[0]) * scale
    starts = np.repeat(period * np.arange(periods), time.size - 1)
    repeated = _Repeated(periods)
    return repeated(time) + np.append(starts, period * (periods - 1)), repeated


# ---- comparison ----


class ComparedResult(NamedTuple):
    """A result of a duty cycle from both models, under the name of its metric."""

    name: str
    quasi_static: float
    simulated: float

    @property
    def quantity(self) -> Quantity:
        """The metric: unit and meaning."""
        return METRICS[self.name]

    @property
    def label(self) -> str:
        """Name as printed."""
        return ROWS[self.name].term

    @property
    def difference(self) -> float | None:
        """Simulated divided by quasi-static value, minus 1; None if that is zero or infinite."""
        if not self.quasi_static or not np.isfinite(self.quasi_static):
            return None
        return self.simulated / self.quasi_static - 1


@dataclass(frozen=True, slots=True)
class CycleComparison:
    """Results of a duty cycle in its last simulated period, beside the quasi-static ones."""

    cycle: str
    start: float
    """Start of the compared period [s]."""
    end: float
    rows: tuple[ComparedResult, ...]
    position_error: float
    """Root mean square of the difference from the reference position in this period [m]."""
    position_error_max: float
    travel: float
    """Range of the reference position [m]."""
    change: float | None
    """Supply energy of this period divided by that of the period before, minus 1."""
    traces: Mapping[str, tuple[Array, Array]]
    """Times [s] in this period and quasi-static pressures [Pa] by the names of the signals."""
    samples: int
    """Samples that the quasi-static results count."""
    stated: int
    """Samples of the file among them."""
    force: float
    """Largest force of the cycle in either direction [N]."""
    inertia: float
    """Largest force of the load's inertia along the reference [N]."""

    @property
    def difference(self) -> float:
        """Relative difference of the supply energies."""
        energy = next(row for row in self.rows if row.name == "duty_supply_energy")
        return energy.difference or 0.0

    @property
    def sentence(self) -> str:
        """Whether the simulation confirms the quasi-static energy."""
        share = f"{100 * abs(self.difference):.2g} %"
        side = "more" if self.difference > 0 else "less"
        text = INPUTS["position"].text
        error = f"rms position error {text(self.position_error, 3)}"
        within = abs(self.difference) <= AGREEMENT
        judged = f"within {100 * AGREEMENT:g} %"
        if not within:
            judged = f"beyond {100 * AGREEMENT:g} %: trust the simulation"
        return (
            f"duty cycle {self.cycle}: the simulation takes {share} {side} energy from the supply "
            f"than the quasi-static model, {judged}; {error}"
        )

    @property
    def notes(self) -> Iterator[str]:
        """Sentences for the reader."""
        yield self.sentence
        if self.samples > self.stated:
            yield (
                f"these quasi-static results count {self.samples} samples of the splines that the "
                f"simulation follows; metrics and requirements count the {self.stated} of the file"
            )
        if self.inertia > self.force:
            inertia, force = (INPUTS["force"].text(x, 3) for x in (self.inertia, self.force))
            yield (
                f"the inertia of the load along {self.cycle} reaches {inertia}, the force of the "
                f"cycle only {force}: the motion is noisy, or its force does not contain this "
                "load: smooth the file, or lower load.mass or load.inertia"
            )
        if self.position_error_max > LAG * self.travel:
            share = 100 * self.position_error_max / self.travel
            yield (
                f"the position differs from that of the cycle by up to {share:.2g} % of its "
                "travel: work and flow differ as well; a higher gain follows closer"
            )
        opening = next(row for row in self.rows if row.name == "duty_opening").quasi_static
        if opening > 1:
            needed = f"by {100 * opening:.3g} %" if np.isfinite(opening) else "more than fully"
            yield (
                f"by the quasi-static model the valve would have to open {needed}: the supply "
                f"cannot move {self.cycle} as stated, and the position falls behind"
            )
        if self.change is not None and abs(self.change) > REPEATED:
            yield (
                f"the supply energy still changes by {100 * self.change:.2g} % from one period to "
                "the next: simulate more periods"
            )

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON, SI."""
        data: dict[str, Any] = plain(
            {
                "cycle": self.cycle,
                "start": self.start,
                "end": self.end,
                "results": {
                    row.name: {
                        "quasi_static": row.quasi_static,
                        "simulated": row.simulated,
                        "difference": row.difference,
                        "unit": row.quantity.si_unit,
                    }
                    for row in self.rows
                },
                "position_error": self.position_error,
                "position_error_max": self.position_error_max,
                "change_between_periods": self.change,
                "sentence": self.sentence,
            }
        )
        return data


def compare(
    scenario: Scenario,
    subject: PreparedDesign,
    actuator: Plant,
    time: Array,
    signals: Mapping[str, Array],
) -> CycleComparison | None:
    """Compare a simulation with the quasi-static results of its duty cycle.

    Parameters
    ----------
    scenario : the scenario, with the signals of the cycle
    subject : the design
    actuator : its plant
    time : times of the samples [s]
    signals : signals at these times, SI
    """
    cycle = cycle_of(scenario, subject.design)
    if cycle is None:
        return None
    assert subject.design.duty is not None
    static = _resampled(cycle, subject)
    period = float(static.time[-1] - static.time[0])
    whole = floor(scenario.duration / period * (1 + 1e-9)) if cycle.closed else 1
    window = _Window(time, (whole - 1) * period, whole * period)
    supply = plant_of(scenario, actuator).supply_pressure
    energy = window.integral(supply * signals["flow_supply"])
    change = None
    if whole > 1:
        before = _Window(time, (whole - 2) * period, (whole - 1) * period)
        change = energy / before.integral(supply * signals["flow_supply"]) - 1
    errors = window.of(signals["error"])
    mean_square = window.integral(signals["error"] ** 2) / period
    position = static.traces["position"]
    return CycleComparison(
        cycle=cycle.name,
        start=window.start,
        end=window.end,
        rows=tuple(_rows(static, window, signals, energy, actuator)),
        position_error=float(np.sqrt(mean_square)),
        position_error_max=float(np.max(np.abs(errors))),
        travel=float(np.ptp(position)),
        change=change,
        traces={
            name: (window.start + static.time - static.time[0], static.traces[name])
            for name in ("pressure_a", "pressure_b")
        },
        samples=len(static.time),
        force=float(np.max(np.abs(static.traces["force"]))),
        inertia=float(np.max(np.abs(inertia_force(actuator, static)))),
        stated=len(cycle.record.time),
    )


class _Window(NamedTuple):
    """A part of the time of a simulation."""

    time: Array
    start: float
    end: float

    def integral(self, values: Array) -> float:
        """Integral over the window, by the trapezoid rule between the samples."""
        steps = 0.5 * (values[1:] + values[:-1]) * np.diff(self.time)
        total = np.append(0.0, np.cumsum(steps))
        return float(np.diff(np.interp([self.start, self.end], self.time, total))[0])

    def of(self, values: Array) -> Array:
        """Values within the window."""
        slack = 1e-9 * self.end
        return values[(self.time >= self.start - slack) & (self.time <= self.end + slack)]


def _rows(
    static: CycleStudy,
    window: _Window,
    signals: Mapping[str, Array],
    energy: float,
    actuator: Plant,
) -> Iterator[ComparedResult]:
    """Results of both models."""
    traces, energies = static.traces, static.energies
    own = static.time - static.time[0]
    period = own[-1] if static.record.closed else None
    force = np.interp(window.time, own, traces["force"], period=period)
    power = force * signals["speed"]
    pressures = [window.of(signals[f"pressure_{chamber}"]) for chamber in "ab"]
    known = [traces["pressure_a"], traces["pressure_b"]]
    simulated = {
        "duty_supply_energy": (energies["supply_energy"], energy),
        "duty_work_out": (energies["work_out"], window.integral(np.maximum(power, 0.0))),
        "duty_work_in": (energies["work_in"], -window.integral(np.minimum(power, 0.0))),
        "duty_friction_energy": (
            energies["friction_energy"],
            window.integral(signals["friction"] * signals["speed"]),
        ),
        "duty_flow_peak": (np.max(traces["flow"]), np.max(window.of(signals["flow_supply"]))),
        "duty_power_peak": (np.max(traces["power"]), np.max(window.of(power))),
        "duty_power_absorbed": (-np.min(traces["power"]), -np.min(window.of(power))),
        "duty_pressure_min": (min(map(np.min, known)), min(map(np.min, pressures))),
        "duty_pressure_max": (max(map(np.max, known)), max(map(np.max, pressures))),
        "duty_opening": (np.max(traces["opening"]), _opening(actuator, window, signals)),
    }
    for name, (before, after) in simulated.items():
        yield ComparedResult(name, float(before), float(after))


def _opening(actuator: Plant, window: _Window, signals: Mapping[str, Array]) -> float:
    """Largest opening of the valve, as a share of its full opening."""
    valve = actuator.valve
    assert valve is not None
    spool = window.of(signals["spool"]) - valve.offset
    start = _start(valve, spool >= 0)
    return float(np.max(np.maximum(np.abs(spool) - start, 0.0) / (valve.signal - start)))
