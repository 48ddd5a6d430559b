"""Turned parts as bodies of revolution: half-sections of the drawing, merged and checked."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import cos, pi, sin
from typing import TypeAlias

from ..base.errors import Diagnostic, InputError
from ..evaluation.result import Evaluation, Outline

Point: TypeAlias = tuple[float, float]
Profile: TypeAlias = tuple[Point, ...]
"""Corners (axial position, radius) in mm, anticlockwise, without collinear points."""

_Edge: TypeAlias = tuple[Point, Point]

_DIGITS = 9
"""Decimals of a millimetre in files: a thousandth of a nanometre."""

_NAMES = {
    "caps": ("cap, cap end", "cap, rod end"),
    "rod.fitting": ("rod.fitting, piston end", "rod.fitting, rod end"),
}
"""Names of a part's bodies, from the cap end on; others have the name of the part."""

_RINGS = tuple(
    f"{place} {ring}"
    for place in ("piston", "rod")
    for ring in ("seal", "secondary seal", "guide", "wiper")
)
EYES = ("cap eye", "rod eye")
NOT_TURNED = ("oil", *_RINGS, *EYES)
"""Parts of the section that are not exported: the model does not define their shape."""


@dataclass(frozen=True, slots=True)
class Body:
    """A body of revolution about the x axis; lengths in mm.

    `profile` starts at the first face of the body; `places` are the positions of its origin in the
    assembly, one per copy.
    """

    name: str
    part: str
    material: str
    profile: Profile
    places: tuple[tuple[float, float, float], ...]


def title(part: str) -> str:
    """Name of an outline's part in files: its PATH if it has one.

    >>> title("layup[1]"), title("glands"), title("rod.layup[0]")
    ('barrel.layup[1]', 'head', 'rod.layup[0]')
    """
    return f"barrel.{part}" if part.startswith("layup") else {"glands": "head"}.get(part, part)


def millimetres(polygon: Iterable[Point]) -> Profile:
    """Corners of an outline (m) in mm."""
    return tuple((round(1000 * x, _DIGITS), round(1000 * r, _DIGITS)) for x, r in polygon)


def area(profile: Sequence[Point]) -> float:
    """Signed area of a polygon, positive anticlockwise.

    >>> area([(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)])
    2.0
    """
    return 0.5 * sum(x1 * r2 - x2 * r1 for (x1, r1), (x2, r2) in edges(profile))


def edges(profile: Sequence[Point]) -> list[_Edge]:
    """Edges of a polygon, including the closing edge."""
    return list(pairwise((*profile, *profile[:1])))


def _turn(a: Point, b: Point, c: Point) -> float:
    return (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])


def tidy(profile: Sequence[Point]) -> Profile:
    """The same polygon anticlockwise from its lowest corner, without collinear corners."""
    corners = [a for a, b in edges(profile) if a != b]
    around = [(corners[k - 1], b, corners[(k + 1) % len(corners)]) for k, b in enumerate(corners)]
    kept = [b for a, b, c in around if _turn(a, b, c) != 0]
    if area(kept) < 0:
        kept.reverse()
    first = kept.index(min(kept)) if kept else 0
    return tuple(kept[first:] + kept[:first])


def _between(point: Point, edge: _Edge) -> bool:
    """Whether a point lies inside an axis-parallel edge."""
    (x1, r1), (x2, r2) = edge
    if x1 == x2 == point[0]:
        return min(r1, r2) < point[1] < max(r1, r2)
    if r1 == r2 == point[1]:
        return min(x1, x2) < point[0] < max(x1, x2)
    return False


def _pieces(edge: _Edge, corners: Iterable[Point]) -> Iterator[_Edge]:
    """An edge, split at corners that lie on it."""
    on = sorted({p for p in corners if _between(p, edge)}, reverse=edge[0] > edge[1])
    yield from pairwise((edge[0], *on, edge[1]))


def _joined(one: Profile, other: Profile) -> Profile | None:
    """Two polygons with a common run of edges, merged; None if they share no run or several."""
    corners = (*one, *other)
    pieces = [piece for edge in (*edges(one), *edges(other)) for piece in _pieces(edge, corners)]
    left = [(a, b) for a, b in pieces if (b, a) not in pieces]
    after = dict(left)
    if len(left) == len(pieces) or len(after) != len(left):
        return None
    loop = [left[0][0]]
    while (point := after[loop[-1]]) != loop[0]:
        loop.append(point)
    return tidy(loop) if len(loop) == len(left) else None


