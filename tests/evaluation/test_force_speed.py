"""Limits in the plane of force and speed, against numbers of an independent program."""

import math

import numpy as np
import pytest
from duty_page_case import cycle, evaluated

from actuator_opt.evaluation.duty_cycles.force_speed import force_limits
from actuator_opt.evaluation.duty_cycles.numbers import SamplePlan

BAR = 1e5
AREA_A, AREA_B = math.pi / 4 * 0.023**2, math.pi / 4 * (0.023**2 - 0.013**2)
EDGE = 10 / 60000 / math.sqrt(35 * BAR)
"""Cylinder 23/13 mm, 210 bar, return 5 bar, valve of 10 l/min at 35 bar per edge."""
PLAN = SamplePlan(frozenset(), True, (), (), (), {})


def limits(plan=PLAN, speeds=(0.0,), **changed):
    """The limits of the example by direction and opening."""
    u = {
        "supply": 210 * BAR, "drain": 5 * BAR, "area_a": AREA_A, "area_b": AREA_B,
        "opening_limit": 0.9, "piston_leakage": 0.0, "other_friction": 0.0, "level": 210 * BAR,
        "arm": 1.0, "shift": 0.0, "load_scale": 1.0, "time_scale": 1.0,
    }  # fmt: skip
    for name in ("feed_a", "feed_b", "drain_a", "drain_b"):
        u |= {name: EDGE, f"{name}.leak_root": 0.0, f"{name}.leak_linear": 0.0}
    found = force_limits(plan, u | changed, np.array(speeds))
    return {(limit.direction, limit.opening): limit for limit in found}


def force_at(limit, speed):
    """The limit at a speed: with constant friction it is a parabola through all points."""
    slope, start = np.polyfit(limit.speed**2, limit.force, 1)
    assert start + slope * limit.speed**2 == pytest.approx(limit.force, rel=1e-6, abs=1e-2)
    return start + slope * speed**2


def test_the_force_reserve_of_the_source_ends_at_the_limit():
    """Load and reserve of a sample add up to the limit."""
    # force 1000 N at 0.38 m/s leaves 5464.91 N; -500 N at -0.4 m/s leaves 2882.28 N
    found = limits()
    assert force_at(found["extending", 0.9], 0.38) == pytest.approx(1000 + 5464.91, rel=1e-6)
    assert force_at(found["retracting", 0.9], -0.4) == pytest.approx(-500 - 2882.28, rel=1e-6)


@pytest.mark.parametrize(
    ("direction", "force", "speed"),
    [
        ("extending", 1000, 0.798811),
        ("extending", -1000, 0.897988),
        ("retracting", 1000, 0.752505),
        ("retracting", -1000, 0.630857),
    ],
)
def test_the_fully_open_valve_reaches_the_speeds_of_the_source(direction, force, speed):
    """The source has the largest speed at a force; here it is read off the curve."""
    assert force_at(limits()[direction, 1.0], speed) == pytest.approx(force, abs=0.05)


def test_friction_narrows_the_limits_of_both_directions():
    """Friction acts against the motion."""
    free, rubbed = limits(), limits(other_friction=100.0)
    assert rubbed["extending", 0.9].force == pytest.approx(free["extending", 0.9].force - 100)
    assert rubbed["retracting", 0.9].force == pytest.approx(free["retracting", 0.9].force + 100)


def test_the_curves_end_where_the_chamber_falls_to_the_pressure_of_the_air():
    """There the whole supply pressure is lost in the edge that feeds the chamber."""
    # p_d = 0 takes the whole supply in the feeding edge: v = y K sqrt(p_s)/A_d, and the balance of
    # forces is then P = -A_o (p_T + c p_s), c = (A_o/A_d)^2
    for (direction, opening), limit in limits().items():
        driven, other = (AREA_A, AREA_B) if direction == "extending" else (AREA_B, AREA_A)
        sign = 1.0 if direction == "extending" else -1.0
        end = sign * opening * EDGE * math.sqrt(210 * BAR) / driven
        least = -sign * other * (5 * BAR + (other / driven) ** 2 * 210 * BAR)
        assert limit.speed[-1] == pytest.approx(end)
        assert limit.suction == pytest.approx(np.full(limit.speed.shape, least))
        assert limit.force[-1] == pytest.approx(least)


def test_without_a_valve_the_supply_alone_limits_the_force():
    """The curve is level, and only for the direction in which the cycle moves."""
    found = limits(SamplePlan(frozenset(), False, (), (), (), {}), speeds=(0.0, 0.3))
    assert [*found] == [("extending", None)]  # the cycle does not retract
    limit = found["extending", None]
    assert limit.speed[-1] == pytest.approx(0.3)
    stall = 210 * BAR * AREA_A - 5 * BAR * AREA_B
    assert limit.force == pytest.approx(np.full(limit.speed.shape, stall))
    assert limit.suction is None


def test_a_motion_on_the_limit_of_a_real_design_has_no_reserve():
    """The seals of the knee rub by their pressures and speed."""
    limit = worst_of(40.0, 0.05, 10.0).limits[0]
    assert (limit.direction, limit.opening) == ("extending", 0.9)
    speed, force = float(limit.speed[25]), float(limit.force[25])
    worst = worst_of(20.0, speed, force).worst
    assert worst["reserve"].value == pytest.approx(0.0, abs=1e-4 * force)
    assert worst["opening"].value == pytest.approx(0.9, rel=1e-4)


def worst_of(start, speed, force):
    """A cycle of constant speed and force, from a position [mm]."""
    rows = [f"{0.01 * k},{start + 10 * k * speed},{force}" for k in range(5)]
    record = "time [s],position [mm],force [N]\n" + "\n".join(rows)
    return evaluated(cycle("push", record, closed="false"), linkage=False).duty.cycles[0]
