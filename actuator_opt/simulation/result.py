"""Results of a simulation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..base.numeric import Array
from ..base.quantities import RESULTS, Quantity
from ..design.scenario.model import Scenario
from ..evaluation.reserve import without_reserve
from ..evaluation.result import State
from ..studies.plant import Plant
from .gains import Tuned
from .integrate import Event
from .loops import Loop
from .step_response import StepMetrics


@dataclass(frozen=True, slots=True)
class Flow:
    """Energy flow across the boundary over the run [J]; inflow is positive."""

    name: str
    energy: float


@dataclass(frozen=True, slots=True)
class Balance:
    """Mass and energy balance of a run, relative to the throughput."""

    mass: float
    """Largest |content - inflow| of any volume, over its content."""
    energy: float
    """stored - net inflow|, relative to all energy across the boundary."""
    flows: tuple[Flow, ...]
    stored: tuple[Flow, ...]
    """Change of the stored energy."""


@dataclass(frozen=True, slots=True)
class Second:
    """Check by a second integrator on the same equations."""

    method: str
    max_difference: float
    """Largest difference of any compared signal, over its span."""
    signal: str
    """Its signal."""
    time: float
    """Its time [s]."""
    differences: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Window:
    """Dynamic stiffness in a window of whole cycles along the stroke."""

    time: float
    position: float
    """Mean pressures of the chambers."""
    stiffness: complex
    """Force over position [N/m]."""
    standard_error: float


@dataclass(frozen=True, slots=True)
class HarmonicLoad:
    """Dynamic stiffness at the frequency of the load."""

    frequency: float
    windows: tuple[Window, ...]


@dataclass(frozen=True, slots=True)
class Servo:
    """Response of the loop to a step."""

    loop: Loop
    time: float
    """Time of the step [s]."""
    start: float
    target: float
    metrics: StepMetrics


@dataclass(frozen=True, slots=True)
class RequirementResult:
    """A requirement on the simulation."""

    metric: str
    sense: str
    limit: float
    value: float | None
    margin: float | None
    met: bool
    why: str = ""

    @property
    def state(self) -> State:
        """Whether it is met, and with what margin (`reserve.NO_RESERVE`)."""
        if not self.met:
            return "missed"
        return "no_reserve" if without_reserve(self.margin, self.limit) else "met"


@dataclass(frozen=True, slots=True)
class Told:
    """Label and quantity of a signal."""

    label: str
    quantity: Quantity


@dataclass(frozen=True, slots=True)
class Simulation:
    """Results of a simulated scenario.

    `time` may contain an instant twice: before and after a jump. `values` are results by the names
    of `quantities.RESULTS`, None if they do not apply, with the reason in `why`.
    """

    scenario: Scenario
    plant: Plant
    spec_hash: str
    time: Array
    signals: Mapping[str, Array]
    told: Mapping[str, Told]
    balance: Balance
    values: Mapping[str, float | None]
    why: Mapping[str, str]
    requirements: tuple[RequirementResult, ...]
    tuned: Tuned | None
    servo: Servo | None
    shaken: HarmonicLoad | None
    events: tuple[Event, ...]
    notes: tuple[str, ...]
    second: Second | None = None
    evaluations: int = 0
    seconds: float = 0.0

    @property
    def met(self) -> bool:
        """Whether all requirements are met."""
        return all(row.met for row in self.requirements)

    def __str__(self) -> str:
        """The results as a table."""
        lines = [f"{self.scenario.name}: {self.plant.design.name}, {self.scenario.duration:g} s"]
        for name, value in self.values.items():
            if value is not None:
                lines.append(f"  {name:20s} {RESULTS[name].text(value)}")
        for row in self.requirements:
            limit = RESULTS[row.metric].text(row.limit)
            lines.append(f"  {row.metric} {row.sense} {limit}: {'met' if row.met else 'missed'}")
        return "\n".join([*lines, *(f"  note: {note}" for note in self.notes)])

    __repr__ = __str__

    def to_dict(self) -> dict[str, Any]:
        """As plain data for JSON, SI; without the samples."""
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
                "flows": {one.name: one.energy for one in self.balance.flows},
                "stored": {one.name: one.energy for one in self.balance.stored},
            },
            "dynamic_stiffness": self._shaken(),
            "events": [{"name": one.name, "time": one.time, "on": one.on} for one in self.events],
            "second_integrator": self._second(),
            "notes": list(self.notes),
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
        return {
            "origin": tuned.origin,
            "unit": tuned.unit,
            "proportional_gain": tuned.gains.proportional_gain,
            "integral_time": _finite(tuned.gains.integral_time),
            "derivative_time": tuned.gains.derivative_time,
            "ultimate_gain": _finite(tuned.ultimate.gain),
            "ultimate_period": _finite(tuned.ultimate.period),
            "gain_margin": _finite(tuned.margins.gain),
            "phase_margin": tuned.margins.phase,
            "stable": tuned.margins.stable,
        }

    def _shaken(self) -> dict[str, Any] | None:
        if self.shaken is None:
            return None
        return {
            "frequency": self.shaken.frequency,
            "windows": [
                {
                    "time": one.time,
                    "position": one.position,
                    "stiffness": abs(one.stiffness),
                    "phase": float(np.angle(one.stiffness)),
                    "standard_error": one.standard_error,
                }
                for one in self.shaken.windows
            ],
        }


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
