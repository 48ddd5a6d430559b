"""Layout of the section's dimensions without overlaps, independent of the file format.

All lengths are in mm of the drawing; `Paper` gives the size of letters and gaps.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

LETTER = 0.95
"""Upper estimate of character width over height, as fonts differ between programs."""


@dataclass(frozen=True, slots=True)
class Paper:
    """Sizes of drawing elements at the intended print scale."""

    scale: float
    """mm of the drawing per mm of paper."""

    @property
    def letter(self) -> float:
        """Height of letters."""
        return 2.5 * self.scale

    @property
    def arrow(self) -> float:
        """Length of an arrowhead."""
        return 2.5 * self.scale

    @property
    def row(self) -> float:
        """Distance between rows of dimensions."""
        return 8.0 * self.scale

    def width(self, text: str) -> float:
        """Width of a text."""
        return LETTER * self.letter * len(text)


@dataclass(frozen=True, slots=True)
class Length:
    """An axial length with its dimension text."""

    start: float
    end: float
    text: str


@dataclass(frozen=True, slots=True)
class Placed:
    """A length with its row, counted outwards, and the centre of its text."""

    length: Length
    row: int
    middle: float
    outside: bool


def _clear(middle: float, half: float, lines: Sequence[float]) -> bool:
    return all(abs(middle - x) > half for x in lines)


def _middle(length: Length, paper: Paper, lines: Sequence[float]) -> tuple[float, bool]:
    """Centre of a text over its own dimension line, else beside it, clear of all lines."""
    half, pad = paper.width(length.text) / 2, 0.5 * paper.letter
    centre = (length.start + length.end) / 2
    inner = [x for x in lines if length.start < x < length.end]
    room = length.end - length.start - 2 * (half + paper.arrow)
    if room > 0:
        reach = [0.0] + [sign * k * paper.letter / 2 for k in range(1, 200) for sign in (1, -1)]
        for shift in reach:
            if abs(shift) <= room / 2 and _clear(centre + shift, half + pad, inner):
                return centre + shift, False
    beside = half + 2 * paper.arrow + pad
    for k in range(2000):
        for edge, sign in ((length.end, 1), (length.start, -1)):
            middle = edge + sign * (beside + k * paper.letter / 2)
            if _clear(middle, half + pad, lines):
                return middle, True
    return length.end + beside, True


def rows(lengths: Sequence[Length], paper: Paper) -> list[Placed]:
    """Assign every length to a row: short lengths next to the parts, long lengths outside.

    Extension lines of a length cross all rows nearer to the parts, so a text must not overlap the
    ends of lengths in its own row or further out.
    """
    ordered = sorted(set(lengths), key=lambda one: (round(one.end - one.start, 6), one.start))
    ends = sorted({x for one in ordered for x in (one.start, one.end)})
    taken: list[list[tuple[float, float]]] = []
    placed = []
    for one in ordered:
        middle, outside = _middle(one, paper, [x for x in ends if x not in (one.start, one.end)])
        half = paper.width(one.text) / 2 + paper.letter / 2
        arrows = 2 * paper.arrow if outside else 0.0
        low = min(one.start - arrows, middle - half)
        high = max(one.end + arrows, middle + half)
        free = (
            row for row, spans in enumerate(taken) if all(high <= a or low >= b for a, b in spans)
        )
        row = next(free, len(taken))
        if row == len(taken):
            taken.append([])
        taken[row].append((low, high))
        placed.append(Placed(one, row, middle, outside))
    return placed
