"""Traced values of one variable alone: sampled, with room for what lies between the samples."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ...symbolic import Symbol, vectorised
from ..problem import Vector

SAMPLES = 2001
"""Samples over the range of the variable."""

CAUTION = 1.5
"""Largest second derivative over that of the samples."""


class Alone:
    """Which variable a value depends on, where it is one."""

    def __init__(self) -> None:
        self._known: dict[int, Symbol | None] = {}

    def variable(self, node: Symbol) -> Symbol | None:
        """The only variable under a value; None of several, or of none."""
        if node.index not in self._known:
            if node.op == "variable":
                self._known[node.index] = node
            else:
                under = {self.variable(one) for one in node.operands}
                self._known[node.index] = under.pop() if len(under) == 1 else None
        return self._known[node.index]


class Sampled(NamedTuple):
    """A function of the logarithm of a variable: its range, and the room that the samples need."""

    low: float
    high: float
    room: float
    """Most that it leaves its secant between two samples."""


def function(nodes: Sequence[Symbol], variable: Symbol) -> Callable[[Vector], Vector]:
    """Values (nodes, n) of nodes of one variable, from its logarithms (n,)."""
    code = vectorised("alone", "value", {str(variable.args[0]): "value"}, nodes)

    def values(t: Vector) -> Vector:
        with np.errstate(all="ignore"):
            rows = code(np.exp(t))
        return np.stack([np.broadcast_to(np.asarray(row, dtype=float), t.shape) for row in rows])

    return values


def samples(variable: Symbol) -> Vector:
    """Logarithms over the range of a variable."""
    low, high = np.log(variable.bounds)
    return np.linspace(low, high, SAMPLES)


def sampled(values: Vector) -> Sampled:
    """What equally spaced samples say of a smooth function."""
    room = CAUTION * float(np.abs(np.diff(values, 2)).max()) / 8
    return Sampled(float(values.min()), float(values.max()), room)


def ranges(nodes: Sequence[Symbol]) -> dict[Symbol, tuple[float, float]]:
    """Ranges of all values that depend on one positive variable, where they are finite."""
    alone = Alone()
    groups: dict[Symbol, list[Symbol]] = {}
    for node in nodes:
        variable = alone.variable(node)
        if variable is None or node.op in ("variable", "lt", "le", "and", "or", "not"):
            continue
        if 0 < variable.bounds[0] < variable.bounds[1] < np.inf:
            groups.setdefault(variable, []).append(node)
    found = {}
    for variable, some in groups.items():
        for node, row in zip(some, function(some, variable)(samples(variable)), strict=True):
            if np.isfinite(row).all():
                one = sampled(row)
                found[node] = (one.low - one.room, one.high + one.room)
    return found
