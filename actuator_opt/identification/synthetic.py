"""Synthetic test records with known friction, to plan a test or to check a method."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array
from ..models import friction, lugre
from ..studies.bench import Bench
from .record import Record


@dataclass(frozen=True, slots=True)
class Truth:
    """Friction of a synthetic cylinder, SI: LuGre bristles with a Stribeck curve."""

    coulomb: float
    static: float
    stribeck_speed: float
    exponent: float
    viscous: float
    bristle_stiffness: float
    bristle_damping: float
    pressure_slope: float = 0.0
    """Increase of F_C per increase of the higher chamber pressure [N/Pa]; F_S changes in
    proportion."""
    reference_pressure: float = 0.0


@dataclass(frozen=True, slots=True)
class Sensors:
    """Errors of the sensors of a synthetic record.

    Parameters
    ----------
    pressure_range : range of the pressure sensors [Pa]
    pressure_noise : standard deviation of the pressures, as a share of that range
    position_step : resolution of the position sensor [m]
    force_noise : standard deviation of the force [N]
    pressure_lag : time lag of the pressures [s]
    spikes : share of the samples that are spikes, in every channel
    pressure_offset : zero error of p1 [Pa]
    """

    pressure_range: float = 25e6
    pressure_noise: float = 1e-3
    position_step: float = 10e-6
    force_noise: float = 0.0
    pressure_lag: float = 0.0
    spikes: float = 0.0
    pressure_offset: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class PrescribedMotion:
    """Prescribed motion of the rod, SI; arrays (samples)."""

    time: Array
    position: Array
    velocity: Array
    acceleration: Array


def plateaus(
    speeds: Sequence[float],
    *,
    travel: float,
    begin: float,
    step: float = 1e-3,
    ramp: float = 0.05,
    rest: float = 0.1,
    longest: float = 3.0,
) -> PrescribedMotion:
    """Strokes out and back, each at constant speed, with smooth ramps and a rest between strokes.

    A stroke covers `travel`, or less if it would take more than `longest` seconds.

    Parameters
    ----------
    speeds : speeds of the strokes [m/s]
    travel : length of an outward stroke [m]
    begin : initial position [m]
    step : time step [s]
    ramp : time from rest to full speed, along half a cosine wave [s]
    rest : time at rest between strokes [s]
    longest : longest time of a stroke at constant speed [s]

    Returns
    -------
    the motion
    """
    parts = [np.zeros(round(rest / step))]
    rise = (1 - np.cos(np.pi * np.arange(round(ramp / step)) * step / ramp)) / 2
    for speed in speeds:
        constant = np.ones(round(min(max(travel / speed - ramp, ramp), longest) / step))
        stroke = speed * np.concatenate([rise, constant, rise[::-1]])
        parts += [stroke, np.zeros(round(rest / step)), -stroke, np.zeros(round(rest / step))]
    return course(np.concatenate(parts), begin=begin, step=step)


def course(velocity: Array, *, begin: float, step: float) -> PrescribedMotion:
    """The motion with a given velocity at each time step, from the initial position `begin`, SI."""
    time = step * np.arange(velocity.size)
    distance = np.concatenate([[0.0], np.cumsum((velocity[1:] + velocity[:-1]) / 2) * step])
    return PrescribedMotion(time, begin + distance, velocity, np.gradient(velocity, step))


def friction_along(truth: Truth, course: PrescribedMotion, pressure: Array) -> Array:
    """Friction that the LuGre model `truth` gives along a motion, without measuring errors [N].

    `pressure` is the higher chamber pressure at each sample.
    """
    between = (course.velocity[1:] + course.velocity[:-1]) / 2
    change = (pressure[1:] + pressure[:-1]) / 2 - truth.reference_pressure
    level = friction.stribeck_level(
        speed=between,
        coulomb=truth.coulomb,
        static=truth.static,
        stribeck_speed=truth.stribeck_speed,
        exponent=truth.exponent,
    )
    level = level * (1 + truth.pressure_slope * change / truth.coulomb)
    step = float(course.time[1] - course.time[0])
    forces = np.zeros(course.time.size)
    deflection = 0.0
    for k, (speed, level_here) in enumerate(zip(between.tolist(), level.tolist(), strict=True)):
        step_result = lugre.lugre_step(
            deflection=deflection,
            speed=speed,
            time_step=step,
            level=level_here,
            bristle_stiffness=truth.bristle_stiffness,
            bristle_damping=truth.bristle_damping,
            viscous=truth.viscous,
        )
        deflection, forces[k + 1] = step_result.deflection, step_result.force
    return forces


def pressures(
    bench: Bench, course: PrescribedMotion, force: Array, *, back_pressure: float, mass: float
) -> tuple[Array, Array]:
    """Chamber pressures that drive a mass against a force [Pa].

    The lower pressure is `back_pressure`. The higher pressure and the growth of the bore that it
    causes are solved together. In a plunger cylinder only p1 pushes; the load returns the plunger.
    """
    needed = force + mass * course.acceleration
    if bench.plunger:
        return needed / bench.areas(np.float64(0.0))[0], 0.0 * needed
    highest: Array = back_pressure
    for _ in range(4):
        area_1, area_2 = bench.areas(highest)
        push = (needed + back_pressure * area_2) / area_1
        pull = (back_pressure * area_1 - needed) / area_2
        extending = push >= back_pressure
        first = np.where(extending, push, back_pressure)
        second = np.where(extending, back_pressure, pull)
        highest = np.maximum(first, second)
    return first, second


def record(
    bench: Bench,
    course: PrescribedMotion,
    friction_force: Array,
    *,
    load: Array = 0.0,
    mass: float = 0.0,
    back_pressure: float = 5e5,
    sensors: Sensors | None = None,
    rng: np.random.Generator | None = None,
    name: str = "synthetic",
) -> Record:
    """Sensor readings during a motion with known friction.

    Parameters
    ----------
    bench : the actuator
    course : its motion
    friction_force : friction with the sign of the velocity (samples) [N]
    load : load on the rod, positive if it opposes extension [N]
    mass : moving mass on the actuator's side of the force sensor [kg]
    back_pressure : pressure of the chamber that is not driven [Pa]
    sensors : errors of the sensors; None for perfect sensors
    rng : random generator of the noise
    name : name of the record

    Returns
    -------
    the record with channels p1, p2, x, F_L; a plunger has no p2
    """
    load = np.broadcast_to(load, course.time.shape).astype(float)
    p1, p2 = pressures(bench, course, friction_force + load, back_pressure=back_pressure, mass=mass)
    channels = {"p1": p1, "p2": p2, "x": course.position, "F_L": load}
    if bench.plunger:
        del channels["p2"]
    if sensors is not None:
        channels = _sensed(channels, course.time, sensors, rng or np.random.default_rng(0))
    return Record(course.time, channels, name)


def _sensed(
    channels: Mapping[str, Array], time: Array, sensors: Sensors, rng: np.random.Generator
) -> dict[str, Array]:
    """The channels as imperfect sensors show them: with lag, offset, noise, steps and spikes."""
    readings = dict(channels)
    scatter = {
        "p1": sensors.pressure_noise * sensors.pressure_range,
        "p2": sensors.pressure_noise * sensors.pressure_range,
        "F_L": sensors.force_noise,
    }
    for name in ("p1", "p2"):
        if name in readings:
            readings[name] = np.interp(time - sensors.pressure_lag, time, readings[name])
    readings["p1"] = readings["p1"] + sensors.pressure_offset
    for name, sigma in scatter.items():
        if name in readings:
            readings[name] = readings[name] + sigma * rng.standard_normal(time.size)
    if sensors.position_step:
        readings["x"] = sensors.position_step * np.round(readings["x"] / sensors.position_step)
    for name, values in readings.items():
        spike = rng.random(time.size) < sensors.spikes
        height = max(float(np.ptp(values)), 1e-6)
        readings[name] = np.where(spike, values + height * rng.uniform(-1, 1, time.size), values)
    return readings
