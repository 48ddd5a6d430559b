"""Newton's method for a film: pressure, cavitated fraction, thickness and rigid shift at once.

The unknowns are pressure p, cavitated fraction theta and film thickness h at every node, and the
rigid shift C of the seal. In scaled form the equations are

    flux out - flux in = 0 at the inner nodes, p given at the ends,
    p + theta - sqrt(p^2 + theta^2) = 0 (p >= 0, theta >= 0, p theta = 0),
    h = h_s + C + K d, d = p + p_c(h) - p_sc,
    sum of weights times d = 0.

Here h_s is the static gap, p_c the contact pressure of the asperities, p_sc the static contact
pressure, and K the compliance matrix of the seal. The linear step is solved for the change g of d.
Then dh = dC + K g and dp = g - p_c' dh, and theta follows node by node where the film is full. This
leaves a dense system with about one equation per node, and one more per cavitated node.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array
from ..models.rough_surface import asperity_integral
from .reynolds import ReynoldsProblem, Vector, banded, faces, flux

TOLERANCE = 1e-9
"""Largest scaled residual of a converged film."""
MOST_ITERATIONS = 60
_GROWTH, _LEAST_GROWTH = 8.0, 1.02
"""Factor by which `follow` changes its input from one step to the next: initial value, and smallest
value before it gives up."""
_CLOSED, _PRESSURE_STEP = 0.5, 0.6
"""Limits of one Newton step: largest relative decrease of the film thickness, and largest change
of a scaled pressure."""


@dataclass(frozen=True, slots=True)
class Bed:
    """Elastic seal and asperities, which support the film, in scaled form.

    Oil and asperities together must balance the static pressure. `compliance` is (1 - nu^2) L
    p_scale/(pi E film_scale), with contact width L. `stiffness` is the asperity stiffness divided
    by the pressure scale (0 for smooth surfaces). `roughness_ratio` is the roughness sigma divided
    by the film scale.
    """

    rest_film: Vector
    static_pressure: Vector
    compliance: Array
    stiffness: Array
    roughness_ratio: Array
    sealed: Array
    outer: Array
    held: bool = False  # the gap is fixed: no rigid shift, no load balance


@dataclass(frozen=True, slots=True)
class FilmState:
    """Scaled pressure, cavitated fraction and film thickness of all nodes, and rigid shift."""

    pressure: Vector
    cavitation: Vector
    film: Vector
    shift: Array


@dataclass(frozen=True, slots=True)
class NewtonResidual:
    """Scaled residuals of the film's equations.

    They are those of flow and complementarity (p >= 0, theta >= 0, p theta = 0) at the inner nodes,
    of the film equation at all nodes, of the load balance, and of the pressures at both ends.
    """

    flow: Vector
    complementarity: Vector
    film: Vector
    load: Array
    ends: tuple[Array, Array]


@dataclass(frozen=True, slots=True)
class NewtonResult:
    """Final state of Newton's method; `reason` is empty if it converged."""

    state: FilmState
    reason: str
    iterations: int
    mass_residual: float
    load_residual: float


@lru_cache(maxsize=16)
def kernel(nodes: int) -> Vector:
    """Change of the film thickness per unit pressure on a node's cell: -int ln(x - s)^2 ds.

    It is for a contact of unit width. Another width only adds a constant times the integral of the
    pressure change d, and the load balance makes this integral zero.
    """
    places = np.linspace(0, 1, nodes)
    edges = np.concatenate([[0.0], (places[1:] + places[:-1]) / 2, [1.0]])
    distance = places[:, None] - edges[None, :]
    far = np.where(distance == 0, 1.0, np.abs(distance))
    primitive = 2 * distance * (np.log(far) - 1)
    result = primitive[:, 1:] - primitive[:, :-1]
    result.setflags(write=False)
    return result


