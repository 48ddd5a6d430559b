"""Finds bounds and fixed dimensions that make an actuator feasible only if several change at once.

A fixed dimension often limits a design only after a bound has been widened, so that neither helps
alone. One search varies all of them, and the sum of their relative changes is as small as possible.
Few of them then change.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..base.numeric import Array
from ..base.progress import tell
from ..design import quantity_of
from . import repairs
from .actuator import ActuatorProblem
from .cures import DIMENSIONS, PARTS, Cure, best_near, rounded_outward, with_variables
from .evaluator import Evaluator
from .problem import BoxProblem, PointValues, Vector

MOST_TOGETHER = 4
"""Maximum number of changes at once that are advised: our choice, as advice must stay short."""


def joint_cures(actuator: ActuatorProblem, x: Vector) -> tuple[Cure, ...]:
    """Bounds and fixed dimensions that make the design feasible together; empty if none were found.

    The sizes are those of `cures.DIMENSIONS`, except for friction coefficients. Each may grow or
    shrink by the factor `repairs.WIDEST` within its valid range.

    Parameters
    ----------
    actuator : the infeasible problem
    x : a point of it at which few limits are missed
    """
    tell("infeasible: searching for bounds and dimensions that are enough together")
    design, numbers = actuator.subject.design, actuator.subject.numbers
    fixed = [
        path
        for path in actuator.fixed_numbers(x)
        if PARTS.match(path) and _is_size(actuator, path) and numbers[path] > 0
    ]
    problem = with_variables(actuator, fixed)
    places = [
        place
        for place, path in enumerate(problem.names)
        if _is_size(actuator, path) and problem.lower[place] > 0
    ]
    end = _least_in_total(actuator, problem, places, np.append(x, problem.lower[len(x) :]))
    if end is None:
        return ()
    changes: list[Cure] = []
    lower, upper = problem.lower.copy(), problem.upper.copy()
    for place in places:
        path, value = problem.names[place], end[place]
        for bounds, side, beyond in (
            (lower, "lower", _beyond(lower[place], value)),
            (upper, "upper", _beyond(value, upper[place])),
        ):
            if not beyond:
                continue
            now = float(bounds[place])
            needed = rounded_outward(quantity_of(path, design), value, upwards=side == "upper")
            if path in fixed:
                lower[place] = upper[place] = needed
                changes.append(Cure(path, now, needed))
                break
            bounds[place] = needed
            changes.append(Cure(f"variables.{path}.{side}", now, needed))
    if not 1 < len(changes) <= MOST_TOGETHER:
        return ()
    best = best_near(replace(problem, lower=lower, upper=upper), end)
    return () if best is None else tuple(replace(cure, objective=best) for cure in changes)


def _beyond(value: float, bound: float) -> bool:
    """Whether the first of two sizes is larger than the second."""
    return bool(np.log(value / bound) > repairs.NOTHING)


def _is_size(actuator: ActuatorProblem, path: str) -> bool:
    """Whether a number is a size that this search may change."""
    name = quantity_of(path, actuator.subject.design).name
    return name in DIMENSIONS and name != "friction_coefficient"


def _least_in_total(
    actuator: ActuatorProblem, problem: BoxProblem, places: list[int], start: Vector
) -> Vector | None:
    """A feasible point for which some sizes leave their bounds, by the least sum of logarithms.

    A further variable for each size is an upper limit of the logarithm by which it leaves its
    bounds; the search minimises the sum of these variables.
    """
    count, m = len(problem.names), len(problem.constraint_names)
    lowest, highest = problem.lower[places, None], problem.upper[places, None]
    lower, upper = problem.lower.copy(), problem.upper.copy()
    for place in places:
        quantity = quantity_of(problem.names[place], actuator.subject.design)
        least, most = quantity.lower, quantity.upper
        lower[place] = max(lower[place] / repairs.WIDEST, least)
        upper[place] = min(upper[place] * repairs.WIDEST, most)

    def evaluate(points: Array) -> PointValues:
        rows, changes, sizes = problem.rows(points[:count]), points[count:], points[places]
        room = (changes - np.log(sizes / highest), changes - np.log(lowest / sizes))
        margins = np.concatenate([rows[1 : 1 + m], *room])
        return PointValues(changes.sum(axis=0), margins, rows[1 + m :])

    labels = [f"change of {problem.names[place]}" for place in places]
    free = replace(
        problem,
        names=(*problem.names, *labels),
        lower=np.append(lower, np.zeros(len(places))),
        upper=np.append(upper, np.full(len(places), np.log(repairs.WIDEST))),
        evaluate=evaluate,
        constraint_names=(
            *problem.constraint_names,
            *(f"{label}, {side}" for side in ("upper", "lower") for label in labels),
        ),
        start=None, relaxable=None, groups=None,
    )  # fmt: skip
    feasible = repairs.near(free, np.append(start, np.zeros(len(places))))
    if feasible is None:
        return None
    evaluator = Evaluator(free)
    end = repairs.go(evaluator, evaluator.point(evaluator.space.to_z(feasible)))
    return end.x[:count] if end.violation <= repairs.NOTHING else None
