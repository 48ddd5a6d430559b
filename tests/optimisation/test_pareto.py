"""`pareto` of the knee: what the front holds, what it writes, and what it refuses."""

from __future__ import annotations

import csv
import json
from dataclasses import replace

import numpy as np
import pytest
from cli_runner import KNEE, bench, run

import actuator_opt as ao
from actuator_opt.optimisation.front.plane import FrontGap
from actuator_opt.pages.pareto import remarks

PAIR = ("--objective", "mass:min", "--objective", "stiffness_min:max")


@pytest.fixture(scope="module")
def front():
    """The front of mass and stiffness."""
    return ao.pareto(KNEE, ["mass:min", "stiffness_min:max"], n=20, checks=1)


@pytest.mark.long
def test_ends_are_the_optima_alone(front):
    """The lightest design is that of `optimise`; the stiffest that of its own optimum."""
    lightest = ao.optimise(KNEE, starts=2, prices=False)
    assert front.points[0].metrics["mass"] == pytest.approx(lightest.objective_value, rel=1e-9)
    turned = ao.read(KNEE, set={"objective.maximise": "stiffness_min"})
    stiffest = ao.optimise(turned, starts=2, prices=False)
    best = front.points[-1].metrics["stiffness_min"]
    assert best == pytest.approx(stiffest.objective_value, rel=1e-6)


def test_every_design_is_one(front):
    """Evaluated as files they meet every requirement, with the metrics told."""
    assert len(front.points) == 20
    for point in front.points[::6]:
        values = {**point.variables}
        evaluation = ao.evaluate(ao.read(KNEE).changed(values))
        assert evaluation.met
        for name, value in point.metrics.items():
            if name in ("mass", "stiffness_min", "friction_running"):
                assert evaluation.metrics[name].value == pytest.approx(value, rel=1e-9)


def test_front_is_a_front(front):
    """Each design is stiffer for its mass; even, optimal, with a knee between the ends."""
    mass = [p.metrics["mass"] for p in front.points]
    stiffness = [p.metrics["stiffness_min"] for p in front.points]
    assert (np.diff(mass) > 0).all()
    assert (np.diff(stiffness) > 0).all()
    assert max(p.kkt_residual for p in front.points) <= 1e-6
    assert front.evenness <= 3
    assert 0 < front.knee.index < 19
    assert front.checked == 1
    assert front.improved == 0


def test_a_design_between_is_the_optimum_at_its_stiffness(front):
    """Least mass at the stiffness of a design of the front is that design's mass."""
    point = front.points[8]
    held = ao.read(KNEE, set={"requirements.stiffness_min.min": point.metrics["stiffness_min"]})
    assert ao.optimise(held, starts=2, prices=False).objective_value == pytest.approx(
        point.metrics["mass"], rel=1e-6
    )


def test_jumps_are_told(front):
    """A jump is named with what it can hold and left out of the ratio; a wide gap is not."""
    gaps = [0.05] * 19
    gaps[4], gaps[9] = 0.4, 0.2
    jump, hole = FrontGap(4, 0.4, 0.01, True), FrontGap(9, 0.2, 0.2, False)
    told = replace(front, gaps=tuple(gaps), wide=(jump, hole))
    assert told.evenness == pytest.approx(4)
    data = told.to_dict()["gaps"]
    assert data["largest"] == 0.2
    assert [gap["after"] for gap in data["wide"]] == [4, 9]
    words = "\n".join(remarks(told))
    assert "jumps between designs 5 and 6" in words
    assert "at most 2.5 %" in words
    assert "wide gap between designs 10 and 11" in words
    assert "jump" not in "\n".join(remarks(front))


