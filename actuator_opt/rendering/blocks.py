"""The building blocks of a report page: tables, figures, notes, listings, as plain data.

A cell is a text, a list of texts (pieces between which a line may break), or one of the records
of `status`, `bar` and `share`. Both renderers (Typst template, plain fallback) read these.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from ..base.suggest import CONTROLS
from .ink import Ink
from .text import STATUS_WORDS

Cell: TypeAlias = str | list[str] | dict[str, Any]
Block: TypeAlias = dict[str, Any]

_PIECES = re.compile(r"[^._/=)\]]{0,17}(?:[._/=)\]]+(?![0-9])|$)|.{1,18}", re.DOTALL)
_WORDS = re.compile(r"\s*\S+\s*|\s+")
_CONTROL = re.compile(rf"[{CONTROLS}]")


@dataclass(frozen=True, slots=True)
class ExtraTable:
    """A table the caller adds to the report, such as published numbers beside ours.

    A cell may be text or a number; `note` stands under the table, a `drawing` (as `figure` makes
    it) after it.
    """

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[object]]
    note: str = ""
    drawing: Block | None = None
    widths: Sequence[float] = ()
    """Of the columns, over one another; default: all alike."""


def clean(text: str) -> str:
    """Printable text: control and direction characters as their code point, ``⟨U+0007⟩``."""
    return _CONTROL.sub(lambda m: f"⟨U+{ord(m[0]):04X}⟩", text)


_PAPER = re.compile(
    r"[^\n\t\u0020-\u007e\u00a0-\u02af\u0370-\u052f\u1e00-\u1eff\u2010-\u2029\u202f-\u205e"
    r"\u2070-\u209c\u20a0-\u20b5\u2100-\u2311\u2500-\u26b8\u2701-\u27be\u27e8\u27e9]"
)
"""What the report's typeface cannot draw (it covers Latin, Greek, Cyrillic and technical signs)."""


def printable(data: Any) -> Any:
    """Data whose texts the typeface can draw; other letters as their code point, ``⟨U+4E2D⟩``."""
    if isinstance(data, str):
        if data.isascii():
            return data
        return _PAPER.sub(lambda m: f"⟨U+{ord(m[0]):04X}⟩", data)
    if isinstance(data, dict):
        return {key: printable(value) for key, value in data.items()}
    if isinstance(data, list):
        return [printable(value) for value in data]
    return data


def soft(text: str, longest: int = 14) -> Cell:
    """A text that may break inside words beyond `longest` letters (paths, absurd names)."""
    text = clean(text)
    pieces: list[str] = [""]
    for word in _WORDS.findall(text):
        if len(word.rstrip()) <= longest:
            pieces[-1] += word
            continue
        first, *rest = (piece for piece in _PIECES.findall(word) if piece)
        pieces[-1] += first
        pieces += rest
    return text if len(pieces) == 1 else pieces


def short(text: str, length: int) -> str:
    """A text cut to `length` letters with an ellipsis."""
    text = clean(text)
    return text if len(text) <= length else text[: length - 1].rstrip() + "…"


def status(state: str) -> Cell:
    """A status with its mark: met, missed or not checked."""
    return {"status": state, "text": STATUS_WORDS[state]}


def bar(margin: float | None, *, met: bool = True) -> Cell:
    """A margin bar: right of the line is room left, left of it is missing; full at 100 %."""
    if margin is None:
        return ""
    return {"bar": round(max(-1.0, min(1.0, margin)), 4), "over": abs(margin) > 1.0, "met": met}


def share(value: float) -> Cell:
    """A bar from zero to one."""
    return {"share": round(max(0.0, min(1.0, value)), 4)}


def column(head: str, align: str = "left", width: float | str = "auto", **more: Any) -> Block:
    """A table column: `width` is "auto", a fraction of the rest (number), or ``"12mm"``."""
    return {"head": head, "align": align, "width": width} | more


def table(
    title: str,
    columns: Sequence[Mapping[str, Any]],
    rows: Sequence[Sequence[Cell]],
    *,
    note: str = "",
    total: int = 0,
    marks: Sequence[str] = (),
) -> Block:
    """A table; the last `total` rows stand under a rule; `marks` names rows to emphasise."""
    return {
        "kind": "table",
        "title": clean(title),
        "columns": [dict(c) for c in columns],
        "rows": [list(row) for row in rows],
        "note": clean(note),
        "total": total,
        "marks": list(marks),
    }


def figure(title: str, ink: Ink, note: str = "") -> Block:
    """A drawing with a title."""
    return {"kind": "figure", "title": clean(title), "ink": ink.data(), "note": clean(note)}


def notes(title: str, items: Sequence[str], note: str = "") -> Block:
    """A list of sentences."""
    return {"kind": "notes", "title": title, "items": [soft(i) for i in items], "note": note}


def listing(title: str, text: str) -> Block:
    """Numbered source text in monospace."""
    lines: list[Cell] = [soft(line.expandtabs(4), 40) for line in text.splitlines()]
    wide = sum(len(line.rstrip()) > 62 for line in text.splitlines()) > len(lines) // 10
    columns = 1 if wide else 2
    return {"kind": "listing", "title": clean(title), "lines": lines, "columns": columns}
