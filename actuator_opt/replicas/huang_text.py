"""Words and numbers that the tables and notes of [Huang2017] share."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..base.numeric import Array
from ..design.model import Design
from ..rendering import text
from .huang_published import PAPER
from .paper_text import SLASH, of_another_cylinder

AGREES, DISAGREES, IN_PART = "agrees", "disagrees", "agrees in part"
OPEN = "no film"
"""A verdict that no film lets us give."""


def mega(value: float, digits: int = 3) -> str:
    """A damping in MN s/m."""
    return text.number(float(value) / 1e6, digits)


def megas(values: Sequence[float] | Array, digits: int = 3) -> str:
    """Dampings of one row in one cell."""
    return SLASH.join(mega(float(value), digits) for value in values)


def rounded(value: float) -> str:
    """Three digits, the rest zeros.

    >>> rounded(252879.0)
    '253\u202f000'
    """
    return text.number(float(f"{value:.3g}"), 3)


def newtons(value: float) -> str:
    """A force."""
    return text.with_unit(rounded(value), "N")


def speed_text(speed: float) -> str:
    """In mm/s."""
    return f"{text.trimmed(1e3 * speed, 3)} mm/s"


def pressure_text(pressure: float) -> str:
    """In MPa."""
    return f"{text.trimmed(pressure / 1e6, 3)} MPa"


def times(ratio: float) -> str:
    """How many times one is the other."""
    return f"{text.trimmed(ratio, 3)} times"


def verdict(share: float) -> str:
    """By the share of a claim that holds; NaN says that there was no film to judge it by."""
    if not math.isfinite(share):
        return OPEN
    return AGREES if share >= 1 else DISAGREES if share <= 0 else IN_PART


def holds(fact: bool, *values: float) -> str:
    """A claim that holds or not, by numbers that all have to be known."""
    return verdict(float(fact) if all(map(math.isfinite, values)) else math.nan)


def other_cylinder(design: Design) -> str:
    """Whose cylinder was measured, if it is not this one."""
    return of_another_cylinder(design, "paper", (PAPER.bore, PAPER.rod, PAPER.stroke))
