"""Shipped designs, evaluated and solved once in a process for all tests that only read them."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import actuator_opt as ao

DESIGNS = Path(__file__).parents[2] / "designs"

KNEE = (DESIGNS / "knee.yaml").read_text("utf-8")
for stated, changed in (
    ("      thickness: 1 mm", "      thickness: 1.85 mm"),
    ("      thickness: 3.65 mm", "      thickness: 2.65 mm"),
    ("  bore: 22.3 mm", "  bore: 21.8 mm"),
    (
        "  outer_diameter: 12.85 mm\n  inner_diameter: 10 mm",
        "  outer_diameter: 12 mm\n  inner_diameter: 8 mm",
    ),
    ("  length: 15.5 mm", "  length: 12.5 mm"),
    ("  length: 6.5 mm", "  length: 8 mm"),
    ("  thickness: 4.95 mm", "  thickness: 4.7 mm"),
    ("preload: 14.2 kN           # mean of a torque wrench: 10.9 kN to 17.5 kN", "preload: 8 kN"),
    ("  length: 5 mm\n  wall: 2.2 mm", "  length: 7 mm\n  wall: 1.1 mm"),
):
    assert stated in KNEE
    KNEE = KNEE.replace(stated, changed)
"""The shipped knee, whose liner starts thick enough for the thread of its plugs."""

SLEEVE = (
    KNEE[KNEE.index("  sleeve:") : KNEE.index("\nclevis:")],
    KNEE[KNEE.index("  retention.sleeve.wall:") : KNEE.index("  seals.piston.squeeze:")],
)
"""Keys and variables of its thicker ends."""

PLAIN_KNEE = KNEE.replace(SLEEVE[0], "").replace(SLEEVE[1], "")
"""The knee with plugs screwed into a liner of one thickness."""


@cache
def evaluated(name: str) -> ao.Evaluation:
    """The evaluation of a shipped design."""
    return ao.evaluate(DESIGNS / f"{name}.yaml")


@cache
def shipped(name: str) -> ao.Optimisation:
    """The optimum of a shipped design, from two starts and without prices."""
    return ao.optimise(DESIGNS / f"{name}.yaml", starts=2, prices=False)


def shipped_mass(name: str) -> float:
    """Mass of that optimum [kg]."""
    return shipped(name).evaluation.metrics["mass"].value
