"""Branch and bound on the log ratios of sums: the least objective that any design can have."""

from __future__ import annotations

import heapq
import itertools
import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .bounding import Bound, Bounding
from .box import ROOM, Box, Gone, Layout

GUARD = 1e-6
"""Taken off the bound, relative: far above rounding in the traced values."""

CLOSE = 1e-4
"""Gap at which the search ends."""

MIDDLE = 0.2
"""Share of a range that the smaller part gets at least."""

WORTH = 1e-9
"""Least excess times price that a split can gain."""


FLOOR = 0.01
"""Least price of a curve in the choice of a direction: several loose ones in a row have none."""

SQUEEZES = 8
"""Most rounds of cutting the first box."""

WAYS = 16
"""Directions cut in a round."""


@dataclass(frozen=True, slots=True)
class Found:
    """Lower bound on the objective's logarithm, boxes solved, and whether the gap is closed."""

    bound: float
    boxes: int
    closed: bool


def search(
    layout: Layout,
    bounding: Bounding,
    best: float,
    *,
    until: float,
    report: Callable[[float], None] | None = None,
) -> Found:
    """Lower bound by splitting the worst box where its relaxation is loosest.

    Parameters
    ----------
    layout, bounding : the relaxation
    best : logarithm of the objective of the best known design
    until : time of `time.perf_counter` to stop at
    report : called with every better bound
    """
    order = itertools.count()
    heap: list[tuple[float, int, Box, Bound]] = []
    solved = 0
    least = math.inf
    goal = best + math.log1p(-CLOSE)

    def add(box: Box, parent: float) -> None:
        nonlocal solved, least
        try:
            box = box.tightened(layout)
        except Gone:
            return
        bound = bounding.solve(box)
        solved += 1
        if bound is None:
            return
        value = max(bound.value, parent)
        if value >= goal:
            least = min(least, value)
            return
        trimmed = bounding.trimmed(box, bound, best)
        heapq.heappush(heap, (value, next(order), trimmed, bound))

    whole = squeezed(layout, bounding, Box.whole(layout), until)
    if whole is None:
        return Found(goal, 1, True)
    add(whole, -math.inf)
    while heap:
        if report is not None:
            report(min(heap[0][0], least))
        if time.perf_counter() > until:
            break
        value, _, box, bound = heapq.heappop(heap)
        choice = _choice(layout, box, bound)
        if choice is None:
            least = min(least, value)
            break
        for part in box.split(*choice):
            add(part, value)
    bottom = min(least, heap[0][0] if heap else math.inf, best)
    return Found(bottom + math.log1p(-GUARD), solved, bottom >= goal)


ROUNDS2, WAYS2 = 1, 2


def squeezed(
    layout: Layout,
    bounding: Bounding,
    box: Box,
    until: float,
    *,
    rounds: int = SQUEEZES,
    ways: int = WAYS,
) -> Box | None:
    """A box cut to where designs no worse than the best known one can be; None of none.

    Bound by optimisation of the directions in which the relaxation is loosest, over and over.
    """
    try:
        box = box.tightened(layout)
        if rounds == SQUEEZES:
            bounding.lay(box)
        for _ in range(rounds):
            bound = bounding.solve(box)
            if bound is None:
                return None
            gain = np.bincount(layout.direction, bound.excess * (bound.price + FLOOR), layout.directions)
            some = np.argsort(-gain, kind="stable")[:ways]
            size = float((box.high - box.low)[some].sum())
            for number in some:
                if time.perf_counter() > until:
                    return box
                reach = bounding.extent(int(number), bounding.enter(box))
                if reach is None:
                    return None
                box = box.cut(int(number), low=reach[0] - ROOM, high=reach[1] + ROOM)
                box = box.tightened(layout)
            if float((box.high - box.low)[some].sum()) > 0.9 * size:
                break
    except Gone:
        return None
    return box


def _choice(layout: Layout, box: Box, bound: Bound) -> tuple[int, float] | None:
    """Direction and place of the split that can gain most; None where nothing is loose."""
    gain = np.bincount(layout.direction, bound.excess * (bound.price + FLOOR), layout.directions)
    number = int(np.argmax(gain))
    if gain[number] <= WORTH:
        return None
    low, high = box.low[number], box.high[number]
    at = bound.directions[number]
    room = MIDDLE * (high - low)
    return number, float(np.clip(at, low + room, high - room))
