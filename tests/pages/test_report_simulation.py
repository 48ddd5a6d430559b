"""Pages of Simulations: their numbers, figures, words and bytes; the terminal; the CSV."""

from __future__ import annotations

import doctest
import importlib.util
import itertools
import json
import math
import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import simulation_report_case as case
from simulation_report_case import boxes_collide
from test_report_identification import agrees, printed

from actuator_opt.base.errors import InputError
from actuator_opt.design.scenario.model import Scenario
from actuator_opt.pages import (
    read_attachment,
    simulation as subject,
    simulation_comparison as comparing,
    simulation_comparison as pair_figures,
    simulation_energy,
    simulation_figures as figures,
)
from actuator_opt.rendering import axes, paper, series, terminal
from actuator_opt.rendering.blocks import Chart, Column, Origin, Pair, Status, Table
from actuator_opt.rendering.chart import Axis, Curve, Panel
from actuator_opt.rendering.chart_ink import drawn
from actuator_opt.simulation.basis import Basis
from actuator_opt.simulation.integrate import Event
from actuator_opt.simulation.result import EnergyFlow, RequirementResult, Second

ORIGIN = Origin(case.SOURCE, "a.yaml", "simulate a.yaml", "12ab")
ABSURD = f"{'a' * 70} {'many words without an end ' * 8}".strip()
SHOWN = {"%": 100.0, "ms": 1e3, "bar": 1e-5, "mm/s": 1e3, "kN/mm": 1e-6, "J": 1.0, "m/s": 1.0,
         "mm": 1e3, "°": 180 / math.pi}  # fmt: skip
"""Shown over SI, by hand."""


USUAL = ("step", "open", "pump line", "closed", "motor", "bench")
"""Kinds of runs that between them have every signal, figure and table."""
EACH = [x if x in USUAL else pytest.param(x, marks=pytest.mark.long) for x in case.KINDS]


def paged(kind, **more):
    """The page of a kind of run."""
    return subject.page(case.simulated(kind), **more)


def tables(page):
    """Every table of a page by its title."""
    found = {}
    for block in page.blocks:
        sides = block.sides if isinstance(block, Pair) else [[block]]
        found |= {one.title: one for side in sides for one in side if isinstance(one, Table)}
    return found


def words_of(page):
    """All words of a page on paper, blanks made one."""
    found = []

    def walk(one):
        if isinstance(one, str):
            found.append(one)
        elif isinstance(one, dict):
            for value in one.values():
                walk(value)
        elif isinstance(one, list):
            if one and all(isinstance(value, str) for value in one):
                found.append("".join(one))
            for value in one:
                walk(value)

    data = paper.plain(page, ORIGIN)
    json.dumps(data, allow_nan=False)
    walk(data)
    return re.sub(r"\s+", " ", " ".join(found))


def written(page, folder, **run):
    """The files of a page."""
    return paper.write(page, ORIGIN, folder=folder, stem="s", **run)


def compared(runs, title="tuning", notes=(), columns=()):
    """The page of several runs."""
    return comparing.page(comparing.comparison(runs, title, notes, columns))


def shown(page, width=100, unicode=True, colour=False):
    """A page on the terminal."""
    return terminal.text(page, colour=colour, unicode=unicode, width=width)


def panels(kind, static=None):
    """Every panel of a kind of run on its own paper, and its signals over time."""
    run = case.simulated(kind)
    strips = [strip.panel for strip in figures.strips(run, {})]
    made = {"signals": drawn(Chart("t", [strips], height=20.0 * len(strips) + 8.0), width=120.0)}
    for part in figures.parts(run, {}, static):
        height = max(60.0 * len(part.panels), part.least)
        made[part.name] = drawn(Chart("t", [part.panels], height=height), width=90.0)
    return made


@cache
def alone(kind):
    """The same without a static stiffness, for all tests that read it."""
    return panels(kind)


def titles(kind):
    """Titles of the strips of a kind of run."""
    strips = figures.strips(case.simulated(kind), {})
    return [strip.panel.title.partition(",")[0] for strip in strips]


# ---- numbers ----


