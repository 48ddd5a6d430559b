"""What the pages of all papers share: published numbers and sentences as data, words of tables.

The data stand in ``notes/PAPER.yaml``. Every number has its place in the paper; every sentence is a
template whose fields are filled from the design.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from ..base.numeric import Array
from ..design.model import Design
from ..rendering import text

SLASH = " / "


def scaled(values: Sequence[float] | Array, scale: float, digits: int = 3) -> str:
    """Numbers of one row in one cell."""
    return SLASH.join(text.trimmed(float(v) * scale, digits) for v in values)


def percent(share: float, digits: int = 2) -> str:
    """A share in percent."""
    return text.with_unit(text.trimmed(100 * share, digits), "%")


def listed(words: Sequence[str]) -> str:
    """One, two and three."""
    *rest, last = words
    return f"{', '.join(rest)} and {last}" if rest else last


class Trace(NamedTuple):
    """Equations first to last, what they say, and the functions that compute them."""

    first: int
    last: int
    subject: str
    functions: tuple[str, ...] = ()
    remark: str = ""
    """Beside the functions, or instead of them: out of scope, and why."""


TRACE_COLUMNS = ("equation", "subject", "function", "remark")


def trace_rows(traces: Iterable[Trace]) -> tuple[tuple[str, ...], ...]:
    """A row per trace, of `TRACE_COLUMNS`."""
    return tuple(
        (
            f"{one.first}" if one.first == one.last else f"{one.first}–{one.last}",
            one.subject,
            "; ".join(one.functions) or "–",
            one.remark or "–",
        )
        for one in traces
    )


def close(a: float, b: float) -> bool:
    """Whether two sizes are the same."""
    return math.isclose(a, b, rel_tol=1e-6)


def of_another_cylinder(design: Design, source: str, theirs: tuple[float, float, float]) -> str:
    """Whose cylinder was measured (bore, rod, stroke), if it is not this one."""
    ours = design.cylinder.bore, design.rod.outer_diameter, design.cylinder.stroke
    if all(map(close, ours, theirs)):
        return ""
    names = (
        "{}/{}-{}".format(*(text.trimmed(1e3 * size) for size in sizes)) for sizes in (theirs, ours)
    )
    return "The {} has a {} cylinder, this design a {}: they need not agree. ".format(
        source, *names
    )
