"""A session solves a design once, then quickly re-solves, predicts or prices changes of it.

A price is the change of the best objective per unit change of a number.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..base.arguments import SetValues, guarded
from ..base.errors import Diagnostic, InputError, Unsolvable, UsageError, remedy
from ..base.numeric import Array
from ..base.quantities import INPUTS
from ..base.tables import OneLine
from ..base.threads import one_thread
from ..design import Design, canonical, get, quantity_of
from ..evaluation import PreparedDesign
from .actuator import (
    Actuator,
    Plugins,
    Result,
    as_actuator,
    fault_of,
    located,
    read,
    require_changes,
    requirement_faults,
)
from .session_results import BareOptimum, OptimumCurve, Prediction, Price

if TYPE_CHECKING:
    from ..optimisation.actuator import ActuatorProblem
    from ..optimisation.resolve.steps import Valley
    from ..optimisation.result import Optimisation
    from ..optimisation.solution import Solution
    from ..optimisation.warm_start import WarmStart

Changes = Mapping[str, float | str]
"""New values of numbers by PATH, such as ``cylinder.stroke``: in SI, or as text with a unit."""

STARTS, SAMPLES = 6, 2048
"""Number of local searches and of sampled designs for the first solution, as in `optimise`."""

NUDGE = 1e-4
"""Relative change of a number, to test whether it affects other numbers."""

ROUNDING = 1e-9
"""Smallest relative change of a number that counts as a change; also the relative tolerance when
judging whether a prediction is valid over the whole change."""


class Session(OneLine):
    """A design's optimum, prepared so that changed problems can be re-solved quickly.

    Every call states its changes relative to the design as read; no call affects a later call. A
    weighted sum as objective divides each of its terms by the term's value in a design. For
    `solve` (and `optimise`) this is the changed design, for other methods the design as read.

    Attributes
    ----------
    optimum : the optimum of the design as read, without prices, as `optimise(prices=False)`
    """

    def __init__(self, actuator: Actuator, *, seed: int = 0) -> None:
        from ..optimisation.actuator import build, require_movable_objective
        from ..optimisation.rounding import Wanted, sizes_of
        from ..optimisation.run import result_of
        from ..optimisation.solution import Outcome
        from ..optimisation.solver import solve
        from ..optimisation.warm_start import SearchEffort, WarmStart
        from .optimum import estimated

        began = time.perf_counter()
        subject = actuator.subject()
        faults = requirement_faults(actuator, subject)
        if faults:
            raise InputError(faults)
        with located(actuator):
            _require_continuous(actuator, sizes_of(actuator.design, Wanted(), subject.materials))
            problem = build(subject, fault_of(actuator))
            require_movable_objective(problem)
        solution = solve(problem.problem, starts=STARTS, samples=SAMPLES, seed=seed)
        if solution.outcome is Outcome.NOTHING_FREE:
            message = "every variable is fixed by equal bounds: nothing to re-solve"
            raise InputError(Diagnostic(message, solution.outcome.remedy, path="variables"))
        if not solution.feasible:
            raise InputError(
                Diagnostic(
                    "no design meets all requirements, so the session has no optimum to start from",
                    "call optimise, which says what to relax",
                    path="requirements",
                )
            )
        optimisation = result_of(subject, problem, solution, prices=False, seed=seed, began=began)
        self.optimum: Optimisation = estimated(optimisation, actuator.plugins)
        self._start(
            actuator, seed, WarmStart(problem, solution, SearchEffort(STARTS, SAMPLES, seed))
        )

    def _start(self, actuator: Actuator, seed: int, warm: WarmStart) -> None:
        """Begin at an optimum."""
        self._actuator, self._seed, self._warm = actuator, seed, warm
        self._differentiable: dict[str, bool] = {}
        self._renumbering: dict[str, bool] = {}
        self._latest: tuple[dict[str, float], _Resolved, Optimisation] | None = None

    @property
    def in_short(self) -> tuple[str, str]:
        """Name and objective of the design."""
        return self.optimum.design.name, self.optimum.objective_text

    @property
    def problem(self) -> ActuatorProblem:
        """The optimisation problem of the design as read."""
        return self._warm.actuator

    @property
    def valleys(self) -> Sequence[Valley]:
        """The known local optima, the best first."""
        return self._warm.valleys

    @property
    def rough_gradients(self) -> tuple[str, ...]:
        """Labels of objective and limits whose gradients are finite differences."""
        evaluator = self._warm.evaluator
        labels = np.array(["objective", *evaluator.problem.constraint_names])
        rough = evaluator.difference_rows if evaluator.complex_works else np.ones(len(labels), bool)
        return tuple(labels[rough].tolist())

    def solve(
        self, changes: Changes, *, prices: bool = False, stop: Callable[[], bool] | None = None
    ) -> Optimisation:
        """Re-solve the optimum with some numbers changed.

        Full Newton steps start from the session's optimum. If they do not converge, feasibility is
        restored and the objective reduced; if that fails too, a full search follows. Only the
        search can report that no design exists. The optimality conditions are checked to 1e-6. In
        the result, `start` is the session's optimum, and `samples` is 0 if no search was needed. To
        learn why a result is infeasible, use `optimise`.

        Parameters
        ----------
        changes : new numbers by PATH, SI or text with a unit, relative to the design as read
        prices : whether to compute prices of requirements and parameters, as for `optimise`
        stop : called between steps; once it returns True, the result has the status "interrupted"
            or "interrupted_infeasible", and the best design so far

        Raises
        ------
        InputError
            the PATH is unknown or has a word as its value, or a new value is not finite or does not
            fit the design
        UsageError
            the PATH names a free dimension
        """
        began = time.perf_counter()
        numbers, resolved = self._solved(changes, stop)
        optimisation = self._result(resolved, prices, began)
        missed = any(not row.met for row in optimisation.evaluation.requirements)
        if resolved.renumbered and resolved.solution.feasible and missed:  # a limit of no variable
            resolved = self._anew(resolved.actuator, stop)
            optimisation = self._result(resolved, prices, began)
        self._latest = numbers, resolved, optimisation
        return optimisation

    def bare_optimum(
        self, changes: Changes, *, stop: Callable[[], bool] | None = None
    ) -> BareOptimum | None:
        """Re-solve the optimum with some numbers changed, without evaluating its design.

        It takes a tenth of the time of `solve`, and its optimality conditions are checked likewise.
        Only the recorded models are run: `solve` also compares them with the models themselves.

        Parameters and errors as for `solve`.

        Returns
        -------
        the optimum, or None if the steps near the session's optimum reach none or `stop` ended
        them; only `solve` can then show whether a design exists
        """
        from ..optimisation.solution import Outcome

        actuator, numbers = self._changed(changes)
        resolved = self._near(actuator, numbers, stop)
        if resolved is None or resolved.solution.outcome is not Outcome.OPTIMUM:
            return None
        solution, problem = resolved.solution, resolved.problem
        assert solution.kkt is not None
        values = self._named(solution.x)
        subject = replace(resolved.subject, numbers={**resolved.subject.numbers, **values})
        return BareOptimum(
            objective=problem.goal.shown(solution.objective),
            variables=values,
            active=solution.kkt.active,
            residual=float(solution.kkt.residual),
            subject=subject,
            limits=tuple(row for row in problem.rows if row.label in solution.kkt.active),
        )

    def _result(self, resolved: _Resolved, prices: bool, began: float) -> Optimisation:
        from ..optimisation.run import result_of

        optimisation = result_of(
            resolved.subject,
            resolved.problem,
            resolved.solution,
            prices=prices,
            seed=self._seed,
            began=began,
            start=self.optimum.evaluation,
        )
        starts = self._warm.point.x.tolist()
        return replace(
            optimisation,
            variables=tuple(
                replace(variable, start=x)
                for variable, x in zip(optimisation.variables, starts, strict=True)
            ),
        )

    def at(self, changes: Changes) -> Session:
        """A session at the optimum with some numbers changed: its prices are those there.

        Parameters and errors as for `solve`.

        Raises
        ------
        Unsolvable
            no design meets all requirements with these numbers
        """
        from ..optimisation.warm_start import WarmStart

        if self._latest is None or self._latest[0] != self._changed(changes)[1]:
            self.solve(changes)
        assert self._latest is not None
        _, resolved, optimum = self._latest
        if not resolved.solution.feasible:
            message = "no design meets all requirements with these numbers"
            raise Unsolvable(Diagnostic(message, "call optimise, which says what to relax"))
        moved = object.__new__(Session)
        moved.optimum = replace(optimum, sensitivities=())
        moved._start(
            resolved.actuator,
            self._seed,
            WarmStart(resolved.problem, resolved.solution, self._warm.effort),
        )
        moved._differentiable |= self._differentiable  # keys and words decide it
        return moved

    def predict(self, changes: Changes) -> Prediction:
        """Predict the optimum after a change of some numbers, linearly, without running models.

        Only the first prediction that involves a number runs the models, to compute its
        derivatives. Parameters and errors as for `solve`; a number without a derivative raises
        `UsageError`.
        """
        _, numbers = self._changed(changes)
        present = {path: self._priced(path) for path in numbers}
        steps = {
            path: value - present[path]
            for path, value in numbers.items()
            if abs(value - present[path]) > ROUNDING * abs(present[path])
        }
        objective, x = self.optimum.objective_value, self._warm.point.x
        if not steps:
            return Prediction(objective, self._named(x), valid=True)
        line = self._warm.line(steps)
        change = self._shown(line.above)
        why = ""
        if line.high is not None and line.high[0] < 1 - ROUNDING:
            why = f"after {100 * abs(line.high[0]):.3g} % of the change, {line.high[1]}"
        if not math.isfinite(line.above):
            why = "even the smallest change in this direction leaves no feasible design"
        return Prediction(objective + change, self._named(x + line.moves), not why, why)

    def price(self, path: str) -> Price:
        """Compute the price of a number at the session's optimum (see `Price`).

        The slope is the derivative of the Lagrangian with respect to the number [Fiacco1983]; at a
        degenerate vertex it differs for an increase and a decrease [Gauvin1982].

        Parameters
        ----------
        path : PATH of a fixed number

        Raises
        ------
        InputError
            the PATH is unknown or has a word as its value
        UsageError
            the PATH names a free dimension, or a number without derivative, such as a bound of a
            variable
        """
        return self.prices([path])[0]

    def prices(self, paths: Sequence[str]) -> tuple[Price, ...]:
        """Compute the prices of several numbers; their derivatives are computed together."""
        names = [self._path(path) for path in paths]
        values = {path: self._priced(path) for path in names}
        self._warm.differentiate(names)
        return tuple(self._price(path, values[path]) for path in names)

    def _price(self, path: str, value: float) -> Price:
        line = self._warm.line({path: 1.0}, value)
        low, high = self._end(line.low, value), self._end(line.high, value)
        return Price(
            path=path,
            value=value,
            slope_down=self._slope(line.below),
            slope_up=self._slope(line.above),
            holds=(low[0], high[0]),
            changes=(low[1], high[1]),
            movement=self._named(line.moves),
        )

    def curve(
        self,
        path: str,
        values: Sequence[float | str] | Array,
        *,
        stop: Callable[[], bool] | None = None,
        search: bool = True,
    ) -> OptimumCurve:
        """Compute the optima for several values of one number.

        Values that cannot be solved together are solved one by one, beginning with those nearest to
        the session's own value of the number. Above and below that value, this search stops at the
        first value without a feasible design.

        Parameters
        ----------
        path : PATH of the number
        values : list or one-dimensional array of values in SI, or texts with a unit
        stop : called between steps; True ends the search, and values not solved by then have no
            design
        search : whether to search where the steps near other optima reach no design. Without it, a
            value without a design costs milliseconds, but only a search can show that there is none

        Raises
        ------
        InputError, UsageError
            as for `solve`; or `values` is empty, not one-dimensional or not finite
        """
        from ..sweeps.plan import one_dimensional

        if isinstance(values, str) or (isinstance(values, Sequence) and not values):
            raise UsageError(Diagnostic("a curve needs a list of values", 'e.g. [0.1, "112 mm"]'))
        one_dimensional(self._path(path), values, self._actuator.design)
        numbers = [self._changed({path: value})[1] for value in values]
        path = next(iter(numbers[0]))
        si_values = [number[path] for number in numbers]
        optima = self._warm.solve_together(
            path,
            si_values,
            lambda value: self._built(self._changed({path: value})[0])[1],
            stop,
            search=search,
        )
        goal = self._warm.actuator.goal
        metrics = self.optimum.evaluation.metrics
        single = goal.single
        return OptimumCurve(
            path=path,
            quantity=quantity_of(path, self._actuator.design),
            values=tuple(si_values),
            objectives=tuple(None if x is None else goal.shown(x.objective) for x in optima),
            variables=tuple({} if x is None else self._named(x.x) for x in optima),
            objective=None if single is None else metrics[single].quantity,
            quantities={x.path: INPUTS[x.quantity] for x in self.optimum.variables},
        )

    def _changed(self, changes: Changes) -> tuple[Actuator, dict[str, float]]:
        """The changed design, and the changed numbers in SI by canonical PATH."""
        require_changes(changes)
        actuator, numbers = self._actuator, {}
        for path in changes:
            name = self._path(path)
            if name in self._actuator.design.variables:
                raise UsageError(
                    Diagnostic(
                        "is a free dimension, whose value the session computes",
                        f"to fix it, change lower, upper and start of variables.{name}",
                        path=path,
                    )
                )
        with located(actuator):
            changed = actuator.changed(dict(changes))
        for path in changes:
            number = get(changed.design, path)
            assert isinstance(number, float | int)
            numbers[self._path(path)] = float(number)
        return changed, numbers

    def _path(self, path: str) -> str:
        """The canonical form of a number's PATH."""
        if not isinstance(path, str):
            raise InputError(
                Diagnostic(f"must be a PATH, not {type(path).__name__}", "write a text")
            )
        design = self._actuator.design
        with located(self._actuator):
            name = canonical(path, design)
            try:
                quantity_of(name, design)
            except InputError:
                raise InputError(
                    Diagnostic(
                        "is a word, not a number",
                        "to change a word, open a new session with the changed design",
                        path=path,
                    )
                ) from None
        return name

    @one_thread()
    def _solved(
        self, changes: Changes, stop: Callable[[], bool] | None = None
    ) -> tuple[dict[str, float], _Resolved]:
        """The changed numbers, and the changed problem with its optimum."""
        actuator, numbers = self._changed(changes)
        subject, problem, renumbered = self._problem(actuator, numbers)
        solution = self._warm.solve(problem.problem, stop)
        if problem.confirmed(solution.x):
            return numbers, _Resolved(actuator, subject, problem, solution, renumbered)
        return numbers, self._anew(actuator, stop)

    @one_thread()
    def _near(
        self, actuator: Actuator, numbers: dict[str, float], stop: Callable[[], bool] | None
    ) -> _Resolved | None:
        """The changed problem with its optimum, if steps from the session's optimum reach it."""
        subject, problem, renumbered = self._problem(actuator, numbers)
        solution = self._warm.solve_near(problem.problem, stop)
        if solution is None:
            return None
        return _Resolved(actuator, subject, problem, solution, renumbered)

    def _anew(self, actuator: Actuator, stop: Callable[[], bool] | None) -> _Resolved:
        """The same by a problem built anew, and by the models if the recording is wrong."""
        subject, problem = self._built(actuator)
        solution = self._warm.solve(problem.problem, stop)
        if not problem.confirmed(solution.x):
            solution = self._warm.solve(problem.problem, stop)
        return _Resolved(actuator, subject, problem, solution)

    def _problem(
        self, actuator: Actuator, numbers: Mapping[str, float]
    ) -> tuple[PreparedDesign, ActuatorProblem, bool]:
        """The design and problem of changed numbers, and whether the problem is `renumbered`."""
        from ..optimisation.actuator import renumbered

        if all(self._only_numbers(path, value) for path, value in numbers.items()):
            subject = actuator.subject()
            problem = renumbered(self._warm.actuator, subject)
            if problem is not None:
                return subject, problem, True
        return *self._built(actuator), False

    def _only_numbers(self, path: str, value: float) -> bool:
        """Whether a changed number leaves the structure of the problem as it is.

        A new problem is built for the first value of every number. It must have the same limits and
        bounds, and the limits that no variable affects must keep their margins.
        """
        from ..optimisation.actuator import renumbered

        if path not in self._renumbering:
            own = self._warm.actuator
            try:
                subject, built = self._built(self._actuator.changed({path: value}))
            except InputError:  # valid only together with another change
                return False
            self._renumbering[path] = (
                renumbered(own, subject) is not None
                and built.problem.same_rows_and_box(own.problem)
                and _margins(built) == _margins(own)
            )
        return self._renumbering[path]

    def _built(self, actuator: Actuator) -> tuple[PreparedDesign, ActuatorProblem]:
        from ..optimisation.actuator import build

        subject = actuator.subject()
        with located(actuator):
            problem = build(subject, fault_of(actuator))
        limited_metrics = {row.limit_of.metric for row in (*problem.rows, *problem.fixed)}
        if not limited_metrics.issuperset(actuator.design.requirements):
            faults = requirement_faults(actuator, subject)
            if faults:
                raise InputError(faults)
        return subject, problem

    def _priced(self, path: str) -> float:
        """The present value of a number; rejects a number that has no price."""
        numbers = self._warm.actuator.subject.numbers
        if path in self._actuator.design.variables:
            raise UsageError(
                Diagnostic("a free dimension has no price", "name a fixed number", path=path)
            )
        if path not in numbers:
            raise UsageError(
                Diagnostic(
                    (
                        "has no derivative at the optimum, because the design does not state a "
                        "number for it"
                    ),
                    remedy(path, numbers) if get(self._actuator.design, path) is None
                    else "re-solve with the changed value instead (session.solve)",
                    path=path,
                )
            )  # fmt: skip
        if path not in self._differentiable:
            self._differentiable[path] = self.only_read(path, float(numbers[path]))
        if not self._differentiable[path]:
            raise UsageError(
                Diagnostic(
                    "has no derivative here, because it is a whole number or also changes "
                    "other inputs",
                    "re-solve with the changed value instead (session.solve, session.curve)",
                    path=path,
                )
            )
        return float(numbers[path])

    def only_read(self, path: str, value: float) -> bool:
        """Whether a number is only an input of the models: no other number or factor depends on it.

        Counter-example: a temperature also changes the factors on strengths.
        """
        own = self._warm.actuator.subject
        for share in (NUDGE, -NUDGE):
            try:
                changed = self._actuator.changed({path: value + share * (abs(value) or 1.0)})
            except InputError:
                continue
            subject = changed.subject()
            others = {**subject.numbers, path: value} == dict(own.numbers)
            return others and subject.factors == own.factors
        return False

    def _shown(self, slope: float) -> float:
        """A change of the objective with the user's sign (the search itself always minimises)."""
        return self._warm.actuator.goal.shown(slope)

    def _slope(self, slope: float) -> float | None:
        return self._shown(slope) if math.isfinite(slope) else None

    def _end(self, end: tuple[float, str] | None, value: float) -> tuple[float | None, str | None]:
        """The number's value at which the active limits change, if that is within ±100 %."""
        if end is None or abs(end[0]) > (abs(value) or 1.0):
            return None, None
        return value + end[0], end[1]

    def _named(self, x: Iterable[float]) -> dict[str, float]:
        """The values of the free dimensions by PATH."""
        return dict(zip(self._warm.actuator.paths, map(float, x), strict=True))


