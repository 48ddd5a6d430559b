"""Cross-sections of rings in finite elements: bodies, their assembly, contacts and stresses."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csc_matrix

from ..base.dataclass import dataclass
from . import material
from .material import Floats, MooneyRivlin
from .mesh import Integers, Mesh


@dataclass(frozen=True, slots=True)
class MeshedBody:
    """A mesh with its material and position.

    Parameters
    ----------
    mesh : nodes and elements
    rubber : strain energy of the material
    place : position of the mesh origin [m]
    """

    mesh: Mesh
    rubber: MooneyRivlin
    place: tuple[float, float] = (0.0, 0.0)


class Assembly:
    """All bodies, with a common vector of unknowns.

    Unknowns 2 i and 2 i + 1 are the axial and the radial displacement of node i. The Lagrange
    multipliers q of the volume constraint follow.

    Parameters
    ----------
    bodies : meshes with their materials
    sliding_radius : radius of the sliding face, where coordinate 2 is zero [m]; None for plane
        strain
    outward : 1 if direction 2 points away from the axis (rod), -1 towards it (bore)
    """

    def __init__(
        self,
        bodies: Sequence[MeshedBody],
        sliding_radius: float | None = None,
        outward: int = 1,
    ) -> None:
        nodes, triangles, corners, self.edges = [], [], [], []
        self.first_node = [0]
        corner_total = 0
        for body in bodies:
            nodes.append(body.mesh.nodes + np.asarray(body.place))
            triangles.append(body.mesh.triangles + self.first_node[-1])
            corners.append(body.mesh.corners + corner_total)
            self.edges.append(body.mesh.edges + self.first_node[-1])
            self.first_node.append(self.first_node[-1] + len(body.mesh.nodes))
            corner_total += body.mesh.corner_count
        self.nodes: Floats = np.concatenate(nodes)
        self.triangles: Integers = np.concatenate(triangles)
        self.corners: Integers = np.concatenate(corners)
        self.displacements = 2 * len(self.nodes)
        self.unknowns = self.displacements + corner_total
        self.sliding_radius, self.outward = sliding_radius, outward
        owners = [np.full(len(body.mesh.triangles), k) for k, body in enumerate(bodies)]
        owner = np.concatenate(owners)
        c10, c01, softness = (
            np.array(values)[owner][:, None]
            for values in zip(
                *((b.rubber.c10, b.rubber.c01, 1 / b.rubber.volume_stiffness) for b in bodies),
                strict=True,
            )
        )
        self.c10: Floats = c10
        self.c01: Floats = c01
        self.softness: Floats = softness
        self._shape(bodies)
        self._pattern()

    def _shape(self, bodies: Sequence[MeshedBody]) -> None:
        """Set the derivatives of the deformation gradient by the displacements of each element.

        The gradient F has five components, an element twelve displacements. Also set the
        integration weights.
        """
        gradients = np.concatenate([b.mesh.gradients for b in bodies])
        self.weights: Floats = np.concatenate([b.mesh.weights for b in bodies])
        values = bodies[0].mesh.values
        self.corner_values: Floats = bodies[0].mesh.corner_values
        count, points = self.weights.shape
        shape = np.zeros((count, points, 5, 6, 2))
        for component, (i, j) in enumerate(material.COMPONENTS[:4]):
            shape[:, :, component, :, i] = gradients[..., j]
        if self.sliding_radius is not None:
            radius = np.einsum("pa,ea->ep", values, self.radii(self.nodes)[self.triangles])
            hoop = self.outward / (self.sliding_radius * radius[..., None])
            shape[:, :, 4, :, 1] = values * hoop
            self.weights = self.weights * radius
        self.shape: Floats = shape.reshape(count, points, 5, 12)
        self.flat_shape: Floats = self.shape.reshape(count, points * 5, 12)

    def _pattern(self) -> None:
        """Set which entries of the sparse stiffness matrix each element and edge contributes to."""
        displacement_dofs = (2 * self.triangles[:, :, None] + np.arange(2)).reshape(
            len(self.triangles), 12
        )
        self.element_unknowns = np.concatenate(
            (displacement_dofs, self.displacements + self.corners), axis=1
        )
        chain = np.concatenate(self.edges)
        self.edge_unknowns = (2 * chain[:, :, None] + np.arange(2)).reshape(len(chain), 6)
        rows, columns = [], []
        for dofs in (self.element_unknowns, self.edge_unknowns):
            width = dofs.shape[1]
            rows.append(np.repeat(dofs, width, axis=1).ravel())
            columns.append(np.tile(dofs, (1, width)).ravel())
        row, column = np.concatenate(rows), np.concatenate(columns)
        keys, self._slot = np.unique(column * self.unknowns + row, return_inverse=True)
        self._indices = keys % self.unknowns
        self._pointers = np.searchsorted(keys // self.unknowns, np.arange(self.unknowns + 1))

    def gradient(self, state: Floats) -> tuple[Floats, Floats]:
        """Deformation gradient and multiplier at the integration points."""
        unknown = state[self.element_unknowns]
        identity = np.array([1.0, 0.0, 0.0, 1.0, 1.0])
        moved = np.einsum("epck,ek->epc", self.shape, unknown[:, :12], optimize=True)
        return identity + moved, unknown[:, 12:] @ self.corner_values.T

    def smallest_volume(self, state: Floats) -> float:
        """Smallest J of all integration points; it must stay positive."""
        gradient, _ = self.gradient(state)
        return float(np.min(material.inverse_transpose(gradient)[1]))

    def internal(self, state: Floats) -> Floats:
        """Residual vector: internal forces at the nodes, then volume errors at the multipliers."""
        gradient, multiplier = self.gradient(state)
        nominal = material.stress(gradient, multiplier, self.c10, self.c01)
        _, volume = material.inverse_transpose(gradient)
        weighted = (nominal * self.weights[..., None]).reshape(len(self.triangles), 1, -1)
        error = (volume - 1 - multiplier * self.softness) * self.weights
        entries = np.concatenate(
            ((weighted @ self.flat_shape)[:, 0], error @ self.corner_values), axis=1
        )
        total = np.bincount(self.element_unknowns.ravel(), entries.ravel(), minlength=self.unknowns)
        return np.asarray(total)

    def stiffness(self, state: Floats, edge_blocks: Floats) -> csc_matrix:
        """Derivative of `internal`, to which the fluid's 6 x 6 block is added for every edge."""
        gradient, multiplier = self.gradient(state)
        count, points = self.weights.shape
        slope = material.tangent(gradient, multiplier, self.c10, self.c01)
        weighted = (slope * self.weights[..., None, None]) @ self.shape
        block = np.zeros((count, 15, 15))
        flat = np.swapaxes(self.flat_shape, 1, 2)
        block[:, :12, :12] = flat @ weighted.reshape(count, points * 5, 12)
        inverse, volume = material.inverse_transpose(gradient)
        coupling = (inverse * (volume * self.weights)[..., None])[..., None]
        coupling = (coupling * self.corner_values[None, :, None, :]).reshape(count, points * 5, 3)
        block[:, :12, 12:] = flat @ coupling
        block[:, 12:, :12] = np.swapaxes(block[:, :12, 12:], 1, 2)
        soft = np.einsum("ep,pa,pb->eab", self.weights, self.corner_values, self.corner_values)
        block[:, 12:, 12:] = -soft * self.softness[:, :, None]
        data = np.bincount(
            self._slot,
            np.concatenate((block.ravel(), edge_blocks.ravel())),
            minlength=len(self._indices),
        )
        return csc_matrix(
            (data, self._indices, self._pointers), shape=(self.unknowns, self.unknowns)
        )

    def radii(self, places: Floats) -> Floats:
        """Circumference at every node divided by that of the sliding face; 1 in plane strain."""
        if self.sliding_radius is None:
            return np.ones(len(places))
        return np.asarray(1 + self.outward * places[:, 1] / self.sliding_radius)

    def places(self, state: Floats) -> Floats:
        """Current positions of the nodes, n x 2 [m]."""
        return np.asarray(self.nodes + state[: self.displacements].reshape(-1, 2))


