"""From the continuous optimum to whole plies and allowed angles, and what that costs.

A layer that states ``ply_thickness`` is whole where its thickness is a whole number of plies, of
pairs of plies where it is balanced at an angle other than 0 and 90 degrees. An angle that is a
variable takes those of ``barrel.allowed_angles``, where they are given. Everything else stays
continuous and is optimised again. The search is no proof: see `branch_and_bound`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from decimal import Decimal

import numpy as np

from ..design import Design, quantity_of, with_values
from ..design.model import Ply
from ..errors import Diagnostic, InputError
from ..evaluation import Evaluation, evaluate, prepare
from .actuator import ActuatorProblem, Fault
from .branch_and_bound import SAME, Found, Listed, search
from .outcome import Solution
from .problem import Vector
from .result import Optimisation, RoundedVariable, Rounding, RunnerUp
from .solver import solve

RUNNERS_UP = 3
"""Next best designs reported."""

WHOLE = 1e-6
"""Part of a ply, and angle (rad), that counts as none."""

_LAYER = re.compile(r"((?:barrel|rod)\.layup\[\d+\])\.(thickness|angle)")


def layers(design: Design) -> Iterator[tuple[str, Ply]]:
    """Every layer of barrel and rod with its PATH."""
    for part, wall in (("barrel", design.barrel.layup), ("rod", design.rod.layup)):
        for i, ply in enumerate(wall):
            yield f"{part}.layup[{i}]", ply


def plies(ply: Ply) -> int | None:
    """Number of plies of a layer; None where it is not whole, or states no ply thickness."""
    if ply.ply_thickness is None:
        return None
    step = 2 if ply.balanced and not _along(ply.angle) else 1
    count = step * round(ply.thickness / ply.ply_thickness / step)
    return count if abs(ply.thickness / ply.ply_thickness - count) <= WHOLE and count else None


def misfits(design: Design) -> tuple[str, ...]:
    """PATHs of the numbers of a lay-up that are no whole plies, or no allowed angle."""
    found = []
    allowed = design.barrel.allowed_angles
    for path, ply in layers(design):
        if ply.ply_thickness is not None and plies(ply) is None:
            found.append(f"{path}.thickness")
        concerned = ply.ply_thickness is not None or f"{path}.angle" in design.variables
        if allowed is None or not concerned:
            continue
        if all(abs(abs(ply.angle) - angle) > WHOLE for angle in allowed):
            found.append(f"{path}.angle")
    return tuple(found)


def unrounded(optimisation: Optimisation) -> str:
    """A remark that an optimum is not whole plies, where nobody asked for them; else nothing."""
    design = optimisation.design
    left = [path for path in misfits(design) if path in design.variables]
    if optimisation.rounding is not None or not left or not optimisation.evaluation.met:
        return ""
    return f"{', '.join(left)}: not whole plies or allowed angles yet; see --whole-plies"


def listed_variables(design: Design, fault: Fault | None = None) -> tuple[Listed, ...]:
    """The variables that only take listed values, angles first.

    Parameters
    ----------
    design : the design with its variables
    fault : places a variable's fault in its file; default: by PATH only

    Raises
    ------
    InputError
        no such variable, or one whose bounds hold no whole ply, or no allowed angle
    """
    known = dict(layers(design))
    found: list[Listed] = []
    angles: dict[str, int] = {}
    faults: list[Diagnostic] = []
    numbered = list(enumerate(design.variables))
    for wanted in ("angle", "thickness"):
        for index, path in numbered:
            match = _LAYER.fullmatch(path)
            if match is None or match[2] != wanted:
                continue
            ply = known[match[1]]
            if wanted == "angle" and design.barrel.allowed_angles is not None:
                one = _angles(design, index, path)
                angles[match[1]] = len(found)
            elif wanted == "thickness" and ply.ply_thickness is not None:
                partner = angles.get(match[1])
                angle = None if partner is None else found[partner]
                one = replace(_thicknesses(design, index, path, ply, angle), partner=partner)
            else:
                continue
            found.append(one)
            if len(one.choices) == 0:
                faults.append(_none_fits(design, path, ply, fault))
    if faults:
        raise InputError(faults)
    if not found:
        raise InputError(
            Diagnostic(
                "nothing to round: no variable is a layer that states ply_thickness, or an angle "
                "of a barrel with allowed_angles",
                "add ply_thickness to a layer whose thickness is a variable",
                path="variables",
            )
        )
    return tuple(found)


def _along(angle: float) -> bool:
    """Whether an angle is 0 or 90 degrees, where a pair is two equal plies."""
    return abs(math.sin(2 * angle)) <= WHOLE


def _angles(design: Design, index: int, path: str) -> Listed:
    """Allowed angles of both signs within the bounds."""
    lower, upper = design.variables[path].lower, design.variables[path].upper
    both = [sign * angle + 0.0 for angle in design.barrel.allowed_angles or () for sign in (1, -1)]
    room = 1e-9 * max(abs(lower), abs(upper))
    kept = {min(max(v, lower), upper) for v in both if lower - room <= v <= upper + room}
    return Listed(index, np.array(sorted(kept), dtype=float))


def _thicknesses(design: Design, index: int, path: str, ply: Ply, angle: Listed | None) -> Listed:
    """Whole plies; of a balanced layer in pairs, unless its angle is, or can be, 0 or 90 deg."""
    assert ply.ply_thickness is not None
    bounds, one = design.variables[path], ply.ply_thickness
    first = max(1, math.ceil(bounds.lower / one - 1e-9))
    counts = range(first, math.floor(bounds.upper / one + 1e-9) + 1)
    along = frozenset[int]()
    if angle is not None:
        along = frozenset(k for k, value in enumerate(angle.choices) if _along(float(value)))
    varied = path.removesuffix("thickness") + "angle" in design.variables
    singly = not ply.balanced or (not varied and _along(ply.angle))
    singly = singly or (angle is not None and len(along) == len(angle.choices))
    if not singly and not along:
        counts = range(first + first % 2, counts.stop, 2)
    # in decimals, so that 26 plies of 0.125 mm are 3.25 mm to the last digit
    values = np.array([float(count * Decimal(repr(one))) for count in counts], dtype=float)
    values = np.clip(values, bounds.lower, bounds.upper)
    if singly or not along:
        return Listed(index, values)
    restricted = [count % 2 == 1 for count in counts]
    return Listed(index, values, restricted=restricted, freeing=along)


def _none_fits(design: Design, path: str, ply: Ply, fault: Fault | None) -> Diagnostic:
    """The fault of a variable whose bounds hold no value it may take."""
    bounds, quantity = design.variables[path], quantity_of(path, design)
    between = f"between {quantity.text(bounds.lower)} and {quantity.text(bounds.upper)}"
    if path.endswith("angle"):
        message, remedy = f"no allowed angle lies {between}", "allow another angle"
    else:
        each = quantity.text(ply.ply_thickness or 0.0)
        pairs = "" if not ply.balanced or _along(ply.angle) else "pairs of "
        message = f"no whole number of {pairs}plies of {each} lies {between}"
        remedy = "state a thinner ply_thickness"
    remedy = f"widen the bounds, or {remedy}"
    place = fault(path, message, remedy) if fault else None
    return place or Diagnostic(message, remedy, path=f"variables.{path}")


def design_at(actuator: ActuatorProblem, x: Vector) -> tuple[Design, Evaluation]:
    """The design at a point of its variables, evaluated."""
    subject = actuator.subject
    values = dict(zip(actuator.paths, x.tolist(), strict=True))
    design = with_values(subject.design, values, metrics=subject.quantities, contradictions=False)
    found = prepare(design, subject.materials, subject.plugins)
    return design, evaluate(replace(found, lenient=True))


def rounded(
    actuator: ActuatorProblem,
    solution: Solution,
    listed: Sequence[Listed],
    *,
    until: float | None = None,
    seed: int = 0,
) -> tuple[Rounding, Solution]:
    """The best design of whole plies and allowed angles, and the continuous optimum.

    That is the one given, unless the search for whole plies runs into a better one.

    Parameters
    ----------
    actuator, solution : the problem and a point that meets every requirement
    listed : `listed_variables` of the design
    until : time of `time.perf_counter` to stop at
    seed : of the sweeps
    """
    problem = actuator.problem
    found = search(problem, listed, solution.x, until=until)
    better = found.objective is not None and _cost(found.objective, solution) < 0
    if better and found.x is not None:
        again = solve(problem, starts=1, seed=seed, more_starts=[found.x])
        if again.feasible and again.objective < solution.objective:
            starts = (*solution.starts, *again.starts)
            solution = replace(again, samples=solution.samples, starts=starts)
            found = search(problem, listed, solution.x, until=until)
    return _rounding(actuator, solution, listed, found), solution


def _cost(objective: float, solution: Solution) -> float:
    """How much worse than the continuous optimum an objective is; rounding counts as nothing."""
    cost = objective - solution.objective
    return 0.0 if abs(cost) <= 10 * SAME * abs(solution.objective) else cost


def _percent(cost: float, solution: Solution) -> float | None:
    return 100 * cost / abs(solution.objective) if solution.objective else None


def _rounding(
    actuator: ActuatorProblem, solution: Solution, listed: Sequence[Listed], found: Found
) -> Rounding:
    shown = actuator.goal.shown
    feasible = sum(math.isfinite(objective) for objective in found.tried.values())
    before = Rounding(
        met=False,
        sentence=f"no design of whole plies and allowed angles that meets every requirement was "
        f"found among {len(found.tried)} tried"
        + ("" if found.complete else ", when the search stopped at its limit"),
        remedy="use thinner plies or allow more angles, widen the bounds of these layers, or "
        "relax a requirement",
        objective_before=shown(solution.objective),
        tried=len(found.tried),
        feasible=feasible,
        solves=found.solves,
        complete=found.complete,
        notes=_fixed_misfits(actuator.subject.design),
    )
    if found.x is None or found.objective is None:
        return before
    design, evaluation = design_at(actuator, found.x)
    cost = _cost(found.objective, solution)
    sentence, remedy = _sentence(evaluation.met, found.complete)
    return replace(
        before,
        met=evaluation.met,
        sentence=sentence,
        remedy=remedy,
        objective_after=shown(found.objective),
        cost=cost,
        percent=_percent(cost, solution),
        variables=_variables(actuator, solution, listed, found.x, design),
        plies={path: count for path, ply in layers(design) if (count := plies(ply)) is not None},
        runners_up=_runners_up(actuator, solution, listed, found),
        design=design,
        evaluation=evaluation,
    )


def _sentence(met: bool, complete: bool) -> tuple[str, str]:
    """What the search came to and what to do about it."""
    if not met:
        return "the design of whole plies misses a requirement", "relax it, or use thinner plies"
    if not complete:
        return (
            "every requirement is met with whole plies; the search stopped at its limit, and the "
            "best design so far is kept",
            "raise the time limit, or make fewer layers variables",
        )
    return (
        "every requirement is met with whole plies; the best found by branch and bound, which is "
        "no proof, as its bounds are local optima",
        "",
    )


def _fixed_misfits(design: Design) -> tuple[str, ...]:
    """What no variable can round."""
    notes = []
    for path in misfits(design):
        if path not in design.variables:
            what = "an allowed angle" if path.endswith("angle") else "a whole number of plies"
            notes.append(f"{path} is no variable and is not {what}")
    return tuple(notes)


def _variables(
    actuator: ActuatorProblem,
    solution: Solution,
    listed: Sequence[Listed],
    x: Vector,
    design: Design,
) -> tuple[RoundedVariable, ...]:
    chosen = {one.index for one in listed}
    known = dict(layers(design))
    rows = []
    for i, path in enumerate(actuator.paths):
        ply = known.get(path.removesuffix(".thickness"))
        rows.append(
            RoundedVariable(
                path=path,
                quantity=quantity_of(path, design).name,
                continuous=float(solution.x[i]),
                value=float(x[i]),
                discrete=i in chosen,
                plies=None if ply is None else plies(ply),
            )
        )
    return tuple(rows)


def _runners_up(
    actuator: ActuatorProblem, solution: Solution, listed: Sequence[Listed], found: Found
) -> tuple[RunnerUp, ...]:
    """The next best of the designs tried."""
    others = sorted(
        (objective, assignment)
        for assignment, objective in found.tried.items()
        if assignment != found.assignment and math.isfinite(objective)
    )
    rows = []
    for objective, assignment in others[:RUNNERS_UP]:
        cost = _cost(objective, solution)
        values = {
            actuator.paths[one.index]: float(one.choices[choice])
            for one, choice in zip(listed, assignment, strict=True)
        }
        shown = actuator.goal.shown(objective)
        rows.append(RunnerUp(shown, cost, _percent(cost, solution), values))
    return tuple(rows)
