"""Solution of an optimisation problem: outcome, optimum, its quality, and how the search went."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum

from ..base.dataclass import dataclass
from .kkt import KktResidual
from .problem import BoxProblem, Vector

MET = 1e-6
"""Largest violation at which a constraint still counts as met."""

BETTER = 1e-8
"""An objective better by this share means that the point lies in another valley (local optimum)."""


class Outcome(Enum):
    """End of a run: a status word, a sentence and a remedy."""

    OPTIMUM = (
        "optimal",
        "optimum found: all requirements are met and the optimality conditions are satisfied",
        "",
    )
    NOT_STATIONARY = (
        "feasible",
        "all requirements are met, but the optimality conditions are not satisfied to 1e-6",
        "run again with more starts or another seed; a kink of a limit may be near this point, "
        "such as two places of equal stress, or min, max or a table in a custom metric",
    )
    SADDLE = (
        "feasible",
        "all requirements are met and the point is stationary, but it is not a minimum",
        "run again with another seed or more starts",
    )
    INFEASIBLE = (
        "infeasible",
        "no design meets all requirements",
        "free a dimension, change a choice, widen a bound or relax a conflicting requirement",
    )
    LIMIT = (
        "limit",
        "stopped at the evaluation or time limit; the best feasible design so far is kept",
        "raise the limit to let the search finish",
    )
    LIMIT_INFEASIBLE = (
        "limit_infeasible",
        "stopped at the evaluation or time limit before any design met all requirements",
        "raise the limit, or start from a design that meets the requirements",
    )
    INTERRUPTED = (
        "interrupted",
        "interrupted; the best feasible design so far is kept",
        "run again to let the search finish",
    )
    INTERRUPTED_INFEASIBLE = (
        "interrupted_infeasible",
        "interrupted before any design met all requirements",
        "run again to let the search finish",
    )
    FLAT = (
        "flat",
        "no variable affects the objective; the design only meets the requirements",
        "free a variable that the objective depends on, or choose another objective",
    )
    UNDEFINED = (
        "undefined",
        "the model has no finite values at any point tried",
        "narrow the bounds to the valid range of the model, or check custom metrics for NaN",
    )
    NOTHING_FREE = (
        "nothing_free",
        "equal bounds fix every variable; the design is only evaluated",
        "give at least one variable a lower bound below its upper bound",
    )

    @property
    def status(self) -> str:
        """Status word for machines."""
        return str(self.value[0])

    @property
    def sentence(self) -> str:
        """The outcome as a sentence."""
        return str(self.value[1])

    @property
    def remedy(self) -> str:
        """The next step recommended to the user; empty if none."""
        return str(self.value[2])

    @property
    def feasible(self) -> bool:
        """Whether a run with this outcome found a point that meets every constraint."""
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
    """A point where local runs ended, and how many starts reached it."""

    x: Vector
    objective: float
    violation: float
    residual: float
    hits: int


@dataclass(frozen=True, slots=True)
class StartRecord:
    """One start of the search, and its result."""

    x: Vector
    objective: float
    violation: float
    algorithm: str
    evaluations: int

    @property
    def feasible(self) -> bool:
        """Whether the start led to a point that meets every limit."""
        return self.violation <= MET


def reached_again(starts: Sequence[StartRecord], objective: float) -> bool:
    """Whether several different runs led to feasible points with at least this objective.

    If such a point is no proven optimum, it is on a kink, and more runs would only reach it again.
    """
    room = BETTER * abs(objective)
    ends = [start for start in starts if start.feasible and start.objective <= objective + room]
    return len({(end.x.tobytes(), end.algorithm) for end in ends}) > 1


@dataclass(frozen=True)
class Solution:
    """The best point, its quality and the search statistics.

    Parameters
    ----------
    problem : the problem solved
    outcome : how the run ended
    x : variables (n,)
    objective, constraints, equalities : values at x
    violation : largest violation of any limit, 0 if all limits are met
    kkt : optimality conditions at x; None if the model is undefined at x
    evaluations, gradients : numbers of points evaluated and gradients computed after the sweep
    samples, feasible_samples : number of points in the global sweep, and how many of them were
        feasible
    undefined : share of the sweep's points at which the model has no finite values
    starts : result of each start, in order
    optima : distinct local optima, the best first
    trace : (evaluation number, objective, violation) at each improvement
    algorithm : the algorithm that reached x
    without_effect : labels of variables that affected no value at any point
    warnings : messages for the user
    seed, seconds : seed and duration of the run
    """

    problem: BoxProblem
    outcome: Outcome
    x: Vector
    objective: float
    constraints: Vector
    equalities: Vector
    violation: float
    kkt: KktResidual | None
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
        """The bound that variable `index` has reached: ``"lower"``, ``"upper"`` or None."""
        low, high = self.problem.lower[index], self.problem.upper[index]
        room = 1e-6 * max(abs(low), abs(high), high - low)
        if self.x[index] - low <= room:
            return "lower"
        return "upper" if high - self.x[index] <= room else None
