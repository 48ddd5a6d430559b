"""The study of a rule of one's own: the width by hand, what it costs, a page of the numbers."""

from __future__ import annotations

from math import sqrt
from pathlib import Path
from typing import Any

import pytest
from script_loader import carried, ran_here, script, text_of
from shipped import shipped_mass

import actuator_opt as ao
from actuator_opt.optimisation.run import optimise

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "designs" / "scripts" / "knee_custom_constraint.py"
REPORT = ROOT / "reports" / "samples" / "knee_custom_constraint.pdf"

study = script("knee_custom_constraint")


@pytest.fixture(scope="module")
def quick(tmp_path_factory) -> tuple[str, Path]:
    """What the script prints and writes at few widths."""
    pytest.importorskip("typst")
    folder = tmp_path_factory.mktemp("reports")
    printed = ran_here("knee_custom_constraint", folder, "--quick", "--out", folder)
    return printed, folder / "knee_custom_constraint.pdf"


@pytest.fixture(params=[pytest.param("quick", marks=pytest.mark.long), "committed"])
def numbers(request) -> dict[str, Any]:
    """The numbers of a quick run, and those that the committed report carries inside."""
    return carried(request.getfixturevalue("quick")[1] if request.param == "quick" else REPORT)


def test_the_width_by_hand() -> None:
    """23 + 2 (0.6 + 1.2 + 0.8 + 1.5) = 31.2; pipe 23 sqrt(0.4/3.05) + 2 = 10.33; three gaps 4.5."""
    found = ao.evaluate(study.wishes()).metrics
    wanted = 31.2e-3 + 23e-3 * sqrt(0.4 / 3.05) + 2e-3 + 4.5e-3
    assert found["joint_width"].value == pytest.approx(wanted, rel=1e-12)
    assert found["turned_skirt"].value == pytest.approx(6 * 1.5 / 20 - 1, rel=1e-12)


def test_every_optimum_keeps_both_rules(numbers) -> None:
    """Set in the design again, each row meets width, skirt and every other requirement."""
    for row in (*study.points(numbers), numbers["after"]):
        assert row["status"] == "optimal"
        found = ao.evaluate(study.wishes(width=row["asked"], still=True).changed(row["values"]))
        assert found.metrics["mass"].value == pytest.approx(row["mass"], rel=1e-6)
        assert found.metrics["turned_skirt"].value > -1e-6
        assert all(one.margin > -1e-5 for one in found.requirements)  # seven digits
        if row["asked"] is not None:
            assert row["width"] == pytest.approx(row["asked"], rel=1e-6)
            assert "joint_width" in row["binds"]


def test_rules_cost_mass_and_less_room_costs_more(numbers) -> None:
    """No rule, the skirt's, the width's: heavier each time; convex along the widths."""
    before, free = numbers["before"]["mass"], numbers["free"]["mass"]
    assert before <= free * (1 + 1e-7)
    rows = study.points(numbers)
    masses, widths = [row["mass"] for row in rows], [row["width"] for row in rows]
    assert masses == sorted(masses)
    assert widths == sorted(widths, reverse=True)
    slopes = [
        (b - a) / (v - w)
        for a, b, v, w in zip(masses, masses[1:], widths, widths[1:], strict=False)
    ]
    assert slopes == sorted(slopes)


def test_the_price_is_a_slope(numbers) -> None:
    """The multiplier lies between the mean slopes to a width below and one above."""
    steep, flat = numbers["slopes"]
    assert steep < numbers["after"]["price"] < flat < 0


def test_without_the_rules_it_is_the_knee_as_shipped(numbers) -> None:
    """The optimum before is that of knee_bonded.yaml alone."""
    assert numbers["before"]["mass"] == pytest.approx(shipped_mass("knee_bonded"), rel=1e-6)


@pytest.mark.long
def test_narrower_than_the_least_is_no_knee() -> None:
    """Half a millimetre less than the least width: infeasible."""
    found = carried(REPORT)["least"]
    knee = study.wishes(width=found["width"] - 0.5e-3).changed(found["values"])
    tried = optimise(knee.subject(), starts=1, prices=False, explain=False)
    assert tried.status == "infeasible"


def test_the_page_says_the_numbers(numbers) -> None:
    """Sentences and masses of the sheet are those of the data, twice the same bytes."""
    pytest.importorskip("typst")
    pdf, sheets = study.page(numbers)
    assert study.page(numbers)[0] == pdf
    assert len(sheets) == 1
    words = text_of(pdf).replace("- ", "")
    for said in study.lead(numbers):
        assert said.replace("- ", "") in words
    for row in study.points(numbers):
        assert f"{1e3 * row['mass']:.1f}" in words


def test_the_committed_report_is_made_of_its_own_numbers() -> None:
    """The script makes the committed text of the attached numbers."""
    pytest.importorskip("typst")
    assert text_of(study.page(carried(REPORT))[0]) == text_of(REPORT.read_bytes())


@pytest.mark.long
def test_the_quick_run_prints_what_it_writes(quick) -> None:
    """Every sentence of the attached numbers is printed."""
    printed, pdf = quick
    for said in study.lead(carried(pdf)):
        assert said in printed
    assert pdf.with_suffix(".png").is_file()
