"""The actuator as an optimisation problem, and how its results change with parameters.

The variables are the design's free numbers, named by PATH. Each limit gives one margin per load
case and location. A parameter is a fixed number of the design or a bound of a variable. The
derivatives of objective and margins with respect to a parameter use the complex step. The
derivatives of the gradients of objective and margins use central differences of complex-step
gradients. Where the complex step disagrees with a finite difference (as in a look-up table), the
finite difference is used.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field, replace
from typing import Any

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError
from ..base.numeric import STEP, Array, namespace, real, where
from ..base.quantities import Sense
from ..base.symbolic.recorded import RecordedFunction
from ..design import with_values
from ..design.choice_list import of_one_combination
from ..design.material import Material
from ..design.materials import Library
from ..evaluation import PreparedDesign, compute, prepare
from ..evaluation.build import names_of_materials
from ..evaluation.kernel import extreme, worst_of
from ..evaluation.limits import (
    UNLIMITED,
    LimitRow,
    MetricArrays,
    MetricLimit,
    all_limits,
    fixed_when_prepared,
    margin,
    rows_of,
)
from ..evaluation.recorded_models import recorded_models
from ..evaluation.values import Values as Numbers
from .evaluator import Evaluator, Point
from .problem import BoxProblem, ParametricProblem, PointValues, Vector

Fault = Callable[[str, str, str], Diagnostic]
"""Function that builds the Diagnostic for a faulty variable, with the variable's line in the file.
Its arguments are PATH, message and remedy."""


def variant(subject: PreparedDesign, values: Mapping[str, Any], library: Library) -> PreparedDesign:
    """Prepare the design with some values replaced; materials new to it come from the library.

    Keys and variables that the joints of these values do not use are left out.
    `values` maps each PATH, such as "barrel.bore", to its new value.

    Raises
    ------
    InputError
        the values contradict the design or each other
    """
    design = of_one_combination(
        with_values(subject.design, dict(values), materials=library, metrics=subject.quantities)
    )
    names = names_of_materials(design)
    materials: dict[str, Material] = {
        name: subject.materials.get(name) or library.get(name) for name in names
    }
    return prepare(design, materials, subject.plugins)


@dataclass(frozen=True, slots=True)
class Goal:
    """The objective: a weighted sum of metrics, each divided by its scale; sign −1 maximises."""

    weights: Mapping[str, float]
    scales: Mapping[str, float]
    sign: float

    @property
    def aim(self) -> Sense:
        """Sense of the objective: "min" or "max"."""
        return "min" if self.sign > 0 else "max"

    @property
    def single(self) -> str | None:
        """The metric, if the objective consists of a single metric; else None."""
        return next(iter(self.weights)) if len(self.weights) == 1 else None

    def value(self, computed: MetricArrays, cases: tuple[str, ...]) -> Array:
        """The objective of every design; a maximised objective has its sign changed."""
        total: Array = 0.0
        for metric, weight in self.weights.items():
            value = worst_value(computed, metric, cases, self.aim)
            total = total + weight / self.scales[metric] * value
        return self.sign * total

    def shown(self, objective: float) -> float:
        """The objective with its true sign, from the value that the solver minimises."""
        return self.sign * objective


def worst_value(computed: MetricArrays, metric: str, cases: tuple[str, ...], aim: Sense) -> Array:
    """The worst value of a metric over load cases and locations, for each design (designs,).

    Raises
    ------
    InputError
        the metric is not computed
    """
    value = extreme(computed, metric, cases, worst_of(aim))
    if value is None:
        reason = computed.why.get(metric, "it does not apply to this design")
        raise InputError(
            Diagnostic(
                f"{metric} cannot be an objective here: {reason}",
                "choose a metric that `actuator-opt evaluate` lists with a value",
                path="objective",
            )
        )
    return value


def goal_of(subject: PreparedDesign) -> Goal:
    """The objective of a design file.

    A weighted sum divides each metric by the value that it has at the design of the file.
    """
    objective = subject.design.objective
    sign = 1.0 if objective.aim == "min" else -1.0
    weights = objective.minimise if objective.minimise is not None else objective.maximise
    assert weights is not None
    if isinstance(weights, str):
        return Goal({weights: 1.0}, {weights: 1.0}, sign)
    run = compute(subject, subject.values())
    scales = {}
    for metric in weights:
        present = worst_value(run.computed, metric, subject.cases, objective.aim)
        scales[metric] = abs(float(np.squeeze(present))) or 1.0
    return Goal(dict(weights), scales, sign)


@dataclass
class Refusals:
    """Counts designs for which a custom metric has no value but the built-in models have results.

    The built-in models count as having results if they compute a mass for the design.
    """

    names: frozenset[str] = frozenset()
    points: int = 0
    missing: dict[str, int] = field(default_factory=dict)
    raised: dict[str, str] = field(default_factory=dict)

    def add(self, computed: MetricArrays, count: int) -> None:
        """Add one evaluation of `count` designs, and count those at which a metric has no value."""
        self.points += count
        sound = np.isfinite(np.broadcast_to(computed.metrics["mass"][""], (count,)))
        for name in self.names:
            value = np.atleast_2d(computed.metrics[name][""])
            lost = int((sound & np.isnan(value).any(axis=0)).sum())
            self.missing[name] = self.missing.get(name, 0) + lost
            if name in computed.why:
                self.raised.setdefault(name, computed.why[name])

    def warnings(self) -> tuple[str, ...]:
        """One warning for each metric that had no value at some design."""
        return tuple(
            f"{name} had no value at {100 * lost / self.points:.3g} % of the points tried; "
            "these points count as infeasible"
            + (f": {self.raised[name]}" if name in self.raised else "")
            for name, lost in sorted(self.missing.items())
            if lost
        )


@dataclass(frozen=True)
class ActuatorProblem:
    """A design with free variables, formulated as a problem for the generic solver."""

    subject: PreparedDesign
    goal: Goal
    paths: tuple[str, ...]
    rows: tuple[LimitRow, ...]
    fixed: tuple[LimitRow, ...]
    """Limits that no variable affects: they are met by every design or by none."""
    problem: BoxProblem
    metrics: frozenset[str] | None
    """Names of the metrics that objective and limits require; None (compute all) if a custom metric
    may read any metric."""
    refusals: Refusals = field(default_factory=Refusals)
    """Counts the designs where a custom metric has no value."""
    goals: tuple[Goal, ...] = ()
    """Objectives of a Pareto front, in addition to `goal`."""
    recorded: RecordedFunction | None = None
    """Objective and margins as a function recorded from the models; its inputs are the variables
    and all positive numbers of the design. None with custom metrics, whose code may do anything."""
    scales: tuple[float, ...] = ()
    """Divisor of each margin while its limit is 0; empty if all are 1."""
    read: frozenset[str] = frozenset()
    """PATHs of all numbers that the models read."""

    def parametric(self, parameters: tuple[str, ...]) -> ParametricProblem:
        """The problem with the design's numbers at the PATHs `parameters` as its parameters."""

        def evaluate(points: Array, values: Array) -> PointValues:
            varied = dict(zip(parameters, values, strict=True))
            return self.evaluate(points, varied)

        present = np.array([self.subject.numbers[path] for path in parameters])
        return ParametricProblem(self.problem, parameters, present, evaluate)

    def fixed_numbers(self, x: Vector) -> list[str]:
        """PATHs of the positive fixed numbers that the models read at the point x (n,).

        Numbers that change the knock-downs of strengths, such as temperatures, are left out: a
        prepared design keeps its knock-downs.
        """
        values = self.subject.values(dict(zip(self.paths, x[:, None], strict=True)))
        self.subject.touch(values)
        return [
            path
            for path in sorted(values.read)
            if path not in self.paths
            and self.subject.numbers.get(path, 0.0) > 0
            and not fixed_when_prepared(path)
        ]

    def number_steps(self, x: Vector, paths: Sequence[str]) -> PointValues:
        """Objective and margins at x (n,), with a complex step in each of the `paths` in turn."""
        present = np.array([self.subject.numbers[path] for path in paths])
        varied = np.repeat(present[:, None].astype(complex), len(paths), axis=1)
        varied += np.diag(1j * STEP * present)
        points = np.repeat(x[:, None], len(paths), axis=1)
        return self.evaluate(points, dict(zip(paths, varied, strict=True)))

    def evaluate(
        self,
        points: Array,
        parameters: Mapping[str, Array] | None = None,
    ) -> PointValues:
        """Objective and constraint margins at points (variables, designs)."""
        objectives, constraints = self._evaluated(points, parameters or {})
        return PointValues(objectives[0], constraints)

    def trade(self, points: Array) -> PointValues:
        """The list of all `goals`, and the margins, at points (variables, designs)."""
        objectives, constraints = self._evaluated(points, {})
        return PointValues(list(objectives[1:]), constraints)

    def _evaluated(
        self, points: Array, parameters: Mapping[str, Array]
    ) -> tuple[Sequence[Array], Array]:
        recorded = self.recorded
        if recorded is None or not parameters.keys() <= set(recorded.names):
            return self.values_by_models(points, parameters)
        rows, count = recorded(self._inputs(points, parameters)), 1 + len(self.goals)
        return rows[:count], rows[count:]

    @property
    def models_run_by(self) -> str:
        """Engine of most evaluations: the compiled program of the recorded models, or NumPy."""
        recorded = self.recorded is not None and self.recorded.recording is not None
        return "compiled program" if recorded else "NumPy"

    def confirmed(self, x: Array) -> bool:
        """Whether the recorded models agree with the models themselves at points (n,) or (n, k)."""
        if self.recorded is None:
            return True
        with np.errstate(all="ignore"):
            return self.recorded.confirmed(self._inputs(x.reshape(len(x), -1), {}))

    def _inputs(self, points: Array, parameters: Mapping[str, Array]) -> Array:
        """All inputs of the recorded function (inputs, designs)."""
        assert self.recorded is not None
        kind = np.result_type(points, *parameters.values()) if parameters else points.dtype
        inputs = np.empty((len(self.recorded.names), points.shape[1]), dtype=kind)
        inputs[: len(self.paths)] = points
        inputs[len(self.paths) :] = self.recorded.present[len(self.paths) :, None]
        for path, value in parameters.items():
            inputs[self.recorded.names.index(path)] = value
        return inputs

    def by_models(self, points: Array, parameters: Mapping[str, Array]) -> PointValues:
        """Like `evaluate`, but by the models themselves instead of the recorded function."""
        objectives, constraints = self.values_by_models(points, parameters)
        return PointValues(objectives[0], constraints)

    def values_by_models(
        self, points: Array, parameters: Mapping[str, Array]
    ) -> tuple[Sequence[Array], Array]:
        """The objective, all `goals`, and the margins, by the models themselves."""
        varied = dict(parameters) | dict(zip(self.paths, points, strict=True))
        numbers = self.subject.values(varied)
        count = points.shape[1]
        run = compute(self.subject, numbers, self.metrics)
        if self.refusals.names and not any(np.iscomplexobj(v) for v in varied.values()):
            self.refusals.add(run.computed, count)
        values = margins(self.rows, run.computed, numbers, count, self.subject.reserves)
        if self.scales:
            values = values / self._divisors(numbers)
        goals = (self.goal, *self.goals)
        return [goal.value(run.computed, self.subject.cases) for goal in goals], bounded_margin(
            values
        )

    def _divisors(self, numbers: Numbers) -> Array:
        """Divisors (rows, 1 or designs) of the margins: `scales` where the limit is 0, else 1."""
        bounds = [row.limit_of.value(numbers) for row in self.rows]
        width = max(getattr(bound, "size", 1) for bound in bounds)
        zero = real(_stacked(bounds, width)) == 0
        return where(zero, np.array(self.scales)[:, None], 1.0)


