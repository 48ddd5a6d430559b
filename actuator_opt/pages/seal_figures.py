"""Seals as ink: gland, squeeze, contact and film, friction over speed, map, finite elements.

Curves differ in dash as well as in colour. Squares on the left rim are breakaway friction, the
cross is what the coefficient of friction gives instead of the film. Sections lie in their groove
true to scale, the sealed side left.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import cycle, pairwise
from typing import Any

import numpy as np

from ..design import paths
from ..design.model import Design
from ..design.seals import Guide, Seal, SealElement, Wiper
from ..evaluation.geometry import Groove, grooves as cut_grooves
from ..evaluation.rings import Place, Ring
from ..evaluation.sealing import closed_form, room
from ..evaluation.values import Values
from ..rendering import contours
from ..rendering.axes import Axes, dot, fitted, legend, level_ticks, ticks
from ..rendering.blocks import clean
from ..rendering.contours import bands, levels, scale, shades
from ..rendering.ink import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    OCHRE,
    PALE,
    RED,
    WHITE,
    Ink,
    Point,
    Polygon,
    hatch,
    spread_within,
    text_width,
)
from ..rendering.text import AT_LEAST, AT_MOST, bars, degrees, number, speed_words, trimmed
from ..seals.contact import Shape, box
from ..seals.seal_type import Room
from ..studies.seal import FilmMap, RingPoint, SealStudy, SqueezeRow
from .dynamics_figures import STYLES, inside, logs
from .section import OUTLINE, THIN, choose_scale, scale_bar

STATIC: dict[str, Any] = {"stroke": GREY, "pen": 0.4, "dash": (0.5, 0.6)}
OIL: dict[str, Any] = {"stroke": BLUE, "pen": 0.4}
ASPERITY: dict[str, Any] = {"stroke": OCHRE, "pen": 0.4, "dash": (1.6, 0.8)}
OTHER: dict[str, Any] = {"stroke": GREEN, "pen": 0.4, "dash": (2.4, 0.7, 0.4, 0.7)}
LIMIT: dict[str, Any] = {"stroke": RED, "pen": 0.25, "dash": (1.8, 1.0)}
_BAR = "#4f86a8"
_ROW = 5.0
WIDTH = 180.0
"""Of every figure (mm of paper)."""
METAL, HATCHING = "#eef1f3", "#9aa3ab"


def stroke_names(study: SealStudy) -> tuple[str, str]:
    """What the stroke of a driven actuator is called at a place, and what the other one.

    A load that overruns the piston drives it against the pressure it seals.
    """
    return ("outstroke", "instroke") if study.place == "rod" else ("driven", "overrun")


# ---- gland ----

_OIL = "#dcecf7"
_FILLS = {
    "elastomer": ("#444b53", None),
    "polymer": ("#f6ead2", 45.0),
    "back-up": ("#d9c9e3", 135.0),
}
_BESIDE = (21.0, 28.0)
"""Paper left and right of the drawing for the words of both sides (mm)."""
_LAND = 7.0
"""Longest land drawn (mm of paper); a longer one is cut."""
_GLAND_BAND, _GLAND_WALL, _GLAND_HEIGHT = 7.5, 4.0, 34.0
"""Paper of the counterface's part, of the housing behind the deepest groove, of that (mm)."""
_LINE = 3.1


@dataclass(frozen=True, slots=True)
class FilledGroove:
    """A groove with what lies in it; x from its left side, r from the counterface, in m."""

    groove: Groove
    element: SealElement | None
    depth: float
    width: float
    shapes: tuple[Shape, ...]


@dataclass(frozen=True, slots=True)
class GlandDrawing:
    """The drawing, its scale in words, and millimetres of paper per metre."""

    ink: Ink
    scale: str
    millimetres_per_metre: float


def filled_grooves(design: Design, place: Place) -> tuple[FilledGroove, ...]:
    """Every groove of a place, from the pressure outwards, with what lies in it."""
    seal: Seal = getattr(design.seals, place)
    elements = seal.elements()
    filled: list[FilledGroove] = []
    for groove in cut_grooves(Values(paths.numbers(design), ()), design, place):
        depth, width = float(groove.gland_depth), float(groove.width)
        element = None
        shapes: tuple[Shape, ...] = ()
        if groove.role == "element":
            element = elements[groove.path.removeprefix(f"seals.{place}.")]
            shapes = element_shapes(element, depth=depth, width=width)
        elif groove.role == "wiper" and seal.wiper is not None:
            shapes = wiper_shapes(seal.wiper, depth=depth, width=width)
        elif seal.guide is not None:
            shapes = guide_shapes(seal.guide)
        filled.append(FilledGroove(groove, element, depth, width, shapes))
    return tuple(filled)


