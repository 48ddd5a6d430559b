"""The seals of piston or rod in their grooves, true to an ISO 5455 scale.

Rings are drawn as mounted, without pressure; dashed, what the surface presses back. The sealed
side is left. Lands that are long on paper are cut short.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from ..design import paths
from ..design.model import Design
from ..design.seals import Seal, SealElement
from ..evaluation.grooves import Groove, grooves
from ..evaluation.rings import Place
from ..evaluation.values import Values
from ..rendering.axes import fitted
from ..rendering.blocks import clean
from ..rendering.ink import (
    BLACK,
    GREY,
    WHITE,
    Ink,
    Point,
    Polygon,
    hatch,
    spread_within,
    text_width,
)
from ..rendering.text import number, trimmed
from ..seals.outline import Shape
from ..studies.seal import SealStudy
from .seal_figures import stroke_names
from .seal_shapes import element_shapes, guide_shapes, wiper_shapes
from .section import OUTLINE, THIN, choose_scale, scale_bar

_METAL, _OIL, _LINES = "#eef1f3", "#dcecf7", "#9aa3ab"
_FILLS = {
    "elastomer": ("#444b53", None),
    "polymer": ("#f6ead2", 45.0),
    "back-up": ("#d9c9e3", 135.0),
}
_BESIDE = (21.0, 28.0)
"""Paper left and right of the drawing for the words of both sides (mm)."""
_LAND = 7.0
"""Longest land drawn (mm of paper); a longer one is cut."""
_BAND, _WALL, _TALL = 7.5, 4.0, 34.0
"""Paper of the counterface's part, of the housing behind the deepest groove, of that (mm)."""
_LINE = 3.1


@dataclass(frozen=True, slots=True)
class Slot:
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


def slots(design: Design, place: Place) -> tuple[Slot, ...]:
    """Every groove of a place, from the pressure outwards, with what lies in it."""
    seal: Seal = getattr(design.seals, place)
    elements = seal.elements()
    found = []
    for groove in grooves(Values(paths.numbers(design), ()), design, place):
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
        found.append(Slot(groove, element, depth, width, shapes))
    return tuple(found)


def tolerance_text(value: float, tolerance: float = 0.0) -> str:
    """A length in mm with its tolerance.

    >>> tolerance_text(1.531e-3, 0.05e-3), tolerance_text(24e-3)
    ('1.531 ±0.05', '24')
    """
    return trimmed(1e3 * value) + (f" ±{trimmed(1e3 * tolerance, 3)}" if tolerance > 0 else "")


@dataclass(frozen=True, slots=True)
class _Frame:
    """Where everything lies on paper; `side` is -1 where the grooves lie above the surface."""

    study: SealStudy
    found: tuple[Slot, ...]
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
        return max(slot.depth for slot in self.found)

    def y(self, r: float, beyond: float = 0.0) -> float:
        """Paper of r (m from the counterface), and some mm further away from it."""
        return self.surface + self.side * (r * self.factor + beyond)

    def right(self, index: int) -> float:
        return self.lefts[index] + self.found[index].width * self.factor


def gland_drawing(study: SealStudy, *, width: float = 180.0) -> GlandDrawing:
    """Grooves, rings, counterface and gap of a place, dimensioned."""
    found = slots(study.design, study.place)
    deepest, wide = max(slot.depth for slot in found), sum(slot.width for slot in found)
    room = width - sum(_BESIDE) - (len(found) + 1) * _LAND
    paper, real = choose_scale(wide, deepest, room, _TALL)
    factor = 1000.0 * paper / real
    lines = max(len(_caption(study, slot, room=True)) for slot in found)
    above = _LINE * lines + 9.0 + _WALL + deepest * factor
    below = _BAND + 6.0
    rod = study.place == "rod"
    ink = Ink(width, above + below + 6.5)
    land, total = _land(study, found, factor)
    start = _BESIDE[0] + (width - sum(_BESIDE) - total) / 2
    lefts = []
    x = start
    for slot in found:
        lefts.append(x + land)
        x += land + slot.width * factor
    surface = above if rod else below
    side = -1.0 if rod else 1.0
    cuts = _cut_places(study, found, lefts, factor, (start, x + land))
    frame = _Frame(
        study, found, ink, factor, surface, side, tuple(lefts), start, x + land, land, cuts
    )
    _bodies(frame)
    for slot, left in zip(found, lefts, strict=True):
        _rings(frame, slot, left)
    _breaks(frame)
    _dimensions(frame)
    _captions(frame)
    _sides(frame)
    _foot(ink, factor, f"{paper}:{real}")
    return GlandDrawing(ink, f"{paper}:{real}", factor)


