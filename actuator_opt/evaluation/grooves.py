"""Grooves of piston and head: one for every seal element, wiper and guide."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

from ..base.numeric import Array, maximum
from ..design.model import Design
from ..design.seals import Seal, SealElement
from ..models import gland
from .values import Values


class Piece(NamedTuple):
    """A ring in a groove: material, free section [m^2], depth of its centre under the face [m]."""

    material: str
    area: Array
    depth: Array


@dataclass(frozen=True, slots=True)
class Groove:
    """A radial groove: owner, free section, gland depth at nominal squeeze, width, count."""

    place: str
    path: str
    role: Literal["element", "wiper", "guide"]
    material: str
    section: Array
    gland_depth: Array
    width: Array
    ring_width: Array
    count: Array
    pieces: tuple[Piece, ...]


def _element(v: Values, place: str, path: str, element: SealElement) -> Groove:
    sizes = {key: v[path + key] for key in ("section", "squeeze", *element.seal_type.needed)}
    own = element.seal_type.groove(sizes)
    default = own.width
    pieces = [Piece(element.compound, piece.area, piece.depth) for piece in own.pieces]
    if element.back_ups:
        assert element.back_up_material is not None
        thickness = v[f"{path}back_up_thickness"]
        default = gland.back_up_groove_width(
            groove_width=default, thickness=thickness, count=element.back_ups
        )
        area = element.back_ups * thickness * own.depth
        pieces.append(Piece(element.back_up_material, area, own.depth / 2))
    return Groove(
        place=place,
        path=path,
        role="element",
        material=element.compound,
        section=sizes["section"],
        gland_depth=own.depth,
        width=v.get(f"{path}groove_width", default),
        ring_width=own.ring_width,
        count=v[f"{path}count"],
        pieces=tuple(pieces),
    )


def grooves(v: Values, design: Design, name: Literal["piston", "rod"]) -> tuple[Groove, ...]:
    """All grooves of a place, from the pressure side outwards: guide, elements, wiper."""
    seal: Seal = getattr(design.seals, name)
    at = f"seals.{name}."
    found = []
    if seal.guide is not None:
        path = f"{at}guide."
        depth = v[f"{path}thickness"]
        found.append(
            Groove(
                place=f"{name} guide",
                path=path,
                role="guide",
                material=seal.guide.material,
                section=depth,
                gland_depth=depth,
                width=v[f"{path}width"],
                ring_width=v[f"{path}width"],
                count=v[f"{path}count"],
                pieces=(Piece(seal.guide.material, depth * v[f"{path}width"], depth / 2),),
            )
        )
    found.append(_element(v, f"{name} seal", at, seal))
    if seal.secondary is not None:
        found.append(_element(v, f"{name} secondary seal", f"{at}secondary.", seal.secondary))
    if seal.wiper is not None:
        path = f"{at}wiper."
        section, width = v[f"{path}section"], v[f"{path}groove_width"]
        depth = gland.gland_depth(squeeze=v[f"{path}squeeze"], section=section)
        found.append(
            Groove(
                place=f"{name} wiper",
                path=path,
                role="wiper",
                material=seal.wiper.compound,
                section=section,
                gland_depth=depth,
                width=width,
                ring_width=width,
                count=1.0,
                pieces=(Piece(seal.wiper.compound, section * width, depth / 2),),
            )
        )
    return tuple(found)


def taken(grooves: Sequence[Groove]) -> tuple[Array, Array, Array]:
    """Total axial length of all grooves, their number, and the largest depth."""
    length: Array = 0.0
    count: Array = 0.0
    deepest: Array = 0.0
    for groove in grooves:
        length = length + groove.count * groove.width
        count = count + groove.count
        deepest = maximum(deepest, groove.gland_depth)
    return length, count, deepest
