"""Test records: named columns with units as a bench writes them, read into SI."""

from __future__ import annotations

import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .. import units
from ..errors import Diagnostic, InputError
from ..numeric import Array
from ..suggest import remedy as remedy_for


class Channel(NamedTuple):
    """A quantity that a record can hold: dimension, label, and other names benches give it."""

    dimension: str
    label: str
    others: tuple[str, ...]


CHANNELS = {
    "t": Channel("time", "time", ("time",)),
    "p1": Channel(
        "pressure", "pressure of the cap-end chamber", ("pa", "pressure1", "pressurea", "pcap")
    ),
    "p2": Channel(
        "pressure", "pressure of the rod-end chamber", ("pb", "pressure2", "pressureb", "prod")
    ),
    "x": Channel("length", "position, outwards", ("position", "displacement", "stroke")),
    "v": Channel("speed", "velocity, outwards", ("velocity", "speed")),
    "F_L": Channel(
        "force",
        "force of the load on the rod, against extension",
        ("fl", "f", "force", "load", "loadforce", "loadcell"),
    ),
    "T": Channel(
        "temperature", "temperature of the oil", ("temperature", "temp", "oiltemperature")
    ),
    "w": Channel("length", "deflection of a bending test", ("deflection",)),
}
"""Channels by their name, as a header writes it: ``t [s]``, ``p1 [bar]``. Pressures are gauge."""

_BRACKETS = re.compile(r"(?P<name>.*?)\s*[\[(]\s*(?P<unit>[^\])]*?)\s*[\])]\s*")
_ABSENT = {"", "-", "--", "na", "n/a", "nan", "null", "none", "#n/a", "inf", "-inf", "+inf"}
_SHOWN = 60
"""Letters of a cell or a list of columns that a message repeats."""


@dataclass(frozen=True, slots=True, eq=False)
class Record:
    """A test record, SI; NaN where a sample is missing.

    Parameters
    ----------
    time : (samples) [s]
    channels : by name of `CHANNELS`, `t` left out (samples)
    name : of the file
    notes : what the reader left out
    first_line : of the samples in the file; None for a record that came from no file
    """

    time: Array
    channels: Mapping[str, Array]
    name: str = "record"
    notes: tuple[str, ...] = ()
    first_line: int | None = None

    def __getitem__(self, name: str) -> Array:
        return self.channels[name]

    def __contains__(self, name: object) -> bool:
        return name in self.channels

    def line(self, sample: int) -> int | None:
        """Line of a sample in its file."""
        return None if self.first_line is None else self.first_line + sample

    def fault(self, message: str, remedy: str, sample: int | None = None) -> InputError:
        """A fault of this record, with its place."""
        line = None if sample is None else self.line(sample)
        return InputError(Diagnostic(message, remedy, file=self.name, line=line))


def parse_record(
    text: str, *, name: str = "record", columns: Mapping[str, str] | None = None
) -> Record:
    """A record from the text of a CSV file.

    The first line that is no comment names the columns with their units, ``p1 [bar]`` or
    ``p1 (bar)`` or ``p1 / bar``; units may also stand in a line of their own below. Columns are
    separated by commas, semicolons or tabs; with the latter two a decimal comma is read.

    Parameters
    ----------
    text : of the file
    name : of the file, for messages
    columns : header by channel, where it is none of the known names; ``"Channel 3 [bar]"`` states
        the unit of a column ``Channel 3`` without one

    Returns
    -------
    the record; columns that are no channel are named in its notes

    Raises
    ------
    InputError
        no header, an unknown or doubled column, a missing or wrong unit, a cell that is no number
    """
    lines = text.split("\n")
    header_line, header, separator = _header(lines, name)
    cells = [cell.strip().strip('"').strip() for cell in header.split(separator)]
    below = header_line + 1
    while below < len(lines) and _skipped(lines[below]):
        below += 1
    units_row = _units_row(lines[below] if below < len(lines) else "", separator, len(cells))
    first = below + (units_row is not None)
    found = _columns(cells, units_row, columns or {}, name, header_line + 1)
    table = _table("\n".join(lines[first:]), separator, len(cells), name, first + 1)
    if not table.size:
        message = "no samples below the header"
        raise InputError(Diagnostic(message, "give one line per sample", file=name))
    values = {
        channel: _converted(table[:, place], unit) for channel, (place, unit) in found.items()
    }
    unused = [cell for i, cell in enumerate(cells) if i not in {x[0] for x in found.values()}]
    notes = (f"columns that are no channel: {_list(unused)}",) if unused else ()
    time = values.pop("t")
    return Record(time, values, name, notes, first + 1)


def _skipped(line: str) -> bool:
    stripped = line.strip()
    return not stripped or stripped.startswith("#")


def _header(lines: Sequence[str], name: str) -> tuple[int, str, str]:
    """Line of the header, its text, and what separates the columns."""
    for i, line in enumerate(lines):
        if _skipped(line):
            continue
        separator = next((one for one in "\t;," if one in line), ",")
        if _is_number(line.split(separator)[0]):
            message = "no header: the first line that is no comment begins with a number"
            remedy = 'name the columns with their units, e.g. "t [s],p1 [bar],p2 [bar],x [mm]"'
            raise InputError(Diagnostic(message, remedy, file=name, line=i + 1))
        return i, line.strip("\r\n"), separator
    raise InputError(Diagnostic("the record is empty", "give a CSV file", file=name))


