"""Computes an evenly spread Pareto front, and checks it for designs that are only locally best.

The anchors are the designs that are best in one objective each. The searches for them share one
sweep of the design space and one model call per step; between equally good anchors, the other
objectives decide. Designs between the anchors are computed for levels (upper limits) of the
objectives, starting from their neighbours and in shared steps. Each design is compared with all
others at its own levels, and a better design replaces it. Independent full searches at some levels
then check whether a better design was overlooked.

On a continuous front, designs at nearly equal levels are close together. If two designs are farther
apart than their levels permit, the front jumps and no design lies between them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from ...base.cluster import HERE, Cluster
from ...base.dataclass import dataclass
from ...base.numeric import Array
from ...base.progress import tell
from ..evaluator import Evaluator, Point
from ..problem import PointValues, Vector
from ..resolve.parallel_descents import (
    converged_from,
    descents_from,
    distinct_ends,
)
from ..resolve.steps import RESIDUAL
from ..solution import MET, Solution
from ..solver import KEEP, Halton, Sweep, distinct, solve, sweep
from . import tracer
from .objectives import Conditions, Objectives
from .plane import (
    FrontGap,
    close_gaps,
    fill_line,
    fill_plane,
    final_designs,
    lost_levels,
    middle_designs,
    wide_gaps,
)
from .tracer import FrontDesign, FrontSearch, FrontStart, Tracer, knee, nondominated

HOLD = 1e-10
"""In the best design of an objective, this objective may worsen by this share of its range while
other objectives improve."""
GAINED = 1e-3
"""Normalised gain of the other objectives that justifies the loss `HOLD`."""
CONFLICT = 1e-6
"""An objective counts as constant if its range is below this share of its magnitude."""
ROUGH = 16
"""Number of points after which an SLSQP run is replaced by steps with the Hessian."""


@dataclass(frozen=True)
class FrontEffort:
    """Search effort: starts and sweep samples for each objective, and the seed."""

    starts: int
    samples: int
    seed: int


@dataclass(frozen=True)
class Anchors:
    """The best design of each objective (the anchors), and all feasible local optima.

    Both are arrays of the n variables: (n, objectives) and (n, number of optima).
    """

    x: Vector
    others: Vector


class NoAnchor(NamedTuple):
    """Index of an objective whose best design the search did not find, and the failed search."""

    objective: int
    solution: Solution


def find_anchors(
    objectives: Objectives, checked: Evaluator, effort: FrontEffort
) -> Anchors | NoAnchor:
    """Find the best design of each objective; return the failed search if a design is missing."""
    optima = [[] for _ in range(objectives.count)] if not checked.exact else _joint_search(
        objectives, checked, effort
    )  # fmt: skip
    known_x = [x for optima_of_one in optima for x in optima_of_one]
    values = objectives.values(np.stack(known_x, axis=1)) if known_x else np.empty((len(optima), 0))
    best: list[Vector] = []
    for index, optima_of_one in enumerate(optima):
        objective_values = values[index]
        first_column = sum(len(points) for points in optima[:index])
        size = CONFLICT * np.abs(objective_values).max(initial=0.0)
        if optima_of_one and objective_values[first_column] <= objective_values.min() + size:
            best.append(optima_of_one[0])
            continue
        solution = solve(
            objectives.single_problem(index),
            starts=effort.starts, samples=effort.samples, seed=effort.seed, more_starts=known_x,
        )  # fmt: skip
        if solution.violation > MET or solution.kkt is None or solution.kkt.residual > RESIDUAL:
            return NoAnchor(index, solution)
        best.append(solution.x)
        known_x += [optimum.x for optimum in solution.optima if optimum.violation <= MET]
    return Anchors(np.stack(best, axis=1), np.stack(known_x, axis=1))


def _joint_search(
    objectives: Objectives, checked: Evaluator, effort: FrontEffort
) -> list[list[Vector]]:
    """Local optima of each objective, the best first, from runs that share model calls."""
    objectives = replace(objectives, evaluate=_with_cache(objectives.evaluate))
    evaluators = [objectives.evaluator_of(checked, k) for k in range(objectives.count)]
    swept = [sweep(evaluator, effort.samples, effort.seed) for evaluator in evaluators]
    starts = [_starts(*pair, effort.starts) for pair in zip(evaluators, swept, strict=True)]
    indices = np.arange(objectives.count, dtype=float)[None]
    single = objectives.selection()
    run_ends = descents_from(single, evaluators, indices, starts, effort.seed, rounds=ROUGH)
    run_ends = [distinct_ends(points) for points in run_ends]
    converged = converged_from(single, evaluators, indices, run_ends)
    return [_optima(*pair) for pair in zip(run_ends, converged, strict=True)]


def _with_cache(evaluate: Callable[[Array], PointValues]) -> Callable[[Array], PointValues]:
    """The function with a cache of its last real (not complex) points, which all sweeps share."""
    cache: dict[bytes, PointValues] = {}

    def remembered(points: Array) -> PointValues:
        if np.iscomplexobj(points):
            return evaluate(points)
        key = np.asarray(points).tobytes()
        if key not in cache:
            values = evaluate(points)
            cache.clear()
            cache[key] = values
        return cache[key]

    return remembered


def _starts(evaluator: Evaluator, swept: Sweep, count: int) -> list[Vector]:
    """Coordinates of the problem's start, and of the best distinct points of the sweep."""
    start = evaluator.problem.start
    starts = [] if start is None else [evaluator.space.to_z(start)]
    return starts + distinct(evaluator, swept.z, max(count - len(starts), 1))


