"""Lower bound for one box: a linear programme minimises the objective of the box's relaxation.

A box is a part of the design space. A tangent bounds a curve on its convex side. Tangents are valid
in every box; a tangent is added where the solution violates the curve [Kelley1960]. On the other
side, the chord across the box bounds the curve. The bound is computed from the multipliers alone,
so it is valid for any tolerance of the solver [Neumaier2004].

The relaxation uses the logarithms of all quantities. In logarithms, the bounds on a sum are loose
if its terms vary widely. Such a sum is therefore also stated with the quantities themselves, as a
linear and so exact row. A product is then not linear: four planes bound it [McCormick1976]. Its two
factors are the quantity with the widest range and the rest of the product. Thus the mass and the
stiffness of a layer, for example, are both tied to the layer's thickness.
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
    """Rows of the linear programme, from row `first`, that bound products w = k x y.

    Each row is low <= w + a x + b y or w + a x + b y <= high. Two planes lie below the
    product and two above. They pass through the corners of the ranges of x and y.
    """

    def __init__(self, products: Sequence[Product], first: int, columns: int) -> None:
        self.first, self.rows = first, 4 * len(products)
        atoms = [(product.first, product.second, product.out) for product in products]
        self.atoms = np.array(atoms, dtype=np.int32).reshape(-1, 3)
        self.level = np.exp([product.level for product in products])
        self.columns = np.repeat(self.atoms, 4, axis=0)
        """Column numbers (rows, 3) of x, y and w."""
        starts, shape = 3 * np.arange(self.rows + 1), (self.rows, columns)
        ones = np.ones(3 * self.rows)
        self.matrix = sp.csr_matrix((ones, self.columns.ravel(), starts), shape=shape)

    def planes(self, lower: Vector, upper: Vector) -> tuple[Vector, Vector, Vector]:
        """Coefficients (rows, 3) and limits of the rows, given the ranges of all columns.

        w >= k (x_l y + y_l x - x_l y_l), w >= k (x_u y + y_u x - x_u y_u),
        w <= k (x_u y + y_l x - x_u y_l), w <= k (x_l y + y_u x - x_l y_u).
        """
        x, y, _ = self.atoms.T
        sides = (lower, lower), (upper, upper), (upper, lower), (lower, upper)
        corners = np.stack([(x_ends[x], y_ends[y]) for x_ends, y_ends in sides])  # (4, 2, products)
        scaled = -self.level * corners
        planes = np.ones((len(self.atoms), 4, 3))
        planes[:, :, 0], planes[:, :, 1] = scaled[:, 1].T, scaled[:, 0].T
        level = (scaled[:, 0] * corners[:, 1]).T
        low, high = level - ROOM, level + ROOM
        low[:, 2:], high[:, :2] = -np.inf, np.inf
        return planes.reshape(-1, 3), low.ravel(), high.ravel()

    def product_errors(self, x: Vector, dual: Vector) -> Vector:
        """Error of every product at a point, multiplied by the multipliers of its rows."""
        first, second, out = self.atoms.T
        price = np.abs(dual[self.first : self.first + self.rows]).reshape(-1, 4).sum(axis=1)
        errors: Vector = np.abs(x[out] - self.level * x[first] * x[second]) * price
        return errors


class Lines(NamedTuple):
    """Lines that bound a curve: low <= out + coefficient * ratio <= high.

    In the linear programme, `out` is the column of the curve's value, and `ratio` that of its
    argument, which is the logarithm of a ratio.
    """

    ratio: Any
    coefficient: Vector
    out: Any
    low: Vector
    high: Vector

    def joined(self, others: Lines) -> Lines:
        """These lines, followed by the others."""
        return Lines(*(np.concatenate(pair) for pair in zip(self, others, strict=True)))

    def add_to(self, solver: Any) -> None:
        """Add the lines as rows to the linear programme."""
        count = len(self.low)
        indices = np.stack([self.ratio, self.out], axis=1).ravel().astype(np.int32)
        data = np.stack([self.coefficient, np.ones(count)], axis=1).ravel()
        starts = 2 * np.arange(count, dtype=np.int32)
        solver.addRows(count, self.low, self.high, 2 * count, starts, indices, data)


class KnownExtents:
    """Least and largest value of every direction (log ratio) among known points."""

    def __init__(self, directions: Vector) -> None:
        self.ends = directions.copy(), directions.copy()

    def add(self, directions: Vector) -> None:
        """Include another point."""
        np.minimum(self.ends[0], directions, out=self.ends[0])
        np.maximum(self.ends[1], directions, out=self.ends[1])


WIDEST = 40.0
"""Widest range of an argument for which a chord is drawn; a wider chord gives no useful bound."""

ROUNDS = 3
"""Maximum number of rounds that add tangents per box; later boxes reuse them."""

TANGENT_GAIN = 2e-5
"""The rounds of tangents end once a round raises the bound by less than this."""

TANGENT_DISTANCES = (1e-5, 1e-3)
"""Least and greatest value of the distance from a curve at which a tangent is added."""

FINE = 0.01
"""Distance from a curve at which a tangent is added, as a share of the gap still to be closed. The
limits `TANGENT_DISTANCES` apply to it."""

PROVEN = 1e-6
"""A dual ray proves that a box has no design if its value is at least this, well above rounding
error."""

NEAR_END = 0.05
"""If a known point is this close to an end of a range (as a share of the range), that end cannot be
cut."""

LINES_PER_CURVE = 3
"""Number of lines per curve above which inactive tangents are deleted."""


class Bound(NamedTuple):
    """Lower bound on the objective's logarithm in a box, and where the relaxation is loose."""

    value: float
    atoms: Vector
    directions: Vector
    excess: Vector
    """For every curve, the distance between curve and solution on the side bounded by the chord."""
    price: Vector
    """For every chord, its multiplier in the linear programme."""
    product_errors: Vector
    """For every product, the error of its bounds, weighted with the multipliers of its rows."""
    slopes: Vector
    """Reduced cost of every column: increase of the objective per unit by which the column's value
    moves away from the end of its range at which the solution has it."""


