"""The best point of a problem some of whose variables may only take listed values.

Branch and bound from the continuous optimum, the most promising box first: the bound of a box is
its continuous optimum, re-optimised from that of the box around it. That optimum is a local one,
so what is found is the best found and no proof. All roundings up and down come before, at once.
"""

from __future__ import annotations

import heapq
import itertools
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np

from ..numeric import Array
from . import elastic, kkt, lockstep, nlopt_wrapper
from .descents import FEASIBLE, RESIDUAL
from .evaluator import Evaluator, Point
from .newton import polish
from .problem import ParametricProblem, Problem, Values, Vector

MOST_SOLVES = 400
"""Most re-optimisations of one search."""

MOST_NEIGHBOURS = 256
"""Most roundings up and down tried at once: all of them up to eight listed variables."""

MOST_STEPS = 100
"""Most evaluations of SLSQP where Newton does not end on an optimum."""

ON = 1e-7
"""Distance from a listed value, over that to the next one, that counts as none."""

SAME = 1e-9
"""Relative difference of objectives that counts as none."""

Box: TypeAlias = tuple[tuple[int, int], ...]
"""First and last choice of every listed variable."""

Assignment: TypeAlias = tuple[int, ...]
"""A choice of every listed variable."""


@dataclass(frozen=True, eq=False)
class Listed:
    """A variable that may only take listed values.

    Parameters
    ----------
    index : of the variable
    choices : ascending values (c,) within its bounds
    restricted : choices (c,) that need `partner` at one of its `freeing` choices; None for none
    partner : which of the listed variables that is
    freeing : choices of the partner
    """

    index: int
    choices: Vector
    restricted: Sequence[bool] | None = None
    partner: int | None = None
    freeing: frozenset[int] = frozenset()


@dataclass
class Found:
    """The best point, every assignment tried with its objective, and how far the search went.

    Parameters
    ----------
    x, objective, assignment : of the best; None where nothing feasible was found
    tried : objective of each assignment, infinite where none was feasible
    solves : re-optimisations, of boxes and of assignments
    complete : whether the search ended by itself, not at a limit
    """

    x: Vector | None
    objective: float | None
    assignment: Assignment | None
    tried: dict[Assignment, float]
    solves: int
    complete: bool


def search(
    problem: Problem,
    listed: Sequence[Listed],
    x: Vector,
    *,
    most: int = MOST_SOLVES,
    until: float | None = None,
) -> Found:
    """The best point with every listed variable at one of its choices.

    Parameters
    ----------
    problem : the continuous problem
    listed : its listed variables
    x : the continuous optimum (n,)
    most : limit of re-optimisations
    until : time of `time.perf_counter` to stop at
    """
    run = _Run(problem, listed, x, most, until)
    run.neighbours()
    count = itertools.count()
    whole = tuple((0, len(one.choices) - 1) for one in listed)
    boxes: list[tuple[float, int, Box, Vector]] = [(-np.inf, next(count), whole, run.x)]
    while boxes and not run.exhausted and not run.beaten(boxes[0][0]):
        _, _, box, near = heapq.heappop(boxes)
        objective, near = run.relaxed(box, near)
        if objective is None or run.beaten(objective):
            continue
        for part in run.parts(box, near, objective):
            heapq.heappush(boxes, (objective, next(count), part, near))
    return run.found(complete=not boxes or run.beaten(boxes[0][0]))


