"""Bounds of every traced value that hold for all designs of a box that meet the limits.

A box is a part of the design space: ranges of atoms and of log ratios, and their implications.
Interval constraint propagation goes forwards from operands to results and backwards from limits to
variables [Benhamou1999]. A choice between a value and no value (NaN) takes the value, because a
design without a value meets no requirement.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ...base.symbolic import Symbol
from ...base.symbolic.expression import Bounds, at_end, bounds, bounds_of
from ..problem import Vector
from .relaxation import (
    FAR,
    ROUNDING,
    Form,
    Mixed,
    Powers,
    Relaxation,
    SampledFunction,
    Signomial,
    Tables,
)

ROUNDS = 30
"""Maximum passes over all values."""

WORTH = 1e-3
"""Relative gain of a bound below which another pass does not pay."""

LARGEST = 80
"""Maximum terms of a sum that is expanded."""

SLACK = 1e-9
"""Relative tolerance on every bound for rounding."""


class Empty(Exception):
    """No design meets the limits: the range of some value is empty."""


def tighten(nodes: Sequence[Symbol], facts: Sequence[tuple[Any, Any]] = ()) -> None:
    """Tighten the bounds of traced values, operands before results, in place.

    Parameters
    ----------
    nodes : operands before results
    facts : pairs of values, the first at least the second

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
        for more, less in facts:
            gained |= narrow(more, (bounds_of(less)[0], math.inf))
            gained |= narrow(less, (-math.inf, bounds_of(more)[1]))
        for node in reversed(nodes):
            gained |= _backward(node)
        if not gained:
            return


def cancelling(nodes: Sequence[Symbol]) -> dict[Symbol, Signomial]:
    """Sums whose terms partly cancel when expanded, which plain bounds miss."""
    known: dict[int, Signomial | None] = {}

    def expanded(value: Any) -> Signomial | None:
        if isinstance(value, Symbol):
            return known[value.index]
        return Signomial.number(value) if math.isfinite(value) else None

    found = {}
    for node in nodes:
        parts = [expanded(arg) for arg in node.args] if node.op in _ALGEBRA else [None]
        whole = None if None in parts else _ALGEBRA[node.op](*parts)
        if whole is not None and len(whole.terms) <= LARGEST:
            sizes = sum(part.size for part in parts if part is not None)
            if node.op in ("add", "sub") and whole.size < (1 - 1e-9) * sizes:
                found[node] = whole
            known[node.index] = whole
        else:
            known[node.index] = Signomial({((node.index, 1.0),): 1.0})
    return found


def _quotient(first: Signomial, second: Signomial) -> Signomial | None:
    known = second.single
    if known is None:
        return None
    sign, form = known
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
    """Bounds of a sum of products of values."""
    low = high = 0.0
    for powers, factor in parts.terms.items():
        least = most = 1.0
        for index, power in powers:
            a, b = nodes[index].bounds
            if a < 0 or (power < 0 and a <= 0):
                return -math.inf, math.inf
            ends = (a**power, b**power) if b < math.inf else (0.0, math.inf)
            least, most = least * min(ends), most * max(ends)
        ends = (factor * least, factor * most)
        low, high = low + min(ends), high + max(ends)
    if low != low or high != high:
        return -math.inf, math.inf
    return low, high


def narrow(value: Any, found: Bounds) -> bool:
    """Narrow a value's bounds; whether the gain was large.

    Raises
    ------
    Empty
        the range is empty
    """
    low, high = found
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
    """Whether a condition is true for all designs, for none, or (None) undecided."""
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
    """The branch that a choice takes for all designs with a value; None if undecided."""
    condition, yes, no = node.args
    if _nothing(yes):
        return no
    if _nothing(no):
        return yes
    known = decided(condition)
    return None if known is None else (yes if known else no)


def extreme(node: Symbol) -> str | None:
    """Whether a choice is the larger ("max") or the smaller ("min") of its branches."""
    condition, yes, no = node.args
    if getattr(condition, "op", None) not in ("lt", "le"):
        return None
    less, more = condition.args
    if same(less, no) and same(more, yes):
        return "max"
    return "min" if same(less, yes) and same(more, no) else None


def same(first: Any, second: Any) -> bool:
    """Whether two values are identical: the same symbol, or equal numbers."""
    if first is second:
        return True
    return isinstance(first, float) and isinstance(second, float) and first == second


