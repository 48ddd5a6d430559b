"""Traced values as monomials of atoms, with curves that relate the atoms."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from ...base.symbolic import Symbol
from .bounding import CAUTION, SAMPLES, Leads, function
from .intervals import branch, extreme
from .relaxation import (FAR, ConstraintRow, Curve, Form, Kind, Mixed, Relaxation, Signomial, Table, Unknown)

WIDEST = 20.0
"""Widest logarithmic range that is sampled."""

LARGEST = 8
"""Maximum terms of a sum that stays expanded, so that terms can cancel."""

_MONOMIAL = ("variable", "mul", "div", "neg", "sqrt", "pow")
"""Operations that keep a monomial a monomial."""


class Builder:
    """Relaxes traced values one by one; equal values share an atom."""

    def __init__(self) -> None:
        self.found = Relaxation()
        self._forms: dict[int, tuple[float, Form] | Unknown] = {}
        self._sums: dict[int, Signomial | None] = {}
        self._leads = Leads()
        self.variables: dict[str, Form] = {}

    def form(self, value: Any) -> tuple[float, Form]:
        """Sign and logarithm of a value.

        Raises
        ------
        Unknown
            its sign is not known, or one of its models has no relaxation
        """
        if not isinstance(value, Symbol):
            number = float(value)
            if number == 0 or not math.isfinite(number):
                raise Unknown(f"a part of it is {number:g}")
            return math.copysign(1.0, number), Form(math.log(abs(number)))
        if value.index not in self._forms:
            try:
                self._forms[value.index] = self._either(value)
            except Unknown as reason:
                self._forms[value.index] = reason
        known = self._forms[value.index]
        if isinstance(known, Unknown):
            raise known
        return known

    def _either(self, node: Symbol) -> tuple[float, Form]:
        """The sampled form if it is tighter than the parts, else the parts."""
        if node.op not in _MONOMIAL or self._repeats(node):
            with suppress(Unknown):
                return self._sampled(node)
        return self._made(node)

    def _repeats(self, node: Symbol) -> bool:
        """Whether both factors of a product depend on one value, other than as powers of it."""
        if node.op not in ("mul", "div"):
            return False
        lead, (first, second) = self._leads.of(node), node.args
        single = first is second or _power(first, lead) or _power(second, lead)
        return lead is not node and not single

    def _made(self, node: Symbol) -> tuple[float, Form]:
        op, args = node.op, node.args
        if op == "variable":
            return self._variable(node)
        if op in ("add", "sub"):
            return self._of_sum(node)
        if op in ("mul", "div"):
            (s, a), (t, b) = self.form(args[0]), self.form(args[1])
            return s * t, a + b if op == "mul" else a - b
        if op == "neg":
            sign, form = self.form(args[0])
            return -sign, form
        if op in ("sqrt", "pow"):
            sign, form = self.form(args[0])
            if sign < 0:
                raise Unknown("a root of a negative number")
            return 1.0, form.scaled(0.5 if op == "sqrt" else args[1])
        if op == "where":
            return self._chosen(node)
        return self._of_function(node)

    def _variable(self, node: Symbol) -> tuple[float, Form]:
        low, high = node.bounds
        if not low > 0:
            raise Unknown(f"{node.args[0]} may be zero or negative")
        form = self.found.atom(low, high, lambda y: math.nan)  # an atom of the design itself
        self.variables[node.args[0]] = form
        return 1.0, form

    def _sampled(self, node: Symbol) -> tuple[float, Form]:
        """The sampled form of a function of one other value."""
        lead = self._leads.of(node)
        if lead is node:
            raise Unknown("it depends on several values")
        sign, argument = self.form(lead)
        if sign < 0:
            raise Unknown("its argument is negative")
        t = np.linspace(*self.found.reach(argument), SAMPLES)
        if not 0 < t[-1] - t[0] < WIDEST:
            raise Unknown("its argument is fixed or unbounded")
        values = function([node], lead)(t)[0]
        with np.errstate(all="ignore"):
            logs = np.log(np.abs(values))
        if not np.isfinite(logs).all():
            raise Unknown("it is not defined everywhere")
        table = Table.of(t, logs, CAUTION)
        if (values[0] > 0) != (values[-1] > 0) or values.min() * values.max() <= 0:
            raise Unknown("its sign is not known")
        least, most = float(logs.min()) - table.room, float(logs.max()) + table.room
        return math.copysign(1.0, values[0]), self._curve(table, argument, least, most)

    def expanded(self, value: Any) -> Signomial | None:
        """A value as a sum of monomials; None if it has too many terms."""
        if not isinstance(value, Symbol):
            return Signomial.number(value) if math.isfinite(value) else None
        if value.index not in self._sums:
            found = self._expand(value)
            kept = found is not None and len(found.terms) <= LARGEST
            self._sums[value.index] = found if kept else None
        return self._sums[value.index]

    def _expand(self, node: Symbol) -> Signomial | None:
        op, args = node.op, node.args
        if op in ("add", "sub"):
            a, b = self.expanded(args[0]), self.expanded(args[1])
            if a is None or b is None:
                return None
            return a.plus(b, 1.0 if op == "add" else -1.0)
        if op == "neg":
            inner = self.expanded(args[0])
            return None if inner is None else Signomial({}).plus(inner, -1.0)
        if op == "mul":
            a, b = self.expanded(args[0]), self.expanded(args[1])
            if a is not None and b is not None and len(a.terms) * len(b.terms) <= 2 * LARGEST:
                return a.times(b)
        if op == "div":
            a = self.expanded(args[0])
            try:
                sign, form = self.form(args[1])
            except Unknown:
                return None
            return None if a is None else a.times(Signomial.monomial(sign, Form(0.0) - form))
        if op == "where":
            taken = branch(node)
            if taken is not None:
                return self.expanded(taken)
        try:
            return Signomial.monomial(*self.form(node))
        except Unknown:
            return None

    def _of_sum(self, node: Symbol) -> tuple[float, Form]:
        """A sum as its terms, expanded where some cancel or signs differ."""
        low, high = node.bounds
        parts = self._cancelled(node) or self._terms(node)
        known = parts.single
        if known is not None:
            return known
        if not parts.terms:
            raise Unknown("it is zero")
        plus, minus = parts.sides()
        low, high = max(low, self._least(plus, minus)), min(high, -self._least(minus, plus))
        if not minus or not plus:
            sign = -1.0 if minus else 1.0
            ends = (low, high) if sign > 0 else (-high, -low)
            return sign, self.found.total(plus or minus, *ends)
        if low > 0:
            return 1.0, self._difference(plus, minus, low, high)
        if high < 0:
            return -1.0, self._difference(minus, plus, -high, -low)
        raise Unknown("the sign of a difference is not known")

    def _least(self, plus: Sequence[Form], minus: Sequence[Form]) -> float:
        """Lower bound of a difference of sums, by its expanded terms."""
        least = sum(math.exp(self.found.reach(one)[0]) for one in plus)
        return least - sum(math.exp(min(self.found.reach(one)[1], 700.0)) for one in minus)

    def _cancelled(self, node: Symbol) -> Signomial | None:
        """An expanded sum, if terms of its operands cancel."""
        parts = [self.expanded(one) for one in (node, *node.args)]
        if None in parts:
            return None
        whole, *sizes = (part.size for part in parts if part is not None)
        return parts[0] if whole < (1 - 1e-9) * sum(sizes) else None

    def _terms(self, node: Symbol) -> Signomial:
        """A sum by its operands, each an atom; operands of unknown sign are expanded."""
        first, second = (self.opened(one) for one in node.args)
        return first.plus(second, -1.0 if node.op == "sub" else 1.0)

    def opened(self, value: Any) -> Signomial:
        """A value of any sign as a sum of as few monomials as possible.

        Raises
        ------
        Unknown
            one of its models has no relaxation
        """
        try:
            return Signomial.monomial(*self.form(value))
        except Unknown:
            if not isinstance(value, Symbol):
                if value == 0:
                    return Signomial({})
                raise
            parts = self.expanded(value)
            if parts is not None and not parts.terms:
                return parts
            if value.op in ("add", "sub"):
                return self._terms(value)
            if value.op == "neg":
                return Signomial({}).plus(self.opened(value.args[0]), -1.0)
            if value.op == "mul":
                return self.opened(value.args[0]).times(self.opened(value.args[1]))
            if value.op == "div":
                sign, form = self.form(value.args[1])
                inverse = Signomial.monomial(sign, Form(0.0) - form)
                return self.opened(value.args[0]).times(inverse)
            raise

    def at_least(self, value: Any, bound: Any) -> None:
        """Add the constraint that a value is at least another value or a number.

        Raises
        ------
        Unknown
            one of their models has no relaxation
        """
        plus, minus = self.opened(value).plus(self.opened(bound), -1.0).sides()
        if minus and not plus:
            raise Unknown("it is below its limit")
        if minus:
            most = math.inf
            whole, rest = (self.found.total(side, 0.0, most) for side in (plus, minus))
            self.found.rows.append(ConstraintRow(rest, whole))

    def _difference(
        self, plus: Sequence[Form], minus: Sequence[Form], low: float, high: float
    ) -> Form:
        """Plus - minus > 0."""
        whole = self.found.total(plus, 0.0, math.inf)
        rest = self.found.total(minus, 0.0, math.inf)

        def apart(y: Sequence[float]) -> float:
            ratio = whole.at(y) - rest.at(y)
            return rest.at(y) + math.log(math.expm1(ratio)) if ratio > 0 else -math.inf

        out = self.found.atom(low, high, apart)
        self.found.split(whole, out, rest)
        return out

    def _chosen(self, node: Symbol) -> tuple[float, Form]:
        taken = branch(node)
        if taken is not None:
            return self.form(taken)
        kind = extreme(node)
        if kind is None:
            raise Unknown("it depends on a condition that is not decided")
        (s, a), (t, b) = self.form(node.args[1]), self.form(node.args[2])
        low, high = node.bounds
        if s != t:
            raise Unknown("the sign of a choice is not known")
        ends = (low, high) if s > 0 else (-high, -low)
        larger = (kind == "max") == (s > 0)
        pick = max if larger else min
        out = self.found.atom(*ends, lambda y: pick(a.at(y), b.at(y)))
        for one in (a, b):
            self.found.rows.append(ConstraintRow(one, out) if larger else ConstraintRow(out, one))
        return s, out

    def _of_function(self, node: Symbol) -> tuple[float, Form]:
        op, argument = node.op, node.args[0]
        low, high = node.bounds
        if op == "log1p":
            return self._logarithm(argument.graph, 1.0 + argument, low, high)
        if op == "log":
            return self._logarithm(argument.graph, argument, low, high)
        if op == "exp":
            return 1.0, self._exponential(argument, low, high)
        if op == "tanh" and low > 0:
            _, form = self.form(argument)
            return 1.0, self._curve("tanh", form, math.log(low), math.log(high))
        raise Unknown(f"{op} has no relaxation")

    def _logarithm(
        self, graph: object, argument: Any, low: float, high: float
    ) -> tuple[float, Form]:
        """The form of ln x > 0: affine in the atoms; its own logarithm is a curve of it."""
        parts = self.expanded(argument)
        if parts is not None:  # a ratio such as 1.2 + t/r exceeds one for all t and r
            plus, minus = parts.sides()
            least = self._least(plus, minus)
            low = max(low, math.log(least)) if least > 0 else low
        _, form = self.form(argument)
        if low <= 0 <= high:
            raise Unknown("the sign of a logarithm is not known")
        sign = 1.0 if low > 0 else -1.0
        inner = form if sign > 0 else Form(0.0) - form
        ends = (low, high) if sign > 0 else (-high, -low)
        return sign, self._curve("log", inner, math.log(ends[0]), math.log(ends[1]))

    def _exponential(self, argument: Any, low: float, high: float) -> Form:
        """The form of e^x: its logarithm is x, a curve of the logarithm of x."""
        sign, form = self.form(argument)
        if sign > 0:
            return self._curve("exp", form, math.log(low) if low > 0 else -FAR, math.log(high))
        out = self.found.atom(low, high, lambda y: -math.exp(form.at(y)))
        self.found.curves.append(Curve("exp", form, Form(0.0) - out))
        return out

    def _curve(self, kind: Kind, argument: Form, low: float, high: float) -> Form:
        """A new atom as a function of a monomial's logarithm; ends are logarithms."""
        one = Mixed([kind])
        out = self.found.atom(
            math.exp(low),
            math.exp(high),
            lambda y: float(one.value(np.array([argument.at(y)]))[0]),
        )
        self.found.curves.append(Curve(kind, argument, out))
        return out


def _power(value: Any, lead: Symbol) -> bool:
    """Whether a value is a number times a power of another."""
    if value is lead or not isinstance(value, Symbol):
        return True
    return value.op in _MONOMIAL and all(_power(one, lead) for one in value.args)
