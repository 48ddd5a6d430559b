"""Identifications of short made-up records: every kind of test, and what has no value."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

import actuator_opt as ao
from actuator_opt.identification import identify, synthetic
from actuator_opt.identification.record import Record
from actuator_opt.studies.bench import bench

DESIGN = Path(__file__).parents[2] / "designs" / "knee_bonded.yaml"
SOURCE = DESIGN.read_text(encoding="utf-8")
TRUTH = synthetic.Truth(
    coulomb=150.0,
    static=300.0,
    stribeck_speed=4e-3,
    exponent=2.0,
    viscous=200.0,
    bristle_stiffness=5e6,
    bristle_damping=1e3,
)
SENSORS = synthetic.Sensors(pressure_lag=4e-3, spikes=0.01)
SPEEDS = (0.001, 0.002, 0.003, 0.006, 0.02, 0.05, 0.2)
COURSES = {
    "plateaus": lambda: synthetic.plateaus(SPEEDS, travel=0.05, begin=0.02, longest=0.8),
    "sine": lambda: sine(amplitude=0.04, frequency=0.4, periods=4, middle=0.055),
    "ramp": lambda: ramps(fastest=0.05, duration=2.0, begin=0.02, repeats=2),
    "pre-sliding": lambda: sine(amplitude=1.2e-4, frequency=0.5, periods=4, middle=0.055),
    "one speed": lambda: synthetic.plateaus([0.05] * 2, travel=0.05, begin=0.015),
}
KINDS = (*COURSES, "gaps", "outside", "levels", "plunger", "one way", "bare")


def sine(*, amplitude, frequency, periods, middle, step=1e-3):
    """A sine of position about its middle, SI."""
    time = step * np.arange(round(periods / frequency / step))
    turn = 2 * np.pi * frequency
    return synthetic.PrescribedMotion(
        time,
        middle - amplitude * np.cos(turn * time),
        amplitude * turn * np.sin(turn * time),
        amplitude * turn**2 * np.cos(turn * time),
    )


def ramps(*, fastest, duration, begin, step=1e-3, repeats=2):
    """Velocity up to `fastest` and back to rest along straight lines, out and back, SI."""
    up = np.linspace(0.0, fastest, round(duration / 2 / step))
    once = np.concatenate([up, up[::-1]])
    return synthetic.course(np.concatenate([once, -once] * repeats), begin=begin, step=step)


@cache
def knee(plunger: bool = False):
    """The knee on a test bench; as a plunger it has no piston seal."""
    sets = {"seals.piston.count": 0} if plunger else {}
    return bench(ao.read(SOURCE, set=sets).subject())


def _sensed(name: str, course, *, load=0.0, truth=TRUTH, back_pressure=5e5) -> Record:
    own = knee()
    found = synthetic.friction_along(truth, course, np.zeros_like(course.time))
    if truth.pressure_slope:
        first, second = synthetic.pressures(
            own, course, found + load, back_pressure=back_pressure, mass=own.mass
        )
        found = synthetic.friction_along(truth, course, np.maximum(first, second))
    return synthetic.record(
        own,
        course,
        found,
        load=load,
        mass=own.mass,
        back_pressure=back_pressure,
        sensors=SENSORS,
        rng=np.random.default_rng(7),
        name=name,
    )


def _levels() -> Record:
    """The same speeds without a load and against two loads; friction grows with pressure."""
    once = synthetic.plateaus(SPEEDS[1:], travel=0.04, begin=0.02, longest=0.5)
    count = once.time.size
    course = synthetic.PrescribedMotion(
        once.time[1] * np.arange(3 * count),
        np.tile(once.position, 3),
        np.tile(once.velocity, 3),
        np.tile(once.acceleration, 3),
    )
    load = np.repeat([0.0, 2500.0, 6000.0], count)
    smooth = np.convolve(np.pad(load, 40, mode="edge"), np.ones(81) / 81, mode="valid")
    return _sensed("levels.csv", course, load=smooth, truth=replace(TRUTH, pressure_slope=1e-5))


def _plunger() -> Record:
    """A rod that a load pushes back: no second chamber."""
    own, course = knee(plunger=True), COURSES["plateaus"]()
    found = synthetic.friction_along(TRUTH, course, np.zeros_like(course.time))
    load = 2000.0 + 0.0 * course.time
    push = (found + load + own.mass * course.acceleration) / own.areas(np.zeros(1))[0][0]
    rng = np.random.default_rng(7)
    first = push + 2.5e4 * rng.standard_normal(push.size)
    place = 1e-5 * np.round(course.position / 1e-5)
    return Record(course.time, {"p1": first, "x": place, "F_L": load}, "plunger.csv")


def _gaps() -> Record:
    """Samples missing for long and for short, a clipped pressure, uneven times."""
    whole = _sensed("gaps.csv", COURSES["plateaus"]())
    channels = {name: one.copy() for name, one in whole.channels.items()}
    channels["p1"][3000:3400] = np.nan
    channels["x"][5200:5203] = np.nan
    channels["p1"] = np.minimum(channels["p1"], np.nanpercentile(channels["p1"], 98.5))
    rng = np.random.default_rng(3)
    time = whole.time + 1e-4 * rng.uniform(-1, 1, whole.time.size)
    kept = np.ones(time.size, dtype=bool)
    kept[7000:7600] = False
    return Record(time[kept], {n: v[kept] for n, v in channels.items()}, "gaps.csv")


def record_of(kind: str) -> Record:
    """The record of a kind of test."""
    if kind == "gaps":
        return _gaps()
    if kind == "levels":
        return _levels()
    if kind == "plunger":
        return _plunger()
    if kind == "outside":
        whole = _sensed("outside.csv", COURSES["plateaus"]())
        return Record(whole.time, {**whole.channels, "x": whole["x"] - 0.5}, "outside.csv")
    if kind == "one way":
        speed = np.repeat(SPEEDS[1:], 300)
        course = synthetic.PrescribedMotion(
            1e-3 * np.arange(speed.size), 0.02 + 1e-3 * np.cumsum(speed), speed, 0.0 * speed
        )
        return _sensed("one_way.csv", course)
    return _sensed(f"{kind.replace(' ', '_')}.csv", COURSES[kind]())


@cache
def identified(kind: str):
    """What a record of a kind tells; `bare` is one without any model."""
    if kind == "bare":
        whole = identified("pre-sliding")
        why = (
            "the record has no uninterrupted half second about a reversal, where the "
            "deflection of bristles shows"
        )
        return replace(
            whole,
            points=(),
            stribeck="no steady sliding: a Stribeck curve needs plateaus or sweeps of 2 speeds",
            lugre=why,
            coefficient="no sliding of 0.1 s above 1 mm/s: no friction coefficient",
            fits=dict.fromkeys(whole.fits, "0 different speeds for a law"),
        )
    return identify(record_of(kind), knee(plunger=kind == "plunger"))
