"""Sums in plain numbers beside their logarithms: what is linear stays linear.

A sum that must be large is loose in logarithms where its terms range widely, and exact in plain
numbers. There a monomial w = c a is tied to its widest atom a by the range of c in the box
[McCormick1976]: mass and stiffness of a layer both follow its thickness.
"""

from __future__ import annotations

import math

from .relaxation import Curve, Link, Relaxation, Row
from .shapes import Table
from .signomial import Form, Powers

WIDE = 0.3
"""Least range of the ratio of a sum's parts that is stated in plain numbers too."""

TIED = 0.7
"""Largest range of a monomial without its widest atom, over that atom's, that ties them."""


class _Plain:
    """Plain atoms of a relaxation whose ranges are known."""

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
        """The plain atom of a monomial, over its largest value."""
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
        """A monomial over e^scale, linear in its plain atom."""
        if not form.powers:
            return Form(math.exp(form.constant - scale))
        number = self.atom(form.powers)
        return Form(0.0, ((number, math.exp(form.constant + self.tops[number] - scale)),))

    def _tie(self, form: Form, number: int) -> None:
        """Tie a plain atom to that of the widest atom in it, or of what that is a function of."""
        lone = [i for i, power in form.powers if power == 1.0]
        if not lone:
            return
        widest = max(lone, key=lambda i: self.width(Form(0.0, ((i, 1.0),))))
        base = Form(0.0, ((widest, 1.0),))
        rest, curve = form - base, None
        if not rest.powers:
            curve = self.tables.get(widest)
            if curve is None:
                return
            base = Form(0.0, curve.argument.powers)
            rest = Form(curve.argument.constant)
        if self.width(rest) > TIED * self.width(base):
            return
        under = self.atom(base.powers)
        ratio = rest + Form(self.tops[under] - self.tops[number])
        self.found.links.append(Link(number, under, ratio, curve))


def straighten(found: Relaxation) -> None:
    """State the wide sums of a relaxation in plain numbers too."""
    plain = _Plain(found)
    for whole, part, rest in list(found.splits):
        if plain.width(part - rest) < WIDE:
            continue
        scale = found.reach(whole)[1]
        own = plain.term(whole, scale)
        sums = plain.term(part, scale) + plain.term(rest, scale)
        found.rows += [Row(own, sums), Row(sums, own)]
