"""Test records: read files of a test bench that name columns and units; convert them to SI."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..base import units
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, remedy as remedy_for, shown
from ..base.numeric import Array
from ..base.sheets import (
    RecordColumn,
    Sheet,
    converted,
    header_cells,
    named_cell,
    numbers,
    read_sheet,
    unit_of_heading,
)
from ..base.units import UnitError
from .column_units import NONE, ColumnUnits


class Channel(NamedTuple):
    """A quantity that a record can have: dimension, usual unit, label and alternative names."""

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
        "force of the load on the rod, positive if it opposes extension",
        ("fl", "f", "force", "load", "loadforce", "loadcell"),
    ),
    "T": Channel(
        "temperature", "degC", "temperature of the oil", ("temperature", "temp", "oiltemperature")
    ),
    "w": Channel("length", "mm", "deflection of a bending test", ("deflection",)),
}
"""Channels by name, as in a heading such as ``t [s]`` or ``p1 [bar]``. Pressures are gauge."""

_OPTIONAL = ("v", "T")
"""Channels that are ignored if their unit does not fit, because, for example, a column "Speed
[rpm]" is not the speed of the rod."""
FEWEST = 2
"""Smallest number of samples of a signal."""
_FALLS = ("time does not increase", "sort the lines by time and remove repeated ones")
_TIMES = ("t", *CHANNELS["t"].others)


@dataclass(frozen=True, slots=True, eq=False)
class Record:
    """A test record, SI; NaN where a sample is missing.

    Parameters
    ----------
    time : times of the samples [s]
    channels : values of the samples by name of the channel, as in `CHANNELS` but without `t`
    name : name of the file
    notes : notes on columns that are ignored and on units that are assumed
    first_line : line number of the first sample in the file; None for a record without a file
    lines : line number of every sample, if comments or blank lines lie between samples
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
        """Name of the file without its folder, as a page and a design file show it."""
        return shown(Path(self.name).name.strip(), 100) or "record"

    def line(self, sample: int) -> int | None:
        """Line number of a sample in the file; None without a file."""
        if self.lines is not None:
            return int(self.lines[sample])
        return None if self.first_line is None else self.first_line + sample

    def fault(self, message: str, remedy: str, sample: int | None = None) -> InputError:
        """Create an error that names this record and, if `sample` is given, its line."""
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

    The first line that is not a comment names the columns with their units: ``p1 [bar]``, ``p1
    (bar)`` or ``p1 / bar``. The units may also be in a separate line below. Columns are separated
    by commas, semicolons or tabs; with semicolons or tabs, decimal commas are accepted. Absolute
    pressures (``bara``, ``psi abs``) are converted to gauge pressures with the standard atmosphere,
    and a note says so.

    Parameters
    ----------
    text : text of the file
    name : name of the file, for messages
    columns : headings of columns that do not name their channel in a known way, by channel, such as
        ``{"p1": "Channel 3"}``. ``"Channel 3 [bar]"`` also states the unit, if the file does not
    channels : channels to read, including ``t``
    units : units of columns whose heading states none
    needed : channels that must have a unit, besides ``t`` and those of `columns`. Other channels
        without a unit are ignored. Default: all channels but ``v`` and ``T``

    Returns
    -------
    the record; its notes list the columns that are not channels or have no unit

    Raises
    ------
    InputError
        no heading, an unknown or repeated column, a missing or wrong unit, contradictory units, or
        a cell that is not a number
    """
    sheet = read_sheet(text, name)
    required = set(channels) - set(_OPTIONAL) if needed is None else set(needed)
    stated = columns or {}
    by_channel, notes = _columns(sheet, stated, channels, units, {"t", *required, *stated})
    table, lines = numbers(sheet, [column.place for column in by_channel.values()])
    if not lines.size:
        message = "no samples below the header"
        raise InputError(Diagnostic(message, "give one line per sample", file=name))
    values = {
        channel: column.values(table[:, k])
        for k, (channel, column) in enumerate(by_channel.items())
    }
    notes += [
        f"{channel} is an absolute pressure; it was converted to gauge with the standard "
        "atmosphere of 1.01325 bar"
        for channel, column in by_channel.items()
        if column.absolute
    ]
    first = int(lines[0])
    broken = int(lines[-1]) - first + 1 != lines.size
    time = values.pop("t")
    return Record(time, values, name, tuple(notes), first, lines if broken else None)


def _plain(name: str) -> str:
    """A name in lower case, without spaces and symbols."""
    return re.sub(r"[\W_]", "", name).lower()


def _is_unit(text: str, dimension: str) -> bool:
    """Whether a text is a unit of a dimension."""
    try:
        unit_of_heading(text, dimension)
    except units.UnitError:
        return False
    return True


