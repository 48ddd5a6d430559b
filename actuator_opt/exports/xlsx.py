"""Write an evaluation as a workbook: limits with margins, section drawing, variables and masses.

Margins and verdicts are formulas, so they update when the user changes a limit. Numbers are in
display units. Where a formula needs SI, a cell in the same row has the conversion factor. Excel and
LibreOffice compute the formulas when they open the file.
"""

from __future__ import annotations

import io
import math
import textwrap
import zipfile
from collections.abc import Iterable, Sequence
from datetime import datetime
from typing import Any

from ..base import units
from ..base.dataclass import dataclass
from ..base.errors import library
from ..base.quantities import Quantity
from ..design.paths import get, quantity_of
from ..evaluation.parts_list import parts_list
from ..evaluation.result import NO_RESERVE, NO_ROOM, Check, Evaluation, Requirement
from ..metrics import METRICS
from ..pages.section import section
from ..rendering.paper import images
from .dxf import plain

TOLERANCE = "0.000001"
"""Violation up to which a limit still counts as met, as text for formulas."""
_TIGHT = "yes, no reserve"
"""Verdict on a limit that is met with hardly any margin (`evaluation.result.NO_RESERVE`)."""

_EPOCH = (1980, 1, 1, 0, 0, 0)
"""Earliest time that a zip archive allows; a fixed time makes equal input give equal files."""

_LIMITS = (
    "quantity",
    "sense",
    "unit",
    "limit [unit of its row]",
    "result [unit of its row]",
    "margin [fraction of the limit; SI unit if the limit is 0]",
    "met",
    "SI per unit",
    "governing case",
    "remark",
)
_FONT = {"name": "Calibri", "size": 11}
"""Font of every cell; if it were not stated, programs would use their own."""
_LINE = 15.0
"""Height of a line of text, points."""
_PIXELS = 96 / 25.4
"""Pixels per millimetre of a sheet."""
_WIDEST = 110.0
"""Largest column width in characters."""
_FIRST = 5
"""Row of the first requirement or check."""


@dataclass(frozen=True, slots=True)
class _Scale:
    """Unit of a row: the display unit, or SI if the display unit has an offset, as degC has."""

    name: str
    factor: float
    quantity: Quantity

    def of(self, value: float | None) -> float | None:
        if value is None or not math.isfinite(value):
            return None
        return value if self.name != self.quantity.unit else self.quantity.to_display(value)


def _scale(quantity: Quantity) -> _Scale:
    if not quantity.unit:
        return _Scale("", 1.0, quantity)
    unit = units.unit(quantity.unit, quantity.dimension)
    if unit.offset:
        return _Scale(quantity.si_unit, 1.0, quantity)
    return _Scale(quantity.unit, unit.scale, quantity)


def _format(value: float | None) -> str:
    """Number format that shows five digits of a value.

    >>> _format(10.1234567), _format(123456.0), _format(0.00123)
    ('0.000', '0', '0.0000000')
    """
    size = abs(value) if value else 1.0
    decimals = min(max(4 - math.floor(math.log10(size)), 0), 12)
    return f"0.{'0' * decimals}" if decimals else "0"


