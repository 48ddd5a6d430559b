"""Arrays of symbols: NumPy arrays whose elements record every operation of a model.

A model that accepts NumPy arrays runs unchanged on these. Every element becomes a symbol of an
exact graph (`Graph.truth`), so the recorded operations repeat those of NumPy, NaN included.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from .expression import Graph, Symbol, needed


class SymbolArray(np.ndarray):
    """An object array whose elements are symbols of one exact graph, numbers or truth values."""

    __array_priority__ = 100.0

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        plain = [_plain(value) for value in inputs]
        if ufunc is np.matmul:
            return _matmul(*inputs)
        function = _UFUNCS.get(ufunc)
        if function is None:
            raise TypeError(f"cannot record numpy.{ufunc.__name__} of symbols")
        if method == "__call__":
            if options.get("out") is not None or options.get("where", True) is not True:
                raise TypeError(
                    f"cannot record numpy.{ufunc.__name__} with the arguments out or where"
                )
            return wrapped(function(*plain))
        if method == "reduce":
            return _reduced(function, plain[0], **options)
        if method in ("accumulate", "outer"):
            options.pop("dtype", None)
            return wrapped(getattr(function, method)(*plain, **options))
        raise TypeError(f"cannot record numpy.{ufunc.__name__}.{method} of symbols")

    def __array_function__(self, func: Any, types: Any, args: Any, kwargs: Any) -> Any:
        own = _FUNCTIONS.get(func)
        if own is not None:
            return own(*args, **kwargs)
        if func not in _STRUCTURAL:
            raise TypeError(f"cannot record numpy.{func.__name__} of symbols")
        kwargs = {name: _plain(value) for name, value in kwargs.items()}
        return wrapped(func(*(_plain(value) for value in args), **kwargs))

    def __array_namespace__(self, *, api_version: str | None = None) -> Any:
        return NAMESPACE

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, SymbolArray):
            raise TypeError("cannot record an array index that depends on symbols")
        value = self.view(np.ndarray)[key]
        return wrapped(value if isinstance(value, np.ndarray) else _boxed(value))

    def __iter__(self) -> Any:
        return (self[k] for k in range(len(self)))

    @property  # type: ignore[misc]  # NumPy's may be assigned to
    def real(self) -> Any:
        """The values without their derivatives."""
        return wrapped(_REAL(self.view(np.ndarray)))

    def __bool__(self) -> bool:
        return bool(self.view(np.ndarray).item())

    def item(self, *index: Any) -> Any:
        """The single element: a plain number, or an array without axes that contains a symbol."""
        value = self.view(np.ndarray).item(*index)
        return wrapped(_boxed(value)) if isinstance(value, Symbol) else value


def _boxed(value: Any) -> Any:
    box = np.empty((), dtype=object)
    box[()] = value
    return box


def wrapped(value: Any) -> Any:
    """Convert an object array to an array of symbols, or of plain numbers if it has no symbols."""
    if isinstance(value, (list, tuple)):
        parts = [wrapped(part) for part in value]
        return parts if isinstance(value, list) else tuple(parts)
    if not isinstance(value, np.ndarray):
        return wrapped(_boxed(value)) if isinstance(value, Symbol) else value
    if value.dtype != object:
        return value
    flat = value.ravel().tolist()
    for element in flat:
        if type(element) is Symbol:
            return value.view(SymbolArray)
    kind = (
        bool if flat and all(isinstance(element, (bool, np.bool_)) for element in flat) else float
    )
    return value.view(np.ndarray).astype(kind)


def _plain(value: Any) -> Any:
    if isinstance(value, SymbolArray):
        return value.view(np.ndarray)
    if isinstance(value, (list, tuple)):
        parts = [_plain(part) for part in value]
        return parts if isinstance(value, list) else tuple(parts)
    return value


# ---- operations on elements, with NumPy's results for numbers ----


def _of_numbers(ufunc: Any, *values: Any) -> Any:
    with np.errstate(all="ignore"):
        known = (np.float64(v) if type(v) is not bool else np.bool_(v) for v in values)
        return ufunc(*known).item()


def _recorded(op: str, ufunc: Any) -> Callable[..., Any]:
    def one(a: Any) -> Any:
        if isinstance(a, Symbol):
            return a.graph.exact_node(op, a)
        return _of_numbers(ufunc, a)

    def two(a: Any, b: Any) -> Any:
        if isinstance(a, Symbol):
            return a.graph.exact_node(op, a, b if isinstance(b, Symbol) else float(b))
        if isinstance(b, Symbol):
            return b.graph.exact_node(op, float(a), b)
        return _of_numbers(ufunc, a, b)

    return one if ufunc.nin == 1 else two


def _multiply(a: Any, b: Any) -> Any:
    """Product; a factor of 1 changes nothing."""
    if type(a) is not Symbol:
        if type(b) is not Symbol:
            return _of_numbers(np.multiply, a, b)
        return b if a == 1.0 and b.op not in BOOLEAN else b.graph.exact_node("mul", b, float(a))
    if type(b) is not Symbol:
        return a if b == 1.0 and a.op not in BOOLEAN else a.graph.exact_node("mul", a, float(b))
    return a.graph.exact_node("mul", a, b)


BOOLEAN = frozenset({"lt", "le", "eq", "and", "or", "not", "isnan"})
"""Operations that result in a truth value."""


def _power(a: Any, b: Any) -> Any:
    if isinstance(a, Symbol) and not isinstance(b, Symbol):
        b = float(b)
        if b == 2.0:
            return a.graph.exact_node("mul", a, a)
        if b == 1.0:
            return a
        if b == 0.5:
            return a.graph.exact_node("sqrt", a)
        if b == -1.0:
            return a.graph.exact_node("div", 1.0, a)
    return _RAISED(a, b)


def _real(value: Any) -> Any:
    if not isinstance(value, Symbol) or value.op in BOOLEAN or value.op == "real":
        return value
    return value.graph.exact_node("real", value)


def _strip(value: Any) -> Any:
    """Replace a recorded `real(x)` by x itself, where derivatives do not matter (comparisons)."""
    return value.args[0] if isinstance(value, Symbol) and value.op == "real" else value


def _compared(op: str, ufunc: Any, *, swap: bool = False) -> Callable[..., Any]:
    inner = _recorded(op, ufunc)

    def compared(a: Any, b: Any) -> Any:
        a, b = _strip(a), _strip(b)
        return inner(b, a) if swap else inner(a, b)

    return compared


def _both(a: Any, b: Any) -> Any:
    if not isinstance(a, Symbol):
        return (b if isinstance(b, Symbol) else bool(b)) if a else False
    if not isinstance(b, Symbol):
        return a if b else False
    return a if a is b else a.graph.exact_node("and", a, b)


def _either(a: Any, b: Any) -> Any:
    if not isinstance(a, Symbol):
        return True if a else (b if isinstance(b, Symbol) else bool(b))
    if not isinstance(b, Symbol):
        return True if b else a
    return a if a is b else a.graph.exact_node("or", a, b)


def _opposite(a: Any) -> Any:
    if not isinstance(a, Symbol):
        return not a
    return a.args[0] if a.op == "not" else a.graph.exact_node("not", a)


def _choice(condition: Any, yes: Any, no: Any) -> Any:
    if not isinstance(condition, Symbol):
        return yes if condition else no
    if yes is no:
        return yes
    return condition.graph.exact_node(
        "where",
        condition,
        yes if isinstance(yes, Symbol) else float(yes),
        no if isinstance(no, Symbol) else float(no),
    )


_less = _compared("lt", np.less)
_less_equal = _compared("le", np.less_equal)


def _is_nan(a: Any) -> Any:
    a = _strip(a)
    return a.graph.exact_node("isnan", a) if isinstance(a, Symbol) else bool(a != a)


def _is_finite(a: Any) -> Any:
    return _less(_ABSOLUTE(_strip(a)), math.inf)


def _extreme(*, largest: bool, keep_nan: bool) -> Callable[[Any, Any], Any]:
    def extreme(a: Any, b: Any) -> Any:
        first = _less_equal(b, a) if largest else _less_equal(a, b)
        return _choice(_either(first, _is_nan(a if keep_nan else b)), a, b)

    return extreme


_RAISED = _recorded("pow", np.power)
_ABSOLUTE = _recorded("abs", np.absolute)


_ELEMENTS: dict[Any, Callable[..., Any]] = {
    np.multiply: _multiply,
    np.power: _power,
    np.float_power: _power,
    np.square: lambda a: _multiply(a, a),
    np.conjugate: lambda a: a,
    np.positive: lambda a: a,
    np.less: _less,
    np.less_equal: _less_equal,
    np.greater: _compared("lt", np.less, swap=True),
    np.greater_equal: _compared("le", np.less_equal, swap=True),
    np.equal: _compared("eq", np.equal),
    np.not_equal: lambda a, b: _opposite(_compared("eq", np.equal)(a, b)),
    np.logical_and: _both,
    np.bitwise_and: _both,
    np.logical_or: _either,
    np.bitwise_or: _either,
    np.logical_not: _opposite,
    np.invert: _opposite,
    np.isnan: _is_nan,
    np.isfinite: _is_finite,
    np.isinf: lambda a: _compared("eq", np.equal)(_ABSOLUTE(_strip(a)), math.inf),
    np.maximum: _extreme(largest=True, keep_nan=True),
    np.minimum: _extreme(largest=False, keep_nan=True),
    np.fmax: _extreme(largest=True, keep_nan=False),
    np.fmin: _extreme(largest=False, keep_nan=False),
}
NUMPY_OF: dict[str, Any] = {
    "mul": np.multiply, "pow": np.power, "lt": np.less, "le": np.less_equal, "eq": np.equal,
    "and": np.logical_and, "or": np.logical_or, "not": np.logical_not, "isnan": np.isnan,
    "where": np.where, "real": np.positive,
}  # fmt: skip
"""NumPy's function for every operation of an exact graph."""
for _op, _ufunc in (
    ("add", np.add), ("sub", np.subtract), ("div", np.divide), ("neg", np.negative),
    ("sqrt", np.sqrt), ("exp", np.exp), ("expm1", np.expm1), ("log", np.log),
    ("log1p", np.log1p), ("sin", np.sin), ("cos", np.cos), ("tan", np.tan), ("tanh", np.tanh),
    ("sinh", np.sinh), ("cosh", np.cosh), ("arctan", np.arctan), ("arcsin", np.arcsin),
    ("arccos", np.arccos), ("atan2", np.arctan2), ("abs", np.absolute), ("sign", np.sign),
    ("floor", np.floor), ("cbrt", np.cbrt), ("copysign", np.copysign),
    ("hypot", np.hypot),
):  # fmt: skip
    _ELEMENTS[_ufunc] = _recorded(_op, _ufunc)
    NUMPY_OF[_op] = _ufunc
