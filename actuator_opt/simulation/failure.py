"""Explanation of a run that failed."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..base.errors import Diagnostic, Unsolvable
from ..base.numeric import Array
from ..studies.plant import Plant
from .methods import Stuck
from .system import Compiled

TOLD = ("position", "speed", "shaft_speed", "pressure_a", "pressure_b", "pressure_supply")
"""Signals that help to explain a failure."""
OUT = 0.1
"""Overrun of the stroke, as a share of it, beyond which the stops have failed (a choice)."""


def failed(stuck: Stuck, compiled: Compiled, plant: Plant) -> Unsolvable:
    """The failure with the actuator's state there, and the likeliest cause."""
    flags = np.zeros((len(compiled.system.flags), 1), dtype=bool)
    signals = compiled.signals(np.array([stuck.time]), stuck.state[:, None], list(flags))
    words = [
        f"{one.label} {one.quantity.text(float(signals[one.name][0]))}"
        for one in compiled.system.signals
        if one.name in TOLD and np.isfinite(signals[one.name][0])
    ]
    (fault,) = stuck.diagnostics
    at = f" ({', '.join(words)})" if words else ""
    remedy = _outside(signals, plant) or fault.remedy
    return Unsolvable(Diagnostic(f"{fault.message}{at}", remedy))


def _outside(signals: Mapping[str, Array], plant: Plant) -> str:
    """Remedy for a piston that has left its stroke; empty otherwise."""
    if "position" not in signals:
        return ""
    position = float(signals["position"][0])
    beyond = max(-position, position - plant.stroke)
    if plant.design.linkage is not None and beyond > 0:
        return "the joint reaches its dead centre beyond the stop: lower its load"
    if beyond > OUT * plant.stroke:
        return "the piston is beyond its stops: lower the load, or stiffen them (stop_travel)"
    return ""
