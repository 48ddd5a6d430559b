"""Optima with duty cycles: windows as limits, exact slopes, and one tape for any record."""

from pathlib import Path

import numpy as np
import pytest

import actuator_opt as ao
from actuator_opt.base.symbolic import program as programs
from actuator_opt.evaluation import evaluate, kernel
from actuator_opt.evaluation.kernel import duty_numbers
from actuator_opt.optimisation.actuator import build
from actuator_opt.optimisation.evaluator import Evaluator

ROOT = Path(__file__).parents[2]
DUTY = """
valve: {rated_flow: 6 l/min, natural_frequency: 100 Hz}
duty:
  cycles:
    - name: walk
      file: CYCLE
      lever_arm: 57 mm
      repeats: 1e6
      starts: 2000
      torque_scale: 4
"""


@pytest.fixture(scope="module")
def actuator() -> ao.Actuator:
    """The steel cylinder with a walking cycle that its supply hardly manages."""
    text = (ROOT / "designs" / "steel_baseline.yaml").read_text()
    cycle = ROOT / "designs" / "cycles" / "gait_knee.csv"
    return ao.read(text + DUTY.replace("CYCLE", str(cycle)))


@pytest.fixture(scope="module")
def tight(actuator: ao.Actuator) -> ao.Actuator:
    """The same held to 0.47 of its supply; the lightest without this limit needs 0.486."""
    return actuator.changed({"requirements.duty_supply_share.max": 0.47})


@pytest.fixture(scope="module")
def held(tight: ao.Actuator) -> ao.Optimisation:
    """Its optimum, from searches that see every sample."""
    return ao.optimise(tight, starts=2)


def test_recorded_models_equal_the_models(actuator: ao.Actuator) -> None:
    """Values and slopes of all rows agree, at points that other designs share or not."""
    problem = build(actuator.subject())
    start = problem.problem.start
    assert start is not None
    points = np.stack([start, start, 1.01 * start], axis=1)
    stepped = Evaluator(problem.problem).space.complex_steps(points)
    for x in (points, stepped):
        recorded, models = problem.evaluate(x), problem.by_models(x, {})
        assert recorded.constraints.real == pytest.approx(models.constraints.real, rel=1e-9)
        slopes = recorded.constraints.imag / 1e-30, models.constraints.imag / 1e-30
        assert slopes[0] == pytest.approx(slopes[1], rel=1e-9, abs=1e-9)
    assert problem.models_run_by == "compiled program"
    few = [row for row in problem.rows if row.limit_of.metric == "duty_supply_share"]
    assert 2 <= len(few) <= 16


def test_a_limit_over_time_binds_at_an_exact_optimum(held: ao.Optimisation) -> None:
    """The worst sample holds the optimum; no sample of the cycle breaks the limit there."""
    optimum = held
    assert optimum.status == "optimal"
    assert optimum.kkt is not None
    assert optimum.kkt.residual <= 1e-6
    assert any("duty_supply_share" in name for name in optimum.kkt.active)
    duty = optimum.evaluation.duty
    assert duty is not None
    assert duty.cycles[0].traces["share"].max() == pytest.approx(0.47, rel=1e-6)
    dear = [price for price in optimum.sensitivities if "duty_supply_share" in price.parameter]
    assert dear


