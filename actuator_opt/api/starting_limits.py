"""Which answer a start design cannot have, and how far that answer may go."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import sqrt
from typing import TypeAlias

from ..base.errors import Diagnostic
from ..base.quantities import Quantity
from ..optimisation.cures import outward

FaultOf: TypeAlias = Callable[[Mapping[str, float]], str]
"""The fault of the first sizes, in words, after some answers changed; empty without a fault."""

DIGITS = 2
"""Significant digits of a limit in a message: our choice."""

HALVINGS = 20
"""Halvings of the range between an unsuitable number and a usual one: our choice."""


def unsuitable(
    stated: Mapping[str, float],
    usual: Mapping[str, tuple[Quantity, float]],
    fault_of: FaultOf,
    prefix: str,
) -> Diagnostic:
    """The answers that leave no file, each with its limit.

    An answer has a limit if the usual number in its place leaves no fault. Halving the range
    between both numbers gives the limit.

    Parameters
    ----------
    stated : the answers, SI; not all of them leave a file
    usual : by answer, its quantity and a usual number, SI
    fault_of : the fault of the first sizes, in words, after some answers changed
    prefix : stands before the name of an answer, such as "--"
    """
    fault = fault_of({})
    limits = {
        name: limit for name in stated if (limit := _limit(name, stated[name], usual, fault_of))
    }
    if not limits:
        unusual = _together(stated, usual, fault_of)
        names = ", ".join(f"{prefix}{name}" for name in unusual)
        nearer = ", ".join(usual[name][0].text(usual[name][1]) for name in unusual)
        return Diagnostic(f"{names}: no start design: {fault}", f"write nearer to {nearer}")
    first, *others = limits
    remedy = f"write {limits[first]}"
    if others:
        remedy += f", or {', '.join(f'{limits[name]} for {prefix}{name}' for name in others)}"
    value = usual[first][0].text(stated[first])
    return Diagnostic(f"{prefix}{first}: {value} gives no start design: {fault}", remedy)


def _together(
    stated: Mapping[str, float], usual: Mapping[str, tuple[Quantity, float]], fault_of: FaultOf
) -> list[str]:
    """Answers that leave no fault only if all of them become usual."""
    changed = {name: usual[name][1] for name, value in stated.items() if value != usual[name][1]}
    for name in list(changed):
        others = {other: number for other, number in changed.items() if other != name}
        if not fault_of(others):
            changed = others
    return list(changed)


def _limit(
    name: str, stated: float, usual: Mapping[str, tuple[Quantity, float]], fault_of: FaultOf
) -> str:
    """The number without a fault that is nearest to a stated answer, as text; empty without one."""
    quantity, good = usual[name]
    if stated == good or fault_of({name: good}):
        return ""
    bad, upwards = stated, stated < good
    for _ in range(HALVINGS):
        middle = sqrt(bad * good) or good / 2
        if fault_of({name: middle}):
            bad = middle
        else:
            good = middle
    shown = outward(quantity.to_display(good), DIGITS, upwards)
    return f"at {'least' if upwards else 'most'} {shown:g} {quantity.unit}"
