"""Finds the best combination of the design's choices: a quick look at each, then full solutions.

A quick look descends from the nearest known design. It usually finds the optimum of a combination
but may miss it. The best combination is then solved from many starts, and combinations nearly as
good from a few. One that becomes the best by this is solved from many starts too. The record of
each combination states how it was searched.

If variables take listed sizes, the sizes of each combination are searched, starting with the best
combination. The continuous optimum bounds the result with sizes, so a combination is skipped if
this bound does not beat the best design with sizes. The bounds are local optima, mostly of a quick
look, so this skipping is no proof. A search of sizes that would repeat an earlier one is skipped
too (see `Evidence`).

On a cluster, the combinations that are next by the present ranking are solved side by side. Which
of them count is then decided in order, as in one process; if a result changes the start of another
combination, this combination is solved again. Combinations without variables are evaluated side by
side. Quick looks, and searches of sizes, need the results of earlier combinations: they run in one
process.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import field, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from ..base.cluster import HERE, Cluster
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError
from ..design import Design
from ..design.choice_list import Value, combinations, left_out
from ..design.materials import load_library
from ..evaluation import PreparedDesign, compute
from ..evaluation.limits import LimitRow, all_limits, rows_of
from .actuator import ActuatorProblem, Goal, build, goal_of, variant
from .branch_and_bound import Memory, SizeSearch, at, search
from .evaluator import Evaluator, Point
from .problem import BoxProblem, Vector
from .quick_look import DOUBTFUL, Look, LookStart, hessian_of, look_quickly
from .resolve.boxes import NEAR
from .resolve.steps import ScaledHessian
from .result import Choices, Combination, How
from .rounding import RUNNERS_UP, ListedSizes, Wanted, sizes_of
from .solution import MET, Solution
from .solver import solve

SAME_OPTIMUM = 1e-6
"""Continuous optima count as equal up to this relative difference, the accuracy of quick looks."""


@dataclass(frozen=True)
class Evidence:
    """Results of all boxes (parts of the space) of a search, and the continuous `optimum`.

    Combinations often differ only in numbers that enter inactive limits, such as the viscosity of
    oils with the same bulk modulus. The search of listed sizes depends on the result of each box:
    its optimum or its least infeasible point. If values and slopes of two problems agree at these
    points, both searches give the same results. A limit may differ between the problems if all
    these points are farther from it than their accuracy.
    """

    problem: BoxProblem
    optimum: float
    ends: Sequence[tuple[Evaluator, Point]]

    def holds_for(self, other: BoxProblem, optimum: float) -> bool:
        """Whether a search of another problem would give the same result."""
        problem = self.problem
        if not self.ends or abs(optimum - self.optimum) > SAME_OPTIMUM * abs(self.optimum):
            return False
        if problem.names != other.names or not problem.same_rows_and_box(other):
            return False
        exact = all(evaluator.exact for evaluator, _ in self.ends)
        if not exact or problem.equality_names or other.equality_names:
            return False
        parts = [evaluator.columns(end.z[:, None]) for evaluator, end in self.ends]
        rows = np.split(
            other.rows(np.concatenate(parts, axis=1)),
            np.cumsum([part.shape[1] for part in parts])[:-1],
            axis=1,
        )
        comparisons = [
            (end, evaluator.jacobian(end), *evaluator.values_and_slopes(part))
            for (evaluator, end), part in zip(self.ends, rows, strict=True)
        ]
        differing = np.zeros(problem.row_count, dtype=bool)
        for end, slopes, values, other_slopes in comparisons:
            differing |= (values[:, 0] != end.rows) | (slopes != other_slopes).any(axis=1)
        return not differing[0] and all(
            (_distance(end.rows, slopes)[differing] > NEAR.step).all()
            and (_distance(values[:, 0], other_slopes)[differing] > NEAR.step).all()
            for end, slopes, values, other_slopes in comparisons
        )


def _distance(rows: Vector, slopes: Vector) -> Vector:
    """Distance to each limit in solver coordinates, estimated from margin and slope."""
    return np.asarray(rows / np.maximum(np.sqrt((slopes**2).sum(axis=1)), 1e-300))


CLOSE = 0.05
"""A combination worse than the best by at most this relative amount is solved again, from a few
starts."""

FEW_STARTS = 2
"""Number of starts of a combination nearly as good as the best: the point of the quick look, and
the best point of a sweep."""

FEW_SAMPLES = 512
"""Number of points of this sweep."""

MOST_DOUBTFUL = 2
"""Once this number of combinations had no feasible design even from many starts, no further such
combination is tried from many starts, as these searches take long."""

MOST_SOLVED = 3
"""Maximum number of combinations solved from many or a few starts (our choice). Ten combinations of
joints of the knee then take about four times the time of one."""

BETTER = 1e-3
"""If many starts improve a design by this relative amount, all feasible combinations get a second
quick look."""

LEAST_SECONDS = 0.1
"""Minimum time for the first look and for the best combination, whatever the time limit."""

EQUAL = 1e-6
"""Relative difference up to which objectives count as equal; the first in the file is then
preferred."""


@dataclass(frozen=True, slots=True)
class ChoiceSettings:
    """Settings of the searches; `until` is the `time.perf_counter` at which they stop."""

    algorithm: str
    starts: int
    samples: int
    seed: int
    until: float | None

    def left(self, share: float = 1.0, began: float = 0.0) -> float | None:
        """Seconds left if only a `share` of the time from `began` to the limit may be used.

        None without a limit.
        """
        if self.until is None:
            return None
        return began + share * (self.until - began) - time.perf_counter()


@dataclass
class ChoiceSearch:
    """All combinations of a design's choices."""

    goal: Goal
    looks: list[Look] = field(default_factory=list)

    def mendable(self) -> frozenset[str]:
        """Checks that some combinations miss and others meet."""
        lists = [
            look.checks for look in self.looks if look.how not in ("not tried", "not possible")
        ]
        return frozenset().union(*lists) - frozenset.intersection(*lists) if lists else frozenset()

    def ranked(self) -> list[Look]:
        """The combinations sorted by requirements met, checks met, objective and file order."""
        mendable = self.mendable()

        def rank(look: Look) -> tuple[bool, float, int, float, int]:
            missed = 0.0 if look.feasible else look.violation
            checks = len(look.checks & mendable)
            fault = bool(look.fault) or look.sizing == "no size fits"
            return (fault, missed, checks, look.objective, look.order)

        looks = sorted(self.looks, key=rank)
        sized = [look for look in looks if look.rounded is not None]
        if sized:
            sized.sort(key=lambda look: (len(look.checks & mendable), look.rounded, look.order))
            return [*sized, *(look for look in looks if look.rounded is None)]
        best = looks[0]
        equal = [
            look
            for look in looks
            if best.feasible
            and rank(look)[:3] == rank(best)[:3]
            and (look.how == best.how or look.solution is not None)
            and look.objective - best.objective <= EQUAL * abs(best.objective)
        ]
        first = min(equal, key=lambda look: look.order, default=best)
        return [first, *(look for look in looks if look is not first)]


