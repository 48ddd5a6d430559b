"""Convex relaxation in logarithms: linear rows, and curves that each have one argument.

A monomial is a positive number times powers of atoms (positive unknowns). Its logarithm is affine
in the logarithms of the atoms. Products, quotients and powers of monomials are monomials. A
signomial is a sum of signed monomials.

Every traced value of known sign is stated as a monomial. A sum s = p + q is a new atom with
log s - log q = softplus(log p - log q), a convex curve of the log ratio of its terms. The curve's
chord bounds it from above; a shorter range of the ratio gives a tighter chord. This is the log-log
convex relaxation of a signomial programme [Maranas1997], applied to every sum.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np

from ...base.dataclass import dataclass
from ..problem import Vector

Name: TypeAlias = Literal["softplus", "exp", "log", "tanh"]
Function: TypeAlias = Callable[[Vector], Vector]
LEAST = 1e-300
"""Number that replaces zero in a logarithm."""
FAR = 200.0
"""Largest logarithm of an atom or a ratio; e^200 is beyond any quantity."""


class MonotoneFunction(NamedTuple):
    """An increasing function with its slope and inverse, either convex (1) or concave (-1)."""

    value: Function
    slope: Function
    inverse: Function
    convex: int

    def hull(self, low: Vector, high: Vector) -> tuple[Vector, Vector]:
        """Ranges of the function's values, for given ranges of the argument."""
        return self.value(low), self.value(high)

    def inverse_hull(self, low: Vector, high: Vector) -> tuple[Vector, Vector]:
        """Ranges of the argument, for given ranges of the function's values."""
        return self.inverse(low), self.inverse(high)


def _softplus_inverse(y: Vector) -> Vector:
    """Inverse of the softplus function: log(e^y - 1)."""
    positive = np.maximum(y, LEAST)
    return positive + np.log(-np.expm1(-positive))


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
"""Functions of curves by name, between logarithms: "tanh" maps log x to log tanh x."""


@dataclass(frozen=True, eq=False)
class SampledFunction:
    """A smooth function, stored as equally spaced samples.

    Parameters
    ----------
    low, step : first argument, and spacing of the arguments
    values : the samples
    room : upper limit on the error of linear interpolation
    convex : 1 if convex, -1 if concave, 0 if neither
    rising : 1 if rising, -1 if falling, 0 if neither
    """

    low: float
    step: float
    values: Vector
    room: float
    convex: int
    rising: int

    @classmethod
    def of(cls, t: Vector, values: Vector, caution: float) -> SampledFunction:
        """The function with samples at t; `caution` is a safety factor on its second derivative."""
        step = float(t[1] - t[0])
        second = np.diff(values, 2)
        noise = 1e-12 * (1 + float(np.abs(values).max()))
        convex = 1 if second.min() >= -noise else -1 if second.max() <= noise else 0
        first = np.diff(values)
        rising = 1 if first.min() >= 0 else -1 if first.max() <= 0 else 0
        bend = caution * float(np.abs(second).max()) / step**2
        return cls(float(t[0]), step, values, bend * step * step / 8 + noise, convex, rising)


