"""Windows about reversals: where bristles show, and the LuGre model integrated along them."""

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
"""Time of a window before and after the rod turns or starts [s] (a choice: at 30 Hz 26 independent
samples, most of them after the turn)."""
MOST = 24
"""Windows looked at, spread over the record (a choice: twice as many cost twice the time for bounds
30 % narrower)."""
LAG = 20e-3
"""Largest lag of the pressures looked for [s] (a choice: five times that of a usual sensor)."""
PER_PERIOD = 12
"""Steps of the integration per period of the cut-off, at least (a choice: a second-order step errs
by (2 pi/12)^2/12 = 2 % at the cut-off itself)."""
SAMPLES, LEFT = 2.0, 0.05
"""Independent samples that a rod must take for a few breakaway travels, and their share that may
still count as rest (a choice)."""
LEAST = 4
"""Independent samples of a window, at least (a choice: one more than stiffness, lag and level)."""
GRAIN = 0.35
"""Least share of the position's error by its steps that shifts all turns alike (a choice, by
records of known friction): over the breakaway travel it is an error of the bristles' stiffness,
over the speed there one of the lag."""
LASTING = 0.05
"""Time for which a way must last to be one [s] (a choice: three independent samples at 30 Hz)."""


@dataclass(frozen=True, slots=True, eq=False)
class Windows:
    """Stretches of a record side by side, SI; arrays (lanes, samples).

    `hydraulic` has `margin` samples more at both ends, so that it can be shifted in time; `kept`
    are the samples that are judged: independent ones, away from the ends. `blur` is the time by
    which the steps of the position sensor hide a turn, sqrt(2 q/a) [s]. `options` (cut-offs, lanes,
    samples) are velocities by lower cut-offs of the position, `velocity` the ones taken; `turn` is
    the sample at which the rod turns or starts. `steady`
    (lanes, kept) is 0 where points of steady sliding say the same, else 1; `judged` is 0 also in
    windows that are left out, `quick` says that all should be; `grain` is the error of the
    position by its steps that shifts all turns alike [m], `noise` its error by white noise of the
    sensor, another in every turn [m], `sample_time` that of the record [s].
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
        """Without windows in which the rod takes less than `SAMPLES` for a distance from its turn.

        There the filter has blurred the motion that bends the bristles. All, where none is left.
        """
        place = np.cumsum(self.velocity, axis=-1) * self.step
        gone = np.abs(place - place[:, self.turn, None])[:, self.turn :]
        near = np.cumprod(gone < travel, axis=-1)
        taken = np.sum(near * (gone > LEFT * travel), axis=-1)
        slow = taken >= SAMPLES * (self.kept[1] - self.kept[0])
        judged = self.steady * slow[:, None]
        return replace(self, judged=judged if slow.any() else self.steady, quick=not slow.any())

    def short(self, distance: float) -> Windows:
        """With a turn or start that lacks a distance [m], as a position sensor's step hides it."""
        velocity = self.velocity.copy()
        way = np.sign(np.sum(velocity[:, self.turn :], axis=-1))
        velocity[:, self.turn] -= way * distance / self.step
        return replace(self, velocity=velocity)

    def measured(self, lag: Array) -> Array:
        """Friction with the hydraulic force taken `lag` later (rows,) -> (rows, lanes, samples).

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
        """Friction of the model less the measured, at judged samples (rows, lanes, kept).

        Parameters (rows,). The model's friction passes the filter that the record has passed.
        """
        measured = self.measured(values["lag"])
        found = self._integrated({n: v[:, None, None] for n, v in values.items()}, measured)
        smooth = zero_phase(self.sections, found, reach=self.reach)
        return (smooth - measured)[..., self.kept] * self.judged

    def chosen(self, values: Mapping[str, Array]) -> Windows:
        """With the velocity in every lane under which the model follows the friction best.

        In slow motion the steps of the position sensor pass the record's filter and look like
        motion, at a start a lower cut-off blurs the motion: the friction tells which.
        """
        costs = [
            np.sum(replace(self, velocity=one).misfit(values)[0] ** 2, axis=-1)
            for one in self.options
        ]
        best = np.argmin(np.stack(costs), axis=0)
        return replace(self, velocity=self.options[best, np.arange(best.size)])

    def _integrated(self, values: Mapping[str, Array], measured: Array) -> Array:
        """LuGre friction along every window: the exact step of `models.lugre.lugre_step`.

        Each begins with the bristles as bent as the friction measured there says.
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
    """Windows about moments at which the rod turns or starts; else spread over the record.

    Parameters
    ----------
    slidings, motion : friction along the record, and how it was filtered
    reference : pressure from which changes are counted [Pa]
    slowest : speed from which points of steady sliding say what settled sliding says [m/s]
    settling : distance after a reversal from which sliding is steady [m]

    Returns
    -------
    the windows, None where the record has no room for one
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
    """Why a record has no window: one holds `LEAST` samples for (T - 2/f) 2 f = n, f = (n + 4)/2T.

    The ends of a window, 1/f each, are the filter's; 2 f samples per second are independent.
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
    return "no half second of an unbroken record about a reversal: bristles show only there"


def _grain(places: Sequence[float], step: float) -> float:
    """Error of the position by its steps that shifts all turns alike [m].

    q/sqrt 12 sqrt(sum n_i^2)/n of n turns, n_i on one step: turns on other steps are as many
    independent errors [derived].
    """
    if step == 0:
        return 0.0
    counts = np.unique(np.round(np.array(places) / step), return_counts=True)[1]
    share = float(np.sqrt(np.sum(counts**2)) / len(places))
    return float(step / np.sqrt(12) * max(share, GRAIN))


def _sections(motion: Motion, step: float) -> Array:
    """The record's filter at the windows' steps."""
    return low_pass(
        cutoff=motion.cutoff, order=motion.order, sample_time=step, compensated=motion.compensated
    )


def _lanes(
    slidings: Sequence[Sliding], motion: Motion, room: tuple[int, int]
) -> list[tuple[Sliding, int]]:
    """Pieces and samples of windows: turns and starts, else places spread over the record."""
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
    """Samples of settled sliding that is no slower than a speed."""
    found = np.zeros(sliding.piece.time.size, dtype=bool)
    found[settled(sliding, settling)] = True
    return found & (np.abs(sliding.piece.velocity) >= slowest)


def _fits(sliding: Sliding, at: int, room: tuple[int, int]) -> bool:
    """Whether a window about a sample lies within the piece's sound part."""
    first, last = at - room[0], at + room[1]
    sound = sliding.piece.sound
    return first >= 0 and last < sound.size and bool(sound[first] and sound[last])


def _turns(sliding: Sliding, motion: Motion) -> list[int]:
    """Samples at which lasting sliding begins, after the other way or rest."""
    way = np.where(sliding.moving, np.sign(sliding.piece.velocity), 0.0)
    begins = np.flatnonzero((way != 0) & (np.diff(way, prepend=0.0) != 0))
    lasting = round(LASTING / motion.sample_time)
    found: list[int] = []
    for at in map(int, begins):
        if np.all(way[at : at + lasting] == way[at]) and (not found or at - found[-1] > lasting):
            found.append(at)
    return found
