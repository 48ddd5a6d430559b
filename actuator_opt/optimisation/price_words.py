"""Wording of priced requirements and parameters: names, values, best offers."""

from __future__ import annotations

from ..base.quantities import Quantity, short
from .sensitivity import CHANGE, Offer, Offers, Sensitivity

PER_CENT = round(100 * CHANGE)


def display_of(row: Sensitivity, value: float | None) -> float | None:
    """A value of the parameter in its display unit; temperatures have an offset."""
    if value is None:
        return None
    offset = 273.15 if row.unit in ("degC", "°C") else 0.0
    return value / row.scale - offset


def short_name(row: Sensitivity) -> str:
    """A PATH shortened for a sentence: "stiffness_min", "density of ti_6al4v".

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


def buys_most(
    found: Offers, quantity: Quantity, objective: float, *, maximised: bool
) -> tuple[str, ...]:
    """Sentences on the most valuable changes, and on requirements that cannot be tightened.

    Parameters
    ----------
    found : the best offer of each kind
    quantity, objective : of the objective, and its value at the optimum, SI
    maximised : whether more of it is better
    """

    def gain(offer: Offer) -> str:
        """The gain of an offer: "saves 19.7 g (7.5 %)"."""
        per_display = quantity.to_display(1.0) - quantity.to_display(0.0)
        amount = f"{short(offer.gain * per_display, 3, full=True)} {quantity.unit}".rstrip()
        if objective:
            amount += f" ({short(100 * offer.gain / abs(objective), 2, full=True)} %)"
        return f"adds {amount}" if maximised else f"saves {amount}"

    if (best := found.requirement) is not None:
        parts = [
            f"Relaxing {short_name(best.row)} by {PER_CENT} % (to {_at(best.row, best.value)}) "
            f"{gain(best)}, the most of any requirement."
        ]
    else:
        parts = [f"Relaxing a single requirement by {PER_CENT} % gains nothing."]
    for best, group in (
        (found.parameter, "Of the design's fixed numbers"),
        (found.material, "Of the materials"),
    ):
        if best is not None:
            more = "more" if best.change > 0 else "less"
            name, value = short_name(best.row), _at(best.row, best.value)
            parts.append(f"{group}, {PER_CENT} % {more} {name} ({value}) {gain(best)}.")
    if found.no_design:
        lost = ", ".join(
            f"{short_name(row)} at {_at(row, row.limit * (1 + sign * CHANGE))}"
            for row, sign in found.no_design
        )
        parts.append(f"No feasible design with {lost}.")
    return tuple(parts)


def _at(row: Sensitivity, value: float) -> str:
    """A value of the parameter with its unit."""
    shown = display_of(row, value)
    assert shown is not None
    unit = "" if row.unit == "-" else row.unit
    return f"{short(shown)} {unit}".rstrip()
