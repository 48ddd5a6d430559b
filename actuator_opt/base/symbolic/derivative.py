"""Exact derivatives of expressions."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

from .expression import Namespace, Symbol, choose, is_boolean, less, needed, power

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
    "sin": lambda node, a: _scaled(Namespace.cos(a)),
    "cos": lambda node, a: _scaled(-Namespace.sin(a)),
}
"""For every operation, the rule that gives its derivative from the derivatives of its operands."""
