"""Read tables of samples from CSV files: heading with units, and numbers in SI.

Records of a test bench, recorded signals of a scenario and duty cycles are such files.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from . import units
from .dataclass import dataclass
from .errors import Diagnostic, InputError, shown
from .files import read_bytes
from .numeric import Array

ABSENT = {"", "-", "--", "na", "n/a", "nan", "-nan", "null", "none", "#n/a", "inf", "-inf", "+inf"}
"""Texts of a cell that mark a missing sample, in lower case."""
_BATCH = 50_000
"""Number of lines that are converted at once (our choice: a record of an hour then fits in
memory)."""
_BINARY = re.compile(r"[\x00-\x08\x0e-\x1f\x7f]")
_ZIP = b"PK\x03\x04"
_COMMENT = re.compile(r"\s*#(?!n/a)", re.IGNORECASE)
_MISREAD = (("Âµ", "µ"), ("Î¼", "µ"), ("Â°", "°"), ("Â²", "²"), ("Â·", "·"))
"""UTF-8 characters as they look if a program has read them as Latin-1, each with its correction."""


def read_text(source: str | Path, *, most: int) -> str:
    """Text of a CSV file of at most `most` bytes; ``"-"`` is standard input.

    Raises
    ------
    InputError
        an unreadable file, a workbook, or a file that is too large
    """
    name = "<stdin>" if str(source) == "-" else str(source)
    data = read_bytes(source, most=most + 1, kinds=(".csv", ".txt", ".tsv"), what="CSV file")
    return decode_sheet(data, name, most=most)


def decode_sheet(data: bytes, name: str, *, most: int | None = None) -> str:
    """Text of a file's bytes: UTF-8, UTF-16 with a byte order mark, else Windows-1252.

    Parameters
    ----------
    data : content of the file
    name : name of the file, for messages
    most : maximum number of bytes

    Raises
    ------
    InputError
        a spreadsheet workbook, another archive, or a file that is too large
    """
    if most is not None and len(data) > most:
        size = f"{most / 1e6:.0f} MB" if most >= 1e6 else f"{most / 1e3:.0f} kB"
        message = f"the file is larger than {size}"
        remedy = "leave out unneeded columns and digits, or give a part of the record"
        raise InputError(Diagnostic(message, remedy, file=name))
    if data.startswith(_ZIP):
        message = "the file is a workbook or an archive, not text"
        raise InputError(Diagnostic(message, "save the sheet as CSV", file=name))
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return data.decode("utf-16", "replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", "replace")


@dataclass(frozen=True, slots=True)
class Sheet:
    """A CSV file, divided into heading and lines of samples.

    Parameters
    ----------
    name : name of the file
    header, header_line : cells of the heading, and the number of its line, from 1
    units : units by column from a separate line below the heading; None if there is no such line
    separator : character that separates the columns
    lines, first : lines of the file, and the index of the first line of samples
    width : number of columns, including those without a name
    """

    name: str
    header: Sequence[str]
    header_line: int
    units: Sequence[str] | None
    separator: str
    lines: Sequence[str]
    first: int
    width: int


def read_sheet(text: str, name: str, *, what: str = "record") -> Sheet:
    """Find the heading, the units and the first line of samples in a CSV file.

    Parameters
    ----------
    text : text of the file
    name : name of the file, for messages
    what : content of the file in a word, for messages

    Raises
    ------
    InputError
        a file without text or without a heading
    """
    text = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")
    strange = _BINARY.search(text)
    if strange is not None:
        line = text.count("\n", 0, strange.start()) + 1
        message = f"not text: byte 0x{ord(strange[0]):02x}"
        raise InputError(Diagnostic(message, f"export the {what} as CSV", file=name, line=line))
    for wrong, right in _MISREAD:
        text = text.replace(wrong, right)
    lines = text.split("\n")
    at = _next(lines, 0)
    if at == len(lines):
        raise InputError(Diagnostic(f"the {what} is empty", "give a CSV file", file=name))
    header, below = lines[at], at + 1
    if is_number(_cells(header, _separator(header, header))[0]):
        at, header, below = _commented(lines, at, name)
    first = _next(lines, below)
    following = lines[first] if first < len(lines) else header
    separator = _separator(header, following)
    cells = _cells(header, separator)
    width = len(cells)
    while len(cells) > 1 and not cells[-1]:
        cells.pop()
    units = _units_row(following, separator, len(cells)) if first < len(lines) else None
    first += units is not None
    return Sheet(name, cells, at + 1, units, separator, lines, first, width)


def is_number(cell: str) -> bool:
    """Whether a cell is a number with a decimal point or comma; nan and inf are numbers too."""
    try:
        float(cell.strip().replace(",", "."))
    except ValueError:
        return False
    return True


def numbers(sheet: Sheet, places: Sequence[int]) -> tuple[Array, Array]:
    """Some columns of a sheet as numbers, (samples, columns), NaN where a sample is missing.

    Returns
    -------
    the numbers, and the line number of every sample in the file, from 1

    Raises
    ------
    InputError
        a line with too few or too many cells, or a cell in these columns that is not a number
    """
    tables, line_numbers = [np.empty((0, len(places)))], [np.empty(0, dtype=int)]
    for begin in range(sheet.first, len(sheet.lines), _BATCH):
        batch = sheet.lines[begin : begin + _BATCH]
        skipped = [k for k, line in enumerate(batch) if _skipped(line, sheet.separator)]
        at = np.delete(np.arange(begin + 1, begin + len(batch) + 1), skipped)
        if skipped:
            batch = [sheet.lines[k - 1] for k in at.tolist()]
        if batch:
            tables.append(_batch(sheet, batch, at, places))
            line_numbers.append(at)
    return np.concatenate(tables), np.concatenate(line_numbers)


def _batch(sheet: Sheet, lines: Sequence[str], at: Array, places: Sequence[int]) -> Array:
    flat, count = _flat(sheet, lines, at)
    out = np.empty((len(lines), len(places)))
    for k, place in enumerate(places):
        column = flat[place::count]
        try:
            if "_" in "".join(column):  # `float` would read 1_000 as a number
                raise ValueError
            out[:, k] = np.fromiter(map(float, column), float, len(column))
        except ValueError:
            out[:, k] = [
                _number(cell, sheet, place, line)
                for cell, line in zip(column, at.tolist(), strict=True)
            ]
    return out


def _flat(sheet: Sheet, lines: Sequence[str], at: Array) -> tuple[list[str], int]:
    """All cells of some lines in one list, and the number of cells per line."""
    separator, named = sheet.separator, len(sheet.header)
    count = lines[0].count(separator) + 1
    text = separator.join(lines)
    alike = all(line.count(separator) == count - 1 for line in lines)
    if alike and count >= named and '"' not in text:
        if separator != ",":
            text = text.replace(",", ".")
        flat = text.split(separator)
        if not any(cell.strip() for k in range(sheet.width, count) for cell in flat[k::count]):
            return flat, count
    return list(_even(sheet, lines, at)), named


def _even(sheet: Sheet, lines: Sequence[str], at: Array) -> Iterator[str]:
    """Cells of lines that differ in length, cut or filled to the number of columns."""
    named = len(sheet.header)
    for line, number in zip(lines, at.tolist(), strict=True):
        cells = _cells(line, sheet.separator)
        while len(cells) > sheet.width and not cells[-1]:
            cells.pop()
        if not named <= len(cells) <= sheet.width:
            message = f"{len(cells)} cells, but the header has {named} columns"
            remedy = "give every line as many cells as the header"
            if sheet.separator == "," and len(cells) > named:
                remedy += "; with decimal commas, separate columns by semicolons"
            raise InputError(Diagnostic(message, remedy, file=sheet.name, line=number))
        yield from (cell.replace(",", ".") for cell in cells[:named])


def _number(cell: str, sheet: Sheet, place: int, line: int) -> float:
    cell = cell.strip()
    try:
        if "_" not in cell:
            return float(cell)
    except ValueError:
        if cell.lower() in ABSENT:
            return float("nan")
    column = f'in column "{shown(named_cell(sheet.header[place])[0])}"'
    message = f'"{shown(cell)}" {column} is not a number'
    remedy = "write a number, or leave the cell empty"
    if re.match(r"\d+[:/-]\d+", cell):
        message = f'"{shown(cell)}" {column} is a clock time or a date'
        remedy = "write the time as a number, counted from the start of the record, e.g. in s"
    raise InputError(Diagnostic(message, remedy, file=sheet.name, line=line))


def _skipped(line: str, separator: str = ",") -> bool:
    """Whether a line contains no sample: it is blank, a comment, or only separators."""
    bare = line.strip(" ,\t\xa0" + separator)
    return not bare or ("#" in line and _COMMENT.match(line) is not None)


def _next(lines: Sequence[str], first: int) -> int:
    """Index of the next line that is neither blank nor a comment."""
    while first < len(lines) and _skipped(lines[first], ";"):
        first += 1
    return first


def _commented(lines: Sequence[str], at: int, name: str) -> tuple[int, str, int]:
    """Read the heading from the last comment above the samples.

    Returns its line number, its text, and the index of the next line.
    """
    above = [k for k in range(at) if lines[k].strip()]
    if above:
        header = lines[above[-1]].strip().lstrip("#").strip()
        separator = _separator(header, lines[at])
        columns = len(_cells(header, separator))
        if columns > 1 and columns == len(_cells(lines[at], separator)):
            return above[-1], header, at
    message = "no header: the first line that is not a comment begins with a number"
    remedy = 'name the columns with their units, e.g. "t [s],p1 [bar],p2 [bar],x [mm]"'
    raise InputError(Diagnostic(message, remedy, file=name, line=at + 1))


def _separator(header: str, following: str) -> str:
    """The separator that splits the heading and the next line into equally many cells."""
    candidates = [sign for sign in "\t;," if sign in header]
    for sign in candidates:
        if len(_cells(header, sign)) == len(_cells(following, sign)):
            return sign
    return candidates[0] if candidates else ","


def _cells(line: str, separator: str) -> list[str]:
    """Cells of a line; a separator within double quotes does not separate."""
    cells = line.split(separator)
    if '"' in line:
        try:
            cells = next(csv.reader([line], delimiter=separator, skipinitialspace=True), cells)
        except csv.Error:  # a cell longer than the limit of the module csv
            cells = line.split(separator)
    return [cell.strip().strip('"').strip() for cell in cells]


def _units_row(line: str, separator: str, count: int) -> list[str] | None:
    """Units from a separate line below the heading; None if the line has no units."""
    cells = [cell.strip("[]() ") for cell in _cells(line, separator)]
    while len(cells) > count and not cells[-1]:
        cells.pop()
    if len(cells) != count or any(re.match(r"[-+.,]?\d(?!/)", cell) for cell in cells):
        return None
    texts = [cell for cell in cells if cell and not is_number(cell)]
    if all(cell.lower() in ABSENT for cell in texts) or any(map(is_number, cells)):
        return None
    return cells


_HEADER = re.compile(
    r"(?P<name>.*?)\s*(?:\[(?P<square>[^\[\]]*)\]|\((?P<round>(?:[^()]|\([^()]*\))*)\))\s*"
)
_LONGEST = 200
"""Largest number of characters of a cell that is searched for a unit (our choice: a longer text is
no heading)."""


_ABSOLUTE = re.compile(
    r"(?i)(?P<unit>(?:[mkh]?pa|m?bar|psi))[\s_]*\(?(?P<kind>a|abs|absolute|g|gauge)\)?\.?"
)
_SIGNS = (("µ", "u"), ("μ", "u"), ("℃", "°C"), ("℉", "°F"), ("º", "°"))
_SECONDS = {"sec": "s", "secs": "s", "second": "s", "seconds": "s", "msec": "ms"}
ATMOSPHERE = units.unit("atm", "pressure").to_si(1.0)
"""Standard atmosphere [Pa], by which absolute pressures exceed gauge pressures."""
_LARGEST = 1e30
"""Largest value of a sample, SI. Larger values count as missing, because loggers write values such
as 1e38 for a missing sample (our choice)."""


class RecordColumn(NamedTuple):
    """The column of a channel, with its unit."""

    place: int
    unit: units.Unit
    absolute: bool

    def values(self, written: Array) -> Array:
        """Values in SI, pressures as gauge; values that are not finite count as missing."""
        with np.errstate(over="ignore", invalid="ignore"):
            values = np.asarray(self.unit.to_si(written))
            if self.absolute:
                values = values - ATMOSPHERE
            return np.where(np.abs(values) < _LARGEST, values, np.nan)


def converted(unit: str, dimension: str, place: int) -> RecordColumn:
    """A column with its unit as written in the heading; an unknown unit raises `UnitError`."""
    return RecordColumn(place, *unit_of_heading(unit, dimension))


def header_cells(sheet: Sheet) -> list[tuple[str, str]]:
    """Name and unit of every column; the units may be in a separate line below the heading."""
    cells = [named_cell(cell) for cell in sheet.header]
    if sheet.units is None:
        return cells
    return [(name, unit or sheet.units[k]) for k, (name, unit) in enumerate(cells)]


def named_cell(cell: str) -> tuple[str, str]:
    """Name and unit from a cell of the heading; the unit is empty if the cell has none."""
    match = _HEADER.fullmatch(cell) if len(cell) <= _LONGEST else None
    if match is not None:
        return match["name"], (match["square"] or match["round"] or "").strip()
    name, _, unit = cell.partition("/")
    return name.strip(), unit.strip()


def unit_of_heading(text: str, dimension: str) -> tuple[units.Unit, bool]:
    """The unit in a heading, and whether it is an absolute pressure."""
    text = " ".join(text.split())
    for sign, plain in _SIGNS:
        text = text.replace(sign, plain)
    text = _SECONDS.get(text.lower(), text).replace("° ", "°").replace("deg ", "deg")
    absolute = False
    if dimension == "pressure" and (match := _ABSOLUTE.fullmatch(text)) is not None:
        text, absolute = match["unit"], match["kind"].lower().startswith("a")
        text = {name.lower(): name for name in units.units_of(dimension)}.get(text.lower(), text)
    try:
        return units.unit(text, dimension), absolute
    except units.UnitError:
        alike = [name for name in units.units_of(dimension) if name.upper() == text]
        if len(alike) != 1:
            raise
        return units.unit(alike[0], dimension), absolute