def tolerance_text(value: float, tolerance: float = 0.0) -> str:
    """A length in mm with its tolerance.

    >>> tolerance_text(1.531e-3, 0.05e-3), tolerance_text(24e-3)
    ('1.531 ±0.05', '24')
    """
    return trimmed(1e3 * value) + (f" ±{trimmed(1e3 * tolerance, 3)}" if tolerance > 0 else "")


@dataclass(frozen=True, slots=True)
class _Gland:
    """Where everything lies on paper; `side` is -1 where the grooves lie above the surface."""

    study: SealStudy
    grooves: tuple[FilledGroove, ...]
    ink: Ink
    factor: float
    surface: float
    side: float
    lefts: tuple[float, ...]
    start: float
    end: float
    land: float
    cuts: tuple[float, ...]

    @property
    def deepest(self) -> float:
        return max(filled.depth for filled in self.grooves)

    def y(self, r: float, beyond: float = 0.0) -> float:
        """Paper of r (m from the counterface), and some mm further away from it."""
        return self.surface + self.side * (r * self.factor + beyond)

    def right(self, index: int) -> float:
        return self.lefts[index] + self.grooves[index].width * self.factor


def gland_drawing(study: SealStudy, *, width: float = 180.0) -> GlandDrawing:
    """Grooves, rings, counterface and gap of a place, dimensioned."""
    grooves = filled_grooves(study.design, study.place)
    deepest, wide = max(filled.depth for filled in grooves), sum(filled.width for filled in grooves)
    room = width - sum(_BESIDE) - (len(grooves) + 1) * _LAND
    paper, real = choose_scale(wide, deepest, room, _GLAND_HEIGHT)
    factor = 1000.0 * paper / real
    lines = max(len(_caption(study, filled, room=True)) for filled in grooves)
    above = _LINE * lines + 9.0 + _GLAND_WALL + deepest * factor
    below = _GLAND_BAND + 6.0
    rod = study.place == "rod"
    ink = Ink(width, above + below + 6.5)
    land, total = _drawn_land(study, grooves, factor)
    start = _BESIDE[0] + (width - sum(_BESIDE) - total) / 2
    lefts = []
    x = start
    for filled in grooves:
        lefts.append(x + land)
        x += land + filled.width * factor
    surface = above if rod else below
    side = -1.0 if rod else 1.0
    cuts = _cut_places(study, grooves, lefts, factor, (start, x + land))
    frame = _Gland(
        study, grooves, ink, factor, surface, side, tuple(lefts), start, x + land, land, cuts
    )
    _bodies(frame)
    for filled, left in zip(grooves, lefts, strict=True):
        _rings(frame, filled, left)
    _breaks(frame)
    _dimensions(frame)
    _captions(frame)
    _sides(frame)
    _foot(ink, factor, f"{paper}:{real}")
    return GlandDrawing(ink, f"{paper}:{real}", factor)


def _true_land(study: SealStudy, grooves: Sequence[FilledGroove]) -> float:
    """Land between two grooves, evenly spread over piston or head [m]."""
    part = study.design.piston if study.place == "piston" else study.design.head
    counts = [float(filled.groove.count) for filled in grooves]
    used = sum(n * filled.width for n, filled in zip(counts, grooves, strict=True))
    return max(part.length - used, 0.0) / (sum(counts) + 1)


def _drawn_land(
    study: SealStudy, grooves: Sequence[FilledGroove], factor: float
) -> tuple[float, float]:
    """Land as drawn, and the whole length (mm of paper)."""
    land = min(_true_land(study, grooves) * factor, _LAND)
    return land, sum(filled.width for filled in grooves) * factor + (len(grooves) + 1) * land


def _cut_places(
    study: SealStudy,
    grooves: Sequence[FilledGroove],
    lefts: Sequence[float],
    factor: float,
    ends: tuple[float, float],
) -> tuple[float, ...]:
    if _true_land(study, grooves) * factor <= _LAND:
        return ()
    rights = [left + filled.width * factor for left, filled in zip(lefts, grooves, strict=True)]
    return (ends[0], *(right + 0.85 * _LAND for right in rights[:-1]), ends[1])


