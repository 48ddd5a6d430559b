"""Ink: a vector canvas in millimetres of paper, y downwards from the top left corner.

Figures and drawings consist of two kinds of marks, paths and texts, which all renderers can draw.
Widths of texts are estimated from the advance widths of the report's typeface, so that labels can
be placed automatically and tested for overlaps.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any, Literal, TypeAlias, TypedDict, final

Point: TypeAlias = tuple[float, float]
Polygon: TypeAlias = Sequence[Point]
Anchor: TypeAlias = Literal["left", "center", "right"]


@final
class PathMark(TypedDict):
    """Polylines drawn with one pen: points, pen width and dash lengths (all in mm), and colours."""

    path: list[list[list[float]]]
    closed: bool
    pen: float
    dash: list[float]
    stroke: str | None
    fill: str | None


@final
class TextMark(TypedDict):
    """A line of text.

    `at` is the point (x, y) in mm, with y at half the height of the capital letters. The type size
    is in points, the angle in degrees, clockwise.
    """

    text: str
    at: list[float]
    size: float
    anchor: Anchor
    angle: float
    bold: bool
    color: str
    halo: bool


Mark: TypeAlias = PathMark | TextMark

POINT = 25.4 / 72
"""Millimetres per typographic point."""

BLACK, GREY, PALE, WHITE = "#16202a", "#5b6670", "#c9d0d6", "#ffffff"
BLUE, RED, OCHRE, GREEN = "#0b4f83", "#a8321a", "#9a6a12", "#00654a"

_NARROW = {
    ".": 0.318,
    ",": 0.318,
    " ": 0.318,
    "i": 0.278,
    "l": 0.278,
    "j": 0.278,
    "I": 0.295,
    ":": 0.337,
    "|": 0.337,
    "'": 0.275,
    "(": 0.39,
    ")": 0.39,
    "[": 0.39,
    "]": 0.39,
    "f": 0.352,
    "t": 0.392,
    "r": 0.411,
    "-": 0.361,
    "/": 0.337,
    "J": 0.295,
    "·": 0.318,
    "\N{NARROW NO-BREAK SPACE}": 0.2,
    "s": 0.521,
    "c": 0.55,
    "k": 0.579,
    "z": 0.525,
}
_WIDE = {
    "m": 0.974,
    "w": 0.818,
    "M": 0.863,
    "W": 0.989,
    "%": 0.95,
    "@": 1.0,
    "⌀": 0.838,
    "≥": 0.838,
    "≤": 0.838,
    "−": 0.838,
    "+": 0.838,
    "×": 0.838,
    "µ": 0.636,
    "→": 0.838,
}


class _Advances(dict[str, float]):
    """Advance widths (em) by letter; a letter that no table has is added at its first use."""

    def __missing__(self, letter: str) -> float:
        self[letter] = 0.70 if letter.isupper() else 0.636 if letter.isascii() else 0.9
        return self[letter]


_ADVANCES = _Advances(_WIDE | _NARROW)


def text_width(text: str, size: float, *, bold: bool = False) -> float:
    """Width (mm) of a text at a type size (pt), from advance widths of DejaVu Sans.

    >>> round(text_width("25 mm", 10.0), 1)
    12.5
    """
    width = 0.0
    for letter in text:
        width += _ADVANCES[letter]
    return width * size * POINT * (1.1 if bold else 1.0)


def spread(targets: Sequence[float], gaps: Sequence[float]) -> list[float]:
    """Positions as close as possible to ascending targets, but with minimum gaps between them.

    `gaps[i]` is the least distance between positions i and i+1. The pool-adjacent-violators
    algorithm minimises the sum of the squared distances from the targets.

    >>> spread([0.0, 0.0, 10.0], [2.0, 2.0])
    [-1.0, 1.0, 10.0]
    """
    offsets = [0.0]
    for gap in gaps[: max(len(targets) - 1, 0)]:
        offsets.append(offsets[-1] + gap)
    pools: list[list[float]] = []
    for value, offset in zip(targets, offsets, strict=False):
        pools.append([value - offset, 1.0])
        while len(pools) > 1 and pools[-2][0] > pools[-1][0]:
            mean, count = pools.pop()
            pools[-1][0] = (pools[-1][0] * pools[-1][1] + mean * count) / (pools[-1][1] + count)
            pools[-1][1] += count
    flat = [mean for mean, count in pools for _ in range(int(count))]
    return [value + offset for value, offset in zip(flat, offsets, strict=False)]


def spread_within(
    targets: Sequence[float], gaps: Sequence[float], lower: float, upper: float
) -> list[float]:
    """Like `spread`, but within [lower, upper]; gaps are reduced if they do not fit."""
    room = upper - lower
    total = sum(gaps[: max(len(targets) - 1, 0)])
    if total > room > 0:
        gaps = [gap * room / total for gap in gaps]
    places = spread([min(max(value, lower), upper) for value in targets], gaps)
    if not places:
        return places
    for index, value in enumerate(places):
        least = lower if index == 0 else places[index - 1] + gaps[index - 1]
        places[index] = max(value, least)
    for index in range(len(places) - 1, -1, -1):
        most = upper if index == len(places) - 1 else places[index + 1] - gaps[index]
        places[index] = min(places[index], most)
    return places


def hatch(
    polygons: Iterable[Polygon], *, angle: float, spacing: float
) -> list[tuple[Point, Point]]:
    """Parallel lines inside the polygons (even-odd rule), at `angle` degrees, `spacing` apart.

    The lines lie at fixed positions on the page, so that the hatching of separate polygons lines
    up.
    """
    cosine, sine = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    edges = []
    for polygon in polygons:
        turned = [(x * cosine + y * sine, y * cosine - x * sine) for x, y in polygon]
        edges += list(zip(turned, [*turned[1:], turned[0]], strict=True))
    if not edges:
        return []
    lowest = min(min(a[1], b[1]) for a, b in edges)
    highest = max(max(a[1], b[1]) for a, b in edges)
    crossings: dict[int, list[float]] = {}
    for (u1, v1), (u2, v2) in edges:
        if v1 == v2:
            continue
        low, high = (v1, v2) if v1 < v2 else (v2, v1)
        for row in range(math.ceil(low / spacing - 0.5), math.ceil(high / spacing - 0.5)):
            level = (row + 0.5) * spacing
            crossings.setdefault(row, []).append(u1 + (level - v1) * (u2 - u1) / (v2 - v1))
    lines = []
    for row in range(math.floor(lowest / spacing) - 1, math.ceil(highest / spacing) + 1):
        level = (row + 0.5) * spacing
        cuts = sorted(crossings.get(row, ()))
        for start, end in zip(cuts[::2], cuts[1::2], strict=False):
            if end - start > 0.02:
                lines.append(
                    tuple(
                        (u * cosine - level * sine, u * sine + level * cosine) for u in (start, end)
                    )
                )
    return [(a, b) for a, b in lines]


class Ink:
    """A drawing of given width and height (mm), to which marks are added in drawing order."""

    def __init__(self, width: float, height: float) -> None:
        self.width = width
        self.height = height
        self.marks: list[Mark] = []

    def path(
        self,
        lines: Iterable[Polygon],
        *,
        stroke: str | None = BLACK,
        pen: float = 0.18,
        fill: str | None = None,
        dash: Sequence[float] = (),
        closed: bool = False,
    ) -> None:
        """Add polylines as one mark; `pen` is the line width, lengths in mm."""
        rounded = [[[round(x, 3), round(y, 3)] for x, y in line] for line in lines]
        rounded = [line for line in rounded if len(line) > 1]
        if rounded:
            self.marks.append(
                PathMark(
                    path=rounded, closed=closed, pen=pen, dash=list(dash), stroke=stroke, fill=fill
                )
            )

    def line(self, *points: Point, **style: Any) -> None:
        """A single polyline."""
        self.path([points], **style)

    def box(self, x: float, y: float, width: float, height: float, **style: Any) -> None:
        """A rectangle, given its top left corner."""
        corners = ((x, y), (x + width, y), (x + width, y + height), (x, y + height))
        self.path([corners], closed=True, **style)

    def hatched(
        self, polygon: Polygon, *, fill: str, angle: float, spacing: float, stroke: str
    ) -> None:
        """A cut face: a filled polygon without outline, hatched at `angle` degrees."""
        self.path([polygon], stroke=None, fill=fill, closed=True)
        self.path(hatch([polygon], angle=angle, spacing=spacing), pen=0.08, stroke=stroke)

    def circle(self, x: float, y: float, radius: float, **style: Any) -> None:
        """A circle, as a polygon of 32 corners."""
        turns = [math.tau * k / 32 for k in range(32)]
        points = [(x + radius * math.cos(a), y + radius * math.sin(a)) for a in turns]
        self.path([points], closed=True, **style)

    def arrow(self, tip: Point, away: Point, *, length: float = 2.0, color: str = BLACK) -> None:
        """A filled arrowhead (15 degrees, ISO 129) at `tip`, pointing away from `away`."""
        dx, dy = tip[0] - away[0], tip[1] - away[1]
        size = math.sqrt(dx * dx + dy * dy) or 1.0
        dx, dy = dx / size * length, dy / size * length
        wing = math.tan(math.radians(9))
        back = (tip[0] - dx, tip[1] - dy)
        left = (back[0] - dy * wing, back[1] + dx * wing)
        right = (back[0] + dy * wing, back[1] - dx * wing)
        self.path([(tip, left, right)], stroke=None, fill=color, closed=True)

    def text(
        self,
        x: float,
        y: float,
        text: str,
        *,
        size: float = 6.5,
        anchor: Anchor = "left",
        angle: float = 0.0,
        bold: bool = False,
        color: str = BLACK,
        halo: bool = False,
    ) -> None:
        """A line of text; `y` is the middle of its capitals, `angle` clockwise in degrees."""
        self.marks.append(
            TextMark(
                text=text,
                at=[round(x, 3), round(y, 3)],
                size=size,
                anchor=anchor,
                angle=angle,
                bold=bold,
                color=color,
                halo=halo,
            )
        )

    def paste(self, other: Ink, x: float, y: float) -> None:
        """Copy another drawing, with its top left corner at (x, y)."""
        for mark in other.marks:
            if "text" in mark:
                at = [round(mark["at"][0] + x, 3), round(mark["at"][1] + y, 3)]
                self.marks.append(TextMark(**mark | {"at": at}))
            else:
                path = [[[round(a + x, 3), round(b + y, 3)] for a, b in line]
                        for line in mark["path"]]  # fmt: skip
                self.marks.append(PathMark(**mark | {"path": path}))

    def data(self) -> dict[str, object]:
        """The drawing as plain data for the Typst template."""
        return {"width": self.width, "height": self.height, "marks": self.marks}

    def text_boxes(self) -> list[tuple[str, float, float, float, float]]:
        """Estimated bounds (text, left, top, right, bottom) of all unrotated texts, for tests."""
        boxes = []
        for mark in self.marks:
            if "text" not in mark or mark["angle"]:
                continue
            x, y = mark["at"]
            width = text_width(mark["text"], mark["size"], bold=mark["bold"])
            left = x - {"left": 0.0, "center": width / 2, "right": width}[mark["anchor"]]
            half = 0.36 * mark["size"] * POINT
            boxes.append((mark["text"], left, y - half, left + width, y + half))
        return boxes
