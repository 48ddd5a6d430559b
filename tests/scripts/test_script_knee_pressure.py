"""The study of the supply pressure: equal requirements, closed forms of pipe and oil, a minimum."""

from __future__ import annotations

import re
from math import log, pi, sqrt
from pathlib import Path
from typing import Any

import pytest
from script_loader import carried, ran, script, text_of

import actuator_opt as ao

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "designs" / "scripts" / "knee_pressure.py"
REPORT = ROOT / "reports" / "samples" / "knee_pressure.pdf"

study = script("knee_pressure")


@pytest.fixture(scope="module")
def quick(tmp_path_factory) -> tuple[str, Path]:
    """What the script prints and writes when run as a person runs it, at few pressures."""
    return ran("knee_pressure", tmp_path_factory.mktemp("reports"))


@pytest.fixture(params=[pytest.param("quick", marks=pytest.mark.long), "committed"])
def numbers(request) -> dict[str, Any]:
    """The numbers of a quick run, and those that the committed report carries inside."""
    return carried(request.getfixturevalue("quick")[1] if request.param == "quick" else REPORT)


def _knee(row: dict[str, Any], *, free: bool = True) -> Any:
    """A row's dimensions in the design that was asked."""
    return study.wishes(free=free, still=True).changed(row["values"] | study.at(row["pressure"]))


def test_requirements_are_those_of_the_knee() -> None:
    """Nothing that is asked differs from knee_bonded.yaml: requirements, loads, waivers."""
    shipped, asked = ao.read(study.DESIGN).design, study.wishes().design
    assert asked.requirements == shipped.requirements
    assert asked.load_cases == shipped.load_cases
    assert asked.waivers == shipped.waivers
    for pressure in (60e5, 350e5):
        moved = study.wishes().changed(study.at(pressure)).design
        assert moved.requirements == shipped.requirements
        assert moved.supply.pressure == pressure


def test_every_row_meets_every_requirement(numbers) -> None:
    """The dimensions of each row, set in the design, meet all; the masses are as told."""
    for key, free in (("rows", True), ("shipped", False)):
        for row in filter(study.met, numbers[key]):
            assert row["status"] == "optimal"
            found = ao.evaluate(_knee(row, free=free))
            assert found.metrics["carried_mass"].value == pytest.approx(study.total(row), rel=1e-6)
            assert all(one.margin > -1e-5 for one in found.requirements)  # seven digits


def test_pipes_and_oil_by_hand(numbers) -> None:
    """Bores by 6 and 3.05 m/s, Lamé for a quarter of 485 MPa, 0.8 m, 870 kg/m3."""
    for row in filter(study.met, numbers["rows"]):
        bore, rod = (row["values"][f"{name}"] for name in ("cylinder.bore", "rod.outer_diameter"))
        head, ring = pi / 4 * bore**2, pi / 4 * (bore**2 - rod**2)
        supply, back = (sqrt(4 * 0.4 * area / pi / v) for area, v in ((ring, 6.0), (head, 3.05)))
        stress, pressure = 485e6 / 4, row["pressure"]
        lame = supply * sqrt((stress + pressure) / (stress - pressure))
        outer = max(lame, supply + 2 * 0.51e-3), back + 2 * 0.51e-3
        steel = sum(pi / 4 * (b**2 - a**2) for a, b in zip((supply, back), outer, strict=True))
        oil = head * 0.110 + 6e-6 + 0.8 * pi / 4 * (supply**2 + back**2)
        assert row["metrics"]["line_mass"] == pytest.approx(8000 * 0.8 * steel, rel=1e-5)
        assert row["metrics"]["oil_carried"] == pytest.approx(870 * oil, rel=1e-5)
        assert row["pipes"] == pytest.approx([supply, outer[0], back], rel=1e-5)


def test_loss_in_the_pipes_by_hand(numbers) -> None:
    """Laminar, 32 eta v L/d2 of both pipes; Reynolds stays below 2300."""
    for row in filter(study.met, numbers["rows"]):
        supply, _, back = row["pipes"]
        assert 6.0 * supply / 32e-6 < 2300
        lost = sum(32 * 870 * 32e-6 * v * 0.8 / d**2 for v, d in ((6.0, supply), (3.05, back)))
        assert row["drop"] == pytest.approx(lost / row["pressure"], rel=1e-4)


def test_the_best_pressure_is_a_minimum(numbers) -> None:
    """With the pressure free the optimum is below every row, and lies inside the range."""
    best = numbers["best"]
    assert best["status"] == "optimal"
    assert 61 < study.bar(best) < 349
    assert all(study.total(best) <= study.total(row) * (1 + 1e-6) for row in numbers["rows"])


def test_free_glands_never_weigh_more(numbers) -> None:
    """Where the glands as shipped go, free ones carry no more."""
    free = {row["pressure"]: study.total(row) for row in numbers["rows"]}
    for row in filter(study.met, numbers["shipped"]):
        assert free[row["pressure"]] <= study.total(row) * (1 + 1e-6)


