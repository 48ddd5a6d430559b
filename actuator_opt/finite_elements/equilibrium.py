"""Equilibrium of bodies in contact with walls, with each other and with a fluid: Newton's method.

A wall is an upper or lower bound on displacements, so contact needs no penalty stiffness. As walls
are parallel to the axes, each bounds one displacement component of every boundary node. A node at
its bound stays there as long as the wall pushes it. The contact force is the reaction of the wall.

The fluid reaches all boundary nodes from the sealed side up to the first node whose contact
pressure exceeds the fluid pressure. Its pressure is a follower load, integrated by Simpson's rule
over every three-node edge. For a uniform pressure this is exact: the resultant on an arc is the
pressure times the distance between the ends of the arc.

Contact of two bodies has no friction: nodes of the upper body rest on the surface of the lower
body. The gap is measured along direction 2, g = y_node - y_surface(x_node); the force is normal to
the surface. The slope of the surface is made continuous from edge to edge. Otherwise a node that
slides over the corner between two edges would oscillate.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
import numpy.typing as npt
from scipy.sparse import bmat, csc_matrix, csr_matrix, vstack
from scipy.sparse.linalg import splu

from ..base.dataclass import dataclass
from ..base.errors import ActuatorError, Diagnostic
from .material import Floats, MooneyRivlin
from .mesh import Integers
from .section import Assembly, MountedContact, SealSolution

SLOPES = np.array([[-1.5, 2.0, -0.5], [-0.5, 0.0, 0.5], [0.5, -2.0, 1.5]])
"""Matrix that converts the positions of an edge's three nodes to d(position)/d(xi) at these nodes;
xi runs from -1 to 1 along the edge."""

SIMPSON = np.array([1.0, 4.0, 1.0]) / 3


def tangents(edges: Integers, places: Floats) -> Floats:
    """Tangent vectors at the boundary nodes times Simpson's weights, (edges, 3 nodes, 2) [m]."""
    return np.asarray(SIMPSON[:, None] * (SLOPES @ places[edges]))


def shares(section: Assembly, places: Floats) -> Floats:
    """Tangent vector of the part of the boundary that belongs to each node, (nodes, 2) [m]."""
    total = np.zeros_like(places)
    for edges in section.edges:
        np.add.at(total, edges, tangents(edges, places))
    return total


def load(section: Assembly, places: Floats, pressure: Floats) -> tuple[Floats, Floats]:
    """Nodal forces of the fluid pressure, and their contribution to the stiffness matrix.

    Parameters
    ----------
    section : bodies
    places : current positions of the nodes [m]
    pressure : fluid pressure at every node, 0 where dry [Pa]

    Returns
    -------
    forces on all unknowns [N/m], and a 6 x 6 block per edge for `Assembly.stiffness`
    """
    chain = np.concatenate(section.edges)
    along = tangents(chain, places)
    size = (pressure * section.radii(places))[chain]
    # outward normal of an anticlockwise edge (dx, dy) is (dy, -dx); the fluid pushes inward
    force = size[..., None] * np.stack((-along[..., 1], along[..., 0]), axis=-1)
    total = np.bincount(
        section.edge_unknowns.ravel(), force.reshape(-1, 6).ravel(), minlength=section.unknowns
    )
    block = np.zeros((len(chain), 3, 2, 3, 2))
    derivative = size[:, :, None] * SIMPSON[:, None] * SLOPES
    block[:, :, 0, :, 1] = derivative
    block[:, :, 1, :, 0] = -derivative
    if section.sliding_radius is not None:  # a node that moves outward has a longer circumference
        widening = section.outward / section.sliding_radius * pressure[chain]
        for k in range(3):
            block[:, k, 0, k, 1] += widening[:, k] * along[:, k, 1]
            block[:, k, 1, k, 1] -= widening[:, k] * along[:, k, 0]
    return np.asarray(total), block.reshape(-1, 6, 6)


Booleans = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class PairContribution:
    """Contribution of a contact pair to the equations of Newton's method.

    Parameters
    ----------
    gaps : derivatives of the gaps at the touching nodes with respect to all unknowns
    directions : forces on all unknowns due to a unit contact force at each touching node
    stiffness : contribution to the stiffness matrix: change of the nodal forces with the unknowns
        at constant contact forces
    """

    gaps: csc_matrix
    directions: csc_matrix
    stiffness: csc_matrix


