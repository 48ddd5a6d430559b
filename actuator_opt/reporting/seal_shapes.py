"""Cross-sections of sealing rings as polygons, in their groove, mounted without pressure.

x runs from the sealed side of the groove, r from the counterface into the groove; m. A round ring
keeps its section: squeezed, it is a rectangle between two half circles.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from ..design.seals import Guide, SealElement, Wiper
from ..evaluation.rings import FACE, face
from ..models.lip_seal import lip_interference
from .ink import Polygon

Kind = Literal["elastomer", "polymer", "back-up", "free"]
_CORNERS = 24


@dataclass(frozen=True, slots=True)
class Shape:
    """A closed polygon of one kind; `free` is the outline before mounting."""

    kind: Kind
    points: Polygon


def element_shapes(element: SealElement, *, depth: float, width: float) -> tuple[Shape, ...]:
    """What lies in a groove `depth` deep and `width` wide, back-up rings included."""
    back = element.back_up_thickness or 0.0
    start = back if element.back_up == "both" else 0.0
    end = width - (back if element.back_ups else 0.0)
    middle = (start + end) / 2
    rings: tuple[Shape, ...] = ()
    if element.back_ups:
        rings += (Shape("back-up", _box(end, width, 0.0, depth)),)
    if element.back_up == "both":
        rings += (Shape("back-up", _box(0.0, back, 0.0, depth)),)
    if element.type == "o_ring":
        return (*rings, *_round(middle, 0.0, depth, element.section))
    if element.type == "step_ring":
        return (*rings, *_step_ring(element, middle, depth))
    if element.type == "u_cup":
        return (*rings, *_u_cup(element, start, end, depth))
    return (*rings, *_compact(element, middle, depth))


def wiper_shapes(wiper: Wiper, *, depth: float, width: float) -> tuple[Shape, ...]:
    """A wiper: its body on the inner side, its lip towards the outer side."""
    give = max(wiper.section - depth, 0.0) / 2
    tip = min(wiper.width, 0.9 * width)
    root, thick = width - tip, min(wiper.thickness, 0.8 * depth)
    body = (
        (0.0, give),
        (root, give),
        (width, 0.0),
        (width, 0.6 * thick),
        (root, give + thick),
        (root, depth),
        (0.0, depth),
    )
    free = ((root, give), (width, -give), (width, 0.6 * thick - give), (root, give + thick))
    return Shape("elastomer", body), Shape("free", free)


def guide_shapes(guide: Guide) -> tuple[Shape, ...]:
    """A guide ring fills its groove."""
    return (Shape("polymer", _box(0.0, guide.width, 0.0, guide.thickness)),)


def _box(left: float, right: float, low: float, high: float) -> Polygon:
    return ((left, low), (right, low), (right, high), (left, high))


def stadium(middle: float, low: float, high: float, section: float) -> Polygon:
    """Outline of a round section pressed to the height high - low; a circle where it is not.

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


def _round(middle: float, low: float, high: float, section: float) -> tuple[Shape, ...]:
    free = stadium(middle, high - section, high, section)
    return Shape("elastomer", stadium(middle, low, high, section)), Shape("free", free)


def _face(element: SealElement, depth: float) -> dict[str, float]:
    """The face as it is computed."""
    stated = {name: value for name in FACE if (value := getattr(element, name)) is not None}
    width = element.width or 0.0
    return face(element.type, stated, width=width, section=element.section, gland_depth=depth)


def _step_ring(element: SealElement, middle: float, depth: float) -> tuple[Shape, ...]:
    """The sliding ring with its land between two tapers, and the energiser behind it."""
    width, thick = element.width or 0.0, element.thickness or 0.0
    own = _face(element, depth)
    land = min(own["land"], width)
    relief = min(own["relief"], width - land)
    left = middle - width / 2
    slope = min(math.tan(own["taper"]), 0.5 * thick / max(width - land, 1e-9))
    body = (
        (left, relief * slope),
        (left + relief, 0.0),
        (left + relief + land, 0.0),
        (left + width, (width - land - relief) * slope),
        (left + width, thick),
        (left, thick),
    )
    return Shape("polymer", body), *_round(middle, thick, depth, element.section)


def _u_cup(element: SealElement, start: float, end: float, depth: float) -> tuple[Shape, ...]:
    """Two lips open to the sealed side; the heel behind them fills the groove up to its play."""
    length, thick = element.width or 0.0, min(element.thickness or 0.0, 0.42 * depth)
    give = max(float(lip_interference(section=element.section, gland_depth=depth)), 0.0)
    own = _face(element, depth)
    root_gap = max(own["root_clearance"], 0.0)
    heel = max((end - start - length) * 0.8, 0.15 * length)
    right = min(start + (end - start + length + heel) / 2, end)
    root = right - heel
    tip, land = root - length, own["land"]
    thin = 0.7 * thick
    body = (
        (right, root_gap),
        (root, root_gap),
        (tip + land, 0.0),
        (tip, 0.0),
        (tip, thin),
        (root - 0.3 * thick, root_gap + thick),
        (root - 0.3 * thick, depth - thick),
        (tip, depth - thin),
        (tip, depth),
        (right, depth),
    )
    free = ((root, root_gap), (tip + land, -give), (tip, -give), (tip, thin - give))
    return Shape("elastomer", body), Shape("free", (*free, (root - 0.3 * thick, root_gap + thick)))


def _compact(element: SealElement, middle: float, depth: float) -> tuple[Shape, ...]:
    """A block whose face is the land, flanked where the body is wider."""
    width = element.width or 0.0
    land = min(_face(element, depth)["land"], width)
    a, b = middle - width / 2, middle + width / 2
    c, d = middle - land / 2, middle + land / 2
    flank = min((width - land) / 2, depth / 2)
    body = ((c, 0.0), (d, 0.0), (b, flank), (b, depth), (a, depth), (a, flank))
    free = _box(c, d, depth - element.section, depth)
    return Shape("elastomer", body), Shape("free", free)
