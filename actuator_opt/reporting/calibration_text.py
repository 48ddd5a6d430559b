"""A calibration as text for the terminal."""

from __future__ import annotations

from collections.abc import Sequence

from ..identification.calibration import Calibration
from ..optimisation.redesign import Redesign
from . import calibration_rows as rows
from .console import Column, Console


def calibration_text(
    found: Calibration,
    changes: Redesign,
    *,
    colour: bool = False,
    unicode: bool = True,
    width: int = 100,
) -> str:
    """What `calibrate` shows: numbers learned, requirements moved, the best design, doubts."""
    console = Console(colour, unicode, width)
    name = console.paint(console.say(found.identification.bench.design.name), "bold")
    parts = [f"{name}\n{console.wrap(rows.what(found), 'dim')}"]
    for heads, lines in (
        (rows.LEARNED_HEADS, rows.learned(found)),
        (rows.SHIFT_HEADS, rows.shifts(changes)),
        (rows.OPTIMUM_HEADS, rows.optimum(changes)),
    ):
        if lines:
            parts.append("\n".join(_table(console, heads, lines)))
    said = rows.remarks(found, changes)
    parts.append("\n".join(console.wrap(words) for words in said))
    return "\n\n".join(parts) + "\n"


def _table(console: Console, heads: Sequence[str], lines: Sequence[rows.Line]) -> list[str]:
    last = len(heads) - 1
    columns = [
        Column(
            head,
            "left" if (k in (0, last) and len(heads) > 4) or k == 0 else "right",
            flexible=k == 0,
            drop={last: 3, last - 1: 2, last - 2: 1}.get(k, 0) if len(heads) > 4 else 0,
            least=24,
        )
        for k, head in enumerate(heads)
    ]
    paint = {"met": "green", "missed": "red", "": ""}
    styles = [[""] * last + [paint[line.state]] for line in lines]
    return console.table(columns, [list(line.cells) for line in lines], styles)
