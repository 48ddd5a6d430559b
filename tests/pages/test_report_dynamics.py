"""Stiffness budget, dynamics and position loop on paper: numbers, marks, and what is left out."""

from __future__ import annotations

import doctest
import math
import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import report_fixture as fixture
from test_through_wall import text_of

import actuator_opt as ao
from actuator_opt.pages import (
    dynamics as dynamics_page,
    dynamics_figures as bode,
    stiffness as stiffness_page,
)
from actuator_opt.pages.stiffness import PARTS, fills
from actuator_opt.rendering import paper, paper_plain as fallback, text
from actuator_opt.rendering.axes import AREAS, Axes
from actuator_opt.rendering.blocks import Chart
from actuator_opt.rendering.chart_ink import drawn
from actuator_opt.rendering.chart_layout import MARKS
from actuator_opt.rendering.ink import BLACK, BLUE, RED, Ink

SOURCE = {"source_text": "a: 1\n", "source_name": "a.yaml", "command": "x", "date": None}
LINES = """
lines:
  - chamber: a
    type: hose
    length: 0.3 m
    inner_diameter: 6 mm
    outer_diameter: 10 mm
    material: steel_42crmo4
  - chamber: b
    length: 0.3 m
    inner_diameter: 6 mm
    outer_diameter: 8 mm
    material: steel_42crmo4
"""
VALVE = """
valve:
  rated_flow: 10 l/min
  leakage_flow: 0.2 l/min
  natural_frequency: 120 Hz
ports:
  end: valve
"""
OF_THE_LOOP = """  bandwidth:
    min: 4 Hz
  gain_margin:
    min: 2.5
  phase_margin:
    min: 50 deg
"""
OF_THE_LOAD = """  damping_ratio:
    min: 0.01
  natural_frequency:
    min: 110 Hz
"""
WHERE_SHAKEN = """  dynamic_stiffness:
    min: 9 kN/mm
  dynamic_phase:
    max: 20 deg
"""


def written(*, shaken="", valve="", gain="", more="", change=()):
    """The knee with lines, a load case that shakes it, a valve, a gain, and limits on them."""
    limits = OF_THE_LOAD + (OF_THE_LOOP if valve else "") + (WHERE_SHAKEN if shaken else "")
    text = text_of("knee_bonded.yaml").replace("requirements:\n", f"requirements:\n{limits}")
    text = text.replace("    side_load: 30 N\n", f"    side_load: 30 N\n{shaken}")
    for old, new in change:
        assert old in text
        text = text.replace(old, new)
    return text + LINES + valve + gain + more


TEXTS = {
    "knee": text_of("knee_bonded.yaml"),
    "aerospace": text_of("aerospace.yaml"),
    "shaken": written(shaken="    frequency: 20 Hz\n"),
    "loop": written(
        shaken="    frequency: 8 Hz\n", valve=VALVE, gain="control:\n  gain: 300 V/m\n"
    ),
    "tuned": written(shaken="    frequency: 8 Hz\n", valve=VALVE),
    "swinging": written(valve=VALVE, gain="control:\n  gain: 5000 V/m\n"),
    "all parts": written(
        valve=VALVE,
        more="stiffness:\n  seals: sticking\n  load_cell: 300 kN/mm\n",
        change=(("  mount: cap_clevis\n", "  mount: cap_clevis\n  mount_stiffness: 80 kN/mm\n"),),
    ),
    "short": written(
        shaken="    frequency: 900 Hz\n",
        change=(
            ("stroke: 110 mm", "stroke: 1.5 mm"),
            ("mass: 20 kg", "mass: 0.05 kg"),
            (
                "material: epoxy_structural\n  length: 20 mm",
                "material: epoxy_structural\n  length: 8 mm",
            ),
        ),
    ),
    "damped": written(
        shaken="    frequency: 0.5 Hz\n",
        valve=VALVE.replace("leakage_flow: 0.2", "leakage_flow: 5"),
        change=(
            ("stroke: 110 mm", "stroke: 900 mm"),
            ("mass: 20 kg", "mass: 2000 kg"),
            ("stance", "a case with a name that is longer than any margin of the figure"),
        ),
    ),
}


