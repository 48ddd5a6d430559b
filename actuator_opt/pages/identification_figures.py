"""Figures of an Identification: over time, over velocity, secant damping, residuals."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import chain

import numpy as np

from ..base import quantities
from ..base.fitting import NORMAL
from ..base.numeric import Array
from ..base.quantities import Quantity
from ..design.material import LawFit
from ..identification.balance import Sliding
from ..identification.lugre import LuGreFit
from ..identification.points import FrictionPoint, by_pressure
from ..identification.result import Identification
from ..identification.stribeck_fit import StribeckFit
from ..metrics import METRICS
from ..rendering.axes import even_range, log_range
from ..rendering.blocks import Chart
from ..rendering.chart import Axis, Curve, Level, Panel, Points, ShadedMap, Values
from ..rendering.chart_ink import drawn
from ..rendering.ink import Ink
from ..rendering.text import number, sentence, trimmed, unit_text

FORCE, PRESSURE = METRICS["friction_running"], quantities.INPUTS["pressure"]
SPEED, LENGTH = quantities.INPUTS["stribeck_speed"], quantities.INPUTS["position"]
STIFFNESS, GROWTH = METRICS["stiffness_min"], METRICS["growth_at_seal"]
LEAST, MOST = 64.0, 140.0
"""Least and greatest height of the whole figure [mm]."""
NEAREST = 1.5
"""Ratio of the lowest measured speed to the lowest speed at which a Stribeck curve is drawn."""
LEAST_SPEEDS = 3
"""Least number of speeds per pressure for which a map is drawn instead of a curve (our choice)."""
DAMPING = "Secant damping F/v, kN·s/m"
FITS = {"power_law": "power law", "double_exponential": "double exp."}
STYLES = {"power_law": 0, "double_exponential": 1}
"""Line styles of the laws fitted to the secant damping."""
_OTHER = 2
"""Line style of any other fit and of the LuGre model."""


def identification_figure(identification: Identification, height: float = MOST) -> Ink:
    """All figures of an identification in one drawing of the given height [mm]."""
    chart = Chart(
        "Friction and damping",
        [_over_time(identification), _friction(identification), _damping(identification)],
        widths=(57.0, 63.0, 54.0),
    )
    return drawn(chart, height=min(max(height, LEAST), MOST))


# ---- over time ----


def _over_time(identification: Identification) -> list[Panel]:
    """Position, pressures, friction, bore growth and stiffness over time, stacked vertically."""
    slidings = identification.slidings

    def curve(words: str, quantity: Quantity, values: Callable[[Sliding], Array]) -> Curve:
        pieces = [(sliding.piece.time, values(sliding)) for sliding in slidings]
        times, shown = joined(pieces)
        return Curve(words, times, quantity.to_display(1.0) * shown, weight="thin")

    pressures = [curve("p1", PRESSURE, lambda sliding: sliding.piece["p1"])]
    if "p2" in slidings[0].piece:
        pressures.append(curve("p2", PRESSURE, lambda sliding: sliding.piece["p2"]))
    stiffness = curve("", STIFFNESS, identification.stiffness_along)
    outside = "" if np.isfinite(stiffness.ys).any() else "The record lies outside the stroke."
    rows: list[tuple[str, Quantity, list[Curve], str]] = [
        ("Position", LENGTH, [curve("", LENGTH, lambda sliding: sliding.piece["x"])], ""),
        ("Pressures", PRESSURE, pressures, ""),
        ("Friction", FORCE, [curve("", FORCE, _sound)], ""),
        ("Bore growth at the seal", GROWTH, [curve("", GROWTH, identification.growth_along)], ""),
        ("k_eq", STIFFNESS, [stiffness], outside),
    ]
    return [
        Panel(
            f"{words}, {unit_text(quantity.unit)}",
            Axis("time, s" if words == "k_eq" else ""),
            Axis(zero=quantity not in (LENGTH, PRESSURE)),
            curves=curves,
            note=why,
        )
        for words, quantity, curves, why in rows
    ]


def _sound(sliding: Sliding) -> Array:
    """Friction over time, without disturbed or clipped samples."""
    return np.where(sliding.piece.sound, sliding.friction, np.nan)


def joined(pieces: Sequence[tuple[Values, Values]]) -> tuple[Array, Array]:
    """Pieces of a curve joined to one curve, with a break after each piece."""
    breaks = np.array([np.nan])
    xs, ys = (
        np.concatenate([*chain.from_iterable((piece[k], breaks) for piece in pieces), breaks])
        for k in (0, 1)
    )
    return xs, ys


# ---- friction over velocity ----


def _friction(identification: Identification) -> list[Panel]:
    """Friction over velocity with its residuals below.

    Without a fitted curve, friction is drawn over position instead.
    """
    fit = identification.stribeck
    if isinstance(fit, StribeckFit):
        return [_velocity_panel(identification, fit), _residuals(identification, fit)]
    why = sentence(f"no Stribeck curve: {fit}")
    unit = unit_text(FORCE.unit)
    x = Axis(f"velocity, {unit_text(SPEED.unit)}", log=True, signed=True)
    points = measured(identification.points, _velocity, _signed_friction)
    loop = _loop(identification, f"Friction over position, {unit}", "" if points else why)
    if not points:
        return [loop]
    title = f"Friction over velocity, {unit}"
    return [Panel(title, x, Axis(zero=True), points=points, note=why, share=0.7), loop]


def measured(
    points: Sequence[FrictionPoint],
    across: Callable[[FrictionPoint], float],
    up: Callable[[FrictionPoint], tuple[float, float]],
) -> list[Points]:
    """Points of both directions of motion, with 95 % error bars.

    `across` returns the x value of a point, and `up` its y value with the standard error.
    """
    groups = []
    for style, (words, way) in enumerate((("out", 1), ("in", -1))):
        here = [point for point in points if way * point.velocity > 0]
        values = [up(point) for point in here]
        if here:
            low, high = (
                [value + side * NORMAL * error for value, error in values] for side in (-1, 1)
            )
            xs, ys = [across(point) for point in here], [value for value, _ in values]
            groups.append(Points(words, xs, ys, low, high, style))
    return groups


def _velocity(point: FrictionPoint) -> float:
    return SPEED.to_display(point.velocity)


def speed(point: FrictionPoint) -> float:
    """Speed in display units."""
    return SPEED.to_display(point.speed)


def _signed_friction(point: FrictionPoint) -> tuple[float, float]:
    return point.friction, point.error


def _velocity_panel(identification: Identification, fit: StribeckFit) -> Panel:
    """Measured points, Stribeck curve with its 95 % band, and F_C and F_S of the LuGre model."""
    points = identification.points
    return Panel(
        f"Friction over velocity, {unit_text(FORCE.unit)}",
        Axis(log=True, signed=True),
        Axis(zero=True),
        curves=_stribeck_curves(points, fit),
        points=measured(points, _velocity, _signed_friction),
        levels=_levels(identification.lugre, points),
        share=0.78,
    )


def _stribeck_curves(points: Sequence[FrictionPoint], fit: StribeckFit) -> list[Curve]:
    """Stribeck curves with their 95 % bounds, at the mean pressure.

    If the fitted friction depends on pressure, there are two curves: at the least and at the
    greatest pressure.
    """
    levels = [(fit.reference_pressure, "Stribeck curve, 95 % band")]
    if "pressure_slope" in fit.parameters:
        ends = [f(point.pressure for point in points) for f in (min, max)]
        names = [f"{trimmed(round(pressure / 1e5))} bar" for pressure in ends]
        levels = list(zip(ends, (names[0], f"{names[1]}; bands 95 %"), strict=True))
    speeds = [point.speed for point in points]
    along = np.geomspace(min(speeds) / NEAREST, max(speeds), 90)
    ways = [way for way in (1, -1) if any(way * point.velocity > 0 for point in points)]
    curves = []
    for level, words in levels:
        pressure = np.full(along.shape, level)
        parts = []
        for way in ways:
            low, high = fit.bounds(way * along, pressure)
            shown = way * SPEED.to_display(1.0) * along
            parts.append((shown, fit.predict(way * along, pressure), low, high))
        xs, ys = joined([(shown, force) for shown, force, _, _ in parts])
        low, high = (joined([(part[0], part[k]) for part in parts])[1] for k in (2, 3))
        curves.append(Curve(words, xs, ys, low, high))
    return curves


def _levels(lugre: LuGreFit | str, points: Sequence[FrictionPoint]) -> list[Level]:
    """F_C and F_S of the LuGre model, as short lines near zero speed."""
    if isinstance(lugre, str):
        return []
    values, offset = lugre.values, lugre.values.get("offset", 0.0)
    least = min(speed(point) for point in points) / NEAREST
    return [
        Level(way * values[name] + offset, words, style=_OTHER, between=(0.0, way * least))
        for name, words in (("coulomb", "F_C"), ("static", "F_S"))
        if name in lugre.parameters
        for way in (1, -1)
        if any(way * point.velocity > 0 for point in points)
    ]


def _residuals(identification: Identification, fit: StribeckFit) -> Panel:
    """Measured minus fitted friction of every point; lines mark the scatter of the LuGre fit."""
    numbers = zip(fit.residuals, fit.errors, strict=True)
    of_point = dict(zip(identification.points, numbers, strict=True))
    points = measured(identification.points, _velocity, lambda point: of_point[point])
    levels = []
    if isinstance(identification.lugre, LuGreFit):
        misfit = identification.lugre.misfit
        words = f"LuGre windows ±{number(misfit, 3)} N"
        levels = [Level(way * misfit, words, style=_OTHER) for way in (-1, 1)]
    return Panel(
        f"Residual, {unit_text(FORCE.unit)}",
        Axis(f"velocity, {unit_text(SPEED.unit)}, outwards positive", log=True, signed=True),
        Axis(zero=True),
        points=[replace(way, words="") for way in points],
        levels=levels,
        share=0.22,
    )


def _loop(identification: Identification, title: str, why: str) -> Panel:
    """Friction over position, with the Coulomb friction F_C of the LuGre model."""
    pieces = [
        (
            LENGTH.to_display(1.0) * sliding.piece["x"][sliding.piece.sound],
            sliding.friction[sliding.piece.sound],
        )
        for sliding in identification.slidings
    ]
    levels = []
    if isinstance(identification.lugre, LuGreFit) and "coulomb" in identification.lugre.parameters:
        values = identification.lugre.values
        levels = [
            Level(
                way * values["coulomb"] + values.get("offset", 0.0),
                "±F_C of the LuGre model",
                style=_OTHER,
            )
            for way in (1, -1)
        ]
    return Panel(
        title,
        Axis(f"position, {unit_text(LENGTH.unit)}"),
        Axis(zero=True),
        curves=[Curve("", *joined(pieces), weight="thin")],
        levels=levels,
        note=why,
    )


# ---- secant damping ----


def _damping(identification: Identification) -> list[Panel]:
    """Secant damping: a map over speed and pressure, or curves over speed with residuals below."""
    usable = [point for point in identification.points if point.damping > 0]
    if not usable:
        why = (
            "No secant damping: the record has no steady sliding with friction opposing the motion."
        )
        return [Panel(DAMPING, note=why)]
    if pressure_levels(usable):
        return [_map(usable, identification.stribeck)]
    fits = {name: fit for name, fit in identification.fits.items() if isinstance(fit, LawFit)}
    why = ""
    if not fits:
        why = sentence(f"no fit: {next(iter(identification.fits.values()), 'none was tried')}")
    label = f"speed, {unit_text(SPEED.unit)}"
    above = Panel(
        DAMPING,
        Axis("" if fits else label, log=True),
        Axis(log=True),
        curves=[_fit_curve(name, fit, usable) for name, fit in fits.items()],
        points=measured(usable, speed, lambda p: (p.damping / 1e3, p.error / p.speed / 1e3)),
        note=why,
        share=0.78,
    )
    if not fits:
        return [above]
    ratios = [_ratios(name, fit, usable) for name, fit in fits.items()]
    x, y = Axis(label, log=True), Axis(zero=True)
    return [above, Panel("Residual, % of the fit", x, y, points=ratios, share=0.22)]


def _fit_curve(name: str, fit: LawFit, points: Sequence[FrictionPoint]) -> Curve:
    low, high = (f(point.speed for point in points) for f in (min, max))
    speeds = np.geomspace(low, high, 90)
    damping = np.asarray(fit.predict(speeds)) / 1e3
    shown = SPEED.to_display(1.0) * speeds
    return Curve(FITS.get(name, name), shown, damping, style=STYLES.get(name, _OTHER))


def _ratios(name: str, fit: LawFit, points: Sequence[FrictionPoint]) -> Points:
    """Relative residual of the damping, measured / fitted - 1, in per cent."""
    predicted = np.asarray(fit.predict(np.array([point.speed for point in points])))
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = 100 * (np.array([point.damping for point in points]) / predicted - 1)
    speeds = [speed(point) for point in points]
    return Points("", speeds, ratio, style=STYLES.get(name, _OTHER), small=True)


# ---- map ----


def pressure_levels(points: Sequence[FrictionPoint]) -> list[list[FrictionPoint]]:
    """Points of one direction of motion, grouped by pressure.

    Empty unless at least two pressures have three speeds each, within a common range of speeds.
    Only one direction is used, because the pressure differs between the two directions even without
    load.
    """
    for way in (1, -1):
        here = [point for point in points if way * point.velocity > 0]
        full = [group for group in by_pressure(here) if _speeds(group) >= LEAST_SPEEDS]
        if len(full) > 1 and _overlap(full):
            return full
    return []


def _speeds(group: Sequence[FrictionPoint]) -> int:
    return len({round(10 * math.log(point.speed)) for point in group})


def _overlap(groups: Sequence[Sequence[FrictionPoint]]) -> bool:
    """Whether the ranges of speed at all pressures overlap.

    If not, the effects of pressure and of speed cannot be separated.
    """
    low = max(min(point.speed for point in group) for group in groups)
    high = min(max(point.speed for point in group) for group in groups)
    return high > 1.5 * low


def _map(points: Sequence[FrictionPoint], fit: StribeckFit | str) -> Panel:
    """Damping over speed and pressure: measured points, drawn on a map of the Stribeck fit."""
    speeds = [speed(point) for point in points]
    pressures = [PRESSURE.to_display(point.pressure) for point in points]
    surface = ShadedMap((), (), np.empty((0, 0)))
    words = f"vertical axis: pressure, {unit_text(PRESSURE.unit)}; circles: measured"
    across, upwards = log_range(speeds), even_range(pressures)
    if isinstance(fit, StribeckFit):
        xs, ys = np.logspace(*across, 40), np.linspace(*upwards, 24)
        moving = xs / SPEED.to_display(1.0)
        table = fit.predict(moving[None, :], ys[:, None] / PRESSURE.to_display(1.0)) / moving
        surface = ShadedMap(xs, ys, np.broadcast_to(np.asarray(table) / 1e3, (24, 40)))
        words += "; shades: Stribeck curve, outwards"
    low, high = (10.0**end for end in across)
    return Panel(
        DAMPING,
        Axis(f"speed, {unit_text(SPEED.unit)}", log=True, range=(low, high)),
        Axis(range=upwards),
        points=[Points("", speeds, pressures, shades=[point.damping / 1e3 for point in points])],
        surface=surface,
        note=words,
    )
