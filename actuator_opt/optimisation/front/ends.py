"""The ends of a front: the best design of each objective alone.

All objectives are searched together: one sweep of the box, and one model call per step of all runs.
Ties are resolved in favour of the other objectives.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ...base.numeric import Array
from ..descents import FEASIBLE, RESIDUAL
from ..evaluator import Evaluator, Point
from ..outcome import Solution
from ..problem import Values, Vector
from ..resolve.parallel_descents import converged_from, descents_from, distinct_ends
from ..sampling import Sweep, distinct, sweep
from ..solver import solve
from .objectives import Objectives
from .tracer import Start, Tracer

HOLD = 1e-10
"""Share of its range by which an anchor's objective may worsen while the others improve."""

GAINED = 1e-3
"""Normalised gain of the others that justifies this."""

CONFLICT = 1e-6
"""Range below this share of the magnitude means that the objective does not vary."""


ROUGH = 16
"""Points of an SLSQP run after which steps with the Hessian take over."""


@dataclass(frozen=True)
class Effort:
    """Search effort: starts and sweep samples per objective, and the seed."""

    starts: int
    samples: int
    seed: int


@dataclass(frozen=True)
class Ends:
    """The anchors (n, objectives), and all feasible local optima (n, k)."""

    x: Vector
    others: Vector


class NoEnd(NamedTuple):
    """A failed search for the best of one objective, and the objective's number."""

    objective: int
    solution: Solution


def ends(objectives: Objectives, checked: Evaluator, effort: Effort) -> Ends | NoEnd:
    """The best design of each objective; the failed search if there is none."""
    optima = [[] for _ in range(objectives.count)] if not checked.exact else _together(
        objectives, checked, effort
    )  # fmt: skip
    known = [x for found in optima for x in found]
    values = objectives.values(np.stack(known, axis=1)) if known else np.empty((len(optima), 0))
    best: list[Vector] = []
    for index, found in enumerate(optima):
        own, first = values[index], sum(len(some) for some in optima[:index])
        size = CONFLICT * np.abs(own).max(initial=0.0)
        if found and own[first] <= own.min() + size:
            best.append(found[0])
            continue
        alone = solve(
            objectives.alone(index),
            starts=effort.starts, samples=effort.samples, seed=effort.seed, more_starts=known,
        )  # fmt: skip
        if alone.violation > FEASIBLE or alone.kkt is None or alone.kkt.residual > RESIDUAL:
            return NoEnd(index, alone)
        best.append(alone.x)
        known += [one.x for one in alone.optima if one.violation <= FEASIBLE]
    return Ends(np.stack(best, axis=1), np.stack(known, axis=1))


def _together(objectives: Objectives, checked: Evaluator, effort: Effort) -> list[list[Vector]]:
    """Local optima of each objective, best first, from simultaneous runs."""
    objectives = replace(objectives, evaluate=_remembering(objectives.evaluate))
    evaluators = [objectives.like(checked, k) for k in range(objectives.count)]
    swept = [sweep(one, effort.samples, effort.seed) for one in evaluators]
    starts = [_starts(*pair, effort.starts) for pair in zip(evaluators, swept, strict=True)]
    which = np.arange(objectives.count, dtype=float)[None]
    picked = objectives.picked()
    ended = descents_from(picked, evaluators, which, starts, effort.seed, rounds=ROUGH)
    ended = [distinct_ends(points) for points in ended]
    settled = converged_from(picked, evaluators, which, ended)
    return [_optima(*pair) for pair in zip(ended, settled, strict=True)]


def _remembering(evaluate: Callable[[Array], Values]) -> Callable[[Array], Values]:
    """The same function with the last real points cached, as all objectives sweep the same ones."""
    last: dict[bytes, Values] = {}

    def remembered(points: Array) -> Values:
        if np.iscomplexobj(points):
            return evaluate(points)
        key = np.asarray(points).tobytes()
        if key not in last:
            values = evaluate(points)
            last.clear()
            last[key] = values
        return last[key]

    return remembered


def _starts(evaluator: Evaluator, swept: Sweep, wanted: int) -> list[Vector]:
    """Coordinates of the problem's own start and of the best distinct points of the sweep."""
    own = evaluator.problem.start
    given = [] if own is None else [evaluator.space.to_z(own)]
    return given + distinct(evaluator, swept.z, max(wanted - len(given), 1))


def _optima(ended: Sequence[Point], settled: Sequence[Point | None]) -> list[Vector]:
    """Distinct optima, best first; empty if an unfinished run may be better."""
    good = sorted((one for one in settled if one is not None), key=lambda one: one.objective)
    open_ = [
        p.objective for p, one in zip(ended, settled, strict=True)
        if one is None and p.violation <= FEASIBLE
    ]  # fmt: skip
    if not good or min(open_, default=np.inf) < good[0].objective:
        return []
    return [one.x for one in distinct_ends(good)]


def normalised(objectives: Objectives, checked: Evaluator, found: Ends) -> tuple[Tracer, Vector]:
    """The anchors (n, k) with their normalisation; a single one without a conflict."""
    x = found.x
    every = objectives.values(np.concatenate([found.others, x], axis=1))
    values, magnitude = every[:, -x.shape[1] :], np.abs(every).max(axis=1)
    magnitude = np.where(magnitude > 0, magnitude, 1.0)
    tracer: Tracer | None = None
    while True:
        ideal, width = values.min(axis=1), np.ptp(values, axis=1)
        best = (values - ideal[:, None] <= (CONFLICT * magnitude)[:, None]).all(axis=0)
        if best.any():
            x, width = x[:, [int(np.argmax(best))]], magnitude
        width = np.where(width <= CONFLICT * magnitude, magnitude, width)
        if tracer is not None or best.any():
            break
        tracer = Tracer(objectives, ideal, width, checked)
        x = _sharpened(tracer, x, tracer.normal(values))
        values = objectives.values(x)
    if tracer is None:
        tracer = Tracer(objectives, ideal, width, checked)
    else:
        tracer.rescale(ideal, width)
    return tracer, x


def _sharpened(tracer: Tracer, x: Vector, units: Vector) -> Vector:
    """The anchors (n, k), moved where others improve without a loss of their own objective."""
    count = len(x.T)
    starts = []
    for k in range(count):
        level, way = np.zeros(count), np.ones(count)
        level[k], way[k] = units[k, k] + HOLD, 0.0
        z = tracer.from_x(x[:, k], float(np.delete(units[:, k], k).max()))
        starts.append(Start(level, way, z, np.eye(len(z))))
    moved = x.copy()
    for k, (one, start) in enumerate(zip(tracer.solve(starts), starts, strict=True)):
        before = start.z[-1] * tracer.scale
        if one is not None and one.point.objective < before - GAINED:
            moved[:, k] = one.point.x[:-1]
    return moved
