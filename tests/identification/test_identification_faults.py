"""Records and choices that mislead: each is refused, named with a remedy, or left unidentified."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import bench_oracle as oracle
import numpy as np
import pytest

import actuator_opt as ao
from actuator_opt.base.errors import InputError
from actuator_opt.identification import (
    Settings,
    conditioning as conditioning_module,
    identify,
    parse_record,
    synthetic,
)
from actuator_opt.identification.points import SETTLED, steady_points
from actuator_opt.studies.bench import bench as bench_of

DESIGNS = Path(__file__).parents[2] / "designs"
TRUTH = oracle.Friction()
LATE = Settings(pressure_lag=4e-3)


@cache
def bench(**changes):
    """The knee's bench, with values of the design changed."""
    return bench_of(ao.read(DESIGNS / "knee_bonded.yaml", set=changes).subject())


@cache
def knee():
    """The bench record of the knee: three loads, bore 23 mm, pressures 4 ms late."""
    path = DESIGNS / "records" / "knee_bench.csv"
    return parse_record(path.read_text(encoding="utf-8"), name=path.name)


def but(record, **channels):
    """The record with other channels."""
    return replace(record, channels=dict(record.channels) | channels)


@cache
def plateaus(speeds=(0.002, 0.005, 0.02, 0.06, 0.15), **given):
    """The oracle's record of plateaus."""
    on = bench()
    return oracle.measured(
        oracle.cylinder_of(on), TRUTH, oracle.plateaus(speeds, longest=0.6), mass=on.mass, **given
    )


def refused(record, on=None, settings=None):
    """The one line by which a record is refused."""
    with pytest.raises(InputError) as caught:
        identify(record, on or bench(), settings)
    (diagnostic,) = caught.value.diagnostics
    return f"{diagnostic.message} -> {diagnostic.remedy}"


@pytest.mark.parametrize("cutoff", [1.0, 2.0, 5.0])
def test_a_low_cut_off_leaves_no_windows(cutoff):
    """Ends of 1/f each leave of half a second (0.5 - 2/f) 2 f = 1 - 4 < 4 samples below 8 Hz."""
    found = identify(knee(), bench(), Settings(cutoff=cutoff))
    assert "no reversal can be used, because a cut-off" in found.lugre
    assert "8 Hz" in found.lugre


@pytest.mark.parametrize("cutoff", [1.0, 2.0, 5.0, 30.0])
def test_a_low_cut_off_makes_no_wrong_plateaus(cutoff):
    """F_C = 33 N + 0.8 N/bar (p - 5 bar) lies in its bounds, or plateaus of 0.8 s show none.

    Ends of 1/f each leave nothing of them up to 2.5 Hz.
    """
    found = identify(knee(), bench(), Settings(cutoff=cutoff))
    if cutoff < 2.5:
        assert found.points == ()
        assert isinstance(found.stribeck, str)
        return
    level = found.stribeck.parameters["coulomb"]
    true = 33.0 + 8e-6 * (found.stribeck.reference_pressure - 5e5)
    assert true == pytest.approx(77.8, abs=1.0)
    assert level.identifiable
    assert level.lower < true < level.upper


def test_a_slow_record_leaves_no_windows():
    """10 samples per second allow a cut-off of 3 Hz: friction, and one line for LuGre."""
    thin = slice(None, None, 100)
    full = plateaus((0.001, 0.002, 0.004))
    channels = {name: one[thin] for name, one in full.channels.items()}
    found = identify(replace(full, time=full.time[thin], channels=channels), bench(), Settings(3.0))
    assert "no reversal can be used, because a cut-off" in found.lugre


@pytest.mark.long
@pytest.mark.parametrize("stated", [22.5, 22.95, 23.05, 23.5])
def test_a_wrong_bore_is_named_with_the_true_one(stated):
    """A_1 by a wrong D leaves p_1 (A - A') alike both ways: D = 23 mm is told within 0.1 mm."""
    found = identify(knee(), bench(**{"cylinder.bore": f"{stated} mm"}))
    (doubt,) = [one for one in found.stribeck.doubts if "The bore seems to be" in one]
    told = float(doubt.split("seems to be ")[1].split(" mm")[0])
    assert told == pytest.approx(23.0, abs=0.1)
    assert f"{stated:g} mm stated" in doubt
    assert "sensor" in doubt
    assert not any("cannot show which" in one for one in found.stribeck.doubts)
    for model in (found.stribeck, found.lugre):
        level = model.parameters["coulomb"]
        assert not level.identifiable or level.lower < 77.8 < level.upper


