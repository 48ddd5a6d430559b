"""Text for a terminal: measures, cuts, wraps and colours columns, in Unicode or ASCII."""

from __future__ import annotations

import re
import textwrap
import unicodedata
from collections.abc import Sequence
from typing import TypedDict

from ..base.dataclass import dataclass
from .blocks import Column, clean
from .text import plain

_CODES = {"bold": "1", "dim": "2", "red": "31", "green": "32", "yellow": "33", "cyan": "36"}
_CODE = "|".join(_CODES.values())
PAINT = rf"\x1b\[(?:0|(?:{_CODE})(?:;(?:{_CODE}))*)m"
"""Regular expression of the codes that `Console.paint` writes."""
GAP = 2
"""Spaces between two columns of a table."""
_BREAK = re.compile(r"[\t\n\r\v\f\u2028\u2029]+")


class Style(TypedDict):
    """Settings of a text: whether it has colour codes and Unicode signs, and its width."""

    colour: bool
    unicode: bool
    width: int


def visible(text: str) -> int:
    """Width of a text in columns of a terminal (wide East Asian letters take two).

    >>> visible("25 mm"), visible("膝")
    (5, 2)
    """
    wide = sum(unicodedata.east_asian_width(letter) in "WF" for letter in text)
    return len(text) + wide - sum(unicodedata.combining(letter) > 0 for letter in text)


@dataclass(frozen=True, slots=True)
class Console:
    """A terminal: whether it shows colours and Unicode, and its width in columns."""

    colour: bool = False
    unicode: bool = True
    width: int = 100

    def say(self, text: str) -> str:
        """A text in characters that the terminal can show, without control codes."""
        text = clean(_BREAK.sub(" ", text))
        return text if self.unicode else plain(text)

    def paint(self, text: str, *styles: str) -> str:
        """Text in colour, if the terminal has colours."""
        codes = [_CODES[style] for style in styles if style]
        if not self.colour or not codes or not text:
            return text
        return f"\x1b[{';'.join(codes)}m{text}\x1b[0m"

    def cut(self, text: str, width: int) -> str:
        """A text cut to `width` columns with an ellipsis."""
        if visible(text) <= width:
            return text
        mark = "…" if self.unicode else "~"
        while text and visible(text) > width - 1:
            text = text[:-1]
        return text + mark if width > 0 else ""

    def wrap(self, text: str, *styles: str) -> str:
        """A paragraph, wrapped to the width of the terminal."""
        lines = textwrap.wrap(self.say(text), self.width, break_on_hyphens=False) or [""]
        return "\n".join(self.paint(line, *styles) for line in lines)

    def heading(self, text: str) -> str:
        """A section title."""
        return self.paint(self.cut(self.say(text), self.width), "bold")

    def table(
        self,
        columns: Sequence[Column],
        rows: Sequence[Sequence[str]],
        styles: Sequence[Sequence[str]] = (),
    ) -> list[str]:
        """Lines of a table with `styles` for each cell.

        To fit the terminal, columns are shrunk, wrapped or dropped.
        """
        cells = [[self.say(cell) for cell in row] for row in rows]
        heads = [self.say(column.head.replace("\n", " ")) for column in columns]
        keep = list(range(len(columns)))
        while True:
            sizes = {k: max([visible(heads[k]), *(visible(row[k]) for row in cells)]) for k in keep}
            spare = self.width - sum(sizes.values()) - GAP * (len(keep) - 1)
            flexible = [k for k in keep if columns[k].flexible]
            floor = sum(min(sizes[k], columns[k].least) for k in flexible)
            dropped = sorted((columns[k].drop, k) for k in keep if columns[k].drop)
            if spare >= 0 or not dropped or sum(sizes[k] for k in flexible) + spare >= floor:
                break
            keep.remove(dropped[-1][1])
        least = {k: columns[k].least if columns[k].wraps else 6 for k in flexible}
        while spare < 0 and (wide := [k for k in flexible if sizes[k] > least[k]]):
            sizes[max(wide, key=lambda k: sizes[k])] -= 1
            spare += 1
        lines = []
        if any(heads[k] for k in keep):
            lines += self._lines(columns, keep, sizes, heads, ["dim"] * len(columns))
        for index, row in enumerate(cells):
            style = styles[index] if index < len(styles) else [""] * len(columns)
            lines += self._lines(columns, keep, sizes, row, style)
        return lines

    def _lines(
        self,
        columns: Sequence[Column],
        keep: Sequence[int],
        sizes: dict[int, int],
        cells: Sequence[str],
        styles: Sequence[str],
    ) -> list[str]:
        """Lines of a row: as many as its longest cell needs."""
        pieces = {k: self._pieces(columns[k], cells[k], sizes[k]) for k in keep}
        lines = []
        for index in range(max(len(piece) for piece in pieces.values())):
            parts = []
            for k in keep:
                text = pieces[k][index] if index < len(pieces[k]) else ""
                gap = " " * (sizes[k] - visible(text))
                painted = self.paint(text, *styles[k].split())
                parts.append(gap + painted if columns[k].align == "right" else painted + gap)
            lines.append((" " * GAP).join(parts).rstrip())
        return lines

    def _pieces(self, column: Column, cell: str, size: int) -> list[str]:
        """Lines of a cell: wrapped, or cut to a single line."""
        if not column.wraps or visible(cell) <= size:
            return [self.cut(cell, size)]
        long = column.breaks > 0
        return textwrap.wrap(cell, size, break_long_words=long, break_on_hyphens=False) or [""]

    def margin_bar(self, margin: float | None, half: int = 5) -> str:
        """A margin as a bar, full at 100 %: reserve right of the mark, violation left of it."""
        if margin is None:
            return ""
        size = min(abs(margin), 1.0) * half
        axis, full = ("│", "█") if self.unicode else ("|", "#")
        if margin < 0:
            whole = int(size)
            part = "▐" if self.unicode and size - whole >= 0.25 else ""
            if not whole and not part:
                part = "▕" if self.unicode else "#"
            return f"{(part + full * whole):>{half}}{axis}{'':{half}}"
        eighths = round(size * 8)
        tail = "" if eighths % 8 == 0 else "▏▎▍▌▋▊▉"[eighths % 8 - 1]
        body = full * (eighths // 8) + tail if self.unicode else full * round(size)
        return f"{'':{half}}{axis}{body:<{half}}"