@dataclass(frozen=True, slots=True)
class _SurfacePoints:
    """The points of the lower surface that are under the upper nodes.

    Each is given by the three nodes of its edge, their shape functions, and the slope.
    """

    nodes: Integers
    inside: Booleans
    shape: Floats
    shape_slope: Floats
    place: Floats
    along: Floats


class ContactPair:
    """Two bodies that may touch: nodes of the upper body, and edges of the lower body.

    The edges run towards decreasing x, because a body's boundary is listed anticlockwise.

    Parameters
    ----------
    upper : nodes of the upper body that may touch
    edges : edges of the lower body's upper surface in order: corner, middle, corner
    """

    def __init__(self, upper: Integers, edges: Integers) -> None:
        self.upper, self.edges = upper, edges

    def _locate(self, places: Floats) -> tuple[Integers, Floats, Booleans]:
        """For every upper node: the edge under it, position on that edge, whether there is an edge.

        The position runs from -1 to 1 along the edge.
        """
        x = places[self.upper, 0]
        ends = places[self.edges, 0]
        low, high = ends[:, 2], ends[:, 0]
        order = np.argsort(low)
        edge = order[np.clip(np.searchsorted(low[order], x, side="right") - 1, 0, len(low) - 1)]
        inside = (x >= low[edge]) & (x <= high[edge])
        a, m, b = ends[edge].T
        local = np.clip((2 * x - a - b) / (b - a), -1.0, 1.0)
        for _ in range(6):
            value = a * local * (local - 1) / 2 + m * (1 - local**2) + b * local * (local + 1) / 2
            slope = a * (local - 0.5) - 2 * m * local + b * (local + 0.5)
            local = np.clip(local - (value - x) / slope, -1.5, 1.5)
        return edge.astype(np.int64), local, inside

    def _surface_points(self, places: Floats) -> _SurfacePoints:
        edge, local, inside = self._locate(places)
        shape = np.stack((local * (local - 1) / 2, 1 - local**2, local * (local + 1) / 2), axis=1)
        slope = np.stack((local - 0.5, -2 * local, local + 0.5), axis=1)
        nodes = self.edges[edge]
        return _SurfacePoints(
            nodes,
            inside,
            shape,
            slope,
            np.einsum("sk,skd->sd", shape, places[nodes]),
            np.einsum("sk,skd->sd", slope, places[nodes]),
        )

    def gap(self, places: Floats) -> Floats:
        """Height of every upper node above the lower surface; infinite for nodes beside it [m]."""
        under = self._surface_points(places)
        above = places[self.upper, 1] - under.place[:, 1]
        return np.asarray(np.where(under.inside, above, np.inf))

    def update(
        self, touching: Booleans, force: Floats, places: Floats, pull: float
    ) -> tuple[Booleans, Floats]:
        """Update which upper nodes touch the lower body, and their contact forces.

        An open node touches if it penetrates the lower surface. A touching node separates if its
        tension reaches `pull`.
        """
        gap = self.gap(places)
        touches = np.where(touching, force > -pull, gap < -1e-10) & np.isfinite(gap)
        return touches, np.where(touches, force, 0.0)

    def _surface_slopes(self, places: Floats, unknowns: int) -> tuple[Floats, csr_matrix]:
        """Slope of the lower surface at its nodes, and its derivative by all unknowns.

        At a corner between two edges, the slope is the mean of both edges.
        """
        ends = SLOPES @ places[self.edges]
        slope = ends[..., 1] / ends[..., 0]
        weight = np.ones_like(slope)
        weight[1:, 0] = weight[:-1, 2] = 0.5
        mean = np.zeros(len(places))
        np.add.at(mean, self.edges, weight * slope)
        part = (weight / ends[..., 0])[..., None] * SLOPES
        data = np.stack((-slope[..., None] * part, part), axis=-1)
        rows = np.broadcast_to(self.edges[:, :, None, None], data.shape)
        columns = np.zeros(data.shape, dtype=np.int64)
        columns += 2 * self.edges[:, None, :, None] + np.arange(2)
        derivative = csr_matrix(
            (data.ravel(), (rows.ravel(), columns.ravel())), shape=(len(places), unknowns)
        )
        return mean, derivative

    def rows(
        self, places: Floats, touching: Booleans, force: Floats, unknowns: int
    ) -> PairContribution:
        """Gaps, force directions and stiffness of the touching nodes."""
        chosen = np.flatnonzero(touching)
        under = self._surface_points(places)
        nodes, shape = under.nodes[chosen], under.shape[chosen]
        turn, along = under.shape_slope[chosen], under.along[chosen]
        contact_nodes = np.concatenate((self.upper[chosen, None], nodes), axis=1)
        columns = (2 * contact_nodes[:, :, None] + np.arange(2)).reshape(len(chosen), 8)

        def sparse(entries: Floats) -> csr_matrix:
            place = np.repeat(np.arange(len(chosen)), 8), columns.ravel()
            return csr_matrix((entries.ravel(), place), shape=(len(chosen), unknowns))

        def spread(steep: Floats) -> Floats:
            entries = np.zeros((len(chosen), 4, 2))
            entries[:, 0, 0], entries[:, 0, 1] = -steep, 1.0
            entries[:, 1:, 0], entries[:, 1:, 1] = steep[:, None] * shape, -shape
            return entries

        corner_slope, slope_derivative = self._surface_slopes(places, unknowns)
        smooth = np.sum(shape * corner_slope[nodes], axis=1)
        size = force[chosen]
        slide = np.zeros((len(chosen), 4, 2))
        slide[:, 0, 0], slide[:, 1:, 0] = 1.0, -shape
        local = sparse(slide / along[:, :1, None])
        by_slope = np.zeros((len(chosen), 4, 2))
        by_slope[:, 0, 0], by_slope[:, 1:, 0] = -size, size[:, None] * shape
        by_place = np.zeros((len(chosen), 4, 2))
        by_place[:, 1:, 0] = (size * smooth)[:, None] * turn
        by_place[:, 1:, 1] = -size[:, None] * turn
        bend = np.sum(turn * corner_slope[nodes], axis=1)
        picked: csr_matrix = csr_matrix(
            (shape.ravel(), (np.repeat(np.arange(len(chosen)), 3), nodes.ravel())),
            shape=(len(chosen), len(places)),
        )
        slope_change = local.multiply(bend[:, None]) + picked @ slope_derivative
        change = sparse(by_slope).T @ slope_change + sparse(by_place).T @ local
        steep = along[:, 1] / along[:, 0]
        return PairContribution(
            sparse(spread(steep)).tocsc(), sparse(spread(smooth)).tocsc(), csc_matrix(-change)
        )


