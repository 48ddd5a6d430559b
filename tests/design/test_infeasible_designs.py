"""The infeasibility card of real designs made infeasible in known ways."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from cli_runner import DESIGNS, KNEE, bench, run

import actuator_opt as ao
from actuator_opt.api import read
from actuator_opt.design.materials import load_library
from actuator_opt.optimisation import cures
from actuator_opt.optimisation.cures import SUBSTITUTES, Cure
from actuator_opt.optimisation.infeasibility import KINDS
from actuator_opt.optimisation.problem import BoxProblem, PointValues
from actuator_opt.optimisation.run import optimise
from actuator_opt.pages.report import verdict

STEEL = DESIGNS / "steel_baseline.yaml"


def best(path, **limits):
    """The optimum of a design with other values by PATH (dots as double underscores)."""
    return best_of(read(path, set=[(k.replace("__", "."), v) for k, v in limits.items()]))


def best_of(actuator):
    """The optimum of an actuator as read, from two starts and without prices."""
    return optimise(actuator.subject(), starts=2, prices=False)


def needed(card, parameter):
    """The limit that alone would do; None where the card says that none would."""
    (entry,) = (row for row in card.sole if row["parameter"] == parameter)
    return entry["needed"]


@pytest.fixture(scope="module")
def least():
    """The least friction of any steel design: friction minimised under all other requirements."""
    actuator = read(STEEL)
    design = actuator.design
    others = {k: v for k, v in design.requirements.items() if k != "friction_running"}
    goal = design.objective.model_copy(update={"minimise": "friction_running"})
    changed = design.model_copy(update={"requirements": others, "objective": goal})
    return best_of(replace(actuator, design=changed)).objective_value


@pytest.fixture(scope="module")
def tight(least):
    """Cards of the steel design with its friction limit far and only just too low."""
    return [
        best(STEEL, requirements__friction_running__max=f"{least - short} N").infeasibility
        for short in (20.0, 0.1)
    ]


@pytest.mark.long
def test_the_friction_needed_is_the_least_there_is(tight, least):
    """The limit that alone would do is the least friction of any design, wherever it was set."""
    for card in tight:
        path = "requirements.friction_running.max"
        assert needed(card, path) == pytest.approx(least, rel=5e-6)
        assert [row["parameter"] for row in card.joint] == [path]
        assert card.joint[0]["needed"] == pytest.approx(least, rel=5e-6)


@pytest.mark.long
def test_what_repairs_a_large_miss_repairs_a_small_one(tight):
    """Every limit that alone makes up for 20 N too little does so for 0.1 N, with less."""
    far, near = ({row["parameter"]: row["relaxation"] for row in card.sole} for card in tight)
    enough = [path for path, amount in far.items() if amount is not None]
    assert enough
    for path in enough:
        assert near[path] is not None
        assert near[path] <= far[path]
    repairs = [path for path, amount in near.items() if amount is not None]
    assert len(repairs) >= 3, "stiffness, buckling and squeeze trade against friction"


@pytest.mark.long
def test_a_mass_below_the_optimum():
    """Mass limited to four fifths of the optimum: alone it must give way to the optimum's mass."""
    mass = best(STEEL).objective_value
    card = best(STEEL, requirements__mass__max=0.8 * mass).infeasibility
    assert needed(card, "requirements.mass.max") == pytest.approx(mass, rel=1e-6)
    assert card.total <= 0.25 + 1e-6, "what mass alone costs is an upper bound"


def test_a_bore_too_small_for_the_force():
    """A bore of at most 17 mm gives less than p A = 4767 N of the 6 kN asked for.

    The force that would do lies below p A by friction and back pressure only; the bore that would
    do alone is beyond that of a seal without friction, sqrt(4 F/(pi p)) = 19.1 mm.
    """
    text = STEEL.read_text("utf-8")
    for start, end in (
        ("  static:", "load:\n"),
        ("  nut:", "\nhead:"),
    ):
        text = text[: text.index(start)] + text[text.index(end, text.index(start)) :]
    card = best(
        text, cylinder__bore="17 mm", variables__cylinder__bore__upper="17 mm"
    ).infeasibility
    rows = {row["parameter"]: row for row in (*card.joint, *card.sole)}
    force = rows["load_cases[stance].force"]
    thrust = 21e6 * math.pi / 4 * 0.017**2
    assert force["origin"] == "load case"
    assert force["limit_text"] == "6 kN"
    joint = next(r for r in card.joint if r["parameter"] == force["parameter"])
    assert 0.9 * thrust < joint["needed"] < thrust
    bore = next(b for b in card.bounds if b["variable"] == "cylinder.bore")
    assert bore["parameter"] == "variables.cylinder.bore.upper"
    least = math.sqrt(4 * 6000 / (math.pi * 21e6))
    assert least < bore["needed"] < 1.15 * least


