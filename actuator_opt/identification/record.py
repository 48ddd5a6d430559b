"""Test records: named columns with units as written by a test bench, converted to SI."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..base import units
from ..base.errors import Diagnostic, InputError
from ..base.numeric import Array
from ..base.suggest import remedy as remedy_for, shown
from ..models.fluid import ATMOSPHERIC_PRESSURE
from .column_units import NONE, ColumnUnits
from .csv_table import Sheet, numbers, read_sheet


class Channel(NamedTuple):
    """A quantity of a record: dimension, usual unit, label, alternative names."""

    dimension: str
    unit: str
    label: str
    others: tuple[str, ...]


CHANNELS = {
    "t": Channel("time", "s", "time", ("time",)),
    "p1": Channel(
        "pressure",
        "bar",
        "pressure of the cap-end chamber",
        ("pa", "pressure1", "pressurea", "pcap"),
    ),
    "p2": Channel(
        "pressure",
        "bar",
        "pressure of the rod-end chamber",
        ("pb", "pressure2", "pressureb", "prod"),
    ),
    "x": Channel("length", "mm", "position, outwards", ("position", "displacement", "stroke")),
    "v": Channel("speed", "mm/s", "velocity, outwards", ("velocity", "speed")),
    "F_L": Channel(
        "force",
        "N",
        "force of the load on the rod, against extension",
        ("fl", "f", "force", "load", "loadforce", "loadcell"),
    ),
    "T": Channel(
        "temperature", "degC", "temperature of the oil", ("temperature", "temp", "oiltemperature")
    ),
    "w": Channel("length", "mm", "deflection of a bending test", ("deflection",)),
}
"""Channels by their name, as a header writes it: ``t [s]``, ``p1 [bar]``. Pressures are gauge."""

_HEADER = re.compile(
    r"(?P<name>.*?)\s*(?:\[(?P<square>[^\[\]]*)\]|\((?P<round>(?:[^()]|\([^()]*\))*)\))\s*"
)
_LONGEST = 200
"""Maximum letters of a header cell with a unit (a choice: longer text is not a header)."""
_OPTIONAL = ("v", "T")
"""Optional channels: a column called "Speed [rpm]" is another speed."""
_ABSOLUTE = re.compile(
    r"(?i)(?P<unit>(?:[mkh]?pa|m?bar|psi))[\s_]*\(?(?P<kind>a|abs|absolute|g|gauge)\)?\.?"
)
_SIGNS = (("µ", "u"), ("μ", "u"), ("℃", "°C"), ("℉", "°F"), ("º", "°"))
_SECONDS = {"sec": "s", "secs": "s", "second": "s", "seconds": "s", "msec": "ms"}
_LARGEST = 1e30
"""Larger values, SI, are missing samples: loggers write 1e38 (a choice)."""


@dataclass(frozen=True, slots=True, eq=False)
class Record:
    """A test record, SI; NaN where a sample is missing.

    Parameters
    ----------
    time : (samples) [s]
    channels : by name of `CHANNELS`, without `t` (samples)
    name : of the file
    notes : what the reader left out
    first_line : of the samples in the file; None for a record without a file
    lines : of every sample in the file, if comments or blank lines lie between
    """

    time: Array
    channels: Mapping[str, Array]
    name: str = "record"
    notes: tuple[str, ...] = ()
    first_line: int | None = None
    lines: Array | None = None

    def __getitem__(self, name: str) -> Array:
        return self.channels[name]

    def __contains__(self, name: object) -> bool:
        return name in self.channels

    @property
    def file_name(self) -> str:
        """Name of its file without folders, suitable for a page and a design file."""
        return shown(Path(self.name).name.strip(), 100) or "record"

    def line(self, sample: int) -> int | None:
        """Line of a sample in its file."""
        if self.lines is not None:
            return int(self.lines[sample])
        return None if self.first_line is None else self.first_line + sample

    def fault(self, message: str, remedy: str, sample: int | None = None) -> InputError:
        """An error about this record, with its place."""
        line = None if sample is None else self.line(sample)
        return InputError(Diagnostic(message, remedy, file=self.name, line=line))


def parse_record(
    text: str,
    *,
    name: str = "record",
    columns: Mapping[str, str] | None = None,
    channels: Mapping[str, Channel] = CHANNELS,
    units: ColumnUnits = NONE,
    needed: Collection[str] | None = None,
) -> Record:
    """A record from the text of a CSV file.

    The first line that is not a comment names the columns with their units, ``p1 [bar]`` or ``p1
    (bar)`` or ``p1 / bar``; units may also stand in a separate line below. Columns are separated by
    commas, semicolons or tabs; with the latter two, decimal commas are accepted. Absolute
    pressures, ``bara`` or ``psi abs``, become gauge by the standard atmosphere, with a note.

    Parameters
    ----------
    text : of the file
    name : of the file, for messages
    columns : header by channel, if it is not a known name; ``"Channel 3 [bar]"`` states the unit of
        a column ``Channel 3`` without one
    channels : those to read, including ``t``
    units : of columns whose header states none
    needed : channels that must have a unit, beside ``t`` and those of `columns`; others without one
        are left out; default: all but ``v`` and ``T``

    Returns
    -------
    the record; notes list columns that are not channels or have no unit

    Raises
    ------
    InputError
        no header, an unknown or repeated column, a missing or wrong unit, contradictory units, or a
        cell that is not a number
    """
    sheet = read_sheet(text, name)
    asked = set(channels) - set(_OPTIONAL) if needed is None else set(needed)
    found, notes = _columns(sheet, columns or {}, channels, units, {"t", *asked, *(columns or {})})
    table, lines = numbers(sheet, [one.place for one in found.values()])
    if not lines.size:
        message = "no samples below the header"
        raise InputError(Diagnostic(message, "give one line per sample", file=name))
    values = {channel: one.values(table[:, k]) for k, (channel, one) in enumerate(found.items())}
    notes += [
        f"{channel}: absolute pressure, converted to gauge with the standard atmosphere of "
        "1.01325 bar"
        for channel, one in found.items()
        if one.absolute
    ]
    first = int(lines[0])
    broken = int(lines[-1]) - first + 1 != lines.size
    time = values.pop("t")
    return Record(time, values, name, tuple(notes), first, lines if broken else None)


class Column(NamedTuple):
    """Column and unit of a channel."""

    place: int
    unit: units.Unit
    absolute: bool

    def values(self, written: Array) -> Array:
        """SI values, pressures gauge; values that are not finite count as missing."""
        with np.errstate(over="ignore", invalid="ignore"):
            found = np.asarray(self.unit.to_si(written))
            if self.absolute:
                found = found - ATMOSPHERIC_PRESSURE
            return np.where(np.abs(found) < _LARGEST, found, np.nan)


def converted(unit: str, dimension: str, place: int) -> Column:
    """A column with a unit as written in a header; raises `UnitError`."""
    return Column(place, *_unit(unit, dimension))


def header_cells(sheet: Sheet) -> list[tuple[str, str]]:
    """Name and unit of every column; units may stand in a separate line."""
    own = [_named(cell) for cell in sheet.header]
    if sheet.units is None:
        return own
    return [(name, unit or sheet.units[k]) for k, (name, unit) in enumerate(own)]


def _named(cell: str) -> tuple[str, str]:
    """Name and unit of a header cell; empty without a unit."""
    match = _HEADER.fullmatch(cell) if len(cell) <= _LONGEST else None
    if match is not None:
        return match["name"], (match["square"] or match["round"] or "").strip()
    name, _, unit = cell.partition("/")
    return name.strip(), unit.strip()


def _plain(name: str) -> str:
    """A name in lower case without blanks and symbols."""
    return re.sub(r"[\W_]", "", name).lower()


def _unit(text: str, dimension: str) -> tuple[units.Unit, bool]:
    """The unit in a header, and whether it is an absolute pressure."""
    text = " ".join(text.split())
    for sign, plain in _SIGNS:
        text = text.replace(sign, plain)
    text = _SECONDS.get(text.lower(), text).replace("° ", "°").replace("deg ", "deg")
    absolute = False
    if dimension == "pressure" and (match := _ABSOLUTE.fullmatch(text)) is not None:
        text, absolute = match["unit"], match["kind"].lower().startswith("a")
        text = {one.lower(): one for one in units.units_of(dimension)}.get(text.lower(), text)
    try:
        return units.unit(text, dimension), absolute
    except units.UnitError:
        alike = [one for one in units.units_of(dimension) if one.upper() == text]
        if len(alike) != 1:
            raise
        return units.unit(alike[0], dimension), absolute


def _fits(text: str, dimension: str) -> bool:
    try:
        _unit(text, dimension)
    except units.UnitError:
        return False
    return True


def _channel(name: str, unit: str, channels: Mapping[str, Channel]) -> str | None:
    """The channel of a header name; the unit decides between t and T."""
    plain = _plain(name)
    alike = [c for c, one in channels.items() if plain in (_plain(c), *one.others)]
    fitting = [c for c in alike if _fits(unit, channels[c].dimension)]
    if name in fitting or (name in alike and not fitting):
        return name
    if fitting or not alike:
        return fitting[0] if fitting else None
    return None if unit and alike[0] in _OPTIONAL else alike[0]


def column_of(sheet: Sheet, own: list[tuple[str, str]], header: str) -> tuple[int, str]:
    """Column of a header named by the caller, and the unit stated with it.

    Raises
    ------
    LookupError
        with the number of columns of that name
    """
    wanted, unit = _named(header)
    names = [one[0] for one in own]
    for name, column_unit, among in (
        (header.strip(), "", sheet.header),
        (wanted, unit, sheet.header),
        (wanted, unit, names),
        (header.strip(), "", names),
    ):
        if among.count(name) == 1:
            place = among.index(name)
            return place, column_unit or own[place][1]
        if among.count(name):
            raise LookupError(among.count(name))
    raise LookupError(0)


def _columns(
    sheet: Sheet,
    stated: Mapping[str, str],
    channels: Mapping[str, Channel],
    given: ColumnUnits,
    needed: Collection[str],
) -> tuple[dict[str, Column], list[str]]:
    """Column and unit of every channel; notes on columns left out or read by `given`."""
    faults: list[Diagnostic] = []

    def fault(message: str, remedy: str, file: str = sheet.name) -> None:
        if not any(one.message == message for one in faults):
            line = sheet.header_line if file == sheet.name else None
            faults.append(Diagnostic(message, remedy, file=file, line=line))

    own = header_cells(sheet)
    places = _stated_places(sheet, own, stated, channels, fault)
    before = own
    own = [(name, unit or given.stated.get(name, "")) for name, unit in before]
    _place_by_header(sheet, own, places, stated, channels, fault)
    read: dict[str, Column] = {}
    unitless: list[int] = []
    for channel, i in places.items():
        known, (name, unit) = channels[channel], own[i]
        header, unit = shown(name), unit or given.of(name, known.dimension)
        if not unit and channel not in needed:
            unitless.append(i)
        elif not unit:
            fault(
                f'column "{header}" states no unit',
                f'write e.g. "{header} [{known.unit}]" into the header, --column '
                f'"{channel}={header} [{known.unit}]", or --units SI for all',
            )
        else:
            place = sheet.name if before[i][1] or given.si else given.name
            try:
                read[channel] = converted(unit, known.dimension, i)
                other = contradicted(read[channel], name, given)
            except units.UnitError as error:
                message = f'column "{header}": {shown(error.message, 120)}'
                fault(message, shown(error.remedy, 120), place)
            else:
                if other:
                    message = (
                        f'column "{header}" is in {shown(unit)} according to the header, not '
                        f"{other}"
                    )
                    fault(message, "correct one of them", given.name)
    if faults:
        raise InputError(faults)
    notes = _column_notes(sheet, set(places.values()), [own[i][0] for i in unitless])
    by_units = [shown(own[i][0]) for i in places.values() if i not in unitless and not before[i][1]]
    if by_units:
        whose = "SI units" if given.si else f"units of {shown(Path(given.name).name)}"
        notes.append(f"{whose} used, as the header states none: {_list(by_units)}")
    return read, notes


def _place_by_header(
    sheet: Sheet,
    own: list[tuple[str, str]],
    places: dict[str, int],
    stated: Mapping[str, str],
    channels: Mapping[str, Channel],
    fault: Callable[[str, str], None],
) -> None:
    """Add the channels named by the header to `places`; a channel named twice is an error."""
    taken = set(places.values())
    doubled = set()
    for i, (header, unit) in enumerate(own):
        found = _channel(header, unit, channels)
        if found is None or found in stated or i in taken or found in doubled:
            continue
        if found in places:
            doubled.add(found)
            one, other = sheet.header[places[found]], sheet.header[i]
            fault(
                f'columns "{shown(one)}" and "{shown(other)}" are both {found}',
                "rename or delete one"
                if one == other
                else f'say which with --column "{found}=NAME", or rename one',
            )
        places.setdefault(found, i)
    if "t" not in places and "t" not in stated:
        fault(
            f"no column t; columns are {_list([one[0] for one in own])}",
            'name it with --column "t=NAME [s]"'
            if len(own) > 1
            else 'separate columns by commas, semicolons or tabs, begin other lines with "#"',
        )


def _column_notes(sheet: Sheet, used: set[int], unitless: Sequence[str]) -> list[str]:
    """Notes on columns that are not channels or have no unit."""
    unused = [cell for k, cell in enumerate(sheet.header) if cell and k not in used]
    notes = [f"columns that are not channels: {_list(unused)}"] if unused else []
    if unitless:
        notes.append(f"columns without a unit, left out: {_list(unitless)}")
    return notes


def contradicted(column: Column, name: str, given: ColumnUnits) -> str:
    """The unit in `given` that contradicts a column's own; empty if it agrees."""
    stated = given.stated.get(name, "")
    if not stated:
        return ""
    other = converted(stated, column.unit.dimension, column.place)
    same = (column.unit.scale, column.unit.offset, column.absolute) == (
        other.unit.scale,
        other.unit.offset,
        other.absolute,
    )
    return "" if same else shown(stated)