def _bodies(frame: _Gland) -> None:
    """Oil, the counterface's part, the housing with its grooves."""
    ink, start, end = frame.ink, frame.start, frame.end
    gap, near = frame.y(frame.study.clearance), frame.y(0.0)
    last = max(i for i, s in enumerate(frame.grooves) if s.element is not None)
    oil = [_rectangle(start, frame.lefts[last], near, gap)]
    for index in range(last + 1):
        floor = frame.y(frame.grooves[index].depth)
        oil.append(_rectangle(frame.lefts[index], frame.right(index), near, floor))
    ink.path(oil, stroke=None, fill=_OIL, closed=True)
    edge: list[Point] = [(start, gap)]
    for index, filled in enumerate(frame.grooves):
        left, right, floor = frame.lefts[index], frame.right(index), frame.y(filled.depth)
        edge += [(left, gap), (left, floor), (right, floor), (right, gap)]
    edge.append((end, gap))
    back = frame.y(frame.deepest, _GLAND_WALL)
    other = frame.y(0.0, -_GLAND_BAND)
    body: Polygon = [*edge, (end, back), (start, back)]
    for polygon, angle in ((body, 45.0), (_rectangle(start, end, near, other), 135.0)):
        ink.hatched(polygon, fill=METAL, angle=angle, spacing=1.8, stroke=HATCHING)
    ink.path([edge, [(start, near), (end, near)]], pen=OUTLINE)
    if not frame.cuts:
        ink.path([[(x, gap), (x, back)] for x in (start, end)], pen=OUTLINE)
    name = "bore" if frame.study.place == "piston" else "rod"
    words = f"{name} ⌀{trimmed(1e3 * frame.study.out.rings[0].ring['diameter'])}"
    ink.text(start + 1.8, (near + other) / 2, words, size=7.0, halo=True)


def _rectangle(left: float, right: float, low: float, high: float) -> list[Point]:
    return [(left, low), (right, low), (right, high), (left, high)]


def _rings(frame: _Gland, filled: FilledGroove, left: float) -> None:
    """What lies in a groove: bodies, then what is pressed back, dashed."""
    for shape in filled.shapes:
        points = [(left + x * frame.factor, frame.y(r)) for x, r in shape.points]
        if shape.kind == "free":
            frame.ink.path([points], pen=0.13, stroke=BLACK, dash=(0.9, 0.5), closed=True)
            continue
        paint, angle = _FILLS[shape.kind]
        if angle is None:
            frame.ink.path([points], stroke=None, fill=paint, closed=True)
        else:
            frame.ink.hatched(points, fill=paint, angle=angle, spacing=0.9, stroke=GREY)
        frame.ink.path([points], pen=OUTLINE, closed=True)


def _breaks(frame: _Gland) -> None:
    """White stripes between two zigzags, through housing and counterface."""
    low, high = sorted((frame.y(frame.deepest, _GLAND_WALL), frame.y(0.0, -_GLAND_BAND)))
    steps = max(2, round((high - low) / 3.0))
    ys = [low + (high - low) * k / steps for k in range(steps + 1)]
    for x in frame.cuts:
        sway = [x + (0.5 if k % 2 else -0.5) for k in range(steps + 1)]
        sides = [[(s + d, y) for s, y in zip(sway, ys, strict=True)] for d in (-0.35, 0.35)]
        stripe = [*sides[0], *sides[1][::-1]]
        frame.ink.path([stripe], stroke=None, fill=WHITE, closed=True)
        frame.ink.path(sides, pen=THIN, stroke=GREY)


def _span(ink: Ink, a: Point, b: Point) -> None:
    """A dimension line between two places, its arrows outside where there is no room inside."""
    length = math.dist(a, b)
    ink.line(a, b, pen=THIN)
    if length >= 4.0:
        ink.arrow(a, b, length=1.6)
        ink.arrow(b, a, length=1.6)
        return
    step = ((b[0] - a[0]) / length, (b[1] - a[1]) / length)
    for tip, sign in ((a, -1.0), (b, 1.0)):
        tail = (tip[0] + sign * 2.4 * step[0], tip[1] + sign * 2.4 * step[1])
        ink.line(tip, tail, pen=THIN)
        ink.arrow(tip, tail, length=1.4)


def _dimensions(frame: _Gland) -> None:
    """Groove widths behind the housing; gland depths in the land right of each groove."""
    ink, level = frame.ink, frame.y(frame.deepest, _GLAND_WALL + 2.6)
    words = [trimmed(1e3 * filled.width) for filled in frame.grooves]
    widths = [text_width(text, 6.5) for text in words]
    middles = [(left + frame.right(i)) / 2 for i, left in enumerate(frame.lefts)]
    gaps = [(a + b) / 2 + 1.5 for a, b in pairwise(widths)]
    places = spread_within(middles, gaps, 2.0, ink.width - 2.0)
    for index, filled in enumerate(frame.grooves):
        left, right = frame.lefts[index], frame.right(index)
        for x in (left, right):
            ink.line((x, frame.y(filled.depth, 0.5)), (x, level + 0.8 * frame.side), pen=0.1)
        _span(ink, (left, level), (right, level))
        ink.text(places[index], level + 2.0 * frame.side, words[index], anchor="center")
        if frame.land < _ROOM:
            continue
        at, floor = right + 2.0, frame.y(filled.depth)
        ink.line((right + 0.3, floor), (at + 0.8, floor), pen=0.1)
        _span(ink, (at, frame.y(0.0)), (at, floor))
        tolerance = 0.0 if filled.element is None else filled.element.tolerance
        half = text_width(tolerance_text(filled.depth, tolerance), 6.5) / 2 + 0.5
        middle = frame.y(filled.depth / 2)
        reach = frame.surface + frame.side * max(frame.side * (middle - frame.surface), half)
        ink.text(
            at + 2.0,
            reach,
            tolerance_text(filled.depth, tolerance),
            anchor="center",
            angle=-90.0,
            halo=True,
        )


