"""A part of the design space: ranges of atoms and of log ratios, and what follows from them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..problem import Vector
from .relaxation import Relaxation
from .shapes import Mixed
from .signomial import Form, Powers

ROUNDS = 20
"""Most passes of the propagation in a part of the space."""

GAIN = 0.01
"""Share of the summed ranges that a pass must cut for another one to be worth it."""

ROOM = 1e-9
"""Room given to every range for rounding (of logarithms, so relative)."""

CROSSED = 1e-8
"""By how much the ends of a range must cross for nothing to be left."""

FAR = 200.0
"""Largest logarithm of an atom or a ratio; e^200 is beyond any quantity."""


GRID = 33
"""Samples of a band's function over a box."""


class Secants(NamedTuple):
    """slope t + least <= out <= slope t + most for every band, and the range low to high of out."""

    slope: Vector
    least: Vector
    most: Vector
    low: Vector
    high: Vector


class Gone(Exception):
    """Nothing is left of a part of the space."""


class Layout:
    """A relaxation as arrays: every distinct direction in the space of logarithms once.

    A direction is a log ratio, such as log(t/r): all curves of powers of one ratio share it.
    Forms are, in order: outs of curves, directions, outs of bands, rows (each >= 0).
    """

    def __init__(self, relaxation: Relaxation) -> None:
        self.relaxation = relaxation
        self.curves, self.atoms = len(relaxation.curves), len(relaxation.lower)
        self.mixed = Mixed([curve.kind for curve in relaxation.curves])
        known: dict[Powers, int] = {}
        places = []
        for curve in relaxation.curves:
            powers = curve.argument.powers
            factor = powers[0][1]
            key = tuple((i, round(p / factor, 12)) for i, p in powers)
            number = known.setdefault(key, len(known))
            places.append((number, factor, curve.argument.constant))
        ways = [known.setdefault(band.argument.powers, len(known)) for band in relaxation.bands]
        self.band = np.array(ways, dtype=np.intp)
        self.bands = len(ways)
        self.directions = len(known)
        self.direction = np.array([place[0] for place in places], dtype=np.intp)
        self.ways = np.concatenate([self.direction, self.band])
        self.factor = np.array([place[1] for place in places])
        self.constant = np.array([place[2] for place in places])
        forms = [curve.out for curve in relaxation.curves]
        forms += [Form(0.0, key) for key in known]
        forms += [band.out for band in relaxation.bands]
        forms += [row.high - row.low for row in relaxation.rows]
        self.levels = np.array([form.constant for form in forms])
        entries = [(k, i, power) for k, form in enumerate(forms) for i, power in form.powers]
        self.form = np.array([entry[0] for entry in entries], dtype=np.intp)
        self.atom = np.array([entry[1] for entry in entries], dtype=np.intp)
        self.power = np.array([entry[2] for entry in entries])

    @cached_property
    def parts(self) -> tuple[slice, slice, slice, slice]:
        """Forms of curves' outs, of directions, of bands' outs and of rows."""
        ends = np.cumsum([0, self.curves, self.directions, self.bands]).tolist()
        return (
            slice(ends[0], ends[1]),
            slice(ends[1], ends[2]),
            slice(ends[2], ends[3]),
            slice(ends[3], len(self.levels)),
        )

    def arguments(self, low: Vector, high: Vector) -> tuple[Vector, Vector]:
        """Ranges of the curves' arguments from those of the directions."""
        ends = (
            self.factor * low[self.direction] + self.constant,
            self.factor * high[self.direction] + self.constant,
        )
        return np.minimum(*ends), np.maximum(*ends)

    def secants(self, low: Vector, high: Vector) -> Secants:
        """Bands over ranges of the directions: two parallel lines around each function."""
        found = np.zeros((5, self.bands))
        for k, (band, number) in enumerate(zip(self.relaxation.bands, self.band, strict=True)):
            t = np.linspace(low[number], high[number], GRID)
            values = band.function(t)
            step = (high[number] - low[number]) / (GRID - 1)
            slope = (values[-1] - values[0]) / (t[-1] - t[0]) if step > 1e-12 else 0.0
            off, room = values - slope * t, band.bend * step * step / 8 + ROOM
            ends = off.min() - room, off.max() + room, values.min() - room, values.max() + room
            found[:, k] = slope, *ends
        return Secants(*found)

    def reach(self, lower: Vector, upper: Vector) -> tuple[Vector, Vector, Vector, Vector]:
        """Ranges of all forms, and of their entries."""
        ends = self.power * lower[self.atom], self.power * upper[self.atom]
        least, most = np.minimum(*ends), np.maximum(*ends)
        count = len(self.levels)
        low = self.levels + np.bincount(self.form, least, count)
        high = self.levels + np.bincount(self.form, most, count)
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
        """Everything that the bounds of the traced values leave."""
        found = layout.relaxation
        none = np.zeros(layout.directions)
        lower, upper = (np.clip(ends, -FAR, FAR) for ends in (found.lower, found.upper))
        return cls(lower, upper, none - FAR, none + FAR)

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
        """What all rows and curves leave of it.

        Raises
        ------
        Gone
            nothing
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
    """Ranges while they are cut."""

    def __init__(self, layout: Layout, box: Box) -> None:
        self.layout = layout
        self.lower, self.upper = box.lower.copy(), box.upper.copy()
        self.low, self.high = box.low.copy(), box.high.copy()

    def size(self) -> float:
        """All ranges together."""
        return float((self.upper - self.lower).sum() + (self.high - self.low).sum())

    def round(self) -> None:
        """One pass over all forms and curves."""
        layout = self.layout
        outs, ways, bands, rows = layout.parts
        low, high, least, most = layout.reach(self.lower, self.upper)
        self._raise(self.low, self.high, low[ways], high[ways])
        ends = layout.arguments(self.low, self.high)
        values = layout.mixed.value(ends[0]), layout.mixed.value(ends[1])
        goal_low, goal_high = low.copy(), high.copy()
        goal_low[outs] = np.maximum(low[outs], np.minimum(*values))
        goal_high[outs] = np.minimum(high[outs], np.maximum(*values))
        self._back(goal_low[outs], goal_high[outs])
        goal_low[ways], goal_high[ways] = self.low, self.high
        if layout.bands:
            secants = layout.secants(self.low, self.high)
            goal_low[bands] = np.maximum(low[bands], secants.low)
            goal_high[bands] = np.minimum(high[bands], secants.high)
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
        """What the outs of curves say about the directions."""
        layout = self.layout
        ends = [
            (layout.mixed.inverse(end) - layout.constant) / layout.factor for end in (low, high)
        ]
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
