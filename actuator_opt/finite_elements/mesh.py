"""Meshes of six-node triangles for a round section and for a slide ring with chamfer and relief.

Direction 1 runs along the cylinder from the sealed side to the outer side, direction 2 outward
from the sliding face.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from ..base.dataclass import dataclass
from .material import Floats, finite_element_library

Integers = npt.NDArray[np.int64]
ORDER = 4
"""Polynomial degree that the quadrature integrates exactly."""


@dataclass(frozen=True, slots=True)
class Mesh:
    """Mesh of a body: six-node triangles, boundary, and shape functions.

    Parameters
    ----------
    nodes : positions, n x 2 [m]
    triangles : the six nodes of every element
    corners : at the three corners of every element, the numbers of the unknowns of the Lagrange
        multiplier (a pressure that enforces the volume), from 0 to `corner_count` - 1
    corner_count : number of corner nodes, which carry the multiplier
    edges : boundary edges in order, anticlockwise: corner, middle, corner
    gradients : derivatives of the six shape functions, elements x points x 6 x 2 [1/m]
    values : the six shape functions, points x 6 [-]
    corner_values : the three shape functions of the multiplier, points x 3 [-]
    weights : areas of the integration points, elements x points [m^2]
    """

    nodes: Floats
    triangles: Integers
    corners: Integers
    corner_count: int
    edges: Integers
    gradients: Floats
    values: Floats
    corner_values: Floats
    weights: Floats


def _in_order(edges: Integers) -> Integers:
    """Sort boundary edges so that each starts where the previous edge ends."""
    following = {int(edge[0]): edge for edge in edges}
    ordered = [edges[0]]
    while len(ordered) < len(edges):
        ordered.append(following[int(ordered[-1][2])])
    return np.array(ordered)


def _boundary(triangles: Integers) -> Integers:
    """Boundary edges (corner, middle, corner), anticlockwise like the elements."""
    sides = np.concatenate(
        [triangles[:, [0, 3, 1]], triangles[:, [1, 4, 2]], triangles[:, [2, 5, 0]]]
    )
    ends = np.sort(sides[:, [0, 2]], axis=1)
    _, first, count = np.unique(ends, axis=0, return_index=True, return_counts=True)
    return _in_order(sides[first[count == 1]])


def meshed(points: Floats, triangles: Integers, radius: float | None = None) -> Mesh:
    """Mesh a body from corner points and triangles.

    Parameters
    ----------
    points : corner positions, n x 2 [m]
    triangles : three corners each, in either orientation
    radius : radius of a round section about the origin [m], onto which the midside nodes of the
        boundary are moved; None for straight edges
    """
    library = finite_element_library()
    a, b, c = (points[triangles[:, k]] for k in range(3))
    turn = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    triangles = np.where(turn[:, None] > 0, triangles, triangles[:, [0, 2, 1]])
    straight = library.MeshTri(points.T.copy(), triangles.T.copy(), sort_t=False)
    curved = library.MeshTri2.from_mesh(straight)
    nodes = curved.doflocs.T.copy()
    numbered = library.Basis(curved, library.ElementTriP2()).element_dofs.T.astype(np.int64)
    edges = _boundary(numbered)
    if radius is not None:
        middle = nodes[edges[:, 1]]
        nodes[edges[:, 1]] = radius * middle / np.linalg.norm(middle, axis=1)[:, None]
        curved = library.MeshTri2(nodes.T.copy(), straight.t.copy(), sort_t=False)
    basis = library.Basis(curved, library.ElementTriP2(), intorder=ORDER)
    corner = library.Basis(curved, library.ElementTriP1(), intorder=ORDER)
    if not np.array_equal(basis.element_dofs.T, numbered):  # the library must keep the numbering
        raise AssertionError("nodes were renumbered")
    shape = [np.asarray(basis.basis[k][0]) for k in range(6)]
    return Mesh(
        nodes=nodes,
        triangles=numbered,
        corners=corner.element_dofs.T.astype(np.int64),
        corner_count=int(corner.N),
        edges=edges,
        gradients=np.moveaxis(np.array([basis.basis[k][0].grad for k in range(6)]), (2, 3), (0, 1)),
        values=np.array([s[0] if s.ndim == 2 else s for s in shape]).T,
        corner_values=np.array([np.atleast_2d(corner.basis[k][0])[0] for k in range(3)]).T,
        weights=np.asarray(basis.dx),
    )


def disc(*, diameter: float, around: int) -> Mesh:
    """Mesh a round section about the origin, finely at its edge and more coarsely inside.

    Parameters
    ----------
    diameter : diameter of the section [m]
    around : number of elements along its circumference, a multiple of 4
    """
    from scipy.spatial import Delaunay

    radius = diameter / 2
    spacing = 2 * math.pi * radius / around
    place, count, rings, turned = radius, around, [], 0.0
    while place > 0.6 * spacing:
        angle = 2 * math.pi * (np.arange(count) + turned) / count
        rings.append(place * np.stack((np.cos(angle), np.sin(angle)), axis=1))
        place -= 0.87 * spacing
        spacing *= 1.3
        turned = 0.5 - turned
        count = max(4 * round(2 * math.pi * max(place, 0.0) / spacing / 4), 4)
    points = np.concatenate([*rings, np.zeros((1, 2))])
    return meshed(points, Delaunay(points).simplices.astype(np.int64), radius)


@dataclass(frozen=True, slots=True)
class SlideRing:
    """Section of a slide ring with a chamfer on the sealed side and a relief behind its land.

    Parameters
    ----------
    width : axial width [m]
    thickness : thickness from land to back [m]
    land_width : axial width of the land, the flat part of the sliding face [m]
    chamfer_width, chamfer_height : chamfer on the sealed side of the land [m]
    relief_angle : angle between rod and the ring's face on the outer side of the land [rad]
    edge_radius : radius at both ends of the land [m]
    """

    width: float
    thickness: float
    land_width: float
    chamfer_width: float
    chamfer_height: float
    relief_angle: float
    edge_radius: float

    def over(self, length: float) -> SlideRing:
        """The same section, with all dimensions divided by a length [m]."""
        sizes = {name: getattr(self, name) / length for name in self.__slots__}
        return SlideRing(**{**sizes, "relief_angle": self.relief_angle})

    @property
    def land(self) -> tuple[float, float]:
        """Positions of the land's ends, from the outer end of the ring; both negative [m]."""
        first = self.chamfer_width - self.width
        return first, first + self.land_width

    def face(self, x: Floats) -> Floats:
        """Height of the undeformed sliding face above the rod; x = 0 is the outer end [m]."""
        first, last = self.land
        before = math.atan2(self.chamfer_height, self.chamfer_width)
        return np.asarray(
            _rounded(first - x, before, self.edge_radius)
            + _rounded(x - last, self.relief_angle, self.edge_radius)
        )


