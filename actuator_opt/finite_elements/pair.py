"""Frictionless contact of two bodies: nodes of the upper body on the surface of the lower body.

The gap is measured along direction 2, g = y_node - y_surface(x_node). The force is normal to the
surface. Its slope is made continuous from edge to edge, since a node that slides over the corner
between two edges would otherwise oscillate.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.sparse import csc_matrix, csr_matrix

from .fluid import SLOPES
from .material import Floats
from .mesh import Integers

Booleans = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Rows:
    """Contribution of a pair to Newton's equations.

    Parameters
    ----------
    gaps : derivative of the touching nodes' gaps by all unknowns
    directions : unit forces of the touching nodes on all unknowns
    stiffness : derivative of the forces at their current size
    """

    gaps: csc_matrix
    directions: csc_matrix
    stiffness: csc_matrix


@dataclass(frozen=True, slots=True)
class _Under:
    """The surface under every upper node: three nodes, shape functions, slope."""

    nodes: Integers
    inside: Booleans
    shape: Floats
    shape_slope: Floats
    place: Floats
    along: Floats


class Pair:
    """Upper nodes and lower edges; the edges run towards decreasing x, as on an upper surface.

    Parameters
    ----------
    upper : nodes of the upper body that may touch
    edges : edges of the lower body's upper surface in order: corner, middle, corner
    """

    def __init__(self, upper: Integers, edges: Integers) -> None:
        self.upper, self.edges = upper, edges

    def _locate(self, places: Floats) -> tuple[Integers, Floats, Booleans]:
        """Edge under every node, local coordinate from -1 to 1, and whether an edge exists."""
        x = places[self.upper, 0]
        ends = places[self.edges, 0]
        low, high = ends[:, 2], ends[:, 0]
        order = np.argsort(low)
        found = order[np.clip(np.searchsorted(low[order], x, side="right") - 1, 0, len(low) - 1)]
        inside = (x >= low[found]) & (x <= high[found])
        a, m, b = ends[found].T
        local = np.clip((2 * x - a - b) / (b - a), -1.0, 1.0)
        for _ in range(6):
            value = a * local * (local - 1) / 2 + m * (1 - local**2) + b * local * (local + 1) / 2
            slope = a * (local - 0.5) - 2 * m * local + b * (local + 0.5)
            local = np.clip(local - (value - x) / slope, -1.5, 1.5)
        return found.astype(np.int64), local, inside

    def _under(self, places: Floats) -> _Under:
        found, local, inside = self._locate(places)
        shape = np.stack((local * (local - 1) / 2, 1 - local**2, local * (local + 1) / 2), axis=1)
        slope = np.stack((local - 0.5, -2 * local, local + 0.5), axis=1)
        nodes = self.edges[found]
        return _Under(
            nodes,
            inside,
            shape,
            slope,
            np.einsum("sk,skd->sd", shape, places[nodes]),
            np.einsum("sk,skd->sd", slope, places[nodes]),
        )

    def gap(self, places: Floats) -> Floats:
        """Distance of every upper node above the surface; infinite beside it [m]."""
        under = self._under(places)
        above = places[self.upper, 1] - under.place[:, 1]
        return np.asarray(np.where(under.inside, above, np.inf))

    def update(
        self, touching: Booleans, force: Floats, places: Floats, pull: float
    ) -> tuple[Booleans, Floats]:
        """Touching nodes and their forces; nodes under tension separate."""
        gap = self.gap(places)
        after = np.where(touching, force > -pull, gap < -1e-10) & np.isfinite(gap)
        return after, np.where(after, force, 0.0)

    def _surface_slopes(self, places: Floats, unknowns: int) -> tuple[Floats, csr_matrix]:
        """Slope of the surface at its nodes, averaged at corners; and its derivative."""
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

    def rows(self, places: Floats, touching: Booleans, force: Floats, unknowns: int) -> Rows:
        """Gaps, directions and stiffness of the touching nodes."""
        chosen = np.flatnonzero(touching)
        under = self._under(places)
        nodes, shape = under.nodes[chosen], under.shape[chosen]
        turn, along = under.shape_slope[chosen], under.along[chosen]
        four = np.concatenate((self.upper[chosen, None], nodes), axis=1)
        columns = (2 * four[:, :, None] + np.arange(2)).reshape(len(chosen), 8)

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
        return Rows(
            sparse(spread(steep)).tocsc(), sparse(spread(smooth)).tocsc(), csc_matrix(-change)
        )
