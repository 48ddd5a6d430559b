"""Explanation of a name on one screen, and lists of names, for the terminal."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Literal, TypeAlias

from ..base.quantities import Quantity
from ..rendering.blocks import Column, Table, short
from ..rendering.text import number

Part: TypeAlias = Literal["what", "now", "model", "valid", "source", "see"]
"""Parts of an explanation: definition, value in the design, model, valid range, source of the
model or number, and names to look up next."""

LINE = 62
"""Characters that surely fit into a line of 80 columns beside the names of the parts."""
_LINES: Mapping[Part, int] = {"what": 4, "now": 2, "model": 3, "valid": 2, "source": 3, "see": 2}
"""Largest number of lines of each part; lines to copy are never cut."""


def explanation(
    name: str,
    kind: str,
    quantity: Quantity | None,
    parts: Mapping[Part, str],
    ask: Sequence[str],
    influences: Mapping[str, float],
) -> Table:
    """Table of an explanation, at most 24 lines of 80 columns.

    Parameters
    ----------
    name, kind, quantity : the name, what it names, and its physical quantity
    parts : texts of the parts; empty ones are left out
    ask : lines to copy into a design file or a command
    influences : what moves a metric, or what a number moves, in % per %
    """
    title = f"{name}  {kind}"
    if quantity is not None:
        title += f", unit {quantity.unit or 'none'}"
        title += f", symbol {quantity.symbol}" if quantity.symbol not in ("", "-") else ""
    moves = ", ".join(f"{other} {number(x, 3, signed=True)}" for other, x in influences.items())
    texts = {key: short(" ".join(text.split()), LINE * _LINES[key]) for key, text in parts.items()}
    facts = [
        *((key, texts[key]) for key in ("what", "now")),
        *(("" if k else "ask", line) for k, line in enumerate(ask)),
        ("moves" if kind == "PATH" else "moved by", f"{moves} (% per %)" if moves else ""),
        *((key, texts[key]) for key in ("model", "valid", "source", "see")),
    ]
    columns = [Column("", style="dim"), Column("", width=1.0, breaks=30, wraps=True, least=24)]
    return Table(short(title, 80), columns, [fact for fact in facts if fact[1]])


def listing(rows: Iterable[tuple[str, str, str, str]], *, valued: bool) -> Table:
    """Table of names with value, unit and phrase; a narrow terminal cuts the phrase.

    Parameters
    ----------
    rows : name, value, unit and phrase of each entry
    valued : whether to show the column of values
    """
    now = [Column("now", "right", drop=1)] if valued else []
    columns = [
        Column("name", strong=True),
        *now,
        Column("unit", style="dim", drop=2),
        Column("meaning", width=1.0),
    ]
    cells = [
        (name, *([short(value, 30)] if valued else []), unit, phrase)
        for name, value, unit, phrase in rows
    ]
    return Table("", columns, cells)
