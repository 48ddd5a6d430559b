"""Fit parameters of a design to a measured record: least squares, with whole simulations.

Residuals, and their derivatives by the parameters, come from simulations. The confidence intervals
of the parameters follow from these residuals and derivatives.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from math import ceil
from time import perf_counter
from typing import Any, Final, Literal

import numpy as np

from ...base import fitting as least_squares
from ...base.dataclass import dataclass
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
    ChannelResidual,
    Overlay,
    SimulatedSignal,
    beside,
    inside,
    named,
    noise,
    overlay,
)

MOST: Final = 4000
"""Largest number of samples of a channel used in a fit (our choice). Of a denser record, only every
n-th sample is used."""
FINE, LONGEST = 2, 5e-4
"""Simulation samples per record sample, and the longest time between two simulation samples [s]
(our choices: cubic interpolation then follows a 200 Hz oscillation within 0.2 %)."""
RELATIVE: Final = 1e-8
"""Relative tolerance of an integration step. It is tight because the derivatives of the residuals
are small differences between two simulations."""
STEPS: Final = (1e-3, 0.1)
"""Smallest and largest step of a parameter for a difference quotient, relative to its size (our
choices: far above integration errors, yet local). Within these limits, the step is chosen so that
the residuals change by as much as their noise."""
FIRST: Final = 1e-2
"""First step of a parameter for a difference quotient, relative to its size (our choice)."""
GUESSES: Final = (1 / 3, 3.0)
"""Factors by which each initial value may be multiplied before the search, if the record then fits
better (our choice)."""
ASTRAY: Final = 5.0
"""Ratio of residual to noise above which the search is repeated from the unchanged initial values
(our choice)."""
MARGIN: Final = 0.02
"""Half the range about the best trial lag in which the search varies the lag, as a share of the
simulated time (our choice)."""
LAGS: Final = 801
"""Number of lags that are tried before the search (our choice)."""
FAR: Final = 10.0
"""Residual assigned to a failed simulation, divided by the largest residual of the first simulation
(our choice)."""
PASSES: Final = 40
"""Largest number of iterations of a least-squares search (our choice)."""
ROUNDS: Final = 4
"""Largest number of searches, each with new weights of the channels (our choice)."""
SETTLED: Final = 0.1
"""Relative change of the weights below which they count as converged (our choice)."""
ROUGH, SHARP = 1e-4, 1e-8
"""Relative change of the cost and of the step that ends a search: for intermediate searches and for
the final search (our choices)."""


class RecordFitProblem:
    """Weighted residuals as a function of the searched values.

    For a positive parameter, the search varies the logarithm.

    Parameters
    ----------
    scenario, plant, records, tuned : inputs of the simulation
    measured : record, on the time axis of the scenario
    parameters : the parameters to fit
    """

    def __init__(
        self,
        scenario: Scenario,
        plant: Plant,
        records: Records,
        tuned: Tuned | None,
        measured: AlignedRecord,
        parameters: Sequence[FitParameter],
    ) -> None:
        self.scenario, self.plant, self.records, self.tuned = scenario, plant, records, tuned
        self.parameters, self.names = (
            tuple(parameters),
            tuple(parameter.name for parameter in parameters),
        )
        self.lag_index = self.names.index("lag") if "lag" in self.names else None
        self.start, self.low, self.high = (
            np.array([_scaled(parameter, getattr(parameter, end)) for parameter in parameters])
            for end in ("start", "lower", "upper")
        )
        spacing = min(float(np.median(np.diff(t))) for t, _ in measured.channels.values())
        self.sizes = np.array(
            [1.0 if parameter.positive else parameter.near or spacing for parameter in parameters]
        )
        duration = scenario.duration
        self.step = _step(spacing, duration)
        self.steps = FIRST * self.sizes
        self.runs = 0
        self._cached: tuple[bytes, Array, Mapping[str, Array]] | None = None
        self.noise = {name: noise(y) for name, (_, y) in measured.channels.items()}
        constant = [name for name, level in self.noise.items() if level == 0]
        self.notes = [
            f"{name} is constant in the record and was not used in the fit" for name in constant
        ]
        varying = {
            name: channel for name, channel in measured.channels.items() if name not in constant
        }
        if not varying:
            raise measured.fault("every channel is constant", "choose a record with motion")
        self.weights = {name: 1 / self.noise[name] for name in varying}
        _, signals = self._simulated(self.start)
        overlap = self._overlapping(replace(measured, channels=varying), signals)
        self.used = {name: _thinned(*channel) for name, channel in overlap.items()}
        self.notes += _thinning_notes(overlap, self.used)
        self.failed = np.inf
        self.failed = FAR * float(np.max(np.abs(self.residuals(self.start))))

    def put(self, x: Array) -> Case:
        """Scenario and plant with the searched values, applied in the order of `PARAMETERS`."""
        scenario, plant = self.scenario, self.plant
        for name in PARAMETERS:
            if name in self.names:
                k = self.names.index(name)
                value = float(np.exp(x[k])) if self.parameters[k].positive else float(x[k])
                scenario, plant = self.parameters[k].put(scenario, plant, value)
        return scenario, plant

    def lag(self, x: Array) -> float:
        """Time lag between record and simulation [s]."""
        return 0.0 if self.lag_index is None else float(x[self.lag_index])

    def _simulated(self, x: Array) -> tuple[Array, Mapping[str, Array]]:
        """Time and signals of a simulation.

        The last result is kept, so that a change of the lag alone needs no new simulation.
        """
        searched = np.array(x, dtype=float)
        if self.lag_index is not None:
            searched[self.lag_index] = 0.0
        key = searched.tobytes()
        if self._cached is not None and self._cached[0] == key:
            return self._cached[1:]
        scenario, plant = self.put(x)
        gains = None if self.tuned is None else self.tuned.gains
        circuit = assemble(scenario, plant, self.records, gains)
        audited = {id(flow[1]) for flow in circuit.audit.flows}
        audited |= {id(term[2]) for term in circuit.audit.mass}
        states = circuit.system.states
        circuit.system.states = [state for state in states if id(state.symbol) not in audited]
        compiled = circuit.system.compiled()
        self.runs += 1
        trajectory = integrate(
            compiled, duration=scenario.duration, sample_time=self.step, relative=RELATIVE
        )
        signals = compiled.signals(trajectory.time, trajectory.states, trajectory.flags)
        self._cached = key, trajectory.time, signals
        return trajectory.time, signals

    def differences(self, x: Array) -> dict[str, Array]:
        """Simulated minus measured values, by channel."""
        time, signals = self._simulated(x)
        lag = self.lag(x)
        return {
            name: beside(t - lag, y, time, signals[name]) - y for name, (t, y) in self.used.items()
        }

    def residuals(self, x: Array) -> Array:
        """Weighted residuals; very large if the simulation fails."""
        try:
            differences = self.differences(x)
        except Unsolvable:
            if not np.isfinite(self.failed):
                raise
            return np.full(sum(t.size for t, _ in self.used.values()), self.failed)
        return np.concatenate(
            [self.weights[name] * difference for name, difference in differences.items()]
        )

    def slopes(self, x: Array, steps: Array) -> Array:
        """Derivatives of the residuals by the searched values, from central differences.

        At an end of the permitted range of a value, the difference is one-sided.
        """
        columns = []
        for k, step in enumerate(steps):
            up, down = x.copy(), x.copy()
            up[k], down[k] = min(x[k] + step, self.high[k]), max(x[k] - step, self.low[k])
            columns.append((self.residuals(up) - self.residuals(down)) / (up[k] - down[k]))
        return np.stack(columns, axis=1)

    def search_slopes(self, x: Array) -> Array:
        """Derivatives of the residuals by the searched values, from one-sided differences.

        The steps of the next differences are then chosen from these derivatives.
        """
        residuals, columns = self.residuals(x), []
        for k, step in enumerate(self.steps):
            row = x.copy()
            row[k] += step if x[k] + step < self.high[k] else -step
            columns.append((self.residuals(row) - residuals) / (row[k] - x[k]))
        slopes = np.stack(columns, axis=1)
        size = np.maximum(np.linalg.norm(slopes, axis=0) * self.sizes, 1e-300)
        self.steps = np.clip(1 / size, *STEPS) * self.sizes
        return slopes

    def solve(self) -> Array:
        """Best values: choose a start, search, then search again with a tight tolerance.

        If the residuals stay far above the noise, the search is repeated once from the initial
        values.
        """
        guess = self._best_guess(self.start)
        x = self._reweighted(guess)
        if self._misses(x) and not np.array_equal(guess, self.start):
            restarted = self._reweighted(self.start)
            x = min((x, restarted), key=self._likelihood_cost)
        self._weigh(x)
        return self._least_squares(x, SHARP)

    def _reweighted(self, x: Array) -> Array:
        """Repeat least squares until the weights converge.

        The weight of a channel is the reciprocal of its residual.
        """
        self._weigh(x)
        for _ in range(ROUNDS):
            x = self._least_squares(x, ROUGH)
            before = dict(self.weights)
            self._weigh(x)
            if all(
                abs(self.weights[name] / weight - 1) < SETTLED for name, weight in before.items()
            ):
                break
        return x

    def levels(self, x: Array) -> dict[str, float]:
        """Root mean square residual of every channel; at least the noise of its sensor."""
        return {
            name: max(self.noise[name], float(np.sqrt(np.mean(difference**2))))
            for name, difference in self.differences(x).items()
        }

    def _misses(self, x: Array) -> bool:
        """Whether the residuals of any channel far exceed its noise."""
        return any(level > ASTRAY * self.noise[name] for name, level in self.levels(x).items())

    def _weigh(self, x: Array) -> None:
        """Weight the channels by their residuals."""
        self.weights = {name: 1 / level for name, level in self.levels(x).items()}

    def _likelihood_cost(self, x: Array) -> float:
        """Negative log-likelihood: sum over all samples of ln(rms residual of the channel)."""
        try:
            levels = self.levels(x)
        except Unsolvable:
            return np.inf
        return float(sum(self.used[name][0].size * np.log(level) for name, level in levels.items()))

    def _overlapping(
        self, measured: AlignedRecord, signals: Mapping[str, Array]
    ) -> dict[str, tuple[Array, Array]]:
        """Samples of a record that lie within the simulated time at every searched lag."""
        duration = self.scenario.duration
        if self.lag_index is None:
            return inside(measured, signals, duration, 0.0)
        middle = self._aligned(measured, signals)
        self.start[self.lag_index] = middle
        low, high = middle - MARGIN * duration, middle + MARGIN * duration
        self.low[self.lag_index], self.high[self.lag_index] = low, high
        samples = inside(measured, signals, duration, middle)
        ends = [(t >= high) & (t <= duration + low) for t, _ in samples.values()]
        overlap = {
            name: (t[inside_run], y[inside_run])
            for inside_run, (name, (t, y)) in zip(ends, samples.items(), strict=True)
            if np.count_nonzero(inside_run) >= FEWEST
        }
        if not overlap:
            message = "the record overlaps the scenario for too short a time to determine a lag"
            raise measured.fault(message, "measure longer, or state the lag")
        return overlap

    def _aligned(self, measured: AlignedRecord, signals: Mapping[str, Array]) -> float:
        """Most likely lag for the initial parameters, from samples within the simulated time."""
        assert self.lag_index is not None
        time, _ = self._simulated(self.start)
        lags = np.linspace(self.low[self.lag_index], self.high[self.lag_index], LAGS)
        cost, count = np.zeros(LAGS), np.zeros(LAGS)
        for name, channel in measured.channels.items():
            if name not in signals:
                continue
            t, y = _thinned(*channel)
            simulated = SimulatedSignal(time, signals[name])
            for k, lag in enumerate(lags):
                within = (t >= lag) & (t <= lag + time[-1])
                difference = simulated(t[within] - lag) - y[within]
                square = float(np.mean(difference**2)) if difference.size else np.inf
                cost[k] += t.size * np.log(max(square, self.noise[name] ** 2))
                count[k] += difference.size
        enough = count >= max(0.5 * float(np.max(count)), 1.0)
        return float(lags[int(np.argmin(np.where(enough, cost, np.inf)))])

    def _best_guess(self, x: Array) -> Array:
        """Improve the initial values: multiply each parameter in turn by the best of `GUESSES`."""
        best, least = x, self._likelihood_cost(x)
        for k, parameter in enumerate(self.parameters):
            for factor in GUESSES if parameter.positive else ():
                row = best.copy()
                row[k] = np.clip(x[k] + np.log(factor), self.low[k], self.high[k])
                cost = self._likelihood_cost(row)
                best, least = (row, cost) if cost < least else (best, least)
        return best

    def _least_squares(self, x: Array, tolerance: float) -> Array:
        """Least-squares solution within the permitted range."""
        return least_squares.solve(
            self.residuals,
            x,
            (self.low, self.high),
            slopes=self.search_slopes,
            sizes=self.sizes,
            room=1e-6 * (self.high - self.low),
            cost_tolerance=tolerance,
            step_tolerance=tolerance,
            most=PASSES,
        ).x


def _scaled(entry: FitParameter, value: float) -> float:
    return float(np.log(value)) if entry.positive else float(value)


def _step(spacing: float, duration: float) -> float:
    """Sample interval of the simulation; if possible, that of the record divided by an integer."""
    longest = max(min(spacing / FINE, LONGEST), duration / (FINE * MOST))
    return spacing / ceil(spacing / longest) if longest < spacing else longest


def _thinning_notes(
    all_samples: Mapping[str, tuple[Array, Array]], used: Mapping[str, tuple[Array, Array]]
) -> Iterator[str]:
    """Notes on the channels of which only every n-th sample is used."""
    steps: dict[int, list[str]] = {}
    for name, (time, _) in all_samples.items():
        steps.setdefault(_every(time), []).append(name)
    for step, names in sorted(steps.items()):
        if step > 1:
            yield (
                f"{named(names, used)}: the fit uses only one in {step} samples, at most {MOST} "
                "in total"
            )


def _every(time: Array) -> int:
    return -(-len(time) // MOST)


def _thinned(time: Array, values: Array) -> tuple[Array, Array]:
    """Every n-th sample, so that at most `MOST` remain."""
    step = _every(time)
    return time[::step], values[::step]


STEADIEST: Final = 0.97
"""Limit on the correlation between neighbouring samples in the rule for the bandwidth (see
`WHOLE`); the usual value."""


WHOLE: Final = 4
"""Largest bandwidth: the length of the record divided by this (our choice). Here, bandwidth means
the longest time lag over which residuals count as correlated."""


ORDERS: Final = 10
"""Highest order of the autoregression of the residuals (our choice)."""


def bounds(problem: RecordFitProblem, x: Array) -> FittedParameters:
    """Covariance of the fitted values, estimated from the residuals.

    The covariance is H^-1 S H^-1 with H = J^T J. J are the derivatives of the residuals r by the
    parameters, and S is the covariance of J^T r. S is at least as large as each of three estimates.
    The first assumes independent residuals. The second describes the residuals of each channel by
    an autoregression, whose order follows from Akaike's criterion. The third covers a misfit that
    occurs only at times. It sums J^T r r^T J over all times, and over time lags within a bandwidth
    with Bartlett's weights (Newey and West); all channels at a time count as one sample. The
    bandwidth follows from Andrews' rule. With n sample times, p parameters and the bandwidth m, the
    degrees of freedom are 3 n/(2 m) - p. J is computed by differences across one standard error of
    each parameter.
    """
    residuals = problem.residuals(x)
    variance = float(np.sum(residuals**2)) / max(residuals.size - x.size, 1)
    first = problem.search_slopes(x) * problem.sizes
    errors = np.sqrt(variance * np.diag(np.linalg.pinv(first.T @ first, hermitian=True)))
    errors[np.linalg.norm(first, axis=0) == 0] = np.inf
    steps = np.clip(errors, *STEPS) * problem.sizes
    scaled = problem.slopes(x, steps) * problem.sizes
    outputs, singular, right = np.linalg.svd(scaled, full_matrices=False)
    moments = _by_time(problem, outputs * residuals[:, None])
    width = _bandwidth(moments)
    inner = _larger(variance * np.eye(x.size), _coloured(problem, outputs, residuals))
    inner = _larger(inner, _summed(moments, width))
    root = np.linalg.cholesky(inner)
    whitened = np.linalg.solve(root, singular[:, None] * right) / problem.sizes
    points = min(float(residuals.size), 1.5 * moments.shape[0] / width)
    return known(
        dict(zip(problem.names, x.tolist(), strict=True)),
        whitened,
        np.ones(1) * np.sqrt(points),
        problem.sizes,
        spare=max(points - x.size, 1.0),
    )


def _larger(first: Array, second: Array) -> Array:
    """A covariance at least as large as both: the first plus what the second exceeds it by."""
    values, axes = np.linalg.eigh(second - first)
    covariance: Array = first + (axes * np.maximum(values, 0.0)) @ axes.T
    return covariance


def _by_time(problem: RecordFitProblem, rows: Array) -> Array:
    """For every time, the sum of the rows of all channels; in the order of time."""
    times = np.concatenate([t for t, _ in problem.used.values()])
    instants, instant = np.unique(times, return_inverse=True)
    sums = np.zeros((instants.size, rows.shape[1]))
    np.add.at(sums, instant, rows)
    return sums


def _bandwidth(moments: Array) -> float:
    """Bandwidth in samples (see `WHOLE`), by Andrews' rule from the correlation of neighbours."""
    before, after = moments[:-1], moments[1:]
    power = np.maximum(np.sum(before**2, axis=0), 1e-300)
    rho = np.clip(np.sum(before * after, axis=0) / power, -STEADIEST, STEADIEST)
    square = (power / power.size) ** 2
    above = np.sum(4 * rho**2 * square / ((1 - rho) ** 6 * (1 + rho) ** 2))
    alpha = float(above / max(np.sum(square / (1 - rho) ** 4), 1e-300))
    count = moments.shape[0]
    return float(np.clip(1.1447 * (alpha * count) ** (1 / 3), 1.0, max(count / WHOLE, 1.0)))


