"""Designs of a front at given levels, many at once, from neighbouring designs.

Also: which designs are on the front, how evenly they lie, and where the front bends most.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from .. import kkt
from ..evaluator import Evaluator, Point
from ..problem import BoxProblem, Vector
from ..resolve.changed import ChangedProblems, applicable
from ..resolve.parallel_descents import FEASIBLE, RESIDUAL
from ..resolve.steps import RADIUS, Descent, free_hessians
from ..solver import solve
from .objectives import Conditions, Objectives

Indices = npt.NDArray[np.intp]


CLEARLY = 100.0
"""Multiple of `equal` that counts as clearly better, so that designs cannot dominate in a cycle."""


SAME = 1e-6
"""Distance in normalised objectives below which two designs count as one."""


def nondominated(values: Vector, equal: float = 0.0) -> npt.NDArray[np.bool_]:
    """Which designs no other design dominates: no worse in every objective, better in one.

    Parameters
    ----------
    values : (objectives, designs), to be minimised; of equal designs all stay
    equal : difference that counts as no worse; better means a gain of `CLEARLY` times that

    >>> nondominated(np.array([[1.0, 2.0, 3.0], [3.0, 2.0, 2.0]]))
    array([ True,  True, False])
    """
    count = values.shape[1]
    kept = np.ones(count, dtype=bool)
    for k in range(count):
        one = values[:, k : k + 1]
        beats = (values <= one + equal).all(axis=0) & (values < one - CLEARLY * equal).any(axis=0)
        kept[k] = not beats.any()
    return kept


def distinct(units: Vector, order: Indices) -> Indices:
    """Designs (objectives, designs), in a given order, that are distinct from those before.

    >>> distinct(np.array([[0.0, 0.0, 1.0], [1.0, 1.0, 0.0]]), np.array([1, 0, 2]))
    array([1, 2])
    """
    kept: list[int] = []
    for k in order:
        if not kept or np.abs(units[:, kept] - units[:, k : k + 1]).max(axis=0).min() > SAME:
            kept.append(int(k))
    return np.array(kept, dtype=np.intp)


def thinned(units: Vector, first: Indices, wanted: int) -> Indices:
    """The requested number of designs (objectives, designs), farthest apart, including `first`.

    Each step adds the design farthest from those selected [Gonzalez1985].
    """
    kept = [int(k) for k in first]
    gaps = np.full(units.shape[1], np.inf)
    for k in kept:
        gaps = np.minimum(gaps, distances(units, units[:, k]))
    while len(kept) < min(wanted, units.shape[1]):
        following = int(np.argmax(gaps))
        kept.append(following)
        gaps = np.minimum(gaps, distances(units, units[:, following]))
    return np.array(sorted(kept), dtype=np.intp)


def distances(units: Vector, one: Vector) -> Vector:
    """Euclidean distance of designs (objectives, designs) from one (objectives,)."""
    return np.asarray(np.sqrt(((units - one[:, None]) ** 2).sum(axis=0)))


def nearest(units: Vector) -> Vector:
    """Distance of each design (objectives, designs) to its nearest neighbour."""
    result = np.empty(units.shape[1])
    for k in range(units.shape[1]):
        gaps = distances(units, units[:, k])
        gaps[k] = np.inf
        result[k] = gaps.min(initial=np.inf)
    return result


def knee(units: Vector) -> tuple[int, float] | None:
    """The design farthest from the plane through the anchors towards the ideal, and its distance.

    Units (objectives, designs) are 0 at the best of each objective [Das1999]. If the anchors span
    no plane that falls in every objective, a plane of equal sums through their middle is used. None
    if the front does not bend towards the ideal.

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
"""Normalised improvement that indicates another valley."""

HELD = 1e-6
"""Normalised shortfall that still counts as at the level."""

ROUNDS = 4
"""Maximum exchanges of results; each follows only if the last exchange improved."""

CURVED = 2
"""Maximum recomputations of the curvature where full steps do not converge."""


@dataclass(frozen=True)
class FrontDesign:
    """The best known design at its levels.

    Parameters
    ----------
    level, way : `a` and `r` of `Objectives.scaled` (objectives,)
    point : variables and t
    unit : normalised objectives (objectives,)
    hessian : of the Lagrangian over `Tracer.scale`, as learnt
    """

    level: Vector
    way: Vector
    point: Point
    unit: Vector
    hessian: Vector

    @property
    def held(self) -> bool:
        """Whether every objective is at its level; else the front has an edge or jump here."""
        room = self.level + self.way * self.point.objective - self.unit
        return bool((room <= HELD).all())


