"""Compact lay-up notation: what it means, where its faults stand, how it is written back."""

from __future__ import annotations

from itertools import groupby

import pytest
from hypothesis import given, strategies as st

from actuator_opt.base.errors import InputError
from actuator_opt.design import get, read_design, with_values
from actuator_opt.design.layup import NotationFault, read_notation
from actuator_opt.design.writer import init_text, to_yaml

GOOD = init_text("test")
LIST_FORM = GOOD[GOOD.index("    - material: t700_epoxy     # hoop") : GOOD.index("\nrod:\n")]
"""Both wound layers of the start file: +-88 deg 1.2 mm, +-20 deg 0.8 mm."""
COMPACT = '    - material: t700_epoxy\n      plies: "%s"\n      ply_thickness: 0.2 mm\n'


def start_file(entries, variables=True):
    """The start file with other wound layers; without `variables` none of them is moved."""
    text = GOOD.replace(LIST_FORM, entries)
    if not variables:
        head, _, rest = text.partition("  barrel.layup[1].thickness:")
        text = head + rest[rest.index("  rod.outer_diameter:") :]
    return text


def layers(text, variables=False):
    """The barrel of the start file whose wound layers are one compact entry."""
    return read_design(start_file(COMPACT % text, variables)).design.barrel.layup


def faults(text, **options):
    """Every fault of a text."""
    with pytest.raises(InputError) as caught:
        read_design(text, **options)
    return caught.value.diagnostics


def plain(text):
    """Angle, balanced and plies of every layer of a notation."""
    return [(float(layer.angle), layer.balanced, layer.plies) for layer in read_notation(text)]


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("0", [(0, True, 1)]),
        ("-90", [(90, True, 1)]),
        ("25", [(25, False, 1)]),
        ("-25_3", [(-25, False, 3)]),
        ("+-25_2", [(25, True, 4)]),
        ("±25", [(25, True, 2)]),
        ("+/-25", [(25, True, 2)]),
        ("+25/-25", [(25, False, 1), (-25, False, 1)]),
        ("90_2/0", [(90, True, 2), (0, True, 1)]),
        ("[90/0]_3", [(90, True, 1), (0, True, 1)] * 3),
        ("[90/0]s", [(90, True, 1), (0, True, 2), (90, True, 1)]),
        ("[90/0]_2s", [(90, True, 1), (0, True, 1), (90, True, 1), (0, True, 2),
                       (90, True, 1), (0, True, 1), (90, True, 1)]),
        ("[88_4 / +-25_2 / 0]s", [(88, False, 4), (25, True, 4), (0, True, 2), (25, True, 4),
                                  (88, False, 4)]),
        ("[0/[45/-45]_2]s", [(0, True, 1), (45, False, 1), (-45, False, 1), (45, False, 1),
                             (-45, False, 2), (45, False, 1), (-45, False, 1), (45, False, 1),
                             (0, True, 1)]),
        ("90/90.0/+-90", [(90, True, 4)]),
        (" [ .5 _ 2 ] S ", [(0.5, False, 4)]),
    ],
)  # fmt: skip
def test_what_a_notation_means(text, meaning):
    """Signs, pairs, repeats, groups and mirrors, written out by hand."""
    assert plain(text) == meaning


ANGLES = st.sampled_from(["0", "90", "25", "45.5", "88", "5"])
PLIES = st.tuples(st.sampled_from(["", "+", "-", "+-", "±"]), ANGLES, st.integers(1, 4))
TREES = st.recursive(
    PLIES.map(lambda ply: ("ply", *ply)),
    lambda inner: st.tuples(
        st.just("group"),
        st.lists(inner, min_size=1, max_size=3),
        st.integers(1, 3),
        st.booleans(),
    ),
    max_leaves=6,
)


def spelled(tree):
    """A syntax tree as notation."""
    if tree[0] == "ply":
        _, sign, angle, count = tree
        return f"{sign}{angle}" + (f"_{count}" if count > 1 else "")
    _, items, count, mirrored = tree
    inside = " / ".join(map(spelled, items))
    return f"[{inside}]" + (f"_{count}" if count > 1 else "") + ("s" if mirrored else "")


