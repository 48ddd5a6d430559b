"""The best point of a problem some of whose variables may only take listed values.

Branch and bound from the continuous optimum, the most promising box first, and of those about as
promising the newest, which is the deepest. The bound of a box is its continuous optimum,
re-optimised from that of the box around it. That optimum is a local one, so the result is the best
found and no proof. All roundings up and down come before, at once. A small box that leaves nothing
to optimise is evaluated whole, in one call of the model.
"""

from __future__ import annotations

import heapq
import itertools
import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..base.numeric import Array
from .descents import FEASIBLE
from .evaluator import Evaluator, Point
from .listed import ON, Assignment, Box, Listed, between, with_rows
from .problem import BoxProblem, ParametricProblem, Values, Vector
from .resolve.boxes import EXACT, ROUGH, BoxTask, Criteria, Nearest, resolve_boxes
from .resolve.changed import ChangedProblems, applicable
from .resolve.hessians import ScaledHessian, hessian_at
from .resolve.steps import valley_at

MOST_SOLVES = 400
"""Most re-optimisations of one search."""

MOST_NEIGHBOURS = 256
"""Most roundings up and down tried at once: all of them up to eight listed variables."""

MOST_MISSED = 4
"""Most assignments looked at closely to say what the nearest one misses."""

MOST_LISTED = 1024
"""Most assignments of a box that are evaluated together, where nothing else may move."""

TIE = 0.01
"""Bounds this near are as promising: a share of the distance from the least bound to the best
design, so that it holds on every scale of the objective. A choice."""

CLOSE = 1e-7
"""Relative difference to a bound that counts as none: bounds are known so well."""


@dataclass
class Found:
    """The best point, every assignment tried with its objective, and how far the search went.

    Parameters
    ----------
    x, objective, assignment : of the best; None where nothing feasible was found
    tried : objective of each assignment, infinite where none was feasible
    solves : re-optimisations, of boxes and of assignments
    complete : whether the search ended by itself, not at a limit
    nearest, missed : where nothing feasible was found: the assignment that misses least of those
        looked at closely, and the point where it does
    ends : where every box ended, its optimum or the point that misses least, with what it was
        evaluated by; empty where a box has neither
    """

    x: Vector | None
    objective: float | None
    assignment: Assignment | None
    tried: dict[Assignment, float]
    solves: int
    complete: bool
    nearest: Assignment | None = None
    missed: Point | None = None
    ends: tuple[tuple[Evaluator, Point], ...] = ()


def search(
    problem: BoxProblem,
    listed: Sequence[Listed],
    x: Vector,
    *,
    most: int = MOST_SOLVES,
    until: float | None = None,
    below: float = np.inf,
    memory: Memory | None = None,
) -> Found:
    """The best point with every listed variable at one of its values.

    Parameters
    ----------
    problem : the continuous problem
    listed : the groups of its listed variables
    x : the continuous optimum (n,)
    most : limit of re-optimisations
    until : time of `time.perf_counter` to stop at
    below : only a better objective than this one is of interest
    memory : of searches of problems much like this one, with the same rows; gets what this finds
    """
    remembered = memory is not None and memory.hessian is not None
    run = _Run(problem, listed, x, most, until, below, memory or Memory())
    if remembered:
        run.look_ahead()
    else:
        run.neighbours()
    whole = tuple(tuple(range(len(one.rows))) for one in listed)
    boxes = _Boxes()
    if run.evaluates(whole):
        run.evaluate(whole)
    elif remembered:
        boxes.add(run.start.objective, whole, run.x)
    else:
        run.relax([whole], run.x, boxes)
    while boxes and not run.exhausted:
        bound, box, x = boxes.take(run.best)
        if not run.beaten(bound):
            run.relax(run.parts(box, x, bound), x, boxes)
    return run.found(complete=all(run.beaten(bound) for bound in boxes.bounds()))


class _Boxes:
    """Boxes left to search, by their bounds and by their age."""

    def __init__(self) -> None:
        self._entries: dict[int, tuple[float, Box, Vector]] = {}
        self._lowest: list[tuple[float, int]] = []
        self._count = itertools.count()

    def __bool__(self) -> bool:
        return bool(self._entries)

    def bounds(self) -> list[float]:
        """The bound of every box left."""
        return [bound for bound, *_ in self._entries.values()]

    def add(self, bound: float, box: Box, x: Vector) -> None:
        """Keep a box with its bound and its continuous optimum."""
        number = next(self._count)
        self._entries[number] = bound, box, x
        heapq.heappush(self._lowest, (bound, number))

    def take(self, best: float) -> tuple[float, Box, Vector]:
        """The newest box where it is as promising as any, else the one of least bound."""
        while self._lowest[0][1] not in self._entries:
            heapq.heappop(self._lowest)
        least, number = self._lowest[0]
        newest = next(reversed(self._entries))
        room = TIE * (best - least) if best < np.inf else np.inf
        return self._entries.pop(newest if self._entries[newest][0] <= least + room else number)


