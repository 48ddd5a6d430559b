"""Static contact profiles of a ring by finite elements, as a design file states them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from math import tan
from typing import TYPE_CHECKING

import numpy as np

from ..design.seals import ContactProfile
from ..errors import ActuatorError, Diagnostic, Unsolvable
from .rings import Ring
from .touch import Touch, touch

if TYPE_CHECKING:
    from ..finite_elements.result import Contact

SHARES = (0.25, 0.5, 0.75, 1.0)
"""Sealed pressures over that of the supply at which the profiles are computed, beside zero."""

POINTS = 81
"""Points of a profile: those of the elements, thinned evenly."""

ENERGISER = 96
"""Elements around the ring behind a step ring: with 64 some load steps leave a dent in its contact,
8 % of the line load, or find no balance."""

EDGE = 0.15e-3
"""Radius of the edges of a step ring's land, m (choice: broken edges of a turned PTFE ring)."""


def room(ring: Ring) -> float:
    """Length of the groove that its back-up rings leave, along the cylinder [m]."""
    backs = ring.element.back_ups * (ring.element.back_up_thickness or 0.0)
    return float(ring["groove_width"]) - backs


def closed_form(ring: Ring) -> Touch:
    """How the ring touches by the closed form, at its pressure and the squeeze it is mounted with.

    The elements know neither the bore's growth nor stated profiles.
    """
    bare = replace(ring, element=ring.element.model_copy(update={"contact": ()}))
    return touch(bare.at(squeeze_left=ring["squeeze"], pressure=abs(ring["pressure"])))


def contacts(ring: Ring, supply: float) -> tuple[Contact, ...]:
    """Finite elements of a ring of floats, mounted and at shares of the supply pressure.

    Back-up rings are as rigid as the groove.

    Parameters
    ----------
    ring : an O-ring, or a step ring with its energiser
    supply : highest sealed pressure [Pa]

    Raises
    ------
    ActuatorError
        the extra is missing, the type has no elements, or they find no balance
    """
    from ..finite_elements.material import MooneyRivlin

    rubber = MooneyRivlin.of_modulus(ring["youngs_modulus"])
    shared = {
        "section": ring["section"],
        "squeeze": ring["squeeze"],
        "groove_width": room(ring),
        "rubber": rubber,
        "pressures": [share * supply for share in SHARES],
        "sliding_radius": ring["diameter"] / 2,
        "on_rod": ring.name == "rod",
    }
    if ring.element.type == "o_ring":
        from ..finite_elements.o_ring import squeezed_ring

        found = squeezed_ring(**shared)
    elif ring.element.type == "step_ring":
        from ..finite_elements.mesh import SlideRing
        from ..finite_elements.step_ring import squeezed_step_ring

        plastic = MooneyRivlin.of_modulus(
            ring["face_modulus"], poissons_ratio=ring["face_poissons_ratio"]
        )
        shape = SlideRing(
            width=ring["width"],
            thickness=ring["thickness"],
            land_width=ring["land"],
            chamfer_width=ring["relief"],
            chamfer_height=ring["relief"] * tan(ring["taper"]),
            relief_angle=ring["taper"],
            edge_radius=EDGE,
        )
        found = squeezed_step_ring(
            **shared, plastic=plastic, shape=shape, elements_around=ENERGISER
        )
    else:
        raise ActuatorError(
            Diagnostic(
                f"{ring.label}: there are no finite elements of a {ring.element.type}",
                "use them for an o_ring or a step_ring, or state profiles of your own",
            )
        )
    if found.failure:
        raise Unsolvable(
            Diagnostic(
                f"{ring.label}: finite elements: {found.failure}",
                "lower the squeeze or the pressure, or widen the groove",
            )
        )
    return found.contacts


def profiles(found: Iterable[Contact]) -> tuple[ContactProfile, ...]:
    """The contacts as a design file states them."""
    return tuple(_profile(one.pressure, one.positions, one.contact_pressure) for one in found)


def _profile(pressure: float, positions: np.ndarray, stresses: np.ndarray) -> ContactProfile:
    """One profile, thinned, to 10 nm and 10 Pa; it ends at the outer pressure, zero."""
    places = positions - positions[0]
    keep = np.unique(np.linspace(0, len(places) - 1, min(POINTS, len(places))).round().astype(int))
    held = np.maximum(stresses, 0.0)
    return ContactProfile(
        pressure=float(pressure),
        positions=tuple(float(x) for x in places[keep].round(8)),
        stresses=tuple(float(x) for x in held[keep].round(-1)),
    )