def one_by_one(tree):
    """Every ply a syntax tree means, in order: (signed angle, balanced)."""
    if tree[0] == "ply":
        _, sign, angle, count = tree
        size = float(angle)
        if size in (0.0, 90.0):
            each = (size, True)
        else:
            each = (-size if sign == "-" else size, sign in ("+-", "±"))
        return [each] * count * (2 if sign in ("+-", "±") else 1)
    _, items, count, mirrored = tree
    plies = [ply for item in items for ply in one_by_one(item)] * count
    return plies + plies[::-1] if mirrored else plies


@given(st.lists(TREES, min_size=1, max_size=3))
def test_notation_round_trips(trees):
    """Any lay-up, spelled, is read back ply for ply; neighbours of one angle are one layer."""
    plies = [ply for tree in trees for ply in one_by_one(tree)]
    found = read_notation("/".join(map(spelled, trees)), most=10_000)
    again = [(float(x.angle), x.balanced) for x in found for _ in range(x.plies)]
    assert again == plies
    assert len(found) == len(list(groupby(plies)))


@given(st.text("0123456789.+-±/[]_sS ,x°", max_size=40) | st.text(max_size=20))
def test_any_text_is_layers_or_one_fault(text):
    """Nothing but layers within 90 degrees, or one fault at one of the text's characters."""
    fault, found = None, ()
    try:
        found = read_notation(text)
    except NotationFault as caught:
        fault = caught
    assert (fault is None) == bool(found)
    assert all(-90 <= float(layer.angle) <= 90 and layer.plies >= 1 for layer in found)
    if fault is not None:
        assert 0 <= fault.offset <= len(text)
        assert fault.message.isprintable()
        assert fault.remedy.isprintable()


@given(st.text("0123456789+-/[]_s ", max_size=20) | st.text(max_size=12).filter(str.isprintable))
def test_any_text_in_a_file_is_a_design_or_placed_faults(text):
    """Whatever stands for plies: a design, or faults at its line (too many layers: the list's)."""
    quoted = "'" + text.replace("'", "''") + "'"
    whole = start_file((COMPACT % "@").replace('"@"', quoted), variables=False)
    try:
        assert read_design(whole).design.barrel.layup[1:]
    except InputError as error:
        line = whole[: whole.index("plies: '")].count("\n") + 1
        for fault in error.diagnostics:
            assert fault.line == line or fault.path == "barrel.layup", str(fault)
            assert str(fault).splitlines()[0].isprintable()


def test_compact_equals_list_form():
    """The start file's wound layers in compact notation give bit for bit the same layers."""
    written_out = read_design(GOOD).design.barrel.layup
    compact = layers("+-88_3 / +-20_2", variables=True)
    assert [ply.ply_thickness for ply in compact] == [None, 2e-4, 2e-4]
    assert [(p.material, p.thickness, p.angle, p.balanced) for p in compact] == [
        (p.material, p.thickness, p.angle, p.balanced) for p in written_out
    ]


def test_paths_address_the_layers():
    """PATHs, --set and variables count the layers the notation means, and entries after it."""
    after = "    - material: al_6061_t6\n      thickness: 0.3 mm\n"
    text = start_file(COMPACT % "[90_2 / 30]s" + after)
    loaded = read_design(text, overrides=[("barrel.layup[2].angle", "-0.4")])
    design = loaded.design
    assert [ply.thickness for ply in design.barrel.layup] == [8e-4, 4e-4, 4e-4, 4e-4, 3e-4]
    assert get(design, "barrel.layup[2].angle") == -0.4
    assert get(design, "barrel.layup[4].material") == "al_6061_t6"
    assert design.variables["barrel.layup[2].thickness"].start == 4e-4


FAULTY = [
    # the value of plies, how far right of its first character the fault stands, its message
    ("90/deg", 3, '"deg" where a ply is expected'),
    ("90_0/45", 3, "0 repeats"),
    ("90_1.5", 3, "1.5 repeats"),
    ("90_/45", 3, '"/" where a number of repeats is expected'),
    ("90/+-91", 3, "91: outside the valid range"),
    ("90/-100", 3, "-100: outside the valid range"),
    ("0/[90/45", 2, 'this "[" is not closed'),
    ("0/90]", 4, '"]" where'),
    ("0//90", 2, '"/" where a ply is expected'),
    ("[]", 1, '"]" where a ply is expected'),
    ("90 45", 3, '"45" where a "/"'),
    ("90,45", 2, '"," where a "/"'),
    ("90/45s", 5, '"s" where a "/"'),
    ("90/", 3, "ends where a ply is expected"),
    ("90/+", 4, "ends where an angle is expected"),
    ("90/45°", 5, '"°" where a "/"'),
    ("[90/0]_20", 1, "more than 24 layers"),
    ("[" * 25 + "0", 20, "nested deeper"),
    ("0/" * 600 + "0", 0, "1201 characters"),
    ("90_1000", 3, "1000 repeats"),
]