TOLERANCE = 1e-9
"""Largest unbalanced force of a converged solution, divided by the rubber's modulus and section."""
SMALLEST_MOVE = 1e-7
"""Newton's iteration has converged if its last step moves no node by more than this share of the
ring's section."""
FREE = "the bodies can move freely"
MOST_ITERATIONS = 40
PATIENCE, STICKING = 15, 5e-4
"""After `PATIENCE` iterations, a node may stay in contact although it is in tension, if the tension
is below `STICKING`. Where the contact ends between two nodes, the last node can satisfy neither
condition exactly: held it is in tension, released it penetrates."""
LONGEST_MOVE = 0.1
"""Largest displacement within one iteration, divided by the section."""
FLATTEST = 0.2
"""Smallest permissible volume ratio J after an iteration, divided by J before it."""


@dataclass(slots=True)
class DisplacementBounds:
    """Lower and upper bounds of all displacements; equal bounds fix a displacement."""

    lower: Floats
    upper: Floats

    @classmethod
    def none(cls, section: Assembly) -> DisplacementBounds:
        """Bounds without walls."""
        size = section.displacements
        return cls(np.full(size, -np.inf), np.full(size, np.inf))


@dataclass(slots=True)
class ElementState:
    """Unknowns, contacts and wet nodes: a complete state, from which a solution can continue.

    Parameters
    ----------
    values : displacements and Lagrange multipliers
    at_lower, at_upper : which displacements are at their lower and upper bounds
    touching : which nodes of the contact pair's upper body touch the lower body
    pair_force : contact force at each of these nodes
    wet : share of the fluid pressure that acts at every node, 0 to 1
    reaction : wall force on every displacement
    level_force : force that prevents the round section from rolling; only the asymmetry of the mesh
        causes it
    """

    values: Floats
    at_lower: Booleans
    at_upper: Booleans
    touching: Booleans
    pair_force: Floats
    wet: Floats
    reaction: Floats
    level_force: float = 0.0

    def copy(self) -> ElementState:
        """An independent copy."""
        return ElementState(
            self.values.copy(),
            self.at_lower.copy(),
            self.at_upper.copy(),
            self.touching.copy(),
            self.pair_force.copy(),
            self.wet.copy(),
            self.reaction.copy(),
            self.level_force,
        )


