"""Scenarios: input signals and events that act on a design over time."""

from __future__ import annotations

from .faults import design_faults
from .model import Scenario
from .reader import LoadedScenario, read_design_of, read_scenario, recorded_parts

__all__ = [
    "LoadedScenario",
    "Scenario",
    "design_faults",
    "read_design_of",
    "read_scenario",
    "recorded_parts",
]