def _channel(name: str, unit: str, channels: Mapping[str, Channel]) -> str | None:
    """The channel that a heading names, or None; the unit decides between time and temperature."""
    plain = _plain(name)
    alike = [c for c, known in channels.items() if plain in (_plain(c), *known.others)]
    fitting = [c for c in alike if _is_unit(unit, channels[c].dimension)]
    if name in fitting or (name in alike and not fitting):
        return name
    if fitting or not alike:
        return fitting[0] if fitting else None
    return None if unit and alike[0] in _OPTIONAL else alike[0]


def column_of(sheet: Sheet, cells: list[tuple[str, str]], header: str) -> tuple[int, str]:
    """Index of the column with a given heading, and its unit.

    `header` is the heading as the caller states it, with or without a unit. `cells` are name and
    unit of every column.

    Raises
    ------
    LookupError
        no column or several columns have this name; the argument of the error is their number
    """
    stated_name, unit = named_cell(header)
    names = [cell[0] for cell in cells]
    for name, column_unit, among in (
        (header.strip(), "", sheet.header),
        (stated_name, unit, sheet.header),
        (stated_name, unit, names),
        (header.strip(), "", names),
    ):
        if among.count(name) == 1:
            place = among.index(name)
            return place, column_unit or cells[place][1]
        if among.count(name):
            raise LookupError(among.count(name))
    raise LookupError(0)


def _columns(
    sheet: Sheet,
    stated: Mapping[str, str],
    channels: Mapping[str, Channel],
    given: ColumnUnits,
    needed: Collection[str],
) -> tuple[dict[str, RecordColumn], list[str]]:
    """Column and unit of every channel; notes on ignored columns, and on units from `given`."""
    faults: list[Diagnostic] = []

    def fault(message: str, remedy: str, file: str = sheet.name) -> None:
        if not any(fault.message == message for fault in faults):
            line = sheet.header_line if file == sheet.name else None
            faults.append(Diagnostic(message, remedy, file=file, line=line))

    in_header = header_cells(sheet)
    places = _stated_places(sheet, in_header, stated, channels, fault)
    cells = [(name, unit or given.stated.get(name, "")) for name, unit in in_header]
    _place_by_header(sheet, cells, places, stated, channels, fault)
    columns: dict[str, RecordColumn] = {}
    unitless: list[int] = []
    for channel, i in places.items():
        known, (name, unit) = channels[channel], cells[i]
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
            file = sheet.name if in_header[i][1] or given.si else given.name
            try:
                columns[channel] = converted(unit, known.dimension, i)
                other = contradicted(columns[channel], name, given)
            except units.UnitError as error:
                message = f'column "{header}": {shown(error.message, 120)}'
                fault(message, shown(error.remedy, 120), file)
            else:
                if other:
                    message = (
                        f'column "{header}" is in {shown(unit)} according to the header, not '
                        f"{other}"
                    )
                    fault(message, "correct one of them", given.name)
    if faults:
        raise InputError(faults)
    left_out = [cells[i][0] for i in unitless]
    notes = _column_notes(sheet, channels, set(places.values()), left_out)
    used = [i for i in places.values() if i not in unitless and not in_header[i][1]]
    if used:
        source = "SI units" if given.si else f"units of {shown(Path(given.name).name)}"
        names = _list([shown(cells[i][0]) for i in used])
        notes.append(f"{source} used, as the header states no units: {names}")
    return columns, notes


def _place_by_header(
    sheet: Sheet,
    cells: list[tuple[str, str]],
    places: dict[str, int],
    stated: Mapping[str, str],
    channels: Mapping[str, Channel],
    fault: Callable[[str, str], None],
) -> None:
    """Add the channels that the heading names to `places`; a channel named twice is an error."""
    taken = set(places.values())
    doubled = set()
    for i, (header, unit) in enumerate(cells):
        channel = _channel(header, unit, channels)
        if channel is None or channel in stated or i in taken or channel in doubled:
            continue
        if channel in places:
            doubled.add(channel)
            first, second = sheet.header[places[channel]], sheet.header[i]
            fault(
                f'columns "{shown(first)}" and "{shown(second)}" both name the channel {channel}',
                "rename or delete one"
                if first == second
                else f'choose a column with --column "{channel}=NAME", or rename one',
            )
        places.setdefault(channel, i)
    if "t" not in places and "t" not in stated:
        fault(
            f"no column t; columns are {_list([first[0] for first in cells])}",
            'name it with --column "t=NAME [s]"'
            if len(cells) > 1
            else 'separate columns by commas, semicolons or tabs, begin other lines with "#"',
        )


def _column_notes(
    sheet: Sheet, channels: Collection[str], used: set[int], unitless: Sequence[str]
) -> list[str]:
    """Notes on columns that are not channels or have no unit."""
    unused = [cell for k, cell in enumerate(sheet.header) if cell and k not in used]
    notes = []
    if unused:
        known = ", ".join(name for name in channels if name != "t")
        notes.append(
            f"columns ignored, as they are not channels: {_list(unused)}; channels are {known}"
        )
    if unitless:
        notes.append(f"columns left out because they have no unit: {_list(unitless)}")
    return notes


