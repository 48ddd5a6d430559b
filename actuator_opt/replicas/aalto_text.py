"""Words and numbers that the notes and tables of [AaltoThesis] share."""

from __future__ import annotations

import math

from ..design.model import Design
from ..rendering import text
from .aalto import PAPER
from .aalto_static import CONTENTS
from .paper_text import of_another_cylinder, percent


def area_text(area: float) -> str:
    """Area of a needle."""
    return f"{text.trimmed(1e4 * area, 2)} cm²"


def air_text(content: float) -> str:
    """Air content, or the end of those searched that it lies beyond."""
    if content == 0:
        return f"less than {percent(CONTENTS[0])}"
    return percent(content) if math.isfinite(content) else f"more than {percent(CONTENTS[1])}"


def other_cylinder(design: Design) -> str:
    """Whose cylinder was measured, if it is not this one."""
    return of_another_cylinder(design, "thesis", (PAPER.bore, PAPER.rod, PAPER.stroke))
