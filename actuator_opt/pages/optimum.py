"""The tables of an optimisation: variables, prices with their quality, how it went, why not."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..base.quantities import Quantity
from ..design import choice_list, quantity_of
from ..evaluation.result import Evaluation
from ..optimisation.infeasibility_card import percent
from ..optimisation.result import Choices, Combination, Infeasibility, Optimisation, Rounding
from ..rendering import text
from ..rendering.blocks import Block, Cell, Column, ExtraTable, Notes, Slot, Table, clean, soft
from ..rendering.console import Console
from ..rendering.terminal import block_text
from ..rendering.text import DASH, sentence
from .uncertainty import percent


def variables(optimisation: Optimisation) -> Block:
    """Bounds, start and best value of every free dimension."""
    rows: list[list[Cell]] = []
    for row in optimisation.best_variables:
        quantity = text.input_quantity(row.quantity)
        lower, upper, value = (quantity.to_display(v) for v in (row.lower, row.upper, row.value))
        start = None if row.start is None else quantity.to_display(row.start)
        place = (value - lower) / (upper - lower) if upper > lower else 0.0
        bound = "" if row.at_bound is None else f"at {row.at_bound} bound"
        rows.append(
            [
                soft(row.path),
                clean(quantity.label),
                text.trimmed(lower),
                text.number(start),
                text.number(value),
                text.trimmed(upper),
                text.unit_text(quantity.unit),
                Slot(place, row.at_bound or ""),
                bound,
            ]
        )
    columns = [
        Column("variable", "left", 1.3, mono=True),
        Column("dimension", "left", 1.1),
        Column("lower", "right"),
        Column("start", "right"),
        Column(heading(optimisation).replace(" ", "\n"), "right", strong=True),
        Column("upper", "right"),
        Column("unit"),
        Column("between bounds", "left", "26mm"),
        Column(""),
    ]
    held = [row.path for row in optimisation.best_variables if row.at_bound]
    note = f"{len(held)} of {len(rows)} variables are at a bound." if held else ""
    return Table("Design variables", columns, rows, note=note)


def heading(optimisation: Optimisation) -> str:
    """What the values shown are: the optimum, or the sizes asked for."""
    if optimisation.rounding is None:
        return "optimum"
    return "continuous" if optimisation.made is None else optimisation.made.name


MOST_ROWS = {"report": 40, "terminal": 12}
"""Combinations shown; JSON has them all."""


MOST_COLUMNS = 4
"""PATHs that get a column each; of more, the values share one."""


def heads(paths: Sequence[str]) -> list[str]:
    """The shortest endings of PATHs, of two words at least, that tell them apart.

    >>> heads(["seals.rod.compound", "seals.piston.compound", "fluid.material"])
    ['rod.compound', 'piston.compound', 'fluid.material']
    """
    found = []
    for path in paths:
        words = path.split(".")
        tails = (".".join(words[-size:]) for size in range(2, len(words) + 1))
        others = [f".{other}" for other in paths if other != path]
        unique = (tail for tail in tails if not any(o.endswith(f".{tail}") for o in others))
        found.append(next(unique, path))
    return found


def _varied(choices: Choices) -> list[str]:
    """PATHs whose value is not the same in every combination."""
    first = choices.combinations[0].values
    return [
        path
        for path, value in first.items()
        if any(not choice_list.same(one.values[path], value) for one in choices.combinations)
    ]


def _choice_rows(optimisation: Optimisation, choices: Choices, most: int) -> list[list[str]]:
    """Values, objective, what it costs, and what became of it, of each combination."""
    paths, objective = _varied(choices), text.metric(optimisation.objective_metric)
    names = heads(paths)

    def cells(one: Combination) -> list[str]:
        values = [
            text.pretty(choice_list.shown(path, one.values[path], optimisation.design))
            for path in paths
        ]
        if len(paths) > MOST_COLUMNS:
            values = [", ".join(f"{n} {v}" for n, v in zip(names, values, strict=True))]
        share = DASH if one.percent is None else f"{text.number(one.percent, 3, signed=True)} %"
        numbers = [one.objective, one.rounded] if sized(choices) else [one.objective]
        known = [DASH if x is None else text.value_text(objective, x) for x in numbers]
        return [*values, *known, share, sentence(one.status)]

    return [cells(one) for one in choices.combinations[:most]]


def sized(choices: Choices) -> bool:
    """Whether variables keep to listed sizes in some combination."""
    return any(one.rounded is not None for one in choices.combinations)


def _value_heads(choices: Choices) -> list[str]:
    paths = _varied(choices)
    return heads(paths) if len(paths) <= MOST_COLUMNS else ["choices"]


def _choices_title(optimisation: Optimisation, choices: Choices) -> str:
    names, values = heads(list(choices.best)), choices.best.items()
    chosen = ", ".join(
        f"{name} {text.pretty(choice_list.shown(path, value, optimisation.design))}"
        for name, (path, value) in zip(names, values, strict=True)
    )
    return f"Choices: {chosen}"


def choice_notes(optimisation: Optimisation, most: int) -> list[str]:
    """How the combinations were looked into, and what is not in the table, in sentences."""
    choices = optimisation.choices
    if choices is None:
        return []
    lines = [sentence(choices.sentence)]
    if len(choices.combinations) > most:
        lines.append(f"The best {most} are shown; JSON has all.")
    if any(one.cost is not None and one.cost < 0 for one in choices.combinations):
        lines.append("A better objective with a check missed that other choices meet ranks lower.")
    return [*lines, *map(sentence, choices.notes)]


def choices(optimisation: Optimisation) -> Block | None:
    """The combinations with objective and cost; None where there is nothing to choose."""
    choices, most = optimisation.choices, MOST_ROWS["report"]
    if choices is None:
        return None
    named = len(_value_heads(choices))
    rows: list[list[Cell]] = [
        [*map(soft, row[:named]), *row[named:-1], soft(row[-1])]
        for row in _choice_rows(optimisation, choices, most)
    ]
    label = text.metric(optimisation.objective_metric).label
    columns = [
        *(Column(head, "left", mono=True) for head in _value_heads(choices)),
        Column(label, "right", strong=not sized(choices)),
        *([Column("with sizes", "right", strong=True)] if sized(choices) else []),
        Column("cost", "right"),
        Column("what became of it", "left", 2.0),
    ]
    note = " ".join(choice_notes(optimisation, most))
    return Table(_choices_title(optimisation, choices), columns, rows, note=note)


def choices_terminal(
    optimisation: Optimisation, *, colour: bool = False, unicode: bool = True, width: int = 100
) -> str:
    """The same for the terminal; empty where there is nothing to choose."""
    choices, most = optimisation.choices, MOST_ROWS["terminal"]
    if choices is None:
        return ""
    console = Console(colour, unicode, width)
    columns = [
        *(Column(head, width=1.0) for head in _value_heads(choices)),
        Column(optimisation.objective_metric, "right"),
        *([Column("with sizes", "right")] if sized(choices) else []),
        Column("cost", "right"),
        Column("what became of it", width=1.0, least=30),
    ]
    rows = _choice_rows(optimisation, choices, most)
    styles = [["bold" if index == 0 else ""] * len(columns) for index in range(len(rows))]
    lines = [console.wrap(_choices_title(optimisation, choices), "bold")]
    lines += console.table(columns, rows, styles)
    return "\n".join(
        [*lines, *(console.wrap(line, "dim") for line in choice_notes(optimisation, most))]
    )


def rounding(optimisation: Optimisation) -> Block | None:
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
    note = " ".join(rounding_notes(optimisation))
    return Table(_rounding_title(optimisation, rounding), columns, rows, note=note)


def rounding_terminal(
    optimisation: Optimisation, *, colour: bool = False, unicode: bool = True, width: int = 100
) -> str:
    """The same for the terminal; empty where no rounding was asked for."""
    made = _ROUND(optimisation)
    if made is None:
        return ""
    console = Console(colour, unicode, width)
    lines = [block_text(made, console)]
    return "\n".join(
        [*lines, *(console.wrap(line, "dim") for line in rounding_notes(optimisation))]
    )


def _rounding_title(optimisation: Optimisation, rounding: Rounding) -> str:
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


def rounding_notes(optimisation: Optimisation) -> list[str]:
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


def infeasibility_terminal(
    subject: Optimisation, *, colour: bool = False, unicode: bool = True, width: int = 100
) -> str:
    """Why nothing fits; empty where something does."""
    console = Console(colour, unicode, width)
    if subject.infeasibility is None:
        return ""
    return "\n\n".join(
        block_text(block, console) for block in infeasibility_blocks(subject.infeasibility)
    )


def infeasibility_blocks(card: Infeasibility) -> list[Block]:
    """The card of an infeasible design: what conflicts, by how much, what would repair it."""
    found: list[Block] = [Notes("Why nothing fits", [_arrows(card.sentence)])]
    if card.joint:
        these = "this" if len(card.joint) == 1 else "all of these together"
        note = f"With {these} a design exists: the one shown here. No smaller sum was found."
        if any(entry["safety_factor"] for entry in card.joint):
            note += " It weakens a safety factor, which is not advised."
        found.append(Table("Smallest joint relaxation", *_limits(card.joint), note=note))
    others = [str(e["parameter"] or e["requirement"]) for e in card.sole if e["needed"] is None]
    words = ""
    if card.cures:
        words = "Any one line alone is enough, the most advisable first; less of it was not. "
    if others:
        words += f"Not enough alone, however far it is relaxed: {', '.join(others)}. "
    if card.untried:
        words += f"Not tried, for the time it takes: {', '.join(card.untried)}."
    if card.cures:
        found.append(Table("What is enough alone", *_cures(card.cures), note=words.strip()))
    elif words:
        found.append(Notes("What is enough alone", [words.strip()]))
    if card.bounds:
        found.append(_bounds(card))
    if card.evidence:
        found.append(Notes("What is proven", [sentence(card.evidence)]))
    return found


def _arrows(words: str) -> str:
    return text.pretty(sentence(words)).replace("->", "→")


def _columns(first: str) -> list[Column]:
    return [
        Column(first, "left", 1.3, mono=True),
        Column("stands for", "left", 1.3, drop=2),
        Column("now", "right"),
        Column("needed", "right", strong=True),
        Column("change", "right", drop=1),
    ]


def _limits(entries: Sequence[Mapping[str, Any]]) -> tuple[list[Column], list[list[Cell]]]:
    """Columns and rows of limits that give way."""
    rows: list[list[Cell]] = [
        [
            soft(entry["parameter"] or entry["requirement"]),
            soft(_origin(entry)),
            text.pretty(entry["limit_text"]),
            text.pretty(entry["needed_text"]) or DASH,
            _change(entry["change"]),
        ]
        for entry in entries
    ]
    return _columns("limit"), rows


def _cures(entries: Sequence[Mapping[str, Any]]) -> tuple[list[Column], list[list[Cell]]]:
    """Columns and rows of what is enough alone."""
    rows: list[list[Cell]] = [
        [
            soft(entry["parameter"]),
            soft(_STANDS_FOR.get(entry["kind"], entry["kind"])),
            text.pretty(entry["limit_text"]),
            text.pretty(entry["needed_text"]),
            _change(entry["change"]),
        ]
        for entry in entries
    ]
    return _columns("what"), rows


_STANDS_FOR = {"dimension": "fixed dimension", "safety factor": "safety: not advised"}
"""Words of a kind of cure, where they say more."""


def _origin(entry: Mapping[str, Any]) -> str:
    """Who asks for a limit; a line of the check list by its name."""
    origin = str(entry["origin"])
    return f"{origin}: {entry['requirement']}" if origin == "check list" else origin


def _change(share: float | None) -> str:
    return DASH if share is None else text.pretty(percent(share))


def _bounds(card: Infeasibility) -> Block:
    """Bounds that the relaxed design stands at: what opening them helps."""
    columns = [
        Column("bound", "left", 1.3, mono=True),
        Column("now", "right"),
        Column("gap closed by 1 %", "right"),
        Column("enough at", "right", strong=True),
        Column("change", "right", drop=1),
    ]
    rows: list[list[Cell]] = [
        [
            soft(bound["parameter"]),
            text.pretty(bound["limit_text"]),
            _closes(bound["gain"], card.total),
            text.pretty(bound["needed_text"]) or DASH,
            _change(bound["change"]),
        ]
        for bound in card.bounds
    ]
    total = DASH if card.total is None else f"{text.number(100 * card.total, 3)} % of the limits"
    note = (
        f"The gap is what the joint relaxation gives up in sum, {total}; 1 % more room closes this"
        f" much of it, to begin with. {DASH}: no design found by opening this bound alone."
    )
    return Table("Bounds in the way", columns, rows, note=note)


def _closes(gain: float, total: float | None) -> str:
    """Share of the gap that 1 % more room closes."""
    return f"{text.number(min(gain / total, 100.0), 2)} %" if total else DASH


WORTH = 10.0
"""Reserves beyond this many times the limit say only that the limit is far away."""


def robust_tables(subject: Evaluation | Optimisation) -> list[ExtraTable]:
    """Optima on the way and reserves; none of a plain optimum."""
    found = subject.robust if isinstance(subject, Optimisation) else None
    if found is None or not isinstance(subject, Optimisation):
        return []
    quantity = text.metric(subject.objective_metric)
    way = [
        [str(number), text.value_text(quantity, one.objective, 5), percent(one.rate)]
        for number, one in enumerate(found.rounds)
    ]
    kept = [
        [name, f"{100 * reserve:.1f} %"]
        for name, reserve in sorted(found.reserves.items(), key=lambda pair: -pair[1])
        if 1e-3 <= reserve <= WORTH
    ]
    asked = percent(found.target)
    rounds = ExtraTable(
        f"Towards a yield of {asked}",
        ("round", quantity.label, "all limits hold"),
        way,
        f"Round 0 has no reserves. An independent sample of {found.samples} draws at the design "
        f"shown: {percent(found.rate)} ({percent(found.lower)} to {percent(found.upper)}).",
    )
    reserves = ExtraTable(
        "Reserves kept beyond limits",
        ("limit", "reserve, of the limit"),
        kept,
        "The distance from the margin of the design to the margin that a draw falls below with "
        "the probability allowed to a single limit.",
    )
    return [rounds, reserves] if kept else [rounds]