class Tables:
    """Several sampled functions with equally many samples; each has its own argument."""

    def __init__(self, tables: Sequence[SampledFunction]) -> None:
        self.low = np.array([table.low for table in tables])
        self.step = np.array([table.step for table in tables])
        self.values = np.stack([table.values for table in tables])
        self.room = np.array([table.room for table in tables])
        self.convex = np.array([table.convex for table in tables])
        self.rising = np.array([table.rising for table in tables])
        self.last = self.values.shape[1] - 1
        self.rows = np.arange(len(tables))
        self.non_monotonic, self.non_convex = (
            np.flatnonzero(self.rising == 0),
            np.flatnonzero(self.convex == 0),
        )
        self._ordered = self.values * np.where(self.rising < 0, -1.0, 1.0)[:, None]

    def _place(self, x: Vector) -> tuple[np.ndarray, Vector]:
        place = (x - self.low) / self.step
        index = np.clip(place.astype(int), 0, self.last - 1)
        return index, np.clip(place - index, 0.0, 1.0)

    def value(self, x: Vector) -> Vector:
        """Values by linear interpolation between two samples."""
        index, share = self._place(x)
        first, second = self.values[self.rows, index], self.values[self.rows, index + 1]
        values: Vector = first * (1 - share) + second * share
        return values

    def slope(self, x: Vector) -> Vector:
        """Slope of the interpolation."""
        index, _ = self._place(x)
        rise = self.values[self.rows, index + 1] - self.values[self.rows, index]
        slopes: Vector = rise / self.step
        return slopes

    def _inside(self, low: Vector, high: Vector, indices: np.ndarray) -> tuple[Vector, np.ndarray]:
        """Arguments of the samples of some tables, and which samples lie within the ranges."""
        t = self.low[indices, None] + self.step[indices, None] * np.arange(self.last + 1)
        return t, (t > low[:, None]) & (t < high[:, None])

    def hull(self, low: Vector, high: Vector) -> tuple[Vector, Vector]:
        """Least and largest values of the functions, for given ranges of the arguments."""
        ends = self.value(low), self.value(high)
        lowest, highest = np.minimum(*ends), np.maximum(*ends)
        indices = self.non_monotonic
        if len(indices):
            _, inside = self._inside(low[indices], high[indices], indices)
            values = self.values[indices]
            inner = np.where(inside, values, np.inf).min(axis=1)
            lowest[indices] = np.minimum(lowest[indices], inner)
            inner = np.where(inside, values, -np.inf).max(axis=1)
            highest[indices] = np.maximum(highest[indices], inner)
        return lowest - self.room, highest + self.room

    def secant_errors(
        self, low: Vector, high: Vector, slope: Vector, indices: Any
    ) -> tuple[Vector, Vector]:
        """Least and largest distance of some curves from lines through their values at `low`.

        Parameters
        ----------
        low, high : ranges of the arguments, for all curves
        slope : slope of each line
        indices : indices of the curves examined
        """
        first, last = self.value(low)[indices], self.value(high)[indices]
        low, high, slope = low[indices], high[indices], slope[indices]
        last = last - slope * (high - low) - first
        t, inside = self._inside(low, high, indices)
        off = self.values[indices] - slope[:, None] * (t - low[:, None]) - first[:, None]
        off = np.where(inside, off, 0.0)
        return (
            np.minimum(np.minimum(off.min(axis=1), last), 0.0),
            np.maximum(np.maximum(off.max(axis=1), last), 0.0),
        )

    def inverse_hull(self, low: Vector, high: Vector) -> tuple[Vector, Vector]:
        """Ranges of arguments for ranges of values; the whole range if not monotonic."""
        falls = self.rising < 0
        low_ends = np.where(falls, -high, low) - self.room
        high_ends = np.where(falls, -low, high) + self.room
        ordered = self._ordered
        lowest = self._inverse(low_ends, (ordered < low_ends[:, None]).sum(axis=1), 0.0)
        highest = self._inverse(high_ends, (ordered <= high_ends[:, None]).sum(axis=1), 1.0)
        lowest[self.non_monotonic] = self.low[self.non_monotonic]
        highest[self.non_monotonic] = (self.low + self.step * self.last)[self.non_monotonic]
        return lowest, highest

    def _inverse(self, values: Vector, counts_below: np.ndarray, flat: float) -> Vector:
        """Arguments for given values, from the number of samples below each value.

        On a flat segment the argument is the segment's lower end (`flat` = 0) or upper end (1).
        """
        ordered, rows = self._ordered, self.rows
        index = np.clip(counts_below - 1, 0, self.last - 1)
        first, second = ordered[rows, index], ordered[rows, index + 1]
        rises = second > first
        share = np.where(rises, (values - first) / np.where(rises, second - first, 1.0), flat)
        arguments: Vector = self.low + self.step * (index + np.clip(share, 0.0, 1.0))
        return arguments


Kind: TypeAlias = Name | SampledFunction


