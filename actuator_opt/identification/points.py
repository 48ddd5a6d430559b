"""Steady sliding: friction over speed and pressure, by plateaus or sweeps."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Literal, NamedTuple

import numpy as np

from ..numeric import Array
from .balance import Sliding
from .conditioning import Motion

STEADY, FLOOR = 0.04, 2e-5
"""A plateau keeps its speed within this share, or this speed [m/s]."""
LASTING = 0.15
"""Least time of a plateau [s]; its first and last fifth are left out."""
ALIKE = 0.06
"""Plateaus within this share of speed are one point."""
PER_DECADE = 8
"""Speeds per decade of a sweep's points."""
SETTLED = 5e-4
"""Distance after a reversal from which sliding is steady [m], ten usual breakaway travels."""
LEVELS = 0.1
"""Pressures within this share of the highest are one level."""

Kind = Literal["plateau", "sweep"]


class Point(NamedTuple):
    """Friction in steady sliding, signed as the velocity; SI.

    `error` is the standard error of the friction; `weight` the time behind it [s]; `pressure` the
    higher of both chambers, gauge.
    """

    velocity: float
    pressure: float
    pressure_1: float
    pressure_2: float
    friction: float
    error: float
    weight: float
    kind: Kind

    @property
    def speed(self) -> float:
        """Without direction [m/s]."""
        return abs(self.velocity)

    @property
    def damping(self) -> float:
        """Secant damping F/v [N s/m]."""
        return self.friction / self.velocity


def steady_points(slidings: Sequence[Sliding], motion: Motion) -> tuple[Point, ...]:
    """Points of steady sliding: of plateaus where they are, else of sweeps through the speeds.

    A record whose plateaus hold three speeds or most of the moving time is one of plateaus.

    Parameters
    ----------
    slidings : friction by piece
    motion : for the filter's memory

    Returns
    -------
    points in order of direction, pressure and speed
    """
    plateaus = [one for sliding in slidings for one in _plateaus(sliding, motion)]
    merged = _merged(plateaus)
    moving = sum(float(one.moving.sum()) for one in slidings) * motion.sample_time
    held = sum(one.weight for one in plateaus)
    speeds = {round(np.log(one.speed) / ALIKE) for one in merged}
    if merged and (len(speeds) >= 3 or held > 0.4 * moving):
        return _ordered(merged)
    return _ordered(_swept(slidings, motion)) or _ordered(merged)


def _ordered(points: Sequence[Point]) -> tuple[Point, ...]:
    return tuple(sorted(points, key=lambda one: (one.velocity < 0, one.pressure, one.speed)))


def independent(count: float, motion: Motion) -> float:
    """Independent samples among `count` filtered ones: 2 f_c per second."""
    return max(count * min(2 * motion.cutoff * motion.sample_time, 1.0), 1.0)


def _plateaus(sliding: Sliding, motion: Motion) -> Iterator[Point]:
    """Stretches of constant velocity in one piece."""
    from scipy.signal import savgol_filter

    step = motion.sample_time
    window = 2 * int(LASTING / (2 * step)) + 1
    if sliding.piece.time.size < 3 * window or window < 5:
        return
    velocity = savgol_filter(sliding.piece["x"], window, 1, deriv=1, delta=step)
    allowed = np.maximum(STEADY * np.abs(velocity), FLOOR)
    usable = sliding.piece.sound & (np.abs(velocity) > max(3 * FLOOR, sliding.resting / 10))
    least, stride = int(np.ceil(LASTING / step)), max(1, int(0.02 / step))
    i, count = 0, velocity.size
    while i + least <= count:
        head = slice(i, i + least)
        off = np.flatnonzero(~usable[head] | (np.abs(velocity[head] - velocity[i]) > allowed[i]))
        if off.size:
            i += max(stride, 1)
            continue
        out = ~usable[i:] | (np.abs(velocity[i:] - velocity[i]) > allowed[i])
        last = i + (int(np.argmax(out)) if out.any() else out.size)
        fifth = (last - i) // 5
        yield _point(sliding, motion, np.arange(i + fifth, last - fifth), "plateau")
        i = last


def _point(sliding: Sliding, motion: Motion, at: Array, kind: Kind) -> Point:
    """The mean over samples, with the standard error of filtered ones."""
    piece = sliding.piece
    friction = sliding.friction[at]
    if kind == "plateau":
        velocity = float(np.polyfit(piece.time[at] - piece.time[at[0]], piece["x"][at], 1)[0])
    else:
        velocity = float(np.mean(piece.velocity[at]))
    first = piece["p1"][at]
    second = piece["p2"][at] if "p2" in piece else np.zeros_like(first)
    size = independent(at.size, motion)
    return Point(
        velocity,
        float(np.mean(sliding.pressure[at])),
        float(np.mean(first)),
        float(np.mean(second)),
        float(np.mean(friction)),
        float(np.std(friction) / np.sqrt(max(size - 1, 1))),
        at.size * motion.sample_time,
        kind,
    )


