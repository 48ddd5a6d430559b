"""Reference quantities of a controller: position or speed, of the piston or of a motor shaft."""

from __future__ import annotations

from typing import Literal, NamedTuple

from ..base.quantities import INPUTS, SCENARIOS, Quantity
from ..design.scenario.model import Control

Loop = Literal["position", "speed", "shaft_speed", "shaft_angle"]


class Followed(NamedTuple):
    """The quantity a loop controls."""

    words: str
    quantity: Quantity
    unit: str
    """Quantity of the loop's gain."""
    typical: float
    """A typical error, for tolerances (SI)."""


def _followed(words: str, quantity: Quantity, gain: str, typical: float) -> Followed:
    return Followed(words, quantity, SCENARIOS[gain].unit, typical)


LOOPS: dict[Loop, Followed] = {
    "position": _followed("position", INPUTS["position"], "position_gain", 1e-2),
    "speed": _followed("speed", SCENARIOS["speed_value"], "speed_gain", 0.1),
    "shaft_speed": _followed(
        "shaft speed", SCENARIOS["shaft_speed_value"], "shaft_speed_gain", 10.0
    ),
    "shaft_angle": _followed(
        "shaft angle", SCENARIOS["shaft_angle_value"], "shaft_angle_gain", 1.0
    ),
}
"""Every loop, by the name of its reference and its signal."""


def loop_of(control: Control | None) -> Loop | None:
    """The loop that a reference closes, or None."""
    if control is None:
        return None
    return next((name for name in LOOPS if getattr(control, name)), None)
