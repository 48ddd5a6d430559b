"""The study of the course's servos: rows that are what the loops do, a page of their numbers."""

from __future__ import annotations

import json
import math
from io import BytesIO
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import course_case as case
import numpy as np
import pytest
from script_loader import script

from actuator_opt.simulation.linear import Tuned

ROOT = Path(__file__).parents[2]
REPORT = ROOT / "reports" / "samples" / "course_servo.pdf"
VARIED = [f"PID, {part} × {factor}" for part in "PID" for factor in ("½", "2")]


study = script("course_servo")


@pytest.fixture(scope="module")
def quick() -> Any:
    """The study with few cases."""
    return study.compute(quick=True)


@pytest.fixture(scope="module")
def fresh(quick) -> dict[str, Any]:
    """Its numbers."""
    return study.numbers(quick)


def _committed() -> dict[str, Any]:
    pypdf = pytest.importorskip("pypdf")
    return json.loads(pypdf.PdfReader(REPORT).attachments["course_servo.json"][0])


@pytest.fixture(params=[pytest.param("quick", marks=pytest.mark.long), "committed"])
def numbers(request) -> dict[str, Any]:
    """The numbers of a quick run, and those that the committed report carries inside."""
    return request.getfixturevalue("fresh") if request.param == "quick" else _committed()


@pytest.mark.long
def test_every_loop_has_the_rows_that_the_course_asks(numbers) -> None:
    """P, PI and PID by the rule, each part of the PID halved and doubled, and the tool's own."""
    assert set(numbers["loops"]) == {"position", "speed", "angle"}
    for loop in numbers["loops"].values():
        assert list(loop["tuned"]) == ["P", "PI", "PID", *VARIED, "own PI"]
        assert list(loop["swung"]) == ["P", "PI", "PID"]


def test_the_rows_follow_the_rule_of_ziegler_and_nichols(numbers) -> None:
    """0.5, 0.45 and 0.6 of the ultimate gain; T_u/1.2; T_u/2 and T_u/8, on both ultimate points."""
    for key, loop in numbers["loops"].items():
        name = next(one for one in study.NEEDED if study.RAISED[one][0] == key)
        points = {"tuned": loop["linear"], "swung": numbers["raised"][name]["raised"]}
        for kind, (gain, period) in points.items():
            rows = loop[kind]
            assert rows["P"]["gain"] == pytest.approx(0.5 * gain, rel=1e-5)
            assert rows["PI"]["gain"] == pytest.approx(0.45 * gain, rel=1e-5)
            assert rows["PI"]["integral_time"] == pytest.approx(period / 1.2, rel=1e-5)
            assert rows["PID"]["gain"] == pytest.approx(0.6 * gain, rel=1e-5)
            assert rows["PID"]["integral_time"] == pytest.approx(period / 2, rel=1e-5)
            assert rows["PID"]["derivative_time"] == pytest.approx(period / 8, rel=1e-5)


@pytest.mark.parametrize(("word", "factor"), [("½", 0.5), ("2", 2.0)])
def test_a_variation_changes_one_part_alone(numbers, word, factor) -> None:
    """K, K/T_i and K T_d of a varied PID: one of them by the factor, the others as they were."""
    for loop in numbers["loops"].values():
        base = _parts(loop["tuned"]["PID"])
        for k, part in enumerate("PID"):
            wanted = [size * (factor if i == k else 1) for i, size in enumerate(base)]
            found = _parts(loop["tuned"][f"PID, {part} × {word}"])
            assert found == pytest.approx(wanted, rel=1e-5)


def _parts(row: dict[str, float]) -> list[float]:
    gain = row["gain"]
    return [gain, gain / row["integral_time"], gain * row["derivative_time"]]


def test_a_proportional_gain_of_half_the_ultimate_one_has_a_margin_of_two(numbers) -> None:
    """The rule's P has gain margin 2 in every linear loop."""
    for loop in numbers["loops"].values():
        assert loop["tuned"]["P"]["gain_margin"] == pytest.approx(2, rel=1e-4)


