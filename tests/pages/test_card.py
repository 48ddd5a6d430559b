"""The card on the terminal: short, misses first, and a green verdict never hides a doubt."""

import re
from dataclasses import replace

import numpy as np
import pytest
import report_fixture as fixture
from cli_runner import DESIGNS, run
from shipped import shipped

import actuator_opt as ao
from actuator_opt.evaluation.result import YieldEstimate
from actuator_opt.metrics.table import ROWS, TERM, term_of
from actuator_opt.pages import card, report
from actuator_opt.rendering import terminal
from actuator_opt.rendering.console import visible

SLOW = "huang_110_80_560"
"""Its oil films take half a minute; its card is among the frozen outputs."""
NAMES = sorted(path.stem for path in DESIGNS.glob("*.yaml") if path.stem != SLOW)


def text(subject, *, width=80, colour=False, unicode=True, **options):
    """The card of a result as text."""
    style = {"width": width, "colour": colour, "unicode": unicode}
    return terminal.blocks_text(card.blocks(subject, **options), **style)


SUBJECTS = {
    "evaluation": fixture.build_evaluation,
    "optimisation": fixture.build_optimisation,
    "infeasible": fixture.build_infeasible,
}


def test_terms_are_short_and_unique():
    """Every metric has a name of at most 24 letters that no other has."""
    terms = [term_of(name) for name in ROWS]
    assert max(map(len, terms)) <= TERM
    assert len(set(terms)) == len(terms)
    assert (term_of("stiffness_min"), term_of("buckling_factor")) == ("stiffness", "buckling")


@pytest.mark.parametrize("name", NAMES)
def test_an_evaluation_fits_thirty_lines_of_eighty_columns(name):
    """Every shipped design; the whole page has more, and the card says how to get it."""
    result = run("evaluate", DESIGNS / f"{name}.yaml", environment={"COLUMNS": "80"})
    lines = result.out.splitlines()
    assert len(lines) <= 30
    paths = [line for line in lines if str(DESIGNS) in line]
    assert all(visible(line) <= 80 for line in lines if line not in paths)
    assert "(-v)" in result.out


def test_verbose_prints_the_whole_page():
    """With -v, every metric, requirement and check as on the page of the library."""
    design = DESIGNS / "course_cylinder.yaml"
    page = report.page(ao.evaluate(design))
    whole = terminal.text(page, colour=False, unicode=True, width=80)
    for option in ("-v", "--verbose"):
        shown = run("evaluate", design, option, environment={"COLUMNS": "80"})
        assert shown.out == whole
    assert len(whole.splitlines()) > 100


@pytest.mark.parametrize("name", ["knee", "steel_baseline"])
def test_an_optimisation_fits_thirty_five_lines(name):
    """Also without prices; all dimensions are there, and what is at a bound is named."""
    optimum = shipped(name)
    shown = text(optimum)
    assert len(shown.splitlines()) <= 35
    assert "optimal (not proven: --certify)" in " ".join(shown.split())
    values = [f"{1e3 * optimum.variables[1].value:.4g}"]
    assert all(value in shown for value in values)
    for row in optimum.variables:
        if row.at_bound is not None:
            assert "at its bound: " in shown


@pytest.mark.parametrize("subject", SUBJECTS)
@pytest.mark.parametrize("width", [40, 80, 160])
def test_lines_fit_and_are_plain_where_they_must_be(subject, width):
    """Any width from 40 columns; ASCII without Unicode; colour adds only codes."""
    result = SUBJECTS[subject]()
    plain = text(result, width=width)
    if width >= 80:
        assert [line for line in plain.splitlines() if visible(line) > width] == []
    assert text(result, width=width, unicode=False).isascii()
    coloured = text(result, width=width, colour=True)
    stripped = re.sub(r"\x1b\[[\d;]*m", "", coloured)
    assert [s.rstrip() for s in stripped.splitlines()] == [s.rstrip() for s in plain.splitlines()]
    assert "\x1b" not in plain


def test_misses_come_first():
    """The headline counts them; the first row is the worst miss, with limit, result and margin."""
    rows = list(fixture.requirements())
    rows[2] = replace(rows[2], met=False, margin=-0.2)
    shown = text(fixture.build_evaluation(requirements=tuple(rows)))
    lines = shown.splitlines()
    assert f"1 of {len(rows)} requirements missed" in lines[0]
    first = next(line for line in lines if line.startswith("✘"))
    assert lines.index(first) == 3
    assert "stiffness" in first
    assert "−20.0 %" in first
    optimisation = fixture.build_optimisation(
        fixture.build_evaluation(requirements=tuple(rows)), kkt=None, sensitivities=()
    )
    limits = [line for line in text(optimisation).splitlines() if " ≥ " in line or " ≤ " in line]
    assert limits[0].split() == first.split()