class CurveFunctions:
    """The functions of all curves, grouped by kind; each has its own argument."""

    def __init__(self, kinds: Sequence[Kind]) -> None:
        names = np.array([kind if isinstance(kind, str) else "" for kind in kinds], dtype=object)
        self.groups: list[tuple[MonotoneFunction | Tables, np.ndarray]] = [
            (shape, np.flatnonzero(names == name)) for name, shape in SHAPES.items()
        ]
        tables = [kind for kind in kinds if isinstance(kind, SampledFunction)]
        self.table_curves = np.flatnonzero(names == "")
        self.tables = Tables(tables) if tables else None
        self.room = np.zeros(len(kinds))
        if self.tables is not None:
            self.groups.append((self.tables, self.table_curves))
            self.room[self.table_curves] = self.tables.room
        self.convex = np.zeros(len(kinds), dtype=int)
        for functions, indices in self.groups:
            self.convex[indices] = functions.convex

    def value(self, x: Vector) -> Vector:
        """The value of each function at its argument."""
        values = np.empty_like(x)
        for functions, indices in self.groups:
            values[indices] = functions.value(x[indices])
        return values

    def slope(self, x: Vector) -> Vector:
        """The slope of each function at its argument."""
        slopes = np.empty_like(x)
        for functions, indices in self.groups:
            slopes[indices] = functions.slope(x[indices])
        return slopes

    def hull(self, low: Vector, high: Vector) -> tuple[Vector, Vector]:
        """Ranges of the functions' values, for given ranges of the arguments."""
        lowest, highest = np.empty_like(low), np.empty_like(high)
        for functions, indices in self.groups:
            ends = functions.hull(low[indices], high[indices])
            lowest[indices], highest[indices] = ends
        return lowest, highest

    def inverse_hull(self, low: Vector, high: Vector) -> tuple[Vector, Vector]:
        """Ranges of the arguments, for given ranges of the functions' values."""
        lowest, highest = np.empty_like(low), np.empty_like(high)
        for functions, indices in self.groups:
            ends = functions.inverse_hull(low[indices], high[indices])
            lowest[indices], highest[indices] = ends
        return lowest, highest

    def secant_errors(self, low: Vector, high: Vector, slope: Vector) -> tuple[Vector, Vector]:
        """Least and largest distance of the functions from lines through their values at `low`.

        Both are 0 for functions that are convex or concave throughout.
        """
        lowest, highest = np.zeros_like(low), np.zeros_like(low)
        if self.tables is not None:
            indices, curves = self.tables.non_convex, self.table_curves
            if len(indices):
                lowest[curves[indices]], highest[curves[indices]] = self.tables.secant_errors(
                    low[curves], high[curves], slope[curves], indices
                )
        return lowest, highest


Powers: TypeAlias = tuple[tuple[int, float], ...]
"""Pairs (number of an atom, exponent) in ascending order; all other atoms have exponent 0. An atom
is a positive unknown."""


class Form(NamedTuple):
    """Logarithm of a monomial of atoms (positive unknowns): constant + sum of power * log(atom)."""

    constant: float
    powers: Powers = ()

    def __add__(self, other: Form) -> Form:  # type: ignore[override]
        return Form(self.constant + other.constant, merged(self.powers, other.powers, 1.0))

    def __sub__(self, other: Form) -> Form:
        return Form(self.constant - other.constant, merged(self.powers, other.powers, -1.0))

    def at(self, logarithms: Sequence[float]) -> float:
        """The logarithm of the monomial, given the logarithms of the atoms."""
        return self.constant + sum(power * logarithms[i] for i, power in self.powers)

    def scaled(self, factor: float) -> Form:
        """The logarithm of the monomial raised to the power `factor`."""
        return Form(factor * self.constant, tuple((i, factor * p) for i, p in self.powers))


def merged(first: Powers, second: Powers, factor: float) -> Powers:
    """Exponents of a product of two monomials, or with factor -1 of their quotient."""
    if not second:
        return first
    total = dict(first)
    for i, power in second:
        total[i] = total.get(i, 0.0) + factor * power
    return tuple(sorted((i, p) for i, p in total.items() if p != 0))


class Signomial(NamedTuple):
    """A sum of monomials: for each set of exponents, a factor with its sign."""

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
        """Sign and logarithm, if the sum is a single monomial."""
        if len(self.terms) != 1:
            return None
        ((powers, factor),) = self.terms.items()
        return math.copysign(1.0, factor), Form(math.log(abs(factor)), powers)

    @property
    def size(self) -> float:
        """Sum of the factors' absolute values."""
        return sum(map(abs, self.terms.values()))

    def plus(self, other: Signomial, sign: float = 1.0) -> Signomial:
        """Sum or difference; terms that cancel, apart from rounding, are dropped."""
        total = dict(self.terms)
        for powers, factor in other.terms.items():
            earlier = total.get(powers)
            if earlier is None:
                total[powers] = sign * factor
            elif abs(earlier + sign * factor) <= ROUNDING * (abs(earlier) + abs(factor)):
                del total[powers]
            else:
                total[powers] = earlier + sign * factor
        return Signomial(total)

    def times(self, other: Signomial) -> Signomial:
        """Product of two sums, expanded into monomials."""
        total = Signomial({})
        for powers, factor in other.terms.items():
            part = {merged(p, powers, 1.0): f * factor for p, f in self.terms.items()}
            total = total.plus(Signomial(part))
        return total

    def sides(self) -> tuple[list[Form], list[Form]]:
        """Logarithms of the positive terms, and of the negative terms."""
        logarithms: tuple[list[Form], list[Form]] = ([], [])
        for powers, factor in sorted(self.terms.items()):
            logarithms[factor < 0].append(Form(math.log(abs(factor)), powers))
        return logarithms


ROUNDING = 1e-12
"""Two terms cancel if their sum is at most this share of the terms' size."""


class Unknown(Exception):
    """Raised if a value's sign is unknown or its model has no relaxation; states the reason."""


