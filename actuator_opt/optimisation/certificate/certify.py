"""Distance of a design from the best possible: a lower bound on the objective, and the gap."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from ...base.symbolic.bounds import bounds_of
from ...base.symbolic.order import needed
from ...evaluation.kernel import ModelRun, compute
from ..actuator import ActuatorProblem
from ..outcome import MET
from ..problem import Vector
from .bounding import Bounding
from .box import Box, Gone, Layout
from .builder import Builder
from .intervals import Empty, narrow, tighten
from .lone import ranges
from .plain import straighten
from .relaxation import ConstraintRow, Relaxation, Unknown
from .search import GUARD, BoxSearch, Found
from .signomial import Form
from .trace import Claim, Traced, trace, variable

Report: TypeAlias = Callable[[float], None] | None

BOXES = 200
"""Boxes to solve: about three seconds, and the same bound on every machine."""

AIM = 0.049
"""Gap at which a search with a wide first gap stops; it only looks for lighter designs."""

WIDE = 0.1
"""First gap above which a search stops there."""

EASY = 20
"""Boxes such a search solves to show that the gap can be closed further."""

SECONDS = 30.0
"""Time limit of the search, for very slow machines."""


@dataclass(frozen=True)
class Relaxed:
    """The relaxation of a traced problem."""

    relaxation: Relaxation
    objective: Form
    variables: dict[str, Form]
    covered: tuple[Claim, ...]
    dropped: dict[str, str]
    unknowns: dict[str, Callable[[ModelRun], float]]
    """Values of the further unknowns in an evaluated design, by name."""

    def atoms(self, actuator: ActuatorProblem, x: Vector) -> Vector:
        """The value of every atom at a design."""
        point = {path: np.array([value]) for path, value in zip(actuator.paths, x, strict=True)}
        with np.errstate(all="ignore"):
            there = compute(actuator.subject, actuator.subject.values(point))
        known = {variable(k): float(value) for k, value in enumerate(x)}
        known |= {name: exact(there) for name, exact in self.unknowns.items()}
        own = {form.powers[0][0]: name for name, form in self.variables.items()}
        found: list[float] = []
        for i, maker in enumerate(self.relaxation.makers):
            found.append(_log(known[own[i]]) if i in own else maker(found))
        return np.array(found)


def relax(traced: Traced, best: float) -> Relaxed:
    """The relaxation of all designs that meet the limits and are no worse than `best`.

    Raises
    ------
    Empty, Gone
        no such design exists
    """
    for claim in traced.claims:
        narrow(claim.value, _ends(claim))
    for objective in traced.objectives:
        narrow(objective, (-math.inf, best + MET * abs(best)))
    values = [claim.value for claim in traced.claims] + traced.objectives
    values += [value for fact in traced.facts for value in fact]
    nodes = needed(values)
    for node, ends in ranges(nodes).items():
        narrow(node, ends)
    tighten(nodes, traced.facts)
    builder = Builder()
    covered, dropped = [], dict(traced.dropped)
    for claim in traced.claims:
        least, most = _ends(claim)
        try:
            if math.isfinite(least):
                builder.at_least(claim.value, least)
            else:
                builder.at_least(-claim.value, -most)
        except Unknown as reason:
            dropped[claim.label] = str(reason)
            continue
        covered.append(claim)
    for more, less in traced.facts:
        with suppress(Unknown):
            builder.at_least(more, less)
    objective = _largest(builder, traced.objectives)
    box = Box.whole(Layout(builder.found)).tightened(Layout(builder.found))
    builder.found.lower, builder.found.upper = box.lower.tolist(), box.upper.tolist()
    straighten(builder.found)
    exact = {name: one for name, (_, one) in traced.unknowns.items()}
    return Relaxed(builder.found, objective, builder.variables, tuple(covered), dropped, exact)


def _largest(builder: Builder, values: Sequence[Any]) -> Form:
    """Logarithm of the largest of some values, bounded from below by each of them."""
    forms = list(dict.fromkeys(builder.form(value)[1] for value in values))
    if len(forms) == 1:
        return forms[0]
    low, high = (max(ends) for ends in zip(*map(bounds_of, values), strict=True))
    found = builder.found.atom(low, high, lambda y: max(form.at(y) for form in forms))
    builder.found.rows += [ConstraintRow(form, found) for form in forms]
    return found


def _ends(claim: Claim) -> tuple[float, float]:
    room = MET * abs(claim.bound)
    if claim.limit.sense == "min":
        return claim.bound - room, math.inf
    return -math.inf, claim.bound + room


def certify(
    actuator: ActuatorProblem,
    x: Vector,
    objective: float,
    *,
    seconds: float = SECONDS,
    most: float = BOXES,
    report: Report = None,
) -> tuple[Relaxed, Found]:
    """Lower bound on the objective of every design that meets the limits.

    Parameters
    ----------
    actuator : the problem
    x, objective : the best known design
    seconds, most : time and boxes to spend
    report : called with the logarithm of every better bound

    Raises
    ------
    Unknown
        the design misses a limit, or an essential model has no relaxation
    """
    until = time.perf_counter() + seconds
    try:
        relaxed, search = _search(trace(actuator, x), objective, until, most)
    except (Empty, Gone):
        raise Unknown("the design misses a limit") from None
    if not _meets(search.layout, relaxed.atoms(actuator, x)):
        raise Unknown("the design misses a limit")
    if search.first() < math.log(objective) + math.log1p(-WIDE):
        coarse, bound = _coarse(actuator, x, objective * (1 - AIM), until, most, report)
        if bound.boxes > EASY:
            return coarse or relaxed, bound
    return relaxed, search.run(report)


def _coarse(
    actuator: ActuatorProblem, x: Vector, aim: float, until: float, most: float, report: Report
) -> tuple[Relaxed | None, Found]:
    """Search for designs no heavier than an aim; no relaxation if that is ruled out at once."""
    try:
        relaxed, search = _search(trace(actuator, x), aim, until, most)
    except (Empty, Gone):
        return None, Found(math.log(aim) + math.log1p(-GUARD), 0, True)
    return relaxed, search.run(report)


def _search(traced: Traced, most: float, until: float, boxes: float) -> tuple[Relaxed, BoxSearch]:
    """A search for designs whose objective is at most `most`."""
    relaxed = relax(traced, most)
    layout = Layout(relaxed.relaxation)
    bounding = Bounding(layout, relaxed.objective)
    atoms = [form.powers[0][0] for form in relaxed.variables.values()]
    goal = math.log(most)
    return relaxed, BoxSearch(layout, bounding, goal, variables=atoms, until=until, most=boxes)


def _meets(layout: Layout, y: Vector) -> bool:
    """Whether a design satisfies the ranges and rows of its relaxation."""
    box = Box.whole(layout)
    _, high, _, _ = layout.reach(y, y)
    rows = layout.parts[2]
    inside = (box.lower - MET <= y) & (y <= box.upper + MET)
    return bool(inside.all() and (high[rows] >= -2 * MET).all())


def _log(value: float) -> float:
    """Logarithm; values at or below zero give that of the zero substitute."""
    return math.log(value) if value > 0 else -math.inf
