"""Names and values of priced requirements and parameters, as people say them."""

from __future__ import annotations

from ..optimisation.sensitivity import Sensitivity


def display_of(row: Sensitivity, value: float | None) -> float | None:
    """A value of the parameter in its display unit; temperatures have an offset."""
    if value is None:
        return None
    offset = 273.15 if row.unit in ("degC", "°C") else 0.0
    return value / row.scale - offset


def short_name(row: Sensitivity) -> str:
    """A PATH without what the sentence tells: "stiffness_min", "density of ti_6al4v".

    >>> from types import SimpleNamespace as Row
    >>> short_name(Row(parameter="requirements.stiffness_min.min"))
    'stiffness_min'
    >>> short_name(Row(parameter="materials.ti_6al4v.density"))
    'density of ti_6al4v'
    """
    path = row.parameter
    if path.startswith("requirements."):
        return path.removeprefix("requirements.").rpartition(".")[0]
    if path.startswith("materials."):
        material, _, name = path.removeprefix("materials.").rpartition(".")
        return f"{name} of {material}"
    return path
