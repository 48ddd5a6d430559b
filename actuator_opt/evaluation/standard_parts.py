"""Standard sizes in a design: bore and rod, glands and housings. A remark, not a limit."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Literal

import numpy as np

from ..base.errors import InputError
from ..design import standard_sizes as standards
from ..design.housings import gland_deviations, housings, housings_for
from ..design.model import Design
from .film import floats
from .gland_check import squeezes
from .result import Check
from .rings import Place, Ring

PLACES: tuple[Place, ...] = ("piston", "rod")

NEAR = 0.02
"""Relative difference of a housing's depth or length that is ignored."""
_SIZES, _GLANDS, _SECTIONS = "standard sizes", "standard glands", "ISO 3601-2 sections (AS568)"


def sizes(design: Design) -> Check:
    """Whether bore and rod are ISO 3320 sizes; otherwise the nearest sizes."""
    odd = []
    asked: tuple[tuple[Literal["bore", "rod"], float], ...] = (
        ("bore", design.cylinder.bore),
        ("rod", design.rod.outer_diameter),
    )
    for what, value in asked:
        near = standards.nearest_standard(what, value, "nearest")
        if abs(near - value) > 1e-9:
            odd.append(f"{what} {1e3 * value:.4g} mm (nearest {1e3 * near:g} mm)")
    if odd:
        reason = "free sizes: " + ", ".join(odd)
        return Check(_SIZES, "not_checked", reason, source="ISO 3320")
    return Check(_SIZES, "met", "bore and rod are standard sizes", source="ISO 3320")


def glands(rings: Iterable[Ring]) -> Check:
    """Whether every groove conforms to a standard; otherwise the differences."""
    odd = [text for ring in rings for text in _remarks(floats(ring, 0))]
    if odd:
        return Check(_GLANDS, "not_checked", "free glands: " + "; ".join(odd), source=_SECTIONS)
    return Check(_GLANDS, "met", "all glands are standard", source=_SECTIONS)


def _remarks(ring: Ring) -> Iterator[str]:
    """Deviations of a groove from its standard."""
    if ring.element.seal_type.o_ring_gland:
        yield from _o_ring(ring)
    elif any(housings(ring.element.type, place) for place in PLACES):
        yield from _housing(ring)
    else:
        yield f"{ring.label}: no standard housing for a {ring.element.type}"


def _o_ring(ring: Ring) -> Iterator[str]:
    loosest, tightest = squeezes(ring.at(stretch=0.0), growth=0.0, aside=0.0, ratio=1.0)
    area = float(np.squeeze(ring.groove.pieces[0].area))
    try:
        found = gland_deviations(
            standards.gland(ring["section"]),
            squeeze_min=float(loosest),
            squeeze_max=float(tightest),
            width=ring["groove_width"],
            fill=area / (ring["groove_width"] * ring["gland_depth"]),
            stretch=ring["stretch"],
            back_up_rings=ring.element.back_ups,
        )
    except InputError as error:
        yield f"{ring.label}: {error.diagnostics[0].message}"
        return
    for one in found:
        scale, unit = (1e3, "mm") if one.what == "groove width" else (100, "%")
        yield (
            f"{ring.label}: {one.what} {scale * one.value:.3g} {unit}, "
            f"{scale * one.lower:.3g} to {scale * one.upper:.3g} {unit}"
        )


def _housing(ring: Ring) -> Iterator[str]:
    try:
        known = housings_for(ring.element.type, ring.name, ring["diameter"])
    except InputError as error:
        yield f"{ring.label}: {error.diagnostics[0].message}"
        return
    depth, length = ring["gland_depth"], ring["groove_width"]
    if any(
        abs(one.radial_depth - depth) <= NEAR * depth
        and any(abs(x - length) <= NEAR * length for x in one.lengths)
        for one in known
    ):
        return
    listed = ", ".join(
        f"{1e3 * one.radial_depth:g} x {' or '.join(f'{1e3 * x:g}' for x in one.lengths)}"
        for one in known[:2]
    )
    yield (
        f"{ring.label}: groove {1e3 * depth:.3g} x {1e3 * length:.3g} mm, "
        f"{known[0].standard} has {listed} mm"
    )