@cache
def evaluated(name):
    """One of the designs above."""
    return ao.evaluate(ao.read(TEXTS[name]))


def blocks_of(evaluation):
    """Blocks of stiffness and dynamics by title."""
    found = paper.plain_blocks(
        stiffness_page.stiffness_blocks(evaluation) + dynamics_page.dynamics_blocks(evaluation)
    )
    return {block["title"]: block for block in found}


def ink_of(block):
    """The drawing of a block."""
    ink = Ink(block["ink"]["width"], block["ink"]["height"])
    ink.marks = block["ink"]["marks"]
    return ink


def stiffness_blocks(evaluation):
    """Figure and table of the stiffness as data for the template."""
    return paper.plain_blocks(stiffness_page.stiffness_blocks(evaluation))


def texts(ink):
    """Every text of a drawing."""
    return [mark["text"] for mark in ink.marks if "text" in mark]


def place_of(ink, words, anchor):
    """Where a tick's words stand; the first of them."""
    return next(m["at"] for m in ink.marks if m.get("text") == words and m.get("anchor") == anchor)


def log_x(ink, frequency, ends=("0.1", "1000")):
    """Where a frequency stands, from the axis' own labels."""
    left, right = (place_of(ink, end, "center")[0] for end in ends)
    return left + (right - left) * (math.log10(frequency) + 1) / 4


def level_y(ink, value, ends):
    """Where a value stands between two labelled levels of a vertical axis (words, value)."""
    (low, a), (high, b) = ((place_of(ink, words, "right")[1], at) for words, at in ends)
    return low + (high - low) * (value - a) / (b - a)


def circles(ink, stroke):
    """Centres of the circles of a colour."""
    found = []
    for mark in ink.marks:
        if "path" in mark and mark["closed"] and mark["stroke"] == stroke:
            points = np.array(mark["path"][0])
            if len(points) == 32:
                found.append(points.mean(axis=0))
    return found


def red(ink, dash=()):
    """Limits: lines in red without their hatching."""
    paths = [m for m in ink.marks if "path" in m and m["stroke"] == RED and m["pen"] > 0.2]
    return [m["path"][0] for m in paths if tuple(m["dash"]) == tuple(dash)]


def ink_of_panels(*panels):
    """A column of panels on its own paper."""
    return drawn(Chart("t", [panels], height=90.0))


# ---- what there is ----


def test_a_design_without_valve_and_shaken_case_gets_one_figure():
    """The shipped knee grows by the budget and one figure of dynamics."""
    assert list(blocks_of(evaluated("knee"))) == [
        "Stiffness over the stroke",
        "Stiffness budget",
        "Dynamics",
    ]


def test_a_shaken_design_has_no_loop():
    """Without a valve there is no loop; with one there is."""
    names = ["Dynamics along the stroke", "Dynamics: poles", "Dynamic stiffness"]
    assert list(blocks_of(evaluated("shaken")))[2:] == names
    assert list(blocks_of(evaluated("loop")))[2:] == [
        *names,
        "Position loop, open",
        "Position loop, closed",
        "Position loop: gain, margins, bandwidth",
    ]


def test_without_a_study_there_is_no_dynamics():
    """An evaluation without dynamics keeps its stiffness alone."""
    titles = [b["title"] for b in fixture.page_data(fixture.build_evaluation(), **SOURCE)["blocks"]]
    assert not any(title.startswith(("Dynamic", "Position loop")) for title in titles)
    assert "Stiffness budget" in titles


# ---- stiffness budget ----