def test_a_good_verdict_states_every_doubt():
    """No reserve, not checked, unverified, extrapolated, warnings, no proof, low yield."""
    evaluation = fixture.build_evaluation()
    low = YieldEstimate(value=0.016, lower=0.007, upper=0.031, draws=500, worst="buckling_factor",
                        worst_fails=0.86)  # fmt: skip
    evaluation = replace(evaluation, yield_estimate=low)
    optimisation = fixture.build_optimisation(evaluation)
    said = " ".join(text(optimisation).split())
    counts = evaluation.counts
    skipped = sum(check.status == "not_checked" for check in evaluation.checks)
    warned = len(evaluation.warnings) + len(optimisation.warnings)
    assert min(skipped, warned, counts["unverified"], counts["extrapolated"]) > 0
    assert f"{skipped} of {len(evaluation.checks)} checks not checked" in said
    assert f"{counts['unverified']} library value" in said
    assert f"{counts['extrapolated'] + counts['extrapolated_models']} result" in said
    assert f"{warned} warning" in said
    assert "not proven: --certify" in said
    assert "yield: 1.6 % of the actuators built would meet all requirements (0.7 to 3.1 %)" in said
    assert "86 % miss buckling" in said
    assert "--yield 0.99" in said
    tight = len(optimisation.tight)
    assert (f"{tight} limit" in said) == bool(tight)


def test_advice_says_how_to_enforce_it_and_how_to_accept_the_miss():
    """Both ways as printed: the requirement is then missed, and the waiver leaves no advice."""
    start = ao.start()
    shown = text(ao.evaluate(start), width=200)
    path, limit, waiver = re.search(
        r'to enforce it: (\S+)="(.*)"; to accept the miss: (\S+) with a reason', shown
    ).groups()
    enforced = ao.evaluate(start.changed({path: limit}))
    assert not enforced.met
    assert [row.path for row in enforced.requirements if not row.met] == [path]
    accepted = ao.evaluate(start.changed({waiver: "a thin ring suffices"}))
    assert accepted.met
    assert "advice" not in text(accepted, width=200)


@pytest.mark.parametrize(
    ("name", "changes", "cycles"),
    [
        ("knee", {}, 104_170),
        ("knee", {"requirements.fatigue_factor.min": 0.2}, None),
        ("knee", {"requirements.cycle_life.min": 1e5}, None),
        ("knee", {"supply.pressure": "60 bar"}, None),
        ("knee_walking", {}, None),
    ],
    ids=["knee", "factor asked for", "life asked for", "low pressure", "duty cycles"],
)
def test_a_limited_life_stands_beside_the_verdict(name, changes, cycles):
    """A limited life is shown, unless a requirement or duty cycles ask for a life.

    At 60 bar the stresses are 60/210 of those for which the factor is 0.44, so it exceeds 1.
    """
    actuator = ao.read(DESIGNS / f"{name}.yaml").changed(changes)
    evaluation = ao.evaluate(actuator)
    factor = evaluation.metrics["fatigue_factor"].value
    told = "limited life: "
    if cycles is None:
        assert "60 bar" not in changes.values() or factor > 1
        assert evaluation.limited_life is None
        assert told not in text(evaluation)
        return
    assert factor < 1
    assert evaluation.limited_life == evaluation.metrics["cycle_life"].value
    words = f"{told}{cycles:,} pressure cycles".replace(",", "\N{NARROW NO-BREAK SPACE}")
    assert words in text(evaluation, width=200)
    assert report.verdict(evaluation).cautions[0] == words


def test_prices_are_changes_of_the_objective():
    """10 % looser and tighter of each active requirement, from re-solved optima; or none found."""
    optimisation = fixture.build_optimisation()
    required = {row.path: row for row in optimisation.evaluation.requirements}
    row = next(r for r in optimisation.sensitivities if r.active and r.parameter in required)
    sense = required[row.parameter].sense
    ends = {1: row.resolved_10, -1: row.resolved_minus10}
    looser, tighter = (ends[-1], ends[1]) if sense == "min" else (ends[1], ends[-1])
    lines = text(optimisation).splitlines()
    head = next(k for k, line in enumerate(lines) if line.startswith("what holds it"))
    line = lines[head + 1].replace("−", "-")
    words = [
        "none found" if end is None else f"{1e3 * (end - optimisation.objective_value):+.3g} g"
        for end in (looser, tighter)
    ]
    assert line.endswith(words[1])
    assert words[0] in line


def test_nothing_fits():
    """Nearest miss, then changes that keep all requirements, then less; safety only if asked."""
    infeasible = fixture.build_infeasible()
    shown = text(infeasible, again="knee.yaml")
    assert shown.startswith("robot knee: nothing fits. Nearest: running friction ")
    keep, less = shown.index("keep every requirement"), shown.index("ask for less")
    assert keep < shown.index("caps.thickness  5 mm → 6 mm") < less
    assert "retention_factor" not in shown
    assert "--relax-safety" in shown
    assert "--set 'caps.thickness=6 mm'" in " ".join(shown.split())
    assert "not tried: caps.material" in shown
    unsafe = text(infeasible, relax_safety=True)
    assert "requirements.retention_factor.min  1.5 → 1.2" in unsafe


def test_pair_of_choices_and_its_objective():
    """A remedy of two choices names both, and states the objective with them."""
    infeasible = fixture.build_infeasible()
    pair = fixture.cure("choice", "seals.piston.compound", "nbr_90", "nbr_70")
    pair |= {"beside": {"seals.rod.compound": "nbr_70"}, "objective": 0.349}
    found = replace(infeasible.infeasibility, cures=(pair,))
    shown = text(replace(infeasible, infeasibility=found), width=100)
    (line,) = [line for line in shown.splitlines() if line.startswith("1  ")]
    assert "seals.piston.compound  nbr_90 → nbr_70 and seals.rod.compound → nbr_70" in line
    assert line.endswith("349.0 g")
    assert np.isfinite(infeasible.objective_value)