@lru_cache(maxsize=16)
def weights(nodes: int) -> Vector:
    """Weights of the trapezium rule for integrals over a unit width."""
    result = np.full(nodes, 1 / (nodes - 1))
    result[[0, -1]] /= 2
    result.setflags(write=False)
    return result


def contact_pressure(bed: Bed, film: Vector) -> Vector:
    """Scaled asperity contact pressure."""
    if np.all(bed.stiffness == 0):
        return 0 * film
    return bed.stiffness * asperity_integral(film_ratio=film / bed.roughness_ratio)


def residual(flow: ReynoldsProblem, bed: Bed, state: FilmState) -> NewtonResidual:
    """Residuals of a state, which may be real or have a complex step added."""
    pressure, theta = state.pressure, state.cavitation
    excess = pressure + contact_pressure(bed, state.film) - bed.static_pressure
    deflection = bed.compliance * (kernel(flow.nodes) @ excess)
    inner = pressure[1:-1] + theta[1:-1]
    root = np.sqrt(pressure[1:-1] ** 2 + theta[1:-1] ** 2)
    load = state.shift if bed.held else weights(flow.nodes) @ excess
    return NewtonResidual(
        flow=np.diff(flux(flow, pressure, theta, state.film)),
        complementarity=inner - root,
        film=state.film - bed.rest_film - state.shift - deflection,
        load=load,
        ends=(pressure[0] - bed.sealed, pressure[-1] - bed.outer),
    )


def _complementarity_slopes(state: FilmState) -> tuple[Vector, Vector]:
    pressure, theta = state.pressure[1:-1], state.cavitation[1:-1]
    root = np.hypot(pressure, theta)
    safe = np.where(root > 0, root, 1.0)
    corner = 1 - np.sqrt(0.5)
    return (
        np.where(root > 0, 1 - pressure / safe, corner),
        np.where(root > 0, 1 - theta / safe, corner),
    )


def _spread(bands: tuple[Vector, Vector, Vector], matrix: Vector) -> Vector:
    """Tridiagonal matrix, with one row per inner node, times a dense matrix."""
    lower, middle, upper = (band[:, None] for band in bands)
    return lower * matrix[:-2] + middle * matrix[1:-1] + upper * matrix[2:]


def _along(bands: tuple[Vector, Vector, Vector], vector: Vector) -> Vector:
    """Tridiagonal matrix, with one row per inner node, times a vector."""
    lower, middle, upper = bands
    return lower * vector[:-2] + middle * vector[1:-1] + upper * vector[2:]


def _widened(bands: tuple[Vector, Vector, Vector]) -> Vector:
    """A tridiagonal matrix, with one row per inner node, as a dense matrix."""
    lower, middle, upper = bands
    rows = np.arange(len(middle))
    result = np.zeros((len(middle), len(middle) + 2))
    result[rows, rows], result[rows, rows + 1], result[rows, rows + 2] = lower, middle, upper
    return result


