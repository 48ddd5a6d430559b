"""The Pareto front of an actuator, for objectives named by metric."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..base.bounds import FRONT
from ..base.errors import Diagnostic, InputError, UsageError, remedy
from ..base.numeric import Array
from ..base.quantities import Quantity
from ..design.model import Objective
from ..evaluation import PreparedDesign, compute, evaluate
from ..evaluation.build import spec_hash
from ..evaluation.governing import governing
from ..evaluation.limits import MetricArrays
from .actuator import ActuatorProblem, Fault, Goal, build, idle_metrics
from .descents import FEASIBLE
from .front.front import Front, NoEnd, Settings, front
from .front.objectives import Objectives
from .infeasibility_card import explained
from .pareto_result import FrontPoint, Knee, ParetoFront, Wish
from .problem import Values, Vector
from .rounding import design_at


def wishes(texts: Sequence[str], known: dict[str, Quantity]) -> tuple[Wish, ...]:
    """Parse objectives from ``METRIC:min`` or ``METRIC:max``.

    Raises
    ------
    UsageError : fewer than two or more than four, an unknown metric, or one metric twice
    """
    found: list[Wish] = []
    for text in texts:
        metric, colon, sense = (part.strip() for part in text.partition(":"))
        if not colon or sense not in ("min", "max"):
            message = f'objective "{text}" is not of the form METRIC:min or METRIC:max'
            raise UsageError(Diagnostic(message, 'write e.g. "mass:min"'))
        if metric not in known:
            message = f'objective "{text}": there is no metric {metric}'
            raise UsageError(Diagnostic(message, remedy(metric, known)))
        before = next((one for one in found if one.metric == metric), None)
        if before is not None:
            both = before.sense != sense
            message = f"objective {metric} is given twice" + (", min and max" if both else "")
            raise UsageError(Diagnostic(message, "keep one of them"))
        found.append(Wish(metric, "min" if sense == "min" else "max", known[metric]))
    if not 2 <= len(found) <= 4:
        message = f"a front needs two to four objectives, not {len(found)}"
        raise UsageError(Diagnostic(message, 'give e.g. "mass:min" and "stiffness_min:max"'))
    return tuple(found)


@dataclass(frozen=True)
class _Many:
    """The problem of an actuator with several objectives."""

    actuator: ActuatorProblem
    goals: tuple[Goal, ...]
    wished: tuple[Wish, ...]
    subject: PreparedDesign
    """The problem with the design's own objective."""

    def evaluate(self, points: Array) -> Values:
        """Objectives, to be minimised, and margins."""
        cases = self.actuator.subject.cases
        done: list[MetricArrays] = []
        found = self.actuator.evaluate(points, seen=done)
        return replace(found, objective=[goal.value(done[0], cases) for goal in self.goals])


def pareto(
    subject: PreparedDesign,
    objectives: Sequence[str],
    *,
    count: int = 50,
    seed: int = 0,
    checks: int = 3,
    fault: Fault | None = None,
) -> ParetoFront:
    """Compute the Pareto front of a design.

    Parameters
    ----------
    subject : the prepared design
    objectives : two to four of ``METRIC:min`` or ``METRIC:max``
    count : designs requested
    seed : of the searches; the same seed gives the same front
    checks : independent searches between designs, which reveal merely local ones
    fault : locates faults of variables in the file
    """
    began = time.perf_counter()
    wished = wishes(objectives, dict(subject.quantities))
    if not FRONT.least <= count <= FRONT.most:
        message = f"-n {count}: a front has {FRONT.least} to {FRONT.most} designs"
        raise UsageError(Diagnostic(message, "choose a number between them"))
    many = _problem(subject, wished, fault)
    names = [one.metric for one in wished]
    found = front(
        Objectives(names, many.actuator.problem, many.evaluate),
        Settings(count=count, seed=seed, checks=checks),
    )
    if isinstance(found, NoEnd):
        return _without(many, found, began)
    return _result(many, found, seed, began)


