"""The knee and its steel counterpart with a wider gap and less stiffness."""

from __future__ import annotations

from pathlib import Path

import actuator_opt as ao

DESIGNS = Path(__file__).parents[2] / "designs"
WIDE = {
    "requirements.seal_gap.max": "60 um",
    "requirements.stiffness_min.min": "6 kN/mm",
    "requirements.blocked_port_factor.min": "1",
}


def test_a_wide_gap_makes_the_composite_knee_a_third_lighter_than_steel():
    """At 60 um and 6 kN/mm both are optima, their seals bear the gap, and composite is lighter."""
    masses = {}
    for name in ("knee", "steel_baseline"):
        found = ao.optimise(ao.read(DESIGNS / f"{name}.yaml", set=WIDE), prices=False, starts=2)
        assert found.status == "optimal"
        assert found.kkt.residual <= 1e-6
        assert not [row.name for row in found.evaluation.checks if row.status == "missed"]
        metrics = found.evaluation.metrics
        assert metrics["extrusion_factor"].value >= 1.0
        assert metrics["seal_gap"].value < 60e-6
        masses[name] = found.objective_value
    assert masses["knee"] < 0.7 * masses["steel_baseline"]