def _rounded(distance: Floats, angle: float, radius: float) -> Floats:
    """Height of a face that is flat up to distance 0, then rises at an angle; the bend is round."""
    reach = radius * math.tan(angle / 2)
    arc = radius - np.sqrt(np.maximum(radius**2 - np.clip(distance + reach, 0, radius) ** 2, 0))
    along = math.tan(angle) * distance
    inside = distance < reach * math.cos(angle)
    return np.asarray(np.where(distance <= -reach, 0.0, np.where(inside, arc, along)))


def _graded(start: float, end: float, fine: float, coarse: float, growth: float) -> Floats:
    """Positions from start to end, with a spacing that grows from `fine` to at most `coarse`."""
    places, step, length = [0.0], fine, abs(end - start)
    while places[-1] < length:
        places.append(places[-1] + step)
        step = min(step * growth, coarse)
    return np.asarray(start + (end - start) * np.array(places) / places[-1])


def slide_ring(shape: SlideRing, *, fine: float, coarse: float) -> Mesh:
    """Mesh of a slide ring with its outer end at x = 0, fine at both ends of the land.

    Parameters
    ----------
    shape : dimensions of the section
    fine, coarse : spacing of the elements at the ends of the land, and elsewhere [m]
    """
    first, last = shape.land
    middle, land = (first + last) / 2, min(coarse, shape.land_width / 8)
    columns = np.concatenate(
        (
            _graded(first, -shape.width, fine, coarse, 1.3)[::-1],
            _graded(first, middle, fine, land, 1.3)[1:],
            _graded(last, middle, fine, land, 1.3)[-2::-1],
            _graded(last, 0.0, fine, coarse, 1.3)[1:],
        )
    )
    rows = _graded(0.0, 1.0, fine / shape.thickness, coarse / shape.thickness, 1.4)
    bottom = shape.face(columns)
    height = bottom[:, None] + rows * (shape.thickness - bottom[:, None])
    points = np.stack((np.repeat(columns, len(rows)), height.ravel()), axis=1)
    corner = np.arange(len(columns) * len(rows)).reshape(len(columns), len(rows))
    a, b = corner[:-1, :-1].ravel(), corner[1:, :-1].ravel()
    c, d = corner[1:, 1:].ravel(), corner[:-1, 1:].ravel()
    triangles = np.concatenate((np.stack((a, b, c), axis=1), np.stack((a, c, d), axis=1)))
    return meshed(points, triangles)