def _stated_places(
    sheet: Sheet,
    own: list[tuple[str, str]],
    stated: Mapping[str, str],
    channels: Mapping[str, Channel],
    fault: Callable[[str, str], None],
) -> dict[str, int]:
    """Columns named by the caller; their units are added to `own`."""
    places: dict[str, int] = {}
    for channel, header in stated.items():
        if channel not in channels:
            fault(f'"{shown(channel)}" is not a channel', f"use one of {', '.join(channels)}")
            continue
        try:
            place, unit = column_of(sheet, own, header)
        except LookupError as error:
            wanted = shown(_named(header)[0])
            if error.args[0]:
                fault(f'{error.args[0]} columns are called "{wanted}"', "rename all but one")
            else:
                remedy = shown(remedy_for(wanted, [one[0] for one in own]), 200)
                fault(f'no column "{wanted}" for {channel}', remedy)
            continue
        for other, taken in places.items():
            if taken == place:
                title = shown(sheet.header[place])
                fault(
                    f'column "{title}" is given for both {other} and {channel}', "name two columns"
                )
        places[channel] = place
        own[place] = own[place][0], unit
    return places


def _list(names: Sequence[str]) -> str:
    """Names in quotes, as many as fit in a line."""
    return shown(", ".join(f'"{name}"' for name in names))
