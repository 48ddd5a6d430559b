"""The Pareto front from its anchors, evenly spread and checked for merely local designs.

The best design of each objective alone is searched for like any optimum. Designs at levels between
these anchors are found from their neighbours, in shared steps. Each is compared with all others at
its own levels, which reveals and replaces merely local designs. Independent full searches at some
levels then check whether a better one was overlooked.

The final designs of a front: evenly spread, with wide gaps closed or explained.

The levels limit the length of a continuous front between two designs. If close levels lead to
distant designs, the front jumps and no design lies between.

The ends of a front: the best design of each objective alone.

All objectives are searched together: one sweep of the box, and one model call per step of all runs.
Ties are resolved in favour of the other objectives.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ...base.numeric import Array
from ...base.progress import tell
from ..actuator import Solution
from ..evaluator import Evaluator, Point
from ..problem import PointValues, Vector
from ..resolve.parallel_descents import (
    FEASIBLE,
    RESIDUAL,
    converged_from,
    descents_from,
    distinct_ends,
)
from ..solver import KEEP, Halton, Sweep, distinct, solve, sweep
from . import tracer
from .objectives import Conditions, Objectives
from .plane import FrontGap, chosen, close, fill_line, fill_plane, lost, middles, wide
from .tracer import FrontDesign, FrontSearch, FrontStart, Tracer, knee, nondominated

HOLD = 1e-10
"""Share of its range by which an anchor's objective may worsen while the others improve."""
GAINED = 1e-3
"""Normalised gain of the others that justifies this."""
CONFLICT = 1e-6
"""Range below this share of the magnitude means that the objective does not vary."""
ROUGH = 16
"""Points of an SLSQP run after which steps with the Hessian take over."""


@dataclass(frozen=True)
class FrontEffort:
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


def ends(objectives: Objectives, checked: Evaluator, effort: FrontEffort) -> Ends | NoEnd:
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


def _together(
    objectives: Objectives, checked: Evaluator, effort: FrontEffort
) -> list[list[Vector]]:
    """Local optima of each objective, best first, from simultaneous runs."""
    objectives = replace(objectives, evaluate=_remembering(objectives.evaluate))
    evaluators = [objectives.like(checked, k) for k in range(objectives.count)]
    swept = [sweep(evaluator, effort.samples, effort.seed) for evaluator in evaluators]
    starts = [_starts(*pair, effort.starts) for pair in zip(evaluators, swept, strict=True)]
    which = np.arange(objectives.count, dtype=float)[None]
    picked = objectives.picked()
    ended = descents_from(picked, evaluators, which, starts, effort.seed, rounds=ROUGH)
    ended = [distinct_ends(points) for points in ended]
    settled = converged_from(picked, evaluators, which, ended)
    return [_optima(*pair) for pair in zip(ended, settled, strict=True)]


def _remembering(evaluate: Callable[[Array], PointValues]) -> Callable[[Array], PointValues]:
    """The same function with the last real points cached, as all objectives sweep the same ones."""
    last: dict[bytes, PointValues] = {}

    def remembered(points: Array) -> PointValues:
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
    return [distinct_end.x for distinct_end in distinct_ends(good)]


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
        starts.append(FrontStart(level, way, z, np.eye(len(z))))
    moved = x.copy()
    for k, (one, start) in enumerate(zip(tracer.solve(starts), starts, strict=True)):
        before = start.z[-1] * tracer.scale
        if one is not None and one.point.objective < before - GAINED:
            moved[:, k] = one.point.x[:-1]
    return moved


OVERLOOKED = 1e-6
"""Normalised level by which a search must improve."""
TOLERANCE = 1e-7
"""Relative change of level and variables that ends a run."""
ROUNDS = 24
"""Maximum points of a run; if no design is feasible by then, other steps take over."""


