"""Computes the Pareto front of an actuator for several metrics: designs, knee, spacing, checks."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from statistics import median
from typing import Any, Literal

import numpy as np

from ..base.bounds import FRONT
from ..base.cluster import HERE, Cluster
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, UsageError, remedy
from ..base.quantities import Quantity
from ..base.tables import Displayed
from ..design import Design
from ..design.model import Objective
from ..evaluation import Evaluation, PreparedDesign, compute, evaluate
from ..evaluation.build import spec_hash
from ..evaluation.kernel import governing
from ..metrics import split_case
from .actuator import ActuatorProblem, Fault, Goal, build, idle_metrics
from .front.front import Front, FrontSettings, NoAnchor, front
from .front.objectives import Objectives
from .front.plane import FrontGap
from .infeasibility import explained
from .problem import Vector
from .result import Infeasibility
from .rounding import design_at
from .solution import MET


@dataclass(frozen=True, slots=True)
class Wish:
    """A metric to minimise or maximise."""

    metric: str
    sense: Literal["min", "max"]
    quantity: Quantity


@dataclass(frozen=True, slots=True)
class FrontPoint:
    """A design on the front (SI), with the residual of its optimality conditions."""

    variables: Mapping[str, float]
    metrics: Mapping[str, float]
    kkt_residual: float

    def to_dict(self) -> dict[str, Any]:
        """The design in JSON (SI)."""
        return {
            "variables": dict(self.variables),
            "metrics": dict(self.metrics),
            "kkt_residual": self.kkt_residual,
        }


@dataclass(frozen=True, slots=True)
class Knee:
    """The design where the front bends most: its index, and how far the front bulges there.

    `depth` is the normalised distance from the plane (for two objectives, the line) through the
    designs that are best in one objective each.
    """

    index: int
    depth: float


@dataclass(frozen=True, slots=True)
class ParetoFront(Displayed):
    """The Pareto front of a design.

    Parameters
    ----------
    subject : the design studied
    spec_hash : hash of the design's specification
    objectives : metrics with their direction
    points : designs on the front, sorted by the first objective
    knee : the design where the front bends most towards the ideal; None without a bend
    design, evaluation : the knee, or else the first point; without a front, the design in the file
    passed : objectives of dominated designs that the search found
    gaps : normalised distances between neighbours; for three or more objectives, to the nearest
        design
    wide : with two objectives, gaps above three times the median, and whether the front jumps there
    checked, improved : number of checking searches between designs, and how many improved the front
    failed : number of places of the front at which the search found no design
    infeasibility : reason why no design is feasible, if there is no front for that reason
    unsolved : the objective whose best design the search did not find, and the outcome of that
        search
    """

    subject: Design
    spec_hash: str
    objectives: tuple[Wish, ...]
    points: tuple[FrontPoint, ...]
    knee: Knee | None
    design: Design
    evaluation: Evaluation
    passed: tuple[tuple[float, ...], ...] = ()
    gaps: tuple[float, ...] = ()
    wide: tuple[FrontGap, ...] = ()
    checked: int = 0
    improved: int = 0
    failed: int = 0
    infeasibility: Infeasibility | None = None
    unsolved: str = ""
    warnings: tuple[str, ...] = ()
    seed: int = 0
    seconds: float = 0.0

    @property
    def status(self) -> str:
        """Status of the front, in one word."""
        if self.points:
            return "front" if len(self.points) > 1 else "no conflict"
        return "unsolved" if self.unsolved else "infeasible"

    @property
    def in_short(self) -> tuple[str, str]:
        """The objectives, and the number of designs."""
        goals = " and ".join(f"{wish.metric} {wish.sense}" for wish in self.objectives)
        count = len(self.points)
        words = f"{count} design{'' if count == 1 else 's'}" if count else self.status
        return self.subject.name, f"{goals}, {words}"

    @property
    def jumps(self) -> tuple[FrontGap, ...]:
        """Gaps where the front jumps, so that no design lies between."""
        return tuple(gap for gap in self.wide if gap.jump)

    @property
    def steps(self) -> tuple[float, ...]:
        """Distances between neighbouring designs of the front, except across jumps."""
        jumps = {gap.after for gap in self.jumps}
        return tuple(gap for k, gap in enumerate(self.gaps) if k not in jumps)

    @property
    def evenness(self) -> float | None:
        """Largest gap divided by the median gap, without jumps; None if there are no gaps."""
        return max(self.steps) / median(self.steps) if self.steps else None

    @property
    def sentence(self) -> str:
        """The result as a sentence."""
        if self.unsolved:
            return (
                "no front: the search for the best value of a single objective failed "
                f"({self.unsolved})"
            )
        if self.infeasibility is not None or not self.points:
            reason = "" if self.infeasibility is None else f" {self.infeasibility.sentence}"
            return f"no front: no design meets all requirements.{reason}"
        if len(self.points) == 1:
            return "the objectives do not conflict: one design is best in every objective"
        sentence = f"{len(self.points)} non-dominated designs; "
        sentence += (
            f"{self.checked} independent searches replaced {self.improved} designs "
            "that were only local optima"
        )
        if self.failed:
            sentence += f"; the search found no design at {self.failed} place" + "s" * (
                self.failed > 1
            )
            sentence += " of the front"
        return sentence

    def to_dict(self) -> dict[str, Any]:
        """The object of `pareto --json`; it includes the evaluation of the knee (SI)."""
        knee = self.knee
        result = self.evaluation.to_dict() | {
            "spec_hash": self.spec_hash,
            "status": self.status,
            "outcome": self.sentence,
            "objectives": [{"metric": o.metric, "sense": o.sense} for o in self.objectives],
            "points": [point.to_dict() for point in self.points],
            "knee": None
            if knee is None
            else {"index": knee.index, "depth": knee.depth, **self.points[knee.index].to_dict()},
            "dominated": [
                dict(zip([o.metric for o in self.objectives], values, strict=True))
                for values in self.passed
            ],
            "gaps": None
            if not self.steps
            else {
                "median": median(self.steps),
                "largest": max(self.steps),
                "ratio": self.evenness,
                "wide": [asdict(gap) for gap in self.wide],
            },
            "checked": self.checked,
            "improved": self.improved,
            "failed": self.failed,
            "warnings": [*self.evaluation.warnings, *self.warnings],
            "seed": self.seed,
            "seconds": self.seconds,
        }
        infeasibility = self.infeasibility
        return result | ({} if infeasibility is None else {"infeasibility": asdict(infeasibility)})


def wishes(texts: Sequence[str], quantities: Mapping[str, Quantity]) -> tuple[Wish, ...]:
    """Parse objectives of the form ``METRIC:min`` or ``METRIC:max``.

    Raises
    ------
    UsageError : fewer than two or more than four objectives, an unknown metric, or the same metric
        twice
    """
    objectives: list[Wish] = []
    for text in texts:
        metric, colon, sense = (part.strip() for part in text.partition(":"))
        if not colon or sense not in ("min", "max"):
            message = f'objective "{text}" is not of the form METRIC:min or METRIC:max'
            raise UsageError(Diagnostic(message, 'write e.g. "mass:min"'))
        if split_case(metric)[0] not in quantities:
            message = f'objective "{text}": there is no metric {metric}'
            raise UsageError(Diagnostic(message, remedy(metric, quantities)))
        earlier = next((wish for wish in objectives if wish.metric == metric), None)
        if earlier is not None:
            contradictory = earlier.sense != sense
            message = f"objective {metric} is given twice" + (
                ", min and max" if contradictory else ""
            )
            raise UsageError(Diagnostic(message, "keep one of them"))
        objectives.append(Wish(metric, "min" if sense == "min" else "max", quantities[metric]))
    if not 2 <= len(objectives) <= 4:
        message = f"a front needs two to four objectives, not {len(objectives)}"
        raise UsageError(Diagnostic(message, 'give e.g. "mass:min" and "stiffness_min:max"'))
    return tuple(objectives)


@dataclass(frozen=True)
class _ManyObjectives:
    """An actuator's optimisation problem with several objectives."""

    actuator: ActuatorProblem
    wished: tuple[Wish, ...]
    subject: PreparedDesign
    """The design, with the objective of its file."""


