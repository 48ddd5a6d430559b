"""The infeasibility card of real designs made infeasible in known ways."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from cli_runner import DESIGNS, KNEE, run

from actuator_opt.optimisation.run import optimise
from actuator_opt.verbs import read

STEEL = DESIGNS / "steel_baseline.yaml"


def best(path, **limits):
    """The optimum of a design with other values by PATH (dots as double underscores)."""
    return best_of(read(path, set=[(k.replace("__", "."), v) for k, v in limits.items()]))


def best_of(actuator):
    """The optimum of an actuator as read, without prices."""
    return optimise(actuator.subject(), prices=False)


def needed(card, parameter):
    """The limit that alone would do; None where the card says that none would."""
    (entry,) = (row for row in card.sole if row["parameter"] == parameter)
    return entry["needed"]


@pytest.fixture(scope="module")
def tight():
    """Cards of the steel design with its friction limit far and only just too low."""
    return [
        best(STEEL, requirements__friction_running__max=limit).infeasibility
        for limit in ("260 N", "279.7 N")
    ]


def test_the_friction_needed_is_the_least_there_is(tight):
    """The limit that alone would do is the least friction of any design, wherever it was set.

    Independently: friction minimised under all other requirements.
    """
    actuator = read(STEEL)
    design = actuator.design
    others = {k: v for k, v in design.requirements.items() if k != "friction_running"}
    goal = design.objective.model_copy(update={"minimise": "friction_running"})
    changed = design.model_copy(update={"requirements": others, "objective": goal})
    least = best_of(replace(actuator, design=changed)).objective_value
    for card in tight:
        path = "requirements.friction_running.max"
        assert needed(card, path) == pytest.approx(least, rel=1e-6)
        assert [row["parameter"] for row in card.joint] == [path]
        assert card.joint[0]["needed"] == pytest.approx(least, rel=1e-6)


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
    card = best(
        STEEL, cylinder__bore="17 mm", variables__cylinder__bore__upper="17 mm"
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


def test_limits_that_contradict_each_other_by_definition():
    """A squeeze of at least 20 % that never exceeds 18 % (tolerance and growth included).

    Giving up a margin s of the least, or t of the largest, moves squeezes by 0.20 s and 0.18 t:
    the least squeeze is the cheaper one to give up, and either alone is enough.
    """
    card = best(
        STEEL,
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
    assert card["sentence"].startswith("nothing fits: the smallest change")
    assert "315 N -> " in card["sentence"]
    assert "evidence, not proof" in card["evidence"]
    relaxed = sets | {row["parameter"]: row["needed_text"] for row in card["joint"]}
    subject = read(KNEE, set=relaxed).subject()
    assert optimise(subject, starts=1, prices=False).status == "optimal"
