"""Straight part of force versus deflection in a bending test: loadings, unloadings and slopes."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import inf, isfinite
from typing import NamedTuple

import numpy as np

from ..base.fitting import quantile
from ..base.numeric import Array
from .cleaning import ROBUST
from .conditioning import ConditionedRecord
from .record import Record

TERMS = 8
"""Number of cosine terms from which the variance of correlated noise is estimated (our choice: so
few also suit noise that is correlated over an eighth of a loading; confidence intervals are then 18
% wider than if the noise were known)."""
PER_TERM = 4
"""Smallest number of degrees of freedom per cosine term (our choice: in short records, it limits
the length of the correlation that is taken into account)."""
MEMORY = 0.99
"""Largest correlation of neighbouring residuals that is taken into account (our choice: above it
the fit mistakes noise for a part of the slope)."""
FEWEST = 5
"""Smallest number of samples of a loading or unloading to which a slope is fitted (our choice:
three degrees of freedom)."""
OUTSTANDING, PART = 10.0, 0.02
"""Smallest height of a spike above the median of five neighbours: in robust standard deviations,
and as a share of the range (our choices: far outside noise; smaller spikes do not change a
slope)."""

SHARES = (0.2, 0.8)
"""Shares of the largest deflection between which the slope is fitted if the test does not reach the
strains of the standards or the depth is unknown (our choice: leaves out the toe and the reversal at
the top)."""
BENT = 0.02
"""Largest change of slope along the straight part (our choice: the chord is then within 1 % of the
tangents at both ends)."""
FOLLOWS = 0.3
"""Smallest permitted correlation of force and deflection (our choice: the correlation is still 0.46
if the press does not touch the specimen in the first 90 % of the record)."""
TOP, BEGUN = 0.9, 0.05
"""Shares of the highest force. A loading ends at the last sample above the first share, because
what follows is slip or failure. The search for zero force begins at the second share (our choices:
both differ from the highest force and from zero by more than usual noise)."""
BACK = 0.25
"""Share of its range by which the deflection must return to count as an unloading. A specimen
counts as bent in both directions if at least this share of the range lies on each side of zero (our
choices: more than noise and offsets)."""
WON = 0.02
"""Due to noise and coarse samples, a specimen may seem to return more work on unloading than
loading took. This is the largest permitted excess, as a share of the work (our choice, as
`BENT`)."""
USUAL = (1e-12, 1e12)
"""Smallest and largest permitted span between the lowest and the highest force [N], or deflection
[m] (our choice: far beyond any sensor and machine)."""
CUTS = ((0.0, 1.0), (0.25, 1.0), (0.0, 0.75), (0.5, 1.0), (0.25, 0.75), (0.0, 0.5))
"""Parts of the range that are tested in turn until a part is straight (our choice: the longest part
first; parts without the toe before parts without the top)."""


class DeflectionBranch(NamedTuple):
    """Samples between two reversals of the deflection: a loading or an unloading."""

    samples: slice
    loading: bool


class Term(NamedTuple):
    """A polynomial coefficient, with its variance and its degrees of freedom."""

    value: float
    variance: float
    freedom: float


def despiked(values: Array) -> Array:
    """A channel with single outliers set to NaN."""
    from scipy.ndimage import maximum_filter1d, median_filter  # slow import, rarely used

    known = np.isfinite(values)
    known_values = values[known]
    if known_values.size < FEWEST:
        return values
    middle = median_filter(known_values, size=5, mode="mirror")
    deviations = np.abs(known_values - middle)
    low, high = np.percentile(middle, (1, 99))
    least = max(OUTSTANDING * ROBUST * float(np.median(deviations)), PART * float(high - low))
    # the median is inaccurate where the channel reverses or ends
    passing = 2 * maximum_filter1d(np.abs(np.gradient(middle)), 5)
    cleaned = np.array(values, dtype=float)
    cleaned[known] = np.where(deviations > least + passing, np.nan, known_values)
    return cleaned


def branches(deflection: Array, least: float) -> list[DeflectionBranch]:
    """Loadings and unloadings, divided where the deflection returns by `least` or more."""
    values = deflection.tolist()
    turns: list[int] = []
    low = high = way = 0
    for k, value in enumerate(values):
        low = k if value < values[low] else low
        high = k if value > values[high] else high
        if way >= 0 and values[high] - value >= least:
            turns.append(high)
            way, low = -1, k
        elif way <= 0 and value - values[low] >= least:
            turns.append(low)
            way, high = 1, k
    turns.append(high if way > 0 else low)
    return [
        DeflectionBranch(slice(first, end + 1), values[end] > values[first])
        for first, end in pairwise(turns)
        if abs(values[end] - values[first]) >= least
    ]


def term(x: Array, y: Array, degree: int) -> Term:
    """Coefficient of x^degree in a least-squares polynomial, for correlated noise.

    The variance of the coefficient is the spectral density, at frequency zero, of the products c e.
    Here c is the column x^degree made orthogonal to lower powers, and e are the residuals. The
    density is estimated by projecting the products onto the lowest cosines along the samples
    [Mueller2007], [Lazarus2018]. Each cosine is a degree of freedom of Student's t. As the fit
    itself removes some variance, the estimate is increased by the share that the fit would remove
    from noise with the correlation of the residuals [derived]. The result is at least the variance
    for white noise.
    """
    scale = float(np.ptp(x)) / 2
    size = (x - np.mean(x)) / scale
    basis, _ = np.linalg.qr(np.vander(size, degree + 1, increasing=True))
    column = basis[:, -1]
    along = float(column @ size**degree)
    residuals = y - basis @ (basis.T @ y)
    count = x.size
    terms = int(np.clip((count - degree - 1) // PER_TERM, 1, TERMS))
    phase = np.pi * (np.arange(count) + 0.5) / count
    waves = np.cos(np.arange(1, terms + 1)[:, None] * phase) * column
    free = waves - (waves @ basis) @ basis.T
    memory = _correlation(residuals, degree)
    seen = np.sum(free * _correlated(free, memory), axis=1)
    meant = float(column @ _correlated(column, memory))
    level = meant * float(np.mean((waves @ residuals) ** 2 / seen))
    white = float(np.sum(residuals**2)) / (count - degree - 1)
    unit = along * scale**degree
    return Term(float(column @ y) / unit, max(level, white) / unit**2, terms)


def _correlation(residuals: Array, degree: int) -> float:
    """Correlation of neighbouring residuals, corrected for the effect of fitting a polynomial.

    For n samples whose neighbours have the correlation r, fitting a constant lowers r by (1 + 3
    r)/n, and fitting a line by (2 + 4 r)/n [MarriottPope1954]. For higher degrees, the series is
    continued.
    """
    size, power = residuals.size, float(np.sum(residuals**2))
    seen = float(residuals[1:] @ residuals[:-1]) / power if power > 0 else 0.0
    spare = max(size - degree - 3, 1)
    return float(np.clip((seen * size + degree + 1) / spare, 0.0, MEMORY))


def _correlated(rows: Array, memory: float) -> Array:
    """The rows, multiplied by the correlation matrix with the elements memory^|i - j|."""
    from scipy.signal import lfilter  # slow import, rarely used

    ahead = lfilter([1.0], [1.0, -memory], rows, axis=-1)
    back = lfilter([1.0], [1.0, -memory], rows[..., ::-1], axis=-1)[..., ::-1]
    return ahead + back - rows


def mean(terms: Sequence[Term]) -> Term:
    """Mean of independent coefficients, with degrees of freedom by Satterthwaite's formula."""
    variances = np.array([term.variance for term in terms]) / len(terms) ** 2
    variance = float(np.sum(variances))
    parts = float(np.sum(variances**2 / [term.freedom for term in terms]))
    freedom = variance**2 / parts if parts > 0 else min(term.freedom for term in terms)
    return Term(float(np.mean([term.value for term in terms])), variance, freedom)


