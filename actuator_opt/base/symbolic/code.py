"""Expressions as generated Python code."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from .expression import Symbol, needed

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
