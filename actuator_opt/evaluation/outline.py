"""Half-sections of all parts of the retracted actuator, for the drawing.

The volumes of the sections equal those of the mass model.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import cos, pi, sin
from typing import Literal, TypeAlias

from ..base.dataclass import dataclass
from ..base.numeric import maximum
from ..design import assembly
from ..design.material import Material
from ..design.model import Design
from ..joints.joint import (
    LEAST_METAL,
    LINE,
    DrawnPart,
    EndDimensions,
    EndSpan,
    EnteringRing,
    Polygon,
    rectangle,
    ring_height,
)
from ..models.piston_nut import FLATS
from .geometry import (
    Geometry,
    Groove,
    RetentionNumbers,
    RodThrough,
    bearing_of,
    end_at,
    end_of,
    entering_rings,
    groove_totals,
    joints_of,
)
from .piston_nut import recess
from .ports import ENDS, boss_axis, cushioned, gallery, places, rim_bosses, seat_radius
from .result import Outline
from .rods import end_material, material_of

_Part: TypeAlias = tuple[str, str, list[Polygon], int, bool]
"""Name of a part, material, polygons, number of round bars (0 for a turned part), and whether these
are radial."""

PORTS, BOSSES = "ports", "port bosses"
"""Parts of the ports: each is one radial bar, so it is only above the axis."""

_Kind: TypeAlias = Literal["metal", "composite", "polymer", "seal", "oil"]


def _grooves(
    start: float, length: float, grooves: Sequence[Groove]
) -> Iterator[tuple[Groove, float, float]]:
    """Yield the grooves of a part with their axial start and end, evenly spaced over its length."""
    used, count, _ = groove_totals(grooves)
    land = (length - float(used)) / (round(float(count)) + 1)
    x = start + land
    for groove in grooves:
        for _ in range(round(float(groove.count))):
            yield groove, x, x + float(groove.width)
            x += float(groove.width) + land


def _grooved(
    x0: float,
    x1: float,
    inner: float,
    outer: float,
    grooves: Sequence[Groove],
    counterface: float,
    *,
    outside: bool,
) -> Polygon:
    """A ring with rectangular grooves cut from outside or inside.

    The gland depth is measured from the counterface, the bore or rod on which the seal slides.
    """
    surface, other = (outer, inner) if outside else (inner, outer)
    edge = _edge(x0, x1, surface, grooves, counterface, outside=outside)
    return (*edge, (x1, other), (x0, other))


def _edge(
    x0: float,
    x1: float,
    surface: float,
    grooves: Sequence[Groove],
    counterface: float,
    *,
    outside: bool,
) -> list[tuple[float, float]]:
    """Edge of a ring from `x0` to `x1`, at radius `surface`, with its grooves."""
    edge = [(x0, surface)]
    for groove, start, end in _grooves(x0, x1 - x0, grooves):
        depth = float(groove.gland_depth)
        floor = counterface - depth if outside else counterface + depth
        edge += [(start, surface), (start, floor), (end, floor), (end, surface)]
    return [*edge, (x1, surface)]


def _half_ring(centre: float, inner: float, outer: float) -> Polygon:
    """Half of a ring in side view."""
    turns = [(cos(pi * k / 24), sin(pi * k / 24) if 0 < k < 24 else 0.0) for k in range(25)]
    rim = [(centre + outer * x, outer * y) for x, y in turns]
    hole = [(centre + inner * x, inner * y) for x, y in reversed(turns)]
    return (*rim, *hole)


def _eye(centre: float, pin: float, radius: float, hole: float, side: int) -> list[Polygon]:
    """Half of an eye in side view: a lug around its hole, and a neck as wide as the pin."""
    foot = (radius**2 - pin**2 / 4) ** 0.5  # intersection of the neck with the rim
    neck = sorted((centre + side * foot, centre + side * (radius + pin)))
    lug = _half_ring(centre, hole / 2, radius)
    return [lug, rectangle(neck[0], neck[1], 0.0, pin / 2)]


def _kind(part: str, material: Material | None) -> _Kind:
    if material is None:
        return "oil" if part == PORTS else "metal"
    kinds: dict[str, _Kind] = {"ply": "composite", "polymer": "polymer", "seal": "seal"}
    return kinds.get(material.kind, "metal")


@dataclass(frozen=True, slots=True)
class _Stations:
    """Axial positions of faces and ends, measured from the cap pin, and radii.

    `plate` is the inner face of the cap's plate, `start` and `head` are the ends of the chamber.
    """

    face: float
    plate: float
    start: float
    end: float
    head: float
    tip: float
    piston_end: float
    rod: float
    bore: float
    hole: float

    def gland(self, g: Geometry, rod: RodThrough) -> tuple[float, float]:
        """Start and end of the gland around a rod."""
        length = float(g.head_length)
        if rod.end == "head":
            return self.end - length, self.end
        return self.plate, self.plate + length


def _stations(g: Geometry) -> _Stations:
    face = float(g.cap_face)
    plate = face + float(g.plate)
    start = plate + float(g.spigot) + float(g.cap_bush)
    end = start + float(g.barrel_length) + float(g.head_bush)
    rod, bore = float(g.rod_diameter) / 2, float(g.inner_radius)
    return _Stations(
        face=face,
        plate=plate,
        start=start,
        end=end,
        head=end - float(g.head_length) - float(g.head_bush),
        tip=end + float(g.plate) + float(g.rod_extension),
        piston_end=start + float(g.piston_length),
        rod=rod,
        bore=bore,
        hole=rod + float(g.head_clearance),
    )


def _barrel(design: Design, g: Geometry, at: _Stations) -> Iterator[_Part]:
    radius = at.bore
    start, end = at.plate - float(g.cap_fit.beyond), at.end + float(g.head_fit.beyond)
    sides = (g.cap_fit, start, at.plate, 1), (g.head_fit, end, at.end, -1)
    last = len(g.thicknesses) - 1
    for i, (ply, thickness) in enumerate(zip(design.barrel.layup, g.thicknesses, strict=True)):
        outer = radius + float(thickness)
        limit = min(outer, float(g.outer_radius)) if i == last else 0.0
        edges = []
        for r, bore, turned in ((radius, i == 0, 0.0), (outer, False, limit)):
            cap, head = (
                _edge_points(*side, r, liner=i == 0, bore=bore, turned=turned) for side in sides
            )
            edges.append([*cap, *reversed(head)])
        yield f"layup[{i}]", ply.material, [(*edges[0], *reversed(edges[1]))], 0, False
        radius = outer


def _edge_points(
    fit: EndDimensions,
    end: float,
    face: float,
    inwards: int,
    radius: float,
    *,
    liner: bool,
    bore: bool,
    turned: float,
) -> Polygon:
    """Points of a layer's edge at one end of the barrel, from there inwards.

    `end` is the axial position of the end, and `face` that of the inner face of the plate. `liner`
    is whether the layer is the innermost. The edge is the `bore` with the groove outside the
    chamber, or the outside, turned down to a skirt with a radius below `turned`. On a sleeve, which
    has groove and skirt itself, the winding is lifted, and a liner ends at the tip.
    """
    if fit.sleeve is not None:
        bare, inner, ramp, lift = (float(size) for size in fit.sleeve[:4])
        tip = (end + inwards * (bare + inner), radius)
        if liner and fit.sleeve.liner:
            return (tip,)
        lifted = radius + lift
        return (end + inwards * bare, lifted), (tip[0] - inwards * ramp, lifted), tip
    if liner:
        end = end + inwards * float(fit.short)
    if bore and fit.groove:
        near, width, depth = (float(size) for size in fit.groove)
        far, near, floor = face - inwards * (near + width), face - inwards * near, radius + depth
        return (end, radius), (far, radius), (far, floor), (near, floor), (near, radius)
    low, step = float(fit.radius), end + inwards * float(fit.length)
    if float(fit.length) > 0 and low < turned:
        return (end, low), (step, low), (step, radius)
    return ((end, radius),)


def _ends(design: Design, g: Geometry, at: _Stations) -> Iterator[_Part]:
    """Cap and head plate with the shapes that their joint adds, and separate parts of the joint."""
    plate = float(g.plate)
    rims = [place == "rim" for place in g.static_places]
    hole = float(g.rods[1].diameter / 2 + g.head_clearance) if design.double_rod else 0.0
    caps = [
        _plate(g, (at.face, at.plate), hole, g.cap_fit, rims[0]),
        _plate(g, (at.end, at.end + plate), at.hole, g.head_fit, rims[1]),
        *_spigot(g, at),
        *_cap_bush(g, at),
    ]
    others: dict[tuple[str, str, int, bool], list[Polygon]] = {}
    for piece in _joints(design, g, at):
        if piece.part == "caps":
            caps.append(piece.shape)
        elif piece.part != LINE:
            key = (piece.part, piece.material, piece.bars, piece.radial)
            others.setdefault(key, []).append(piece.shape)
    yield "caps", design.caps.material, caps, 0, False
    for (part, material, bars, radial), shapes in others.items():
        yield part, material, shapes, bars, radial


def _joints(design: Design, g: Geometry, at: _Stations) -> Iterator[DrawnPart]:
    """All parts of the joints at both ends."""
    face, back = at.face, at.end + float(g.plate)
    spans = {"cap": EndSpan(at.plate, 1, face, back), "head": EndSpan(at.end, -1, back, face)}
    fits = {"cap": g.cap_fit, "head": g.head_fit}
    for end_joint in joints_of(design):
        end = end_at(design, end_joint, RetentionNumbers(end_joint.section), g)
        for name in [end_joint.name] if end_joint.name else spans:
            yield from end_joint.joint.outline(end, fits[name], spans[name])


def _plate(
    g: Geometry, span: tuple[float, float], hole: float, fit: EndDimensions, sealed: bool
) -> Polygon:
    """An end plate, with the groove of its static seal if the plate is `sealed` on its rim."""
    radius = float(fit.plate_radius)
    if not sealed:
        return rectangle(*span, hole, radius)
    return _grooved(*span, hole, radius, g.static_grooves, radius, outside=True)


def _spigot(g: Geometry, at: _Stations) -> Iterator[Polygon]:
    """The spigot of the cap, with the groove of its static seal."""
    if g.static_places[0] == "bore" and len(g.rods) == 1:
        depth = float(g.static_grooves[0].gland_depth)
        inner = at.bore - depth - LEAST_METAL
        end = at.start - float(g.cap_bush)
        yield _grooved(at.plate, end, inner, at.bore, g.static_grooves, at.bore, outside=True)


def _cap_bush(g: Geometry, at: _Stations) -> Iterator[Polygon]:
    """The bush at the cap that the spear of a cushion enters."""
    if float(g.cap_bush) > 0:
        yield rectangle(at.start - float(g.cap_bush), at.start, float(g.cushion) / 2, at.bore)


def _cushion(design: Design, g: Geometry, at: _Stations) -> Iterator[_Part]:
    """Spear and collar of the cushions."""
    cap, head, radius = float(g.cap_bush), float(g.head_bush), float(g.cushion) / 2
    hole = 0.0 if design.sensor is None else _sensor_hole(design, g)
    shapes = [rectangle(at.start - cap, at.start, hole, radius)] if cap > 0 else []
    if head > 0:
        shapes.append(rectangle(at.piston_end, at.piston_end + head, at.rod, radius))
    yield "cushions", end_material(design), shapes, 0, False


def _inside(design: Design, g: Geometry, at: _Stations) -> Iterator[_Part]:
    """Piston, head plug, rod and seals."""
    radius = at.bore - float(g.piston_clearance)
    piston = _grooved(at.start, at.piston_end, 0.0, radius, g.piston_grooves, at.bore, outside=True)
    cap_place, head_place = g.static_places
    plugs, bush = [_plug(g, at, rod) for rod in g.rods], float(g.head_bush)
    if bush > 0:
        plugs.append(rectangle(at.head, at.head + bush, float(g.cushion) / 2, at.bore))
    if float(g.nut) > 0:
        height, corner = (float(size) for size in recess(g))
        hole = float(g.nut) / 2
        bottom = at.start + height
        edge = ((at.piston_end, hole), (bottom, hole), (bottom, corner), (at.start, corner))
        piston = (*piston[:-2], *edge)
    if design.sensor is not None:
        hole = _sensor_hole(design, g)
        piston = (*piston[:-2], (at.piston_end, hole), (at.start, hole))
    yield "piston", design.piston.material, [piston], 0, False
    yield "glands", design.head.material, plugs, 0, False
    yield from _cushion(design, g, at)
    yield from _rod(design, g, at)
    yield from _rings(at.start, float(g.piston_length), g.piston_grooves, at.bore, -1)
    for rod in g.rods:
        start, radius = at.gland(g, rod)[0], float(rod.diameter) / 2
        yield from _rings(start, float(g.head_length), _along(rod), radius, 1)
    beyond = at.end + float(g.plate)
    spans = {
        "cap": {"rim": (at.face, at.plate), "bore": (at.plate, at.start - float(g.cap_bush))}.get(
            cap_place
        ),
        "head": {"rim": (at.end, beyond), "bore": at.gland(g, g.rods[0])}.get(head_place),
    }
    shapes = [
        shape
        for span in spans.values()
        if span is not None
        for _, _, rings, *_ in _rings(span[0], span[1] - span[0], g.static_grooves, at.bore, -1)
        for shape in rings
    ]
    for groove in g.static_grooves:
        yield groove.place, groove.material, shapes, 0, False


def _along(rod: RodThrough) -> Sequence[Groove]:
    """Grooves of a gland in the direction of the axis; they are listed from the chamber outwards.

    The gland of a second rod is thus a mirror image of the head.
    """
    return rod.grooves if rod.end == "head" else rod.grooves[::-1]


def _plug(g: Geometry, at: _Stations, rod: RodThrough) -> Polygon:
    """The gland around a rod, with its grooves and that of its static seal."""
    start, end = at.gland(g, rod)
    sealed = g.static_place(rod.end) == "bore"
    outer = _edge(
        start,
        end,
        float(g.plug_radius_at(rod.end)),
        g.static_grooves if sealed else (),
        at.bore,
        outside=True,
    )
    radius = float(rod.diameter) / 2
    inner = _edge(start, end, radius + float(g.head_clearance), _along(rod), radius, outside=False)
    return (*inner, *reversed(outer))


def _sensor_hole(design: Design, g: Geometry) -> float:
    """Radius of the hole of the piston through which the sensor passes."""
    bore, fitting = float(g.rod_inner_diameter) / 2, design.rod.fitting
    return bore if fitting is None else max(bore - (fitting.wall or 0.0), 0.0)


def _rod(design: Design, g: Geometry, at: _Stations) -> Iterator[_Part]:
    """The rod: a bar or tube, or its layers with the fittings in both ends."""
    bore = float(g.rod_inner_diameter) / 2
    if not design.rod.layup:
        bars = [rectangle(at.piston_end, at.tip, bore, at.rod)]
        if float(g.nut) > 0:
            radius, height = float(g.nut) / 2, float(recess(g)[0])
            bars.append(rectangle(at.start, at.piston_end, 0.0, radius))
            nut = rectangle(at.start, at.start + height, radius, FLATS * radius)
            yield "piston nut", design.rod.material, [nut], 0, False
        yield "rod", design.rod.material, bars, 0, False
        for rod in g.rods[1:]:
            start, radius = at.start - float(rod.length), float(rod.diameter) / 2
            bar = rectangle(start, at.start, float(rod.inner_diameter) / 2, radius)
            yield rod.name, material_of(design, rod), [bar], 0, False
        return
    radius = bore
    for i, (ply, thickness) in enumerate(zip(design.rod.layup, g.rod_thicknesses, strict=True)):
        outer = radius + float(thickness)
        shape = rectangle(at.piston_end, at.tip, radius, outer)
        yield f"rod.layup[{i}]", ply.material, [shape], 0, False
        radius = outer
    fitting = design.rod.fitting
    if fitting is not None:
        hole = 0.0 if fitting.wall is None else max(bore - fitting.wall, 0.0)
        yield (
            "rod.fitting",
            end_material(design),
            [
                rectangle(at.piston_end, at.piston_end + fitting.length, hole, bore),
                rectangle(at.tip - fitting.length, at.tip, hole, bore),
            ],
            0,
            False,
        )


def _rings(
    start: float, length: float, grooves: Sequence[Groove], counterface: float, side: int
) -> Iterator[_Part]:
    """Rings in every groove, as rectangles: as wide as the ring, but no wider than the groove."""
    shapes: dict[tuple[str, str], list[Polygon]] = {}
    for groove, left, right in _grooves(start, length, grooves):
        middle, half = (left + right) / 2, min(float(groove.ring_width), right - left) / 2
        near, far = counterface, counterface + side * float(groove.gland_depth)
        shape = rectangle(middle - half, middle + half, min(near, far), max(near, far))
        shapes.setdefault((groove.place, groove.material), []).append(shape)
    for (place, material), polygons in shapes.items():
        yield place, material, polygons, 0, False


def _eyes(design: Design, g: Geometry, at: _Stations) -> Iterator[_Part]:
    if design.clevis is None:
        return
    pin, bearing, name = float(g.pin_diameter), bearing_of(design), design.clevis.material
    hole = pin if bearing is None else bearing.outer_diameter
    centres = {"cap": (0.0, 1), "rod": (at.tip + float(g.rod_stack + g.eye_offset), -1)}
    if design.double_rod:
        del centres["cap"]
    for end, (centre, side) in centres.items():
        shapes = _eye(centre, pin, float(g.eye_radius), hole, side)
        if end == "cap" and float(g.neck) > 0:
            shapes.append(rectangle(at.face - float(g.neck), at.face, 0.0, pin / 2))
        yield f"{end} eye", name, shapes, 0, False
    if bearing is not None:
        rings = [_half_ring(centre, pin / 2, hole / 2) for centre, _ in centres.values()]
        yield "eye bearings", f"{bearing.name.upper()}, ISO 12240-1", rings, 0, False


def _ports(design: Design, g: Geometry, at: _Stations) -> Iterator[_Part]:
    """The ports, above the axis: their threads and bores, and their bosses."""
    found = places(design, g)
    if found is None:
        return
    size, half, bore = found.size, found.size.diameter / 2, float(found.bore) / 2
    bushes = cushioned(design)
    plate = float(g.plate) / 2
    holes, bosses = [], []
    cap, head = float(g.cap_bush), float(g.head_bush)
    near = [float(boss_axis(design, g, name, found.bore)) for name in ENDS]
    ends = (
        (g.cap_fit, at.start - cap + near[0], at.plate - plate, at.start - cap),
        (g.head_fit, at.head + head - near[1], at.end + plate, at.head + head),
    )
    rims = rim_bosses(size, g)
    for name, (fit, above, middle, chamber), boss, rim, bush in zip(
        ENDS, ends, found.on_barrel, rims, bushes, strict=True
    ):
        drillings = gallery(g, name, bore=found.bore, bush=bush)
        axis, drilled, _ = (float(size) for size in drillings)
        middle = above if boss else middle
        base = float(seat_radius(g, fit) if boss else fit.plate_radius)
        top = base + (size.drilled if boss else float(rim))
        bottom = top - size.drilled
        holes.append(rectangle(middle - half, middle + half, bottom, top))
        if top > base:
            bosses += [
                rectangle(middle - size.boss / 2, middle - half, base, top),
                rectangle(middle + half, middle + size.boss / 2, base, top),
            ]
        end = axis
        if boss:
            end = float(g.cushion) / 2 if bush else at.bore
        if bottom > end:
            holes.append(rectangle(middle - bore, middle + bore, end, bottom))
        if not boss:
            start, stop = sorted((middle, chamber))
            holes.append(rectangle(start, stop, axis - drilled / 2, axis + drilled / 2))
    yield PORTS, f"{size.thread}, {size.standard}", holes, 1, True
    yield BOSSES, design.caps.material, bosses, 1, True


def _components(g: Geometry, at: _Stations) -> Iterator[_Part]:
    """Components between cap or rod and eye, as blocks as wide as the cap's plate and the rod.

    The additional neck is between cap and component, which so is outside a barrel around the neck.
    """
    cap, rod = float(g.cap_stack), float(g.rod_stack)
    blocks = []
    if cap > 0:
        start = float(g.eye_offset)
        blocks.append(rectangle(start, start + cap, 0.0, float(g.cap_fit.plate_radius)))
    if rod > 0:
        blocks.append(rectangle(at.tip, at.tip + rod, 0.0, at.rod))
    yield "components", "as stated", blocks, 0, False


def _sensor(design: Design, g: Geometry, at: _Stations) -> Iterator[_Part]:
    """The element of a position sensor, from the cap into the rod."""
    if design.sensor is not None:
        end = at.start + float(g.stroke) + design.sensor.dead_length
        shape = rectangle(at.plate, end, 0.0, design.sensor.diameter / 2)
        yield "sensor", design.sensor.type, [shape], 0, False


def _merged(parts: Iterable[_Part]) -> Iterator[_Part]:
    """Parts, where pieces of the same part form one part, such as a layer that a joint goes on."""
    merged: dict[tuple[str, str, int, bool], list[Polygon]] = {}
    for part, material, shapes, bars, radial in parts:
        merged.setdefault((part, material, bars, radial), []).extend(shapes)
    for (part, material, bars, radial), shapes in merged.items():
        yield part, material, shapes, bars, radial


def outlines(design: Design, materials: dict[str, Material], g: Geometry) -> tuple[Outline, ...]:
    """All parts as closed polygons of (axial position from the cap pin, radius) in m."""
    at = _stations(g)
    oil = Outline(
        "oil",
        design.fluid.material,
        (rectangle(at.piston_end, at.head, at.rod, at.bore),),
        "oil",
    )
    groups = (_barrel, _ends, _inside, _eyes, _sensor, _ports)
    drawn = [part for group in groups for part in group(design, g, at)]
    parts = _merged([*drawn, *_components(g, at)])
    return (
        oil,
        *(
            Outline(part, name, tuple(polygons), _kind(part, materials.get(name)), bars, radial)
            for part, name, polygons, bars, radial in parts
            if polygons
        ),
    )


def lines(design: Design, g: Geometry) -> tuple[Polygon, ...]:
    """Lines of the drawing that bound no part, such as the flanks of threads; points as above."""
    return tuple(x.shape for x in _joints(design, g, _stations(g)) if x.part == LINE)


def lengths(design: Design, g: Geometry) -> dict[str, float]:
    """Dimensions that the drawing states [m]."""
    bearing = bearing_of(design)
    values = {
        "bore": g.bore,
        "rod": g.rod_diameter,
        "rod_inner": g.rod_inner_diameter,
        "barrel_outer_diameter": 2 * g.outer_radius,
        "plate_outer": 2 * maximum(g.cap_fit.plate_radius, g.head_fit.plate_radius),
        "stroke": g.stroke,
        "piston_length": g.piston_length,
        "head_length": g.head_length,
        "barrel_length": g.barrel_length,
        "plate": g.plate,
        "spigot": g.spigot,
        "cap_bush": g.cap_bush,
        "head_bush": g.head_bush,
        "beyond_cap": g.cap_fit.beyond,
        "beyond_head": g.head_fit.beyond,
        "closed_length": g.closed_length,
        "pin_cap": 0.0,
        "pin_rod": g.closed_length,
        "eye_offset": g.eye_offset,
        "face": g.cap_face,
        "neck": g.neck,
        "cap_stack": g.cap_stack,
        "pin": g.pin_diameter,
        "eye_radius": g.eye_radius,
        "eye_hole": g.pin_diameter if bearing is None else bearing.outer_diameter,
        "extension": g.rod_extension,
    }
    for rod in g.rods[1:]:
        values |= {"second_rod": rod.diameter, "second_rod_inner": rod.inner_diameter}
    return {name: float(value) for name, value in values.items()}


def numbered(design: Design) -> list[str]:
    """Numbered sentences on the order of assembly."""
    return [f"Assembly {k}. {line}" for k, line in enumerate(assembly.order(design), 1)]


def notes(design: Design, lengths: Mapping[str, float]) -> list[str]:
    """Details of the joints that the drawn section does not show, and the order of assembly."""
    sentences = []
    radii = {"head": lengths["rod"] / 2}
    if "second_rod" in lengths:
        radii["cap"] = lengths["second_rod"] / 2
    for end_joint in joints_of(design):
        end = end_of(
            design,
            end_joint,
            RetentionNumbers(end_joint.section),
            inner_radius=lengths["bore"] / 2,
            outer_radius=lengths["barrel_outer_diameter"] / 2,
            thicknesses=[ply.thickness for ply in design.barrel.layup],
            angles=[ply.angle for ply in design.barrel.layup],
            barrel_length=lengths["barrel_length"],
            plate=lengths["plate"],
            rod_radii=radii,
            head_length=lengths["head_length"],
            rings=ring_height(
                EnteringRing(*(getattr(seal, key) for key in EnteringRing._fields))
                for _, seal in entering_rings(design)
            ),
        )
        sentences += [end_joint.placed(sentence) for sentence in end_joint.joint.notes(end)]
    return [*sentences, *numbered(design)]
