"""Draw the longitudinal section as DXF in mm, hatched and dimensioned, one layer per part.

Diameters are dimensioned above the parts, lengths below them, without overlaps. Dimensions are
DIMENSION entities that measure the drawing (DIMLFAC 1): if a line is moved in CAD, its dimension
follows. The drawing is at full scale, in mm; `DrawingSizes` has the sizes of letters and gaps.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import pairwise
from math import asin, cos, pi, radians, sin, sqrt, tan
from typing import Any, TypeAlias

from ..base.dataclass import dataclass
from ..base.errors import library
from ..evaluation.outline import notes
from ..evaluation.parts_list import parts_list
from ..evaluation.result import Evaluation, Outline
from ..rendering.ink import spread
from . import fits
from .step import BEARINGS, EYES, Profile, joined, millimetres, title

_CONTROL = re.compile(
    "[\x00-\x1f\x7f-\x9f\u200b-\u200f\u2028-\u202e\u2060-\u2069\ud800-\udfff\ufeff\ufffe\uffff]"
)


LONGEST = 200


def plain(words: str) -> str:
    r"""The text as one line of at most 200 characters, without control characters.

    >>> plain("a\nb"), len(plain(300 * "c"))
    ('a b', 200)
    """
    line = _CONTROL.sub(" ", words)
    return line if len(line) <= LONGEST else f"{line[: LONGEST - 1]}…"


LETTER = 0.95
"""Character width divided by height: an upper estimate, because fonts differ between programs."""


@dataclass(frozen=True, slots=True)
class DrawingSizes:
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
    """A length as drawn: the row of its dimension line (0 is nearest the parts), and its text.

    `middle` is the axial position of the text's centre; `outside` says that the text is beside the
    dimension line.
    """

    length: Length
    row: int
    middle: float
    outside: bool


def _clear(middle: float, half: float, lines: Sequence[float]) -> bool:
    return all(abs(middle - x) > half for x in lines)


def _middle(length: Length, paper: DrawingSizes, lines: Sequence[float]) -> tuple[float, bool]:
    """Centre of a dimension text, and whether the text is beside its dimension line.

    `lines` are axial positions of extension lines, which the text must not touch. A text that does
    not fit on its dimension line is placed beside it.
    """
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


def rows(lengths: Sequence[Length], paper: DrawingSizes) -> list[Placed]:
    """Assign each length to a row of dimensions: short ones near the parts, long ones further out.

    The extension lines of a length cross all rows between it and the parts. A text must therefore
    not overlap the extension lines of lengths in its own row or further out.
    """
    ordered = sorted(set(lengths), key=lambda x: (round(x.end - x.start, 6), x.start))
    ends = sorted({x for length in ordered for x in (length.start, length.end)})
    taken: list[list[tuple[float, float]]] = []
    placed = []
    for length in ordered:
        others = [x for x in ends if x not in (length.start, length.end)]
        middle, outside = _middle(length, paper, others)
        half = paper.width(length.text) / 2 + paper.letter / 2
        arrows = 2 * paper.arrow if outside else 0.0
        low = min(length.start - arrows, middle - half)
        high = max(length.end + arrows, middle + half)
        free = (
            row for row, spans in enumerate(taken) if all(high <= a or low >= b for a, b in spans)
        )
        row = next(free, len(taken))
        if row == len(taken):
            taken.append([])
        taken[row].append((low, high))
        placed.append(Placed(length, row, middle, outside))
    return placed


LAYER = "dimensions"
STYLE = "TRUE"
_COLOUR, _BY_LAYER, _BLACK_OR_WHITE = 153, 256, 7
"""DXF colour numbers: of dimension lines (readable on black and on white), "same as the layer", and
"black or white, whichever contrasts with the background"."""
_SMALLEST = 1e-6
"""Lengths below this value (mm) are not dimensioned."""


@dataclass(frozen=True, slots=True)
class _Diameter:
    """A diameter and its axial position in the drawing."""

    x: float
    value: float
    name: str

    @property
    def text(self) -> str:
        return f"%%c<> {self.name}"

    @property
    def shown(self) -> str:
        return f"0{number(self.value)} {self.name}"


def number(value: float) -> str:
    """Text of a length as the dimension style formats it: three decimals, no trailing zeros.

    >>> number(12.0), number(7.12345)
    ('12', '7.123')
    """
    return f"{value:.3f}".rstrip("0").rstrip(".")


def set_up(document: Any, paper: DrawingSizes) -> None:
    """Add the layer and the style of the dimensions: true lengths, ISO arrows."""
    document.layers.add(LAYER, color=_COLOUR, lineweight=18)
    style = document.dimstyles.new(STYLE)
    style.set_arrows(blk="", blk1="", blk2="")
    for name, value in {
        "dimlfac": 1.0, "dimscale": 1.0, "dimtxt": paper.letter, "dimasz": paper.arrow,
        "dimexo": 1.0 * paper.scale, "dimexe": 1.5 * paper.scale, "dimgap": 0.8 * paper.scale,
        "dimtad": 1, "dimtih": 0, "dimtoh": 0, "dimdec": 3, "dimzin": 8, "dimdsep": ord("."),
        "dimtxsty": "Standard",
        "dimclrd": _BY_LAYER,
        "dimclre": _BY_LAYER,
        "dimclrt": _BLACK_OR_WHITE,
    }.items():  # fmt: skip
        style.dxf.set(name, value)


def reach(profiles: Sequence[Profile], x: float) -> float:
    """Largest radius of the parts at an axial position."""
    radii = [
        max(r for _, r in profile)
        for profile in profiles
        if min(a for a, _ in profile) - 1e-9 <= x <= max(a for a, _ in profile) + 1e-9
    ]
    return max(radii, default=0.0)


def _stations(lengths: Mapping[str, float]) -> dict[str, tuple[float, float]]:
    """Start and end position of every axial length, mm."""
    mm = {name: 1000 * value for name, value in lengths.items()}
    face = mm["face"]
    plate = face + mm["plate"]
    start = plate + mm["spigot"] + mm["cap_bush"]
    end = start + mm["barrel_length"] + mm["head_bush"]
    piston = start + mm["piston_length"]
    spans = {
        "plate": (face, plate),
        "piston": (start, piston),
        "stroke": (piston, piston + mm["stroke"]),
        "head": (end - mm["head_length"], end),
        "other plate": (end, end + mm["plate"]),
        "extension": (end + mm["plate"], end + mm["plate"] + mm["extension"]),
        "barrel": (plate - mm["beyond_cap"], end + mm["beyond_head"]),
        "closed length": (mm["pin_cap"], mm["pin_rod"]),
    }
    if "second_rod" in mm:  # the spigot is then the gland of the cap
        spans["second gland"] = (plate, plate + mm["spigot"])
        spans["second extension"] = (0.0, face)
        spans["total length"] = spans.pop("closed length")
    return {name: span for name, span in spans.items() if span[1] - span[0] > _SMALLEST}


def _dimension_words(name: str, span: tuple[float, float]) -> str:
    prefix = f"{name} " if name in ("stroke", "closed length", "total length") else ""
    return prefix + number(span[1] - span[0])


def lengths_below(
    space: Any,
    evaluated: Mapping[str, float],
    skirts: Sequence[tuple[float, float]],
    profiles: Sequence[Profile],
    paper: DrawingSizes,
) -> float:
    """Draw dimension lengths below the parts, row by row.

    Parameters
    ----------
    space : model space of the DXF document
    evaluated : lengths of the evaluated design by name [m]
    skirts : start and end of the cap's skirt over the barrel [mm]; empty if there is none
    profiles : half-sections of all parts
    paper : sizes of letters and gaps

    Returns
    -------
    the lowest y coordinate used
    """
    spans = _stations(evaluated) | {f"skirt {k}": span for k, span in enumerate(skirts)}
    lengths = [Length(*span, _dimension_words(name, span)) for name, span in spans.items()]
    base = -max(r for profile in profiles for _, r in profile) - 1.2 * paper.row
    lowest = base
    for placed in rows(lengths, paper):
        length, y = placed.length, base - placed.row * paper.row
        ends = [(x, -reach(profiles, x)) for x in (length.start, length.end)]
        value = number(length.end - length.start)
        dimension = space.add_linear_dim(
            base=(length.start, y),
            p1=ends[0],
            p2=ends[1],
            text=length.text.replace(value, "<>"),
            dimstyle=STYLE,
            dxfattribs={"layer": LAYER},
        )
        height = y + 0.4 * paper.letter + 0.5 * paper.letter
        dimension.set_location((placed.middle, height), leader=False, relative=False)
        dimension.render()
        if placed.outside:
            half = paper.width(length.text) / 2
            far = placed.middle + (half if placed.middle > length.end else -half)
            near = length.end if placed.middle > length.end else length.start
            space.add_line((near, y), (far, y), dxfattribs={"layer": LAYER})
        lowest = min(lowest, y)
    return lowest


def _diameters(evaluated: Mapping[str, float]) -> list[_Diameter]:
    """Diameters to draw, from left to right: rod, bore, barrel, end plate and pin.

    Those of rod, bore and barrel are spread evenly over the stroke, so that their texts have room.
    """
    spans = _stations(evaluated)
    low, high = spans["stroke"]
    names = {
        "rod_inner": "rod bore",
        "rod": "rod",
        "bore": "bore",
        "barrel_outer_diameter": "barrel",
    }
    keys = [key for key in names if evaluated[key] > 0]
    step = (high - low) / (2 * len(keys))
    diameters = [
        _Diameter(low + step * (2 * k + 1), 1000 * evaluated[key], names[key])
        for k, key in enumerate(keys)
    ]
    if "plate" in spans:
        diameters.append(_Diameter(sum(spans["plate"]) / 2, 1000 * evaluated["plate_outer"], "cap"))
    second = evaluated.get("second_rod")
    if second is not None:
        middle = 500 * evaluated["face"]
        diameters.append(_Diameter(middle, 1000 * second, "second rod"))
    if evaluated["pin"] > 0:
        pin = 0.0 if second is None else 1000 * evaluated["pin_rod"]
        diameters.append(_Diameter(pin, 1000 * evaluated["pin"], "pin"))
    return sorted(diameters, key=lambda diameter: diameter.x)


def diameters_above(
    space: Any, evaluated: Mapping[str, float], profiles: Sequence[Profile], paper: DrawingSizes
) -> float:
    """Draw diameters, with texts in one row above the parts; return the largest y reached."""
    diameters = _diameters(evaluated)
    top = max(r for profile in profiles for _, r in profile)
    widths = [paper.width(diameter.shown) for diameter in diameters]
    gaps = [(a + b) / 2 + 2 * paper.letter for a, b in pairwise(widths)]
    elbow, row = top + 3 * paper.scale, top + 9 * paper.scale
    middles = spread([diameter.x for diameter in diameters], gaps)
    for diameter, middle in zip(diameters, middles, strict=True):
        half = diameter.value / 2
        dimension = space.add_linear_dim(
            base=(diameter.x, 0.0),
            p1=(diameter.x, -half),
            p2=(diameter.x, half),
            angle=90,
            text=diameter.text,
            dimstyle=STYLE,
            override={"dimse1": 1, "dimse2": 1, "dimtih": 1, "dimtoh": 1},
            dxfattribs={"layer": LAYER},
        )
        centre = row + 0.9 * paper.letter
        dimension.set_location((middle, centre), leader=False, relative=False)
        dimension.dimension.dxf.text_rotation = 0.0
        dimension.render()
        corners = [(diameter.x, half), (diameter.x, elbow), (middle, row)]
        space.add_lwpolyline(corners, dxfattribs={"layer": LAYER})
    return row + 2 * paper.letter


_SHEET = 270.0
"""Length of paper (mm) available for the section: A3 without the space for dimensions."""

_SCALES = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0)
"""Scales, as mm of the drawing per mm of paper: 10:1 to 1:200 of ISO 5455."""

_METAL = ((45.0, 1.5), (135.0, 1.5), (45.0, 0.9), (135.0, 0.9), (30.0, 2.0), (150.0, 2.0))
_COMPOSITE = ((60.0, 0.8), (120.0, 0.8), (75.0, 1.1), (105.0, 1.1))
_POLYMER = ((15.0, 1.2),)
"""Hatches (angle, spacing in mm of paper), assigned to materials in order of appearance."""

_COLOURS = (7, 23, 142, 94, 6, 42, 134, 200, 54, 213, 233, 74)
"""Colours of the layers, in order of the parts: each is visible on black and on white (7
adapts)."""

_Corner: TypeAlias = tuple[float, float, float]
"""Corner of a polyline: x, y and bulge. The bulge is tan(angle/4), where angle is the included
angle of the arc to the next corner."""


def paper_for(length: float) -> DrawingSizes:
    """The largest ISO 5455 scale at which a length (mm) fits the sheet.

    >>> paper_for(200.0).scale, paper_for(880.0).scale
    (1.0, 5.0)
    """
    return DrawingSizes(next((scale for scale in _SCALES if length <= scale * _SHEET), _SCALES[-1]))


def layer_name(part: str) -> str:
    """Layer name of a part; characters that layers do not allow become underscores."""
    return re.sub(r"[<>/\\\":;?*|=`',]", "_", part)


def _straight(points: Profile) -> list[_Corner]:
    return [(x, y, 0.0) for x, y in points]


def _halves(profile: Profile) -> list[list[_Corner]]:
    """Section of a part: both halves, or a single piece if the part reaches the axis."""
    below = tuple((x, -r) for x, r in reversed(profile))
    on_axis = [k for k, (_, r) in enumerate(profile) if r == 0]
    if not on_axis:
        return [_straight(profile), _straight(below)]
    first = next(k for k in on_axis if profile[k - 1][1] > 0)
    turned = profile[first:] + profile[:first]
    upper = tuple(point for point in turned if point[1] > 0)
    return [_straight((*upper, *((x, -r) for x, r in reversed(upper))))]


def _circle(centre: float, diameter: float) -> list[_Corner]:
    return [(centre - diameter / 2, 0.0, 1.0), (centre + diameter / 2, 0.0, 1.0)]


def _eye(
    centre: float, pin: float, radius: float, hole: float, side: int, neck: float
) -> list[list[_Corner]]:
    """Outlines of an eye seen along its pin: the lug with its neck, and the hole.

    The shape is that of `mass.eye_volume` or `spherical_bearing.bearing_eye_volume`, with a neck
    longer by `neck`.
    """
    foot, half = centre + side * sqrt(radius * radius - pin * pin / 4), pin / 2
    arc = -side * tan((2 * pi - 2 * asin(half / radius)) / 4)
    end = centre + side * (radius + pin + neck)
    lug = [(foot, half, 0.0), (end, half, 0.0), (end, -half, 0.0), (foot, -half, arc)]
    return [lug, _circle(centre, hole)]


def _profiles(outline: Outline) -> list[Profile]:
    return joined(millimetres(polygon) for polygon in outline.polygons)


def _cut(evaluation: Evaluation, outline: Outline) -> list[list[_Corner]]:
    """Closed outlines of a part in the section plane."""
    lengths = evaluation.lengths
    pin, radius, hole = (1000 * lengths[name] for name in ("pin", "eye_radius", "eye_hole"))
    if outline.part in EYES:
        at, side = ("pin_cap", 1) if outline.part == "cap eye" else ("pin_rod", -1)
        neck, face = (1000 * lengths[name] for name in ("neck", "face"))
        if outline.part == "rod eye" or neck == 0.0:
            return _eye(1000 * lengths[at], pin, radius, hole, side, 0.0)
        if lengths["cap_stack"] == 0.0:
            return _eye(1000 * lengths[at], pin, radius, hole, side, neck)
        near = face - neck  # components are between eye and neck
        shaft = ((near, pin / 2), (near, -pin / 2), (face, -pin / 2), (face, pin / 2))
        return [*_eye(1000 * lengths[at], pin, radius, hole, side, 0.0), _straight(shaft)]
    if outline.part == BEARINGS:
        pins = ("pin_rod",) if evaluation.design.double_rod else ("pin_cap", "pin_rod")
        ends = [1000 * lengths[at] for at in pins]
        return [_circle(end, size) for end in ends for size in (hole, pin)]
    lines = [half for profile in _profiles(outline) for half in _halves(profile)]
    return lines if -1 in outline.sides else [line for line in lines if line[0][1] > 0]


def _hatches(outlines: Sequence[Outline]) -> dict[tuple[str, str], tuple[float, float]]:
    styles: dict[tuple[str, str], tuple[float, float]] = {}
    for kind, table in (("metal", _METAL), ("composite", _COMPOSITE), ("polymer", _POLYMER)):
        names = dict.fromkeys(outline.material for outline in outlines if outline.kind == kind)
        for index, name in enumerate(names):
            styles[kind, name] = table[index % len(table)]
    return styles


def _hatch(
    space: Any,
    lines: Sequence[Sequence[_Corner]],
    style: tuple[float, float] | None,
    attributes: Mapping[str, Any],
    *,
    nested: bool,
) -> None:
    """Hatch closed outlines, or fill them if no hatch style is given.

    Nested outlines get a single hatch, which leaves the inner outlines open.
    """
    for group in [lines] if nested else [[line] for line in lines]:
        hatch = space.add_hatch(dxfattribs={**attributes, "hatch_style": 0})
        if style is None:
            hatch.set_solid_fill()
            hatch.dxf.color = 256
        else:
            angle, spacing = style
            pattern = [[angle, (0.0, 0.0), _across(angle, spacing), []]]
            hatch.set_pattern_fill("ACTUATOR", color=256, definition=pattern)
        for index, line in enumerate(group):
            hatch.paths.add_polyline_path(line, is_closed=True, flags=16 if index else 1)


def _across(angle: float, spacing: float) -> tuple[float, float]:
    """Vector (x, y) from one hatch line to the next, perpendicular to the lines."""
    turn = radians(angle + 90.0)
    return spacing * cos(turn), spacing * sin(turn)


def _parts(
    space: Any, evaluation: Evaluation, outlines: Sequence[Outline], paper: DrawingSizes
) -> None:
    looks = _hatches(outlines)
    layers = space.doc.layers
    for index, outline in enumerate(outlines):
        layer = layer_name(title(outline.part))
        if layer not in layers:
            layers.add(layer, color=_COLOURS[index % len(_COLOURS)], lineweight=35)
        lines = _cut(evaluation, outline)
        look = looks.get((outline.kind, outline.material))
        if look is not None:
            look = look[0], look[1] * paper.scale
        thin = {"layer": layer, "lineweight": 13}
        if outline.kind != "oil":
            _hatch(space, lines, look, thin, nested=outline.part in (*EYES, BEARINGS))
        for line in lines:
            space.add_lwpolyline(line, format="xyb", close=True, dxfattribs={"layer": layer})


def _axis(space: Any, first: float, last: float, paper: DrawingSizes) -> None:
    space.doc.layers.add("axis", color=1, linetype="CENTER", lineweight=18)
    space.doc.header["$LTSCALE"] = 0.4 * paper.scale
    over = 5.0 * paper.scale
    space.add_line((first - over, 0.0), (last + over, 0.0), dxfattribs={"layer": "axis"})


def _words(
    space: Any, evaluation: Evaluation, outlines: Sequence[Outline], paper: DrawingSizes,
    corner: tuple[float, float], origin: str,
) -> None:  # fmt: skip
    """Write title and parts list, line by line, below the dimensions."""
    space.doc.layers.add("text", color=7, lineweight=18)
    scale = paper.scale
    size = f"1:{scale:g}" if scale >= 1 else f"{1 / scale:g}:1"
    lines = [
        evaluation.name,
        f"Section, retracted. Lengths in mm, drawn 1:1; text height for print at {size}.",
        origin,
        "",
        *(f"{title(outline.part)}: {outline.material}" for outline in outlines),
        "",
        "Not drawn, as the models do not describe their shape: threads, fillets, chamfers"
        f"{'' if evaluation.design.cylinder.port_thread else ', ports'}.",
        "Rings are drawn as rectangles in their grooves, not with their true sections.",
    ]
    lines += notes(evaluation.design, evaluation.lengths)
    lines += ["", *fits.notes(evaluation), *_masses(evaluation)]
    x, y = corner
    for index, words in enumerate(lines):
        if words:
            text = plain(words).replace("%%", "% %")
            attributes = {"layer": "text", "height": paper.letter, "style": "Standard"}
            place = (x, y - index * 1.7 * paper.letter)
            space.add_text(text, dxfattribs=attributes).set_placement(place)


def _masses(evaluation: Evaluation) -> Iterator[str]:
    """Yield the parts list, with pieces, masses and materials, and the sum of the masses."""
    yield "Parts list: pieces, part, mass, material"
    for part, pieces, material, mass in parts_list(evaluation):
        if mass:
            count = "" if pieces is None else f"{pieces} "
            yield f"{count}{title(part)}, {1e3 * mass:.4g} g, {material}"
    yield f"Sum {1e3 * sum(evaluation.mass_parts.values()):.4g} g, without oil."


@contextmanager
def _repeatable(ezdxf: Any) -> Iterator[None]:
    """Make the output of ezdxf reproducible: without times and random identifiers."""
    before = ezdxf.options.write_fixed_meta_data_for_testing
    ezdxf.options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = before


def _ordered_classes(document: Any) -> None:
    """Register the classes in the order of their names.

    ezdxf reads them from a set, whose order differs between processes.
    """
    for name in sorted(document.entitydb.dxf_types_in_use()):
        document.classes.add_class(name)


def _skirts(outlines: Sequence[Outline], start: float) -> list[tuple[float, float]]:
    """Start and end of the cap's skirt over the barrel at the cap end; empty if there is none."""
    caps = [
        profile for outline in outlines if outline.part == "caps" for profile in _profiles(outline)
    ]
    ends = [max(x for x, _ in profile) for profile in caps[:1]]
    return [(start, end) for end in ends if end > start]


