"""Sections ('windows') of a record around reversals, and the LuGre friction along them.

The LuGre model is integrated along each window. The friction that it gives is then filtered like
the record.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array
from ..models import friction
from .balance import Sliding
from .conditioning import SLOWEST, ConditionedRecord, velocities, zero_phase
from .points import SETTLED, settled

BEFORE, AFTER = 0.1, 0.4
"""Length of a window before and after the rod reverses or starts [s] (our choice: 26 independent
samples at 30 Hz, most of them after the reversal)."""
MOST = 24
"""Largest number of windows, spread over the record (our choice: twice as many take twice the time,
but only narrow the confidence intervals by 30 %)."""
LAG = 20e-3
"""Largest pressure lag that is searched for [s] (our choice: five times that of a usual sensor)."""
PER_PERIOD = 12
"""Smallest number of integration steps per period of the filter's cut-off (our choice: a method of
second order then has an error of (2 pi/12)^2/12 = 2 % at the cut-off frequency)."""
SAMPLES, LEFT = 2.0, 0.05
"""Number of independent samples that must lie within the travel in which the bristles deflect, and
share of that travel up to which the rod still counts as at rest (our choices)."""
LEAST = 4
"""Smallest number of independent samples in a window (our choice: one more than its three unknowns,
which are stiffness, lag and friction level)."""
GRAIN = 0.35
"""The finite resolution of the position causes an error, of which at least this share is assumed to
shift all reversals alike (our choice, from records of known friction). Divided by the breakaway
travel, this error is the relative error of the bristle stiffness; divided by the speed at the
reversal, it is the error of the lag."""
LASTING = 0.05
"""Shortest motion in one direction that counts [s] (our choice: three independent samples at 30
Hz)."""


@dataclass(frozen=True, slots=True, eq=False)
class Windows:
    """Sections of a record around reversals and starts, SI.

    Arrays have the shape (lanes, samples): each window is a row, called a lane.

    Parameters
    ----------
    velocity : velocity of the rod, which for each window is one of the `options`
    options : velocities at the cut-off of the record and at lower cut-offs (cut-offs, lanes,
        samples)
    turn : index of the sample at which the rod reverses or starts
    change : pressure, minus the reference pressure [Pa]
    hydraulic : hydraulic force; it has `margin` extra samples at both ends, so that it can be
        shifted in time
    resisting : sum of load and inertia force
    step : time between samples of a window [s]
    sections, reach : second-order sections of the record's filter for the time step `step`, and the
        number of mirrored samples that the filter adds at both ends
    kept : indices of the samples that are compared with the model: independent, not at the ends
    steady : weights (lanes, kept): 0 where points of steady sliding already give the same
        information, else 1
    judged : weights in use: as `steady`, but 0 in windows in which the rod is too fast for the
        filter to show the deflection of the bristles
    blur : time for which the position resolution q hides a reversal with acceleration a: sqrt(2
        q/a) [s]
    grain : position error due to resolution that shifts all reversals alike [m]
    noise : position error due to white sensor noise, independent in every reversal [m]
    sample_time : time between samples of the record, of which `step` is a multiple [s]
    quick : True if the rod is too fast in every window, so that none shows the bristles; all
        windows are then kept
    """

    velocity: Array
    options: Array
    turn: int
    change: Array
    hydraulic: Array
    resisting: Array
    step: float
    margin: int
    sections: Array
    reach: int
    kept: Array
    steady: Array
    judged: Array
    blur: float
    grain: float
    noise: float
    sample_time: float
    quick: bool = False

    @property
    def fastest(self) -> float:
        """Highest speed in the windows [m/s]."""
        return float(np.max(np.abs(self.velocity)))

    @property
    def largest(self) -> float:
        """Largest friction in the windows [N]."""
        return float(np.max(np.abs(self.measured(np.zeros(1))[..., self.kept])))

    def resolved(self, travel: float) -> Windows:
        """Ignore windows in which the rod covers `travel` in fewer than `SAMPLES` samples.

        Only independent samples count. In such fast motion, the filter blurs the deflection of the
        bristles. If the rod is that fast in every window, all windows are kept.
        """
        place = np.cumsum(self.velocity, axis=-1) * self.step
        distance = np.abs(place - place[:, self.turn, None])[:, self.turn :]
        within = np.cumprod(distance < travel, axis=-1)
        slow_samples = np.sum(within * (distance > LEFT * travel), axis=-1)
        slow = slow_samples >= SAMPLES * (self.kept[1] - self.kept[0])
        judged = self.steady * slow[:, None]
        return replace(self, judged=judged if slow.any() else self.steady, quick=not slow.any())

    def short(self, distance: float) -> Windows:
        """Lengthen the motion at each reversal by a distance [m] that the resolution may hide."""
        velocity = self.velocity.copy()
        way = np.sign(np.sum(velocity[:, self.turn :], axis=-1))
        velocity[:, self.turn] -= way * distance / self.step
        return replace(self, velocity=velocity)

    def measured(self, lag: Array) -> Array:
        """Measured friction, with the hydraulic force taken from a time `lag` later.

        An array of lags, (rows,), gives friction of shape (rows, lanes, samples), where each lane
        is a window. Values between samples are interpolated by cubic polynomials.
        """
        count = self.velocity.shape[-1]
        rows = []
        for value in np.atleast_1d(lag):
            whole = int(np.floor(value / self.step))
            fraction = value / self.step - whole
            weights = (
                -fraction * (fraction - 1) * (fraction - 2) / 6,
                (fraction + 1) * (fraction - 1) * (fraction - 2) / 2,
                -(fraction + 1) * fraction * (fraction - 2) / 2,
                (fraction + 1) * fraction * (fraction - 1) / 6,
            )
            first = self.margin + whole - 1
            rows.append(
                sum(
                    weight * self.hydraulic[:, first + k : first + k + count]
                    for k, weight in enumerate(weights)
                )
            )
        return np.stack(rows) - self.resisting

    def misfit(self, values: Mapping[str, Array]) -> Array:
        """Friction of the model minus measured friction at the samples in use.

        `values` are the parameters, each (rows,). The result has the shape (rows, lanes, kept):
        each lane is a window, and `kept` are the samples in use. The model's friction is filtered
        like the record.
        """
        measured = self.measured(values["lag"])
        model = self._integrated({n: v[:, None, None] for n, v in values.items()}, measured)
        smooth = zero_phase(self.sections, model, reach=self.reach)
        return (smooth - measured)[..., self.kept] * self.judged

    def chosen(self, values: Mapping[str, Array]) -> Windows:
        """Select for every window the velocity with which the model fits the friction best.

        In slow motion, the steps of the position sensor pass the filter and look like motion. A
        lower cut-off removes them, but blurs the start of a motion. The misfit of the friction
        shows which cut-off is better.
        """
        costs = [
            np.sum(replace(self, velocity=option).misfit(values)[0] ** 2, axis=-1)
            for option in self.options
        ]
        best = np.argmin(np.stack(costs), axis=0)
        return replace(self, velocity=self.options[best, np.arange(best.size)])

    def _integrated(self, values: Mapping[str, Array], measured: Array) -> Array:
        """LuGre friction along every window, in exact time steps as in `models.lugre.lugre_step`.

        At the start of a window, the bristles have the deflection that gives the measured friction.
        """
        between = (self.velocity[:, 1:] + self.velocity[:, :-1]) / 2
        change = (self.change[:, 1:] + self.change[:, :-1]) / 2
        level = friction.stribeck_level(
            speed=np.abs(between),
            coulomb=values["coulomb"],
            static=values["static"],
            stribeck_speed=values["stribeck_speed"],
            exponent=values["exponent"],
        )
        level = level * (1 + values["pressure_slope"] * change / values["coulomb"])
        stiffness, damping = values["bristle_stiffness"], values["bristle_damping"]
        viscous = values["viscous"] * self.velocity
        initial = (measured - values["offset"] - viscous)[..., :3].mean(axis=-1)
        first = np.clip(initial, -level[..., 0], level[..., 0]) / stiffness[..., 0]
        rate = stiffness * np.abs(between) / level
        decay = rate * self.step
        tail = np.exp(-decay)
        negligible = decay < 1e-9
        reach = np.where(negligible, 1.0, (1 - tail) / np.where(negligible, 1.0, decay)) * self.step
        retained, added = 1 - rate * reach, between * reach
        deflections = np.empty((*level.shape[:-1], self.velocity.shape[-1]))
        deflections[..., 0] = deflection = first
        for k in range(between.shape[-1]):
            deflections[..., k + 1] = deflection = retained[..., k] * deflection + added[..., k]
        slip = np.diff(deflections, axis=-1, append=deflections[..., -1:]) / self.step
        return stiffness * deflections + damping * slip + viscous + values["offset"]


def windows(
    slidings: Sequence[Sliding],
    motion: ConditionedRecord,
    reference: float,
    slowest: float = np.inf,
    settling: float = SETTLED,
) -> Windows | None:
    """Windows around the times at which the rod reverses or starts.

    If it never does, windows are spread over the record.

    Parameters
    ----------
    slidings, motion : friction along the record, and the conditioned record with its filter
    reference : reference pressure, which is subtracted from the pressures [Pa]
    slowest : lowest speed of the points of steady sliding, which are fitted besides the windows
        [m/s]. In the windows, steady sliding above this speed has no weight, because these points
        already cover it
    settling : distance after a reversal beyond which sliding is steady [m]

    Returns
    -------
    the windows; None if the record is too short for a window
    """
    stride = max(1, int(1 / (PER_PERIOD * motion.cutoff * motion.sample_time)))
    step = stride * motion.sample_time
    margin = int(np.ceil(LAG / step)) + 2
    before, after = round(BEFORE / step), round(AFTER / step)
    room = (before + margin) * stride, (after + margin) * stride
    lanes = _lanes(slidings, motion, room)
    kept = _independent_samples(motion, step, before + after)
    if not lanes or kept.size < LEAST:
        return None

    def cut(values: Sequence[Array], more: int = 0) -> Array:
        ends = (before + more) * stride, (after + more) * stride
        pairs = zip(values, lanes, strict=True)
        return np.stack([along[at - ends[0] : at + ends[1] : stride] for along, (_, at) in pairs])

    sections = {id(sliding): sliding for sliding, _ in lanes}
    masks = {key: _steady_above(sliding, slowest, settling) for key, sliding in sections.items()}
    steady = np.where(cut([masks[id(sliding)] for sliding, _ in lanes])[:, kept], 0.0, 1.0)
    first, last = before * stride, after * stride
    sets = [velocities(sliding.piece, motion, at - first, at + last) for sliding, at in lanes]
    options = np.stack([velocity[:, ::stride] for velocity in sets], axis=1)
    accelerations = np.abs(np.gradient(options[-1], step, axis=-1))
    sharpest = max(float(np.median(np.max(accelerations, axis=-1))), 1e-12)
    resolution = motion.quality["x"].resolution
    return Windows(
        velocity=options[0],
        options=options,
        turn=before,
        change=cut([sliding.pressure for sliding, _ in lanes]) - reference,
        hydraulic=cut([sliding.hydraulic for sliding, _ in lanes], margin),
        resisting=cut([sliding.resisting for sliding, _ in lanes]),
        step=step,
        margin=margin,
        sections=motion.sections(cutoff=motion.cutoff, sample_time=step),
        reach=round(3 / (motion.cutoff * step)),
        kept=kept,
        steady=steady,
        judged=steady,
        grain=_grain([sliding.piece["x"][at] for sliding, at in lanes], resolution),
        noise=motion.quality["x"].noise * float(np.sqrt(motion.band)),
        sample_time=motion.sample_time,
        blur=float(np.sqrt(2 * resolution / sharpest)),
    )


def _independent_samples(motion: ConditionedRecord, step: float, count: int) -> Array:
    """Indices of the independent samples of a window, without those at its ends."""
    edge = round(1 / (motion.cutoff * step))
    apart = max(1, round(1 / (2 * motion.cutoff * step)))
    return np.arange(edge, count - edge, apart)


def no_windows(motion: ConditionedRecord) -> str:
    """Reason why a record has no windows.

    A window of duration T has n = (T - 2/f) 2 f independent samples at the cut-off f, because the
    filter disturbs a time 1/f at each end, and 2 f samples per second are independent. The lowest
    usable cut-off is thus f = (n + 4)/2T with n = `LEAST`.
    """
    lowest = (LEAST + 4) / (2 * (BEFORE + AFTER))
    if motion.cutoff <= lowest:
        remedy = f"filter above {lowest:.2g} Hz (--cutoff)"
        if motion.sample_time * lowest * SLOWEST > 1:
            remedy = f"sample at {SLOWEST * lowest:.3g} Hz or faster, and {remedy}"
        return (
            f"no reversal can be used, because a cut-off of {motion.cutoff:.3g} Hz blurs the half "
            "second around a reversal, in which the deflection of the bristles shows; "
            f"{remedy}"
        )
    return (
        "the record has no uninterrupted half second around a reversal, in which the deflection "
        "of the bristles would show"
    )


def _grain(places: Sequence[float], step: float) -> float:
    """Position error that shifts all reversals alike, due to the resolution of the sensor [m].

    For n reversals, of which n_i lie on sensor step i, it is q/sqrt 12 sqrt(sum n_i^2)/n with the
    resolution q. The errors of different steps are independent [derived].
    """
    if step == 0:
        return 0.0
    counts = np.unique(np.round(np.array(places) / step), return_counts=True)[1]
    share = float(np.sqrt(np.sum(counts**2)) / len(places))
    return float(step / np.sqrt(12) * max(share, GRAIN))


def _lanes(
    slidings: Sequence[Sliding], motion: ConditionedRecord, room: tuple[int, int]
) -> list[tuple[Sliding, int]]:
    """For each window: its section of the record, and the sample of the reversal or start.

    If the rod never reverses or starts, the windows are spread evenly.
    """
    places = [
        (sliding, at)
        for sliding in slidings
        for at in _starts_of_motion(sliding, motion)
        if _fits(sliding, at, room)
    ]
    if not places:
        places = [
            (sliding, at)
            for sliding in slidings
            for at in range(room[0], sliding.piece.time.size, room[0] + room[1])
            if _fits(sliding, at, room)
        ]
    if not places:
        return []
    selected = np.linspace(0, len(places) - 1, min(MOST, len(places))).round().astype(int)
    return [places[k] for k in np.unique(selected)]


def _steady_above(sliding: Sliding, slowest: float, settling: float) -> Array:
    """Flags for samples of steady sliding that are faster than `slowest`."""
    mask = np.zeros(sliding.piece.time.size, dtype=bool)
    mask[settled(sliding, settling)] = True
    return mask & (np.abs(sliding.piece.velocity) >= slowest)


def _fits(sliding: Sliding, at: int, room: tuple[int, int]) -> bool:
    """Whether a window around the sample `at` lies within the usable part of its section.

    `room` has the number of samples before and after that sample.
    """
    first, last = at - room[0], at + room[1]
    sound = sliding.piece.sound
    return first >= 0 and last < sound.size and bool(sound[first] and sound[last])


def _starts_of_motion(sliding: Sliding, motion: ConditionedRecord) -> list[int]:
    """Samples at which a lasting motion begins, after a reversal or rest."""
    way = np.where(sliding.moving, np.sign(sliding.piece.velocity), 0.0)
    begins = np.flatnonzero((way != 0) & (np.diff(way, prepend=0.0) != 0))
    lasting = round(LASTING / motion.sample_time)
    starts: list[int] = []
    for at in map(int, begins):
        if np.all(way[at : at + lasting] == way[at]) and (not starts or at - starts[-1] > lasting):
            starts.append(at)
    return starts
