"""The barrel's wall on paper: what stands there, and that nothing written collides."""

from __future__ import annotations

import re
from functools import cache

import pytest
import report_fixture as fixture
from test_through_wall import evaluated, with_wall

import actuator_opt as ao
from actuator_opt.pages import wall
from actuator_opt.pages.wall import Rung, ladder_figure
from actuator_opt.rendering import paper, paper_plain as fallback
from actuator_opt.rendering.ink import Ink

SOURCE = {"source_text": "a: 1\n", "source_name": "a.yaml", "command": "x", "date": None}
NAMES = ("knee_bonded.yaml", "aerospace.yaml", "elasswad_knee.yaml", "steel_baseline.yaml", "puck")


@cache
def many_layers():
    """The knee with a liner and 23 thin plies of five angles."""
    plies = "".join(
        f"    - material: t700_epoxy\n      angle: {(88, 25, 45, 60, 10)[i % 5]} deg\n"
        "      thickness: 0.2 mm\n"
        for i in range(23)
    )
    layup = f"  layup:\n    - material: al_7075_t6\n      thickness: 0.4 mm\n{plies}"
    return ao.evaluate(ao.read(with_wall(layup + "  criterion: tsai_wu\n")))


def subjects():
    """Evaluations with few and many layers, with and without plies, cure and autofrettage."""
    return [*map(evaluated, NAMES), many_layers()]


def blocks_of(evaluation):
    """Blocks of the wall by what follows "Barrel wall"."""
    found = paper.plain_blocks(wall.wall_blocks(evaluation))
    assert all(block["title"].startswith("Barrel wall") for block in found)
    return {block["title"].removeprefix("Barrel wall").strip(":, "): block for block in found}


def text_of(cell):
    """A cell as text."""
    return cell if isinstance(cell, str) else "".join(cell)


def test_all_of_the_wall_is_on_the_page():
    """Drawing, layers, stresses, criteria, ladder, both theories, thickness, metals: in order."""
    assert list(blocks_of(evaluated("knee_bonded.yaml"))) == [
        "from the bore outwards",
        "layers",
        "stress through the wall",
        "strength used through the wall",
        "strength ratios by every criterion",
        "from working pressure to burst",
        "exact tube compared with thin laminate",
        "thickness for another bore growth",
        "metal barrels for the same limits",
    ]


def test_a_metal_wall_has_no_criteria():
    """A steel barrel shows stresses, ladder and alternatives, nothing of plies."""
    titles = list(blocks_of(evaluated("steel_baseline.yaml")))
    assert not any("criterion" in title or "laminate" in title for title in titles)
    assert "stress through the wall" in titles


def test_without_a_study_there_is_the_drawing():
    """An evaluation without a wall study keeps the drawing of its layers."""
    assert list(blocks_of(fixture.build_evaluation())) == ["from the bore outwards"]


def test_the_wall_stands_before_the_check_list():
    """The section follows the masses and comes before limits and checks, in one piece."""
    titles = [
        b["title"] for b in fixture.page_data(evaluated("knee_bonded.yaml"), **SOURCE)["blocks"]
    ]
    places = [k for k, title in enumerate(titles) if title.startswith("Barrel wall")]
    assert places == list(range(places[0], places[0] + 9))
    assert titles[places[-1] + 1 :][:3] == [
        "Limits, place by place",
        "Why these limits",
        "Check list",
    ]
    assert titles[places[0] - 1] == "Dynamics"


def figures_of(evaluation):
    """Every figure of the wall as ink."""
    for block in paper.plain_blocks(wall.wall_blocks(evaluation)):
        if block["kind"] == "figure":
            ink = Ink(block["ink"]["width"], block["ink"]["height"])
            ink.marks = block["ink"]["marks"]
            yield ink


@pytest.mark.parametrize("index", range(len(NAMES) + 1))
def test_nothing_written_collides(index):
    """In every figure of the wall no two texts overlap, and all stay on the paper."""
    for ink in figures_of(subjects()[index]):
        boxes = ink.text_boxes()
        for k, (one, left, top, right, bottom) in enumerate(boxes):
            assert min(left, ink.width - right) > -0.5, one
            assert min(top, ink.height - bottom) > -0.5, one
            for other, a, b, c, d in boxes[k + 1 :]:
                assert right <= a or c <= left or bottom <= b or d <= top, (one, other)


