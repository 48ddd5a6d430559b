"""Bonded joints in an evaluation: caps on the barrel, metal fittings in a laminated rod.

Shear at both edges of the overlap under force, and without force at the coldest and the hottest.
The two are not added: their elastic sum overstates an adhesive that yields before it breaks.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi

from ..design.model import Design
from ..models import lap_joint
from ..models.rod import section_area
from ..models.strength_modes import load_multiplier
from ..numeric import Array, absolute, maximum
from .allow import Stock
from .barrel import Wall
from .geometry import Geometry
from .rods import Rod
from .rows import Computed
from .values import Values


@dataclass(frozen=True, slots=True)
class Lap:
    """A bonded overlap of a metal part with a tube.

    `tube` and `metal` are axial E t at the bond's diameter [N/m]; `mismatch` is the metal's
    expansion less the tube's [1/K], None where one is not known; `names` are tube and metal part.
    """

    adhesive: str
    diameter: Array
    length: Array
    tube: Array
    metal: Array
    mismatch: Array
    names: tuple[str, str]


def caps(stock: Stock, design: Design, g: Geometry, wall: Wall) -> Lap | str:
    """The caps' skirts over the barrel, or why they cannot be judged."""
    held = design.retention
    if held is None:
        return "no retention stated: add retention"
    if held.type != "bond":
        return "the caps are not bonded"
    if held.material is None:
        return "a bond needs its adhesive: add retention.material"
    modulus = stock.get(design.caps.material, "youngs_modulus")
    glue = (stock.get(held.material, key) for key in ("bond_strength", "shear_modulus"))
    if any(value is None for value in (modulus, *glue)):
        return "adhesive or caps lack bond strength or a modulus"
    along = None if wall.expansion is None else wall.expansion[0]
    return Lap(
        adhesive=held.material,
        diameter=2 * g.outer_radius,
        length=g.skirt_length,
        tube=wall.axial_line_stiffness,
        metal=modulus * g.skirt_wall,
        mismatch=_mismatch(stock, design.caps.material, along),
        names=("barrel", "skirt"),
    )


def fittings(v: Values, stock: Stock, design: Design, rod: Rod) -> Lap | str:
    """The end fittings inside a laminated rod, or why there are none."""
    fitting = design.rod.fitting
    if fitting is None:
        return "the rod has no bonded fittings"
    area = fitting_area(v, design, rod)
    around = pi * rod.inner_diameter
    return Lap(
        adhesive=fitting.adhesive,
        diameter=rod.inner_diameter,
        length=v["rod.fitting.length"],
        tube=rod.axial_stiffness / around,
        metal=stock.get(rod.end_material, "youngs_modulus") * area / around,
        mismatch=_mismatch(stock, rod.end_material, rod.expansion),
        names=("tube", "fitting"),
    )


def fitting_hole(v: Values, design: Design, rod: Rod) -> Array:
    """Inner diameter of a fitting: none of a plug, nor of a sleeve that fills the bore."""
    if design.rod.fitting is None or design.rod.fitting.wall is None:
        return 0.0 * rod.inner_diameter
    return maximum(rod.inner_diameter - 2 * v["rod.fitting.wall"], 0.0)


def fitting_area(v: Values, design: Design, rod: Rod) -> Array:
    """Section of a fitting in the overlap."""
    return section_area(
        outer_diameter=rod.inner_diameter, inner_diameter=fitting_hole(v, design, rod)
    )


def _mismatch(stock: Stock, metal: str, along: Array) -> Array:
    """Expansion of the metal less that of the tube along the axis; None where not known."""
    own = stock.get(metal, "thermal_expansion")
    return None if own is None or along is None else own - along


def _adhesive(stock: Stock, lap: Lap) -> dict[str, Array]:
    """The overlap as the models take it."""
    return {
        "length": lap.length,
        "shear_modulus": stock.get(lap.adhesive, "shear_modulus"),
        "bond_thickness": stock.get(lap.adhesive, "bond_thickness", default=0.15e-3),
    }


def edge_factors(stock: Stock, lap: Lap, force: Array) -> dict[str, Array]:
    """Strength over elastic shear at both edges under a force."""
    strength = stock.allowable(lap.adhesive, "bond_strength")
    tube, metal = lap.names
    factors = {}
    for edge, loaded, free in ((metal, lap.tube, lap.metal), (tube, lap.metal, lap.tube)):
        stress = lap_joint.bond_edge_shear(
            force=force,
            diameter=lap.diameter,
            membrane_stiffness_loaded=loaded,
            membrane_stiffness_free=free,
            **_adhesive(stock, lap),
        )
        factors[f"bond at the {edge}'s edge"] = strength / stress
    return factors


def least_peak_ratio(stock: Stock, lap: Lap, stiffness: Array) -> Array:
    """Peak over mean shear from below, from the stiffness of one of the walls."""
    return lap_joint.least_bond_peak_ratio(membrane_stiffness=stiffness, **_adhesive(stock, lap))


def mean_factor(stock: Stock, lap: Lap, force: Array) -> Array:
    """Strength over mean shear under a force."""
    return stock.allowable(lap.adhesive, "bond_strength") * (pi * lap.diameter * lap.length) / force


def thermal(
    v: Values, stock: Stock, design: Design, laps: Mapping[str, Lap | str], out: Computed
) -> None:
    """Strength over edge shear without load, from joining to the coldest and the hottest."""
    metric = "bond_thermal_factor"
    if design.environment is None:
        out.skip(metric, "no temperature range stated: add environment")
        return
    factors = {}
    reasons = []
    for place, lap in laps.items():
        if isinstance(lap, str):
            reasons.append(lap)
            continue
        if lap.mismatch is None:
            reasons.append(f"thermal expansion of the {' or of the '.join(lap.names)} is not known")
            continue
        for word in ("cold", "hot"):
            limit = "min" if word == "cold" else "max"
            warming = v[f"environment.temperature_{limit}"] - v["environment.assembly_temperature"]
            stress = lap_joint.bond_thermal_shear(
                strain_difference=lap.mismatch * warming,
                membrane_stiffness_1=lap.tube,
                membrane_stiffness_2=lap.metal,
                **_adhesive(stock, lap),
            )
            strength = stock.allowable(lap.adhesive, "bond_strength", cold=word == "cold")
            factors[f"{place}, {word}"] = load_multiplier(absolute(stress) / strength)
    if factors:
        out.put(metric, factors)
    else:
        out.skip(metric, reasons[0])
