"""Contradictions between values of lines, valve, ports and position loop."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import get_args

from ..base import quantities
from ..base.errors import Fault
from . import choices
from .view import View, length_text


def lines(view: View) -> Iterator[Fault]:
    """Every line has a wall; a line beyond the throttle requires a throttle."""
    for index in range(len(view.items("lines"))):
        inner = view.number("lines", index, "inner_diameter")
        outer = view.number("lines", index, "outer_diameter")
        if inner is not None and outer is not None and outer <= inner:
            yield Fault(
                ("lines", index, "outer_diameter"),
                f"{length_text(outer)}: not larger than inner_diameter ({length_text(inner)})",
                f"write more than {length_text(inner)}",
            )
        if view.flag("lines", index, "beyond_throttle") and not view.has("ports", "throttle"):
            yield Fault(
                ("lines", index, "beyond_throttle"),
                "no throttle stated",
                "add ports.throttle, or remove beyond_throttle",
            )


ENDS = get_args(get_args(choices.End)[0])


def ports(view: View) -> Iterator[Fault]:
    """The selected end of the lines is described."""
    end = view.text("ports", "end")
    if end not in ENDS:  # a separate fault, reported at its place
        return
    needed = {"valve": ("valve",), "reducing_valve": ("ports", "reducing_valve")}.get(end or "")
    if needed is not None and not view.has(*needed):
        yield Fault(
            ("ports", "end"),
            f"{end}: not described",
            f"add {'.'.join(needed)}, or write closed or constant_pressure",
        )
    if end != "reducing_valve" and view.has("ports", "reducing_valve"):
        yield Fault(
            ("ports", "reducing_valve"),
            "is not the selected end of the lines",
            'write "end: reducing_valve", or remove it',
            at_key=True,
        )
    if end == "constant_pressure" and view.items("ports", "accumulators"):
        yield Fault(
            ("ports", "accumulators"),
            "has no effect at constant line pressure",
            "remove it, or write another end",
            at_key=True,
        )


def valve(view: View) -> Iterator[Fault]:
    """The centred valve leaks less than the open valve passes, at the same pressure drop."""
    numbers = [
        view.number("valve", name)
        for name in ("rated_flow", "rated_drop", "leakage_flow", "leakage_drop")
    ]
    if any(number is None for number in numbers):
        return
    rated, rated_drop, leakage, leakage_drop = (number or 0.0 for number in numbers)
    most = rated * (leakage_drop / rated_drop) ** 0.5
    if leakage >= most:
        text = quantities.INPUTS["leakage_flow"].text
        yield Fault(
            ("valve", "leakage_flow"),
            f"{text(leakage)}: the leakage reaches the flow of the open valve",
            f"write less than {text(most)}",
        )


def stiffness(view: View) -> Iterator[Fault]:
    """The published topologies do not include sticking seals."""
    published = view.text("stiffness", "topology") != "per_chamber"
    if published and view.text("stiffness", "seals") == "sticking":
        yield Fault(
            ("stiffness", "seals"),
            "sticking: the published topologies do not include seals",
            'write "topology: per_chamber", or "seals: sliding"',
        )


def control(view: View) -> Iterator[Fault]:
    """A position loop needs a valve."""
    if view.has("control") and not view.has("valve"):
        yield Fault(
            ("control",), "no valve to control", "add valve, or remove control", at_key=True
        )


def held_pressures(view: View) -> Iterator[Fault]:
    """Held pressures are given for both chambers or for neither."""
    for index in range(len(view.items("load_cases"))):
        loc = ("load_cases", index)
        a, b = view.has(*loc, "pressure_a"), view.has(*loc, "pressure_b")
        if a != b:
            missing, other = ("pressure_b", "pressure_a") if a else ("pressure_a", "pressure_b")
            yield Fault(
                (*loc, missing), f"missing: required with {other}", f'add e.g. "{missing}: 20 bar"'
            )
        for name in ("pressure_a", "pressure_b"):
            pressure, supply = view.number(*loc, name), view.number("supply", "pressure")
            ratio = view.number("supply", "proof_ratio")
            if pressure is None or supply is None or ratio is None:
                continue
            if pressure > supply * ratio * (1 + 1e-9):
                text = quantities.INPUTS["pressure"].text
                yield Fault(
                    (*loc, name),
                    f"{text(pressure)}: above proof pressure ({text(supply * ratio)})",
                    f"write at most {text(supply * ratio)}, or raise supply.pressure",
                )


CHECKS: tuple[Callable[[View], Iterator[Fault]], ...] = (
    lines,
    ports,
    valve,
    stiffness,
    control,
    held_pressures,
)
