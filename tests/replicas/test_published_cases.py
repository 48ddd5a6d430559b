"""Published and foreign cases in time: EXUDYN's arm and press, a textbook's servo, beside ours."""

from __future__ import annotations

import re
import shlex
import sys
from functools import cache
from math import cos, pi, sqrt
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from plain_servo import Arm, PlainServo

import actuator_opt as ao
from actuator_opt.api.reports import REPLICAS, published as blocks_of_report
from actuator_opt.api.simulations import compare_measured, read_scenario, simulate
from actuator_opt.design.scenario.kinds import PublishedCase
from actuator_opt.rendering.blocks import Chart, Notes, Table
from actuator_opt.replicas import CASES, exudyn, fossee, published
from actuator_opt.simulation import Simulation

ROOT = Path(__file__).parents[2]
SCENARIOS = ROOT / "designs" / "scenarios"
NAMES = ("exudyn_arm", "exudyn_press", "textbook_servo")


@cache
def run(name: str, **values: str | None) -> Simulation:
    """A shipped scenario with values set (None: removed); a double underscore is a dot."""
    own = {path.replace("__", "."): value for path, value in values.items()}
    return simulate(SCENARIOS / f"{name}.yaml", set=own, margins=True)


# ---- both ----


@pytest.mark.parametrize("name", NAMES)
def test_a_case_adds_up(name) -> None:
    """Mass and energy kept; a second integrator agrees."""
    found = simulate(SCENARIOS / f"{name}.yaml", verify=True)
    assert max(found.balance.mass, found.balance.energy) < 1e-6
    assert found.second is not None
    assert found.second.max_difference < 1e-3


def _lines() -> list[tuple[str, list[str]]]:
    """What the heads of the scenarios say to add to the command."""
    return [
        (name, shlex.split(line))
        for name in NAMES
        for line in re.findall(
            r"^#   (--.*?)(?:   .*)?$",
            (SCENARIOS / f"{name}.yaml").read_text("utf-8"),
            re.MULTILINE,
        )
    ]


@pytest.mark.parametrize(("name", "words"), _lines())
def test_a_variant_named_in_a_scenario_runs(name, words) -> None:
    """Values can be set, and the record can be compared."""
    if words[0] == "--measured":
        found = compare_measured(SCENARIOS / f"{name}.yaml", ROOT / words[1])
        assert len(found.overlay.residuals) == 3
        return
    assert words[::2] == ["--set"] * (len(words) // 2)
    one = simulate(SCENARIOS / f"{name}.yaml", set=dict(w.split("=", 1) for w in words[1::2]))
    assert max(one.balance.mass, one.balance.energy) < 1e-6


def test_every_case_can_be_named() -> None:
    """The word of a scenario, its module, its shipped scenario."""
    words, _ = get_args(get_args(PublishedCase)[0])
    assert set(get_args(words)) == set(CASES)
    shipped = {read_scenario(SCENARIOS / f"{name}.yaml").scenario.reproduces for name in NAMES}
    assert shipped == set(CASES)


def test_the_name_of_a_case_changes_no_result() -> None:
    """Hash and blocks without the word, and with it but without the sources."""
    named, plain = run("textbook_servo"), run("textbook_servo", reproduces=None)
    assert plain.scenario.reproduces is None
    assert plain.spec_hash == named.spec_hash
    assert published(plain) == []


def test_a_page_without_the_replicas_says_where_they_are(monkeypatch) -> None:
    """A wheel comes without the tables: a line of caution in their place."""
    monkeypatch.setitem(sys.modules, REPLICAS, None)
    (notes,) = blocks_of_report(run("textbook_servo"))
    assert "FOSSEE788 are not part of this installation" in notes.items[0]


def test_a_page_holds_the_published_values(tmp_path) -> None:
    """The report is written with the tables."""
    trial = read_scenario(SCENARIOS / "textbook_servo.yaml")
    with_them = ao.write_simulation(run("textbook_servo"), trial, folder=tmp_path / "a")
    without = ao.write_simulation(
        run("textbook_servo", reproduces=None), trial, folder=tmp_path / "b"
    )
    assert with_them[0].path.stat().st_size > without[0].path.stat().st_size + 1000


# ---- EXUDYN's arm and press ----


def shares(simulation: Simulation) -> dict[str, float]:
    """Largest differences: of the span for the position, of the supply for pressures."""
    return {
        name: residual.largest / residual.span
        if name == "position"
        else exudyn.share_of_supply(simulation, residual)
        for name, residual in exudyn.compared(simulation).residuals.items()
    }


def test_the_arm_is_that_of_exudyn() -> None:
    """At every sample of EXUDYN's record with fine steps."""
    found = shares(run("exudyn_arm"))
    assert set(found) == {"position", "pressure_a", "pressure_b"}
    assert found["position"] < 4e-4
    assert max(found["pressure_a"], found["pressure_b"]) < 1e-4


def test_the_press_is_that_of_exudyn() -> None:
    """Unequal areas, volumes that change, 60 kN: at every sample, with pressures to 180 bar."""
    one = run("exudyn_press")
    found = shares(one)
    assert set(found) == {"position", "pressure_a", "pressure_b"}
    assert found["position"] < 1e-4
    assert max(found["pressure_a"], found["pressure_b"]) < 2e-4
    assert max(one.signals["pressure_b"]) > 175e5
    assert max(one.signals["pressure_a"]) > 125e5
    assert min(one.signals["pressure_b"]) > 5e5


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("exudyn_arm", {"valve__natural_frequency": "100 Hz"}),
        ("exudyn_arm", {"load__inertia": "44 kg*m^2"}),
        ("exudyn_press", {"ideal__area_b": "25.25 cm^2"}),
        ("exudyn_press", {"fluid__air_content": "0.1 %"}),
    ],
)
def test_another_circuit_is_not_that_of_exudyn(name, change) -> None:
    """A real spool, 10 % of inertia, 1 % of area, air: each is seen."""
    assert max(shares(run(name, **change)).values()) > 1e-3


