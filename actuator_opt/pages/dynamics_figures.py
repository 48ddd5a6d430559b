"""Dynamics as ink: modes along the stroke, dynamic stiffness over frequency.

Curves differ in dash as well as in colour. What is required stands in red where it applies, with
a tick that points to the allowed side; the words stand beside the frames, where nothing crosses.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from ..base.numeric import Array
from ..evaluation.dynamics_study import DynamicsStudy, LoopStudy, Response
from ..evaluation.result import Requirement
from ..rendering.axes import Axes, Ticks, dot, fitted, legend, level_ticks, lowest, required
from ..rendering.ink import BLACK, BLUE, GREEN, GREY, OCHRE, RED, WHITE, Ink, spread_within
from ..rendering.text import MINUS, SENSES, SUPERSCRIPTS, number, trimmed

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
    unit = "" if power == 0 else f", 10{str(power).translate(SUPERSCRIPTS)}"
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
    statics = [response.static / 1e6 for response in responses]
    values = [float(v) / 1e6 for response in responses for v in response.magnitude if v > 0]
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
    for response in study.responses:
        level = axes.y(math.log10(response.static / 1e6))
        ink.line((box[0], level), (box[0] + box[2], level), **STATIC)
    for response, style in zip(study.responses, STYLES, strict=False):
        ink.path(axes.clipped(xs, logs(response.magnitude / 1e6)), **style)
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
    curves = [[math.degrees(float(p)) for p in response.phase] for response in study.responses]
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
    for response, style in zip(study.responses, STYLES, strict=False):
        ink.line((x, y), (x + 6.0, y), **style)
        place = f"{response.place}, {trimmed(1e3 * response.position, 3)} mm"
        ink.text(x + 7.5, y, fitted(place, width - x - 7.5))
        ink.text(x + 7.5, y + _ROW, f"static {number(response.static / 1e6)}", color=GREY)
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
    entries = [
        (response.place, style) for response, style in zip(study.responses, STYLES, strict=False)
    ]
    legend(ink, width, 1.8, [*entries, ("static", STATIC)])
    return ink


# ---- the position loop ----

HALF_POWER = -10 * math.log10(2.0)
"""-3 dB, where a closed loop's bandwidth ends."""
_LEFT, _BESIDE = 12.0, 55.0
"""Room (mm) for the levels left of a frame and for the words right of it."""
_ARROW: dict[str, Any] = {"stroke": BLACK, "pen": 0.25}


@dataclass(frozen=True, slots=True)
class LoopLimits:
    """What is required of the loop."""

    gain_margin: Sequence[Requirement] = ()
    phase_margin: Sequence[Requirement] = ()
    bandwidth: Sequence[Requirement] = ()


def decibels(ratio: float) -> float:
    """A ratio of magnitudes in dB.

    >>> decibels(10.0), decibels(0.0)
    (20.0, -6000.0)
    """
    return 20 * math.log10(ratio) if ratio > 1e-300 else -6000.0


def governing(loops: Sequence[LoopStudy], figure: str) -> int:
    """Index of the loop whose margin or bandwidth is least; one without a value counts last."""

    def least(k: int) -> float:
        value = getattr(loops[k], figure)
        return math.inf if value is None or math.isnan(value) else float(value)

    return min(range(len(loops)), key=least)


def open_figure(
    study: DynamicsStudy,
    loops: Sequence[LoopStudy],
    limits: LoopLimits,
    *,
    width: float = 180.0,
) -> Ink:
    """Open loop, magnitude over phase, with the margins where they are least."""
    tall, gap = 35.0, 9.0
    ink = Ink(width, 2 * tall + gap + 18.0)
    span = width - _LEFT - _BESIDE
    first, second = ((_LEFT, 8.0 + k * (tall + gap), span, tall) for k in range(2))
    xs, across = frequency_axis(study)
    _loop_magnitude_panel(ink, first, xs, across, loops, limits.gain_margin)
    _loop_phase_panel(ink, second, xs, across, loops, limits.phase_margin)
    x = _LEFT + span + 4.0
    top = _names(ink, x, first[1] + 1.0, loops)
    top = _words(ink, x, top, first[1] + tall, _gain_words(loops, limits.gain_margin))
    _words(ink, x, top, second[1] + tall, _phase_words(loops, limits.phase_margin))
    return ink


def closed_figure(
    study: DynamicsStudy,
    loops: Sequence[LoopStudy],
    limits: LoopLimits,
    *,
    width: float = 180.0,
) -> Ink:
    """Closed loop with the bandwidth of every curve."""
    tall = 40.0
    ink = Ink(width, tall + 18.0)
    span = width - _LEFT - _BESIDE
    xs, across = frequency_axis(study)
    _closed_panel(ink, (_LEFT, 8.0, span, tall), xs, across, loops, limits.bandwidth)
    x = _LEFT + span + 4.0
    top = _names(ink, x, 9.0, loops)
    _words(ink, x, top, 8.0 + tall, _bandwidth_words(loops, limits.bandwidth))
    return ink


