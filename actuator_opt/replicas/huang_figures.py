"""Figures 3, 6 to 8 and 15 to 20 of [Huang2017] as ink, from stated inputs.

Where the paper measured, the curves are its own table 2; its drawn figures carry no numbers in
their text.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..base.numeric import Array
from ..models.friction import HUANG_TABLE_2
from ..rendering.ink import Ink
from ..rendering.text import trimmed
from ..studies.film_walk import FilmMap
from . import huang_published
from .aalto_figures import Curve
from .huang import TYPICAL
from .huang_panels import ROW, STYLES, Field, contours, curve, panel, surface
from .huang_parts import WIDTH
from .huang_published import PAPER, SPEEDS
from .huang_study import HuangStudy

LEVELS = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
"""Lines of equal damping, MN s/m."""
_SPEED, _PRESSURE = "speed, mm/s", "sealed pressure, MPa"
_UNIT = "MN·s/m"
SPEED_RANGE = (0.0, 1e3 * PAPER.speeds[1])
SHOWN = (0.5e-3, 2.1e-3, 5e-3, 10e-3)
"""Speeds of the curves over pressure, figure 8."""


def _field(speeds: Array, pressures: Array, damping: Array) -> Field:
    return Field(1e3 * np.asarray(speeds), np.asarray(pressures) / 1e6, np.asarray(damping) / 1e6)


def published_field() -> Field:
    """Table 2 over the tested speeds."""
    pressures = np.array([row.pressure for row in HUANG_TABLE_2])
    damping = np.array([huang_published.secant_of(row, SPEEDS) for row in HUANG_TABLE_2])
    return _field(SPEEDS, pressures, damping)


def cylinder_figure(study: HuangStudy, *, width: float = 180.0) -> Ink:
    """Figure 3(c) and (d): the piston cylinder on its films."""
    ink = Ink(width, ROW)
    found = study.cylinder
    field = _field(found.piston.speeds, found.pressures, found.damping)
    surface(ink, (0, 0), f"Figure 3(c): B, {_UNIT}", field)
    contours(ink, (0, 1), f"Figure 3(d): B, {_UNIT}, over chamber pressure, MPa", field, LEVELS)
    return ink


def plunger_figure(study: HuangStudy, *, width: float = 180.0) -> Ink:
    """Figure 6: table 2 above, our films below."""
    ink = Ink(width, 2 * ROW)
    ours = _field(study.plunger.speeds, study.plunger.pressures, study.plunger.damping)
    for row, words, field in ((0, "table 2", published_field()), (1, "our films", ours)):
        surface(ink, (row, 0), f"Figure 6(a): B, {_UNIT}, {words}", field)
        contours(ink, (row, 1), f"Figure 6(b): B, {_UNIT}, over MPa, {words}", field, LEVELS)
    return ink


def _limits(values: Sequence[float]) -> tuple[float, float]:
    """Least and largest of the values that are known; 0 and 1 where none is."""
    known = [value for value in values if math.isfinite(value)]
    return (min(known), max(known)) if known else (0.0, 1.0)


def _highest(curves: list[Curve]) -> float:
    return 1.08 * _limits([y for one in curves for y in one.ys])[1]


def _over_speed(speeds: Array, rows: list[tuple[float, Array]]) -> list[Curve]:
    return [
        curve(1e3 * np.asarray(speeds), damping / 1e6, style, f"{trimmed(pressure / 1e6)} MPa")
        for (pressure, damping), style in zip(rows, STYLES, strict=False)
    ]


def speed_figure(study: HuangStudy, *, width: float = 180.0) -> Ink:
    """Figures 7 and 8: over speed and over pressure, table 2 and our films."""
    ink = Ink(width, 2 * ROW)
    mapped = study.plunger
    table = [(row.pressure, huang_published.secant_of(row, SPEEDS)) for row in HUANG_TABLE_2]
    ours = list(zip(mapped.pressures, mapped.damping, strict=True))
    pressures = np.array([row.pressure for row in HUANG_TABLE_2]) / 1e6
    for column, words, curves in (
        (0, "table 2", _over_speed(SPEEDS, table)),
        (1, "our films", _over_speed(mapped.speeds, ours)),
    ):
        title = f"Figure 7: B, {_UNIT}, {words}"
        limits = (0.0, _highest(curves))
        panel(ink, (0, column), title, _SPEED, curves, span=SPEED_RANGE, range_=limits)
    measured, filmed = [], []
    for v, style in zip(SHOWN, STYLES, strict=False):
        label = f"{trimmed(1e3 * v)} mm/s"
        values = np.array([float(huang_published.secant_of(row, v)) for row in HUANG_TABLE_2])
        measured.append(curve(pressures, values / 1e6, style, label))
        j = mapped.at(mapped.pressures[0], v)[1]
        filmed.append(curve(mapped.pressures / 1e6, mapped.damping[:, j] / 1e6, style, label))
    for column, words, curves in ((0, "table 2", measured), (1, "our films", filmed)):
        panel(
            ink,
            (1, column),
            f"Figure 8: B, {_UNIT}, {words}",
            _PRESSURE,
            curves,
            span=(0.0, max(curves[0].xs)),
            range_=(0.0, _highest(curves)),
        )
    return ink


def _row_at(mapped: FilmMap, pressure: float) -> Array:
    return mapped.damping[mapped.at(pressure, PAPER.speeds[0])[0]]


def simulated_figure(study: HuangStudy, *, width: float = 180.0) -> Ink:
    """Figures 15 and 16: 6 MPa measured and on films, 8 and 10 MPa on films."""
    ink = Ink(width, ROW)
    mapped = study.plunger
    table = huang_published.secant_of(HUANG_TABLE_2[-1], SPEEDS)
    speeds = 1e3 * mapped.speeds
    compared = [
        curve(1e3 * SPEEDS, table / 1e6, STYLES[1], "table 2"),
        curve(speeds, _row_at(mapped, PAPER.compared) / 1e6, STYLES[0], "our films"),
    ]
    high = [
        curve(speeds, _row_at(mapped, p) / 1e6, style, f"{trimmed(p / 1e6)} MPa")
        for p, style in zip(PAPER.simulated, STYLES, strict=False)
    ]
    for column, title, curves in (
        (0, f"Figure 15: B at 6 MPa, {_UNIT}", compared),
        (1, f"Figure 16: B, {_UNIT}, our films", high),
    ):
        limits = (0.0, _highest(curves))
        panel(ink, (0, column), title, _SPEED, curves, span=SPEED_RANGE, range_=limits)
    return ink


def ring_figure(study: HuangStudy, *, width: float = 180.0) -> Ink:
    """Figures 17 and 18: stress and length of the step ring's contact, and its film."""
    ink = Ink(width, 2 * ROW)
    found = study.stress
    pressures = found.pressures / 1e6
    span = (0.0, float(pressures[-1]))
    stresses = [
        curve(pressures, found.peak / 1e6, STYLES[0], "highest"),
        curve(pressures, found.excess / 1e6, STYLES[1], "over the oil", "pressure"),
        curve(pressures, pressures, STYLES[7], "sealed pressure"),
    ]
    panel(
        ink, (0, 0), "Figure 17: contact stress at rest, MPa", _PRESSURE, stresses,
        span=span, range_=(0.0, _highest(stresses)),
    )  # fmt: skip
    lengths = [curve(pressures, 1e3 * found.width, STYLES[0], "step ring")]
    panel(
        ink, (0, 1), "Figure 17: contact length, mm", _PRESSURE, lengths,
        span=span, range_=(0.0, _highest(lengths)),
    )  # fmt: skip
    films = [
        curve(1e3 * one.x, 1e6 * one.film, style, f"{trimmed(one.pressure / 1e6)} MPa")
        for one, style in zip(study.profiles, STYLES, strict=False)
    ]
    if films:
        values = np.concatenate([one.ys for one in films])
        low, high = _limits([float(value) for value in values])
        margin = 0.15 * (high - low) + 0.01
        panel(
            ink,
            (1, 0),
            "Figure 18: film of the step ring, µm, 5 mm/s",
            "from the sealed side, mm",
            films,
            span=(0.0, max(max(one.xs) for one in films)),
            range_=(low - margin, high + margin),
        )
    thickness = study.plunger.thickness[:, study.plunger.at(0.0, 5e-3)[1], 0]
    means = [curve(study.plunger.pressures / 1e6, 1e6 * thickness, STYLES[0], "mean film")]
    low, high = _limits(means[0].ys)
    panel(
        ink, (1, 1), "Its mean over pressure, µm, 5 mm/s", _PRESSURE, means,
        span=(0.0, max(means[0].xs)), range_=(low - 0.05, high + 0.05),
    )  # fmt: skip
    return ink


