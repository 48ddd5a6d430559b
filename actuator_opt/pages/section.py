"""The longitudinal section of the cylinder, hatched and dimensioned, at a scale of ISO 5455.

The layout follows rules: item balloons in a row above the cylinder, diameters in a row below it,
lengths below the diameters. `ink.spread_within` places every label, so that no two touch.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

from ..base.dataclass import dataclass
from ..evaluation.result import Evaluation, Outline
from ..rendering.ink import BLACK, GREY, Ink, Point, Polygon, hatch, spread_within, text_width
from ..rendering.text import trimmed

SCALES = tuple(
    (step * decade if enlarge else 1, 1 if enlarge else step * decade)
    for enlarge, steps, decades in (
        (True, (5, 2, 1), (10, 1)),
        (False, (2, 5, 10), (1, 10, 100, 1000)),
    )
    for decade in decades
    for step in steps
)
"""(paper, real) of ISO 5455, largest drawing first: 50:1 … 2:1, 1:1, 1:2 … 1:10 000."""

THIN, OUTLINE = 0.13, 0.18
BALLOON = 2.3
"""Radius of an item balloon (mm)."""

_METAL = ((45.0, 1.5), (135.0, 1.5), (45.0, 0.8), (135.0, 0.8), (30.0, 2.2), (150.0, 2.2))
_COMPOSITE = ((60.0, 0.7), (120.0, 0.7), (75.0, 1.0), (105.0, 1.0))
_TINTS = {
    "metal": "#eef1f3",
    "composite": "#d5dbe0",
    "polymer": "#f6ead2",
    "seal": "#2a2f35",
    "oil": "#dcecf7",
}


@dataclass(frozen=True, slots=True)
class Item:
    """One line of the drawing's parts list."""

    number: int
    part: str
    material: str


@dataclass(frozen=True, slots=True)
class SectionDrawing:
    """The drawing, its scale in words, and its parts list."""

    ink: Ink
    scale: str
    millimetres_per_metre: float
    items: tuple[Item, ...]


@dataclass(frozen=True, slots=True)
class _Frame:
    """Conversion of real coordinates (m) to positions on paper (mm)."""

    factor: float
    left: float
    axis: float
    first: float

    def x(self, position: float) -> float:
        return self.left + (position - self.first) * self.factor

    def point(self, position: float, radius: float) -> Point:
        return self.x(position), self.axis - radius * self.factor


def choose_scale(length: float, height: float, room: float, room_high: float) -> tuple[int, int]:
    """The largest ISO 5455 scale at which `length` × `height` (m) fits the space (mm).

    >>> choose_scale(0.23, 0.03, 150.0, 60.0)
    (1, 2)
    >>> choose_scale(0.03, 0.004, 150.0, 60.0)
    (5, 1)
    """
    for paper, real in SCALES:
        factor = 1000 * paper / real
        if length * factor <= room and height * factor <= room_high:
            return paper, real
    return SCALES[-1]


def section(
    evaluation: Evaluation, *, width: float = 180.0, height: float = 78.0
) -> SectionDrawing:
    """The dimensioned section of an evaluated design, `width` mm wide.

    The cylinder itself is drawn at most `height` mm high.
    """
    outlines = [o for o in evaluation.outlines if o.polygons]
    points = [p for o in outlines for polygon in o.polygons for p in polygon]
    if not points:
        ink = Ink(width, 8.0)
        ink.text(width / 2, 4.0, "No outlines: the section is not drawn.", anchor="center")
        return SectionDrawing(ink, "", 0.0, ())
    first, last = min(x for x, _ in points), max(x for x, _ in points)
    radius = max(r for _, r in points)
    paper, real = choose_scale(last - first, 2 * radius, width - 14.0, height)
    factor = 1000.0 * paper / real
    half = radius * factor
    items = tuple(Item(k + 1, o.part, o.material) for k, o in enumerate(outlines))
    rows = _balloon_rows(len(items), width)
    top = 1.0 + rows * (2 * BALLOON + 1.0) + 3.5
    frame = _Frame(factor, (width - (last - first) * factor) / 2, top + half, first)
    ink = Ink(width, top + 2 * half + 28.0)
    _parts(ink, frame, outlines)
    flanks = [
        [frame.point(x, side * r) for x, r in line] for line in evaluation.lines for side in (1, -1)
    ]
    if flanks:
        ink.path(flanks, pen=THIN)
    centre = [(frame.x(first) - 4.0, frame.axis), (frame.x(last) + 4.0, frame.axis)]
    ink.path([centre], stroke=GREY, pen=THIN, dash=(6.0, 1.2, 0.8, 1.2))
    _balloons(ink, frame, outlines, rows)
    base = top + 2 * half
    labels = _diameters(ink, frame, evaluation, outlines, base + 6.0)
    _lengths(ink, frame, evaluation.lengths, outlines, base, (first, last))
    for place, text in labels:
        ink.text(place, base + 6.0, text, size=7.0, anchor="center", halo=True)
    scale = f"{paper}:{real}"
    scale_bar(ink, factor, ink.height - 2.4)
    words = "ISO 5455, section, retracted, dimensions in mm"
    ink.text(width, ink.height - 2.4, words, size=6.5, anchor="right", color=GREY)
    left = width - text_width(words, 6.5) - 3.0
    ink.text(left, ink.height - 2.4, f"SCALE {scale}", size=7.5, anchor="right", bold=True)
    return SectionDrawing(ink, scale, factor, items)