def possible(subject: PreparedDesign) -> list[Look]:
    """All combinations of the choices, each with its design or the reason why it is left out.

    A combination is impossible, or equal to an earlier one: a joint without a material is the same
    with every material.

    Raises
    ------
    InputError
        every combination is impossible
    """
    library = load_library()
    looks: list[Look] = []
    for order, values in enumerate(combinations(subject.design)):
        look = Look(order, values)
        try:
            look.subject = variant(subject, values, library)
        except InputError as error:
            _give_up(look, error)
        else:
            _drop_repeated(look, looks)
        looks.append(look)
    _require_one(looks)
    return looks


def _drop_repeated(look: Look, earlier: Sequence[Look]) -> None:
    assert look.subject is not None
    for other in earlier:
        if other.subject is not None and other.subject.design == look.subject.design:
            values = ", ".join(f"{path}: {value}" for path, value in other.values.items())
            look.fault, look.how = f"the same design as {values}", "not possible"
            look.subject = None
            return


def _give_up(look: Look, error: InputError) -> None:
    diagnostic = error.diagnostics[0]
    look.fault = (
        f"{diagnostic.path}: {diagnostic.message}" if diagnostic.path else diagnostic.message
    )
    look.how = "not possible"


def never_possible(looks: Sequence[Look]) -> Iterator[str]:
    """Yield a sentence on each allowed value that no possible combination has."""
    for path in looks[0].values:
        by_value: dict[Value, list[str]] = {}
        for look in looks:
            by_value.setdefault(look.values[path], []).append(look.fault)
        for value, faults in by_value.items():
            if all(faults):
                yield f"choices.{path}: no combination with {value} is possible: {faults[0]}"


