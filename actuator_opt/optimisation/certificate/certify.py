"""Proof of quality: a lower bound on the objective of all designs, and a design's gap to it.

The models that evaluate a design are traced: recorded as expressions of the design's variables,
separately for each load case. A model without a closed expression becomes an unknown quantity. An
envelope (upper and lower estimates) encloses its exact value, so the bound stays valid. Limits that
cannot be traced are dropped and listed by name.
"""

from __future__ import annotations

import heapq
import itertools
import math
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import field, replace
from typing import Any, TypeAlias

import numpy as np

from ...base.dataclass import dataclass
from ...base.symbolic import Graph, Symbol
from ...base.symbolic.bounds import bounds_of
from ...base.symbolic.expression import needed
from ...evaluation.kernel import ModelRun, Statics, compute, statics
from ...evaluation.limits import MetricArrays, MetricLimit
from ...evaluation.values import Values
from ..actuator import ActuatorProblem
from ..problem import Vector
from ..solution import MET
from .bounding import Bound, Bounding, KnownExtents, add_plain_sums, ranges
from .builder import Builder
from .envelopes import Envelopes, decays, layered, refuse
from .intervals import ROOM, Box, Empty, Layout, narrow, tighten
from .relaxation import ConstraintRow, Form, Relaxation, Unknown

SOFTER = 1e-5
"""Relative tolerance on the minimum stiffness, whose closed form is accurate to about 1e-7."""


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

    `dropped` gives the name of each limit that could not be traced, with the reason.
    """

    graph: Graph
    variables: dict[str, Symbol]
    """Variables of the design by PATH."""
    unknowns: dict[str, tuple[Symbol, Callable[[ModelRun], float]]] = field(default_factory=dict)
    """By name: each unknown quantity that an envelope bounds, and the function that reads its value
    from an evaluated design."""
    objectives: list[Any] = field(default_factory=list)
    """Values of the objective metric in the load cases; the objective is at least each of them."""
    claims: list[TracedLimit] = field(default_factory=list)
    facts: list[tuple[Any, Any]] = field(default_factory=list)
    """Pairs of values; the first value of a pair is always at least the second."""
    dropped: dict[str, str] = field(default_factory=dict)

    def unknown(self, name: str, exact: Callable[[ModelRun], float]) -> Symbol:
        """Add a positive unknown quantity; `exact` returns its value for an evaluated design."""
        if name not in self.unknowns:
            self.unknowns[name] = self.graph.variable(name, (0.0, math.inf)), exact
        return self.unknowns[name][0]


def variable(number: int) -> str:
    """Name of a design variable in the expressions, from its number."""
    return f"x{number}"


def trace(actuator: ActuatorProblem, x: Vector) -> Traced:
    """Trace objective and limits of an actuator as expressions.

    Parameters
    ----------
    actuator : the problem
    x : the design at which the envelopes are exact

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
    reference = compute(subject, subject.values(point))
    rates = decays(subject, subject.values(point), reference, actuator.paths)
    positions = _positions(reference)
    limits = dict.fromkeys(row.limit_of for row in actuator.rows)
    for i, case in enumerate(subject.design.load_cases):
        design = subject.design.model_copy(update={"load_cases": [case]})
        case_subject = replace(subject, design=design)
        values = Values(subject.numbers, case_subject.cases, traced.variables)
        envelopes = Envelopes(traced, subject, reference, rates, i)
        out = MetricArrays()
        try:
            with np.errstate(all="ignore"):
                case_statics = statics(case_subject, values, out, envelopes.implicit())
        except (TypeError, AttributeError):  # symbols raise this for unsupported operations
            raise Unknown("one of the models is not a closed formula of the variables") from None
        traced.facts += [(part, 0.0) for part in case_statics.mass_parts.values()]
        traced.facts += _along_the_stroke(envelopes, case_statics, out, positions)
        envelopes.joint(case_statics, out)
        if envelopes.bearable is not None:
            proof = values["supply.proof_ratio"] * values["supply.pressure"]
            proof_factor = traced.unknown("proof_factor", _least_proof)
            traced.facts.append((envelopes.bearable / proof, proof_factor))
            out.put("proof_factor", proof_factor)
        _collect(actuator, traced, list(limits), out, values, is_first=i == 0)
    return traced


