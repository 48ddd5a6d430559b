"""Derived dimensions of the actuator and its grooves, shared by physics, mass and drawing.

Axial layout, from the outer face of the cap plate: cap plate, barrel, head plate, exposed rod, eye.
The barrel contains the piston (retracted against the cap plate), the stroke and the head plug.
A second rod passes through the cap, whose gland then is between cap plate and chamber.
Every seal element, wiper and guide has its groove in piston or head. Each end plate is held by a
joint (see `joints`); the design states one joint for both ends, or one for each.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import pi
from typing import Any, Literal, NamedTuple

from ..base.dataclass import dataclass
from ..base.numeric import Array, maximum
from ..design.lengths import closed_length, spigot_length
from ..design.model import Design, EndRetention, Ply
from ..design.seals import Seal, SealElement, StaticSeal
from ..design.standard_sizes import SphericalBearing, spherical_bearing
from ..joints.joint import (
    ENCLOSED,
    HELICAL,
    RINGS,
    BarrelLayer,
    End,
    EndDimensions,
    EnteringRing,
    Form,
    Joint,
    JointSizes,
    StaticPlace,
    ring_height,
)
from ..joints.kinds import JOINTS
from ..joints.sleeve import in_sleeve
from ..models import forces, gland
from ..models.spherical_bearing import lug_radius
from .values import Values


class Numbers:
    """Values of the block of a joint by key, in an evaluation, where they may be arrays.

    `path` is the PATH of the block: `retention`, or `retention.cap` for example.
    """

    def __init__(self, v: Values, path: str) -> None:
        self._v, self._path = v, path

    def __contains__(self, key: object) -> bool:
        return f"{self._path}.{key}" in self._v

    def __getitem__(self, key: str) -> Array:
        return self._v[f"{self._path}.{key}"]

    def get(self, key: str, default: Array) -> Array:
        """The number of a key, or `default` if the design does not state it."""
        return self._v.get(f"{self._path}.{key}", default)


class RetentionNumbers:
    """Values of the block of a joint by key, as stated in the design file."""

    def __init__(self, section: EndRetention) -> None:
        self._section = section

    def get(self, key: str, default: Array) -> Array:
        """The number of a key, or `default` if the design does not state it."""
        node: object = self._section
        for name in key.split("."):
            node = getattr(node, name, None)
        return default if node is None else node

    def __contains__(self, key: object) -> bool:
        return self.get(str(key), None) is not None

    def __getitem__(self, key: str) -> Array:
        return self.get(key, None)


@dataclass(frozen=True, slots=True)
class EndJoint:
    """The joint of one end of the barrel, "cap" or "head", or of both ends, with the name "".

    `path` is the PATH of the joint's block in the design file, and `section` its values there.
    """

    name: str
    path: str
    joint: Joint
    section: EndRetention

    @property
    def count(self) -> int:
        """Number of ends with this joint."""
        return 1 if self.name else 2

    def placed(self, place: str) -> str:
        """A location at this end, with the name of the end if the two ends differ.

        >>> EndJoint("cap", "retention.cap", None, None).placed("thread of the skirt")
        'cap: thread of the skirt'
        """
        return ": ".join(part for part in (self.name, place) if part)


def joints_of(design: Design) -> tuple[EndJoint, ...]:
    """The joints of the ends: one for both ends, or those of cap and head; none without them."""
    if design.retention is None:
        return ()
    return tuple(
        EndJoint(
            name,
            f"retention.{name}" if name else "retention",
            JOINTS[end.type] if end.sleeve is None else in_sleeve(JOINTS[end.type]),
            end,
        )
        for name, end in design.retention.ends.items()
    )


def clamped(design: Design) -> bool:
    """Whether the joint clamps the barrel between both ends."""
    return any(end.joint.clamping is not None for end in joints_of(design))


def _helical(ply: Ply) -> bool:
    """Whether a layer is wound at a stated angle that can carry the axial force of an end."""
    return 0.0 < abs(ply.angle) <= HELICAL


def end_of(
    design: Design,
    end_joint: EndJoint,
    sizes: JointSizes,
    *,
    inner_radius: Array,
    outer_radius: Array,
    thicknesses: Sequence[Array],
    angles: Sequence[Array],
    barrel_length: Array,
    plate: Array,
    rod_radii: Mapping[str, Array],
    head_length: Array,
    rings: Array,
    static: Sequence[Groove] = (),
) -> End:
    """Describe an end of the barrel; `thicknesses` and `angles` are those of its layers.

    `rod_radii` are the radii of the rods by the end that they pass, "head" or "cap". A joint of
    both ends gets the larger one. `rings` is the largest height of a ring above the bore.
    """
    radii = rod_radii if end_joint.name not in rod_radii else {"": rod_radii[end_joint.name]}
    rod_radius, *others = radii.values()
    for other in others:
        rod_radius = maximum(rod_radius, other)
    passed = end_joint.name != "cap" or "cap" in rod_radii
    layers = zip(design.barrel.layup, thicknesses, angles, strict=True)
    sealed = bool(static) and end_joint.joint.static_seal == "rim"
    return End(
        sizes=sizes,
        material=end_joint.section.material,
        cap=design.caps.material,
        layers=tuple(
            BarrelLayer(ply.material, thickness, angle, _helical(ply))
            for ply, thickness, angle in layers
        ),
        inner_radius=inner_radius,
        outer_radius=outer_radius,
        barrel_length=barrel_length,
        plate=plate,
        rod_radius=rod_radius,
        head_length=head_length if passed else None,
        seal_depth=static[0].gland_depth if sealed else 0.0,
        seal_lip=(plate - static[0].width) / 2 if sealed else None,
        ring_height=rings,
        sleeve=None if end_joint.section.sleeve is None else end_joint.section.sleeve.material,
    )


def entering_rings(design: Design) -> list[tuple[str, SealElement | StaticSeal]]:
    """The rings that enter the barrel, with their PATHs."""
    seals = design.seals
    stated = (seals.piston, seals.piston.secondary, seals.static)
    places = zip(RINGS, stated, strict=True)
    return [(".".join(place), seal) for place, seal in places if seal is not None]


def _rings(v: Values, design: Design) -> Array:
    """Largest height above the bore of a ring that enters the barrel [m]."""
    return ring_height(
        EnteringRing(*(v[f"{path}.{key}"] for key in EnteringRing._fields))
        for path, _ in entering_rings(design)
    )


class GroovePart(NamedTuple):
    """A ring in a groove: material, area of its section [m^2], radial depth of its centre [m]."""

    material: str
    area: Array
    depth: Array


@dataclass(frozen=True, slots=True)
class Groove:
    """A groove in piston or head, or several equal ones: its rings and dimensions.

    `gland_depth` is the radial depth that gives the nominal squeeze; `count` is the number of equal
    grooves.
    """

    place: str
    path: str
    role: Literal["element", "wiper", "guide"]
    material: str
    section: Array
    gland_depth: Array
    width: Array
    ring_width: Array
    count: Array
    pieces: tuple[GroovePart, ...]


def _element_groove(v: Values, place: str, path: str, element: SealElement) -> Groove:
    sizes = {key: v[path + key] for key in ("section", "squeeze", *element.seal_type.needed)}
    base_groove = element.seal_type.groove(sizes)
    default = base_groove.width
    pieces = [GroovePart(element.compound, piece.area, piece.depth) for piece in base_groove.pieces]
    if element.back_ups:
        assert element.back_up_material is not None
        thickness = v[f"{path}back_up_thickness"]
        default = gland.back_up_groove_width(
            groove_width=default, thickness=thickness, count=element.back_ups
        )
        area = element.back_ups * thickness * base_groove.depth
        pieces.append(GroovePart(element.back_up_material, area, base_groove.depth / 2))
    return Groove(
        place=place,
        path=path,
        role="element",
        material=element.compound,
        section=sizes["section"],
        gland_depth=base_groove.depth,
        width=v.get(f"{path}groove_width", default),
        ring_width=base_groove.ring_width,
        count=v[f"{path}count"],
        pieces=tuple(pieces),
    )


def grooves(v: Values, design: Design, name: Literal["piston", "rod"]) -> tuple[Groove, ...]:
    """All grooves in piston or head, from the pressure side outwards: guides, seals, wiper."""
    seal: Seal = getattr(design.seals, name)
    at = f"seals.{name}."
    place_grooves = []
    if seal.guide is not None:
        path = f"{at}guide."
        depth = v[f"{path}thickness"]
        place_grooves.append(
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
                pieces=(GroovePart(seal.guide.material, depth * v[f"{path}width"], depth / 2),),
            )
        )
    place_grooves.append(_element_groove(v, f"{name} seal", at, seal))
    if seal.secondary is not None:
        place_grooves.append(
            _element_groove(v, f"{name} secondary seal", f"{at}secondary.", seal.secondary)
        )
    if seal.wiper is not None:
        path = f"{at}wiper."
        section, width = v[f"{path}section"], v[f"{path}groove_width"]
        depth = gland.gland_depth(squeeze=v[f"{path}squeeze"], section=section)
        place_grooves.append(
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
                pieces=(GroovePart(seal.wiper.compound, section * width, depth / 2),),
            )
        )
    return tuple(place_grooves)


def static_places(design: Design) -> tuple[StaticPlace, StaticPlace]:
    """Places of the static seals of cap and head, both empty without static seals."""
    if design.seals.static is None:
        return "", ""
    places = [end.joint.static_seal for end in joints_of(design)] or ["bore"]
    return places[0], places[-1]


def static_grooves(v: Values, design: Design) -> tuple[Groove, ...]:
    """The groove of the static seal, equal in cap and head; none without static seals."""
    if design.seals.static is None or not any(static_places(design)):
        return ()
    path, compound = "seals.static.", design.seals.static.compound
    section = v[f"{path}section"]
    depth = gland.gland_depth(squeeze=v[f"{path}squeeze"], section=section)
    return (
        Groove(
            place="static seal",
            path=path,
            role="element",
            material=compound,
            section=section,
            gland_depth=depth,
            width=gland.groove_width(section=section),
            ring_width=section,
            count=1.0,
            pieces=(GroovePart(compound, pi / 4 * section * section, depth / 2),),
        ),
    )


def groove_totals(grooves: Sequence[Groove]) -> tuple[Array, Array, Array]:
    """Sum of the axial lengths of all grooves, number of grooves, and largest depth."""
    length: Array = 0.0
    count: Array = 0.0
    deepest: Array = 0.0
    for groove in grooves:
        length = length + groove.count * groove.width
        count = count + groove.count
        deepest = maximum(deepest, groove.gland_depth)
    return length, count, deepest


@dataclass(frozen=True, slots=True)
class RodThrough:
    """A rod through an end of the barrel, and the gland there.

    `path` is the PATH of its block in the design. `outside` is its length outside the end in the
    retracted actuator, and `length` that from the piston to its tip.
    """

    end: Literal["head", "cap"]
    path: Literal["rod", "second_rod"]
    diameter: Array
    inner_diameter: Array
    outside: Array
    length: Array
    grooves: tuple[Groove, ...]

    @property
    def name(self) -> str:
        """Name of the rod in results.

        >>> RodThrough("cap", "second_rod", 0.0, 0.0, 0.0, 0.0, ()).name
        'second rod'
        """
        return self.path.replace("_", " ")

    @property
    def gland(self) -> str:
        """Name of its gland in results: the head, or the second gland."""
        return "head" if self.end == "head" else "second gland"


@dataclass(frozen=True, slots=True)
class Geometry:
    """Dimensions in m, areas in m²; floats or arrays (designs,)."""

    bore: Array
    inner_radius: Array
    outer_radius: Array
    thicknesses: tuple[Array, ...]
    angles: tuple[Array, ...]
    """Winding angles of the barrel's layers; those of helical layers may be arrays."""
    stroke: Array
    area_a: Array
    area_b: Array
    rod_diameter: Array
    rod_inner_diameter: Array
    rod_thicknesses: tuple[Array, ...]
    rod_extension: Array
    rod_length: Array
    piston_length: Array
    piston_clearance: Array
    nut: Array
    """Thread diameter of the nut that clamps the piston; 0 without one."""
    head_length: Array
    head_clearance: Array
    plate: Array
    fits: tuple[EndDimensions, ...]
    """Dimensions of cap and head that follow from their joints; one entry if the joints are the
    same."""
    forms: tuple[Form, ...]
    """Forms of cap and head; one entry if their joints are the same."""
    barrel_length: Array
    eye_offset: Array
    """Length of an eye, from its pin to its end, without the additional neck of the cap's."""
    eye_radius: Array
    neck: Array
    """Additional length of the neck of the cap's eye."""
    pin_diameter: Array
    closed_length: Array
    piston_grooves: tuple[Groove, ...]
    rod_grooves: tuple[Groove, ...]
    rings: Array
    """Largest height above the bore of a ring that enters the barrel."""
    static_grooves: tuple[Groove, ...]
    """Groove of the static seal, equal in cap and head; empty without static seals."""
    static_places: tuple[StaticPlace, ...]
    """Places of the static seals of cap and head, both empty without static seals."""
    spigot: Array
    """Length of the cap's spigot, which has the groove of the static seal or is its skirt in the
    bore; 0 without one. With a second rod, it is the length of the cap's gland."""
    cushion: Array
    """Diameter of the cushions' spear and collar; 0 without cushions."""
    cap_bush: Array
    """Length of the cushion's bush between cap and chamber; 0 without one."""
    head_bush: Array
    """Length of the cushion's bush between head and chamber; 0 without one."""
    cap_stack: Array
    """Length of the components between cap and eye."""
    rod_stack: Array
    """Length of the components between rod and eye."""
    bearing_span: Array
    second_rod: tuple[RodThrough, ...]
    """The rod through the cap; empty without one."""

    @property
    def rods(self) -> tuple[RodThrough, ...]:
        """The rod through the head; then the second rod, through the cap, if there is one."""
        first = RodThrough(
            end="head",
            path="rod",
            diameter=self.rod_diameter,
            inner_diameter=self.rod_inner_diameter,
            outside=self.rod_extension,
            length=self.rod_length,
            grooves=self.rod_grooves,
        )
        return first, *self.second_rod

    @property
    def rod_radii(self) -> dict[str, Array]:
        """Radius of each rod by the end that it passes, "head" or "cap"."""
        return {rod.end: rod.diameter / 2 for rod in self.rods}

    @property
    def cap_eye(self) -> Array:
        """Length of the cap's eye with neck and components; 0 with a rod through the cap."""
        return 0.0 if self.second_rod else self.eye_offset + self.neck + self.cap_stack

    @property
    def cap_face(self) -> Array:
        """Distance from the first end of the actuator to the outer face of the cap's plate.

        The first end is the pin of the cap's eye, or the tip of a second rod.
        """
        return self.second_rod[0].outside if self.second_rod else self.cap_eye

    @property
    def wall_length(self) -> Array:
        """Length of the barrel wall, with the parts that enclose the end plates."""
        inside = self.cap_bush + self.barrel_length + self.head_bush
        return inside + self.spigot + self.cap_fit.beyond + self.head_fit.beyond

    @property
    def cap_fit(self) -> EndDimensions:
        """Dimensions of the cap that follow from its joint."""
        return self.fits[0]

    @property
    def plug_radius(self) -> Array:
        """Outer radius of the head's plug in the barrel."""
        return self.plug_radius_at("head")

    def plug_radius_at(self, end: Literal["head", "cap"]) -> Array:
        """Outer radius of the plug of an end in the barrel."""
        return self.inner_radius - (self.head_fit if end == "head" else self.cap_fit).inset

    def placed(self, rod: RodThrough, place: str) -> str:
        """A location at the end of a rod, with the rod's name if it is the second one."""
        return place if rod.end == "head" else f"{rod.name}, {place}"

    def by_rod(self, value: Callable[[RodThrough], Array]) -> Array | dict[str, Array]:
        """A value of the only rod; or those of both rods, by name."""
        if not self.second_rod:
            return value(self.rods[0])
        return {rod.name: value(rod) for rod in self.rods}

    def static_place(self, end: Literal["head", "cap"]) -> StaticPlace:
        """Place of the static seal at an end, empty without one."""
        return self.static_places[1 if end == "head" else 0]

    @property
    def head_fit(self) -> EndDimensions:
        """Dimensions of the head that follow from its joint."""
        return self.fits[-1]