class Bounding:
    """The relaxation as one linear programme that is solved again for every box.

    The columns are atoms (elementary positive quantities), directions (logarithms of ratios) and
    curves. The rows define directions and curves, state the limits, and bound every curve by
    straight lines: one chord and some tangents.
    """

    def __init__(self, layout: Layout, objective: Form) -> None:
        self.layout = layout
        curves = layout.curves
        composite = layout.plain < 0
        self.columns = layout.atoms + int(composite.sum())
        self.column = np.where(composite, layout.atoms + np.cumsum(composite) - 1, layout.plain)
        """Column of every output and direction. An output or direction that equals a single atom
        shares the atom's column."""
        self.out = self.column[:curves].astype(np.int32)
        self.direction_columns = self.column[curves:]
        self.ratio = self.direction_columns[layout.direction].astype(np.int32)
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
        self.missed = TANGENT_DISTANCES[1]

    def refine(self, gap: float) -> None:
        """Set the accuracy of the tangents by the gap that remains in the objective's logarithm."""
        self.missed = float(np.clip(FINE * gap, *TANGENT_DISTANCES))

    def _definitions(self) -> tuple[Any, Vector, Vector]:
        """Rows that define outputs and directions by atoms, and the constraint rows (each >= 0)."""
        layout = self.layout
        new = np.flatnonzero(layout.plain < 0)
        defined = np.concatenate([new, np.arange(len(layout.plain), len(layout.levels))])
        place = np.full(len(layout.levels), -1)
        place[defined] = np.arange(len(defined))
        entries = place[layout.form] >= 0
        rows = np.concatenate([place[layout.form[entries]], np.arange(len(new))])
        columns = np.concatenate([layout.atom[entries], self.column[new]])
        values = np.concatenate([layout.power[entries], np.full(len(new), -1.0)])
        matrix = sp.csr_matrix((values, (rows, columns)), shape=(len(defined), self.columns))
        level = -layout.levels[defined]
        high = level.copy()
        high[len(new) :] = np.inf
        return matrix, level, high

    def _solver(self) -> Any:
        """The linear programme without bounds and chords, which change with the box."""
        solver: Any = highspy.Highs()  # type: ignore[no-untyped-call]
        m = self.matrix
        for name, value in _OPTIONS.items():
            solver.setOptionValue(name, value)
        none, index = np.empty(0), np.empty(0, dtype=np.int32)
        ends = np.full(self.columns, FAR)
        solver.addCols(self.columns, self.cost, -ends, ends, 0, index, index, none)
        rows = m.indptr[:-1].astype(np.int32), m.indices.astype(np.int32), m.data
        solver.addRows(len(self.low), self.low, self.high, m.nnz, *rows)
        self.lines.add_to(solver)
        return solver

    def solve(self, box: Box) -> Bound | None:
        """Compute the bound of a box; None if its relaxation has no solution."""
        lower, upper = self.enter(box)
        solution = self._minimum(self.cost, lower, upper, rounds=ROUNDS)
        if solution is None:
            return None
        value, slopes, x, dual = solution
        row = len(self.low)
        return Bound(
            value + self.constant,
            x[: self.layout.atoms],
            x[self.direction_columns],
            np.maximum(-self._missed(x), 0.0),
            np.abs(dual[row : row + self.layout.curves]),
            self.products.product_errors(x, dual),
            slopes,
        )

    def trimmed(self, box: Box, bound: Bound, best: float) -> Box:
        """The part of a box that may contain a design as good as the best known design.

        A range with reduced cost d can be cut to the length gap / d, where gap is the difference
        between the best objective and the bound.
        """
        lower, upper = self._ends(box)
        gap = max(best - bound.value, 0.0) + ROOM
        with np.errstate(divide="ignore"):
            highest = lower + gap / np.maximum(bound.slopes, 0.0)
            lowest = upper + gap / np.minimum(bound.slopes, -0.0)
        lower, upper = np.maximum(lower, lowest - ROOM), np.minimum(upper, highest + ROOM)
        atoms = slice(0, self.layout.atoms)
        return Box(
            np.maximum(box.lower, lower[atoms]),
            np.minimum(box.upper, upper[atoms]),
            np.maximum(box.low, lower[self.direction_columns]),
            np.minimum(box.high, upper[self.direction_columns]),
        )

    def enter(self, box: Box) -> tuple[Vector, Vector]:
        """Load a box into the linear programme, and return the ranges of the columns."""
        self._purge()
        ends = self._columns(box)
        self._chords(box)
        return ends

    def _purge(self) -> None:
        """Delete inactive tangents if there are more lines than `LINES_PER_CURVE` permits."""
        first, count = len(self.low) + self.moving, len(self.lines.low)
        if count < LINES_PER_CURVE * self.moving:
            return
        status = self.solver.getBasis().row_status
        idle = [
            r for r in range(first, len(status)) if status[r] == highspy.HighsBasisStatus.kBasic
        ]
        if not idle:
            return
        self.solver.deleteRows(len(idle), np.array(idle, dtype=np.int32))
        active = np.ones(count, dtype=bool)
        active[np.array(idle) - len(self.low)] = False
        self.lines = Lines(*(part[active] for part in self.lines))

    def extent(
        self, direction: int, ends: tuple[Vector, Vector], known: KnownExtents
    ) -> tuple[float, float] | None:
        """Least and largest value of a direction in the loaded box; None if the box is empty.

        An end of the range that a known point nearly reaches is not searched. The points of the
        search are added to `known`.
        """
        column = self.direction_columns[direction]
        extent = [float(end[column]) for end in ends]
        tolerance = NEAR_END * (extent[1] - extent[0])
        cost = np.zeros(self.columns)
        for side, sign in enumerate((1.0, -1.0)):
            if 0 <= sign * (known.ends[side][direction] - extent[side]) <= tolerance:
                continue
            cost[column] = sign
            solution = self._minimum(cost, *ends, rounds=1)
            if solution is None:
                return None
            extent[side] = sign * solution[0]
            known.add(solution[2][self.direction_columns])
        return extent[0], extent[1]

    def _minimum(
        self, cost: Vector, lower: Vector, upper: Vector, *, rounds: int
    ) -> tuple[float, Vector, Vector, Vector] | None:
        """Minimise a linear function; return proven minimum, reduced costs, point, multipliers."""
        index = np.arange(self.columns, dtype=np.int32)
        self.solver.changeColsCost(self.columns, index, cost)
        previous = -np.inf
        for _ in range(rounds):
            self.solver.run()
            if self._empty(lower, upper):
                return None
            solution = self.solver.getSolution()
            x, dual = np.array(solution.col_value), np.array(solution.row_dual)
            value = float(cost @ x)
            if rounds == 1 or value - previous < TANGENT_GAIN or not self._tangents(x):
                break
            previous = value
        return *self._proven_minimum(cost, dual, lower, upper), x, dual

    def _empty(self, lower: Vector, upper: Vector) -> bool:
        """Whether multipliers prove that no point satisfies all rows of the linear programme."""
        if self.solver.getModelStatus() != highspy.HighsModelStatus.kInfeasible:
            return False
        _, has_ray, ray = self.solver.getDualRay()
        none = np.zeros(self.columns)
        return has_ray and self._proven_minimum(none, np.array(ray), lower, upper)[0] > PROVEN

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
        """Load the ranges of the columns and the planes that bound the products."""
        lower, upper = self._ends(box)
        index = np.arange(self.columns, dtype=np.int32)
        self.solver.changeColsBounds(self.columns, index, lower, upper)
        self._planes(lower, upper)
        return lower, upper

    def _planes(self, lower: Vector, upper: Vector) -> None:
        """Load the planes that bound the products, for these ranges of the columns."""
        products, first = self.products, self.products.first
        planes, low, high = products.planes(lower, upper)
        self.matrix.data[len(self.matrix.data) - planes.size :] = planes.ravel()
        rows = slice(first, first + products.rows)
        self.low[rows], self.high[rows] = low, high
        columns, values = products.columns.tolist(), planes.tolist()
        for row, (x, y, _), (x_factor, y_factor, _) in zip(
            range(first, first + products.rows), columns, values, strict=True
        ):
            self.solver.changeCoeff(row, x, x_factor)
            self.solver.changeCoeff(row, y, y_factor)
        index = np.arange(first, first + products.rows, dtype=np.int32)
        self.solver.changeRowsBounds(products.rows, index, low, high)

    def _chords(self, box: Box) -> None:
        """Replace all chords by the chords across this box."""
        layout, lines = self.layout, self.lines
        first, count = len(self.low), layout.curves
        low, high = layout.arguments(box.low, box.high)
        functions, width = layout.functions, high - low
        first_value, last_value = functions.value(low), functions.value(high)
        flat = width < 1e-9
        slope = np.where(flat, 0.0, (last_value - first_value) / np.where(flat, 1.0, width))
        level = first_value + slope * (layout.constant - low)
        tolerance = functions.room + np.where(flat, np.abs(last_value - first_value), 0.0)
        below, above = functions.secant_errors(low, high, slope)
        narrow = width <= WIDEST
        lines.coefficient[:count] = np.where(narrow, -slope * layout.factor, 0.0)
        lines.low[:count] = np.where(
            narrow & (functions.convex <= 0), level + below - tolerance, -np.inf
        )
        lines.high[:count] = np.where(
            narrow & (functions.convex >= 0), level + above + tolerance, np.inf
        )
        ratios = layout.ratios(box)
        link_lows, link_highs = (
            slice(count, count + len(ratios[0])),
            slice(count + len(ratios[0]), self.moving),
        )
        lines.coefficient[link_lows], lines.low[link_lows] = -ratios[0], 0.0
        lines.coefficient[link_highs], lines.high[link_highs] = -ratios[1], 0.0
        count = self.moving
        index = first + np.arange(count, dtype=np.int32)
        columns, values = lines.ratio[:count].tolist(), lines.coefficient[:count].tolist()
        for row, column, value in zip(index.tolist(), columns, values, strict=True):
            self.solver.changeCoeff(row, column, value)
        self.solver.changeRowsBounds(count, index, lines.low[:count], lines.high[:count])

    def _argument(self, x: Vector) -> Vector:
        argument: Vector = self.layout.factor * x[self.ratio] + self.layout.constant
        return argument

    def _missed(self, x: Vector) -> Vector:
        """Distance of a point from every curve; positive where a new tangent excludes the point."""
        functions = self.layout.functions
        off = functions.value(self._argument(x)) - x[self.out]
        return np.where(functions.convex == 0, -np.abs(off), functions.convex * off)

    def add_first_tangents(self, box: Box) -> None:
        """Add a tangent at the middle of the range of every convex or concave curve."""
        low, high = self.layout.arguments(box.low, box.high)
        curves = np.flatnonzero(self.layout.functions.convex)
        self._append(self._touching((low + high) / 2, curves))

    def _append(self, lines: Lines) -> None:
        lines.add_to(self.solver)
        self.lines = self.lines.joined(lines)

    def _tangents(self, x: Vector) -> bool:
        """Add tangents to the curves that the point violates; return whether any were added."""
        curves = np.flatnonzero(self._missed(x) > self.missed)
        if len(curves):
            self._append(self._touching(self._argument(x), curves))
        return len(curves) > 0

    def _touching(self, t: Vector, curves: Any) -> Lines:
        """Tangents of the given curves at the arguments `t`, one for every curve."""
        layout, functions = self.layout, self.layout.functions
        slope = functions.slope(t)
        level = (
            functions.value(t) - functions.convex * functions.room + slope * (layout.constant - t)
        )
        level, convex = level[curves], functions.convex[curves] > 0
        return Lines(
            self.ratio[curves],
            (-slope * layout.factor)[curves],
            self.out[curves],
            np.where(convex, level, -np.inf),
            np.where(convex, np.inf, level),
        )

    def _proven_minimum(
        self, cost: Vector, dual: Vector, lower: Vector, upper: Vector
    ) -> tuple[float, Vector]:
        """Lower bound on the cost, proven by the multipliers, and the reduced costs."""
        count, lines = len(self.low), self.lines
        dual = dual[: count + len(lines.low)]
        low, high = (
            np.concatenate([fixed, movable])[: len(dual)]
            for fixed, movable in ((self.low, lines.low), (self.high, lines.high))
        )
        ends = np.where(dual > 0, low, high)
        dual = np.where(np.isfinite(ends), dual, 0.0)
        ends = np.where(np.isfinite(ends), ends, 0.0)
        line_dual = dual[count:]
        rows = slice(0, len(line_dual))
        slopes = cost - self.matrix.T @ dual[:count]
        np.add.at(slopes, lines.ratio[rows], -line_dual * lines.coefficient[rows])
        np.add.at(slopes, lines.out[rows], -line_dual)
        return float(dual @ ends + np.minimum(slopes * lower, slopes * upper).sum()), slopes


