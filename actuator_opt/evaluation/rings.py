"""Sealing rings in an evaluation: squeeze with bore growth, contact pressure, gland checks.

The contact pressure follows from the model of the seal type, unless the design states it. Gland
checks cover squeeze, fill and extrusion gap, with tolerances, bore growth and temperature.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Literal

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array, absolute, maximum, minimum, real, where
from ..design.housings import extrusion_tables
from ..design.material import Material
from ..design.model import Design
from ..design.seals import SealElement
from ..models import elastomer, gland
from ..seals.contact import SealContact, stated_contact
from ..seals.seal_type import SealSizes
from .barrel import OWN, SEAL_STEP
from .geometry import Geometry, Groove
from .limits import MaterialValues
from .state import LoadState, pressure_law
from .values import Values

Place = Literal["piston", "rod"]
SlidingPlace = Place | Literal["second_rod"]
RingPlace = SlidingPlace | Literal["static"]
BLOCKS: dict[SlidingPlace, Place] = {"piston": "piston", "rod": "rod", "second_rod": "rod"}
"""Block of `seals` that describes the seals of each place: both rods have the same."""


@dataclass(frozen=True, slots=True)
class Ring:
    """A sealing element with its numerical properties; arrays broadcast to (cases, designs).

    `numbers` contains the values of the design file and in addition `diameter`, `youngs_modulus` of
    the squeezed part, `pressure` (the sealed pressure difference), `outer_pressure` (gauge) and
    `squeeze_left` (nominal squeeze minus the loss by bore growth). For an oil film it also contains
    `speed`, `viscosity`, `return_pressure` (in chamber B, or at a second rod in chamber A, on the
    return stroke) and the ring's roughness.
    """

    name: RingPlace
    element: SealElement
    groove: Groove
    numbers: Mapping[str, Array]
    viscosity_law: str = "none"
    """Name of the law by which the viscosity of the oil depends on pressure."""

    def __getitem__(self, name: str) -> Array:
        return self.numbers[name]

    @property
    def sizes(self) -> SealSizes:
        """Numbers and laws of the ring, as inputs of the models of seal types and friction."""
        element = self.element
        around_rod = self.name in ("rod", "second_rod")
        return SealSizes(self.numbers, element.law, element.hardness_model, around_rod)

    @property
    def label(self) -> str:
        """Name of the ring in results."""
        return self.groove.place

    def at(self, **numbers: Array) -> Ring:
        """The same ring with some numbers replaced."""
        return replace(self, numbers={**self.numbers, **numbers})


def places(g: Geometry) -> tuple[tuple[SlidingPlace, tuple[Groove, ...], Array], ...]:
    """Name, grooves and counterface diameter of the piston seals and of the seals of each rod."""
    rods = ((rod.path, rod.grooves, rod.diameter) for rod in g.rods)
    return ("piston", g.piston_grooves, g.bore), *rods


HARDNESS_TEMPERATURE = 296.15
"""Temperature at which hardness and modulus of a compound are measured, K (ISO 23529)."""


def hardness_modulus(v: Values, compound: str, law: str) -> Array:
    """Young's modulus of a compound from its hardness, at `HARDNESS_TEMPERATURE`."""
    at = f"materials.{compound}."
    modulus = elastomer.MODULUS_LAWS[law].modulus(hardness=v[f"{at}hardness"])
    factor = f"{at}hardness_modulus_factor"
    return modulus * v[factor] if factor in v else modulus


def face_modulus(v: Values, compound: str, law: str, temperature: Array) -> Array:
    """Young's modulus of a ring's sliding face at a temperature; by default from its hardness."""
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
    """All sealing rings; on piston and rod, the first ring seals the pressure.

    The piston seal seals the pressure difference between the chambers, the rod seal the pressure of
    chamber B, and that of a second rod the pressure of chamber A. `growth` is the radial growth of
    the bore far from the seal.
    """
    across: dict[str, tuple[Array, Array]] = {
        "piston": (
            absolute(state.moving_a - state.moving_b),
            state.moving_a + state.moving_b,
        ),
        "rod": (maximum(state.moving_b, 0.0), maximum(state.moving_b, 0.0)),
        "second_rod": (maximum(state.moving_a, 0.0), maximum(state.moving_a, 0.0)),
    }
    law, coefficient = pressure_law(design.fluid, stock, state.temperature)
    drain = v["supply.return_pressure"]
    oil_numbers = {
        "speed": state.speed,
        "viscosity": state.dynamic_viscosity,
        "viscosity_coefficient": coefficient,
    }
    sealing_rings = []
    for name, grooves, diameter in places(geometry):
        block = BLOCKS[name]
        elements = getattr(design.seals, block).elements()
        pressure, total = across[name]
        for groove in grooves:
            key = groove.path.removeprefix(f"seals.{block}.")
            if groove.role != "element" or elements[key].count == 0:
                continue
            numbers = _numbers(v, elements[key], groove, diameter, state.temperature)
            ring_growth = SEAL_STEP * growth if name == "piston" else 0.0
            ring_pressure = pressure if key == "" else 0.0 * pressure
            numbers["pressure"] = ring_pressure
            numbers["outer_pressure"] = (total - pressure) / 2
            if elements[key].friction_law.film:
                numbers |= oil_numbers
                back = (state.driven_pressure, drain)
                back = back[::-1] if name == "second_rod" else back
                numbers["return_pressure"] = where(state.push, *back)
            numbers["squeeze_left"] = gland.squeeze_after(
                squeeze=numbers["squeeze"],
                section=groove.section,
                growth=ring_growth,
                tolerance=0.0,
            )
            roughness = {"counterface_roughness": v[f"seals.{block}.counterface_roughness"]}
            sealing_rings.append(Ring(name, elements[key], groove, numbers | roughness, law))
    return tuple(sealing_rings)