def _thicknesses(v: Values, part: str, layup: tuple[Ply, ...]) -> tuple[Array, ...]:
    return tuple(v[f"{part}.layup[{i}].thickness"] for i in range(len(layup)))


def bearing_of(design: Design) -> SphericalBearing | None:
    """The spherical bearing of both eyes; None without one."""
    if design.clevis is None or design.clevis.bearing is None:
        return None
    return spherical_bearing(design.clevis.bearing)


def _eyes(v: Values, design: Design) -> dict[str, Array]:
    """Sizes of the eyes, and lengths of the components between cap or rod and eye."""
    bearing = bearing_of(design)
    if bearing is not None:
        pin = bearing.bore
        sizes = {"outer_diameter": bearing.outer_diameter, "width": bearing.width}
        radius = lug_radius(pin_diameter=pin, **sizes)
    else:
        pin = radius = 0.0 if design.clevis is None else v["clevis.pin_diameter"]
    lengths: dict[str, Array] = {"cap": 0.0, "rod": 0.0}
    for index, component in enumerate(design.extra_masses):
        if component.place in lengths:
            at = f"extra_masses[{index}]."
            added = v[f"{at}count"] * v[f"{at}length"]
            lengths[component.place] = lengths[component.place] + added
    return {
        "pin_diameter": pin,
        "eye_radius": radius,
        "eye_offset": radius + pin,
        "neck": 0.0 if design.clevis is None else v["clevis.neck"],
        "cap_stack": lengths["cap"],
        "rod_stack": lengths["rod"],
    }


