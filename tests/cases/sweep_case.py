"""Designs and ways that the tests of sweeps share."""

from __future__ import annotations

KNEE = "designs/knee_bonded.yaml"
STEEL = "designs/steel_baseline.yaml"
NEAR = {  # the optimum of the shipped knee with some room at every limit
    "barrel.layup[0].thickness": "1.2 mm", "barrel.layup[1].thickness": "2.77 mm",
    "barrel.layup[2].thickness": "1.06 mm", "barrel.layup[2].angle": "20 deg",
    "rod.outer_diameter": "10.8 mm", "rod.inner_diameter": "5.3 mm", "piston.length": "10.4 mm",
    "head.length": "6 mm", "caps.thickness": "5.6 mm", "retention.wall": "2.47 mm",
    "retention.length": "18.4 mm", "seals.piston.squeeze": "12.45 %",
    "seals.rod.squeeze": "12.25 %", "cylinder.bore": "21.0 mm",
    "requirements.stiffness_min.min": "9.7 kN/mm", "requirements.friction_running.max": "296 N",
    "requirements.seal_gap.max": "34.5 um",
}  # fmt: skip
WAYS = ["cylinder.bore=20.9..21.1 mm", "barrel.layup[1].thickness=2.5..3.3 mm"]
