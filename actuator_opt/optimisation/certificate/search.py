"""Branch and bound on the log ratios of sums: the least objective that any design can have."""

from __future__ import annotations

import heapq
import itertools
import math
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from ..problem import Vector
from .bounding import Bound, Bounding
from .box import ROOM, Box, Gone, Layout
from .lines import Seen

GUARD = 1e-6
"""Taken off the bound, relative: far above rounding in the traced values."""

CLOSE = 1e-4
"""Gap at which the search ends."""

MIDDLE = 0.2
"""Share of a range that the smaller part gets at least."""

WORTH = 1e-9
"""Least excess times price that a split can gain."""

FAR_OFF = 0.2
"""Excess beyond which a curve is no more worth a split: its first one gains most of it."""

FLOOR = 0.003
"""Least price of a curve in the choice of a direction: several loose ones in a row have none."""

SQUEEZES = 2
"""Most rounds of cutting the first box."""

WAYS = 16
"""Directions cut in a round beside the variables."""

GAIN = 0.1
"""Share of their ranges that a round must cut for another one to be worth it."""


@dataclass(frozen=True, slots=True)
class Found:
    """Lower bound on the objective's logarithm, boxes solved, and whether the gap is closed."""

    bound: float
    boxes: int
    closed: bool


class BoxSearch:
    """A search by splitting the box of least bound where its relaxation is loosest.

    Parameters
    ----------
    layout, bounding : the relaxation
    best : logarithm of the objective that a design must have at most
    variables : atoms whose directions are cut in the first box in any case
    until : time of `time.perf_counter` to stop at
    most : boxes to solve at most
    """

    def __init__(
        self,
        layout: Layout,
        bounding: Bounding,
        best: float,
        *,
        variables: Sequence[int] = (),
        until: float = math.inf,
        most: float = math.inf,
    ) -> None:
        self.layout, self.bounding, self.best = layout, bounding, best
        self.until, self.most = until, most
        self.goal = best + math.log1p(-CLOSE)
        self.least, self.boxes = math.inf, 0
        """Least bound of the boxes that are done with; boxes solved."""
        ways = layout.plain[layout.curves :]
        self.variables = np.flatnonzero(np.isin(ways, variables))
        self._order = itertools.count()
        self._open: list[tuple[float, int, Box, Bound]] = []

    def run(self, report: Callable[[float], None] | None = None) -> Found:
        """The bound that holds when time or boxes are used up, or the gap is closed.

        Parameters
        ----------
        report : called with every better bound
        """
        with suppress(Gone):
            self._add(self._squeezed(Box.whole(self.layout)), -math.inf)
        while self._open:
            if report is not None:
                report(min(self._open[0][0], self.least))
            if self.boxes >= self.most or time.perf_counter() > self.until:
                break
            value, _, box, bound = heapq.heappop(self._open)
            self.bounding.refine(self.best - value)
            choice = self._choice(box, bound)
            if choice is None:
                self.least = min(self.least, value)
                break
            for part in box.split(*choice):
                with suppress(Gone):
                    self._add(part.tightened(self.layout), value)
        bottom = min(self.least, self._open[0][0] if self._open else math.inf, self.goal)
        return Found(bottom + math.log1p(-GUARD), self.boxes, bottom >= self.goal)

    def first(self) -> float:
        """The bound of the first box as it is; infinite where nothing is in it."""
        try:
            box = Box.whole(self.layout).tightened(self.layout)
        except Gone:
            return math.inf
        self.bounding.lay(box)
        bound = self.bounding.solve(box)
        return math.inf if bound is None else bound.value

    def _add(self, box: Box, parent: float) -> None:
        """Keep a box that may hold a better design."""
        bound = self.bounding.solve(box)
        self.boxes += 1
        if bound is None:
            return
        value = max(bound.value, parent)
        if value >= self.goal:
            self.least = min(self.least, value)
            return
        trimmed = self.bounding.trimmed(box, bound, self.best)
        heapq.heappush(self._open, (value, next(self._order), trimmed, bound))

    def _squeezed(self, box: Box) -> Box:
        """The first box cut to where designs no worse than the best known one can be.

        Bounds by optimisation of the directions in which the relaxation is loosest, over and over.

        Raises
        ------
        Gone
            nothing is left
        """
        box = box.tightened(self.layout)
        self.bounding.lay(box)
        for _ in range(SQUEEZES):
            bound = self.bounding.solve(box)
            if bound is None:
                raise Gone
            loose = np.argsort(-self._gains(box, bound), kind="stable")[:WAYS]
            some = np.concatenate([loose, np.setdiff1d(self.variables, loose)])
            size, seen = float((box.high - box.low)[some].sum()), Seen(bound.directions)
            for number in map(int, some):
                if time.perf_counter() > self.until:
                    return box
                reach = self.bounding.extent(number, self.bounding.enter(box), seen)
                if reach is None:
                    raise Gone
                box = box.cut(number, low=reach[0] - ROOM, high=reach[1] + ROOM)
                box = box.tightened(self.layout)
            if float((box.high - box.low)[some].sum()) > (1 - GAIN) * size:
                break
        return box

    def _gains(self, box: Box, bound: Bound) -> Vector:
        """What a split of every direction may gain."""
        gains = np.minimum(bound.excess, FAR_OFF) * (bound.price + FLOOR)
        found = np.bincount(self.layout.direction, gains, self.layout.directions).astype(float)
        width = box.high - box.low
        first, second = self.layout.factors
        np.add.at(found, np.where(width[first] > width[second], first, second), bound.torn)
        return found

    def _choice(self, box: Box, bound: Bound) -> tuple[int, float] | None:
        """Direction and place of the split that can gain most; None where nothing is loose."""
        gains = self._gains(box, bound)
        number = int(np.argmax(gains))
        if gains[number] <= WORTH:
            return None
        low, high = box.low[number], box.high[number]
        room = MIDDLE * (high - low)
        return number, float(np.clip(bound.directions[number], low + room, high - room))
