"""From identified friction to the seals of a design: what was put in comes back, nothing else."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from identification_case import DESIGN, identified

import actuator_opt as ao
from actuator_opt.identification import calibration
from actuator_opt.identification.points import FrictionPoint
from actuator_opt.identification.stribeck_fit import fit_stribeck
from actuator_opt.studies.bench import bench

SPEEDS = (5e-4, 1e-3, 2e-3, 3e-3, 5e-3, 1e-2, 3e-2, 0.1, 0.2)
PRESSURES = ((10e5, 5e5), (120e5, 5e5))
KEYS = ("friction_coefficient", "breakaway_ratio", "stribeck_speed", "viscous_friction")


@cache
def knee():
    """The knee as shipped."""
    return ao.read(DESIGN)


def rubbed(values, *, pressures=PRESSURES, speeds=SPEEDS, offset=0.0):
    """An identification whose points are those of the knee with other friction numbers."""
    own = bench(knee().changed(values).subject())
    points = []
    for first, second in pressures:
        for way in (1, -1):
            level, viscous = own.sliding(np.array(speeds), np.full(len(speeds), first),
                                         np.full(len(speeds), second))  # fmt: skip
            points += [
                FrictionPoint(way * v, max(first, second), first, second,
                              way * float(f) + offset, 0.2, 1.0, "plateau")
                for v, f in zip(speeds, level + viscous, strict=True)
            ]  # fmt: skip
    whole = identified("plateaus")
    area = float(whole.bench.areas(np.float64(0.0))[0])
    fit = fit_stribeck(points, area)
    return replace(
        whole, points=tuple(points), stribeck=fit, lugre="none", bench=bench(knee().subject())
    )


def changed(factor, ratio, speed, viscous):
    """Friction numbers of both seals, sigma_2 shared by circumference."""
    d = {"piston": knee().design.cylinder.bore, "rod": knee().design.rod.outer_diameter}
    values = {}
    for place, diameter in d.items():
        at = f"seals.{place}."
        values[f"{at}friction_coefficient"] = 0.1 * factor
        values[f"{at}breakaway_ratio"] = ratio
        values[f"{at}stribeck_speed"] = speed
        values[f"{at}viscous_friction"] = viscous * diameter / sum(d.values())
    return values


@settings(max_examples=15, deadline=None)
@given(
    factor=st.floats(0.5, 3.0),
    ratio=st.floats(1.4, 3.0),
    speed=st.floats(1.5e-3, 6e-3),
    viscous=st.floats(50.0, 400.0),
)
def test_friction_put_in_comes_back(factor, ratio, speed, viscous):
    """Points of the design's own friction law give its numbers within 1 %, viscous within 5 %.

    Two pressures, so that the linear rise with pressure of the fit is the contact law's.
    """
    values = changed(factor, ratio, speed, viscous)
    found = calibration(rubbed(values))
    assert not found.left
    got = found.values()
    assert set(got) == set(values)
    for path, value in values.items():
        near = 0.05 if path.endswith("viscous_friction") else 0.01
        assert got[path] == pytest.approx(value, rel=near), path


def test_bounds_hold_the_value_and_name_the_record():
    """Every new number lies within its measured bounds, in the range of its quantity."""
    found = calibration(rubbed(changed(1.2, 2.0, 3e-3, 100.0)))
    for path, known in found.measured().items():
        assert known.lower <= found.values()[path] <= known.upper
        assert known.record == "plateaus.csv"
        assert known.lower >= (1.0 if path.endswith("ratio") else 0.0)


def test_the_offset_is_left_out_and_said():
    """An offset between both ways changes no coefficient; the page says it is not in them."""
    without, with_it = (calibration(rubbed(changed(1.0, 2.0, 3e-3, 100.0), offset=x))
                        for x in (0.0, 20.0))  # fmt: skip
    for path, value in without.values().items():
        assert with_it.values()[path] == pytest.approx(value, rel=0.02)
    assert any("offset of 20" in words for words in with_it.doubts)
    assert not any("offset" in words for words in without.doubts)


def test_another_rise_with_pressure_is_said():
    """Friction that does not rise with pressure deviates from the contact law, which is said."""
    points = rubbed(changed(1.0, 2.0, 3e-3, 100.0), pressures=PRESSURES[:1]).points
    flat = [
        one._replace(pressure_1=first, pressure=first) for first, _ in PRESSURES for one in points
    ]
    whole = identified("plateaus")
    area = float(whole.bench.areas(np.float64(0.0))[0])
    found = calibration(replace(whole, points=tuple(flat), stribeck=fit_stribeck(flat, area)))
    assert any("deviates from the contact law" in words for words in found.doubts)


def test_loads_beyond_the_record_are_said():
    """The record's speed and pressure are named beside the design's."""
    found = calibration(rubbed(changed(1.0, 2.0, 3e-3, 100.0)))
    said = [words for words in found.doubts if words.startswith("the record reaches")]
    assert len(said) == 1
    assert "200 mm/s and 120 bar" in said[0]
    assert "400 mm/s and 210 bar" in said[0]


def test_one_speed_gives_the_factor_alone():
    """Friction at one speed scales the coefficients; what it cannot tell stays, and is said."""
    values = {f"seals.{place}.friction_coefficient": 0.15 for place in ("piston", "rod")}
    found = calibration(rubbed(values, speeds=(0.05,)))
    assert set(found.values()) == set(values)
    assert found.values()["seals.rod.friction_coefficient"] == pytest.approx(0.15, rel=1e-6)
    assert set(found.left) == set(KEYS[1:])
    assert all("Stribeck curve needs" in why for why in found.left.values())


def test_coulomb_friction_by_hand():
    """Measured over stated is the factor; stated is mu pi (D f_p + d f_r) of the rings."""
    found = calibration(rubbed(changed(1.3, 2.0, 3e-3, 100.0)))
    own = bench(knee().subject())
    by_hand = np.mean([
        0.1 * sum(float(force) for _, force in own.normal_forces(np.float64(a), np.float64(b)))
        for a, b in PRESSURES
    ])  # fmt: skip
    assert found.stated == pytest.approx(by_hand, rel=1e-9)
    assert found.coulomb / found.stated == pytest.approx(1.3, rel=0.01)


def test_the_bench_rubs_as_the_evaluation():
    """Friction of the bench at a load case's speed and pressures is the metric of that case."""
    knee_ = ao.read(DESIGN, set={"seals.piston.viscous_friction": 30.0,
                                 "load_cases[stance].side_load": 0.0})  # fmt: skip
    subject = knee_.subject()
    own = bench(subject)
    metric = ao.evaluate(knee_).metrics["friction_running"]
    case = next(c for c in knee_.design.load_cases if c.name == metric.case)
    from actuator_opt.evaluation import compute

    state = compute(subject, subject.values()).state
    k = knee_.design.load_cases.index(case)
    first, second = (float(np.real(np.ravel(p)[k])) for p in (state.moving_a, state.moving_b))
    level, viscous = own.sliding(np.float64(case.speed), np.float64(first), np.float64(second))
    assert float(level + viscous) == pytest.approx(metric.value, rel=1e-6)


@pytest.mark.parametrize("kind", ["bare", "pre-sliding"])
def test_without_steady_sliding_there_is_nothing_to_calibrate(kind):
    """One line that says which test to run."""
    with pytest.raises(ao.InputError, match="no steady sliding"):
        calibration(replace(identified(kind), points=()))


@pytest.mark.long
def test_a_film_is_refused():
    """Friction by an oil film has no coefficient to calibrate."""
    film = knee().changed({"seals.rod.friction": "film"})
    with pytest.raises(ao.InputError, match="oil film") as caught:
        calibration(replace(identified("plateaus"), bench=bench(film.subject())))
    assert caught.value.diagnostics[0].path == "seals.rod.friction"


def test_calibrating_again_changes_nothing():
    """The calibrated design states what the record measures: a second pass gives factor one."""
    whole = rubbed(changed(1.4, 2.2, 4e-3, 150.0))
    found = calibration(whole)
    again = bench(knee().changed(found.values()).subject())
    second = calibration(replace(whole, bench=again))
    for path, value in found.values().items():
        assert second.values()[path] == pytest.approx(value, rel=1e-9), path
    factor = next(one for one in second.learned if one.name == "friction_coefficient")
    assert factor.known.value == pytest.approx(1.0, rel=1e-9)
