"""Values out of all proportion: each has a number that fires, and no shipped design fires."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from cli_runner import run

import actuator_opt as ao
from actuator_opt.evaluation import proportions

DESIGNS = Path(__file__).parents[2] / "designs"
LINES = """lines:
  - {chamber: a, material: steel_e355, inner_diameter: 6 mm, outer_diameter: 8 mm, length: 1 m}
"""
TEXT = (DESIGNS / "steel_baseline.yaml").read_text("utf-8").replace("load:\n", f"{LINES}load:\n")
FREE = TEXT[: TEXT.index("variables:\n")] + TEXT[TEXT.index("# The same requirements") :]
"""The steel knee with a line and nothing to move: its caps screwed on, its pins of clevises."""

RINGS = (
    FREE[: FREE.index("retention:\n")]
    + "retention:\n  type: retaining_ring\n  material: steel_bolt_12_9\n  length: 4 mm\n"
    "  groove_depth: 0.5 mm\n  ring_thickness: 1 mm\n  ring_width: 2 mm\n\n"
    + FREE[FREE.index("clevis:\n") :]
)
"""The same with its ends held by rings."""

FIRES = {
    ("cylinder.dead_volume_a", "volume"): {"cylinder.dead_volume_a": "100 l"},
    ("cylinder.dead_volume_b", "volume"): {"cylinder.dead_volume_b": "1 l"},
    ("lines", "volume"): {
        "lines[0].length": "20 m",
        "lines[0].inner_diameter": "30 mm",
        "lines[0].outer_diameter": "40 mm",
    },
    ("rod.outer_diameter", "bore"): {"cylinder.bore": "500 mm"},
    ("second_rod.outer_diameter", "bore"): {
        "cylinder.type": "double_rod", "cylinder.mount": "cap_flange",
        "second_rod.outer_diameter": "2 mm", "second_rod.inner_diameter": "0 mm",
    },
    ("clevis.pin_diameter", "bore"): {"cylinder.bore": "500 mm"},
    ("rod.thread.diameter", "bore"): {"cylinder.bore": "500 mm"},
    ("cylinder.port_diameter", "bore"): {"cylinder.port_diameter": "22 mm"},
    ("cylinder.stroke", "bore"): {"cylinder.stroke": "1 mm"},
    ("barrel.layup", "wall"): {"barrel.layup[0].thickness": "60 mm"},
    ("supply.pressure", "hoop"): {"cylinder.bore": "500 mm"},
    ("supply.return_pressure", "supply"): {"supply.return_pressure": "150 bar"},
    ("supply.proof_ratio", "supply"): {"supply.proof_ratio": "5"},
    ("piston.clearance", "bore"): {"piston.clearance": "0.3 mm"},
    ("head.clearance", "rod"): {"head.clearance": "0.3 mm"},
    ("piston.length", "bore"): {"piston.length": "140 mm"},
    ("head.length", "bore"): {"head.length": "140 mm"},
    ("caps.thickness", "bore"): {"caps.thickness": "50 mm"},
    ("rod.extension", "stroke"): {"rod.extension": "1200 mm"},
    ("barrel.length", "head"): {"barrel.length": "1 m"},
    ("cylinder.stop_travel", "stroke"): {"cylinder.stop_travel": "30 mm"},
    ("seals.piston", "groove"): {"cylinder.bore": "500 mm"},
    ("seals.rod", "groove"): {"seals.rod.section": "7 mm", "cylinder.bore": "60 mm"},
    ("retention.wall", "bore"): {"retention.wall": "20 mm"},
    ("retention.length", "bore"): {"cylinder.bore": "500 mm"},
    ("retention.length", "turns"): {"retention.length": "4 mm"},
    ("retention.length", "groove depth"): {"retention.length": "15 mm"},
    ("retention.ring_width", "groove depth"): {"retention.ring_width": "0.6 mm"},
    ("load.mass", "load"): {"load.mass": "500 t"},
    ("load_cases", "strokes"): {"load_cases[stance].speed": "0.0001 mm/s"},
    ("fluid.temperature", "oil"): {"fluid.temperature": "-90 degC"},
    ("environment", "lowest"): {
        "environment.temperature_min": "-90 degC", "environment.temperature_max": "250 degC",
    },
}  # fmt: skip
"""For every proportion, by its PATH and a word of it, changes of the steel knee that fire it."""


def said(text, changes=None):
    """What is out of proportion in a design."""
    subject = ao.read(text, set=changes or {}).subject()
    return list(proportions.warnings(subject, subject.values()))


def rows(path, word):
    """The proportions of a PATH whose words hold a word."""
    return [row for row in proportions.TABLE if row.path == path and word in row.meaning]


def test_every_proportion_has_a_number_that_fires():
    """The table of this test and the program's name the same rows."""
    assert [len(rows(*key)) for key in FIRES] == [1] * len(FIRES)
    assert len(FIRES) == len(proportions.TABLE)


@pytest.mark.parametrize("key", FIRES, ids=" ".join)
def test_a_slip_is_told(key):
    """The PATH, the number, the range and its source are in the sentence; nothing is refused."""
    (row,) = rows(*key)
    text = RINGS if key[1] == "groove depth" else FREE
    (sentence,) = [
        one for one in said(text, FIRES[key]) if one.startswith(row.path) and row.meaning in one
    ]
    assert row.source in sentence
    assert "check its unit" in sentence


@pytest.mark.parametrize("path", sorted(DESIGNS.glob("*.yaml")), ids=lambda p: p.stem)
def test_shipped_designs_are_in_proportion(path):
    """No shipped design draws a warning."""
    assert said(path) == []
    assert said(FREE) == []


def test_the_number_is_the_ratio():
    """100 l on a 40 ml cylinder: 100e-3/(pi/4 0.023^2 0.11) = 2190 times."""
    (sentence,) = said(FREE, {"cylinder.dead_volume_a": "100 l"})
    assert "it is 2190 times the swept volume of the piston; at most 1 is usual " in sentence


def test_check_evaluate_and_optimise_tell():
    """`check` succeeds and warns, in text and JSON; `evaluate` and `optimise` warn as well."""
    knee = str(DESIGNS / "knee_bonded.yaml")
    slip = ("--set", "cylinder.dead_volume_a=100 l")
    told = run("check", knee, *slip)
    assert told.code == 0
    assert "warning: cylinder.dead_volume_a is out of proportion" in told.err
    found = json.loads(run("check", knee, *slip, "--json").out)
    assert found["errors"] == []
    assert [one["file"] for one in found["warnings"]] == [knee]
    scene = str(DESIGNS / "scenarios" / "knee_step.yaml")
    assert "out of proportion" in run("check", scene, *slip).err
    assert json.loads(run("check", knee, "--json").out) == {"errors": []}
    text = found["warnings"][0]["message"]
    asked = {"cylinder.dead_volume_a": "100 l"}
    assert text in ao.evaluate(ao.read(knee, set=asked)).warnings
    quick = "variables:\n  caps.thickness:\n    lower: 4 mm\n    upper: 12 mm\n\n"
    small = f"{quick}{FREE[: FREE.index('requirements:')]}objective: {{minimise: mass}}\n"
    best = ao.optimise(ao.read(small, set=asked), starts=1)
    assert any("dead_volume_a is out of proportion" in one for one in best.evaluation.warnings)
