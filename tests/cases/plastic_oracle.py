"""Independent solution of a lined tube that yields: incremental finite elements in the radius.

Nothing of the package's mechanics is used here. Generalised plane strain, quadratic elements of
three Gauss points, Newton to equilibrium at every step of the load; the liner flows by the closest
point on the yield surface of Tresca (faces and edges, so sigma_z may become extreme) or of von
Mises, the wrap is elastic. Unloading is a load like any other: reverse yield shows by itself.
"""

from __future__ import annotations

from itertools import pairwise
from math import pi

import numpy as np
from tube_oracle import layer_stiffness

STEP = 1e-30
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(3)
SHAPES = np.array([POINTS * (POINTS - 1) / 2, 1 - POINTS**2, POINTS * (POINTS + 1) / 2]).T
SLOPES = np.array([POINTS - 0.5, -2 * POINTS, POINTS + 0.5]).T
FACES = np.linalg.inv(np.vander(POINTS, 3))
"""Coefficients of the parabola through values at the Gauss points, highest power first."""


def tresca(trial, strength):
    """Closest point on Tresca's prism of trial stresses z, t, r, (3, points)."""
    order = np.argsort(-np.real(trial), axis=0)
    a, b, c = np.take_along_axis(trial, order, axis=0)
    wide, upper, lower = a - c - strength, a - b - strength, b - c - strength
    face = wide / 2
    on_face = np.array([a - face, b, c + face])
    one, two = (2 * wide - upper) / 3, (2 * upper - wide) / 3
    on_right = np.array([a - one - two, b + two, c + one])
    one, two = (2 * wide - lower) / 3, (2 * lower - wide) / 3
    on_left = np.array([a - one, b - two, c + one + two])
    ordered = (np.real(on_face[0]) >= np.real(b)) & (np.real(b) >= np.real(on_face[2]))
    found = np.where(ordered, on_face, np.where(np.real(a + c - 2 * b) > 0, on_right, on_left))
    found = np.where(np.real(wide) > 0, found, np.array([a, b, c]))
    return np.take_along_axis(found, np.argsort(order, axis=0), axis=0)


def mises(trial, strength):
    """Closest point on von Mises' cylinder."""
    mean = np.sum(trial, axis=0) / 3
    deviator = trial - mean
    size = np.sqrt(1.5 * np.sum(deviator**2, axis=0))
    return mean + deviator * (strength / np.where(np.real(size) > strength, size, strength))


class PlasticTube:
    """A tube of `tube_oracle` layers, the first of which flows; loads are applied in order."""

    def __init__(self, layers, radius, strength, flow=tresca, elements=40):
        """Mesh it."""
        self.flow, self.strength, self.radius = flow, strength, radius
        kinds = [k for k in range(len(layers)) for _ in range(elements if k == 0 else 12)]
        ends = np.cumsum([radius, *(layer.thickness for layer in layers)])
        parts = [
            np.linspace(a, b, (elements if k == 0 else 12) + 1)[1:]
            for k, (a, b) in enumerate(pairwise(ends))
        ]
        edges = np.concatenate([[radius], *parts])
        self.interface = ends[1]
        half, middle = np.diff(edges) / 2, (edges[1:] + edges[:-1]) / 2
        self.r = middle[:, None] + half[:, None] * POINTS
        self.weight = half[:, None] * WEIGHTS * self.r
        count = len(half)
        self.metal = np.array(kinds) == 0
        self.turn = np.zeros((count, 3, 3, 4))  # element, point, strain z t r, unknown u1 u2 u3 e_z
        self.turn[:, :, 0, 3] = 1
        self.turn[:, :, 1, :3] = SHAPES / self.r[:, :, None]
        self.turn[:, :, 2, :3] = SLOPES / half[:, None, None]
        first = 2 * np.arange(count)
        self.place = np.stack([first, first + 1, first + 2, 0 * first + 2 * count + 1], axis=1)
        tables = [layer_stiffness(layer) for layer in layers]
        self.stiffness = np.array([tables[k][0][:3, :3] for k in kinds])
        self.heat = np.array([tables[k][1][:3] for k in kinds])
        self.unknowns = np.zeros(2 * count + 2)
        self.plastic = np.zeros((count, 3, 3))

    def stresses(self, strain, change):
        """Stresses z, t, r at the Gauss points."""
        trial = np.einsum("eij,egj->egi", self.stiffness, strain - self.plastic)
        trial = trial - self.heat[:, None] * change
        own = trial[self.metal]
        flowed = self.flow(own.reshape(-1, 3).T, self.strength).T.reshape(own.shape)
        return np.concatenate([flowed, trial[~self.metal]])

    def load(self, pressure, force, change=0.0):
        """Equilibrium under inner pressure, axial force, temperature change."""
        outside = np.zeros(len(self.unknowns))
        outside[0], outside[-1] = pressure * self.radius, force / (2 * pi)
        for _ in range(30):
            strain = np.einsum("egij,ej->egi", self.turn, self.unknowns[self.place])
            stress = self.stresses(strain, change)
            pull = np.einsum("egij,egi,eg->ej", self.turn, stress, self.weight)
            inside = np.zeros(len(self.unknowns))
            np.add.at(inside, self.place, pull)
            if np.max(np.abs(outside - inside)) < 1e-11 * self.strength * self.radius:
                break
            steps = 1j * STEP * np.eye(3)
            slope = [self.stresses(strain + step, change).imag / STEP for step in steps]
            tangent = np.stack(slope, axis=-1)
            own = np.einsum(
                "egia,egij,egjb,eg->eab", self.turn, tangent, self.turn, self.weight, optimize=True
            )
            matrix = np.zeros((len(self.unknowns),) * 2)
            np.add.at(matrix, (self.place[:, :, None], self.place[:, None, :]), own)
            self.unknowns = self.unknowns + np.linalg.solve(matrix, outside - inside)
        else:
            message = f"no equilibrium at {pressure}"
            raise ArithmeticError(message)
        held = (stress + self.heat[:, None] * change)[..., None]
        elastic = np.linalg.solve(self.stiffness[:, None], held)[..., 0]
        self.plastic = np.where(self.metal[:, None, None], strain - elastic, 0.0)
        self.stress, self.pull = stress, pull

    def way(self, start, end, area, change=0.0, steps=25):
        """From one pressure to another, the axial force `area` times the pressure."""
        for pressure in np.linspace(start, end, steps + 1)[1:]:
            self.load(pressure, area * pressure, change)
        return self

    def outcome(self):
        """Bore growth, axial strain, pressure on the wrap; stresses z, t at the liner's faces."""
        last = np.flatnonzero(self.metal)[-1]
        press = self.pull[last + 1, 0] / self.interface if last + 1 < len(self.r) else 0.0
        inner, outer = (np.vander([x], 3) @ FACES for x in (-1.0, 1.0))
        faces = np.concatenate([inner @ self.stress[0], outer @ self.stress[last]])
        return np.array([self.unknowns[0], self.unknowns[-1], press]), faces[:, :2]
