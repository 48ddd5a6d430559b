"""The convex problem of one box: the least objective of its relaxation.

A linear programme. The convex side of every curve is a set of tangents, valid in every box and
added where the solution misses the curve [Kelley1960]. The other side is the chord over the box.
The bound is computed from the multipliers alone, so it holds whatever the solver's tolerances
[Neumaier2004].

Sums in plain numbers beside their logarithms, so that linear relations stay linear.

A lower bound on a sum is loose in logarithms where its terms range widely, but exact in plain
numbers. There a monomial is tied to its widest factor and the rest by the planes of their product
[McCormick1976]: mass and stiffness of a layer both follow its thickness.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import highspy
import numpy as np
import scipy.sparse as sp

from ...base.symbolic import Symbol, vectorised
from ..problem import Vector
from .intervals import ROOM, Box, Layout
from .relaxation import (
    FAR,
    AtomFunction,
    ConstraintRow,
    Form,
    Link,
    Powers,
    Product,
    Relaxation,
    SampledFunction,
)


class Products:
    """Rows -inf or low <= w + a x + b y <= high or inf of products w = k x y, from row `first` on.

    Two planes lie below and two above, through the corners of both factors' ranges.
    """

    def __init__(self, products: Sequence[Product], first: int, columns: int) -> None:
        self.first, self.rows = first, 4 * len(products)
        atoms = [(product.first, product.second, product.out) for product in products]
        self.atoms = np.array(atoms, dtype=np.int32).reshape(-1, 3)
        self.level = np.exp([product.level for product in products])
        self.columns = np.repeat(self.atoms, 4, axis=0)
        """Columns (rows, 3) of x, y and w."""
        starts, shape = 3 * np.arange(self.rows + 1), (self.rows, columns)
        ones = np.ones(3 * self.rows)
        self.matrix = sp.csr_matrix((ones, self.columns.ravel(), starts), shape=shape)

    def planes(self, lower: Vector, upper: Vector) -> tuple[Vector, Vector, Vector]:
        """Coefficients (rows, 3) and ends of the rows, for ranges of all columns.

        w >= k (x_l y + y_l x - x_l y_l), w >= k (x_u y + y_u x - x_u y_u),
        w <= k (x_u y + y_l x - x_u y_l), w <= k (x_l y + y_u x - x_l y_u).
        """
        x, y, _ = self.atoms.T
        sides = (lower, lower), (upper, upper), (upper, lower), (lower, upper)
        corners = np.stack([(one[x], two[y]) for one, two in sides])  # (4, 2, products)
        scaled = -self.level * corners
        planes = np.ones((len(self.atoms), 4, 3))
        planes[:, :, 0], planes[:, :, 1] = scaled[:, 1].T, scaled[:, 0].T
        level = (scaled[:, 0] * corners[:, 1]).T
        low, high = level - ROOM, level + ROOM
        low[:, 2:], high[:, :2] = -np.inf, np.inf
        return planes.reshape(-1, 3), low.ravel(), high.ravel()

    def torn(self, x: Vector, dual: Vector) -> Vector:
        """Error of every product at a point, times its multipliers."""
        first, second, out = self.atoms.T
        price = np.abs(dual[self.first : self.first + self.rows]).reshape(-1, 4).sum(axis=1)
        found: Vector = np.abs(x[out] - self.level * x[first] * x[second]) * price
        return found


class Lines(NamedTuple):
    """low <= out + coefficient * ratio <= high, by columns of curve and direction."""

    ratio: Any
    coefficient: Vector
    out: Any
    low: Vector
    high: Vector

    def joined(self, more: Lines) -> Lines:
        """These lines followed by others."""
        return Lines(*(np.concatenate(pair) for pair in zip(self, more, strict=True)))

    def put(self, solver: Any) -> None:
        """Add the lines to a programme as rows."""
        count = len(self.low)
        indices = np.stack([self.ratio, self.out], axis=1).ravel().astype(np.int32)
        data = np.stack([self.coefficient, np.ones(count)], axis=1).ravel()
        starts = 2 * np.arange(count, dtype=np.int32)
        solver.addRows(count, self.low, self.high, 2 * count, starts, indices, data)


class Seen:
    """Least and largest value of every direction over known points of the relaxation."""

    def __init__(self, directions: Vector) -> None:
        self.ends = directions.copy(), directions.copy()

    def add(self, directions: Vector) -> None:
        """Include another point."""
        np.minimum(self.ends[0], directions, out=self.ends[0])
        np.maximum(self.ends[1], directions, out=self.ends[1])


WIDEST = 40.0
"""Widest argument range that gets a chord; a wider chord carries no information."""

ROUNDS = 3
"""Maximum rounds of tangents in one box; the following boxes reuse the tangents."""

FIRST = (0.0,)
"""Places of the first tangents, as shares of half the range."""

ENOUGH = 2e-5
"""Gain of the bound below which no further round of tangents follows."""

MISSED = (1e-5, 1e-3)
"""Limits of the distance from a curve at which a tangent is added."""

FINE = 0.01
"""The same distance, relative to the remaining gap."""

PROVEN = 1e-6
"""Least value of a ray that proves a box empty, above rounding."""

NEAR = 0.05
"""A point this close to an end of a range, as a share of it, shows that the end cannot be cut."""

MOST = 3
"""Lines per curve above which those that do not touch are deleted."""


class Bound(NamedTuple):
    """Least objective of a box (its logarithm), and where the relaxation is loose there."""

    value: float
    atoms: Vector
    directions: Vector
    excess: Vector
    """Distance of every curve from the solution, on the side of its chord."""
    price: Vector
    """Multiplier of every chord."""
    torn: Vector
    """Error of every product times its price."""
    slopes: Vector
    """For every column, the least rise of the objective as the column leaves its better end."""


class Bounding:
    """The relaxation as one linear programme, solved again for every box.

    Columns: atoms, directions, curves. Rows: definitions of directions and curves, limits; then
    lines, each between a direction and a curve: one chord per curve, and the tangents.
    """

    def __init__(self, layout: Layout, objective: Form) -> None:
        self.layout = layout
        curves = layout.curves
        own = layout.plain < 0
        self.columns = layout.atoms + int(own.sum())
        self.column = np.where(own, layout.atoms + np.cumsum(own) - 1, layout.plain)
        """Column of every output and direction: that of its atom, or its own."""
        self.out = self.column[:curves].astype(np.int32)
        self.ways = self.column[curves:]
        self.ratio = self.ways[layout.direction].astype(np.int32)
        self.cost = np.zeros(self.columns)
        for i, power in objective.powers:
            self.cost[i] = power
        self.constant = objective.constant
        matrix, low, high = self._definitions()
        self.products = Products(layout.relaxation.products, len(low), self.columns)
        self.matrix = sp.vstack([matrix, self.products.matrix], format="csr")
        none = np.full(self.products.rows, np.inf)
        self.low, self.high = np.concatenate([low, -none]), np.concatenate([high, none])
        bases = np.array([link.base for link in layout.links], dtype=np.int32)
        outs = np.array([link.out for link in layout.links], dtype=np.int32)
        self.moving = curves + 2 * len(outs)
        none = np.zeros(self.moving)
        self.lines = Lines(
            np.concatenate([self.ratio, bases, bases]),
            none,
            np.concatenate([self.out, outs, outs]),
            none - np.inf,
            none + np.inf,
        )
        self.solver = self._solver()
        self.missed = MISSED[1]

    def refine(self, gap: float) -> None:
        """Refine the tangents to the accuracy that a gap of the objective's logarithm needs."""
        self.missed = float(np.clip(FINE * gap, *MISSED))

    def _definitions(self) -> tuple[Any, Vector, Vector]:
        """Outputs and directions in terms of their atoms; rows at least zero."""
        layout = self.layout
        new = np.flatnonzero(layout.plain < 0)
        kept = np.concatenate([new, np.arange(len(layout.plain), len(layout.levels))])
        place = np.full(len(layout.levels), -1)
        place[kept] = np.arange(len(kept))
        some = place[layout.form] >= 0
        rows = np.concatenate([place[layout.form[some]], np.arange(len(new))])
        columns = np.concatenate([layout.atom[some], self.column[new]])
        values = np.concatenate([layout.power[some], np.full(len(new), -1.0)])
        matrix = sp.csr_matrix((values, (rows, columns)), shape=(len(kept), self.columns))
        level = -layout.levels[kept]
        high = level.copy()
        high[len(new) :] = np.inf
        return matrix, level, high

    def _solver(self) -> Any:
        """The programme without bounds and chords, which depend on the box."""
        solver: Any = highspy.Highs()  # type: ignore[no-untyped-call]
        m = self.matrix
        for name, value in _OPTIONS.items():
            solver.setOptionValue(name, value)
        none, index = np.empty(0), np.empty(0, dtype=np.int32)
        ends = np.full(self.columns, FAR)
        solver.addCols(self.columns, self.cost, -ends, ends, 0, index, index, none)
        rows = m.indptr[:-1].astype(np.int32), m.indices.astype(np.int32), m.data
        solver.addRows(len(self.low), self.low, self.high, m.nnz, *rows)
        self.lines.put(solver)
        return solver

    def solve(self, box: Box) -> Bound | None:
        """The bound of a box; None if the relaxation has no solution."""
        lower, upper = self.enter(box)
        found = self._least(self.cost, lower, upper, rounds=ROUNDS)
        if found is None:
            return None
        value, slopes, x, dual = found
        first = len(self.low)
        return Bound(
            value + self.constant,
            x[: self.layout.atoms],
            x[self.ways],
            np.maximum(-self._missed(x), 0.0),
            np.abs(dual[first : first + self.layout.curves]),
            self.products.torn(x, dual),
            slopes,
        )

    def trimmed(self, box: Box, bound: Bound, best: float) -> Box:
        """The part of a box that may hold a design as good as the best known one.

        A range with multiplier d is at most as long as the remaining gap divided by d.
        """
        lower, upper = self._ends(box)
        left = max(best - bound.value, 0.0) + ROOM
        with np.errstate(divide="ignore"):
            most = lower + left / np.maximum(bound.slopes, 0.0)
            least = upper + left / np.minimum(bound.slopes, -0.0)
        lower, upper = np.maximum(lower, least - ROOM), np.minimum(upper, most + ROOM)
        atoms = slice(0, self.layout.atoms)
        return Box(
            np.maximum(box.lower, lower[atoms]),
            np.minimum(box.upper, upper[atoms]),
            np.maximum(box.low, lower[self.ways]),
            np.minimum(box.high, upper[self.ways]),
        )

    def enter(self, box: Box) -> tuple[Vector, Vector]:
        """Load a box into the programme; returns the ranges of its columns."""
        self._purge()
        ends = self._columns(box)
        self._chords(box)
        return ends

    def _purge(self) -> None:
        """Delete tangents that no longer touch, once there are too many."""
        first, count = len(self.low) + self.moving, len(self.lines.low)
        if count < MOST * self.moving:
            return
        status = self.solver.getBasis().row_status
        idle = [
            r for r in range(first, len(status)) if status[r] == highspy.HighsBasisStatus.kBasic
        ]
        if not idle:
            return
        self.solver.deleteRows(len(idle), np.array(idle, dtype=np.int32))
        kept = np.ones(count, dtype=bool)
        kept[np.array(idle) - len(self.low)] = False
        self.lines = Lines(*(part[kept] for part in self.lines))

    def extent(
        self, direction: int, ends: tuple[Vector, Vector], seen: Seen
    ) -> tuple[float, float] | None:
        """Least and largest value of a direction in the loaded box; None if the box is empty.

        An end of the range that a known point nearly reaches is not recomputed; new points are
        stored.
        """
        way = self.ways[direction]
        reach = [float(end[way]) for end in ends]
        near = NEAR * (reach[1] - reach[0])
        cost = np.zeros(self.columns)
        for side, sign in enumerate((1.0, -1.0)):
            if 0 <= sign * (seen.ends[side][direction] - reach[side]) <= near:
                continue
            cost[way] = sign
            found = self._least(cost, *ends, rounds=1)
            if found is None:
                return None
            reach[side] = sign * found[0]
            seen.add(found[2][self.ways])
        return reach[0], reach[1]

    def _least(
        self, cost: Vector, lower: Vector, upper: Vector, *, rounds: int
    ) -> tuple[float, Vector, Vector, Vector] | None:
        """Minimise a linear function: proven value, slopes, point, multipliers."""
        index = np.arange(self.columns, dtype=np.int32)
        self.solver.changeColsCost(self.columns, index, cost)
        last = -np.inf
        for _ in range(rounds):
            self.solver.run()
            if self._empty(lower, upper):
                return None
            solution = self.solver.getSolution()
            x, dual = np.array(solution.col_value), np.array(solution.row_dual)
            value = float(cost @ x)
            if rounds == 1 or value - last < ENOUGH or not self._tangents(x):
                break
            last = value
        return *self._safe(cost, dual, lower, upper), x, dual

    def _empty(self, lower: Vector, upper: Vector) -> bool:
        """Whether multipliers prove that no point satisfies all lines."""
        if self.solver.getModelStatus() != highspy.HighsModelStatus.kInfeasible:
            return False
        _, known, ray = self.solver.getDualRay()
        none = np.zeros(self.columns)
        return known and self._safe(none, np.array(ray), lower, upper)[0] > PROVEN

    def _ends(self, box: Box) -> tuple[Vector, Vector]:
        """Ranges of the columns in a box."""
        low, high, _, _ = self.layout.reach(box.lower, box.upper)
        lower, upper = np.full((2, self.columns), np.nan)
        lower[: len(box.lower)], upper[: len(box.upper)] = box.lower, box.upper
        outs = self.layout.parts[0]
        lows, highs = np.concatenate([low[outs], box.low]), np.concatenate([high[outs], box.high])
        np.fmax.at(lower, self.column, lows)
        np.fmin.at(upper, self.column, highs)
        return lower, upper

    def _columns(self, box: Box) -> tuple[Vector, Vector]:
        """Load the ranges of a box."""
        lower, upper = self._ends(box)
        index = np.arange(self.columns, dtype=np.int32)
        self.solver.changeColsBounds(self.columns, index, lower, upper)
        self._planes(lower, upper)
        return lower, upper

    def _planes(self, lower: Vector, upper: Vector) -> None:
        """Load the planes of the products over the ranges of the columns."""
        products, first = self.products, self.products.first
        planes, low, high = products.planes(lower, upper)
        self.matrix.data[len(self.matrix.data) - planes.size :] = planes.ravel()
        some = slice(first, first + products.rows)
        self.low[some], self.high[some] = low, high
        columns, values = products.columns.tolist(), planes.tolist()
        for row, (one, two, _), (left, right, _) in zip(
            range(first, first + products.rows), columns, values, strict=True
        ):
            self.solver.changeCoeff(row, one, left)
            self.solver.changeCoeff(row, two, right)
        index = np.arange(first, first + products.rows, dtype=np.int32)
        self.solver.changeRowsBounds(products.rows, index, low, high)

    def _chords(self, box: Box) -> None:
        """Replace the chords by those over this box."""
        layout, lines = self.layout, self.lines
        first, count = len(self.low), layout.curves
        low, high = layout.arguments(box.low, box.high)
        mixed, width = layout.mixed, high - low
        first_value, last_value = mixed.value(low), mixed.value(high)
        flat = width < 1e-9
        slope = np.where(flat, 0.0, (last_value - first_value) / np.where(flat, 1.0, width))
        level = first_value + slope * (layout.constant - low)
        off = mixed.room + np.where(flat, np.abs(last_value - first_value), 0.0)
        below, above = mixed.apart(low, high, slope)
        over = width <= WIDEST
        lines.coefficient[:count] = np.where(over, -slope * layout.factor, 0.0)
        lines.low[:count] = np.where(over & (mixed.convex <= 0), level + below - off, -np.inf)
        lines.high[:count] = np.where(over & (mixed.convex >= 0), level + above + off, np.inf)
        ratios = layout.ratios(box)
        least, most = (
            slice(count, count + len(ratios[0])),
            slice(count + len(ratios[0]), self.moving),
        )
        lines.coefficient[least], lines.low[least] = -ratios[0], 0.0
        lines.coefficient[most], lines.high[most] = -ratios[1], 0.0
        count = self.moving
        index = first + np.arange(count, dtype=np.int32)
        columns, values = lines.ratio[:count].tolist(), lines.coefficient[:count].tolist()
        for row, column, value in zip(index.tolist(), columns, values, strict=True):
            self.solver.changeCoeff(row, column, value)
        self.solver.changeRowsBounds(count, index, lines.low[:count], lines.high[:count])

    def _argument(self, x: Vector) -> Vector:
        found: Vector = self.layout.factor * x[self.ratio] + self.layout.constant
        return found

    def _missed(self, x: Vector) -> Vector:
        """Distance of every curve from a point, positive on the side of its tangents."""
        mixed = self.layout.mixed
        off = mixed.value(self._argument(x)) - x[self.out]
        return np.where(mixed.convex == 0, -np.abs(off), mixed.convex * off)

    def lay(self, box: Box) -> None:
        """Place the first tangents of every curve over a box."""
        low, high = self.layout.arguments(box.low, box.high)
        middle, reach = (low + high) / 2, np.minimum((high - low) / 2, 0.5 * WIDEST)
        some = np.flatnonzero(self.layout.mixed.convex)
        for share in FIRST:
            self._append(self._touching(middle + share * reach, some))

    def _append(self, more: Lines) -> None:
        more.put(self.solver)
        self.lines = self.lines.joined(more)

    def _tangents(self, x: Vector) -> bool:
        """Add tangents where the point violates a curve; whether any were added."""
        some = np.flatnonzero(self._missed(x) > self.missed)
        if len(some):
            self._append(self._touching(self._argument(x), some))
        return len(some) > 0

    def _touching(self, t: Vector, some: Any) -> Lines:
        """Tangents of some curves, from the arguments of all."""
        layout = self.layout
        slope = layout.mixed.slope(t)
        mixed = layout.mixed
        level = mixed.value(t) - mixed.convex * mixed.room + slope * (layout.constant - t)
        level, convex = level[some], mixed.convex[some] > 0
        return Lines(
            self.ratio[some],
            (-slope * layout.factor)[some],
            self.out[some],
            np.where(convex, level, -np.inf),
            np.where(convex, np.inf, level),
        )

    def _safe(
        self, cost: Vector, dual: Vector, lower: Vector, upper: Vector
    ) -> tuple[float, Vector]:
        """Least value that the multipliers prove from rows and bounds, and its slopes."""
        count, lines = len(self.low), self.lines
        dual = dual[: count + len(lines.low)]
        low, high = (
            np.concatenate([one, two])[: len(dual)]
            for one, two in ((self.low, lines.low), (self.high, lines.high))
        )
        ends = np.where(dual > 0, low, high)
        dual = np.where(np.isfinite(ends), dual, 0.0)
        ends = np.where(np.isfinite(ends), ends, 0.0)
        own = dual[count:]
        some = slice(0, len(own))
        rest = cost - self.matrix.T @ dual[:count]
        np.add.at(rest, lines.ratio[some], -own * lines.coefficient[some])
        np.add.at(rest, lines.out[some], -own)
        return float(dual @ ends + np.minimum(rest * lower, rest * upper).sum()), rest


