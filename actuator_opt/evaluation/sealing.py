"""Piston and rod seals in an evaluation: squeeze after growth, contact, gap, friction, damping."""

from __future__ import annotations

from dataclasses import dataclass

from ..design.model import Design
from ..models import damping, friction, gland, seals
from ..numeric import Array, absolute, maximum, real, where
from .allow import Stock
from .barrel import SEAL_STEP, Wall
from .geometry import Geometry, Groove
from .rows import Computed
from .state import State
from .values import Values

STRIBECK_EXPONENT = 2.0
"""Shape of the Stribeck curve where no record says otherwise ([MECE5005], [Huang2017] Table 2)."""


@dataclass(frozen=True, slots=True)
class Friction:
    """Friction of all seals per case, N; `slope` is dF/dv at the case's speed, N·s/m."""

    running: Array
    breakaway: Array
    slope: Array


@dataclass(frozen=True, slots=True)
class _SealState:
    squeeze: Array
    youngs_modulus: Array
    coefficient: Array
    breakaway_ratio: Array
    stribeck_speed: Array
    pressure: Array
    growth: Array
    diameter: Array
    groove: Groove


def _seal_state(
    v: Values,
    design: Design,
    name: str,
    diameter: Array,
    groove: Groove,
    pressure: Array,
    growth: Array,
) -> _SealState:
    section = getattr(design.seals, name)
    compound = f"materials.{section.compound}."
    at = f"seals.{name}."

    def own(field: str) -> Array:
        return v[at + field] if at + field in v else v[compound + field]

    modulus = seals.MODULUS_LAWS[section.hardness_model].modulus(hardness=v[compound + "hardness"])
    return _SealState(
        squeeze=v[at + "squeeze"],
        youngs_modulus=modulus,
        coefficient=own("friction_coefficient"),
        breakaway_ratio=own("breakaway_ratio"),
        stribeck_speed=own("stribeck_speed"),
        pressure=pressure,
        growth=growth,
        diameter=diameter,
        groove=groove,
    )


def _gland_metrics(v: Values, name: str, state: _SealState, full_growth: Array) -> dict[str, Array]:
    at = f"seals.{name}."
    section, tolerance = state.groove.section, v[at + "tolerance"]
    thin = gland.stretched_section(section=section, stretch=v[at + "stretch"])
    return {
        "seal_squeeze": gland.squeeze_in_place(
            squeeze=state.squeeze,
            section=section,
            stretch=v[at + "stretch"],
            growth=full_growth,
            tolerance=tolerance,
        ),
        "seal_squeeze_max": state.squeeze + tolerance / section,
        "seal_fill": gland.gland_fill(
            section=thin,
            groove_width=state.groove.width,
            gland_depth=state.groove.gland_depth - tolerance,
        ),
        "seal_stretch": v[at + "stretch"],
        "seal_section": section,
    }


def _contact(law: seals.SealLaw, state: _SealState) -> tuple[Array, Array, Array]:
    """Line load of the whole row, contact width and peak pressure of the ring that seals.

    One ring of a row carries the pressure, the others only their squeeze.
    """
    squeeze = gland.squeeze_after(
        squeeze=state.squeeze, section=state.groove.section, growth=state.growth, tolerance=0.0
    )
    inputs = {
        "squeeze": squeeze,
        "section": state.groove.section,
        "youngs_modulus": state.youngs_modulus,
        "pressure": state.pressure,
    }
    width = gland.limited_width(
        contact_width=law.contact_width(**inputs), groove_width=state.groove.width
    )
    load = law.line_load(**inputs)
    if not isinstance(state.groove.count, float) or state.groove.count != 1.0:
        idle = law.line_load(**(inputs | {"pressure": 0.0 * state.pressure}))
        load = load + (state.groove.count - 1) * idle
    return load, width, law.peak_pressure(**inputs)


def compute(
    v: Values,
    design: Design,
    stock: Stock,
    geometry: Geometry,
    state: State,
    wall: Wall,
    out: Computed,
) -> Friction:
    """Gland, contact and friction metrics of both seals; returns the cylinder's friction."""
    full_growth = SEAL_STEP * wall.growth
    case_growth = SEAL_STEP * wall.case_growth
    parts = _both(v, design, geometry, state, case_growth)
    places: dict[str, dict[str, Array]] = {}
    total = Friction(0.0, 0.0, 0.0)
    for place, part in parts.items():
        name = place.split()[0]
        section = getattr(design.seals, name)
        grown = full_growth if name == "piston" else 0.0
        for metric, value in _gland_metrics(v, name, part, grown).items():
            places.setdefault(metric, {})[place] = value
        load, width, peak = _contact(seals.LAWS[section.law], part)
        places.setdefault("contact_width", {})[place] = width
        places.setdefault("contact_pressure", {})[place] = peak
        own = _friction(load, part, state.speed, v[f"seals.{name}.viscous_friction"])
        total = Friction(
            total.running + own.running, total.breakaway + own.breakaway, total.slope + own.slope
        )
        _extrusion(v, stock, section.compound, place, geometry, state, full_growth, places)
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


def _both(
    v: Values, design: Design, geometry: Geometry, state: State, case_growth: Array
) -> dict[str, _SealState]:
    """State of both seals in every case: the piston's sees the difference, the rod's p_B."""
    return {
        "piston seal": _seal_state(
            v,
            design,
            "piston",
            geometry.bore,
            geometry.piston_groove,
            absolute(state.moving_a - state.moving_b),
            case_growth,
        ),
        "rod seal": _seal_state(
            v,
            design,
            "rod",
            geometry.rod_diameter,
            geometry.rod_groove,
            maximum(state.moving_b, 0.0),
            0.0,
        ),
    }


def _friction(load: Array, part: _SealState, speed: Array, viscous: Array) -> Friction:
    """Friction of one row of seals: sliding where the case moves, Coulomb where it does not."""
    coulomb = friction.seal_friction(
        line_load=load, diameter=part.diameter, friction_coefficient=part.coefficient
    )
    static = friction.breakaway(running=coulomb, ratio=part.breakaway_ratio)
    curve = {
        "speed": speed,
        "coulomb": coulomb,
        "static": static,
        "stribeck_speed": part.stribeck_speed,
        "exponent": STRIBECK_EXPONENT,
    }
    sliding = friction.stribeck_level(**curve) + viscous * speed
    return Friction(
        running=where(real(speed) > 0, sliding, coulomb),
        breakaway=static,
        slope=friction.stribeck_slope(**curve, viscous=viscous),
    )


def _extrusion(
    v: Values,
    stock: Stock,
    compound: str,
    place: str,
    geometry: Geometry,
    state: State,
    growth: Array,
    places: dict[str, dict[str, Array]],
) -> None:
    """Largest gap the compound bears at supply pressure over the present one.

    Side load pushes piston and rod over: the gap of one side is then the clearance larger.
    """
    limit = stock.material(compound).properties.get("extrusion_gap_max")
    if limit is None:
        return
    clearance = geometry.piston_clearance if place == "piston seal" else geometry.head_clearance
    pushed = where(real(state.side_load) > 0, 2.0, 1.0)
    gap = gland.extrusion_gap(
        clearance=pushed * clearance, growth=growth if place == "piston seal" else 0.0
    )
    allowed = limit.at(v["supply.pressure"], value=stock.get(compound, "extrusion_gap_max"))
    places.setdefault("extrusion_factor", {})[place] = allowed / gap