def test_a_search_that_begins_with_few_samples_finds_the_same(
    tight: ao.Actuator, held: ao.Optimisation, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A long record: the search begins with some samples, and its optimum holds for all."""
    monkeypatch.setattr(kernel, "MANY_SAMPLES", 100)
    monkeypatch.setattr(kernel, "FEW_SAMPLES", 24)
    few = ao.optimise(tight, starts=2, prices=False)
    assert few.objective_value == pytest.approx(held.objective_value, rel=1e-8)
    assert few.kkt is not None
    assert few.kkt.residual <= 1e-6
    assert len(few.starts) == len(held.starts)
    yields = [x.best_evaluation.yield_estimate.value for x in (few, held)]
    assert yields[0] == pytest.approx(yields[1], abs=0.05)  # of 500 draws, also of few samples
    duty = few.evaluation.duty
    assert duty is not None
    assert duty.cycles[0].traces["share"].max() == pytest.approx(0.47, rel=1e-6)


@pytest.mark.long
@pytest.mark.parametrize(
    ("design", "objective"),
    [
        ("knee_walking", "mass"),
        ("knee_walking", "duty_supply_energy"),
        ("knee_walking", "duty_supply_energy[walk]"),
        ("knee_walking", "system_mass"),
        ("flight_control", "mass"),
    ],
)
def test_the_optimality_conditions_hold_in_the_worked_designs(design: str, objective: str) -> None:
    """Their residual is below 1e-6."""
    actuator = ao.read(ROOT / "designs" / f"{design}.yaml", set={"objective.minimise": objective})
    optimum = ao.optimise(actuator, starts=1, prices=False)
    assert optimum.status == "optimal"
    assert optimum.kkt is not None
    assert optimum.kkt.residual < 1e-6


def test_slopes_of_fatigue_and_wear_are_those_of_differences(actuator: ao.Actuator) -> None:
    """All results of the cycles, in three directions of all numbers at once, for two designs."""
    subject = actuator.subject()
    models, numbers = duty_numbers(subject, subject.values())
    random = np.random.default_rng(1)
    point = np.concatenate([numbers, 1.02 * numbers], axis=1)
    ways = random.normal(size=(len(numbers), 2, 3)) * np.abs(point)[:, :, None]
    stepped = np.repeat(point, 3, axis=1) + 1e-30j * ways.reshape(len(numbers), -1)
    slopes = models(stepped).imag / 1e-30
    h = 1e-6
    above, below = (
        models(np.repeat(point, 3, axis=1) + sign * h * ways.reshape(len(numbers), -1))
        for sign in (1, -1)
    )
    differences = (above - below) / (2 * h)
    room = 1e-3 * np.abs(differences) + 1e-9 * np.abs(above) / h
    assert np.all(np.abs(slopes - differences) <= room)
    damage = [place.name == "damage" for place in models.places]
    assert np.abs(differences[damage]).max() > 0


def test_a_search_leaves_other_results_as_they_are(actuator: ao.Actuator) -> None:
    """A search computes only the results it reads; the same design still has all the others."""
    subject = actuator.subject()
    expected = evaluate(actuator.subject())
    problem = build(subject)
    start = problem.problem.start
    assert start is not None
    for _ in range(2):
        problem.evaluate(start[:, None])
    after = evaluate(subject)
    for name, metric in expected.metrics.items():
        assert after[name].value == metric.value, name


def test_prices_of_long_cycles_count_few_samples(
    held: ao.Optimisation, tight: ao.Actuator, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They say so, and are close to those of all samples, around the optimum with all."""
    monkeypatch.setattr(kernel, "MANY_SAMPLES", 50)
    monkeypatch.setattr(kernel, "FEW_SAMPLES", 50)
    few = ao.optimise(tight, starts=2)
    assert any("prices count" in warning for warning in few.warnings)
    assert not any("prices count" in warning for warning in held.warnings)
    assert few.objective_value == pytest.approx(held.objective_value, rel=1e-9)
    row, all_samples = (
        next(x for x in found.sensitivities if x.parameter == "requirements.duty_supply_share.max")
        for found in (few, held)
    )
    assert row.price == pytest.approx(all_samples.price, rel=0.05)
    assert row.resolved_10 == pytest.approx(all_samples.resolved_10, rel=0.005)


def test_without_the_machine_a_recording_is_not_used(
    actuator: ao.Actuator, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A worker may receive recorded models and have no machine."""
    problem = build(actuator.subject())
    x = Evaluator(problem.problem).space.complex_steps(problem.problem.start[:, None])
    recorded = problem.evaluate(x)
    monkeypatch.setattr(programs, "AVAILABLE", False)
    monkeypatch.setattr(programs, "COMPILED", None)
    assert problem.evaluate(x).constraints == pytest.approx(recorded.constraints, rel=1e-9)
