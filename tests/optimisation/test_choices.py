"""Choices: what a file may list, what the optimiser makes of it, against brute force."""

from __future__ import annotations

import functools
import itertools
import json
import math
from dataclasses import replace

import cli_runner
import pytest
import report_fixture as fixture
from cli_runner import DESIGNS, evaluated, refused, run
from hypothesis import given, settings, strategies as st
from shipped import KNEE, PLAIN_KNEE, SLEEVE

import actuator_opt as ao
from actuator_opt.api import examine
from actuator_opt.base import units
from actuator_opt.base.errors import InputError
from actuator_opt.design import choice_list, read_design
from actuator_opt.design.schema import json_schema
from actuator_opt.design.structure import child_at
from actuator_opt.design.writer import to_yaml
from actuator_opt.optimisation import choices
from actuator_opt.optimisation.choices import possible
from actuator_opt.pages.optimum import MOST_ROWS, heads, sizes_and_choices

BENCH = cli_runner.BENCH.replace("12.2 %", "16 %")
"""The bench design with rings squeezed enough for every check of the seals."""

SEALS = {"seals.rod.compound": "[nbr_90, nbr_70]", "seals.rod.count": "[1, 2]"}
LAYER = "      angle: 88 deg\n      thickness: 1.2 mm\n"
FIXED = BENCH[: BENCH.index("variables:")] + BENCH[BENCH.index("requirements:") :]
"""The bench design without variables."""


def listed(lists, text=BENCH):
    """A design text with choices: PATH to the list as it is written."""
    lines = "".join(f"  {path}: {values}\n" for path, values in lists.items())
    return f"{text}choices:\n{lines}"


@functools.cache
def optimum(text, **options):
    """The optimisation of a design text, without prices."""
    return ao.optimise(ao.read(text), **({"prices": False, "starts": 2} | options))


def alone(text, values):
    """A design text read with the values of one combination and no choices left."""
    actuator = ao.read(text).changed(values)
    return replace(actuator, design=actuator.design.model_copy(update={"choices": {}}))


FAULTS = [
    ("seals.rod.compound: [nbr_7, nbr_90]", '"nbr_7": unknown material', "nbr_70"),
    (
        "seals.rod.compound: [nbr_90, steel_e355]",
        "a material of kind metal cannot be used",
        "use e.g.",
    ),
    ("seals.rod.count: [1.5, 2]", "1.5: must be a whole number", "write 1"),
    ("seals.rod.section: [1.78, 2.62 mm]", "unit missing", "1.78 mm"),
    ("seals.rod.section: [2 bar]", "bar is a pressure", "mm"),
    ("seals.rod.section: [900 mm]", "outside the valid range", "30 mm"),
    ("seals.rod.section: [1.78 mm, 0.178 cm]", "the same as value 1", "keep one"),
    ("cylinder.bore: [20 mm, 25 mm]", "is also a variable", "variables or in choices"),
    ("seals.rod.count: 2", 'need a list of allowed values, not "2"', "write [2]"),
    ("seals.rod.count: []", "the list is empty", "write e.g. [1]"),
    ("seals.rod.count:", "no value", "write one"),
    ("seals.rod.section: [[1 mm]]", "not a list", "write one value"),
    ("seals.rod.type: [o_ring, o_rng]", '"o_rng" is not a choice', "o_ring"),
    ("seals.rod.compond: [nbr_70]", "unknown PATH", "seals.rod.compound"),
    ("seals.rod: [nbr_70]", "names a block", "add one of"),
    ("name: [a, b]", "is not a value of an actuator part", "write the PATH of a part's number"),
    (
        "requirements.seal_gap.max: [1 um]",
        "is not a value of an actuator part",
        "write the PATH of a part's number",
    ),
    ("load_cases[stance].name: [walk]", "is free text", "write the PATH of a part's number"),
    ("load_cases[0].force: [1 kN]", "is not the canonical PATH", "load_cases[stance].force"),
    ("barrel.layup[7].material: [t700_epoxy]", "has no entry 7", "use one of"),
    ("caps.material: [none, steel_e355]", "none: the block caps is needed", "remove none from"),
    ("barrel.layup[0].material: [none]", "the block barrel.layup[0] is needed", "remove none from"),
    ("head.bearing: [none]", '"none": unknown material', "use one of"),
    ("clevis.pin_diameter: [none, 8 mm]", '"none" is not a number', "mm"),
    (f"seals.rod.count: [{', '.join(['1'] * 51)}]", "51 values are too many", "at most 50"),
]


