"""A step ring: a plastic ring with a worn-in land, energised by an O-ring behind it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from ..base.numeric import Array
from ..base.quantities import INPUTS
from ..models import gland, seals, step_seal
from .contact import (
    LAND,
    RELIEF,
    TAPER,
    THICKNESS,
    WIDTH,
    SealContact,
    Shape,
    SizeField,
    landed,
    round_ring,
)
from .o_ring import law_inputs, law_warnings, round_piece
from .seal_type import (
    AXIAL_PLAY,
    Elements,
    Room,
    SealGroove,
    SealPart,
    SealSizes,
    SealType,
    SizeFault,
)

if TYPE_CHECKING:
    from ..finite_elements.section import SealSolution

TAPER_DEFAULT = math.radians(6.0)
"""Default angle of the taper beside the land [rad] (our choice)."""

LAND_SHARE = 0.5
"""Default ratio of land width to ring width (our choice)."""

ROOM = 0.1
"""The O-ring may be wider than the step ring by up to this share of the step ring's width."""

ENERGISER_ELEMENTS = 96
"""Number of elements around the O-ring. With 64, some load steps do not converge, and others give a
line load that is 8 % too small."""

EDGE = 0.15e-3
"""Radius of the edges of the land in finite elements [m]. Our choice, for the broken edges of a
turned PTFE ring."""

_text = INPUTS["length"].text


def contact(seal: SealSizes) -> SealContact:
    """Contact of the land, loaded by the O-ring and by the pressure behind the ring."""
    law, inputs = seals.LAWS[seal.law], law_inputs(seal)
    pressure, width, land = seal["pressure"], seal["width"], seal["land"]
    foot = law.contact_width(**inputs | {"pressure": 0.0 * pressure})
    load = step_seal.line_load(
        energiser_load=law.line_load(**inputs),
        pressure=pressure,
        wetted_back=step_seal.wetted_back(
            ring_width=width,
            foot_width=foot,
            section=seal["section"],
            squeeze=seal["squeeze_left"],
        ),
        wetted_front=seal["relief"],
    )
    face = step_seal.contact_width(
        line_load=load,
        land=land,
        taper=seal["taper"],
        ring_width=width,
        youngs_modulus=seal["face_modulus"],
        poissons_ratio=seal["face_poissons_ratio"],
    )
    return landed(load, face, pressure)


def groove(sizes: Mapping[str, Array]) -> SealGroove:
    """Groove for the ring and the O-ring behind it."""
    section, width, thickness = sizes["section"], sizes["width"], sizes["thickness"]
    energiser_depth = gland.gland_depth(squeeze=sizes["squeeze"], section=section)
    ring = round_piece(section, energiser_depth)
    pieces = (
        SealPart(thickness * width, thickness / 2),
        ring._replace(depth=thickness + ring.depth),
    )
    return SealGroove(energiser_depth + thickness, width, AXIAL_PLAY * width, pieces)


def outline(sizes: Mapping[str, float], room: Room) -> tuple[Shape, ...]:
    """Outline of the sliding ring, its land between two tapers, and of the O-ring behind it."""
    width, thick = sizes["width"], sizes["thickness"]
    land = min(sizes["land"], width)
    relief = min(sizes["relief"], width - land)
    left = room.middle - width / 2
    slope = min(math.tan(sizes["taper"]), 0.5 * thick / max(width - land, 1e-9))
    body = (
        (left, relief * slope),
        (left + relief, 0.0),
        (left + relief + land, 0.0),
        (left + width, (width - land - relief) * slope),
        (left + width, thick),
        (left, thick),
    )
    energiser = round_ring(room.middle, thick, room.depth, sizes["section"])
    return Shape("polymer", body), *energiser


def faults(sizes: Mapping[str, float]) -> Iterable[SizeFault]:
    """Faults if the O-ring, or land and relief together, are too wide for the step ring."""
    width, section = sizes.get("width"), sizes.get("section")
    if width is None or section is None:
        return
    if section > width * (1 + ROOM):
        yield SizeFault(
            "section",
            f"{_text(section)}: the O-ring is wider than the step ring ({_text(width)})",
            "widen the ring, or use a smaller O-ring",
        )
    land, relief = sizes.get("land"), sizes.get("relief")
    if land is None or relief is None:
        return
    if land <= width < (land + relief) * (1 - 1e-9):
        yield SizeFault(
            "relief",
            f"{_text(relief)}: relief and land together are wider than the ring ({_text(width)})",
            f"write at most {_text(width - land)}",
        )


def _solve(seal: SealSizes, width: float, pressures: Sequence[float]) -> SealSolution:
    from ..finite_elements.material import MooneyRivlin
    from ..finite_elements.mesh import SlideRing
    from ..finite_elements.step_ring import squeezed_step_ring

    return squeezed_step_ring(
        section=seal["section"],
        squeeze=seal["squeeze"],
        groove_width=width,
        rubber=MooneyRivlin.of_modulus(seal["youngs_modulus"]),
        pressures=pressures,
        sliding_radius=seal["diameter"] / 2,
        on_rod=seal.on_rod,
        plastic=MooneyRivlin.of_modulus(
            seal["face_modulus"], poissons_ratio=seal["face_poissons_ratio"]
        ),
        shape=SlideRing(
            width=seal["width"],
            thickness=seal["thickness"],
            land_width=seal["land"],
            chamfer_width=seal["relief"],
            chamfer_height=seal["relief"] * math.tan(seal["taper"]),
            relief_angle=seal["taper"],
            edge_radius=EDGE,
        ),
        elements_around=ENERGISER_ELEMENTS,
    )


TYPE = SealType(
    name="step_ring",
    title="step ring",
    help="a sliding ring of PTFE, energised by an O-ring behind it",
    fields=(
        SizeField(WIDTH, None),
        SizeField(LAND, lambda sizes: LAND_SHARE * sizes["width"]),
        SizeField(RELIEF, lambda sizes: (sizes["width"] - sizes["land"]) / 2),
        SizeField(TAPER, lambda sizes: TAPER_DEFAULT),
        SizeField(THICKNESS, None),
    ),
    faults=faults,
    groove=groove,
    contact=contact,
    outline=outline,
    round_ring=True,
    modulus_by="hardness",
    face=True,
    o_ring_gland=False,
    model=step_seal.line_load,
    contact_model="O-ring ({law} law) behind a worn-in land",
    warnings=law_warnings,
    elements=Elements(
        _solve,
        "The peak is at an end of the land and depends on the mesh and on the edge radius; line "
        "load and contact width hardly depend on them. The decrease of the peak above 5 MPa in "
        "Huang2017 is not reproduced.",
    ),
)
