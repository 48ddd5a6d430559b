"""Optima of shipped designs, solved once in a process for all tests that only read them."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import actuator_opt as ao

DESIGNS = Path(__file__).parents[2] / "designs"


@cache
def shipped(name: str) -> ao.Optimisation:
    """The optimum of a shipped design, from two starts and without prices."""
    return ao.optimise(DESIGNS / f"{name}.yaml", starts=2, prices=False)


def shipped_mass(name: str) -> float:
    """Mass of that optimum [kg]."""
    return shipped(name).evaluation.metrics["mass"].value