@pytest.mark.parametrize(("line", "message", "remedy"), FAULTS)
def test_a_faulty_choice_is_one_line_at_its_place(line, message, remedy):
    """Every fault of the block stands at its own line, says what is wrong and what to do."""
    text = f"{BENCH}choices:\n  {line}\n"
    (fault,) = refused(text)
    assert fault["line"] == text.count("\n")
    assert message in fault["message"]
    assert remedy in fault["remedy"]


def test_the_block_itself_can_be_faulty():
    """A word or a list instead of the block, and the same PATH twice, are faults of one line."""
    assert "need a block" in refused(f"{BENCH}choices: 3\n")[0]["message"]
    assert "need a block" in refused(f"{BENCH}choices: [seals]\n")[0]["message"]
    twice = f"{BENCH}choices:\n  seals.rod.count: [1]\n  seals.rod.count: [2]\n"
    assert "duplicate key" in refused(twice)[0]["message"]


def test_a_million_combinations_are_refused_at_once():
    """The product of the lists is refused where the file is read, not after hours."""
    sections = ", ".join(f"{1 + k / 100:.2f} mm" for k in range(50))
    lists = {f"seals.{name}.section": f"[{sections}]" for name in ("piston", "rod")}
    lists |= {"piston.length": f"[{', '.join(f'{10 + k} mm' for k in range(40))}]"}
    lists |= {"seals.rod.count": "[1, 2]", "seals.piston.count": "[1, 2, 3, 4, 5]"}
    (fault,) = refused(listed(lists))
    assert "1000000 combinations are too many" in fault["message"]
    assert "at most 1000" in fault["remedy"]


def test_a_list_cannot_be_set_from_outside():
    """--set takes one value: a list of choices is changed in the file, and the message says so."""
    (fault,) = refused(listed(SEALS), "--set", "choices.seals.rod.count=2")
    assert "is a list" in fault["message"]
    assert "in the file" in fault["remedy"]


def test_every_kind_of_value_is_read_as_its_field_reads_it():
    """Names, words, counts, lengths, yes or no and positions all become what a design holds."""
    lists = SEALS | {
        "seals.rod.section": "[1.78 mm, 0.262 cm]",
        "load_cases[stance].position": "[worst, 50 %, 55 mm]",
        "barrel.criterion": "[puck, hashin]",
        "environment.wet": "[yes, no]",
        "barrel.layup[1].material": "[t700_epoxy, im7_8552]",
    }
    found = ao.read(listed(lists)).design.choices
    assert found["seals.rod.compound"] == ("nbr_90", "nbr_70")
    assert found["seals.rod.count"] == (1.0, 2.0)
    assert found["seals.rod.section"] == pytest.approx((1.78e-3, 2.62e-3), rel=1e-12)
    worst, share, length = found["load_cases[stance].position"]
    assert (worst, choice_list.plain(share), length) == ("worst", "50 %", 0.055)
    assert found["environment.wet"] == (True, False)


def test_evaluate_takes_the_design_as_it_stands():
    """The block changes no metric: only the optimiser reads it."""
    with_choices, without = evaluated(listed(SEALS)), evaluated(BENCH)
    assert with_choices["metrics"] == without["metrics"]
    assert with_choices["checks"] == without["checks"]


