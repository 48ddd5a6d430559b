"""What each requirement and parameter costs: table, which dimensions move, what buys the most."""

from __future__ import annotations

from ..base.quantities import Quantity
from ..evaluation.result import Requirement
from ..optimisation.price_words import PER_CENT, display_of, short_name
from ..optimisation.result import Optimisation
from ..optimisation.sensitivity import STRAIGHT, Sensitivity
from ..rendering import text
from ..rendering.blocks import Block, Cell, Column, Drawing, Notes, Table, soft
from ..rendering.console import Console
from ..rendering.heights import cells_of, joined
from ..rendering.ink import Ink
from ..rendering.terminal import block_text
from ..rendering.text import DASH
from ..rendering.tornado import MOST, TornadoBar, bars

pass

MOVING = 3
"""Most dimensions named per row of the table of movements."""

MOST_MOVES = 8
"""Most rows of that table: those that change the most."""

LEAST_MOVE = 1e-4
"""Relative movement per +1 % below which a dimension stands still."""


def price_blocks(optimisation: Optimisation) -> list[Block]:
    """Prices, the tornado of their re-solved ends, and which dimensions move."""
    if not optimisation.sensitivities:
        return []
    found: list[Block | None] = [
        sensitivities(optimisation),
        Notes("What would buy the most", buys_most(optimisation)),
        tornado_drawing(optimisation),
        moves(optimisation),
    ]
    return [one for one in found if one is not None]


def terminal(
    optimisation: Optimisation,
    *,
    moving: bool = False,
    colour: bool = False,
    unicode: bool = True,
    width: int = 100,
) -> str:
    """Prices, predicted against re-solved, with the quality line and what buys the most.

    With `moving` also which dimensions move.
    """
    if not optimisation.sensitivities:
        return ""
    console = Console(colour, unicode, width)
    block = sensitivities(optimisation)
    unit = text.unit_text(text.metric(optimisation.objective_metric).unit)
    columns = [
        Column("parameter", width=1.0, least=34),
        Column("limit", "right"),
        Column("value", "right", drop=4),
        Column("margin", "right", drop=3),
        Column("active" if unicode else "act"),
        Column(f"{unit}/unit", "right"),
        Column("%/%", "right"),
        Column(f"at +{PER_CENT} %", "right", drop=1),
        Column("+ solved", "right"),
        Column(f"at -{PER_CENT} %", "right", drop=1),
        Column("- solved", "right"),
        Column("holds until, then active", width=1.0, drop=2),
    ]
    rows, styles = [], []
    for cells in block.rows:
        row = [joined(cell) for cell in cells_of(cells)]
        active = row[4] != ""
        row[4] = "" if not active else "●" if unicode else "*"
        rows.append(row)
        strong = "bold" if active else ""
        styles.append(
            [strong, "", "dim", "dim", "yellow", strong, strong, *("dim", strong) * 2, "dim"]
        )
    lines = [console.heading(block.title), *console.table(columns, rows, styles)]
    lines += [
        console.wrap(quality(optimisation), "dim"),
        "",
        *map(console.wrap, buys_most(optimisation)),
    ]
    moved = moves(optimisation) if moving else None
    if moved is not None:
        lines += ["", block_text(moved, console)]
    return "\n".join(lines)


def sensitivities(optimisation: Optimisation) -> Table:
    """Price of every limit and parameter, checked by solving again at ±10 %."""
    objective = text.metric(optimisation.objective_metric)
    required = {row.path: row for row in optimisation.evaluation.requirements}
    rows: list[list[Cell]] = []
    for row in optimisation.sensitivities:
        found, unit = required.get(row.parameter), text.unit_text(row.unit)
        value = None if found is None else found.value
        solved = [text.number(text.display(objective, v)) for end in row.ends for v in end[1:]]
        rows.append(
            [
                soft(row.parameter.removeprefix("requirements.")),
                text.with_unit(text.trimmed(display_of(row, row.limit)), unit),
                DASH if found is None else text.number(display_of(row, value)),
                DASH if found is None else _margin(found),
                "●" if row.active else "",
                _price(optimisation, row, objective),
                text.number(row.percent_per_percent, 3, signed=True),
                *(solved or [""] * 4),
                _reach(optimisation, row),
            ]
        )
    unit = text.unit_text(objective.unit) or objective.name
    columns = [
        Column("requirement or parameter", "left", 1.0, mono=True),
        Column("limit", "right"),
        Column("value", "right"),
        Column("margin", "right"),
        Column("act.", "center"),
        Column(f"price,\n{unit}/unit", "right"),
        Column("% per\n+1 %", "right"),
        Column(f"+{PER_CENT} %\npredicted", "right"),
        Column(f"+{PER_CENT} %\nsolved", "right", strong=True),
        Column(f"−{PER_CENT} %\npredicted", "right"),
        Column(f"−{PER_CENT} %\nsolved", "right", strong=True),
        Column("holds until, then active", "left", 1.25),
    ]
    title = f"What each requirement costs ({objective.label}, {unit})"
    return Table(title, columns, rows, note=quality(optimisation))


