"""Samples of the law tests for the liner models; merged into `model_samples`."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from actuator_opt.models.autofrettage import autofrettage
from actuator_opt.models.layered_tube import TubeLayer
from actuator_opt.models.liner import layer_thickness_for_strain
from actuator_opt.models.solid_ply import solid_stiffness

SOLID = tuple(
    float(value)
    for value in solid_stiffness(
        youngs_modulus_1=138e9, youngs_modulus_2=9e9, youngs_modulus_3=9e9,
        poissons_ratio_12=0.28, poissons_ratio_13=0.28, poissons_ratio_23=0.42,
        shear_modulus_12=5e9,
    )
)  # fmt: skip
WRAP = [
    TubeLayer(stiffness=SOLID, thickness=2e-3, angle=1.4, expansion_1=1e-6, expansion_2=28e-6,
              expansion_3=30e-6),
    TubeLayer(stiffness=SOLID, thickness=0.7e-3, angle=0.6),
]  # fmt: skip
TWISTING = [WRAP[0], replace(WRAP[1], balanced=False)]
LINED = {
    "youngs_modulus": 71.7e9, "poissons_ratio": 0.33, "thickness": 6e-3, "expansion": 23e-6,
    "wrap": WRAP, "yield_strength": 240e6, "inner_radius": 16e-3,
    "axial_force_per_pressure": 8e-4, "temperature_change": -15.0,
}  # fmt: skip
SOUGHT = {
    "layers": WRAP, "inner_radius": 16e-3, "strain": 3e-3, "pressure": 25e6,
    "axial_force_per_pressure": 5e-4, "largest_thickness": 9e-3,
}  # fmt: skip


def _residual(youngs_modulus, poissons_ratio, thickness, expansion, wrap, **numbers):
    """Autofrettage of an isotropic liner by its two elastic constants.

    Of the radial stresses only those at the layers' inner faces: the outermost is zero but for
    rounding, which has no slope.
    """
    solid = solid_stiffness(
        **{f"youngs_modulus_{i}": youngs_modulus for i in (1, 2, 3)},
        **{f"poissons_ratio_{ij}": poissons_ratio for ij in (12, 13, 23)},
        shear_modulus_12=youngs_modulus / (2 * (1 + poissons_ratio)),
    )
    liner = TubeLayer(stiffness=solid, thickness=thickness, expansion_1=expansion)
    left = autofrettage(layers=[liner, *wrap], **numbers)
    along, across, radial, slip = left.stresses
    return replace(left, stresses=(along, across, radial[0, ...], slip))


SAMPLES: dict = {
    # elastic, partly plastic, through; a liner alone
    "autofrettage.autofrettage": [
        *((_residual, {**LINED, "pressure": pressure}) for pressure in (40e6, 85e6, 130e6)),
        (_residual, {**LINED, "wrap": [], "pressure": 60e6}),
    ],
    "liner.liner_cycle": {
        "stress": (60e6, 330e6, -20e6, 5e6), "yield_strength": 240e6, "youngs_modulus": 71.7e9,
        "residual": (-20e6, -140e6, 1e6, 2e6),
    },
    # a hoop layer; an outer ply that twists the wall; a layer that is not needed
    "liner.layer_thickness_for_strain": [
        (partial(layer_thickness_for_strain, index=0), SOUGHT),
        (partial(layer_thickness_for_strain, index=1), {**SOUGHT, "layers": TWISTING}),
        (partial(layer_thickness_for_strain, index=1), {**SOUGHT, "strain": 8e-3}),
    ],
}  # fmt: skip
