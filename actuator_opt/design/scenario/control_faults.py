"""Faults of the valve drive, and of results that a scenario requires from the response."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from ...base.errors import Fault
from ..build import how_to_add
from ..structure import child_at, entries
from ..view import View, without_effect
from .components import LAWS, SUPPLIES, ControlLaw
from .model import Control, Scenario
from .shapes import SHAPES

REFERENCES: Mapping[str, str] = {
    "position": "position_gain",
    "speed": "speed_gain",
    "shaft_speed": "shaft_speed_gain",
    "shaft_angle": "shaft_angle_gain",
}
"""Every loop by its reference, with its gain."""
STEP_RESULTS = ("rise_time", "settling_time", "overshoot", "steady_state_ratio")
"""Results derived from the response to a single step."""


def stated(view: View, *loc: str) -> bool:
    """Whether the file states this value; empty lists do not count."""
    return child_at(view.tree, loc) not in (None, [], ())


def given(view: View) -> list[str]:
    """References that the control states."""
    return [name for name in REFERENCES if stated(view, "control", name)]


def drives(view: View) -> Iterator[Fault]:
    """Either signal or control drives the valve, which must end the lines."""
    driven = [name for name in ("signal", "control") if stated(view, name)]
    if len(driven) == 2:
        message = "a signal beside control: both would drive the valve"
        yield Fault(("signal",), message, "keep one of them", at_key=True)
    ends = view.text("ends")
    if ends == "valve" or ends not in entries(Scenario)["ends"].choices:
        return
    if driven:
        message = f"{ends}: the {driven[0]} would drive a valve that is not connected"
        yield Fault(("ends",), message, f'write "valve", or remove {driven[0]}')
    supply = SUPPLIES.get(view.text("supply", "type") or "")
    if supply is not None and supply.pumps:
        message = f"{ends}: the pump of the supply is not connected"
        yield Fault(("ends",), message, 'write "valve", or remove supply')


def reference(view: View) -> Iterator[Fault]:
    """Exactly one reference, of an existing motion."""
    if not isinstance(child_at(view.tree, ("control",)), dict):
        return
    found = given(view)
    if not found:
        remedy = f'add a list "position:" (or {", ".join(list(REFERENCES)[1:])})'
        yield Fault(("control", "position"), "missing: no reference", remedy)
    for name in found[1:]:
        message = f"a second reference, beside {found[0]}"
        yield Fault(("control", name), message, "keep one of them", at_key=True)
    if not found or found[0].startswith("shaft") == view.has("motor"):
        return
    if view.has("motor"):
        message = "a motor has no rod to move"
        remedy = "write shaft_speed or shaft_angle, or remove motor"
    else:
        message, remedy = "there is no shaft", "add motor, or write position or speed"
    yield Fault(("control", found[0]), message, remedy, at_key=True)


def tuning(view: View) -> Iterator[Fault]:
    """The gain and times that the tuning needs are stated, and no others."""
    found, law, way = given(view), view.text("control", "law"), view.text("control", "tuning")
    if not isinstance(child_at(view.tree, ("control",)), dict):
        return
    known = entries(Control)
    own = LAWS.get(law or "")
    if own is None or way not in known["tuning"].choices:
        return
    loop = found[0] if found else None
    for name, gain in REFERENCES.items():
        if not view.has("control", gain):
            continue
        if loop is not None and name != loop:
            message = f"gain of a {name} loop, but the reference is a {loop}"
            yield Fault(("control", gain), message, f"write {REFERENCES[loop]}", at_key=True)
        elif way != "stated":
            message = f"stated, but determined by tuning ({way})"
            remedy = 'remove it, or write "tuning: stated"'
            yield Fault(("control", gain), message, remedy, at_key=True)
    times = [f"{part}_time" for part in own.parts]
    needed = ([] if loop is None else [REFERENCES[loop]]) + times
    for key in needed if way == "stated" else ():
        if not view.has("control", key):
            what = "stated tuning" if key not in times else f"a stated {law} law"
            how = how_to_add(key, known[key])
            yield Fault(("control", key), f"missing: required by {what}", how)
    yield from _unread(view, own, way)


def _unread(view: View, law: ControlLaw, way: str) -> Iterator[Fault]:
    """Keys without effect under this control law and tuning."""
    for part in ("integral", "derivative"):
        if part not in law.parts:
            keys = [f"{part}_time", f"{part}_factor"]
            yield from without_effect(view, ("control",), keys, f"on a {law.name} law")
    if not law.derivative:
        yield from without_effect(view, ("control",), ["filter_time"], f"on a {law.name} law")
    if way != "margins":
        yield from without_effect(view, ("control",), ["margin"], f"where tuning is {way}")
    if not view.number("control", "pressure_feedback"):
        keys = ["pressure_time"] if not view.has("control", "pressure_feedback") else []
        yield from without_effect(view, ("control",), keys, "without pressure_feedback")


def step_results(view: View) -> Iterator[Fault]:
    """Results of a step response need a stepping reference."""
    asked = [name for name in STEP_RESULTS if view.has("requirements", name)]
    found = given(view)
    if not asked or len(found) > 1:
        return
    shapes = []
    for name in found:
        for index in range(len(view.items("control", name))):
            shapes.append(view.text("control", name, index, "shape"))
    known = [SHAPES[shape] for shape in shapes if shape is not None and shape in SHAPES]
    if len(known) < len(shapes) or (found and not shapes):
        return
    if "step" in shapes and all(shape.settles for shape in known):
        return
    where = f"control.{found[0]}" if found else "control with a reference"
    for name in asked:
        message = "no reference that steps"
        remedy = f'give {where} a part of "shape: step" and no sine or record, or remove this'
        yield Fault(("requirements", name), message, remedy, at_key=True)


CHECKS: tuple[Callable[[View], Iterator[Fault]], ...] = (drives, reference, tuning, step_results)