_OPTIONS = {
    "output_flag": False,
    "presolve": "off",
    "simplex_strategy": 0,
    "simplex_dual_edge_weight_strategy": 1,  # Devex: no update after a change of rows
    "primal_feasibility_tolerance": 1e-7,
    "dual_feasibility_tolerance": 1e-9,
    "threads": 1,
    "simplex_scale_strategy": 0,
}
SAMPLES = 1001
"""Number of samples over the range of the argument."""
CAUTION = 1.5
"""Safety factor on the second derivative of the samples."""
_LOGIC = ("lt", "le", "and", "or", "not")


class Leads:
    """The lead of each value: the one value through which it depends on all variables."""

    def __init__(self) -> None:
        self._known: dict[int, Symbol] = {}

    def of(self, node: Symbol) -> Symbol:
        """The lead of a value."""
        if node.index not in self._known:
            under = {self.of(operand) for operand in node.operands}
            self._known[node.index] = under.pop() if len(under) == 1 else node
        return self._known[node.index]


def function(nodes: Sequence[Symbol], lead: Symbol) -> Callable[[Vector], Vector]:
    """A function for values (nodes, n) of nodes with one lead, from its logarithms (n,)."""
    code = vectorised("lone", "value", {}, nodes, known={lead: "value"})

    def values(t: Vector) -> Vector:
        with np.errstate(all="ignore"):
            rows = code(np.exp(t))
        return np.stack([np.broadcast_to(np.asarray(row, dtype=float), t.shape) for row in rows])

    return values


