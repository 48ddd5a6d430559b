"""A search of listed sizes serves problems that differ in nothing it rests on, and no others."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import actuator_opt as ao
from actuator_opt.optimisation.branch_and_bound import Listed, search
from actuator_opt.optimisation.choices import Evidence
from actuator_opt.optimisation.problem import BoxProblem, PointValues
from actuator_opt.optimisation.solver import solve

KNEE = Path(__file__).parents[2] / "designs" / "knee_bonded.yaml"


def _plate(*, load=1.0, weight=1.0, slack=50.0):
    """Lightest plate t w that bears a load on t^2 w, with a far limit on its width."""

    def evaluate(x):
        thickness, width = x
        bears = thickness**2 * width / load - 1
        return PointValues(weight * thickness * width, np.stack([bears, (slack - width) / 10]))

    low, high = np.array([0.2, 0.1]), np.array([3.0, 40.0])
    return BoxProblem(("thickness", "width"), low, high, evaluate, ("bears", "narrow"))


@pytest.fixture(scope="module")
def evidence():
    """What the search of a plate of listed thicknesses rests on."""
    problem = _plate()
    listed = [Listed((0,), np.array([[0.25], [0.7], [1.1], [2.5], [2.9]]))]
    found = search(problem, listed, solve(problem).x)
    # t = 2.9, the largest listed: mass = 1/t
    assert found.objective == pytest.approx(1 / 2.9, rel=1e-9)
    return Evidence(problem, solve(problem).objective, found.ends)


def test_a_limit_far_off_makes_no_difference(evidence):
    """A far limit may be anywhere, as long as it stays far."""
    assert evidence.holds_for(_plate(), evidence.optimum)
    assert evidence.holds_for(_plate(slack=60.0), evidence.optimum)


@pytest.mark.parametrize("change", [{"load": 1.001}, {"weight": 1.001}, {"slack": 0.12}])
def test_what_the_search_rests_on_must_be_the_same(evidence, change):
    """Neither the objective nor a limit that holds an end may differ, nor one come near."""
    assert not evidence.holds_for(_plate(**change), evidence.optimum)


def test_bounds_names_and_the_continuous_optimum_must_be_the_same(evidence):
    """Problems of other variables, limits, bounds or optima are not compared further."""
    other = _plate()
    assert not evidence.holds_for(replace(other, names=("t", "w")), evidence.optimum)
    assert not evidence.holds_for(replace(other, upper=other.upper * 2), evidence.optimum)
    assert not evidence.holds_for(other, evidence.optimum * 1.01)


@pytest.mark.long
def test_oils_of_one_bulk_modulus_are_searched_once(monkeypatch):
    """Every combination gets the same result as if each were searched, with fewer searches."""
    text = KNEE.read_text("utf-8").replace("max: 290 N", "max: 400 N")
    text = text.replace("    upper: 4 mm", "    upper: 8 mm")
    for path in ("cylinder.bore", "rod.outer_diameter"):
        text = text.replace(f"  {path}:\n    lower", f"  {path}:\n    sizes: iso_3320\n    lower")
    text += "choices:\n  fluid.material: [iso_vg_32, polyol_ester_46, iso_vg_46, iso_vg_68]\n"
    served = []
    holds_for = Evidence.holds_for

    def counted(self, other, optimum):
        served.append(holds_for(self, other, optimum))
        return served[-1]

    monkeypatch.setattr(Evidence, "holds_for", counted)
    once = ao.optimise(ao.read(text), prices=False, starts=2)
    monkeypatch.setattr(Evidence, "holds_for", lambda *_: False)
    each = ao.optimise(ao.read(text), prices=False, starts=2)
    assert sum(served) == 2
    assert once.rounding.objective_after == each.rounding.objective_after
    for one, other in zip(once.choices.combinations, each.choices.combinations, strict=True):
        assert (one.values, one.status, one.objective) == (
            other.values,
            other.status,
            other.objective,
        )
        assert one.rounded == pytest.approx(other.rounded, rel=1e-9, nan_ok=True)
