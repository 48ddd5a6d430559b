"""A problem in logarithms: linear rows, and curves with one argument.

Every traced value of known sign is a monomial of atoms. A sum s = p + q makes a new atom with log s
- log q = softplus(log p - log q), a curve of the log ratio of its terms. The curve is convex on one
side and is relaxed by its chord on the other; a shorter range of the ratio gives a tighter chord.
This is the log-log convex relaxation of a signomial programme [Maranas1997], applied to every sum.

Signomials: sums of signed monomials, and the logarithms of monomials.

A monomial is a positive number times powers of atoms (positive unknowns); its logarithm is affine
in the atoms' logarithms. Products, quotients and powers of monomials are monomials.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np

from ..problem import Vector

Name: TypeAlias = Literal["softplus", "exp", "log", "tanh"]
Function: TypeAlias = Callable[[Vector], Vector]
LEAST = 1e-300
"""Substitute for zero under a logarithm."""
FAR = 200.0
"""Largest logarithm of an atom or a ratio; e^200 is beyond any quantity."""


class MonotoneFunction(NamedTuple):
    """An increasing function with its slope and its inverse; convex (1) or concave (-1)."""

    value: Function
    slope: Function
    inverse: Function
    convex: int


def _softplus_inverse(y: Vector) -> Vector:
    """log(e^y - 1)."""
    held = np.maximum(y, LEAST)
    return held + np.log(-np.expm1(-held))


def _exp(x: Vector) -> Vector:
    return np.exp(np.minimum(x, 700.0))


def _log(x: Vector) -> Vector:
    return np.log(np.maximum(x, LEAST))


SHAPES: dict[Name, MonotoneFunction] = {
    "softplus": MonotoneFunction(
        lambda x: np.logaddexp(0.0, x),
        lambda x: 1 / (1 + np.exp(-np.maximum(x, -700.0))),
        _softplus_inverse,
        1,
    ),
    "exp": MonotoneFunction(_exp, _exp, _log, 1),
    "log": MonotoneFunction(_log, lambda x: 1 / np.maximum(x, LEAST), _exp, -1),
    "tanh": MonotoneFunction(
        lambda x: _log(np.tanh(_exp(x))),
        lambda x: 2 * _exp(x) / np.sinh(np.minimum(2 * _exp(x), 700.0)),
        lambda y: _log(np.arctanh(np.minimum(_exp(y), 1 - 1e-16))),
        -1,
    ),
}
"""The functions of curves; the hyperbolic tangent in logarithms of argument and value."""


@dataclass(frozen=True, eq=False)
class SampledFunction:
    """A smooth function as equally spaced samples; `room` bounds the error between samples.

    `convex` is 1, -1 or 0 for neither.
    """

    low: float
    step: float
    values: Vector
    room: float
    convex: int
    rising: int
    """1, -1 or 0 for neither."""

    @classmethod
    def of(cls, t: Vector, values: Vector, caution: float) -> SampledFunction:
        """The table of samples at t; `caution` scales their second derivative."""
        step = float(t[1] - t[0])
        second = np.diff(values, 2)
        noise = 1e-12 * (1 + float(np.abs(values).max()))
        convex = 1 if second.min() >= -noise else -1 if second.max() <= noise else 0
        first = np.diff(values)
        rising = 1 if first.min() >= 0 else -1 if first.max() <= 0 else 0
        bend = caution * float(np.abs(second).max()) / step**2
        return cls(float(t[0]), step, values, bend * step * step / 8 + noise, convex, rising)


class Tables:
    """Several tables with equally many samples, one argument each."""

    def __init__(self, tables: Sequence[SampledFunction]) -> None:
        self.low = np.array([table.low for table in tables])
        self.step = np.array([table.step for table in tables])
        self.values = np.stack([table.values for table in tables])
        self.room = np.array([table.room for table in tables])
        self.convex = np.array([table.convex for table in tables])
        self.rising = np.array([table.rising for table in tables])
        self.last = self.values.shape[1] - 1
        self.rows = np.arange(len(tables))
        self.turning, self.waving = (
            np.flatnonzero(self.rising == 0),
            np.flatnonzero(self.convex == 0),
        )
        self._ordered = self.values * np.where(self.rising < 0, -1.0, 1.0)[:, None]

    def _place(self, x: Vector) -> tuple[np.ndarray, Vector]:
        place = (x - self.low) / self.step
        index = np.clip(place.astype(int), 0, self.last - 1)
        return index, np.clip(place - index, 0.0, 1.0)

    def value(self, x: Vector) -> Vector:
        """Linear interpolation between two samples."""
        index, share = self._place(x)
        first, second = self.values[self.rows, index], self.values[self.rows, index + 1]
        found: Vector = first * (1 - share) + second * share
        return found

    def slope(self, x: Vector) -> Vector:
        """Slope of the interpolation."""
        index, _ = self._place(x)
        rise = self.values[self.rows, index + 1] - self.values[self.rows, index]
        found: Vector = rise / self.step
        return found

    def _inside(self, low: Vector, high: Vector, some: np.ndarray) -> tuple[Vector, np.ndarray]:
        """Samples of some tables, and whether they lie within the ranges."""
        t = self.low[some, None] + self.step[some, None] * np.arange(self.last + 1)
        return t, (t > low[:, None]) & (t < high[:, None])

    def hull(self, low: Vector, high: Vector) -> tuple[Vector, Vector]:
        """Least and largest values over ranges."""
        ends = self.value(low), self.value(high)
        least, most = np.minimum(*ends), np.maximum(*ends)
        some = self.turning
        if len(some):
            _, inside = self._inside(low[some], high[some], some)
            values = self.values[some]
            least[some] = np.minimum(least[some], np.where(inside, values, np.inf).min(axis=1))
            most[some] = np.maximum(most[some], np.where(inside, values, -np.inf).max(axis=1))
        return least - self.room, most + self.room

    def apart(self, low: Vector, high: Vector, slope: Vector, some: Any) -> tuple[Vector, Vector]:
        """Least and largest distance of some tables from lines through their first values."""
        first, last = self.value(low)[some], self.value(high)[some]
        low, high, slope = low[some], high[some], slope[some]
        last = last - slope * (high - low) - first
        t, inside = self._inside(low, high, some)
        off = self.values[some] - slope[:, None] * (t - low[:, None]) - first[:, None]
        off = np.where(inside, off, 0.0)
        return (
            np.minimum(np.minimum(off.min(axis=1), last), 0.0),
            np.maximum(np.maximum(off.max(axis=1), last), 0.0),
        )

    def within(self, low: Vector, high: Vector) -> tuple[Vector, Vector]:
        """Ranges of arguments for ranges of values; the whole range if not monotonic."""
        falls = self.rising < 0
        first = np.where(falls, -high, low) - self.room
        second = np.where(falls, -low, high) + self.room
        ordered = self._ordered
        least = self._inverse(first, (ordered < first[:, None]).sum(axis=1), 0.0)
        most = self._inverse(second, (ordered <= second[:, None]).sum(axis=1), 1.0)
        least[self.turning] = self.low[self.turning]
        most[self.turning] = (self.low + self.step * self.last)[self.turning]
        return least, most

    def _inverse(self, wanted: Vector, below: np.ndarray, flat: float) -> Vector:
        """Arguments of values, from the number of samples below; at flat parts one of the ends."""
        ordered, rows = self._ordered, self.rows
        index = np.clip(below - 1, 0, self.last - 1)
        first, second = ordered[rows, index], ordered[rows, index + 1]
        rises = second > first
        share = np.where(rises, (wanted - first) / np.where(rises, second - first, 1.0), flat)
        found: Vector = self.low + self.step * (index + np.clip(share, 0.0, 1.0))
        return found


Kind: TypeAlias = Name | SampledFunction


class Mixed:
    """Many curves of several kinds, one argument each."""

    def __init__(self, kinds: Sequence[Kind]) -> None:
        tables = [kind for kind in kinds if isinstance(kind, SampledFunction)]
        self.tabled = np.array(
            [k for k, kind in enumerate(kinds) if isinstance(kind, SampledFunction)], dtype=np.intp
        )
        self.tables = Tables(tables) if tables else None
        names = np.array([kind if isinstance(kind, str) else "" for kind in kinds], dtype=object)
        self.parts = [(shape, np.flatnonzero(names == name)) for name, shape in SHAPES.items()]
        self.convex = np.zeros(len(kinds), dtype=int)
        self.room = np.zeros(len(kinds))
        for shape, some in self.parts:
            self.convex[some] = shape.convex
        if self.tables is not None:
            self.convex[self.tabled], self.room[self.tabled] = self.tables.convex, self.tables.room

    def value(self, x: Vector) -> Vector:
        """The functions' values."""
        found = np.empty_like(x)
        for shape, some in self.parts:
            found[some] = shape.value(x[some])
        if self.tables is not None:
            found[self.tabled] = self.tables.value(x[self.tabled])
        return found

    def slope(self, x: Vector) -> Vector:
        """Their slopes."""
        found = np.empty_like(x)
        for shape, some in self.parts:
            found[some] = shape.slope(x[some])
        if self.tables is not None:
            found[self.tabled] = self.tables.slope(x[self.tabled])
        return found

    def hull(self, low: Vector, high: Vector) -> tuple[Vector, Vector]:
        """Ranges of the values over ranges of the arguments."""
        least, most = np.empty_like(low), np.empty_like(high)
        for shape, some in self.parts:
            least[some], most[some] = shape.value(low[some]), shape.value(high[some])
        if self.tables is not None:
            some = self.tabled
            least[some], most[some] = self.tables.hull(low[some], high[some])
        return least, most

    def apart(self, low: Vector, high: Vector, slope: Vector) -> tuple[Vector, Vector]:
        """Distance of functions with both curvatures from their secants, below and above."""
        least, most = np.zeros_like(low), np.zeros_like(low)
        if self.tables is not None:
            some, own = self.tables.waving, self.tabled
            if len(some):
                least[own[some]], most[own[some]] = self.tables.apart(
                    low[own], high[own], slope[own], some
                )
        return least, most

    def within(self, low: Vector, high: Vector) -> tuple[Vector, Vector]:
        """Ranges of the arguments whose values lie in ranges."""
        least, most = np.empty_like(low), np.empty_like(high)
        for shape, some in self.parts:
            least[some], most[some] = shape.inverse(low[some]), shape.inverse(high[some])
        if self.tables is not None:
            some = self.tabled
            least[some], most[some] = self.tables.within(low[some], high[some])
        return least, most


