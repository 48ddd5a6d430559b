"""Static strength in an evaluation: wall, rod, column, thread, retention, caps, pins, guides.

Loads are the largest the supply can make: p A_A pushing (stall, column), p A_B pulling (rod
tension), and what the end stop puts through barrel and retention.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import pi, sqrt

from ..design.model import Design
from ..models import end_plate, retention, rod
from ..numeric import Array, real, where
from . import bonds, rod_strength, threads
from .allow import Stock
from .barrel import Wall, load_path
from .beam import Beam
from .geometry import Geometry
from .grooves import Groove, taken
from .rods import Rod
from .rows import Computed
from .state import State, side_reactions
from .values import Values

HOLE = 2.0
"""Stress at the edge of a small central hole over that of the solid plate [Timoshenko1959]."""


def compute(
    v: Values,
    design: Design,
    stock: Stock,
    g: Geometry,
    state: State,
    wall: Wall,
    section: Rod,
    beam: Beam,
    out: Computed,
) -> None:
    """Every strength metric."""
    supply = v["supply.pressure"]
    push, pull = supply * g.area_a, supply * g.area_b
    through = supply * load_path.largest_area(design, g)
    cut = threads.judged(v, design, stock, g)
    yields, bursts = wall.yield_pressure, wall.burst_pressure
    if isinstance(cut, threads.Thread):
        under = threads.barrel_pressures(stock, cut, wall.path.per_pressure)
        yields, bursts = yields | under[0], bursts | under[1]
    _pressure_factors(v, wall, supply, yields, bursts, out)
    parts = {place: p / supply for place, p in yields.items()}
    parts |= rod_strength.yields(stock, design, g, state, section, beam)
    parts |= _metal_ends(v, stock, design, g, section, cut, through, push)
    out.put("yield_factor", parts)
    out.put("buckling_factor", beam.critical / push)
    rod_strength.compute(design, section, beam, supply, push, pull, out)
    _rod_end(v, stock, design, section, pull, out)
    laps = {
        "caps": bonds.caps(stock, design, g, wall),
        "rod fittings": bonds.fittings(v, stock, design, section),
    }
    _retention(v, stock, design, wall, laps["caps"], cut, through, out)
    _fittings(stock, laps["rod fittings"], push, out)
    bonds.thermal(v, stock, design, laps, out)
    _caps(stock, design, g, supply, out)
    _pins(v, stock, design, push, out)
    _guides(stock, design, g, state, out)


def _pressure_factors(
    v: Values,
    wall: Wall,
    supply: Array,
    yields: Mapping[str, Array],
    bursts: Mapping[str, Array],
    out: Computed,
) -> None:
    """What the barrel bears over working and proof pressure, its thread included.

    `yields` and `bursts` are pressures by place.
    """
    proof = v["supply.proof_ratio"] * supply
    liner = {place: p / supply for place, p in wall.yield_pressure.items()}
    why = wall.missing[0] if wall.missing else "the wall has no metal layer"
    for name, factors in (
        ("liner_yield_factor", liner),
        ("burst_factor", {place: p / supply for place, p in bursts.items()}),
        ("first_ply_factor", {place: p / supply for place, p in wall.first_ply_pressure.items()}),
    ):
        if factors:
            out.put(name, factors)
        else:
            out.skip(name, "the wall has no plies" if name == "first_ply_factor" else why)
    both = {**yields, **wall.first_ply_pressure}
    if both:
        out.put("proof_factor", {place: p / proof for place, p in both.items()})
    else:
        out.skip("proof_factor", why)


def _metal_ends(
    v: Values,
    stock: Stock,
    design: Design,
    g: Geometry,
    section: Rod,
    cut: threads.Thread | str,
    through: Array,
    push: Array,
) -> dict[str, Array]:
    """Yield over working stress of what hangs on the ends: the caps' skirts, rod fittings."""
    factors = {}
    strength = stock.allowable(design.caps.material, "yield_strength")
    if isinstance(cut, threads.Thread):
        factors["skirt under the thread"] = strength * cut.skirt_section / through
    elif strength is not None and design.retention is not None and not load_path.tied(design):
        factors["cap skirt"] = strength * (2 * pi * g.outer_radius * g.skirt_wall) / through
    strength = stock.allowable(section.end_material, "yield_strength")
    if strength is not None and design.rod.fitting is not None:
        factors["rod fitting"] = strength * bonds.fitting_area(v, design, section) / push
    return factors


def _rod_end(
    v: Values, stock: Stock, design: Design, section: Rod, pull: Array, out: Computed
) -> None:
    strength = stock.allowable(section.end_material, "yield_strength")
    if design.rod.thread is None or strength is None:
        why = (
            "no thread stated: add rod.thread"
            if design.rod.thread is None
            else f"{section.end_material} states no yield strength"
        )
        out.skip("thread_factor", why)
        return
    stress = rod.thread_stress(
        force=pull, diameter=v["rod.thread.diameter"], pitch=v["rod.thread.pitch"]
    )
    out.put("thread_factor", strength / stress)


