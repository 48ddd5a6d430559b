"""Figures of the barrel's wall as ink: stresses and strength used through it, the way to burst.

Layers stand as bands with their number, the bore at the left; curves differ in dash as well as in
colour and are named in the legend above the frames, so nothing written crosses a curve.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..evaluation.wall_study import Profile, WallStudy
from ..rendering.axes import Axes, fitted, legend
from ..rendering.ink import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    OCHRE,
    RED,
    WHITE,
    Ink,
    Point,
    hatch,
    spread_within,
    text_width,
)
from ..rendering.text import number, trimmed

STEEL = "#4f86a8"
BANDS = {"metal": "#f1f3f5", "composite": "#e2e7eb", "polymer": "#f6efdc"}
_STYLES: tuple[dict[str, Any], ...] = (
    {"stroke": BLUE, "pen": 0.4},
    {"stroke": OCHRE, "pen": 0.4, "dash": (1.6, 0.8)},
    {"stroke": GREEN, "pen": 0.4, "dash": (2.4, 0.7, 0.4, 0.7)},
)
_REST: dict[str, Any] = {"stroke": GREY, "pen": 0.35, "dash": (0.4, 0.6)}
_MISES: dict[str, Any] = {"stroke": BLACK, "pen": 0.4}
_AT_REST = {"cold": "no pressure, coldest", "hot": "no pressure, hottest", "": "no pressure"}
_NEAR = 0.6
"""Share of a limit from which on it is drawn."""
_NUMBERS, _SHARES = 4.2, 8.0
"""Room (mm) inside a frame, above the curves, for layer numbers, and for strength ratios too."""


@dataclass(frozen=True, slots=True)
class Curve:
    """Values of every layer, (layers, points), with the ink they are drawn in."""

    values: Any
    style: dict[str, Any]


@dataclass(frozen=True, slots=True)
class Rung:
    """A line of the ladder: what, its pressure (Pa), the colour of its bar, a remark, its limit."""

    what: str
    pressure: float
    color: str
    remark: str = ""
    required: float | None = None


def _panel(
    ink: Ink,
    box: tuple[float, float, float, float],
    title: str,
    study: WallStudy,
    curves: Sequence[Curve],
    room: float,
    limits: Sequence[float] = (),
) -> Axes:
    """A frame over the wall with its layers as bands, the curves in it, and limits they near."""
    found = [float(v) for c in curves for row in c.values for v in row if math.isfinite(v)]
    shown = [level for level in limits if any(v / level > _NEAR for v in found)]
    low, high = min([0.0, *found, *shown]), max([0.0, *found, *shown])
    span = high - low or 1.0
    low -= 0.04 * span if low < 0 else 0.0
    high += (0.03 * span + span * room / (box[3] - room)) if high > 0 or low == 0 else 0.0
    if high <= 0:
        high = (high - low) * room / (box[3] - room)
    radii = [[1000.0 * float(r) for r in row] for row in study.radius]
    axes = Axes(ink, box, (radii[0][0], radii[-1][-1]), (low, high))
    bottom = box[1] + box[3]
    for row, layer in zip(radii, study.layers, strict=True):
        left, right = axes.x(row[0]), axes.x(row[-1])
        ink.box(left, box[1], right - left, box[3], fill=BANDS[layer.kind], stroke=None)
    for row in radii[1:]:
        ink.line((axes.x(row[0]), box[1]), (axes.x(row[0]), bottom), stroke=WHITE, pen=0.35)
    axes.frame(title, "radius, mm")
    if low < 0 < high:
        ink.line((box[0], axes.y(0.0)), (box[0] + box[2], axes.y(0.0)), pen=0.13)
    for level in shown:
        y = axes.y(level)
        ink.line((box[0], y), (box[0] + box[2], y), stroke=RED, pen=0.25, dash=(1.8, 1.0))
    free = box[0]
    for index, row in enumerate(radii):
        half = text_width(str(index + 1), 6.0, bold=True) / 2
        middle = (axes.x(row[0]) + axes.x(row[-1])) / 2
        if middle - half >= free:
            ink.text(
                middle,
                box[1] + 2.0,
                str(index + 1),
                size=6.0,
                anchor="center",
                color=GREY,
                bold=True,
            )
            free = middle + half + 0.8
    for curve in curves:
        lines: list[list[Point]] = [
            [(axes.x(r), axes.y(float(v))) for r, v in zip(row, values, strict=True)]
            for row, values in zip(radii, curve.values, strict=True)
            if all(math.isfinite(float(v)) for v in values)
        ]
        ink.path(lines, **curve.style)
    return axes


def stress_figure(study: WallStudy, *, width: float = 180.0, height: float = 52.0) -> Ink:
    """Hoop, axial and radial stress through the wall at supply pressure, for every load path."""
    ink = Ink(width, height)
    rest = max(study.rest, key=lambda one: abs(one.hoop).max(), default=None)
    loads: list[tuple[Profile, dict[str, Any]]] = list(zip(study.profiles, _STYLES, strict=False))
    entries = [(profile.name, style) for profile, style in loads]
    if rest is not None:
        loads.append((rest, _REST))
        entries.append((_AT_REST.get(rest.name, rest.name), _REST))
    legend(ink, width, 1.8, entries, ends=True)
    panel = (width - 3 * 12.5) / 3
    for k, part in enumerate(("hoop", "axial", "radial")):
        box = (11.0 + k * (panel + 12.0), 12.0, panel, height - 22.0)
        curves = [Curve(getattr(profile, part) / 1e6, style) for profile, style in loads]
        _panel(ink, box, f"{part.capitalize()} stress, MPa", study, curves, _NUMBERS)
    return ink


def strength_figure(study: WallStudy, *, width: float = 180.0, height: float = 58.0) -> Ink:
    """Strength used at supply pressure by the design's criterion, and stress over strength."""
    ink = Ink(width, height)
    panel = (width - 2 * 13.0) / 2
    box = (11.0, 12.0, panel, height - 22.0)
    paths = list(zip(study.profiles, _STYLES, strict=False))
    curves = [Curve(one.used, style) for one, style in paths if one.used is not None]
    axes = _panel(ink, box, "Strength used, 1/SR", study, curves, _SHARES, (1.0,))
    legend(ink, box[0] - 9.6, 1.8, [(one.name, style) for one, style in paths], ends=False)
    for index, row in enumerate(study.radius):
        found = [float(v) for one, _ in paths if one.used is not None for v in one.used[index]]
        worst = max((v for v in found if not math.isnan(v)), default=0.0)
        words = f"SR {number(1 / worst, 3)}" if worst > 0 else ""
        left, right = axes.x(1000.0 * float(row[0])), axes.x(1000.0 * float(row[-1]))
        if words and text_width(words, 6.0) + 0.6 < right - left:
            ink.text((left + right) / 2, box[1] + 5.4, words, size=6.0, anchor="center")
    shares = study.shares
    if shares is None:
        return ink
    box = (box[0] + panel + 12.5, box[1], panel, box[3])
    named = [
        ("fibre σ₁/X", shares.along, _STYLES[0]),
        ("across σ₂/Y", shares.across, _STYLES[1]),
        ("shear τ₁₂/S", shares.shear, _STYLES[2]),
        ("von Mises", shares.mises, _MISES),
    ]
    named = [one for one in named if any(math.isfinite(float(v)) for row in one[1] for v in row)]
    curves = [Curve(values, style) for _, values, style in named]
    _panel(ink, box, "Stress over strength", study, curves, _NUMBERS, (1.0, -1.0))
    legend(ink, width, 1.8, [(words, style) for words, _, style in named], ends=True)
    return ink


