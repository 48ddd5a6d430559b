"""Straight parts of a loading test: branches of loading and unloading, slopes with bounds."""

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
"""Cosines of a long-run variance (a choice: few enough for noise correlated over an eighth of a
branch, at the price of bounds 18 % wider than those of known noise)."""
PER_TERM = 4
"""Least spare samples per cosine (a choice: the longest correlation in short records)."""
MEMORY = 0.99
"""Largest correlation of neighbouring residuals allowed for (a choice: beyond it the fit takes the
noise for part of the slope)."""
FEWEST = 5
"""Least samples of a branch for a slope (a choice: three spare)."""
OUTSTANDING, PART = 10.0, 0.02
"""A spike exceeds five neighbours' median by so many robust standard deviations and by this share
of the range (a choice: far outside noise, well inside what would move a slope)."""

SHARES = (0.2, 0.8)
"""Shares of the highest force for the slope if the test does not reach the strains or the depth is
unknown (a choice: the toe and the reversal at the top lie outside)."""
BENT = 0.02
"""Allowed change of slope along the straight part (a choice: the chord is then within 1 % of the
tangents at both ends)."""
FOLLOWS = 0.3
"""Least correlation of force and deflection (a choice: 90 % of approach leave 0.46)."""
TOP, BEGUN = 0.9, 0.05
"""Shares of the highest force: data after the last of the first is slip or failure; the second is
where the search for zero begins (a choice: both beyond usual noise)."""
BACK = 0.25
"""Share of a range that a return must cover to be an unloading, and that lies on either side of
zero for a specimen bent both ways (a choice: both far from noise and from offsets)."""
WON = 0.02
"""Share of its work that a loop may gain by noise and coarse samples (a choice as `BENT`)."""
USUAL = (1e-12, 1e12)
"""Largest ranges of force [N] and deflection [m] of any sensor and machine (a choice: far
beyond)."""
CUTS = ((0.0, 1.0), (0.25, 1.0), (0.0, 0.75), (0.5, 1.0), (0.25, 0.75), (0.0, 0.5))
"""Parts of the range tried in turn until one is straight (a choice: the longest first, cutting the
toe before the top)."""


class DeflectionBranch(NamedTuple):
    """Samples between two reversals of the deflection."""

    samples: slice
    loading: bool


class Term(NamedTuple):
    """A polynomial coefficient with its variance and degrees of freedom."""

    value: float
    variance: float
    freedom: float


def despiked(values: Array) -> Array:
    """A channel with single outliers set to NaN."""
    from scipy.ndimage import maximum_filter1d, median_filter  # slow import, rarely used

    known = np.isfinite(values)
    kept = values[known]
    if kept.size < FEWEST:
        return values
    middle = median_filter(kept, size=5, mode="mirror")
    apart = np.abs(kept - middle)
    low, high = np.percentile(middle, (1, 99))
    least = max(OUTSTANDING * ROBUST * float(np.median(apart)), PART * float(high - low))
    # the median lags where the channel reverses or ends
    passing = 2 * maximum_filter1d(np.abs(np.gradient(middle)), 5)
    out = np.array(values, dtype=float)
    out[known] = np.where(apart > least + passing, np.nan, kept)
    return out