_DIVIDE: Callable[..., Any] = _ELEMENTS[np.divide]
_ELEMENTS[np.reciprocal] = lambda a: _DIVIDE(1.0, a)
_UFUNCS: dict[Any, Any] = {
    ufunc: np.frompyfunc(element, ufunc.nin, 1) for ufunc, element in _ELEMENTS.items()
}
_WHERE = np.frompyfunc(_choice, 3, 1)
_REAL = np.frompyfunc(_real, 1, 1)


def _reduced(
    function: Any, values: Any, axis: Any = 0, keepdims: bool = False, **options: Any
) -> Any:
    options.pop("dtype", None)
    if options.get("out") is not None or options.get("where", True) is not True:
        raise TypeError("cannot record reductions with the arguments out or where")
    known = {"initial": options["initial"]} if "initial" in options else {}
    if known.get("initial", 0.0) is np._NoValue:
        known = {}
    if axis is None:
        axis = tuple(range(values.ndim))
    axes = sorted((a % values.ndim for a in np.atleast_1d(axis)), reverse=True)
    if not values.size and "initial" not in known:
        known = {"initial": _EMPTY[function]}
    for a in axes:
        values = function.reduce(values, axis=a, keepdims=keepdims, **known)
        if not isinstance(values, np.ndarray):
            values = _boxed(values)
    return wrapped(values)