@pytest.mark.parametrize(("text", "offset", "message"), FAULTY, ids=range(len(FAULTY)))
@pytest.mark.parametrize("quote", ['"', "'", ""])
def test_a_fault_stands_at_its_character(text, offset, message, quote):
    """Every fault of a notation is one line at the right column, however it is quoted."""
    if not quote and text.startswith("["):
        text, offset = f"0/{text}", offset + 2  # a bracket first would be a YAML list
    whole = start_file((COMPACT % "@").replace('"@"', quote + text + quote), variables=False)
    (fault,) = faults(whole)
    index = whole.index("plies: ") + len("plies: ") + len(quote) + offset
    assert fault.line == whole[:index].count("\n") + 1
    assert fault.column == index - whole.rindex("\n", 0, index)
    assert fault.path == "barrel.layup[1].plies"
    assert message in fault.message
    assert fault.remedy


ENTRIES = [
    # replaced in the entry, by what, and key, message, remedy of the single fault
    ("      ply_thickness: 0.2 mm\n", "", "ply_thickness", "missing", "0.2 mm"),
    ("ply_thickness: 0.2 mm", "ply_thickness: 0.2", "ply_thickness", "unit missing", "0.2 mm"),
    ("ply_thickness: 0.2 mm", "ply_thickness: 0 mm", "ply_thickness", "must be > 0", "0.01 mm"),
    ("ply_thickness: 0.2 mm", "ply_thickness:", "ply_thickness", "no value", "write one"),
    ("ply_thickness: 0.2 mm", "ply_thickness: [1]", "ply_thickness", "not a list", "0.2 mm"),
    ('"90/45"', "", "plies", "no value", "write one"),
    ('"90/45"', "[90/45]", "plies", "need a text, not a list", "quotes"),
    ('"90/45"', "{a: b}", "plies", "need a text, not a block", "quotes"),
    ('"90/45"', '""', "plies", "ends where a ply is expected", "write e.g."),
    ('"90/45"', '"90/45"\n      angle: 3 deg', "angle", "angle and plies", "keep one"),
    ('"90/45"', '"90/45"\n      thickness: 3 mm', "thickness", "thickness and plies", "keep one"),
    ('"90/45"', '"90/45"\n      balanced: no', "balanced", "balanced and plies", "keep one"),
    ("material: t700_epoxy", "material: t700_epox", "material", "unknown material", "t700_epoxy"),
    ("      ply_t", "      colour: red\n      ply_t", "colour", "unknown key", "plies"),
]


@pytest.mark.parametrize(("old", "new", "key", "message", "remedy"), ENTRIES, ids=range(14))
def test_a_faulty_entry_says_it_once(old, new, key, message, remedy):
    """What several layers share is said once, at its own place in the file."""
    entry = COMPACT % "90/45"
    assert entry.count(old) == 1
    whole = start_file(entry.replace(old, new))
    (fault,) = faults(whole)
    assert fault.path == f"barrel.layup[1].{key}"
    assert message in fault.message
    assert remedy in fault.remedy
    where = "material" if message == "missing" else key
    assert f"{where}:" in whole.splitlines()[fault.line - 1]


def test_a_misspelt_notation_is_recognised():
    """An entry with plys is an entry without thickness, and its key is close to plies."""
    found = faults(start_file((COMPACT % "90/45").replace("plies", "plys"), variables=False))
    assert [fault.path for fault in found] == ["barrel.layup[1].thickness", "barrel.layup[1].plys"]
    assert found[1].remedy == 'did you mean "plies"?'


def test_an_unquoted_bracket_says_so():
    """Brackets without quotes are a YAML list: the remedy is to quote the value."""
    text = start_file((COMPACT % "[90/0]s").replace('"', ""))
    (fault,) = faults(text)
    assert 'text after "]"' in fault.message
    assert "quotes" in fault.remedy
    assert text.splitlines()[fault.line - 1][fault.column - 1] == "s"


