"""Parameters of a design from a measured record: least squares over the whole simulation."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from time import perf_counter
from typing import Any, Final

import numpy as np

from ..design.scenario.model import Scenario
from ..errors import InputError, Unsolvable
from ..evaluation.study.plant import Plant
from ..least_squares import NORMAL, Parameter, known, rated
from ..numeric import Array
from .assemble import assemble
from .gains import Tuned, tune
from .integrate import integrate
from .measured import Measured, Overlay, Residual, at, inside, noise, overlay
from .measured_parameters import PARAMETERS, Entry, entries
from .parts.signals import Records
from .run import run
from .system import Compiled

MOST: Final = 4000
"""Largest number of samples of a channel in a fit (a choice: what is denser is thinned evenly)."""
FINE: Final = 4
"""Samples of the simulation to one of the record (a choice: straight between them, a swing of ten
samples to the period loses 0.3 %)."""
RELATIVE: Final = 1e-8
"""Tolerance of an integration step: slopes are differences of two runs."""
STEP: Final = 1e-3
"""Step of a slope on the way, over a parameter's size (a choice: far above what is integrated)."""
WIDEST: Final = 0.1
"""Largest step of the last slopes, which are secants over a standard error (a choice)."""
GUESSES: Final = (1 / 3, 3.0)
"""Factors on each start that are tried before the search (a choice)."""
ROUNDS: Final = 2
"""Searches: weighted by the sensors' noise, then by what is left over where that is more."""
MISFIT: Final = 3.0
"""Residual over noise from which the model misses the record (a choice)."""
ALIKE: Final = 0.9
"""Correlation from which two parameters are named as not parted (a choice)."""
EDGE: Final = 1e-3
"""Share of a parameter's range within which it lies at its end (a choice)."""
MARGIN: Final = 0.02
"""Range about the best lag that is searched, over the simulated time (a choice)."""


@dataclass(frozen=True, slots=True)
class Fitted:
    """A fitted parameter, SI."""

    entry: Entry
    parameter: Parameter
    edge: str
    """The end of its range at which it lies: "lower", "upper" or none."""

    def to_dict(self) -> dict[str, Any]:
        """As plain data for JSON, SI."""
        quantity = self.entry.quantity
        return {
            "label": quantity.label,
            "unit": quantity.si_unit,
            "start": self.entry.start,
            **self.parameter.to_dict(),
            "at_bound": self.edge or None,
        }


@dataclass(frozen=True, slots=True)
class Fit:
    """Parameters that bring a simulation to a record.

    Parameters
    ----------
    scenario, plant : with the parameters put in
    parameters : by name
    correlations : of the parameters' errors, pairs of known ones
    before, after : the record over the simulation with the first and the fitted values
    doubts : what the numbers alone do not say
    runs, seconds : what it took
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
    def values(self) -> dict[str, float]:
        """Fitted values by name, SI."""
        return {name: one.parameter.value for name, one in self.parameters.items()}

    def to_dict(self) -> dict[str, Any]:
        """As plain data for JSON, SI."""
        return {
            "record": self.after.measured.name,
            "parameters": {name: one.to_dict() for name, one in self.parameters.items()},
            "correlations": [
                {"between": list(pair), "value": value}
                for pair, value in self.correlations.items()
            ],
            "before": self.before.to_dict(),
            "after": self.after.to_dict(),
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
) -> Fit:
    """Fit named parameters of a design or scenario to a measured record.

    Least squares over all channels, each weighted by the noise of its sensor (`measured.noise`),
    then by what is left over where the model misses it by more. Bounds of 95 % count residuals that
    hang together over time.

    Parameters
    ----------
    scenario, plant : what was measured, as far as known
    records : columns of the files that the scenario's signals name
    measured : on the scenario's time
    names : of `measured_parameters.PARAMETERS`, and "lag"
    tuned : gains of the controller, which the fit leaves alone; default: as the scenario says

    Raises
    ------
    InputError
        no such parameter, one without effect, nothing in common with the record
    Unsolvable
        where the simulation cannot go on with the values it begins with
    """
    begin = perf_counter()
    own = entries(names, scenario, plant)
    gains = tune(scenario, plant, records) if tuned is None else tuned
    before = overlay(run(scenario, plant, records, gains), measured)
    problem = Problem(scenario, plant, records, measured, own, gains)
    x = problem.solve()
    fitted, correlations = problem.bounded(x)
    final_scenario, final_plant = problem.put(x)
    final = run(final_scenario, final_plant, records, gains)
    after = overlay(final, measured, lag=problem.lag(x))
    doubts = (*_doubts(fitted, correlations, after.residuals), *_tuned(gains))
    return Fit(
        final_scenario, final_plant, fitted, correlations, before, after, doubts,
        problem.runs, perf_counter() - begin,
    )  # fmt: skip


class Problem:
    """Weighted residuals of a record over the searched parameters.

    Searched are the logarithms of positive parameters, over the start; signed ones over their size.
    """

    def __init__(
        self,
        scenario: Scenario,
        plant: Plant,
        records: Records,
        measured: Measured,
        own: Sequence[Entry],
        tuned: Tuned | None,
    ) -> None:
        self.scenario, self.plant, self.records, self.tuned = scenario, plant, records, tuned
        self.own, self.measured = tuple(own), measured
        self.names = tuple(one.name for one in own)
        self.runs = 0
        self._last: tuple[bytes, Mapping[str, Array], Array] | None = None
        self.sizes = np.array([1.0 if one.positive else one.upper for one in own])
        logs = [(one, np.log) if one.positive else (one, float) for one in own]
        self.start = np.array([to(one.start) for one, to in logs])
        self.low = np.array([to(one.lower) for one, to in logs])
        self.high = np.array([to(one.upper) for one, to in logs])
        steps = [float(np.median(np.diff(t))) for t, _ in measured.channels.values()]
        asked = min(steps) / FINE
        duration = scenario.duration
        self.step = min(max(asked, duration / (FINE * MOST)), duration / MOST)
        time, signals = self._simulated(self.start, needed=True)
        used = inside(measured, signals, float(time[-1]), 0.0)
        self.noise = {name: noise(y) for name, (_, y) in used.items()}
        self.scale = dict(self.noise)
        self.used = {name: _thin(*one) for name, one in used.items()}