class _Sheet:
    """A sheet that is filled row by row; its texts are stored so that none is read as a formula.

    Columns have the stated width, or a larger one if texts below the heading need it.
    """

    def __init__(self, book: Any, title: str, widths: Sequence[float]) -> None:
        self._styles = library("openpyxl.styles")
        self.sheet = book.create_sheet(title)
        self.headed = False
        self.widths = dict(zip("ABCDEFGHIJK", widths, strict=False))
        for column, width in self.widths.items():
            self.sheet.column_dimensions[column].width = width
        self.sheet.page_setup.orientation, self.sheet.page_setup.paperSize = "landscape", 9  # A4
        self.sheet.page_setup.fitToHeight = 0  # one page wide, any number of pages high
        self.sheet.sheet_properties.pageSetUpPr.fitToPage = True

    def put(self, place: str, value: float | str | None, *, bold: bool = False) -> Any:
        cell = self.sheet[place]
        if isinstance(value, str):
            cell.value = plain(value)
            cell.data_type = "s"
            cell.quotePrefix = value[:1] in tuple("=+-@")
            if self.headed:
                column = self.sheet.column_dimensions[cell.column_letter]
                column.width = max(column.width, min(len(cell.value) + 1.0, _WIDEST))
        elif value is not None:
            cell.value = value
            cell.number_format = _format(value)
        if bold:
            cell.font = self._styles.Font(bold=True, **_FONT)
        return cell

    def formula(self, place: str, text: str, form: str = "General", *, bold: bool = False) -> None:
        cell = self.sheet[place]
        cell.value, cell.number_format = f"={text}", form
        if bold:
            cell.font = self._styles.Font(bold=True, **_FONT)

    def head(self, row: int, names: Iterable[str]) -> None:
        styles, lines = self._styles, 1
        for column, name in zip("ABCDEFGHIJK", names, strict=False):
            cell = self.put(f"{column}{row}", name, bold=True)
            cell.alignment = styles.Alignment(wrap_text=True, vertical="top")
            cell.fill = styles.PatternFill("solid", fgColor="E3E8EC")
            lines = max(lines, len(textwrap.wrap(name, max(int(0.8 * self.widths[column]), 1))))
        self.sheet.row_dimensions[row].height = _LINE * lines
        self.headed = True
        self.sheet.print_title_rows = f"{row}:{row}"
        self.sheet.freeze_panes = f"B{row + 1}"

    def colour(self, cells: str, word: str, colour: str) -> None:
        rule = library("openpyxl.formatting.rule").CellIsRule
        fill = self._styles.PatternFill("solid", bgColor=colour)
        self.sheet.conditional_formatting.add(
            cells, rule(operator="equal", formula=[f'"{word}"'], fill=fill)
        )


def _case(row: Requirement | Check) -> str:
    return ", ".join(part for part in (row.case, row.place) if part)


def _remark(evaluation: Evaluation, row: Requirement | Check) -> str:
    if isinstance(row, Check):
        return row.reason or row.source
    metric = evaluation.metrics.get(row.metric)
    return metric.why or "" if row.value is None and metric is not None else ""


def _limit_row(sheet: _Sheet, at: int, evaluation: Evaluation, row: Requirement | Check) -> None:
    assert row.metric is not None
    quantity = evaluation.metrics[row.metric].quantity
    scale = _scale(quantity)
    value = scale.of(row.value)
    met = row.met if isinstance(row, Requirement) else row.status == "met"
    texts = (row.name, quantity.label, row.sense, scale.name)
    for column, text in zip("ABCD", texts, strict=True):
        sheet.put(f"{column}{at}", text)
    limit = sheet.put(f"E{at}", scale.of(row.limit))
    limit.font = library("openpyxl.styles").Font(color="0B4F83", **_FONT)
    unjudged = isinstance(row, Check) and row.status == "not_checked"
    none = "unlimited" if met else "not checked" if unjudged else "none"
    sheet.put(f"F{at}", none if value is None or unjudged else value)
    sign, room = f'IF(C{at}="min",1,-1)', f"IF(E{at}=0,{NO_ROOM:f},{NO_RESERVE:f})"
    sheet.formula(
        f"G{at}",
        f'IF(ISNUMBER(F{at}),IF(E{at}=0,{sign}*F{at}*I{at},{sign}*(F{at}-E{at})/ABS(E{at})),"")',
        "0.000" if row.limit == 0 else "0.0%",
    )
    sheet.formula(
        f"H{at}",
        f'IF(ISNUMBER(G{at}),IF(G{at}<-{TOLERANCE},"no",IF(G{at}<{room},"{_TIGHT}","yes")),'
        f'IF(F{at}="unlimited","yes",IF(F{at}="not checked","-","no")))',
    )
    sheet.put(f"I{at}", scale.factor).number_format = "General"
    sheet.put(f"J{at}", _case(row))
    sheet.put(f"K{at}", _remark(evaluation, row))