def test_the_right_bore_is_not_doubted():
    """With 23 mm as it is nothing is unequal."""
    found = identify(knee(), bench())
    assert not any("unequal" in one for one in found.stribeck.doubts)
    assert found.stribeck.parameters["coulomb"].identifiable
    assert found.lugre.parameters["coulomb"].identifiable


def test_an_offset_that_pressure_does_not_change_is_no_area():
    """50 kPa more in p1 is 50 kPa A_1 = 20.8 N at every load: zeros or seals, not the areas."""
    found = identify(but(knee(), p1=knee()["p1"] + 50e3), bench())
    assert found.stribeck.values["offset"] == pytest.approx(50e3 * np.pi / 4 * 0.023**2, abs=1.0)
    assert any("not the areas" in one for one in found.stribeck.doubts)
    assert not any("seems to be" in one for one in found.stribeck.doubts)


@pytest.mark.long
def test_an_offset_of_a_made_up_sensor():
    """1 bar more in p1 of a made-up record is F_0 = A_1 1e5 Pa = 41.5 N."""
    truth = synthetic.Truth(
        coulomb=150.0,
        static=300.0,
        stribeck_speed=4e-3,
        exponent=2.0,
        viscous=200.0,
        bristle_stiffness=5e6,
        bristle_damping=1e3,
    )
    speeds = (0.002, 0.005, 0.02, 0.06, 0.15)
    course = synthetic.plateaus(speeds, travel=0.05, begin=0.02, longest=0.6)
    force = synthetic.friction_along(truth, course, 0 * course.time)
    sensors = synthetic.Sensors(pressure_offset=1e5)
    record = synthetic.record(bench(), course, force, mass=bench().mass, sensors=sensors)
    found = identify(record, bench(), Settings(pressure_lag=0.0))
    assert found.stribeck.values["offset"] == pytest.approx(1e5 * np.pi / 4 * 0.023**2, abs=1.5)


def test_an_offset_as_large_as_friction_leaves_nothing_identified():
    """F_0 = 1.2 F would have friction drive the rod one way: nothing is called identifiable."""
    record = plateaus((0.01, 0.02, 0.03, 0.05))
    area = np.pi / 4 * 0.023**2
    found = identify(but(record, p1=record["p1"] + 1.2 * 155 / area), bench(), LATE)
    assert any("would drive the rod" in one for one in found.stribeck.doubts)
    for model in (found.stribeck, found.lugre):
        assert not any(one.identifiable for one in model.parameters.values())


def test_a_model_that_misses_friction_is_not_identifiable():
    """Where LuGre says that it misses friction, only what the steady points know too is left."""
    found = identify(knee(), bench(**{"cylinder.bore": "22.5 mm"}))
    assert any("deviates from the measured friction" in one for one in found.lugre.doubts)
    assert any("misses the points" in one for one in found.stribeck.doubts)
    assert not any(one.identifiable for one in found.lugre.parameters.values())


@pytest.mark.parametrize("kind", ["constant", "a digit", "1 um"])
def test_a_rod_that_never_moves(kind):
    """A constant x, with a flickering last digit or 1 um of noise: the rod never moves."""
    rng = np.random.default_rng(0)
    still = np.full(knee().time.size, 0.015)
    noise = {
        "constant": 0.0 * still,
        "a digit": 1e-5 * (rng.random(still.size) < 0.3),
        "1 um": 1e-6 * rng.standard_normal(still.size),
    }
    assert "the rod never moves" in refused(but(knee(), x=still + noise[kind]))


def test_travel_beyond_the_stroke():
    """Ten times the travel, 799 mm of 110 mm, is a wrong unit; an offset of x is not."""
    line = refused(but(knee(), x=10 * knee()["x"]))
    assert "but the stroke is 110 mm" in line
    assert "unit of x" in line
    assert "cylinder.stroke" in line
    moved = identify(but(knee(), x=knee()["x"] + 0.2), bench())
    assert any("the zero of x is not at the cap end" in one for one in moved.notes)


def test_a_reversed_position_is_named():
    """Friction of the same size that drives by 100 % opposes as soon as x is turned."""
    assert "x seems to have the wrong sign" in refused(but(knee(), x=0.1 - knee()["x"]))


def test_reversed_pressures_are_two_options():
    """The remedy is what the command takes: one --column each."""
    line = refused(but(knee(), p1=knee()["p2"], p2=knee()["p1"]))
    assert "p1 and p2 seem swapped" in line
    assert "--column p1=... --column p2=..." in line
    assert "F_L seems to have the wrong sign" in refused(but(knee(), F_L=-knee()["F_L"]))


