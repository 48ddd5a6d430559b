"""Shortfalls of duty cycles that miss a check, and whether the named cures are enough."""

from __future__ import annotations

import pickle
from dataclasses import replace
from math import sqrt

import numpy as np
import pytest
from duty_case import knee, wave

import actuator_opt as ao
from actuator_opt.evaluation import kernel
from actuator_opt.evaluation.duty_cycles.remedies import CHECKED, Shortfall, shortfalls
from actuator_opt.evaluation.duty_cycles.study import study
from actuator_opt.evaluation.kernel import duty_numbers, duty_results
from actuator_opt.metrics.table import ROWS

LIMITS = {name: (ROWS[name].worst, ROWS[name].check.limit) for name in CHECKED}
FORCE = {"duty__cycles[walk]__torque_scale": "12"}
FLOW = {"valve__rated_flow": "4 l/min"}
TRAVEL = {"cylinder__stroke": "90 mm", "linkage__base_radius": "230 mm"}
LIFE = {"duty__cycles[walk]__repeats": "1e12"}


def margins(actuator: ao.Actuator) -> dict[str, float]:
    """Least margin of every check."""
    subject = actuator.subject()
    results = duty_results(subject, subject.values()).metrics
    found = {}
    for name, (sense, limit) in LIMITS.items():
        values = [float(np.ravel(x)[0]) for x in results.get(name, {}).values()]
        if values:
            found[name] = limit - max(values) if sense == "max" else min(values) - limit
    return found


def missed(actuator: ao.Actuator) -> dict[str, Shortfall]:
    """The missed checks of a design with one cycle, by metric."""
    subject = actuator.subject()
    models, numbers = duty_numbers(subject, subject.values())
    duty = study(models, numbers[:, 0])
    lacking = [name for name, margin in margins(actuator).items() if margin < 0]
    return {x.metric: x for x in shortfalls(subject, duty, LIMITS, lacking)}


CASES = [
    (FORCE, "duty_supply_share", {"supply.pressure", "cylinder.bore", "linkage.crank_radius"}),
    (FLOW, "duty_supply_share", {"supply.pressure", "cylinder.bore", "valve.rated_flow"}),
    (FORCE, "duty_suction_ratio", {"supply.pressure", "cylinder.bore"}),
    (TRAVEL, "duty_stroke_margin", {"cylinder.stroke", "linkage.base_radius"}),
    (LIFE, "duty_fatigue", {"duty.cycles[walk].repeats", "supply.pressure"}),
]


@pytest.mark.parametrize(("changed", "metric", "paths"), CASES)
def test_every_cure_is_enough_and_not_much_more_than_needed(changed, metric, paths):
    """The design with the cure meets the check, and misses no other that it met before."""
    stated = "repeats: 5e6\nstarts: 2000\n" if changed is not LIFE else "repeats: 1e6\n"
    actuator = knee(stated=stated, **changed)
    before, shortfall = margins(actuator), missed(actuator)[metric]
    assert paths <= {remedy.path for remedy in shortfall.remedies}
    for remedy in shortfall.remedies:
        after = margins(actuator.changed({remedy.path: remedy.needed}))
        assert after[metric] >= 0, remedy
        assert all(value >= min(-1e-6, before[name]) for name, value in after.items()), remedy
        nearer = remedy.now + 0.85 * (remedy.needed - remedy.now)
        less = margins(actuator.changed({remedy.path: nearer}))
        assert less[metric] < 0, remedy
        assert remedy.text in shortfall.sentence


def test_few_samples_of_a_long_cycle_lead_to_the_same_cures(monkeypatch):
    """The scan of a long cycle uses few samples; every cure is confirmed by all of them."""
    actuator = knee(stated="repeats: 5e6\nstarts: 2000\n", **FORCE)
    expected = missed(actuator)["duty_supply_share"].remedies
    monkeypatch.setattr(kernel, "MANY_SAMPLES", 20)
    monkeypatch.setattr(kernel, "FEW_SAMPLES", 24)
    assert kernel.with_few_samples(actuator.subject()).most_samples == 24
    assert missed(actuator)["duty_supply_share"].remedies == expected


