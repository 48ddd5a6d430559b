"""The study of what the knee's seals cost: feasible optima, prices, closed forms, and a page."""

from __future__ import annotations

import re
from math import pi, sqrt
from pathlib import Path
from typing import Any

import pytest
from script_loader import carried, ran, script, text_of

import actuator_opt as ao

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "designs" / "scripts" / "knee_seals.py"
REPORT = ROOT / "reports" / "samples" / "knee_seals.pdf"

study = script("knee_seals")


@pytest.fixture(scope="module")
def quick(tmp_path_factory) -> tuple[str, Path]:
    """What the script prints and writes when run as a person runs it, with few points."""
    return ran("knee_seals", tmp_path_factory.mktemp("reports"))


@pytest.fixture(params=[pytest.param("quick", marks=pytest.mark.long), "committed"])
def numbers(request) -> dict[str, Any]:
    """The numbers of a quick run, and those that the committed report carries inside."""
    return carried(request.getfixturevalue("quick")[1] if request.param == "quick" else REPORT)


def test_less_friction_never_weighs_less(numbers) -> None:
    """Every point is an optimum, and mass rises as less friction is allowed."""
    for rows in map(study.optima, numbers["series"].values()):
        assert {row["status"] for row in rows} <= {"optimal"}
        masses = [row["mass"] for row in rows]
        limits = [row["asked"] for row in rows[1:]]
        assert masses == sorted(masses)
        assert limits == sorted(limits, reverse=True)
        assert rows == [] or rows[0]["asked"] is None


def test_freeing_rings_never_costs(numbers) -> None:
    """Sections and clearances are more freedom: at the same limit the optimum is no heavier."""
    shipped, free = (numbers["series"][name] for name in ("shipped", "free"))
    assert free[0]["mass"] <= shipped[0]["mass"]
    assert free[-1]["asked"] <= shipped[-1]["asked"]


def test_every_point_by_coefficient_meets_every_requirement(numbers) -> None:
    """The dimensions of each point, set in the design as read, meet all that is required."""
    for variant in ("shipped", "free"):
        for row in numbers["series"][variant]:
            limits = {"friction_running": row["asked"]}
            knee = study.wishes(variant, limits=limits, still=True).changed(row["values"])
            evaluation = ao.evaluate(knee)
            assert evaluation.metrics["mass"].value == pytest.approx(row["mass"], rel=1e-6)
            assert all(one.margin > -1e-5 for one in evaluation.requirements)  # seven digits


@pytest.mark.long
def test_the_film_meets_its_limit_within_the_error_of_its_surrogate() -> None:
    """Solved without a surrogate's box, friction on the film is within 2 % of what was asked."""
    rows = carried(REPORT)["series"]["film"][1:]
    assert len(rows) >= 2
    for row in rows:
        film = ao.evaluate(study.wishes("film", still=True).changed(row["values"]))
        assert film.metrics["friction_running"].value == pytest.approx(row["asked"], rel=0.02)


def test_friction_by_coefficient_is_by_hand_a_sum_over_two_rings() -> None:
    """F = mu pi (D f_p + d f_r), f = b (10/11 p + f_0/b_0), b^2 = b_0^2 + W^2 g/(1 + 0.618 E/p)."""
    knee = study.wishes("free", still=True)
    for squeeze in (0.10, 0.14):
        changed = knee.changed({f"seals.{n}.squeeze": squeeze for n in study.PLACES})
        loose = changed.changed({f"seals.{n}.stretch": 0.0 for n in study.PLACES})
        found = ao.evaluate(loose).metrics
        growth = found["growth_at_seal"].value
        modulus, coefficient = study.moduli()[1], 0.10
        total = 0.0
        for diameter, pressure, grown in ((23e-3, 205e5, growth), (13e-3, 210e5, 0.0)):
            left = squeeze - grown / 1.78e-3
            force = 0.307 * left + 2.294 * left**2
            bare = sqrt(6 * force / pi) * (1 - 0.652 * left**2)
            gained = (0.307 + 0.549 * left) / (1 + 0.618 * modulus / pressure)
            mean = 10 / 11 * pressure + modulus * force / bare
            load = 1.78e-3 * sqrt(bare**2 + gained) * mean
            total += coefficient * pi * diameter * load
        # the modulus is that of the oil's temperature: 0.2 % per kelvin over 20 K, on the preload
        assert found["friction_running"].value == pytest.approx(total, rel=0.02)