def pareto(
    subject: PreparedDesign,
    objectives: Sequence[str],
    *,
    count: int = 50,
    seed: int = 0,
    checks: int = 3,
    fault: Fault | None = None,
    cluster: Cluster = HERE,
) -> ParetoFront:
    """Compute the Pareto front of a design.

    Parameters
    ----------
    subject : the prepared design
    objectives : two to four of ``METRIC:min`` or ``METRIC:max``
    count : requested number of designs
    seed : seed of the searches; the same seed gives the same front
    checks : number of independent searches between designs, which reveal designs that are only
        locally best
    fault : builds the Diagnostic of a faulty variable, with its line in the file
    cluster : workers for independent searches (see `front`)
    """
    began = time.perf_counter()
    wished = wishes(objectives, subject.quantities)
    if not FRONT.least <= count <= FRONT.most:
        message = f"-n {count}: a front has {FRONT.least} to {FRONT.most} designs"
        raise UsageError(Diagnostic(message, "choose a number between them"))
    many = _problem(subject, wished, fault)
    names = [wish.metric for wish in wished]
    traded = Objectives(names, many.actuator.problem, many.actuator.trade)
    settings = FrontSettings(count=count, seed=seed, checks=checks)
    result = front(traded, settings, cluster)
    if not isinstance(result, NoAnchor) and not many.actuator.confirmed(result.x):
        result = front(traded, settings, cluster)  # without the recorded models: they are wrong
    if isinstance(result, NoAnchor):
        return _without(many, result, began)
    return _result(many, result, seed, began)


