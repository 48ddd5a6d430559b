"""The block `uncertainty`: what it takes, ISO 286 classes, faults at their line, the command."""

from __future__ import annotations

import csv
import json
import math

import jsonschema
import pytest
import scatter_case as case
from cases.digests import digests
from cli_runner import KNEE, run

import actuator_opt as ao
from actuator_opt.design.kinds import ValueFault
from actuator_opt.design.materials import load_library
from actuator_opt.design.schema import json_schema
from actuator_opt.design.standard_sizes import tables
from actuator_opt.design.uncertain import class_limits
from actuator_opt.design.writer import to_yaml
from actuator_opt.pages import uncertainty as document
from actuator_opt.pages.uncertainty import margins_figure, tornado
from actuator_opt.rendering import paper, terminal
from actuator_opt.rendering.blocks import Origin

BORE, AIR = "cylinder.bore", "fluid.air_content"
FIBRE = "materials.t700_epoxy.youngs_modulus_1"
GRADES = {5: 7, 6: 10, 7: 16, 8: 25, 9: 40, 10: 64, 11: 100, 12: 160, 13: 250, 14: 400}
"""Tolerance units of the grades, ISO 286-1."""
STEPS = (0, 3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500)


# ---- ISO 286 ----


def test_the_table_follows_the_formulas_of_iso_286():
    """Width k i, i = 0.45 D^(1/3) + 0.001 D um at the geometric mean of a step, rounded."""
    rows = tables()["iso_286"]["rows"]
    for low, high, row in zip(STEPS, STEPS[1:], rows, strict=False):
        size = math.sqrt((low or 1) * high)
        unit = 0.45 * size ** (1 / 3) + 0.001 * size
        for units, width in zip(GRADES.values(), row["widths"], strict=True):
            # rounded to 1 um, from 60 um to 5 and coarser beyond; the first step is of older make
            coarse = 0.16 if low == 0 else 0.09
            assert float(width) == pytest.approx(units * unit, rel=coarse, abs=0.8)


@pytest.mark.parametrize(
    ("letter", "factor", "power"), [("d", 16, 0.44), ("e", 11, 0.41), ("f", 5.5, 0.41),
                                    ("g", 2.5, 0.34)],
)  # fmt: skip
def test_fundamental_deviations_follow_their_formulas(letter, factor, power):
    """Deviation of shafts: d 16 D^0.44, e 11 D^0.41, f 5.5 D^0.41, g 2.5 D^0.34 um."""
    values = tables()["iso_286"]["shafts"][letter]
    for low, high, value in zip(STEPS, STEPS[1:], values, strict=False):
        exact = factor * math.sqrt((low or 1) * high) ** power
        assert float(value) == pytest.approx(exact, rel=0.09, abs=1.2)


@pytest.mark.parametrize(
    ("name", "size", "low", "high"),
    [("H8", 25, 0, 33), ("f7", 25, -41, -20), ("h6", 50, -16, 0), ("H7", 50, 0, 25),
     ("js9", 2, -12.5, 12.5), ("F8", 25, 20, 53), ("g6", 30, -20, -7), ("g6", 30.01, -25, -9)],
)  # fmt: skip
def test_classes_of_the_workshop(name, size, low, high):
    """Limits as printed in every table of fits, um."""
    found = class_limits(name, size * 1e-3)
    assert [1e6 * x for x in found] == pytest.approx([low, high], abs=1e-9)


@pytest.mark.parametrize(("name", "size"), [("K7", 0.02), ("H4", 0.02), ("", 0.02), ("H8", 0.6)])
def test_unknown_classes_are_refused(name, size):
    """A letter or grade that the table lacks, a size beyond it."""
    with pytest.raises(ValueFault):
        class_limits(name, size)


# ---- the block ----


def fault(stated, text=case.KNEE):
    """The only fault of a block, found while reading or while drawing."""
    with pytest.raises(ao.InputError) as caught:
        ao.uncertainty(ao.read(case.block(stated, text=text)), count=20, rows=0)
    (one,) = caught.value.diagnostics
    return one


