"""Stress over a mesh of triangles as bands between levels: few outlines instead of many triangles.

The stress of the elements is averaged at the corners, within each body, and linear between them.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, TypeAlias, TypeVar

import numpy as np

from ..rendering.ink import Point

if TYPE_CHECKING:
    from ..finite_elements.result import StressField

Name = TypeVar("Name", bound=Hashable)
Key: TypeAlias = tuple[int, int, int]
"""A corner (itself, itself, 0), or where the edge between two corners meets a level."""


def corner_values(field: StressField) -> np.ndarray:
    """Stress at every corner: the mean of the elements around it, by their area [Pa]."""
    a, b, c = (field.nodes[field.triangles[:, k]] for k in range(3))
    area = np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    total, weight = np.zeros(len(field.nodes)), np.zeros(len(field.nodes))
    for k in range(3):
        np.add.at(total, field.triangles[:, k], area * field.von_mises)
        np.add.at(weight, field.triangles[:, k], area)
    return np.asarray(total / weight)


def outlines(field: StressField) -> list[list[list[Point]]]:
    """Outline of every body, in the field's coordinates."""
    places = [(float(x), float(y)) for x, y in field.nodes]
    found = []
    for body in range(int(field.body.max()) + 1):
        rings = _rings([int(k) for k in one] for one in field.triangles[field.body == body])
        found.append([[places[k] for k in ring] for ring in rings])
    return found


def bands(field: StressField, levels: Sequence[float]) -> list[list[list[Point]]]:
    """Outlines of every band between two neighbouring levels, as `outlines`; holes turn back.

    Parameters
    ----------
    levels : rising; the lowest and the highest enclose the stress [Pa]
    """
    values = corner_values(field)
    aside = 1e-9 * (levels[-1] - levels[0])
    for level in levels:  # no corner exactly on a level: it would be two points in one place
        nudged = level + (aside if level < levels[-1] else -aside)
        values = np.where(np.abs(values - level) < aside, nudged, values)
    corners = field.triangles.tolist()
    found = []
    for low, high in pairwise(range(len(levels))):
        pieces = [_between(one, values, levels, low, high) for one in corners]
        rings = _rings(piece for piece in pieces if piece)
        found.append([[_place(key, field, values, levels) for key in ring] for ring in rings])
    return found


def _between(
    corners: Sequence[int], values: np.ndarray, levels: Sequence[float], low: int, high: int
) -> list[Key]:
    """The part of a triangle between two levels, as keys of its corners in order."""
    own = [float(values[k]) for k in corners]
    if max(own) <= levels[low] or min(own) >= levels[high]:
        return []
    found: list[Key] = []
    for (i, start), (j, end) in zip(
        zip(corners, own, strict=True),
        zip([*corners[1:], corners[0]], [*own[1:], own[0]], strict=True),
        strict=True,
    ):
        if levels[low] < start < levels[high]:
            found.append((i, i, 0))
        first, last = min(i, j), max(i, j)
        for level in (low, high) if end > start else (high, low):
            if (start - levels[level]) * (end - levels[level]) < 0:
                found.append((first, last, level))
    return found


def _place(key: Key, field: StressField, values: np.ndarray, levels: Sequence[float]) -> Point:
    i, j, level = key
    if i == j:
        return float(field.nodes[i, 0]), float(field.nodes[i, 1])
    share = (levels[level] - values[i]) / (values[j] - values[i])
    x, y = field.nodes[i] + share * (field.nodes[j] - field.nodes[i])
    return float(x), float(y)


def _rings(polygons: Iterable[Sequence[Name]]) -> list[list[Name]]:
    """Outlines of polygons that turn one way and share edges: what two of them share goes."""
    edges: dict[tuple[Name, Name], bool] = {}
    for polygon in polygons:
        for start, end in zip(polygon, [*polygon[1:], polygon[0]], strict=True):
            if (end, start) in edges:
                del edges[end, start]
            else:
                edges[start, end] = True
    after: dict[Name, list[Name]] = {}
    for start, end in edges:
        after.setdefault(start, []).append(end)
    found = []
    while after:
        first = next(iter(after))
        ring, here = [], first
        while True:
            ring.append(here)
            following = after[here]
            here = following.pop()
            if not following:
                del after[ring[-1]]
            if here == first:
                break
        found.append(ring)
    return found
