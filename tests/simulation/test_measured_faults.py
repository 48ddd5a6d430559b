"""Records with gaps, early ends and faults: what is said of them, and what is refused."""

from __future__ import annotations

import doctest
import json
import re
from functools import cache

import numpy as np
import pytest
import simulation_report_case as case
from cli_runner import DESIGNS, run
from simulation_case import scenario
from simulation_report_case import boxes_collide

import actuator_opt as ao
from actuator_opt.base.errors import InputError
from actuator_opt.design.scenario import reader
from actuator_opt.identification import parse_column
from actuator_opt.pages import measured as pages
from actuator_opt.pages.measured import drawn, measured_charts
from actuator_opt.pages.simulation_figures import simulation_figure
from actuator_opt.rendering import chart_ink, terminal
from actuator_opt.simulation.components.circuit import acts_after, at_start
from actuator_opt.simulation.measured import AlignedRecord, fit, overlay, parse_measured
from actuator_opt.studies.plant import plant

REPLAY = f"""\
name: replay
design: {DESIGNS / "servo_knee.yaml"}
duration: 0.2 s
initial:
  position: 40 mm
control:
  position:
    - shape: record
      file: in.csv
      column: x
"""


@pytest.fixture
def replay(tmp_path):
    """A scenario whose reference is a file, and a way to write that."""
    file = tmp_path / "replay.yaml"
    file.write_text(REPLAY, encoding="utf-8")

    def written(lines, head="t [s],x [mm]"):
        text = "\n".join([head, *lines])
        (tmp_path / "in.csv").write_text(text, encoding="utf-8")
        return file

    return written


def course(end=0.2):
    """Lines of a reference, from the start: 2 mm up at 20 ms."""
    return [f"{k / 1e3:.3f},{2 if k > 20 else 0}" for k in range(round(1e3 * end) + 1)]


# What a scenario reads


def test_an_input_without_gaps_says_nothing(replay):
    """Nothing is told where there is nothing."""
    assert not [one for one in ao.simulate(replay(course())).notes if "in.csv" in one]


def test_missing_samples_of_an_input_are_told(replay):
    """Empty cells, nan, inf and missing lines: how many, where, and what stands in their place."""
    lines = course()
    for k, cell in zip(range(30, 34), ("", "nan", "inf", "-"), strict=True):
        lines[k] = f"{k / 1e3:.3f},{cell}"
    del lines[80:83]
    found = ao.simulate(replay(lines))
    assert found.notes[0] == (
        'column "x" of in.csv (control.position[0]): 7 samples are missing in 2 places, first from '
        "0.03 to 0.033 s, last from 0.08 to 0.082 s; the signal is interpolated there"
    )
    whole = ao.simulate(replay(course()))
    assert found.signals["reference"][-1] == whole.signals["reference"][-1] == pytest.approx(0.042)


def test_an_input_that_ends_early_is_held_and_told(replay):
    """Its last value stands to the end, and so nothing asks for motion there: the creep is told."""
    found = ao.simulate(replay(course(end=0.15)))
    assert found.notes[0] == (
        'column "x" of in.csv (control.position[0]) ends at 0.15 s, the scenario at 0.2 s: in '
        "between the signal keeps its last value"
    )
    assert found.signals["reference"][-1] == pytest.approx(0.042)
    assert found.values["hold_drift"] is not None
    moving = [f"{k / 1e3:.3f},{0.01 * k}" for k in range(191)]
    found = ao.simulate(replay(moving))
    assert found.values["hold_drift"] is None
    assert found.why["hold_drift"].endswith("still cause motion in the last tenth of the time")


def test_an_input_that_begins_late_is_told(replay):
    """Its first value holds from the beginning."""
    found = ao.simulate(replay(course()[10:]))
    assert "begins at 0.01 s: before that, the signal has its first value" in found.notes[0]


def test_a_record_acts_until_its_last_change():
    """Scaled and moved by its start: a step between 1 and 2 s, begun 0.5 s later."""
    part = scenario(
        signal=[{"shape": "record", "file": "f", "column": "u", "start": 0.5, "scale": 2.0}]
    ).signal[0]
    values = np.array([1.0, 1.0, 3.0, np.nan, 3.0])
    records = {("f", "u"): (np.arange(5.0), values)}
    assert [acts_after(part, t, records) for t in (0.0, 2.0, 2.4, 2.5, 9.0)] == [
        True, True, True, False, False,
    ]  # fmt: skip
    assert at_start([part], records) == 2.0
    later = {("f", "u"): (np.arange(5.0) - 3.0, values)}  # the time begins in the gap
    assert at_start([part], later) == 6.0