_ROOM = 6.5
"""Land in which a gland depth can be written (mm of paper)."""


def _caption(study: SealStudy, filled: FilledGroove, *, room: bool) -> list[str]:
    """Lines that name a groove; its depth where the land has no room for it."""
    count = float(filled.groove.count)
    words = filled.groove.place.removeprefix(f"{study.place} ")
    lines = [words if count == 1 else f"{trimmed(count)} × {words}"]
    element = filled.element
    if element is not None:
        lines[0] += f": {element.type.replace('_', ' ')}"
    lines.append(fitted(clean(filled.groove.material), 34.0))
    if element is not None:
        lines.append(f"section {tolerance_text(element.section, element.section_tolerance)}")
    if not room:
        tolerance = 0.0 if element is None else element.tolerance
        lines.append(f"depth {tolerance_text(filled.depth, tolerance)}")
    return lines


def _captions(frame: _Gland) -> None:
    """Names beyond the widths, spread so that none meets another, with leaders."""
    room = frame.land >= _ROOM
    captions = [_caption(frame.study, filled, room=room) for filled in frame.grooves]
    widths = [max(text_width(line, 6.5, bold=True) for line in lines) for lines in captions]
    middles = [(left + frame.right(i)) / 2 for i, left in enumerate(frame.lefts)]
    gaps = [(a + b) / 2 + 2.5 for a, b in pairwise(widths)]
    places = spread_within(
        middles, gaps, widths[0] / 2 + 0.5, frame.ink.width - widths[-1] / 2 - 0.5
    )
    level = frame.y(frame.deepest, _GLAND_WALL + 6.2)
    for lines, middle, place in zip(captions, middles, places, strict=True):
        if abs(middle - place) > 1.0:
            elbow = level + 1.2 * frame.side
            frame.ink.line((middle, level), (place, elbow), pen=0.1, stroke=GREY)
        ordered = lines if frame.side > 0 else lines[::-1]
        for k, words in enumerate(ordered):
            y = level + frame.side * (3.0 + k * _LINE)
            frame.ink.text(place, y, words, anchor="center", bold=words == lines[0])


def _sides(frame: _Gland) -> None:
    """Both sides' pressures, the pressure between two rings, the gap and its growth."""
    study, ink = frame.study, frame.ink
    middle = frame.y(study.clearance / 2)
    held = f"{trimmed(study.drive.pressure / 1e5)} bar"
    left = frame.start - 2.5
    ink.line((left - 3.0, middle), (left + 1.5, middle), pen=THIN)
    ink.arrow((left + 1.5, middle), (left - 3.0, middle), length=1.6)
    ink.text(left - 4.0, middle, "sealed side", anchor="right")
    ink.text(left - 4.0, middle + _LINE, held, anchor="right", bold=True)
    right = frame.end + 1.5
    lines = ["outer side", "", f"radial gap {tolerance_text(study.clearance)}"]
    if study.growth > 0:
        lines += [f"+ growth {number(1e3 * study.growth, 2)}", f"at {held}"]
    ink.line((frame.end - 0.5, middle), (right + 2.0, middle + 2 * _LINE), pen=THIN)
    for k, words in enumerate(lines):
        ink.text(right + 3.0, middle + k * _LINE, words)
    if math.isfinite(study.drive.between):
        both = [i for i, filled in enumerate(frame.grooves) if filled.element is not None]
        x = frame.right(both[0]) + 0.9
        y = frame.y(0.0, -_GLAND_BAND - 3.0)
        ink.line((x, middle), (x, y - 1.6 * math.copysign(1.0, y - middle)), pen=0.1)
        ink.circle(x, middle, 0.4, fill=BLACK, pen=0.1)
        driven, other = stroke_names(study)
        words = f"between: {number(study.drive.between / 1e5)} bar {driven}"
        words += f", {number(study.other.between / 1e5)} bar {other}"
        ink.text(x, y, words, anchor="center")


def _foot(ink: Ink, factor: float, scale: str) -> None:
    y = ink.height - 2.4
    scale_bar(ink, factor, y)
    words = "ISO 5455, mounted, without pressure, dimensions in mm"
    ink.text(ink.width, y, words, anchor="right", color=GREY)
    at = ink.width - text_width(words, 6.5) - 3.0
    ink.text(at, y, f"SCALE {scale}", size=7.5, anchor="right", bold=True)


