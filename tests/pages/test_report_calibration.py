"""The page and the text of a calibration: its numbers, its figure, every outcome in words."""

from __future__ import annotations

import itertools
import json
import re
from dataclasses import replace
from functools import cache

import pytest
from identification_case import DESIGN, identified

import actuator_opt as ao
from actuator_opt.optimisation.redesign import solved
from actuator_opt.pages import calibration as document
from actuator_opt.rendering import paper, paper_plain as fallback, terminal
from actuator_opt.rendering.blocks import Origin

ORIGIN = Origin("a: 1\n", "a.yaml", "calibrate r.csv", "12ab")


RECORD = DESIGN.parent / "records" / "knee_bench.csv"
KINDS = ("levels", "plateaus", "one speed", "shipped")


@cache
def calibrated(kind):
    """A calibration of the knee; only that of the shipped record has its optimum searched."""
    if kind == "shipped":
        return ao.calibrate(RECORD, design=DESIGN)
    return ao.calibrate(identified(kind), design=DESIGN, search=False)


def page(found):
    """Its page as data."""
    return paper.plain(found.page(), ORIGIN)


def test_the_page_says_the_numbers_of_the_json():
    """Every new value stands in the table as in the JSON."""
    found = calibrated("levels")
    data = found.to_dict()
    body = document._values(found.calibration).rows
    named = {path: one for part in data["learned"].values() for path, one in part["values"].items()}
    assert {line[0] for line in body} == set(named)
    for line in body:
        value = named[line[0]]["value"]
        shown = float(line[2].split(" ")[0].replace("\N{NARROW NO-BREAK SPACE}", ""))
        scale = 1e3 if line[0].endswith("stribeck_speed") else 1.0
        assert shown == pytest.approx(scale * value, rel=6e-3)


@pytest.mark.long
def test_no_page_holds_a_nan():
    """Neither words nor drawing hold a number that is none."""
    for kind in KINDS:
        text = json.dumps(page(calibrated(kind)), allow_nan=False)
        assert not re.search(r"\bnan\b", text.lower())


@pytest.mark.long
def test_a_design_that_cannot_meet_its_limits_says_so():
    """The bore alone to change: infeasible, with the smallest change of limits that would do."""
    design = ao.read(DESIGN).design
    bore = {"cylinder.bore": design.variables["cylinder.bore"]}
    stiff = design.model_copy(update={"variables": bore})
    found = ao.calibrate(identified("levels"), design=stiff)
    assert not solved(found.redesign.best_after)
    data = page(found)
    assert data["verdict"]["state"] == "infeasible"
    said = document.remarks(found.calibration, found.redesign)
    assert any("no design meets all requirements" in words for words in said)
    assert any("smallest change of limits" in words for words in said)
    assert not any("at its limit" in words for words in said)


def test_without_a_search_there_is_no_optimum():
    """The page is shorter; nothing is said of a best design."""
    found = calibrated("plateaus")
    assert found.redesign.best_after is None
    titles = [block["title"] for block in page(found)["blocks"]]
    assert titles == [
        "Values measured, 95 % bounds",
        "Requirements that change",
        "Changes and basis of these results",
    ]


def test_one_speed_lists_what_was_left():
    """What the record cannot tell stands with its reason."""
    found = calibrated("one speed")
    said = " ".join(document.remarks(found.calibration, found.redesign))
    for key in ("breakaway_ratio", "stribeck_speed", "viscous_friction"):
        assert f"{key} keeps the value that the design states: one speed, 50 mm/s" in said


def test_levels_of_pressure_are_drawn_apart():
    """Points of like pressure share a curve; at most three curves are drawn."""
    groups = document.shown_levels(identified("levels").points)
    assert len(groups) == 3
    tops = [max(one.pressure for one in group) for group in groups]
    assert tops == sorted(tops)
    assert len(document.shown_levels(identified("plateaus").points)) <= 3


def test_texts_of_the_figure_do_not_meet():
    """No two upright texts of the drawing overlap."""
    for kind in KINDS:
        found = calibrated(kind)
        stated = found.calibration.identification.bench
        drawing = document.figure(found.calibration, found.redesign, stated)
        for a, b in itertools.combinations(drawing.text_boxes(), 2):
            apart = a[3] <= b[1] + 0.2 or b[3] <= a[1] + 0.2 or a[4] <= b[2] or b[4] <= a[2]
            assert apart, (kind, a[0], b[0])
        for words, left, top, right, bottom in drawing.text_boxes():
            assert left >= -0.5, words
            assert right <= drawing.width + 0.5, words
            assert top >= -0.5, words
            assert bottom <= drawing.height + 0.5, words


@pytest.mark.parametrize("width", [40, 60, 100, 200])
def test_the_terminal_fits_its_width(width):
    """No line is wider than the terminal, and ASCII stays ASCII."""
    found = calibrated("shipped")
    for unicode in (True, False):
        text = terminal.text(found.page(), colour=False, unicode=unicode, width=width)
        assert max(len(line) for line in text.splitlines()) <= width
        assert unicode or text.isascii()


def test_the_fallback_draws_it():
    """Without the typesetter the page is still written, in pure Python."""
    data = paper._printable(page(calibrated("shipped")))
    data |= {
        "title": "knee",
        "source": "name: knee",
        "source_file": "knee_bonded.yaml",
        "run": "{}",
    }
    pdf, images = fallback.render(data, 0)
    assert pdf.startswith(b"%PDF")
    assert images


def test_where_nothing_moves_it_says_so():
    """No requirement, or none that friction moves: one sentence, no empty drawing of margins."""
    found = calibrated("plateaus")
    still = replace(found, redesign=replace(found.redesign, shifts=()))
    assert still.redesign.moved is None
    said = document.remarks(still.calibration, still.redesign)
    assert said[0] == "No requirement changes."
    assert "No requirement changes." in json.dumps(page(still), allow_nan=False)
