"""Searches of several problems that differ in parameters: a model call serves a step of all."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from .. import kkt, lockstep
from ..descents import LOCAL_EVALUATIONS
from ..evaluator import Evaluator, Point
from ..nlopt_wrapper import ARRIVAL
from ..problem import ParametricProblem, Vector
from ..side_by_side import ROUNDS, Task, run_together
from .curvature import hessians

FIRST = 14
"""Most steps with the curvature, but where none has led to an optimum yet."""


def runs_from(
    parametric: ParametricProblem,
    evaluators: Sequence[Evaluator],
    parameters: Vector,
    starts: Sequence[Sequence[Vector]],
    seed: int,
    *,
    tolerance: float = 1e-9,
    rounds: int = ROUNDS,
) -> list[list[Point]]:
    """Where runs of SLSQP lead, for each problem from each of its starts.

    Parameters
    ----------
    parametric : the problems
    evaluators : one of each problem, with exact gradients
    parameters : of each problem (q, k)
    starts : coordinates (nf,) for each problem
    seed, tolerance, rounds : of the runs, see `run_together`
    """

    def rows(
        batch: npt.NDArray[np.complex128], owners: npt.NDArray[np.intp]
    ) -> npt.NDArray[np.generic]:
        return parametric.with_columns(parameters[:, owners]).rows(batch)

    if not any(starts):
        return [[] for _ in evaluators]
    places = [(k, z) for k, some in enumerate(starts) for z in some]
    parts = [evaluators[k].columns(z[:, None]) for k, z in places]
    owners = np.repeat([k for k, _ in places], parts[0].shape[1]).astype(np.intp)
    found = np.split(rows(np.concatenate(parts, axis=1), owners), len(parts), axis=1)
    tasks = [Task(one, []) for one in evaluators]
    for (k, z), part in zip(places, found, strict=True):
        point = evaluators[k].entered(z, part)
        if point.valid:
            tasks[k].starts.append(point)
    return run_together(
        tasks, rows, seed=seed, most=LOCAL_EVALUATIONS, tolerance=tolerance, rounds=rounds
    )


def settled_from(
    parametric: ParametricProblem,
    evaluators: Sequence[Evaluator],
    parameters: Vector,
    begun: Sequence[Sequence[Point]],
) -> list[list[Point | None]]:
    """The optimum that each point leads to by steps with the curvature there; None where to none.

    Parameters
    ----------
    parametric, evaluators, parameters : as of `runs_from`
    begun : points of each problem with their gradients
    """
    ways: list[lockstep.Descent] = []
    for one, points in zip(evaluators, begun, strict=True):
        some = [_way(one, point, np.eye(one.space.size)) for point in points]
        for way, point in zip(some, points, strict=True):
            way.go_on(one, point)
        ways += [_way(one, *p) for p in zip(points, hessians(one, some), strict=True)]
    if not ways:
        return [[] for _ in begun]
    owners = np.repeat(np.arange(len(begun)), [len(points) for points in begun])
    own = parameters[:, owners]
    z = np.stack([point.z for points in begun for point in points], axis=1)
    found = lockstep.descend(parametric, evaluators[0], ways, z, own, FIRST)
    done = {owner for owner, point in zip(owners, found, strict=True) if point is not None}
    left = [k for k, owner in enumerate(owners) if owner not in done and ways[k].point is not None]
    if left:
        some = [ways[k] for k in left]
        z = np.stack([way.known.z + way.step for way in some], axis=1)
        more = lockstep.descend(parametric, evaluators[0], some, z, own[:, left])
        for k, reached in zip(left, more, strict=True):
            found[k] = reached
    every = iter(found)
    return [[next(every) for _ in points] for points in begun]


def _way(evaluator: Evaluator, point: Point, hessian: Vector) -> lockstep.Descent:
    """A descent from a point, with a Hessian of its own."""
    scale = kkt.slope_scale(evaluator, point)
    return lockstep.Descent(hessian, scale, evaluator.constraint_count, 1.0)


def apart(points: Sequence[Point]) -> list[Point]:
    """Those ends of runs that are not near a better one, the best first."""
    kept: list[Point] = []
    for one in sorted(points, key=lambda p: (p.violation > ARRIVAL[2], p.objective)):
        if not any(_near(one, known) for known in kept):
            kept.append(one)
    return kept


def _near(point: Point, known: Point) -> bool:
    """Whether a run would count as arrived there."""
    reach, share, _ = ARRIVAL
    alike = abs(point.objective - known.objective) <= share * abs(known.objective)
    return alike and bool(np.abs(point.z - known.z).max(initial=0.0) <= reach)
