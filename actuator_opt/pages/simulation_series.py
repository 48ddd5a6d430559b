"""What of a Simulation is drawn over time: strips by the signals that it has."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..base.numeric import Array
from ..base.quantities import Quantity
from ..models.fluid import ATMOSPHERIC_PRESSURE
from ..rendering.text import unit_text
from ..simulation.loops import LOOPS, Loop, loop_of
from ..simulation.result import Simulation
from .simulation_axes import ASKED, LEVEL, LIMIT, MEASURED, STYLES, Curve, Level, Strip
from .simulation_words import PRESSURE

Measured = Mapping[str, tuple[Array, Array]]
"""Time [s] and values (SI) by the name of the signal."""
_SIGNALS: tuple[tuple[str, int, bool, tuple[tuple[str, str], ...]], ...] = (
    ("Speed", 6, True, (("speed", ""),)),
    ("Shaft speed", 1, True, (("shaft_speed", ""),)),
    ("Shaft angle", 5, False, (("shaft_angle", ""),)),
    ("Joint angle", 7, False, (("joint_angle", ""),)),
    ("Valve signal", 3, True, (("signal", "signal"), ("spool", "spool"))),
    ("Pressures", 2, False, (("pressure_a", "A"), ("pressure_b", "B"))),
    (
        "Supply",
        7,
        False,
        (("pressure_supply", "supply"), ("pressure_accumulator", "accumulator")),
    ),
    ("Flows into the ports", 4, True, (("flow_a", "A"), ("flow_b", "B"))),
    ("Flows of the line", 4, True, (("flow_supply", "from supply"), ("flow_tank", "to tank"))),
    ("Flows of the pump", 7, True, (("flow_pump", "pump"), ("flow_relief", "relief"))),
    ("Flows past the throttles", 5, True, (("flow_throttle_a", "out of A"),
                                           ("flow_throttle_b", "out of B"))),
    ("Friction", 5, True, (("friction", ""),)),
    ("Load", 6, True, (("load_force", ""),)),
    ("Torques", 4, True, (("torque", "motor"), ("load_torque", "load"))),
    ("Torque on the joint", 8, True, (("joint_torque", ""),)),
    ("Stops and cushions", 5, True, (("stop_force", "stops"), ("cushion_force", "cushions"))),
)  # fmt: skip
"""Title, rank, whether zero belongs to it, and signals with their names."""
_STILL = {"Stops and cushions", "Load", "Supply", "Torque on the joint", "Friction"}
"""Strips that are left out where nothing in them moves."""

_PUMPED = ("Supply", "Flows of the pump")
"""Strips that come early where the supply is no constant one."""


def scaled(quantity: Quantity, values: Array) -> Array:
    """Values in the unit shown."""
    return np.asarray(values, dtype=float) * quantity.to_display(1.0)


def curve(found: Simulation, name: str, words: str, style: dict[str, Any]) -> Curve:
    """A signal as a curve."""
    return Curve(words, found.time, scaled(found.told[name].quantity, found.signals[name]), style)


def overlay(found: Simulation, name: str, measured: Measured) -> list[Curve]:
    """What was measured of a signal, to lie under it."""
    if name not in measured or name not in found.told:
        return []
    time, values = measured[name]
    shown = scaled(found.told[name].quantity, values)
    return [Curve("measured", np.asarray(time, dtype=float), shown, MEASURED)]


def titled(words: str, quantity: Quantity) -> str:
    """A title with its unit.

    >>> from actuator_opt.base.quantities import SCENARIOS
    >>> titled("Speed", SCENARIOS["speed_value"]), titled("Ratio", SCENARIOS["factor"])
    ('Speed, m/s', 'Ratio')
    """
    unit = unit_text(quantity.unit)
    return f"{words}, {unit}" if unit else words


def followed(found: Simulation) -> Loop | None:
    """The signal that a controller follows, or what moves; None where nothing does."""
    control = found.scenario.control
    if control is not None and "reference" in found.signals:
        return loop_of(control)
    return next((name for name in ("position", "shaft_speed") if name in found.signals), None)


def response(found: Simulation, measured: Measured) -> Strip | None:
    """What moves, with what was asked for and what was measured; None where nothing moves."""
    name = followed(found)
    if not name:
        return None
    words, quantity, *_ = LOOPS[name]
    curves = overlay(found, name, measured)
    asked = "reference" if "reference" in found.signals else "drive_position"
    if asked in found.signals:
        curves.append(curve(found, asked, "asked" if asked == "reference" else "machine", ASKED))
    own = "response" if curves else ""
    curves.append(curve(found, name, own, STYLES[0]))
    return Strip(titled(words.capitalize(), quantity), tuple(curves), rank=0)


def strips(found: Simulation, measured: Measured) -> list[Strip]:
    """Everything worth a strip, the response first."""
    shown = []
    first = response(found, measured)
    if first is not None:
        shown.append(first)
    if "error" in found.signals:
        quantity = found.told["error"].quantity
        own = curve(found, "error", "", STYLES[0])
        shown.append(Strip(titled("Error", quantity), (own,), zero=True, rank=3))
    used = followed(found)
    if used not in (None, "position") and "position" in found.signals:
        shown += _strip(found, measured, "Position", 5, False, (("position", ""),))
    pumped = found.scenario.supply.type != "constant"
    for title, rank, zero, signals in _SIGNALS:
        if used not in [name for name, _ in signals]:
            early = 3 if pumped and title in _PUMPED else rank
            shown += _strip(found, measured, title, early, zero, signals)
    return shown


def _strip(
    found: Simulation,
    measured: Measured,
    title: str,
    rank: int,
    zero: bool,
    signals: Sequence[tuple[str, str]],
) -> list[Strip]:
    here = [(name, words) for name, words in signals if name in found.signals]
    if title == "Flows of the line" and found.scenario.held_ports is None:
        return []
    if title in _STILL and not any(_moves(found.signals[name]) for name, _ in here):
        return []
    if not here:
        return []
    under = [one for name, _ in here for one in overlay(found, name, measured)]
    over = [
        curve(found, name, words if len(here) > 1 else "", style)
        for (name, words), style in zip(here, STYLES, strict=False)
    ]
    if under and len(over) == 1:
        over = [curve(found, here[0][0], "simulated", STYLES[0])]
    quantity = found.told[here[0][0]].quantity
    levels, zero = _levels(found, here[0][0], zero)
    return [Strip(titled(title, quantity), (*under, *over), levels, zero, rank)]


def _moves(values: Array) -> bool:
    return float(np.ptp(values)) > 1e-9 * max(float(np.max(np.abs(values))), 1e-12)


def _levels(found: Simulation, name: str, zero: bool) -> tuple[tuple[Level, ...], bool]:
    """Levels of a strip, and whether they belong to its axis."""
    scale = PRESSURE.to_display(1.0)
    if name == "pressure_a":
        plant = found.plant
        vapour = Level("vapour", scale * (plant.oil.vapour_pressure - ATMOSPHERIC_PRESSURE), LIMIT)
        supplied = found.signals.get("pressure_supply")
        if supplied is None:
            return (vapour,), False
        held = [plant.return_pressure] + ([] if _moves(supplied) else [plant.supply_pressure])
        words = "supply, return" if len(held) > 1 else "return"
        return (*(Level(words, scale * p, LEVEL) for p in held), vapour), True
    if name == "signal" and found.plant.valve is not None:
        full = found.plant.valve.signal
        if float(np.max(np.abs(found.signals[name]))) > 0.5 * full:
            return tuple(Level("limit", way * full, LEVEL) for way in (1, -1)), True
    return (), zero
