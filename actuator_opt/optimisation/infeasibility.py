"""Explains why a problem is infeasible: relaxed limits, sufficient changes, binding bounds.

All amounts are margins, as fractions of the limits. The least total relaxation makes the problem
feasible with the least sum of margins given up (an elastic programme [Chinneck2008]). The sum
favours a large relaxation of few requirements over a small relaxation of many. Physical laws
(geometry) are never relaxed. All searches are local and start from the given points. Their remedies
are valid, but others may exist.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from ..base.dataclass import dataclass
from ..base.progress import tell
from . import kkt, repairs
from .evaluator import Evaluator, Point
from .problem import BoxProblem, Vector
from .repairs import NOTHING, Opening, RelaxedConstraint

STARTS = 2
"""Maximum number of starts in the search for the least total relaxation of all limits."""

ROOM = 1.001
"""A limit is relaxed by this multiple of the least sufficient relaxation."""


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


def explain(problem: BoxProblem, points: Sequence[Vector]) -> Conflict:
    """Explain why a problem has no feasible point.

    Parameters
    ----------
    problem : the problem; `relaxable` separates requirements from laws (None: all relaxable)
    points : starting points (n,), such as the least infeasible points of a search
    """
    tell("infeasible: searching for the smallest relaxation")
    m = len(problem.constraint_names)
    mask = np.ones(m, dtype=bool) if problem.relaxable is None else np.array(problem.relaxable)
    all_groups = _groups(problem)
    groups = [group for group in all_groups if mask[group].all()]
    point, evaluator = _smallest(problem, groups, points)
    laws: tuple[str, ...] = ()
    if point.violation > NOTHING and not mask.all():
        groups = all_groups
        point, evaluator = _smallest(problem, groups, points)
        amounts = point.x[len(problem.names) :]
        laws = tuple(
            problem.constraint_names[group[0]]
            for group, amount in zip(groups, amounts, strict=True)
            if not mask[group].all() and amount > NOTHING
        )
    quality = kkt.check(evaluator, point, objective_scale=1.0)
    joint = _joint(problem, groups, mask, point)
    sole: tuple[RelaxedConstraint, ...] = ()
    x = point.x[: len(problem.names)]
    if joint and not laws:
        part = _conflicting(evaluator, point, quality)
        named = {row.index for row in joint}
        candidates = [group for group in groups if part[group].any() or group[0] in named]
        sole = repairs.by_limits(problem, candidates, named, [x, *points[:STARTS]])
        smaller = _smaller_relaxation(problem, evaluator, groups, candidates, sole, point)
        if smaller is not None:
            point, quality = smaller, kkt.check(evaluator, smaller, objective_scale=1.0)
            joint, x = _joint(problem, groups, mask, point), point.x[: len(problem.names)]
    openings = _binding_bounds(problem, evaluator, quality)
    if joint and not laws:
        openings = repairs.by_bounds(problem, openings, x)
    return Conflict(
        joint, sole, openings, laws, x, float(point.objective), quality.residual,
        quality.multipliers,
    )  # fmt: skip


def _joint(
    problem: BoxProblem,
    groups: list[repairs.Indices],
    mask: npt.NDArray[np.bool_],
    point: Point,
) -> tuple[RelaxedConstraint, ...]:
    """The relaxations (slacks) at a point of the relaxed problem, largest first."""
    amounts = point.x[len(problem.names) :]
    joint = [
        RelaxedConstraint(problem.constraint_names[group[0]], int(group[0]), float(amount))
        for group, amount in zip(groups, amounts, strict=True)
        if amount > NOTHING and mask[group].all() and point.violation <= NOTHING
    ]
    return tuple(sorted(joint, key=lambda r: -(r.amount or 0.0)))


def _smaller_relaxation(
    problem: BoxProblem,
    evaluator: Evaluator,
    groups: list[repairs.Indices],
    candidates: list[repairs.Indices],
    sole: Sequence[RelaxedConstraint],
    point: Point,
) -> Point | None:
    """A relaxation of one limit alone, less than the total found for all limits; or None.

    Such a relaxation exists only if the descent to the least total relaxation stalled.
    """
    single = [(r.amount, group) for r, group in zip(sole, candidates, strict=True) if r.amount]
    amount, group = min(single, key=lambda entry: entry[0], default=(np.inf, groups[0]))
    if amount >= point.objective - NOTHING:
        return None
    x = point.x[: len(problem.names)]
    start = repairs.without_each(problem, [group], x, [ROOM * amount])[0]
    if start is None:
        return None
    lacks = repairs.missed(Evaluator(problem), start, groups)
    end = repairs.descend(evaluator.problem, start, lacks)
    improved = end.violation <= NOTHING and end.objective < point.objective
    return end if improved else None


def _conflicting(
    evaluator: Evaluator, point: Point, quality: kkt.KktResidual
) -> npt.NDArray[np.bool_]:
    """Mask of the constraints that conflict with each other even if all others are dropped.

    The multipliers of the relaxation prove this locally, and globally for a convex problem. If the
    relaxation is not optimal, every active constraint counts as a possible cause.
    """
    if quality.residual <= NOTHING:
        return np.asarray(quality.multipliers > 1e-7)
    return point.rows[1 : 1 + evaluator.constraint_count] <= kkt.ACTIVE


def _groups(problem: BoxProblem) -> list[repairs.Indices]:
    """Indices of the constraints, grouped by the limit to which they belong."""
    m = len(problem.constraint_names)
    numbers = np.arange(m) if problem.groups is None else np.asarray(problem.groups)
    return [np.flatnonzero(numbers == number) for number in dict.fromkeys(numbers.tolist())]


def _smallest(
    problem: BoxProblem, groups: list[repairs.Indices], points: Sequence[Vector]
) -> tuple[Point, Evaluator]:
    """The point with the smallest sum of relaxations, from several starts, and its evaluator."""
    judge = Evaluator(problem)
    room, starts = 1.0, []
    for x in list(points)[:STARTS] or [(problem.lower + problem.upper) / 2]:
        lacks = repairs.missed(judge, x, groups)
        room = max(room, 2.0 * max(lacks, default=0.0))
        starts.append((x, lacks))
    stretched = repairs.separate(problem, groups, [room] * len(groups))
    ends: list[Point] = []
    for x, lacks in starts:
        elastic_end = repairs.descend(stretched, x, lacks, ends)
        if elastic_end.valid and not any(elastic_end is end for end in ends):
            ends.append(elastic_end)
    smallest = min(ends, key=lambda end: (max(end.violation - NOTHING, 0.0), end.objective))
    return smallest, Evaluator(stretched)


def _binding_bounds(
    problem: BoxProblem, evaluator: Evaluator, quality: kkt.KktResidual
) -> tuple[Opening, ...]:
    """Bounds which, if wider, would decrease the total relaxation; the most helpful first."""
    openings = []
    space = evaluator.space
    for k, j in enumerate(space.free):
        if j >= len(problem.names):
            continue
        for side, multiplier, limit in (
            ("lower", quality.lower_multipliers[j], problem.lower[j]),
            ("upper", quality.upper_multipliers[j], problem.upper[j]),
        ):
            if multiplier > 1e-7:
                widening = 1.0 if space.logarithmic[k] else abs(limit) / space.scale[k]
                openings.append(
                    Opening(
                        problem.names[j], int(j), side, float(limit), float(multiplier * widening)
                    )
                )
    return tuple(sorted(openings, key=lambda b: -b.gain))
