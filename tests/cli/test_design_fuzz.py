"""Whatever the file: a design, or faults with places; never a traceback, never a hang."""

from __future__ import annotations

import json
import re
import time

import pytest
from fuzz import WORDS as ODD
from hypothesis import given, strategies as st

from actuator_opt.base.errors import InputError
from actuator_opt.design import read_design
from actuator_opt.design.writer import init_text
from actuator_opt.design.yaml_source import parse


class Names(dict):
    """Any material is known, of no kind that fits."""

    names = dict.keys
    kind = dict.get

    def meanings(self, kinds=()):
        """No entry has a meaning."""
        return {}


GOOD = init_text("test")
LINES = GOOD.splitlines(keepends=True)
BREAK = re.compile("\r\n|[\n\r\x85\u2028\u2029]")
"""Line breaks of YAML 1.1."""
CODE = [index for index, line in enumerate(LINES) if line.split("#")[0].strip()]


def outcome(text, **options):
    """A design or its faults; the faults have the file, and print as one line each."""
    faults = []
    try:
        read_design(text + "\n", materials=Names(), **options)
    except InputError as error:
        faults = error.diagnostics
        refused = True
    else:
        refused = False
    assert bool(faults) == refused
    lines = BREAK.split(text + "\n")
    for fault in faults:
        assert fault.file is not None
        assert str(fault).splitlines()[0].isprintable()
        assert fault.to_dict()["message"]
        if fault.line is not None and fault.source is not None:
            assert lines[fault.line - 1].replace("\t", " ") == fault.source


@given(st.lists(st.tuples(st.sampled_from(CODE), st.sampled_from(ODD)), min_size=1, max_size=4))
def test_odd_values(changes):
    """Any value replaced by any odd one."""
    lines = list(LINES)
    for index, odd in changes:
        key = lines[index].split(":")[0] if ":" in lines[index] else lines[index].rstrip()
        lines[index] = f"{key}: {odd}\n"
    outcome("".join(lines))


@given(
    st.lists(
        st.tuples(
            st.sampled_from(["drop", "double", "swap", "indent", "dedent", "cut"]),
            st.sampled_from(CODE),
            st.sampled_from(CODE),
        ),
        min_size=1,
        max_size=3,
    )
)
def test_shuffled_lines(changes):
    """Lines dropped, doubled, swapped, moved in or out, cut in the middle."""
    lines = list(LINES)
    for what, first, second in changes:
        if what == "drop":
            lines[first] = ""
        elif what == "double":
            lines[first] *= 2
        elif what == "swap":
            lines[first], lines[second] = lines[second], lines[first]
        elif what == "indent":
            lines[first] = "  " + lines[first]
        elif what == "dedent":
            lines[first] = lines[first].removeprefix("  ")
        else:
            lines[first] = lines[first][: len(lines[first]) // 2] + "\n"
    outcome("".join(lines))


@given(st.integers(0, len(GOOD)), st.text(max_size=5), st.integers(0, 20))
def test_random_characters(position, inserted, removed):
    """Any characters typed anywhere over the file."""
    outcome(GOOD[:position] + inserted + GOOD[position + removed :])


TREES = st.recursive(
    st.sampled_from(ODD),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from(
                [
                    "name",
                    "cylinder",
                    "bore",
                    "barrel",
                    "layup",
                    "plies",
                    "ply_thickness",
                    "thickness",
                    "balanced",
                    "allowed_angles",
                    "fitting",
                    "variables",
                    "min",
                    "requirements",
                    "mass",
                    "objective",
                    "minimise",
                    "load_cases",
                    "seals",
                    "rod",
                    "cylinder.bore",
                    "lower",
                    "position",
                    "lines",
                    "materials",
                    "x",
                ]
            ),
            inner,
            max_size=4,
        )
    ),
    max_leaves=12,
)