def test_an_alias_is_one_fault():
    """A refused alias is not reported a second time as a missing value."""
    text = start_file((COMPACT % "@").replace('"@"', "*x"), variables=False)
    assert [fault.message for fault in faults(text)] == ['alias "*x"']


def test_thickness_faults_point_at_the_angle():
    """A layer too thick for its quantity is reported at its angle in the notation."""
    text = start_file(COMPACT % "90 / 45_99", variables=False).replace("0.2 mm\n", "20 mm\n", 1)
    (fault,) = faults(text)
    assert fault.path == "barrel.layup[2].thickness"
    assert "1980 mm" in fault.message
    assert text.splitlines()[fault.line - 1][fault.column - 1 :].startswith("45_99")


def test_too_many_layers_in_all():
    """Entries that each fit but together exceed the list are refused at the list."""
    text = start_file(COMPACT % "[90/0]_6" * 3, variables=False)
    (fault,) = faults(text)
    assert fault.path == "barrel.layup"
    assert "keep at most 24" in fault.remedy


def test_an_unchanged_file_stays_as_it_is():
    """Writing a design that was only read keeps the compact notation, byte for byte."""
    loaded = read_design(start_file(COMPACT % "[90_2 / 30]s"))
    assert to_yaml(loaded.design, loaded.source) == loaded.source.text
    moved = with_values(loaded.design, {"cylinder.bore": 0.026})
    assert to_yaml(moved, loaded.source) == loaded.source.text.replace("bore: 25 mm", "bore: 26 mm")


@pytest.mark.parametrize("newline", ["\n", "\r\n"])
@pytest.mark.parametrize(
    "entry",
    [
        COMPACT % "[90_2 / 30]s",
        '    - {material: t700_epoxy, plies: "[90_2 / 30]s", ply_thickness: 0.2 mm}\n',
        "    -   plies: '[90_2/30]s'\n        ply_thickness: 200 um  # tow\n"
        "        material: t700_epoxy\n",
        "    - material: t700_epoxy\n      ply_thickness: 0.2 mm\n      plies: >-\n"
        "        [90_2 /\n        30]s\n",
    ],
    ids=["block", "flow", "indented", "folded"],
)
def test_a_changed_layer_is_written_in_list_form(entry, newline):
    """The layers then stand one by one; comments elsewhere stay; the text reads back exactly."""
    loaded = read_design(start_file(entry).replace("\n", newline))
    moved = with_values(loaded.design, {"barrel.layup[2].thickness": 1.2345e-3})
    text = to_yaml(moved, loaded.source)
    assert read_design(text).design == moved
    assert "plies" not in text
    assert "thickness: 1.2345 mm" in text or "thickness: 1234.5 um" in text
    assert "balanced: false" in text
    assert "# actuator-opt materials list" in text
    assert text.count("\r\n") == (text.count("\n") if newline == "\r\n" else 0)
    assert read_design(to_yaml(moved)).design == moved


def test_both_walls_of_an_actuator():
    """The rod's lay-up takes the same notation; places and PATHs of both are kept apart."""
    rod = (COMPACT % "[+-10_2 / 90]").replace("\n    ", "\n  ")[2:]
    text = start_file(COMPACT % "90/45x", variables=False).replace(
        "  inner_diameter: 4 mm         # 0 = solid\n", f"  layup:\n  {rod.lstrip()}"
    )
    text = text.replace("  rod.inner_diameter:\n    lower: 0 mm\n    upper: 16 mm\n", "")
    found = {fault.path for fault in faults(text)}
    assert found == {"barrel.layup[1].plies", "rod.fitting"}
    text = text.replace("90/45x", "90/45").replace(
        "  extension:",
        "  fitting:\n    adhesive: epoxy_structural\n    length: 20 mm\n  extension:",
        1,
    )
    loaded = read_design(text)
    assert [p.thickness for p in loaded.design.rod.layup] == [8e-4, 2e-4]
    assert [p.thickness for p in loaded.design.barrel.layup] == [8e-4, 2e-4, 2e-4]
    values = {"rod.layup[1].angle": "80 deg", "barrel.layup[2].angle": "40 deg"}
    moved = with_values(loaded.design, values)
    assert read_design(to_yaml(moved, loaded.source)).design == moved