@pytest.mark.parametrize("kind", EACH)
def test_results_are_those_of_the_json(kind):
    """Value, unit, limit and margin of every result that has a value or a limit."""
    found = case.simulated(kind).to_dict()
    table = tables(paged(kind)).get("Results")
    body = [] if table is None else [row.cells for row in table.rows]
    limits = {row["metric"]: row for row in found["requirements"]}
    wanted = [
        name for name, one in found["results"].items() if one["value"] is not None or name in limits
    ]
    assert [row[0] for row in body] == [subject.label(name) for name in wanted]
    for name, row in zip(wanted, body, strict=True):
        value, _, unit = row[1].replace("°", " °").rpartition(" ")
        si = found["results"][name]["value"]
        if abs(si) >= subject.ZERO_BELOW.get(name, 0.0):
            assert agrees(value, si * SHOWN[unit]), (name, row[1])
        else:
            assert value == "0"
        if name in limits:
            assert row[5].state == ("met" if limits[name]["met"] else "missed")
            assert agrees(row[2][2:], limits[name]["limit"] * SHOWN[unit])
        elif len(row) > 3:
            assert row[2:6] == ["", "", "", ""]


def test_margins_are_relative_to_their_limits():
    """Settling at 40 ms against 20 ms misses by 100 %, in table and tile."""
    found = case.simulated("step")
    row = next(one for one in found.requirements if one.metric == "settling_time")
    changed = replace(row, value=0.04, margin=-1.0)
    rows = tuple(changed if one is row else one for one in found.requirements)
    values = dict(found.values) | {"settling_time": 0.04}
    page = subject.page(replace(found, requirements=rows, values=values))
    table = tables(page)["Results"]
    cells = next(row.cells for row in table.rows if row.cells[0] == "settling time")
    assert cells[1:4] == ["40.00 ms", "≤ 20 ms", "−100.0 %"]
    tile = next(one for one in page.tiles if one.label == "settling time")
    assert (tile.state, tile.note) == ("missed", "≤ 20 ms")
    assert page.verdict.text == "REQUIREMENTS MISSED"


def test_the_controller_is_that_of_the_json():
    """Gain, times, ultimate point and both margins in their units; factors of the scenario too."""
    for _, run in case.tuned():
        told = run.to_dict()["controller"]
        shown = dict(subject.controller(run))
        factor = run.scenario.control.gain_factor
        assert agrees(shown["gain K"], told["proportional_gain"])
        assert ("×" in shown["gain K"]) == (factor != 1)
        assert agrees(shown["ultimate gain"], told["ultimate_gain"])
        assert agrees(shown["ultimate period"], 1e3 * told["ultimate_period"])
        assert agrees(shown["gain margin"], told["gain_margin"])
        decibel = printed(shown["gain margin"].partition(", ")[2])[0]
        assert decibel == pytest.approx(20 * math.log10(told["gain_margin"]), abs=0.06)
        if not run.tuned.margins.stable:
            assert shown["linear loop"] == "unstable"
            assert "phase margin" not in shown
        else:
            assert agrees(shown["phase margin"], math.degrees(told["phase_margin"]))
        for words in ("integral time", "derivative time"):
            name = words.replace(" ", "_")
            if told[name]:
                assert agrees(shown[words], 1e3 * told[name])
            else:
                assert words not in shown


def test_the_valves_bench_tells_its_flows():
    """Largest flows and what leaks at no signal, as the square root law of the edges has them."""
    found = case.simulated("bench", **{"supply.pressure": "70 bar"})
    tiles = {tile.label: tile for tile in subject.tiles(found)}
    # 10 l/min at 35 bar an edge: 35 bar into A, 30 bar out of B; 0.2 l/min at 50 bar leak
    into, leaked = 10.0, 0.2 * math.sqrt(30 / 50)
    wanted = into - leaked
    assert printed(tiles["largest flow into A"].value)[0] == pytest.approx(wanted, rel=2e-3)
    idle = 2 * 0.2 * math.sqrt(35 / 50)
    assert printed(tiles["flow, valve centred"].value)[0] == pytest.approx(idle, rel=2e-3)


def test_expected_reasons_are_left_out():
    """A step against no stop under a constant load says only why the efficiency is missing."""
    found = replace(case.simulated("step"), requirements=())
    assert {"stop_speed", "dynamic_stiffness", "following_error"} <= found.why.keys()
    assert set(subject.reasons(found)) <= {found.why["efficiency"]}


