"""What stands on the sheet: content of the blocks, before any ink."""

from dataclasses import replace

import pytest
import report_fixture as fixture

from actuator_opt.pages import optimum
from actuator_opt.pages.report import key_figures, verdict
from actuator_opt.rendering import paper
from actuator_opt.rendering.blocks import text_table

SOURCE = {"source_text": "a: 1\n", "source_name": "a.yaml", "command": "x", "date": None}


def block(data, title):
    """The block with a title that starts so."""
    return next(b for b in data["blocks"] if b["title"].startswith(title))


def text_of(cell):
    """A cell as text."""
    if isinstance(cell, dict):
        return cell.get("text", "")
    return cell if isinstance(cell, str) else "".join(cell)


def rows_of(data, title):
    """Rows of a table as texts."""
    return [[text_of(cell) for cell in row] for row in block(data, title)["rows"]]


def test_requirements_show_limit_result_margin_status_and_case():
    """One row per requirement with everything an engineer signs for."""
    rows = rows_of(fixture.page_data(fixture.build_evaluation(), **SOURCE), "Requirements")
    assert rows[5] == [
        "seal_squeeze",
        "smallest seal squeeze after bore growth and tolerance",
        "≥ 8 %",
        "9.400 %",
        "+17.5 %",
        "",
        "met",
        "swing, piston seal",
    ]
    assert len(rows) == 11


def test_price_is_per_display_unit():
    """0.77 × 205.2 g / 10 kN/mm is 15.8 g per kN/mm, the value beside it in kN/mm too."""
    row = rows_of(fixture.page_data(fixture.build_optimisation(), **SOURCE), "What each")[0]
    assert row[:7] == ["stiffness_min.min", "10 kN/mm", "10.00", "0.0 %", "●", "+15.8", "+0.770"]
    assert row[7:11] == ["221.0", "221.7", "189.4", "190.4"]


@pytest.mark.parametrize(
    ("width", "end"),
    [
        (80, "190.4"),
        (100, "190.4 12.1 kN/mm"),
        (200, "190.4 12.1 kN/mm with rod.outer_diameter upper bound"),
    ],
)
def test_the_end_of_a_price_is_shown_from_100_columns_on(width, end):
    """Widths of a usual terminal: 80 columns are full without it, 100 have room for the value."""
    shown = fixture.shown(fixture.build_optimisation(), width=width)
    line = next(x for x in shown.splitlines() if x.startswith("stiffness_min.min"))
    assert " ".join(line.split()).endswith(end)


def test_infeasible_resolve_shows_a_dash():
    """A re-solve that found nothing is a dash, never a number."""
    rows = rows_of(fixture.page_data(fixture.build_optimisation(), **SOURCE), "What each")
    assert rows[3][10] == "–"


def test_masses_add_up():
    """The printed parts add up to the printed dry mass; oil stands below it."""
    rows = rows_of(fixture.page_data(fixture.build_evaluation(), **SOURCE), "Parts and mass")
    parts = [float(row[3]) for row in rows[:-3]]
    assert sum(parts) == pytest.approx(float(rows[-3][3]), abs=0.011)
    assert [row[0] for row in rows[-3:]] == ["dry mass", "oil inside", "filled"]


def test_checks_all_stand_with_reason_and_source():
    """Every line of the check list is printed, unchecked ones with their reason."""
    evaluation = fixture.build_evaluation()
    rows = rows_of(fixture.page_data(evaluation, **SOURCE), "Check list")
    assert len(rows) == len(evaluation.checks)
    assert rows[7][4] == "not checked"
    assert rows[7][6].startswith("the design has no lines; common practice")


def test_extrapolated_models_are_flagged():
    """A model outside its range says so in its row and in the note."""
    found = block(fixture.page_data(fixture.build_evaluation(), **SOURCE), "Models")
    assert [text_of(row[5]) for row in found["rows"]] == ["inside", "EXTRAPOLATED", "EXTRAPOLATED"]
    assert "2 of 3" in found["note"]