def _least_proof(run: ModelRun) -> float:
    """The least proof-pressure factor among all locations."""
    return min(float(np.min(value)) for value in run.computed.metrics["proof_factor"].values())


def _along_the_stroke(
    envelopes: Envelopes, case_statics: Statics, out: MetricArrays, positions: tuple[float, ...]
) -> Iterator[tuple[Any, Any]]:
    """Bound the minimum stiffness from above by its values at some piston positions.

    The compliance of the two chambers is a 2 x 2 matrix. Elastic walls only add compliance to that
    of the oil, so the matrix has at least the determinant and the diagonal that it has for the oil
    alone.
    """
    springs, stroke = case_statics.springs, case_statics.base.geometry.stroke
    if springs.topology != "per_chamber" or springs.seals is not None:
        return
    series = springs.series_compliance()
    stiffness = envelopes.unknown(
        "stiffness", lambda run: run.computed.metrics["stiffness_min"][""]
    )
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
        yield (1 + SOFTER) / (1 / chambers + series), stiffness
    out.put("stiffness_min", stiffness)
    out.put("stiffness_rod", springs.chain["rod"])


def _collect(
    actuator: ActuatorProblem,
    traced: Traced,
    limits: list[MetricLimit],
    out: MetricArrays,
    values: Values,
    *,
    is_first: bool,
) -> None:
    """Collect the limits and objectives of one load case."""
    goal = actuator.goal
    case = values.cases[0]
    if goal.single is not None:
        for value in _applying(out, goal.single, ""):
            traced.objectives.append(goal.sign * value[1])
    for limit in limits:
        if limit.case is not None and limit.case != case:
            continue
        rows = list(_applying(out, limit.metric, case))
        limit_value = limit.value(values)
        varies = isinstance(limit_value, Symbol)
        if varies and not limit_value.bounds[0] > 0:
            traced.dropped[limit.name] = "the limit depends on the variables and may be zero"
            continue
        bound = 1.0 if varies else float(np.squeeze(limit_value))
        for place, value in rows:
            if limit.places is not None and place not in limit.places:
                continue
            if isinstance(value, Symbol) or varies:
                location = ", ".join(x for x in (case, place) if x)
                limited = value / limit_value if varies else value
                label = f"{limit.name} ({location})"
                traced.claims.append(TracedLimit(limit, label, limited, bound))
            else:
                traced.dropped.setdefault(limit.name, "no variable affects it")
        if not rows and (is_first or limit.case is not None):
            traced.dropped[limit.name] = "the model is not a closed formula of the variables"


def _applying(out: MetricArrays, metric: str, case: str) -> Iterator[tuple[str, Any]]:
    """Traced values of a metric, in the load cases where the metric applies."""
    for place, value in out.metrics.get(metric, {}).items():
        applies = out.applies_at.get((metric, place), out.applies.get(metric))
        if applies is None or bool(np.ravel(applies)[0]):
            yield place, value.item() if isinstance(value, np.ndarray) else value


def _positions(reference: ModelRun) -> tuple[float, ...]:
    """Piston positions of least stiffness in the load cases, as shares of the stroke."""
    shares = np.ravel(reference.weakest / reference.geometry.stroke)
    return tuple(sorted({round(float(share), 6) for share in shares if np.isfinite(share)}))