def _margin(found: Requirement) -> str:
    quantity = text.metric(found.metric)
    return text.margin_of(quantity, found.limit, found.margin, met=found.met)


def _price(optimisation: Optimisation, row: Sensitivity, objective: Quantity) -> Cell:
    """The price per unit shown, both sides of a kink, marked where its line does not hold."""
    factor = row.scale * (objective.to_display(1.0) - objective.to_display(0.0))

    def shown(price: float | None) -> str:
        return "∞" if price is None else text.number(price * factor, 3, signed=True)

    mark = "" if row.straight(optimisation.objective_value) else "~ "
    if row.one_sided:
        return [f"{mark}{shown(row.price_up)} up, ", f"{shown(row.price_down)} down"]
    return mark + shown(row.price)


def _reach(optimisation: Optimisation, row: Sensitivity) -> Cell:
    unit = text.unit_text(row.unit)
    until = text.with_unit(text.trimmed(display_of(row, row.holds_until)), unit)
    if row.next_active is None:
        return until
    only = "" if row.straight(optimisation.objective_value) else "only to "
    gone = row.next_active.removesuffix(" stops being active")
    words = f"without {gone}" if gone != row.next_active else gone.removesuffix(" becomes active")
    return soft(f"{only}{until}, then {words}")


def quality(optimisation: Optimisation) -> str:
    """The quality line under the prices."""
    kkt = optimisation.kkt
    if kkt is None:
        return "Quality: no multipliers (the design is not an optimum); prices are not exact."
    parts = [
        f"Quality: KKT residual {text.number(kkt.residual, 2)}, {len(kkt.active)} active rows of"
        f" rank {kkt.rank}, {kkt.curvature}."
    ]
    if len(kkt.active) > kkt.rank:
        kinks = sum(row.one_sided for row in optimisation.sensitivities)
        sides = (
            "every price here is the same upwards and downwards"
            if not kinks
            else f"{kinks} prices differ upwards and downwards"
        )
        parts.append(f"A degenerate vertex, more rows than dimensions they hold: {sides}.")
    if (made := optimisation.made) is not None:
        value = text.value_text(text.metric(optimisation.objective_metric), made.objective_before)
        parts.append(f"Prices are those of the continuous optimum ({value}), before rounding.")
    parts.append(
        "Prices are per unit shown in the limit column; rows are ranked by what ±"
        f"{PER_CENT} % changes when solved; {DASH} under solved: no feasible design found."
    )
    if not all(row.straight(optimisation.objective_value) for row in optimisation.sensitivities):
        parts.append(
            f"~: at ±{PER_CENT} % the price misses more than {round(100 * STRAIGHT)} % of the"
            " change or one end has no design; trust the solved columns."
        )
    return " ".join(parts)


def buys_most(optimisation: Optimisation) -> list[str]:
    """What would buy the most of the objective, and which requirements cannot be tightened."""
    return [text.pretty(line) for line in optimisation.buys_most]


