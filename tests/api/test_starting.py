"""Start designs: few answers give a solved design of one page."""

from __future__ import annotations

import re
from math import pi

import pytest
import yaml

import actuator_opt as ao
from actuator_opt.api import starting
from actuator_opt.api.starting import StartAnswers
from actuator_opt.metrics.table import CHECKS

ANSWERS = [
    StartAnswers(500.0, 500.0, 0.5, 350e5),
    StartAnswers(50e3, 50e3, 0.5, 50e5, wall="aluminium"),
    StartAnswers(43e3, 42e3, 0.023, 250e5),  # skirts that nearly meet, on a spigot
    StartAnswers(1.2e3, 1e3, 0.04, 60e5, wall="lined_carbon"),
    StartAnswers(2e3, 1e3, 0.06, 120e5, wall="linerless"),
    StartAnswers(
        9e3, 3e3, 0.18, 350e5, "friction", "lined_carbon", 0.06, 0.15, 10e6
    ),  # longest file
]
"""The corners of forces, stroke and pressure, and each wall."""


@pytest.fixture(autouse=True)
def _one_search(monkeypatch):
    """The first sizes alone lead to a design."""
    monkeypatch.setattr(starting, "STARTS", 1)


def missed_checks(evaluation):
    """The checks that a design misses, without those that only advise."""
    advice = {line.name for _, line in CHECKS if line.advice}
    return {check.name for check in evaluation.checks if check.status == "missed"} - advice


@pytest.mark.parametrize(
    "answers",
    [
        ANSWERS[0],
        pytest.param(ANSWERS[1], marks=pytest.mark.long),
        *ANSWERS[2:-1],
        pytest.param(ANSWERS[-1], marks=pytest.mark.long),
    ],
    ids=lambda answers: f"{answers.wall} {answers.push:g} N",
)
def test_a_start_meets_its_limits_on_one_page(answers):
    """Every limit is met with round numbers; areas by hand carry the forces; at most 60 lines."""
    start = starting.solved_start(answers, "leg: α")
    assert (start.met, start.sentence) == (True, "")
    lines = start.text.splitlines()
    assert len(lines) <= 60
    assert max(map(len, lines)) <= 100
    assert yaml.safe_load(start.text)["name"] == "leg: α"
    assert not re.search(r"\.\d{5}", start.text)
    design = ao.read(start.text).design
    evaluation = ao.evaluate(design)
    assert evaluation.met
    assert not missed_checks(evaluation)
    cases, arm = design.load_cases, answers.lever_arm
    loads = [case.force if arm is None else case.joint_torque / arm for case in cases]
    assert loads == pytest.approx([answers.push, answers.pull])
    bore, rod = design.cylinder.bore, design.rod.outer_diameter
    ring = pi / 4 * (bore**2 - rod**2)
    assert answers.pressure * pi / 4 * bore**2 - answers.return_pressure * ring > answers.push
    assert answers.pressure * ring - answers.return_pressure * pi / 4 * bore**2 > answers.pull
    for path, variable in design.variables.items():
        assert variable.lower <= variable.start <= variable.upper, path


@pytest.mark.long
def test_other_goals_weigh_little_more_than_the_lightest(monkeypatch):
    """Friction falls below that of the lightest, and the mass stays within its limit."""
    starts, solved = [], starting._solved
    monkeypatch.setattr(starting, "_solved", lambda *a: starts.append(solved(*a)) or starts[-1])
    smooth = ao.start(push=4e3, stroke="50 mm", goal="friction")
    assert starts[1].actuator is smooth
    light, smooth = (ao.evaluate(start.actuator).metrics for start in starts)
    assert smooth["friction_running"].value < light["friction_running"].value
    assert smooth["mass"].value <= starting.HEAVIER * light["mass"].value


def test_a_joint_is_stated_by_torque_arm_speed_and_stiffness():
    """Torques stand in the file with their arm; by hand, the force is torque by arm."""
    actuator = ao.start(
        push="540 N*m", pull=3e3, lever_arm="60 mm", stroke="180 mm", speed="0.2 m/s",
        stiffness="20 kN/mm", wall="aluminium",
    )  # fmt: skip
    cases = actuator.design.load_cases
    assert [case.joint_torque for case in cases] == pytest.approx([540.0, 180.0])
    assert {(case.lever_arm, case.speed, case.force) for case in cases} == {(0.06, 0.2, None)}
    assert len(actuator.source.text.splitlines()) <= 60
    evaluation = ao.evaluate(actuator)
    assert evaluation.met
    assert evaluation.metrics["push_force"].value > 9e3
    assert evaluation.metrics["stiffness_min"].value > 20e6
    assert "stiffness_min: {min: 20 kN/mm}" in actuator.source.text


