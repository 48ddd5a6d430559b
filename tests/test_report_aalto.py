"""The [AaltoThesis] pages of its design's report: tables, figures, and the trace of equations."""

from __future__ import annotations

import importlib
import inspect
import itertools
import re
from pathlib import Path

import pytest

from actuator_opt import verbs
from actuator_opt.evaluation.study import aalto, aalto_dynamic, aalto_static
from actuator_opt.reporting.page import page
from actuator_opt.reporting.published import (
    aalto_equations,
    aalto_figures,
    aalto_tables,
    published_tables,
)

DESIGN = Path(__file__).parents[1] / "designs" / "aalto_40_25_220.yaml"
SOURCE = {"source_text": "a: 1", "source_name": "a.yaml", "command": "report", "date": None}
OTHERS = (
    {"cylinder.stroke": "120 mm"},
    {"cylinder.stroke": "800 mm", "rod.outer_diameter": "28 mm"},
    {"cylinder.bore": "63 mm", "retention.thread.diameter": "73 mm"},
    {"cylinder.bore": "28 mm", "rod.outer_diameter": "18 mm", "rod.extension": "0 mm"},
    {"fluid.material": "iso_vg_46", "fluid.air_content": "3 %"},
    {"ports.throttle.area": "0.02 cm^2", "lines[2].length": "5 m"},
    {"ports.reducing_valve.natural_frequency": "60 Hz"},
    {"ports.reducing_valve.conductance": "20 ml/s/bar"},
    {"barrel.layup[0].thickness": "1.5 mm", "load.mass": "400 kg"},
)
"""Designs that the tables and figures have to bear as well."""


def evaluated(**changes):
    """The shipped design, some values replaced."""
    return verbs.evaluate(verbs.read(DESIGN, set=changes) if changes else DESIGN)


@pytest.fixture(scope="module")
def evaluation():
    """The design as it is shipped."""
    return evaluated()


@pytest.fixture(scope="module")
def tables(evaluation):
    """Every table by the end of its title."""
    return {t.title.partition(": ")[2]: t for t in published_tables(evaluation)}


@pytest.fixture(scope="module")
def words(tables):
    """Every cell and note as one text, spaces plain."""
    cells = [str(cell) for table in tables.values() for row in table.rows for cell in row]
    return re.sub(r"\s", " ", "\n".join([*cells, *(t.note for t in tables.values())]))


def figures(design):
    """The three drawings of the page."""
    pipes = aalto.pipes(design)
    oil = [("no lines", aalto.oil_alone(design, ())), ("pipes", aalto.oil_alone(design, pipes))]
    stroke = design.cylinder.stroke
    return (
        aalto_figures.theory_figure(
            stroke,
            oil,
            aalto.total(design, pipes, 1600e6),
            aalto.total(design, design.lines, 1300e6),
        ),
        aalto_figures.static_figure(stroke, aalto_static.static_test(design)),
        aalto_figures.dynamic_figure(aalto_dynamic.dynamic_test(design)),
    )


@pytest.mark.parametrize(
    "number",
    ["0.11–0.21", "0.31–0.48", "12 / 62", "17–19", "16.25 m", "100.8", "0.611", "0.22 cm²",
     "0.4 bar", "1300 MPa", "0.4 and 0.08 ml", "70 bar"],
)  # fmt: skip
def test_published_numbers_stand_in_the_tables(words, number):
    """What the thesis prints of its tests is set beside ours."""
    assert number in words


@pytest.mark.parametrize(
    ("row", "column", "cell"),
    [
        ("figure 5, oil alone, no lines", 2, "28.98 at 123.6 mm"),
        ("figure 5, oil alone, with pipes", 1, "194.4 / 27.66 / 95.05"),
        ("figure 29", 1, "55.98 / 19.53 / 42.83"),
        ("eq. 38 without", 1, "25.46 / 12.68 / 14.10"),
        ("eq. 38 without", 3, "24.73 / 12.52 / 12.29"),
    ],
)
def test_check_values_stand_in_the_stiffness_table(tables, row, column, cell):
    """Independent check values (56.0/19.5/42.8 and the others, here with a digit more)."""
    found = next(r for r in tables["stiffness along the stroke"].rows if r[0].startswith(row))
    assert found[column] == cell


