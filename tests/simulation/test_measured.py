"""The table `measured` of a design: bounds that a test record gave, kept with the design."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import pytest

import actuator_opt as ao
from actuator_opt.design import with_values
from actuator_opt.design.schema import json_schema
from actuator_opt.design.writer import to_yaml
from actuator_opt.pages import report as page

KNEE = (Path(__file__).parents[2] / "designs" / "knee_bonded.yaml").read_text(encoding="utf-8")
PATH = "seals.piston.friction_coefficient"


def entry(path=PATH, lower="0.09", upper="0.11", record="bench.csv"):
    """A design with one measured value."""
    said = {"lower": lower, "upper": upper, "record": record}
    lines = [f"    {key}: {value}" for key, value in said.items() if value is not None]
    return "\n".join([KNEE, "measured:", f"  {path}:", *lines, ""])


def fault(text):
    """The only fault of a text."""
    with pytest.raises(ao.InputError) as caught:
        ao.read(text)
    (one,) = caught.value.diagnostics
    return one


def test_bounds_are_read_in_the_unit_of_their_path():
    """Bounds become SI by the quantity of their PATH."""
    found = ao.read(entry("seals.rod.viscous_friction", "10 N*s/m", "0.02 kN*s/m")).design.measured
    one = found["seals.rod.viscous_friction"]
    assert (one.lower, one.upper, one.record) == (10.0, 20.0, "bench.csv")


@pytest.mark.parametrize("kept", [True, False])
def test_a_written_design_reads_back(kept):
    """The table survives writing, beside comments and without them."""
    actuator = ao.read(entry())
    text = to_yaml(actuator.design, actuator.source if kept else None)
    assert ao.read(text).design == actuator.design
    assert ("# " in text) == kept


def test_bounds_are_settable_by_path():
    """A bound has a PATH of its own; its value is held to be in order."""
    design = ao.read(entry()).design
    moved = with_values(design, {f"measured.{PATH}.upper": 0.12})
    assert moved.measured[PATH].upper == 0.12
    with pytest.raises(ao.InputError, match="bounds reversed"):
        with_values(design, {f"measured.{PATH}.upper": 0.05})


@pytest.mark.parametrize(
    ("changes", "message", "remedy"),
    [
        ({"path": "seals.piston.friction_coeff"}, "unknown PATH", PATH),
        ({"path": "seals.piston.compound"}, "is not a numeric input of the actuator", "remove"),
        ({"path": "seals.rod.stribeck_speed", "lower": "1 mm/s", "upper": "2 mm/s"},
         "is not set", "set it"),
        ({"lower": "0.2"}, "bounds reversed: upper 0.11 is below lower 0.2", "swap"),
        ({"lower": "3 mm"}, "3 mm", ""),
        ({"upper": None}, "missing", 'add "upper'),
        ({"record": None}, "missing", 'add "record'),
        ({"path": "load_cases[stance].spead", "lower": "1 m/s", "upper": "2 m/s"},
         "unknown PATH", "load_cases[stance].speed"),
    ],
)  # fmt: skip
def test_faults_are_one_line_at_their_place(changes, message, remedy):
    """A wrong PATH, reversed or missing bounds, a wrong unit: said at the line."""
    found = fault(entry(**changes))
    assert message in found.message
    assert remedy in found.remedy
    assert found.line is not None
    assert found.line > KNEE.count("\n")


def test_a_value_beyond_its_bounds_is_said():
    """Who changes a measured value learns that the record does not support it."""
    inside, outside = (ao.evaluate(ao.read(entry(), set={PATH: v})) for v in (0.1, 0.2))
    assert not any("bench.csv" in words for words in inside.warnings)
    said = [words for words in outside.warnings if "bench.csv" in words]
    assert said == [
        f"{PATH}: 0.2 is outside the bounds from bench.csv, 0.09 to 0.11: the test record does not "
        "support this value"
    ]


def test_the_report_names_the_record():
    """The data sheet of the report holds value, bounds and record."""
    block = page.assumptions(ao.evaluate(ao.read(entry())))
    row = next(row for row in block.rows if "bench.csv" in row)
    assert "0.100 (0.0900 to 0.110)" in "".join(row[1])


def test_the_schema_knows_the_table():
    """An editor accepts a good table and marks one without its record."""
    schema = json_schema()
    good = {PATH: {"lower": "0.09", "upper": "0.11", "record": "bench.csv"}}
    table = {**schema["properties"]["measured"], "definitions": schema["definitions"]}
    editor = jsonschema.Draft7Validator(table)
    editor.validate(json.loads(json.dumps(good)))
    for broken in ({PATH: {"lower": "0.1", "upper": "0.2"}}, {"seals.x": good[PATH]}):
        with pytest.raises(jsonschema.ValidationError):
            editor.validate(broken)
