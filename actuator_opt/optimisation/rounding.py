"""Rounds the continuous optimum to sizes that can be made; reports the cost and remedies.

A variable is rounded to the sizes that the design file states for it (a list, a step, a standard
series). On request, variables are also rounded to whole plies, allowed angles or all standard
sizes; see `design.sizes`. All other variables remain continuous and are optimised again. The search
proves nothing; see `branch_and_bound`.

Remedies are small changes of a limit, a load or the supply pressure that make better sizes
possible. If rounding costs much, the variable that rounding changed most is moved to the
neighbouring size on the other side of its continuous value, a size that some limit forbids. If no
design with listed sizes is feasible, the least infeasible sizes are used instead. With these
sizes fixed, the smallest sufficient relaxation of each limit is computed. An optimisation with the
relaxed limit then confirms the remedy.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError
from ..base.numeric import Array
from ..base.progress import tell
from ..base.quantities import INPUTS
from ..design import Design, quantity_of, with_values
from ..design.material import Material
from ..design.model import Ply
from ..design.sizes import STEP_LABEL, groups
from ..design.standard_sizes import WHOLE, along
from ..evaluation import Evaluation, evaluate, prepare
from . import repairs
from .actuator import ActuatorProblem, Fault
from .branch_and_bound import SAME, Assignment, Listed, SizeSearch, search
from .cures import least_changes, with_variables
from .evaluator import Evaluator
from .infeasibility import change_text, entry_of
from .problem import BoxProblem, PointValues, Vector
from .repairs import RelaxedConstraint
from .result import Optimisation, RoundedVariable, Rounding, RunnerUp, SizeRemedy
from .solution import Solution
from .solver import solve

COSTLY = 10.0
"""If rounding costs more than this (% of the objective), remedies are searched for (our choice)."""


SMALL = 0.25
"""Largest relative change of a number in a remedy: our choice."""


MOST_LIMITS = 6
"""Maximum number of limits tried, the tightest first: our choice, to limit the time."""


MOST_SIZES = 3
"""Maximum number of combinations of sizes tried: our choice, to limit the time."""


PRESSURE = "supply.pressure"


def size_remedies(
    actuator: ActuatorProblem,
    solution: Solution,
    listed: Sequence[Listed],
    size_search: SizeSearch,
    deadline: float | None = None,
) -> tuple[tuple[SizeRemedy, ...], str]:
    """Single changes that make better sizes possible, best first; a note if there are none.

    Parameters
    ----------
    actuator, solution : the problem and its continuous optimum
    listed, size_search : the sizes, and the result of their search
    deadline : time of `time.perf_counter` at which the search stops
    """
    objective = math.inf if size_search.objective is None else size_search.objective
    cheap = objective - solution.objective <= COSTLY / 100 * abs(solution.objective)
    remedies: list[SizeRemedy] = []
    assignments = [] if cheap else _other_sizes(listed, solution.x, size_search)
    for assignment in assignments:
        if deadline is not None and time.perf_counter() > deadline:
            break
        tell("rounding costs much: searching for changes that allow better sizes")
        fixed = _FixedSizes(actuator, listed, assignment, solution.x, objective)
        remedies += [
            *fixed.relaxed(_limits(actuator, solution, size_search)),
            *fixed.with_other_pressure(),
        ]
    sign = actuator.goal.sign
    note = f"no single change of a limit, a load or the supply pressure by up to {100 * SMALL:g} % "
    note = f"{note}allows better sizes" if assignments and not remedies else ""
    return tuple(sorted(remedies, key=lambda remedy: sign * remedy.objective)), note


def _other_sizes(listed: Sequence[Listed], x: Vector, size_search: SizeSearch) -> list[Assignment]:
    """Infeasible combinations of sizes that move the variable which rounding changed most.

    This variable takes the neighbouring size on the other side of its continuous value. If no
    design with sizes is feasible, only the least infeasible combination is returned.
    """
    if size_search.assignment is None:
        return [] if size_search.nearest is None else [size_search.nearest]
    moves = []
    for k, (group, row) in enumerate(zip(listed, size_search.assignment, strict=True)):
        values = x[list(group.index)]
        scale = np.where(values == 0, 1.0, np.abs(values))
        moves.append((float(np.max(np.abs(group.rows[row] - values) / scale)), k))
    _, k = max(moves)
    other_rows = set(listed[k].around(x[list(listed[k].index)])) - {size_search.assignment[k]}
    infeasible = (a for a, objective in size_search.tried.items() if not math.isfinite(objective))
    return [a for a in infeasible if a[k] in other_rows][:MOST_SIZES]


def _limits(actuator: ActuatorProblem, solution: Solution, size_search: SizeSearch) -> list[int]:
    """Indices of the requirements and loads with the least margins, before or after rounding."""
    margins = solution.constraints
    if size_search.missed is not None:
        margins = np.minimum(margins, size_search.missed.rows[1 : 1 + len(margins)])
    smallest: dict[str, tuple[float, int]] = {}
    for index, (row, margin) in enumerate(zip(actuator.rows, margins.tolist(), strict=True)):
        limit = row.limit_of
        negotiable = limit.origin in ("requirement", "case") and not limit.metric.endswith(
            "_factor"
        )
        if negotiable and limit.path is not None:
            smallest[limit.path] = min((margin, index), smallest.get(limit.path, (math.inf, index)))
    return [index for _, index in sorted(smallest.values())[:MOST_LIMITS]]


@dataclass(frozen=True)
class _FixedSizes:
    """The problem with its sizes fixed: `assignment` chooses a size for each listed variable."""

    actuator: ActuatorProblem
    listed: Sequence[Listed]
    assignment: Assignment
    x: Vector
    objective: float

    @property
    def sizes(self) -> dict[int, float]:
        """The chosen sizes, by index of their variable."""
        pairs = zip(self.listed, self.assignment, strict=True)
        return {
            i: float(v)
            for group, row in pairs
            for i, v in zip(group.index, group.rows[row], strict=True)
        }

    def with_sizes(self, problem: BoxProblem) -> BoxProblem:
        """A copy of a problem in which the sizes are fixed."""
        lower, upper = problem.lower.copy(), problem.upper.copy()
        for place, value in self.sizes.items():
            lower[place] = upper[place] = value
        return replace(problem, lower=lower, upper=upper, start=None)

    def relaxed(self, indices: Sequence[int]) -> Iterator[SizeRemedy]:
        """For each limit, the remedy with the least relaxation that makes the sizes feasible."""
        problem = self.with_sizes(self.actuator.problem)
        assert problem.groups is not None
        numbers = np.asarray(problem.groups)
        groups = [np.flatnonzero(numbers == numbers[index]) for index in indices]
        starts = repairs.without_each(problem, groups, self.x, [SMALL] * len(groups))
        for index, group, start in zip(indices, groups, starts, strict=True):
            amount = None if start is None else repairs.least(problem, group, start)
            if start is None or amount is None or amount <= repairs.NOTHING:
                continue
            name = problem.constraint_names[index]
            entry = entry_of(self.actuator, RelaxedConstraint(name, index, amount))
            if entry["change"] is None or abs(entry["change"]) > SMALL:
                continue
            granted = np.zeros((len(problem.constraint_names), 1))
            granted[group] = amount  # the printed value is rounded, so it grants more

            def evaluate(points: Array, granted: Array = granted) -> PointValues:
                values = problem.evaluate(points)
                return PointValues(values.objective, values.constraints + granted)

            yield from self.remedy(replace(problem, evaluate=evaluate), start, entry)

    def with_other_pressure(self) -> Iterator[SizeRemedy]:
        """The remedy with the least change of the supply pressure that makes the sizes feasible."""
        if PRESSURE in self.actuator.paths:
            return
        design = self.actuator.subject.design
        problem = self.with_sizes(with_variables(self.actuator, [PRESSURE]))
        present = float(problem.lower[-1])
        for sign in (1.0, -1.0):
            limit = {len(self.x): present * (1 + sign * SMALL)}
            start = np.append(self.x, present)
            for cure in least_changes(problem, start, limit, {len(self.x): PRESSURE}, design):
                quantity = quantity_of(PRESSURE, design)
                value = float(cure.needed)
                lower, upper = problem.lower.copy(), problem.upper.copy()
                lower[-1] = upper[-1] = value
                entry = {
                    "parameter": PRESSURE,
                    "limit": present,
                    "needed": value,
                    "change": value / present - 1,
                    "limit_text": quantity.text(present, 6),
                    "needed_text": quantity.text(value, 6),
                }
                fixed = replace(problem, lower=lower, upper=upper)
                yield from self.remedy(fixed, np.append(self.x, value), entry)

    def remedy(
        self, eased: BoxProblem, x: Vector, entry: Mapping[str, Any]
    ) -> Iterator[SizeRemedy]:
        """Yield the remedy if it makes the best design with these sizes better than `objective`."""
        point = repairs.near(eased, x)
        if point is None:
            return
        evaluator = Evaluator(eased)
        end = repairs.go(evaluator, evaluator.point(evaluator.space.to_z(point)))
        if end.violation > repairs.NOTHING or not end.objective < self.objective:
            return
        keys = ("parameter", "limit", "needed", "change", "limit_text", "needed_text")
        yield SizeRemedy(
            change={name: entry[name] for name in keys},
            sentence=change_text(entry),
            objective=self.actuator.goal.shown(end.objective),
            values={self.actuator.paths[place]: value for place, value in self.sizes.items()},
        )


RUNNERS_UP = 3
"""Number of next best designs that the result lists."""

MOST_SAID = 4
"""Maximum number of sizes named in a sentence."""

_OF_PLIES = ("whole plies", "allowed angles")


@dataclass(frozen=True, slots=True)
class Wanted:
    """Kinds of sizes that the user requests in addition to those in the design file."""

    whole_plies: bool = False
    standard: bool = False
    shop: bool = False


@dataclass(frozen=True)
class ListedSizes:
    """The variables with listed values, in groups for the search, and the source of their sizes."""

    listed: tuple[Listed, ...]
    labels: dict[str, str]
    """Where each listed variable's sizes come from, by PATH."""

    @property
    def name(self) -> str:
        """Name of the rounding: "whole plies", "sizes in steps" or "standard sizes"."""
        labels = set(self.labels.values()) - set(_OF_PLIES)
        if not labels:
            return "whole plies"
        steps = all(label.startswith(STEP_LABEL) for label in labels)
        return "sizes in steps" if steps else "standard sizes"