GOOD = {
    BORE: {"tolerance": "H8"},
    AIR: {"distribution": "triangular", "lower": "0.1 %", "upper": "3 %"},
    FIBRE: {"distribution": "normal", "cv": "4 %", "source": "lot 7"},
    "fluid.temperature": {"distribution": "normal", "deviation": "3 K"},
    "rod.outer_diameter": {"distribution": "uniform", "half_width": "20 um"},
    "supply.pressure": {"distribution": "lognormal", "factor": "1.02"},
}


@pytest.mark.parametrize("kept", [True, False])
def test_a_written_design_reads_back(kept):
    """The block survives writing, beside comments and without them."""
    actuator = ao.read(case.block(GOOD, text=case.KNEE))
    text = to_yaml(actuator.design, actuator.source if kept else None)
    assert ao.read(text).design == actuator.design


def test_the_schema_knows_the_block():
    """An editor accepts what the reader takes and marks what it refuses."""
    schema = json_schema(materials=load_library())
    table = {**schema["properties"]["uncertainty"], "definitions": schema["definitions"]}
    editor = jsonschema.Draft7Validator(table)
    assert editor.is_valid(json.loads(json.dumps(GOOD)))
    for broken in (
        {BORE: {}}, {BORE: {"distribution": "gauss", "cv": "1 %"}}, {"cylinder.bor": GOOD[BORE]},
        {AIR: {"distribution": "normal", "deviation": "3 mm"}},
    ):  # fmt: skip
        assert not editor.is_valid(broken)


@pytest.mark.parametrize(
    ("path", "entry", "message", "remedy"),
    [
        ("cylinder.bor", {"tolerance": "H8"}, "unknown PATH", BORE),
        ("seals.rod.count", {"distribution": "normal", "cv": "1 %"}, "is a count", "remove"),
        ("cylinder.mount", {"distribution": "fixed"}, "is not a numeric input", "remove"),
        ("cylinder.mount_stiffness", {"distribution": "normal", "cv": "1 %"}, "not set", "write"),
        ("stiffness.seal_deflection", {"distribution": "normal", "cv": "1 %"}, "no model of this",
         "remove"),
        ("materials.peek.density", {"distribution": "normal", "cv": "1 %"}, "no model of this",
         "remove"),
        (BORE, {"tolerance": "Z99"}, "not a supported tolerance class", "H8"),
        (BORE, {"distribution": "gauss", "cv": "1 %"}, "is not a distribution", "normal"),
        (BORE, {"distribution": "normal"}, "has no parameters", "deviation, or cv"),
        (BORE, {"distribution": "normal", "cv": "1 %", "deviation": "1 mm"}, "has deviation and cv",
         "deviation, or cv"),
        (BORE, {"cv": "1 %"}, "missing", "distribution"),
        (BORE, {"distribution": "uniform", "lower": "22 mm", "upper": "24 mm"},
         "while the optimiser varies", "half_width"),
        (AIR, {"distribution": "normal", "deviation": "3 %"}, "the valid range", "lognormal"),
        (FIBRE, {"distribution": "normal", "cv": "30 %"}, "the valid range", "lognormal"),
        (AIR, {"distribution": "uniform", "lower": "3 %", "upper": "1 %"}, "reversed", "swap"),
        (AIR, {"distribution": "uniform", "lower": "1 %", "upper": "2 %"},
         "design, 0.5 %, is outside",
         "widen"),
        (AIR, {"distribution": "normal", "cv": "3 mm"}, "3 mm", ""),
        (AIR, {"distribution": "lognormal", "factor": "0.5"}, "0.5", "1"),
        (AIR, {"distribution": "normal", "cv": "1 %", "mean": "1 %"}, "unknown key", ""),
    ],
)  # fmt: skip
def test_faults_are_one_line_at_their_place(path, entry, message, remedy):
    """Wrong PATHs, keys, sizes and ranges: said at the line, with what to do."""
    found = fault({path: entry})
    assert message in found.message
    assert remedy in found.remedy
    assert found.line is not None
    assert found.line > case.KNEE.count("\n")


def test_older_designs_keep_their_hash():
    """A block that is not there does not enter the hash; one that is does."""
    plain, stated = case.KNEE, case.block({BORE: {"tolerance": "H8"}}, text=case.KNEE)
    one, other = (ao.evaluate(ao.read(text)) for text in (plain, stated))
    assert one.spec_hash != other.spec_hash
    assert {n: m.value for n, m in one.metrics.items()} == {
        n: m.value for n, m in other.metrics.items()
    }