def _layer(outline: Outline) -> int:
    """Order of drawing: the oil of the chamber, the parts, the oil in the ports."""
    if outline.kind != "oil":
        return 1
    return 2 if outline.radial else 0


def _patterns(outlines: Sequence[Outline]) -> dict[tuple[str, str], tuple[float, float]]:
    """Angle and spacing of the hatch of each material, assigned in order of appearance."""
    chosen: dict[tuple[str, str], tuple[float, float]] = {}
    for kind, table in (("metal", _METAL), ("composite", _COMPOSITE)):
        names = list(dict.fromkeys(o.material for o in outlines if o.kind == kind))
        for index, name in enumerate(names):
            chosen[kind, name] = table[index % len(table)]
    return chosen


def _parts(ink: Ink, frame: _Frame, outlines: Sequence[Outline]) -> None:
    patterns = _patterns(outlines)
    for outline in sorted(outlines, key=_layer):
        halves = [
            [frame.point(x, side * r) for x, r in polygon]
            for polygon in outline.polygons
            for side in outline.sides
        ]
        ink.path(halves, stroke=None, fill=_TINTS[outline.kind], closed=True)
        pattern = patterns.get((outline.kind, outline.material))
        if outline.kind == "polymer":
            pattern = (45.0, 1.8)
        if pattern is not None:
            lines = hatch(halves, angle=-pattern[0], spacing=pattern[1])
            if outline.kind == "polymer":
                lines += hatch(halves, angle=pattern[0], spacing=pattern[1])
            ink.path(lines, pen=0.09, stroke=GREY)
        if outline.kind != "oil" or outline.radial:
            ink.path(_edges(outline, frame), pen=OUTLINE)


def _edges(outline: Outline, frame: _Frame) -> list[list[Point]]:
    """Lines of an outline above and below the axis, except where polygons of a part touch."""
    segments = []
    for index, polygon in enumerate(outline.polygons):
        for a, b in zip(polygon, [*polygon[1:], polygon[0]], strict=True):
            if a != b and not (a[1] <= 0.0 and b[1] <= 0.0):
                segments.append((index, a, b))
    lines: list[list[Point]] = []
    for side in outline.sides:
        chain: list[Point] = []
        for index, a, b in segments:
            for ends in _uncovered(a, b, [s[1:] for s in segments if s[0] != index]):
                start, end = (frame.point(x, side * r) for x, r in ends)
                if chain and chain[-1] == start:
                    chain.append(end)
                else:
                    chain = [start, end]
                    lines.append(chain)
    return lines


def _uncovered(
    a: Point, b: Point, others: Sequence[tuple[Point, Point]]
) -> list[tuple[Point, Point]]:
    """The parts of an axis-parallel edge that no edge of another polygon covers."""
    axis = next((k for k in (0, 1) if abs(a[k] - b[k]) < 1e-9), None)
    if axis is None:
        return [(a, b)]
    along = 1 - axis
    sign = 1.0 if b[along] > a[along] else -1.0
    free = [(sign * a[along], sign * b[along])]
    for c, d in others:
        if abs(c[axis] - a[axis]) > 1e-9 or abs(d[axis] - a[axis]) > 1e-9:
            continue
        low, high = sorted((sign * c[along], sign * d[along]))
        free = [
            piece
            for start, end in free
            for piece in ((start, min(end, low)), (max(start, high), end))
            if piece[1] - piece[0] > 1e-9
        ]
    if axis == 0:
        return [((a[0], sign * start), (a[0], sign * end)) for start, end in free]
    return [((sign * start, a[1]), (sign * end, a[1])) for start, end in free]


