"""Dynamics as ink: modes along the stroke, dynamic stiffness over frequency.

Curves differ in dash as well as in colour. What is required stands in red where it applies, with
a tick that points to the allowed side; the words stand beside the frames, where nothing crosses.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..base.numeric import Array
from ..evaluation.dynamics_study import DynamicsStudy, Response
from ..evaluation.result import Requirement
from ..rendering.axes import (
    _SUPERSCRIPTS,
    Axes,
    dot,
    fitted,
    legend,
    level_ticks,
    lowest,
    required,
)
from ..rendering.ink import BLACK, BLUE, GREY, RED, WHITE, Ink, spread_within
from ..rendering.text import MINUS, SENSES, number, trimmed
from .wall_figures import GREEN, OCHRE

STYLES: tuple[dict[str, Any], ...] = (
    {"stroke": BLUE, "pen": 0.4},
    {"stroke": OCHRE, "pen": 0.4, "dash": (1.6, 0.8)},
    {"stroke": GREEN, "pen": 0.4, "dash": (2.4, 0.7, 0.4, 0.7)},
)
STATIC: dict[str, Any] = {"stroke": GREY, "pen": 0.2, "dash": (0.9, 0.6)}
LIMIT: dict[str, Any] = {"stroke": RED, "pen": 0.4}
DEEPEST = 1000.0
"""How far below the static stiffness a curve is drawn, as a ratio."""
MOST_CASES = 6
"""Shaken load cases named beside the figure."""
_ROW = 3.5


@dataclass(frozen=True, slots=True)
class Shaken:
    """A load case that shakes the actuator: Hz, its least stiffness (N/m), its phase (rad)."""

    name: str
    frequency: float
    stiffness: float | None = None
    phase: float | None = None


def logs(values: Array) -> list[float]:
    """Logarithms to ten; zero and less become very small."""
    return [math.log10(v) if v > 1e-200 else -200.0 for v in map(float, values)]


def frequency_axis(study: DynamicsStudy) -> tuple[list[float], tuple[float, float]]:
    """Frequencies of the study as logarithms, and their ends."""
    found = logs(study.frequencies)
    return found, (found[0], found[-1])


def inside(axes: Axes, x: float) -> bool:
    """Whether a place lies on the x axis."""
    return axes.x_range[0] <= x <= axes.x_range[1]


def limit_mark(axes: Axes, x: float, y: float, sense: str) -> None:
    """A limit at one place: a bar, and a tick on its allowed side; at the rim where it is off."""
    low, high = axes.y_range
    at, level = axes.x(x), axes.y(min(max(y, low), high))
    axes.ink.line((at - 2.4, level), (at + 2.4, level), **LIMIT)
    towards = level + (-1.7 if sense == "min" else 1.7)
    corners = ((at - 0.8, level), (at + 0.8, level), (at, towards))
    axes.ink.path([corners], stroke=None, fill=RED, closed=True)


# ---- along the stroke ----


def frequency_panel(
    ink: Ink,
    box: tuple[float, float, float, float],
    study: DynamicsStudy,
    requirements: Sequence[Requirement],
) -> bool:
    """Natural frequency along the stroke; True where the line end makes a second curve."""
    xs = [1000.0 * float(x) for x in study.position]
    closed = [float(f) for f in study.closed_frequency]
    held = [float(f) for f in study.frequency]
    both = any(abs(a - b) > 1e-3 * b for a, b in zip(held, closed, strict=True))
    least = min(closed)
    limits = [row.limit for row in requirements]
    floor = max([least, *limits, *([min(held)] if both else [])])
    shown = [f for f in (*closed, *(held if both else ())) if math.isfinite(f)]
    top = 1.06 * min(max([*shown, 1.15 * floor]), 3.0 * floor)
    axes = Axes(ink, box, (xs[0], xs[-1]), (0.0, top))
    axes.frame("Natural frequency, Hz", "piston position from the cap end, mm")
    ink.path(axes.clipped(xs, closed), **STYLES[0])
    if both:
        ink.path(axes.clipped(xs, held), **STYLES[1])
    for row in requirements:
        required(axes, row.limit, f"{SENSES[row.sense]} {trimmed(row.limit)}")
    place = xs[closed.index(least)]
    lowest(axes, place, least, limits)
    return both


def damping_panel(
    ink: Ink,
    box: tuple[float, float, float, float],
    study: DynamicsStudy,
    requirements: Sequence[Requirement],
) -> None:
    """Damping ratio along the stroke, and what friction alone gives at the weakest position."""
    xs = [1000.0 * float(x) for x in study.position]
    found = [float(z) if math.isfinite(float(z)) else 0.0 for z in study.damping_ratio]
    size = max([abs(z) for z in found] + [abs(study.friction_share)])
    power = 0 if size == 0 else 3 * min(0, math.floor(math.log10(size) / 3 + 1 / 3))
    scale = 10.0**-power
    ys = [scale * z for z in found]
    limits = [scale * row.limit for row in requirements]
    friction = scale * study.friction_share
    near = [level for level in limits if level < 4 * max(map(abs, [*ys, 1e-12]))]
    low = min([0.0, *ys, friction])
    high = max([*ys, friction, *near, 0.0]) or 1.0
    axes = Axes(ink, box, (xs[0], xs[-1]), (1.08 * low, 1.08 * high))
    unit = "" if power == 0 else f", 10{str(power).translate(_SUPERSCRIPTS)}"
    axes.frame(f"Damping ratio{unit}", "piston position from the cap end, mm")
    ink.path(axes.clipped(xs, ys), **STYLES[0])
    for row, level in zip(requirements, limits, strict=True):
        required(axes, level, f"{SENSES[row.sense]} {trimmed(row.limit)}")
    closed = [float(f) for f in study.closed_frequency]
    place = closed.index(min(closed))
    dot(axes, xs[place], friction, OCHRE)
    dot(axes, xs[place], ys[place], WHITE, BLUE)


def modes_figure(
    study: DynamicsStudy,
    frequency: Sequence[Requirement],
    damping: Sequence[Requirement],
    *,
    width: float = 180.0,
    height: float = 54.0,
) -> Ink:
    """Natural frequency (left) and damping ratio (right) along the stroke."""
    ink = Ink(width, height)
    panel = (width - 44.0) / 2
    both = frequency_panel(ink, (11.0, 12.0, panel, height - 22.0), study, frequency)
    damping_panel(ink, (panel + 33.0, 12.0, panel, height - 22.0), study, damping)
    legend(ink, 11.0 + panel, 1.8, _mode_words(study, both))
    return ink


def _mode_words(study: DynamicsStudy, both: bool) -> list[tuple[str, dict[str, Any]]]:
    found = [("ports closed" if both or study.end == "closed" else "as held", STYLES[0])]
    if both:
        end = study.end.replace("_", " ")
        words = "with the lines' oil moving" if study.end == "closed" else f"lines end at: {end}"
        found.append((words, STYLES[1]))
    return found


# ---- over frequency ----


def _stiffness_range(responses: Sequence[Response], shown: Sequence[float]) -> tuple[float, float]:
    """Decades (log10, kN/mm) that show the curves down to a thousandth of the static stiffness."""
    statics = [one.static / 1e6 for one in responses]
    values = [float(v) / 1e6 for one in responses for v in one.magnitude if v > 0]
    low = max(min([*values, *statics]), min(statics) / DEEPEST)
    low, high = min([low, *shown]), max([*values, *statics, *shown])
    return math.log10(low) - 0.15, math.log10(high) + 0.15


def magnitude_panel(
    ink: Ink,
    box: tuple[float, float, float, float],
    study: DynamicsStudy,
    shaken: Sequence[Shaken],
    requirements: Sequence[Requirement],
    x_label: str,
    title: str,
) -> Axes:
    """Magnitude of the dynamic stiffness at three places with its static levels."""
    xs, across = frequency_axis(study)
    results = [one.stiffness / 1e6 for one in shaken if one.stiffness]
    near = [row.limit / 1e6 for row in requirements if shaken and row.limit > 0]
    axes = Axes(ink, box, across, _stiffness_range(study.responses, [*results, *near]))
    axes.frame_at(title, x_label, level_ticks(*across), level_ticks(*axes.y_range), upright=True)
    for one in study.responses:
        level = axes.y(math.log10(one.static / 1e6))
        ink.line((box[0], level), (box[0] + box[2], level), **STATIC)
    for one, style in zip(study.responses, STYLES, strict=False):
        ink.path(axes.clipped(xs, logs(one.magnitude / 1e6)), **style)
    for case in shaken:
        x = math.log10(case.frequency)
        if not inside(axes, x):
            continue
        for row in requirements:
            if row.limit > 0:
                limit_mark(axes, x, math.log10(row.limit / 1e6), row.sense)
        if case.stiffness:
            dot(axes, x, math.log10(case.stiffness / 1e6), BLACK)
    return axes


def _phase_panel(
    ink: Ink,
    box: tuple[float, float, float, float],
    study: DynamicsStudy,
    shaken: Sequence[Shaken],
    requirements: Sequence[Requirement],
) -> Axes:
    xs, across = frequency_axis(study)
    curves = [[math.degrees(float(p)) for p in one.phase] for one in study.responses]
    low = -180.0 if min(min(curve) for curve in curves) < -1.0 else 0.0
    axes = Axes(ink, box, across, (low, 180.0))
    marks = [(float(v), degrees(v)) for v in range(int(low), 181, 45 if low == 0 else 90)]
    axes.frame_at(
        "Phase by which the force leads, degrees",
        "frequency, Hz",
        level_ticks(*across),
        marks,
        upright=True,
    )
    for curve, style in zip(curves, STYLES, strict=False):
        ink.path(axes.clipped(xs, curve), **style)
    for case in shaken:
        x = math.log10(case.frequency)
        if not inside(axes, x):
            continue
        for row in requirements:
            limit_mark(axes, x, math.degrees(row.limit), row.sense)
        if case.phase is not None:
            dot(axes, x, math.degrees(case.phase), BLACK)
    return axes


def degrees(value: float) -> str:
    """Whole degrees for an axis."""
    return f"{value:.0f}".replace("-", MINUS)


def _letters(axes: Axes, bottom: float, shaken: Sequence[Shaken]) -> None:
    """Upright lines at the shaken frequencies through both frames, a letter above each."""
    drawn = [(k, one) for k, one in enumerate(shaken) if inside(axes, math.log10(one.frequency))]
    drawn.sort(key=lambda one: one[1].frequency)
    xs = [axes.x(math.log10(one.frequency)) for _, one in drawn]
    places = spread_within(xs, [2.6] * len(xs), axes.left, axes.left + axes.width)
    for (k, _), x, at in zip(drawn, xs, places, strict=True):
        style: dict[str, Any] = {"stroke": BLACK, "pen": 0.13, "dash": (0.4, 0.7)}
        axes.ink.line((at, axes.top - 0.4), (x, axes.top + 1.2), (x, bottom), **style)
        axes.ink.text(at, axes.top - 1.6, chr(ord("a") + k), anchor="center", size=6.5, bold=True)


def response_figure(
    study: DynamicsStudy,
    shaken: Sequence[Shaken],
    stiffness: Sequence[Requirement],
    phase: Sequence[Requirement],
    *,
    width: float = 180.0,
) -> Ink:
    """Dynamic stiffness, magnitude over phase, with what stands beside them in words."""
    upper, lower, left = 46.0, 28.0, 12.0
    ink = Ink(width, upper + lower + 31.0)
    span = width - left - 52.0
    ink.text(left - 1.4, 4.0, "Magnitude, load mass included, kN/mm", size=7.0, bold=True)
    axes = magnitude_panel(ink, (left, 11.0, span, upper), study, shaken, stiffness, "", "")
    below = _phase_panel(ink, (left, 21.0 + upper, span, lower), study, shaken, phase)
    _letters(axes, below.top + below.height, shaken)
    x, y = left + span + 4.0, axes.top + 1.0
    for one, style in zip(study.responses, STYLES, strict=False):
        ink.line((x, y), (x + 6.0, y), **style)
        place = f"{one.place}, {trimmed(1e3 * one.position, 3)} mm"
        ink.text(x + 7.5, y, fitted(place, width - x - 7.5))
        ink.text(x + 7.5, y + _ROW, f"static {number(one.static / 1e6)}", color=GREY)
        y += 2 * _ROW + 1.0
    ink.line((x, y), (x + 6.0, y), **STATIC)
    ink.text(x + 7.5, y, "static, ports closed", color=GREY)
    _case_words(ink, x, y + _ROW + 2.0, width, shaken, stiffness, phase)
    return ink


def _case_words(
    ink: Ink,
    x: float,
    y: float,
    width: float,
    shaken: Sequence[Shaken],
    stiffness: Sequence[Requirement],
    phase: Sequence[Requirement],
) -> None:
    """Load cases that shake with their results, and what is required."""
    room = width - x
    for k, case in enumerate(shaken[:MOST_CASES]):
        ink.text(x, y, chr(ord("a") + k), bold=True)
        words = f"{case.name}, {trimmed(case.frequency)} Hz"
        ink.text(x + 4.0, y, fitted(words, room - 4.0))
        found = [] if case.stiffness is None else [f"{number(case.stiffness / 1e6)} kN/mm"]
        if case.phase is not None:
            found.append(f"{number(math.degrees(case.phase), 3)}°")
        ink.text(x + 4.0, y + _ROW, fitted(", ".join(found), room - 4.0), color=GREY)
        y += 2 * _ROW + 0.7
    if len(shaken) > MOST_CASES:
        ink.text(x, y, f"and {len(shaken) - MOST_CASES} more", color=GREY)
        y += _ROW
    if not shaken:
        return
    for row in stiffness:
        words = f"required {SENSES[row.sense]} {trimmed(row.limit / 1e6)} kN/mm"
        ink.text(x, y, fitted(words, room), color=RED)
        y += _ROW
    for row in phase:
        words = f"required {SENSES[row.sense]} {trimmed(math.degrees(row.limit))}°"
        ink.text(x, y, fitted(words, room), color=RED)
        y += _ROW


def compact_figure(
    study: DynamicsStudy,
    frequency: Sequence[Requirement],
    damping: Sequence[Requirement],
    *,
    width: float = 180.0,
    height: float = 54.0,
) -> Ink:
    """Natural frequency, damping ratio and dynamic stiffness in one row."""
    ink = Ink(width, height)
    panel, tall = 43.0, height - 22.0
    frequency_panel(ink, (9.0, 12.0, panel, tall), study, frequency)
    damping_panel(ink, (69.0, 12.0, panel, tall), study, damping)
    box = (131.0, 12.0, width - 136.0, tall)
    magnitude_panel(ink, box, study, (), (), "frequency, Hz", "Dynamic stiffness, kN/mm")
    entries = [(one.place, style) for one, style in zip(study.responses, STYLES, strict=False)]
    legend(ink, width, 1.8, [*entries, ("static", STATIC)])
    return ink
