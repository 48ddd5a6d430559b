"""The study of joints over pressure and bore: equal loads, masses that can be checked."""

from __future__ import annotations

import re
from math import pi
from pathlib import Path
from typing import Any

import pytest
from script_loader import carried, ran, script

import actuator_opt as ao

ROOT = Path(__file__).parents[2]
REPORT = ROOT / "reports" / "samples" / "knee_joints.pdf"

study = script("knee_joints")


@pytest.fixture(scope="module")
def quick(tmp_path_factory) -> tuple[str, Path]:
    """What the script prints and writes when run as a person runs it, at few points."""
    return ran("knee_joints", tmp_path_factory.mktemp("reports"))


@pytest.fixture(params=[pytest.param("quick", marks=pytest.mark.long), "committed"])
def numbers(request) -> dict[str, Any]:
    """The numbers of a quick run, and those that the committed report carries inside."""
    return carried(request.getfixturevalue("quick")[1] if request.param == "quick" else REPORT)


def _read(joint: str, row: dict[str, Any]) -> ao.Actuator:
    return study.read(joint, row["pressure"], row["bore"])


@pytest.mark.parametrize(("pressure", "bore"), [(100, 16), (210, 25), (350, 80)])
def test_all_joints_have_the_same_duty(pressure, bore) -> None:
    """Load cases, requirements, stroke, seals and supply are equal; force follows the area."""
    row = {"pressure": pressure, "bore": bore}
    designs = [_read(joint, row).design for joint in study.JOINTS]
    for block in ("supply", "cylinder", "load", "load_cases", "requirements", "environment"):
        assert all(getattr(one, block) == getattr(designs[0], block) for one in designs), block
    assert all(one.seals.piston == designs[0].seals.piston for one in designs)
    knee = ao.read(ROOT / "designs" / "knee.yaml").design
    ratio = 1e5 * pressure * pi / 4 * (1e-3 * bore) ** 2 / study.KNEE_FORCE
    assert designs[0].load_cases[0].force == pytest.approx(ratio * knee.load_cases[0].force)


def test_a_row_is_a_design_that_meets_its_limits(numbers) -> None:
    """The dimensions of each optimum, set in its design, give its mass and meet all limits."""
    rows = [numbers["rows"][k] for k in (0, -1)]
    for row in rows:
        for joint in study.masses(row):
            found = ao.evaluate(_read(joint, row).changed(row[joint]["values"]))
            assert found.metrics["mass"].value == pytest.approx(row[joint]["mass"], rel=1e-5)
            assert all(one.margin > -1e-5 for one in found.requirements)


def test_the_lightest_is_the_lightest(numbers) -> None:
    """Each row's winner has the least mass, and the sentences name every bore once."""
    for row in numbers["rows"]:
        found = study.masses(row)
        assert found[study.lightest(row)] == min(found.values())
    pressures = {row["pressure"] for row in numbers["rows"]}
    winners = {study.lightest(row) for row in numbers["rows"]}
    said = study.lead(numbers)
    for pressure in pressures:
        (sentence,) = (text for text in said if text.startswith(f"Lightest at {pressure} bar"))
        bores = [row["bore"] for row in numbers["rows"] if row["pressure"] == pressure]
        assert sorted(int(word) for word in re.findall(r"\d+(?=,| mm)", sentence)) == bores
    assert sum(text.startswith("Why ") for text in said) == len(winners)


def test_joints_that_replace_that_of_the_knee() -> None:
    """At the bore and pressure of the knee, its own joint is that of the file, without the nut."""
    knee = ao.read(ROOT / "designs" / "knee.yaml").design
    row = {"pressure": study.KNEE_PRESSURE, "bore": study.KNEE_BORE}
    for joint in study.JOINTS:
        design = _read(joint, row).design
        assert design.piston.nut is None
        assert not any("nut" in path for path in design.variables)
        assert design.retention.type == ("plug_thread" if joint == "sleeve" else joint)
        assert (design.retention.sleeve is not None) == (joint == "sleeve")
        own = {path for path in design.variables if path.startswith("retention.")}
        if joint in study.BLOCKS:
            assert own == {f"retention.{key}" for key in study.BLOCKS[joint][1]}
    plug = _read("sleeve", row).design
    assert plug.retention.length == pytest.approx(knee.retention.length)
    assert plug.retention.thread == knee.retention.thread
    assert {path for path in knee.variables if path.startswith("retention.")} == {
        path for path in plug.variables if path.startswith("retention.")
    }


def test_a_sleeve_saves_metal_between_the_ends() -> None:
    """At the knee's size, the liner between the sleeves is thinner than a tube with threads."""
    rows = {(row["pressure"], row["bore"]): row for row in carried(REPORT)["rows"]}
    row = rows[210, 20]
    liner = "barrel.layup[0].thickness"
    assert row["sleeve"]["values"][liner] < 0.5 * row["plug_thread"]["values"][liner]
    assert row["sleeve"]["parts"]["barrel"] < row["plug_thread"]["parts"]["barrel"]


def test_what_the_committed_map_shows() -> None:
    """Bonds win at little force, steel for stiffness; else plugs in a thicker liner."""
    rows = {(row["pressure"], row["bore"]): row for row in carried(REPORT)["rows"]}
    assert len(rows) == len(study.PRESSURES) * len(study.BORES)
    others = {(100, 80): "thread"} | dict.fromkeys(((100, b) for b in (16, 20, 25, 32)), "bond")
    for point, row in rows.items():
        assert study.lightest(row) == others.get(point, "sleeve")
