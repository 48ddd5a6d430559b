"""Samples of the law tests for the exact tube; merged into `model_samples`."""

from __future__ import annotations

from dataclasses import replace
from math import pi

from actuator_opt.models.burst_ladder import WallLayer
from actuator_opt.models.layered_tube import (
    TubeLayer,
    layered_tube,
    ply_stresses_at_faces,
    tube_state,
    tube_stresses,
)
from actuator_opt.models.solid_ply import solid_stiffness
from actuator_opt.models.strength_modes import PlyStrength

PLY = {
    "youngs_modulus_1": 138e9, "youngs_modulus_2": 9e9, "youngs_modulus_3": 9e9,
    "poissons_ratio_12": 0.28, "poissons_ratio_13": 0.28, "poissons_ratio_23": 0.42,
    "shear_modulus_12": 5e9,
}  # fmt: skip
SOLID = tuple(float(value) for value in solid_stiffness(**PLY))
STRENGTH = PlyStrength(1900e6, 1300e6, 55e6, 190e6, 85e6)
EXPANSIONS = {"expansion_1": 1e-6, "expansion_2": 28e-6, "expansion_3": 30e-6}
HOOP = WallLayer(**PLY, strength=STRENGTH, thickness=1.2e-3, angle=pi / 2, material="ply")
HELICAL = WallLayer(**PLY, strength=STRENGTH, thickness=0.8e-3, angle=pi / 6, material="ply")
LINER = WallLayer(
    youngs_modulus_1=71.7e9, youngs_modulus_2=71.7e9, poissons_ratio_12=0.33,
    shear_modulus_12=71.7e9 / 2.66, thickness=0.6e-3, yield_strength=240e6,
)  # fmt: skip
LAYERS = [
    TubeLayer(stiffness=SOLID, thickness=1e-3, angle=1.4, **EXPANSIONS),
    TubeLayer(stiffness=SOLID, thickness=0.7e-3, angle=0.6, balanced=False, **EXPANSIONS),
]
WALL = {"inner_radius": 16e-3, "axial_force_per_pressure": 7e-4}

LOADED = {
    "layers": LAYERS, "inner_radius": 16e-3, "inner_pressure": 25e6, "outer_pressure": 1e6,
    "axial_force": 9e3, "torque": 12.0, "temperature_change": -60.0,
}  # fmt: skip


def _loaded(layers, inner_radius, **loads):
    """A tube built and loaded in one call, so that the laws reach every number in it."""
    tube = layered_tube(layers=layers, inner_radius=inner_radius)
    return tube, tube_state(tube=tube, **loads)


def state_of(**numbers):
    """The state of a loaded tube, from numbers."""
    return _loaded(**numbers)[1]


def stresses_of(**numbers):
    """The stresses in tube axes, from numbers."""
    tube, state = _loaded(**numbers)
    return tube_stresses(tube=tube, state=state)


def ply_stresses_of(**numbers):
    """The stresses of both plies of every pair, from numbers."""
    tube, state = _loaded(**numbers)
    return tuple(
        ply_stresses_at_faces(tube=tube, state=state, opposite=side) for side in (False, True)
    )


SAMPLES: dict = {
    "solid_ply.solid_stiffness": PLY,
    "solid_ply.solid_rotated": {"stiffness": SOLID, "angle": 0.6},
    "solid_ply.solid_expansion_load": {"stiffness": SOLID, "angle": 0.6, **EXPANSIONS},
    "solid_ply.solid_ply_stresses": {
        "stiffness": SOLID, "angle": 0.6, "axial_strain": 1e-3, "hoop_strain": 3e-3,
        "radial_strain": -5e-4, "shear_strain": 2e-4, "free_strain_1": -1e-4,
        "free_strain_2": -2e-3, "free_strain_3": -2.1e-3,
    },
    "tube_elements.layered_tube": {"layers": LAYERS, "inner_radius": 16e-3},
    "layered_tube.tube_state": (state_of, LOADED),
    "layered_tube.tube_stresses": (stresses_of, LOADED),
    "layered_tube.ply_stresses_at_faces": (ply_stresses_of, LOADED),
    "strength.mises_product": {
        "first": (3e8, 1e8, -5e7, 4e7), "second": (2e8, -1e8, 2e7, 3e7),
    },
    "strength.yield_utilisation": [
        {"stress": (3e8, 1e8, -5e7, 4e7), "yield_strength": 4e8, "residual": residual}
        for residual in (None, (-5e7, 8e7, 1e7, 2e7))
    ],
    "tube_burst.burst_of_tube": [
        {"layers": [HOOP, HELICAL], **WALL}, {"layers": [LINER, HOOP, HELICAL], **WALL},
        {
            "layers": [
                replace(LINER, expansion_1=23e-6, expansion_2=23e-6),
                replace(HOOP, expansion_1=1e-6, expansion_2=28e-6),
            ],
            "temperature_change": -60.0, "held_force": -8e3, **WALL,
        },
    ],
}  # fmt: skip
