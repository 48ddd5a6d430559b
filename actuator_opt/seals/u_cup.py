"""A U-cup: two lips on a heel; the pressure spreads the lips."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ..base.numeric import Array
from ..base.quantities import INPUTS
from ..models import contact_profile, gland, lip_seal
from .contact import (
    GROOVE_WIDTH,
    LAND,
    ROOT_CLEARANCE,
    THICKNESS,
    WIDTH,
    SealContact,
    Shape,
    SizeField,
    shaped,
)
from .seal_type import (
    AXIAL_PLAY,
    Room,
    SealGroove,
    SealPart,
    SealSizes,
    SealType,
    SizeFault,
    no_warnings,
)

LAND_SHARE = 0.1
"""Default ratio of land width to lip length (our choice)."""

_text = INPUTS["length"].text


def contact(seal: SealSizes) -> SealContact:
    """Contact of a lip, at its rim, with the counterface."""
    pressure, thickness = seal["pressure"], seal["thickness"]
    side = 1.0 if seal.on_rod else -1.0
    lip = {
        "interference": lip_seal.lip_interference(
            section=seal["section"], gland_depth=seal["section"] * (1 - seal["squeeze_left"])
        ),
        "pressure": pressure,
        "youngs_modulus": seal["youngs_modulus"],
        "poissons_ratio": seal["face_poissons_ratio"],
        "lip_thickness": thickness,
        "lip_length": seal["width"],
        "lip_radius": (seal["diameter"] + side * thickness) / 2,
    }
    load = lip_seal.line_load(**lip, root_clearance=seal["root_clearance"])
    peak = lip_seal.peak_pressure(**lip, edge_radius=seal["land"] / 2)
    width = lip_seal.contact_width(
        line_load=load, peak_pressure=peak, pressure=pressure, lip_length=seal["width"]
    )
    return shaped(
        load,
        width,
        peak,
        pressure,
        excess_law=contact_profile.lip_excess,
        profile_law=contact_profile.lip_profile,
    )


def groove(sizes: Mapping[str, Array]) -> SealGroove:
    """Groove of a U-cup, whose body is as long as the groove minus the clearance."""
    section, width = sizes["section"], sizes["width"]
    depth = gland.gland_depth(squeeze=sizes["squeeze"], section=section)
    lips = (2 * sizes["thickness"] - section) * width
    piece = SealPart(section * sizes["groove_width"] + lips, depth / 2)
    return SealGroove(depth, width, AXIAL_PLAY * width, (piece,))


def outline(sizes: Mapping[str, float], room: Room) -> tuple[Shape, ...]:
    """Outline of two lips, open to the sealed side, on a heel that leaves an axial clearance."""
    start, end, depth = room
    length, thick = sizes["width"], min(sizes["thickness"], 0.42 * depth)
    interference = max(
        float(lip_seal.lip_interference(section=sizes["section"], gland_depth=depth)), 0.0
    )
    root_gap = max(sizes["root_clearance"], 0.0)
    heel = max((end - start - length) * 0.8, 0.15 * length)
    right = min(start + (end - start + length + heel) / 2, end)
    root = right - heel
    tip, land = root - length, sizes["land"]
    thin = 0.7 * thick
    body = (
        (right, root_gap),
        (root, root_gap),
        (tip + land, 0.0),
        (tip, 0.0),
        (tip, thin),
        (root - 0.3 * thick, root_gap + thick),
        (root - 0.3 * thick, depth - thick),
        (tip, depth - thin),
        (tip, depth),
        (right, depth),
    )
    free = (
        (root, root_gap),
        (tip + land, -interference),
        (tip, -interference),
        (tip, thin - interference),
    )
    return Shape("elastomer", body), Shape("free", (*free, (root - 0.3 * thick, root_gap + thick)))


def lip_faults(width: float, thickness: float) -> Iterable[SizeFault]:
    """A fault if the lip is shorter than it is thick, as the beam model then does not apply."""
    if width < thickness:
        yield SizeFault(
            "width",
            f"{_text(width)}: the lip is shorter than its thickness ({_text(thickness)})",
            f"write {_text(thickness)} or more",
        )


def faults(sizes: Mapping[str, float]) -> Iterable[SizeFault]:
    """Faults if the lips are shorter than thick, or if there is no space between them."""
    width, thickness, section = (sizes.get(key) for key in ("width", "thickness", "section"))
    if width is None or thickness is None or section is None:
        return
    yield from lip_faults(width, thickness)
    if 2 * thickness >= section:
        yield SizeFault(
            "thickness",
            f"{_text(thickness)}: two lips of this thickness fill the section ({_text(section)})",
            f"write less than {_text(section / 2)}",
        )


def _interference(sizes: Mapping[str, Array]) -> Array:
    return lip_seal.lip_interference(section=sizes["section"], gland_depth=sizes["gland_depth"])


TYPE = SealType(
    name="u_cup",
    title="U-cup",
    help="two lips, spread by the pressure",
    fields=(
        SizeField(WIDTH, None),
        SizeField(LAND, lambda sizes: LAND_SHARE * sizes["width"]),
        SizeField(ROOT_CLEARANCE, _interference),
        SizeField(THICKNESS, None),
        SizeField(GROOVE_WIDTH, None),
    ),
    faults=faults,
    groove=groove,
    contact=contact,
    outline=outline,
    round_ring=False,
    modulus_by="stated",
    face=True,
    o_ring_gland=False,
    model=lip_seal.line_load,
    contact_model="lip modelled as a short clamped tube",
    warnings=no_warnings,
    elements=None,
)
