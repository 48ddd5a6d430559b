"""The barrel of a design: its wall, by the tube model that suits it, and its axial force.

Only this module selects the tube model. The models are: isotropic (Lamé), exact layered tube
(default for all laminates), thin laminate (fast), and the formula of a published paper. Each
returns a `Wall`, the only form in which other modules use the result.
"""

from __future__ import annotations

from collections.abc import Mapping

from ...design.material import Material
from ...design.model import Design
from ..geometry import Geometry
from ..limits import MaterialValues
from ..state import LoadState
from ..values import Values
from . import laminate, wall
from .wall import OWN, SEAL_STEP, Cycle, Swelling, Wall

__all__ = ["LAMINATES", "OWN", "SEAL_STEP", "Cycle", "Swelling", "Wall", "compute", "kind"]

LAMINATES = ("layered", "thin_laminate")
"""Wall models that treat the barrel as a laminate of plies."""


def kind(design: Design, materials: Mapping[str, Material]) -> str:
    """Name of a design's wall model: isotropic, as_published, layered or thin_laminate."""
    if design.barrel.model != "auto":
        return design.barrel.model
    first = materials[design.barrel.layup[0].material]
    return "isotropic" if len(design.barrel.layup) == 1 and first.isotropic else "layered"


def compute(
    v: Values, design: Design, stock: MaterialValues, geometry: Geometry, state: LoadState
) -> Wall:
    """Calculate the barrel wall of a design under its supply pressure."""
    model = kind(design, stock.materials)
    if model in LAMINATES:
        exact = model == "layered"
        return laminate.compute(v, design, stock, geometry, state, exact=exact)
    published = model == "as_published"
    return wall.metal_swelling(v, design, stock, geometry, state, as_published=published)