WetPart = Callable[["ElementState", Floats, float], Floats]
"""Function of state, node positions and pressure that returns the share of the fluid pressure
acting at every node."""
FIRST_STEP, SHORTEST_STEP, GROWTH = 0.1, 1e-3, 1.5
"""Initial and smallest pressure step, divided by the modulus; and the factor by which the step
grows after a success."""


@dataclass(slots=True)
class ElementProblem:
    """A contact problem: bodies, walls, two surfaces that may touch, and the fluid.

    Parameters
    ----------
    section : bodies
    bounds : walls
    pair : two surfaces that may touch; None with a single body
    wet_part : function that returns the share of the fluid pressure at every node
    level : two nodes that are kept at equal height, because a round section between frictionless
        walls could roll freely; None if nothing can roll
    """

    section: Assembly
    bounds: DisplacementBounds
    wet_part: WetPart
    level: tuple[int, int] | None = None
    pair: ContactPair | None = None
    steps: int = 0
    iterations: int = 0
    worst_residual: float = 0.0

    def start(self) -> ElementState:
        """Undeformed state without contact."""
        size, count = self.section.displacements, len(self.pair.upper) if self.pair else 0
        none = np.zeros(size, dtype=bool)
        return ElementState(
            np.zeros(self.section.unknowns),
            none,
            none.copy(),
            np.zeros(count, dtype=bool),
            np.zeros(count),
            np.zeros(len(self.section.nodes)),
            np.zeros(size),
        )


class NotConverged(Exception):
    """Newton's method failed in a load step; the text of the exception states the reason."""


def _update_walls(problem: ElementProblem, state: ElementState, force: Floats, pull: float) -> bool:
    """Hold nodes that pass a bound, and release nodes that a wall pulls by `pull` or more.

    Return whether any node was held or released.
    """
    bounds, displacements = problem.bounds, state.values[: problem.section.displacements]
    fixed = bounds.lower == bounds.upper
    slack = 1e-10
    lower = np.where(state.at_lower, force > -pull, displacements < bounds.lower - slack) | fixed
    upper = np.where(state.at_upper, force < pull, displacements > bounds.upper + slack) & ~fixed
    changed = bool(np.any(lower != state.at_lower) or np.any(upper != state.at_upper))
    state.at_lower, state.at_upper = lower, upper
    return changed


@dataclass(slots=True)
class _Links:
    """Constraints and their forces: one per touching node, then one that keeps two nodes level."""

    gap: Floats
    rows: csc_matrix
    directions: csc_matrix
    stiffness: csc_matrix
    force: Floats


def _links(problem: ElementProblem, state: ElementState, places: Floats) -> _Links:
    """Constraints of a state; an empty matrix if there are none."""
    unknowns = problem.section.unknowns
    none = csc_matrix((unknowns, unknowns))
    links = _Links(
        np.zeros(0), csc_matrix((0, unknowns)), csc_matrix((0, unknowns)), none, np.zeros(0)
    )
    if problem.pair is not None:
        part = problem.pair.rows(places, state.touching, state.pair_force, unknowns)
        gap = problem.pair.gap(places)[state.touching]
        force = state.pair_force[state.touching]
        links = _Links(gap, part.gaps, part.directions, part.stiffness, force)
    if problem.level is not None:
        left, right = problem.level
        row = csc_matrix(([1.0, -1.0], ([0, 0], [2 * left + 1, 2 * right + 1])), (1, unknowns))
        links.gap = np.append(links.gap, places[left, 1] - places[right, 1])
        links.rows = vstack((links.rows, row)).tocsc()
        links.directions = vstack((links.directions, row)).tocsc()
        links.force = np.append(links.force, state.level_force)
    return links