def joined(polygons: Iterable[Profile]) -> list[Profile]:
    """Polygons merged along shared edges, in axial order.

    >>> plate = ((0.0, 0.0), (2.0, 0.0), (2.0, 5.0), (0.0, 5.0))
    >>> skirt = ((2.0, 4.0), (6.0, 4.0), (6.0, 5.0), (2.0, 5.0))
    >>> joined([plate, skirt])
    [((0.0, 0.0), (2.0, 0.0), (2.0, 4.0), (6.0, 4.0), (6.0, 5.0), (0.0, 5.0))]
    """
    loops: list[Profile] = []
    for polygon in polygons:
        loop = tidy(polygon)
        while True:
            found = next(((one, w) for one in loops if (w := _joined(one, loop))), None)
            if found is None:
                break
            loops.remove(found[0])
            loop = found[1]
        loops.append(loop)
    return sorted(loops)


def _crosses(one: _Edge, other: _Edge) -> bool:
    """Whether two edges that are not neighbours intersect."""
    (a, b), (c, d) = one, other
    sides = _turn(a, b, c) * _turn(a, b, d), _turn(c, d, a) * _turn(c, d, b)
    apart = any(
        max(a[k], b[k]) < min(c[k], d[k]) or max(c[k], d[k]) < min(a[k], b[k]) for k in (0, 1)
    )
    return not apart and max(sides) <= 0


def sound(profile: Profile) -> bool:
    """Whether a polygon bounds a solid of revolution: nonzero area, no crossing.

    It may touch the axis along one edge only: a point would pinch it, two edges would make a void.
    """
    sides = edges(profile)
    if len(sides) < 3 or area(profile) <= 0 or min(r for _, r in profile) < 0:
        return False
    on_axis = sum(r == 0 for _, r in profile)
    if on_axis and (on_axis != 2 or not any(a[1] == b[1] == 0 for a, b in sides)):
        return False
    last = len(sides) - 1
    pairs = [(i, j) for i in range(last) for j in range(i + 2, last + 1) if (i, j) != (0, last)]
    return not any(_crosses(sides[i], sides[j]) for i, j in pairs)


def _fault(part: str) -> InputError:
    remedy = "make room for its grooves and walls: see the geometry_... metrics of evaluate"
    return InputError(Diagnostic(f"{part}: its section crosses itself or has no wall", remedy))


def _bars(outline: Outline) -> Body:
    """Round bars evenly spaced about the axis, the first in the plane of the section."""
    profile = tidy(millimetres(outline.polygons[0]))
    first, low = profile[0]
    last, high = max(profile)
    radius, ring = (high - low) / 2, (low + high) / 2
    turns = [2 * pi * k / outline.bars for k in range(outline.bars)]
    return Body(
        name=outline.part.removesuffix("s"),
        part=outline.part,
        material=outline.material,
        profile=((0.0, 0.0), (last - first, 0.0), (last - first, radius), (0.0, radius)),
        places=tuple((first, ring * cos(turn), ring * sin(turn)) for turn in turns),
    )


def _bodies(outline: Outline) -> Iterator[Body]:
    part = outline.part
    own = title(part)
    loops = joined(millimetres(polygon) for polygon in outline.polygons)
    names = _NAMES.get(part, (own,))
    for index, loop in enumerate(loops):
        if not sound(loop):
            raise _fault(own)
        name = names[index] if len(names) == len(loops) else f"{own} {index + 1}"
        start = loop[0][0]
        moved = tuple((round(x - start, _DIGITS), r) for x, r in loop)
        yield Body(name, part, outline.material, moved, ((start, 0.0, 0.0),))


def bodies(evaluation: Evaluation) -> list[Body]:
    """All turned parts of an evaluation, without oil, seals in grooves and eyes.

    Raises
    ------
    InputError : a part's section crosses itself
    """
    found: list[Body] = []
    for outline in evaluation.outlines:
        if outline.bars:
            found.append(_bars(outline))
        elif outline.part not in NOT_TURNED:
            found += _bodies(outline)
    return found