def _level_marks(low: float, high: float) -> Ticks:
    step = 20 if high - low > 50 else 10 if high - low > 25 else 5
    first, last = math.ceil(low / step), math.floor(high / step)
    return [(float(step * k), degrees(step * k)) for k in range(first, last + 1)]


def _curves(axes: Axes, xs: Sequence[float], rows: Sequence[Sequence[float]]) -> None:
    for row, style in zip(rows, STYLES, strict=False):
        axes.ink.path(axes.clipped(xs, row), **style)


def _line(axes: Axes, y: float, style: dict[str, Any]) -> None:
    if axes.y_range[0] <= y <= axes.y_range[1]:
        axes.ink.line((axes.left, axes.y(y)), (axes.left + axes.width, axes.y(y)), **style)


def _held(axes: Axes, y: float) -> float:
    return min(max(y, axes.y_range[0]), axes.y_range[1])


def _span(axes: Axes, x: float, start: float, end: float) -> None:
    """A margin: an arrow from where it counts to the curve, with a dot there."""
    at, low, high = axes.x(x), axes.y(_held(axes, start)), axes.y(_held(axes, end))
    axes.ink.line((at, low), (at, high), **_ARROW)
    if abs(high - low) > 2.0:
        axes.ink.arrow((at, high), (at, low), length=1.6)
    axes.ink.circle(at, high, 0.6, fill=WHITE, stroke=BLACK, pen=0.25)


def _loop_magnitude_panel(
    ink: Ink,
    box: tuple[float, float, float, float],
    xs: Sequence[float],
    across: tuple[float, float],
    loops: Sequence[LoopStudy],
    required: Sequence[Requirement],
) -> None:
    rows = [[decibels(float(v)) for v in loop.open_magnitude] for loop in loops]
    one = loops[governing(loops, "gain_margin")]
    known = 0 < one.gain_margin < math.inf
    margin = decibels(one.gain_margin) if known else 0.0
    low = min(-40.0, -margin - 15.0, *(-decibels(row.limit) - 5.0 for row in required))
    low = max(low, min(min(row) for row in rows) - 5.0, -140.0)
    high = max(20.0, *(max(row) for row in rows), -margin + 5.0)
    axes = Axes(ink, box, across, (low, min(high, 120.0) + 3.0))
    axes.frame_at(
        "Open loop, magnitude, dB", "", level_ticks(*across), _level_marks(*axes.y_range),
        upright=True,
    )  # fmt: skip
    _line(axes, 0.0, {"stroke": BLACK, "pen": 0.18})
    _curves(axes, xs, rows)
    x = math.log10(one.ultimate_frequency) if one.ultimate_frequency > 0 else math.nan
    if known and inside(axes, x):
        for row in required:
            limit_mark(axes, x, -decibels(row.limit), "max" if row.sense == "min" else "min")
        _span(axes, x, 0.0, -margin)