_OPTIONS = {
    "output_flag": False,
    "presolve": "off",
    "simplex_strategy": 0,
    "simplex_dual_edge_weight_strategy": 1,  # Devex pricing needs no update after a change of rows
    "primal_feasibility_tolerance": 1e-7,
    "dual_feasibility_tolerance": 1e-9,
    "threads": 1,
    "simplex_scale_strategy": 0,
}
SAMPLES = 1001
"""Number of sample points across the range of an argument."""
CAUTION = 1.5
"""Safety factor on the second derivative estimated from the samples."""
_LOGIC = ("lt", "le", "and", "or", "not")


class Leads:
    """Finds the lead of a value: a single other value that alone determines it in every design."""

    def __init__(self) -> None:
        self._known: dict[int, Symbol] = {}

    def of(self, node: Symbol) -> Symbol:
        """The lead of a value: the value that alone determines it (see `Leads`)."""
        if node.index not in self._known:
            operand_leads = {self.of(operand) for operand in node.operands}
            self._known[node.index] = operand_leads.pop() if len(operand_leads) == 1 else node
        return self._known[node.index]


def function(nodes: Sequence[Symbol], lead: Symbol) -> Callable[[Vector], Vector]:
    """Function from the logarithms (n,) of a lead to the values (nodes, n) that it determines."""
    code = vectorised("lone", "value", {}, nodes, known={lead: "value"})

    def values(t: Vector) -> Vector:
        with np.errstate(all="ignore"):
            rows = code(np.exp(t))
        return np.stack([np.broadcast_to(np.asarray(row, dtype=float), t.shape) for row in rows])

    return values


