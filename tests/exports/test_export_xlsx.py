"""The workbook: its formulas give the evaluation's margins, and follow a changed limit."""

from __future__ import annotations

import io
import zipfile
from dataclasses import replace

import pytest
from cli_runner import bench
from formula_reader import Workbook
from shipped import evaluated
from test_export_step import EACH, SHIPPED

import actuator_opt as ao
from actuator_opt.exports.xlsx import xlsx
from actuator_opt.pages.section import section
from actuator_opt.rendering.paper import images

openpyxl = pytest.importorskip("openpyxl")


TIGHT = "yes, no reserve"
VERDICTS = {"met": "yes", "no_reserve": TIGHT, "missed": "no", "not_checked": "-"}


def opened(evaluation):
    """The workbook of an evaluation, read back."""
    return openpyxl.load_workbook(io.BytesIO(xlsx(evaluation, program="test")))


def rows_of(book, title):
    """Row numbers by name of a sheet of limits."""
    return {cell.value: cell.row for cell in book[title]["A"][4:] if cell.value}


@pytest.mark.parametrize("path", EACH, ids=lambda path: path.stem)
def test_formulas_give_the_evaluations_margins(path):
    """Margin and verdict of every requirement and check, computed from the cells alone."""
    evaluation = evaluated(path.stem)
    book = opened(evaluation)
    computed = Workbook(book)
    checks = [row for row in evaluation.checks if row.limit is not None and row.metric]
    for title, rows in (("Requirements", evaluation.requirements), ("Checks", checks)):
        for at, row in enumerate(rows, 5):
            assert book[title][f"A{at}"].value == row.name
            margin = computed.value(title, f"G{at}")
            if row.margin is None:
                assert margin == ""
            else:
                assert margin == pytest.approx(row.margin, rel=1e-9, abs=1e-12), row.name
            assert computed.value(title, f"H{at}") == VERDICTS[row.state], row.name
        states = {row.state for row in rows}
        worst = next((x for x in ("missed", "no_reserve") if x in states), "met")
        if rows:
            assert computed.value(title, "B2") == VERDICTS[worst]


def test_sheets_are_readable_on_paper():
    """One page wide, every word of the tables within its column, a font that is named."""
    book = opened(evaluated(SHIPPED[0].stem))
    for sheet in book:
        assert sheet.sheet_properties.pageSetUpPr.fitToPage
        assert sheet.page_setup.fitToHeight == 0
        assert {cell.font.name for row in sheet.iter_rows() for cell in row} == {"Calibri"}
    for title in ("Requirements", "Checks", "Variables", "Metrics"):
        sheet = book[title]
        for cell in (one for row in sheet.iter_rows(min_row=5) for one in row):
            if cell.data_type == "s":
                width = sheet.column_dimensions[cell.column_letter].width
                assert len(cell.value) < width, f"{title} {cell.coordinate}"


def test_a_changed_limit_changes_margin_and_verdict():
    """(result - limit)/|limit| of a minimum in the row's unit; -1e-6 and 1e-3 are the edges."""
    evaluation = ao.evaluate(bench())
    book = opened(evaluation)
    computed, sheet = Workbook(book), book["Requirements"]
    at = rows_of(book, "Requirements")["stiffness_min"]
    assert sheet[f"D{at}"].value == "kN/mm"
    result = sheet[f"F{at}"].value
    assert result == pytest.approx(evaluation.metrics["stiffness_min"].value / 1e6)
    for limit, verdict in ((0.5 * result, "yes"), (result / 1.0011, "yes"),
                           (result / 1.0009, TIGHT), (result * (1 + 0.9e-6), TIGHT),
                           (result * (1 + 1.1e-6), "no"), (2 * result, "no")):  # fmt: skip
        sheet[f"E{at}"].value = limit
        assert computed.value("Requirements", f"G{at}") == pytest.approx(result / limit - 1)
        assert computed.value("Requirements", f"H{at}") == verdict
        assert computed.value("Requirements", "B2") == verdict
    sheet[f"E{at}"].value = 0
    assert computed.value("Requirements", f"G{at}") == pytest.approx(1e6 * result)  # SI
    at = rows_of(book, "Requirements")["seal_gap"]
    result, limit = sheet[f"F{at}"].value, 40.0
    sheet[f"E{at}"].value = limit
    margin = computed.value("Requirements", f"G{at}")
    assert margin == pytest.approx((limit - result) / limit)