def dxf(evaluation: Evaluation, *, program: str, date: str | None = None) -> bytes:
    """Draw the section of an evaluated design; return the text of a DXF file (R2010).

    Parameters
    ----------
    evaluation : evaluation of the design to draw
    program : name of the writing program
    date : ISO date, or None

    Raises
    ------
    ActuatorError : ezdxf (extra ``cad``) is not installed
    """
    ezdxf = library("ezdxf")
    outlines = [
        outline
        for outline in evaluation.outlines
        if outline.polygons and (outline.kind != "oil" or outline.radial)
    ]
    profiles = [millimetres(polygon) for outline in outlines for polygon in outline.polygons]
    first = min(x for profile in profiles for x, _ in profile)
    last = max(x for profile in profiles for x, _ in profile)
    paper = paper_for(last - first)
    with _repeatable(ezdxf):
        document = ezdxf.new("R2010", setup=["linetypes"], units=ezdxf.units.MM)
        document.header["$MEASUREMENT"] = 1
        document.header["$DIMLFAC"] = 1.0
        document.styles.get("Standard").dxf.font = "arial.ttf"
        space = document.modelspace()
        set_up(document, paper)
        _parts(space, evaluation, outlines, paper)
        _axis(space, first, last, paper)
        lengths = evaluation.lengths
        diameters_above(space, lengths, profiles, paper)
        skirts = _skirts(outlines, 1000 * (lengths["face"] + lengths["plate"]))
        lowest = lengths_below(space, lengths, skirts, profiles, paper)
        origin = ", ".join(part for part in (program, date) if part)
        corner = (first, lowest - 1.5 * paper.row)
        _words(space, evaluation, outlines, paper, corner, origin)
        _ordered_classes(document)
        text = io.StringIO()
        document.write(text)
    return text.getvalue().encode(document.output_encoding, "backslashreplace")