def _nothing(value: Any) -> bool:
    return isinstance(value, float) and math.isnan(value)


def _forward(node: Symbol) -> Bounds:
    if node.op == "where":
        taken = branch(node)
        if taken is not None:
            return bounds_of(taken)
    if node.op in ("lt", "le", "and", "or", "not", "variable", "flag"):
        return node.bounds
    if node.op == "sub":
        return _difference(node)
    return bounds(node.op, node.args)


def _difference(node: Symbol) -> Bounds:
    """Bounds of a difference; for squares also as (a - b)(a + b), if a - b is traced."""
    low, high = bounds("sub", node.args)
    first, second = (_root_of(arg) for arg in node.args)
    if first is not None and second is not None:
        apart = node.graph.known.get(("sub", ("#", first.index), ("#", second.index)))
        if apart is not None:
            total = first.bounds[0] + second.bounds[0], first.bounds[1] + second.bounds[1]
            ends = [a * b for a in apart.bounds for b in total]
            return max(low, min(ends)), min(high, max(ends))
    return low, high


def _root_of(value: Any) -> Symbol | None:
    """The x of x * x."""
    if isinstance(value, Symbol) and value.op == "mul" and value.args[0] is value.args[1]:
        root: Symbol = value.args[0]
        return root
    return None


def _backward(node: Symbol) -> bool:
    """Narrow the operands of a value by its bounds."""
    rule = _BACKWARDS.get(node.op)
    return False if rule is None else rule(node)


def _add(node: Symbol) -> bool:
    a, b = node.args
    return narrow(a, _rounded("sub", node, b)) | narrow(b, _rounded("sub", node, a))


def _sub(node: Symbol) -> bool:
    a, b = node.args
    return narrow(a, _rounded("add", node, b)) | narrow(b, _rounded("sub", a, node))


def _rounded(op: str, first: Any, second: Any) -> Bounds:
    """Bounds of a sum or difference, with a tolerance for the rounding of its operands."""
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
    for one, other in ((a, b), (b, a)):
        if bounds_of(other)[0] > 0:
            gained |= narrow(one, bounds("div", (node, other)))
    return gained


def _div(node: Symbol) -> bool:
    a, b = node.args
    gained = narrow(a, bounds("mul", (node, b)))
    (low, high), (least, most) = bounds_of(a), node.bounds
    if low > 0 and least > 0:
        gained |= narrow(b, (low / most if most < math.inf else 0.0, high / least))
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
    taken = branch(node)
    if taken is not None:
        return narrow(taken, node.bounds) | _holds(condition, held=taken is yes)
    low, high = node.bounds
    kind = extreme(node)
    if kind == "max":
        return narrow(yes, (-math.inf, high)) | narrow(no, (-math.inf, high))
    if kind == "min":
        return narrow(yes, (low, math.inf)) | narrow(no, (low, math.inf))
    return False


def _holds(condition: Any, *, held: bool) -> bool:
    """Narrow both sides of a comparison that is known to be true or false."""
    if not isinstance(condition, Symbol):
        return False
    if condition.op == "not":
        return _holds(condition.args[0], held=not held)
    if condition.op in ("and", "or"):
        if held != (condition.op == "and"):
            return False
        gains = [_holds(arg, held=held) for arg in condition.args]
        return any(gains)
    less, more = condition.args if held else reversed(condition.args)
    gained = narrow(less, (-math.inf, bounds_of(more)[1]))
    return narrow(more, (bounds_of(less)[0], math.inf)) | gained


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
"""Maximum passes of the propagation in one box."""


GAIN = 0.01
"""Share of the summed ranges that a pass must cut to justify another."""


ROOM = 1e-9
"""Tolerance on every range for rounding (of logarithms, so relative)."""


CROSSED = 1e-8
"""Overlap of crossed range ends that proves a box empty."""


def _lone(form: Form) -> int:
    """The atom that a form consists of; -1 for other forms."""
    lone = form.constant == 0 and len(form.powers) == 1 and form.powers[0][1] == 1.0
    return form.powers[0][0] if lone else -1


class Gone(Exception):
    """A part of the design space is empty."""


