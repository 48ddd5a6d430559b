"""Small changes of a limit, load or the supply pressure that allow better sizes.

If rounding costs much, the size that moved most is fixed at its other neighbour, which some limit
forbids. If no sized design is feasible, the least infeasible sizes are fixed. With all sizes fixed,
the least relaxation of one limit at a time is computed, and the best design with it. Each remedy
was confirmed by a design of these sizes.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..base.numeric import Array
from ..base.progress import tell
from ..design import quantity_of
from . import elastic, repairs
from .actuator import ActuatorProblem, Solution
from .branch_and_bound import Found
from .cures import freed, opened
from .evaluator import Evaluator
from .infeasibility_card import change_text, entry_of
from .listed import Assignment, Listed
from .problem import BoxProblem, Values, Vector
from .repairs import Relaxation
from .result import SizeRemedy

COSTLY = 10.0
"""Cost of rounding (%) above which remedies are sought: a choice."""

SMALL = 0.25
"""Largest relative change of a limit that is offered: a choice."""

MOST_LIMITS = 6
"""Maximum limits tried, the tightest first: a choice, to limit the time."""

MOST_SIZES = 3
"""Maximum combinations of sizes tried: a choice, to limit the time."""

PRESSURE = "supply.pressure"


def size_remedies(
    actuator: ActuatorProblem,
    solution: Solution,
    listed: Sequence[Listed],
    found: Found,
    until: float | None = None,
) -> tuple[tuple[SizeRemedy, ...], str]:
    """The changes of one number that allow better sizes, best design first; else a note.

    Parameters
    ----------
    actuator, solution : the problem and its continuous optimum
    listed, found : the sizes, and the result of their search
    until : time of `time.perf_counter` to stop at
    """
    below = math.inf if found.objective is None else found.objective
    cheap = below - solution.objective <= COSTLY / 100 * abs(solution.objective)
    remedies: list[SizeRemedy] = []
    smaller = [] if cheap else _smaller(listed, solution.x, found)
    for assignment in smaller:
        if until is not None and time.perf_counter() > until:
            break
        tell("rounding costs much: searching for a limit that allows a smaller size")
        held = _Held(actuator, listed, assignment, solution.x, below)
        remedies += [*held.relaxed(_limits(actuator, solution, found)), *held.repressured()]
    better = actuator.goal.sign
    note = f"no change of one limit, load or the supply pressure by up to {100 * SMALL:g} % "
    note = f"{note}allows better sizes" if smaller and not remedies else ""
    return tuple(sorted(remedies, key=lambda remedy: better * remedy.objective)), note


def _smaller(listed: Sequence[Listed], x: Vector, found: Found) -> list[Assignment]:
    """Combinations of sizes with the most rounded size at its other neighbour.

    The least infeasible sizes if no sized design is feasible.
    """
    if found.assignment is None:
        return [] if found.nearest is None else [found.nearest]
    moves = []
    for k, (one, row) in enumerate(zip(listed, found.assignment, strict=True)):
        here = x[list(one.index)]
        scale = np.where(here == 0, 1.0, np.abs(here))
        moves.append((float(np.max(np.abs(one.rows[row] - here) / scale)), k))
    _, k = max(moves)
    others = set(listed[k].around(x[list(listed[k].index)])) - {found.assignment[k]}
    missed = (a for a, objective in found.tried.items() if not math.isfinite(objective))
    return [a for a in missed if a[k] in others][:MOST_SIZES]


def _limits(actuator: ActuatorProblem, solution: Solution, found: Found) -> list[int]:
    """Rows of the tightest requirements and loads, at the optimum or the sizes."""
    margins = solution.constraints
    if found.missed is not None:
        margins = np.minimum(margins, found.missed.rows[1 : 1 + len(margins)])
    least: dict[str, tuple[float, int]] = {}
    for index, (row, margin) in enumerate(zip(actuator.rows, margins.tolist(), strict=True)):
        limit = row.limit_of
        own = limit.origin in ("requirement", "case") and not limit.metric.endswith("_factor")
        if own and limit.path is not None:
            least[limit.path] = min((margin, index), least.get(limit.path, (math.inf, index)))
    return [index for _, index in sorted(least.values())[:MOST_LIMITS]]


@dataclass(frozen=True)
class _Held:
    """The problem with every size of an assignment fixed."""

    actuator: ActuatorProblem
    listed: Sequence[Listed]
    assignment: Assignment
    x: Vector
    below: float

    @property
    def sizes(self) -> dict[int, float]:
        """The sizes by index of their variable."""
        pairs = zip(self.listed, self.assignment, strict=True)
        return {
            i: float(v) for one, row in pairs for i, v in zip(one.index, one.rows[row], strict=True)
        }

    def held(self, problem: BoxProblem) -> BoxProblem:
        """A problem with the sizes fixed."""
        lower, upper = problem.lower.copy(), problem.upper.copy()
        for place, value in self.sizes.items():
            lower[place] = upper[place] = value
        return replace(problem, lower=lower, upper=upper, start=None)

    def relaxed(self, indices: Sequence[int]) -> Iterator[SizeRemedy]:
        """The least relaxation of each limit that makes the sizes feasible."""
        problem = self.held(self.actuator.problem)
        assert problem.groups is not None
        numbers = np.asarray(problem.groups)
        groups = [np.flatnonzero(numbers == numbers[index]) for index in indices]
        starts = repairs.without_each(problem, groups, self.x, [SMALL] * len(groups))
        for index, group, start in zip(indices, groups, starts, strict=True):
            amount = None if start is None else repairs.least(problem, group, start)
            if start is None or amount is None or amount <= repairs.NOTHING:
                continue
            name = problem.constraint_names[index]
            entry = entry_of(self.actuator, Relaxation(name, index, amount))
            if entry["change"] is None or abs(entry["change"]) > SMALL:
                continue
            granted = np.zeros((len(problem.constraint_names), 1))
            granted[group] = amount  # the printed value is rounded outwards: more, not less

            def evaluate(points: Array, granted: Array = granted) -> Values:
                values = problem.evaluate(points)
                return Values(values.objective, values.constraints + granted)

            yield from self.remedy(replace(problem, evaluate=evaluate), start, entry)

    def repressured(self) -> Iterator[SizeRemedy]:
        """The least change of the supply pressure that makes the sizes feasible."""
        if PRESSURE in self.actuator.paths:
            return
        design = self.actuator.subject.design
        problem = self.held(opened(self.actuator, [PRESSURE]))
        now = float(problem.lower[-1])
        for sign in (1.0, -1.0):
            limit = {len(self.x): now * (1 + sign * SMALL)}
            start = np.append(self.x, now)
            for cure in freed(problem, start, limit, {len(self.x): PRESSURE}, design):
                quantity = quantity_of(PRESSURE, design)
                value = float(cure.needed)
                lower, upper = problem.lower.copy(), problem.upper.copy()
                lower[-1] = upper[-1] = value
                entry = {
                    "parameter": PRESSURE,
                    "limit": now,
                    "needed": value,
                    "change": value / now - 1,
                    "limit_text": quantity.text(now, 6),
                    "needed_text": quantity.text(value, 6),
                }
                fixed = replace(problem, lower=lower, upper=upper)
                yield from self.remedy(fixed, np.append(self.x, value), entry)

    def remedy(
        self, eased: BoxProblem, near: Vector, entry: Mapping[str, Any]
    ) -> Iterator[SizeRemedy]:
        """The best design of the sizes at the changed number, if better than without."""
        point = repairs.near(eased, near)
        if point is None:
            return
        evaluator = Evaluator(eased)
        end = elastic.go(evaluator, evaluator.point(evaluator.space.to_z(point)))
        if end.violation > repairs.NOTHING or not end.objective < self.below:
            return
        kept = ("parameter", "limit", "needed", "change", "limit_text", "needed_text")
        yield SizeRemedy(
            change={name: entry[name] for name in kept},
            sentence=change_text(entry),
            objective=self.actuator.goal.shown(end.objective),
            values={self.actuator.paths[place]: value for place, value in self.sizes.items()},
        )