def _scales(rows: Sequence[LimitRow]) -> tuple[float, ...]:
    """Size of each margin of a limit of 0: its value at the start, if this is above 1 in SI.

    Such a margin is the value itself. As 1e7 N/m it would outweigh the relative margins of all
    other limits in the solver, whose tolerances would lie below its rounding error.
    """
    scales = []
    for row in rows:
        size = abs(float(np.real(row.margin[0])))
        zero = not np.any(real(row.limit))
        scales.append(size if zero and 1 < size < UNLIMITED else 1.0)
    return tuple(scales) if any(scale > 1 for scale in scales) else ()


def bounded_margin(margin: Array) -> Array:
    """Compress a positive margin m to m/(1 + m) for the solver, so that infinity becomes 1.

    A negative margin stays as it is. Sign, and value and slope at m = 0, do not change.
    """
    large = real(margin) > 1e9
    finite = where(large, 0.0, margin)
    bounded = where(real(finite) > 0, finite / (1 + where(real(finite) > 0, finite, 0.0)), finite)
    return where(large, 1.0, bounded)


def margins(
    rows: tuple[LimitRow, ...],
    computed: MetricArrays,
    numbers: Numbers,
    count: int,
    reserves: Mapping[str, float],
) -> Array:
    """Margins (rows, designs) of all limits, in one vectorised operation.

    From each margin its reserve is subtracted: an additional margin required because of scatter.
    Infinite values (a part without load) count as `UNLIMITED`.
    """
    if not rows:
        return np.empty((0, count))
    values, bounds = [], [row.limit_of.value(numbers) for row in rows]
    for row in rows:
        array = computed.metrics[row.limit_of.metric][row.place]
        values.append(array if row.case_index is None else array[row.case_index])
    width = max(getattr(bound, "size", 1) for bound in bounds)
    value, bound = _stacked(values, count), _stacked(bounds, width)
    value = where(real(value) == np.inf, UNLIMITED, value)
    sign = np.array([[1.0 if row.limit_of.sense == "min" else -1.0] for row in rows])
    relative = sign * margin(value, bound, "min")
    if reserves:
        relative = relative - np.array([[reserves.get(row.limit_of.name, 0.0)] for row in rows])
    return relative


