"""A part of the design space: ranges of atoms and of log ratios, and what follows from them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ..problem import Vector
from .relaxation import Relaxation
from .shapes import SHAPES
from .signomial import Form, Powers

ROUNDS = 6
"""Most passes of the propagation in a part of the space."""

GAIN = 1e-2
"""Share of a range that a pass must cut for another one to be worth it."""

ROOM = 1e-9
"""Room given to every range for rounding (of logarithms, so relative)."""


@dataclass(frozen=True)
class Layout:
    """A relaxation as lists: every distinct direction in the space of logarithms once.

    A direction is a log ratio, such as log(t/r): all curves of powers of one ratio share it.
    """

    relaxation: Relaxation
    directions: tuple[Powers, ...]
    arguments: tuple[tuple[int, float, float], ...]
    """Of every curve: direction, factor and constant of its argument."""
    of_atom: dict[int, int]
    """Direction of a lone atom."""

    @classmethod
    def of(cls, relaxation: Relaxation) -> Layout:
        """Sort out the directions."""
        known: dict[Powers, int] = {}
        arguments = []
        for curve in relaxation.curves:
            powers = curve.argument.powers
            factor = powers[0][1]
            key = tuple((i, round(p / factor, 12)) for i, p in powers)
            number = known.setdefault(key, len(known))
            arguments.append((number, factor, curve.argument.constant))
        lone = {key[0][0]: number for key, number in known.items() if len(key) == 1}
        return cls(relaxation, tuple(known), tuple(arguments), lone)


class Gone(Exception):
    """Nothing is left of a part of the space."""


@dataclass(frozen=True)
class Box:
    """Ranges of the atoms' logarithms and of the directions."""

    lower: Vector
    upper: Vector
    low: Vector
    high: Vector

    @classmethod
    def whole(cls, layout: Layout) -> Box:
        """Everything that the bounds of the traced values leave."""
        count = len(layout.directions)
        return cls(
            np.array(layout.relaxation.lower),
            np.array(layout.relaxation.upper),
            np.full(count, -np.inf),
            np.full(count, np.inf),
        )

    def split(self, direction: int, at: float) -> tuple[Box, Box]:
        """The part below and the part above a value of a direction."""
        high, low = self.high.copy(), self.low.copy()
        high[direction] = low[direction] = at
        return replace(self, high=high), replace(self, low=low)

    def tightened(self, layout: Layout) -> Box:
        """What all rows and curves leave of it.

        Raises
        ------
        Gone
            nothing
        """
        box = Box(*(one.copy() for one in (self.lower, self.upper, self.low, self.high)))
        for _ in range(ROUNDS):
            if not box._round(layout):
                break
        return box

    def _round(self, layout: Layout) -> bool:
        gained = False
        for row in layout.relaxation.rows:
            low, high = self.range(row.low)[0], self.range(row.high)[1]
            gained |= self._limit(row.high, low, math.inf) | self._limit(row.low, -math.inf, high)
        for curve, (number, factor, constant) in zip(
            layout.relaxation.curves, layout.arguments, strict=True
        ):
            shape, along = SHAPES[curve.kind], Form(0.0, layout.directions[number])
            gained |= self._cut(number, *self.range(along))
            ends = self.argument(number, factor, constant)
            values = [shape.value(end) for end in ends]
            gained |= self._limit(curve.out, min(values), max(values))
            values = [shape.inverse(end) for end in self.range(curve.out)]
            inner = sorted((value - constant) / factor for value in values)
            gained |= self._cut(number, inner[0], inner[1])
            gained |= self._limit(along, self.low[number], self.high[number])
        return gained

    def argument(self, number: int, factor: float, constant: float) -> tuple[float, float]:
        """Range of a curve's argument."""
        ends = (factor * self.low[number] + constant, factor * self.high[number] + constant)
        return (ends[0], ends[1]) if factor > 0 else (ends[1], ends[0])

    def range(self, form: Form) -> tuple[float, float]:
        """Range of a monomial's logarithm."""
        low = high = form.constant
        for i, power in form.powers:
            first, second = power * self.lower[i], power * self.upper[i]
            low, high = (
                (low + first, high + second) if power > 0 else (low + second, high + first)
            )
        return low, high

    def _cut(self, number: int, low: float, high: float) -> bool:
        """Cut a direction's range."""
        old = (self.low[number], self.high[number])
        new = _within(old, low, high)
        self.low[number], self.high[number] = new
        return _much(old, new)

    def _limit(self, form: Form, low: float, high: float) -> bool:
        """Cut the atoms' ranges so that a monomial's logarithm can lie between two numbers."""
        least, most = self.range(form)
        if least > high + ROOM or most < low - ROOM:
            raise Gone
        gained = False
        for i, power in form.powers:
            others = tuple(one for one in form.powers if one[0] != i)
            rest_low, rest_high = self.range(Form(form.constant, others))
            ends = ((low - rest_high) / power, (high - rest_low) / power)
            old = (self.lower[i], self.upper[i])
            new = _within(old, min(ends), max(ends))
            self.lower[i], self.upper[i] = new
            gained |= _much(old, new)
        return gained


def _within(old: tuple[float, float], low: float, high: float) -> tuple[float, float]:
    if low != low or high != high:
        return old
    low, high = max(old[0], low - ROOM), min(old[1], high + ROOM)
    if low > high:
        if low > high + 10 * ROOM:
            raise Gone
        low = high = (low + high) / 2
    return low, high


def _much(old: tuple[float, float], new: tuple[float, float]) -> bool:
    width = old[1] - old[0]
    if not math.isfinite(width):
        return new != old
    return new[1] - new[0] < (1 - GAIN) * width
