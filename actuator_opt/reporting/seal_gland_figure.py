"""The seals of piston or rod in their grooves, true to an ISO 5455 scale.

Rings are drawn as mounted, without pressure, with their section kept; dashed, what the surface
presses back. The sealed side is left. Lands between grooves are cut short where they are long.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from ..design import paths
from ..design.model import Design
from ..evaluation.grooves import Groove, grooves
from ..evaluation.rings import Place
from ..evaluation.study.seal import SealStudy
from ..evaluation.values import Values
from .drawing import OUTLINE, THIN, choose_scale, scale_bar
from .ink import BLACK, GREY, Ink, Point, Polygon, hatch, spread_within, text_width
from .seal_shapes import Shape, shapes_of
from .text import trimmed

_METAL, _OIL, _WHITE = "#eef1f3", "#dcecf7", "#ffffff"
_FILLS = {
    "elastomer": ("#444b53", None),
    "polymer": ("#f6ead2", (45.0, 1.0)),
    "back-up": ("#d9c9e3", (135.0, 0.8)),
}
_SIDE = 27.0
"""Paper beside the drawing for the words of both sides (mm)."""
_LAND = 9.0
"""Longest land drawn (mm of paper); a longer one is cut."""
_BAND, _WALL = 7.5, 4.0
"""Paper of the counterface's part, and of the housing behind the deepest groove (mm)."""
_TALL = 34.0
"""Deepest gland on paper (mm)."""
_LINE = 3.1


@dataclass(frozen=True, slots=True)
class Slot:
    """A groove with its rings as shapes; x from its left side, r from the counterface, in m."""

    groove: Groove
    depth: float
    width: float
    shapes: tuple[Shape, ...]


@dataclass(frozen=True, slots=True)
class GlandDrawing:
    """The drawing, its scale in words, and millimetres of paper per metre."""

    ink: Ink
    scale: str
    millimetres_per_metre: float


@dataclass(frozen=True, slots=True)
class _Frame:
    """Where a groove's coordinates fall on paper; `side` is -1 where grooves lie above."""

    factor: float
    surface: float
    side: float

    def point(self, left: float, x: float, r: float) -> Point:
        """Paper of x (m from `left` mm) and r (m from the counterface)."""
        return left + x * self.factor, self.y(r)

    def y(self, r: float) -> float:
        return self.surface + self.side * r * self.factor

    def off(self, beyond: float, r: float) -> float:
        """Paper `beyond` mm past r, away from the counterface."""
        return self.y(r) + self.side * beyond


def slots(design: Design, place: Place) -> tuple[Slot, ...]:
    """Every groove of a place, from the pressure outwards, with what lies in it."""
    values = Values(paths.numbers(design), ())
    found = []
    for groove in grooves(values, design, place):
        depth, width = float(groove.gland_depth), float(groove.width)
        shapes = shapes_of(design, place, groove)
        found.append(Slot(groove, depth, width, shapes))
    return tuple(found)


def tolerance_text(value: float, tolerance: float) -> str:
    """A length in mm with its tolerance.

    >>> tolerance_text(1.531e-3, 0.05e-3), tolerance_text(24e-3, 0.0)
    ('1.531 ±0.05', '24')
    """
    plus = f" ±{trimmed(1e3 * tolerance, 3)}" if tolerance > 0 else ""
    return f"{trimmed(1e3 * value)}{plus}"


