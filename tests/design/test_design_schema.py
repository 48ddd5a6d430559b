"""The JSON Schema agrees with the reader: what one takes the other takes."""

from __future__ import annotations

import json
import re

import pytest
import yaml

from actuator_opt.base import quantities, units
from actuator_opt.base.errors import InputError
from actuator_opt.design import read_design
from actuator_opt.design.build import build
from actuator_opt.design.kinds import EXAMPLES, ValueFault, example, read_quantity
from actuator_opt.design.model import Design
from actuator_opt.design.schema import json_schema, quantity_schema
from actuator_opt.design.structure import entries
from actuator_opt.design.writer import init_text
from actuator_opt.design.yaml_source import parse
from actuator_opt.metrics import METRICS

jsonschema = pytest.importorskip("jsonschema")
SCHEMA = json_schema()
VALIDATOR = jsonschema.Draft7Validator(SCHEMA)
GOOD = init_text("test")


def faults(text):
    """Faults an editor would show: its YAML reader, then the schema."""
    return list(VALIDATOR.iter_errors(yaml.safe_load(text)))


def test_is_a_draft_07_schema():
    """The schema is itself valid and plain JSON."""
    jsonschema.Draft7Validator.check_schema(SCHEMA)
    json.dumps(SCHEMA)


def test_start_file_passes():
    """The start file has no fault, neither for the schema nor for the reader."""
    assert faults(GOOD) == []
    assert build(parse(GOOD, "f").data).design is not None


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("  bore: 25 mm", "  bore: 25"),
        ("  bore: 25 mm", "  bore: 25 bar"),
        ("  bore: 25 mm", "  bore: -25 mm"),
        ("  bore: 25 mm", "  boar: 25 mm"),
        ("  bore: 25 mm", "  bore: [25 mm]"),
        ("  mount: cap_clevis ", "  mount: cap_clewis "),
        ("  cylinder.bore:", "  cylinder.bor:"),
        ("  cylinder.bore:", "  rod.material:"),
        ("    upper: 40 mm", "    uper: 40 mm"),
        ("    upper: 40 mm", "    upper: 40 bar"),
        ("  seal_gap:", "  seal_gab:"),
        ("    max: 80 um", "    max: 80 kN"),
        ("  minimise: mass", "  minimise: mas"),
        ("  minimise: mass", "  minimise: mass\n  maximise: mass"),
        ("    force: 1 kN", "    force: 1 kN\n    position: 50 bar"),
        ("    tolerance: 0.05 mm\n  rod:", "    tolerance: 0.05 mm\n    count: 1.5\n  rod:"),
    ],
)
def test_bad_lines_fail_in_editor_and_reader(old, new):
    """What the reader refuses shows in the editor."""
    text = GOOD.replace(old, new)
    assert text != GOOD
    assert faults(text)
    assert build(parse(text, "f").data).faults


HOOP = (
    "      angle: 88 deg            # from the tube axis; a balanced +- pair\n"
    "      thickness: 1.2 mm"
)
COMPACT = '      plies: "[88_4 / +-25_2 / 0]s"\n      ply_thickness: 0.2 mm'


def test_compact_lay_up_passes_both():
    """Editor and reader take a list entry in compact notation, and each of its spellings."""
    assert GOOD.count(HOOP) == 1
    for text in ('"[88_4 / +-25_2 / 0]s"', "88_4/±25", "90", "'[90/0]_3'"):
        compact = GOOD.replace(HOOP, COMPACT.replace('"[88_4 / +-25_2 / 0]s"', text))
        assert faults(compact) == []
        assert read_design(compact).design


@pytest.mark.parametrize(
    "entry",
    [
        '      plies: "90/0"',
        COMPACT + "\n      angle: 3 deg",
        COMPACT + "\n      thickness: 3 mm",
        COMPACT + "\n      balanced: false",
        COMPACT.replace("88_4", "88x4"),
        COMPACT.replace("0.2 mm", "0.2 bar"),
        "      ply_thickness: 0.2 mm",
        HOOP.split("\n")[1] + "\n      balanced: maybe",
    ],
)
def test_bad_layers_fail_in_editor_and_reader(entry):
    """What the reader refuses of a layer or of several in one entry shows in the editor."""
    text = GOOD.replace(HOOP, entry)
    assert faults(text)
    with pytest.raises(InputError):
        read_design(text)


@pytest.mark.parametrize(
    "lines",
    [
        "  allowed_angles: [0 deg, 45 deg]\n  criterion: hashin\n",
        "  autofrettage_pressure: 400 bar\n",
        "  model: layered\n",
    ],
)
def test_options_of_the_barrel_pass_both(lines):
    """The barrel's options are offered and taken."""
    text = GOOD.replace(
        "  model: auto                  # isotropic for one metal layer, else layered\n", lines
    )
    assert text != GOOD
    assert faults(text) == []
    assert read_design(text).design


