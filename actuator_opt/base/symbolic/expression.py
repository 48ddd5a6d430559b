"""Symbols: values that record the operations on them.

Equal operations on equal operands share a node; operations on numbers are evaluated at once.
Every node has bounds of its value (a square is not negative, a limited signal keeps its limits).
The bounds decide comparisons, so the guards of a model cost nothing where they cannot act.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from types import SimpleNamespace
from typing import Any, Final, TypeAlias

from .bounds import ANY, Bounds, bounds, bounds_of

Expression: TypeAlias = Any
"""A symbol, or its numeric value if known."""

_FUNCTIONS: dict[str, Callable[[float], float]] = {
    "sqrt": math.sqrt,
    "exp": math.exp,
    "expm1": math.expm1,
    "log": math.log,
    "log1p": math.log1p,
    "tanh": math.tanh,
    "sin": math.sin,
    "cos": math.cos,
}
"""Functions of one variable."""


@dataclass(slots=True)
class Graph:
    """Nodes of one trace in creation order: operands precede results."""

    nodes: list[Symbol] = field(default_factory=list)
    known: dict[tuple[Any, ...], Symbol] = field(default_factory=dict)
    tables: list[Callable[..., Any]] = field(default_factory=list)
    """Tabulated functions of time, such as measured inputs."""
    slopes: dict[int, int] = field(default_factory=dict)
    """Index of a tabulated function whose slope this function is."""

    def variable(self, name: str, limits: Bounds = ANY) -> Symbol:
        """A free number, `name` in the code, with its limits."""
        found = self.node("variable", (name,))
        found.bounds = limits
        return found

    def flag(self, name: str) -> Symbol:
        """A free truth value; it changes only at restarts of an integration."""
        return self.node("flag", (name,))

    def table(
        self,
        function: Callable[..., Any],
        time: Symbol,
        slope: Callable[..., Any] | None = None,
    ) -> Symbol:
        """A tabulated function of time with its slope; both accept floats and NumPy arrays."""
        number = len(self.tables)
        self.tables.append(function)
        if slope is not None:
            self.slopes[number] = len(self.tables)
            self.tables.append(slope)
        return self.node("table", (number, time))

    def slope(self, number: int, time: Symbol) -> Any:
        """Slope of a tabulated function; zero if none was given."""
        known = self.slopes.get(number)
        return 0.0 if known is None else self.node("table", (known, time))

    def node(self, op: str, args: tuple[Any, ...]) -> Symbol:
        """Node of an operation; equal operands give the same node."""
        key = (op, *(("#", a.index) if isinstance(a, Symbol) else a for a in args))
        found = self.known.get(key)
        if found is None:
            found = Symbol(self, op, args, len(self.nodes), bounds(op, args))
            self.nodes.append(found)
            self.known[key] = found
        return found


class Symbol:
    """A node of a graph that behaves like a number of the array-API standard."""

    __array_ufunc__ = None  # NumPy numbers defer operations to this class
    __slots__ = ("args", "bounds", "graph", "index", "op", "operands")
    dtype: Final = "float64"
    shape: Final = ()
    ndim: Final = 0

    def __init__(
        self, graph: Graph, op: str, args: tuple[Any, ...], index: int, limits: Bounds
    ) -> None:
        self.graph, self.op, self.args, self.index = graph, op, args, index
        self.bounds = limits
        self.operands = tuple(a for a in args if isinstance(a, Symbol))

    def __array_namespace__(self, **_: Any) -> Any:
        return Namespace

    def __repr__(self) -> str:
        inside = ", ".join(f"%{a.index}" if isinstance(a, Symbol) else repr(a) for a in self.args)
        return f"%{self.index} = {self.op}({inside})"

    def __hash__(self) -> int:
        return id(self)

    def __bool__(self) -> bool:
        raise TypeError("a symbol has no truth value: use `where`")

    def __add__(self, other: Any) -> Any:
        return add(self, other)

    def __radd__(self, other: Any) -> Any:
        return add(other, self)

    def __sub__(self, other: Any) -> Any:
        return subtract(self, other)

    def __rsub__(self, other: Any) -> Any:
        return subtract(other, self)

    def __mul__(self, other: Any) -> Any:
        return multiply(self, other)

    def __rmul__(self, other: Any) -> Any:
        return multiply(other, self)

    def __truediv__(self, other: Any) -> Any:
        return divide(self, other)

    def __rtruediv__(self, other: Any) -> Any:
        return divide(other, self)

    def __pow__(self, other: Any) -> Any:
        return power(self, other)

    def __rpow__(self, other: Any) -> Any:
        return power(other, self)

    def __neg__(self) -> Any:
        return negative(self)

    def __pos__(self) -> Symbol:
        return self

    def __lt__(self, other: Any) -> Any:
        return less(self, other)

    def __gt__(self, other: Any) -> Any:
        return less(other, self)

    def __le__(self, other: Any) -> Any:
        return less_equal(self, other)

    def __ge__(self, other: Any) -> Any:
        return less_equal(other, self)

    def __and__(self, other: Any) -> Any:
        return both(self, other)

    __rand__ = __and__

    def __or__(self, other: Any) -> Any:
        return either(self, other)

    __ror__ = __or__

    def __invert__(self) -> Any:
        return opposite(self)


def _number(value: Any) -> Any:
    """Numbers as plain Python numbers; symbols unchanged."""
    if isinstance(value, (Symbol, bool)) or type(value) is float:
        return value
    if isinstance(value, (int, float)):  # includes NumPy
        return float(value)
    plain = value.item()  # NumPy numbers
    return plain if isinstance(plain, (bool, Symbol)) else float(plain)


def _graph(*values: Any) -> Graph:
    return next(value.graph for value in values if isinstance(value, Symbol))


def _ordered(first: Any, second: Any) -> tuple[Any, Any]:
    """Operands of a commutative operation in a fixed order: numbers first, then by age."""
    if isinstance(second, Symbol) and (
        not isinstance(first, Symbol) or first.index <= second.index
    ):
        return first, second
    return second, first


def add(first: Any, second: Any) -> Any:
    """Sum."""
    a, b = _ordered(_number(first), _number(second))
    if not isinstance(b, Symbol):
        return a + b
    if not isinstance(a, Symbol) and a == 0:
        return b
    if b.op == "neg":
        return subtract(a, b.args[0])
    if isinstance(a, Symbol) and a.op == "neg":
        return subtract(b, a.args[0])
    return b.graph.node("add", (a, b))


def subtract(first: Any, second: Any) -> Any:
    """Difference."""
    a, b = _number(first), _number(second)
    if not isinstance(a, Symbol) and not isinstance(b, Symbol):
        return a - b
    if a is b:
        return 0.0
    if not isinstance(b, Symbol):
        return add(-b, a)
    if not isinstance(a, Symbol) and a == 0:
        return negative(b)
    if b.op == "neg":
        return add(a, b.args[0])
    return b.graph.node("sub", (a, b))


def multiply(first: Any, second: Any) -> Any:
    """Product; zero times a symbol is zero."""
    a, b = _ordered(_number(first), _number(second))
    if not isinstance(b, Symbol):
        return a * b
    if not isinstance(a, Symbol):
        if a == 0:
            return 0.0
        if a == 1:
            return b
        if a == -1:
            return negative(b)
        if b.op == "mul" and not isinstance(b.args[0], Symbol):
            return multiply(a * b.args[0], b.args[1])
        if b.op == "neg":
            return multiply(-a, b.args[0])
    elif a.op == "neg" and b.op == "neg":
        return multiply(a.args[0], b.args[0])
    return b.graph.node("mul", (a, b))


def divide(first: Any, second: Any) -> Any:
    """Quotient."""
    a, b = _number(first), _number(second)
    if not isinstance(b, Symbol):
        if b == 0:
            return math.nan if not isinstance(a, Symbol) and a == 0 else math.inf * a
        return multiply(1 / b, a) if isinstance(a, Symbol) else a / b
    if not isinstance(a, Symbol) and a == 0:
        return 0.0
    if a is b:
        return 1.0
    return b.graph.node("div", (a, b))


def power(base: Any, exponent: Any) -> Any:
    """Power; a symbolic exponent needs a positive base."""
    base, exponent = _number(base), _number(exponent)
    if isinstance(exponent, Symbol):
        return Namespace.exp(exponent * Namespace.log(base))
    if not isinstance(base, Symbol):
        return base**exponent
    if exponent == 0:
        return 1.0
    if exponent == 1:
        return base
    if exponent == 2:
        return base * base
    if exponent == 0.5:
        return Namespace.sqrt(base)
    if exponent == -1:
        return 1.0 / base
    return base.graph.node("pow", (base, exponent))


def negative(value: Any) -> Any:
    """Negative of a value."""
    value = _number(value)
    if not isinstance(value, Symbol):
        return -value
    if value.op == "neg":
        return value.args[0]
    if value.op == "mul" and not isinstance(value.args[0], Symbol):
        return multiply(-value.args[0], value.args[1])
    if value.op == "sub":
        return subtract(value.args[1], value.args[0])
    return value.graph.node("neg", (value,))


def less(first: Any, second: Any) -> Any:
    """First < second."""
    a, b = _number(first), _number(second)
    (low_a, high_a), (low_b, high_b) = bounds_of(a), bounds_of(b)
    if not isinstance(a, Symbol) and not isinstance(b, Symbol):
        return a < b
    if a is b or low_a >= high_b:
        return False
    if high_a < low_b:
        return True
    return _graph(a, b).node("lt", (a, b))


def less_equal(first: Any, second: Any) -> Any:
    """First <= second."""
    a, b = _number(first), _number(second)
    (low_a, high_a), (low_b, high_b) = bounds_of(a), bounds_of(b)
    if not isinstance(a, Symbol) and not isinstance(b, Symbol):
        return a <= b
    if a is b or high_a <= low_b:
        return True
    if low_a > high_b:
        return False
    return _graph(a, b).node("le", (a, b))


def both(first: Any, second: Any) -> Any:
    """First and second."""
    a, b = _ordered(_number(first), _number(second))
    if not isinstance(b, Symbol):
        return bool(a and b)
    if not isinstance(a, Symbol):
        return b if a else False
    return b.graph.node("and", (a, b))


def either(first: Any, second: Any) -> Any:
    """First or second."""
    a, b = _ordered(_number(first), _number(second))
    if not isinstance(b, Symbol):
        return bool(a or b)
    if not isinstance(a, Symbol):
        return True if a else b
    return b.graph.node("or", (a, b))


def opposite(value: Any) -> Any:
    """Negation of a truth value."""
    if not isinstance(value, Symbol):
        return not value
    return value.args[0] if value.op == "not" else value.graph.node("not", (value,))


def choose(condition: Any, yes: Any, no: Any) -> Any:
    """`yes` where the condition holds, else `no`."""
    condition, yes, no = _number(condition), _number(yes), _number(no)
    if not isinstance(condition, Symbol):
        return yes if condition else no
    if yes is no or (not isinstance(yes, Symbol) and not isinstance(no, Symbol) and yes == no):
        return yes
    return condition.graph.node("where", (condition, yes, no))


def apply(name: str, value: Any) -> Any:
    """A function of one variable."""
    value = _number(value)
    if not isinstance(value, Symbol):
        return _FUNCTIONS[name](value)
    return value.graph.node(name, (value,))


def atan2(first: Any, second: Any) -> Any:
    """Polar angle of a point."""
    first, second = _number(first), _number(second)
    if not isinstance(first, Symbol) and not isinstance(second, Symbol):
        return math.atan2(first, second)
    return _graph(first, second).node("atan2", (first, second))


Namespace = SimpleNamespace(
    nan=math.nan,
    pi=math.pi,
    float64="float64",
    isdtype=lambda dtype, kind: kind in ("real floating", "float64"),
    asarray=lambda value, dtype=None: value,
    where=choose,
    atan2=atan2,
    **{name: partial(apply, name) for name in _FUNCTIONS},
)
"""Array-API namespace of symbols: the functions that models use."""