def _true_land(study: SealStudy, found: Sequence[Slot]) -> float:
    """Land between two grooves, evenly spread over piston or head [m]."""
    part = study.design.piston if study.place == "piston" else study.design.head
    counts = [float(slot.groove.count) for slot in found]
    used = sum(n * slot.width for n, slot in zip(counts, found, strict=True))
    return max(part.length - used, 0.0) / (sum(counts) + 1)


def _land(study: SealStudy, found: Sequence[Slot], factor: float) -> tuple[float, float]:
    """Land as drawn, and the whole length (mm of paper)."""
    land = min(_true_land(study, found) * factor, _LAND)
    return land, sum(slot.width for slot in found) * factor + (len(found) + 1) * land


def _cut_places(
    study: SealStudy,
    found: Sequence[Slot],
    lefts: Sequence[float],
    factor: float,
    ends: tuple[float, float],
) -> tuple[float, ...]:
    if _true_land(study, found) * factor <= _LAND:
        return ()
    rights = [left + slot.width * factor for left, slot in zip(lefts, found, strict=True)]
    return (ends[0], *(right + 0.85 * _LAND for right in rights[:-1]), ends[1])


def _bodies(frame: _Frame) -> None:
    """Oil, the counterface's part, the housing with its grooves."""
    ink, start, end = frame.ink, frame.start, frame.end
    gap, near = frame.y(frame.study.clearance), frame.y(0.0)
    last = max(i for i, s in enumerate(frame.found) if s.element is not None)
    oil = [_rectangle(start, frame.lefts[last], near, gap)]
    for index in range(last + 1):
        floor = frame.y(frame.found[index].depth)
        oil.append(_rectangle(frame.lefts[index], frame.right(index), near, floor))
    ink.path(oil, stroke=None, fill=_OIL, closed=True)
    edge: list[Point] = [(start, gap)]
    for index, slot in enumerate(frame.found):
        left, right, floor = frame.lefts[index], frame.right(index), frame.y(slot.depth)
        edge += [(left, gap), (left, floor), (right, floor), (right, gap)]
    edge.append((end, gap))
    back = frame.y(frame.deepest, _WALL)
    other = frame.y(0.0, -_BAND)
    body: Polygon = [*edge, (end, back), (start, back)]
    for polygon, angle in ((body, 45.0), (_rectangle(start, end, near, other), 135.0)):
        ink.path([polygon], stroke=None, fill=_METAL, closed=True)
        ink.path(hatch([polygon], angle=angle, spacing=1.8), pen=0.08, stroke=_LINES)
    ink.path([edge, [(start, near), (end, near)]], pen=OUTLINE)
    if not frame.cuts:
        ink.path([[(x, gap), (x, back)] for x in (start, end)], pen=OUTLINE)
    name = "bore" if frame.study.place == "piston" else "rod"
    words = f"{name} ⌀{trimmed(1e3 * frame.study.out.rings[0].ring['diameter'])}"
    ink.text(start + 1.8, (near + other) / 2, words, size=7.0, halo=True)


def _rectangle(left: float, right: float, low: float, high: float) -> list[Point]:
    return [(left, low), (right, low), (right, high), (left, high)]


def _rings(frame: _Frame, slot: Slot, left: float) -> None:
    """What lies in a groove: bodies, then what is pressed back, dashed."""
    for shape in slot.shapes:
        points = [(left + x * frame.factor, frame.y(r)) for x, r in shape.points]
        if shape.kind == "free":
            frame.ink.path([points], pen=0.13, stroke=BLACK, dash=(0.9, 0.5), closed=True)
            continue
        paint, angle = _FILLS[shape.kind]
        frame.ink.path([points], stroke=None, fill=paint, closed=True)
        if angle is not None:
            frame.ink.path(hatch([points], angle=angle, spacing=0.9), pen=0.08, stroke=GREY)
        frame.ink.path([points], pen=OUTLINE, closed=True)


