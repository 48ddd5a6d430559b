"""Windows about reversals, where bristles show, and the LuGre model integrated along them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..base.numeric import Array
from ..models import friction
from .balance import Sliding
from .conditioning import SLOWEST, Motion, low_pass, zero_phase
from .pace import velocities
from .points import SETTLED, settled

BEFORE, AFTER = 0.1, 0.4
"""Length of a window before and after the rod reverses or starts [s] (a choice: at 30 Hz 26
independent samples, most of them after the reversal)."""
MOST = 24
"""Maximum windows, spread over the record (a choice: twice as many cost twice the time for bounds
30 % narrower)."""
LAG = 20e-3
"""Largest pressure lag searched [s] (a choice: five times that of a usual sensor)."""
PER_PERIOD = 12
"""Least integration steps per period of the cut-off (a choice: a second-order step has an error of
(2 pi/12)^2/12 = 2 % at the cut-off itself)."""
SAMPLES, LEFT = 2.0, 0.05
"""Independent samples that a few breakaway travels must take, and their share that may still count
as rest (a choice)."""
LEAST = 4
"""Least independent samples of a window (a choice: one more than stiffness, lag and level)."""
GRAIN = 0.35
"""Least share of the position error due to resolution that shifts all reversals alike (a choice,
from records of known friction): over the breakaway travel it is an error of the bristles'
stiffness, over the speed there one of the lag."""
LASTING = 0.05
"""Least duration of motion in one direction [s] (a choice: three independent samples at 30 Hz)."""


@dataclass(frozen=True, slots=True, eq=False)
class Windows:
    """Sections of a record side by side, SI; arrays (lanes, samples).

    `hydraulic` has `margin` extra samples at both ends, so that it can be shifted in time. `kept`
    are the samples in use: independent ones, away from the ends. `blur` is the time for which the
    position resolution hides a reversal, sqrt(2 q/a) [s]. `options` (cut-offs, lanes, samples) are
    velocities at lower cut-offs of the position, `velocity` those selected; `turn` is the sample at
    which the rod reverses or starts. `steady` (lanes, kept) is 0 where points of steady sliding
    give the same information, else 1; `judged` is also 0 in windows left out, `quick` means that
    all should be left out. `grain` is the position error due to resolution that shifts all
    reversals alike [m], `noise` that due to white sensor noise, different in every reversal [m],
    `sample_time` that of the record [s].
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
        """Largest speed in the windows [m/s]."""
        return float(np.max(np.abs(self.velocity)))

    @property
    def largest(self) -> float:
        """Largest friction in the windows [N]."""
        return float(np.max(np.abs(self.measured(np.zeros(1))[..., self.kept])))

    def resolved(self, travel: float) -> Windows:
        """Drop windows in which the rod takes under `SAMPLES` for a distance after reversal.

        There the filter has blurred the motion that bends the bristles. Keeps all if none would be
        left.
        """
        place = np.cumsum(self.velocity, axis=-1) * self.step
        gone = np.abs(place - place[:, self.turn, None])[:, self.turn :]
        near = np.cumprod(gone < travel, axis=-1)
        taken = np.sum(near * (gone > LEFT * travel), axis=-1)
        slow = taken >= SAMPLES * (self.kept[1] - self.kept[0])
        judged = self.steady * slow[:, None]
        return replace(self, judged=judged if slow.any() else self.steady, quick=not slow.any())

    def short(self, distance: float) -> Windows:
        """Add a distance [m] missing at a reversal or start, hidden by the position resolution."""
        velocity = self.velocity.copy()
        way = np.sign(np.sum(velocity[:, self.turn :], axis=-1))
        velocity[:, self.turn] -= way * distance / self.step
        return replace(self, velocity=velocity)

    def measured(self, lag: Array) -> Array:
        """Friction with the hydraulic force shifted `lag` later (rows,) -> (rows, lanes, samples).

        Cubic interpolation between samples.
        """
        count = self.velocity.shape[-1]
        rows = []
        for one in np.atleast_1d(lag):
            whole = int(np.floor(one / self.step))
            part = one / self.step - whole
            weights = (
                -part * (part - 1) * (part - 2) / 6,
                (part + 1) * (part - 1) * (part - 2) / 2,
                -(part + 1) * part * (part - 2) / 2,
                (part + 1) * part * (part - 1) / 6,
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
        """Model friction less the measured one, at samples in use (rows, lanes, kept).

        Parameters (rows,). The model's friction passes the same filter as the record.
        """
        measured = self.measured(values["lag"])
        found = self._integrated({n: v[:, None, None] for n, v in values.items()}, measured)
        smooth = zero_phase(self.sections, found, reach=self.reach)
        return (smooth - measured)[..., self.kept] * self.judged

    def chosen(self, values: Mapping[str, Array]) -> Windows:
        """Select for every lane the velocity with which the model fits friction best.

        In slow motion the position resolution passes the record's filter and looks like motion,
        while at a start a lower cut-off blurs the motion. The friction shows which is better.
        """
        costs = [
            np.sum(replace(self, velocity=one).misfit(values)[0] ** 2, axis=-1)
            for one in self.options
        ]
        best = np.argmin(np.stack(costs), axis=0)
        return replace(self, velocity=self.options[best, np.arange(best.size)])

    def _integrated(self, values: Mapping[str, Array], measured: Array) -> Array:
        """LuGre friction along every window: the exact step of `models.lugre.lugre_step`.

        Each starts with the bristle deflection of the friction measured there.
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
        begun = (measured - values["offset"] - viscous)[..., :3].mean(axis=-1)
        first = np.clip(begun, -level[..., 0], level[..., 0]) / stiffness[..., 0]
        rate = stiffness * np.abs(between) / level
        decay = rate * self.step
        tail = np.exp(-decay)
        small = decay < 1e-9
        reach = np.where(small, 1.0, (1 - tail) / np.where(small, 1.0, decay)) * self.step
        kept, pushed = 1 - rate * reach, between * reach
        bent = np.empty((*level.shape[:-1], self.velocity.shape[-1]))
        bent[..., 0] = deflection = first
        for k in range(between.shape[-1]):
            bent[..., k + 1] = deflection = kept[..., k] * deflection + pushed[..., k]
        slip = np.diff(bent, axis=-1, append=bent[..., -1:]) / self.step
        return stiffness * bent + damping * slip + viscous + values["offset"]


def windows(
    slidings: Sequence[Sliding],
    motion: Motion,
    reference: float,
    slowest: float = np.inf,
    settling: float = SETTLED,
) -> Windows | None:
    """Windows where the rod reverses or starts; else spread over the record.

    Parameters
    ----------
    slidings, motion : friction along the record, and its filter
    reference : pressure from which changes are counted [Pa]
    slowest : speed above which points of steady sliding cover steady motion [m/s]
    settling : distance after a reversal from which sliding is steady [m]

    Returns
    -------
    the windows, or None if the record is too short for any
    """
    stride = max(1, int(1 / (PER_PERIOD * motion.cutoff * motion.sample_time)))
    step = stride * motion.sample_time
    margin = int(np.ceil(LAG / step)) + 2
    before, after = round(BEFORE / step), round(AFTER / step)
    room = (before + margin) * stride, (after + margin) * stride
    lanes = _lanes(slidings, motion, room)
    kept = _kept(motion, step, before + after)
    if not lanes or kept.size < LEAST:
        return None

    def cut(values: Sequence[Array], more: int = 0) -> Array:
        ends = (before + more) * stride, (after + more) * stride
        own = zip(values, lanes, strict=True)
        return np.stack([one[at - ends[0] : at + ends[1] : stride] for one, (_, at) in own])

    used = {id(one): one for one, _ in lanes}
    told = {key: _settled_above(one, slowest, settling) for key, one in used.items()}
    steady = np.where(cut([told[id(one)] for one, _ in lanes])[:, kept], 0.0, 1.0)
    span = (-before * stride, after * stride)
    paces = [velocities(one.piece, motion, at + span[0], at + span[1]) for one, at in lanes]
    options = np.stack([one[:, ::stride] for one in paces], axis=1)
    slopes = np.abs(np.gradient(options[-1], step, axis=-1))
    sharpest = max(float(np.median(np.max(slopes, axis=-1))), 1e-12)
    resolution = motion.quality["x"].resolution
    band = min(2 * motion.cutoff * motion.sample_time, 1.0)
    return Windows(
        velocity=options[0],
        options=options,
        turn=before,
        change=cut([one.pressure for one, _ in lanes]) - reference,
        hydraulic=cut([one.hydraulic for one, _ in lanes], margin),
        resisting=cut([one.resisting for one, _ in lanes]),
        step=step,
        margin=margin,
        sections=_sections(motion, step),
        reach=round(3 / (motion.cutoff * step)),
        kept=kept,
        steady=steady,
        judged=steady,
        grain=_grain([one.piece["x"][at] for one, at in lanes], resolution),
        noise=motion.quality["x"].noise * float(np.sqrt(band)),
        sample_time=motion.sample_time,
        blur=float(np.sqrt(2 * resolution / sharpest)),
    )


def _kept(motion: Motion, step: float, count: int) -> Array:
    """Independent samples of a window, away from its ends."""
    edge = round(1 / (motion.cutoff * step))
    apart = max(1, round(1 / (2 * motion.cutoff * step)))
    return np.arange(edge, count - edge, apart)


def no_windows(motion: Motion) -> str:
    """Why a record has no window: one has `LEAST` samples for (T - 2/f) 2 f = n, f = (n + 4)/2T.

    The filter affects the ends of a window, 1/f each; 2 f samples per second are independent.
    """
    lowest = (LEAST + 4) / (2 * (BEFORE + AFTER))
    if motion.cutoff <= lowest:
        remedy = f"filter above {lowest:.2g} Hz (--cutoff)"
        if motion.sample_time * lowest * SLOWEST > 1:
            remedy = f"sample at {SLOWEST * lowest:.3g} Hz or faster, and {remedy}"
        return (
            f"no windows at this cut-off: {motion.cutoff:.3g} Hz blur the half second about a "
            f"reversal in which bristles show; {remedy}"
        )
    return "no uninterrupted half second about a reversal, where bristles show"


def _grain(places: Sequence[float], step: float) -> float:
    """Position error due to resolution that shifts all reversals alike [m].

    q/sqrt 12 sqrt(sum n_i^2)/n of n reversals, n_i on one step: different steps are independent
    errors [derived].
    """
    if step == 0:
        return 0.0
    counts = np.unique(np.round(np.array(places) / step), return_counts=True)[1]
    share = float(np.sqrt(np.sum(counts**2)) / len(places))
    return float(step / np.sqrt(12) * max(share, GRAIN))


def _sections(motion: Motion, step: float) -> Array:
    """The record's filter at the windows' sampling."""
    return low_pass(
        cutoff=motion.cutoff, order=motion.order, sample_time=step, compensated=motion.compensated
    )


def _lanes(
    slidings: Sequence[Sliding], motion: Motion, room: tuple[int, int]
) -> list[tuple[Sliding, int]]:
    """Sections and samples of windows: reversals and starts, else spread over the record."""
    places = [(one, at) for one in slidings for at in _turns(one, motion) if _fits(one, at, room)]
    if not places:
        places = [
            (one, at)
            for one in slidings
            for at in range(room[0], one.piece.time.size, room[0] + room[1])
            if _fits(one, at, room)
        ]
    if not places:
        return []
    chosen = np.linspace(0, len(places) - 1, min(MOST, len(places))).round().astype(int)
    return [places[k] for k in np.unique(chosen)]


def _settled_above(sliding: Sliding, slowest: float, settling: float) -> Array:
    """Samples of steady sliding above a speed."""
    found = np.zeros(sliding.piece.time.size, dtype=bool)
    found[settled(sliding, settling)] = True
    return found & (np.abs(sliding.piece.velocity) >= slowest)


def _fits(sliding: Sliding, at: int, room: tuple[int, int]) -> bool:
    """Whether a window about a sample lies within the usable part of the section."""
    first, last = at - room[0], at + room[1]
    sound = sliding.piece.sound
    return first >= 0 and last < sound.size and bool(sound[first] and sound[last])


def _turns(sliding: Sliding, motion: Motion) -> list[int]:
    """Samples at which lasting sliding begins, after a reversal or rest."""
    way = np.where(sliding.moving, np.sign(sliding.piece.velocity), 0.0)
    begins = np.flatnonzero((way != 0) & (np.diff(way, prepend=0.0) != 0))
    lasting = round(LASTING / motion.sample_time)
    found: list[int] = []
    for at in map(int, begins):
        if np.all(way[at : at + lasting] == way[at]) and (not found or at - found[-1] > lasting):
            found.append(at)
    return found
