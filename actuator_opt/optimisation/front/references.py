"""Levels of the objectives at which designs are wanted, on the plane of the anchors.

Two objectives use the line u -> (u, 1 - u). Along it a front is never steeper than 45 degrees, so
its length between two places is at most twice their difference in u. More objectives use a lattice
of the plane sum = 1, where its lines meet the box of ideal and nadir.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations, product

import numpy as np

from ..problem import Vector

STEEPEST = 2.0
"""Maximum length of a two-objective front per unit of u."""


def on_line(places: Vector) -> Vector:
    """Levels (2, k) at places u (k,) between the anchors of the first and the second objective."""
    return np.stack([places, 1.0 - places])


def lengths(places: Vector, units: Vector) -> Vector:
    """Length of the front between neighbours (k - 1,), jumps excluded.

    Parameters
    ----------
    places : u (k,), ascending
    units : normalised objectives (2, k) there
    """
    way = np.sqrt((np.diff(units, axis=1) ** 2).sum(axis=0))
    return np.asarray(np.minimum(way, STEEPEST * np.diff(places)))


def between(places: Vector, units: Vector, count: int) -> Vector:
    """The requested number of new places u, where the front is longest between neighbours."""
    way = lengths(places, units)
    pieces = np.ones(len(way), dtype=int)
    for _ in range(count):
        longest = int(np.argmax(way / pieces))
        if not way[longest] > 0:
            break
        pieces[longest] += 1
    parts = [
        places[k] + (places[k + 1] - places[k]) * np.arange(1, n) / n for k, n in enumerate(pieces)
    ]
    return np.concatenate(parts) if parts else np.empty(0)


def places(objectives: int, steps: int) -> list[tuple[int, ...]]:
    """Places of a lattice, in steps from the middle, whose lines meet the unit box.

    >>> len(places(3, 1)), len(places(3, 2))
    (1, 7)
    """
    axis = range(-steps, steps + 1)
    return [
        (*most, last)
        for most in product(axis, repeat=objectives - 1)
        if (last := -sum(most)) in axis and max(*most, last) - min(*most, last) <= steps
    ]


def around(place: tuple[int, ...]) -> list[tuple[int, ...]]:
    """The neighbours of a place.

    >>> around((0, 0))
    [(-1, 1), (1, -1)]
    """
    found = []
    for up, down in permutations(range(len(place)), 2):
        near = list(place)
        near[up] += 1
        near[down] -= 1
        found.append(tuple(near))
    return sorted(found)


def level(place: Sequence[int], steps: int) -> Vector:
    """Levels (objectives,) at a place."""
    return 1.0 / len(place) + np.array(place, dtype=float) / steps
