"""Bounds of every traced value that hold for all designs that meet the limits.

Interval constraint propagation, forwards from operands to results and backwards from limits to
variables [Benhamou1999]. A choice between a value and no value (NaN) takes the value, because a
design without a value meets no requirement.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from ...base.symbolic import Symbol
from ...base.symbolic.expression import Bounds, at_end, bounds, bounds_of
from .relaxation import ROUNDING, Form, Signomial

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
        parts = [expanded(one) for one in node.args] if node.op in _ALGEBRA else [None]
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
    sides = [decided(one) for one in args]
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
    first, second = (_root_of(one) for one in node.args)
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
        gains = [_holds(one, held=held) for one in condition.args]
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