def _step(
    problem: ElementProblem,
    state: ElementState,
    force: Floats,
    stiffness: csc_matrix,
    links: _Links,
) -> tuple[Floats, Floats, float]:
    """Newton step: changes of the unknowns, new constraint forces, largest residual before it."""
    section, bounds = problem.section, problem.bounds
    fixed = np.zeros(section.unknowns, dtype=bool)
    fixed[: section.displacements] = state.at_lower | state.at_upper
    target = np.where(state.at_lower, bounds.lower, bounds.upper)
    bound, free = np.flatnonzero(fixed), np.flatnonzero(~fixed)
    move = np.zeros(section.unknowns)
    move[bound] = target[bound] - state.values[bound]
    rows = stiffness[free]
    right = np.concatenate(
        (
            -force[free] - rows[:, bound] @ move[bound],
            -links.gap - links.rows[:, bound] @ move[bound],
        )
    )
    matrix = rows[:, free]
    if len(links.gap):
        beside = -links.directions[:, free].T.tocsc()
        matrix = bmat([[matrix.tocsc(), beside], [links.rows[:, free].tocsc(), None]])
    try:
        solution = splu(matrix.tocsc()).solve(right)
    except RuntimeError as singular:
        raise NotConverged(FREE) from singular
    if not np.all(np.isfinite(solution)):
        raise NotConverged(FREE)
    move[free] = solution[: len(free)]
    return move, solution[len(free) :], float(np.max(np.abs(right), initial=0.0))


def _damped(problem: ElementProblem, state: ElementState, move: Floats) -> float:
    """Share of a Newton step to make, so that it moves no node too far and inverts no element."""
    section = problem.section
    longest = float(np.max(np.abs(move[: section.displacements])))
    share = min(1.0, LONGEST_MOVE / max(longest, 1e-300))
    least = FLATTEST * min(section.smallest_volume(state.values), 1.0)
    while section.smallest_volume(state.values + share * move) < least:
        share /= 2
        if share < 1e-3:
            raise NotConverged("an element is inverted")
    return share


@np.errstate(all="ignore")  # a trial that inverts elements is rejected by its residual
def solve(problem: ElementProblem, start: ElementState, pressure: float) -> ElementState:
    """Find the equilibrium under a fluid pressure and walls, starting from a nearby state.

    Raises
    ------
    NotConverged
        there is no equilibrium, or the iteration does not reach it; the text states the reason
    """
    section, state = problem.section, start.copy()
    size = section.displacements
    for iteration in range(MOST_ITERATIONS):
        pull = TOLERANCE if iteration < PATIENCE else STICKING
        places = section.places(state.values)
        wet = problem.wet_part(state, places, pressure) if pressure > 0 else 0 * state.wet
        changed = bool(np.max(np.abs(wet - state.wet), initial=0.0) > 1e-6)
        state.wet = wet
        if problem.pair is not None:
            touching, state.pair_force = problem.pair.update(
                state.touching, state.pair_force, places, pull
            )
            changed |= bool(np.any(touching != state.touching))
            state.touching = touching
        links = _links(problem, state, places)
        external, blocks = load(section, places, pressure * wet)
        force = section.internal(state.values) - external - links.directions.T @ links.force
        changed |= _update_walls(problem, state, force[:size], pull)
        at_wall = state.at_lower | state.at_upper
        state.reaction = np.where(at_wall, force[:size], 0.0)
        stiffness = section.stiffness(state.values, blocks) + links.stiffness
        move, force_change, error = _step(problem, state, force, stiffness, links)
        moved = float(np.max(np.abs(move[:size])))
        if not changed and error < TOLERANCE and moved < SMALLEST_MOVE:
            problem.iterations += iteration
            problem.worst_residual = max(problem.worst_residual, error)
            return state
        share = _damped(problem, state, move)
        state.values = state.values + share * move
        link_force = links.force + share * force_change
        if problem.level is not None:
            link_force, state.level_force = link_force[:-1], float(link_force[-1])
        if problem.pair is not None:
            state.pair_force = np.zeros_like(state.pair_force)
            state.pair_force[state.touching] = link_force
    problem.iterations += MOST_ITERATIONS
    raise NotConverged(f"no equilibrium within {MOST_ITERATIONS} iterations")


