"""STEP (ISO 10303-214): turned parts as closed solids of planes, cylinders and cones.

The half-section of a body is followed anticlockwise. Each of its edges sweeps a face, and each of
its corners a circle. The circle separates two faces, which use it in opposite directions. Faces
around the axis are closed by a seam.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from math import atan2, cos, hypot, pi, sin
from typing import TypeAlias

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError
from ..evaluation.result import Evaluation, Outline

Point: TypeAlias = tuple[float, float]
Profile: TypeAlias = tuple[Point, ...]
"""Corners (axial position, radius) in mm, anticlockwise, without collinear points."""
_Edge: TypeAlias = tuple[Point, Point]
_DIGITS = 9
"""Number of decimals of a length in mm, in files: the last is a thousandth of a nanometre."""
_NAMES = {
    "caps": ("cap, cap end", "cap, rod end"),
    "glands": ("head, cap end", "head, rod end"),
    "rod.fitting": ("rod.fitting, piston end", "rod.fitting, rod end"),
}
"""For parts that consist of two bodies, the names of these bodies, starting at the cap end. All
other bodies have the name of their part."""
_RINGS = tuple(
    f"{place} {ring}"
    for place in ("piston", "rod", "second rod")
    for ring in ("seal", "secondary seal", "guide", "wiper")
)
EYES = ("cap eye", "rod eye")
BEARINGS, BOSSES = "eye bearings", "port bosses"
NOT_TURNED = ("oil", *_RINGS, *EYES, BEARINGS, "ports", "components")
"""Parts of the section that are not exported, because the model does not define their shape."""


@dataclass(frozen=True, slots=True)
class SolidBody:
    """A body of revolution about the x axis; lengths in mm.

    `profile` is the half-section, with x = 0 at the body's first end; `places` are the positions of
    that origin in the assembly, one per copy of the body. `axes` are the directions of the body's x
    axis there; empty if all are along x.
    """

    name: str
    part: str
    material: str
    profile: Profile
    places: tuple[tuple[float, float, float], ...]
    axes: tuple[tuple[float, float, float], ...] = ()


def title(part: str) -> str:
    """Name, for exported files, of the part that an outline shows.

    It is the part's PATH in the design, or else a plain name.

    >>> title("layup[1]"), title("glands"), title("rod.layup[0]")
    ('barrel.layup[1]', 'head', 'rod.layup[0]')
    """
    paths = {"glands": "head", "second rod": "second_rod"}
    return f"barrel.{part}" if part.startswith("layup") else paths.get(part, part)


def millimetres(polygon: Iterable[Point]) -> Profile:
    """Convert the corners of an outline from m to mm."""
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
    """Reorder a polygon anticlockwise from its lowest corner; drop collinear corners."""
    corners = [a for a, b in edges(profile) if a != b]
    triples = [(corners[k - 1], b, corners[(k + 1) % len(corners)]) for k, b in enumerate(corners)]
    turns = [b for a, b, c in triples if _turn(a, b, c) != 0]
    if area(turns) < 0:
        turns.reverse()
    first = turns.index(min(turns)) if turns else 0
    return tuple(turns[first:] + turns[:first])


def _between(point: Point, edge: _Edge) -> bool:
    """Whether a point lies inside an axis-parallel edge."""
    (x1, r1), (x2, r2) = edge
    if x1 == x2 == point[0]:
        return min(r1, r2) < point[1] < max(r1, r2)
    if r1 == r2 == point[1]:
        return min(x1, x2) < point[0] < max(x1, x2)
    return False


def _pieces(edge: _Edge, corners: Iterable[Point]) -> Iterator[_Edge]:
    """Split an edge at corners that lie on it."""
    on = sorted({p for p in corners if _between(p, edge)}, reverse=edge[0] > edge[1])
    yield from pairwise((edge[0], *on, edge[1]))


def _joined(profile: Profile, other: Profile) -> Profile | None:
    """Merge two polygons that touch along one run of edges; None if along none or several."""
    corners = (*profile, *other)
    pieces = [
        piece for edge in (*edges(profile), *edges(other)) for piece in _pieces(edge, corners)
    ]
    left = [(a, b) for a, b in pieces if (b, a) not in pieces]
    after = dict(left)
    if len(left) == len(pieces) or len(after) != len(left):
        return None
    loop = [left[0][0]]
    while (point := after[loop[-1]]) != loop[0]:
        loop.append(point)
    return tidy(loop) if len(loop) == len(left) else None


def joined(polygons: Iterable[Profile]) -> list[Profile]:
    """Merge polygons along shared edges; return them in axial order.

    >>> plate = ((0.0, 0.0), (2.0, 0.0), (2.0, 5.0), (0.0, 5.0))
    >>> skirt = ((2.0, 4.0), (6.0, 4.0), (6.0, 5.0), (2.0, 5.0))
    >>> joined([plate, skirt])
    [((0.0, 0.0), (2.0, 0.0), (2.0, 4.0), (6.0, 4.0), (6.0, 5.0), (0.0, 5.0))]
    """
    loops: list[Profile] = []
    for polygon in polygons:
        loop = tidy(polygon)
        while True:
            pair = next(((other, w) for other in loops if (w := _joined(other, loop))), None)
            if pair is None:
                break
            loops.remove(pair[0])
            loop = pair[1]
        loops.append(loop)
    return sorted(loops)


def _crosses(first: _Edge, second: _Edge) -> bool:
    """Whether two edges that are not neighbours intersect."""
    (a, b), (c, d) = first, second
    sides = _turn(a, b, c) * _turn(a, b, d), _turn(c, d, a) * _turn(c, d, b)
    apart = any(
        max(a[k], b[k]) < min(c[k], d[k]) or max(c[k], d[k]) < min(a[k], b[k]) for k in (0, 1)
    )
    return not apart and max(sides) <= 0


def bounds_solid(profile: Profile) -> bool:
    """Whether a polygon bounds a solid of revolution: nonzero area, no crossing.

    It may touch the axis along one edge. If it touched it at a point, the solid would be pinched
    there; if along two edges, it would enclose a void.
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
    remedy = (
        "enlarge the part until grooves and walls fit: see the geometry_... metrics of `evaluate`"
    )
    return InputError(
        Diagnostic(
            f"{part}: the outline of its section crosses itself, or a wall has no thickness", remedy
        )
    )


