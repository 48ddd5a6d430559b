"""STEP (ISO 10303-214): turned parts as closed solids of planes, cylinders and cones.

The half-section of a body, traversed anticlockwise, gives one face per edge and one circle per
corner. A circle separates two faces, so each edge is used twice, once in each direction. Faces
around the axis are closed by a seam.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import atan2, hypot

from .solids import Body, Point, Profile, edges

SCHEMA = "AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }"

_UNCERTAINTY = 1e-6
"""Distance below which points coincide (mm), as stated in the file."""


def text(words: str) -> str:
    r"""A string of ISO 10303-21: quotes doubled, non-ASCII characters as codes.

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
    """A real number of ISO 10303-21, always with a decimal point.

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
        """Add a record; returns its number for references."""
        number = f"#{len(self.lines) + 1}"
        self.lines.append(f"{number}={record};")
        return number

    def shared(self, record: str) -> str:
        """Add a record once; equal records are shared."""
        if record not in self._known:
            self._known[record] = self.add(record)
        return self._known[record]

    def point(self, x: float, y: float, z: float = 0.0) -> str:
        """A Cartesian point."""
        return self.shared(f"CARTESIAN_POINT('',({real(x)},{real(y)},{real(z)}))")

    def direction(self, x: float, y: float, z: float = 0.0) -> str:
        """A unit vector."""
        return self.shared(f"DIRECTION('',({real(x)},{real(y)},{real(z)}))")

    def frame(self, origin: str, along: float = 1.0) -> str:
        """A frame with its main axis along x (or opposite), angles counted from y."""
        axis, zero = self.direction(along, 0.0), self.direction(0.0, 1.0)
        return self.shared(f"AXIS2_PLACEMENT_3D('',{origin},{axis},{zero})")

    def place(self, at: tuple[float, float, float]) -> str:
        """A frame moved but not rotated, which all CAD readers interpret alike."""
        axis, zero = self.direction(0.0, 0.0, 1.0), self.direction(1.0, 0.0)
        return self.shared(f"AXIS2_PLACEMENT_3D('',{self.point(*at)},{axis},{zero})")


def listed(numbers: Iterable[str]) -> str:
    """References as a list."""
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

    def _loop(self, used: Sequence[tuple[str, bool]]) -> str:
        r = self.records
        sides = [r.add(f"ORIENTED_EDGE('',*,*,{one},.{'FT'[way]}.)") for one, way in used]
        return r.add(f"EDGE_LOOP('',{listed(sides)})")

    def face(self, start: Point, end: Point) -> str:
        """The face that an edge of the section sweeps; the material is left of the edge."""
        r = self.records
        rims = [(self.circles[c], c is end, c[1]) for c in (start, end) if c in self.circles]
        if start[0] == end[0]:  # the larger rim is the outer bound
            rims.sort(key=lambda rim: -rim[2])
            kinds = ("FACE_OUTER_BOUND", "FACE_BOUND")
            bounds = [
                r.add(f"{kind}('',{self._loop([(one, way)])},.T.)")
                for kind, (one, way, _) in zip(kinds, rims, strict=False)
            ]
            outwards = 1.0 if end[1] > start[1] else -1.0
            surface = r.add(f"PLANE('',{r.frame(r.point(start[0], 0.0), outwards)})")
            return r.add(f"ADVANCED_FACE('',{listed(bounds)},{surface},.T.)")
        seam = self._seam(start, end)
        used: list[tuple[str, bool]] = []
        for forth in (True, False):
            used += [(seam, forth), *((one, way) for one, way, _ in rims if way is forth)]
        bound = r.add(f"FACE_OUTER_BOUND('',{self._loop(used)},.T.)")
        same = "T" if end[0] < start[0] else "F"
        return r.add(f"ADVANCED_FACE('',({bound}),{self._round(start, end)},.{same}.)")

    def _round(self, start: Point, end: Point) -> str:
        """The cylinder or cone of an edge; the axis of a cone points to its wide end."""
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
        """Assign the shape."""
        r = self._records
        made = f"{kind}({text(self.name)},{listed(items)},{self._space})"
        self.representation = r.add(made)
        r.add(f"SHAPE_DEFINITION_REPRESENTATION({self._shape},{self.representation})")


class _Contexts:
    """Application, disciplines and units; mm, rad, sr."""

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
    """Add a part to the assembly: its own frame `home` is mapped to `place`."""
    r = records
    use = r.add(
        f"NEXT_ASSEMBLY_USAGE_OCCURRENCE({text(name)},{text(name)},'',"
        f"{whole.definition},{part.definition},$)"
    )
    used = r.add(f"PRODUCT_DEFINITION_SHAPE('','',{use})")
    move = r.add(f"ITEM_DEFINED_TRANSFORMATION('','',{home},{place})")
    relation = r.add(
        f"(REPRESENTATION_RELATIONSHIP('','',{part.representation},{whole.representation})"
        f"REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION({move})"
        "SHAPE_REPRESENTATION_RELATIONSHIP())"
    )
    r.add(f"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION({relation},{used})")


def step(bodies: Sequence[Body], *, name: str, program: str, date: str | None = None) -> str:
    """An assembly as a STEP file.

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
    places = [[r.place(place) for place in body.places] for body in bodies]
    frames = dict.fromkeys([home, *(one for frames in places for one in frames)])
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