GUARD = 1e-6
"""Relative reduction of the bound for safety, far above the rounding error of traced values."""
CLOSE = 1e-4
"""Relative gap between design and bound at which the search ends."""
MIDDLE = 0.2
"""Each part of a split range has at least this share of the range."""
WORTH = 1e-9
"""Least estimated gain in the bound that justifies a split."""
FAR_OFF = 0.2
"""When the gain of a split is estimated, a curve's `Bound.excess` counts at most this much, since
the first split gains most."""
FLOOR = 0.003
"""Added to a curve's `Bound.price` in the estimated gain of a split. Among loose curves in a chain
(each the argument of the next), some have a price of 0; without this addition, no gain would be
expected from a split of their ranges."""
SQUEEZES = 2
"""Maximum number of rounds that cut the ranges of the first box."""
DIRECTIONS = 16
"""Number of directions (log ratios) that are cut per round, in addition to the variables."""
GAIN = 0.1
"""A further round follows only if a round cut at least this share of the ranges."""


@dataclass(frozen=True, slots=True)
class ProvenBound:
    """Lower bound on the objective's logarithm, boxes solved, and whether the gap is closed."""

    bound: float
    boxes: int
    closed: bool


class BoxSearch:
    """Branch and bound: splits the box with the lowest bound, where its relaxation is loosest.

    Parameters
    ----------
    layout, bounding : the relaxation, as arrays and as a linear programme
    best : logarithm of an objective; only designs that are at least as good are of interest
    variables : atoms (elementary quantities) whose ranges are always cut in the first box
    deadline : time of `time.perf_counter` at which the search stops
    max_boxes : maximum number of boxes to solve
    """

    def __init__(
        self,
        layout: Layout,
        bounding: Bounding,
        best: float,
        *,
        variables: Sequence[int] = (),
        deadline: float = math.inf,
        max_boxes: float = math.inf,
    ) -> None:
        self.layout, self.bounding, self.best = layout, bounding, best
        self.deadline, self.max_boxes = deadline, max_boxes
        self.goal = best + math.log1p(-CLOSE)
        self.least, self.boxes = math.inf, 0
        """Lowest bound among the finished boxes, and the number of boxes solved."""
        directions = layout.plain[layout.curves :]
        self.variables = np.flatnonzero(np.isin(directions, variables))
        self._order = itertools.count()
        self._open: list[tuple[float, int, Box, Bound]] = []

    def run(self, report: Callable[[float], None] | None = None) -> ProvenBound:
        """Search until the gap is closed or a limit is reached; return the bound.

        `report` is called with every better bound.
        """
        with suppress(Empty):
            self._add(self._squeezed(Box.whole(self.layout)), -math.inf)
        while self._open:
            if report is not None:
                report(min(self._open[0][0], self.least))
            if self.boxes >= self.max_boxes or time.perf_counter() > self.deadline:
                break
            value, _, box, bound = heapq.heappop(self._open)
            self.bounding.refine(self.best - value)
            choice = self._choice(box, bound)
            if choice is None:
                self.least = min(self.least, value)
                break
            for part in box.split(*choice):
                with suppress(Empty):
                    self._add(part.tightened(self.layout), value)
        bottom = min(self.least, self._open[0][0] if self._open else math.inf, self.goal)
        return ProvenBound(bottom + math.log1p(-GUARD), self.boxes, bottom >= self.goal)

    def root_bound(self) -> float:
        """The bound of the first box; infinite if it is empty."""
        try:
            box = Box.whole(self.layout).tightened(self.layout)
        except Empty:
            return math.inf
        self.bounding.add_first_tangents(box)
        bound = self.bounding.solve(box)
        return math.inf if bound is None else bound.value

    def _add(self, box: Box, parent: float) -> None:
        """Solve a box, and store it if it may contain a better design."""
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
        """The first box, cut to the designs that are no worse than the best known design.

        Each round minimises and maximises the log ratios (directions) at which the relaxation is
        loosest.

        Raises
        ------
        Empty
            the box is empty
        """
        box = box.tightened(self.layout)
        self.bounding.add_first_tangents(box)
        for _ in range(SQUEEZES):
            bound = self.bounding.solve(box)
            if bound is None:
                raise Empty
            loosest = np.argsort(-self._gains(box, bound), kind="stable")[:DIRECTIONS]
            directions = np.concatenate([loosest, np.setdiff1d(self.variables, loosest)])
            known = KnownExtents(bound.directions)
            size = float((box.high - box.low)[directions].sum())
            for number in map(int, directions):
                if time.perf_counter() > self.deadline:
                    return box
                extent = self.bounding.extent(number, self.bounding.enter(box), known)
                if extent is None:
                    raise Empty
                box = box.cut(number, low=extent[0] - ROOM, high=extent[1] + ROOM)
                box = box.tightened(self.layout)
            if float((box.high - box.low)[directions].sum()) > (1 - GAIN) * size:
                break
        return box

    def _gains(self, box: Box, bound: Bound) -> Vector:
        """Estimated gain in the bound from a split along each direction."""
        gains = np.minimum(bound.excess, FAR_OFF) * (bound.price + FLOOR)
        layout, width = self.layout, box.high - box.low
        by_direction = np.bincount(layout.direction, gains, layout.directions).astype(float)
        first, second = layout.factors
        wider = np.where(width[first] > width[second], first, second)
        np.add.at(by_direction, wider, bound.product_errors)
        return by_direction

    def _choice(self, box: Box, bound: Bound) -> tuple[int, float] | None:
        """Direction and position of the split with the largest gain; None if no split gains."""
        gains = self._gains(box, bound)
        number = int(np.argmax(gains))
        if gains[number] <= WORTH:
            return None
        low, high = box.low[number], box.high[number]
        room = MIDDLE * (high - low)
        return number, float(np.clip(bound.directions[number], low + room, high - room))