def test_the_budget_adds_up_to_the_curve():
    """Printed shares are each part's compliance over the sum, at every place and the weakest."""
    curve = fixture.curve()
    table = stiffness_blocks(fixture.build_evaluation(curve=curve))[1]
    index = int(np.argmin(curve.stiffness))
    at = [0, 40, 80, 120, 160, index]
    total = sum(curve.contributions.values())
    for row, (name, compliance) in zip(table["rows"], curve.contributions.items(), strict=False):
        assert row[0] == name
        assert row[1:7] == [f"{100 * compliance[k] / total[k]:.1f} %" for k in at]
        assert float(row[7]) == pytest.approx(1e-6 / compliance[index], rel=6e-4)
    last = table["rows"][-1]
    assert last[0] == "stiffness, kN/mm"
    assert [float(k) for k in last[1:7]] == pytest.approx(
        [curve.stiffness[k] / 1e6 for k in at], rel=6e-4
    )


def test_the_budget_shows_the_metric():
    """The printed stiffness at the weakest position is the metric, to the digits shown."""
    for name in ("knee", "aerospace", "all parts"):
        evaluation = evaluated(name)
        value = evaluation.metrics["stiffness_min"].value / 1e6
        shown = float(blocks_of(evaluation)["Stiffness budget"]["rows"][-1][6])
        assert shown == pytest.approx(value, rel=1e-3)


def test_the_part_that_buys_most_is_named_with_what_it_buys():
    """Halving the largest compliance gives the gain the sentence states, by adding up anew."""
    curve = fixture.curve()
    index = int(np.argmin(curve.stiffness))
    parts = {name: c[index] for name, c in curve.contributions.items()}
    name = max(parts, key=parts.get)
    halved = sum(parts.values()) - parts[name] / 2
    gain = sum(parts.values()) / halved - 1
    said = stiffness_page.gain_sentence(curve)
    assert f"{name} matters most" in said
    assert f"the actuator would be {100 * gain:.0f} % stiffer" in said


def test_ports_case_and_a_published_topology_are_named():
    """The figure says ports closed and its case; another topology than ours is named as such."""
    evaluation = fixture.build_evaluation()
    note = stiffness_blocks(evaluation)[0]["note"]
    assert note.startswith('Load case "stance", ports closed. Computed per chamber')
    stiffness = evaluation.design.stiffness
    for topology, words in (
        ("aalto_as_published", "As published in [AaltoThesis], not per chamber"),
        ("elasswad_as_published", "As published in [ElAsswad2018], not per chamber"),
    ):
        design = evaluation.design.model_copy(
            update={"stiffness": stiffness.model_copy(update={"topology": topology})}
        )
        note = stiffness_blocks(replace(evaluation, design=design))[0]["note"]
        assert words in note


def test_every_part_has_its_own_fill():
    """Eleven parts are told apart, each always by the same fill; others take what is free."""
    assert len(set(AREAS)) == len(AREAS) == len(PARTS) == 11
    assert fills(["oil A", "rod"]) == [0, 8]
    assert len(set(fills(["oil A", "swelling", "rod", "other"]))) == 4
    ink = ink_of(blocks_of(evaluated("all parts"))["Stiffness over the stroke"])
    drawn = {m["fill"] for m in ink.marks if "path" in m and m["closed"]}
    assert set(AREAS) <= drawn


def test_a_flat_or_single_curve_has_no_budget():
    """One part, or one position, is nothing to divide."""
    curve = fixture.curve()
    single = replace(curve, contributions={"oil": curve.contributions["oil"]})
    assert len(stiffness_blocks(fixture.build_evaluation(curve=single))) == 1
    short = replace(
        curve,
        position=curve.position[:1],
        stiffness=curve.stiffness[:1],
        contributions={k: v[:1] for k, v in curve.contributions.items()},
    )
    assert len(stiffness_blocks(fixture.build_evaluation(curve=short))) == 1
    assert stiffness_page.summary(short) == ""


# ---- along the stroke ----