def element_shapes(element: SealElement, *, depth: float, width: float) -> tuple[Shape, ...]:
    """What lies in a groove `depth` deep and `width` wide, back-up rings included."""
    back = element.back_up_thickness or 0.0
    start = back if element.back_up == "both" else 0.0
    end = width - (back if element.back_ups else 0.0)
    backs: tuple[Shape, ...] = ()
    if element.back_ups:
        backs += (Shape("back-up", box(end, width, 0.0, depth)),)
    if element.back_up == "both":
        backs += (Shape("back-up", box(0.0, back, 0.0, depth)),)
    own = {"section": element.section, "gland_depth": depth}
    own |= element.seal_type.sizes(element.stated_sizes(), **own)
    return (*backs, *element.seal_type.outline(own, Room(start, end, depth)))


def wiper_shapes(wiper: Wiper, *, depth: float, width: float) -> tuple[Shape, ...]:
    """A wiper: its body on the inner side, its lip towards the outer side."""
    give = max(wiper.section - depth, 0.0) / 2
    tip = min(wiper.width, 0.9 * width)
    root, thick = width - tip, min(wiper.thickness, 0.8 * depth)
    body = (
        (0.0, give),
        (root, give),
        (width, 0.0),
        (width, 0.6 * thick),
        (root, give + thick),
        (root, depth),
        (0.0, depth),
    )
    free = ((root, give), (width, -give), (width, 0.6 * thick - give), (root, give + thick))
    return Shape("elastomer", body), Shape("free", free)


def guide_shapes(guide: Guide) -> tuple[Shape, ...]:
    """A guide ring fills its groove."""
    return (Shape("polymer", box(0.0, guide.width, 0.0, guide.thickness)),)


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


def contact_figure(study: SealStudy, index: int) -> Ink:
    """Pressures of one ring on both strokes, and its film, from the sealed side outwards."""
    points = (study.drive.rings[index], study.other.rings[index])
    strokes = stroke_names(study)
    ink = Ink(WIDTH, 54.5)
    highest = max(
        float(np.max(curve)) / 1e6 for ring in points for curve in _pressures(ring) if len(curve)
    )
    panel, left = 43.0, 11.0
    for k, (ring, stroke) in enumerate(zip(points, strokes, strict=True)):
        box = (left + k * (panel + 15.0), 13.0, panel, 32.0)
        xs = _millimetres(ring)
        axes = Axes(ink, box, (0.0, xs[-1]), (0.0, 1.06 * highest))
        axes.frame(f"Pressure, {stroke}, MPa absolute", "from the sealed side, mm")
        for curve, style in zip(_pressures(ring), (STATIC, OIL, ASPERITY), strict=True):
            ink.path(axes.clipped(xs, [p / 1e6 for p in map(float, curve)]), **style)
    films = [[1e6 * float(h) for h in ring.film] for ring in points]
    long = max(_millimetres(ring)[-1] for ring in points)
    box = (left + 2 * (panel + 15.0), 13.0, panel, 32.0)
    axes = Axes(ink, box, (0.0, long), (0.0, 1.06 * max(map(max, films))))
    axes.frame("Film, mean planes, µm", "from the sealed side, mm")
    for ring, film, style in zip(points, films, (OIL, OTHER), strict=True):
        ink.path(axes.clipped(_millimetres(ring), film), **style)
    words = [("static", STATIC), ("oil", OIL), ("asperities", ASPERITY)]
    legend(ink, left, 3.0, words, ends=False)
    legend(ink, box[0], 3.0, list(zip(strokes, (OIL, OTHER), strict=True)), ends=False)
    return ink


def _pressures(ring: RingPoint) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return ring.static, ring.oil, ring.asperity


def _millimetres(ring: RingPoint) -> list[float]:
    return [1e3 * float(x) for x in ring.x]


# ---- friction and damping over speed ----


def pieces(xs: Sequence[float], ys: Sequence[float]) -> Iterable[list[tuple[float, float]]]:
    """Stretches of a curve whose values are above zero.

    >>> list(pieces([0, 1, 2, 3, 4], [1.0, 2.0, math.nan, 3.0, 4.0]))
    [[(0, 1.0), (1, 2.0)], [(3, 3.0), (4, 4.0)]]
    """
    piece: list[tuple[float, float]] = []
    for x, y in zip(xs, ys, strict=True):
        if y > 0 and math.isfinite(y):
            piece.append((x, y))
            continue
        if len(piece) > 1:
            yield piece
        piece = []
    if len(piece) > 1:
        yield piece


