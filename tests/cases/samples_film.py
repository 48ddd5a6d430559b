"""Samples of the law tests for rough surfaces and their flow factors; see `model_samples`."""

from __future__ import annotations

CONTACT = {
    "youngs_modulus": 3e7, "poissons_ratio": 0.48, "asperity_density": 8e13,
    "asperity_radius": 1.5e-6, "roughness": 1e-6,
}  # fmt: skip

SAMPLES = {
    "rough_surface.composite_roughness": {"first": 8e-7, "second": 3e-7},
    "rough_surface.asperity_integral": [
        {"film_ratio": 2.5, "order": order} for order in ("-1/2", "1/2", "3/2", "5/2")
    ] + [{"film_ratio": -1.5}],
    "rough_surface.asperity_stiffness": CONTACT,
    "rough_surface.asperity_pressure": {"film_ratio": 2.5, **CONTACT},
    "rough_surface.film_ratio_under_contact": [
        {"contact_pressure": 7.5e6, "stiffness": 5.1e9},
        {"contact_pressure": 7.5e6, "stiffness": 5.1e6},
    ],
    "rough_surface.mean_gap_ratio": [{"film_ratio": h} for h in (-2.0, 0.7, 2.5, 12.0, -12.0)],
    "rough_surface.pressure_flow_factor": {"film_ratio": 2.5},
    "rough_surface.shear_flow_factor": [
        {"film_ratio": h, "rod_share": 0.3} for h in (2.5, 8.0, -1.0)
    ],
    "rough_surface.shear_stress_factor": [{"film_ratio": h} for h in (1.5, 8.0, 40.0, -1.0)],
    "rough_surface.shear_stress_correction": [
        {"film_ratio": h, "rod_share": 0.3} for h in (2.5, 8.0, -1.0)
    ],
    "rough_surface.pressure_stress_factor": [{"film_ratio": 2.5}, {"film_ratio": 0.3}],
}  # fmt: skip
