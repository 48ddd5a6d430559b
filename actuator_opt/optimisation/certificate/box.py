"""A part of the design space: ranges of atoms and of log ratios, and their implications."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..problem import Vector
from .relaxation import FAR, Form, Mixed, Powers, Relaxation, Table, Tables

ROUNDS = 20
"""Maximum passes of the propagation in one box."""

GAIN = 0.01
"""Share of the summed ranges that a pass must cut to justify another."""

ROOM = 1e-9
"""Tolerance on every range for rounding (of logarithms, so relative)."""

CROSSED = 1e-8
"""Overlap of crossed range ends that proves a box empty."""


def _lone(form: Form) -> int:
    """The atom that a form consists of; -1 for other forms."""
    lone = form.constant == 0 and len(form.powers) == 1 and form.powers[0][1] == 1.0
    return form.powers[0][0] if lone else -1


class Gone(Exception):
    """A part of the design space is empty."""


class Layout:
    """A relaxation as arrays; each distinct direction in logarithmic space appears once.

    A direction is a log ratio, such as log(t/r), shared by all curves of powers of that ratio. Its
    largest power is 1, so its range is no longer than those of its atoms together. Forms come in
    this order: outputs of curves, directions, rows (each >= 0).
    """

    def __init__(self, relaxation: Relaxation) -> None:
        self.relaxation = relaxation
        self.curves, self.atoms = len(relaxation.curves), len(relaxation.lower)
        self.mixed = Mixed([curve.kind for curve in relaxation.curves])
        known: dict[Powers, int] = {}
        places = []
        for curve in relaxation.curves:
            powers = curve.argument.powers
            factor = max((p for _, p in powers), key=abs)
            key = tuple((i, round(p / factor, 12)) for i, p in powers)
            number = known.setdefault(key, len(known))
            places.append((number, factor, curve.argument.constant))
        self.links = relaxation.links
        self._of_curve = {id(curve): k for k, curve in enumerate(relaxation.curves)}
        self.directions = len(known)
        self.direction = np.array([place[0] for place in places], dtype=np.intp)
        self.factor = np.array([place[1] for place in places])
        self.constant = np.array([place[2] for place in places])
        forms = [curve.out for curve in relaxation.curves]
        forms += [Form(0.0, key) for key in known]
        self.plain = np.array([_lone(form) for form in forms], dtype=np.intp)
        forms += [row.high - row.low for row in relaxation.rows]
        self.levels = np.array([form.constant for form in forms])
        entries = [(k, i, power) for k, form in enumerate(forms) for i, power in form.powers]
        self.form = np.array([entry[0] for entry in entries], dtype=np.intp)
        self.atom = np.array([entry[1] for entry in entries], dtype=np.intp)
        self.power = np.array([entry[2] for entry in entries])

    @cached_property
    def factors(self) -> tuple[np.ndarray, np.ndarray]:
        """Directions of both factors of every product."""
        way = {
            curve.out.powers[0][0]: int(number)
            for curve, number in zip(self.relaxation.curves, self.direction, strict=True)
            if curve.kind == "exp" and len(curve.out.powers) == 1
        }
        found = [(way[one.first], way[one.second]) for one in self.relaxation.products]
        first, second = np.array(found, dtype=np.intp).reshape(-1, 2).T
        return first, second

    @cached_property
    def _linked(self) -> tuple[Tables, np.ndarray, Vector]:
        """Tables of the links, the numbers of their curves, and the levels of the ratios."""
        number = np.array([self._of_curve[id(link.curve)] for link in self.links])
        kinds = [link.curve.kind for link in self.links]
        tables = Tables([kind for kind in kinds if isinstance(kind, Table)])
        return tables, number, np.array([link.level for link in self.links])

    def ratios(self, box: Box) -> tuple[Vector, Vector]:
        """Least and largest ratio of every link in a box."""
        if not self.links:
            return np.empty(0), np.empty(0)
        tables, number, constant = self._linked
        first, last = (ends[number] for ends in self.arguments(box.low, box.high))
        off = tables.apart(first, last, np.ones(len(number)), tables.rows)
        start = constant + tables.value(first) - first
        return np.exp(start + off[0] - tables.room), np.exp(start + off[1] + tables.room)

    @cached_property
    def parts(self) -> tuple[slice, slice, slice]:
        """Forms of outputs, of directions and of rows."""
        first, second = self.curves, self.curves + self.directions
        return slice(0, first), slice(first, second), slice(second, len(self.levels))

    def arguments(self, low: Vector, high: Vector) -> tuple[Vector, Vector]:
        """Ranges of the curves' arguments from those of the directions."""
        ends = (
            self.factor * low[self.direction] + self.constant,
            self.factor * high[self.direction] + self.constant,
        )
        return np.minimum(*ends), np.maximum(*ends)

    def reach(self, lower: Vector, upper: Vector) -> tuple[Vector, Vector, Vector, Vector]:
        """Ranges of all forms, and of their terms."""
        ends = self.power * lower[self.atom], self.power * upper[self.atom]
        least, most = np.minimum(*ends), np.maximum(*ends)
        count = len(self.levels)
        low: Vector = self.levels + np.bincount(self.form, least, count)
        high: Vector = self.levels + np.bincount(self.form, most, count)
        return low, high, least, most


