"""LuGre bristles from reversals: integrated along the record, with the record's filter.

Bristle stiffness and damping, and the lag of the pressures, are fitted to windows about the
reversals, together with the Stribeck parameters from the steady points.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..base import fitting as least_squares
from ..base.fitting import NORMAL, Parameter, known, quantile
from ..base.numeric import Array
from ..models import friction
from .balance import Sliding
from .conditioning import SLOWEST, ConditionedRecord, low_pass, velocities, zero_phase
from .doubtful import PARTED, agreed, hidden, opened, widened
from .points import SETTLED, SETTLING, FrictionPoint, settled
from .stribeck_fit import (
    EXPONENT,
    EXPONENTS,
    OTHER,
    SHARED,
    SPEEDS,
    Steady,
    StribeckFit,
    held_error,
)

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
            np.sum(replace(self, velocity=option).misfit(values)[0] ** 2, axis=-1)
            for option in self.options
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
    motion: ConditionedRecord,
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
    options = np.stack([pace[:, ::stride] for pace in paces], axis=1)
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


def _kept(motion: ConditionedRecord, step: float, count: int) -> Array:
    """Independent samples of a window, away from its ends."""
    edge = round(1 / (motion.cutoff * step))
    apart = max(1, round(1 / (2 * motion.cutoff * step)))
    return np.arange(edge, count - edge, apart)


def no_windows(motion: ConditionedRecord) -> str:
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


def _sections(motion: ConditionedRecord, step: float) -> Array:
    """The record's filter at the windows' sampling."""
    return low_pass(
        cutoff=motion.cutoff, order=motion.order, sample_time=step, compensated=motion.compensated
    )


def _lanes(
    slidings: Sequence[Sliding], motion: ConditionedRecord, room: tuple[int, int]
) -> list[tuple[Sliding, int]]:
    """Sections and samples of windows: reversals and starts, else spread over the record."""
    places = [
        (sliding, at)
        for sliding in slidings
        for at in _turns(sliding, motion)
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


def _turns(sliding: Sliding, motion: ConditionedRecord) -> list[int]:
    """Samples at which lasting sliding begins, after a reversal or rest."""
    way = np.where(sliding.moving, np.sign(sliding.piece.velocity), 0.0)
    begins = np.flatnonzero((way != 0) & (np.diff(way, prepend=0.0) != 0))
    lasting = round(LASTING / motion.sample_time)
    found: list[int] = []
    for at in map(int, begins):
        if np.all(way[at : at + lasting] == way[at]) and (not found or at - found[-1] > lasting):
            found.append(at)
    return found


TRAVELS = (1e-6, 3e-3)
"""Bristle travels F_S/sigma_0 searched [m] (a choice: nearly two decades about 50 um)."""
DAMPING_TIMES = (1e-6, 0.3)
"""sigma_1/sigma_0 searched [s] (a choice: from none to the length of a window)."""
USUAL = 5e-3
"""Usual standard deviation of the pressure lag [s] (a choice: sensors and lines of a test bench, up
to 10 ms): included in bounds if a record does not show the lag."""
STEP = 1e-4
"""Relative step of central differences (a choice: error 1e-8)."""
SYMBOLS = {"bristle_stiffness": "σ₀", "bristle_damping": "σ₁", "lag": "τ"}
"""Parameters in addition to those of the Stribeck curve: N/m, N s/m, s."""
MODEL = 1e-3
"""Least scatter of the windows relative to the largest friction (a choice, as of the points): below
it the filtered motion limits the model, not noise."""
BENDS = 3.0
"""Breakaway travels that give 95 % of the force, 1 - e^-3: the record must resolve them in time."""
LATE = 1.5
"""Multiple of its standard error by which a lag is uncertain (a choice, from records of known
friction: with 25 kPa of noise and steps of 10 um z of the fitted lag scatters by 1.3 to 1.9); the
sampling adds dt/sqrt 12, as a reversal falls anywhere within a sample."""
NOISY, MISSED = 2.0, 0.02
"""Allowed misfit in the windows, as a multiple of noise and a share of the largest friction (a
choice, from records of known friction: position steps cost up to 3 times the noise)."""
TOLD = 3
"""Parameters determined by the windows: stiffness, lag or damping, level."""
RCOND = 1e-6
"""Least ratio of singular values by which a lag affects parameters (a choice: far above
rounding)."""
ROUNDS = 2
"""Searches, each with windows weighted by their scatter in the last (a choice: the second changes
the weights by a few per cent)."""
LOGARITHMIC = ("bristle_stiffness", "bristle_damping", "stribeck_speed")
"""Parameters searched by logarithm."""


@dataclass(frozen=True, slots=True, eq=False)
class LuGreFit:
    """A LuGre model, SI.

    Parameters
    ----------
    parameters : fitted, by name: those of the Stribeck curve, `bristle_stiffness`,
        `bristle_damping` and the pressures' `lag`
    held : fixed values
    count : number of windows
    misfit : standard deviation of the friction about the model in the windows [N]
    doubts : unknown parameters and other caveats
    """

    parameters: Mapping[str, Parameter]
    held: Mapping[str, float]
    count: int
    misfit: float
    doubts: tuple[str, ...]

    @property
    def values(self) -> dict[str, float]:
        """All parameters, fitted or fixed."""
        return {**self.held, **{name: one.value for name, one in self.parameters.items()}}


def sizes(names: Sequence[str], largest: float, steady: Steady | None) -> Array:
    """Size of each searched parameter: 1 of a logarithm."""
    speed, change = 1e-3, 1e5
    if steady is not None:
        speed = max(speed, float(np.max(np.abs(steady.velocity))))
        change = max(change, float(np.max(np.abs(steady.change))))
    size = dict.fromkeys(("coulomb", "static", "offset"), largest)
    size |= {"viscous": largest / speed, "pressure_slope": largest / change, "lag": 1e-2}
    return np.array([size.get(name, 1.0) for name in names])


class LugreProblem:
    """Residuals of points and windows over the searched parameters."""

    def __init__(
        self,
        found: Windows,
        points: Sequence[FrictionPoint],
        stribeck: StribeckFit | None,
        lag_known: bool,
        lag_seen: bool,
        falling: bool = False,
        held: Mapping[str, float] | None = None,
    ) -> None:
        self.windows, self.lag_known = found, lag_known
        self.steady = None
        self.largest = found.largest
        self.spread = 1.0
        if stribeck is None:
            self.begin = {"coulomb": self.largest, "offset": 0.0}
            self.held = {"viscous": 0.0, "exponent": EXPONENT, "pressure_slope": 0.0}
            self.held["stribeck_speed"] = SPEEDS[0]
            if falling:
                del self.held["stribeck_speed"], self.held["exponent"]
                self.begin |= {
                    "exponent": EXPONENT,
                    "coulomb": self.largest / 2,
                    "static": self.largest,
                    "stribeck_speed": float(np.sqrt(SPEEDS[0] * SPEEDS[1])),
                }
        else:
            apart = found.step * float(found.kept[1] - found.kept[0])
            noise = [point.error * np.sqrt(max(point.weight / apart, 1.0)) for point in points]
            self.noise = float(np.median(noise))
            least = SHARED if any(point.kind == "sweep" for point in points) else 1e-3
            self.steady = Steady(points, stribeck.errors * max(stribeck.scatter, least))
            self.begin = {name: one.value for name, one in stribeck.parameters.items()}
            self.held = dict(stribeck.held)
            self.told = stribeck.parameters
            self._ask_for_static(stribeck)
        for name, value in (held or {}).items():
            self.begin.pop(name, None)
            self.held[name] = value
        if lag_known:
            self.held["lag"] = 0.0
        else:
            self.held["bristle_damping"] = 0.0
            if not lag_seen:
                self.held["lag"] = 0.0
        self.names = (*self.begin, *(name for name in SYMBOLS if name not in self.held))
        self.sizes = sizes(self.names, self.largest, self.steady)

    def _ask_for_static(self, stribeck: StribeckFit) -> None:
        """Start F_S and v_s from the windows if the points do not give them."""
        seen = stribeck.parameters.get("static")
        if self.held.pop("exponent", None) is not None:
            self.begin["exponent"] = EXPONENT
        self.static_known = seen is not None and seen.identifiable
        if not self.static_known:
            for name in ("static", "stribeck_speed"):
                self.held.pop(name, None)
            self.begin |= {
                "exponent": EXPONENT,
                "static": max(self.largest, 1.01 * self.begin["coulomb"]),
                "stribeck_speed": float(np.sqrt(SPEEDS[0] * SPEEDS[1])),
            }

    def values(self, rows: Array) -> dict[str, Array]:
        """Parameters (rows,) of rows of searched ones (rows, searched)."""
        own = {}
        for name, column in zip(self.names, rows.T, strict=True):
            own[name] = np.exp(column) if name in LOGARITHMIC else column
        held = {name: np.full(rows.shape[0], value) for name, value in self.held.items()}
        if "static" not in own:
            held["static"] = own["coulomb"]
        return held | own

    def residuals(self, rows: Array) -> Array:
        """Weighted residuals of rows of searched parameters (rows, residuals)."""
        values = self.values(rows)
        lanes = (self.windows.misfit(values) / self.spread).reshape(len(rows), -1)
        if self.steady is None:
            return lanes
        steady = {n: v[:, None] for n, v in values.items() if n not in SYMBOLS}
        return np.concatenate([self.steady.residual(steady), lanes], axis=1)

    def one(self, x: Array) -> Array:
        """Weighted residuals of one row."""
        return self.residuals(x[None])[0]

    def slopes(self, x: Array) -> Array:
        """Derivatives of the residuals by central differences, all at once."""
        steps = STEP * np.diag(self.sizes)
        found = self.residuals(np.concatenate([x + steps, x - steps]))
        return ((found[: x.size] - found[x.size :]) / (2 * STEP * self.sizes[:, None])).T

    def limits(self) -> tuple[Array, Array]:
        """Limits of the search."""
        stiffest, softest = (self.largest / one for one in TRAVELS)
        ends = {
            "coulomb": (1e-3 * self.largest, np.inf),
            "static": (1e-3 * self.largest, 3 * self.largest),
            "viscous": (0.0, np.inf),
            "exponent": EXPONENTS,
            "stribeck_speed": tuple(np.log(SPEEDS)),
            "bristle_stiffness": (np.log(softest), np.log(stiffest)),
            "bristle_damping": tuple(
                np.log([softest * DAMPING_TIMES[0], stiffest * DAMPING_TIMES[1]])
            ),
            "lag": (-LAG, LAG),
        }
        pairs = [ends.get(name, (-np.inf, np.inf)) for name in self.names]
        return np.array([pair[0] for pair in pairs]), np.array([pair[1] for pair in pairs])

    def start(self) -> Array:
        """The best of a grid of bristle stiffnesses and lags (and Stribeck speeds)."""
        speeds = [self.begin.get("stribeck_speed", SPEEDS[0])]
        if "static" in self.begin and "stribeck_speed" not in self.held:
            speeds = [0.3 * speeds[0], speeds[0], 3 * speeds[0]]
        rows = []
        for speed in speeds:
            for travel in np.geomspace(3 * TRAVELS[0], TRAVELS[1] / 3, 9):
                for lag in (-4e-3, 0.0, 4e-3, 8e-3) if "lag" in self.names else (0.0,):
                    stiffness = self.largest / travel
                    own = self.begin | {
                        "stribeck_speed": np.log(np.clip(speed, *SPEEDS)),
                        "bristle_stiffness": np.log(stiffness),
                        "bristle_damping": np.log(1e-3 * stiffness),
                        "lag": lag,
                    }
                    rows.append([own[name] for name in self.names])
        table = np.array(rows)
        best, least = table[0], np.inf
        for one in self.windows.options[[0, -1]]:
            self.windows = replace(self.windows, velocity=one)
            cost = np.sum(self.residuals(table) ** 2, axis=1)
            k = int(np.argmin(cost))
            if cost[k] < least:
                best, least = table[k], cost[k]
        return best

    def descend(self, x: Array) -> Array:
        """Least squares within the limits."""
        low, high = self.limits()
        span = np.where(np.isfinite(high - low), high - low, self.sizes)
        return least_squares.solve(
            self.one,
            x,
            (low, high),
            slopes=self.slopes,
            sizes=self.sizes,
            room=1e-6 * span,
            cost_tolerance=1e-7,
            step_tolerance=1e-6,
            most=40,
        ).x

    def scatter(self, x: Array) -> float:
        """Standard deviation of the windows' residuals [N]."""
        judged = self.windows.judged.sum()
        square = np.sum(self.windows.misfit(self.values(x[None])) ** 2) / max(judged, 1.0)
        return max(float(np.sqrt(square)), MODEL * self.largest)

    def whitened(self, residuals: Array, slopes: Array) -> Array:
        """Slopes J' of equally informative independent unit residuals: J'^T J' = cov^-1.

        cov = H^-1 J^T R J H^-1, H = J^T J, R the residuals' covariance: points are independent,
        lanes share one autocovariance c_k = sum r_t r_(t+k)/n [SeberWild1989]. With J = U S V^T,
        J' = L^-1 S V^T, L L^T = U^T R U [derived].
        """
        from scipy.linalg import solve_triangular, toeplitz  # slow import, rarely used

        lanes, count = self.windows.judged.shape
        split = residuals.size - lanes * count
        left, singular, right = np.linalg.svd(slopes * self.sizes, full_matrices=False)
        own = residuals[split:].reshape(lanes, count)
        judged = max(float(self.windows.judged.sum()) - slopes.shape[1], 1.0)
        lags = [float(np.sum(own[:, : count - k] * own[:, k:])) / judged for k in range(count)]
        lags[0] = max(lags[0], (MODEL * self.largest / self.spread) ** 2)
        steep = left[split:].reshape(lanes, count, -1)
        inner = left[:split].T @ left[:split]
        inner = inner + np.einsum("lip,ij,ljq->pq", steep, toeplitz(lags), steep, optimize=True)
        root = np.linalg.cholesky(inner)
        return solve_triangular(root, singular[:, None] * right, lower=True) / self.sizes

    def lanes(self, residuals: Array, slopes: Array) -> Array:
        """Standard errors from independent lanes, whatever the correlation within them.

        cov = H^-1 sum (J_l^T r_l)(J_l^T r_l)^T H^-1 n/(n - 3) of n lanes [SeberWild1989]: steps of
        the position sensor shift a whole reversal. Zeros for too few lanes.
        """
        lanes, count = self.windows.judged.shape
        split = residuals.size - lanes * count
        scaled = slopes * self.sizes
        inverse = np.linalg.pinv(scaled, rcond=RCOND)
        parts = np.einsum(
            "plc,lc->lp",
            inverse[:, split:].reshape(-1, lanes, count),
            residuals[split:].reshape(lanes, count),
        )
        used = self.used
        if used <= TOLD:
            return np.zeros(self.sizes.size)
        variance = np.sum(parts**2, axis=0) * used / (used - TOLD)
        variance += np.sum(inverse[:, :split] ** 2, axis=1)
        return np.sqrt(variance) * self.sizes

    @property
    def missed(self) -> str | None:
        """Why the windows are unusable, if the model misses them by more than their noise."""
        if self.steady is None or self.spread <= NOISY * self.noise + MISSED * self.largest:
            return None
        return (
            f"the model misses friction at reversals by {self.spread:.3g} N, but noise is "
            f"{self.noise:.2g} N: the rod moves too fast there for the filter to show F_S, v_s "
            "and σ₀"
        )

    def travel(self, x: Array) -> float:
        """Deflection distance of the bristles [m]."""
        found = {name: float(one[0]) for name, one in self.values(x[None]).items()}
        level = min(max(found["static"], found["coulomb"]), self.largest)
        return BENDS * level / found["bristle_stiffness"]

    def moved(self, x: Array, chain: Array, misfit: Array) -> dict[str, float]:
        """Change of parameters for a misfit of the windows [N]."""
        before = self.one(x)
        lanes = (misfit / self.spread).reshape(-1)
        change = np.zeros_like(before)
        change[-lanes.size :] = lanes - before[-lanes.size :]
        moved = np.linalg.lstsq(self.slopes(x) * self.sizes, -change, rcond=RCOND)[0]
        return dict(zip(self.names, np.abs(moved * self.sizes * chain), strict=True))

    def bounded(self, x: Array) -> dict[str, Parameter]:
        """Parameters with bounds from residuals, lanes and position resolution."""
        found = {name: float(one[0]) for name, one in self.values(x[None]).items()}
        own = {name: found[name] for name in self.names}
        chain = np.array([own[name] if name in LOGARITHMIC else 1.0 for name in self.names])
        least = 1e-3 * self.sizes * chain
        residuals = self.one(x)
        steep = self.slopes(x)
        slopes = self.whitened(residuals, steep) / chain
        spare = residuals.size - int(np.sum(self.windows.judged == 0)) - len(own)
        told = known(
            own,
            slopes,
            np.ones(1) * np.sqrt(max(spare, 0)),
            np.maximum(np.abs(list(own.values())), least),
            spare=spare,
        )
        by_lanes = self.lanes(residuals, steep) * chain
        own_error = np.array([parameter.standard_error for parameter in told.parameters.values()])
        with np.errstate(invalid="ignore"):
            more = np.sqrt(np.maximum(by_lanes**2 - own_error**2, 0.0))
        more = np.where(np.isfinite(own_error), more, 0.0)
        place = list(own).index("bristle_stiffness")
        shift = self.windows.grain * BENDS / self.travel(x) * own["bristle_stiffness"]
        more[place] = np.hypot(more[place], shift)
        if "lag" in own:
            place = list(own).index("lag")
            known_error = own_error[place] if np.isfinite(own_error[place]) else 0.0
            few = quantile(self.used - 1) / told.quantile
            scatter = few * float(np.hypot(own_error[place], more[place]))
            whole = self._lag_error(x, chain, scatter)
            more[place] = np.sqrt(max(whole**2 - known_error**2, 0.0))
        parameters = widened(
            told.parameters, dict(zip(own, more.tolist(), strict=True)), told.quantile
        )
        if "lag" not in self.names and not self.lag_known:
            late = self.windows.misfit(self.values(x[None]) | {"lag": np.full(1, USUAL)})
            parameters = widened(parameters, self.moved(x, chain, late), told.quantile)
        return parameters

    @property
    def used(self) -> int:
        """Number of windows in use."""
        return int(np.sum(np.any(self.windows.judged > 0, axis=-1)))

    def _lag_error(self, x: Array, chain: Array, scatter: float) -> float:
        """Standard error of the lag from scatter, position, velocity and sampling [s].

        Resolution of the position sensor shifts all reversals alike, its white noise each reversal
        separately. A velocity with a lower cut-off than the pressures' starts early, which looks
        like a lag; the velocity at the record's own cut-off shows the difference.
        """
        values, windows = self.values(x[None]), self.windows
        distance = float(np.hypot(windows.grain, windows.noise / np.sqrt(max(self.used, 1))))
        short = self.moved(x, chain, windows.short(distance).misfit(values))["lag"]
        whole = LATE * float(np.hypot(scatter, short))
        return float(np.hypot(np.hypot(whole, self._early(x)), windows.sample_time / np.sqrt(12)))

    def _early(self, x: Array) -> float:
        """Change of the lag with the velocity at the record's own cut-off [s]."""
        windows = self.windows
        if np.array_equal(windows.velocity, windows.options[0]):
            return 0.0
        self.windows = replace(windows, velocity=windows.options[0])
        place = self.names.index("lag")
        apart = abs(float(self.descend(x)[place] - x[place]))
        self.windows = windows
        return apart

    def solve(self) -> LuGreFit:
        """Search, weight the windows by their scatter, search again, and compute bounds."""
        x = self.start()
        for _ in range(ROUNDS):
            self.windows = self.windows.chosen(self.values(x[None]))
            self.windows = self.windows.resolved(self.travel(x))
            self.spread = self.scatter(x)
            x = self.descend(x)
        parameters = self.bounded(x)
        fastest = self.windows.fastest
        if self.steady is not None:
            fastest = max(fastest, float(np.max(np.abs(self.steady.velocity))))
        missed = self.missed
        if missed is not None:
            told = agreed(parameters, self.told)
            parameters = opened(parameters, (name for name in parameters if name not in told))
        if self.windows.quick:
            parameters = opened(parameters, ("bristle_stiffness", "bristle_damping", "lag"))
        why = hidden(parameters, fastest, falls=False)
        if why is not None:
            parameters = opened(parameters, PARTED)
        doubts = [
            f"{SYMBOLS[name]} is {one.verdict}"
            for name, one in parameters.items()
            if name in LOGARITHMIC[:2] and not one.identifiable
        ]
        if self.windows.quick:
            doubts.append(
                "the rod starts too fast for the filter to show bristles: reverse it slowly"
            )
        doubts += [one for one in (why, missed) if one is not None]
        lanes = self.windows.velocity.shape[0]
        return LuGreFit(parameters, self.held, lanes, self.spread, tuple(doubts))