def samples(lead: Symbol) -> Vector:
    """Equally spaced logarithms across the range of a positive value."""
    low, high = np.log(lead.bounds)
    return np.linspace(low, high, SAMPLES)


def ranges(nodes: Sequence[Symbol]) -> dict[Symbol, tuple[float, float]]:
    """Sampled ranges, if finite, of the values that depend on one positive value alone."""
    leads = Leads()
    groups: dict[Symbol, list[Symbol]] = {}
    for node in nodes:
        lead = leads.of(node)
        if lead is node or node.op in _LOGIC:
            continue
        if 0 < lead.bounds[0] < lead.bounds[1] < np.inf:
            groups.setdefault(lead, []).append(node)
    result = {}
    for lead, group in groups.items():
        for node, row in zip(group, function(group, lead)(samples(lead)), strict=True):
            if np.isfinite(row).all():
                room = CAUTION * float(np.abs(np.diff(row, 2)).max()) / 8
                result[node] = (float(row.min()) - room, float(row.max()) + room)
    return result


WIDE = 0.3
"""A sum is also stated with the quantities themselves, not only with their logarithms, if the log
ratio of its two terms varies by at least this."""


class _PlainAtoms:
    """Adds atoms for values of monomials, of which the relaxation otherwise has only logarithms."""

    def __init__(self, relaxation: Relaxation) -> None:
        self.relaxation = relaxation
        self.known: dict[Powers, int] = {}
        self.tops: dict[int, float] = {}
        self.tables = {
            curve.out.powers[0][0]: curve
            for curve in relaxation.curves
            if isinstance(curve.kind, SampledFunction)
        }

    def width(self, form: Form) -> float:
        """Length of the range of a monomial's logarithm."""
        low, high = self.relaxation.reach(form)
        return high - low

    def atom(self, powers: Powers) -> int:
        """Index of the unknown for the value of a monomial, not its logarithm; at most 1."""
        if powers not in self.known:
            relaxation, form = self.relaxation, Form(0.0, powers)
            low, high = relaxation.reach(form)
            argument = Form(-high, powers)
            relaxation.lower.append(math.exp(low - high))
            relaxation.upper.append(1.0)
            relaxation.makers.append(lambda y: math.exp(argument.at(y)))
            self.known[powers] = number = len(relaxation.lower) - 1
            self.tops[number] = high
            relaxation.curves.append(AtomFunction("exp", argument, Form(0.0, ((number, 1.0),))))
            self._tie(form, number)
        return self.known[powers]

    def term(self, form: Form, scale: float) -> Form:
        """A monomial divided by e^scale, as a multiple of the monomial's own atom (see `atom`)."""
        if not form.powers:
            return Form(math.exp(form.constant - scale))
        number = self.atom(form.powers)
        return Form(0.0, ((number, math.exp(form.constant + self.tops[number] - scale)),))

    def _tie(self, form: Form, number: int) -> None:
        """Relate the atom of a monomial to the atoms of its two factors.

        If the monomial is a sampled function of one other atom, relate it to that atom.
        """
        lone = [i for i, power in form.powers if power == 1.0]
        if not lone:
            return
        widest = max(lone, key=lambda i: self.width(Form(0.0, ((i, 1.0),))))
        base = Form(0.0, ((widest, 1.0),))
        cofactor = form - base
        if cofactor.powers:
            base_atom, cofactor_atom = self.atom(base.powers), self.atom(cofactor.powers)
            level = self.tops[base_atom] + self.tops[cofactor_atom] - self.tops[number]
            self.relaxation.products.append(Product(number, base_atom, cofactor_atom, level))
        elif widest in self.tables:
            curve = self.tables[widest]
            argument_atom = self.atom(curve.argument.powers)
            level = curve.argument.constant + self.tops[argument_atom] - self.tops[number]
            self.relaxation.links.append(Link(number, argument_atom, level, curve))


def add_plain_sums(relaxation: Relaxation) -> None:
    """State sums whose terms vary widely a second time, with values instead of logarithms."""
    plain = _PlainAtoms(relaxation)
    for whole, part, remainder in list(relaxation.splits):
        if plain.width(part - remainder) < WIDE:
            continue
        scale = relaxation.reach(whole)[1]
        total = plain.term(whole, scale)
        sums = plain.term(part, scale) + plain.term(remainder, scale)
        relaxation.rows += [ConstraintRow(total, sums), ConstraintRow(sums, total)]
