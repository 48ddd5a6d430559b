"""Results of a Pareto study: designs, knee, spacing and checks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from statistics import median
from typing import Any, Literal

from ..base.quantities import Quantity
from ..base.tables import Displayed
from ..design import Design
from ..evaluation import Evaluation
from .front.even import Gap
from .result import Infeasibility


@dataclass(frozen=True, slots=True)
class Wish:
    """A metric to minimise or maximise."""

    metric: str
    sense: Literal["min", "max"]
    quantity: Quantity


@dataclass(frozen=True, slots=True)
class FrontPoint:
    """A design of the front (SI), with the residual of its optimality conditions."""

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
    """The design farthest from the plane of the anchors, and its normalised distance."""

    index: int
    depth: float


@dataclass(frozen=True, slots=True)
class ParetoFront(Displayed):
    """The Pareto front of a design.

    Parameters
    ----------
    subject : the design studied
    spec_hash : of it
    objectives : metrics with their direction
    points : designs, the best in the first objective first
    knee : where the front bends most towards the ideal; None if it does not
    design, evaluation : of the knee, else of the first point; as stated without a front
    passed : objectives of dominated designs met during the search
    gaps : normalised distances between neighbours (to the nearest for three or more objectives)
    wide : gaps of two objectives above three times the median, and the reason
    checked, improved : independent searches between designs, and how many improved the front
    failed : number of places without a design at or near them
    infeasibility : reason for a missing front
    unsolved : objective whose best design was not found, and the outcome of its search
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
    wide: tuple[Gap, ...] = ()
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
    def jumps(self) -> tuple[Gap, ...]:
        """Gaps at which the front is discontinuous, so that no design lies between."""
        return tuple(gap for gap in self.wide if gap.jump)

    @property
    def steps(self) -> tuple[float, ...]:
        """The gaps other than jumps."""
        over = {gap.after for gap in self.jumps}
        return tuple(gap for k, gap in enumerate(self.gaps) if k not in over)

    @property
    def evenness(self) -> float | None:
        """The largest gap over the median one, without jumps; None if there are no gaps."""
        return max(self.steps) / median(self.steps) if self.steps else None

    @property
    def sentence(self) -> str:
        """The result in words."""
        if self.unsolved:
            return (
                f"no front: the search for the best of one objective alone failed, {self.unsolved}"
            )
        if self.infeasibility is not None or not self.points:
            why = "" if self.infeasibility is None else f" {self.infeasibility.sentence}"
            return f"no front: no design meets all requirements.{why}"
        if len(self.points) == 1:
            return "the objectives do not conflict: one design is best in every objective"
        told = f"{len(self.points)} non-dominated designs; "
        told += f"{self.checked} independent searches replaced {self.improved} merely local designs"
        if self.failed:
            told += f"; no design at {self.failed} place" + "s" * (self.failed > 1)
        return told

    def to_dict(self) -> dict[str, Any]:
        """The object of `pareto --json`: the evaluation's keys are those of the knee (SI)."""
        knee = self.knee
        found = self.evaluation.to_dict() | {
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
        more = self.infeasibility
        return found | ({} if more is None else {"infeasibility": asdict(more)})
