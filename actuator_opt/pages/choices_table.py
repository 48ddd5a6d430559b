"""The table of the choices: every combination tried, the best first, and what the others cost."""

from __future__ import annotations

from collections.abc import Sequence

from ..design import choice_list
from ..optimisation.result import Choices, Combination, Optimisation
from ..rendering import text
from ..rendering.blocks import Block, Cell, Column, Table, soft
from ..rendering.console import Console
from ..rendering.text import DASH
from .optimum import sentence

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


def _rows(optimisation: Optimisation, choices: Choices, most: int) -> list[list[str]]:
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


def _title(optimisation: Optimisation, choices: Choices) -> str:
    names, values = heads(list(choices.best)), choices.best.items()
    chosen = ", ".join(
        f"{name} {text.pretty(choice_list.shown(path, value, optimisation.design))}"
        for name, (path, value) in zip(names, values, strict=True)
    )
    return f"Choices: {chosen}"


def notes(optimisation: Optimisation, most: int) -> list[str]:
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


def block(optimisation: Optimisation) -> Block | None:
    """The combinations with objective and cost; None where there is nothing to choose."""
    choices, most = optimisation.choices, MOST_ROWS["report"]
    if choices is None:
        return None
    named = len(_value_heads(choices))
    rows: list[list[Cell]] = [
        [*map(soft, row[:named]), *row[named:-1], soft(row[-1])]
        for row in _rows(optimisation, choices, most)
    ]
    label = text.metric(optimisation.objective_metric).label
    columns = [
        *(Column(head, "left", mono=True) for head in _value_heads(choices)),
        Column(label, "right", strong=not sized(choices)),
        *([Column("with sizes", "right", strong=True)] if sized(choices) else []),
        Column("cost", "right"),
        Column("what became of it", "left", 2.0),
    ]
    note = " ".join(notes(optimisation, most))
    return Table(_title(optimisation, choices), columns, rows, note=note)


def terminal(
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
    rows = _rows(optimisation, choices, most)
    styles = [["bold" if index == 0 else ""] * len(columns) for index in range(len(rows))]
    lines = [console.wrap(_title(optimisation, choices), "bold")]
    lines += console.table(columns, rows, styles)
    return "\n".join([*lines, *(console.wrap(line, "dim") for line in notes(optimisation, most))])