def test_modes_carry_the_metrics_and_the_limits():
    """The lowest natural frequency is the metric; both requirements stand beside their frames."""
    evaluation = evaluated("loop")
    ink = ink_of(blocks_of(evaluation)["Dynamics along the stroke"])
    value = evaluation.metrics["natural_frequency"].value
    assert any(t.startswith(f"minimum {value:.1f} at") for t in texts(ink))
    assert {"≥ 110", "≥ 0.01"} <= set(texts(ink))
    assert "oil lines end at: valve" in texts(ink)


def test_damping_adds_up_from_its_causes():
    """Friction and leakage make the whole; without a leak and lines friction is all of it."""
    for name in ("knee", "loop", "short"):
        study = evaluated(name).dynamics
        place = int(np.argmin(study.closed_frequency))
        whole = study.friction_share + study.conductance_share
        assert whole == pytest.approx(float(study.damping_ratio[place]), rel=1e-6)
    study = evaluated("knee").dynamics
    assert study.conductance_share == 0.0
    note = blocks_of(evaluated("knee"))["Dynamics"]["note"]
    assert "leakage and hydraulic lines give next to nothing" in note


def test_friction_share_is_the_closed_form():
    """Held by closed ports, zeta = B (1 - f k)^2/(2 sqrt(k m)): rod and mount keep f k back."""
    evaluation = evaluated("knee")
    study = evaluation.dynamics
    subject = ao.evaluation.prepare(evaluation.design)
    from actuator_opt.evaluation.kernel import compute

    motion = compute(subject, subject.values()).motion
    index = [case.name for case in evaluation.design.load_cases].index(study.case)
    k = evaluation.metrics["stiffness_min"].value
    b = float(np.broadcast_to(motion.damping, (2, 1))[index, 0])
    f = float(np.squeeze(motion.springs.series_compliance()))
    expected = b * (1 - f * k) ** 2 / (2 * math.sqrt(k * study.mass))
    assert study.friction_share == pytest.approx(expected, rel=1e-4)


# ---- dynamic stiffness ----


def test_no_resonance_falls_between_the_points():
    """At the weakest position the dip reaches 2 zeta k, however light the damping."""
    study = evaluated("knee").dynamics
    response = study.responses[1]
    zeta = study.friction_share
    assert response.magnitude.min() == pytest.approx(2 * zeta * response.static, rel=0.02)
    assert study.frequencies[0] == 0.1
    assert study.frequencies[-1] == 1000.0
    assert np.all(np.diff(study.frequencies) > 0)


def test_shaken_cases_stand_at_their_frequency_and_value():
    """Circle and limit lie where the axes' own labels put 8 Hz, the result and the limit."""
    evaluation = evaluated("loop")
    ink = ink_of(blocks_of(evaluation)["Dynamic stiffness"])
    x = log_x(ink, 8.0)
    ends = (("1", 0.0), ("100", 2.0))
    result = evaluation.metrics["dynamic_stiffness"].value / 1e6
    found = circles(ink, BLACK)[1:]  # the first is in the legend
    assert found[0] == pytest.approx([x, level_y(ink, math.log10(result), ends)], abs=0.02)
    (shaken,) = evaluation.dynamics.shaken
    assert shaken.stiffness / 1e6 == result  # its phase is that of the same place, not the largest
    assert shaken.phase <= evaluation.metrics["dynamic_phase"].value
    phase = math.degrees(shaken.phase)
    assert found[1] == pytest.approx(
        [x, level_y(ink, phase, (("0", 0.0), ("180", 180.0)))], abs=0.02
    )
    limits = [(np.mean([p[0] for p in line]), line[0][1]) for line in red(ink)]
    assert limits[0] == pytest.approx((x, level_y(ink, math.log10(9.0), ends)), abs=0.02)
    assert limits[1] == pytest.approx(
        (x, level_y(ink, 20.0, (("0", 0.0), ("180", 180.0)))), abs=0.02
    )
    assert {"≥ 9 kN/mm", "≤ 20°", "a"} <= set(texts(ink))
    assert any(t.startswith("a: ") and f"{result:#.4g} kN/mm" in t for t in texts(ink))