@pytest.mark.parametrize(
    ("text", "message", "line"),
    [
        ("t [s],U [V],U [V]\n0,1,1\n1,2,2\n", '2 columns are called "U"', 1),
        ("t [s],V [V]\n0,1\n1,2\n", 'no column "U"', 1),
        ("t [s],U [V]\n", 'column "U" has fewer than two samples', 1),
        ("t [s],U [V]\n0,nan\n1,2\n", 'column "U" has fewer than two samples', 1),
        ("t [s],U [V]\n0,1\n,2\n2,1\n", "missing time", 3),
        ("t [s],U [V]\n0,1\n2,2\n1,1\n", "time does not increase", 4),
        ("t [s],U [mm]\n0,1\n2,2\n", 'column "U": ', 1),
        ("t [s],U [V]\n0,1\n2,x\n", '"x" in column "U" is not a number', 3),
    ],
)
def test_bad_inputs_are_told_in_one_line(text, message, line):
    """What, where and what to do, of a column that a scenario names."""
    with pytest.raises(InputError) as told:
        parse_column(text, "U", "voltage", name="in.csv")
    (fault,) = told.value.diagnostics
    assert fault.message.startswith(message)
    assert (fault.file, fault.line) == ("in.csv", line)
    assert fault.remedy


def test_marks_commas_and_tabs_are_read():
    """A byte order mark, decimal commas with semicolons, tabs: the same samples."""
    plain = parse_column("t [s],U [V]\n0,1.5\n0.5,2.5\n", "U", "voltage", name="in.csv")
    for text in ("\ufefft [s];U [V]\n0;1,5\n0,5;2,5\n", "t [ms]\tU [mV]\n0\t1500\n500\t2500\n"):
        found = parse_column(text, "U", "voltage", name="in.csv")
        assert np.allclose(found, plain, rtol=1e-15)


# What a record says


STEP = f"""\
name: step
design: {DESIGNS / "servo_knee.yaml"}
duration: 0.1 s
sample_time: 0.5 ms
control:
  position:
    - {{shape: step, value: 2 mm, start: 0.02 s}}
"""
NOISE = {"pressure_a": 1.4e4, "pressure_b": 1.4e4, "position": 3e-6, "signal": 1e-2}


@cache
def trial():
    """The scenario, read once."""
    return ao.read_scenario(STEP)


def record(count=4, lag=0.0):
    """A record of a run with other oil, with noise, without samples from 50 to 60 ms and the end.

    It ends at 90 ms.
    """
    made = ao.simulate(STEP, set={"fluid.air_content": 0.012})
    time, first = np.unique(made.time, return_index=True)
    rng = np.random.default_rng(4)
    kept = (time < 0.0901) & ~((time > 0.0499) & (time < 0.0601))
    return AlignedRecord(
        {
            name: ((time + lag)[kept], (made.signals[name][first] + size * noise)[kept])
            for name, size in list(NOISE.items())[:count]
            for noise in [rng.standard_normal(time.size)]
        },
        "bench.csv",
    )


@cache
def fitted():
    """Air and capacity found from the record, with a lag."""
    own = plant(trial().actuator.subject())
    return fit(
        trial().scenario, own, {}, record(lag=0.003), ("air_content", "valve_capacity", "lag")
    )


def test_a_record_that_ends_early_is_compared_while_it_lasts():
    """Residuals over the overlap, and a note of what that is."""
    found = overlay(ao.simulate(trial()), record())
    assert found.residuals["position"].count == 181 - 21
    assert (
        "all channels: measured from 0 to 0.09 s, simulated from 0 to 0.1 s: only the overlap "
        "is compared" in found.notes
    )
    late = AlignedRecord({"position": tuple(one[40:] for one in record().channels["position"])})
    notes = overlay(ao.simulate(trial()), late).notes
    assert any(one.startswith("position: measured from 0.02 to 0.09 s") for one in notes)


def test_lines_break_where_samples_are_missing():
    """Nothing is drawn between 50 and 60 ms, on the time of the simulation."""
    found = drawn(overlay(ao.simulate(trial()), record(lag=0.003), lag=0.003))
    time, values = found["position"]
    assert time[0] == pytest.approx(0.0, abs=1e-12)
    (hole,) = time[~np.isfinite(values)]
    assert 0.0499 < hole < 0.0601