def test_the_pages_say_whose_the_valve_is(tables):
    """The valve's numbers are ours and not the thesis', and a fit is no proof."""
    note = tables["dynamic tests"].note
    assert "our numbers, not the thesis'" in note
    assert "not that this one did" in note
    assert "none of these four in the thesis" in DESIGN.read_text("utf-8")


def test_the_pages_say_where_ours_disagrees(tables):
    """By how much, and where we do not know why."""
    assert "We do not know" in tables["static test"].note
    assert re.search(r"takes 4 %, 3\.\d times", tables["static test"].note)
    assert "We do not know" in tables["orifice and 20 Hz peak"].note
    assert "1.8 % (eq. 37) and 14 % (eq. 38) stiffer" in tables["stiffness along the stroke"].note


def test_every_equation_is_traced_once():
    """1 to 46, each in one row: to functions, or out of scope with the reason."""
    numbers = [n for t in aalto_equations.TRACES for n in range(t.first, t.last + 1)]
    assert numbers == list(range(1, 47))
    for trace in aalto_equations.TRACES:
        assert trace.functions or re.match(r"out of scope: \w+", trace.remark), trace.subject


@pytest.mark.parametrize(
    "name", sorted({name for t in aalto_equations.TRACES for name in t.functions})
)
def test_every_traced_function_exists_and_cites_the_thesis(name):
    """Each is a public function of `models` whose references name the thesis."""
    module, _, function = name.partition(".")
    found = getattr(importlib.import_module(f"actuator_opt.models.{module}"), function)
    assert inspect.isfunction(found)
    assert "[AaltoThesis]" in inspect.getdoc(found)


def test_functions_named_in_remarks_exist():
    """Those of eq. 39's remark too."""
    for module, function in (("orifice", "orifice_resistance"), ("elements", "inertance")):
        remark = next(t.remark for t in aalto_equations.TRACES if t.first == 39)
        assert function in remark
        assert hasattr(importlib.import_module(f"actuator_opt.models.{module}"), function)


def overlaps(boxes):
    """Pairs of text boxes that share area."""
    return [
        (a[0], b[0])
        for a, b in itertools.combinations(boxes, 2)
        if min(a[3], b[3]) - max(a[1], b[1]) > 0.05 and min(a[4], b[4]) - max(a[2], b[2]) > 0.05
    ]


@pytest.mark.parametrize("changes", [{}, *OTHERS], ids=lambda c: " ".join(c) or "as shipped")
def test_tables_and_figures_bear_any_design(changes):
    """Whatever the design: every table is made, no label overlaps or leaves the drawing."""
    one = evaluated(**changes)
    found = published_tables(one)
    assert len(found) == len(aalto_tables.TABLES)
    assert all(table.rows and table.note for table in found)
    cells = [str(cell) for table in found for row in table.rows for cell in row]
    assert not [cell for cell in cells if re.search(r"\bnan\b", cell)]
    for ink in figures(one.design):
        boxes = ink.text_boxes()
        assert overlaps(boxes) == []
        for words, left, top, right, bottom in boxes:
            assert 0 <= left < right <= ink.width, words
            assert 0 <= top < bottom <= ink.height, words


def test_curves_stay_in_their_frames(evaluation):
    """No curve is drawn outside the paper, and every frame has one."""
    for ink in figures(evaluation.design):
        for mark in ink.marks:
            for x, y in itertools.chain(*mark.get("path", ())):
                assert 0 <= x <= ink.width
                assert 0 <= y <= ink.height


def test_figures_stand_after_their_tables(evaluation):
    """On the page each drawing follows its table; the equations stand last, before the input."""
    blocks = page(evaluation, **SOURCE, extra_tables=published_tables(evaluation))["blocks"]
    titles = [b.get("title", "") for b in blocks]
    for name in ("stiffness along the stroke", "static test", "dynamic tests"):
        at = titles.index(f"Aalto thesis: {name}")
        assert (blocks[at]["kind"], blocks[at + 1]["kind"]) == ("table", "figure")
    assert titles.index("Aalto thesis: where its equations are") == len(blocks) - 2
    assert blocks[-1]["kind"] == "listing"
