"""Contradictions between values of a scenario, or between scenario and design."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from ...base import quantities
from ...base.errors import Fault
from ..build import how_to_add
from ..kinds import position_at
from ..model import Design
from ..structure import entries
from ..view import View, length_text, without_effect
from . import control_faults, signal_faults
from .components import FRICTIONS, SUPPLIES
from .model import Friction, Load, Scenario, Supply

_force = quantities.SCENARIOS["coulomb_force"].text
_flow = quantities.INPUTS["rated_flow"].text
_area = quantities.INPUTS["orifice_area"].text


def supply(view: View) -> Iterator[Fault]:
    """A supply has the keys that its type needs, and no others."""
    kind = view.text("supply", "type")
    own = SUPPLIES.get(kind or "")
    if own is None:  # a separate fault, reported at its place
        return
    known = entries(Supply)
    for key in own.needed:
        if not view.has("supply", key):
            message = f"missing: required by a {kind}"
            yield Fault(("supply", key), message, how_to_add(key, known[key]))
    flow, pump = view.has("supply", "flow"), view.has("supply", "pump")
    if kind == "fixed_pump" and not flow and not pump:
        remedy = f'{how_to_add("flow", known["flow"])}, or a block "pump:"'
        yield Fault(("supply", "flow"), f"missing: a {kind} needs this or pump", remedy)
    if kind == "fixed_pump" and flow and pump:
        message = "pump beside flow: both define the delivery"
        yield Fault(("supply", "pump"), message, "keep one of them", at_key=True)
    given, passed = (view.number("supply", *one) for one in (("flow",), ("relief", "rated_flow")))
    if kind == "fixed_pump" and given is not None and passed is not None and passed < given:
        message = f"{_flow(passed)}: less than the pump delivers ({_flow(given)})"
        yield Fault(("supply", "relief", "rated_flow"), message, f"write {_flow(given)} or more")
    where = "on a constant supply" if kind == "constant" else f"on a {kind}"
    remedy = "remove it, or write another type" if kind == "constant" else "remove the line"
    yield from without_effect(view, ("supply",), own.unread, where, remedy)


def cushion(view: View) -> Iterator[Fault]:
    """A cushion reduces the flow area of the oil."""
    loc = ("stops", "cushion")
    opened, closed = view.number(*loc, "open_area"), view.number(*loc, "end_area")
    if opened is not None and closed is not None and closed >= opened:
        message = f"{_area(closed)}: not smaller than open_area ({_area(opened)})"
        yield Fault((*loc, "end_area"), message, f"write less than {_area(opened)}")
    elif closed == 0:
        message = f"{_area(closed)}: the piston would never reach its stop"
        yield Fault((*loc, "end_area"), message, "write the area of the remaining gap")


def load_cylinder(view: View) -> Iterator[Fault]:
    """A load cylinder has an area and a pressure difference."""
    loc = ("load", "cylinder")
    bore, rod = view.number(*loc, "bore"), view.number(*loc, "rod_diameter")
    if bore is not None and rod is not None and rod >= bore:
        message = f"{length_text(rod)}: not smaller than bore ({length_text(bore)})"
        yield Fault((*loc, "rod_diameter"), message, f"write less than {length_text(bore)}")
    high, low = view.number(*loc, "supply_pressure"), view.number(*loc, "return_pressure")
    if high is not None and low is not None and low >= high:
        text = quantities.INPUTS["pressure"].text
        message = f"{text(low)}: not below supply_pressure ({text(high)})"
        yield Fault((*loc, "return_pressure"), message, f"write less than {text(high)}")


def friction(view: View) -> Iterator[Fault]:
    """A friction curve starts with Coulomb friction; breakaway is not below it."""
    model = view.text("friction", "model")
    own = FRICTIONS.get(model or "")
    if own is not None:
        yield from without_effect(view, ("friction",), own.unread, f"where model is {model}")
    if model == "none":
        return
    known = entries(Friction)
    if not view.has("friction", "coulomb"):
        for key in ("static", "stribeck_speed", "viscous"):
            if view.has("friction", key):
                message = f"missing: required with {key}"
                how = how_to_add("coulomb", known["coulomb"])
                yield Fault(("friction", "coulomb"), message, how)
                break
    if view.has("friction", "static") and not view.has("friction", "stribeck_speed"):
        remedy = 'add e.g. "stribeck_speed: 5 mm/s"'
        yield Fault(("friction", "stribeck_speed"), "missing: required with static", remedy)
    low, high = view.number("friction", "coulomb"), view.number("friction", "static")
    if low is not None and high is not None and high < low:
        message = f"{_force(high)}: below coulomb ({_force(low)})"
        yield Fault(("friction", "static"), message, f"write {_force(low)} or more")


def motor(view: View) -> Iterator[Fault]:
    """With a motor in place of the cylinder, no cylinder data are stated."""
    if not view.has("motor"):
        return
    where = "with a motor in place of the cylinder"
    if view.has("held_ports"):
        message = "held_ports beside motor: no oil flows to the motor"
        yield Fault(("held_ports",), message, "keep one of them", at_key=True)
    yield from without_effect(view, (), ("stops", "friction"), where)
    yield from without_effect(view, ("initial",), ("position", "speed"), where)
    yield from without_effect(
        view, ("load",), entries(Load), where, "the load of the motor is under motor"
    )
    yield from without_effect(view, ("control",), ["speed_feedback"], where)


def held_ports(view: View) -> Iterator[Fault]:
    """With held ports the valve moves no load."""
    if not view.has("held_ports") or view.has("motor"):  # stating both is a separate fault
        return
    where, idle = "with held ports", ("control", "stops", "friction", "initial")
    yield from without_effect(view, (), idle, where, "remove it, or remove held_ports")
    yield from without_effect(view, ("load",), entries(Load), where)
    ends = view.text("ends")
    if ends != "valve" and ends in entries(Scenario)["ends"].choices:
        remedy = 'write "valve", or remove held_ports'
        yield Fault(("ends",), f"{ends}: held_ports apply to the valve", remedy)


CHECKS: tuple[Callable[[View], Iterator[Fault]], ...] = (
    *signal_faults.CHECKS,
    *control_faults.CHECKS,
    supply,
    cushion,
    load_cylinder,
    friction,
    motor,
    held_ports,
)


def cross_field(tree: Any) -> Iterator[Fault]:
    """All contradictions between values of a scenario's tree in SI."""
    view = View(tree, Scenario)
    for check in CHECKS:
        yield from check(view)


