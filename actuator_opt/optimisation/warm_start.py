"""Re-solves problems near an optimum, and predicts how the optimum moves.

A new search starts at the local optima of the original search, whose Hessians are computed once. It
takes full SQP steps first, then tries restoration and descent (`resolve.ladder`). If these fail, a
short search from `STARTS` starting points follows; if that finds no design, the original search is
repeated. So every problem that the original search can solve is solved.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..base.dataclass import dataclass
from . import kinks, prices
from .actuator import ActuatorProblem, Responses, responses
from .evaluator import Evaluator, LimitReached, Point
from .problem import BoxProblem, ParametricProblem, Vector
from .resolve import ladder
from .resolve.changed import ChangedProblems, applicable
from .resolve.steps import RESIDUAL, Valley, valley_at
from .solution import MET, Outcome, Solution
from .solver import solve

Stop = Callable[[], bool]
"""Function that is called between steps; if it returns True, the search stops."""

STARTS = 3
"""Number of starts in the search that follows if the steps fail."""

SAMPLES = 1024
"""Number of designs sampled in the search that follows if the steps fail; it starts at the best."""

AGREES = 1e-9
"""Largest difference of margins that counts as a rounding error. It serves to check that changing a
parameter of the model gives the same margins as building the problem again with the new value."""


@dataclass(frozen=True, slots=True)
class SearchEffort:
    """Settings of a search: number of starts, number of designs sampled for them, random seed."""

    starts: int
    samples: int
    seed: int


@dataclass(frozen=True)
class LinearPath:
    """The optimum as a linear function of one parameter (in the units of the model).

    Parameters
    ----------
    below, above : slope of the objective if the parameter decreases and if it increases; infinite
        if no feasible design remains
    moves : change of each variable (n,) per unit of the parameter
    low, high : if the parameter decreases (low) or increases (high): its change at which the set of
        active limits first changes, and a description of that event; None if the set stays the same
    """

    below: float
    above: float
    moves: Vector
    low: tuple[float, str] | None
    high: tuple[float, str] | None


class WarmStart:
    """An optimum, with the data needed to re-solve nearby problems.

    Parameters
    ----------
    actuator : the problem
    solution : its optimum
    effort : effort of the search that found the optimum
    """

    def __init__(self, actuator: ActuatorProblem, solution: Solution, effort: SearchEffort) -> None:
        self.actuator, self.solution, self.effort = actuator, solution, effort
        self.evaluator = evaluator = Evaluator(actuator.problem)
        self.point = point = evaluator.point(evaluator.space.to_z(solution.x))
        evaluator.check_gradients(point)
        optima = [point, *ladder.other_optima(evaluator, solution)]
        self.valleys = [valley_at(evaluator, optimum) for optimum in optima]
        self._optima: list[prices.Optimum] = []
        self._responses: list[dict[str, Responses]] = []

    def solve(self, problem: BoxProblem, stop: Stop | None = None) -> Solution:
        """Find the optimum of a changed problem with the same variables: steps, then a search.

        Parameters
        ----------
        problem : the changed problem; its bounds may differ too
        stop : called between steps; once True, the unchanged optimum is returned with the outcome
            "interrupted"
        """
        near, feasible = self._near(problem, stop)
        return self._searched(problem, feasible, stop) if near is None else near

    def solve_near(
        self, problem: BoxProblem, stop: Stop | None = None, starts: Sequence[Vector] = ()
    ) -> Solution | None:
        """As `solve`, but without a search: None if no descent reaches a feasible design.

        If the steps reach none, descents follow from the feasible point that they found, if any,
        and from the points `starts` (n,).
        """
        near, feasible = self._near(problem, stop)
        points = [*starts] if feasible is None else [feasible, *starts]
        if near is not None or not points:
            return near
        descent = replace(problem, start=None)
        found = solve(descent, starts=len(points), samples=0, more_starts=points, stop=stop)
        if found.outcome in (Outcome.LIMIT, Outcome.LIMIT_INFEASIBLE):
            return _stopped(found)
        return found if found.feasible else None

    def _near(
        self, problem: BoxProblem, stop: Stop | None
    ) -> tuple[Solution | None, Vector | None]:
        """The optimum by steps from the known optima, or None and perhaps a feasible point."""
        evaluator = Evaluator(problem, stop=stop)
        if evaluator.space.size == 0:
            return solve(problem), None
        try:
            self._take_gradients(evaluator)
            optimum, feasible = self._stepped(evaluator, self._valleys(evaluator))
            if optimum is None and feasible is not None:
                optimum = ladder.optimum_near(evaluator, evaluator.point(feasible))
        except LimitReached:
            return self._interrupted(evaluator), None
        if optimum is not None:
            how = "SQP steps, or a descent from a feasible point"
            return _solution(evaluator, optimum, how), None
        return None, None if feasible is None else evaluator.space.to_x(feasible[:, None])[:, 0]

    def _searched(
        self, problem: BoxProblem, feasible: Vector | None, stop: Stop | None
    ) -> Solution:
        """The optimum by a search that starts at the known optimum, or at a feasible point."""
        starts = [problem.inside(self.point.x) if feasible is None else feasible]
        seed = self.effort.seed
        solution = solve(
            problem, starts=STARTS, samples=SAMPLES, more_starts=starts, seed=seed, stop=stop
        )
        if not solution.feasible and solution.outcome is not Outcome.LIMIT_INFEASIBLE:
            solution = solve(
                problem,
                starts=self.effort.starts,
                samples=self.effort.samples,
                more_starts=[solution.x],
                seed=seed,
                stop=stop,
            )
        if solution.outcome is Outcome.LIMIT_INFEASIBLE:
            evaluator = Evaluator(problem)
            self._take_gradients(evaluator)
            return self._interrupted(evaluator)
        return _stopped(solution) if solution.outcome is Outcome.LIMIT else solution

    def solve_together(
        self, path: str, values: Sequence[float], rebuilt: Callable[[float], ActuatorProblem],
        stop: Stop | None = None, *, search: bool = True,
    ) -> list[Point | None]:  # fmt: skip
        """Find the optimum for each value of one number, in parallel.

        For values that the parallel steps do not solve, single searches follow, beginning with the
        values nearest to the present value. Above and below the present value, they stop at the
        first value for which no design exists.

        Parameters
        ----------
        path, values : PATH of the number, and its values
        rebuilt : function that builds the problem for a value of the number
        stop : called between steps; True ends the search, and the remaining values have no optimum
        search : whether a search follows for values that no steps reach
        """
        present = self.actuator.subject.numbers.get(path)
        optima: list[Point | None] = [None] * len(values)
        feasible: list[Vector | None] = [None] * len(values)
        missing = list(range(len(values)))
        if present is not None and self._follows(path, present, values, rebuilt):
            try:
                optima, feasible = self._curve(path, values, stop)
            except LimitReached:
                return optima
            missing = [k for k, optimum in enumerate(optima) if optimum is None]
        middle = present if present is not None else float(np.median(values))
        for side in (-1, 1):
            outwards = sorted(
                (k for k in missing if (values[k] - middle >= 0) == (side > 0)),
                key=lambda k: abs(values[k] - middle),
            )
            for k in outwards:
                if stop is not None and stop():
                    return optima
                problem = rebuilt(values[k]).problem
                starts = self._starts(values, optima, feasible, k)
                solution = self.solve_near(problem, stop, starts)
                if solution is None and search:
                    solution = self.solve(problem, stop)
                if solution is not None and solution.interrupted:
                    return optima
                if solution is None or not solution.feasible:
                    break
                optima[k] = ladder.point_of(self.evaluator, solution)
        return optima

    def line(self, changes: Mapping[str, float], size: float = 1.0) -> LinearPath:
        """The optimum as a linear function of one parameter that changes several numbers at once.

        Parameters
        ----------
        changes : change of each number, by PATH, per unit of the parameter
        size : value of the parameter that counts as a change of 100 %
        """
        pieces = self._along(changes, size)
        below, above = prices.slopes(pieces)[:, 0]
        x_moves = np.zeros(len(self.point.x))
        slope = self.evaluator.space.slope(self.point.x[:, None])[:, 0]
        x_moves[self.evaluator.space.free] = slope * pieces[0].moves[:, 0]
        low, high = prices.ends(pieces)[0]
        return LinearPath(
            float(below), float(above), x_moves,
            None if low is None else (float(low.distance), low.text),
            None if high is None else (float(high.distance), high.text),
        )  # fmt: skip

    @property
    def optima(self) -> list[prices.Optimum]:
        """The optimum on each piece beside its kinks, as needed for prices; computed once."""
        if not self._optima:
            self._optima = [
                prices.optimum_at(piece.evaluator, piece.point, piece.quality)
                for piece in self._pieces(())
            ]
        return self._optima

    def _pieces(self, paths: tuple[str, ...]) -> list[kinks.Piece]:
        """The pieces of the problem with the numbers at `paths` as parameters."""
        return kinks.pieces(self.actuator.parametric(paths), self.evaluator, self.point)

    def _along(self, changes: Mapping[str, float], size: float) -> list[prices.LinearOptimum]:
        """The optimum with one parameter that moves several numbers in proportion, per piece."""
        self.differentiate(changes)
        pieces = []
        for optimum, responses_of in zip(self.optima, self._responses, strict=True):
            parts = [(responses_of[path], change) for path, change in changes.items()]
            derivatives = Responses(
                ("change",),
                np.array([size]),
                np.asarray(sum(part.rows * change for part, change in parts)),
                np.asarray(sum(part.mixed * change for part, change in parts)),
                np.asarray(sum(part.bounds * change for part, change in parts)),
                parts[0][0].differences,
            )
            pieces.append(prices.LinearOptimum(optimum, derivatives))
        return pieces

    def differentiate(self, paths: Iterable[str]) -> None:
        """Compute the derivatives with respect to the numbers at `paths`, unless already known.

        A single call for many numbers takes little longer than a call for one number.
        """
        known = self._responses[0] if self._responses else {}
        missing = tuple(path for path in dict.fromkeys(paths) if path not in known)
        if not missing:
            return
        self._responses = self._responses or [{} for _ in self.optima]
        for piece, optimum, known in zip(
            self._pieces(missing), self.optima, self._responses, strict=True
        ):
            new = responses(piece.parametric, piece.evaluator, piece.point, optimum.weights)
            for k, path in enumerate(missing):
                column = slice(k, k + 1)
                known[path] = replace(
                    new, names=(path,), values=new.values[column], rows=new.rows[:, column],
                    mixed=new.mixed[:, column], bounds=new.bounds[:, column],
                )  # fmt: skip

    def _take_gradients(self, evaluator: Evaluator) -> None:
        """Reuse the gradient check if the constraints have the same names; else check again."""
        solved, problem = self.evaluator, evaluator.problem
        if tuple(problem.constraint_names) == tuple(solved.problem.constraint_names):
            evaluator.adopt_check(solved)
        else:
            evaluator.check_gradients(
                evaluator.point(evaluator.space.to_z(problem.inside(self.point.x)))
            )

    def _valleys(self, evaluator: Evaluator) -> list[Valley]:
        """The known local optima, as starts for a changed problem."""
        solved, space = self.evaluator.space, evaluator.space
        same_coordinates = np.array_equal(solved.free, space.free) and all(
            np.array_equal(getattr(solved, name), getattr(space, name))
            for name in ("logarithmic", "scale")
        )
        same_box = same_coordinates and all(
            np.array_equal(getattr(solved, name), getattr(space, name))
            for name in ("lower", "upper")
        )
        if same_box:
            return [valley.of(evaluator.constraint_count) for valley in self.valleys]
        result = []
        for valley in self.valleys:
            point = evaluator.point(space.to_z(evaluator.problem.inside(valley.point.x)))
            if same_coordinates:
                result.append(replace(valley.of(evaluator.constraint_count), point=point))
            elif point.valid:
                result.append(valley_at(evaluator, point))
        return result

    def _stepped(
        self, evaluator: Evaluator, valleys: Sequence[Valley]
    ) -> tuple[Point | None, Vector | None]:
        """Optimum reached from the known optima, and a feasible point; each None if not found."""
        problem = evaluator.problem
        parametric = ParametricProblem.of(problem)
        if not valleys or not applicable(parametric, evaluator):
            return None, None
        changed = ChangedProblems(parametric, evaluator, np.zeros((0, 1)))
        optima, feasible = ladder.resolve_batch(changed, valleys, valleys[0].point.z[:, None])
        return optima[0], feasible[0]

    def _interrupted(self, evaluator: Evaluator) -> Solution:
        """The unchanged optimum as the result of a search that was stopped."""
        evaluator.limited = False
        point = evaluator.point(evaluator.space.to_z(evaluator.problem.inside(self.point.x)))
        return _stopped(_solution(evaluator, point, "interrupted"))

    def _follows(
        self,
        path: str,
        present: float,
        values: Sequence[float],
        rebuilt: Callable[[float], ActuatorProblem],
    ) -> bool:
        """Whether changing the number in the model gives the same problem as building it again.

        This is checked at the lowest and the highest value.

        Some numbers act not only as inputs of the models: temperatures, for example, also change
        the factors on material properties.
        """
        parametric = self.actuator.parametric((path,))
        if not applicable(parametric, self.evaluator):
            return False
        problem = self.actuator.problem
        for value in {min(values), max(values)} - {present}:
            changed = rebuilt(value).problem
            if not problem.same_rows_and_box(changed):
                return False
            x = self.point.x[:, None]
            ours, theirs = parametric.at(np.array([value])).rows(x), changed.rows(x)
            if not np.allclose(ours, theirs, rtol=AGREES, atol=AGREES, equal_nan=True):
                return False
        return True

    def _starts(
        self,
        values: Sequence[float],
        optima: Sequence[Point | None],
        feasible: Sequence[Vector | None],
        k: int,
    ) -> list[Vector]:
        """Starts for value k of a curve: its feasible point, and the optimum of the next value."""
        space, z = self.evaluator.space, feasible[k]
        starts = [] if z is None else [space.to_x(z[:, None])[:, 0]]
        known = [(abs(values[i] - values[k]), x.x) for i, x in enumerate(optima) if x is not None]
        return starts + [x for _, x in sorted(known, key=lambda pair: pair[0])[:1]]

    def _curve(
        self, path: str, values: Sequence[float], stop: Stop | None
    ) -> tuple[list[Point | None], list[Vector | None]]:
        """Optimum and feasible point for each value of a number; None where steps reach none."""
        evaluator = Evaluator(self.actuator.problem, stop=stop)
        self._take_gradients(evaluator)
        changed = ChangedProblems(self.actuator.parametric((path,)), evaluator, np.array([values]))
        starts = np.repeat(self.point.z[:, None], len(values), axis=1)
        return ladder.resolve_batch(changed, self.valleys, starts)


def _solution(evaluator: Evaluator, point: Point, algorithm: str) -> Solution:
    """A point as a solution; it counts as an optimum if it is feasible and stationary."""
    quality = kinks.check(evaluator, point) if point.valid else None
    if point.violation > MET or quality is None:
        outcome = Outcome.INFEASIBLE
    else:
        stationary = quality.residual <= RESIDUAL
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
        kkt=quality,
        evaluations=evaluator.evaluations,
        gradients=evaluator.gradients,
        algorithm=algorithm,
        seconds=time.perf_counter() - evaluator.began,
    )


def _stopped(solution: Solution) -> Solution:
    feasible = solution.violation <= MET
    outcome = Outcome.INTERRUPTED if feasible else Outcome.INTERRUPTED_INFEASIBLE
    return replace(solution, outcome=outcome)
