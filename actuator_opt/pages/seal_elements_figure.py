"""Finite elements of a ring as ink: stress in the deformed section, contact over pressure.

Sections stand in their groove to scale, the sealed side left, the counterface below for a rod and
above for a bore. Darker is more stress, so that a grey print reads the same.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import cycle
from typing import Any

import numpy as np

from ..evaluation.contact_elements import closed_form, room
from ..evaluation.rings import Ring
from ..rendering.axes import Axes, legend, ticks
from ..rendering.ink import BLACK, BLUE, GREY, RED, WHITE, Ink, Point, Polygon, hatch
from ..rendering.shading import shades
from ..rendering.text import number, trimmed
from ..studies.seal import SealStudy
from . import stress_bands
from .bode import STYLES
from .drawing import OUTLINE, choose_scale
from .seal_figures import bars

WIDTH = 180.0
_METAL, _LINES = "#eef1f3", "#9aa3ab"
_WALL, _BAND, _APART, _TALL = 2.2, 3.0, 3.0, 46.0
"""Paper of the groove's walls, of the counterface, between two sections, of the groove (mm)."""
_HEAD, _WORDS, _SCALE = 6.0, 8.0, 9.0
"""Paper of the pressures above, of the words below, of the colour scale (mm)."""
MOST_BANDS = 12
"""Bands of stress at most."""
CURVES: tuple[dict[str, Any], ...] = (
    {"stroke": GREY, "pen": 0.4, "dash": (0.5, 0.6)},
    *STYLES,
    {"stroke": RED, "pen": 0.4, "dash": (0.9, 0.6)},
)
"""Contact pressures from the mounted ring on."""
ELEMENTS: dict[str, Any] = {"stroke": BLUE, "pen": 0.4}
CLOSED: dict[str, Any] = {"stroke": BLACK, "pen": 0.3, "dash": (1.6, 0.8)}


def stress_levels(study: SealStudy) -> list[float]:
    """Round levels from zero to the highest stress of all sections or more [Pa]."""
    top = max(float(np.max(one.field.von_mises)) for one in study.elements) / 1e6
    step = ticks(0.0, top, MOST_BANDS - 1)[1]
    return [1e6 * k * step for k in range(math.ceil(top / step - 1e-9) + 1)]


@dataclass(frozen=True, slots=True)
class Gland:
    """The groove of one section on paper: its outer wall at `right`, its face at `surface`.

    `side` is -1 where the groove lies above the counterface; lengths in mm of paper per m.
    """

    right: float
    surface: float
    side: float
    factor: float
    wide: float
    deep: float

    def at(self, x: float, r: float) -> Point:
        """Paper of a place from the outer wall (negative) and away from the sliding face [m]."""
        return self.right + x * self.factor, self.surface + self.side * r * self.factor


def gland_sizes(ring: Ring) -> tuple[float, float]:
    """Length that the elements have in the groove, and its depth from the counterface [m]."""
    return room(ring), float(ring.element.seal_type.groove(ring.numbers).depth)


def stress_scale(study: SealStudy) -> tuple[int, int]:
    """Scale of the sections, paper to real."""
    wide, deep = gland_sizes(study.out.rings[0].ring)
    count = len(study.elements)
    panel = (WIDTH - (count - 1) * _APART) / count
    return choose_scale(wide, deep, panel - 2 * _WALL, _TALL)