def _cushions(v: Values, design: Design) -> dict[str, Array]:
    """Diameter of the cushions, and lengths of their bushes at cap and head; 0 without cushions."""
    ends = None if design.cushion is None else design.cushion.ends
    return {
        "cushion": 0.0 if ends is None else v["cushion.diameter"],
        "cap_bush": v["cushion.length"] if ends in ("cap", "both") else 0.0,
        "head_bush": v["cushion.length"] if ends in ("rod", "both") else 0.0,
    }


def _fits(v: Values, design: Design, **sizes: Any) -> tuple[EndDimensions, ...]:
    """Dimensions of cap and head that follow from their joints; `sizes` are those of `end_of`."""
    outer = sizes["outer_radius"]
    return tuple(
        end_joint.joint.fit(end_of(design, end_joint, Numbers(v, end_joint.path), **sizes))
        for end_joint in joints_of(design)
    ) or (EndDimensions(plate_radius=outer, radius=outer),)


def _rods(
    v: Values, design: Design, *, barrel_length: Array, head_bush: Array
) -> tuple[RodThrough, ...]:
    """The rod through the head, and the second rod, if any.

    Numbers that the block of the second rod does not state are those of the first. From its piston
    face it passes gland and plate; retracted, it extends over the stroke and its extension.
    """
    rod, extension = v["rod.outer_diameter"], v["rod.extension"]
    layers = _thicknesses(v, "rod", design.rod.layup)
    plate = v["caps.thickness"]
    first = RodThrough(
        end="head",
        path="rod",
        diameter=rod,
        inner_diameter=rod - 2 * sum(layers) if layers else v["rod.inner_diameter"],
        outside=extension,
        length=barrel_length - v["piston.length"] + head_bush + plate + extension,
        grooves=grooves(v, design, "rod"),
    )
    if not design.double_rod:
        return (first,)
    outside = v["cylinder.stroke"] + v.get("second_rod.extension", extension)
    second = RodThrough(
        end="cap",
        path="second_rod",
        diameter=v.get("second_rod.outer_diameter", rod),
        inner_diameter=v.get("second_rod.inner_diameter", first.inner_diameter),
        outside=outside,
        length=v["head.length"] + plate + outside,
        grooves=tuple(replace(x, place=f"second {x.place}") for x in first.grooves),
    )
    return first, second


