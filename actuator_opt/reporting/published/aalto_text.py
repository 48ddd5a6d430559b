"""Words and numbers that the notes and tables of [AaltoThesis] share."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ...design.model import Design
from ...evaluation.study.aalto import PAPER
from ...evaluation.study.aalto_static import CONTENTS
from ...numeric import Array
from .. import text

SLASH = " / "


def scaled(values: Sequence[float] | Array, scale: float, digits: int = 3) -> str:
    """Numbers of one row in one cell."""
    return SLASH.join(text.trimmed(float(v) * scale, digits) for v in values)


def percent(share: float, digits: int = 2) -> str:
    """A share in percent."""
    return text.with_unit(text.trimmed(100 * share, digits), "%")


def area_text(area: float) -> str:
    """Area of a needle."""
    return f"{text.trimmed(1e4 * area, 2)} cm²"


def air_text(content: float) -> str:
    """Air content, or the end of those searched that it lies beyond."""
    if content == 0:
        return f"less than {percent(CONTENTS[0])}"
    return percent(content) if math.isfinite(content) else f"more than {percent(CONTENTS[1])}"


def listed(words: Sequence[str]) -> str:
    """One, two and three."""
    *rest, last = words
    return f"{', '.join(rest)} and {last}" if rest else last


def close(a: float, b: float) -> bool:
    """Whether two sizes are the same."""
    return math.isclose(a, b, rel_tol=1e-6)


def other_cylinder(design: Design) -> str:
    """Whose cylinder was measured, if it is not this one."""
    ours = design.cylinder.bore, design.rod.outer_diameter, design.cylinder.stroke
    theirs = PAPER.bore, PAPER.rod, PAPER.stroke
    if all(map(close, ours, theirs)):
        return ""
    names = (
        "{}/{}-{}".format(*(text.trimmed(1e3 * size) for size in sizes)) for sizes in (theirs, ours)
    )
    return "The thesis has a {} cylinder, this design a {}: they need not agree. ".format(*names)
