"""Contact pressures from wall forces, and the pressure profile on the sliding face."""

from __future__ import annotations

import numpy as np

from . import equilibrium
from .equilibrium import Booleans, ElementState, NotConverged
from .material import Floats
from .mesh import Integers
from .section import Assembly, MountedContact, contact_end, stress_field

HOLDING = 0.05
"""Share by which the contact pressure at a sealing node may fall below the fluid pressure before
the node opens."""


def boundary_nodes(section: Assembly, body: int) -> Integers:
    """Boundary nodes of a body in order, anticlockwise."""
    return np.asarray(section.edges[body][:, :2].ravel())


def middle_node(section: Assembly, nodes: int) -> int:
    """Node at the centre of the round section, which must be the first body."""
    places = section.nodes[:nodes]
    middle = (places.min(axis=0) + places.max(axis=0)) / 2
    return int(np.argmin(np.sum((places - middle) ** 2, axis=1)))


def level_pair(section: Assembly, nodes: int, middle: float) -> tuple[int, int]:
    """Two inner nodes of the round section, left and right of its centre at the same height."""
    places = section.nodes[:nodes]
    centre = float(places[:, 0].min() + places[:, 0].max()) / 2
    on_line = np.flatnonzero(np.abs(places[:, 1] - middle) < 1e-9)
    offset = places[on_line, 0] - centre
    pairs = [
        (abs(float(a) - 0.25), int(on_line[np.argmin(np.abs(offset + a))]), int(on_line[k]))
        for k, a in enumerate(offset)
        if a > 0 and np.min(np.abs(offset + a)) < 1e-9
    ]
    _, left, right = min(pairs)
    return left, right


def wall_pressing(section: Assembly, state: ElementState) -> Floats:
    """Force that the walls above and below exert on every node, positive if they push it."""
    force = state.reaction.reshape(-1, 2)[:, 1]
    lower = state.at_lower.reshape(-1, 2)[:, 1]
    return np.asarray(np.where(lower, force, -force))


def barriers(
    section: Assembly, state: ElementState, places: Floats, pressing: Floats, pressure: float
) -> Floats:
    """Contact pressure at every node, 0 where nothing touches.

    It is the contact force per area, plus the fluid pressure at nodes that the fluid has reached.
    """
    length = np.abs(equilibrium.shares(section, places)[:, 0]) * section.radii(places)
    total = pressing / np.maximum(length, 1e-12) + state.wet * pressure
    return np.asarray(np.where(pressing != 0, total, 0.0))


def both_ways(boundary: Integers, start: int) -> tuple[Integers, Integers]:
    """All nodes of a closed boundary, listed anticlockwise and clockwise.

    `start` is the index in `boundary` of the node at which both lists start.
    """
    return np.roll(boundary, -start), np.roll(boundary[::-1], start + 1)


def wetted(
    chain: Integers, barrier: Floats, state: ElementState, pressure: float
) -> tuple[Integers, int | None]:
    """Nodes of a chain that the fluid reaches; and index of its first node at the outer side wall.

    The index is None if the chain has no node at this wall.

    The fluid advances to the first node whose contact pressure exceeds the fluid pressure. That
    node seals until its contact pressure is below the fluid pressure by the share `HOLDING`. The
    mesh resolves the fluid front only to one node. Without this hysteresis, the iteration could
    therefore alternate between two states.

    Parameters
    ----------
    chain : boundary nodes in order, from the sealed side
    barrier : contact pressure at every node, 0 where nothing touches
    state : solution, with the nodes that were wet before and those that touch the outer side wall
    pressure : pressure of the fluid
    """
    needed = pressure * np.where(state.wet[chain] > 0, 1.0, 1.0 - HOLDING)
    stops = np.flatnonzero(barrier[chain] > needed)
    wall = np.flatnonzero(state.at_upper[2 * chain])
    last = int(wall[0]) if len(wall) else None
    end = int(stops[0]) if len(stops) else len(chain)
    return chain[: end if last is None else min(end, last)], last


def profile_on_face(
    section: Assembly,
    state: ElementState,
    places: Floats,
    boundary: Integers,
    touching: Booleans,
    pressure: float,
    force: Floats,
) -> tuple[float, Floats, Floats, float]:
    """The dry contact on the sliding face: where it starts, its pressure profile, and its load.

    The profile consists of positions, counted from the start, and of the contact pressures there.

    Parameters
    ----------
    section, state, places : bodies, solution, and current positions of the nodes
    boundary : boundary nodes of the sliding body, anticlockwise, so that x increases on the face
    touching : whether a node is in contact with the sliding face
    pressure : pressure of the fluid
    force : force of the sliding face on every node
    """
    dry = np.flatnonzero(touching[boundary] & (state.wet[boundary] == 0))
    if not len(dry):
        raise NotConverged("the ring does not touch the sliding face")
    along = places[boundary[dry], 0]
    turn = int(dry[np.argmin(along)])
    chain = np.roll(boundary, -turn)
    count = (int(dry[np.argmax(along)]) - turn) % len(boundary) + 1
    nodes, open_nodes, after = chain[:count], chain[[-1, -2]], chain[[count, count + 1]]
    x = places[nodes, 0]
    start = contact_end(float(x[0]), places[open_nodes, 1], places[open_nodes, 0])
    end = contact_end(float(x[-1]), places[after, 1], places[after, 0])
    # Simpson's rule gives a corner 1/6 of each adjacent edge, a middle node 2/3 of its edge
    before = places[chain[-1], 0]
    lent = (1 / 3 if turn % 2 else 2 / 3) * (x[0] - before)
    share = np.abs(equilibrium.shares(section, places)[nodes, 0])
    inner = force[nodes] / (share * section.radii(places)[nodes])
    distinct = (x - start > 1e-6) & (end - x > 1e-6)
    positions = np.concatenate(([0.0], x[distinct] - start, [end - start]))
    return (
        start,
        positions,
        np.concatenate(([pressure], inner[distinct], [0.0])),
        float(np.sum(force[nodes]) + pressure * (before + lent - start)),
    )


def mounted_contact(
    section: Assembly,
    state: ElementState,
    boundary: Integers,
    pressure: float,
    length: float,
    modulus: float,
    *,
    wall: float = 0.0,
) -> MountedContact:
    """Contact on the sliding face, converted from a dimensionless solution to SI.

    Parameters
    ----------
    section, state : bodies and solution, made dimensionless by `length` and `modulus`
    boundary : boundary nodes of the sliding body in order, anticlockwise
    pressure : sealed pressure divided by the modulus
    length, modulus : reference length [m] and modulus [Pa] of the dimensionless solution
    wall : position of the outer groove wall divided by `length`
    """
    force = state.reaction.reshape(-1, 2)
    start, positions, contact_pressure, line_load = profile_on_face(
        section,
        state,
        section.places(state.values),
        boundary,
        state.at_lower.reshape(-1, 2)[:, 1],
        pressure,
        force[:, 1],
    )
    upper = state.at_upper.reshape(-1, 2)
    return MountedContact(
        pressure=pressure * modulus,
        positions=positions * length,
        contact_pressure=contact_pressure * modulus,
        width=float(positions[-1]) * length,
        line_load=line_load * length * modulus,
        peak_pressure=float(np.max(contact_pressure)) * modulus,
        opposite_load=float(-np.sum(force[upper[:, 1], 1])) * length * modulus,
        side_load=float(-np.sum(force[upper[:, 0], 0])) * length * modulus,
        start=(start - wall) * length,
        field=stress_field(section, state.values, length, modulus),
    )
