"""Blocks of an optimum: variables, choices, sizes, reasons of infeasibility, and robustness."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ..base.quantities import Quantity
from ..design import choice_list, quantity_of
from ..optimisation.infeasibility import percent as change_percent
from ..optimisation.result import (
    Choices,
    Combination,
    Infeasibility,
    Optimisation,
    Rounding,
    VariableResult,
)
from ..rendering import heights, text
from ..rendering.blocks import Block, Cell, Column, Notes, Pair, Slot, Table, soft
from ..rendering.text import DASH, sentence
from .uncertainty import percent

MOST_ROWS = 20
"""Largest number of combinations shown; the JSON output contains all combinations."""
MOST_COLUMNS = 4
"""Up to this number of choices, each has its own column; if there are more, all share one column.
"""
WORTH = 10.0
"""Margins added for scatter are not shown if they exceed this multiple of their limit, as the
design is then far from the limit."""
_KINDS = {
    "dimension": "fixed dimension",
    "number": "fixed number",
    "safety factor": "safety: not advised",
}
"""Clearer words for some kinds of remedy."""


# ---- variables ----


def variables(optimisation: Optimisation) -> Table:
    """Bounds, start and best value of every free dimension."""
    rows: list[list[Cell]] = []
    for row in optimisation.best_variables:
        quantity = text.input_quantity(row.quantity)
        lower, upper, value = (quantity.to_display(v) for v in (row.lower, row.upper, row.value))
        start = None if row.start is None else quantity.to_display(row.start)
        rows.append(
            [
                row.path,
                soft(quantity.label),
                text.trimmed(lower),
                text.number(start),
                text.number(value),
                text.trimmed(upper),
                text.unit_text(quantity.unit),
                Slot(_place(row), row.at_bound or ""),
                "" if row.at_bound is None else f"at {row.at_bound} bound",
            ]
        )
    columns = [
        Column("variable", "left", 1.2, breaks=30, mono=True, least=16),
        Column("dimension", "left", 1.0, on="paper"),
        Column("lower", "right", style="dim"),
        Column("start", "right", drop=2, style="dim"),
        Column(heading(optimisation), "right", strong=True),
        Column("upper", "right", style="dim"),
        Column("unit", style="dim"),
        Column("between bounds", "left", "26mm", drop=1),
        Column("", style="yellow", on="terminal"),
    ]
    at_bounds = sum(row.at_bound is not None for row in optimisation.best_variables)
    note = f"{at_bounds} of {len(rows)} variables are at a bound." if at_bounds else ""
    return Table("Design variables", columns, rows, note=note)


def _place(row: VariableResult) -> float:
    """Position of a value between its bounds, from 0 (lower) to 1 (upper)."""
    return (row.value - row.lower) / (row.upper - row.lower) if row.upper > row.lower else 0.0


def best_values(optimisation: Optimisation, room: float) -> list[Block]:
    """Best values of the variables side by side.

    Only the values that fit into the height `room` [mm] are shown; a note refers to the
    table with all variables.
    """
    best = optimisation.best_variables
    lines = (len(best) + 1) // 2
    most = (room - heights.HEAD - 2 * heights.LINE) / (heights.MARKED * heights.LINE)
    fit = min(lines, math.floor(most))
    if fit < 1:
        return []
    columns = [
        Column("variable", "left", 1.0, breaks=26, mono=True),
        Column(heading(optimisation), "right", strong=True),
        Column("unit"),
        Column("between bounds", "left", "26mm"),
    ]
    rows: list[list[Cell]] = []
    for row in best:
        quantity = text.input_quantity(row.quantity)
        value, unit = text.number(quantity.to_display(row.value)), text.unit_text(quantity.unit)
        rows.append([row.path, value, unit, Slot(_place(row), row.at_bound or "")])
    more = len(best) - 2 * fit
    note = f"{more} more variables, starts and bounds" if more > 0 else "Starts and bounds"
    left = Table(
        "Best values", columns, rows[:fit], note=f"{note}: see table Design variables.", on="paper"
    )
    right = Table("Best values, continued", columns, rows[fit : 2 * fit], on="paper")
    return [Pair([[left], [right]] if right.rows else [[left]])]


def heading(optimisation: Optimisation) -> str:
    """Heading for the column of values: "optimum", "continuous" (before rounding), or the sizes."""
    if optimisation.rounding is None:
        return "optimum"
    return "continuous" if optimisation.made is None else optimisation.made.name


def sizes_and_choices(optimisation: Optimisation) -> Iterator[Block]:
    """Tables of rounding and of choices, as far as requested."""
    if optimisation.rounding is not None:
        yield _rounding_table(optimisation, optimisation.rounding)
    if optimisation.choices is not None:
        yield _choices_table(optimisation, optimisation.choices)


# ---- choices ----


def heads(paths: Sequence[str]) -> list[str]:
    """The shortest endings by which the PATHs can be distinguished, with at least two words each.

    >>> heads(["seals.rod.compound", "seals.piston.compound", "fluid.material"])
    ['rod.compound', 'piston.compound', 'fluid.material']
    """
    endings = []
    for path in paths:
        words = path.split(".")
        tails = (".".join(words[-size:]) for size in range(2, len(words) + 1))
        others = [f".{other}" for other in paths if other != path]
        unique = (tail for tail in tails if not any(o.endswith(f".{tail}") for o in others))
        endings.append(next(unique, path))
    return endings


def choice_notes(optimisation: Optimisation) -> list[str]:
    """Sentences on how combinations were compared, and on the combinations not in the table."""
    choices = optimisation.choices
    if choices is None:
        return []
    lines = [sentence(choices.sentence)]
    if len(choices.combinations) > MOST_ROWS:
        lines.append(f"The best {MOST_ROWS} combinations are shown; the JSON output lists all.")
    if any(tried.cost is not None and tried.cost < 0 for tried in choices.combinations):
        lines.append(
            "A combination with a better objective ranks lower if it misses a check that "
            "other combinations meet."
        )
    return [*lines, *map(sentence, choices.notes)]


def _choices_table(optimisation: Optimisation, choices: Choices) -> Block:
    """Every combination tried, best first, with its cost compared to the best."""
    paths, objective = _varied(choices), text.metric(optimisation.objective_metric)
    names = heads(paths)
    sized = any(tried.rounded is not None for tried in choices.combinations)

    def cells(tried: Combination) -> list[Cell]:
        values = [
            text.pretty(choice_list.shown(path, tried.values[path], optimisation.design))
            for path in paths
        ]
        if len(paths) > MOST_COLUMNS:
            values = [", ".join(f"{n} {v}" for n, v in zip(names, values, strict=True))]
        share = DASH if tried.percent is None else f"{text.number(tried.percent, 3, signed=True)} %"
        numbers = [tried.objective, tried.rounded] if sized else [tried.objective]
        known = [DASH if x is None else text.value_text(objective, x) for x in numbers]
        return [*map(soft, values), *known, share, soft(sentence(tried.status))]

    columns = [
        *(
            Column(head, mono=True)
            for head in (names if len(paths) <= MOST_COLUMNS else ["choices"])
        ),
        Column(objective.label, "right", strong=not sized),
        *([Column("with sizes", "right", strong=True)] if sized else []),
        Column("cost", "right"),
        Column("result", "left", 2.0, least=30),
    ]
    rows = [cells(tried) for tried in choices.combinations[:MOST_ROWS]]
    note = " ".join(choice_notes(optimisation))
    return Table(f"Choices: {chosen(optimisation, choices)}", columns, rows, note=note)


def chosen(optimisation: Optimisation, choices: Choices) -> str:
    """The values of the best combination of choices, each with its name."""
    return ", ".join(
        f"{name} {text.pretty(choice_list.shown(path, value, optimisation.design))}"
        for name, (path, value) in zip(heads(list(choices.best)), choices.best.items(), strict=True)
    )


def _varied(choices: Choices) -> list[str]:
    """PATHs whose value differs between combinations."""
    first = choices.combinations[0].values
    return [
        path
        for path, value in first.items()
        if any(not choice_list.same(tried.values[path], value) for tried in choices.combinations)
    ]


# ---- whole plies and sizes ----


def _rounding_table(optimisation: Optimisation, rounding: Rounding) -> Block:
    """Every variable before and after rounding, the number of plies, and the cost of rounding."""
    counted = any(row.plies is not None for row in rounding.variables)
    rows: list[list[Cell]] = []
    for row in rounding.variables:
        quantity = text.input_quantity(row.quantity)
        change = quantity.to_display(row.value) - quantity.to_display(row.continuous)
        still = abs(row.value - row.continuous) <= 1e-9 * abs(row.value)
        rows.append(
            [
                row.path,
                text.number(quantity.to_display(row.continuous)),
                text.number(quantity.to_display(row.value)),
                DASH if still else text.number(change, 3, signed=True),
                text.unit_text(quantity.unit),
                *(["" if row.plies is None else str(row.plies)] if counted else []),
                (row.sizes or "rounded") if row.discrete else "optimised again",
            ]
        )
    columns = [
        Column("variable", "left", 1.3, breaks=30, mono=True),
        Column("continuous", "right"),
        Column(rounding.name, "right", strong=True),
        Column("change", "right"),
        Column("unit"),
        *([Column("plies", "right")] if counted else []),
        Column("sizes"),
    ]
    note = " ".join(rounding_notes(optimisation))
    return Table(rounding_title(optimisation, rounding), columns, rows, note=note)


def rounding_title(optimisation: Optimisation, rounding: Rounding) -> str:
    """Objective before and after rounding, and the cost of rounding."""
    objective = text.metric(optimisation.objective_metric)
    name = rounding.name.capitalize()
    if rounding.objective_after is None:
        return f"{name}: no design found"
    before = text.value_text(objective, rounding.objective_before, 5)
    after = text.value_text(objective, rounding.objective_after, 5)
    return f"{name}: {objective.label} {before} → {after}, {_cost(objective, rounding)}"


def _cost(objective: Quantity, rounding: Rounding) -> str:
    """Cost of rounding in the unit of the objective and in per cent."""
    if not rounding.cost:
        return "rounding costs nothing"
    per_display = objective.to_display(1.0) - objective.to_display(0.0)
    unit = text.unit_text(objective.unit)
    amount = text.with_unit(text.number(rounding.cost * per_display, 3), unit)
    share = "" if rounding.percent is None else f" ({text.number(rounding.percent, 3)} %)"
    return f"rounding costs {amount}{share}"


def rounding_notes(optimisation: Optimisation) -> list[str]:
    """Sentences on the outcome and effort of rounding, and on the next best designs."""
    rounding = optimisation.rounding
    if rounding is None:
        return []
    objective = text.metric(optimisation.objective_metric)
    lines = [sentence(rounding.sentence), sentence(rounding.remedy)]
    lines.append(
        f"{rounding.tried} rounded designs were tried; {rounding.feasible} of them meet every"
        f" requirement. This took {rounding.solves} re-optimisations."
    )
    for row in rounding.runners_up:
        share = text.number(row.percent, 3, signed=True)
        cost = "" if row.percent is None else f" ({share} %)"
        sizes = _sizes(optimisation, row.values)
        lines.append(f"Next best: {text.value_text(objective, row.objective)}{cost} with {sizes}.")
    for remedy in rounding.remedies:
        change = text.pretty(remedy.sentence).replace("->", "→")
        reached = text.value_text(objective, remedy.objective)
        lines.append(f"With {change}: {reached} with {_sizes(optimisation, remedy.values)}.")
    return [line for line in [*lines, *map(sentence, rounding.notes)] if line]


def _sizes(optimisation: Optimisation, sizes: Mapping[str, float]) -> str:
    """Sizes in words, each with its PATH but without a final ".thickness" or ".angle"."""
    words = []
    for path, value in sizes.items():
        quantity = quantity_of(path, optimisation.design)
        shown = text.trimmed(quantity.to_display(value))
        name = path.removesuffix(".thickness").removesuffix(".angle")
        words.append(f"{name} {text.with_unit(shown, text.unit_text(quantity.unit))}")
    return ", ".join(words)


# ---- why nothing fits ----


def infeasibility_blocks(card: Infeasibility) -> list[Block]:
    """Blocks on an infeasible design: conflicting limits, size of the conflict, and remedies."""
    conflict = text.pretty(sentence(card.sentence)).replace("->", "→")
    blocks: list[Block] = [Notes("Why no design meets all limits", [conflict])]
    if card.joint:
        these = "this" if len(card.joint) == 1 else "all of these together"
        note = (
            f"With {these}, the design shown here meets all limits. The search found no relaxation "
            "with a smaller total."
        )
        if any(entry["safety_factor"] for entry in card.joint):
            note += " This reduces a safety factor, which is not advised."
        rows = [_limit(entry) for entry in card.joint]
        blocks.append(Table("Smallest joint relaxation", _columns("limit"), rows, note=note))
    others = [str(e["parameter"] or e["requirement"]) for e in card.sole if e["needed"] is None]
    words = ""
    if card.cures:
        words = (
            "Each of these changes alone is enough; a smaller change of the same input was not. "
            "The most advisable is first. "
        )
    if others:
        words += f"Not enough alone, however far they are relaxed: {', '.join(others)}. "
    if card.untried:
        words += f"Not tried, to save time: {', '.join(card.untried)}."
    if card.cures:
        rows = [_cure(entry) for entry in card.cures]
        title = "Single changes that are enough"
        blocks.append(Table(title, _columns("what"), rows, note=words.strip()))
    elif words:
        blocks.append(Notes("Single changes that are enough", [words.strip()]))
    if card.bounds:
        blocks.append(_bounds(card))
    if card.evidence:
        blocks.append(Notes("What is proven", [sentence(card.evidence)]))
    return blocks


def _columns(first: str) -> list[Column]:
    return [
        Column(first, "left", 1.3, breaks=24, mono=True),
        Column("kind", "left", 1.3, drop=2),
        Column("now", "right"),
        Column("needed", "right", strong=True),
        Column("change", "right", drop=1),
    ]


def _limit(entry: Mapping[str, Any]) -> list[Cell]:
    """Row of a relaxed limit, with its PATH or the name of its check."""
    origin = str(entry["origin"])
    return [
        str(entry["parameter"] or entry["requirement"]),
        soft(f"{origin}: {entry['requirement']}" if origin == "check list" else origin),
        text.pretty(entry["limit_text"]),
        text.pretty(entry["needed_text"]) or DASH,
        _change(entry["change"]),
    ]


def _cure(entry: Mapping[str, Any]) -> list[Cell]:
    """Row of a single change that is sufficient on its own."""
    return [
        str(entry["parameter"]),
        soft(_KINDS.get(entry["kind"], entry["kind"])),
        text.pretty(entry["limit_text"]),
        text.pretty(entry["needed_text"]),
        _change(entry["change"]),
    ]


def _change(share: float | None) -> str:
    return DASH if share is None else text.pretty(change_percent(share))


def _bounds(card: Infeasibility) -> Block:
    """Bounds on which the relaxed design lies, and the benefit of widening each."""
    columns = [
        Column("bound", "left", 1.3, breaks=24, mono=True),
        Column("now", "right"),
        Column("gap closed by 1 %", "right"),
        Column("enough at", "right", strong=True),
        Column("change", "right", drop=1),
    ]
    rows: list[list[Cell]] = [
        [
            str(bound["parameter"]),
            text.pretty(bound["limit_text"]),
            _closes(bound["gain"], card.total),
            text.pretty(bound["needed_text"]) or DASH,
            _change(bound["change"]),
        ]
        for bound in card.bounds
    ]
    total = DASH if card.total is None else f"{text.number(100 * card.total, 3)} % of their values"
    note = (
        f"Gap: the smallest sum of relaxations of all limits with which a design exists, {total}. "
        "Gap closed by 1 %: share by which this sum falls if the bound is widened by 1 %. "
        f"{DASH}: widening this bound alone led to no design."
    )
    return Table("Bounds that prevent a design", columns, rows, note=note)


def _closes(gain: float, total: float | None) -> str:
    """Share by which the total relaxation needed becomes smaller if a bound is widened by 1 %."""
    return f"{text.number(min(gain / total, 100.0), 2)} %" if total else DASH


# ---- the way to a yield ----


def robust_tables(optimisation: Optimisation) -> Iterator[Table]:
    """Tables of a robust search: successive optima, and the margins added for scatter.

    Empty if the search was not a robust one.
    """
    robust = optimisation.robust
    if robust is None:
        return
    quantity = text.metric(optimisation.objective_metric)
    rounds: list[list[Cell]] = [
        [str(number), text.value_text(quantity, step.objective, 5), percent(step.rate)]
        for number, step in enumerate(robust.rounds)
    ]
    note = (
        "In round 0 no margins are added for scatter. In an independent sample, the design shown "
        f"meets all limits in {percent(robust.rate)} of {robust.samples} draws (95 % confidence: "
        f"{percent(robust.lower)} to {percent(robust.upper)})."
    )
    columns = [Column(head, width=1.0) for head in ("round", quantity.label, "all limits met")]
    title = f"Search for a yield of {percent(robust.target)}"
    yield Table(title, columns, rounds, note=note, on="paper")
    kept: list[list[Cell]] = [
        [soft(name), f"{100 * share:.1f} %"]
        for name, share in sorted(robust.reserves.items(), key=lambda pair: -pair[1])
        if 1e-3 <= share <= WORTH
    ]
    if kept:
        columns = [Column(head, width=1.0) for head in ("limit", "added, of the limit")]
        note = (
            "Added margin: the margin that the nominal design needs so that, with scatter, no more "
            "draws miss this limit than the required yield allows."
        )
        yield Table("Margins added for scatter", columns, kept, note=note, on="paper")


def change_text(optimisation: Optimisation, solved: float | None) -> str:
    """Change of the objective with its unit; "none found" without a design."""
    if solved is None:
        return "none found"
    quantity = text.metric(optimisation.objective_metric)
    change = _per_display(quantity) * (solved - optimisation.objective_value)
    if abs(solved - optimisation.objective_value) <= 1e-6 * abs(optimisation.objective_value):
        change = 0.0
    return text.with_unit(text.number(change, 3, signed=True), text.unit_text(quantity.unit))


def _per_display(quantity: Quantity) -> float:
    return quantity.to_display(1.0) - quantity.to_display(0.0)