def test_a_bound_and_a_fixed_dimension_that_block_together():
    """A start for 12 kN is asked for 30 kN: its thread is too small, and so is the largest bore.

    By hand, the thread alone leaves the bore at p A = 24.9 kN. A solved start for 30 kN exists, so
    that less force is not the only way out. The sizes as printed give a design.
    """
    start = ao.start(push="12 kN")
    strong = start.changed({"load_cases[push].force": "30 kN"})
    largest = start.design.variables["cylinder.bore"].upper
    assert 160e5 * math.pi / 4 * largest**2 < 30e3
    card = best_of(strong).infeasibility
    assert "rod.thread.diameter" in card.failed
    first, *others = card.cures
    changes = {part["parameter"]: part["needed_text"] for part in first["together"]}
    assert set(changes) == {"variables.cylinder.bore.upper", "rod.thread.diameter"}
    assert [cure["kind"] for cure in others] == ["requirement"]
    assert card.sentence.startswith("infeasible: it is enough to change variables.cylinder.bore")
    assert card.sentence.endswith(" together")
    assert best_of(strong.changed(changes)).status == "optimal"
    one = dict([changes.popitem()])
    for single in (changes, one):
        assert best_of(strong.changed(single)).status == "infeasible"


def test_limits_that_contradict_each_other_by_definition():
    """A squeeze of at least 20 % that never exceeds 18 % (tolerance and growth included).

    Giving up a margin s of the least, or t of the largest, moves squeezes by 0.20 s and 0.18 t:
    the least squeeze is the cheaper one to give up, and either alone is enough.
    """
    text = STEEL.read_text("utf-8")
    start = text.index("  static:")  # its squeeze is fixed, and would be a contradiction of its own
    card = best(
        text[:start] + text[text.index("load:\n") :],
        requirements__seal_squeeze__min="20 %",
        requirements__seal_squeeze_max__max="18 %",
        requirements__friction_running__max="2 kN",
    ).infeasibility
    assert "requirements.seal_squeeze.min" in [row["parameter"] for row in card.joint]
    low = needed(card, "requirements.seal_squeeze.min")
    high = needed(card, "requirements.seal_squeeze_max.max")
    assert low is not None
    assert high is not None
    assert low < 0.18
    assert high > 0.20


@pytest.mark.long
def test_knee_with_thick_rings():
    """Rings of 2.62 mm and 315 N: infeasible, exit 1; with the limits as printed it is not."""
    sets = {
        "seals.piston.section": "2.62 mm",
        "seals.rod.section": "2.62 mm",
        "requirements.friction_running.max": "315 N",
    }
    words = [word for path, value in sets.items() for word in ("--set", f"{path}={value}")]
    result = run("optimise", KNEE, "--json", "--starts", "1", *words)
    assert result.code == 1
    card = result.json["infeasibility"]
    assert card["sentence"].startswith("infeasible: the smallest change")
    assert "315 N -> " in card["sentence"]
    assert "evidence, not proof" in card["evidence"]
    relaxed = sets | {row["parameter"]: row["needed_text"] for row in card["joint"]}
    subject = read(KNEE, set=relaxed).subject()
    assert optimise(subject, starts=1, prices=False).status == "optimal"


WALL = "  retention.wall:\n    lower: 1 mm\n    upper: 10 mm\n"


def fixed(**values):
    """The bench design with a fixed skirt, and other values by PATH."""
    return read(bench((WALL, "")), set=[(k.replace("__", "."), v) for k, v in values.items()])


def solved(actuator, values=(), **options):
    """An optimum from the start, without prices."""
    changed = actuator.changed(dict(values))
    return optimise(changed.subject(), starts=1, prices=False, **options)


@pytest.mark.parametrize(
    ("path", "now"),
    [pytest.param("retention.wall", "1 mm", marks=pytest.mark.long), ("retention.length", "13 mm")],
)
def test_a_fixed_dimension_that_alone_is_enough_comes_first(path, now):
    """At the value printed a design fits, at 1 % less none; safety factors come last."""
    skirt = {"retention.wall": "2 mm"} if path == "retention.length" else {}
    actuator = fixed(**{path: now, **skirt})
    result = solved(actuator)
    card, first = result.infeasibility, result.infeasibility.cures[0]
    assert (first["kind"], first["parameter"]) == ("dimension", path)
    assert card.sentence.startswith(
        f"infeasible: it is enough to change {path} {now} -> {first['needed_text']} ("
    )
    ranks = [KINDS.index(cure["kind"]) for cure in card.cures]
    assert ranks == sorted(ranks)
    assert all(cure["advised"] is (cure["kind"] != "safety factor") for cure in card.cures)
    assert all(row["safety_factor"] for row in card.joint), "checks are what conflicts here"
    assert solved(actuator, {path: first["needed_text"]}).status == "optimal"
    short = solved(actuator, {path: 0.99 * first["needed"]}, explain=False)
    assert short.status == "infeasible"
    if path == "retention.length":  # mean shear F/(pi d L): the factor grows with the length
        factor = needed(card, "requirements.retention_burst_factor.min")
        assert first["needed"] == pytest.approx(first["now"] * 4 / factor, rel=1e-3)
    missed = next(check.name for check in result.evaluation.checks if check.status == "missed")
    line = f"8 of 8 requirements met; checks missed: {missed}"
    assert verdict(result).lines[0] == line
    assert line in str(result)
    assert card.sentence in str(result)


