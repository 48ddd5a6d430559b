"""The sealing rings of an evaluation: their numbers, and the pressure and growth they see."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

from ..design.model import Design
from ..design.seals import SealElement
from ..models import gland, seals
from ..numeric import Array, absolute, maximum
from .allow import Stock
from .geometry import Geometry
from .grooves import Groove
from .state import State
from .values import Values

Place = Literal["piston", "rod"]


@dataclass(frozen=True, slots=True)
class Ring:
    """A sealing element with its numbers by name; arrays broadcast to (cases, designs).

    `numbers`: those of the design file, and `diameter`, `youngs_modulus` of what is squeezed,
    `pressure` (the difference it seals, gauge), `outer_pressure` (gauge), `squeeze_left` (nominal
    squeeze less what the bore's growth takes).
    """

    name: Place
    element: SealElement
    groove: Groove
    numbers: Mapping[str, Array]

    def __getitem__(self, name: str) -> Array:
        return self.numbers[name]

    @property
    def label(self) -> str:
        """How results call it."""
        return self.groove.place

    def at(self, **numbers: Array) -> Ring:
        """The same ring with other numbers."""
        return replace(self, numbers={**self.numbers, **numbers})


def places(g: Geometry) -> tuple[tuple[Place, tuple[Groove, ...], Array], ...]:
    """Grooves and counterface diameter of piston and rod."""
    return ("piston", g.piston_grooves, g.bore), ("rod", g.rod_grooves, g.rod_diameter)


def rubber_modulus(v: Values, element: SealElement, compound: str, temperature: Array) -> Array:
    """Young's modulus of a compound at a temperature: stated, else by its hardness."""
    law = seals.MODULUS_LAWS[element.hardness_model]
    return law.modulus(hardness=v[f"materials.{compound}.hardness"])


def rings(
    v: Values, design: Design, stock: Stock, geometry: Geometry, state: State, growth: Array
) -> tuple[Ring, ...]:
    """Every sealing element; the first of a place carries the pressure.

    The piston's sees the difference, the rod's p_B. `growth` is the bore's at the piston seal.
    """
    across: dict[str, tuple[Array, Array]] = {
        "piston": (
            absolute(state.moving_a - state.moving_b),
            state.moving_a + state.moving_b,
        ),
        "rod": (maximum(state.moving_b, 0.0), maximum(state.moving_b, 0.0)),
    }
    found = []
    for name, grooves, diameter in places(geometry):
        elements = getattr(design.seals, name).elements()
        pressure, total = across[name]
        for groove in grooves:
            if groove.role != "element":
                continue
            tail = groove.path.removeprefix(f"seals.{name}.")
            own = _numbers(v, elements[tail], groove, diameter, state.temperature)
            grown = growth if name == "piston" else 0.0
            held = pressure if tail == "" else 0.0 * pressure
            own["pressure"] = held
            own["outer_pressure"] = (total - pressure) / 2
            own["squeeze_left"] = gland.squeeze_after(
                squeeze=own["squeeze"], section=groove.section, growth=grown, tolerance=0.0
            )
            found.append(Ring(name, elements[tail], groove, own))
    return tuple(found)


_OWN = ("friction_coefficient", "breakaway_ratio", "stribeck_speed")
"""Numbers an element takes from its compound where it states none."""

_SHAPE = ("thickness", "width", "land", "relief", "root_clearance")


def _numbers(
    v: Values, element: SealElement, groove: Groove, diameter: Array, temperature: Array
) -> dict[str, Array]:
    at, compound = groove.path, f"materials.{element.compound}."
    soft = element.compound if element.energiser is None else element.energiser
    numbers = {
        "section": groove.section,
        "squeeze": v[f"{at}squeeze"],
        "tolerance": v[f"{at}tolerance"],
        "stretch": v[f"{at}stretch"],
        "groove_width": groove.width,
        "gland_depth": groove.gland_depth,
        "count": groove.count,
        "viscous_friction": v[f"{at}viscous_friction"],
        "diameter": diameter,
        "youngs_modulus": rubber_modulus(v, element, soft, temperature),
    }
    for field in _OWN:
        numbers[field] = v[at + field] if at + field in v else v[compound + field]
    for field in _SHAPE:
        if at + field in v:
            numbers[field] = v[at + field]
    return numbers
