"""How far a design is from the best possible: a lower bound on the objective, and its gap."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

from ...symbolic.order import needed
from ..actuator import ActuatorProblem
from ..problem import Vector
from .bounding import Bounding
from .box import Box, Layout
from .intervals import narrow, tighten
from .lone import ranges
from .plain import straighten
from .relaxation import Builder, Relaxation, Unknown
from .search import Found, Search
from .signomial import Form
from .trace import Claim, Traced, trace

SECONDS = 3.0
"""Time for the search."""

MET = 1e-6
"""Relative room of a limit that still counts as met (contract)."""


@dataclass(frozen=True)
class Relaxed:
    """The relaxation of a traced problem."""

    relaxation: Relaxation
    objective: Form
    variables: dict[str, Form]
    covered: tuple[Claim, ...]
    dropped: dict[str, str]


def relax(traced: Traced, best: float, near=None) -> Relaxed:
    """The relaxation of all designs that meet the limits and are no worse than `best`."""
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
        if near is not None and claim.limit.name not in near:
            continue
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
    (objective,) = (builder.form(one)[1] for one in set(traced.objectives))
    box = Box.whole(Layout(builder.found)).tightened(Layout(builder.found))
    builder.found.lower, builder.found.upper = box.lower.tolist(), box.upper.tolist()
    straighten(builder.found)
    return Relaxed(builder.found, objective, builder.variables, tuple(covered), dropped)


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
    most: float = math.inf,
    report: Callable[[float], None] | None = None,
) -> tuple[Relaxed, Found]:
    """Lower bound on the objective of every design that meets the limits.

    Parameters
    ----------
    actuator : the problem
    x, objective : the best known design
    seconds, most : time and boxes to spend
    report : called with the logarithm of every better bound
    """
    began = time.perf_counter()
    relaxed = relax(trace(actuator, x), objective)
    layout = Layout(relaxed.relaxation)
    bounding = Bounding(layout, relaxed.objective)
    search = Search(
        layout, bounding, math.log(objective), until=began + seconds, most=most
    )
    return relaxed, search.run(report)