def _retention(
    v: Values,
    stock: Stock,
    design: Design,
    wall: Wall,
    lap: bonds.Lap | str,
    cut: threads.Thread | str,
    load: Array,
    out: Computed,
) -> None:
    """What holds caps and head: elastic limit and breaking load over the largest axial force."""
    held = design.retention
    found: tuple[dict[str, Array], Array | dict[str, Array]] | str
    if held is None:
        found = "no retention stated: add retention"
    elif held.type == "bond":
        found = (
            lap
            if isinstance(lap, str)
            else (bonds.edge_factors(stock, lap, load), bonds.mean_factor(stock, lap, load))
        )
    elif held.type == "thread":
        found = (
            cut
            if isinstance(cut, str)
            else (threads.factors(stock, cut, load), threads.burst_factors(stock, cut, load))
        )
    else:
        found = _tied(v, stock, design, wall)
    if isinstance(found, str):
        out.skip("retention_factor", found)
        out.skip("retention_burst_factor", found)
    else:
        out.put("retention_factor", found[0])
        out.put("retention_burst_factor", found[1])
    if wall.path.tie_rods is None:
        out.skip("joint_factor", "no tie rods")
    else:
        out.put("joint_factor", wall.path.tie_rods.closed)


def _fittings(stock: Stock, lap: bonds.Lap | str, push: Array, out: Computed) -> None:
    """Bond of the rod's fittings under the push, which is larger than any pull."""
    if isinstance(lap, str):
        out.skip("fitting_factor", lap)
    else:
        out.put("fitting_factor", bonds.edge_factors(stock, lap, push))


def _tied(
    v: Values, stock: Stock, design: Design, wall: Wall
) -> tuple[dict[str, Array], Array] | str:
    """Yield and ultimate strength of the tie rods over their stress; or why not."""
    held = design.retention
    name = None if held is None else held.material
    strength = None if name is None else stock.allowable(name, "yield_strength")
    ultimate = None if name is None else stock.allowable(name, "ultimate_strength")
    if held is None or held.thread is None or strength is None or ultimate is None:
        return "tie rods need a thread and a material with yield and ultimate strength"
    assert wall.path.tie_rods is not None
    stress = retention.tie_rod_stress(
        force=wall.path.tie_rods.largest,
        count=v["retention.count"],
        diameter=v["retention.thread.diameter"],
        pitch=v["retention.thread.pitch"],
    )
    return {"tie rods": strength / stress}, ultimate / stress


def _caps(stock: Stock, design: Design, g: Geometry, supply: Array, out: Computed) -> None:
    """Bending of the end plates; the head's plate and plug bend as one turned part.

    The cap hangs on the skirt (or the tie rods) while the piston stands at the far end; on a
    clevis its neck takes the push, pressure bending the plate around it, and the pull, which
    comes in at the skirt.
    """
    name = design.caps.material
    strength = stock.allowable(name, "yield_strength")
    ratio = stock.get(name, "poissons_ratio")
    if strength is None or ratio is None:
        out.skip("cap_factor", f"{name} states no yield strength or Poisson's ratio")
        return
    support = (g.plate_radius + g.skirt_radius) / 2
    stresses: dict[str, Array] = {}
    if design.cylinder.end_stop == "internal" or load_path.tied(design) or design.clevis is None:
        stresses["cap, hung on its skirt"] = end_plate.hung_plate_stress(
            pressure=supply,
            loaded_radius=g.inner_radius,
            support_radius=support,
            thickness=g.plate,
            poissons_ratio=ratio,
        )
    if design.clevis is not None and design.cylinder.mount == "cap_clevis":
        hub = {"hub_radius": g.pin_diameter / 2, "thickness": g.plate, "poissons_ratio": ratio}
        stresses["cap, pushing on its neck"] = end_plate.hub_plate_stress(
            pressure=supply, edge_force=0.0, edge_radius=g.inner_radius, **hub
        )
        stresses["cap, pulled by its neck"] = end_plate.hub_plate_stress(
            pressure=0.0, edge_force=supply * g.area_b, edge_radius=support, **hub
        )
    head = end_plate.end_plate_stress(
        pressure=supply,
        radius=g.inner_radius,
        thickness=g.plate + g.head_length,
        poissons_ratio=ratio,
    )
    stresses["head"] = HOLE * head
    out.put("cap_factor", {place: strength / stress for place, stress in stresses.items()})


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


def _guided(grooves: Sequence[Groove], length: Array) -> Array:
    """Length that carries side load: the guide rings', else what the grooves leave of the part."""
    for groove in grooves:
        if groove.role == "guide":
            return groove.count * groove.width
    return length - taken(grooves)[0]


def _guides(stock: Stock, design: Design, g: Geometry, state: State, out: Computed) -> None:
    out.put("bearing_overlap", g.bearing_span / g.rod_diameter)
    carried = side_reactions(g, state)
    pressures = {
        "head": retention.bearing_pressure(
            force=carried["rod"],
            diameter=g.rod_diameter,
            length=_guided(g.rod_grooves, g.head_length + g.plate),
        ),
        "piston": retention.bearing_pressure(
            force=carried["piston"],
            diameter=g.bore,
            length=_guided(g.piston_grooves, g.piston_length),
        ),
    }
    out.put("bearing_pressure", pressures)
    factors = {}
    for place, part, seal in (
        ("head", design.head, design.seals.rod),
        ("piston", design.piston, design.seals.piston),
    ):
        own = part.bearing or part.material
        material = own if seal.guide is None else seal.guide.material
        allowed = stock.allowable(material, "bearing_strength")
        if allowed is None:
            out.skip("bearing_factor", f"{material} states no bearing strength")
            return
        loaded = real(pressures[place]) > 0
        safe = where(loaded, pressures[place], 1.0 + 0 * pressures[place])
        factors[place] = where(loaded, allowed / safe, float("inf"))
    out.put("bearing_factor", factors)