def stress_figure(study: SealStudy) -> Ink:
    """Von Mises stress of the section at every pressure, its contact in red."""
    wide, deep = gland_sizes(study.out.rings[0].ring)
    paper, real = stress_scale(study)
    factor, rod = 1000.0 * paper / real, study.place == "rod"
    tall = _WALL + deep * factor + _BAND
    ink = Ink(WIDTH, _HEAD + tall + _WORDS + _SCALE)
    surface = _HEAD + (tall - _BAND if rod else _BAND)
    levels = stress_levels(study)
    panel = (WIDTH + _APART) / len(study.elements)
    for k, one in enumerate(study.elements):
        right = panel * k + (panel - _APART + wide * factor) / 2
        gland = Gland(right, surface, -1.0 if rod else 1.0, factor, wide, deep)
        _walls(ink, gland)
        _section(ink, gland, one.field, levels)
        ends = [gland.at(one.start, 0.0), gland.at(one.start + one.width, 0.0)]
        ink.line(*ends, stroke=RED, pen=0.9)
        middle = right - wide * factor / 2
        said = f"{bars(one.pressure)}, mounted" if k == 0 else bars(one.pressure)
        ink.text(middle, 2.6, said, anchor="center", bold=True)
        y = _HEAD + tall + 2.8
        highest = number(1e-6 * float(np.max(one.field.von_mises)), 3)
        ink.text(middle, y, f"up to {highest} MPa", anchor="center")
        words = f"contact {number(1e3 * one.width, 3)} mm"
        ink.text(middle, y + 3.2, words, anchor="center", color=RED)
    _colours(ink, levels, ink.height - 6.0)
    words = f"SCALE {paper}:{real}"
    ink.text(WIDTH, ink.height - 4.6, words, size=7.5, anchor="right", bold=True)
    return ink


def _walls(ink: Ink, gland: Gland) -> None:
    """Groove and counterface, cut, the groove's corners closed."""
    left, right = gland.at(-gland.wide, 0.0)[0], gland.right
    floor = gland.at(0.0, gland.deep)[1]
    outside = floor + gland.side * _WALL
    groove = [(left, gland.surface), (left, floor), (right, floor), (right, gland.surface)]
    ends = (left - _WALL, right + _WALL)
    housing: Polygon = [
        (ends[0], gland.surface),
        *groove,
        (ends[1], gland.surface),
        (ends[1], outside),
        (ends[0], outside),
    ]
    beyond = gland.surface - gland.side * _BAND
    other = [(ends[0], gland.surface), (ends[1], gland.surface), (ends[1], beyond)]
    other.append((ends[0], beyond))
    for polygon, angle in ((housing, 45.0), (other, 135.0)):
        ink.path([polygon], stroke=None, fill=_METAL, closed=True)
        ink.path(hatch([polygon], angle=angle, spacing=1.4), pen=0.08, stroke=_LINES)
    face = [(ends[0], gland.surface), (ends[1], gland.surface)]
    ink.path([groove, face], pen=OUTLINE)


def _section(ink: Ink, gland: Gland, field: Any, levels: Sequence[float]) -> None:
    """The bands of stress, then the outline of every body."""
    fills = shades(len(levels) - 1)
    wall = float(np.max(field.nodes[:, 0]))  # it leans on the outer wall
    for paint, rings in zip(fills, stress_bands.bands(field, levels), strict=True):
        lines = [[gland.at(x - wall, r) for x, r in ring] for ring in rings]
        ink.path(lines, stroke=paint, pen=0.05, fill=paint, closed=True)
    for rings in stress_bands.outlines(field):
        lines = [[gland.at(x - wall, r) for x, r in ring] for ring in rings]
        ink.path(lines, pen=0.15, closed=True)


def _colours(ink: Ink, levels: Sequence[float], y: float) -> None:
    """The bands with the levels between them."""
    count, wide = len(levels) - 1, 9.0
    words = "von Mises stress, MPa"
    ink.text(0.0, y + 1.4, words)
    left = 34.0
    for k, paint in enumerate(shades(count)):
        ink.box(left + k * wide, y, wide, 2.8, fill=paint, pen=0.1)
    for k, level in enumerate(levels):
        ink.text(left + k * wide, y + 4.8, trimmed(1e-6 * level), size=6.0, anchor="center")


# ---- contact over pressure ----


