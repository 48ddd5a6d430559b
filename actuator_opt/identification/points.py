"""Points of steady sliding, from plateaus or sweeps of speed: friction at a speed and pressure."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Literal, NamedTuple

import numpy as np

from ..base.numeric import Array
from .balance import Sliding
from .conditioning import ConditionedRecord, velocities

STEADY, FLOOR = 0.04, 2e-5
"""Permitted change of speed within a plateau: the share `STEADY` of the speed or `FLOOR` [m/s],
whichever is larger (our choices: viscous friction changes by at most that share; 2e-5 m/s is two
sensor steps of 10 um in a second)."""
LASTING = 0.15
"""Shortest plateau [s]. The first and last fifth of a plateau are excluded. Samples within the
settling distance from its start are excluded too, if enough others remain (our choices: five
independent samples remain at 30 Hz; the filter blurs the adjacent ramps into the excluded
fifths)."""
ALIKE = 0.06
"""Relative difference of speed within which plateaus are merged into one point (our choice: more
than `STEADY`, less than the steps between the speeds of a test)."""
PER_DECADE = 8
"""Number of points per decade of speed in a sweep (our choice: neighbouring speeds then differ by a
third, so that several points lie in the decade in which the Stribeck part drops)."""
BLURRED = 1.0
"""Time at each end of a plateau in which the filter mixes plateau and adjacent ramp, in periods of
the cut-off (our choice: after this time, a step response is within 2 % of its final value)."""
SETTLED = 5e-4
"""Distance after a reversal beyond which sliding is steady [m] (our choice: ten breakaway travels
of 50 um). If the breakaway travel of the record is known, the distance is `SETTLING` times that
travel, but at least this value."""
SLIDES = 2e-4
"""Smallest travel of a plateau [m] (our choice: four breakaway travels of 50 um; a smaller travel
may be elastic deflection of the contact)."""
SETTLING = 8.0
"""Number of breakaway travels F_S/sigma_0 after which sliding is steady (our choice: after a
reversal, friction is then within 2 e^-8, less than 0.1 %, of its final value)."""
LEVELS = 0.1
"""Range within which pressures count as equal, as a share of the highest pressure (our choice: less
than the steps between the loads of a test, more than friction alone changes the pressures)."""
PRIOR = 8
"""The scatter of a point is averaged with the usual scatter of the record, which counts as this
number of independent samples (our choice: some points only have four of their own)."""

Kind = Literal["plateau", "sweep"]


class FrictionPoint(NamedTuple):
    """Friction in steady sliding, with the sign of the velocity; SI.

    `error` is the standard error of the friction, `weight` the duration [s], `pressure` the higher
    chamber pressure (gauge). `spread` is the standard deviation of the velocities in a point of a
    sweep. It is needed because, where the curve bends, the mean friction is not the friction at the
    mean velocity.
    """

    velocity: float
    pressure: float
    pressure_1: float
    pressure_2: float
    friction: float
    error: float
    weight: float
    kind: Kind
    spread: float = 0.0

    @property
    def speed(self) -> float:
        """Absolute value of the velocity [m/s]."""
        return abs(self.velocity)

    @property
    def damping(self) -> float:
        """Secant damping F/v [N s/m]."""
        return self.friction / self.velocity


def steady_points(
    slidings: Sequence[Sliding], motion: ConditionedRecord, settling: float = SETTLED
) -> tuple[FrictionPoint, ...]:
    """Points of steady sliding: from plateaus of constant speed, or else from sweeps of speed.

    Plateaus are used if they have at least three speeds or last more than 40 % of the moving time,
    or if the record has no usable sweeps.

    Parameters
    ----------
    slidings : friction of each section
    motion : the conditioned record with its filter
    settling : distance after a reversal beyond which sliding is steady [m]

    Returns
    -------
    points, ordered by direction, pressure and speed
    """
    pairs = [pair for sliding in slidings for pair in _plateaus(sliding, motion, settling)]
    moderated = _moderated([point for point, _ in pairs], motion)
    plateaus = [
        point._replace(error=float(np.hypot(point.error, remainder)))
        for point, (_, remainder) in zip(moderated, pairs, strict=True)
    ]
    merged = _merged(plateaus)
    moving = sum(float(sliding.moving.sum()) for sliding in slidings) * motion.sample_time
    constant = sum(point.weight for point in plateaus)
    speeds = {round(np.log(point.speed) / ALIKE) for point in merged}
    if merged and (len(speeds) >= 3 or constant > 0.4 * moving):
        return _ordered(merged)
    return _ordered(_swept(slidings, motion, settling)) or _ordered(merged)


def _ordered(points: Sequence[FrictionPoint]) -> tuple[FrictionPoint, ...]:
    return tuple(
        sorted(points, key=lambda point: (point.velocity < 0, point.pressure, point.speed))
    )


def independent(count: float, motion: ConditionedRecord) -> float:
    """Number of independent samples among `count` filtered samples: 2 f_c per second."""
    return max(count * motion.band, 1.0)


def _moderated(points: Sequence[FrictionPoint], motion: ConditionedRecord) -> list[FrictionPoint]:
    """The points, with their scatter moved towards the median scatter of all points.

    The scatter of few samples is unreliable. The variance of a point becomes s^2 = (n_0 s_0^2 + n
    s_i^2)/(n_0 + n), with its own variance s_i^2 and number of samples n, the median variance
    s_0^2, and n_0 = `PRIOR` [Smyth2004].
    """
    if not points:
        return []
    count = np.array([max(2 * motion.cutoff * point.weight - 1, 1.0) for point in points])
    variance = np.array([point.error for point in points]) ** 2 * count
    variance = (PRIOR * np.median(variance) + count * variance) / (PRIOR + count)
    errors = np.sqrt(variance / count)
    return [point._replace(error=float(error)) for point, error in zip(points, errors, strict=True)]


def _plateaus(
    sliding: Sliding, motion: ConditionedRecord, settling: float
) -> Iterator[tuple[FrictionPoint, float]]:
    """Points from plateaus of constant velocity, each with its error due to pre-sliding [N]."""
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
        if np.any(~usable[head] | (np.abs(velocity[head] - velocity[i]) > allowed[i])):
            i += stride
            continue
        out = ~usable[i:] | (np.abs(velocity[i:] - velocity[i]) > allowed[i])
        last = i + (int(np.argmax(out)) if out.any() else out.size)
        if abs(sliding.piece["x"][last - 1] - sliding.piece["x"][i]) < SLIDES:
            i = last
            continue
        edge = max((last - i) // 5, int(np.ceil(BLURRED / (motion.cutoff * step))))
        end = last - edge
        if end - i - edge < least // 2:
            i = last
            continue
        steady = i + round(settling / (abs(float(velocity[i])) * step))
        at = np.arange(max(i + edge, min(steady, end - least // 2)), end)
        point = _point(sliding, motion, at, "plateau")
        travel = sliding.piece["x"][at] - sliding.piece["x"][i]
        yield point, _unsettled(point.friction, travel, settling)
        i = last


def _unsettled(friction: float, distance: Array, settling: float) -> float:
    """Possible error of a plateau's mean friction F, if bristles still reverse at its start [N].

    The error is 2 F times the mean of e^(-8 d/settling), where d is the distance from the start of
    the plateau. After a reversal friction is F (1 - 2 e^(-d sigma_0/F)) [derived from dz/dt = v (1
    - sigma_0 z/F)], and the settling distance is `SETTLING` = 8 times F/sigma_0.
    """
    return float(2 * abs(friction) * np.mean(np.exp(-SETTLING * np.abs(distance) / settling)))


def _point(sliding: Sliding, motion: ConditionedRecord, at: Array, kind: Kind) -> FrictionPoint:
    """Point of steady sliding from the samples `at`.

    The standard error of its friction allows for the correlation that the filter causes.
    """
    piece = sliding.piece
    friction = sliding.friction[at]
    if kind == "plateau":
        velocity = float(np.polyfit(piece.time[at] - piece.time[at[0]], piece["x"][at], 1)[0])
    else:
        velocity = float(np.mean(piece.velocity[at]))
    first, second = piece.pressures
    size = independent(at.size, motion)
    return FrictionPoint(
        velocity,
        float(np.mean(sliding.pressure[at])),
        float(np.mean(first[at])),
        float(np.mean(second[at])),
        float(np.mean(friction)),
        float(np.std(friction) / np.sqrt(max(size - 1, 1))),
        at.size * motion.sample_time,
        kind,
    )


def _merged(points: Sequence[FrictionPoint]) -> list[FrictionPoint]:
    """Merge points of similar velocity and pressure, weighted by their duration."""
    highest = max((point.pressure for point in points), default=0.0)
    groups: list[list[FrictionPoint]] = []
    for point in sorted(points, key=lambda x: x.velocity):
        for group in groups:
            first = group[0]
            alike = abs(point.velocity / first.velocity - 1) < ALIKE
            if alike and abs(point.pressure - first.pressure) <= LEVELS * highest:
                group.append(point)
                break
        else:
            groups.append([point])
    return [_mean(group) for group in groups]


def _mean(group: Sequence[FrictionPoint]) -> FrictionPoint:
    """Mean of points of similar velocity and pressure; its error includes their scatter."""
    if len(group) == 1:
        return group[0]
    weights = np.array([point.weight for point in group])
    share = weights / weights.sum()
    numbers = np.array([point[:5] for point in group])
    middle = share @ numbers
    within = np.sqrt(np.sum((share * np.array([point.error for point in group])) ** 2))
    between = np.sqrt(
        np.sum(share**2 * (numbers[:, 4] - middle[4]) ** 2) * len(group) / (len(group) - 1)
    )
    error = float(max(within, between))
    v, p, p1, p2, mean = map(float, middle)
    return FrictionPoint(v, p, p1, p2, mean, error, float(weights.sum()), group[0].kind)


def _swept(
    slidings: Sequence[Sliding], motion: ConditionedRecord, settling: float
) -> list[FrictionPoint]:
    """Points from sweeps: means over ranges of velocity and pressure.

    Samples with rising and with falling speed have equal weight in a mean.

    A range of velocity that occurs only with rising or only with falling speed is left out, because
    there a lag would look like friction. The velocity is filtered at the lowest cut-off that does
    not change the motion, because the resolution of the position would otherwise blur slow ranges.
    """
    parts = [settled(sliding, settling) for sliding in slidings]
    if not any(at.size for at in parts):
        return []

    def all_of(values: Sequence[Array]) -> Array:
        return np.concatenate([value[at] for value, at in zip(values, parts, strict=True)])

    pieces = [sliding.piece for sliding in slidings]
    paces = [velocities(piece, motion, 0, piece.time.size)[-1] for piece in pieces]
    velocity = all_of(paces)
    rising = all_of([pace * np.gradient(pace) for pace in paces]) > 0
    friction = all_of([sliding.friction for sliding in slidings])
    pressure = all_of([sliding.pressure for sliding in slidings])
    first = all_of([piece.pressures[0] for piece in pieces])
    second = all_of([piece.pressures[1] for piece in pieces])
    speed_bin = np.floor(PER_DECADE * np.log10(np.abs(velocity)))
    top = float(np.percentile(pressure, 99)) or 1.0
    level_bin = np.floor(pressure / (2 * LEVELS * top))
    keys = np.stack([velocity < 0, level_bin, speed_bin], axis=1)
    bins, inverse = np.unique(keys, axis=0, return_inverse=True)
    order = np.argsort(inverse.reshape(-1), kind="stable")
    groups = np.split(order, np.cumsum(np.bincount(inverse.reshape(-1)))[:-1])
    points: list[FrictionPoint] = []
    for at in groups[: len(bins)]:
        halves = _common_speeds(at, np.abs(velocity[at]), rising[at])
        if halves is None or min(independent(half.size, motion) for half in halves) < 3:
            continue
        for half in halves:
            size = independent(half.size, motion)
            line = np.polyfit(velocity[half], friction[half], 1)
            residuals = friction[half] - np.polyval(line, velocity[half])
            channels = (velocity, pressure, first, second, friction)
            v, p, p1, p2, mean = (float(np.mean(channel[half])) for channel in channels)
            points.append(
                FrictionPoint(
                    v,
                    p,
                    p1,
                    p2,
                    mean,
                    float(np.std(residuals) / np.sqrt(max(size - 2, 1))),
                    half.size * motion.sample_time,
                    "sweep",
                    float(np.std(velocity[half])),
                )
            )
    moderated = _moderated(points, motion)
    return [_balanced(both) for both in zip(moderated[::2], moderated[1::2], strict=True)]


def _common_speeds(at: Array, speed: Array, rising: Array) -> tuple[Array, Array] | None:
    """Samples of rising and of falling speed, limited to the range of speed that both cover."""
    if rising.all() or not rising.any():
        return None
    low = max(float(speed[rising].min()), float(speed[~rising].min()))
    high = min(float(speed[rising].max()), float(speed[~rising].max()))
    inside = (speed >= low) & (speed <= high)
    return at[inside & rising], at[inside & ~rising]


def _balanced(halves: Sequence[FrictionPoint]) -> FrictionPoint:
    """Mean of the points of rising and falling speed with equal weights, so that a lag cancels.

    A lag cancels to first order only, so a quarter of the difference between rising and falling
    speed counts as a further error (our choice).
    """
    numbers = np.mean([point[:5] for point in halves], axis=0)
    by_lag = (halves[0].friction - halves[1].friction) / 4
    error = float(np.sqrt(sum(point.error**2 for point in halves) / 4 + by_lag**2))
    v, p, p1, p2, mean = map(float, numbers)
    between = (halves[0].velocity - halves[1].velocity) / 2
    spread = float(np.sqrt((halves[0].spread ** 2 + halves[1].spread ** 2) / 2 + between**2))
    weight = sum(point.weight for point in halves)
    return FrictionPoint(v, p, p1, p2, mean, error, weight, "sweep", spread)


def settled(sliding: Sliding, settling: float = SETTLED) -> Array:
    """Indices of moving samples more than `settling` [m] after the last reversal or rest."""
    piece, moving = sliding.piece, sliding.moving
    way = np.where(moving, np.sign(piece.velocity), 0.0)
    begins = np.flatnonzero(np.diff(way, prepend=0.0) != 0)
    start = np.zeros(way.size, dtype=int)
    start[begins] = begins
    start = np.maximum.accumulate(start)
    distance = np.abs(piece["x"] - piece["x"][start])
    return np.flatnonzero(moving & (distance > settling))


def by_pressure(points: Sequence[FrictionPoint]) -> list[list[FrictionPoint]]:
    """Groups of points with about equal pressure, the lowest pressure first.

    The pressures in a group differ by at most `LEVELS` times the highest pressure.
    """
    highest = max((point.pressure for point in points), default=0.0)
    groups: list[list[FrictionPoint]] = []
    for point in sorted(points, key=lambda point: point.pressure):
        if groups and point.pressure - groups[-1][0].pressure <= LEVELS * highest:
            groups[-1].append(point)
        else:
            groups.append([point])
    return groups
