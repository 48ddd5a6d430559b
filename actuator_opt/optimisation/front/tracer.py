"""Computes many designs of a front together, for given levels, from neighbouring designs.

A level is a set of upper limits for the objectives. The module also selects non-dominated designs,
measures their spacing and locates the knee (where the front bends most).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field, replace
from functools import cached_property, partial

import numpy as np
import numpy.typing as npt

from ...base.cluster import HERE, Cluster
from ...base.dataclass import dataclass
from .. import kkt
from ..evaluator import Evaluator, Point
from ..problem import BoxProblem, Vector
from ..resolve.changed import ChangedProblems, applicable
from ..resolve.steps import RADIUS, RESIDUAL, Descent, free_hessians
from ..solution import MET
from ..solver import solve
from .objectives import Conditions, Objectives

Indices = npt.NDArray[np.intp]


CLEARLY = 100.0
"""A gain above this multiple of `equal` is clearly better; this prevents cycles of dominance."""


SAME = 1e-6
"""Distance in normalised objectives below which two designs are equal."""


def nondominated(values: Vector, equal: float = 0.0) -> npt.NDArray[np.bool_]:
    """Which designs no other design dominates, as a mask.

    A dominating design is no worse in every objective and clearly better in one.

    Parameters
    ----------
    values : objectives to be minimised (objectives, designs); of equal designs, all remain
    equal : loss up to which a design counts as no worse; a gain of `CLEARLY` times `equal` counts
        as clearly better

    >>> nondominated(np.array([[1.0, 2.0, 3.0], [3.0, 2.0, 2.0]]))
    array([ True,  True, False])
    """
    count = values.shape[1]
    mask = np.ones(count, dtype=bool)
    for k in range(count):
        design = values[:, k : k + 1]
        no_worse = (values <= design + equal).all(axis=0)
        mask[k] = not (no_worse & (values < design - CLEARLY * equal).any(axis=0)).any()
    return mask


def distinct(units: Vector, order: Indices) -> Indices:
    """Indices of designs, in the given order, that differ from all designs before them.

    >>> distinct(np.array([[0.0, 0.0, 1.0], [1.0, 1.0, 0.0]]), np.array([1, 0, 2]))
    array([1, 2])
    """
    selected: list[int] = []
    for k in order:
        gaps = np.abs(units[:, selected] - units[:, k : k + 1]).max(axis=0)
        if gaps.min(initial=np.inf) > SAME:
            selected.append(int(k))
    return np.array(selected, dtype=np.intp)


def thinned(units: Vector, fixed: Indices, count: int) -> Indices:
    """Indices of `count` designs that are as far apart as possible, including the designs `fixed`.

    Each step adds the design farthest from the selected designs [Gonzalez1985].
    """
    selected = [int(k) for k in fixed]
    gaps = np.full(units.shape[1], np.inf)
    for k in selected:
        gaps = np.minimum(gaps, distances(units, units[:, k]))
    while len(selected) < min(count, units.shape[1]):
        farthest = int(np.argmax(gaps))
        selected.append(farthest)
        gaps = np.minimum(gaps, distances(units, units[:, farthest]))
    return np.array(sorted(selected), dtype=np.intp)


def distances(units: Vector, unit: Vector) -> Vector:
    """Euclidean distance of designs (objectives, designs) from a design (objectives,)."""
    return np.asarray(np.sqrt(((units - unit[:, None]) ** 2).sum(axis=0)))


def nearest(units: Vector) -> Vector:
    """Distance from each design (objectives, designs) to its nearest neighbour."""
    result = np.empty(units.shape[1])
    for k in range(units.shape[1]):
        gaps = distances(units, units[:, k])
        gaps[k] = np.inf
        result[k] = gaps.min(initial=np.inf)
    return result


def knee(units: Vector) -> tuple[int, float] | None:
    """Index and distance of the design farthest from the anchors' plane, towards the ideal.

    `units` (objectives, designs) are normalised objectives, 0 at the best value of each [Das1999].
    If the anchors' plane does not fall in every objective, the plane of equal sums through the
    middle of the anchors replaces it. The result is None if the front does not bend towards the
    ideal.

    >>> knee(np.array([[0.0, 0.25, 1.0], [1.0, 0.25, 0.0]]))
    (1, 0.35355339059327373)
    """
    anchors = units[:, np.argmin(units, axis=1)]
    normal: Vector = np.ones(len(units))
    if np.linalg.cond(anchors) < 1e6:
        across = np.asarray(np.linalg.solve(anchors.T, normal), dtype=float)
        normal = across if (across > 0).all() else normal
    depth = ((normal @ anchors).mean() - normal @ units) / np.linalg.norm(normal)
    deepest = int(np.argmax(depth))
    return (deepest, float(depth[deepest])) if depth[deepest] > SAME else None


BETTER = 1e-7
"""A normalised improvement of this size shows that a design belongs to another local optimum."""

HELD = 1e-6
"""An objective counts as equal to its level (upper limit) if it is at most this much below."""

ROUNDS = 4
"""Maximum number of rounds in which designs exchange results. The rounds end as soon as nothing
improves."""

GROUP = 16
"""Number of designs that a worker of a cluster computes in shared steps."""

CURVED = 2
"""Maximum number of times that the Hessian is recomputed if full steps do not converge."""


@dataclass(frozen=True)
class FrontDesign:
    """The best known design at its levels.

    Parameters
    ----------
    level, direction : parameters `a` and `r` of `Objectives.scaled` (objectives,)
    point : the variables, and t, the level of the objectives, which is minimised
    unit : normalised objectives (objectives,)
    hessian : estimate of the Lagrangian's Hessian, divided by `Tracer.scale`
    """

    level: Vector
    direction: Vector
    point: Point
    unit: Vector
    hessian: Vector

    @property
    def at_level(self) -> bool:
        """Whether every objective is at its upper limit; if not, the front ends or jumps there."""
        room = self.level + self.direction * self.point.objective - self.unit
        return bool((room <= HELD).all())


@dataclass(frozen=True)
class FrontStart:
    """Start of the search for a design at given levels: coordinates `z`, and a Hessian.

    The last coordinate is that of t, the level of the objectives, which is minimised.
    """

    level: Vector
    direction: Vector
    z: Vector
    hessian: Vector


class Tracer:
    """Computes designs of a front in shared steps.

    Parameters
    ----------
    objectives : the objectives
    ideal, width : offset and scale that normalise the objectives
    checked : an evaluator whose gradients are checked, see `Objectives.checked`
    cluster : workers that compute the designs at given levels, see `solve`
    """

    def __init__(
        self,
        objectives: Objectives,
        ideal: Vector,
        width: Vector,
        checked: Evaluator,
        cluster: Cluster = HERE,
    ) -> None:
        self.objectives = objectives
        self.cluster = cluster
        self._checked = checked
        self.rescale(ideal, width)
        self.scale = float(self.evaluator.space.scale[-1])
        self.exact = applicable(self.parametric, self.evaluator)

    def rescale(self, ideal: Vector, width: Vector) -> None:
        """Change the normalisation; designs computed before become invalid."""
        self.ideal, self.width = ideal, width
        self.parametric = self.objectives.scaled(ideal, width)
        self.evaluator = self.evaluator_of(self.parametric.problem)

    def from_x(self, x: Vector, t: float) -> Vector:
        """Coordinates (nf,) of variables (n,), with t as given."""
        return self.evaluator.space.to_z(np.append(x, t))

    def to_t(self, z: Vector, t: float) -> Vector:
        """The same coordinates with another value of t."""
        space = self.evaluator.space
        return np.append(z[:-1], np.clip(t / self.scale, space.lower[-1], space.upper[-1]))

    def unit(self, x: Vector) -> Vector:
        """Normalised objectives (objectives, k) at the variables (n, k)."""
        return self.normal(self.objectives.values(x))

    def normal(self, values: Vector) -> Vector:
        """Normalise objectives (objectives, k)."""
        return np.asarray((values - self.ideal[:, None]) / self.width[:, None])

    def values(self, units: Vector) -> Vector:
        """Objectives (objectives, k) from normalised objectives."""
        return units * self.width[:, None] + self.ideal[:, None]

    def at(self, level: Vector, direction: Vector) -> BoxProblem:
        """The single-objective problem for given levels (upper limits of the objectives)."""
        return self.parametric.at(np.concatenate([level, direction]))

    def initial_designs(self, x: Vector) -> list[FrontDesign]:
        """Designs at the variables (n, k), with their own objectives as levels and no Hessian."""
        units = self.unit(x)
        size = self.evaluator.space.size
        return self._at_own(
            [
                FrontStart(unit, np.ones(len(unit)), self.from_x(variables, 0.0), np.eye(size))
                for variables, unit in zip(x.T, units.T, strict=True)
            ]
        )

    def at_own_levels(self, designs: Sequence[FrontDesign]) -> list[FrontDesign]:
        """The designs, with the values of their own objectives as levels (upper limits)."""
        if not designs:
            return []
        units = self.unit(np.stack([design.point.x[:-1] for design in designs], axis=1))
        direction = np.ones(len(units))
        starts = [
            FrontStart(unit, direction, self.to_t(design.point.z, 0.0), design.hessian)
            for design, unit in zip(designs, units.T, strict=True)
        ]
        return self._at_own(starts)

    def _at_own(self, starts: Sequence[FrontStart]) -> list[FrontDesign]:
        """The start points themselves as designs, with their gradients."""
        z = np.stack([start.z for start in starts], axis=1)
        if not self.exact:
            x = self.evaluator.space.to_x(z)
            return [self.design_at(*pair) for pair in zip(starts, x.T, strict=True)]
        points = self._changed(starts).points(z)
        return [self._design(s, p, s.hessian) for s, p in zip(starts, points, strict=True)]

    def prices(self, front_design: FrontDesign) -> Vector:
        """Price (multiplier) of each objective's level (objectives,) at a design."""
        m, count = len(self.objectives.problem.constraint_names), self.objectives.count
        jacobian = self.evaluator.jacobian(front_design.point)
        active = kkt.active_set(self.evaluator, front_design.point)
        equalities = jacobian[1 + self.evaluator.constraint_count :]
        multipliers, _ = kkt.multipliers(jacobian[0], active, equalities)
        by_constraint = np.zeros(self.evaluator.constraint_count)
        by_constraint[active.constraint] = multipliers[: len(active.constraint)]
        return by_constraint[m : m + count]

    def solve(
        self, starts: Sequence[FrontStart], fallbacks: Sequence[FrontDesign] = ()
    ) -> list[FrontDesign | None]:
        """Find the design at the levels of each start; None where not found.

        If the steps from a start fail, a descent follows from the best of the designs `fallbacks`.
        The designs are independent of each other; on a cluster, groups of them run side by side.
        """
        work = partial(self._solved, fallbacks=fallbacks)
        groups = self.cluster.parts(starts, GROUP if self.exact else 1)
        return [design for designs in self.cluster.map(work, groups) for design in designs]

    def _solved(
        self, starts: Sequence[FrontStart], fallbacks: Sequence[FrontDesign]
    ) -> list[FrontDesign | None]:
        designs: list[FrontDesign | None] = [None] * len(starts)
        if self.exact:
            designs = self._follow(starts)
            missing = [k for k, design in enumerate(designs) if design is None]
            if fallbacks and missing:
                self._descend(starts, designs, missing, fallbacks)
            return designs
        return [self._solve_alone(start) for start in starts]

    def exchange(
        self, designs: list[FrontDesign], other_x: Vector, other_units: Vector
    ) -> list[FrontDesign]:
        """Replace each design that another beats at its levels: descend from that better design.

        Parameters
        ----------
        designs : the designs
        other_x : variables (n, k) of further feasible designs
        other_units : normalised objectives (objectives, k) of the further designs
        """
        failed: set[int] = set()
        for _ in range(ROUNDS if designs else 0):
            x = np.concatenate(
                [np.stack([d.point.x[:-1] for d in designs], axis=1), other_x], axis=1
            )
            units = np.concatenate(
                [np.stack([d.unit for d in designs], axis=1), other_units], axis=1
            )
            improvements = []
            for k, design in enumerate(designs):
                if k in failed:
                    continue
                levels = ((units - design.level[:, None]) / design.direction[:, None]).max(axis=0)
                best = int(np.argmin(levels))
                if levels[best] < design.point.objective - BETTER:
                    improvements.append((k, x[:, best], float(levels[best])))
            if not improvements:
                break
            starts = [
                FrontStart(
                    designs[k].level, designs[k].direction, self.from_x(z, t), designs[k].hessian
                )
                for k, z, t in improvements
            ]
            for (k, _, t), new in zip(improvements, self._descended(starts), strict=True):
                if new is not None and new.point.objective <= t + BETTER:
                    designs[k] = new
                else:
                    failed.add(k)
        return designs

    def spread(
        self, designs: list[FrontDesign], changed: Sequence[FrontDesign]
    ) -> list[FrontDesign]:
        """Descend from the `changed` designs; a better end replaces the present design."""
        improved = list(changed)
        while improved:
            levels = np.stack([descended.level for descended in improved], axis=1)
            starts = []
            for design in designs:
                nearest_design = improved[int(np.argmin(distances(levels, design.level)))]
                t = float(((nearest_design.unit - design.level) / design.direction).max())
                starts.append(
                    FrontStart(
                        design.level,
                        design.direction,
                        self.to_t(nearest_design.point.z, t),
                        nearest_design.hessian,
                    )
                )
            improved = []
            for k, descended in enumerate(self._descended(starts)):
                if (
                    descended is not None
                    and descended.point.objective < designs[k].point.objective - BETTER
                ):
                    designs[k] = descended
                    improved.append(descended)
        return designs

    def _descended(self, starts: Sequence[FrontStart]) -> list[FrontDesign | None]:
        """The designs that descents reach from feasible starts."""
        if not self.exact:
            return [self._solve_alone(start) for start in starts]
        return self._follow(starts)

    def _changed(self, starts: Sequence[FrontStart]) -> ChangedProblems:
        """The single-objective problems for the levels of some starts."""
        levels = np.stack(
            [np.concatenate([start.level, start.direction]) for start in starts], axis=1
        )
        return ChangedProblems(self.parametric, self.evaluator, levels)

    def _descent(self, hessian: Vector, radius: float = RADIUS) -> Descent:
        """A descent that begins with a given Hessian."""
        rows = self.evaluator.constraint_count
        return Descent(hessian, self.scale, rows, 1.0, radius=radius)

    def _follow(self, starts: Sequence[FrontStart]) -> list[FrontDesign | None]:
        """Take full Newton steps; where they diverge, try again with the last point's Hessian."""
        designs: list[FrontDesign | None] = [None] * len(starts)
        indices, current = list(range(len(starts))), list(starts)
        for attempt in range(1 + CURVED):
            z = np.stack([start.z for start in current], axis=1)
            descents = [self._descent(start.hessian, radius=kkt.RADIUS) for start in current]
            points = self._changed(current).step_fully(descents, z)
            for k, start, point, descent in zip(indices, current, points, descents, strict=True):
                if point is not None:
                    designs[k] = self._design(start, point, descent.hessian)
            unfinished = [
                i
                for i, (point, descent) in enumerate(zip(points, descents, strict=True))
                if point is None and descent.point is not None and np.isfinite(descent.step).all()
            ]
            if attempt == CURVED or not unfinished:
                break
            hessians = free_hessians(self.evaluator, [descents[i] for i in unfinished])
            current = [
                replace(current[i], z=descents[i].current.z, hessian=hessian)
                for i, hessian in zip(unfinished, hessians, strict=True)
            ]
            indices = [indices[i] for i in unfinished]
        return designs

    def _descend(
        self,
        starts: Sequence[FrontStart],
        designs: list[FrontDesign | None],
        missing: list[int],
        fallbacks: Sequence[FrontDesign],
    ) -> None:
        """For each missing design, descend from the best known design in a trust region."""
        units = np.stack([design.unit for design in fallbacks], axis=1)
        coordinates, descents = [], []
        for k in missing:
            moving = starts[k].direction > 0
            level, slope = starts[k].level[moving, None], starts[k].direction[moving, None]
            t = ((units[moving] - level) / slope).max(axis=0)
            best = fallbacks[int(np.argmin(t))]
            coordinates.append(self.to_t(best.point.z, float(t.min())))
            descents.append(self._descent(best.hessian))
        missing_starts = [starts[k] for k in missing]
        points = self._changed(missing_starts).descend(descents, np.stack(coordinates, axis=1))
        for k, point, descent in zip(missing, points, descents, strict=True):
            if point is not None:
                designs[k] = self._design(starts[k], point, descent.hessian)

    def _solve_alone(self, start: FrontStart) -> FrontDesign | None:
        """The design for one start, by the most robust method."""
        problem = replace(self.at(start.level, start.direction), start=None)
        x = self.evaluator.space.to_x(start.z[:, None])[:, 0]
        solution = solve(problem, starts=1, samples=0, more_starts=[x])
        if solution.violation > MET or solution.kkt is None or solution.kkt.residual > MET:
            return None
        return self.design_at(start, solution.x)

    def polished(self, front_design: FrontDesign) -> FrontDesign:
        """The design after Newton steps with the exact Hessian."""
        evaluator = self.evaluator_of(self.at(front_design.level, front_design.direction))
        point = kkt.polish(evaluator, evaluator.point(front_design.point.z))
        evaluator.jacobian(point)
        return self._design(
            FrontStart(front_design.level, front_design.direction, point.z, front_design.hessian),
            point,
            front_design.hessian,
        )

    def design_at(self, start: FrontStart, x: Vector) -> FrontDesign:
        """The design at the point x (n + 1,), which is variables and t, with its gradients."""
        evaluator = self.evaluator_of(self.at(start.level, start.direction))
        point = evaluator.point(evaluator.space.to_z(x))
        evaluator.jacobian(point)
        return self._design(start, point, start.hessian)

    def _design(self, start: FrontStart, point: Point, hessian: Vector) -> FrontDesign:
        m = len(self.objectives.problem.constraint_names)
        rows = point.rows[1 + m : 1 + m + self.objectives.count]
        unit = start.level + start.direction * point.objective - rows
        return FrontDesign(start.level, start.direction, point, unit, hessian)

    def evaluator_of(self, problem: BoxProblem) -> Evaluator:
        """An evaluator of a problem that reuses the gradient check made before."""
        evaluator = Evaluator(problem)
        evaluator.adopt_check(self._checked)
        return evaluator