def back_up_figure(study: HuangStudy, *, width: float = 180.0) -> Ink:
    """Figures 19 and 20: film and damping of the back-up ring."""
    ink = Ink(width, ROW)
    shown = [one for one in study.rings if one.speed in PAPER.ring_speeds]
    films = [
        curve(1e3 * one.film.x, 1e6 * one.film.film, style, f"{trimmed(1e3 * one.speed)} mm/s")
        for one, style in zip(shown, STYLES, strict=False)
        if one.film.converged
    ]
    if films:
        panel(
            ink, (0, 0), "Figure 19: film of the back-up ring, µm", "along the ring, mm", films,
            span=(0.0, 1e3 * WIDTH), range_=(0.0, 3 * max(np.median(one.ys) for one in films)),
        )  # fmt: skip
    speeds = np.array([one.speed for one in study.rings])
    damping = np.array([one.damping for one in study.rings])
    over = [curve(1e3 * speeds, damping, STYLES[0], "back-up ring")]
    panel(
        ink, (0, 1), "Figure 20: its B, N·s/m", _SPEED, over,
        span=(0.0, 1e3 * float(speeds[-1])), range_=(0.0, _highest(over)),
    )  # fmt: skip
    return ink


def relief_figure(study: HuangStudy, *, width: float = 180.0) -> Ink | None:
    """What the step ring's relief does to the trend; None where there is no step ring."""
    if not study.reliefs:
        return None
    ink = Ink(width, ROW)
    curves = [
        curve(
            one.pressures / 1e6,
            one.damping / 1e6,
            style,
            f"{1e3 * one.relief:.2f} mm, k {one.balance:.2f}",
        )
        for one, style in zip(study.reliefs, STYLES, strict=False)
    ]
    title = f"Step ring alone, {trimmed(1e3 * TYPICAL)} mm/s: B, {_UNIT}"
    panel(
        ink, (0, 0), title, _PRESSURE, curves,
        span=(0.0, max(curves[0].xs)), range_=(0.0, _highest(curves)),
    )  # fmt: skip
    lengths = np.array([1e3 * one.relief for one in study.reliefs])
    rises = [curve(lengths, np.array([one.rise for one in study.reliefs]), STYLES[0], "alone")]
    if study.whole:
        rises.append(
            curve(lengths, np.array(study.drained), STYLES[1], "both, no", "pressure", "between")
        )
        rises.append(curve(lengths, np.array(study.whole), STYLES[2], "both, flows", "matched"))
    panel(
        ink,
        (0, 1),
        "B at 6 MPa over B at 0.6 MPa",
        "relief of the step ring, mm",
        rises,
        span=(float(lengths[0]), float(lengths[-1])),
        range_=(0.0, _highest(rises)),
        level=1.0,
    )
    return ink