def _bars(outline: Outline) -> SolidBody:
    """The round bars of an outline: one body, placed several times, evenly spaced around the axis.

    The first bar is in the section plane.
    """
    profile = tidy(millimetres(outline.polygons[0]))
    places, radii = zip(*profile, strict=True)
    first, last, ring = min(places), max(places), (min(radii) + max(radii)) / 2
    above = [(x - first, r - ring) for x, r in profile if r > ring]
    turns = [2 * pi * k / outline.bars for k in range(outline.bars)]
    return SolidBody(
        name=outline.part.removesuffix("s"),
        part=outline.part,
        material=outline.material,
        profile=((0.0, 0.0), (last - first, 0.0), *above),
        places=tuple((first, ring * cos(turn), ring * sin(turn)) for turn in turns),
    )


def _pins(outline: Outline) -> Iterator[SolidBody]:
    """The radial bars of an outline: for each row, one body, placed evenly around the axis."""
    for index, polygon in enumerate(outline.polygons, 1):
        profile = tidy(millimetres(polygon))
        (first, low), (last, high) = profile[0], max(profile)
        turns = [2 * pi * k / outline.bars for k in range(outline.bars)]
        axes = tuple((0.0, cos(turn), sin(turn)) for turn in turns)
        length, radius = high - low, (last - first) / 2
        yield SolidBody(
            name=f"{outline.part.removesuffix('s')}, row {index}",
            part=outline.part,
            material=outline.material,
            profile=((0.0, 0.0), (length, 0.0), (length, radius), (0.0, radius)),
            places=tuple(((first + last) / 2, low * y, low * z) for _, y, z in axes),
            axes=axes,
        )


def _bosses(outline: Outline) -> Iterator[SolidBody]:
    """The bosses of the ports, each drawn as two pieces beside its hole."""
    pieces = [tidy(millimetres(polygon)) for polygon in outline.polygons]
    for index, (first, second) in enumerate(zip(pieces[::2], pieces[1::2], strict=True), 1):
        (left, base), (inner, top) = first[0], max(first)
        radius = (max(second)[0] - left) / 2
        hole, height = radius - (inner - left), top - base
        yield SolidBody(
            name=f"port boss {index}",
            part=outline.part,
            material=outline.material,
            profile=((0.0, hole), (height, hole), (height, radius), (0.0, radius)),
            places=((left + radius, base, 0.0),),
            axes=((0.0, 1.0, 0.0),),
        )