def brute_force(text, result, **options):
    """Objective of the best combination when each is optimised by itself from many starts."""
    objectives = {}
    paths = list(result.choices.best)
    for one in result.choices.combinations:
        if one.how == "not possible":
            continue
        found = ao.optimise(alone(text, dict(one.values)), prices=False, **options)
        met = found.status == "optimal"
        key = tuple(one.values[path] for path in paths)
        objectives[key] = found.objective_value if met else math.inf
    return objectives, tuple(result.choices.best[path] for path in paths)


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "lists"),
    [
        pytest.param(
            None,
            SEALS | {"caps.material": "[ti_6al4v, steel_42crmo4]"},
            marks=pytest.mark.long,
        ),
        ("steel_baseline", {"rod.material": "[steel_42crmo4, steel_17_4ph_h1025]"}),
        ("knee_bonded", {"barrel.layup[2].material": "[t700_epoxy, im7_8552]"}),
        pytest.param(
            "aerospace",
            {"caps.material": "[ti_6al4v, steel_42crmo4]"},
            marks=pytest.mark.long,
        ),
    ],
)
def test_the_winner_is_that_of_brute_force(name, lists):
    """Many starts for each combination by itself find no better one and no better objective.

    What was looked at quickly is within 0.1 % of what many starts find.
    """
    shipped = BENCH if name is None else (DESIGNS / f"{name}.yaml").read_text(encoding="utf-8")
    text = listed(lists, shipped.rstrip() + "\n")
    result = optimum(text, starts=3)
    objectives, best = brute_force(text, result, starts=3)
    assert result.choices.combinations[0].how == "multistart"
    good = {key: value for key, value in objectives.items() if math.isfinite(value)}
    assert good
    missed = [one for one in result.choices.combinations if one.cost is not None and one.cost < 0]
    if not missed:
        assert objectives[best] == pytest.approx(min(good.values()), rel=1e-6)
    assert result.objective_value == pytest.approx(objectives[best], rel=1e-6)
    for one in result.choices.combinations:
        alone_found = objectives.get(tuple(one.values.values()), math.inf)
        assert one.feasible == math.isfinite(alone_found)
        if one.feasible:
            assert one.objective == pytest.approx(alone_found, rel=1e-3)


def test_many_starts_for_the_best_and_few_for_the_next(monkeypatch):
    """Of eight combinations, the best has all starts, the next a few, all others a quick look."""
    solved = []
    solve = choices.solve

    def counted(problem, **options):
        solved.append((options["starts"], options["samples"]))
        return solve(problem, **options)

    monkeypatch.setattr(choices, "solve", counted)
    lists = SEALS | {"caps.material": "[ti_6al4v, steel_42crmo4]"}
    found = optimum(listed(lists), starts=6).choices
    assert len(found.combinations) == 8
    assert found.combinations[0].how == "multistart"
    assert found.count("multistart") == 1
    assert 1 <= found.count("few starts") < choices.MOST_SOLVED
    few = [(choices.FEW_STARTS, choices.FEW_SAMPLES)] * found.count("few starts")
    assert solved == [(6, 2048), *few]


def test_the_result_is_that_of_the_chosen_combination_alone():
    """Optimum, prices and multipliers are those of the design with the chosen values written in."""
    text = listed(SEALS)
    result = ao.optimise(ao.read(text), starts=2)
    single = ao.optimise(alone(text, dict(result.choices.best)), starts=2)
    assert result.objective_value == pytest.approx(single.objective_value, rel=1e-9)
    prices = {row.parameter: row.price for row in single.sensitivities}
    assert {row.parameter for row in result.sensitivities} == set(prices)
    for row in result.sensitivities:
        assert row.price == pytest.approx(prices[row.parameter], rel=1e-5, abs=1e-12)


def test_combinations_are_sorted_and_priced_against_the_best():
    """Those that meet everything come first, by objective; the cost is the difference, >= 0."""
    result = optimum(listed(SEALS | {"seals.rod.section": "[1.78 mm, 2.62 mm]"}))
    rows = result.choices.combinations
    assert len(rows) == 8 == result.choices.tried
    feasible = [one for one in rows if one.feasible and "misses" not in one.status]
    assert feasible == list(rows[: len(feasible)])
    for one in feasible:
        assert one.cost == pytest.approx(one.objective - rows[0].objective, abs=1e-6)
        assert one.cost >= 0
    for one in rows:
        assert one.feasible or "misses" in one.status


