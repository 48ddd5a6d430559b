"""Robust optima against closed forms, and what is said where there is none."""

from __future__ import annotations

import math

import pytest
import scatter_case as case
from cli_runner import run
from scipy.stats import norm

import actuator_opt as ao
from actuator_opt.scatter import robust

SPREAD = 0.2
"""Deviation of the rod's diameter, mm."""


def one_wish(upper="17 mm"):
    """A knee that only asks for the lightest rod; nothing but its diameter scatters or moves."""
    start = case.PLAIN.index("variables:\n")
    end = case.PLAIN.index("waivers:")
    variable = f"variables:\n  rod.outer_diameter:\n    lower: 12 mm\n    upper: {upper}\n\n"
    text = case.PLAIN[:start] + variable + case.PLAIN[end:]
    text = text.replace("  thickness: 5 mm", "  thickness: 8 mm")  # plates far from their limit
    entry = {"distribution": "normal", "deviation": f"{SPREAD} mm"}
    text = text.replace("force: 4 kN", "force: 2 kN")
    return case.only({"rod.outer_diameter": entry}, text=text)


@ao.constraint("thick_rod", label="rod beyond 15 mm")
def thick_rod(design):
    """A limit that the lightest rod stands at: 15 mm."""
    return design["rod.outer_diameter"] / 15e-3 - 1


def optimum(target, **more):
    """The robust optimum of that design."""
    actuator = ao.read(one_wish(**more), plugins=[thick_rod])
    return ao.optimise(actuator, yield_target=target, prices=False, seed=1, starts=1)


@pytest.mark.parametrize("target", [0.9, 0.99])
def test_one_limit_one_input_in_closed_form(target):
    """The rod is thicker by z deviations, z of the failures aimed at; the sample agrees."""
    found = optimum(target)
    aimed = 1 - robust.AIM * (1 - target)
    thick = 15 + SPREAD * norm.ppf(aimed)
    value = {row.path: row.value for row in found.variables}["rod.outer_diameter"]
    noise = 3 * math.sqrt(aimed * (1 - aimed) / 4096) / norm.pdf(norm.ppf(aimed)) * SPREAD
    assert 1e3 * value == pytest.approx(thick, abs=noise)
    made = found.robust
    assert made.converged
    assert made.reached
    assert made.lower >= target - 0.2 * (1 - target)
    exact = norm.cdf((1e3 * value - 15) / SPREAD)
    assert made.lower <= exact <= made.upper
    assert made.nominal_rate == pytest.approx(0.5, abs=0.03)
    assert made.reserves["thick_rod"] == pytest.approx(1e3 * value / 15 - 1, abs=1e-5)
    assert found.objective_value > made.nominal_objective
    assert found.to_dict()["robust"]["yield"]["value"] == made.rate


def test_without_scatter_the_plain_optimum_is_robust():
    """No input: the yield is 1, no reserve is kept, nothing gets heavier."""
    text = one_wish().replace(
        "    distribution: normal\n    deviation: 0.2 mm\n", "    distribution: fixed\n"
    )
    found = ao.optimise(ao.read(text, plugins=[thick_rod]), yield_target=0.999, prices=False)
    assert found.robust.rate == 1.0
    assert found.robust.reserves == {}
    assert found.objective_value == found.robust.nominal_objective


def test_no_room_for_the_reserve_is_infeasible_in_words():
    """The rod may not grow as far as the yield asks: infeasible, with the limit named."""
    found = optimum(0.99, upper="15.1 mm")
    assert found.status == "infeasible"
    assert "no design was found that keeps the reserves" in found.robust.sentence
    assert "thick_rod" in found.robust.sentence
    assert found.infeasibility is not None
    assert not found.robust.reached


def test_what_does_not_settle_is_said(monkeypatch):
    """Too few rounds: the sentence says that the reserves did not settle, and what holds."""
    monkeypatch.setattr(robust, "ROUNDS", 1)
    monkeypatch.setattr(robust, "AIM", 8.0)
    found = optimum(0.95)
    assert not found.robust.converged
    assert not found.robust.reached
    assert "did not settle" in found.robust.sentence
    assert found.robust.upper < 0.95


def test_a_design_that_never_met_its_limits_is_told_as_ever():
    """Infeasible without any reserve: the ordinary card, no word of yields."""
    found = optimum(0.99, upper="14 mm")
    assert found.status == "infeasible"
    assert found.robust is None
    assert found.infeasibility is not None


def test_same_seed_same_design():
    """The seed fixes the draws, so the design."""
    one, other = optimum(0.6), optimum(0.6)
    assert one.robust.to_dict() == other.robust.to_dict()
    assert one.objective_value == other.objective_value


@pytest.mark.parametrize("target", ["0", "1", "2", "nan", "0.3"])
def test_impossible_targets_are_one_line(target, tmp_path):
    """A probability that no sample can show is refused before the work."""
    file = tmp_path / "d.yaml"
    file.write_text(one_wish(), encoding="utf-8")
    result = run("optimise", file, "--yield", target, "--json")
    assert result.code == 2
    (fault,) = result.json["errors"]
    assert "cannot be asked for" in fault["message"]


def test_the_report_tells_of_it(tmp_path):
    """Sentence on page 1, rounds and reserves as tables."""
    from actuator_opt.reporting.robust_rows import robust_tables

    found = optimum(0.9)
    way, reserves = robust_tables(found)
    assert len(way.rows) == len(found.robust.rounds)
    assert "thick_rod" in [row[0] for row in reserves.rows]
    assert robust_tables(found.evaluation) == []


def test_an_interrupt_ends_the_way():
    """Ctrl-C in a round gives the best design of that round, as in any optimisation."""
    from dataclasses import replace

    from actuator_opt.scatter.robust import robust as run_robust

    actuator = ao.read(one_wish(), plugins=[thick_rod])
    plain = ao.optimise(actuator, prices=False, starts=1)
    calls = []

    def search(subject, last):
        calls.append(last)
        return plain if len(calls) == 1 else replace(plain, status="interrupted")

    found = run_robust(actuator.subject(), 0.99, search)
    assert found.status == "interrupted"
    assert found.robust is None
    assert calls == [False, False]