@dataclass(frozen=True)
class FrontStart:
    """Start for the design at some levels: coordinates with t, and a Hessian."""

    level: Vector
    way: Vector
    z: Vector
    hessian: Vector


class Tracer:
    """Finds designs of a front in shared steps.

    Parameters
    ----------
    objectives : the objectives
    ideal, width : of the normalisation
    checked : an evaluator with checked gradients, see `Objectives.checked`
    """

    def __init__(
        self, objectives: Objectives, ideal: Vector, width: Vector, checked: Evaluator
    ) -> None:
        self.objectives = objectives
        self._checked = checked
        self.rescale(ideal, width)
        self.scale = float(self.evaluator.space.scale[-1])
        self.exact = applicable(self.parametric, self.evaluator)

    def rescale(self, ideal: Vector, width: Vector) -> None:
        """Change the normalisation; earlier designs become invalid."""
        self.ideal, self.width = ideal, width
        self.parametric = self.objectives.scaled(ideal, width)
        self.evaluator = self.like(self.parametric.problem)

    def from_x(self, x: Vector, t: float) -> Vector:
        """Coordinates (nf,) of variables (n,) at a level t."""
        return self.evaluator.space.to_z(np.append(x, t))

    def to_t(self, z: Vector, t: float) -> Vector:
        """The same coordinates at another level t."""
        space = self.evaluator.space
        return np.append(z[:-1], np.clip(t / self.scale, space.lower[-1], space.upper[-1]))

    def unit(self, x: Vector) -> Vector:
        """Normalised objectives (objectives, k) of variables (n, k)."""
        return self.normal(self.objectives.values(x))

    def normal(self, values: Vector) -> Vector:
        """Normalise objectives (objectives, k)."""
        return np.asarray((values - self.ideal[:, None]) / self.width[:, None])

    def values(self, units: Vector) -> Vector:
        """Objectives (objectives, k) from normalised ones."""
        return units * self.width[:, None] + self.ideal[:, None]

    def at(self, level: Vector, way: Vector) -> BoxProblem:
        """The problem at some levels."""
        return self.parametric.at(np.concatenate([level, way]))

    def begun(self, x: Vector) -> list[FrontDesign]:
        """Designs from variables (n, k) at their own levels, without curvature."""
        units = self.unit(x)
        size = self.evaluator.space.size
        return self._at_own(
            [
                FrontStart(unit, np.ones(len(unit)), self.from_x(one, 0.0), np.eye(size))
                for one, unit in zip(x.T, units.T, strict=True)
            ]
        )

    def placed(self, designs: Sequence[FrontDesign]) -> list[FrontDesign]:
        """The designs at their own levels, for which every design of a front is the best."""
        if not designs:
            return []
        units = self.unit(np.stack([design.point.x[:-1] for design in designs], axis=1))
        way = np.ones(len(units))
        starts = [
            FrontStart(unit, way, self.to_t(design.point.z, 0.0), design.hessian)
            for design, unit in zip(designs, units.T, strict=True)
        ]
        return self._at_own(starts)

    def _at_own(self, starts: Sequence[FrontStart]) -> list[FrontDesign]:
        """The designs at the starts, with their gradients."""
        z = np.stack([start.z for start in starts], axis=1)
        if not self.exact:
            x = self.evaluator.space.to_x(z)
            return [self.located(start, one) for start, one in zip(starts, x.T, strict=True)]
        points = self._changed(starts).points(z)
        return [self._design(s, p, s.hessian) for s, p in zip(starts, points, strict=True)]

    def prices(self, front_design: FrontDesign) -> Vector:
        """Price of each objective's level at a design (objectives,)."""
        m, count = len(self.objectives.problem.constraint_names), self.objectives.count
        jacobian = self.evaluator.jacobian(front_design.point)
        active = kkt.active_set(self.evaluator, front_design.point)
        equalities = jacobian[1 + self.evaluator.constraint_count :]
        held, _ = kkt.multipliers(jacobian[0], active, equalities)
        every = np.zeros(self.evaluator.constraint_count)
        every[active.constraint] = held[: len(active.constraint)]
        return every[m : m + count]

    def solve(
        self, starts: Sequence[FrontStart], known: Sequence[FrontDesign] = ()
    ) -> list[FrontDesign | None]:
        """The design at the levels of each start, or None.

        Where the starts fail, descents start from the `known` designs.
        """
        if not starts:
            return []
        found: list[FrontDesign | None] = [None] * len(starts)
        if self.exact:
            found = self._follow(starts)
            left = [k for k, one in enumerate(found) if one is None]
            if known and left:
                self._descend(starts, found, left, known)
            return found
        return [self._alone(start) for start in starts]

    def exchange(
        self, designs: list[FrontDesign], others: Vector, rest: Vector
    ) -> list[FrontDesign]:
        """The designs, each replaced where another design's variables are better.

        Parameters
        ----------
        designs : as found
        others : variables (n, k) of further feasible designs
        rest : normalised objectives of these (objectives, k)
        """
        lost: set[int] = set()
        for _ in range(ROUNDS if designs else 0):
            x = np.concatenate(
                [np.stack([d.point.x[:-1] for d in designs], axis=1), others], axis=1
            )
            units = np.concatenate([np.stack([d.unit for d in designs], axis=1), rest], axis=1)
            better = []
            for k, design in enumerate(designs):
                if k in lost:
                    continue
                levels = ((units - design.level[:, None]) / design.way[:, None]).max(axis=0)
                best = int(np.argmin(levels))
                if levels[best] < design.point.objective - BETTER:
                    better.append((k, x[:, best], float(levels[best])))
            if not better:
                break
            starts = [
                FrontStart(designs[k].level, designs[k].way, self.from_x(z, t), designs[k].hessian)
                for k, z, t in better
            ]
            for (k, _, t), new in zip(better, self._descended(starts), strict=True):
                if new is not None and new.point.objective <= t + BETTER:
                    designs[k] = new
                else:
                    lost.add(k)
        return designs

    def spread(self, designs: list[FrontDesign], begun: Sequence[FrontDesign]) -> list[FrontDesign]:
        """The designs, each replaced where a descent from another start is better."""
        news = list(begun)
        while news:
            levels = np.stack([new.level for new in news], axis=1)
            starts = []
            for design in designs:
                near = news[int(np.argmin(distances(levels, design.level)))]
                t = float(((near.unit - design.level) / design.way).max())
                starts.append(
                    FrontStart(design.level, design.way, self.to_t(near.point.z, t), near.hessian)
                )
            news = []
            for k, new in enumerate(self._descended(starts)):
                if new is not None and new.point.objective < designs[k].point.objective - BETTER:
                    designs[k] = new
                    news.append(new)
        return designs

    def _descended(self, starts: Sequence[FrontStart]) -> list[FrontDesign | None]:
        """The designs reached by descents from feasible starts."""
        if not self.exact:
            return [self._alone(start) for start in starts]
        return self._follow(starts)

    def _changed(self, starts: Sequence[FrontStart]) -> ChangedProblems:
        """The problems at the levels of some starts."""
        levels = np.stack([np.concatenate([start.level, start.way]) for start in starts], axis=1)
        return ChangedProblems(self.parametric, self.evaluator, levels)

    def _descent(self, hessian: Vector, radius: float = RADIUS) -> Descent:
        """A descent that begins with a Hessian."""
        rows = self.evaluator.constraint_count
        return Descent(hessian, self.scale, rows, 1.0, radius=radius)

    def _follow(self, starts: Sequence[FrontStart]) -> list[FrontDesign | None]:
        """Full steps; where they do not converge, again with the curvature of the last point."""
        designs: list[FrontDesign | None] = [None] * len(starts)
        left, begun = list(range(len(starts))), list(starts)
        for again in range(1 + CURVED):
            z = np.stack([one.z for one in begun], axis=1)
            ways = [self._descent(one.hessian, radius=kkt.RADIUS) for one in begun]
            found = self._changed(begun).step_fully(ways, z)
            for k, one, point, way in zip(left, begun, found, ways, strict=True):
                if point is not None:
                    designs[k] = self._design(one, point, way.hessian)
            lost = [
                i for i, way in enumerate(ways)
                if found[i] is None and way.point is not None and np.isfinite(way.step).all()
            ]  # fmt: skip
            if again == CURVED or not lost:
                break
            bent = free_hessians(self.evaluator, [ways[i] for i in lost])
            begun = [
                replace(begun[i], z=ways[i].known.z, hessian=hessian)
                for i, hessian in zip(lost, bent, strict=True)
            ]
            left = [left[i] for i in lost]
        return designs

    def _descend(
        self,
        starts: Sequence[FrontStart],
        found: list[FrontDesign | None],
        left: list[int],
        known: Sequence[FrontDesign],
    ) -> None:
        """Descend from the best known design at each level, within trust regions."""
        units = np.stack([one.unit for one in known], axis=1)
        begun, ways = [], []
        for k in left:
            moving = starts[k].way > 0
            level, slope = starts[k].level[moving, None], starts[k].way[moving, None]
            t = ((units[moving] - level) / slope).max(axis=0)
            best = known[int(np.argmin(t))]
            begun.append(self.to_t(best.point.z, float(t.min())))
            ways.append(self._descent(best.hessian))
        chosen = [starts[k] for k in left]
        points = self._changed(chosen).descend(ways, np.stack(begun, axis=1))
        for k, point, way in zip(left, points, ways, strict=True):
            if point is not None:
                found[k] = self._design(starts[k], point, way.hessian)

    def _alone(self, start: FrontStart) -> FrontDesign | None:
        """One design alone, by the most robust methods."""
        problem = replace(self.at(start.level, start.way), start=None)
        x = self.evaluator.space.to_x(start.z[:, None])[:, 0]
        best = solve(problem, starts=1, samples=0, more_starts=[x])
        if best.violation > FEASIBLE or best.kkt is None or best.kkt.residual > FEASIBLE:
            return None
        return self.located(start, best.x)

    def polished(self, front_design: FrontDesign) -> FrontDesign:
        """The design after exact Newton steps."""
        own = self.like(self.at(front_design.level, front_design.way))
        point = kkt.polish(own, own.point(front_design.point.z))
        own.jacobian(point)
        return self._design(
            FrontStart(front_design.level, front_design.way, point.z, front_design.hessian),
            point,
            front_design.hessian,
        )

    def located(self, start: FrontStart, x: Vector) -> FrontDesign:
        """The design at variables with t (n + 1,), with its gradients."""
        own = self.like(self.at(start.level, start.way))
        point = own.point(own.space.to_z(x))
        own.jacobian(point)
        return self._design(start, point, start.hessian)

    def _design(self, start: FrontStart, point: Point, hessian: Vector) -> FrontDesign:
        m = len(self.objectives.problem.constraint_names)
        rows = point.rows[1 + m : 1 + m + self.objectives.count]
        unit = start.level + start.way * point.objective - rows
        return FrontDesign(start.level, start.way, point, unit, hessian)

    def like(self, problem: BoxProblem) -> Evaluator:
        """An evaluator of a problem, reusing the gradient check."""
        own = Evaluator(problem)
        own.complex_works = self._checked.complex_works
        own.difference_rows = self._checked.difference_rows
        return own