def _require_one(looks: Sequence[Look]) -> None:
    if all(look.fault for look in looks):
        faults = dict.fromkeys(look.fault for look in looks)
        texts = "; ".join(list(faults)[:3])
        count = (
            "the only combination is" if len(looks) == 1 else f"all {len(looks)} combinations are"
        )
        message = f"{count} impossible: {texts}"
        raise InputError(
            Diagnostic(message, "change the values listed in the block `choices`", path="choices")
        )


@np.errstate(all="ignore")  # designs without finite values come last
def search_choices(
    subject: PreparedDesign,
    settings: ChoiceSettings,
    max_solved: int = MOST_SOLVED,
    cluster: Cluster = HERE,
) -> ChoiceSearch:
    """Look at every combination of the choices, and solve the best ones from many starts.

    Parameters
    ----------
    subject : the design with its choices
    settings : settings of the full searches
    max_solved : maximum number of combinations solved from many or a few starts
    cluster : workers for independent combinations

    Raises
    ------
    InputError
        every combination is impossible
    """
    choice_search = ChoiceSearch(goal_of(subject), possible(subject))
    if not subject.design.variables:
        work = partial(_evaluated, choice_search.goal)
        choice_search.looks = list(cluster.map(work, choice_search.looks))
        _require_one(choice_search.looks)
        return choice_search
    for look in choice_search.looks:
        if look.subject is None:
            continue
        try:
            look.actuator = _with_goal(build(look.subject), choice_search.goal)
            look.checks = _missed_checks(look.actuator.fixed)
        except InputError as error:
            _give_up(look, error)
    _require_one(choice_search.looks)
    _look_at_all(choice_search, settings)
    _solve_best(choice_search, settings, max_solved, cluster)
    return choice_search


def _with_goal(actuator: ActuatorProblem, goal: Goal) -> ActuatorProblem:
    """The problem with one common objective, so that all combinations use the same weights."""
    shared = replace(actuator, goal=goal)
    return replace(shared, problem=replace(actuator.problem, evaluate=shared.evaluate))


def _missed_checks(rows: Sequence[LimitRow]) -> frozenset[str]:
    return frozenset(
        row.limit_of.name
        for row in rows
        if row.limit_of.origin == "check" and not float(row.margin[0]) >= -MET
    )


@np.errstate(all="ignore")
def _evaluated(goal: Goal, look: Look) -> Look:
    """Evaluate a combination that has no free variables; return it."""
    if look.subject is not None:
        try:
            _evaluate(look, look.subject, goal)
        except InputError as error:
            _give_up(look, error)
    return look


def _evaluate(look: Look, subject: PreparedDesign, goal: Goal) -> None:
    values = subject.values()
    computed = compute(subject, values).computed
    limits = all_limits(subject.design, subject.plugins)
    rows = [row for limit in limits for row in rows_of(limit, computed, values)]
    look.how = "evaluated"
    look.objective = float(np.squeeze(goal.value(computed, subject.cases)))
    look.checks = _missed_checks(rows)
    margins = {
        row.label: np.nan_to_num(float(row.margin[0]), nan=-math.inf)
        for row in rows
        if row.limit_of.origin not in ("check", "advice")
    }
    look.missed = min(margins, key=lambda label: margins[label])
    look.violation = max(-float(margins[look.missed]), 0.0)
    if not math.isfinite(look.objective):
        message = "the objective has no finite value"
        raise InputError(Diagnostic(message, path="objective"))


