"""Limits without reserve, quick yields, unverified and extrapolated counts: in words and numbers.

Yields are held against closed forms: the mass of a design is linear in a density, so that the
share of a normal density below its limit is known.
"""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from statistics import NormalDist

import numpy as np
import pytest
import report_fixture as fixture
import scatter_case as case
from scipy.special import betaincinv, ndtri

import actuator_opt as ao
from actuator_opt import api as verbs
from actuator_opt.evaluation import prepare
from actuator_opt.evaluation.result import Check, Unverified, YieldEstimate, without_reserve
from actuator_opt.optimisation.problem import Robust
from actuator_opt.optimisation.result import Optimisation
from actuator_opt.optimisation.stored_results import from_plain, to_plain
from actuator_opt.pages import (
    calibration,
    comparison,
    limits as limit_tables,
    pareto,
    report as page,
    runs,
    sweep,
)
from actuator_opt.rendering import paper, paper_plain as fallback, terminal as renderer
from actuator_opt.rendering.terminal import blocks_text
from actuator_opt.uncertainties.estimate import exact, normal_quantile
from actuator_opt.uncertainties.study import DRAWS, quick_yield

DESIGNS = Path(__file__).parents[2] / "designs"
DENSITY = "materials.steel_42crmo4.density"
KNEE = DESIGNS / "knee_bonded.yaml"


def unchecked(evaluation):
    """The same without its check list, in which the knee at its start misses some lines."""
    return replace(evaluation, checks=())


@pytest.fixture(scope="module")
def optimum():
    """The best knee, without prices."""
    return ao.optimise(KNEE, prices=False)


@pytest.fixture(scope="module")
def wide():
    """The plain knee: only its forces are asked, with a third to spare."""
    return ao.evaluate(ao.read(case.PLAIN))


# ---- the yield ----


@pytest.mark.parametrize("reserve", [0.0, 1.0, -1.0])
def test_yield_of_one_limit_by_symmetry_and_by_the_normal_law(reserve):
    """On its limit half of the actuators hold it; a standard deviation away Phi(1), Phi(-1)."""
    text = case.only({DENSITY: {"distribution": "normal", "cv": "1 %"}})
    plain = ao.read(text)
    mass = ao.evaluate(plain).metrics["mass"].value
    subject = plain.subject()
    part = ao.evaluate(plain.changed({DENSITY: 1.01 * subject.numbers[DENSITY]}))
    deviation = part.metrics["mass"].value - mass  # linear in the density
    assert deviation > 0
    limited = ao.read(text, set={"requirements.mass.max": mass + reserve * deviation})
    evaluation = ao.evaluate(limited)
    held = replace(evaluation, requirements=())  # so that a missed limit is drawn too
    found = quick_yield(limited.subject(), held, seed=3)
    assert found.draws == DRAWS
    assert found.lower < NormalDist().cdf(reserve) < found.upper
    assert found.upper - found.lower < 0.09
    assert found.worst == "mass"
    assert found.worst_fails == pytest.approx(1 - found.value)


def test_a_limit_with_a_tenth_of_reserve_holds_in_every_draw():
    """Ten standard deviations away none of n draws fails: bounds 0.025^(1/n) to 1."""
    text = case.only({DENSITY: {"distribution": "normal", "cv": "1 %"}})
    mass = ao.evaluate(ao.read(text)).metrics["mass"].value
    limited = ao.read(text, set={"requirements.mass.max": 1.1 * mass})
    evaluation = verbs.with_yield(unchecked(ao.evaluate(limited)))
    found = evaluation.yield_estimate
    assert (found.value, found.upper) == (1.0, 1.0)
    assert found.lower == pytest.approx(0.025 ** (1 / DRAWS), rel=1e-9)
    assert evaluation.tight == ()
    assert page.verdict(evaluation).text == "REQUIREMENTS MET"
    assert page.verdict(evaluation).state == "met"
    assert "About 100 %" in " ".join(page.reserve_sentences(evaluation))
    assert "--yield" not in " ".join(page.reserve_sentences(evaluation))


def test_the_optimum_carries_the_yield_that_uncertainty_finds(optimum):
    """The same seed draws the same points; another seed agrees within both bounds."""
    found = optimum.best_evaluation.yield_estimate
    same = ao.uncertainty(optimum.best, count=DRAWS, rows=0)
    assert (found.value, found.lower, found.upper) == pytest.approx(
        (same.rate.value, same.rate.lower, same.rate.upper), abs=1e-9
    )
    other = ao.uncertainty(optimum.best, count=4000, rows=0, seed=11)
    assert found.lower < other.rate.upper
    assert other.rate.lower < found.upper
    worst = other.required[0]
    missed = 1 - worst.rate.value
    apart = 4 * (missed * (1 - missed) * (1 / DRAWS + 1 / 4000)) ** 0.5  # four deviations
    assert (found.worst, found.worst_fails) == (worst.name, pytest.approx(missed, abs=apart))