def static_rings(v: Values, design: Design, geometry: Geometry) -> tuple[Ring, ...]:
    """The static seal of an end; both ends have the same. None if static seals are not stated."""
    if design.seals.static is None or not geometry.static_grooves:
        return ()
    (groove,) = geometry.static_grooves
    keys = ("section", "squeeze", "tolerance", "section_tolerance", "stretch", "clearance")
    numbers = {key: v[groove.path + key] for key in keys}
    numbers |= {"groove_width": groove.width, "gland_depth": groove.gland_depth}
    return (Ring("static", design.seals.static.element, groove, numbers),)


_OWN = ("friction_coefficient", "breakaway_ratio", "stribeck_speed")
"""Keys of a seal whose default is the value of its compound."""


def _numbers(
    v: Values, element: SealElement, groove: Groove, diameter: Array, temperature: Array
) -> dict[str, Array]:
    """Numbers of a sealing ring from which its contact pressure follows."""
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
"""Default Poisson's ratio of rubber (common values are 0.49 to 0.499)."""


def seal_contact(ring: Ring) -> SealContact:
    """Contact pressure of a ring, at its numbers `squeeze_left` and `pressure`."""
    if ring.element.contact:
        return stated_contact(ring.element.contact, ring["pressure"])
    return ring.element.seal_type.contact(ring.sizes)


def static_profile(ring: Ring, nodes: int) -> tuple[Array, Array]:
    """Contact width [m], and static contact pressure [Pa gauge] at evenly spaced nodes."""
    position = np.linspace(0.0, 1.0, nodes)
    pressure, outer = ring["pressure"], ring["outer_pressure"]
    if real(pressure) >= 0:
        contact = seal_contact(ring)
        return contact.profile_width, outer + contact.profile(position)
    contact = seal_contact(ring.at(pressure=-pressure))  # pressure acts from the other side
    return contact.profile_width, outer + pressure + contact.profile(1 - position)


ROOM = 293.15
"""Default assembly temperature [K]."""


EXTRUSION_TABLE = "sealanddesign"
"""Table of extrusion gaps by hardness and pressure, for compounds that state no gap limits."""


def gland_metrics(
    v: Values,
    design: Design,
    stock: MaterialValues,
    geometry: Geometry,
    state: LoadState,
    ring: Ring,
    growths: Mapping[str, Array],
) -> dict[str, dict[str, Array]]:
    """Gland metrics of a ring by location; `growths` has the growth of its bore by load path.

    Squeeze and fill are for the worst tolerances, at the highest and lowest temperature, with rod
    and bore concentric as in gland tables. The extrusion gap includes the effect of a side load: it
    moves the rod aside, so that on one side the gap is larger by the clearance. The seal report
    shows the smaller squeeze on that side.
    """
    clearance, aside = clearances(geometry, state, ring)
    cold, hot = (
        volume_ratio(v, design, stock, ring, v[f"environment.temperature_{end}"])
        if design.environment is not None
        else 1.0
        for end in ("min", "max")
    )
    least, most = minimum(cold, hot), maximum(cold, hot)
    allowed, gap = _allowed_gap(v, stock, ring), clearance + aside
    metrics = {"extrusion_factor": {path: allowed / (gap + x) for path, x in growths.items()}}
    if ring.element.seal_type.round_ring:  # limits of squeeze apply to round rings
        metrics["seal_squeeze"] = {
            path: squeezes(ring, growth=growth, aside=0.0, ratio=least)[0]
            for path, growth in growths.items()
        }
        metrics["seal_squeeze_max"] = {OWN: squeezes(ring, growth=0.0, aside=0.0, ratio=most)[1]}
    if ring.element.seal_type.o_ring_gland:
        metrics["seal_fill"] = {OWN: _fill(ring) * most}
        metrics["seal_stretch"] = {OWN: ring["stretch"]}
        if ring.name != "static":  # the limit is against twisting by the stroke
            metrics["seal_section"] = {OWN: ring["section"]}
    return {
        metric: {", ".join(x for x in (ring.label, path) if x): x for path, x in values.items()}
        for metric, values in metrics.items()
    }


def _fill(ring: Ring) -> Array:
    """Largest filled share of an O-ring's groove at assembly: thickest ring, shallowest groove."""
    back_up_width = sum(piece.area for piece in ring.groove.pieces[1:]) / ring["gland_depth"]
    return gland.gland_fill(
        section=gland.stretched_section(
            section=ring["section"] + ring["section_tolerance"], stretch=ring["stretch"]
        ),
        groove_width=ring["groove_width"] - back_up_width,
        gland_depth=ring["gland_depth"] - ring["tolerance"],
    )


