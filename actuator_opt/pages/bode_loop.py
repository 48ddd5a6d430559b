"""The position loop as ink: open loop with its margins, closed loop with its bandwidth."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from ..evaluation.dynamics_study import DynamicsStudy, LoopStudy
from ..evaluation.result import Requirement
from ..rendering.axes import Axes, Ticks, dot, fitted, level_ticks
from ..rendering.ink import BLACK, GREY, RED, WHITE, Ink
from ..rendering.text import MINUS, SENSES, number, trimmed
from .bode import LIMIT, STATIC, STYLES, degrees, frequency_axis, inside, limit_mark

HALF_POWER = -10 * math.log10(2.0)
"""-3 dB, where a closed loop's bandwidth ends."""
_ROW = 3.5
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
    _magnitude_panel(ink, first, xs, across, loops, limits.gain_margin)
    _phase_panel(ink, second, xs, across, loops, limits.phase_margin)
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


def _magnitude_panel(
    ink: Ink,
    box: tuple[float, float, float, float],
    xs: Sequence[float],
    across: tuple[float, float],
    loops: Sequence[LoopStudy],
    required: Sequence[Requirement],
) -> None:
    rows = [[decibels(float(v)) for v in one.open_magnitude] for one in loops]
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


def _phase_panel(
    ink: Ink,
    box: tuple[float, float, float, float],
    xs: Sequence[float],
    across: tuple[float, float],
    loops: Sequence[LoopStudy],
    required: Sequence[Requirement],
) -> None:
    rows = [[math.degrees(float(p)) for p in one.open_phase] for one in loops]
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
    rows = [[decibels(float(v)) for v in one.closed_magnitude] for one in loops]
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
    for one, style in zip(loops, STYLES, strict=False):
        if one.bandwidth is not None and inside(axes, math.log10(one.bandwidth)):
            dot(axes, math.log10(one.bandwidth), HALF_POWER, style["stroke"])


# ---- words beside the frames ----

Words = list[tuple[str, str]]


def _names(ink: Ink, x: float, y: float, loops: Sequence[LoopStudy]) -> float:
    """What each curve is; returns where the next line may stand."""
    room = ink.width - x - 7.5
    for one, style in zip(loops, STYLES, strict=False):
        ink.line((x, y), (x + 6.0, y), **style)
        direction, _, place = one.place.partition(", ")
        ink.text(x + 7.5, y, fitted(f"{one.case}, {direction}", room))
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
