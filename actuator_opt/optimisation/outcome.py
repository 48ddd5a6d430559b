"""How an optimisation ended, as sentences with a remedy, and everything it found."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from .kkt import Kkt
from .problem import BoxProblem, Vector

MET = 1e-6
"""Worst violation that counts as met (contract)."""


class Outcome(Enum):
    """How a run ended: status word, sentence, remedy."""

    OPTIMUM = (
        "optimal",
        "optimum found: every requirement is met and the optimality conditions hold",
        "",
    )
    NOT_STATIONARY = (
        "feasible",
        "every requirement is met, but the optimality conditions do not hold to 1e-6",
        "run again with more starts or another seed, or look for a kink (min, max, look-up "
        "table) in an own metric near this point, or for an edge where it ends",
    )
    SADDLE = (
        "feasible",
        "every requirement is met and the slopes balance, but the point is not a minimum",
        "run again with another seed or more starts",
    )
    INFEASIBLE = (
        "infeasible",
        "no point that meets every requirement was found",
        "free a dimension, change a choice, widen a bound or relax a requirement that conflicts",
    )
    LIMIT = (
        "limit",
        "stopped by the evaluation or time limit; the best point that meets every requirement "
        "is kept",
        "raise the limit to let the search finish",
    )
    LIMIT_INFEASIBLE = (
        "limit_infeasible",
        "stopped by the evaluation or time limit before any point met every requirement",
        "raise the limit, or give a start that meets the requirements",
    )
    INTERRUPTED = (
        "interrupted",
        "interrupted; the best point so far meets every requirement",
        "run again to let the search finish",
    )
    INTERRUPTED_INFEASIBLE = (
        "interrupted_infeasible",
        "interrupted before any point met every requirement",
        "run again to let the search finish",
    )
    FLAT = (
        "flat",
        "no variable affects the objective; the point only meets the requirements",
        "free a variable that the objective depends on, or choose another objective",
    )
    UNDEFINED = (
        "undefined",
        "the model gives no finite values at any point tried",
        "narrow the bounds to where the model is valid, or check an own metric for NaN",
    )
    NOTHING_FREE = (
        "nothing_free",
        "every variable is fixed by equal bounds; the point is only evaluated",
        "give at least one variable a lower bound below its upper bound",
    )

    @property
    def status(self) -> str:
        """One word for machines."""
        return str(self.value[0])

    @property
    def sentence(self) -> str:
        """What happened, in plain words."""
        return str(self.value[1])

    @property
    def remedy(self) -> str:
        """What to do about it; empty where nothing needs doing."""
        return str(self.value[2])

    @property
    def feasible(self) -> bool:
        """Whether the point meets every constraint (where the outcome itself tells)."""
        return self in (
            Outcome.OPTIMUM,
            Outcome.NOT_STATIONARY,
            Outcome.SADDLE,
            Outcome.LIMIT,
            Outcome.INTERRUPTED,
            Outcome.FLAT,
        )


@dataclass(frozen=True, slots=True)
class LocalOptimum:
    """A distinct point that local runs ended on, and from how many starts."""

    x: Vector
    objective: float
    violation: float
    residual: float
    hits: int


@dataclass(frozen=True, slots=True)
class StartRecord:
    """One start and where it led: the algorithm that ended it and the final values."""

    x: Vector
    objective: float
    violation: float
    algorithm: str
    evaluations: int

    @property
    def feasible(self) -> bool:
        """Whether it led to a point that meets every limit."""
        return self.violation <= MET


@dataclass(frozen=True)
class Solution:
    """The best point found, how good it is and how it was found.

    Parameters
    ----------
    problem : the problem solved
    outcome : how the run ended
    x : variables (n,)
    objective, constraints, equalities : values at x
    violation : worst missed margin, 0 where all are met
    kkt : optimality conditions at x; None where the model is undefined
    evaluations, gradients : points evaluated and gradients taken in the local phase
    samples, feasible_samples : points of the global sweep, and how many met everything
    undefined : share of the sweep where the model has no finite values
    starts : where each start led, in order
    optima : distinct local optima, the best first
    trace : (evaluation, objective, violation) of each improvement
    algorithm : the algorithm that reached x
    without_effect : labels of variables that changed no value anywhere they were tried
    warnings : what the user should know
    seed, seconds : of the run
    """

    problem: BoxProblem
    outcome: Outcome
    x: Vector
    objective: float
    constraints: Vector
    equalities: Vector
    violation: float
    kkt: Kkt | None
    evaluations: int
    gradients: int
    algorithm: str
    seconds: float
    samples: int = 0
    feasible_samples: int = 0
    undefined: float = 0.0
    starts: tuple[StartRecord, ...] = ()
    optima: tuple[LocalOptimum, ...] = ()
    trace: tuple[tuple[int, float, float], ...] = ()
    without_effect: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    seed: int = 0

    @property
    def feasible(self) -> bool:
        """Whether every margin is at least -1e-6 and every equality within 1e-6."""
        return self.violation <= MET

    @property
    def interrupted(self) -> bool:
        """Whether Ctrl-C ended the search."""
        return self.outcome in (Outcome.INTERRUPTED, Outcome.INTERRUPTED_INFEASIBLE)

    def at_bound(self, index: int) -> str | None:
        """``"lower"``, ``"upper"`` or None for variable `index`."""
        low, high = self.problem.lower[index], self.problem.upper[index]
        room = 1e-6 * max(abs(low), abs(high), high - low)
        if self.x[index] - low <= room:
            return "lower"
        return "upper" if high - self.x[index] <= room else None
