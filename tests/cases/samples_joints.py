"""Samples of the law tests for pins and shrunk rings; merged into `model_samples`."""

from __future__ import annotations

from samples_tube import LAYERS

from actuator_opt.models import laminate_pins, shrink_fit
from actuator_opt.models.layered_tube import layered_tube

ROW = {"force": 7e3, "count": 8.0, "diameter": 4e-3}
STIFFNESS = (139e9, 2.5e9, 9.1e9, 5e9)
PLIES = [
    laminate_pins.FibreLayer(thickness, angle, STIFFNESS, 1.7e9, 1.1e9)
    for thickness, angle in ((1e-3, 1.5), (2e-3, 0.8), (0.9e-3, 0.05))
]
RING = {"inner_radius": 15e-3, "wall_thickness": 2e-3}


def growth_of(layers, inner_radius, **loads):
    """Growth of the outside of a tube, from numbers."""
    tube = layered_tube(layers=layers, inner_radius=inner_radius)
    return shrink_fit.outer_growth(tube=tube, **loads)


def stress_of(layers, inner_radius):
    """Stress at the bore of a tube under outer pressure, from numbers."""
    return shrink_fit.bore_stress(tube=layered_tube(layers=layers, inner_radius=inner_radius))


SAMPLES: dict = {
    "laminate_pins.bearing_stress": {**ROW, "thickness": 3e-3},
    "laminate_pins.shear_out_stress": {
        "force": 7e3, "count": 8.0, "thickness": 3e-3, "edge_distance": 12e-3,
    },
    "laminate_pins.net_section_stress": {**ROW, "thickness": 3e-3, "radius": 14e-3},
    "laminate_pins.elastic_hole_factor": [
        {"diameter": 4e-3, "pitch": 11e-3, "edge_distance": edge} for edge in (8e-3, 14e-3)
    ],
    "laminate_pins.laminate_hole_factor": {"elastic_factor": 2.6},
    "laminate_pins.pin_shear": ROW,
    "laminate_pins.pin_bending": {**ROW, "lever_length": 1.5e-3},
    "laminate_pins.plastic_pin_bending": {**ROW, "lever_length": 1.5e-3},
    "laminate_pins.holding_depth": {"depth": 5e-3, "lever_length": 1.5e-3},
    "laminate_pins.pin_flexibility": {
        "diameter": 4e-3, "thickness": 3e-3, "modulus": 5e10, "depth": 5e-3,
        "plug_modulus": 7e10, "pin_modulus": 2e11,
    },
    "laminate_pins.first_row_share": [
        {"row_stiffness": 2e8, "tube_give": 1e-9, "sleeve_give": 2e-9, "loaded_together": together}
        for together in (False, True)
    ],
    "laminate_pins.axial_modulus": {"layers": PLIES},
    "laminate_pins.fibre_strengths": {"layers": PLIES},
    "laminate_pins.bearing_cycles": {"share": 0.4},
    "shrink_fit.outer_growth": (growth_of, {
        "layers": LAYERS, "inner_radius": 16e-3, "inner_pressure": 25e6, "outer_pressure": 9e6,
        "axial_force": 9e3, "temperature_change": -60.0,
    }),
    "shrink_fit.bore_stress": (stress_of, {"layers": LAYERS, "inner_radius": 16e-3}),
    "shrink_fit.ring_give": {**RING, "youngs_modulus": 2.1e11, "poissons_ratio": 0.3},
    "shrink_fit.contact_pressure": {
        "interference": 2e-5, "tube_growth": 5e-6, "ring_growth": 1e-6, "tube_give": 5e-13,
        "give": 6e-13,
    },
    "shrink_fit.grip": {
        "friction_coefficient": 0.12, "radius": 15e-3, "pressure": 17e6, "length": 15e-3,
    },
    "shrink_fit.ring_stress": RING,
    "shrink_fit.plastic_pressure": {**RING, "yield_strength": 355e6},
    "shrink_fit.collapse_pressure": {"hoop_bending_stiffness": 60.0, "radius": 12e-3},
}  # fmt: skip
