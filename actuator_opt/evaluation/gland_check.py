"""Gland checks with tolerances, growth and temperature: squeeze, fill, extrusion gap."""

from __future__ import annotations

import math
from collections.abc import Mapping

from ..base.numeric import Array, maximum, minimum, real, where
from ..design.housings import extrusion_tables
from ..design.material import Material
from ..design.model import Design
from ..models import extrusion, gland
from .geometry import Geometry
from .limits import MaterialValues
from .rings import Ring
from .state import LoadState
from .values import Values

ROOM = 293.15
"""Default assembly temperature, K."""

EXTRUSION_TABLE = "sealanddesign"
"""Table of gaps by hardness and pressure for compounds without their own limits."""


def metrics(
    v: Values,
    design: Design,
    stock: MaterialValues,
    geometry: Geometry,
    state: LoadState,
    ring: Ring,
    growth: Array,
) -> dict[str, Array]:
    """Gland metrics of a ring; `growth` is the largest bore growth over it.

    Squeeze and fill are for worst tolerances, hot and cold, with rod and bore concentric as in
    gland tables. Side load displaces the rod: the gap on one side is then larger by the clearance
    (and the squeeze smaller, as the seal sheet shows).
    """
    clearance, aside = clearances(geometry, state, ring)
    cold, hot = (
        volume_ratio(v, design, stock, ring, v[f"environment.temperature_{end}"])
        if design.environment is not None
        else 1.0
        for end in ("min", "max")
    )
    least, most = minimum(cold, hot), maximum(cold, hot)
    found = {"extrusion_factor": _extrusion(v, stock, ring, clearance + aside + growth)}
    if ring.element.seal_type.round_ring:  # limits of squeeze apply to round rings
        found["seal_squeeze"] = squeezes(ring, growth=growth, aside=0.0, ratio=least)[0]
        found["seal_squeeze_max"] = squeezes(ring, growth=0.0, aside=0.0, ratio=most)[1]
    if ring.element.seal_type.o_ring_gland:
        found["seal_fill"] = _fill(ring) * most
        found["seal_stretch"] = ring["stretch"]
        found["seal_section"] = ring["section"]
    return found


def _fill(ring: Ring) -> Array:
    """Largest fill of an O-ring's groove at assembly, with the shallowest groove."""
    backs = sum(piece.area for piece in ring.groove.pieces[1:]) / ring["gland_depth"]
    return gland.gland_fill(
        section=gland.stretched_section(
            section=ring["section"] + ring["section_tolerance"], stretch=ring["stretch"]
        ),
        groove_width=ring["groove_width"] - backs,
        gland_depth=ring["gland_depth"] - ring["tolerance"],
    )


def clearances(geometry: Geometry, state: LoadState, ring: Ring) -> tuple[Array, Array]:
    """Radial clearance behind a ring, and the displacement by side load, by case."""
    clearance = geometry.piston_clearance if ring.name == "piston" else geometry.head_clearance
    return clearance, where(real(state.side_load) > 0, 1.0, 0.0) * clearance


def squeezes(ring: Ring, *, growth: Array, aside: Array, ratio: Array) -> tuple[Array, Array]:
    """Least squeeze of a ring, with growth and stretch, and largest squeeze, without.

    `ratio` is ring over groove volume; `aside` the eccentricity of rod or piston.
    """
    section = ring["section"]
    thin = gland.stretched_section(section=section, stretch=ring["stretch"])
    spread = {
        "section_tolerance": ring["section_tolerance"],
        "depth_tolerance": ring["tolerance"],
        "eccentricity": aside,
    }
    grown = 1 - (section * (1 - ring["squeeze"]) + growth) / thin
    loosest, _ = gland.squeeze_extremes(squeeze=grown, section=thin, **spread)
    _, tightest = gland.squeeze_extremes(squeeze=ring["squeeze"], section=section, **spread)
    return (
        gland.squeeze_at_volume(squeeze=loosest, volume_ratio=ratio),
        gland.squeeze_at_volume(squeeze=tightest, volume_ratio=ratio),
    )


def volume_ratio(
    v: Values, design: Design, stock: MaterialValues, ring: Ring, temperature: Array
) -> Array:
    """Ring over groove volume at a temperature, relative to assembly; 1 if unknown."""
    expansion = stock.get(ring.element.compound, "volume_expansion")
    part = design.piston if ring.name == "piston" else design.head
    housing = stock.get(part.material, "thermal_expansion")
    if expansion is None or housing is None:
        return 1.0
    assembly = v["environment.assembly_temperature"] if design.environment is not None else ROOM
    return gland.volume_ratio(
        volume_expansion=expansion,
        housing_expansion=housing,
        temperature_change=temperature - assembly,
    )


def _extrusion(v: Values, stock: MaterialValues, ring: Ring, gap: Array) -> Array:
    """Allowable gap of the seal or its back-up ring at supply pressure, over the gap."""
    pressure, element = v["supply.pressure"], ring.element
    if stock.material(element.compound).properties.get("extrusion_gap_max") is None:
        hardness = v[f"materials.{element.compound}.hardness"]
        table = extrusion_tables()[EXTRUSION_TABLE].rows
        allowed = extrusion.extrusion_gap_limit(hardness=hardness, pressure=pressure, table=table)
        end = extrusion.extrusion_pressure_end(hardness=hardness, table=table)
    else:
        allowed = _stated(stock, element.compound, pressure)
        end = _stated_end(stock.material(element.compound))
    if element.back_up_material is not None:
        allowed = extrusion.backed_gap_limit(
            pressure=pressure,
            seal_limit=allowed,
            seal_end=end,
            ring_limit=_stated(stock, element.back_up_material, pressure),
            ring_end=_stated_end(stock.material(element.back_up_material)),
        )
    return allowed / gap


def _stated_end(material: Material) -> float:
    """Highest pressure for which a material states a gap limit; 0 if none."""
    limit = material.properties.get("extrusion_gap_max")
    if limit is None:
        return 0.0
    return limit.arguments[-1] if limit.points else math.inf


def _stated(stock: MaterialValues, name: str, pressure: Array) -> Array:
    """A material's own gap limit at a pressure; 0 if none."""
    limit = stock.material(name).properties.get("extrusion_gap_max")
    if limit is None:
        return 0.0
    scale = stock.get(name, "extrusion_gap_max") / limit.value
    if not limit.points:
        return scale * limit.value
    points = tuple(zip(limit.arguments, limit.values, strict=True))
    return scale * extrusion.gap_limit(pressure=pressure, points=points)


def extrusion_end(ring: Ring, materials: Mapping[str, Material]) -> float:
    """Highest pressure for which a gap limit of a ring is known."""
    compound, back_up = materials[ring.element.compound], ring.element.back_up_material
    ends = [0.0 if back_up is None else _stated_end(materials[back_up])]
    if "extrusion_gap_max" in compound.properties:
        ends.append(_stated_end(compound))
    else:
        table = extrusion_tables()[EXTRUSION_TABLE].rows
        hardness = compound.numbers["hardness"]
        ends.append(float(extrusion.extrusion_pressure_end(hardness=hardness, table=table)))
    return max(ends)