def ladder_figure(rungs: Sequence[Rung], working: float, *, width: float = 180.0) -> Ink:
    """Pressures on the way to burst as bars; a red tick is what a check or requirement asks for."""
    step, top = 4.8, 5.0
    ink = Ink(width, top + step * len(rungs) + 1.5)
    left, room = 40.0, 48.0
    largest = max([rung.pressure for rung in rungs] + [rung.required or 0.0 for rung in rungs])
    scale = room / largest
    values = left + room
    ink.text(values + 14.0, 1.6, "bar", size=6.0, anchor="right", color=GREY)
    ink.text(values + 28.0, 1.6, "× working", size=6.0, anchor="right", color=GREY)
    for k, rung in enumerate(rungs):
        y = top + step * (k + 0.5)
        ink.text(left - 1.5, y, rung.what, size=6.5, anchor="right")
        ink.box(left, y - 1.5, rung.pressure * scale, 3.0, fill=rung.color, pen=0.13)
        if rung.required is not None:
            x = left + rung.required * scale
            ink.line((x, y - 2.2), (x, y + 2.2), stroke=RED, pen=0.45)
        ink.text(values + 14.0, y, number(rung.pressure / 1e5), size=6.5, anchor="right", bold=True)
        ink.text(values + 28.0, y, number(rung.pressure / working, 3), size=6.5, anchor="right")
        ink.text(
            values + 31.0, y, fitted(rung.remark, width - values - 31.0, 6.2), size=6.2, color=GREY
        )
    ink.line((left, top), (left, top + step * len(rungs)), pen=0.2)
    return ink


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