@dataclass(frozen=True, slots=True)
class StressField:
    """Deformed bodies with von Mises stress, for a figure.

    Parameters
    ----------
    nodes : positions of the element corners, n x 2: axial, and outward from the sliding face [m]
    triangles : three corners of every element
    von_mises : mean von Mises stress of every element [Pa]
    body : index of the body that every element belongs to; 0 is the rubber ring
    """

    nodes: Floats
    triangles: Integers
    von_mises: Floats
    body: Integers


@dataclass(frozen=True, slots=True)
class MountedContact:
    """A seal in its groove at one sealed pressure; pressures are relative to the outer side.

    Parameters
    ----------
    pressure : sealed pressure above that of the outer side [Pa]
    positions : distances from the sealed end of the contact, from 0 to `width` [m]
    contact_pressure : contact pressure at these positions [Pa]; the first value is the sealed
        pressure, the last is 0
    width : axial width of the contact [m]
    line_load : force on the sliding face per length of its circumference [N/m]
    peak_pressure : highest contact pressure [Pa]
    opposite_load : contact force on the groove bottom per length of circumference [N/m]
    side_load : contact force on the outer side wall of the groove, likewise [N/m]; for a step ring
        without pressure, which does not rest on this wall yet, the force that holds it axially
    start : position of the sealed end of the contact, measured from the outer groove wall; negative
        [m]
    field : deformed mesh with stress
    """

    pressure: float
    positions: Floats
    contact_pressure: Floats
    width: float
    line_load: float
    peak_pressure: float
    opposite_load: float
    side_load: float
    start: float
    field: StressField


