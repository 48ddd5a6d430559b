"""The study of the flight control actuator's ends: equal load cases, masses that can be checked."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml
from script_loader import ran, script

import actuator_opt as ao

ROOT = Path(__file__).parents[2]

study = script("aerospace_ends")


def read(joint: str) -> ao.Actuator:
    """The design of the study with this joint."""
    return ao.read(yaml.safe_dump(study.stated(joint), sort_keys=False))


def test_all_ends_have_the_duty_of_the_shipped_design() -> None:
    """Only joint, thickness of the liner and static seals differ; the variables are its own."""
    shipped = ao.read(ROOT / "designs" / "aerospace.yaml").design
    for joint in study.ENDS:
        design = read(joint).design
        for block in ("supply", "load_cases", "requirements", "environment", "rod", "caps"):
            assert getattr(design, block) == getattr(shipped, block), block
        assert design.seals.piston == shipped.seals.piston
        assert (design.seals.static is None) == (joint == "bond")
        sleeved = joint == "sleeve"
        assert design.retention.type == ("plug_thread" if sleeved else joint)
        assert (design.retention.sleeve is not None) == sleeved
        own = {path for path in design.variables if path.startswith("retention")}
        others = {path for path in shipped.variables if not path.startswith("retention")}
        assert set(design.variables) - own == others
        assert len(own) == (1 if joint == study.STATED else len(study.ENDS[joint][2]))


def test_rows_and_sentences_of_numbers() -> None:
    """Groups add up to the mass; the lightest, its lead, and what has no design are named."""
    parts = {"barrel": 0.3, "rod": 0.2, "piston": 0.04, "caps": 0.1, "glands": 0.05,
             "seals": 0.01, "fastening": 0.05, "clevises": 0.05}  # fmt: skip
    heavy = parts | {"fastening": 0.25}
    rows = {
        "tie_rods": {"mass": 1.0, "parts": heavy, "binds": ["buckling_factor"]},
        "bond": {"mass": None, "why": "no bond is strong enough"},
        "plug_thread": {"mass": 0.8, "parts": parts, "binds": ["cycle_life (thread root)"]},
    }
    numbers = {"version": "0", "rows": rows}
    groups = study.grouped(parts)
    assert groups == pytest.approx({"barrel": 0.3, "rod": 0.2, "ends": 0.2, "rest": 0.1})
    table = study.mass_rows(numbers)
    assert table[2] == ["bonded caps", "none", "–", "–", "–", "no bond is strong enough"]
    assert table[3][1:] == ["800", "300", "200", "200", "cycle_life (thread root)"]
    assert study.lead(numbers) == [
        "Lightest: screwed plugs, 800 g.",
        "They save 20 % of the actuator between tie rods.",
        "No design meets all requirements with: bonded caps.",
    ]
    assert len(study.drawing(numbers).text_boxes()) == 2 * 2 + len(study.PARTS)


@pytest.mark.long
def test_the_script_as_a_person_runs_it(tmp_path) -> None:
    """Screwed plugs are at least 10 % lighter than tie rods; their sizes give this mass again."""
    out, report = ran("aerospace_ends", tmp_path)
    assert report.exists()
    assert "Lightest: screwed plugs" in out
    numbers = study.compute(quick=True)["rows"]
    for joint, row in numbers.items():
        data = study.stated(joint)
        del data["variables"]  # rounded values can be outside the bounds
        fixed = ao.read(yaml.safe_dump(data, sort_keys=False))
        found = ao.evaluate(fixed.changed(row["values"]))
        assert found.metrics["mass"].value == pytest.approx(row["mass"], rel=1e-5)
        assert all(one.margin > -1e-4 for one in found.requirements)
    assert numbers["plug_thread"]["mass"] < 0.9 * numbers["tie_rods"]["mass"]
