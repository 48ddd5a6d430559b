"""The oil film under a seal: solution at a speed, with drag, flow, profiles and derivatives.

The static contact pressure of the seal is an input. At speed 0, the film is that of a leaking seal
at rest: no oil is dragged along, and all friction is at the asperities. `sensitivities` gives exact
derivatives with respect to the inputs, from the implicit-function theorem.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import STEP, Array, real
from ..models.rough_surface import (
    film_ratio_under_contact,
    pressure_stress_factor,
    shear_stress_correction,
    shear_stress_factor,
)
from .newton import (
    Bed,
    FilmState,
    LinearSystem,
    NewtonResidual,
    NewtonResult,
    contact_pressure,
    follow,
    newton,
    residual,
    weights,
)
from .reynolds import Contact, ReynoldsProblem, Vector, fault, flux

LEAST_CONTACT = 1e-12
"""Smallest ratio of static pressure to asperity stiffness. Where it is lower, this value is used,
so that the film thickness at rest stays finite."""
SLOWEST = 1e-4
"""First speed [m/s] from which the speed is raised in steps if Newton's method does not converge
directly at the stated speed."""


@dataclass(frozen=True, slots=True)
class Film:
    """A solved film, or the reason for a failure.

    Forces and flow are per unit length of circumference. `flow` is the mass flow divided by the
    density at zero pressure, positive towards the outer side. The values of a film that did not
    converge are meaningless.
    """

    contact: Contact
    converged: bool
    reason: str
    state: FilmState
    viscous_drag: float  # [N/m], positive against a positive speed
    contact_load: float  # int p_c dx [N/m]
    flow: float  # [m^2/s]
    mean_film: float  # mean of h over the width [m]
    load_residual: float
    mass_residual: float
    iterations: int

    @property
    def x(self) -> Vector:
        """Distances of the nodes from the sealed side [m]."""
        return np.linspace(0.0, self.contact.width, len(self.contact.static_pressure))

    @property
    def pressure(self) -> Vector:
        """Absolute pressure of the oil [Pa]."""
        scale = pressure_scale(self.contact)
        return self.contact.cavitation_pressure + scale * self.state.pressure

    @property
    def cavitated_fraction(self) -> Vector:
        """Share of the gap without oil [-]."""
        return self.state.cavitation

    @property
    def film(self) -> Vector:
        """Film thickness h, the distance between the mean planes of both surfaces [m]."""
        return self.contact.surface.roughness * self.state.film

    @property
    def contact_pressure(self) -> Vector:
        """Contact pressure that the asperities carry [Pa]."""
        _, bed = scaled(self.contact)
        return pressure_scale(self.contact) * contact_pressure(bed, self.state.film)

    @property
    def rigid_shift(self) -> float:
        """Rigid shift C of the seal [m].

        The film equation is h = h_s + C - (1 - nu^2)/(pi E) int d ln (x - s)^2 ds. Here h_s is the
        static gap, and d the difference between the total pressure and the static contact pressure.
        """
        return float(self.contact.surface.roughness * self.state.shift)


def pressure_scale(contact: Contact) -> float:
    """Scale of all pressures: the largest absolute pressure minus the cavitation pressure [Pa]."""
    pressures = (contact.sealed_pressure, contact.outer_pressure, *contact.static_pressure)
    return max(float(real(p)) for p in pressures) - float(real(contact.cavitation_pressure))


def scaled(contact: Contact, scales: Contact | None = None) -> tuple[ReynoldsProblem, Bed]:
    """Equations of a contact in scaled form: flow, and bed (seal and asperities).

    The scales are those of `contact` itself or, if given, of the contact `scales`.
    """
    base = scales or contact
    pressure = pressure_scale(base)
    film = float(base.surface.roughness)
    viscosity = contact.lubricant.dynamic_viscosity
    base_viscosity = float(base.lubricant.dynamic_viscosity)
    per_gradient = film**3 * pressure / 12
    flow_scale = per_gradient / (base_viscosity * base.width) + abs(base.speed) * film / 2
    ratio = contact.surface.roughness / film
    flow = ReynoldsProblem(
        nodes=len(contact.static_pressure),
        width=contact.width,
        lubricant=contact.lubricant,
        pressure_scale=pressure,
        film_scale=film,
        flow_scale=flow_scale,
        cavitation_pressure=contact.cavitation_pressure,
        conductance=per_gradient / (viscosity * contact.width * flow_scale),
        drive=contact.speed * film / (2 * flow_scale),
        rod_share=contact.surface.rod_share,
        roughness_ratio=ratio,
    )
    return flow, _bed(contact, pressure, film, ratio)


def _bed(contact: Contact, pressure: float, film: float, ratio: Array) -> Bed:
    stiffness = contact.asperity_stiffness
    static = contact.static_pressure
    least = LEAST_CONTACT * stiffness
    touching = np.where(real(static) > real(least), static, least)
    return Bed(
        rest_film=ratio * film_ratio_under_contact(contact_pressure=touching, stiffness=stiffness),
        static_pressure=(static - contact.cavitation_pressure) / pressure,
        compliance=contact.elastic.compliance * contact.width * (pressure / film),
        stiffness=stiffness / pressure,
        roughness_ratio=ratio,
        sealed=(contact.sealed_pressure - contact.cavitation_pressure) / pressure,
        outer=(contact.outer_pressure - contact.cavitation_pressure) / pressure,
    )


def outputs(flow: ReynoldsProblem, bed: Bed, state: FilmState) -> tuple[Array, Array, Array, Array]:
    """Viscous drag [N/m], asperity load [N/m], flow [m^2/s] and mean film thickness [m]."""
    couette_factor, poiseuille_factor = 1.0, 1.0
    if flow.rod_share is not None:
        ratio = state.film / flow.roughness_ratio
        correction = shear_stress_correction(film_ratio=ratio, rod_share=flow.rod_share)
        couette_factor = shear_stress_factor(film_ratio=ratio) - correction
        poiseuille_factor = pressure_stress_factor(film_ratio=ratio)
    film = flow.film_scale * state.film
    absolute = flow.cavitation_pressure + flow.pressure_scale * state.pressure
    viscosity = flow.lubricant.dynamic_viscosity * flow.lubricant.viscosity_ratio(absolute)
    couette_stress = viscosity * flow.speed / film * couette_factor * (1 - state.cavitation)
    poiseuille_stress = poiseuille_factor * film / 2 * _slope(absolute) / flow.width
    share = weights(flow.nodes)
    load = flow.width * flow.pressure_scale * (share @ contact_pressure(bed, state.film))
    net_flow = flow.flow_scale * np.mean(flux(flow, state.pressure, state.cavitation, state.film))
    return flow.width * (share @ (couette_stress + poiseuille_stress)), load, net_flow, share @ film


def _slope(values: Vector) -> Vector:
    """Derivative by central differences, one-sided at the ends; the nodes span a unit width."""
    rise = np.diff(values)
    inner = (rise[1:] + rise[:-1]) / 2
    return (len(values) - 1) * np.concatenate([rise[:1], inner, rise[-1:]])


def _at_rest(contact: Contact, bed: Bed) -> FilmState:
    """Initial guess: linear oil pressure, and a film whose asperities carry the remaining load."""
    nodes = len(contact.static_pressure)
    straight = np.linspace(bed.sealed, bed.outer, nodes)
    pressure = np.minimum(straight, np.maximum(0.9 * bed.static_pressure, 0.0))
    pressure[[0, -1]] = bed.sealed, bed.outer
    remaining = np.maximum(bed.static_pressure - pressure, LEAST_CONTACT * bed.stiffness)
    ratio = film_ratio_under_contact(contact_pressure=remaining, stiffness=bed.stiffness)
    film = np.maximum(ratio, 0.3)
    return FilmState(pressure, _starved(np.zeros(nodes), contact), film, 0.0)


def _starved(cavitation: Vector, contact: Contact) -> Vector:
    """Copy the cavitated fractions; set the two end values to those stated by the contact."""
    ends = [contact.sealed_cavitation], [contact.outer_cavitation]
    return np.concatenate([ends[0], cavitation[1:-1], ends[1]])


def _rescaled(start: Film, contact: Contact) -> FilmState:
    """Convert the state of another film to the scales of this contact."""
    pressure = (start.pressure - contact.cavitation_pressure) / pressure_scale(contact)
    ratio = start.contact.surface.roughness / contact.surface.roughness
    state = start.state
    cavitation = _starved(state.cavitation, contact)
    return FilmState(pressure, cavitation, state.film * ratio, state.shift * ratio)


def _solved(contact: Contact, state: FilmState) -> NewtonResult:
    return newton(*scaled(contact), state)


def _cold(contact: Contact) -> NewtonResult:
    """Solve a film without initial state: directly, or else by raising the speed in steps."""
    _, bed = scaled(contact)
    rest = _at_rest(contact, bed)
    outcome = _solved(contact, rest)
    target = abs(contact.speed)
    if not outcome.reason or target <= SLOWEST:
        return outcome
    sign = -1.0 if contact.speed < 0 else 1.0

    def at(speed: float, state: FilmState) -> NewtonResult:
        flow, _ = scaled(replace(contact, speed=sign * speed))
        return newton(flow, bed, state)

    further = follow(at, rest, SLOWEST, target)
    return replace(further, iterations=further.iterations + outcome.iterations)


def solve_film(contact: Contact, start: Film | None = None) -> Film:
    """Film of a seal at an operating point.

    Parameters
    ----------
    contact : seal, surfaces, oil and operating point
    start : converged film of a nearby operating point, from which to start; it must have the same
        number of nodes

    Returns
    -------
    film; with `converged` False and a reason if there is no equilibrium or it was not reached
    """
    reason = fault(contact)
    if reason:
        unsolved = np.full(np.shape(contact.static_pressure), np.nan)
        return _film(
            contact, NewtonResult(FilmState(unsolved, unsolved, unsolved, np.nan), reason, 0, 1, 1)
        )
    nodes = len(contact.static_pressure)
    if start is not None and start.converged and len(start.state.film) == nodes:
        outcome = _solved(contact, _rescaled(start, contact))
        if not outcome.reason:
            return _film(contact, outcome)
    return _film(contact, _cold(contact))


def _film(contact: Contact, outcome: NewtonResult) -> Film:
    values: tuple[Array, ...] = (np.nan, np.nan, np.nan, np.nan)
    if not outcome.reason:
        values = outputs(*scaled(contact), outcome.state)
    drag, load, net_flow, mean = (float(value) for value in values)
    return Film(
        contact=contact,
        converged=not outcome.reason,
        reason=outcome.reason,
        state=outcome.state,
        viscous_drag=drag,
        contact_load=load,
        flow=net_flow,
        mean_film=mean,
        load_residual=float(outcome.load_residual),
        mass_residual=float(outcome.mass_residual),
        iterations=outcome.iterations,
    )


def sensitivities(film: Film, stepped: Sequence[Contact]) -> Vector:
    """Derivatives of viscous drag, asperity load, flow and mean film with respect to the inputs.

    Each direction of differentiation is given by a copy of the film's contact in which some
    numbers have a complex step added, such as ``width * (1 + 1j * STEP)``. The state changes by
    -J^-1 times the change of the residual at the solved state, with the Jacobian J. One
    factorisation serves all directions.

    Parameters
    ----------
    film : a converged film
    stepped : for each direction, the film's contact with a complex step of size `numeric.STEP`

    Returns
    -------
    array (directions, 4): derivatives of the four outputs along each direction, SI

    Raises
    ------
    ValueError
        The film did not converge.
    """
    if not film.converged:
        raise ValueError(f"no derivatives for a film that did not converge: {film.reason}")
    problems = [scaled(contact, film.contact) for contact in stepped]
    steps = [_imaginary(residual(flow, bed, film.state)) for flow, bed in problems]
    changes = LinearSystem(*scaled(film.contact), film.state).solve(steps)
    slopes = []
    for (flow, bed), change in zip(problems, changes, strict=True):
        values = outputs(flow, bed, _moved(film.state, change))
        slopes.append([np.imag(value) / STEP for value in values])
    return np.array(slopes).reshape(len(slopes), 4)


def _imaginary(newton_residual: NewtonResidual) -> NewtonResidual:
    """Derivatives of the residuals along a complex step: imaginary parts divided by the step."""
    flow, complementarity, film = (
        np.imag(part) / STEP
        for part in (newton_residual.flow, newton_residual.complementarity, newton_residual.film)
    )
    ends = (
        float(np.imag(newton_residual.ends[0])) / STEP,
        float(np.imag(newton_residual.ends[1])) / STEP,
    )
    return NewtonResidual(
        flow, complementarity, film, float(np.imag(newton_residual.load)) / STEP, ends
    )


def _moved(state: FilmState, change: FilmState) -> FilmState:
    """The state plus a complex step: `change` times an imaginary step size is added."""
    return FilmState(
        state.pressure + 1j * STEP * change.pressure,
        state.cavitation + 1j * STEP * change.cavitation,
        state.film + 1j * STEP * change.film,
        state.shift + 1j * STEP * change.shift,
    )