def test_force_binds_below_stiffness_above(numbers) -> None:
    """By hand, p A - p_return A_ring - 6 kN is friction, at most, where the force binds."""
    rows = list(filter(study.met, numbers["rows"]))
    spare = []
    for row in rows:
        bore, rod = row["values"]["cylinder.bore"], row["values"]["rod.outer_diameter"]
        push = row["pressure"] * pi / 4 * bore**2 - 5e5 * pi / 4 * (bore**2 - rod**2)
        spare.append(push - 6000)
        if "stance force" in study.binding(row):
            assert 0 < spare[-1] <= row["metrics"]["friction_running"]
        assert ("stiffness" in study.binding(row)) == (row["metrics"]["stiffness_min"] < 10.0001e6)
    assert "stance force" in study.binding(rows[0])
    assert "stiffness" in study.binding(rows[-1])
    assert spare[-1] > 2 * rows[-1]["metrics"]["friction_running"]


def test_masses_rise_on_both_sides_of_the_best() -> None:
    """Along the committed pressures: down to the best, up from there, no bumps."""
    found = carried(REPORT)
    assert [round(study.bar(row)) for row in found["rows"]] == list(study.PRESSURES)
    best = study.bar(found["best"])
    masses = [(study.bar(row), study.total(row)) for row in found["rows"]]
    low = [mass for pressure, mass in masses if pressure < best]
    high = [mass for pressure, mass in masses if pressure > best]
    assert low == sorted(low, reverse=True)
    assert high == sorted(high)


def test_longer_pipes_ask_for_more_pressure() -> None:
    """Oil and pipes fall with pressure: the longer they are, the higher the best one."""
    rows = carried(REPORT)["lengths"]
    assert list(map(float, rows)) == sorted(map(float, rows))
    pressures = [row["pressure"] for row in rows.values()]
    assert pressures == sorted(pressures)


@pytest.mark.long
def test_a_search_from_many_starts_finds_no_lighter_one() -> None:
    """Warm starts along the pressures do not end in a worse optimum: 275 bar from four starts."""
    row = next(r for r in carried(REPORT)["rows"] if round(study.bar(r)) == 275)
    found = ao.optimise(study.wishes().changed(study.at(275e5)), starts=4, prices=False)
    assert found.objective_value == pytest.approx(study.total(row), rel=1e-5)


def test_back_up_rings_by_hand(numbers) -> None:
    """The gap they bear: ln g linear, 76 um at 345 to 40 um at 400 bar, over at most 60 um."""
    for row in filter(study.met, numbers["rows"]):
        high = max(row["pressure"], 345e5)
        share = (high - 345e5) / 55e5
        allowed = 76e-6 * (40 / 76) ** share
        assert log(allowed) < log(77e-6)
        gap = max(2 * row["values"]["head.clearance"], 34e-6 + row["values"]["piston.clearance"])
        assert row["backed"] == pytest.approx(allowed / gap, rel=1e-3)
        assert row["backed"] >= 1
        assert bool(row["unbacked"]) == (row["pressure"] > 206.8e5)


def test_the_accumulator_by_hand() -> None:
    """1.5 rho p V0/(sigma/4): gas from p to 0.9 p with n 1.4, filled slowly from 0.81 p."""
    p, given = 200e5, 50e-6
    total, low, charge = (x * p + 101325 for x in (1.0, 0.9, 0.81))
    full = charge / total  # of V0
    volume = given / (full * ((total / low) ** (1 / 1.4) - 1))
    wanted = 1.5 * 7850 * p * volume / (1000e6 / 4)
    assert study.accumulator_mass(p, given) == pytest.approx(wanted, rel=1e-3)


def test_the_page_says_the_numbers(numbers) -> None:
    """Sentences and masses of the sheets are those of the data, twice the same bytes."""
    pytest.importorskip("typst")
    pdf, sheets = study.page(numbers)
    assert study.page(numbers)[0] == pdf
    assert len(sheets) == 2 or len(numbers["rows"]) == len(study.QUICK)
    words = text_of(pdf).replace("- ", "")
    for said in study.lead(numbers):
        assert said.replace("- ", "") in words
    for row in filter(study.met, numbers["rows"]):
        assert f"{1e3 * study.total(row):.1f}" in words


def test_the_committed_report_is_made_of_its_own_numbers() -> None:
    """The script makes the committed text of the attached numbers."""
    pytest.importorskip("typst")
    assert text_of(study.page(carried(REPORT))[0]) == text_of(REPORT.read_bytes())


@pytest.mark.long
def test_the_quick_run_prints_what_it_writes(quick) -> None:
    """Every mass of the attached numbers stands in the printed table."""
    printed, pdf = quick
    found = carried(pdf)
    masses = set(re.findall(r"\d+\.\d", printed))
    assert {f"{1e3 * study.total(row):.1f}" for row in found["rows"]} <= masses
    assert f"lightest at {study.bar(found['best']):.0f} bar" in printed
    assert pdf.with_suffix(".png").is_file()


def test_a_pressure_nobody_meets_is_told() -> None:
    """A row without a design names what is missed and how the shipped glands end."""
    found = carried(REPORT)
    assert not study.met(found["shipped"][-1])
    assert "friction_running" in {one["metric"] for one in found["shipped"][-1]["lacks"]}
    lacking = {**found["rows"][-1], "lacks": [{"metric": "burst_factor"}]}
    told = study.mass_rows(found | {"rows": [*found["rows"][:-1], lacking]})
    assert "misses burst_factor" in told[-1]