def _look_at_all(choice_search: ChoiceSearch, settings: ChoiceSettings) -> None:
    """Take a quick look at every combination, in half of the available time."""
    began = time.perf_counter()
    last = {look.actuator.paths: look.order for look in choice_search.looks if look.actuator}
    for look in choice_search.looks:
        seconds = settings.left(0.5, began)
        if look.actuator is None or (seconds is not None and seconds <= 0 and _any(choice_search)):
            continue
        seconds = None if seconds is None else max(seconds, LEAST_SECONDS)
        try:
            look_quickly(look, _starts(choice_search, look), settings.seed, seconds)
        except InputError as error:
            _give_up(look, error)
        needed = look.order < last[look.actuator.paths]  # by a later one with the same variables
        if look.hessian is None and look.feasible and needed:
            look.hessian = hessian_of(look)


def _any(choice_search: ChoiceSearch) -> bool:
    return any(look.x is not None for look in choice_search.looks)


def _translated(other: Look, look: Look) -> Vector | None:
    """The best point of a combination, in the variables of another combination.

    A variable that only the other combination has keeps its start.
    """
    if other.x is None or other.actuator is None or look.actuator is None:
        return other.x
    known = dict(zip(other.actuator.paths, other.x, strict=True))
    start = look.actuator.problem.start
    assert start is not None
    pairs = zip(look.actuator.paths, start, strict=True)
    return np.array([known.get(path, number) for path, number in pairs])


def _shared(other: Look, look: Look) -> ScaledHessian | None:
    """The Hessian of another combination, if both have the same variables."""
    if other.actuator is None or look.actuator is None:
        return None
    return other.hessian if other.actuator.paths == look.actuator.paths else None


def _starts(choice_search: ChoiceSearch, look: Look) -> list[LookStart]:
    """Starts for a combination, from solved combinations that differ in the fewest values.

    From a feasible neighbour, a descent starts. From an infeasible neighbour, a search starts that
    reduces the violation. The nearest neighbour with a known Hessian (the latest of several) gives
    a third start, whose steps use that Hessian.
    """
    solved = [
        replace(other, x=_translated(other, look), hessian=_shared(other, look))
        for other in choice_search.looks
        if other.x is not None and other is not look
    ]

    def distance(other: Look) -> tuple[int, float]:
        differing = sum(other.values[path] != value for path, value in look.values.items())
        return differing, other.objective

    feasible = min((other for other in solved if other.feasible), key=distance, default=None)
    infeasible = min((other for other in solved if not other.feasible), key=distance, default=None)
    starts = []
    infeasible_is_closer = infeasible is not None and (
        feasible is None or distance(infeasible)[0] <= distance(feasible)[0]
    )
    if infeasible_is_closer and infeasible is not None and infeasible.x is not None:
        starts.append(LookStart(infeasible.x, descend=False))
    if feasible is not None and feasible.x is not None:
        starts.append(LookStart(feasible.x, descend=True))
    latest = min(
        (other for other in solved if other.hessian is not None),
        key=lambda other: (distance(other)[0], -other.order),
        default=None,
    )
    if latest is not None and latest.x is not None:
        starts.append(LookStart(latest.x, descend=True, hessian=latest.hessian))
    start = None if look.actuator is None else look.actuator.problem.start
    return starts or ([] if start is None else [LookStart(start, descend=True)])


def _solve_best(
    choice_search: ChoiceSearch, settings: ChoiceSettings, max_solved: int, cluster: Cluster
) -> None:
    """Solve the best combination from many starts, and those nearly as good from a few."""
    first_gain = True
    ahead: dict[int, _SolvedTask] = {}
    for number in range(max_solved):
        look = _promising(choice_search)
        seconds = settings.left()
        if look is None or (seconds is not None and seconds <= 0):
            break
        previous = look.objective if look.feasible else math.inf
        if cluster and (look.order not in ahead or ahead[look.order].start is not look.x):
            looks = [look, *(other for other in _close(choice_search) if other is not look)]
            ahead = _solved_ahead(looks[: max_solved - number], settings, cluster)
        solve_again(look, settings, ahead.get(look.order), few=_nearly_best(choice_search, look))
        gained = look.feasible and look.objective < previous - BETTER * abs(look.objective)
        if first_gain and gained and look.x is not None:
            first_gain = False
            for other in choice_search.looks:
                promising = other.violation <= DOUBTFUL
                if other.solution is None and other.actuator is not None and promising:
                    start = _translated(look, other)
                    assert start is not None
                    look_quickly(
                        other, [LookStart(start, descend=True)], settings.seed, settings.left()
                    )
    best = choice_search.ranked()[0]
    if best.how != "multistart":
        solve_again(best, settings)


