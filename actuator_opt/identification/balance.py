"""Friction from the force balance of the rod: over time, and as a coefficient.

For the coefficient, the contact laws of the design give the normal force.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError
from ..base.fitting import quantile
from ..base.numeric import Array
from ..studies.bench import Bench
from .conditioning import ConditionedRecord, RecordSection

RESTING, CREEP = 3.0, 2e-5
"""Below a certain speed, the rod may be at rest. That speed is `RESTING` standard deviations of the
velocity noise, or `CREEP` [m/s] if that is larger (our choices: only 0.3 % of the samples at rest
look faster than 3 standard deviations; 2e-5 m/s is two sensor steps of 10 um in a second)."""
OPPOSED = 0.5
"""Smallest `opposing_share` of a plausible record. A smaller share indicates a channel with a wrong
sign (our choice: at this value, a quarter of the friction's power drives the rod, which is more
than noise and offsets explain)."""
SLIDES = 5e-4
"""Smallest travel at which a section of a record counts as sliding [m] (our choice: ten breakaway
travels of 50 um; within a shorter travel, the contact returns much of its energy like a spring)."""
SURE = 0.8
"""A correction of the record is suggested only if the `opposing_share` of the corrected record is
larger than this value (our choice: at this value, a tenth of the friction's power drives the
rod)."""


@dataclass(frozen=True, slots=True, eq=False)
class Sliding:
    """Friction along one section of a record, SI; arrays are (samples).

    Parameters
    ----------
    piece : the section, with its motion
    hydraulic : hydraulic force p_1 A_1 - p_2 A_2 [N]
    resisting : load F_L plus inertia force m a [N], the part of the hydraulic force that is not
        friction
    pressure : the higher chamber pressure, gauge [Pa]
    resting : speed below which the rod may be at rest [m/s]
    """

    piece: RecordSection
    hydraulic: Array
    resisting: Array
    pressure: Array
    resting: float

    @property
    def friction(self) -> Array:
        """Friction force [N]: hydraulic force minus load and inertia force."""
        return self.hydraulic - self.resisting

    @property
    def moving(self) -> Array:
        """Flags for samples at which the rod certainly moves."""
        return self.piece.sound & (np.abs(self.piece.velocity) > self.resting)


def velocity_noise(motion: ConditionedRecord) -> float:
    """Standard deviation of the velocity due to noise and resolution of the position sensor [m/s].

    White noise with a standard deviation s of a sample, filtered at the cut-off f_c and
    differentiated, gives s_v = 2 pi f_c s sqrt(2 f_c dt/3) with the time step dt [derived]. A
    sensor step q counts as s = q/sqrt 12.
    """
    quality = motion.quality["x"]
    sample = max(quality.noise, quality.resolution / np.sqrt(12))
    band = 2 * motion.cutoff * motion.sample_time
    return float(2 * np.pi * motion.cutoff * sample * np.sqrt(band / 3))


def slide(
    motion: ConditionedRecord, bench: Bench, *, mass: float, load_force: float | None
) -> list[Sliding]:
    """Friction along every section of a record, from the force balance.

    The friction is F_r = p_1 A_1 - p_2 A_2 - F_L - m a [Huang2017] eq. 1, with pressures p and
    areas A of the chambers, load F_L, mass m and acceleration a. The areas include the growth of
    the bore.

    Parameters
    ----------
    motion : conditioned record; without a channel p2 the rod end is vented
    bench : the actuator, which gives the areas
    mass : moving mass on the actuator's side of the force sensor [kg]
    load_force : force of the load, if no channel F_L measures it [N]

    Returns
    -------
    friction of each section
    """
    resting = max(RESTING * velocity_noise(motion), CREEP)
    return [_sliding(piece, bench, mass, load_force or 0.0, resting) for piece in motion.pieces]


def _sliding(
    piece: RecordSection, bench: Bench, mass: float, load_force: float, resting: float
) -> Sliding:
    """Friction along one section."""
    first, second = piece.pressures
    highest = np.maximum(np.maximum(first, second), 0.0)
    area_1, area_2 = bench.areas(highest)
    load = piece.channels.get("F_L", load_force)
    return Sliding(
        piece,
        first * area_1 - second * area_2,
        load + mass * piece.acceleration,
        highest,
        resting,
    )


def opposing_share(slidings: Sequence[Sliding]) -> float:
    """Opposing minus driving power of the friction, divided by their sum.

    The share is 1 if friction always opposes the motion, and -1 if it always drives the rod. In a
    section of the record in which the rod hardly slides, friction acts like a spring. There, the
    power is that of the change of friction from sample to sample.
    """
    power = np.concatenate([_power(sliding) for sliding in slidings])
    total = float(np.sum(np.abs(power)))
    return float(np.sum(power)) / total if total else 0.0


def _power(sliding: Sliding) -> Array:
    """Power of the friction F at speed v for all moving samples: F v if the section slides.

    In a section that does not slide, it is v dF, with the change dF of F per sample.
    """
    velocity = sliding.piece.velocity
    if _slides(sliding):
        return (sliding.friction * velocity)[sliding.moving]
    return (np.gradient(sliding.friction) * velocity)[sliding.moving]


def _slides(sliding: Sliding) -> bool:
    """Whether the section travels far enough to count as sliding."""
    return float(np.ptp(sliding.piece["x"])) > SLIDES


def check_signs(slidings: Sequence[Sliding], bench: Bench, *, mass: float, name: str) -> None:
    """Reject a record whose friction drives the rod, because a channel then has the wrong sign.

    Raises
    ------
    InputError
        the text names the wrong or swapped channel whose correction explains the record, if there
        is one. If there are several, it names the one whose correction leaves the least friction
    """
    share = opposing_share(slidings)
    slides = any(_slides(sliding) for sliding in slidings)
    if share >= (OPPOSED if slides else 0.0):
        return
    candidates = []
    for rank, error in enumerate(_ERRORS):
        corrected = [_corrected(sliding, bench, mass, error) for sliding in slidings]
        friction = _mean_friction(corrected)
        if opposing_share(corrected) > SURE and (
            error == "x" or friction < _mean_friction(slidings)
        ):
            candidates.append((friction, rank, error))
    message = (
        "the computed friction drives the rod instead of opposing it (opposing minus driving "
        f"power is {100 * share:.0f} % of their sum)"
    )
    remedy = "check signs and zeros of all channels, bore and rod of the design, mass and load"
    if candidates:
        cause, remedy = _ERRORS[min(candidates)[-1]]
        message = f"{cause}: {message}"
    raise InputError(Diagnostic(message, remedy, file=name))


_ERRORS = {
    "x": (
        "x seems to have the wrong sign",
        "reverse the sign of x: it must increase as the rod extends",
    ),
    "F_L": (
        "F_L seems to have the wrong sign",
        "reverse the sign of F_L: it must be positive if it opposes extension",
    ),
    "p": ("p1 and p2 seem swapped", "swap p1 and p2, e.g. with --column p1=... --column p2=..."),
}
"""Possible sign errors of x and F_L, and swapped pressures: message and remedy of each."""


def _mean_friction(slidings: Sequence[Sliding]) -> float:
    """Mean absolute friction [N]."""
    return float(
        np.mean(np.concatenate([np.abs(sliding.friction[sliding.moving]) for sliding in slidings]))
    )


def _corrected(sliding: Sliding, bench: Bench, mass: float, error: str) -> Sliding:
    """The friction after correcting one of the `_ERRORS`."""
    piece = sliding.piece
    channels = dict(piece.channels)
    if error == "p" and "p2" in channels:
        channels["p1"], channels["p2"] = channels["p2"], channels["p1"]
    if error == "F_L" and "F_L" in channels:
        channels["F_L"] = -channels["F_L"]
    sign = -1.0 if error == "x" else 1.0
    section = RecordSection(
        piece.time, channels, sign * piece.velocity, sign * piece.acceleration, piece.sound
    )
    load = sliding.resisting[0] - mass * piece.acceleration[0] if "F_L" not in channels else 0.0
    return _sliding(section, bench, mass, float(load), sliding.resting)


WINDOW = 0.1
"""Length of the time windows over which friction and contact force are averaged [s] (our choice:
six independent samples at 30 Hz)."""


LEAST_SPEED = 1e-3
"""Smallest mean speed of a usable time window [m/s] (our choice: the rod then moves ten sensor
steps of 10 um, which show the direction)."""


@dataclass(frozen=True, slots=True)
class Coefficient:
    """Friction coefficient mu = F_r/N: median over short time windows of sliding, SI.

    F_r is the friction force, N the normal force of all rings.

    Parameters
    ----------
    value, lower, upper : median, and its 95 % confidence limits [-]
    contact_force : normal force N of all rings, median over the windows [N]
    contact_pressure : N divided by the contact areas of the rings [Pa]
    windows : number of windows
    law : contact laws of the rings
    speeds : lowest and highest mean speed of a window [m/s]
    """

    value: float
    lower: float
    upper: float
    contact_force: float
    contact_pressure: float
    windows: int
    law: str
    speeds: tuple[float, float]


def coefficient(
    slidings: Sequence[Sliding], motion: ConditionedRecord, bench: Bench
) -> Coefficient | str:
    """The friction coefficient from a record, or the reason why it is missing.

    mu = F_r/(pi sum f_i D_i), with the friction force F_r and, for each ring i, its diameter D_i
    and its line load f_i. The line loads follow from the contact laws of the design at the chamber
    pressures. Both squeeze and pressure load the rings, so no pressure difference is needed.

    Parameters
    ----------
    slidings, motion : friction along each section of the record, and the conditioned record
    bench : rings of the design

    Returns
    -------
    median over the windows, with confidence limits from its order statistics; or the reason why it
    is missing
    """
    rows = np.concatenate([_windows(sliding, motion) for sliding in slidings])
    if rows.shape[0] < 2:
        return (
            f"the rod never slides for {WINDOW:g} s above {1e3 * LEAST_SPEED:g} mm/s in one "
            "direction: no friction coefficient"
        )
    forces = bench.contact_forces(rows[:, 1], rows[:, 2])
    normal = sum(forces.values())
    ratios = np.sort(rows[:, 0] / normal)
    count = ratios.size
    half = quantile(count - 1) * np.sqrt(count) / 2
    low = int(np.clip(np.floor(count / 2 - half), 0, count - 1))
    high = int(np.clip(np.ceil(count / 2 + half), 0, count - 1))
    first, second = float(np.median(rows[:, 1])), float(np.median(rows[:, 2]))
    return Coefficient(
        float(np.median(ratios)),
        float(ratios[low]),
        float(ratios[high]),
        float(np.median(normal)),
        bench.contact_pressure(first, second),
        count,
        bench.contact_law,
        (float(np.min(rows[:, 3])), float(np.max(rows[:, 3]))),
    )


def _windows(sliding: Sliding, motion: ConditionedRecord) -> Array:
    """Means over each time window in which the rod slides in one direction, an array (windows, 4).

    The columns are friction (positive against the motion), both pressures, and speed.
    """
    size = max(round(WINDOW / motion.sample_time), 1)
    piece = sliding.piece
    count = piece.time.size // size

    def cut(values: Array) -> Array:
        return values[: count * size].reshape(count, size)

    way = np.sign(piece.velocity)
    valid = np.all(cut(sliding.moving), axis=1) & (np.abs(np.sum(cut(way), axis=1)) == size)
    valid &= np.mean(np.abs(cut(piece.velocity)), axis=1) > LEAST_SPEED
    channels = (sliding.friction * way, *piece.pressures, np.abs(piece.velocity))
    return np.stack([np.mean(cut(channel), axis=1)[valid] for channel in channels], axis=1)