def _problem(
    subject: PreparedDesign, wished: tuple[Wish, ...], fault: Fault | None
) -> _ManyObjectives:
    """Build the problem; reject an objective that is undefined or that no variable changes.

    Raises
    ------
    InputError, UsageError : an objective is undefined or constant
    """
    wish_all = Objective(minimise={w.metric: 1.0 for w in wished})
    weighted = replace(
        subject,
        design=subject.design.model_copy(update={"objective": wish_all}),
        aims={w.metric: w.sense for w in wished},
    )
    present = compute(weighted, subject.values()).computed
    for wish in wished:
        if not present.metrics.get(wish.metric):
            reason = present.why.get(wish.metric, "it does not apply to this design")
            message = f"{wish.metric} cannot be an objective here: {reason}"
            raise UsageError(
                Diagnostic(message, "choose a metric that `evaluate` lists with a value")
            )
    goals = tuple(
        Goal({w.metric: 1.0}, {w.metric: 1.0}, 1.0 if w.sense == "min" else -1.0) for w in wished
    )
    actuator = build(weighted, fault, goals)
    idle = idle_metrics(actuator)
    if idle:
        message = f"no variable affects {' and '.join(idle)}: nothing to trade off"
        remedy_ = "choose another objective, or free a dimension that it depends on"
        raise InputError(Diagnostic(message, remedy_))
    return _ManyObjectives(actuator, wished, subject)


def _points(many: _ManyObjectives, result: Front) -> tuple[FrontPoint, ...]:
    """For every design, its variables and the metrics used by objectives and requirements."""
    actuator, count = many.actuator, result.x.shape[1]
    subject = actuator.subject
    numbers = subject.values(dict(zip(actuator.paths, result.x, strict=True)))
    computed = compute(subject, numbers, actuator.metrics).computed
    names = [wish.metric for wish in many.wished] + [
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
            dict(zip(actuator.paths, result.x[:, k].tolist(), strict=True)),
            {name: float(column[k]) for name, column in columns.items()},
            float(result.residuals[k]),
        )
        for k in range(count)
    )


def _result(many: _ManyObjectives, result: Front, seed: int, began: float) -> ParetoFront:
    """Assemble the result from the computed front."""
    knee = None if result.knee is None else Knee(*result.knee)
    index = 0 if knee is None else knee.index
    design, evaluation = design_at(many.actuator, result.x[:, index])
    signs = np.array([goal.sign for goal in many.actuator.goals])
    return ParetoFront(
        subject=many.subject.design,
        spec_hash=spec_hash(many.subject),
        objectives=many.wished,
        points=_points(many, result),
        knee=knee,
        design=design,
        evaluation=evaluation,
        passed=tuple(map(tuple, _passed(result.passed, signs))),
        gaps=tuple(result.gaps.tolist()),
        wide=result.wide,
        checked=result.checked,
        improved=result.improved,
        failed=result.failed,
        warnings=(*result.warnings, *many.actuator.refusals.warnings(), *_notes(many)),
        seed=seed,
        seconds=time.perf_counter() - began,
    )


def _passed(values: Vector, signs: Vector) -> list[list[float]]:
    rows: list[list[float]] = (values * signs[:, None]).T.tolist()
    return rows


def _notes(many: _ManyObjectives) -> list[str]:
    """Warnings about choices and listed sizes of a design, which a front ignores."""
    design = many.actuator.subject.design
    notes = []
    if design.choices:
        notes.append(
            f"choices are not varied, but stay as in the design: {', '.join(design.choices)}"
        )
    sized = [
        path
        for path, variable in design.variables.items()
        if variable.sizes is not None or variable.step is not None
    ]
    if sized:
        notes.append(
            f"listed sizes are ignored, as the front uses continuous dimensions: {', '.join(sized)}"
        )
    return notes


def _text(wish: Wish) -> str:
    return f"{wish.metric}:{wish.sense}"


def _without(many: _ManyObjectives, no_anchor: NoAnchor, began: float) -> ParetoFront:
    """The result if there is no front: no design is feasible, or an anchor is missing."""
    subject = many.subject
    solution = no_anchor.solution
    feasible = solution.violation <= MET
    infeasibility = None if feasible else explained(many.actuator, solution)[0]
    return ParetoFront(
        subject=subject.design,
        spec_hash=spec_hash(subject),
        objectives=many.wished,
        points=(),
        knee=None,
        design=subject.design,
        evaluation=evaluate(replace(subject, aims=many.actuator.subject.aims)),
        infeasibility=infeasibility,
        unsolved=f"{_text(many.wished[no_anchor.objective])}: {solution.outcome.sentence}"
        if feasible
        else "",
        seconds=time.perf_counter() - began,
    )