__all__ = [
    "LOGARITHMIC",
    "SYMBOLS",
    "TRAVELS",
    "LuGreFit",
    "fit_lugre",
    "settling_distance",
]

BLUR = 40e-3
"""Longest hidden reversal for which a lag is fitted [s] (a choice: ten usual lags)."""
SURER = 10.0
"""Gain in Akaike information required for a falling over a constant level (a choice: very
strong)."""
SLID = 0.95
"""Share of the level that friction must reach for the level to be identifiable (a choice)."""
FAR = 3.0
"""Stribeck speeds at which at most 5 % of F_S - F_C remain at exponent 1 (a choice)."""


def settling_distance(lugre: LuGreFit | str) -> float:
    """Distance after a reversal from which sliding is steady [m], for known bristles."""
    if isinstance(lugre, str) or not lugre.parameters["bristle_stiffness"].identifiable:
        return SETTLED
    level = max(lugre.values.get("static", 0.0), lugre.values["coulomb"])
    return max(SETTLED, SETTLING * level / lugre.values["bristle_stiffness"])


def fit_lugre(
    slidings: Sequence[Sliding],
    motion: ConditionedRecord,
    points: Sequence[FrictionPoint],
    stribeck: StribeckFit | str,
    *,
    lag_known: bool,
    settling: float = SETTLED,
) -> LuGreFit | str:
    """The LuGre model of a record, or the reason for none.

    Least squares over points of steady sliding and windows about reversals, each weighted by its
    own scatter [AaltoThesis] eq. 27-31. Without a Stribeck curve, as in pre-sliding, the windows
    alone give F_C and the bristles. In stuck contact sigma_0 z + sigma_1 dz/dt is sigma_0 z
    advanced by sigma_1/sigma_0, like early pressures, so only one of the two is fitted.

    Parameters
    ----------
    slidings, motion : friction along the record, and its filter
    points : of steady sliding
    stribeck : the curve through them, the start of the search
    lag_known : fit sigma_1; else fit the lag of the pressures, with sigma_1 fixed at 0
    settling : distance after a reversal from which sliding is steady [m]

    Returns
    -------
    the fit, or the reason for none
    """
    curve_known = stribeck if isinstance(stribeck, StribeckFit) else None
    reference = 0.0 if curve_known is None else curve_known.reference_pressure
    slowest = np.inf if curve_known is None else min(point.speed for point in points)
    found = windows(slidings, motion, reference, slowest, settling)
    if found is None:
        return no_windows(motion)
    seen = found.blur < BLUR
    if curve_known is None:
        fit = _level(found, lag_known, seen)
    else:
        problem = LugreProblem(found, points, curve_known, lag_known, seen)
        fit = problem.solve()
        if "stribeck_speed" in fit.parameters and not np.isfinite(fit.parameters["coulomb"].upper):
            fit = _parted(fit, points, curve_known, found, lag_known, seen)
        fit = _as_the_points(fit, curve_known, points)
    if lag_known or seen:
        return fit
    doubt = (
        f"the position resolution hides reversals for {1000.0 * found.blur:.0f} ms: no lag of "
        f"the pressures is fitted, but bounds allow for {1000.0 * USUAL:.0f} ms; move faster or "
        "state --pressure-lag"
    )
    return replace(fit, doubts=(*fit.doubts, doubt))