@dataclass(frozen=True)
class Box:
    """Ranges of the atoms' logarithms and of the directions."""

    lower: Vector
    upper: Vector
    low: Vector
    high: Vector

    @classmethod
    def whole(cls, layout: Layout) -> Box:
        """The box given by the bounds of the traced values."""
        found = layout.relaxation
        none = np.zeros(layout.directions)
        lower, upper = (np.clip(ends, -FAR, FAR) for ends in (found.lower, found.upper))
        return cls(lower, upper, none - FAR, none + FAR)

    def range(self, form: Form) -> tuple[float, float]:
        """Range of a monomial's logarithm."""
        low = high = form.constant
        for i, power in form.powers:
            ends = power * self.lower[i], power * self.upper[i]
            low, high = low + min(ends), high + max(ends)
        return low, high

    def split(self, direction: int, at: float) -> tuple[Box, Box]:
        """The part below and the part above a value of a direction."""
        return self.cut(direction, high=at), self.cut(direction, low=at)

    def cut(self, direction: int, *, low: float = -FAR, high: float = FAR) -> Box:
        """The part between two values of a direction."""
        lows, highs = self.low.copy(), self.high.copy()
        lows[direction] = max(lows[direction], low)
        highs[direction] = min(highs[direction], high)
        return replace(self, low=lows, high=highs)

    def tightened(self, layout: Layout) -> Box:
        """The box cut by all rows and curves.

        Raises
        ------
        Gone
            the box is empty
        """
        work = _Work(layout, self)
        size = work.size()
        for _ in range(ROUNDS):
            work.round()
            left = work.size()
            if left > (1 - GAIN) * size:
                break
            size = left
        return Box(work.lower, work.upper, work.low, work.high)


class _Work:
    """Ranges while they are being cut."""

    def __init__(self, layout: Layout, box: Box) -> None:
        self.layout = layout
        self.lower, self.upper = box.lower.copy(), box.upper.copy()
        self.low, self.high = box.low.copy(), box.high.copy()

    def size(self) -> float:
        """Sum of all ranges."""
        return float((self.upper - self.lower).sum() + (self.high - self.low).sum())

    def round(self) -> None:
        """One pass over all forms and curves."""
        layout = self.layout
        outs, ways, rows = layout.parts
        low, high, least, most = layout.reach(self.lower, self.upper)
        self._raise(self.low, self.high, low[ways], high[ways])
        values = layout.mixed.hull(*layout.arguments(self.low, self.high))
        goal_low, goal_high = low.copy(), high.copy()
        goal_low[outs] = np.maximum(low[outs], values[0])
        goal_high[outs] = np.minimum(high[outs], values[1])
        self._back(goal_low[outs], goal_high[outs])
        goal_low[ways], goal_high[ways] = self.low, self.high
        goal_low[rows] = np.maximum(low[rows], 0.0)
        if (goal_low > goal_high + CROSSED).any():
            raise Gone
        rest_low = low[layout.form] - least
        rest_high = high[layout.form] - most
        ends = (
            (goal_low[layout.form] - rest_high) / layout.power,
            (goal_high[layout.form] - rest_low) / layout.power,
        )
        lower, upper = self.lower.copy(), self.upper.copy()
        np.maximum.at(lower, layout.atom, np.minimum(*ends) - ROOM)
        np.minimum.at(upper, layout.atom, np.maximum(*ends) + ROOM)
        self._raise(self.lower, self.upper, lower, upper)

    def _back(self, low: Vector, high: Vector) -> None:
        """Cut the directions through the outputs of curves."""
        layout = self.layout
        inner = layout.mixed.within(low, high)
        ends = [(end - layout.constant) / layout.factor for end in inner]
        lows, highs = self.low.copy(), self.high.copy()
        np.maximum.at(lows, layout.direction, np.minimum(*ends) - ROOM)
        np.minimum.at(highs, layout.direction, np.maximum(*ends) + ROOM)
        self._raise(self.low, self.high, lows, highs)

    @staticmethod
    def _raise(low: Vector, high: Vector, new_low: Vector, new_high: Vector) -> None:
        """Cut ranges in place."""
        np.maximum(low, new_low, out=low)
        np.minimum(high, new_high, out=high)
        crossed = low > high
        if crossed.any():
            if (low[crossed] > high[crossed] + CROSSED).any():
                raise Gone
            middle = (low[crossed] + high[crossed]) / 2
            low[crossed] = high[crossed] = middle