def branches(deflection: Array, least: float) -> list[DeflectionBranch]:
    """Sections between reversals after which the deflection returns by `least` or more."""
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
    """Coefficient of x^degree of a least-squares polynomial, with correlated noise.

    The variance is that of the scores c e (c the column orthogonal to lower powers, e the
    residuals) at frequency zero, as the mean over the first cosines of the samples in order
    [Mueller2007], [Lazarus2018]. Student's t has a degree of freedom for each. The loss by the fit
    is compensated for noise with the residuals' correlation [derived]; the variance is at least
    that of white noise.
    """
    scale = float(np.ptp(x)) / 2
    size = (x - np.mean(x)) / scale
    basis, _ = np.linalg.qr(np.vander(size, degree + 1, increasing=True))
    column = basis[:, -1]
    along = float(column @ size**degree)
    rest = y - basis @ (basis.T @ y)
    count = x.size
    terms = int(np.clip((count - degree - 1) // PER_TERM, 1, TERMS))
    phase = np.pi * (np.arange(count) + 0.5) / count
    waves = np.cos(np.arange(1, terms + 1)[:, None] * phase) * column
    free = waves - (waves @ basis) @ basis.T
    memory = _memory(rest, degree)
    seen = np.sum(free * _remembered(free, memory), axis=1)
    meant = float(column @ _remembered(column, memory))
    level = meant * float(np.mean((waves @ rest) ** 2 / seen))
    white = float(np.sum(rest**2)) / (count - degree - 1)
    unit = along * scale**degree
    return Term(float(column @ y) / unit, max(level, white) / unit**2, terms)


def _memory(rest: Array, degree: int) -> float:
    """Correlation of neighbouring residuals, corrected for the loss by a polynomial's fit.

    A constant takes (1 + 3 r)/n, a trend (2 + 4 r)/n [MarriottPope1954]; so on by degree.
    """
    size, whole = rest.size, float(np.sum(rest**2))
    seen = float(rest[1:] @ rest[:-1]) / whole if whole > 0 else 0.0
    spare = max(size - degree - 3, 1)
    return float(np.clip((seen * size + degree + 1) / spare, 0.0, MEMORY))


def _remembered(rows: Array, memory: float) -> Array:
    """Rows times the correlations memory^|i - j|."""
    from scipy.signal import lfilter  # slow import, rarely used

    ahead = lfilter([1.0], [1.0, -memory], rows, axis=-1)
    back = lfilter([1.0], [1.0, -memory], rows[..., ::-1], axis=-1)[..., ::-1]
    return ahead + back - rows


def mean(terms: Sequence[Term]) -> Term:
    """Mean of independent coefficients; degrees of freedom after Satterthwaite."""
    variances = np.array([one.variance for one in terms]) / len(terms) ** 2
    whole = float(np.sum(variances))
    parts = float(np.sum(variances**2 / [one.freedom for one in terms]))
    freedom = whole**2 / parts if parts > 0 else min(one.freedom for one in terms)
    return Term(float(np.mean([one.value for one in terms])), whole, freedom)


def pooled(groups: Sequence[Sequence[Term]]) -> Term:
    """Mean of the means of groups; includes scatter of members beyond their noise.

    Beyond means by the F test at 95 %. Members with the same index in their groups, loading and
    unloading of a cycle, are taken as correlated.
    """
    from scipy.special import fdtri  # slow import, rarely used

    found = mean([mean(group) for group in groups])
    spare = sum(len(group) - 1 for group in groups)
    if spare == 0 or found.variance == 0:
        return found
    middles = [(one, mean(group).value) for group in groups for one in group]
    ratio = sum((one.value - middle) ** 2 / one.variance for one, middle in middles) / spare
    if ratio <= fdtri(spare, sum(one.freedom for group in groups for one in group), 0.95):
        return found
    several = [[one.value for one in group] for group in groups if len(group) > 1]
    between = float(np.mean([np.var(one, ddof=1) / len(one) for one in several]))
    return Term(found.value, max(between, found.variance), max(len(one) for one in several) - 1)


class Part(NamedTuple):
    """Samples of one branch in the straight part."""

    deflection: Array
    force: Array
    loading: bool


class Straight(NamedTuple):
    """The straight part.

    Its samples, its ends as deflections from zero force [m], the change of slope along it relative
    to the slope, the part of that beyond noise, and whether part of the range was left out.
    """

    parts: list[Part]
    ends: tuple[float, float]
    bent: float
    unsure: float
    cut: bool


class Loop:
    """Force over deflection by branches."""

    def __init__(self, record: Record) -> None:
        self.record = record
        self.deflection, self.force, self.floor, self.both = _turned(*_channels(record))
        self.least = BACK * float(np.ptp(self.deflection))
        self.branches = [self._kept(branch) for branch in branches(self.deflection, self.least)]

    def _kept(self, branch: DeflectionBranch) -> DeflectionBranch:
        """A loading branch up to its highest force; slip or failure follows."""
        if not branch.loading:
            return branch
        first, force = branch.samples.start, self.force[branch.samples]
        most = float(np.max(force))
        high = most - (1 - TOP) * abs(most - self.floor)
        return DeflectionBranch(
            slice(first, first + int(np.flatnonzero(force >= high)[-1]) + 1), True
        )

    def cut(self, low: float, high: float, zeros: Sequence[float]) -> list[Part]:
        """Samples of every branch between two deflections from its zero."""
        parts = []
        for zero, (samples, loading) in zip(zeros, self.branches, strict=True):
            w, force = self.deflection[samples], self.force[samples]
            inside = (w - zero >= low) & (w - zero <= high)
            parts.append(Part(w[inside], force[inside], loading))
        return parts

    def begins(self) -> list[float]:
        """Deflection at which the force of every branch is `BEGUN` of its highest."""
        found = []
        for samples, _ in self.branches:
            force = self.force[samples] - self.floor
            at = int(np.argmin(np.abs(force - BEGUN * np.max(force))))
            found.append(float(self.deflection[samples][at]))
        return found

    def zeros(self, parts: Sequence[Part]) -> list[float]:
        """Deflection at which the straight line of every branch meets zero force."""
        slope = slopes(parts, 1, self.record).value
        if slope <= 0:
            message = "F_L does not grow with w in the straight part"
            raise self.record.fault(message, "check both columns, and their noise")
        return [
            float(np.mean(part.deflection) - (np.mean(part.force) - self.floor) / slope)
            if part.deflection.size
            else inf
            for part in parts
        ]

    def top(self, zeros: Sequence[float]) -> float:
        """Largest deflection from zero, median of the branches."""
        tops = [float(np.max(self.deflection[branch.samples])) for branch in self.branches]
        return float(np.median([a - b for a, b in zip(tops, zeros, strict=True) if isfinite(b)]))

    def hysteresis(self) -> float | None:
        """Work lost over work done on loading, mean of the loops; None if not available.

        From an unloading after a loading, or a reloading, over the deflections that both cover: the
        integral of F dw around the loop over that of F dw above zero.
        """
        pairs, shares = list(pairwise(self.branches)), []
        for both in [pair for pair in pairs if pair[0].loading] or pairs:
            passes = [self.deflection[one.samples] for one in both]
            ends = max(np.min(w) for w in passes), min(np.max(w) for w in passes)
            lost = done = 0.0
            for w, (samples, loading) in zip(passes, both, strict=True):
                force, way = self.force[samples] - self.floor, 1.0 if loading else -1.0
                lost += float(np.trapezoid(force, np.clip(w, *ends)))
                done += float(np.trapezoid(np.maximum(way * force, 0), way * np.clip(w, *ends)))
            if done > 0:
                shares.append(lost / done)
        share = float(np.mean(shares)) if shares else -inf
        return max(share, 0.0) if share >= -WON else None


def slopes(parts: Sequence[Part], degree: int, record: Record) -> Term:
    """Coefficient of a degree, mean of loading and unloading; every branch has its own offsets."""
    groups = by_way(parts, degree)
    if not groups:
        most = max((part.deflection.size for part in parts), default=0)
        message = f"{most} samples in the straight part of the longest loading"
        remedy = "sample faster, load slower, or check noise and units of the channels"
        raise record.fault(f"{message}, {FEWEST} are needed", remedy)
    return pooled(list(groups.values()))


def by_way(parts: Sequence[Part], degree: int) -> dict[bool, list[Term]]:
    """Coefficients of the branches, by direction of loading."""
    groups: dict[bool, list[Term]] = {}
    for part in parts:
        if part.deflection.size >= FEWEST and np.unique(part.deflection).size > degree + 1:
            groups.setdefault(part.loading, []).append(term(part.deflection, part.force, degree))
    return groups


def scatter(parts: Sequence[Part]) -> float:
    """Least 1 - r^2 of force over deflection of the branches: difference between both regressions.

    Noise of the deflection alone lowers the slope by this share [derived].
    """
    found = [
        1 - float(np.corrcoef(part.deflection, part.force)[0, 1]) ** 2
        for part in parts
        if part.deflection.size >= FEWEST and np.ptp(part.force) > 0
    ]
    return min(found, default=0.0)


@np.errstate(over="ignore", invalid="ignore")  # an overflow is rejected as an unusual range
def _channels(record: Record) -> tuple[Array, Array]:
    """Deflection and force of complete samples, with one sign convention."""
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
            message = f"{name} is constant, except for single samples"
            raise record.fault(message, "give a record of a loaded specimen")
        if not USUAL[0] <= reach <= USUAL[1]:
            message = f"{name} spans {reach:.3g} {'m' if name == 'w' else 'N'}"
            raise record.fault(f"{message}, which no bending test reaches", "check its unit")
    most = int(np.argmax(np.abs(force - force[0]))) + 1  # before a failure
    most = most if most >= 2 * FEWEST else w.size
    follows = float(np.corrcoef(w[:most], force[:most])[0, 1]) if np.ptp(w[:most]) else 0.0
    if follows <= -FOLLOWS:
        remedy = "reverse the sign of F_L or w: both increase as the specimen is bent"
        raise record.fault("F_L decreases as w increases", remedy)
    if follows < FOLLOWS:
        message = f"F_L does not follow w (correlation {follows:.2f})"
        raise record.fault(message, "check both columns")
    return w, force


def _turned(w: Array, force: Array) -> tuple[Array, Array, float, bool]:
    """Deflection and force increasing with bending, the force at rest; whether bent both ways.

    It is at rest at the start, whatever the offsets, except for a single pass towards zero force
    (unloading). Bent both ways it is at rest where both channels are zero at once, else at the
    start.
    """

    def inside(values: Array, one: float) -> bool:
        room = min(np.max(values) - one, one - np.min(values))
        return bool(room > BACK * np.ptp(values))

    first, last = float(force[0]), float(force[np.argmax(np.abs(force - force[0]))])
    at_zero = float(np.interp(0.0, *(one[np.argsort(w)] for one in (w, force))))
    between = inside(w, 0.0) and abs(at_zero) <= BENT * np.ptp(force)
    both = inside(force, 0.0) and (inside(force, first) or between)
    single = len(branches(w, BACK * float(np.ptp(w)))) == 1
    eased = single and not both and abs(last) < abs(first)
    if bool(w[0] - np.min(w) > np.max(w) - w[0]) != eased:
        w, force, first = -w, -force, -first
    rest = float(np.percentile(force, 1))
    if both:
        rest = 0.0 if between else first
    elif eased and rest > BEGUN * np.max(force):
        rest = 0.0  # never unloaded
    return w, force, rest, both


def straight(loop: Loop, zeros: Sequence[float], low: float, high: float) -> Straight:
    """The longest part of a range with constant slope, else the whole range."""
    straights: list[Straight] = []
    for first, last in CUTS:
        ends = low + first * (high - low), low + last * (high - low)
        parts = loop.cut(*ends, zeros)
        if straights and not all(by_way(parts, 2).get(part.loading) for part in parts):
            break
        slope, curve = slopes(parts, 1, loop.record), slopes(parts, 2, loop.record)
        if straights and slope.value <= 0:
            break
        new = loop.zeros(parts)
        length = ends[1] - ends[0]
        bent = 2 * length * curve.value / slope.value
        half = quantile(curve.freedom) * float(np.sqrt(curve.variance))
        beyond = max(abs(bent) - abs(2 * length * half / slope.value), 0.0)
        moved = float(np.median([a - b for a, b in zip(zeros, new, strict=True) if isfinite(b)]))
        whole = (ends[0] + moved, ends[1] + moved)
        one = Straight(parts, whole, bent, beyond, (first, last) != CUTS[0])
        if abs(bent) <= BENT or beyond == 0:
            return one
        straights.append(one)
    return straights[0]


SHARE = 0.999
"""Share of the velocity's power that counts as motion (a choice: the rest then has 3 % of the
velocity)."""
ABOVE = 4.0
"""Multiple of its noise at which the velocity's spectrum shows motion (a choice: white noise
reaches it in one of 55 lines of a single periodogram, hardly ever in the mean of many)."""


class Spectrum(NamedTuple):
    """Frequencies of a record [Hz].

    Parameters
    ----------
    motion : 99.9 % of the velocity's power lies below
    floor : above the motion, the position's spectrum is noise from here on; 0 if it never is
    kept : share of the velocity's power that passes the filter
    """

    motion: float
    floor: float
    kept: float

    def says(self, cutoff: float) -> str:
        """Judge a cut-off [Hz] for the record, in one line."""
        if self.motion == 0:
            return "the position shows no motion above its noise"
        if self.motion > cutoff:
            return (
                f"the motion reaches {self.motion:.3g} Hz, above the cut-off: raise --cutoff, or "
                "fast motion is lost"
            )
        if 0 < self.floor < cutoff:
            return (
                f"99.9 % of the motion lies below {self.motion:.3g} Hz, and the position is "
                f"noise above {self.floor:.3g} Hz: a cut-off between them loses nothing and "
                "reduces noise"
            )
        return f"99.9 % of the motion lies below {self.motion:.3g} Hz, within the cut-off"


def spectrum(record: Record, motion: ConditionedRecord) -> Spectrum:
    """Frequencies at which motion ends and noise begins, by Welch's method on the longest section.

    Uses the velocity's spectrum less that of white noise of the position, (2 sin(pi f dt)/dt)^2
    times a level from the upper half of the band.

    Parameters
    ----------
    record : raw
    motion : conditioned

    Returns
    -------
    the frequencies
    """
    from scipy.signal import welch  # slow import, rarely used

    step, noise = motion.sample_time, motion.quality["x"].noise
    piece = max(motion.pieces, key=lambda one: one.time.size)
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
    """Frequencies at which the excess over white noise is motion.

    A sensor step q causes lines at v/q with up to q^2/(2 pi^2) of the position's power, less than
    their variance q^2/12. Beyond the motion's own peak a line must exceed that to count.
    """
    place = np.where(loud, power / np.where(slope > 0, slope, 1.0), 0.0)
    peak = int(np.argmax(place))
    quiet = np.flatnonzero(~loud[peak:])
    foot = peak + (int(quiet[0]) if quiet.size else loud.size)
    return (np.arange(loud.size) < foot) | (place * frequency[1] > variance)
