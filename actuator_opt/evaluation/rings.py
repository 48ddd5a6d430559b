"""The sealing rings of an evaluation: their numbers, and the pressure and growth they see."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

from ..design.model import Design
from ..design.seals import SealElement
from ..models import elastomer, gland, lip_seal
from ..numeric import Array, absolute, maximum, where
from . import oil
from .allow import Stock
from .barrel import SEAL_STEP
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
    squeeze less what the bore's growth takes). With an oil film: `speed`, `viscosity`,
    `return_pressure` (p_B while the rod runs the other way) and the face's roughness.
    """

    name: Place
    element: SealElement
    groove: Groove
    numbers: Mapping[str, Array]
    viscosity_law: str = "none"
    """How the oil under it thickens with pressure."""

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


HARDNESS_TEMPERATURE = 296.15
"""Temperature at which hardness and modulus of a compound are measured, K (ISO 23529)."""


def hardness_modulus(v: Values, compound: str, law: str) -> Array:
    """Young's modulus of a compound by its hardness, where it was measured."""
    at = f"materials.{compound}."
    modulus = elastomer.MODULUS_LAWS[law].modulus(hardness=v[f"{at}hardness"])
    own = f"{at}hardness_modulus_factor"
    return modulus * v[own] if own in v else modulus


def face_modulus(v: Values, compound: str, law: str, temperature: Array) -> Array:
    """Young's modulus of a compound's sliding face at a temperature: stated, else by hardness."""
    at = f"materials.{compound}."
    stated = f"{at}youngs_modulus"
    modulus = v[stated] if stated in v else hardness_modulus(v, compound, law)
    if f"{at}softening" not in v:
        return modulus
    return modulus * elastomer.temperature_factor(
        temperature=temperature,
        reference_temperature=HARDNESS_TEMPERATURE,
        softening=v[f"{at}softening"],
        stiffening_temperature=v[f"{at}stiffening_temperature"],
    )


def rings(
    v: Values, design: Design, stock: Stock, geometry: Geometry, state: State, growth: Array
) -> tuple[Ring, ...]:
    """Every sealing element; the first of a place carries the pressure.

    The piston's sees the difference, the rod's p_B. `growth` is the bore's far from it.
    """
    across: dict[str, tuple[Array, Array]] = {
        "piston": (
            absolute(state.moving_a - state.moving_b),
            state.moving_a + state.moving_b,
        ),
        "rod": (maximum(state.moving_b, 0.0), maximum(state.moving_b, 0.0)),
    }
    law, coefficient = oil.pressure_law(design.fluid, stock, state.temperature)
    drain = v["supply.return_pressure"]
    oiled = {
        "speed": state.speed,
        "viscosity": state.dynamic_viscosity,
        "viscosity_coefficient": coefficient,
    }
    found = []
    for name, grooves, diameter in places(geometry):
        elements = getattr(design.seals, name).elements()
        pressure, total = across[name]
        for groove in grooves:
            tail = groove.path.removeprefix(f"seals.{name}.")
            if groove.role != "element" or elements[tail].count == 0:
                continue
            own = _numbers(v, elements[tail], groove, diameter, state.temperature)
            grown = SEAL_STEP * growth if name == "piston" else 0.0
            held = pressure if tail == "" else 0.0 * pressure
            own["pressure"] = held
            own["outer_pressure"] = (total - pressure) / 2
            if elements[tail].friction == "film":
                own |= oiled
                own["return_pressure"] = where(state.push, state.driven_pressure, drain)
            own["squeeze_left"] = gland.squeeze_after(
                squeeze=own["squeeze"], section=groove.section, growth=grown, tolerance=0.0
            )
            roughness = {"counterface_roughness": v[f"seals.{name}.counterface_roughness"]}
            found.append(Ring(name, elements[tail], groove, own | roughness, law))
    return tuple(found)


_OWN = ("friction_coefficient", "breakaway_ratio", "stribeck_speed")
"""Numbers an element takes from its compound where it states none."""

_FACE = ("seal_roughness", "asperity_radius", "asperity_density", "asperity_friction")
"""Numbers of a compound's face that the oil film asks for."""


def _numbers(
    v: Values, element: SealElement, groove: Groove, diameter: Array, temperature: Array
) -> dict[str, Array]:
    """What the contact of an element is computed from."""
    at, compound = groove.path, f"materials.{element.compound}."
    face = face_modulus(v, element.compound, element.hardness_model, temperature)
    squeezed = face
    if element.type == "step_ring":  # the energiser; the temperature law is of the sliding ring
        squeezed = hardness_modulus(v, element.compound, element.hardness_model)
    numbers = {
        "section": groove.section,
        "squeeze": v[f"{at}squeeze"],
        "tolerance": v[f"{at}tolerance"],
        "section_tolerance": v[f"{at}section_tolerance"],
        "stretch": v[f"{at}stretch"],
        "groove_width": groove.width,
        "gland_depth": groove.gland_depth,
        "count": groove.count,
        "viscous_friction": v[f"{at}viscous_friction"],
        "diameter": diameter,
        "youngs_modulus": squeezed,
    }
    for field in _OWN:
        numbers[field] = v[at + field] if at + field in v else v[compound + field]
    numbers |= _shape(v, element, groove)
    by_hardness = element.type in ("o_ring", "step_ring")
    if by_hardness or f"{compound}youngs_modulus" not in v:
        numbers["hardness"] = v[f"{compound}hardness"]
    if element.type != "o_ring" or element.friction == "film":
        numbers["face_modulus"] = face
        numbers["face_poissons_ratio"] = v.get(f"{compound}poissons_ratio", INCOMPRESSIBLE)
    if element.friction == "film":
        numbers |= {field: v[compound + field] for field in _FACE}
    return numbers


TAPER = math.radians(6.0)
"""Taper beside a step ring's land where none is stated: a choice."""

LANDS = {"step_ring": 0.5, "compact": 1.0, "u_cup": 0.1}
"""Land over width where none is stated: choices."""

FACE = ("land", "relief", "taper", "root_clearance")
"""Numbers of a sliding face that a design may leave to their defaults."""

INCOMPRESSIBLE = 0.495
"""Poisson's ratio of rubber whose compound states none (0.49 to 0.499 in use)."""


def _shape(v: Values, element: SealElement, groove: Groove) -> dict[str, Array]:
    """Widths and clearances of an element that is no O-ring."""
    at = groove.path
    if element.type == "o_ring":
        return {}
    stated = {name: v[at + name] for name in FACE if at + name in v}
    width = v[f"{at}width"]
    shape = {"width": width} | face(
        element.type, stated, width=width, section=groove.section, gland_depth=groove.gland_depth
    )
    if element.type != "compact":
        shape["thickness"] = v[f"{at}thickness"]
    return shape


def face(
    kind: str, stated: Mapping[str, Array], *, width: Array, section: Array, gland_depth: Array
) -> dict[str, Array]:
    """What of `FACE` a type of ring has: stated, else its default."""
    land = stated.get("land", LANDS[kind] * width)
    if kind == "step_ring":
        relief = stated.get("relief", (width - land) / 2)
        return {"land": land, "relief": relief, "taper": stated.get("taper", TAPER)}
    if kind == "u_cup":
        interference = lip_seal.lip_interference(section=section, gland_depth=gland_depth)
        return {"land": land, "root_clearance": stated.get("root_clearance", interference)}
    return {"land": land}
