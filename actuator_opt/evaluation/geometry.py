"""Derived dimensions of the actuator, shared by physics, mass and drawing.

Axial layout, from the outer face of the cap plate: plate, barrel (piston retracted against the
plate, stroke, head plug), head plate, exposed rod, eye. A joint of `joints` holds
both plates.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from ..base.numeric import Array, absolute
from ..design.linkage import closed_length
from ..design.material import Material
from ..design.model import Design, Ply
from ..joints.joint import End, Fit, JointSizes
from ..models import forces, mass
from .grooves import Groove, grooves, taken
from .retention import Numbers, end_of, joint_of
from .values import Values


@dataclass(frozen=True, slots=True)
class Geometry:
    """Dimensions in m, areas in m²; floats or arrays (designs,)."""

    bore: Array
    inner_radius: Array
    outer_radius: Array
    thicknesses: tuple[Array, ...]
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
    head_length: Array
    head_clearance: Array
    plate: Array
    fit: Fit
    """Dimensions from the joint of caps and head, the same at both ends."""
    has_skirts: bool
    barrel_length: Array
    eye_offset: Array
    pin_diameter: Array
    closed_length: Array
    piston_grooves: tuple[Groove, ...]
    rod_grooves: tuple[Groove, ...]
    bearing_span: Array


def _thicknesses(v: Values, part: str, layup: tuple[Ply, ...]) -> tuple[Array, ...]:
    return tuple(v[f"{part}.layup[{i}].thickness"] for i in range(len(layup)))


def derive(v: Values, design: Design) -> Geometry:
    """All derived dimensions of a design."""
    bore, stroke = v["cylinder.bore"], v["cylinder.stroke"]
    rod = v["rod.outer_diameter"]
    thicknesses = _thicknesses(v, "barrel", design.barrel.layup)
    rod_thicknesses = _thicknesses(v, "rod", design.rod.layup)
    rod_inner = rod - 2 * sum(rod_thicknesses) if rod_thicknesses else v["rod.inner_diameter"]
    inner_radius = bore / 2
    outer_radius = inner_radius + sum(thicknesses)
    piston_length, head_length = v["piston.length"], v["head.length"]
    needed = piston_length + stroke + head_length
    barrel_length = v.get("barrel.length", needed)
    plate = v["caps.thickness"]
    extension = v["rod.extension"]
    joint = joint_of(design)
    fit = Fit(plate_radius=outer_radius, radius=outer_radius)
    if joint is not None:
        end = end_of(
            design,
            Numbers(v),
            inner_radius=inner_radius,
            outer_radius=outer_radius,
            thicknesses=thicknesses,
            barrel_length=barrel_length,
            plate=plate,
        )
        fit = joint.fit(end)
    pin = v["clevis.pin_diameter"] if design.clevis is not None else 0.0
    eye_offset = mass.eye_length(pin_diameter=pin)
    return Geometry(
        bore=bore,
        inner_radius=inner_radius,
        outer_radius=outer_radius,
        thicknesses=thicknesses,
        stroke=stroke,
        area_a=forces.piston_area(bore=bore),
        area_b=forces.annulus_area(bore=bore, rod_diameter=rod),
        rod_diameter=rod,
        rod_inner_diameter=rod_inner,
        rod_thicknesses=rod_thicknesses,
        rod_extension=extension,
        rod_length=barrel_length - piston_length + plate + extension,
        piston_length=piston_length,
        piston_clearance=v["piston.clearance"],
        head_length=head_length,
        head_clearance=v["head.clearance"],
        plate=plate,
        fit=fit,
        has_skirts=joint is not None and joint.skirts,
        barrel_length=barrel_length,
        eye_offset=eye_offset,
        pin_diameter=pin,
        closed_length=closed_length(
            barrel_length=barrel_length, plate=plate, extension=extension, pin_diameter=pin
        ),
        piston_grooves=grooves(v, design, "piston"),
        rod_grooves=grooves(v, design, "rod"),
        bearing_span=(piston_length + head_length + plate) / 2,
    )


def end_at(design: Design, sizes: JointSizes, g: Geometry) -> End:
    """The end of the barrel as input of its joint."""
    return end_of(
        design,
        sizes,
        inner_radius=g.inner_radius,
        outer_radius=g.outer_radius,
        thicknesses=g.thicknesses,
        barrel_length=g.barrel_length,
        plate=g.plate,
    )


def lands(geometry: Geometry, thread_radius: Array) -> dict[str, Array]:
    """Walls that must stay positive: each is a constraint of the optimiser."""
    g = geometry
    piston_length, piston_count, piston_depth = taken(g.piston_grooves)
    head_length, head_count, head_depth = taken(g.rod_grooves)
    bore = {"geometry_rod_bore": g.rod_inner_diameter} if g.rod_thicknesses else {}
    between = g.barrel_length - 2 * g.fit.length
    skirts = {"geometry_skirts": between} if g.has_skirts else {}
    return (
        bore
        | skirts
        | {
            "geometry_rod_in_bore": g.inner_radius - g.rod_diameter / 2,
            "geometry_rod_wall": (g.rod_diameter - g.rod_inner_diameter) / 2,
            "geometry_piston_groove": (g.piston_length - piston_length) / (piston_count + 1),
            "geometry_piston_core": g.inner_radius - piston_depth - thread_radius,
            "geometry_head_groove": (g.head_length - head_length) / (head_count + 1),
            "geometry_head_wall": g.inner_radius - g.rod_diameter / 2 - head_depth,
        }
    )


def makeable(
    v: Values, design: Design, materials: Mapping[str, Material]
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Margins to the process limits, by layer of barrel and rod.

    Winding angle minus the smallest feasible angle [rad], and layer thickness over the smallest
    feasible thickness, minus one. A layer at exactly 0 deg is laid along the mandrel, not wound.
    """
    angles: dict[str, Array] = {}
    spare: dict[str, Array] = {}
    for path, entry in _layers(design):
        known, at = materials[entry.material].numbers, f"materials.{entry.material}."
        laid = entry.angle == 0 and f"{path}.angle" not in (*design.variables, *v.varied)
        if known.get("minimum_angle", 0.0) > 0 and not laid:
            angles[path] = absolute(v[f"{path}.angle"]) - v[f"{at}minimum_angle"]
        if known.get("minimum_thickness", 0.0) > 0:
            spare[path] = v[f"{path}.thickness"] / v[f"{at}minimum_thickness"] - 1
    return angles, spare


def _layers(design: Design) -> Iterator[tuple[str, Ply]]:
    """All layers of barrel and rod by PATH."""
    for part, layup in (("barrel", design.barrel.layup), ("rod", design.rod.layup)):
        for i, entry in enumerate(layup):
            yield f"{part}.layup[{i}]", entry