def at(
    problem: BoxProblem, listed: Sequence[Listed], assignment: Assignment, x: Vector, memory: Memory
) -> float | None:
    """The objective of one assignment, re-optimised; None where it is infeasible."""
    objective = _Run(problem, listed, x, 1, None, np.inf, memory).assigned(assignment, x)
    return objective if objective < np.inf else None


@dataclass
class Memory:
    """Where the boxes of a search ended, from where those of a problem much like it are near."""

    hessian: ScaledHessian | None = None
    ends: dict[Box, tuple[Evaluator, Point]] = field(default_factory=dict)
    hessians: dict[Box, ScaledHessian | None] = field(default_factory=dict)
    missed: dict[Box, Vector] = field(default_factory=dict)
    """The least violated points of boxes without a feasible one."""
    visited: tuple[Box, ...] = ()
    """The boxes whose continuous optimum the last search wanted."""

    def near(self, box: Box) -> tuple[Vector, ScaledHessian | None] | None:
        """The optimum in a box of another problem, and its Hessian."""
        end = self.ends.get(box)
        if end is None:
            return None
        if box not in self.hessians:
            self.hessians[box] = hessian_at(*end)
        return end[1].x, self.hessians[box]

    def note(self, box: Box, evaluator: Evaluator, found: Nearest) -> None:
        """Keep where a box ended, unless it was easily reached from what is known."""
        if found.optimum is not None and not (found.followed and box in self.ends):
            self.ends[box] = evaluator, found.optimum
            self.hessians.pop(box, None)
        elif found.optimum is None and found.missed is not None:
            self.missed.setdefault(box, found.missed.x)