# ---- energy ----

LEAKED = "leakage across the piston"


@pytest.mark.parametrize("kind", EACH)
def test_shares_add_up(kind):
    """What came in less what went out is what the balance does not close, small ones included."""
    found = case.simulated(kind)
    shares = simulation_energy.shares(found)
    total = sum(one.energy for one in shares if one.energy > 0)
    doors = sum(one.energy for one in found.balance.flows)
    kept = sum(one.energy for one in found.balance.stored)
    assert sum(one.energy for one in shares) == pytest.approx(doors - kept, abs=1e-9 * total)
    assert len(shares) <= simulation_energy.MOST_ROWS
    names = [one.name for one in shares]
    assert len(set(names)) == len(names)
    if any(one.name == "supply" for one in found.balance.flows):
        assert names[0] == "supply"


VALVE = {"supply", "valve edges", "return line"}
ROD = {"load", "friction of the seals"}
TOLD = {
    **dict.fromkeys(("step", "down", "sine", "speed", "open"), VALVE | ROD | {LEAKED}),
    **dict.fromkeys(("pump", "pump line"), VALVE | ROD | {LEAKED, "relief valve"}),
    "line": VALVE | ROD | {LEAKED},
    **dict.fromkeys(("closed", "stroke"), ROD),
    "motor": VALVE | {"load", "losses of the motor"},
    "bench": VALVE,
}
"""Doors of each kind whose power the signals tell."""
UNTOLD = {"stroke": {"load"}}
"""Doors through which more goes than the signals tell: the machine outside moves the rod."""


@pytest.mark.parametrize("kind", EACH)
def test_energies_over_time_end_at_their_doors(kind):
    """Every power that the signals tell comes to its door; the curves that are left are these."""
    found = case.simulated(kind)
    doors = {one.name: one.energy for one in found.balance.flows}
    throughput = max(sum(abs(e) for e in doors.values() if (e > 0) == way) for way in (True, False))
    summed, off = simulation_energy._summed(found)
    assert set(summed) == set(off) == TOLD[kind]
    for name, curve in summed.items():
        way = 1 if name == "supply" else -1
        ends = pytest.approx(way * doors[name], abs=1e-3 * throughput)
        assert curve[0] == 0
        assert (curve[-1] == ends) == (name not in UNTOLD.get(kind, ())), name
    shown = simulation_energy.over_time(found)
    assert shown
    assert set(shown) <= TOLD[kind] - UNTOLD.get(kind, set())
    assert ("supply" in shown) == ("supply" in doors)
    assert simulation_energy.doubts(found) == []


def test_energies_that_powers_do_not_confirm_are_doubted():
    """A supply that tells twice its work is named, its curve left out, and the badge doubts."""
    found = case.simulated("step")
    assert simulation_energy.doubts(found) == []
    flows = tuple(
        EnergyFlow(one.name, 2 * one.energy if one.name == "supply" else one.energy)
        for one in found.balance.flows
    )
    wrong = replace(found, requirements=(), balance=replace(found.balance, flows=flows))
    assert "supply by −" in simulation_energy.doubts(wrong)[0]
    assert "supply" not in simulation_energy.over_time(wrong)
    page = subject.page(wrong)
    assert page.verdict.text == "SIMULATED, IN DOUBT"
    assert "Energies summed from the sampled powers differ" in words_of(page)


# ---- words ----


@pytest.mark.parametrize("kind", EACH)
def test_no_words_are_lost_and_none_are_nan(kind):
    """Notes, remarks, events and the scenario's own words stand on page and terminal alike."""
    found = case.simulated(kind)
    notes = ("measured at 20 degC", "made up")
    own = found.scenario.model_copy(update={"notes": "a scenario of\nmine"})
    found = replace(
        found, scenario=own, notes=(*found.notes, "something acted"),
        events=(Event("stop at the cap end", 0.25, True),),
    )  # fmt: skip
    page = subject.page(found, notes=notes)
    printed_words = words_of(page).replace("\N{NO-BREAK SPACE}", " ")
    said = re.sub(r"\s+", " ", shown(page, width=400))
    assert not re.search(r"\b(nan|inf|None)\b", printed_words + said)
    for words in ("Something acted.", "A scenario of mine.", "stop at the cap end on at 0.2500 s"):
        assert words in printed_words, words
        assert words in said, words
    assert "Measured at 20 °C." in printed_words