def test_pressure_alone_is_most_of_the_friction(numbers) -> None:
    """What the pressure's part leaves is the preload's: E f_0/b_0 beside 10/11 p in the mean."""

    def beside(squeeze: float) -> float:
        force = 0.307 * squeeze + 2.294 * squeeze**2
        bare = sqrt(6 * force / pi) * (1 - 0.652 * squeeze**2)
        return study.moduli()[1] * force / bare / (10 / 11 * 205e5)

    for variant in ("shipped", "free"):
        for row in numbers["series"][variant]:
            alone = numbers["coefficients"]["stated"] * row["around"]
            most = max(beside(row["values"][f"seals.{n}.squeeze"]) for n in study.PLACES)
            assert most < 1 / 3  # the pressure gives three quarters or more
            assert alone < row["coulomb"] < (1 + most) * alone
            assert row["coulomb"] == pytest.approx(row["metrics"]["friction_running"], rel=1e-5)


def test_the_film_breaks_away_dry_and_runs_below(numbers) -> None:
    """At rest all asperities carry: f_asp over mu times the coefficient's; running, less."""
    ratio = numbers["coefficients"]["asperities"] / numbers["coefficients"]["stated"]
    assert ratio == pytest.approx(2.5)
    for row in numbers["series"]["film"]:
        met = row["metrics"]
        assert met["friction_breakaway"] == pytest.approx(ratio * row["coulomb"], rel=1e-4)
        assert met["friction_running"] < met["friction_breakaway"]


def test_a_multiplier_is_a_slope(numbers) -> None:
    """The price lies between the mean slopes to a limit below and one above, within 2 %."""
    for variant, base in numbers["prices"].items():
        assert base["slopes"].keys() == base["prices"].keys()
        for name, ends in base["slopes"].items():
            known = [one for one in ends if one is not None]
            low, high, paid = min(known), max(known), base["prices"][name]
            assert study.SENSE[name] == ("max" if paid < 0 else "min")
            slack = 0.02 * abs(paid)
            if variant == "film" and len(known) == 1:
                continue
            assert low - slack <= paid <= high + slack, (variant, name)


def test_leakage_has_a_price_on_the_film() -> None:
    """Where the rod may leave less oil than it would, mass rises, and the price says so."""
    prices = carried(REPORT)["prices"]["film"]
    assert prices["prices"]["rod_leakage"] < 0
    assert prices["metrics"]["rod_leakage"] == pytest.approx(prices["at"]["rod_leakage"], rel=0.02)


def test_every_combination_is_counted(numbers) -> None:
    """Each pair of compounds stands once per choice of back-up rings; optima are no lighter."""
    rows = numbers["choices"]
    pairs = [(*row["compounds"], row["bare"]) for row in rows]
    assert len(pairs) == len(set(pairs))
    best = min(row["mass"] for row in rows if row["feasible"])
    assert best >= numbers["prices"]["free"]["mass"] * (1 - 1e-2)
    for row in rows:
        assert row["feasible"] <= row["tried"]
        if row["feasible"]:
            assert row["status"] == "optimal"
            assert row["mass"] <= row["looked"] * (1 + 1e-6)


def test_the_page_says_the_numbers(numbers) -> None:
    """Masses and sentences of the sheets are those of the data, twice the same bytes."""
    pytest.importorskip("typst")
    pdf, sheets = study.page(numbers)
    assert study.page(numbers)[0] == pdf
    assert len(sheets) in (1, 2)
    words = text_of(pdf).replace("- ", "")
    for said in study.lead(numbers):
        assert said in words
    for rows in numbers["series"].values():
        for row in rows:
            assert f"{1e3 * row['mass']:.1f}" in words


@pytest.mark.long
def test_the_quick_run_prints_what_it_writes(quick) -> None:
    """Every mass of the attached numbers stands in the printed tables."""
    printed, pdf = quick
    masses = re.findall(r" (\d{3}\.\d) ", printed)
    for rows in carried(pdf)["series"].values():
        assert {f"{1e3 * row['mass']:.1f}" for row in rows} <= set(masses)
    assert pdf.with_suffix(".png").is_file()


def test_the_committed_report_is_made_of_its_own_numbers() -> None:
    """The script makes the committed text of the attached numbers."""
    pytest.importorskip("typst")
    assert text_of(study.page(carried(REPORT))[0]) == text_of(REPORT.read_bytes())