def moves(optimisation: Optimisation) -> Block | None:
    """Which dimensions the optimum moves, per +1 % of each requirement or parameter."""
    variables = {row.path: row for row in optimisation.variables}
    rows: list[list[Cell]] = []
    for row in optimisation.sensitivities:
        found = []
        for path, slope in row.movement.items():
            variable = variables.get(path)
            if variable is None:
                continue
            step = 0.01 * row.limit * slope
            share = step / variable.value if variable.value else 0.0
            found.append((abs(share), path, step, share))
        found = sorted((one for one in found if one[0] > LEAST_MOVE), reverse=True)[:MOVING]
        if not found or len(rows) == MOST_MOVES:
            continue
        words = []
        for _, path, step, share in found:
            quantity = text.input_quantity(variables[path].quantity)
            shown = text.number(
                quantity.to_display(step) - quantity.to_display(0.0), 2, signed=True
            )
            unit = text.unit_text(quantity.unit)
            percent = text.number(100 * share, 2, signed=True)
            words.append(f"{path} {text.with_unit(shown, unit)} ({percent} %)")
        rows.append(
            [
                soft(row.parameter.removeprefix("requirements.")),
                text.with_unit(
                    text.trimmed(abs(0.01 * row.limit) / row.scale, 3), text.unit_text(row.unit)
                ),
                soft(
                    ("" if row.straight(optimisation.objective_value) else "~ ") + ", ".join(words)
                ),
            ]
        )
    if not rows:
        return None
    columns = [
        Column("requirement or parameter", "left", 0.9, mono=True),
        Column("1 % of it", "right"),
        Column("which dimensions move, per +1 %", "left", 3.0),
    ]
    note = (
        f"Derivative of the optimum: the {MOVING} largest movements of the first {MOST_MOVES} rows"
        " that move any; ~ only as far as the price holds."
    )
    return Table("Which dimension moves", columns, rows, note=note)


LEAST_EFFECT = 1e-5
"""Share of the objective below which a row changes nothing worth drawing."""


NO_DESIGN = "no design"
"""What stands where an end has none."""


def drawn(optimisation: Optimisation) -> list[Sensitivity]:
    """The rows worth drawing: ranked as in the table, those without any effect left out."""
    objective = optimisation.objective_value
    least = LEAST_EFFECT * abs(objective)
    rows = [
        row
        for row in optimisation.sensitivities
        if row.effect(objective) > least or any(solved is None for _, _, solved in row.ends)
    ]
    return rows[:MOST]


def tornado_drawing(optimisation: Optimisation) -> Block | None:
    """The tornado with its title, or None where nothing changes anything."""
    rows = drawn(optimisation)
    if not rows:
        return None
    left = len(optimisation.sensitivities) - len(rows)
    rest = f" {left} more change less or nothing." if left else ""
    note = (
        "Bars are solved again, each an optimum of its own; strokes are what the price predicts."
        f" Ranked by the larger bar.{rest}"
    )
    return Drawing(f"What ±{PER_CENT} % of each changes", tornado(optimisation), note)


def tornado(optimisation: Optimisation, *, width: float = 180.0) -> Ink:
    """Bars of the re-solved objective at +10 % (dark) and -10 % (light) of every row.

    A row without a design at an end says so at the right; predictions beyond the frame end at
    it with an arrow.
    """
    objective = optimisation.objective_value
    quantity = text.metric(optimisation.objective_metric)
    factor = quantity.to_display(1.0) - quantity.to_display(0.0)
    rows = [_bar(row, objective, factor) for row in drawn(optimisation)]
    unit = text.unit_text(quantity.unit)
    return bars(
        rows,
        axis=f"change of {quantity.label}" + (f", {unit}" if unit else ""),
        centre=f"optimum {text.value_text(quantity, objective)}",
        ends=(f"+{PER_CENT} %", f"{text.MINUS}{PER_CENT} %"),
        predicted=True,
        width=width,
    )


def _bar(row: Sensitivity, objective: float, factor: float) -> TornadoBar:
    """A price row as a bar."""
    limit = text.with_unit(text.trimmed(display_of(row, row.limit)), text.unit_text(row.unit))
    changes: dict[bool, float | None] = {}
    told: dict[bool, float | None] = {}
    words: dict[bool, str] = {}
    for sign, predicted, solved in row.ends:
        changes[sign > 0] = None if solved is None else factor * (solved - objective)
        seen = predicted is not None and abs(predicted - objective) > LEAST_EFFECT * abs(objective)
        told[sign > 0] = (
            factor * (predicted - objective) if seen and predicted is not None else None
        )
        if solved is None:
            words[sign > 0] = NO_DESIGN
            continue
        share = 100 * (solved - objective) / abs(objective) if objective else None
        said = "" if share is None else f"{text.number(share, 2, signed=True)} %"
        words[sign > 0] = "0" if share is not None and abs(share) < 100 * LEAST_EFFECT else said
    return TornadoBar(
        f"{short_name(row)}  {limit}",
        (changes.get(True), changes.get(False)),
        (words.get(True, ""), words.get(False, "")),
        (told.get(True), told.get(False)),
    )