def _promising(choice_search: ChoiceSearch) -> Look | None:
    """The next combination to solve; None if all others are clearly worse."""
    best = choice_search.ranked()[0]
    return best if best.how != "multistart" else next(iter(_close(choice_search)), None)


def _nearly_best(choice_search: ChoiceSearch, look: Look) -> bool:
    """Whether a few starts are enough: a feasible combination that is not the best."""
    return look.feasible and look is not choice_search.ranked()[0]


def _close(choice_search: ChoiceSearch) -> list[Look]:
    """Combinations with a quick look only that are nearly as good as the best."""
    ranked, mendable = choice_search.ranked(), choice_search.mendable()
    best, looks = ranked[0], []
    solved = sum(look.solution is not None and not look.feasible for look in ranked)
    for look in ranked[1:]:
        if look.solution is not None or look.how != "quick":
            continue
        gap = look.objective - best.objective
        close = gap <= CLOSE * abs(best.objective)
        as_good = len(look.checks & mendable) <= len(best.checks & mendable)
        doubtful = not look.feasible and look.violation <= best.violation + DOUBTFUL
        promising = best.feasible and look.feasible and close and as_good
        if promising or (doubtful and solved < MOST_DOUBTFUL):
            looks.append(look)
    return looks


class _SolveTask(NamedTuple):
    """A combination to solve: its problem, known point and time limit, and starts and samples."""

    problem: BoxProblem
    start: Vector | None
    seconds: float | None
    starts: int
    samples: int


class _SolvedTask(NamedTuple):
    start: Vector | None
    solution: Solution
    few: bool


def _task(look: Look, settings: ChoiceSettings, *, few: bool) -> _SolveTask:
    assert look.actuator is not None
    seconds = settings.left()
    seconds = None if seconds is None else max(seconds, LEAST_SECONDS)
    problem, starts, samples = look.actuator.problem, settings.starts, settings.samples
    if few:  # the quick look has started from the problem's own start, or from a better design
        problem = replace(problem, start=look.x)
        return _SolveTask(problem, None, seconds, FEW_STARTS, min(samples, FEW_SAMPLES))
    return _SolveTask(problem, look.x, seconds, starts, samples)


@np.errstate(all="ignore")
def _solution(settings: ChoiceSettings, task: _SolveTask) -> Solution:
    return solve(
        task.problem,
        algorithm=settings.algorithm,
        starts=task.starts,
        samples=task.samples,
        seed=settings.seed,
        max_seconds=task.seconds,
        more_starts=[] if task.start is None else [task.start],
    )


def _solved_ahead(
    looks: Sequence[Look], settings: ChoiceSettings, cluster: Cluster
) -> dict[int, _SolvedTask]:
    """Solve combinations on a cluster; the results by the place of the combination in the file.

    The first is solved from many starts, as are those without a feasible design.
    """
    few = [number > 0 and look.feasible for number, look in enumerate(looks)]
    tasks = [_task(look, settings, few=k) for look, k in zip(looks, few, strict=True)]
    solutions = cluster.map(partial(_solution, settings), tasks)
    return {
        look.order: _SolvedTask(look.x, solution, k)
        for look, solution, k in zip(looks, solutions, few, strict=True)
    }


