"""Designs back to text: the same numbers bit for bit, comments kept where there were any."""

from __future__ import annotations

import random

import pytest
from hypothesis import given, strategies as st

from actuator_opt.base import quantities, units
from actuator_opt.design import FileSource, LoadedDesign, read_design, with_values
from actuator_opt.design.build import build
from actuator_opt.design.paths import numbers
from actuator_opt.design.writer import exact_text, init_text, scalar, to_yaml
from actuator_opt.design.yaml_source import parse


class Names(dict):
    """A material library reduced to names and kinds."""

    names = dict.keys
    kind = dict.get


MATERIALS = Names(
    iso_vg_32="fluid", al_6061_t6="metal", al_7075_t6="metal", ti_6al4v="metal",
    steel_42crmo4="metal",
    steel_e235="metal", t700_epoxy="ply", nbr_70="seal", epoxy_structural="adhesive",
)  # fmt: skip
TEXT = init_text("test")
MOVED = {
    "cylinder.bore": 0.0271234567891234,
    "barrel.layup[1].angle": 0.9,
    "barrel.layup[2].thickness": 1 / 3e3,
    "environment.temperature_min": 250.123456789,
    "rod.thread.pitch": "1.25 mm",
    "requirements.seal_gap.max": 7.7e-5,
}
ADDED = {
    "requirements.mass.max": 1.5,
    "load_cases[swing].temperature": 333.15,
    "barrel.length": 0.16,
    "materials.t700_epoxy.density": 1600.0,
}


def load(text):
    """A text as a design with its places, material names unchecked."""
    document = parse(text, "f")
    built = build(document.data)
    assert built.design is not None, built.faults
    return LoadedDesign(built.design, FileSource(document))


def test_unchanged_design_gives_the_same_text():
    """Writing a design that was only read changes no byte."""
    loaded = load(TEXT)
    assert to_yaml(loaded.design, loaded.source) == TEXT


@pytest.mark.parametrize("values", [MOVED, ADDED, MOVED | ADDED])
@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_written_design_reads_back_bit_for_bit(values, newline):
    """Edited text and text written anew both give exactly the design; comments and units stay."""
    loaded = load(TEXT.replace("\n", newline))
    design = with_values(loaded.design, values)
    edited = to_yaml(design, loaded.source)
    assert load(edited).design == design
    assert load(to_yaml(design)).design == design
    comments = [line for line in TEXT.splitlines() if "#" in line]
    kept = sum(line.split("#")[1] in edited for line in comments)
    assert kept == len(comments)
    assert edited.count("\r\n") == (edited.count("\n") if newline == "\r\n" else 0)


def test_only_changed_lines_change():
    """One moved value changes one line, in the unit it was written in."""
    loaded = load(TEXT.replace("length: 0.2 m", "length: 20 cm", 1))
    design = with_values(loaded.design, {"lines[0].length": 0.25})
    before = loaded.source.text.splitlines()
    after = to_yaml(design, loaded.source).splitlines()
    assert [(a, b) for a, b in zip(before, after, strict=True) if a != b] == [
        ("    length: 20 cm", "    length: 25 cm")
    ]


def test_flow_style_is_edited_too():
    """Values inside { } are replaced in place; a key to be added has the text written anew."""
    text = TEXT.replace("  cylinder.bore:\n    lower: 18 mm\n    upper: 40 mm",
              "  cylinder.bore: {lower: 18 mm, upper: 40 mm}  # free")  # fmt: skip
    loaded = load(text)
    moved = with_values(loaded.design, {"variables.cylinder.bore.upper": 0.05})
    edited = to_yaml(moved, loaded.source)
    assert "{lower: 18 mm, upper: 50 mm}  # free" in edited
    started = with_values(loaded.design, {"variables.cylinder.bore.start": 0.02})
    assert load(to_yaml(started, loaded.source)).design == started