def test_the_result_lies_on_a_drawn_curve():
    """Curves are those of the load case with the least dynamic stiffness: its mark is on one."""
    evaluation = evaluated("loop")
    study, metric = evaluation.dynamics, evaluation.metrics["dynamic_stiffness"]
    assert study.response_case == metric.case
    shown = [
        float(np.interp(math.log(8.0), np.log(study.frequencies), np.log(one.magnitude)))
        for one in study.responses
    ]
    assert min(abs(math.log(metric.value) - one) for one in shown) < 0.01


def test_curves_begin_at_the_static_stiffness():
    """With ports closed a slow load meets the static stiffness; its level is printed."""
    evaluation = evaluated("shaken")
    study = evaluation.dynamics
    words = texts(ink_of(blocks_of(evaluation)["Dynamic stiffness"]))
    for one in study.responses:
        assert one.magnitude[0] == pytest.approx(one.static, rel=1e-4)
        assert any(t.endswith(f": static {one.static / 1e6:.4g}") for t in words)


def test_poles_are_listed_with_the_load_named():
    """The pole at the load's natural frequency is named; fast ones are counted."""
    evaluation = evaluated("loop")
    table = blocks_of(evaluation)["Dynamics: poles"]
    named = [row for row in table["rows"] if "the load" in row[2]]
    lowest = evaluation.metrics["natural_frequency"].value
    assert [float(row[0]) for row in named] == pytest.approx([lowest], rel=2e-3)
    fast = sum(pole.frequency > 1e4 for pole in evaluation.dynamics.poles)
    assert f"{fast} pole lies above 10 kHz" in table["note"]
    assert len(table["rows"]) == len(evaluation.dynamics.poles) - fast
    assert not any(
        "the load" in row[2] for row in blocks_of(evaluated("damped"))["Dynamics: poles"]["rows"]
    )


# ---- loop ----


def test_margins_are_drawn_from_their_line_to_the_curve():
    """Lines span the gain margin at the ultimate frequency and the phase margin at crossover."""
    evaluation = evaluated("loop")
    study = evaluation.dynamics
    ink = ink_of(blocks_of(evaluation)["Position loop, open"])
    first = study.position_loop
    decibels = 20 * math.log10(evaluation.metrics["gain_margin"].value)
    gain_ends = (("0", 0.0), ("−40", -40.0))
    found = circles(ink, BLACK)
    x = log_x(ink, first.ultimate_frequency)
    assert found[0] == pytest.approx([x, level_y(ink, -decibels, gain_ends)], abs=0.03)
    loops = (first, *study.other_loops)
    least = min(loops, key=lambda one: one.phase_margin)
    assert least.phase_margin == evaluation.metrics["phase_margin"].value
    phase_ends = (("−180", -180.0), ("−450", -450.0))
    y = level_y(ink, -180.0, phase_ends)
    step = level_y(ink, -181.0, phase_ends) - y
    found = found[1]
    assert found[0] == pytest.approx(log_x(ink, least.crossover), abs=0.03)
    assert abs(found[1] - y) / step == pytest.approx(math.degrees(least.phase_margin), rel=0.03)
    limits = [(np.mean([p[0] for p in line]), line[0][1]) for line in red(ink)]
    wanted = level_y(ink, -20 * math.log10(2.5), gain_ends)
    assert limits[0] == pytest.approx((x, wanted), abs=0.03)
    assert abs(limits[1][1] - y) / step == pytest.approx(50.0, abs=0.2)


