"""How a sealing ring touches its counterface: one function for every type of seal."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ..models import gland, seals
from ..numeric import Array
from .rings import Ring


@dataclass(frozen=True, slots=True)
class Touch:
    """Normal force per length of circumference [N/m], width [m], peak pressure [Pa gauge]."""

    line_load: Array
    width: Array
    peak: Array


def touch(ring: Ring) -> Touch:
    """How a ring touches at its `squeeze_left` and `pressure`."""
    return _TOUCH[ring.element.type](ring)


def _o_ring(ring: Ring) -> Touch:
    law = seals.LAWS[ring.element.law]
    inputs = {
        "squeeze": ring["squeeze_left"],
        "section": ring["section"],
        "youngs_modulus": ring["youngs_modulus"],
        "pressure": ring["pressure"],
    }
    width = gland.limited_width(
        contact_width=law.contact_width(**inputs), groove_width=ring["groove_width"]
    )
    return Touch(law.line_load(**inputs), width, law.peak_pressure(**inputs))


_TOUCH: dict[str, Callable[[Ring], Touch]] = {"o_ring": _o_ring}
