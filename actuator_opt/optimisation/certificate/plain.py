"""Sums in plain numbers beside their logarithms, so that linear relations stay linear.

A lower bound on a sum is loose in logarithms where its terms range widely, but exact in plain
numbers. There a monomial is tied to its widest factor and the rest by the planes of their product
[McCormick1976]: mass and stiffness of a layer both follow its thickness.
"""

from __future__ import annotations

import math

from .relaxation import ConstraintRow, Curve, Link, Product, Relaxation
from .shapes import Table
from .signomial import Form, Powers

WIDE = 0.3
"""Least range of the ratio of a sum's parts for which plain numbers are added."""


class _Plain:
    """Plain atoms of a relaxation with known ranges."""

    def __init__(self, found: Relaxation) -> None:
        self.found = found
        self.known: dict[Powers, int] = {}
        self.tops: dict[int, float] = {}
        self.tables = {
            curve.out.powers[0][0]: curve for curve in found.curves if isinstance(curve.kind, Table)
        }

    def width(self, form: Form) -> float:
        """Range of a monomial's logarithm."""
        low, high = self.found.reach(form)
        return high - low

    def atom(self, powers: Powers) -> int:
        """The plain atom of a monomial, relative to its largest value."""
        if powers not in self.known:
            found, form = self.found, Form(0.0, powers)
            low, high = found.reach(form)
            argument = Form(-high, powers)
            found.lower.append(math.exp(low - high))
            found.upper.append(1.0)
            found.makers.append(lambda y: math.exp(argument.at(y)))
            self.known[powers] = number = len(found.lower) - 1
            self.tops[number] = high
            found.curves.append(Curve("exp", argument, Form(0.0, ((number, 1.0),))))
            self._tie(form, number)
        return self.known[powers]

    def term(self, form: Form, scale: float) -> Form:
        """A monomial divided by e^scale, linear in its plain atom."""
        if not form.powers:
            return Form(math.exp(form.constant - scale))
        number = self.atom(form.powers)
        return Form(0.0, ((number, math.exp(form.constant + self.tops[number] - scale)),))

    def _tie(self, form: Form, number: int) -> None:
        """Tie a plain atom to those of its factors, or to its argument."""
        lone = [i for i, power in form.powers if power == 1.0]
        if not lone:
            return
        widest = max(lone, key=lambda i: self.width(Form(0.0, ((i, 1.0),))))
        base = Form(0.0, ((widest, 1.0),))
        rest = form - base
        if rest.powers:
            first, second = self.atom(base.powers), self.atom(rest.powers)
            level = self.tops[first] + self.tops[second] - self.tops[number]
            self.found.products.append(Product(number, first, second, level))
        elif widest in self.tables:
            curve = self.tables[widest]
            under = self.atom(curve.argument.powers)
            level = curve.argument.constant + self.tops[under] - self.tops[number]
            self.found.links.append(Link(number, under, level, curve))


def straighten(found: Relaxation) -> None:
    """Add plain numbers for the wide sums of a relaxation."""
    plain = _Plain(found)
    for whole, part, rest in list(found.splits):
        if plain.width(part - rest) < WIDE:
            continue
        scale = found.reach(whole)[1]
        own = plain.term(whole, scale)
        sums = plain.term(part, scale) + plain.term(rest, scale)
        found.rows += [ConstraintRow(own, sums), ConstraintRow(sums, own)]
