"""What scatter does to a design, as text for the terminal."""

from __future__ import annotations

from collections.abc import Sequence

from ..rendering.console import Column, Console
from ..uncertainties.result import Uncertainty
from . import uncertainty_rows as rows


def uncertainty_text(
    found: Uncertainty, *, colour: bool = False, unicode: bool = True, width: int = 100
) -> str:
    """What `uncertainty` shows: yield, requirements, failing checks, indices, what it means."""
    console = Console(colour, unicode, width)
    name = console.paint(console.say(found.name), "bold")
    parts = [f"{name}\n{console.wrap(rows.what(found))}"]
    for lines in (rows.limits(found), rows.limits(found, checks=True)):
        if lines:
            drops = (0, 3, 0, 1, 2, 0, 0)
            parts.append("\n".join(_table(console, rows.LIMIT_HEADS, lines, drops)))
    for output in rows.followed(found):
        lines = rows.indices(found, output)
        if lines:
            head = console.heading(rows.heading(found, output))
            parts.append(
                "\n".join([head, *_table(console, rows.INDEX_HEADS, lines, (0, 0, 0, 1, 1))])
            )
    heads = rows.INPUT_HEADS
    parts.append("\n".join(_table(console, heads, rows.inputs(found), (0, 0, 0, 0, 2, 1))))
    parts.append("\n".join(console.wrap(words, "dim") for words in rows.remarks(found)))
    return "\n\n".join(parts) + "\n"


def _table(
    console: Console, heads: Sequence[str], lines: Sequence[rows.Line], drops: Sequence[int]
) -> list[str]:
    left = ("distribution", "from", "")
    columns = [
        Column(
            head,
            "left" if k == 0 or head in left else "right",
            flexible=k == 0 or head == "from",
            drop=drops[k],
            least=34 if head == "input" else 16,
        )
        for k, head in enumerate(heads)
    ]
    paint = {"met": "green", "missed": "red", "": ""}
    styles = [[""] * (len(heads) - 2) + [paint[line.state], ""] for line in lines]
    return console.table(columns, [list(line.cells) for line in lines], styles)
