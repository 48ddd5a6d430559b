"""Mass of every part, each by a formula that can be checked by hand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ..base.numeric import Array
from ..design.choices import COMPONENTS
from ..design.model import Design
from ..joints.joint import LEAST_METAL, EndDimensions
from ..models import mass
from ..models.spherical_bearing import bearing_eye_volume
from . import cushion, piston_nut, ports, sensor
from .geometry import Geometry, Numbers, bearing_of, end_at, joints_of
from .limits import MaterialValues
from .rods import RodSection, fitting_hole
from .values import Values

PARTS = ("barrel", "rod", "piston", "caps", "glands", "seals", "fastening", "clevises")
"""Parts of the mass breakdown, in assembly order."""
SECOND = "second rod"
OPTIONAL = (SECOND, "ports", "sensor")
"""Parts that follow them, in a design that has them: second rod, bosses of the ports, position
sensor."""
STATED, STATED_MOVING = "components", "moving components"
"""Last parts of the breakdown: components with a stated mass, fixed or moving with the rod."""
MOVING = ("rod", SECOND, "piston", "fastening", STATED_MOVING)
"""Parts that move with the rod."""


def _barrel(v: Values, design: Design, g: Geometry) -> Array:
    total: Array = 0.0
    radius = g.inner_radius
    for ply, thickness in zip(design.barrel.layup, g.thicknesses, strict=True):
        area = mass.layer_area(inner_radius=radius, thickness=thickness)
        total = total + v[f"materials.{ply.material}.density"] * area
        radius = radius + thickness
    return total * g.wall_length


def _piston(v: Values, design: Design, g: Geometry) -> Array:
    density = v[f"materials.{design.piston.material}.density"]
    diameter = g.bore - 2 * g.piston_clearance
    groove_volume = sum(
        groove.count
        * mass.piston_groove_volume(
            diameter=diameter, depth=groove.gland_depth - g.piston_clearance, width=groove.width
        )
        for groove in g.piston_grooves
    )
    disc = mass.disc_mass(density=density, diameter=diameter, thickness=g.piston_length)
    return disc - density * groove_volume


def _plate(density: Array, g: Geometry, fit: EndDimensions, hole: Array) -> Array:
    """Mass of one end plate."""
    return mass.tube_mass(
        density=density, inner_diameter=hole, outer_diameter=2 * fit.plate_radius, length=g.plate
    )


def _glands(v: Values, design: Design, g: Geometry) -> Array:
    """Mass of the gland around every rod."""
    density, glands = v[f"materials.{design.head.material}.density"], []
    for rod in g.rods:
        hole = rod.diameter + 2 * g.head_clearance
        groove_volume = sum(
            groove.count
            * mass.rod_groove_volume(
                diameter=hole, depth=groove.gland_depth - g.head_clearance, width=groove.width
            )
            for groove in rod.grooves
        )
        plug = mass.tube_mass(
            density=density,
            inner_diameter=hole,
            outer_diameter=2 * g.plug_radius_at(rod.end),
            length=g.head_length,
        )
        glands.append(plug - density * groove_volume)
    return sum(glands[1:], start=glands[0])


def _seals(v: Values, g: Geometry) -> Array:
    rings: Array = 0.0
    placed_grooves = [(groove, g.bore, -1) for groove in g.piston_grooves]
    placed_grooves += [(groove, rod.diameter, 1) for rod in g.rods for groove in rod.grooves]
    for place in g.static_places:
        placed_grooves += [(groove, g.bore, -1) for groove in g.static_grooves if place]
    for groove, counterface, side in placed_grooves:
        for piece in groove.pieces:
            ring = mass.ring_mass(
                density=v[f"materials.{piece.material}.density"],
                area=piece.area,
                centre_diameter=counterface + side * 2 * piece.depth,
            )
            rings = rings + groove.count * ring
    return rings


def _static_grooves(caps: Array, head: Array, g: Geometry) -> dict[str, Array]:
    """Mass of the cap's spigot, and of the metal cut for static seals, with a negative sign.

    `caps` and `head` are the densities of caps and head.
    """
    if not g.static_grooves:
        return {}
    (groove,) = g.static_grooves
    cut = mass.piston_groove_volume(diameter=g.bore, depth=groove.gland_depth, width=groove.width)
    wall = groove.gland_depth + LEAST_METAL
    spigot = mass.layer_area(inner_radius=g.inner_radius - wall, thickness=wall) * g.spigot
    cap, _ = g.static_places
    additions: dict[str, Array] = {}
    if "cap" not in g.rod_radii:
        additions["cap"] = caps * (spigot - cut) if cap else 0.0
    for rod in g.rods:
        place = g.static_place(rod.end)
        if place:
            part, density = (rod.end, caps) if place == "rim" else ("glands", head)
            additions[part] = additions.get(part, 0.0) - density * cut
    return additions


def _rod_ends(v: Values, design: Design, rod: RodSection) -> Array:
    """Mass of the rod's threaded stud, of the two plugs in its bore, and of its bonded fittings.

    A plug closes the bore at each end. A bonded fitting is itself such a plug, or a sleeve around
    one. Stud and plugs are as long as the diameter of the thread there; at the piston, this is the
    nut's thread if there is one.
    """
    density = v[f"materials.{rod.end_material}.density"]
    hole, total = rod.inner_diameter, 0.0
    if design.rod.fitting is not None:
        hole = fitting_hole(v, design, rod)
        total = 2 * mass.tube_mass(
            density=density,
            inner_diameter=hole,
            outer_diameter=rod.inner_diameter,
            length=v["rod.fitting.length"],
        )
    if design.rod.thread is None:
        return total
    diameter, pitch = v["rod.thread.diameter"], v["rod.thread.pitch"]
    stud = mass.stud_mass(density=density, diameter=diameter, pitch=pitch, length=diameter)
    plugs = diameter + (diameter if design.piston.nut is None else v["piston.nut.diameter"])
    return total + stud + mass.disc_mass(density=density, diameter=hole, thickness=plugs)


def _eyes(v: Values, design: Design, g: Geometry) -> Array:
    """Mass of the eyes with their spherical bearings, and of the additional neck of the cap's.

    With a second rod there is no eye at the cap.
    """
    if design.clevis is None:
        return 0.0
    density, bearing = v[f"materials.{design.clevis.material}.density"], bearing_of(design)
    neck = mass.disc_mass(density=density, diameter=g.pin_diameter, thickness=g.neck)
    count = 1 if design.double_rod else 2
    if bearing is None:
        return count * density * mass.eye_volume(pin_diameter=g.pin_diameter) + neck
    volume = bearing_eye_volume(
        pin_diameter=bearing.bore, outer_diameter=bearing.outer_diameter, width=bearing.width
    )
    return count * (density * volume + bearing.mass) + neck


def parts(
    v: Values,
    design: Design,
    stock: MaterialValues,
    geometry: Geometry,
    sections: Sequence[RodSection],
) -> dict[str, Array]:
    """Mass of every part [kg]; the oil is not included."""
    g, rod = geometry, sections[0]
    caps = v[f"materials.{design.caps.material}.density"]
    masses = {
        "barrel": _barrel(v, design, g),
        "rod": rod.mass_per_length * g.rod_length,
        "piston": _piston(v, design, g),
        "cap": _plate(caps, g, g.cap_fit, 0.0),
        "head": _plate(caps, g, g.head_fit, g.rod_diameter + 2 * g.head_clearance),
        "glands": _glands(v, design, g),
        "seals": _seals(v, g),
        "fastening": _rod_ends(v, design, rod),
        "clevises": _eyes(v, design, g),
    }
    for through, section in zip(g.rods[1:], sections[1:], strict=True):
        masses["cap"] = _plate(caps, g, g.cap_fit, through.diameter + 2 * g.head_clearance)
        masses[SECOND] = section.mass_per_length * through.length
    head = v[f"materials.{design.head.material}.density"]
    for additions in (
        _static_grooves(caps, head, g),
        piston_nut.masses(v, design, g),
        ports.masses(v, design, g),
        sensor.masses(v, design, g, rod),
        cushion.masses(v, design, g, rod),
    ):
        for part, addition in additions.items():
            masses[part] = masses.get(part, 0.0) + addition
    for end_joint in joints_of(design):
        end = end_at(design, end_joint, Numbers(v, end_joint.path), g)
        for part, addition in end_joint.joint.mass(end, stock).items():
            if part == "caps":
                for plate in [end_joint.name] if end_joint.name else ["cap", "head"]:
                    masses[plate] = masses[plate] + addition
            else:
                masses[part] = masses[part] + end_joint.count * addition
    masses["caps"] = masses.pop("cap") + masses.pop("head")
    stated = {part: masses[part] for part in OPTIONAL if part in masses}
    for index, component in enumerate(design.extra_masses):
        part = STATED_MOVING if component.place in ("piston", "rod") else STATED
        stated[part] = stated.get(part, 0.0) + _component(v, index)
    return {part: masses[part] for part in PARTS} | stated


def _component(v: Values, index: int) -> Array:
    """Mass of a component that the design states, with all its pieces."""
    return v[f"extra_masses[{index}].count"] * v[f"extra_masses[{index}].mass"]


def moving(parts: Mapping[str, Array], load: Array = 0.0) -> Array:
    """Mass of the parts that move with the rod, and of the load on it [kg]."""
    return sum((parts[part] for part in MOVING if part in parts), load)


def left_out(design: Design) -> tuple[str, ...]:
    """Components that the mass leaves out: no model weighs them, and the design states no mass.

    A bonded end needs no static seal, since the adhesive seals it.
    """
    stated = {component.kind for component in design.extra_masses}
    if design.seals.static is not None:
        stated.add("static_seals")
    if design.piston.nut is not None:
        stated.add("piston_fastening")
    joints = joints_of(design)
    if joints and all("adhesive" in end.joint.kinds for end in joints):
        stated.add("static_seals")
    if design.clevis is None or design.clevis.bearing is not None:
        stated.add("bearings")
    if design.sensor is not None:
        stated.add("sensor")
    missing = {kind: words for kind, words in COMPONENTS.items() if kind not in stated}
    if design.cylinder.port_thread is not None and "ports" in missing:
        missing["ports"] = "fittings of the ports"
    return tuple(missing.values())


def oil(v: Values, design: Design, geometry: Geometry, position: Array = 0.0) -> Array:
    """Mass of the oil in both chambers [kg]; `position` is the piston's travel from the cap end."""
    g = geometry
    volume = (
        v["cylinder.dead_volume_a"]
        + v["cylinder.dead_volume_b"]
        + g.area_a * position
        + g.area_b * (g.barrel_length - g.piston_length - g.head_length - position)
    )
    density = v[f"materials.{design.fluid.material}.density"]
    return mass.oil_mass(density=density, volume=volume)