# ---- the command ----


def test_the_schema_is_printed_whole():
    """The command prints JSON: no number of it is infinite."""
    data = run("schema").json
    assert "cylinder.bore" in data["properties"]["uncertainty"]["properties"]


def test_the_command_prints_json_of_the_contract():
    """Yield with bounds, indices; the knee as shipped misses its requirements: exit 1."""
    result = run("uncertainty", KNEE, "-n", "300", "--index-rows", "64", "--json")
    assert result.code == 1
    data = result.json
    assert set(data["yield"]) == {"value", "lower", "upper"}
    assert data["yield"]["value"] == 0.0 < data["yield"]["upper"] < 0.02
    assert data["requirements"][0]["name"] == "seal_gap"
    assert data["samples"] == 300
    assert {"parameter", "output", "first", "total"} <= set(data["indices"][0])
    assert data["inputs"][0]["path"] == "barrel.layup[0].thickness"
    assert data["outputs"]["mass"]["unit"] == "kg"


@pytest.mark.long
def test_the_command_writes_draws_and_pages(tmp_path):
    """CSV with a line per draw, PDF and PNG; the same bytes again."""
    files = {}
    for number in range(2):
        target = tmp_path / "draws.csv"
        result = run(
            "uncertainty", KNEE, "-n", "100", "--index-rows", "64", "--csv", target, "--report",
            "--out", tmp_path, "--quasi",
        )  # fmt: skip
        assert "knee_bonded_uncertainty.pdf" in result.err
        files[number] = digests(tmp_path)
    assert files[0] == files[1]
    with (tmp_path / "draws.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    assert len(rows) == 1 + 16 * 8  # sixteen randomisations of the next power of two
    assert rows[0][0] == "barrel.layup[0].thickness [mm]"
    assert {row[-1] for row in rows[1:]} == {"0"}


@pytest.mark.parametrize(
    ("options", "code", "words"),
    [
        (["-n", "3"], 2, "3 draws"),
        (["--metric", "no_such"], 3, "no_such cannot be evaluated"),
        (
            ["--set", "uncertainty.cylinder.bore.tolerance=Z99"],
            3,
            "not a supported tolerance class",
        ),
        (["--csv", "/no/such/folder/x.csv"], 3, "folder"),
    ],
)
def test_bad_options_are_one_line(options, code, words):
    """Usage and input faults leave with one line, no traceback."""
    result = run("uncertainty", KNEE, *options)
    assert result.code == code
    assert words in result.err
    assert "Traceback" not in result.err


def test_text_in_ascii_and_narrow():
    """Plain ASCII on a narrow terminal: no line beyond it."""
    found = ao.uncertainty(case.KNEE, count=100, rows=64)
    said = terminal.text(document.page(found), colour=False, unicode=False, width=60)
    assert said.isascii()
    assert max(map(len, said.splitlines())) <= 60


def overlaps(ink):
    """Pairs of texts that meet."""
    boxes = ink.text_boxes()
    return [
        (a[0], b[0])
        for k, a in enumerate(boxes)
        for b in boxes[k + 1 :]
        if a[1] < b[3] - 0.2 and b[1] < a[3] - 0.2 and a[2] < b[4] - 0.2 and b[2] < a[4] - 0.2
    ]


def test_figures_have_no_overlapping_words():
    """Strips and tornados of the knee: no label meets another, none leaves the paper."""
    found = ao.uncertainty(case.KNEE, count=200, rows=64)
    inks = [margins_figure(found), tornado(found, "stiffness_min"), tornado(found, "mass")]
    for ink in inks:
        assert ink is not None
        assert overlaps(ink) == []
        for _, left, top, right, bottom in ink.text_boxes():
            assert left > -0.5
            assert top > -0.5
            assert right < ink.width + 0.5
            assert bottom < ink.height + 0.5


def test_a_page_without_scatter_or_requirements():
    """Nothing to draw and nothing to hold: still a page."""
    found = ao.uncertainty(case.only({}), count=20)
    page = document.page(found)
    assert page.blocks[-1].title == "What the yield means"
    assert paper.plain(page, Origin("", "x.yaml", "", found.spec_hash))["blocks"]
