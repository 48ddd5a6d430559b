"""Fit parameters of a design to a measured record: least squares over whole simulations."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from time import perf_counter
from typing import Any, Final, Literal

import numpy as np

from ...base.errors import shown
from ...base.fitting import WEAK, Known, Parameter, rated
from ...base.numeric import Array
from ...base.progress import whole
from ...design.scenario.model import Scenario
from ...studies.plant import Plant
from ..components.signals import Records
from ..linear import Tuned, tune
from ..methods import Method
from ..run import run
from .bounds import bounds
from .parameters import Entry, entries
from .problem import RecordFitProblem
from .record import Measured, Overlay, overlay

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

    entry: Entry
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
    measured: Measured,
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


def _natural(one: Entry, told: Known, problem: RecordFitProblem) -> Parameter:
    """A parameter in its own unit from the searched value.

    Bounds apply to the parameter itself, not to its logarithm, as the effect of an air content or a
    leakage is proportional. None is below zero.
    """
    x = told.parameters[one.name]
    half = x.upper - x.value
    if not one.positive:
        near = one.near or float(problem.sizes[problem.names.index(one.name)])
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


def _correlations(told: Known) -> dict[tuple[str, str], float]:
    """Correlations between the errors of bounded parameters."""
    found = {}
    for (i, one), (k, other) in combinations(enumerate(told.parameters), 2):
        size = np.sqrt(told.covariance[i, i] * told.covariance[k, k])
        if np.isfinite(size) and size > 0:
            found[one, other] = float(np.clip(told.covariance[i, k] / size, -1.0, 1.0))
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
