"""Independent full searches at some levels, for designs that were overlooked."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..descents import FEASIBLE
from ..evaluator import Evaluator, Point
from ..problem import Vector
from ..resolve.parallel_descents import converged_from, descents_from, distinct_ends
from ..sampling import KEEP, Halton, distinct
from ..solver import solve
from .ends import Effort
from .tracer import Design, Tracer

OVERLOOKED = 1e-6
"""Normalised level by which a search must improve."""

TOLERANCE = 1e-7
"""Relative change of level and variables that ends a run."""

ROUNDS = 24
"""Maximum points of a run; if no design is feasible by then, other steps take over."""


def better(tracer: Tracer, designs: Sequence[Design], effort: Effort) -> list[Vector]:
    """Variables (n,) of better designs at the levels of some designs on the front."""
    reached: list[list[Point]] = [[] for _ in designs]
    if tracer.exact and designs:
        reached = _reached(tracer, designs, effort)
    found = []
    for number, (one, points) in enumerate(zip(designs, reached, strict=True)):
        ends = [(point.objective, point.x) for point in points]
        if not ends:
            best = solve(
                tracer.at(one.level, one.way),
                starts=effort.starts, samples=effort.samples, seed=effort.seed + number,
            )  # fmt: skip
            ends = [(best.objective, best.x)] if best.violation <= FEASIBLE else []
        level, x = min(ends, key=lambda pair: pair[0], default=(np.inf, one.point.x))
        if level < one.point.objective - OVERLOOKED:
            found.append(x[:-1])
    return found


def _reached(tracer: Tracer, designs: Sequence[Design], effort: Effort) -> list[list[Point]]:
    """Feasible points reached by runs, separately for each level."""
    evaluators = [tracer.like(tracer.at(one.level, one.way)) for one in designs]
    parameters = np.stack([np.concatenate([one.level, one.way]) for one in designs], axis=1)
    given = tracer.parametric, evaluators, parameters
    starts = _starts(tracer, designs, effort)
    ended = descents_from(*given, starts, effort.seed, tolerance=TOLERANCE, rounds=ROUNDS)
    met = [[point for point in points if point.violation <= FEASIBLE] for points in ended]
    rest = [[] if good else distinct_ends(points) for good, points in zip(met, ended, strict=True)]
    settled = converged_from(*given, rest)
    return [
        [*good, *(point for point in more if point is not None)]
        for good, more in zip(met, settled, strict=True)
    ]


def _starts(tracer: Tracer, designs: Sequence[Design], effort: Effort) -> list[list[Vector]]:
    """Coordinates for each level: the problem's own start, and the best of one shared sweep."""
    inner = Evaluator(tracer.objectives.alone(0))
    space, own = inner.space, tracer.objectives.problem.start
    cube = Halton(space.size, effort.seed, most=max(2, effort.samples)).points(0, effort.samples)
    z = space.lower[:, None] + (space.upper - space.lower)[:, None] * cube
    if own is not None:
        z = np.concatenate([space.to_z(own)[:, None], z], axis=1)
    rows = tracer.evaluator.batch(np.concatenate([z, np.zeros((1, z.shape[1]))]))
    first = 1 + len(tracer.objectives.problem.constraint_names)
    units = -rows[first : first + tracer.objectives.count]
    margins = np.delete(rows, range(first, first + tracer.objectives.count), axis=0)
    missed = inner.violations(margins, "sum")
    missed = np.where(np.isfinite(units).all(axis=0), missed, np.inf)
    result = []
    for one in designs:
        t = ((units - one.level[:, None]) / one.way[:, None]).max(axis=0)
        order = np.lexsort((t, missed))
        order = order[np.isfinite(missed[order]) & (order >= (own is not None))][:KEEP]
        begun = [] if own is None else [tracer.to_t(np.append(z[:, 0], 0.0), float(t[0]))]
        places = {z[:, k].tobytes(): float(t[k]) for k in order}
        for at in distinct(inner, z[:, order], max(effort.starts - len(begun), 1)):
            begun.append(tracer.to_t(np.append(at, 0.0), places[at.tobytes()]))
        result.append(begun)
    return result