def drawable(film_map: FilmMap | None) -> bool:
    """Whether there is anything to draw: two points with a friction above zero."""
    return film_map is not None and int(np.sum(np.nan_to_num(film_map.friction) > 0)) >= 2


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

    Two rings share a pressure by their films; at standstill there is none.
    """
    curves = study.curves
    if len(study.drive.rings) > 1 or curves is None:
        marks = [(study.drive.breakaway, BLACK)]
    else:
        pairs = zip(curves.breakaway, STYLES, strict=False)
        marks = [(float(dry), style["stroke"]) for dry, style in pairs]
    return [(dry, color) for dry, color in marks if dry > 0]


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
    drawn = sorted(ends, key=lambda labelled: labelled[0][1])
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


# ---- map ----

_MAP_BOX = (62.0, 44.0)
"""Width and height of a map (mm)."""


def map_figure(study: SealStudy) -> Ink:
    """Friction (left) and secant damping (right), driven."""
    film_map = study.map
    assert film_map is not None
    ink = Ink(180.0, 62.0)
    title = f"Friction, {stroke_names(study)[0]}, N"
    _map_panel(ink, 11.0, study, film_map, title, film_map.friction)
    _map_panel(ink, 102.0, study, film_map, "Secant damping F/v, kN·s/m", film_map.damping / 1e3)
    return ink


def _map_panel(
    ink: Ink,
    left: float,
    study: SealStudy,
    film_map: FilmMap,
    title: str,
    values: np.ndarray,
) -> None:
    box = (left, 8.0, *_MAP_BOX)
    xs, ys = logs(1e3 * film_map.speeds), [float(p) / 1e5 for p in film_map.pressures]
    axes = Axes(ink, box, (xs[0], xs[-1]), (ys[0], ys[-1]))
    corners = [(box[0], box[1]), (box[0] + box[2], box[1])]
    corners += [(box[0] + box[2], box[1] + box[3]), (box[0], box[1] + box[3])]
    ink.path(hatch([corners], angle=45.0, spacing=1.6), pen=0.1, stroke=PALE)
    usable = values[np.isfinite(values) & (values > 0)]
    bounds = levels(float(usable.min()), float(usable.max()))
    table = np.ma.masked_invalid(np.log10(np.where(values > 0, values, np.nan)))
    bands(axes, xs, ys, table, bounds)
    for i, j in zip(*np.nonzero(table.mask if table.mask is not np.False_ else []), strict=True):
        _cross_out(axes, xs[int(j)], ys[int(i)])
    place, level = math.log10(1e3 * study.drive.speed), study.drive.pressure / 1e5
    if inside(axes, place) and ys[0] <= level <= ys[-1]:
        dot(axes, place, level, BLACK)
    marks = [(v, trimmed(v)) for v in ticks(ys[0], ys[-1], 5)]
    _map_frame(axes, title, level_ticks(xs[0], xs[-1]), marks)
    scale(ink, box, bounds)


def _map_frame(axes: Axes, title: str, x_ticks: Any, y_ticks: Any) -> None:
    """Ticks outside, no grid; the axes' names as those of the other figures."""
    ink, bottom, right = axes.ink, axes.top + axes.height, axes.left + axes.width
    for value, words in y_ticks:
        y = axes.y(value)
        ink.line((axes.left - 1.0, y), (axes.left, y), pen=0.13)
        ink.text(axes.left - 1.6, y, words, anchor="right")
    for value, words in x_ticks:
        x = axes.x(value)
        ink.line((x, bottom), (x, bottom + 1.0), pen=0.13)
        ink.text(x, bottom + 3.0, words, anchor="center")
    ink.box(axes.left, axes.top, axes.width, axes.height, pen=0.18)
    middle = (axes.left + right) / 2
    ink.text(middle, bottom + 7.0, "speed, mm/s", anchor="center", color=GREY)
    words = f"{title}; upwards: pressure, bar"
    ink.text(axes.left - 1.4, axes.top - 3.6, words, size=7.0, bold=True)


def _cross_out(axes: Axes, x: float, y: float) -> None:
    """A point without a film."""
    at = axes.x(x), axes.y(y)
    for side in (-0.7, 0.7):
        axes.ink.line((at[0] - 0.7, at[1] - side), (at[0] + 0.7, at[1] + side), pen=0.2)


# ---- finite elements ----

_SECTION_WALL, _SECTION_BAND, _SECTION_GAP, _SECTION_HEIGHT = 2.2, 3.0, 3.0, 46.0
"""Paper of the groove's walls, of the counterface, between two sections, of the groove (mm)."""
_PRESSURES, _WORDS, _SCALE = 6.0, 8.0, 9.0
"""Paper of the pressures above, of the words below, of the colour scale (mm)."""
MOST_BANDS = 12
"""Bands of stress at most."""
ELEMENT_CURVES: tuple[dict[str, Any], ...] = (
    {"stroke": GREY, "pen": 0.4, "dash": (0.5, 0.6)},
    *STYLES,
    {"stroke": RED, "pen": 0.4, "dash": (0.9, 0.6)},
)
"""Contact pressures from the mounted ring on."""
BY_ELEMENTS: dict[str, Any] = {"stroke": BLUE, "pen": 0.4}
BY_CLOSED_FORM: dict[str, Any] = {"stroke": BLACK, "pen": 0.3, "dash": (1.6, 0.8)}


