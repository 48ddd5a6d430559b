"""A problem in logarithms: linear rows, and curves with one argument.

Every traced value of known sign is a monomial of atoms. A sum s = p + q makes a new atom with log s
- log q = softplus(log p - log q), a curve of the log ratio of its terms. The curve is convex on one
side and is relaxed by its chord on the other; a shorter range of the ratio gives a tighter chord.
This is the log-log convex relaxation of a signomial programme [Maranas1997], applied to every sum.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

from .shapes import Kind
from .signomial import Form


class Unknown(Exception):
    """A value of unknown sign, or without a relaxation of its model; carries the reason."""


class Curve(NamedTuple):
    """out = function(argument), both affine in the atoms' logarithms."""

    kind: Kind
    argument: Form
    out: Form


class Link(NamedTuple):
    """Two plain atoms of one argument: out = e^level f(argument), base is the argument itself.

    `curve` is the table of log f by the logarithm of the argument.
    """

    out: int
    base: int
    level: float
    curve: Curve


class Product(NamedTuple):
    """Three plain atoms: out = e^level * first * second."""

    out: int
    first: int
    second: int
    level: float


Maker: TypeAlias = Callable[[Sequence[float]], float]
"""Logarithm of an atom from earlier atoms."""


class ConstraintRow(NamedTuple):
    """low <= high."""

    low: Form
    high: Form


@dataclass
class Relaxation:
    """Atoms with their bounds (logarithms), linear rows and curves.

    `makers` compute the logarithm of every atom at a design, from earlier ones.
    """

    makers: list[Maker] = field(default_factory=list)
    lower: list[float] = field(default_factory=list)
    upper: list[float] = field(default_factory=list)
    rows: list[ConstraintRow] = field(default_factory=list)
    curves: list[Curve] = field(default_factory=list)
    splits: list[tuple[Form, Form, Form]] = field(default_factory=list)
    """Every sum: the whole, and its two parts."""
    links: list[Link] = field(default_factory=list)
    products: list[Product] = field(default_factory=list)
    sums: dict[tuple[Form, Form], Form] = field(default_factory=dict)

    def atom(self, low: float, high: float, maker: Maker) -> Form:
        """Add a positive unknown between two numbers."""
        self.makers.append(maker)
        self.lower.append(math.log(low) if low > 0 else -math.inf)
        self.upper.append(math.log(high) if high < math.inf else math.inf)
        return Form(0.0, ((len(self.lower) - 1, 1.0),))

    def reach(self, form: Form) -> tuple[float, float]:
        """Bounds of a monomial's logarithm."""
        low = high = form.constant
        for i, power in form.powers:
            ends = (power * self.lower[i], power * self.upper[i])
            low, high = low + min(ends), high + max(ends)
        return low, high

    def total(self, terms: Sequence[Form], low: float, high: float) -> Form:
        """Logarithm of a sum of monomials, with bounds of its value."""
        common = _common(terms)
        least, most = self.reach(common)
        low = low * math.exp(-min(most, 700.0)) if low > 0 else low
        high = high * math.exp(-least) if least > -700 else math.inf
        first, *others = (term - common for term in terms)
        for i, term in enumerate(others):
            last = i == len(others) - 1
            first = self._sum(first, term, low if last else 0.0, high)
        return first + common

    def _sum(self, first: Form, second: Form, low: float, high: float) -> Form:
        if first.powers == second.powers:  # a known ratio
            return Form(log_of_sum(first.constant, second.constant), first.powers)
        key = (first, second) if first <= second else (second, first)
        if key not in self.sums:
            self.sums[key] = self.atom(low, high, lambda y: log_of_sum(first.at(y), second.at(y)))
            self.split(self.sums[key], *key)
        return self.sums[key]

    def split(self, whole: Form, part: Form, rest: Form) -> None:
        """Add the constraint whole = part + rest."""
        self.curves.append(Curve("softplus", part - rest, whole - rest))
        self.splits.append((whole, part, rest))


def log_of_sum(first: float, second: float) -> float:
    """Logarithm of the sum of two numbers, given by their logarithms."""
    high, low = max(first, second), min(first, second)
    return high + math.log1p(math.exp(low - high))


def _common(terms: Sequence[Form]) -> Form:
    """The greatest monomial that divides all terms."""
    if len(terms) < 2:
        return Form(0.0)
    first, *others = (dict(term.powers) for term in terms)
    found = []
    for i, power in first.items():
        powers = [power, *(other.get(i, 0.0) for other in others)]
        least = min(powers) if min(powers) > 0 else max(powers) if max(powers) < 0 else 0.0
        if least:
            found.append((i, least))
    return Form(0.0, tuple(sorted(found)))
