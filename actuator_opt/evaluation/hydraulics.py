"""Stiffness along the stroke, frequency, oil damping, flow and end stop in an evaluation."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

from ..design.model import Design
from ..models import damping, dynamics, forces, lines, rod, stiffness
from ..numeric import Array
from .geometry import Geometry
from .rows import Computed
from .sealing import Friction
from .state import State
from .values import Values
from .wall import Wall


@dataclass(frozen=True, slots=True)
class Chambers:
    """Compliance of both chambers, C = fixed + per_length · chamber length, by cause.

    Each entry is (fixed, per_length) for `oil`, `barrel` and `lines`.
    """

    a: dict[str, tuple[Array, Array]]
    b: dict[str, tuple[Array, Array]]

    def total(self, side: str) -> tuple[Array, Array]:
        """Compliance of one chamber (fixed, per length) of all causes."""
        entries = list((self.a if side == "a" else self.b).values())
        return sum(e[0] for e in entries), sum(e[1] for e in entries)


@dataclass(frozen=True, slots=True)
class Springs:
    """Everything that gives way between load and ground."""

    chambers: Chambers
    rod: Array
    mount: Array | None
    geometry: Geometry

    def hydraulic(self, position: Array, causes: tuple[str, ...]) -> Array:
        """Stiffness of the chambers at a position, counting only some causes."""
        g = self.geometry
        length_b = g.stroke - position
        compliance_a = sum(self.chambers.a[c][0] + self.chambers.a[c][1] * position for c in causes)
        compliance_b = sum(self.chambers.b[c][0] + self.chambers.b[c][1] * length_b for c in causes)
        return stiffness.hydraulic_stiffness(
            area_a=g.area_a, compliance_a=compliance_a, area_b=g.area_b, compliance_b=compliance_b
        )

    def compliances(self, position: Array) -> dict[str, Array]:
        """Compliance by part at a position (m/N); they add up to 1/stiffness.

        Barrel and lines are what they add to the compliance of oil alone, in this order.
        """
        oil = 1 / self.hydraulic(position, ("oil",))
        with_barrel = 1 / self.hydraulic(position, ("oil", "barrel"))
        full = 1 / self.hydraulic(position, ("oil", "barrel", "lines"))
        parts = {
            "oil": oil,
            "barrel": with_barrel - oil,
            "lines": full - with_barrel,
            "rod": 1 / self.rod,
        }
        if self.mount is not None:
            parts["mount"] = 1 / self.mount
        return parts


def springs(v: Values, design: Design, geometry: Geometry, state: State, wall: Wall) -> Springs:
    """Compliance of chambers, lines, rod and mount."""
    g = geometry
    volume = {"a": v["cylinder.dead_volume_a"], "b": v["cylinder.dead_volume_b"]}
    volume["b"] = volume["b"] + g.area_b * (
        g.barrel_length - g.piston_length - g.head_length - g.stroke
    )
    give: dict[str, Array] = {"a": 0.0, "b": 0.0}
    for i, line in enumerate(design.lines):
        at, material = f"lines[{i}].", f"materials.{line.material}."
        size = {"inner_diameter": v[at + "inner_diameter"], "length": v[at + "length"]}
        volume[line.chamber] = volume[line.chamber] + lines.line_volume(**size)
        give[line.chamber] = give[line.chamber] + lines.line_compliance(
            **size,
            outer_diameter=v[at + "outer_diameter"],
            youngs_modulus=v[material + "youngs_modulus"],
            poissons_ratio=v[material + "poissons_ratio"],
        )
    per_length = 2 * pi * g.inner_radius * (wall.growth / v["supply.pressure"])
    sides = {}
    for side, area, bulk in (
        ("a", g.area_a, state.bulk_modulus_a),
        ("b", g.area_b, state.bulk_modulus_b),
    ):
        sides[side] = {
            "oil": (volume[side] / bulk, area / bulk),
            "barrel": (0.0, per_length),
            "lines": (give[side], 0.0),
        }
    modulus = v[f"materials.{design.rod.material}.youngs_modulus"]
    return Springs(
        chambers=Chambers(sides["a"], sides["b"]),
        rod=rod.axial_stiffness(
            youngs_modulus=modulus,
            outer_diameter=g.rod_diameter,
            inner_diameter=g.rod_inner_diameter,
            length=g.rod_length,
        ),
        mount=v.get("cylinder.mount_stiffness", None),
        geometry=g,
    )


def weakest(s: Springs) -> Array:
    """Position of least stiffness in every case."""
    a0, a1 = s.chambers.total("a")
    b0, b1 = s.chambers.total("b")
    return stiffness.weakest_position(
        area_a=s.geometry.area_a,
        area_b=s.geometry.area_b,
        compliance_a0=a0,
        compliance_a_per_length=a1,
        compliance_b0=b0,
        compliance_b_per_length=b1,
        stroke=s.geometry.stroke,
    )


def compute_stiffness(s: Springs, moving_mass: Array, out: Computed) -> Array:
    """Stiffness and frequency metrics; returns the least stiffness."""
    parts = s.compliances(weakest(s))
    total = 1 / sum(parts.values())
    out.put("stiffness_min", total)
    out.put("stiffness_oil", 1 / parts["oil"])
    out.put("stiffness_barrel", 1 / parts["barrel"])
    out.put("stiffness_rod", s.rod)
    out.put("natural_frequency", dynamics.natural_frequency(stiffness=total, mass=moving_mass))
    return total


def compute_damping(
    v: Values,
    geometry: Geometry,
    state: State,
    friction: Friction,
    stiffness_min: Array,
    moving_mass: Array,
    out: Computed,
) -> None:
    """Oil damping (pipe form and annular gaps) and the damping ratio of the load."""
    g, viscosity = geometry, state.dynamic_viscosity
    pipe = damping.pipe_flow(dynamic_viscosity=viscosity, length=g.stroke)
    piston = damping.annular_couette(
        dynamic_viscosity=viscosity,
        length=g.piston_length,
        inner_radius=g.inner_radius - g.piston_clearance,
        outer_radius=g.inner_radius,
    )
    head = damping.annular_couette(
        dynamic_viscosity=viscosity,
        length=g.head_length,
        inner_radius=g.rod_diameter / 2,
        outer_radius=g.rod_diameter / 2 + g.head_clearance,
    )
    out.put("damping_pipe", pipe)
    out.put("damping_annular", piston + head)
    out.put(
        "damping_ratio",
        dynamics.friction_damping_ratio(
            incremental_damping=friction.slope + pipe + piston + head,
            stiffness=stiffness_min,
            mass=moving_mass,
        ),
    )


def compute_flow(
    v: Values, design: Design, geometry: Geometry, state: State, out: Computed
) -> None:
    """Flow, port and line velocities and pressure drop."""
    flow = {
        "a": forces.chamber_flow(area=geometry.area_a, speed=state.speed),
        "b": forces.chamber_flow(area=geometry.area_b, speed=state.speed),
    }
    out.put("flow", flow["a"])
    out.put("piston_speed", state.speed)
    out.put("oil_viscosity", state.kinematic_viscosity)
    if "cylinder.port_diameter" in v:
        port = v["cylinder.port_diameter"]
        out.put("port_velocity", lines.port_velocity(flow=flow["a"], port_diameter=port))
    else:
        out.skip("port_velocity", "no port stated: add cylinder.port_diameter")
    if not design.lines:
        for name in ("line_velocity", "line_pressure_drop", "line_drop_ratio"):
            out.skip(name, "no lines stated: add lines")
        return
    velocity, drop = {}, {}
    for i, line in enumerate(design.lines):
        at, place = f"lines[{i}].", f"line {line.chamber} [{i}]"
        inner = v[at + "inner_diameter"]
        velocity[place] = lines.line_velocity(flow=flow[line.chamber], inner_diameter=inner)
        drop[place] = lines.line_pressure_drop(
            flow=flow[line.chamber],
            inner_diameter=inner,
            length=v[at + "length"],
            density=state.density,
            dynamic_viscosity=state.dynamic_viscosity,
        )
    out.put("line_velocity", velocity)
    out.put("line_pressure_drop", drop)
    supply = v["supply.pressure"]
    out.put("line_drop_ratio", {place: value / supply for place, value in drop.items()})
