"""Cushions of the cylinder: masses, and the metal beside spear and collar.

A spear on the piston enters a bush at the cap, and a collar on the rod one at the head. Each bush
fills the barrel over the cushioned travel, and makes the cylinder longer by it.
"""

from __future__ import annotations

from typing import Any

from ..base.numeric import Array
from ..design.model import Design
from ..models.mass import tube_mass
from .geometry import Geometry
from .rods import RodSection
from .values import Values

NO_CUSHION = "no cushion stated: add cushion"


def lands(design: Design, g: Geometry) -> dict[str, Any]:
    """Walls of bush and collar, which the optimiser keeps."""
    if design.cushion is None:
        return {}
    rows = {"bush": g.inner_radius - g.cushion / 2}
    if design.cushion.ends != "cap":
        rows["collar"] = (g.cushion - g.rod_diameter) / 2
    return {"geometry_cushion": rows}


def masses(v: Values, design: Design, g: Geometry, rod: RodSection) -> dict[str, Array]:
    """Mass of the bushes, of the metals of cap and head; of spear and collar, of the rod's metal.

    A sensor passes through the spear in a hole as wide as the rod's bore.
    """
    if design.cushion is None:
        return {}
    caps, head, metal = (
        v[f"materials.{name}.density"]
        for name in (design.caps.material, design.head.material, rod.end_material)
    )
    bush = {"inner_diameter": g.cushion, "outer_diameter": g.bore}
    hole = 0.0 if design.sensor is None else g.rod_inner_diameter
    spear = {"inner_diameter": hole, "outer_diameter": g.cushion, "length": g.cap_bush}
    collar = {"inner_diameter": g.rod_diameter, "outer_diameter": g.cushion, "length": g.head_bush}
    return {
        "cap": tube_mass(density=caps, length=g.cap_bush, **bush),
        "glands": tube_mass(density=head, length=g.head_bush, **bush),
        "fastening": tube_mass(density=metal, **spear) + tube_mass(density=metal, **collar),
    }
