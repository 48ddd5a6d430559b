"""Why nothing fits: what to relax together, what alone would do, which bounds stand in the way.

All amounts are margins, that is fractions of the limits. The smallest joint relaxation minimises
the sum of the margins given up (an elastic programme [Chinneck2008]), which names few
requirements rather than a little of each; constraints that are laws (geometry) are never relaxed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from . import elastic, kkt
from .evaluator import Evaluator, Point
from .problem import Problem, Values, Vector

NOTHING = 1e-6
"""A relaxation below this is none."""


@dataclass(frozen=True, slots=True)
class Relaxation:
    """A constraint and the margin (fraction of its limit) that must be given up.

    `amount` is None where giving up this constraint entirely would not be enough.
    """

    constraint: str
    index: int
    amount: float | None


@dataclass(frozen=True, slots=True)
class BindingBound:
    """A bound that holds back the joint relaxation.

    Parameters
    ----------
    variable, side, value : the bound
    gain : fall of the total relaxation per unit of relative widening of the bound (0.01 = 1 %)
    """

    variable: str
    side: str
    value: float
    gain: float


@dataclass(frozen=True, slots=True)
class Infeasibility:
    """Which requirements conflict, and by how much.

    Parameters
    ----------
    joint : the smallest joint relaxation, the largest first; empty where the laws alone conflict
    sole : for each requirement that takes part, what it would have to give up alone
    bounds : variable bounds that bind there, the most gainful first
    laws : constraints that cannot be relaxed and conflict among themselves
    x : the point that needs only the joint relaxation
    total : sum of the joint relaxation
    residual : optimality of the joint relaxation (small: it is the smallest near x)
    """

    joint: tuple[Relaxation, ...]
    sole: tuple[Relaxation, ...]
    bounds: tuple[BindingBound, ...]
    laws: tuple[str, ...]
    x: Vector
    total: float
    residual: float


def explain(problem: Problem, points: Sequence[Vector]) -> Infeasibility:
    """Explain why a problem has no feasible point.

    Parameters
    ----------
    problem : the problem, with `relaxable` telling wishes from laws (None: all are wishes)
    points : where to start, such as the least infeasible points found (n,)
    """
    m = len(problem.constraint_names)
    mask = np.ones(m, dtype=bool) if problem.relaxable is None else np.array(problem.relaxable)
    everything = _groups(problem)
    groups = [group for group in everything if mask[group].all()]
    found, evaluator = _smallest(problem, groups, points)
    laws: tuple[str, ...] = ()
    if found.violation > NOTHING and not mask.all():
        groups = everything
        found, evaluator = _smallest(problem, groups, points)
        amounts = found.x[len(problem.names) :]
        laws = tuple(
            problem.constraint_names[group[0]]
            for group, amount in zip(groups, amounts, strict=True)
            if not mask[group].all() and amount > NOTHING
        )
    n = len(problem.names)
    x, amounts = found.x[:n], found.x[n:]
    quality = kkt.check(evaluator, found, objective_scale=1.0)
    joint = [
        _relaxation(problem, group, float(amount))
        for group, amount in zip(groups, amounts, strict=True)
        if amount > NOTHING and mask[group].all()
    ]
    joint.sort(key=lambda r: -(r.amount or 0.0))
    sole: tuple[Relaxation, ...] = ()
    if not laws:
        part = quality.multipliers > 1e-7 if quality.unique else np.ones(m, dtype=bool)
        sole = tuple(
            _alone(problem, groups, i, x) for i, group in enumerate(groups) if part[group].any()
        )
    return Infeasibility(
        tuple(joint),
        sole,
        _bounds(problem, evaluator, quality),
        laws,
        x,
        float(found.objective),
        quality.residual,
    )


def _groups(problem: Problem) -> list[elastic.Indices]:
    """Rows of the constraints that are relaxed together."""
    m = len(problem.constraint_names)
    numbers = np.arange(m) if problem.groups is None else np.asarray(problem.groups)
    return [np.flatnonzero(numbers == number) for number in dict.fromkeys(numbers.tolist())]


def _relaxation(problem: Problem, group: elastic.Indices, amount: float | None) -> Relaxation:
    first = int(group[0])
    return Relaxation(problem.constraint_names[first], first, amount)


def _smallest(
    problem: Problem, groups: list[elastic.Indices], points: Sequence[Vector]
) -> tuple[Point, Evaluator]:
    """Return the smallest sum of slacks of the groups, from the best of several points."""
    best: Point | None = None
    judge = Evaluator(problem)
    room, starts = 1.0, []
    for x in list(points)[:2] or [(problem.lower + problem.upper) / 2]:
        rows = judge.point(judge.space.to_z(x)).rows[1 : 1 + len(problem.constraint_names)]
        missed = np.maximum(-np.nan_to_num(rows, nan=0.0), 0.0)
        room = max(room, 2.0 * float(missed.max(initial=0.0)))
        starts.append((x, [float(missed[group].max()) for group in groups]))
    stretched = elastic.separate(problem, groups, [room] * len(groups))
    for x, lacks in starts:
        found, _ = elastic.descend(stretched, x, lacks)
        key = (max(found.violation - NOTHING, 0.0), found.objective)
        if best is None or key < (max(best.violation - NOTHING, 0.0), best.objective):
            best = found
    assert best is not None
    return best, Evaluator(stretched)


def _alone(problem: Problem, groups: list[elastic.Indices], index: int, x: Vector) -> Relaxation:
    """Return what one group alone must give up; None where that is not enough."""
    group = groups[index]
    others, kept = _without(problem, group)
    rest, _ = _smallest(others, [kept[g] for i, g in enumerate(groups) if i != index], [x])
    if rest.violation > NOTHING or rest.objective > NOTHING:
        return _relaxation(problem, group, None)
    found, _ = _smallest(problem, [group], [rest.x[: len(problem.names)]])
    enough = found.violation <= NOTHING
    return _relaxation(problem, group, float(found.objective) if enough else None)


def _without(problem: Problem, group: elastic.Indices) -> tuple[Problem, elastic.Indices]:
    """Leave a group of constraints out; also the new index of every old row."""
    m = len(problem.constraint_names)
    kept = np.setdiff1d(np.arange(m), group)
    places = np.full(m, -1, dtype=np.intp)
    places[kept] = np.arange(len(kept))

    def evaluate(points: np.ndarray) -> Values:
        rows = problem.rows(points)
        return Values(rows[0], rows[1 : 1 + m][kept], rows[1 + m :])

    names = tuple(problem.constraint_names[i] for i in kept)
    slim = replace(problem, evaluate=evaluate, constraint_names=names, relaxable=None, groups=None)
    return slim, places


def _bounds(problem: Problem, evaluator: Evaluator, quality: kkt.Kkt) -> tuple[BindingBound, ...]:
    found = []
    space = evaluator.space
    for k, j in enumerate(space.free):
        if j >= len(problem.names):
            continue
        for side, held, limit in (
            ("lower", quality.lower_multipliers[j], problem.lower[j]),
            ("upper", quality.upper_multipliers[j], problem.upper[j]),
        ):
            if held > 1e-7:
                widening = 1.0 if space.logarithmic[k] else abs(limit) / space.scale[k]
                name = problem.names[j]
                found.append(BindingBound(name, side, float(limit), float(held * widening)))
    return tuple(sorted(found, key=lambda b: -b.gain))
