"""Contour plots: shaded bands between levels, on a grid or on a mesh of triangles.

Small values are light and large values dark, so that a grey print can be read.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable, Sequence
from itertools import pairwise
from typing import Any, TypeAlias, TypeVar

import numpy as np

from .axes import Axes
from .ink import WHITE, Ink, Point
from .text import number, trimmed

_LIGHT, _DARK = (0xF1, 0xF6, 0xF9), (0x0B, 0x3C, 0x5D)
_MOST = 11
"""Maximum number of bands."""

Name = TypeVar("Name", bound=Hashable)
Key: TypeAlias = tuple[int, int, int]
"""Key of a point: a corner k is (k, k, 0); the point on the edge between corners i and j at which a
level is reached is (i, j, level)."""


def levels(low: float, high: float) -> list[float]:
    """Round levels over a positive range: six per decade, or fewer over many decades.

    >>> levels(33.0, 121.0), levels(110.0, 2.2e7)[:3]
    ([30.0, 50.0, 70.0, 100.0, 150.0], [100.0, 300.0, 1000.0])
    """
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    for steps in ((1, 1.5, 2, 3, 5, 7), (1, 2, 5), (1, 3), (1,)):
        candidates = [step * 10.0**power for power in powers for step in steps]
        first = max(k for k, v in enumerate(candidates) if v <= low * (1 + 1e-9))
        above = (k for k, v in enumerate(candidates) if v >= high * (1 - 1e-9))
        last = min(above, default=len(candidates))
        bounds = candidates[first : last + 1]
        if len(bounds) <= _MOST + 1:
            return bounds if len(bounds) > 1 else [bounds[0], 10 * bounds[0]]
    return bounds


def shades(count: int) -> list[str]:
    """Fills from light to dark."""
    fills = []
    for k in range(count):
        share = k / max(count - 1, 1)
        parts = [round(a + share * (b - a)) for a, b in zip(_LIGHT, _DARK, strict=True)]
        fills.append("#" + "".join(f"{part:02x}" for part in parts))
    return fills


# ---- on a grid ----


def bands(
    axes: Axes, xs: Sequence[float], ys: Sequence[float], table: Any, bounds: Sequence[float]
) -> None:
    """Shade the bands between the levels `bounds`, with a thin line at every level.

    Between grid points, the logarithm of the value is interpolated bilinearly.
    """
    from contourpy import FillType, LineType, contour_generator

    maker = contour_generator(
        xs, ys, table, fill_type=FillType.OuterOffset, line_type=LineType.Separate, corner_mask=True
    )
    marks = [math.log10(v) for v in bounds]
    for low, high, paint in zip(marks[:-1], marks[1:], shades(len(marks) - 1), strict=True):
        filled: Any = maker.filled(low, high)
        for points, starts in zip(*filled, strict=True):
            rings = [points[a:b] for a, b in pairwise(starts)]
            paper = [[(axes.x(float(x)), axes.y(float(y))) for x, y in ring] for ring in rings]
            axes.ink.path(paper, stroke=paint, pen=0.05, fill=paint, closed=True)
    for mark in marks[1:-1]:
        traced: Any = maker.lines(mark)
        lines = [[(axes.x(float(x)), axes.y(float(y))) for x, y in line] for line in traced]
        axes.ink.path(lines, stroke=WHITE, pen=0.12)


def scale(ink: Ink, box: tuple[float, float, float, float], bounds: Sequence[float]) -> None:
    """Draw the scale of the bands right of the frame, with the levels between them."""
    x, count = box[0] + box[2] + 2.5, len(bounds) - 1
    high = min(box[3] / count, 6.0)
    top = box[1] + box[3] - high * count
    for k, paint in enumerate(shades(count)[::-1]):
        ink.box(x, top + k * high, 3.0, high, fill=paint, pen=0.1)
    for k, level in enumerate(reversed(bounds)):
        ink.text(x + 4.2, top + k * high, _level(level), size=6.0)


def _level(value: float) -> str:
    return number(value, 1) if value < 1 else trimmed(value)


# ---- over a mesh ----


def corner_values(nodes: np.ndarray, triangles: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Values at the corners: area-weighted means of the values of the adjacent triangles.

    Parameters
    ----------
    nodes : coordinates (x, y) of the corners
    triangles : numbers of the three corners of each triangle; different bodies share no corner
    values : values of the triangles
    """
    a, b, c = (nodes[triangles[:, k]] for k in range(3))
    area = np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    total, weight = np.zeros(len(nodes)), np.zeros(len(nodes))
    for k in range(3):
        np.add.at(total, triangles[:, k], area * values)
        np.add.at(weight, triangles[:, k], area)
    return np.asarray(total / weight)