def better(tracer: Tracer, designs: Sequence[FrontDesign], effort: FrontEffort) -> list[Vector]:
    """Variables (n,) of better designs at the levels of some designs on the front."""
    reached: list[list[Point]] = [[] for _ in designs]
    if tracer.exact and designs:
        reached = _reached(tracer, designs, effort)
    found = []
    for number, (design, points) in enumerate(zip(designs, reached, strict=True)):
        ends = [(point.objective, point.x) for point in points]
        if not ends:
            best = solve(
                tracer.at(design.level, design.way),
                starts=effort.starts, samples=effort.samples, seed=effort.seed + number,
            )  # fmt: skip
            ends = [(best.objective, best.x)] if best.violation <= FEASIBLE else []
        level, x = min(ends, key=lambda pair: pair[0], default=(np.inf, design.point.x))
        if level < design.point.objective - OVERLOOKED:
            found.append(x[:-1])
    return found


def _reached(
    tracer: Tracer, designs: Sequence[FrontDesign], effort: FrontEffort
) -> list[list[Point]]:
    """Feasible points reached by runs, separately for each level."""
    evaluators = [tracer.like(tracer.at(design.level, design.way)) for design in designs]
    parameters = np.stack(
        [np.concatenate([design.level, design.way]) for design in designs], axis=1
    )
    given = tracer.parametric, evaluators, parameters
    starts = _overlooked_starts(tracer, designs, effort)
    ended = descents_from(*given, starts, effort.seed, tolerance=TOLERANCE, rounds=ROUNDS)
    met = [[point for point in points if point.violation <= FEASIBLE] for points in ended]
    rest = [[] if good else distinct_ends(points) for good, points in zip(met, ended, strict=True)]
    settled = converged_from(*given, rest)
    return [
        [*good, *(point for point in more if point is not None)]
        for good, more in zip(met, settled, strict=True)
    ]


def _overlooked_starts(
    tracer: Tracer, designs: Sequence[FrontDesign], effort: FrontEffort
) -> list[list[Vector]]:
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
    for design in designs:
        t = ((units - design.level[:, None]) / design.way[:, None]).max(axis=0)
        order = np.lexsort((t, missed))
        order = order[np.isfinite(missed[order]) & (order >= (own is not None))][:KEEP]
        begun = [] if own is None else [tracer.to_t(np.append(z[:, 0], 0.0), float(t[0]))]
        places = {z[:, k].tobytes(): float(t[k]) for k in order}
        for at in distinct(inner, z[:, order], max(effort.starts - len(begun), 1)):
            begun.append(tracer.to_t(np.append(at, 0.0), places[at.tobytes()]))
        result.append(begun)
    return result


@dataclass(frozen=True)
class FrontSettings:
    """Search effort for a front.

    Parameters
    ----------
    count : designs requested
    starts, samples : of the search for each anchor
    checks : full searches at levels in between
    seed : of the searches
    """

    count: int
    starts: int = 3
    samples: int = 1024
    checks: int = 3
    seed: int = 0


@dataclass(frozen=True)
class Front:
    """A front: its designs along the first objective, and the search statistics.

    Parameters
    ----------
    x : variables (n, k)
    values : objectives (objectives, k), to be minimised
    units : the same between 0 (ideal) and 1 (worst of the anchors)
    residuals : of the optimality conditions (k,)
    knee : index and depth of the design where the front bends most, or None
    passed : values (objectives, p) of dominated designs met during the search
    checked, improved : full searches at levels in between, and how many found something better
    failed : number of levels without a design at or near them
    wide : gaps of two objectives wider than `even.WIDEST`, and the reason
    """

    x: Vector
    values: Vector
    units: Vector
    residuals: Vector
    knee: tuple[int, float] | None
    passed: Vector
    checked: int = 0
    improved: int = 0
    failed: int = 0
    wide: tuple[FrontGap, ...] = ()
    warnings: tuple[str, ...] = ()

    @property
    def gaps(self) -> Vector:
        """Normalised distance to the next design: along two objectives, else to the nearest."""
        if self.units.shape[1] < 2:
            return np.empty(0)
        if len(self.units) > 2:
            return tracer.nearest(self.units)
        return np.asarray(np.sqrt((np.diff(self.units, axis=1) ** 2).sum(axis=0)))