def test_bandwidth_and_its_limit_stand_on_the_closed_loop():
    """The least bandwidth is a circle at -3 dB; the limit is an upright line at 4 Hz."""
    evaluation = evaluated("loop")
    ink = ink_of(blocks_of(evaluation)["Position loop, closed"])
    value = evaluation.metrics["bandwidth"].value
    ends = (("0", 0.0), ("−40", -40.0))
    level = level_y(ink, 10 * math.log10(0.5), ends)
    found = [c for edge, _ in MARKS for c in circles(ink, edge)]
    nearest = min(found, key=lambda c: abs(c[0] - log_x(ink, value)))
    assert nearest == pytest.approx([log_x(ink, value), level], abs=0.03)
    (limit,) = red(ink, dash=(1.8, 1.0))
    assert [x for x, _ in limit] == pytest.approx([log_x(ink, 4.0)] * 2, abs=0.03)
    assert "≥ 4 Hz" in texts(ink)
    assert f"bandwidth {value:#.4g} Hz" in texts(ink)


def test_the_loop_is_told_where_each_figure_is_least():
    """Gain margin, phase margin and bandwidth each have their curve; the table names the places."""
    evaluation = evaluated("loop")
    study = evaluation.dynamics
    rows = blocks_of(evaluation)["Position loop: gain, margins, bandwidth"]["rows"]
    loops = {(one.case, one.place): one for one in (study.position_loop, *study.other_loops)}
    for row, name in zip(rows[2:], ("gain_margin", "phase_margin", "bandwidth"), strict=True):
        metric = evaluation.metrics[name]
        assert getattr(loops[metric.case, metric.place], name) == pytest.approx(metric.value)
        assert "".join(row[4]) == f"{metric.case}, {metric.place}"
        shown = float(re.match(r"[\d.]+", row[1])[0])
        assert shown == pytest.approx(metric.quantity.to_display(metric.value), rel=1e-3)
        assert row[3].startswith("≥")
    assert rows[0][2] == "as stated in control.gain"


def test_a_tuned_gain_says_its_rule():
    """Without a stated gain half the ultimate gain is used, and the table says whose rule it is."""
    evaluation = evaluated("tuned")
    rows = blocks_of(evaluation)["Position loop: gain, margins, bandwidth"]["rows"]
    assert "half the ultimate gain" in rows[0][2]
    gain, ultimate = (float(rows[k][1].split()[0]) for k in (0, 1))
    assert gain == pytest.approx(ultimate / 2, rel=1e-3)
    assert evaluation.dynamics.position_loop.gain_margin == pytest.approx(2.0)


def test_a_swinging_loop_is_no_response():
    """Beyond the ultimate gain both figures say so."""
    found = blocks_of(evaluated("swinging"))
    assert "The closed loop is unstable." in texts(ink_of(found["Position loop, open"]))
    closed = texts(ink_of(found["Position loop, closed"]))
    assert any(
        t.startswith("The closed loop is unstable, so these curves are not its response.")
        for t in closed
    )


def test_open_loop_of_an_integrator_and_its_drawing():
    """A loop of K/s with K = 2 pi 10: 0 dB at 10 Hz, drawn there, with no ultimate gain."""
    study = evaluated("loop").dynamics
    s = 1j * study.frequencies / 10.0
    one = replace(
        study.position_loop,
        gain_margin=math.inf,
        phase_margin=math.pi / 2,
        ultimate_gain=math.inf,
        ultimate_frequency=math.nan,
        crossover=10.0,
        bandwidth=10.0,
        open_magnitude=np.abs(1 / s),
        open_phase=np.full(len(s), -math.pi / 2),
        closed_magnitude=np.abs(1 / (1 + s)),
    )
    ink = ink_of_panels(*bode.open_panels(study, [one], bode.LoopLimits()))
    assert "The loop is stable at any gain." in texts(ink)
    blue = (m["path"][0] for m in ink.marks if m.get("stroke") == BLUE)
    curve = next(line for line in blue if len(line) > 2)
    zero = level_y(ink, 0.0, (("0", 0.0), ("−40", -40.0)))
    at = float(np.interp(-zero, [-p[1] for p in curve[::-1]], [p[0] for p in curve[::-1]]))
    assert at == pytest.approx(log_x(ink, 10.0), abs=0.05)
    closed = ink_of_panels(bode.closed_panel(study, [one], bode.LoopLimits()))
    marks = circles(closed, BLUE)
    assert marks[0][0] == pytest.approx(log_x(closed, 10.0), abs=0.03)


