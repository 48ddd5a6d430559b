"""An optimum prepared for nearby problems: re-solve, predict, price, trace.

Full steps, then restoration and descent, start from the optimum and the other local optima of its
search (`resolve.ladder`), with their Hessians computed once. If they fail, a search from `STARTS`
starts follows; if that finds nothing, the first search is repeated. So every problem that the first
search would solve is solved.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from . import kkt, prices
from .actuator import ActuatorProblem, Outcome, Responses, Solution, responses
from .evaluator import Evaluator, LimitReached, Point
from .problem import BoxProblem, ParametricProblem, Vector
from .resolve import ladder
from .resolve.changed import ChangedProblems, applicable
from .resolve.steps import Valley, valley_at
from .solver import solve

Stop = Callable[[], bool]
"""Called between steps; True stops."""

STARTS = 3
"""Starts of the search if the steps fail."""

SAMPLES = 1024
"""Points of its sweep."""

AGREES = 1e-9
"""Margin difference up to which parameters fully describe a changed problem: rounding."""


@dataclass(frozen=True, slots=True)
class SearchEffort:
    """The search that led to the optimum: its starts, points of the sweep, and seed."""

    starts: int
    samples: int
    seed: int


@dataclass(frozen=True)
class LinearPath:
    """The optimum as a straight line in one parameter (model units).

    Parameters
    ----------
    below, above : slope of the objective downwards and upwards; infinite without a design
    moves : change of each variable (n,) per unit
    low, high : the nearest change of the active set, as distance and words; None if none is near
    """

    below: float
    above: float
    moves: Vector
    low: tuple[float, str] | None
    high: tuple[float, str] | None


class WarmStart:
    """An optimum with the data for re-solving.

    Parameters
    ----------
    actuator : the problem
    solution : its optimum
    effort : how it was searched for
    """

    def __init__(self, actuator: ActuatorProblem, solution: Solution, effort: SearchEffort) -> None:
        self.actuator, self.solution, self.effort = actuator, solution, effort
        self.evaluator = evaluator = Evaluator(actuator.problem)
        self.point = point = evaluator.point(evaluator.space.to_z(solution.x))
        evaluator.check_gradients(point)
        known = [point, *ladder.other_optima(evaluator, solution)]
        self.valleys = [valley_at(evaluator, one) for one in known]
        self._optimum: prices.Optimum | None = None
        self._responses: dict[str, Responses] = {}

    def solve(self, problem: BoxProblem, stop: Stop | None = None) -> Solution:
        """The optimum of a changed problem with the same variables.

        Parameters
        ----------
        problem : the changed problem; its bounds may differ too
        stop : called between steps; once True, the unchanged optimum is returned with the outcome
            "interrupted"
        """
        near = Evaluator(problem, stop=stop)
        if near.space.size == 0:
            return solve(problem)
        try:
            self._take_gradients(near)
            optimum, inside = self._stepped(near, self._valleys(near))
        except LimitReached:
            return self._interrupted(near)
        if optimum is not None:
            return _solution(near, optimum, "full steps, or restoration and descent")
        known = problem.inside(self.point.x)
        more = [known if inside is None else near.space.to_x(inside[:, None])[:, 0]]
        seed = self.effort.seed
        found = solve(
            problem, starts=STARTS, samples=SAMPLES, more_starts=more, seed=seed, stop=stop
        )
        if not found.feasible and found.outcome is not Outcome.LIMIT_INFEASIBLE:
            found = solve(
                problem,
                starts=self.effort.starts,
                samples=self.effort.samples,
                more_starts=[found.x],
                seed=seed,
                stop=stop,
            )
        if found.outcome is Outcome.LIMIT_INFEASIBLE:
            return self._interrupted(near)
        return _stopped(found) if found.outcome is Outcome.LIMIT else found

    def solve_together(
        self, path: str, values: Sequence[float], rebuilt: Callable[[float], ActuatorProblem],
        stop: Stop | None = None,
    ) -> list[Point | None]:  # fmt: skip
        """The optimum at each value of a number, solved together.

        Values that shared steps do not reach are searched in order, outwards. The search stops at
        the first value without a design.

        Parameters
        ----------
        path, values : the number
        rebuilt : the problem with the number at a value
        stop : called between steps; values not reached by then are None
        """
        present = self.actuator.subject.numbers.get(path)
        optima: list[Point | None] = [None] * len(values)
        left = list(range(len(values)))
        if present is not None and self._follows(path, present, values, rebuilt):
            try:
                optima = self._curve(path, values, stop)
            except LimitReached:
                return optima
            left = [k for k, one in enumerate(optima) if one is None]
        here = present if present is not None else float(np.median(values))
        for side in (-1, 1):
            outwards = sorted(
                (k for k in left if (values[k] - here >= 0) == (side > 0)),
                key=lambda k: abs(values[k] - here),
            )
            for k in outwards:
                if stop is not None and stop():
                    return optima
                found = self.solve(rebuilt(values[k]).problem, stop)
                if found.interrupted:
                    return optima
                if not found.feasible:
                    break
                optima[k] = ladder.point_of(self.evaluator, found)
        return optima

    def line(self, changes: Mapping[str, float], size: float = 1.0) -> LinearPath:
        """The optimum as a straight line along joint changes of numbers, per unit.

        Parameters
        ----------
        changes : difference of each number by PATH
        size : units that make a change of the numbers' own size
        """
        optimum = self.optimum
        given = self._along(changes, size)
        moves, shifts = prices.movement(optimum, given)
        active = np.flatnonzero(optimum.margins <= kkt.ACTIVE)
        below, above = prices.one_sided(optimum, given, active)[:, 0]
        moved = np.zeros(len(self.point.x))
        slope = self.evaluator.space.slope(self.point.x[:, None])[:, 0]
        moved[self.evaluator.space.free] = slope * moves[:, 0]
        low, high = prices.ends(optimum, given, moves, shifts)[0]
        return LinearPath(
            float(below), float(above), moved,
            None if low is None else (float(low.distance), low.text),
            None if high is None else (float(high.distance), high.text),
        )  # fmt: skip

    @property
    def optimum(self) -> prices.Optimum:
        """The linear algebra of the optimum, computed once."""
        if self._optimum is None:
            quality = kkt.check(self.evaluator, self.point)
            self._optimum = prices.optimum(self.evaluator, self.point, quality)
        return self._optimum

    def _along(self, changes: Mapping[str, float], size: float) -> Responses:
        """The responses to one parameter that changes several numbers."""
        self.differentiate(changes)
        parts = [(self._responses[path], change) for path, change in changes.items()]
        first = parts[0][0]
        return Responses(
            ("change",),
            np.array([size]),
            np.asarray(sum(part.rows * change for part, change in parts)),
            np.asarray(sum(part.mixed * change for part, change in parts)),
            np.asarray(sum(part.bounds * change for part, change in parts)),
            first.differences,
        )

    def differentiate(self, paths: Iterable[str]) -> None:
        """Compute the derivatives by some numbers, unless known; many cost little more than one.

        Parameters
        ----------
        paths : of the numbers
        """
        missing = tuple(path for path in dict.fromkeys(paths) if path not in self._responses)
        if missing:
            parametric = self.actuator.parametric(missing)
            new = responses(parametric, self.evaluator, self.point, self.optimum.weights)
            for k, path in enumerate(missing):
                column = slice(k, k + 1)
                self._responses[path] = replace(
                    new, names=(path,), values=new.values[column], rows=new.rows[:, column],
                    mixed=new.mixed[:, column], bounds=new.bounds[:, column],
                )  # fmt: skip

    def _take_gradients(self, near: Evaluator) -> None:
        """Reuse the gradient check for a changed problem, or run its own."""
        own, problem = self.evaluator, near.problem
        if tuple(problem.constraint_names) == tuple(own.problem.constraint_names):
            near.complex_works, near.difference_rows = own.complex_works, own.difference_rows
        else:
            near.check_gradients(near.point(near.space.to_z(problem.inside(self.point.x))))

    def _valleys(self, near: Evaluator) -> list[Valley]:
        """The valleys as starts of descents of a changed problem."""
        own, space = self.evaluator.space, near.space
        same = np.array_equal(own.free, space.free) and all(
            np.array_equal(getattr(own, name), getattr(space, name))
            for name in ("logarithmic", "scale")
        )
        box = same and all(
            np.array_equal(getattr(own, name), getattr(space, name)) for name in ("lower", "upper")
        )
        if box:
            return [replace(valley, rows=near.constraint_count) for valley in self.valleys]
        result = []
        for valley in self.valleys:
            point = near.point(space.to_z(near.problem.inside(valley.point.x)))
            if same:
                result.append(replace(valley, rows=near.constraint_count, point=point))
            elif point.valid:
                result.append(valley_at(near, point))
        return result

    def _stepped(
        self, near: Evaluator, valleys: Sequence[Valley]
    ) -> tuple[Point | None, Vector | None]:
        """The optimum that steps from the valleys reach, or a feasible point (nf,)."""
        problem = near.problem
        alone = ParametricProblem(problem, (), np.zeros(0), lambda x, _: problem.evaluate(x))
        if not valleys or not applicable(alone, near):
            return None, None
        changed = ChangedProblems(alone, near, np.zeros((0, 1)))
        optima, inside = ladder.resolve_batch(changed, valleys, valleys[0].point.z[:, None])
        return optima[0], inside[0]

    def _interrupted(self, near: Evaluator) -> Solution:
        """The unchanged optimum as the result of a stopped search."""
        near.limited = False
        point = near.point(near.space.to_z(near.problem.inside(self.point.x)))
        return _stopped(_solution(near, point, "interrupted"))

    def _follows(
        self,
        path: str,
        present: float,
        values: Sequence[float],
        rebuilt: Callable[[float], ActuatorProblem],
    ) -> bool:
        """Whether the number alone makes the changed problems, judged at both ends.

        Some numbers affect more than the models read directly, as temperatures affect the factors
        on materials.
        """
        parametric = self.actuator.parametric((path,))
        if not applicable(parametric, self.evaluator):
            return False
        own = self.actuator.problem
        for value in {min(values), max(values)} - {present}:
            other = rebuilt(value).problem
            same = tuple(other.constraint_names) == tuple(own.constraint_names)
            boxed = np.array_equal(own.lower, other.lower) and np.array_equal(
                own.upper, other.upper
            )
            if not (same and boxed):
                return False
            x = self.point.x[:, None]
            ours, theirs = parametric.at(np.array([value])).rows(x), other.rows(x)
            if not np.allclose(ours, theirs, rtol=AGREES, atol=AGREES, equal_nan=True):
                return False
        return True

    def _curve(self, path: str, values: Sequence[float], stop: Stop | None) -> list[Point | None]:
        """The optima at values of a number that shared steps reach."""
        near = Evaluator(self.actuator.problem, stop=stop)
        self._take_gradients(near)
        changed = ChangedProblems(self.actuator.parametric((path,)), near, np.array([values]))
        starts = np.repeat(self.point.z[:, None], len(values), axis=1)
        return ladder.resolve_batch(changed, self.valleys, starts)[0]


def _solution(evaluator: Evaluator, point: Point, algorithm: str) -> Solution:
    """A point as a search result; an optimum if it is feasible and stationary."""
    found = kkt.check(evaluator, point) if point.valid else None
    if point.violation > ladder.FEASIBLE or found is None:
        outcome = Outcome.INFEASIBLE
    else:
        stationary = found.residual <= ladder.RESIDUAL
        outcome = Outcome.OPTIMUM if stationary else Outcome.NOT_STATIONARY
    m = evaluator.constraint_count
    return Solution(
        problem=evaluator.problem,
        outcome=outcome,
        x=point.x,
        objective=point.objective,
        constraints=point.rows[1 : 1 + m],
        equalities=point.rows[1 + m :],
        violation=point.violation,
        kkt=found,
        evaluations=evaluator.evaluations,
        gradients=evaluator.gradients,
        algorithm=algorithm,
        seconds=time.perf_counter() - evaluator.began,
    )


def _stopped(solution: Solution) -> Solution:
    feasible = solution.violation <= ladder.FEASIBLE
    outcome = Outcome.INTERRUPTED if feasible else Outcome.INTERRUPTED_INFEASIBLE
    return replace(solution, outcome=outcome)