def _stacked(values: Sequence[Array], width: int) -> Array:
    """The values as rows of an array (values, designs); faster than `stack` for NumPy's arrays."""
    xp = namespace(*values)
    if xp is not np:
        return xp.stack([xp.broadcast_to(xp.asarray(value), (width,)) for value in values])
    stepped = any(np.iscomplexobj(value) for value in values)
    result = np.empty((len(values), width), dtype=complex if stepped else float)
    for k, value in enumerate(values):
        result[k] = value
    return result


@np.errstate(all="ignore")  # the solver handles values that are not finite
def build(
    subject: PreparedDesign, fault: Fault | None = None, goals: tuple[Goal, ...] = ()
) -> ActuatorProblem:
    """Build the optimisation problem of a design.

    Of a design that lists types of joint under `choices`, it is that of the stated type.

    Parameters
    ----------
    subject : the prepared design
    fault : builds the Diagnostic of a faulty variable; by default, the Diagnostic states the PATH
        but not the line in the file

    Raises
    ------
    InputError
        the design has no variables, or a variable that no model reads
    """
    if subject.design.choices:
        subject = replace(subject, design=of_one_combination(subject.design))
    subject = replace(subject, windows=True)
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
    run = compute(subject, numbers)
    goal.value(run.computed, subject.cases)
    all_rows = [row for limit in limits for row in rows_of(limit, run.computed, numbers)]
    _check_read(numbers, paths, fault)
    rows, fixed = _rows_of_search(all_rows, subject.reserves)
    holder: list[ActuatorProblem] = []
    problem = BoxProblem(
        names=paths,
        lower=lower,
        upper=upper,
        evaluate=lambda points: holder[0].evaluate(points),
        constraint_names=tuple(row.label for row in rows),
        start=start,
        relaxable=tuple(row.limit_of.origin != "geometry" for row in rows),
        groups=_groups(limits, rows),
    )
    metrics = frozenset({row.limit_of.metric for row in rows} | set(goal.weights))
    plugin_names = {plugin.name for plugin in subject.plugins}
    refusals, lenient = Refusals(metrics & plugin_names), replace(subject, lenient=True)
    required = None if plugin_names else metrics
    actuator = ActuatorProblem(
        lenient, goal, paths, rows, fixed, problem, required, refusals, goals,
        scales=_scales(rows), read=frozenset(numbers.read),
    )  # fmt: skip
    if not plugin_names:
        actuator = _recording(actuator)
    holder.append(actuator)
    return holder[0]


