"""A picture of energies: sources add up from the left, sinks lead back to zero.

It is an `Ink` drawing instead of a `Chart`, because each bar starts where the bar above it ends and
has its numbers beside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from .axes import SIZE, fitted, per_cent
from .ink import BLUE, GREY, OCHRE, Ink, text_width

ROW, TOP = 3.7, 9.0
"""Height of a row, and of the title above the rows [mm]."""
GIVEN, TAKEN, KEPT = BLUE, OCHRE, "#7d868e"
"""Fill colours of sources, of sinks, and of stored energy."""


class WaterfallBar(NamedTuple):
    """A bar: its name, its value (positive for a source) and the value in words."""

    name: str
    value: float
    words: str
    kept: bool = False
    """Whether the energy is stored."""


def waterfall(title: str, steps: Sequence[WaterfallBar], width: float, *, beside: str = "") -> Ink:
    """The bars under a title, with words right of the title; the sources are 100 %.

    The sources must come first and add up to more than zero.
    """
    ink = Ink(width, TOP + ROW * len(steps) + 1.0)
    ink.text(0.0, 4.0, title, size=6.8, bold=True)
    if beside:
        ink.text(width, 4.0, beside, anchor="right", color=GREY)
    total = sum(step.value for step in steps if step.value > 0)
    parts = [per_cent(abs(step.value) / total) for step in steps]
    names = min(max(text_width(step.name, SIZE) for step in steps), 0.42 * width)
    widest = max(text_width(step.words, SIZE) for step in steps)
    left, right = names + 1.5, width - widest - 13.5
    scale = (right - left) / total
    level = 0.0
    for k, (step, part) in enumerate(zip(steps, parts, strict=True)):
        y = TOP + ROW * (k + 0.5)
        ink.text(names, y, fitted(step.name, names, SIZE), size=SIZE, anchor="right")
        begin, level = level, level + step.value
        start, end = sorted(left + scale * min(max(v, 0.0), total) for v in (begin, level))
        colour = KEPT if step.kept else GIVEN if step.value > 0 else TAKEN
        bar = max(end - start, 0.25)
        ink.box(min(start, right - bar), y - 1.15, bar, 2.3, fill=colour, stroke=None)
        if k + 1 < len(steps):
            at = left + scale * min(max(level, 0.0), total)
            ink.line((at, y + 1.15), (at, y + ROW - 1.15), pen=0.1, stroke=GREY)
        ink.text(width - 11.5, y, step.words, size=SIZE, anchor="right")
        ink.text(width, y, part, size=SIZE, anchor="right", color=GREY)
    ink.line((left, TOP), (left, TOP + ROW * len(steps)), pen=0.13)
    return ink
