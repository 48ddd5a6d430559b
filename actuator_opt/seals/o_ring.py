"""An O-ring: a round rubber ring alone in its groove."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..base.numeric import Array, minimum, real, where
from ..models import contact_profile, elastomer, gland, seals
from .contact import SealContact, Shape, round_ring, shaped
from .seal_type import Elements, Room, SealGroove, SealPart, SealSizes, SealType, no_faults

if TYPE_CHECKING:
    from ..finite_elements.section import SealSolution

ON_LIMIT = 1e-6
"""Tolerance on the squeeze range of a contact law, so that an optimum at the end of the range
causes no warning."""


def law_inputs(seal: SealSizes) -> dict[str, Array]:
    """Inputs of a law of `models.seals.LAWS` for a round ring."""
    return {
        "squeeze": seal["squeeze_left"],
        "section": seal["section"],
        "youngs_modulus": seal["youngs_modulus"],
        "pressure": seal["pressure"],
    }


def contact(seal: SealSizes) -> SealContact:
    """Contact of the ring by its contact law, with a contact width of at most the groove width."""
    law, inputs, pressure = seals.LAWS[seal.law], law_inputs(seal), seal["pressure"]
    width = gland.limited_width(
        contact_width=law.contact_width(**inputs), groove_width=seal["groove_width"]
    )
    load, peak = law.line_load(**inputs), law.peak_pressure(**inputs)
    at_rest = contact_profile.o_ring_mean(
        excess=peak - pressure, sealed_pressure=pressure, outer_pressure=0.0
    )
    touching = real(at_rest) > 0
    narrow = minimum(width, load / where(touching, at_rest, 1.0))  # soft rings: too wide
    ring_contact = shaped(
        load,
        narrow,
        peak,
        pressure,
        excess_law=contact_profile.o_ring_excess,
        profile_law=contact_profile.o_ring_profile,
    )
    return replace(ring_contact, width=width)


def round_piece(section: Array, depth: Array) -> SealPart:
    """A round ring in its groove: section area, and depth of its centre."""
    return SealPart((0.25 * math.pi) * section * section, depth / 2)


def groove(sizes: Mapping[str, Array]) -> SealGroove:
    """The standard O-ring gland for the section diameter of the ring."""
    section = sizes["section"]
    depth = gland.gland_depth(squeeze=sizes["squeeze"], section=section)
    width = gland.groove_width(section=section)
    return SealGroove(depth, section, width, (round_piece(section, depth),))


def outline(sizes: Mapping[str, float], room: Room) -> tuple[Shape, ...]:
    """Outline of a round ring, squeezed between the counterface and the bottom of the groove."""
    return round_ring(room.middle, 0.0, room.depth, sizes["section"])


def law_warnings(seal: SealSizes) -> Iterable[str]:
    """Warn of a contact law used outside the hardness, squeeze or pressure of its test data."""
    law = seals.LAWS[seal.law]
    modulus_law = elastomer.MODULUS_LAWS[seal.hardness_model]
    hardness = float(np.max(seal["hardness"]))
    if not modulus_law.hardness_range[0] <= hardness <= modulus_law.hardness_range[1]:
        yield (
            f"{hardness:g} Shore A, but the {modulus_law.name} law for the modulus is valid from "
            f"{modulus_law.hardness_range[0]:g} to {modulus_law.hardness_range[1]:g} Shore A"
        )
    ratio = float(np.max(np.abs(seal["pressure"] / seal["youngs_modulus"])))
    low, high = law.squeeze_range
    remaining, nominal = (
        float(np.min(np.real(seal[name]))) for name in ("squeeze_left", "squeeze")
    )
    if not (low - ON_LIMIT <= remaining and nominal <= high + ON_LIMIT):
        squeeze = nominal if nominal > high else remaining
        yield (
            f"squeeze {100 * squeeze:.3g} %, but the {law.name} contact law was only compared with "
            f"data from {100 * low:.0f} to {100 * high:.0f} % squeeze"
        )
    if ratio > law.pressure_range[1]:
        yield (
            f"pressure is {ratio:.1f} times Young's modulus, but the {law.name} contact law was "
            f"only compared with data up to {law.pressure_range[1]:g} times this modulus"
        )


def _solve(seal: SealSizes, width: float, pressures: Sequence[float]) -> SealSolution:
    from ..finite_elements.material import MooneyRivlin
    from ..finite_elements.o_ring import squeezed_ring

    return squeezed_ring(
        section=seal["section"],
        squeeze=seal["squeeze"],
        groove_width=width,
        rubber=MooneyRivlin.of_modulus(seal["youngs_modulus"]),
        pressures=pressures,
        sliding_radius=seal["diameter"] / 2,
        on_rod=seal.on_rod,
    )


TYPE = SealType(
    name="o_ring",
    title="O-ring",
    help="a rubber ring with round section",
    fields=(),
    faults=no_faults,
    groove=groove,
    contact=contact,
    outline=outline,
    round_ring=True,
    modulus_by="stated",
    face=False,
    o_ring_gland=True,
    model=None,
    contact_model="{law} O-ring",
    warnings=law_warnings,
    elements=Elements(
        _solve,
        "How steeply the pressure falls at the edge towards the outer side depends on the mesh.",
    ),
)