def renumbered(actuator: ActuatorProblem, subject: PreparedDesign) -> ActuatorProblem | None:
    """The problem of a design with the same structure but other numbers, without running models.

    The numbers must leave all limits that no variable affects as they are, which only `build`
    finds out. The result is None if the recording does not serve the new numbers: other words,
    variables or zeros, a weighted objective, custom metrics, duty cycles or tables of oil films.
    """
    own, recorded = actuator.subject, actuator.recorded
    other = subject.design.variables != own.design.variables or subject.design.duty is not None
    if recorded is None or recorded.recording is None or other or actuator.goal.single is None:
        return None
    holder: list[ActuatorProblem] = []
    problem = replace(actuator.problem, evaluate=lambda points: holder[0].evaluate(points))
    subject = replace(subject, windows=True, lenient=True)
    changed = _recording(replace(actuator, subject=subject, problem=problem, refusals=Refusals()))
    assert changed.recorded is not None
    if own.films or changed.recorded.structure != recorded.structure:
        return None
    changed.recorded.recording = recorded.recording
    holder.append(changed)
    return changed


def _rows_of_search(
    rows: Sequence[LimitRow], reserves: Mapping[str, float]
) -> tuple[tuple[LimitRow, ...], tuple[LimitRow, ...]]:
    """Rows that constrain the search, and all rows that no variable affects.

    A missed row that no variable affects makes the search infeasible, unless it is a check, which
    is only reported.
    """
    movable = [row for row in rows if np.size(row.margin) > 1]
    fixed = tuple(row for row in rows if np.size(row.margin) == 1)
    missed = [
        row
        for row in fixed
        if row.limit_of.origin != "check"
        and not float(row.margin[0]) - reserves.get(row.limit_of.name, 0.0) >= -1e-6
    ]
    return (*movable, *missed), fixed


