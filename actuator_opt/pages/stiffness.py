"""The stiffness over the stroke: the curve, the share of each part, the most effective change."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..evaluation.result import Evaluation, Requirement, StrokeCurve
from ..rendering import text
from ..rendering.axes import per_cent
from ..rendering.blocks import Block, Cell, Chart, Column, Notes, Table, TerminalFigure
from ..rendering.chart import Area, Axis, Curve, Level, Panel
from ..rendering.text import trimmed
from .dynamics_figures import ALONG, limit_level, minimum

SHARES = ((0.0, "cap end"), (0.25, "25 %"), (0.5, "50 %"), (0.75, "75 %"), (1.0, "rod end"))
"""Positions in the table, as shares of the stroke."""
_TOPOLOGY = {
    "per_chamber": (
        "Computed per chamber: the compliance of a part is twice its strain energy under a unit "
        "force; the parts add up to the compliance 1/k"
    ),
    "aalto_as_published": (
        "As published in [AaltoThesis], not per chamber: total compliances of oil, walls and "
        "lines are in series"
    ),
    "elasswad_as_published": (
        "As published in [ElAsswad2018], not per chamber: compliances of oil and wall expansion "
        "are in series"
    ),
}


def stiffness_blocks(evaluation: Evaluation, *, curve_shown: bool = True) -> list[Block]:
    """Figure and table of the stiffness; without the table if fewer than two parts are compliant.

    `curve_shown`: the terminal also shows a small curve.
    """
    rows = evaluation.requirements
    required = next((r for r in rows if r.metric == "stiffness_min" and r.sense == "min"), None)
    curve, title = evaluation.curve, "Stiffness over the stroke"
    note = f'Load case "{curve.case}", ports closed. {_topology(evaluation)}.'
    panels = stiffness_panels(curve, required)
    if not panels:
        words = "No stiffness curve: the stroke was not evaluated."
        return [Notes(title, [words], note=note, on="paper")]
    small = _terminal_curve(curve, required) if curve_shown and _usable(curve) else None
    blocks: list[Block] = [Chart(title, panels, note, instead=small, height=62.0)]
    if len(parts(curve)) > 1 and _usable(curve):
        blocks.append(_budget(curve))
    return blocks


def _terminal_curve(curve: StrokeCurve, required: Requirement | None) -> TerminalFigure:
    """A small curve with the required stiffness, its minimum, and each part's share there."""
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
    title = f'Stiffness over the stroke, kN/mm (load case "{curve.case}")'
    return TerminalFigure(title, points, limit, note=note)


def _topology(evaluation: Evaluation) -> str:
    words = _TOPOLOGY[evaluation.design.stiffness.topology]
    return f"{words}; seals stick" if evaluation.design.stiffness.seals == "sticking" else words


def _usable(curve: StrokeCurve) -> bool:
    ends = float(curve.position[0]), float(curve.position[-1])
    return ends[1] > ends[0] and all(math.isfinite(float(k)) for k in curve.stiffness)


def parts(curve: StrokeCurve) -> list[str]:
    """Parts with a compliance above zero."""
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
    """Index of the least stiffness on the curve."""
    return int(np.argmin(curve.stiffness))


def gain_sentence(curve: StrokeCurve) -> str:
    """Sentence on the part whose change would raise the stiffness most, and by how much."""
    index = weakest(curve)
    compliances = shares(curve, float(curve.position[index]))
    name, share = max(compliances.items(), key=lambda part: part[1])
    oil = sum(value for part, value in compliances.items() if part.startswith("oil"))
    both = ""
    if name.startswith("oil") and oil > share:
        both = f" (all oil together: {per_cent(oil)})"
    gain = 1 / (1 - share / 2) - 1
    place = text.trimmed(1e3 * float(curve.position[index]), 3)
    return (
        f"At the weakest position, {place} mm, {name} matters most: it causes {per_cent(share)} "
        f"of the compliance{both}. With half of its compliance, the actuator would be "
        f"{per_cent(gain)} stiffer there."
    )


