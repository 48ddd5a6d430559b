"""Newton's method with walls that bound the displacements: contact without a penalty.

A wall that stands along an axis bounds one displacement component of every boundary node. A node
at its bound is held there as long as the wall pushes it; the force is the wall's own reaction.
The fluid reaches every boundary node from the sealed side up to the first one that is pressed
more strongly than the fluid presses.
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
"""Force left unbalanced, of modulus times section."""
SMALLEST_MOVE = 1e-7
"""Step of an iteration that changes nothing any more, of the section."""
FREE = "the bodies are not held against moving freely"
MOST_ITERATIONS = 40
PATIENCE, STICKING = 15, 5e-4
"""After so many iterations a node may be held by so small a pull: the end of a contact lies
between two nodes, and holding or releasing the last one may both be wrong."""
LONGEST_MOVE = 0.1
"""Largest displacement of one iteration; the section is 1."""
FLATTEST = 0.2
"""Smallest J an iteration may reach, as a share of the last one."""


@dataclass(slots=True)
class Bounds:
    """Bounds of every displacement; equal bounds hold a node."""

    lower: Floats
    upper: Floats

    @classmethod
    def none(cls, section: Section) -> Bounds:
        """No wall anywhere."""
        size = section.displacements
        return cls(np.full(size, -np.inf), np.full(size, np.inf))


@dataclass(slots=True)
class ElementState:
    """Unknowns, what touches what, and the fluid: enough to go on from.

    Parameters
    ----------
    values : displacements and multipliers
    at_lower, at_upper : displacements held at their bound
    touching : nodes of the pair's upper body in contact
    pair_force : force of the pair at each of them
    wet : share of the fluid's pressure that every node feels, 0 to 1
    reaction : force of walls on every displacement
    level_force : what keeps the level pair level, nothing but the mesh's unevenness
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
"""Steps of pressure over modulus: the first, the shortest, and the growth after a success."""


@dataclass(slots=True)
class ElementProblem:
    """Bodies, a pair that may touch, and where the fluid goes.

    Parameters
    ----------
    section : bodies
    bounds : walls
    pair : two surfaces that may touch, None with one body
    wet_part : tells which nodes the fluid reaches
    level : two nodes kept level with each other: a round section between frictionless walls is
        free to roll, and every rolled place of it is the same; None when nothing can roll
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
        """Nothing moved, nothing touches."""
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
    """A load step that Newton's method could not make; the text says why."""


def _update_walls(problem: ElementProblem, state: ElementState, force: Floats, pull: float) -> bool:
    """Hold what passes its bound, release what is pulled more; whether anything changed."""
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
    """Conditions with a force each: nodes of the pair that touch, then the level pair."""

    gap: Floats
    rows: csc_matrix
    directions: csc_matrix
    stiffness: csc_matrix
    force: Floats


def _links(problem: ElementProblem, state: ElementState, places: Floats) -> _Links:
    """The conditions of a state; none is an empty matrix."""
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
    """Newton's step of the unknowns and of the links' forces, and the largest error before it."""
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
    """Share of a step that neither moves too far nor turns an element inside out."""
    section = problem.section
    longest = float(np.max(np.abs(move[: section.displacements])))
    share = min(1.0, LONGEST_MOVE / max(longest, 1e-300))
    least = FLATTEST * min(section.smallest_volume(state.values), 1.0)
    while section.smallest_volume(state.values + share * move) < least:
        share /= 2
        if share < 1e-3:
            raise NotConverged("an element is turned inside out")
    return share


@np.errstate(all="ignore")  # a trial that turns elements inside out is judged by its balance
def solve(problem: ElementProblem, start: ElementState, pressure: float) -> ElementState:
    """Equilibrium under a fluid pressure within the walls, from a neighbouring state.

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
    """Equilibrium at a higher pressure, in steps as long as Newton's method can make them.

    Raises
    ------
    NotConverged
        With the pressure that was reached and the reason.
    """
    step = min(FIRST_STEP, wanted - reached)
    while reached < wanted:
        trial = min(wanted, reached + step)
        if wanted - trial < 0.1 * step:
            trial = wanted
        try:
            found = solve(problem, state, trial)
            if np.sum(found.touching & ~np.roll(found.touching, 1)) > 1:
                raise NotConverged("the contact between the rings opens inside")
        except NotConverged as reason:
            step /= 2
            if step < SHORTEST_STEP:
                raise NotConverged(f"{reason} beyond {reached:.3g} of the modulus") from reason
            continue
        state, reached, step = found, trial, step * GROWTH
        problem.steps += 1
    return state
