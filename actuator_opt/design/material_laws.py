"""Laws of an oil: the selected law, and the library data that each law needs."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping
from typing import Any

from ..base.errors import Fault, InputError
from ..base.kinds import Kinds
from ..models.oil_laws import BULK_MODULUS_LAWS, VISCOSITY_LAWS
from .structure import child_at
from .view import Materials, Properties, View

_GOOD = {
    "bulk_modulus_slope": "6", "pressure_viscosity": "18 1/GPa", "tait_modulus": "8.4 GPa",
    "tait_decay": "0.0058 1/K", "tait_coefficient": "11.9",
}  # fmt: skip
"""An example of each property, for mineral oil, for messages."""


def bulk_modulus_law(stated: str | None, known: Container[str]) -> str:
    """The stated law; else linear if the slope is a known property, else constant."""
    return stated or ("linear" if "bulk_modulus_slope" in known else "constant")


def viscosity_law(stated: str | None, known: Container[str]) -> str:
    """The stated law; else Roelands if its coefficient is a known property."""
    return stated or ("roelands" if "pressure_viscosity" in known else "none")


def of_fluid(tree: Any, materials: Materials) -> Iterator[Fault]:
    """Stated laws of the oil without the data they need in library or design."""
    view = View(tree)
    name = view.text("fluid", "material")
    if name is None or not isinstance(materials, Properties) or materials.kind(name) != "fluid":
        return
    own = child_at(tree, ("materials", name))
    try:
        known = {*materials.numbers(name), *(own if isinstance(own, Mapping) else ())}
    except InputError:  # a faulty entry is reported elsewhere
        return
    for key, laws, instead in (
        ("bulk_modulus_law", BULK_MODULUS_LAWS, bulk_modulus_law(None, known)),
        ("viscosity_pressure", VISCOSITY_LAWS, viscosity_law(None, known)),
    ):
        law = view.text("fluid", key)
        missing = [needed for needed in _needs(laws, law) if needed not in known]
        if missing:
            stated = f'"{missing[0]}: {_GOOD[missing[0]]}"'
            yield Fault(
                ("fluid", key),
                f"{law}: {name} has no {', '.join(missing)}",
                f"write {instead}, or add e.g. {stated} under materials.{name}",
            )


def _needs(laws: Kinds[Any], law: str | None) -> tuple[str, ...]:
    """Properties that a stated law needs."""
    return laws[law].needs if law is not None and law in laws else ()