def gland_drawing(study: SealStudy, *, width: float = 180.0) -> GlandDrawing:
    """Grooves, rings, counterface and gap of a place, dimensioned."""
    found = slots(study.design, study.place)
    deepest = max(slot.depth for slot in found)
    room = width - 2 * _SIDE
    lands = (len(found) + 1) * _LAND
    wide = sum(slot.width for slot in found)
    paper, real = choose_scale(wide, deepest, room - lands, _TALL)
    factor = 1000.0 * paper / real
    rod = study.place == "rod"
    head = 13.0 + _LINE * max(len(_caption(study, slot)) for slot in found) + _WALL
    span = deepest * factor
    below = _BAND + 12.0
    height = head + span + below + 7.0
    surface = head + span if rod else below
    frame = _Frame(factor, surface, -1.0 if rod else 1.0)
    ink = Ink(width, height)
    lefts, start, end, cuts = _lefts(study, found, factor, width)
    _bodies(ink, frame, study, found, lefts, (start, end), deepest)
    for slot, left in zip(found, lefts, strict=True):
        _fill(ink, frame, slot, left)
    _cuts(ink, frame, cuts, off=frame.off(_WALL, deepest), gap=study.clearance)
    _dimensions(ink, frame, study, found, lefts, deepest)
    _captions(ink, frame, study, found, lefts, deepest)
    _sides(ink, frame, study, found, lefts, (start, end))
    scale = f"{paper}:{real}"
    scale_bar(ink, factor, height - 2.4)
    words = "ISO 5455, mounted, without pressure, dimensions in mm"
    ink.text(width, height - 2.4, words, size=6.5, anchor="right", color=GREY)
    at = width - text_width(words, 6.5) - 3.0
    ink.text(at, height - 2.4, f"SCALE {scale}", size=7.5, anchor="right", bold=True)
    return GlandDrawing(ink, scale, factor)


def _lefts(
    study: SealStudy, found: Sequence[Slot], factor: float, width: float
) -> tuple[list[float], float, float, list[float]]:
    """Paper x of every groove, both ends of the part, and where a land is cut short."""
    part = study.design.piston if study.place == "piston" else study.design.head
    used = sum(slot.width * float(slot.groove.count) for slot in found)
    count = sum(float(slot.groove.count) for slot in found)
    true = (part.length - used) / (count + 1) * factor
    land = min(max(true, 2.0), _LAND)
    total = sum(slot.width for slot in found) * factor + (len(found) + 1) * land
    x = start = (width - total) / 2
    lefts = []
    for slot in found:
        x += land
        lefts.append(x)
        x += slot.width * factor
    shortened = true > _LAND
    middles = [a + s.width * factor for a, s in zip(lefts, found, strict=True)][:-1]
    cuts = [start, x + land] if shortened else []
    if shortened:
        cuts += [at + land / 2 for at in middles]
    return lefts, start, x + land, sorted(cuts)


def _bodies(
    ink: Ink,
    frame: _Frame,
    study: SealStudy,
    found: Sequence[Slot],
    lefts: Sequence[float],
    ends: tuple[float, float],
    deepest: float,
) -> None:
    """Oil in the gap, the counterface's part, the housing with its grooves."""
    start, end = ends
    first = next(i for i, s in enumerate(found) if s.groove.role == "element")
    wet = lefts[first]
    gap, near = frame.y(study.clearance), frame.y(0.0)
    bottom = frame.off(_WALL, deepest)
    ink.path(
        [[(start, near), (wet, near), (wet, gap), (start, gap)]],
        stroke=None,
        fill=_OIL,
        closed=True,
    )
    for slot, left in zip(found, lefts, strict=True):
        if slot.groove.role == "element":
            right = left + slot.width * frame.factor
            floor = frame.y(slot.depth)
            box = [(left, near), (right, near), (right, floor), (left, floor)]
            ink.path([box], stroke=None, fill=_OIL, closed=True)
    edge: list[Point] = [(start, gap)]
    for slot, left in zip(found, lefts, strict=True):
        right, floor = left + slot.width * frame.factor, frame.y(slot.depth)
        edge += [(left, gap), (left, floor), (right, floor), (right, gap)]
    edge.append((end, gap))
    body: Polygon = [*edge, (end, bottom), (start, bottom)]
    other = near - frame.side * _BAND
    band: Polygon = [(start, near), (end, near), (end, other), (start, other)]
    for polygon, angle in ((body, 45.0), (band, 135.0)):
        ink.path([polygon], stroke=None, fill=_METAL, closed=True)
        ink.path(hatch([polygon], angle=angle, spacing=1.8), pen=0.08, stroke="#9aa3ab")
    ink.path([edge], pen=OUTLINE)
    ink.path([[(start, near), (end, near)]], pen=OUTLINE)
    name = "bore" if study.place == "piston" else "rod"
    diameter = study.out.rings[0].ring["diameter"]
    middle = (near + other) / 2
    words = f"{name} ⌀{trimmed(1e3 * float(diameter))}"
    ink.text((start + end) / 2, middle, words, size=7.0, anchor="center", halo=True)