def stress_levels(study: SealStudy) -> list[float]:
    """Round levels from zero to the highest stress of all sections or more [Pa]."""
    top = max(float(np.max(contact.field.von_mises)) for contact in study.elements) / 1e6
    step = ticks(0.0, top, MOST_BANDS - 1)[1]
    return [1e6 * k * step for k in range(math.ceil(top / step - 1e-9) + 1)]


@dataclass(frozen=True, slots=True)
class GrooveOnPaper:
    """The groove of one section on paper: its outer wall at `right`, its face at `surface`.

    `side` is -1 where the groove lies above the counterface; lengths in mm of paper per m.
    """

    right: float
    surface: float
    side: float
    factor: float
    wide: float
    deep: float

    def at(self, x: float, r: float) -> Point:
        """Paper of a place from the outer wall (negative) and away from the sliding face [m]."""
        return self.right + x * self.factor, self.surface + self.side * r * self.factor


def gland_sizes(ring: Ring) -> tuple[float, float]:
    """Length that the elements have in the groove, and its depth from the counterface [m]."""
    return room(ring), float(ring.element.seal_type.groove(ring.numbers).depth)


def stress_scale(study: SealStudy) -> tuple[int, int]:
    """Scale of the sections, paper to real."""
    wide, deep = gland_sizes(study.out.rings[0].ring)
    count = len(study.elements)
    panel = (WIDTH - (count - 1) * _SECTION_GAP) / count
    return choose_scale(wide, deep, panel - 2 * _SECTION_WALL, _SECTION_HEIGHT)


def stress_figure(study: SealStudy) -> Ink:
    """Von Mises stress of the section at every pressure, its contact in red."""
    wide, deep = gland_sizes(study.out.rings[0].ring)
    paper, real = stress_scale(study)
    factor, rod = 1000.0 * paper / real, study.place == "rod"
    tall = _SECTION_WALL + deep * factor + _SECTION_BAND
    ink = Ink(WIDTH, _PRESSURES + tall + _WORDS + _SCALE)
    surface = _PRESSURES + (tall - _SECTION_BAND if rod else _SECTION_BAND)
    levels = stress_levels(study)
    panel = (WIDTH + _SECTION_GAP) / len(study.elements)
    for k, contact in enumerate(study.elements):
        right = panel * k + (panel - _SECTION_GAP + wide * factor) / 2
        gland = GrooveOnPaper(right, surface, -1.0 if rod else 1.0, factor, wide, deep)
        _groove_walls(ink, gland)
        _stress_section(ink, gland, contact.field, levels)
        ends = [gland.at(contact.start, 0.0), gland.at(contact.start + contact.width, 0.0)]
        ink.line(*ends, stroke=RED, pen=0.9)
        middle = right - wide * factor / 2
        words = f"{bars(contact.pressure)}, mounted" if k == 0 else bars(contact.pressure)
        ink.text(middle, 2.6, words, anchor="center", bold=True)
        y = _PRESSURES + tall + 2.8
        highest = number(1e-6 * float(np.max(contact.field.von_mises)), 3)
        ink.text(middle, y, f"up to {highest} MPa", anchor="center")
        words = f"contact {number(1e3 * contact.width, 3)} mm"
        ink.text(middle, y + 3.2, words, anchor="center", color=RED)
    _stress_colours(ink, levels, ink.height - 6.0)
    words = f"SCALE {paper}:{real}"
    ink.text(WIDTH, ink.height - 4.6, words, size=7.5, anchor="right", bold=True)
    return ink


def _groove_walls(ink: Ink, gland: GrooveOnPaper) -> None:
    """Groove and counterface, cut, the groove's corners closed."""
    left, right = gland.at(-gland.wide, 0.0)[0], gland.right
    floor = gland.at(0.0, gland.deep)[1]
    outside = floor + gland.side * _SECTION_WALL
    groove = [(left, gland.surface), (left, floor), (right, floor), (right, gland.surface)]
    ends = (left - _SECTION_WALL, right + _SECTION_WALL)
    housing: Polygon = [
        (ends[0], gland.surface),
        *groove,
        (ends[1], gland.surface),
        (ends[1], outside),
        (ends[0], outside),
    ]
    beyond = gland.surface - gland.side * _SECTION_BAND
    other = [(ends[0], gland.surface), (ends[1], gland.surface), (ends[1], beyond)]
    other.append((ends[0], beyond))
    for polygon, angle in ((housing, 45.0), (other, 135.0)):
        ink.hatched(polygon, fill=METAL, angle=angle, spacing=1.4, stroke=HATCHING)
    face = [(ends[0], gland.surface), (ends[1], gland.surface)]
    ink.path([groove, face], pen=OUTLINE)