def test_scenarios_are_told_in_words():
    """Start, steps, load and supply of a servo; parts beyond three are counted."""
    said = subject.description(case.simulated("step"))
    assert "Position from 55 mm: step of 20 mm at 0.1 s, step of −30 mm at 0.6 s." in said
    assert "constant supply 210 bar, return 5 bar, LuGre friction, 1 s." in said
    assert "Load: 2000 N." in said
    bench = subject.description(case.simulated("bench"))
    assert "the valve alone, with its ports at 35 bar and 35 bar" in bench
    assert "Valve signal: −10 V, ramp of 20 V from 0 to 2 s." in bench
    found = case.simulated("open")
    pulse = found.scenario.signal[0]
    many = found.scenario.model_copy(update={"signal": (pulse,) * 7})
    assert subject.description(replace(found, scenario=many)).endswith("and 4 more.")
    assert "ports closed" in subject.description(case.simulated("closed"))


def test_blocked_ports_and_a_load_cylinder_are_told():
    """Ports shut at the cylinder by their name; of a load cylinder bore, rod and signal."""
    found = case.simulated("closed")
    signal = [{"shape": "sine", "value": 2.0, "frequency": 5.0}]
    cylinder = {
        "bore": 0.063,
        "rod_diameter": 0.036,
        "stroke": 0.3,
        "supply_pressure": 160e5,
        "valve": {"rated_flow": 2.5e-4, "natural_frequency": 100.0},
        "signal": signal,
    }
    stated = {"name": "rig", "design": "x.yaml", "duration": 1.0, "ends": "blocked"}
    for own, words in (
        (cylinder, "Load cylinder of bore 63 mm and rod 36 mm, valve signal: sine of 2 V at 5 Hz."),
        (cylinder | {"signal": []}, "and rod 36 mm, no signal at its valve."),
    ):
        scenario = Scenario.model_validate(stated | {"load": {"cylinder": own}})
        said = subject.description(replace(found, scenario=scenario))
        assert "ports blocked" in said
        assert words in said


def test_trust_tells_the_second_integrator():
    """Largest difference with its signal and time; a large one is a doubt; none is said."""
    found = replace(case.simulated("step"), requirements=())
    assert "Radau on the same equations" in subject.second_words(found)
    apart = Second("radau", 0.2, "position", 0.3, {"position": 0.2})
    assert (
        "by at most 0.2 of their range; the difference is largest for position of the piston at "
        "0.3000 s"
    ) in subject.second_words(replace(found, second=apart))
    assert subject.verdict(replace(found, second=apart)).state == "checks"
    assert "Not compared" in subject.second_words(replace(found, second=None))


def test_a_limit_without_reserve_is_no_green_verdict():
    """Of a requirement met with a margin of 0 % badge and row say so."""
    found = replace(case.simulated("step"), second=None)
    assert subject.sound(found)
    row = RequirementResult("overshoot", "max", 0.2, 0.2, 0.0, True)
    for margin, state, words in (
        (0.0, "checks", "REQUIREMENTS MET, 1 LIMIT WITHOUT RESERVE"),
        (0.1, "met", "REQUIREMENTS MET"),
    ):
        tight = replace(found, requirements=(replace(row, margin=margin),))
        badge = subject.verdict(tight)
        assert (badge.state, badge.text) == (state, words)
        assert tight.requirements[0].state == {"checks": "no_reserve"}.get(state, state)


def test_many_events_are_counted():
    """Four are told, the others counted."""
    events = tuple(Event("stop at the rod end", 0.1 * k, k % 2 == 0) for k in range(9))
    said = subject.event_words(replace(case.simulated("open"), events=events))
    assert said.startswith("9 events: stop at the rod end on at 0 s, ")
    assert said.endswith("and 5 more.")


# ---- figures ----


