"""The study of what each hertz of the knee costs: feasible optima, prices, and a page of them."""

from __future__ import annotations

import itertools
import re
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from script_loader import carried, ran, script, text_of

import actuator_opt as ao

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "designs" / "scripts" / "knee_dynamics.py"
REPORT = ROOT / "reports" / "samples" / "knee_dynamics.pdf"


study = script("knee_dynamics")


@pytest.fixture(scope="module")
def quick(tmp_path_factory) -> tuple[str, Path]:
    """What the script prints and writes when run as a person runs it, with few points."""
    return ran("knee_dynamics", tmp_path_factory.mktemp("reports"))


@pytest.fixture(params=[pytest.param("quick", marks=pytest.mark.long), "committed"])
def numbers(request) -> dict[str, Any]:
    """The numbers of a quick run, and those that the committed report carries inside."""
    return carried(request.getfixturevalue("quick")[1] if request.param == "quick" else REPORT)


@pytest.mark.parametrize("spool", [60.0, 120.0, 240.0])
def test_the_closed_form_puts_a_pair_of_poles_on_the_axis(spool) -> None:
    """At the gain it gives, s R(s) V(s) + K has a root i w and none to the right of the axis."""
    mode = {"frequency": 112.0, "damping": 0.05}
    gain = study.ultimate_speed_gain(**mode, spool=spool, spool_damping=0.7)
    low = [1.0]
    for frequency, damping in ((112.0, 0.05), (spool, 0.7)):
        omega = 2 * pi * frequency
        low = np.polymul(low, [1 / omega**2, 2 * damping / omega, 1.0])
    low = np.polymul(low, [1.0, 0.0])
    low[-1] += 2 * pi * gain
    assert max(np.roots(low).real) == pytest.approx(0, abs=1e-6 * 2 * pi * 112)


def test_the_closed_form_tends_to_that_of_merritt() -> None:
    """A spool quick beyond measure leaves K/(2 pi) = 2 zeta f_0."""
    mode = {"frequency": 112.0, "damping": 0.05}
    assert study.ultimate_speed_gain(**mode) == pytest.approx(11.2)
    fast = study.ultimate_speed_gain(**mode, spool=1e7, spool_damping=0.7)
    assert fast == pytest.approx(11.2, rel=1e-4)


def test_the_leaking_spring_has_its_two_ends() -> None:
    """Without leakage k - m w^2 is left, with a leak beyond measure the mass alone."""
    given = {"stiffness": 1e7, "mass": 20.0, "frequency": 30.0}
    inertia = 20 * (2 * pi * 30) ** 2
    assert study.shaken_stiffness(**given, corner=0.0) == pytest.approx(1e7 - inertia)
    assert study.shaken_stiffness(**given, corner=1e9) == pytest.approx(inertia, rel=1e-3)


def test_more_asked_never_weighs_less(numbers) -> None:
    """Every point is an optimum, and mass rises with what is asked, in the end more steeply.

    The models are not convex: from 7.3 to 10 Hz, the slope falls by 1 %, from 1 and 16 starts.
    """
    for metric, found in numbers["series"].items():
        rows = [*found["points"], found["most"]]
        assert {row["status"] for row in rows} == {"optimal"}
        asked, masses = [row["asked"] for row in rows], [row["mass"] for row in rows]
        assert asked == sorted(asked)
        assert masses == sorted(masses)
        slopes = [study.slope(metric, *pair) for pair in itertools.pairwise(rows)]
        assert slopes[0] > 0
        assert all(after > 0.98 * before for before, after in itertools.pairwise(slopes))
        assert slopes[-1] > 5 * slopes[0]


def test_every_point_meets_every_requirement(numbers) -> None:
    """The dimensions of each point, set in the design as read, meet all that is required."""
    for metric, found in numbers["series"].items():
        for row in [*found["points"], found["most"]]:
            asked = {f"requirements.{metric}.min": row["asked"]}
            evaluation = ao.evaluate(ao.read(study.DESIGN).changed(row["values"] | asked))
            assert evaluation.metrics["mass"].value == pytest.approx(row["mass"], rel=1e-6)
            assert evaluation.metrics[metric].value == pytest.approx(row["asked"], rel=1e-5)
            assert all(one.margin > -1e-5 for one in evaluation.requirements)  # seven digits


@pytest.mark.long
def test_what_is_free_is_free() -> None:
    """Where a series begins, leaving the requirement out saves no mass."""
    for metric, found in carried(REPORT)["series"].items():
        without = ao.optimise(study.wishes(without=metric), starts=1, prices=False)
        assert found["points"][0]["mass"] == pytest.approx(without.objective_value, rel=1e-5)
        assert found["points"][0]["asked"] == pytest.approx(found["free"], rel=1e-6)


def test_a_multiplier_lies_between_the_slopes_beside_it() -> None:
    """The price of a point lies between the slopes of both chords, which 1 % may exchange."""
    for metric, found in carried(REPORT)["series"].items():
        rows, priced = [*found["points"], found["most"]], 0
        for before, row, after in zip(rows, rows[1:], rows[2:], strict=False):
            if metric in row["prices"]:
                paid = study.price(metric, row)
                low, high = study.slope(metric, before, row), study.slope(metric, row, after)
                assert 0 < 0.98 * low < paid < 1.02 * high
                priced += 1
        assert priced == 2


