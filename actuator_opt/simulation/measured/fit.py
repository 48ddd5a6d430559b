"""Fit parameters of a design to a measured record: least squares over whole simulations.

Residuals and slopes come from the simulation; the bounds of the parameters follow from them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from math import ceil
from time import perf_counter
from typing import Any, Final, Literal

import numpy as np

from ...base import fitting as least_squares
from ...base.errors import Unsolvable, shown
from ...base.fitting import WEAK, FittedParameters, Parameter, known, rated
from ...base.numeric import Array
from ...base.progress import whole
from ...design.scenario.kinds import Records
from ...design.scenario.model import Scenario
from ...studies.plant import Plant
from ..assemble import assemble
from ..integrate import Method, integrate
from ..linear import Tuned, tune
from ..run import run
from .parameters import PARAMETERS, Case, FitParameter, entries
from .record import (
    FEWEST,
    AlignedRecord,
    Overlay,
    SimulatedSignal,
    beside,
    inside,
    named,
    noise,
    overlay,
)

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
        measured: AlignedRecord,
        own: Sequence[FitParameter],
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
        idle = {id(flow[1]) for flow in circuit.audit.flows}
        idle |= {id(one[2]) for one in circuit.audit.mass}
        states = circuit.system.states
        circuit.system.states = [state for state in states if id(state.symbol) not in idle]
        compiled = circuit.system.compiled()
        self.runs += 1
        trajectory = integrate(
            compiled, duration=scenario.duration, sample_time=self.step, relative=RELATIVE
        )
        signals = compiled.signals(trajectory.time, trajectory.states, trajectory.flags)
        self._known = key, trajectory.time, signals
        return trajectory.time, signals

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
        self, measured: AlignedRecord, signals: Mapping[str, Array]
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

    def _aligned(self, measured: AlignedRecord, signals: Mapping[str, Array]) -> float:
        """The most likely lag of the first run, from the overlap."""
        assert self.late is not None
        time, _ = self._simulated(self.start)
        lags = np.linspace(self.low[self.late], self.high[self.late], LAGS)
        judged, count = np.zeros(LAGS), np.zeros(LAGS)
        for name, channel in measured.channels.items():
            if name not in signals:
                continue
            t, y = _thinned(*channel)
            course = SimulatedSignal(time, signals[name])
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


def _scaled(entry: FitParameter, value: float) -> float:
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


STEADIEST: Final = 0.97
"""Largest correlation of neighbouring samples used for the bandwidth, as is usual."""


WHOLE: Final = 4
"""Least number of bandwidths in a record (a choice)."""


ORDERS: Final = 10
"""Highest order of an autoregression of residuals (a choice)."""


def bounds(problem: RecordFitProblem, x: Array) -> FittedParameters:
    """Covariance of the fitted values from the residuals.

    cov = H^-1 S H^-1, H = J^T J, S the covariance of J^T r. S is the largest of three estimates:
    independent residuals; channels as autoregressions, each of the order by Akaike's criterion;
    and, for intermittent misfit, the sum of J^T r r^T J over times and lags within a bandwidth,
    with Bartlett's weights (Newey and West; bandwidth by Andrews' rule), all channels of an instant
    together. The degrees of freedom follow from that window, 3 n/(2 m) - p. The slopes are secants
    over a standard error.
    """
    rest = problem.rest(x)
    variance = float(np.sum(rest**2)) / max(rest.size - x.size, 1)
    first = problem.slopes_on_the_way(x) * problem.sizes
    errors = np.sqrt(variance * np.diag(np.linalg.pinv(first.T @ first, hermitian=True)))
    errors[np.linalg.norm(first, axis=0) == 0] = np.inf
    steps = np.clip(errors, *STEPS) * problem.sizes
    scaled = problem.slopes(x, steps) * problem.sizes
    left, singular, right = np.linalg.svd(scaled, full_matrices=False)
    moments = _by_time(problem, left * rest[:, None])
    width = _bandwidth(moments)
    inner = _larger(variance * np.eye(x.size), _coloured(problem, left, rest))
    inner = _larger(inner, _summed(moments, width))
    root = np.linalg.cholesky(inner)
    whitened = np.linalg.solve(root, singular[:, None] * right) / problem.sizes
    points = min(float(rest.size), 1.5 * moments.shape[0] / width)
    return known(
        dict(zip(problem.names, x.tolist(), strict=True)),
        whitened,
        np.ones(1) * np.sqrt(points),
        problem.sizes,
        spare=max(points - x.size, 1.0),
    )


def _larger(first: Array, second: Array) -> Array:
    """A covariance at least as large as both: the first plus the excess of the second."""
    values, turn = np.linalg.eigh(second - first)
    found: Array = first + (turn * np.maximum(values, 0.0)) @ turn.T
    return found


def _by_time(problem: RecordFitProblem, rows: Array) -> Array:
    """Rows of samples, summed per instant, in the order of time."""
    times = np.concatenate([t for t, _ in problem.used.values()])
    instants, place = np.unique(times, return_inverse=True)
    found = np.zeros((instants.size, rows.shape[1]))
    np.add.at(found, place, rows)
    return found


def _bandwidth(moments: Array) -> float:
    """Correlation length of the moments in samples, from neighbouring values."""
    before, after = moments[:-1], moments[1:]
    power = np.maximum(np.sum(before**2, axis=0), 1e-300)
    rho = np.clip(np.sum(before * after, axis=0) / power, -STEADIEST, STEADIEST)
    square = (power / power.size) ** 2
    above = np.sum(4 * rho**2 * square / ((1 - rho) ** 6 * (1 + rho) ** 2))
    alpha = float(above / max(np.sum(square / (1 - rho) ** 4), 1e-300))
    count = moments.shape[0]
    return float(np.clip(1.1447 * (alpha * count) ** (1 / 3), 1.0, max(count / WHOLE, 1.0)))


def _summed(moments: Array, width: float) -> Array:
    """Sum of products of moments within a bandwidth, with weights that fall to zero."""
    total: Array = moments.T @ moments
    for k in range(1, min(int(np.ceil(width)), moments.shape[0])):
        product = moments[:-k].T @ moments[k:]
        total = total + (1 - k / width) * (product + product.T)
    return total


def _coloured(problem: RecordFitProblem, left: Array, rest: Array) -> Array:
    """Covariance of U^T r with every channel's residuals as an autoregression."""
    from scipy.linalg import matmul_toeplitz  # slow import, rarely used

    total = np.zeros((left.shape[1], left.shape[1]))
    first = 0
    for t, _ in problem.used.values():
        part = slice(first, first + t.size)
        first += t.size
        total += left[part].T @ matmul_toeplitz(_autocovariance(rest[part]), left[part])
    return total