def _merged(points: Sequence[Point]) -> list[Point]:
    """Points of like velocity and pressure as one, weighted by their time."""
    highest = max((one.pressure for one in points), default=0.0)
    groups: list[list[Point]] = []
    for one in sorted(points, key=lambda x: x.velocity):
        for group in groups:
            lead = group[0]
            like = abs(one.velocity / lead.velocity - 1) < ALIKE
            if like and abs(one.pressure - lead.pressure) <= LEVELS * highest:
                group.append(one)
                break
        else:
            groups.append([one])
    return [_mean(group) for group in groups]


def _mean(group: Sequence[Point]) -> Point:
    """One point of several of like velocity and pressure: scatter between them counts too."""
    if len(group) == 1:
        return group[0]
    weights = np.array([one.weight for one in group])
    share = weights / weights.sum()
    numbers = np.array([one[:5] for one in group])
    middle = share @ numbers
    within = np.sqrt(np.sum((share * np.array([one.error for one in group])) ** 2))
    apart = np.sqrt(
        np.sum(share**2 * (numbers[:, 4] - middle[4]) ** 2) * len(group) / (len(group) - 1)
    )
    error = float(max(within, apart))
    v, p, p1, p2, mean = map(float, middle)
    return Point(v, p, p1, p2, mean, error, float(weights.sum()), group[0].kind)


def _swept(slidings: Sequence[Sliding], motion: Motion) -> list[Point]:
    """Means over bins of velocity and pressure, rising and falling speed with equal weight.

    A bin passed one way only is left out: there a lag would count as friction.
    """
    parts = [_settled(one) for one in slidings]
    if not any(at.size for at in parts):
        return []

    def all_of(values: Sequence[Array]) -> Array:
        return np.concatenate([one[at] for one, at in zip(values, parts, strict=True)])

    pieces = [one.piece for one in slidings]
    velocity = all_of([one.velocity for one in pieces])
    rising = all_of([one.velocity * one.acceleration for one in pieces]) > 0
    friction = all_of([one.friction for one in slidings])
    pressure = all_of([one.pressure for one in slidings])
    first = all_of([one["p1"] for one in pieces])
    second = all_of([one["p2"] if "p2" in one else np.zeros(one.time.size) for one in pieces])
    speed_bin = np.floor(PER_DECADE * np.log10(np.abs(velocity)))
    top = float(np.percentile(pressure, 99)) or 1.0
    level_bin = np.floor(pressure / (2 * LEVELS * top))
    keys = np.stack([velocity < 0, level_bin, speed_bin, rising], axis=1)
    found, inverse = np.unique(keys, axis=0, return_inverse=True)
    halves: dict[tuple[float, ...], list[Point]] = {}
    for k, key in enumerate(found):
        at = np.flatnonzero(inverse.reshape(-1) == k)
        size = independent(at.size, motion)
        if size < 3:
            continue
        rest = friction[at] - np.polyval(np.polyfit(velocity[at], friction[at], 1), velocity[at])
        halves.setdefault(tuple(key[:3]), []).append(
            Point(
                float(np.mean(velocity[at])),
                float(np.mean(pressure[at])),
                float(np.mean(first[at])),
                float(np.mean(second[at])),
                float(np.mean(friction[at])),
                float(np.std(rest) / np.sqrt(max(size - 2, 1))),
                at.size * motion.sample_time,
                "sweep",
            )
        )
    return [_halves(both) for both in halves.values() if len(both) == 2]


def _halves(both: Sequence[Point]) -> Point:
    """Rising and falling speed as one point of equal weights: what lags cancels."""
    numbers = np.mean([one[:5] for one in both], axis=0)
    error = float(np.sqrt(sum(one.error**2 for one in both)) / 2)
    v, p, p1, p2, mean = map(float, numbers)
    return Point(v, p, p1, p2, mean, error, sum(one.weight for one in both), "sweep")


def _settled(sliding: Sliding) -> Array:
    """Samples that have slid `SETTLED` since the last reversal or rest."""
    piece, moving = sliding.piece, sliding.moving
    way = np.where(moving, np.sign(piece.velocity), 0.0)
    begins = np.flatnonzero(np.diff(way, prepend=0.0) != 0)
    start = np.zeros(way.size, dtype=int)
    start[begins] = begins
    start = np.maximum.accumulate(start)
    gone = np.abs(piece["x"] - piece["x"][start])
    return np.flatnonzero(moving & (gone > SETTLED))