Powers: TypeAlias = tuple[tuple[int, float], ...]
"""Exponents by atom number, in order; a missing atom has exponent 0."""


class Form(NamedTuple):
    """Logarithm of a monomial: constant + sum of power * log(atom)."""

    constant: float
    powers: Powers = ()

    def __add__(self, other: Form) -> Form:  # type: ignore[override]
        return Form(self.constant + other.constant, merged(self.powers, other.powers, 1.0))

    def __sub__(self, other: Form) -> Form:
        return Form(self.constant - other.constant, merged(self.powers, other.powers, -1.0))

    def at(self, logarithms: Sequence[float]) -> float:
        """The logarithm at given logarithms of the atoms."""
        return self.constant + sum(power * logarithms[i] for i, power in self.powers)

    def scaled(self, factor: float) -> Form:
        """The logarithm of a power."""
        return Form(factor * self.constant, tuple((i, factor * p) for i, p in self.powers))


def merged(first: Powers, second: Powers, factor: float) -> Powers:
    """Powers of a product, or of a quotient with factor -1."""
    if not second:
        return first
    total = dict(first)
    for i, power in second:
        total[i] = total.get(i, 0.0) + factor * power
    return tuple(sorted((i, p) for i, p in total.items() if p != 0))


class Signomial(NamedTuple):
    """A sum of monomials: signed factors by powers."""

    terms: Mapping[Powers, float]

    @classmethod
    def number(cls, value: float) -> Signomial:
        """A constant as a signomial."""
        return cls({(): value} if value else {})

    @classmethod
    def monomial(cls, sign: float, form: Form) -> Signomial:
        """A monomial with a sign, as a signomial."""
        return cls({form.powers: sign * math.exp(form.constant)})

    @property
    def single(self) -> tuple[float, Form] | None:
        """Sign and logarithm of a single monomial."""
        if len(self.terms) != 1:
            return None
        ((powers, factor),) = self.terms.items()
        return math.copysign(1.0, factor), Form(math.log(abs(factor)), powers)

    @property
    def size(self) -> float:
        """Sum of the absolute factors."""
        return sum(map(abs, self.terms.values()))

    def plus(self, other: Signomial, sign: float = 1.0) -> Signomial:
        """Sum or difference; terms that cancel to rounding are dropped."""
        total = dict(self.terms)
        for powers, factor in other.terms.items():
            known = total.get(powers)
            if known is None:
                total[powers] = sign * factor
            elif abs(known + sign * factor) <= ROUNDING * (abs(known) + abs(factor)):
                del total[powers]
            else:
                total[powers] = known + sign * factor
        return Signomial(total)

    def times(self, other: Signomial) -> Signomial:
        """Product, expanded."""
        total = Signomial({})
        for powers, factor in other.terms.items():
            part = {merged(p, powers, 1.0): f * factor for p, f in self.terms.items()}
            total = total.plus(Signomial(part))
        return total

    def sides(self) -> tuple[list[Form], list[Form]]:
        """Logarithms of the positive and of the negative terms."""
        found: tuple[list[Form], list[Form]] = ([], [])
        for powers, factor in sorted(self.terms.items()):
            found[factor < 0].append(Form(math.log(abs(factor)), powers))
        return found


ROUNDING = 1e-12
"""Relative remainder of two terms that counts as zero."""


class Unknown(Exception):
    """A value of unknown sign, or without a relaxation of its model; carries the reason."""


class AtomFunction(NamedTuple):
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
    curve: AtomFunction


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
    curves: list[AtomFunction] = field(default_factory=list)
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
        self.curves.append(AtomFunction("softplus", part - rest, whole - rest))
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