_EMPTY = {
    _UFUNCS[np.add]: 0.0,
    _UFUNCS[np.multiply]: 1.0,
    _UFUNCS[np.logical_and]: True,
    _UFUNCS[np.logical_or]: False,
}
_FUNCTIONS: dict[Any, Callable[..., Any]] = {}
_STRUCTURAL = frozenset({
    np.stack, np.concatenate, np.expand_dims, np.reshape, np.squeeze, np.transpose, np.moveaxis,
    np.swapaxes, np.broadcast_to, np.broadcast_arrays, np.ravel, np.atleast_1d, np.atleast_2d,
    np.atleast_3d, np.repeat, np.tile, np.roll, np.flip, np.vstack, np.hstack, np.copy,
    np.diagonal, np.take, np.shape, np.ndim, np.size, np.split, np.array_split, np.append,
    np.column_stack,
})  # fmt: skip


def _implements(*functions: Any) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    def add(own: Callable[..., Any]) -> Callable[..., Any]:
        for function in functions:
            _FUNCTIONS[function] = own
        return own

    return add


@_implements(np.where)
def _where(condition: Any, yes: Any, no: Any) -> Any:
    return wrapped(_WHERE(_plain(condition), _plain(yes), _plain(no)))


for _function, _reducing in (
    (np.sum, np.add), (np.prod, np.multiply), (np.any, np.logical_or), (np.all, np.logical_and),
    (np.max, np.maximum), (np.min, np.minimum), (np.nanmax, np.fmax), (np.nanmin, np.fmin),
):  # fmt: skip

    def _reduction(
        values: Any,
        axis: Any = None,
        keepdims: bool = False,
        *,
        _u: Any = _reducing,
        **options: Any,
    ) -> Any:
        options.pop("out", None)
        return _reduced(_UFUNCS[_u], _plain(NAMESPACE.asarray(values)), axis, keepdims, **options)

    _FUNCTIONS[_function] = _reduction


