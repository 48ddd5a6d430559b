"""Temperatures from cold under duty cycles, with limits and ripple; strokes that starve seals."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from duty_case import knee, wave

import actuator_opt as ao
from actuator_opt.base.numeric import STEP
from actuator_opt.evaluation import duty_study
from actuator_opt.evaluation.kernel import duty_numbers
from actuator_opt.models import thermal_network

SOFT = {"materials__t700_epoxy__temperature_max": "45 degC"}
LIVES = "repeats: 1e6\n"


@cache
def walking(**changed: str) -> ao.Evaluation:
    """The walking knee."""
    return ao.evaluate(knee(**changed))


def test_curves_lead_from_the_air_to_the_steady_metrics():
    """Every place begins at the ambient temperature and ends within 1 % of its steady value."""
    results = walking()
    (warming,) = results.duty.warming
    steady = results.metrics["duty_wall_temperature"].by_place
    steady |= results.metrics["duty_seal_temperature"].by_place
    steady |= {"walk, oil": results.metrics["duty_oil_temperature"].value}
    assert warming.name == "walk"
    assert {f"walk, {place.name}" for place in warming.places} == set(steady)
    for place in warming.places:
        own = place.temperature
        assert place.steady == pytest.approx(steady[f"walk, {place.name}"], rel=1e-12)
        assert own[0] == pytest.approx(293.15, rel=1e-12)
        assert own[-1] == pytest.approx(place.steady, abs=0.011 * (place.steady - own[0]))
    assert warming.time[-1] == pytest.approx(5 * warming.time_constant)
    margin = results.metrics["duty_temperature_margin"].value
    assert warming.reserve == pytest.approx(margin, rel=1e-12)


def test_a_limit_is_crossed_where_the_curve_has_its_value():
    """Only places of the material with the low limit; the time lies on their curves."""
    (warming,) = walking(**SOFT).duty.warming
    crossed = {place.name: place for place in warming.places if place.crossed is not None}
    assert set(crossed) == {"layer 2 (t700_epoxy)", "layer 3 (t700_epoxy)"}
    for place in crossed.values():
        assert (place.material, place.limit) == ("t700_epoxy", pytest.approx(318.15))
        at = np.interp(place.crossed, warming.time, place.temperature)
        assert at == pytest.approx(318.15, abs=0.05)
    assert crossed["layer 3 (t700_epoxy)"].crossed > crossed["layer 2 (t700_epoxy)"].crossed


def test_the_mean_of_all_cycles_has_one_curve():
    """With its life stated, and the mean asked for."""
    text = ao.read(knee(stated=LIVES).source.text + "\n", set={"duty.thermal": "mean"})
    (warming,) = ao.evaluate(text).duty.warming
    assert warming.name == "mean of all cycles"
    assert warming.ripple > 0


def test_the_end_of_the_mission_is_on_the_curve():
    """A mission of one time constant; without a stated time there is no such temperature."""
    (cold,) = walking().duty.warming
    assert cold.mission is None
    assert {place.after_mission for place in cold.places} == {None}
    time = f"{cold.time_constant:.6f} s"
    mission = ao.read(
        knee().source.text.replace("duty:\n", f"duty:\n  supply: {{mission_time: {time}}}\n")
    )
    (warming,) = ao.evaluate(mission).duty.warming
    for place in warming.places:
        expected = np.interp(warming.mission, warming.time, place.temperature)
        assert place.after_mission == pytest.approx(expected, abs=0.01)


def test_a_period_in_small_steps_stays_within_the_ripple(monkeypatch):
    """The oil changes with the motion and friction heats by its power: implicit steps of 2 ms."""
    kept = {}

    def keep(design, stock, states, cycles, numbers):
        kept.update(states=states, cycles=cycles, numbers=numbers)
        return ()

    monkeypatch.setattr(duty_study, "warmings", keep)
    ao.evaluate(knee())
    state, (cycle,) = kept["states"]["walk"], kept["cycles"]
    monkeypatch.undo()
    (warming,) = walking().duty.warming
    network, steady = state.network, state.steady
    matrix, capacities = thermal_network._rates(network, steady)
    matrix[0, 0] -= network.oil.exchange_conductance  # added sample by sample
    nodes = np.array([float(x) for x in steady.nodes])
    air = matrix @ np.full(nodes.size, 293.15)  # heat by which the air holds its temperature
    fine = np.linspace(cycle.time[0], cycle.time[-1], 551)[1:]
    speed = np.interp(fine, cycle.time, cycle.traces["speed"])
    area = np.where(speed > 0, kept["numbers"]["area_a"], kept["numbers"]["area_b"])
    density = state.oil["density"] * state.oil["specific_heat"]
    flow = density * area * np.abs(speed)
    inlet = state.supplied + np.interp(fine, cycle.time, cycle.traces["inlet_drop"]) / density
    rubbed = [
        np.interp(fine, cycle.time, cycle.traces[f"friction{i}"] * np.abs(cycle.traces["speed"]))
        for i in range(2)
    ]
    step, oil = fine[1] - fine[0], []
    for _ in range(3):
        oil = []
        for k in range(fine.size):
            heat = air.copy()
            heat[0] += flow[k] * inlet[k]
            heat[1] += rubbed[0][k] + 0.5 * rubbed[1][k]
            heat[-1] += 0.5 * rubbed[1][k]
            now = matrix + np.diag([flow[k], *[0.0] * (nodes.size - 1)])
            left = np.diag(capacities) / step + now
            nodes = np.linalg.solve(left, capacities / step * nodes + heat)
            oil.append(nodes[0])
    deviation = np.max(np.abs(np.array(oil) - np.mean(oil)))
    assert 0.2 * warming.ripple < deviation < warming.ripple


def test_short_strokes_are_counted_and_told():
    """A stroke of 0.4 mm is below two contact widths of both seals; one of 40 mm is not."""
    dither = ao.evaluate(knee(wave(amplitude=0.2)))
    (cycle,) = dither.duty.cycles
    width = dither.metrics["contact_width"].by_place["piston seal"]
    assert cycle.reversals == 2
    short = cycle.short_strokes["piston seal"]
    assert short.strokes == 2
    assert short.shorter_than >= 2 * width  # the metric has the least width of all load cases
    told = [text for text in dither.warnings if "2 of 2 strokes are shorter than 2" in text]
    assert len(told) == 2
    assert [x.strokes for x in ao.evaluate(knee(wave())).duty.cycles[0].short_strokes.values()] == [
        0, 0
    ]  # fmt: skip


def test_a_design_without_bolted_parts_has_slopes_of_its_damage():
    """Bonded caps and no nut: only metals follow the pressure."""
    subject = knee(stated=LIVES).subject()
    models, numbers = duty_numbers(subject, subject.values())
    assert not models._fatigue._life.size
    row = models.names.index("supply")
    step = np.zeros_like(numbers, dtype=complex)
    step[row] = 1j * STEP
    slopes = models(numbers + step)[:, 0].imag / STEP
    change = 1e-4 * numbers[row, 0]
    moved = numbers.copy()
    moved[row] += change
    expected = (models(moved) - models(numbers))[:, 0] / change
    of = [k for k, place in enumerate(models.places) if place.name == "damage"]
    assert of
    np.testing.assert_allclose(slopes[of], expected[of], rtol=5e-3)


LINES = "lines:\n" + "".join(
    f"  - {{chamber: {chamber}, type: pipe, inner_diameter: 6 mm, outer_diameter: 8 mm, "
    "material: steel_e355, length: LENGTH}\n"
    for chamber in "ab"
)


def test_behind_a_long_line_the_same_oil_shuttles():
    """Lines that hold more than a stroke keep fresh oil out: the oil takes the wall's heat."""
    base = knee().source.text

    def with_lines(length: str) -> ao.Evaluation:
        return ao.evaluate(ao.read(LINES.replace("LENGTH", length) + base))

    long, short = with_lines("5 m"), with_lines("50 mm")
    drop = [x.metrics["duty_supply_needed"].value for x in (long, short)]
    assert drop[0] > drop[1] > walking().metrics["duty_supply_needed"].value
    constants = [x.duty.warming[0].time_constant for x in (long, short)]
    assert constants[0] > 2 * constants[1]  # no oil carries heat away
    assert long.duty.warming[0].ripple < short.duty.warming[0].ripple