def _of_rods(rods: tuple[RodThrough, ...]) -> dict[str, Any]:
    """Fields of `Geometry` for the rod through the head and the second rod."""
    first = rods[0]
    return {
        "rod_diameter": first.diameter,
        "rod_inner_diameter": first.inner_diameter,
        "rod_extension": first.outside,
        "rod_length": first.length,
        "rod_grooves": first.grooves,
        "second_rod": rods[1:],
    }


def _area_a(bore: Array, rods: Sequence[RodThrough]) -> Array:
    """Area of chamber A: that of the piston, or its annulus around a second rod."""
    if len(rods) == 1:
        return forces.piston_area(bore=bore)
    return forces.annulus_area(bore=bore, rod_diameter=rods[1].diameter)


def derive(v: Values, design: Design) -> Geometry:
    """All derived dimensions of a design."""
    bore, stroke = v["cylinder.bore"], v["cylinder.stroke"]
    double, cushions = design.double_rod, _cushions(v, design)
    thicknesses = _thicknesses(v, "barrel", design.barrel.layup)
    piston_length, head_length = v["piston.length"], v["head.length"]
    barrel_length = v.get("barrel.length", piston_length + stroke + head_length)
    if double and "barrel.length" in v:
        barrel_length = barrel_length - head_length  # the gland of the cap counts as its spigot
    plate = v["caps.thickness"]
    rods = _rods(v, design, barrel_length=barrel_length, head_bush=cushions["head_bush"])
    forms = tuple(end.joint.form for end in joints_of(design))
    sizes: dict[str, Any] = {
        "inner_radius": bore / 2,
        "outer_radius": bore / 2 + sum(thicknesses),
        "thicknesses": thicknesses,
        "angles": tuple(v[f"barrel.layup[{i}].angle"] for i in range(len(thicknesses))),
        "barrel_length": barrel_length,
        "plate": plate,
        "head_length": head_length,
        "rings": _rings(v, design),
    }
    static, places = static_grooves(v, design), static_places(design)
    radii = {rod.end: rod.diameter / 2 for rod in rods}
    fits = _fits(v, design, **sizes, rod_radii=radii, static=static)
    spigot = spigot_length(place=places[0], section=static[0].section) if static else 0.0
    spigot = head_length if double else spigot + fits[0].inner_length
    eyes = _eyes(v, design)
    further = cushions["cap_bush"] + cushions["head_bush"] + eyes["neck"] + eyes["cap_stack"]
    if double:
        further = further + rods[1].outside
    return Geometry(
        bore=bore,
        **sizes,
        stroke=stroke,
        area_a=_area_a(bore, rods),
        area_b=forces.annulus_area(bore=bore, rod_diameter=rods[0].diameter),
        **_of_rods(rods),
        rod_thicknesses=_thicknesses(v, "rod", design.rod.layup),
        piston_length=piston_length,
        piston_clearance=v["piston.clearance"],
        nut=0.0 if design.piston.nut is None else v["piston.nut.diameter"],
        head_clearance=v["head.clearance"],
        fits=fits,
        forms=forms,
        **eyes,
        closed_length=closed_length(
            barrel_length=barrel_length,
            plate=plate,
            spigot=spigot,
            further=further + eyes["rod_stack"],
            extension=rods[0].outside,
            eyes=(1 if double else 2) * eyes["eye_offset"],
        ),
        piston_grooves=grooves(v, design, "piston"),
        static_grooves=static,
        static_places=places,
        spigot=spigot,
        **cushions,
        bearing_span=(piston_length + head_length + plate) / 2 + cushions["head_bush"],
    )


