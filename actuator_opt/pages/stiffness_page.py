"""The stiffness budget on paper: the U-curve, what it is made of, and what would buy most."""

from __future__ import annotations

import math

import numpy as np

from ..evaluation.result import Evaluation, StrokeCurve
from ..rendering import text
from ..rendering.axes import per_cent
from ..rendering.blocks import Block, Cell, Column, Drawing, Table
from .stiffness_figure import stiffness_figure

SHARES = ((0.0, "cap end"), (0.25, "25 %"), (0.5, "50 %"), (0.75, "75 %"), (1.0, "rod end"))
"""Places of the table, as shares of the stroke."""
_TOPOLOGY = {
    "per_chamber": (
        "Per chamber: a part's share is its part of the strain energy under a unit force, the"
        " shares add up to 1/k"
    ),
    "aalto_as_published": (
        "As published in [AaltoThesis], not per chamber: totals of oil, walls and lines in series"
    ),
    "elasswad_as_published": (
        "As published in [ElAsswad2018], not per chamber: oil and wall expansion in series"
    ),
}


def blocks(evaluation: Evaluation) -> list[Block]:
    """Figure and table; the figure alone where there is nothing to divide."""
    rows = evaluation.requirements
    required = next((r for r in rows if r.metric == "stiffness_min" and r.sense == "min"), None)
    curve = evaluation.curve
    note = f"Case {curve.case}, ports closed. {_topology(evaluation)}."
    found: list[Block] = [
        Drawing("Stiffness over the stroke", stiffness_figure(curve, required), note)
    ]
    if len(parts(curve)) > 1 and _usable(curve):
        found.append(_budget(curve))
    return found


def _topology(evaluation: Evaluation) -> str:
    said = _TOPOLOGY[evaluation.design.stiffness.topology]
    if evaluation.design.stiffness.seals == "sticking":
        said += "; seals stick"
    return said


def _usable(curve: StrokeCurve) -> bool:
    ends = float(curve.position[0]), float(curve.position[-1])
    return ends[1] > ends[0] and all(math.isfinite(float(k)) for k in curve.stiffness)


def parts(curve: StrokeCurve) -> list[str]:
    """Parts that give way at all."""
    return [name for name, c in curve.contributions.items() if any(float(x) != 0 for x in c)]


def shares(curve: StrokeCurve, position: float) -> dict[str, float]:
    """Share of each part in the compliance at a position; they add up to one."""
    at = {
        name: float(np.interp(position, curve.position, curve.contributions[name]))
        for name in parts(curve)
    }
    total = sum(at.values())
    return {name: value / total for name, value in at.items()}


def weakest(curve: StrokeCurve) -> int:
    """Index of the least stiffness along the curve."""
    return int(np.argmin(curve.stiffness))


def sentence(curve: StrokeCurve) -> str:
    """Which part would buy most, and how much."""
    index = weakest(curve)
    found = shares(curve, float(curve.position[index]))
    name, share = max(found.items(), key=lambda one: one[1])
    oil = sum(value for part, value in found.items() if part.startswith("oil"))
    both = ""
    if name.startswith("oil") and oil > share:
        both = f" (all oil {per_cent(oil)})"
    gain = 1 / (1 - share / 2) - 1
    place = text.trimmed(1e3 * float(curve.position[index]), 3)
    return (
        f"At the weakest position, {place} mm, {name} would buy most: it is"
        f" {per_cent(share)} of the compliance{both}; halving that would make the actuator"
        f" {per_cent(gain)} stiffer there."
    )


def summary(curve: StrokeCurve) -> str:
    """The shares at the weakest position in one line, largest first."""
    if not _usable(curve) or not parts(curve):
        return ""
    found = shares(curve, float(curve.position[weakest(curve)]))
    ordered = sorted(found.items(), key=lambda one: -one[1])
    said = (f"{name.replace('_', ' ')} {per_cent(share)}" for name, share in ordered)
    return ", ".join(said).replace(" %", f"{text.NARROW}%")


def _budget(curve: StrokeCurve) -> Block:
    index = weakest(curve)
    start, stroke = float(curve.position[0]), float(curve.position[-1] - curve.position[0])
    places = [start + share * stroke for share, _ in SHARES] + [float(curve.position[index])]
    columns_at = [shares(curve, place) for place in places]
    rows: list[list[Cell]] = []
    for name in parts(curve):
        alone = float(curve.contributions[name][index])
        rows.append(
            [
                name.replace("_", " "),
                *(text.share_text(found[name]) for found in columns_at),
                text.number(1e-6 / alone if alone > 0 else math.inf),
            ]
        )
    compliances = 1 / np.asarray(curve.stiffness)
    totals = [1e-6 / float(np.interp(place, curve.position, compliances)) for place in places]
    total = ["stiffness, kN/mm", *(text.number(k) for k in totals), text.number(totals[-1])]
    rows.append(list(total))
    columns = [
        Column("part", "left", 1.3),
        *(Column(name, "right", 0.8) for _, name in SHARES),
        Column(f"weakest, {text.trimmed(1e3 * places[-1], 3)} mm", "right", 1.2, strong=True),
        Column("alone there, kN/mm", "right", 1.2),
    ]
    return Table("Stiffness budget", columns, rows, note=sentence(curve), total=1)
