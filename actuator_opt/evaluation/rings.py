"""One sealing ring in an evaluation: its numbers, and how it touches its counterface."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ..design.seals import SealElement
from ..models import gland, seals
from ..numeric import Array
from .allow import Stock
from .grooves import Groove
from .values import Values


@dataclass(frozen=True, slots=True)
class Ring:
    """A sealing element's numbers; arrays broadcast to (cases, designs)."""

    name: str
    """Whose it is: piston or rod."""
    element: SealElement
    groove: Groove
    diameter: Array
    squeeze: Array
    youngs_modulus: Array
    friction_coefficient: Array
    breakaway_ratio: Array
    stribeck_speed: Array
    viscous: Array


@dataclass(frozen=True, slots=True)
class Contact:
    """How a ring touches: normal force per length [N/m], width [m], peak pressure [Pa gauge]."""

    line_load: Array
    width: Array
    peak: Array


def youngs_modulus(
    v: Values, stock: Stock, element: SealElement, compound: str, temperature: Array
) -> Array:
    """Young's modulus of a compound at a temperature."""
    law = seals.MODULUS_LAWS[element.hardness_model]
    return law.modulus(hardness=v[f"materials.{compound}.hardness"])


def ring(
    v: Values,
    stock: Stock,
    name: str,
    element: SealElement,
    groove: Groove,
    diameter: Array,
    temperature: Array,
) -> Ring:
    """A sealing element with its numbers: its own, else its compound's."""

    def own(field: str) -> Array:
        at = groove.path + field
        return v[at] if at in v else v[f"materials.{element.compound}.{field}"]

    soft = element.energiser if element.energiser is not None else element.compound
    return Ring(
        name=name,
        element=element,
        groove=groove,
        diameter=diameter,
        squeeze=v[groove.path + "squeeze"],
        youngs_modulus=youngs_modulus(v, stock, element, soft, temperature),
        friction_coefficient=own("friction_coefficient"),
        breakaway_ratio=own("breakaway_ratio"),
        stribeck_speed=own("stribeck_speed"),
        viscous=v[groove.path + "viscous_friction"],
    )


def contact(ring: Ring, *, squeeze: Array, pressure: Array) -> Contact:
    """Contact of a ring at a squeeze and a pressure difference >= 0."""
    return _CONTACTS[ring.element.type](ring, squeeze, pressure)


def _o_ring(ring: Ring, squeeze: Array, pressure: Array) -> Contact:
    law = seals.LAWS[ring.element.law]
    inputs = {
        "squeeze": squeeze,
        "section": ring.groove.section,
        "youngs_modulus": ring.youngs_modulus,
        "pressure": pressure,
    }
    width = gland.limited_width(
        contact_width=law.contact_width(**inputs), groove_width=ring.groove.width
    )
    return Contact(law.line_load(**inputs), width, law.peak_pressure(**inputs))


_CONTACTS: dict[str, Callable[[Ring, Array, Array], Contact]] = {"o_ring": _o_ring}


def wiper_load(
    v: Values, stock: Stock, groove: Groove, diameter: Array, temperature: Array
) -> tuple[Array, Array]:
    """Line load of a wiper and its friction coefficient."""
    raise NotImplementedError
