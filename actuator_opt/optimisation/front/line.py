"""Designs between two anchors, wherever the front is longest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...base.progress import tell
from ..problem import Vector
from . import references
from .search import FrontSearch
from .tracer import Design, Start

GROWTH = 10
"""Maximum new designs per round, relative to the known ones."""

MOST_ROUNDS = 12
"""Maximum rounds: a continuous front takes two or three."""


def fill_line(search: FrontSearch, count: int) -> None:
    """Add designs between two anchors, wherever the front is longest."""
    for number in range(MOST_ROUNDS):
        missing = count - len(search.chosen())
        if missing <= 0:
            break
        tell("following the front", 1 - missing / count)
        search.sort()
        places = np.array([one.level[0] for one in search.designs])
        more = references.between(
            places, search.units, min(missing, GROWTH * (len(places) - 1) - 1)
        )
        if not len(more):
            break
        search.solve(between(search, more), firmly=number > 0)
    search.cross()


def between(search: FrontSearch, places: Sequence[float] | Vector) -> list[Start]:
    """Starts at places u between the known designs, from their neighbours."""
    search.sort()
    known = [one.level[0] for one in search.designs]
    return [
        _between(search.designs, int(np.searchsorted(known, u)), float(u), np.ones(2))
        for u in places
    ]


def _between(designs: Sequence[Design], k: int, u: float, way: Vector) -> Start:
    """A start before design k by interpolation; from the nearer neighbour if the front jumps."""
    left, right = designs[k - 1], designs[k]
    low, high = left.level[0], right.level[0]
    near = left if u - low < high - u else right
    z = near.point.z
    if not _jumps(left, right):
        some = [left, right]
        if k > 1 and not _jumps(designs[k - 2], left):
            some.insert(0, designs[k - 2])
        if k + 1 < len(designs) and not _jumps(right, designs[k + 1]):
            some.append(designs[k + 1])
        places = np.array([one.level[0] for one in some])
        z = np.stack([one.point.z for one in some], axis=1) @ _weights(places, u)
    return Start(references.on_line(np.array([u]))[:, 0], way, z, near.hessian)


def _jumps(left: Design, right: Design) -> bool:
    """Whether two designs are farther apart than on a continuous front."""
    wide = right.level[0] - left.level[0]
    return bool(np.linalg.norm(right.unit - left.unit) >= references.STEEPEST * wide)


def _weights(places: Vector, u: float) -> Vector:
    """Weights for interpolating values at places (k,) at u, by the polynomial through all."""
    apart = places[:, None] - places + np.eye(len(places))
    to = u - places + np.zeros((len(places), 1))
    np.fill_diagonal(to, 1.0)
    return np.asarray((to / apart - np.eye(len(places)) * (1 / np.diag(apart) - 1)).prod(axis=1))