def test_writes_table_csv_and_report(tmp_path):
    """One line per design in the CSV, units in its header; files named in the JSON."""
    file = tmp_path / "front.csv"
    done = run("pareto", KNEE, *PAIR, "-n", "6", "--checks", "0", "--csv", file, "--report",
               "--out", tmp_path / "r", "--json")  # fmt: skip
    assert done.code == 0
    data = json.loads(done.out)
    assert len(data["points"]) == 6
    assert set(data["points"][0]) == {"variables", "metrics", "kkt_residual"}
    assert data["knee"]["metrics"] == data["points"][data["knee"]["index"]]["metrics"]
    rows = list(csv.DictReader(file.read_text().splitlines()))
    assert len(rows) == 6
    assert float(rows[0]["mass [g]"]) == pytest.approx(1e3 * data["points"][0]["metrics"]["mass"])
    names = sorted(path.name for path in (tmp_path / "r").iterdir())
    assert {f"knee_bonded_pareto{end}" for end in (".pdf", "_figure.png", "_figure.svg")} <= set(
        names
    )


@pytest.mark.parametrize(
    ("given", "code", "words"),
    [
        (["--objective", "mass:min"], 2, "two to four objectives, not 1"),
        ([], 2, "two to four objectives, not 0"),
        ([x for m in ("mass:min", "push_force:max", "stiffness_min:max", "friction_running:min",
                      "efficiency:max") for x in ("--objective", m)], 2, "not 5"),
        (["--objective", "mass:min", "--objective", "mass:min"], 2, "given twice"),
        (["--objective", "mass:min", "--objective", "mass:max"], 2, "given twice, min and max"),
        (["--objective", "mass:min", "--objective", "masss:min"], 2, 'did you mean "mass"'),
        (["--objective", "mass:min", "--objective", "stiffness_min"], 2, "METRIC:min"),
        ([*PAIR, "-n", "2"], 2, "3 to 2000"),
        (["--objective", "mass:min", "--objective", "damping_pipe:max"], 3, "no variable affects"),
        ([*PAIR, "--csv", "/no/such/folder/f.csv"], 3, "its folder does not exist"),
    ],
)  # fmt: skip
def test_refuses(given, code, words):
    """One line each: what is wrong, and what to do."""
    done = run("pareto", KNEE, *given)
    assert done.code == code
    assert words in done.err
    assert len(done.err.strip().splitlines()) == 1
    assert done.out == ""


def test_sizes_a_front_does_not_keep_are_told():
    """The bore moves freely although its file asks for a series; the remarks say so."""
    bore = "  cylinder.bore:\n    lower: 20 mm\n"
    actuator = ao.read(bench((bore, bore + "    sizes: iso_3320\n")))
    found = ao.pareto(actuator, ["mass:min", "stiffness_min:max"], n=3, checks=0)
    told = "listed sizes are ignored, as the front uses continuous dimensions: cylinder.bore"
    assert told in found.to_dict()["warnings"]
    assert any(told in remark for remark in remarks(found))


@pytest.mark.long
def test_infeasible_design():
    """No front of a design that no dimensions make feasible; the exit code says so."""
    done = run("pareto", KNEE, *PAIR, "--set", "requirements.stiffness_min.min=1e9", "--json")
    assert done.code == 1
    data = json.loads(done.out)
    assert data["points"] == []
    assert data["knee"] is None
    assert data["infeasibility"]["joint"]


KINKED = """
import actuator_opt as ao


@ao.metric("own")
def own(v):
    aside = v["cylinder.bore"] - 0.0221
    return -aside if aside.real > 0 else aside
"""


@pytest.mark.long
def test_an_end_that_is_not_found_is_named(tmp_path):
    """The objective whose best lies on a kink is no proven optimum: named, with the reason."""
    plugin = tmp_path / "own.py"
    plugin.write_text(KINKED)
    asked = ["--objective", "mass:min", "--objective", "own:max", "--plugin", plugin]
    result = run("pareto", "-", *asked, "-n", "3", "--checks", "0", stdin=bench().encode())
    assert result.code == 4
    assert "failed (own:max: all requirements are met" in " ".join(result.out.split())