class LinearSystem:
    """Linearised equations at a state; `solve` gives the change that cancels the residuals."""

    def __init__(self, flow: ReynoldsProblem, bed: Bed, state: FilmState) -> None:
        nodes = self.nodes = flow.nodes
        slope = faces(flow, state.pressure, state.cavitation, state.film)
        self.softness = np.zeros(nodes)  # d(contact pressure)/d(film)
        if bed.stiffness != 0:
            ratio = state.film / bed.roughness_ratio
            integral = asperity_integral(film_ratio=ratio, order="1/2")
            self.softness = -1.5 * bed.stiffness / bed.roughness_ratio * integral
        self.over_pressure, self.over_theta = _complementarity_slopes(state)
        self.empty = self.over_theta < self.over_pressure
        self.held = bed.held
        self.bent = bed.compliance * kernel(nodes)
        self.cavitation = banded(*slope.cavitation)
        film = banded(*slope.film)
        ratio = np.zeros(nodes)
        full = ~self.empty
        ratio[1:-1][full] = self.over_pressure[full] / self.over_theta[full]
        pressure = [
            band - theta * part
            for band, theta, part in zip(
                banded(*slope.pressure),
                self.cavitation,
                (ratio[:-2], ratio[1:-1], ratio[2:]),
                strict=True,
            )
        ]
        self.pressure = (pressure[0], pressure[1], pressure[2])
        parts = zip(film, self.pressure, self._neighbours(self.softness), strict=True)
        both = [over_film - over_pressure * soft for over_film, over_pressure, soft in parts]
        self.film = (both[0], both[1], both[2])
        self.matrix = self._assembled()

    @staticmethod
    def _neighbours(vector: Vector) -> tuple[Vector, Vector, Vector]:
        return vector[:-2], vector[1:-1], vector[2:]

    def _assembled(self) -> Vector:
        nodes = self.nodes
        holes = np.flatnonzero(self.empty) + 1
        size = nodes + 1 + len(holes)
        matrix = np.zeros((size, size))
        matrix[1 : nodes - 1, :nodes] = _spread(self.film, self.bent) + _widened(self.pressure)
        matrix[1 : nodes - 1, nodes] = self.film[0] + self.film[1] + self.film[2]
        matrix[1 : nodes - 1, nodes + 1 :] = _widened(self.cavitation)[:, holes]
        fixed = np.concatenate([[0, nodes - 1], holes])
        rows = np.concatenate([[0, nodes - 1], np.arange(nodes + 1, size)])
        share = np.ones(len(fixed))
        share[2:] = self.over_pressure[holes - 1]
        matrix[rows, :nodes] = -(share * self.softness[fixed])[:, None] * self.bent[fixed]
        matrix[rows, fixed] += share
        matrix[rows, nodes] = -share * self.softness[fixed]
        matrix[rows[2:], rows[2:]] = self.over_theta[holes - 1]
        if self.held:
            matrix[nodes, nodes] = 1.0
        else:
            matrix[nodes, :nodes] = weights(nodes)
        return matrix

    def solve(self, residuals: list[NewtonResidual]) -> list[FilmState]:
        """Changes of the state that cancel each residual to first order."""
        nodes, full = self.nodes, ~self.empty
        holes = np.flatnonzero(self.empty) + 1
        right = np.zeros((len(residuals), len(self.matrix)))
        local = np.zeros((len(residuals), nodes))
        for row, theta, part in zip(right, local, residuals, strict=True):
            theta[1:-1][full] = -part.complementarity[full] / self.over_theta[full]
            row[1 : nodes - 1] = _along(self.film, part.film) - part.flow
            row[1 : nodes - 1] -= _along(self.cavitation, theta)
            row[0] = -part.ends[0] - self.softness[0] * part.film[0]
            row[nodes - 1] = -part.ends[1] - self.softness[-1] * part.film[-1]
            row[nodes] = -part.load
            row[nodes + 1 :] = -part.complementarity[holes - 1]
            row[nodes + 1 :] -= self.over_pressure[holes - 1] * (self.softness * part.film)[holes]
        solution = np.linalg.solve(self.matrix, right.T).T
        changes = []
        for row, theta, part in zip(solution, local, residuals, strict=True):
            film = self.bent @ row[:nodes] + row[nodes] - part.film
            pressure = row[:nodes] - self.softness * film
            inner = theta[1:-1]
            inner[full] -= self.over_pressure[full] / self.over_theta[full] * pressure[1:-1][full]
            theta[holes] = row[nodes + 1 :]
            changes.append(FilmState(pressure, theta, film, row[nodes]))
        return changes


def _allowed(state: FilmState, change: FilmState) -> float:
    """Share of a Newton step at which the film stays open and no pressure changes too much."""
    fall = np.max(-change.film / state.film)
    jump = np.max(np.abs(change.pressure))
    return float(min(1.0, _CLOSED / max(fall, 1e-300), _PRESSURE_STEP / max(jump, 1e-300)))


