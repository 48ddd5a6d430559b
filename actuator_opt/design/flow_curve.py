"""The flow curve of a valve: a table of flow over signal, as CSV, in a file or written out.

The first column is the signal (``signal [%]`` of the full signal, or ``signal [V]``). A column
``q [l/min]`` is the flow of whichever edges the signal opens. Four columns ``q_pa``, ``q_pb``,
``q_at`` and ``q_bt`` are the flows of single edges. All flows apply at one pressure drop per edge.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import field
from itertools import pairwise
from math import isfinite
from pathlib import Path
from typing import Any

from ..base import sheets, units
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, shown
from ..base.files import read_bytes
from ..base.quantities import INPUTS
from .kinds import ValueFault, ValueKind, shape_in_words

EDGES = ("pa", "pb", "at", "bt")
"""Metering edges: from supply p to the ports a and b, and from these to the tank t."""
MOST_ROWS = 200
"""Most points of a curve (our choice: every point adds to the equations of a simulation)."""
MOST_BYTES = 100_000
"""Largest size of a table (our choice: 200 rows of five columns take less)."""
WRITTEN = "the table"
"""Name of a table that is written out in the design."""
ROUNDED = 1e-6
"""Relative deviation up to which the end of a curve counts as the full signal."""
_SIGNALS = ("signal", "u", "command")
_FLOWS = ("q", "flow")
_KINDS = (".csv", ".txt", ".tsv")


@dataclass(frozen=True, slots=True)
class FlowTable:
    """Flow over signal, SI; signals are in V, or shares of the full signal.

    Tables of equal numbers are equal, whatever their files and texts.
    """

    file: str = field(compare=False)
    """Name of the file as stated; empty if the table is written out in the design."""
    text: str = field(compare=False)
    """The table as CSV."""
    in_volts: bool
    signal: tuple[float, ...]
    """Rising signals of the rows."""
    flows: tuple[tuple[float, ...], ...]
    """Flow of every row [m^3/s]: of one column, or of the edges in the order of `EDGES`."""

    def __str__(self) -> str:
        """The name of the file, and the number of rows."""
        return f"{self.file or WRITTEN}, {len(self.signal)} rows"

    @property
    def stated(self) -> str:
        """The text that states this table in a design: the name of its file, or the table."""
        return self.file or self.text

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


class FlowCurve(ValueKind):
    """The flow curve of a valve: the name of a CSV file, or the table itself."""

    example = "valve_curve.csv"

    def __init__(self, help: str) -> None:
        self.help = help

    def validate(self, value: Any) -> FlowTable:
        """Read the table; a file is looked for in the current folder."""
        if isinstance(value, FlowTable):
            return value
        if not isinstance(value, str) or not value.strip():
            raise ValueFault(
                f"need the name of a CSV file, not {shape_in_words(value)}",
                f'write e.g. "{self.example}"',
            )
        return read_flow_table(value, Path())


def read_flow_table(stated: str, folder: Path) -> FlowTable:
    """Read a table: a text of several lines, or the name of a file in a folder.

    Raises
    ------
    ValueFault
        a file that cannot be read, or a table that is no flow curve; the message names file, line
        and column
    """
    written = "\n" in stated or "\r" in stated
    name = WRITTEN if written else stated
    try:
        data = (
            stated.encode()
            if written
            else read_bytes(folder / stated, most=MOST_BYTES + 1, kinds=_KINDS, what="CSV file")
        )
        if len(data) > MOST_BYTES:
            raise ValueFault(
                f"{shown(name)}: larger than {MOST_BYTES // 1000} kB",
                f"a flow curve has at most {MOST_ROWS} rows: is this the right file?",
            )
        text = sheets.decode_sheet(data, name)
        sheet = sheets.read_sheet(text, name, what="flow curve")
        return _table("" if written else stated, text, sheet)
    except InputError as error:
        raise _fault(name, error.diagnostics[0]) from None


def _fault(name: str, diagnostic: Diagnostic, column: str = "") -> ValueFault:
    """A fault of the table, in one line with the name of its file, the line and the column."""
    line = f", line {diagnostic.line}" if diagnostic.line is not None else ""
    place = f"{shown(name)}{line}{f', column {chr(34)}{shown(column)}{chr(34)}' if column else ''}"
    remedy = "name a file of the design's folder" if "no such" in diagnostic.message else ""
    return ValueFault(f"{place}: {diagnostic.message}", diagnostic.remedy or remedy)


def _table(file: str, text: str, sheet: sheets.Sheet) -> FlowTable:
    """The curve in a sheet, with all its checks."""
    name = sheet.name
    signal_place, flow_places = _places(sheet)
    signal_unit = _unit(sheet, signal_place, ("ratio", "voltage"))
    signal, lines = _column(sheet, signal_place, signal_unit)
    if not 2 <= len(signal) <= MOST_ROWS:
        raise ValueFault(
            f"{shown(name)}: {len(signal)} rows", f"give 2 to {MOST_ROWS} rows below the heading"
        )
    column = sheet.header[signal_place]
    for k, (before, after) in enumerate(pairwise(signal)):
        if after <= before:
            diagnostic = Diagnostic(
                "the signal does not rise", "sort the rows by signal", line=lines[k + 1]
            )
            raise _fault(name, diagnostic, column)
    flows = []
    for place in flow_places:
        flow, _ = _column(sheet, place, _unit(sheet, place, ("flow",)))
        _check_size(name, flow, lines, sheet.header[place])
        flows.append(flow)
    titles = [sheet.header[place] for place in flow_places]
    if len(flows) == 1:
        _check_single(name, signal, flows[0], lines, titles[0])
    else:
        _check_edges(name, flows, lines, titles)
    return FlowTable(file, text, signal_unit.dimension == "voltage", signal, tuple(flows))


def _places(sheet: sheets.Sheet) -> tuple[int, list[int]]:
    """Columns of the signal and of the flows; faults of the heading."""
    names = [cell[0].strip().lower() for cell in sheets.header_cells(sheet)]

    def one_of(wanted: Sequence[str]) -> int | None:
        found = [k for k, name in enumerate(names) if name in wanted]
        if len(found) > 1:
            raise ValueFault(
                f'{shown(sheet.name)}, line {sheet.header_line}: two columns "{names[found[0]]}"',
                "keep one of them",
            )
        return found[0] if found else None

    signal, single = one_of(_SIGNALS), one_of(_FLOWS)
    edges = [one_of((f"q_{edge}",)) for edge in EDGES]
    place = f"{shown(sheet.name)}, line {sheet.header_line}"
    if signal is None:
        raise ValueFault(f"{place}: no column of the signal", 'name it "signal [%]"')
    stated = [k for k in edges if k is not None]
    if (single is None) == (not stated):
        message = "no column of the flow" if single is None else "flows of all and of single edges"
        raise ValueFault(f"{place}: {message}", 'name one "q [l/min]", or four "q_pa [l/min]" …')
    if single is not None:
        return signal, [single]
    missing = [f"q_{edge}" for edge, k in zip(EDGES, edges, strict=True) if k is None]
    if missing:
        raise ValueFault(f"{place}: no column {missing[0]}", "give q_pa, q_pb, q_at and q_bt")
    return signal, stated


def _unit(sheet: sheets.Sheet, place: int, dimensions: Sequence[str]) -> units.Unit:
    """The unit in the heading of a column, of one of these dimensions."""
    title, text = sheet.header[place], sheets.header_cells(sheet)[place][1]
    fault: units.UnitError | None = None
    if text:
        for dimension in dimensions:
            try:
                return units.unit(text, dimension)
            except units.UnitError as error:
                fault = error
    names = ", ".join(units.units_of(dimension)[0] for dimension in dimensions)
    message = f"the unit {shown(text)} does not fit" if fault else "the heading states no unit"
    diagnostic = Diagnostic(message, f"write one in brackets: {names}", line=sheet.header_line)
    raise _fault(sheet.name, diagnostic, title)


def _column(
    sheet: sheets.Sheet, place: int, unit: units.Unit
) -> tuple[tuple[float, ...], list[int]]:
    """Values of a column in SI, and the line of every row."""
    title = sheet.header[place]
    values, lines = sheets.numbers(sheet, [place])
    numbers = [unit.to_si(value) for value in values[:, 0].tolist()]
    for value, line in zip(numbers, lines.tolist(), strict=True):
        if not isfinite(value):
            diagnostic = Diagnostic("no finite number", "write one, or remove the row", line=line)
            raise _fault(sheet.name, diagnostic, title)
    return tuple(numbers), lines.tolist()


def _check_size(name: str, flow: Sequence[float], lines: Sequence[int], column: str) -> None:
    """Refuse flows larger than any valve's."""
    limit = INPUTS["rated_flow"]
    for value, line in zip(flow, lines, strict=True):
        if abs(value) > limit.upper:
            message = f"{limit.text(value)}: outside the valid range"
            diagnostic = Diagnostic(message, f"write {limit.range_text()}", line=line)
            raise _fault(name, diagnostic, column)


