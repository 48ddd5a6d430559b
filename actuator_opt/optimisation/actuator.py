"""The actuator as an optimisation problem: variables by PATH, one margin per limit, case, place."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from ..base.errors import Diagnostic, InputError
from ..base.numeric import Array, real, where
from ..base.quantities import Sense
from ..evaluation import PreparedDesign, compute
from ..evaluation.governing import extreme, worst_of
from ..evaluation.limits import all_limits, margin
from ..evaluation.rows import UNLIMITED, LimitRow, MetricArrays, rows_of
from ..evaluation.values import Values as Numbers
from .problem import BoxProblem, ParametricProblem, Values

Fault = Callable[[str, str, str], Diagnostic]
"""Builds the Diagnostic of a variable at its place in the file, from path, message and remedy."""


@dataclass(frozen=True, slots=True)
class Goal:
    """The objective: weighted metrics, each divided by its scale; sign −1 maximises."""

    weights: Mapping[str, float]
    scales: Mapping[str, float]
    sign: float

    @property
    def aim(self) -> Sense:
        """Whether the metrics are minimised or maximised."""
        return "min" if self.sign > 0 else "max"

    @property
    def single(self) -> str | None:
        """The metric of an objective with only one, else None."""
        return next(iter(self.weights)) if len(self.weights) == 1 else None

    def value(self, computed: MetricArrays, cases: tuple[str, ...]) -> Array:
        """The objective of every design, to be minimised."""
        total: Array = 0.0
        for metric, weight in self.weights.items():
            worst = worst_value(computed, metric, cases, self.aim)
            total = total + weight / self.scales[metric] * worst
        return self.sign * total

    def shown(self, objective: float) -> float:
        """The objective as the user states it (a maximised metric with its own sign)."""
        return self.sign * objective


def worst_value(computed: MetricArrays, metric: str, cases: tuple[str, ...], aim: Sense) -> Array:
    """The worst value of an objective over load cases and places, (designs,).

    Raises
    ------
    InputError
        the metric is not computed
    """
    worst = extreme(computed, metric, cases, worst_of(aim))
    if worst is None:
        reason = computed.why.get(metric, "it does not apply to this design")
        raise InputError(
            Diagnostic(
                f"{metric} cannot be an objective here: {reason}",
                "choose a metric that `actuator-opt evaluate` lists with a value",
                path="objective",
            )
        )
    return worst


def goal_of(subject: PreparedDesign) -> Goal:
    """The objective of a design; weighted metrics are divided by their present value."""
    objective = subject.design.objective
    sign = 1.0 if objective.aim == "min" else -1.0
    stated = objective.minimise if objective.minimise is not None else objective.maximise
    assert stated is not None
    if isinstance(stated, str):
        return Goal({stated: 1.0}, {stated: 1.0}, sign)
    done = compute(subject, subject.values())
    scales = {}
    for metric in stated:
        present = worst_value(done.computed, metric, subject.cases, objective.aim)
        scales[metric] = abs(float(np.squeeze(present))) or 1.0
    return Goal(dict(stated), scales, sign)


@dataclass
class Refusals:
    """Counts points where the user's own metrics gave no value although the mass models did."""

    names: frozenset[str] = frozenset()
    points: int = 0
    missing: dict[str, int] = field(default_factory=dict)
    raised: dict[str, str] = field(default_factory=dict)

    def add(self, computed: MetricArrays, count: int) -> None:
        """Count one evaluation."""
        self.points += count
        sound = np.isfinite(np.broadcast_to(computed.metrics["mass"][""], (count,)))
        for name in self.names:
            value = np.atleast_2d(computed.metrics[name][""])
            lost = int((sound & np.isnan(value).any(axis=0)).sum())
            self.missing[name] = self.missing.get(name, 0) + lost
            if name in computed.why:
                self.raised.setdefault(name, computed.why[name])

    def warnings(self) -> tuple[str, ...]:
        """The warnings, one line for each metric that was missing somewhere."""
        return tuple(
            f"{name} gave no value at {100 * lost / self.points:.3g} % of the points tried, "
            "which count as infeasible" + (f": {self.raised[name]}" if name in self.raised else "")
            for name, lost in sorted(self.missing.items())
            if lost
        )