def contact_figure(study: SealStudy) -> Ink:
    """Contact pressures by elements and closed form; peak and width of both over the pressure."""
    ring = study.out.rings[0].ring
    ink = Ink(WIDTH, 115.0)
    styles = [style for _, style in zip(study.elements, cycle(CURVES), strict=False)]
    names = [bars(one.pressure) for one in study.elements]
    legend(ink, 11.0, 3.0, list(zip(names, styles, strict=True)), ends=False)
    solved = [(one.positions, one.contact_pressure) for one in study.elements]
    closed = [_closed_profile(ring, one.pressure) for one in study.elements]
    top = max(float(np.max(p)) for _, p in [*solved, *closed]) / 1e6
    long = max(float(x[-1]) for x, _ in [*solved, *closed]) * 1e3
    for left, title, curves in ((11.0, "elements", solved), (103.0, "closed form", closed)):
        axes = Axes(ink, (left, 13.0, 66.0, 36.0), (0.0, long), (0.0, 1.06 * top))
        axes.frame(f"Contact pressure, {title}, MPa", "from the sealed end of the contact, mm")
        for (x, p), style in zip(curves, styles, strict=True):
            ink.path(axes.clipped((1e3 * x).tolist(), (p / 1e6).tolist()), **style)
    legend(ink, 11.0, 61.0, [("elements", ELEMENTS), ("closed form", CLOSED)], ends=False)
    pressures = np.linspace(0.0, study.elements[-1].pressure, 41)
    touches = [closed_form(ring.at(pressure=float(p))) for p in pressures]
    rows = (
        (11.0, "Peak contact pressure, MPa", "peak_pressure", "peak", 1e-6),
        (103.0, "Contact width, mm", "width", "width", 1e3),
    )
    for left, title, name, law, unit in rows:
        points = [unit * float(getattr(one, name)) for one in study.elements]
        line = [unit * float(getattr(one, law)) for one in touches]
        _over_pressure(ink, left, title, study, points, pressures, line)
    return ink


def _closed_profile(ring: Ring, pressure: float) -> tuple[np.ndarray, np.ndarray]:
    """Places and contact pressures of the closed form."""
    found = closed_form(ring.at(pressure=pressure))
    share = np.linspace(0.0, 1.0, 121)
    return share * float(found.profile_width), np.asarray(found.profile(share), dtype=float)


def _over_pressure(
    ink: Ink,
    left: float,
    title: str,
    study: SealStudy,
    points: Sequence[float],
    pressures: np.ndarray,
    line: Sequence[float],
) -> None:
    """A quantity of the elements at their pressures, and of the closed form over all."""
    top = 1.08 * max(*points, *line)
    most = float(pressures[-1]) / 1e5
    axes = Axes(ink, (left, 70.0, 66.0, 34.0), (0.0, most), (0.0, top))
    axes.frame(title, "sealed pressure, bar")
    ink.path(axes.clipped((pressures / 1e5).tolist(), line), **CLOSED)
    places = [one.pressure / 1e5 for one in study.elements]
    ink.path(axes.clipped(places, points), **ELEMENTS)
    for x, y in zip(places, points, strict=True):
        ink.circle(axes.x(x), axes.y(y), 0.75, fill=WHITE, stroke=BLUE, pen=0.3)


# ---- words ----


def sentence(study: SealStudy) -> str:
    """Width and peak at the operating point against the closed form; empty without elements."""
    if not study.elements:
        return ""
    one = study.out.rings[0]
    closed = closed_form(one.ring)
    pressure = float(f"{abs(one.ring['pressure']):.4g}")

    def beside(value: Any, other: Any, unit: str, scale: float) -> str:
        own, law = (number(scale * float(one), 3) for one in (value, other))
        return f"{own} {unit} (closed form {law})"

    return (
        f"Contact of the {one.ring.label} by finite elements: at {bars(pressure)} width"
        f" {beside(one.contact.width, closed.width, 'mm', 1e3)}, peak"
        f" {beside(one.contact.peak, closed.peak, 'MPa', 1e-6)}."
    )


def stress_note(study: SealStudy) -> str:
    """What the sections show, and what they leave out."""
    said = "Deformed to scale, sealed side left; red: the contact. "
    if study.out.rings[0].ring.element.back_ups:
        said += "The groove is what the back-up rings leave. "
    return (
        f"{said}Stress averaged at the corners of the elements; highest: mean of one element."
        " Rigid walls with closed corners; no friction, no creep, no yielding."
    )


def contact_note(study: SealStudy) -> str:
    """How far the curves are to be trusted."""
    said = (
        "Pressures above the outer side's; both without the bore's growth. Between the points of"
        " the elements the line is straight, and so are contacts taken between two pressures."
    )
    elements = study.out.rings[0].ring.element.seal_type.elements
    return said if elements is None else f"{said} {elements.note}"
