"""Independent solution of a layered anisotropic tube: high-order finite elements in the radius.

Nothing of the package's mechanics is used here. The kinematics are axial strain e_z constant, hoop
strain u/r, radial strain u', engineering shear gamma_0 r; the rest is the virtual-work statement

    integral sigma . delta(e) dV = sum of p, N, T times their virtual displacements

with the 3x3x3x3 stiffness tensor of each ply turned by the full tensor law. Unknowns are u at the
bore, the Legendre coefficients of u' in each element, e_z and gamma_0. Complex arguments pass
through, so its complex-step derivatives are exact. Strategies for random tubes stand at the end.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import ceil, exp, log, pi

import numpy as np
from hypothesis import assume, strategies as st
from numpy.polynomial import legendre
from scipy.optimize import brentq

ORDER = 10
"""Coefficients of u' in an element: u is of degree 10."""
LONGEST = 0.12
"""Longest element in ln r: u ~ r^l, l < 10, is then reproduced to rounding."""
VOIGT = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
"""Index pairs of 11, 22, 33, 23, 13, 12; in tube axes 1 is z, 2 is theta, 3 is r."""
STRAINS = (0, 1, 2, 5)
"""Places of e_z, e_theta, e_r, gamma_ztheta, the only strains of the tube, in that order."""


@dataclass(frozen=True, kw_only=True)
class Ply:
    """Elastic constants of a ply in its own axes: 1 along the fibre, 2 in the wall, 3 radial."""

    youngs: tuple
    """E1, E2, E3 [Pa]"""
    poisson: tuple
    """nu12, nu13, nu23 [-], nu_ij = -e_j/e_i under sigma_i"""
    shear: float
    """G12 [Pa]"""
    expansion: tuple = (0.0, 0.0, 0.0)
    """alpha_1, alpha_2, alpha_3 [1/K]"""

    @staticmethod
    def isotropic(youngs, poisson, expansion=0.0):
        """A ply of equal properties in every direction."""
        return Ply(
            youngs=(youngs,) * 3,
            poisson=(poisson,) * 3,
            shear=youngs / (2 * (1 + poisson)),
            expansion=(expansion,) * 3,
        )

    def compliance(self):
        """Compliance [1/Pa], 6x6, engineering shear; G13 and G23 never act here: G12 twice."""
        e, (nu12, nu13, nu23) = self.youngs, self.poisson
        normal = [
            [1 / e[0], -nu12 / e[0], -nu13 / e[0]],
            [-nu12 / e[0], 1 / e[1], -nu23 / e[1]],
            [-nu13 / e[0], -nu23 / e[1], 1 / e[2]],
        ]
        shear = np.eye(3) / self.shear
        return np.block([[np.array(normal), np.zeros((3, 3))], [np.zeros((3, 3)), shear]])


@dataclass(frozen=True, kw_only=True)
class Layer:
    """One layer: a ply at a winding angle from the axis, or its +-angle pair averaged."""

    ply: Ply
    thickness: float
    angle: float = 0.0
    balanced: bool = True


def tensor(matrix):
    """Fourth-order tensor of a 6x6 stiffness."""
    full = np.zeros((3, 3, 3, 3), dtype=matrix.dtype)
    for i, (a, b) in enumerate(VOIGT):
        for j, (c, d) in enumerate(VOIGT):
            for p, q in {(a, b), (b, a)}:
                for r, s in {(c, d), (d, c)}:
                    full[p, q, r, s] = matrix[i, j]
    return full


def basis(angle):
    """Rows e1, e2, e3 of the ply in (z, theta, r)."""
    c, s = np.cos(angle), np.sin(angle)
    zero = 0 * c
    return np.array([[c, s, zero], [-s, c, zero], [zero, zero, 1 + zero]])


def turned(ply, angle):
    """Stiffness 6x6 and thermal stress coefficients (6,) of a ply in tube axes."""
    stiffness = np.linalg.inv(ply.compliance())
    e = basis(angle)
    full = np.einsum("ijkl,ia,jb,kc,ld->abcd", tensor(stiffness), e, e, e, e)
    matrix = np.array([[full[p, q, r, s] for r, s in VOIGT] for p, q in VOIGT])
    heat = stiffness @ np.array([*ply.expansion, 0.0, 0.0, 0.0])
    k = np.array([[heat[0], 0, 0], [0, heat[1], 0], [0, 0, heat[2]]])
    k = np.einsum("ij,ia,jb->ab", k, e, e)
    return matrix, np.array([k[p, q] for p, q in VOIGT])


