"""Where along the front a design is wanted: levels of the objectives on the plane of the anchors.

Two objectives have the line u -> (u, 1 - u): along it a front is never steeper than 45 degrees, so
that its length between two places is at most twice their difference in u. More objectives have a
lattice of the plane sum = 1, as far as lines from it meet the box of ideal and nadir.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from ..problem import Vector

STEEPEST = 2.0
"""Longest way along a front of two objectives per unit of u."""


def on_line(places: Vector) -> Vector:
    """Levels (2, k) at places u (k,) between the anchors of the first and the second objective."""
    return np.stack([places, 1.0 - places])


def lengths(places: Vector, units: Vector) -> Vector:
    """Way along the front between neighbours (k - 1,), a jump of it left out.

    Parameters
    ----------
    places : u (k,), ascending
    units : normalised objectives (2, k) there
    """
    way = np.sqrt((np.diff(units, axis=1) ** 2).sum(axis=0))
    return np.asarray(np.minimum(way, STEEPEST * np.diff(places)))


def between(places: Vector, units: Vector, count: int) -> Vector:
    """So many more places u, wherever the front is longest between two neighbours."""
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


def lattice(objectives: int, steps: int) -> Vector:
    """Levels (objectives, k) of a lattice with so many steps from the middle to an anchor's level.

    >>> lattice(3, 1).shape, lattice(3, 2).shape
    ((3, 1), (3, 7))
    """
    axis = range(-steps, steps + 1)
    whole = [
        (*most, last)
        for most in product(axis, repeat=objectives - 1)
        if (last := -sum(most)) in axis and max(*most, last) - min(*most, last) <= steps
    ]
    return 1.0 / objectives + np.array(whole, dtype=float).T / steps
