"""TODO."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..evaluation.result import Requirement, StrokeCurve
from ..rendering.axes import AREAS, Axes, lowest, per_cent, required
from ..rendering.ink import BLACK, BLUE, GREY, Ink, hatch, spread_within
from ..rendering.text import trimmed

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


def wall_figure(layers: Sequence[tuple[str, float, str]], *, width: float = 180.0) -> Ink:
    """The barrel wall enlarged to an ISO scale, layer by layer from the bore (below) outwards.

    `layers` holds (text, thickness in m, kind).
    """
    total = 1000.0 * sum(thickness for _, thickness, _ in layers)
    paper, real = next(
        ((p, 1) for p in (100, 50, 20, 10, 5, 2, 1) if total * p <= 26.0),
        next(((1, r) for r in (2, 5, 10, 20, 50) if total / r <= 26.0), (1, 100)),
    )
    factor = 1000.0 * paper / real
    count = len(layers)
    wall = total * paper / real
    height = max(wall, 3.4 * count) + 9.0
    ink = Ink(width, height)
    bottom = height - 4.0 - max(0.0, (3.4 * count - wall) / 2)
    middles = []
    base = bottom
    for _, thickness, kind in layers:
        deep = thickness * factor
        box = ((3.0, base - deep), (63.0, base - deep), (63.0, base), (3.0, base))
        composite = kind == "composite"
        ink.path([box], fill="#d5dbe0" if composite else "#eef1f3", stroke=None, closed=True)
        lines = hatch([box], angle=-60.0 if composite else -45.0, spacing=0.9 if composite else 1.5)
        if composite:
            lines += hatch([box], angle=60.0, spacing=0.9)
        ink.path(lines, pen=0.09, stroke=GREY)
        ink.path([box], closed=True, pen=0.18)
        middles.append(base - deep / 2)
        base -= deep
    places = spread_within(middles[::-1], [3.4] * (count - 1), 2.0, height - 2.0)[::-1]
    for (words, thickness, _), middle, y in zip(layers, middles, places, strict=True):
        ink.line((63.0, middle), (69.0, y), (71.0, y), pen=0.13)
        ink.text(72.0, y, f"{words}, {trimmed(1000 * thickness)} mm", size=7.0)
    ink.text(33.0, bottom + 2.4, "bore side", size=6.0, color=GREY, anchor="center")
    ink.text(width, 2.0, f"SCALE {paper}:{real}", size=7.0, bold=True, anchor="right")
    return ink
