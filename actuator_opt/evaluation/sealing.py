"""Piston and rod seals in an evaluation: squeeze after growth, contact, gap, friction, damping."""

from __future__ import annotations

from dataclasses import dataclass

from ..design.model import Design
from ..models import damping, friction, gland
from ..numeric import Array, real, where
from .allow import Stock
from .barrel import SEAL_STEP, Wall
from .geometry import Geometry
from .rings import Ring, places, rings
from .rows import Computed
from .state import State, side_reactions
from .touch import Touch, touch
from .values import Values

STRIBECK_EXPONENT = 2.0
"""Shape of the Stribeck curve where no record says otherwise ([MECE5005], [Huang2017] Table 2)."""


@dataclass(frozen=True, slots=True)
class Friction:
    """Friction per case, N; `slope` is dF/dv at the case's speed, N·s/m."""

    running: Array = 0.0
    breakaway: Array = 0.0
    slope: Array = 0.0

    def __add__(self, other: Friction) -> Friction:
        return Friction(
            self.running + other.running,
            self.breakaway + other.breakaway,
            self.slope + other.slope,
        )


def compute(
    v: Values,
    design: Design,
    stock: Stock,
    geometry: Geometry,
    state: State,
    wall: Wall,
    out: Computed,
) -> Friction:
    """Gland, contact and friction metrics of every seal; returns the cylinder's friction."""
    full_growth = SEAL_STEP * wall.growth
    by_metric: dict[str, dict[str, Array]] = {}
    total = Friction()
    for ring in rings(v, design, stock, geometry, state, SEAL_STEP * wall.case_growth):
        grown = full_growth if ring.name == "piston" else 0.0
        contact = touch(ring)
        total = total + _friction(_row_load(ring, contact), ring, state.speed)
        rows = _gland_metrics(ring, grown) | {
            "contact_width": contact.width,
            "contact_pressure": contact.peak,
        }
        rows |= _extrusion(v, stock, ring, geometry, state, grown)
        for metric, value in rows.items():
            by_metric.setdefault(metric, {})[ring.label] = value
    total = total + _beside(v, geometry, state)
    for metric, by_place in by_metric.items():
        out.put(metric, by_place)
    if "extrusion_factor" not in by_metric:
        out.skip("extrusion_factor", "the seal compounds state no extrusion_gap_max")
    gap = gland.extrusion_gap(clearance=geometry.piston_clearance, growth=full_growth)
    out.put("seal_gap", gap)
    out.put("growth_at_seal", full_growth)
    out.put("friction_running", total.running)
    out.put("friction_breakaway", total.breakaway)
    moving = real(state.speed)[:, 0] > 0
    secant = damping.secant(friction=total.running, speed=state.speed)
    out.put("damping_seal", secant, cases=moving)
    if not moving.any():
        out.skip("damping_seal", "a secant damping needs a speed; no load case states one")
    return total


def _gland_metrics(ring: Ring, growth: Array) -> dict[str, Array]:
    section, tolerance, stretch = ring["section"], ring["tolerance"], ring["stretch"]
    return {
        "seal_squeeze": gland.squeeze_in_place(
            squeeze=ring["squeeze"],
            section=section,
            stretch=stretch,
            growth=growth,
            tolerance=tolerance,
        ),
        "seal_squeeze_max": ring["squeeze"] + tolerance / section,
        "seal_fill": gland.gland_fill(
            section=gland.stretched_section(section=section, stretch=stretch),
            groove_width=ring["groove_width"],
            gland_depth=ring["gland_depth"] - tolerance,
        ),
        "seal_stretch": stretch,
        "seal_section": section,
    }


def _row_load(ring: Ring, contact: Touch) -> Array:
    """Line load of a whole row: one ring carries the pressure, the others only their squeeze."""
    count = ring["count"]
    if isinstance(count, float) and count == 1.0:
        return contact.line_load
    idle = touch(ring.at(pressure=0.0 * ring["pressure"]))
    return contact.line_load + (count - 1) * idle.line_load


def _friction(load: Array, ring: Ring, speed: Array) -> Friction:
    """Friction of one row of seals: sliding where the case moves, Coulomb where it does not."""
    coulomb = friction.seal_friction(
        line_load=load,
        diameter=ring["diameter"],
        friction_coefficient=ring["friction_coefficient"],
    )
    static = friction.breakaway(running=coulomb, ratio=ring["breakaway_ratio"])
    curve = {
        "speed": speed,
        "coulomb": coulomb,
        "static": static,
        "stribeck_speed": ring["stribeck_speed"],
        "exponent": STRIBECK_EXPONENT,
    }
    viscous = ring["viscous_friction"]
    sliding = friction.stribeck_level(**curve) + viscous * speed
    return Friction(
        running=where(real(speed) > 0, sliding, coulomb),
        breakaway=static,
        slope=friction.stribeck_slope(**curve, viscous=viscous),
    )


def _beside(v: Values, geometry: Geometry, state: State) -> Friction:
    """Coulomb friction of guide rings under the side load."""
    total: Array = 0.0
    carried = side_reactions(geometry, state)
    for name, grooves, _ in places(geometry):
        for groove in grooves:
            if groove.role == "guide":
                total = total + v[f"{groove.path}friction_coefficient"] * carried[name]
    return Friction(total, total, 0.0)


def _extrusion(
    v: Values, stock: Stock, ring: Ring, geometry: Geometry, state: State, growth: Array
) -> dict[str, Array]:
    """Largest gap the compound bears at supply pressure over the present one.

    Side load pushes piston and rod over: the gap of one side is then the clearance larger.
    """
    compound = ring.element.compound
    limit = stock.material(compound).properties.get("extrusion_gap_max")
    if limit is None:
        return {}
    clearance = geometry.piston_clearance if ring.name == "piston" else geometry.head_clearance
    pushed = where(real(state.side_load) > 0, 2.0, 1.0)
    gap = gland.extrusion_gap(clearance=pushed * clearance, growth=growth)
    allowed = limit.at(v["supply.pressure"], value=stock.get(compound, "extrusion_gap_max"))
    return {"extrusion_factor": allowed / gap}