def _groups(limits: Sequence[MetricLimit], rows: Sequence[LimitRow]) -> tuple[int, ...]:
    """Index of the limit of every row."""
    place = {id(limit): k for k, limit in enumerate(limits)}
    return tuple(place[id(row.limit_of)] for row in rows)


def _recording(actuator: ActuatorProblem) -> ActuatorProblem:
    """The problem with `recorded`."""
    goals = [(goal.weights, goal.scales, goal.sign) for goal in (actuator.goal, *actuator.goals)]
    recorded = recorded_models(
        lambda subject, points, varied: replace(actuator, subject=subject).values_by_models(
            points, varied
        ),
        subject=actuator.subject,
        paths=actuator.paths,
        read=actuator.read,
        limits=actuator.rows,
        goals=[
            sorted(actuator.metrics or ()),
            goals,
            *([actuator.scales] if actuator.scales else ()),
        ],
    )
    return replace(actuator, recorded=recorded)


def idle_metrics(actuator: ActuatorProblem) -> tuple[str, ...]:
    """Metrics of the objective that no variable changes."""
    start = actuator.problem.start
    assert start is not None
    points = {path: np.array([x, x]) for path, x in zip(actuator.paths, start, strict=True)}
    subject, goal = actuator.subject, actuator.goal
    computed = compute(subject, subject.values(points)).computed
    values = {name: worst_value(computed, name, subject.cases, goal.aim) for name in goal.weights}
    return tuple(
        name for name, value in values.items() if np.size(value) == 1 and np.isfinite(value).all()
    )