@dataclass(frozen=True)
class ActuatorProblem:
    """A design with variables as a problem of the generic solver, and the way back."""

    subject: PreparedDesign
    goal: Goal
    paths: tuple[str, ...]
    rows: tuple[LimitRow, ...]
    fixed: tuple[LimitRow, ...]
    """Rows that no variable changes: always met, or always missed."""
    problem: BoxProblem
    wanted: frozenset[str] | None
    """Metrics of objective and rows; None where a custom metric may read any of them."""
    refusals: Refusals = field(default_factory=Refusals)
    """Points where custom metrics had no value."""

    def parametric(self, parameters: tuple[str, ...]) -> ParametricProblem:
        """The same problem, with the numbers at `parameters` to be priced."""

        def evaluate(points: Array, values: Array) -> Values:
            varied = dict(zip(parameters, values, strict=True))
            return self.evaluate(points, varied)

        present = np.array([self.subject.numbers[path] for path in parameters])
        return ParametricProblem(self.problem, parameters, present, evaluate)

    def evaluate(
        self,
        points: Array,
        parameters: Mapping[str, Array] | None = None,
        seen: list[MetricArrays] | None = None,
    ) -> Values:
        """Objective and constraint margins of points (variables, designs).

        Adds the computed metrics to `seen`.
        """
        varied = dict(parameters or {}) | dict(zip(self.paths, points, strict=True))
        numbers = self.subject.values(varied)
        count = points.shape[1]
        done = compute(self.subject, numbers, self.wanted)
        if seen is not None:
            seen.append(done.computed)
        if self.refusals.names and not any(np.iscomplexobj(v) for v in varied.values()):
            self.refusals.add(done.computed, count)
        return Values(
            self.goal.value(done.computed, self.subject.cases),
            _margins(self.rows, done.computed, numbers, count, self.subject.reserves),
        )


def _bounded(margin: Array) -> Array:
    """A margin scaled for the solver: m below 0, m/(1 + m) above, so that infinity is 1.

    Keeps the sign, and both value and slope where the limit is just met.
    """
    large = real(margin) > 1e9
    held = where(large, 0.0, margin)
    inside = where(real(held) > 0, held / (1 + where(real(held) > 0, held, 0.0)), held)
    return where(large, 1.0, inside)


def _margins(
    wanted: tuple[LimitRow, ...],
    computed: MetricArrays,
    numbers: Numbers,
    count: int,
    reserves: Mapping[str, float],
) -> Array:
    """Margins of the wanted rows less their reserves (rows, designs), all in one pass."""
    if not wanted:
        return np.empty((0, count))
    complex_ = any(np.iscomplexobj(value) for value in numbers.varied.values())
    value = np.empty((len(wanted), count), dtype=complex if complex_ else float)
    bounds = [row.limit_of.value(numbers) for row in wanted]
    width = max(getattr(bound, "size", 1) for bound in bounds)
    bound = np.empty((len(wanted), width), dtype=value.dtype)
    for i, row in enumerate(wanted):
        array = computed.metrics[row.limit_of.metric][row.place]
        if row.case_index is not None:
            array = array[row.case_index]
        value[i], bound[i] = array, bounds[i]
    value = where(real(value) == np.inf, UNLIMITED, value)
    sign = np.array([[1.0 if row.limit_of.sense == "min" else -1.0] for row in wanted])
    beyond = sign * margin(value, bound, "min")
    if reserves:
        beyond = beyond - np.array([[reserves.get(row.limit_of.name, 0.0)] for row in wanted])
    return _bounded(beyond)


