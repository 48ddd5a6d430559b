"""Axisymmetric finite elements of a layered wall: an independent check of the models of its ends.

Linear elasticity on a grid of rectangles in (r, z), with quadratic elements of `scikit-fem`.
Lengths in mm and stresses in MPa. Cells can be left out, such as those of a groove.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

Place = Callable[[Any, Any], Any]
"""Whether points (r, z) belong to a region."""


def isotropic(modulus: float, ratio: float) -> np.ndarray:
    """Stiffness of a metal in the order r, t, z, rz."""
    first = modulus * ratio / ((1 + ratio) * (1 - 2 * ratio))
    shear = modulus / (2 * (1 + ratio))
    stiffness = np.full((3, 3), first) + 2 * shear * np.eye(3)
    return _with_shear(stiffness, shear)


def orthotropic(moduli: Sequence[float], ratios: Sequence[float], shear: float) -> np.ndarray:
    """Stiffness from E_r, E_t, E_z, the ratios tr, zr, tz (nu_ij/E_i), and G_rz."""
    (e_r, e_t, e_z), (tr, zr, tz) = moduli, ratios
    compliance = np.array(
        [
            [1 / e_r, -tr / e_t, -zr / e_z],
            [-tr / e_t, 1 / e_t, -tz / e_t],
            [-zr / e_z, -tz / e_t, 1 / e_z],
        ]
    )
    return _with_shear(np.linalg.inv(compliance), shear)


def _with_shear(stiffness: np.ndarray, shear: float) -> np.ndarray:
    full = np.zeros((4, 4))
    full[:3, :3] = stiffness
    full[3, 3] = shear
    return full


@dataclass
class Wall:
    """A solved wall; `stress` gives r, t, z, rz at points (r, z), each (points,)."""

    basis: Any
    displacement: np.ndarray
    layers: Sequence[tuple[Place, np.ndarray]]

    def _strain(self, r: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        finder = self.basis.mesh.element_finder()
        points = np.stack([r, z])
        cells = finder(*points)
        local = self.basis.mapping.invF(points[:, :, None], tind=cells)
        strain, total = np.zeros((4, len(r))), np.zeros((2, len(r)))
        for i in range(self.basis.Nbfun):
            (field,) = self.basis.elem.gbasis(self.basis.mapping, local, i, tind=cells)
            amount = self.displacement[self.basis.element_dofs[i, cells]]
            gradient, value = field.grad[..., 0], np.asarray(field)[..., 0]
            total += amount * value
            strain[0] += amount * gradient[0, 0]
            strain[1] += amount * value[0] / r
            strain[2] += amount * gradient[1, 1]
            strain[3] += amount * (gradient[0, 1] + gradient[1, 0])
        return strain, total

    def moved(self, r: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Displacements (2, points)."""
        return self._strain(r, z)[1]

    def stress(self, r: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Stresses (4, points)."""
        strain = self._strain(r, z)[0]
        out = np.zeros_like(strain)
        for place, stiffness in self.layers:
            out += place(r, z) * (stiffness @ strain)
        return out

    def through(self, z: float, low: float, high: float) -> tuple[float, float]:
        """Mean and bending part (at radius `low`) of the axial stress across a layer."""
        nodes, weights = np.polynomial.legendre.leggauss(24)
        middle, half = (low + high) / 2, (high - low) / 2
        r = middle + half * nodes
        axial = self.stress(r, np.full_like(r, z))[2]
        mean = np.sum(weights * axial * r) / np.sum(weights * r)
        bending = -1.5 * np.sum(weights * (axial - mean) * nodes)
        return float(mean), float(bending)


def solved(
    *,
    radii: Sequence[float],
    stations: Sequence[float],
    layers: Sequence[tuple[Place, np.ndarray]],
    absent: Place | None = None,
    loads: Sequence[tuple[Place, Place]] = (),
    fixed_r: Place | None = None,
    fixed_z: Place | None = None,
    shaped: Callable[[Any, Any], Any] | None = None,
) -> Wall:
    """Solve a wall on the grid of `radii` and `stations`.

    `shaped` maps the grid to radii; `absent` belongs to the grid, all else to the shaped wall.

    `loads` are pairs: the part of the boundary, by the midpoints of its edges, and the traction
    (2,) there as a function of (r, z). `fixed_r` and `fixed_z` select nodes without radial or
    axial displacement.
    """
    import skfem

    mesh = skfem.MeshQuad.init_tensor(np.asarray(radii), np.asarray(stations))
    if absent is not None:
        middle = mesh.p[:, mesh.t].mean(axis=1)
        mesh = mesh.remove_elements(np.flatnonzero(absent(*middle)))
    if shaped is not None:
        mesh = skfem.MeshQuad(np.stack([shaped(*mesh.p), mesh.p[1]]), mesh.t)
    element = skfem.ElementVector(skfem.ElementQuad2())
    basis = skfem.Basis(mesh, element, intorder=5)

    def strains(u: Any, x: Any) -> np.ndarray:
        return np.stack([u.grad[0, 0], u[0] / x[0], u.grad[1, 1], u.grad[0, 1] + u.grad[1, 0]])

    @skfem.BilinearForm
    def energy(u: Any, v: Any, w: Any) -> Any:
        first, second = strains(u, w.x), strains(v, w.x)
        total = 0.0
        centre = w.x.mean(axis=-1, keepdims=True)
        for place, stiffness in layers:
            part = np.einsum("i...,ij,j...->...", second, stiffness, first)
            total = total + place(centre[0], centre[1]) * part
        return total * w.x[0]

    matrix = energy.assemble(basis)
    vector = np.zeros(basis.N)
    for place, traction in loads:
        boundary = mesh.boundary_facets()
        middle = mesh.p[:, mesh.facets[:, boundary]].mean(axis=1)
        facets = boundary[np.asarray(place(*middle), dtype=bool)]
        facet_basis = skfem.FacetBasis(mesh, element, facets=facets, intorder=5)

        @skfem.LinearForm
        def work(v: Any, w: Any, traction: Any = traction) -> Any:
            pull = traction(w.x[0], w.x[1])
            return (v[0] * pull[0] + v[1] * pull[1]) * w.x[0]

        vector += work.assemble(facet_basis)
    fixed = [
        basis.get_dofs(lambda x, place=place: place(x[0], x[1])).all([f"u^{k}"])
        for k, place in ((1, fixed_r), (2, fixed_z))
        if place is not None
    ]
    dofs = np.unique(np.concatenate(fixed)) if fixed else np.array([], dtype=int)
    answer = skfem.solve(*skfem.condense(matrix, vector, D=dofs))
    return Wall(basis, answer, layers)