class AtomFunction(NamedTuple):
    """A curve out = function(argument); `out` and `argument` are logarithms of monomials."""

    kind: Kind
    argument: Form
    out: Form


class Link(NamedTuple):
    """Relation out = e^level f(base) of two atoms (positive unknowns); f is a sampled function.

    `out` and `base` are the numbers of the atoms; `level` is the logarithm of a constant factor.
    `curve` has the samples of f: log f as a function of the logarithm of its argument.
    """

    out: int
    base: int
    level: float
    curve: AtomFunction


class Product(NamedTuple):
    """Relation out = e^level * first * second between three atoms (positive unknowns).

    `out`, `first` and `second` are the numbers of the atoms; `level` is the logarithm of a constant
    factor.
    """

    out: int
    first: int
    second: int
    level: float


Maker: TypeAlias = Callable[[Sequence[float]], float]
"""Computes the logarithm of an atom (positive unknown) from the logarithms of earlier atoms."""


class ConstraintRow(NamedTuple):
    """A constraint low <= high between the logarithms of two monomials."""

    low: Form
    high: Form


@dataclass
class Relaxation:
    """Convex relaxation of a problem in logarithms: atoms with bounds, linear rows, and curves.

    Atoms are elementary positive quantities; rows are linear constraints between their logarithms.
    `makers` compute the logarithm of every atom from those of earlier atoms.
    """

    makers: list[Maker] = field(default_factory=list)
    lower: list[float] = field(default_factory=list)
    upper: list[float] = field(default_factory=list)
    rows: list[ConstraintRow] = field(default_factory=list)
    curves: list[AtomFunction] = field(default_factory=list)
    splits: list[tuple[Form, Form, Form]] = field(default_factory=list)
    """Every sum of two terms, as the logarithms of the sum, of its first and of its second term."""
    links: list[Link] = field(default_factory=list)
    products: list[Product] = field(default_factory=list)
    sums: dict[tuple[Form, Form], Form] = field(default_factory=dict)

    def atom(self, low: float, high: float, maker: Maker) -> Form:
        """Add an atom, a positive unknown, whose value lies between `low` and `high`."""
        self.makers.append(maker)
        self.lower.append(math.log(low) if low > 0 else -math.inf)
        self.upper.append(math.log(high) if high < math.inf else math.inf)
        return Form(0.0, ((len(self.lower) - 1, 1.0),))

    def reach(self, form: Form) -> tuple[float, float]:
        """Least and largest value of a monomial's logarithm within the atoms' bounds."""
        low = high = form.constant
        for i, power in form.powers:
            ends = (power * self.lower[i], power * self.upper[i])
            low, high = low + min(ends), high + max(ends)
        return low, high

    def total(self, terms: Sequence[Form], low: float, high: float) -> Form:
        """Logarithm of a sum of monomials; the sum lies between `low` and `high`."""
        common = _common(terms)
        common_low, common_high = self.reach(common)
        low = low * math.exp(-min(common_high, 700.0)) if low > 0 else low
        high = high * math.exp(-common_low) if common_low > -700 else math.inf
        result, *terms_left = (term - common for term in terms)
        for i, term in enumerate(terms_left):
            last = i == len(terms_left) - 1
            result = self._sum(result, term, low if last else 0.0, high)
        return result + common

    def _sum(self, first: Form, second: Form, low: float, high: float) -> Form:
        if first.powers == second.powers:  # the terms have a constant ratio
            return Form(log_of_sum(first.constant, second.constant), first.powers)
        key = (first, second) if first <= second else (second, first)
        if key not in self.sums:
            self.sums[key] = self.atom(low, high, lambda y: log_of_sum(first.at(y), second.at(y)))
            self.split(self.sums[key], *key)
        return self.sums[key]

    def split(self, whole: Form, part: Form, remainder: Form) -> None:
        """Add the constraint whole = part + remainder."""
        self.curves.append(AtomFunction("softplus", part - remainder, whole - remainder))
        self.splits.append((whole, part, remainder))


def log_of_sum(first: float, second: float) -> float:
    """Logarithm of the sum of two numbers that are given by their logarithms."""
    high, low = max(first, second), min(first, second)
    return high + math.log1p(math.exp(low - high))


def _common(terms: Sequence[Form]) -> Form:
    """The greatest monomial by which all terms can be divided."""
    if len(terms) < 2:
        return Form(0.0)
    first, *other_terms = (dict(term.powers) for term in terms)
    common = []
    for i, power in first.items():
        powers = [power, *(other.get(i, 0.0) for other in other_terms)]
        power_in_all = min(powers) if min(powers) > 0 else max(powers) if max(powers) < 0 else 0.0
        if power_in_all:
            common.append((i, power_in_all))
    return Form(0.0, tuple(sorted(common)))