def test_the_end_is_that_of_exudyn_but_for_its_steps() -> None:
    """Its stored number, of steps of 1 ms, lies 0.37 % above its own with 10 us."""
    stored, fine, length, a, b = exudyn.end_values(run("exudyn_arm"))
    assert stored.published == 7.130440021870293
    assert fine.published / stored.published - 1 == pytest.approx(-0.0037, abs=5e-5)
    assert abs(fine.deviation) < 5e-4
    assert abs(length.deviation) < 2e-4
    assert -0.006 < a.deviation < 0
    assert -0.003 < b.deviation < 0
    assert exudyn.end_values(run("exudyn_arm", duration="0.35 s")) == []
    assert exudyn.end_values(run("exudyn_press")) == []


def test_the_record_obeys_the_equations_of_exudyn() -> None:
    """Volumes that do not change, the moment of the weight with the cosine, no spool."""
    pull = 120 * 9.81 * 0.5
    start = 0.25 * sqrt(2)
    arm = Arm(0.25, 0.25, 40.0, lambda angle: pull * cos(angle - pi / 2), start)

    def reference(time: float) -> float:
        return (max(0.5, min(1.5, 1 - cos(pi * time))) - 0.5) * 0.1

    servo = PlainServo(
        areas=(0.01, 0.01), dead=(0.0, 0.0), stroke=1.0, modulus=1e11, edge=2e-5, supply=2e7,
        back=0.0, gain=20.0, reference=reference, viscous=2e5, spool=(1e6, 0.7), arm=arm,
        volumes=(1.0, 1.0),
    )  # fmt: skip
    channels = exudyn.record("Exudyn2022").channels
    time = channels["position"][0]
    truth = servo.run(pi / 2, (2e6, 2e6), time, (1 / 3,))
    moved = channels["position"][1] + 0.3 - start
    assert np.max(np.abs(moved - truth["position"])) < 2e-4 * np.ptp(moved)
    for name in ("pressure_a", "pressure_b"):
        assert np.max(np.abs(channels[name][1] - truth[name])) < 5e-5 * 2e7


@pytest.mark.parametrize(
    ("name", "kinds"),
    [
        ("exudyn_arm", [Table, Table, Chart, Notes]),
        ("exudyn_press", [Table, Chart, Notes]),
        ("textbook_servo", [Table, Notes]),
    ],
)
def test_the_blocks_of_a_case(name, kinds) -> None:
    """Record or values, end, chart, notes."""
    assert [type(block) for block in published(run(name))] == kinds


# ---- the textbook's servo ----


def test_the_printed_results_of_the_textbook() -> None:
    """Its formulas by hand, in its rounding."""
    case = fossee.CASE
    assert case.natural_frequency == pytest.approx(5 * sqrt(350000 / 129.5), rel=1e-12)
    assert case.computed_gain == pytest.approx(722.05, abs=0.01)
    assert case.metric_gain == pytest.approx(284.8, abs=0.1)
    assert (case.rest_error, case.metric_rest_error) == (0.00138, 0.00352)
    assert (case.lag, case.metric_lag) == (0.104, 0.264)


def test_the_servo_is_that_of_the_textbook() -> None:
    """Natural frequency, lag at full speed, error at rest from both sides."""
    rows = fossee.values(run("textbook_servo"))
    limits = (3e-3, 2e-3, 1e-3, 6e-3, 6e-3, 1e-2)
    for row, limit in zip(rows, limits, strict=True):
        assert abs(row.deviation) < limit, row
    assert abs(rows[3].ours - rows[4].ours) < 1e-6


def test_half_the_dead_band_halves_the_error_at_rest() -> None:
    """The lag at 300 mA stays."""
    whole, half = (
        fossee.values(run("textbook_servo", **values))
        for values in ({}, {"valve__spool__overlap": "2 um"})
    )
    assert half[3].ours == pytest.approx(whole[3].ours / 2, rel=0.02)
    assert half[1].ours == pytest.approx(whole[1].ours, rel=2e-3)


def test_twice_the_gain_is_not_stable() -> None:
    """Two thirds of the frequency ask for a damping ratio of 1/3; ours has 0.24."""
    tuned = run("textbook_servo", control__gain_factor="2").tuned
    assert tuned is not None
    assert tuned.margins is not None
    assert not tuned.margins.stable
    assert fossee.damping_ratio(run("textbook_servo")) == pytest.approx(0.236, abs=0.001)


def test_another_reference_has_no_row_over_time() -> None:
    """A run that ends before the last rest: only the natural frequency is left."""
    rows = fossee.values(run("textbook_servo", duration="2.4 s"))
    assert [row.subject for row in rows] == ["natural frequency"]
