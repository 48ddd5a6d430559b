"""Figures 3, 6 to 8 and 15 to 20 of [Huang2017] as ink: curves, contours, surfaces.

For measurements of the paper, the curves follow its table 2, because its figures contain no
numbers.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array
from ..models.friction import HUANG_TABLE_2
from ..rendering.axes import Axes, ticks
from ..rendering.ink import BLACK, BLUE, GREEN, GREY, OCHRE, PALE, WHITE, Ink, Point
from ..rendering.text import trimmed
from ..studies.film_walk import FilmMap
from . import huang_published
from .aalto_figures import (
    CHAIN,
    DASHED,
    DOTTED,
    FULL,
    THIN,
    LabelledCurve,
    Style,
    curve,
    draw_curves,
)
from .huang_models import TYPICAL, WIDTH, HuangStudy
from .huang_published import PAPER, SPEEDS

STYLES: tuple[Style, ...] = (
    FULL,
    DASHED,
    CHAIN,
    THIN,
    {"stroke": BLUE, "pen": 0.35, "dash": (0.5, 0.6)},
    {"stroke": OCHRE, "pen": 0.4, "dash": (3.2, 0.7, 0.4, 0.7, 0.4, 0.7)},
    {"stroke": GREEN, "pen": 0.5},
    DOTTED,
)
"""Styles of the curves of one panel, in order."""

COLUMNS, PANEL, HEIGHT, ROW, TOP = (10.0, 101.0), 52.0, 36.0, 56.0, 9.0

_LIFT = 0.4
"""Rise and run of a surface's depth axis, as a share of the panel's height and width."""


def box(place: tuple[int, int]) -> tuple[float, float, float, float]:
    """Frame (left, top, width, height) of a panel at a (row, column)."""
    row, column = place
    return COLUMNS[column], TOP + row * ROW, PANEL, HEIGHT


def panel(
    ink: Ink,
    place: tuple[int, int],
    title: str,
    x_label: str,
    curves: Sequence[LabelledCurve],
    *,
    span: tuple[float, float],
    range_: tuple[float, float],
    level: float | None = None,
) -> None:
    """Draw curves in a frame, each labelled at its end; `level` is a horizontal line."""
    left, top, width, height = box(place)
    axes = Axes(ink, (left, top, width, height), span, range_)
    right, bottom = left + width, top + height
    axes.frame(title, x_label)
    if level is not None:
        ink.line((left, axes.y(level)), (right, axes.y(level)), stroke=GREY, pen=0.2)
    draw_curves(ink, axes, curves, (right, top, bottom))


@dataclass(frozen=True, slots=True)
class DampingField:
    """Damping [MN s/m] over speed [mm/s] and pressure [MPa], as an array (pressure, speed)."""

    speeds: Array
    pressures: Array
    values: Array


def contours(
    ink: Ink, place: tuple[int, int], title: str, field: DampingField, levels: Sequence[float]
) -> None:
    """Draw lines of equal damping; on the logarithmic speed axis they are evenly spaced."""
    logs = np.log10(field.speeds)
    spans = [(float(axis[0]), float(axis[-1])) for axis in (logs, field.pressures)]
    axes = Axes(ink, box(place), spans[0], spans[1])
    marks = [v for v in (0.5, 1.0, 2.0, 5.0, 10.0) if spans[0][0] <= math.log10(v) <= spans[0][1]]
    axes.frame_at(
        title,
        "speed, mm/s",
        [(math.log10(v), trimmed(v)) for v in marks],
        [(p, trimmed(p)) for p in ticks(*spans[1], 5)],
    )
    taken: list[Point] = []
    for k, level in enumerate(levels):
        pieces = segments(logs, field.pressures, np.log(field.values), math.log(level))
        if not pieces:
            continue
        paper = [[(axes.x(x), axes.y(y)) for x, y in piece] for piece in pieces]
        ink.path(paper, stroke=(BLUE, OCHRE, GREEN)[k % 3], pen=0.35)
        middles = [((a[0] + b[0]) / 2, (a[1] + b[1]) / 2) for a, b in paper]
        inner = [m for m in middles if _inside(m, box(place))]
        free = [m for m in inner if all(abs(m[0] - x) > 8 or abs(m[1] - y) > 4 for x, y in taken)]
        if free:
            x, y = free[len(free) // 2]
            taken.append((x, y))
            ink.text(x, y, trimmed(level), size=6.0, anchor="center", halo=True)


def _inside(point: Point, frame: tuple[float, float, float, float]) -> bool:
    left, top, width, height = frame
    return left + 3 < point[0] < left + width - 3 and top + 2 < point[1] < top + height - 2


def segments(xs: Array, ys: Array, values: Array, level: float) -> list[tuple[Point, Point]]:
    """Straight pieces of a contour line, cell by cell; each cell consists of two triangles."""
    pieces = []
    for i, j in itertools.product(range(len(ys) - 1), range(len(xs) - 1)):
        corners = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)]
        for three in ((0, 1, 2), (0, 2, 3)):
            crossed = []
            nodes = [corners[k] for k in three]
            for a, b in itertools.combinations(nodes, 2):
                here, other = values[a] - level, values[b] - level
                if here * other < 0:
                    t = float(here / (here - other))
                    x = xs[a[1]] + t * (xs[b[1]] - xs[a[1]])
                    y = ys[a[0]] + t * (ys[b[0]] - ys[a[0]])
                    crossed.append((float(x), float(y)))
            if len(crossed) == 2:
                pieces.append((crossed[0], crossed[1]))
    return pieces


def surface(ink: Ink, place: tuple[int, int], title: str, field: DampingField) -> None:
    """Draw the damping as a net in space: speed rightwards, pressure backwards, values upwards."""
    left, top, width, height = box(place)
    deep, wide = _LIFT * height, _LIFT * width
    speeds, pressures = field.speeds, field.pressures
    ink.text(left - 1.4, top - 3.6, title, size=7.0, bold=True)
    if not np.any(np.isfinite(field.values)):
        ink.text(left, top + height / 2, "no film", size=6.5, color=GREY)
        return
    highest = float(np.nanmax(field.values))

    def paper(v: float, p: float, value: float) -> Point:
        across = (v - speeds[0]) / (speeds[-1] - speeds[0])
        back = (p - pressures[0]) / (pressures[-1] - pressures[0])
        x = left + across * (width - wide) + back * wide
        y = top + height - back * deep - value / highest * (height - deep)
        return float(x), float(y)

    for p in pressures[[0, -1]]:
        ink.line(paper(speeds[0], p, 0), paper(speeds[-1], p, 0), stroke=PALE, pen=0.15)
    for v in speeds[[0, -1]]:
        ink.line(paper(v, pressures[0], 0), paper(v, pressures[-1], 0), stroke=PALE, pen=0.15)
    corner = paper(speeds[0], pressures[0], 0)
    ink.line(corner, paper(speeds[0], pressures[0], highest), pen=0.18)
    ink.line(corner, paper(speeds[-1], pressures[0], 0), pen=0.18)
    ink.line(paper(speeds[-1], pressures[0], 0), paper(speeds[-1], pressures[-1], 0), pen=0.18)
    for i in range(len(pressures) - 2, -1, -1):
        for j in range(len(speeds) - 1):
            nodes = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)]
            values = [float(field.values[node]) for node in nodes]
            if all(map(math.isfinite, values)):
                face = [
                    paper(speeds[b], pressures[a], value)
                    for (a, b), value in zip(nodes, values, strict=True)
                ]
                ink.path([face], fill=WHITE, stroke=BLUE, pen=0.18, closed=True)
    for value in ticks(0.0, highest, 4):
        at = paper(speeds[0], pressures[0], value)
        ink.line(at, (at[0] - 1.0, at[1]), pen=0.13)
        ink.text(at[0] - 1.6, at[1], trimmed(value), size=6.5, anchor="right")
    bottom = top + height
    for v in (speeds[0], speeds[-1]):
        x, _ = paper(v, pressures[0], 0)
        ink.text(x, bottom + 3.0, trimmed(float(v)), size=6.5, anchor="center")
    ink.text(
        left + (width - wide) / 2, bottom + 7.0, "speed, mm/s", size=6.5, anchor="center",
        color=GREY,
    )  # fmt: skip
    for p in (pressures[0], pressures[-1]):
        x, y = paper(speeds[-1], p, 0)
        words = f"{trimmed(float(p))} MPa"
        ink.text(x + 2.6, y + 0.6, words, size=6.5, color=BLACK)


LEVELS = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
"""Values of the lines of equal damping, MN s/m."""

_SPEED, _PRESSURE = "speed, mm/s", "sealed pressure, MPa"

_UNIT = "MN·s/m"

SPEED_RANGE = (0.0, 1e3 * PAPER.speeds[1])

SHOWN = (0.5e-3, 2.1e-3, 5e-3, 10e-3)
"""Speeds for which figure 8 has a curve over pressure."""


def _field(speeds: Array, pressures: Array, damping: Array) -> DampingField:
    return DampingField(
        1e3 * np.asarray(speeds), np.asarray(pressures) / 1e6, np.asarray(damping) / 1e6
    )


def published_field() -> DampingField:
    """Damping by table 2 over the tested speeds."""
    pressures = np.array([row.pressure for row in HUANG_TABLE_2])
    damping = np.array([huang_published.secant_of(row, SPEEDS) for row in HUANG_TABLE_2])
    return _field(SPEEDS, pressures, damping)


def cylinder_figure(study: HuangStudy, *, width: float = 180.0) -> Ink:
    """Figure 3(c) and (d): the piston cylinder, computed with oil films."""
    ink = Ink(width, ROW)
    cylinder = study.cylinder
    field = _field(cylinder.piston.speeds, cylinder.pressures, cylinder.damping)
    surface(ink, (0, 0), f"Figure 3(c): B, {_UNIT}", field)
    contours(ink, (0, 1), f"Figure 3(d): B, {_UNIT}; y axis: chamber pressure, MPa", field, LEVELS)
    return ink


def plunger_figure(study: HuangStudy, *, width: float = 180.0) -> Ink:
    """Figure 6: damping by table 2 (above) and by our films (below)."""
    ink = Ink(width, 2 * ROW)
    ours = _field(study.plunger.speeds, study.plunger.pressures, study.plunger.damping)
    for row, words, field in ((0, "table 2", published_field()), (1, "our films", ours)):
        surface(ink, (row, 0), f"Figure 6(a): B, {_UNIT}, {words}", field)
        contours(ink, (row, 1), f"Figure 6(b): B, {_UNIT}, {words}; y axis: MPa", field, LEVELS)
    return ink


def _limits(values: Sequence[float]) -> tuple[float, float]:
    """Least and largest of the finite values; 0 and 1 without any."""
    known = [value for value in values if math.isfinite(value)]
    return (min(known), max(known)) if known else (0.0, 1.0)


def _highest(curves: list[LabelledCurve]) -> float:
    return 1.08 * _limits([y for drawn in curves for y in drawn.ys])[1]


def _over_speed(speeds: Array, rows: list[tuple[float, Array]]) -> list[LabelledCurve]:
    return [
        curve(1e3 * np.asarray(speeds), damping / 1e6, style, f"{trimmed(pressure / 1e6)} MPa")
        for (pressure, damping), style in zip(rows, STYLES, strict=False)
    ]


def speed_figure(study: HuangStudy, *, width: float = 180.0) -> Ink:
    """Figures 7 and 8: damping over speed and over pressure, by table 2 and by our films."""
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
    """Figures 15 and 16: measured and film results at 6 MPa, film results at 8 and 10 MPa."""
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
    """Figures 17 and 18: contact stress and contact length of the step ring, and its film."""
    ink = Ink(width, 2 * ROW)
    stress = study.stress
    pressures = stress.pressures / 1e6
    span = (0.0, float(pressures[-1]))
    stresses = [
        curve(pressures, stress.peak / 1e6, STYLES[0], "highest"),
        curve(pressures, stress.excess / 1e6, STYLES[1], "excess over", "oil pressure"),
        curve(pressures, pressures, STYLES[7], "sealed pressure"),
    ]
    panel(
        ink, (0, 0), "Figure 17: contact stress at rest, MPa", _PRESSURE, stresses,
        span=span, range_=(0.0, _highest(stresses)),
    )  # fmt: skip
    lengths = [curve(pressures, 1e3 * stress.width, STYLES[0], "step ring")]
    panel(
        ink, (0, 1), "Figure 17: contact length, mm", _PRESSURE, lengths,
        span=span, range_=(0.0, _highest(lengths)),
    )  # fmt: skip
    films = [
        curve(1e3 * profile.x, 1e6 * profile.film, style, f"{trimmed(profile.pressure / 1e6)} MPa")
        for profile, style in zip(study.profiles, STYLES, strict=False)
    ]
    if films:
        values = np.concatenate([profile.ys for profile in films])
        low, high = _limits([float(value) for value in values])
        margin = 0.15 * (high - low) + 0.01
        panel(
            ink,
            (1, 0),
            "Figure 18: film of the step ring, µm, 5 mm/s",
            "distance from the sealed side, mm",
            films,
            span=(0.0, max(max(profile.xs) for profile in films)),
            range_=(low - margin, high + margin),
        )
    thickness = study.plunger.thickness[:, study.plunger.at(0.0, 5e-3)[1], 0]
    means = [curve(study.plunger.pressures / 1e6, 1e6 * thickness, STYLES[0], "mean film")]
    low, high = _limits(means[0].ys)
    panel(
        ink, (1, 1), "Mean film of the step ring, µm, 5 mm/s", _PRESSURE, means,
        span=(0.0, max(means[0].xs)), range_=(low - 0.05, high + 0.05),
    )  # fmt: skip
    return ink


def back_up_figure(study: HuangStudy, *, width: float = 180.0) -> Ink:
    """Figures 19 and 20: film and damping of the back-up ring."""
    ink = Ink(width, ROW)
    shown = [ring for ring in study.rings if ring.speed in PAPER.ring_speeds]
    films = [
        curve(1e3 * ring.film.x, 1e6 * ring.film.film, style, f"{trimmed(1e3 * ring.speed)} mm/s")
        for ring, style in zip(shown, STYLES, strict=False)
        if ring.film.converged
    ]
    if films:
        panel(
            ink, (0, 0), "Figure 19: film of the back-up ring, µm", "along the ring, mm", films,
            span=(0.0, 1e3 * WIDTH), range_=(0.0, 3 * max(np.median(ring.ys) for ring in films)),
        )  # fmt: skip
    speeds = np.array([ring.speed for ring in study.rings])
    damping = np.array([ring.damping for ring in study.rings])
    over = [curve(1e3 * speeds, damping, STYLES[0], "back-up ring")]
    panel(
        ink, (0, 1), "Figure 20: B of the back-up ring, N·s/m", _SPEED, over,
        span=(0.0, 1e3 * float(speeds[-1])), range_=(0.0, _highest(over)),
    )  # fmt: skip
    return ink


def relief_figure(study: HuangStudy, *, width: float = 180.0) -> Ink | None:
    """Trend of damping over pressure for several reliefs; None without a step ring."""
    if not study.reliefs:
        return None
    ink = Ink(width, ROW)
    curves = [
        curve(
            relief.pressures / 1e6,
            relief.damping / 1e6,
            style,
            f"{1e3 * relief.relief:.2f} mm, k {relief.balance:.2f}",
        )
        for relief, style in zip(study.reliefs, STYLES, strict=False)
    ]
    title = f"Step ring alone, {trimmed(1e3 * TYPICAL)} mm/s: B, {_UNIT}"
    panel(
        ink, (0, 0), title, _PRESSURE, curves,
        span=(0.0, max(curves[0].xs)), range_=(0.0, _highest(curves)),
    )  # fmt: skip
    lengths = np.array([1e3 * relief.relief for relief in study.reliefs])
    rises = [
        curve(lengths, np.array([relief.rise for relief in study.reliefs]), STYLES[0], "alone")
    ]
    if study.whole:
        rises.append(
            curve(lengths, np.array(study.drained), STYLES[1], "both, no", "pressure", "between")
        )
        rises.append(curve(lengths, np.array(study.whole), STYLES[2], "both, flows", "matched"))
    panel(
        ink,
        (0, 1),
        "B at 6 MPa / B at 0.6 MPa",
        "relief of the step ring, mm",
        rises,
        span=(float(lengths[0]), float(lengths[-1])),
        range_=(0.0, _highest(rises)),
        level=1.0,
    )
    return ink