def test_without_variables_every_combination_is_evaluated():
    """The record repeats what evaluating each design gives, and the best of them is returned."""
    text = listed(SEALS | {"caps.thickness": "[6 mm, 8 mm, 10 mm]"}, FIXED)
    result = optimum(text)
    assert result.choices.count("evaluated") == 12
    assert result.variables == ()
    assert result.kkt is None
    assert result.sensitivities == ()
    masses = []
    for one in result.choices.combinations:
        evaluation = ao.evaluate(alone(text, dict(one.values)))
        assert one.feasible == evaluation.met
        assert one.objective == pytest.approx(evaluation.metrics["mass"].value, rel=1e-12)
        missed = sum(check.status == "missed" for check in evaluation.checks)
        masses.append((not evaluation.met, missed, evaluation.metrics["mass"].value))
    assert masses[0] == min(masses)
    assert result.evaluation.metrics["mass"].value == result.choices.combinations[0].objective


def test_all_combinations_evaluated_are_a_proof():
    """--certify where nothing else may move: the bound is the least mass of all that meet all."""
    text = listed(SEALS | {"caps.thickness": "[6 mm, 8 mm, 10 mm]"}, FIXED)
    result = ao.optimise(ao.read(text), certify=True)
    met = [one.objective for one in result.choices.combinations if one.feasible]
    proven = result.certificate
    assert proven.lower_bound == min(met)
    assert proven.gap == pytest.approx(1 - min(met) / result.objective_value, abs=1e-15)
    assert "all 12 combinations were evaluated" in proven.sentence
    stiff = ao.optimise(
        ao.read(text.replace("minimise: mass", "maximise: stiffness_min")), certify=True
    )
    assert (stiff.certificate.lower_bound, stiff.certificate.gap) == (None, None)
    assert "evaluated" in stiff.certificate.sentence


def test_a_maximised_metric_ranks_the_other_way_round():
    """With `maximise` the largest value wins, and the cost of the others is still positive."""
    text = listed({"caps.thickness": "[6 mm, 8 mm, 10 mm]"}, FIXED)
    result = optimum(text.replace("minimise: mass", "maximise: mass"))
    assert result.choices.best["caps.thickness"] == pytest.approx(0.010)
    met = [one for one in result.choices.combinations if one.feasible]
    assert [one.objective for one in met] == sorted((o.objective for o in met), reverse=True)
    assert all(one.cost > 0 for one in met[1:])


def test_weighted_objectives_of_all_combinations_have_one_scale():
    """Each metric is divided by its value in the file's design, not in the combination's own."""
    goal = "minimise:\n    mass: 2\n    friction_running: 1"
    text = listed(SEALS, FIXED.replace("minimise: mass", goal))
    result = optimum(text)
    base = ao.evaluate(ao.read(text)).metrics
    for one in result.choices.combinations:
        own = ao.evaluate(alone(text, dict(one.values))).metrics
        parts = [
            weight * own[name].value / base[name].value
            for name, weight in (("mass", 2), ("friction_running", 1))
        ]
        assert one.objective == pytest.approx(sum(parts), rel=1e-9)


def test_of_equals_the_first_listed_wins():
    """Words that change nothing in the objective leave the file's order: no false preference."""
    for order in ("[hertz_lindley, plane_strain]", "[plane_strain, hertz_lindley]"):
        result = optimum(listed({"seals.piston.law": order}, FIXED))
        assert result.choices.best["seals.piston.law"] == order[1:-1].split(", ")[0]
        assert [one.cost for one in result.choices.combinations] == [0.0, 0.0]


def test_a_check_that_choosing_mends_counts():
    """A lighter combination that misses a check which others meet ranks below them.

    It says so; a check missed by all of them decides nothing.
    """
    text = listed({"seals.rod.section": "[1.78 mm, 2.62 mm]"}, FIXED)
    text = text.replace(text[text.index("waivers:") : text.index("objective:")], "")
    text = text.replace("max: 500 N", "max: 900 N")
    result = optimum(text)
    missed = [
        {check.name for check in ao.evaluate(alone(text, dict(one.values))).checks
         if check.status == "missed"}
        for one in result.choices.combinations
    ]  # fmt: skip
    mendable = set.union(*missed) - set.intersection(*missed)
    assert missed[0] & mendable <= missed[1] & mendable
    for one, names in zip(result.choices.combinations, missed, strict=True):
        if one.feasible:
            assert ("which other choices meet" in one.status) == bool(names & mendable)


