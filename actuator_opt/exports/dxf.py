"""The longitudinal section as DXF: true lengths in mm, hatched, dimensioned, one layer per part."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from math import cos, radians, sin, sqrt, tan
from typing import Any, TypeAlias

from ..base.extras import library
from ..evaluation.outline import notes
from ..evaluation.result import Evaluation, Outline
from . import dimensions
from .layout import Paper
from .solids import EYES, Profile, joined, millimetres, title
from .words import plain

_SHEET = 270.0
"""Paper length (mm) for the section: A3 with space for dimensions."""

_SCALES = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0)
"""mm of the drawing per mm of paper: 10:1 to 1:200 of ISO 5455."""

_METAL = ((45.0, 1.5), (135.0, 1.5), (45.0, 0.9), (135.0, 0.9), (30.0, 2.0), (150.0, 2.0))
_COMPOSITE = ((60.0, 0.8), (120.0, 0.8), (75.0, 1.1), (105.0, 1.1))
_POLYMER = ((15.0, 1.2),)
"""Angle and spacing (mm of paper) of hatches, by material in order of appearance."""

_COLOURS = (7, 23, 142, 94, 6, 42, 134, 200, 54, 213, 233, 74)
"""Of the layers, by part: each shows on a black ground and on a white ground (7 is the other)."""

_Corner: TypeAlias = tuple[float, float, float]
"""x, y and bulge of a polyline: tan of a quarter of the arc to the next corner."""


def paper_for(length: float) -> Paper:
    """The largest ISO 5455 scale at which a length (mm) fits the sheet.

    >>> paper_for(200.0).scale, paper_for(880.0).scale
    (1.0, 5.0)
    """
    return Paper(next((one for one in _SCALES if length <= one * _SHEET), _SCALES[-1]))


def layer_name(part: str) -> str:
    """Layer name of a part; characters that layers do not allow become underscores."""
    return re.sub(r"[<>/\\\":;?*|=`',]", "_", part)


def _straight(points: Profile) -> list[_Corner]:
    return [(x, y, 0.0) for x, y in points]


def _halves(profile: Profile) -> list[list[_Corner]]:
    """The section of a part: both halves, or a single piece if the part meets the axis."""
    below = tuple((x, -r) for x, r in reversed(profile))
    on_axis = [k for k, (_, r) in enumerate(profile) if r == 0]
    if not on_axis:
        return [_straight(profile), _straight(below)]
    first = next(k for k in on_axis if profile[k - 1][1] > 0)
    turned = profile[first:] + profile[:first]
    upper = tuple(point for point in turned if point[1] > 0)
    return [_straight((*upper, *((x, -r) for x, r in reversed(upper))))]


def _eye(centre: float, pin: float, side: int) -> list[list[_Corner]]:
    """The eye of `mass.eye_volume` seen along its pin: lug with neck, and the hole."""
    foot, half = centre + side * sqrt(0.75) * pin, pin / 2
    arc = -side * tan(radians(300 / 4))
    end = centre + side * 2 * pin
    lug = [(foot, half, 0.0), (end, half, 0.0), (end, -half, 0.0), (foot, -half, arc)]
    return [lug, [(centre - half, 0.0, 1.0), (centre + half, 0.0, 1.0)]]


def _profiles(outline: Outline) -> list[Profile]:
    return joined(millimetres(polygon) for polygon in outline.polygons)


def _cut(evaluation: Evaluation, outline: Outline) -> list[list[_Corner]]:
    """Closed lines of a part in the section plane."""
    if outline.part in EYES:
        at, side = ("pin_cap", 1) if outline.part == "cap eye" else ("pin_rod", -1)
        lengths = evaluation.lengths
        return _eye(1000 * lengths[at], 1000 * lengths["pin"], side)
    lines = [half for profile in _profiles(outline) for half in _halves(profile)]
    if outline.bars % 2:
        return [line for line in lines if line[0][1] > 0]  # no bar opposite the first
    return lines


def _hatches(outlines: Sequence[Outline]) -> dict[tuple[str, str], tuple[float, float]]:
    found: dict[tuple[str, str], tuple[float, float]] = {}
    for kind, table in (("metal", _METAL), ("composite", _COMPOSITE), ("polymer", _POLYMER)):
        names = dict.fromkeys(one.material for one in outlines if one.kind == kind)
        for index, name in enumerate(names):
            found[kind, name] = table[index % len(table)]
    return found


def _hatch(
    space: Any,
    lines: Sequence[Sequence[_Corner]],
    look: tuple[float, float] | None,
    attributes: Mapping[str, Any],
    *,
    nested: bool,
) -> None:
    """Hatch closed lines, jointly if nested; fill them if no hatch style is given."""
    for group in [lines] if nested else [[line] for line in lines]:
        hatch = space.add_hatch(dxfattribs={**attributes, "hatch_style": 0})
        if look is None:
            hatch.set_solid_fill()
            hatch.dxf.color = 256
        else:
            angle, spacing = look
            line = [[angle, (0.0, 0.0), _across(angle, spacing), []]]
            hatch.set_pattern_fill("ACTUATOR", color=256, definition=line)
        for index, one in enumerate(group):
            hatch.paths.add_polyline_path(one, is_closed=True, flags=16 if index else 1)


def _across(angle: float, spacing: float) -> tuple[float, float]:
    """Offset between neighbouring hatch lines."""
    turn = radians(angle + 90.0)
    return spacing * cos(turn), spacing * sin(turn)


def _parts(space: Any, evaluation: Evaluation, outlines: Sequence[Outline], paper: Paper) -> None:
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
        _hatch(space, lines, look, thin, nested=outline.part in EYES)
        for line in lines:
            space.add_lwpolyline(line, format="xyb", close=True, dxfattribs={"layer": layer})


def _axis(space: Any, first: float, last: float, paper: Paper) -> None:
    space.doc.layers.add("axis", color=1, linetype="CENTER", lineweight=18)
    space.doc.header["$LTSCALE"] = 0.4 * paper.scale
    over = 5.0 * paper.scale
    space.add_line((first - over, 0.0), (last + over, 0.0), dxfattribs={"layer": "axis"})


def _words(
    space: Any, evaluation: Evaluation, outlines: Sequence[Outline], paper: Paper,
    corner: tuple[float, float], made: str,
) -> None:  # fmt: skip
    """Title and parts list, line by line below the dimensions."""
    space.doc.layers.add("text", color=7, lineweight=18)
    scale = paper.scale
    size = f"1:{scale:g}" if scale >= 1 else f"{1 / scale:g}:1"
    lines = [
        evaluation.name,
        f"Section, retracted. Lengths in mm, drawn 1:1; text height for print at {size}.",
        made,
        "",
        *(f"{title(one.part)}: {one.material}" for one in outlines),
        "",
        "Not drawn, as the models have no geometry for them: threads, ports, fillets, chamfers.",
        "Rings are drawn as rectangles in their grooves, without their true sections.",
    ]
    lines += notes(evaluation.design, evaluation.lengths)
    x, y = corner
    for index, words in enumerate(lines):
        if words:
            text = plain(words).replace("%%", "% %")
            attributes = {"layer": "text", "height": paper.letter, "style": "Standard"}
            place = (x, y - index * 1.7 * paper.letter)
            space.add_text(text, dxfattribs=attributes).set_placement(place)


@contextmanager
def _repeatable(ezdxf: Any) -> Iterator[None]:
    """Make the output reproducible: no time, no random identifiers."""
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
    """The skirt of the cap end, if any."""
    caps = [profile for one in outlines if one.part == "caps" for profile in _profiles(one)]
    ends = [max(x for x, _ in profile) for profile in caps[:1]]
    return [(start, end) for end in ends if end > start]


def dxf(evaluation: Evaluation, *, program: str, date: str | None = None) -> bytes:
    """The section of an evaluation as a DXF file (R2010).

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
    outlines = [one for one in evaluation.outlines if one.polygons and one.kind != "oil"]
    profiles = [millimetres(polygon) for one in outlines for polygon in one.polygons]
    first = min(x for profile in profiles for x, _ in profile)
    last = max(x for profile in profiles for x, _ in profile)
    paper = paper_for(last - first)
    with _repeatable(ezdxf):
        document = ezdxf.new("R2010", setup=["linetypes"], units=ezdxf.units.MM)
        document.header["$MEASUREMENT"] = 1
        document.header["$DIMLFAC"] = 1.0
        document.styles.get("Standard").dxf.font = "arial.ttf"
        space = document.modelspace()
        dimensions.set_up(document, paper)
        _parts(space, evaluation, outlines, paper)
        _axis(space, first, last, paper)
        lengths = evaluation.lengths
        dimensions.diameters_above(space, lengths, profiles, paper)
        skirts = _skirts(outlines, 1000 * (lengths["eye_offset"] + lengths["plate"]))
        lowest = dimensions.lengths_below(space, lengths, skirts, profiles, paper)
        made = ", ".join(part for part in (program, date) if part)
        corner = (first, lowest - 1.5 * paper.row)
        _words(space, evaluation, outlines, paper, corner, made)
        _ordered_classes(document)
        text = io.StringIO()
        document.write(text)
    return text.getvalue().encode(document.output_encoding, "backslashreplace")