class Layout:
    """A relaxation as arrays; each distinct direction in logarithmic space appears once.

    A direction is a log ratio, such as log(t/r), shared by all curves of powers of that ratio. Its
    largest power is 1, so its range is no longer than those of its atoms together. Forms come in
    this order: outputs of curves, directions, rows (each >= 0).
    """

    def __init__(self, relaxation: Relaxation) -> None:
        self.relaxation = relaxation
        self.curves, self.atoms = len(relaxation.curves), len(relaxation.lower)
        self.mixed = Mixed([curve.kind for curve in relaxation.curves])
        known: dict[Powers, int] = {}
        places = []
        for curve in relaxation.curves:
            powers = curve.argument.powers
            factor = max((p for _, p in powers), key=abs)
            key = tuple((i, round(p / factor, 12)) for i, p in powers)
            number = known.setdefault(key, len(known))
            places.append((number, factor, curve.argument.constant))
        self.links = relaxation.links
        self._of_curve = {id(curve): k for k, curve in enumerate(relaxation.curves)}
        self.directions = len(known)
        self.direction = np.array([place[0] for place in places], dtype=np.intp)
        self.factor = np.array([place[1] for place in places])
        self.constant = np.array([place[2] for place in places])
        forms = [curve.out for curve in relaxation.curves]
        forms += [Form(0.0, key) for key in known]
        self.plain = np.array([_lone(form) for form in forms], dtype=np.intp)
        forms += [row.high - row.low for row in relaxation.rows]
        self.levels = np.array([form.constant for form in forms])
        entries = [(k, i, power) for k, form in enumerate(forms) for i, power in form.powers]
        self.form = np.array([entry[0] for entry in entries], dtype=np.intp)
        self.atom = np.array([entry[1] for entry in entries], dtype=np.intp)
        self.power = np.array([entry[2] for entry in entries])

    @cached_property
    def factors(self) -> tuple[np.ndarray, np.ndarray]:
        """Directions of both factors of every product."""
        way = {
            curve.out.powers[0][0]: int(number)
            for curve, number in zip(self.relaxation.curves, self.direction, strict=True)
            if curve.kind == "exp" and len(curve.out.powers) == 1
        }
        found = [(way[product.first], way[product.second]) for product in self.relaxation.products]
        first, second = np.array(found, dtype=np.intp).reshape(-1, 2).T
        return first, second

    @cached_property
    def _linked(self) -> tuple[Tables, np.ndarray, Vector]:
        """Tables of the links, the numbers of their curves, and the levels of the ratios."""
        number = np.array([self._of_curve[id(link.curve)] for link in self.links])
        kinds = [link.curve.kind for link in self.links]
        tables = Tables([kind for kind in kinds if isinstance(kind, SampledFunction)])
        return tables, number, np.array([link.level for link in self.links])

    def ratios(self, box: Box) -> tuple[Vector, Vector]:
        """Least and largest ratio of every link in a box."""
        if not self.links:
            return np.empty(0), np.empty(0)
        tables, number, constant = self._linked
        first, last = (ends[number] for ends in self.arguments(box.low, box.high))
        off = tables.apart(first, last, np.ones(len(number)), tables.rows)
        start = constant + tables.value(first) - first
        return np.exp(start + off[0] - tables.room), np.exp(start + off[1] + tables.room)

    @cached_property
    def parts(self) -> tuple[slice, slice, slice]:
        """Forms of outputs, of directions and of rows."""
        first, second = self.curves, self.curves + self.directions
        return slice(0, first), slice(first, second), slice(second, len(self.levels))

    def arguments(self, low: Vector, high: Vector) -> tuple[Vector, Vector]:
        """Ranges of the curves' arguments from those of the directions."""
        ends = (
            self.factor * low[self.direction] + self.constant,
            self.factor * high[self.direction] + self.constant,
        )
        return np.minimum(*ends), np.maximum(*ends)

    def reach(self, lower: Vector, upper: Vector) -> tuple[Vector, Vector, Vector, Vector]:
        """Ranges of all forms, and of their terms."""
        ends = self.power * lower[self.atom], self.power * upper[self.atom]
        least, most = np.minimum(*ends), np.maximum(*ends)
        count = len(self.levels)
        low: Vector = self.levels + np.bincount(self.form, least, count)
        high: Vector = self.levels + np.bincount(self.form, most, count)
        return low, high, least, most


