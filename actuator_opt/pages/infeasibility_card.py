"""The infeasibility card as an engineer reads it: what to change, to what, and what is proven."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..optimisation.infeasibility_card import percent
from ..optimisation.result import Infeasibility, Optimisation
from ..rendering import text
from ..rendering.blocks import Block, Cell, Column, Notes, Table, soft
from ..rendering.console import Console
from ..rendering.terminal import block_text
from ..rendering.text import DASH
from .optimum import sentence


def terminal(
    subject: Optimisation, *, colour: bool = False, unicode: bool = True, width: int = 100
) -> str:
    """Why nothing fits; empty where something does."""
    console = Console(colour, unicode, width)
    if subject.infeasibility is None:
        return ""
    return "\n\n".join(block_text(block, console) for block in blocks(subject.infeasibility))


def blocks(card: Infeasibility) -> list[Block]:
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