def _optima(run_ends: Sequence[Point], converged: Sequence[Point | None]) -> list[Vector]:
    """Distinct optima, the best first; empty if a run that did not finish may be better."""
    optima = sorted((p for p in converged if p is not None), key=lambda point: point.objective)
    unfinished = [
        p.objective for p, point in zip(run_ends, converged, strict=True)
        if point is None and p.violation <= MET
    ]  # fmt: skip
    if not optima or min(unfinished, default=np.inf) < optima[0].objective:
        return []
    return [distinct_end.x for distinct_end in distinct_ends(optima)]


def normalised(
    objectives: Objectives, checked: Evaluator, anchors: Anchors, cluster: Cluster = HERE
) -> tuple[Tracer, Vector]:
    """A `Tracer` with normalised objectives, and the n variables of the k anchors (n, k).

    If no objectives conflict, there is a single anchor.
    """
    x = anchors.x
    all_values = objectives.values(np.concatenate([anchors.others, x], axis=1))
    values, magnitude = all_values[:, -x.shape[1] :], np.abs(all_values).max(axis=1)
    magnitude = np.where(magnitude > 0, magnitude, 1.0)
    tracer: Tracer | None = None
    while True:
        ideal, width = values.min(axis=1), np.ptp(values, axis=1)
        best_of_all = (values - ideal[:, None] <= (CONFLICT * magnitude)[:, None]).all(axis=0)
        if best_of_all.any():
            x, width = x[:, [int(np.argmax(best_of_all))]], magnitude
        width = np.where(width <= CONFLICT * magnitude, magnitude, width)
        if tracer is not None or best_of_all.any():
            break
        tracer = Tracer(objectives, ideal, width, checked, cluster)
        x = _sharpened(tracer, x, tracer.normal(values))
        values = objectives.values(x)
    if tracer is None:
        tracer = Tracer(objectives, ideal, width, checked, cluster)
    else:
        tracer.rescale(ideal, width)
    return tracer, x


def _sharpened(tracer: Tracer, x: Vector, units: Vector) -> Vector:
    """The best design of each objective (n, k), moved if that only improves other objectives."""
    count = len(x.T)
    starts = []
    for k in range(count):
        level, direction = np.zeros(count), np.ones(count)
        level[k], direction[k] = units[k, k] + HOLD, 0.0
        z = tracer.from_x(x[:, k], float(np.delete(units[:, k], k).max()))
        starts.append(FrontStart(level, direction, z, np.eye(len(z))))
    sharpened = x.copy()
    for k, (design, start) in enumerate(zip(tracer.solve(starts), starts, strict=True)):
        previous = start.z[-1] * tracer.scale
        if design is not None and design.point.objective < previous - GAINED:
            sharpened[:, k] = design.point.x[:-1]
    return sharpened


OVERLOOKED = 1e-6
"""Normalised improvement that a search must find for its design to replace the known design."""
TOLERANCE = 1e-7
"""A run ends if the level (t) and the variables change by less than this relative amount."""
ROUNDS = 24
"""Maximum number of points of a run; a run that ends infeasible is continued by other steps."""


def overlooked(tracer: Tracer, designs: Sequence[FrontDesign], effort: FrontEffort) -> list[Vector]:
    """Search for better designs within the levels (upper limits of the objectives) of some designs.

    Returns the variables (n,) of the designs found. The searches are independent: on a cluster they
    run side by side.
    """
    groups = tracer.cluster.parts(list(enumerate(designs)), 1)
    work = partial(_overlooked, tracer, effort)
    return [x for improvements in tracer.cluster.map(work, groups) for x in improvements]