@pytest.mark.long
@pytest.mark.parametrize(("factor", "told"), [(2.0, "2.00"), (-1.0, "-1.00"), (0.0, "0.00")])
def test_a_velocity_that_is_not_the_slope_of_x(factor, told):
    """A channel v of k dx/dt is noted with its k; one that agrees is not."""
    record = plateaus()
    pace = np.gradient(record["x"], record.time)
    notes = identify(but(record, v=factor * pace), bench(), LATE).notes
    assert any(f"v is {told} times the time derivative of x" in one for one in notes)
    notes = identify(but(record, v=pace), bench(), LATE).notes
    assert not any("time derivative of x" in one for one in notes)


def test_a_short_slow_plateau_says_what_has_not_settled():
    """0.5 mm/s for 0.6 s is 4 breakaway travels F_S/sigma_0 = 64 um: 2 F e^-d is left somewhere.

    The errors of all points hold the truth within 2.5 standard errors; the slow ones weigh little.
    """
    truth = replace(TRUTH, static=320.0)
    motion = oracle.plateaus((0.0005, 0.001, 0.004, 0.01, 0.03, 0.1), longest=0.6)
    on = bench()
    record = oracle.measured(oracle.cylinder_of(on), truth, motion, mass=on.mass)
    found = identify(record, on, LATE)
    points = steady_points(found.slidings, found.motion, SETTLED)
    for one in points:
        true = np.sign(one.velocity) * truth.steady(one.speed)
        assert abs(one.friction - true) < 2.5 * one.error
    slow = [one.error for one in points if one.speed < 6e-4]
    fast = [one.error for one in points if one.speed > 2e-3]
    assert min(slow) > 3 * max(fast)


@pytest.mark.long
def test_steps_of_the_position_widen_the_lag():
    """Turns known to 10 um shift the lag by up to e/v: bounds hold the truth, 0 or 4 ms."""
    motion = oracle.ramps(fastest=0.06, duration=2.4, repeats=5)
    on = bench()
    for late in (0.0, 4e-3):
        sensors = oracle.without(oracle.Sensors(), lag=late)
        record = oracle.measured(
            oracle.cylinder_of(on), TRUTH, motion, mass=on.mass, sensors=sensors
        )
        found = identify(record, on, Settings())
        lag = found.lugre.parameters["lag"]
        taken = found.pressure_lag
        assert lag.lower + taken <= late - 0.2e-3 <= lag.upper + taken
        assert lag.upper - lag.lower > 2e-3


@pytest.mark.long
def test_slow_speeds_do_not_tell_the_level():
    """1 to 2 mm/s lie within the Stribeck rise of v_s = 4 mm/s: 270 N there is not F_C = 150 N."""
    found = identify(plateaus((0.001, 0.0015, 0.002)), bench(), LATE)
    for model in (found.stribeck, found.lugre):
        assert not model.parameters["coulomb"].identifiable
        assert any("F_C" in one for one in model.doubts)
    found = identify(plateaus((0.002,) * 3), bench(), LATE).lugre
    assert any(("F_C" in one and "level" in one) or "separated" in one for one in found.doubts)


def test_a_plunger_can_be_made_up():
    """A plunger of area pi d^2/4 under 900 N and 50 N of friction: p1 = 950 N/A, and no p2."""
    on = bench(**{"seals.piston.count": 0})
    course = synthetic.plateaus((0.01, 0.05), travel=0.02, begin=0.02)
    record = synthetic.record(on, course, 0 * course.time + 50.0, load=900.0)
    assert "p2" not in record
    area = np.pi / 4 * on.rod_diameter**2
    np.testing.assert_allclose(record["p1"], 950.0 / area, rtol=1e-12)


@pytest.mark.parametrize(
    ("settings", "line"),
    [
        (Settings(mass=-1.0), "the moving mass is -1 kg"),
        (Settings(mass=float("nan")), "the moving mass is nan kg"),
        (Settings(load_force=float("inf")), "the load is inf N"),
        (Settings(pressure_lag=0.4), "from -0.1 to 0.1 s"),
    ],
)
def test_settings_that_are_none(settings, line):
    """A negative mass, a load without a value, a lag of 0.4 s: refused in one line."""
    record = knee()
    if settings.load_force is not None:
        channels = {name: one for name, one in record.channels.items() if name != "F_L"}
        record = replace(record, channels=channels)
    assert line in refused(record, settings=settings)


def test_a_record_is_cleaned_once(monkeypatch):
    """Taking off a lag filters again, but cleans no channel twice: x, p1, p2, F_L are four."""
    count = []
    clean = conditioning_module.clean

    def counted(*given, **more):
        count.append(1)
        return clean(*given, **more)

    monkeypatch.setattr(conditioning_module, "clean", counted)
    found = identify(knee(), bench())
    assert found.pressure_lag > 1e-3
    assert len(count) == 4
