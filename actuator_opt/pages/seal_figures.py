"""Charts of a seal study: squeeze, contact and film, friction over speed, map, finite elements."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..base.numeric import Array
from ..evaluation.rings import Ring
from ..evaluation.sealing import closed_form
from ..rendering.axes import Axes, fitted, log_range, ticks
from ..rendering.chart import Axis, Curve, Panel, Points, ShadedMap, known
from ..rendering.ink import BLACK, GREY, PALE, RED, Ink, spread_within
from ..rendering.text import AT_LEAST, AT_MOST, bars, degrees, number, speed_words, trimmed
from ..studies.seal import FilmMap, RingPoint, SealStudy, SqueezeRow
from .seal_sections import WIDTH, stroke_names

LIMIT: dict[str, Any] = {"stroke": RED, "pen": 0.25, "dash": (1.8, 1.0)}
_BAR = "#4f86a8"
_ROW = 5.0
STATIC, OIL, ASPERITY, OTHER = 5, 0, 1, 2
"""Styles of the curves of contact and film."""
CLOSED_FORM = 4
"""Line style of the closed form, drawn beside the finite elements."""
PRESSURES = (0, 2, 4)
"""Styles of points whose colours match the first curves."""
DAMPING = "Secant damping F/v, kN·s/m"


# ---- squeeze ----


def squeeze_figure(study: SealStudy) -> Ink:
    """Bars from the loosest to the tightest squeeze of every ring, with the required limits.

    There is a bar for each combination of temperature and pressure. The figure is drawn directly,
    because a `Chart` cannot print numbers beside each bar.
    """
    rows = study.squeezes
    labels = 62.0
    box = (labels, 8.0, WIDTH - labels - 46.0, _ROW * len(rows) + 1.0)
    ink = Ink(WIDTH, box[1] + box[3] + 9.0)
    limits = squeeze_limits(study)
    ends = [100 * x for row in rows for x in (row.loosest, row.tightest)]
    ends += [100 * level for _, level in limits]
    span = (min(0.0, *ends) - 0.5, max(0.0, *ends) * 1.04 + 0.5)
    axes = Axes(ink, box, span, (0.0, 1.0))
    bottom = box[1] + box[3]
    for value in ticks(*span, 8):
        x = axes.x(value)
        ink.line((x, box[1]), (x, bottom), stroke=PALE, pen=0.1)
        ink.text(x, bottom + 2.6, trimmed(value), anchor="center")
    ink.text(box[0] + box[2] / 2, bottom + 6.4, "squeeze, %", anchor="center", color=GREY)
    ink.line((axes.x(0.0), box[1]), (axes.x(0.0), bottom), stroke=BLACK, pen=0.3)
    heads = ("loosest", "nominal", "tightest")
    columns = [WIDTH - 32.0, WIDTH - 16.5, WIDTH - 1.0]
    for head, x in zip(heads, columns, strict=True):
        ink.text(x, 4.0, head, anchor="right", size=6.0, color=GREY)
    for k, row in enumerate(rows):
        _squeeze_row(axes, row, box[1] + _ROW * (k + 0.5) + 0.5, columns)
    for _, level in limits:
        x = axes.x(100 * level)
        ink.line((x, box[1] - 1.5), (x, bottom), **LIMIT)
    _limit_words(axes, limits)
    return ink


def _squeeze_row(axes: Axes, row: SqueezeRow, y: float, columns: Sequence[float]) -> None:
    ink, values = axes.ink, [100 * v for v in (row.loosest, row.nominal, row.tightest)]
    words = f"{row.label}, {degrees(row.temperature)}, {bars(row.pressure)}"
    ink.text(axes.left - 2.0, y, fitted(words, axes.left - 2.0), anchor="right")
    left, right = axes.x(values[0]), axes.x(values[2])
    lost = values[0] <= 0
    ink.box(left, y - 1.1, max(right - left, 0.3), 2.2, fill=RED if lost else _BAR, stroke=None)
    x = axes.x(values[1])
    ink.line((x, y - 1.7), (x, y + 1.7), stroke=BLACK, pen=0.35)
    for value, at in zip(values, columns, strict=True):
        color = RED if lost and value == values[0] else BLACK
        ink.text(at, y, f"{number(value, 3)} %", anchor="right", color=color)


def squeeze_limits(study: SealStudy) -> list[tuple[str, float]]:
    """Required squeeze: sense ("min" or "max") and value of every limit in the design."""
    limits = []
    for metric in ("seal_squeeze", "seal_squeeze_max"):
        limit = study.design.requirements.get(metric)
        if limit is None:
            continue
        stated = ((AT_LEAST, limit.min), (AT_MOST, limit.max))
        limits += [(sense, level) for sense, level in stated if level is not None]
    return limits


def _limit_words(axes: Axes, limits: Sequence[tuple[str, float]]) -> None:
    ordered = sorted(limits, key=lambda limit: limit[1])
    places = spread_within(
        [axes.x(100 * level) for _, level in ordered],
        [15.0] * len(ordered),
        axes.left,
        axes.left + axes.width,
    )
    for (sense, level), x in zip(ordered, places, strict=True):
        words = f"{sense} {trimmed(100 * level)} %"
        axes.ink.text(x, axes.top - 3.6, words, anchor="center", color=RED)


# ---- contact and film ----


def contact_panels(study: SealStudy, index: int) -> list[Panel]:
    """Pressures and oil film of a ring on both strokes, from the sealed side outwards."""
    strokes = stroke_names(study)
    points = (study.drive.rings[index], study.other.rings[index])
    x = Axis("distance from the sealed side, mm")
    highest = max(
        float(np.max(curve)) / 1e6 for point in points for curve in _pressures(point) if len(curve)
    )
    pressures = [
        Panel(
            f"Pressure, {stroke}, MPa absolute",
            x,
            Axis(range=(0.0, 1.06 * highest)),
            curves=[
                Curve(words, 1e3 * point.x, curve / 1e6, style=style)
                for words, curve, style in zip(
                    ("static", "oil", "asperities"),
                    _pressures(point),
                    (STATIC, OIL, ASPERITY),
                    strict=True,
                )
                if len(curve)
            ],
        )
        for stroke, point in zip(strokes, points, strict=True)
    ]
    films = [
        Curve(stroke, 1e3 * point.x, 1e6 * point.film, style=style)
        for stroke, point, style in zip(strokes, points, (OIL, OTHER), strict=True)
    ]
    return [*pressures, Panel("Film between mean planes, µm", x, Axis(zero=True), curves=films)]


def _pressures(point: RingPoint) -> tuple[Array, Array, Array]:
    return point.static, point.oil, point.asperity


# ---- friction and damping over speed ----


def drawable(film_map: FilmMap | None) -> bool:
    """Whether a map can be drawn; for this, at least two points must have a friction above zero."""
    return film_map is not None and int(np.sum(np.nan_to_num(film_map.friction) > 0)) >= 2


def speed_panels(study: SealStudy, curves: FilmMap) -> list[Panel]:
    """Friction (left) and secant damping (right) of the driven stroke: a curve per pressure."""
    point, x = study.drive, _speed_axis(curves)
    shown = curves.speeds[0] <= point.speed <= curves.speeds[-1]
    marks = [*_breakaways(study, curves), *(_friction_points(study) if shown else [])]
    damping = []
    if shown and point.damping > 0:
        damping = [Points("operating point", [1e3 * point.speed], [point.damping / 1e3], style=3)]
    return [
        _speed_panel(f"Friction, {stroke_names(study)[0]}, N", x, curves, curves.friction, marks),
        _speed_panel(DAMPING, x, curves, curves.damping / 1e3, damping),
    ]


def _speed_axis(curves: FilmMap) -> Axis:
    first, *_, last = (1e3 * curves.speeds).tolist()
    return Axis("speed, mm/s", log=True, range=(first, last))


def _speed_panel(
    title: str, x: Axis, curves: FilmMap, rows: Array, points: Sequence[Points]
) -> Panel:
    """A curve per pressure, named at its end, and separate points."""
    values = known(rows.ravel(), log=True)
    for marks in points:
        values += known([*marks.ys, *marks.low, *marks.high], log=True)
    low, high = (10.0**end for end in log_range(values))
    drawn = [
        Curve("", 1e3 * curves.speeds, row, end=bars(float(pressure)))
        for row, pressure in zip(rows, curves.pressures, strict=True)
    ]
    return Panel(title, x, Axis(log=True, range=(low, high)), drawn, points)


def _breakaways(study: SealStudy, curves: FilmMap) -> list[Points]:
    """Breakaway friction at the pressure of every curve; for two rings, only at one pressure.

    This is the pressure of the operating point. At others, the pressure between the rings is not
    known: it follows from their oil films, which do not exist at standstill.
    """
    point, rim = study.drive, 1e3 * float(curves.speeds[0])
    if len(point.rings) > 1:
        words = f"breakaway, dry, {bars(point.pressure)} (at rest)"
        values = [(point.breakaway, words, 1)]
    else:
        values = [
            (float(dry), "breakaway, dry (at rest)", style)
            for dry, style in zip(curves.breakaway, PRESSURES, strict=False)
        ]
    return [Points(words, [rim], [dry], style=style) for dry, words, style in values if dry > 0]


def _friction_points(study: SealStudy) -> list[Points]:
    """Operating point with its scatter, and the friction by the coefficient of friction."""
    point = study.drive
    points, speed = [], [1e3 * point.speed]
    if point.coefficient_friction > 0:
        words = (
            f"by the coefficient of friction, {bars(point.pressure)}, {speed_words(point.speed)}"
        )
        points.append(Points(words, speed, [point.coefficient_friction], style=3, small=True))
    if point.friction > 0:
        words = "operating point, with scatter of the modulus"
        ends = sorted(known([point.lower, point.upper], log=True))
        low, high = ([end] for end in ends) if len(ends) == 2 else ((), ())
        points.append(Points(words, speed, [point.friction], low, high, style=3))
    return points


# ---- map ----


def map_panels(study: SealStudy, film_map: FilmMap) -> list[Panel]:
    """Maps of friction (left) and secant damping (right) of the driven stroke."""
    title = f"Friction, {stroke_names(study)[0]}, N"
    return [
        _map_panel(study, film_map, title, film_map.friction),
        _map_panel(study, film_map, DAMPING, film_map.damping / 1e3),
    ]


def _map_panel(study: SealStudy, film_map: FilmMap, title: str, values: Array) -> Panel:
    """A quantity as shades, with crosses where no oil film exists, and the operating point."""
    speeds, pressures = 1e3 * film_map.speeds, film_map.pressures / 1e5
    rows, columns = np.nonzero(~(np.isfinite(values) & (values > 0)))
    points = []
    if rows.size:
        points.append(Points("no film", speeds[columns], pressures[rows], style=1, small=True))
    speed, pressure = 1e3 * study.drive.speed, study.drive.pressure / 1e5
    if speeds[0] <= speed <= speeds[-1] and pressures[0] <= pressure <= pressures[-1]:
        points.append(Points("operating point", [speed], [pressure]))
    return Panel(
        title,
        _speed_axis(film_map),
        Axis(range=(float(pressures[0]), float(pressures[-1]))),
        points=points,
        surface=ShadedMap(speeds, pressures, values),
        note="vertical axis: pressure, bar",
    )


# ---- finite elements ----


def elements_panels(study: SealStudy) -> list[list[Panel]]:
    """Finite elements compared with the closed form.

    Panels of the contact pressure, and of its peak and the contact width versus sealed pressure.
    """
    ring = study.out.rings[0].ring
    pressures = np.linspace(0.0, study.elements[-1].pressure, 41)
    contacts = [closed_form(ring.at(pressure=float(pressure))) for pressure in pressures]

    def over_pressure(title: str, elements: Sequence[float], closed: Sequence[float]) -> Panel:
        places = [contact.pressure / 1e5 for contact in study.elements]
        return Panel(
            title,
            Axis("sealed pressure, bar", range=(0.0, 1.03 * float(pressures[-1]) / 1e5)),
            Axis(zero=True),
            [
                Curve("elements", places, elements),
                Curve("closed form", pressures / 1e5, closed, style=CLOSED_FORM),
            ],
            [Points("elements", places, elements)],
        )

    upper = _profiles(study, ring)
    peaks = over_pressure(
        "Peak contact pressure, MPa",
        [contact.peak_pressure / 1e6 for contact in study.elements],
        [float(contact.peak) / 1e6 for contact in contacts],
    )
    widths = over_pressure(
        "Contact width, mm",
        [1e3 * contact.width for contact in study.elements],
        [1e3 * float(contact.width) for contact in contacts],
    )
    return [[upper[0], peaks], [upper[1], widths]]


def _profiles(study: SealStudy, ring: Ring) -> list[Panel]:
    """Contact pressure along the contact at every sealed pressure, by elements and closed form."""
    solved = [(contact.positions, contact.contact_pressure) for contact in study.elements]
    closed = [_closed_profile(ring, contact.pressure) for contact in study.elements]
    highest = max(float(np.max(values)) for _, values in [*solved, *closed]) / 1e6
    longest = max(float(places[-1]) for places, _ in [*solved, *closed]) * 1e3
    return [
        Panel(
            f"Contact pressure, {title}, MPa",
            Axis("distance from the sealed end of the contact, mm", range=(0.0, longest)),
            Axis(range=(0.0, 1.06 * highest)),
            [
                Curve(bars(contact.pressure), 1e3 * places, values / 1e6)
                for contact, (places, values) in zip(study.elements, curves, strict=True)
            ],
        )
        for title, curves in (("elements", solved), ("closed form", closed))
    ]


def _closed_profile(ring: Ring, pressure: float) -> tuple[Array, Array]:
    """Positions along the contact, and contact pressures, by the closed form."""
    contact = closed_form(ring.at(pressure=pressure))
    share = np.linspace(0.0, 1.0, 121)
    return share * float(contact.profile_width), np.asarray(contact.profile(share), dtype=float)