def samples(lead: Symbol) -> Vector:
    """Sampled logarithms over the range of a positive value."""
    low, high = np.log(lead.bounds)
    return np.linspace(low, high, SAMPLES)


def ranges(nodes: Sequence[Symbol]) -> dict[Symbol, tuple[float, float]]:
    """Ranges of all values with a positive lead, if finite."""
    leads = Leads()
    groups: dict[Symbol, list[Symbol]] = {}
    for node in nodes:
        lead = leads.of(node)
        if lead is node or node.op in _LOGIC:
            continue
        if 0 < lead.bounds[0] < lead.bounds[1] < np.inf:
            groups.setdefault(lead, []).append(node)
    found = {}
    for lead, some in groups.items():
        for node, row in zip(some, function(some, lead)(samples(lead)), strict=True):
            if np.isfinite(row).all():
                room = CAUTION * float(np.abs(np.diff(row, 2)).max()) / 8
                found[node] = (float(row.min()) - room, float(row.max()) + room)
    return found


WIDE = 0.3
"""Least range of the ratio of a sum's parts for which plain numbers are added."""


class _Plain:
    """Plain atoms of a relaxation with known ranges."""

    def __init__(self, relaxation: Relaxation) -> None:
        self.found = relaxation
        self.known: dict[Powers, int] = {}
        self.tops: dict[int, float] = {}
        self.tables = {
            curve.out.powers[0][0]: curve
            for curve in relaxation.curves
            if isinstance(curve.kind, SampledFunction)
        }

    def width(self, form: Form) -> float:
        """Range of a monomial's logarithm."""
        low, high = self.found.reach(form)
        return high - low

    def atom(self, powers: Powers) -> int:
        """The plain atom of a monomial, relative to its largest value."""
        if powers not in self.known:
            found, form = self.found, Form(0.0, powers)
            low, high = found.reach(form)
            argument = Form(-high, powers)
            found.lower.append(math.exp(low - high))
            found.upper.append(1.0)
            found.makers.append(lambda y: math.exp(argument.at(y)))
            self.known[powers] = number = len(found.lower) - 1
            self.tops[number] = high
            found.curves.append(AtomFunction("exp", argument, Form(0.0, ((number, 1.0),))))
            self._tie(form, number)
        return self.known[powers]

    def term(self, form: Form, scale: float) -> Form:
        """A monomial divided by e^scale, linear in its plain atom."""
        if not form.powers:
            return Form(math.exp(form.constant - scale))
        number = self.atom(form.powers)
        return Form(0.0, ((number, math.exp(form.constant + self.tops[number] - scale)),))

    def _tie(self, form: Form, number: int) -> None:
        """Tie a plain atom to those of its factors, or to its argument."""
        lone = [i for i, power in form.powers if power == 1.0]
        if not lone:
            return
        widest = max(lone, key=lambda i: self.width(Form(0.0, ((i, 1.0),))))
        base = Form(0.0, ((widest, 1.0),))
        rest = form - base
        if rest.powers:
            first, second = self.atom(base.powers), self.atom(rest.powers)
            level = self.tops[first] + self.tops[second] - self.tops[number]
            self.found.products.append(Product(number, first, second, level))
        elif widest in self.tables:
            curve = self.tables[widest]
            under = self.atom(curve.argument.powers)
            level = curve.argument.constant + self.tops[under] - self.tops[number]
            self.found.links.append(Link(number, under, level, curve))


def straighten(relaxation: Relaxation) -> None:
    """Add plain numbers for the wide sums of a relaxation."""
    plain = _Plain(relaxation)
    for whole, part, rest in list(relaxation.splits):
        if plain.width(part - rest) < WIDE:
            continue
        scale = relaxation.reach(whole)[1]
        own = plain.term(whole, scale)
        sums = plain.term(part, scale) + plain.term(rest, scale)
        relaxation.rows += [ConstraintRow(own, sums), ConstraintRow(sums, own)]
