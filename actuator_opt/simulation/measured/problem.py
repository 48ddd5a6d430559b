"""Least-squares problem of fitting a simulation to a record: residuals, slopes, search."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import ceil
from typing import Final

import numpy as np

from ...base import fitting as least_squares
from ...base.errors import Unsolvable
from ...base.numeric import Array
from ...design.scenario.model import Scenario
from ...studies.plant import Plant
from ..assemble import assemble
from ..components.signals import Records
from ..integrate import integrate
from ..linear import Tuned
from .parameters import PARAMETERS, Case, Entry
from .record import FEWEST, Course, Measured, beside, inside, named, noise

MOST: Final = 4000
"""Maximum samples of a channel in a fit (a choice: denser records are thinned evenly)."""
FINE, LONGEST = 2, 5e-4
"""Simulation samples per record sample, and the longest time between two of them [s] (choices:
cubic interpolation follows a 200 Hz oscillation within 0.2 %)."""
RELATIVE: Final = 1e-8
"""Tolerance of an integration step, tight because slopes are differences of two runs."""
STEPS: Final = (1e-3, 0.1)
"""Least and largest slope step relative to a parameter's size (choices: far above integration
errors, yet local); between them, the step that moves the residuals by their noise."""
FIRST: Final = 1e-2
"""The first slope step (a choice)."""
GUESSES: Final = (1 / 3, 3.0)
"""Factors on each start tried before the search (a choice)."""
ASTRAY: Final = 5.0
"""Residual relative to noise above which another start is tried (a choice)."""
MARGIN: Final = 0.02
"""Search range about the best trial lag, relative to the simulated time (a choice)."""
LAGS: Final = 801
"""Trial lags before the search (a choice)."""
FAR: Final = 10.0
"""Residual of a failed run, relative to the largest of the first run (a choice)."""
PASSES: Final = 40
"""Maximum steps of a search (a choice)."""
ROUNDS: Final = 4
"""Maximum searches with new weights (a choice)."""
SETTLED: Final = 0.1
"""Relative change of the weights that counts as converged (a choice)."""
ROUGH, SHARP = 1e-4, 1e-8
"""Relative change of cost and step that ends a search, intermediate and final (choices)."""


class RecordFitProblem:
    """Weighted residuals as a function of the searched values, logarithms for positive parameters.

    Parameters
    ----------
    scenario, plant, records, tuned : of the simulation
    measured : on the scenario's time
    own : the parameters
    """

    def __init__(
        self,
        scenario: Scenario,
        plant: Plant,
        records: Records,
        tuned: Tuned | None,
        measured: Measured,
        own: Sequence[Entry],
    ) -> None:
        self.scenario, self.plant, self.records, self.tuned = scenario, plant, records, tuned
        self.own, self.names = tuple(own), tuple(one.name for one in own)
        self.late = self.names.index("lag") if "lag" in self.names else None
        self.start, self.low, self.high = (
            np.array([_scaled(one, getattr(one, end)) for one in own])
            for end in ("start", "lower", "upper")
        )
        apart = min(float(np.median(np.diff(t))) for t, _ in measured.channels.values())
        self.sizes = np.array([1.0 if one.positive else one.near or apart for one in own])
        duration = scenario.duration
        self.step = _step(apart, duration)
        self.steps = FIRST * self.sizes
        self.runs = 0
        self._known: tuple[bytes, Array, Mapping[str, Array]] | None = None
        self.noise = {name: noise(y) for name, (_, y) in measured.channels.items()}
        still = [name for name, one in self.noise.items() if one == 0]
        self.notes = [f"{name} is constant in the record: not used in the fit" for name in still]
        moving = {name: one for name, one in measured.channels.items() if name not in still}
        if not moving:
            raise measured.fault("every channel is constant", "fit to a record with motion")
        self.weights = {name: 1 / self.noise[name] for name in moving}
        _, signals = self._simulated(self.start)
        used = self._overlapping(replace(measured, channels=moving), signals)
        self.used = {name: _thinned(*one) for name, one in used.items()}
        self.notes += _told(used, self.used)
        self.far = np.inf
        self.far = FAR * float(np.max(np.abs(self.rest(self.start))))

    def put(self, x: Array) -> Case:
        """Scenario and plant with fitted values, in the order of the table."""
        scenario, plant = self.scenario, self.plant
        for name in PARAMETERS:
            if name in self.names:
                k = self.names.index(name)
                value = float(np.exp(x[k])) if self.own[k].positive else float(x[k])
                scenario, plant = self.own[k].put(scenario, plant, value)
        return scenario, plant

    def lag(self, x: Array) -> float:
        """Time lag of the record [s]."""
        return 0.0 if self.late is None else float(x[self.late])

    def _simulated(self, x: Array) -> tuple[Array, Mapping[str, Array]]:
        """Time and signals; the last run is cached, as a lag does not change it."""
        own = np.array(x, dtype=float)
        if self.late is not None:
            own[self.late] = 0.0
        key = own.tobytes()
        if self._known is not None and self._known[0] == key:
            return self._known[1:]
        scenario, plant = self.put(x)
        gains = None if self.tuned is None else self.tuned.gains
        circuit = assemble(scenario, plant, self.records, gains)
        idle = {id(one[1]) for one in circuit.audit.flows}
        idle |= {id(one[2]) for one in circuit.audit.mass}
        states = circuit.system.states
        circuit.system.states = [one for one in states if id(one.symbol) not in idle]
        compiled = circuit.system.compiled()
        self.runs += 1
        found = integrate(
            compiled, duration=scenario.duration, sample_time=self.step, relative=RELATIVE
        )
        signals = compiled.signals(found.time, found.states, found.flags)
        self._known = key, found.time, signals
        return found.time, signals

    def apart(self, x: Array) -> dict[str, Array]:
        """Simulated less measured, by channel."""
        time, signals = self._simulated(x)
        late = self.lag(x)
        return {
            name: beside(t - late, y, time, signals[name]) - y for name, (t, y) in self.used.items()
        }

    def rest(self, x: Array) -> Array:
        """Weighted residuals; very large ones if the run fails."""
        try:
            found = self.apart(x)
        except Unsolvable:
            if not np.isfinite(self.far):
                raise
            return np.full(sum(t.size for t, _ in self.used.values()), self.far)
        return np.concatenate([self.weights[name] * one for name, one in found.items()])

    def slopes(self, x: Array, steps: Array) -> Array:
        """Derivatives of the residuals by central differences, within the range."""
        columns = []
        for k, step in enumerate(steps):
            up, down = x.copy(), x.copy()
            up[k], down[k] = min(x[k] + step, self.high[k]), max(x[k] - step, self.low[k])
            columns.append((self.rest(up) - self.rest(down)) / (up[k] - down[k]))
        return np.stack(columns, axis=1)

    def slopes_on_the_way(self, x: Array) -> Array:
        """One-sided differences, with steps that follow the last ones."""
        here, columns = self.rest(x), []
        for k, step in enumerate(self.steps):
            row = x.copy()
            row[k] += step if x[k] + step < self.high[k] else -step
            columns.append((self.rest(row) - here) / (row[k] - x[k]))
        found = np.stack(columns, axis=1)
        moved = np.maximum(np.linalg.norm(found, axis=0) * self.sizes, 1e-300)
        self.steps = np.clip(1 / moved, *STEPS) * self.sizes
        return found

    def solve(self) -> Array:
        """The best values: trial starts, a search, then a precise one.

        If the model misses the record by far, the search restarts once from the initial values.
        """
        tried = self._guessed(self.start)
        x = self._searched(tried)
        if self._astray(x) and not np.array_equal(tried, self.start):
            other = self._searched(self.start)
            x = min((x, other), key=self._judged)
        self._weigh(x)
        return self._descended(x, SHARP)

    def _searched(self, x: Array) -> Array:
        """Least squares with each channel weighted by its residual, until the weights settle."""
        self._weigh(x)
        for _ in range(ROUNDS):
            x = self._descended(x, ROUGH)
            before = dict(self.weights)
            self._weigh(x)
            if all(abs(self.weights[name] / one - 1) < SETTLED for name, one in before.items()):
                break
        return x

    def left(self, x: Array) -> dict[str, float]:
        """Root mean square residual of every channel, at least its noise."""
        return {
            name: max(self.noise[name], float(np.sqrt(np.mean(one**2))))
            for name, one in self.apart(x).items()
        }

    def _astray(self, x: Array) -> bool:
        """Whether some channel has residuals far above its noise."""
        return any(one > ASTRAY * self.noise[name] for name, one in self.left(x).items())

    def _weigh(self, x: Array) -> None:
        """Weight the channels by their residuals."""
        self.weights = {name: 1 / one for name, one in self.left(x).items()}

    def _judged(self, x: Array) -> float:
        """Negative log-likelihood: logarithm of the residuals, over all samples."""
        try:
            left = self.left(x)
        except Unsolvable:
            return np.inf
        return float(sum(self.used[name][0].size * np.log(one) for name, one in left.items()))

    def _overlapping(
        self, measured: Measured, signals: Mapping[str, Array]
    ) -> dict[str, tuple[Array, Array]]:
        """The part of a record that overlaps the run at every searched lag."""
        duration = self.scenario.duration
        if self.late is None:
            return inside(measured, signals, duration, 0.0)
        middle = self._aligned(measured, signals)
        self.start[self.late] = middle
        low, high = middle - MARGIN * duration, middle + MARGIN * duration
        self.low[self.late], self.high[self.late] = low, high
        whole = inside(measured, signals, duration, middle)
        ends = [(t >= high) & (t <= duration + low) for t, _ in whole.values()]
        found = {
            name: (t[kept], y[kept])
            for kept, (name, (t, y)) in zip(ends, whole.items(), strict=True)
            if np.count_nonzero(kept) >= FEWEST
        }
        if not found:
            message = "too little of the record overlaps the scenario to determine a lag"
            raise measured.fault(message, "measure longer, or state the lag")
        return found

    def _aligned(self, measured: Measured, signals: Mapping[str, Array]) -> float:
        """The most likely lag of the first run, from the overlap."""
        assert self.late is not None
        time, _ = self._simulated(self.start)
        lags = np.linspace(self.low[self.late], self.high[self.late], LAGS)
        judged, count = np.zeros(LAGS), np.zeros(LAGS)
        for name, channel in measured.channels.items():
            if name not in signals:
                continue
            t, y = _thinned(*channel)
            course = Course(time, signals[name])
            for k, lag in enumerate(lags):
                within = (t >= lag) & (t <= lag + time[-1])
                off = course(t[within] - lag) - y[within]
                square = float(np.mean(off**2)) if off.size else np.inf
                judged[k] += t.size * np.log(max(square, self.noise[name] ** 2))
                count[k] += off.size
        enough = count >= max(0.5 * float(np.max(count)), 1.0)
        return float(lags[int(np.argmin(np.where(enough, judged, np.inf)))])

    def _guessed(self, x: Array) -> Array:
        """Improve the starts of positive parameters by trial factors, one after the other."""
        best, least = x, self._judged(x)
        for k, one in enumerate(self.own):
            for by in GUESSES if one.positive else ():
                row = best.copy()
                row[k] = np.clip(x[k] + np.log(by), self.low[k], self.high[k])
                judged = self._judged(row)
                best, least = (row, judged) if judged < least else (best, least)
        return best

    def _descended(self, x: Array, tolerance: float) -> Array:
        """Least squares within the range."""
        return least_squares.solve(
            self.rest,
            x,
            (self.low, self.high),
            slopes=self.slopes_on_the_way,
            sizes=self.sizes,
            room=1e-6 * (self.high - self.low),
            cost_tolerance=tolerance,
            step_tolerance=tolerance,
            most=PASSES,
        ).x


def _scaled(entry: Entry, value: float) -> float:
    return float(np.log(value)) if entry.positive else float(value)


def _step(apart: float, duration: float) -> float:
    """Time between samples of a run: a whole fraction of the record's, unless too fine."""
    longest = max(min(apart / FINE, LONGEST), duration / (FINE * MOST))
    return apart / ceil(apart / longest) if longest < apart else longest


def _told(
    whole: Mapping[str, tuple[Array, Array]], used: Mapping[str, tuple[Array, Array]]
) -> Iterator[str]:
    """Notes on channels that the fit thins."""
    steps: dict[int, list[str]] = {}
    for name, (time, _) in whole.items():
        steps.setdefault(_every(time), []).append(name)
    for every, names in sorted(steps.items()):
        if every > 1:
            yield f"{named(names, used)}: the fit uses one of {every} samples, {MOST} at most"


def _every(time: Array) -> int:
    return -(-len(time) // MOST)


def _thinned(time: Array, values: Array) -> tuple[Array, Array]:
    """Every n-th sample, within the fit's maximum."""
    every = _every(time)
    return time[::every], values[::every]
