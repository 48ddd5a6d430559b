"""Robust optima against closed forms, and what is said where there is none."""

from __future__ import annotations

import math
from functools import cache

import pytest
import scatter_case as case
from cli_runner import run
from scipy.stats import norm

import actuator_opt as ao
from actuator_opt.uncertainties import robust

SPREAD = 0.2
"""Deviation of the rod's diameter, mm."""


def one_wish(upper="17 mm", sizes=""):
    """A knee that only asks for the lightest rod; nothing but its diameter scatters or moves."""
    start = case.PLAIN.index("variables:\n")
    end = case.PLAIN.index("waivers:")
    variable = f"variables:\n  rod.outer_diameter:\n    lower: 12 mm\n    upper: {upper}\n"
    variable += f"    sizes: [{sizes}]\n\n" if sizes else "\n"
    text = case.PLAIN[:start] + variable + case.PLAIN[end:]
    text = text.replace("  thickness: 5 mm", "  thickness: 8 mm")  # plates far from their limit
    entry = {"distribution": "normal", "deviation": f"{SPREAD} mm"}
    text = text.replace("force: 4 kN", "force: 2 kN")
    return case.only({"rod.outer_diameter": entry}, text=text)


@ao.constraint("thick_rod", label="rod beyond 15 mm")
def thick_rod(design):
    """A limit that the lightest rod stands at: 15 mm."""
    return design["rod.outer_diameter"] / 15e-3 - 1


PLUGIN = """import actuator_opt as ao


@ao.constraint("thick_rod", label="rod beyond 15 mm")
def thick_rod(design):
    return design["rod.outer_diameter"] / 15e-3 - 1
"""


def plain_mass(sizes):
    """Mass of the smallest of the sizes, without any reserve."""
    actuator = ao.read(one_wish(sizes=sizes), plugins=[thick_rod])
    return ao.optimise(actuator, prices=False, seed=1, starts=1).best_objective


def optimum(target, **more):
    """The robust optimum of that design."""
    actuator = ao.read(one_wish(**more), plugins=[thick_rod])
    return ao.optimise(actuator, yield_target=target, prices=False, seed=1, starts=1)


known = cache(optimum)
"""The robust optimum, solved once for all tests that only read it."""


@pytest.mark.parametrize("target", [pytest.param(0.9, marks=pytest.mark.long), 0.99])
@pytest.mark.long
def test_one_limit_one_input_in_closed_form(target):
    """The rod is thicker by z deviations, z of the failures aimed at; the sample agrees."""
    found = known(target)
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


@pytest.mark.long
def test_without_scatter_the_plain_optimum_is_robust():
    """No input: the yield is 1, no reserve is kept, nothing gets heavier."""
    text = one_wish().replace(
        "    distribution: normal\n    deviation: 0.2 mm\n", "    distribution: fixed\n"
    )
    actuator = ao.read(text, plugins=[thick_rod])
    found = ao.optimise(actuator, yield_target=0.999, prices=False, starts=1)
    assert found.robust.rate == 1.0
    assert found.robust.reserves == {}
    assert found.objective_value == found.robust.nominal_objective


@pytest.mark.long
def test_no_room_for_the_reserve_is_infeasible_in_words():
    """The rod may not grow as far as the yield asks: infeasible, with the limit named."""
    found = known(0.99, upper="15.1 mm")
    assert found.status == "infeasible"
    assert "no design meets the limits with the margins" in found.robust.sentence
    assert "thick_rod" in found.robust.sentence
    assert found.infeasibility is not None
    assert not found.robust.reached


@pytest.mark.long
def test_the_yield_is_that_of_the_size_to_build():
    """Sizes of 15 mm and a bit: the first one 2.39 deviations beyond 15 mm or more is taken."""
    found = optimum(0.99, sizes="15 mm, 15.2 mm, 15.6 mm, 16 mm")
    assert found.best.rod.outer_diameter == pytest.approx(15.6e-3, rel=1e-12)
    made = found.robust
    assert made.reached
    assert made.lower <= norm.cdf(0.6 / SPREAD) <= made.upper
    assert made.nominal_rate == pytest.approx(0.5, abs=0.03)


@pytest.mark.long
def test_no_size_with_enough_yield_saves_nothing(tmp_path):
    """The largest size holds in norm.cdf(1.5) of the draws: missed, told, and nothing saved."""
    sizes = "15 mm, 15.3 mm"
    found = optimum(0.99, sizes=sizes)
    assert found.rounding is not None
    assert not found.rounding.met
    assert found.robust.sentence.startswith("no design of standard sizes meets")
    assert found.robust.nominal_objective == pytest.approx(plain_mass(sizes), rel=1e-9)
    file, plugin, saved = tmp_path / "d.yaml", tmp_path / "p.py", tmp_path / "saved.yaml"
    file.write_text(one_wish(sizes=sizes), encoding="utf-8")
    plugin.write_text(PLUGIN, encoding="utf-8")
    more = ("--plugin", plugin, "--yield", "0.99", "--write", saved, "--no-record", "--starts", "1")
    result = run("optimise", file, *more, "-v", "--out", tmp_path / "r")
    assert result.code == 1
    assert not saved.exists()
    assert "not written" in result.err
    assert "without margins for scatter" in " ".join(result.out.split())


