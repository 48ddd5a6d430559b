"""YAML to a tree of texts with places: nothing guessed, nothing grown, every fault placed."""

from __future__ import annotations

import pytest

from actuator_opt.base.errors import InputError
from actuator_opt.design.yaml_source import MAX_BYTES, MAX_DEPTH, MAX_NODES, decode, parse


def fault(text: str):
    """The one fault of a text that cannot be read."""
    with pytest.raises(InputError) as caught:
        parse(text, "f.yaml")
    return caught.value.diagnostics[-1]


@pytest.mark.parametrize(
    "written", ["no", "yes", "on", "off", "12:30", "017", "1e5", "0x1F", "1_000", ".nan", ".inf",
                "2024-01-31", "~", "null", "true", "=", "<"]
)  # fmt: skip
def test_scalars_stay_text(written):
    """Every YAML 1.1 trap (boolean, sexagesimal, octal, date, float, null) stays what was typed."""
    assert parse(f"a: {written}\n", "f").data == {"a": written}


def test_empty_value_is_none_and_quoted_empty_is_text():
    """A key without a value differs from a quoted empty text."""
    assert parse("a:\nb: ''\n", "f").data == {"a": None, "b": ""}


def test_places_are_lines_columns_and_characters():
    """Each value's span cuts exactly its text out of the file, also behind µ and under CRLF."""
    text = "µ: 1 mm  # c\r\nb:\r\n  - c: 'x y'\r\n    d: [1, {e: 2 µm}]\r\n"
    document = parse(text, "f")
    cut = {
        loc: text[span.start : span.end]
        for loc, span in document.values.items()
        if span.end > span.start
    }
    assert cut[("µ",)] == "1 mm"
    assert cut[("b", 0, "c")] == "'x y'"
    assert cut[("b", 0, "d")] == "[1, {e: 2 µm}]"
    assert cut[("b", 0, "d", 1, "e")] == "2 µm"
    assert document.values[("b", 0, "d", 1, "e")][:2] == (4, 16)
    assert document.keys[("b", 0, "d")][:2] == (4, 5)


SYNTAX = [
    # text, line, column, part of the message: read off the text by eye
    ("a: b: c\n", 1, 5, '":" that does not fit'),
    ("a:\n\tb: 1\n", 2, 1, "tab in the indentation"),
    ('a: 1\nb: "x\nc: 2\n', 2, 4, "quote is not closed"),
    ("a: [1, 2\nb: 3\n", 1, 4, "bracket is not closed"),
    ("a: {b: 1\n", 1, 4, "bracket is not closed"),
    ("a: 1\n  b: 2\n", 2, 4, '":" that does not fit'),
    ("a: 1\nbcd\nc: 2\n", 2, 1, 'a key without ":"'),
    ("a: @x\n", 1, 4, '"@" cannot start a value'),
    ("a: %x\n", 1, 4, '"%" cannot start a value'),
    ("a: `x`\n", 1, 4, '"`" cannot start a value'),
    ("- a\nb: 1\n", 2, 1, "key among list entries"),
    ("a: 1\n---\na: 2\n", 2, 1, "second document"),
    ("", 1, 1, "empty"),
    ("# only a comment\n", 1, 1, "empty"),
    ("- a\n- b\n", 1, 1, "not a design"),
    ("just a text\n", 1, 1, "not a design"),
    ("a: \x07\n", 1, 4, "control character U+0007"),
    ("a: \ud800\n", 1, 4, "control character U+D800"),
    ("ok: 1\nb: \x00", 2, 4, "control character U+0000"),
    ("{a: 1}}\n", 1, 7, "after the end"),
]


@pytest.mark.parametrize(("text", "line", "column", "message"), SYNTAX)
def test_syntax_faults_have_place_and_remedy(text, line, column, message):
    """A broken file says what is wrong, where, and what to do, in words of the design file."""
    found = fault(text)
    assert (found.line, found.column) == (line, column)
    assert message in found.message
    assert found.remedy


def test_duplicate_keys_name_both_places():
    """A key given twice is refused with both places; the rest is still read."""
    document = parse("a: 1\nb:\n  c: 1\n  d: 2\n  c: 3\n", "f")
    (found,) = document.faults
    assert (found.line, found.column) == (5, 3)
    assert "first at line 3, column 3" in found.message
    assert document.data == {"a": "1", "b": {"c": "1", "d": "2"}}


def test_content_below_a_duplicate_key_is_skipped():
    """The block of a repeated key neither replaces nor mixes with the first."""
    document = parse("a:\n  b: 1\na:\n  b: 2\n  c: [1, {d: 2}]\ne: 3\n", "f")
    assert document.data == {"a": {"b": "1"}, "e": "3"}
    assert len(document.faults) == 1


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("a: &x 1\nb: *x\n", 'alias "*x"'),
        ("a: &x 1\n", 'anchor "&x"'),
        ("a: !!python/object/apply:os.system [x]\n", "tag"),
        ("a: !!int 12\n", "tag"),
        ("a: {<<: 1}\n", "merge keys"),
        ("? [1, 2]\n: x\nb: 1\n", "a key must be one word"),
        ("? {a: 1}\n: x\n", "a key must be one word"),
        ("*x : 1\n", "a key must be one word"),
    ],
)
def test_yaml_machinery_is_refused(text, part):
    """Anchors, aliases, tags, merge keys and composite keys are faults with a place."""
    document = parse(text, "f")
    assert any(part in found.message and found.line for found in document.faults)


def test_alias_bomb_does_not_grow():
    """A billion-laughs file is refused without being expanded."""
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 10)]
    document = parse("\n".join(lines) + "\n", "f")
    assert sum("alias" in found.message for found in document.faults) == 81
    assert all(len(items) == 9 for items in document.data.values())


def test_limits_of_size_and_depth():
    """Deep nesting, very many values and very large files stop early with a reason."""
    assert "nested deeper" in fault("a: " + "[" * (MAX_DEPTH + 5)).message
    assert "nested deeper" in fault("a: " + "[" * 100_000).message
    assert "more than" in fault("a: [" + "1," * (MAX_NODES + 5) + "]").message
    assert "larger than" in fault("a: " + "x" * (MAX_BYTES + 1)).message
    with pytest.raises(InputError, match="larger than"):
        decode(b"x" * (MAX_BYTES + 1), "f")


def test_encodings():
    """UTF-8 with or without a byte-order mark is read; anything else is refused with its place."""
    assert decode("a: 1 µm".encode("utf-8-sig"), "f") == "a: 1 µm"
    with pytest.raises(InputError, match="UTF-16"):
        decode("a: 1".encode("utf-16"), "f")
    with pytest.raises(InputError) as caught:
        decode(b"a: 1\nb: \xb5m", "f")
    (found,) = caught.value.diagnostics
    assert (found.line, found.column) == (2, 4)
    assert "0xb5" in found.message
