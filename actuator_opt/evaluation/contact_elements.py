"""Static contact profiles of a ring by finite elements, in the form of a design file."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..base.errors import ActuatorError, Diagnostic, Unsolvable
from ..base.suggest import article
from ..design.seals import ContactProfile
from ..seals.contact import SealContact
from ..seals.kinds import TYPES
from .rings import Ring
from .seal_contact import seal_contact

if TYPE_CHECKING:
    from ..finite_elements.result import Contact

SHARES = (0.25, 0.5, 0.75, 1.0)
"""Sealed pressures over supply pressure of the profiles, in addition to zero."""

POINTS = 81
"""Points of a profile, an even selection from the finite-element nodes."""


def room(ring: Ring) -> float:
    """Axial groove length between the back-up rings [m]."""
    backs = ring.element.back_ups * (ring.element.back_up_thickness or 0.0)
    return float(ring["groove_width"]) - backs


def closed_form(ring: Ring) -> SealContact:
    """Contact of the ring by the closed form, at its pressure and mounted squeeze.

    The finite elements include neither bore growth nor stated profiles.
    """
    bare = replace(ring, element=ring.element.model_copy(update={"contact": ()}))
    return seal_contact(bare.at(squeeze_left=ring["squeeze"], pressure=abs(ring["pressure"])))


def contacts(ring: Ring, supply: float) -> tuple[Contact, ...]:
    """Finite elements of a ring of floats, mounted and at fractions of the supply pressure.

    Back-up rings are as rigid as the groove.

    Parameters
    ----------
    ring : ring of a type with finite elements
    supply : highest sealed pressure [Pa]

    Raises
    ------
    ActuatorError
        missing extra, type without finite elements, or no convergence
    """
    elements = ring.element.seal_type.elements
    if elements is None:
        known = " or ".join(article(one.name) for one in TYPES.values() if one.elements)
        raise ActuatorError(
            Diagnostic(
                f"{ring.label}: no finite elements for a {ring.element.type}",
                f"use them for {known}, or state your own profiles",
            )
        )
    found = elements.solve(ring.sizes, room(ring), [share * supply for share in SHARES])
    if found.failure:
        raise Unsolvable(
            Diagnostic(
                f"{ring.label}: finite elements: {found.failure}",
                "lower the squeeze or the pressure, or widen the groove",
            )
        )
    return found.contacts


def profiles(found: Iterable[Contact]) -> tuple[ContactProfile, ...]:
    """The contacts in the form of a design file."""
    return tuple(_profile(one.pressure, one.positions, one.contact_pressure) for one in found)


def _profile(pressure: float, positions: np.ndarray, stresses: np.ndarray) -> ContactProfile:
    """A profile with fewer points, rounded to 10 nm and 10 Pa; it ends at the outer pressure."""
    places = positions - positions[0]
    keep = np.unique(np.linspace(0, len(places) - 1, min(POINTS, len(places))).round().astype(int))
    held = np.maximum(stresses, 0.0)
    return ContactProfile(
        pressure=float(pressure),
        positions=tuple(float(x) for x in places[keep].round(8)),
        stresses=tuple(float(x) for x in held[keep].round(-1)),
    )