def _stress_section(ink: Ink, gland: GrooveOnPaper, field: Any, levels: Sequence[float]) -> None:
    """The bands of stress, then the outline of every body."""
    fills = shades(len(levels) - 1)
    wall = float(np.max(field.nodes[:, 0]))  # it leans on the outer wall
    corners = contours.corner_values(field.nodes, field.triangles, field.von_mises)
    banded = contours.mesh_bands(field.nodes, field.triangles, corners, levels)
    for paint, rings in zip(fills, banded, strict=True):
        lines = [[gland.at(x - wall, r) for x, r in ring] for ring in rings]
        ink.path(lines, stroke=paint, pen=0.05, fill=paint, closed=True)
    for rings in contours.mesh_outlines(field.nodes, field.triangles, field.body):
        lines = [[gland.at(x - wall, r) for x, r in ring] for ring in rings]
        ink.path(lines, pen=0.15, closed=True)


def _stress_colours(ink: Ink, levels: Sequence[float], y: float) -> None:
    """The bands with the levels between them."""
    count, wide = len(levels) - 1, 9.0
    words = "von Mises stress, MPa"
    ink.text(0.0, y + 1.4, words)
    left = 34.0
    for k, paint in enumerate(shades(count)):
        ink.box(left + k * wide, y, wide, 2.8, fill=paint, pen=0.1)
    for k, level in enumerate(levels):
        ink.text(left + k * wide, y + 4.8, trimmed(1e-6 * level), size=6.0, anchor="center")


# ---- contact over pressure ----


def elements_figure(study: SealStudy) -> Ink:
    """Contact pressures by elements and closed form; peak and width of both over the pressure."""
    ring = study.out.rings[0].ring
    ink = Ink(WIDTH, 115.0)
    styles = [style for _, style in zip(study.elements, cycle(ELEMENT_CURVES), strict=False)]
    names = [bars(contact.pressure) for contact in study.elements]
    legend(ink, 11.0, 3.0, list(zip(names, styles, strict=True)), ends=False)
    solved = [(contact.positions, contact.contact_pressure) for contact in study.elements]
    closed = [_closed_profile(ring, contact.pressure) for contact in study.elements]
    top = max(float(np.max(p)) for _, p in [*solved, *closed]) / 1e6
    long = max(float(x[-1]) for x, _ in [*solved, *closed]) * 1e3
    for left, title, curves in ((11.0, "elements", solved), (103.0, "closed form", closed)):
        axes = Axes(ink, (left, 13.0, 66.0, 36.0), (0.0, long), (0.0, 1.06 * top))
        axes.frame(f"Contact pressure, {title}, MPa", "from the sealed end of the contact, mm")
        for (x, p), style in zip(curves, styles, strict=True):
            ink.path(axes.clipped((1e3 * x).tolist(), (p / 1e6).tolist()), **style)
    legend(
        ink, 11.0, 61.0, [("elements", BY_ELEMENTS), ("closed form", BY_CLOSED_FORM)], ends=False
    )
    pressures = np.linspace(0.0, study.elements[-1].pressure, 41)
    closed_forms = [closed_form(ring.at(pressure=float(p))) for p in pressures]
    rows = (
        (11.0, "Peak contact pressure, MPa", "peak_pressure", "peak", 1e-6),
        (103.0, "Contact width, mm", "width", "width", 1e3),
    )
    for left, title, name, law, unit in rows:
        points = [unit * float(getattr(contact, name)) for contact in study.elements]
        line = [unit * float(getattr(contact, law)) for contact in closed_forms]
        _over_pressure(ink, left, title, study, points, pressures, line)
    return ink


def _closed_profile(ring: Ring, pressure: float) -> tuple[np.ndarray, np.ndarray]:
    """Places and contact pressures of the closed form."""
    contact = closed_form(ring.at(pressure=pressure))
    share = np.linspace(0.0, 1.0, 121)
    return share * float(contact.profile_width), np.asarray(contact.profile(share), dtype=float)


def _over_pressure(
    ink: Ink,
    left: float,
    title: str,
    study: SealStudy,
    points: Sequence[float],
    pressures: np.ndarray,
    line: Sequence[float],
) -> None:
    """A quantity of the elements at their pressures, and of the closed form over all."""
    top = 1.08 * max(*points, *line)
    most = float(pressures[-1]) / 1e5
    axes = Axes(ink, (left, 70.0, 66.0, 34.0), (0.0, most), (0.0, top))
    axes.frame(title, "sealed pressure, bar")
    ink.path(axes.clipped((pressures / 1e5).tolist(), line), **BY_CLOSED_FORM)
    places = [contact.pressure / 1e5 for contact in study.elements]
    ink.path(axes.clipped(places, points), **BY_ELEMENTS)
    for x, y in zip(places, points, strict=True):
        ink.circle(axes.x(x), axes.y(y), 0.75, fill=WHITE, stroke=BLUE, pen=0.3)