def _overlooked(
    tracer: Tracer, effort: FrontEffort, numbered: Sequence[tuple[int, FrontDesign]]
) -> list[Vector]:
    run_ends: list[list[Point]] = [[] for _ in numbered]
    if tracer.exact:
        run_ends = _feasible_ends(tracer, [design for _, design in numbered], effort)
    result = []
    for (number, design), points in zip(numbered, run_ends, strict=True):
        ends = [(point.objective, point.x) for point in points]
        if not ends:
            solution = solve(
                tracer.at(design.level, design.direction),
                starts=effort.starts, samples=effort.samples, seed=effort.seed + number,
            )  # fmt: skip
            ends = [(solution.objective, solution.x)] if solution.violation <= MET else []
        level, x = min(ends, key=lambda end: end[0], default=(np.inf, design.point.x))
        if level < design.point.objective - OVERLOOKED:
            result.append(x[:-1])
    return result


def _feasible_ends(
    tracer: Tracer, designs: Sequence[FrontDesign], effort: FrontEffort
) -> list[list[Point]]:
    """Feasible points at which runs ended, for the levels of each design."""
    evaluators = [tracer.evaluator_of(tracer.at(d.level, d.direction)) for d in designs]
    parameters = np.stack(
        [np.concatenate([design.level, design.direction]) for design in designs], axis=1
    )
    problems = tracer.parametric, evaluators, parameters
    starts = _overlooked_starts(tracer, designs, effort)
    run_ends = descents_from(*problems, starts, effort.seed, tolerance=TOLERANCE, rounds=ROUNDS)
    feasible = [[point for point in points if point.violation <= MET] for points in run_ends]
    unfinished = [
        [] if feasible_points else distinct_ends(points)
        for feasible_points, points in zip(feasible, run_ends, strict=True)
    ]
    converged = converged_from(*problems, unfinished)
    return [
        [*feasible_points, *(point for point in more if point is not None)]
        for feasible_points, more in zip(feasible, converged, strict=True)
    ]


def _overlooked_starts(
    tracer: Tracer, designs: Sequence[FrontDesign], effort: FrontEffort
) -> list[list[Vector]]:
    """Starts for the levels of each design: the problem's start, and the best of shared samples."""
    inner = Evaluator(tracer.objectives.single_problem(0))
    space, start = inner.space, tracer.objectives.problem.start
    cube = Halton(space.size, effort.seed, max_points=max(2, effort.samples)).points(
        0, effort.samples
    )
    z = space.lower[:, None] + (space.upper - space.lower)[:, None] * cube
    if start is not None:
        z = np.concatenate([space.to_z(start)[:, None], z], axis=1)
    rows = tracer.evaluator.batch(np.concatenate([z, np.zeros((1, z.shape[1]))]))
    first_row = 1 + len(tracer.objectives.problem.constraint_names)
    units = -rows[first_row : first_row + tracer.objectives.count]
    margins = np.delete(rows, range(first_row, first_row + tracer.objectives.count), axis=0)
    missed = inner.violations(margins, "sum")
    missed = np.where(np.isfinite(units).all(axis=0), missed, np.inf)
    result = []
    for design in designs:
        t = ((units - design.level[:, None]) / design.direction[:, None]).max(axis=0)
        order = np.lexsort((t, missed))
        order = order[np.isfinite(missed[order]) & (order >= (start is not None))][:KEEP]
        starts = [] if start is None else [tracer.to_t(np.append(z[:, 0], 0.0), float(t[0]))]
        places = {z[:, k].tobytes(): float(t[k]) for k in order}
        for candidate in distinct(inner, z[:, order], max(effort.starts - len(starts), 1)):
            starts.append(tracer.to_t(np.append(candidate, 0.0), places[candidate.tobytes()]))
        result.append(starts)
    return result


@dataclass(frozen=True)
class FrontSettings:
    """Search effort for a Pareto front.

    Parameters
    ----------
    count : requested number of designs
    starts, samples : numbers of starts and sweep points in the search for each anchor
    checks : number of full searches that check designs between the anchors
    seed : seed of the searches
    """

    count: int
    starts: int = 3
    samples: int = 1024
    checks: int = 3
    seed: int = 0