def test_without_draws_the_reason_and_the_way_on_are_said(wide):
    """Oil films, functions that are missing, an evaluation alone: null, why, and the command."""
    films = prepare(ao.read(DESIGNS / "huang_110_80_560.yaml").design)
    reasons = {
        "oil films": quick_yield(films, replace(wide, requirements=())),
        "draws no samples": wide.yield_estimate,
        "custom metrics": quick_yield(
            ao.read(case.PLAIN).subject(),
            replace(wide, requirements=(replace(wide.requirements[0], metric="mine"),)),
        ),
        "misses a requirement": quick_yield(
            films, replace(wide, requirements=(replace(wide.requirements[0], met=False),))
        ),
    }
    for words, found in reasons.items():
        shown = replace(wide, yield_estimate=found)
        assert found.value is None
        assert words in found.why
        assert shown.to_dict()["reserve"]["yield"] is None
        assert words in shown.to_dict()["reserve"]["why"]
        for text in (fixture.shown(shown, width=200), str(shown)):
            assert f"Yield not estimated ({found.why})" in text
            assert "`actuator-opt uncertainty`" in text


def test_a_block_that_does_not_fit_leaves_the_optimum_and_says_so(wide):
    """An entry on what no model reads: the estimate fails, the result does not."""
    subject = ao.read(case.PLAIN).subject()
    stated = ao.read(case.only({DENSITY: {"distribution": "normal", "cv": "1 %"}}))
    entry = {"control.gain": stated.design.uncertainty[DENSITY]}
    design = subject.design.model_copy(update={"uncertainty": entry})
    found = quick_yield(replace(subject, design=design), wide)
    assert found.value is None
    assert "no model of this design uses this" in found.why


def test_the_yield_asked_for_is_told_by_its_own_sample(optimum):
    """With --yield reached the verdict is green, and the bounds are those of its own draws."""
    robust = Robust(0.9, 0.93, 0.92, 0.94, 10_000, True, 0.2, 0.02, {}, (), (), "it holds")
    found = verbs.optimum.estimated(replace(optimum, robust=robust), ())
    told = found.to_dict()["reserve"]["yield"]
    assert [told[key] for key in ("value", "lower", "upper", "draws")] == [0.93, 0.92, 0.94, 10_000]
    assert page.verdict(found).state == "met"
    assert page.reserve_sentences(found) == []


def test_an_interrupted_search_says_why_there_is_no_yield(optimum):
    """The best so far is kept at once: nothing is drawn."""
    found = verbs.optimum.estimated(replace(optimum, status="interrupted"), ())
    assert found.best_evaluation.yield_estimate.value is None
    assert "interrupted" in found.to_dict()["reserve"]["why"]


def test_the_estimate_survives_its_record(optimum):
    """What a run record keeps gives the same estimate back; an older one has none."""
    kept = to_plain(optimum)
    back = from_plain(Optimisation, kept)
    assert back.best_evaluation.yield_estimate == optimum.best_evaluation.yield_estimate
    assert back.start.yield_estimate.value is None
    kept["result"]["evaluation"] = {"$evaluation": kept["result"]["evaluation"]["$evaluation"][0]}
    assert from_plain(Optimisation, kept).best_evaluation.yield_estimate.value is None


# ---- limits without reserve ----


@pytest.mark.parametrize(
    ("margin", "limit", "without"),
    [
        (0.0, 4.0, True), (-1e-6, 4.0, True), (0.99e-3, 4.0, True), (1.01e-3, 4.0, False),
        (None, 4.0, False), (0.9e-6, 0.0, True), (2e-6, 0.0, False),
    ],
)  # fmt: skip
def test_what_counts_as_no_reserve(margin, limit, without):
    """Below 0.1 % of the limit; of a limit of 0 the tolerance of met."""
    assert without_reserve(margin, limit) is without


def test_every_active_limit_has_no_reserve(optimum):
    """What the optimality conditions call active, found by another way, is counted once each."""
    names = {row.partition(" (")[0] for row in optimum.kkt.active}
    names = {name for name in names if not name.endswith((" lower", " upper"))}
    tight = optimum.best_evaluation.tight
    assert names <= {name.partition(" (")[0] for name in tight}
    assert len(tight) == len(set(tight))
    assert "column buckling at full extension" not in tight  # it is the requirement's own limit
    assert "buckling_factor" in tight


