"""Films between smooth surfaces: fixed gap, loaded slider, or elastic back-up ring on a rod."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ..base.dataclass import dataclass
from .film import outputs
from .newton import Bed, FilmState, NewtonResult, follow, kernel, newton, weights
from .reynolds import Elastic, Lubricant, ReynoldsProblem, Vector

_NARROWEST = 0.04
"""Smallest width of the initial elliptic pressure, stated as the square of (half width / width of
the face)."""
_FASTER = (1.0, 30.0)
"""A loaded film is first solved at a multiple of the stated speed, then at the stated speed. These
multiples are tried in turn; a larger one gives a thicker initial film."""


@dataclass(frozen=True, slots=True)
class SmoothFilm:
    """A solved film between smooth surfaces, or the reason for a failure.

    Forces are per unit length of circumference.
    """

    converged: bool
    reason: str
    x: Vector  # [m]
    pressure: Vector  # absolute [Pa]
    cavitated_fraction: Vector  # [-]
    film: Vector  # h [m]
    viscous_drag: float  # on the rod, positive against a positive speed [N/m]
    line_load: float  # int p dx, absolute [N/m]
    flow: float  # [m^2/s]
    load_residual: float
    mass_residual: float
    iterations: int


@dataclass(frozen=True, slots=True)
class Gap:
    """A smooth gap between a seal or ring and the rod. Pressures are absolute.

    Parameters
    ----------
    width : width of the face [m]
    profile : height of the unloaded face above the rod at uniform nodes [m]; unless the gap is
        fixed, a constant that is added to all heights has no effect
    lubricant : oil
    speed : rod speed [m/s], positive in the outstroke
    sealed_pressure, outer_pressure : pressures at the ends [Pa]
    line_load : load on the film, int p dx [N/m]; None for a fixed gap
    elastic : elasticity of the ring; None for a rigid ring
    cavitation_pressure : pressure below which the oil film ruptures [Pa]
    """

    width: float
    profile: Vector
    lubricant: Lubricant
    speed: float
    sealed_pressure: float
    outer_pressure: float
    line_load: float | None = None
    elastic: Elastic | None = None
    cavitation_pressure: float = 0.0


def fault(gap: Gap) -> str:
    """Reason why a gap is invalid, in one line; empty if it is valid."""
    for name, value in (
        ("width", gap.width),
        ("viscosity", gap.lubricant.dynamic_viscosity),
        ("least film of a fixed gap", np.min(gap.profile) if gap.line_load is None else 1.0),
    ):
        if not value > 0:
            return f"{name} {value:g}: must be above zero"
    if min(gap.sealed_pressure, gap.outer_pressure) < gap.cavitation_pressure:
        return "an end pressure is below the cavitation pressure"
    if gap.line_load is None:
        return ""
    static = gap.width * (gap.sealed_pressure + gap.outer_pressure) / 2
    if gap.line_load <= static:
        return (
            f"line load {gap.line_load:g} N/m: the pressures at both ends of the gap alone already "
            f"carry {static:g} N/m, so the ring lifts off"
        )
    if gap.elastic is not None and np.ptp(gap.profile) == 0:
        return "a flat elastic face has no wedge to draw in oil: round the edges of its profile"
    return "" if gap.speed != 0 else "speed 0: a film at rest carries no load"


def solve_gap(gap: Gap, nodes: int = 0) -> SmoothFilm:
    """Solve a smooth gap for film, drag and flow.

    The film is h = h_0 + profile - (1 - nu^2)/(pi E) int p ln(x - s)^2 ds, where h_0 follows from
    the line load ([Huang2017] eq. 19 to 22, with local density and viscosity).

    Parameters
    ----------
    gap : shape, oil, operating point
    nodes : number of nodes; 0 for as many as the profile has

    Returns
    -------
    film; with `converged` False and a reason if no equilibrium was reached
    """
    if nodes and nodes != len(gap.profile):
        old, new = np.linspace(0, 1, len(gap.profile)), np.linspace(0, 1, nodes)
        gap = replace(gap, profile=np.interp(new, old, gap.profile))
    reason = fault(gap)
    if reason:
        unsolved = np.full(len(gap.profile), np.nan)
        failure = NewtonResult(FilmState(unsolved, unsolved, unsolved, np.nan), reason, 0, 1.0, 1.0)
        return _smooth_film(gap, 1.0, 1.0, failure)
    return _fixed_gap(gap) if gap.line_load is None else _loaded_gap(gap)


def _scales(gap: Gap) -> float:
    """Scale of the pressures: the largest pressure that is known in advance [Pa]."""
    mean = (gap.line_load or 0.0) / gap.width
    highest = max(gap.sealed_pressure, gap.outer_pressure, mean) - gap.cavitation_pressure
    shear = gap.lubricant.dynamic_viscosity * abs(gap.speed) * gap.width
    if gap.line_load is None:
        highest += shear / float(np.min(gap.profile)) ** 2
    return float(max(highest, 1.0))


def _scaled(gap: Gap, film: float, pressure: float) -> tuple[ReynoldsProblem, Bed]:
    nodes = len(gap.profile)
    viscosity = gap.lubricant.dynamic_viscosity
    conductance = film**3 * pressure / (12 * viscosity * gap.width)
    scale = conductance + abs(gap.speed) * film / 2
    flow = ReynoldsProblem(
        nodes=nodes,
        width=gap.width,
        lubricant=gap.lubricant,
        pressure_scale=pressure,
        film_scale=film,
        flow_scale=scale,
        cavitation_pressure=gap.cavitation_pressure,
        conductance=conductance / scale,
        drive=gap.speed * film / (2 * scale),
        rod_share=None,
    )
    compliance = 0.0 if gap.elastic is None else gap.elastic.compliance
    compliance *= gap.width * pressure / film
    load = np.full(nodes, ((gap.line_load or 0.0) / gap.width - gap.cavitation_pressure) / pressure)
    bed = Bed(
        rest_film=gap.profile / film + compliance * (kernel(nodes) @ load),
        static_pressure=load,
        compliance=compliance,
        stiffness=0.0,
        roughness_ratio=1.0,
        sealed=(gap.sealed_pressure - gap.cavitation_pressure) / pressure,
        outer=(gap.outer_pressure - gap.cavitation_pressure) / pressure,
        held=gap.line_load is None,
    )
    return flow, bed


def _fixed_gap(gap: Gap) -> SmoothFilm:
    film, pressure = float(np.mean(gap.profile)), _scales(gap)
    flow, bed = _scaled(gap, film, pressure)
    ends = np.linspace(bed.sealed, bed.outer, flow.nodes)
    start = FilmState(ends, np.zeros(flow.nodes), gap.profile / film, 0.0)
    return _smooth_film(gap, film, pressure, newton(flow, bed, start))


def _loaded_gap(gap: Gap) -> SmoothFilm:
    """Solve a loaded gap, starting from dry contact with a thin film, or else from a thick film.

    The thin film is the film that the inlet lets pass: h* = sqrt(8 eta U/(9 w)), with viscosity
    eta, speed U and the pressure gradient w at the inlet.
    """
    pressure = _scales(gap)
    rise = 4 * (gap.line_load or 0.0) / gap.width**2
    viscosity = gap.lubricant.dynamic_viscosity
    film = math.sqrt(8 * viscosity * abs(gap.speed) / (9 * rise))
    speed, iterations = abs(gap.speed), 0

    def at(value: float, state: FilmState) -> NewtonResult:
        return newton(
            *_scaled(replace(gap, speed=math.copysign(value, gap.speed)), film, pressure), state
        )

    for faster in _FASTER:
        start = _dry(gap, *_scaled(gap, film, pressure), math.sqrt(faster))
        outcome = follow(at, start, faster * speed, speed)
        iterations += outcome.iterations
        if not outcome.reason:
            break
    reason = (
        outcome.reason and f"{outcome.reason}; a film of about {film:.1e} m may need more nodes"
    )
    return _smooth_film(gap, film, pressure, replace(outcome, reason=reason, iterations=iterations))


def _dry(gap: Gap, flow: ReynoldsProblem, bed: Bed, least: float) -> FilmState:
    """Initial state: elliptic pressure, as under a cylinder in dry contact, and the film under it.

    `least` is the smallest film thickness, scaled.
    """
    place = np.linspace(0, 1, flow.nodes)
    ends = bed.sealed + (bed.outer - bed.sealed) * place
    relief = float(np.mean(gap.profile[[0, -1]]) - np.min(gap.profile))
    reach = 0.25
    if relief > 0 and gap.elastic is not None:
        hertz = (gap.line_load or 0.0) * gap.elastic.compliance / (2 * relief)
        reach = min(reach, max(hertz, _NARROWEST))
    ellipse = np.sqrt(np.maximum(reach - (place - 0.5) ** 2, 0.0))
    carried = bed.static_pressure[0] - (bed.sealed + bed.outer) / 2
    pressure = ends + carried * ellipse / (weights(flow.nodes) @ ellipse)
    bent = bed.rest_film + bed.compliance * (kernel(flow.nodes) @ (pressure - bed.static_pressure))
    shift = least - float(np.min(bent))
    return FilmState(pressure, np.zeros(flow.nodes), bent + shift, shift)


def _smooth_film(gap: Gap, film: float, pressure: float, outcome: NewtonResult) -> SmoothFilm:
    state = outcome.state
    drag = load = passing = np.nan
    absolute = gap.cavitation_pressure + pressure * state.pressure
    if not outcome.reason:
        flow, bed = _scaled(gap, film, pressure)
        drag, _, passing, _ = outputs(flow, bed, state)
        load = gap.width * float(weights(flow.nodes) @ absolute)
    return SmoothFilm(
        converged=not outcome.reason,
        reason=outcome.reason,
        x=np.linspace(0.0, gap.width, len(gap.profile)),
        pressure=absolute,
        cavitated_fraction=state.cavitation,
        film=film * state.film,
        viscous_drag=float(drag),
        line_load=float(load),
        flow=float(passing),
        load_residual=float(outcome.load_residual),
        mass_residual=float(outcome.mass_residual),
        iterations=outcome.iterations,
    )
