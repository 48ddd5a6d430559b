"""Static strength in an evaluation: wall, rod, column, thread, retention, caps, pins, guides.

Loads are the largest the supply can make: p A_A pushing (stall, column), p A_B pulling (rod
tension), and what the end stop puts through barrel and retention.
"""

from __future__ import annotations

from math import pi, sqrt

from ..design.model import Design
from ..models import column, end_plate, retention, rod, stepped
from ..numeric import Array, real, where
from .allow import Stock
from .geometry import Geometry
from .rows import Computed
from .state import State
from .values import Values
from .wall import Wall

HOLE = 2.0
"""Stress at the edge of a small central hole over that of the solid plate [Timoshenko1959]."""

FIXED_PINNED = 0.6992
"""Effective length factor of a column fixed at one end, pinned at the other: pi/4.4934."""


def compute(
    v: Values,
    design: Design,
    stock: Stock,
    g: Geometry,
    state: State,
    wall: Wall,
    out: Computed,
) -> None:
    """Every strength metric."""
    supply = v["supply.pressure"]
    push, pull = supply * g.area_a, supply * g.area_b
    through = max_axial(design, g, supply)
    _pressure_factors(v, stock, design, g, wall, supply, through, state, out)
    _buckling(stock, design, g, wall, push, out)
    _rod_end(v, stock, design, pull, out)
    _retention(v, stock, design, g, wall, through, out)
    _caps(stock, design, g, supply, out)
    _pins(v, stock, design, push, out)
    _guides(stock, design, g, state, out)


def max_axial(design: Design, g: Geometry, supply: Array) -> Array:
    """Largest axial force through barrel and retention: end stop, mount or tie rods."""
    tied = design.retention is not None and design.retention.type == "tie_rods"
    if design.cylinder.end_stop == "internal" or tied:
        return supply * g.area_a
    area = g.area_b if design.cylinder.mount.startswith("cap") else g.area_a
    return supply * area


def _pressure_factors(
    v: Values,
    stock: Stock,
    design: Design,
    g: Geometry,
    wall: Wall,
    supply: Array,
    through: Array,
    state: State,
    out: Computed,
) -> None:
    proof = v["supply.proof_ratio"] * supply
    yields = {place: p / supply for place, p in wall.yield_pressure.items()}
    why = wall.missing[0] if wall.missing else "the wall has no metal layer"
    for name, factors in (
        ("liner_yield_factor", yields),
        ("burst_factor", {place: p / supply for place, p in wall.burst_pressure.items()}),
        ("first_ply_factor", {place: p / supply for place, p in wall.first_ply_pressure.items()}),
    ):
        if factors:
            out.put(name, factors)
        else:
            out.skip(name, "the wall has no plies" if name == "first_ply_factor" else why)
    both = wall.yield_pressure | wall.first_ply_pressure
    if both:
        out.put("proof_factor", {place: p / proof for place, p in both.items()})
    else:
        out.skip("proof_factor", why)
    parts = dict(yields)
    strength = stock.allowable(design.rod.material, "yield_strength", "strength_1_compression")
    if strength is not None:
        axial = rod.rod_stress(
            force=state.driven_pressure * where(state.push, g.area_a, g.area_b),
            outer_diameter=g.rod_diameter,
            inner_diameter=g.rod_inner_diameter,
        )
        bending = rod.bending_stress(
            bending_moment=state.side_load * overhang(g),
            outer_diameter=g.rod_diameter,
            inner_diameter=g.rod_inner_diameter,
        )
        parts["rod"] = strength / (axial + bending)
    skirt = stock.allowable(design.caps.material, "yield_strength")
    if skirt is not None and design.retention is not None and design.retention.type != "tie_rods":
        parts["cap skirt"] = skirt * (2 * pi * g.outer_radius * g.skirt_wall) / through
    out.put("yield_factor", parts)


def overhang(g: Geometry) -> Array:
    """Distance of the rod eye from the middle of the head bearing at full extension."""
    return g.stroke + g.rod_extension + g.eye_offset + (g.head_length + g.plate) / 2


def _buckling(
    stock: Stock, design: Design, g: Geometry, wall: Wall, push: Array, out: Computed
) -> None:
    modulus = stock.get(design.rod.material, "youngs_modulus", "youngs_modulus_1")
    bending = modulus * rod.second_moment(
        outer_diameter=g.rod_diameter, inner_diameter=g.rod_inner_diameter
    )
    exposed = g.stroke + g.rod_extension + g.eye_offset
    mount = design.cylinder.mount
    if mount.startswith("head"):
        factor = FIXED_PINNED if mount == "head_flange" else 1.0
        load = column.euler_load(bending_stiffness=bending, effective_length=factor * exposed)
    else:
        load = stepped.stepped_column_load(
            bending_stiffness_1=wall.bending_stiffness,
            length_1=g.eye_offset + 2 * g.plate + g.barrel_length,
            bending_stiffness_2=bending,
            length_2=exposed,
            ends=("fixed" if mount == "cap_flange" else "pinned", "pinned"),
        )
    out.put("buckling_factor", load / push)


