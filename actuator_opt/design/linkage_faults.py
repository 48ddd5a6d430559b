"""Contradictions of the linkage and of load cases that use it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

from ..base import quantities
from ..base.errors import Fault
from ..models import linkage as crank
from .model import PLAIN_CAP, closed_length
from .view import View, length_text
from .walls import Loc

_ROUND = math.radians(0.01)
"""Joint angles in remedies are rounded inwards to this step (rad), for short numbers."""


class _Reach(NamedTuple):
    """Pin-to-pin range of the actuator, and the linkage."""

    closed: float
    stroke: float
    base: float
    crank: float
    offset: float


def _closed(view: View) -> float | None:
    """Pin-to-pin length of the retracted actuator; None if a part is unknown."""
    stroke, piston = view.number("cylinder", "stroke"), view.number("piston", "length")
    head = view.number("head", "length") if view.has("head") else piston
    barrel = view.number("barrel", "length")
    if not view.has("barrel", "length"):
        known = stroke is not None and piston is not None and head is not None
        barrel = (stroke or 0.0) + (piston or 0.0) + (head or 0.0) if known else None
    bore = view.number("cylinder", "bore")
    plain = None if bore is None else PLAIN_CAP * bore
    plate = view.number("caps", "thickness") if view.has("caps") else plain
    extension = view.number("rod", "extension")
    pin = view.number("clevis", "pin_diameter") if view.has("clevis") else 0.0
    if barrel is None or plate is None or extension is None or pin is None:
        return None
    return float(
        closed_length(barrel_length=barrel, plate=plate, extension=extension, pin_diameter=pin)
    )


def _reach(view: View) -> _Reach | None:
    if not view.has("linkage"):
        return None
    values = (
        _closed(view),
        view.number("cylinder", "stroke"),
        view.number("linkage", "base_radius"),
        view.number("linkage", "crank_radius"),
        view.number("linkage", "angle_offset"),
    )
    numbers = [value for value in values if value is not None]
    return _Reach(*numbers) if len(numbers) == len(values) else None


def linkage(view: View) -> Iterator[Fault]:
    """No dead point between the stops: |a - r| < l < a + r."""
    found = _reach(view)
    if found is None:
        return
    closed, stroke, base, pin, _ = found
    if stroke >= 2 * pin:
        yield Fault(
            ("linkage", "crank_radius"),
            f"{length_text(pin)}: a stroke of {length_text(stroke)} moves the joint past a dead "
            "point",
            f"write more than {length_text(stroke / 2)}, or a shorter cylinder.stroke",
        )
        return
    least, most = max(closed + stroke - pin, pin - closed), closed + pin
    if not least < base < most:
        yield Fault(
            ("linkage", "base_radius"),
            f"{length_text(base)}: the actuator, {length_text(closed)} to "
            f"{length_text(closed + stroke)} from pin to pin, moves the joint past a dead point",
            f"write more than {length_text(least)} and less than {length_text(most)}",
        )


def inertia(view: View) -> Iterator[Fault]:
    """A joint speed, torque or inertia needs a linkage."""
    if view.number("load", "inertia") and not view.has("linkage"):
        yield _no_linkage(("load", "inertia"), "load.mass")


def _no_linkage(loc: Loc, instead: str) -> Fault:
    remedy = f'add a block "linkage:" with base_radius, crank_radius, or write {instead} instead'
    return Fault(loc, "no linkage stated", remedy, at_key=True)


def load_cases(view: View) -> Iterator[Fault]:
    """A case has an angle or a position, one speed, and stays within the range of the joint."""
    for index, case in enumerate(view.items("load_cases")):
        if not isinstance(case, dict):
            continue
        loc = ("load_cases", index)
        for key, instead, unset in (("angle", "position", "worst"), ("joint_speed", "speed", 0.0)):
            if key in case and not view.has("linkage"):
                yield _no_linkage((*loc, key), instead)
            elif key in case and case.get(instead, unset) != unset:
                message = f"{instead} and {key} in one load case"
                yield Fault((*loc, key), message, "keep one of them", at_key=True)
        yield from _angle(view, loc)


def _angle(view: View, loc: Loc) -> Iterator[Fault]:
    """The joint angle of a case is between those of both stops."""
    angle, found = view.number(*loc, "angle"), _reach(view)
    if angle is None or found is None:
        return
    low, high = (
        float(
            crank.linkage_angle(
                length=found.closed + travel,
                base_radius=found.base,
                crank_radius=found.crank,
                angle_offset=found.offset,
            )
        )
        for travel in (0.0, found.stroke)
    )
    if low - 1e-9 <= angle <= high + 1e-9 or math.isnan(high - low):
        return
    text = quantities.INPUTS["joint_angle"].text
    inner = [_ROUND * math.ceil(low / _ROUND), _ROUND * math.floor(high / _ROUND)]
    yield Fault(
        (*loc, "angle"),
        f"{text(angle)}: the range of the joint is {text(low)} to {text(high)}",
        f"write {text(inner[0], 7)} to {text(inner[1], 7)}, or change linkage.angle_offset",
    )


CHECKS: tuple[Callable[[View], Iterator[Fault]], ...] = (linkage, inertia, load_cases)