def layers(design: Design) -> Iterator[tuple[str, Ply]]:
    """The layers of barrel and rod with their PATHs."""
    for part, wall in (("barrel", design.barrel.layup), ("rod", design.rod.layup)):
        for i, ply in enumerate(wall):
            yield f"{part}.layup[{i}]", ply


def plies(ply: Ply) -> int | None:
    """Number of plies of a layer; None if not whole, or if no ply thickness is stated."""
    if ply.ply_thickness is None:
        return None
    step = 2 if ply.balanced and not along(ply.angle) else 1
    count = step * round(ply.thickness / ply.ply_thickness / step)
    return count if abs(ply.thickness / ply.ply_thickness - count) <= WHOLE and count else None


def uncounted(design: Design, materials: Mapping[str, Material]) -> tuple[str, ...]:
    """PATHs of fibre layer thicknesses for which plies cannot be counted.

    Their layers state no ply thickness, and the thickness is not a variable with sizes.
    """
    paths = []
    for path, ply in layers(design):
        variable = design.variables.get(f"{path}.thickness")
        has_sizes = variable is not None and (
            variable.sizes is not None or variable.step is not None
        )
        if ply.ply_thickness is None and not has_sizes and not materials[ply.material].isotropic:
            paths.append(f"{path}.thickness")
    return tuple(paths)