def front(objectives: Objectives, settings: FrontSettings) -> Front | NoEnd:
    """Trace the front of some objectives; returns the failed search if an anchor has no optimum."""
    effort = FrontEffort(settings.starts, settings.samples, settings.seed)
    tell("searching for the ends of the front")
    checked, warnings = objectives.checked()
    found = ends(objectives, checked, effort)
    if isinstance(found, NoEnd):
        return found
    tracer, x = normalised(objectives, checked, found)
    if x.shape[1] == 1:
        return _single(tracer, x, warnings)
    search = FrontSearch(tracer, tracer.begun(x), found.others)
    _fill(search, settings.count)
    searched = improved = 0
    for again in range(2 if settings.checks else 0):
        places = _places(search, settings)
        before = [search.designs[k] for k in places]
        tell("searching for overlooked designs")
        more = better(tracer, before, replace(effort, seed=settings.seed + 1 + again))
        searched += len(places)
        if not more:
            break
        search.consider(np.stack(more, axis=1))
        gained = sum(
            search.designs[k].point.objective < one.point.objective - OVERLOOKED
            for k, one in zip(places, before, strict=True)
        )
        improved += gained
        if not gained:
            break
        _fill(search, settings.count)
    return _finished(search, settings.count, warnings, searched, improved)


def _fill(search: FrontSearch, count: int) -> None:
    """Find the requested number of designs, evenly spread."""
    if len(search.tracer.ideal) == 2:
        fill_line(search, count)
        close(search, count)
    else:
        fill_plane(search, count)


def _places(search: FrontSearch, settings: FrontSettings) -> list[int]:
    """Indices of designs for independent searches: evenly spaced, and one in each wide gap."""
    inner = [k for k in search.chosen() if search.designs[k].held][1:-1]
    picked = np.linspace(0, len(inner) - 1, settings.checks + 2)[1:-1].round().astype(int)
    places = {inner[k] for k in picked.tolist()} if inner else set()
    if len(search.tracer.ideal) == 2:
        places |= set(middles(search, settings.count)[: settings.checks])
    return sorted(places)


def _finished(
    search: FrontSearch, count: int, warnings: tuple[str, ...], checked: int, improved: int
) -> Front:
    """The final designs, with the designs they dominate and their spacing."""
    tracer, kept = search.tracer, chosen(search, count)
    units = search.units[:, kept]
    replaced = np.stack(search.passed, axis=1) if search.passed else np.empty((len(units), 0))
    everything = np.concatenate([search.units, search.rest, tracer.normal(replaced)], axis=1)
    dominated = ~nondominated(np.concatenate([units, everything], axis=1))[len(kept) :]
    return Front(
        x=np.stack([search.designs[k].point.x[:-1] for k in kept], axis=1),
        values=tracer.values(units),
        units=units,
        residuals=np.array([search.residual(k) for k in kept]),
        knee=knee(units),
        passed=tracer.values(everything[:, dominated]),
        checked=checked,
        improved=improved,
        failed=lost(search, kept),
        wide=tuple(wide(search, kept)) if len(units) == 2 else (),
        warnings=warnings,
    )


def _single(tracer: Tracer, x: Vector, warnings: tuple[str, ...]) -> Front:
    """A front of one design, which is best in every objective."""
    one = tracer.begun(x)[0]
    unit = one.unit[:, None]
    residual = Conditions(tracer.objectives).residual(one.point)
    return Front(
        x, tracer.objectives.values(x), unit, np.array([residual]), None,
        np.empty((len(unit), 0)), warnings=warnings,
    )  # fmt: skip
