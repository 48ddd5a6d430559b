"""Samples of the law tests for glands over their range and for extrusion; see `model_samples`."""

from __future__ import annotations

POINTS = ((35e5, 0.2e-3), (70e5, 0.13e-3), (140e5, 0.05e-3))
TABLE = ((70.0, POINTS), (90.0, ((35e5, 0.36e-3), (210e5, 0.13e-3))))
SAMPLES: dict = {
    "gland.back_up_groove_width": {"groove_width": 4.8e-3, "thickness": 1.4e-3, "count": 2.0},
    "gland.volume_ratio": {
        "volume_expansion": 6.6e-4, "housing_expansion": 11.5e-6, "temperature_change": 60.0,
    },
    "gland.squeeze_at_volume": {"squeeze": 0.13, "volume_ratio": 1.05},
    "gland.squeeze_extremes": {
        "squeeze": 0.13, "section": 3.53e-3, "section_tolerance": 1e-4, "depth_tolerance": 3e-5,
        "eccentricity": 4e-5,
    },
    # between two points, below the first, beyond the last
    "gland.gap_limit": [
        {"pressure": pressure, "points": POINTS} for pressure in (90e5, 20e5, 300e5)
    ],
    # inside; beyond the end of one row; softer and harder than the table
    "gland.extrusion_gap_limit": [
        {"hardness": hardness, "pressure": pressure, "table": TABLE}
        for hardness, pressure in ((77.0, 90e5), (77.0, 180e5), (60.0, 50e5), (95.0, 50e5))
    ],
    # both known; beyond the end of the seal, of the ring, of both
    "gland.backed_gap_limit": [
        {"pressure": pressure, "seal_limit": 1.2e-4, "seal_end": seal_end, "ring_limit": 0.8e-4,
         "ring_end": 300e5} for pressure, seal_end in (
            (150e5, 200e5), (250e5, 200e5), (350e5, 400e5), (450e5, 400e5))
    ],
    "gland.extrusion_pressure_end": [
        {"hardness": hardness, "table": TABLE} for hardness in (60.0, 77.0, 95.0)
    ],
}  # fmt: skip