def _bodies(outline: Outline) -> Iterator[SolidBody]:
    part = outline.part
    label = title(part)
    loops = joined(millimetres(polygon) for polygon in outline.polygons)
    names = _NAMES.get(part, (label,)) if len(loops) > 1 else (label,)
    for index, loop in enumerate(loops):
        if not bounds_solid(loop):
            raise _fault(label)
        name = names[index] if len(names) == len(loops) else f"{label} {index + 1}"
        start = loop[0][0]
        profile = tuple((round(x - start, _DIGITS), r) for x, r in loop)
        yield SolidBody(name, part, outline.material, profile, ((start, 0.0, 0.0),))


def bodies(evaluation: Evaluation) -> list[SolidBody]:
    """All turned parts of an evaluated design; oil, seals in grooves and eyes are omitted.

    Raises
    ------
    InputError : if the section of a part crosses itself
    """
    solid_bodies: list[SolidBody] = []
    for outline in evaluation.outlines:
        if outline.part in NOT_TURNED:
            continue
        if outline.part == BOSSES:
            solid_bodies += _bosses(outline)
        elif outline.radial:
            solid_bodies += _pins(outline)
        elif outline.bars:
            solid_bodies.append(_bars(outline))
        else:
            solid_bodies += _bodies(outline)
    return solid_bodies


SCHEMA = "AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }"

_UNCERTAINTY = 1e-6
"""Distance (mm) below which two points count as one; the file states it."""


def text(words: str) -> str:
    r"""A string as ISO 10303-21 writes it: quotes doubled, non-ASCII characters as codes.

    >>> print(text("5' \u00f6"))
    '5'' \X2\00F6\X0\'
    """
    parts = []
    for letter in words:
        code = ord(letter)
        if letter in "'\\":
            parts.append(2 * letter)
        elif 32 <= code < 127:
            parts.append(letter)
        elif code < 0x10000:
            parts.append(f"\\X2\\{code:04X}\\X0\\")
        else:
            parts.append(f"\\X4\\{code:08X}\\X0\\")
    return f"'{''.join(parts)}'"


def real(value: float) -> str:
    """A real number as ISO 10303-21 writes it, always with a decimal point.

    >>> real(12.0), real(0.1), real(1e-06), real(-0.0)
    ('12.', '0.1', '1.E-06', '0.')
    """
    mantissa, exponent, power = f"{value + 0.0:.15G}".partition("E")
    return f"{mantissa if '.' in mantissa else mantissa + '.'}{exponent}{power}"


