"""A compact seal: a rubber block between two guides, which seals in both directions."""

from __future__ import annotations

from collections.abc import Mapping

from ..base.numeric import Array
from ..models import compact_seal, gland
from .contact import LAND, WIDTH, SealContact, Shape, SizeField, box, landed
from .seal_type import (
    AXIAL_PLAY,
    Room,
    SealGroove,
    SealPart,
    SealSizes,
    SealType,
    no_faults,
    no_warnings,
)


def contact(seal: SealSizes) -> SealContact:
    """Contact of a squeezed rubber block, on its face, with the counterface."""
    load = compact_seal.line_load(
        squeeze=seal["squeeze_left"],
        face_width=seal["land"],
        youngs_modulus=seal["youngs_modulus"],
        poissons_ratio=seal["face_poissons_ratio"],
        pressure=seal["pressure"],
    )
    width = compact_seal.contact_width(
        squeeze=seal["squeeze_left"], face_width=seal["land"], groove_width=seal["groove_width"]
    )
    return landed(load, width, seal["pressure"])


def groove(sizes: Mapping[str, Array]) -> SealGroove:
    """Groove for a block with the seal's section before mounting."""
    section, width = sizes["section"], sizes["width"]
    depth = gland.gland_depth(squeeze=sizes["squeeze"], section=section)
    return SealGroove(depth, width, AXIAL_PLAY * width, (SealPart(section * width, depth / 2),))


def outline(sizes: Mapping[str, float], room: Room) -> tuple[Shape, ...]:
    """Outline of a block whose face has the width `land`; a wider body tapers towards the face."""
    width, depth, middle = sizes["width"], room.depth, room.middle
    land = min(sizes["land"], width)
    a, b = middle - width / 2, middle + width / 2
    c, d = middle - land / 2, middle + land / 2
    flank = min((width - land) / 2, depth / 2)
    body = ((c, 0.0), (d, 0.0), (b, flank), (b, depth), (a, depth), (a, flank))
    free = box(c, d, depth - sizes["section"], depth)
    return Shape("elastomer", body), Shape("free", free)


TYPE = SealType(
    name="compact",
    title="compact seal",
    help="a rubber body between two guides, which seals in both directions",
    fields=(SizeField(WIDTH, None), SizeField(LAND, lambda sizes: 1.0 * sizes["width"])),
    faults=no_faults,
    groove=groove,
    contact=contact,
    outline=outline,
    round_ring=False,
    modulus_by="stated",
    face=True,
    o_ring_gland=False,
    model=compact_seal.line_load,
    contact_model="block in plane strain",
    warnings=no_warnings,
    elements=None,
)