def _limits(
    book: Any, title: str, evaluation: Evaluation, rows: Sequence[Requirement | Check]
) -> None:
    """Add a sheet of limits: limit, result, margin and verdict, as formulas."""
    kind = "requirement" if title == "Requirements" else "check"
    widths = (25, 20, 7, 9, 14, 14, 24, 7, 12, 16, 16)
    sheet = _Sheet(book, title, widths)
    last = _FIRST + len(rows) - 1
    sheet.put("A1", f"{evaluation.name}: {title.lower()}", bold=True)
    sheet.put("A2", f"every {kind} met" if rows else f"no {kind} with a limit", bold=True)
    sheet.head(_FIRST - 1, (kind, *_LIMITS))
    if not rows:
        return
    cells = f"H{_FIRST}:H{last}"
    tight = f'IF(COUNTIF({cells},"{_TIGHT}")=0,"yes","{_TIGHT}")'
    sheet.formula("B2", f'IF(COUNTIF({cells},"no")=0,{tight},"no")', bold=True)
    for at, row in enumerate(rows, _FIRST):
        _limit_row(sheet, at, evaluation, row)
    for cells in (f"H{_FIRST}:H{last}", "B2"):
        sheet.colour(cells, "yes", "CDE8D0")
        sheet.colour(cells, _TIGHT, "F6E3B4")
        sheet.colour(cells, "no", "F5C9C2")


def _section(book: Any, evaluation: Evaluation) -> None:
    """Add the longitudinal section as a picture below the requirements."""
    drawing = section(evaluation)
    picture = library("openpyxl.drawing.image").Image(
        io.BytesIO(images(drawing.ink, "section")["section.png"])
    )
    picture.width = round(drawing.ink.width * _PIXELS)
    picture.height = round(drawing.ink.height * _PIXELS)
    sheet = book.worksheets[0]
    sheet.add_image(picture, f"A{sheet.max_row + 2}")


def _variables(book: Any, evaluation: Evaluation) -> None:
    """Add a sheet with the variables of the optimiser and their bounds."""
    sheet = _Sheet(book, "Variables", (20, 20, 9, 12, 12, 12, 14))
    sheet.put("A1", f"{evaluation.name}: variables", bold=True)
    design = evaluation.design
    names = [f"{name} [unit of its row]" for name in ("lower bound", "value", "upper bound")]
    sheet.head(3, ("variable", "quantity", "unit", *names, "position between the bounds [%]"))
    if not design.variables:
        sheet.put("A4", "this design has no variables")
    for at, (path, bounds) in enumerate(design.variables.items(), 4):
        quantity, value = quantity_of(path, design), get(design, path)
        for column, text in zip("ABC", (path, quantity.label, quantity.unit), strict=True):
            sheet.put(f"{column}{at}", text)
        for column, number in zip("DEF", (bounds.lower, value, bounds.upper), strict=True):
            finite = None if isinstance(number, str) else number
            sheet.put(f"{column}{at}", None if finite is None else quantity.to_display(finite))
        sheet.formula(f"G{at}", f'IF(F{at}>D{at},(E{at}-D{at})/(F{at}-D{at}),"")', "0%")


def _mass(book: Any, evaluation: Evaluation) -> None:
    """Add a sheet with the parts list, the sum of the masses, the mass of the oil, and a chart."""
    quantity = METRICS["mass"]
    sheet = _Sheet(book, "Mass", (24, 14, 12, 9, 30))
    sheet.put("A1", f"{evaluation.name}: parts and mass", bold=True)
    sheet.head(3, ("part", f"mass [{quantity.unit}]", "share [%]", "pieces", "material"))
    parts = parts_list(evaluation)
    last = 3 + len(parts)
    total = last + 1
    for at, (part, pieces, material, mass) in enumerate(parts, 4):
        sheet.put(f"A{at}", part)
        sheet.put(f"D{at}", pieces).number_format = "0"
        sheet.put(f"E{at}", material)
        sheet.put(f"B{at}", quantity.to_display(mass)).number_format = "0.00"
        sheet.formula(f"C{at}", f"IF(B${total}>0,B{at}/B${total},0)", "0.0%")
    sheet.put(f"A{total}", "dry mass", bold=True)
    sheet.formula(f"B{total}", f"SUM(B4:B{last})", "0.00", bold=True)
    oil = evaluation.metrics.get("mass_oil")
    if oil is not None and oil.value is not None:
        sheet.put(f"A{total + 1}", "oil inside")
        sheet.put(f"B{total + 1}", quantity.to_display(oil.value)).number_format = "0.00"
        sheet.put(f"A{total + 2}", "filled", bold=True)
        sheet.formula(f"B{total + 2}", f"B{total}+B{total + 1}", "0.00", bold=True)
    charts = library("openpyxl.chart")
    chart = charts.BarChart()
    chart.type, chart.legend, chart.gapWidth = "bar", None, 40
    chart.title = f"Mass of the parts [{quantity.unit}]"
    chart.add_data(charts.Reference(sheet.sheet, min_col=2, min_row=4, max_row=last))
    chart.set_categories(charts.Reference(sheet.sheet, min_col=1, min_row=4, max_row=last))
    chart.x_axis.scaling.orientation = "maxMin"
    chart.x_axis.delete = chart.y_axis.delete = False
    chart.y_axis.numFmt, chart.y_axis.number_format = "0", "0"
    chart.height, chart.width = 9.0, 16.0
    sheet.sheet.add_chart(chart, "G3")