@pytest.mark.parametrize(
    ("subject", "state"),
    [
        (fixture.build_evaluation(), "checks"),
        (fixture.build_infeasible(), "infeasible"),
        (
            fixture.build_evaluation(
                requirements=(replace(fixture.requirements()[0], met=False, margin=-0.1),)
            ),
            "missed",
        ),
    ],
    ids=["checks", "infeasible", "missed"],
)
def test_verdict(subject, state):
    """The badge says met (or which checks are not), missed or infeasible, with the counts."""
    found = verdict(subject)
    assert found.state == state
    assert found.lines[1] == "checks: 6 met · 1 missed · 3 not checked"


def test_key_figures_are_five_and_start_with_the_objective():
    """Five tiles; a quantity without a value is passed over."""
    evaluation = fixture.build_evaluation()
    empty = replace(evaluation.metrics["stiffness_min"], value=None, why="no oil")
    evaluation = replace(evaluation, metrics=dict(evaluation.metrics) | {"stiffness_min": empty})
    tiles = key_figures(fixture.build_optimisation(evaluation))
    assert len(tiles) == 5
    assert tiles[0].value == "205.2"
    assert tiles[0].note == "start 312.1 g, −34.3 %"
    assert "stiffness" not in " ".join(tile.label for tile in tiles)


def test_the_infeasibility_card_reads_as_advice():
    """Limits by the PATH to set, now and needed with units, signed changes; what alone cannot."""
    said, joint, alone, bounds, proof = paper.plain_blocks(
        optimum.infeasibility_blocks(fixture.build_infeasible().infeasibility)
    )
    assert "250 N → 281 N (+12.4 %)" in text_of(said["items"][0])
    assert [text_of(cell) for cell in joint["rows"][1]] == [
        "requirements.stiffness_min.min", "requirement", "10 kN/mm", "9.7 kN/mm", "−3 %",
    ]  # fmt: skip
    assert [[text_of(cell) for cell in row] for row in alone["rows"]] == [
        ["caps.thickness", "fixed dimension", "5 mm", "6 mm", "+20 %"],
        ["seals.rod.compound", "choice", "nbr_90", "nbr_70", "–"],
        ["requirements.retention_factor.min", "safety: not advised", "1.5", "1.2", "−20 %"],
    ]  # fmt: skip
    assert "however far they are relaxed: requirements.seal_gap.max." in alone["note"]
    assert alone["note"].endswith("Not tried, to save time: caps.material.")
    # 1 % more room: 0.01 x 0.077 of 0.154, that is 0.5 % of the gap
    assert [text_of(cell) for cell in bounds["rows"][0]] == [
        "variables.seals.piston.section.lower", "1.78 mm", "0.50 %", "1.6 mm", "−10.1 %",
    ]  # fmt: skip
    assert "15.4 % of their values" in bounds["note"]
    assert "evidence, not proof" in text_of(proof["items"][0])


def test_nothing_to_say_is_said():
    """Empty lists give sentences, not empty tables."""
    evaluation = fixture.build_evaluation(
        requirements=(), checks=(), warnings=(), unverified=(), models=()
    )
    data = fixture.page_data(evaluation, **SOURCE)
    assert "states no requirement" in text_of(block(data, "Requirements")["items"][0])
    assert all(b["title"] != "Warnings" for b in data["blocks"])


def test_extra_tables_stand_before_the_appendix():
    """A caller's table is printed; then models, data and the listing."""
    extra = text_table(
        "Published beside ours", ["what", "paper", "ours"], [["gap", "1.5", "1.6"]], "they differ"
    )
    data = fixture.page_data(fixture.build_evaluation(), **SOURCE, extra_tables=[extra])
    titles = [b["title"] for b in data["blocks"]]
    start = titles.index("Published beside ours")
    assert titles[start + 1 : start + 4] == [
        "Appendix", "Assumptions and unverified data", "Models",
    ]  # fmt: skip
    assert data["blocks"][-1]["kind"] == "listing"


def test_wall_time_stays_off_the_page():
    """Seconds differ between runs, so equal input gives equal data."""
    one = fixture.page_data(fixture.build_optimisation(seconds=0.1), **SOURCE)
    assert one == fixture.page_data(fixture.build_optimisation(seconds=9.9), **SOURCE)
