"""The study of joints over pressure and bore: equal duty, masses that can be evaluated again."""

from __future__ import annotations

from math import pi
from pathlib import Path
from typing import Any

import pytest
import yaml
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
    text = yaml.safe_dump(study.scaled(joint, row["pressure"], row["bore"]), sort_keys=False)
    return ao.read(text)


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
    assert len(study.lead(numbers)) == len(pressures) + len(study.RULES)


def test_what_the_committed_map_shows() -> None:
    """Bonds win small at 100 bar, steel large; plugs win everywhere at 210 and 350 bar."""
    rows = {(row["pressure"], row["bore"]): row for row in carried(REPORT)["rows"]}
    assert study.lightest(rows[100, 16]) == "bond"
    assert study.lightest(rows[100, 80]) == "thread"
    for (pressure, _), row in rows.items():
        if pressure > 100:
            assert study.lightest(row) in ("retaining_ring", "plug_thread")
