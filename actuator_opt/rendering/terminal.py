"""A page on the terminal: verdict, sentence, and blocks from top to bottom.

Curves are drawn in a few lines of braille dots. Functions return text and print nothing. Without
Unicode the text is plain ASCII.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import zip_longest
from typing import Unpack

from .blocks import (
    Bar,
    Block,
    Cell,
    Chart,
    Column,
    Drawing,
    Flag,
    Notes,
    Page,
    Pair,
    Row,
    Share,
    Slot,
    State,
    Status,
    Table,
    TerminalFigure,
    Verdict,
)
from .console import GAP, PAINT, Console, Style, visible
from .heights import cells_of, joined
from .text import number, trimmed

_DOTS = ((0x01, 0x02, 0x04, 0x40), (0x08, 0x10, 0x20, 0x80))
"""Bit of every dot in a braille character, by column, then row."""


def curve(
    points: Sequence[tuple[float, float]],
    limit: float | None,
    console: Console,
    width: int,
    height: int,
    *,
    ends: tuple[str, str] | None = None,
) -> list[str]:
    """Lines of a plot of (x, y) points with an optional horizontal limit.

    `ends` are the labels below the first and the last point; by default, their x values in mm.
    """
    points = [(x, y) for x, y in points if math.isfinite(x) and math.isfinite(y)]
    if len(points) < 2 or points[-1][0] <= points[0][0]:
        return []
    lowest = min(y for _, y in points)
    floor = max(lowest, limit or 0.0)
    top = min(max(max(y for _, y in points), 1.1 * floor), 3.0 * floor)
    bottom = min(0.85 * lowest, 0.95 * (lowest if limit is None else limit))
    margin = max(len(console.say(number(level, 3))) for level in (top, bottom, floor)) + 2
    columns = width - margin
    if columns < 8 or not top > bottom:
        return []
    across, down = (2, 4) if console.unicode else (1, 1)
    grid_width, grid_height = columns * across, height * down

    def row_of(y: float) -> int:
        return round((top - y) / (top - bottom) * (grid_height - 1))

    drawn = _trace(points, grid_width, row_of)
    required = None if limit is None else row_of(limit)
    levels = {height - 1: bottom} if required is None else {required // down: limit}
    levels[0] = top
    lines = []
    for line in range(height):
        head = console.say(number(levels[line], 3)) if line in levels else ""
        tick = ("┤" if head else "│") if console.unicode else "|"
        cells = "".join(
            _character(console, drawn, required, line, column, across, down)
            for column in range(columns)
        )
        lines.append(f"{console.paint(f'{head:>{margin - 2}} {tick}', 'dim')}{cells}")
    corner, rule = ("└", "─") if console.unicode else ("+", "-")
    axis = f"{'':{margin - 1}}{corner}{rule * columns}"
    first, last = ends or (trimmed(points[0][0], 3), f"{trimmed(points[-1][0], 4)} mm")
    left, right = console.say(first), console.say(last)
    below = f"{'':{margin}}{left}{right:>{columns - len(left)}}"
    return [*lines, console.paint(axis, "dim"), console.paint(below, "dim")]


def _trace(
    points: Sequence[tuple[float, float]], grid_width: int, row_of: Callable[[float], int]
) -> dict[int, tuple[int, int]]:
    """For every column of dots, the first and last row that the curve passes through."""
    first, last = points[0][0], points[-1][0]
    rows = []
    index = 0
    for column in range(grid_width):
        x = first + (last - first) * column / (grid_width - 1)
        while index < len(points) - 2 and points[index + 1][0] < x:
            index += 1
        (x1, y1), (x2, y2) = points[index], points[index + 1]
        y = y1 if x2 <= x1 else y1 + (y2 - y1) * (x - x1) / (x2 - x1)
        rows.append(row_of(y))
    spans = {}
    for column, row in enumerate(rows):
        before = rows[column - 1] if column else row
        low, high = (row, before - 1) if before > row else (before + 1, row)
        spans[column] = (min(low, row), max(high, row))
    return spans


def _character(
    console: Console,
    drawn: dict[int, tuple[int, int]],
    required: int | None,
    line: int,
    column: int,
    across: int,
    down: int,
) -> str:
    if not console.unicode:
        low, high = drawn[column]
        if low <= line <= high:
            return "*"
        return "-" if required == line and column % 2 == 0 else " "
    bits = limit_bits = 0
    for i in range(across):
        low, high = drawn[column * across + i]
        for j in range(down):
            row = line * down + j
            if low <= row <= high:
                bits |= _DOTS[i][j]
            if row == required and (column * across + i) % 4 < 2:
                limit_bits |= _DOTS[i][j]
    if bits:
        return console.paint(chr(0x2800 + (bits | limit_bits)), "cyan")
    if limit_bits:
        return console.paint(chr(0x2800 + limit_bits), "red")
    return " "


PAINTS: dict[str, str] = {
    "": "",
    "met": "green",
    "no_reserve": "yellow",
    "missed": "red bold",
    "checks": "yellow bold",
    "not_checked": "dim",
    "infeasible": "red bold",
}
"""Colour and font weight of every verdict state."""
MARKS: dict[str, tuple[str, str]] = {
    "": ("", ""),
    "met": ("✔", "ok"),
    "no_reserve": ("!", "!"),
    "checks": ("!", "!"),
    "missed": ("✘", "MISSED"),
    "not_checked": ("○", "-"),
    "infeasible": ("✘", "INFEASIBLE"),
}
"""Mark of every verdict state, in Unicode and in ASCII."""
SPLIT = 4
"""Spaces between blocks side by side."""
LEAST_SIDE = 36
"""Least width in columns at which blocks stand side by side."""
WIDE = 110
"""Smallest terminal width (columns) at which the bars of margins have their full length."""


def text(page: Page, **style: Unpack[Style]) -> str:
    """A page as text that ends in a line break.

    Parameters
    ----------
    page : to show
    style : whether to use colour codes and Unicode signs, and the width in columns
    """
    console = Console(**style)
    head = "\n".join(heading(page.name, page.verdict, page.sentence, console))
    return f"{head}\n\n{blocks_text(page.blocks, **style)}".rstrip("\n") + "\n"


def blocks_text(blocks: Sequence[Block], **style: Unpack[Style]) -> str:
    """Blocks from top to bottom, as text that ends in a line break."""
    console = Console(**style)
    parts = [block_text(block, console) for block in blocks]
    return "\n\n".join(part for part in parts if part) + "\n"


def heading(name: str, verdict: Verdict, sentence: str, console: Console) -> list[str]:
    """Top of a page: name, verdict with its reasons, cautions, and a summary sentence."""
    mark = f"{MARKS[verdict.state][0]} " if console.unicode and verdict.state else ""
    state = console.paint(console.say(mark + verdict.text.lower()), *PAINTS[verdict.state].split())
    lines = [f"{console.paint(console.say(name), 'bold')}  {state}"]
    if visible(console.say(name) + console.say(mark + verdict.text)) + 2 > console.width:
        paint = PAINTS[verdict.state].split()
        lines = [console.wrap(name, "bold"), console.wrap(mark + verdict.text.lower(), *paint)]
    if verdict.lines:
        lines.append(console.wrap("; ".join(verdict.lines), "dim"))
    if verdict.cautions:
        lines.append(console.wrap("; ".join(verdict.cautions), "yellow"))
    return [*lines, console.wrap(sentence)] if sentence else lines


def block_text(block: Block, console: Console) -> str:
    """A block as text; empty for a block that appears only on paper."""
    if isinstance(block, Pair):
        return _pair(block, console)
    if isinstance(block, (Drawing, Chart)):
        return "" if block.instead is None else block_text(block.instead, console)
    if isinstance(block, TerminalFigure):
        return _figure(block, console)
    if isinstance(block, Table):
        return "" if block.on == "paper" else _tables(block, console)
    if isinstance(block, Notes):
        return "" if block.on == "paper" else _notes(block, console)
    return ""


def _pair(pair: Pair, console: Console) -> str:
    count = len(pair.sides)
    width = (console.width - SPLIT * (count - 1)) // count
    beside = pair.tight and count > 1 and width >= LEAST_SIDE
    side_console = replace(console, width=width) if beside else console
    sides = [[block_text(part, side_console) for part in side] for side in pair.sides]
    texts = [("\n" if pair.tight else "\n\n").join(filter(None, side)) for side in sides]
    if not beside:
        return ("\n" if pair.tight else "\n\n").join(filter(None, texts))
    lines = [text.split("\n") for text in texts]
    widths = [max(map(_width, side)) + SPLIT for side in lines]
    rows = zip_longest(*lines, fillvalue="")
    return "\n".join(
        "".join(
            line + " " * (width - _width(line)) for line, width in zip(row, widths, strict=True)
        ).rstrip()
        for row in rows
    )


def _width(line: str) -> int:
    """Width of a line in columns, without its colour codes."""
    return visible(re.sub(PAINT, "", line))


def _notes(block: Notes, console: Console) -> str:
    lines = [] if block.headless else [console.heading(block.title)]
    lines += [console.wrap(item, *block.style.split()) for item in block.items]
    return "\n".join([*lines, *([console.wrap(block.note, "dim")] if block.note else [])])


def _figure(figure: TerminalFigure, console: Console) -> str:
    width = min(console.width, 76)
    drawn = curve(figure.points, figure.level, console, width, figure.height, ends=figure.ends)
    if not drawn:
        return ""
    below = [console.wrap(figure.note, "dim")] if figure.note else []
    return "\n".join([console.heading(figure.title), *drawn, *below])


def _tables(table: Table, console: Console) -> str:
    """A table as text, split into parts if it is too wide and its first columns may be repeated."""
    if not table.repeat:
        return _table(table, console)
    cells = [[_cell(cell, console) for cell in cells_of(row)] for row in table.rows]
    columns = zip(*([column.head for column in table.columns], *cells), strict=True)
    widths = [max(visible(console.say(text)) for text in column) + GAP for column in columns]
    parts = table.parts(widths, console.width + GAP)
    return "\n\n".join(_table(part, console) for part in parts)


def _table(table: Table, console: Console) -> str:
    shown = [k for k, column in enumerate(table.columns) if column.on != "paper"]
    columns = [table.columns[k] for k in shown]
    body, styles = [], []
    last = len(table.rows) - table.total
    for index, entry in enumerate(table.rows):
        row = entry if isinstance(entry, Row) else Row(entry)
        body.append([_cell(row.cells[k], console) for k in shown])
        total = "bold" if index >= last else ""
        styles.append([_paint(table.columns[k], row.cells[k], row.state) or total for k in shown])
    lines = [] if table.headless or not table.title else [console.heading(table.title)]
    lines += console.table(columns, body, styles)
    return "\n".join([*lines, *([console.wrap(table.note, "dim")] if table.note else [])])


def _paint(column: Column, cell: Cell, state: State) -> str:
    """Name of the colour and font weight in which a cell is printed."""
    if isinstance(cell, Status):
        return PAINTS[cell.state]
    if isinstance(cell, Bar):
        return PAINTS[state or ("met" if cell.met else "missed")]
    if isinstance(cell, Flag):
        return "red bold" if cell.raised else "dim"
    if isinstance(cell, (Slot, Share)):
        return "cyan"
    if column.style == "state":
        return PAINTS[state]
    return column.style or ("bold" if column.strong else "")


def _cell(cell: Cell, console: Console) -> str:
    if isinstance(cell, Status):
        mark = MARKS[cell.state][0 if console.unicode else 1]
        if not console.unicode and mark.lower() in cell.words.lower():
            return cell.words
        return f"{mark} {cell.words}".strip()
    if isinstance(cell, Bar):
        return console.margin_bar(cell.margin, 5 if console.width >= WIDE else 3)
    if isinstance(cell, Slot):
        return slot(console, cell.place)
    if isinstance(cell, Share):
        return ("█" if console.unicode else "#") * round(12 * min(max(cell.value, 0.0), 1.0))
    return joined(cell)


def slot(console: Console, share: float, size: int = 13) -> str:
    """A position between two ends as a dot on a line."""
    place = round(min(max(share, 0.0), 1.0) * (size - 1))
    line, dot = ("─", "●") if console.unicode else ("-", "o")
    return line * place + dot + line * (size - 1 - place)


def words(sentences: Sequence[str], console: Console, *styles: str) -> str:
    """Paragraphs, wrapped to the width of the terminal."""
    return "\n".join(console.wrap(sentence, *styles) for sentence in sentences if sentence)