def pooled(groups: Sequence[Sequence[Term]]) -> Term:
    """Mean of the means of several groups, such as the slopes of loadings and of unloadings.

    If the members of the groups scatter by more than their own variances explain, by an F test at
    95 %, their scatter increases the variance of the result. Members with the same index in their
    groups, such as loading and unloading of a cycle, count as correlated.
    """
    from scipy.special import fdtri  # slow import, rarely used

    overall = mean([mean(group) for group in groups])
    spare = sum(len(group) - 1 for group in groups)
    if spare == 0 or overall.variance == 0:
        return overall
    middles = [(member, mean(group).value) for group in groups for member in group]
    squares = [(member.value - middle) ** 2 / member.variance for member, middle in middles]
    freedom = sum(member.freedom for member, _ in middles)
    if sum(squares) / spare <= fdtri(spare, freedom, 0.95):
        return overall
    several = [[member.value for member in group] for group in groups if len(group) > 1]
    between = float(np.mean([np.var(values, ddof=1) / len(values) for values in several]))
    return Term(overall.value, max(between, overall.variance), max(map(len, several)) - 1)


class Part(NamedTuple):
    """The samples of one loading or unloading that lie in the straight part."""

    deflection: Array
    force: Array
    loading: bool


class Straight(NamedTuple):
    """The straight part of a record.

    Parameters
    ----------
    parts : samples of each loading and unloading that lie in the straight part
    ends : deflections at both ends of the straight part, counted from zero force [m]
    bent : change of slope along the straight part, divided by the slope
    unsure : absolute value of `bent` minus the part that noise can cause; 0 if noise can cause all
    cut : whether the straight part is only a part of the searched range
    """

    parts: list[Part]
    ends: tuple[float, float]
    bent: float
    unsure: float
    cut: bool


