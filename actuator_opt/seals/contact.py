"""Contact of a seal with its counterface: load, width, peak pressure and profile."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ..base.numeric import Array, maximum
from ..models import contact_land

WITHIN, TOUCHING = 1e-6, 1.0
"""Least excess of a static profile, as a share of the sealed pressure and in Pa: below it the
sealed pressure would open the contact."""


@dataclass(frozen=True, slots=True)
class SealContact:
    """Contact of a seal with its counterface.

    Parameters
    ----------
    line_load : normal force per length of circumference [N/m]
    width : contact width [m]
    peak : highest contact pressure above the outer pressure [Pa]
    profile : static contact pressure above the outer pressure [Pa] at t = x/b, 0 on the sealed side
    excess : excess of the profile over the oil pressure [Pa]; without an excess the sealed
        pressure opens the contact, and the profile shows bare touch
    profile_width : width of the profile [m]: the contact width, or less if the load is too small
    """

    line_load: Array
    width: Array
    peak: Array
    profile: Callable[[Array], Array]
    excess: Array
    profile_width: Array


def shaped(
    load: Array,
    width: Array,
    peak: Array,
    pressure: Array,
    *,
    excess_law: Callable[..., Array],
    profile_law: Callable[..., Array],
) -> SealContact:
    """A contact with a given profile shape, scaled to carry the load."""
    ends = {"sealed_pressure": pressure, "outer_pressure": 0.0}
    excess = excess_law(line_load=load, width=width, **ends)

    def profile(position: Array) -> Array:
        held = maximum(excess, WITHIN * pressure + TOUCHING)
        return profile_law(position=position, excess=held, **ends)

    return SealContact(load, width, peak, profile, excess, width)


def landed(load: Array, width: Array, pressure: Array) -> SealContact:
    """A worn-in land under a line load."""
    peak = contact_land.land_peak(
        line_load=load, width=width, sealed_pressure=pressure, outer_pressure=0.0
    )
    return shaped(
        load,
        width,
        peak,
        pressure,
        excess_law=contact_land.land_excess,
        profile_law=contact_land.land_profile,
    )
