"""The stiffness over the stroke: the curve, its parts, and which part would buy most."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..evaluation.result import Evaluation, Requirement, StrokeCurve
from ..rendering import text
from ..rendering.axes import AREAS, Axes, lowest, per_cent, required
from ..rendering.blocks import Block, Cell, Column, Drawing, Table, TerminalFigure
from ..rendering.ink import BLACK, BLUE, GREY, Ink, spread_within
from ..rendering.text import trimmed

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


def stiffness_blocks(evaluation: Evaluation, *, curve_shown: bool = True) -> list[Block]:
    """Figure and table; the figure alone where there is nothing to divide.

    `curve_shown`: the terminal shows a small curve.
    """
    rows = evaluation.requirements
    required = next((r for r in rows if r.metric == "stiffness_min" and r.sense == "min"), None)
    curve = evaluation.curve
    note = f"Case {curve.case}, ports closed. {_topology(evaluation)}."
    ink, small = stiffness_figure(curve, required), None
    if curve_shown and _usable(curve):
        small = _terminal_curve(curve, required)
    blocks: list[Block] = [Drawing("Stiffness over the stroke", ink, note, instead=small)]
    if len(parts(curve)) > 1 and _usable(curve):
        blocks.append(_budget(curve))
    return blocks


def _terminal_curve(curve: StrokeCurve, required: Requirement | None) -> TerminalFigure:
    """A small curve with the required value, the minimum, and the shares there."""
    points = [
        (1000.0 * float(x), float(k) / 1e6)
        for x, k in zip(curve.position, curve.stiffness, strict=True)
    ]
    limit = None if required is None else required.limit / 1e6
    place, least = min(points, key=lambda point: point[1])
    note = f"minimum {text.number(least)} at {trimmed(place, 3)} mm"
    if limit is not None:
        note += f", required {trimmed(limit)}"
    if shares := summary(curve):
        note += f"; compliance there: {shares}"
    title = f"Stiffness over the stroke, kN/mm (case {curve.case})"
    return TerminalFigure(title, points, limit, note=note)


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


def gain_sentence(curve: StrokeCurve) -> str:
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
    return Table("Stiffness budget", columns, rows, note=gain_sentence(curve), total=1, on="paper")


PARTS = (
    "oil A", "oil B", "oil in lines", "barrel", "stretch", "pipes", "hoses", "seals", "rod",
    "mount", "load cell",
)  # fmt: skip
"""Parts of the stiffness budget, each with its own fill in every report."""


def stiffness_figure(
    curve: StrokeCurve,
    requirement: Requirement | None,
    *,
    width: float = 180.0,
    height: float = 62.0,
) -> Ink:
    """Stiffness over the stroke (left) and the compliances it is made of, stacked (right)."""
    ink = Ink(width, height)
    positions = [1000.0 * float(x) for x in curve.position]
    stiffness = [float(k) / 1e6 for k in curve.stiffness]
    usable = [(x, k) for x, k in zip(positions, stiffness, strict=True) if math.isfinite(k)]
    if len(usable) < 2 or not usable[-1][0] > usable[0][0]:
        ink = Ink(width, 6.0)
        ink.text(0.0, 3.0, "No stiffness curve: the stroke was not evaluated.")
        return ink
    panel = (width - 56.0) / 2
    _stiffness_panel(ink, (9.0, 8.0, panel, height - 18.0), usable, requirement)
    _compliance_panel(ink, (panel + 26.0, 8.0, panel, height - 18.0), curve, positions)
    return ink


def _stiffness_panel(
    ink: Ink,
    box: tuple[float, float, float, float],
    points: Sequence[tuple[float, float]],
    requirement: Requirement | None,
) -> None:
    xs, ys = [x for x, _ in points], [k for _, k in points]
    place, weakest = min(points, key=lambda point: point[1])
    limit = None if requirement is None else requirement.limit / 1e6
    floor = max(weakest, limit or 0.0)
    top = min(max(*ys, 1.15 * floor), 3.0 * floor) * 1.06
    axes = Axes(ink, box, (xs[0], xs[-1]), (0.0, top))
    axes.frame("Axial stiffness, kN/mm", "piston position from the cap end, mm")
    ink.path(axes.clipped(xs, ys), stroke=BLUE, pen=0.45)
    lowest(axes, place, weakest, [] if limit is None else [limit])
    if limit is not None:
        required(axes, limit, f"≥ {trimmed(limit)}")


def fills(parts: Sequence[str]) -> list[str]:
    """The fill of each part: its own, or one that no other part has."""
    free = [k for k, name in enumerate(PARTS) if name not in parts]
    own = [PARTS.index(name) if name in PARTS else free.pop(0) if free else 0 for name in parts]
    return [AREAS[k] for k in own]


def _compliance_panel(
    ink: Ink,
    box: tuple[float, float, float, float],
    curve: StrokeCurve,
    positions: Sequence[float],
) -> None:
    parts = {
        name.replace("_", " "): [float(c) * 1e9 for c in values]
        for name, values in curve.contributions.items()
        if any(float(c) > 0 for c in values)
    }
    if not parts:
        return
    totals = [sum(column) for column in zip(*parts.values(), strict=True)]
    axes = Axes(ink, box, (positions[0], positions[-1]), (0.0, max(totals) * 1.06))
    axes.frame("Compliance, µm/kN, stacked", "piston position from the cap end, mm")
    below = [0.0] * len(positions)
    weakest = max(range(len(totals)), key=totals.__getitem__)
    middles, labels, paints = [], [], fills(list(parts))
    for paint, (name, values) in zip(paints, parts.items(), strict=True):
        above = [low + value for low, value in zip(below, values, strict=True)]
        edge = [(axes.x(x), axes.y(y)) for x, y in zip(positions, above, strict=True)]
        back = [(axes.x(x), axes.y(y)) for x, y in zip(positions, below, strict=True)]
        ink.path([[*edge, *back[::-1]]], fill=paint, stroke=None, closed=True)
        ink.path([edge], stroke="#ffffff", pen=0.12)
        middles.append((edge[-1][1] + back[-1][1]) / 2)
        labels.append(f"{name} {per_cent(values[weakest] / totals[weakest])}")
        below = above
    ink.path([edge], stroke=BLACK, pen=0.3)
    x = axes.x(positions[weakest])
    ink.line((x, box[1]), (x, box[1] + box[3]), stroke=BLACK, pen=0.13, dash=(0.5, 0.7))
    right = box[0] + box[2]
    order = list(range(len(middles)))[::-1]
    places = spread_within(
        [middles[k] for k in order], [3.6] * len(order), box[1] - 0.4, box[1] + box[3] + 2.0
    )
    for k, y in zip(order, places, strict=True):
        ink.line((right, middles[k]), (right + 3.0, y), pen=0.13, stroke=GREY)
        ink.box(right + 3.2, y - 1.1, 2.2, 2.2, fill=paints[k], pen=0.1)
        ink.text(right + 6.2, y, labels[k], size=6.5)
    ink.text(right + 3.2, box[1] - 3.6, "share at minimum", size=6.0, color=GREY)
