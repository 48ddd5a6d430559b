"""Bounds of symbols: lower and upper limits of the results of operations."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Final, TypeAlias

Bounds: TypeAlias = tuple[float, float]
ANY: Final[Bounds] = (-math.inf, math.inf)


def bounds_of(value: Any) -> Bounds:
    """Lower and upper bound of a symbol or number; those of NaN are infinite."""
    if hasattr(value, "bounds"):
        limits: Bounds = value.bounds
        return limits
    return (float(value), float(value)) if value == value else ANY


def bounds(op: str, args: tuple[Any, ...]) -> Bounds:
    """Bounds of an operation's result, from the bounds of its operands."""
    if op == "add":
        (a, b), (c, d) = bounds_of(args[0]), bounds_of(args[1])
        return _clean(a + c, b + d)
    if op == "sub":
        (a, b), (c, d) = bounds_of(args[0]), bounds_of(args[1])
        return _clean(a - d, b - c)
    if op == "neg":
        a, b = bounds_of(args[0])
        return -b, -a
    if op == "mul":
        if args[0] is args[1]:
            a, b = bounds_of(args[0])
            least = 0.0 if a <= 0 <= b else min(a * a, b * b)
            return least, max(a * a, b * b)
        (a, b), (c, d) = bounds_of(args[0]), bounds_of(args[1])
        return _hull(_product(a, c), _product(a, d), _product(b, c), _product(b, d))
    if op == "div":
        (a, b), (c, d) = bounds_of(args[0]), bounds_of(args[1])
        if c > 0:
            return _hull(a / c, a / d, b / c, b / d)
        return (0.0, math.inf) if a >= 0 and c >= 0 else ANY
    if op == "where":
        return _of_choice(*args)
    return _of_function(op, args)


def _of_function(op: str, args: tuple[Any, ...]) -> Bounds:
    """Bounds of a function of one variable, or of a power with a constant exponent."""
    if op in _RISING:
        domain, function = _RISING[op]
        low, high = bounds_of(args[0])
        low, high = at_end(function, max(low, domain)), at_end(function, max(high, domain))
        if op == "sqrt":  # rounding is equal on every system
            return low, high
        low, high = _wider(low, high)
        return max(low, at_end(function, domain)), min(high, at_end(function, math.inf))
    if op == "pow" and bounds_of(args[0])[0] >= 0:
        low, high = (at_end(lambda x: x ** args[1], end) for end in bounds_of(args[0]))
        return _wider(low, high) if args[1] > 0 else _wider(high, low)
    if op in ("sin", "cos"):
        return _of_wave(op, *bounds_of(args[0]))
    return ANY


_RISING: Final[dict[str, tuple[float, Callable[[float], float]]]] = {
    "sqrt": (0.0, math.sqrt),
    "exp": (-math.inf, math.exp),
    "expm1": (-math.inf, math.expm1),
    "log": (0.0, math.log),
    "log1p": (-1.0, math.log1p),
    "tanh": (-math.inf, math.tanh),
}
"""Increasing functions, with the lower end of their domain."""


def at_end(function: Callable[[float], float], value: float) -> float:
    """Value of a function at an end of its operand's range; infinite where it is undefined.

    Towards the edge of its domain, a logarithm tends to -infinity and a negative power to
    +infinity.
    """
    try:
        return function(value)
    except (OverflowError, ZeroDivisionError):
        return math.inf
    except ValueError:
        return -math.inf


def _wider(low: float, high: float) -> Bounds:
    """Widen bounds by the rounding errors of functions, which differ between libraries."""
    return low - ROUNDING * abs(low), high + ROUNDING * abs(high)


ROUNDING = 1e-14
"""Relative allowance for the rounding error of a function."""


def _of_wave(op: str, low: float, high: float) -> Bounds:
    """Bounds of a sine or cosine over an interval."""
    if not high - low < 2 * math.pi:
        return -1.0, 1.0
    wave, crest = (math.cos, 0.0) if op == "cos" else (math.sin, 0.5 * math.pi)
    ends = (wave(low), wave(high))
    room = ROUNDING * (1 + max(abs(low), abs(high)))

    def passes(place: float) -> bool:
        """Whether the interval contains this angle plus any whole number of turns."""
        turn = 2 * math.pi
        return math.ceil((low - place) / turn - room) <= math.floor((high - place) / turn + room)

    least = -1.0 if passes(crest + math.pi) else max(min(ends) - room, -1.0)
    return least, 1.0 if passes(crest) else min(max(ends) + room, 1.0)


def _product(a: float, b: float) -> float:
    return 0.0 if a == 0 or b == 0 else a * b


def _clean(low: float, high: float) -> Bounds:
    return (-math.inf if low != low else low), (math.inf if high != high else high)


def _hull(*values: float) -> Bounds:
    known = [value for value in values if value == value]
    return (min(known), max(known)) if len(known) == len(values) else ANY


def _of_choice(condition: Any, yes: Any, no: Any) -> Bounds:
    """Bounds of a choice between two values.

    If the condition compares these two values, the choice is their minimum or maximum.
    """
    (a, b), (c, d) = bounds_of(yes), bounds_of(no)
    if getattr(condition, "op", None) in ("lt", "le"):
        less, more = condition.args
        if _same(less, no) and _same(more, yes):  # the larger of both
            return max(a, c), max(b, d)
        if _same(less, yes) and _same(more, no):  # the smaller of both
            return min(a, c), min(b, d)
    return min(a, c), max(b, d)


def _same(first: Any, second: Any) -> bool:
    if first is second:
        return True
    return isinstance(first, float) and isinstance(second, float) and first == second