def _measures(
    flow: ReynoldsProblem, bed: Bed, state: FilmState, newton_residual: NewtonResidual
) -> tuple[float, float, float]:
    """Three measures of the error: flux, load, and the rest.

    They are the variation of the flux along the film, the load residual (both relative), and the
    largest of all other residuals.
    """
    fluxes = flux(flow, state.pressure, state.cavitation, state.film)
    drag_flow = abs(flow.drive) * np.min(flow.gap(state.film)[1])
    spread = np.ptp(fluxes) / (abs(np.mean(fluxes)) + drag_flow + 1e-300)
    load = abs(newton_residual.load) / max(weights(flow.nodes) @ bed.static_pressure, 1e-12)
    film = np.max(np.abs(newton_residual.film)) / np.max(state.film)
    ends = max(abs(newton_residual.ends[0]), abs(newton_residual.ends[1]))
    return spread, load, max(film, ends, np.max(np.abs(newton_residual.complementarity)))


def newton(flow: ReynoldsProblem, bed: Bed, state: FilmState) -> NewtonResult:
    """Solve the film from an initial state; if this fails, the result states the reason."""
    with np.errstate(all="ignore"):
        return _newton(flow, bed, state)


def _newton(flow: ReynoldsProblem, bed: Bed, state: FilmState) -> NewtonResult:
    spread = load = np.inf
    for iteration in range(MOST_ITERATIONS + 1):
        current = residual(flow, bed, state)
        spread, load, largest = _measures(flow, bed, state, current)
        if spread < TOLERANCE and load < TOLERANCE and largest < TOLERANCE:
            return NewtonResult(state, "", iteration, spread, load)
        if not np.isfinite(spread + load + largest):
            return NewtonResult(
                state,
                "the film's pressure or thickness left the valid range of its laws",
                iteration,
                spread,
                load,
            )
        if iteration == MOST_ITERATIONS:
            break
        try:
            (change,) = LinearSystem(flow, bed, state).solve([current])
        except np.linalg.LinAlgError:
            return NewtonResult(
                state, "the linearised equations of the film are singular", iteration, spread, load
            )
        part = _allowed(state, change)
        state = FilmState(
            state.pressure + part * change.pressure,
            state.cavitation + part * change.cavitation,
            state.film + part * change.film,
            state.shift + part * change.shift,
        )
    residuals = f"relative errors: flow along the film {spread:.1e}, load {load:.1e}"
    reason = f"no equilibrium within {MOST_ITERATIONS} iterations ({residuals})"
    return NewtonResult(state, reason, MOST_ITERATIONS, spread, load)


def follow(
    solve: Callable[[float, FilmState], NewtonResult], state: FilmState, first: float, last: float
) -> NewtonResult:
    """Solve a film at the value `last` of an input, such as the speed, in steps from `first`.

    Each step starts from the solution of the previous step. The factor between successive values
    adapts to whether the steps converge.

    Parameters
    ----------
    solve : function that solves the film, given the value of the input and an initial state
    state : initial state at the first value
    first, last : first and last value of the input, both positive
    """
    outcome = solve(first, state)
    iterations, value, growth = outcome.iterations, first, _GROWTH
    while not outcome.reason and value != last:
        factor = growth if last > value else 1 / growth
        step = last if abs(math.log(last / value)) <= math.log(growth) else value * factor
        trial = solve(step, outcome.state)
        iterations += trial.iterations
        if not trial.reason:
            outcome, value, growth = trial, step, min(growth**1.5, _GROWTH)
            continue
        growth = growth**0.5
        if growth < _LEAST_GROWTH:
            reason = f"{trial.reason}; changing the speed in steps failed beyond {value:.2e} m/s"
            return replace(trial, reason=reason, iterations=iterations)
    return replace(outcome, iterations=iterations)
