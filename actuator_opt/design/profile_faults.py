"""Faults of stated contact profiles: order, lengths, range, and sealing of the pressure."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from ..base.errors import Fault
from ..base.quantities import INPUTS
from .structure import Loc
from .view import View


def elements(view: View) -> Iterator[Loc]:
    """Place of every sealing element the file states."""
    for name in ("piston", "rod"):
        yield ("seals", name)
        if view.has("seals", name, "secondary"):
            yield ("seals", name, "secondary")


def profiles(view: View) -> Iterator[Fault]:
    """Stated contact pressures: positions increase from 0, one stress each, sorted by pressure."""
    for loc in elements(view):
        last = -1.0
        for index, _ in enumerate(view.items(*loc, "contact")):
            at = (*loc, "contact", index)
            positions = view.items(*at, "positions")
            stresses = view.items(*at, "stresses")
            pressure = view.number(*at, "pressure")
            if pressure is not None and pressure <= last:
                yield Fault(
                    (*at, "pressure"),
                    f"{INPUTS['pressure'].text(pressure)}: not above the previous profile",
                    "sort the profiles by pressure, each once",
                )
            last = last if pressure is None else pressure
            known = [x for x in stresses if isinstance(x, float)]
            complete = known and len(known) == len(stresses)
            if complete and pressure is not None and max(known) <= pressure:
                yield Fault(
                    (*at, "stresses"),
                    f"nowhere above the sealed pressure ({INPUTS['pressure'].text(pressure)}): "
                    "this contact does not seal",
                    "state contact pressures that include the sealed pressure",
                )
            if len(positions) != len(stresses):
                yield Fault(
                    (*at, "stresses"),
                    f"{len(stresses)} stresses at {len(positions)} positions",
                    "write one stress for every position",
                )
            numbers = [x for x in positions if isinstance(x, float)]
            pairs = pairwise(numbers)
            if numbers and (numbers[0] != 0 or any(b <= a for a, b in pairs)):
                yield Fault(
                    (*at, "positions"),
                    "not from 0 upwards",
                    "begin with 0 mm at the sealed side, then increase",
                )


def reach(view: View) -> Iterator[Fault]:
    """Stated profiles extend from zero pressure to the supply pressure."""
    supply, text = view.number("supply", "pressure"), INPUTS["pressure"].text
    for loc in elements(view):
        count = len(view.items(*loc, "contact"))
        first = view.number(*loc, "contact", 0, "pressure")
        last = view.number(*loc, "contact", count - 1, "pressure")
        if first is not None and first > 0:
            yield Fault(
                (*loc, "contact", 0, "pressure"),
                f"{text(first)}: the profile without pressure is missing",
                "add a profile at 0 bar before it",
            )
        if last is not None and supply is not None and last < supply * (1 - 1e-9):
            yield Fault(
                (*loc, "contact", count - 1, "pressure"),
                f"{text(last)}: the profiles end below supply.pressure ({text(supply)})",
                "add a profile at the supply pressure",
            )


CHECKS = (profiles, reach)
