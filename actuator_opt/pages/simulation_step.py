"""The step of a servo enlarged: rise, overshoot and settling where they are read."""

from __future__ import annotations

import numpy as np

from ..base.numeric import Array
from ..rendering.axes import Axes, Box, even_ticks
from ..rendering.ink import BLACK, Ink, text_width
from ..rendering.text import number
from ..simulation.loops import LOOPS
from ..simulation.result import Servo, Simulation
from ..simulation.step_response import BAND
from .simulation_axes import ASKED, SIZE, STYLES, lines, names, steady_range, time_axis
from .simulation_series import Measured, overlay, scaled, titled
from .wall_figures import OCHRE

LEAST_SHOWN = 0.01
"""Overshoot from which on it is marked, share of the step: less is in the width of the band."""
ROOM = 4.6
"""Room of a line of words beyond the peak [mm]."""
_BAND = "#e8eef2"
_MARK = {"stroke": OCHRE, "pen": 0.18}


def end_of(found: Simulation, servo: Servo) -> float:
    """When the reference changes again, or the run ends [s]."""
    asked = found.signals["reference"]
    size = abs(servo.target - servo.start)
    later = (found.time > servo.time) & (np.abs(asked - servo.target) > 1e-9 * size)
    return float(found.time[later][0]) if np.any(later) else float(found.time[-1])


def window(found: Simulation, servo: Servo) -> tuple[float, float]:
    """The times that show how the step settles [s]."""
    end = end_of(found, servo)
    own = servo.metrics
    span = end - servo.time
    if own.settling_time is not None:
        wanted = 1.6 * own.settling_time
        wanted = max(wanted, 4.0 * (own.rise_time or 0.0), 0.02 * span)
        span = min(span, wanted)
    return max(servo.time - 0.08 * span, 0.0), servo.time + span


def step_panel(ink: Ink, box: Box, found: Simulation, measured: Measured) -> None:
    """The response about its step, with the band, 10 to 90 %, the peak and the settling."""
    servo = found.servo
    if servo is None:
        return
    left, top, width, height = box
    words, quantity, *_ = LOOPS[servo.loop]
    begin, end = window(found, servo)
    scale = quantity.to_display(1.0)
    start, target = scale * servo.start, scale * servo.target
    size = target - start
    frame = (left + 11.0, top + 6.5, width - 14.0, height - 14.0)
    values = scaled(quantity, found.signals[servo.loop])
    inside = (found.time >= begin) & (found.time <= end)
    under = overlay(found, servo.loop, measured)
    ends = [start, target, float(np.min(values[inside])), float(np.max(values[inside]))]
    low, high = steady_range(ends)
    spare = max(0.06, ROOM / max(frame[3] - ROOM, ROOM)) * (high - low)
    low, high = (low, high + spare) if size > 0 else (low - spare, high)
    axes = Axes(ink, frame, (begin - servo.time, end - servo.time), (low, high))
    time = found.time - servo.time
    half = BAND * abs(size)
    upper, lower = axes.y(target + half), axes.y(target - half)
    ink.box(frame[0], upper, frame[2], lower - upper, fill=_BAND, stroke=None)
    axes.frame_at("", "", [], even_ticks(low, high, 5))
    title = titled(f"Step of {words}" if under else f"Step of the {words}", quantity)
    ink.text(left, top + 2.0, title, size=7.0, bold=True)
    ink.path(lines(axes, time, scaled(quantity, found.signals["reference"])), **ASKED)
    for one in under:
        ink.path(lines(axes, one.time - servo.time, one.values), **one.style)
    style = STYLES[0] | {"pen": 0.4}
    ink.path(lines(axes, time, values), **style)
    entries = [("measured", under[0].style)] if under else []
    entries += [("±2 %", {"stroke": _BAND, "pen": 1.6}), ("asked", ASKED)]
    room = width - text_width(title, 7.0, bold=True) - 2.0
    names(ink, left + width, top + 2.0, entries, room)
    _rise(axes, servo, time, (values - start) / size, start, size)
    _settled(axes, servo, start, size)
    _peak(axes, servo, scale, target, size)
    time_axis(axes, "time after the step")


def _words(axes: Axes, x: float, y: float, words: str) -> None:
    """Words to the right of a place, or to its left where there is no room."""
    wide = text_width(words, SIZE)
    right = axes.left + axes.width
    if x + 1.0 + wide <= right - 0.5:
        axes.ink.text(x + 1.0, y, words, size=SIZE, color=OCHRE, halo=True)
    else:
        at = max(x - 1.0, axes.left + wide + 0.5)
        axes.ink.text(at, y, words, size=SIZE, anchor="right", color=OCHRE, halo=True)


def _rise(axes: Axes, servo: Servo, time: Array, done: Array, start: float, size: float) -> None:
    """From 10 to 90 %: the time between, at the lower level."""
    rise = servo.metrics.rise_time
    if rise is None:
        return
    late = np.flatnonzero((time > 0) & (done >= 0.9))
    if not late.size:
        return
    right = axes.x(float(time[late[0]]))
    left = axes.x(float(time[late[0]]) - rise)
    low, high = (axes.y(start + share * size) for share in (0.1, 0.9))
    axes.ink.line((left, low), (right, low), (right, high), **_MARK)
    for y in (low, high):
        axes.ink.circle(left if y == low else right, y, 0.5, fill=OCHRE, stroke=None)
    _words(axes, right, low, f"rise {number(1e3 * rise, 3)} ms")


def _settled(axes: Axes, servo: Servo, start: float, size: float) -> None:
    """The last time outside the band."""
    settling = servo.metrics.settling_time
    level = axes.y(start + 0.4 * size)
    if settling is None:
        x = axes.left + axes.width - 1.0
        words = "does not settle within 2 %"
        axes.ink.text(x, level, words, size=SIZE, anchor="right", color=OCHRE, halo=True)
        return
    x = axes.x(settling)
    if axes.left <= x <= axes.left + axes.width:
        end = axes.y(start + size)
        axes.ink.line((x, axes.y(start + 0.34 * size)), (x, end), **_MARK | {"dash": (1.0, 0.6)})
        _words(axes, x, level, f"settled {number(1e3 * settling, 3)} ms")


def _peak(axes: Axes, servo: Servo, scale: float, target: float, size: float) -> None:
    """The overshoot at its peak."""
    own = servo.metrics
    if own.overshoot < LEAST_SHOWN:
        return
    x, y = axes.x(own.peak_time), axes.y(scale * own.peak)
    if not axes.left <= x <= axes.left + axes.width:
        return
    axes.ink.line((x, y), (x, axes.y(target)), **_MARK | {"stroke": BLACK})
    axes.ink.circle(x, y, 0.6, fill=OCHRE, stroke=None)
    away = -2.2 if size > 0 else 2.2
    _words(axes, x, y + away, f"overshoot {number(100 * own.overshoot, 3)} %")