def test_a_contradiction_leaves_out_its_combination_only():
    """A thread that the file does not describe is no retention; the bond is optimised."""
    result = optimum(listed({"retention.type": "[thread, bond]"}))
    good, bad = result.choices.combinations
    assert good.values["retention.type"] == "bond"
    assert good.feasible
    assert bad.how == "not possible"
    assert bad.objective is None
    assert not bad.feasible
    assert "retention.thread" in bad.status
    assert result.choices.tried == 1


def test_check_warns_of_a_choice_that_is_never_possible():
    """The thread lacks its keys in every combination; the bond only with a metal."""
    lists = {
        "retention.type": "[thread, bond]",
        "retention.material": "[epoxy_structural, steel_bolt_12_9]",
    }
    (warning, metal) = examine(listed(lists)).warnings
    assert "choices.retention.type: no combination with thread" in warning
    assert "retention.thread: missing" in warning
    assert "no combination with steel_bolt_12_9" in metal
    assert examine(DESIGNS / "knee_choices.yaml").warnings == []


@pytest.mark.long
def test_without_and_with_a_sleeve_is_the_better_of_two_files():
    """`none` is the file without the block and its variables.

    The liner in the file is too thin for the thread, which the search without a sleeve mends.
    """
    thin = KNEE.replace("thickness: 1.85 mm", "thickness: 0.7 mm")
    result = optimum(listed({"retention.sleeve.material": "[none, al_7075_t6]"}, thin))
    plain, sleeve = (optimum(text) for text in (PLAIN_KNEE, KNEE))
    assert sleeve.objective_value < 0.95 * plain.objective_value
    assert result.objective_value == pytest.approx(sleeve.objective_value, rel=1e-6)
    assert result.choices.best == {"retention.sleeve.material": "al_7075_t6"}
    _, other = result.choices.combinations
    assert other.objective == pytest.approx(plain.objective_value, rel=1e-3)
    assert ao.read(KNEE).changed({"retention.sleeve.material": "none"}).design == (
        ao.read(PLAIN_KNEE).design
    )


def test_equal_combinations_are_tried_once():
    """A bond has no sleeve, and a sleeve that is left out has no wall."""
    looks = possible(ao.read(DESIGNS / "knee_choices.yaml").subject())
    kept = [tuple(look.values.values())[::2] for look in looks if not look.fault]
    assert kept == [
        ("bond", "none"),
        ("plug_thread", "none"),
        ("plug_thread", "al_7075_t6"),
        ("retaining_ring", "none"),
        ("retaining_ring", "al_7075_t6"),
    ]
    (bond,) = (look for look in looks if "the same design" in look.fault and look.order == 1)
    assert bond.fault.endswith(
        "retention.type: bond, retention.material: epoxy_structural, "
        "retention.sleeve.material: none"
    )
    lists = {
        "retention.sleeve.material": "[none, al_7075_t6]",
        "retention.sleeve.inner_length": "[8 mm, 9 mm]",
    }
    text = KNEE.replace(SLEEVE[1], "")
    looks = possible(ao.read(listed(lists, text)).subject())
    assert [bool(look.fault) for look in looks] == [False, True, False, False]
    assert [look.subject.design.retention.sleeve for look in looks[:1]] == [None]


def test_none_removes_an_optional_block_with_its_entries_in_tables():
    """Variables, measured values and uncertainty of the block's numbers are removed too."""
    text = KNEE + (
        "measured:\n  retention.sleeve.wall:\n    lower: 2.5 mm\n    upper: 2.7 mm\n"
        "    record: wall.csv\n"
        "uncertainty:\n  retention.sleeve.wall:\n    distribution: uniform\n"
        "    half_width: 0.1 mm\n    source: drawing\n"
    )
    before = ao.read(text)
    design = before.changed({"retention.sleeve.material": "none"}).design
    assert "retention.sleeve.wall" in before.design.measured
    assert "retention.sleeve.wall" in before.design.uncertainty
    assert not {**design.measured, **design.uncertainty}
    assert not any("sleeve" in path for path in design.variables)
    for path in ("seals.static.compound", "piston.nut.diameter", "clevis.material"):
        block = path.rpartition(".")[0]
        changed = before.changed({path: "none"}).design
        assert child_at(changed, tuple(block.split("."))) is None
        assert not any(variable.startswith(block) for variable in changed.variables)