@pytest.mark.parametrize("index", range(len(NAMES) + 1))
def test_curves_stay_on_the_paper(index):
    """Every line of the figures lies inside its drawing."""
    for ink in figures_of(subjects()[index]):
        points = [p for mark in ink.marks if "path" in mark for line in mark["path"] for p in line]
        assert all(0 <= x <= ink.width and 0 <= y <= ink.height for x, y in points)


def test_bars_are_to_scale():
    """Bars of the ladder are as long as their pressures; the tick stands at the limit."""
    rungs = [Rung("a", 1e7, "#ffffff", "", 3e7), Rung("b", 4e7, "#ffffff", "x" * 300)]
    ink = ladder_figure(rungs, 1e7)
    boxes = [m["path"][0] for m in ink.marks if m.get("closed")]
    widths = [box[1][0] - box[0][0] for box in boxes]
    assert widths[1] == pytest.approx(4 * widths[0], abs=0.01)
    tick = next(m["path"][0] for m in ink.marks if m.get("stroke") == "#a8321a")
    assert tick[0][0] - boxes[0][0][0] == pytest.approx(3 * widths[0], abs=0.01)
    texts = ink.text_boxes()
    assert all(right <= ink.width + 0.5 for _, _, _, right, _ in texts)
    assert any(words.endswith("…") for words, *_ in texts)


def test_criteria_table_reads_as_the_study():
    """Each cell starts with the ratio of its ply and criterion, and names mode, face and load."""
    evaluation = evaluated("knee_bonded.yaml")
    block = blocks_of(evaluation)["strength ratios by every criterion"]
    rows = [[text_of(cell) for cell in row] for row in block["rows"]]
    assert [row[0] for row in rows] == ["2", "3"]
    heads = [column["head"] for column in block["columns"]]
    assert heads[1:6] == ["maximum stress ●", "maximum strain", "Tsai-Wu", "Hashin", "Puck"]
    ratios = {(r.layer, r.criterion): r for r in evaluation.wall.ratios}
    for row in rows:
        for cell, name in zip(
            row[1:6], ("max_stress", "max_strain", "tsai_wu", "hashin", "puck"), strict=True
        ):
            known = ratios[int(row[0]) - 1, name]
            assert float(cell.split()[0]) == pytest.approx(known.ratio, rel=0.01)
            assert known.mode in cell
            assert known.face in cell
    assert "layer 1 yields at" in block["note"]


def test_ladder_names_layers_as_the_page_does():
    """No YAML index is left in the figure: layup[2] is layer 3."""
    block = blocks_of(evaluated("knee_bonded.yaml"))["from working pressure to burst"]
    words = [mark["text"] for mark in block["ink"]["marks"] if "text" in mark]
    assert not any("layup[" in one for one in words)
    assert any(re.match(r"layer \d", one) for one in words)
    for what in ("working pressure", "proof pressure", "first yield", "burst"):
        assert what in words
    assert "first ply, maximum stress" in words


def test_a_fabric_carries_its_warning():
    """Hashin and Puck on a woven ply are marked as outside what they were made for."""
    note = blocks_of(evaluated("elasswad_knee.yaml"))["strength ratios by every criterion"]["note"]
    assert "not to fabrics" in note
    plain = blocks_of(evaluated("puck"))["strength ratios by every criterion"]["note"]
    assert "fabric" not in plain


def test_equal_designs_give_equal_pages():
    """Two evaluations of one design make the same data to the letter."""
    first, second = (ao.evaluate(evaluated("knee_bonded.yaml").design) for _ in range(2))
    assert fixture.page_data(first, **SOURCE) == fixture.page_data(second, **SOURCE)


@pytest.mark.long
def test_the_plain_report_draws_it_too():
    """Without the typst wheel the section is there, on sheets of the fallback."""
    data = fixture.page_data(evaluated("knee_bonded.yaml"), **SOURCE) | {
        "source_file": "a.yaml", "source": "a: 1\n", "run": "{}",
    }  # fmt: skip
    data["blocks"] = paper.plain_blocks(wall.wall_blocks(evaluated("knee_bonded.yaml")))
    pdf, images = fallback.render(data, 0)
    assert pdf.startswith(b"%PDF")
    assert len(images) == 3