def _autocovariance(rest: Array) -> Array:
    """Autocovariance of the best autoregression of some residuals, by Levinson's recursion."""
    count = rest.size
    orders = min(ORDERS, count // 4)
    lags = np.array([float(rest[: count - k] @ rest[k:]) for k in range(orders + 1)]) / count
    found, weights = np.empty(0), np.empty(0)
    variance = lags[0]
    least = np.inf
    for order in range(orders + 1):
        if order:
            turn = (lags[order] - weights @ lags[order - 1 : 0 : -1]) / variance
            weights = np.append(weights - turn * weights[::-1], turn)
            variance = max(variance * (1 - turn**2), 1e-12 * lags[0])
        cost = count * np.log(max(variance, 1e-300)) + 2 * order
        if cost < least:
            least, found = cost, weights
    series = np.empty(count)
    series[: orders + 1] = lags
    for k in range(found.size + 1, count):
        series[k] = found @ series[k - found.size : k][::-1]
    return series


MISFIT: Final = 2.0
"""Residual relative to noise above which the model misses the record (a choice)."""
WORSE: Final = 1.05
"""Residual relative to that before the fit above which the fit is worse (a choice)."""
ALIKE: Final = 0.9
"""Correlation above which two parameters are reported as inseparable (a choice)."""
EDGE: Final = 0.01
"""Share of a parameter's range within which it counts as at the end (a choice)."""


@dataclass(frozen=True, slots=True)
class Fitted:
    """A fitted parameter, SI."""

    entry: FitParameter
    parameter: Parameter
    at_bound: Literal["lower", "upper"] | None
    """The end of its range, if it is there."""

    def to_dict(self) -> dict[str, Any]:
        """As plain data for JSON, SI."""
        quantity = self.entry.quantity
        return {
            "label": quantity.label,
            "unit": quantity.si_unit,
            "start": self.entry.start,
            **self.parameter.to_dict(),
            "at_bound": self.at_bound,
        }


@dataclass(frozen=True, slots=True)
class Fit:
    """Parameters fitted to a record.

    Parameters
    ----------
    scenario, plant : with the fitted parameters
    parameters : by name
    correlations : of the errors of two parameters, by their names
    before, after : the record against the simulation with the first and the fitted values, the
        first with the best lag if a lag is fitted
    doubts : caveats that the numbers do not show
    runs, seconds : number of runs, and time taken
    """

    scenario: Scenario
    plant: Plant
    parameters: Mapping[str, Fitted]
    correlations: Mapping[tuple[str, str], float]
    before: Overlay
    after: Overlay
    doubts: tuple[str, ...]
    runs: int
    seconds: float

    @property
    def missed(self) -> tuple[str, ...]:
        """Channels with residuals above their noise, where the model lacks something."""
        found = self.after.residuals.items()
        return tuple(name for name, one in found if one.span and one.rms > MISFIT * one.noise)

    @property
    def values(self) -> dict[str, float]:
        """Fitted values by name, SI."""
        return {name: one.parameter.value for name, one in self.parameters.items()}

    def to_dict(self) -> dict[str, Any]:
        """As plain data for JSON, SI."""
        return {
            "record": self.after.measured.name,
            "parameters": {name: one.to_dict() for name, one in self.parameters.items()},
            "correlations": [
                {"between": list(pair), "value": value} for pair, value in self.correlations.items()
            ],
            "before": self.before.to_dict(),
            "after": self.after.to_dict(),
            "missed": list(self.missed),
            "doubts": list(self.doubts),
            "runs": self.runs,
            "seconds": self.seconds,
        }


def fit(
    scenario: Scenario,
    plant: Plant,
    records: Records,
    measured: AlignedRecord,
    names: Sequence[str],
    *,
    tuned: Tuned | None = None,
    verify: bool = False,
    method: Method = "lsoda",
    spec: str = "",
) -> Fit:
    """Fit named parameters of a design or scenario to a measured record.

    Least squares over all channels, each weighted by its sensor noise (`record.noise`), then by its
    residuals if larger. Bounds are 95 %, from the slopes at the solution and from residuals
    correlated over time.

    Parameters
    ----------
    scenario, plant : the measured system, as far as known
    records : columns of the files that the scenario's signals name
    measured : on the scenario's time
    names : of `parameters.PARAMETERS`, and "lag"
    tuned : gains of the controller, which the fit leaves alone; default: as the scenario says
    verify, method : of the simulation with the fitted values, as `simulation.simulate`
    spec : hash of the scenario and its design

    Raises
    ------
    InputError
        no such parameter, one without effect, or no overlap with the record
    Unsolvable
        the simulation fails at the initial values
    """
    begin = perf_counter()
    own = entries(names, scenario, plant)
    gains = tune(scenario, plant, records) if tuned is None else tuned
    problem = RecordFitProblem(scenario, plant, records, gains, measured, own)
    first = problem.lag(problem.start)
    dense = {"sample_time": problem.step}
    start = run(scenario.model_copy(update=dense), plant, records, gains, spec=spec)
    before = overlay(start, measured, lag=first)
    with whole("fitting"):
        x = problem.solve()
    told = bounds(problem, x)
    fitted = {
        one.name: Fitted(one, _natural(one, told, problem), _edge(problem, x, k))
        for k, one in enumerate(own)
    }
    correlations = _correlations(told)
    new_scenario, new_plant = problem.put(x)
    after_gains = tune(new_scenario, new_plant, records, held=gains)
    final = run(
        new_scenario.model_copy(update=dense), new_plant, records, after_gains,
        verify=verify, method=method, spec=spec,
    )  # fmt: skip
    after = overlay(final, measured, lag=problem.lag(x))
    doubts = (
        *problem.notes,
        *_unknown(fitted),
        *_parted(fitted, correlations),
        *_missed(after, before),
        *_loop(gains),
    )
    return Fit(
        new_scenario, new_plant, fitted, correlations, before, after, doubts,
        problem.runs, perf_counter() - begin,
    )  # fmt: skip


def _natural(
    fit_parameter: FitParameter, fitted_parameters: FittedParameters, problem: RecordFitProblem
) -> Parameter:
    """A parameter in its own unit from the searched value.

    Bounds apply to the parameter itself, not to its logarithm, as the effect of an air content or a
    leakage is proportional. None is below zero.
    """
    x = fitted_parameters.parameters[fit_parameter.name]
    half = x.upper - x.value
    if not fit_parameter.positive:
        near = fit_parameter.near or float(problem.sizes[problem.names.index(fit_parameter.name)])
        sure = bool(half <= max(WEAK * abs(x.value), near))
        return Parameter(x.value, float(x.lower), float(x.upper), x.standard_error, sure)
    value = float(np.exp(x.value))
    if not np.isfinite(half):
        return Parameter(value, -np.inf, np.inf, np.inf, False)
    low, high = value * max(1 - float(half), 0.0), value * (1 + float(half))
    return rated(value, low, high, value * x.standard_error)


def _edge(problem: RecordFitProblem, x: Array, k: int) -> Literal["lower", "upper"] | None:
    """The end of its range at which a parameter lies, or None."""
    room = EDGE * (problem.high[k] - problem.low[k])
    if x[k] - problem.low[k] < room:
        return "lower"
    return "upper" if problem.high[k] - x[k] < room else None


def _correlations(fitted_parameters: FittedParameters) -> dict[tuple[str, str], float]:
    """Correlations between the errors of bounded parameters."""
    found = {}
    for (i, one), (k, other) in combinations(enumerate(fitted_parameters.parameters), 2):
        size = np.sqrt(fitted_parameters.covariance[i, i] * fitted_parameters.covariance[k, k])
        if np.isfinite(size) and size > 0:
            found[one, other] = float(np.clip(fitted_parameters.covariance[i, k] / size, -1.0, 1.0))
    return found


def _unknown(fitted: Mapping[str, Fitted]) -> Iterator[str]:
    """Parameters that are not identified, and why."""
    for name, one in fitted.items():
        quantity, found = one.entry.quantity, one.parameter
        if one.at_bound is not None:
            low = one.at_bound == "lower"
            end = one.entry.lower if low else one.entry.upper
            yield (
                f"{name} is at the {one.at_bound} end of its range, {quantity.text(end)}: the "
                f"record suggests {('less' if low else 'more')}, or the simulation lacks "
                "something else"
            )
        elif found.verdict == "identifiable":
            continue
        elif not np.isfinite(found.upper):
            yield (
                f"{name} is not identifiable: no measured channel depends on it, or only in "
                "combination with other fitted parameters"
            )
        else:
            between = f"{quantity.text(found.lower, 3)} to {quantity.text(found.upper, 3)}"
            yield f"{name} is {found.verdict}: the record allows {between}"


def _parted(
    fitted: Mapping[str, Fitted], correlations: Mapping[tuple[str, str], float]
) -> Iterator[str]:
    """Parameters that the fit cannot separate."""
    found = [
        f"{one} with {other} ({value:.2f})"
        for (one, other), value in correlations.items()
        if abs(value) > ALIKE
        and not all(fitted[name].parameter.identifiable for name in (one, other))
    ]
    if found:
        yield (
            f"correlated errors: {', '.join(found)}; the pair is known better than each alone: "
            "state one, or measure what separates them"
        )


def _missed(after: Overlay, before: Overlay) -> Iterator[str]:
    """Channels with residuals above the noise."""
    missed = []
    for name, one in after.residuals.items():
        if one.span == 0 or one.rms <= MISFIT * one.noise:
            continue
        quantity = after.simulation.told[name].quantity
        missed.append(f"{name} {quantity.text(one.rms, 2)}, {_times(one.rms / one.noise)} times")
        if one.rms > WORSE * before.residuals[name].rms:
            yield f"{name} fits worse than before: the channels contradict each other"
    if missed:
        yield shown(
            f"the simulation misses the record by more than its noise ({'; '.join(missed)}): the "
            "model lacks something (or the record was smoothed), and the bounds do not include "
            "the resulting bias of the parameters",
            400,
        )


def _times(ratio: float) -> str:
    return f"{ratio:.2g}" if ratio < 10 else f"{ratio:.0f}"


def _loop(tuned: Tuned | None) -> Iterator[str]:
    if tuned is not None and tuned.origin != "stated":
        yield (
            f"the controller's gain is not stated but comes from {tuned.origin}: state the test "
            "bench's gain in control"
        )