@_implements(np.mean)
def _mean(values: Any, axis: Any = None, **options: Any) -> Any:
    count = values.size if axis is None else values.shape[axis]
    return np.sum(values, axis=axis, **options) / count


@_implements(np.real)
def _np_real(value: Any) -> Any:
    return value.real


@_implements(np.iscomplexobj)
def _is_complex(_: Any) -> bool:
    return False


@_implements(np.result_type)
def _type(*_: Any) -> Any:
    return np.dtype(float)


@_implements(np.zeros_like)
def _zeros(values: Any, **_: Any) -> Any:
    return np.zeros(values.shape)


@_implements(np.ones_like)
def _ones(values: Any, **_: Any) -> Any:
    return np.ones(values.shape)


@_implements(np.full_like)
def _full(values: Any, fill: Any, **_: Any) -> Any:
    return np.broadcast_to(NAMESPACE.asarray(fill), np.shape(values))


@_implements(np.nan_to_num)
def _no_nan(values: Any, nan: float = 0.0, **_: Any) -> Any:
    return np.where(np.isnan(values), nan, values)


@_implements(np.clip)
def _clip(values: Any, low: Any = None, high: Any = None, **_: Any) -> Any:
    values = values if low is None else np.maximum(values, low)
    return values if high is None else np.minimum(values, high)


@_implements(np.cumsum, np.cumulative_sum)
def _cumsum(values: Any, axis: int = 0, **_: Any) -> Any:
    return wrapped(_UFUNCS[np.add].accumulate(_plain(values), axis=axis))


@_implements(np.diff)
def _diff(values: Any, axis: int = -1, **_: Any) -> Any:
    before = (slice(None),) * (axis % values.ndim)
    return values[(*before, slice(1, None))] - values[(*before, slice(None, -1))]