def misfits(design: Design) -> tuple[str, ...]:
    """PATHs of thicknesses that are not whole plies, and of angles that are not allowed."""
    paths = []
    allowed = design.barrel.allowed_angles
    for path, ply in layers(design):
        if ply.ply_thickness is not None and plies(ply) is None:
            paths.append(f"{path}.thickness")
        concerned = ply.ply_thickness is not None or f"{path}.angle" in design.variables
        if allowed is None or not concerned:
            continue
        if all(abs(abs(ply.angle) - angle) > WHOLE for angle in allowed):
            paths.append(f"{path}.angle")
    return tuple(paths)


def unrounded(optimisation: Optimisation) -> str:
    """A note if an optimum has no whole plies because none were requested; else empty."""
    design = optimisation.design
    paths = [path for path in misfits(design) if path in design.variables]
    if optimisation.rounding is not None or not paths or not optimisation.evaluation.met:
        return ""
    return (
        f"{', '.join(paths)}: not yet rounded to whole numbers of plies or to allowed angles; see "
        "--whole-plies"
    )


def sizes_of(
    design: Design,
    requested: Wanted,
    materials: Mapping[str, Material],
    fault: Fault | None = None,
) -> ListedSizes | None:
    """The variables that only take listed values; None if there are no such variables.

    Parameters
    ----------
    design : the design with its variables
    requested : sizes in addition to those of the file
    materials : materials of the design, by name
    fault : builds the Diagnostic of a faulty variable; by default, the Diagnostic states the PATH
        but not the line in the file

    Raises
    ------
    InputError
        sizes are requested but no variable has sizes, the bounds of a variable contain no size, or
        whole plies are requested but a layer states no ply thickness
    """
    if requested.whole_plies or requested.standard:
        _require_plies(design, requested, materials)
    size_groups, faults = groups(
        design, plies=requested.whole_plies, standard=requested.standard, shop=requested.shop
    )
    if faults:
        raise InputError(
            [
                (fault(str(conflict.loc[1]), conflict.message, conflict.remedy) if fault else None)
                or Diagnostic(
                    conflict.message, conflict.remedy, path=f"variables.{conflict.loc[1]}"
                )
                for conflict in faults
            ]
        )
    if not size_groups and (requested.whole_plies or requested.standard or requested.shop):
        raise InputError(_nothing_to_round(requested))
    place = {path: index for index, path in enumerate(design.variables)}
    listed = tuple(
        Listed(tuple(place[path] for path in group.paths), np.array(group.rows))
        for group in size_groups
    )
    labels = {
        path: label
        for group in size_groups
        for path, label in zip(group.paths, group.labels, strict=True)
    }
    return ListedSizes(listed, labels) if size_groups else None