class Loop:
    """Force versus deflection, divided into branches: loadings and unloadings."""

    def __init__(self, record: Record) -> None:
        self.record = record
        self.deflection, self.force, self.floor, self.both = _oriented(*_channels(record))
        self.least = BACK * float(np.ptp(self.deflection))
        self.branches = [self._intact(branch) for branch in branches(self.deflection, self.least)]

    def _intact(self, branch: DeflectionBranch) -> DeflectionBranch:
        """A loading branch up to its highest force, after which slip or failure follows."""
        if not branch.loading:
            return branch
        first, force = branch.samples.start, self.force[branch.samples]
        most = float(np.max(force))
        high = most - (1 - TOP) * abs(most - self.floor)
        return DeflectionBranch(
            slice(first, first + int(np.flatnonzero(force >= high)[-1]) + 1), True
        )

    def cut(self, low: float, high: float, zeros: Sequence[float]) -> list[Part]:
        """Samples of every branch between two deflections, counted from the branch's zero force.

        `zeros` are the deflections at which the branches meet zero force.
        """
        parts = []
        for zero, (samples, loading) in zip(zeros, self.branches, strict=True):
            w, force = self.deflection[samples], self.force[samples]
            inside = (w - zero >= low) & (w - zero <= high)
            parts.append(Part(w[inside], force[inside], loading))
        return parts

    def begins(self) -> list[float]:
        """Deflection of every branch at which its force is the share `BEGUN` of its highest."""
        deflections = []
        for samples, _ in self.branches:
            force = self.force[samples] - self.floor
            at = int(np.argmin(np.abs(force - BEGUN * np.max(force))))
            deflections.append(float(self.deflection[samples][at]))
        return deflections

    def zeros(self, parts: Sequence[Part]) -> list[float]:
        """Deflection of every branch at which its straight line meets zero force."""
        slope = slopes(parts, 1, self.record).value
        if slope <= 0:
            message = "F_L does not increase with w in the straight part"
            raise self.record.fault(message, "check both columns, and their noise")
        return [
            float(np.mean(part.deflection) - (np.mean(part.force) - self.floor) / slope)
            if part.deflection.size
            else inf
            for part in parts
        ]

    def top(self, zeros: Sequence[float]) -> float:
        """Largest deflection, counted from zero force: median of those of all branches."""
        tops = [float(np.max(self.deflection[branch.samples])) for branch in self.branches]
        return float(np.median([a - b for a, b in zip(tops, zeros, strict=True) if isfinite(b)]))

    def hysteresis(self) -> float | None:
        """Work lost divided by work done on loading, mean of all loops; None if not available.

        A loop is a loading with the next unloading, or else an unloading with the next loading,
        over the deflections that both cover. The work lost is the integral of F dw around the loop,
        with force F and deflection w; the work done is the positive part of that integral.
        """
        pairs, shares = list(pairwise(self.branches)), []
        for both in [pair for pair in pairs if pair[0].loading] or pairs:
            passes = [self.deflection[branch.samples] for branch in both]
            ends = max(np.min(w) for w in passes), min(np.max(w) for w in passes)
            lost = supplied = 0.0
            for w, (samples, loading) in zip(passes, both, strict=True):
                force, sign = self.force[samples] - self.floor, 1.0 if loading else -1.0
                common = np.clip(w, *ends)
                lost += float(np.trapezoid(force, common))
                supplied += float(np.trapezoid(np.maximum(sign * force, 0), sign * common))
            if supplied > 0:
                shares.append(lost / supplied)
        share = float(np.mean(shares)) if shares else -inf
        return max(share, 0.0) if share >= -WON else None