@given(
    st.dictionaries(
        st.sampled_from(
            [
                "name",
                "cylinder",
                "barrel",
                "rod",
                "variables",
                "seals",
                "lines",
                "requirements",
                "objective",
                "load_cases",
                "materials",
                "waivers",
                "retention",
                "y",
            ]
        ),
        TREES,
        max_size=5,
    )
)
def test_any_tree(tree):
    """Blocks, lists and texts where others belong, in flow style."""

    def flow(node):
        if isinstance(node, dict):
            return "{" + ", ".join(f"'{key}': {flow(value)}" for key, value in node.items()) + "}"
        if isinstance(node, list):
            return "[" + ", ".join(map(flow, node)) + "]"
        return "'" + node.replace("'", "''").replace("\t", " ") + "'"

    outcome("\n".join(f"{key}: {flow(value)}" for key, value in tree.items()))


PATHS = [
    "cylinder.bore",
    "barrel.layup[1].angle",
    "barrel.layup[1].balanced",
    "rod.layup[0].thickness",
    "barrel.allowed_angles[0]",
    "rod.fitting.length",
    "load_cases[0].position",
    "requirements.mass.max",
    "variables.rod.extension.lower",
    "objective.minimise",
    "materials.a.density",
    "waivers.mass",
    "lines[0].chamber",
    "retention.thread.pitch",
    "environment.temperature_min",
    "name",
    "x",
    "barrel.layup",
    "load_cases[9].force",
    "cylinder..bore",
    "objective.minimise.mass",
]


LAYERS = st.lists(
    st.dictionaries(
        st.sampled_from(["material", "plies", "ply_thickness", "angle", "thickness", "balanced"]),
        st.sampled_from([*ODD, "0.2 mm"]) | st.text("0123456789+-/[]_s ", max_size=12),
        max_size=5,
    ),
    max_size=4,
)


@given(LAYERS, LAYERS)
def test_any_layers(barrel, rod):
    """Any entries for the walls of barrel and rod, compact or not, among good and bad ones."""

    def block(entries):
        quoted = ({key: json.dumps(value) for key, value in item.items()} for item in entries)
        lines = (", ".join(f"{key}: {value}" for key, value in item.items()) for item in quoted)
        return "".join(f"    - {{{line}}}\n" for line in lines)

    outcome(
        GOOD.replace(
            "    - material: al_6061_t6 ", block(barrel) + "    - material: al_6061_t6 "
        ).replace("  extension: 25 mm", "  layup:\n" + block(rod) + "  extension: 25 mm")
    )


@given(st.lists(st.tuples(st.sampled_from(PATHS), st.sampled_from(ODD)), max_size=3), st.booleans())
def test_odd_overrides(overrides, whole):
    """Any --set over a whole file, or over one that lacks what it names."""
    outcome(GOOD if whole else "cylinder: 3\nbarrel: [x]\nlines: y\n", overrides=overrides)


@pytest.mark.parametrize(
    "text",
    [
        "a: " + "[" * 50_000,
        "{" * 50_000,
        "a: '" + "1" * 500_000 + "\n x'",
        "\n".join(f"k{i}: 1" for i in range(20_000)),
        "variables:\n" + "\n".join(f"  cylinder.bor{i}: {{lower: 1 mm}}" for i in range(4_000)),
        "load_cases:\n" + "\n".join(f"  - name: c{i}" for i in range(4_000)),
        "- " * 60_000,
        "a: " + "&a " * 1000,
        "x" * 900_000,
        "? " * 60_000,
        "barrel:\n  layup:\n" + "    - {plies: '[90/0]_12', ply_thickness: 1 mm}\n" * 3_000,
        f"barrel:\n  layup:\n    - plies: '{'[' * 100_000}'\n",
    ],
    ids=range(12),
)
def test_large_nonsense_is_refused_quickly(text):
    """Files made to be slow are refused in about a second."""
    start = time.perf_counter()
    outcome(text)
    assert time.perf_counter() - start < 5


def test_parse_is_total_on_bytes_of_control_characters():
    """Every character below 256 in a value is read or refused with its place."""
    placed = []
    for code in range(256):
        try:
            parse(f"a: b{chr(code)}c\n", "f")
        except InputError as error:
            placed.append(error.diagnostics[0].line)
    assert len(placed) >= 60  # the control characters, C0 and C1
    assert None not in placed