def require_movable_objective(actuator: ActuatorProblem) -> None:
    """Reject an objective that no variable changes.

    Raises
    ------
    InputError
        no variable changes the objective
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
            message = "no model of this design uses this variable"
            remedy = "remove the variable, or add the part of the design to which it belongs"
            place = fault(path, message, remedy) if fault else None
            faults.append(place or Diagnostic(message, remedy, path=f"variables.{path}"))
    if faults:
        raise InputError(faults)


RELATIVE_STEP = 1e-5
"""Step of central differences: a share of the parameter, or absolute for a parameter of 0."""


@dataclass(frozen=True)
class Responses:
    """Derivatives at one point with respect to q parameters, which include bounds of variables.

    nf is the number of free variables.

    Parameters
    ----------
    names, values : names and values of the parameters
    rows : (rows, q), derivatives of objective, constraints and equalities
    mixed : (nf, q), derivatives of the Lagrangian's gradient
    bounds : (2 nf, q), derivatives of the variables' distances to all lower, then to all upper
        bounds
    differences : labels of parameters whose derivatives are finite differences
    """

    names: tuple[str, ...]
    values: Vector
    rows: Vector
    mixed: Vector
    bounds: Vector
    differences: tuple[str, ...]

    def matters(self, k: int) -> bool:
        """Whether any result changes with parameter k."""
        return bool(self.rows[:, k].any() or self.bounds[:, k].any())


def responses(
    parametric: ParametricProblem, evaluator: Evaluator, point: Point, weights: Vector
) -> Responses:
    """Derivatives of all results with respect to the parameters.

    `weights` (rows,) are the factors of objective, constraints and equalities in the Lagrangian.
    """
    count, nf = len(parametric.parameters), evaluator.space.size
    steps = RELATIVE_STEP * np.where(parametric.parameters == 0, 1.0, parametric.parameters)
    rows, fallen = _row_slopes(parametric, point, steps)
    mixed = _mixed(parametric, evaluator, point, weights, steps)
    return Responses(
        tuple(parametric.parameter_names),
        parametric.parameters,
        rows,
        mixed,
        np.zeros((2 * nf, count)),
        fallen,
    )


def with_bounds(derivatives: Responses, evaluator: Evaluator, multipliers: Vector) -> Responses:
    """Add a parameter "NAME lower" or "NAME upper" for each bound with a positive multiplier.

    `multipliers` (2 nf,) has those of all lower bounds first, then those of all upper bounds.
    """
    space, problem = evaluator.space, evaluator.problem
    nf = space.size
    priced = np.flatnonzero(multipliers > 0)
    names, values, shifts = [], [], np.zeros((2 * nf, len(priced)))
    for k, i in enumerate(priced):
        j, is_upper = int(i) % nf, bool(i >= nf)
        limit = (problem.upper if is_upper else problem.lower)[space.free[j]]
        slope = limit if space.logarithmic[j] else space.scale[j]
        names.append(f"{problem.names[space.free[j]]} {'upper' if is_upper else 'lower'}")
        values.append(limit)
        shifts[i, k] = (1.0 if is_upper else -1.0) / slope
    count = len(priced)
    return replace(
        derivatives,
        names=(*derivatives.names, *names),
        values=np.concatenate([derivatives.values, np.array(values, dtype=float)]),
        rows=np.concatenate([derivatives.rows, np.zeros((len(derivatives.rows), count))], axis=1),
        mixed=np.concatenate([derivatives.mixed, np.zeros((nf, count))], axis=1),
        bounds=np.concatenate([derivatives.bounds, shifts], axis=1),
    )


def perturbed(parametric: ParametricProblem, name: str, k: int, value: float) -> BoxProblem | None:
    """The problem with parameter k, or a variable's bound, set to `value`.

    If k is beyond the last parameter, the bound labelled `name` is changed instead. The result is
    None if a lower bound would exceed its upper bound.
    """
    if k < len(parametric.parameters):
        parameters = parametric.parameters.copy()
        parameters[k] = value
        return parametric.at(parameters)
    problem = parametric.problem
    variable, side = name.rsplit(" ", 1)
    j = list(problem.names).index(variable)
    bounds = (problem.upper if side == "upper" else problem.lower).copy()
    bounds[j] = value
    lower, upper = (bounds, problem.upper) if side == "lower" else (problem.lower, bounds)
    if lower[j] > upper[j]:
        return None
    return replace(problem, lower=lower, upper=upper, start=None)


def _rows(parametric: ParametricProblem, points: Vector, parameters: Vector) -> Vector:
    problem = replace(
        parametric.problem, start=None, evaluate=lambda x: parametric.evaluate(x, parameters)
    )
    return np.asarray(problem.rows(points))


def _row_slopes(
    parametric: ParametricProblem, point: Point, steps: Vector
) -> tuple[Vector, tuple[str, ...]]:
    """Derivatives (rows, q) of objective and margins; labels of finite-difference parameters."""
    count = len(steps)
    if count == 0:
        return np.zeros((len(point.rows), 0)), ()
    parameters = np.repeat(parametric.parameters[:, None], count, axis=1)
    x = np.repeat(point.x[:, None], count, axis=1)
    shifts = np.diag(steps)
    rows = _rows(
        parametric,
        np.concatenate([x, x], axis=1),
        np.concatenate([parameters + shifts, parameters - shifts], axis=1),
    ).real
    above, below = rows[:, :count], rows[:, count:]
    middle = point.rows[:, None]
    above = np.where(np.isfinite(above), above, 2 * middle - below)
    below = np.where(np.isfinite(below), below, 2 * middle - above)
    crude = np.nan_to_num((above - below) / (2 * steps))
    try:
        fine = _rows(parametric, x, parameters + 1j * STEP * shifts).imag / STEP / steps
    except (TypeError, ValueError, np.exceptions.ComplexWarning):
        return crude, tuple(parametric.parameter_names)
    room = 1e-4 * np.abs(crude).max(axis=0) + 1e-6 * (1 + np.abs(point.rows).max()) / np.abs(steps)
    room = np.minimum(room, 1e-4 * np.abs(crude).max(axis=0) + 1e-9 / np.abs(steps))
    wrong = ~(np.abs(fine - crude) <= room).all(axis=0)
    # A margin is relative, except for a limit of 0, so it jumps between this limit and its
    # neighbours; differences are then wrong.
    wrong &= (parametric.parameters != 0) | ~fine.any(axis=0)
    names = tuple(parametric.parameter_names[int(k)] for k in np.flatnonzero(wrong))
    return np.where(wrong, crude, fine), names


def _mixed(
    parametric: ParametricProblem,
    evaluator: Evaluator,
    point: Point,
    weights: Vector,
    steps: Vector,
) -> Vector:
    """Derivatives of the Lagrangian's gradient (nf, q), by central differences.

    Where the complex step works, each side of the differences takes only one call of the model.
    """
    count, nf = len(steps), evaluator.space.size
    if count == 0 or nf == 0:
        return np.zeros((nf, count))
    slopes = []
    if evaluator.complex_works and not evaluator.difference_rows.any():
        x = evaluator.space.complex_steps(point.x[:, None])
        for sign in (1.0, -1.0):
            columns = parametric.parameters[:, None] + sign * np.diag(steps)
            rows = _rows(parametric, np.tile(x, count), np.repeat(columns, nf, axis=1))
            part = (rows.imag / STEP).reshape(len(rows), count, nf)
            slopes.append(np.tensordot(weights, part, axes=1))
    else:
        for sign in (1.0, -1.0):
            side = []
            for k in range(count):
                parameters = parametric.parameters.copy()
                parameters[k] += sign * 100 * steps[k]
                changed = Evaluator(parametric.at(parameters))
                changed.adopt_check(evaluator)
                side.append(weights @ changed.jacobians(point.z[:, None])[:, 0])
            slopes.append(np.array(side))
        steps = 100 * steps
    return np.asarray(np.nan_to_num((slopes[0] - slopes[1]) / (2 * steps[:, None])).T)