@pytest.mark.parametrize("height", [figures.LEAST, figures.MOST])
@pytest.mark.parametrize("kind", EACH)
def test_nothing_written_collides(kind, height):
    """No two texts overlap, all stay on the paper, and so does every line."""
    found = case.simulated(kind)
    name = figures.followed(found) or "signal"
    measured = {name: (found.time, 1.1 * found.signals[name])}
    place = np.array([0.0, 0.2])
    ink = figures.simulation_figure(found, height, measured=measured, static=(place, 1e7 + place))
    assert boxes_collide(ink) == []
    assert ink.height == height


@pytest.mark.parametrize("kind", EACH)
def test_figures_stand_alone(kind):
    """Every panel fits its own paper too; the signals hold all strips."""
    made = alone(kind)
    for name, ink in made.items():
        assert boxes_collide(ink) == [], name
    words = [mark["text"] for mark in made["signals"].marks if "text" in mark]
    for title in titles(kind):
        assert any(one.startswith(title) for one in words), title


def test_panels_follow_the_signals():
    """What a run has decides what is drawn of it."""
    names = {kind: set(alone(kind)) for kind in ("step", "closed", "bench", "motor")}
    assert {"step", "energy", "energy_time", "friction"} <= names["step"]
    assert {"stiffness", "cycles"} <= names["closed"]
    assert "step" not in names["closed"]
    assert "flows" in names["bench"]
    assert "friction" not in names["motor"]
    assert titles("step")[:2] == ["Position", "Error"]
    assert titles("motor")[:2] == ["Shaft speed", "Error"]
    assert {"Torques", "Shaft angle", "Pressures"} <= set(titles("motor"))
    assert titles("bench") == ["Valve signal", "Flows into the ports", "Flows of the line"]
    assert "Stops and cushions" in titles("open")
    assert "Stops and cushions" not in titles("sine")
    assert {"Supply", "Flows of the pump"} <= set(titles("pump"))
    assert titles("speed")[0] == "Speed"
    assert "Position" in titles("speed")


def ticks_beside(ink, anchor, inside):
    """Places and values of the numbers that stand where `inside` says."""
    found = []
    for mark in ink.marks:
        here = mark.get("anchor") == anchor and inside(*mark["at"])
        if here and re.fullmatch(r"\N{MINUS SIGN}?[\d.]+", mark["text"]):
            found.append((mark["at"], printed(mark["text"])[0]))
    return found


def test_the_step_stands_where_the_ticks_say():
    """Rise, settling and peak are marked at their times and levels by the ticks of the axes."""
    found = case.simulated("down")
    ink = alone("down")["step"]
    own = found.servo.metrics
    upright = ticks_beside(ink, "right", lambda x, _: x < 14)
    across = ticks_beside(ink, "center", lambda _, y: y > 40)
    level = np.polyfit([v for _, v in upright], [at[1] for at, _ in upright], 1)
    time = np.polyfit([v for _, v in across], [at[0] for at, _ in across], 1)
    unit = 1e3 if any(m.get("text") == "time after the step, ms" for m in ink.marks) else 1.0
    dots = [m["path"][0] for m in ink.marks if m.get("closed") and len(m["path"][0]) == 32]
    centres = [np.mean(one, axis=0) for one in dots]
    early, late, _, peak = centres
    assert late[0] - early[0] == pytest.approx(time[0] * unit * own.rise_time, abs=0.1)
    for at, share in ((early, 0.1), (late, 0.9)):
        value = 1e3 * (found.servo.start + share * (found.servo.target - found.servo.start))
        assert at[1] == pytest.approx(np.polyval(level, value), abs=0.1)
    assert peak[0] == pytest.approx(np.polyval(time, unit * own.peak_time), abs=0.1)
    assert peak[1] == pytest.approx(np.polyval(level, 1e3 * own.peak), abs=0.1)
    words = " ".join(m["text"] for m in ink.marks if "text" in m)
    assert f"overshoot {100 * own.overshoot:.1f} %" in words
    assert f"settling {1e3 * own.settling_time:.1f} ms" in words