@dataclass(frozen=True, slots=True)
class SealSolution:
    """Results for a seal that is mounted and then pressurised.

    Parameters
    ----------
    contacts : contact of the seal without pressure, then one for every pressure that was reached
    failure : reason why a pressure was not reached; None if all were reached
    steps, iterations : number of load steps, and total number of Newton iterations
    residual : largest unbalanced force, divided by the rubber's modulus and section
    """

    contacts: tuple[MountedContact, ...]
    failure: str | None
    steps: int
    iterations: int
    residual: float


def stress_field(section: Assembly, values: Floats, length: float, modulus: float) -> StressField:
    """Deformed mesh and stress in SI, from a solution scaled by `length` and `modulus`."""
    gradient, multiplier = section.gradient(values)
    stress = material.von_mises(gradient, multiplier, section.c10, section.c01)
    mean = np.sum(stress * section.weights, axis=1) / np.sum(section.weights, axis=1)
    corners, triangles = np.unique(section.triangles[:, :3], return_inverse=True)
    owner = np.searchsorted(section.first_node, section.triangles[:, 0], side="right") - 1
    return StressField(
        section.places(values)[corners] * length,
        triangles.reshape(-1, 3).astype(np.int64),
        mean * modulus,
        owner.astype(np.int64),
    )


def contact_end(held: float, gaps: Floats, places: Floats) -> float:
    """Position where a contact ends, between its last closed and its first open node.

    Next to a smooth contact, the gap grows as distance^(3/2). The gaps at the first two open nodes
    therefore determine where the contact ends.

    Parameters
    ----------
    held : position of the last node in contact [m]
    gaps, places : gaps and positions of the first two open nodes [m]
    """
    ratio = (max(gaps[0], 0.0) / gaps[1]) ** (2 / 3) if gaps[1] > gaps[0] else 0.0
    end = (places[0] - ratio * places[1]) / (1 - ratio)
    low, high = sorted((held, float(places[0])))
    return float(min(max(end, low), high))
