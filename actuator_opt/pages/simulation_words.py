"""What was simulated, in words: signals, loops, what was around the design."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from ..base.quantities import INPUTS, SCENARIOS, Quantity
from ..design.scenario.components import ENDS, FRICTIONS, SUPPLIES
from ..design.scenario.model import Scenario
from ..design.scenario.shapes import SHAPES, height
from ..rendering.text import sentence, trimmed, unit_text, with_unit
from ..simulation.assemble import ends_of
from ..simulation.loops import LOOPS
from ..simulation.result import Simulation

MOST_PARTS = 3
"""Parts of a signal that are told."""
PRESSURE, LENGTH = INPUTS["pressure"], INPUTS["position"]
_UNITS = r"(?:mm|m|m/s|ms|s|V|bar|k?N|Hz|J|l/min|rpm|rad|N·m|V/m|kN/mm|MPa)(?![\w/])|%|°"
_TIED = re.compile(rf"(?<=\d) (?={_UNITS})")


def tied(words: str) -> str:
    r"""Words of a page: a number stays on the line of its unit.

    >>> tied("step of 20 mm at 0.5 s, 3 steps")
    'step of 20\xa0mm at 0.5\xa0s, 3 steps'
    """
    return _TIED.sub("\N{NO-BREAK SPACE}", words)


def amount(quantity: Quantity, value: float) -> str:
    """A value that a person wrote, with its unit."""
    return with_unit(trimmed(quantity.to_display(value)), unit_text(quantity.unit))


def _part(part: Any, quantity: Quantity) -> str:
    """A part of a signal."""
    return SHAPES[part.shape].words(part, amount(quantity, height(part)), trimmed)


def parts_words(parts: Sequence[Any], quantity: Quantity) -> str:
    """A signal in words; empty where it is zero all the time."""
    told = [one for one in parts if height(one) or "file" in SHAPES[one.shape].needed]
    said = [_part(one, quantity) for one in told[:MOST_PARTS]]
    more = len(told) - len(said)
    return ", ".join(said) + (f" and {more} more" if more else "")


def what(found: Simulation) -> str:
    """What was simulated, in a few sentences."""
    scenario, plant = found.scenario, found.plant
    said = [f"{plant.design.name}: {_machine(found)}, {trimmed(scenario.duration)} s."]
    control = scenario.control
    asked = ""
    for name, one in LOOPS.items() if control is not None else ():
        words, quantity = one.words, one.quantity
        if found_words := parts_words(getattr(control, name), quantity):
            asked = f"{words}: {found_words}"
            if name == "position":
                start = amount(quantity, float(found.signals["position"][0]))
                asked = f"{words} from {start}: {found_words}"
    if not asked:
        signal = parts_words(scenario.signal, SCENARIOS["signal_value"])
        asked = f"valve signal: {signal}" if signal else ""
    torque = scenario.load.torque if scenario.motor is None else scenario.motor.torque
    said += [
        sentence(words)
        for words in (
            asked,
            _told("load", parts_words(scenario.load.force, SCENARIOS["force_value"])),
            _told("torque", parts_words(torque, SCENARIOS["torque_value"])),
            _told("machine outside", _drive(scenario)),
            _load_cylinder(scenario),
        )
        if words
    ]
    return " ".join(said)


def _told(head: str, words: str) -> str:
    return f"{head}: {words}" if words else ""


def _drive(scenario: Scenario) -> str:
    drive = scenario.load.drive
    return "" if drive is None else parts_words(drive.position, LENGTH)


def _load_cylinder(scenario: Scenario) -> str:
    """Bore and rod of the load cylinder, with its signal."""
    one = scenario.load.cylinder
    if one is None:
        return ""
    bore, rod = (amount(LENGTH, value) for value in (one.bore, one.rod_diameter))
    signal = parts_words(one.signal, SCENARIOS["signal_value"])
    said = f"valve signal: {signal}" if signal else "no signal at its valve"
    return f"load cylinder of bore {bore} and rod {rod}, {said}"


def _machine(found: Simulation) -> str:
    """What was around the design."""
    scenario, plant = found.scenario, found.plant
    held = scenario.held_ports
    words = []
    if held is not None:
        ports = " and ".join(amount(PRESSURE, p) for p in (held.pressure_a, held.pressure_b))
        words.append(f"the valve alone, ports at {ports}")
    elif scenario.motor is not None:
        words.append("its valve with a hydraulic motor")
    elif "flow_supply" not in found.signals:
        words.append(ENDS[ends_of(scenario, plant)].words or "")
    if "flow_supply" in found.signals:
        relief = scenario.supply.relief
        supply = SUPPLIES[scenario.supply.type].words
        if scenario.supply.type == "fixed_pump" and relief is not None:
            supply += f", relief valve {amount(PRESSURE, relief.pressure)}"
        else:
            supply += f" {amount(PRESSURE, plant.supply_pressure)}"
        words.append(f"{supply}, return {amount(PRESSURE, plant.return_pressure)}")
    if "friction" in found.signals:
        words.append(FRICTIONS[scenario.friction.model].words)
    return ", ".join(words)
