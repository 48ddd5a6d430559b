"""How a sealing ring touches its counterface: one function for every type of seal."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..models import (
    compact_seal,
    contact_land,
    contact_profile,
    gland,
    lip_seal,
    seals,
    step_seal,
)
from ..numeric import Array, maximum, minimum, real, where
from .rings import Ring

WITHIN, TOUCHING = 1e-6, 1.0
"""Least excess of a static profile, as a part of the sealed pressure and in Pa: with less the
sealed pressure would open the contact."""


@dataclass(frozen=True, slots=True)
class Touch:
    """How a ring touches: normal force per length [N/m], width [m], peak pressure [Pa over outer].

    `profile` gives the static contact pressure over the outer one [Pa] at t = x/b, 0 on the
    sealed side.
    """

    line_load: Array
    width: Array
    peak: Array
    profile: Callable[[Array], Array]
    excess: Array
    """Of the profile over the oil pressure [Pa]; where it is not above zero the sealed pressure
    opens the contact, and the profile shows a bare touch."""
    profile_width: Array
    """Width the profile stands on [m]: the contact's, or less where the load is too small."""


def touch(ring: Ring) -> Touch:
    """How a ring touches at its `squeeze_left` and `pressure`."""
    if ring.element.contact:
        return _table(ring)
    return _TOUCH[ring.element.type](ring)


def static_profile(ring: Ring, nodes: int) -> tuple[Array, Array]:
    """Width [m] and static contact pressure [Pa gauge] at uniform nodes, for a ring of floats."""
    position = np.linspace(0.0, 1.0, nodes)
    pressure, outer = ring["pressure"], ring["outer_pressure"]
    if real(pressure) >= 0:
        found = touch(ring)
        return found.profile_width, outer + found.profile(position)
    found = touch(ring.at(pressure=-pressure))  # sealed from the other side
    return found.profile_width, outer + pressure + found.profile(1 - position)


def _squeezed(ring: Ring) -> dict[str, Array]:
    """What the O-ring laws ask of a round ring."""
    return {
        "squeeze": ring["squeeze_left"],
        "section": ring["section"],
        "youngs_modulus": ring["youngs_modulus"],
        "pressure": ring["pressure"],
    }


def _shaped(
    load: Array,
    width: Array,
    peak: Array,
    pressure: Array,
    *,
    excess_law: Callable[..., Array],
    profile_law: Callable[..., Array],
) -> Touch:
    """A touch whose profile is a shape with the excess that carries the load."""
    ends = {"sealed_pressure": pressure, "outer_pressure": 0.0}
    excess = excess_law(line_load=load, width=width, **ends)

    def profile(position: Array) -> Array:
        held = maximum(excess, WITHIN * pressure + TOUCHING)
        return profile_law(position=position, excess=held, **ends)

    return Touch(load, width, peak, profile, excess, width)


def _o_ring(ring: Ring) -> Touch:
    law, inputs, pressure = seals.LAWS[ring.element.law], _squeezed(ring), ring["pressure"]
    width = gland.limited_width(
        contact_width=law.contact_width(**inputs), groove_width=ring["groove_width"]
    )
    load, peak = law.line_load(**inputs), law.peak_pressure(**inputs)
    at_rest = contact_profile.o_ring_mean(
        excess=peak - pressure, sealed_pressure=pressure, outer_pressure=0.0
    )
    touching = real(at_rest) > 0
    narrow = minimum(width, load / where(touching, at_rest, 1.0))  # a soft ring's law is too wide
    shaped = _shaped(
        load,
        narrow,
        peak,
        pressure,
        excess_law=contact_profile.o_ring_excess,
        profile_law=contact_profile.o_ring_profile,
    )
    return replace(shaped, width=width)


def _step_ring(ring: Ring) -> Touch:
    law, inputs = seals.LAWS[ring.element.law], _squeezed(ring)
    pressure, width, land = ring["pressure"], ring["width"], ring["land"]
    foot = law.contact_width(**inputs | {"pressure": 0.0 * pressure})
    load = step_seal.line_load(
        energiser_load=law.line_load(**inputs),
        pressure=pressure,
        wetted_back=step_seal.wetted_back(
            ring_width=width,
            foot_width=foot,
            section=ring["section"],
            squeeze=ring["squeeze_left"],
        ),
        wetted_front=ring["relief"],
    )
    face = step_seal.contact_width(
        line_load=load,
        land=land,
        taper=ring["taper"],
        ring_width=width,
        youngs_modulus=ring["face_modulus"],
        poissons_ratio=ring["face_poissons_ratio"],
    )
    return _landed(load, face, pressure)