def clearances(geometry: Geometry, state: LoadState, ring: Ring) -> tuple[Array, Array]:
    """Radial clearance behind a ring, and radial shift of rod or piston by the side load."""
    if ring.name == "static":
        return ring["clearance"], 0.0
    clearance = geometry.piston_clearance if ring.name == "piston" else geometry.head_clearance
    return clearance, where(real(state.side_load) > 0, 1.0, 0.0) * clearance


def squeezes(ring: Ring, *, growth: Array, aside: Array, ratio: Array) -> tuple[Array, Array]:
    """Least and largest squeeze of a ring.

    The least squeeze includes the effects of bore growth and stretch, the largest excludes them.
    `ratio` is the result of `volume_ratio`; `aside` is the eccentricity of rod or piston.
    """
    section = ring["section"]
    stretched = gland.stretched_section(section=section, stretch=ring["stretch"])
    tolerances = {
        "section_tolerance": ring["section_tolerance"],
        "depth_tolerance": ring["tolerance"],
        "eccentricity": aside,
    }
    squeeze = 1 - (section * (1 - ring["squeeze"]) + growth) / stretched
    loosest, _ = gland.squeeze_extremes(squeeze=squeeze, section=stretched, **tolerances)
    _, tightest = gland.squeeze_extremes(squeeze=ring["squeeze"], section=section, **tolerances)
    return (
        gland.squeeze_at_volume(squeeze=loosest, volume_ratio=ratio),
        gland.squeeze_at_volume(squeeze=tightest, volume_ratio=ratio),
    )


def volume_ratio(
    v: Values, design: Design, stock: MaterialValues, ring: Ring, temperature: Array
) -> Array:
    """Ratio of ring volume to groove volume at a temperature, relative to the ratio at assembly.

    It is 1 if the thermal expansion is unknown.
    """
    expansion = stock.get(ring.element.compound, "volume_expansion")
    part = design.piston.material if ring.name == "piston" else design.head.material
    housing = stock.get(
        design.caps.material if ring.name == "static" else part, "thermal_expansion"
    )
    if expansion is None or housing is None:
        return 1.0
    assembly = v["environment.assembly_temperature"] if design.environment is not None else ROOM
    return gland.volume_ratio(
        volume_expansion=expansion,
        housing_expansion=housing,
        temperature_change=temperature - assembly,
    )


def _allowed_gap(v: Values, stock: MaterialValues, ring: Ring) -> Array:
    """Allowable extrusion gap at supply pressure.

    It is that of the seal or, if there is a back-up ring, the larger of both gaps whose data cover
    the pressure.
    """
    pressure, element = v["supply.pressure"], ring.element
    if stock.material(element.compound).properties.get("extrusion_gap_max") is None:
        hardness = v[f"materials.{element.compound}.hardness"]
        table = extrusion_tables()[EXTRUSION_TABLE].rows
        allowed = gland.extrusion_gap_limit(hardness=hardness, pressure=pressure, table=table)
        end = gland.extrusion_pressure_end(hardness=hardness, table=table)
    else:
        allowed = _stated(stock, element.compound, pressure)
        end = _stated_end(stock.material(element.compound))
    if element.back_up_material is not None:
        allowed = gland.backed_gap_limit(
            pressure=pressure,
            seal_limit=allowed,
            seal_end=end,
            ring_limit=_stated(stock, element.back_up_material, pressure),
            ring_end=_stated_end(stock.material(element.back_up_material)),
        )
    return allowed


def _stated_end(material: Material) -> float:
    """Highest pressure for which a material states a limit of the extrusion gap, or 0."""
    limit = material.properties.get("extrusion_gap_max")
    if limit is None:
        return 0.0
    return limit.arguments[-1] if limit.points else math.inf


def _stated(stock: MaterialValues, name: str, pressure: Array) -> Array:
    """Extrusion gap that a material states as its limit at a pressure; 0 if not stated."""
    limit = stock.material(name).properties.get("extrusion_gap_max")
    if limit is None:
        return 0.0
    scale = stock.get(name, "extrusion_gap_max") / limit.value
    if not limit.points:
        return scale * limit.value
    points = tuple(zip(limit.arguments, limit.values, strict=True))
    return scale * gland.gap_limit(pressure=pressure, points=points)


def extrusion_end(ring: Ring, materials: Mapping[str, Material]) -> float:
    """Highest pressure for which a limit of a ring's extrusion gap is known."""
    compound, back_up = materials[ring.element.compound], ring.element.back_up_material
    ends = [0.0 if back_up is None else _stated_end(materials[back_up])]
    if "extrusion_gap_max" in compound.properties:
        ends.append(_stated_end(compound))
    else:
        table = extrusion_tables()[EXTRUSION_TABLE].rows
        hardness = compound.numbers["hardness"]
        ends.append(float(gland.extrusion_pressure_end(hardness=hardness, table=table)))
    return max(ends)
