"""Bonds in an evaluation: metal fittings of a laminated rod, and all bonds without load.

The joint module covers the bonds of the caps.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import pi

from ..base.numeric import Array, maximum
from ..design.model import Design
from ..joints.joint import Thermal
from ..joints.overlap import Overlap, mismatch
from ..models.rod import section_area
from .allow import MaterialValues
from .rods import Rod
from .rows import MetricArrays
from .values import Values


def fittings(v: Values, stock: MaterialValues, design: Design, rod: Rod) -> Overlap | str:
    """End fittings in a laminated rod, or a reason why the rod has none."""
    fitting = design.rod.fitting
    if fitting is None:
        return "the rod has no bonded fittings"
    area = fitting_area(v, design, rod)
    around = pi * rod.inner_diameter
    return Overlap(
        adhesive=fitting.adhesive,
        diameter=rod.inner_diameter,
        length=v["rod.fitting.length"],
        tube=rod.axial_stiffness / around,
        metal=stock.get(rod.end_material, "youngs_modulus") * area / around,
        mismatch=mismatch(stock, rod.end_material, rod.expansion),
        names=("tube", "fitting"),
    )


def fitting_hole(v: Values, design: Design, rod: Rod) -> Array:
    """Inner diameter of a fitting: zero for a plug or a sleeve that fills the bore."""
    if design.rod.fitting is None or design.rod.fitting.wall is None:
        return 0.0 * rod.inner_diameter
    return maximum(rod.inner_diameter - 2 * v["rod.fitting.wall"], 0.0)


def fitting_area(v: Values, design: Design, rod: Rod) -> Array:
    """Cross-section of a fitting in the overlap."""
    return section_area(
        outer_diameter=rod.inner_diameter, inner_diameter=fitting_hole(v, design, rod)
    )


def thermal(
    v: Values, design: Design, bonds: Mapping[str, Thermal | str], out: MetricArrays
) -> None:
    """Strength over edge shear without load, from joining to the coldest and the hottest.

    `bonds` are overlaps by place, or the reason why a place has none.
    """
    metric = "bond_thermal_factor"
    if design.environment is None:
        out.skip(metric, "no temperature range stated: add environment")
        return
    factors = {}
    for place, factor in bonds.items():
        if isinstance(factor, str):
            continue
        for word in ("cold", "hot"):
            limit = "min" if word == "cold" else "max"
            warming = v[f"environment.temperature_{limit}"] - v["environment.assembly_temperature"]
            factors[f"{place}, {word}"] = factor(warming, word == "cold")
    if factors:
        out.put(metric, factors)
    else:
        out.skip(metric, next(why for why in bonds.values() if isinstance(why, str)))