def layer_stiffness(layer):
    """Stiffness and thermal coefficients of a layer: the mean of both signs when balanced."""
    plus = turned(layer.ply, layer.angle)
    if not layer.balanced:
        return plus
    minus = turned(layer.ply, -layer.angle)
    return tuple((p + m) / 2 for p, m in zip(plus, minus, strict=True))


POINTS, WEIGHTS = legendre.leggauss(ORDER + 5)
_SLOPES = np.eye(ORDER)
"""Legendre coefficients of P_m, one row each."""
_RISES = [legendre.legint(row, lbnd=-1) for row in _SLOPES]
"""Legendre coefficients of the integrals of P_m from -1: 2 at the outer face for m = 0, else 0."""


def evaluate(rows, xi):
    """Every polynomial of rows at the points xi: (points, rows)."""
    return np.stack([legendre.legval(xi, row) for row in rows], axis=-1)


@dataclass(frozen=True)
class Solution:
    """Displacement field; radii are asked per layer, so both sides of an interface exist."""

    layers: tuple
    elements: list = field(repr=False)
    """(layer, inner radius, outer radius, u at the inner radius, coefficients of u')"""
    axial_strain: float
    twist: float
    temperature_change: float

    def u(self, layer, radius):
        """Radial displacement [m]."""
        return self._field(layer, radius)[0]

    def strains(self, layer, radius):
        """Strains e_z, e_theta, e_r, gamma_ztheta."""
        u, slope = self._field(layer, radius)
        return np.array([self.axial_strain, u / radius, slope, self.twist * radius])

    def stresses(self, layer, radius):
        """Stresses sigma_z, sigma_theta, sigma_r, tau_ztheta of the layer [Pa]."""
        matrix, heat = layer_stiffness(self.layers[layer])
        full = matrix[:, STRAINS] @ self.strains(layer, radius) - heat * self.temperature_change
        return full[list(STRAINS)]

    def ply_stresses(self, layer, radius, sign=1):
        """Stresses s1, s2, s3, t12 of the ply at sign * angle in its own axes [Pa]."""
        part = self.layers[layer]
        angle = sign * part.angle
        matrix, heat = turned(part.ply, angle)
        full = matrix[:, STRAINS] @ self.strains(layer, radius) - heat * self.temperature_change
        s = np.zeros((3, 3), dtype=full.dtype)
        for value, (a, b) in zip(full, VOIGT, strict=True):
            s[a, b] = s[b, a] = value
        e = basis(angle)
        own = np.einsum("ia,jb,ab->ij", e, e, s)
        return np.array([own[0, 0], own[1, 1], own[2, 2], own[0, 1]])

    def _field(self, layer, radius):
        """Displacement and its slope at a radius of a layer, from the element that holds it."""
        mine = [e for e in self.elements if e[0] == layer]
        holds = (e for e in mine if np.real(radius) <= np.real(e[2]))
        _, inner, outer, start, slopes = next(holds, mine[-1])
        half = (outer - inner) / 2
        xi = (radius - inner) / half - 1
        return start + half * evaluate(_RISES, xi) @ slopes, evaluate(_SLOPES, xi) @ slopes


def mesh(layers, inner_radius):
    """Elements (layer, inner radius, outer radius)."""
    elements, radius = [], inner_radius
    for k, layer in enumerate(layers):
        outer = radius + layer.thickness
        count = ceil(log(np.real(outer) / np.real(radius)) / LONGEST)
        edges = [radius + layer.thickness * i / count for i in range(count)] + [outer]
        elements += [(k, a, b) for a, b in pairwise(edges)]
        radius = outer
    return elements