def _landed(load: Array, width: Array, pressure: Array) -> Touch:
    """A worn-in land under a line load."""
    peak = contact_land.land_peak(
        line_load=load, width=width, sealed_pressure=pressure, outer_pressure=0.0
    )
    return _shaped(
        load,
        width,
        peak,
        pressure,
        excess_law=contact_land.land_excess,
        profile_law=contact_land.land_profile,
    )


def _u_cup(ring: Ring) -> Touch:
    pressure, thickness = ring["pressure"], ring["thickness"]
    side = 1.0 if ring.name == "rod" else -1.0
    lip = {
        "interference": lip_seal.lip_interference(
            section=ring["section"], gland_depth=ring["section"] * (1 - ring["squeeze_left"])
        ),
        "pressure": pressure,
        "youngs_modulus": ring["youngs_modulus"],
        "poissons_ratio": ring["face_poissons_ratio"],
        "lip_thickness": thickness,
        "lip_length": ring["width"],
        "lip_radius": (ring["diameter"] + side * thickness) / 2,
    }
    load = lip_seal.line_load(**lip, root_clearance=ring["root_clearance"])
    peak = lip_seal.peak_pressure(**lip, edge_radius=ring["land"] / 2)
    width = lip_seal.contact_width(
        line_load=load, peak_pressure=peak, pressure=pressure, lip_length=ring["width"]
    )
    return _shaped(
        load,
        width,
        peak,
        pressure,
        excess_law=contact_profile.lip_excess,
        profile_law=contact_profile.lip_profile,
    )


def _compact(ring: Ring) -> Touch:
    load = compact_seal.line_load(
        squeeze=ring["squeeze_left"],
        face_width=ring["land"],
        youngs_modulus=ring["youngs_modulus"],
        poissons_ratio=ring["face_poissons_ratio"],
        pressure=ring["pressure"],
    )
    width = compact_seal.contact_width(
        squeeze=ring["squeeze_left"], face_width=ring["land"], groove_width=ring["groove_width"]
    )
    return _landed(load, width, ring["pressure"])


def _table(ring: Ring) -> Touch:
    """Stated profiles, interpolated between the two pressures around, at equal t."""
    pressure = ring["pressure"]
    tables = ring.element.contact
    known = [one.pressure for one in tables]
    shares = [_share(pressure, known, i) for i in range(len(tables))]
    widths = [one.positions[-1] for one in tables]
    width = sum(share * one for share, one in zip(shares, widths, strict=True))
    places = [tuple(x / one.positions[-1] for x in one.positions) for one in tables]

    def profile(position: Array) -> Array:
        parts = [
            share
            * contact_profile.table_profile(
                position=position, positions=place, pressures=one.stresses
            )
            for share, place, one in zip(shares, places, tables, strict=True)
        ]
        return sum(parts)

    means = [
        contact_profile.table_mean(positions=place, pressures=one.stresses)
        for place, one in zip(places, tables, strict=True)
    ]
    load = width * sum(share * mean for share, mean in zip(shares, means, strict=True))
    knots = np.array(sorted({place for row in places for place in row}))
    told = [
        np.interp(knots, place, one.stresses) for place, one in zip(places, tables, strict=True)
    ]
    mixed = sum(np.asarray(share)[..., None] * row for share, row in zip(shares, told, strict=True))
    highest = np.argmax(real(mixed), axis=-1)[..., None]  # straight lines peak at a knot
    peak = np.take_along_axis(mixed, highest, axis=-1)[..., 0]
    return Touch(load, width, peak, profile, peak - pressure, width)


def _share(pressure: Array, known: list[float], index: int) -> Array:
    """Weight of one table at a pressure: 1 at its own, falling to 0 at its neighbours'."""
    own = known[index]
    rising: Array = 1.0
    falling: Array = 1.0
    if index > 0:
        rising = (pressure - known[index - 1]) / (own - known[index - 1])
    if index < len(known) - 1:
        falling = (known[index + 1] - pressure) / (known[index + 1] - own)
    within = where(real(pressure) <= own, rising, falling)
    return minimum(maximum(within, 0.0), 1.0)


_TOUCH: dict[str, Callable[[Ring], Touch]] = {
    "o_ring": _o_ring,
    "step_ring": _step_ring,
    "u_cup": _u_cup,
    "compact": _compact,
}
