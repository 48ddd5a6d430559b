"""Samples of the law tests for chambers that keep their mass, end stops and linkages."""

from __future__ import annotations

OIL = {"bulk_modulus": 1.4e9, "slope": 8.0}
AIRY = {**OIL, "air_content": 0.01, "polytropic_index": 1.3}
STOP = {"stiffness": 5e7, "damping": 2e4}
BOTH = {"base_radius": 0.3, "crank_radius": 0.04, "angle_offset": 0.2}

SAMPLES = {
    "chamber.density_ratio": [
        {"pressure": 2e7, **OIL}, {"pressure": 2e5, **AIRY}, {"pressure": -5e4, **AIRY},
        {"pressure": 2e7, "bulk_modulus": 1.4e9, "slope": 0.0},
    ],
    "chamber.cavity": [{"pressure": p, "content": 1e-6} for p in (-5e4, 2e5)],
    "chamber.mixture_bulk_modulus": [
        {"pressure": 2e7, **OIL}, {"pressure": 2e5, **AIRY}, {"pressure": -5e4, **AIRY},
    ],
    "chamber.pressure_rate": {
        "flow": 1e-4, "volume": 1e-4, "volume_rate": 4e-5, "bulk_modulus": 1.4e9,
        "compliance": 2e-14,
    },
    "end_stop.stop_stiffness": {"area": 8e-4, "pressure": 1.4e7},
    "end_stop.stop_damping": {"stiffness": 5e7, "mass": 30.0},
    "end_stop.cushion_flow_area": [
        {
            "remaining": remaining, "length": 0.02, "open_area": 3e-5, "end_area": 1e-6,
            "exponent": 0.6,
        }
        for remaining in (0.03, 0.01, -1e-3)
    ],
    "end_stop.cushion_pressure": [
        {
            "speed": speed, "area": 6e-4, "flow_area": 4e-6, "density": 870.0,
            "dynamic_viscosity": 0.04, "back_pressure": 5e5,
        }
        for speed in (0.3, -0.3)
    ],
    "end_stop.cushion_mean_pressure": {
        "driving_force": 6000.0, "mass": 40.0, "velocity": 0.3, "length": 0.02, "area": 6e-4,
    },
    "end_stop.cushion_open_area": {
        "velocity": 0.3, "area": 6e-4, "pressure": 1e7, "density": 870.0,
    },
    "linkage.linkage": {**BOTH, "joint_angle": 1.1},
    "linkage.linkage_angle": {**BOTH, "length": 0.29},
    "linkage.joint_torque": {"force": 3e3, "lever_arm": -0.04},
    "linkage.actuator_force": {"torque": 120.0, "lever_arm": -0.04},
    "linkage.reflected_inertia": {"inertia": 0.8, "lever_arm": 0.04, "lever_slope": 0.01},
}  # fmt: skip