# ---- on paper and in the terminal ----


@pytest.mark.parametrize("name", TEXTS)
def test_nothing_written_collides(name):
    """In every figure no two texts overlap, all stay on the paper, and so does every line."""
    for block in blocks_of(evaluated(name)).values():
        if block["kind"] != "figure":
            continue
        ink = ink_of(block)
        boxes = ink.text_boxes()
        for k, (one, left, top, right, bottom) in enumerate(boxes):
            assert min(left, ink.width - right) > -0.5, one
            assert min(top, ink.height - bottom) > -0.5, one
            for other, a, b, c, d in boxes[k + 1 :]:
                assert right <= a or c <= left or bottom <= b or d <= top, (one, other)
        points = [p for mark in ink.marks if "path" in mark for line in mark["path"] for p in line]
        assert all(-0.01 <= x <= ink.width + 0.01 for x, _ in points)
        assert all(-0.01 <= y <= ink.height + 0.01 for _, y in points)


def test_a_needle_is_cut_at_both_edges():
    """A curve that leaves the frame through its foot is cut there, and comes back there."""
    axes = Axes(Ink(20.0, 20.0), (0.0, 0.0, 10.0, 10.0), (0.0, 4.0), (0.0, 1.0))
    lines = axes.clipped([0, 1, 2, 3, 4], [0.5, 0.5, -0.5, 0.5, 1.5])
    assert lines == [
        [(0.0, 5.0), (2.5, 5.0), (3.75, 10.0)],
        [(6.25, 10.0), (7.5, 5.0), (8.75, 0.0)],
    ]
    assert axes.clipped([0, 4], [-1.0, 3.0]) == [[(2.5, 10.0), (5.0, 0.0)]]


@pytest.mark.long
def test_equal_designs_give_equal_files(tmp_path):
    """The report of a design with a loop has the same bytes again; the plain one can draw it."""
    given = {"stem": "r", "source_text": "a: 1\n", "source_name": "a.yaml", "command": "c"}
    first = fixture.write_report(evaluated("loop"), folder=tmp_path / "1", **given)
    again = ao.evaluate(ao.read(TEXTS["loop"]))
    second = fixture.write_report(again, folder=tmp_path / "2", **given)
    assert [f.sha256 for f in first] == [f.sha256 for f in second]
    data = fixture.page_data(again, **SOURCE) | {
        "source_file": "a.yaml",
        "source": "a: 1\n",
        "run": "{}",
    }
    data["blocks"] = [block for block in data["blocks"] if block["kind"] == "figure"]
    assert len(data["blocks"]) >= 2
    assert fallback.render(data, 0)[1]


def test_terminal_keeps_places_and_groups_reasons():
    """At 110 columns the places of the loop are whole; one reason stands once."""
    shown = fixture.shown(evaluated("loop"), width=110)
    line = next(x for x in shown.splitlines() if x.startswith("bandwidth"))
    assert re.search(r"swing, retract, 100 %$", line)
    assert "…" not in next(x for x in shown.splitlines() if x.startswith("phase_margin"))
    knee = fixture.shown(evaluated("knee"), width=100)
    assert knee.count("no valve stated: add valve") == 2  # once for all metrics, and at the check
    assert "compliance there: oil A 42" in knee
    assert fixture.shown(evaluated("loop"), unicode=False, width=100).isascii()


@pytest.mark.parametrize("module", [bode, dynamics_page, text, stiffness_page])
def test_examples_in_docstrings(module):
    """The worked examples hold."""
    assert doctest.testmod(module).failed == 0
