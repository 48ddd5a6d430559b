"""Read a STEP file back, without the code that wrote it: topology, orientation, volumes.

Bodies of revolution about lines along x: planes, cylinders, cones, circles, straight seams.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from dataclasses import dataclass

_TOKEN = re.compile(r"'(?:[^']|'')*'|#\d+|\.\w+\.|[-+]?\d+\.\d*(?:E[-+]?\d+)?|[-+]?\d+|\w+|[(),$*]")


@dataclass(frozen=True)
class Face:
    """A surface of revolution: kind, its straight section, sense, and the circles around it."""

    kind: str
    start: tuple[float, float]
    end: tuple[float, float]
    outwards: float
    circles: tuple[tuple[float, float, int], ...]
    """(x, radius, turn about +x) of the bounds, as walked."""


class StepFile:
    """The records of a file, by number."""

    def __init__(self, text):
        head, data = text.split("DATA;\n")
        assert text.isascii()
        assert head.startswith("ISO-10303-21;\nHEADER;\n")
        assert data.endswith("ENDSEC;\nEND-ISO-10303-21;\n")
        self.header = head
        self.records = {}
        for line in data.splitlines()[:-2]:
            number, record = re.fullmatch(r"(#\d+)=(.*);", line).groups()
            assert number not in self.records
            self.records[number] = self._read(record)
        for record in self.records.values():
            assert all(one in self.records for one in self._references(record)), record

    @staticmethod
    def _read(record):
        tokens = _TOKEN.findall(record)
        assert "".join(tokens) == re.sub(r"\s+(?=[^']*(?:'[^']*'[^']*)*$)", "", record), record
        at = 0

        def value():
            nonlocal at
            token = tokens[at]
            at += 1
            if token == "(":
                items = []
                while tokens[at] != ")":
                    if tokens[at] == ",":
                        at += 1
                    items.append(value())
                at += 1
                return items
            if re.fullmatch(r"[A-Z]\w*", token):
                return [token, value()]
            if token[0] in "+-0123456789":
                return float(token)
            return token

        found = value()
        assert at == len(tokens)
        return found

    def _references(self, item):
        if isinstance(item, list):
            return [one for part in item for one in self._references(part)]
        return [item] if isinstance(item, str) and item.startswith("#") else []

    def of(self, kind):
        """Numbers of all records of a kind."""
        return [n for n, record in self.records.items() if record[0] == kind]

    def get(self, number, kind):
        """Arguments of a record that must be of a kind."""
        record = self.records[number]
        assert record[0] == kind, record
        return record[1]

    def point(self, number):
        """Coordinates of a point."""
        return tuple(self.get(number, "CARTESIAN_POINT")[1])

    def axis(self, number):
        """Position along x and sense of a frame about a line along x through the origin."""
        _, origin, along, across = self.get(number, "AXIS2_PLACEMENT_3D")
        x, y, z = self.point(origin)
        assert (y, z) == (0.0, 0.0)
        direction = self.get(along, "DIRECTION")[1]
        assert self.get(across, "DIRECTION")[1] == [0.0, 1.0, 0.0]
        assert direction in ([1.0, 0.0, 0.0], [-1.0, 0.0, 0.0])
        return x, direction[0]

    def vertex(self, number):
        """(x, radius) of a vertex, which lies at y = radius."""
        x, y, z = self.point(self.get(number, "VERTEX_POINT")[1])
        assert z == 0.0
        assert y >= 0.0
        return x, y

    def edge(self, number):
        """Start, end, and (x, radius, turn) of a circle or None of a straight edge."""
        _, start, end, curve, same = self.get(number, "EDGE_CURVE")
        assert same == ".T."
        a, b = self.vertex(start), self.vertex(end)
        kind, arguments = self.records[curve]
        if kind == "CIRCLE":
            x, turn = self.axis(arguments[1])
            assert start == end
            assert a == (x, arguments[2])
            return start, end, (x, arguments[2], int(turn))
        assert kind == "LINE"
        px, py, pz = self.point(arguments[1])
        dx, dy, dz = self.get(self.get(arguments[2], "VECTOR")[1], "DIRECTION")[1]
        assert pz == dz == 0.0
        length = math.dist(a, b)
        assert (px, py) == a
        assert math.isclose(math.hypot(dx, dy), 1.0, rel_tol=1e-12)
        assert math.dist((px + length * dx, py + length * dy), b) < 1e-9
        return start, end, None

    def loop(self, number, uses):
        """Circles of a closed loop, as walked; counts every use of an edge."""
        walk, circles = [], []
        for one in self.get(number, "EDGE_LOOP")[1]:
            _, _, _, edge, way = self.get(one, "ORIENTED_EDGE")
            start, end, circle = self.edge(edge)
            forth = way == ".T."
            uses[edge, forth] += 1
            walk.append((start, end) if forth else (end, start))
            if circle is not None:
                circles.append((*circle[:2], circle[2] if forth else -circle[2]))
        for (_, end), (start, _) in zip(walk, walk[1:] + walk[:1], strict=True):
            assert end == start
        return circles

    def face(self, number, uses):
        """A face of a plane, cylinder or cone that its circles lie on."""
        _, bounds, surface, same = self.get(number, "ADVANCED_FACE")
        circles, outer = [], 0
        for bound in bounds:
            kind, (_, loop, way) = self.records[bound]
            assert kind in ("FACE_OUTER_BOUND", "FACE_BOUND")
            assert way == ".T."
            outer += kind == "FACE_OUTER_BOUND"
            circles += self.loop(loop, uses)
        assert outer == 1
        sense = 1.0 if same == ".T." else -1.0
        kind, arguments = self.records[surface]
        x, along = self.axis(arguments[1])
        if kind == "PLANE":
            assert all(one[0] == x for one in circles)
            radii = sorted(one[1] for one in circles)
            inner = radii[0] if len(radii) == 2 else 0.0
            return Face(kind, (x, inner), (x, radii[-1]), sense * along, tuple(circles))
        if kind == "CYLINDRICAL_SURFACE":
            assert all(one[1] == arguments[2] for one in circles)
            (a, b) = sorted(one[:2] for one in circles)
            return Face(kind, a, b, sense, tuple(circles))
        assert kind == "CONICAL_SURFACE"
        radius, slope = arguments[2:]
        assert 0 < slope < math.pi / 2
        for position, r, _ in circles:  # the circles lie on the cone
            assert math.isclose(r, radius + (position - x) * along * math.tan(slope), abs_tol=1e-9)
        ends = [one[:2] for one in circles]
        if len(ends) == 1:
            ends.append((x - along * radius / math.tan(slope), 0.0))
        return Face(kind, *sorted(ends), sense, tuple(circles))

    def solid(self, number):
        """Faces of a solid whose shell is closed and whose orientation is consistent."""
        shell = self.get(number, "MANIFOLD_SOLID_BREP")[1]
        uses = Counter()
        numbers = self.get(shell, "CLOSED_SHELL")[1]
        faces = [self.face(one, uses) for one in numbers]
        edges = {edge for edge, _ in uses}
        assert uses == {(edge, way): 1 for edge in edges for way in (True, False)}
        vertices = {v for edge in edges for v in self.edge(edge)[:2]}
        rims = sum(len(self.get(one, "ADVANCED_FACE")[1]) - 1 for one in numbers)
        euler = len(vertices) - len(edges) + len(faces) - rims
        assert euler in (0, 2)  # a ring or a ball
        for face in faces:
            check_orientation(face)
        return faces

    def solids(self):
        """Name to faces of every solid."""
        return {
            self.get(one, "MANIFOLD_SOLID_BREP")[0][1:-1]: self.solid(one)
            for one in self.of("MANIFOLD_SOLID_BREP")
        }

    def occurrences(self):
        """(product, place) of everything in the assembly, none of it turned."""
        assert all(axis == (1.0, 0.0, 0.0) for _, _, axis in self.placed())
        return [(name, place) for name, place, _ in self.placed()]

    def placed(self):
        """(product, place, direction of its x axis) of everything in the assembly."""
        found = []
        for use in self.of("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION"):
            relation, shape = self.records[use][1]
            names = {"REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION"}
            record = self.records[relation]
            parts = record if isinstance(record[0], list) else [record]
            (move,) = next(part[1] for part in parts if part[0] in names)
            _, _, home, place = self.get(move, "ITEM_DEFINED_TRANSFORMATION")
            frames = [self.get(one, "AXIS2_PLACEMENT_3D") for one in (home, place)]
            ahead, axes = (
                [tuple(self.get(one, "DIRECTION")[1]) for one in frame[2:]] for frame in frames
            )
            assert ahead == [(0.0, 0.0, 1.0), (1.0, 0.0, 0.0)]
            assert sum(a * b for a, b in zip(*axes, strict=True)) == 0.0
            assert self.point(frames[0][1]) == (0.0, 0.0, 0.0)
            owner = self.get(shape, "PRODUCT_DEFINITION_SHAPE")[2]
            part = self.get(owner, "NEXT_ASSEMBLY_USAGE_OCCURRENCE")[4]
            formation = self.get(part, "PRODUCT_DEFINITION")[2]
            product = self.get(formation, "PRODUCT_DEFINITION_FORMATION")[2]
            name = self.get(product, "PRODUCT")[0][1:-1]
            found.append((name, self.point(frames[1][1]), axes[1]))
        return found


def _flux(face, field):
    """Flux of (f_x, f_r)(x, r) through a face along its outward normal, by Simpson's rule.

    Exact for the quadratic and cubic integrands used here.
    """
    (x1, r1), (x2, r2) = face.start, face.end
    dx, dr = x2 - x1, r2 - r1
    if face.kind == "PLANE":
        nx, nr = face.outwards * abs(dr), 0.0
    else:  # from the axis outwards, times the sense
        nx, nr = -face.outwards * dr, face.outwards * dx
    total = 0.0
    for t, weight in ((0.0, 1 / 6), (0.5, 4 / 6), (1.0, 1 / 6)):
        x, r = x1 + t * dx, r1 + t * dr
        fx, fr = field(x, r)
        total += weight * 2 * math.pi * r * (fx * nx + fr * nr)
    return total


def check_orientation(face):
    """Stokes' theorem on a face: G = (0, -xz, xy) around it is the flux of (2x, -y, -z).

    Only a boundary walked with the material on its left satisfies it. Planes, whose flux may
    vanish, are also checked with G = (0, -z, y), of curl (2, 0, 0).
    """
    around = sum(turn * 2 * math.pi * r * r * x for x, r, turn in face.circles)
    through = _flux(face, lambda x, r: (2 * x, -r))
    assert math.isclose(around, through, rel_tol=1e-9, abs_tol=1e-9 * (1 + abs(around)))
    around = sum(turn * 2 * math.pi * r * r for _, r, turn in face.circles)
    through = _flux(face, lambda x, r: (2.0, 0.0))
    assert math.isclose(around, through, rel_tol=1e-9, abs_tol=1e-9 * (1 + abs(around)))


def volume(faces):
    """Volume by the divergence theorem, twice: of x along the axis, and of r/2 across it."""
    along = sum(_flux(face, lambda x, r: (x, 0.0)) for face in faces)
    across = sum(_flux(face, lambda x, r: (0.0, r / 2)) for face in faces)
    assert math.isclose(along, across, rel_tol=1e-9), (along, across)
    return along