def _balloon_rows(count: int, width: float) -> int:
    return max(1, -(-count * int(10 * (2 * BALLOON + 0.8)) // int(10 * (width - 6.0))))


def _spans(outline: Outline, position: float) -> list[tuple[float, float]]:
    """Radial intervals [m] in which a part has material at an axial position."""
    spans = []
    for polygon in outline.polygons:
        hits = []
        for (x1, r1), (x2, r2) in zip(polygon, [*polygon[1:], polygon[0]], strict=True):
            if (x1 <= position) != (x2 <= position):
                hits.append(r1 + (position - x1) * (r2 - r1) / (x2 - x1))
        hits.sort()
        spans += list(zip(hits[::2], hits[1::2], strict=False))
    return spans


def _area(polygon: Polygon) -> float:
    pairs = zip(polygon, [*polygon[1:], polygon[0]], strict=True)
    return 0.5 * sum(x1 * r2 - x2 * r1 for (x1, r1), (x2, r2) in pairs)


def _balloons(ink: Ink, frame: _Frame, outlines: Sequence[Outline], rows: int) -> None:
    """Numbered balloons above the drawing with leaders into their parts."""
    reach = []
    for number, outline in enumerate(outlines, 1):
        main = max(outline.polygons, key=lambda p: abs(_area(p)))
        low, high = min(x for x, _ in main), max(x for x, _ in main)
        reach.append(((low + high) / 2, -max(r for _, r in main), low, high, number, outline))
    reach.sort(key=lambda entry: entry[:2])
    gap = (2 * BALLOON + 0.8) / rows
    places = spread_within(
        [frame.x(centre) for centre, *_ in reach],
        [gap] * (len(reach) - 1),
        BALLOON + 0.5,
        ink.width - BALLOON - 0.5,
    )
    for index, ((_, _, low, high, number, outline), x) in enumerate(
        zip(reach, places, strict=True)
    ):
        y = BALLOON + 0.6 + (index % rows) * (2 * BALLOON + 1.0)
        wanted = frame.first + (x - frame.left) / frame.factor
        inset = 0.12 * (high - low)
        position = min(max(wanted, low + inset), high - inset)
        spans = _spans(outline, position)
        if not spans:
            continue
        inner, outer = max(spans, key=lambda s: (round((s[1] - s[0]) * 1e7), s[1]))
        target = frame.point(position, (inner + outer) / 2)
        if outer - inner > 6.0 / frame.factor:
            target = frame.point(position, outer - 3.0 / frame.factor)
        ink.line((x, y + BALLOON), target, pen=THIN, stroke=BLACK)
        dark = outline.kind == "seal"
        ink.circle(*target, 0.35, fill="#ffffff" if dark else BLACK, stroke=BLACK, pen=0.1)
        ink.circle(x, y, BALLOON, fill="#ffffff", pen=THIN)
        ink.text(x, y, str(number), size=6.5, anchor="center", bold=True)


def _chamber(
    frame: _Frame, outlines: Sequence[Outline], lengths: Mapping[str, float]
) -> tuple[float, float]:
    """Horizontal position on paper of the piston's rod-side face, retracted and extended."""
    stroke = lengths.get("stroke", 0.0)
    for outline in outlines:
        if outline.part == "piston":
            face = max(x for polygon in outline.polygons for x, _ in polygon)
            return frame.x(face), frame.x(face + stroke)
    ends = [x for o in outlines for polygon in o.polygons for x, _ in polygon]
    middle = (min(ends) + max(ends)) / 2
    return frame.x(middle - stroke / 2), frame.x(middle + stroke / 2)


def _diameters(
    ink: Ink,
    frame: _Frame,
    evaluation: Evaluation,
    outlines: Sequence[Outline],
    row: float,
) -> list[tuple[float, str]]:
    """Draw the dimensions of rod, bore and barrel diameter, across the free part of the chamber.

    That of a second rod with another diameter is drawn outside the cap.
    Returns the labels with their positions on `row`; they are written after the other lines.
    """
    labels = []
    wanted = [
        (lengths_key, label, outside)
        for lengths_key, label, outside in (
            ("rod", "rod", True),
            ("bore", "bore", False),
            ("barrel_outer_diameter", "barrel", True),
        )
        if lengths_key in evaluation.lengths
    ]
    second = evaluation.lengths.get("second_rod")
    apart = second is not None and second != evaluation.lengths["rod"]
    if apart:
        wanted.insert(0, ("second_rod", "second rod", True))
    start, end = _chamber(frame, outlines, evaluation.lengths)
    texts = [f"⌀{trimmed(1000 * evaluation.lengths[k])} {label}" for k, label, _ in wanted]
    widths = [text_width(text, 7.0) for text in texts]
    count = len(wanted)
    if apart:
        count -= 1
    lines = [start + (end - start) * (2 * k + 1) / (2 * count) for k in range(count)]
    if apart:
        lines.insert(0, frame.x(evaluation.lengths["face"] / 2))
    gaps = [(a + b) / 2 + 3.0 for a, b in pairwise(widths)]
    ends = (widths[0] / 2 + 1.5, widths[-1] / 2 + 1.5) if widths else (0.0, 0.0)
    if apart or end - start < sum(gaps) + sum(ends):
        places = spread_within(lines, gaps, ends[0], ink.width - ends[1])
    else:
        places = spread_within(lines, gaps, start + ends[0], end - ends[1])
    for (key, _, outside), text, x, place in zip(wanted, texts, lines, places, strict=True):
        half = evaluation.lengths[key] / 2 * frame.factor
        upper, lower = (x, frame.axis - half), (x, frame.axis + half)
        size = min(2.0, max(0.9, half / 2))
        elbow = (x, row - 2.8) if abs(place - x) > 0.5 else (x, row - 1.6)
        if outside:
            ink.line((x, upper[1] - 2 * size), upper, pen=THIN)
            ink.line(lower, elbow, pen=THIN)
            ink.arrow(upper, (x, upper[1] - 9.0), length=size)
            ink.arrow(lower, (x, lower[1] + 9.0), length=size)
        else:
            ink.line(upper, elbow, pen=THIN)
            ink.arrow(upper, lower, length=size)
            ink.arrow(lower, upper, length=size)
        if abs(place - x) > 0.5:
            ink.line(elbow, (place, row - 1.6), pen=THIN)
        labels.append((place, text))
    return labels


def _lengths(
    ink: Ink,
    frame: _Frame,
    lengths: Mapping[str, float],
    outlines: Sequence[Outline],
    base: float,
    ends: tuple[float, float],
) -> None:
    """Dimension the stroke and the closed length, each on its own line below the parts."""
    if "stroke" in lengths:
        start, end = _chamber(frame, outlines, lengths)
        _dimension(
            ink, start, end, base + 13.0, base, f"stroke {trimmed(1000 * lengths['stroke'])}"
        )
    if "closed_length" in lengths:
        closed = lengths["closed_length"]
        if "pin_cap" in lengths and "pin_rod" in lengths:
            first, last = lengths["pin_cap"], lengths["pin_rod"]
        else:
            spare = (ends[1] - ends[0] - closed) / 2
            first, last = ends[0] + spare, ends[1] - spare
        words = "total length" if "second_rod" in lengths else "closed length"
        text = f"{words} {trimmed(1000 * closed)}"
        for x in (first, last):
            ink.line(
                (frame.x(x), frame.axis - 2.5),
                (frame.x(x), frame.axis + 2.5),
                pen=THIN,
                stroke=BLACK,
            )
        _dimension(ink, frame.x(first), frame.x(last), base + 19.5, frame.axis + 3.5, text)


def _dimension(ink: Ink, start: float, end: float, y: float, origin: float, text: str) -> None:
    """A horizontal dimension line with extension lines from `origin`, text above the line."""
    for x in (start, end):
        ink.line((x, origin + 0.8), (x, y + 1.5), pen=THIN)
    width = text_width(text, 7.0)
    if end - start >= width + 3.0:
        ink.line((start, y), (end, y), pen=THIN)
        ink.arrow((start, y), (end, y), length=min(2.0, (end - start) / 3))
        ink.arrow((end, y), (start, y), length=min(2.0, (end - start) / 3))
        ink.text((start + end) / 2, y - 1.7, text, size=7.0, anchor="center", halo=True)
        return
    right = end + 6.0 + width < ink.width
    ink.line((start - 5.0, y), (end + 5.0, y), pen=THIN)
    ink.arrow((start, y), (start - 9.0, y))
    ink.arrow((end, y), (end + 9.0, y))
    place = end + 6.0 if right else start - 6.0
    ink.text(place, y, text, size=7.0, anchor="left" if right else "right")


def scale_bar(ink: Ink, factor: float, y: float) -> None:
    """A ruler of a round length, to check the size of a print."""
    for millimetres in (5000, 2000, 1000, 500, 200, 100, 50, 20, 10, 5, 2, 1):
        if millimetres * factor / 1000 <= 50.0:
            break
    length = millimetres * factor / 1000
    for index in range(5):
        ink.box(
            index * length / 5,
            y - 0.7,
            length / 5,
            1.4,
            pen=THIN,
            fill=BLACK if index % 2 == 0 else "#ffffff",
        )
    ink.text(length + 1.5, y, f"{millimetres} mm", size=6.5)
