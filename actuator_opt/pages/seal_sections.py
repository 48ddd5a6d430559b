"""Drawings of seal sections, true to scale: gland with its rings, and finite-element stress.

The sealed side is on the left.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from ..base.dataclass import dataclass
from ..design import paths
from ..design.model import Design
from ..design.seals import Guide, Seal, SealElement, Wiper
from ..evaluation.geometry import Groove, grooves as cut_grooves
from ..evaluation.rings import Place, Ring
from ..evaluation.sealing import room
from ..evaluation.values import Values
from ..rendering import contours
from ..rendering.axes import fitted, ticks
from ..rendering.blocks import clean
from ..rendering.contours import shades
from ..rendering.ink import (
    BLACK,
    GREY,
    RED,
    WHITE,
    Ink,
    Point,
    Polygon,
    spread_within,
    text_width,
)
from ..rendering.text import bars, number, trimmed
from ..seals.contact import Shape, box
from ..seals.seal_type import Room
from ..studies.seal import SealStudy
from .section import OUTLINE, THIN, choose_scale, scale_bar

WIDTH = 180.0
"""Width of every figure [mm]."""
METAL, HATCHING = "#eef1f3", "#9aa3ab"


def stroke_names(study: SealStudy) -> tuple[str, str]:
    """Names of the driven stroke and of its return.

    The names for a piston refer to what moves it: the oil pressure, or (overrun) a load that moves
    it against the sealed pressure.
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
"""Widths of the spaces for words to the left and to the right of the drawing (mm of paper)."""
_LAND = 7.0
"""Greatest drawn length of a land between grooves (mm of paper); longer lands are drawn with a
break."""
_GLAND_BAND, _GLAND_WALL, _GLAND_HEIGHT = 7.5, 4.0, 34.0
"""Drawn heights (mm of paper) of the counterface, of the housing behind the deepest groove, and of
this groove."""
_LINE = 3.1


@dataclass(frozen=True, slots=True)
class FilledGroove:
    """A groove and the bodies in it; x [m] starts at its left side, r [m] at the counterface."""

    groove: Groove
    element: SealElement | None
    depth: float
    width: float
    shapes: tuple[Shape, ...]


@dataclass(frozen=True, slots=True)
class GlandDrawing:
    """The drawing of a gland, its scale in words, and its scale in mm of paper per metre."""

    ink: Ink
    scale: str
    millimetres_per_metre: float


def filled_grooves(design: Design, place: Place) -> tuple[FilledGroove, ...]:
    """Every groove of piston or rod with the bodies in it, from the pressure side outwards."""
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
    """Conversion to positions on paper; `side` is -1 if the grooves lie above the surface."""

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
        """Position on paper of a radial distance r (m) from the counterface, plus `beyond` (mm)."""
        return self.surface + self.side * (r * self.factor + beyond)

    def right(self, index: int) -> float:
        return self.lefts[index] + self.grooves[index].width * self.factor


def gland_drawing(study: SealStudy, *, width: float = 180.0) -> GlandDrawing:
    """Dimensioned section to scale: grooves, rings, counterface and gap of piston or rod."""
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
    """Length of the land between two grooves [m], if grooves are evenly spaced along the part."""
    part = study.design.piston if study.place == "piston" else study.design.head
    counts = [float(filled.groove.count) for filled in grooves]
    used = sum(n * filled.width for n, filled in zip(counts, grooves, strict=True))
    return max(part.length - used, 0.0) / (sum(counts) + 1)


def _drawn_land(
    study: SealStudy, grooves: Sequence[FilledGroove], factor: float
) -> tuple[float, float]:
    """Drawn length of a land, and of the whole section (mm of paper)."""
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
    """Draw the oil, the counterface, and the housing with its grooves."""
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
    """Draw the bodies in a groove; outlines of undeformed rings are dashed."""
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
    """Draw break lines: white stripes between two zigzags, through housing and counterface."""
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
    """A dimension line between two points; if it is too short, its arrows are outside."""
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
    """Draw dimensions: groove widths behind the housing, gland depths right of each groove."""
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
"""Least drawn length of a land beside which a gland depth can be written (mm of paper)."""