def raise_pressure(
    problem: ElementProblem, state: ElementState, current: float, target: float
) -> ElementState:
    """Find the equilibrium at a higher pressure, with adaptive load steps.

    Raises
    ------
    NotConverged
        the target is not reached; the text states the reached pressure and the reason
    """
    step = min(FIRST_STEP, target - current)
    while current < target:
        trial = min(target, current + step)
        if target - trial < 0.1 * step:
            trial = target
        try:
            next_state = solve(problem, state, trial)
            if np.sum(next_state.touching & ~np.roll(next_state.touching, 1)) > 1:
                raise NotConverged("a gap opens within the contact between the rings")
        except NotConverged as reason:
            step /= 2
            if step < SHORTEST_STEP:
                raise NotConverged(
                    f"{reason} at pressures above {current:.3g} times the modulus"
                ) from reason
            continue
        state, current, step = next_state, trial, step * GROWTH
        problem.steps += 1
    return state


SQUEEZE_STEP = 0.04
"""Largest increase of the squeeze in one load step."""
MOST_SQUEEZE = 0.4
"""Largest squeeze: beyond it, elements at the contact edge invert."""


def check_inputs(
    section: float,
    squeeze: float,
    rubber: MooneyRivlin,
    pressures: Sequence[float],
    elements_around: int,
    *further: tuple[bool, str, str],
) -> None:
    """Check all inputs; raise a one-line error for an invalid input.

    Parameters
    ----------
    section, squeeze, rubber, pressures, elements_around : as in `o_ring.squeezed_ring`
    further : further checks, each a tuple of a flag (True if the input is wrong), the error message
        and the remedy
    """
    rising = all(b > a for a, b in zip((0.0, *pressures), pressures, strict=False))
    checks = (
        (
            not section > 0,
            f"the section diameter {section:g} m is not positive",
            "give the diameter of the undeformed section",
        ),
        (
            not 0 < squeeze <= MOST_SQUEEZE,
            f"squeeze {squeeze:g} is outside 0 to {MOST_SQUEEZE:g}",
            "change groove depth or section",
        ),
        (
            not (rubber.c10 >= 0 and rubber.c01 >= 0 and rubber.c10 + rubber.c01 > 0),
            "the Mooney-Rivlin constants are not positive",
            "give a modulus",
        ),
        (not rising, "sealed pressures must be positive and increasing", "sort them"),
        (
            elements_around < 16 or elements_around % 4 != 0,
            f"the number of elements around the section is {elements_around}",
            "give a multiple of 4, at least 16",
        ),
        *further,
    )
    diagnostics = [Diagnostic(message, remedy) for wrong, message, remedy in checks if wrong]
    if diagnostics:
        raise ActuatorError(diagnostics)


class ElementSeal(Protocol):
    """Interface of a seal: mount it, move it to the outer groove wall, evaluate its contact."""

    problem: ElementProblem

    def mount(self, squeeze: float, groove_width: float) -> ElementState:
        """Find the equilibrium of the seal squeezed in its groove, without pressure."""

    def release(self, state: ElementState) -> ElementState:
        """Move the seal against the outer side wall, and remove all other constraints."""

    def contact(
        self, state: ElementState, pressure: float, length: float, modulus: float
    ) -> MountedContact:
        """Contact on the sliding face in SI, from a solution scaled by `length` and `modulus`."""


def follow(
    seal: ElementSeal,
    squeeze: float,
    groove_width: float,
    pressures: Sequence[float],
    length: float,
    modulus: float,
) -> SealSolution:
    """Mount a seal and raise its pressure; return its contact at every pressure.

    Parameters
    ----------
    seal : seal, made dimensionless by `length` and `modulus`
    squeeze : radial compression of the rubber ring divided by its free section [-]
    groove_width : width of the groove divided by `length`
    pressures : increasing pressures [Pa]
    length, modulus : reference length [m] and modulus [Pa]
    """
    contacts: list[MountedContact] = []
    failure, current = None, 0.0
    try:
        state = seal.mount(squeeze, groove_width)
        contacts.append(seal.contact(state, 0.0, length, modulus))
        state = seal.release(state)
        for pressure in pressures:
            state = raise_pressure(seal.problem, state, current, pressure / modulus)
            current = pressure / modulus
            contacts.append(seal.contact(state, current, length, modulus))
    except NotConverged as reason:
        failure = str(reason)
    problem = seal.problem
    return SealSolution(
        tuple(contacts), failure, problem.steps, problem.iterations, problem.worst_residual
    )