def test_force_lacks_at_the_sample_of_the_largest_need():
    """The sentence names time and sample, and what the supply lacks as a force."""
    actuator = knee(**FORCE)
    shortfall = missed(actuator)["duty_supply_share"]
    results = ao.evaluate(actuator)
    walk = results.duty.cycles[0]
    at = walk.worst["share"]
    index = int(np.argmax(walk.traces["needed"]))
    assert at.time == walk.record.time[index]
    assert f"walk: at {at.time:.4g} s (sample {index}) too little force" in shortfall.reason
    assert f"{-walk.worst['reserve'].value:.0f} N less than the load needs" in shortfall.reason
    needed = results.metrics["duty_supply_needed"].value
    cure = next(x for x in shortfall.remedies if x.path == "supply.pressure")
    assert cure.needed == pytest.approx(needed, rel=0.02)  # friction grows with the pressure
    assert shortfall in results.duty.shortfalls
    assert (shortfall.lacks, shortfall.sample, shortfall.time) == ("force", index, at.time)


def test_the_valve_that_is_enough_follows_from_the_square_of_its_flow():
    """It is p_0 + k/K^2 at every sample, with p_0 that of a valve without pressure drop."""
    actuator = knee(**FLOW)
    shortfall = missed(actuator)["duty_supply_share"]

    def needed(flow):
        subject = actuator.changed({"valve.rated_flow": flow}).subject()
        models, numbers = duty_numbers(subject, subject.values())
        return study(models, numbers[:, 0]).cycles[0].traces["needed"]

    now = 4 / 60000
    present, without = needed(now), needed(1e3 * now)
    ratio = np.max((present - without) / (210e5 - without))
    cure = next(x for x in shortfall.remedies if x.path == "valve.rated_flow")
    assert cure.needed == pytest.approx(now * sqrt(ratio), rel=0.01)
    assert cure.needed >= now * sqrt(ratio)
    assert "too little flow: at 90 % opening the valve passes" in shortfall.reason


def test_the_stroke_that_is_enough_is_that_of_the_motion():
    """A sine of 60 mm about 55 mm passes both stops of 110 mm by 5 mm: no stroke is enough."""
    shortfall = missed(knee(wave(amplitude=60.0)))["duty_stroke_margin"]
    assert "5 mm beyond the" in shortfall.reason
    assert shortfall.remedies == ()
    assert shortfall.sentence.endswith("no change of stroke alone is enough")


def test_a_pull_faster_than_the_supply_cavitates():
    """A load that helps the motion empties the driven chamber."""
    shortfall = missed(knee(wave(force=-9000.0)))["duty_suction_ratio"]
    assert "cavitation in chamber A" in shortfall.reason
    assert "because the load pulls the piston" in shortfall.reason


def test_the_number_of_repeats_is_that_of_miners_sum():
    """Damage is proportional to the repeats."""
    actuator = knee(stated="repeats: 1e6\n", **LIFE)
    shortfall = missed(actuator)["duty_fatigue"]
    damage = 1 - margins(actuator)["duty_fatigue"]
    cure = next(x for x in shortfall.remedies if x.path.endswith("repeats"))
    assert cure.needed <= 1e12 / damage
    assert cure.needed == pytest.approx(1e12 / damage, rel=0.1)
    assert f"reaches a damage of {damage:.3g}" in shortfall.reason


def test_a_feasible_cycle_lacks_nothing():
    """No sentence where all checks are met."""
    assert missed(knee()) == {}


def test_a_cure_beyond_the_bounds_of_a_variable_is_named():
    """The bore that is enough is 24.5 mm, also if the optimiser may only take 24 mm."""
    actuator = knee(**FORCE, **{"variables__cylinder__bore__upper": "24 mm"})
    shortfall = missed(actuator)["duty_supply_share"]
    cure = next(x for x in shortfall.remedies if x.path == "cylinder.bore")
    assert 24e-3 < cure.needed < 25e-3


def test_shortfalls_are_searched_when_they_are_read_and_a_pickle_has_them():
    """The search takes seconds; a copy of a study that was unpickled keeps the result."""
    duty = ao.evaluate(knee(**FLOW)).duty
    assert "shortfalls" not in vars(duty)
    again = pickle.loads(pickle.dumps(duty))
    assert again.shortfalls == replace(again).shortfalls == duty.shortfalls
    assert {x.metric for x in duty.shortfalls} == {"duty_supply_share"}
