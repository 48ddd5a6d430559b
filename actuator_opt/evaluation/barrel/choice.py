"""The barrel in an evaluation: the one place that chooses between the tube models.

Isotropic (Lamé), exact layered tube (the default of every laminate), thin laminate (fast), or the
paper's own; everything after it works with a `Wall`.
"""

from __future__ import annotations

from collections.abc import Mapping

from ...design.material import Material
from ...design.model import Design
from ..allow import MaterialValues
from ..geometry import Geometry
from ..state import LoadState
from ..values import Values
from . import laminate, metal
from .wall import Wall

LAMINATES = ("layered", "thin_laminate")
"""The wall models of plies."""


def kind(design: Design, materials: Mapping[str, Material]) -> str:
    """Which wall model a design uses: isotropic, as_published, layered or thin_laminate."""
    if design.barrel.model != "auto":
        return design.barrel.model
    first = materials[design.barrel.layup[0].material]
    return "isotropic" if len(design.barrel.layup) == 1 and first.isotropic else "layered"


def compute(
    v: Values, design: Design, stock: MaterialValues, geometry: Geometry, state: LoadState
) -> Wall:
    """The wall of a design under its supply pressure."""
    model = kind(design, stock.materials)
    if model in LAMINATES:
        exact = model == "layered"
        return laminate.compute(v, design, stock, geometry, state, exact=exact)
    published = model == "as_published"
    return metal.compute(v, design, stock, geometry, state, as_published=published)
