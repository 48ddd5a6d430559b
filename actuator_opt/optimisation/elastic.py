"""Elastic problems: the same problem with constraints that may be violated at a price."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from ..base.numeric import Array
from .evaluator import Evaluator, Point
from .kkt import polish
from .nlopt_wrapper import run
from .problem import BoxProblem, Values, Vector

Indices: TypeAlias = npt.NDArray[np.intp]

FEASIBLE = 1e-6
"""Slack that counts as zero."""

MOST = 200
"""Maximum evaluations of one descent; 10 to 50 usually suffice."""

FINE = 1e-7
"""Relative tolerance of a descent before it is polished."""

EXACT = 1e-9
"""Optimality at which further polishing does not pay."""

ROUGH = 1e-5
"""Relative tolerance of a descent that only tests whether a start is promising."""


def common(problem: BoxProblem, room: float) -> BoxProblem:
    """Minimise one slack shared by every constraint and equality."""
    m, e = len(problem.constraint_names), len(problem.equality_names)
    n = len(problem.names)

    def evaluate(x: Array) -> Values:
        rows = _rows_once(problem, x[:n])
        slack = x[n]
        margins = [rows[1 : 1 + m] + slack]
        if e:
            margins += [slack - rows[1 + m :], slack + rows[1 + m :]]
        return Values(slack, np.concatenate(margins))

    names = tuple(str(i) for i in range(m + 2 * e))
    return _extended(problem, evaluate, ["slack"], room, names, ())


def separate(problem: BoxProblem, groups: Sequence[Indices], room: Sequence[float]) -> BoxProblem:
    """Minimise the sum of one slack per group of constraints; all others must be met."""
    n, m = len(problem.names), len(problem.constraint_names)

    def evaluate(x: Array) -> Values:
        rows = _rows_once(problem, x[:n])
        margins = np.array(rows[1 : 1 + m], dtype=np.result_type(rows, x))
        for slack, group in zip(x[n:], groups, strict=True):
            margins[group] = margins[group] + slack
        return Values(x[n:].sum(axis=0), margins, rows[1 + m :])

    names = [f"relax {problem.constraint_names[group[0]]}" for group in groups]
    return _extended(
        problem, evaluate, names, room, problem.constraint_names, problem.equality_names
    )


def _rows_once(problem: BoxProblem, points: Array) -> npt.NDArray[np.generic]:
    """Rows of points (n, k) of which many differ only in slacks; the model evaluates each once."""
    columns = np.ascontiguousarray(points.T)
    first: dict[bytes, int] = {}
    places = [first.setdefault(column.tobytes(), len(first)) for column in columns]
    if len(first) == len(columns):
        return problem.rows(points)
    _, kept = np.unique(places, return_index=True)
    return problem.rows(points[:, kept])[:, places]


def _extended(
    problem: BoxProblem,
    evaluate: Callable[[Array], Values],
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
    """Return a feasible point near `point`, by minimising one common slack, or None."""
    if point.violation <= FEASIBLE:
        return point
    found = least_missed(evaluator, point)
    return found if found.violation <= FEASIBLE else None


def least_missed(evaluator: Evaluator, point: Point, rough: float = np.inf) -> Point:
    """Minimise the worst violation near a point; a feasible point is returned unchanged.

    A result that violates more than `rough` is not polished, which halves the effort.
    """
    inner = Evaluator(common(evaluator.problem, 2.0 * point.violation + 1.0))
    start = found = inner.point(inner.space.to_z(np.append(point.x, point.violation)))
    if not start.valid:
        return point
    inner.eager = True
    if rough < np.inf:
        found = run(inner, start, "LD_SLSQP", tolerance=ROUGH, most=MOST, rank=_miss).point
    if _miss(found) <= rough:
        led = run(inner, found, "LD_SLSQP", tolerance=FINE, most=MOST, rank=_miss)
        found = min((led.point, finish(inner, led.point)), key=_miss)
    evaluator.evaluations += inner.evaluations
    evaluator.check_limits()
    end = evaluator.point(evaluator.space.to_z(found.x[: len(point.x)]))
    return end if end.valid and end.violation < point.violation else point


def _miss(point: Point) -> float:
    """The worst violation at a point of a common slack; the slack covers what is violated."""
    return point.objective + point.violation if point.valid else np.inf


def descend(
    problem: BoxProblem, x: Vector, slack: Sequence[float], known: Sequence[Point] = ()
) -> Point:
    """Solve an elastic problem from a point and slacks, unless it reaches a known result."""
    inner = Evaluator(problem)
    start = inner.point(inner.space.to_z(np.concatenate([x, np.asarray(slack, dtype=float)])))
    if not start.valid:
        return start
    led = run(inner, start, "LD_SLSQP", tolerance=FINE, most=MOST, known=known)
    return known[led.arrived] if led.arrived is not None else finish(inner, led.point)


def go(evaluator: Evaluator, start: Point) -> Point:
    """Run one descent and polish the result."""
    return finish(evaluator, run(evaluator, start, "LD_SLSQP", tolerance=FINE, most=MOST).point)


def finish(evaluator: Evaluator, point: Point) -> Point:
    """Polish a descent to `EXACT`."""
    return polish(evaluator, point, tolerance=EXACT)
