"""Sampled tables of traced values that depend on a single other value."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ...base.symbolic import Symbol, vectorised
from ..problem import Vector

SAMPLES = 1001
"""Number of samples over the range of the argument."""

CAUTION = 1.5
"""Safety factor on the second derivative of the samples."""

_LOGIC = ("lt", "le", "and", "or", "not")


class Leads:
    """The lead of each value: the one value through which it depends on all variables."""

    def __init__(self) -> None:
        self._known: dict[int, Symbol] = {}

    def of(self, node: Symbol) -> Symbol:
        """The lead of a value."""
        if node.index not in self._known:
            under = {self.of(one) for one in node.operands}
            self._known[node.index] = under.pop() if len(under) == 1 else node
        return self._known[node.index]


def function(nodes: Sequence[Symbol], lead: Symbol) -> Callable[[Vector], Vector]:
    """A function for values (nodes, n) of nodes with one lead, from its logarithms (n,)."""
    code = vectorised("lone", "value", {}, nodes, known={lead: "value"})

    def values(t: Vector) -> Vector:
        with np.errstate(all="ignore"):
            rows = code(np.exp(t))
        return np.stack([np.broadcast_to(np.asarray(row, dtype=float), t.shape) for row in rows])

    return values


def samples(lead: Symbol) -> Vector:
    """Sampled logarithms over the range of a positive value."""
    low, high = np.log(lead.bounds)
    return np.linspace(low, high, SAMPLES)


def ranges(nodes: Sequence[Symbol]) -> dict[Symbol, tuple[float, float]]:
    """Ranges of all values with a positive lead, if finite."""
    leads = Leads()
    groups: dict[Symbol, list[Symbol]] = {}
    for node in nodes:
        lead = leads.of(node)
        if lead is node or node.op in _LOGIC:
            continue
        if 0 < lead.bounds[0] < lead.bounds[1] < np.inf:
            groups.setdefault(lead, []).append(node)
    found = {}
    for lead, some in groups.items():
        for node, row in zip(some, function(some, lead)(samples(lead)), strict=True):
            if np.isfinite(row).all():
                room = CAUTION * float(np.abs(np.diff(row, 2)).max()) / 8
                found[node] = (float(row.min()) - room, float(row.max()) + room)
    return found