def test_results_that_are_no_numbers():
    """What nothing loads is unlimited and met; what has no finite answer is missed."""
    evaluation = ao.evaluate(bench())
    row = evaluation.requirements[0]
    for met, shown, verdict in ((True, "unlimited", "yes"), (False, "none", "no")):
        none = replace(row, value=None, margin=None, met=met)
        book = opened(replace(evaluation, requirements=(none,)))
        assert book["Requirements"]["F5"].value == shown
        assert Workbook(book).value("Requirements", "G5") == ""
        assert Workbook(book).value("Requirements", "H5") == verdict


def test_masses_add_up():
    """Parts in grams, their sum and shares by formula; a chart of them."""
    evaluation = ao.evaluate(bench())
    book = opened(evaluation)
    computed, sheet = Workbook(book), book["Mass"]
    assert [cell.value for cell in sheet[3][:3]] == ["part", "mass [g]", "share [%]"]
    count = len(evaluation.mass_parts)
    for at, (part, mass) in enumerate(evaluation.mass_parts.items(), 4):
        assert sheet[f"A{at}"].value == part
        assert sheet[f"B{at}"].value == pytest.approx(1000 * mass)
        share = mass / sum(evaluation.mass_parts.values())
        assert computed.value("Mass", f"C{at}") == pytest.approx(share)
    total = computed.value("Mass", f"B{4 + count}")
    assert total == pytest.approx(1000 * evaluation.metrics["mass"].value)
    filled = total + 1000 * evaluation.metrics["mass_oil"].value
    assert computed.value("Mass", f"B{6 + count}") == pytest.approx(filled)
    (chart,) = sheet._charts
    assert chart.series[0].val.numRef.f == f"'Mass'!$B$4:$B${3 + count}"
    assert chart.series[0].cat.numRef.f == f"'Mass'!$A$4:$A${3 + count}"


def test_variables_stand_between_their_bounds():
    """PATH, bounds and value in one unit, and how far between the bounds it is."""
    book = opened(ao.evaluate(bench()))
    sheet, computed = book["Variables"], Workbook(book)
    rows = {cell.value: cell.row for cell in sheet["A"][3:]}
    at = rows["cylinder.bore"]
    assert [sheet[f"{c}{at}"].value for c in "CDEF"] == ["mm", 20, pytest.approx(22), 30]
    assert computed.value("Variables", f"G{at}") == pytest.approx(0.2)


def test_a_persons_words_are_no_formulas():
    """Names that begin like formulas stay texts, whatever sheet they stand on."""
    text = bench(("name: test bench", 'name: "=HYPERLINK(1)"'))
    book = opened(ao.evaluate(text))
    assert book["About"]["B1"].value == "=HYPERLINK(1)"
    for sheet in book:
        for row in sheet.iter_rows():
            for cell in row:
                if cell.data_type == "f":
                    assert "HYPERLINK" not in cell.value
                elif isinstance(cell.value, str) and cell.value[:1] in "=+":
                    assert cell.data_type == "s"
                    assert cell.quotePrefix


def test_the_first_sheet_shows_the_section():
    """One picture below the requirements, 180 mm wide, of the section that the report draws."""
    evaluation = ao.evaluate(bench())
    content = xlsx(evaluation, program="p")
    book = openpyxl.load_workbook(io.BytesIO(content))
    (picture,) = book.worksheets[0]._images
    assert picture.anchor._from.row > book.worksheets[0].max_row - 1
    extent = picture.anchor.ext
    drawn = section(evaluation).ink
    assert extent.width / extent.height == pytest.approx(drawn.width / drawn.height, rel=0.01)
    assert extent.width / 36000 == pytest.approx(180.0, rel=0.01)  # EMU per mm
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        (name,) = [name for name in archive.namelist() if name.endswith(".png")]
        assert archive.read(name) == images(drawn, "section")["section.png"]
    assert not any(sheet._images for sheet in book.worksheets[1:])


def test_same_design_same_bytes():
    """No clock: neither in the archive nor in the properties."""
    evaluation = ao.evaluate(bench())
    content = xlsx(evaluation, program="p")
    assert content == xlsx(evaluation, program="p")
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        assert {entry.date_time for entry in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
    assert xlsx(evaluation, program="p", date="2026-01-02") != content
