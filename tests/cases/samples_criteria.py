"""Samples of the law tests for the criteria models; merged into `model_samples`."""

from __future__ import annotations

from dataclasses import replace

from actuator_opt.models.strength_modes import PlyRatios, PlyStrength

STRENGTH = PlyStrength(1900e6, 1300e6, 55e6, 190e6, 85e6)
SQUEEZED = replace(STRENGTH, shear_23=62e6)
RATIOS = PlyRatios(
    poissons_ratio_12=0.28, poissons_ratio_13=0.3, poissons_ratio_23=0.42, modulus_ratio=0.07
)
PULLED = {"stress": (400e6, 30e6, -25e6, 40e6), "strength": STRENGTH}
PRESSED = {"stress": (-300e6, -90e6, -15e6, 60e6), "strength": STRENGTH}
SHEARED = {"stress": (10e6, -20e6, -5e6, -60e6), "strength": SQUEEZED}
COOLED, CRUSHED = (-40e6, 20e6, 3e6, 5e6), (60e6, -80e6, -4e6, 6e6)
LOADS = [
    PULLED,
    PRESSED,
    SHEARED,
    {**PULLED, "residual": COOLED},
    {**PULLED, "residual": CRUSHED},
    {**PRESSED, "residual": COOLED},
    {**PRESSED, "residual": CRUSHED},
    {**SHEARED, "residual": COOLED},
    {**SHEARED, "residual": (0.7e6, 90e6, 1e6, 2e6)},
]
"""Loads with and without residual stress, across sigma_2 = 0 in both directions and not at all."""

SAMPLES: dict = {
    "strength_modes.one_stress_modes": [
        {"stress": 30e6, "tension": 55e6, "compression": 190e6},
        {"stress": 30e6, "tension": 55e6, "compression": 190e6, "residual": 20e6},
        {"stress": -30e6, "tension": 55e6, "compression": 190e6, "residual": 70e6},
    ],
    "strength_modes.max_stress_modes": LOADS,
    "strength_modes.max_strain_modes": [{**load, "elastic": RATIOS} for load in LOADS],
    "strength.tsai_wu_modes": [*LOADS, {**PULLED, "interaction": -0.3}],
    "strength_modes.hashin_modes": [*LOADS, {**PULLED, "fibre_shear": 0.4}],
    "strength_modes.puck_modes": [
        *LOADS,
        {**SHEARED, "inclination_tension": 0.30, "inclination_compression": 0.25},
    ],
}
"""Arguments by ``module.function``: one sample, or a list of them."""
