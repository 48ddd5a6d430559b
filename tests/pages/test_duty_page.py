"""Duty cycles on the page, on the card, in JSON and in CSV."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from cli_runner import DESIGNS, run
from duty_page_case import FLIGHT, GAIT, RUN, cycle, design, evaluated
from report_fixture import build_infeasible

import actuator_opt as ao
from actuator_opt.base.tables import encoded
from actuator_opt.evaluation.duty_cycles.warming import POINTS
from actuator_opt.models.linkage import linkage
from actuator_opt.pages import card, duty, duty_figures, limits, report
from actuator_opt.rendering import html, terminal
from actuator_opt.rendering.blocks import Chart, Notes, Table
from actuator_opt.rendering.chart_ink import drawn
from actuator_opt.rendering.console import visible
from actuator_opt.rendering.ink import Ink
from actuator_opt.rendering.series import csv_text
from actuator_opt.rendering.text import value_text

WALK = cycle("walk", GAIT, repeats="5e6", starts="2000")
HURRY = cycle("run", RUN, torque_scale="1.2", time_scale="0.9")
HOLD = cycle("hold", "time [s],position [mm],force [N]\n0,50,500\n0.2,50,800\n0.4,50,-9\n1,50,500")
HARD = cycle(
    "hard",
    "time [s],position [mm],force [N]\n0,20,500\n0.1,60,8000\n0.2,90,-200\n0.3,50,-6000\n0.4,20,90",
    closed="false",
)
PARTED = cycle(
    "parted",
    "time [s],position [mm],force [N],supply_pressure [bar]\n"
    "0,20,500,200\n0.3,60,-900,180\n0.5,90,-200,150\n0.8,50,-600,190\n1,20,500,200",
)
DENSE = "time [s],position [mm],force [N]\n" + "\n".join(
    f"{k / 1000},{60 + 20 * math.sin(math.tau * k / 19999):.6f},"
    f"{900 * math.sin(8 * math.tau * k / 19999):.5f}"
    for k in range(20000)
)
DESIGNS_OF = {
    "walk": partial(evaluated, WALK),
    "two": partial(evaluated, WALK, HURRY, limit="80 %"),
    "no valve": partial(evaluated, WALK, valve=False),
    "still": partial(evaluated, HOLD, linkage=False),
    "hard": partial(evaluated, HARD, PARTED, linkage=False),
}


def case(name):
    """The evaluation of one of the designs above."""
    return DESIGNS_OF[name]()


def tables(evaluation):
    """All tables on the duty cycles by title."""
    return {x.title: x for x in duty.duty_blocks(evaluation) if isinstance(x, Table)}


def charts(evaluation):
    """The figures of single duty cycles."""
    shown = [x for x in duty.duty_blocks(evaluation) if isinstance(x, Chart)]
    return [x for x in shown if x.title.startswith("Duty cycle ")]


def warming(evaluation):
    """The figure of temperatures from cold."""
    (figure,) = (x for x in duty.duty_blocks(evaluation) if x.title == duty_figures.WARMING_TITLE)
    return figure


def titles(chart):
    """Titles of all panels of a figure, without their units."""
    panels = [part for column in chart.columns for part in column if not isinstance(part, Ink)]
    return [panel.title.rpartition(",")[0] or panel.title for panel in panels]


def margins(evaluation, name):
    """Rows of the worst samples of a cycle by their first cell."""
    table = tables(evaluation)[f"Cycle {name}: where margins are least"]
    return {row.cells[0]: row for row in table.rows}


def test_a_design_without_cycles_has_nothing_on_them():
    """Neither blocks nor columns; the card is as before."""
    evaluation = ao.evaluate(DESIGNS / "knee.yaml")
    assert duty.duty_blocks(evaluation) == duty.card_blocks(evaluation) == []
    assert duty.series(evaluation) == []


def test_the_overview_has_the_metrics_of_every_cycle():
    """Reserve, flows, energy and efficiency are those of the table of metrics."""
    two = case("two")
    table = tables(two)["Duty cycles"]
    heads = [column.head for column in table.columns]
    for row, name in zip(table.rows, ("walk", "run"), strict=True):
        cells = dict(zip(heads, row.cells, strict=True))
        at = {key: two.metrics[f"duty_{key}"].by_place[name] for key in (
            "force_margin", "opening", "flow_peak", "flow_mean", "supply_energy", "efficiency"
        )}  # fmt: skip
        assert cells["reserve"] == duty.value_of(duty.FORCE, at["force_margin"])
        assert cells["opening"] == duty.value_of(duty.OPENING, at["opening"])
        mean = duty.value_of(duty.FLOW, at["flow_mean"])
        assert cells["peak, mean flow"].endswith(f", {mean}")
        assert cells["peak, mean flow"].startswith(f"{60000 * at['flow_peak']:.3g}")
        assert cells["supply"] == duty.value_of(duty.ENERGY, at["supply_energy"])
        assert cells["efficiency"] == f"{100 * at['efficiency']:#.3g} %"
    assert [row.state for row in table.rows] == ["met", "missed"]  # the run needs 177 %


def test_worst_samples_stand_with_their_time_and_state():
    """The row of a result is the sample at which its trace is worst."""
    two = case("two")
    study = two.duty.cycles[1]
    rows = margins(two, "run")
    at = int(np.argmin(study.traces["reserve"]))
    row = rows["least force reserve"]
    assert row.state == "missed"
    assert row.cells[1] == duty.value_of(duty.FORCE, float(study.traces["reserve"][at]))
    assert row.cells[3] == f"{0.9 * study.record.time[at]:#.3g} s"  # the machine's time
    angle = math.degrees(study.record.motion[at])
    assert row.cells[4] == f"{angle:.1f}°".replace("-", "\N{MINUS SIGN}")
    assert rows["largest opening"].cells[2] == "≤ 80 %"
    assert rows["lowest pressure, chamber A"].state == "met"


def test_a_requirement_is_the_limit_of_its_row():
    """A stated limit on the peak flow is shown, and missed if the cycle needs more."""
    text = design(WALK).replace(
        "requirements:\n", "requirements:\n  duty_flow_peak:\n    max: 9 l/min\n"
    )
    row = margins(ao.evaluate(ao.read(text)), "walk")["peak flow"]
    assert (row.state, row.cells[2]) == ("missed", "≤ 9 l/min")


def test_torques_and_times_are_scaled():
    """Joint torque and time of the figure are those of the machine, not of the file."""
    study = case("two").duty.cycles[1]
    torque = duty_figures.trace_of(study, "torque")
    assert torque == pytest.approx(1.2 * study.record.load)
    worst = study.worst["reserve"]
    assert study.state(worst.sample)["joint_torque"] == pytest.approx(torque[worst.sample])
    strips = charts(case("two"))[1].columns[0]
    assert strips[0].curves[0].xs[-1] == pytest.approx(0.9 * study.record.time[-1])


def test_sources_of_energy_equal_its_sinks():
    """The bars of the picture lead back to zero."""
    for evaluation in map(case, DESIGNS_OF):
        for study in evaluation.duty.cycles:
            parts = duty_figures.balance_of(study)
            given = sum(value for _, value in parts if value > 0)
            assert sum(value for _, value in parts) == pytest.approx(0.0, abs=1e-9 * given)
            assert parts[0][0] == "supply"


def test_the_linkage_is_drawn_to_scale():
    """Distances of the three joints on paper are the lengths at the least reserve."""
    study = case("walk").duty
    worst = study.cycles[0].worst["reserve"].sample
    picture = next(
        part
        for part in charts(case("walk"))[0].columns[1]
        if isinstance(part, Ink) and any("SCALE" in m["text"] for m in part.marks if "text" in m)
    )
    words = [mark["text"] for mark in picture.marks if "text" in mark]
    paper, real = next(w.split()[1] for w in words if w.startswith("SCALE")).split(":")
    circles = [m["path"][0] for m in picture.marks if "path" in m and len(m["path"][0]) == 32]
    pivot, crank, joint = (np.mean(circle, axis=0) for circle in circles)
    scale = 1000 * int(paper) / int(real)
    own = linkage(
        base_radius=0.24, crank_radius=0.062, angle_offset=math.radians(120),
        joint_angle=study.cycles[0].record.motion[worst],
    )  # fmt: skip
    for a, b, length in ((pivot, joint, 0.24), (crank, joint, 0.062), (pivot, crank, own.length)):
        assert math.dist(a, b) == pytest.approx(scale * length, abs=0.01)
    assert f"lever arm {1e3 * own.lever_arm:#.3g} mm (dashed)" in words
    assert all(0 <= x <= picture.width for circle in circles for x, _ in circle)


@pytest.mark.parametrize("offset", [120.0, -75.0])
def test_a_pose_has_the_length_and_lever_arm_of_the_model(offset):
    """On either side of the base."""
    sizes = duty_figures.LinkageSize(0.3, 0.05, math.radians(offset), 0.2)
    pose = duty_figures._pose_at(sizes, 0.2)
    own = linkage(
        base_radius=0.3, crank_radius=0.05, angle_offset=math.radians(offset), joint_angle=0.2
    )
    (px, py), (cx, cy) = pose
    length = math.dist(pose.pivot, pose.crank)
    assert length == pytest.approx(own.length)
    assert abs(px * cy - py * cx) / length == pytest.approx(abs(own.lever_arm))


def test_the_figure_shows_what_the_cycle_has():
    """Joint and linkage only with a joint, opening only with a valve."""
    walk, bare = titles(charts(case("walk"))[0]), titles(charts(case("no valve"))[0])
    assert walk[:3] == ["Joint angle", "Joint torque", "Lever arm"]
    assert {"Valve opening", "The cycle enlarged"} <= {*walk}
    assert "Valve opening" not in bare
    assert "no valve is stated" in charts(case("no valve"))[0].note
    still = charts(case("still"))[0]
    assert titles(still)[0] == "Position of the piston"
    assert "The cycle enlarged" not in titles(still)
    assert len(charts(case("walk"))[0].columns[1]) == 4  # two planes, energy, linkage
    assert len(still.columns[1]) == 2


def test_every_figure_keeps_its_words_apart_and_inside():
    """No word leaves the paper; curves are thinned to what the pen can show."""
    for evaluation in map(case, DESIGNS_OF):
        for chart in (*charts(evaluation), warming(evaluation)):
            ink = drawn(chart)
            for words, left, top, right, bottom in ink.text_boxes():
                assert -1 < left < right < ink.width + 1, words
                assert -1 < top < bottom < ink.height + 1, words


def test_the_plane_marks_the_least_reserve_between_cycle_and_limit():
    """The line goes from the sample to the limit at its speed, as long as the reserve."""
    study = case("walk").duty.cycles[0]
    plane = charts(case("walk"))[0].columns[1][0]
    worst = study.worst["reserve"]
    line = next(curve for curve in plane.curves if len(curve.xs) == 2)
    assert line.xs[0] == line.xs[1] == pytest.approx(study.traces["speed"][worst.sample])
    # friction depends on the force a little, so the distance is that reserve but for a few per cent
    assert abs(line.ys[1] - line.ys[0]) == pytest.approx(worst.value, rel=0.05)


def test_only_a_cycle_that_moves_the_linkage_has_its_picture():
    """A design with a linkage may have a cycle of position and force, too."""
    mixed = evaluated(WALK, HARD)
    assert [len(chart.columns[1]) for chart in charts(mixed)] == [4, 2]
    assert mixed.duty.cycles[1].traces["position"] == pytest.approx([0.02, 0.06, 0.09, 0.05, 0.02])
    columns = {column.head: column.values for column in duty.series(mixed)}
    assert np.isnan(columns["joint_angle [deg]"][-5:]).all()


def test_a_load_that_does_not_move_has_no_efficiency():
    """Leakage alone costs energy."""
    still = case("still")
    assert tables(still)["Duty cycles"].rows[0].cells[-1] == "nothing moves"
    study = still.duty.cycles[0]
    assert study.efficiency is None
    assert still.duty.to_dict()["cycles"][0]["efficiency"] is None
    assert [name for name, value in duty_figures.balance_of(study) if value] == [
        "supply", "leakage"
    ]  # fmt: skip


def test_a_load_that_stalls_says_so():
    """There is no opening; the reserve is negative, and the gaps are named."""
    rows = margins(case("hard"), "hard")
    assert (rows["largest opening"].cells[1], rows["largest opening"].state) == ("stalls", "missed")
    assert rows["lowest pressure, chamber A"].state == "missed"
    assert "Valve opening (gaps: stall)" in titles(charts(case("hard"))[0])
    parted = charts(case("hard"))[1]
    assert "least supply pressure of the cycle" in parted.note


def test_parts_are_listed_by_their_damage():
    """The worst first; the rest is counted, and cycles without repeats are named."""
    two = case("two")
    table = tables(two)["Duty cycles: fatigue damage of a life"]
    damage = two.metrics["duty_fatigue"].by_place
    ranked = sorted(damage.values(), reverse=True)
    assert len(table.rows) <= duty.MOST_PARTS < len(damage)
    assert [row[1] for row in table.rows] == [
        duty.number(value, 3) for value in ranked[: len(table.rows)]
    ]
    assert f"{len(damage) - len(table.rows)} more parts" in table.note
    assert "Without repeats, so not counted: run." in table.note


def test_only_the_worst_cycles_have_a_figure():
    """The table has them all."""
    many = evaluated(*(
        cycle(f"walk {k}", GAIT, torque_scale=1 + k / 4, time_scale=1.5) for k in range(8)
    ))  # fmt: skip
    shown = [chart.title for chart in charts(many)]
    assert shown == [f"Duty cycle walk {k}" for k in range(2, 8)]
    table = tables(many)["Duty cycles"]
    assert len(table.rows) == 8
    assert "Figures follow for the 6 cycles" in table.note
    lines = [block.items[0] for block in duty.card_blocks(many) if isinstance(block, Notes)]
    assert lines[-1] == "5 more cycles (-v)"


@pytest.mark.parametrize("width", [40, 80, 110])
@pytest.mark.parametrize("unicode", [True, False])
def test_the_terminal_keeps_its_width(width, unicode):
    """Card and page, in ASCII, too."""
    style = {"width": width, "colour": False, "unicode": unicode}
    for evaluation in map(case, DESIGNS_OF):
        for blocks in (duty.card_blocks(evaluation), duty.duty_blocks(evaluation)):
            text = terminal.blocks_text(blocks, **style)
            assert max(map(visible, text.splitlines())) <= width
            assert unicode or text.isascii()


def test_the_card_has_a_short_block():
    """Reserve with its time, opening, flows, energy and efficiency; then the worst part."""
    text = terminal.blocks_text(card.blocks(case("walk")), width=80, colour=False, unicode=True)
    assert len(text.splitlines()) <= 30
    assert "3784 N  0.704 s   46.9 %  9.40, 3.08 l/min  1187 J     0.400 %" in text
    assert "energy of walk: throttling 78 %, leakage 19 %" in " ".join(text.split())
    assert "fatigue of the life: 0.0223, thread root in the bore, at the head" in text


def test_the_page_and_its_html_have_the_cycles():
    """The blocks follow those of the dynamics, on paper and in HTML."""
    page = report.page(case("walk"))
    named = [getattr(block, "title", "") for block in page.blocks]
    assert named.index("Duty cycle walk") > named.index("Duty cycles")
    assert "Duty cycle walk" in html.document(page, None)


def test_the_traces_are_written_as_csv():
    """A column for every trace with its unit; a cycle without a column has empty cells."""
    mixed = evaluated(WALK, HURRY)
    columns = {column.head: column.values for column in duty.series(mixed)}
    first = mixed.duty.cycles[0]
    count = first.time.size
    assert columns["cycle"][:count] == ["walk"] * count
    assert columns["joint_angle [deg]"][:count] == pytest.approx(np.degrees(first.record.motion))
    assert columns["joint_torque [N*m]"][:count] == pytest.approx(first.record.load)
    assert columns["pressure_a [bar]"][:count] == pytest.approx(first.traces["pressure_a"] / 1e5)
    assert columns["supply_flow [l/min]"][:count] == pytest.approx(6e4 * first.traces["flow"])
    assert "contact_pressure of the rod seal [bar]" in columns
    text = csv_text(duty.series(case("hard")))
    assert "joint_angle" not in text
    assert len(text.splitlines()) == 1 + 10 + 2 * POINTS
    assert ",inf," in text or ",," in text  # past stall there is no opening


def test_temperatures_follow_the_traces_in_the_csv_file():
    """Rows of their own, named after the cycle, without traces."""
    two = case("two")
    columns = {column.head: column.values for column in duty.series(two)}
    rows = sum(cycle.time.size for cycle in two.duty.cycles)
    names = [f"{name}, from cold" for name in ("walk", "run") for _ in range(POINTS)]
    assert columns["cycle"][rows:] == names
    run = two.duty.warming[1]
    assert columns["time [s]"][-POINTS:] == pytest.approx(run.time)
    for place in run.places:
        own = columns[f"temperature of {place.name} [degC]"]
        assert own[-POINTS:] == pytest.approx(place.temperature - 273.15)
        assert np.isnan(own[:rows]).all()
    assert np.isnan(columns["force [N]"][rows:]).all()


def test_a_panel_shows_temperatures_limits_and_when_they_are_exceeded():
    """A mark where the plies reach their limit; the table names the place and the time."""
    text = design(WALK)
    soft = ao.evaluate(ao.read(text, set={"materials.t700_epoxy.temperature_max": "45 degC"}))
    first = soft.duty.warming[0]
    panel = warming(soft).panels[0]
    assert panel.title == "walk: temperature, °C"
    assert len(panel.curves) == len(warming(soft).key) == 4
    assert panel.curves[0].ys == pytest.approx(first.places[-3].temperature - 273.15)  # the oil
    assert any(level.value == pytest.approx(45.0) for level in panel.levels)
    crossed = [place for place in first.places if place.crossed is not None]
    assert [x.ys for x in panel.points] == [[pytest.approx(45.0)]] * len(crossed)
    marks = {(*x.xs, *x.labels) for x in panel.points}
    assert marks == {(x.crossed, duty_figures.duration_words(x.crossed)) for x in crossed}
    rows = tables(soft)["Duty cycles: limits of temperature"].rows
    assert [row.state for row in rows] == ["missed"] * len(rows)
    own = [row.cells for row in rows if row.cells[0] == "walk"]
    assert [row[3] for row in own] == [x.name for x in sorted(crossed, key=lambda x: x.crossed)]
    assert own[0][6] == f"after {duty_figures.duration_words(min(x.crossed for x in crossed))}"
    assert own[0][1] == duty_figures.duration_words(first.time_constant)
    calm = tables(case("walk"))["Duty cycles: limits of temperature"]
    assert [(row.state, row.cells[6]) for row in calm.rows] == [("met", "–")]
    assert "begin at 20.0 °C, as warm as the air" in calm.note


def test_what_lacks_is_shown_once():
    """In the first blocks of page and card and in JSON, not among the warnings."""
    hard = case("hard")
    (table,) = duty.shortfall_blocks(hard)
    assert len(table.rows) == len(hard.duty.shortfalls) > 1
    first = hard.duty.shortfalls[0]
    assert (first.cycle, first.lacks, first.time) == ("hard", "force", 0.3)
    assert not [text for text in hard.warnings if "too little force" in text]
    for blocks in (report.page(hard).blocks, card.blocks(hard)):
        text = terminal.blocks_text(blocks, width=100, colour=False, unicode=True)
        assert text.count("too little force") == sum(
            x.lacks == "force" for x in hard.duty.shortfalls
        )
    data = hard.to_dict()["duty"]["shortfalls"]
    assert data[0]["sentence"] == first.sentence
    assert {*data[0]["remedies"][0]} == {"path", "now", "needed"} if data[0]["remedies"] else True
    assert duty.shortfall_blocks(case("walk")) == []


def test_the_answer_of_an_infeasible_search_says_what_the_cycles_lack():
    """In JSON it is part of `infeasibility`, and of nothing else; on the card it comes first."""
    hard = case("hard")
    optimum = replace(build_infeasible(), evaluation=hard)
    data = optimum.to_dict()
    assert data["infeasibility"]["duty_cycles"] == hard.duty.to_dict()["shortfalls"]
    assert "shortfalls" not in data["duty"]
    text = terminal.blocks_text(card.blocks(optimum), width=100, colour=False, unicode=True)
    assert text.count("too little force") == text.split("no help")[0].count("too little force") > 0
    page = terminal.blocks_text(report.page(optimum).blocks, width=100, colour=False, unicode=True)
    assert page.index("What the duty cycles lack") > page.index("Why no design meets all limits")


def test_a_number_that_is_not_finite_is_listed_with_its_reason():
    """Past stall the opening has no bound."""
    data = json.loads(encoded(case("hard").to_dict()))
    assert data["duty"]["cycles"][0]["worst"]["opening"]["value"] is None
    assert data["not_finite"]["duty.cycles[0].worst.opening.value"] == "unbounded"
    assert data["metrics"]["duty_opening"]["why"] == "the supply does not move the load"


def test_long_lists_of_places_are_cut_to_the_worst():
    """Dozens of parts fatigue; the worst are listed, and one row counts the others."""
    two = case("two")
    (table,) = limits.places(two)
    heads = [row.cells[0] for row in table.rows]
    ends = [k for k, head in enumerate(heads) if head] + [len(heads)]
    sizes = np.diff(ends)
    assert max(sizes) == limits.MOST_PLACES + 1
    counted = [row.cells for row in table.rows if row.cells[1].endswith(" more")]
    assert counted
    assert all(cells[4].startswith("from ") for cells in counted)
    first = heads.index("fatigue by the duty cycles of a life")
    worst = sorted(two.metrics["duty_fatigue"].by_place.values(), reverse=True)
    shown = [row.cells[3] for row in table.rows[first : first + limits.MOST_PLACES]]
    assert shown == [value_text(duty.DAMAGE, x) for x in worst[: limits.MOST_PLACES]]


def test_twenty_thousand_samples_stay_a_small_figure():
    """Every row is written; the figure keeps the extremes of short stretches."""
    long = evaluated(cycle("long", DENSE), linkage=False)
    ink = drawn(charts(long)[0])
    points = sum(len(line) for mark in ink.marks if "path" in mark for line in mark["path"])
    assert points < 40_000
    assert len(duty.series(long)[0].values) == 20_000 + POINTS
    assert len(json.dumps(long.duty.to_dict())) < 60_000


def test_json_has_limits_and_the_state_at_worst_samples():
    """What the figure shows, in SI."""
    data = case("walk").duty.to_dict()
    json.dumps(data)
    study = data["cycles"][0]
    assert data["opening_limit"] == 0.9
    assert data["linkage"]["closed_length"] == pytest.approx(case("walk").lengths["closed_length"])
    assert [(x["direction"], x["opening"]) for x in study["force_limits"]] == [
        ("extending", 0.9), ("retracting", 0.9), ("extending", 1.0), ("retracting", 1.0)
    ]  # fmt: skip
    state = study["worst"]["reserve"]["state"]
    assert state["joint_torque"] == pytest.approx(state["force"] * state["arm"])
    assert "joint_angle" not in case("still").duty.to_dict()["cycles"][0]["worst"]["flow"]["state"]


def test_csv_on_the_command_line(tmp_path):
    """With cycles the file is written; without, one line says what to do, and there is no file."""
    source, target = tmp_path / "flight.yaml", tmp_path / "x.csv"
    source.write_text(design(cycle("flight", FLIGHT), linkage=False))
    assert run("evaluate", source, "--csv", target, "-q").code in (0, 1)
    assert len(target.read_text().splitlines()) == 1 + 401 + POINTS
    target.unlink()
    result = run("evaluate", DESIGNS / "knee.yaml", "--csv", target, "-q")
    assert result.code == 2
    assert "states no duty cycles; add duty.cycles" in result.err
    assert not target.exists()