def _level(found: Windows, lag_known: bool, lag_seen: bool) -> LuGreFit:
    """The model from windows alone: a constant friction level, or one that falls from F_S."""
    fit = LugreProblem(found, (), None, lag_known, lag_seen).solve()
    slid = fit.misfit + found.largest > SLID * fit.values["coulomb"]
    if slid:
        falling = _falling(found, lag_known, lag_seen, EXPONENT)
        count = 2 * float(found.judged.sum())
        better = count * np.log(fit.misfit / falling.misfit)
        more = 2 * (len(falling.parameters) - len(fit.parameters))
        if better > more + SURER:
            free = _falling(found, lag_known, lag_seen)
            known = free.parameters["exponent"].identifiable
            fit = free if known else _any_exponent(falling, found, lag_known, lag_seen)
    fastest = 1e3 * found.fastest
    if "static" in fit.parameters:
        if found.fastest < FAR * fit.values["stribeck_speed"]:
            fit = replace(fit, parameters=opened(fit.parameters, PARTED))
        doubt = (
            f"F_C is the level at {fastest:.3g} mm/s, including viscous friction, as one speed "
            "cannot separate them; give plateaus or sweeps of other speeds"
        )
    elif slid:
        doubt = (
            f"F_C is the friction level up to {fastest:.3g} mm/s, between F_C and F_S: give "
            "plateaus or sweeps of other speeds"
        )
    else:
        doubt = "the rod hardly slides: the record shows bristles, but no friction level"
        fit = replace(fit, parameters=opened(fit.parameters, ("coulomb",)))
    return replace(fit, doubts=(*fit.doubts, doubt))


