"""Requirements checked in time, and sensitive parameters, as text for the terminal."""

from __future__ import annotations

from ..rendering.blocks import Column
from ..rendering.console import Console
from ..rendering.text import pretty, sentence
from ..simulation.sensitivity import Sensitivities
from ..simulation.verification import Verification
from . import verification_rows as rows
from .simulation_words import tied

_SIGNS = {
    "met": ("✔", "+", "green"),
    "missed": ("✘", "x", "red"),
    "not_checked": ("○", "o", "yellow"),
}


def verification_text(
    found: Verification, *, colour: bool = False, unicode: bool = True, width: int = 100
) -> str:
    """What `--verify-dynamics` shows: both tiers of every requirement, then each experiment."""
    console = Console(colour, unicode, width)
    parts = [console.heading("dynamic requirements in time")]
    lines = [rows.line(row) for row in found.rows]
    if lines:
        columns = [Column(""), Column(rows.HEADS[0], width=1.0, least=20)]
        columns += [
            Column(name, "right", drop=drop)
            for name, drop in zip(rows.HEADS[1:], (2, 3, 0, 0, 1, 4), strict=True)
        ]
        body, styles = [], []
        for one in lines:
            sign, plain, paint = _SIGNS[one.state]
            body.append([sign if unicode else plain, *one.cells])
            styles.append([paint, "", "dim", "dim", "", "bold", "", paint])
        parts.append("\n".join(console.table(columns, body, styles)))
    parts.append(console.wrap(rows.verdict(found)))
    parts += [
        console.wrap(_tied(f"{sentence(one.cells[0])[:-1]}: {one.said}", unicode), "dim")
        for one in lines
        if one.said
    ]
    notes = [rows.MEANING, *(sentence(pretty(words)) for words in found.notes)]
    parts.append(console.wrap(" ".join([*notes, rows.effort(found)]), "dim"))
    return "\n\n".join(parts) + "\n"


def _tied(words: str, unicode: bool) -> str:
    """A number stays on the line of its unit, where the terminal has such a space."""
    return tied(words) if unicode else words


def sensitivity_text(
    found: Sensitivities, *, colour: bool = False, unicode: bool = True, width: int = 100
) -> str:
    """Parameters ranked by their largest effect on a result."""
    console = Console(colour, unicode, width)
    parts = [console.heading(f"sensitive parameters: {found.name}")]
    results = rows.shown_results(found)
    if results:
        columns = [
            Column("parameter", width=1.0, least=24),
            Column("value", "right", drop=len(results) + 1),
            Column("for", "right", drop=len(results) + 2),
        ]
        columns += [
            Column(f"{rows.head(name)}, %", "right", drop=k) for k, name in enumerate(results)
        ]
        body = [list(rows.cells(one, results)) for one in found.parameters]
        styles = [["", "dim", "dim", *[""] * len(results)]] * len(body)
        parts.append("\n".join(console.table(columns, body, styles)))
    else:
        parts.append(console.wrap("No parameter moves a result."))
    parts += [console.wrap(pretty(words), "dim") for words in rows.sensitivity_notes(found)]
    return "\n\n".join(parts) + "\n"
