"""Sealing rings of an evaluation: their numbers, with pressure and bore growth."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

from ..base.numeric import Array, absolute, maximum, where
from ..design.model import Design
from ..design.seals import SealElement
from ..models import elastomer, gland
from ..seals.seal_type import SealSizes
from . import oil
from .barrel import SEAL_STEP
from .geometry import Geometry
from .grooves import Groove
from .limits import MaterialValues
from .state import LoadState
from .values import Values

Place = Literal["piston", "rod"]


@dataclass(frozen=True, slots=True)
class Ring:
    """A sealing element with its numbers by name; arrays broadcast to (cases, designs).

    `numbers`: those of the design file, and `diameter`, `youngs_modulus` of the squeezed part,
    `pressure` (sealed difference), `outer_pressure` (gauge), `squeeze_left` (nominal squeeze minus
    the loss by bore growth). With an oil film: `speed`, `viscosity`, `return_pressure` (p_B on the
    return stroke) and the roughness of the face.
    """

    name: Place
    element: SealElement
    groove: Groove
    numbers: Mapping[str, Array]
    viscosity_law: str = "none"
    """Viscosity law of its oil over pressure."""

    def __getitem__(self, name: str) -> Array:
        return self.numbers[name]

    @property
    def sizes(self) -> SealSizes:
        """Its numbers and laws, as inputs of seal types and friction laws."""
        own = self.element
        return SealSizes(self.numbers, own.law, own.hardness_model, self.name == "rod")

    @property
    def label(self) -> str:
        """Name in results."""
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
    """Young's modulus of a compound from its hardness, at measuring temperature."""
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
    v: Values,
    design: Design,
    stock: MaterialValues,
    geometry: Geometry,
    state: LoadState,
    growth: Array,
) -> tuple[Ring, ...]:
    """All sealing elements; the first of a place carries the pressure.

    The piston seal has the pressure difference, the rod seal p_B. `growth` is the far-field bore
    growth.
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
            if elements[tail].friction_law.film:
                own |= oiled
                own["return_pressure"] = where(state.push, state.driven_pressure, drain)
            own["squeeze_left"] = gland.squeeze_after(
                squeeze=own["squeeze"], section=groove.section, growth=grown, tolerance=0.0
            )
            roughness = {"counterface_roughness": v[f"seals.{name}.counterface_roughness"]}
            found.append(Ring(name, elements[tail], groove, own | roughness, law))
    return tuple(found)


_OWN = ("friction_coefficient", "breakaway_ratio", "stribeck_speed")
"""Numbers that default to those of the compound."""


def _numbers(
    v: Values, element: SealElement, groove: Groove, diameter: Array, temperature: Array
) -> dict[str, Array]:
    """Inputs of the contact of an element."""
    at, compound, kind = groove.path, f"materials.{element.compound}.", element.seal_type
    law = element.friction_law
    face = face_modulus(v, element.compound, element.hardness_model, temperature)
    squeezed = face
    if kind.modulus_by == "hardness":  # the temperature law applies to the sliding ring
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
    stated = {key: v[at + key] for key in kind.keys if at + key in v}
    numbers |= kind.sizes(stated, section=groove.section, gland_depth=groove.gland_depth)
    if kind.round_ring or f"{compound}youngs_modulus" not in v:
        numbers["hardness"] = v[f"{compound}hardness"]
    if kind.face or law.film:
        numbers["face_modulus"] = face
        numbers["face_poissons_ratio"] = v.get(f"{compound}poissons_ratio", INCOMPRESSIBLE)
    return numbers | {field: v[compound + field] for field in law.compound}


INCOMPRESSIBLE = 0.495
"""Default Poisson's ratio of rubber (0.49 to 0.499 in use)."""
