"""Test bench records of known friction, made without the package's own maker of records.

Bristles by the trapezoidal rule on steps far below the sample's, or with a free mass by SciPy's
Radau; areas and the pressures' balance from the cylinder's own dimensions; sensors of its own.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi

import numpy as np
from scipy.integrate import solve_ivp

from actuator_opt.identification.record import Record

FINE = 10
"""Steps of the integration per sample."""
SAMPLE = 1e-3


@dataclass(frozen=True)
class Friction:
    """Stribeck level g(v) with LuGre bristles, SI; numbers, or arrays (lanes, 1)."""

    coulomb: float = 150.0
    static: float = 300.0
    stribeck_speed: float = 4e-3
    exponent: float = 2.0
    viscous: float = 200.0
    bristle_stiffness: float = 5e6
    bristle_damping: float = 1e3
    pressure_slope: float = 0.0
    reference_pressure: float = 0.0

    def level(self, speed, pressure):
        """g(v) at a pressure; F_S grows with pressure as F_C does."""
        rise = self.static - self.coulomb
        at_rest = np.exp(-np.power(np.abs(speed) / self.stribeck_speed, self.exponent))
        change = pressure - self.reference_pressure
        return (self.coulomb + rise * at_rest) * (1 + self.pressure_slope * change / self.coulomb)

    def steady(self, speed, pressure=0.0):
        """Friction of steady sliding outwards."""
        return self.level(speed, pressure) + self.viscous * speed


@dataclass(frozen=True)
class Cylinder:
    """Dimensions; `growth` of the bore's radius over pressure; a plunger has no piston seal."""

    bore: float
    rod: float
    growth: float
    plunger: bool = False

    def areas(self, highest):
        """Cap-end and rod-end areas at the higher chamber pressure."""
        rod_area = pi / 4 * self.rod**2
        if self.plunger:
            return rod_area + 0 * highest, 0 * highest
        cap = pi / 4 * (self.bore + 2 * self.growth * highest) ** 2
        return cap, cap - rod_area

    def pressures(self, force, back):
        """Both chambers' pressures that push with a force; the lower one is at `back`."""
        if self.plunger:
            return force / self.areas(0.0)[0], 0 * force
        highest = back + 0 * force
        for _ in range(8):
            cap, annulus = self.areas(highest)
            first = np.maximum(back, (force + back * annulus) / cap)
            second = np.where(first > back, back, (back * cap - force) / annulus)
            highest = np.maximum(first, second)
        return first, second


@dataclass(frozen=True)
class Sensors:
    """Realistic ones by default: 0.1 % of 25 MPa, 10 um, 4 ms, one sample in twenty an outlier."""

    pressure_noise: float = 25e3
    position_step: float = 10e-6
    force_noise: float = 2.0
    lag: float = 4e-3
    outliers: float = 0.05


@dataclass(frozen=True)
class Way:
    """A motion on fine steps: velocity, position, acceleration, all (fine samples)."""

    velocity: np.ndarray
    position: np.ndarray
    acceleration: np.ndarray
    step: float


def way(velocity, begin, step=SAMPLE / FINE):
    """A motion from its velocity on fine steps, Simpson's rule between."""
    velocity = np.asarray(velocity, dtype=float)
    middle = (velocity[1:] + velocity[:-1]) / 2
    position = begin + np.concatenate([[0.0], np.cumsum(middle) * step])
    return Way(velocity, position, np.gradient(velocity, step), step)


def plateaus(speeds, *, travel=0.06, begin=0.02, longest=2.0, rise=0.08, rest=0.15):
    """Constant speeds out and back, from rest to rest by smooth fifth-order ramps.

    Strokes begin at other places of the sensor's steps, as on a bench.
    """
    step = SAMPLE / FINE
    s = np.arange(round(rise / step)) * step / rise
    ramp = s**3 * (10 - 15 * s + 6 * s * s)
    still = np.zeros(round(rest / step))
    parts = [still]
    for k, speed in enumerate(speeds):
        count = round(min(travel / speed - rise, longest) / step)
        more = round((37e-6 * (k + 1)) % 1e-4 / (speed * step))
        out, back = (np.concatenate([ramp, np.ones(n), 1 - ramp]) for n in (count, count + more))
        parts += [speed * out, still, -speed * back, still]
    return way(np.concatenate(parts), begin)


def sine(*, amplitude, frequency, periods, middle=0.055, drift=1e-4):
    """A sine about the middle that begins at its inner end.

    It drifts over the record: no bench turns at the same step of its sensor every time.
    """
    t = np.arange(round(periods / frequency / (SAMPLE / FINE))) * SAMPLE / FINE
    turn = 2 * pi * frequency
    return Way(
        amplitude * turn * np.sin(turn * t) + drift / t[-1],
        middle - amplitude * np.cos(turn * t) + drift * t / t[-1],
        amplitude * turn**2 * np.cos(turn * t),
        SAMPLE / FINE,
    )