def _summed(moments: Array, width: float) -> Array:
    """Sum of products of pairs of samples; their weight falls to zero at a time lag `width`."""
    total: Array = moments.T @ moments
    for k in range(1, min(int(np.ceil(width)), moments.shape[0])):
        product = moments[:-k].T @ moments[k:]
        total = total + (1 - k / width) * (product + product.T)
    return total


def _coloured(problem: RecordFitProblem, outputs: Array, residuals: Array) -> Array:
    """Covariance of U^T r, with U = `outputs`, if the residuals r are an autoregression."""
    from scipy.linalg import matmul_toeplitz  # slow import, rarely used

    total = np.zeros((outputs.shape[1], outputs.shape[1]))
    first = 0
    for t, _ in problem.used.values():
        part = slice(first, first + t.size)
        first += t.size
        total += outputs[part].T @ matmul_toeplitz(_autocovariance(residuals[part]), outputs[part])
    return total


def _autocovariance(residuals: Array) -> Array:
    """Autocovariance of the autoregression that fits residuals best, by Levinson's recursion."""
    count = residuals.size
    orders = min(ORDERS, count // 4)
    lags = (
        np.array([float(residuals[: count - k] @ residuals[k:]) for k in range(orders + 1)]) / count
    )
    best, weights = np.empty(0), np.empty(0)
    variance = lags[0]
    least = np.inf
    for order in range(orders + 1):
        if order:
            turn = (lags[order] - weights @ lags[order - 1 : 0 : -1]) / variance
            weights = np.append(weights - turn * weights[::-1], turn)
            variance = max(variance * (1 - turn**2), 1e-12 * lags[0])
        cost = count * np.log(max(variance, 1e-300)) + 2 * order
        if cost < least:
            least, best = cost, weights
    series = np.empty(count)
    series[: orders + 1] = lags
    for k in range(best.size + 1, count):
        series[k] = best @ series[k - best.size : k][::-1]
    return series


MISFIT: Final = 2.0
"""Ratio of residual to noise above which the model does not explain the record (our choice)."""
WORSE: Final = 1.05
"""A channel fits worse if its residual after the fit exceeds that before the fit by more than this
factor (our choice)."""
ALIKE: Final = 0.9
"""Correlation above which two parameters are reported as not separable (our choice)."""
EDGE: Final = 0.01
"""A parameter counts as at an end of its range if its distance from that end is less than this
share of the range (our choice)."""


@dataclass(frozen=True, slots=True)
class Fitted:
    """A fitted parameter, SI."""

    entry: FitParameter
    parameter: Parameter
    at_bound: Literal["lower", "upper"] | None
    """The end of the permitted range at which the parameter lies; None if it lies inside."""

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
    """Result of a fit to a record.

    Parameters
    ----------
    scenario, plant : inputs with the fitted parameters
    parameters : fitted parameters by name
    correlations : correlation between the errors of two parameters, by their names
    before, after : comparisons of the record with the simulation at the initial and at the fitted
        values; if the lag is fitted, `before` has the lag that fits best at the initial values
    doubts : reasons to doubt the result, beyond its confidence intervals
    runs, seconds : number of simulations, and computing time
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
        """Channels with residuals above their noise; the model does not explain them completely."""
        return tuple(name for name, x in self.after.residuals.items() if _is_missed(x))

    @property
    def values(self) -> dict[str, float]:
        """Fitted values by name, SI."""
        return {name: fitted.parameter.value for name, fitted in self.parameters.items()}

    def to_dict(self) -> dict[str, Any]:
        """As plain data for JSON, SI."""
        return {
            "record": self.after.measured.name,
            "parameters": {name: fitted.to_dict() for name, fitted in self.parameters.items()},
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

    The fit is by least squares over all channels. Each channel is weighted by its sensor noise
    (`record.noise`), or by its residuals if they are larger. Confidence intervals are 95 %. They
    follow from the derivatives of the residuals at the solution, and take into account that
    residuals may be correlated over time.

    Parameters
    ----------
    scenario, plant : the measured system, as far as known
    records : columns of the files that the scenario's signals name
    measured : record, on the time axis of the scenario
    names : names of the parameters to fit, from `parameters.PARAMETERS`; "lag" fits the time lag of
        the record
    tuned : controller gains, which the fit does not change; default: those of the scenario, stated
        or tuned
    verify, method : as for `simulation.simulate`, for the simulation with the fitted values
    spec : hash of the scenario and its design

    Raises
    ------
    InputError
        an unknown parameter, a parameter without effect, or no overlap with the record
    Unsolvable
        the simulation fails at the initial values
    """
    begin = perf_counter()
    searched = entries(names, scenario, plant)
    gains = tune(scenario, plant, records) if tuned is None else tuned
    problem = RecordFitProblem(scenario, plant, records, gains, measured, searched)
    first = problem.lag(problem.start)
    dense = {"sample_time": problem.step}
    initial = run(scenario.model_copy(update=dense), plant, records, gains, spec=spec)
    before = overlay(initial, measured, lag=first)
    with whole("fitting"):
        x = problem.solve()
    uncertain = bounds(problem, x)
    fitted = {
        parameter.name: Fitted(
            parameter, _natural(parameter, uncertain, problem), _edge(problem, x, k)
        )
        for k, parameter in enumerate(searched)
    }
    correlations = _correlations(uncertain)
    new_scenario, new_plant = problem.put(x)
    asked = gains is not None and gains.margins is not None
    after_gains = tune(new_scenario, new_plant, records, previous=gains, with_margins=asked)
    final = run(
        new_scenario.model_copy(update=dense), new_plant, records, after_gains,
        verify=verify, method=method, spec=spec,
    )  # fmt: skip
    after = overlay(final, measured, lag=problem.lag(x))
    doubts = (
        *problem.notes,
        *_unidentified(fitted),
        *_inseparable(fitted, correlations),
        *_misfits(after, before),
        *_controller_notes(gains),
    )
    return Fit(
        new_scenario, new_plant, fitted, correlations, before, after, doubts,
        problem.runs, perf_counter() - begin,
    )  # fmt: skip


def _natural(
    fit_parameter: FitParameter, fitted_parameters: FittedParameters, problem: RecordFitProblem
) -> Parameter:
    """Convert a value of the search, which may be a logarithm, to the fitted parameter in SI.

    Confidence intervals are symmetrical in the parameter itself, not in its logarithm, because the
    effect of an air content or a leakage is proportional to its value. The interval does not extend
    below zero.
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
    """Correlations between the errors of the parameters that have a confidence interval."""
    correlations = {}
    for (i, first), (k, second) in combinations(enumerate(fitted_parameters.parameters), 2):
        size = np.sqrt(fitted_parameters.covariance[i, i] * fitted_parameters.covariance[k, k])
        if np.isfinite(size) and size > 0:
            correlations[first, second] = float(
                np.clip(fitted_parameters.covariance[i, k] / size, -1.0, 1.0)
            )
    return correlations


def _unidentified(fitted: Mapping[str, Fitted]) -> Iterator[str]:
    """Messages on parameters that the record determines poorly, with the reason."""
    for name, parameter in fitted.items():
        quantity, value, side = parameter.entry.quantity, parameter.parameter, parameter.at_bound
        if side is not None:
            low = side == "lower"
            end = parameter.entry.lower if low else parameter.entry.upper
            size = "smaller" if low else "larger"
            yield (
                f"{name} is at the {side} end of its range, {quantity.text(end)}: the record "
                f"suggests a {size} value, or the model lacks some other effect"
            )
        elif value.verdict == "identifiable":
            continue
        elif not np.isfinite(value.upper):
            yield (
                f"{name} is not identifiable: no measured channel depends on it, or its effect "
                "cannot be separated from that of other fitted parameters"
            )
        else:
            between = f"{quantity.text(value.lower, 3)} to {quantity.text(value.upper, 3)}"
            yield f"{name} is {value.verdict}: the record admits values from {between}"


def _inseparable(
    fitted: Mapping[str, Fitted], correlations: Mapping[tuple[str, str], float]
) -> Iterator[str]:
    """Messages on parameters whose effects the fit cannot separate."""
    pairs = [
        f"{first} with {second} ({value:.2f})"
        for (first, second), value in correlations.items()
        if abs(value) > ALIKE
        and not all(fitted[name].parameter.identifiable for name in (first, second))
    ]
    if pairs:
        yield (
            f"correlated errors: {', '.join(pairs)}; the record determines a combination of such a "
            "pair better than each parameter, so state one of the two, or measure a signal that "
            "separates them"
        )


def _is_missed(residual: ChannelResidual) -> bool:
    """Whether a channel that changes during the record has a residual above its noise."""
    return residual.span > 0 and residual.rms > MISFIT * residual.noise


def _misfits(after: Overlay, before: Overlay) -> Iterator[str]:
    """Messages on channels whose residuals exceed the noise."""
    misfits = []
    for name, channel in after.residuals.items():
        if not _is_missed(channel):
            continue
        quantity = after.simulation.told[name].quantity
        misfits.append(
            f"{name} {quantity.text(channel.rms, 2)}, {_times(channel.rms / channel.noise)} times "
            "its noise"
        )
        if channel.rms > WORSE * before.residuals[name].rms:
            yield f"{name} fits worse than before the fit, so the channels contradict each other"
    if misfits:
        yield shown(
            "the simulation differs from the record by more than the sensor noise "
            f"({'; '.join(misfits)}): the model lacks an effect, or the record was smoothed. This "
            "biases the parameters, and their confidence intervals do not include this bias",
            400,
        )


def _times(ratio: float) -> str:
    return f"{ratio:.2g}" if ratio < 10 else f"{ratio:.0f}"


def _controller_notes(tuned: Tuned | None) -> Iterator[str]:
    if tuned is not None and tuned.origin != "stated":
        yield (
            f"the controller's gain is not stated but comes from {tuned.origin}; state the gain "
            "of the test bench in the block control"
        )