def _fill(ink: Ink, frame: _Frame, slot: Slot, left: float) -> None:
    """What lies in a groove: bodies, then what is pressed back, dashed."""
    for shape in slot.shapes:
        points = [frame.point(left, x, r) for x, r in shape.points]
        if shape.kind == "free":
            ink.path([points], pen=0.13, stroke=BLACK, dash=(0.9, 0.5), closed=True)
            continue
        paint, pattern = _FILLS[shape.kind]
        ink.path([points], stroke=None, fill=paint, closed=True)
        if pattern is not None:
            lines = hatch([points], angle=pattern[0], spacing=pattern[1])
            ink.path(lines, pen=0.08, stroke=GREY)
        ink.path([points], pen=OUTLINE, closed=True)


def _cuts(ink: Ink, frame: _Frame, cuts: Sequence[float], *, off: float, gap: float) -> None:
    """Break lines: a white stripe between two zigzags, through housing and counterface."""
    low, high = sorted((off, frame.y(0.0) - frame.side * _BAND))
    for x in cuts:
        steps = max(2, round((high - low) / 3.0))
        ys = [low + (high - low) * k / steps for k in range(steps + 1)]
        sway = [x + (0.5 if k % 2 else -0.5) for k in range(steps + 1)]
        a = [(s - 0.35, y) for s, y in zip(sway, ys, strict=True)]
        b = [(s + 0.35, y) for s, y in zip(sway, ys, strict=True)]
        ink.path([[*a, *b[::-1]]], stroke=None, fill=_WHITE, closed=True)
        ink.path([a, b], pen=0.13, stroke=GREY)


def _arrows(ink: Ink, a: Point, b: Point) -> None:
    """A dimension line between two places; from outside where they are close."""
    length = math.dist(a, b)
    if length >= 4.5:
        ink.line(a, b, pen=THIN)
        ink.arrow(a, b, length=1.6)
        ink.arrow(b, a, length=1.6)
        return
    step = ((b[0] - a[0]) / length, (b[1] - a[1]) / length)
    for tip, sign in ((a, -1.0), (b, 1.0)):
        tail = (tip[0] + sign * 2.6 * step[0], tip[1] + sign * 2.6 * step[1])
        ink.line(tip, tail, pen=THIN)
        ink.arrow(tip, tail, length=1.4)
    ink.line(a, b, pen=THIN)


def _dimensions(
    ink: Ink,
    frame: _Frame,
    study: SealStudy,
    found: Sequence[Slot],
    lefts: Sequence[float],
    deepest: float,
) -> None:
    """Groove widths behind the housing, gland depths inside the right land of each groove."""
    level = frame.off(_WALL + 3.0, deepest)
    for slot, left in zip(found, lefts, strict=True):
        right = left + slot.width * frame.factor
        for x in (left, right):
            ink.line((x, frame.off(0.4, slot.depth)), (x, frame.off(1.2, deepest + 0.0)), pen=0.0)
            ink.line((x, frame.off(0.5, slot.depth)), (x, level + frame.side * 0.8), pen=0.1)
        _arrows(ink, (left, level), (right, level))
        at = right + 2.6
        ink.line((right + 0.3, frame.y(slot.depth)), (at + 0.8, frame.y(slot.depth)), pen=0.1)
        _arrows(ink, (at, frame.y(0.0)), (at, frame.y(slot.depth)))
    del study


def _caption(study: SealStudy, slot: Slot) -> list[str]:
    """Lines that name a groove and its sizes."""
    element = _element(study.design, study.place, slot.groove)
    lines = [slot.groove.place if slot.groove.count == 1 else f"{slot.groove.count:g} × {slot.groove.place}"]
    if element is None:
        lines.append(slot.groove.material)
        lines.append(f"depth {trimmed(1e3 * slot.depth)}")
        lines.append(f"width {trimmed(1e3 * slot.width)}")
        return lines
    kind = element.type.replace("_", " ")
    lines.append(kind)
    lines.append(slot.groove.material)
    lines.append(f"section {tolerance_text(element.section, element.section_tolerance)}")
    lines.append(f"depth {tolerance_text(slot.depth, element.tolerance)}")
    lines.append(f"groove {trimmed(1e3 * slot.width)}")
    return lines