def _is_number(cell: str) -> bool:
    try:
        float(cell.strip().replace(",", "."))
    except ValueError:
        return False
    return True


def _units_row(line: str, separator: str, count: int) -> list[str] | None:
    """The units that stand in a line of their own, if they do."""
    cells = [cell.strip().strip('"').strip("[]() ") for cell in line.split(separator)]
    texts = [cell for cell in cells if cell and not _is_number(cell)]
    if len(cells) != count or not texts or any(_is_number(cell) for cell in cells):
        return None
    return None if all(cell.lower() in _ABSENT for cell in cells) else cells


def _named(cell: str) -> tuple[str, str]:
    """Name and unit of a header cell; no unit is empty."""
    match = _BRACKETS.fullmatch(cell)
    if match is not None:
        return match["name"], match["unit"]
    name, _, unit = cell.partition("/")
    return name.strip(), unit.strip()


def _plain(name: str) -> str:
    """A name without case, blanks and signs."""
    return re.sub(r"[\W_]", "", name).lower()


def _channel(name: str) -> str | None:
    """The channel a header name means."""
    if name in CHANNELS:
        return name
    plain = _plain(name)
    for channel, one in CHANNELS.items():
        if plain in (_plain(channel), *one.others):
            return channel
    return None


def _columns(
    cells: Sequence[str],
    units_row: Sequence[str] | None,
    stated: Mapping[str, str],
    name: str,
    line: int,
) -> dict[str, tuple[int, units.Unit]]:
    """Column and unit of every channel."""
    faults: list[Diagnostic] = []

    def fault(message: str, remedy: str) -> None:
        faults.append(Diagnostic(message, remedy, file=name, line=line))

    own = [_named(cell) for cell in cells]
    if units_row is not None:
        own = [(a, b or units_row[i]) for i, (a, b) in enumerate(own)]
    names = [one[0] for one in own]
    places: dict[str, int] = {}
    for channel, header in stated.items():
        if channel not in CHANNELS:
            fault(f'"{channel}" is no channel', f"use one of {', '.join(CHANNELS)}")
            continue
        wanted, unit = _named(header)
        if wanted not in names:
            fault(f'no column "{_short(wanted)}" for {channel}', remedy_for(wanted, names))
            continue
        places[channel] = names.index(wanted)
        if unit:
            own[places[channel]] = (wanted, unit)
    for i, (header, _) in enumerate(own):
        found = _channel(header)
        if found is None or found in stated or i in places.values():
            continue
        if found in places:
            other = cells[places[found]]
            fault(
                f'columns "{_short(other)}" and "{_short(cells[i])}" are both {found}',
                f'say which with --column "{found}=NAME", or rename one',
            )
        places.setdefault(found, i)
    if "t" not in places:
        fault(f"no column t; columns are {_list(names)}", 'name it with --column "t=NAME [s]"')
    read = {}
    for channel, i in places.items():
        known, (header, unit) = CHANNELS[channel], own[i]
        if not unit:
            example = units.units_of(known.dimension)[0]
            fault(
                f'column "{_short(header)}" states no unit',
                f'write e.g. "{_short(header)} [{example}]" into the header, or '
                f'--column "{channel}={_short(header)} [{example}]"',
            )
            continue
        try:
            read[channel] = i, units.unit(unit, known.dimension)
        except units.UnitError as error:
            fault(f'column "{_short(header)}": {error.message}', error.remedy)
    if faults:
        raise InputError(faults)
    return read


def _table(text: str, separator: str, columns: int, name: str, first: int) -> Array:
    """The cells as numbers, NaN where there is none."""
    if separator != "," and "," in text:
        text = text.replace(",", ".")
    try:
        return np.loadtxt(io.StringIO(text), delimiter=separator, ndmin=2, comments=None)
    except ValueError:
        pass
    rows = []
    for i, line in enumerate(text.split("\n")):
        if not line.strip():
            continue
        cells = [cell.strip().strip('"').strip() for cell in line.split(separator)]
        if len(cells) != columns:
            message = f"{len(cells)} cells, the header has {columns} columns"
            remedy = "give every line as many cells as the header"
            raise InputError(Diagnostic(message, remedy, file=name, line=first + i))
        rows.append([_number(cell, name, first + i) for cell in cells])
    return np.array(rows)


def _number(cell: str, name: str, line: int) -> float:
    try:
        return float(cell)
    except ValueError:
        if cell.lower() in _ABSENT:
            return float("nan")
    message = f'"{_short(cell)}" is no number'
    raise InputError(
        Diagnostic(message, "write a number, or leave the cell empty", file=name, line=line)
    )


def _converted(values: Array, unit: units.Unit) -> Array:
    """SI values; what is not finite is missing."""
    return np.where(np.isfinite(values), values * unit.scale + unit.offset, np.nan)


def _short(text: str) -> str:
    return text if len(text) <= _SHOWN else f"{text[: _SHOWN - 3]}..."


def _list(names: Sequence[str]) -> str:
    """Names in quotes, as many as a line holds."""
    return _short(", ".join(f'"{name}"' for name in names))