def _metrics(book: Any, evaluation: Evaluation) -> None:
    sheet = _Sheet(book, "Metrics", (20, 20, 14, 10, 18, 20))
    sheet.put("A1", f"{evaluation.name}: metrics", bold=True)
    names = ("metric", "quantity", "value [unit of its row]", "unit", "governing case")
    sheet.head(3, (*names, "reason for a missing value"))
    for at, metric in enumerate(evaluation.metrics.values(), 4):
        quantity = metric.quantity
        value = None if metric.value is None else quantity.to_display(metric.value)
        row = (metric.name, quantity.label, value, quantity.unit, metric.case or "", metric.why)
        for column, entry in zip("ABCDEF", row, strict=True):
            sheet.put(f"{column}{at}", entry)


def _about(book: Any, evaluation: Evaluation, program: str, date: str | None) -> None:
    sheet = _Sheet(book, "About", (24, 110))
    rows = [
        ("design", evaluation.name),
        ("written by", program),
        ("date", date or ""),
        ("hash of the input", evaluation.spec_hash),
        (
            "margin",
            "(result - limit)/|limit| for min, (limit - result)/|limit| for max; "
            "a limit counts as met if its margin is at least -1e-6",
        ),
        (
            "blue cells",
            "limits that you can change: margins and verdicts update, results stay as they are",
        ),
        *(("warning", words) for words in evaluation.warnings),
    ]
    for at, (name, words) in enumerate(rows, 1):
        sheet.put(f"A{at}", name, bold=True)
        cell = sheet.put(f"B{at}", words)
        cell.alignment = library("openpyxl.styles").Alignment(wrap_text=True, vertical="top")


def _packed(book: Any) -> bytes:
    """Bytes of the workbook, which are equal for equal contents."""
    raw, clean = io.BytesIO(), io.BytesIO()
    with zipfile.ZipFile(raw, "w") as archive:
        library("openpyxl.writer.excel").ExcelWriter(book, archive).write_data()
    with zipfile.ZipFile(raw) as archive, zipfile.ZipFile(clean, "w") as copy:
        for name in archive.namelist():
            entry = zipfile.ZipInfo(name, _EPOCH)
            copy.writestr(entry, archive.read(name), zipfile.ZIP_DEFLATED)
    return clean.getvalue()


def xlsx(evaluation: Evaluation, *, program: str, date: str | None = None) -> bytes:
    """Write an evaluation as a workbook; return its bytes.

    Parameters
    ----------
    evaluation : evaluation of the design
    program : name of the writing program
    date : ISO date, or None

    Raises
    ------
    ActuatorError : openpyxl (extra ``excel``) is not installed
    """
    book = library("openpyxl").Workbook()
    book.remove(book.active)
    _limits(book, "Requirements", evaluation, evaluation.requirements)
    _section(book, evaluation)
    checks = [row for row in evaluation.checks if row.limit is not None and row.metric is not None]
    _limits(book, "Checks", evaluation, checks)
    _variables(book, evaluation)
    _mass(book, evaluation)
    _metrics(book, evaluation)
    _about(book, evaluation, program, date)
    stamp = datetime.fromisoformat(date or "1980-01-01")
    book.properties.created = book.properties.modified = stamp
    book.properties.creator, book.properties.title = program, plain(evaluation.name)
    return _packed(book)