@pytest.mark.parametrize("count", [1, 4])
def test_every_channel_is_drawn_with_what_is_left_over(count):
    """Names, the noise of the sensor, the gap left open; nothing overlaps or leaves the paper."""
    found = overlay(ao.simulate(trial()), record(count))
    made = [chart_ink.drawn(chart) for chart in measured_charts(found)]
    assert [boxes_collide(ink) for ink in made] == [[]] * len(made)
    words = [one[0] for ink in made for one in ink.text_boxes()]
    assert sum(one.startswith("Measured minus simulated, ") for one in words) == count
    assert words.count("±2σ of noise") == count
    assert {"Pressure A, bar", "measured", "simulated"} <= set(words)
    assert not [one for one in words if "…" in one]


@pytest.mark.parametrize("width", [40, 60, 80, 100])
def test_the_terminal_shows_every_parameter_whole(width):
    """Names, values and verdict at any width, in lines that fit; powers of ten as printed."""
    found = fitted()
    blocks = pages.blocks(found.after, found)
    text = terminal.blocks_text(blocks, colour=False, unicode=True, width=width)
    assert max(map(len, text.splitlines())) <= width
    flat = " ".join(text.split())
    for word in ("air content", "valve capacity", "lag", "pressure A", "identified", "ms"):
        assert word in flat
    assert "…" not in text
    assert not re.search(r"\de[-+]?\d", text)


def test_numbers_show_what_they_are_uncertain_by():
    """Bounds differ from their value by two digits at least."""
    found = fitted()
    table = pages.blocks(found.after, found)[0]
    for row, one in zip(table.rows, found.parameters.values(), strict=True):
        cells = (cell.split(" ")[0].replace("\N{MINUS SIGN}", "-") for cell in row[2:5])
        value, low, high = map(float, cells)
        scale = one.entry.quantity.to_display(1.0)
        half = scale * (one.parameter.upper - one.parameter.value)
        assert high - value == pytest.approx(half, rel=0.15)
        assert value - low == pytest.approx(half, rel=0.15)


@pytest.mark.long
def test_the_second_integrator_and_the_hash_come_with_a_fit(tmp_path):
    """--verify counts with --fit; the hash is that of the scenario without it."""
    scene, bench = tmp_path / "step.yaml", tmp_path / "bench.csv"
    scene.write_text(STEP, encoding="utf-8")
    time, values = record().channels["position"]
    lines = [f"{t:.6f},{1e3 * x:.6f}" for t, x in zip(time, values, strict=True)]
    bench.write_text("\n".join(["time [s],way [mm]", *lines]), encoding="utf-8")
    plain = json.loads(run("simulate", str(scene), "--json").out)
    options = ("--measured", str(bench), "--column", "x=way", "--json")
    found = json.loads(
        run("simulate", str(scene), *options, "--fit", "air_content", "--verify").out
    )
    assert found["spec_hash"] == plain["spec_hash"] != ""
    assert found["second_integrator"]["method"] == "radau"
    assert found["measured"]["parameters"]["air_content"]["value"] == pytest.approx(0.012, rel=0.1)
    assert run("simulate", str(scene), "--column", "x=way").code == 2


def of_lines(head, count=30, cells="{k},{k}.5"):
    """A record of numbered lines."""
    return "\n".join([head, *(cells.format(k=k) for k in range(count))])


@pytest.mark.parametrize(
    ("text", "message", "line"),
    [
        ("", "the record is empty", None),
        ("t [s],p1 [bar]\n", "no samples below the header", None),
        (of_lines("t [s],p1 [bar]", 9), "fewer than 10 numbers in p1", None),
        (of_lines("t [s],p1 [bar]", cells="{k},1e300"), "fewer than 10 numbers in p1", None),
        (of_lines("t [s],p1 [bar],p1 [bar]", cells="{k},1,1"), 'columns "p1 [bar]" and', 1),
        (of_lines("t [s],time [s],x [mm]", cells="{k},{k},1"), 'columns "t [s]" and "time', 1),
        (of_lines("t [s],presure_1 [bar]"), "no channel matches a simulated signal", None),
        (of_lines("t [s],p1 [mm]"), 'column "p1": mm is a length', 1),
        (of_lines("t [s],p1"), 'column "p1" states no unit', 1),
        (
            of_lines("t [s],p1 [bar]", cells="{k},5,{k},5"),
            "4 cells, but the header has 2",
            2,
        ),
        (of_lines("t [s],p1 [bar]") + "\n3,1", "time does not increase at 3 s", 32),
        (of_lines("t [s],p1 [bar]", cells="1,{k}"), "time does not increase at 1 s", 3),
    ],
)
def test_bad_records_are_told_in_one_line(text, message, line):
    """What, where and what to do."""
    with pytest.raises(InputError) as told:
        parse_measured(text, name="bench.csv")
    (fault,) = told.value.diagnostics
    assert fault.message.startswith(message)
    assert (fault.file, fault.line) == ("bench.csv", line)
    assert fault.remedy