class _Resolved(NamedTuple):
    """A changed design, its problem and its optimum.

    `renumbered` says whether the problem is the session's own with other numbers.
    """

    actuator: Actuator
    subject: PreparedDesign
    problem: ActuatorProblem
    solution: Solution
    renumbered: bool = False


def _margins(problem: ActuatorProblem) -> list[tuple[str, float]]:
    """The margins of all limits that no variable affects, with their labels."""
    return [(row.label, float(row.margin[0])) for row in problem.fixed]


def _require_continuous(actuator: Actuator, sizes: object) -> None:
    """Reject choices and listed sizes, because a session only re-solves continuous dimensions."""
    design = actuator.design
    if design.choices:
        raise UsageError(
            Diagnostic(
                "a session cannot vary choices, but the design states choices to try",
                "optimise it, and open a session on the best design",
                path="choices",
            )
        )
    if sizes is not None:
        raise UsageError(
            Diagnostic(
                "a session re-solves continuous dimensions, but some variables take listed sizes",
                "remove `sizes` and `step` of the variables",
                path="variables",
            )
        )


@guarded
def session(
    design: Actuator | Design | Result | str | Path,
    *,
    set: SetValues = (),
    plugins: Plugins = (),
    seed: int = 0,
) -> Session:
    """Solve a design once, so that changed designs can be re-solved quickly.

    Parameters
    ----------
    design : as for `optimise`
    set : values to replace first, by PATH; a number without a unit is SI
    plugins : the user's metrics and constraints
    seed : seed of the search

    Raises
    ------
    InputError
        the design has a fault or no variables, or no design meets all requirements
    UsageError
        the design has choices, or variables with listed sizes
    """
    if isinstance(design, (str, Path)):
        return Session(read(design, set=set, plugins=plugins), seed=seed)
    actuator, changes = as_actuator(design, plugins), dict(set)
    return Session(actuator.changed(changes) if changes else actuator, seed=seed)
