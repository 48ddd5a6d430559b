"""Heights of blocks on paper, estimated from the widths of the words in them.

`room` is the height that remains for the large figure on the first sheet. The estimates are rather
too high than too low: a figure that is a few millimetres too small does no harm, but blocks must
not be pushed to the next sheet.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from .blocks import (
    Bar,
    Block,
    Cell,
    Chart,
    Drawing,
    Flag,
    Listing,
    Notes,
    Page,
    Pair,
    Reach,
    Row,
    Share,
    Slot,
    Status,
    Table,
    soft,
)
from .ink import text_width

SHEET, TILES, FOOT, HEAD = 265.0, 23.0, 24.5, 8.2
"""Heights of a sheet inside its margins, of the key figures, of the title block, and of the title
of a block [mm]."""
HALF, FULL = 86.0, 172.0
"""Width of text in half a sheet and in a whole sheet [mm]."""
LINE, NOTE_LINE = 3.6, 2.75
"""Heights of a line of a table, and of a line of the note below it [mm]."""
MARKED = 1.06
"""Height of a table row that contains a bar, in lines."""
FRAME, SPARE = 3.0, 9.0
"""Height of the frame around the large figure, and measured excess of the estimated over the true
height of a sheet with a large figure and two tables [mm]."""


def joined(cell: Cell) -> str:
    """A cell as one text; marks without words are empty.

    >>> joined(["barrel.", "wall"]), joined(Status("met"))
    ('barrel.wall', 'met')
    """
    if isinstance(cell, str):
        return cell
    if isinstance(cell, list):
        return "".join(cell)
    if isinstance(cell, Status):
        return cell.words
    return cell.text if isinstance(cell, Flag) else ""


def wrap(text: str, width: float, size: float) -> list[str]:
    """Lines of a text, at most `width` mm wide; longer words are cut.

    >>> wrap("one two three", 12.0, 7.0)
    ['one two', 'three']
    """
    text = text.replace("\n", " ").lstrip(" ")
    if text_width(text, size) <= width:
        return [text]
    lines = [""]
    for word in text.split(" "):
        trial = f"{lines[-1]} {word}" if lines[-1] else word
        if text_width(trial, size) <= width:
            lines[-1] = trial
            continue
        if lines[-1]:
            lines.append("")
        while word and text_width(word, size) > width:
            cut = max(1, int(len(word) * width / text_width(word, size)) - 1)
            lines[-1] = word[:cut]
            lines.append("")
            word = word[cut:]
        lines[-1] = word
    return lines


def cells_of(row: Row | Sequence[Cell]) -> Sequence[Cell]:
    """The cells of a row, with or without a state."""
    return row.cells if isinstance(row, Row) else row


def height(block: Block, width: float = FULL) -> float:
    """Height of a block on paper [mm]; 0 for a block that only the terminal shows."""
    if isinstance(block, Pair):
        return max(sum(height(part, HALF) for part in side) for side in block.sides)
    if isinstance(block, Table):
        if block.on == "terminal":
            return 0.0
        parts = fitting(block, width)
        return sum(HEAD + _note(x.note, width) + LINE * sum(_lines(x, width)) for x in parts)
    if isinstance(block, Drawing):
        return HEAD + _note(block.note, width) + block.ink.height + 3.0
    if isinstance(block, Chart):
        return HEAD + _note(block.note, width) + block.height + 3.0
    if isinstance(block, Notes):
        if block.on == "terminal":
            return 0.0
        lines = [len(wrap(joined(soft(item)), width, 7.0)) for item in block.items]
        return HEAD + 1.5 + _note(block.note, width) + sum(3.2 * n + 0.5 for n in lines)
    if isinstance(block, Listing):
        return HEAD + 2.5 * len(block.text.splitlines())
    return 0.0


def fitting(table: Table, width: float) -> list[Table]:
    """The parts of a table that fit the width [mm]."""
    return table.parts(_widths(table), width) if table.repeat else [table]


def room(page: Page) -> float:
    """Height that remains for the large figure on the first sheet [mm].

    If the figure would be lower than `Page.least`, the last blocks move to the next sheet.
    """
    head = 6.0 + (8.0 if len(page.name) <= 28 else 6.0 * math.ceil(len(page.name) / 45))
    head += 3.1 * len(wrap(page.sentence, 112.0, 7.5))
    left = SHEET - max(head, 17.0) - TILES - FOOT
    heights = [height(block) for block in page.blocks]
    while heights and left - sum(heights) < page.least:
        heights.pop()
    return left - sum(heights)


def rest(page: Page, hero: float) -> float:
    """Height that remains on the first sheet with the blocks and a figure of height `hero`."""
    legend = sum(
        text_width(f"{n} {part}, {material}", 5.8) + 4.0 for n, part, material in page.items
    )
    below = 1.8 + 1.9 * math.ceil(legend / FULL) if page.items else 0.0
    return room(page) + SPARE - hero - below - FRAME


def _note(words: str, width: float) -> float:
    return NOTE_LINE * len(wrap(words, width, 6.2)) + 1.2 if words else 0.0


def _widths(table: Table) -> list[float]:
    """Widths that the columns need without line breaks [mm]."""
    body = [cells_of(row) for row in table.rows]
    widths = []
    for k, column in enumerate(table.columns):
        if isinstance(column.width, str) and column.width.endswith("mm"):
            widths.append(float(column.width[:-2]))
            continue
        words = [*column.head.split("\n"), *(joined(row[k]) for row in body)]
        widths.append(max(text_width(word, 6.8, bold=column.strong) for word in words) + 2.2)
    return widths


def _lines(table: Table, width: float) -> list[float]:
    """Number of text lines of the heads and of every row.

    Flexible columns share the remaining width.
    """
    columns = [k for k, column in enumerate(table.columns) if column.on != "terminal"]
    body = [cells_of(row) for row in table.rows]
    widths = _widths(table)
    wides = {k: widths[k] for k in columns}
    spare = width - sum(wides.values())
    flexible = [k for k in columns if table.columns[k].flexible] or columns[:1]
    for k in flexible:
        wides[k] = max(wides[k] + min(spare, 0.0) / len(flexible), 10.0)
    lines = [float(max(table.columns[k].head.count("\n") + 1 for k in columns))]
    for row in body:
        most = max(len(wrap(joined(row[k]), wides[k] - 2.0, 6.8)) for k in columns)
        marked = any(isinstance(row[k], (Bar, Slot, Share, Reach)) for k in columns)
        lines.append((MARKED if marked else 1.0) + 0.72 * (most - 1))
    return lines
