"""The flow curve of a valve: a table of flow over signal, as CSV, in a file or written out.

The first column is the signal (``signal [%]`` of the full signal, or ``signal [V]``). A column
``q [l/min]`` is the flow of whichever edges the signal opens. Four columns ``q_pa``, ``q_pb``,
``q_at`` and ``q_bt`` are the flows of single edges. All flows apply at one pressure drop per edge.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import isfinite
from typing import NamedTuple

from ..base import sheets, units
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, shown
from ..base.quantities import INPUTS
from .data_file import DataFile

EDGES = ("pa", "pb", "at", "bt")
"""Metering edges: from supply p to the ports a and b, and from these to the tank t."""
MOST_ROWS = 200
"""Most points of a curve (our choice: every point adds to the equations of a simulation)."""
MOST_BYTES = 100_000
"""Largest size of a table (our choice: 200 rows of five columns take less)."""
ROUNDED = 1e-6
"""Relative deviation up to which the end of a curve counts as the full signal."""
_SIGNALS = ("signal", "u", "command")
_FLOWS = ("q", "flow")


@dataclass(frozen=True, slots=True)
class FlowTable:
    """Flow over signal, SI; signals are in V, or shares of the full signal."""

    name: str
    """Name of the file."""
    in_volts: bool
    signal: tuple[float, ...]
    """Rising signals of the rows."""
    flows: tuple[tuple[float, ...], ...]
    """Flow of every row [m^3/s]: of one column, or of the edges in the order of `EDGES`."""

    @property
    def digest(self) -> str:
        """SHA-256 of the numbers."""
        numbers = repr((self.in_volts, self.signal, self.flows))
        return hashlib.sha256(numbers.encode()).hexdigest()

    def points(self, edge: str, full: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Shares of the full signal that open an edge, rising, and the flows there [m^3/s].

        `full` is the full signal [V]. A single column without negative signals serves both
        directions.
        """
        scale = full if self.in_volts else 1.0
        sign = 1.0 if edge in ("pa", "bt") else -1.0
        single = len(self.flows) == 1
        column = self.flows[0 if single else EDGES.index(edge)]
        if single and self.signal[0] >= 0:
            sign = 1.0
        pairs = [(sign * u / scale, q) for u, q in zip(self.signal, column, strict=True)]
        if single:
            pairs = [(share, abs(q)) for share, q in pairs if share >= 0]
        pairs.sort()
        if abs(pairs[-1][0] - 1.0) < ROUNDED:
            pairs[-1] = (1.0, pairs[-1][1])
        return tuple(share + 0.0 for share, _ in pairs), tuple(q for _, q in pairs)

    def ends(self, full: float) -> tuple[float, float]:
        """First and last signal, as shares of the full signal [V]."""
        scale = full if self.in_volts else 1.0
        return self.signal[0] / scale, self.signal[-1] / scale


def flow_table(file: DataFile) -> FlowTable:
    """The table in a file; for `DataFile.parsed`.

    Raises
    ------
    InputError
        a table that is no flow curve, with file, line and column
    """
    sheet = sheets.read_sheet(file.text, file.place, what="flow curve")
    signal_place, flow_places = _places(sheet)
    signal_unit = _unit(sheet, signal_place, ("ratio", "voltage"))
    signal, lines = _column(sheet, signal_place, signal_unit)
    if not 2 <= len(signal) <= MOST_ROWS:
        remedy = f"give 2 to {MOST_ROWS} rows below the heading"
        raise _fault(sheet, f"{len(signal)} rows", remedy)
    for k, (before, after) in enumerate(pairwise(signal)):
        if after <= before:
            message = "the signal does not rise"
            raise _fault(sheet, message, "sort the rows by signal", lines[k + 1], signal_place)
    columns = []
    for place in flow_places:
        flow, _ = _column(sheet, place, _unit(sheet, place, ("flow",)))
        _check_size(sheet, place, flow, lines)
        columns.append(_FlowColumn(place, flow))
    if len(columns) == 1:
        _check_single(sheet, signal, columns[0], lines)
    else:
        _check_edges(sheet, columns, lines)
    flows = tuple(column.flow for column in columns)
    return FlowTable(file.label, signal_unit.dimension == "voltage", signal, flows)


class _FlowColumn(NamedTuple):
    """A column of flows [m^3/s], with its place in the sheet."""

    place: int
    flow: tuple[float, ...]


def _fault(
    sheet: sheets.Sheet,
    message: str,
    remedy: str,
    line: int | None = None,
    place: int | None = None,
) -> InputError:
    """A fault of the table at a line, of the column at a place."""
    if place is not None:
        message = f'column "{shown(sheet.header[place])}": {message}'
    return InputError(Diagnostic(message, remedy, file=sheet.name, line=line))


def _places(sheet: sheets.Sheet) -> tuple[int, list[int]]:
    """Columns of the signal and of the flows; faults of the heading."""
    names = [cell[0].strip().lower() for cell in sheets.header_cells(sheet)]

    def fault(message: str, remedy: str) -> InputError:
        return _fault(sheet, message, remedy, sheet.header_line)

    def one_of(wanted: Sequence[str]) -> int | None:
        found = [k for k, name in enumerate(names) if name in wanted]
        if len(found) > 1:
            raise fault(f'two columns "{shown(names[found[0]])}"', "keep one of them")
        return found[0] if found else None

    signal, single = one_of(_SIGNALS), one_of(_FLOWS)
    edges = [one_of((f"q_{edge}",)) for edge in EDGES]
    if signal is None:
        raise fault("no column of the signal", 'name it "signal [%]"')
    stated = [k for k in edges if k is not None]
    if (single is None) == (not stated):
        message = "no column of the flow" if single is None else "flows of all and of single edges"
        raise fault(message, 'name one "q [l/min]", or four "q_pa [l/min]" …')
    if single is not None:
        return signal, [single]
    missing = [f"q_{edge}" for edge, k in zip(EDGES, edges, strict=True) if k is None]
    if missing:
        raise fault(f"no column {missing[0]}", "give q_pa, q_pb, q_at and q_bt")
    return signal, stated


