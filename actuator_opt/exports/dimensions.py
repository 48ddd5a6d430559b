"""Dimensions of the section as DIMENSION entities: diameters above the parts, lengths below.

They measure the drawing itself (DIMLFAC 1): if a line is moved in CAD, its dimension follows.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from ..rendering.ink import spread
from .layout import Length, Paper, rows
from .solids import Profile

LAYER = "dimensions"
STYLE = "TRUE"
_COLOUR, _BY_LAYER, _BLACK_OR_WHITE = 153, 256, 7
"""Of the lines, which show on black and on white; letters take the colour that the ground lacks."""

_SMALLEST = 1e-6
"""Shorter lengths (mm) are not dimensioned."""


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
    """A length in the format of the dimension style: three decimals, no trailing zeros.

    >>> number(12.0), number(7.12345)
    ('12', '7.123')
    """
    return f"{value:.3f}".rstrip("0").rstrip(".")


def set_up(document: Any, paper: Paper) -> None:
    """Add the layer and the dimension style: true lengths, ISO arrows."""
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
    found = [
        max(r for _, r in profile)
        for profile in profiles
        if min(a for a, _ in profile) - 1e-9 <= x <= max(a for a, _ in profile) + 1e-9
    ]
    return max(found, default=0.0)


def _stations(lengths: Mapping[str, float]) -> dict[str, tuple[float, float]]:
    """Start and end of every axial length, mm."""
    mm = {name: 1000 * value for name, value in lengths.items()}
    face = mm["eye_offset"]
    start = face + mm["plate"]
    end = start + mm["barrel_length"]
    piston = start + mm["piston_length"]
    spans = {
        "plate": (face, start),
        "piston": (start, piston),
        "stroke": (piston, piston + mm["stroke"]),
        "head": (end - mm["head_length"], end),
        "other plate": (end, end + mm["plate"]),
        "extension": (end + mm["plate"], end + mm["plate"] + mm["extension"]),
        "barrel": (start, end),
        "closed length": (mm["pin_cap"], mm["pin_rod"]),
    }
    return {name: span for name, span in spans.items() if span[1] - span[0] > _SMALLEST}


def _words(name: str, span: tuple[float, float]) -> str:
    told = {"stroke": "stroke ", "closed length": "closed length "}.get(name, "")
    return told + number(span[1] - span[0])


def lengths_below(
    space: Any,
    evaluated: Mapping[str, float],
    skirts: Sequence[tuple[float, float]],
    profiles: Sequence[Profile],
    paper: Paper,
) -> float:
    """Draw dimension lengths below the parts, row by row.

    Parameters
    ----------
    space : model space
    evaluated : `lengths` of the evaluation
    skirts : start and end of the dimensioned skirt, mm, if any
    profiles : half-sections of all parts
    paper : sizes of letters and gaps

    Returns
    -------
    the lowest y coordinate used
    """
    spans = _stations(evaluated) | {f"skirt {k}": span for k, span in enumerate(skirts)}
    lengths = [Length(*span, _words(name, span)) for name, span in spans.items()]
    base = -max(r for profile in profiles for _, r in profile) - 1.2 * paper.row
    lowest = base
    for placed in rows(lengths, paper):
        one, y = placed.length, base - placed.row * paper.row
        ends = [(x, -reach(profiles, x)) for x in (one.start, one.end)]
        value = number(one.end - one.start)
        dimension = space.add_linear_dim(
            base=(one.start, y),
            p1=ends[0],
            p2=ends[1],
            text=one.text.replace(value, "<>"),
            dimstyle=STYLE,
            dxfattribs={"layer": LAYER},
        )
        height = y + 0.4 * paper.letter + 0.5 * paper.letter
        dimension.set_location((placed.middle, height), leader=False, relative=False)
        dimension.render()
        if placed.outside:
            half = paper.width(one.text) / 2
            far = placed.middle + (half if placed.middle > one.end else -half)
            near = one.end if placed.middle > one.end else one.start
            space.add_line((near, y), (far, y), dxfattribs={"layer": LAYER})
        lowest = min(lowest, y)
    return lowest


def _wanted(evaluated: Mapping[str, float], profiles: Sequence[Profile]) -> list[_Diameter]:
    """Diameters of rod, bore and barrel at the chamber, and of the plate."""
    spans = _stations(evaluated)
    low, high = spans["stroke"]
    names = {
        "rod_inner": "rod bore",
        "rod": "rod",
        "bore": "bore",
        "barrel_outer_diameter": "barrel",
    }
    asked = [(key, name) for key, name in names.items() if evaluated[key] > 0]
    found = [
        _Diameter(low + (high - low) * (2 * k + 1) / (2 * len(asked)), 1000 * evaluated[key], name)
        for k, (key, name) in enumerate(asked)
    ]
    if "plate" in spans:
        found.append(_Diameter(sum(spans["plate"]) / 2, 1000 * evaluated["plate_outer"], "cap"))
    if evaluated["pin"] > 0:
        found.append(_Diameter(0.0, 1000 * evaluated["pin"], "pin"))
    return sorted(found, key=lambda one: one.x)


def diameters_above(
    space: Any, evaluated: Mapping[str, float], profiles: Sequence[Profile], paper: Paper
) -> float:
    """Draw diameters, with texts in one row above the parts; returns the highest y used."""
    wanted = _wanted(evaluated, profiles)
    top = max(r for profile in profiles for _, r in profile)
    widths = [paper.width(one.shown) for one in wanted]
    gaps = [(a + b) / 2 + 2 * paper.letter for a, b in pairwise(widths)]
    elbow, row = top + 3 * paper.scale, top + 9 * paper.scale
    for one, middle in zip(wanted, spread([one.x for one in wanted], gaps), strict=True):
        half = one.value / 2
        dimension = space.add_linear_dim(
            base=(one.x, 0.0),
            p1=(one.x, -half),
            p2=(one.x, half),
            angle=90,
            text=one.text,
            dimstyle=STYLE,
            override={"dimse1": 1, "dimse2": 1, "dimtih": 1, "dimtoh": 1},
            dxfattribs={"layer": LAYER},
        )
        centre = row + 0.9 * paper.letter
        dimension.set_location((middle, centre), leader=False, relative=False)
        dimension.dimension.dxf.text_rotation = 0.0
        dimension.render()
        corners = [(one.x, half), (one.x, elbow), (middle, row)]
        space.add_lwpolyline(corners, dxfattribs={"layer": LAYER})
    return row + 2 * paper.letter
