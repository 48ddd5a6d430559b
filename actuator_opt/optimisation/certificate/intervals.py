"""Interval constraint propagation: bounds of traced values over all designs that meet the limits.

The propagation runs forwards from operands to results, and backwards from limits to variables
[Benhamou1999]. If an expression chooses between a value and NaN, the value is taken, because a
design whose value is NaN meets no requirement. A box is a part of the design space, given by ranges
of atoms (elementary quantities) and of log ratios.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from ...base.dataclass import dataclass
from ...base.symbolic import Symbol
from ...base.symbolic.bounds import Bounds, at_end, bounds, bounds_of
from ..problem import Vector
from .relaxation import (
    FAR,
    ROUNDING,
    CurveFunctions,
    Form,
    Powers,
    Relaxation,
    SampledFunction,
    Signomial,
    Tables,
)

ROUNDS = 30
"""Maximum number of passes through all values."""

WORTH = 1e-3
"""A further pass follows only if a bound improved by at least this relative amount."""

LARGEST = 80
"""Maximum number of terms when a sum is expanded."""

SLACK = 1e-9
"""Relative widening of every bound, for rounding."""


class Empty(Exception):
    """Raised if no design in the box meets the limits, because some range is empty."""


def tighten(nodes: Sequence[Symbol], facts: Sequence[tuple[Any, Any]] = ()) -> None:
    """Tighten the bounds of traced values in place.

    Parameters
    ----------
    nodes : the values, operands before results
    facts : pairs of values; the first value of each is at least the second

    Raises
    ------
    Empty
        the range of some value is empty
    """
    sums = cancelling(nodes)
    for _ in range(ROUNDS):
        gained = False
        for node in nodes:
            if node.operands:
                gained |= narrow(node, _forward(node))
            if node in sums:
                gained |= narrow(node, _of_terms(sums[node], node.graph.nodes))
        for larger, smaller in facts:
            gained |= narrow(larger, (bounds_of(smaller)[0], math.inf))
            gained |= narrow(smaller, (-math.inf, bounds_of(larger)[1]))
        for node in reversed(nodes):
            gained |= _backward(node)
        if not gained:
            return


def cancelling(nodes: Sequence[Symbol]) -> dict[Symbol, Signomial]:
    """Sums in which terms cancel when expanded: bounds from their operands are too wide."""
    signomials: dict[int, Signomial | None] = {}

    def expanded(value: Any) -> Signomial | None:
        if isinstance(value, Symbol):
            return signomials[value.index]
        return Signomial.number(value) if math.isfinite(value) else None

    sums = {}
    for node in nodes:
        parts = [expanded(arg) for arg in node.args] if node.op in _ALGEBRA else [None]
        signomial = None if None in parts else _ALGEBRA[node.op](*parts)
        if signomial is not None and len(signomial.terms) <= LARGEST:
            sizes = sum(part.size for part in parts if part is not None)
            if node.op in ("add", "sub") and signomial.size < (1 - 1e-9) * sizes:
                sums[node] = signomial
            signomials[node.index] = signomial
        else:
            signomials[node.index] = Signomial({((node.index, 1.0),): 1.0})
    return sums


def _quotient(first: Signomial, second: Signomial) -> Signomial | None:
    divisor = second.single
    if divisor is None:
        return None
    sign, form = divisor
    return first.times(Signomial.monomial(sign, Form(0.0) - form))


def _product(first: Signomial, second: Signomial) -> Signomial | None:
    if len(first.terms) * len(second.terms) > 2 * LARGEST:
        return None
    return first.times(second)


_ALGEBRA: dict[str, Callable[..., Signomial | None]] = {
    "add": lambda a, b: a.plus(b),
    "sub": lambda a, b: a.plus(b, -1.0),
    "neg": lambda a: Signomial({}).plus(a, -1.0),
    "mul": _product,
    "div": _quotient,
}


def _of_terms(parts: Signomial, nodes: Sequence[Symbol]) -> Bounds:
    """Bounds on a sum whose terms are products of values."""
    low = high = 0.0
    for powers, factor in parts.terms.items():
        term_low = term_high = 1.0
        for index, power in powers:
            a, b = nodes[index].bounds
            if a < 0 or (power < 0 and a <= 0):
                return -math.inf, math.inf
            ends = (a**power, b**power) if b < math.inf else (0.0, math.inf)
            term_low, term_high = term_low * min(ends), term_high * max(ends)
        ends = (factor * term_low, factor * term_high)
        low, high = low + min(ends), high + max(ends)
    if low != low or high != high:
        return -math.inf, math.inf
    return low, high


def narrow(value: Any, ends: Bounds) -> bool:
    """Narrow the bounds of a value; return whether the gain justifies another pass.

    Raises
    ------
    Empty
        the range is empty
    """
    low, high = ends
    if not isinstance(value, Symbol):
        return False
    old_low, old_high = value.bounds
    low = low - SLACK * abs(low) if low > old_low else old_low
    high = high + SLACK * abs(high) if high < old_high else old_high
    if low > high:
        raise Empty
    value.bounds = (low, high)
    return _much(old_low, low) or _much(old_high, high)


def _much(old: float, new: float) -> bool:
    return old != new and (math.isinf(old) or abs(new - old) > WORTH * abs(old))


def decided(condition: Any) -> bool | None:
    """True if a condition holds for all designs, False if for none, None if not known."""
    if not isinstance(condition, Symbol):
        return bool(condition)
    args = condition.args
    if condition.op in ("lt", "le"):
        (a, b), (c, d) = bounds_of(args[0]), bounds_of(args[1])
        if b < c:
            return True
        return False if a > d else None
    if condition.op == "not":
        inner = decided(args[0])
        return None if inner is None else not inner
    sides = [decided(arg) for arg in args]
    settles = condition.op == "or"
    if settles in sides:
        return settles
    return None if None in sides else not settles


def branch(node: Symbol) -> Any:
    """The branch of a conditional that all designs take, except those with NaN; None if unknown.

    If one branch is NaN itself, the other branch is the result.
    """
    condition, yes, no = node.args
    if _is_nan(yes):
        return no
    if _is_nan(no):
        return yes
    decision = decided(condition)
    return None if decision is None else (yes if decision else no)


def extreme(node: Symbol) -> str | None:
    """The word "max" or "min" if a conditional takes its larger or smaller branch; else None."""
    condition, yes, no = node.args
    if getattr(condition, "op", None) not in ("lt", "le"):
        return None
    smaller, larger = condition.args
    if same(smaller, no) and same(larger, yes):
        return "max"
    return "min" if same(smaller, yes) and same(larger, no) else None


def same(first: Any, second: Any) -> bool:
    """Whether two values are identical: the same symbol, or equal numbers."""
    if first is second:
        return True
    return isinstance(first, float) and isinstance(second, float) and first == second


def _is_nan(value: Any) -> bool:
    return isinstance(value, float) and math.isnan(value)


def _forward(node: Symbol) -> Bounds:
    if node.op == "where":
        choice = branch(node)
        if choice is not None:
            return bounds_of(choice)
    if node.op in ("lt", "le", "and", "or", "not", "variable", "flag"):
        return node.bounds
    if node.op == "sub":
        return _difference(node)
    return bounds(node.op, node.args)


def _difference(node: Symbol) -> Bounds:
    """Bounds on a difference.

    If it is a difference of squares a^2 - b^2 and a - b is also a traced value, the bounds of
    (a - b)(a + b) are used too.
    """
    low, high = bounds("sub", node.args)
    first, second = (_root_of(arg) for arg in node.args)
    if first is not None and second is not None:
        difference = node.graph.known.get(("sub", ("#", first.index), ("#", second.index)))
        if difference is not None:
            total = first.bounds[0] + second.bounds[0], first.bounds[1] + second.bounds[1]
            ends = [a * b for a in difference.bounds for b in total]
            return max(low, min(ends)), min(high, max(ends))
    return low, high


def _root_of(value: Any) -> Symbol | None:
    """The operand x if the value is x * x; else None."""
    if isinstance(value, Symbol) and value.op == "mul" and value.args[0] is value.args[1]:
        root: Symbol = value.args[0]
        return root
    return None


def _backward(node: Symbol) -> bool:
    """Narrow the operands of a value, using the bounds of the value."""
    rule = _BACKWARDS.get(node.op)
    return False if rule is None else rule(node)


def _add(node: Symbol) -> bool:
    a, b = node.args
    return narrow(a, _rounded("sub", node, b)) | narrow(b, _rounded("sub", node, a))


def _sub(node: Symbol) -> bool:
    a, b = node.args
    return narrow(a, _rounded("add", node, b)) | narrow(b, _rounded("sub", a, node))


def _rounded(op: str, first: Any, second: Any) -> Bounds:
    """Bounds on a sum or difference, widened by the rounding error of its operands."""
    low, high = bounds(op, (first, second))
    sizes = [abs(end) for end in (*bounds_of(first), *bounds_of(second)) if math.isfinite(end)]
    room = ROUNDING * max(sizes, default=0.0)
    return low - room, high + room


def _mul(node: Symbol) -> bool:
    a, b = node.args
    if a is b:
        high = math.sqrt(max(node.bounds[1], 0.0))
        low = math.sqrt(max(node.bounds[0], 0.0)) if a.bounds[0] >= 0 else -high
        return narrow(a, (low, high))
    gained = False
    for factor, divisor in ((a, b), (b, a)):
        if bounds_of(divisor)[0] > 0:
            gained |= narrow(factor, bounds("div", (node, divisor)))
    return gained


def _div(node: Symbol) -> bool:
    a, b = node.args
    gained = narrow(a, bounds("mul", (node, b)))
    (low, high), (quotient_low, quotient_high) = bounds_of(a), node.bounds
    if low > 0 and quotient_low > 0:
        gained |= narrow(
            b, (low / quotient_high if quotient_high < math.inf else 0.0, high / quotient_low)
        )
    return gained


def _root(node: Symbol) -> bool:
    low, high = node.bounds
    return narrow(node.args[0], (max(low, 0.0) ** 2, high * high))


def _power(node: Symbol) -> bool:
    base, exponent = node.args
    if not bounds_of(base)[0] >= 0:
        return False
    low, high = (max(end, 0.0) for end in node.bounds)
    if exponent < 0:
        low, high = high, low
    ends = [at_end(lambda x: x ** (1 / exponent), end) for end in (low, high)]
    return narrow(base, (ends[0], ends[1]))


def _inverse(function: Callable[[float], float]) -> Callable[[Symbol], bool]:
    def rule(node: Symbol) -> bool:
        low, high = (at_end(function, end) for end in node.bounds)
        return narrow(node.args[0], (low, high))

    return rule


def _neg(node: Symbol) -> bool:
    low, high = node.bounds
    return narrow(node.args[0], (-high, -low))


def _where(node: Symbol) -> bool:
    condition, yes, no = node.args
    choice = branch(node)
    if choice is not None:
        return narrow(choice, node.bounds) | _impose(condition, truth=choice is yes)
    low, high = node.bounds
    kind = extreme(node)
    if kind == "max":
        return narrow(yes, (-math.inf, high)) | narrow(no, (-math.inf, high))
    if kind == "min":
        return narrow(yes, (low, math.inf)) | narrow(no, (low, math.inf))
    return False


def _impose(condition: Any, *, truth: bool) -> bool:
    """Narrow the operands of a condition that is known to be true or known to be false."""
    if not isinstance(condition, Symbol):
        return False
    if condition.op == "not":
        return _impose(condition.args[0], truth=not truth)
    if condition.op in ("and", "or"):
        if truth != (condition.op == "and"):
            return False
        gains = [_impose(arg, truth=truth) for arg in condition.args]
        return any(gains)
    smaller, larger = condition.args if truth else reversed(condition.args)
    gained = narrow(smaller, (-math.inf, bounds_of(larger)[1]))
    return narrow(larger, (bounds_of(smaller)[0], math.inf)) | gained


_BACKWARDS: dict[str, Callable[[Symbol], bool]] = {
    "add": _add,
    "sub": _sub,
    "mul": _mul,
    "div": _div,
    "neg": _neg,
    "where": _where,
    "sqrt": _root,
    "pow": _power,
    "exp": _inverse(math.log),
    "log": _inverse(math.exp),
    "expm1": _inverse(math.log1p),
    "log1p": _inverse(math.expm1),
}


BOX_ROUNDS = 20
"""Maximum number of propagation passes in one box."""


GAIN = 0.01
"""A further pass follows only if a pass cut at least this share of the summed ranges."""


ROOM = 1e-9
"""Tolerance for rounding, at both ends of a range of logarithms."""


CROSSED = 1e-8
"""A box is proven empty if the lower end of a range exceeds the upper end by this much."""


def _lone(form: Form) -> int:
    """Number of the atom if the monomial of the form is that atom alone; else -1."""
    lone = form.constant == 0 and len(form.powers) == 1 and form.powers[0][1] == 1.0
    return form.powers[0][0] if lone else -1


class Layout:
    """A relaxation as arrays.

    A direction is a log ratio, such as log(t/r). All curves that depend on powers of one ratio
    share its direction. The largest exponent is scaled to 1, so the direction's range is at most
    the sum of the ranges of its atoms. A form is an affine function of the atoms' logarithms. Forms
    are stored in this order: outputs of curves, directions, constraint rows (each >= 0).
    """

    def __init__(self, relaxation: Relaxation) -> None:
        self.relaxation = relaxation
        self.curves, self.atoms = len(relaxation.curves), len(relaxation.lower)
        self.functions = CurveFunctions([curve.kind for curve in relaxation.curves])
        numbers: dict[Powers, int] = {}
        places = []
        for curve in relaxation.curves:
            powers = curve.argument.powers
            factor = max((p for _, p in powers), key=abs)
            key = tuple((i, round(p / factor, 12)) for i, p in powers)
            number = numbers.setdefault(key, len(numbers))
            places.append((number, factor, curve.argument.constant))
        self.links = relaxation.links
        self._of_curve = {id(curve): k for k, curve in enumerate(relaxation.curves)}
        self.directions = len(numbers)
        self.direction = np.array([place[0] for place in places], dtype=np.intp)
        self.factor = np.array([place[1] for place in places])
        self.constant = np.array([place[2] for place in places])
        forms = [curve.out for curve in relaxation.curves]
        forms += [Form(0.0, key) for key in numbers]
        self.plain = np.array([_lone(form) for form in forms], dtype=np.intp)
        forms += [row.high - row.low for row in relaxation.rows]
        self.levels = np.array([form.constant for form in forms])
        entries = [(k, i, power) for k, form in enumerate(forms) for i, power in form.powers]
        self.form = np.array([entry[0] for entry in entries], dtype=np.intp)
        self.atom = np.array([entry[1] for entry in entries], dtype=np.intp)
        self.power = np.array([entry[2] for entry in entries])

    @cached_property
    def factors(self) -> tuple[np.ndarray, np.ndarray]:
        """For every product, the numbers of the directions (log ratios) of its two factors."""
        direction_of = {
            curve.out.powers[0][0]: int(number)
            for curve, number in zip(self.relaxation.curves, self.direction, strict=True)
            if curve.kind == "exp" and len(curve.out.powers) == 1
        }
        pairs = [
            (direction_of[product.first], direction_of[product.second])
            for product in self.relaxation.products
        ]
        first, second = np.array(pairs, dtype=np.intp).reshape(-1, 2).T
        return first, second

    @cached_property
    def _linked(self) -> tuple[Tables, np.ndarray, Vector]:
        """For every `Link`: its table, the number of its curve, the log of its constant factor."""
        number = np.array([self._of_curve[id(link.curve)] for link in self.links])
        kinds = [link.curve.kind for link in self.links]
        tables = Tables([kind for kind in kinds if isinstance(kind, SampledFunction)])
        return tables, number, np.array([link.level for link in self.links])

    def ratios(self, box: Box) -> tuple[Vector, Vector]:
        """Least and largest ratio out/base of the two atoms of every `Link` within a box."""
        if not self.links:
            return np.empty(0), np.empty(0)
        tables, number, constant = self._linked
        lows, highs = (ends[number] for ends in self.arguments(box.low, box.high))
        deviation = tables.secant_errors(lows, highs, np.ones(len(number)), tables.rows)
        start = constant + tables.value(lows) - lows
        return np.exp(start + deviation[0] - tables.room), np.exp(
            start + deviation[1] + tables.room
        )

    @cached_property
    def parts(self) -> tuple[slice, slice, slice]:
        """Slices of the list of forms: curve outputs, directions (log ratios), constraint rows."""
        outputs_end, directions_end = self.curves, self.curves + self.directions
        return (
            slice(0, outputs_end),
            slice(outputs_end, directions_end),
            slice(directions_end, len(self.levels)),
        )

    def arguments(self, low: Vector, high: Vector) -> tuple[Vector, Vector]:
        """Ranges of the curves' arguments, from the ranges of the directions (log ratios)."""
        ends = (
            self.factor * low[self.direction] + self.constant,
            self.factor * high[self.direction] + self.constant,
        )
        return np.minimum(*ends), np.maximum(*ends)

    def reach(self, lower: Vector, upper: Vector) -> tuple[Vector, Vector, Vector, Vector]:
        """Ranges of all forms and of their terms, for given ranges of the atoms' logarithms."""
        ends = self.power * lower[self.atom], self.power * upper[self.atom]
        term_low, term_high = np.minimum(*ends), np.maximum(*ends)
        count = len(self.levels)
        low: Vector = self.levels + np.bincount(self.form, term_low, count)
        high: Vector = self.levels + np.bincount(self.form, term_high, count)
        return low, high, term_low, term_high