def widened(gain: float, spool: float) -> float:
    """-3 dB bandwidth of a loop of velocity gain `gain` [Hz] with the spool's lag alone [Hz]."""
    frequency = np.linspace(0.5 * gain, 2 * gain, 20001)
    lag = 1 + 2 * 0.7j * frequency / spool - (frequency / spool) ** 2
    closed = 1 / (1 + 1j * frequency / gain * lag)
    return float(frequency[np.argmax(abs(closed) < 0.5**0.5)])


def test_the_closed_form_of_the_loop_agrees_with_the_model(numbers) -> None:
    """Spool, resonance and integrator give the velocity gain within 7 %, and it the bandwidth.

    The lag of the spool widens the closed loop, the more the nearer the gain is to the spool: by
    7 % at 4 Hz, by a sixth at 11 Hz. With it the gain gives the bandwidth within 5 %.
    """
    for row in numbers["series"]["bandwidth"]["points"]:
        slow = row["speed_gains"][1]
        assert row["with_spool"] == pytest.approx(slow, rel=0.07)
        wide = widened(slow, numbers["spool"])
        assert wide == pytest.approx(row["metrics"]["bandwidth"], rel=0.05)


def test_the_closed_forms_agree_with_the_model(numbers) -> None:
    """One spring that leaks for two that leak at different rates: 5 % below to 13 % above."""
    for row in numbers["series"]["dynamic_stiffness"]["points"]:
        high = 1e6 * row["maxwell"] / row["metrics"]["dynamic_stiffness"]
        assert 0.95 < high < 1.13


def test_a_quick_spool_comes_to_merritts_limit() -> None:
    """With a spool of 1 kHz the bandwidth lies within a fifth of 2 zeta f_0 over the rest."""
    row = carried(REPORT)["changes"]["spool of 1 kHz"]
    assert row["metrics"]["bandwidth"] == pytest.approx(row["merritt"], rel=0.2)


def test_changes_are_compared_at_one_mass(numbers) -> None:
    """No change is given more mass than the design as required; undone it gives its bandwidth.

    The widest loop at a mass is a kink where two places of the piston are as wide: a search may
    end there without a proof of its conditions, "feasible".
    """
    base = numbers["required"]
    for row in numbers["changes"].values():
        assert row["status"] in ("optimal", "feasible")
        assert row["mass"] <= (1 + 3e-6) * base["mass"]
    same = numbers["changes"]["as it is"]["metrics"]["bandwidth"]
    assert same == pytest.approx(base["metrics"]["bandwidth"], rel=1e-4)


def test_what_the_page_says_in_words_holds() -> None:
    """A quicker spool takes bandwidth, a heavier load margin; dearer points are stiffer, wider."""
    found = carried(REPORT)
    spools = [found["changes"][name] for name in found["changes"] if name.startswith("spool")]
    widths = [row["metrics"]["bandwidth"] for row in spools]
    assert len(widths) == 3
    assert widths == sorted(widths, reverse=True)
    assert list(found["kept"].values()) == sorted(found["kept"].values(), reverse=True)
    for series in found["series"].values():
        rows = [*series["points"], series["most"]]
        assert not any("friction" in study.limits(row) for row in series["points"])
        for values in (
            [r["frequency"] for r in rows],
            [r["values"]["cylinder.bore"] for r in rows],
        ):
            assert values == sorted(values)
    for row in found["series"]["bandwidth"]["points"]:
        assert row["swings_at"] < row["frequency"]
        assert row["cases"] == ["swing", "swing"]


def test_losses_and_sag_are_those_by_hand() -> None:
    """0.2 l/min at 50 bar is 195.7 W over two edge pairs at 205 bar; sag is g F/(A^2 K_v)."""
    row = carried(REPORT)["required"]
    edge = 0.2e-3 / 60 * (102.5 / 50) ** 0.5
    assert row["valve_power"] == pytest.approx(2 * edge * 205e5, rel=1e-6)
    bleed, bore = (row["values"][path] for path in ("piston.leakage_conductance", "cylinder.bore"))
    speed = bleed * 6000 / (pi / 4 * bore**2) ** 2
    assert row["sag"] == pytest.approx(speed / (2 * pi * row["speed_gains"][1]), rel=1e-5)


def test_the_page_says_the_numbers(numbers) -> None:
    """Masses, prices and sentences of the sheets are those of the data, twice the same bytes."""
    pytest.importorskip("typst")
    pdf, sheets = study.page(numbers)
    assert study.page(numbers)[0] == pdf
    assert len(sheets) in (1, 2)
    words = text_of(pdf)
    for metric, found in numbers["series"].items():
        assert study.sentence(metric, found) in words.replace("- ", "")
        for row in found["points"]:
            assert f"{1e3 * row['mass']:.1f}" in words
    for row in numbers["changes"].values():
        assert f"{row['metrics']['bandwidth']:.3g}" in words


@pytest.mark.long
def test_the_quick_run_prints_what_it_writes(quick) -> None:
    """Every mass of the attached numbers stands in the printed tables."""
    printed, pdf = quick
    rows = carried(pdf)["series"]
    masses = re.findall(r"^ +[\d.]+ +(\d{3}\.\d) ", printed, re.MULTILINE)
    wanted = [f"{1e3 * r['mass']:.1f}" for f in rows.values() for r in [*f["points"], f["most"]]]
    assert masses == wanted
    assert pdf.with_suffix(".png").is_file()


def test_the_committed_report_is_made_of_its_own_numbers() -> None:
    """The script makes the committed text of the attached numbers."""
    pytest.importorskip("typst")
    assert text_of(study.page(carried(REPORT))[0]) == text_of(REPORT.read_bytes())