def solve_again(
    look: Look, settings: ChoiceSettings, ahead: _SolvedTask | None = None, *, few: bool = False
) -> None:
    """Solve a combination from many or a `few` starts, and from its best known point.

    A solution `ahead` is used if it started from this point, with as many starts.
    """
    if ahead is not None and ahead.start is look.x and ahead.few == few:
        solution = ahead.solution
    else:
        solution = _solution(settings, _task(look, settings, few=few))
    look.how, look.solution = "few starts" if few else "multistart", solution
    look.x, look.objective, look.violation = solution.x, solution.objective, solution.violation
    if len(solution.constraints):
        assert look.actuator is not None
        worst = int(np.argmin(solution.constraints))
        look.missed = look.actuator.problem.constraint_names[worst]


def record(choice_search: ChoiceSearch, design: Design) -> Choices:
    """All combinations, the best first.

    Parameters
    ----------
    choice_search : the finished search
    design : the design of the file
    """
    ranked, mendable = choice_search.ranked(), choice_search.mendable()
    best, rows = ranked[0], []
    least = best.objective if best.rounded is None else best.rounded
    for look in ranked:
        cost = None
        objective = look.objective if look.rounded is None else look.rounded
        if look.feasible and best.feasible and look.sizing not in _WITHOUT:
            cost = objective - least
            cost = 0.0 if abs(cost) <= EQUAL * abs(least) else cost
        rows.append(
            Combination(
                values=look.values,
                how=look.how,
                feasible=look.feasible,
                status=_status(look, mendable, best.rounded is not None),
                objective=choice_search.goal.shown(look.objective)
                if math.isfinite(look.objective)
                else None,
                cost=cost,
                percent=100 * cost / abs(least) if cost and least else cost,
                rounded=None if look.rounded is None else choice_search.goal.shown(look.rounded),
            )
        )
    choices = Choices("", tuple(rows), left_out(design))
    return replace(choices, sentence=_sentence(choices))


def _status(look: Look, mendable: frozenset[str], sized: bool) -> str:
    """Sentence on one combination: how it was searched, and the outcome."""
    if look.fault:
        return f"not possible: {look.fault}"
    if look.how == "not tried":
        return "not tried: time limit reached"
    checks = ", ".join(sorted(look.checks & mendable))
    if look.feasible:
        outcome = (
            "all requirements are met" if look.solution is None else look.solution.outcome.sentence
        )
        if look.sizing:
            outcome = f"{outcome}; {_SIZING[look.sizing]}"
        elif look.rounded is None and sized:
            outcome = (
                f"{outcome}; listed sizes were not searched, because they cannot improve on the "
                "best design"
            )
        if checks:
            outcome = f"misses the check {checks}, which other choices meet; {outcome}"
    else:
        by = f" by {100 * look.violation:.2g} %" if math.isfinite(look.violation) else ""
        outcome = (
            f"misses {look.missed}{by}"
            if look.missed
            else "the models have no finite value at any point tried"
        )
    return _WAYS[look.how] + outcome


_SIZING = {
    "found": "the search gave this combination's best design with listed sizes",
    "sizes of the best": "computed with the listed sizes of the best design",
    "none better": "the search found no better design with listed sizes",
    "none": "the search found no feasible design with listed sizes",
    "no size fits": "no listed size lies within the bounds",
}
"""Words for each result of the search for listed sizes."""


_WITHOUT = ("none", "none better", "no size fits")
"""Results of the size search that give no design to compare."""


_WAYS: dict[How, str] = {
    "multistart": "many starts: ",
    "few starts": "a few starts: ",
    "quick": "quick look: ",
    "evaluated": "",
}


def _sentence(choices: Choices) -> str:
    """Sentence that counts the combinations: all, feasible ones, and those searched in each way."""
    total, feasible = len(choices.combinations), choices.feasible
    result = (
        f"none of {total} combinations meets all requirements; the combination that misses them "
        "least is shown"
    )
    if feasible:
        result = (
            f"the best of {total} combinations is shown; {feasible} of them meet all requirements"
        )
    counts = ", ".join(_counts(choices))
    proof = (
        "; a quick look is one short search and may miss a better design"
        if choices.count("quick")
        else ""
    )
    return f"{result}; {counts}{proof}"


