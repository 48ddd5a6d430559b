"""Figures of the linear tier at one position and load case, for comparison with experiments."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import nan, pi
from typing import NamedTuple

import numpy as np

from ...base.numeric import Array
from ...base.polynomial import at_frequency
from ...design.scenario.model import Scenario
from ...evaluation.kernel import ModelRun, PreparedDesign, compute
from ...evaluation.result import Requirement
from ...evaluation.values import of_case
from ...models import linear, loop
from ...studies.plant import Plant, plant
from .stand import Stand, Tally

WEAKEST = "weakest position"
STEADY = 0.4
"""Gain relative to the ultimate one that brings an oscillating loop to rest (a choice)."""
SLOW = 0.05
"""Bandwidth relative to the resonance if the loop's is unknown (a choice)."""
PEAK = 0.5
"""Magnitude above which an open-loop resonance may cause a crossover (a choice)."""


class Spot(NamedTuple):
    """Where a figure of the linear tier is the worst."""

    case: int
    position: float
    extending: bool | None
    """Direction of the spool; None if irrelevant."""
    words: str


class LoopFigures(NamedTuple):
    """Figures of the position loop for one spool direction."""

    ultimate_gain: float
    frequency: float
    """Frequency of oscillation there [Hz]."""
    phase_margin: float
    bandwidth: float


@dataclass(frozen=True, slots=True)
class LinearTier:
    """The linear model of a design, at any position of the stroke."""

    subject: PreparedDesign
    done: ModelRun

    @classmethod
    def of(cls, subject: PreparedDesign) -> LinearTier:
        """Build by one evaluation of the models."""
        return cls(subject, compute(subject, subject.values()))

    def spot(self, row: Requirement) -> Spot:
        """The governing load case and position of a requirement."""
        cases = self.subject.cases
        case = cases.index(row.case) if row.case in cases else 0
        place = row.place or WEAKEST
        extending: bool | None = None
        words = [row.case or "", row.place or WEAKEST]
        if place.startswith(("extending, ", "retracting, ")):
            way, _, place = place.partition(", ")
            extending = way == "extending"
        position = self.done.places.get(place, self.done.places[WEAKEST])
        return Spot(case, of_case(position, case), extending, ", ".join(filter(None, words)))

    def plant(self, case: int) -> Plant:
        """The plant with the oil of a load case."""
        subject = self.subject
        order = [case, *(k for k in range(len(subject.cases)) if k != case)]
        cases = tuple(subject.design.load_cases[k] for k in order)
        films = {(p, order.index(k), way): t for (p, k, way), t in subject.films.items()}
        design = subject.design.model_copy(update={"load_cases": cases})
        return plant(replace(subject, design=design, films=films))

    def stand(self, scenario: Scenario, spot: Spot, tally: Tally, scale: float) -> Stand:
        """The design held at a spot, with the pressures of the load case."""
        own = self.plant(spot.case)
        state = self.done.state
        stand = Stand(
            plant=own,
            scenario=scenario,
            position=spot.position,
            pressure_a=of_case(state.holding_a, spot.case),
            pressure_b=of_case(state.holding_b, spot.case),
            tally=tally,
            scale=scale,
        )
        if own.valve is None:
            return stand
        gain = self._gain(spot.case)
        both = [self.figures(spot.case, spot.position, way) for way in (True, False)]
        least = min(one.ultimate_gain for one in both)
        known = [one.bandwidth for one in both if one.bandwidth > 0]
        slow = min(known, default=SLOW * self.resonance(spot.case, spot.position))
        return stand.but(gain=gain, steady_gain=min(gain, STEADY * least), bandwidth=slow)

    def _open_loop(self, position: float, extending: bool) -> loop.OpenLoop:
        place = np.array([[position]])
        return self.done.motion.position_loop(place, extending=np.array(extending))

    def _gain(self, case: int) -> float:
        return of_case(self.done.computed.metrics["position_gain"][""], case)

    def figures(self, case: int, position: float, extending: bool) -> LoopFigures:
        """Figures of the position loop, with margins at the design's gain."""
        one, gain = self._open_loop(position, extending), self._gain(case)
        limit = loop.ultimate_gain(loop=one)
        found = loop.margins(loop=one, gain=gain)
        return LoopFigures(
            of_case(limit.gain, case),
            of_case(limit.frequency, case),
            of_case(found.phase_margin, case),
            of_case(found.bandwidth, case),
        )

    def response(
        self, case: int, position: float, extending: bool
    ) -> Callable[[float | Array], Array]:
        """The open loop over frequency [Hz], its gain included."""
        one, gain = self._open_loop(position, extending), self._gain(case)

        def at(frequency: float | Array) -> Array:
            omega = 2 * pi * np.asarray(frequency, dtype=float).reshape(-1, 1, 1)
            top, low = at_frequency(one.numerator, omega), at_frequency(one.denominator, omega)
            value = gain * np.asarray(top.complex / low.complex)
            value = value[:, min(case, value.shape[1] - 1), 0]
            return value if np.ndim(frequency) else complex(value[0])

        return at

    def crossings(
        self, case: int, position: float, extending: bool
    ) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Crossovers and resonances of the open loop [Hz]."""
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
        """Figures of the actuator with held ports: oscillation and dynamic stiffness."""
        place = np.array([[position]])
        motion = self.done.motion
        model = motion.model(place)
        found = {
            "natural_frequency": self.resonance(case, position),
            "damping_ratio": of_case(motion.mode(model, place).damping_ratio, case),
        }
        frequency = self.subject.design.load_cases[case].frequency
        if frequency is None:
            return found | dict.fromkeys(("dynamic_stiffness", "dynamic_phase"), nan)
        parts = linear.dynamic_stiffness(model=model, frequency=frequency)
        value = complex(of_case(parts.real, case), of_case(parts.imaginary, case))
        return found | {
            "dynamic_stiffness": abs(value),
            "dynamic_phase": float(np.angle(value)),
        }

    def closed(self, metric: str, case: int, position: float, extending: bool) -> float:
        """A figure of the closed loop for one spool direction."""
        figures = self.figures(case, position, extending)
        if metric == "gain_margin":
            return figures.ultimate_gain / self._gain(case)
        return float(getattr(figures, metric))

    def stated(self, case: int) -> tuple[float, float]:
        """Chamber pressures assumed by the linear tier [Pa]."""
        state = self.done.state
        return of_case(state.holding_a, case), of_case(state.holding_b, case)

    def unsimulated(self) -> str:
        """Parts of the design that no experiment covers; empty if none."""
        if self.subject.design.ports.accumulators:
            return "accumulators at the ports are not simulated"
        return ""
