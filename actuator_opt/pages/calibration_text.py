"""A calibration as text for the terminal."""

from __future__ import annotations

from collections.abc import Sequence

from ..identification.calibration import Calibration
from ..optimisation.redesign import Redesign
from ..rendering.blocks import Column
from ..rendering.console import Console
from . import calibration_rows as rows


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
    for heads, lines, drops in (
        (rows.LEARNED_HEADS, rows.learned(found), (0, 1, 0, 3, 2, 4)),
        (rows.SHIFT_HEADS, rows.shifts(changes), (0, 2, 1, 0, 5, 4, 3)),
        (rows.OPTIMUM_HEADS, rows.optimum(changes), (0, 1, 0, 2)),
    ):
        if lines:
            parts.append("\n".join(_table(console, heads, lines, drops)))
    said = rows.remarks(found, changes)
    parts.append("\n".join(console.wrap(words) for words in said))
    return "\n\n".join(parts) + "\n"


def _table(
    console: Console, heads: Sequence[str], lines: Sequence[rows.Line], drops: Sequence[int]
) -> list[str]:
    """A table whose columns leave a narrow terminal in the order of `drops`, the highest first."""
    last = len(heads) - 1
    words = ("from", "verdict")
    columns = [
        Column(
            head,
            "left" if k == 0 or head in words else "right",
            width=1.0 if k == 0 else "auto",
            drop=drops[k],
            least=20,
        )
        for k, head in enumerate(heads)
    ]
    paint = {"met": "green", "no_reserve": "yellow", "missed": "red", "": ""}
    styles = [[""] * last + [paint[line.state]] for line in lines]
    return console.table(columns, [list(line.cells) for line in lines], styles)
