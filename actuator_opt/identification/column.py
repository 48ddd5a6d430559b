"""One column of a CSV file over its time: the input of a simulation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..base.errors import Diagnostic, InputError, remedy as remedy_for, shown
from ..base.fitting import quantile
from ..base.numeric import Array
from ..base.units import UnitError
from ..studies.bench import Bench
from .balance import Sliding
from .column_units import NONE, ColumnUnits
from .conditioning import ConditionedRecord
from .record import CHANNELS, column_of, contradicted, converted, header_cells, numbers, read_sheet

FEWEST = 2
"""Least number of samples of a signal."""


def parse_column(
    text: str, header: str, dimension: str, *, name: str, units: ColumnUnits = NONE
) -> tuple[Array, Array]:
    """Time [s] and values [SI] of a column, named by its header with or without its unit.

    Missing samples are NaN.

    Parameters
    ----------
    text : of the file
    header : of the column; ``"U [V]"`` states the unit of a column ``U`` without one
    dimension : of the quantity, "voltage"
    name : of the file, for messages
    units : of columns whose header states none

    Raises
    ------
    InputError
        no such column, no time, no unit or one of another dimension, contradictory units, times
        that do not increase, no samples
    """
    sheet = read_sheet(text, name)
    cells = header_cells(sheet)
    names = [one[0] for one in cells]

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
    own = cells[place][1]
    if own and unit and own != unit and header.strip() != sheet.header[place].strip():
        message = f'column "{shown(sheet.header[place])}" is in {shown(own)}, not {shown(unit)}'
        raise fault(message, f'name it "{shown(cells[place][0])} [{shown(own)}]"')
    clock = next((k for k, (one, _) in enumerate(cells) if one.strip().lower() in _TIMES), None)
    if clock is None:
        raise fault("no column t", 'add one with its unit, "t [s]"')
    moment, title = cells[clock], cells[place][0]
    unit = unit or units.of(title, dimension)
    if not unit:
        raise fault(f'column "{shown(header)}" states no unit', 'name it with one, e.g. "U [V]"')
    try:
        columns = [
            converted(moment[1] or units.of(moment[0], "time") or "s", "time", clock),
            converted(unit, dimension, place),
        ]
        for column, named in zip(columns, (moment[0], title), strict=True):
            if other := contradicted(column, named, units):
                message = f'column "{shown(named)}" is in {column.unit.name}, not {other}'
                raise InputError(Diagnostic(message, "correct one of them", file=units.name))
    except UnitError as error:
        message = f'column "{shown(header)}": {shown(error.message, 120)}'
        raise fault(message, shown(error.remedy, 120)) from None
    table, lines = numbers(sheet, [clock, place])
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


WINDOW = 0.1
"""Averaging time of friction and contact force [s] (a choice: six independent samples at 30 Hz; a
single one is ill-posed)."""


LEAST_SPEED = 1e-3
"""Least mean speed of a window [m/s] (a choice: ten steps of 10 um in it show its direction)."""


@dataclass(frozen=True, slots=True)
class Coefficient:
    """Median of mu = F_r/N over windows of sliding, SI.

    Parameters
    ----------
    value, lower, upper : [-], 95 % bounds of the median
    contact_force : N, normal force of all rings, median over the windows [N]
    contact_pressure : N over the rings' contact areas [Pa]
    windows : how many
    law : contact laws of the rings
    speeds : lowest and highest mean speed of the windows [m/s]
    """

    value: float
    lower: float
    upper: float
    contact_force: float
    contact_pressure: float
    windows: int
    law: str
    speeds: tuple[float, float]


def coefficient(
    slidings: Sequence[Sliding], motion: ConditionedRecord, bench: Bench
) -> Coefficient | str:
    """The friction coefficient of a record, or the reason for none.

    mu = F_r/sum f_i pi D_i, f the line loads of the design's contact laws at the chamber pressures.
    Squeeze and pressure both load the rings, so no pressure difference is needed.

    Parameters
    ----------
    slidings, motion : friction along the record
    bench : the rings

    Returns
    -------
    median over windows with bounds from the order statistics, or the reason for none
    """
    rows = np.concatenate([_windows(one, motion) for one in slidings])
    if rows.shape[0] < 2:
        return (
            f"no sliding of {WINDOW:g} s above {1e3 * LEAST_SPEED:g} mm/s in one direction: "
            "no friction coefficient"
        )
    forces = bench.contact_forces(rows[:, 1], rows[:, 2])
    normal = sum(forces.values())
    ratios = np.sort(rows[:, 0] / normal)
    count = ratios.size
    half = quantile(count - 1) * np.sqrt(count) / 2
    low = int(np.clip(np.floor(count / 2 - half), 0, count - 1))
    high = int(np.clip(np.ceil(count / 2 + half), 0, count - 1))
    first, second = float(np.median(rows[:, 1])), float(np.median(rows[:, 2]))
    return Coefficient(
        float(np.median(ratios)),
        float(ratios[low]),
        float(ratios[high]),
        float(np.median(normal)),
        bench.contact_pressure(first, second),
        count,
        bench.contact_law,
        (float(np.min(rows[:, 3])), float(np.max(rows[:, 3]))),
    )


def _windows(sliding: Sliding, motion: ConditionedRecord) -> Array:
    """Friction along motion, both pressures and speed of every window (windows, 4)."""
    size = max(round(WINDOW / motion.sample_time), 1)
    piece = sliding.piece
    count = piece.time.size // size

    def cut(values: Array) -> Array:
        return values[: count * size].reshape(count, size)

    way = np.sign(piece.velocity)
    kept = np.all(cut(sliding.moving), axis=1) & (np.abs(np.sum(cut(way), axis=1)) == size)
    kept &= np.mean(np.abs(cut(piece.velocity)), axis=1) > LEAST_SPEED
    second = piece.channels.get("p2", np.zeros_like(piece.time))
    parts = (sliding.friction * way, piece["p1"], second, np.abs(piece.velocity))
    return np.stack([np.mean(cut(one), axis=1)[kept] for one in parts], axis=1)
