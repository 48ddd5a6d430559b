"""Threaded ports: where they are, their masses, and the metal and clearance around them.

A port is in the rim of an end plate; axial drillings lead from it to the chamber. If the plate
is not deep enough for the drill, a boss on its rim makes up for it. Where the barrel encloses the
end plate, the port is in a round boss on the barrel, at the end of the chamber. The land of the
piston before its first groove then passes the port's bore, so that no seal does.
"""

from __future__ import annotations

from math import pi
from typing import Any, Literal

from ..base.dataclass import dataclass
from ..base.numeric import Array, maximum, minimum
from ..design.model import Design
from ..design.standard_sizes import PortSize, port
from ..joints.joint import ENCLOSED, LEAST_METAL, EndDimensions
from ..models.mass import stud_mass
from ..models.port import boss_volume
from .geometry import Geometry, groove_totals
from .values import Values

NO_PORTS = "no thread of the ports stated: add cylinder.port_thread"


@dataclass(frozen=True, slots=True)
class Places:
    """The ports of a design: size and bore; whether those of cap and head are on the barrel."""

    size: PortSize
    bore: Array
    on_barrel: tuple[bool, bool]


def bore(v: Values, design: Design) -> Array | None:
    """Bore of the ports; None if the design states neither bore nor thread."""
    name = design.cylinder.port_thread
    default = None if name is None else port(name).bore
    return v.get("cylinder.port_diameter", default)


def places(design: Design, g: Geometry, v: Values | None = None) -> Places | None:
    """The ports of a design; None if it states no thread for them."""
    name = design.cylinder.port_thread
    if name is None:
        return None
    size, forms = port(name), g.forms or ("plates",)
    stated = design.cylinder.port_diameter or size.bore
    return Places(
        size=size,
        bore=stated if v is None else v.get("cylinder.port_diameter", size.bore),
        on_barrel=(forms[0] in ENCLOSED, forms[-1] in ENCLOSED),
    )


def cushioned(design: Design) -> tuple[bool, bool]:
    """Whether cap and head have a cushion, in whose bush the port then opens."""
    ends = "" if design.cushion is None else design.cushion.ends
    return ends in ("cap", "both"), ends in ("rod", "both")


def boss_axis(design: Design, g: Geometry, name: str, bore: Array) -> Array:
    """Distance of a boss's axis from the outer end of chamber or bush at an end [m].

    The bore of a port opens at the end of the chamber, or into the middle of a cushion's bush.
    """
    cap, head = cushioned(design)
    if name == "cap":
        return g.cap_bush / 2 if cap else bore / 2
    return g.head_bush / 2 if head else bore / 2


def seat_radius(g: Geometry, fit: EndDimensions) -> Array:
    """Outer radius of the barrel under a boss at an end; a sleeve lifts the winding there."""
    return g.outer_radius + (0.0 if fit.sleeve is None else fit.sleeve.lift)


ENDS: tuple[Literal["cap", "head"], ...] = ("cap", "head")

DRILL = 1e-3
"""Smallest drill of the drillings from a port to the chamber [m]. Our choice."""


def gallery(
    g: Geometry, end: Literal["cap", "head"], *, bore: Array, bush: bool
) -> tuple[Array, Array, Array]:
    """Radius of the axial drillings, their diameter, and the width of the metal around them.

    Drillings with the area of the bore together are spread over half the circumference: in a ring
    of radius R they need the radial width d^2/(4 R). They lie between the grooves of the rod seals
    and the groove of a static seal on the head. With a cushion's `bush`, they end in its bore. A
    cap without rod has them where the head has them.
    """
    rod = g.rods[-1] if end == "cap" else g.rods[0]
    inner = rod.diameter / 2 + groove_totals(rod.grooves)[2]
    sealed = g.static_place(rod.end) == "bore"
    outer = g.plug_radius_at(rod.end) - (g.static_grooves[0].gland_depth if sealed else 0.0)
    if bush:
        outer = minimum(outer, g.cushion / 2)
    radius = (inner + outer) / 2
    return radius, maximum(bore * bore / (4 * radius), DRILL), outer - inner


