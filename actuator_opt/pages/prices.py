"""Prices of requirements and parameters: tornado, table, and changes of the optimal dimensions."""

from __future__ import annotations

from collections.abc import Sequence

from ..base.quantities import Quantity
from ..evaluation.result import Requirement
from ..optimisation.price_table import PER_CENT, STRAIGHT, Sensitivity, display_of, short_name
from ..optimisation.result import Optimisation
from ..rendering import text
from ..rendering.blocks import (
    AttachedFile,
    Block,
    Cell,
    Column,
    Drawing,
    Medium,
    Notes,
    Reach,
    Table,
    soft,
)
from ..rendering.ink import Ink
from ..rendering.text import DASH
from ..rendering.tornado import MOST, TornadoBar, bars

MOVING = 3
"""Largest number of dimensions named in each row of the table of changed dimensions."""
MOST_MOVES = 8
"""Largest number of rows in the table of changed dimensions."""
LEAST_MOVE = 1e-4
"""Relative change per +1 % below which a dimension counts as unchanged."""
LEAST_EFFECT = 1e-5
"""Smallest change of the objective that is drawn, as a share of the objective."""
NO_DESIGN = "no design"
"""Words beside a bar if no feasible design exists for the changed limit or parameter."""


def price_blocks(optimisation: Optimisation, *, moving: bool = False) -> list[Block]:
    """Blocks on prices: tornado chart, table, most valuable changes, and changes of dimensions.

    `moving`: the terminal also shows the changes of dimensions.
    """
    if not optimisation.sensitivities:
        return []
    buys_most = [text.pretty(line) for line in optimisation.buys_most]
    blocks: list[Block | None] = [
        _tornado_block(optimisation),
        sensitivities(optimisation),
        Notes("What would buy the most", buys_most),
        moves(optimisation, shown=moving),
    ]
    return [block for block in blocks if block is not None]


def attached_blocks(attached: Sequence[AttachedFile]) -> list[Block]:
    """Block that names the files attached to the report, besides its input."""
    if not attached:
        return []
    how = "To open it, save it from the attachments of this PDF (paper clip)."
    lines = [f"{file.name}: {file.about}. {how}" for file in attached]
    return [Notes("Attached to this PDF", lines, on="paper")]


# ---- prices ----


def _value(row: Sensitivity, limit: Requirement) -> str:
    """Result at a limit in the unit of its parameter; a torque by a lever arm limits a force."""
    if row.parameter.endswith(".joint_torque") and limit.metric != "joint_torque_min":
        return text.value_text(text.metric(limit.metric), limit.value)
    return text.number(display_of(row, limit.value))


def sensitivities(optimisation: Optimisation) -> Table:
    """Table of the price of every limit and parameter, checked by re-optimising at ±10 %."""
    objective = text.metric(optimisation.objective_metric)
    required = {row.path: row for row in optimisation.evaluation.requirements}
    rows: list[list[Cell]] = []
    for row in optimisation.sensitivities:
        limit, unit = required.get(row.parameter), text.unit_text(row.unit)
        solved = [text.number(text.display(objective, v)) for end in row.ends for v in end[1:]]
        rows.append(
            [
                row.parameter.removeprefix("requirements."),
                text.with_unit(text.trimmed(display_of(row, row.limit)), unit),
                DASH if limit is None else _value(row, limit),
                DASH if limit is None else _margin(limit),
                "●" if row.active else "",
                _price(optimisation, row, objective),
                text.number(row.percent_per_percent, 3, signed=True),
                *(solved or [""] * 4),
                Reach(_reach(row), met=row.straight(optimisation.objective_value)),
                text.with_unit(text.trimmed(display_of(row, row.holds_until)), unit),
                _next_active(row),
            ]
        )
    unit = text.unit_text(objective.unit) or objective.name
    low, high = f"{text.MINUS}{PER_CENT} %", f"+{PER_CENT} %"
    columns = [
        Column("requirement or parameter", "left", 1.0, breaks=22, mono=True, least=30),
        Column("limit", "right"),
        Column("value", "right", drop=5, style="dim"),
        Column("margin", "right", drop=4, style="dim"),
        Column("act.", "center", style="yellow"),
        Column(f"{unit}/unit", "right"),
        Column("%/%", "right"),
        Column(f"at\n{high}", "right", drop=3, style="dim"),
        Column("+\nsolved", "right", strong=True),
        Column(f"at\n{low}", "right", drop=3, style="dim"),
        Column(f"{text.MINUS}\nsolved", "right", strong=True),
        Column(f"holds until\n(ticks: ±{PER_CENT} %)", "left", "24mm", on="paper"),
        Column("holds\nuntil", "right", drop=1, on="terminal"),
        Column("then", "left", 1.0, drop=2, style="dim", on="terminal"),
    ]
    title = f"What each requirement costs ({objective.label}, {unit})"
    return Table(title, columns, rows, note=quality(optimisation))


