"""Circuits for the tests of the simulation: a plant of stated numbers, a scenario, a run of both.

The cylinder is the 32/18-160 of the check values: 140 bar, 30 kg, an oil of 1.4 GPa without air.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

import actuator_opt as ao
from actuator_opt.base.symbolic import vectorised
from actuator_opt.design.scenario.model import Scenario
from actuator_opt.evaluation.springs import Give
from actuator_opt.models.loop import ControllerGains
from actuator_opt.simulation.assemble import assemble
from actuator_opt.simulation.components.circuit import Circuit
from actuator_opt.simulation.integrate import Trajectory, integrate
from actuator_opt.simulation.system import Compiled
from actuator_opt.studies import plant as plants
from actuator_opt.studies.plant import LineData, Oil, Plane, Plant, SealData, ValveData

BAR = 1e5
LITRE = 1 / 60000  # l/min in m^3/s
FULL, LEAK = 40 * LITRE / math.sqrt(35 * BAR), 0.45 * LITRE / math.sqrt(50 * BAR)
AREA_A, AREA_B = math.pi * 0.032**2 / 4, math.pi * (0.032**2 - 0.018**2) / 4
DESIGN = "designs/servo_knee.yaml"
VALVE = ValveData(FULL, LEAK, LEAK, 10.0, 250.0, 0.7)
OIL = Oil(
    temperature=313.0, bulk_modulus=1.4e9, slope=0.0, air_content=0.0, polytropic_index=1.4,
    density=870.0, dynamic_viscosity=32e-6 * 870, kinematic_viscosity=32e-6, vapour_pressure=0.0,
)  # fmt: skip
NO_SEALS = SealData(Plane(0.0), Plane(0.0), 1e-3, 0.0, 1e-4)
MIDDLE = {"position": 0.08, "pressure_a": 70 * BAR, "pressure_b": 70 * BAR}
BALANCED = [{"shape": "constant", "value": 70 * BAR * (AREA_A - AREA_B)}]
"""Load that holds the piston with 70 bar in both chambers."""


@cache
def _knee() -> Plant:
    return plants.plant(ao.read(DESIGN).subject())


def plant(**changes) -> Plant:
    """The cylinder of the check values, without friction of seals, lines, leakage or give."""
    stated = {
        "area_a": AREA_A, "area_b": AREA_B, "stroke": 0.16, "dead_a": 8e-6, "dead_b": 8e-6,
        "walls": Give(), "flexibility": 0.0, "mass": 30.0, "leakage": 0.0, "oil": OIL,
        "supply_pressure": 140 * BAR, "return_pressure": 0.0, "valve": VALVE,
        "lines": {"a": LineData(), "b": LineData()}, "throttle": None, "reducing_valve": None,
        "seals": NO_SEALS, "oil_damping": 400.0, "stop_stiffness": 5e7, "closed_length": 0.4,
    }  # fmt: skip
    return replace(_knee(), **(stated | changes))


def scenario(**stated) -> Scenario:
    """A scenario of one second; the file names are not read."""
    return Scenario.model_validate({"name": "a", "design": "b", "duration": 1.0} | stated)


@dataclass(frozen=True)
class Run:
    """A run with its equations."""

    circuit: Circuit
    compiled: Compiled
    found: Trajectory
    signals: dict[str, np.ndarray]

    @property
    def time(self) -> np.ndarray:
        """Samples [s]."""
        return self.found.time

    def state(self, name: str) -> np.ndarray:
        """A state over time."""
        names = [state.name for state in self.circuit.system.states]
        return self.found.states[names.index(name)]

    def integral(self, symbol) -> np.ndarray:
        """A state over time, by its symbol."""
        symbols = [state.symbol for state in self.circuit.system.states]
        return self.found.states[symbols.index(symbol)]

    def values(self, expressions) -> list[np.ndarray]:
        """Expressions of the states over time."""
        states = self.circuit.system.states
        names = ", ".join(str(state.symbol.args[0]) for state in states)
        many = vectorised("values", "t, y", {f"{names},": "y"}, expressions)
        found = many(self.time, self.found.states)
        return [np.broadcast_to(value, self.time.shape) for value in found]

    def lost_mass(self) -> float:
        """Largest volume at rest that a chamber gained from nowhere, over its content."""
        audit = self.circuit.audit
        contents = self.values([content for _, content, _ in audit.mass])
        missing = [
            np.abs(content - content[0] - self.integral(inflow)).max() / np.abs(content).max()
            for content, (_, _, inflow) in zip(contents, audit.mass, strict=True)
        ]
        return max(missing, default=0.0)

    def lost_energy(self) -> float:
        """Largest energy that nothing explains [J]."""
        audit = self.circuit.audit
        stored = sum(self.values([value for _, value in audit.stored]), np.zeros(len(self.time)))
        missing = stored - stored[0]
        for _, symbol, into in audit.flows:
            missing = missing - (1 if into else -1) * self.integral(symbol)
        return float(np.abs(missing).max())

    def turnover(self) -> float:
        """Energy that went through all doors, to and fro [J]."""
        flows = self.circuit.audit.flows
        return sum(float(np.abs(np.diff(self.integral(one))).sum()) for _, one, _ in flows)


def run(
    scene: Scenario,
    own: Plant,
    gains: ControllerGains | None = None,
    *,
    sharp: float = 1.0,
    relative: float | None = None,
    sample_time: float = 1e-3,
    method: str = "lsoda",
    records=None,
) -> Run:
    """Simulate; `sharp` divides the absolute tolerances."""
    circuit = assemble(scene, own, {} if records is None else records, gains)
    compiled = circuit.system.compiled()
    compiled = replace(compiled, tolerances=compiled.tolerances / sharp)
    found = integrate(
        compiled, duration=scene.duration, sample_time=sample_time, method=method,
        relative=relative,
    )  # fmt: skip
    signals = compiled.signals(found.time, found.states, found.flags)
    return Run(circuit, compiled, found, signals)