def _caption(study: SealStudy, filled: FilledGroove, *, room: bool) -> list[str]:
    """Lines of words that name a groove; they include its depth if the land is too short for it."""
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
    """Write the names of grooves beyond the width dimensions, with leaders and without overlaps."""
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
    """Write the pressures on both sides and between the rings, and the gap with its growth."""
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
        words = f"between the rings: {number(study.drive.between / 1e5)} bar {driven}"
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
    """Bodies in a groove `depth` deep and `width` wide, back-up rings included."""
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
    """Outline of a wiper, with its body on the inner side and its lip towards the outer side."""
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
    """Outline of a guide ring, which fills its groove."""
    return (Shape("polymer", box(0.0, guide.width, 0.0, guide.thickness)),)


# ---- finite elements ----

_SECTION_WALL, _SECTION_BAND, _SECTION_GAP, _SECTION_HEIGHT = 2.2, 3.0, 3.0, 46.0
"""Drawn sizes (mm of paper): thickness of groove walls and counterface, distance between two
sections, and height of the groove."""
_PRESSURES, _WORDS, _SCALE = 6.0, 8.0, 9.0
"""Heights (mm of paper) of the pressures above a section, of the words below, and of the colour
scale."""
MOST_BANDS = 12
"""Largest number of stress bands."""


def stress_levels(study: SealStudy) -> list[float]:
    """Stress levels [Pa] at round numbers, from zero to the highest stress or beyond."""
    top = max(float(np.max(contact.field.von_mises)) for contact in study.elements) / 1e6
    step = ticks(0.0, top, MOST_BANDS - 1)[1]
    return [1e6 * k * step for k in range(math.ceil(top / step - 1e-9) + 1)]


@dataclass(frozen=True, slots=True)
class GrooveOnPaper:
    """Position of a groove on paper: its outer wall is at `right`, the sliding face at `surface`.

    `side` is -1 if the groove lies above the counterface. Scales are in mm of paper per m.
    """

    right: float
    surface: float
    side: float
    factor: float
    wide: float
    deep: float

    def at(self, x: float, r: float) -> Point:
        """Point on paper for x from the outer wall (negative) and r from the sliding face [m]."""
        return self.right + x * self.factor, self.surface + self.side * r * self.factor


def gland_sizes(ring: Ring) -> tuple[float, float]:
    """Axial space for the ring in the groove, and the groove's depth from the counterface [m]."""
    return room(ring), float(ring.element.seal_type.groove(ring.numbers).depth)


def stress_scale(study: SealStudy) -> tuple[int, int]:
    """Scale of the sections: length on paper, and real length."""
    wide, deep = gland_sizes(study.out.rings[0].ring)
    count = len(study.elements)
    panel = (WIDTH - (count - 1) * _SECTION_GAP) / count
    return choose_scale(wide, deep, panel - 2 * _SECTION_WALL, _SECTION_HEIGHT)


def stress_figure(study: SealStudy) -> Ink:
    """Von Mises stress of the ring's section at every pressure, to scale; contact is red."""
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
    """Draw the cut faces of groove and counterface."""
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
    """Draw the stress bands, then the outline of every body."""
    fills = shades(len(levels) - 1)
    wall = float(np.max(field.nodes[:, 0]))  # the ring touches the outer wall
    corners = contours.corner_values(field.nodes, field.triangles, field.von_mises)
    banded = contours.mesh_bands(field.nodes, field.triangles, corners, levels)
    for paint, rings in zip(fills, banded, strict=True):
        lines = [[gland.at(x - wall, r) for x, r in ring] for ring in rings]
        ink.path(lines, stroke=paint, pen=0.05, fill=paint, closed=True)
    for rings in contours.mesh_outlines(field.nodes, field.triangles, field.body):
        lines = [[gland.at(x - wall, r) for x, r in ring] for ring in rings]
        ink.path(lines, pen=0.15, closed=True)


def _stress_colours(ink: Ink, levels: Sequence[float], y: float) -> None:
    """Draw the colour scale: the stress bands with the levels between them."""
    count, wide = len(levels) - 1, 9.0
    words = "von Mises stress, MPa"
    ink.text(0.0, y + 1.4, words)
    left = 34.0
    for k, paint in enumerate(shades(count)):
        ink.box(left + k * wide, y, wide, 2.8, fill=paint, pen=0.1)
    for k, level in enumerate(levels):
        ink.text(left + k * wide, y + 4.8, trimmed(1e-6 * level), size=6.0, anchor="center")