def design_faults(scenario: Scenario, design: Design) -> Iterator[Fault]:
    """All contradictions between scenario and design, at the scenario's places."""
    yield from _parts_there_are(scenario, design)
    stroke = design.cylinder.stroke
    begin = scenario.initial.position
    place = None if begin is None else position_at(begin, stroke)
    if place is not None and place > stroke:
        message = f"{length_text(place)}: beyond cylinder.stroke ({length_text(stroke)})"
        remedy = f'write at most {length_text(stroke)}, or a share such as "50 %"'
        yield Fault(("initial", "position"), message, remedy)
    spear = scenario.stops.cushion
    if spear is not None and spear.length > stroke:
        message = f"{length_text(spear.length)}: beyond cylinder.stroke ({length_text(stroke)})"
        yield Fault(("stops", "cushion", "length"), message, f"write at most {length_text(stroke)}")


def _parts_there_are(scenario: Scenario, design: Design) -> Iterator[Fault]:
    """Components that the scenario uses exist in the design."""
    needs_valve = {
        ("signal",): bool(scenario.signal),
        ("control",): scenario.control is not None,
        ("held_ports",): scenario.held_ports is not None,
        ("motor",): scenario.motor is not None,
        ("ends",): scenario.ends == "valve",
        ("supply", "type"): scenario.supply.type != "constant",
    }
    missing = [loc for loc, needed in needs_valve.items() if needed]
    if design.valve is None and missing:
        remedy = f"add valve to the design, or remove {'.'.join(missing[0])}"
        yield Fault(missing[0], "the design has no valve", remedy, at_key=True)
    if scenario.ends == "reducing_valve" and design.ports.reducing_valve is None:
        remedy = "add ports.reducing_valve to the design, or write another end"
        yield Fault(("ends",), "reducing_valve: missing in the design", remedy)
    if scenario.load.torque and getattr(design, "linkage", None) is None:
        remedy = "add linkage to the design, or write load.force"
        yield Fault(("load", "torque"), "the design has no linkage", remedy, at_key=True)