def _margin(limit: Requirement) -> str:
    quantity = text.metric(limit.metric)
    return text.margin_of(quantity, limit.limit, limit.margin, met=limit.met)


def _price(optimisation: Optimisation, row: Sensitivity, objective: Quantity) -> Cell:
    """The price per displayed unit; if an increase and a decrease have different prices, both.

    "~" marks a price that predicts the changes at ±10 % badly.
    """
    factor = row.scale * (objective.to_display(1.0) - objective.to_display(0.0))

    def shown(price: float | None) -> str:
        return "∞" if price is None else text.number(price * factor, 3, signed=True)

    mark = "" if row.straight(optimisation.objective_value) else "~ "
    if row.one_sided:
        return [f"{mark}{shown(row.price_up)} up, ", f"{shown(row.price_down)} down"]
    return mark + shown(row.price)


def _reach(row: Sensitivity) -> float | None:
    """Relative change of a limit or parameter at which other limits become active.

    None if it is beyond ±100 %.
    """
    if row.holds_until is None or not row.limit:
        return None
    return row.holds_until / row.limit - 1


def _next_active(row: Sensitivity) -> str:
    """The limit with which a price changes at the end of its range, or without which."""
    if row.next_active is None:
        return ""
    gone = row.next_active.removesuffix(" stops being active")
    words = "with" if gone == row.next_active else "without"
    return f"{words} {gone.removesuffix(' becomes active')}"


def quality(optimisation: Optimisation) -> str:
    """Line below the prices on how accurate they are."""
    kkt = optimisation.kkt
    if kkt is None:
        return "Quality: prices are not exact, because the design is not an optimum."
    parts = [
        f"Quality: KKT residual {text.number(kkt.residual, 2)}, {len(kkt.active)} active limits "
        f"of rank {kkt.rank}, {kkt.curvature}."
    ]
    if len(kkt.active) > kkt.rank:
        kinks = sum(row.one_sided for row in optimisation.sensitivities)
        sides = (
            "every price here is the same for an increase and a decrease"
            if not kinks
            else f"{kinks} prices differ between an increase and a decrease"
        )
        parts.append(f"Degenerate optimum (more active limits than independent ones): {sides}.")
    if (made := optimisation.made) is not None:
        value = text.value_text(text.metric(optimisation.objective_metric), made.objective_before)
        parts.append(f"Prices are those of the continuous optimum ({value}), before rounding.")
    parts.append(
        'Price: change of the objective per unit of the value under "limit". '
        f"At ±{PER_CENT} %: the objective that the price predicts, then the objective of the new "
        "optimum (solved), by which the rows are ranked. "
        f"{DASH}: no design found. Holds until: the nearest value, higher or lower, "
        "at which the active limits change."
    )
    if not all(row.straight(optimisation.objective_value) for row in optimisation.sensitivities):
        parts.append(
            f"~: the change predicted for ±{PER_CENT} % is wrong by more than "
            f"{round(100 * STRAIGHT)} %, or no design was found on one side; trust the columns "
            '"solved".'
        )
    return " ".join(parts)


# ---- movements ----