def mesh_outlines(
    nodes: np.ndarray, triangles: np.ndarray, body: np.ndarray
) -> list[list[list[Point]]]:
    """Outlines of every body, in mesh coordinates; `body` has the number of each triangle's body.

    Holes have the opposite orientation.
    """
    places = [(float(x), float(y)) for x, y in nodes]
    bodies = []
    for number_of in range(int(body.max()) + 1):
        rings = _rings([int(k) for k in corners] for corners in triangles[body == number_of])
        bodies.append([[places[k] for k in ring] for ring in rings])
    return bodies


def mesh_bands(
    nodes: np.ndarray, triangles: np.ndarray, values: np.ndarray, levels: Sequence[float]
) -> list[list[list[Point]]]:
    """Outlines of the band between each two neighbouring levels, in the form of `mesh_outlines`.

    Between the corners, values are interpolated linearly.

    Parameters
    ----------
    nodes, triangles : see `corner_values`
    values : values at the corners
    levels : levels in ascending order; the lowest and the highest enclose all values
    """
    aside = 1e-9 * (levels[-1] - levels[0])
    for level in levels:  # a corner exactly on a level would give two points at the same place
        nudged = level + (aside if level < levels[-1] else -aside)
        values = np.where(np.abs(values - level) < aside, nudged, values)
    corners = triangles.tolist()
    banded = []
    for low, high in pairwise(range(len(levels))):
        pieces = [_between(triangle, values, levels, low, high) for triangle in corners]
        rings = _rings(piece for piece in pieces if piece)
        banded.append([[_place(key, nodes, values, levels) for key in ring] for ring in rings])
    return banded


def _between(
    corners: Sequence[int], values: np.ndarray, levels: Sequence[float], low: int, high: int
) -> list[Key]:
    """The part of a triangle between two levels, as keys of its corners in order."""
    at_corners = [float(values[k]) for k in corners]
    if max(at_corners) <= levels[low] or min(at_corners) >= levels[high]:
        return []
    keys: list[Key] = []
    for (i, start), (j, end) in zip(
        zip(corners, at_corners, strict=True),
        zip([*corners[1:], corners[0]], [*at_corners[1:], at_corners[0]], strict=True),
        strict=True,
    ):
        if levels[low] < start < levels[high]:
            keys.append((i, i, 0))
        first, last = min(i, j), max(i, j)
        for level in (low, high) if end > start else (high, low):
            if (start - levels[level]) * (end - levels[level]) < 0:
                keys.append((first, last, level))
    return keys


def _place(key: Key, nodes: np.ndarray, values: np.ndarray, levels: Sequence[float]) -> Point:
    i, j, level = key
    if i == j:
        return float(nodes[i, 0]), float(nodes[i, 1])
    share = (levels[level] - values[i]) / (values[j] - values[i])
    x, y = nodes[i] + share * (nodes[j] - nodes[i])
    return float(x), float(y)


def _rings(polygons: Iterable[Sequence[Name]]) -> list[list[Name]]:
    """Outlines of the area that polygons of equal orientation cover together.

    An edge that two polygons share is not part of an outline.
    """
    edges: dict[tuple[Name, Name], bool] = {}
    for polygon in polygons:
        for start, end in zip(polygon, [*polygon[1:], polygon[0]], strict=True):
            if (end, start) in edges:
                del edges[end, start]
            else:
                edges[start, end] = True
    successors: dict[Name, list[Name]] = {}
    for start, end in edges:
        successors.setdefault(start, []).append(end)
    outlines = []
    while successors:
        first = next(iter(successors))
        ring, corner = [], first
        while True:
            ring.append(corner)
            targets = successors[corner]
            corner = targets.pop()
            if not targets:
                del successors[ring[-1]]
            if corner == first:
                break
        outlines.append(ring)
    return outlines
