"""Signomials: sums of signed monomials, and the logarithms of monomials.

A monomial is a positive number times powers of atoms (positive unknowns); its logarithm is affine
in the atoms' logarithms. Products, quotients and powers of monomials are monomials.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple, TypeAlias

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
