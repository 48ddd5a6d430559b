"""A quick look at a combination of the choices: descends from solved, similar combinations.

It usually finds the optimum of the combination, or no feasible design if there is none. It proves
neither that the optimum is the best nor that the combination is infeasible.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..base.dataclass import dataclass
from ..design.choice_list import Value
from ..evaluation import PreparedDesign
from . import kinks, kkt, nlopt_wrapper, repairs
from .actuator import ActuatorProblem
from .evaluator import Evaluator, LimitReached, Point
from .problem import Vector
from .resolve.boxes import ROUGH, stepped
from .resolve.steps import ScaledHessian, hessian_at
from .result import How
from .solution import MET, Solution
from .solver import solve, sweep

EVALUATIONS = 40
"""Maximum number of evaluations in one descent; 10 to 30 are enough from a nearby design."""

SAMPLES = 256
"""Number of points of the sweep that gives another start if the similar combinations fail."""

DOUBTFUL = 0.02
"""If the least violation found is at most this, the look may have missed a feasible design, and
further starts are tried."""

STUCK = 0.3
"""If the least violation found exceeds this, the search may be stuck; further starts follow.
Between `DOUBTFUL` and this limit, all starts of the shipped designs led to the same violation, so
one start is enough."""

SETTLED = 1e-2
"""A descent counts as converged up to this residual of the optimality conditions."""

STARTS = 3
"""Number of starts after a descent that did not converge: its end point, the design's start, and
the best point of a sweep."""


@dataclass
class Look:
    """A combination of choices: its design and the results so far."""

    order: int
    values: Mapping[str, Value]
    subject: PreparedDesign | None = None
    actuator: ActuatorProblem | None = None
    fault: str = ""
    """Reason why the combination is impossible."""
    how: How = "not tried"
    x: Vector | None = None
    objective: float = math.inf
    violation: float = math.inf
    missed: str = ""
    """The limit with the largest violation."""
    checks: frozenset[str] = frozenset()
    """Missed checks that no variable can correct."""
    solution: Solution | None = None
    hessian: ScaledHessian | None = None
    """Hessian at the optimum of this combination, or of a similar combination from whose optimum
    Newton steps led here."""
    sizing: str = ""
    """Result of the search for listed sizes, in one or a few words; empty without a search."""
    rounded: float | None = None
    """Objective of the best design of listed sizes."""

    @property
    def feasible(self) -> bool:
        """Whether all requirements are met."""
        return self.violation <= MET


class LookStart(NamedTuple):
    """A start for a descent; if `descend` is false, the worst violation is minimised first."""

    x: Vector
    descend: bool
    hessian: ScaledHessian | None = None
    """Hessian at the start if the start is the optimum of a similar combination; else None."""


def look_quickly(
    look: Look,
    starts: Sequence[LookStart],
    seed: int,
    seconds: float | None,
) -> None:
    """Descend from the starts, then from the best point of a sweep, until the result is clear.

    Parameters
    ----------
    look : the combination, in which the best point is stored
    starts : starting points, the most reliable first
    seed : seed of the sweep
    seconds : time limit
    """
    assert look.actuator is not None
    evaluator = Evaluator(look.actuator.problem, max_seconds=seconds)

    def down(start: Point) -> Point:
        run = nlopt_wrapper.run(
            evaluator, start, "LD_SLSQP", max_evaluations=EVALUATIONS, seed=seed
        )
        return _store_best(look, evaluator, run.point)

    look.how = "quick"
    try:
        if _follow_neighbour(look, evaluator, starts):
            return
        for z, descend in _coordinates(evaluator, starts, seed):
            point = _store_best(look, evaluator, evaluator.point(z))
            if point.valid and (descend or point.violation <= MET):
                point = down(point)
            if point.valid and point.violation > MET and evaluator.space.size:
                point = _store_best(look, evaluator, repairs.least_missed(evaluator, point))
                if point.violation <= MET:
                    down(point)
            if look.feasible or DOUBTFUL < look.violation <= STUCK:
                break
        if look.feasible and look.x is not None:
            _settle_quickly(look, evaluator, look.x, seed)
    except LimitReached:
        look.how = "not tried" if look.x is None else "quick"


def _follow_neighbour(look: Look, evaluator: Evaluator, starts: Sequence[LookStart]) -> bool:
    """Take Newton steps from the optimum of a similar combination; return whether they converge."""
    neighbour = next((start for start in starts if start.hessian is not None), None)
    if neighbour is None or neighbour.hessian is None or not evaluator.space.size:
        return False
    evaluator.eager = True
    point = evaluator.point(evaluator.space.to_z(neighbour.x))
    optimum = stepped(evaluator, point, neighbour.hessian, ROUGH) if point.valid else None
    if optimum is not None:
        _store_best(look, evaluator, optimum)
        look.hessian = neighbour.hessian
    return optimum is not None


def hessian_of(look: Look) -> ScaledHessian | None:
    """The Hessian at the optimum of a combination; None without an optimum."""
    if look.actuator is None or look.x is None:
        return None
    evaluator = Evaluator(look.actuator.problem)
    point = evaluator.point(evaluator.space.to_z(look.x))
    if not point.valid or not evaluator.space.size:
        return None
    converged = kkt.check(evaluator, point).residual <= SETTLED
    return hessian_at(evaluator, point) if converged else None


def _settle_quickly(look: Look, evaluator: Evaluator, x: Vector, seed: int) -> None:
    """Optimise from a few starts if the descent ended before it reached an optimum."""
    quality = kinks.check(evaluator, evaluator.point(evaluator.space.to_z(x)))
    if quality.residual <= SETTLED or not evaluator.space.size:
        return
    seconds = None
    if evaluator.max_seconds is not None:
        seconds = evaluator.began + evaluator.max_seconds - time.perf_counter()
        if seconds <= 0:
            return
    solution = solve(
        evaluator.problem,
        starts=STARTS,
        samples=SAMPLES,
        seed=seed,
        max_seconds=seconds,
        more_starts=[x],
    )
    _store_best(look, evaluator, evaluator.point(evaluator.space.to_z(solution.x)))


def _coordinates(
    evaluator: Evaluator, starts: Sequence[LookStart], seed: int
) -> Iterator[tuple[Vector, bool]]:
    """Coordinates of the given starts, then of the best point of a small sweep."""
    for x, descend, _ in starts:
        yield evaluator.space.to_z(x), descend
    if evaluator.space.size:
        swept = sweep(evaluator, SAMPLES, seed)
        if swept.z.shape[1]:
            yield swept.z[:, 0].copy(), not starts


def _store_best(look: Look, evaluator: Evaluator, point: Point) -> Point:
    """Store a point if it is better than the stored point; return the point."""
    better = (max(point.violation, MET), point.objective)
    if not point.valid or better >= (max(look.violation, MET), look.objective):
        return point
    look.x, look.objective, look.violation = point.x, point.objective, point.violation
    margins = point.rows[1 : 1 + evaluator.constraint_count]
    if len(margins):
        look.missed = evaluator.problem.constraint_names[int(np.argmin(margins))]
    return point
