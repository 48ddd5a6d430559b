"""Numbers, units and margins as printed."""

import doctest

import pytest
from hypothesis import given, strategies as st

from actuator_opt.base import units
from actuator_opt.pages import optimum, section as drawing
from actuator_opt.rendering import axes as figures, blocks, console, ink, text


@pytest.mark.parametrize("module", [text, ink, console, drawing, figures, optimum])
def test_examples_in_docstrings_run(module):
    """Every example in the docstrings gives what it says."""
    assert doctest.testmod(module).failed == 0


@given(st.floats(min_value=1e-12, max_value=1e12), st.integers(min_value=1, max_value=6))
def test_a_printed_number_is_the_number(value, digits):
    """Reading a printed number back gives the value to the digits shown, sign included."""
    for signed in (value, -value):
        shown = text.plain(text.number(signed, digits)).replace(" ", "")
        assert float(shown) == pytest.approx(signed, rel=0.51 * 10.0 ** (1 - digits))


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (None, "–"),
        (float("nan"), "–"),
        (float("inf"), "∞"),
        (0.0, "0"),
        (-1.5, "−1.500"),
        (9999.6, "10\u202f000"),
        (123456.0, "123\u202f456"),
        (2.5e-7, "2.500×10⁻⁷"),
    ],
)
def test_special_numbers(value, shown):
    """Missing, infinite, negative, rounded-up, long and tiny numbers."""
    assert text.number(value) == shown


def test_every_unit_has_a_printed_form():
    """No caret, star or lone dash reaches the page, for any unit of any dimension."""
    for dimension in units.BASE:
        for unit in units.units_of(dimension):
            assert not set(text.unit_text(unit)) & set("^*")
            assert text.unit_text(unit) != "-"


def test_a_miss_never_reads_as_zero():
    """A margin that misses by little shows its digit; one within tolerance reads 0.0 %."""
    assert text.margin_text(-2e-4, met=False) == "−0.02 %"
    assert text.margin_text(-5e-7, met=True) == "0.0 %"
    assert text.margin_text(25.0) == "> +999 %"


@given(st.text(max_size=60))
def test_plain_text_is_ascii(words):
    """The ASCII fallback never emits anything else."""
    assert text.plain(words).isascii()


@given(st.text(max_size=80))
def test_soft_breaks_lose_no_letter(words):
    """Splitting a long word for line breaks keeps every letter in order."""
    pieces = blocks.soft(words)
    joined = pieces if isinstance(pieces, str) else "".join(pieces)
    assert joined == blocks.clean(words)


def test_paths_break_behind_their_separators_alone():
    """No name of a PATH is cut while a column has room for it; an index stays with its name."""
    assert blocks.soft("materials.steel_42crmo4.youngs_modulus", 22) == [
        "materials.", "steel_42crmo4.", "youngs_modulus",
    ]  # fmt: skip
    assert blocks.soft("barrel.layup[2].thickness", 20) == ["barrel.", "layup[2].", "thickness"]
    assert blocks.soft("load_cases[swing].force", 20) == ["load_cases[", "swing].", "force"]
    assert blocks.soft("retention_burst_factor", 18) == ["retention_", "burst_", "factor"]


def test_control_characters_become_code_points():
    """An escape sequence or a direction override in a name is printed, not obeyed."""
    assert blocks.clean("a\x1b[31mb\u202ec") == "a⟨U+001B⟩[31mb⟨U+202E⟩c"


def test_letters_outside_the_typeface_become_code_points():
    """Letters that the typeface cannot draw are named; technical signs stay."""
    assert blocks.printable("中 Ω ≥ é ✔") == "⟨U+4E2D⟩ Ω ≥ é ✔"