@pytest.mark.long
def test_dimensions_that_are_enough_together():
    """Bond and skirt both too small: neither alone, both at once, at the values printed."""
    actuator = fixed(retention__length="13 mm", retention__wall="1.2 mm")
    card = solved(actuator).infeasibility
    (both,) = [cure for cure in card.cures if cure["kind"] == "dimension"]
    values = {part["parameter"]: part["needed_text"] for part in both["together"]}
    assert list(values) == ["retention.length", "retention.wall"]
    assert card.sentence.endswith(" together")
    assert solved(actuator, values).status == "optimal"


def test_a_back_up_ring_is_offered_with_all_it_needs():
    """NBR 70 at 210 bar has too large a gap: a ring, or NBR 90, comes before a lower factor."""
    actuator = read(bench(), set={"seals.piston.compound": "nbr_70"})
    result = solved(actuator)
    assert "checks missed: extrusion of the seals" in verdict(result).lines[0]
    ring, *others = result.infeasibility.cures
    assert (ring["kind"], ring["parameter"]) == ("choice", "seals.piston.back_up")
    assert (ring["now"], ring["needed"]) == ("none", "one")
    compound = next(one for one in others if one["parameter"] == "seals.piston.compound")
    assert compound["needed"] == "nbr_90"
    unsafe = others[-1]
    assert (unsafe["parameter"], unsafe["advised"]) == ("requirements.extrusion_factor.min", False)
    for cure in (ring, compound):
        values = {cure["parameter"]: cure["needed"], **cure.get("beside", {})}
        assert solved(actuator, values).status == "optimal"


@pytest.mark.long
def test_stops_outside_the_cylinder_are_offered():
    """Oil at the stop meets the stall force on a narrow ring: the cure moves the stops outside."""
    start = ao.start(push="1 kN", pull=0.0, stroke="200 mm", pressure="210 bar").source.text
    assert "end_stop: external" in start
    text = start.replace("end_stop: external", "end_stop: internal")
    first = best_of(read(text)).infeasibility.cures[0]
    assert (first["parameter"], first["now"]) == ("cylinder.end_stop", "internal")
    assert (first["needed"], first["advised"]) == ("external", True)
    assert first["objective"] is not None


@pytest.mark.long
def test_a_thinner_ring_is_offered_against_friction():
    """Rings of 3.53 mm rub more than those of 2.62 mm: the next section makes up for 8 %."""
    start = ao.start(push=9e3, pull=3e3, stroke="180 mm", pressure="160 bar", stiffness=20e6)
    thick = {f"seals.{place}.section": "3.53 mm" for place in ("piston", "rod")}
    limits = {"requirements.friction_running.max": "500 N"}
    cures = best_of(read(start.source.text, set=thick | limits)).infeasibility.cures
    first = next(cure for cure in cures if cure["parameter"].endswith(".section"))
    assert (first["now"], first["needed"], first["advised"]) == ("3.53 mm", "2.62 mm", True)
    changed = thick | limits | {first["parameter"]: first["needed"]}
    assert best_of(read(start.source.text, set=changed)).status == "optimal"


def test_what_is_tried_in_place_of_materials_is_in_the_library():
    """Every substitute exists and is of its kind."""
    library = load_library()
    for kind, names in SUBSTITUTES.items():
        assert {library.kind(name) for name in names} == {kind}


def test_two_choices_that_are_only_enough_together(monkeypatch):
    """Each gives 1 of the 2.5 missing, the free variable at most 1: only both meet the limit.

    The objective 2 + x with both is least at the limit: x = 0.5.
    """

    def problem(bonus):
        def evaluate(points):
            return PointValues(2 + points[0], (points[0] + bonus - 2.5)[None])

        return BoxProblem(("x",), np.array([0.1]), np.array([1.0]), evaluate, ("limit",))

    monkeypatch.setattr(cures, "_with_choice", lambda actuator, values, library: problem(
        sum(word == "better" for word in values.values())
    ))  # fmt: skip
    x = {"x": 0.2}
    single = [(1.3, Cure(path, "old", "better"), problem(1)) for path in ("rod.a", "caps.b")]
    assert cures._sufficient(single, x, 4)[0] == []
    pairs = cures._pairs(None, x, [*single, single[0]], 2.3, None)
    assert [(c.path, c.beside) for _, c, _ in pairs] == [
        ("caps.b", {"rod.a": "better"}), ("rod.a", {"caps.b": "better"}),
    ]  # fmt: skip
    (cure, *_), failed, left = cures._sufficient(pairs[:1], x, 4)
    assert (cure.path, failed, left) == ("caps.b", [], [])
    assert cure.objective == pytest.approx(2.5, abs=1e-6)