@dataclass
class _Run:
    """The state of one search."""

    problem: Problem
    listed: Sequence[Listed]
    x: Vector
    most: int
    until: float | None
    solves: int = 0
    tried: dict[Assignment, float] = field(default_factory=dict)
    points: dict[Assignment, Vector] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.index = np.array([one.index for one in self.listed], dtype=np.intp)
        self.reference = Evaluator(self.problem)
        start = self.reference.point(self.reference.space.to_z(self.x))
        self.x = start.x
        if start.valid and self.reference.space.size:
            self.reference.check_gradients(start)

    @property
    def exhausted(self) -> bool:
        """Whether a limit is reached."""
        late = self.until is not None and time.perf_counter() > self.until
        return late or self.solves >= self.most

    def beaten(self, bound: float) -> bool:
        """Whether nothing above a bound can improve on what is known."""
        best = min(self.tried.values(), default=np.inf)
        return best < np.inf and bound >= best - SAME * abs(best)

    def allowed(self, box: Box) -> list[list[int]]:
        """The choices of every listed variable that a box holds."""
        result = []
        for one, (first, last) in zip(self.listed, box, strict=True):
            choices = list(range(first, last + 1))
            if one.partner is not None and one.restricted is not None:
                low, high = box[one.partner]
                if not any(low <= choice <= high for choice in one.freeing):
                    choices = [choice for choice in choices if not one.restricted[choice]]
            result.append(choices)
        return result

    def consistent(self, assignment: Assignment) -> bool:
        """Whether every restricted choice has the partner it needs."""
        return all(self.allowed(tuple((choice, choice) for choice in assignment)))

    def values(self, assignment: Assignment) -> Vector:
        """Values of the listed variables (d,)."""
        pairs = zip(self.listed, assignment, strict=True)
        return np.array([one.choices[choice] for one, choice in pairs], dtype=float)

    def neighbours(self) -> None:
        """Try every rounding up and down, all at once where the problem allows."""
        sides = []
        for one in self.listed:
            value = float(self.x[one.index])
            side = _around(one, value, range(len(one.choices)))
            if one.restricted is not None:
                free = [k for k, bound in enumerate(one.restricted) if not bound]
                side = list(dict.fromkeys([*side, *_around(one, value, free)]))
            sides.append(side)
        every = itertools.product(*sides)
        chosen = list(itertools.islice(filter(self.consistent, every), MOST_NEIGHBOURS))
        for assignment, near in self.together(chosen):
            if near is None:
                self.tried[assignment] = np.inf
            elif not self.exhausted:
                self.assigned(assignment, near)
        self.confirmed()

    def together(self, chosen: list[Assignment]) -> list[tuple[Assignment, Vector | None]]:
        """Re-optimise assignments at once; what is left, with a start each (None: none nearby)."""
        point, evaluator = self._fixed(self.x[self.index], self.x)
        names = [self.problem.names[i] for i in self.index]

        def evaluate(points: Array, values: Array) -> Values:
            full = np.array(points)
            full[self.index] = values
            return self.problem.evaluate(full)

        parametric = ParametricProblem(evaluator.problem, names, self.x[self.index], evaluate)
        suits = point.valid and evaluator.space.size and lockstep.applicable(parametric, evaluator)
        if not suits or not chosen:
            return [(assignment, self.x) for assignment in chosen]
        values = np.stack([self.values(assignment) for assignment in chosen], axis=1)
        starts = np.repeat(point.z[:, None], len(chosen), axis=1)
        known = lockstep.resolve_together(parametric, evaluator, point, starts, values)
        left = [k for k, optimum in enumerate(known) if optimum is None]
        near = lockstep.restore_together(parametric, evaluator, point.z, values[:, left])
        for assignment, optimum in zip(chosen, known, strict=True):
            self.solves += 1
            if optimum is not None:
                self.tried[assignment] = optimum.objective
        return [
            (chosen[k], None if z is None else evaluator.space.to_x(z[:, None])[:, 0])
            for k, z in zip(left, near, strict=True)
        ]

    def assigned(self, assignment: Assignment, near: Vector) -> float:
        """Re-optimise the other variables of an assignment; infinite where that is infeasible."""
        if assignment not in self.points:
            point, evaluator = self._fixed(self.values(assignment), near)
            found = self._descended(evaluator, point)
            self.tried[assignment] = np.inf if found is None else found.objective
            if found is not None:
                self.points[assignment] = found.x
        return self.tried[assignment]

    def confirmed(self) -> Assignment | None:
        """The best assignment, once its point is known too; None where none is feasible."""
        while True:
            best = min(self.tried, key=lambda one: self.tried[one], default=None)
            if best is None or self.tried[best] == np.inf:
                return None
            if best in self.points:
                return best
            self.assigned(best, self.x)

    def relaxed(self, box: Box, near: Vector) -> tuple[float | None, Vector]:
        """Objective and point of the continuous optimum in a box; None where it is infeasible."""
        lower, upper = self.problem.lower.copy(), self.problem.upper.copy()
        for one, choices in zip(self.listed, self.allowed(box), strict=True):
            lower[one.index] = one.choices[choices[0]]
            upper[one.index] = one.choices[choices[-1]]
        point, evaluator = self._near(lower, upper, near)
        found = self._descended(evaluator, point)
        return (None, near) if found is None else (found.objective, found.x)

    def parts(self, box: Box, x: Vector, objective: float) -> list[Box]:
        """What is left to search of a box, given its continuous optimum."""
        allowed = self.allowed(box)
        widest, cut = ON, None
        for k, (one, choices) in enumerate(zip(self.listed, allowed, strict=True)):
            below, above, share = _between(one, float(x[one.index]), choices)
            if share > widest:
                widest, cut = share, (k, below, above)
        if cut is not None:
            k, below, above = cut
            return self._cut(box, k, (box[k][0], below), (above, box[k][1]))
        assignment = tuple(
            _around(one, float(x[one.index]), choices)[0]
            for one, choices in zip(self.listed, allowed, strict=True)
        )
        if np.array_equal(self.values(assignment), x[self.index]) and self.consistent(assignment):
            self.tried[assignment], self.points[assignment] = objective, x
        room = SAME * abs(objective)
        if self.consistent(assignment) and self.assigned(assignment, x) <= objective + room:
            return []  # nothing else in the box can be better
        parts = []
        for k, choice in enumerate(assignment):
            parts += self._cut(box, k, (box[k][0], choice - 1), (choice + 1, box[k][1]))
            box = (*box[:k], (choice, choice), *box[k + 1 :])
        return parts

    def _cut(self, box: Box, k: int, *ranges: tuple[int, int]) -> list[Box]:
        parts = [(*box[:k], one, *box[k + 1 :]) for one in ranges if one[0] <= one[1]]
        return [part for part in parts if all(self.allowed(part))]

    def found(self, *, complete: bool) -> Found:
        """What the search comes to."""
        best = self.confirmed()
        if best is None:
            return Found(None, None, None, self.tried, self.solves, complete)
        return Found(self.points[best], self.tried[best], best, self.tried, self.solves, complete)

    def _fixed(self, values: Vector, near: Vector) -> tuple[Point, Evaluator]:
        lower, upper = self.problem.lower.copy(), self.problem.upper.copy()
        lower[self.index] = upper[self.index] = values
        return self._near(lower, upper, near)

    def _near(self, lower: Vector, upper: Vector, near: Vector) -> tuple[Point, Evaluator]:
        """The problem in a box, and the point of it nearest to another point."""
        evaluator = Evaluator(replace(self.problem, lower=lower, upper=upper, start=None))
        evaluator.complex_works = self.reference.complex_works
        evaluator.difference_rows = self.reference.difference_rows
        point = evaluator.point(evaluator.space.to_z(np.clip(near, lower, upper)))
        return point, evaluator

    def _descended(self, evaluator: Evaluator, start: Point) -> Point | None:
        """The optimum near a point: Newton from an infeasible one, else SLSQP; None without."""
        self.solves += 1
        if evaluator.space.size == 0:
            return start if _met(start) else None
        found = start if _met(start) else polish(evaluator, start, iterations=8, tolerance=1e-10)
        if _met(found) and kkt.check(evaluator, found).residual <= RESIDUAL:
            return found
        inside = next(
            (
                inside
                for point in (found, start)
                if point.valid and (inside := elastic.feasible_point(evaluator, point)) is not None
            ),
            None,
        )
        if inside is None:
            return None
        found = nlopt_wrapper.run(evaluator, inside, "LD_SLSQP", most=MOST_STEPS).point
        found = polish(evaluator, found, iterations=8, tolerance=1e-10)
        return found if _met(found) else inside


def _met(point: Point) -> bool:
    return point.valid and point.violation <= FEASIBLE


def _between(one: Listed, value: float, choices: Sequence[int]) -> tuple[int, int, float]:
    """The choices below and above a value, and how far it is from both (0 to 0.5)."""
    values = one.choices[list(choices)]
    k = int(np.clip(np.searchsorted(values, value), 1, max(len(values) - 1, 1)))
    if len(values) == 1:
        return choices[0], choices[0], 0.0
    low, high = float(values[k - 1]), float(values[k])
    share = min(value - low, high - value) / (high - low)
    return choices[k - 1], choices[k], max(share, 0.0)


def _around(one: Listed, value: float, choices: Sequence[int]) -> list[int]:
    """The choices next to a value, the nearest first; one alone where the value is it."""
    if not choices:
        return []
    below, above, share = _between(one, value, choices)
    pair = sorted({below, above}, key=lambda k: abs(float(one.choices[k]) - value))
    return pair[:1] if share <= ON else pair