def _require_plies(design: Design, requested: Wanted, materials: Mapping[str, Material]) -> None:
    """Check that all fibre layers state a ply thickness, and that fixed layers have whole plies."""
    plies_by_path = dict(layers(design))
    hint = (
        ""
        if requested.whole_plies
        else '; to round only bore and rod, set "sizes: iso_3320" for these variables'
    )
    faults = [
        Diagnostic(
            "the layer states no ply_thickness, so its plies cannot be counted",
            f'add e.g. "ply_thickness: 0.2 mm" to it{hint}',
            path=path,
        )
        for path in uncounted(design, materials)
    ]
    for path in misfits(design):
        ply = plies_by_path.get(path.removesuffix(".thickness"))
        if path not in design.variables and ply is not None and ply.ply_thickness is not None:
            thickness = INPUTS["ply_thickness"].text(ply.ply_thickness)
            pairs = "" if not ply.balanced or along(ply.angle) else "pairs of "
            faults.append(
                Diagnostic(
                    f"fixed, and not a whole number of {pairs}plies of {thickness}",
                    "change it, or make it a variable",
                    path=path,
                )
            )
    if faults:
        raise InputError(faults)


def _nothing_to_round(requested: Wanted) -> Diagnostic:
    if requested.standard:
        message = "nothing to round: no variable has standard sizes"
        remedy = "make cylinder.bore or rod.outer_diameter a variable, or give a variable sizes"
    elif requested.shop and not requested.whole_plies:
        message = "nothing to round: no variable is a length, an angle or a squeeze"
        remedy = "make a dimension a variable, or omit --shop"
    else:
        message = (
            "nothing to round: no variable is the thickness of a layer with ply_thickness, or "
            "an angle of a barrel with allowed_angles"
        )
        remedy = "add ply_thickness to a layer whose thickness is a variable"
    return Diagnostic(message, remedy, path="variables")


