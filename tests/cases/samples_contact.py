"""Samples of the law tests for the seal contact models; merged into `model_samples`."""

from __future__ import annotations

LIP = {
    "interference": 0.4e-3, "root_clearance": 0.5e-3, "youngs_modulus": 43e6,
    "poissons_ratio": 0.48, "lip_thickness": 1.8e-3, "lip_length": 5e-3,
}  # fmt: skip
TUBE = {name: LIP[name] for name in ("youngs_modulus", "poissons_ratio", "lip_thickness")}
ENDS = {"sealed_pressure": 5e6, "outer_pressure": 0.1e6}
CARRIED = {"line_load": 16e3, "width": 3e-3, **ENDS}
TABLE = {"positions": (0.05, 0.22, 0.51, 0.97), "pressures": (5e6, 8e6, 6e6, 0.4e6)}

SAMPLES: dict = {
    "elastomer.modulus_gent": {"hardness": 75.0},
    "elastomer.modulus_ruess": {"hardness": 75.0},
    "elastomer.modulus_bounds": {"hardness": 70.0, "hardness_scatter": 5.0},
    "elastomer.temperature_factor": [
        {
            "temperature": temperature, "reference_temperature": 296.0, "softening": 0.002,
            "stiffening_temperature": 250.0,
        }
        for temperature in (253.0, 353.0)
    ],
    "lip_seal.lip_interference": {"section": 6.4e-3, "gland_depth": 5.3e-3},
    # a short lip (series), a usual one, one longer than the decay of its edge load
    "lip_seal.lip_stiffness": [
        {**TUBE, "lip_length": 5e-3, "lip_radius": radius} for radius in (1.0, 40e-3, 6e-3)
    ],
    # the rim alone, lying down, without pressure, no contact
    "lip_seal.lip_free_span": [
        {**LIP, "pressure": 0.2e6},
        {**LIP, "pressure": 6e6},
        {**LIP, "interference": 2e-3, "pressure": 0.0},
        {**LIP, "interference": -1e-4, "pressure": 6e6},
    ],
    "lip_seal.line_load": [
        {**LIP, "lip_radius": 20e-3, "pressure": pressure} for pressure in (0.2e6, 6e6)
    ] + [{**LIP, "lip_radius": 20e-3, "pressure": 6e6, "interference": -1e-4}],
    "lip_seal.peak_pressure": {
        **{name: value for name, value in LIP.items() if name != "root_clearance"},
        "lip_radius": 20e-3, "edge_radius": 0.2e-3, "pressure": 3e6,
    },
    "lip_seal.contact_width": {
        "line_load": 6e3, "peak_pressure": 8e6, "pressure": 3e6, "lip_length": 5e-3,
    },
    "step_seal.wetted_back": {
        "ring_width": 3.9e-3, "foot_width": 1.1e-3, "section": 2.6e-3, "squeeze": 0.15,
    },
    "step_seal.line_load": {
        "energiser_load": 15e3, "pressure": 5e6, "wetted_back": 1.6e-3, "wetted_front": 2.4e-3,
    },
    "step_seal.contact_width": {
        "line_load": 20e3, "land": 0.8e-3, "taper": 0.09, "ring_width": 3.9e-3,
        "youngs_modulus": 600e6, "poissons_ratio": 0.46,
    },
    "compact_seal.energised_share": {"poissons_ratio": 0.48},
    "compact_seal.contact_width": {
        "squeeze": 0.12, "face_width": 8e-3, "groove_width": 10e-3,
    },
    "compact_seal.line_load": {
        "squeeze": 0.12, "face_width": 8e-3, "youngs_modulus": 9e6, "poissons_ratio": 0.48,
        "pressure": 5e6,
    },
    "contact_profile.o_ring_profile": {"position": 0.3, "excess": 2e6, **ENDS},
    "contact_profile.o_ring_mean": {"excess": 2e6, **ENDS},
    "contact_profile.o_ring_excess": CARRIED,
    # each cubic; a profile that only falls; one whose sealed end is bounded
    "contact_profile.lip_profile": [
        {"position": position, "excess": 1.5e6, **ENDS} for position in (0.1, 0.4, 0.8)
    ] + [{"position": 0.1, "excess": excess, **ENDS} for excess in (-1e6, 0.2e6)],
    "contact_profile.lip_mean": [{"excess": excess, **ENDS} for excess in (-1e6, 0.2e6, 1.5e6)],
    "contact_profile.lip_excess": [CARRIED, {**CARRIED, "line_load": 9.1e3}],
    "contact_profile.table_profile": {"position": 0.35, **TABLE},
    "contact_profile.table_mean": TABLE,
    "contact_profile.land_profile": {"position": 0.3, "excess": 2e6, **ENDS},
    "contact_profile.land_excess": CARRIED,
    # a peak inside; one at the sealed end
    "contact_profile.land_peak": [CARRIED, {**CARRIED, "line_load": 7e3}],
}  # fmt: skip
