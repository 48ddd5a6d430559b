"""Elastic problems: the same problem with constraints that may be missed at a price."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from ..numeric import Array
from .evaluator import Evaluator, Point
from .newton import polish
from .nlopt_wrapper import run
from .problem import Problem, Values, Vector

Indices: TypeAlias = npt.NDArray[np.intp]

FEASIBLE = 1e-6
"""Slack that counts as none."""


def common(problem: Problem, room: float) -> Problem:
    """Minimise one slack that every constraint and equality may be missed by."""
    m, e = len(problem.constraint_names), len(problem.equality_names)
    n = len(problem.names)

    def evaluate(x: Array) -> Values:
        rows = problem.rows(x[:n])
        slack = x[n]
        margins = [rows[1 : 1 + m] + slack]
        if e:
            margins += [slack - rows[1 + m :], slack + rows[1 + m :]]
        return Values(slack, np.concatenate(margins))

    names = tuple(str(i) for i in range(m + 2 * e))
    return _extended(problem, evaluate, ["slack"], room, names, ())


def separate(problem: Problem, groups: Sequence[Indices], room: Sequence[float]) -> Problem:
    """Minimise the sum of one slack per group of constraints; the others hold."""
    n, m = len(problem.names), len(problem.constraint_names)

    def evaluate(x: Array) -> Values:
        rows = problem.rows(x[:n])
        margins = np.array(rows[1 : 1 + m], dtype=np.result_type(rows, x))
        for slack, group in zip(x[n:], groups, strict=True):
            margins[group] = margins[group] + slack
        return Values(x[n:].sum(axis=0), margins, rows[1 + m :])

    names = [f"relax {problem.constraint_names[group[0]]}" for group in groups]
    return _extended(
        problem, evaluate, names, room, problem.constraint_names, problem.equality_names
    )


def _extended(
    problem: Problem,
    evaluate: Callable[[Array], Values],
    names: Sequence[str],
    room: float | Sequence[float],
    constraint_names: Sequence[str],
    equality_names: Sequence[str],
) -> Problem:
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
    problem = common(evaluator.problem, 2.0 * point.violation + 1.0)
    found, used = descend(problem, point.x, [point.violation])
    evaluator.evaluations += used
    evaluator.check_limits()
    if not found.valid or found.violation + found.objective > FEASIBLE:
        return None
    return evaluator.point(evaluator.space.to_z(found.x[: len(point.x)]))


def descend(problem: Problem, x: Vector, slack: Sequence[float]) -> tuple[Point, int]:
    """Solve an elastic problem from a point and slacks; also the evaluations used."""
    inner = Evaluator(problem)
    start = inner.point(inner.space.to_z(np.concatenate([x, np.asarray(slack, dtype=float)])))
    if not start.valid:
        return start, 1
    found = polish(inner, run(inner, start, "LD_SLSQP", most=400).point)
    return found, inner.evaluations