def test_jumps_are_drawn_upright():
    """The reference of a step goes up at one place, however long the record."""
    found = case.simulated("step")
    asked = Curve("", found.time, 1e3 * found.signals["reference"])
    ink = drawn(Chart("t", [Panel("x, mm", Axis("time, s"), curves=[asked])]), width=60.0)
    (line,) = next(m["path"] for m in ink.marks if "path" in m and m["pen"] == 0.4)
    steps = [(a, b) for a, b in itertools.pairwise(line) if abs(a[1] - b[1]) > 1]
    assert len(steps) == 2
    assert all(a[0] == pytest.approx(b[0], abs=1e-6) for a, b in steps)


def test_windows_stand_along_the_stroke_or_over_time():
    """Where the rod travels, places in mm; where it is held, times; bars of 95 % about the size."""
    travelled, held = case.simulated("stroke"), case.simulated("closed")
    assert figures.travelled(travelled.shaken.windows, travelled.plant.stroke)
    assert not figures.travelled(held.shaken.windows, held.plant.stroke)
    one = figures.along(travelled.shaken, "stroke")
    windows = sorted(travelled.shaken.windows, key=lambda w: w.position)
    assert one.place == pytest.approx([1e3 * w.position for w in windows])
    assert one.size == pytest.approx([abs(w.stiffness) / 1e6 for w in windows])
    assert one.size_error == pytest.approx(
        [1.959964 * w.standard_error / 1e6 for w in windows], rel=1e-4
    )


def test_measured_values_lie_under_the_simulated_ones():
    """A measured curve is drawn before the run's own, and named; unknown names are left out."""
    found = case.simulated("step")
    measured = {"position": (found.time, found.signals["position"]), "nothing": ([0.0], [1.0])}
    first = figures.strips(found, measured)[0].panel
    assert [one.words for one in first.curves] == ["measured", "reference", "response"]
    alone = figures.strips(found, {})[0].panel
    assert [one.words for one in alone.curves] == ["reference", "response"]


def test_a_static_stiffness_is_drawn_beside_the_dynamic_one():
    """Its name stands in the legend where the rod travels, not over time."""
    place = np.linspace(0.0, 0.22, 9)
    for kind, beside in (("stroke", True), ("closed", False)):
        ink = panels(kind, (place, 1e7 + 0 * place))["stiffness"]
        assert any(m.get("text") == "static" for m in ink.marks) == beside


# ---- several ----


def test_a_row_of_a_comparison_is_its_run():
    """Every number of the table, by the JSON of its run; a limit that is missed carries a cross."""
    runs = case.tuned()
    columns = ("overshoot", "settling_time", "gain", "gain_margin", "phase_margin")
    body = comparing.run_table(comparing.comparison(runs, "tuning", columns=columns)).rows
    assert [row[0] for row in body] == [name for name, _ in runs]
    for (_, run), row in zip(runs, body, strict=True):
        told = run.to_dict()
        results, gains = told["results"], told["controller"]
        over = row[1].text if isinstance(row[1], Status) else row[1]
        assert isinstance(row[1], Status) == (results["overshoot"]["value"] > 0.05)
        assert agrees(over, 100 * results["overshoot"]["value"])
        settling = results["settling_time"]["value"]
        assert row[2] == "–" if settling is None else agrees(row[2], 1e3 * settling)
        factor = run.scenario.control.gain_factor
        assert agrees(row[3], factor * gains["proportional_gain"])
        assert agrees(row[4], gains["gain_margin"])
        assert agrees(row[5], math.degrees(gains["phase_margin"]))


def test_a_comparison_chooses_its_figure():
    """Steps, stiffness along the stroke, or signals; each kind has columns of its own."""
    stroke = [(f"{k}, {way}", case.simulated("stroke")) for k in "ab" for way in ("out", "in")]
    mixed = [("one", case.simulated("open")), ("two", case.simulated("pump"))]
    kinds = {"step": case.tuned(), "stiffness": stroke, "signals": mixed}
    for kind, runs in kinds.items():
        assert pair_figures.kind_of([run for _, run in runs]) == kind
        assert comparing.comparison(runs, kind).columns
        for height in (pair_figures.LEAST, 100.0, pair_figures.MOST):
            assert boxes_collide(pair_figures.comparison_figure(runs, height)) == [], kind


