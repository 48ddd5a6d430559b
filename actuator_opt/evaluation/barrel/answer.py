"""Response of a laminated wall to unit pressure, unit axial force and unit temperature change.

From the exact layered tube, or the fast thin laminate; both give stresses at the layer faces.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

import numpy as np

from ...base.numeric import Array
from ...models import laminate, ply
from ...models.layered_tube import layered_tube, ply_stresses_at_faces, tube_state
from ...models.strength_modes import Stress
from ..geometry import Geometry
from ..plies import Layer

PRESSURE, FORCE, WARMTH = range(3)
"""Unit loads of a `WallSolution`."""


@dataclass(frozen=True, slots=True)
class WallSolution:
    """Response to unit loads: ply stresses (faces, layers, loads, designs) and stiffness.

    `walls` are the layer stiffnesses in tube axes, as input of `rod.layered_section`.
    """

    stress: Stress
    growth: Array
    axial: Array
    warm_hoop: Array
    walls: Sequence[Sequence[Array]]


def exact_answer(layers: Sequence[Layer], g: Geometry) -> WallSolution:
    """The layered tube under its three unit loads."""
    tube = layered_tube(layers=[layer.as_tube() for layer in layers], inner_radius=g.inner_radius)
    unit = np.eye(3)
    state = tube_state(
        tube=tube,
        inner_pressure=unit[PRESSURE][:, None],
        axial_force=unit[FORCE][:, None],
        temperature_change=unit[WARMTH][:, None],
    )
    stress = ply_stresses_at_faces(tube=tube, state=state)
    if tube.twisting:  # the plies of a pair then differ
        other = ply_stresses_at_faces(tube=tube, state=state, opposite=True)
        one, two, three, slip = (np.concatenate([a, b]) for a, b in zip(stress, other, strict=True))
        stress = (one, two, three, slip)
    return WallSolution(
        stress=stress,
        growth=state.bore_displacement,
        axial=state.axial_strain,
        warm_hoop=state.hoop_strain[0, 0, WARMTH],
        walls=[[part[i] for part in tube.wall] for i in range(len(layers))],
    )


def thin_answer(layers: Sequence[Layer], g: Geometry) -> WallSolution:
    """The membrane: stresses at mid-radius, growth at the bore."""
    reduced, turned, loads = [], [], []
    for layer in layers:
        c = layer.constants
        stiffness = ply.ply_stiffness(
            youngs_modulus_1=c["youngs_modulus_1"],
            youngs_modulus_2=c["youngs_modulus_2"],
            poissons_ratio_12=c["poissons_ratio_12"],
            shear_modulus_12=c["shear_modulus_12"],
        )
        first, second = layer.expansions or (0.0, 0.0)
        reduced.append(stiffness)
        turned.append(ply.rotated(stiffness=stiffness, angle=layer.angle))
        loads.append(
            ply.thermal_ply_load(
                stiffness=stiffness, angle=layer.angle, expansion_1=first, expansion_2=second
            )
        )
    thicknesses = [layer.thickness for layer in layers]
    sheet = laminate.membrane(plies=turned, thicknesses=thicknesses)
    warm = laminate.thermal_line_forces(
        loads=loads, thicknesses=thicknesses, temperature_change=1.0
    )
    middle, none = (g.inner_radius + g.outer_radius) / 2, 0.0 * np.atleast_1d(g.inner_radius)

    def strains(radius: Array) -> tuple[Array, Array]:
        return laminate.strains(
            membrane=sheet,
            axial_line_force=np.stack([none, none + 1 / (2 * pi * radius), none + warm[0]]),
            hoop_line_force=np.stack([none + radius, none, none + warm[1]]),
        )

    axial, hoop = strains(middle)
    unit = np.array([0.0, 0.0, 1.0])[:, None]
    rows = []
    for layer, stiffness in zip(layers, reduced, strict=True):
        first, second = layer.expansions or (0.0, 0.0)
        one, two, slip = ply.ply_stresses(
            stiffness=stiffness,
            angle=layer.angle,
            axial_strain=axial,
            hoop_strain=hoop,
            free_strain_1=first * unit,
            free_strain_2=second * unit,
        )
        pressed = 0.0 * one
        if layer.isotropic:  # the pressure itself is exact at the liner's bore
            pressed = pressed - np.array([1.0, 0.0, 0.0])[:, None]
        rows.append(np.stack(np.broadcast_arrays(one, two, pressed, slip)))
    stress = np.stack(rows, axis=1)[:, None]
    near_axial, near_hoop = strains(g.inner_radius)
    return WallSolution(
        stress=(stress[0], stress[1], stress[2], stress[3]),
        growth=g.inner_radius * near_hoop,
        axial=near_axial,
        warm_hoop=hoop[WARMTH],
        walls=[(q[0], q[1], 0.0, q[2], 0.0, 1.0, q[5]) for q in turned],
    )