def ramps(*, fastest, duration, begin=0.02, repeats=4):
    """Velocity up and down along straight lines, out and back."""
    up = np.linspace(0.0, fastest, round(duration / 2 / (SAMPLE / FINE)), endpoint=False)
    once = np.concatenate([up, fastest - up])
    return way(np.concatenate([once, -once] * repeats), begin)


def friction_force(friction, motion, pressure):
    """Friction along a motion by the trapezoidal rule on z' = v - sigma_0 |v| z/g.

    Begins with straight bristles; lanes of `friction` side by side.
    """
    speed = motion.velocity
    rate = friction.bristle_stiffness * np.abs(speed) / friction.level(speed, pressure)
    half = np.atleast_2d(rate) * motion.step / 2
    tail = ((1 - half[:, :-1]) / (1 + half[:, 1:])).T
    push = ((speed[1:] + speed[:-1]) / 2 * motion.step / (1 + half[:, 1:])).T
    bent = np.zeros((tail.shape[0] + 1, tail.shape[1]))
    if tail.shape[1] == 1:
        now, found = 0.0, [0.0]
        for keep, gain in zip(tail[:, 0].tolist(), push[:, 0].tolist(), strict=True):
            now = keep * now + gain
            found.append(now)
        bent[:, 0] = found
    else:
        for k in range(tail.shape[0]):
            bent[k + 1] = tail[k] * bent[k] + push[k]
    bent = bent.T.reshape(rate.shape)
    slip = speed - rate * bent
    return (
        friction.bristle_stiffness * bent
        + friction.bristle_damping * slip
        + friction.viscous * speed
    )


def measured(
    cylinder, friction, motion, *, load=0.0, mass=0.0, back=5e5, sensors=None, seed=0, cell=True
):
    """The record of a motion: pressures that drive it against friction, load and inertia.

    `load` and `back` are numbers or arrays (fine samples); without a cell no F_L is written.
    """
    inertia = mass * motion.acceleration
    pressure = back + 0 * motion.velocity
    for _ in range(6):
        force = friction_force(friction, motion, pressure)
        first, second = cylinder.pressures(force + load + inertia, back)
        pressure = np.maximum(first, second)
        if np.all(friction.pressure_slope == 0):
            break
    load = load + 0 * motion.velocity
    time = motion.step * np.arange(motion.velocity.size)
    channels = {"p1": first, "p2": second, "x": motion.position, "F_L": load}
    if cylinder.plunger:
        del channels["p2"]
    if not cell:
        del channels["F_L"]
    return sensed(time, channels, sensors or Sensors(), seed)


def sensed(time, channels, sensors, seed):
    """What sensors write: every FINE-th sample, late, noisy, in steps, with outliers."""
    rng = np.random.default_rng(seed)
    at = time[::FINE]
    late = {"p1": sensors.lag, "p2": sensors.lag}
    noise = {"p1": sensors.pressure_noise, "p2": sensors.pressure_noise}
    noise["F_L"] = sensors.force_noise
    found = {}
    for name, values in channels.items():
        seen = np.interp(at - late.get(name, 0.0), time, values)
        seen = seen + noise.get(name, 0.0) * rng.standard_normal(at.size)
        hit = rng.random(at.size) < sensors.outliers
        reach = np.ptp(seen)
        seen = np.where(hit, seen + reach * rng.uniform(-1, 1, at.size), seen)
        if name == "x" and sensors.position_step:
            seen = sensors.position_step * np.rint(seen / sensors.position_step)
        found[name] = seen
    return Record(at, found, "oracle")


def driven(cylinder, friction, *, mass, force, duration, begin=0.02, sensors=None, seed=0):
    """A free mass under a stated force(t, x, v), by Radau: position, velocity, bristles.

    The record has the pressures that make up the force at 0.5 MPa back pressure.
    """

    def bend(v, z):
        return v - friction.bristle_stiffness * abs(v) / friction.level(v, 0.0) * z

    def rub(v, z):
        return (
            friction.bristle_stiffness * z
            + friction.bristle_damping * bend(v, z)
            + friction.viscous * v
        )

    def slope(t, y):
        x, v, z = y
        return [v, (force(t, x, v) - rub(v, z)) / mass, bend(v, z)]

    step = SAMPLE / FINE
    time = step * np.arange(round(duration / step))
    found = solve_ivp(
        slope, (0, time[-1]), [begin, 0, 0], "Radau", time, rtol=1e-7, atol=[1e-9, 1e-8, 1e-11]
    )
    x, v, _ = found.y
    push = np.array([force(*one) for one in zip(time, x, v, strict=True)])
    first, second = cylinder.pressures(push, 5e5)
    return sensed(time, {"p1": first, "p2": second, "x": x}, sensors or Sensors(), seed)


def cylinder_of(bench):
    """The bench's dimensions."""
    return Cylinder(bench.bore, bench.rod_diameter, bench.growth, bench.plunger)


def without(sensors, **changes):
    """Sensors with changes."""
    return replace(sensors, **changes)
