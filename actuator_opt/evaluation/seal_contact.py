"""Contact of a sealing ring with its counterface, by seal type or as stated in the design."""

from __future__ import annotations

import numpy as np

from ..base.numeric import Array, real
from ..seals import stated_profile
from ..seals.contact import SealContact
from .rings import Ring


def seal_contact(ring: Ring) -> SealContact:
    """Contact of a ring at its `squeeze_left` and `pressure`."""
    if ring.element.contact:
        return stated_profile.contact(ring.element.contact, ring["pressure"])
    return ring.element.seal_type.contact(ring.sizes)


def static_profile(ring: Ring, nodes: int) -> tuple[Array, Array]:
    """Width [m] and static contact pressure [Pa gauge] at uniform nodes, for a ring of floats."""
    position = np.linspace(0.0, 1.0, nodes)
    pressure, outer = ring["pressure"], ring["outer_pressure"]
    if real(pressure) >= 0:
        found = seal_contact(ring)
        return found.profile_width, outer + found.profile(position)
    found = seal_contact(ring.at(pressure=-pressure))  # sealed from the other side
    return found.profile_width, outer + pressure + found.profile(1 - position)