def test_none_is_impossible_where_another_block_needs_it():
    """A plug that is screwed in has a thread in every combination; check says so."""
    lists = {"retention.thread.pitch": "[none, 0.75 mm]"}
    (warning,) = examine(listed(lists, PLAIN_KNEE)).warnings
    assert "choices.retention.thread.pitch: no combination with none is possible" in warning
    assert "retention.thread: missing" in warning
    (fault,) = refused(listed({"retention.thread.pitch": "[none]"}, KNEE), command="check")
    assert "retention.thread: missing" in fault["message"]


def test_impossible_choices_are_refused_in_one_line():
    """Where every combination contradicts itself, check and optimise say why; evaluate works."""
    text = listed({"retention.type": "[thread, tie_rods]"})
    for command in ("check", "optimise"):
        (fault,) = refused(text, command=command)
        assert "all 2 combinations are impossible" in fault["message"]
        assert "retention.thread" in fault["message"]
        assert fault["path"] == "choices"
    (fault,) = refused(listed({"retention.type": "[thread]"}), command="check")
    assert "the only combination is impossible" in fault["message"]
    evaluated(text)


def test_where_nothing_fits_the_nearest_is_explained():
    """No combination meets a wish beyond all of them: exit 1, the card, the count of none."""
    text = listed(SEALS).replace("min: 6 kN/mm", "min: 600 kN/mm")
    result = run("optimise", "-", "--json", "--starts", 1, stdin=text.encode())
    assert result.code == 1
    data = result.json
    assert data["status"] == "infeasible"
    assert data["choices"]["feasible"] == 0
    assert data["infeasibility"]["joint"]
    assert "none of 4 combinations" in data["choices"]["outcome"]
    fixed = listed(SEALS, FIXED).replace("min: 6 kN/mm", "min: 600 kN/mm")
    result = run("optimise", "-", "--json", stdin=fixed.encode())
    assert result.code == 1
    assert result.json["status"] == "infeasible"
    assert "misses stiffness_min" in result.json["choices"]["found"]["status"]


def test_one_combination_is_an_optimisation_like_any_other():
    """A single value per PATH sets it; the optimum is that of the design with it."""
    text = listed({"seals.rod.compound": "[nbr_70]"})
    result = optimum(text)
    head, rod, tail = BENCH.rpartition("nbr_90")
    single = optimum(f"{head}nbr_70{tail}")
    assert rod
    assert result.objective_value == pytest.approx(single.objective_value, rel=1e-9)
    assert result.design.seals.rod.compound == "nbr_70"
    (note,) = result.choices.notes
    assert "seals.rod.compound" in note
    assert "nbr_90" in note
    assert "not among" in note


def test_a_time_limit_keeps_a_design_and_says_what_was_not_tried():
    """With no time at all the first combination still gives a design; the rest says so."""
    result = optimum(listed(SEALS), max_seconds=1e-3)
    data = result.choices.to_dict()
    assert not data["complete"]
    assert data["tried"] >= 1
    assert any("not tried" in one["status"] for one in data["runners_up"])
    assert result.design.seals.rod.compound in ("nbr_90", "nbr_70")


@pytest.mark.long
def test_json_says_what_was_chosen_and_what_the_others_cost():
    """The keys of `choices`, numbers in SI, runners-up sorted, nothing that is no JSON."""
    text = listed(SEALS | {"load_cases[stance].position": "[50 %]"})
    result = run("optimise", "-", "--json", "--starts", 1, stdin=text.encode())
    assert result.code == 0
    choices = result.json["choices"]
    assert set(choices) == {
        "outcome", "combinations", "tried", "feasible", "complete", "best", "found",
        "runners_up", "notes",
    }  # fmt: skip
    assert choices["tried"] == 4
    assert choices["complete"]
    assert choices["best"]["load_cases[stance].position"] == "50 %"
    assert set(choices["runners_up"][0]["values"]) == set(choices["best"])
    assert choices["found"]["objective"] == result.json["objective"]["value"]
    plain = run("optimise", "-", "--json", "--starts", 1, stdin=BENCH.encode())
    assert plain.json["choices"] is None