def test_families_share_a_colour_and_kinds_a_dash():
    """What stands before the last comma decides the colour, what stands after it the dash."""
    names = [f"{k} %, {way}" for k in (0, 50, 75, 100) for way in ("out", "in")]
    made = pair_figures.styles(names)
    assert [colour for colour, _ in made] == [0, 0, 1, 1, 2, 2, 3, 3]
    assert [dash for _, dash in made] == [0, 1] * 4
    alone = pair_figures.styles(["P", "PI", "PID", "PID, half"])
    assert len(set(alone)) == 4
    assert len(set(pair_figures.styles([str(k) for k in range(20)]))) == 20


@pytest.mark.parametrize(
    ("runs", "columns", "words"),
    [
        ([], (), "nothing to compare"),
        (["a", "a"], (), 'two runs are named "a"'),
        (["a"], ("overshot",), 'did you mean "overshoot"?'),
    ],
)
def test_what_cannot_be_compared_says_why(runs, columns, words):
    """One clear line each."""
    with pytest.raises(InputError, match=re.escape(words)) as caught:
        comparing.comparison([(name, case.simulated("open")) for name in runs], "t", (), columns)
    assert len(str(caught.value).splitlines()) == 1


# ---- documents ----


@pytest.mark.parametrize("kind", EACH)
def test_a_run_makes_one_sheet(kind, tmp_path):
    """One A4 sheet as PDF and PNG, and one with the values of the equations; the source inside."""
    found = case.simulated(kind)
    files = written(subject.page(found), tmp_path, scenario_hash=found.spec_hash)
    assert [file.path.name for file in files] == ["s.pdf", "s.png"]
    assert files[0].pages == (1 if kind == "bench" else 2)
    if kind == "step":
        short = subject.page(replace(found, basis=Basis(())))
        assert written(short, tmp_path / "short")[0].pages == 1
    inside = read_attachment(files[0].path)
    assert inside.source == case.SOURCE
    assert inside.run["scenario_hash"] == found.spec_hash


def test_a_comparison_makes_one_sheet(tmp_path):
    """Five controllers on one sheet."""
    page = compared(case.tuned(), notes=["Ziegler-Nichols"])
    assert written(page, tmp_path)[0].pages == 1
    assert "Ziegler-Nichols." in words_of(page)


def test_one_value_of_every_run_is_no_range():
    """Equal runs show each figure once; runs that differ show the least and the most."""
    one = case.simulated("step")
    same = compared([("a", one), ("b", one)]).tiles
    assert {tile.note for tile in same} == {"every run"}
    assert not any("\N{EN DASH}" in tile.value for tile in same)
    assert any("\N{EN DASH}" in tile.value for tile in compared(case.tuned()).tiles)


def test_what_the_caller_adds_goes_on_to_the_next_sheet(tmp_path):
    """An extra table that has no room leaves the figures as high as they were."""
    rows = [[f"frequency {k}", "1 Hz"] for k in range(40)]
    extra = [Table("Linear and not", [Column("what", "left", 1.0), Column("value")], rows)]
    longer = paged("step", extra=extra)
    assert written(longer, tmp_path)[0].pages == 3
    drawn = [paper.plain(page, ORIGIN)["section"] for page in (longer, paged("step"))]
    assert drawn[0] == drawn[1]
    assert "Linear and not" in tables(longer)


def test_equal_runs_make_equal_bytes(tmp_path):
    """The time that a run took is not on its page."""
    hashes = []
    for k in (1, 2):
        found = replace(case.simulated("closed"), seconds=float(k))
        files = written(subject.page(found), tmp_path / str(k))
        hashes.append([file.sha256 for file in files])
    assert hashes[0] == hashes[1]


def test_absurd_names_are_cut_or_broken(tmp_path):
    """Names without an end stay inside the figures and break in the tables; no word is lost."""
    found = case.simulated("step")
    own = found.scenario.model_copy(update={"name": ABSURD, "notes": ABSURD})
    long = replace(found, scenario=own)
    assert written(subject.page(long), tmp_path)[0].pages <= 2
    runs = [(f"{k} {ABSURD}", run) for k, (_, run) in enumerate(case.tuned())]
    assert boxes_collide(pair_figures.comparison_figure(runs, 120.0)) == []
    assert written(compared(runs, ABSURD), tmp_path)[0].pages <= 3
    for width in (40, 100):
        lines = shown(subject.page(long), width=width).splitlines()
        assert max(map(len, lines[1:])) <= width