def contradicted(column: RecordColumn, name: str, given: ColumnUnits) -> str:
    """Error message if `given` and a column's heading state different units, else empty."""
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
    cells: list[tuple[str, str]],
    stated: Mapping[str, str],
    channels: Mapping[str, Channel],
    fault: Callable[[str, str], None],
) -> dict[str, int]:
    """Index of the column of each channel for which the caller stated a heading.

    If the heading was stated with a unit, the unit is written into `cells`.
    """
    places: dict[str, int] = {}
    for channel, header in stated.items():
        if channel not in channels:
            fault(f'"{shown(channel)}" is not a channel', f"use one of {', '.join(channels)}")
            continue
        try:
            place, unit = column_of(sheet, cells, header)
        except LookupError as error:
            stated_name = shown(named_cell(header)[0])
            if error.args[0]:
                fault(f'{error.args[0]} columns are called "{stated_name}"', "rename all but one")
            else:
                remedy = shown(remedy_for(stated_name, [cell[0] for cell in cells]), 200)
                fault(f'no column "{stated_name}" for {channel}', remedy)
            continue
        for other, taken in places.items():
            if taken == place:
                title = shown(sheet.header[place])
                fault(
                    f'column "{title}" is given for both {other} and {channel}', "name two columns"
                )
        places[channel] = place
        cells[place] = cells[place][0], unit
    return places


def _list(names: Sequence[str]) -> str:
    """The names in quotes, joined to a text; names that do not fit in one line are left out."""
    return shown(", ".join(f'"{name}"' for name in names))


def parse_column(
    text: str, header: str, dimension: str, *, name: str, units: ColumnUnits = NONE
) -> tuple[Array, Array]:
    """Time [s] and values [SI] of the column with a given heading; missing samples are NaN.

    Parameters
    ----------
    text : text of the file
    header : heading of the column; ``"U [V]"`` also states the unit of a column ``U`` that has none
    dimension : dimension of the quantity, such as "voltage"
    name : name of the file, for messages
    units : units of columns whose heading states none

    Raises
    ------
    InputError
        the column or the time is missing, a unit is missing, contradictory or of another dimension,
        times do not increase, or there are no samples
    """
    sheet = read_sheet(text, name)
    cells = header_cells(sheet)
    names = [cell[0] for cell in cells]

    def fault(message: str, remedy: str) -> InputError:
        return InputError(Diagnostic(message, remedy, file=name, line=sheet.header_line))

    try:
        place, unit = column_of(sheet, cells, header)
    except LookupError as error:
        if error.args[0]:
            message = f'{error.args[0]} columns are called "{shown(header)}"'
            raise fault(message, "rename all but one") from None
        remedy = shown(remedy_for(header, names), 200)
        raise fault(f'no column "{shown(header)}"', remedy) from None
    header_unit, exact = cells[place][1], header.strip() == sheet.header[place].strip()
    if header_unit and unit and header_unit != unit and not exact:
        message = (
            f'column "{shown(sheet.header[place])}" is in {shown(header_unit)}, not {shown(unit)}'
        )
        raise fault(message, f'name it "{shown(cells[place][0])} [{shown(header_unit)}]"')
    time_place = next(
        (k for k, cell in enumerate(cells) if cell[0].strip().lower() in _TIMES), None
    )
    if time_place is None:
        raise fault("no column t", 'add the time with its unit, "t [s]"')
    time_cell, title = cells[time_place], cells[place][0]
    unit = unit or units.of(title, dimension)
    if not unit:
        raise fault(f'column "{shown(header)}" states no unit', 'name it with one, e.g. "U [V]"')
    try:
        columns = [
            converted(time_cell[1] or units.of(time_cell[0], "time") or "s", "time", time_place),
            converted(unit, dimension, place),
        ]
        for column, column_name in zip(columns, (time_cell[0], title), strict=True):
            if other := contradicted(column, column_name, units):
                message = f'column "{shown(column_name)}" is in {column.unit.name}, not {other}'
                raise InputError(Diagnostic(message, "correct one of them", file=units.name))
    except UnitError as error:
        message = f'column "{shown(header)}": {shown(error.message, 120)}'
        raise fault(message, shown(error.remedy, 120)) from None
    table, lines = numbers(sheet, [time_place, place])
    t, x = (column.values(table[:, k]) for k, column in enumerate(columns))
    if np.count_nonzero(np.isfinite(x)) < FEWEST:
        raise fault(
            f'column "{shown(header)}" has fewer than two samples', "give two samples or more"
        )
    for bad, message, remedy in (
        (~np.isfinite(t), "missing time", "give a time for every sample"),
        (np.diff(t, prepend=-np.inf) <= 0, *_FALLS),
    ):
        if np.any(bad):
            line = int(lines[np.argmax(bad)])
            raise InputError(Diagnostic(message, remedy, file=name, line=line))
    return t, x
