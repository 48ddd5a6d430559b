"""The final designs of a front: evenly spread, with wide gaps closed or explained."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...base.progress import tell
from ..problem import Vector
from ..resolve.parallel_descents import RESIDUAL
from . import plane, tracer
from .plane import between_on_line
from .tracer import FrontSearch

WIDEST = 3.0
"""Largest gap between neighbours, relative to the median gap."""
MOST_ROUNDS = 6
"""Maximum rounds of adding designs in wide gaps."""
PIECES = 8
"""Maximum number of pieces per split of a gap."""


@dataclass(frozen=True)
class Gap:
    """A wide gap between neighbours of a front, in normalised objectives.

    Parameters
    ----------
    after : index of the design before it
    size : distance of its two designs
    reach : upper limit of the front's length between them, from the levels tried
    jump : whether that is at most a median gap, so that the front is discontinuous here
    """

    after: int
    size: float
    reach: float
    jump: bool


def chosen(search: FrontSearch, count: int) -> tracer.Indices:
    """The requested number of designs, farthest apart, along the first objective."""
    kept = np.array([k for k in search.chosen() if search.residual(k) <= RESIDUAL], dtype=np.intp)
    units = search.units[:, kept]
    order = np.lexsort(units[::-1])
    kept, units = kept[order], units[:, order]
    if len(kept) <= count:
        return kept
    firm = [*np.argmin(units, axis=1).tolist(), *np.argmax(units, axis=1).tolist()]
    if len(units) == 2:
        jumps = [gap.after for gap in wide(search, kept) if gap.jump]
        firm += [k + side for k in jumps for side in (0, 1)]
    first = np.array(list(dict.fromkeys(firm))[:count], dtype=np.intp)
    return kept[tracer.thinned(units, first, count)]


def wide(search: FrontSearch, kept: tracer.Indices) -> list[Gap]:
    """The wide gaps between designs of two objectives, in order."""
    units = search.units[:, kept]
    sizes = np.sqrt((np.diff(units, axis=1) ** 2).sum(axis=0))
    reaches = np.array([float(_pieces(search, *two).sum()) for two in _pairs(kept)])
    middle = float(np.median(np.minimum(sizes, reaches))) if len(sizes) else 0.0
    return [
        Gap(k, float(sizes[k]), float(reaches[k]), bool(reaches[k] <= middle))
        for k in np.flatnonzero(sizes > WIDEST * middle).tolist()
    ]


def close(search: FrontSearch, count: int) -> None:
    """Add designs of two objectives in wide gaps until only jumps remain."""
    for number in range(MOST_ROUNDS):
        kept = chosen(search, count)
        open_ = [gap for gap in wide(search, kept) if not gap.jump]
        if not open_:
            return
        tell("closing gaps of the front", number / MOST_ROUNDS)
        places = []
        for gap in open_:
            among = _among(search, kept[gap.after], kept[gap.after + 1])
            levels = np.array([search.designs[k].level[0] for k in among])
            more = plane.between(levels, search.units[:, among], PIECES - 1)
            places += more.tolist()
        if not search.solve(between_on_line(search, places)):
            return


def middles(search: FrontSearch, count: int) -> list[int]:
    """Add a design at the middle level of each wide gap, widest first."""
    kept, found = chosen(search, count), []
    for gap in sorted(wide(search, kept), key=lambda one: -one.size):
        among = _among(search, kept[gap.after], kept[gap.after + 1])
        levels = [search.designs[k].level[0] for k in among]
        middle = (levels[0] + levels[-1]) / 2
        found.append(int(among[int(np.argmin(np.abs(np.subtract(levels, middle))))]))
    return found


def lost(search: FrontSearch, kept: tracer.Indices) -> int:
    """Number of levels without a design in or near them, in gaps that are not jumps."""
    units = search.units[:, kept]
    if len(units) > 2:
        widest = tracer.nearest(units).max(initial=0.0)
        plane = search.plane[:, kept]
        levels = [level - level.mean() for level in search.lost]
        return sum(bool(tracer.distances(plane, one).min() > widest) for one in levels)
    ranges = [
        sorted(search.designs[kept[gap.after + side]].level[0] for side in (0, 1))
        for gap in wide(search, kept)
        if not gap.jump
    ]
    return sum(any(low < a[0] < high for low, high in ranges) for a in search.lost)


def _pairs(kept: tracer.Indices) -> Iterator[tuple[int, int]]:
    return zip(kept[:-1].tolist(), kept[1:].tolist(), strict=True)


def _among(search: FrontSearch, left: int, right: int) -> tracer.Indices:
    """Designs at levels between two given ones, in order."""
    levels = np.array([one.level[0] for one in search.designs])
    low, high = sorted((levels[left], levels[right]))
    order = np.argsort(levels, kind="stable")
    within = (levels[order] >= low) & (levels[order] <= high)
    return np.asarray(order[within], dtype=np.intp)


def _pieces(search: FrontSearch, left: int, right: int) -> Vector:
    """Upper limits of the front's length between neighbouring levels of a section."""
    among = _among(search, left, right)
    levels = np.array([search.designs[k].level[0] for k in among])
    return plane.lengths(levels, search.units[:, among])