def test_removed_values_are_written_anew():
    """A design without a block its text has is written anew, without that block."""
    loaded = load(TEXT)
    design = loaded.design.model_copy(update={"clevis": None, "lines": ()})
    again = load(to_yaml(design, loaded.source)).design
    assert again.clevis is None
    assert again == design


QUANTITIES = [*quantities.INPUTS.values(), *quantities.MATERIAL_PROPERTIES.values()]


@given(st.sampled_from(QUANTITIES), st.floats(0, 1), st.randoms(use_true_random=False))
def test_exact_text_of_every_quantity_and_unit(quantity, share, chance):
    """A number in range, written in any unit of its quantity, is read back bit for bit.

    A share of the stroke must carry its %, which not every number has to the last bit.
    """
    value = quantity.lower + share * (quantity.upper - quantity.lower)
    if quantity.dimension == "count":
        value = float(round(value))
    unit = chance.choice([None, *units.units_of(quantity.dimension)])
    found = units.parse(exact_text(value, quantity, unit), quantity.dimension)
    if quantity.name == "fraction":
        assert found == pytest.approx(value, rel=3e-16)
    else:
        assert found == value


def test_random_designs_read_back():
    """Designs with every free dimension anywhere in its bounds survive writing bit for bit."""
    chance = random.Random(1)
    loaded = load(TEXT)
    for _ in range(20):
        values = {
            path: chance.uniform(bounds.lower, bounds.upper)
            for path, bounds in loaded.design.variables.items()
            if path not in ("rod.outer_diameter", "rod.inner_diameter")
        }
        values["cylinder.bore"] = max(values["cylinder.bore"], 0.022)
        design = with_values(loaded.design, values)
        again = load(to_yaml(design, loaded.source)).design
        assert numbers(again) == numbers(design)


@given(st.text(min_size=1, max_size=30).filter(lambda text: text.strip() and text.isprintable()))
def test_any_name_survives(name):
    """A design of any printable name is read back under that name."""
    text = init_text(name)
    assert build(parse(text, "f").data).design.name == name
    assert parse(f"a: {scalar(name)}\n", "f").data == {"a": name}


def test_notes_keep_their_lines():
    """Free text of several lines is kept, as a block or written anew."""
    text = TEXT.replace("name: test\n", "name: test\nnotes: |\n  one\n  two: 2\n")
    loaded = load(text)
    assert loaded.design.notes == "one\ntwo: 2\n"
    assert to_yaml(loaded.design, loaded.source) == text
    assert load(to_yaml(loaded.design)).design == loaded.design


def test_what_the_start_file_offers_as_comments_is_valid():
    """Valve, ports, loop and frequency stand commented out; uncommented they are valid."""
    text = init_text("offered")
    lines = text.splitlines()
    first = lines.index(next(line for line in lines if line.startswith("# valve:")))
    last = lines.index("", first)
    body = [line[2:] if first <= i < last else line for i, line in enumerate(lines)]
    body = [f"  {line[2:]}" if line.startswith("#   frequency") else line for line in body]
    design = load("\n".join(body)).design
    assert design.valve is not None
    assert (design.ports.end, design.control.gain) == ("valve", 500.0)
    assert design.load_cases[0].frequency == 20.0


def test_init_from_a_design():
    """`init --from` keeps text and comments and changes the name."""
    loaded = load(TEXT)
    text = init_text("other: one", loaded)
    assert text == TEXT.replace("name: test", "name: 'other: one'")
    assert load(init_text("other", loaded.design)).design.name == "other"


def test_overrides_are_written():
    """What --set changed stands in the written file; the rest of the text stays."""
    loaded = read_design(
        TEXT,
        overrides=[("cylinder.bore", "0.03"), ("rod.material", "al_7075_t6")],
        materials=MATERIALS,
    )
    edited = to_yaml(loaded.design, loaded.source)
    assert load(edited).design == loaded.design
    assert "  bore: 30 mm\n" in edited
    assert "entrained air" in edited