def solve(
    layers,
    inner_radius,
    *,
    inner_pressure=0.0,
    outer_pressure=0.0,
    axial_force=0.0,
    torque=0.0,
    temperature_change=0.0,
):
    """Solve a tube under pressures, axial force, torque and a temperature change.

    Works in units of the bore radius and of the stiffest entry of C; every unknown is a strain:
    u/r_i at the bore, the coefficients of u' element by element, e_z, gamma_0 r_i.
    """
    parts = [layer_stiffness(layer) for layer in layers]
    unit = max(np.max(np.real(matrix)) for matrix, _ in parts)
    elements = mesh(layers, inner_radius)
    size = ORDER * len(elements) + 3
    loads = [inner_pressure, outer_pressure, axial_force, torque, temperature_change, inner_radius]
    kind = np.result_type(*loads, *(m for m, _ in parts), *(k for _, k in parts), float)
    stiffness = np.zeros((size, size), dtype=kind)
    load = np.zeros(size, dtype=kind)
    load[0] = 2 * pi * inner_pressure / unit
    rises, slopes = evaluate(_RISES, POINTS), evaluate(_SLOPES, POINTS)
    start = np.zeros(size, dtype=kind)  # u/r_i at the element's inner face, from the unknowns
    start[0] = 1
    for i, (k, inner, outer) in enumerate(elements):
        matrix = parts[k][0][np.ix_(STRAINS, STRAINS)] / unit
        heat = parts[k][1][list(STRAINS)] * temperature_change / unit
        half = (outer - inner) / (2 * inner_radius)
        mine = slice(1 + i * ORDER, 1 + (i + 1) * ORDER)
        for q, weight in enumerate(WEIGHTS):
            r = inner / inner_radius + half * (1 + POINTS[q])
            strain = np.zeros((4, size), dtype=kind)  # rows z, theta, r, z theta
            strain[0, -2] = 1
            strain[1] = start / r
            strain[1, mine] += half * rises[q] / r
            strain[2, mine] = slopes[q]
            strain[3, -1] = r
            volume = 2 * pi * r * half * weight
            stiffness += strain.T @ (matrix * volume) @ strain
            load += strain.T @ heat * volume
        start[1 + i * ORDER] = 2 * half
    load -= start * (2 * pi * outer / inner_radius * outer_pressure / unit)
    load[-2] += axial_force / (unit * inner_radius**2)
    load[-1] += torque / (unit * inner_radius**3)
    scale = 1 / np.sqrt(np.real(np.diag(stiffness)))
    x = np.linalg.solve(stiffness * scale[:, None] * scale, load * scale) * scale
    fields, u = [], x[0] * inner_radius
    for i, (k, inner, outer) in enumerate(elements):
        own = x[1 + i * ORDER : 1 + (i + 1) * ORDER]
        fields.append((k, inner, outer, u, own))
        u = u + (outer - inner) * own[0]
    return Solution(tuple(layers), fields, x[-2], x[-1] / inner_radius, temperature_change)


def resonant(ply, angle, exponent, balanced=True):
    """The ply with E3 chosen so that C_tt = exponent^2 C_rr at this angle, or None."""

    def excess(log_youngs):
        trial = replace(ply, youngs=(*ply.youngs[:2], exp(log_youngs)))
        matrix, _ = layer_stiffness(Layer(ply=trial, thickness=1.0, angle=angle, balanced=balanced))
        return matrix[1, 1] / matrix[2, 2] - exponent**2

    low, high = log(0.02 * ply.youngs[1]), log(1.2 * min(ply.youngs[0], 4 * ply.youngs[1]))
    if excess(low) * excess(high) > 0:
        return None
    found = exp(brentq(excess, low, high, xtol=1e-15, rtol=1e-14))
    return replace(ply, youngs=(*ply.youngs[:2], found))


def sound(ply):
    """Whether the stiffness of a ply is positive definite with room to spare."""
    normal = ply.compliance()[:3, :3]
    size = np.sqrt(np.diag(normal))
    return bool(np.min(np.linalg.eigvalsh(normal / np.outer(size, size))) > 0.1)


