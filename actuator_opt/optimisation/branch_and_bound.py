"""Branch and bound for variables that only take listed values, singly or in groups.

The search first rounds the listed variables of the continuous optimum in every way (each up or
down) and re-optimises all these designs together. It then splits the most promising box (part of
the search space) again and again; among boxes that are nearly as promising, it takes the newest,
which is the smallest. The bound of a box is the objective of its continuous optimum, which starts
from the optimum of the enclosing box. This optimum is local, so the best point of the search is not
proven to be the best of all. If a small box has no continuous free variables, all its points are
evaluated in one model call.
"""

from __future__ import annotations

import heapq
import itertools
import math
import time
from collections.abc import Sequence
from dataclasses import field, replace
from typing import TypeAlias

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array
from .evaluator import Evaluator, Point
from .problem import BoxProblem, ParametricProblem, PointValues, Vector
from .resolve.boxes import EXACT, ROUGH, BoxTask, Criteria, Nearest, resolve_boxes
from .resolve.changed import ChangedProblems, applicable
from .resolve.steps import ScaledHessian, hessian_at, valley_at
from .solution import MET

ON = 1e-7
"""Distance from a listed value, relative to the range of the list, up to which a variable counts as
having that value."""


SAME = 1e-9
"""Relative difference up to which two objectives count as equal."""


Rows: TypeAlias = tuple[int, ...]
"""For one group of listed variables: the row numbers of the combinations that remain, ascending."""


Box: TypeAlias = tuple[Rows, ...]
"""A part of the search space: the combinations that remain for every group."""


Assignment: TypeAlias = tuple[int, ...]
"""The row number of one chosen combination per group."""


@dataclass(frozen=True, eq=False)
class Listed:
    """Variables whose values are listed together; each row of the list is an allowed combination.

    Parameters
    ----------
    index : numbers of the variables (k,)
    rows : the c allowed combinations (c, k), all different and within the bounds
    """

    index: tuple[int, ...]
    rows: Vector

    def values(self, column: int, rows: Rows) -> Vector:
        """The distinct values of one variable among the given rows, ascending."""
        return np.unique(self.rows[list(rows), column])

    def parts(self, rows: Rows, row: int) -> list[Rows]:
        """Split all rows except `row` into parts, each below or above `row` in one variable."""
        parts: list[Rows] = []
        for column, value in enumerate(self.rows[row]):
            of = self.rows[:, column]
            parts += [
                tuple(k for k in rows if of[k] < value),
                tuple(k for k in rows if of[k] > value),
            ]
            rows = tuple(k for k in rows if of[k] == value)
        return [part for part in parts if part]

    def at(self, x: Vector, rows: Rows) -> int | None:
        """The row among `rows` whose values a point (k,) has, or None."""
        span = np.ptp(self.rows, axis=0)
        matches = np.abs(self.rows[list(rows)] - x) <= ON * span + SAME * np.abs(x)
        positions = np.flatnonzero(matches.all(axis=1))
        return rows[int(positions[0])] if len(positions) else None

    def around(self, x: Vector) -> list[int]:
        """Rows to which a point (k,) can be rounded, the nearest first.

        The list has the nearest row for each way to round, with every value up or down. For a point
        that is on a row, it has only this row.
        """
        all_rows = tuple(range(len(self.rows)))
        own_row = self.at(x, all_rows)
        if own_row is not None:
            return [own_row]
        span = np.ptp(self.rows, axis=0)
        off = (self.rows - x) / np.where(span > 0, span, 1.0)
        distance = np.abs(off).sum(axis=1)
        rows = []
        for sides in itertools.product((1, -1), repeat=len(x)):
            sector = np.flatnonzero((off * sides >= -ON).all(axis=1))
            if len(sector):
                rows.append(int(sector[distance[sector].argmin()]))
        rows = rows or [int(distance.argmin())]
        return sorted(dict.fromkeys(rows), key=lambda row: float(distance[row]))


def with_rows(box: Box, k: int, rows: Rows) -> Box:
    """A copy of the box (see `Box`) in which group k has the given rows."""
    return (*box[:k], rows, *box[k + 1 :])


def between(values: Vector, value: float) -> tuple[float, float, float]:
    """The two listed values around a value, and the relative distance to the nearer."""
    if len(values) == 1:
        return float(values[0]), float(values[0]), 0.0
    k = int(np.clip(np.searchsorted(values, value), 1, len(values) - 1))
    low, high = float(values[k - 1]), float(values[k])
    share = min(value - low, high - value) / (high - low)
    return low, high, max(share, 0.0)


MOST_SOLVES = 400
"""Maximum number of re-optimisations in one search."""