@dataclass(frozen=True)
class Box:
    """Part of the design space: ranges of directions (log ratios) and of the atoms' logarithms."""

    lower: Vector
    upper: Vector
    low: Vector
    high: Vector

    @classmethod
    def whole(cls, layout: Layout) -> Box:
        """The whole design space: the bounds of the traced values."""
        relaxation = layout.relaxation
        none = np.zeros(layout.directions)
        lower, upper = (np.clip(ends, -FAR, FAR) for ends in (relaxation.lower, relaxation.upper))
        return cls(lower, upper, none - FAR, none + FAR)

    def split(self, direction: int, at: float) -> tuple[Box, Box]:
        """The two parts of the box, below and above a value of a direction (log ratio)."""
        return self.cut(direction, high=at), self.cut(direction, low=at)

    def cut(self, direction: int, *, low: float = -FAR, high: float = FAR) -> Box:
        """The part of the box between two values of a direction (log ratio)."""
        lows, highs = self.low.copy(), self.high.copy()
        lows[direction] = max(lows[direction], low)
        highs[direction] = min(highs[direction], high)
        return replace(self, low=lows, high=highs)

    def tightened(self, layout: Layout) -> Box:
        """The box after propagation through all its rows and curves.

        Raises
        ------
        Empty
            the box is empty
        """
        propagation = _Propagation(layout, self)
        size = propagation.size()
        for _ in range(BOX_ROUNDS):
            propagation.propagate()
            new_size = propagation.size()
            if new_size > (1 - GAIN) * size:
                break
            size = new_size
        return Box(propagation.lower, propagation.upper, propagation.low, propagation.high)