def slopes(parts: Sequence[Part], degree: int, record: Record) -> Term:
    """Coefficient of x^degree in force versus deflection: mean of loading and unloading.

    A polynomial is fitted to each loading and unloading on its own.
    """
    groups = by_way(parts, degree)
    if not groups:
        most = max((part.deflection.size for part in parts), default=0)
        message = f"only {most} samples in the straight part of the longest loading"
        remedy = "sample faster, load slower, or check noise and units of the channels"
        raise record.fault(f"{message}, {FEWEST} are needed", remedy)
    return pooled(list(groups.values()))


def by_way(parts: Sequence[Part], degree: int) -> dict[bool, list[Term]]:
    """Coefficients of x^degree of all branches, by direction: True for loading, else False."""
    groups: dict[bool, list[Term]] = {}
    for part in parts:
        if part.deflection.size >= FEWEST and np.unique(part.deflection).size > degree + 1:
            groups.setdefault(part.loading, []).append(term(part.deflection, part.force, degree))
    return groups


def scatter(parts: Sequence[Part]) -> float:
    """Scatter 1 - r^2 of force versus deflection, for the branch that scatters least.

    r is the correlation. The scatter is the relative difference between the slopes of two
    regressions, of force on deflection and of deflection on force. If only the deflection is noisy,
    the noise lowers the slope by this share [derived].
    """
    shares = [
        1 - float(np.corrcoef(part.deflection, part.force)[0, 1]) ** 2
        for part in parts
        if part.deflection.size >= FEWEST and np.ptp(part.force) > 0
    ]
    return min(shares, default=0.0)


@np.errstate(over="ignore", invalid="ignore")  # an overflow is rejected as an unusual range
def _channels(record: Record) -> tuple[Array, Array]:
    """Deflection and force of the samples that have both."""
    for name in ("F_L", "w"):
        if name not in record:
            message = f"no column {name}, the {'deflection' if name == 'w' else 'force'}"
            raise record.fault(message, f'name it with --column "{name}=..."')
    w, force = despiked(record["w"]), despiked(record["F_L"])
    both = np.isfinite(w) & np.isfinite(force)
    if both.sum() < 2 * FEWEST:
        message = f"{both.sum()} samples with force and deflection, {2 * FEWEST} are needed"
        raise record.fault(message, "give a record of the whole loading")
    w, force = w[both], force[both]
    for values, name in ((w, "w"), (force, "F_L")):
        reach = float(np.ptp(values))
        if reach == 0:
            message = f"{name} is constant except for single samples"
            raise record.fault(message, "give a record of a loaded specimen")
        if not USUAL[0] <= reach <= USUAL[1]:
            message = f"{name} spans {reach:.3g} {'m' if name == 'w' else 'N'}"
            raise record.fault(
                f"{message}, which is implausible for a bending test", "check its unit"
            )
    most = int(np.argmax(np.abs(force - force[0]))) + 1  # only samples before a failure
    most = most if most >= 2 * FEWEST else w.size
    follows = float(np.corrcoef(w[:most], force[:most])[0, 1]) if np.ptp(w[:most]) else 0.0
    if follows <= -FOLLOWS:
        remedy = "reverse the sign of F_L or w: both must increase as the specimen is bent"
        raise record.fault("F_L decreases as w increases", remedy)
    if follows < FOLLOWS:
        message = f"F_L does not follow w (correlation {follows:.2f})"
        raise record.fault(message, "check both columns")
    return w, force