def _rod_end(v: Values, stock: Stock, design: Design, pull: Array, out: Computed) -> None:
    strength = stock.allowable(design.rod.material, "yield_strength")
    if design.rod.thread is None or strength is None:
        why = (
            "no thread stated: add rod.thread"
            if design.rod.thread is None
            else f"{design.rod.material} states no yield strength"
        )
        out.skip("thread_factor", why)
        return
    stress = rod.thread_stress(
        force=pull, diameter=v["rod.thread.diameter"], pitch=v["rod.thread.pitch"]
    )
    out.put("thread_factor", strength / stress)


def _retention(
    v: Values, stock: Stock, design: Design, g: Geometry, wall: Wall, load: Array, out: Computed
) -> None:
    held = design.retention
    if held is None:
        out.skip("retention_factor", "no retention stated: add retention")
        return
    if held.type == "bond" and held.material is not None:
        strength = stock.allowable(held.material, "bond_strength")
        modulus = stock.get(design.caps.material, "youngs_modulus")
        shear = stock.get(held.material, "shear_modulus")
        if strength is None or modulus is None or shear is None:
            out.skip("retention_factor", "adhesive or caps lack bond strength or a modulus")
            return
        common = {
            "force": load,
            "diameter": 2 * g.outer_radius,
            "length": g.skirt_length,
            "shear_modulus": shear,
            "bond_thickness": stock.get(held.material, "bond_thickness", default=0.15e-3),
        }
        skirt, barrel = modulus * g.skirt_wall, wall.axial_line_stiffness
        edges = {
            "bond at the skirt's edge": (barrel, skirt),
            "bond at the barrel's edge": (skirt, barrel),
        }
        out.put(
            "retention_factor",
            {
                place: strength
                / retention.bond_edge_shear(
                    **common, membrane_stiffness_loaded=loaded, membrane_stiffness_free=free
                )
                for place, (loaded, free) in edges.items()
            },
        )
        return
    name = held.material if held.type == "tie_rods" else design.caps.material
    strength = None if name is None else stock.allowable(name, "yield_strength")
    if strength is None or held.thread is None:
        out.skip(
            "retention_factor", "retention needs a thread and a material with a yield strength"
        )
    elif held.type == "tie_rods":
        stress = retention.tie_rod_stress(
            force=load,
            count=v["retention.count"],
            diameter=v["retention.thread.diameter"],
            pitch=v["retention.thread.pitch"],
        )
        out.put("retention_factor", {"tie rods": strength / stress})
    else:
        stress = rod.thread_shear_stress(
            force=load,
            diameter=2 * g.outer_radius,
            pitch=v["retention.thread.pitch"],
            engagement=g.skirt_length,
        )
        out.put("retention_factor", {"thread": strength / sqrt(3) / stress})


def _caps(stock: Stock, design: Design, g: Geometry, supply: Array, out: Computed) -> None:
    """Bending of the end plates; the head's plate and plug bend as one turned part."""
    name = design.caps.material
    strength = stock.allowable(name, "yield_strength")
    ratio = stock.get(name, "poissons_ratio")
    if strength is None or ratio is None:
        out.skip("cap_factor", f"{name} states no yield strength or Poisson's ratio")
        return
    flat = {"pressure": supply, "radius": g.inner_radius, "poissons_ratio": ratio}
    cap = end_plate.end_plate_stress(thickness=g.plate, **flat)
    head = end_plate.end_plate_stress(thickness=g.plate + g.head_length, **flat)
    out.put("cap_factor", {"cap": strength / cap, "head": strength / (HOLE * head)})


def _pins(v: Values, stock: Stock, design: Design, push: Array, out: Computed) -> None:
    if design.clevis is None:
        out.skip("pin_factor", "no clevis stated: add clevis")
        return
    strength = stock.allowable(design.clevis.material, "yield_strength")
    if strength is None:
        out.skip("pin_factor", f"{design.clevis.material} states no yield strength")
        return
    stress = retention.pin_shear_stress(force=push, diameter=v["clevis.pin_diameter"])
    out.put("pin_factor", strength / sqrt(3) / stress)


def _guides(stock: Stock, design: Design, g: Geometry, state: State, out: Computed) -> None:
    out.put("bearing_overlap", g.bearing_span / g.rod_diameter)
    head, piston = retention.guide_forces(
        side_force=state.side_load, overhang=overhang(g), span=g.bearing_span
    )
    grooves = g.rod_groove.count * g.rod_groove.width
    pressures = {
        "head": retention.bearing_pressure(
            force=head, diameter=g.rod_diameter, length=g.head_length + g.plate - grooves
        ),
        "piston": retention.bearing_pressure(
            force=piston,
            diameter=g.bore,
            length=g.piston_length - g.piston_groove.count * g.piston_groove.width,
        ),
    }
    out.put("bearing_pressure", pressures)
    factors = {}
    for place, part in (("head", design.head), ("piston", design.piston)):
        allowed = stock.allowable(part.guide or part.material, "bearing_strength")
        if allowed is None:
            out.skip("bearing_factor", f"{part.guide or part.material} states no bearing strength")
            return
        loaded = real(pressures[place]) > 0
        safe = where(loaded, pressures[place], 1.0 + 0 * pressures[place])
        factors[place] = where(loaded, allowed / safe, float("inf"))
    out.put("bearing_factor", factors)
