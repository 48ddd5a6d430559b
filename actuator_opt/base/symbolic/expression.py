"""Symbols: values that record the operations applied to them.

Equal operations on equal operands share a node; operations on numbers are evaluated at once. Every
node has bounds of its value (a square is not negative, a limited signal keeps its limits). A
comparison whose result follows from the bounds is removed, so a model's guards cost nothing where
they cannot act.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Mapping, Sequence
from dataclasses import field
from functools import partial
from types import SimpleNamespace
from typing import Any, Final, TypeAlias

import numpy as np

from ..dataclass import dataclass

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


xp = Namespace
Slopes: TypeAlias = dict[int, Any]
"""Nonzero derivatives, by the index of the variable."""


def jacobian(outputs: Sequence[Any], variables: Sequence[Symbol]) -> list[list[Any]]:
    """Derivatives of outputs (rows) by variables (columns); 0.0 for independent outputs.

    The derivative of a choice is that of the selected branch; that of a tabulated function is the
    slope given with it. Flags have no derivative. The derivative of a square root at zero is set to
    zero, although it is infinite.
    """
    known: dict[int, Slopes] = {variable.index: {k: 1.0} for k, variable in enumerate(variables)}
    for node in needed(outputs):
        if node.index not in known and not is_boolean(node):
            slopes = _slopes(node, known)
            if slopes:
                known[node.index] = slopes
    rows = []
    for out in outputs:
        slopes = known.get(out.index, {}) if isinstance(out, Symbol) else {}
        rows.append([slopes.get(k, 0.0) for k in range(len(variables))])
    return rows


def _slopes(node: Symbol, known: dict[int, Slopes]) -> Slopes:
    """Derivatives of a node, from the derivatives of its operands."""
    inner = [known.get(a.index, {}) if isinstance(a, Symbol) else {} for a in node.args]
    columns = dict.fromkeys(k for slopes in inner for k in slopes)
    if not columns:
        return {}
    rule = _RULES[node.op](node, *node.args)
    result = {}
    for k in columns:
        slope = rule(*(slopes.get(k, 0.0) for slopes in inner))
        if isinstance(slope, Symbol) or slope != 0:
            result[k] = slope
    return result


def _scaled(factor: Any) -> Callable[..., Any]:
    return lambda da: factor * da


def is_steep_at_zero(node: Symbol) -> bool:
    """Whether a node is a root whose derivative at zero counts as zero instead of infinite.

    It is False for nodes of exact graphs, whose derivatives are those of NumPy.
    """
    if node.graph.truth is not None:
        return False
    return node.op == "sqrt" or (node.op == "pow" and 0 < node.args[1] < 1)


def _steep(value: Any) -> Any:
    """Replace 0 by infinity, so that the derivative of sqrt(x) at x = 0 is 0 and not infinite."""
    return choose(less(0.0, value), value, math.inf)


_RULES: dict[str, Callable[..., Callable[..., Any]]] = {
    "add": lambda node, a, b: lambda da, db: da + db,
    "sub": lambda node, a, b: lambda da, db: da - db,
    "mul": lambda node, a, b: lambda da, db: da * b + a * db,
    "div": lambda node, a, b: lambda da, db: (da - node * db) / b,
    "pow": lambda node, a, b: lambda da, db: b * power(_steep(a) if 0 < b < 1 else a, b - 1) * da,
    "atan2": lambda node, a, b: lambda da, db: (b * da - a * db) / (a * a + b * b),
    "where": lambda node, c, a, b: lambda dc, da, db: choose(c, da, db),
    "table": lambda node, k, t: lambda dk, dt: node.graph.slope(k, t) * dt,
    "neg": lambda node, a: lambda da: -da,
    "sqrt": lambda node, a: _scaled(0.5 / _steep(node)),
    "exp": lambda node, a: _scaled(node),
    "expm1": lambda node, a: _scaled(node + 1.0),
    "log": lambda node, a: _scaled(1.0 / a),
    "log1p": lambda node, a: _scaled(1.0 / (1.0 + a)),
    "tanh": lambda node, a: _scaled(1.0 - node * node),
    "sin": lambda node, a: _scaled(xp.cos(a)),
    "cos": lambda node, a: _scaled(-xp.sin(a)),
}
"""For every operation, the rule that gives its derivative from the derivatives of its operands."""
DEEPEST = 12
"""Deepest nesting of operations in a line of generated code; deeper operations get own lines."""
_OPERATORS = {"add": "+", "sub": "-", "mul": "*", "div": "/", "lt": "<", "le": "<="}
_LOGIC = {"and": ("and", "&"), "or": ("or", "|")}


def function(
    name: str, arguments: str, unpack: Mapping[str, str], outputs: Sequence[Any]
) -> Callable[..., Any]:
    """A Python function of floats that returns the outputs as a list.

    Parameters
    ----------
    name : name of the function
    arguments : arguments of the function, ``"t, y, m"``
    unpack : code for every variable and flag by name, such as ``{"x": "y[0]"}``; a key with several
        names, ``"a, b"``, unpacks them together
    outputs : expressions to compute
    """
    scope: dict[str, Any] = {f"_{key}": getattr(math, key) for key in _MATH}
    return _compiled(name, arguments, unpack, outputs, scope, {}, many=False)


def vectorised(
    name: str,
    arguments: str,
    unpack: Mapping[str, str],
    outputs: Sequence[Any],
    known: Mapping[Symbol, str] | None = None,
    library: Any = np,
) -> Callable[..., Any]:
    """Like `function`, but for arrays, so that both branches of every choice are computed.

    `known` gives code for expressions that are already computed; `library` is NumPy or a
    library with the same function names.
    """
    scope: dict[str, Any] = {f"_{key}": getattr(library, _NUMPY.get(key, key)) for key in _MATH}
    scope["_where"], scope["_not"] = library.where, library.logical_not
    return _compiled(name, arguments, unpack, outputs, scope, known or {}, many=True)


_MATH = ("sqrt", "exp", "expm1", "log", "log1p", "tanh", "sin", "cos", "atan2", "pow")
_NUMPY = {"pow": "power", "atan2": "arctan2"}


def _compiled(
    name: str,
    arguments: str,
    unpack: Mapping[str, str],
    outputs: Sequence[Any],
    scope: dict[str, Any],
    known: Mapping[Symbol, str],
    *,
    many: bool,
) -> Callable[..., Any]:
    nodes = needed(outputs, {symbol.index for symbol in known})
    scope["_nan"], scope["_inf"] = math.nan, math.inf
    if nodes:
        scope |= {f"_table{i}": table for i, table in enumerate(nodes[0].graph.tables)}
    used = {node.args[0] for node in nodes if node.op in ("variable", "flag")}
    lines = [
        f" {names} = {code}"
        for names, code in unpack.items()
        if any(variable.strip() in used for variable in names.split(","))
    ]
    lines += _lines(nodes, outputs, known, many)
    source = f"def {name}({arguments}):\n" + "\n".join(lines)
    exec(compile(source, f"<{name}>", "exec"), scope)  # generated text, no input
    compiled: Callable[..., Any] = scope[name]
    return compiled


def _lines(
    nodes: Sequence[Symbol], outputs: Sequence[Any], known: Mapping[Symbol, str], many: bool
) -> list[str]:
    """Lines of code: one for every node that is used twice or nested deeply, then the return."""
    uses: dict[int, int] = {}
    for node in nodes:
        for operand in node.operands:
            uses[operand.index] = uses.get(operand.index, 0) + 1
    for out in outputs:
        if isinstance(out, Symbol):
            uses[out.index] = uses.get(out.index, 0) + 1
    lines: list[str] = []
    text = {symbol.index: code for symbol, code in known.items()}
    depth = {symbol.index: 0 for symbol in known}

    def code_of(value: Any) -> str:
        return text[value.index] if isinstance(value, Symbol) else _literal(value)

    for node in nodes:
        code = _code(node, code_of, many)
        deep = 1 + max((depth[o.index] for o in node.operands), default=0)
        plain = node.op in ("variable", "flag")
        if plain or (uses[node.index] == 1 and deep < DEEPEST):
            text[node.index], depth[node.index] = code, 0 if plain else deep
        else:
            lines.append(f" _{node.index} = {code}")  # no variable has such a name
            text[node.index], depth[node.index] = f"_{node.index}", 0
    lines.append(f" return [{', '.join(code_of(out) for out in outputs)}]")
    return lines


def _literal(value: Any) -> str:
    if isinstance(value, bool):
        return repr(value)
    if value != value:
        return "_nan"
    if math.isinf(value):
        return "_inf" if value > 0 else "(-_inf)"
    number = repr(float(value))  # the text of NumPy numbers includes their type
    return number if value >= 0 else f"({number})"


def _code(node: Symbol, code_of: Callable[[Any], str], many: bool) -> str:
    op = node.op
    if op in ("variable", "flag"):
        return str(node.args[0])
    if op == "table":
        return f"_table{node.args[0]}({code_of(node.args[1])})"
    args = [code_of(a) for a in node.args]
    if op in _OPERATORS:
        return f"({args[0]} {_OPERATORS[op]} {args[1]})"
    if op in _LOGIC:
        return f"({args[0]} {_LOGIC[op][many]} {args[1]})"
    if op == "where":
        return (
            f"_where({args[0]}, {args[1]}, {args[2]})"
            if many
            else f"({args[1]} if {args[0]} else {args[2]})"
        )
    if op == "not":
        return f"_not({args[0]})" if many else f"(not {args[0]})"
    if op == "neg":
        return f"(-{args[0]})"
    return f"_{op}({', '.join(args)})"