def summary(curve: StrokeCurve) -> str:
    """The shares at the weakest position in one line, largest first."""
    if not _usable(curve) or not parts(curve):
        return ""
    compliances = shares(curve, float(curve.position[weakest(curve)]))
    ordered = sorted(compliances.items(), key=lambda part: -part[1])
    words = (f"{name.replace('_', ' ')} {per_cent(share)}" for name, share in ordered)
    return ", ".join(words).replace(" %", f"{text.NARROW}%")


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
                *(text.share_text(compliances[name]) for compliances in columns_at),
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
        Column("part's own stiffness, kN/mm", "right", 1.2),
    ]
    return Table("Stiffness budget", columns, rows, note=gain_sentence(curve), total=1, on="paper")


PARTS = (
    "oil A", "oil B", "oil in lines", "barrel", "stretch", "pipes", "hoses", "seals", "rod",
    "mount", "load cell",
)  # fmt: skip
"""Parts that contribute to the compliance; each has the same fill in every report."""


def stiffness_panels(curve: StrokeCurve, requirement: Requirement | None) -> list[Panel]:
    """Panels over the stroke: stiffness, and compliances of the parts; empty without a curve."""
    positions = [1000.0 * float(x) for x in curve.position]
    stiffness = [float(k) / 1e6 for k in curve.stiffness]
    usable = [(x, k) for x, k in zip(positions, stiffness, strict=True) if math.isfinite(k)]
    if len(usable) < 2 or not usable[-1][0] > usable[0][0]:
        return []
    panels = [_stiffness_panel(usable, requirement)]
    if any(float(c) > 0 for column in curve.contributions.values() for c in column):
        panels.append(_compliance_panel(curve, positions))
    return panels


def _stiffness_panel(
    points: Sequence[tuple[float, float]], requirement: Requirement | None
) -> Panel:
    xs, ys = [x for x, _ in points], [k for _, k in points]
    place, weakest = min(points, key=lambda point: point[1])
    limit = None if requirement is None else requirement.limit / 1e6
    floor = max(weakest, limit or 0.0)
    top = min(max(*ys, 1.15 * floor), 3.0 * floor) * 1.06
    return Panel(
        "Axial stiffness, kN/mm",
        Axis(ALONG, range=(xs[0], xs[-1])),
        Axis(range=(0.0, top)),
        curves=[Curve("", xs, ys)],
        points=[minimum(place, weakest)],
        levels=[] if requirement is None else [limit_level(requirement, requirement.limit / 1e6)],
    )


def fills(parts: Sequence[str]) -> list[int]:
    """The fill of each part by number; unknown parts get an unused fill."""
    free = [k for k, name in enumerate(PARTS) if name not in parts]
    return [PARTS.index(name) if name in PARTS else free.pop(0) if free else 0 for name in parts]


def _compliance_panel(curve: StrokeCurve, positions: Sequence[float]) -> Panel:
    """Stacked compliances of all parts; a vertical line marks the least stiffness."""
    parts = {
        name.replace("_", " "): 1e9 * np.asarray(values, dtype=float)
        for name, values in curve.contributions.items()
        if any(float(c) > 0 for c in values)
    }
    totals = np.sum([*parts.values()], axis=0)
    weakest = int(np.argmax(totals))
    below = np.zeros(len(positions))
    areas = []
    for fill, (name, values) in zip(fills(list(parts)), parts.items(), strict=True):
        words = f"{name} {per_cent(float(values[weakest] / totals[weakest]))}"
        areas.append(Area(words, positions, below, below + values, fill))
        below = below + values
    return Panel(
        "Compliance, µm/kN; shares at the minimum",
        Axis(ALONG),
        Axis(range=(0.0, 1.06 * float(totals[weakest]))),
        curves=[Curve("", positions, totals, style=4, dash=0)],
        levels=[Level(positions[weakest], "", style=4, upright=True)],
        areas=areas,
    )
