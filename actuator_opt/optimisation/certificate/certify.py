"""Distance of a design from the best possible: a lower bound on the objective, and the gap.

The problem as expressions of its variables, from the models that evaluate a design.

One load case is traced at a time. A model without a closed expression becomes an unknown with an
envelope around its exact value, so that limits on either side stay valid. Limits that cannot be
traced are dropped and listed by name.
"""

from __future__ import annotations

import heapq
import itertools
import math
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias

import numpy as np

from ...base.symbolic import Graph, Symbol
from ...base.symbolic.expression import bounds_of, needed
from ...evaluation.kernel import ModelRun, Statics, compute, statics
from ...evaluation.limits import MetricArrays, MetricLimit
from ...evaluation.values import Values
from ..actuator import MET, ActuatorProblem
from ..problem import Vector
from .bounding import Bound, Bounding, Seen, ranges, straighten
from .builder import Builder, Envelopes, decays, layered, refuse
from .intervals import ROOM, Box, Empty, Gone, Layout, narrow, tighten
from .relaxation import ConstraintRow, Form, Relaxation, Unknown

SOFTER = 1e-5
"""Relative tolerance of the stiffness: the closed-form softest position is exact to some 1e-7."""


@dataclass(frozen=True, slots=True)
class TracedLimit:
    """A limit on a traced value: value >= limit or value <= limit."""

    limit: MetricLimit
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
    claims: list[TracedLimit] = field(default_factory=list)
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
    traced = Traced(
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
        values = Values(subject.numbers, one.cases, traced.variables)
        envelopes = Envelopes(traced, subject, there, falls, i)
        out = MetricArrays()
        try:
            with np.errstate(all="ignore"):
                done = statics(one, values, out, envelopes.implicit())
        except (TypeError, AttributeError):  # symbols raise this for operations they do not support
            raise Unknown("one of its models is not a closed expression of the variables") from None
        traced.facts += [(part, 0.0) for part in done.mass_parts.values()]
        traced.facts += _along_the_stroke(envelopes, done, out, positions)
        envelopes.joint(done, out)
        if envelopes.bearable is not None:
            proof = values["supply.proof_ratio"] * values["supply.pressure"]
            least = traced.unknown("proof_factor", _least_proof)
            traced.facts.append((envelopes.bearable / proof, least))
            out.put("proof_factor", least)
        _collect(actuator, traced, list(limits), out, values, first=i == 0)
    return traced


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
    traced: Traced,
    limits: list[MetricLimit],
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
            traced.objectives.append(goal.sign * value[1])
    for limit in limits:
        if limit.case is not None and limit.case != case:
            continue
        rows = list(_applying(out, limit.metric, case))
        limited = limit.value(values)
        varies = isinstance(limited, Symbol)
        if varies and not limited.bounds[0] > 0:
            traced.dropped[limit.name] = "its limit varies and may be zero"
            continue
        bound = 1.0 if varies else float(np.squeeze(limited))
        for place, value in rows:
            if limit.places is not None and place not in limit.places:
                continue
            if isinstance(value, Symbol) or varies:
                where = ", ".join(x for x in (case, place) if x)
                claimed = value / limited if varies else value
                traced.claims.append(TracedLimit(limit, f"{limit.name} ({where})", claimed, bound))
            else:
                traced.dropped.setdefault(limit.name, "no variable affects its traced value")
        if not rows and (first or limit.case is not None):
            traced.dropped[limit.name] = "its model is not a closed expression"


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


GUARD = 1e-6
"""Relative deduction from the bound, far above rounding in the traced values."""
CLOSE = 1e-4
"""Gap at which the search ends."""
MIDDLE = 0.2
"""Least share of a range in the smaller part of a split."""
WORTH = 1e-9
"""Least excess times price that justifies a split."""
FAR_OFF = 0.2
"""Excess above which further splits of a curve gain little; the first split gains most."""
FLOOR = 0.003
"""Least price of a curve when choosing a direction; consecutive loose curves show none."""
SQUEEZES = 2
"""Maximum rounds of cutting the first box."""
WAYS = 16
"""Directions cut per round, beside the variables."""
GAIN = 0.1
"""Share of their ranges that a round must cut to justify another."""


@dataclass(frozen=True, slots=True)
class ProvenBound:
    """Lower bound on the objective's logarithm, boxes solved, and whether the gap is closed."""

    bound: float
    boxes: int
    closed: bool


class BoxSearch:
    """A search that splits the box with the least bound where its relaxation is loosest.

    Parameters
    ----------
    layout, bounding : the relaxation
    best : logarithm of the largest objective a design may have
    variables : atoms whose directions are always cut in the first box
    until : time of `time.perf_counter` to stop at
    most : maximum number of boxes to solve
    """

    def __init__(
        self,
        layout: Layout,
        bounding: Bounding,
        best: float,
        *,
        variables: Sequence[int] = (),
        until: float = math.inf,
        most: float = math.inf,
    ) -> None:
        self.layout, self.bounding, self.best = layout, bounding, best
        self.until, self.most = until, most
        self.goal = best + math.log1p(-CLOSE)
        self.least, self.boxes = math.inf, 0
        """Least bound of the finished boxes; number of boxes solved."""
        ways = layout.plain[layout.curves :]
        self.variables = np.flatnonzero(np.isin(ways, variables))
        self._order = itertools.count()
        self._open: list[tuple[float, int, Box, Bound]] = []

    def run(self, report: Callable[[float], None] | None = None) -> ProvenBound:
        """Search until time or boxes run out or the gap closes; returns the bound.

        Parameters
        ----------
        report : called with every better bound
        """
        with suppress(Gone):
            self._add(self._squeezed(Box.whole(self.layout)), -math.inf)
        while self._open:
            if report is not None:
                report(min(self._open[0][0], self.least))
            if self.boxes >= self.most or time.perf_counter() > self.until:
                break
            value, _, box, bound = heapq.heappop(self._open)
            self.bounding.refine(self.best - value)
            choice = self._choice(box, bound)
            if choice is None:
                self.least = min(self.least, value)
                break
            for part in box.split(*choice):
                with suppress(Gone):
                    self._add(part.tightened(self.layout), value)
        bottom = min(self.least, self._open[0][0] if self._open else math.inf, self.goal)
        return ProvenBound(bottom + math.log1p(-GUARD), self.boxes, bottom >= self.goal)

    def first(self) -> float:
        """The bound of the first box; infinite if it is empty."""
        try:
            box = Box.whole(self.layout).tightened(self.layout)
        except Gone:
            return math.inf
        self.bounding.lay(box)
        bound = self.bounding.solve(box)
        return math.inf if bound is None else bound.value

    def _add(self, box: Box, parent: float) -> None:
        """Add a box that may hold a better design."""
        bound = self.bounding.solve(box)
        self.boxes += 1
        if bound is None:
            return
        value = max(bound.value, parent)
        if value >= self.goal:
            self.least = min(self.least, value)
            return
        trimmed = self.bounding.trimmed(box, bound, self.best)
        heapq.heappush(self._open, (value, next(self._order), trimmed, bound))

    def _squeezed(self, box: Box) -> Box:
        """The first box, cut to the designs no worse than the best known one.

        Repeatedly bounds the directions in which the relaxation is loosest, by optimisation.

        Raises
        ------
        Gone
            the box is empty
        """
        box = box.tightened(self.layout)
        self.bounding.lay(box)
        for _ in range(SQUEEZES):
            bound = self.bounding.solve(box)
            if bound is None:
                raise Gone
            loose = np.argsort(-self._gains(box, bound), kind="stable")[:WAYS]
            some = np.concatenate([loose, np.setdiff1d(self.variables, loose)])
            size, seen = float((box.high - box.low)[some].sum()), Seen(bound.directions)
            for number in map(int, some):
                if time.perf_counter() > self.until:
                    return box
                reach = self.bounding.extent(number, self.bounding.enter(box), seen)
                if reach is None:
                    raise Gone
                box = box.cut(number, low=reach[0] - ROOM, high=reach[1] + ROOM)
                box = box.tightened(self.layout)
            if float((box.high - box.low)[some].sum()) > (1 - GAIN) * size:
                break
        return box

    def _gains(self, box: Box, bound: Bound) -> Vector:
        """Possible gain of a split along every direction."""
        gains = np.minimum(bound.excess, FAR_OFF) * (bound.price + FLOOR)
        found = np.bincount(self.layout.direction, gains, self.layout.directions).astype(float)
        width = box.high - box.low
        first, second = self.layout.factors
        np.add.at(found, np.where(width[first] > width[second], first, second), bound.torn)
        return found

    def _choice(self, box: Box, bound: Bound) -> tuple[int, float] | None:
        """Direction and place of the split with the largest possible gain, or None."""
        gains = self._gains(box, bound)
        number = int(np.argmax(gains))
        if gains[number] <= WORTH:
            return None
        low, high = box.low[number], box.high[number]
        room = MIDDLE * (high - low)
        return number, float(np.clip(bound.directions[number], low + room, high - room))


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
    covered: tuple[TracedLimit, ...]
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


def _ends(claim: TracedLimit) -> tuple[float, float]:
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
) -> tuple[Relaxed, ProvenBound]:
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
) -> tuple[Relaxed | None, ProvenBound]:
    """Search for designs no heavier than an aim; no relaxation if that is ruled out at once."""
    try:
        relaxed, search = _search(trace(actuator, x), aim, until, most)
    except (Empty, Gone):
        return None, ProvenBound(math.log(aim) + math.log1p(-GUARD), 0, True)
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
