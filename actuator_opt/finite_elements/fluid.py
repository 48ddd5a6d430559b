"""Fluid pressure on the wetted part of a boundary: a follower load at the nodes.

Simpson's rule on every three-node edge is exact for a uniform pressure: the resultant on an arc is
the pressure times the distance between its ends.
"""

from __future__ import annotations

import numpy as np

from .material import Floats
from .mesh import Integers
from .section import Section

SLOPES = np.array([[-1.5, 2.0, -0.5], [-0.5, 0.0, 0.5], [0.5, -2.0, 1.5]])
"""d(position)/d(xi) at the three nodes of an edge from their positions, xi from -1 to 1."""
SIMPSON = np.array([1.0, 4.0, 1.0]) / 3


def tangents(edges: Integers, places: Floats) -> Floats:
    """Directed lengths of every node's share of its edges, edges x 3 nodes x 2 [m]."""
    return np.asarray(SIMPSON[:, None] * (SLOPES @ places[edges]))


def shares(section: Section, places: Floats) -> Floats:
    """Directed length of each node's share of the boundary, nodes x 2 [m]."""
    total = np.zeros_like(places)
    for edges in section.edges:
        np.add.at(total, edges, tangents(edges, places))
    return total


def load(section: Section, places: Floats, pressure: Floats) -> tuple[Floats, Floats]:
    """Nodal forces of a fluid, and minus their derivative for every edge.

    Parameters
    ----------
    section : bodies
    places : current positions of the nodes [m]
    pressure : fluid pressure at every node, 0 where dry [Pa]

    Returns
    -------
    forces on all unknowns [N/m], 6 x 6 blocks for `Section.stiffness`
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