def test_the_terminal_shows_the_table_without_colour_or_unicode(tmp_path):
    """The table has a row per combination, the chosen one first; NO_COLOR leaves no codes."""
    result = run(
        "optimise", "-", "-v", "--starts", 1, "--out", tmp_path, stdin=listed(SEALS).encode(),
        encoding="ascii", environment={"NO_COLOR": "1", "COLUMNS": "100"},
    )  # fmt: skip
    assert result.code == 0
    assert "\x1b" not in result.out
    start = result.out.index("Choices: rod.compound")
    table = result.out[start:].splitlines()
    assert table[1].split()[:2] == ["rod.compound", "rod.count"]
    assert table[2].split()[0] == table[0].split()[2].rstrip(",")
    assert max(map(len, table[:6])) <= 100


def test_the_report_has_the_table_with_or_without_variables():
    """The page lists the combinations; where there are no choices it has no such table."""
    for text in (listed(SEALS), listed(SEALS, FIXED)):
        result = optimum(text, starts=1)
        made = fixture.page_data(result, source_text=text, source_name="d", command="")
        (table,) = (b for b in made["blocks"] if b.get("title", "").startswith("Choices"))
        assert len(table["rows"]) == 4
        json.dumps(table)
    assert "Choices" not in fixture.shown(optimum(BENCH, starts=1))


def test_many_combinations_are_cut_in_the_table_not_in_the_record():
    """The table keeps to its length and says how many there are; five PATHs share one column."""
    lists = SEALS | {
        "caps.thickness": "[7 mm, 8 mm]",
        "piston.length": "[14 mm, 15 mm]",
        "head.length": "[14 mm, 15 mm, 16 mm]",
    }
    result = optimum(listed(lists, FIXED))
    assert len(result.choices.combinations) == 48
    shown = fixture.shown(result, width=120)
    assert f"The best {MOST_ROWS} combinations" in shown
    assert "head.length 1" in shown
    (table,) = sizes_and_choices(result)
    assert len(table.rows) == MOST_ROWS


def test_heads_tell_equal_endings_apart():
    """Two PATHs with one ending get as many words as they need."""
    paths = ["load_cases[a].force", "seals.rod.secondary.count", "lines[0].secondary.count"]
    assert heads(paths) == ["load_cases[a].force", "rod.secondary.count", paths[2]]


def test_write_keeps_the_block_and_repeats_the_optimum(tmp_path):
    """The chosen values stand in the file, comments and choices too; evaluate repeats the mass."""
    text = listed({"seals.rod.compound": "[nbr_70]  # soft"}).replace(
        "squeeze: 16 %", "squeeze: 16 %   # kept", 1
    )
    target = tmp_path / "chosen.yaml"
    arguments = ("optimise", "-", "--json", "--starts", 1, "--write", target)
    result = run(*arguments, stdin=text.encode())
    assert result.code == 0
    written = target.read_text(encoding="utf-8")
    assert "[nbr_70]  # soft" in written
    assert "# kept" in written
    again = ao.read(target)
    assert again.design.seals.rod.compound == "nbr_70"
    assert again.design.choices == {"seals.rod.compound": ("nbr_70",)}
    assert ao.evaluate(again).metrics["mass"].value == result.json["objective"]["value"]


def test_the_winner_is_rounded_to_whole_plies():
    """With --whole-plies the chosen combination is rounded; the record is that of the choices."""

    def laid(text):
        return functools.reduce(
            lambda changed, pair: changed.replace(*pair), cli_runner.PLIES, text
        )

    result = optimum(listed(SEALS, laid(BENCH)), whole_plies=True)
    assert result.rounding is not None
    assert result.rounding.met
    assert result.best.seals.rod.compound == result.choices.best["seals.rod.compound"]
    plies = result.best.barrel.layup[1].thickness / 0.2e-3
    assert plies == pytest.approx(round(plies), abs=1e-9)
    with pytest.raises(InputError, match="nothing to round"):
        optimum(listed(SEALS, laid(FIXED)), whole_plies=True)


