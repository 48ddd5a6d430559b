"""Records with gaps, early ends and faults: what is said of them, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from cli_runner import DESIGNS
from simulation_case import scenario

import actuator_opt as ao
from actuator_opt.errors import InputError
from actuator_opt.identification import parse_column
from actuator_opt.simulation.parts.signals import acts_after, at_start

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
        "0.03 to 0.033 s, last from 0.08 to 0.082 s, a straight line between those beside them"
    )
    whole = ao.simulate(replay(course()))
    assert found.signals["reference"][-1] == whole.signals["reference"][-1] == pytest.approx(0.042)


def test_an_input_that_ends_early_is_held_and_told(replay):
    """Its last value stands to the end, and so nothing asks for motion there: the creep is told."""
    found = ao.simulate(replay(course(end=0.15)))
    assert found.notes[0] == (
        'column "x" of in.csv (control.position[0]) ends at 0.15 s, the scenario at 0.2 s: its '
        "last value is held"
    )
    assert found.signals["reference"][-1] == pytest.approx(0.042)
    assert found.values["hold_drift"] is not None
    moving = [f"{k / 1e3:.3f},{0.01 * k}" for k in range(191)]
    found = ao.simulate(replay(moving))
    assert found.values["hold_drift"] is None
    assert found.why["hold_drift"].endswith("still moves it in the last tenth")


def test_an_input_that_begins_late_is_told(replay):
    """Its first value holds from the beginning."""
    found = ao.simulate(replay(course()[10:]))
    assert "begins at 0.01 s: its first value holds until then" in found.notes[0]


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
        ("t [s],U [V]\n", 'column "U" holds no course', 1),
        ("t [s],U [V]\n0,nan\n1,2\n", 'column "U" holds no course', 1),
        ("t [s],U [V]\n0,1\n,2\n2,1\n", "no time", 3),
        ("t [s],U [V]\n0,1\n2,2\n1,1\n", "the time does not rise", 4),
        ("t [s],U [mm]\n0,1\n2,2\n", 'column "U": ', 1),
        ("t [s],U [V]\n0,1\n2,x\n", '"x" is no number', 3),
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