def _matmul(first: Any, second: Any) -> Any:
    first, second = NAMESPACE.asarray(first), NAMESPACE.asarray(second)
    if second.ndim == 1:
        return (first * second).sum(axis=-1)
    if first.ndim == 1:
        return (first[:, None] * second).sum(axis=-2)
    return (first[..., :, :, None] * second[..., None, :, :]).sum(axis=-2)


_implements(np.dot)(_matmul)


@_implements(np.einsum)
def _einsum(subscripts: str, *operands: Any, **_: Any) -> Any:
    inputs, output = subscripts.replace(" ", "").split("->")
    parts = inputs.split(",")
    if "." in subscripts:
        raise TypeError(f"cannot record einsum {subscripts}")
    letters = [*output, *sorted(set("".join(parts)) - set(output))]
    total: Any = None
    for part, operand in zip(parts, operands, strict=True):
        order = sorted(range(len(part)), key=lambda k: letters.index(part[k]))
        turned = np.transpose(NAMESPACE.asarray(operand), order)
        present = {part[k] for k in order}
        turned = turned[tuple(slice(None) if x in present else None for x in letters)]
        total = turned if total is None else total * turned
    extra = tuple(range(len(output), len(letters)))
    return np.sum(total, axis=extra) if extra else total


def _index_of(values: Any, axis: Any, *, largest: bool) -> Any:
    values = NAMESPACE.asarray(values)
    if axis is None:
        values, axis = values.reshape(-1), 0
    parts = [np.take(values, k, axis=axis) for k in range(values.shape[axis])]
    best, index = parts[0], np.zeros(np.shape(parts[0]))
    for k, part in enumerate(parts[1:], 1):
        better = part > best if largest else part < best
        better = better | (np.isnan(part) & ~np.isnan(best))
        best, index = np.where(better, part, best), np.where(better, float(k), index)
    return index


@_implements(np.argmax)
def _argmax(values: Any, axis: Any = None, **_: Any) -> Any:
    return _index_of(values, axis, largest=True)


@_implements(np.argmin)
def _argmin(values: Any, axis: Any = None, **_: Any) -> Any:
    return _index_of(values, axis, largest=False)


@_implements(np.take_along_axis)
def _take_along(values: Any, indices: Any, axis: int) -> Any:
    if not isinstance(indices, SymbolArray):
        return wrapped(np.take_along_axis(_plain(values), indices.astype(int), axis))
    values, axis = NAMESPACE.asarray(values), axis % indices.ndim
    columns = []
    for j in range(indices.shape[axis]):
        index = np.take(indices, [j], axis=axis)
        total = np.take(values, [0], axis=axis)
        for i in range(1, values.shape[axis]):
            total = np.where(index == float(i), np.take(values, [i], axis=axis), total)
        columns.append(total)
    return np.concatenate(columns, axis=axis)


def asarray(value: Any, dtype: Any = None, **_: Any) -> Any:
    """An array of the value: symbols stay symbols, also within lists."""
    if isinstance(value, SymbolArray):
        return value
    if isinstance(value, (list, tuple)) and any(_symbolic(part) for part in value):
        parts = [asarray(part) for part in value]
        return np.stack(parts)
    return np.asarray(value, dtype=dtype)


def _symbolic(value: Any) -> bool:
    if isinstance(value, (list, tuple)):
        return any(_symbolic(part) for part in value)
    return isinstance(value, (SymbolArray, Symbol))


