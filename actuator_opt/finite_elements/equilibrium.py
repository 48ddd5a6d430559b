"""Newton's method with walls as bounds of the displacements: contact without a penalty.

A wall parallel to an axis bounds one displacement component of every boundary node. A node at its
bound stays there as long as the wall pushes it; the force is the reaction of the wall. The fluid
reaches all boundary nodes from the sealed side up to the first node whose contact pressure exceeds
the fluid pressure.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import bmat, csc_matrix, vstack
from scipy.sparse.linalg import splu

from . import fluid
from .material import Floats
from .pair import Booleans, Pair
from .section import Section

TOLERANCE = 1e-9
"""Largest unbalanced force, relative to modulus times section."""
SMALLEST_MOVE = 1e-7
"""Largest step of a converged iteration, relative to the section."""
FREE = "the bodies can move freely"
MOST_ITERATIONS = 40
PATIENCE, STICKING = 15, 5e-4
"""After this many iterations a node with so small a tension may stay in contact: the contact end
lies between two nodes, and holding or releasing the last node may both be wrong."""
LONGEST_MOVE = 0.1
"""Largest displacement of an iteration; the section is 1."""
FLATTEST = 0.2
"""Smallest J after an iteration, relative to the previous J."""


@dataclass(slots=True)
class Bounds:
    """Bounds of all displacements; equal bounds fix a node."""

    lower: Floats
    upper: Floats

    @classmethod
    def none(cls, section: Section) -> Bounds:
        """No walls."""
        size = section.displacements
        return cls(np.full(size, -np.inf), np.full(size, np.inf))


@dataclass(slots=True)
class ElementState:
    """Unknowns, contacts and fluid: a complete state to continue from.

    Parameters
    ----------
    values : displacements and multipliers
    at_lower, at_upper : displacements at their bound
    touching : nodes of the pair's upper body in contact
    pair_force : force of the pair at each of these nodes
    wet : share of the fluid pressure at every node, 0 to 1
    reaction : wall force on every displacement
    level_force : force that keeps the level pair level, due to mesh asymmetry only
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
"""Share of the pressure at every node, from state, node places and pressure."""
FIRST_STEP, SHORTEST_STEP, GROWTH = 0.1, 1e-3, 1.5
"""Steps of pressure over modulus: initial, smallest, and growth after a success."""


@dataclass(slots=True)
class ElementProblem:
    """Bodies, a pair in contact, and the region of the fluid.

    Parameters
    ----------
    section : bodies
    bounds : walls
    pair : two surfaces that may touch; None with a single body
    wet_part : returns the nodes that the fluid reaches
    level : two nodes kept level, because a round section between frictionless walls could roll
        without effect; None if nothing can roll
    """

    section: Section
    bounds: Bounds
    wet_part: WetPart
    level: tuple[int, int] | None = None
    pair: Pair | None = None
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
    """Newton's method failed in a load step; the text states the reason."""


def _update_walls(problem: ElementProblem, state: ElementState, force: Floats, pull: float) -> bool:
    """Hold nodes that pass a bound, release nodes under tension; whether anything changed."""
    bounds, moved = problem.bounds, state.values[: problem.section.displacements]
    held = bounds.lower == bounds.upper
    slack = 1e-10
    lower = np.where(state.at_lower, force > -pull, moved < bounds.lower - slack) | held
    upper = np.where(state.at_upper, force < pull, moved > bounds.upper + slack) & ~held
    changed = bool(np.any(lower != state.at_lower) or np.any(upper != state.at_upper))
    state.at_lower, state.at_upper = lower, upper
    return changed


@dataclass(slots=True)
class _Links:
    """Constraints with a force each: touching nodes of the pair, then the level pair."""

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
    """Newton step of the unknowns and the constraint forces, and the largest previous error."""
    section, bounds = problem.section, problem.bounds
    fixed = np.zeros(section.unknowns, dtype=bool)
    fixed[: section.displacements] = state.at_lower | state.at_upper
    target = np.where(state.at_lower, bounds.lower, bounds.upper)
    held, free = np.flatnonzero(fixed), np.flatnonzero(~fixed)
    move = np.zeros(section.unknowns)
    move[held] = target[held] - state.values[held]
    rows = stiffness[free]
    right = np.concatenate(
        (
            -force[free] - rows[:, held] @ move[held],
            -links.gap - links.rows[:, held] @ move[held],
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
    """Share of a step that limits displacement and inverts no element."""
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
    """Equilibrium under a fluid pressure and walls, from a neighbouring state.

    Raises
    ------
    NotConverged
        With the reason in words.
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
        external, blocks = fluid.load(section, places, pressure * wet)
        force = section.internal(state.values) - external - links.directions.T @ links.force
        changed |= _update_walls(problem, state, force[:size], pull)
        held = state.at_lower | state.at_upper
        state.reaction = np.where(held, force[:size], 0.0)
        stiffness = section.stiffness(state.values, blocks) + links.stiffness
        move, added, error = _step(problem, state, force, stiffness, links)
        moved = float(np.max(np.abs(move[:size])))
        if not changed and error < TOLERANCE and moved < SMALLEST_MOVE:
            problem.iterations += iteration
            problem.worst_residual = max(problem.worst_residual, error)
            return state
        share = _damped(problem, state, move)
        state.values = state.values + share * move
        after = links.force + share * added
        if problem.level is not None:
            after, state.level_force = after[:-1], float(after[-1])
        if problem.pair is not None:
            state.pair_force = np.zeros_like(state.pair_force)
            state.pair_force[state.touching] = after
    problem.iterations += MOST_ITERATIONS
    raise NotConverged(f"no equilibrium within {MOST_ITERATIONS} iterations")


def raise_pressure(
    problem: ElementProblem, state: ElementState, reached: float, wanted: float
) -> ElementState:
    """Equilibrium at a higher pressure, with adaptive load steps.

    Raises
    ------
    NotConverged
        With the reached pressure and the reason.
    """
    step = min(FIRST_STEP, wanted - reached)
    while reached < wanted:
        trial = min(wanted, reached + step)
        if wanted - trial < 0.1 * step:
            trial = wanted
        try:
            found = solve(problem, state, trial)
            if np.sum(found.touching & ~np.roll(found.touching, 1)) > 1:
                raise NotConverged("the contact between the rings opens in its interior")
        except NotConverged as reason:
            step /= 2
            if step < SHORTEST_STEP:
                raise NotConverged(f"{reason} beyond {reached:.3g} of the modulus") from reason
            continue
        state, reached, step = found, trial, step * GROWTH
        problem.steps += 1
    return state