def test_the_verdict_is_amber_where_a_limit_has_no_reserve(optimum):
    """Words and colour on page 1, in the terminal and of print; met and exit code stay."""
    from actuator_opt.api import exit_code

    count = len(optimum.best_evaluation.tight)
    assert count >= 10
    words = f"requirements met, {count} limits without reserve"
    badge = page.verdict(optimum)
    assert (badge.state, badge.text) == ("checks", words.upper())
    shown = fixture.shown(optimum, colour=True, width=500)
    assert f"\x1b[33;1m! {words}\x1b[0m" in shown
    assert "`actuator-opt optimise --yield 0.99`" in shown
    fails = optimum.best_evaluation.yield_estimate.worst_fails
    assert f"buckling_factor is missed most often, by {100 * fails:.0f} %" in shown
    assert "no reserve" in str(optimum)
    assert "Met without reserve (margin below 0.1 %): stiffness_min" in str(optimum)
    data = optimum.to_dict()
    assert data["reserve"]["without"] == list(optimum.best_evaluation.tight)
    assert all(row["met"] for row in data["requirements"])
    assert int(exit_code(optimum)) == 0


def test_rows_without_reserve_are_marked_on_paper_and_in_the_terminal(optimum):
    """The state of a row is a word: it reads in grey and without colour."""
    evaluation = optimum.best_evaluation
    rows = paper.plain_blocks([limit_tables.requirements(evaluation)])[0]["rows"]
    states = {"".join(row[0]): row[6]["text"] for row in rows}
    assert states["buckling_factor"] == "no reserve"
    assert states["burst_factor"] == "met"
    plain = fixture.shown(optimum, unicode=False, width=120)
    rows = [line.split() for line in plain.splitlines()]
    assert [row[0] for row in rows if row[1:2] == ["buckling_factor"]] == ["!"]
    assert any(row[:3] == ["!", "cap", "retention"] for row in rows)


def test_one_limit_reads_as_one(wide, monkeypatch):
    """A singular; and the fallback renderer has the same amber."""
    row = replace(wide.requirements[0], margin=0.0)
    shown = replace(unchecked(wide), requirements=(row, *wide.requirements[1:]))
    assert page.verdict(shown).text == "REQUIREMENTS MET, 1 LIMIT WITHOUT RESERVE"
    data = fixture.page_data(shown, source_text="", source_name="a.yaml", command="")
    drawn = []
    monkeypatch.setattr(fallback, "_draw", lambda sheets, title: drawn.extend(sheets) or (b"", []))
    monkeypatch.setattr(fallback, "embed", lambda pdf, files, timestamp: pdf)
    fallback.render(data | {"title": "", "source": "", "source_file": "", "run": ""}, 0)
    amber = [mark["text"] for mark in drawn[0].marks if mark.get("color") == fallback.AMBER]
    assert amber[0] == "REQUIREMENTS MET, 1 LIMIT WITHOUT RESERVE"
    assert any("values not verified: " in line for line in amber)


def test_a_missed_check_is_not_hidden_by_limits_without_reserve(optimum):
    """CHECKS MISSED stays in the words; the count then stands below, in amber."""
    evaluation = optimum.best_evaluation
    missed = Check("a line", "missed", metric="mass", sense="max", limit=1.0, value=2.0, margin=-1)
    shown = replace(evaluation, checks=(*evaluation.checks, missed))
    badge = page.verdict(shown)
    assert badge.text == "REQUIREMENTS MET, CHECKS MISSED"
    assert any("limits without reserve" in line for line in badge.cautions)


# ---- counts ----


def test_counts_of_unverified_and_extrapolated_stand_on_page_one(wide):
    """Amber where there are some, plain where there are none; the same numbers in JSON."""
    evaluation = ao.evaluate(
        ao.read(DESIGNS / "aalto_40_25_220.yaml", set={"requirements.cycle_life.min": 1e6})
    )
    flagged = [m for m in evaluation.metrics.values() if not m.in_range]
    models = [m for m in evaluation.models if not m.in_range]
    assert flagged
    assert evaluation.to_dict()["counts"] == {
        "unverified": len(evaluation.unverified),
        "extrapolated": len(flagged),
        "extrapolated_models": len(models),
    }
    badge = page.verdict(evaluation)
    assert badge.cautions == [
        f"values not verified: {len(evaluation.unverified)}",
        f"EXTRAPOLATED: {len(flagged)} result, {len(models)} model",
    ]
    shown = fixture.shown(evaluation, colour=True)
    assert f"\x1b[33mvalues not verified: {len(evaluation.unverified)}; EXTRAPOLATED" in shown
    assert "extrapolated: cycle_life" in shown
    table = paper.plain_blocks([limit_tables.requirements(evaluation)])[0]
    names = ["".join(row[0]) for row in table["rows"]]
    assert "cycle_life (!)" in names
    assert "(!) EXTRAPOLATED" in table["note"]
    assert "cycle_life (!)" in fixture.shown(evaluation, width=120)
    clean = replace(
        evaluation,
        unverified=(),
        metrics={name: replace(m, in_range=True) for name, m in evaluation.metrics.items()},
        models=tuple(replace(m, in_range=True) for m in evaluation.models),
    )
    badge = page.verdict(clean)
    assert badge.cautions == []
    assert badge.lines[-2:] == ["values not verified: 0", "EXTRAPOLATED: 0 results"]
    one = replace(clean, unverified=(Unverified("a", "b", "c", "d"),))
    assert page.verdict(one).cautions == ["values not verified: 1"]


