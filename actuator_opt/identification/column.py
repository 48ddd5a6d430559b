"""Read one column of a CSV file over time, as input of a simulation."""

from __future__ import annotations

import numpy as np

from ..base.errors import Diagnostic, InputError, remedy as remedy_for, shown
from ..base.numeric import Array
from ..base.units import UnitError
from .column_units import NONE, ColumnUnits
from .record import CHANNELS, column_of, contradicted, converted, header_cells, numbers, read_sheet

FEWEST = 2
"""Smallest number of samples of a signal."""


def parse_column(
    text: str, header: str, dimension: str, *, name: str, units: ColumnUnits = NONE
) -> tuple[Array, Array]:
    """Time [s] and values [SI] of a column, chosen by its heading with or without the unit.

    Missing samples are NaN.

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
        raise fault("no column t", 'add one with its unit, "t [s]"')
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


_FALLS = ("time does not increase", "sort the lines by time and remove repeated ones")
_TIMES = ("t", *CHANNELS["t"].others)