@dataclass
class _Run:
    """The state of one search."""

    problem: BoxProblem
    listed: Sequence[Listed]
    x: Vector
    most: int
    until: float | None
    below: float
    memory: Memory
    solves: int = 0
    tried: dict[Assignment, float] = field(default_factory=dict)
    points: dict[Assignment, Vector] = field(default_factory=dict)
    near: dict[Assignment, Vector] = field(default_factory=dict)
    ends: list[tuple[Evaluator, Point | None]] = field(default_factory=list)
    visited: list[Box] = field(default_factory=list)
    ahead: dict[Box, tuple[BoxTask, Nearest]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.index = np.concatenate([one.index for one in self.listed]).astype(np.intp)
        self.reference = Evaluator(self.problem)
        self.start = start = self.reference.point(self.reference.space.to_z(self.x))
        self.x = start.x
        others = np.setdiff1d(np.arange(len(self.x)), self.index)
        self.only_listed = bool((self.problem.lower == self.problem.upper)[others].all())
        self.least = np.inf
        if self.memory.hessian is None and start.valid and self.reference.space.size:
            self.reference.check_gradients(start)
            self.memory.hessian = hessian_at(self.reference, start)

    @property
    def exhausted(self) -> bool:
        """Whether a limit is reached."""
        late = self.until is not None and time.perf_counter() > self.until
        return late or self.solves >= self.most

    @property
    def best(self) -> float:
        """The objective to beat."""
        return min(self.below, self.least)

    def note(self, assignment: Assignment, objective: float) -> None:
        """Store the value of an assignment, or a more exact one."""
        worse = self.tried.get(assignment, np.inf) <= self.least < objective
        self.tried[assignment] = objective
        self.least = min(self.tried.values()) if worse else min(self.least, objective)

    def beaten(self, bound: float) -> bool:
        """Whether nothing above a bound can improve on what is known."""
        best = self.best
        return best < np.inf and bound >= best - CLOSE * abs(best)

    def values(self, assignment: Assignment) -> Vector:
        """Values of the listed variables (d,)."""
        pairs = zip(self.listed, assignment, strict=True)
        return np.concatenate([one.rows[row] for one, row in pairs])

    def neighbours(self) -> None:
        """Try every rounding up and down, all at once where the problem allows."""
        sides = [one.around(self.x[list(one.index)]) for one in self.listed]
        chosen = list(itertools.islice(itertools.product(*sides), MOST_NEIGHBOURS))
        for assignment, near in self.together(chosen):
            if near is None:
                self.note(assignment, np.inf)
            elif not self.exhausted:
                self.assigned(assignment, near)
        self.confirmed()

    def together(self, chosen: list[Assignment]) -> list[tuple[Assignment, Vector | None]]:
        """Re-optimise assignments at once; what is left, with a start each (None: none nearby)."""
        here = self.x[self.index]
        point, evaluator = self._near(here, here, self.x)
        names = [self.problem.names[i] for i in self.index]

        def evaluate(points: Array, values: Array) -> Values:
            full = np.array(points)
            full[self.index] = values
            return self.problem.evaluate(full)

        parametric = ParametricProblem(evaluator.problem, names, here, evaluate)
        suits = point.valid and evaluator.space.size and applicable(parametric, evaluator)
        if not suits or not chosen:
            return [(assignment, self.x) for assignment in chosen]
        values = np.stack([self.values(assignment) for assignment in chosen], axis=1)
        starts = np.repeat(point.z[:, None], len(chosen), axis=1)
        changed = ChangedProblems(parametric, evaluator, values)
        known = changed.near_optimum(valley_at(evaluator, point), starts)
        left = [k for k, optimum in enumerate(known) if optimum is None]
        near = changed.chosen(left).restore(point.z)
        for assignment, optimum in zip(chosen, known, strict=True):
            self.solves += 1
            if optimum is not None:
                self.note(assignment, optimum.objective)
                self.near[assignment] = optimum.x
        return [
            (chosen[k], None if z is None else evaluator.space.to_x(z[:, None])[:, 0])
            for k, z in zip(left, near, strict=True)
        ]

    def assigned(self, assignment: Assignment, near: Vector) -> float:
        """Re-optimise the other variables of an assignment; infinite where that is infeasible."""
        if assignment not in self.points:
            values = self.values(assignment)
            box = tuple((row,) for row in assignment)
            (found,) = self._descended([(box, values, values)], near, EXACT)
            self.note(assignment, np.inf if found is None else found.objective)
            if found is not None:
                self.points[assignment] = found.x
        return self.tried[assignment]

    def confirmed(self) -> Assignment | None:
        """The best assignment, once its point is known too; None where none is feasible."""
        while True:
            best = min(self.tried, key=lambda one: self.tried[one], default=None)
            if best is None or not self.tried[best] < self.below:
                return None
            if best in self.points:
                return best
            self.assigned(best, self.near.get(best, self.x))

    def look_ahead(self) -> None:
        """Re-optimise the boxes of the last search at once: most of them are wanted again."""
        tasks = [self._task(box, *self._bounds(box), self.x, ROUGH) for box in self.memory.visited]
        ends = resolve_boxes(tasks)
        self.ahead = dict(zip(self.memory.visited, zip(tasks, ends, strict=True), strict=True))

    def evaluates(self, box: Box) -> bool:
        """Whether every assignment of a box can be evaluated at once."""
        return self.only_listed and math.prod(map(len, box)) <= MOST_LISTED

    def evaluate(self, box: Box) -> None:
        """Evaluate every assignment of a box that leaves nothing to optimise."""
        chosen = list(itertools.product(*box))
        points = np.repeat(self.x[:, None], len(chosen), axis=1)
        for one, rows in zip(self.listed, np.array(chosen).T, strict=True):
            points[list(one.index)] = one.rows[rows].T
        values = Evaluator.screen(self.problem.rows(points))
        met = self.reference.violations(values, "worst") <= FEASIBLE
        objectives = np.where(met, values[0], np.inf).tolist()
        for assignment, objective in zip(chosen, objectives, strict=True):
            self.tried.setdefault(assignment, objective)
        self.least = min(self.least, *objectives)
        self.solves += 1
        self.ends.append((self.reference, None))  # no optimum of a box to compare with

    def relax(self, parts: Sequence[Box], near: Vector, boxes: _Boxes) -> None:
        """Add the boxes whose continuous optimum may improve on what is known."""
        large = []
        for box in parts:
            if self.evaluates(box):
                self.evaluate(box)
            else:
                large.append(box)
        self.visited += large
        bounds = [(box, *self._bounds(box)) for box in large]
        for box, point in zip(large, self._descended(bounds, near, ROUGH), strict=True):
            if point is not None and not self.beaten(point.objective):
                boxes.add(point.objective, box, point.x)

    def _bounds(self, box: Box) -> tuple[Vector, Vector]:
        """Bounds of the listed variables in a box."""
        left = [one.rows[list(rows)] for one, rows in zip(self.listed, box, strict=True)]
        lower = np.concatenate([rows.min(axis=0) for rows in left])
        return lower, np.concatenate([rows.max(axis=0) for rows in left])

    def parts(self, box: Box, x: Vector, objective: float) -> list[Box]:
        """What is left to search of a box, given its continuous optimum."""
        widest: float = ON
        halves: tuple[int, list[list[int]]] | None = None
        for k, (one, rows) in enumerate(zip(self.listed, box, strict=True)):
            for column, index in enumerate(one.index):
                values = one.values(column, rows)
                below, above, share = between(values, float(x[index]))
                if share > widest:
                    of = one.rows[:, column]
                    widest = share
                    parts = [
                        [r for r in rows if of[r] <= below],
                        [r for r in rows if of[r] >= above],
                    ]
                    halves = k, parts if x[index] - below > above - x[index] else parts[::-1]
        if halves is not None:  # the nearer one last
            return [with_rows(box, halves[0], tuple(half)) for half in halves[1]]
        found = [
            one.at(x[list(one.index)], rows) for one, rows in zip(self.listed, box, strict=True)
        ]
        if None in found:  # every value is listed, but not together
            k = found.index(None)
            one, rows = self.listed[k], box[k]
            nearest = min(rows, key=lambda r: float(np.abs(one.rows[r] - x[list(one.index)]).sum()))
            return [with_rows(box, k, part) for part in [*one.parts(rows, nearest), (nearest,)]]
        assignment = tuple(row for row in found if row is not None)
        room = CLOSE * abs(objective)
        if self.assigned(assignment, x) <= objective + room:
            return []  # nothing else in the box can be better
        left = []
        for k, row in enumerate(assignment):
            left += [with_rows(box, k, part) for part in self.listed[k].parts(box[k], row)]
            box = with_rows(box, k, (row,))
        return left

    def found(self, *, complete: bool) -> Found:
        """What the search comes to."""
        self.memory.visited = tuple(self.visited)
        best = self.confirmed()
        x, objective, nearest, missed = None, None, None, None
        if best is not None:
            x, objective = self.points[best], self.tried[best]
        elif not self.below < np.inf:
            nearest, missed = self.nearest()
        ends = tuple((evaluator, end) for evaluator, end in self.ends if end is not None)
        ends = ends if len(ends) == len(self.ends) else ()
        tried, solves = self.tried, self.solves
        return Found(x, objective, best, tried, solves, complete, nearest, missed, ends)

    def nearest(self) -> tuple[Assignment, Point] | tuple[None, None]:
        """The assignment that misses least of the first ones, and the point where it does."""
        found = []
        for assignment in list(self.tried)[:MOST_MISSED]:
            box = tuple((row,) for row in assignment)
            values = self.values(assignment)
            point, _ = self._near(values, values, self.memory.missed.get(box, self.x))
            if box not in self.memory.missed and point.valid and not self.exhausted:
                self.assigned(assignment, self.x)
                near = self.memory.missed.get(box, self.x)
                point, _ = self._near(values, values, near)
            if point.valid:
                found.append((point.violation, assignment, point))
        if not found:
            return None, None
        _, assignment, point = min(found, key=lambda one: one[0])
        return assignment, point

    def _within(self, lower: Vector, upper: Vector) -> Evaluator:
        """The problem with the listed variables in bounds."""
        least, most = self.problem.lower.copy(), self.problem.upper.copy()
        least[self.index], most[self.index] = lower, upper
        evaluator = Evaluator(replace(self.problem, lower=least, upper=most, start=None))
        evaluator.complex_works = self.reference.complex_works
        evaluator.difference_rows = self.reference.difference_rows
        evaluator.eager = True
        return evaluator

    def _near(self, lower: Vector, upper: Vector, near: Vector) -> tuple[Point, Evaluator]:
        """The point within bounds of the listed variables that is nearest to another."""
        evaluator = self._within(lower, upper)
        return evaluator.point(evaluator.space.to_z(evaluator.problem.inside(near))), evaluator

    def _task(
        self, box: Box, lower: Vector, upper: Vector, near: Vector, criteria: Criteria
    ) -> BoxTask:
        """A box to re-optimise, near a point or where a like problem ended."""
        known = self.memory.near(box)
        hopeless = known is None and box in self.memory.missed
        x, hessian = known or (self.memory.missed.get(box, near), self.memory.hessian)
        evaluator = self._within(lower, upper)
        above = self.best if criteria is ROUGH else np.inf
        x = evaluator.problem.inside(x)
        return BoxTask(evaluator, x, hessian, criteria, hopeless, above)

    def _descended(
        self, bounds: Sequence[tuple[Box, Vector, Vector]], near: Vector, criteria: Criteria
    ) -> list[Point | None]:
        """The optimum in boxes, near a point or where a like problem ended; None without."""
        known = self.ahead if criteria is ROUGH else {}
        tasks = {
            box: self._task(box, lower, upper, near, criteria)
            for box, lower, upper in bounds
            if box not in known
        }
        ends = resolve_boxes(list(tasks.values()))
        done = known | dict(zip(tasks, zip(tasks.values(), ends, strict=True), strict=True))
        self.solves += len(bounds)
        found = []
        for box, _, _ in bounds:
            task, end = done[box]
            self.memory.note(box, task.evaluator, end)
            self.ends.append((task.evaluator, end.optimum or end.missed))
            found.append(end.optimum)
        return found