@pytest.mark.long
def test_choices_are_those_of_the_plain_optimum_and_said_so():
    """The lighter of two rods is kept, told in words and in the record of the choices."""
    text = one_wish() + "\nchoices:\n  rod.material: [steel_42crmo4, ti_6al4v]\n"
    plain = ao.optimise(ao.read(text, plugins=[thick_rod]), prices=False, starts=1)
    found = ao.optimise(
        ao.read(text, plugins=[thick_rod]), yield_target=0.9, prices=False, starts=1
    )
    assert found.choices.best == plain.choices.best
    assert found.best.rod.material == found.choices.best["rod.material"].split()[0]
    assert found.choices.sentence.endswith("without margins for scatter")
    assert "options are those of the optimum without margins" in found.robust.sentence
    assert found.robust.reached


@pytest.mark.parametrize(("rod", "drawn"), [("steel_42crmo4", False), ("ti_6al4v", True)])
def test_scatter_of_a_material_that_is_not_chosen_waits(rod, drawn):
    """What only another choice reads does not scatter, and is no fault."""
    path = "materials.ti_6al4v.density"
    entry = f"uncertainty:\n  {path}:\n    distribution: normal\n    cv: 2 %\n"
    text = one_wish().replace("uncertainty:\n", entry)
    text += "\nchoices:\n  rod.material: [steel_42crmo4, ti_6al4v]\n"
    actuator = ao.read(text, plugins=[thick_rod], set=[("rod.material", rod)])
    found = ao.uncertainty(actuator, count=20, rows=0)
    assert (path in [one.path for one in found.inputs]) == drawn


@pytest.mark.long
def test_the_certificate_speaks_of_limits_without_reserves():
    """The bound holds for what meets the limits themselves: below both optima, and said so."""
    text = ao.read(one_wish(), plugins=[thick_rod])
    found = ao.optimise(text, yield_target=0.9, prices=False, starts=1, certify=True)
    assert found.certificate is not None
    if found.certificate.lower_bound is not None:
        assert found.certificate.lower_bound <= found.robust.nominal_objective * (1 + 1e-6)
        assert "without margins added for scatter" in found.certificate.sentence


@pytest.mark.long
def test_reserves_refused_are_those_of_the_yield():
    """What is said to be lacking is the whole reserve, not a part of it that was tried."""
    found = known(0.99, upper="15.1 mm")
    aimed = 1 - robust.AIM * 0.01
    whole = SPREAD * norm.ppf(aimed) / 15
    assert found.robust.reserves["thick_rod"] == pytest.approx(whole, rel=0.1)
    (joint,) = [one for one in found.infeasibility.joint if one["requirement"] == "thick_rod"]
    assert joint["relaxation"] == pytest.approx(whole - 0.1 / 15, rel=0.2)


@pytest.mark.long
def test_what_does_not_settle_is_said(monkeypatch):
    """Too few rounds: the sentence says that the margins did not converge, and what holds."""
    monkeypatch.setattr(robust, "ROUNDS", 1)
    monkeypatch.setattr(robust, "AIM", 8.0)
    found = optimum(0.95)
    assert not found.robust.converged
    assert not found.robust.reached
    assert "did not converge" in found.robust.sentence
    assert found.robust.upper < 0.95


def test_a_design_that_never_met_its_limits_is_told_as_ever():
    """Infeasible without any reserve: the ordinary card, no word of yields."""
    found = optimum(0.99, upper="14 mm")
    assert found.status == "infeasible"
    assert found.robust is None
    assert found.infeasibility is not None


@pytest.mark.long
def test_same_seed_same_design():
    """The seed fixes the draws, so the design."""
    one, other = known(0.9), optimum(0.9)
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
    assert "is outside the valid range" in fault["message"]


@pytest.mark.long
def test_the_report_tells_of_it(tmp_path):
    """Sentence on page 1, rounds and reserves as tables."""
    from dataclasses import replace

    from actuator_opt.pages.optimum import robust_tables

    found = known(0.9)
    way, reserves = robust_tables(found)
    assert len(way.rows) == len(found.robust.rounds)
    assert "thick_rod" in [row[0] for row in reserves.rows]
    assert list(robust_tables(replace(found, robust=None))) == []


def test_an_interrupt_ends_the_way():
    """Ctrl-C in a round gives the best design of that round, as in any optimisation."""
    from dataclasses import replace

    from actuator_opt.uncertainties.robust import robust as run_robust

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
