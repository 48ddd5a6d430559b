"""Piston and rod seals in an evaluation: squeeze after growth, contact, gap, friction, damping."""

from __future__ import annotations

from dataclasses import dataclass

from ..design.model import Design
from ..models import damping, friction, gland
from ..numeric import Array, maximum, real, where
from . import gland_check
from .allow import Stock
from .barrel import SEAL_STEP, Wall
from .film import Running
from .film_tables import Tables, running
from .geometry import Geometry
from .rings import Ring, places
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
    rings: tuple[Ring, ...],
    films: Tables,
    out: Computed,
) -> Friction:
    """Gland, contact and friction metrics of every seal; returns the cylinder's friction."""
    full_growth = SEAL_STEP * wall.growth
    by_metric: dict[str, dict[str, Array]] = {}
    total = Friction()
    for ring in rings:
        grown = full_growth if ring.name == "piston" else 0.0
        contact = touch(ring)
        rows = gland_check.metrics(v, design, stock, geometry, state, ring, grown) | {
            "contact_width": contact.width,
            "contact_pressure": contact.peak,
            "seal_wear": 2 * geometry.stroke * _mean_pressure(contact),
        }
        film = running(films, ring, "drive", len(v.cases))
        if ring.element.friction == "film":
            total = total + _lubricated(contact, ring, film)
        else:
            total = total + _friction(_row_load(ring, contact), ring, state.speed)
        if film is not None:
            rows["film_thickness"] = film.thickness
        for metric, value in rows.items():
            by_metric.setdefault(metric, {})[ring.label] = value
    total = total + _beside(v, geometry, state)
    for metric, by_place in by_metric.items():
        out.put(metric, by_place)
    _carried(geometry, rings, films, len(v.cases), state, out)
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


def _carried(
    geometry: Geometry,
    rings: tuple[Ring, ...],
    films: Tables,
    cases: int,
    state: State,
    out: Computed,
) -> None:
    """Oil that a double stroke of the rod leaves outside: dragged out less drawn back."""
    asked = 'needs the oil film: write "friction: film" in seals.rod'
    for ring in rings:
        there, back = (running(films, ring, stroke, cases) for stroke in ("drive", "return"))
        if ring.label != "rod seal" or there is None or back is None:
            continue
        moving = real(state.speed) > 0
        time = geometry.stroke / where(moving, state.speed, 1.0)
        lost = maximum((there.flow + back.flow) * time, 0.0)
        out.put("rod_leakage", lost, cases=moving[:, 0])
    for name in ("film_thickness", "rod_leakage", "inter_seal_pressure"):
        if name not in out.metrics:
            out.skip(name, asked)


def _mean_pressure(contact: Touch) -> Array:
    """Line load over width; 0 without contact."""
    touching = real(contact.width) > 0
    return where(touching, contact.line_load / where(touching, contact.width, 1.0), 0.0)


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


def _lubricated(contact: Touch, ring: Ring, film: Running | None) -> Friction:
    """Friction of a seal on its oil film; at rest all oil is squeezed out and the face is dry."""
    coefficient = ring["asperity_friction"]
    dry = friction.seal_friction(
        line_load=contact.line_load, diameter=ring["diameter"], friction_coefficient=coefficient
    )
    if film is None:
        return Friction(dry, dry, 0.0)
    sliding = film.viscous + coefficient * film.load
    slope = film.viscous_slope + coefficient * film.load_slope
    return Friction(where(real(ring["speed"]) > 0, sliding, dry), dry, slope)


def _beside(v: Values, geometry: Geometry, state: State) -> Friction:
    """Coulomb friction of guide rings under the side load."""
    total: Array = 0.0
    carried = side_reactions(geometry, state)
    for name, grooves, _ in places(geometry):
        for groove in grooves:
            if groove.role == "guide":
                total = total + v[f"{groove.path}friction_coefficient"] * carried[name]
    return Friction(total, total, 0.0)
