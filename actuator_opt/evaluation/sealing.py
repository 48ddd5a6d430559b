"""Piston and rod seals in an evaluation: squeeze after growth, contact, gap, friction, damping."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ..design.model import Design
from ..models import damping, friction, gland
from ..numeric import Array, absolute, maximum, real, where
from .allow import Stock
from .barrel import SEAL_STEP, Wall
from .geometry import Geometry
from .grooves import Groove
from .rings import Ring, contact, ring, wiper_load
from .rows import Computed
from .state import State, side_reactions
from .values import Values

STRIBECK_EXPONENT = 2.0
"""Shape of the Stribeck curve where no record says otherwise ([MECE5005], [Huang2017] Table 2)."""

Place = Literal["piston", "rod"]


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


@dataclass(frozen=True, slots=True)
class Sealed:
    """One sealing element under its load: pressure difference and bore growth, by case."""

    ring: Ring
    pressure: Array
    growth: Array

    @property
    def squeeze(self) -> Array:
        """Nominal squeeze less what the bore's growth takes."""
        return gland.squeeze_after(
            squeeze=self.ring.squeeze,
            section=self.ring.groove.section,
            growth=self.growth,
            tolerance=0.0,
        )


def sealed(
    v: Values, design: Design, stock: Stock, geometry: Geometry, state: State, growth: Array
) -> list[Sealed]:
    """Every sealing element; the first of a place carries the pressure.

    The piston's sees the difference, the rod's p_B. `growth` is the bore's at the piston seal.
    """
    across = {
        "piston": absolute(state.moving_a - state.moving_b),
        "rod": maximum(state.moving_b, 0.0),
    }
    found = []
    for name, grooves, diameter in _places(geometry):
        seal = getattr(design.seals, name)
        elements = seal.elements()
        grown = growth if name == "piston" else 0.0
        for groove in grooves:
            if groove.role != "element":
                continue
            tail = groove.path.removeprefix(f"seals.{name}.")
            part = ring(v, stock, name, elements[tail], groove, diameter, state.temperature)
            pressure = across[name] if tail == "" else 0.0 * across[name]
            found.append(Sealed(part, pressure, grown))
    return found


def _places(g: Geometry) -> list[tuple[Place, tuple[Groove, ...], Array]]:
    return [("piston", g.piston_grooves, g.bore), ("rod", g.rod_grooves, g.rod_diameter)]


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
    places: dict[str, dict[str, Array]] = {}
    total = Friction()
    for part in sealed(v, design, stock, geometry, state, SEAL_STEP * wall.case_growth):
        place = part.ring.groove.place
        grown = full_growth if part.ring.name == "piston" else 0.0
        load, width, peak = _contact(part)
        own = _friction(load, part.ring, state.speed)
        total = total + own
        rows = _gland_metrics(v, part.ring, grown) | {
            "contact_width": width,
            "contact_pressure": peak,
        }
        for metric, value in rows.items():
            places.setdefault(metric, {})[place] = value
        _extrusion(v, stock, part, geometry, state, grown, places)
    total = total + _beside(v, design, stock, geometry, state)
    for metric, by_place in places.items():
        out.put(metric, by_place)
    if "extrusion_factor" not in places:
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


def _gland_metrics(v: Values, part: Ring, growth: Array) -> dict[str, Array]:
    groove = part.groove
    section, tolerance = groove.section, v[groove.path + "tolerance"]
    stretch = v[groove.path + "stretch"]
    thin = gland.stretched_section(section=section, stretch=stretch)
    return {
        "seal_squeeze": gland.squeeze_in_place(
            squeeze=part.squeeze,
            section=section,
            stretch=stretch,
            growth=growth,
            tolerance=tolerance,
        ),
        "seal_squeeze_max": part.squeeze + tolerance / section,
        "seal_fill": gland.gland_fill(
            section=thin,
            groove_width=groove.width,
            gland_depth=groove.gland_depth - tolerance,
        ),
        "seal_stretch": stretch,
        "seal_section": section,
    }


def _contact(part: Sealed) -> tuple[Array, Array, Array]:
    """Line load of the whole row, contact width and peak pressure of the ring that seals.

    One ring of a row carries the pressure, the others only their squeeze.
    """
    touch = contact(part.ring, squeeze=part.squeeze, pressure=part.pressure)
    count = part.ring.groove.count
    load = touch.line_load
    if not isinstance(count, float) or count != 1.0:
        idle = contact(part.ring, squeeze=part.squeeze, pressure=0.0 * part.pressure)
        load = load + (count - 1) * idle.line_load
    return load, touch.width, touch.peak


def _friction(load: Array, part: Ring, speed: Array) -> Friction:
    """Friction of one row of seals: sliding where the case moves, Coulomb where it does not."""
    coulomb = friction.seal_friction(
        line_load=load, diameter=part.diameter, friction_coefficient=part.friction_coefficient
    )
    static = friction.breakaway(running=coulomb, ratio=part.breakaway_ratio)
    curve = {
        "speed": speed,
        "coulomb": coulomb,
        "static": static,
        "stribeck_speed": part.stribeck_speed,
        "exponent": STRIBECK_EXPONENT,
    }
    sliding = friction.stribeck_level(**curve) + part.viscous * speed
    return Friction(
        running=where(real(speed) > 0, sliding, coulomb),
        breakaway=static,
        slope=friction.stribeck_slope(**curve, viscous=part.viscous),
    )


def _beside(v: Values, design: Design, stock: Stock, geometry: Geometry, state: State) -> Friction:
    """Coulomb friction of wipers and of guide rings under the side load."""
    total: Array = 0.0
    carried = side_reactions(geometry, state)
    for name, grooves, diameter in _places(geometry):
        for groove in grooves:
            if groove.role == "guide":
                total = total + v[groove.path + "friction_coefficient"] * carried[name]
            elif groove.role == "wiper":
                load, coefficient = wiper_load(v, stock, groove, diameter, state.temperature)
                total = total + friction.seal_friction(
                    line_load=load, diameter=diameter, friction_coefficient=coefficient
                )
    return Friction(total, total, 0.0)


def _extrusion(
    v: Values,
    stock: Stock,
    part: Sealed,
    geometry: Geometry,
    state: State,
    growth: Array,
    places: dict[str, dict[str, Array]],
) -> None:
    """Largest gap the compound bears at supply pressure over the present one.

    Side load pushes piston and rod over: the gap of one side is then the clearance larger.
    """
    compound = part.ring.element.compound
    limit = stock.material(compound).properties.get("extrusion_gap_max")
    if limit is None:
        return
    piston = part.ring.name == "piston"
    clearance = geometry.piston_clearance if piston else geometry.head_clearance
    pushed = where(real(state.side_load) > 0, 2.0, 1.0)
    gap = gland.extrusion_gap(clearance=pushed * clearance, growth=growth)
    allowed = limit.at(v["supply.pressure"], value=stock.get(compound, "extrusion_gap_max"))
    places.setdefault("extrusion_factor", {})[part.ring.groove.place] = allowed / gap