@pytest.mark.parametrize("word", ["true", "no", "off", "False"])
def test_yes_or_no_passes_both(word):
    """An editor reads no as a boolean or a text; both are offered."""
    text = GOOD.replace("environment:\n", f"environment:\n  wet: {word}\n")
    assert faults(text) == []
    assert read_design(text).design


@pytest.mark.parametrize(
    "line",
    ["bore: 0.025 m", "bore: 25mm", "bore: '25 mm'", "bore: 2.5e1 mm", "bore: 1 inch",
     "bore: 25 mm\n  dead_volume_a: 2 cm3", "bore: 25 mm\n  dead_volume_a: 2 cm^3",
     "bore: 25 mm\n  dead_volume_a: 2 cm³", "bore: 25 mm\n  dead_volume_a: 0",
     "bore: 25 mm\n  mount_stiffness: 50 kN/mm"],
)  # fmt: skip
def test_every_spelling_of_a_unit_passes_both(line):
    """Units may be written as people write them."""
    text = GOOD.replace("bore: 25 mm", line)
    assert faults(text) == []
    assert build(parse(text, "f").data).design is not None


TABLES = {**quantities.MATERIAL_PROPERTIES, **quantities.INPUTS}


@pytest.mark.parametrize("quantity", TABLES.values(), ids=list(TABLES))
def test_pattern_takes_each_unit_and_the_reader_too(quantity):
    """The pattern of a quantity takes a value in each of its units, and no foreign unit."""
    schema = quantity_schema(quantity)
    pattern = re.compile(schema["pattern"])
    assert pattern.search(example(quantity))
    assert read_quantity(example(quantity), quantity) >= quantity.lower
    for name in units.units_of(quantity.dimension):
        assert pattern.search(f"1.5 {name}")
        assert units.parse(f"1.5 {name}", quantity.dimension) is not None
    for text in ("1.5 parsec", "nan", "one", "1,5 mm", "", "1..5"):
        assert not pattern.search(text)
        with pytest.raises((ValueFault, units.UnitError)):
            read_quantity(text, quantity)


def test_examples_are_of_input_quantities():
    """No example is left over from a quantity that is gone."""
    assert set(EXAMPLES) <= set(quantities.INPUTS | quantities.SCENARIOS)


def walk(node, path=()):
    """Every object of a JSON value with where it stands."""
    if isinstance(node, dict):
        yield path, node
        for key, value in node.items():
            yield from walk(value, (*path, key))
    elif isinstance(node, list):
        for index, value in enumerate(node):
            yield from walk(value, (*path, index))


def test_hover_and_completion():
    """Every quantity shows label, range, units and an example; objects refuse unknown keys."""
    for path, node in walk(SCHEMA):
        if "patternErrorMessage" in node:
            assert "Range: " in node["description"], path
            assert "Units: " in node["description"], path
            assert node["examples"]
        if node.get("type") == "object" and "properties" in node:
            assert node["additionalProperties"] is False, path
    bore = SCHEMA["properties"]["cylinder"]["properties"]["bore"]
    assert "2 mm to 1000 mm" in bore["description"]
    assert "cylinder.bore" in SCHEMA["properties"]["variables"]["properties"]
    mass = SCHEMA["properties"]["requirements"]["properties"]["mass"]
    assert mass["title"] == METRICS["mass"].label


def test_every_key_of_the_model_is_in_the_schema():
    """Sections, required keys and choices are those of the model."""
    assert list(SCHEMA["properties"]) == list(entries(Design))
    mounts = SCHEMA["properties"]["cylinder"]["properties"]["mount"]["enum"]
    assert mounts == list(entries(entries(Design)["cylinder"].section)["mount"].choices)


def choice_count(section=Design):
    """How many choices the model has."""
    found = entries(section).values()
    below = sum(choice_count(entry.section) for entry in found if entry.section is not None)
    return below + sum(entry.shape == "choice" for entry in found)


def test_every_choice_says_what_each_word_means():
    """Whoever hovers over a choice reads what it decides, then the meaning of every word of it."""
    found = [
        (path, node)
        for path, node in walk(SCHEMA)
        if all(isinstance(word, str) for word in node.get("enum", [1]))
        and "enumDescriptions" not in node  # metrics, each with its label
    ]
    assert len(found) == choice_count()
    for path, node in found:
        words = "|".join(node["enum"])
        what, *said = re.split(rf"; ({words}): ", node["description"])
        assert len(what.split()) >= 3, path
        assert said[::2] == node["enum"], path
        meanings = said[1::2]
        assert all(meanings), path
        assert len(set(meanings)) == len(meanings), path


def test_material_names_are_offered_by_role():
    """With a library, each place offers the names that can stand there."""

    class Names(dict):
        names = dict.keys
        kind = dict.get

    schema = json_schema(materials=Names(oil="fluid", nbr="seal", steel="metal", glue="adhesive"))
    properties = schema["properties"]
    assert properties["fluid"]["properties"]["material"]["enum"] == ["oil"]
    assert properties["rod"]["properties"]["material"]["enum"] == ["steel"]
    assert properties["seals"]["properties"]["rod"]["properties"]["compound"]["enum"] == ["nbr"]