EQUAL = 1e-8
"""Normalised difference that counts as equal, as bounded objectives vary by this much."""
JUMP = 5.0
"""Step of the variables between neighbours, over the median, that suggests another valley."""


@dataclass
class FrontSearch:
    """The designs so far, with other known feasible points."""

    tracer: Tracer
    designs: list[FrontDesign]
    others: Vector
    """Variables (n, k) of further feasible designs."""
    passed: list[Vector] = field(default_factory=list)
    """Objectives of designs that were replaced."""
    lost: list[Vector] = field(default_factory=list)
    """Levels without a design."""
    _rest: tuple[Vector, Vector] | None = None
    _residuals: dict[int, tuple[FrontDesign, float]] = field(default_factory=dict)

    def solve(self, starts: Sequence[FrontStart], *, firmly: bool = True) -> int:
        """Add the designs at the levels of some starts; returns their number.

        `firmly` : retry those that shared steps lose within trust regions
        """
        good = [one for one in self.found(starts, firmly=firmly) if one is not None]
        self.take(good)
        return len(good)

    def found(
        self, starts: Sequence[FrontStart], *, firmly: bool = True
    ) -> list[FrontDesign | None]:
        """The designs at the levels of some starts, not added yet; see `solve`."""
        found = self.tracer.solve(starts, self.designs if firmly else ())
        self.lost += [s.level for s, one in zip(starts, found, strict=True) if one is None]
        return found

    def compared(self, starts: Sequence[FrontStart]) -> list[FrontDesign | None]:
        """As `found`, but continue from a known design where it is better at the level."""
        found = self.found(starts)
        good = [k for k, one in enumerate(found) if one is not None]
        known = np.stack([design.point.x[:-1] for design in self.designs], axis=1)
        more = np.concatenate([self.others, known], axis=1)
        rest = np.concatenate([self.rest, self.units], axis=1)
        exchanged = self.tracer.exchange([one for one in found if one is not None], more, rest)
        for k, one in zip(good, exchanged, strict=True):
            found[k] = one
        return found

    def take(self, good: Sequence[FrontDesign]) -> None:
        """Add designs, and exchange results between them."""
        before = [*self.designs, *good]
        self.designs = self.tracer.exchange(list(before), self.others, self.rest)
        news = [new for old, new in zip(before, self.designs, strict=True) if old is not new]
        self.designs = self.tracer.spread(self.designs, news)
        self._pass([o for o, new in zip(before, self.designs, strict=True) if o is not new])

    def _pass(self, designs: Sequence[FrontDesign]) -> None:
        """Record the objectives of designs that are replaced."""
        self.passed += [self.tracer.values(design.unit[:, None])[:, 0] for design in designs]

    def rescale(self, low: Vector, wide: Vector) -> None:
        """Normalise to another range (objectives,), in current units."""
        tracer = self.tracer
        tracer.rescale(tracer.ideal + low * tracer.width, wide * tracer.width)
        self.designs = tracer.placed(self.designs)
        self.lost.clear()

    @property
    def plane(self) -> Vector:
        """The designs (objectives, k) projected on the plane of equal sums."""
        units = self.units
        return np.asarray(units - units.mean(axis=0))

    def sort(self) -> None:
        """Sort the designs by their level of the first objective."""
        self.designs.sort(key=lambda one: one.level[0])

    @cached_property
    def _conditions(self) -> Conditions:
        return Conditions(self.tracer.objectives)

    def residual(self, k: int) -> float:
        """Residual of a design's optimality conditions, improved by Newton steps if necessary."""
        one = self.designs[k]
        known = self._residuals.get(id(one))
        if known is not None and known[0] is one:
            return known[1]
        found = self._conditions.residual(one.point)
        if found > RESIDUAL:
            self.designs[k] = one = self.tracer.polished(one)
            found = self._conditions.residual(one.point)
        self._residuals[id(one)] = (one, found)
        return found

    def consider(self, x: Vector) -> None:
        """Compare the designs with further feasible ones (n, k)."""
        self.others = np.concatenate([self.others, x], axis=1)
        self.take([])

    def cross(self) -> None:
        """Retry each side of a jump in the variables from the other side."""
        self.sort()
        z = np.stack([design.point.z[:-1] for design in self.designs], axis=1)
        steps = np.abs(np.diff(z, axis=1)).max(axis=0)
        starts, chosen = [], []
        for k in np.flatnonzero(steps > JUMP * np.median(steps)).tolist():
            for to, way in ((k, k + 1), (k + 1, k)):
                one, other = self.designs[to], self.designs[way]
                at = self.tracer.to_t(other.point.z, float((other.unit - one.level).max()))
                starts.append(FrontStart(one.level, one.way, at, other.hessian))
                chosen.append(to)
        for to, new in zip(chosen, self.tracer.solve(starts), strict=True):
            if new is not None and new.point.objective < self.designs[to].point.objective - BETTER:
                self._pass([self.designs[to]])
                self.designs[to] = new
                self.designs = self.tracer.spread(self.designs, [new])

    @property
    def rest(self) -> Vector:
        """Normalised objectives of the further designs (objectives, k)."""
        if self._rest is None or self._rest[0] is not self.others:
            self._rest = self.others, self.tracer.objectives.values(self.others)
        return self.tracer.normal(self._rest[1])

    @property
    def units(self) -> Vector:
        """Normalised objectives of all designs (objectives, k)."""
        return np.stack([design.unit for design in self.designs], axis=1)

    def chosen(self) -> Indices:
        """The distinct non-dominated designs, those at all levels first."""
        order = np.array(sorted(range(len(self.designs)), key=lambda k: not self.designs[k].held))
        units = self.units
        own = distinct(units, order.astype(np.intp))
        every = np.concatenate([units[:, own], self.rest + BETTER], axis=1)
        equal = EQUAL if len(units) > 2 else 0.0
        best = nondominated(every, equal)[: len(own)]
        return np.sort(own[best])
