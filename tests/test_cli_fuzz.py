"""The knee design mutated at random through `check` and `evaluate`: never a traceback."""

from __future__ import annotations

import os
import re

import pytest
from cli_runner import KNEE, run
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

TEXT = KNEE.read_text(encoding="utf-8")
LINES = TEXT.splitlines(keepends=True)
VALUE = re.compile(r"^(\s*(?:- )?[\w.\[\]]+: )(\S.*?)(\s*(?:#.*)?\n)$")
VALUES = [index for index, line in enumerate(LINES) if VALUE.match(line) and ">-" not in line]
NUMBER = re.compile(r"-?\d+(\.\d+)?")
ODD = [
    "0", "-1 mm", "1e300 mm", ".nan", ".inf", "nan mm", "~", "no", "{}", "[]", "[1, 2]", "x",
    "1e-300 mm", "12:30", "017 mm", "25 mm mm", "25 µm", "%", "worst", "50 %", "t700_epoxy",
    "steel_42crmo4", "iso_vg_46", "nbr_70", "epoxy_structural", "guide_acetal", "thread",
    "tie_rods", "as_published", "isotropic", "head_flange", "external", "pull", "chord", "ruess",
    "100 degC", "-100 degC", "90 deg", "1 m", "20 m", "0 mm", "1500 bar", "20 m/s", "20 MN", "8",
    "&a 1", "*a", "!!int 1", "'", "|", "- a", "a: b", '"\\ud800"', "99 %", "mass", "leakage",
    "line_velocity", "stiffness_min",
]  # fmt: skip
FACTORS = [0.0, 1e-9, 1e-3, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1.01, 1.1, 1.5, 2.0, 4.0, 10.0, 1e3, 1e9]
MANY = int(os.environ.get("FUZZ_EXAMPLES", "12"))
QUICK = settings(max_examples=MANY, deadline=None, suppress_health_check=list(HealthCheck))


def survives(text):
    """`check` and `evaluate` answer a text, agree on it, and leave valid JSON."""
    data = text.encode("utf-8", "surrogatepass")
    checked = run("check", "-", "--json", stdin=data)
    assert checked.code in (0, 3)
    assert (checked.code == 3) == bool(checked.json["errors"])
    result = run("evaluate", "-", "--json", stdin=data)
    if result.code == 3:
        assert checked.code == 3
        assert result.errors
        return
    assert result.code in (0, 1)
    answer = result.json
    assert (result.code == 0) == all(row["met"] for row in answer["requirements"])
    for name, metric in answer["metrics"].items():
        assert (metric["value"] is None) == bool(metric.get("why")), name
    if result.code == 0 and not answer["warnings"]:
        return
    shown = run("evaluate", "-", stdin=data)
    assert (shown.code, shown.err) == (result.code, "")


def replaced(changes):
    """The text with values replaced by line."""
    lines = list(LINES)
    for index, value in changes:
        before, _, after = VALUE.match(LINES[index]).groups()
        lines[index] = before + value + after
    return "".join(lines)


@QUICK
@given(
    st.lists(st.tuples(st.sampled_from(VALUES), st.sampled_from(ODD)), min_size=1, max_size=3),
)
def test_odd_values(changes):
    """Any value replaced by any odd one."""
    survives(replaced(changes))


@QUICK
@given(
    st.lists(st.tuples(st.sampled_from(VALUES), st.sampled_from(FACTORS)), min_size=1, max_size=4),
)
def test_scaled_numbers(changes):
    """Any number scaled: most of these are designs, if bad ones."""
    scaled = []
    for index, factor in changes:
        value = VALUE.match(LINES[index])[2]
        number = NUMBER.search(value)
        if number is not None:
            value = value.replace(number[0], repr(float(number[0]) * factor), 1)
        scaled.append((index, value))
    survives(replaced(scaled))


@QUICK
@given(
    st.lists(
        st.tuples(
            st.sampled_from(["drop", "double", "swap", "indent", "cut"]),
            st.sampled_from(VALUES),
            st.sampled_from(VALUES),
        ),
        min_size=1,
        max_size=3,
    )
)
def test_shuffled_lines(changes):
    """Lines dropped, doubled, swapped, moved in and cut."""
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
        else:
            lines[first] = lines[first][: len(lines[first]) // 2] + "\n"
    survives("".join(lines))


@pytest.mark.parametrize("name", re.findall(r"^(\w+):", TEXT, re.MULTILINE))
def test_without_a_block(name):
    """The design without each of its blocks."""
    start = re.search(rf"^{name}:", TEXT, re.MULTILINE).start()
    end = re.search(r"^\w", TEXT[start + 1 :], re.MULTILINE)
    survives(TEXT[:start] + (TEXT[start + 1 + end.start() :] if end else ""))
