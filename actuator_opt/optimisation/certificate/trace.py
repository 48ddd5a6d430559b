"""The problem as expressions of its variables, from the models that evaluate a design.

One load case is traced at a time. A model without a closed expression becomes an unknown with an
envelope around its exact value, so that limits on either side stay valid. Limits that cannot be
traced are dropped and listed by name.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ...base.symbolic import Graph, Symbol
from ...evaluation.kernel import ModelRun, Statics, compute, statics
from ...evaluation.limits import Limit
from ...evaluation.rows import MetricArrays
from ...evaluation.values import Values
from ..actuator import ActuatorProblem
from ..problem import Vector
from .envelopes import Envelopes, decays, layered, refuse
from .relaxation import Unknown

SOFTER = 1e-5
"""Relative tolerance of the stiffness: the closed-form softest position is exact to some 1e-7."""


@dataclass(frozen=True, slots=True)
class Claim:
    """A limit on a traced value: value >= limit or value <= limit."""

    limit: Limit
    label: str
    value: Symbol
    bound: float


@dataclass
class Traced:
    """Objective and limits of a design as expressions of its variables.

    `dropped` gives the reason for each limit that is not traced, by name.
    """

    graph: Graph
    variables: dict[str, Symbol]
    """Variables of the design, by PATH."""
    unknowns: dict[str, tuple[Symbol, Callable[[ModelRun], float]]] = field(default_factory=dict)
    """Further unknowns of envelopes by name, with their values in an evaluated design."""
    objectives: list[Any] = field(default_factory=list)
    """The objective is at least each of these values."""
    claims: list[Claim] = field(default_factory=list)
    facts: list[tuple[Any, Any]] = field(default_factory=list)
    """Pairs of values: the first is always at least the second."""
    dropped: dict[str, str] = field(default_factory=dict)

    def unknown(self, name: str, exact: Callable[[ModelRun], float]) -> Symbol:
        """Add a positive unknown; `exact` returns its value in an evaluated design."""
        if name not in self.unknowns:
            self.unknowns[name] = self.graph.variable(name, (0.0, math.inf)), exact
        return self.unknowns[name][0]


def variable(number: int) -> str:
    """Name of a design variable in expressions."""
    return f"x{number}"


def trace(actuator: ActuatorProblem, x: Vector) -> Traced:
    """Trace objective and limits of an actuator as expressions.

    Parameters
    ----------
    actuator : the problem
    x : the design at which envelopes are tight

    Raises
    ------
    Unknown
        an essential model cannot be traced
    """
    subject, problem = actuator.subject, actuator.problem
    refuse(subject.design)
    graph = Graph()
    found = Traced(
        graph,
        {
            path: graph.variable(variable(k), (float(low), float(high)))
            for k, (path, low, high) in enumerate(
                zip(actuator.paths, problem.lower, problem.upper, strict=True)
            )
        },
    )
    point = {path: np.array([value]) for path, value in zip(actuator.paths, x, strict=True)}
    there = compute(subject, subject.values(point))
    falls = decays(subject, subject.values(point), there, actuator.paths)
    positions = _positions(there)
    limits = dict.fromkeys(row.limit_of for row in actuator.rows)
    for i, case in enumerate(subject.design.load_cases):
        design = subject.design.model_copy(update={"load_cases": [case]})
        one = replace(subject, design=design)
        values = Values(subject.numbers, one.cases, found.variables)
        envelopes = Envelopes(found, subject, there, falls, i)
        out = MetricArrays()
        try:
            with np.errstate(all="ignore"):
                done = statics(one, values, out, envelopes.implicit())
        except (TypeError, AttributeError):  # symbols raise this for operations they do not support
            raise Unknown("one of its models is not a closed expression of the variables") from None
        found.facts += [(part, 0.0) for part in done.mass_parts.values()]
        found.facts += _along_the_stroke(envelopes, done, out, positions)
        envelopes.joint(done, out)
        if envelopes.bearable is not None:
            proof = values["supply.proof_ratio"] * values["supply.pressure"]
            least = found.unknown("proof_factor", _least_proof)
            found.facts.append((envelopes.bearable / proof, least))
            out.put("proof_factor", least)
        _collect(actuator, found, list(limits), out, values, first=i == 0)
    return found


def _least_proof(done: ModelRun) -> float:
    """The least proof factor of all places."""
    return min(float(np.min(value)) for value in done.computed.metrics["proof_factor"].values())


def _along_the_stroke(
    envelopes: Envelopes, done: Statics, out: MetricArrays, positions: tuple[float, ...]
) -> Iterator[tuple[Any, Any]]:
    """Bound the stiffness from above by its values at some positions.

    Walls only add to the compliance of the oil, a matrix of the two chambers. Its determinant and
    diagonal are therefore at least those of the oil.
    """
    springs, stroke = done.springs, done.base.geometry.stroke
    if springs.topology != "per_chamber" or springs.seals is not None:
        return
    series = springs.series_compliance()
    least = envelopes.unknown("stiffness", lambda one: one.computed.metrics["stiffness_min"][""])
    for share in positions:
        x = share * stroke
        if layered(envelopes.subject):
            chambers = envelopes.stiffness(springs, share)
        else:
            chambers = springs.hydraulic(x)
            a, b, ab = springs.total().at(x, stroke)
            oil_a, oil_b, _ = springs.total(springs.oil).at(x, stroke)
            yield a, oil_a
            yield b, oil_b
            yield a * b - ab * ab, oil_a * oil_b
        yield (1 + SOFTER) / (1 / chambers + series), least
    out.put("stiffness_min", least)
    out.put("stiffness_rod", springs.chain["rod"])


def _collect(
    actuator: ActuatorProblem,
    found: Traced,
    limits: list[Limit],
    out: MetricArrays,
    values: Values,
    *,
    first: bool,
) -> None:
    """Collect claims and objectives of one load case."""
    goal = actuator.goal
    case = values.cases[0]
    if goal.single is not None:
        for value in _applying(out, goal.single, ""):
            found.objectives.append(goal.sign * value[1])
    for limit in limits:
        if limit.case is not None and limit.case != case:
            continue
        rows = list(_applying(out, limit.metric, case))
        limited = limit.value(values)
        varies = isinstance(limited, Symbol)
        if varies and not limited.bounds[0] > 0:
            found.dropped[limit.name] = "its limit varies and may be zero"
            continue
        bound = 1.0 if varies else float(np.squeeze(limited))
        for place, value in rows:
            if limit.places is not None and place not in limit.places:
                continue
            if isinstance(value, Symbol) or varies:
                where = ", ".join(x for x in (case, place) if x)
                claimed = value / limited if varies else value
                found.claims.append(Claim(limit, f"{limit.name} ({where})", claimed, bound))
            else:
                found.dropped.setdefault(limit.name, "no variable affects its traced value")
        if not rows and (first or limit.case is not None):
            found.dropped[limit.name] = "its model is not a closed expression"


def _applying(out: MetricArrays, metric: str, case: str) -> Iterator[tuple[str, Any]]:
    """Traced values of a metric where it applies."""
    for place, value in out.metrics.get(metric, {}).items():
        applies = out.applies_at.get((metric, place), out.applies.get(metric))
        if applies is None or bool(np.ravel(applies)[0]):
            yield place, value.item() if isinstance(value, np.ndarray) else value


def _positions(there: ModelRun) -> tuple[float, ...]:
    """Positions of least stiffness over the load cases, as shares of the stroke."""
    shares = np.ravel(there.weakest / there.geometry.stroke)
    return tuple(sorted({round(float(share), 6) for share in shares if np.isfinite(share)}))