def test_a_record_in_another_unit_is_told():
    """Millimetres that are called metres, bar that are called MPa."""
    good = record(3).channels
    wrong = AlignedRecord(
        {
            "position": (good["position"][0], 1e3 * good["position"][1]),
            "pressure_a": (good["pressure_a"][0], 10 * good["pressure_a"][1]),
            "pressure_b": good["pressure_b"],
        }
    )
    made = ao.simulate(trial())
    told = [one for one in overlay(made, wrong).notes if "check the unit" in one]
    assert [one.split()[0] for one in told] == ["position", "pressure_a"]
    assert not any("check the unit" in one for one in overlay(made, record()).notes)


def test_a_record_of_a_million_samples_is_thinned_for_a_fit():
    """Every 250th of them, which is told; all count for the residuals."""
    made = ao.simulate(trial())
    time = np.linspace(0.0, 0.1, 1_000_001)[:-1]
    rng = np.random.default_rng(1)
    course = np.interp(time, made.time, made.signals["pressure_a"])
    wide = AlignedRecord({"pressure_a": (time, course + 1e4 * rng.standard_normal(time.size))})
    assert overlay(made, wide).residuals["pressure_a"].count == 1_000_000
    own = plant(trial().actuator.subject())
    found = fit(trial().scenario, own, {}, wide, ("air_content",))
    assert "pressure_a: the fit uses only one in 250 samples, at most 4000 in total" in found.doubts
    assert found.values["air_content"] == pytest.approx(0.005, rel=0.1)


def test_a_record_that_stands_still_is_not_fitted_to():
    """No channel that moves: one line, not a search."""
    still = AlignedRecord({"position": (np.linspace(0, 0.1, 50), np.full(50, 0.055))})
    own = plant(trial().actuator.subject())
    with pytest.raises(InputError, match="every channel is constant; choose a record with motion"):
        fit(trial().scenario, own, {}, still, ("air_content",))


def test_a_fit_at_the_end_of_a_range_says_which_way():
    """Oil of which a record asks for more air than there can be."""
    made = ao.simulate(STEP, set={"fluid.air_content": 0.15})
    time, first = np.unique(made.time, return_index=True)
    rng = np.random.default_rng(9)
    noise = rng.standard_normal(time.size)
    whole = made.signals["pressure_a"][first]
    more = whole[0] + 0.2 * (whole - whole[0]) + 1e3 * noise
    own = plant(trial().actuator.subject())
    found = fit(
        trial().scenario, own, {}, AlignedRecord({"pressure_a": (time, more)}), ("air_content",)
    )
    assert found.parameters["air_content"].at_bound == "upper"
    assert any(
        "upper end of its range, 20 %: the record suggests a larger" in o for o in found.doubts
    )


@pytest.mark.long
@pytest.mark.parametrize("kind", case.KINDS)
def test_no_name_of_a_curve_is_cut_for_a_record(kind):
    """With every signal measured, legends of strips and panels hold their words whole."""
    found = case.simulated(kind)
    measured = {name: (found.time, values) for name, values in found.signals.items()}
    bare = {one[0] for one in simulation_figure(found).text_boxes()}
    words = {one[0] for one in simulation_figure(found, measured=measured).text_boxes()}
    assert "measured" in words
    assert not [one for one in words - bare if "…" in one]


@pytest.mark.parametrize("module", [reader, pages])
def test_examples_in_docstrings(module):
    """What the docstrings show is what comes out."""
    found = doctest.testmod(module)
    assert (found.attempted > 0, found.failed) == (True, 0)
