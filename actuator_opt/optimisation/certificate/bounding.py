"""The convex problem of one box: the least objective of its relaxation.

A linear programme: the convex side of every curve is a set of tangents, added where the solution
misses the curve [Kelley1960] and good in every box; the other side is the chord over the box. The
bound is computed from the multipliers alone, so that it holds whatever the solver's tolerances
[Neumaier2004].
"""

from __future__ import annotations

from typing import Any, NamedTuple

import highspy
import numpy as np
import scipy.sparse as sp

from ..problem import Vector
from .box import Box, Layout
from .shapes import SHAPES
from .signomial import Form

FAR = 200.0
"""Largest logarithm of an atom or a ratio; e^200 is beyond any quantity."""

WIDEST = 40.0
"""Widest range of an argument that gets a chord; beyond it the chord says nothing."""

ROUNDS = 12
"""Most rounds of tangents in one box."""

MISSED = 1e-6
"""Distance from a curve at which a tangent is added."""

class Bound(NamedTuple):
    """Least objective of a box (its logarithm), and where the relaxation is loose there."""

    value: float
    atoms: Vector
    directions: Vector
    excess: Vector
    """By how much every curve is missed on the side of its chord."""
    price: Vector
    """Multiplier of every chord."""


class Bounding:
    """The relaxation as one linear programme, solved again for every box.

    Columns: atoms, directions, curves. Rows: definitions of directions and curves, limits; then
    lines, each between a direction and a curve: one chord per curve, and the tangents.
    """

    def __init__(self, layout: Layout, objective: Form) -> None:
        self.layout = layout
        found = layout.relaxation
        self.atoms, self.ratios = len(found.lower), len(layout.directions)
        self.curves = len(found.curves)
        self.columns = self.atoms + self.ratios + self.curves
        self.cost = np.zeros(self.columns)
        for i, power in objective.powers:
            self.cost[i] = power
        self.constant = objective.constant
        self.shapes = [SHAPES[curve.kind] for curve in found.curves]
        self.convex = np.array([shape.convex for shape in self.shapes])
        self.ratio = np.array([self.atoms + place[0] for place in layout.arguments], dtype=np.int32)
        self.out = self.atoms + self.ratios + np.arange(self.curves, dtype=np.int32)
        self.matrix, self.low, self.high = self._definitions()
        none = np.zeros(self.curves)
        self.lines = _Lines(self.ratio, none, self.out, none - np.inf, none + np.inf)
        self.solver = self._solver()

    def _definitions(self) -> tuple[Any, Vector, Vector]:
        parts: list[tuple[dict[int, float], float, float]] = []
        for k, key in enumerate(self.layout.directions):
            parts.append((dict(key) | {self.atoms + k: -1.0}, 0.0, 0.0))
        for column, curve in zip(self.out.tolist(), self.layout.relaxation.curves, strict=True):
            constant = -curve.out.constant
            parts.append((dict(curve.out.powers) | {column: -1.0}, constant, constant))
        for row in self.layout.relaxation.rows:
            form = row.high - row.low
            parts.append((dict(form.powers), -form.constant, np.inf))
        matrix = sp.lil_matrix((len(parts), self.columns))
        for r, (entries, _, _) in enumerate(parts):
            for column, value in entries.items():
                matrix[r, column] = value
        low, high = (np.array([part[i] for part in parts]) for i in (1, 2))
        return sp.csr_matrix(matrix), low, high

    def _solver(self) -> highspy.Highs:
        """The programme without bounds and chords, which follow the box."""
        solver, m = highspy.Highs(), self.matrix
        for name, value in _OPTIONS.items():
            solver.setOptionValue(name, value)
        none, index = np.empty(0), np.empty(0, dtype=np.int32)
        ends = np.full(self.columns, FAR)
        solver.addCols(self.columns, self.cost, -ends, ends, 0, index, index, none)
        rows = m.indptr[:-1].astype(np.int32), m.indices.astype(np.int32), m.data
        solver.addRows(len(self.low), self.low, self.high, m.nnz, *rows)
        _add(solver, self.lines)
        return solver

    def solve(self, box: Box) -> Bound | None:
        """The bound of a box; None where the relaxation has no point."""
        lower, upper = self._columns(box)
        self._chords(box)
        for _ in range(ROUNDS):
            self.solver.run()
            if self.solver.getModelStatus() == highspy.HighsModelStatus.kInfeasible:
                return None
            solution = self.solver.getSolution()
            x, dual = np.array(solution.col_value), np.array(solution.row_dual)
            missed = self._missed(x)
            more = self._tangents(x, missed)
            if more is None:
                break
            _add(self.solver, more)
            self.lines = self.lines.joined(more)
        first = len(self.low)
        return Bound(
            self._safe(dual, lower, upper),
            x[: self.atoms],
            x[self.atoms : self.atoms + self.ratios],
            np.maximum(-missed, 0.0),
            np.abs(dual[first : first + self.curves]),
        )

    def _columns(self, box: Box) -> tuple[Vector, Vector]:
        """Ranges of all columns in a box."""
        outs = [box.range(curve.out) for curve in self.layout.relaxation.curves]
        lower = np.concatenate([box.lower, box.low, [low for low, _ in outs]])
        upper = np.concatenate([box.upper, box.high, [high for _, high in outs]])
        lower, upper = np.clip(lower, -FAR, FAR), np.clip(upper, -FAR, FAR)
        index = np.arange(self.columns, dtype=np.int32)
        self.solver.changeColsBounds(self.columns, index, lower, upper)
        return lower, upper

    def _chords(self, box: Box) -> None:
        """Put the chords over a box in place of those of the last one."""
        first, count, lines = len(self.low), self.curves, self.lines
        for k, (place, shape) in enumerate(zip(self.layout.arguments, self.shapes, strict=True)):
            low, high = box.argument(*place)
            slope, ends = 0.0, (-np.inf, np.inf)
            if high - low <= WIDEST:
                ends = (shape.value(low), shape.value(high))
                if high - low > 1e-12:
                    slope = (ends[1] - ends[0]) / (high - low)
                    level = ends[0] + slope * (place[2] - low)
                    ends = (level, level)
            lines.coefficient[k] = -slope * place[1]
            lines.low[k] = -np.inf if shape.convex else min(ends)
            lines.high[k] = max(ends) if shape.convex else np.inf
            self.solver.changeCoeff(first + k, int(self.ratio[k]), lines.coefficient[k])
        index = first + np.arange(count, dtype=np.int32)
        self.solver.changeRowsBounds(count, index, lines.low[:count], lines.high[:count])

    def _missed(self, x: Vector) -> Vector:
        """By how much every curve is missed, positive on the side of its tangents."""
        values = [
            shape.value(factor * x[self.atoms + number] + constant)
            for shape, (number, factor, constant) in zip(
                self.shapes, self.layout.arguments, strict=True
            )
        ]
        return np.where(self.convex, 1.0, -1.0) * (np.array(values) - x[self.out])

    def _tangents(self, x: Vector, missed: Vector) -> _Lines | None:
        """Tangents where the point lies on their side of a curve."""
        some = np.flatnonzero(missed > MISSED)
        if not len(some):
            return None
        coefficients, levels = [], []
        for k in some:
            number, factor, constant = self.layout.arguments[k]
            t, shape = factor * x[self.atoms + number] + constant, self.shapes[k]
            coefficients.append(-shape.slope(t) * factor)
            levels.append(shape.value(t) + shape.slope(t) * (constant - t))
        level, convex = np.array(levels), self.convex[some]
        return _Lines(
            self.ratio[some],
            np.array(coefficients),
            self.out[some],
            np.where(convex, level, -np.inf),
            np.where(convex, np.inf, level),
        )

    def _safe(self, dual: Vector, lower: Vector, upper: Vector) -> float:
        """Least objective that the multipliers prove: what rows and bounds contribute."""
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
        rest = self.cost - self.matrix.T @ dual[:count]
        np.add.at(rest, lines.ratio[some], -own * lines.coefficient[some])
        np.add.at(rest, lines.out[some], -own)
        return float(dual @ ends + np.minimum(rest * lower, rest * upper).sum()) + self.constant


_OPTIONS = {
    "output_flag": False,
    "presolve": "off",
    "primal_feasibility_tolerance": 1e-7,
    "dual_feasibility_tolerance": 1e-9,
    "threads": 1,
}


class _Lines(NamedTuple):
    """low <= out + coefficient * ratio <= high, by columns of curve and direction."""

    ratio: Any
    coefficient: Vector
    out: Any
    low: Vector
    high: Vector

    def joined(self, more: _Lines) -> _Lines:
        return _Lines(*(np.concatenate(pair) for pair in zip(self, more, strict=True)))


def _add(solver: highspy.Highs, lines: _Lines) -> None:
    count = len(lines.low)
    indices = np.stack([lines.ratio, lines.out], axis=1).ravel().astype(np.int32)
    data = np.stack([lines.coefficient, np.ones(count)], axis=1).ravel()
    starts = 2 * np.arange(count, dtype=np.int32)
    solver.addRows(count, lines.low, lines.high, 2 * count, starts, indices, data)
