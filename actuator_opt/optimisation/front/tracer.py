"""The designs of a front at given levels: many at once, from the designs next to them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from .. import lockstep
from ..descents import FEASIBLE
from ..evaluator import Evaluator, Point
from ..problem import Problem, Vector
from ..solver import solve
from .curvature import hessians as hessians_at
from .dominance import distances
from .objectives import HIGHEST, Objectives

BETTER = 1e-7
"""Normalised level by which another design must be better to be another valley."""

HELD = 1e-6
"""Normalised objective below its level that still counts as at it."""

ROUNDS = 4
"""Most exchanges of what was found; each goes on only where the last one gained."""

CURVED = 2
"""Times that the curvature is taken anew where full steps do not settle."""

ALONE = 8
"""Most designs of one call that are searched for by themselves where common steps fail."""


@dataclass(frozen=True)
class Design:
    """A design that is best at its levels, as far as is known.

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
        """Whether every objective is at its level: else the front has an edge or a jump here."""
        room = self.level + self.way * self.point.objective - self.unit
        return bool((room <= HELD).all())


@dataclass(frozen=True)
class Start:
    """Where to look for the design at some levels: coordinates with t, and a Hessian."""

    level: Vector
    way: Vector
    z: Vector
    hessian: Vector


class Tracer:
    """Finds designs of a front in common steps.

    Parameters
    ----------
    objectives : what is wanted
    ideal, width : of the normalisation
    first : variables of a design (n,) to check gradients at and to take the first Hessian from
    """

    def __init__(self, objectives: Objectives, ideal: Vector, width: Vector, first: Vector) -> None:
        self.objectives = objectives
        self._scale(ideal, width)
        self.scale = float(self.evaluator.space.scale[-1])
        at = self.from_x(first, HIGHEST / 2)
        self.warnings = self.evaluator.check_gradients(self.evaluator.point(at))
        self.exact = lockstep.applicable(self.parametric, self.evaluator)
        self.solves = 0

    def _scale(self, ideal: Vector, width: Vector) -> None:
        self.ideal, self.width = ideal, width
        self.parametric = self.objectives.scaled(ideal, width)
        self.evaluator = Evaluator(self.parametric.problem)

    def rescale(self, ideal: Vector, width: Vector) -> None:
        """Normalise otherwise; the designs found until then are of no more use."""
        before = self.evaluator
        self._scale(ideal, width)
        self.evaluator.complex_works = before.complex_works
        self.evaluator.difference_rows = before.difference_rows

    def from_x(self, x: Vector, t: float) -> Vector:
        """Coordinates (nf,) of variables (n,) at a level t."""
        return self.evaluator.space.to_z(np.append(x, t))

    def to_t(self, z: Vector, t: float) -> Vector:
        """The same coordinates at another level t."""
        space = self.evaluator.space
        return np.append(z[:-1], np.clip(t / self.scale, space.lower[-1], space.upper[-1]))

    def unit(self, x: Vector) -> Vector:
        """Normalised objectives (objectives, k) of variables (n, k)."""
        return (self.objectives.values(x) - self.ideal[:, None]) / self.width[:, None]

    def at(self, level: Vector, way: Vector) -> Problem:
        """The problem at some levels."""
        return self.parametric.at(np.concatenate([level, way]))

    def begin(self, x: Vector, level: Vector, way: Vector) -> Design:
        """A design with its gradients, as a start for others; nothing is known of its curvature."""
        own = self.unit(x[:, None])[:, 0]
        moving = way > 0
        t = float(((own - level)[moving] / way[moving]).max())
        z = self.from_x(x, t)
        return self.located(Start(level, way, z, np.eye(len(z))), np.append(x, t))

    def solve(self, starts: Sequence[Start], known: Sequence[Design] = ()) -> list[Design | None]:
        """The design at the levels of each start; None where none is found.

        `known` are designs from which the way down is tried where the starts lead nowhere.
        """
        if not starts:
            return []
        self.solves += len(starts)
        found: list[Design | None] = [None] * len(starts)
        if self.exact:
            found = self._follow(starts)
            left = [k for k, one in enumerate(found) if one is None]
            if known and left:
                self._descend(starts, found, left, known)
        left = [k for k, one in enumerate(found) if one is None]
        for k in left if not self.exact else left[:ALONE] if known else ():
            found[k] = self._alone(starts[k])
        return found

    def exchange(self, designs: list[Design], others: Vector) -> list[Design]:
        """The designs, with every one replaced that another one's variables are better for.

        Parameters
        ----------
        designs : as found
        others : variables (n, k) of more designs that meet every requirement
        """
        lost: set[int] = set()
        for _ in range(ROUNDS):
            x = np.concatenate(
                [np.stack([d.point.x[:-1] for d in designs], axis=1), others], axis=1
            )
            units = np.concatenate(
                [np.stack([d.unit for d in designs], axis=1), self.unit(others)], axis=1
            )
            better = []
            for k, one in enumerate(designs):
                if k in lost:
                    continue
                levels = ((units - one.level[:, None]) / one.way[:, None]).max(axis=0)
                best = int(np.argmin(levels))
                if levels[best] < one.point.objective - BETTER:
                    better.append((k, x[:, best], float(levels[best])))
            if not better:
                break
            starts = [
                Start(designs[k].level, designs[k].way, self.from_x(z, t), designs[k].hessian)
                for k, z, t in better
            ]
            for (k, _, t), new in zip(better, self._descended(starts), strict=True):
                if new is not None and new.point.objective <= t + BETTER:
                    designs[k] = new
                else:
                    lost.add(k)
        return designs

    def spread(self, designs: list[Design], begun: Sequence[Design]) -> list[Design]:
        """The designs, with every one replaced that is better from one of those begun with."""
        news = list(begun)
        while news:
            levels = np.stack([one.level for one in news], axis=1)
            starts = []
            for one in designs:
                near = news[int(np.argmin(distances(levels, one.level)))]
                t = float(((near.unit - one.level) / one.way).max())
                starts.append(Start(one.level, one.way, self.to_t(near.point.z, t), near.hessian))
            news = []
            for k, new in enumerate(self._descended(starts)):
                if new is not None and new.point.objective < designs[k].point.objective - BETTER:
                    designs[k] = new
                    news.append(new)
        return designs

    def _descended(self, starts: Sequence[Start]) -> list[Design | None]:
        """The designs that feasible starts lead down to."""
        self.solves += len(starts)
        if not self.exact:
            return [self._alone(start) for start in starts]
        return self._follow(starts)

    def _parameters(self, starts: Sequence[Start]) -> Vector:
        return np.stack([np.concatenate([one.level, one.way]) for one in starts], axis=1)

    def _follow(self, starts: Sequence[Start]) -> list[Design | None]:
        """Full steps, and where they do not settle again with the curvature where they stood."""
        designs: list[Design | None] = [None] * len(starts)
        left, begun = list(range(len(starts))), list(starts)
        for again in range(1 + CURVED):
            z = np.stack([one.z for one in begun], axis=1)
            hessians = [one.hessian for one in begun]
            found, ways = lockstep.follow(
                self.parametric, self.evaluator, hessians, self.scale, z, self._parameters(begun)
            )
            for k, one, point, way in zip(left, begun, found, ways, strict=True):
                if point is not None:
                    designs[k] = self._design(one, point, way.hessian)
            lost = [
                i for i, way in enumerate(ways)
                if found[i] is None and way.point is not None and np.isfinite(way.step).all()
            ]  # fmt: skip
            if again == CURVED or not lost:
                break
            bent = hessians_at(self.evaluator, [ways[i] for i in lost])
            begun = [
                replace(begun[i], z=ways[i].known.z, hessian=hessian)
                for i, hessian in zip(lost, bent, strict=True)
            ]
            left = [left[i] for i in lost]
        return designs

    def _descend(
        self,
        starts: Sequence[Start],
        found: list[Design | None],
        left: list[int],
        known: Sequence[Design],
    ) -> None:
        """Go down from the known design that is best at the levels."""
        units = np.stack([one.unit for one in known], axis=1)
        begun = []
        for k in left:
            moving = starts[k].way > 0
            level, way = starts[k].level[moving, None], starts[k].way[moving, None]
            t = ((units[moving] - level) / way).max(axis=0)
            best = int(np.argmin(t))
            z = self.to_t(known[best].point.z, float(t[best]))
            begun.append(replace(starts[k], z=z, hessian=known[best].hessian))
        for k, one in zip(left, self._follow(begun), strict=True):
            found[k] = one

    def _alone(self, start: Start) -> Design | None:
        """One design by itself, by the sturdiest means."""
        problem = replace(self.at(start.level, start.way), start=None)
        x = self.evaluator.space.to_x(start.z[:, None])[:, 0]
        best = solve(problem, starts=1, samples=0, more_starts=[x])
        if best.violation > FEASIBLE or best.kkt is None or best.kkt.residual > FEASIBLE:
            return None
        return self.located(start, best.x)

    def located(self, start: Start, x: Vector) -> Design:
        """The design at variables with t (n + 1,), with its gradients."""
        own = self._like(self.at(start.level, start.way))
        point = own.point(own.space.to_z(x))
        own.jacobian(point)
        return self._design(start, point, start.hessian)

    def _design(self, start: Start, point: Point, hessian: Vector) -> Design:
        m = len(self.objectives.problem.constraint_names)
        rows = point.rows[1 + m : 1 + m + self.objectives.count]
        unit = start.level + start.way * point.objective - rows
        return Design(start.level, start.way, point, unit, hessian)

    def _like(self, problem: Problem) -> Evaluator:
        """An evaluator of a problem whose gradients are taken as those of the whole front."""
        own = Evaluator(problem)
        own.complex_works = self.evaluator.complex_works
        own.difference_rows = self.evaluator.difference_rows
        return own
