"""Single changes of a requirement or a bound that make an infeasible problem feasible.

Each candidate change drops one requirement or widens one bound. For each candidate, the
search first looks for a point that meets all unchanged limits; it takes shortest steps to the
linearised limits, for all candidates at once. If the steps fail, an elastic problem (with slacks on
the constraints) minimises the worst violation from several points. From the feasible point, the
search then finds the least change that is enough.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from ..base.dataclass import dataclass
from ..base.numeric import Array
from ..base.progress import tell
from . import kkt
from .evaluator import Evaluator, Point
from .kkt import polish
from .nlopt_wrapper import run
from .problem import BoxProblem, ParametricProblem, PointValues, Vector
from .resolve.changed import ChangedProblems, applicable

Indices: TypeAlias = npt.NDArray[np.intp]


MOST = 200
"""Maximum number of evaluations in one descent; 10 to 50 usually suffice."""


FINE = 1e-7
"""Relative tolerance of a descent whose result Newton steps polish afterwards."""


EXACT = 1e-9
"""The Newton steps after a descent end once the measure of optimality is below this."""


ROUGH = 1e-5
"""Relative tolerance of a descent that only tests a start."""


def common(problem: BoxProblem, room: float) -> BoxProblem:
    """The problem relaxed by a single slack, which is added to all constraints and equalities."""
    m, e = len(problem.constraint_names), len(problem.equality_names)
    n = len(problem.names)

    def evaluate(x: Array) -> PointValues:
        rows = _rows_once(problem, x[:n])
        slack = x[n]
        margins = [rows[1 : 1 + m] + slack]
        if e:
            margins += [slack - rows[1 + m :], slack + rows[1 + m :]]
        return PointValues(slack, np.concatenate(margins))

    names = tuple(str(i) for i in range(m + 2 * e))
    return _extended(problem, evaluate, ["slack"], room, names, ())


def separate(problem: BoxProblem, groups: Sequence[Indices], room: Sequence[float]) -> BoxProblem:
    """The problem relaxed by one slack for each of the `groups`; other constraints must be met."""
    n, m = len(problem.names), len(problem.constraint_names)

    def evaluate(x: Array) -> PointValues:
        rows = _rows_once(problem, x[:n])
        margins = np.array(rows[1 : 1 + m], dtype=np.result_type(rows, x))
        for slack, group in zip(x[n:], groups, strict=True):
            margins[group] = margins[group] + slack
        return PointValues(x[n:].sum(axis=0), margins, rows[1 + m :])

    names = [f"relax {problem.constraint_names[group[0]]}" for group in groups]
    return _extended(
        problem, evaluate, names, room, problem.constraint_names, problem.equality_names
    )


def _rows_once(problem: BoxProblem, points: Array) -> npt.NDArray[np.generic]:
    """Objective and margins at points (n, k); points with only other slacks are evaluated once."""
    columns = np.ascontiguousarray(points.T)
    numbers: dict[bytes, int] = {}
    places = [numbers.setdefault(column.tobytes(), len(numbers)) for column in columns]
    if len(numbers) == len(columns):
        return problem.rows(points)
    _, indices = np.unique(places, return_index=True)
    return problem.rows(points[:, indices])[:, places]


def _extended(
    problem: BoxProblem,
    evaluate: Callable[[Array], PointValues],
    names: Sequence[str],
    room: float | Sequence[float],
    constraint_names: Sequence[str],
    equality_names: Sequence[str],
) -> BoxProblem:
    count = len(names)
    return replace(
        problem,
        names=(*problem.names, *names),
        lower=np.concatenate([problem.lower, np.zeros(count)]),
        upper=np.concatenate([problem.upper, np.broadcast_to(np.asarray(room), (count,))]),
        evaluate=evaluate,
        constraint_names=tuple(constraint_names),
        equality_names=tuple(equality_names),
        start=None,
        relaxable=None,
        groups=None,
    )


def feasible_point(evaluator: Evaluator, point: Point) -> Point | None:
    """A feasible point near `point`, or None; found by minimising a common slack."""
    if point.violation <= NOTHING:
        return point
    end = least_missed(evaluator, point)
    return end if end.violation <= NOTHING else None


def least_missed(evaluator: Evaluator, point: Point, rough: float = np.inf) -> Point:
    """Minimise the worst violation near a point; return a feasible point unchanged.

    If a rough search ends with a violation above `rough`, it is not refined, which halves the
    effort.
    """
    inner = Evaluator(common(evaluator.problem, 2.0 * point.violation + 1.0))
    start = best = inner.point(inner.space.to_z(np.append(point.x, point.violation)))
    if not start.valid:
        return point
    inner.eager = True
    if rough < np.inf:
        best = run(
            inner, start, "LD_SLSQP", tolerance=ROUGH, max_evaluations=MOST, rank=_miss
        ).point
    if _miss(best) <= rough:
        run_end = run(inner, best, "LD_SLSQP", tolerance=FINE, max_evaluations=MOST, rank=_miss)
        best = min((run_end.point, finish(inner, run_end.point)), key=_miss)
    evaluator.evaluations += inner.evaluations
    evaluator.check_limits()
    end = evaluator.point(evaluator.space.to_z(best.x[: len(point.x)]))
    return end if end.valid and end.violation < point.violation else point


def _miss(point: Point) -> float:
    """Sort key for points of the problem with a common slack: slack plus remaining violation."""
    return point.objective + point.violation if point.valid else np.inf


def descend(
    problem: BoxProblem, x: Vector, slack: Sequence[float], ends: Sequence[Point] = ()
) -> Point:
    """Solve a relaxed problem from a point and its slacks; stop near a known result (`ends`)."""
    inner = Evaluator(problem)
    start = inner.point(inner.space.to_z(np.concatenate([x, np.asarray(slack, dtype=float)])))
    if not start.valid:
        return start
    run_end = run(inner, start, "LD_SLSQP", tolerance=FINE, max_evaluations=MOST, optima=ends)
    return ends[run_end.arrived] if run_end.arrived is not None else finish(inner, run_end.point)


def go(evaluator: Evaluator, start: Point) -> Point:
    """Run one descent and polish the result."""
    return finish(
        evaluator, run(evaluator, start, "LD_SLSQP", tolerance=FINE, max_evaluations=MOST).point
    )


def finish(evaluator: Evaluator, point: Point) -> Point:
    """Refine the end point of a descent by Newton steps, to the accuracy `EXACT`."""
    return polish(evaluator, point, tolerance=EXACT)


NOTHING = 1e-6
"""Relaxations and violations up to this count as zero."""

SETTLED = 1e-6
"""A result counts as an optimum up to this residual of the optimality conditions."""

CHALLENGE = 0.99
"""If this share of a relaxation is also enough, the relaxation found was too large."""

FAINT = 1e-3
"""Least relaxation that is checked with `CHALLENGE`, since a hundredth of it must exceed the
feasibility tolerance."""

CHALLENGES = 8
"""Maximum number of checks with `CHALLENGE`; seven halvings reach one per cent."""

WIDEST = 2.0
"""Largest factor on a bound or dimension; with a larger factor it would be another actuator."""

_FREED = 1e9
"""Margin given up to ignore a requirement altogether; larger than any violation."""


@dataclass(frozen=True, slots=True)
class RelaxedConstraint:
    """A constraint and the margin (fraction of its limit) that must be given up.

    `amount` is None if the problem is infeasible even without this constraint.
    """

    constraint: str
    index: int
    amount: float | None


@dataclass(frozen=True, slots=True)
class Opening:
    """A bound of a variable; if it were wider, the limits would need less relaxation in total.

    Parameters
    ----------
    variable, index, side, value : the bound
    gain : decrease of the total relaxation per relative change of the bound
    needed : value of the bound that is enough if only this bound changes; None if no change up to
        the factor `WIDEST` is enough
    """

    variable: str
    index: int
    side: str
    value: float
    gain: float
    needed: float | None = None


def missed(evaluator: Evaluator, x: Vector, groups: Sequence[Indices]) -> list[float]:
    """For each group of constraints, the largest violation at a point."""
    rows = evaluator.point(evaluator.space.to_z(x)).rows[1 : 1 + evaluator.constraint_count]
    lacks = np.maximum(-np.nan_to_num(rows, nan=0.0), 0.0)
    return [float(lacks[group].max(initial=0.0)) for group in groups]


def by_limits(
    problem: BoxProblem,
    groups: Sequence[Indices],
    named: set[int],
    points: Sequence[Vector],
) -> tuple[RelaxedConstraint, ...]:
    """For each group of constraints, the relaxation that is enough if only this group is relaxed.

    Parameters
    ----------
    problem : the infeasible problem
    groups : indices of the constraints in each group
    named : groups to be searched from every point, each given by its first constraint
    points : starting points; the first is that of the least total relaxation
    """
    amounts: list[float | None] = []
    points_without = without_each(problem, groups, points[0])
    for number, (group, x) in enumerate(zip(groups, points_without, strict=True)):
        tell(
            "infeasible: searching for a requirement whose change makes the design feasible",
            number / len(groups),
        )
        if x is None:
            x = _without(problem, group, points if int(group[0]) in named else points[:1])
        amounts.append(None if x is None else _least_of_all(problem, group, x, points[1:]))
    amounts = _challenged(problem, groups, amounts, points)
    return tuple(
        RelaxedConstraint(problem.constraint_names[int(group[0])], int(group[0]), amount)
        for group, amount in zip(groups, amounts, strict=True)
    )


def _challenged(
    problem: BoxProblem,
    groups: Sequence[Indices],
    amounts: Sequence[float | None],
    points: Sequence[Vector],
) -> list[float | None]:
    """The relaxations, reduced wherever the share `CHALLENGE` of a relaxation is also enough.

    A descent may end too early, at a kink or in a shallow valley. Repeated halving then finds a
    smaller relaxation.
    """
    sufficient = {k: amount for k, amount in enumerate(amounts) if amount is not None}
    trials = {k: CHALLENGE * amount for k, amount in sufficient.items() if amount > FAINT}
    insufficient = dict.fromkeys(sufficient, 0.0)
    for _ in range(CHALLENGES):
        if not trials:
            break
        starts: dict[int, Vector | None] = dict.fromkeys(trials)
        for x in points:
            missing = [k for k in trials if starts[k] is None]
            ends = without_each(
                problem, [groups[k] for k in missing], x, [trials[k] for k in missing]
            )
            starts |= dict(zip(missing, ends, strict=True))
        for k, amount in trials.items():
            start = starts[k]
            if start is None:
                insufficient[k] = amount
                continue
            smaller, _ = _least(problem, groups[k], start)
            sufficient[k] = amount if smaller is None else min(amount, smaller)
        trials = {
            k: (insufficient[k] + sufficient[k]) / 2
            for k in trials
            if insufficient[k] < CHALLENGE * sufficient[k]
        }
    return [sufficient.get(k) for k in range(len(groups))]


def without_each(
    problem: BoxProblem,
    groups: Sequence[Indices],
    x: Vector,
    granted: Sequence[float] | None = None,
) -> list[Vector | None]:
    """For each group of constraints, a point that meets the constraints of all other groups.

    The violation of the group itself may be up to `granted`; None permits any violation. Where
    there is no such point, the result is None.
    """
    evaluator = Evaluator(problem)
    point = evaluator.point(evaluator.space.to_z(x))
    margins_granted = np.zeros((len(problem.constraint_names), len(groups)))
    for k, group in enumerate(groups):
        margins_granted[group, k] = _FREED if granted is None else granted[k]

    def evaluate(points: Array, margins: Array) -> PointValues:
        rows = problem.rows(points)
        m = len(problem.constraint_names)
        return PointValues(rows[0], rows[1 : 1 + m] + margins, rows[1 + m :])

    labels = problem.constraint_names
    parametric = ParametricProblem(problem, labels, np.zeros(len(labels)), evaluate)
    evaluator.check_gradients(point)
    if not groups or not applicable(parametric, evaluator):
        return [None] * len(groups)
    restored = ChangedProblems(parametric, evaluator, margins_granted).restore(point.z)
    return [None if z is None else evaluator.space.to_x(z[:, None])[:, 0] for z in restored]


def near(problem: BoxProblem, x: Vector) -> Vector | None:
    """A feasible point near x, or None."""
    return without_each(problem, [np.empty(0, dtype=np.intp)], x)[0]


def _without(problem: BoxProblem, group: Indices, points: Sequence[Vector]) -> Vector | None:
    """A point that meets all constraints except those of one group, or None."""
    m = len(problem.constraint_names)
    remaining = np.setdiff1d(np.arange(m), group)

    def evaluate(trial: Array) -> PointValues:
        rows = problem.rows(trial)
        return PointValues(rows[0], rows[1 : 1 + m][remaining], rows[1 + m :])

    names = tuple(problem.constraint_names[i] for i in remaining)
    slim = replace(problem, evaluate=evaluate, constraint_names=names, relaxable=None, groups=None)
    evaluator = Evaluator(slim)
    for x in points:
        start = evaluator.point(evaluator.space.to_z(x))
        end = least_missed(evaluator, start, start.violation / 4)
        if end.violation <= NOTHING:
            return end.x
    return None


def _least_of_all(
    problem: BoxProblem, group: Indices, x: Vector, points: Sequence[Vector]
) -> float | None:
    """The least relaxation of one group; tried from further points if a descent stalls."""
    amount, optimal = _least(problem, group, x)
    for point in points:
        if optimal:
            break
        start = _without(problem, group, [point])
        if start is not None:
            retried, optimal = _least(problem, group, start)
            amount = retried if amount is None else min(amount, retried or amount)
    return amount


def least(problem: BoxProblem, group: Indices, x: Vector) -> float | None:
    """The least relaxation of a group, near a point that meets the other groups; or None."""
    return _least(problem, group, x)[0]


def _least(problem: BoxProblem, group: Indices, x: Vector) -> tuple[float | None, bool]:
    """The result of `least`, and whether it is optimal."""
    lacks = missed(Evaluator(problem), x, [group])
    stretched = separate(problem, [group], [2.0 * max(*lacks, 0.5)])
    end = descend(stretched, x, lacks)
    if end.violation > NOTHING:
        return None, False
    residual = kkt.check(Evaluator(stretched), end, objective_scale=1.0).residual
    return float(end.objective), residual <= SETTLED


def by_bounds(problem: BoxProblem, bounds: Sequence[Opening], x: Vector) -> tuple[Opening, ...]:
    """The bounds, each with the value that is enough if only that bound changes."""
    result = []
    for number, bound in enumerate(bounds):
        tell(
            "infeasible: searching for a bound whose change makes the design feasible",
            number / len(bounds),
        )
        result.append(replace(bound, needed=_opened(problem, bound, x)))
    return tuple(result)


def _opened(problem: BoxProblem, bound: Opening, x: Vector) -> float | None:
    """The variable's value, as little beyond its bound as possible, that meets all requirements.

    None if there is no such value.
    """
    j, is_upper = bound.index, bound.side == "upper"
    if bound.value <= 0:
        return None
    lower_bounds, upper_bounds = problem.lower.copy(), problem.upper.copy()
    lower_bounds[j], upper_bounds[j] = (
        (bound.value, bound.value * WIDEST) if is_upper else (bound.value / WIDEST, bound.value)
    )

    def evaluate(points: Array) -> PointValues:
        rows = problem.rows(points)
        m = len(problem.constraint_names)
        return PointValues(points[j] if is_upper else -points[j], rows[1 : 1 + m], rows[1 + m :])

    opened = replace(problem, lower=lower_bounds, upper=upper_bounds, evaluate=evaluate, start=None)
    start = near(opened, x)
    if start is None:
        return None
    evaluator = Evaluator(opened)
    point = go(evaluator, evaluator.point(evaluator.space.to_z(start)))
    return float(point.x[j]) if point.violation <= NOTHING else None


@dataclass(frozen=True, slots=True)
class Conflict:
    """The requirements that conflict, and by how much.

    Parameters
    ----------
    joint : limits to relax together so that the total relaxation is least, the most relaxed first;
        empty if only laws conflict
    sole : for each conflicting requirement, the relaxation that is enough if only it is relaxed
    bounds : bounds of variables that are active at `x`, the most helpful first
    laws : constraints that cannot be relaxed but conflict with each other
    x : the point that is feasible once the limits in `joint` are relaxed
    total : sum of the relaxations in `joint`
    residual : residual of the optimality conditions of the least total relaxation, at `x`
    multipliers : decrease of the total per unit by which each constraint is relaxed (m,)
    """

    joint: tuple[RelaxedConstraint, ...]
    sole: tuple[RelaxedConstraint, ...]
    bounds: tuple[Opening, ...]
    laws: tuple[str, ...]
    x: Vector
    total: float
    residual: float
    multipliers: Vector