@dataclass(frozen=True)
class Box:
    """Ranges of the atoms' logarithms and of the directions."""

    lower: Vector
    upper: Vector
    low: Vector
    high: Vector

    @classmethod
    def whole(cls, layout: Layout) -> Box:
        """The box given by the bounds of the traced values."""
        relaxation = layout.relaxation
        none = np.zeros(layout.directions)
        lower, upper = (np.clip(ends, -FAR, FAR) for ends in (relaxation.lower, relaxation.upper))
        return cls(lower, upper, none - FAR, none + FAR)

    def range(self, form: Form) -> tuple[float, float]:
        """Range of a monomial's logarithm."""
        low = high = form.constant
        for i, power in form.powers:
            ends = power * self.lower[i], power * self.upper[i]
            low, high = low + min(ends), high + max(ends)
        return low, high

    def split(self, direction: int, at: float) -> tuple[Box, Box]:
        """The part below and the part above a value of a direction."""
        return self.cut(direction, high=at), self.cut(direction, low=at)

    def cut(self, direction: int, *, low: float = -FAR, high: float = FAR) -> Box:
        """The part between two values of a direction."""
        lows, highs = self.low.copy(), self.high.copy()
        lows[direction] = max(lows[direction], low)
        highs[direction] = min(highs[direction], high)
        return replace(self, low=lows, high=highs)

    def tightened(self, layout: Layout) -> Box:
        """The box cut by all rows and curves.

        Raises
        ------
        Gone
            the box is empty
        """
        work = _Work(layout, self)
        size = work.size()
        for _ in range(BOX_ROUNDS):
            work.round()
            left = work.size()
            if left > (1 - GAIN) * size:
                break
            size = left
        return Box(work.lower, work.upper, work.low, work.high)


class _Work:
    """Ranges while they are being cut."""

    def __init__(self, layout: Layout, box: Box) -> None:
        self.layout = layout
        self.lower, self.upper = box.lower.copy(), box.upper.copy()
        self.low, self.high = box.low.copy(), box.high.copy()

    def size(self) -> float:
        """Sum of all ranges."""
        return float((self.upper - self.lower).sum() + (self.high - self.low).sum())

    def round(self) -> None:
        """One pass over all forms and curves."""
        layout = self.layout
        outs, ways, rows = layout.parts
        low, high, least, most = layout.reach(self.lower, self.upper)
        self._raise(self.low, self.high, low[ways], high[ways])
        values = layout.mixed.hull(*layout.arguments(self.low, self.high))
        goal_low, goal_high = low.copy(), high.copy()
        goal_low[outs] = np.maximum(low[outs], values[0])
        goal_high[outs] = np.minimum(high[outs], values[1])
        self._back(goal_low[outs], goal_high[outs])
        goal_low[ways], goal_high[ways] = self.low, self.high
        goal_low[rows] = np.maximum(low[rows], 0.0)
        if (goal_low > goal_high + CROSSED).any():
            raise Gone
        rest_low = low[layout.form] - least
        rest_high = high[layout.form] - most
        ends = (
            (goal_low[layout.form] - rest_high) / layout.power,
            (goal_high[layout.form] - rest_low) / layout.power,
        )
        lower, upper = self.lower.copy(), self.upper.copy()
        np.maximum.at(lower, layout.atom, np.minimum(*ends) - ROOM)
        np.minimum.at(upper, layout.atom, np.maximum(*ends) + ROOM)
        self._raise(self.lower, self.upper, lower, upper)

    def _back(self, low: Vector, high: Vector) -> None:
        """Cut the directions through the outputs of curves."""
        layout = self.layout
        inner = layout.mixed.within(low, high)
        ends = [(end - layout.constant) / layout.factor for end in inner]
        lows, highs = self.low.copy(), self.high.copy()
        np.maximum.at(lows, layout.direction, np.minimum(*ends) - ROOM)
        np.minimum.at(highs, layout.direction, np.maximum(*ends) + ROOM)
        self._raise(self.low, self.high, lows, highs)

    @staticmethod
    def _raise(low: Vector, high: Vector, new_low: Vector, new_high: Vector) -> None:
        """Cut ranges in place."""
        np.maximum(low, new_low, out=low)
        np.minimum(high, new_high, out=high)
        crossed = low > high
        if crossed.any():
            if (low[crossed] > high[crossed] + CROSSED).any():
                raise Gone
            middle = (low[crossed] + high[crossed]) / 2
            low[crossed] = high[crossed] = middle
