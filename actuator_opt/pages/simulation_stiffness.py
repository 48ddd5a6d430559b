"""Dynamic stiffness of a Simulation as ink: size and phase along the stroke, last cycles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..base.fitting import NORMAL
from ..base.numeric import Array
from ..base.quantities import RESULTS
from ..rendering.axes import Axes, Box, band, error_bar, even_ticks, required
from ..rendering.ink import BLUE, WHITE, Ink, text_width
from ..rendering.text import SENSES, trimmed
from ..simulation.harmonic import harmonic_fit
from ..simulation.result import HarmonicLoad, Simulation, Window
from .simulation_axes import ASKED, LEVEL, STYLES, ZERO, names, steady_range, x_axis

STIFFNESS, PHASE = RESULTS["dynamic_stiffness"], RESULTS["dynamic_phase"]
MOVED = 0.02
"""Share of the stroke over which windows must spread to be shown along it (a choice)."""
MOST_MARKS = 40
"""Windows that are shown as marks with bars; more become a line with a band."""
CYCLES = 3
"""Cycles of the loop that are drawn."""
Static = tuple[Array, Array]
"""Positions [m] and static stiffness there [N/m]."""
Limits = Sequence[tuple[str, float]]
"""Senses and limits (SI)."""


@dataclass(frozen=True, slots=True)
class StrokeProfile:
    """Windows of one run as they are drawn: place, size and phase with their errors, by style."""

    words: str
    place: list[float]
    size: list[float]
    size_error: list[float]
    phase: list[float]
    phase_error: list[float]
    style: dict[str, Any]


def travelled(windows: Sequence[Window], stroke: float) -> bool:
    """Whether windows lie along the stroke, or all at one place."""
    places = [one.position for one in windows]
    return max(places) - min(places) > MOVED * stroke


def along(words: str, shaken: HarmonicLoad, over: str, style: dict[str, Any]) -> StrokeProfile:
    """Windows over the stroke (mm) or over time (s), in kN/mm and degrees.

    An error of the stiffness turns it by the same share at most: that is the phase's.
    """
    order = sorted(shaken.windows, key=lambda one: one.position if over == "stroke" else one.time)
    place = [1e3 * one.position if over == "stroke" else one.time for one in order]
    size = [abs(one.stiffness) for one in order]
    errors = [NORMAL * one.standard_error for one in order]
    turn = PHASE.to_display(1.0)
    phases = np.unwrap([float(np.angle(one.stiffness)) for one in order])
    scale = STIFFNESS.to_display(1.0)
    return StrokeProfile(
        words,
        place,
        [scale * k for k in size],
        [scale * e for e in errors],
        [turn * float(p) for p in phases],
        [turn * min(e / k, math.pi) if k > 0 else 180.0 for e, k in zip(errors, size, strict=True)],
        style,
    )


def limits_of(found: Simulation, metric: str) -> Limits:
    """Limits of a scenario on a result."""
    return [(row.sense, row.limit) for row in found.requirements if row.metric == metric]


def stiffness_panels(
    ink: Ink,
    boxes: tuple[Box, Box],
    runs: Sequence[StrokeProfile],
    over: str,
    *,
    static: Static | None = None,
    limits: tuple[Limits, Limits] = ((), ()),
    side: float = 3.0,
) -> None:
    """Size (first box) and phase (second box) of several runs; `side` is the room for limits."""
    across = _across(runs)
    xs = "position from the cap end, mm" if over == "stroke" else "time, s"
    size_box, phase_box = boxes
    shared = phase_box[0] == size_box[0] and phase_box[1] > size_box[1]
    named = [(one.words, one.style) for one in runs if one.words]
    curve = _static_curve(static, over)
    if curve is not None:
        named.append(("static", LEVEL))
    _panel(
        ink, size_box, f"Dynamic stiffness, {STIFFNESS.unit}", "" if shared else xs, across,
        [(one.place, one.size, one.size_error, one.style) for one in runs],
        curve, [(s, STIFFNESS.to_display(v)) for s, v in limits[0]], named, side,
    )  # fmt: skip
    _panel(
        ink, phase_box, "Phase of the force, °", xs, across,
        [(one.place, one.phase, one.phase_error, one.style) for one in runs],
        None, [(s, PHASE.to_display(v)) for s, v in limits[1]], [], side,
    )  # fmt: skip


def _across(runs: Sequence[StrokeProfile]) -> tuple[float, float]:
    places = [x for one in runs for x in one.place]
    low, high = min(places), max(places)
    spare = 0.04 * (high - low) or 0.5
    return low - spare, high + spare


def _static_curve(static: Static | None, over: str) -> tuple[Array, Array] | None:
    if static is None or over != "stroke":
        return None
    place, stiffness = (np.asarray(one, dtype=float) for one in static)
    return 1e3 * place, STIFFNESS.to_display(1.0) * stiffness


Series = tuple[list[float], list[float], list[float], dict[str, Any]]


def _panel(
    ink: Ink,
    box: Box,
    title: str,
    x_words: str,
    across: tuple[float, float],
    series: Sequence[Series],
    static: tuple[Array, Array] | None,
    limits: Limits,
    named: Sequence[tuple[str, dict[str, Any]]],
    side: float,
) -> None:
    left, top, width, height = box
    below = 7.5 if x_words else 1.0
    frame = (left + 11.0, top + 6.5, width - 11.0 - side, height - 6.5 - below)
    ends = _ends(series)
    if static is not None:
        inside = (static[0] >= across[0]) & (static[0] <= across[1])
        ends += [float(v) for v in static[1][inside & np.isfinite(static[1])]]
    near = [v for _, v in limits if v <= 2 * max(map(abs, ends))]
    axes = Axes(ink, frame, across, steady_range([*ends, *near]))
    low, high = axes.y_range
    axes.frame_at("", "", [], even_ticks(low, high, 4 if height > 30 else 3))
    ink.text(left, top + 2.0, title, size=7.0, bold=True)
    names(ink, left + width, top + 2.0, named, width - text_width(title, 7.0, bold=True) - 2.0)
    if low < 0 < high:
        ink.line((frame[0], axes.y(0.0)), (frame[0] + frame[2], axes.y(0.0)), **ZERO)
    if static is not None:
        known = np.isfinite(static[1]) & (static[0] >= across[0]) & (static[0] <= across[1])
        xs, ys = ([float(v) for v in one[known]] for one in static)
        ink.path(axes.clipped(xs, ys), **LEVEL)
    for sense, limit in limits:
        required(axes, limit, f"{SENSES[sense]} {trimmed(limit)}")
    for xs, ys, errors, style in series:
        _drawn(axes, xs, ys, errors, style, alone=len(series) == 1)
    x_axis(axes, x_words)


def _ends(series: Sequence[Series]) -> list[float]:
    """Values, and their bars as far as these do not hide how the values differ."""
    values = [y for _, ys, _, _ in series for y in ys]
    errors = [e for _, _, es, _ in series for e in es]
    low, high = min(values), max(values)
    most = max(0.5 * (high - low), 3.0 * float(np.median(errors)), 1e-6 * max(abs(low), abs(high)))
    bars = [y + way * e for y, e in zip(values, errors, strict=True) for way in (-1, 1)]
    return [min(max(v, low - most), high + most) for v in (*values, *bars)]


def _drawn(
    axes: Axes,
    xs: list[float],
    ys: list[float],
    errors: list[float],
    style: dict[str, Any],
    *,
    alone: bool,
) -> None:
    """Marks with bars, or a line where there are many; a band where it is alone."""
    colour = style["stroke"]
    if len(xs) > MOST_MARKS:
        if alone:
            band(axes, xs, [y - e for y, e in zip(ys, errors, strict=True)],
                 [y + e for y, e in zip(ys, errors, strict=True)])  # fmt: skip
        axes.ink.path(axes.clipped(xs, ys), **style)
        return
    if not alone:
        axes.ink.path(axes.clipped(xs, ys), **style)
    for x, y, error in zip(xs, ys, errors, strict=True):
        error_bar(axes, x, y - error, y + error, colour)
        axes.ink.circle(axes.x(x), axes.y(y), 0.6, fill=WHITE, stroke=colour, pen=0.25)


# ---- the last cycles ----


def loop_panel(ink: Ink, box: Box, found: Simulation) -> None:
    """Force over position in the last cycles, without drift, and the fitted ellipse."""
    shaken = found.shaken
    if shaken is None:
        return
    left, top, width, height = box
    last = shaken.windows[-1]
    half = min(CYCLES, found.scenario.analysis.window_cycles) / shaken.frequency / 2
    time, at = np.unique(found.time, return_index=True)
    inside = (time >= last.time - half) & (time <= last.time + half)
    if np.count_nonzero(inside) < 8:
        return
    t = time[inside]
    x, force = (found.signals[name][at][inside] for name in ("position", "load_force"))
    swing = [harmonic_fit(time=t, values=v, frequency=shaken.frequency) for v in (x, -force)]
    drawn_x, drawn_f = (
        v - one.mean - one.slope * (t - t.mean()) for v, one in zip((x, -force), swing, strict=True)
    )
    turn = np.exp(1j * np.linspace(0.0, 2 * np.pi, 90))
    fitted_x = np.real(swing[0].amplitude * turn)
    fitted_f = np.real(last.stiffness * swing[0].amplitude * turn)
    x_scale = _micro(float(np.max(np.abs(drawn_x))))
    unit, factor = x_scale
    frame = (left + 11.0, top + 6.5, width - 14.0, height - 14.0)
    across = steady_range([float(factor * v) for one in (drawn_x, fitted_x) for v in one])
    upwards = steady_range([float(v) for one in (drawn_f, fitted_f) for v in one])
    axes = Axes(ink, frame, across, upwards)
    axes.frame_at("", "", [], even_ticks(*upwards, 4))
    title = "Last cycles: force, N"
    ink.text(left, top + 2.0, title, size=7.0, bold=True)
    room = width - text_width(title, 7.0, bold=True) - 2.0
    names(ink, left + width, top + 2.0, [("run", STYLES[0]), ("fit", ASKED)], room)
    for xs, ys, style in (
        (factor * drawn_x, drawn_f, {"stroke": BLUE, "pen": 0.25}),
        (factor * fitted_x, fitted_f, ASKED),
    ):
        ink.path(axes.clipped([float(v) for v in xs], [float(v) for v in ys]), **style)
    x_axis(axes, f"position about its mean, {unit}")


def _micro(size: float) -> tuple[str, float]:
    """Unit in which a swing has whole numbers.

    >>> _micro(4e-5), _micro(2e-3)
    (('µm', 1000000.0), ('mm', 1000.0))
    """
    return ("µm", 1e6) if size < 5e-4 else ("mm", 1e3)