def _problem(subject: PreparedDesign, wished: tuple[Wish, ...], fault: Fault | None) -> _Many:
    """The problem, with every objective defined and variable.

    Raises
    ------
    InputError, UsageError : an objective is undefined or constant
    """
    present = compute(subject, subject.values()).computed
    for wish in wished:
        if not present.metrics.get(wish.metric):
            why = present.why.get(wish.metric, "it does not apply to this design")
            message = f"{wish.metric} cannot be an objective here: {why}"
            raise UsageError(
                Diagnostic(message, "choose a metric that `evaluate` lists with a value")
            )
    wish_all = Objective(minimise={one.metric: 1.0 for one in wished})
    asked = replace(
        subject,
        design=subject.design.model_copy(update={"objective": wish_all}),
        aims={one.metric: one.sense for one in wished},
    )
    actuator = build(asked, fault)
    still = idle_metrics(actuator)
    if still:
        message = f"no variable affects {' and '.join(still)}: nothing to trade off"
        remedy_ = "choose another objective, or free a dimension that it depends on"
        raise InputError(Diagnostic(message, remedy_))
    goals = tuple(
        Goal({one.metric: 1.0}, {one.metric: 1.0}, 1.0 if one.sense == "min" else -1.0)
        for one in wished
    )
    return _Many(actuator, goals, wished, subject)


def _points(many: _Many, found: Front) -> tuple[FrontPoint, ...]:
    """Variables and metrics of every design: objectives, and those of the requirements."""
    actuator, count = many.actuator, found.x.shape[1]
    subject = actuator.subject
    numbers = subject.values(dict(zip(actuator.paths, found.x, strict=True)))
    computed = compute(subject, numbers, actuator.wanted).computed
    names = [one.metric for one in many.wished] + [
        row.limit_of.metric
        for row in (*actuator.rows, *actuator.fixed)
        if row.limit_of.origin in ("requirement", "case")
    ]
    columns = {
        name: np.broadcast_to(governing(name, computed, numbers, subject), (count,))
        for name in dict.fromkeys(names)
    }
    return tuple(
        FrontPoint(
            dict(zip(actuator.paths, found.x[:, k].tolist(), strict=True)),
            {name: float(column[k]) for name, column in columns.items()},
            float(found.residuals[k]),
        )
        for k in range(count)
    )


def _result(many: _Many, found: Front, seed: int, began: float) -> ParetoFront:
    """Assemble the result."""
    knee = None if found.knee is None else Knee(*found.knee)
    shown = 0 if knee is None else knee.index
    design, evaluation = design_at(many.actuator, found.x[:, shown])
    signs = np.array([goal.sign for goal in many.goals])
    return ParetoFront(
        subject=many.subject.design,
        spec_hash=spec_hash(many.subject),
        objectives=many.wished,
        points=_points(many, found),
        knee=knee,
        design=design,
        evaluation=evaluation,
        passed=tuple(map(tuple, _passed(found.passed, signs))),
        gaps=tuple(found.gaps.tolist()),
        wide=found.wide,
        checked=found.checked,
        improved=found.improved,
        failed=found.failed,
        warnings=(*found.warnings, *many.actuator.refusals.warnings(), *_held(many)),
        seed=seed,
        seconds=time.perf_counter() - began,
    )


def _passed(values: Vector, signs: Vector) -> list[list[float]]:
    rows: list[list[float]] = (values * signs[:, None]).T.tolist()
    return rows


def _held(many: _Many) -> list[str]:
    """Parts of a design that a front ignores: its choices, and the sizes of its variables."""
    design = many.actuator.subject.design
    said = []
    if design.choices:
        said.append(f"choices stay as stated in the design: {', '.join(design.choices)}")
    sized = [
        path
        for path, variable in design.variables.items()
        if variable.sizes is not None or variable.step is not None
    ]
    if sized:
        said.append(
            f"listed sizes are ignored, as the front uses continuous dimensions: {', '.join(sized)}"
        )
    return said


def _said(wish: Wish) -> str:
    return f"{wish.metric}:{wish.sense}"


def _without(many: _Many, found: NoEnd, began: float) -> ParetoFront:
    """The result without a front: nothing is feasible, or an end is missing."""
    subject = many.subject
    solution = found.solution
    feasible = solution.violation <= FEASIBLE
    why = None if feasible else explained(many.actuator, solution)[0]
    return ParetoFront(
        subject=subject.design,
        spec_hash=spec_hash(subject),
        objectives=many.wished,
        points=(),
        knee=None,
        design=subject.design,
        evaluation=evaluate(replace(subject, aims=many.actuator.subject.aims)),
        infeasibility=why,
        unsolved=f"{_said(many.wished[found.objective])}: {solution.outcome.sentence}"
        if feasible
        else "",
        seconds=time.perf_counter() - began,
    )
