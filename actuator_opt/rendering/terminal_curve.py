"""A curve in a few lines of terminal: braille dots, or plain characters."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from .console import Console
from .text import number, trimmed

_DOTS = ((0x01, 0x02, 0x04, 0x40), (0x08, 0x10, 0x20, 0x80))
"""Bits of a braille cell, by column, then row."""


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

    `ends` are the words below its first and last x; without them x is in mm.
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
            _cell(console, drawn, required, line, column, across, down) for column in range(columns)
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
    """For every dot column, the rows the curve passes through."""
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


def _cell(
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
