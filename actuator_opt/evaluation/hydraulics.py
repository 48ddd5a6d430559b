"""Stiffness along the stroke, frequency, oil damping, flow and end stop in an evaluation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import NamedTuple

from ..design.model import Design
from ..models import damping, dynamics, forces, lines, stiffness
from ..numeric import Array
from .barrel import Wall
from .geometry import Geometry
from .rods import Rod
from .rows import Computed
from .sealing import Friction
from .state import State
from .values import Values


class Give(NamedTuple):
    """One cause of compliance along the piston's position x.

    Of chamber A a0 + a1 x, of chamber B b0 + b1 (s - x); c0 + c1 x is what the pressure of one adds
    to the volume of the other.
    """

    a0: Array = 0.0
    a1: Array = 0.0
    b0: Array = 0.0
    b1: Array = 0.0
    c0: Array = 0.0
    c1: Array = 0.0


CAUSES = ("oil", "barrel", "stretch", "lines")
"""What gives in the chambers, in the order their shares are told."""


@dataclass(frozen=True, slots=True)
class Springs:
    """Everything that gives way between load and ground; chambers by cause."""

    chambers: dict[str, Give]
    rod: Array
    mount: Array | None
    geometry: Geometry
    rod_place: str = ""

    def total(self, causes: Sequence[str] = CAUSES) -> Give:
        """Compliance of some causes together."""
        chosen = [self.chambers[cause] for cause in causes]
        return Give(*(sum(part[1:], start=part[0]) for part in zip(*chosen, strict=True)))

    def hydraulic(self, position: Array, causes: Sequence[str]) -> Array:
        """Stiffness of the chambers at a position, counting only some causes."""
        g, give = self.geometry, self.total(causes)
        return stiffness.hydraulic_stiffness(
            area_a=g.area_a,
            compliance_a=give.a0 + give.a1 * position,
            area_b=g.area_b,
            compliance_b=give.b0 + give.b1 * (g.stroke - position),
            compliance_ab=give.c0 + give.c1 * position,
        )

    def compliances(self, position: Array) -> dict[str, Array]:
        """Compliance by part at a position (m/N); they add up to 1/stiffness.

        Barrel (swelling), its axial stretch and lines are what they add to the compliance of the
        parts before them.
        """
        parts: dict[str, Array] = {}
        before: Array = 0.0
        for i, cause in enumerate(CAUSES):
            now = 1 / self.hydraulic(position, CAUSES[: i + 1])
            parts[cause] = now - before
            before = now
        parts["rod"] = 1 / self.rod
        if self.mount is not None:
            parts["mount"] = 1 / self.mount
        return parts


def _stretch(design: Design, g: Geometry, wall: Wall, extra: Array) -> Give:
    """Axial stretch of the barrel under the pressure of the chamber that pulls on it.

    Cap-mounted, N = p_B A_B over the whole length: the head moves by e_N L N + e_p (x p_A +
    y p_B), and N narrows both chambers by e_p N per length; e_p is the strain per pressure, y the
    wetted length of chamber B, the rest of the stroke and what the barrel is longer (`extra`).
    Head-mounted, the same with p_A A_A. Tie rods take their share of N.
    """
    shortening = wall.swelling.shortening * wall.path.share
    cap = design.cylinder.mount.startswith("cap")
    area = g.area_b if cap else g.area_a
    own = area * area * wall.swelling.stretch * wall.path.share * g.barrel_length
    twice, once = 2 * shortening * area, shortening * area
    if cap:
        return Give(b0=own + twice * extra, b1=twice, c1=once)
    return Give(a0=own, a1=twice, c0=once * (g.stroke + extra), c1=-once)


def springs(
    v: Values, design: Design, geometry: Geometry, state: State, wall: Wall, rod: Rod
) -> Springs:
    """Compliance of chambers, lines, rod and mount."""
    g = geometry
    volume = {"a": v["cylinder.dead_volume_a"], "b": v["cylinder.dead_volume_b"]}
    extra = g.barrel_length - g.piston_length - g.head_length - g.stroke
    volume["b"] = volume["b"] + g.area_b * extra
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
    swelling = 2 * pi * g.inner_radius * wall.swelling.growth
    oil_a, oil_b = state.bulk_modulus_a, state.bulk_modulus_b
    return Springs(
        chambers={
            "oil": Give(
                a0=volume["a"] / oil_a,
                a1=g.area_a / oil_a,
                b0=volume["b"] / oil_b,
                b1=g.area_b / oil_b,
            ),
            "barrel": Give(a1=swelling, b0=swelling * extra, b1=swelling),
            "stretch": _stretch(design, g, wall, extra),
            "lines": Give(a0=give["a"], b0=give["b"]),
        },
        rod=rod.axial_stiffness / g.rod_length,
        mount=v.get("cylinder.mount_stiffness", None),
        geometry=g,
        rod_place=rod.place,
    )


def weakest(s: Springs) -> Array:
    """Position of least stiffness in every case."""
    give = s.total()
    return stiffness.weakest_position(
        area_a=s.geometry.area_a,
        area_b=s.geometry.area_b,
        compliance_a0=give.a0,
        compliance_a_per_length=give.a1,
        compliance_b0=give.b0,
        compliance_b_per_length=give.b1,
        stroke=s.geometry.stroke,
        compliance_ab0=give.c0,
        compliance_ab_per_length=give.c1,
    )


def compute_stiffness(s: Springs, moving_mass: Array, out: Computed) -> Array:
    """Stiffness and frequency metrics; returns the least stiffness."""
    parts = s.compliances(weakest(s))
    total = 1 / sum(parts.values())
    out.put("stiffness_min", total)
    out.put("stiffness_oil", 1 / parts["oil"])
    out.put("stiffness_barrel", 1 / parts["barrel"])
    out.put("stiffness_rod", {s.rod_place: s.rod})
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
