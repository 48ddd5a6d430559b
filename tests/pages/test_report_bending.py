"""The terminal text of a bending test: fits, in ASCII, with the numbers of the JSON."""

from __future__ import annotations

import re

import numpy as np
import pytest

from actuator_opt.identification.bending import Specimen, bending
from actuator_opt.identification.record import Record
from actuator_opt.pages import bending as document
from actuator_opt.rendering import terminal

BAR = {"span": 0.3, "outer_diameter": 0.02, "inner_diameter": 0.016}
KNOWN = {"shear_modulus": 26e9, "local_compliance": 1e-7, "expected_modulus": 205e9}


def a_test(*, cycles=2, name="bend.csv", noise=2.0, **specimen):
    """Loading and unloading with friction of a tenth of the force."""
    once = np.linspace(0.0, 1.2e-3, 150)
    w = np.concatenate([once, once[::-1]] * cycles)
    way = np.repeat(np.tile([1.1, 0.9], cycles), 150)
    force = 5e5 * w * way + noise * np.random.default_rng(0).standard_normal(w.size)
    channels = {"w": w, "F_L": force}
    return bending(Record(0.01 * np.arange(w.size), channels, name), Specimen(**BAR, **specimen))


def bending_text(bending, *, colour=False, unicode=True, width=100):
    """Its text for the terminal."""
    return terminal.text(document.page(bending), colour=colour, unicode=unicode, width=width)


CASES = {
    "known": a_test(**KNOWN),
    "plain": a_test(cycles=1),
    "long name": a_test(name="a-very-long-name-of-a-record-of-a-bending-test-\u819d.csv"),
    "no upper bound": a_test(local_compliance=1.98e-6, noise=40.0),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("width", [40, 60, 100])
@pytest.mark.parametrize("unicode", [False, True])
def test_every_line_fits(case, width, unicode):
    """No line is longer than the terminal, no word of the table is cut."""
    told = bending_text(CASES[case], unicode=unicode, width=width)
    assert max(map(len, told.splitlines())) <= width
    assert "modulus, no compliance subtracted" in " ".join(told.split()).lower()
    assert "\x1b" not in told
    assert unicode or told.isascii()


def test_colour_is_bold_and_dim_alone():
    """In colour the words are the same."""
    told = bending_text(CASES["known"], colour=True)
    assert "\x1b[" in told
    assert re.sub(r"\x1b\[\d+m", "", told) == bending_text(CASES["known"])


@pytest.mark.parametrize("width", [40, 100])
def test_numbers_are_those_of_the_json(width):
    """Slope in kN/mm, moduli in GPa, with bounds, to four digits; shares to 0.1 %."""
    found = CASES["known"]
    plain, told = found.to_dict(), bending_text(found, unicode=False, width=width)
    words = " ".join(told.split())
    for key, unit, size in (
        ("slope", "kN/mm", 1e-6), ("modulus", "GPa", 1e-9), ("modulus_as_published", "GPa", 1e-9)
    ):  # fmt: skip
        for bound in ("value", "lower", "upper"):
            shown = [float(one) for one in re.findall(rf"([\d.]+) {unit}", words)]
            value = size * plain[key][bound]
            assert any(one == pytest.approx(value, rel=1e-3) for one in shown)
    assert f"{plain['cycles']} cycles lose {100 * plain['hysteresis']:.1f} %" in words
    assert f"shear deflection is {100 * plain['shear_share']:.1f} %" in words.lower()
    assert f"{plain['samples']} samples" in words
    for doubt in plain["doubts"]:
        assert doubt.lower() in words.lower()


def test_one_cycle_is_one():
    """A single cycle is not told as cycles, and what is not known is not told."""
    told = " ".join(bending_text(CASES["plain"]).split())
    assert "The cycle loses" in told
    assert "Shear deflects" not in told
    assert "dents taken off:" not in told