def _counts(choices: Choices) -> Iterator[str]:
    texts: dict[How, str] = {
        "evaluated": "evaluated",
        "multistart": "solved from many starts",
        "few starts": "solved from a few starts",
        "quick": "quick look only",
        "not possible": "not possible",
        "not tried": "not tried within the time limit",
    }
    for kind, text in texts.items():
        if count := choices.count(kind):
            yield f"{count} {text}"


_NOTHING_BETTER = SizeSearch(None, None, None, {}, 0, complete=True)
"""Search result for a combination that cannot improve on the best design."""


@dataclass(frozen=True)
class Sized:
    """A combination with the sizes chosen for it, and the result of the size search."""

    look: Look
    sizes: ListedSizes
    size_search: SizeSearch
    memory: Memory


def best_of_sizes(
    choices: ChoiceSearch, requested: Wanted, settings: ChoiceSettings
) -> Sized | None:
    """Find the combination with the best design of listed sizes; it is solved from many starts.

    If no size fits, the result is the combination with the best continuous optimum. The result is
    None if no variable has listed sizes.

    Raises
    ------
    InputError
        the requested sizes fit no combination
    """
    searched = list(_searched(choices, requested, settings))
    improved = [sized for sized in searched if sized.size_search.objective is not None]
    winner = next(iter([*reversed(improved), *searched]), None)
    if winner is None:
        return None
    if improved:
        _runners_up(winner, searched)
    if winner.look.how != "multistart":
        solve_again(winner.look, settings)
    return winner


def _searched(
    choices: ChoiceSearch, requested: Wanted, settings: ChoiceSettings
) -> Iterator[Sized]:
    """Search the sizes of each combination that may give a better design."""
    error: InputError | None = None
    memories: dict[object, Memory] = {}
    evidence_by_sizes: dict[object, list[Evidence]] = {}
    mendable = choices.mendable()
    best, count = (math.inf, math.inf), 0
    for look in choices.ranked():
        if not look.feasible or look.actuator is None or look.x is None:
            continue
        checks = len(look.checks & mendable)
        late = settings.until is not None and time.perf_counter() > settings.until
        if (count and late) or (checks, look.objective) >= best:
            break
        try:
            subject = look.actuator.subject
            sizes = sizes_of(subject.design, requested, subject.materials)
        except InputError as fault:
            error, look.sizing = error or fault, "no size fits"
            continue
        if sizes is None:
            continue
        key = tuple((group.index, group.rows.tobytes()) for group in sizes.listed)
        memory = memories.setdefault(key, Memory())
        problem = look.actuator.problem
        if any(
            group.holds_for(problem, look.objective) for group in evidence_by_sizes.get(key, ())
        ):
            look.sizing = "none" if best[1] == math.inf else "none better"
            yield Sized(look, sizes, _NOTHING_BETTER, memory)
            continue
        size_search = search(
            problem, sizes.listed, look.x, deadline=settings.until, cutoff=best[1], memory=memory
        )
        if size_search.complete:
            evidence_by_sizes.setdefault(key, []).append(
                Evidence(problem, look.objective, size_search.ends)
            )
        look.rounded, count = size_search.objective, count + 1
        if size_search.objective is not None:
            look.sizing, best = "found", (checks, size_search.objective)
        else:
            look.sizing = "none" if best[1] == math.inf else "none better"
        yield Sized(look, sizes, size_search, memory)
    if not count and error is not None:
        raise error


def _runners_up(winner: Sized, searched: Sequence[Sized]) -> None:
    """Compute the objective of the next best combinations with the sizes of the best."""
    assert winner.size_search.assignment is not None
    candidates = [sized for sized in searched if sized.look.sizing == "none better"]
    for sized in candidates[:RUNNERS_UP]:
        look = sized.look
        if sized.memory is not winner.memory or look.actuator is None or look.x is None:
            continue
        problem, listed = look.actuator.problem, sized.sizes.listed
        objective = at(problem, listed, winner.size_search.assignment, look.x, sized.memory)
        if objective is not None:
            look.rounded, look.sizing = objective, "sizes of the best"