Report: TypeAlias = Callable[[float], None] | None

BOXES = 200
"""Default limit on the number of boxes, which takes some six seconds. Unlike a time limit, it
does not depend on how busy a machine is."""

AIM = 0.049
"""Target gap of a coarse search, which only has to exclude much better designs."""

WIDE = 0.1
"""If the gap of the first box exceeds this, a coarse search is run."""

EASY = 20
"""A full search follows a coarse search that ends within this number of boxes."""

SECONDS = 30.0
"""Time limit of the search; only very slow machines reach it."""


@dataclass(frozen=True)
class Relaxed:
    """The relaxation of a traced problem."""

    relaxation: Relaxation
    objective: Form
    variables: dict[str, Form]
    covered: tuple[TracedLimit, ...]
    dropped: dict[str, str]
    unknowns: dict[str, Callable[[ModelRun], float]]
    """By name: functions that read the unknown quantities' values from an evaluated design."""

    def atoms(self, actuator: ActuatorProblem, x: Vector) -> Vector:
        """Logarithm of the value that every atom (elementary quantity) has at a design."""
        point = {path: np.array([value]) for path, value in zip(actuator.paths, x, strict=True)}
        with np.errstate(all="ignore"):
            run = compute(actuator.subject, actuator.subject.values(point))
        values = {variable(k): float(value) for k, value in enumerate(x)}
        values |= {name: exact(run) for name, exact in self.unknowns.items()}
        names = {form.powers[0][0]: name for name, form in self.variables.items()}
        logarithms: list[float] = []
        for i, maker in enumerate(self.relaxation.makers):
            logarithms.append(_log(values[names[i]]) if i in names else maker(logarithms))
        return np.array(logarithms)