def _check_single(
    name: str, signal: Sequence[float], flow: Sequence[float], lines: Sequence[int], column: str
) -> None:
    """Check one flow for all edges: a row at zero, signs, and a flow that grows with the signal."""
    if 0.0 not in signal:
        raise ValueFault(
            f"{shown(name)}: no row at signal 0",
            "add it; its flow is the leakage of an edge of the centred valve",
        )
    negative = any(u < 0 and q < 0 for u, q in zip(signal, flow, strict=True))
    for u, q, line in zip(signal, flow, lines, strict=True):
        if q < 0 and u >= 0:
            diagnostic = Diagnostic("a negative flow", "write its size", line=line)
            raise _fault(name, diagnostic, column)
        if negative and u < 0 < q:
            diagnostic = Diagnostic(
                "a positive flow, but negative ones at other negative signals",
                "write one sign for a direction",
                line=line,
            )
            raise _fault(name, diagnostic, column)
    rows = list(zip(signal, map(abs, flow), lines, strict=True))
    _check_rise(name, [row for row in rows if row[0] >= 0], column)
    below = [row for row in reversed(rows) if row[0] <= 0]
    if len(below) > 1:
        _check_rise(name, below, column)


def _check_edges(
    name: str, flows: Sequence[Sequence[float]], lines: Sequence[int], titles: Sequence[str]
) -> None:
    """Check four columns: no negative flow, and each grows in the direction that opens its edge."""
    for edge, flow, title in zip(EDGES, flows, titles, strict=True):
        for q, line in zip(flow, lines, strict=True):
            if q < 0:
                diagnostic = Diagnostic("a negative flow", "write its size", line=line)
                raise _fault(name, diagnostic, title)
        rows = [(0.0, q, line) for q, line in zip(flow, lines, strict=True)]
        _check_rise(name, rows if edge in ("pa", "bt") else rows[::-1], title)


def _check_rise(name: str, rows: Sequence[tuple[float, float, int]], column: str) -> None:
    """Refuse a flow that falls while its edge opens, and an edge that never opens."""
    text = INPUTS["leakage_flow"].text
    for (_, before, _), (_, after, line) in pairwise(rows):
        if after < before:
            message = f"{text(after)} is less than at a smaller opening ({text(before)})"
            remedy = f"smooth the curve: write at least {text(before)}"
            raise _fault(name, Diagnostic(message, remedy, line=line), column)
    if rows[-1][1] <= rows[0][1]:
        diagnostic = Diagnostic("the flow never rises", "check the column", line=rows[-1][2])
        raise _fault(name, diagnostic, column)


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
            name = shown(table.file or WRITTEN)
            remedy = f"give rows up to {goal}"
            if table.in_volts and share * end > 0:
                remedy += f", or set valve.signal to {volts(abs(share) * full)}"
            yield f"{name}: the signal ends at {now}, not at the full signal ({goal})", remedy
