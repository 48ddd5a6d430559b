"""ISO 286-1 tolerance classes: limits of a size from its class, ``H8`` or ``f7``."""

from __future__ import annotations

import re
from typing import Any

from .kinds import ValueFault
from .standards import citation, metres, tables

_CLASS = re.compile(r"(JS|js|[A-Za-z])(\d{1,2})")
_MICRON = 1e-6


def _table() -> dict[str, Any]:
    found: dict[str, Any] = tables()["iso_286"]
    return found


def source() -> str:
    """Source of the table, with its confidence."""
    return f"{citation(_table()['source'])} ({_table()['confidence']})"


def class_limits(name: str, size: float) -> tuple[float, float]:
    """Lower and upper deviation (m) from the nominal size (m) of a class of ISO 286-1.

    Holes have capital, shafts small letters. The fundamental deviation of a hole is the negative
    of that of the shaft with the same letter (d to h); js and JS are symmetric.

    Raises
    ------
    ValueFault : no such class, or a size beyond the table

    Examples
    --------
    >>> [round(1e6 * x, 3) for x in class_limits("H8", 25e-3)]
    [0.0, 33.0]
    >>> [round(1e6 * x, 3) for x in class_limits("f7", 25e-3)]
    [-41.0, -20.0]
    """
    table = _table()
    match = _CLASS.fullmatch(name.strip())
    letter = "" if match is None else match[1]
    grades, letters = [int(g) for g in table["grades"]], table["shafts"]
    known = letter.lower() in (*letters, "h", "js")
    if match is None or int(match[2]) not in grades or not known:
        message = f'"{name}" is not a supported tolerance class'
        ends = f"{', '.join(sorted(letters))}, h or js and {grades[0]} to {grades[-1]}"
        raise ValueFault(message, f"write e.g. H8 or f7: {ends}, capitals for holes")
    row = next((r for r in table["rows"] if size <= metres(r["to"]) * (1 + 1e-12)), None)
    if row is None or size <= 0:
        message = f"{name}: the ISO 286 table ends at {table['rows'][-1]['to']} mm"
        raise ValueFault(message, "write half_width instead")
    width = float(row["widths"][grades.index(int(match[2]))]) * _MICRON
    if letter.lower() == "js":
        return -width / 2, width / 2
    shift = 0.0 if letter.lower() == "h" else float(letters[letter.lower()][_place(row)]) * _MICRON
    return (shift, shift + width) if letter.isupper() else (-shift - width, -shift)


def _place(row: dict[str, Any]) -> int:
    """Index of a size step."""
    return [one["to"] for one in _table()["rows"]].index(row["to"])