def _unit(sheet: sheets.Sheet, place: int, dimensions: Sequence[str]) -> units.Unit:
    """The unit in the heading of a column, of one of these dimensions."""
    text = sheets.header_cells(sheet)[place][1]
    fault: units.UnitError | None = None
    if text:
        for dimension in dimensions:
            try:
                return units.unit(text, dimension)
            except units.UnitError as error:
                fault = error
    names = ", ".join(units.units_of(dimension)[0] for dimension in dimensions)
    message = f"the unit {shown(text)} does not fit" if fault else "the heading states no unit"
    raise _fault(sheet, message, f"write one in brackets: {names}", sheet.header_line, place)


def _column(
    sheet: sheets.Sheet, place: int, unit: units.Unit
) -> tuple[tuple[float, ...], list[int]]:
    """Values of a column in SI, and the line of every row."""
    values, lines = sheets.numbers(sheet, [place])
    numbers = [unit.to_si(value) for value in values[:, 0].tolist()]
    for value, line in zip(numbers, lines.tolist(), strict=True):
        if not isfinite(value):
            raise _fault(sheet, "no finite number", "write one, or remove the row", line, place)
    return tuple(numbers), lines.tolist()


def _check_size(
    sheet: sheets.Sheet, place: int, flow: Sequence[float], lines: Sequence[int]
) -> None:
    """Refuse flows larger than any valve's."""
    limit = INPUTS["rated_flow"]
    for value, line in zip(flow, lines, strict=True):
        if abs(value) > limit.upper:
            message = f"{limit.text(value)}: outside the valid range"
            raise _fault(sheet, message, f"write {limit.range_text()}", line, place)


def _check_single(
    sheet: sheets.Sheet, signal: Sequence[float], column: _FlowColumn, lines: Sequence[int]
) -> None:
    """Check one flow for all edges: a row at zero, signs, and a flow that grows with the signal."""
    place, flow = column
    if 0.0 not in signal:
        remedy = "add it; its flow is the leakage of an edge of the centred valve"
        raise _fault(sheet, "no row at signal 0", remedy)
    negative = any(u < 0 and q < 0 for u, q in zip(signal, flow, strict=True))
    for u, q, line in zip(signal, flow, lines, strict=True):
        if q < 0 and u >= 0:
            raise _fault(sheet, "a negative flow", "write its size", line, place)
        if negative and u < 0 < q:
            message = "a positive flow, but negative ones at other negative signals"
            raise _fault(sheet, message, "write one sign for a direction", line, place)
    rows = list(zip(signal, map(abs, flow), lines, strict=True))
    _check_rise(sheet, place, [row for row in rows if row[0] >= 0])
    below = [row for row in reversed(rows) if row[0] <= 0]
    if len(below) > 1:
        _check_rise(sheet, place, below)


def _check_edges(sheet: sheets.Sheet, columns: Sequence[_FlowColumn], lines: Sequence[int]) -> None:
    """Check four columns: no negative flow, and each grows in the direction that opens its edge."""
    for edge, (place, flow) in zip(EDGES, columns, strict=True):
        for q, line in zip(flow, lines, strict=True):
            if q < 0:
                raise _fault(sheet, "a negative flow", "write its size", line, place)
        rows = [(0.0, q, line) for q, line in zip(flow, lines, strict=True)]
        _check_rise(sheet, place, rows if edge in ("pa", "bt") else rows[::-1])


def _check_rise(sheet: sheets.Sheet, place: int, rows: Sequence[tuple[float, float, int]]) -> None:
    """Refuse a flow that falls while its edge opens, and an edge that never opens."""
    text = INPUTS["leakage_flow"].text
    for (_, before, _), (_, after, line) in pairwise(rows):
        if after < before:
            message = f"{text(after)} is less than at a smaller opening ({text(before)})"
            remedy = f"smooth the curve: write at least {text(before)}"
            raise _fault(sheet, message, remedy, line, place)
    if rows[-1][1] <= rows[0][1]:
        raise _fault(sheet, "the flow never rises", "check the column", rows[-1][2], place)


def check_ends(table: FlowTable, full: float) -> Iterator[tuple[str, str]]:
    """Message and remedy if a curve does not end at the full signal [V] in its directions."""
    first, last = table.ends(full)
    volts = INPUTS["signal"].text
    wanted = [(last, 1.0)]
    if first < 0 or len(table.flows) > 1:
        wanted.insert(0, (first, -1.0))
    for share, end in wanted:
        if abs(share - end) > ROUNDED:
            now = volts(share * full) if table.in_volts else f"{100 * share:.4g} %"
            goal = volts(end * full) if table.in_volts else f"{100 * end:.0f} %"
            remedy = f"give rows up to {goal}"
            if table.in_volts and share * end > 0:
                remedy += f", or set valve.signal to {volts(abs(share) * full)}"
            yield (
                f"{shown(table.name)}: the signal ends at {now}, not at the full signal ({goal})",
                remedy,
            )