def moves(optimisation: Optimisation, *, shown: bool = False) -> Block | None:
    """Change of the optimum's dimensions per +1 % of each requirement or parameter.

    `shown`: the terminal shows the table too.
    """
    variables = {row.path: row for row in optimisation.variables}
    rows: list[list[Cell]] = []
    for row in optimisation.sensitivities:
        changes = []
        for path, slope in row.movement.items():
            variable = variables.get(path)
            if variable is None:
                continue
            step = 0.01 * row.limit * slope
            share = step / variable.value if variable.value else 0.0
            changes.append((abs(share), path, step, share))
        changes = sorted((x for x in changes if x[0] > LEAST_MOVE), reverse=True)[:MOVING]
        if not changes or len(rows) == MOST_MOVES:
            continue
        words = []
        for _, path, step, share in changes:
            quantity = text.input_quantity(variables[path].quantity)
            amount = text.number(
                quantity.to_display(step) - quantity.to_display(0.0), 2, signed=True
            )
            unit = text.unit_text(quantity.unit)
            percent = text.number(100 * share, 2, signed=True)
            words.append(f"{path} {text.with_unit(amount, unit)} ({percent} %)")
        rows.append(
            [
                row.parameter.removeprefix("requirements."),
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
        Column("requirement or parameter", "left", 0.9, breaks=24, mono=True),
        Column("1 % of it", "right"),
        Column("which dimensions move, per +1 %", "left", 3.0),
    ]
    note = (
        f"Derivatives of the optimum: the {MOVING} largest relative changes of dimensions in each "
        f"row, for the first {MOST_MOVES} rows with any change; ~: valid only for small changes."
    )
    on: Medium = "both" if shown else "paper"
    return Table("Which dimension moves", columns, rows, note=note, on=on)


# ---- tornado ----


def drawn(optimisation: Optimisation) -> list[Sensitivity]:
    """Limits and parameters with an effect, ranked as in the table."""
    objective = optimisation.objective_value
    least = LEAST_EFFECT * abs(objective)
    rows = [
        row
        for row in optimisation.sensitivities
        if row.effect(objective) > least or any(solved is None for _, _, solved in row.ends)
    ]
    return rows[:MOST]


def _tornado_block(optimisation: Optimisation) -> Block | None:
    """The tornado chart with its title; None if no limit or parameter has an effect."""
    rows = drawn(optimisation)
    if not rows:
        return None
    left = len(optimisation.sensitivities) - len(rows)
    more = f" {left} more have a smaller effect or none." if left else ""
    note = (
        "Bars: change of the objective after re-optimisation; tick marks: change that the price "
        f"predicts. Ranked by the longer bar.{more}"
    )
    return Drawing(f"Effect of ±{PER_CENT} % of each", tornado(optimisation), note)


def tornado(optimisation: Optimisation, *, width: float = 180.0) -> Ink:
    """Tornado chart: change of the re-optimised objective at +10 % (dark) and -10 % (light).

    If no design exists for a change, words at the right end of the row report this. A prediction
    beyond the frame ends at the frame with an arrow.
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
    """A limit or parameter as a bar of the tornado chart."""
    limit = text.with_unit(text.trimmed(display_of(row, row.limit)), text.unit_text(row.unit))
    changes: dict[bool, float | None] = {}
    predictions: dict[bool, float | None] = {}
    words: dict[bool, str] = {}
    for sign, predicted, solved in row.ends:
        changes[sign > 0] = None if solved is None else factor * (solved - objective)
        seen = predicted is not None and abs(predicted - objective) > LEAST_EFFECT * abs(objective)
        predictions[sign > 0] = (
            factor * (predicted - objective) if seen and predicted is not None else None
        )
        if solved is None:
            words[sign > 0] = NO_DESIGN
            continue
        share = 100 * (solved - objective) / abs(objective) if objective else None
        percent = "" if share is None else f"{text.number(share, 2, signed=True)} %"
        words[sign > 0] = "0" if share is not None and abs(share) < 100 * LEAST_EFFECT else percent
    return TornadoBar(
        f"{short_name(row)}  {limit}",
        (changes.get(True), changes.get(False)),
        (words.get(True, ""), words.get(False, "")),
        (predictions.get(True), predictions.get(False)),
    )
