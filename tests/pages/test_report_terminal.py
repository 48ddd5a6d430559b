"""Text for the terminal: fits, is plain where it must be, and obeys no control codes."""

import re
from dataclasses import replace

import numpy as np
import pytest
import report_fixture as fixture

from actuator_opt.pages import report, stiffness
from actuator_opt.rendering import terminal
from actuator_opt.rendering.console import Console, visible

PLAIN = {"colour": False, "unicode": True}
SUBJECTS = {
    "evaluation": lambda **s: fixture.shown(fixture.build_evaluation(), **s),
    "optimisation": lambda **s: fixture.shown(fixture.build_optimisation(), **s),
    "infeasible": lambda **s: fixture.shown(fixture.build_infeasible(), **s),
    "prices": lambda **s: terminal.text(
        report.prices_page(fixture.build_optimisation()), **PLAIN | s
    ),
}


@pytest.mark.parametrize("subject", SUBJECTS)
@pytest.mark.parametrize("width", [80, 100, 160])
def test_lines_fit_the_terminal(subject, width):
    """No line is wider than the terminal."""
    lines = SUBJECTS[subject](width=width).splitlines()
    assert [line for line in lines if visible(line) > width] == []


@pytest.mark.parametrize("subject", SUBJECTS)
def test_ascii_stream_gets_ascii(subject):
    """Without Unicode every character is ASCII."""
    assert SUBJECTS[subject](unicode=False, width=100).isascii()


@pytest.mark.parametrize("subject", SUBJECTS)
def test_colour_only_adds_codes(subject):
    """Colour changes no text and no alignment; without it there is no escape code."""
    plain = SUBJECTS[subject](width=100)
    coloured = SUBJECTS[subject](width=100, colour=True)
    stripped = re.sub(r"\x1b\[[\d;]*m", "", coloured)
    assert "\x1b" not in plain
    assert "\x1b" in coloured
    assert [s.rstrip() for s in stripped.splitlines()] == [s.rstrip() for s in plain.splitlines()]


def test_evaluation_shows_values_limits_and_what_is_missing():
    """Value with unit, limit, margin and case in one line; a null metric with its reason."""
    shown = fixture.shown(fixture.build_evaluation())
    line = next(x for x in shown.splitlines() if x.startswith("push_force"))
    assert line.split()[:8] == ["push_force", "9.894", "kN", "≥", "6", "kN", "+64.9", "%"]
    assert "stance" in line
    assert "line_velocity: the design has no lines" in shown
    assert "damping_pipe (!)" in shown


def test_missed_requirements_are_named_first():
    """The verdict names what is missed."""
    row = replace(fixture.requirements()[2], met=False, margin=-0.2)
    shown = fixture.shown(fixture.build_evaluation(requirements=(row,)))
    assert "requirements missed" in shown
    assert "missed: stiffness_min" in shown


def test_terminal_escapes_in_names_are_shown_not_sent():
    """A design name cannot colour, clear or retitle the terminal."""
    evaluation = fixture.build_evaluation("bad\x1b]0;owned\x07\nname")
    shown = fixture.shown(evaluation)
    assert "\x1b" not in shown
    assert "⟨U+001B⟩]0;owned⟨U+0007⟩ name" in shown


@pytest.mark.parametrize(
    ("margin", "bar"),
    [
        (0.0, "     │     "),
        (1.0, "     │█████"),
        (5.0, "     │█████"),
        (-1.0, "█████│     "),
        (0.5, "     │██▌  "),
        (-0.5, "  ▐██│     "),
        (-0.01, "    ▕│     "),
    ],
)
def test_margin_bar(margin, bar):
    """Room grows to the right, a miss to the left; every bar is as wide as another."""
    assert Console().margin_bar(margin) == bar
    assert len(Console(unicode=False).margin_bar(margin)) == 11


def drawn(evaluation, *, unicode=True, width=100):
    """Lines of the curve of stiffness over the stroke."""
    console = Console(False, unicode, width)
    return terminal.block_text(stiffness.stiffness_blocks(evaluation)[0], console).splitlines()


@pytest.mark.parametrize("unicode", [True, False])
def test_curve_is_a_u_with_its_requirement(unicode):
    """The lowest drawn line is in the middle of the stroke; the limit stands at its level."""
    lines = drawn(fixture.build_evaluation(), unicode=unicode, width=60)
    assert "minimum 10.00 at 59.8 mm, required 10" in lines[10]
    assert lines[7].startswith("10.0")
    curve_marks = [i for i, c in enumerate(lines[1]) if c in "*" or "\u2801" <= c <= "\u28ff"]
    assert curve_marks[0] < 12


def test_flat_and_broken_curves_are_left_out():
    """A constant or non-finite curve gives no plot instead of a fault."""
    curve = fixture.curve()
    broken = replace(curve, stiffness=np.full(len(curve.position), np.nan))
    assert drawn(fixture.build_evaluation(curve=broken)) == []
    flat = replace(curve, stiffness=np.full(len(curve.position), 1e7))
    assert "minimum 10.00" in " ".join(drawn(fixture.build_evaluation(curve=flat)))
