"""Oil damping, leakage, flow and line losses in an evaluation."""

from __future__ import annotations

from ..base.numeric import Array, absolute, maximum, real, where
from ..design.model import Design
from ..friction.law import Friction
from ..models import damping, elements, forces, lines, transmission_line
from .circuit import wall_compliance
from .film import Running
from .geometry import Geometry
from .limits import MetricArrays
from .state import LoadState
from .values import Values


def compute_damping(
    geometry: Geometry, state: LoadState, friction: Friction, out: MetricArrays
) -> Array:
    """Oil damping (pipe form and annular gaps); returns the total incremental damping."""
    g = geometry
    viscosity = 0.5 * (state.dynamic_viscosity_a + state.dynamic_viscosity_b)
    pipe = damping.pipe_flow(dynamic_viscosity=viscosity, length=g.stroke)
    piston = damping.annular_couette(
        dynamic_viscosity=viscosity,
        length=g.piston_length,
        inner_radius=g.inner_radius - g.piston_clearance,
        outer_radius=g.inner_radius,
    )
    head = damping.annular_couette(
        dynamic_viscosity=0.5 * (state.dynamic_viscosity_b + state.dynamic_viscosity),
        length=g.head_length,
        inner_radius=g.rod_diameter / 2,
        outer_radius=g.rod_diameter / 2 + g.head_clearance,
    )
    out.put("damping_pipe", pipe)
    out.put("damping_annular", piston + head)
    return friction.slope + pipe + piston + head


def compute_leakage(
    v: Values,
    design: Design,
    geometry: Geometry,
    state: LoadState,
    film: Running | None,
    out: MetricArrays,
) -> Array:
    """Leakage across the moving piston; returns its conductance.

    Sum of the stated conductance, the oil film of the seal, and the gap of a piston without seals,
    widened by bore growth. The flow of a film is taken at the speed of the case; a film that draws
    oil back to the driven side counts as tight.
    """
    path = "piston.leakage_conductance"
    conductance = v[path]
    across = absolute(state.moving_a - state.moving_b)
    bare = design.seals.piston.count == 0
    if bare:
        g = geometry
        conductance = conductance + damping.gap_conductance(
            diameter=g.bore,
            gap=g.piston_clearance + out.metrics["growth_at_seal"][""],
            dynamic_viscosity=0.5 * (state.dynamic_viscosity_a + state.dynamic_viscosity_b),
            length=g.piston_length,
        )
    elif film is not None:
        moving = real(state.speed) > 0
        divisor = where(real(across) > 0, across, 1.0)
        passed = where(moving & (real(across) > 0), maximum(film.flow, 0.0), 0.0)
        conductance = conductance + passed / divisor
    if bare or film is not None or path in v.varied or design.piston.leakage_conductance > 0:
        running = None if film is None else real(state.speed)[:, 0] > 0
        out.put("leakage", conductance * across, cases=running)
    else:
        out.skip(
            "leakage",
            'needs the oil film: write "friction: film" in seals.piston, or state '
            "piston.leakage_conductance",
        )
    return conductance


LINE_METRICS = (
    "line_velocity",
    "line_pressure_drop",
    "line_drop_ratio",
    "line_hammer",
    "line_resonance",
)


def compute_flow(
    v: Values, design: Design, geometry: Geometry, state: LoadState, out: MetricArrays
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
    if design.lines:
        _compute_lines(v, design, state, flow, out)
    else:
        for name in LINE_METRICS:
            out.skip(name, "no lines stated: add lines")


def _compute_lines(
    v: Values, design: Design, state: LoadState, flow: dict[str, Array], out: MetricArrays
) -> None:
    """Velocity, pressure drop, hammer and resonance of the lines, by flow of their chamber."""
    velocity, drop, hammer = {}, {}, {}
    lengths: dict[str, Array] = {}
    times: dict[str, Array] = {}  # travel time of a wave through the lines of a chamber
    modulus = {"a": state.bulk_modulus_a, "b": state.bulk_modulus_b}
    viscosity = {"a": state.dynamic_viscosity_a, "b": state.dynamic_viscosity_b}
    for i, line in enumerate(design.lines):
        at, place = f"lines[{i}].", f"line {line.chamber} [{i}]"
        inner = v[at + "inner_diameter"]
        velocity[place] = lines.line_velocity(flow=flow[line.chamber], inner_diameter=inner)
        drop[place] = lines.line_pressure_drop(
            flow=flow[line.chamber],
            inner_diameter=inner,
            length=v[at + "length"],
            density=state.density,
            dynamic_viscosity=viscosity[line.chamber],
        )
        size = {"inner_diameter": inner, "length": v[at + "length"]}
        speed = transmission_line.wave_speed(
            bulk_modulus=modulus[line.chamber],
            density=state.density,
            volume=lines.line_volume(**size),
            wall_compliance=wall_compliance(v, line, at),
        )
        hammer[place] = transmission_line.joukowsky_pressure(
            density=state.density, sound_speed=speed, velocity_change=velocity[place]
        )
        chamber = f"lines of chamber {line.chamber}"
        lengths[chamber] = lengths.get(chamber, 0.0) + v[at + "length"]
        times[chamber] = times.get(chamber, 0.0) + v[at + "length"] / speed
    out.put("line_hammer", hammer)
    out.put(
        "line_resonance",
        {
            chamber: elements.quarter_wave_frequency(
                length=length, sound_speed=length / times[chamber]
            )
            for chamber, length in lengths.items()
        },
    )
    out.put("line_velocity", velocity)
    out.put("line_pressure_drop", drop)
    supply = v["supply.pressure"]
    out.put("line_drop_ratio", {place: value / supply for place, value in drop.items()})