def _oriented(w: Array, force: Array) -> tuple[Array, Array, float, bool]:
    """Deflection and force, increasing with bending.

    Also returns the reading of the force channel for the unloaded specimen, and whether the
    specimen is bent in both directions.

    Whatever the offsets, the specimen is taken to be unloaded at the start of the record. The
    exception is a record of a single unloading. A specimen bent in both directions is unloaded
    where both channels are zero at the same time, or else at the start.
    """

    def inside(values: Array, value: float) -> bool:
        distance = min(np.max(values) - value, value - np.min(values))
        return bool(distance > BACK * np.ptp(values))

    first, last = float(force[0]), float(force[np.argmax(np.abs(force - force[0]))])
    order = np.argsort(w)
    at_zero = float(np.interp(0.0, w[order], force[order]))
    common_zero = inside(w, 0.0) and abs(at_zero) <= BENT * np.ptp(force)
    bent_both_ways = inside(force, 0.0) and (inside(force, first) or common_zero)
    single = len(branches(w, BACK * float(np.ptp(w)))) == 1
    unloading = single and not bent_both_ways and abs(last) < abs(first)
    if bool(w[0] - np.min(w) > np.max(w) - w[0]) != unloading:
        w, force, first = -w, -force, -first
    force_at_rest = float(np.percentile(force, 1))
    if bent_both_ways:
        force_at_rest = 0.0 if common_zero else first
    elif unloading and force_at_rest > BEGUN * np.max(force):
        force_at_rest = 0.0  # never unloaded
    return w, force, force_at_rest, bent_both_ways


def straight(loop: Loop, zeros: Sequence[float], low: float, high: float) -> Straight:
    """Find the longest of some parts of a range in which the slope is constant.

    The parts are listed in `CUTS`. If the slope is constant in none, the result is the whole range.
    """
    straights: list[Straight] = []
    for first, last in CUTS:
        ends = low + first * (high - low), low + last * (high - low)
        parts = loop.cut(*ends, zeros)
        if straights and not all(by_way(parts, 2).get(part.loading) for part in parts):
            break
        slope, curve = slopes(parts, 1, loop.record), slopes(parts, 2, loop.record)
        if straights and slope.value <= 0:
            break
        new_zeros = loop.zeros(parts)
        length = ends[1] - ends[0]
        bent = 2 * length * curve.value / slope.value
        half = quantile(curve.freedom) * float(np.sqrt(curve.variance))
        beyond = max(abs(bent) - abs(2 * length * half / slope.value), 0.0)
        pairs = zip(zeros, new_zeros, strict=True)
        shift = float(np.median([old - new for old, new in pairs if isfinite(new)]))
        from_zero = (ends[0] + shift, ends[1] + shift)
        candidate = Straight(parts, from_zero, bent, beyond, (first, last) != CUTS[0])
        if abs(bent) <= BENT or beyond == 0:
            return candidate
        straights.append(candidate)
    return straights[0]


SHARE = 0.999
"""Share of the velocity's power that counts as motion (our choice: the rest is 3 % of the
velocity's amplitude)."""
ABOVE = 4.0
"""Multiple of the noise above which the spectrum of the velocity shows motion (our choice: white
noise exceeds it in one of 55 lines of a single periodogram, but hardly ever in the mean of
many)."""