# ---- brothers ----


def test_other_places_that_say_met_say_it_without_reserve_too(optimum):
    """Compared designs, recorded runs, fronts, calibrations."""
    evaluation = optimum.best_evaluation
    count = len(evaluation.tight)
    beside = verbs.compare(optimum, KNEE)
    assert comparison.named(beside, 0).endswith(f"met, {count} limits without reserve")
    assert beside.to_dict()["designs"][0]["without_reserve"] == list(evaluation.tight)
    head = {"kind": "optimise", "status": "optimal", "met": True, "without_reserve": count}
    assert runs.outcome(head) == f"met, {count} without reserve"
    listing = runs.listing([("one", head)])
    assert "\x1b[33mmet, " in blocks_text([listing], colour=True, unicode=True, width=100)

    class Front:
        points, knee = (1, 2), None

    Front.evaluation = evaluation
    badge = pareto.verdict(Front())
    assert badge.state == "checks"
    assert badge.cautions[0] == f"first design: {count} limits without reserve"
    assert badge.cautions[1:] == page.doubts(evaluation)[1]

    class Changes:
        best_after = optimum

    Changes.evaluation = evaluation
    badge = calibration.verdict(Changes())
    assert badge.text == f"REDESIGN MEETS ALL, {count} LIMITS WITHOUT RESERVE"
    assert badge.cautions == page.doubts(evaluation)[1]
    assert badge.state == "checks"


def test_the_best_of_a_sweep_say_that_they_have_no_reserve(optimum):
    """Around an optimum the least margin is 0; with limits relaxed by far there is no remark."""
    swept = ao.sweep(optimum.best, ["fluid.air_content=0.5 %,0.6 %"], workers=1)
    assert len(swept.best) == 1  # more air is less stiff
    shown = renderer.text(sweep.page(swept), colour=True)
    assert "\x1b[33m1 of the best designs: no reserve (least margin below 0.1 %)" in shown
    with_room = replace(swept.best[0], row=(*swept.best[0].row[:-3], 0.02, *swept.best[0].row[-2:]))
    swept.best[:] = [with_room]
    assert "without reserve" not in renderer.text(sweep.page(swept))


# ---- light ----


def test_quantiles_and_bounds_are_those_of_scipy():
    """The inverse normal to 1e-14 of its value, exact bounds to 1e-12 [Clopper1934]."""
    shares = np.concatenate([np.linspace(0.001, 0.999, 999), 10.0 ** -np.arange(2.0, 15.0)])
    shares = np.concatenate([shares, 1 - shares[shares > 1e-9]])
    np.testing.assert_allclose(normal_quantile(shares), ndtri(shares), rtol=1e-14, atol=1e-15)
    for count in (1, 20, 500, 2000):
        for hits in {0, 1, count // 3, count - 1, count}:
            bounds = exact(hits, count)
            lower = betaincinv(hits, count - hits + 1, 0.025) if hits else 0.0
            upper = betaincinv(hits + 1, count - hits, 0.975) if hits < count else 1.0
            assert (bounds.lower, bounds.upper) == pytest.approx((lower, upper), abs=1e-12)


def test_the_estimate_loads_no_scipy():
    """It alone takes as long to load as a knee takes to optimise."""
    code = (
        "import sys\n"
        "import actuator_opt as ao\n"
        "from actuator_opt import api as verbs\n"
        f"found = verbs.with_yield(ao.evaluate({str(DESIGNS / 'aalto_40_25_220.yaml')!r}))\n"
        "assert found.yield_estimate.draws == 500\n"
        "assert 'scipy' not in sys.modules, 'scipy was imported'\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_the_estimate_is_the_same_for_the_same_seed(optimum):
    """Same input, same bytes."""
    evaluation = optimum.best_evaluation
    first, again, other = (verbs.with_yield(evaluation, seed=seed) for seed in (0, 0, 1))
    assert first.yield_estimate == again.yield_estimate == evaluation.yield_estimate
    assert first.yield_estimate != other.yield_estimate
    assert YieldEstimate(value=0.5, lower=0.4, upper=0.6, draws=9).sentence == (
        "About 50 % of the actuators built to this design would meet every requirement "
        "(40 to 60 %, 9 samples)."
    )