def _falling(
    found: Windows, lag_known: bool, lag_seen: bool, exponent: float | None = None
) -> LuGreFit:
    """The model from windows alone with a falling level, with a fixed exponent if given."""
    held = None if exponent is None else {"exponent": exponent}
    return LugreProblem(found, (), None, lag_known, lag_seen, falling=True, held=held).solve()


def _any_exponent(fit: LuGreFit, found: Windows, lag_known: bool, lag_seen: bool) -> LuGreFit:
    """A falling level with bounds that allow for exponents other than the fixed one.

    Each parameter has the larger uncertainty of both fits, plus their difference.
    """
    other = _falling(found, lag_known, lag_seen, OTHER)
    more = held_error(fit.parameters, other.values)
    for name, extra in more.items():
        apart = [one.parameters[name].standard_error ** 2 for one in (fit, other)]
        if np.isfinite(apart).all():
            more[name] = float(np.sqrt(extra**2 + max(apart[1] - apart[0], 0.0)))
    doubt = f"the exponent is fixed at {EXPONENT:g}, bounds allow for {OTHER:g}"
    parameters = widened(fit.parameters, more, NORMAL)
    return replace(fit, parameters=parameters, doubts=(*fit.doubts, doubt))


def _as_the_points(
    fit: LuGreFit, stribeck: StribeckFit, points: Sequence[FrictionPoint]
) -> LuGreFit:
    """The model without parameters that the points of steady sliding rule out."""
    level, speed = stribeck.parameters["coulomb"], fit.parameters.get("stribeck_speed")
    doubts = list(fit.doubts)
    parameters = dict(fit.parameters)
    if stribeck.doubted:
        told = agreed(parameters, stribeck.parameters)
        parameters = opened(parameters, set(parameters) - set(told))
        doubts.append("areas or sensors are wrong, according to the points of steady sliding")
    elif not np.isfinite(level.upper) and not (speed is not None and speed.identifiable):
        if np.isfinite(parameters["coulomb"].upper):
            fastest = 1e3 * max(point.speed for point in points)
            doubts.append(
                f"F_C is the friction level up to {fastest:.3g} mm/s: steady sliding there does "
                "not separate it from F_S and σ₂; give more and faster speeds"
            )
        parameters = opened(parameters, PARTED)
    return replace(fit, parameters=parameters, doubts=tuple(doubts))


def _parted(
    fit: LuGreFit,
    points: Sequence[FrictionPoint],
    stribeck: StribeckFit,
    found: Windows,
    lag_known: bool,
    lag_seen: bool,
) -> LuGreFit:
    """F_S and sigma_0, with the change due to fixing F_C and sigma_2 if those are not separated."""
    held = {"viscous": 0.0, "exponent": EXPONENT}
    other = LugreProblem(found, points, stribeck, lag_known, lag_seen, held=held).solve()
    more = {
        name: abs(other.values[name] - fit.values[name])
        for name in ("static", "bristle_stiffness")
        if name in fit.parameters
    }
    return replace(fit, parameters=widened(fit.parameters, more, NORMAL))
