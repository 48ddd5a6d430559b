"""Builds the relaxation: traced values become monomials of atoms; curves relate the atoms.

Atoms are elementary positive quantities, such as variables and sums. A model without a closed
expression becomes an unknown quantity between upper and lower estimates (its envelope).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from ...base.symbolic import Symbol
from ..problem import Vector
from .bounding import CAUTION, SAMPLES, Leads, function
from .intervals import branch, extreme
from .relaxation import (
    FAR,
    AtomFunction,
    ConstraintRow,
    CurveFunctions,
    Form,
    Kind,
    Relaxation,
    SampledFunction,
    Signomial,
    Unknown,
)

WIDEST = 20.0
"""Widest range of a logarithm over which a function is sampled."""

LARGEST = 8
"""Maximum number of terms of a sum that is expanded to let terms cancel."""

_MONOMIAL = ("variable", "mul", "div", "neg", "sqrt", "pow")
"""Operations that give a monomial if their operands are monomials."""


class Builder:
    """Adds traced values to a relaxation; equal values share one atom (elementary quantity)."""

    def __init__(self) -> None:
        self.relaxation = Relaxation()
        self._forms: dict[int, tuple[float, Form] | Unknown] = {}
        self._sums: dict[int, Signomial | None] = {}
        self._leads = Leads()
        self.variables: dict[str, Form] = {}

    def form(self, value: Any) -> tuple[float, Form]:
        """Sign of a value, and the logarithm of its absolute value.

        Raises
        ------
        Unknown
            the value's sign is not known, or one of its models has no relaxation
        """
        if not isinstance(value, Symbol):
            number = float(value)
            if number == 0 or not math.isfinite(number):
                raise Unknown(
                    f"a factor or term in the model is constant at {number:g}, "
                    "but the proof needs its logarithm, which is not finite"
                )
            return math.copysign(1.0, number), Form(math.log(abs(number)))
        if value.index not in self._forms:
            try:
                self._forms[value.index] = self._tightest(value)
            except Unknown as reason:
                self._forms[value.index] = reason
        entry = self._forms[value.index]
        if isinstance(entry, Unknown):
            raise entry
        return entry

    def _tightest(self, node: Symbol) -> tuple[float, Form]:
        """Sign and logarithm of a value; a fit to samples is used if its bounds are tighter."""
        if node.op not in _MONOMIAL or self._repeats(node):
            with suppress(Unknown):
                return self._sampled(node)
        return self._composed(node)

    def _repeats(self, node: Symbol) -> bool:
        """Whether a product's factors are both functions of one value, neither just a power of it.

        Such a product has tighter bounds as a sampled function of that value.
        """
        if node.op not in ("mul", "div"):
            return False
        lead, (first, second) = self._leads.of(node), node.args
        single = first is second or _power(first, lead) or _power(second, lead)
        return lead is not node and not single

    def _composed(self, node: Symbol) -> tuple[float, Form]:
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
                raise Unknown("the model contains a root of a negative number")
            return 1.0, form.scaled(0.5 if op == "sqrt" else args[1])
        if op == "where":
            return self._of_choice(node)
        return self._of_function(node)

    def _variable(self, node: Symbol) -> tuple[float, Form]:
        low, high = node.bounds
        if not low > 0:
            raise Unknown(f"the variable {node.args[0]} may be zero or negative")
        form = self.relaxation.atom(low, high, lambda y: math.nan)  # a design value
        self.variables[node.args[0]] = form
        return 1.0, form

    def _sampled(self, node: Symbol) -> tuple[float, Form]:
        """Sign and logarithm, by samples, of a value that is a function of a single other value."""
        lead = self._leads.of(node)
        if lead is node:
            raise Unknown("no bound is implemented for a function of several quantities")
        sign, argument = self.form(lead)
        if sign < 0:
            raise Unknown("the model contains a function whose argument is negative")
        low, high = self.relaxation.reach(argument)
        if not 0 < high - low < WIDEST:
            raise Unknown("the model contains a function whose argument is constant or unbounded")
        t, exact = np.linspace(low, high, SAMPLES), function([node], lead)
        values = exact(t)[0]
        with np.errstate(all="ignore"):
            logs = np.log(np.abs(values))
        if not np.isfinite(logs).all():
            raise Unknown("the model has no value for some designs within the bounds")
        table = SampledFunction.of(t, logs, CAUTION)
        if (values[0] > 0) != (values[-1] > 0) or values.min() * values.max() <= 0:
            raise Unknown("the model contains a function that may be positive or negative")
        least, most = float(logs.min()) - table.room, float(logs.max()) + table.room

        def logarithm(x: Vector) -> Vector:
            return np.asarray(np.log(np.abs(exact(x)[0])))

        form = self._curve(table, argument, least, most, logarithm)
        return math.copysign(1.0, values[0]), form

    def expanded(self, value: Any) -> Signomial | None:
        """A value as a sum of monomials; None if it has too many terms."""
        if not isinstance(value, Symbol):
            return Signomial.number(value) if math.isfinite(value) else None
        if value.index not in self._sums:
            signomial = self._expand(value)
            is_short = signomial is not None and len(signomial.terms) <= LARGEST
            self._sums[value.index] = signomial if is_short else None
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
            choice = branch(node)
            if choice is not None:
                return self.expanded(choice)
        try:
            return Signomial.monomial(*self.form(node))
        except Unknown:
            return None

    def _of_sum(self, node: Symbol) -> tuple[float, Form]:
        """Sign and logarithm of a sum, expanded if terms cancel or an operand's sign is unknown."""
        low, high = node.bounds
        parts = self._cancelled(node) or self._terms(node)
        single = parts.single
        if single is not None:
            return single
        if not parts.terms:
            raise Unknown("a value in the model is always zero, so it has no logarithm")
        plus, minus = parts.sides()
        low, high = (
            max(low, self._lower_bound(plus, minus)),
            min(high, -self._lower_bound(minus, plus)),
        )
        if not minus or not plus:
            sign = -1.0 if minus else 1.0
            ends = (low, high) if sign > 0 else (-high, -low)
            return sign, self.relaxation.total(plus or minus, *ends)
        if low > 0:
            return 1.0, self._difference(plus, minus, low, high)
        if high < 0:
            return -1.0, self._difference(minus, plus, -high, -low)
        raise Unknown("the model contains a subtraction whose result may be positive or negative")

    def _lower_bound(self, plus: Sequence[Form], minus: Sequence[Form]) -> float:
        """Lower bound on the difference of two sums of monomials."""
        least = sum(math.exp(self.relaxation.reach(term)[0]) for term in plus)
        return least - sum(math.exp(min(self.relaxation.reach(term)[1], 700.0)) for term in minus)

    def _cancelled(self, node: Symbol) -> Signomial | None:
        """A sum in expanded form if terms of its operands cancel; else None."""
        parts = [self.expanded(value) for value in (node, *node.args)]
        if None in parts:
            return None
        size, *sizes = (part.size for part in parts if part is not None)
        return parts[0] if size < (1 - 1e-9) * sum(sizes) else None

    def _terms(self, node: Symbol) -> Signomial:
        """A sum or difference as monomials; operands of unknown sign are expanded."""
        first, second = (self.signomial(arg) for arg in node.args)
        return first.plus(second, -1.0 if node.op == "sub" else 1.0)

    def signomial(self, value: Any) -> Signomial:
        """A value of any sign as a sum of as few monomials as possible.

        Raises
        ------
        Unknown
            one of the value's models has no relaxation
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
                return Signomial({}).plus(self.signomial(value.args[0]), -1.0)
            if value.op == "mul":
                return self.signomial(value.args[0]).times(self.signomial(value.args[1]))
            if value.op == "div":
                sign, form = self.form(value.args[1])
                inverse = Signomial.monomial(sign, Form(0.0) - form)
                return self.signomial(value.args[0]).times(inverse)
            raise

    def at_least(self, value: Any, bound: Any) -> None:
        """Add the constraint that a value is at least another value or a number.

        Raises
        ------
        Unknown
            a model of either value has no relaxation
        """
        plus, minus = self.signomial(value).plus(self.signomial(bound), -1.0).sides()
        if minus and not plus:
            raise Unknown("no design within the bounds meets this limit")
        if minus:
            plus_total, minus_total = (
                self.relaxation.total(side, 0.0, math.inf) for side in (plus, minus)
            )
            self.relaxation.rows.append(ConstraintRow(minus_total, plus_total))

    def _difference(
        self, plus: Sequence[Form], minus: Sequence[Form], low: float, high: float
    ) -> Form:
        """Logarithm of the sum of `plus` less the sum of `minus`, between `low` and `high`."""
        minuend = self.relaxation.total(plus, 0.0, math.inf)
        subtrahend = self.relaxation.total(minus, 0.0, math.inf)

        def logarithm(y: Sequence[float]) -> float:
            ratio = minuend.at(y) - subtrahend.at(y)
            return subtrahend.at(y) + math.log(math.expm1(ratio)) if ratio > 0 else -math.inf

        out = self.relaxation.atom(low, high, logarithm)
        self.relaxation.split(minuend, out, subtrahend)
        return out

    def _of_choice(self, node: Symbol) -> tuple[float, Form]:
        choice = branch(node)
        if choice is not None:
            return self.form(choice)
        kind = extreme(node)
        if kind is None:
            raise Unknown("a condition in the model may hold for some designs but not for others")
        (s, a), (t, b) = self.form(node.args[1]), self.form(node.args[2])
        low, high = node.bounds
        if s != t:
            raise Unknown("the model takes a minimum or maximum of values with opposite signs")
        ends = (low, high) if s > 0 else (-high, -low)
        is_larger = (kind == "max") == (s > 0)
        pick = max if is_larger else min
        out = self.relaxation.atom(*ends, lambda y: pick(a.at(y), b.at(y)))
        for option in (a, b):
            self.relaxation.rows.append(
                ConstraintRow(option, out) if is_larger else ConstraintRow(out, option)
            )
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
        raise Unknown(f"no bound is implemented for the function {op}")

    def _logarithm(
        self, graph: object, argument: Any, low: float, high: float
    ) -> tuple[float, Form]:
        """Sign of ln x and the logarithm of |ln x|, which is a curve of ln x.

        ln x is affine in the logarithms of the atoms.
        """
        parts = self.expanded(argument)
        if parts is not None:  # the terms of a sum such as 1.2 + t/r show that it exceeds 1
            plus, minus = parts.sides()
            least = self._lower_bound(plus, minus)
            low = max(low, math.log(least)) if least > 0 else low
        _, form = self.form(argument)
        if low <= 0 <= high:
            raise Unknown("the model contains a logarithm that may be positive or negative")
        sign = 1.0 if low > 0 else -1.0
        inner = form if sign > 0 else Form(0.0) - form
        ends = (low, high) if sign > 0 else (-high, -low)
        return sign, self._curve("log", inner, math.log(ends[0]), math.log(ends[1]))

    def _exponential(self, argument: Any, low: float, high: float) -> Form:
        """Logarithm of e^x, that is x itself, as a curve of the logarithm of x."""
        sign, form = self.form(argument)
        if sign > 0:
            return self._curve("exp", form, math.log(low) if low > 0 else -FAR, math.log(high))
        out = self.relaxation.atom(low, high, lambda y: -math.exp(form.at(y)))
        self.relaxation.curves.append(AtomFunction("exp", form, Form(0.0) - out))
        return out

    def _curve(
        self,
        kind: Kind,
        argument: Form,
        low: float,
        high: float,
        exact: Callable[[Vector], Vector] | None = None,
    ) -> Form:
        """A new atom whose logarithm is a function of a monomial's logarithm.

        `low` and `high` bound the atom's logarithm. `exact` is the function that a sampled `kind`
        interpolates: a steep function, such as cycles over stress, deviates from its
        interpolation by more than the tolerance of a limit.
        """
        value = exact or CurveFunctions([kind]).value
        out = self.relaxation.atom(
            math.exp(low), math.exp(high), lambda y: float(value(np.array([argument.at(y)]))[0])
        )
        self.relaxation.curves.append(AtomFunction(kind, argument, out))
        return out


def _power(value: Any, lead: Symbol) -> bool:
    """Whether a value is a constant times a power of `lead`."""
    if value is lead or not isinstance(value, Symbol):
        return True
    return value.op in _MONOMIAL and all(_power(arg, lead) for arg in value.args)