def relax(traced: Traced, best: float) -> Relaxed:
    """Relax the problem for all designs that meet the limits, with an objective of at most `best`.

    Raises
    ------
    Empty
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
        low, high = _ends(claim)
        try:
            if math.isfinite(low):
                builder.at_least(claim.value, low)
            else:
                builder.at_least(-claim.value, -high)
        except Unknown as reason:
            dropped[claim.label] = str(reason)
            continue
        covered.append(claim)
    for larger, smaller in traced.facts:
        with suppress(Unknown):
            builder.at_least(larger, smaller)
    objective = _largest(builder, traced.objectives)
    box = Box.whole(Layout(builder.relaxation)).tightened(Layout(builder.relaxation))
    builder.relaxation.lower, builder.relaxation.upper = box.lower.tolist(), box.upper.tolist()
    add_plain_sums(builder.relaxation)
    exact = {name: function for name, (_, function) in traced.unknowns.items()}
    return Relaxed(builder.relaxation, objective, builder.variables, tuple(covered), dropped, exact)


def _largest(builder: Builder, values: Sequence[Any]) -> Form:
    """Logarithm of the largest value, or of an atom at least as large as each value."""
    forms = list(dict.fromkeys(builder.form(value)[1] for value in values))
    if len(forms) == 1:
        return forms[0]
    low, high = (max(ends) for ends in zip(*map(bounds_of, values), strict=True))
    largest = builder.relaxation.atom(low, high, lambda y: max(form.at(y) for form in forms))
    builder.relaxation.rows += [ConstraintRow(form, largest) for form in forms]
    return largest


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
    max_boxes: float = BOXES,
    report: Report = None,
) -> tuple[Relaxed, ProvenBound]:
    """Compute a lower bound on the objective, for all designs that meet the limits.

    Parameters
    ----------
    actuator : the problem
    x, objective : the best known design
    seconds, max_boxes : limits on duration and number of boxes
    report : called with the logarithm of every better bound

    Raises
    ------
    Unknown
        the design misses a limit, or an essential model has no relaxation
    """
    deadline = time.perf_counter() + seconds
    try:
        relaxed, search = _search(trace(actuator, x), objective, deadline, max_boxes)
    except Empty:
        raise Unknown("the design itself misses a limit") from None
    if not _meets(search.layout, relaxed.atoms(actuator, x)):
        raise Unknown("the design itself misses a limit")
    if search.root_bound() < math.log(objective) + math.log1p(-WIDE):
        coarse, bound = _coarse(actuator, x, objective * (1 - AIM), deadline, max_boxes, report)
        if bound.boxes > EASY:
            return coarse or relaxed, bound
    return relaxed, search.run(report)


def _coarse(
    actuator: ActuatorProblem,
    x: Vector,
    aim: float,
    deadline: float,
    max_boxes: float,
    report: Report,
) -> tuple[Relaxed | None, ProvenBound]:
    """Search for designs no worse than `aim`; the relaxation returned is None if there are none."""
    try:
        relaxed, search = _search(trace(actuator, x), aim, deadline, max_boxes)
    except Empty:
        return None, ProvenBound(math.log(aim) + math.log1p(-GUARD), 0, True)
    return relaxed, search.run(report)


def _search(
    traced: Traced, objective: float, deadline: float, max_boxes: float
) -> tuple[Relaxed, BoxSearch]:
    """Prepare a search for designs whose objective is at most `objective`."""
    relaxed = relax(traced, objective)
    layout = Layout(relaxed.relaxation)
    bounding = Bounding(layout, relaxed.objective)
    atoms = [form.powers[0][0] for form in relaxed.variables.values()]
    goal = math.log(objective)
    return relaxed, BoxSearch(
        layout, bounding, goal, variables=atoms, deadline=deadline, max_boxes=max_boxes
    )


def _meets(layout: Layout, y: Vector) -> bool:
    """Whether a design satisfies the ranges and rows of its own relaxation."""
    box = Box.whole(layout)
    _, high, _, _ = layout.reach(y, y)
    rows = layout.parts[2]
    inside = (box.lower - MET <= y) & (y <= box.upper + MET)
    return bool(inside.all() and (high[rows] >= -2 * MET).all())


def _log(value: float) -> float:
    """Logarithm of a value; a value at or below 0 is replaced by a tiny number."""
    return math.log(value) if value > 0 else -math.inf