def design_at(actuator: ActuatorProblem, x: Vector) -> tuple[Design, Evaluation]:
    """The evaluated design with the variables at a point."""
    subject = actuator.subject
    values = dict(zip(actuator.paths, x.tolist(), strict=True))
    design = with_values(subject.design, values, metrics=subject.quantities, contradictions=False)
    prepared = prepare(design, subject.materials, subject.plugins)
    return design, evaluate(replace(prepared, lenient=True, aims=subject.aims))


def rounded(
    actuator: ActuatorProblem,
    solution: Solution,
    sizes: ListedSizes,
    size_search: SizeSearch | None = None,
    *,
    until: float | None = None,
    seed: int = 0,
) -> tuple[Rounding, Solution]:
    """The best design with listed sizes, and the continuous optimum with which it is compared.

    The continuous optimum is the given solution, or a new solution if the search for sizes finds a
    better design.

    Parameters
    ----------
    actuator, solution : the problem and a feasible point
    sizes : the listed sizes of the design, from `sizes_of`
    size_search : result of the search for sizes, if already made
    until : time of `time.perf_counter` at which the search stops
    seed : seed of the sweeps
    """
    problem = actuator.problem
    if size_search is None:
        size_search = search(problem, sizes.listed, solution.x, deadline=until)
    improves = size_search.objective is not None and _cost(size_search.objective, solution) < 0
    if improves and size_search.x is not None:
        solution_again = solve(problem, starts=1, seed=seed, more_starts=[size_search.x])
        if solution_again.feasible and solution_again.objective < solution.objective:
            starts = (*solution.starts, *solution_again.starts)
            solution = replace(solution_again, samples=solution.samples, starts=starts)
            size_search = search(problem, sizes.listed, solution.x, deadline=until)
    remedies, note = size_remedies(actuator, solution, sizes.listed, size_search, until)
    rounding = _rounding(actuator, solution, sizes, size_search)
    notes = (*rounding.notes, note) if note else rounding.notes
    return replace(rounding, remedies=remedies, notes=notes), solution


def _cost(objective: float, solution: Solution) -> float:
    """Difference of the objective from the continuous optimum; rounding errors count as 0."""
    cost = objective - solution.objective
    return 0.0 if abs(cost) <= 10 * SAME * abs(solution.objective) else cost


def _percent(cost: float, solution: Solution) -> float | None:
    return 100 * cost / abs(solution.objective) if solution.objective else None


def _rounding(
    actuator: ActuatorProblem, solution: Solution, sizes: ListedSizes, size_search: SizeSearch
) -> Rounding:
    shown = actuator.goal.shown
    feasible = sum(math.isfinite(objective) for objective in size_search.tried.values())
    failure = Rounding(
        met=False,
        sentence=f"none of the {len(size_search.tried)} tried designs with {sizes.name} "
        "meets all requirements"
        + ("" if size_search.complete else ", and the search stopped at its time limit")
        + _nearest(actuator, sizes, size_search),
        remedy=f"{_FINER[sizes.name]}, widen the bounds of these variables, or relax a requirement",
        name=sizes.name,
        objective_before=shown(solution.objective),
        tried=len(size_search.tried),
        feasible=feasible,
        solves=size_search.solves,
        complete=size_search.complete,
        notes=_unbuildable(actuator, actuator.subject.design)[1],
    )
    if size_search.x is None or size_search.objective is None:
        return failure
    design, evaluation = design_at(actuator, size_search.x)
    cost = _cost(size_search.objective, solution)
    sentence, remedy = _sentence(sizes.name, evaluation.met, size_search.complete)
    unmade, notes = _unbuildable(actuator, design)
    return replace(
        failure,
        unmade=unmade,
        notes=notes,
        met=evaluation.met,
        sentence=sentence,
        remedy=remedy,
        objective_after=shown(size_search.objective),
        cost=cost,
        percent=_percent(cost, solution),
        variables=_variables(actuator, solution, sizes, size_search.x, design),
        plies={path: count for path, ply in layers(design) if (count := plies(ply)) is not None},
        runners_up=_runners_up(actuator, solution, sizes.listed, size_search),
        design=design,
        evaluation=evaluation,
    )