@pytest.fixture
def no_typst(monkeypatch):
    """A machine without the typst wheel."""
    real = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name: None if name == "typst" else real(name)
    )


@pytest.mark.long
def test_the_plain_renderer_draws_it_too(tmp_path, no_typst):
    """Without typst every table and note is drawn, one below the other."""
    assert written(paged("step"), tmp_path)[0].path.read_bytes().startswith(b"%PDF")
    files = written(compared(case.tuned()), tmp_path)
    assert files[0].pages == len(files) - 1


# ---- terminal ----


@pytest.mark.parametrize("kind", EACH)
def test_the_terminal_keeps_its_width(kind):
    """No line is longer than the terminal, also in plain ASCII."""
    page = paged(kind)
    for width, unicode in itertools.product((40, 80, 140), (True, False)):
        text = shown(page, width, unicode)
        assert max(map(len, text.splitlines())) <= width, text
        assert "\\u" not in text
        assert "\\x" not in text
        assert unicode or text.isascii()


def test_the_terminal_shows_the_numbers_of_the_page():
    """Every result with its limit and state in one line; controller, balances, curve, energies."""
    found = case.simulated("step")
    text = shown(subject.page(found), width=160)
    lines = text.splitlines()
    for one in subject.results(found):
        value = one.words.split(" ")[0]
        mark = {"met": "✔", "missed": "✘", "": ""}[one.state]
        wanted = (one.label, value, one.limit, one.margin, mark)
        assert any(all(cell in line for cell in wanted) for line in lines), one.name
    for words in ("P on the position", "Errors of the balances: oil mass", "% of the step"):
        assert words in text
    assert any("⡠" in line or "⠊" in line for line in lines)
    plain = shown(subject.page(found), 160, unicode=False)
    assert any("<= 20 ms" in line and "missed" in line for line in plain.splitlines())
    assert "\x1b[" not in text
    assert "\x1b[31" in shown(subject.page(found), 160, colour=True)


# ---- CSV ----


@pytest.mark.parametrize("kind", EACH)
def test_the_csv_holds_every_signal_on_an_even_grid(kind, tmp_path):
    """Header with units, even times each once, values as the signals have them."""
    found = case.simulated(kind)
    path = tmp_path / "s.csv"
    file = series.write_csv(subject.series(found), path)
    assert file.path == path
    heads = path.read_text().splitlines()[0].split(",")
    assert heads[0] == "t [s]"
    assert [one.partition(" [")[0] for one in heads[1:]] == list(found.signals)
    values = np.loadtxt(path, delimiter=",", skiprows=1).T
    step = found.scenario.sample_time or found.scenario.duration / 2000
    assert values[0] == pytest.approx(np.arange(values.shape[1]) * step, rel=1e-8, abs=1e-9 * step)
    assert values[0][-1] == pytest.approx(found.scenario.duration)
    if "pressure_a" in found.signals:
        assert "pressure_a [bar]" in heads
        at = heads.index("pressure_a [bar]")
        assert values[at][-1] == pytest.approx(1e-5 * found.signals["pressure_a"][-1], rel=1e-6)
        assert values[at].max() <= 1e-5 * found.signals["pressure_a"].max() * (1 + 1e-6)


def test_an_instant_that_stands_twice_tells_the_value_after_it(tmp_path):
    """At the very time of the step the reference has stepped."""
    found = case.simulated("step")
    path = tmp_path / "s.csv"
    series.write_csv(subject.series(found), path)
    heads = path.read_text().splitlines()[0].split(",")
    values = np.loadtxt(path, delimiter=",", skiprows=1).T
    asked = values[heads.index("reference [mm]")]
    at = int(np.argmin(np.abs(values[0] - 0.1)))
    assert values[0][at] == pytest.approx(0.1, abs=1e-9)
    assert asked[at] == pytest.approx(75.0)
    assert asked[at - 1] == pytest.approx(55.0)


@pytest.mark.parametrize(
    "module",
    [
        axes,
        figures,
        pair_figures,
        series,
        subject,
    ],
)
def test_examples_in_docstrings(module):
    """What the docstrings show is what comes out."""
    assert doctest.testmod(module).failed == 0