@dataclass(frozen=True)
class Front:
    """A Pareto front: its designs in order of the first objective, and search statistics.

    Parameters
    ----------
    x : the n variables of the k designs (n, k)
    values : objectives (objectives, k), to be minimised
    units : normalised objectives: 0 at the ideal, 1 at the worst value of the anchors
    residuals : residuals of the optimality conditions (k,)
    knee : index of the design where the front bends most, and the distance by which the front
        bulges there; or None
    passed : values (objectives, p) of dominated designs that the search found
    checked, improved : number of checking searches, and how many of them improved a design
    failed : number of levels (upper limits of the objectives) without a design nearby
    wide : with two objectives, gaps wider than `plane.WIDEST` times the median gap, and whether the
        front jumps there
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
        """Normalised distance from each design to the next (two objectives) or nearest design."""
        if self.units.shape[1] < 2:
            return np.empty(0)
        if len(self.units) > 2:
            return tracer.nearest(self.units)
        return np.asarray(np.sqrt((np.diff(self.units, axis=1) ** 2).sum(axis=0)))


def front(
    objectives: Objectives, settings: FrontSettings, cluster: Cluster = HERE
) -> Front | NoAnchor:
    """Compute the front; return the failed search if an objective's best design is missing.

    On a cluster run the designs at given levels (`Tracer.solve`) and the searches that check them
    (`overlooked`). The search for the anchors shares its model calls, and runs in this process.
    """
    effort = FrontEffort(settings.starts, settings.samples, settings.seed)
    tell("searching for the ends of the front")
    checked, warnings = objectives.checked()
    anchors = find_anchors(objectives, checked, effort)
    if isinstance(anchors, NoAnchor):
        return anchors
    tracer, x = normalised(objectives, checked, anchors, cluster)
    if x.shape[1] == 1:
        return _single(tracer, x, warnings)
    search = FrontSearch(tracer, tracer.initial_designs(x), anchors.others)
    _fill(search, settings.count)
    searched = improved = 0
    for attempt in range(2 if settings.checks else 0):
        places = _places(search, settings)
        previous = [search.designs[k] for k in places]
        tell("searching for designs that were missed")
        reseeded = replace(effort, seed=settings.seed + 1 + attempt)
        improvements = overlooked(tracer, previous, reseeded)
        searched += len(places)
        if not improvements:
            break
        search.consider(np.stack(improvements, axis=1))
        gained = sum(
            search.designs[k].point.objective < design.point.objective - OVERLOOKED
            for k, design in zip(places, previous, strict=True)
        )
        improved += gained
        if not gained:
            break
        _fill(search, settings.count)
    return _assembled(search, settings.count, warnings, searched, improved)


def _fill(search: FrontSearch, count: int) -> None:
    """Add designs, evenly spread, until the requested number is reached."""
    if len(search.tracer.ideal) == 2:
        fill_line(search, count)
        close_gaps(search, count)
    else:
        fill_plane(search, count)


def _places(search: FrontSearch, settings: FrontSettings) -> list[int]:
    """Indices of designs for the checking searches: evenly spaced, and at the wide gaps."""
    inner = [k for k in search.front_indices() if search.designs[k].at_level][1:-1]
    positions = np.linspace(0, len(inner) - 1, settings.checks + 2)[1:-1].round().astype(int)
    places = {inner[k] for k in positions.tolist()} if inner else set()
    if len(search.tracer.ideal) == 2:
        places |= set(middle_designs(search, settings.count)[: settings.checks])
    return sorted(places)


def _assembled(
    search: FrontSearch, count: int, warnings: tuple[str, ...], checked: int, improved: int
) -> Front:
    """Build the front from the final designs, the dominated designs and the gaps."""
    tracer, indices = search.tracer, final_designs(search, count)
    units = search.units[:, indices]
    replaced = np.stack(search.replaced, axis=1) if search.replaced else np.empty((len(units), 0))
    everything = np.concatenate([search.units, search.other_units, tracer.normal(replaced)], axis=1)
    dominated = ~nondominated(np.concatenate([units, everything], axis=1))[len(indices) :]
    return Front(
        x=np.stack([search.designs[k].point.x[:-1] for k in indices], axis=1),
        values=tracer.values(units),
        units=units,
        residuals=np.array([search.residual(k) for k in indices]),
        knee=knee(units),
        passed=tracer.values(everything[:, dominated]),
        checked=checked,
        improved=improved,
        failed=lost_levels(search, indices),
        wide=tuple(wide_gaps(search, indices)) if len(units) == 2 else (),
        warnings=warnings,
    )


def _single(tracer: Tracer, x: Vector, warnings: tuple[str, ...]) -> Front:
    """A front that consists of one design, which is best in every objective."""
    design = tracer.initial_designs(x)[0]
    unit = design.unit[:, None]
    residual = Conditions(tracer.objectives).residual(design.point)
    return Front(
        x, tracer.objectives.values(x), unit, np.array([residual]), None,
        np.empty((len(unit), 0)), warnings=warnings,
    )  # fmt: skip
