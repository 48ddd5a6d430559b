"""Branch and bound on the log ratios of sums: a lower bound on the objective of any design."""

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
"""Relative deduction from the bound, far above rounding in the traced values."""

CLOSE = 1e-4
"""Gap at which the search ends."""

MIDDLE = 0.2
"""Least share of a range in the smaller part of a split."""

WORTH = 1e-9
"""Least excess times price that justifies a split."""

FAR_OFF = 0.2
"""Excess above which further splits of a curve gain little; the first split gains most."""

FLOOR = 0.003
"""Least price of a curve when choosing a direction; consecutive loose curves show none."""

SQUEEZES = 2
"""Maximum rounds of cutting the first box."""

WAYS = 16
"""Directions cut per round, beside the variables."""

GAIN = 0.1
"""Share of their ranges that a round must cut to justify another."""


@dataclass(frozen=True, slots=True)
class Found:
    """Lower bound on the objective's logarithm, boxes solved, and whether the gap is closed."""

    bound: float
    boxes: int
    closed: bool


class BoxSearch:
    """A search that splits the box with the least bound where its relaxation is loosest.

    Parameters
    ----------
    layout, bounding : the relaxation
    best : logarithm of the largest objective a design may have
    variables : atoms whose directions are always cut in the first box
    until : time of `time.perf_counter` to stop at
    most : maximum number of boxes to solve
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
        """Least bound of the finished boxes; number of boxes solved."""
        ways = layout.plain[layout.curves :]
        self.variables = np.flatnonzero(np.isin(ways, variables))
        self._order = itertools.count()
        self._open: list[tuple[float, int, Box, Bound]] = []

    def run(self, report: Callable[[float], None] | None = None) -> Found:
        """Search until time or boxes run out or the gap closes; returns the bound.

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
        """The bound of the first box; infinite if it is empty."""
        try:
            box = Box.whole(self.layout).tightened(self.layout)
        except Gone:
            return math.inf
        self.bounding.lay(box)
        bound = self.bounding.solve(box)
        return math.inf if bound is None else bound.value

    def _add(self, box: Box, parent: float) -> None:
        """Add a box that may hold a better design."""
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
        """The first box, cut to the designs no worse than the best known one.

        Repeatedly bounds the directions in which the relaxation is loosest, by optimisation.

        Raises
        ------
        Gone
            the box is empty
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
        """Possible gain of a split along every direction."""
        gains = np.minimum(bound.excess, FAR_OFF) * (bound.price + FLOOR)
        found = np.bincount(self.layout.direction, gains, self.layout.directions).astype(float)
        width = box.high - box.low
        first, second = self.layout.factors
        np.add.at(found, np.where(width[first] > width[second], first, second), bound.torn)
        return found

    def _choice(self, box: Box, bound: Bound) -> tuple[int, float] | None:
        """Direction and place of the split with the largest possible gain, or None."""
        gains = self._gains(box, bound)
        number = int(np.argmax(gains))
        if gains[number] <= WORTH:
            return None
        low, high = box.low[number], box.high[number]
        room = MIDDLE * (high - low)
        return number, float(np.clip(bound.directions[number], low + room, high - room))
