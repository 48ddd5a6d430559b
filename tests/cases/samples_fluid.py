"""Samples of the law tests for vapour pressure and compressed density; see `model_samples`."""

from __future__ import annotations

SAMPLES = {
    "fluid.vapour_pressure": {
        "temperature": 330.0, "points_temperature": (293.0, 313.0, 333.0),
        "points_pressure": (1.75e3, 5.5e3, 15e3),
    },
    "oil_laws.density_compressed": [
        {"reference_density": 870.0, "pressure": 2e7, "bulk_modulus": 1.4e9, "slope": 10.8},
        {"reference_density": 870.0, "pressure": 2e7, "bulk_modulus": 1.4e9, "slope": 0.0},
    ],
}  # fmt: skip