@np.errstate(all="ignore")  # the solver handles values that are not finite
def build(subject: PreparedDesign, fault: Fault | None = None) -> ActuatorProblem:
    """Build the optimisation problem of a design.

    Parameters
    ----------
    subject : the prepared design
    fault : locates a variable's fault in the file; default: by PATH only

    Raises
    ------
    InputError
        no variables, or a variable that no model reads
    """
    design = subject.design
    if not design.variables:
        raise InputError(
            Diagnostic(
                "the design has no variables, so nothing can be optimised",
                "add a `variables` block with lower and upper bounds",
                path="variables",
            )
        )
    paths = tuple(design.variables)
    lower = np.array([design.variables[path].lower for path in paths], dtype=float)
    upper = np.array([design.variables[path].upper for path in paths], dtype=float)
    start = np.array(
        [
            subject.numbers[path] if variable.start is None else variable.start
            for path, variable in design.variables.items()
        ],
        dtype=float,
    )
    goal = goal_of(subject)
    limits = tuple(
        limit for limit in all_limits(subject.design, subject.plugins) if limit.origin != "advice"
    )
    numbers = subject.values({path: np.array([v, v]) for path, v in zip(paths, start, strict=True)})
    done = compute(subject, numbers)
    goal.value(done.computed, subject.cases)
    everything = [row for limit in limits for row in rows_of(limit, done.computed, numbers)]
    _check_read(numbers, paths, fault)
    rows = tuple(row for row in everything if np.size(row.margin) > 1)
    fixed = tuple(row for row in everything if np.size(row.margin) == 1)
    missed = [  # a check that no variable can fix is reported, but does not constrain the search
        row
        for row in fixed
        if row.limit_of.origin != "check"
        and not float(row.margin[0]) - subject.reserves.get(row.limit_of.name, 0.0) >= -1e-6
    ]
    rows += tuple(missed)
    holder: list[ActuatorProblem] = []
    problem = BoxProblem(
        names=paths,
        lower=lower,
        upper=upper,
        evaluate=lambda points: holder[0].evaluate(points),
        constraint_names=tuple(row.label for row in rows),
        start=start,
        relaxable=tuple(row.limit_of.origin != "geometry" for row in rows),
        groups=tuple(limits.index(row.limit_of) for row in rows),
    )
    wanted = frozenset({row.limit_of.metric for row in rows} | set(goal.weights))
    own = {plugin.name for plugin in subject.plugins}
    refusals, lenient = Refusals(wanted & own), replace(subject, lenient=True)
    asked = None if own else wanted
    holder.append(ActuatorProblem(lenient, goal, paths, rows, fixed, problem, asked, refusals))
    return holder[0]


def idle_metrics(actuator: ActuatorProblem) -> tuple[str, ...]:
    """Metrics of the objective that no variable affects at all."""
    start = actuator.problem.start
    assert start is not None
    moved = {path: np.array([x, x]) for path, x in zip(actuator.paths, start, strict=True)}
    subject, goal = actuator.subject, actuator.goal
    found = compute(subject, subject.values(moved)).computed
    values = {name: worst_value(found, name, subject.cases, goal.aim) for name in goal.weights}
    return tuple(
        name for name, value in values.items() if np.size(value) == 1 and np.isfinite(value).all()
    )


def require_movable_objective(actuator: ActuatorProblem) -> None:
    """Reject an objective that no variable affects.

    Raises
    ------
    InputError
        no variable affects it
    """
    goal = actuator.goal
    if len(idle_metrics(actuator)) == len(goal.weights):
        raise InputError(
            Diagnostic(
                f"no variable affects {' and '.join(goal.weights)}: nothing to optimise",
                "choose another objective, or free a dimension that it depends on",
                path="objective",
            )
        )


def _check_read(numbers: Numbers, paths: tuple[str, ...], fault: Fault | None) -> None:
    """Reject a variable that no model reads."""
    faults = []
    for path in paths:
        if path not in numbers.read:
            message = "no model of this design reads this variable"
            remedy = "remove it, or check that the design uses the part it belongs to"
            place = fault(path, message, remedy) if fault else None
            faults.append(place or Diagnostic(message, remedy, path=f"variables.{path}"))
    if faults:
        raise InputError(faults)