class Spectrum(NamedTuple):
    """Frequencies that describe a record [Hz].

    Parameters
    ----------
    motion : frequency below which 99.9 % of the velocity's power lies
    floor : frequency above which the position is only noise; 0 if there is none
    kept : share of the velocity's power that passes the filter
    """

    motion: float
    floor: float
    kept: float

    def says(self, cutoff: float) -> str:
        """One-line judgement of a cut-off [Hz] for the record."""
        if self.motion == 0:
            return "the position shows no motion above its noise"
        if self.motion > cutoff:
            return (
                f"the motion reaches {self.motion:.3g} Hz, above the cut-off, so fast motion is "
                "lost: raise --cutoff"
            )
        if 0 < self.floor < cutoff:
            return (
                f"99.9 % of the motion lies below {self.motion:.3g} Hz, only noise lies above "
                f"{self.floor:.3g} Hz; a cut-off between them reduces noise and loses no motion"
            )
        return f"99.9 % of the motion lies below {self.motion:.3g} Hz, within the cut-off"


def spectrum(record: Record, motion: ConditionedRecord) -> Spectrum:
    """Frequencies at which motion ends and noise begins, by Welch's method on the longest section.

    The spectrum of motion is that of the velocity, minus that which white noise of the position
    adds to it. At a frequency f, the noise adds (2 sin(pi f dt)/dt)^2 times a constant level, with
    the time step dt. The level is taken from the upper half of the band.

    Parameters
    ----------
    record : raw record
    motion : conditioned record
    """
    from scipy.signal import welch  # slow import, rarely used

    step, noise = motion.sample_time, motion.quality["x"].noise
    piece = max(motion.pieces, key=lambda section: section.time.size)
    known = np.isfinite(record["x"])
    raw = np.interp(piece.time, record.time[known], record["x"][known])
    spike = np.abs(raw - piece["x"]) > 6 * noise
    position = np.where(spike, piece["x"], raw)
    frequency, power = welch(
        np.diff(position) / step, fs=1 / step, nperseg=min(position.size - 1, round(4 / step))
    )
    slope = (2 * np.sin(np.pi * frequency * step) / step) ** 2
    upper = frequency > 0.25 / step
    level = float(np.median(power[upper] / slope[upper]))
    variance = max(level * 0.5 / step, motion.quality["x"].resolution ** 2 / 12)
    loud = (power > ABOVE * level * slope) & (frequency > 0)
    clear = np.where(loud & _moves(frequency, power, slope, loud, variance), power, 0.0)
    clear = np.maximum(clear - level * slope, 0.0)
    total = np.cumsum(clear)
    if np.sum(clear[1:] / slope[1:]) * frequency[1] <= variance:
        return Spectrum(0.0, 0.0, 1.0)
    edge = float(frequency[int(np.searchsorted(total, SHARE * total[-1]))])
    drowned = np.flatnonzero((clear == 0) & (frequency > edge))
    floor = float(frequency[drowned[0]]) if drowned.size else 0.0
    kept = float(np.sum(clear[frequency <= motion.cutoff]) / total[-1])
    return Spectrum(edge, floor, kept)


def _moves(frequency: Array, power: Array, slope: Array, loud: Array, variance: float) -> Array:
    """Flags for frequencies at which the excess over white noise is motion.

    A sensor with the step q causes a spectral line at the frequency v/q for the speed v. The power
    of the line in the position is at most q^2/(2 pi^2), which is less than the variance q^2/12 of
    the steps. Beyond the peak of the motion, a line therefore counts as motion only if its power
    exceeds that variance.
    """
    place = np.where(loud, power / np.where(slope > 0, slope, 1.0), 0.0)
    peak = int(np.argmax(place))
    quiet = np.flatnonzero(~loud[peak:])
    foot = peak + (int(quiet[0]) if quiet.size else loud.size)
    return (np.arange(loud.size) < foot) | (place * frequency[1] > variance)