class Records:
    """The numbered records of a file."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self._known: dict[str, str] = {}

    def add(self, record: str) -> str:
        """Add a record; return its number, by which others refer to it."""
        number = f"#{len(self.lines) + 1}"
        self.lines.append(f"{number}={record};")
        return number

    def shared(self, record: str) -> str:
        """Add a record unless an equal record exists; return its number."""
        if record not in self._known:
            self._known[record] = self.add(record)
        return self._known[record]

    def point(self, x: float, y: float, z: float = 0.0) -> str:
        """Add a Cartesian point."""
        return self.shared(f"CARTESIAN_POINT('',({real(x)},{real(y)},{real(z)}))")

    def direction(self, x: float, y: float, z: float = 0.0) -> str:
        """Add a unit vector."""
        return self.shared(f"DIRECTION('',({real(x)},{real(y)},{real(z)}))")

    def frame(self, origin: str, along: float = 1.0) -> str:
        """Add a coordinate system with its main axis along +x or -x; angles are measured from y."""
        axis, zero = self.direction(along, 0.0), self.direction(0.0, 1.0)
        return self.shared(f"AXIS2_PLACEMENT_3D('',{origin},{axis},{zero})")

    def place(
        self,
        at: tuple[float, float, float],
        along: tuple[float, float, float] = (1.0, 0.0, 0.0),
    ) -> str:
        """Add a coordinate system that is shifted, and rotated only for a radial body.

        All CAD programs read a coordinate system that is not rotated in the same way. `along` is
        the direction of its x axis: that of the assembly, or a radial one.
        """
        axis, zero = self.direction(*_across(along)), self.direction(*along)
        return self.shared(f"AXIS2_PLACEMENT_3D('',{self.point(*at)},{axis},{zero})")


def _across(along: tuple[float, float, float]) -> tuple[float, float, float]:
    """Direction of the z axis of a coordinate system, from that of its x axis."""
    return (0.0, 0.0, 1.0) if along[0] else (1.0, 0.0, 0.0)


def listed(numbers: Iterable[str]) -> str:
    """Text of a list of references."""
    return f"({','.join(numbers)})"


class _Skin:
    """The faces of one body."""

    def __init__(self, records: Records, profile: Profile) -> None:
        self.records = records
        self.corners = {corner: self._vertex(corner) for corner in profile}
        self.circles = {corner: self._circle(corner) for corner in profile if corner[1] > 0}

    def _vertex(self, corner: Point) -> str:
        return self.records.add(f"VERTEX_POINT('',{self.records.point(*corner)})")

    def _circle(self, corner: Point) -> str:
        r, (x, radius) = self.records, corner
        curve = r.add(f"CIRCLE('',{r.frame(r.point(x, 0.0))},{real(radius)})")
        vertex = self.corners[corner]
        return r.add(f"EDGE_CURVE('',{vertex},{vertex},{curve},.T.)")

    def _seam(self, start: Point, end: Point) -> str:
        r = self.records
        dx, dr = end[0] - start[0], end[1] - start[1]
        size = hypot(dx, dr)
        vector = r.add(f"VECTOR('',{r.direction(dx / size, dr / size)},1.)")
        curve = r.add(f"LINE('',{r.point(*start)},{vector})")
        return r.add(f"EDGE_CURVE('',{self.corners[start]},{self.corners[end]},{curve},.T.)")

    def _loop(self, edges: Sequence[tuple[str, bool]]) -> str:
        r = self.records
        sides = [r.add(f"ORIENTED_EDGE('',*,*,{edge},.{'FT'[sense]}.)") for edge, sense in edges]
        return r.add(f"EDGE_LOOP('',{listed(sides)})")

    def face(self, start: Point, end: Point) -> str:
        """Add the face that an edge of the section sweeps; material lies left of the edge."""
        r = self.records
        rims = [(self.circles[c], c is end, c[1]) for c in (start, end) if c in self.circles]
        if start[0] == end[0]:  # the larger rim is the face's outer boundary
            rims.sort(key=lambda rim: -rim[2])
            kinds = ("FACE_OUTER_BOUND", "FACE_BOUND")
            bounds = [
                r.add(f"{kind}('',{self._loop([(circle, sense)])},.T.)")
                for kind, (circle, sense, _) in zip(kinds, rims, strict=False)
            ]
            outwards = 1.0 if end[1] > start[1] else -1.0
            surface = r.add(f"PLANE('',{r.frame(r.point(start[0], 0.0), outwards)})")
            return r.add(f"ADVANCED_FACE('',{listed(bounds)},{surface},.T.)")
        seam = self._seam(start, end)
        loop: list[tuple[str, bool]] = []
        for forward in (True, False):
            loop.append((seam, forward))
            loop += [(circle, sense) for circle, sense, _ in rims if sense is forward]
        bound = r.add(f"FACE_OUTER_BOUND('',{self._loop(loop)},.T.)")
        same = "T" if end[0] < start[0] else "F"
        return r.add(f"ADVANCED_FACE('',({bound}),{self._round(start, end)},.{same}.)")

    def _round(self, start: Point, end: Point) -> str:
        """Add the cylinder or cone that an edge sweeps; a cone's axis points to its wide end."""
        r = self.records
        (x, radius), (far, wide) = sorted((start, end), key=lambda corner: corner[1])
        if radius == wide:
            return r.add(f"CYLINDRICAL_SURFACE('',{r.frame(r.point(x, 0.0))},{real(radius)})")
        frame = r.frame(r.point(x, 0.0), 1.0 if far > x else -1.0)
        slope = atan2(wide - radius, abs(far - x))
        return r.add(f"CONICAL_SURFACE('',{frame},{real(radius)},{real(slope)})")


def solid(records: Records, name: str, profile: Profile) -> str:
    """Add a body of revolution about x."""
    skin = _Skin(records, profile)
    faces = [skin.face(a, b) for a, b in edges(profile) if a[1] > 0 or b[1] > 0]
    shell = records.add(f"CLOSED_SHELL('',{listed(faces)})")
    return records.add(f"MANIFOLD_SOLID_BREP({text(name)},{shell})")


