"""Figures of an Identification as ink: over time, over velocity, damping, residuals.

Curves differ in dash as well as in colour. Where something has no value its frame says why.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..design.material_fits import Fit
from ..identification.lugre_fit import LuGreFit
from ..identification.points import Point
from ..identification.result import Identification
from ..identification.stribeck_fit import StribeckFit
from ..rendering.axes import (
    Axes,
    Box,
    band,
    dot,
    empty,
    error_bar,
    even_range,
    even_ticks,
    legend,
    log_range,
    log_ticks,
    reason,
    spaced,
)
from ..rendering.ink import BLUE, GREY, Ink, spread_within
from ..rendering.text import bars, number, sentence, unit_text
from .identification_axes import IN, OUT, SURE, Velocities, ways
from .identification_map import map_panel, pressure_levels
from .identification_rows import FORCE, SPEED
from .identification_series import LINE, loop, strips
from .wall_figures import GREEN, OCHRE

WIDTH = 180.0
LEAST, MOST = 70.0, 140.0
"""Heights of the whole figure [mm]."""
_CURVE: dict[str, Any] = {"stroke": BLUE, "pen": 0.4}
_OTHER: dict[str, Any] = {"stroke": OCHRE, "pen": 0.4, "dash": (1.6, 0.8)}
_LUGRE: dict[str, Any] = {"stroke": GREEN, "pen": 0.35, "dash": (0.8, 0.5)}
_ZERO: dict[str, Any] = {"stroke": GREY, "pen": 0.18}
_MISFIT: dict[str, Any] = {"stroke": GREEN, "pen": 0.25, "dash": (1.2, 0.8)}
_NAMES = {"power_law": "power law", "double_exponential": "double exp."}
FIT_STYLES = {"power_law": _CURVE, "double_exponential": _OTHER}


def identification_figure(found: Identification, height: float = MOST) -> Ink:
    """All figures of an identification in one drawing of a stated height [mm]."""
    height = min(max(height, LEAST), MOST)
    ink = Ink(WIDTH, height)
    strips(ink, (10.0, 0.0, 45.0, height), found)
    _friction_column(ink, (68.0, 9.5, 52.0, height - 18.0), found)
    _damping_column(ink, (133.0, 9.5, 46.0, height - 18.0), found)
    return ink


# ---- friction over velocity ----


def _friction_column(ink: Ink, box: Box, found: Identification) -> None:
    """Friction over velocity above its residuals; without a curve beside the loop over position."""
    left, top, width, tall = box
    if isinstance(found.stribeck, StribeckFit):
        residual = max(0.22 * tall, 9.0)
        upper = (left, top, width, tall - residual - 6.5)
        axis = _friction_panel(ink, upper, found, found.stribeck)
        lower = (left, top + tall - residual, width, residual)
        _residual_panel(ink, lower, found, found.stribeck, axis)
        return
    said = sentence(f"no Stribeck curve: {found.stribeck}")
    title = f"Friction, {unit_text(FORCE.unit)}"
    ink.text(left - 1.4, top - 5.0, title, size=7.0, bold=True)
    left, top, width, tall = reason(ink, (left, top - 1.0, width, tall + 1.0), said)
    top, tall = top + 1.5, tall - 1.5
    if found.points:
        half = (width - 13.0) / 2
        _points_panel(ink, (left, top, half, tall), found)
        left, width = left + half + 13.0, half
    _loop_panel(ink, (left, top, width, tall), found)


def _friction_panel(ink: Ink, box: Box, found: Identification, fit: StribeckFit) -> Velocities:
    """Points with their 95 % bars, the curve with its band, F_C and F_S of the LuGre model."""
    axis = Velocities([SPEED.to_display(one.velocity) for one in found.points])
    curves = _stribeck_curves(found.points, fit, axis)
    ends = [one.friction + side * SURE * one.error for one in found.points for side in (-1, 1)]
    least = abs(axis.at(axis.low))  # towards rest the curve may leave the frame: nothing is seen
    for xs, _, middle, _, _, _ in curves:
        ends += [v for x, v in zip(xs, middle, strict=True) if abs(x) >= least]
    marks = _level_marks(found.lugre, axis)
    axes = Axes(ink, box, axis.range, even_range([*ends, *(f for f, _, _ in marks)], zero=True))
    for xs, _, _, low, high, _ in curves:
        band(axes, xs, low, high)
    title = f"Friction over velocity, {unit_text(FORCE.unit)}"
    axes.frame_at("", "", axis.ticks(axes), even_ticks(*axes.y_range, 4), upright=True)
    ink.text(box[0] - 1.4, box[1] - 6.2, title, size=7.0, bold=True)
    _cross_lines(axes)
    names: dict[str, dict[str, Any]] = {}
    for xs, words, middle, _, _, style in curves:
        ink.path(axes.clipped(xs, middle), **style)
        names[words] = style
    _draw_levels(axes, marks)
    for one in found.points:
        x, style = axis.at(SPEED.to_display(one.velocity)), OUT if one.velocity > 0 else IN
        error_bar(axes, x, one.friction - SURE * one.error, one.friction + SURE * one.error,
                  style["color"])  # fmt: skip
        dot(axes, x, one.friction, **style)
    legend(ink, box[0] + box[2], box[1] - 2.4, list(names.items()))
    return axis


def _stribeck_curves(
    points: Sequence[Point], fit: StribeckFit, axis: Velocities
) -> list[tuple[list[float], str, list[float], list[float], list[float], dict[str, Any]]]:
    """Curves with bounds by way: at the mean pressure, or at the ends where pressure matters."""
    levels = [(fit.reference_pressure, "Stribeck curve, 95 % band", _CURVE)]
    if "pressure_slope" in fit.parameters:
        ends = [min(one.pressure for one in points), max(one.pressure for one in points)]
        styles = (_CURVE, _OTHER)
        names = [bars(1e5 * round(p / 1e5)) for p in ends]
        names[1] += "; bands 95 %"
        levels = list(zip(ends, names, styles, strict=True))
    found = []
    for level, words, style in levels:
        for way in axis.ways:
            shown = way * axis.curve()
            speed = shown / SPEED.to_display(1.0)
            low, high = fit.bounds(speed, np.full(speed.shape, level))
            middle = fit.predict(speed, np.full(speed.shape, level))
            xs = [axis.at(float(v)) for v in shown]
            lists = [[float(v) for v in one] for one in (middle, low, high)]
            found.append((xs, words, lists[0], lists[1], lists[2], style))
    return found


def _level_marks(lugre: LuGreFit | str, axis: Velocities) -> list[tuple[float, str, int]]:
    """F_C and F_S of the LuGre model: force, name, way."""
    if isinstance(lugre, str):
        return []
    values = lugre.values
    names = [("coulomb", "F_C"), ("static", "F_S")]
    offset = values.get("offset", 0.0)
    return [
        (way * values[name] + offset, words, way)
        for name, words in names
        if name in lugre.parameters
        for way in axis.ways
    ]


def _draw_levels(axes: Axes, marks: Sequence[tuple[float, str, int]]) -> None:
    """Short lines at rest, named on the side where no curve runs."""
    zero = axes.x(0.0)
    for way in (1, -1):
        here = sorted((one for one in marks if one[2] == way), key=lambda one: -one[0])
        wanted = [axes.y(level) for level, _, _ in here]
        low, high = axes.top + 1.2, axes.top + axes.height - 1.2
        places = spread_within(wanted, [2.8] * len(here), low, high)
        both = axes.x_range[0] < 0 < axes.x_range[1]
        for (_, words, _), y, at in zip(here, wanted, places, strict=True):
            axes.ink.line((zero, y), (zero + way * 3.2, y), **_LUGRE)
            side = -way if both else way
            x = zero + side * (1.2 if both else 4.0)
            anchor: Any = "left" if side > 0 else "right"
            axes.ink.text(x, at, words, size=6.0, anchor=anchor, color=GREEN, halo=not both)


def _cross_lines(axes: Axes) -> None:
    """Lines at rest and at no force, where they lie inside."""
    (left, right), (bottom, top) = axes.x_range, axes.y_range
    if bottom < 0 < top:
        axes.ink.line((axes.x(left), axes.y(0.0)), (axes.x(right), axes.y(0.0)), **_ZERO)
    if left < 0 < right:
        axes.ink.line((axes.x(0.0), axes.y(bottom)), (axes.x(0.0), axes.y(top)), **_ZERO)


def _residual_panel(
    ink: Ink, box: Box, found: Identification, fit: StribeckFit, axis: Velocities
) -> None:
    """Measured less fitted friction of every point; the scatter about the LuGre model in lines."""
    bars95 = [SURE * float(e) for e in fit.errors]
    residuals = [float(r) for r in fit.residuals]
    largest = max([abs(r) + e for r, e in zip(residuals, bars95, strict=True)] + [1e-9])
    misfit = None if isinstance(found.lugre, str) else found.lugre.misfit
    near = misfit is not None and misfit < 4 * largest
    if near and misfit is not None:
        largest = max(largest, misfit)
    axes = Axes(ink, box, axis.range, (-1.15 * largest, 1.15 * largest))
    words = f"velocity, {unit_text(SPEED.unit)}, outwards positive"
    axes.frame_at("", words, axis.ticks(axes), even_ticks(*axes.y_range, 2), upright=True)
    _cross_lines(axes)
    title = f"Residual, {unit_text(FORCE.unit)}"
    ink.text(box[0] - 1.4, box[1] - 2.4, title, size=6.5, bold=True)
    if misfit is not None:
        said = f"LuGre windows ±{number(misfit, 3)} N"
        if near:
            for level in (-misfit, misfit):
                right = box[0] + box[2]
                ink.line((box[0], axes.y(level)), (right, axes.y(level)), **_MISFIT)
            legend(ink, box[0] + box[2], box[1] - 2.4, [(said, _MISFIT)])
        else:
            ink.text(box[0] + box[2], box[1] - 2.4, said, anchor="right", color=GREEN)
    for one, residual, half in zip(found.points, residuals, bars95, strict=True):
        x, style = axis.at(SPEED.to_display(one.velocity)), OUT if one.velocity > 0 else IN
        error_bar(axes, x, residual - half, residual + half, style["color"])
        dot(axes, x, residual, **style)


def _points_panel(ink: Ink, box: Box, found: Identification) -> None:
    """Points over velocity without a curve."""
    axis = Velocities([SPEED.to_display(one.velocity) for one in found.points])
    ends = [one.friction + side * SURE * one.error for one in found.points for side in (-1, 1)]
    axes = Axes(ink, box, axis.range, even_range(ends, zero=True))
    words = f"velocity, {unit_text(SPEED.unit)}"
    axes.frame_at("", words, axis.ticks(axes), even_ticks(*axes.y_range, 4), upright=True)
    _cross_lines(axes)
    for one in found.points:
        x, style = axis.at(SPEED.to_display(one.velocity)), OUT if one.velocity > 0 else IN
        error_bar(axes, x, one.friction - SURE * one.error, one.friction + SURE * one.error,
                  style["color"])  # fmt: skip
        dot(axes, x, one.friction, **style)


def _loop_panel(ink: Ink, box: Box, found: Identification) -> None:
    """Friction over position, with F_C of the LuGre model."""
    lines = loop(found)
    xs, ys = zip(*[one for line in lines for one in line], strict=True)
    axes = Axes(ink, box, even_range(xs), even_range(ys, zero=True))
    levels = []
    if isinstance(found.lugre, LuGreFit) and "coulomb" in found.lugre.parameters:
        values = found.lugre.values
        levels = [way * values["coulomb"] + values.get("offset", 0.0) for way in (1, -1)]
        axes.y_range = even_range([*ys, *levels], zero=True)
    marks = spaced([(v, w, 1) for v, w in even_ticks(*axes.x_range, 4)], axes)
    axes.frame_at("", "position, mm", marks, even_ticks(*axes.y_range, 4), upright=True)
    _cross_lines(axes)
    for line in lines:
        ink.path(axes.clipped([x for x, _ in line], [y for _, y in line]), **LINE)
    right = box[0] + box[2]
    for level in levels:
        y = axes.y(level)
        ink.line((box[0], y), (right, y), **_LUGRE)
    if levels:
        legend(ink, right, box[1] - 2.0, [("±F_C of the LuGre model", _LUGRE)])


# ---- secant damping ----


def _damping_column(ink: Ink, box: Box, found: Identification) -> None:
    """Secant damping: a map over speed and pressure, or curves above what they leave."""
    left, top, width, tall = box
    title = "Secant damping F/v, kN·s/m"
    usable = [one for one in found.points if one.damping > 0]
    if not usable:
        why = "No point of steady sliding with friction against motion: no secant damping."
        empty(ink, (left, top, width, tall), title, why)
        return
    if pressure_levels(usable):
        map_panel(ink, (left, top + 3.4, width - 13.0, tall - 3.4), title, usable, found.stribeck)
        return
    fits = {name: fit for name, fit in found.fits.items() if isinstance(fit, Fit)}
    ink.text(left - 1.4, top - 6.2, title, size=7.0, bold=True)
    if not fits:
        why = sentence(f"no fit: {next(iter(found.fits.values()), 'none was tried')}")
        left, top, width, tall = reason(ink, (left, top - 1.0, width, tall + 1.0), why)
        top, tall = top + 1.0, tall - 1.0
    names = [(_NAMES.get(name, name), FIT_STYLES.get(name, _LUGRE)) for name in fits]
    ways(ink, left, top - 2.2, found.points)
    top, tall = top + 3.4, tall - 3.4
    legend(ink, left + width, top - 2.4, names)
    residual = max(0.22 * tall, 9.0) if fits else 0.0
    upper = (left, top, width, tall - residual - (6.5 if fits else 0.0))
    across = log_range([SPEED.to_display(one.speed) for one in usable])
    _damping_panel(ink, upper, usable, fits, across)
    if fits:
        _ratio_panel(ink, (left, top + tall - residual, width, residual), usable, fits, across)


def _damping_panel(
    ink: Ink, box: Box, points: Sequence[Point], fits: dict[str, Fit], across: tuple[float, float]
) -> None:
    """Points with their bars and the fits over speed, both logarithmic."""
    values = [one.damping / 1e3 for one in points]
    axes = Axes(ink, box, across, log_range(values))
    axes.frame_at(
        "",
        "" if fits else "speed, mm/s",
        _log_ticks(axes),
        log_ticks(*axes.y_range),
        upright=True,
    )
    lowest, highest = (f(one.speed for one in points) for f in (min, max))
    speeds = np.geomspace(lowest, highest, 90)
    for name, fit in fits.items():
        damping = np.asarray(fit.predict(speeds)) / 1e3
        drawn = [(math.log10(1e3 * v), math.log10(b)) for v, b in zip(speeds, damping, strict=True)
                 if b > 0 and math.isfinite(b)]  # fmt: skip
        if len(drawn) > 1:
            xs, ys = zip(*drawn, strict=True)
            ink.path(axes.clipped(xs, ys), **FIT_STYLES.get(name, _LUGRE))
    for one in points:
        half = SURE * one.error / one.speed
        low, high = (max(one.damping + s * half, 1e-12) / 1e3 for s in (-1, 1))
        x = math.log10(SPEED.to_display(one.speed))
        style = OUT if one.velocity > 0 else IN
        error_bar(axes, x, math.log10(low), math.log10(high), style["color"])
        dot(axes, x, math.log10(one.damping / 1e3), **style)


def _log_ticks(axes: Axes) -> Sequence[tuple[float, str]]:
    """Ticks of a logarithmic x axis that have room."""
    found = log_ticks(*axes.x_range)
    return spaced([(v, w, int(abs(v - round(v)) > 1e-9)) for v, w in found], axes)


def _ratio_panel(
    ink: Ink, box: Box, points: Sequence[Point], fits: dict[str, Fit], across: tuple[float, float]
) -> None:
    """Measured over fitted damping less one, per cent."""
    rows = []
    for name, fit in fits.items():
        fitted_ = np.asarray(fit.predict(np.array([one.speed for one in points])))
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = 100 * (np.array([one.damping for one in points]) / fitted_ - 1)
        rows.append((name, [float(r) for r in ratio]))
    sizes = [abs(r) for _, one in rows for r in one if math.isfinite(r)]
    top = 1.2 * max([*sizes, 1e-3])
    axes = Axes(ink, box, across, (-top, top))
    marks = even_ticks(-top, top, 2)
    axes.frame_at("", "speed, mm/s", _log_ticks(axes), marks, upright=True)
    axes.ink.line((box[0], axes.y(0.0)), (box[0] + box[2], axes.y(0.0)), **_ZERO)
    ink.text(box[0] - 1.4, box[1] - 2.4, "Residual, % of the fit", size=6.5, bold=True)
    for name, one in rows:
        color = FIT_STYLES.get(name, _LUGRE)["stroke"]
        for point, value in zip(points, one, strict=True):
            x = math.log10(SPEED.to_display(point.speed))
            if math.isfinite(value):
                _mark(axes, x, value, color, round_=name == "power_law")


def _mark(axes: Axes, x: float, y: float, color: str, *, round_: bool) -> None:
    """A small filled circle, or a cross."""
    at, level = axes.x(x), axes.y(y)
    if round_:
        axes.ink.circle(at, level, 0.6, fill=color, stroke=None)
        return
    for side in (-0.7, 0.7):
        axes.ink.line((at - 0.7, level - side), (at + 0.7, level + side), pen=0.25, stroke=color)