def _nearest(actuator: ActuatorProblem, sizes: ListedSizes, size_search: SizeSearch) -> str:
    """Clause on the limit that the least infeasible sizes miss most; empty if unknown."""
    if (
        size_search.nearest is None
        or size_search.missed is None
        or size_search.missed.violation <= 0
    ):
        return ""
    margins = size_search.missed.rows[1 : 1 + len(actuator.problem.constraint_names)]
    worst = actuator.problem.constraint_names[int(np.argmin(margins))]
    texts = [
        f"{path} {quantity_of(path, actuator.subject.design).text(value)}"
        for path, value in _values_of(actuator, sizes.listed, size_search.nearest).items()
    ]
    if len(texts) > MOST_SAID:
        texts = [*texts[:MOST_SAID], "…"]
    by = 100 * size_search.missed.violation
    return f"; the nearest design, {', '.join(texts)}, misses {worst} by {by:.2g} %"


def _values_of(
    actuator: ActuatorProblem, listed: Sequence[Listed], assignment: Assignment
) -> dict[str, float]:
    """By PATH, the values that an assignment gives to the listed variables."""
    return {
        actuator.paths[index]: float(value)
        for group, row in zip(listed, assignment, strict=True)
        for index, value in zip(group.index, group.rows[row], strict=True)
    }


_FINER = {
    "whole plies": "use thinner plies or allow more angles",
    "standard sizes": "allow more sizes",
    "sizes in steps": "allow finer steps",
}


def _sentence(name: str, met: bool, complete: bool) -> tuple[str, str]:
    """Sentence on the result of the search, and the remedy."""
    if not met:
        return f"the best design with {name} misses a requirement", f"relax it, or {_FINER[name]}"
    if not complete:
        return (
            f"all requirements are met with {name}; the search stopped at its time limit and "
            "returns the best design so far",
            "raise the time limit, or restrict fewer variables to sizes",
        )
    return (
        f"all requirements are met with {name}; this is the best design that branch and bound "
        "found (not proven, because its bounds are local optima)",
        "",
    )


def _unbuildable(
    actuator: ActuatorProblem, design: Design
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """PATHs of values that are not whole plies or allowed angles, and a sentence on each.

    PATHs of layers without `ply_thickness` are included. If `design` is the design before rounding,
    its variables are left out.
    """
    start = design is actuator.subject.design
    excluded = design.variables if start else {}
    not_whole = [path for path in misfits(design) if path not in excluded]
    uncountable = [
        path for path in uncounted(design, actuator.subject.materials) if path not in excluded
    ]
    notes = [
        (
            f"{path} is not a variable and not "
            if path not in design.variables
            else f"{path} is not "
        )
        + ("an allowed angle" if path.endswith("angle") else "a whole number of plies")
        for path in not_whole
    ]
    notes += [f"{path}: the layer states no ply_thickness, so its plies cannot be counted"
              for path in uncountable]  # fmt: skip
    return (*not_whole, *uncountable), tuple(notes)


def _variables(
    actuator: ActuatorProblem,
    solution: Solution,
    sizes: ListedSizes,
    x: Vector,
    design: Design,
) -> tuple[RoundedVariable, ...]:
    plies_by_path = dict(layers(design))
    rows = []
    for i, path in enumerate(actuator.paths):
        ply = plies_by_path.get(path.removesuffix(".thickness"))
        rows.append(
            RoundedVariable(
                path=path,
                quantity=quantity_of(path, design).name,
                continuous=float(solution.x[i]),
                value=float(x[i]),
                discrete=path in sizes.labels,
                plies=None if ply is None else plies(ply),
                sizes=sizes.labels.get(path),
            )
        )
    return tuple(rows)


def _runners_up(
    actuator: ActuatorProblem, solution: Solution, listed: Sequence[Listed], size_search: SizeSearch
) -> tuple[RunnerUp, ...]:
    """The next best designs with listed sizes."""
    candidates = sorted(
        (objective, assignment)
        for assignment, objective in size_search.tried.items()
        if assignment != size_search.assignment and math.isfinite(objective)
    )
    rows = []
    for objective, assignment in candidates[:RUNNERS_UP]:
        cost = _cost(objective, solution)
        values = _values_of(actuator, listed, assignment)
        shown = actuator.goal.shown(objective)
        rows.append(RunnerUp(shown, cost, _percent(cost, solution), values))
    return tuple(rows)
