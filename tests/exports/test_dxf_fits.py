"""Fits, surfaces and threads in the notes of a drawing; dimensions in steps of a workshop."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest

import actuator_opt as ao
from actuator_opt.base.errors import InputError
from actuator_opt.exports import fits

DESIGNS = Path(__file__).parents[2] / "designs"


def test_tolerances_by_the_formulas_of_the_standard():
    """I = 0.45 D^(1/3) + 0.001 D [um], D in mm the geometric mean of the range's ends.

    IT7 = 16 i, IT8 = 25 i, and the upper deviation of f is 5.5 D^0.41, each rounded in the table.
    Up to 3 mm, the table has more than the formula.
    """
    lowest = (row[0] for row in fits.RANGES)
    for below, (largest, seventh, eighth, upper) in zip(lowest, fits.RANGES[1:], strict=False):
        mean = (below * largest) ** 0.5
        unit = 0.45 * mean ** (1 / 3) + 0.001 * mean
        assert seventh == pytest.approx(16 * unit, rel=0.05, abs=1.0)
        assert eighth == pytest.approx(25 * unit, rel=0.05, abs=1.0)
        assert -upper == pytest.approx(5.5 * mean**0.41, rel=0.06, abs=1.0)
    assert all(a[0] < b[0] and a[1] < b[1] for a, b in pairwise(fits.RANGES))


def test_a_size_on_a_limit_belongs_to_the_smaller_range():
    """18 mm has IT8 27 um, 18.1 mm 33 um; above 500 mm nothing is known."""
    assert fits.deviations(18e-3)[0][1] == pytest.approx(27e-6)
    assert fits.deviations(18.1e-3)[0][1] == pytest.approx(33e-6)
    with pytest.raises(ValueError, match="above 500 mm"):
        fits.deviations(0.6)


def test_notes_compare_the_fit_with_the_clearance_of_the_design():
    """H8/f7 at 21.5 mm leaves 10 to 37 um: 30 um fit, 60 um do not."""
    wide = {"piston.clearance": "60 um"}
    text, other = (
        " ".join(fits.notes(ao.evaluate(ao.read(DESIGNS / "knee.yaml", set=changes))))
        for changes in ({}, wide)
    )
    assert "Bore 22.3 H8 (0 / +0.033), piston and head f7 (-0.041 / -0.020)" in text
    assert "radial clearance 0.010 to 0.037 mm; the design has 0.03 mm." in text
    assert "the design has 0.06 mm, which needs another fit." in other
    assert "M10 x 1.25 - 6g" in text
    assert "RMS roughness at most 0.2 um" in text


@pytest.mark.long
def test_a_design_in_steps_of_a_workshop():
    """Every dimension is a multiple of its step, and the design still meets its limits."""
    found = ao.optimise(ao.read(DESIGNS / "steel_baseline.yaml"), prices=False, shop=True)
    rounding = found.rounding
    assert rounding is not None
    assert rounding.evaluation.met
    steps = {"mm": 0.1e-3, "%": 0.01}
    assert len(rounding.variables) == len(found.variables)
    for variable in rounding.variables:
        step = steps["%" if variable.path.endswith("squeeze") else "mm"]
        assert variable.value / step == pytest.approx(round(variable.value / step), abs=1e-6)


def test_nothing_to_round_is_said():
    """A design whose only variable is a pressure has no dimension to round."""
    text = (DESIGNS / "steel_baseline.yaml").read_text("utf-8")
    start, stop = text.index("variables:\n"), text.index("# The same requirements")
    only = "variables:\n  supply.pressure:\n    lower: 150 bar\n    upper: 250 bar\n\n"
    with pytest.raises(InputError, match="no variable is a length"):
        ao.optimise(ao.read(text[:start] + only + text[stop:]), prices=False, shop=True)