def test_the_schema_offers_every_list():
    """A value that the reader takes is one the schema takes, and the other way round."""
    jsonschema = pytest.importorskip("jsonschema")
    validator = jsonschema.Draft7Validator(json_schema())
    tree = read_design(listed(SEALS)).source.document.data
    assert not list(validator.iter_errors(tree))
    for path, values in [
        ("seals.rod.section", ["1.78"]),
        ("seals.rod.count", []),
        ("seals.rod.type", ["o_rng"]),
        ("cylinder.boer", ["1 mm"]),
        ("piston.clearance", ["none"]),
        ("barrel.layup[1].thickness", ["2 bar"]),
    ]:
        assert list(validator.iter_errors(tree | {"choices": {path: values}})), path
    for path, values in [
        ("load_cases[swing].position", ["50 %", "worst"]),
        ("barrel.layup[0].material", ["al_7075_t6"]),
        ("retention.sleeve.material", ["none", "al_7075_t6"]),
        ("piston.nut.diameter", ["none", "8 mm"]),
        ("environment.wet", ["yes"]),
    ]:
        assert not list(validator.iter_errors(tree | {"choices": {path: values}})), path


PERCENT = units.unit("%", "ratio")
LENGTHS = st.floats(0.6e-3, 29e-3, allow_nan=False)
LISTS = st.fixed_dictionaries(
    {},
    optional={
        "seals.rod.section": st.lists(LENGTHS, min_size=1, max_size=4),
        "seals.rod.count": st.lists(st.integers(1, 8).map(float), min_size=1, max_size=3),
        "seals.piston.compound": st.lists(
            st.sampled_from(["nbr_70", "nbr_90", "hnbr_75", "fkm_75"]), min_size=1, max_size=3
        ),
        "environment.wet": st.lists(st.booleans(), min_size=1, max_size=2),
        "barrel.criterion": st.lists(
            st.sampled_from(["puck", "hashin", "tsai_wu"]), min_size=1, max_size=3
        ),
        "load_cases[swing].position": st.lists(
            st.one_of(
                st.just("worst"),
                st.floats(1e-4, 0.1).map(float),
                st.floats(1, 99).map(lambda number: choice_list.Fraction(PERCENT.to_si(number))),
            ),
            min_size=1,
            max_size=3,
        ),
    },
)  # fmt: skip


@settings(max_examples=25, deadline=None)
@given(LISTS)
def test_what_is_written_reads_back_as_the_same_choices(lists):
    """Any choices survive writing and reading bit for bit, into the file's text and anew."""
    kept = {
        path: tuple(v for i, v in enumerate(values)
                    if not any(choice_list.same(v, w) for w in values[:i]))
        for path, values in lists.items()
    }  # fmt: skip
    loaded = read_design(BENCH)
    design = loaded.design.model_copy(update={"choices": kept})
    for source in (None, loaded.source):
        text = to_yaml(design, source)
        again = read_design(text).design
        assert again == design
        first, second = again.choices, design.choices
        assert list(first) == list(second)
        for path, values in first.items():
            assert [type(v) for v in values] == [type(v) for v in second[path]]


def test_a_share_that_no_percentage_says_exactly_is_still_read():
    """One third is written with its unit, to the last digits a percentage can have."""
    third = {"load_cases[swing].position": (choice_list.Fraction(1 / 3),)}
    design = read_design(BENCH).design.model_copy(update={"choices": third})
    (share,) = read_design(to_yaml(design)).design.choices["load_cases[swing].position"]
    assert share.value == pytest.approx(1 / 3, rel=1e-15)


def test_combinations_are_the_product_in_the_order_of_the_file():
    """Every combination once, the last PATH changing first."""
    design = ao.read(listed(SEALS)).design
    found = [tuple(c.values()) for c in choice_list.combinations(design)]
    assert found == list(itertools.product(("nbr_90", "nbr_70"), (1.0, 2.0)))