class _Propagation:
    """The ranges of a box while they are propagated."""

    def __init__(self, layout: Layout, box: Box) -> None:
        self.layout = layout
        self.lower, self.upper = box.lower.copy(), box.upper.copy()
        self.low, self.high = box.low.copy(), box.high.copy()

    def size(self) -> float:
        """Sum of the lengths of all ranges."""
        return float((self.upper - self.lower).sum() + (self.high - self.low).sum())

    def propagate(self) -> None:
        """Cut all ranges in one pass over the forms and curves."""
        layout = self.layout
        outs, directions, rows = layout.parts
        low, high, term_low, term_high = layout.reach(self.lower, self.upper)
        self._raise(self.low, self.high, low[directions], high[directions])
        values = layout.functions.hull(*layout.arguments(self.low, self.high))
        goal_low, goal_high = low.copy(), high.copy()
        goal_low[outs] = np.maximum(low[outs], values[0])
        goal_high[outs] = np.minimum(high[outs], values[1])
        self._back(goal_low[outs], goal_high[outs])
        goal_low[directions], goal_high[directions] = self.low, self.high
        goal_low[rows] = np.maximum(low[rows], 0.0)
        if (goal_low > goal_high + CROSSED).any():
            raise Empty
        rest_low = low[layout.form] - term_low
        rest_high = high[layout.form] - term_high
        ends = (
            (goal_low[layout.form] - rest_high) / layout.power,
            (goal_high[layout.form] - rest_low) / layout.power,
        )
        lower, upper = self.lower.copy(), self.upper.copy()
        np.maximum.at(lower, layout.atom, np.minimum(*ends) - ROOM)
        np.minimum.at(upper, layout.atom, np.maximum(*ends) + ROOM)
        self._raise(self.lower, self.upper, lower, upper)

    def _back(self, low: Vector, high: Vector) -> None:
        """Cut the ranges of the directions (log ratios), using those of the curves' outputs."""
        layout = self.layout
        inner = layout.functions.inverse_hull(low, high)
        ends = [(end - layout.constant) / layout.factor for end in inner]
        lows, highs = self.low.copy(), self.high.copy()
        np.maximum.at(lows, layout.direction, np.minimum(*ends) - ROOM)
        np.minimum.at(highs, layout.direction, np.maximum(*ends) + ROOM)
        self._raise(self.low, self.high, lows, highs)

    @staticmethod
    def _raise(low: Vector, high: Vector, new_low: Vector, new_high: Vector) -> None:
        """Cut ranges in place to the new ends, where these are tighter."""
        np.maximum(low, new_low, out=low)
        np.minimum(high, new_high, out=high)
        crossed = low > high
        if crossed.any():
            if (low[crossed] > high[crossed] + CROSSED).any():
                raise Empty
            middle = (low[crossed] + high[crossed]) / 2
            low[crossed] = high[crossed] = middle
