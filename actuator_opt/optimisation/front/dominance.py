"""Which designs are on the front, how evenly they lie, and where the front bends most."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..problem import Vector

Indices = npt.NDArray[np.intp]

CLEARLY = 100.0
"""Multiple of `equal` that counts as clearly better, so that designs cannot dominate in a cycle."""

SAME = 1e-6
"""Distance in normalised objectives below which two designs count as one."""


def nondominated(values: Vector, equal: float = 0.0) -> npt.NDArray[np.bool_]:
    """Which designs no other design dominates: no worse in every objective, better in one.

    Parameters
    ----------
    values : (objectives, designs), to be minimised; of equal designs all stay
    equal : difference that counts as no worse; better means a gain of `CLEARLY` times that

    >>> nondominated(np.array([[1.0, 2.0, 3.0], [3.0, 2.0, 2.0]]))
    array([ True,  True, False])
    """
    count = values.shape[1]
    kept = np.ones(count, dtype=bool)
    for k in range(count):
        one = values[:, k : k + 1]
        beats = (values <= one + equal).all(axis=0) & (values < one - CLEARLY * equal).any(axis=0)
        kept[k] = not beats.any()
    return kept


def distinct(units: Vector, order: Indices) -> Indices:
    """Designs (objectives, designs), in a given order, that are distinct from those before.

    >>> distinct(np.array([[0.0, 0.0, 1.0], [1.0, 1.0, 0.0]]), np.array([1, 0, 2]))
    array([1, 2])
    """
    kept: list[int] = []
    for k in order:
        if not kept or np.abs(units[:, kept] - units[:, k : k + 1]).max(axis=0).min() > SAME:
            kept.append(int(k))
    return np.array(kept, dtype=np.intp)


def thinned(units: Vector, first: Indices, wanted: int) -> Indices:
    """The requested number of designs (objectives, designs), farthest apart, including `first`.

    Each step adds the design farthest from those selected [Gonzalez1985].
    """
    kept = [int(k) for k in first]
    gaps = np.full(units.shape[1], np.inf)
    for k in kept:
        gaps = np.minimum(gaps, distances(units, units[:, k]))
    while len(kept) < min(wanted, units.shape[1]):
        following = int(np.argmax(gaps))
        kept.append(following)
        gaps = np.minimum(gaps, distances(units, units[:, following]))
    return np.array(sorted(kept), dtype=np.intp)


def distances(units: Vector, one: Vector) -> Vector:
    """Euclidean distance of designs (objectives, designs) from one (objectives,)."""
    return np.asarray(np.sqrt(((units - one[:, None]) ** 2).sum(axis=0)))


def nearest(units: Vector) -> Vector:
    """Distance of each design (objectives, designs) to its nearest neighbour."""
    result = np.empty(units.shape[1])
    for k in range(units.shape[1]):
        gaps = distances(units, units[:, k])
        gaps[k] = np.inf
        result[k] = gaps.min(initial=np.inf)
    return result


def knee(units: Vector) -> tuple[int, float] | None:
    """The design farthest from the plane through the anchors towards the ideal, and its distance.

    Units (objectives, designs) are 0 at the best of each objective [Das1999]. If the anchors span
    no plane that falls in every objective, a plane of equal sums through their middle is used. None
    if the front does not bend towards the ideal.

    >>> knee(np.array([[0.0, 0.25, 1.0], [1.0, 0.25, 0.0]]))
    (1, 0.35355339059327373)
    """
    anchors = units[:, np.argmin(units, axis=1)]
    normal: Vector = np.ones(len(units))
    if np.linalg.cond(anchors) < 1e6:
        across = np.asarray(np.linalg.solve(anchors.T, normal), dtype=float)
        normal = across if (across > 0).all() else normal
    depth = ((normal @ anchors).mean() - normal @ units) / np.linalg.norm(normal)
    deepest = int(np.argmax(depth))
    return (deepest, float(depth[deepest])) if depth[deepest] > SAME else None