def rim_bosses(size: PortSize, g: Geometry) -> tuple[Array, Array]:
    """Heights of the bosses on the rims of cap and head that the drill of a port needs, or 0."""
    cap = g.cap_fit.plate_radius
    for rod in g.rods[1:]:
        cap = cap - (rod.diameter / 2 + g.head_clearance + LEAST_METAL)
    under = g.rod_diameter / 2 + g.head_clearance + LEAST_METAL
    return (
        maximum(size.drilled - cap, 0.0),
        maximum(size.drilled - (g.head_fit.plate_radius - under), 0.0),
    )


def lands(v: Values, design: Design, g: Geometry) -> dict[str, Any]:
    """Metal beside the ports, and clearances of their bosses, which the optimiser keeps."""
    ports = places(design, g, v)
    if ports is None:
        return {}
    size, bore, rows = ports.size, ports.bore, {}
    if any(ports.on_barrel):
        length, count, _ = groove_totals(g.piston_grooves)
        land = (g.piston_length - length) / (count + 1)
        passed = [
            boss and not bush for boss, bush in zip(ports.on_barrel, cushioned(design), strict=True)
        ]
        if any(passed):
            rows["land of the piston beyond the port"] = land - bore
        rows["barrel beside the boss"] = g.outer_radius - size.boss / 2
    if all(ports.on_barrel):
        inside = g.cap_bush + g.barrel_length - g.head_length + g.head_bush
        axes = sum(boss_axis(design, g, name, bore) for name in ENDS)
        rows["between the bosses"] = inside - axes - size.boss
    fits = (g.cap_fit, g.head_fit)
    glands = {rod.end: rod.gland for rod in g.rods}
    for name, boss, fit in zip(ENDS, ports.on_barrel, fits, strict=True):
        if boss:
            outside = fit.beyond + (g.spigot if name == "cap" else g.head_length)
            end = outside + boss_axis(design, g, name, bore) - size.boss / 2
            bare = 0.0 if fit.sleeve is None else fit.sleeve.bare
            rows[f"barrel's end beside the boss, {name}"] = end - bare
            continue
        rows[f"{name} plate beside the port"] = (g.plate - size.seat) / 2
        if name in glands:
            _, drilled, width = gallery(g, name, bore=bore, bush=cushioned(design)[1])
            rows[f"{glands[name]} beside the drillings"] = (width - drilled) / 2
    return {"geometry_port": rows}


def masses(v: Values, design: Design, g: Geometry) -> dict[str, Array]:
    """Mass of the bosses, and of the metal that the ports remove, with a negative sign."""
    ports = places(design, g, v)
    if ports is None:
        return {}
    size = ports.size
    caps = v[f"materials.{design.caps.material}.density"]
    head = v[f"materials.{design.head.material}.density"]
    thread = {"diameter": size.diameter, "pitch": size.pitch, "length": size.drilled}
    area = pi / 4 * ports.bore * ports.bore
    wall = sum(
        v[f"materials.{ply.material}.density"] * thickness
        for ply, thickness in zip(design.barrel.layup, g.thicknesses, strict=True)
    )
    cut = stud_mass(density=caps, **thread)
    rims = rim_bosses(size, g)
    parts: dict[str, Array] = {}
    fits, bushes = (g.cap_fit, g.head_fit), cushioned(design)
    for name, boss, fit, rim, bush in zip(ENDS, ports.on_barrel, fits, rims, bushes, strict=True):
        if boss:
            solid = boss_volume(
                boss_diameter=size.boss, height=size.drilled, tube_radius=seat_radius(g, fit)
            )
            parts["ports"] = parts.get("ports", 0.0) + caps * solid - cut
            parts["barrel"] = parts.get("barrel", 0.0) - wall * area
        else:
            axis = gallery(g, name, bore=ports.bore, bush=bush)[0]
            further = maximum(fit.plate_radius + rim - size.drilled - axis, 0.0)
            solid = caps * pi / 4 * size.boss * size.boss * rim
            parts[name] = solid - cut - caps * area * (further + g.plate / 2)
            if name in g.rod_radii:
                parts["glands"] = parts.get("glands", 0.0) - head * area * g.head_length
    return parts