def end_at(design: Design, end_joint: EndJoint, sizes: JointSizes, g: Geometry) -> End:
    """Describe an end of the barrel, as input for the functions of its joint."""
    return end_of(
        design,
        end_joint,
        sizes,
        inner_radius=g.inner_radius,
        outer_radius=g.outer_radius,
        thicknesses=g.thicknesses,
        angles=g.angles,
        barrel_length=g.barrel_length,
        plate=g.plate,
        rod_radii=g.rod_radii,
        head_length=g.head_length,
        rings=g.rings,
        static=g.static_grooves,
    )


STATIC_SEAL = 2.4e-3
"""Width of a plug's groove for its static O-ring [m], unless static seals are stated: ISO 3601-2,
section 1.78 mm, without back-up ring."""


def lands(geometry: Geometry, thread_radius: Array, *, eyes: bool) -> dict[str, Any]:
    """Wall thicknesses and clearances that must be positive, as constraints of the optimiser.

    `eyes` is whether both ends of the actuator have eyes.
    """
    g = geometry
    piston_length, piston_count, piston_depth = groove_totals(g.piston_grooves)
    head_length, head_count, head_depth = groove_totals(g.rod_grooves)
    bore = {"geometry_rod_bore": g.rod_inner_diameter} if g.rod_thicknesses else {}
    skirted = 2 * g.cap_fit.length if len(g.fits) == 1 else g.cap_fit.length + g.head_fit.length
    skirts = {"geometry_skirts": g.wall_length - skirted} if "skirts" in g.forms else {}
    static_width = g.static_grooves[0].width if g.static_grooves else STATIC_SEAL
    lips = {"cap": g.cap_face - g.eye_radius - g.cap_fit.lip} if eyes else {}
    if "cap" in g.rod_radii:
        lips["cap"] = g.rods[1].outside - g.stroke - g.cap_fit.lip
    lips["head"] = g.rod_extension - g.head_fit.lip
    beside: Array | dict[str, Array] = (g.plate - static_width) / 2
    radial: dict[str, Array] = {}
    sealed: dict[str, Array] = {}
    for rod in g.rods:
        place, word = g.static_place(rod.end), g.placed(rod, "radial")
        if place == "rim" and g.static_grooves:
            rest = g.inner_radius - rod.diameter / 2 - g.head_clearance
            radial[word] = rest - g.static_grooves[0].gland_depth
        if place == "bore":
            depth = g.static_grooves[0].gland_depth
            sealed[word] = g.inner_radius - rod.diameter / 2 - head_depth - depth
    if radial:
        beside = {"axial": beside, **radial}
    plugs = {"geometry_lip": lips, "geometry_plug": beside}
    if sealed:
        sealed["axial"] = (g.head_length - static_width) / 2
    return (
        bore
        | skirts
        | ({"geometry_static_seal": sealed} if sealed else {})
        | _sleeve_lands(g)
        | (plugs if set(ENCLOSED) & set(g.forms) else {})
        | {
            "geometry_rod_in_bore": g.by_rod(lambda rod: g.inner_radius - rod.diameter / 2),
            "geometry_rod_wall": g.by_rod(lambda rod: (rod.diameter - rod.inner_diameter) / 2),
            "geometry_piston_groove": (g.piston_length - piston_length) / (piston_count + 1),
            "geometry_piston_core": g.inner_radius - piston_depth - thread_radius,
            "geometry_head_groove": (g.head_length - head_length) / (head_count + 1),
            "geometry_head_wall": g.by_rod(
                lambda rod: g.plug_radius_at(rod.end) - rod.diameter / 2 - head_depth
            ),
        }
    )


def _sleeve_lands(g: Geometry) -> dict[str, dict[str, Array]]:
    """Lengths that must not be negative: lift of the winding, its cover, and between sleeves."""
    lands: dict[str, Array] = {}
    between = g.wall_length
    for name, fit in zip(("cap", "head") if len(g.fits) > 1 else ("",), g.fits, strict=True):
        if fit.sleeve is not None:
            own = {
                "lift": fit.sleeve.lift,
                "beyond the tip": fit.sleeve.inner - fit.sleeve.ramp,
            }
            lands |= {": ".join(filter(None, (name, key))): x for key, x in own.items()}
            sleeves = 1 if name else 2
            between = between - sleeves * (fit.sleeve.bare + fit.sleeve.inner)
    return {"geometry_sleeve": lands | {"between": between}} if lands else {}