class _Product:
    """A part or the assembly: its definition and its shape."""

    def __init__(self, records: Records, name: str, about: str, contexts: _Contexts) -> None:
        r = records
        self.name = name
        own = r.add(f"PRODUCT({text(name)},{text(name)},{text(about)},({contexts.product}))")
        r.add(f"PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,({own}))")
        formation = r.add(f"PRODUCT_DEFINITION_FORMATION('','',{own})")
        self.definition = r.add(
            f"PRODUCT_DEFINITION('design','',{formation},{contexts.definition})"
        )
        self._shape = r.add(f"PRODUCT_DEFINITION_SHAPE('','',{self.definition})")
        self._records, self._space = r, contexts.space
        self.representation = ""

    def shaped(self, kind: str, items: Iterable[str]) -> None:
        """Assign a shape to the part."""
        r = self._records
        record = f"{kind}({text(self.name)},{listed(items)},{self._space})"
        self.representation = r.add(record)
        r.add(f"SHAPE_DEFINITION_REPRESENTATION({self._shape},{self.representation})")


class _Contexts:
    """Contexts of the file: application, disciplines and units (mm, rad, sr)."""

    def __init__(self, records: Records) -> None:
        r = records
        application = r.add(
            "APPLICATION_CONTEXT('core data for automotive mechanical design processes')"
        )
        r.add(
            "APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,"
            f"{application})"
        )
        self.product = r.add(f"PRODUCT_CONTEXT('',{application},'mechanical')")
        self.definition = r.add(
            f"PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')"
        )
        length = r.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))")
        angle = r.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
        solid_angle = r.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
        close = r.add(
            f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({real(_UNCERTAINTY)}),{length},"
            "'distance_accuracy_value','points closer than this are one')"
        )
        self.space = r.add(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(3)"
            f"GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({close}))"
            f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid_angle}))"
            "REPRESENTATION_CONTEXT('','3D'))"
        )


def _placed(
    records: Records, whole: _Product, part: _Product, name: str, home: str, place: str
) -> None:
    """Add a part to the assembly, so that its coordinate system `home` comes to lie at `place`."""
    r = records
    use = r.add(
        f"NEXT_ASSEMBLY_USAGE_OCCURRENCE({text(name)},{text(name)},'',"
        f"{whole.definition},{part.definition},$)"
    )
    usage = r.add(f"PRODUCT_DEFINITION_SHAPE('','',{use})")
    move = r.add(f"ITEM_DEFINED_TRANSFORMATION('','',{home},{place})")
    relation = r.add(
        f"(REPRESENTATION_RELATIONSHIP('','',{part.representation},{whole.representation})"
        f"REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION({move})"
        "SHAPE_REPRESENTATION_RELATIONSHIP())"
    )
    r.add(f"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION({relation},{usage})")


def step(bodies: Sequence[SolidBody], *, name: str, program: str, date: str | None = None) -> str:
    """Write an assembly as the text of a STEP file.

    Parameters
    ----------
    bodies : parts of the assembly
    name : name of the assembly
    program : name of the writing program
    date : ISO date, or None

    Returns
    -------
    text of the file, ASCII
    """
    r = Records()
    contexts = _Contexts(r)
    whole = _Product(r, name, "turned parts, retracted", contexts)
    home = r.place((0.0, 0.0, 0.0))
    parts = [_Product(r, body.name, body.material, contexts) for body in bodies]
    for body, part in zip(bodies, parts, strict=True):
        part.shaped("ADVANCED_BREP_SHAPE_REPRESENTATION", (home, solid(r, body.name, body.profile)))
    ahead = (1.0, 0.0, 0.0)
    places = [
        [r.place(place, along) for place, along in zip(body.places, axes, strict=True)]
        for body in bodies
        for axes in [body.axes or (ahead,) * len(body.places)]
    ]
    frames = dict.fromkeys([home, *(frame for frames in places for frame in frames)])
    whole.shaped("SHAPE_REPRESENTATION", frames)
    for body, part, frames_of in zip(bodies, parts, places, strict=True):
        for index, place in enumerate(frames_of):
            label = f"{body.name} {index + 1}" if len(frames_of) > 1 else body.name
            _placed(r, whole, part, label, home, place)
    stamp = "" if date is None else f"{date}T00:00:00"
    return "\n".join(
        (
            "ISO-10303-21;",
            "HEADER;",
            f"FILE_DESCRIPTION(({text('turned parts, lengths in mm')}),'2;1');",
            f"FILE_NAME({text(name)},{text(stamp)},(''),(''),{text(program)},{text(program)},'');",
            f"FILE_SCHEMA(({text(SCHEMA)}));",
            "ENDSEC;",
            "DATA;",
            *r.lines,
            "ENDSEC;",
            "END-ISO-10303-21;",
            "",
        )
    )