def test_the_p_loops_err_as_their_valves_ask(numbers) -> None:
    """Cylinder: friction takes over at -3.9 mV; motor: the droop is the signal over the gain."""
    row = numbers["loops"]["position"]["tuned"]["P"]
    assert row["steady_state_error"] * row["gain"] == pytest.approx(
        case.holding_signal(case.STATIC), rel=0.02
    )
    row = numbers["loops"]["speed"]["tuned"]["P"]
    speed = 1000 * case.RPM - row["steady_state_error"]
    assert case.running(speed).volts == pytest.approx(
        row["gain"] * row["steady_state_error"], rel=1e-3
    )
    for name in ("PI", "PID"):
        assert abs(numbers["loops"]["speed"]["tuned"][name]["steady_state_error"]) < 1e-4


def test_the_raised_gain_of_the_motor_is_that_of_its_working_point(numbers) -> None:
    """Where it swings at 1000 rpm: the ultimate gain about the droop's own speed, by hand."""
    for name, row in numbers["raised"].items():
        if not name.endswith("rpm"):
            continue
        gain, period = row["raised"]
        wanted = float(name.split()[1]) * case.RPM
        speed = wanted
        for _ in range(50):  # the droop at that gain
            speed = wanted - case.running(speed).volts / gain
        by_hand, swing = case.motor_swings(speed)
        assert gain == pytest.approx(by_hand, rel=0.06)
        assert period == pytest.approx(swing, rel=0.03)


def test_friction_lifts_the_ultimate_gain_of_the_cylinder(numbers) -> None:
    """More than threefold; with 1 N of it less than half of that is left."""
    raised = numbers["raised"]
    assert 3 < raised["cylinder, 50 mm"]["ratio"] < 4.5
    if "cylinder, 1 N of dry friction" in raised:
        assert 1 < raised["cylinder, 1 N of dry friction"]["ratio"] < 1.5


def test_the_calm_loop_is_calm(numbers) -> None:
    """The tool's own PI overshoots less than the rule's PI and comes to rest in every loop."""
    for loop in numbers["loops"].values():
        own, rule = loop["tuned"]["own PI"], loop["tuned"]["PI"]
        assert own["overshoot"] < rule["overshoot"]
        assert own["settling_time"] is not None
        assert own["gain_margin"] > 2


@pytest.mark.long
def test_the_committed_report_is_this_study(fresh) -> None:
    """The loops of a fresh run have the numbers of the committed one."""
    before = _committed()
    assert before["version"] == fresh["version"]
    for key, loop in fresh["loops"].items():
        then = before["loops"][key]
        assert loop["linear"] == pytest.approx(then["linear"], rel=1e-5)
        for name, row in loop["tuned"].items():
            for figure in ("gain", "overshoot", "gain_margin"):
                assert row[figure] == pytest.approx(then["tuned"][name][figure], rel=1e-3, abs=1e-3)
    for name, row in fresh["pulse"].items():
        assert row == pytest.approx(before["pulse"][name], rel=1e-3, abs=1e-6)


def test_a_loop_swings_on_or_dies_away() -> None:
    """What counts as swinging: a sine that stays, not one that fades or is too small to see."""
    runs = {name: _shaped(size, rate) for name, size, rate in _SHAPES}
    assert [study.swinging(run, "y") for run in runs.values()] == [True, False, False]
    assert study.period(runs["stays"], "y") == pytest.approx(0.05, rel=1e-3)


_SHAPES = (("stays", 0.1, 0.0), ("fades", 0.1, 3.0), ("unseen", 1e-5, 0.0))


def _shaped(size: float, rate: float) -> Any:
    """A step of 1 at 1 s with a swing of 20 Hz on it."""
    time = np.linspace(0, 4, 8001)
    swing = size * np.exp(-rate * time) * np.sin(2 * math.pi * 20 * time)
    step = SimpleNamespace(time=1.0, start=0.0, target=1.0)
    return SimpleNamespace(time=time, signals={"y": 1 + swing}, servo=step)


@pytest.mark.long
def test_the_page_tells_the_numbers(quick, fresh) -> None:
    """One PDF: every sentence stands in it, the numbers are attached."""
    pypdf = pytest.importorskip("pypdf")
    pytest.importorskip("typst")
    pdf, images = study.page(quick)
    reader = pypdf.PdfReader(BytesIO(pdf))
    words = "".join("".join(page.extract_text() for page in reader.pages).split())
    for sentence in study.sentences(fresh):
        assert "".join(sentence.split()) in words
    assert json.loads(reader.attachments["course_servo.json"][0]) == fresh
    assert len(images) == len(reader.pages)
    assert isinstance(quick.runs["position"]["P"].tuned, Tuned)