def _breaks(frame: _Frame) -> None:
    """White stripes between two zigzags, through housing and counterface."""
    low, high = sorted((frame.y(frame.deepest, _WALL), frame.y(0.0, -_BAND)))
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


def _dimensions(frame: _Frame) -> None:
    """Groove widths behind the housing; gland depths in the land right of each groove."""
    ink, level = frame.ink, frame.y(frame.deepest, _WALL + 2.6)
    words = [trimmed(1e3 * slot.width) for slot in frame.found]
    widths = [text_width(text, 6.5) for text in words]
    middles = [(left + frame.right(i)) / 2 for i, left in enumerate(frame.lefts)]
    gaps = [(a + b) / 2 + 1.5 for a, b in pairwise(widths)]
    places = spread_within(middles, gaps, 2.0, ink.width - 2.0)
    for index, slot in enumerate(frame.found):
        left, right = frame.lefts[index], frame.right(index)
        for x in (left, right):
            ink.line((x, frame.y(slot.depth, 0.5)), (x, level + 0.8 * frame.side), pen=0.1)
        _span(ink, (left, level), (right, level))
        ink.text(places[index], level + 2.0 * frame.side, words[index], anchor="center")
        if frame.land < _ROOM:
            continue
        at, floor = right + 2.0, frame.y(slot.depth)
        ink.line((right + 0.3, floor), (at + 0.8, floor), pen=0.1)
        _span(ink, (at, frame.y(0.0)), (at, floor))
        tolerance = 0.0 if slot.element is None else slot.element.tolerance
        half = text_width(tolerance_text(slot.depth, tolerance), 6.5) / 2 + 0.5
        middle = frame.y(slot.depth / 2)
        reach = frame.surface + frame.side * max(frame.side * (middle - frame.surface), half)
        ink.text(
            at + 2.0,
            reach,
            tolerance_text(slot.depth, tolerance),
            anchor="center",
            angle=-90.0,
            halo=True,
        )


_ROOM = 6.5
"""Land in which a gland depth can be written (mm of paper)."""


def _caption(study: SealStudy, slot: Slot, *, room: bool) -> list[str]:
    """Lines that name a groove; its depth where the land has no room for it."""
    count = float(slot.groove.count)
    words = slot.groove.place.removeprefix(f"{study.place} ")
    lines = [words if count == 1 else f"{trimmed(count)} × {words}"]
    element = slot.element
    if element is not None:
        lines[0] += f": {element.type.replace('_', ' ')}"
    lines.append(fitted(clean(slot.groove.material), 34.0))
    if element is not None:
        lines.append(f"section {tolerance_text(element.section, element.section_tolerance)}")
    if not room:
        tolerance = 0.0 if element is None else element.tolerance
        lines.append(f"depth {tolerance_text(slot.depth, tolerance)}")
    return lines


def _captions(frame: _Frame) -> None:
    """Names beyond the widths, spread so that none meets another, with leaders."""
    room = frame.land >= _ROOM
    captions = [_caption(frame.study, slot, room=room) for slot in frame.found]
    widths = [max(text_width(line, 6.5, bold=True) for line in lines) for lines in captions]
    middles = [(left + frame.right(i)) / 2 for i, left in enumerate(frame.lefts)]
    gaps = [(a + b) / 2 + 2.5 for a, b in pairwise(widths)]
    places = spread_within(
        middles, gaps, widths[0] / 2 + 0.5, frame.ink.width - widths[-1] / 2 - 0.5
    )
    level = frame.y(frame.deepest, _WALL + 6.2)
    for lines, middle, place in zip(captions, middles, places, strict=True):
        if abs(middle - place) > 1.0:
            elbow = level + 1.2 * frame.side
            frame.ink.line((middle, level), (place, elbow), pen=0.1, stroke=GREY)
        ordered = lines if frame.side > 0 else lines[::-1]
        for k, words in enumerate(ordered):
            y = level + frame.side * (3.0 + k * _LINE)
            frame.ink.text(place, y, words, anchor="center", bold=words == lines[0])


def _sides(frame: _Frame) -> None:
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
        both = [i for i, slot in enumerate(frame.found) if slot.element is not None]
        x = frame.right(both[0]) + 0.9
        y = frame.y(0.0, -_BAND - 3.0)
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