def _root_parts(coefficients: Sequence[Any]) -> tuple[Any, Any]:
    """Real and imaginary parts of all roots of polynomials; their derivatives are not recorded.

    The coefficients are given with that of the lowest power first.
    """
    rows = np.broadcast_arrays(*(_plain(asarray(c)) for c in coefficients))
    shape, degree = rows[0].shape, len(rows) - 1
    along, across = (np.empty((*shape, degree), dtype=object) for _ in range(2))
    for at in np.ndindex(shape):
        values = [_strip(row[at]) for row in rows]
        symbol = next((value for value in values if isinstance(value, Symbol)), None)
        if symbol is None:
            raise TypeError(
                "cannot record the roots of a polynomial whose coefficients are all plain numbers"
            )
        node = symbol.graph.exact_node(
            "roots", *(v if isinstance(v, Symbol) else float(v) for v in values)
        )
        for k in range(degree):
            along[(*at, k)] = symbol.graph.exact_node("part", node, k)
            across[(*at, k)] = symbol.graph.exact_node("part", node, degree + k)
    return along.view(SymbolArray), across.view(SymbolArray)


def _finished(active: Any) -> bool:
    """Whether no element is active; see `numeric.finished`."""
    (active_at_all,) = elements(asarray(np.any(active)))
    if not isinstance(active_at_all, Symbol):
        return not active_at_all
    assert active_at_all.graph.truth is not None
    return not active_at_all.graph.truth(active_at_all, one_sided=True)


NAMESPACE: Any = SimpleNamespace(
    **{name: getattr(np, name) for name in dir(np) if not name.startswith("_")}
)
NAMESPACE.asarray = asarray
NAMESPACE.array = asarray
NAMESPACE.real_sqrt = np.sqrt
NAMESPACE.root_parts = _root_parts
NAMESPACE.finished = _finished


def elements(values: Any) -> list[Any]:
    """The elements of an array, symbols or numbers, in order."""
    flat: list[Any] = _plain(values).ravel().tolist()
    return flat


_QUICK: dict[str, Callable[..., Any]] = {
    "add": operator.add,
    "sub": operator.sub,
    "mul": operator.mul,
    "neg": operator.neg,
    "lt": operator.lt,
    "le": operator.le,
    "eq": operator.eq,
    "and": lambda a, b: bool(a and b),
    "or": lambda a, b: bool(a or b),
    "not": operator.not_,
    "where": lambda condition, yes, no: yes if condition else no,
    "real": operator.pos,
    "abs": abs,
    "isnan": lambda a: a != a,
}
"""Operations on Python numbers with the same results as those of NumPy, but many times faster."""


class Recorder:
    """Records every operation of a model, along the branches that it takes at a given point.

    Attributes
    ----------
    graph : the recorded operations
    guards : conditions on which the model branched, each with its truth at the point
    """

    def __init__(self) -> None:
        self.graph = Graph(truth=self.decide)
        self.guards: dict[Symbol, bool] = {}
        self._known: dict[int, Any] = {}
        """Values at the point, by index of the node."""

    def variables(self, names: Sequence[str], values: Any) -> SymbolArray:
        """Add variables with their values at the point; return them as an array (variables, 1)."""
        symbols = np.empty((len(names), 1), dtype=object)
        for k, (name, value) in enumerate(zip(names, values, strict=True)):
            symbols[k, 0] = self.graph.variable(name)
            self._known[symbols[k, 0].index] = float(value)
        return symbols.view(SymbolArray)

    def value(self, symbol: Any) -> Any:
        """Value of a symbol at the point."""
        if not isinstance(symbol, Symbol):
            return symbol
        known = self._known
        for node in needed([symbol], known):
            if node.op not in NUMPY_OF:
                raise TypeError("cannot record a branch that depends on the roots of a polynomial")
            operands = [known[a.index] if type(a) is Symbol else a for a in node.args]
            quick = _QUICK.get(node.op)
            known[node.index] = (
                _of_numbers(NUMPY_OF[node.op], *operands) if quick is None else quick(*operands)
            )
        return known[symbol.index]

    def decide(self, symbol: Symbol, *, one_sided: bool = False) -> bool:
        """Record a condition on which the model branches; return its truth at the point.

        A `one_sided` condition that is true is no guard: the branch is correct for all points.
        """
        symbol = _strip(symbol)
        answer = bool(self.value(symbol))
        if not (answer and one_sided):
            self.guards[symbol] = answer
        return answer