EQUAL = 1e-8
"""Normalised difference up to which objectives count as equal: their numerical accuracy."""
JUMP = 5.0
"""If the variables of neighbours differ by this multiple of the median difference, the neighbours
may belong to different local optima."""


@dataclass
class FrontSearch:
    """State of the search: the designs of the front so far, and other known feasible points."""

    tracer: Tracer
    designs: list[FrontDesign]
    others: Vector
    """Variables (n, k) of feasible designs that are not in the list of designs."""
    replaced: list[Vector] = field(default_factory=list)
    """Objectives of designs that a better design has replaced."""
    empty_levels: list[Vector] = field(default_factory=list)
    """Levels (upper limits of the objectives) for which the search gave no design."""
    _other_values: tuple[Vector, Vector] | None = None
    _residuals: dict[int, tuple[FrontDesign, float]] = field(default_factory=dict)

    def solve(self, starts: Sequence[FrontStart], *, firmly: bool = True) -> int:
        """Add the designs at the levels of some starts; return how many were added.

        With `firmly`, starts that fail are tried again within trust regions.
        """
        designs = [d for d in self.designs_at(starts, firmly=firmly) if d is not None]
        self.add(designs)
        return len(designs)

    def designs_at(
        self, starts: Sequence[FrontStart], *, firmly: bool = True
    ) -> list[FrontDesign | None]:
        """Compute the design at the levels of each start, without adding it to the front.

        The result is None for a start that leads to no design. `firmly` is explained in `solve`.
        """
        designs = self.tracer.solve(starts, self.designs if firmly else ())
        self.empty_levels += [
            s.level for s, design in zip(starts, designs, strict=True) if design is None
        ]
        return designs

    def improved_designs(self, starts: Sequence[FrontStart]) -> list[FrontDesign | None]:
        """Compute the designs as `designs_at`, then improve them from better known designs.

        If a known design is better at the levels of a start, the search restarts from it.
        """
        designs = self.designs_at(starts)
        indices = [k for k, d in enumerate(designs) if d is not None]
        known_x = np.stack([design.point.x[:-1] for design in self.designs], axis=1)
        others = np.concatenate([self.others, known_x], axis=1)
        other_units = np.concatenate([self.other_units, self.units], axis=1)
        exchanged = self.tracer.exchange([d for d in designs if d is not None], others, other_units)
        for k, d in zip(indices, exchanged, strict=True):
            designs[k] = d
        return designs

    def add(self, designs: Sequence[FrontDesign]) -> None:
        """Add designs, then recompute each design from any other that is better at its levels."""
        previous = [*self.designs, *designs]
        self.designs = self.tracer.exchange(list(previous), self.others, self.other_units)
        changed = [new for old, new in zip(previous, self.designs, strict=True) if old is not new]
        self.designs = self.tracer.spread(self.designs, changed)
        self._pass([o for o, new in zip(previous, self.designs, strict=True) if o is not new])

    def _pass(self, designs: Sequence[FrontDesign]) -> None:
        """Record the objectives of designs that are replaced."""
        self.replaced += [self.tracer.values(design.unit[:, None])[:, 0] for design in designs]

    def rescale(self, low: Vector, width: Vector) -> None:
        """Normalise to another range: `low` and `width` (objectives,), in the present units."""
        tracer = self.tracer
        tracer.rescale(tracer.ideal + low * tracer.width, width * tracer.width)
        self.designs = tracer.at_own_levels(self.designs)
        self.empty_levels.clear()

    @property
    def plane(self) -> Vector:
        """Normalised objectives (objectives, k), projected on the plane where their sum is 0."""
        units = self.units
        return np.asarray(units - units.mean(axis=0))

    def sort(self) -> None:
        """Sort the designs by the level of their first objective."""
        self.designs.sort(key=lambda design: design.level[0])

    @cached_property
    def _conditions(self) -> Conditions:
        return Conditions(self.tracer.objectives)

    def residual(self, k: int) -> float:
        """Residual of design k's optimality conditions, after Newton steps if necessary."""
        design = self.designs[k]
        cached = self._residuals.get(id(design))
        if cached is not None and cached[0] is design:
            return cached[1]
        residual = self._conditions.residual(design.point)
        if residual > RESIDUAL:
            self.designs[k] = design = self.tracer.polished(design)
            residual = self._conditions.residual(design.point)
        self._residuals[id(design)] = (design, residual)
        return residual

    def consider(self, x: Vector) -> None:
        """Compare the front's designs with feasible points x (n, k), and keep the better."""
        self.others = np.concatenate([self.others, x], axis=1)
        self.add([])

    def retry_jumps(self) -> None:
        """Where variables jump between two neighbours, recompute each design from the other."""
        self.sort()
        z = np.stack([design.point.z[:-1] for design in self.designs], axis=1)
        steps = np.abs(np.diff(z, axis=1)).max(axis=0)
        starts, targets = [], []
        for k in np.flatnonzero(steps > JUMP * np.median(steps)).tolist():
            for target, source in ((k, k + 1), (k + 1, k)):
                level, neighbour = self.designs[target].level, self.designs[source]
                at = self.tracer.to_t(neighbour.point.z, float((neighbour.unit - level).max()))
                direction = self.designs[target].direction
                starts.append(FrontStart(level, direction, at, neighbour.hessian))
                targets.append(target)
        for target, retried in zip(targets, self.tracer.solve(starts), strict=True):
            design = self.designs[target]
            if retried is not None and retried.point.objective < design.point.objective - BETTER:
                self._pass([design])
                self.designs[target] = retried
                self.designs = self.tracer.spread(self.designs, [retried])

    @property
    def other_units(self) -> Vector:
        """Normalised objectives (objectives, k) of the other feasible designs."""
        if self._other_values is None or self._other_values[0] is not self.others:
            self._other_values = self.others, self.tracer.objectives.values(self.others)
        return self.tracer.normal(self._other_values[1])

    @property
    def units(self) -> Vector:
        """Normalised objectives of all designs (objectives, k)."""
        return np.stack([design.unit for design in self.designs], axis=1)

    def front_indices(self) -> Indices:
        """Indices of distinct non-dominated designs; of equal ones, one at its levels is kept."""
        order = sorted(range(len(self.designs)), key=lambda k: not self.designs[k].at_level)
        units = self.units
        indices = distinct(units, np.array(order, dtype=np.intp))
        all_units = np.concatenate([units[:, indices], self.other_units + BETTER], axis=1)
        equal = EQUAL if len(units) > 2 else 0.0
        mask = nondominated(all_units, equal)[: len(indices)]
        return np.sort(indices[mask])