def _loop_phase_panel(
    ink: Ink,
    box: tuple[float, float, float, float],
    xs: Sequence[float],
    across: tuple[float, float],
    loops: Sequence[LoopStudy],
    required: Sequence[Requirement],
) -> None:
    rows = [[math.degrees(float(p)) for p in loop.open_phase] for loop in loops]
    index = governing(loops, "phase_margin")
    one = loops[index]
    lowest, highest = min(min(row) for row in rows), max(max(row) for row in rows)
    low, high = min(lowest, -180.0) - 15.0, max(highest, -90.0) + 15.0
    axes = Axes(ink, box, across, (low, high))
    step = 90 * max(1, math.ceil((high - low) / 630.0))
    marks = [(float(v), degrees(v)) for v in range(-1800, 1801, step) if low <= v <= high]
    title = "Open loop, phase, degrees"
    axes.frame_at(title, "frequency, Hz", level_ticks(*across), marks, upright=True)
    for turn in range(int(-high // 360) - 1, int(-low // 360) + 2):
        _line(axes, -180.0 - 360.0 * turn, {"stroke": BLACK, "pen": 0.18})
    _curves(axes, xs, rows)
    x = math.nan if one.crossover is None else math.log10(one.crossover)
    if not inside(axes, x):
        return
    phase = _at(xs, rows[index], x)
    base = -180.0 - 360.0 * round(-(phase + 180.0) / 360.0)
    side = 1.0 if phase >= base or one.phase_margin < 0 else -1.0
    for row in required:
        away = "min" if (side > 0) == (row.sense == "min") else "max"
        limit_mark(axes, x, base + side * math.degrees(row.limit), away)
    _span(axes, x, base, phase)


def _at(xs: Sequence[float], ys: Sequence[float], x: float) -> float:
    """A curve between its points."""
    k = next((k for k in range(1, len(xs) - 1) if xs[k] >= x), len(xs) - 1)
    return ys[k - 1] + (ys[k] - ys[k - 1]) * (x - xs[k - 1]) / (xs[k] - xs[k - 1])


def _closed_panel(
    ink: Ink,
    box: tuple[float, float, float, float],
    xs: Sequence[float],
    across: tuple[float, float],
    loops: Sequence[LoopStudy],
    required: Sequence[Requirement],
) -> None:
    rows = [[decibels(float(v)) for v in loop.closed_magnitude] for loop in loops]
    highest = max(max(row) for row in rows)
    axes = Axes(ink, box, across, (-40.0, min(max(highest, 0.0), 60.0) + 5.0))
    axes.frame_at(
        "Closed loop, magnitude, dB",
        "frequency, Hz",
        level_ticks(*across),
        _level_marks(*axes.y_range),
        upright=True,
    )
    _line(axes, HALF_POWER, STATIC)
    _curves(axes, xs, rows)
    for row in required:
        x = math.log10(row.limit) if row.limit > 0 else math.nan
        if inside(axes, x):
            at, bottom = axes.x(x), axes.top + axes.height
            corner = axes.y(HALF_POWER)
            away = -3.2 if row.sense == "min" else 3.2
            ink.line((at + away, corner), (at, corner), (at, bottom), **LIMIT)
    for loop, style in zip(loops, STYLES, strict=False):
        if loop.bandwidth is not None and inside(axes, math.log10(loop.bandwidth)):
            dot(axes, math.log10(loop.bandwidth), HALF_POWER, style["stroke"])


Words = list[tuple[str, str]]


def _names(ink: Ink, x: float, y: float, loops: Sequence[LoopStudy]) -> float:
    """What each curve is; returns where the next line may stand."""
    room = ink.width - x - 7.5
    for loop, style in zip(loops, STYLES, strict=False):
        ink.line((x, y), (x + 6.0, y), **style)
        direction, _, place = loop.place.partition(", ")
        ink.text(x + 7.5, y, fitted(f"{loop.case}, {direction}", room))
        ink.text(x + 7.5, y + _ROW, fitted(place, room), color=GREY)
        y += 2 * _ROW + 0.6
    return y


def _words(ink: Ink, x: float, top: float, bottom: float, words: Words) -> float:
    """Lines of words that end at the foot of a frame, or begin at `top` where that is lower."""
    y = max(top, bottom - 1.5 - _ROW * (len(words) - 1))
    for line, color in words:
        ink.text(x, y, fitted(line, ink.width - x), color=color)
        y += _ROW
    return y


def _required(rows: Sequence[Requirement], say: Callable[[float], str]) -> Words:
    return [(f"required {SENSES[row.sense]} {say(row.limit)}", RED) for row in rows]


def _margin(ratio: float) -> str:
    return f"{number(ratio, 4)} ({_signed(decibels(ratio))} dB)"


def _signed(value: float) -> str:
    return f"{value:.1f}".replace("-", MINUS)


def _gain_words(loops: Sequence[LoopStudy], required: Sequence[Requirement]) -> Words:
    one = loops[governing(loops, "gain_margin")]
    if one.gain_margin == math.inf:
        return [("no gain makes it swing", BLACK), *_required(required, trimmed)]
    found = [(f"gain margin {_margin(one.gain_margin)}", BLACK)]
    if one.gain_margin <= 0:
        found = [("unstable at any gain", RED)]
    elif one.gain_margin < 1:
        found.append(("the closed loop swings", RED))
    if one.ultimate_frequency > 0:
        found.append((f"at {number(one.ultimate_frequency)} Hz", GREY))
    return [*found, *_required(required, trimmed)]


def _phase_words(loops: Sequence[LoopStudy], required: Sequence[Requirement]) -> Words:
    one = loops[governing(loops, "phase_margin")]

    def say(angle: float) -> str:
        return f"{trimmed(math.degrees(angle))}°"

    if one.crossover is None or math.isnan(one.phase_margin):
        return [("the magnitude stays off 0 dB", BLACK), *_required(required, say)]
    found = [
        (f"phase margin {number(math.degrees(one.phase_margin))}°", BLACK),
        (f"at {number(one.crossover)} Hz", GREY),
    ]
    return found + _required(required, say)


def _bandwidth_words(loops: Sequence[LoopStudy], required: Sequence[Requirement]) -> Words:
    one = loops[governing(loops, "bandwidth")]
    value = "none" if one.bandwidth is None else f"{number(one.bandwidth)} Hz"
    words = [(f"bandwidth (least) {value}", BLACK), (f"at {MINUS}3 dB, dashed", GREY)]
    if loops[governing(loops, "gain_margin")].gain_margin < 1:
        words.insert(0, ("the loop swings: not its response", RED))
    return words + _required(required, lambda limit: f"{trimmed(limit)} Hz")
