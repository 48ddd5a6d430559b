"""Glands over tolerances, growth, heat and cold: squeeze, fill, the gap behind the seal."""

from __future__ import annotations

from ..design.housings import extrusion_tables
from ..design.model import Design
from ..models import extrusion, gland, gland_range
from ..numeric import Array, maximum, minimum, real, where
from .allow import Stock
from .geometry import Geometry
from .rings import Ring
from .state import State
from .values import Values

EXTRUSION_TABLE = "sealanddesign"
"""Table of gaps over hardness and pressure for compounds that state none of their own."""


def metrics(
    v: Values,
    design: Design,
    stock: Stock,
    geometry: Geometry,
    state: State,
    ring: Ring,
    growth: Array,
) -> dict[str, Array]:
    """Gland metrics of a ring; `growth` is the largest of the bore over it.

    Squeeze and fill are those of the worst tolerances in heat and cold; side load pushes the rod
    over, so that one side has the clearance more and the other less.
    """
    clearance = geometry.piston_clearance if ring.name == "piston" else geometry.head_clearance
    aside = where(real(state.side_load) > 0, 1.0, 0.0) * clearance
    section = ring["section"]
    thin = gland.stretched_section(section=section, stretch=ring["stretch"])
    spread = {
        "section_tolerance": ring["section_tolerance"],
        "depth_tolerance": ring["tolerance"],
        "eccentricity": aside,
    }
    grown = 1 - (section * (1 - ring["squeeze"]) + growth) / thin
    loosest, _ = gland_range.squeeze_extremes(squeeze=grown, section=thin, **spread)
    _, tightest = gland_range.squeeze_extremes(squeeze=ring["squeeze"], section=section, **spread)
    fill = gland.gland_fill(
        section=thin,
        groove_width=ring["groove_width"],
        gland_depth=ring["gland_depth"] - ring["tolerance"],
    )
    cold, hot = _volumes(v, design, stock, ring)
    return {
        "seal_squeeze": gland_range.squeeze_at_volume(squeeze=loosest, volume_ratio=cold),
        "seal_squeeze_max": gland_range.squeeze_at_volume(squeeze=tightest, volume_ratio=hot),
        "seal_fill": fill * hot,
        "seal_stretch": ring["stretch"],
        "seal_section": section,
        "extrusion_factor": _extrusion(v, stock, ring, clearance + aside + growth),
    }


def _volumes(v: Values, design: Design, stock: Stock, ring: Ring) -> tuple[Array, Array]:
    """Ring over groove volume at the coldest and the hottest, relative to assembly."""
    expansion = stock.get(ring.element.compound, "volume_expansion")
    if design.environment is None or expansion is None:
        return 1.0, 1.0
    part = design.piston if ring.name == "piston" else design.head
    housing = stock.get(part.material, "thermal_expansion", default=0.0)
    ratios = [
        gland_range.volume_ratio(
            volume_expansion=expansion,
            housing_expansion=housing,
            temperature_change=v[f"environment.temperature_{end}"]
            - v["environment.assembly_temperature"],
            swell=0.0,
        )
        for end in ("min", "max")
    ]
    return minimum(*ratios), maximum(*ratios)


def _extrusion(v: Values, stock: Stock, ring: Ring, gap: Array) -> Array:
    """Largest gap that the seal or its back-up ring bears at supply pressure, over the gap."""
    pressure, element = v["supply.pressure"], ring.element
    own = stock.material(element.compound).properties.get("extrusion_gap_max")
    if own is None:
        allowed = extrusion.extrusion_gap_limit(
            hardness=v[f"materials.{element.compound}.hardness"],
            pressure=pressure,
            table=extrusion_tables()[EXTRUSION_TABLE].rows,
        )
    else:
        allowed = _stated(stock, element.compound, pressure)
    if element.back_up_material is not None:
        allowed = maximum(allowed, _stated(stock, element.back_up_material, pressure))
    return allowed / gap


def _stated(stock: Stock, name: str, pressure: Array) -> Array:
    """A material's own limit of the gap at a pressure; 0 where it states none."""
    limit = stock.material(name).properties.get("extrusion_gap_max")
    if limit is None:
        return 0.0
    scale = stock.get(name, "extrusion_gap_max") / limit.value
    if not limit.points:
        return scale * limit.value
    points = tuple(zip(limit.arguments, limit.values, strict=True))
    return scale * extrusion.gap_limit(pressure=pressure, points=points)


def extrusion_end(ring: Ring, stock: Stock) -> float:
    """Highest pressure at which a limit of the gap is known for a ring."""
    ends = []
    for name in (ring.element.compound, ring.element.back_up_material):
        limit = None if name is None else stock.material(name).properties.get("extrusion_gap_max")
        if limit is not None and limit.points:
            ends.append(limit.arguments[-1])
    if not ends:
        hardness = float(stock.get(ring.element.compound, "hardness"))
        table = extrusion_tables()[EXTRUSION_TABLE].rows
        ends.append(float(extrusion.extrusion_pressure_end(hardness=hardness, table=table)))
    return max(ends)
