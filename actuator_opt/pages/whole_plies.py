"""The table of a rounding: from the continuous optimum to whole plies or standard sizes."""

from __future__ import annotations

from collections.abc import Mapping

from ..base.quantities import Quantity
from ..design import quantity_of
from ..optimisation.result import Optimisation, Rounding
from ..rendering import text
from ..rendering.blocks import Block, Cell, Column, Table, soft
from ..rendering.console import Console
from ..rendering.terminal import block_text
from ..rendering.text import DASH
from .optimum import sentence


def block(optimisation: Optimisation) -> Block | None:
    """Every variable before and after rounding, its plies, the cost; None where none was asked."""
    rounding = optimisation.rounding
    if rounding is None:
        return None
    counted = any(row.plies is not None for row in rounding.variables)
    rows: list[list[Cell]] = []
    for row in rounding.variables:
        quantity = text.input_quantity(row.quantity)
        change = quantity.to_display(row.value) - quantity.to_display(row.continuous)
        still = abs(row.value - row.continuous) <= 1e-9 * abs(row.value)
        rows.append(
            [
                soft(row.path),
                text.number(quantity.to_display(row.continuous)),
                text.number(quantity.to_display(row.value)),
                DASH if still else text.number(change, 3, signed=True),
                text.unit_text(quantity.unit),
                *(["" if row.plies is None else str(row.plies)] if counted else []),
                (row.sizes or "rounded") if row.discrete else "optimised again",
            ]
        )
    columns = [
        Column("variable", "left", 1.3, mono=True),
        Column("continuous", "right"),
        Column(rounding.name, "right", strong=True),
        Column("change", "right"),
        Column("unit"),
        *([Column("plies", "right")] if counted else []),
        Column("sizes", "left"),
    ]
    note = " ".join(notes(optimisation))
    return Table(_title(optimisation, rounding), columns, rows, note=note)


def terminal(
    optimisation: Optimisation, *, colour: bool = False, unicode: bool = True, width: int = 100
) -> str:
    """The same for the terminal; empty where no rounding was asked for."""
    made = block(optimisation)
    if made is None:
        return ""
    console = Console(colour, unicode, width)
    lines = [block_text(made, console)]
    return "\n".join([*lines, *(console.wrap(line, "dim") for line in notes(optimisation))])


def _title(optimisation: Optimisation, rounding: Rounding) -> str:
    objective = text.metric(optimisation.objective_metric)
    name = rounding.name.capitalize()
    if rounding.objective_after is None:
        return f"{name}: no design found"
    before = text.value_text(objective, rounding.objective_before, 5)
    after = text.value_text(objective, rounding.objective_after, 5)
    return f"{name}: {objective.label} {before} → {after}, {_cost(objective, rounding)}"


def _cost(objective: Quantity, rounding: Rounding) -> str:
    """What rounding costs, in the unit of the objective and in per cent."""
    if not rounding.cost:
        return "rounding costs nothing"
    per_display = objective.to_display(1.0) - objective.to_display(0.0)
    unit = text.unit_text(objective.unit)
    amount = text.with_unit(text.number(rounding.cost * per_display, 3), unit)
    share = "" if rounding.percent is None else f" ({text.number(rounding.percent, 3)} %)"
    return f"rounding costs {amount}{share}"


def notes(optimisation: Optimisation) -> list[str]:
    """Outcome, effort and the next best designs of a rounding, in sentences."""
    rounding = optimisation.rounding
    if rounding is None:
        return []
    objective = text.metric(optimisation.objective_metric)
    lines = [sentence(rounding.sentence), sentence(rounding.remedy)]
    lines.append(
        f"{rounding.tried} rounded designs tried, {rounding.feasible} meet every requirement;"
        f" {rounding.solves} re-optimisations."
    )
    for row in rounding.runners_up:
        share = text.number(row.percent, 3, signed=True)
        percent = "" if row.percent is None else f" ({share} %)"
        sizes = _sizes(optimisation, row.values)
        lines.append(f"Next: {text.value_text(objective, row.objective)}{percent} with {sizes}.")
    for remedy in rounding.remedies:
        change = text.pretty(remedy.sentence).replace("->", "→")
        reached = text.value_text(objective, remedy.objective)
        lines.append(f"With {change}: {reached} with {_sizes(optimisation, remedy.values)}.")
    return [line for line in [*lines, *map(sentence, rounding.notes)] if line]


def _sizes(optimisation: Optimisation, sizes: Mapping[str, float]) -> str:
    """Sizes by PATH in words."""
    words = []
    for path, value in sizes.items():
        quantity = quantity_of(path, optimisation.design)
        shown = text.trimmed(quantity.to_display(value))
        words.append(f"{_short(path)} {text.with_unit(shown, text.unit_text(quantity.unit))}")
    return ", ".join(words)


def _short(path: str) -> str:
    """A PATH without what its value tells."""
    return path.removesuffix(".thickness").removesuffix(".angle")
