"""What lies in a groove, as polygons: seal and back-up rings, wiper or guide.

x runs from the sealed side of the groove, r from the counterface into the groove; m.
"""

from __future__ import annotations

from ..design.seals import Guide, SealElement, Wiper
from ..seals.outline import Shape, box
from ..seals.seal_type import Room


def element_shapes(element: SealElement, *, depth: float, width: float) -> tuple[Shape, ...]:
    """What lies in a groove `depth` deep and `width` wide, back-up rings included."""
    back = element.back_up_thickness or 0.0
    start = back if element.back_up == "both" else 0.0
    end = width - (back if element.back_ups else 0.0)
    backs: tuple[Shape, ...] = ()
    if element.back_ups:
        backs += (Shape("back-up", box(end, width, 0.0, depth)),)
    if element.back_up == "both":
        backs += (Shape("back-up", box(0.0, back, 0.0, depth)),)
    own = {"section": element.section, "gland_depth": depth}
    own |= element.seal_type.sizes(element.stated_sizes(), **own)
    return (*backs, *element.seal_type.outline(own, Room(start, end, depth)))


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
    return (Shape("polymer", box(0.0, guide.width, 0.0, guide.thickness)),)
