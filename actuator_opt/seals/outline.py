"""Outlines of seals as polygons, mounted in their groove without pressure.

x runs from the sealed side of the groove, r from the counterface into the groove; m. A round ring
keeps its section area: squeezed, it is a rectangle between two half circles.
"""

from __future__ import annotations

import math
from typing import Literal, NamedTuple, TypeAlias

Polygon: TypeAlias = tuple[tuple[float, float], ...]
_CORNERS = 24


class Shape(NamedTuple):
    """A named closed polygon; `free` is the outline before mounting."""

    kind: Literal["elastomer", "polymer", "back-up", "free"]
    points: Polygon


def box(left: float, right: float, low: float, high: float) -> Polygon:
    """A rectangle."""
    return ((left, low), (right, low), (right, high), (left, high))


def stadium(middle: float, low: float, high: float, section: float) -> Polygon:
    """Outline of a round section compressed to the height high - low; a circle if uncompressed.

    >>> points = stadium(0.0, 0.0, 0.8, 1.0)
    >>> f"{max(x for x, _ in points) - min(x for x, _ in points):.4f}"
    '1.1534'
    """
    height = min(high - low, section)
    flat = math.pi / 4 * (section**2 - height**2) / height
    centre, radius = high - height / 2, height / 2
    points = []
    for k in range(2 * _CORNERS + 2):
        end = 1.0 if k <= _CORNERS else -1.0
        angle = math.pi * ((k if k <= _CORNERS else k - 1) / _CORNERS - 0.5)
        x = middle + end * flat / 2 + radius * math.cos(angle)
        points.append((x, centre + radius * math.sin(angle)))
    return tuple(points)


def round_ring(middle: float, low: float, high: float, section: float) -> tuple[Shape, ...]:
    """A round ring between two heights, mounted and free."""
    free = stadium(middle, high - section, high, section)
    return Shape("elastomer", stadium(middle, low, high, section)), Shape("free", free)
