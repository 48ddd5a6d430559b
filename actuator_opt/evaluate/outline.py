"""Half-sections of every part, retracted, for the drawing; their volumes equal the mass model's."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, pi, sin

from ..design.material import Material
from ..design.model import Design
from .evaluation import Outline
from .geometry import Geometry, Groove


def _rectangle(x0: float, x1: float, r0: float, r1: float) -> tuple[tuple[float, float], ...]:
    return ((x0, r0), (x1, r0), (x1, r1), (x0, r1))


def _grooves(start: float, length: float, groove: Groove) -> Iterator[tuple[float, float]]:
    """Axial intervals of the grooves, evenly spread over a part."""
    count = round(float(groove.count))
    width = float(groove.width)
    land = (length - count * width) / (count + 1)
    for i in range(count):
        x = start + land + i * (land + width)
        yield x, x + width


def _grooved(
    x0: float, x1: float, inner: float, outer: float, groove: Groove, floor: float, *, outside: bool
) -> tuple[tuple[float, float], ...]:
    """A ring with rectangular grooves cut to radius `floor` from outside or from inside."""
    surface = outer if outside else inner
    edge = [(x0, surface)]
    for start, end in _grooves(x0, x1 - x0, groove):
        edge += [(start, surface), (start, floor), (end, floor), (end, surface)]
    edge.append((x1, surface))
    other = inner if outside else outer
    return (*edge, (x1, other), (x0, other))


def _eye(centre: float, pin: float, side: int) -> list[tuple[tuple[float, float], ...]]:
    """Half of an eye seen from the side: lug of radius `pin` around the pin hole, and its neck."""
    angles = [pi * k / 24 for k in range(25)]
    rim = [(centre + pin * cos(a), pin * sin(a)) for a in angles]
    hole = [(centre + pin / 2 * cos(a), pin / 2 * sin(a)) for a in reversed(angles)]
    foot = 0.75**0.5 * pin  # where a neck of this diameter meets the rim
    neck = sorted((centre + side * foot, centre + side * 2 * pin))
    return [(*rim, *hole), _rectangle(neck[0], neck[1], 0.0, pin / 2)]


def _kind(material: Material) -> str:
    return {"ply": "composite", "polymer": "polymer", "seal": "seal"}.get(material.kind, "metal")


def outlines(design: Design, materials: dict[str, Material], g: Geometry) -> tuple[Outline, ...]:
    """Every part as closed polygons of (axial position from the cap pin, radius) in m."""
    parts: list[tuple[str, str, list[tuple[tuple[float, float], ...]]]] = []
    face = float(g.eye_offset)
    start = face + float(g.plate)
    end = start + float(g.barrel_length)
    head = end - float(g.head_length)
    tip = end + float(g.plate) + float(g.rod_extension)
    piston_end = start + float(g.piston_length)
    rod, bore = float(g.rod_diameter) / 2, float(g.inner_radius)
    hole = rod + float(g.head_clearance)
    skirt, outer, plate = float(g.skirt_length), float(g.outer_radius), float(g.plate_radius)

    radius = bore
    for i, (ply, thickness) in enumerate(zip(design.barrel.layup, g.thicknesses, strict=True)):
        next_radius = radius + float(thickness)
        parts.append((f"layup[{i}]", ply.material, [_rectangle(start, end, radius, next_radius)]))
        radius = next_radius
    caps = [
        _rectangle(face, start, 0.0, plate),
        _rectangle(end, end + float(g.plate), hole, plate),
    ]
    if skirt > 0:
        caps += [
            _rectangle(start, start + skirt, outer, outer + float(g.skirt_wall)),
            _rectangle(end - skirt, end, outer, outer + float(g.skirt_wall)),
        ]
    parts.append(("caps", design.caps.material, caps))
    piston_radius = bore - float(g.piston_clearance)
    piston_floor = bore - float(g.piston_groove.gland_depth)
    parts.append(
        (
            "piston",
            design.piston.material,
            [
                _grooved(
                    start,
                    piston_end,
                    0.0,
                    piston_radius,
                    g.piston_groove,
                    piston_floor,
                    outside=True,
                )
            ],
        )
    )
    head_floor = rod + float(g.rod_groove.gland_depth)
    parts.append(
        (
            "glands",
            design.head.material,
            [_grooved(head, end, hole, bore, g.rod_groove, head_floor, outside=False)],
        )
    )
    parts.append(
        (
            "rod",
            design.rod.material,
            [_rectangle(piston_end, tip, float(g.rod_inner_diameter) / 2, rod)],
        )
    )
    for name, compound, groove, x0, length, low, high in (
        (
            "piston seal",
            design.seals.piston.compound,
            g.piston_groove,
            start,
            g.piston_length,
            piston_floor,
            bore,
        ),
        ("rod seal", design.seals.rod.compound, g.rod_groove, head, g.head_length, rod, head_floor),
    ):
        rings = []
        for left, right in _grooves(x0, float(length), groove):
            middle, half = (left + right) / 2, min(float(groove.section), right - left) / 2
            rings.append(_rectangle(middle - half, middle + half, low, high))
        parts.append((name, compound, rings))
    if design.clevis is not None:
        pin = float(g.pin_diameter)
        parts.append(("cap eye", design.clevis.material, _eye(0.0, pin, 1)))
        parts.append(("rod eye", design.clevis.material, _eye(tip + float(g.eye_offset), pin, -1)))
    oil = Outline("oil", design.fluid.material, (_rectangle(piston_end, head, rod, bore),), "oil")
    return (
        oil,
        *(
            Outline(part, name, tuple(polygons), _kind(materials[name]))  # type: ignore[arg-type]
            for part, name, polygons in parts
            if polygons
        ),
    )


def lengths(design: Design, g: Geometry) -> dict[str, float]:
    """Dimensions shown on the drawing, m."""
    values = {
        "bore": g.bore,
        "rod": g.rod_diameter,
        "rod_inner": g.rod_inner_diameter,
        "barrel_outer_diameter": 2 * g.outer_radius,
        "plate_outer": 2 * g.plate_radius,
        "stroke": g.stroke,
        "piston_length": g.piston_length,
        "head_length": g.head_length,
        "barrel_length": g.barrel_length,
        "plate": g.plate,
        "closed_length": g.closed_length,
        "pin_cap": 0.0,
        "pin_rod": g.closed_length,
        "eye_offset": g.eye_offset,
        "pin": g.pin_diameter,
        "extension": g.rod_extension,
    }
    return {name: float(value) for name, value in values.items()}