MOST_NEIGHBOURS = 256
"""Maximum number of roundings tried at once: all roundings of eight listed variables."""

MOST_MISSED = 4
"""Maximum number of combinations examined to find the least infeasible combination."""

MOST_LISTED = 1024
"""A box with at most this many combinations, and no continuous free variable, is evaluated in one
call."""

TIE = 0.01
"""Bounds this close count as equally promising. The difference is relative to the distance between
the lowest bound and the best design's objective. Our choice."""

CLOSE = 1e-7
"""Relative difference up to which two bounds count as equal: the accuracy of the bounds."""


@dataclass
class SizeSearch:
    """Result of a search: the best point, and the objective of every combination tried.

    Parameters
    ----------
    x, objective, assignment : of the best point; None if no point is feasible
    tried : objective of each assignment, infinite if infeasible
    solves : number of boxes and assignments re-optimised
    complete : whether the search finished before reaching a limit
    nearest, missed : if no point is feasible, the least infeasible assignment and its point
    ends : evaluator of every box, with the box's optimum or least infeasible point; empty if some
        box has neither
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
    deadline: float | None = None,
    cutoff: float = np.inf,
    memory: Memory | None = None,
) -> SizeSearch:
    """Find the best point at which every listed variable has one of its listed values.

    Parameters
    ----------
    problem : the continuous problem
    listed : the groups of variables that take listed values
    x : the continuous optimum (n,)
    most : maximum number of re-optimisations
    deadline : time of `time.perf_counter` at which the search stops
    cutoff : the search ignores designs whose objective is not better than this
    memory : results from similar problems with the same rows; this search adds its own
    """
    remembered = memory is not None and memory.hessian is not None
    run = _Run(problem, listed, x, most, deadline, cutoff, memory or Memory())
    if remembered:
        run.precompute()
    else:
        run.try_neighbours()
    root = tuple(tuple(range(len(group.rows))) for group in listed)
    boxes = _Boxes()
    if run.can_evaluate(root):
        run.evaluate(root)
    elif remembered:
        boxes.add(run.start.objective, root, run.x)
    else:
        run.relax([root], run.x, boxes)
    while boxes and not run.exhausted:
        bound, box, x = boxes.pop(run.best)
        if not run.beaten(bound):
            run.relax(run.parts(box, x, bound), x, boxes)
    return run.result(complete=all(run.beaten(bound) for bound in boxes.bounds()))


class _Boxes:
    """Boxes (parts of the search space) that wait to be searched, with their bounds and age."""

    def __init__(self) -> None:
        self._entries: dict[int, tuple[float, Box, Vector]] = {}
        self._lowest: list[tuple[float, int]] = []
        self._count = itertools.count()

    def __bool__(self) -> bool:
        return bool(self._entries)

    def bounds(self) -> list[float]:
        """The bounds of all waiting boxes."""
        return [bound for bound, *_ in self._entries.values()]

    def add(self, bound: float, box: Box, x: Vector) -> None:
        """Add a box with its bound and its continuous optimum."""
        number = next(self._count)
        self._entries[number] = bound, box, x
        heapq.heappush(self._lowest, (bound, number))

    def pop(self, best: float) -> tuple[float, Box, Vector]:
        """Remove the newest of the most promising boxes, and return it."""
        while self._lowest[0][1] not in self._entries:
            heapq.heappop(self._lowest)
        lowest_bound, number = self._lowest[0]
        newest = next(reversed(self._entries))
        tolerance = TIE * (best - lowest_bound) if best < np.inf else np.inf
        return self._entries.pop(
            newest if self._entries[newest][0] <= lowest_bound + tolerance else number
        )


def at(
    problem: BoxProblem, listed: Sequence[Listed], assignment: Assignment, x: Vector, memory: Memory
) -> float | None:
    """Re-optimise one assignment and return its objective; None if it is infeasible."""
    objective = _Run(problem, listed, x, 1, None, np.inf, memory).reoptimised(assignment, x)
    return objective if objective < np.inf else None


@dataclass
class Memory:
    """Results for each part of the search space, stored to start similar problems from."""

    hessian: ScaledHessian | None = None
    ends: dict[Box, tuple[Evaluator, Point]] = field(default_factory=dict)
    hessians: dict[Box, ScaledHessian | None] = field(default_factory=dict)
    missed: dict[Box, Vector] = field(default_factory=dict)
    """The least infeasible point of each box that has no feasible point."""
    visited: tuple[Box, ...] = ()
    """Boxes that the last search re-optimised."""

    def warm_start(self, box: Box) -> tuple[Vector, ScaledHessian | None] | None:
        """Optimum and Hessian of an earlier, similar problem in the same box, or None."""
        end = self.ends.get(box)
        if end is None:
            return None
        if box not in self.hessians:
            self.hessians[box] = hessian_at(*end)
        return end[1].x, self.hessians[box]

    def note(self, box: Box, evaluator: Evaluator, end: Nearest) -> None:
        """Store the result of a box, unless it was reached in a few steps from a stored result."""
        if end.optimum is not None and not (end.followed and box in self.ends):
            self.ends[box] = evaluator, end.optimum
            self.hessians.pop(box, None)
        elif end.optimum is None and end.missed is not None:
            self.missed.setdefault(box, end.missed.x)


@dataclass
class _Run:
    """The state of one branch-and-bound search."""

    problem: BoxProblem
    listed: Sequence[Listed]
    x: Vector
    max_solves: int
    deadline: float | None
    cutoff: float
    memory: Memory
    solves: int = 0
    tried: dict[Assignment, float] = field(default_factory=dict)
    points: dict[Assignment, Vector] = field(default_factory=dict)
    starts: dict[Assignment, Vector] = field(default_factory=dict)
    ends: list[tuple[Evaluator, Point | None]] = field(default_factory=list)
    visited: list[Box] = field(default_factory=list)
    precomputed: dict[Box, tuple[BoxTask, Nearest]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.index = np.concatenate([group.index for group in self.listed]).astype(np.intp)
        self.reference = Evaluator(self.problem)
        self.start = start = self.reference.point(self.reference.space.to_z(self.x))
        self.x = start.x
        unlisted = np.setdiff1d(np.arange(len(self.x)), self.index)
        self.only_listed = bool((self.problem.lower == self.problem.upper)[unlisted].all())
        self.lowest = np.inf
        if self.memory.hessian is None and start.valid and self.reference.space.size:
            self.reference.check_gradients(start)
            self.memory.hessian = hessian_at(self.reference, start)

    @property
    def exhausted(self) -> bool:
        """Whether the limit of time or of re-optimisations is reached."""
        late = self.deadline is not None and time.perf_counter() > self.deadline
        return late or self.solves >= self.max_solves

    @property
    def best(self) -> float:
        """The objective that a new design must beat to be of interest."""
        return min(self.cutoff, self.lowest)

    def note(self, assignment: Assignment, objective: float) -> None:
        """Store an assignment's objective, or replace the stored value by a more accurate value."""
        worse = self.tried.get(assignment, np.inf) <= self.lowest < objective
        self.tried[assignment] = objective
        self.lowest = min(self.tried.values()) if worse else min(self.lowest, objective)

    def beaten(self, bound: float) -> bool:
        """Whether a box with this bound cannot contain a design better than the best design."""
        best = self.best
        return best < np.inf and bound >= best - CLOSE * abs(best)

    def values(self, assignment: Assignment) -> Vector:
        """Values of the listed variables (d,) in an assignment."""
        pairs = zip(self.listed, assignment, strict=True)
        return np.concatenate([group.rows[row] for group, row in pairs])

    def try_neighbours(self) -> None:
        """Try all roundings of the listed variables, together if the problem allows that."""
        sides = [group.around(self.x[list(group.index)]) for group in self.listed]
        assignments = list(itertools.islice(itertools.product(*sides), MOST_NEIGHBOURS))
        for assignment, start in self.reoptimised_together(assignments):
            if start is None:
                self.note(assignment, np.inf)
            elif not self.exhausted:
                self.reoptimised(assignment, start)
        self.confirmed_best()

    def reoptimised_together(
        self, assignments: list[Assignment]
    ) -> list[tuple[Assignment, Vector | None]]:
        """Re-optimise assignments together; return the unsolved, each with a start (or None)."""
        present = self.x[self.index]
        point, evaluator = self._nearest_point(present, present, self.x)
        names = [self.problem.names[i] for i in self.index]

        def evaluate(points: Array, values: Array) -> PointValues:
            x = np.array(points)
            x[self.index] = values
            return self.problem.evaluate(x)

        parametric = ParametricProblem(evaluator.problem, names, present, evaluate)
        suits = point.valid and evaluator.space.size and applicable(parametric, evaluator)
        if not suits or not assignments:
            return [(assignment, self.x) for assignment in assignments]
        values = np.stack([self.values(assignment) for assignment in assignments], axis=1)
        starts = np.repeat(point.z[:, None], len(assignments), axis=1)
        changed = ChangedProblems(parametric, evaluator, values)
        optima = changed.near_optimum(valley_at(evaluator, point), starts)
        unsolved = [k for k, optimum in enumerate(optima) if optimum is None]
        restored = changed.subset(unsolved).restore(point.z)
        for assignment, optimum in zip(assignments, optima, strict=True):
            self.solves += 1
            if optimum is not None:
                self.note(assignment, optimum.objective)
                self.starts[assignment] = optimum.x
        return [
            (assignments[k], None if z is None else evaluator.space.to_x(z[:, None])[:, 0])
            for k, z in zip(unsolved, restored, strict=True)
        ]

    def reoptimised(self, assignment: Assignment, start: Vector) -> float:
        """The objective of an assignment after re-optimisation; infinite if it is infeasible."""
        if assignment not in self.points:
            values = self.values(assignment)
            box = tuple((row,) for row in assignment)
            (optimum,) = self._optima([(box, values, values)], start, EXACT)
            self.note(assignment, np.inf if optimum is None else optimum.objective)
            if optimum is not None:
                self.points[assignment] = optimum.x
        return self.tried[assignment]

    def confirmed_best(self) -> Assignment | None:
        """The best assignment, with its point verified; None if none is feasible."""
        while True:
            best = min(self.tried, key=lambda assignment: self.tried[assignment], default=None)
            if best is None or not self.tried[best] < self.cutoff:
                return None
            if best in self.points:
                return best
            self.reoptimised(best, self.starts.get(best, self.x))

    def precompute(self) -> None:
        """Re-optimise the last search's boxes together, as most are needed again."""
        tasks = [self._task(box, *self._bounds(box), self.x, ROUGH) for box in self.memory.visited]
        ends = resolve_boxes(tasks)
        self.precomputed = dict(
            zip(self.memory.visited, zip(tasks, ends, strict=True), strict=True)
        )

    def can_evaluate(self, box: Box) -> bool:
        """Whether all assignments of a box can be evaluated in one model call."""
        return self.only_listed and math.prod(map(len, box)) <= MOST_LISTED

    def evaluate(self, box: Box) -> None:
        """Evaluate every assignment of a box that has no continuous free variables."""
        assignments = list(itertools.product(*box))
        points = np.repeat(self.x[:, None], len(assignments), axis=1)
        for group, rows in zip(self.listed, np.array(assignments).T, strict=True):
            points[list(group.index)] = group.rows[rows].T
        values = Evaluator.screen(self.problem.rows(points))
        feasible = self.reference.violations(values, "worst") <= MET
        objectives = np.where(feasible, values[0], np.inf).tolist()
        for assignment, objective in zip(assignments, objectives, strict=True):
            self.tried.setdefault(assignment, objective)
        self.lowest = min(self.lowest, *objectives)
        self.solves += 1
        self.ends.append((self.reference, None))  # the box has no optimum for comparison

    def relax(self, parts: Sequence[Box], x: Vector, boxes: _Boxes) -> None:
        """Evaluate small boxes; keep large boxes whose continuous optimum beats the best design."""
        large = []
        for box in parts:
            if self.can_evaluate(box):
                self.evaluate(box)
            else:
                large.append(box)
        self.visited += large
        bounds = [(box, *self._bounds(box)) for box in large]
        for box, point in zip(large, self._optima(bounds, x, ROUGH), strict=True):
            if point is not None and not self.beaten(point.objective):
                boxes.add(point.objective, box, point.x)

    def _bounds(self, box: Box) -> tuple[Vector, Vector]:
        """Bounds of the listed variables in a box."""
        values = [group.rows[list(rows)] for group, rows in zip(self.listed, box, strict=True)]
        lower = np.concatenate([rows.min(axis=0) for rows in values])
        return lower, np.concatenate([rows.max(axis=0) for rows in values])

    def parts(self, box: Box, x: Vector, objective: float) -> list[Box]:
        """Split a box at its continuous optimum; return the parts that may have a better design."""
        widest: float = ON
        halves: tuple[int, list[list[int]]] | None = None
        for k, (group, rows) in enumerate(zip(self.listed, box, strict=True)):
            for column, index in enumerate(group.index):
                values = group.values(column, rows)
                below, above, share = between(values, float(x[index]))
                if share > widest:
                    column_values = group.rows[:, column]
                    widest = share
                    parts = [
                        [r for r in rows if column_values[r] <= below],
                        [r for r in rows if column_values[r] >= above],
                    ]
                    halves = k, parts if x[index] - below > above - x[index] else parts[::-1]
        if halves is not None:  # put the nearer part last
            return [with_rows(box, halves[0], tuple(half)) for half in halves[1]]
        rows_at = [
            group.at(x[list(group.index)], rows)
            for group, rows in zip(self.listed, box, strict=True)
        ]
        if None in rows_at:  # each variable has a listed value, but not in an allowed combination
            k = rows_at.index(None)
            group, rows = self.listed[k], box[k]
            nearest = min(
                rows, key=lambda r: float(np.abs(group.rows[r] - x[list(group.index)]).sum())
            )
            return [with_rows(box, k, part) for part in [*group.parts(rows, nearest), (nearest,)]]
        assignment = tuple(row for row in rows_at if row is not None)
        room = CLOSE * abs(objective)
        if self.reoptimised(assignment, x) <= objective + room:
            return []  # nothing else in the box can be better
        rest = []
        for k, row in enumerate(assignment):
            rest += [with_rows(box, k, part) for part in self.listed[k].parts(box[k], row)]
            box = with_rows(box, k, (row,))
        return rest

    def result(self, *, complete: bool) -> SizeSearch:
        """The result of the search."""
        self.memory.visited = tuple(self.visited)
        best = self.confirmed_best()
        x, objective, nearest, missed = None, None, None, None
        if best is not None:
            x, objective = self.points[best], self.tried[best]
        elif not self.cutoff < np.inf:
            nearest, missed = self.nearest()
        ends = tuple((evaluator, end) for evaluator, end in self.ends if end is not None)
        ends = ends if len(ends) == len(self.ends) else ()
        tried, solves = self.tried, self.solves
        return SizeSearch(x, objective, best, tried, solves, complete, nearest, missed, ends)

    def nearest(self) -> tuple[Assignment, Point] | tuple[None, None]:
        """The least infeasible of the first assignments tried, and its point; or (None, None)."""
        candidates = []
        for assignment in list(self.tried)[:MOST_MISSED]:
            box = tuple((row,) for row in assignment)
            values = self.values(assignment)
            point, _ = self._nearest_point(values, values, self.memory.missed.get(box, self.x))
            if box not in self.memory.missed and point.valid and not self.exhausted:
                self.reoptimised(assignment, self.x)
                start = self.memory.missed.get(box, self.x)
                point, _ = self._nearest_point(values, values, start)
            if point.valid:
                candidates.append((point.violation, assignment, point))
        if not candidates:
            return None, None
        _, assignment, point = min(candidates, key=lambda candidate: candidate[0])
        return assignment, point

    def _restricted(self, lower: Vector, upper: Vector) -> Evaluator:
        """Evaluator of the problem, with these bounds on the listed variables."""
        lowest, highest = self.problem.lower.copy(), self.problem.upper.copy()
        lowest[self.index], highest[self.index] = lower, upper
        evaluator = Evaluator(replace(self.problem, lower=lowest, upper=highest, start=None))
        evaluator.adopt_check(self.reference)
        evaluator.eager = True
        return evaluator

    def _nearest_point(
        self, lower: Vector, upper: Vector, start: Vector
    ) -> tuple[Point, Evaluator]:
        """The point within the bounds of the listed variables that is nearest to `start`."""
        evaluator = self._restricted(lower, upper)
        return evaluator.point(evaluator.space.to_z(evaluator.problem.inside(start))), evaluator

    def _task(
        self, box: Box, lower: Vector, upper: Vector, start: Vector, criteria: Criteria
    ) -> BoxTask:
        """The task to re-optimise a box, from a nearby point or the result of a similar problem."""
        warm_start = self.memory.warm_start(box)
        hopeless = warm_start is None and box in self.memory.missed
        x, hessian = warm_start or (self.memory.missed.get(box, start), self.memory.hessian)
        evaluator = self._restricted(lower, upper)
        cutoff = self.best if criteria is ROUGH else np.inf
        x = evaluator.problem.inside(x)
        return BoxTask(evaluator, x, hessian, criteria, hopeless, cutoff)

    def _optima(
        self, bounds: Sequence[tuple[Box, Vector, Vector]], start: Vector, criteria: Criteria
    ) -> list[Point | None]:
        """The optimum of each box, reached from a nearby or stored point, or None."""
        precomputed = self.precomputed if criteria is ROUGH else {}
        tasks = {
            box: self._task(box, lower, upper, start, criteria)
            for box, lower, upper in bounds
            if box not in precomputed
        }
        ends = resolve_boxes(list(tasks.values()))
        resolved = precomputed | dict(
            zip(tasks, zip(tasks.values(), ends, strict=True), strict=True)
        )
        self.solves += len(bounds)
        optima = []
        for box, _, _ in bounds:
            task, end = resolved[box]
            self.memory.note(box, task.evaluator, end)
            self.ends.append((task.evaluator, end.optimum or end.missed))
            optima.append(end.optimum)
        return optima
