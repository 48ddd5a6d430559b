"""Seals as ink: squeeze over tolerances, contact and film, friction and damping over speed.

Curves differ in dash as well as in colour. Squares on the left rim are breakaway friction, the
cross is what the coefficient of friction gives instead of the film.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from ..rendering.axes import Axes, dot, fitted, legend, level_ticks, ticks
from ..rendering.ink import (
    BLACK,
    BLUE,
    GREY,
    PALE,
    RED,
    WHITE,
    Ink,
    Point,
    spread_within,
    text_width,
)
from ..rendering.text import AT_LEAST, AT_MOST, MINUS, number, trimmed
from ..studies.seal import FilmMap, RingPoint, SealStudy, SqueezeRow
from .bode import STYLES, inside, logs
from .wall_figures import GREEN, OCHRE

STATIC: dict[str, Any] = {"stroke": GREY, "pen": 0.4, "dash": (0.5, 0.6)}
OIL: dict[str, Any] = {"stroke": BLUE, "pen": 0.4}
ASPERITY: dict[str, Any] = {"stroke": OCHRE, "pen": 0.4, "dash": (1.6, 0.8)}
OTHER: dict[str, Any] = {"stroke": GREEN, "pen": 0.4, "dash": (2.4, 0.7, 0.4, 0.7)}
LIMIT: dict[str, Any] = {"stroke": RED, "pen": 0.25, "dash": (1.8, 1.0)}
_BAR = "#4f86a8"
_ROW = 5.0
WIDTH = 180.0


def degrees(temperature: float) -> str:
    """A temperature in whole °C.

    >>> degrees(253.15), degrees(313.15)
    ('−20 °C', '40 °C')
    """
    return f"{temperature - 273.15:.0f} °C".replace("-", MINUS)


def bars(pressure: float) -> str:
    """A pressure in bar as short as it was written.

    >>> bars(2e5), bars(20.5e6)
    ('2 bar', '205 bar')
    """
    return f"{trimmed(pressure / 1e5)} bar"


def speed_words(speed: float) -> str:
    """A speed in mm/s.

    >>> speed_words(0.00917), speed_words(0.4)
    ('9.17 mm/s', '400 mm/s')
    """
    return f"{trimmed(1e3 * speed)} mm/s"


def stroke_names(study: SealStudy) -> tuple[str, str]:
    """What the stroke of a driven actuator is called at a place, and what the other one.

    A load that overruns the piston drives it against the pressure it seals.
    """
    return ("outstroke", "instroke") if study.place == "rod" else ("driven", "overrun")


# ---- squeeze ----


def squeeze_figure(study: SealStudy) -> Ink:
    """Loosest to tightest squeeze of every ring by temperature and pressure, with the limits."""
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
    """Required squeeze: (sense, level) of every limit the design states."""
    found = []
    for metric in ("seal_squeeze", "seal_squeeze_max"):
        limit = study.design.requirements.get(metric)
        if limit is None:
            continue
        stated = ((AT_LEAST, limit.min), (AT_MOST, limit.max))
        found += [(sense, level) for sense, level in stated if level is not None]
    return found


def _limit_words(axes: Axes, limits: Sequence[tuple[str, float]]) -> None:
    ordered = sorted(limits, key=lambda one: one[1])
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


def contact_figure(study: SealStudy, index: int) -> Ink:
    """Pressures of one ring on both strokes, and its film, from the sealed side outwards."""
    points = (study.drive.rings[index], study.other.rings[index])
    strokes = stroke_names(study)
    ink = Ink(WIDTH, 54.5)
    highest = max(
        float(np.max(curve)) / 1e6 for one in points for curve in _pressures(one) if len(curve)
    )
    panel, left = 43.0, 11.0
    for k, (one, stroke) in enumerate(zip(points, strokes, strict=True)):
        box = (left + k * (panel + 15.0), 13.0, panel, 32.0)
        xs = _millimetres(one)
        axes = Axes(ink, box, (0.0, xs[-1]), (0.0, 1.06 * highest))
        axes.frame(f"Pressure, {stroke}, MPa absolute", "from the sealed side, mm")
        for curve, style in zip(_pressures(one), (STATIC, OIL, ASPERITY), strict=True):
            ink.path(axes.clipped(xs, [p / 1e6 for p in map(float, curve)]), **style)
    films = [[1e6 * float(h) for h in one.film] for one in points]
    long = max(_millimetres(one)[-1] for one in points)
    box = (left + 2 * (panel + 15.0), 13.0, panel, 32.0)
    axes = Axes(ink, box, (0.0, long), (0.0, 1.06 * max(map(max, films))))
    axes.frame("Film, mean planes, µm", "from the sealed side, mm")
    for one, film, style in zip(points, films, (OIL, OTHER), strict=True):
        ink.path(axes.clipped(_millimetres(one), film), **style)
    words = [("static", STATIC), ("oil", OIL), ("asperities", ASPERITY)]
    legend(ink, left, 3.0, words, ends=False)
    legend(ink, box[0], 3.0, list(zip(strokes, (OIL, OTHER), strict=True)), ends=False)
    return ink


def _pressures(one: RingPoint) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return one.static, one.oil, one.asperity


def _millimetres(one: RingPoint) -> list[float]:
    return [1e3 * float(x) for x in one.x]


# ---- friction and damping over speed ----


def pieces(xs: Sequence[float], ys: Sequence[float]) -> Iterable[list[tuple[float, float]]]:
    """Stretches of a curve whose values are above zero.

    >>> list(pieces([0, 1, 2, 3, 4], [1.0, 2.0, math.nan, 3.0, 4.0]))
    [[(0, 1.0), (1, 2.0)], [(3, 3.0), (4, 4.0)]]
    """
    found: list[tuple[float, float]] = []
    for x, y in zip(xs, ys, strict=True):
        if y > 0 and math.isfinite(y):
            found.append((x, y))
            continue
        if len(found) > 1:
            yield found
        found = []
    if len(found) > 1:
        yield found


def drawable(found: FilmMap | None) -> bool:
    """Whether there is anything to draw: two points with a friction above zero."""
    return found is not None and int(np.sum(np.nan_to_num(found.friction) > 0)) >= 2


def speed_figure(study: SealStudy) -> Ink:
    """Friction (left) and secant damping (right) over speed at three pressures, driven."""
    curves = study.curves
    assert curves is not None
    ink = Ink(WIDTH, 64.0)
    panel, tall, top = 61.0, 41.0, 13.0
    frictions = _above([*curves.friction.ravel(), *_friction_marks(study)])
    frictions += [dry for dry, _ in _breakaways(study)]
    title = f"Friction, {stroke_names(study)[0]}, N"
    friction = _framed(ink, (11.0, top, panel, tall), curves, frictions, title)
    damped = _above([*curves.damping.ravel(), study.drive.damping])
    box = (103.0, top, panel, tall)
    damping = _framed(ink, box, curves, [v / 1e3 for v in damped], "Secant damping F/v, kN·s/m")
    for axes, rows in ((friction, curves.friction), (damping, curves.damping / 1e3)):
        _curves(axes, curves, rows)
    for dry, color in _breakaways(study):
        _square(ink, 11.0, friction.y(math.log10(dry)), color)
    _point(friction, study)
    place = math.log10(1e3 * study.drive.speed)
    if study.drive.damping > 0 and inside(damping, place):
        dot(damping, place, math.log10(study.drive.damping / 1e3), BLACK)
    _key(ink, study, shown=inside(friction, math.log10(1e3 * study.drive.speed)))
    return ink


def _breakaways(study: SealStudy) -> list[tuple[float, str]]:
    """Breakaway at the curves' pressures; of two rings at the operating point alone.

    How two rings share a pressure is told by their films, which a standstill has not.
    """
    curves = study.curves
    if len(study.drive.rings) > 1 or curves is None:
        found = [(study.drive.breakaway, BLACK)]
    else:
        pairs = zip(curves.breakaway, STYLES, strict=False)
        found = [(float(dry), style["stroke"]) for dry, style in pairs]
    return [(dry, color) for dry, color in found if dry > 0]


def _key(ink: Ink, study: SealStudy, *, shown: bool) -> None:
    """What the marks mean, above the frames."""
    y, x = 3.0, 11.0
    point = study.drive
    at = f"{bars(point.pressure)}, {speed_words(point.speed)}"
    if shown:
        words = f"by the coefficient of friction, {at}"
        _cross(ink, x, y)
        ink.text(x + 2.5, y, words)
        x += text_width(words, 6.5) + 8.0
    pair = len(point.rings) > 1
    words = f"breakaway, dry, {bars(point.pressure)}" if pair else "breakaway, dry"
    _square(ink, x, y, BLACK if pair else GREY)
    ink.text(x + 2.5, y, words)
    if point.converged and shown:
        x += text_width(words, 6.5) + 8.0
        ink.circle(x, y, 0.75, fill=WHITE, stroke=BLACK, pen=0.3)
        ink.text(x + 2.5, y, "operating point, with the modulus' scatter")


def _square(ink: Ink, x: float, y: float, color: str) -> None:
    ink.box(x - 0.9, y - 0.9, 1.8, 1.8, fill=color, stroke=WHITE, pen=0.1)


def _cross(ink: Ink, x: float, y: float) -> None:
    for side in (-1.1, 1.1):
        ink.line((x - 1.1, y - side), (x + 1.1, y + side), pen=0.35)


def _friction_marks(study: SealStudy) -> list[float]:
    point = study.drive
    return [point.coefficient_friction, point.friction, point.lower, point.upper]


def _above(values: Any) -> list[float]:
    return [float(v) for v in np.ravel(np.asarray(values)) if v > 0 and math.isfinite(v)]


def _logarithmic(values: Sequence[float]) -> tuple[float, float]:
    """Range of a logarithmic axis, at least half a decade."""
    low, high = math.log10(min(values)), math.log10(max(values))
    spare = max(0.05 * (high - low), (0.5 - (high - low)) / 2, 0.04)
    return low - spare, high + spare


def _framed(
    ink: Ink,
    box: tuple[float, float, float, float],
    curves: FilmMap,
    values: Sequence[float],
    title: str,
) -> Axes:
    """A frame with logarithmic axes over the speeds of the curves."""
    speeds = logs(1e3 * curves.speeds)
    across = (speeds[0], speeds[-1])
    axes = Axes(ink, box, across, _logarithmic(values))
    marks = level_ticks(*axes.y_range)
    axes.frame_at(title, "speed, mm/s", level_ticks(*across), marks, upright=True)
    return axes


def _curves(axes: Axes, curves: FilmMap, rows: np.ndarray) -> None:
    """A curve per pressure, in pieces where a film is missing, with its label."""
    ends = []
    xs = logs(1e3 * curves.speeds)
    for row, style, pressure in zip(rows, STYLES, curves.pressures, strict=False):
        lines = []
        for piece in pieces(xs, [float(v) for v in row]):
            lines += axes.clipped([x for x, _ in piece], [math.log10(v) for _, v in piece])
        axes.ink.path(lines, **style)
        if lines:
            ends.append((lines[-1][-1], bars(float(pressure)), style["stroke"]))
    _labels(axes, ends)


def _labels(axes: Axes, ends: Sequence[tuple[Point, str, str]]) -> None:
    """Words of curves beside their ends, spread where they come close."""
    right = axes.left + axes.width
    drawn = sorted(ends, key=lambda one: one[0][1])
    wanted = [end[1] for end, _, _ in drawn]
    low, high = axes.top + 1.0, axes.top + axes.height - 1.0
    places = spread_within(wanted, [3.4] * len(wanted), low, high)
    for (end, words, color), y in zip(drawn, places, strict=True):
        axes.ink.line(end, (right + 1.0, end[1]), (right + 3.0, y), pen=0.13, stroke=GREY)
        axes.ink.text(right + 3.6, y, words, color=color)


def _point(axes: Axes, study: SealStudy) -> None:
    """The operating point with its band, and what the coefficient of friction gives there."""
    point, ink = study.drive, axes.ink
    place = math.log10(1e3 * point.speed)
    if not inside(axes, place):
        return
    x = axes.x(place)
    if point.coefficient_friction > 0:
        _cross(ink, x, axes.y(math.log10(point.coefficient_friction)))
    ends = _above([point.lower, point.upper])
    if len(ends) == 2:
        low, high = (axes.y(math.log10(v)) for v in ends)
        ink.line((x, low), (x, high), pen=0.3)
        for y in (low, high):
            ink.line((x - 1.0, y), (x + 1.0, y), pen=0.3)
    if point.friction > 0:
        dot(axes, place, math.log10(point.friction), BLACK)