def test_what_does_not_fit_says_why():
    """The seals bear 0.5 m/s: a faster start is the nearest design, with the reason on top."""
    start = starting.solved_start(StartAnswers(5e3, 2e3, 0.05, 160e5, speed=0.6))
    assert not start.met
    assert start.sentence == "missed: piston speed"
    assert start.text.startswith("# Nothing fits yet: missed: piston speed.\n")
    assert missed_checks(ao.evaluate(start.actuator)) == {"piston speed"}


@pytest.mark.parametrize("wall", ["steel", pytest.param("linerless", marks=pytest.mark.long)])
def test_a_double_rod_start_pushes_as_it_pulls(wall):
    """With a rod through both ends the forces are equal, and every limit is met."""
    design = ao.start(type="double_rod", push="8 kN", pull="8 kN", wall=wall).design
    evaluation = ao.evaluate(design)
    assert design.double_rod
    assert design.cylinder.mount == "head_trunnion"
    assert evaluation.met
    push, pull = (evaluation.metrics[f"{key}_force"].value for key in ("push", "pull"))
    assert push == pytest.approx(pull, rel=1e-4)  # the barrel grows a little differently


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"push": "9"}, 'push: "9": unit missing'),
        ({"push": "540 N*m"}, "push: 540 N*m is a torque; add the lever arm"),
        ({"lever_arm": 0.0}, "lever_arm: 0 m: must be > 0"),
        ({"stiffness": "9 kN"}, "stiffness"),
        ({"speed": "fast"}, "speed"),
        ({"pull": -1.0}, "pull: -1"),
        ({"pressure": "40 mm"}, "pressure"),
        ({"wall": "double_rod"}, "use one of steel, aluminium, lined_carbon, linerless"),
        ({"type": "plunger"}, "use one of differential, double_rod"),
        ({"goal": "mas"}, 'did you mean "mass"?'),
        ({"push": 0.0, "pull": 0.0}, "state a force"),
        ({"push": "900 kN", "pressure": "10 bar"}, "for pressure"),
        ({"push": "20 MN", "pull": "20 MN"}, "push, pull: no start design"),
        ({"name": "two\nlines"}, "unprintable"),
    ],
)
def test_unsuitable_answers(changes, words):
    """One clear line each, before anything is solved."""
    with pytest.raises(ao.ActuatorError, match=r"^[^\n]*$") as error:
        ao.start(**changes)
    assert words in str(error.value)


@pytest.mark.parametrize(
    "changes",
    [
        {"push": 2e7, "pressure": 1.5e8},
        {"stroke": 10.0, "push": 1e3, "pressure": 1.5e8},
        {"pull": 1e5, "pressure": 1e6, "stroke": 0.01},
        {"stiffness": 1e15},
        {"speed": 20.0},
        {"stroke": 10.0, "pull": 1e5, "pressure": 1.5e8, "type": "double_rod"},
    ],
)
def test_absurd_answers_name_what_was_typed_and_its_limit(changes):
    """The line names options, not the template; each limit gives a start, and none lies beyond."""
    usual = {"push": 5e3, "pull": 3e3, "stroke": 0.1, "pressure": 160e5}
    answers = StartAnswers(**usual | changes)
    with pytest.raises(ao.ActuatorError, match=r"^--(?!.*<text>)[^\n]*$") as error:
        starting.solved_start(answers, prefix="--")
    line = str(error.value)
    key = re.match(r"--(\w+): ", line)[1]
    assert key in changes
    limits = re.findall(r"at (most|least) ([\d.e+]+ [\w/]+)(?: for --(\w+))?", line)
    assert limits
    for sense, text, other in limits:
        name = other or key
        number = starting.start_answers({name: text})[name]
        assert not starting._fault(answers, {name: number})
        beyond = number * (1.1 if sense == "most" else 0.9)
        assert starting._fault(answers, {name: beyond})