@st.composite
def layers(draw, resonances=(None,)):
    """A layer: isotropic, or orthotropic at any angle, paired or single; t is per bore radius."""
    thickness, alpha = draw(st.floats(0.01, 0.3)), st.floats(-2e-6, 60e-6)
    if draw(st.integers(0, 3)) == 0:
        youngs, poisson = draw(st.floats(2e9, 210e9)), draw(st.floats(0.0, 0.45))
        return Layer(ply=Ply.isotropic(youngs, poisson, draw(alpha)), thickness=thickness)
    share = st.floats(0.03, 1.0)
    youngs_1 = draw(st.floats(20e9, 250e9))
    ply = Ply(
        youngs=(youngs_1, youngs_1 * draw(share), youngs_1 * draw(share)),
        poisson=tuple(draw(st.floats(0.0, 0.45)) for _ in range(3)),
        shear=draw(st.floats(1e9, 60e9)),
        expansion=tuple(draw(alpha) for _ in range(3)),
    )
    angle = draw(st.sampled_from([0.0, pi / 2, pi / 4]) | st.floats(-pi / 2, pi / 2))
    balanced = draw(st.booleans())
    exponent = draw(st.sampled_from(resonances))
    if exponent is not None:
        ply = resonant(ply, angle, exponent, balanced)
        assume(ply is not None)
        ply = replace(ply, youngs=(*ply.youngs[:2], ply.youngs[2] * (1 + draw(NEARLY))))
    assume(sound(ply))
    return Layer(ply=ply, thickness=thickness, angle=angle, balanced=balanced)


NEARLY = st.sampled_from([0.0, 0.0, 1e-14, -1e-12, 1e-9, -1e-7, 1e-5])
"""How far a tuned ply stands from its resonance, as a share of E3."""


@st.composite
def tubes(draw, resonances=(None,), most=6):
    """Layers in metres and the bore radius."""
    radius = draw(st.floats(2e-3, 0.5))
    drawn = draw(st.lists(layers(resonances), min_size=1, max_size=most))
    return [replace(layer, thickness=layer.thickness * radius) for layer in drawn], radius


@st.composite
def loads(draw, radius):
    """Loads of comparable size on a tube of a bore radius: pressures, N, T, temperature."""
    share, pressure = st.floats(-1.0, 1.0), 30e6
    return {
        "inner_pressure": pressure * draw(st.floats(0.1, 1.0)),
        "outer_pressure": pressure * draw(st.floats(0.0, 1.0)),
        "axial_force": pressure * radius**2 * 3 * draw(share),
        "torque": pressure * radius**3 * draw(share),
        "temperature_change": 120.0 * draw(share),
    }


def split(layers, parts):
    """The same tube with every layer cut into parts at shares of its thickness (sum 1)."""
    return [replace(one, thickness=one.thickness * share) for one in layers for share in parts]


def model_tube(layers, inner_radius):
    """The package's tube of these layers."""
    from actuator_opt.models.layered_tube import TubeLayer, layered_tube
    from actuator_opt.models.solid_ply import solid_stiffness

    return layered_tube(
        layers=[
            TubeLayer(
                stiffness=solid_stiffness(
                    youngs_modulus_1=one.ply.youngs[0],
                    youngs_modulus_2=one.ply.youngs[1],
                    youngs_modulus_3=one.ply.youngs[2],
                    poissons_ratio_12=one.ply.poisson[0],
                    poissons_ratio_13=one.ply.poisson[1],
                    poissons_ratio_23=one.ply.poisson[2],
                    shear_modulus_12=one.ply.shear,
                ),
                thickness=one.thickness,
                angle=one.angle,
                balanced=one.balanced,
                expansion_1=one.ply.expansion[0],
                expansion_2=one.ply.expansion[1],
                expansion_3=one.ply.expansion[2],
            )
            for one in layers
        ],
        inner_radius=inner_radius,
    )


def model_fields(layers, radius, loads):
    """Every output of the package, stacked by kind: (kind, face, layer, ...)."""
    from actuator_opt.models.layered_tube import ply_stresses_at_faces, tube_state, tube_stresses

    tube = model_tube(layers, radius)
    state = tube_state(tube=tube, **loads)
    plies, opposite = (
        ply_stresses_at_faces(tube=tube, state=state, opposite=side) for side in (False, True)
    )
    return {
        "scalars": np.array(
            [state.bore_displacement / radius, state.axial_strain, state.twist * radius]
        ),
        "strains": np.array([state.hoop_strain, state.radial_strain, state.shear_strain]),
        "radial_stress": np.array([state.radial_stress]),
        "stresses": np.array(tube_stresses(tube=tube, state=state)),
        "ply_stresses": np.array(plies),
        "opposite_ply_stresses": np.array(opposite),
    }
