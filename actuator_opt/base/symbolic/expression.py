"""Symbols: values that record the operations applied to them.

Equal operations on equal operands share a node; operations on numbers are evaluated at once. Every
node has bounds of its value (a square is not negative, a limited signal keeps its limits). A
comparison whose result follows from the bounds is removed, so a model's guards cost nothing where
they cannot act.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Sequence
from dataclasses import field
from functools import partial
from types import SimpleNamespace
from typing import Any, Final, TypeAlias

from ..dataclass import dataclass
from .bounds import ANY, Bounds, bounds, bounds_of

Expression: TypeAlias = Any
"""A symbol, or a number if its value is known."""

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
    """The nodes of one traced model in order of creation, so that operands precede results."""

    nodes: list[Symbol] = field(default_factory=list)
    known: dict[tuple[Any, ...], Symbol] = field(default_factory=dict)
    tables: list[Callable[..., Any]] = field(default_factory=list)
    """Tabulated functions of time, such as measured inputs."""
    slopes: dict[int, int] = field(default_factory=dict)
    """Indices in `tables`: that of each tabulated function, mapped to that of its slope."""
    labels: list[str] = field(default_factory=list)
    """Name of each function in `tables`."""
    truth: Callable[..., bool] | None = None
    """Function that decides a condition on which a model branches. Only exact graphs have it; their
    operations are those of NumPy (NaN and rounding included) and are never simplified."""

    def variable(self, name: str, limits: Bounds = ANY) -> Symbol:
        """Add a variable: a number within limits, called `name` in generated code."""
        symbol = self.node("variable", (name,))
        symbol.bounds = limits
        return symbol

    def flag(self, name: str) -> Symbol:
        """Add a boolean variable; it changes only when an integration restarts."""
        return self.node("flag", (name,))

    def table(
        self,
        function: Callable[..., Any],
        time: Symbol,
        slope: Callable[..., Any] | None = None,
        label: str = "table",
    ) -> Symbol:
        """Add a tabulated function of time with its slope; both accept floats and NumPy arrays."""
        number = len(self.tables)
        self.tables.append(function)
        self.labels.append(label)
        if slope is not None:
            self.slopes[number] = len(self.tables)
            self.tables.append(slope)
            self.labels.append(f"slope of {label}")
        return self.node("table", (number, time))

    def slope(self, number: int, time: Symbol) -> Any:
        """Slope of the function `tables[number]` at a time; 0 if it was added without a slope."""
        known = self.slopes.get(number)
        return 0.0 if known is None else self.node("table", (known, time))

    def node(self, op: str, args: tuple[Any, ...]) -> Symbol:
        """Node of an operation; equal operands give the same node."""
        key = (op, *(("#", a.index) if isinstance(a, Symbol) else a for a in args))
        symbol = self.known.get(key)
        if symbol is None:
            symbol = Symbol(self, op, args, len(self.nodes), bounds(op, args))
            self.nodes.append(symbol)
            self.known[key] = symbol
        return symbol

    def exact_node(self, op: str, *args: Any) -> Symbol:
        """Node of an operation, without simplification; -0 and 0 are different operands."""
        key = (op, *args)
        for a in args:
            if type(a) is float and a == 0.0 and math.copysign(1.0, a) < 0:
                key = (op, *map(str, args))  # -0 and 0 are equal, but not their texts
                break
        symbol = self.known.get(key)
        if symbol is None:
            symbol = Symbol(self, op, args, len(self.nodes), ANY)
            self.nodes.append(symbol)
            self.known[key] = symbol
        return symbol


class Symbol:
    """A node of a graph that behaves like a number of the array-API standard."""

    __array_ufunc__ = None  # NumPy numbers defer operations to this class
    __slots__ = ("args", "bounds", "graph", "index", "op")
    dtype: Final = "float64"
    shape: Final = ()
    ndim: Final = 0

    def __init__(
        self, graph: Graph, op: str, args: tuple[Any, ...], index: int, limits: Bounds
    ) -> None:
        self.graph, self.op, self.args, self.index = graph, op, args, index
        self.bounds = limits

    @property
    def operands(self) -> list[Symbol]:
        """The operands that are symbols."""
        return [a for a in self.args if type(a) is Symbol]

    def __array_namespace__(self, **_: Any) -> Any:
        return Namespace

    def __repr__(self) -> str:
        inside = ", ".join(f"%{a.index}" if isinstance(a, Symbol) else repr(a) for a in self.args)
        return f"%{self.index} = {self.op}({inside})"

    def __bool__(self) -> bool:
        if self.graph.truth is not None:
            return self.graph.truth(self)
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
    """Order the operands of a commutative operation: numbers first, then by creation."""
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
    """Logical "and" of two conditions."""
    a, b = _ordered(_number(first), _number(second))
    if not isinstance(b, Symbol):
        return bool(a and b)
    if not isinstance(a, Symbol):
        return b if a else False
    return b.graph.node("and", (a, b))


def either(first: Any, second: Any) -> Any:
    """Logical "or" of two conditions."""
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
    """Polar angle of the point (second, first)."""
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
"""Array-API namespace of symbols, with the functions that models use."""
_BOOLEAN = {"lt", "le", "and", "or", "not", "flag"}


def is_boolean(symbol: Symbol) -> bool:
    """Whether a symbol is a truth value."""
    return symbol.op in _BOOLEAN


def needed(outputs: Sequence[Any], known: Container[int] = ()) -> list[Symbol]:
    """Nodes on which the outputs depend, operands first.

    Nodes with an index in `known` are omitted, and so are nodes on which only they depend.
    """
    symbols = [out for out in outputs if isinstance(out, Symbol) and out.index not in known]
    if not symbols:
        return []
    nodes, index = symbols[0].graph.nodes, max(symbol.index for symbol in symbols)
    wanted = bytearray(index + 1)
    for symbol in symbols:
        wanted[symbol.index] = 1
    left, result = sum(wanted), []
    while left:  # operands precede results
        if wanted[index]:
            node = nodes[index]
            result.append(node)
            left -= 1
            for a in node.args:
                if type(a) is Symbol and not wanted[a.index] and a.index not in known:
                    wanted[a.index] = 1
                    left += 1
        index -= 1
    result.reverse()
    return result
