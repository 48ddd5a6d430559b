"""Explanation of a name on one screen, and lists of names, for the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..rendering.blocks import Block, Column, Table, short
from ..rendering.text import number

if TYPE_CHECKING:
    from ..api.explaining import Catalogue, Explanation

LINE = 62
"""Characters of text that surely fit into a line of 80 columns beside the first column."""
_LINES = {"what": 4, "now": 2, "ask": 4, "model": 2, "valid": 2, "source": 3, "see": 2}
"""Largest number of lines of each part."""


def _cut(part: str, text: str) -> str:
    return short(" ".join(text.split()), LINE * _LINES[part])


def explanation(explained: Explanation) -> Sequence[Block]:
    """Blocks of at most 24 lines of 80 columns: what, value, how to ask, what moves it, sources."""
    entry = explained.entry
    title = f"{entry.name}  {entry.kind}"
    if entry.quantity is not None:
        title += f", unit {entry.unit}"
        if entry.quantity.symbol not in ("", "-"):
            title += f", symbol {entry.quantity.symbol}"
    moved = ", ".join(f"{name} {number(x, 3, signed=True)}" for name, x in moves(explained))
    facts = [
        ("what", _cut("what", explained.definition)),
        ("now", _cut("now", explained.value)),
        *((("ask" if k == 0 else ""), _cut("ask", line)) for k, line in enumerate(explained.ask)),
        ("moves" if entry.kind == "PATH" else "moved by", f"{moved} (% per %)" if moved else ""),
        ("model", _cut("model", explained.model)),
        ("valid", _cut("valid", explained.validity)),
        ("source", _cut("source", explained.source)),
        ("see", _cut("see", ", ".join(explained.related))),
    ]
    columns = [Column("", style="dim"), Column("", width=1.0, breaks=30, wraps=True, least=24)]
    return [Table(short(title, 80), columns, [fact for fact in facts if fact[1]])]


def moves(explained: Explanation) -> Sequence[tuple[str, float]]:
    """The influences, the largest first."""
    return list(explained.influences.items())


def catalogue(listed: Catalogue) -> Table:
    """Table of entries: name, value, unit and phrase; a narrow terminal cuts the phrase."""
    now = [Column("now", "right", drop=1)] if listed.valued else []
    columns = [
        Column("name", strong=True),
        *now,
        Column("unit", style="dim", drop=2),
        Column("", width=1.0),
    ]
    rows = [
        (entry.name, *([short(entry.number(), 30)] if now else []), entry.unit, entry.phrase)
        for entry in listed.entries
    ]
    return Table("", columns, rows)
